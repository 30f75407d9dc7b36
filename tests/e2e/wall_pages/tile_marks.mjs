// SPDX-License-Identifier: GPL-3.0-or-later
// Marks on a picture that extends across two displays: alarms on each display, notes, the pointer of a user at the desk, and
// the title of the view. The result must not depend on which display connects first.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { afterEach, beforeEach, test } from 'node:test';
import { keepMediaQueries, openPage, pixelRatioOf, shoot } from '../support/browser.mjs';
import { PlainClient } from '../support/plain_client.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, sleep, TinyPlant } from '../support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 240000 };
const [WIDTH, HEIGHT] = [640, 360], SCREEN = { viewport: { width: WIDTH, height: HEIGHT } }, FAR = [1.5, -20, 0];
// TI-2 is on the far side of E-101, on display 1; PI-1 is on P-101A, on display 2.
const WALLS = `
views:
- { id: all, title: All of it, view: "group=temperature&camera=3.5,-7,1,1.5,0,0,0,0,1,30" }
walls:
- { id: wide, tile: { columns: 2, rows: 1, bezel_mm: 10, views: all } }
- { id: other, displays: [{ grid: [main], panes: [{ area: main, views: all }] }] }
`;
let plant, pages, crew, seq = 0;

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    plant.addAlarms();
    // lengthens timeouts, so that a busy machine has no stale or Bad readings, which would raise other alarms
    const tags = join(plant.folder, 'tags.csv');
    writeFileSync(tags, readFileSync(tags, 'utf8').replace(/,1,90$/gm, ',600,90'));
    writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace('timeout_ms: 300', 'timeout_ms: 10000') + WALLS);
    await plant.start();
    await plant.set({ 'TI-1': 50, 'TI-2': 20, 'PI-1': 5 });
});
beforeEach(async () => {
    if (options.skip)
        return;
    crew = await PlainClient.open(plant.port);
    await crew.hello();
});
afterEach(() => crew?.close());

const said = (text) => crew.say({ seq: ++seq, ...text });
const note = (text, place) => said({ type: 'note', text, ...place });
const point = (position, wall = 'wide') => crew.say({ type: 'point', wall, display: 1, area: 'main', desk: 'Desk 2', position });
const mark = (i, text) => pages[i].page.locator('.marks .alarm', { hasText: text });
const count = (i, what) => pages[i].page.locator(what).count();

// Returns the position of a mark on a display as fractions of its sides; below 0 or above 1 if it is on the neighbouring
// display.
const placeOf = (i, what, hasText) => pages[i].page.locator(what, { hasText }).evaluate((element) =>
    ['--x', '--y'].map((name) => parseFloat(element.style.getPropertyValue(name)) / 100));

test('the first display leads and titles the view, though another connected first', options, async () => {
    const url = (display) => `http://127.0.0.1:${plant.port}/wall.html?wall=wide&display=${display}`;
    const second = await openPage(url(2), SCREEN);
    await second.page.waitForFunction(() => globalThis.wall?.panes[0]?.session?.tiles.leads);
    pages = [await openPage(url(1), SCREEN, keepMediaQueries), second];
    for (const { page } of pages)
        await page.waitForFunction(() => globalThis.wall?.panes[0]?.session?.picture);
    await pages[0].page.locator('.picture > h2', { hasText: /^All of it · Temperature · data .* old$/ }).waitFor();
    assert.deepEqual(await Promise.all(pages.map(({ page }) => page.evaluate(() => globalThis.wall.panes[0].session.tiles.leads))),
        [true, false]);
});

test('hidden alarms, and alarms of quantities not shown, are marked on the right display', options, async () => {
    await plant.tell('set TI-2 95');
    await mark(0, 'TI-2').and(pages[0].page.locator('.behind')).waitFor();
    await plant.tell('set PI-1 95');
    await mark(1, 'PI-1').and(pages[1].page.locator('.behind')).waitFor();
    for (const [i, text] of ['TI-2', 'PI-1'].entries()) {
        const [x, y] = await placeOf(i, '.marks .alarm', text);
        assert.ok(x > 0 && x < 1 && y > 0.2 && y < 0.8, `the mark ${text} is at ${x}, ${y}`);
    }
    await pages[0].page.locator('.picture > h2', { hasText: '2 active, 2 unacknowledged' }).waitFor();
    await mark(1, /PI-1 95\.?0* bar/).waitFor();
    await plant.tell('set PI-1 97');
    await mark(1, /PI-1 97\.?0* bar/).waitFor();
    await plant.tell('fail PI-1');
    await mark(1, /PI-1\s*$/).waitFor();
    await plant.tell('release PI-1');
    await plant.tell('set PI-1 95');
    await mark(1, /PI-1 95\.?0* bar/).waitFor();
    assert.ok(await pages[0].page.locator('.picture > h2').evaluate(({ clientHeight, scrollWidth, parentNode }) => {
        const { fontSize } = getComputedStyle(parentNode);
        return clientHeight < 2.2 * parseFloat(fontSize) && scrollWidth <= parentNode.clientWidth;
    }), 'the heading fits in one line');
    assert.deepEqual(await pages[0].page.locator('.legend .end-text, .legend .keys span').allTextContents(),
        ['> 100', '< 0', 'No data', 'Uncertain']);
    const cut = await pages[0].page.locator('.legend').evaluate((legend) => {
        const { top, bottom } = legend.getBoundingClientRect();
        return [top < 0, bottom > innerHeight + 4, legend.scrollHeight > legend.clientHeight + 1];
    });
    // neither the mark's top, nor its bottom, nor the legend is cut off, although the burn-in protection shifts the whole
    // display by up to 3 pixels
    assert.deepEqual(cut, [false, false, false]);
    for (const [i, { page }] of pages.entries())
        await shoot(page, `wall-tile-marks-${i + 1}`);
    said({ type: 'alarm', action: 'acknowledge', alarms: [['TI-2', 'H'], ['PI-1', 'H'], ['PI-1', 'BAD']], name: 'kim' });
    await pages[0].page.locator('.picture > h2', { hasText: '2 active, 0 unacknowledged' }).waitFor();
    await plant.tell('set TI-2 20');
    await plant.tell('set PI-1 5');
    for (const i of [0, 1])
        await pages[i].page.waitForFunction(() => !document.querySelector('.marks .alarm'));
    await pages[0].page.locator('.picture > h2', { hasText: /^All of it · Temperature/ }).waitFor();
});

test('the title says whether all values or some are simulated', options, async () => {
    const title = pages[0].page.locator('.picture > h2');
    const cases = [[[true, false], / · Partly simulated$/], [[true, true], / · Simulated$/], [[false, false], / old$/]];
    for (const [simulated, text] of cases) {
        await pages[0].page.evaluate((all) => globalThis.wall.session.heard({ type: 'status', live: true,
            links: all.map((one, i) => ({ source: `plc${i}`, up: true, simulated: one })) }), simulated);
        await title.filter({ hasText: text }).waitFor();
    }
});

test('notes and the desk\'s pointer are marked at their places', options, async () => {
    note('Manhole open', { asset: 'P-101A' });
    const { id } = await crew.text('noted');
    await pages[1].page.locator('.marks .note', { hasText: 'Manhole open' }).waitFor();
    // points again every second, because the page removes the pointer after some seconds
    const here = () => point([0, 0, 0.5]), pointing = setInterval(here, 1000);
    try {
        here();
        await pages[0].page.locator('.marks .pointer', { hasText: 'Desk 2' }).waitFor();
        const [x] = await placeOf(0, '.marks .pointer', 'Desk 2');
        assert.equal(await count(0, '.marks .ring'), 1);
        assert.ok(x > 0.3 && x < 1, `the mark at ${x} is on E-101`);
        for (const [i, { page }] of pages.entries())
            await shoot(page, `wall-tile-notes-${i + 1}`);
    } finally {
        clearInterval(pointing);
    }
    for (const { page } of pages)
        await page.locator('.marks .pointer').waitFor({ state: 'detached' });
    const setRatio = await pixelRatioOf(pages[0].page);
    for (const ratio of [2, 1]) {
        await setRatio(ratio);
        await pages[0].page.waitForFunction((wanted) => globalThis.wall.panes[0].session.size.pixel_ratio === wanted, ratio);
    }
    said({ type: 'remove_note', id });
    await pages[1].page.locator('.marks .note', { hasText: 'Manhole open' }).waitFor({ state: 'detached' });
    point(FAR, 'other');
    await sleep(500);
    assert.equal(await count(0, '.marks .pointer') + await count(1, '.marks .pointer'), 0);
    await Promise.all(pages.map(({ close }) => close()));
});
