// SPDX-License-Identifier: GPL-3.0-or-later
// Tests alarms in the browser: every view counts and marks them, the list shows the most urgent first, and users can
// acknowledge and shelve them and fly to their tags.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { DESKTOP, openPage, settle, shoot, view, waitForHealth, waitForPicture } from '../support/browser.mjs';
import { missing, startPlant } from '../support/plant.mjs';
import { setUp } from '../support/set_up.mjs';
import { becomes, until } from '../support/until.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
const HOT = 'TE-101', LOW = 'TE-101';
let plant, browser, page, tags;

setUp(why, async (own) => {
    plant = own(await startPlant('\nalarms: local\n'));
    browser = own(await openPage(plant.url, DESKTOP));
    page = browser.page;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    tags = await page.evaluate(() => globalThis.plantcast.session.model.tags.map(({ name, group, limits }) => ({ name, group, limits })));
    await plant.freeze(tags.map(({ name }) => name));
    for (const { name, limits } of tags.filter((tag) => tag.limits.H !== null)) // sets all values between their limits L and H
        await plant.ask(`set ${name} ${((limits.L ?? 0) + limits.H) / 2}`);
    await page.waitForFunction(() => globalThis.plantcast.session.model.alarms.counts().active === 0);
});

const words = () => page.locator('#alarm-words').textContent();
const waitForWords = (pattern) => page.waitForFunction(
    (p) => new RegExp(p).test(document.getElementById('alarm-words').textContent), pattern);
const limitOf = (name) => tags.find((tag) => tag.name === name).limits;
// Returns the position of a tag's alarm ring in the picture, and the alarm; null: no ring is drawn.
const ring = (name) => page.evaluate((tag) => {
    const { overlay } = globalThis.plantcast, found = overlay.markers.find((marker) => marker.tag.name === tag && marker.alarm);
    const box = document.getElementById('viewport').getBoundingClientRect();
    return found ? { x: box.left + found.x, y: box.top + found.y, kind: found.alarm.kind, state: found.alarm.state } : null;
}, name);
const waitForRing = (name) => page.waitForFunction((tag) => globalThis.plantcast.overlay.markers.some((marker) => marker.tag.name === tag &&
    marker.alarm), name);

test('readings beyond a limit are counted, marked and listed, the most urgent first', options, async () => {
    const shaken = tags.find(({ group, limits }) => group === 'vibration' && limits.H !== null).name;
    await plant.ask(`set ${shaken} ${limitOf(shaken).H + 0.1}`);
    await plant.ask(`set ${HOT} ${limitOf(HOT).HH + 1}`);
    await page.waitForFunction(([hot, other]) => {
        const alarms = globalThis.plantcast.session.model.alarms.list();
        return alarms.some(({ tag, kind }) => tag.name === hot && kind === 'HH') && alarms.some(({ tag }) => tag.name === other);
    }, [HOT, shaken]);
    await waitForWords('^2 active alarms, \\d+ unacknowledged$');
    assert.match(await page.locator('#alarm-mode').textContent(), /Plantcast alarms/);
    await becomes(async () => {
        const at = await ring(HOT);
        return [at?.kind, at?.state];
    }, ['HH', 'unacknowledged']);
    await page.locator('#alarm-strip').click();
    await page.locator('#alarms-list tr:first-child', { hasText: new RegExp(`${HOT}High-high.*${limitOf(HOT).HH + 1}`) }).waitFor();
    await settle(page);
    const [legend, list] = await Promise.all(['#legend', '#alarms'].map((id) => page.locator(id).boundingBox()));
    assert.ok(legend.x + legend.width <= list.x, 'the legend is beside the list');
    await shoot(page, 'alarms-desktop');
});

test('an alarm stays marked and counted in every group and display mode', options, async () => {
    const before = await words();
    for (const params of [{ group: 'vibration' }, { group: 'pressure', show: 'operator' },
        { group: 'temperature', show: 'distance', sensor: 'TE-102' },
        { group: 'temperature', show: 'operator' }]) {
        await page.evaluate((change) => globalThis.plantcast.session.setParams(change), params);
        await settle(page);
        await until(`the ring with ${JSON.stringify(params)}`, () => ring(HOT), 30);
        assert.equal(await words(), before);
        if (params.group === 'vibration')
            await shoot(page, 'alarms-other-group');
    }
    await shoot(page, 'alarms-operator');
    await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'temperature', show: 'value' }));
});

test('isolating other equipment hides the alarm\'s ring but not its count', options, async () => {
    const before = await words();
    const other = await page.evaluate((hot) => globalThis.plantcast.session.model.assets.find(({ id, tags: on }) => on.length > 0 &&
        id !== globalThis.plantcast.session.model.tag(hot).asset).id, HOT);
    await page.evaluate((id) => globalThis.plantcast.session.setParams({ isolate: [id] }), other);
    await page.waitForFunction((hot) => globalThis.plantcast.session.shown.isolate?.length > 0 &&
        globalThis.plantcast.overlay.markers.every(({ tag, alarm }) => tag.name !== hot || !alarm), HOT);
    assert.equal(await words(), before);
    await shoot(page, 'alarms-isolated');
    await page.evaluate(() => globalThis.plantcast.session.setParams({ isolate: [] }));
    await waitForRing(HOT);
});

test('an alarm is acknowledged by keyboard, and the keyboard focus stays on its row', options, async () => {
    const id = await page.evaluate((hot) => globalThis.plantcast.session.model.alarms.list().find(({ tag, kind }) => tag.name === hot &&
        kind === 'HH').id, HOT);
    await page.locator(`tr[data-alarm="${id}"] button[data-action="acknowledge"]`).focus();
    await page.keyboard.press('Enter');
    await page.waitForFunction((alarm) => globalThis.plantcast.session.model.alarms.rows.get(alarm)?.state === 'acknowledged', id);
    await page.locator(`tr[data-alarm="${id}"]`, { hasText: /Acknowledged.*by local/s }).waitFor();
    await page.locator(`tr[data-alarm="${id}"] button[data-action="acknowledge"]`).waitFor({ state: 'detached' });
    await becomes(() => page.evaluate(() => document.activeElement.closest('tr')?.dataset.alarm), id, 'the keyboard stays there');
});

test('an alarm\'s row stays under the pressed pointer while other alarms arrive', options, async () => {
    const { name, limits } = tags.find(({ group, limits: of, name: is }) => group === 'temperature' && of.HH !== null && is !== HOT);
    const row = page.locator('#alarms-list tr', { hasText: HOT }).first(), held = await row.elementHandle();
    const box = await row.locator('button[data-action="shelve"]').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await plant.ask(`set ${name} ${limits.H + 0.1}`);
    await page.locator('#alarms-list tr', { hasText: `${name}High` }).waitFor();
    assert.ok(await held.evaluate((tr) => tr.isConnected), 'the pressed row is still in the page');
    const now = await row.locator('button[data-action="shelve"]').boundingBox();
    await page.mouse.move(now.x + now.width / 2, now.y + now.height / 2);
    await page.mouse.up();
    await page.locator('#shelve[open]').waitFor();
    await page.locator('#shelve-cancel').click();
    await plant.ask(`set ${name} ${((limits.L ?? 0) + limits.H) / 2}`);
});

test('shelving needs a reason and hides the alarm', options, async () => {
    const id = await page.evaluate((hot) => globalThis.plantcast.session.model.alarms.list().find(({ tag, kind }) => tag.name === hot &&
        kind === 'HH').id, HOT);
    await page.locator(`tr[data-alarm="${id}"] button[data-action="shelve"]`).click();
    await page.locator('#shelve[open]').waitFor();
    assert.equal(await page.evaluate(() => document.activeElement.id), 'shelve-reason', 'the reason can be typed at once');
    await page.locator('#shelve button[type="submit"]').click();
    assert.ok(await page.locator('#shelve').isVisible(), 'without a reason nothing happens');
    await shoot(page, 'alarms-shelve');
    await page.locator('#shelve-reason').fill('transmitter is being changed');
    await page.locator('#shelve button[type="submit"]').click();
    const row = page.locator(`#alarms-aside tr[data-alarm="${id}"]`);
    await row.waitFor();
    await row.filter({ hasText: /Shelved.*until (?:\w{3} \d+ )?\d\d:\d\d, by local, transmitter is being changed/s }).waitFor();
    await row.locator('button[data-action="unshelve"]').click();
    /* after unshelving, the alarm is listed as one that calls for attention, like a new one */
    await page.locator(`#alarms-list tr[data-alarm="${id}"].calls`).waitFor();
});

test('a click on an alarm flies to its tag in the tag\'s group, and a return to normal is shown', options, async () => {
    await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'pressure' }));
    const { camera } = await view(page);
    await page.locator('#alarms-list tr .alarm-go').first().click();
    await page.waitForFunction(() => globalThis.plantcast.session.params.group === 'temperature');
    await page.waitForFunction((eye) => Math.hypot(...globalThis.plantcast.session.camera.eye.map((x, i) => x - eye[i])) > 1, camera.eye);
    await page.waitForFunction((hot) => globalThis.plantcast.selection.tag === hot, HOT);
    await settle(page);
    await shoot(page, 'alarms-fly');
    await plant.ask(`set ${HOT} ${limitOf(HOT).H - 10}`);
    await page.waitForFunction((hot) => globalThis.plantcast.session.model.alarms.list().every(({ tag, state }) => tag.name !== hot ||
        state === 'returned'), HOT);
    assert.deepEqual(browser.errors, []);
});

const rowOf = (name) => page.locator('#alarms-list tr').filter({ has: page.locator('td b', { hasText: new RegExp(`^${name}$`) }) });
const settleAll = async () => { // sets all values within their limits and acknowledges all alarms
    for (const { name, limits } of tags.filter((tag) => tag.limits.H !== null))
        await plant.ask(`set ${name} ${((limits.L ?? 0) + limits.H) / 2}`);
    const gone = () => globalThis.plantcast.session.model.alarms.counts().active === 0;
    await page.waitForFunction(gone);
    await page.evaluate(() => {
        const { session } = globalThis.plantcast, alarms = [...session.model.alarms.rows.values()].map(({ tag, kind }) => [tag.name, kind]);
        for (const action of ['unshelve', 'acknowledge'])
            session.post({ type: 'alarm', seq: ++session.alarmSeq, action, alarms });
    });
    await waitForWords('^No active alarms$');
};

test('a tag has one row and counts once; a returned alarm is not active, and is drawn hollow', options, async () => {
    await settleAll();
    const { LL, L, H } = limitOf(LOW);
    await plant.ask(`set ${LOW} ${LL - 1}`);
    await page.waitForFunction((low) => [...globalThis.plantcast.session.model.alarms.rows.values()]
        .filter(({ tag }) => tag.name === low).length === 2, LOW);
    await waitForWords('^1 active alarm, 1 unacknowledged$');
    await rowOf(LOW).filter({ hasText: /Low-low.*also Low \(Unacknowledged\)/s }).waitFor();
    assert.equal(await rowOf(LOW).count(), 1);
    await plant.ask(`set ${LOW} ${(L + H) / 2}`);
    await waitForWords('^0 active, 1 unacknowledged$');
    await becomes(() => page.locator('#alarm-counts .hollow').count(), 1);
    await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'temperature' }));
    await waitForRing(LOW);
    await settle(page);
    const at = await until('the ring of a returned alarm', async () => {
        const found = await ring(LOW);
        return found?.state === 'returned' && found;
    });
    // reads a pixel of the ring: a returned alarm's ring is white where an active one's has the colour of the priority
    const [r, g, b] = await page.evaluate(({ x, y }) => {
        const box = document.getElementById('viewport').getBoundingClientRect(), { canvas, unit } = globalThis.plantcast.overlay;
        const ratio = canvas.width / box.width;
        globalThis.plantcast.overlay.draw();
        const px = [(x - box.left) * ratio, (y - box.top - 10 * unit) * ratio].map(Math.round);
        return [...canvas.getContext('2d').getImageData(px[0], px[1], 1, 1).data];
    }, at);
    assert.ok(Math.min(r, g, b) > 200, `colour of the ring's middle: ${[r, g, b]}`);
    await shoot(page, 'alarms-returned');
    await rowOf(LOW).locator('button[data-action="acknowledge"]').click();
    await waitForWords('^No active alarms$');
});

test('a user acknowledges several alarms at once, only visible ones; a filter narrows the list', options, async () => {
    const three = tags.filter(({ group, limits }) => group === 'temperature' && limits.H !== null).slice(0, 3).map(({ name }) => name);
    for (const name of three)
        await plant.ask(`set ${name} ${limitOf(name).H + 0.1}`);
    await waitForWords('^3 active alarms, 3 unacknowledged$');
    await page.locator('#alarms-words').fill(three[0]);
    await becomes(() => page.locator('#alarms-list tr').count(), 1);
    assert.ok(await page.locator('#alarms-many').isHidden(), 'nothing is selected');
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
    await becomes(() => page.locator('#alarms-list td b').allTextContents(), [three[0]]);
    await page.locator('#alarms-which').selectOption('all');
});

test('a new alarm is announced once, with tag, state and value', options, async () => {
    await settleAll();
    // waits until the announcer is idle, because alarms of earlier tests may still be queued
    await page.waitForFunction(() => (globalThis.plantcast.modules.there('announcer')?.timer ?? null) === null);
    await page.evaluate(() => {
        const element = document.getElementById('alarm-said');
        globalThis.announced = [];
        new MutationObserver(() => globalThis.announced.push(element.textContent)).observe(element, { childList: true });
    });
    const { H } = limitOf(HOT);
    await plant.ask(`set ${HOT} ${H + 0.5}`);
    await page.waitForFunction(() => globalThis.announced.length > 0);
    await plant.ask(`set ${HOT} ${H + 0.75}`);
    await rowOf(HOT).locator('button[data-action="acknowledge"]').click();
    await waitForWords('^1 active alarm$');
    const [text, ...more] = await page.evaluate(() => globalThis.announced);
    assert.match(text, new RegExp(`^${HOT} High, Unacknowledged, raised at ${H}\\.5 °C, now .* \\(limit ${H}\\.0 °C\\)$`));
    assert.deepEqual(more, []);
});

test('in forced colours active and returned alarms still look different', options, async () => {
    await page.emulateMedia({ forcedColors: 'active' });
    await page.waitForFunction(() => [...document.styleSheets].some(({ href }) => href?.endsWith('common/contrast.css')));
    const looks = await page.evaluate(() => [1, 2, 3, 4].flatMap((p) => [`priority p${p}`, `priority p${p} hollow`]).map((name) => {
        const element = document.createElement('span');
        element.className = name;
        document.body.append(element);
        const { backgroundColor, color, borderStyle, clipPath, boxShadow } = getComputedStyle(element);
        element.remove();
        return [backgroundColor, color, borderStyle, clipPath, boxShadow].join();
    }));
    const frames = await page.evaluate(() => ['timeline past', 'moment'].map((name) => {
        const element = document.createElement('section');
        element.className = name;
        document.body.append(element);
        const { borderTopStyle, outlineStyle } = getComputedStyle(element);
        element.remove();
        return [borderTopStyle, outlineStyle].includes('solid');
    }));
    const grounds = await page.locator('#groups input').evaluateAll((all) => all.map((input) =>
        [input.checked, getComputedStyle(input.nextElementSibling).backgroundColor]));
    const [, chosen] = grounds.find(([isChecked]) => isChecked);
    await shoot(page, 'alarms-forced-colours');
    await page.emulateMedia({ forcedColors: 'none' });
    assert.ok(grounds.every(([isChecked, ground]) => isChecked === (ground === chosen)), `background of the chosen quantity: ${grounds}`);
    assert.deepEqual(frames, [true, true], 'the past is framed');
    const [ink, ground] = ['rgb(0, 0, 0)', 'rgb(255, 255, 255)'];
    assert.deepEqual(looks, [1, 2, 3, 4].flatMap(() => [`${ink},${ground},none,none,none`, `${ground},${ink},dashed,none,none`]));
});

test('with forced colours, the theme is that of the system, whatever the address and the browser\'s storage say', options, async () => {
    for (const scheme of ['dark', 'light']) {
        const other = await openPage(`${plant.url}?theme=${scheme === 'dark' ? 'light' : 'dark'}`,
            { viewport: { width: 1280, height: 800 }, forcedColors: 'active', colorScheme: scheme });
        await waitForPicture(other.page);
        assert.equal(await other.page.evaluate(() => document.documentElement.dataset.theme), scheme);
        const [chosen, ...grounds] = await other.page.locator('#groups input').evaluateAll((all) => [...all]
            .sort((a, b) => b.checked - a.checked).map((input) => getComputedStyle(input.nextElementSibling).backgroundColor));
        const highlight = await other.page.evaluate(() => {
            const element = document.createElement('i');
            Object.assign(element.style, { forcedColorAdjust: 'none', color: 'Highlight' });
            document.body.append(element);
            return getComputedStyle(element).color;
        });
        assert.ok(chosen === highlight && !grounds.includes(highlight), `background of the chosen quantity: ${chosen}, ${grounds}`);
        await other.close();
    }
});

// The list's rows that lie completely within its panel.
const wholeRows = () => page.evaluate(() => {
    const { bottom } = document.getElementById('alarms-now').getBoundingClientRect();
    const rows = [...document.querySelectorAll('#alarms-list tr')].map((row) => row.getBoundingClientRect());
    return { count: rows.filter((box) => box.bottom <= bottom).length, highest: Math.max(...rows.map(({ height }) => height)) };
});
const column = (col) => page.locator(`#alarms-list td[data-col=${col}]`).allTextContents();

test('at 900 pixels the alarm list shows at least twenty rows, sorts by any column, and filters by area', options, async () => {
    await settleAll();
    const many = tags.filter(({ group, limits }) => group === 'temperature' && limits.H !== null).slice(0, 26);
    for (const { name, limits } of many)
        await plant.ask(`set ${name} ${limits.H + 0.1}`);
    await waitForWords(`^${many.length} active alarms, ${many.length} unacknowledged$`);
    for (const width of [1280, 1600]) {
        await page.setViewportSize({ width, height: 900 });
        await settle(page);
        await until('twenty rows of at most 29 pixels', async () => {
            const { count, highest } = await wholeRows();
            return count >= 20 && highest <= 29;
        }, 30, async () => JSON.stringify(await wholeRows()));
        await shoot(page, `alarms-many-${width}`);
    }
    for (const [id, text] of [['#alarms-count', `${many.length}`],
        ['#alarms-which option[value=waiting]', `Unacknowledged (${many.length})`],
        ['#alarms-which option[value=gone]', 'Returned to normal (0)']])
        await becomes(() => page.locator(id).textContent(), text);
    await becomes(() => page.title().then((title) => title.slice(0, 5)), `(${many.length}) `);
    const names = many.map(({ name }) => name).sort((a, b) => a.localeCompare(b, undefined, { numeric: true }));
    const title = page.locator('#alarms-table th[data-col=tag]');
    await title.locator('button').click();
    assert.deepEqual([await column('tag'), await title.getAttribute('aria-sort')], [names, 'ascending']);
    await title.locator('button').click();
    assert.deepEqual([await column('tag'), await title.getAttribute('aria-sort')], [[...names].reverse(), 'descending']);
    await title.locator('button').click();
    const [area] = await column('area');
    await page.locator('#alarms-area').selectOption(area);
    assert.deepEqual([...new Set(await column('area'))], [area]);
    await shoot(page, 'alarms-area');
    await page.locator('#alarms-area').selectOption('');
    const priorities = await column('priority');
    for (const chosen of ['1', '2', '3', '4']) {
        await page.locator('#alarms-priority').selectOption(chosen);
        await becomes(() => column('priority'), priorities.filter((one) => one === chosen));
    }
    await page.locator('#alarms-priority').selectOption('');
});

test('the list\'s edge can be dragged and moved by keys; its size survives a reload and can be reset', options, async (t) => {
    const own = await openPage(plant.url, { viewport: { width: 1280, height: 800 } }), on = own.page, edge = on.locator('.alarms > .edge');
    t.after(() => own.close());
    const opened = async () => {
        await waitForPicture(on);
        await on.locator('#alarm-strip').click();
        await edge.waitFor({ state: 'attached' });
    };
    const width = () => on.evaluate(() => document.getElementById('alarms').offsetWidth);
    await opened();
    const usual = await width(), { x } = await edge.boundingBox();
    await on.mouse.move(x + 4, 400);
    await on.mouse.down();
    await on.mouse.move(x + 204, 400, { steps: 3 });
    await on.mouse.up();
    const dragged = await width();
    assert.ok(Math.abs(dragged - (usual - 200)) <= 5, `the list's edge moved from ${usual} to ${dragged}`);
    await edge.press('ArrowLeft');
    assert.equal(await width(), dragged + 40);
    // while the window is only 740 pixels wide the panel is narrower, but its stored width must not change
    for (const screen of [740, 1280]) {
        await on.setViewportSize({ width: screen, height: 800 });
        await on.reload();
        await opened();
    }
    assert.equal(await width(), dragged + 40);
    await edge.dblclick();
    assert.equal(await width(), usual);
    assert.deepEqual(own.errors, []);
});

test('several alarms are shelved at once with one reason; the list is exported', options, async () => {
    await page.locator('#alarms-list .choose').nth(0).check();
    await page.locator('#alarms-list .choose').nth(3).click({ modifiers: ['Shift'] });
    assert.match(await page.locator('#alarms-chosen').textContent(), /^4 selected$/);
    await page.locator('#alarms-list .choose').nth(2).uncheck();
    await page.locator('#alarms-list .choose').nth(3).uncheck();
    const two = (await column('tag')).slice(0, 2);
    await page.locator('#alarms-shelve').click();
    await page.locator('#shelve-reason').fill('work on the line');
    await shoot(page, 'alarms-shelve-two');
    await page.locator('#shelve button[type="submit"]').click();
    await page.locator('#alarms-many').waitFor({ state: 'hidden' });
    await page.waitForFunction(() => document.activeElement.closest('#alarms'), null, { timeout: 20000 });
    await page.waitForFunction(() => document.querySelectorAll('#alarms-aside tr').length === 2);
    assert.deepEqual((await page.locator('#alarms-aside td[data-col=tag]').allTextContents()).sort(), [...two].sort());
    assert.ok(await page.locator('#alarms-many').isHidden());
    const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#alarms-csv').click()]);
    const lines = readFileSync(await download.path(), 'utf8').trim().split('\r\n');
    assert.match(lines[0], /^time,state,event,priority,tag,kind,area,/);
    assert.equal(lines.filter((line) => line.includes('shelved') && line.endsWith('work on the line')).length, 2);
});

test('the journal has the list\'s columns, a time range, and each change', options, async () => {
    await page.locator('#journal-tab').click();
    const changes = () => page.locator('#journal-list tr').evaluateAll((rows) => rows.map((row) => row.dataset.event));
    await page.locator('#journal-list tr[data-event=shelve]', { hasText: 'work on the line' }).first().waitFor();
    assert.deepEqual(await page.locator('#journal-table th').evaluateAll((all) => all.map((th) => th.dataset.col)),
        await page.locator('#alarms-table th[data-col]').evaluateAll((all) => all.map((th) => th.dataset.col)));
    await page.locator('#journal-which').selectOption('raised');
    await becomes(async () => [...new Set(await changes())], ['raise']);
    await page.locator('#alarms-words').fill(HOT);
    await becomes(async () => [...new Set(await page.locator('#journal-list td[data-col=tag]').allTextContents())], [HOT]);
    await shoot(page, 'alarms-journal');
    const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#alarms-csv').click()]);
    const [titles, ...lines] = readFileSync(await download.path(), 'utf8').trim().split('\r\n').map((line) => line.split(','));
    assert.deepEqual([download.suggestedFilename(), titles[2]], ['alarm_journal.csv', 'event']);
    assert.equal(lines.length, await page.locator('#journal-list tr').count(), 'the file has the rows that the filter leaves');
    assert.ok(lines.every(([, , event, , tag]) => event === 'raise' && tag === HOT), JSON.stringify(lines));
    await page.locator('#journal-span').selectOption('chosen');
    for (const [id, text] of [['from', '2020-01-01T00:00'], ['to', '2020-01-02T00:00']])
        await page.locator(`#journal-${id}`).fill(text);
    await page.locator('#journal-list:empty').waitFor({ state: 'attached' });
    await page.locator('#journal-span').selectOption('day');
    await page.locator('#journal-list tr').first().waitFor();
    await page.locator('#alarms-words').fill('');
    await page.locator('#journal-which').selectOption('');
    await page.locator('#alarms-tab').click();
});

test('the moment before an alarm opens half a minute before it, at its place, and names the alarm', options, async () => {
    const row = page.locator('#alarms-list tr').first(), name = await row.locator('td[data-col=tag]').textContent();
    const before = await page.evaluate(() => globalThis.plantcast.session.camera.eye);
    const raisedUs = await page.evaluate((of) =>
        globalThis.plantcast.session.model.alarms.list().find(({ tag }) => tag.name === of).raisedUs, name);
    // Waits until the alarm is 4 s old. The history of an instant is complete after 3 s; for a newer instant the server would
    // show an earlier one.
    await page.waitForFunction((us) => globalThis.plantcast.session.clockUs() > us + 4e6, raisedUs);
    await row.locator('.moment-go').click();
    await page.waitForFunction(() => globalThis.plantcast.session.time.atUs !== null);
    assert.equal(await page.evaluate(() => globalThis.plantcast.session.time.atUs), Math.round(raisedUs - 30e6));
    await page.locator('#moment', { hasText: new RegExp(`${name} High.*raised .* · 30 s before`) }).waitFor();
    await page.waitForFunction((tag) => globalThis.plantcast.selection.tag === tag, name);
    await settle(page);
    assert.notDeepEqual(await page.evaluate(() => globalThis.plantcast.session.camera.eye), before, 'the camera flies to the tag');
    await page.waitForFunction((tag) => globalThis.plantcast.overlay.markers.some((marker) => marker.tag.name === tag &&
        !marker.occluded), name);
    const size = await page.locator('#moment strong').evaluate((e) => parseFloat(getComputedStyle(e).fontSize));
    assert.ok(size >= 20, `the alarm's name is ${size} px high`);
    await shoot(page, 'alarms-moment');
    await page.locator('#moment .at').click();
    await page.waitForFunction((us) => globalThis.plantcast.session.time.atUs === us, Math.round(raisedUs));
    await page.locator('#moment .live').click();
    await page.locator('#moment').waitFor({ state: 'hidden' });
    await page.setViewportSize(DESKTOP.viewport);
});

test('without a connection the alarm strip shows the time of its data, and offers no actions', options, async () => {
    const before = await words();
    await page.evaluate(() => {
        const { connection } = globalThis.plantcast.session;
        connection.hold(100000);
        connection.socket.close();
    });
    await waitForWords('^As of \\d\\d:\\d\\d:\\d\\d: ');
    assert.equal((await words()).replace(/^As of [\d:]+: /, ''), before);
    await page.locator('.stale #alarm-strip').waitFor();
    await page.waitForFunction(() => document.querySelectorAll('#alarms [data-action]').length === 0);
    await page.locator('#alarms-stale', { hasText: /^Out of date: as of \d\d:\d\d:\d\d/ }).waitFor();
    assert.equal(await page.evaluate(() => document.body.classList.contains('alarm-blink')), false);
    await shoot(page, 'alarms-disconnected');
    await page.evaluate(() => globalThis.plantcast.session.connection.retryNow());
    await waitForWords(`^${before}$`);
    await page.locator('#alarm-strip:not(.stale)').waitFor();
});
