// SPDX-License-Identifier: GPL-3.0-or-later
// Pins of notes: inside the picture, over no legend, no other pin and, where there is room, over no alarm ring.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { meets } from '../../clients/web/core/labels.js';
import { placePin, STEM } from '../../clients/web/core/pins.js';
import { randomNumbers } from './random.mjs';

const random = randomNumbers(), AREA = { left: 0, top: 0, right: 600, bottom: 400 };
const pin = (x, y) => ({ x, y, wide: 120, high: 20 });
const boxOf = (left, top) => ({ left, top, right: left + 120, bottom: top + 20 });

test('a pin with free space is above and to the right of its point', () =>
    assert.deepEqual(placePin(pin(200, 200), AREA, [], []), boxOf(200, 200 - STEM - 20)));

test('a pin at an edge is moved inside', () => {
    assert.deepEqual(placePin(pin(590, 200), AREA, [], []), boxOf(480, 200 - STEM - 20));
    assert.deepEqual(placePin(pin(200, 5), AREA, [], []), boxOf(200, 0));
});

test('a pin whose point is under a legend is beside the legend', () => {
    const legend = { left: 450, top: 10, right: 590, bottom: 390 }, box = placePin(pin(500, 200), AREA, [legend], []);
    assert.deepEqual(box, boxOf(450 - 2 - 120, 200 - STEM - 20));
});

test('a pin at the upper edge stays below the strip there', () =>
    assert.equal(placePin(pin(200, 20), AREA, [{ left: 0, top: 0, right: 600, bottom: 28 }], []).top, 30));

test('pins cover alarm rings only if the picture has no other space', () => {
    const rings = [];
    for (let x = 0; x < 600; x += 20)
        for (let y = 60; y < 400; y += 20)
            rings.push({ left: x, right: x + 26, top: y, bottom: y + 26 });
    assert.ok(rings.every((ring) => !meets(placePin(pin(200, 300), AREA, [], rings), ring)));
    const all = [{ left: 0, top: 0, right: 600, bottom: 400 }], fixed = [boxOf(200, 300 - STEM - 20)];
    assert.ok(!meets(placePin(pin(200, 300), AREA, fixed, all), fixed[0]), 'a pin never covers another pin');
});

test('a pin keeps a distance from its own point\'s alarm ring, so that its stem is visible', () => {
    const ring = { left: 187, top: 187, right: 213, bottom: 213 }, box = placePin(pin(200, 200), AREA, [], [ring]);
    assert.ok(box.left > ring.right + STEM - 1 || box.bottom < ring.top - STEM + 1, JSON.stringify(box));
    assert.ok(Math.hypot(box.left - 200, box.bottom - 200) < 60, 'the pin stays near its point');
});

test('a pin without free space covers as few markers as it can', () => {
    const half = { left: 0, top: 0, right: 150, bottom: 200 }, marks = [];
    for (let y = 0; y < 200; y += 18)
        // markers every 30 px, in two rows only every 100 px: there a pin must cover the fewest markers, though still one
        for (let x = 0; x < 150; x += y > 100 && y < 140 ? 100 : 30)
            marks.push({ left: x, right: x + 12, top: y, bottom: y + 12 });
    const covered = (box) => marks.filter((mark) => meets(box, mark)).length;
    const box = placePin(pin(60, 60), half, [], [], marks);
    assert.equal(covered(box), 1, JSON.stringify(box));
});

test('random pins are complete and cover neither each other nor the legend', () => {
    for (let round = 0; round < 200; round++) {
        const legend = { left: 480, top: 10, right: 590, bottom: 300 }, fixed = [legend];
        for (let n = 0; n < 8; n++) {
            const box = placePin(pin(random(0, 600), random(0, 400)), AREA, fixed, []);
            assert.ok(box.left >= 0 && box.top >= 0 && box.right <= 600 && box.bottom <= 400, JSON.stringify(box));
            assert.ok(fixed.every((other) => !meets(box, other)), JSON.stringify([box, fixed]));
            fixed.push(box);
        }
    }
});
