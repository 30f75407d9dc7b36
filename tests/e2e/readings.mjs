// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon sends changed readings at once, uses almost no processor time for unchanged ones, and marks a reading stale even
// if no device writes anything.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { PlainClient, get } from './support/plain_client.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, TinyPlant } from './support/tiny_plant.mjs';
import { median, sleep } from './support/crowd.mjs';
import { promise } from './support/promise.mjs';
import { until } from './support/until.mjs';

const FLAG_STILL = 2, FLAG_MORE = 8, FLAG_DATA = 16, CHANGES = 7;
const options = { skip: notBuilt(), timeout: 240000 };
let plant, client;

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.running());
    client = own(await PlainClient.open(plant.port));
    await client.hello({ width: 320, height: 240 });
    await client.frameWhere('a refined frame', (f) => (f.flags & FLAG_STILL) !== 0);
});

// Returns how often per second the daemon's main thread (event loop) went to sleep, measured for this many seconds.
async function sleeps(seconds) {
    const { pid } = plant.daemon.child;
    const count = () => Number(readFileSync(`/proc/${pid}/task/${pid}/status`, 'utf8').match(/^voluntary_ctxt_switches:\s*(\d+)/m)[1]);
    const start = count();
    await sleep(seconds * 1000);
    return (count() - start) / seconds;
}

test('an event loop with nothing to do sleeps', options, async () => {
    // a loop that polled every 100 ms would wake ten times in each second
    await until('three seconds in which the loop wakes less than five times a second', async () => await sleeps(3) < 5);
});

// All tags are read every 100 ms, so the frame's oldest reading is about as old as the change that caused the frame. Its age is
// the delay from the change to the frame.
test('a changed reading is sent without waiting for a tick', options, async (t) => {
    const ages = [];
    for (let i = 0; i < CHANGES; i++) {
        const shown = client.frames.length;
        await plant.tell(`set TI-1 ${60 + i % 2}`);
        const made = (f) => client.frames.indexOf(f) >= shown && (f.flags & FLAG_DATA) !== 0 && (f.flags & FLAG_MORE) === 0;
        ages.push((await client.frameWhere(`change ${i}`, made)).oldest_age_ms);
        await client.frameWhere(`change ${i}, refined`, (f) => client.frames.indexOf(f) >= shown && (f.flags & FLAG_STILL) !== 0);
        await sleep(37 * (i % 5)); // makes the next change at another phase of a possible tick
    }
    // The median delay must be at most 35 ms; it would be 50 ms if the event loop looked for changes every 100 ms.
    promise(t, `from a reading to its frame, median of ${ages.join(', ')} ms`, median(ages), 35);
});

test('an answer between changes has the present time and current ages', options, async (t) => {
    await until('a picture more than half a second old', () => performance.now() - client.frames.at(-1).at > 700);
    const asked = Date.now(), page = JSON.parse((await get(plant.port, '/api/v1/tags')).body.toString()), time = page.time_us / 1000;
    assert.ok(time > asked - 500 && time < Date.now() + 500, `the page's time is ${time - asked} ms after the request`);
    client.say({ type: 'ping', t: 1 });
    const pong = await client.until('a pong', (c) => c.texts.find((text) => text.type === 'pong'));
    promise(t, 'the oldest reading', Math.max(pong.oldest_age_ms, ...page.tags.map((tag) => tag.age_ms)), 500);
});

test('a reading becomes stale when its time is over, though nothing is written', options, async () => {
    const told = client.texts.length, bad = (row) => row[2] === 'bad';
    await plant.tell('pause');
    await client.until('all readings bad', (c) => {
        const rows = c.texts.slice(told).filter((text) => text.type === 'tags').flatMap((text) => text.values);
        const last = new Map(rows.map((row) => [row[0], row]));
        return last.size === 3 && [...last.values()].every(bad);
    });
    await plant.tell('resume');
    await client.until('links', (c) => c.texts.filter((text) => text.type === 'status').at(-1)?.links.every((link) => link.up));
});
