// SPDX-License-Identifier: GPL-3.0-or-later
// The page's patterns and colours of limits have the numbers that the server draws with.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { LIMIT_BANDS } from '../../clients/web/core/legend.js';
import { PATTERNS } from '../../clients/web/core/patterns.js';

const shaders = new URL('../../shaders/', import.meta.url);
const linesOf = (name) => readFileSync(new URL(name, shaders), 'utf8').split('\n');

test('patterns have the numbers of shaders/constants.glsl', () => {
    const all = linesOf('constants.glsl').map((line) => line.match(/^#define (\w+) (-?[\d.]+)$/)).filter(Boolean);
    const constants = Object.fromEntries(all.map(([, name, value]) => [name, Number(value)]));
    const found = Object.keys(constants).filter((name) => /^(PATTERN|HATCH|STIPPLE|RULE)_/.test(name));
    assert.deepEqual(Object.keys(PATTERNS).sort(), found.sort());
    for (const [name, value] of Object.entries(PATTERNS))
        assert.equal(value, constants[name], name);
});

test('bands of limits have the colours of shaders/maps/operator.csv', () => {
    const colours = linesOf('maps/operator.csv').filter((line) => /^\d/.test(line)).map((line) => line.split(',').map(Number));
    assert.equal(colours.length, 256);
    for (const { from, to, colour } of LIMIT_BANDS) // the middle one is lightest in its middle
        assert.deepEqual(colours[Math.floor(((from + to) / 2 + 3) / 6 * 256)], colour, `${from} to ${to}`);
});
