// SPDX-License-Identifier: GPL-3.0-or-later
// Flights to a tag: from which distance and from which sides the camera may look at the tag.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { approachDistance, approaches, atDistance, distanceBounds, fillOf, silhouetteOf } from '../../clients/web/core/approach.js';
import { valid } from '../../clients/web/core/camera.js';
import { distance } from '../../clients/web/core/camera_moves.js';

const CAMERA = { eye: [30, 30, 20], target: [0, 0, 0], up: [0, 0, 1], fov: 45 }, ASPECT = 16 / 9;
const box = (x, y, z) => ({ min: [0, 0, 0], max: [x, y, z] }), WHOLE = box(60, 40, 25);
const scaled = ({ min, max }, by) => ({ min: min.map((m) => m * by), max: max.map((m) => m * by) });
const usual = { camera: CAMERA, aspect: ASPECT, whole: WHOLE, solid: false };
const SHAPES = [box(0.84, 2.24, 1.04), box(1, 1, 1), box(2, 2, 30), box(8, 8, 9), box(60, 40, 6), box(1.4, 6.9, 1.8), box(0.3, 0.3, 0.4)];

test('the camera stops at most as far away as equipment is recognisable, however long the equipment is', () => {
    const bounds = distanceBounds(WHOLE);
    assert.ok(Math.abs(approachDistance(box(1, 1, 1), bounds) - 1.1) < 1e-9, 'distance to a pump');
    assert.equal(approachDistance(box(2, 2, 30), bounds), 16, 'distance to a column');
    assert.ok(Math.abs(approachDistance(box(8, 8, 9), bounds) - 8.8) < 1e-9, 'distance to a tank');
    assert.equal(approachDistance(box(60, 40, 6), bounds), 16, 'distance to a pipe rack');
});

test('the box of the equipment fills at least 35 % of the picture from every side, on desk, tablet and phone', () => {
    for (const shape of SHAPES) {
        for (const aspect of [ASPECT, 4 / 3, 390 / 500]) {
            for (const corner of [0, 0.5, 1]) {
                const point = shape.max.map((m, i) => m * [corner, 0.5, 1][i]);
                for (const [side, camera] of approaches({ ...usual, point, box: shape, aspect }).entries())
                    assert.ok(fillOf(camera, shape, aspect) >= 0.35, `${shape.max}: side ${side}, ${fillOf(camera, shape, aspect)}`);
            }
        }
    }
});

test('the camera approaches tags alike in a plant of a few millimetres and in one of many kilometres', () => {
    for (const by of [1e-3, 1e3]) {
        for (const shape of SHAPES) {
            const there = scaled(shape, by), point = shape.max.map((m) => (m * by) / 2);
            for (const camera of approaches({ ...usual, point, box: there, whole: scaled(WHOLE, by) }))
                assert.ok(valid(camera) && fillOf(camera, there, ASPECT) >= 0.35, `${by}: ${shape.max}`);
        }
    }
});

test('an orthographic camera comes as near as a perspective one', () => {
    const parallel = { ...CAMERA, height_m: 30 }, shape = box(1.4, 6.9, 1.8);
    for (const camera of approaches({ ...usual, camera: parallel, point: [0.7, 0, 1], box: shape }))
        assert.ok(fillOf(camera, shape, ASPECT) >= 0.35 && camera.height_m > 1);
    assert.equal(atDistance(parallel, distance(parallel) / 2).height_m, 15);
});

test('every candidate view looks at the tag, from its own side first, and no two are equal', () => {
    const all = approaches({ ...usual, point: [1, 0.5, 0.5], box: box(1, 1, 1) });
    assert.ok(all[0].eye[0] > 1.5 && Math.abs(all[0].eye[1] - 0.5) < 1e-6);
    for (const one of all) {
        assert.ok(valid(one));
        assert.deepEqual(one.target, [1, 0.5, 0.5]);
    }
    for (const [i, one] of all.entries())
        assert.ok(all.slice(0, i).every(({ eye }) => Math.hypot(...eye.map((m, k) => m - one.eye[k])) > 0.1),
            `side ${i} equals an earlier one`);
});

test('no candidate camera position is inside solid equipment', () => {
    for (const shape of SHAPES) {
        for (const camera of approaches({ ...usual, solid: true, point: [shape.max[0], shape.max[1] / 2, shape.max[2] / 2], box: shape }))
            assert.ok(camera.eye.some((m, i) => m <= 0 || m >= shape.max[i]), `the camera is inside ${shape.max}: ${camera.eye}`);
    }
});

test('a thin plate is viewed from its faces first, wherever its sensor is and wherever the user looks from', () => {
    for (const thin of [0, 1, 2]) {
        const shape = box(...[10, 5, 8].map((m, i) => (i === thin ? 0.02 : m)));
        for (const eye of [[30, 0, 1], [0, 30, 1], [30, 30, 20], [-1, 30, 0], [0.1, 0, 30]]) {
            for (const along of [0.02, 0.5, 0.98]) {
                for (const across of [0, 0.5, 1]) {
                    const point = shape.max.map((m, i) => m * (i === thin ? across : along));
                    const sides = approaches({ ...usual, camera: { ...CAMERA, eye }, point, box: shape, solid: true });
                    const shown = silhouetteOf(sides[0], shape);
                    assert.ok(shown >= 0.4, `${shape.max}, ${point}, from ${eye}: ${shown}`);
                }
            }
        }
    }
});

test('a box\'s silhouette is as large as its projected area', () => {
    const from = (eye) => silhouetteOf({ eye, target: [0, 0, 0] }, box(2, 3, 4)), most = Math.hypot(12, 8, 6);
    assert.ok(Math.abs(from([9, 0, 0]) - 12 / most) < 1e-9 && Math.abs(from([0, 0, -9]) - 6 / most) < 1e-9);
    assert.ok(Math.abs(from([12, 8, 6]) - 1) < 1e-9, 'silhouette from the diagonal');
    assert.equal(silhouetteOf({ eye: [1, 0, 0], target: [0, 0, 0] }, box(0, 0, 0)), 0, 'silhouette of a point');
});
