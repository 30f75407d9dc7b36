// SPDX-License-Identifier: GPL-3.0-or-later
// Wind around a tank, from four sensors with directions to arrows: what a client receives, what the page draws, what a snapshot
// shows; and a lost direction, which leaves no arrows around its sensor.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { DESKTOP, FLYING, openPage, PHONE, settle, shoot, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { notBuilt, runProgram, TinyPlant } from '../support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
// SENSORS: bearings of the four sensors around the tank, in degrees; LOST: bearing of the sensor whose direction becomes Bad.
const SENSORS = [0, 90, 180, 270], LOST = 270;
let plant, browser;

// Returns a sphere of radius 1 with its poles on the z axis.
function tank(around = 48, up = 24) {
    const positions = [], indices = [];
    for (let j = 0; j <= up; j++)
        for (let i = 0; i <= around; i++) {
            const a = 2 * Math.PI * i / around, b = Math.PI * j / up;
            positions.push(Math.sin(b) * Math.cos(a), Math.sin(b) * Math.sin(a), Math.cos(b));
        }
    for (let j = 0; j < up; j++)
        for (let i = 0; i < around; i++) {
            const at = j * (around + 1) + i;
            indices.push(at, at + around + 1, at + 1, at + 1, at + around + 1, at + around + 2);
        }
    const bytes = Buffer.concat([Buffer.from(new Float32Array(positions).buffer), Buffer.from(new Uint16Array(indices).buffer)]);
    return JSON.stringify({
        asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ name: 'tank', mesh: 0 }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 0 }, indices: 1 }] }],
        buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }],
        bufferViews: [{ buffer: 0, byteOffset: 0, byteLength: positions.length * 4 },
            { buffer: 0, byteOffset: positions.length * 4, byteLength: indices.length * 2 }],
        accessors: [
            { bufferView: 0, componentType: 5126, count: positions.length / 3, type: 'VEC3', min: [-1, -1, -1], max: [1, 1, 1] },
            { bufferView: 1, componentType: 5123, count: indices.length, type: 'SCALAR' },
        ],
    });
}

const address = (n) => 400001 + 2 * n;
const speedTag = (degrees) => `WS-${degrees}`, bearingTag = (degrees) => `WD-${degrees}`;

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    writeFileSync(join(plant.folder, 'tank.gltf'), tank());
    writeFileSync(plant.file, `plant: { name: Wind, view: { eye: [3.2, -3.2, 1.6], target: [0, 0, 0] } }
assets:
  - { id: T-1, model: tank.gltf, up: z }
groups:
  - { id: wind, quantity: Wind, unit: m/s, min: 0, max: 12, prepare: [gp], gp: { range_m: 2 } }
sources:
  - { id: plc1, type: modbus, host: 127.0.0.1, port: ${plant.modbusPort}, poll_ms: 100, timeout_ms: 5000, byte_order: ABCD,
    address_base: 1 }
tags: tags.csv
`);
    const rows = SENSORS.flatMap((degrees, i) => {
        const a = degrees * Math.PI / 180, place = [Math.cos(a), Math.sin(a), 0].map((n) => n.toFixed(4));
        return [`${speedTag(degrees)},${address(2 * i)},Float,m/s,wind,T-1,${place},600,${bearingTag(degrees)}`,
            `${bearingTag(degrees)},${address(2 * i + 1)},Float,,,,,,,${degrees === LOST ? 2 : 600},`];
    });
    writeFileSync(join(plant.folder, 'tags.csv'),
        `Tag Name,Address,Data Type,Eng Units,Group,Asset,X,Y,Z,Stale s,Direction\n${rows.join('\n')}\n`);
    const { code, err } = plant.prepare();
    assert.equal(code, 0, err);
    await plant.startSim();
    await plant.startDaemon();
    for (const [i, degrees] of SENSORS.entries()) {
        await plant.tell(`set ${speedTag(degrees)} ${6 + 2 * i}`);
        // sets directions that run counter-clockwise around the tank, seen from above
        await plant.tell(`set ${bearingTag(degrees)} ${(360 - degrees) % 360}`);
    }
    browser = own(await openPage(`http://127.0.0.1:${plant.port}/`, { ...DESKTOP, ...FLYING }));
    await waitForPicture(browser.page);
});

// Returns the arrows that the page got with its picture, rows of [x, y, dx, dy, value, uncertain, half], and the picture's
// size. whole: false for the smaller previews of a busy machine, which have fewer arrows.
const arrows = () => browser.page.evaluate(() => {
    const { session } = globalThis.plantcast, { picture, size } = session;
    return { rows: session.markersOf(picture.seq)?.arrows ?? [], width: picture.fullWidth, height: picture.fullHeight,
        whole: picture.fullWidth === size.width && picture.fullHeight === size.height };
});
const isUnknown = ([, , dx, dy]) => dx === 0 && dy === 0;
async function until(what, good) {
    for (const end = Date.now() + 120000; ;) {
        const found = await arrows();
        if (found.whole && good(found))
            return found;
        assert.ok(Date.now() < end, `${what}: ${JSON.stringify(found)}`);
        await new Promise((done) => setTimeout(done, 100));
    }
}

test('arrows follow the wind around the tank, near sensors and away from them', options, async () => {
    // Up to two arrows may have no direction: on the tank's top, the directions of the four sensors cancel out.
    const known = ({ rows }) => rows.length > 15 && rows.filter(isUnknown).length < 3 && rows.every((row) => row[5] === 0);
    const { rows, width, height } = await until('directions known', known);
    let front = 0;
    for (const [x, y, dx, dy, value, uncertain] of rows) {
        assert.ok(value >= 6 && value <= 12 && uncertain === 0, `the speed is ${value}`);
        assert.ok(Math.hypot(dx, dy) < 1.01);
        if (Math.abs(x - width / 2) > height / 8 || Math.abs(y - height / 2) > height / 8)
            continue;
        assert.ok(dx > 0.7 && Math.abs(dy) < 0.4, `the arrow on the outside points right: at ${x}, ${y}: ${dx}, ${dy}`);
        front++;
    }
    console.log(`# ${rows.length} arrows, ${front} in front`);
    assert.ok(front > 2);
    const apart = Math.min(...rows.flatMap(([x, y], i) => rows.slice(i + 1).map(([u, v]) => Math.hypot(u - x, v - y))));
    assert.ok(apart >= Math.max(48, width / 24) - 0.2, `two arrows are only ${apart} px apart`);
});

test('the page draws the arrows, and its legend states their length', options, async () => {
    const key = browser.page.locator('.legend .arrow-key');
    await key.waitFor();
    assert.match(await key.textContent(), /12\s*m\/s/);
    await settle(browser.page);
    await shoot(browser.page, 'arrows');
    assert.deepEqual(browser.errors, []);
});

test('streaks follow the wind around the tank, move, and point the way that is seen from the front', options, async () => {
    await browser.page.evaluate(() => globalThis.plantcast.session.setParams({ arrows: 'strokes' }));
    const { rows, width, height } = await until('strokes', ({ rows: all }) => all.filter((row) => row[7] > 0).length > 60);
    const numbers = new Set(rows.map((row) => row[7] ?? 0).filter((number) => number > 0));
    const strokes = new Map([...numbers].map((number) => [number, rows.filter((row) => row[7] === number)]));
    let front = 0;
    for (const points of strokes.values()) {
        assert.ok(points.length <= 12);
        for (const [i, [x, y, toX, toY]] of points.slice(1).entries()) {
            const [px, py, fromX, fromY] = points[i], dx = (fromX + toX) / 2, dy = (fromY + toY) / 2, long = Math.hypot(x - px, y - py);
            if (long < 4 || Math.hypot(dx, dy) < 0.3)
                // skips steps that are short or whose direction points towards the viewer, as their direction in the picture is
                // inexact
                continue;
            const along = ((x - px) * dx + (y - py) * dy) / long / Math.hypot(dx, dy);
            assert.ok(along > 0.8, `the streak follows its direction: ${along} at ${px}, ${py}`);
            if (Math.abs(px - width / 2) < height / 8 && Math.abs(py - height / 2) < height / 8) {
                assert.ok(x > px, `the streak runs from ${px} to ${x}, not to the right`);
                front++;
            }
        }
    }
    console.log(`# ${strokes.size} strokes, ${rows.length} points, ${front} steps in front`);
    assert.ok(strokes.size > 8 && strokes.size <= 48 && front > 10);
    const pixels = () => browser.page.evaluate(() => {
        const canvas = document.getElementById('strokes');
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        return data.reduce((sum, value, i) => (sum * 31 + value * (i % 251)) % 1000003, 0);
    });
    const seen = new Set();
    for (const end = Date.now() + 20000; seen.size < 3; seen.add(await pixels()))
        assert.ok(Date.now() < end, 'the streaks\' dashes do not move');
    for (const points of strokes.values())
        assert.ok(points.length > 1, 'a streak has more than one point');
    // with strokes, unlike arrows, the legend has no scale that relates length to speed
    await browser.page.waitForFunction(() => !document.querySelector('.arrow-key canvas'));
    await shoot(browser.page, 'strokes');
    const answer = await fetch(`http://127.0.0.1:${plant.port}/snapshot.png?width=960&height=540&arrows=strokes`);
    const png = Buffer.from(await answer.arrayBuffer());
    assert.equal(png.readUInt32BE(16), 960);
    if (process.env.PLANTCAST_OUT)
        writeFileSync(join(process.env.PLANTCAST_OUT, 'strokes_snapshot.png'), png);
    await browser.page.evaluate(() => globalThis.plantcast.session.setParams({ arrows: 'none' }));
    await until('none', ({ rows: all }) => all.length === 0);
    await browser.page.waitForFunction(() => document.getElementById('strokes').hidden && !document.querySelector('.arrow-key'));
    await browser.page.evaluate(() => globalThis.plantcast.session.setParams({ arrows: 'arrows' }));
    await until('arrows again', ({ rows: all }) => all.length > 15 && all.every((row) => row.length === 7));
    assert.deepEqual(browser.errors, []);
});

test('the picture panel explains what arrows and streaks show, and when not to trust them', options, async () => {
    const { page } = browser;
    await page.click('#picture-toggle');
    await page.locator('#directions .note').waitFor();
    assert.match(await page.locator('#directions .note').textContent(), /Interpolated/);
    await page.locator('#directions label', { hasText: 'Streaks' }).click();
    await until('strokes', ({ rows }) => rows.some((row) => row[7] > 0));
    assert.match(await page.locator('#directions .note').textContent(), /not the paths of a fluid/);
    await shoot(page, 'strokes_panel');
    await page.locator('#directions label', { hasText: 'Arrows' }).click();
    await until('arrows', ({ rows }) => rows.length > 15 && rows.every((row) => row.length === 7));
    await page.click('#picture-toggle');
    assert.deepEqual(browser.errors, []);
});

test('where a sensor\'s direction is lost, arrows are unknown, and only there', options, async () => {
    const before = (await arrows()).rows.filter(isUnknown).length;
    await plant.tell(`fail ${bearingTag(LOST)}`);
    const { rows } = await until('more unknown', ({ rows: all }) => all.filter(isUnknown).length > before + 3);
    assert.ok(!rows.every(isUnknown));
    await settle(browser.page);
    await shoot(browser.page, 'arrows_unknown');
});

test('arrows based on uncertain readings are dashed, and the legend says so', options, async () => {
    const key = browser.page.locator('.legend .arrow-key');
    assert.doesNotMatch(await key.textContent(), /Uncertain/);
    await plant.tell('pause'); // the device stops answering: the daemon keeps showing the last values for a while, as Uncertain
    await until('uncertain', ({ rows }) => rows.some((row) => row[5]));
    await browser.page.waitForFunction(() => /Uncertain/.test(document.querySelector('.legend .arrow-key')?.textContent));
    await settle(browser.page);
    await shoot(browser.page, 'arrows_uncertain');
});

test('the explanation of the chosen Display mode stands below its buttons', options, async () => {
    const { page } = browser;
    await page.evaluate(() => globalThis.plantcast.session.setParams({ show: 'blind' }));
    await page.locator('#viewport').focus();
    await page.keyboard.press('p');
    for (const part of ['#coverage', '#directions']) {
        await page.locator(`${part} .note`).waitFor();
        const of = (selector) => page.locator(`${part} ${selector}`).boundingBox();
        const [row, note, panel] = [await of('.row'), await of('.note'), await page.locator('#picture-panel').boundingBox()];
        assert.ok(note.y >= row.y + row.height - 1, `${part}: ${JSON.stringify([row, note])}`);
        assert.ok(note.width > 200 && note.x + note.width <= panel.x + panel.width, `${part}: ${JSON.stringify([note, panel])}`);
    }
    await page.keyboard.press('Escape');
});

test('on a phone no Display choice is cut off; legends have units and no impossible values', options, async () => {
    for (const language of sweep(['de', 'ko'], ['de'])) { // German has the longer words
        const { page, errors, close } = await openPage(`http://127.0.0.1:${plant.port}/?lang=${language}`, PHONE);
        await waitForPicture(page);
        await page.locator('#picture-toggle').tap();
        await page.locator('#coverage input').nth(2).waitFor({ state: 'attached' });
        let keys = 0;
        for (const [show, sign] of [['value', /^(?!±)/], ['uncertainty', /^± /], ['blind', /: /]]) {
            await page.evaluate((what) => globalThis.plantcast.session.setParams({ show: what }), show);
            await page.waitForFunction((what) => globalThis.plantcast.session.shown?.show === what, show);
            const found = await page.evaluate(() => ({
                cut: [...document.querySelectorAll('#picture-panel .segments span, #coverage .note, #directions .note, #legend .note')]
                    .filter((e) => e.scrollWidth > e.clientWidth + 1).map((e) => e.textContent),
                title: document.querySelector('#legend h2').textContent,
                below: document.querySelectorAll('#legend .end.below').length,
                keys: document.querySelectorAll('#legend .keys canvas').length,
                why: document.querySelector('#coverage .note').textContent,
            }));
            const what = `${language}, ${show}: ${JSON.stringify(found)}`;
            assert.deepEqual(found.cut, [], what);
            assert.match(found.title, sign, what);
            assert.match(found.title, /m\/s/, what);
            assert.equal(found.below, show === 'value' ? 1 : 0, what);
            assert.equal(found.why.length > 20, show !== 'value', what);
            keys ||= found.keys;
            // values can be uncertain, and hot spots, because this plant's distances run along surfaces; other displays lack this key
            assert.equal(found.keys, show === 'uncertainty' ? keys - 1 : keys, what);
        }
        await shoot(page, `display-phone-${language}`);
        assert.deepEqual(errors, []);
        await close();
    }
});

test('new sensors are suggested at one pole, then at the other, where existing sensors see least', options, () => {
    const suggest = (...more) => runProgram('plantcast', ['sensors', 'suggest', plant.file, ...more]);
    const { code, out, err } = suggest('--add', '3', '--csv');
    assert.equal(code, 0, err);
    const [names, ...rows] = out.trim().split('\n').map((line) => line.split(','));
    assert.deepEqual(names.slice(0, 6), ['asset', 'x_m', 'y_m', 'z_m', 'blindness_before', 'blindness_after']);
    assert.equal(rows.length, 3, out);
    const heights = rows.slice(0, 2).map((row) => Number(row[3]));
    assert.ok(heights.every((z) => Math.abs(z) > 0.95) && heights[0] * heights[1] < 0, out);
    const gains = rows.map((row) => row[4] - row[5]);
    // the gains at the two poles are equal but for rounding: each is the difference of two numbers with five digits
    assert.ok(gains.every((gain, i) => gain > 0 && (i === 0 || (gain <= gains[i - 1] + 2e-5 && rows[i][4] === rows[i - 1][5]))), out);
    assert.match(suggest('--add', '1').out, /T-1/);
    for (const [wrong, why] of [[['--add', '0'], /--add/], [['--add', '1', '--group', 'nothing'], /nothing/],
        [['--add', '1', '--asset', 'X-9'], /X-9/]]) {
        const refused = suggest(...wrong);
        assert.notEqual(refused.code, 0, wrong.join(' '));
        assert.match(refused.err, why);
    }
});
