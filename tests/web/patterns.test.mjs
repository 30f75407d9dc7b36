// SPDX-License-Identifier: GPL-3.0-or-later
// The page's colours of limit bands equal those that the server draws.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { LIMIT_BANDS } from '../../clients/web/core/legend.js';

const shaders = new URL('../../shaders/', import.meta.url);
const linesOf = (name) => readFileSync(new URL(name, shaders), 'utf8').split('\n');

test('bands of limits have the colours of shaders/maps/operator.csv', () => {
    const colours = linesOf('maps/operator.csv').filter((line) => /^\d/.test(line)).map((line) => line.split(',').map(Number));
    assert.equal(colours.length, 256);
    for (const { from, to, colour } of LIMIT_BANDS) // the middle band is lightest at its centre
        assert.deepEqual(colours[Math.floor(((from + to) / 2 + 3) / 6 * 256)], colour, `colour of the band from ${from} to ${to}`);
});
