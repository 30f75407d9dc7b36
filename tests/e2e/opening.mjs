// SPDX-License-Identifier: GPL-3.0-or-later
// Measures how soon the page shows the plant: from the request to the first picture on the screen.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { browserWith, DESKTOP } from './support/browser.mjs';
import { median } from './support/crowd.mjs';
import { missing, startPlant } from './support/plant.mjs';
import { setUp } from './support/set_up.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 400000 };
const MOST_MS = 1000, LOADS = 5, PATIENCE_MS = 120000;
const LAN = { offline: false, latency: 1, downloadThroughput: 12.5e6, uploadThroughput: 12.5e6 }; // latency 1 ms, 100 Mbit/s
let plant, browser;

setUp(why, async (own) => {
    plant = own(await startPlant());
    browser = own(await browserWith([]));
});

// Opens the page in a new browser profile. Returns the milliseconds until the first picture is on the screen.
async function load() {
    const context = await browser.newContext(DESKTOP), page = await context.newPage();
    const client = await context.newCDPSession(page);
    await client.send('Network.enable');
    await client.send('Network.emulateNetworkConditions', LAN);
    await page.addInitScript(() => {
        new MutationObserver((_, observer) => {
            if (!document.getElementById('waiting')?.hidden)
                return;
            observer.disconnect();
            // at the next animation frame the picture has been painted
            requestAnimationFrame(() => { globalThis.firstPictureMs = performance.now(); });
        }).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ['hidden'] });
    });
    await page.goto(plant.url, { timeout: PATIENCE_MS });
    await page.waitForFunction(() => globalThis.firstPictureMs, null, { timeout: PATIENCE_MS });
    const ms = await page.evaluate(() => globalThis.firstPictureMs);
    await context.close();
    return ms;
}

test(`the plant is on the screen within ${MOST_MS} ms of the page's request`, options, async (t) => {
    const times = [];
    while (times.length < LOADS)
        times.push(await load());
    const said = times.map((ms) => `${ms.toFixed(0)} ms`).join(', ');
    t.diagnostic(`first pictures: ${said}`);
    assert.ok(median(times) <= MOST_MS, `median of ${said}`);
});
