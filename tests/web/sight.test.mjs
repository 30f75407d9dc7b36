// SPDX-License-Identifier: GPL-3.0-or-later
// Assets that hide a tag from every side become ghosts (translucent), tested by the cases of protocol/vectors/wall/sights.json.
// If the tag is in a room, the eye moves into the room instead.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { Approach } from '../../clients/web/app/input/approach.js';
import { approaches } from '../../clients/web/core/approach.js';

const CASES = JSON.parse(readFileSync(new URL('../../protocol/vectors/wall/sights.json', import.meta.url)));
const CAMERA = { eye: [30, 30, 20], target: [0, 0, 0], up: [0, 0, 1], fov: 45 };
const TAG = { name: 'TI-1', asset: 'own', position: [1, 0.5, 0.5] }, OWN = { id: 'own', bounds: { min: [0, 0, 0], max: [1, 1, 1] } };
const CLOSE = [1, 0.5, 0.55]; // distances at a place where everything is so close to the tag that the eye has no room
const MIDDLE = [640, 360], WHOLE = { min: [0, 0, 0], max: [40, 40, 10] };
const away = ({ eye }) => Math.hypot(...eye.map((m, i) => m - TAG.position[i]));
const sides = approaches({ camera: CAMERA, point: TAG.position, box: OWN.bounds, aspect: 1280 / 720, whole: WHOLE, solid: true });

// A fake plant. before: by side, the assets that hide the tag when it is seen from there; from all other sides the tag's own
// asset hides it.
class World {
    constructor({ ghosts, before }, others = []) {
        Object.assign(this, { camera: CAMERA, params: { ghost: ghosts }, before, handlers: {}, pickSeq: 0, welcomed: true,
            model: { plant: { bounds: WHOLE }, assets: others, asset: () => OWN }, picture: { camera: CAMERA } });
        this.connection = { send: (pick) => queueMicrotask(() => this.handlers.picked({ ...this.answer(pick), purpose: 'sight' })) };
    }

    on(name, handler) { this.handlers[name] = handler; }
    setParams(change) { Object.assign(this.params, change); }

    answer({ x, y, camera }) {
        const inMiddle = Math.hypot(x - MIDDLE[0], y - MIDDLE[1]) < 1, side = this.sideOf(camera);
        const front = (this.before[side] ?? ['own']).find((id) => !this.params.ghost.includes(id));
        if (!inMiddle)
            return { asset: null, position: null };
        return front === undefined ? { asset: 'own', position: TAG.position } : { asset: front, position: front && CLOSE };
    }

    sideOf({ eye }) {
        return sides.findIndex((one) => Math.hypot(...one.eye.map((m, k) => m - eye[k])) < 1e-6);
    }
}

for (const one of CASES) {
    test(`a flight to a hidden tag, case: ${one.name}`, async () => {
        const world = new World(one), viewport = { width: 1280, height: 720, pixelOf: (x, y) => [x, y] };
        const approach = new Approach({ session: world, viewport });
        let shown = null;
        await approach.go(TAG, OWN, (camera) => { shown = world.sideOf(camera); });
        assert.equal(shown, one.side);
        assert.deepEqual(world.params.ghost, [...one.ghosts, ...one.made]);
    });
}

// Returns a plant in which the tag's own asset is a hollow sphere around the tag. Its wall of `thick` metres hides the tag from
// every eye outside the sphere.
function hollow(radius, thick, others) {
    const world = new World({ ghosts: [], before: {} }, others);
    world.answer = ({ x, y, camera }) => {
        const far = away(camera), wall = far > radius + thick ? radius + thick : far > radius ? radius : 0;
        if (Math.hypot(x - MIDDLE[0], y - MIDDLE[1]) >= 1)
            return { asset: null, position: null };
        return { asset: 'own', position: TAG.position.map((m, i) => m + (camera.eye[i] - m) * (wall / far)) };
    };
    return world;
}

async function arrivals(world) {
    const viewport = { width: 1280, height: 720, pixelOf: (x, y) => [x, y] }, cameras = [];
    await new Approach({ session: world, viewport }).go(TAG, OWN, (camera) => cameras.push(camera));
    assert.deepEqual(world.params.ghost, []);
    return cameras;
}

test('the eye enters a room whose walls hide its tag from outside', async () => {
    const outside = away(sides[0]), pump = { id: 'pump', bounds: { min: [0.4, 0.4, 0.4], max: [0.6, 0.6, 0.6] } };
    const cameras = await arrivals(hollow(0.7 * outside, 0.2 * outside, [pump])), last = cameras.at(-1);
    assert.ok(away(cameras[0]) > 0.9 * outside);
    assert.ok(away(last) < 0.7 * outside && away(last) > 0.6 * outside,
        `the eye ends ${away(last)} m from the tag, after ${outside} m outside`);
    assert.deepEqual(last.target, TAG.position);
});

test('the eye stays outside equipment that contains its tag', async () => {
    const outside = away(sides[0]);
    for (const camera of await arrivals(hollow(0.7 * outside, 0.2 * outside, [])))
        assert.ok(away(camera) > 0.9 * outside);
});
