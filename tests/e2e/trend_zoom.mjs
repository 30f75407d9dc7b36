// SPDX-License-Identifier: GPL-3.0-or-later
// A trend of eight tags over 30 days, while live pictures arrive: a zoom draws the values of the new range within 300 ms on two cores.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, settle, shoot, waitForHealth, waitForPicture } from './support/browser.mjs';
import { missing, startPlant } from './support/plant.mjs';
import { promise } from './support/promise.mjs';
import { sweep } from './support/sweep.mjs';
import { runProgram } from './support/tiny_plant.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
const NAMES = ['TE-101', 'TE-102', 'TE-103', 'TE-104', 'TE-105', 'PT-101', 'PT-102', 'PT-103'];
const DAYS = 30, STEP_S = sweep(45, 450); // STEP_S: interval between the recorded values of a tag, in seconds
const ZOOMS = 9, MOST_MS = 300;
let plant, page;

// Writes recorded values of the tags over the last 30 days as CSV: a daily wave with noise. The history would leave out points of a
// smooth curve.
function record(file) {
    const noise = (n) => Math.abs(Math.sin(n * 12.9898) * 43758.5453) % 1;
    const endS = Math.floor(Date.now() / 1000) - STEP_S, beginS = endS - DAYS * 86400, lines = [['Time', ...NAMES].join()];
    for (let s = beginS, n = 0; s <= endS; s += STEP_S, n++) {
        const values = NAMES.map((_, i) => (8 + i + Math.sin(s / 13750) + noise(n * NAMES.length + i)).toFixed(3));
        lines.push([new Date(s * 1000).toISOString(), ...values].join());
    }
    writeFileSync(file, `${lines.join('\n')}\n`);
}

before(async () => {
    if (why)
        return;
    plant = await startPlant('', ({ file }) => {
        const series = join(dirname(file), 'series.csv');
        record(series);
        const { code, err } = runProgram('plantcast', ['history', 'import', file, series], 100000);
        assert.equal(code, 0, err);
    });
});
after(() => plant?.stop());

// Does something that changes the trend's range by releasing the mouse button. Returns the milliseconds from that event to the animation
// frame that shows the values of the new range.
async function timed(act) {
    await page.evaluate(() => {
        const { trends } = globalThis.plantcast;
        globalThis.drawn = new Promise((done) => addEventListener('pointerup', ({ timeStamp }) => {
            const lengthS = ([from, to]) => Math.round((to - from) / 1e6), before = lengthS(trends.range);
            const isDrawn = () => lengthS(trends.range) !== before && !trends.isAsking && lengthS(trends.span) === lengthS(trends.range);
            const look = () => (isDrawn() ? done(performance.now() - timeStamp) : requestAnimationFrame(look));
            requestAnimationFrame(look);
        }, { capture: true, once: true }));
    });
    await act();
    return page.evaluate(() => globalThis.drawn);
}

async function drag() {
    const { x, y, width, height } = await page.locator('#trend-chart .u-over').first().boundingBox();
    await page.mouse.move(x + 0.25 * width, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + 0.75 * width, y + height / 2, { steps: 4 });
    await page.mouse.up();
}

// Returns the smallest number of points that a tag's curve has in the drawn range, relative to the number of its recorded values or
// to 100, if more are recorded.
const leastDrawn = () => page.evaluate(([names, stepS]) => {
    const { series, span: [from, to] } = globalThis.plantcast.trends, recorded = (to - from) / 1e6 / stepS;
    return Math.min(...names.map((name) => series.get(name)?.points.filter(([us]) => us >= from && us <= to).length ?? 0)) /
        Math.min(100, recorded);
}, [NAMES, STEP_S]);

test('a page with eight series over 30 days draws a zoom within 300 ms', options, async (t) => {
    const browser = await openPage(plant.url, { viewport: { width: 1600, height: 900 } }), times = [];
    page = browser.page;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    await page.evaluate((names) => {
        const { showTrend, addTrend, session } = globalThis.plantcast;
        names.forEach((name, i) => (i === 0 ? showTrend : addTrend)(session.model.tag(name)));
    }, NAMES);
    await page.waitForFunction((count) => globalThis.plantcast.trends?.series.size === count, NAMES.length);
    await page.evaluate((spanS) => globalThis.plantcast.trends.goTo({ spanS }), DAYS * 86400);
    await page.waitForFunction((us) => {
        const { span: [from, to], isAsking } = globalThis.plantcast.trends;
        return !isAsking && to - from === us;
    }, DAYS * 86400e6);
    await settle(page);
    await shoot(page, 'trend-month');
    for (const act of [drag, () => page.locator('#trend-back').click()])
        for (let i = 0; i < ZOOMS; i++) {
            times.push(await timed(act));
            assert.ok(await leastDrawn() > 0.5, `curves of zoom ${i + 1} lack points`);
        }
    const sorted = [...times].sort((a, b) => a - b);
    t.diagnostic(`milliseconds per zoom: ${times.map(Math.round).join(' ')}`);
    promise(t, `median of ${times.length} zooms`, sorted[Math.floor(times.length / 2)], MOST_MS);
    promise(t, 'slowest zoom', sorted.at(-1), MOST_MS);
    assert.deepEqual(browser.errors, []);
    await browser.close();
});
