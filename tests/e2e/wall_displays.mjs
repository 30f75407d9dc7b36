// SPDX-License-Identifier: GPL-3.0-or-later
// Displays of a control room, as `walls` of the plant file has them: each pane, an alarm that takes the place of a view, and a lost server.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { openPage, shoot } from './support/browser.mjs';
import { missing, startPlant } from './support/plant.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 300000 };
const WALLS = `
views:
- { id: whole, title: Whole unit, view: "group=temperature" }
- { id: above, title: From above, view: "group=temperature&camera=8,2,30,8,6,0,0,0,1,45" }
tours:
- id: round
  stops:
  - { view: above, dwell_s: 4, text: Seen from the stack }
  - { view: whole, dwell_s: 6 }
walls:
- id: room
  inches: 55
  distance_m: 3
  displays:
  - grid: [main main alarms, main main tiles, main main clock]
    panes:
    - { area: main, views: [whole, above], every_s: 5, on_alarm: yes }
    - { area: alarms, alarms: yes }
    - { area: tiles, title: Feed, tiles: [TE-171, TE-172, PT-101, PT-102] }
    - { area: clock, clock: yes }
  - grid: [top, bottom]
    panes:
    - { area: top, trend: [TE-171, TE-172], hours: 1 }
    - { area: bottom, title: To do, text: [Check P-101A, Clean F-101] }
  - grid: [tour]
    panes: [{ area: tour, tour: round }]
`;
let plant, browser, page;

before(async () => {
    if (why)
        return;
    plant = await startPlant(`alarms: local\n${WALLS}`);
    browser = await openPage(`${plant.url}?wall=room`, { viewport: { width: 1920, height: 1080 } });
    page = browser.page;
});
after(async () => {
    await browser?.close();
    await plant?.stop();
});

const paneTitle = (area) => page.locator(`.pane.${area} h2`);
const inner = () => document.querySelector('.pane.views iframe').contentWindow.plantcast?.session.picture;
test('each pane shows what it is for', options, async () => {
    await page.waitForURL(/wall\.html\?wall=room/);
    await page.locator('.tile .value', { hasText: '°C' }).first().waitFor({ timeout: 60000 });
    await page.waitForFunction(inner, null, { timeout: 90000 });
    await page.waitForFunction(() => {
        const { clientWidth, clientHeight } = document.querySelector('.pane.views iframe').contentDocument.getElementById('viewport');
        return clientWidth > 800 && clientHeight > 600;
    }, null, { timeout: 30000 });
    await page.waitForFunction(() => { // from home, of the shape that the pane has in the end
        const { session } = document.querySelector('.pane.views iframe').contentWindow.plantcast, { width, height } = session.size;
        const { eye } = session.homeIn(width, height);
        return session.picture?.camera.eye.every((m, i) => Math.abs(m - eye[i]) < 0.01);
    }, null, { timeout: 30000 });
    await page.locator('.clock b').filter({ hasText: /^\d\d:\d\d:\d\d$/ }).waitFor();
    assert.match(await paneTitle('alarms').textContent(), /Alarms/);
    await shoot(page, 'wall-display');
});

test('views follow each other without a flight', options, async () => {
    await page.locator('.pane.views h2', { hasText: 'From above' }).waitFor({ timeout: 60000 });
    await page.waitForFunction(() => {
        const { picture } = document.querySelector('.pane.views iframe').contentWindow.plantcast.session;
        return Math.abs(picture.camera.eye[2] - 30) < 0.01;
    }, null, { timeout: 60000, polling: 100 });
    await page.locator('.pane.views h2', { hasText: 'Whole unit' }).waitFor({ timeout: 60000 });
    await page.waitForFunction(() => {
        const { picture } = document.querySelector('.pane.views iframe').contentWindow.plantcast.session;
        return Math.abs(picture.camera.eye[2] - 30) > 1; // home
    }, null, { timeout: 60000, polling: 100 });
});

test('an alarm comes to the pane that is for it, and leaves once it is acknowledged', options, async () => {
    await plant.ask('set TE-171 500');
    await page.locator('.pane.views.called h2', { hasText: 'TE-171' }).waitFor({ timeout: 60000 });
    await page.locator('.pane.alarms li.waiting', { hasText: 'TE-171' }).waitFor();
    assert.ok(await page.locator('.tile[data-alarm]:not([data-alarm=""])').count() > 0);
    await page.waitForTimeout(4000);
    await shoot(page, 'wall-display-alarm');
    await page.evaluate(() => {
        const { session } = globalThis.wall, all = [...session.model.alarms.rows.values()];
        const alarms = all.filter(({ state }) => state === 'unacknowledged').map(({ tag, kind }) => [tag.name, kind]);
        session.post({ type: 'alarm', seq: 1, action: 'acknowledge', alarms, name: 'kim' });
    });
    await page.waitForFunction(() => !document.querySelector('.pane.views.called'), null, { timeout: 60000 });
});

test('another display has its own panes', options, async () => {
    const other = await openPage(`${plant.url}?wall=room&display=2`, { viewport: { width: 1920, height: 1080 } });
    await other.page.locator('.pane.text p', { hasText: 'Clean F-101' }).waitFor({ timeout: 60000 });
    await other.page.waitForFunction(() => {
        const { contentDocument: inner, contentWindow: { innerHeight } } = document.querySelector('.pane.trend iframe');
        const chart = inner?.querySelector('#trend-chart canvas')?.getBoundingClientRect();
        return chart?.height > 0.5 * innerHeight && chart.bottom < innerHeight;
    }, null, { timeout: 90000 });
    await other.page.waitForTimeout(1500);
    await shoot(other.page, 'wall-display-2');
    await other.close();
    const gone = await openPage(`${plant.url}wall.html?wall=nowhere`, { viewport: { width: 800, height: 600 } });
    await gone.page.locator('.wrong', { hasText: "no wall 'nowhere'" }).waitFor();
    assert.match(await gone.page.locator('.wrong').textContent(), /room/);
    await gone.close();
});

test('a tour shows each view for its time, with its text', options, async () => {
    const other = await openPage(`${plant.url}?wall=room&display=3`, { viewport: { width: 1280, height: 720 } });
    const title = other.page.locator('.pane.tour h2, .pane.views h2').first(), begun = [];
    for (const text of ['From above · Seen from the stack', 'Whole unit', 'From above · Seen from the stack']) {
        await title.filter({ hasText: new RegExp(`^${text}(?! ·)`) }).waitFor({ timeout: 60000 });
        begun.push(performance.now());
        if (begun.length === 1) {
            await other.page.waitForTimeout(2500);
            await shoot(other.page, 'wall-tour');
        }
    }
    const [first, second] = [begun[1] - begun[0], begun[2] - begun[1]];
    assert.ok(first > 2500 && first < 9000 && second > 4500 && second < 11000, `${first} and ${second} ms`);
    await other.close();
});

test('a lost server is said in large letters, and ends by itself', options, async () => {
    await plant.stopDaemon('SIGKILL');
    await page.locator('#lost', { hasText: 'No connection to the plant since' }).waitFor({ timeout: 15000 });
    const px = await page.evaluate(() => parseFloat(getComputedStyle(document.getElementById('lost')).fontSize));
    assert.ok(px >= 100, `${px} pixels`);
    await shoot(page, 'wall-display-lost');
    await plant.startDaemon();
    await page.locator('#lost').waitFor({ state: 'hidden', timeout: 60000 });
    await page.locator('.tile .value', { hasText: '°C' }).first().waitFor({ timeout: 60000 });
    await page.waitForFunction(inner, null, { timeout: 60000 });
});
