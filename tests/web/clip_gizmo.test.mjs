// SPDX-License-Identifier: GPL-3.0-or-later
// Handles of a clip box: their positions, where the pointer grabs them, and how far a drag moves them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { alongSight, beforeEye, facing, gripsOf, moveBox, moveGrip, spotsOf, wholeOf } from '../../clients/web/core/clip_gizmo.js';
import { sight } from '../../clients/web/core/camera_moves.js';
import { cut } from '../../clients/web/core/section.js';

const BOUNDS = { min: [0, 0, 0], max: [10, 20, 4] };
const near = (a, b, least = 1e-9) => assert.ok(Math.abs(a - b) < least, `${a} is not ${b}`);

test('a section plane has one handle in its middle, whichever side is cut off', () => {
    for (const turned of [false, true]) {
        const clip = cut('x', 3, turned), [grip] = gripsOf(clip, BOUNDS);
        assert.deepEqual([grip.axis, grip.turned, grip.direction], ['x', turned, [1, 0, 0]]);
        near(grip.at, 3);
        assert.equal(grip.corners.length, 4);
        assert.deepEqual(spotsOf(grip)[0].map((m) => Math.round(m * 1e6) / 1e6), [3, 10, 2]);
        const [moved] = gripsOf(moveGrip(clip, grip, 7), BOUNDS);
        near(moved.at, 7);
        assert.equal(moved.turned, turned);
    }
});

test('an oblique plane moves along its own normal of any length, and the other planes stay', () => {
    const clip = { planes: [[0, 0, 1, -1], [3, 4, 0, -25]] }, [, grip] = gripsOf(clip, BOUNDS);
    assert.equal(grip.axis, null);
    near(grip.at, 5);
    const moved = moveGrip(clip, grip, 8);
    assert.deepEqual(moved.planes[0], clip.planes[0]);
    moved.planes[1].forEach((v, i) => near(v, [3, 4, 0, -40][i]));
    for (const p of gripsOf(moved, BOUNDS)[1].corners)
        near(0.6 * p[0] + 0.8 * p[1], 8);
    const three = gripsOf({ planes: [[-1, -1, -1, 2]] }, BOUNDS)[0];
    assert.equal(three.corners.length, 3);
    assert.equal(three.turned, true);
});

test('a plane stays inside the plant, and a box keeps a minimum width, so no handle is lost', () => {
    for (const to of [-1e9, 1e9, -5, 10.01]) {
        const clip = cut('x', 3, false), moved = moveGrip(clip, gripsOf(clip, BOUNDS)[0], to);
        assert.ok(gripsOf(moved, BOUNDS)[0].corners.length >= 3, `the plane is lost after a move by ${to}`);
    }
    const clip = { box: { min: [2, 2, 1], max: [4, 6, 3] } };
    for (const grip of gripsOf(clip, BOUNDS)) {
        for (const to of [-1e9, 1e9]) {
            const { min, max } = moveGrip(clip, grip, to).box;
            assert.ok(min.every((m, i) => m < max[i]), grip.id);
        }
    }
});

test('a section box has six handles, one for each side', () => {
    const clip = { box: { min: [2, 2, 1], max: [4, 6, 3] } }, grips = gripsOf(clip, BOUNDS);
    assert.deepEqual(grips.map(({ id }) => id), ['xmin', 'xmax', 'ymin', 'ymax', 'zmin', 'zmax']);
    assert.deepEqual(spotsOf(grips[3])[0], [3, 6, 2]);
    assert.deepEqual(moveGrip(clip, grips[3], 9).box, { min: [2, 2, 1], max: [4, 9, 3] });
    assert.deepEqual(moveGrip(clip, grips[4], 0).box, { min: [2, 2, 0], max: [4, 6, 3] });
    assert.deepEqual(clip.box, { min: [2, 2, 1], max: [4, 6, 3] }, 'moving does not change the given clip');
    assert.deepEqual(gripsOf(null, BOUNDS), []);
});

test('a pointer on an arrow\'s line grabs the handle there, in both projections', () => {
    for (const lens of [{}, { height_m: 8 }]) {
        const camera = { eye: [5, -12, 6], target: [5, 5, 0], up: [0, 0, 1], fov: 45, ...lens };
        for (const [x, y] of [[100, 100], [400, 300], [700, 500]]) {
            const seen = sight(camera, x, y, 800, 600), metres = alongSight([3, 2, 1], [1, 0, 0], seen), p = [3 + metres, 2, 1];
            // alongSight() must find the point of an axis that is nearest to the pointer's line of sight: points 1 cm to either
            // side are farther from it.
            const off = (q) => {
                const w = q.map((v, i) => v - seen.origin[i]), d = seen.direction, c = d.reduce((sum, v) => sum + v * v, 0);
                const t = w.reduce((sum, v, i) => sum + v * d[i], 0) / c;
                return Math.hypot(...w.map((v, i) => v - t * d[i]));
            };
            assert.ok(off(p) < off([p[0] + 0.01, 2, 1]) && off(p) < off([p[0] - 0.01, 2, 1]),
                `another point is nearer to the pointer at ${x},${y}`);
        }
    }
    const along = { eye: [5, -12, 1], target: [5, 5, 1], up: [0, 0, 1], fov: 45 };
    assert.equal(alongSight([5, 2, 1], [0, 1, 0], sight(along, 400, 300, 800, 600)), null, 'a line towards the eye has no grab point');
});

test('lines that reach behind the eye are cut off in front of it', () => {
    const camera = { eye: [0, 0, 0], target: [1, 0, 0], up: [0, 0, 1], fov: 45 };
    assert.equal(beforeEye(camera, [-1, 0, 0], [-2, 1, 0]), null);
    const [a, b] = beforeEye(camera, [-1, 1, 0], [1, 1, 0]);
    assert.ok(a[0] > 0 && a[0] < 0.05 && a[1] === 1);
    assert.deepEqual(b, [1, 1, 0]);
});

test('a box is moved as a whole, while its middle stays in the plant', () => {
    const clip = { box: { min: [1, 2, 1], max: [3, 6, 2] } };
    assert.deepEqual(spotsOf(wholeOf(clip))[0], [2, 4, 1.5]);
    assert.equal(wholeOf(cut('x', 3, false)), null);
    assert.equal(wholeOf(null), null);
    assert.deepEqual(moveBox(clip, [1, -1, 0.5], BOUNDS), { box: { min: [2, 1, 1.5], max: [4, 5, 2.5] } });
    const { box } = moveBox(clip, [100, -100, 0], BOUNDS);
    assert.deepEqual([box.min, box.max], [[9, -2, 1], [11, 2, 2]]);
});

test('the pointer moves a handle in the plane that faces the camera', () => {
    const camera = { eye: [0, -10, 0], target: [0, 0, 0], up: [0, 0, 1], fov: 60 };
    const [x, y, z] = facing(camera, [2, 3, 1], sight(camera, 400, 100, 800, 600));
    near(x, 0);
    near(y, 3);
    near(z, (13 * Math.tan(Math.PI / 6) * 200) / 300);
});
