// SPDX-License-Identifier: GPL-3.0-or-later
// A tour of an operator's page: overview, alarm, flight to it, trend, past, acknowledgement, sharing. Reduced copies of its
// screenshots are in the README (deploy/pictures). With screenshots, the tour is repeated on every kind of screen;
// bench/notes/tour.md says what these show.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import {
    arrive, openPage, PHONE, SCREENSHOTS, settle, SHOOTS, TABLET, waitForHealth, waitForPicture, withPage,
} from '../support/browser.mjs';
import { missing, startPlant } from '../support/plant.mjs';
import { promise } from '../support/promise.mjs';
import { setUp } from '../support/set_up.mjs';
import { runProgram } from '../support/tiny_plant.mjs';
import { becomes } from '../support/until.mjs';

// the other tests check each step, so this tour runs only where its screenshots are taken
const why = missing() ?? (SHOOTS ? null : 'make test-long and PLANTCAST_SHOTS=1 run it');
const options = { skip: why ?? false, timeout: 280000 };
const HOT = 'TE-101', MOST_MS = 180000;
let plant, browser, page, began;

// Imports fifty minutes of history for each tag, near its present value, then freezes the simulated values, because each change
// would cause a new picture.
async function remember({ file, ask }) {
    const folder = dirname(file), now = Math.floor(Date.now() / 1000), lines = ['Tag,Time,Value,Quality'];
    const rows = readFileSync(join(folder, 'tags.csv'), 'utf8').trim().split('\n').slice(1), names = rows.map((row) => row.split(',')[0]);
    for (const [i, name] of names.entries()) {
        const value = Number(await ask(`get ${name}`));
        await ask(`set ${name} ${value}`);
        for (let s = 3000; s > 10; s -= 30)
            lines.push(`${name},${now - s},${(value * (1 + 0.01 * Math.sin(i + s / 250) * Math.min(1, s / 300))).toFixed(3)},Good`);
    }
    writeFileSync(join(folder, 'series.csv'), lines.join('\n'));
    const { code, err } = runProgram('plantcast', ['history', 'import', file, join(folder, 'series.csv')]);
    assert.equal(code, 0, err);
}

setUp(why, async (own) => {
    plant = own(await startPlant('\nalarms: local\n', remember));
    browser = own(await openPage(plant.url, { viewport: { width: 1280, height: 800 } }));
    page = browser.page;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    began = performance.now();
});

async function keep(name) {
    await arrive(page);
    if (!SHOOTS)
        return;
    mkdirSync(SCREENSHOTS, { recursive: true });
    await page.screenshot({ path: join(SCREENSHOTS, `tour-${name}.jpg`), type: 'jpeg', quality: 62 });
}

test('overview: the whole plant is shown live', options, async () => {
    await settle(page);
    assert.match(await page.locator('#health .words').textContent(), /Live|Simulated/);
    assert.ok(await page.evaluate(() => globalThis.plantcast.overlay.markers.filter(({ occluded }) => !occluded).length) > 5);
    await keep('1-overview');
});

test('a new alarm is counted at once and listed, and one click leads to its place', options, async () => {
    const limit = await page.evaluate((name) => globalThis.plantcast.session.model.tag(name).limits.HH, HOT);
    await plant.ask(`set ${HOT} ${limit + 2}`);
    await page.waitForFunction((name) => globalThis.plantcast.session.model.alarms.list().some(({ tag, kind }) =>
        tag.name === name && kind === 'HH'), HOT);
    await page.locator('#alarm-strip').click();
    const row = page.locator('#alarms-list tr', { hasText: `${HOT}High-high` });
    await row.waitFor();
    await settle(page);
    await keep('2-alarm');
    await row.locator('.alarm-go').click();
    await page.locator('#alarms-close').click();
    await page.locator('#card').waitFor();
    assert.match(await page.locator('#card h3').textContent(), new RegExp(HOT));
    await page.waitForFunction((name) => { // flown there
        const { cameraController, overlay, session } = globalThis.plantcast, marker = overlay.marker(session.model.tag(name));
        return cameraController?.fly === null && marker && !marker.occluded && marker.depth < 8;
    }, HOT);
    await keep('3-there');
});

test('the alarm\'s trend opens, and the instant before the alarm', options, async () => {
    await page.locator('#card .trend').click();
    await page.locator('#trend-chart canvas').waitFor();
    await page.waitForFunction(() => globalThis.plantcast.trends?.series.size > 0);
    await settle(page);
    await page.locator('#time-toggle').click();
    const slider = page.locator('#time-slider');
    await slider.focus();
    await page.locator('#time-span').selectOption('900');
    await slider.fill('846'); // moves the slider to 846 s after its left end; the slider spans 900 s
    await waitForHealth(page, 'past');
    await page.waitForFunction(() => globalThis.plantcast.session.picture.past);
    await page.locator('#banner', { hasText: /History/ }).waitFor();
    await settle(page);
    await becomes(async () => {
        const [banner, card, legend, picture] = await Promise.all(['#banner', '#card', '#legend', '#viewport'].map((id) =>
            page.locator(id).boundingBox()));
        return [card.y >= banner.y + banner.height && card.y + card.height <= picture.y + picture.height,
            legend.y + legend.height <= picture.y + picture.height];
    }, [true, true], 'card and legend are whole');
    await keep('4-past');
    await page.locator('#time-live').click();
    await page.waitForFunction(() => globalThis.plantcast.session.time.atUs === null && !globalThis.plantcast.session.picture.past);
    await page.locator('#trend-close').click();
    await page.locator('#time-toggle').click();
});

test('an acknowledgement is shown to everybody', options, async () => {
    await page.locator('#alarm-strip').click();
    const row = page.locator('#alarms-list tr', { hasText: `${HOT}High-high` });
    await row.locator('button[data-action="acknowledge"]').click();
    await page.waitForFunction((name) => globalThis.plantcast.session.model.alarms.list().some(({ tag, kind, state }) =>
        tag.name === name && kind === 'HH' && state === 'acknowledged'), HOT);
    await settle(page);
    await keep('5-acknowledged');
    await page.locator('#alarms-close').click();
});

test('sharing gives a link and a QR code to this view', options, async (t) => {
    await page.locator('#share-open').click();
    await page.locator('#share-code svg').waitFor();
    assert.equal(await page.locator('#share-link').inputValue(), `${plant.url}#tag=${HOT}`);
    await keep('6-share');
    const took = performance.now() - began;
    t.diagnostic(`the tour took ${(took / 1000).toFixed(0)} s`);
    promise(t, 'the tour', took, MOST_MS);
    assert.deepEqual(browser.errors, []);
});

const sized = (screen, width, height) => ({ ...screen, viewport: { width, height } });
const SCREENS = {
    'desk-1600': [sized({}, 1600, 900), ''], 'desk-1600-dark': [sized({}, 1600, 900), 'theme=dark'],
    'desk-1280': [sized({}, 1280, 800), ''], 'desk-1280-dark': [sized({}, 1280, 800), 'theme=dark'],
    'desk-german': [sized({}, 1280, 800), 'lang=de'], 'desk-korean': [sized({}, 1600, 900), 'lang=ko'],
    tablet: [TABLET, ''], 'tablet-german': [sized(TABLET, 1280, 800), 'lang=de'], 'tablet-upright': [sized(TABLET, 768, 1024), 'lang=ko'],
    phone: [PHONE, ''], 'phone-low': [sized(PHONE, 360, 640), 'lang=de'], 'phone-across': [sized(PHONE, 844, 390), 'lang=ko'],
    'zoom-200': [sized({}, 640, 400), 'lang=de'], wall: [sized({}, 1920, 1080), 'wall'],
};
// The steps of the tour: what opens a part of the page, and the part. Clicks are sent to elements that may be behind the button for more.
const press = (on, ...selectors) => on.evaluate((all) => all.forEach((one) => document.querySelector(one).click()), selectors);
const STEPS = {
    overview: [() => {}, '#viewport'],
    alarms: [(on) => press(on, '#alarm-strip'), '#alarms-list tr'],
    journal: [(on) => press(on, '#journal-tab'), '#journal-list tr'],
    card: [(on) => press(on, '#alarms-tab', '#alarms-list .alarm-go'), '#card'],
    trend: [(on) => on.evaluate((name) => globalThis.plantcast.showTrend(globalThis.plantcast.session.model.tag(name)), HOT),
        '#trend-chart canvas'],
    past: [async (on) => {
        await press(on, '#time-toggle');
        await on.locator('#time-slider').waitFor();
        await press(on, '#hold');
    }, '#banner[data-kind="past"]'],
    views: [(on) => press(on, '#time-live', '#trend-close', '#time-toggle', '#views-toggle'), '#views.open'],
    picture: [(on) => press(on, '#views-toggle', '#picture-toggle'), '#picture-panel.open'],
};

const skip = why ?? (SHOOTS ? false : 'set PLANTCAST_SHOTS=1');
test('each step of the tour opens on every kind of screen', { skip, timeout: 900000 }, async () => {
    for (const [name, [screen, query]] of Object.entries(SCREENS))
        await withPage(`${plant.url}?${query}`, screen, async (on) => {
            await waitForPicture(on);
            await on.waitForFunction(() => globalThis.plantcast.session.recorded &&
                globalThis.plantcast.session.model.alarms.list().length > 0);
            for (const [step, [open, part]] of Object.entries(STEPS).slice(0, name === 'wall' ? 1 : undefined)) {
                await open(on);
                await on.locator(part).first().waitFor();
                await arrive(on);
                await on.screenshot({ path: join(SCREENSHOTS, `tour-${name}-${step}.png`) });
            }
        });
});
