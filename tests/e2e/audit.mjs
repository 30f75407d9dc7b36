// SPDX-License-Identifier: GPL-3.0-or-later
// The audit trail: user actions are recorded with name, place and result; tampering is detected; a syslog server gets the
// entries over TLS; a full disk is reported, and no entry is lost.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:tls';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { makeCertificate } from './support/certificate.mjs';
import { http, PlainClient } from './support/plain_client.mjs';
import { freePort } from './support/ports.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { sweep } from './support/sweep.mjs';
import { notBuilt, runProgram, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
let plant, trail, tokens, syslog;

const path = (name) => join(plant.folder, name);
// Returns the parsed complete lines of the audit trail. The text after the last line break is ignored, because the daemon may
// be writing a line at this moment.
const lines = () => readFileSync(trail, 'utf8').split('\n').slice(0, -1).map((line) => JSON.parse(line));
const verify = (...args) => runProgram('plantcast', ['audit', 'verify', trail, ...args]);
const bearer = (token) => `Authorization: Bearer ${token}\r\n`;
const ask = (url, token, { method = 'GET', origin, localAddress } = {}) =>
    http(plant.port, `${method} ${url} HTTP/1.1\r\nHost: localhost\r\n${token ? bearer(token) : ''}${
        origin ? `Origin: ${origin}\r\n` : ''}\r\n`, { localAddress });
async function found(what, where) {
    return await until(`${what} in the trail`, () => lines().find(where), 90, () => readFileSync(trail, 'utf8'));
}

// A syslog server that parses RFC 5425, in which each message is preceded by its length. requestCert true: it requires a client
// certificate. closes true: it closes each connection after the handshake, like a server that rejects the name in the client's
// certificate.
class SyslogServer {
    constructor(key, cert, { requestCert = true, closes = false } = {}) {
        this.messages = [];
        this.sockets = new Set();
        this.server = createServer({ key, cert, ca: cert, requestCert }, (socket) => {
            if (closes)
                return void socket.destroy();
            let bytes = Buffer.alloc(0);
            this.sockets.add(socket);
            socket.on('error', () => {});
            socket.on('data', (chunk) => {
                bytes = Buffer.concat([bytes, chunk]);
                for (let head; (head = /^(\d+) /.exec(bytes.subarray(0, 12).toString())) &&
                    bytes.length >= head[0].length + Number(head[1]);) {
                    this.messages.push(bytes.subarray(head[0].length, head[0].length + Number(head[1])).toString());
                    bytes = bytes.subarray(head[0].length + Number(head[1]));
                }
            });
        });
        this.server.on('tlsClientError', () => {});
    }

    listen(port) {
        return new Promise((done) => this.server.listen(port, '127.0.0.1', done));
    }

    close() {
        for (const socket of this.sockets)
            socket.destroy();
        return new Promise((done) => this.server.close(done));
    }

    async until(what, where) {
        return await until(what, () => this.messages.find(where), 90, () => this.messages.join('\n'));
    }
}

// Returns the number of daemon starts in the trail. The file is missing before the first start, and for a moment while a full
// one is renamed.
function starts() {
    try {
        return readFileSync(trail, 'utf8').split('"event":"start"').length - 1;
    } catch {
        return 0;
    }
}
// Restarts the daemon and waits until its start is recorded in the audit trail, which can happen after the daemon reports that
// it is ready.
async function start(...args) {
    await plant.daemon?.stop();
    const count = starts();
    await plant.startDaemon('--tokens', path('tokens'), '--audit', trail, ...args);
    await until('the start in the trail', () => starts() > count);
}

// Waits until `plantcast audit verify` accepts the trail. It may fail for a moment, while the daemon writes a line or removes a
// line that did not fit on the disk.
const whole = () => until('a good trail', () => verify().code === 0, 90, () => verify().err);
// Waits until the metric plantcast_audit_good has this value; the daemon sets it after it has logged the failure or recovery.
const isGood = (value) => until(`plantcast_audit_good ${value}`, async () =>
    new RegExp(`^plantcast_audit_good ${value}$`, 'm').test((await ask('/metrics', tokens.viewer)).body.toString()));

setUp(skip, async () => {
    plant = await TinyPlant.create();
    plant.addAlarms();
    assert.equal(plant.prepare().code, 0);
    trail = path('audit.log');
    tokens = {};
    for (const role of ['viewer', 'operator', 'engineer'])
        tokens[role] = runProgram('plantcast', ['token', 'add', path('tokens'), '--role', role, '--name', `${role}-1`]).out.trim();
    makeCertificate(plant.folder, 'log', ['localhost']);
});
after(async () => {
    await syslog?.close();
    await plant?.destroy();
});

test('the audit trail records each action with user, address, object and result', { skip }, async () => {
    await start('--log-level', 'debug');
    await found('the start', (line) => line.event === 'start');
    const engineer = await PlainClient.open(plant.port, { localAddress: '127.0.0.5' });
    await engineer.hello({ token: tokens.engineer });
    await plant.daemon.line(/ debug session \d+: opened/);
    const login = await found('the log-in', (line) => line.event === 'login' && line.who === 'engineer-1');
    assert.deepEqual([login.result, login.role, login.from, login.how], ['done', 'engineer', '127.0.0.5', 'stream']);
    engineer.say({ type: 'alarm', seq: 1, action: 'shelve', alarms: [['TI-1', 'H']], for_s: 60, reason: 'works on it' });
    await engineer.text('alarmed');
    const shelf = await found('the shelf', (line) => line.event === 'alarm');
    assert.deepEqual([shelf.who, shelf.what], ['engineer-1', 'shelve TI-1 H for 60 s: works on it']);
    engineer.say({ type: 'params', seq: 2, baseline: { set: 'then' } });
    await engineer.text('params');
    assert.equal((await found('the baseline', (line) => line.event === 'baseline')).what, 'keep then');
    engineer.say({ type: 'prove', seq: 3, tag: 'TI-1', expected: 5, tolerance: 1 });
    assert.equal((await found('the proof', (line) => line.event === 'proof')).what, 'TI-1: not passed');
    engineer.say({ type: 'save_view', seq: 4, id: 'boiler', title: 'Boiler', view: 'group=t' });
    assert.equal((await found('the view', (line) => line.event === 'view')).what, 'save boiler');
    engineer.close();
    await found('the end', (line) => line.event === 'leave' && line.who === 'engineer-1');
    const viewer = await PlainClient.open(plant.port);
    await viewer.hello({ token: tokens.viewer });
    viewer.say({ type: 'params', seq: 1, power: 3 });
    await viewer.text('error');
    const refused = await found('the refusal', (line) => line.event === 'access' && line.how === 'stream');
    assert.deepEqual([refused.result, refused.who, /role engineer/.test(refused.why)], ['refused', 'viewer-1', true]);
    viewer.close();
    assert.equal((await ask('/api/v1/reload', tokens.operator, { method: 'POST' })).status, 403);
    await found('the refused reload', (line) => line.event === 'access' && line.who === 'operator-1' && line.what === '/api/v1/reload');
    assert.equal((await ask('/api/v1/pick?x=1&y=1&strength=2', tokens.viewer)).status, 403);
    await found('the refused pick', (line) => line.event === 'access' && line.who === 'viewer-1' && line.what === '/api/v1/pick');
    assert.equal((await ask('/api/v1/reload', tokens.engineer, { method: 'POST', origin: 'https://elsewhere.example' })).status, 403);
    await found('the page of another site', (line) => line.what === '/api/v1/reload' && /another site/.test(line.why));
    const stranger = { origin: 'https://elsewhere.example', headers: [`Authorization: Bearer ${tokens.viewer}`] };
    await assert.rejects(PlainClient.open(plant.port, stranger), /403/);
    await found('the stream of another site', (line) => line.what === '/stream' && line.event === 'access' &&
        line.who === 'viewer-1' && /another site/.test(line.why));
    const reload = await ask('/api/v1/reload', tokens.engineer, { method: 'POST' });
    assert.equal(JSON.parse(reload.body).by, 'engineer-1');
    await found('the reload', (line) => line.event === 'reload' && line.result === 'done' && line.who === 'engineer-1');
    assert.equal(verify().code, 0, verify().err);
    assert.ok(!Object.values(tokens).some((token) => readFileSync(trail, 'utf8').includes(token)));
});

test('a note can be changed by its author, and ended by the author or an engineer; the trail names both', { skip }, async () => {
    const [kim, lee] = ['kim', 'lee'].map((name) =>
        runProgram('plantcast', ['token', 'add', path('tokens'), '--role', 'operator', '--name', name]).out.trim());
    await start();
    const people = {};
    for (const [name, token] of Object.entries({ kim, lee, engineer: tokens.engineer })) {
        people[name] = await PlainClient.open(plant.port);
        await people[name].hello({ token });
    }
    const does = async (who, message) => {
        people[who].say({ seq: 1, ...message });
        return await people[who].text('noted');
    };
    const why = ({ kept, refusal, why: words }) => [kept, refusal?.code, refusal?.args.author, /kim/.test(words)];
    const { id } = await does('kim', { type: 'note', text: 'drips', tag: 'TI-1' });
    assert.deepEqual(why(await does('lee', { type: 'note', text: 'dry', replaces: id })), [false, 'note_others', 'kim', true]);
    assert.deepEqual(why(await does('engineer', { type: 'note', text: 'dry', replaces: id })), [false, 'note_others', 'kim', true]);
    assert.deepEqual(why(await does('lee', { type: 'remove_note', id })), [false, 'note_not_own', 'kim', true]);
    const failed = await found('the refused end', (line) => line.event === 'note' && line.what.startsWith('remove'));
    assert.deepEqual([failed.result, failed.who, failed.what, /kim/.test(failed.why)],
        ['failed', 'lee', `remove ${id}, written by kim`, true]);
    assert.deepEqual(why(await does('engineer', { type: 'remove_note', id })), [true, undefined, undefined, false]);
    const ended = await found('the end', (line) => line.event === 'note' && line.who === 'engineer-1' && line.result === 'done');
    assert.equal(ended.what, `remove ${id}, written by kim`);
    const own = await does('kim', { type: 'note', text: 'drips again', tag: 'TI-1' });
    const changed = await does('kim', { type: 'note', text: 'drips more', replaces: own.id });
    assert.deepEqual(why(await does('kim', { type: 'remove_note', id: changed.id })), [true, undefined, undefined, false]);
    for (const client of Object.values(people))
        client.close();
});

test('each file and each command of an import is recorded, with its user and its outcome', { skip, timeout: 120000 }, async () => {
    await start('--import');
    // Opens a new connection for each request. The server may close a connection whose upload it refused, which would break the
    // next request on the same connection.
    const post = (what, token, body, headers = {}) => fetch(`http://127.0.0.1:${plant.port}/api/v1/import${what}`,
        { method: 'POST', body, headers: { Authorization: `Bearer ${token}`, Connection: 'close', ...headers } });
    const since = lines().at(-1).seq, { engineer, operator } = tokens;
    const told = () => lines().filter((line) => line.seq > since && line.event !== 'login')
        .map(({ event, result, who, what, why }) => `${event} ${result} ${who} ${what}${why ? `: ${why}` : ''}`);
    const idle = async () => {
        for (;; await sleep(50)) {
            const answer = await fetch(`http://127.0.0.1:${plant.port}/api/v1/import`,
                { headers: { Authorization: `Bearer ${engineer}`, Connection: 'close' } });
            if ((await answer.json()).phase === 'idle')
                return;
        }
    };
    const box = readFileSync(path('box.gltf'));
    const list = 'Tag Name,Address,Eng Units\nTI-1,400001,°C\n';
    for (const [token, what, body] of [[operator, '/run'], [engineer, '/upload?name=..%2Fx.glb', 'x'],
        [engineer, '/upload?name=x.glb', 'x'], [engineer, '/run'], [engineer, '/remove?name=x.glb'],
        [engineer, '/upload?name=box.gltf', box], [engineer, '/upload?name=tags.csv', list], [engineer, '/run'],
        [engineer, '/run?what=tags'], [engineer, '/decide', 'Tag,Status,Asset\nTI-1,none,\n'],
        [engineer, '/source?host=127.0.0.1&port=1'], [engineer, '/run?what=anew'], [engineer, '/run?units=km'], [engineer, '/cancel']]) {
        await post(what, token, body);
        await idle();
    }
    await post('/run', engineer, undefined, { Origin: 'http://elsewhere.example' });
    const foreign = 'the request comes from a page of another site';
    await found('the last', (line) => line.event === 'import' && line.result === 'refused' && line.why === foreign);
    const want = ['access refused operator-1 /api/v1/import/run: the request needs the role engineer',
        'import failed engineer-1 /api/v1/import/upload: this file name is not allowed.*',
        'import done engineer-1 /api/v1/import/upload x.glb',
        'import failed engineer-1 models were read and tags matched: plantcast import: .*/x.glb: ' +
            'the JSON part of the glTF model is invalid: .*',
        'import done engineer-1 /api/v1/import/remove x.glb', 'import done engineer-1 /api/v1/import/upload box.gltf',
        'import done engineer-1 /api/v1/import/upload tags.csv', 'reload done engineer-1 configuration .* is active',
        'import done engineer-1 models were read and tags matched', 'reload done engineer-1 configuration .* is active',
        'import done engineer-1 tags were matched', 'reload done engineer-1 configuration .* is active',
        'import done engineer-1 decisions about tags were applied',
        'import failed engineer-1 a source was set: plantcast match: .*: --modbus cannot change a source that was edited by hand.*',
        'reload done engineer-1 configuration .* is active', 'import done engineer-1 the plant was created again from its exports',
        'import failed engineer-1 /api/v1/import/run: units and mesh_units are .*', 'import done engineer-1 /api/v1/import/cancel',
        'import refused engineer-1 /api/v1/import/run: the request comes from a page of another site'];
    const is = told();
    is.forEach((line, i) => assert.match(line, new RegExp(`^${want[i] ?? 'nothing more'}$`)));
    assert.equal(is.length, want.length);
    assert.equal(verify().code, 0, verify().err);
});

const EACH_TRIES = sweep(500, 100), TRYING = 20;
test('thousands of wrong tokens make few lines in the trail, and other clients get in meanwhile', { skip }, async (t) => {
    const before_ = lines().length, since = performance.now();
    let slowest = 0, refused = 0;
    const wrong = async () => {
        for (let i = 0; i < EACH_TRIES; i++) {
            const { status } = await ask('/api/v1/tags', 'pc_wrong', { localAddress: '127.0.0.9' });
            refused += status === 429 || status === 401;
        }
    };
    const right = async () => {
        for (let i = 0; i < 20; i++, await sleep(50)) {
            const began = performance.now();
            assert.equal((await ask('/api/v1/tags', tokens.viewer, { localAddress: '127.0.0.6' })).status, 200);
            slowest = Math.max(slowest, performance.now() - began);
        }
    };
    const began = performance.now();
    await Promise.all([...Array.from({ length: TRYING }, wrong), right()]);
    const took = (performance.now() - began) / 1000;
    t.diagnostic(`${refused} refused in ${took.toFixed(1)} s; the slowest answer to another took ${slowest.toFixed(0)} ms`);
    assert.equal(refused, TRYING * EACH_TRIES);
    promise(t, 'the slowest answer to another client', slowest, 5000);
    await found('the slowing', (line) => /delayed/.test(line.why ?? ''));
    const held = await found('unchecked ones', (line) => /tokens from rate-limited addresses were refused unchecked/.test(line.what ?? ''));
    assert.equal(held.result, 'refused');
    // Expected lines: ten failed logins of the attacking address and one login of the other client. Then the daemon checks one
    // token every 5 s and writes one summary per minute.
    const { length: count } = lines().slice(before_).filter(({ event }) => event === 'login');
    const seconds = (performance.now() - since) / 1000, most = 12 + seconds / 5 + seconds / 60;
    assert.ok(count <= most, `${count} lines in the trail in ${seconds} s`);
});

test('a changed byte and removed lines of the trail are detected, also at the next start', { skip }, async () => {
    await plant.daemon.stop();
    const good = readFileSync(trail);
    assert.match(verify().out, /: unaltered: lines 1 to \d+ in 1 file/);
    const text = good.toString().replace('engineer-1', 'engineer-2');
    writeFileSync(trail, text);
    assert.match(verify().err, /audit\.log:2: the line was changed/);
    const end = good.toString().trimEnd().split('\n');
    writeFileSync(trail, `${end.slice(0, -3).join('\n')}\n`);
    assert.match(verify().err, /the last 3 lines were removed/);
    const { seq, hash } = JSON.parse(end.at(-1));
    writeFileSync(trail, good);
    assert.equal(verify('--known', `${seq}:${hash}`).code, 0);
    assert.equal(verify('--known', `${seq + 1}:${hash}`).code, 1);
    writeFileSync(trail, `${end.slice(0, -1).join('\n')}\n`);
    await start();
    await plant.daemon.line(/lines were removed/);
    await found('the finding', (line) => line.event === 'audit' && /lines were removed/.test(line.what));
    await plant.daemon.stop();
    assert.equal(verify().code, 1, 'the removed line is still reported');
    writeFileSync(trail, '');
    writeFileSync(`${trail}.head`, '');
    const emptied = verify();
    assert.equal(emptied.code, 1, emptied.out);
    assert.match(emptied.err, /audit\S*: the file has no lines, .* emptied/);
    assert.equal(runProgram('plantcast', ['audit', 'verify']).code, 2);
});

test('a full disk is reported in the log and the metrics, and no audit entry is lost', { skip }, async (t) => {
    if (!existsSync('/usr/bin/prlimit'))
        return t.skip('no prlimit');
    await start();
    const limit = (bytes) => spawnSync('prlimit', ['--pid', String(plant.daemon.child.pid), `--fsize=${bytes}`]);
    limit(`${statSync(trail).size + 20}:unlimited`);
    const count = lines().length;
    await ask('/api/v1/tags', 'pc_wrong', { localAddress: '127.0.0.20' });
    await plant.daemon.line(/audit: .*audit\.log cannot be written \(File too large\)/);
    await plant.daemon.line(/audit, not written: login refused: \(nobody\) from 127\.0\.0\.20/);
    await isGood(0);
    assert.equal(lines().length, count);
    await whole();
    limit('unlimited:unlimited');
    await plant.daemon.line(/audit: writing to .*audit\.log works again/);
    await found('what waited', (line) => line.from === '127.0.0.20');
    await isGood(1);
    await whole();
});

test('a small full disk raises an alarm, no line on it is torn, and a read-only disk is refused', { skip, timeout: 2e5 }, async (t) => {
    const small = path('small'), full = join(small, 'full'), usual = trail;
    mkdirSync(small);
    if (spawnSync('mount', ['-t', 'tmpfs', '-o', 'size=64k', 'tmpfs', small]).status !== 0)
        return t.skip('this user may not mount a file system');
    t.after(async () => {
        await plant.daemon.stop();
        trail = usual;
        spawnSync('umount', [small]);
    });
    const good = async () => /^plantcast_audit_good (\d)$/m.exec((await ask('/metrics', tokens.viewer)).body.toString())[1];
    trail = join(small, 'audit.log');
    await start();
    assert.notEqual(spawnSync('dd', ['if=/dev/zero', `of=${full}`]).status, 0);
    // Sends wrong tokens, each of which adds a line to the trail, until writing fails. The first lines may still fit into the
    // last disk block of the file, although the disk is full.
    for (let i = 0; i < 60 && await good() === '1'; i++, await sleep(20))
        await ask('/api/v1/tags', 'pc_wrong', { localAddress: `127.0.2.${i + 1}` });
    await plant.daemon.line(/audit: .*audit\.log cannot be written \(No space left on device/);
    await isGood(0);
    await ask('/api/v1/tags', 'pc_wrong', { localAddress: '127.0.3.1' });
    await plant.daemon.line(/audit, not written: login refused: \(nobody\) from 127\.0\.3\.1/);
    assert.equal((await ask('/api/v1/tags', tokens.viewer)).status, 200, 'the daemon still serves the plant');
    await whole();
    rmSync(full);
    await plant.daemon.line(/audit: writing to .*audit\.log works again/);
    await found('what waited', (line) => line.from === '127.0.3.1');
    await whole();
    await plant.daemon.stop();
    assert.equal(spawnSync('mount', ['-o', 'remount,ro', small]).status, 0);
    const refused = runProgram('plantcastd', [plant.file, '--port', '0', '--audit', trail]);
    assert.equal(refused.code, 1);
    assert.match(refused.err, /audit: .*audit\.log: Read-only file system/);
});

test('a full trail file is renamed, and a new one begins', { skip }, async () => {
    const usual = trail;
    trail = path('full.log');
    writeFileSync(trail, `${'x'.repeat(1 << 20)}\n`);
    await start('--audit-size', '1');
    await until('the new file', () => readdirSync(plant.folder).some((name) => /^full\.log\.\d{12}$/.test(name)));
    await plant.daemon.stop();
    // the first line of the new file reports that the last line of the full file was not a line of an audit trail
    assert.equal(lines()[0].event, 'audit');
    trail = usual;
});

test('syslog over TLS: each line is valid RFC 5424, lines survive an outage, and an untrusted server gets none', { skip }, async () => {
    const key = readFileSync(path('log.key')), cert = readFileSync(path('log.pem'));
    const port = await freePort(); // port that no other program takes while the syslog server is stopped during this test
    syslog = new SyslogServer(key, cert);
    await syslog.listen(port);
    await start('--audit-syslog', `localhost:${port}`, '--audit-ca', path('log.pem'), '--audit-cert', path('log.pem'),
        '--audit-key', path('log.key'));
    const first = await syslog.until('the start', (text) => / start - /.test(text));
    const [, head, json] = /^(.*?) - (\{.*)$/.exec(first);
    assert.match(head, /^<109>1 \d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d+Z \S+ plantcastd \d+ start$/);
    assert.deepEqual(JSON.parse(json), lines().find(({ seq }) => seq === JSON.parse(json).seq));
    await syslog.close();
    await ask('/api/v1/tags', 'pc_wrong', { localAddress: '127.0.0.21' });
    await ask('/api/v1/tags', 'pc_wrong', { localAddress: '127.0.0.22' });
    await plant.daemon.line(/audit: syslog server localhost:\d+ cannot be reached/);
    syslog = new SyslogServer(key, cert);
    await syslog.listen(port);
    for (const address of ['127.0.0.21', '127.0.0.22'])
        assert.match(await syslog.until(address, (text) => text.includes(`"from":"${address}"`)), /^<108>1 /);
    await start('--audit-syslog', `localhost:${port}`);
    await plant.daemon.line(/audit: syslog server localhost:\d+ cannot be reached: SSL/);
    const wrong = runProgram('plantcastd', [plant.file, '--audit-syslog', 'localhost']);
    assert.equal(wrong.code, 1);
    assert.match(wrong.err, /needs --audit/);
});

// A server that rejects the daemon's certificate. With TLS 1.3, the daemon's handshake succeeds before the server has checked
// that certificate, so the daemon learns of the rejection later: by an alert, or because the connection is closed.
for (const [how, options, reason] of [['by an alert', {}, 'alert certificate required'],
    ['by closing', { requestCert: false, closes: true }, '(closed|reset)']])
    test(`a syslog server that refuses our certificate after the handshake, ${how}, loses no line`, { skip }, async () => {
        const key = readFileSync(path('log.key')), cert = readFileSync(path('log.pem')), port = await freePort();
        const metric = (value) => until(`plantcast_audit_syslog_good ${value}`, async () =>
            new RegExp(`^plantcast_audit_syslog_good ${value}$`, 'm').test((await ask('/metrics', tokens.viewer)).body.toString()));
        const refusing = new SyslogServer(key, cert, options), accepting = new SyslogServer(key, cert, { requestCert: false });
        await refusing.listen(port);
        await start('--audit-syslog', `localhost:${port}`, '--audit-ca', path('log.pem'));
        const began = lines().findLast(({ event }) => event === 'start');
        await plant.daemon.line(new RegExp(`audit: syslog server localhost:\\d+ does not accept audit lines; check .*${reason}`));
        await metric(0);
        await ask('/api/v1/tags', 'pc_wrong', { localAddress: '127.0.0.23' });
        await refusing.close();
        await accepting.listen(port);
        await accepting.until('the start', (text) => text.includes(`"seq":${began.seq},`));
        await accepting.until('the refused login', (text) => text.includes('"from":"127.0.0.23"'));
        await plant.daemon.line(/audit: syslog server localhost:\d+ accepts audit lines again/);
        await metric(1);
        await accepting.close();
    });
