// SPDX-License-Identifier: GPL-3.0-or-later
// Values read back from pictures with a legend strip (a printed row of colours with their values), from the pixels alone, are
// compared with the renderer's values. Sources: the picture itself, JPEGs of it, and a screenshot that was scaled, framed and
// compressed.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { setUp } from './support/set_up.mjs';
import { missing, runProgram, TinyPlant } from './support/tiny_plant.mjs';

const absent = missing();
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` :
    spawnSync('ffmpeg', ['-version']).status !== 0 ? 'not installed: ffmpeg' : false;
const MIN = 0, MAX = 100;
let plant, spots;

const file = (name) => join(plant.folder, name);
const snapshot = (name, ...more) => runProgram('plantcast', ['snapshot', plant.file, '-o', file(name), '--size', '1280x720', '--values',
    file('values.csv'), '--fit', 'E-101', '--side', 'iso', ...more], 120000);
const read = (name, ...places) => runProgram('plantcast', ['read', file(name), ...places.flat().map(String)]);
const ffmpeg = (from, to, ...more) => {
    const { status, stderr } = spawnSync('ffmpeg', ['-v', 'error', '-y', '-i', file(from), ...more, file(to)], { encoding: 'utf8' });
    assert.equal(status, 0, stderr);
};
const readings = (out) => [...out.matchAll(/^(\d+),(\d+): ([-\d.e]+) °C \(([-\d.e]+) to ([-\d.e]+)\)$/gm)]
    .map(([, x, y, value, low, high]) => ({ x: Number(x), y: Number(y), value: Number(value), low: Number(low), high: Number(high) }));

// Reads all points of `spots` from a picture; move maps a point of the original picture to this one. Returns as shares: points
// that can be read, and points whose bounds contain the true value; in percent of the range: the mean error and the mean width
// of the bounds.
function judge(name, move = ([x, y]) => [x, y]) {
    const { out } = read(name, ...spots.map(({ at }) => move(at)));
    const truth = new Map(spots.map(({ at, value }) => [move(at).join(), value]));
    const all = readings(out).map((reading) => ({ ...reading, truth: truth.get(`${reading.x},${reading.y}`) }));
    const mean = (of) => all.reduce((sum, one) => sum + of(one), 0) / all.length * 100 / (MAX - MIN);
    const held = all.filter(({ truth: is, low, high }) => is >= low && is <= high).length / all.length;
    const result = { read: all.length / spots.length, held, error: mean((one) => Math.abs(one.value - one.truth)),
        width: mean((one) => one.high - one.low) };
    console.log(`# ${name}: ${JSON.stringify(result)}`);
    return result;
}

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace('max: 100 }', 'max: 100, prepare: [gp], gp: { range_m: 2 } }'));
    writeFileSync(file('values.csv'), 'TI-1,82\nTI-2,17\nPI-1,5\n');
    assert.equal(plant.prepare().code, 0);
    const { code, err } = snapshot('whole.png', '--strip', 'legend');
    assert.equal(code, 0, err);
    // The renderer's values at 65 points of a grid. Four of the points have no legend colour, because they lie under a marker,
    // a label or an edge.
    spots = [];
    for (let x = 420; x < 900; x += 48)
        for (let y = 160; y < 600; y += 55) {
            const { out } = runProgram('plantcast', ['snapshot', plant.file, '--size', '1280x720', '--values', file('values.csv'), '--fit',
                'E-101', '--side', 'iso', '--strip', 'legend', '--pick', `${x},${y}`]);
            const pick = JSON.parse(out);
            if (typeof pick.value === 'number')
                spots.push({ at: [x, y], value: pick.value });
        }
});

test('values are read from a snapshot with a legend strip', { skip }, () => {
    assert.ok(spots.length > 20, `only ${spots.length} places with a value`);
    const { out, code } = read('whole.png', [640, 5]);
    assert.match(out, /group temperature, 0 to 100 °C/);
    assert.match(out, /640,5: this pixel's colour is not in the legend/);
    assert.equal(code, 1);
    const { read: share, held, error, width } = judge('whole.png');
    assert.ok(share > 0.9 && held > 0.97 && error < 0.4 && width < 6);
});

// ffmpeg's quality scale is inverted: 3 and 8 correspond to qualities of about 90 and 70 in other programs
for (const quality of [3, 8]) {
    test(`values are read from a JPEG of ffmpeg quality ${quality}`, { skip }, () => {
        ffmpeg('whole.png', 'whole.jpg', '-q:v', String(quality));
        const { read: share, held, error, width } = judge('whole.jpg');
        assert.ok(share > 0.9 && held > 0.95 && error < 0.8 && width < 10);
    });
}

test('values are read from a screenshot that was scaled, framed and compressed', { skip }, () => {
    const scale = 0.9, move = ([x, y]) => [Math.round(x * scale + 37), Math.round(y * scale + 61)];
    ffmpeg('whole.png', 'shot.jpg', '-vf', `scale=iw*${scale}:ih*${scale}:flags=bicubic,pad=1600:900:37:61:color=0x336699`, '-q:v', '4');
    const { read: share, held, error, width } = judge('shot.jpg', move);
    assert.ok(share > 0.9 && held > 0.95 && error < 0.8 && width < 10);
});

test('the quantity that a picture shows is named', { skip }, () => {
    for (const [show, words] of [['uncertainty', 'standard deviation'], ['blind', 'detectable hot spot']]) {
        const { code, err } = snapshot(`${show}.png`, '--strip', 'legend', '--show', show, '--interpolation', 'gp');
        assert.equal(code, 0, err);
        assert.match(read(`${show}.png`, [640, 5]).out, new RegExp(`group temperature, ${words}, `));
    }
});

test('pictures without a whole legend strip, and files that are no pictures, are refused', { skip }, () => {
    assert.equal(snapshot('bare.png').code, 0);
    const refusals = [['bare.png', /has no legend strip/], ['plant.yaml', /expected a valid PNG or JPEG file/],
        ['gone.png', /No such file/]];
    for (const [name, words] of refusals) {
        const { code, err } = read(name, [1, 1]);
        assert.notEqual(code, 0);
        assert.match(err, words);
    }
    ffmpeg('whole.png', 'cut.png', '-vf', 'crop=iw/2:ih:0:0');
    assert.match(read('cut.png', [1, 1]).err, /the picture has no legend strip/);
    ffmpeg('whole.png', 'small.png', '-vf', 'scale=iw/6:ih/6');
    assert.match(read('small.png', [1, 1]).err, /no legend strip|too damaged/);
    assert.equal(runProgram('plantcast', ['read', file('whole.png'), '1']).code, 2);
    assert.ok(existsSync(file('whole.png')));
});
