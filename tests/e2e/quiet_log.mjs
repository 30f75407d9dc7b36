// SPDX-License-Identifier: GPL-3.0-or-later
// Growth of the log: bytes written per normal event, in the longest log format, and the total of a busy day. While nothing
// happens, nothing is written.
import assert from 'node:assert/strict';
import { chmodSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { PlainClient } from './support/plain_client.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, Program, runProgram, sleep, TinyPlant } from './support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 280000 };
const DAY_BYTES = 10e6, DAY_S = 24 * 3600;
let plant, token;
const costs = {}; // bytes and lines of the log for each kind of event

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    plant.addAlarms();
    const file = join(plant.folder, 'tokens');
    token = runProgram('plantcast', ['token', 'add', file, '--role', 'operator', '--name', 'desk-of-shift-3']).out.trim();
    chmodSync(file, 0o600);
    assert.equal(plant.prepare().code, 0);
    await plant.startSim();
    plant.daemon = new Program('plantcastd', [plant.file, '--port', '0', '--log-format', 'json', '--tokens', file, '--history',
        join(plant.folder, 'history'), '--audit', join(plant.folder, 'audit')]);
    plant.port = Number((await plant.daemon.line(/"ready https?:\/\/[\d.]+:(\d+)\//m))[1]);
    await plant.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
    await sleep(3000);
});

const said = () => plant.daemon.said;
// Causes an event `times` times, waits, and records in costs[what] how many bytes and lines the log grew per event. Returns the
// new text.
async function measure(what, times, happen, settleMs = 3000) {
    await sleep(1500); // waits 1.5 s before it begins: the log counts repeated lines for a second and then prints their number
    const from = said().length;
    for (let i = 0; i < times; i++)
        await happen(i);
    await sleep(settleMs);
    const text = said().slice(from);
    costs[what] = { bytes: text.length / times, lines: (text.match(/\n/g) ?? []).length / times };
    return text;
}
const ask = (path) => fetch(`http://127.0.0.1:${plant.port}${path}`, { headers: { Authorization: `Bearer ${token}` } });
const look = async () => {
    const client = await PlainClient.open(plant.port, { headers: [`Authorization: Bearer ${token}`] });
    await client.hello();
    await client.frameWhere('a picture', () => true);
    client.close();
};

test('each normal event writes few bytes to the log', options, async () => {
    assert.equal(await measure('10 s of changing readings', 10, async (i) => {
        await plant.tell(`set TI-2 ${20 + i}`);
        await sleep(1000);
    }, 0), '');
    assert.ok((await measure('session', 20, look)).includes('desk-of-shift-3'));
    await measure('picture or question', 30, async (i) => {
        const answer = await ask(['/snapshot.png?width=320&height=200', '/api/v1/tags', '/metrics', '/api/v1/alarms'][i % 4]);
        assert.equal(answer.status, 200);
        await answer.arrayBuffer();
    });
    await measure('alarm that comes and goes', 10, async () => {
        await plant.tell('set TI-1 95');
        await sleep(500);
        await plant.tell('set TI-1 80');
        await sleep(500);
    });
    await measure('wrong token', 5, async () => {
        await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/tags`, { headers: { Authorization: 'Bearer nobody' } })).arrayBuffer();
        await sleep(1100);
    });
    await measure('reload', 5, async (i) => {
        writeFileSync(join(plant.folder, 'note'), String(i));
        plant.daemon.child.kill('SIGHUP');
        await sleep(1500);
    });
    assert.match(await measure('device that is lost and comes back', 3, async () => {
        await plant.sim.stop();
        await sleep(6000);
        await plant.startSim();
        await sleep(6000);
    }), /source|link/i);
});

test('a device that stays lost is not logged again and again', options, async () => {
    await plant.sim.stop();
    await sleep(6000);
    assert.equal(await measure('second of a lost device', 20, () => sleep(1000), 0), '');
    await plant.startSim();
});

test('the log of a busy day stays under 10 MB, also with a device that flaps all day', options, () => {
    for (const [what, { bytes, lines }] of Object.entries(costs))
        console.log(`# ${what}: ${bytes.toFixed(0)} bytes, ${lines.toFixed(1)} lines`);
    // How often each kind of event happens on a busy day: 40 people and walls that reconnect 50 times each, a scraper and
    // programs that poll every 5 s, a permanent alarm flood by ISA-18.2 (10 alarms in 10 minutes), a wrong token per minute, a
    // reload per hour, a cable unplugged 100 times.
    const day = { session: 2000, 'picture or question': DAY_S / 5, 'alarm that comes and goes': DAY_S / 60, 'wrong token': DAY_S / 60,
        reload: 24, 'device that is lost and comes back': 100, 'second of a lost device': DAY_S, '10 s of changing readings': DAY_S / 10 };
    assert.deepEqual(Object.keys(day).sort(), Object.keys(costs).sort());
    const bytes = Object.entries(day).reduce((sum, [what, times]) => sum + times * costs[what].bytes, 0);
    const flaps = (DAY_S / 12) * costs['device that is lost and comes back'].bytes;
    const [usual, more] = [bytes, flaps].map((count) => (count / 1e6).toFixed(2));
    console.log(`# a busy day: ${usual} MB; a device that flaps every 12 s for all of it: ${more} MB more`);
    assert.ok(bytes > 0 && flaps > 0);
    assert.ok(bytes + flaps < DAY_BYTES, `${bytes} bytes of a busy day and ${flaps} bytes of a flapping device`);
});
