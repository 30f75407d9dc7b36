// SPDX-License-Identifier: GPL-3.0-or-later
// OPC UA servers that lie about sizes, fall silent between rare messages, tell times of the future, or are at the second address of their
// name.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { distort, LIES, tellLies } from './support/lying_server.mjs';
import { opcuaOptions, shareOpcua } from './support/opcua.mjs';
import { freePort } from './support/ports.mjs';

const options = opcuaOptions(180000);
const ROWS = ['TI-1,nsu=urn:test:plant%3B1;s=TI-1,,°C,temperature,E-101,0.5,0,0,,,,,,'];
const canMount = process.getuid() === 0 && spawnSync('unshare', ['--mount', 'true']).status === 0;
const MOST_MB = 48; // that a liar may cost
const good = { quality_name: 'Good' };
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
let server, plant;

shareOpcua(options, (...made) => { [server, plant] = made; });
const peakMb = () => Number(/VmHWM:\s+(\d+)/.exec(readFileSync(`/proc/${plant.daemon.child.pid}/status`, 'utf8'))[1]) / 1024;

// Has the daemon meet something at the server's port; returns what that costs it, in MB, beyond `before`.
async function meet(before = 0) {
    await plant.start('security: none', ROWS);
    await plant.said(/no readings \(/, 25000);
    await sleep(500);
    return peakMb() - before;
}

test('what lies about sizes is left, named, and costs nothing', options, async () => {
    const before = await meet(); // nobody
    await plant.daemon.stop();
    for (const [name, lies] of Object.entries(LIES)) {
        const liar = await tellLies(server.port, lies);
        const moreMb = await meet(before);
        assert.ok(liar.seen() > 0 && moreMb < MOST_MB, `${name}: ${moreMb} MB`);
        await plant.daemon.stop();
        await liar.stop();
    }
});

test('a real server\'s messages with sizes in them that are none cost no more', options, async () => {
    await server.restart();
    const real = server.port;
    for (const spared of [0, 600, 3000]) {
        server.port = await freePort();
        const liar = await distort(server.port, real, spared);
        await plant.start('security: none', ROWS);
        for (const end = performance.now() + 20000; liar.seen() < 3; await sleep(50))
            assert.ok(performance.now() < end, `${spared}: ${liar.seen()} lies`);
        await sleep(500);
        assert.equal(plant.daemon.child.exitCode, null, plant.daemon.said);
        assert.ok(peakMb() < 400, `${peakMb()} MB`);
        await plant.daemon.stop();
        await liar.stop();
        server.port = real;
    }
});

test('a server that tells rarely says so, and is missed soon all the same', options, async () => {
    await server.restart({ publishing_ms: 60000 });
    await plant.run('security: none', ROWS, 30);
    await plant.said(/the server tells what has changed every 60000 ms, instead of every 100 ms/);
    server.freeze();
    const frozen = performance.now();
    await plant.said(/no readings \(the subscription has ended \(the server is silent\)\)/, 30000);
    assert.ok(performance.now() - frozen < 20000, `${performance.now() - frozen} ms`);
    server.thaw();
});

test('a reading whose source is an hour ahead is shown, and not as if it came from the future', options, async () => {
    await server.restart({});
    await plant.run('security: none', ROWS, 30);
    await server.set('TI-1', 33, { at: Date.now() + 3600000 });
    const ahead = await plant.until('TI-1', { ...good, value: 33 });
    assert.ok(ahead.age_ms >= 0 && ahead.age_ms < 5000, `${ahead.age_ms} ms`);
});

// The first of its two addresses takes no connection.
const named = { ...options, skip: options.skip || !canMount && 'no right to mount' };
test('of a name with several addresses, each is tried', named, async () => {
    const hosts = join(server.folder, 'hosts');
    writeFileSync(hosts, '127.0.0.1 localhost\n127.0.0.9 plc.test\n127.0.0.1 plc.test\n');
    plant.plant.before = ['unshare', '--mount', 'sh', '-c', `mount --bind ${hosts} /etc/hosts && exec "$@"`, 'sh'];
    await server.restart({});
    const real = server.port;
    server.port = await freePort();
    const link = await distort(server.port, real, Infinity); // at 127.0.0.1 alone
    server.host = 'plc.test';
    await plant.run('security: none', ROWS, 30);
    await plant.until('TI-1', good);
    await plant.daemon.stop();
    await link.stop();
    plant.plant.before = [];
});
