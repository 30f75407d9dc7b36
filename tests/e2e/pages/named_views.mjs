// SPDX-License-Identifier: GPL-3.0-or-later
// Named views, in the plant file or saved by users on the page: all users see them, in the same order, and earlier versions of
// a saved view can be restored.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { land, openPage, settle, shoot, view, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, startTiny } from '../support/tiny_plant.mjs';

const why = notBuilt();
const options = { skip: why, timeout: 200000 };
const FROM_ABOVE = 'group=temperature&colormap=turbo&camera=8,2,30,8,6,0,0,0,1,45';
let plant, browser, page;

setUp(why, async (own) => {
    plant = own(await startTiny(`views:\n- { id: above, title: From above, view: "${FROM_ABOVE}" }\n`));
    browser = own(await openPage(plant.url, { viewport: { width: 1200, height: 720 } }));
    page = browser.page;
    await waitForPicture(page);
});

const rows = (at) => at.locator('#named-list li .named-open span').allTextContents();
const isFrom = (at, eye) => at.waitForFunction((wanted) =>
    globalThis.plantcast?.session.picture?.camera.eye.every((m, i) => Math.abs(m - wanted[i]) < 0.01), eye);
const views = async () => (await (await fetch(new URL('api/v1/views', plant.url))).json()).list;

test('the views of the plant file are listed, each with its picture', options, async () => {
    await page.click('#views-toggle');
    await page.locator('#named-list li').waitFor();
    assert.deepEqual(await rows(page), ['From above']);
    await page.waitForFunction(() => document.querySelector('#named-list img').naturalWidth === 160);
    await page.evaluate(() => globalThis.plantcast.session.setParams({ clip: { planes: [[0, 0, -1, 3]] }, selected: 'E-101' }));
    await page.click('#named-list li .named-open');
    await isFrom(page, [8, 2, 30]);
    const { clip, selected, colormap } = await page.evaluate(() => globalThis.plantcast.session.params);
    assert.deepEqual([clip, selected, colormap], [null, null, 'turbo'], 'parameters of the earlier view are reset');
    assert.equal(await page.locator('#named summary').count(), 0, 'views of the plant file cannot be edited');
});

test('the current view is saved under a name, for all users', options, async () => {
    const other = await openPage(plant.url, { viewport: { width: 1200, height: 720 } });
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: 'E-101', look: 'glossy' }));
    await page.fill('#named-title', 'Tank, von Süden');
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => document.querySelectorAll('#named-list li').length === 2);
    await waitForPicture(other.page);
    await other.page.click('#views-toggle');
    await other.page.waitForFunction(() => document.querySelectorAll('#named-list li').length === 2);
    assert.deepEqual(await rows(other.page), ['From above', 'Tank, von Süden']);
    const { look } = await other.page.evaluate(() => globalThis.plantcast.session.params);
    assert.equal(look, 'default');
    await other.page.click('#named-list li:nth-child(2) .named-open');
    await other.page.waitForFunction(() => globalThis.plantcast.session.confirmed.look === 'glossy');
    await other.close();
    const [, saved] = await views();
    assert.equal(saved.id, 'tank-von-suden');
    assert.ok(saved.by && saved.time_us > 0);
});

test('an updated view keeps its earlier version, which can be restored', options, async () => {
    await page.click('#named-list li:nth-child(1) .named-open');
    await isFrom(page, [8, 2, 30]);
    await page.click('#named-list summary');
    await page.getByRole('button', { name: 'Update to current view' }).click();
    await page.waitForFunction(() => globalThis.plantcast.session.views[1].view.includes('camera=8,2,30'));
    await page.click('#named-list summary');
    await page.locator('.named-before li').waitFor();
    await settle(page);
    await shoot(page, 'named-views');
    await page.getByRole('button', { name: 'Undo' }).click();
    await page.waitForFunction(() => globalThis.plantcast.session.views[1].view.includes('look=glossy'));
    assert.equal((await views())[1].view.includes('look=glossy'), true);
});

test('an address opens a view by its name; an unknown name gets a message', options, async () => {
    const there = await openPage(`${plant.url}#view=above`, { viewport: { width: 800, height: 600 } });
    await isFrom(there.page, [8, 2, 30]);
    await there.close();
    const gone = await openPage(`${plant.url}#view=nowhere`, { viewport: { width: 800, height: 600 } });
    await gone.page.locator('#toast', { hasText: 'There is no view' }).waitFor();
    assert.match(await gone.page.locator('#toast').textContent(), /'nowhere'/);
    await gone.close();
    assert.ok((await view(page)).camera);
});

test('views are reordered and removed, and the server keeps the new order', options, async () => {
    await page.fill('#named-title', 'Second');
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => document.querySelectorAll('#named-list li').length === 3);
    await page.click('#named-list li:nth-child(3) summary');
    await page.locator('#named-list li:nth-child(3)').getByRole('button', { name: 'Up', exact: true }).click();
    await page.waitForFunction(() => globalThis.plantcast.session.views[1].id === 'second');
    await page.click('#named-list li:nth-child(2) summary');
    await page.locator('#named-list li:nth-child(2)').getByRole('button', { name: 'Remove' }).click();
    await page.waitForFunction(() => globalThis.plantcast.session.views.length === 2);
    assert.deepEqual((await views()).map(({ id }) => id), ['above', 'tank-von-suden']);
});

test('opening a view without a flight ends a flight whose module is still loading', options, async () => {
    let release;
    const held = new Promise((go) => { release = go; });
    const late = async (route) => {
        await held;
        await route.continue();
    };
    const other = await openPage(plant.url, { viewport: { width: 1200, height: 720 } }, null,
        (on) => on.route('**/camera_controller.js*', late));
    await waitForPicture(other.page);
    await other.page.evaluate(async () => {
        const { flyToTag, modules, session } = globalThis.plantcast;
        await modules.get('commands');
        flyToTag(session.model.tag('TI-1'));
        (await modules.get('views')).openNamed('above', false);
    });
    await other.page.waitForFunction(() => globalThis.plantcast.session.params.colormap === 'turbo');
    release();
    await other.page.waitForFunction(() => Boolean(globalThis.plantcast.cameraController));
    await land(other.page);
    await isFrom(other.page, [8, 2, 30]);
    await other.close();
});
