// SPDX-License-Identifier: GPL-3.0-or-later
// The page in its languages: no text is cut off.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { alarmed } from './alarmed.mjs';
import { DESKTOP, openPage, PHONE, resize, settle, shoot, TABLET, waitForPicture, withPage } from '../support/browser.mjs';
import { cutOff, everyPanel } from '../support/panels.mjs';
import { sweep, takes } from '../support/sweep.mjs';
import { notBuilt } from '../support/tiny_plant.mjs';
import { becomes } from '../support/until.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
let url;

before(async () => {
    if (!options.skip)
        [, url] = await alarmed();
});

const READERS = [['en', '.', /^\w{3} \d+, \d{4} /], ['ko', '.', /^\d{4}\. \d+\. \d+\. /], ['de', ',', /^\d\d\.\d\d\.\d{4} /]];
for (const [lang, decimal, date] of READERS.slice(sweep(0, 1))) {
    test(`in ${lang}: words, numbers, dates are right, and ${sweep('every panel', 'the page')} fits on every screen`, options, async () => {
        const browser = await openPage(`${url}?lang=${lang}`, DESKTOP), { page } = browser;
        const look = async (name) => {
            await becomes(() => cutOff(page), [], name);
            if (!name.endsWith('closed'))
                await shoot(page, `words-${lang}-${name}`);
        };
        try {
            await waitForPicture(page);
            assert.equal(await page.evaluate(() => document.documentElement.lang), lang);
            if (sweep(true, false)) // opens every panel only in long runs; in the default run accessible.mjs opens them all in German
                await everyPanel(page, look);
            else
                await page.evaluate(() => { // selects an asset, so that its readings are listed
                    const { session } = globalThis.plantcast;
                    session.setParams({ selected: session.model.assets[0].id });
                });
            await page.locator('.reading .value').first().waitFor();
            await page.locator('#clock', { hasText: date }).waitFor();
            await page.locator('.reading .value', { hasText: new RegExp(`^\\d+\\${decimal}\\d+ `) }).first().waitFor();
            for (const [name, { viewport }] of [['tablet', TABLET], ['phone', PHONE]]) {
                await resize(page, viewport);
                await settle(page);
                await look(`page-${name}`);
            }
            assert.deepEqual(browser.errors, []);
        } finally {
            await browser.close();
        }
    });
}

// By default only the language with the longest words is tried.
const LANGUAGES = sweep(['de', 'ko', 'en'], ['de']);

// The columns of the alarm list and of the journal that a desk of 1280 pixels shows.
const COLUMNS = ['state', 'priority', 'tag', 'kind', 'about', 'us', 'then', 'now', 'limit', 'since', 'do'];
// Returns the columns that a table does not show, the cells of its first row whose text is cut, and whether the page scrolls sideways.
// The description may be cut, because its title has the whole text.
const hiddenColumns = (page, tab) => page.evaluate(([name, columns]) => {
    const row = document.querySelector(`#${name}-list tr`), edge = document.getElementById('alarms').getBoundingClientRect().right;
    const cells = columns.map((col) => [col, row.querySelector(`[data-col=${col}]`)]), about = row.querySelector('[data-col=about]');
    const isCut = (cell) => cell.scrollWidth > cell.clientWidth || cell.scrollHeight > cell.clientHeight;
    return {
        hidden: cells.filter(([, { offsetWidth }]) => offsetWidth < 20).map(([col]) => col),
        cut: cells.filter(([col, cell]) => col !== 'about' && (isCut(cell) || cell.getBoundingClientRect().right > edge))
            .map(([col]) => col),
        untitled: isCut(about) && about.title !== about.textContent,
        scrolls: document.scrollingElement.scrollWidth > innerWidth,
    };
}, [tab, COLUMNS]);

// Draws the alarm list again as if two days had passed, so that alarms are not of today.
const showLater = (page) => page.evaluate(() => {
    const { session, modules } = globalThis.plantcast, us = session.clockUs() + 2 * 86400e6;
    session.clockUs = () => us;
    document.getElementById('alarms-list').replaceChildren();
    modules.there('alarms').show();
});

test('titles and current values of the alarm list and the journal are complete, also with sort marks', options, async () => {
    for (const [row, lang] of LANGUAGES.entries()) {
        await withPage(`${url}?lang=${lang}`, { viewport: { width: 1920, height: 900 } }, async (page) => {
            await waitForPicture(page);
            await page.locator('#alarm-strip').click();
            for (const [column, tab] of ['alarms', 'journal'].entries()) {
                await page.locator(`#${tab}-tab`).click();
                await page.locator(`#${tab}-list tr`).first().waitFor();
                const widths = [1920, 1600, 1400, 1280, 1260, 1240, 1200];
                for (const width of widths.filter((px, i) => px === 1200 || takes(row + column, i, 2))) {
                    await resize(page, { width, height: 900 });
                    const cut = await page.evaluate((name) => [...document.querySelectorAll(`#${name}-table thead th`)].filter((head) => {
                        const title = head.querySelector('button') ?? head;
                        head.querySelector('button')?.click();
                        const { clientWidth, clientHeight, scrollWidth, scrollHeight } = title;
                        return clientWidth > 1 && (scrollWidth > clientWidth || scrollHeight > clientHeight);
                    }).map(({ textContent }) => textContent), tab);
                    assert.deepEqual(cut, [], `${lang}, ${tab}, ${width}`);
                    const [needed, room] = await page.locator(`#${tab}-list td[data-col=now]`).first().evaluate((cell) => {
                        cell.firstChild.data = '200.00';
                        cell.querySelector('small').textContent = 'mm/s';
                        return [cell.scrollWidth, cell.clientWidth];
                    });
                    assert.ok(needed <= room, `${lang}, ${tab}, ${width}: a value of ${needed} pixels is cut at ${room}`);
                    if (width >= 1280) {
                        assert.deepEqual(await hiddenColumns(page, tab), { hidden: [], cut: [], untitled: false, scrolls: false },
                            `${lang}, ${tab}, ${width}`);
                        await shoot(page, `columns-${lang}-${tab}-${width}`);
                    }
                }
                await resize(page, { width: 1920, height: 900 });
            }
            await page.locator('#alarms-tab').click();
            await showLater(page);
            for (const width of [1920, 1280]) {
                await resize(page, { width, height: 900 });
                assert.deepEqual(await hiddenColumns(page, 'alarms'), { hidden: [], cut: [], untitled: false, scrolls: false },
                    `${lang}, ${width}, alarms of an earlier day`);
                assert.ok((await page.locator('#alarms-list tr').first().boundingBox()).height <= 29);
                await shoot(page, `columns-${lang}-earlier-${width}`);
            }
            for (const width of sweep([412, 390, 375, 360], [360])) {
                await resize(page, { width, height: 844 });
                const [needed, room] = await page.locator('#alarms-list td[data-col=state]').first().evaluate((cell) => {
                    const now = cell.parentElement.querySelector('[data-col=now]');
                    now.firstChild.data = '200.00';
                    now.querySelector('small').textContent = 'mm/s';
                    return [cell.scrollWidth, cell.clientWidth];
                });
                assert.ok(needed <= room, `${lang}, ${width}: a state of ${needed} pixels is cut at ${room}`);
            }
        });
    }
});

// Sizes of tablets in CSS pixels.
const TABLETS = [[1024, 768], [820, 1180], [768, 1024], [1180, 820], [1280, 800]];
// Writes long numbers into the first row of a table. Returns cells that overlap or leave the row, how many rows the list shows at
// once, buttons that are smaller than a finger, and columns on which a tap does not fly to the tag.
const rowFaults = (page, tab) => page.evaluate((name) => {
    const row = document.querySelector(`#${name}-list tr`), box = (element) => element.getBoundingClientRect(), area = box(row);
    const cells = [...row.cells].filter((cell) => box(cell).width > 0 && cell.dataset.col !== 'pick'), col = ({ dataset }) => dataset.col;
    for (const [column, text] of [['then', '200.00'], ['now', '200.00'], ['limit', '200.00']])
        row.querySelector(`[data-col=${column}]`).firstChild.data = text;
    row.querySelector('[data-col=now] small').textContent = 'mm/s';
    const apart = (a, b) => a.right <= b.left + 0.5 || b.right <= a.left + 0.5 || a.bottom <= b.top + 0.5 || b.bottom <= a.top + 0.5;
    const inside = ({ left, right, top, bottom }) => left >= area.left && right <= area.right && top >= area.top && bottom <= area.bottom;
    const hits = (cell) => document.elementFromPoint(box(cell).left + box(cell).width / 2, box(cell).top + box(cell).height / 2);
    return {
        over: cells.flatMap((a, i) => cells.slice(i + 1).filter((b) => !apart(box(a), box(b))).map((b) => `${col(a)} ${col(b)}`)),
        out: cells.filter((cell) => !inside(box(cell))).map(col),
        rows: Math.floor(document.querySelector(`#${name}-list`).closest('.scroll').clientHeight / area.height),
        small: [row, ...row.querySelectorAll('[data-col=do] button')].filter((e) => box(e).height < 43.5 || box(e).width < 43.5).length,
        dead: cells.filter((cell) => col(cell) !== 'do' && !hits(cell)?.closest('.alarm-go')).map(col),
    };
}, tab);

// Returns buttons of the alarm list, and the strip, that are lower than a finger; in a row of several lines, a tag's button extends
// over the whole row.
const lowButtons = (page) => page.evaluate(() => [...document.querySelectorAll('#alarms button, #alarm-strip')]
    .map((e) => (e.matches('.alarm-go') && getComputedStyle(e.closest('tr')).display === 'grid' ? e.closest('tr') : e))
    .filter((e) => e.getClientRects().length > 0 && e.getBoundingClientRect().height < 37.5).map((e) => e.id || e.textContent));

test('on tablets a row of the alarm list or the journal shows all columns and is finger-sized', options, async () => {
    for (const [row, lang] of LANGUAGES.entries()) {
        await withPage(`${url}?lang=${lang}`, TABLET, async (page) => {
            await waitForPicture(page);
            await page.locator('#alarm-strip').tap();
            for (const [column, tab] of ['alarms', 'journal'].entries()) {
                await page.locator(`#${tab}-tab`).tap();
                await page.locator(`#${tab}-list tr [data-col=do] button`).first().waitFor();
                for (const [width, height] of TABLETS.filter(([px], n) => px === 768 || takes(row + column, n, 2))) {
                    const name = `${lang}, ${tab}, ${width}x${height}`, faults = () => rowFaults(page, tab);
                    await resize(page, { width, height });
                    await becomes(async () => ({ ...await faults(), rows: 0 }), { over: [], out: [], rows: 0, small: 0, dead: [] },
                        name, 20);
                    await becomes(() => hiddenColumns(page, tab), { hidden: [], cut: [], untitled: false, scrolls: false }, name, 20);
                    await becomes(() => lowButtons(page), [], name, 20);
                    const { rows } = await faults();
                    assert.ok(rows >= 6, `${name}: the list shows ${rows} rows at once`);
                    await shoot(page, `tablet-${lang}-${tab}-${width}`);
                }
            }
            await page.locator('#alarms-tab').tap();
            await showLater(page);
            for (const [width, height] of sweep(TABLETS, [[768, 1024]])) {
                await resize(page, { width, height });
                await becomes(() => hiddenColumns(page, 'alarms'), { hidden: [], cut: [], untitled: false, scrolls: false },
                    `${lang}, ${width}x${height}, an alarm of an earlier day`, 20);
            }
        });
    }
});

// A phone's keyboard covers up to half of the screen. On a phone held sideways, rows are low.
test('on phones the dialogue to shelve an alarm and the row of the alarm are complete and finger-sized', options, async () => {
    for (const lang of LANGUAGES) {
        await withPage(`${url}?lang=${lang}`, PHONE, async (page) => {
            await waitForPicture(page);
            await page.locator('#alarm-strip').tap();
            for (const [width, height] of sweep([[390, 844], [360, 640], [844, 390], [667, 375]], [[360, 640], [667, 375]])) {
                await resize(page, { width, height });
                await page.locator('[data-action="shelve"]').first().tap();
                await page.locator('#shelve[open]').waitFor();
                const name = `${lang} ${width}x${height}`;
                await becomes(() => page.evaluate(() => {
                    const dialogue = document.getElementById('shelve'), { top, bottom, left, right } = dialogue.getBoundingClientRect();
                    const small = [...dialogue.querySelectorAll('button, select, input')].filter((e) => {
                        const box = e.getBoundingClientRect();
                        return box.width < 43.5 || box.height < 43.5 || box.left < left || box.right > right || box.bottom > bottom;
                    });
                    return { small: small.map(({ id }) => id),
                        inside: top >= 0 && left >= 0 && right <= innerWidth && bottom <= innerHeight / 2,
                        scrolls: dialogue.scrollHeight > dialogue.clientHeight || dialogue.scrollWidth > dialogue.clientWidth };
                }), { small: [], inside: true, scrolls: false }, name);
                await becomes(() => cutOff(page), [], name);
                await shoot(page, `shelve-${lang}-${width}`);
                await page.locator('#shelve-cancel').tap();
            }
            await resize(page, { width: 844, height: 390 });
            const row = page.locator('#alarms-list tr').first();
            await row.locator('button').first().waitFor();
            await becomes(() => row.evaluate((element) => {
                const cell = (col) => element.querySelector(`[data-col=${col}]`), { height, left, right } = element.getBoundingClientRect();
                cell('now').firstChild.data = '200.00';
                cell('now').querySelector('small').textContent = 'mm/s';
                const { left: x, top: y } = cell('state').getBoundingClientRect();
                return {
                    isLow: height <= 56,
                    cut: ['priority', 'tag', 'kind', 'now', 'state'].filter((col) => cell(col).scrollWidth > cell(col).clientWidth ||
                        cell(col).scrollHeight > cell(col).clientHeight),
                    small: [...cell('do').children].map((button) => button.getBoundingClientRect()).filter((box) => box.width < 43.5 ||
                        box.height < 43.5 || box.left < left || box.right > right),
                    // a tap anywhere on the row's text flies to the tag
                    flies: Boolean(document.elementFromPoint(x + 4, y + 4)?.closest('.alarm-go')),
                };
            }), { isLow: true, cut: [], small: [], flies: true }, lang);
            await shoot(page, `rows-${lang}-844`);
        });
    }
});
