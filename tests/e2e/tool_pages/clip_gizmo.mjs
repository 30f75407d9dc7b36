// SPDX-License-Identifier: GPL-3.0-or-later
// Moving a section plane or section box with the arrows drawn on the picture: on the plane, on each side of the box, and for
// the whole box; in both halves of a split picture; by mouse, keyboard and touch.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { boxes } from './boxes.mjs';
import { drawnAt, openPage, settle, shoot, TABLET, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt } from '../support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
let url, browser, page;

setUp(options.skip, async (own) => {
    url = `http://127.0.0.1:${(await boxes()).port}/`;
    browser = own(await openPage(url, { viewport: { width: 1280, height: 800 } }));
    page = browser.page;
    await waitForPicture(page);
});

const setClip = async (on, clip) => {
    await on.evaluate((value) => globalThis.plantcast.session.setParams({ clip: value }), clip);
    await on.waitForFunction((is) => document.querySelectorAll('.grip').length === is, clip?.box ? 7 : clip ? 1 : 0);
    await settle(on);
};
const readClip = (on) => on.evaluate(() => globalThis.plantcast.session.params.clip);
const readCamera = (on) => on.evaluate(() => globalThis.plantcast.session.camera);
// Returns the page position of the centre of the handle (arrow) with this id.
const gripAt = async (on, id) => {
    const box = await on.locator(`.grip[data-id="${id}"]`).boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
};

test('a section plane dragged by its arrow follows the pointer, and the camera stays', options, async () => {
    await setClip(page, { planes: [[1, 0, 0, 0.1]] });
    const camera = await readCamera(page), [x, y] = await gripAt(page, 'plane0');
    const to = await drawnAt(page, await page.evaluate(async () => { // returns the position of the handle after a drag by half a metre
        const { spotsOf } = await import('/core/clip_gizmo.js'), { grip, spot } = document.querySelector('.grip');
        const [px, py, pz] = spotsOf(grip)[spot.number];
        return [px + 0.5, py, pz];
    }));
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move((x + to.x) / 2, (y + to.y) / 2);
    await page.mouse.move(to.x, to.y);
    await page.waitForFunction(() => Math.abs(globalThis.plantcast.session.params.clip.planes[0][3] + 0.4) < 0.02);
    assert.equal(await page.locator('.cut-label').textContent(), `Keep X ≥ ${(-(await readClip(page)).planes[0][3]).toFixed(2)} m`);
    const now = await gripAt(page, 'plane0');
    assert.ok(Math.hypot(now[0] - to.x, now[1] - to.y) < 6, `the handle at ${now} is not under the pointer at ${to.x}, ${to.y}`);
    await settle(page);
    await shoot(page, 'grip-plane');
    await page.mouse.up();
    await page.mouse.move(20, 20);
    await page.waitForFunction(() => Math.abs(globalThis.plantcast.session.confirmed.clip.planes[0][3] + 0.4) < 0.02, null);
    assert.deepEqual(await readCamera(page), camera);
});

test('keys move a section plane within its range; a screen reader announces its position', options, async () => {
    const camera = await readCamera(page), slider = page.getByRole('slider', { name: 'Move the section: X' });
    const said = async (name) => Number(await slider.getAttribute(`aria-value${name}`));
    const at = await said('now');
    await slider.focus();
    await page.keyboard.press('ArrowUp');
    assert.ok(await said('now') > at);
    await page.keyboard.press('Shift+ArrowLeft');
    assert.ok(await said('now') < at);
    await page.keyboard.press('End');
    assert.equal(await said('now'), await said('max'));
    assert.equal(await slider.getAttribute('aria-valuetext'), 'Keep X ≥ 3.50 m');
    await page.keyboard.press('Home');
    assert.equal(await said('now'), await said('min'));
    assert.equal(await slider.isVisible(), true, 'the handle is still visible');
    assert.deepEqual(await readCamera(page), camera);
});

test('a section box has an arrow on each side; Escape cancels a drag', options, async () => {
    await setClip(page, { box: { min: [-0.7, -0.7, -0.7], max: [0.3, 0.7, 0.3] } });
    const shown = await page.locator('.grip').evaluateAll((all) => all.filter((e) => e.checkVisibility()).map((e) => e.dataset.id).sort());
    assert.deepEqual(shown, ['whole', 'xmax', 'xmin', 'ymax', 'ymin', 'zmax', 'zmin']);
    await shoot(page, 'grip-box');
    const was = await readClip(page), [x, y] = await gripAt(page, 'zmax');
    const lower = (by) => page.waitForFunction((z) => globalThis.plantcast.session.params.clip.box.max[2] < z, was.box.max[2] - by);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x, y + 30);
    await lower(0.03);
    await page.keyboard.press('Escape');
    assert.deepEqual(await readClip(page), was);
    await page.mouse.up();
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x, y + 30);
    await lower(0.03);
    await page.mouse.up();
    await page.keyboard.press('v');
    assert.match(await page.locator('#cut-text').textContent(), /^1\.0 × 1\.4 × \d\.\d m$/, 'the panel states the box\'s size');
    await page.keyboard.press('v');
    assert.deepEqual(browser.errors, []);
});

test('the whole box follows the pointer or the keys, and keeps its size', options, async () => {
    const box = { min: [-0.6, -0.7, -0.6], max: [0.2, 0.1, 0.2] }, middle = ({ min, max }) => min.map((m, i) => (m + max[i]) / 2);
    await setClip(page, { box });
    const camera = await readCamera(page), [x, y] = await gripAt(page, 'whole');
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 20, y - 10);
    await page.mouse.move(x + 60, y - 30);
    await page.waitForFunction((was) => globalThis.plantcast.session.params.clip.box.min.some((m, i) => Math.abs(m - was[i]) > 0.03),
        box.min);
    await settle(page);
    const now = await gripAt(page, 'whole');
    assert.ok(Math.hypot(now[0] - x - 60, now[1] - y + 30) < 6, `the handle at ${now} is not under the pointer`);
    await shoot(page, 'grip-whole');
    await page.mouse.up();
    const moved = (await readClip(page)).box;
    for (const i of [0, 1, 2])
        assert.ok(Math.abs((moved.max[i] - moved.min[i]) - 0.8) < 1e-6, 'the box keeps its size');
    await page.getByRole('button', { name: 'Move the box' }).focus();
    await page.keyboard.press('PageUp');
    assert.ok(middle((await readClip(page)).box)[2] > middle(moved)[2]);
    for (let i = 0; i < 12; i++)
        await page.keyboard.press('Shift+ArrowRight');
    const most = await page.evaluate(() => globalThis.plantcast.session.model.plant.bounds.max[0]);
    assert.ok(Math.abs(middle((await readClip(page)).box)[0] - most) < 1e-6, 'the box stays in the plant');
    assert.deepEqual(await readCamera(page), camera);
    await setClip(page, null);
});

test('in a split view the right half has arrows, too, and both halves are cut alike', options, async () => {
    await page.evaluate(() => globalThis.plantcast.session.setParams({ split: { look: 'flat' } }));
    await page.evaluate(() => globalThis.plantcast.session.setParams({ clip: { planes: [[1, 0, 0, 0.1]] } }));
    await page.waitForFunction(() => document.querySelectorAll('.grip').length === 2);
    await settle(page);
    const boxes = await page.locator('.grip').evaluateAll((all) => all.map((e) => e.getBoundingClientRect()).map((b) => b.x + b.width / 2));
    const picture = await page.locator('#viewport').boundingBox(), middle = picture.x + picture.width / 2;
    assert.ok(boxes[0] < middle && boxes[1] > middle, `the handles at ${boxes} are not on both sides of ${middle}`);
    assert.equal(await page.getByRole('slider', { name: 'Move the section: X' }).count(), 1, 'a screen reader finds one slider');
    const right = page.locator('.grip').nth(1), at = await right.boundingBox();
    const to = await page.evaluate(async () => {
        const { spotsOf } = await import('/core/clip_gizmo.js'), { grip, spot, half } = document.querySelectorAll('.grip')[1];
        const [px, py, pz] = spotsOf(grip)[spot.number], box = document.getElementById('viewport').getBoundingClientRect();
        const { projector } = await import('/core/camera.js');
        const place = projector(globalThis.plantcast.session.camera, box.width / 2, box.height)([px + 0.4, py, pz]);
        return [box.left + (half * box.width) / 2 + place[0], box.top + place[1]];
    });
    await page.mouse.move(at.x + at.width / 2, at.y + at.height / 2);
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 3 });
    await page.waitForFunction(() => Math.abs(globalThis.plantcast.session.params.clip.planes[0][3] + 0.3) < 0.02);
    await settle(page);
    await shoot(page, 'grip-split');
    await page.mouse.up();
    await page.evaluate(() => globalThis.plantcast.session.setParams({ split: null }));
    await page.waitForFunction(() => document.querySelectorAll('.grip').length === 1);
    await setClip(page, null);
    assert.deepEqual(browser.errors, []);
});

test('on a tablet a finger drags the arrow, and the camera stays', options, async () => {
    const tablet = await openPage(url, TABLET), on = tablet.page;
    await waitForPicture(on);
    await setClip(on, { planes: [[0, 0, -1, 0.2]] });
    const [x, y] = await gripAt(on, 'plane0'), camera = await readCamera(on);
    const client = await on.context().newCDPSession(on);
    const touch = (type, ...touchPoints) => client.send('Input.dispatchTouchEvent', { type, touchPoints });
    await touch('touchStart', { x, y });
    await touch('touchMove', { x: x + 4, y: y + 12 });
    await touch('touchMove', { x: x + 4, y: y + 30 });
    await on.waitForFunction(() => globalThis.plantcast.session.params.clip.planes[0][3] < 0.15);
    await settle(on);
    await shoot(on, 'grip-tablet');
    await touch('touchEnd');
    assert.deepEqual(await readCamera(on), camera);
    assert.deepEqual(tablet.errors, []);
    await tablet.close();
});
