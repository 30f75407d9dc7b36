// SPDX-License-Identifier: GPL-3.0-or-later
// Adjacent displays as people see them: the picture continues from one to the next, even though it is shifted to prevent
// burn-in.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { burnShift } from '../../../clients/web/core/wall.js';
import { openPage, SCREENSHOTS, shoot } from '../support/browser.mjs';
import { PlainClient } from '../support/plain_client.mjs';
import { pixelsOf } from '../support/png_pixels.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt } from '../support/tiny_plant.mjs';
import { savePng } from '../support/x_display.mjs';
import { startWide } from './wide.mjs';

const options = { skip: notBuilt(), timeout: 240000 };
const [WIDTH, HEIGHT] = [640, 360], SCREEN = { viewport: { width: WIDTH, height: HEIGHT } }, MARGIN = 3, STILL = 2;
const CAMERA = { type: 'camera', seq: 1, eye: [3.5, -7, 1], target: [1.5, 0, 0], up: [0, 0, 1], fov: 30 };
const shiftNow = () => burnShift(Date.now() * 1000);
let plant;

setUp(options.skip, async (own) => {
    plant = await startWide(own);
});

// Returns the picture of both displays and the margin around them, drawn for a single client of that size: { width, at(x, y) }.
async function wholePicture() {
    const client = await PlainClient.open(plant.port), width = 2 * WIDTH + 2 * MARGIN, height = HEIGHT + 2 * MARGIN;
    await client.hello({ width, height, codecs: ['png'] });
    client.say({ type: 'params', seq: 1, group: 'temperature' });
    client.say(CAMERA);
    const frame = await client.frameWhere('a refined picture', (one) =>
        one.camera_seq === 1 && one.params_seq === 1 && one.flags & STILL && one.width === width && one.height === height, 60000);
    client.close();
    return pictureOf(pixelsOf(frame.payload));
}

const pictureOf = ({ width, height, rgb }) => ({ width, height, at: (x, y) => [0, 1, 2].map((i) => rgb[3 * (y * width + x) + i]) });
// colours may differ slightly, because pictures are sent as JPEG or H.264
const isNear = (a, b) => a.every((value, i) => Math.abs(value - b[i]) < 40);

// Compares the pixels of two displays with the large picture, which is shifted by (x0, y0). Returns the smaller share of equal
// pixels: of those near edges (along the seam, and at the lower edge between legend and corner), or of those that show a box
// (neither white nor grey).
function agreement(screens, large, [x0, y0]) {
    const parts = { edges: [0, 0], box: [0, 0] };
    const look = (i, x, y, part = parts.edges) => {
        part[0] += isNear(screens[i].at(x, y), large.at(MARGIN - x0 + i * WIDTH + x, MARGIN - y0 + y));
        part[1]++;
    };
    for (let y = 0.35 * HEIGHT; y < 0.65 * HEIGHT; y += 4) {
        for (let x = 0.7 * WIDTH; x < 0.85 * WIDTH; x += 4)
            look(0, Math.round(x), Math.round(y), parts.box);
    }
    for (let k = 0; k < MARGIN; k++) {
        for (let y = Math.round(0.15 * HEIGHT); y < HEIGHT; y++) {
            look(0, WIDTH - 1 - k, y);
            look(1, k, y);
        }
        for (let x = Math.round(0.6 * WIDTH); x < Math.round(0.9 * WIDTH); x++)
            look(0, x, HEIGHT - 1 - k);
    }
    return Math.min(...Object.values(parts).map(([same, all]) => same / all));
}

// Waits for refined pictures and, if one is due, for the burn-in shift that happens every 3 minutes.
async function expectOnePicture(grab, name) {
    const large = await wholePicture();
    let share = 0, screens;
    for (const end = performance.now() + 60000; share < 0.97 && performance.now() < end; await sleep(500)) {
        screens = await grab();
        share = agreement(screens, large, shiftNow());
    }
    if (share < 0.97 || process.env.PLANTCAST_SHOTS === '1')
        screens.forEach((screen, i) => savePng(screen, join(SCREENSHOTS, `wall-seam-${name}-${i + 1}.png`)));
    assert.ok(share >= 0.97, `share of pixels equal to the large picture: ${share}`);
}

test('the pages of two adjacent displays show one picture without a line between them', options, async () => {
    const url = (display) => `http://127.0.0.1:${plant.port}/wall.html?wall=wide&display=${display}`;
    const pages = [await openPage(url(1), SCREEN), await openPage(url(2), SCREEN)];
    for (const { page } of pages)
        await page.waitForFunction(() => globalThis.wall?.panes[0]?.session?.picture);
    await expectOnePicture(() => Promise.all(pages.map(async ({ page }) => pictureOf(pixelsOf(await page.screenshot())))), 'page');
    for (const [i, { page }] of pages.entries())
        await shoot(page, `wall-seam-${i + 1}`);
    await Promise.all(pages.map(({ close }) => close()));
});
