// SPDX-License-Identifier: GPL-3.0-or-later
// A value in a PLC's register appears in a browser's pixels; and recovery after the daemon died.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { isDeepStrictEqual } from 'node:util';
import { demo } from './demo.mjs';
import {
    arrive, grab, held, markers, openPage, pageOf, settle, shoot, view, waitForChange, waitForHealth, waitForPicture,
} from '../support/browser.mjs';
import { contrast, countOutside, difference, meanAround } from '../support/pixels.mjs';
import { missing } from '../support/plant.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { until } from '../support/until.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
const GROUP = 'temperature';
const SCREEN = { viewport: sweep({ width: 1920, height: 1080 }, { width: 1024, height: 640 }) };
const QUIET_MS = 1500; // longer than any picture takes to draw
let plant, browser, page;

setUp(why, async (own) => {
    plant = await demo();
    browser = own(await openPage(plant.url, SCREEN));
    page = browser.page;
});

// Returns the asset's bounding box in the picture, with a margin because encoding blurs edges.
const assetBox = (id) => page.evaluate(async (asset) => {
    const { projector } = await import('/core/camera.js');
    const { session } = globalThis.plantcast;
    const { camera, fullWidth, fullHeight } = session.picture;
    const { min, max } = session.model.asset(asset).bounds;
    const project = projector(camera, fullWidth, fullHeight);
    const places = [0, 1, 2, 3, 4, 5, 6, 7].map((n) => project([0, 1, 2].map((i) => (n & (1 << i) ? max[i] : min[i]))));
    const xs = places.map((p) => p[0]), ys = places.map((p) => p[1]);
    return { left: Math.min(...xs) - 16, right: Math.max(...xs) + 16, top: Math.min(...ys) - 16, bottom: Math.max(...ys) + 16 };
}, id);

// Waits for a complete picture of this size; previews are smaller.
const waitForWhole = (width, height) => page.waitForFunction(([w, h]) => {
    const canvas = document.getElementById('picture');
    return globalThis.plantcast.session.picture.still && canvas.width === w && canvas.height === h;
}, [width, height], { polling: 'raf' });

test('live frames arrive, and the page says that they are live', options, async () => {
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    await arrive(page);
    const picture = await grab(page);
    assert.ok(contrast(picture) > 10, `contrast of the picture is ${contrast(picture)}`);
    const box = await page.locator('#viewport').boundingBox();
    await waitForWhole(Math.round(box.width), Math.round(box.height)); // waits for a picture with one pixel per pixel of the screen
    await page.locator('#clock', { hasText: /^\w{3} \d+, \d{4} \d\d:\d\d:\d\d UTC/ }).waitFor();
    await page.locator('#age', { hasText: /^\d+(\.\d)? s$/ }).waitFor();
    await shoot(page, 'desktop');
});

test('a changed reading changes the picture at its sensor, and nowhere but on its equipment', options, async (t) => {
    await page.evaluate((group) => globalThis.plantcast.session.setParams({ group }), GROUP);
    await settle(page, QUIET_MS);
    const before = await grab(page), seen = await markers(page);
    const off = ({ x, y }) => Math.hypot(x - before.width / 2, y - before.height / 2);
    const inside = seen.filter((m) => !m.occluded && m.quality === 'good' && off(m) < before.height / 2 - 40);
    inside.sort((a, b) => off(a) - off(b));
    const one = inside[0];
    assert.ok(one, 'no sensor is visible');
    const wanted = one.value > 100 ? 40 : 160;
    t.diagnostic(`${one.name} on ${one.asset}: ${one.value} -> ${wanted}`);

    t.after(() => plant.ask(`set ${one.name} ${one.value}`));
    await plant.ask(`set ${one.name} ${wanted}`);
    await waitForChange(page, one, before, 30);
    await settle(page, QUIET_MS);
    const change = difference(before, await until('a picture in full size', async () => {
        const picture = await grab(page);
        return picture.width === before.width && picture;
    }));

    assert.ok(meanAround(change, one.x, one.y, 2) > 30, `at the sensor the colour changed by ${meanAround(change, one.x, one.y, 2)}`);
    const others = inside.filter((m) => m.asset !== one.asset);
    assert.ok(others.length >= 3, 'fewer than three other assets are visible');
    const box = await assetBox(one.asset);
    for (const other of others) {
        const here = meanAround(change, other.x, other.y, 3);
        if (other.x < box.left || other.x > box.right || other.y < box.top || other.y > box.bottom)
            assert.ok(here < 6, `the colour of ${other.name} on ${other.asset} changed by ${here}`);
    }
    assert.equal(countOutside(change, 24, box), 0, 'number of pixels that changed elsewhere');
    await page.mouse.move(one.pageX, one.pageY);
    await page.locator('#card', { hasText: new RegExp(`^${one.name}`) }).waitFor();
    await page.locator('#card .value', { hasText: new RegExp(`^${wanted}\\.\\d °C$`) }).waitFor();
    await shoot(page, 'one-reading');
});

test('mouse, wheel and keys move the camera, and the picture follows', options, async () => {
    const box = await page.locator('#viewport').boundingBox();
    const start = await view(page);
    const centre = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(...centre);
    await page.mouse.down();
    const pivot = await held(page);
    await page.mouse.move(centre[0] + 220, centre[1] + 40, { steps: 12 });
    await page.mouse.up();
    const turned = await view(page), stays = await pageOf(page, pivot);
    assert.ok(Math.hypot(stays[0] - centre[0], stays[1] - centre[1]) < 2, `the point under the pointer moved to ${stays}`);
    assert.notDeepEqual(turned.camera.eye, start.camera.eye);
    await page.mouse.wheel(0, -400);
    const distance = ({ camera }) => Math.hypot(...camera.eye.map((x, i) => x - camera.target[i]));
    const zoomed = await until('nearer', async () => {
        const now = await view(page);
        return distance(now) < distance(turned) && now;
    });
    await page.keyboard.press('ArrowRight');
    await until('another camera', async () => !isDeepStrictEqual((await view(page)).camera, zoomed.camera));
    await settle(page, QUIET_MS);
    const drawn = await page.evaluate(() => globalThis.plantcast.session.picture.camera.eye);
    (await view(page)).camera.eye.forEach((x, i) => assert.ok(Math.abs(x - drawn[i]) < 1e-3, 'the picture shows the newest camera'));
    await until('the latency', async () => Number.isFinite(parseInt(await page.locator('#latency').textContent(), 10)));
});

const codec = () => page.evaluate(() => globalThis.plantcast.session.picture.codec);
// Returns the number of tags with a good quality.
const measured = () => page.evaluate(() => globalThis.plantcast.session.model.readings.filter(({ quality }) => quality === 'good').length);
const waitForMeasured = (count) => page.waitForFunction((least) =>
    globalThis.plantcast.session.model.readings.filter(({ quality }) => quality === 'good').length >= least, count);

test('the daemon dies: a message says so and the picture stays; when the daemon returns, so does the view', options, async () => {
    // makes the page try out the browser's codecs now, so that a later try does not change the codec during the test
    await page.evaluate(async () => (await import('/app/startup.js')).probeCodecs());
    await page.evaluate(() => globalThis.plantcast.session.setParams({ distance: 'euclidean', ramp_interval: 20 }));
    await settle(page, QUIET_MS);
    const before = await grab(page), asked = await view(page), tags = await measured(), coded = await codec();
    await plant.stopDaemon('SIGKILL');
    try {
        await waitForHealth(page, 'lost');
        await page.locator('#health .words', { hasText: /^Disconnected$/ }).waitFor();
        await page.locator('#banner', { hasText: /This picture is \d+(\.\d)? s old/ }).waitFor();
        const frozen = difference(before, await grab(page));
        assert.equal(countOutside(frozen, 0, {}), 0, 'the last picture stays as it was');
        await shoot(page, 'disconnected');
    } finally {
        await plant.startDaemon();
    }
    await waitForHealth(page, 'live');
    await page.locator('#banner').waitFor({ state: 'hidden' });
    await waitForMeasured(tags);
    await settle(page, QUIET_MS);
    const now = await view(page);
    assert.deepEqual(now.camera, asked.camera);
    for (const name of ['group', 'distance', 'interpolation', 'ramp_interval', 'colormap', 'look'])
        assert.equal(now.params[name], asked.params[name], name);
    assert.equal(await codec(), coded, 'the codec is the same as before');
    const again = difference(before, await grab(page));
    assert.ok(countOutside(again, 32, {}) < again.at.length * 0.01, 'the picture is the same again');
    await shoot(page, 'reconnected');
});

test('the address keeps the view across a reload', options, async () => {
    const asked = await view(page);
    await page.waitForFunction(async () => { // waits, because the page updates its address a moment after the view
        const [{ addressOf }, { session, selection }] = [await import('/core/address.js'), globalThis.plantcast];
        return location.hash === addressOf(session, selection.tag);
    });
    await page.reload();
    await waitForPicture(page);
    await settle(page, QUIET_MS);
    const now = await view(page);
    now.camera.eye.forEach((x, i) => assert.ok(Math.abs(x - asked.camera.eye[i]) < 1e-3));
    assert.equal(now.params.distance, 'euclidean');
    assert.equal(now.params.ramp_interval, 20);
});

test('a silent PLC: the page says that there are no live data, and is live again when the PLC answers', options, async () => {
    await plant.ask('pause');
    try {
        await waitForHealth(page, 'nodata');
        await page.locator('#banner', { hasText: /No live data/i }).waitFor();
        await page.waitForFunction(() => globalThis.plantcast.session.picture.oldestAgeMs === null);
        await settle(page, QUIET_MS);
        await until('no value on the screen', async () => (await markers(page)).every((m) => m.quality === 'bad' && m.value === null));
        await shoot(page, 'no-live-data');
    } finally {
        await plant.ask('resume');
    }
    await waitForHealth(page, 'live');
});

test('the page logged no errors and requested nothing from other origins', options, async () => {
    await waitForHealth(page, 'live');
    assert.deepEqual(browser.errors, []);
});
