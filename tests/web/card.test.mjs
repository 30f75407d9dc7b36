// SPDX-License-Identifier: GPL-3.0-or-later
// The position of a card: inside the picture, never over its point, over as few other markers as possible, at most 280 pixels
// high.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { cardPlace } from '../../clients/web/app/cards/card_position.js';
import { randomNumbers } from './random.mjs';

const random = randomNumbers();

test('a card opens on the side with more space', () => {
    const free = { left: 8, top: 8, right: 900, bottom: 600 };
    assert.ok(cardPlace({ wide: 280, tall: 200 }, free, [700, 300]).left + 280 < 700);
    assert.ok(cardPlace({ wide: 280, tall: 200 }, free, [200, 300]).left > 200);
});

test('a card is inside the picture, never over its point, and at most 280 pixels high', () => {
    for (let round = 0; round < 2000; round++) {
        const free = { left: 8, top: random(8, 60), right: random(320, 1500), bottom: random(180, 1000) };
        const card = { wide: 280, tall: random(60, 900) }, at = [random(0, free.right), random(free.top, free.bottom)];
        const { left, top, most } = cardPlace(card, free, at), tall = Math.min(card.tall, most), what = JSON.stringify({ free, card, at });
        assert.ok(most <= 280, what);
        assert.ok(left >= free.left - 1 && left + card.wide <= free.right + 1, what);
        assert.ok(top >= free.top - 1 && top + tall <= free.bottom + 1, what);
        const over = at[0] > left && at[0] < left + card.wide && at[1] > top && at[1] < top + tall;
        assert.ok(!over, `${what} ${JSON.stringify({ left, top, most })}`);
    }
});

test('a card covers no other marker if any position beside its point is free', () => {
    const free = { left: 8, top: 8, right: 900, bottom: 600 }, card = { wide: 280, tall: 200 };
    const covered = ({ left, top }, marks) => marks.filter(([x, y]) => x > left - 12 && x < left + 292 && y > top - 12 && y < top + 212);
    const right = [[500, 300, false], [600, 250, false]], left = [[200, 300, true]];
    for (const marks of [right, left, [...right, ...left], [[500, 220, false]], [[500, 380, true], [250, 220, false]]])
        assert.deepEqual(covered(cardPlace(card, free, [400, 300], marks), marks), [], JSON.stringify(marks));
    const all = [[500, 300, true], [200, 300, false], [400, 200, true], [400, 400, true]];
    assert.deepEqual(covered(cardPlace(card, free, [400, 300], all), all), [all[1]], 'the card covers a marker rather than an alarm ring');
});

test('a card changes its side only to cover fewer markers', () => {
    const free = { left: 8, top: 8, right: 900, bottom: 600 }, card = { wide: 280, tall: 200 };
    const first = cardPlace(card, free, [440, 300]), next = cardPlace(card, free, [470, 300], [], first);
    assert.equal(next.side, first.side);
    assert.notEqual(cardPlace(card, free, [470, 300], [[600, 300, true]], next).side, next.side);
});
