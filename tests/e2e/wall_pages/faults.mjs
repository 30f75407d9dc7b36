// SPDX-License-Identifier: GPL-3.0-or-later
// A display that shows one tile of a wall and whose clock is 5 s ahead of the server's: it must show each picture at the time
// that the server sets for all tiles.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { PlainClient } from '../support/plain_client.mjs';
import { promise } from '../support/promise.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt } from '../support/tiny_plant.mjs';
import { startWide } from './wide.mjs';

const options = { skip: notBuilt(), timeout: 240000 };
// EARLY_MS: a page may show a picture 4 ms before its time, and the clocks that it uses are rounded to milliseconds
const [WIDTH, HEIGHT] = [640, 360], NEAR_MS = 2500, EARLY_MS = 10;
let plant;

setUp(options.skip, async (own) => {
    plant = await startWide(own);
});

const url = () => `http://127.0.0.1:${plant.port}/`;

const presents = (client) => client.texts.filter(({ type }) => type === 'present');
const camera = (seq, x) => ({ type: 'camera', seq, eye: [x, -7, 1], target: [x, 0, 0], up: [0, 0, 1], fov: 30 });

// Returns the client of the wall's first tile. It leads (its camera applies to the wall) and acknowledges each frame at once,
// so it never delays the wall.
async function leading() {
    const leader = await PlainClient.open(plant.port);
    await leader.hello({ width: WIDTH, height: HEIGHT, codecs: ['jpeg'], tile: { wall: 'wide', display: 1 } });
    await leader.until('the lead', () => leader.texts.some(({ type, leads }) => type === 'tiles' && leads));
    leader.say({ type: 'params', seq: 1, group: 'temperature' });
    return leader;
}

test('the page of a tile whose clock is 5 s ahead shows each picture at the server\'s time', options, async (t) => {
    const leader = await leading();
    const { page, close } = await openPage(`${url()}wall.html?wall=wide&display=2`, { viewport: { width: WIDTH, height: HEIGHT } }, () => {
        const { now } = Date, { timeOrigin } = performance;
        Date.now = () => now.call(Date) + 5000;
        Object.defineProperty(performance, 'timeOrigin', { value: timeOrigin + 5000 });
    });
    await page.waitForFunction(() => globalThis.wall?.panes[0]?.session?.picture);
    // `off`: largest error in milliseconds of the page's estimate of the server's clock, which it derives from the answer to a ping
    await page.evaluate(() => {
        const { session } = globalThis.wall.panes[0];
        globalThis.shown = [];
        session.on('presented', ({ number }) => globalThis.shown.push({ number, at: Date.now() - 5000,
            off: session.pongs.reduce((least, { roundTripMs }) => Math.min(least, roundTripMs), Infinity) / 2 }));
    });
    // the page estimates the server's clock from the answer to its first ping, which it sends 2 s after its start
    await page.waitForFunction(() => globalThis.wall.panes[0].session.pongs.length > 0);
    let late = [];
    for (let seq = 1; late.length < 3; seq++) {
        leader.say(camera(seq, 1 + 0.02 * (seq % 50)));
        const isShown = ({ seq: number }) => leader.frames.some((frame) => frame.seq === number && frame.camera_seq === seq);
        await leader.until('the moved picture', () => presents(leader).some(isShown));
        const shown = await page.evaluate(() => globalThis.shown.filter(({ off }) => off < Infinity));
        late = shown.flatMap(({ number, at, off }) => presents(leader).filter(({ picture }) => picture === number)
            .map(({ at_us: us }) => ({ ms: at - us / 1000, off })));
    }
    assert.ok(late.every(({ ms, off }) => ms > -off - EARLY_MS), `no picture is shown before its time: ${JSON.stringify(late)}`);
    promise(t, 'a picture after its time', Math.min(...late.map(({ ms }) => ms)), NEAR_MS);
    await close();
    leader.close();
});
