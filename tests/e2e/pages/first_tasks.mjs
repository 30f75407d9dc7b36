// SPDX-License-Identifier: GPL-3.0-or-later
// Ten tasks of a user who opens the page for the first time, and the number of clicks that each takes. Typing a text, and
// pressing Enter after it, does not count. tests/bench/notes/first_tasks.md lists the figures.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, runProgram, startTiny } from '../support/tiny_plant.mjs';

const why = notBuilt();
const options = { skip: why, timeout: 200000 };
const MOST = 3; // maximum number of clicks per task
let plant, browser, page, clicks = 0;

// Imports nine hours of history, because a new trend shows eight hours, but less if the history is shorter.
function remember({ folder, file }) {
    const now = Math.floor(Date.now() / 1000), path = join(folder, 'series.csv'), lines = ['Tag,Time,Value,Quality'];
    for (let s = 9 * 3600; s > 60; s -= 60)
        lines.push(`TI-1,${now - s},80,Good`, `TI-2,${now - s},20,Good`);
    writeFileSync(path, `${lines.join('\n')}\n`);
    const { code, err } = runProgram('plantcast', ['history', 'import', file, path]);
    assert.equal(code, 0, err);
}

setUp(why, async (own) => {
    plant = own(await startTiny('', [], remember));
    browser = own(await openPage(plant.url, { viewport: { width: 1440, height: 900 } }));
    page = browser.page;
    await waitForPicture(page);
    await page.waitForFunction(() => globalThis.plantcast.session.recorded);
    await plant.ask('set TI-1 95');
    await page.waitForFunction(() => [...globalThis.plantcast.session.model.alarms.rows.values()]
        .some(({ state }) => state === 'unacknowledged'));
});

// Clicks on an element and counts it. Clicks are counted here, not in the page, because the browser's driver clicks again if an
// element moves.
const click = (what, text) => {
    clicks++;
    return page.locator(what, text ? { hasText: text } : {}).first().click();
};
const until = (f) => page.waitForFunction(f);
const type = async (text) => {
    await page.keyboard.type(text);
    await page.keyboard.press('Enter');
};

const TASKS = {
    'find the hottest tag': [2, async () => {
        await click('#views-toggle');
        await click('[data-extreme=highest]');
        await page.locator('#card h3', { hasText: 'TI-1' }).waitFor();
    }],
    'acknowledge an alarm': [2, async () => {
        await click('#alarm-strip');
        await click('#alarms-list [data-action=acknowledge]');
        await until(() => [...globalThis.plantcast.session.model.alarms.rows.values()].some(({ state }) => state === 'acknowledged'));
    }, () => click('#alarms-close')],
    'see the moment before an alarm': [2, async () => {
        await click('#alarm-strip');
        await click('#alarms-list .moment-go');
        await page.locator('#moment').waitFor();
        await until(() => globalThis.plantcast.session.time.atUs !== null);
    }, async () => {
        await click('#moment button >> nth=-1');
        await until(() => globalThis.plantcast.session.time.atUs === null);
        await click('#alarms-close');
        if (await page.locator('#timeline').isVisible())
            await click('#time-toggle');
    }],
    'plot two tags over the last 8 hours': [3, async () => {
        await click('#assets-list .reading', 'TI-1');
        await click('#card .trend');
        await click('#trend-add');
        await type('TI-2');
        await until(() => {
            const { trends } = globalThis.plantcast;
            return trends?.series.size === 2 && trends.span[1] - trends.span[0] === 8 * 3600e6;
        });
    }, () => click('#trend-close')],
    'compare now with yesterday': [2, async () => {
        await click('#time-toggle');
        await click('#time-compare');
        await page.locator('#compare-half').waitFor();
    }, async () => {
        await click('#compare-bar button');
        await click('#time-toggle');
    }],
    'write a note for the shift': [2, async () => {
        await click('#views-toggle');
        await click('#note-text');
        await type('Fire drill at 14:00');
        await until(() => globalThis.plantcast.session.notes.length === 1);
    }, () => page.keyboard.press('Escape')],
    'share a view': [2, async () => {
        await click('#share-open');
        await click('#share-copy');
        await until(() => /\/v\/\w+$/.test(document.getElementById('share-link').value));
    }, () => page.keyboard.press('Escape')],
    'find a tag by its name': [2, async () => {
        await click('#assets-search');
        await page.keyboard.type('PI-1');
        await click('#assets-list .reading', 'PI-1');
        await page.locator('#card h3', { hasText: 'PI-1' }).waitFor();
    }, () => page.locator('#assets-search').fill('')],
    'shelve an alarm with a reason': [2, async () => {
        await click('#alarm-strip');
        await click('#alarms-list [data-action=shelve]');
        await page.locator('#shelve[open]').waitFor();
        await type('transmitter is being changed');
        await until(() => [...globalThis.plantcast.session.model.alarms.rows.values()].some(({ state }) => state === 'shelved'));
    }, () => click('#alarms-close')],
    'isolate equipment': [3, async () => {
        await click('#assets-list .asset', 'E-101');
        await click('#views-toggle');
        await click('#shows [data-how=only]');
        await until(() => globalThis.plantcast.session.params.isolate?.join() === 'E-101');
    }],
};

for (const [name, [most, task, end = () => {}]] of Object.entries(TASKS))
    test(`a new user needs ${most} clicks: ${name}`, options, async () => {
        clicks = 0;
        await task();
        assert.ok(clicks === most && clicks <= MOST, `the task took ${clicks} clicks`);
        await end();
    });
