// SPDX-License-Identifier: GPL-3.0-or-later
// A wall display whose server is killed repeatedly: it reports that, never shows an old picture as new, and recovers each time.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { openPage, shoot } from '../support/browser.mjs';
import { promise } from '../support/promise.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { missing, startTiny } from '../support/tiny_plant.mjs';

const lacking = missing(), why = lacking.length > 0 && `not built: ${lacking.join(', ')}`;
const LOSSES = Number(process.env.LOSSES) || sweep(3, 2);
const options = { skip: why, timeout: 240000 + LOSSES * 60000 };
const WALLS = `
views:
- { id: whole, title: Whole unit, view: "group=temperature" }
walls:
- id: room
  inches: 55
  distance_m: 3
  displays:
  - grid: [main tiles]
    panes:
    - { area: main, views: [whole] }
    - { area: tiles, tiles: [TI-1, PI-1] }
`;
let plant, wall;

setUp(why, async (own) => {
    plant = own(await startTiny(WALLS));
    wall = own(await openPage(`${plant.url}?wall=room`, { viewport: { width: 960, height: 540 } }));
});

// Returns the times of the readings in the pane's picture and in the texts next to it; 0: not received on the current
// connection yet.
const shown = () => wall.page.evaluate(() => {
    const inner = document.querySelector('.pane.views iframe')?.contentWindow.plantcast?.session, { session } = globalThis.wall;
    return { picture: inner?.isCurrent ? inner.picture?.dataTimeUs ?? 0 : 0, words: session.isCurrent ? session.freshAt : 0 };
});
const live = (since) => wall.page.waitForFunction(([picture, words]) => {
    const inner = document.querySelector('.pane.views iframe')?.contentWindow.plantcast?.session, { session } = globalThis.wall;
    return document.getElementById('lost').hidden && inner?.isCurrent && inner.picture?.dataTimeUs > picture && session.isCurrent &&
        session.freshAt > words;
}, [since.picture, since.words], { polling: 200 });

test(`each of ${LOSSES} losses of the server is reported, and the wall recovers by itself`, options, async (t) => {
    // waits until the wall page has built its panes; before that, another page is loaded
    await wall.page.waitForFunction(() => globalThis.wall?.panes.length > 0);
    await live({ picture: 0, words: 0 });
    let slowest = 0;
    for (let i = 0; i < LOSSES; i++) {
        const before = await shown();
        await plant.stopDaemon('SIGKILL');
        const lost = Date.now();
        await wall.page.locator('#lost').waitFor({ state: 'visible' });
        slowest = Math.max(slowest, Date.now() - lost);
        if (i === 0) {
            await wall.page.locator('#lost', { hasText: 'No connection to the plant since' }).waitFor();
            const px = await wall.page.evaluate(() => parseFloat(getComputedStyle(document.getElementById('lost')).fontSize));
            assert.ok(px >= 50, `the text is ${px} pixels high`);
            await shoot(wall.page, 'wall-lost');
        }
        await plant.startDaemon();
        await live(before);
    }
    console.log(`# said after ${slowest} ms at most`);
    promise(t, 'until it is said', slowest, 10000);
    assert.deepEqual(wall.errors, []);
});
