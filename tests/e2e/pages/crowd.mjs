// SPDX-License-Identifier: GPL-3.0-or-later
// A hundred sensors on one side of a box: some markers are left out. A click where a marker is left out selects the surface;
// searching for its name or zooming in shows it.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, shoot, waitForHealth, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, TinyPlant } from '../support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 120000 };
const MANY = 100, ACROSS = 10, REACH_PX = 15; // REACH_PX: distance within which a click hits a marker
const TO_THE_SIDE = { eye: [3.25, 0, 0], target: [0, 0, 0], up: [0, 0, 1], fov: 45 };
let plant, browser;

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    const file = join(plant.folder, 'tags.csv'), at = (n) => ((n - (ACROSS - 1) / 2) * 0.07).toFixed(3);
    const lines = Array.from({ length: MANY }, (_, i) =>
        `X-${i},${400101 + 2 * i},Float,°C,one of many,temperature,E-101,0.5,${at(i % ACROSS)},${at(Math.floor(i / ACROSS))},9`);
    writeFileSync(file, `${readFileSync(file, 'utf8')}${lines.join('\n')}\n`);
    writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace('placement: { translate: [3', 'placement: { translate: [-3'));
    const { code, err } = plant.prepare();
    assert.equal(code, 0, err);
    await plant.startSim();
    // fixed values: each change of a value would draw a new picture
    await plant.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5, ...Object.fromEntries(lines.map((_, i) => [`X-${i}`, 50])) });
    await plant.startDaemon();
    browser = own(await openPage(`http://127.0.0.1:${plant.port}/?lang=en`, { viewport: { width: 900, height: 700 } }));
});

const look = (page) => page.evaluate((reach) => {
    const { overlay } = globalThis.plantcast, shown = new Set(overlay.markers);
    const names = (list) => list.map(({ tag }) => tag.name);
    const free = overlay.all.find((a) => !shown.has(a) && overlay.markers.every((b) => Math.hypot(a.x - b.x, a.y - b.y) > reach));
    return { all: names(overlay.all), drawn: names(overlay.markers), free: free && [free.tag.name, free.x, free.y] };
}, REACH_PX);

test('some markers of a crowd are left out, and reappear when the user zooms in', options, async () => {
    const { page } = browser;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    const goTo = async (camera) => {
        await page.evaluate((there) => globalThis.plantcast.session.setCamera(there), camera);
        await page.waitForFunction(({ eye }) => globalThis.plantcast.session.picture.camera.eye[0] === eye[0] &&
            globalThis.plantcast.overlay.all.length > 0, camera);
    };
    await goTo(TO_THE_SIDE);
    await page.waitForFunction((many) => globalThis.plantcast.overlay.all.length >= many &&
        globalThis.plantcast.overlay.markers.length < many, MANY);
    const { all, drawn, free } = await look(page);
    await shoot(page, 'crowd');
    assert.ok(drawn.length < 0.9 * all.length && drawn.length > 0.2 * all.length, `${drawn.length} of ${all.length} markers are drawn`);
    assert.ok(free, 'a left-out marker has no other beside it');
    const [name, x, y] = free, { x: left, y: top } = await page.locator('#viewport').boundingBox();
    await page.mouse.click(left + x, top + y);
    await page.locator('#place').waitFor();
    assert.equal(await page.evaluate(() => globalThis.plantcast.selection.tag), null, `the left-out marker ${name} cannot be clicked`);

    await page.evaluate((chosen) => {
        const { selection, refresh } = globalThis.plantcast;
        selection.tag = chosen;
        refresh();
    }, name);
    await page.waitForFunction((chosen) => globalThis.plantcast.overlay.markers.some(({ tag }) => tag.name === chosen), name);
    await goTo({ ...TO_THE_SIDE, eye: [1.5, 0, 0] });
    await page.waitForFunction(() => globalThis.plantcast.overlay.markers.length === globalThis.plantcast.overlay.all.length);
    assert.deepEqual(browser.errors, []);
});
