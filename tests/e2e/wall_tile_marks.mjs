// SPDX-License-Identifier: GPL-3.0-or-later
// What is said on a picture over two displays, by the page and by the player: alarms wherever they are, notes, where a desk points, and a
// title of what is shown, whoever came first.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { openPage, SCREENSHOTS, shoot } from './support/browser.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { BIN, missing, TinyPlant } from './support/tiny_plant.mjs';
import { missingDisplay, savePng, startDisplay } from './support/x_display.mjs';

const absent = missing(), PLAYER = join(BIN, 'plantcast-wall');
const options = { skip: absent.length > 0 ? `not built: ${absent.join(', ')}` : false, timeout: 240000 };
const noPlayer = (existsSync(PLAYER) ? null : 'not built: plantcast-wall') ?? missingDisplay();
const [WIDTH, HEIGHT] = [640, 360], SCREEN = { viewport: { width: WIDTH, height: HEIGHT } }, FAR = [1.5, -20, 0];
// TI-2 is on the far side of E-101, on display 1; PI-1 on P-101A, on display 2.
const WALLS = `
views:
- { id: all, title: All of it, view: "group=temperature&camera=3.5,-7,1,1.5,0,0,0,0,1,30" }
walls:
- { id: wide, tile: { columns: 2, rows: 1, bezel_mm: 10, views: all } }
- { id: other, displays: [{ grid: [main], panes: [{ area: main, views: all }] }] }
`;
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
let plant, pages, crew, seq = 0;

before(async () => {
    if (options.skip)
        return;
    plant = await TinyPlant.create();
    plant.addAlarms();
    const tags = join(plant.folder, 'tags.csv'); // no alarm but ours, however busy the machine is
    writeFileSync(tags, readFileSync(tags, 'utf8').replace(/,1,90$/gm, ',600,90'));
    writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace('timeout_ms: 300', 'timeout_ms: 10000') + WALLS);
    assert.equal(plant.prepare().code, 0);
    await plant.startSim();
    await plant.startDaemon();
    for (const [tag, value] of [['TI-1', 50], ['TI-2', 20], ['PI-1', 5]])
        await plant.tell(`set ${tag} ${value}`);
});
beforeEach(async () => {
    if (options.skip)
        return;
    crew = await PlainClient.open(plant.port);
    await crew.hello();
});
afterEach(() => crew?.close());
after(() => plant?.destroy());

const said = (text) => crew.say({ seq: ++seq, ...text });
const note = (text, place) => said({ type: 'note', text, ...place });
const point = (position, wall = 'wide') => crew.say({ type: 'point', wall, display: 1, area: 'main', desk: 'Desk 2', position });
const mark = (i, text) => pages[i].page.locator('.marks .alarm', { hasText: text });
const count = (i, what) => pages[i].page.locator(what).count();

// Where a mark is on a display, in shares of its sides: beyond them where it stands on the display beside.
const placeOf = (i, what, hasText) => pages[i].page.locator(what, { hasText }).evaluate((element) =>
    ['--x', '--y'].map((name) => parseFloat(element.style.getPropertyValue(name)) / 100));

test('the first display leads and names what is shown, though another came first', options, async () => {
    const url = (display) => `http://127.0.0.1:${plant.port}/wall.html?wall=wide&display=${display}`;
    const second = await openPage(url(2), SCREEN);
    await second.page.waitForFunction(() => globalThis.wall?.panes[0]?.session?.tiles.leads);
    pages = [await openPage(url(1), SCREEN), second];
    for (const { page } of pages)
        await page.waitForFunction(() => globalThis.wall?.panes[0]?.session?.picture);
    await pages[0].page.locator('.picture > h2', { hasText: /^All of it · Temperature · data .* old$/ }).waitFor();
    assert.deepEqual(await Promise.all(pages.map(({ page }) => page.evaluate(() => globalThis.wall.panes[0].session.tiles.leads))),
        [true, false]);
});

test('alarms are marked behind something, and of a quantity that is not shown', options, async () => {
    await plant.tell('set TI-2 95');
    await mark(0, 'TI-2').and(pages[0].page.locator('.behind')).waitFor();
    await plant.tell('set PI-1 95');
    await mark(1, 'PI-1').and(pages[1].page.locator('.behind')).waitFor();
    for (const [i, text] of ['TI-2', 'PI-1'].entries()) {
        const [x, y] = await placeOf(i, '.marks .alarm', text);
        assert.ok(x > 0 && x < 1 && y > 0.2 && y < 0.8, `${text} at ${x}, ${y}`);
    }
    await pages[0].page.locator('.picture > h2', { hasText: '2 active, 2 to be acknowledged' }).waitFor();
    assert.ok(await pages[0].page.locator('.picture > h2').evaluate(({ clientHeight, scrollWidth, parentNode }) => {
        const { fontSize } = getComputedStyle(parentNode);
        return clientHeight < 2.2 * parseFloat(fontSize) && scrollWidth <= parentNode.clientWidth;
    }), 'in one line');
    assert.deepEqual(await pages[0].page.locator('.legend .end-text, .legend .keys span').allTextContents(),
        ['> 100', '< 0', 'No data', 'Uncertain']);
    const cut = await pages[0].page.locator('.legend').evaluate((legend) => {
        const { top, bottom } = legend.getBoundingClientRect();
        return [top < 0, bottom > innerHeight + 4, legend.scrollHeight > legend.clientHeight + 1];
    });
    assert.deepEqual(cut, [false, false, false]); // all displays are moved by up to 3 pixels
    for (const [i, { page }] of pages.entries())
        await shoot(page, `wall-tile-marks-${i + 1}`);
    said({ type: 'alarm', action: 'acknowledge', alarms: [['TI-2', 'H'], ['PI-1', 'H']], name: 'kim' });
    await pages[0].page.locator('.picture > h2', { hasText: '2 active, 0 to be acknowledged' }).waitFor();
    await plant.tell('set TI-2 20');
    await plant.tell('set PI-1 5');
    for (const i of [0, 1])
        await pages[i].page.waitForFunction(() => !document.querySelector('.marks .alarm'));
    await pages[0].page.locator('.picture > h2', { hasText: /^All of it · Temperature/ }).waitFor();
});

test('notes and where a desk points stand where they are', options, async () => {
    note('Manhole open', { asset: 'P-101A' });
    const { id } = await crew.text('noted');
    await pages[1].page.locator('.marks .note', { hasText: 'Manhole open' }).waitFor();
    const here = () => point([0, 0, 0.5]), pointing = setInterval(here, 1000); // it goes by itself after some seconds
    try {
        here();
        await pages[0].page.locator('.marks .pointer', { hasText: 'Desk 2' }).waitFor();
        const [x] = await placeOf(0, '.marks .pointer', 'Desk 2');
        assert.equal(await count(0, '.marks .ring'), 1);
        assert.ok(x > 0.3 && x < 1, `${x}: on E-101`);
        for (const [i, { page }] of pages.entries())
            await shoot(page, `wall-tile-notes-${i + 1}`);
    } finally {
        clearInterval(pointing);
    }
    for (const { page } of pages)
        await page.locator('.marks .pointer').waitFor({ state: 'detached' });
    said({ type: 'remove_note', id });
    await pages[1].page.locator('.marks .note', { hasText: 'Manhole open' }).waitFor({ state: 'detached' });
    point(FAR, 'other');
    await sleep(500);
    assert.equal(await count(0, '.marks .pointer') + await count(1, '.marks .pointer'), 0);
    await Promise.all(pages.map(({ close }) => close()));
});

// Of one colour on a screen: how many of its pixels, and where in the middle.
const near = (...wanted) => (...rgb) => rgb.every((value, i) => Math.abs(value - wanted[i]) <= 2);
function find(screen, isWanted) {
    const { at } = screen.grab(), found = [];
    for (let y = 0; y < HEIGHT; y++) {
        for (let x = 0; x < WIDTH; x++) {
            if (isWanted(...at(x, y)))
                found.push([x, y]);
        }
    }
    const middle = [0, 1].map((k) => found.reduce((sum, place) => sum + place[k], 0) / found.length);
    return { count: found.length, middle };
}

async function until(screens, i, colour, expected, what, ms = 120000) {
    for (const end = performance.now() + ms; ; await sleep(50)) {
        const found = find(screens[i], colour);
        if (expected(found))
            return found;
        if (performance.now() > end) {
            screens.forEach((screen, k) => savePng(screen.grab(), join(SCREENSHOTS, `wall-tile-player-failed-${k + 1}.png`)));
            assert.fail(`${what}: ${JSON.stringify(found)}`);
        }
    }
}

test('the player: the same', { ...options, skip: options.skip || (noPlayer ?? false) }, async () => {
    const PAPER = near(0xff, 0xf7, 0xd6), RING = near(0xc7, 0x0d, 0x99);
    const PRIORITY_3 = (r, g, b) => r > 225 && g > 165 && g < 205 && b < 40, hot = (r, g, b) => r > 200 && g > 120 && g < 190 && b < 110;
    const screens = [await startDisplay(WIDTH, HEIGHT), await startDisplay(WIDTH, HEIGHT)];
    const url = `http://127.0.0.1:${plant.port}/`;
    const players = screens.map((screen, i) => spawn(PLAYER, [url, '--wall', 'wide', '--display', String(i + 1)],
        { env: screen.env, stdio: 'ignore' }));
    const shot = (name) => process.env.PLANTCAST_SHOTS === '1' && screens.forEach((screen, i) =>
        savePng(screen.grab(), join(SCREENSHOTS, `wall-tile-player-${name}-${i + 1}.png`)));
    try {
        for (const i of [0, 1])
            await until(screens, i, near(0xf4, 0xf5, 0xf6), ({ count: n }) => n > 0, 'a title, a legend');
        note('Manhole open', { asset: 'P-101A' });
        await until(screens, 1, PAPER, ({ count: n }) => n > 50, 'the note');
        await plant.tell('set TI-2 95');
        await plant.tell('set PI-1 95');
        for (const i of [0, 1])
            await until(screens, i, PRIORITY_3, ({ count: n }) => n > 10, 'the ring of an alarm');
        await until(screens, 0, hot, ({ count: n }) => n > 300, 'a hot side');
        shot('alarms');
        const again = setInterval(() => point([0, 0, 0.5]), 1000); // it is shown for 4 s
        const { middle: [x] } = await until(screens, 0, RING, ({ count: n }) => n > 20, 'where the desk points');
        clearInterval(again);
        assert.ok(x > 0.3 * WIDTH && x < WIDTH, `${x}: on E-101`);
        shot('pointer');
        await until(screens, 0, RING, ({ count: n }) => n === 0, 'nowhere any more');
        for (let i = 0; i < 10; i++, await sleep(100)) {
            point([0, 0, 0.5], 'other');
            assert.equal(find(screens[0], RING).count, 0, 'what is pointed at on another wall');
        }
    } finally {
        for (const player of players) {
            const gone = new Promise((done) => player.once('exit', done));
            player.kill();
            await gone;
        }
        for (const screen of screens)
            await screen.stop();
    }
});
