// SPDX-License-Identifier: GPL-3.0-or-later
// Nothing old is shown as current: the value at which an alarm was raised, notes written later, and rings and lists of a lost
// device or server.
import assert from 'node:assert/strict';
import { appendFileSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { openPage, resize, settle, shoot, travel, waitForHealth, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, TinyPlant } from '../support/tiny_plant.mjs';
import { becomes } from '../support/until.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
const SCREEN = { viewport: { width: 1280, height: 720 } };
let plant, url, desk, german, wall;

setUp(options.skip, async () => {
    plant = await TinyPlant.create();
    // a timeout of 2 s instead of 0.3 s, because on a busy machine a late answer of the device would raise an alarm
    writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace('timeout_ms: 300', 'timeout_ms: 2000'));
    appendFileSync(plant.file, `alarms: local
views:
- { id: near, view: "look=default" }
walls:
- id: room
  displays:
  - grid: [main alarms]
    panes:
    - { area: main, views: [near], on_alarm: yes }
    - { area: alarms, alarms: yes }
`);
    const tags = join(plant.folder, 'tags.csv'), [head, ...rows] = readFileSync(tags, 'utf8').trim().split('\n');
    const limits = { 'TI-1': ',60,90', 'TI-2': ',60,90', 'PI-1': ',,' };
    writeFileSync(tags, `${[`${head},H,HH`, ...rows.map((row) => row + limits[row.split(',')[0]])].join('\n')}\n`);
    assert.equal(plant.prepare().code, 0);
    await plant.startSim();
    await plant.set({ 'TI-1': 50, 'TI-2': 20, 'PI-1': 5 });
    await plant.startDaemon();
    url = `http://127.0.0.1:${plant.port}/`;
    desk = await openPage(url, SCREEN);
    german = await openPage(`${url}?lang=de`, SCREEN);
    for (const { page } of [desk, german]) {
        await waitForPicture(page);
        await waitForHealth(page, 'live');
    }
});
after(async () => {
    for (const browser of [desk, german, wall])
        await browser?.close();
    await plant?.destroy();
});

const waitForText = (page, selector, pattern) => page.waitForFunction(
    ([where, p]) => new RegExp(p).test(document.querySelector(where)?.textContent), [selector, pattern]);
const labels = (page) => page.evaluate(() => globalThis.plantcast.overlay.labels().filter(({ rank, ring }) => ring && rank >= 0)
    .map(({ parts }) => parts.map(([text]) => text).join(' ')));

test('an alarm shows the value at which it was raised, and the present value', options, async () => {
    await plant.tell('set TI-1 95.5');
    await waitForText(desk.page, '#alarm-newest', '^TI-1 High-high, raised at 95\\.5 °C, now 95\\.5 °C \\(limit 90\\.0 °C\\)$');
    await plant.tell('set TI-1 70.25');
    await waitForText(desk.page, '#alarm-newest', 'TI-1 High.*now 70\\.3 °C');
    await plant.tell('set TI-1 40'); // TI-1 is back within its limits, but its alarm still waits for acknowledgement
    await waitForText(desk.page, '#alarm-newest', 'raised at .* now 40\\.0 °C \\(limit');
    await waitForText(german.page, '#alarm-newest', 'gekommen bei .*, jetzt 40,0 °C \\(Grenzwert');
    await desk.page.locator('#alarm-strip').click();
    await waitForText(desk.page, '#alarms-list td[data-col=now]', '40\\.0 °C');
    await plant.tell('set TI-1 41');
    await waitForText(desk.page, '#alarms-list td[data-col=now]', '41\\.0 °C');
    await settle(desk.page);
    await shoot(desk.page, 'present-list');
    await shoot(german.page, 'present-strip-de');
    await desk.page.locator('#alarms-close').click();
    wall = await openPage(`${url}wall.html?wall=room&display=1`, SCREEN);
    await waitForText(wall.page, '.pane.alarms .what', 'raised at .*, now 41\\.0 °C');
    await waitForText(wall.page, '.pane.views h2', 'raised at .*, now 41\\.0 °C');
    await plant.tell('set TI-1 42');
    await waitForText(wall.page, '.pane.alarms .what', 'now 42\\.0 °C');
    await waitForText(wall.page, '.pane.views h2', 'now 42\\.0 °C');
    await shoot(wall.page, 'present-wall');
    await plant.tell('set TI-1 95.5');
    await waitForText(wall.page, '.pane.views h2', 'High-high TI-1 Unacknowledged · ');
    await desk.page.evaluate(async () => {
        const { actOnAlarm } = await import('/core/requests.js');
        actOnAlarm(globalThis.plantcast.session, 'acknowledge', [['TI-1', 'HH']]);
    });
    await waitForText(wall.page, '.pane.views h2', 'High-high TI-1 Acknowledged · High: Unacknowledged · ');
    await plant.tell('set TI-1 42');
});

test('a note appears in the past only at instants when it existed', options, async () => {
    const { page } = desk, nowUs = () => page.evaluate(() => globalThis.plantcast.session.clockUs());
    const pins = () => page.evaluate(() => [...document.querySelectorAll('.note-pin')].map(({ textContent }) => textContent));
    const waitForPins = (...texts) => page.waitForFunction((wanted) => [...document.querySelectorAll('.note-pin')]
        .map(({ textContent }) => textContent).join('|') === wanted, texts.join('|'));
    const later = async (us) => { // waits until the history of the instant `us` is complete, which takes 3 s
        await page.waitForFunction((then) => globalThis.plantcast.session.clockUs() > then + 3.5e6, us);
        return us;
    };
    const before = await nowUs();
    await later(before);
    await page.evaluate(() => globalThis.plantcast.session.post({ type: 'note', seq: 900, text: 'Manhole open', asset: 'E-101' }));
    await waitForPins('Manhole open');
    const during = await nowUs();
    await later(during);
    await page.evaluate(() => {
        const { session } = globalThis.plantcast;
        session.post({ type: 'remove_note', seq: 901, id: session.notes[0].id });
    });
    await waitForPins();
    const gone = await later(await nowUs());
    await travel(page, before);
    await waitForHealth(page, 'past');
    await page.waitForFunction((us) => globalThis.plantcast.session.picture.dataTimeUs === us, before);
    assert.deepEqual(await pins(), []);
    await travel(page, during);
    await waitForPins('Manhole open');
    await waitForText(page, '#alarm-newest', 'raised at [^,]* \\(limit');
    await shoot(page, 'present-note-then');
    await travel(page, gone);
    await waitForPins();
    await travel(page, during);
    await waitForPins('Manhole open');
    await travel(page, null);
    await waitForHealth(page, 'live');
    await waitForPins();
});

test('a note for the shift needs no place; its author changes and ends it', options, async () => {
    const { page } = desk, rows = page.locator('#notes-list li');
    await page.locator('#viewport').focus();
    await page.keyboard.press('v');
    await page.locator('#note-text').fill('Flare work until 02:00');
    await page.locator('#note-at').selectOption('plant');
    await page.locator('#note-form button[type=submit]').click();
    await page.locator('#plant-notes li', { hasText: 'Flare work until 02:00' }).waitFor();
    await rows.filter({ hasText: /The whole plant · local, .* · until / }).waitFor();
    await german.page.locator('#plant-notes li', { hasText: 'Flare work until 02:00' }).waitFor();
    await rows.locator('.edit').click();
    assert.equal(await page.locator('#note-text').inputValue(), 'Flare work until 02:00');
    await page.locator('#note-text').fill('Flare work until 04:00');
    await shoot(page, 'present-note-changed');
    await page.locator('#note-form button[type=submit]').click();
    await page.locator('#plant-notes li', { hasText: 'Flare work until 04:00' }).waitFor();
    await becomes(() => rows.count(), 1);
    await rows.locator('.end').click();
    await page.locator('#plant-notes').waitFor({ state: 'hidden' });
    await page.keyboard.press('Escape');
});

test('on a phone, a press on a sensor closes the panel of views, but not while a note is written there', options, async () => {
    const { page } = desk;
    const press = (tag) => page.evaluate((name) => {
        const { handlers, overlay, selectTag, session } = globalThis.plantcast, marker = overlay.marker(session.model.tag(name));
        selectTag(null);
        handlers.click(marker.x, marker.y, 'touch');
    }, tag);
    const choice = (tag) => page.locator('#note-at option', { hasText: tag });
    await resize(page, { width: 390, height: 844 });
    await page.locator('#views-toggle').click();
    await page.locator('#note-text').fill('Valve leaks');
    await press('TI-1');
    await choice('TI-1').waitFor({ state: 'attached' });
    assert.ok(await page.locator('#note-text').isVisible());
    assert.equal(await page.locator('#note-text').inputValue(), 'Valve leaks');
    await shoot(page, 'present-note-phone');
    await page.locator('#note-text').fill('');
    await press('TI-2');
    await page.locator('#views.open').waitFor({ state: 'detached' });
    await page.evaluate(() => globalThis.plantcast.selectTag(null));
    await resize(page, SCREEN.viewport);
});

test('note pins are complete, and cover no other pin, no legend and not the right half', options, async () => {
    const { page } = desk;
    const texts = ['Manhole open', 'Seal drips, the tray is emptied each hour by the outside operator of the shift', 'Hot'];
    await page.evaluate((all) => {
        const { session } = globalThis.plantcast, target = session.model.tag('TI-1').position, [x, y, z] = target;
        // looks at TI-1's position, so that the tag stays in the middle when the picture is split into two halves
        session.setCamera({ ...session.camera, eye: [x + 6, y - 6, z + 4], target });
        all.forEach((text) => session.post({ type: 'note', seq: ++session.toldSeq, text, tag: 'TI-1' }));
    }, texts);
    // Returns the note pins with a fault: overlapping another pin or a legend, extending beyond the left half of a split
    // picture, or with text cut off. On a phone cut-off lines are allowed, because the list of notes has the whole text.
    const amiss = () => page.evaluate(() => {
        const view = document.getElementById('viewport').getBoundingClientRect(), { split } = globalThis.plantcast.session.shown;
        const right = split ? view.left + view.width / 2 : view.right;
        const pins = [...document.querySelectorAll('.note-pin')]
            .map((e) => [e.textContent, e.getBoundingClientRect(), e.firstChild]);
        const legends = [...document.querySelectorAll('.legend')].map((e) => ['legend', e.getBoundingClientRect()]);
        return pins.filter(([, a, text], i) => a.width === 0 || a.left < view.left - 1 || a.right > right + 1 || a.top < view.top - 1 ||
            (innerWidth > 719 && text.scrollHeight > text.clientHeight + 1) || text.scrollWidth > text.clientWidth + 1 ||
            [...pins.slice(i + 1), ...legends].some(([, b]) => a.left < b.right && b.left < a.right && a.top < b.bottom &&
                b.top < a.bottom))
            .map(([text]) => text);
    });
    const screen = page.viewportSize();
    for (const size of [screen, { width: 390, height: 844 }]) {
        await resize(page, size);
        for (const split of [null, { show: 'operator' }]) {
            await page.evaluate((half) => globalThis.plantcast.session.setParams({ split: half }), split);
            await page.waitForFunction(([count, halves]) => document.querySelectorAll('.note-pin:not([hidden])').length === count &&
                Boolean(globalThis.plantcast.session.shown.split) === halves, [texts.length, Boolean(split)]);
            await settle(page);
            await shoot(page, `present-pins-${size.width}${split ? '-split' : ''}`);
            await becomes(amiss, [], `${size.width}${split ? ', split' : ''}`);
        }
    }
    // moves the camera downwards until the point to which the notes belong is at the upper edge of the picture
    await page.evaluate(async () => {
        const { projector } = await import('/core/camera.js'), { session, viewport } = globalThis.plantcast;
        const { position } = session.model.tag('TI-1'), lower = ([x, y, z]) => [x, y, z - 0.01];
        let { camera } = session;
        while (projector(camera, viewport.width, viewport.height)(position)[1] > 15)
            camera = { ...camera, eye: lower(camera.eye), target: lower(camera.target) };
        session.setCamera(camera);
    });
    await settle(page);
    await shoot(page, 'present-pins-high');
    await becomes(amiss, [], 'at the upper edge');
    await page.evaluate(() => {
        const { session } = globalThis.plantcast;
        session.notes.forEach(({ id }) => session.post({ type: 'remove_note', seq: ++session.toldSeq, id }));
        session.setParams({ split: null });
    });
    await resize(page, screen);
    await page.locator('.note-pin').first().waitFor({ state: 'detached' });
    await settle(page);
});

test('a lost device raises an alarm of its own; rings keep their tag names and say since when the alarm is held', options, async () => {
    await plant.tell('set TI-1 95.5');
    await plant.tell('set TI-2 95.5');
    const rings = (page, pattern) => page.waitForFunction((p) => {
        const said = globalThis.plantcast.overlay.labels().filter(({ rank, ring }) => ring && rank >= 0)
            .map(({ parts }) => parts.map(([text]) => text).join(' '));
        return said.length === 2 && said.every((text) => new RegExp(p).test(text));
    }, pattern);
    await rings(desk.page, '^TI-[12] 95\\.5 °C HH$');
    await plant.tell('pause');
    await rings(desk.page, '^TI-[12] HH held since \\d\\d:\\d\\d$');
    await rings(german.page, '^TI-[12] HH gehalten seit \\d\\d:\\d\\d$');
    assert.match(await desk.page.evaluate(async () => {
        const { limitText } = await import('/app/alarms/alarm_bar.js'), { session } = globalThis.plantcast;
        return limitText(session, session.model.alarms.list().find(({ tag }) => tag.name === 'TI-1'), true);
    }), /^raised at 95\.5 °C, held since \d\d:\d\d \(limit 90\.0 °C\)$/);
    await desk.page.waitForFunction(() => globalThis.plantcast.session.model.alarms.list().some(({ tag, kind, state }) =>
        tag.name === 'plc1' && kind === 'LINK' && state === 'unacknowledged'));
    await desk.page.locator('#alarm-strip').click();
    await waitForText(desk.page, '#alarms-list', 'plc1');
    await waitForText(desk.page, '#alarms-list', '95\\.5no value');
    await shoot(desk.page, 'present-device-lost');
    await shoot(german.page, 'present-device-lost-de');
    await shoot(wall.page, 'present-device-lost-wall');
    await desk.page.locator('#alarms-close').click();
    await plant.tell('resume');
    await rings(desk.page, '^TI-[12] 95\\.5 °C HH$');
    assert.equal((await labels(desk.page)).length, 2);
});

test('a refusal is shown in the reader\'s language, over the stream and over HTTP', options, async () => {
    await german.page.evaluate(() => globalThis.plantcast.session.setParams({ selected: 'E-9' }));
    await waitForText(german.page, '#toast', '^Der Server hat abgelehnt: diese Anlage hat kein Anlagenteil „E-9“$');
    await shoot(german.page, 'refused-de');
    await german.page.evaluate(() => globalThis.plantcast.session.setParams({ range: [1, -1] }));
    await waitForText(german.page, '#toast', '^Der Server hat abgelehnt: das Ende des Bereichs muss seinen Anfang um mindestens ');
    await german.page.evaluate(async () => {
        const { askFit } = await import('/core/requests.js');
        askFit(globalThis.plantcast.session, { side: 'inside out' });
    });
    await waitForText(german.page, '#toast', '^Der Server hat abgelehnt: auf Englisch: „side:');
    const answer = await fetch(`${url}api/v1/history?tags=Ü-1&from=2026-01-01T00:00:00Z&to=2026-01-02T00:00:00Z`);
    assert.deepEqual(JSON.parse(answer.headers.get('plantcast-refusal')), { code: 'no_tag', args: { name: 'Ü-1' } });
    assert.equal(await answer.text(), 'tags: this plant has no tag “Ü-1”\n');
});

test('when the server is lost, the equipment list turns grey as the strip and the picture do', options, async () => {
    const { page } = desk, list = page.locator('#assets-list');
    if (await page.locator('#assets-toggle').getAttribute('aria-expanded') !== 'true')
        await page.locator('#assets-toggle').click();
    await list.locator('.limit-flag').first().waitFor();
    const filter = () => list.evaluate((element) => getComputedStyle(element).filter);
    await becomes(filter, 'none');
    await plant.daemon.stop();
    await page.waitForFunction(() => getComputedStyle(document.getElementById('assets-list')).filter === 'grayscale(1)');
    await becomes(() => page.locator('#alarm-newest').evaluate((element) => getComputedStyle(element).filter), 'grayscale(1)');
    await waitForText(page, '#alarm-newest', 'raised at .*, now –');
    await shoot(page, 'present-server-lost');
    await shoot(wall.page, 'present-server-lost-wall');
});
