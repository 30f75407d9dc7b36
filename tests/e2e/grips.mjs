// SPDX-License-Identifier: GPL-3.0-or-later
// What is cut away, by hand: arrows on the plane and on the sides of the box, for mouse, keys and finger.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { openPage, settle, shoot, TABLET, waitForPicture } from './support/browser.mjs';
import { missing, TinyPlant } from './support/tiny_plant.mjs';

const absent = missing();
const options = { skip: absent.length > 0 ? `not built: ${absent.join(', ')}` : false, timeout: 200000 };
let plant, url, browser, page;

before(async () => {
    if (options.skip)
        return;
    plant = await TinyPlant.running();
    url = `http://127.0.0.1:${plant.port}/`;
    browser = await openPage(url, { viewport: { width: 1280, height: 800 } });
    page = browser.page;
    await waitForPicture(page);
});
after(async () => {
    await browser?.close();
    await plant?.destroy();
});

const setClip = async (on, clip) => {
    await on.evaluate((value) => globalThis.plantcast.session.setParams({ clip: value }), clip);
    await on.waitForFunction((is) => document.querySelectorAll('.grip').length === is, clip?.box ? 6 : clip ? 1 : 0);
    await settle(on);
};
const readClip = (on) => on.evaluate(() => globalThis.plantcast.session.params.clip);
const readCamera = (on) => on.evaluate(() => globalThis.plantcast.session.camera);
// Its middle in the page.
const gripAt = async (on, id) => {
    const box = await on.locator(`.grip[data-id="${id}"]`).boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
};

test('a plane is dragged by its arrow: it goes where the hand goes, and the camera stays', options, async () => {
    await setClip(page, { planes: [[1, 0, 0, 0.1]] });
    const camera = await readCamera(page), [x, y] = await gripAt(page, 'plane0');
    const to = await page.evaluate(async () => { // where the grip will be half a metre on
        const { spotsOf } = await import('/core/grips.js'), { grip, spot } = document.querySelector('.grip');
        const [px, py, pz] = spotsOf(grip)[spot.number];
        return globalThis.plantcast.overlay.pageOf([px + 0.5, py, pz]);
    });
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move((x + to.x) / 2, (y + to.y) / 2);
    await page.mouse.move(to.x, to.y);
    await page.waitForFunction(() => Math.abs(globalThis.plantcast.session.params.clip.planes[0][3] + 0.4) < 0.02);
    assert.equal(await page.locator('.cut-label').textContent(), `X ≥ ${(-(await readClip(page)).planes[0][3]).toFixed(2)} m stays`);
    const now = await gripAt(page, 'plane0');
    assert.ok(Math.hypot(now[0] - to.x, now[1] - to.y) < 6, `${now} is not under the hand at ${to.x}, ${to.y}`);
    await settle(page);
    await shoot(page, 'grip-plane');
    await page.mouse.up();
    await page.mouse.move(20, 20);
    await page.waitForFunction(() => Math.abs(globalThis.plantcast.session.confirmed.clip.planes[0][3] + 0.4) < 0.02, null);
    assert.deepEqual(await readCamera(page), camera);
});

test('keys move it, as far as it goes; a screen reader is told where it is', options, async () => {
    const camera = await readCamera(page), slider = page.getByRole('slider', { name: 'Move the cut: X' });
    const said = async (name) => Number(await slider.getAttribute(`aria-value${name}`));
    const at = await said('now');
    await slider.focus();
    await page.keyboard.press('ArrowUp');
    assert.ok(await said('now') > at);
    await page.keyboard.press('Shift+ArrowLeft');
    assert.ok(await said('now') < at);
    await page.keyboard.press('End');
    assert.equal(await said('now'), await said('max'));
    assert.equal(await slider.getAttribute('aria-valuetext'), 'X ≥ 3.50 m stays');
    await page.keyboard.press('Home');
    assert.equal(await said('now'), await said('min'));
    assert.equal(await slider.isVisible(), true, 'and is not lost');
    assert.deepEqual(await readCamera(page), camera);
});

test('a box has an arrow on each side; Escape puts back what is being dragged', options, async () => {
    await setClip(page, { box: { min: [-0.7, -0.7, -0.7], max: [0.3, 0.7, 0.3] } });
    const shown = await page.locator('.grip').evaluateAll((all) => all.filter((e) => e.checkVisibility()).map((e) => e.dataset.id).sort());
    assert.deepEqual(shown, ['xmax', 'xmin', 'ymax', 'ymin', 'zmax', 'zmin']);
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
    assert.match(await page.locator('#cut-text').textContent(), /^1\.0 × 1\.4 × \d\.\d m$/, 'the panel says how large it is');
    await page.keyboard.press('v');
    await setClip(page, null);
    assert.deepEqual(browser.errors, []);
});

test('on a tablet a finger takes the arrow, and the camera stays', options, async () => {
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
