// SPDX-License-Identifier: GPL-3.0-or-later
// After every part of the page was opened and closed, and after alarms were raised and cleared, the page has no more nodes and
// listeners than before. `make test-long` also compares its memory.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { openPage, settle, travel, waitForHealth, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { notBuilt, startTiny } from '../support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 300000 };
// WARM_UP: unmeasured cycles; CYCLES: measured ones; HEAP_KB: largest allowed growth of the heap in kB per cycle. The heap may take
// some ten cycles to reach its size, so up to BATCHES times CYCLES are measured until it grows less: a leak grows in each of them.
const WARM_UP = sweep(3, 1), CYCLES = sweep(5, 1), HEAP_KB = sweep(10, Infinity), BATCHES = 4;
// TRIES: maximum number of comparisons of the page before and after a cycle, PAUSE_MS apart. They are repeated because the page
// may differ for a moment, for example while it shows a message.
const TRIES = 40, PAUSE_MS = 250;
// Runs JavaScript without compiled code, whose size depends on how long functions run. Without it the heap has nearly the same
// size in each run. Only runs that compare the heap need this: it doubles the processor time.
const JITLESS = sweep(['--js-flags=--jitless'], []);
let plant, browser, page, devTools;

setUp(options.skip, async (own) => {
    plant = own(await startTiny());
    browser = own(await openPage(plant.url, { viewport: { width: 1280, height: 800 }, args: JITLESS }));
    page = browser.page;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    // waits until recorded history begins more than 6 s ago, because the page treats instants of the last 4 s as the present
    await page.waitForFunction(() => {
        const { session } = globalThis.plantcast;
        return session.time.fromUs && session.clockUs() - session.time.fromUs > 6e6;
    });
    devTools = await page.context().newCDPSession(page);
    await devTools.send('Performance.enable');
    await devTools.send('HeapProfiler.enable');
});

async function measure() {
    await devTools.send('HeapProfiler.collectGarbage');
    const { metrics } = await devTools.send('Performance.getMetrics');
    const { Nodes: nodes, JSEventListeners: listeners, JSHeapUsedSize: heap } =
        Object.fromEntries(metrics.map(({ name, value }) => [name, value]));
    // Subtracts the contents of the sensor card (drift, neighbours, alarm) and of the list of sensors that disagree with their
    // neighbours, where each sensor has a button. They depend on which answers had arrived when the part was closed.
    const { card = 0, disagreeing = 0, drifting = 0 } = await contents(), buttons = await page.locator('#disagreeing button').count();
    return { nodes: nodes - card - disagreeing - drifting, listeners: listeners - buttons, heap };
}

// Returns, for each element of the document with an id, how many nodes it contains directly or through elements without an id.
const contents = () => page.evaluate(() => {
    const counts = {}, walker = document.createTreeWalker(document);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const { id } = (node.parentElement ?? document.documentElement).closest('[id], html');
        counts[id] = (counts[id] ?? 0) + 1;
    }
    return counts;
});

const shows = (selector, is = true) => page.waitForFunction(([wanted, on]) =>
    [...document.querySelectorAll(wanted)].some((element) => element.checkVisibility()) === on, [selector, is]);
async function press(id) {
    await page.waitForFunction((name) => document.getElementById(name) !== null, id);
    await page.evaluate((name) => document.getElementById(name).click(), id);
}

async function setAlarm(on) {
    await plant.ask(`set TI-1 ${on ? 95 : 80}`);
    await page.waitForFunction((is) => globalThis.plantcast.session.model.alarms.list().some(({ tag, state }) =>
        tag.name === 'TI-1' && state === (is ? 'unacknowledged' : 'returned')), on);
}

async function twice(button, selector) {
    const was = await page.locator(selector).isVisible();
    for (const is of [!was, was]) {
        await press(button);
        await shows(selector, is);
    }
}

async function dialog(button, selector) {
    await press(button);
    await shows(selector);
    await page.keyboard.press('Escape');
    await shows(selector, false);
}

const ACTIONS = {
    alarm: async () => {
        await setAlarm(true);
        await setAlarm(false);
    },
    journal: async () => {
        await press('alarm-strip');
        await press('journal-tab');
        await shows('#journal-list tr');
        await setAlarm(true);
        await setAlarm(false);
        await press('alarms-tab');
        await shows('#alarms-list tr');
        await press('alarm-strip');
        await shows('#alarms', false);
    },
    card: async () => {
        for (const name of ['TI-1', 'TI-2', null]) {
            await page.evaluate((tag) => globalThis.plantcast.selectTag(tag && globalThis.plantcast.session.model.tag(tag)), name);
            // waits until the lazily loaded card is visible and shows this tag, or is hidden for null
            await page.waitForFunction((tag) => {
                const card = document.getElementById('card');
                return tag ? card.checkVisibility() && card.querySelector('h3')?.textContent === tag : !card.checkVisibility();
            }, name);
        }
    },
    trend: async () => {
        await page.evaluate(() => globalThis.plantcast.showTrend(globalThis.plantcast.session.model.tag('TI-1')));
        await shows('#trend-chart canvas');
        await press('trend-close');
        await shows('#trends', false);
    },
    past: async () => {
        await travel(page, await page.evaluate(() => globalThis.plantcast.session.time.fromUs + 1e6));
        await page.waitForFunction(() => globalThis.plantcast.session.picture.past);
        await shows('#timeline');
        await press('time-toggle');
        await page.waitForFunction(() => !globalThis.plantcast.session.picture.past);
        await shows('#timeline', false);
    },
    split: async () => {
        for (const is of [true, false]) {
            await press('split-toggle');
            await page.waitForFunction((on) => Boolean(globalThis.plantcast.session.params.split) === on, is);
        }
    },
    theme: async () => {
        await press('theme');
        await press('theme');
    },
    views: () => twice('views-toggle', '#views'),
    picture: () => twice('picture-toggle', '#picture-panel'),
    equipment: () => twice('assets-toggle', '#assets'),
    help: () => dialog('help-open', 'dialog[open]'),
    share: () => dialog('share-open', 'dialog[open]'),
    group: async () => {
        for (const group of ['pressure', 'temperature']) {
            await page.evaluate((id) => globalThis.plantcast.session.setParams({ group: id }), group);
            await settle(page);
        }
    },
};

test('repeating all actions leaves as many DOM nodes and listeners as before', options, async (t) => {
    const cycles = async (count) => {
        for (let i = 0; i < count; i++)
            for (const act of Object.values(ACTIONS))
                await act();
        await settle(page);
    };
    await cycles(WARM_UP);
    const first = await measure(), contained = await contents();
    await cycles(CYCLES);
    let last = await measure();
    for (let i = 0; i < TRIES && (last.nodes > first.nodes || last.listeners > first.listeners); i++) {
        await new Promise((go) => setTimeout(go, PAUSE_MS));
        last = await measure();
    }
    const contains = await contents();
    let grownKb = (last.heap - first.heap) / 1024 / CYCLES;
    for (let n = 1, { heap } = last; n < BATCHES && grownKb >= HEAP_KB; n++) {
        await cycles(CYCLES);
        const now = (await measure()).heap;
        grownKb = (now - heap) / 1024 / CYCLES;
        heap = now;
    }
    const grown = Object.keys(contains).filter((id) => contains[id] > (contained[id] ?? 0)).map((id) => [id, contained[id], contains[id]]);
    const said = JSON.stringify({ first, last, grown });
    t.diagnostic(said);
    assert.ok(last.nodes <= first.nodes && last.listeners <= first.listeners, said);
    assert.ok(grownKb < HEAP_KB, `memory grows by ${grownKb} kB per cycle, ${said}`);
    assert.deepEqual(browser.errors, []);
});
