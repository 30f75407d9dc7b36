// SPDX-License-Identifier: GPL-3.0-or-later
// The first camera move on a new page that is still busy: its pictures are as good as later ones.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FLYING, grab, openPage, settle, shoot, waitForPicture } from './support/browser.mjs';
import { similarity } from './support/pixels.mjs';
import { missing, startPlant } from './support/plant.mjs';
import { setUp } from './support/set_up.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
const SCREEN = { viewport: { width: 1280, height: 720 } };
const LEAST = 0.95, WITHIN_MS = 1000, BUSY_MS = 350, QUIET_MS = 1500;
const SMALL_MS = 500;
let plant, browser, page;

// Blocks the page's main thread for this many milliseconds, as loading does, with a synchronous request, which uses no
// processor time.
const BUSY = `globalThis.busy = (ms) => {
        const request = new XMLHttpRequest();
        request.open('GET', '/busy?' + ms, false);
        request.send();
    };
    addEventListener('load', () => [0, 1000, 2000].forEach((at) => setTimeout(globalThis.busy, at, 700)));`;
const answerLate = (on) => on.route('**/busy?*', async (route) => {
    await new Promise((done) => setTimeout(done, Number(new URL(route.request().url()).search.slice(1))));
    await route.fulfill({ body: '' });
});

setUp(why, async (own) => {
    plant = own(await startPlant());
    const { tags } = await (await fetch(`${plant.url}api/v1/tags`)).json();
    await plant.freeze(tags.map(({ name }) => name));
    browser = own(await openPage(plant.url, { ...SCREEN, ...FLYING }, BUSY, answerLate));
    page = browser.page;
});

const shown = () => page.evaluate(() => {
    const { seq, camera, codec, fullWidth, fullHeight, still } = globalThis.plantcast.session.picture;
    return { seq, camera, codec, fullWidth, fullHeight, still };
});

const isSettled = (p) => p.evaluate(() => {
    const { picture, cameraSeq, cameraNews } = globalThis.plantcast.session;
    return picture.still && picture.cameraSeq === cameraSeq && !cameraNews;
});

test('the picture of the first camera move is as good as a refined one within a second', options, async (t) => {
    await waitForPicture(page);
    await settle(page, QUIET_MS);
    const box = await page.locator('#viewport').boundingBox(), [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let n = 1; n <= 12; n++) {
        await page.mouse.move(x + 5 * n, y + n);
        if (n % 4 === 0)
            await page.evaluate((ms) => globalThis.busy(ms), BUSY_MS);
        await page.waitForTimeout(16);
    }
    await page.mouse.up();
    const ended = performance.now(), seen = [];
    do { // records each picture and its properties
        const picture = await shown(), at = performance.now() - ended, image = await grab(page);
        if (picture.seq === (await shown()).seq && picture.seq !== seen.at(-1)?.seq)
            seen.push({ ...picture, at, image });
        if (seen.length === 1)
            await shoot(page, 'first-move');
    } while (!seen.at(-1)?.still || !await isSettled(page));
    const { image } = seen.at(-1), alike = seen.map((one) => similarity(one.image, image));
    const said = seen.map(({ at, codec, fullWidth, fullHeight, still }, n) =>
        `${at.toFixed(0)} ms: ${codec} of ${fullWidth}x${fullHeight}${still ? ', refined' : ''}, SSIM ${alike[n].toFixed(3)}`);
    t.diagnostic(said.join('; '));
    const good = seen[alike.findIndex((ssim) => ssim >= LEAST)], first = alike[seen.findIndex(({ still }) => still)];
    assert.ok(first >= LEAST, `the picture is refined at once, not in two stages: ${said.join('; ')}`);
    // Until SMALL_MS the page may get smaller previews, because the server does not know its bandwidth yet; later pictures must
    // have the full size.
    assert.ok(seen.every((one) => one.fullWidth === image.width || one.at <= SMALL_MS),
        `the picture has the viewport's size: ${said.join('; ')}`);
    assert.ok(good.at <= WITHIN_MS, said.join('; '));
    assert.deepEqual(browser.errors, []);
});
