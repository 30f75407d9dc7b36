// SPDX-License-Identifier: GPL-3.0-or-later
// Decluttering: which of the sensors' markers are drawn, by the rule of protocol/LABELS.md. Uses test vectors that the server
// shares, and checks properties that every choice must have.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { projector } from '../../clients/web/core/camera.js';
import { thinOut } from '../../clients/web/core/declutter.js';
import { randomNumbers } from './random.mjs';

const random = randomNumbers();

const folder = new URL('../../protocol/vectors/markers/', import.meta.url), MOST = 6, NEAR = 30;
const itemOf = ([x, y, depth, occluded, kept, held], id) =>
    ({ id, x, y, depth, occluded: Boolean(occluded), kept: Boolean(kept), held: Boolean(held) });
const ids = (items) => items.map(({ id }) => id);

for (const name of readdirSync(folder)) {
    const vector = JSON.parse(readFileSync(new URL(name, folder), 'utf8'));
    test(`markers ${name}: ${vector.what}`, () =>
        assert.deepEqual(ids(thinOut(vector.items.map(itemOf), vector.unit)), vector.drawn));
}

const crowd = (count, wide = 640, high = 360) => Array.from({ length: count }, (_, id) => itemOf([random(0, wide), random(0, high),
    random(1, 90), random(0, 1) < 0.3, random(0, 1) < 0.05, random(0, 1) < 0.3], id));
const within = (items, { x, y }, least) => items.filter((other) => Math.hypot(other.x - x, other.y - y) < least).length;

test('markers that must be drawn or stand free are never left out, and no crowd is drawn', () => {
    for (let round = 0; round < 20; round++) {
        const items = crowd(40 * (1 + round)), drawn = thinOut(items), shown = new Set(drawn), others = drawn.filter(({ kept }) => !kept);
        assert.deepEqual(ids(drawn), ids(drawn).sort((a, b) => a - b), 'drawn markers keep their order');
        for (const item of items) {
            if (shown.has(item))
                assert.ok(within(others, item, 0.4 * NEAR) <= MOST, `a crowd is drawn at marker ${item.id}`);
            else
                assert.ok(!item.kept && within(drawn, item, NEAR) >= MOST, `marker ${item.id} is left out`);
        }
    }
});

test('a second picture of the same view draws the same markers', () => {
    const items = crowd(600).map((item) => ({ ...item, held: false })), drawn = ids(thinOut(items));
    const again = items.map((item) => ({ ...item, held: drawn.includes(item.id) }));
    assert.deepEqual(ids(thinOut(again)), drawn);
});

test('hidden markers displace no visible ones', () => {
    const items = crowd(600), drawn = ids(thinOut(items)).filter((id) => !items[id].occluded);
    assert.deepEqual(ids(thinOut(items.filter(({ occluded, kept }) => !occluded || kept))).filter((id) => !items[id].occluded), drawn);
});

test('when zoomed in, all markers are drawn', () => {
    const items = crowd(900), near = items.map((item) => ({ ...item, x: 20 * item.x, y: 20 * item.y }));
    assert.ok(thinOut(items).length < 750);
    assert.equal(thinOut(near).length, 900);
});

// Two cameras look at 2,000 sensors: one turns around them by a quarter of a degree per picture; one trembles by less than a
// tenth of a pixel.
const sensors = Array.from({ length: 2000 }, () => [random(-12, 12), random(-12, 12), random(0, 10)]);
function drawnFrom(angle, before) {
    const camera = { eye: [40 * Math.cos(angle), 40 * Math.sin(angle), 20], target: [0, 0, 4], up: [0, 0, 1], fov: 45 };
    const project = projector(camera, 1280, 720);
    return new Set(ids(thinOut(sensors.map((sensor, id) => {
        const [x, y, depth] = project(sensor);
        return { id, x, y, depth, occluded: false, kept: false, held: before.has(id) };
    }))));
}

test('while the camera turns, markers do not flicker', () => {
    let before = drawnFrom(0, new Set()), changes = 0, flickers = 0, shown = 0;
    const since = new Map();
    for (let n = 1; n <= 120; n++) {
        const next = drawnFrom((n * Math.PI) / 720, before);
        shown += next.size;
        for (let id = 0; id < sensors.length; id++) {
            if (before.has(id) === next.has(id))
                continue;
            changes++;
            flickers += n - (since.get(id) ?? -100) < 4 ? 1 : 0; // changed again within four pictures
            since.set(id, n);
        }
        before = next;
    }
    const percent = ((100 * changes) / shown).toFixed(2);
    console.log(`# ${changes} changes in 120 pictures, ${percent} % a picture, ${flickers} flickers`);
    assert.ok(changes / shown < 0.02 && flickers < changes / 10);
});

// A marker that is shown stays until it is nearer to others than 0.8 of the distance required of new ones. While the camera
// trembles, a marker may therefore appear once, but not disappear.
test('while the camera trembles, no marker appears or disappears', () => {
    const changed = new Set();
    for (let angle = 1; angle <= 5; angle++) {
        let before = drawnFrom(angle, drawnFrom(angle, new Set()));
        changed.clear();
        for (let n = 0; n < 15; n++) {
            const next = drawnFrom(angle + random(-1e-4, 1e-4), before);
            for (let id = 0; id < sensors.length; id++) {
                if (before.has(id) === next.has(id))
                    continue;
                assert.ok(!changed.has(id), `marker ${id} changes a second time`);
                changed.add(id);
            }
            before = next;
        }
    }
});
