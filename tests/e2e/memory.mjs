// SPDX-License-Identifier: GPL-3.0-or-later
// Memory: a random user tries everything, and the daemon stays under its limit; when all clients have left it releases the
// memory. By default the run covers one minute of a person's use, as fast as the machine answers; ten minutes in `make
// test-long`, an hour with USES=1440.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { Curious, dice } from './support/curious.mjs';
import { get } from './support/plain_client.mjs';
import { missing, startPlant } from './support/plant.mjs';
import { setUp } from './support/set_up.mjs';
import { sweep } from './support/sweep.mjs';

const USES = Number(process.env.USES ?? sweep(240, 24)), SEED = Number(process.env.PLANTCAST_SEED ?? 20), LEAVES = 0.02;
const BOUND_MB = Number(process.env.MEMORY_MB ?? 1280), GROWN = 1.2;
const why = missing();
const options = { skip: why ?? false, timeout: 100000 + 10000 * USES };
let plant, port, start, one;

const status = () => readFileSync(`/proc/${plant.pid}/status`, 'utf8');
const megabytes = (name) => Number(status().match(new RegExp(`${name}:\\s+(\\d+)`))[1]) / 1024;

// Returns the sizes in MB that the daemon reports under plantcast_memory_bytes, by label, and their limit as `bound`.
async function gauges() {
    const { body } = await get(port, '/metrics'), found = {};
    for (const [, name, of, value] of body.toString().matchAll(/^plantcast_memory(_bound)?_bytes(?:\{of="(.*)"\})? (\d+)$/gm))
        found[name ? 'bound' : of] = Number(value) / (1 << 20);
    return found;
}
const told = (all) => Object.entries(all).map(([name, value]) => `${name} ${value.toFixed(0)}`).join(', ');

setUp(why, async (own) => {
    plant = own(await startPlant('', () => {}, ['--memory', String(BOUND_MB)]));
    port = Number(new URL(plant.url).port);
    start = megabytes('VmRSS');
});

test('the daemon\'s memory stays under its limit, whatever a random user tries', options, async (t) => {
    const random = dice(SEED), began = performance.now(), done = {};
    let most = 0, mostOf = {};
    one = await Curious.come(port, random);
    for (let n = 0; n < USES; n++) {
        const name = await one.act(true), now = megabytes('RssAnon');
        done[name] = (done[name] ?? 0) + 1;
        if (now > most)
            [most, mostOf] = [now, await gauges()];
        assert.ok(now <= BOUND_MB, `after ${n} uses, the last of them ${name}: ${now} MB; ${told(mostOf)}`);
        const { bound, drawing, ...kept } = await gauges(), sum = Object.values(kept).reduce((a, b) => a + b);
        // sum of all memory kept between pictures; up to 10 % over the limit is allowed, because the current picture may need
        // it
        assert.ok(sum <= bound * 1.1,
            `${sum} MB of ${bound} are kept, beside ${drawing} to draw the next picture in: ${told(kept)}`);
        if (random() < LEAVES) {
            await one.leave();
            one = await Curious.come(port, random);
        }
    }
    assert.deepEqual([...new Set(one.refused)], []);
    await one.leave();
    t.diagnostic(`${USES} uses in ${((performance.now() - began) / 1000).toFixed(0)} s: ${start.toFixed(0)} MB at first, of its own ` +
        `${most.toFixed(0)} MB at most (${told(mostOf)})`);
    t.diagnostic(told(done));
});

test('when all clients have left, the daemon keeps no caches and is as small as at the start', options, async (t) => {
    await one?.leave(); // disconnects the first test's client, which is still connected if that test failed
    const isKept = ([name, value]) => !['light', 'models', 'bound'].includes(name) && value > 0;
    let all = await gauges();
    for (; Object.entries(all).some(isKept); all = await gauges())
        await sleep(250);
    const now = megabytes('VmRSS');
    t.diagnostic(`${now.toFixed(0)} MB; ${start.toFixed(0)} MB at first; ${told(all)}`);
    // compares the sizes only in long runs, on an idle machine: on a loaded one, threads may free memory after the daemon has
    // returned free memory to the system
    if (sweep(true, false))
        assert.ok(now <= GROWN * start, `${now} MB now, ${start} MB at the start: ${told(all)}`);
    one = await Curious.come(port, dice(SEED));
    await one.leave();
});
