// SPDX-License-Identifier: GPL-3.0-or-later
// Views in the browser: standard views, the parallel projection, a cut, equipment hidden and shown, and what is at a place.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { openPage, settle, shoot, view, waitForHealth, waitForPicture } from './support/browser.mjs';
import { missing, startPlant } from './support/plant.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
let plant, browser, page;

before(async () => {
    if (why)
        return;
    plant = await startPlant();
    browser = await openPage(plant.url, { viewport: { width: 1440, height: 900 } });
    page = browser.page;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    await settle(page);
});
after(async () => {
    await browser?.close();
    await plant?.stop();
});

const arrive = async () => {
    await page.waitForTimeout(1200); // flights
    await settle(page);
};

// A place in the page where equipment with a field is and no marker.
const middleOf = (id) => page.evaluate((asset) => {
    const { session } = globalThis.plantcast;
    const { min, max } = session.model.asset(asset).bounds;
    return globalThis.plantcast.overlay.pageOf(min.map((m, i) => (m + max[i]) / 2));
}, id);

test('a click tells what is there, and goes on telling it', options, async () => {
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: 'TK-101' }));
    await page.keyboard.press('f');
    await arrive();
    const at = await middleOf('TK-101');
    await page.mouse.click(at.x + 7, at.y + 7);
    await page.locator('#place').waitFor();
    await shoot(page, 'place');
    assert.match(await page.locator('#place h3').textContent(), /TK-101/);
    assert.match(await page.locator('#place .value').textContent(), /^[\d.,]+ °C$/);
    assert.match(await page.locator('#place .state').textContent(), /Between sensors|Measured here/);
    assert.ok(await page.locator('#place .nearest li').count() >= 2);
    await page.waitForTimeout(1500);
    assert.equal(await page.locator('#place').isVisible(), true, 'it stays while values come in');
    await page.keyboard.press('Escape');
    await page.waitForTimeout(1500);
    assert.equal(await page.locator('#place').isVisible(), false, 'and does not come back');
});

test('standard views and the parallel projection', options, async () => {
    // From here on values stand still, so that pictures are refined on a busy machine, too.
    await plant.freeze(await page.evaluate(() => globalThis.plantcast.session.model.tags.map((tag) => tag.name)));
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: null }));
    await page.keyboard.press('o');
    await page.keyboard.press('t');
    await arrive();
    const { camera } = await view(page);
    assert.ok(camera.height_m > 20 && camera.height_m < 200, `${camera.height_m} m`);
    assert.ok(camera.eye[2] > camera.target[2] + 20 && Math.abs(camera.eye[0] - camera.target[0]) < 1);
    assert.equal(await page.evaluate(() => globalThis.plantcast.session.picture.camera.height_m > 20), true, 'the frame says so');
    await shoot(page, 'plan');
    await page.keyboard.press('o');
    await page.keyboard.press('h');
    await arrive();
    assert.equal((await view(page)).camera.height_m, undefined);
});

test('a cut, ghosts and hidden equipment', options, async () => {
    await page.keyboard.press('v');
    await page.locator('#cut label', { hasText: 'Y' }).click();
    await settle(page);
    const { params } = await view(page);
    assert.equal(params.clip.planes.length, 1);
    assert.equal(params.clip.planes[0][1], 1);
    await page.locator('#cut-at').fill('190');
    await page.waitForTimeout(300);
    await settle(page);
    assert.notDeepEqual((await view(page)).params.clip, params.clip);
    const [legend, panel] = await Promise.all(['#legend', '#views'].map((id) => page.locator(id).boundingBox()));
    assert.ok(legend.x + legend.width <= panel.x, 'the legend is read beside the panel');
    await shoot(page, 'cut');
    await page.locator('#cut label', { hasText: 'Off' }).click();
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: 'T-101' }));
    await page.locator('#shows button', { hasText: 'Ghost' }).click();
    await settle(page);
    assert.deepEqual((await view(page)).params.ghost, ['T-101']);
    await shoot(page, 'ghost');
    await page.locator('#shows button', { hasText: 'Hide' }).click();
    await settle(page);
    assert.deepEqual((await view(page)).params.hidden, ['T-101']);
    const marked = await page.evaluate(() => globalThis.plantcast.overlay.markers.filter(({ tag }) => tag.asset === 'T-101').length);
    assert.equal(marked, 0, 'no markers on what is hidden');
    await page.locator('#show-all').click();
    await settle(page);
    assert.deepEqual((await view(page)).params.hidden, []);
    assert.deepEqual(browser.errors, []);
});
