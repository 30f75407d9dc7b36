// SPDX-License-Identifier: GPL-3.0-or-later
// Alarm colours are reserved: by CIEDE2000, each differs enough from every colour of every map, for normal sight, deuteranopes
// and protanopes, and the rims of a ring are visible on each of these colours. Prints the smallest distances as a table.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { ALARM_COLOURS } from '../../clients/web/core/alarms.js';

const ROOT = new URL('../../', import.meta.url), read = (path) => readFileSync(new URL(path, ROOT), 'utf8');
// Machado, Oliveira, Fernandes 2009, severity 1; rows of a matrix on linear sRGB
const SIGHTS = {
    normal: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    deuteranope: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
    protanope: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
};
// Smallest CIEDE2000 distance allowed between an alarm colour and any colour of a map, for each kind of sight; LEAST_RIM:
// between a ring's rims and these colours; LEAST_MUTUAL: between alarm colours. The maps use nearly all hues that colour-blind
// users can tell apart: a search of sRGB in steps of 17 found no alarm colours much farther away, so rings have rims.
const LEAST = { normal: 9, deuteranope: 4.5, protanope: 4 }, LEAST_RIM = 30, LEAST_MUTUAL = 10;
const RIMS = ['#ffffff', '#1d252d'];

const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
const dot = (row, c) => row.reduce((sum, factor, i) => sum + factor * c[i], 0);

// Returns [L*, a*, b*] (D65) of an sRGB colour as perceived with this kind of sight.
function labOf(rgb, sight) {
    const linear = rgb.map((v) => (v <= 10.31475 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
    const seen = SIGHTS[sight].map((row) => Math.max(0, Math.min(1, dot(row, linear))));
    const xyz = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175], [0.0193339, 0.119192, 0.9503041]];
    const [x, y, z] = xyz.map((row, i) => dot(row, seen) / [0.95047, 1, 1.08883][i])
        .map((t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116));
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

// CIEDE2000 (Sharma, Wu, Dalal 2005).
function distance([l1, a1, b1], [l2, a2, b2]) {
    const rad = Math.PI / 180, mean7 = ((Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2) ** 7;
    const stretch = 1 + 0.5 * (1 - Math.sqrt(mean7 / (mean7 + 25 ** 7)));
    const c1 = Math.hypot(a1 * stretch, b1), c2 = Math.hypot(a2 * stretch, b2);
    const hue = (a, b) => (Math.atan2(b, a * stretch) / rad + 360) % 360, h1 = hue(a1, b1), h2 = hue(a2, b2), grey = c1 * c2 === 0;
    const turn = grey ? 0 : ((h2 - h1 + 540) % 360) - 180, far = Math.abs(h1 - h2) > 180;
    const h = grey ? h1 + h2 : (h1 + h2) / 2 + (far ? (h1 + h2 < 360 ? 180 : -180) : 0);
    const l = (l1 + l2) / 2, c = (c1 + c2) / 2, dh = 2 * Math.sqrt(c1 * c2) * Math.sin((turn / 2) * rad);
    const t = 1 - 0.17 * Math.cos((h - 30) * rad) + 0.24 * Math.cos(2 * h * rad) + 0.32 * Math.cos((3 * h + 6) * rad) -
        0.2 * Math.cos((4 * h - 63) * rad);
    const sl = 1 + (0.015 * (l - 50) ** 2) / Math.sqrt(20 + (l - 50) ** 2), sc = 1 + 0.045 * c, sh = 1 + 0.015 * c * t;
    const rt = -2 * Math.sqrt(c ** 7 / (c ** 7 + 25 ** 7)) * Math.sin(60 * rad * Math.exp(-(((h - 275) / 25) ** 2)));
    const [x, y, z] = [(l2 - l1) / sl, (c2 - c1) / sc, dh / sh];
    return Math.sqrt(x * x + y * y + z * z + rt * y * z);
}

// Returns the colours of a map, including those for values below and above its range.
function coloursOf(name) {
    const lines = read(`shaders/maps/${name}`).split('\n'), list = (text) => text.split(',').map(Number);
    const ends = lines.filter((line) => /^# (below|above) /.test(line)).map((line) => list(line.split(' ')[2]));
    // leaves out the end colours of the map "operator", whose range has no values outside
    return [...lines.filter((line) => /^\d/.test(line)).map(list), ...name === 'operator.csv' ? [] : ends];
}

const maps = Object.fromEntries(readdirSync(new URL('shaders/maps/', ROOT)).map((name) => [name.slice(0, -4), coloursOf(name)]));

test('the CIEDE2000 colour distance equals the published values', () => {
    for (const [a, b, published] of [[[50, 2.6772, -79.7751], [50, 0, -82.7485], 2.0425], [[50, 2.5, 0], [73, 25, -18], 27.1492],
        [[6.7747, -0.2908, -2.4247], [5.8714, -0.0985, -2.2286], 0.6377], [[50, 2.49, -0.001], [50, -2.49, 0.0011], 7.2195]])
        assert.ok(Math.abs(distance(a, b) - published) < 1e-4, `distance ${distance(a, b)} instead of ${published}`);
});

test('alarm colours differ enough from every colour map, for each type of colour vision', (t) => {
    for (const [map, colours] of Object.entries(maps)) {
        const row = Object.keys(SIGHTS).map((sight) => ALARM_COLOURS.map(([alarm]) => {
            const own = labOf(hex(alarm), sight), least = Math.min(...colours.map((colour) => distance(own, labOf(colour, sight))));
            assert.ok(least >= LEAST[sight], `${alarm} and ${map}, ${sight}: distance ${least}`);
            return least.toFixed(1);
        }));
        t.diagnostic(`${map.padEnd(10)} ${Object.keys(SIGHTS).map((sight, i) => `${sight}: ${row[i].join(' ')}`).join('   ')}`);
    }
});

test('one rim of an alarm ring is visible on each colour of each map', () => {
    for (const sight of Object.keys(SIGHTS)) {
        const rims = RIMS.map((rim) => labOf(hex(rim), sight));
        for (const [map, colours] of Object.entries(maps))
            for (const colour of colours) {
                const seen = labOf(colour, sight), most = Math.max(...rims.map((rim) => distance(rim, seen)));
                assert.ok(most >= LEAST_RIM, `${map} ${colour}, ${sight}: distance ${most}`);
            }
    }
});

test('the colours of alarm priorities differ enough from each other', (t) => {
    const all = Object.keys(SIGHTS).flatMap((sight) => ALARM_COLOURS.flatMap(([a], i) => ALARM_COLOURS.slice(i + 1)
        .map(([b]) => ({ sight, a, b, apart: distance(labOf(hex(a), sight), labOf(hex(b), sight)) }))));
    const [least] = all.sort((a, b) => a.apart - b.apart);
    t.diagnostic(JSON.stringify(least));
    assert.ok(least.apart >= LEAST_MUTUAL, JSON.stringify(least));
});

test('page, walls and daemon use the same alarm colours', () => {
    const colours = ALARM_COLOURS.map(([colour]) => colour), variables = colours.map((colour, i) => `--p${i + 1}: ${colour};`).join(' ');
    for (const file of ['clients/web/app/state.css', 'clients/web/wall/wall.css'])
        assert.ok(read(file).includes(variables), file);
    const rows = colours.map((colour) => `{ ${colour.match(/[\da-f]{2}/g).map((byte) => `0x${byte} / 255.0`).join(', ')} }`);
    for (const row of rows)
        assert.ok(read('server/render/overlay/overlay_markers.c').includes(row), row);
});
