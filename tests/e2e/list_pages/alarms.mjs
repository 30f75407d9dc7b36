// SPDX-License-Identifier: GPL-3.0-or-later
// Alarms in the browser: counted and marked in every view, listed, acknowledged, shelved, flown to.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { DESKTOP, openPage, settle, shoot, TABLET, view, waitForHealth, waitForPicture } from '../support/browser.mjs';
import { missing, startPlant } from '../support/plant.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
const HOT = 'TE-101', LOW = 'TE-101';
let plant, browser, page, tags;

before(async () => {
    if (why)
        return;
    plant = await startPlant('\nalarms: local\n');
    browser = await openPage(plant.url, DESKTOP);
    page = browser.page;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    tags = await page.evaluate(() => globalThis.plantcast.session.model.tags.map(({ name, group, limits }) => ({ name, group, limits })));
    await plant.freeze(tags.map(({ name }) => name));
    for (const { name, limits } of tags.filter((tag) => tag.limits.H !== null)) // sets all values between their limits L and H
        await plant.ask(`set ${name} ${((limits.L ?? 0) + limits.H) / 2}`);
});
after(async () => {
    await browser?.close();
    await plant?.stop();
});

const words = () => page.locator('#alarm-words').textContent();
const waitForWords = (pattern) => page.waitForFunction(
    (p) => new RegExp(p).test(document.getElementById('alarm-words').textContent), pattern,
    { timeout: 30000 });
const limitOf = (name) => tags.find((tag) => tag.name === name).limits;
// Returns the position of a tag's alarm ring over the picture, and the alarm; null: no ring is drawn.
const ring = (name) => page.evaluate((tag) => {
    const { overlay } = globalThis.plantcast, found = overlay.markers.find((marker) => marker.tag.name === tag && marker.alarm);
    const box = document.getElementById('viewport').getBoundingClientRect();
    return found ? { x: box.left + found.x, y: box.top + found.y, kind: found.alarm.kind, state: found.alarm.state } : null;
}, name);
const waitForRing = (name) => page.waitForFunction((tag) => globalThis.plantcast.overlay.markers.some((marker) => marker.tag.name === tag &&
    marker.alarm), name, { timeout: 30000 });

test('what comes beyond its limit is counted, marked and listed, the most urgent first', options, async () => {
    await waitForWords('^No active alarms|returned|^\\d+ active');
    const shaken = tags.find(({ group, limits }) => group === 'vibration' && limits.H !== null).name;
    await plant.ask(`set ${shaken} ${limitOf(shaken).H + 0.1}`);
    await plant.ask(`set ${HOT} ${limitOf(HOT).HH + 1}`);
    await page.waitForFunction(
        (hot) => globalThis.plantcast.session.model.alarms.list().some(({ tag, kind }) => tag.name === hot && kind === 'HH'),
        HOT, { timeout: 30000 });
    await waitForWords('^\\d+ active alarms, \\d+ unacknowledged$');
    assert.match(await page.locator('#alarm-mode').textContent(), /Plantcast alarms/);
    await waitForRing(HOT);
    assert.deepEqual((({ kind, state }) => [kind, state])(await ring(HOT)), ['HH', 'unacknowledged']);
    await page.locator('#alarm-strip').click();
    const first = page.locator('#alarms-list li').first();
    assert.match(await first.textContent(), new RegExp(`${HOT} High-high, raised at ${limitOf(HOT).HH + 1}`));
    await settle(page);
    const [legend, list] = await Promise.all(['#legend', '#alarms'].map((id) => page.locator(id).boundingBox()));
    assert.ok(legend.x + legend.width <= list.x, 'the legend is read beside the list');
    await shoot(page, 'alarms-desktop');
});

test('whatever group and way of showing is chosen, it stays marked and counted', options, async () => {
    const before = await words();
    for (const params of [{ group: 'vibration' }, { group: 'pressure', show: 'operator' },
        { group: 'temperature', show: 'distance', sensor: 'TE-102' },
        { group: 'temperature', show: 'operator' }]) {
        await page.evaluate((change) => globalThis.plantcast.session.setParams(change), params);
        await settle(page);
        assert.ok(await ring(HOT), JSON.stringify(params));
        assert.equal(await words(), before);
        if (params.group === 'vibration')
            await shoot(page, 'alarms-other-group');
    }
    await shoot(page, 'alarms-operator');
    await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'temperature', show: 'value' }));
});

test('an acknowledgement is done once, for everybody', options, async () => {
    const other = await openPage(`${plant.url}?wall`, { viewport: { width: 1280, height: 720 } });
    try {
        await waitForPicture(other.page);
        const id = await page.evaluate((hot) => globalThis.plantcast.session.model.alarms.list().find(({ tag, kind }) => tag.name === hot &&
            kind === 'HH').id, HOT);
        await page.locator(`li[data-alarm="${id}"] button[data-action="acknowledge"]`).focus();
        await page.keyboard.press('Enter');
        await other.page.waitForFunction(
            (alarm) => globalThis.plantcast.session.model.alarms.rows.get(alarm)?.state === 'acknowledged', id);
        await page.waitForFunction((alarm) => globalThis.plantcast.session.model.alarms.rows.get(alarm)?.state === 'acknowledged', id);
        assert.ok(await other.page.locator('#alarm-strip').isVisible(), 'on a wall too');
        assert.match(await page.locator(`li[data-alarm="${id}"]`).textContent(), /Acknowledged.*by local/s);
        assert.equal(await page.locator(`li[data-alarm="${id}"] button[data-action="acknowledge"]`).count(), 0);
        assert.equal(await page.evaluate(() => document.activeElement.closest('li')?.dataset.alarm), id, 'the keyboard stays there');
        await shoot(other.page, 'alarms-wall');
        assert.deepEqual(other.errors, []);
    } finally {
        await other.close();
    }
});

test('a row under the hand stays while others come, and can be pressed', options, async () => {
    const { name, limits } = tags.find(({ group, limits: of, name: is }) => group === 'temperature' && of.HH !== null && is !== HOT);
    const row = page.locator('#alarms-list li', { hasText: HOT }).first(), held = await row.elementHandle();
    const box = await row.locator('button[data-action="shelve"]').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await plant.ask(`set ${name} ${limits.H + 0.1}`);
    await page.locator('#alarms-list li', { hasText: `${name} High,` }).waitFor({ timeout: 30000 });
    assert.ok(await held.evaluate((li) => li.isConnected), 'it is the same');
    const now = await row.locator('button[data-action="shelve"]').boundingBox();
    await page.mouse.move(now.x + now.width / 2, now.y + now.height / 2);
    await page.mouse.up();
    await page.locator('#shelve[open]').waitFor();
    await page.locator('#shelve-cancel').click();
    await plant.ask(`set ${name} ${((limits.L ?? 0) + limits.H) / 2}`);
});

test('a shelf needs a reason, and keeps the alarm from being seen', options, async () => {
    const id = await page.evaluate((hot) => globalThis.plantcast.session.model.alarms.list().find(({ tag, kind }) => tag.name === hot &&
        kind === 'HH').id, HOT);
    await page.locator(`li[data-alarm="${id}"] button[data-action="shelve"]`).click();
    await page.locator('#shelve button[type="submit"]').click();
    assert.ok(await page.locator('#shelve').isVisible(), 'without a reason nothing happens');
    await shoot(page, 'alarms-shelve');
    await page.locator('#shelve-reason').fill('transmitter is being changed');
    await page.locator('#shelve button[type="submit"]').click();
    const row = page.locator(`#alarms-aside li[data-alarm="${id}"]`);
    await row.waitFor();
    assert.match(await row.textContent(), /Shelved.*until \d\d:\d\d, by local, transmitter is being changed/s);
    await row.locator('button[data-action="unshelve"]').click();
    await page.locator(`#alarms-list li[data-alarm="${id}"].calls`).waitFor(); /* the alarm is listed again as if it were new */
});

test('a click flies there, in its own group, and back to normal is said', options, async () => {
    await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'pressure' }));
    const { camera } = await view(page);
    await page.locator('#alarms-list li .alarm-go').first().click();
    await page.waitForFunction(() => globalThis.plantcast.session.params.group === 'temperature');
    await page.waitForFunction((eye) => Math.hypot(...globalThis.plantcast.session.camera.eye.map((x, i) => x - eye[i])) > 1, camera.eye);
    assert.equal(await page.evaluate(() => globalThis.plantcast.selection?.tag ?? document.querySelector('#card h3').textContent), HOT);
    await settle(page);
    await shoot(page, 'alarms-fly');
    await plant.ask(`set ${HOT} ${limitOf(HOT).H - 10}`);
    await page.waitForFunction((hot) => globalThis.plantcast.session.model.alarms.list().every(({ tag, state }) => tag.name !== hot ||
        state === 'returned'), HOT, { timeout: 30000 });
    assert.deepEqual(browser.errors, []);
});

const rowOf = (name) => page.locator('#alarms-list li').filter({ has: page.locator('.what b', { hasText: new RegExp(`^${name}$`) }) });
const settleAll = async () => { // sets all values within their limits and acknowledges all alarms
    for (const { name, limits } of tags.filter((tag) => tag.limits.H !== null))
        await plant.ask(`set ${name} ${((limits.L ?? 0) + limits.H) / 2}`);
    const gone = () => globalThis.plantcast.session.model.alarms.counts().active === 0;
    await page.waitForFunction(gone, null, { timeout: 30000 });
    await page.evaluate(() => {
        const { session } = globalThis.plantcast, alarms = [...session.model.alarms.rows.values()].map(({ tag, kind }) => [tag.name, kind]);
        for (const action of ['unshelve', 'acknowledge'])
            session.post({ type: 'alarm', seq: ++session.alarmSeq, action, alarms });
    });
    await waitForWords('^No active alarms$');
};

test('one row and one count for a tag; what has returned is not active, and drawn hollow', options, async () => {
    await settleAll();
    const { LL, L, H } = limitOf(LOW);
    await plant.ask(`set ${LOW} ${LL - 1}`);
    await page.waitForFunction((low) => [...globalThis.plantcast.session.model.alarms.rows.values()]
        .filter(({ tag }) => tag.name === low).length === 2, LOW, { timeout: 30000 });
    await waitForWords('^1 active alarm, 1 unacknowledged$');
    assert.equal(await rowOf(LOW).count(), 1);
    assert.match(await rowOf(LOW).textContent(), /Low-low.*also Low \(Unacknowledged\)/s);
    await plant.ask(`set ${LOW} ${(L + H) / 2}`);
    await waitForWords('^0 active, 1 unacknowledged$');
    assert.equal(await page.locator('#alarm-counts .hollow').count(), 1);
    await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'temperature' }));
    await waitForRing(LOW);
    await settle(page);
    const at = await ring(LOW);
    assert.equal(at.state, 'returned');
    // The ring of a returned alarm is white where an active alarm's ring has the colour of its priority.
    const [r, g, b] = await page.evaluate(({ x, y }) => {
        const box = document.getElementById('viewport').getBoundingClientRect(), { canvas, unit } = globalThis.plantcast.overlay;
        const ratio = canvas.width / box.width;
        globalThis.plantcast.overlay.draw();
        const px = [(x - box.left) * ratio, (y - box.top - 10 * unit) * ratio].map(Math.round);
        return [...canvas.getContext('2d').getImageData(px[0], px[1], 1, 1).data];
    }, at);
    assert.ok(Math.min(r, g, b) > 200, `${[r, g, b]}`);
    await shoot(page, 'alarms-returned');
    await rowOf(LOW).locator('button[data-action="acknowledge"]').click();
    await waitForWords('^No active alarms$');
});

test('several are acknowledged at once, only those that are seen; a filter', options, async () => {
    const three = tags.filter(({ group, limits }) => group === 'temperature' && limits.H !== null).slice(0, 3).map(({ name }) => name);
    for (const name of three)
        await plant.ask(`set ${name} ${limitOf(name).H + 0.1}`);
    await waitForWords('^3 active alarms, 3 unacknowledged$');
    await page.locator('#alarms-words').fill(three[0]);
    assert.equal(await page.locator('#alarms-list li').count(), 1);
    assert.ok(await page.locator('#alarms-many').isHidden(), 'one has a button of its own');
    await page.locator('#alarms-words').fill('');
    await page.locator('#alarms-which').selectOption('gone');
    assert.equal(await page.locator('#alarms-none').textContent(), 'No match among 3 alarms.');
    await page.locator('#alarms-which').selectOption('waiting');
    await page.locator('#alarms-all').check();
    await rowOf(three[0]).locator('.choose').uncheck();
    assert.equal(await page.locator('#alarms-acknowledge').textContent(), 'Acknowledge 2');
    await shoot(page, 'alarms-several');
    await page.locator('#alarms-acknowledge').click();
    await waitForWords('^3 active alarms, 1 unacknowledged$');
    assert.deepEqual(await page.locator('#alarms-list li .what b').allTextContents(), [three[0]]);
    await page.locator('#alarms-which').selectOption('all');
});

test('without a connection the strip says as of when, and offers nothing', options, async () => {
    const before = await words();
    await page.evaluate(() => {
        const { connection } = globalThis.plantcast.session;
        connection.hold(100000);
        connection.socket.close();
    });
    await waitForWords('^As of \\d\\d:\\d\\d:\\d\\d: ');
    assert.equal((await words()).replace(/^As of [\d:]+: /, ''), before);
    assert.ok(await page.locator('.stale #alarm-strip').isVisible());
    await page.waitForFunction(() => document.querySelectorAll('#alarms .do button').length === 0);
    assert.match(await page.locator('#alarms-stale').textContent(), /^Out of date: as of \d\d:\d\d:\d\d/);
    assert.equal(await page.evaluate(() => document.body.classList.contains('alarm-blink')), false);
    await shoot(page, 'alarms-disconnected');
    await page.evaluate(() => globalThis.plantcast.session.connection.retryNow());
    await waitForWords(`^${before}$`);
    assert.ok(await page.locator('#alarm-strip:not(.stale)').isVisible());
});

test('on a tablet in both orientations', options, async () => {
    await plant.ask(`set ${HOT} ${limitOf(HOT).HH + 1}`);
    for (const [name, screen] of [['landscape', TABLET], ['portrait', { ...TABLET, viewport: { width: 768, height: 1024 } }]]) {
        const tablet = await openPage(plant.url, screen);
        try {
            await waitForPicture(tablet.page);
            await tablet.page.waitForFunction(() => globalThis.plantcast.session.model.alarms.list().length > 0);
            await settle(tablet.page);
            await tablet.page.locator('#alarm-strip').tap();
            const small = await tablet.page.evaluate(() => [...document.querySelectorAll('#alarms button, #alarm-strip')]
                .filter((e) => e.getClientRects().length > 0 && e.getBoundingClientRect().height < 37.5).map((e) => e.id || e.textContent));
            assert.deepEqual(small, []);
            await shoot(tablet.page, `alarms-tablet-${name}`);
            assert.deepEqual(tablet.errors, []);
        } finally {
            await tablet.close();
        }
    }
});
