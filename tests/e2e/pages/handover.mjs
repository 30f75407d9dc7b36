// SPDX-License-Identifier: GPL-3.0-or-later
// The report for the shift handover, as a page and as a PDF: notes, alarms, who acknowledged them, and who shelved them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { openPage, shoot, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, startTiny } from '../support/tiny_plant.mjs';
import { until } from '../support/until.mjs';

const why = notBuilt();
const options = { skip: why, timeout: 200000 };
let plant, browser, page;

setUp(why, async (own) => {
    plant = own(await startTiny());
    browser = own(await openPage(plant.url, { viewport: { width: 1000, height: 1100 } }));
    page = browser.page;
    await waitForPicture(page);
    await plant.ask('set TI-1 95');
    await plant.ask('set TI-2 92');
    const raised = (...names) => page.waitForFunction((all) => all.every((name) =>
        [...globalThis.plantcast.session.model.alarms.rows.values()]
            .some(({ tag, state }) => tag.name === name && state === 'unacknowledged')), names);
    await raised('TI-1', 'TI-2');
    await page.evaluate(() => {
        const { session } = globalThis.plantcast;
        const rows = [...session.model.alarms.rows.values()].filter(({ state }) => state === 'unacknowledged');
        const alarms = rows.map(({ tag, kind }) => [tag.name, kind]);
        session.post({ type: 'alarm', seq: 1, action: 'acknowledge', alarms, name: 'kim' });
        session.post({ type: 'alarm', seq: 2, action: 'shelve', alarms: alarms.filter(([tag]) => tag === 'TI-1'), for_s: 3600,
            reason: 'sensor is checked', name: 'kim' });
        session.post({ type: 'note', seq: 1, text: 'Pump P-101A: <seal> drips', asset: 'P-101A', name: 'kim' });
    });
    await page.waitForFunction(() => globalThis.plantcast.session.notes.length === 1 &&
        ['TI-1', 'TI-2'].every((name) => [...globalThis.plantcast.session.model.alarms.rows.values()]
            .every(({ tag, state }) => tag.name !== name || ['acknowledged', 'shelved'].includes(state))));
    await plant.ask('set PI-1 95'); // the only alarm that nobody has acknowledged
    await raised('PI-1');
});

test('the handover page lists notes, alarms, acknowledgements and shelved alarms of the shift', options, async () => {
    // reloads the page until the journal contains the shelving, because the daemon writes the journal with a delay
    await until('the shelved alarm', async () => {
        await page.goto(`${plant.url}handover.html`);
        await page.locator('[data-part=notes]').waitFor();
        return await page.locator('[data-part=shelved] td', { hasText: 'sensor is checked' }).count() > 0;
    });
    const rows = (name) => page.locator(`[data-part=${name}] tbody tr`).allTextContents();
    assert.match((await rows('notes')).join(), /P-101A.*<seal> drips.*kim \(local\)/);
    assert.match((await rows('raised')).join(), /TI-1 · High.*95\.\d+ \(90\.\d+\) °C/);
    const counts = Object.fromEntries((await page.locator('.counts span').allTextContents()).map((text) => text.split(': ')));
    const standing = await rows('standing');
    const [first, second] = standing;
    assert.match(first, /PI-1 · High.*P-101A, pump.*Unacknowledged.*95\.\d+ \(90\.\d+\) bar/, 'the most urgent alarm comes first');
    assert.match(second, /TI-2 · High.*E-101, right.*Acknowledged.*92\.\d+ \(90\.\d+\) °C/);
    assert.equal(standing.length, 2);
    assert.equal(Number(counts['Active now']), standing.filter((text) => !text.includes('Returned')).length);
    assert.match((await rows('asides')).join(), /TI-1 · High.*Shelved.*sensor is checked/);
    assert.equal((await rows('acknowledged')).filter((text) => text.includes('TI-1')).length, 1, 'one action counts once');
    assert.match((await rows('acknowledged')).join(), /TI-1.*kim \(local\)/);
    assert.match((await rows('shelved')).join(), /TI-1.*kim \(local\).*sensor is checked/);
    await shoot(page, 'handover');
});

test('the handover says what could not be read, instead of counting 0', options, async () => {
    await page.route('**/api/v1/alarms**', (route) => route.fulfill({ status: 503, body: 'busy' }));
    await page.reload();
    await page.locator('[data-part=notes] td').first().waitFor();
    const counts = await page.locator('.counts b').allTextContents();
    const wrong = await page.locator('[data-part] > .wrong').allTextContents();
    await page.unroute('**/api/v1/alarms**');
    await page.reload();
    await page.locator('[data-part=standing] td').first().waitFor();
    assert.deepEqual(counts, ['–', '–', '–', '–']);
    assert.equal(wrong.length, 5);
    assert.ok(wrong.every((text) => text.startsWith('could not be read: ')), wrong.join());
});

test('the handover says that the alarm list is shortened, also if the journal cannot be read', options, async () => {
    await page.route('**/api/v1/alarms?**', async (route) => {
        const response = await route.fetch();
        await route.fulfill({ response, json: { ...await response.json(), next_offset: 10000 } });
    });
    await page.route('**/api/v1/alarms/journal?**', (route) => route.fulfill({ status: 503, body: 'busy' }));
    await page.reload();
    await page.locator('[data-part=notes] td').first().waitFor();
    const texts = await page.locator('#handover > .wrong').allTextContents();
    const raised = await page.locator('[data-part=raised] > .wrong').count();
    await page.unroute('**/api/v1/alarms?**');
    await page.unroute('**/api/v1/alarms/journal?**');
    await page.reload();
    await page.locator('[data-part=raised] td').first().waitFor();
    assert.equal(raised, 1);
    assert.match(texts.join(), /^List shortened/);
});

test('on a phone, each row of the handover is a block of titled lines', options, async () => {
    const screen = page.viewportSize();
    await page.setViewportSize({ width: 390, height: 844 });
    const cells = await page.locator('[data-part=notes] td:not(:empty)').evaluateAll((all) => all.map((cell) =>
        [cell.clientWidth, cell.scrollWidth <= cell.clientWidth, getComputedStyle(cell, '::before').content]));
    await page.setViewportSize(screen);
    assert.deepEqual(cells.map(([, isWhole, title]) => [isWhole, title.length > 3]), Array(4).fill([true, true]));
    assert.ok(cells.every(([width]) => width > 300), JSON.stringify(cells));
});

test('the handover prints on paper without controls, on as many pages as needed', options, async () => {
    const pdf = await page.pdf({ preferCSSPageSize: true });
    assert.equal(pdf.subarray(0, 5).toString(), '%PDF-');
    assert.ok(pdf.length > 10000);
    await page.emulateMedia({ media: 'print' });
    assert.equal(await page.locator('form').isVisible(), false);
    await page.emulateMedia({ media: 'screen' });
});

test('the handover of a requested time span, also in German, is empty before the first event; a wrong span is refused',
    options, async () => {
    await page.goto(`${plant.url}handover.html?from=-2h&to=-1h&lang=de`);
    await page.locator('h2', { hasText: /^Quittiert$/ }).waitFor();
    assert.equal(await page.locator('[data-part=acknowledged] tbody tr').count(), 0);
    await page.goto(`${plant.url}handover.html?from=tomorrow`);
    await page.locator('.wrong').waitFor();
});
