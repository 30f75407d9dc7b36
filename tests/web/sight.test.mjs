// SPDX-License-Identifier: GPL-3.0-or-later
// Assets that hide a tag from all sides become ghosts, by the cases of protocol/vectors/wall/sights.json.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { Approach } from '../../clients/web/app/input/approach.js';
import { approaches } from '../../clients/web/core/approach.js';

const CASES = JSON.parse(readFileSync(new URL('../../protocol/vectors/wall/sights.json', import.meta.url)));
const CAMERA = { eye: [30, 30, 20], target: [0, 0, 0], up: [0, 0, 1], fov: 45 };
const TAG = { name: 'TI-1', position: [1, 0.5, 0.5] }, OWN = { id: 'own', bounds: { min: [0, 0, 0], max: [1, 1, 1] } };
const MIDDLE = [640, 360];

// A fake plant: `before` lists, for some sides, the assets that hide the tag; from the other sides the tag's own asset hides it.
class World {
    constructor({ ghosts, before }) {
        Object.assign(this, { camera: CAMERA, params: { ghost: ghosts }, before, handlers: {}, pickSeq: 0, welcomed: true,
            picture: { camera: CAMERA } });
        this.connection = { send: (pick) => queueMicrotask(() => this.handlers.picked({ ...this.answer(pick), purpose: 'sight' })) };
        this.sides = approaches(CAMERA, TAG.position, OWN.bounds);
    }

    on(name, handler) { this.handlers[name] = handler; }
    setParams(change) { Object.assign(this.params, change); }

    answer({ x, y, camera }) {
        const inMiddle = Math.hypot(x - MIDDLE[0], y - MIDDLE[1]) < 1, side = this.sideOf(camera);
        const front = (this.before[side] ?? ['own']).find((id) => !this.params.ghost.includes(id));
        if (!inMiddle)
            return { asset: null, position: null };
        return front === undefined ? { asset: 'own', position: TAG.position } : { asset: front, position: front && [9, 9, 9] };
    }

    sideOf({ eye }) {
        return this.sides.findIndex((one) => Math.hypot(...one.eye.map((m, k) => m - eye[k])) < 1e-6);
    }
}

for (const one of CASES) {
    test(one.name, async () => {
        const world = new World(one), viewport = { width: 1280, height: 720, pixelOf: (x, y) => [x, y] };
        const approach = new Approach({ session: world, viewport });
        let shown = null;
        await approach.go(TAG, OWN, (camera) => { shown = world.sideOf(camera); });
        assert.equal(shown, one.side);
        assert.deepEqual(world.params.ghost, [...one.ghosts, ...one.made]);
    });
}
