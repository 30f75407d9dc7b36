// SPDX-License-Identifier: GPL-3.0-or-later
// Tests how the daemon deals with OPC UA servers that send wrong sizes, fall silent between rare messages, send future
// timestamps, have a wrong clock, or listen at the second address of their name.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { shareOpcua } from './server.mjs';
import { missingClocks } from '../support/clocks.mjs';
import { distort, LIES, tellLies } from '../support/lying_server.mjs';
import { makeCertificate, opcuaOptions } from '../support/opcua.mjs';
import { freePort } from '../support/ports.mjs';
import { cpuMs } from '../support/processes.mjs';
import { promise } from '../support/promise.mjs';
import { sweep } from '../support/sweep.mjs';
import { until } from '../support/until.mjs';

const options = opcuaOptions(180000);
const ROWS = ['TI-1,nsu=urn:test:plant%3B1;s=TI-1,,°C,temperature,E-101,0.5,0,0,,,,,,'];
const canMount = process.getuid() === 0 && spawnSync('unshare', ['--mount', 'true']).status === 0;
const MOST_MB = 48; // largest growth of the daemon's memory, in MB, that a server announcing false sizes may cause
const good = { quality_name: 'Good' };
let server, plant;

shareOpcua(options, (...made) => { [server, plant] = made; });
const peakMb = () => Number(/VmHWM:\s+(\d+)/.exec(readFileSync(`/proc/${plant.daemon.child.pid}/status`, 'utf8'))[1]) / 1024;

// Waits until the daemon has nothing to do.
async function rest() {
    const taken = () => cpuMs(plant.daemon.child.pid);
    for (let before = -Infinity, end = performance.now() + 20000; taken() - before > 20 && performance.now() < end; await sleep(500))
        before = taken();
}

test('a server that announces false sizes is disconnected, named, and costs no memory', options, async () => {
    const real = server.port;
    server.port = await freePort();
    // By default a daemon meets half of the liars, because its peak memory only grows, and its pauses between connections become longer.
    // In a long run each liar meets a new daemon.
    const all = Object.entries(LIES), half = all.length / 2;
    for (const some of sweep(all.map((one) => [one]), [all.slice(0, half), all.slice(half)])) {
        // the daemon logs only the first failure to connect as a warning, and the next ones at level debug
        await plant.start('security: none', ROWS, '--log-level', 'debug');
        await plant.said(/no readings \(/);
        await rest();
        const before = peakMb();
        for (const [name, lies] of some) {
            const liar = await tellLies(server.port, lies), from = plant.daemon.said.length;
            const isNamed = () => /source plc: .*no readings \(/.test(plant.daemon.said.slice(from));
            try {
                await until(`${name}: the end of the connection`, () => liar.left() > 0, 60);
                await until(`${name}: a report`, isNamed);
                await rest();
            } finally {
                await liar.stop();
            }
            assert.equal(plant.daemon.child.exitCode, null, plant.daemon.said);
            assert.ok(peakMb() - before < MOST_MB, `${name}: memory grew by ${peakMb() - before} MB`);
        }
        await plant.daemon.stop();
    }
    server.port = real;
});

test('a real server\'s messages with invalid sizes cost no extra memory', options, async () => {
    await server.reset();
    const real = server.port;
    for (const spared of [0, 600, 3000]) {
        server.port = await freePort();
        const liar = await distort(server.port, real, spared);
        await plant.start('security: none', ROWS);
        for (const end = performance.now() + 20000; liar.seen() < 3; await sleep(50))
            assert.ok(performance.now() < end, `${spared}: only ${liar.seen()} false sizes were sent`);
        await sleep(500);
        assert.equal(plant.daemon.child.exitCode, null, plant.daemon.said);
        assert.ok(peakMb() < 400, `peak memory is ${peakMb()} MB`);
        await plant.daemon.stop();
        await liar.stop();
        server.port = real;
    }
});

test('a reading timestamped an hour ahead is shown, but not with that future time', options, async () => {
    await server.reset({});
    await plant.run('security: none', ROWS);
    await server.set('TI-1', 33, { at: Date.now() + 3600000 });
    const ahead = await plant.until('TI-1', { ...good, value: 33 });
    assert.ok(ahead.age_ms >= 0 && ahead.age_ms < 5000, `the reading is ${ahead.age_ms} ms old`);
});

// plc.test has two addresses: 127.0.0.9, where connections are refused, and 127.0.0.1. Needs the right to mount, to replace
// /etc/hosts.
const named = { ...options, skip: options.skip || !canMount && 'no right to mount' };
test('each address of a server\'s host name is tried', named, async () => {
    const hosts = join(server.folder, 'hosts');
    writeFileSync(hosts, '127.0.0.1 localhost\n127.0.0.9 plc.test\n127.0.0.1 plc.test\n');
    plant.plant.before = ['unshare', '--mount', 'sh', '-c', `mount --bind ${hosts} /etc/hosts && exec "$@"`, 'sh'];
    await server.reset({});
    const real = server.port;
    server.port = await freePort();
    const link = await distort(server.port, real, Infinity); // listens on 127.0.0.1 only, so that the first address refuses connections
    server.host = 'plc.test';
    await plant.run('security: none', ROWS);
    await plant.until('TI-1', good);
    await plant.daemon.stop();
    await link.stop();
    plant.plant.before = [];
    server.host = undefined;
});

test('a server with a long publishing interval is reported, and its loss is noticed soon all the same', options, async (t) => {
    await server.restart({ publishing_ms: 60000 });
    await plant.run('security: none', ROWS);
    await plant.said(/the server publishes changes every 60000 ms instead of every 100 ms/);
    server.freeze();
    const frozen = performance.now();
    await plant.said(/no readings \(the OPC UA server ended the subscription \(nothing received from the OPC UA server\)\)/);
    promise(t, 'until the frozen server is missed', performance.now() - frozen, 20000);
    server.thaw();
});

const inDays = (days) => `${new Date(Date.now() + days * 86400e3).toISOString().replace(/[-:T]/g, '').slice(0, 14)}Z`;
const clocks = { ...options, skip: options.skip || (missingClocks() ?? false) };
// The certificates are valid from that many days ago. The clock that is an hour behind is before their beginning: the daemon must connect
// all the same.
for (const [off_s, word, days] of [[3600, 'ahead of', 1], [-3600, 'behind', 1 / 48]])
    test(`readings from a server whose clock is an hour ${word} ours are used, its clock is not`, clocks, async () => {
        for (const name of ['recent', 'client2'])
            makeCertificate(server.folder, name, { dates: [inDays(-days), inDays(1)] });
        server.trust('recent');
        await server.restart({ ahead_s: off_s, certificate: 'recent' });
        const stale = ROWS[0].replace('TI-1', 'OLD').replace('s=TI-1', 's=TI-2').replace(/0\.5,0,0,,/, '0.5,0,0,60,');
        await plant.run(server.security('', 'client2'), [...ROWS, stale]);
        await server.set('TI-1', 34);
        const { age_ms } = await plant.until('TI-1', { ...good, value: 34 });
        const past_s = off_s < 0 ? -off_s : 0;
        assert.ok(age_ms >= past_s * 1000 && age_ms < (past_s + 9) * 1000, `the reading is ${age_ms} ms old`);
        await plant.until('OLD', off_s < 0 ? { quality_name: 'Bad_CommunicationError', value: null } : good, 20);
        await plant.said(new RegExp(`source plc: the server's timestamps are 3[56]\\d\\d\\.\\d s ${word} this machine's clock`));
        assert.equal(plant.daemon.said.match(/timestamps are/g).length, 1, 'the clock difference is logged once');
    });

test('a server certificate that is not yet valid is refused by name', clocks, async () => {
    for (const [name, from, to] of [['tomorrow', 1, 2], ['us', -1 / 48, 1]])
        makeCertificate(server.folder, name, { dates: [inDays(from), inDays(to)] });
    server.trust('tomorrow');
    // the server's clock is 25 hours ahead: its certificate is valid for itself, but not yet for the daemon
    await server.restart({ ahead_s: 90000, certificate: 'tomorrow' });
    await plant.start(server.security('', 'us'), ROWS);
    await plant.said(/BadCertificateTimeInvalid: the server's certificate: certificate is not yet valid/);
    assert.equal((await server.tell({})).sessions, 0);
});
