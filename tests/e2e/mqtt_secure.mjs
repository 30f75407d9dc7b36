// SPDX-License-Identifier: GPL-3.0-or-later
// Tests MQTT brokers with access control: TLS with certificates on both sides, users with passwords, and topics that a user may
// not read. Also tests the last will, which the broker publishes if the daemon is killed.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, test } from 'node:test';
import { Broker, makeCertificates, missingBroker } from './support/broker.mjs';
import { PublishedPlant } from './support/published_plant.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram } from './support/tiny_plant.mjs';

const options = { skip: notBuilt() || (missingBroker() ?? false), timeout: 240000 };
const ROWS = ['TI-1,plant/ti1,,°C,temperature,E-101,0.5,0,0,30,,,,,', 'TI-2,secret/ti2,,°C,temperature,E-101,-0.5,0,0,30,,,,,'];
const good = { quality_name: 'Good' };
let folder, broker, plant, publisher;
const path = (name) => join(folder, name), pem = (name) => readFileSync(path(name));

setUp(options.skip, async () => {
    folder = mkdtempSync(join(tmpdir(), 'plantcast-secrets-'));
    makeCertificates(folder);
    makeCertificates(folder, 'other');
    writeFileSync(path('acl'), 'user reader\ntopic read plant/#\nuser boss\ntopic readwrite #\n');
    for (const [user, password] of [['reader', 'right'], ['boss', 'bossy']])
        assert.equal(spawnSync('mosquitto_passwd', [...(user === 'reader' ? ['-c'] : []), '-b', path('users'), user, password]).status, 0);
    plant = await PublishedPlant.create({ port: 0 });
});
afterEach(async () => {
    publisher?.end(true);
    publisher = null;
    await plant?.daemon?.stop();
    await broker?.destroy();
});
after(async () => {
    await plant?.destroy();
    if (folder)
        rmSync(folder, { recursive: true, force: true });
});

async function start(...more) {
    broker = plant.broker = await Broker.start(more);
}

// Starts a daemon with these keys of the source; asserts that it gets no readings and that its log gives the reason `why`.
async function refused(keys, why) {
    plant.write(keys, ROWS);
    assert.equal(plant.plant.prepare().code, 0);
    await plant.plant.startDaemon();
    await plant.daemon.line(why);
    await plant.until('TI-1', { quality_name: 'Bad_NoCommunication' });
    await plant.daemon.stop();
}

test('TLS: broker and daemon each verify the other\'s certificate', options, async () => {
    await start(`cafile ${path('ca.crt')}`, `certfile ${path('ca-server.crt')}`, `keyfile ${path('ca-server.key')}`,
        'require_certificate true');
    const own = `certificate: ${path('ca-client.crt')}, key: ${path('ca-client.key')}`;
    await plant.run(`tls: { ca: ${path('ca.crt')}, ${own} }`, ROWS);
    publisher = await broker.client({ ca: pem('ca.crt'), cert: pem('ca-client.crt'), key: pem('ca-client.key') });
    await publisher.tell('plant/ti1', 21.5);
    await plant.until('TI-1', { ...good, value: 21.5 });
    // a message of 3 MB, larger than one TLS record: it must arrive whole, as its value is no valid reading
    await publisher.tell('plant/ti1', '5'.repeat(3 << 20));
    await plant.until('TI-1', { quality_name: 'Bad_ConfigurationError' });
    await publisher.tell('plant/ti1', 22);
    await plant.until('TI-1', { ...good, value: 22 });
    await plant.daemon.stop();
    await refused(`tls: { ca: ${path('other.crt')}, ${own} }`, /no readings \(.*certificate verify failed/);
    await refused(`tls: { ca: system, ${own} }`, /no readings \(.*certificate verify failed/);
    await refused(`tls: { ca: ${path('ca.crt')} }`, /no readings \(/);
    await refused(`tls: { ca: ${path('ca.crt')}, certificate: ${path('other-client.crt')}, key: ${path('other-client.key')} }`,
        /no readings \(/);
    await refused('payload: number', /no readings \(/);
});

test('user name and password are read from a file, and a topic forbidden to this user is reported', options, async () => {
    await start(`password_file ${path('users')}`, `acl_file ${path('acl')}`, 'allow_anonymous false');
    for (const protocol of ['5', '3.1.1']) {
        writeFileSync(path('login'), 'reader\nwrong\n');
        plant.write(`login: ${path('login')}, protocol: ${protocol}`, ROWS);
        assert.equal(plant.plant.prepare().code, 0);
        await plant.plant.startDaemon();
        await plant.daemon.line(/no readings \(the broker refused the connection: .*(not|Not) auth/);
        writeFileSync(path('login'), 'reader\r\nright\r\n');
        await plant.daemon.line(/source broker: .*: reading/);
        publisher = await broker.client({ username: 'boss', password: 'bossy' });
        await publisher.tell('plant/ti1', 21.5);
        await publisher.tell('secret/ti2', 21.5);
        await plant.until('TI-1', { ...good, value: 21.5 });
        await plant.until('TI-2', { quality_name: 'Bad_NoCommunication' });
        await publisher.leave();
        await plant.daemon.stop();
    }
    writeFileSync(path('login'), '\n');
    await refused(`login: ${path('login')}`, /no readings \(.*login: expected the user name in line 1 and the password in line 2\)/);
    rmSync(path('login'));
    await refused(`login: ${path('login')}`, /no readings \(.*login: No such file or directory\)/);
});

test('the last will is published when the daemon is killed, and not when it exits cleanly', options, async () => {
    await start();
    const heard = [];
    publisher = await broker.client();
    publisher.on('message', (topic, payload) => heard.push(`${topic} ${payload}`));
    await new Promise((done) => publisher.subscribe('#', done));
    await plant.run('will: plantcast/two-boxes', ROWS);
    await plant.daemon.stop('SIGTERM');
    await plant.run('will: plantcast/two-boxes', ROWS);
    assert.deepEqual(heard, []);
    await plant.daemon.stop('SIGKILL');
    for (const end = performance.now() + 10000; heard.length === 0 && performance.now() < end;)
        await new Promise((done) => setTimeout(done, 50));
    assert.deepEqual(heard, ['plantcast/two-boxes offline'], 'nothing else was ever published');
    plant.write('will: plant/ti1', ROWS);
    assert.match(runProgram('plantcastd', ['--check', plant.file]).err, /will: expected a topic that begins with plantcast\//);
    plant.write('tls: { ca: system, key: x }', ROWS);
    assert.match(runProgram('plantcastd', ['--check', plant.file]).err, /tls: expected certificate and key, or neither/);
});
