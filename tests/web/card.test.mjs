// SPDX-License-Identifier: GPL-3.0-or-later
// The position of a card: inside the picture, never over its point, at most 280 pixels high.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { cardPlace } from '../../clients/web/app/cards/card_position.js';
import { randomNumbers } from './random.mjs';

const random = randomNumbers();

test('a card opens on the side with more room', () => {
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
