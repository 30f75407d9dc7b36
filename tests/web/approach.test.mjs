// SPDX-License-Identifier: GPL-3.0-or-later
// From which positions the camera looks at a tag: the distance, and the sides that are tried.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { approachDistance, approaches } from '../../clients/web/core/approach.js';
import { valid } from '../../clients/web/core/camera.js';
import { distance } from '../../clients/web/core/camera_moves.js';

const box = (x, y, z) => ({ min: [0, 0, 0], max: [x, y, z] });

test('as far off as what the tag stands on is recognised, however long it is', () => {
    assert.equal(approachDistance(box(1, 1, 1)), 5, 'a pump');
    assert.equal(approachDistance(box(2, 2, 30)), 5, 'a column');
    assert.ok(Math.abs(approachDistance(box(8, 8, 9)) - 8.8) < 1e-9, 'a tank');
    assert.equal(approachDistance(box(60, 40, 6)), 12, 'a pipe rack');
});

test('all sides look at the tag from as far, the first from its own side, none twice', () => {
    const camera = { eye: [30, 30, 20], target: [0, 0, 0], up: [0, 0, 1], fov: 45 };
    const all = approaches(camera, [1, 0.5, 0.5], box(1, 1, 1));
    assert.ok(all[0].eye[0] > 5 && Math.abs(all[0].eye[1] - 0.5) < 1e-6);
    for (const one of all) {
        assert.ok(valid(one));
        assert.deepEqual(one.target, [1, 0.5, 0.5]);
        assert.ok(Math.abs(distance(one) - 5) < 1e-9);
    }
    for (const [i, one] of all.entries())
        assert.ok(all.slice(0, i).every(({ eye }) => Math.hypot(...eye.map((m, k) => m - one.eye[k])) > 0.5), `side ${i}`);
});
