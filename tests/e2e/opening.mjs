// SPDX-License-Identifier: GPL-3.0-or-later
// How soon a page shows the plant: measured on the page, from asking for it to the first picture on the screen.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Worker } from 'node:worker_threads';
import { availableParallelism } from 'node:os';
import { browserWith, DESKTOP } from './support/browser.mjs';
import { median } from './support/crowd.mjs';
import { missing, startPlant } from './support/plant.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 400000 };
const MOST_MS = 1000, LOADS = 5, MOST_TRIES = 12, TRIED_MS = 60000, PATIENCE_MS = 120000;
const SPIN_MS = 80, LEAST_SHARE = 0.85; // of the processors: below it something else takes too much of them for a time to mean anything
const LAN = { offline: false, latency: 1, downloadThroughput: 12.5e6, uploadThroughput: 12.5e6 }; // 1 ms, 100 Mbit/s
let plant, browser;

// What the machine gives: all processors are kept busy for a while.
const spin = `const { parentPort } = require('node:worker_threads');
    parentPort.on('message', (ms) => { for (const end = performance.now() + ms; performance.now() < end;); parentPort.postMessage(0); });`;
const spinners = [];
async function share() {
    const began = performance.now(), used = process.cpuUsage();
    await Promise.all(spinners.map((spinner) => new Promise((done) => {
        spinner.once('message', done);
        spinner.postMessage(SPIN_MS);
    })));
    const { user, system } = process.cpuUsage(used);
    return (user + system) / 1000 / ((performance.now() - began) * spinners.length);
}

async function startSpinners() {
    while (spinners.length < availableParallelism())
        spinners.push(new Worker(spin, { eval: true }));
    await share(); // they start
}

before(async () => {
    if (why)
        return;
    plant = await startPlant();
    browser = await browserWith([]);
});
after(async () => {
    await Promise.all(spinners.map((spinner) => spinner.terminate()));
    await browser?.close();
    await plant?.stop();
});

// By who was never here: { ms: until the first picture was on the screen, share: of the processors that was ours before or after,
// whichever is less; 0 where nobody asked }.
async function load(asks) {
    const context = await browser.newContext(DESKTOP), page = await context.newPage(), calm = asks ? await share() : 0;
    const client = await context.newCDPSession(page);
    await client.send('Network.enable');
    await client.send('Network.emulateNetworkConditions', LAN);
    await page.addInitScript(() => {
        new MutationObserver((_, observer) => {
            if (!document.getElementById('waiting')?.hidden)
                return;
            observer.disconnect();
            requestAnimationFrame(() => { globalThis.firstPictureMs = performance.now(); }); // it is drawn by then
        }).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ['hidden'] });
    });
    await page.goto(plant.url, { timeout: PATIENCE_MS });
    await page.waitForFunction(() => globalThis.firstPictureMs, null, { timeout: PATIENCE_MS });
    const ms = await page.evaluate(() => globalThis.firstPictureMs);
    await context.close();
    return { ms, share: asks ? Math.min(calm, await share()) : 0 };
}

// Time that something else took only makes it later: what is soon enough beside it is soon enough.
test(`the plant is on the screen ${MOST_MS} ms after the page was asked for, wherever the machine has the time`, options, async (t) => {
    const loads = [], began = performance.now(), times = (least) => loads.filter((one) => one.share >= least).map(({ ms }) => ms);
    const isSoon = (list) => list.length >= LOADS && median(list) <= MOST_MS;
    do {
        if (loads.length === LOADS) // and they were not soon
            await startSpinners();
        loads.push(await load(spinners.length > 0));
    } while (loads.length < MOST_TRIES && performance.now() - began < TRIED_MS && !isSoon(times(0)) && times(LEAST_SHARE).length < LOADS);
    const said = loads.map((one) => `${one.ms.toFixed(0)} ms${one.share > 0 ? ` with ${(100 * one.share).toFixed(0)} %` : ''}`).join(', ');
    t.diagnostic(`first pictures, and the share of the processors: ${said}`);
    if (isSoon(times(0)))
        return;
    if (times(LEAST_SHARE).length < LOADS)
        t.skip(`something else keeps the machine busy: ${said}`);
    else
        assert.fail(`median of ${median(times(LEAST_SHARE)).toFixed(0)} ms: ${said}`);
});
