// SPDX-License-Identifier: GPL-3.0-or-later
// Displays in a control room, as configured in `walls` of the plant file: each kind of pane, and an alarm that replaces a
// view.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, shoot } from '../support/browser.mjs';
import { BIN } from '../support/plant.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, startTiny } from '../support/tiny_plant.mjs';

const why = notBuilt();
const options = { skip: why, timeout: 300000 };
const WALLS = `
views:
- { id: whole, title: Whole unit, view: "group=temperature" }
- { id: above, title: From above, view: "group=temperature&show=blind&only=E-101&camera=0,-0.5,30,0,0,0,0,0,1,5" }
- { id: gone, title: Pressures, view: "group=presure" }
- { id: odd, title: One thing, view: "group=pressure&show_only=E-1" }
- { id: since, title: Since noon, view: "group=temperature&show=difference&baseline=noon" }
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
    - { area: tiles, title: Feed, tiles: [TI-1, TI-2, PI-1] }
    - { area: clock, clock: yes }
  - grid: [top, bottom]
    panes:
    - { area: top, trend: [TI-1, TI-2], hours: 1 }
    - { area: bottom, title: To do, text: [Check P-101A, Clean F-101] }
  - grid: [tour]
    panes: [{ area: tour, tour: round }]
  - grid: [left right]
    panes:
    - { area: left, views: [gone], on_alarm: yes }
    - { area: right, views: [whole] }
`;
let plant, browser, page;

setUp(why, async (own) => {
    plant = own(await startTiny(WALLS));
    browser = own(await openPage(`${plant.url}?wall=room`, { viewport: { width: 960, height: 540 } }));
    page = browser.page;
});

const paneTitle = (area) => page.locator(`.pane.${area} h2`);
const inner = () => document.querySelector('.pane.views iframe')?.contentWindow.plantcast?.session.picture;
test('each pane shows its configured content', options, async () => {
    await page.waitForURL(/wall\.html\?wall=room/);
    await page.locator('.tile .value', { hasText: '°C' }).first().waitFor();
    await page.waitForFunction(inner);
    await page.waitForFunction(() => {
        const { clientWidth, clientHeight } = document.querySelector('.pane.views iframe').contentDocument.getElementById('viewport');
        return clientWidth > 400 && clientHeight > 300;
    });
    await page.waitForFunction(() => { // waits for a picture from the home position of the camera, as fitted to the pane's final shape
        const { session } = document.querySelector('.pane.views iframe').contentWindow.plantcast, { width, height } = session.size;
        const { eye } = session.homeIn(width, height);
        return session.picture?.camera.eye.every((m, i) => Math.abs(m - eye[i]) < 0.01);
    });
    await page.locator('.clock b').filter({ hasText: /^\d\d:\d\d:\d\d$/ }).waitFor();
    assert.match(await paneTitle('alarms').textContent(), /Alarms/);
    const letters = await page.locator('.tile .name, .pane.alarms').evaluateAll((all) => all.map((e) => getComputedStyle(e).fontSize));
    assert.deepEqual([...new Set(letters)].length, 1, `letters of tiles are as large as those of alarms: ${letters}`);
    await shoot(page, 'wall-display');
});

test('the views of a pane follow each other without a flight', options, async () => {
    await page.locator('.pane.views h2', { hasText: 'From above' }).waitFor();
    await page.waitForFunction(() => {
        const { picture } = document.querySelector('.pane.views iframe').contentWindow.plantcast.session;
        return Math.abs(picture.camera.eye[2] - 30) < 0.01;
    }, null, { polling: 100 });
    await page.locator('.pane.views h2', { hasText: 'Whole unit' }).waitFor();
    await page.waitForFunction(() => {
        const { picture } = document.querySelector('.pane.views iframe').contentWindow.plantcast.session;
        return Math.abs(picture.camera.eye[2] - 30) > 1; // the camera is at home
    }, null, { polling: 100 });
});

// Runs in the page.
function acknowledgeAll() {
    const { session } = globalThis.wall, all = [...session.model.alarms.rows.values()];
    const alarms = all.filter(({ state }) => state === 'unacknowledged').map(({ tag, kind }) => [tag.name, kind]);
    session.post({ type: 'alarm', seq: 1, action: 'acknowledge', alarms, name: 'kim' });
}

test('an alarm appears in the pane meant for it, and disappears once acknowledged', options, async () => {
    await page.evaluate(() => {
        globalThis.mixed = 0;
        const look = () => {
            const pane = document.querySelector('.pane.views'), frame = pane.querySelector('iframe');
            const { session, overlay } = frame.contentWindow.plantcast ?? {}, isAlarm = /PI-1/.test(pane.querySelector('h2').textContent);
            globalThis.mixed += isAlarm && getComputedStyle(frame).visibility === 'visible' &&
                (session?.shown.group !== 'pressure' || !overlay.marker(session.model.tag('PI-1')));
            requestAnimationFrame(look);
        };
        look();
    });
    // waits until the tour shows the view that does not contain PI-1's pump, so that the alarm must replace the view
    await page.locator('.pane.views h2', { hasText: 'From above' }).waitFor();
    await plant.ask('set PI-1 95');
    await page.locator('.pane.views.called h2', { hasText: 'PI-1' }).waitFor();
    await page.locator('.pane.alarms li.waiting', { hasText: 'PI-1' }).waitFor();
    await page.locator('.tile[data-alarm]:not([data-alarm=""])').first().waitFor();
    await page.waitForFunction(() => [...document.querySelectorAll('.pane.views')].some((pane) => !pane.classList.contains('coming') &&
        /PI-1/.test(pane.querySelector('h2').textContent) &&
        pane.querySelector('iframe').contentWindow.plantcast?.session.shown.group === 'pressure'));
    assert.deepEqual(await page.evaluate(() => {
        const { show, isolate } = document.querySelector('.pane.views.called iframe').contentWindow.plantcast.session.shown;
        return [show, isolate];
    }), ['value', []], 'the pane shows readings, and the equipment of the alarm');
    assert.equal(await page.evaluate(() => globalThis.mixed), 0, 'no view\'s name stands over the picture of another quantity or place');
    const [frame, badge] = await page.evaluate(() => {
        const pane = document.querySelector('.pane.views.called');
        return [getComputedStyle(pane, '::after').borderTopColor, getComputedStyle(pane.querySelector('h2 .priority')).borderTopColor];
    });
    assert.equal(frame, badge, 'the frame has the colour of the alarm\'s priority');
    await shoot(page, 'wall-display-alarm');
    await plant.ask('set TI-1 95');
    await plant.ask('set TI-2 95');
    // the pane has no room for three long rows: it shows short ones with name and value, and the number of those left out
    await page.waitForFunction(() => {
        const { alarms } = globalThis.wall.session.model, rows = [...document.querySelectorAll('.pane.alarms li.brief')];
        const more = document.querySelector('.pane.alarms .more'), count = more.hidden ? 0 : Number(/\d+/.exec(more.textContent)[0]);
        return alarms.list().length >= 3 && rows.length > 0 && rows.length + count === alarms.list().length &&
            rows.every((row) => /^95\.\d+\s\S+$/.test(row.querySelector('.now').textContent));
    });
    await shoot(page, 'wall-display-alarms');
    await page.evaluate(acknowledgeAll);
    await page.waitForFunction(() => !document.querySelector('.pane.views.called'));
    for (const tag of ['TI-1', 'TI-2'])
        await plant.ask(`set ${tag} 20`);
});

test('an error in one pane does not stop the panes after it; a tag that a pane\'s page lacks yet is no error', options, async () => {
    const other = await openPage(`${plant.url}?wall=room`, { viewport: { width: 960, height: 540 } }), own = other.page;
    await own.waitForFunction(inner);
    await own.locator('.clock b', { hasText: ':' }).waitFor();
    await plant.ask('set PI-1 95');
    await own.locator('.pane.alarms li', { hasText: 'PI-1' }).waitFor();
    const failing = own.waitForEvent('console', (message) => message.text().includes('no such pane'));
    await own.evaluate(() => {
        const [views, , tiles] = globalThis.wall.panes, broken = globalThis.wall.session.model.tag('PI-1'), { description } = broken;
        const get = () => { throw new Error('no such pane'); };
        Object.defineProperty(broken, 'description', { configurable: true, get });
        const { tick } = tiles;
        tiles.tick = () => { throw new Error(); }; // without a message
        globalThis.restore = () => {
            Object.defineProperty(broken, 'description', { value: description, writable: true });
            tiles.tick = tick;
        };
        const { model } = views.element.querySelector('iframe').contentWindow.plantcast.session, { tag } = model;
        model.tag = (name) => (name === 'PI-1' ? null : tag.call(model, name));
        globalThis.learn = () => { delete model.tag; };
    });
    await own.setViewportSize({ width: 960, height: 500 }); // makes the list of alarms build its rows, which fails
    await failing;
    const clock = await own.locator('.clock b').textContent();
    await own.waitForFunction((before) => document.querySelector('.clock b').textContent !== before, clock);
    await own.locator('.pane.alarms > .failure', { hasText: 'out of date' }).waitFor();
    await own.locator('.pane.tiles > .failure').waitFor();
    assert.equal(await own.locator('.failure').count(), 2);
    await shoot(own, 'wall-display-error');
    const covered = await own.locator('.clock b').textContent();
    await own.waitForFunction((before) => document.querySelector('.clock b').textContent !== before, covered);
    assert.equal(await own.locator('.pane.alarms > .failure').count(), 1, 'an unchanged list stays covered');
    await own.evaluate(() => globalThis.restore());
    await own.waitForFunction(() => !document.querySelector('.failure'));
    await plant.ask('set PI-1 5');
    await own.waitForFunction(() => !globalThis.wall.session.model.alarms.list().some(({ tag }) => tag.name === 'PI-1'));
    await plant.ask('set PI-1 95');
    await own.waitForFunction(() => globalThis.wall.call.shown?.startsWith('2/'));
    const late = await own.locator('.clock b').textContent();
    await own.waitForFunction((before) => document.querySelector('.clock b').textContent !== before, late);
    assert.equal(await own.evaluate(() => globalThis.wall.panes[0].error), null);
    await own.evaluate(() => globalThis.learn());
    await own.locator('.pane.views.called h2', { hasText: 'PI-1' }).waitFor();
    await own.evaluate(acknowledgeAll);
    await own.waitForFunction(() => !document.querySelector('.pane.views.called'));
    await other.close();
});

test('a display that cannot read the walls of the plant file tries again', options, async () => {
    let fails = true;
    const arrange = (one) => one.route(/api\/v1\/walls/, (route) => (fails ? route.abort() : route.continue()));
    const other = await openPage(`${plant.url}wall.html?wall=room&display=2`, { viewport: { width: 960, height: 540 } }, null, arrange);
    await other.page.locator('.wrong').waitFor();
    fails = false;
    await other.page.locator('.pane.text p', { hasText: 'Clean F-101' }).waitFor();
    // after another connection, the display says which display it is, even while requests fail again
    const isKnown = () => globalThis.wall.session.walls?.displays.some(({ wall, display }) => wall === 'room' && display === 2);
    await other.page.waitForFunction(isKnown);
    fails = true;
    const again = () => new Promise((done) => {
        globalThis.wall.session.on('welcome', done);
        globalThis.wall.session.connection.socket.close();
    });
    await other.page.evaluate(again);
    await other.page.waitForFunction(isKnown);
    await other.close();
});

test('a second display shows its own panes', options, async () => {
    let answer; // delays the trend module until answer() is called, so that the pane's text `waiting for values` can be seen
    const held = new Promise((done) => { answer = done; });
    const arrange = (one) => one.route(/app\/trends\/trends\.js/, async (route) => { await held; await route.continue(); });
    const other = await openPage(`${plant.url}?wall=room&display=2&lang=ko`, { viewport: { width: 960, height: 540 } }, null, arrange);
    const why = other.page.locator('.pane.trend .why');
    await why.filter({ hasText: 'TI\u20111, TI\u20112 값을 기다리는 중' }).waitFor();
    answer();
    await why.waitFor({ state: 'hidden' });
    await other.page.locator('.pane.text p', { hasText: 'Clean F-101' }).waitFor();
    const cut = (all) => all.filter((e) => e.scrollWidth > e.clientWidth + 1).map((e) => e.textContent);
    assert.deepEqual(await other.page.locator('.pane.text p').evaluateAll(cut), []);
    await other.page.waitForFunction(() => document.querySelector('.pane.trend iframe').contentDocument?.documentElement.lang === 'ko');
    const breaks = await other.page.locator('.pane.text p').first().evaluate((p) => getComputedStyle(p).wordBreak);
    assert.equal(breaks, 'keep-all', 'lines do not break within Korean words');
    await other.page.waitForFunction(() => {
        const { contentDocument: inner, contentWindow: { innerHeight } } = document.querySelector('.pane.trend iframe');
        const chart = inner?.querySelector('#trend-chart canvas')?.getBoundingClientRect();
        return chart?.height > 0.5 * innerHeight && chart.bottom < innerHeight;
    });
    await shoot(other.page, 'wall-display-2');
    await other.close();
    const gone = await openPage(`${plant.url}wall.html?wall=nowhere`, { viewport: { width: 800, height: 600 } });
    await gone.page.locator('.wrong', { hasText: "no wall 'nowhere'" }).waitFor();
    assert.match(await gone.page.locator('.wrong').textContent(), /room/);
    await gone.close();
});

// Makes the panes name tags that the plant lacks. The daemon would refuse to start with such a wall, but after a reload that
// removes tags, a display keeps its panes for a while.
test('tags that the plant lacks are named in tiles and trends', options, async () => {
    const openWith = (names, display) => openPage(`${plant.url}wall.html?wall=room&display=${display}`,
        { viewport: { width: 960, height: 540 } }, null, (one) => one.route(/api\/v1\/walls/, async (route) => {
            const answer = await route.fetch(), text = await answer.text();
            const body = Object.entries(names).reduce((now, [name, other]) => now.replaceAll(`"${name}"`, `"${other}"`), text);
            await route.fulfill({ response: answer, body });
        }));
    const tiles = await openWith({ 'TI-2': 'TI-8' }, 1);
    const tile = (name) => tiles.page.locator('.tile', { hasText: name });
    await tile('TI-8').locator('.value', { hasText: 'no such tag' }).waitFor();
    await tile('TI-1').locator('.value', { hasText: '°C' }).waitFor();
    await shoot(tiles.page, 'wall-display-unknown-tile');
    await tiles.close();
    const one = await openWith({ 'TI-2': 'TI-8' }, 2), inside = one.page.frameLocator('.pane.trend iframe');
    await inside.locator('#trend-note', { hasText: 'Not in this plant: TI-8' }).waitFor();
    await inside.locator('#trend-tags tbody tr', { hasText: 'TI-1' }).waitFor();
    await shoot(one.page, 'wall-display-unknown-trend');
    await one.page.route(/api\/v1\/history/, () => {}); // never answered
    await one.page.reload();
    const waiting = 'Waiting for the values of TI\u20111 · Not in this plant: TI\u20118';
    await one.page.locator('.pane.trend .why', { hasText: waiting }).waitFor();
    await one.close();
    const both = await openWith({ 'TI-1': 'TI-7', 'TI-2': 'TI-8' }, 2);
    await both.page.locator('.pane.trend .why', { hasText: 'Not in this plant: TI\u20117, TI\u20118' }).waitFor();
    await both.close();
});

test('a heading names the view in the picture, not one that is still loading', options, async () => {
    let answer;
    const held = new Promise((done) => { answer = done; });
    const arrange = (one) => one.route(/views\/named_views\.js/, async (route) => { await held; await route.continue(); });
    const slow = await openPage(`${plant.url}?wall=room`, { viewport: { width: 960, height: 540 } }, null, arrange);
    await slow.page.waitForFunction(() => document.querySelector('.pane.views iframe')?.contentWindow.plantcast?.session.picture &&
        document.querySelector('.pane.views .about').textContent);
    assert.equal(await slow.page.locator('.pane.views .said').textContent(), '');
    answer();
    await slow.page.locator('.pane.views .said', { hasText: /Whole unit|From above/ }).waitFor();
    await slow.close();
});

// The page must not show another picture instead: people would take it for the requested view.
test('a view that names things the plant lacks is not shown, and is reported', options, async () => {
    const { list } = await (await fetch(new URL('api/v1/views', plant.url))).json();
    const wrong = Object.fromEntries(list.map(({ id, wrong: why }) => [id, why]));
    assert.match(wrong.gone, /group: this plant has no quantity “presure”/);
    assert.match(wrong.odd, /show_only: not available in a picture/);
    assert.deepEqual([wrong.whole, wrong.above, wrong.since], [undefined, undefined, undefined]);
    const { stdout, status } = spawnSync(join(BIN, 'plantcastd'), ['--check', plant.file], { encoding: 'utf8' });
    assert.equal(status, 0, stdout);
    assert.match(stdout, /plant\.yaml:\d+: warning: view gone: group: this plant has no quantity “presure”/);
    assert.match(stdout, /warning: view odd: .*show_only/);
    assert.doesNotMatch(stdout, /view (whole|above|since):/);
    const other = await openPage(`${plant.url}?wall=room&display=4`, { viewport: { width: 1280, height: 720 } });
    const left = other.page.locator('.pane.views').first(), right = other.page.locator('.pane.views').nth(1);
    await left.locator('.why', { hasText: 'cannot be shown: this plant has no quantity “presure”' }).waitFor();
    assert.equal(await left.locator('h2 .said').textContent(), 'Pressures');
    assert.equal(await left.locator('iframe').isVisible(), false);
    await right.locator('h2 .about', { hasText: 'Temperature' }).waitFor();
    assert.equal(await right.locator('.why').isVisible(), false);
    await shoot(other.page, 'wall-display-wrong-view');
    await plant.ask('set TI-2 95'); // the pane whose view is invalid can still show an alarm
    await other.page.waitForFunction(() => document.querySelector('.pane.views.called:not(.unshown, .coming)'));
    assert.equal(await left.locator('iframe').isVisible(), true);
    await plant.ask('set TI-2 20');
    await other.page.goto(plant.url);
    await other.page.click('#views-toggle');
    await other.page.locator('#named-list em').first().waitFor();
    await other.page.locator('#legend h2').waitFor();
    const said = await other.page.locator('#named-list em').allTextContents();
    assert.equal(said.length, 2, 'the list marks the two invalid views');
    // puts in the German name of the demo plant's vibration, a long word; returns the number of lines that the title then takes
    const lines = await other.page.evaluate(() => {
        const [name] = document.querySelector('#legend h2').childNodes, range = document.createRange();
        name.textContent = 'Schwinggeschwindigkeit';
        range.selectNodeContents(name);
        return range.getClientRects().length;
    });
    assert.equal(lines, 1, 'the title of the legend does not break within a long word');
    await other.close();
});

// A tour pauses while an alarm calls for attention. So that this does not disturb the test, any alarm (e.g. after a late answer
// of the PLC) is acknowledged at once.
test('a tour shows each view for its time, with its text', options, async () => {
    await page.evaluate(() => {
        const { session } = globalThis.wall;
        const acknowledge = () => {
            const waiting = [...session.model.alarms.rows.values()].filter(({ state }) => /^(unacknowledged|returned)$/.test(state));
            const alarms = waiting.map(({ tag, kind }) => [tag.name, kind]);
            if (alarms.length > 0)
                session.post({ type: 'alarm', seq: 2, action: 'acknowledge', alarms, name: 'kim' });
        };
        session.on('alarms', acknowledge);
        acknowledge();
    });
    // Records the pane's titles (titles) and the times at which it begins another view (begun), which precede the view's
    // picture. late: time in ms by which it had to be later, because timers were late or an alarm waited.
    const watch = () => {
        const log = globalThis.titles = [], begun = globalThis.begun = [], { setItem } = Storage.prototype;
        let last = performance.now(), late = 0;
        Storage.prototype.setItem = function set(key, value) {
            if (key.startsWith('plantcast.at.')) { // the pane stores the view that it begins to show, so this write marks the beginning
                const now = performance.now();
                begun.push({ at: now, late: late + Math.max(0, now - last - 50) });
                late = 0;
            }
            setItem.call(this, key, value);
        };
        setInterval(() => {
            const now = performance.now(), text = document.querySelector('.pane.views h2 .said')?.textContent;
            const rests = globalThis.wall?.session.model?.alarms.list().some(({ waiting }) => waiting);
            late += rests ? now - last : Math.max(0, now - last - 50);
            last = now;
            if (text && text !== log.at(-1))
                log.push(text);
        }, 50);
    };
    const other = await openPage(`${plant.url}?wall=room&display=3`, { viewport: { width: 1280, height: 720 } }, watch);
    // a view whose picture arrives only when its time is over does not get its title
    const texts = ['From above · Seen from the stack', 'Whole unit'], wanted = JSON.stringify([...texts, ...texts]).slice(1, -1);
    await other.page.waitForFunction((four) => JSON.stringify(globalThis.titles).includes(four) && globalThis.begun.length >= 3, wanted);
    await shoot(other.page, 'wall-tour');
    const begun = await other.page.evaluate(() => globalThis.begun);
    // checks for how long each of the first two views was shown
    for (const [i, dwellMs] of [[0, 6000], [1, 4000]]) {
        const tookMs = begun[i + 1].at - begun[i].at, { late } = begun[i + 1];
        assert.ok(tookMs > dwellMs - late - 300 && tookMs < dwellMs + late + 600, `view ${i} was shown for ${tookMs} ms, late by ${late}`);
    }
    await other.close();
});
