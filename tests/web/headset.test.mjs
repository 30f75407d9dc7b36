// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry for headsets: the matrices of the eyes, the wide picture that covers both eyes' views, where rays hit surfaces, and
// where a user stands.
import assert from 'node:assert/strict';
import { mock, test } from 'node:test';
import { Hands } from '../../clients/web/app/xr/hands.js';
import { Repeater } from '../../clients/web/core/requests.js';
import { projector } from '../../clients/web/core/camera.js';
import { clipOf, eyeMatrix, eyeOf, floorHit, headCamera, hitOf, isApart, panelHit, pointOf, rigAt, rigFor, standAt, wideView }
    from '../../clients/web/core/headset_views.js';
import { along, dot, length, subtract, unit } from '../../clients/web/core/vector.js';
import { moveBy } from '../../clients/web/core/warp_mesh.js';

const UP = [0, 0, 1], DEGREE = Math.PI / 180;
const isClose = (a, b, most = 1e-6) => assert.ok(length(subtract(a, b)) < most, `${a} is not ${b}`);

// Returns a projection matrix as WebXR states it, for a field of view with these tangents of its edges (those of a Quest 3, for
// example).
function projection(left, right, bottom, top, near = 0.1, far = 1000) {
    return [2 / (right - left), 0, 0, 0, 0, 2 / (top - bottom), 0, 0, (right + left) / (right - left), (top + bottom) / (top - bottom),
        -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0];
}
// Returns the matrix of a pose in the user's room: a rotation by yawDeg about the vertical axis y, and a position.
function matrix(yawDeg, [x, y, z]) {
    const c = Math.cos(yawDeg * DEGREE), s = Math.sin(yawDeg * DEGREE);
    return [c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, x, y, z, 1];
}
const LEFT = projection(-1.376, 0.839, -1.428, 0.966), RIGHT = projection(-0.839, 1.376, -1.428, 0.966);
const viewsAt = (yaw, [x, y, z], turn = 0) => [[-0.0315, LEFT, turn], [0.0315, RIGHT, -turn]].map(([side, projectionMatrix, more]) => ({
    projectionMatrix,
    transform: { matrix: matrix(yaw + more, [x + side * Math.cos(yaw * DEGREE), y, z - side * Math.sin(yaw * DEGREE)]) },
}));

// Returns a depth grid, without masks, of a flat wall at y = 5 and a board of 1 m width in front of it at y = 3.
function gridOf(camera, width, height, cellPx) {
    const columns = Math.ceil(width / cellPx), rows = Math.ceil(height / cellPx), base = 1e-3, unitOf = 2e-4, near = [];
    for (let y = 0; y < rows; y++)
        for (let x = 0; x < columns; x++) {
            const px = 2 * Math.tan(camera.fov * DEGREE / 2) / height;
            const right = ((x + 0.5) * cellPx - width / 2) * px, isBoard = Math.abs(right * 3) < 0.5;
            near.push(Math.round((1 / (isBoard ? 3 : 5) - base) / unitOf) + 1);
        }
    return { x: 0, y: 0, width, height, columns, rows, cellPx, maskSide: 4, masks: new Uint8Array(0), near,
        far: new Int16Array(near.length).fill(-1), base, unit: unitOf, levels: 4095, parallel: false };
}
const CAMERA = { eye: [0, 0, 1.6], target: [0, 2, 1.6], up: UP, fov: 100 };

test('a headset\'s camera rig is level, right-handed, and looks in the given direction', () => {
    const { at, axes: [x, y, z] } = rigAt([1, 2, 3], [0, 5, -4], UP);
    assert.deepEqual(at, [1, 2, 3]);
    isClose(x, [1, 0, 0]);
    isClose(y, UP);
    isClose(z, [0, -1, 0]);
    isClose(pointOf({ at, axes: [x, y, z] }, [0.5, 1.6, -2]), [1.5, 4, 4.6]);
    const upright = rigAt([0, 0, 0], UP, UP); // the user looks straight up
    assert.ok(upright.axes.every((axis) => Math.abs(length(axis) - 1) < 1e-9) && Math.abs(dot(upright.axes[0], UP)) < 1e-9);
});

test('a point has the device\'s clip coordinates, even beyond or behind the view', () => {
    const rig = rigAt([100000, 200000, 50], [1, 0, 0], UP), [left] = viewsAt(0, [0, 1.6, 0]), eye = eyeOf(rig, left);
    isClose(eye.at, [100000, 200000.0315, 51.6]);
    const clip = clipOf(eye, [subtract([100004, 200001, 52], eye.at), 1], 0.05), camera = [-0.9685, 0.4, -4, 1]; // in the eye's axes
    const wanted = [0, 1, 3].map((row) => camera.reduce((sum, v, i) => sum + LEFT[4 * i + row] * v, 0));
    assert.ok([0, 1, 3].every((row, i) => Math.abs(clip[row] - wanted[i]) < 1e-6), `clip coordinates are ${clip}`);
    assert.ok(clip[2] < clip[3] && clip[2] > -clip[3], 'the depth is between the nearest and the farthest');
    const [, , z, w] = clipOf(eye, [[0.02, 0, 0], 1], 0.05);
    assert.ok(z < -w, 'a point too near is not drawn');
    const [, , endless, far] = clipOf(eye, [[1, 0, 0], 0], 0.05); // distance 0 means a direction without a surface: the background
    assert.ok(endless < far && far > 0, 'an infinitely far point is not clipped');
});

test('a picture drawn for an eye at its own position and projection is unchanged', () => {
    const grid = gridOf(CAMERA, 400, 400, 8), tan = Math.tan(50 * DEGREE), own = projection(-tan, tan, -tan, tan);
    const eye = { at: CAMERA.eye, axes: [[1, 0, 0], UP, [0, -1, 0]], projection: own };
    for (const [x, y, depth] of [[10, 20, 0.2], [390, 200, 1], [200, 200, 0]])
        isClose([...moveBy(eyeMatrix(grid, CAMERA, eye, 0.05), grid, [x, y, depth]), 0], [x, y, 0]);
});

test('both eyes see a picture\'s point at its true position, with the disparity of real eyes', () => {
    const grid = gridOf(CAMERA, 1000, 1000, 8), rig = rigAt([0, 0, 0], [0, 1, 0], UP);
    const eyes = viewsAt(0, [0, 1.6, 0]).map((view) => eyeOf(rig, view));
    for (const away of [2, 20]) {
        const xs = eyes.map((eye) => moveBy(eyeMatrix(grid, CAMERA, eye, 0.05), grid, [500, 500, 1 / away])[0]);
        const truth = eyes.map((eye) => {
            const [x, , , w] = clipOf(eye, [subtract([0, away, 1.6], eye.at), 1], 0.05);
            return (x / w + 1) * 500;
        });
        assert.ok(xs.every((x, i) => Math.abs(x - truth[i]) < 1e-3), `the eyes see the point at ${xs}, not at ${truth}`);
    }
});

test('the wide picture covers what both eyes see, with a margin, even if the eyes diverge', () => {
    for (const turn of [0, 5, -5]) {
        const views = viewsAt(30, [1, 1.6, 2], turn), head = matrix(30, [1, 1.6, 2]), { fov, width, height } = wideView(head, views, 1760);
        const camera = headCamera(rigAt([0, 0, 0], [0, 1, 0], UP), head, fov), project = projector(camera, width, height);
        assert.ok(fov <= 120 && width % 2 === 0 && height % 2 === 0 && width * height <= 4.1e6,
            `the wide picture has a field of ${fov} degrees and ${width}x${height} pixels`);
        const rig = rigAt([0, 0, 0], [0, 1, 0], UP);
        for (const view of views) {
            const eye = eyeOf(rig, view), p = view.projectionMatrix;
            for (const [sx, sy] of [[-1, -1], [1, -1], [-1, 1], [1, 1]]) {
                const ray = [(sx + p[8]) / p[0], (sy + p[9]) / p[5], -1];
                const far = eye.axes.reduce((sum, axis, i) => along(sum, axis, 1e4 * ray[i]), eye.at);
                const [x, y] = project(far);
                const out = Math.max(Math.abs(x / width - 0.5), Math.abs(y / height - 0.5));
                assert.ok(out < 0.48, `head turn ${turn}: the eye's corner is at ${x} ${y} of ${width}x${height}`);
            }
        }
    }
    const level = matrix(0, [0, 0, 0]), widest = { projectionMatrix: projection(-9, 9, -9, 9), transform: { matrix: level } };
    const { fov } = wideView(level, [widest], 1000);
    assert.ok(Math.abs(fov - 120) < 1e-9, 'the field of view stays within the server\'s limit');
});

test('a new picture is requested after a step or a turn of the head, not for a tremor', () => {
    const rig = rigAt([0, 0, 0], [0, 1, 0], UP), at = (yaw, place) => headCamera(rig, matrix(yaw, place), 100), start = at(0, [0, 1.6, 0]);
    assert.equal(isApart(start, at(1, [0.01, 1.6, 0])), false);
    assert.equal(isApart(start, at(3, [0, 1.6, 0])), true);
    assert.equal(isApart(start, at(0, [0, 1.63, 0])), true);
    assert.equal(isApart(start, { ...start, up: unit([0.1, 0, 1]) }), true, 'a tilted head needs a new picture');
});

test('a user starts on the floor in front of the plant, or below a camera within it', () => {
    const bounds = { min: [0, 0, -1], max: [20, 10, 8] }, camera = { eye: [10, -40, 30], target: [10, 5, 3], up: UP, fov: 45 };
    const front = rigFor(camera, bounds, UP);
    isClose(front.at, [10, -2.5, -1]);
    isClose(front.axes[2], [0, -1, 0]);
    const inside = rigFor({ ...camera, eye: [5, 5, 4], target: [9, 5, 2] }, bounds, UP);
    isClose(inside.at, [5, 5, 2.4]);
    isClose(inside.axes[2], [-1, 0, 0]);
    isClose(rigFor({ ...camera, eye: [5, 5, 0] }, bounds, UP).at, [5, 5, -1], 1e-6);
    const above = rigFor({ ...camera, eye: [10, 4.9, 60] }, bounds, UP);
    assert.ok(above.at[1] < 0 && above.at[2] === -1 && above.axes[2][1] < -0.9, `the user stands at ${above.at}`);
    const inY = rigFor({ eye: [0, 3, 50], target: [0, 0, 0], up: [0, 1, 0], fov: 45 }, { min: [-2, 0, -2], max: [2, 4, 2] }, [0, 1, 0]);
    isClose(inY.at, [0, 0, 4.5]);
});

test('a ray hits the surface that the picture shows, wherever the ray starts', () => {
    const grid = gridOf(CAMERA, 1000, 1000, 8);
    isClose(hitOf(grid, CAMERA, [0.2, 0.3, 1.2], unit([0, 1, 0])).point, [0.2, 3, 1.2], 0.03);
    isClose(hitOf(grid, CAMERA, [0.2, 0.3, 1.2], unit([1, 2, 0.1])).point, [2.55, 5, 1.435], 0.05);
    // the ray begins behind the camera from which the depth grid was drawn
    isClose(hitOf(grid, CAMERA, [0.1, -0.5, 1.2], unit([0, 1, 0.02])).point, [0.1, 3, 1.27], 0.03);
    assert.equal(hitOf(grid, CAMERA, [0, 0.3, 1.2], [0, -1, 0]), null);
    assert.equal(hitOf(grid, CAMERA, [0, 0.3, 1.2], [1, 0, 0]), null);
    assert.ok(hitOf(grid, CAMERA, [0, 0.3, 1.2], unit([1, -0.0001, 0])) === null, 'the search ends');
});

test('invalid numbers from a broken device: every search ends, and nothing is hit', () => {
    const grid = gridOf(CAMERA, 1000, 1000, 8), bad = [NaN, Infinity, -Infinity, 1e300, 0];
    for (const one of bad)
        for (const other of bad)
            for (const i of [0, 1, 2]) {
                const spoil = (v) => v.map((value, at) => (at === i ? one : value)), direction = [other, 1, 0.1];
                const rays = [[spoil([0, 0.3, 1.2]), direction], [[0, 0.3, 1.2], spoil(direction)]];
                for (const hit of rays.map((ray) => hitOf(grid, CAMERA, ...ray)))
                    assert.ok(hit === null || hit.point.every(Number.isFinite), `${one} ${other}: ${hit?.point}`);
                assert.ok(floorHit([0, 0, 1], spoil(direction), [0, 0, 0], UP)?.every(Number.isFinite) ?? true);
                const projectionMatrix = LEFT.map((value, at) => ({ 0: one, 5: other }[at] ?? value));
                const { fov, width, height } = wideView(matrix(0, [0, 0, 0]), [{ projectionMatrix,
                    transform: { matrix: matrix(0, [0, 0, 0]) } }], 1000);
                const isAsked = fov >= 1 && fov <= 120 && width >= 16 && height >= 16 && width * height < 5e6;
                assert.ok(isAsked, `${one} ${other}: ${fov} ${width}x${height}`);
            }
});

test('the floor, the user\'s position on it, and the wrist panel are placed correctly', () => {
    isClose(floorHit([0, 0, 1.5], unit([0, 1, -1]), [9, 9, 0], UP), [0, 1.5, 0]);
    assert.equal(floorHit([0, 0, 1.5], unit([0, 1, 0.1]), [0, 0, 0], UP), null, 'a ray upwards hits no floor');
    assert.equal(floorHit([0, 0, 3], unit([0, 15, -1]), [0, 0, 0], UP), null, 'a ray that hits the floor too far away does not count');
    const rig = standAt(rigAt([5, 5, 0], [1, 0, 0], UP), [0.3, 1.7, -0.2], [8, 9, 2]);
    isClose(pointOf(rig, [0.3, 0, -0.2]), [8, 9, 2]);
    const panel = { at: [0, 1, 1], axes: [[1, 0, 0], UP, [0, -1, 0]], width: 0.4, height: 0.2 };
    assert.deepEqual(panelHit(panel, [0, 0, 1], [0, 1, 0]).map((share) => Math.round(1e6 * share) / 1e6), [0.5, 0.5]);
    assert.equal(panelHit(panel, [0, 0, 1], [0, -1, 0]), null, 'a panel behind the hand is not hit');
    assert.equal(panelHit(panel, [0.3, 0, 1], [0, 1, 0]), null, 'a ray beside the panel does not hit');
});

test('the card repeats its request if there is no answer, or if another module\'s request replaced it', () => {
    let now = 10000;
    const { mock: calls } = mock.method(performance, 'now', () => now);
    const sent = [], session = { welcomed: true, picture: {}, params: {}, pickSeq: 0, size: { width: 800, height: 600 },
        connection: { send: ({ seq }) => sent.push(seq) } };
    const hands = Object.assign(Object.create(Hands.prototype), { headset: { session, shown: { camera: CAMERA }, rig: { axes: [0, UP] } },
        asked: null, askedAt: 0, repeater: new Repeater(), card: { at: [0, 5, 1], picked: { asset: 'E-101', value: 1 } } });
    const after = (ms) => {
        now += ms;
        hands.ask();
        return sent.length;
    };
    const answer = (purpose, value) => hands.hear({ purpose, asset: 'E-101', position: [0, 5, 1], value });
    try {
        assert.deepEqual([after(0), after(1100), after(2000), after(1100)], [1, 1, 2, 2], 'an unanswered request is repeated');
        assert.deepEqual([after(4800), after(200)], [2, 3], 'waits twice as long for the answer to a repeated request');
        answer('headset again', 2);
        assert.equal(hands.card.picked.value, 2);
        assert.equal(after(1000), 4);
        answer('place', 9);
        assert.deepEqual([hands.card.picked.value, after(1100)], [2, 5], 'a replaced request is repeated');
        answer('headset again', 3);
        assert.equal(hands.card.picked.value, 3);
        after(1100);
        hands.forget();
        answer('headset again', 4);
        assert.deepEqual([hands.card, after(5000)], [null, 6], 'a new connection clears the card');
    } finally {
        calls.restore();
    }
});
