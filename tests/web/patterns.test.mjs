// SPDX-License-Identifier: GPL-3.0-or-later
// In the operator's view, the legend's colours for the bands between alarm limits equal those that the server draws.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { LIMIT_BANDS } from '../../clients/web/core/legend.js';

const shaders = new URL('../../shaders/', import.meta.url);
const linesOf = (name) => readFileSync(new URL(name, shaders), 'utf8').split('\n');

test('bands of limits have the colours of shaders/maps/operator.csv', () => {
    const colours = linesOf('maps/operator.csv').filter((line) => /^\d/.test(line)).map((line) => line.split(',').map(Number));
    assert.equal(colours.length, 256);
    // compares the colour at the centre of each band; the middle band's colour varies and is lightest there
    for (const { from, to, colour } of LIMIT_BANDS)
        assert.deepEqual(colours[Math.floor(((from + to) / 2 + 3) / 6 * 256)], colour, `colour of the band from ${from} to ${to}`);
});
