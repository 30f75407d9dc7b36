// SPDX-License-Identifier: GPL-3.0-or-later
// A page whose main thread hangs, on an X display: a wall reports that and is reloaded, a desk only reports it, and the daemon
// logs it. Also the case that once made pages hang: alarm rings in a viewport without area.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { browserOn, openPage, SCREENSHOTS, shoot, waitForPicture } from './support/browser.mjs';
import { setUp } from './support/set_up.mjs';
import { missing, startTiny } from './support/tiny_plant.mjs';
import { missingDisplay, savePng, startDisplay } from './support/x_display.mjs';

const absent = missing();
const why = absent.length > 0 ? `not built: ${absent.join(', ')}`
    : missingDisplay() ?? (existsSync('/usr/bin/chromium') ? false : 'no chromium');
const options = { skip: why, timeout: 300000 };
const [WIDTH, HEIGHT] = [960, 540], PATIENCE_MS = 120000;
const VEIL = [0x8f, 0x13, 0x20]; // colour of the band behind the watchdog's text
const WALLS = `
views: [{ id: whole, title: Whole unit, view: "group=temperature" }]
walls:
- id: room
  displays:
  - grid: [main alarms, trend alarms]
    panes:
    - { area: main, views: [whole], on_alarm: yes }
    - { area: alarms, alarms: yes }
    - { area: trend, trend: [TI-1, TI-2], hours: 1 }
`;
let plant, display, browser, kiosk; // kiosk: the browser's page, which fills the display

async function openKiosk() {
    browser = await browserOn(display.name, `${plant.url}?wall=room&lang=en`, WIDTH, HEIGHT);
    kiosk = browser.page;
}

setUp(why, async (own) => {
    plant = own(await startTiny(WALLS));
    display = own(await startDisplay(WIDTH, HEIGHT));
    own({ close: () => browser?.close() });
    await openKiosk();
});

// Waits until the watchdog's coloured band is visible on the display (wanted true) or has disappeared (false). Returns the
// display's pixels.
async function seesVeil(wanted) {
    const end = performance.now() + PATIENCE_MS;
    for (;;) {
        const picture = display.grab(), seen = picture.at(WIDTH / 2, HEIGHT / 2 - 40).every((value, i) => Math.abs(value - VEIL[i]) < 8);
        if (seen === wanted)
            return picture;
        assert.ok(performance.now() < end, `the veil is ${wanted ? 'not seen' : 'still there'}`);
        await new Promise((done) => setTimeout(done, 100));
    }
}

// Blocks the page's main thread for ever.
const hang = (page) => page.evaluate(() => { setTimeout(() => { for (;;); }); });

test('a wall whose main thread hangs reports the hang, and shows the plant again by itself', options, async () => {
    await kiosk.waitForURL(/wall\.html/);
    await kiosk.waitForFunction(() => globalThis.wall?.session.model && document.querySelector('canvas.watches'));
    await kiosk.waitForFunction(() => document.querySelector('.pane.views iframe')?.contentWindow.plantcast?.session.picture);
    await kiosk.evaluate(() => { globalThis.wall.before = true; });
    try {
        const again = kiosk.waitForEvent('load', { predicate: (one) => /wall\.html/.test(one.url()), timeout: PATIENCE_MS });
        await hang(kiosk);
        savePng(await seesVeil(true), join(SCREENSHOTS, 'hang-wall.png'));
        await again;
        await seesVeil(false);
    } catch (error) {
        // replaces the browser, because its page may hang for ever and disturb the next tests
        await browser.close();
        await openKiosk();
        throw error;
    }
    await kiosk.waitForFunction(() => globalThis.wall?.session.model && !globalThis.wall.before);
    await kiosk.waitForFunction(() => document.querySelector('.pane.views iframe')?.contentWindow.plantcast?.session.picture);
    savePng(display.grab(), join(SCREENSHOTS, 'hang-wall-again.png'));
    assert.match(kiosk.url(), /wall\.html\?wall=room&lang=en$/);
});

test('a desk page that hangs reports the hang until it responds; the daemon logs that the page acknowledges nothing', options, async () => {
    await kiosk.goto(`${plant.url}?lang=de`);
    await waitForPicture(kiosk);
    await kiosk.waitForFunction(() => document.querySelector('canvas.watches'));
    let answer, moving;
    const released = new Promise((done) => { answer = done; });
    try {
        await kiosk.route('**/busy', async (route) => { await released; await route.fulfill({ body: '' }); });
        await kiosk.evaluate(() => { // blocks the page's main thread until the request is answered
            setTimeout(() => {
                const request = new XMLHttpRequest();
                request.open('GET', '/busy', false);
                request.send();
            });
        });
        moving = setInterval(() => plant.ask(`set TI-1 ${20 + 30 * Math.random()}`).catch(() => {}), 500);
        savePng(await seesVeil(true), join(SCREENSHOTS, 'hang-desk.png'));
        await plant.logged(/session \d+ \(127\.0\.0\.1\): no picture acknowledged for 8 s/);
        answer();
        await seesVeil(false);
        savePng(display.grab(), join(SCREENSHOTS, 'hang-desk-again.png'));
    } finally {
        clearInterval(moving);
        answer();
        await kiosk.goto('about:blank').catch(() => {}); // draws nothing during the next test
    }
});

// Draws the alarm call-outs in the page (no selector), or in the panes of a wall (selector of their frames), after loading the
// module for them. Never returns if the page hangs.
const drawCallouts = (page, selector) => page.evaluate(async (which) => {
    const windows = which ? [...document.querySelectorAll(which)].map((frame) => frame.contentWindow) : [globalThis];
    for (const { plantcast } of windows) {
        await plantcast.modules.get('callouts');
        for (let n = 0; n < 3; n++) {
            plantcast.refresh();
            await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
        }
    }
}, selector);

test('a display with a trend and alarms, and a desk page with almost no height, do not hang', options, async () => {
    for (const [tag, value] of [['TI-1', 95], ['TI-2', 96], ['PI-1', 95]])
        await plant.ask(`set ${tag} ${value}`);
    const wall = await openPage(`${plant.url}?wall=room`, { viewport: { width: WIDTH, height: HEIGHT } });
    await wall.page.waitForFunction(() => globalThis.wall?.session.model?.alarms.list().length >= 3);
    await wall.page.waitForFunction(() => document.querySelectorAll('.pane iframe').length === 2 &&
        [...document.querySelectorAll('.pane iframe')].every(({ contentWindow: { plantcast } }) =>
            plantcast?.modules && plantcast.session.picture && plantcast.session.model.alarms.list().length >= 3));
    await drawCallouts(wall.page, '.pane iframe');
    await shoot(wall.page, 'hang-wall-alarms');
    await wall.close();
    const desk = await openPage(plant.url, { viewport: { width: 844, height: 150 } }), { page } = desk;
    await waitForPicture(page);
    for (const height of [150, 100, 40]) { // the last window heights leave a viewport of height 0
        await page.setViewportSize({ width: 844, height });
        await drawCallouts(page, null);
        await shoot(page, `hang-desk-844x${height}`);
    }
    assert.deepEqual(desk.errors, []);
    await desk.close();
});
