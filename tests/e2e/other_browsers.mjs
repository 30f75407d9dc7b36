// SPDX-License-Identifier: GPL-3.0-or-later
// The page in Firefox and in WebKitGTK, whose engine Safari uses too: it opens, shows the plant and its words, warps the picture
// while a mouse drags it, and shows a sensor's card.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { drive, missingBrowser } from './support/drivers.mjs';
import { missing, TinyPlant } from './support/tiny_plant.mjs';

const absent = missing(), WIDTH = 1200, HEIGHT = 800;
let plant;

before(async () => {
    if (absent.length === 0)
        plant = await TinyPlant.running({ fresh: true });
});
after(() => plant?.destroy());

for (const name of ['firefox', 'webkit']) {
    const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : missingBrowser(name) ?? false;
    test(`${name}: shows the plant, warps the picture under a mouse, and shows a sensor's card`, { skip, timeout: 200000 }, async (t) => {
        const page = await drive(name, WIDTH, HEIGHT);
        t.after(() => page.close());
        await page.goto(`http://127.0.0.1:${plant.port}/?lang=en`);
        await page.wait(() => Boolean(globalThis.plantcast?.session.picture));
        assert.match(await page.evaluate(() => document.body.innerText), /Temperature/);
        const [x, y] = await page.evaluate(() => {
            const box = document.getElementById('viewport').getBoundingClientRect();
            return [box.left + box.width / 2, box.top + box.height / 2];
        });
        await page.pointer('mouseMoved', x, y);
        await page.pointer('mousePressed', x, y);
        const updates = () => page.evaluate(() => globalThis.plantcast.viewport.warp?.updates ?? 0);
        const end = performance.now() + 120000;
        for (let n = 0; performance.now() < end && await updates() < 5; n++)
            await page.pointer('mouseMoved', x + 60 * Math.sin(n / 5), y + 20 * Math.cos(n / 7));
        const painter = await page.evaluate(() => globalThis.plantcast.viewport.warp.painter.constructor.name);
        assert.ok(['CpuPainter', 'GlPainter'].includes(painter), painter);
        await page.pointer('mouseReleased', x, y);
        // waits until markers stand still, so that the click finds one
        const at = await page.wait(() => {
            const { session, overlay, viewport } = globalThis.plantcast, { picture, cameraSeq, cameraNews } = session;
            const marker = overlay.markers.find(({ occluded }) => !occluded), box = viewport.element.getBoundingClientRect();
            const rests = picture.still && picture.cameraSeq === cameraSeq && !cameraNews;
            return rests && marker && [box.left + marker.x, box.top + marker.y];
        });
        await page.pointer('mouseMoved', ...at);
        await page.pointer('mousePressed', ...at);
        await page.pointer('mouseReleased', ...at);
        await page.wait(() => Boolean(globalThis.plantcast.selection.tag));
        await page.wait(() => /Quality/.test(document.body.innerText));
    });
}
