// SPDX-License-Identifier: GPL-3.0-or-later
// A client that comes through a proxy unknown to the daemon has no rights, however the daemon listens, and the log says who was
// admitted or refused.
import assert from 'node:assert/strict';
import { appendFileSync, readFileSync, writeFileSync } from 'node:fs';
import http from 'node:http';
import https from 'node:https';
import { connect } from 'node:net';
import { connect as connectTls } from 'node:tls';
import { join } from 'node:path';
import { test } from 'node:test';
import { makeCertificate } from './support/certificate.mjs';
import { encodeFrame, PlainClient } from './support/plain_client.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
const FORWARDED = {
    'X-Forwarded-For': '203.0.113.7', Forwarded: 'for=203.0.113.7', 'X-Real-IP': '203.0.113.7', Via: '1.1 proxy.example',
    'X-Forwarded-Host': 'plant.example', 'X-Forwarded-Proto': 'https',
};
const UPGRADE = {
    Connection: 'Upgrade', Upgrade: 'websocket', 'Sec-WebSocket-Version': 13, 'Sec-WebSocket-Key': 'AAAAAAAAAAAAAAAAAAAAAA==',
    'Sec-WebSocket-Protocol': 'plantcast.v1',
};
let plant, tokensFile, tokens, tls;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    appendFileSync(plant.file, 'alarms: local\n');
    const list = join(plant.folder, 'tags.csv'), lines = readFileSync(list, 'utf8').split('\n');
    writeFileSync(list, lines.map((line, i) => line && line + (i === 0 ? ',H' : ',60')).join('\n'));
    assert.equal(plant.prepare().code, 0);
    tokensFile = join(plant.folder, 'tokens');
    tokens = {};
    for (const [role, ...more] of [['viewer'], ['engineer'], ['operator', '--until', '2001-01-01']]) {
        const added = runProgram('plantcast', ['token', 'add', tokensFile, '--role', role, '--name', `${role}-1`, ...more]);
        tokens[role] = added.out.trim();
    }
    makeCertificate(plant.folder, 'cert', ['plant.example']);
    tls = ['--tls-cert', join(plant.folder, 'cert.pem'), '--tls-key', join(plant.folder, 'cert.key')];
});

async function serve(...args) {
    await plant.daemon?.stop();
    await plant.startDaemon(...args);
}
// Returns { status, headers, body } of a request from this machine.
function ask(path, headers = {}, secure = false) {
    return new Promise((done, fail) => {
        const to = { port: plant.port, host: '127.0.0.1', path }, all = { Host: 'localhost', ...headers };
        const options = { ...to, headers: all, rejectUnauthorized: false };
        const asked = (secure ? https : http).request(options, (response) => {
            let body = '';
            response.on('data', (chunk) => { body += chunk; });
            response.on('end', () => done({ status: response.statusCode, headers: response.headers, body }));
        });
        asked.on('upgrade', (response, socket) => { socket.destroy(); done({ status: 101, headers: response.headers }); });
        asked.on('error', fail).end();
    });
}
const bearer = (token) => ({ Authorization: `Bearer ${token}` });
const metric = async (name) => {
    const answer = await fetch(`http://127.0.0.1:${plant.port}/metrics`, { headers: bearer(tokens.viewer) });
    return Number((await answer.text()).match(new RegExp(`^${name} (\\d+)`, 'm'))?.[1]);
};

test('clients of an unknown proxy get 403, however the daemon listens', { skip }, async () => {
    const any = ['--listen', '0.0.0.0', '--host', 'plant.example'], more = ['--tokens', tokensFile];
    const ways = [ // [arguments, status that a local client gets without a token]
        [[], 200], [more, 401], [[...more, '--trust-local'], 200], [[...tls, ...more], 401], [[...any, '--open-viewers'], 200],
        [[...any, '--open-viewers', ...more], 403], [[...any, ...tls, ...more], 401], [[...any, ...tls, ...more, '--trust-local'], 200],
    ];
    for (const [args, direct] of ways) {
        const secure = args.includes('--tls-cert'), what = args.join(' ');
        await serve(...args);
        assert.equal((await ask('/api/v1/tags', {}, secure)).status, direct, what);
        for (const [name, value] of Object.entries(FORWARDED))
            for (const Host of args.includes('--host') ? ['localhost', 'plant.example'] : ['localhost'])
                for (const [path, headers] of [['/api/v1/tags', {}], ['/metrics', bearer(tokens.viewer)], ['/stream', UPGRADE]])
                    assert.equal((await ask(path, { ...headers, Host, [name]: value }, secure)).status, 403, `${what}: ${name} ${path}`);
        // A host name from --host admits the request, but gives it no rights without a token.
        if (args.includes('--host') && !args.includes('--trust-local'))
            assert.ok([401, 403].includes((await ask('/api/v1/tags', { Host: 'plant.example' }, secure)).status), what);
    }
});

// An engineer first causes messages with tag and user names: saves a list, writes a note, checks a loop. An open viewer (a
// client without a token) must get none of them.
test('an open viewer gets no reading, tag or user name, and can follow nobody by guessing session numbers', { skip }, async () => {
    await plant.startSim();
    await serve('--behind-proxy', '--host', 'plant.example', '--open-viewers', '--tokens', tokensFile);
    await plant.set({ 'TI-1': 81.25, 'TI-2': 20.5, 'PI-1': 5 });
    const as = (more = {}) => PlainClient.open(plant.port, { host: 'plant.example' }).then(async (client) => {
        client.welcome = await client.hello(more);
        return client;
    });
    const engineer = await as({ token: tokens.engineer });
    engineer.say({ type: 'params', seq: 1, baseline: { set: 'Kim, 7th' } });
    await engineer.text('params');
    engineer.say({ type: 'params', seq: 2, sensors: { 'TI-1': { strength: 2 } } });
    engineer.say({ type: 'prove', seq: 1, tag: 'TI-1', expected: 81, tolerance: 1, remark: 'by Kim' });
    await engineer.text('proved');
    engineer.say({ type: 'alarm', seq: 1, action: 'shelve', alarms: [['TI-1', 'H']], reason: 'Kim knows', for_s: 60, name: 'Kim' });
    await engineer.text('alarmed');
    assert.equal((await engineer.until('tags', (c) => c.texts.find((m) => m.type === 'tags'))).values.length, 3);

    const stranger = await as(), { welcome } = stranger;
    assert.deepEqual([welcome.role, welcome.tags, welcome.links], ['open', [], []]);
    assert.ok(welcome.assets.length === 2 && welcome.assets.every((asset) => !asset.properties));
    const guesses = [1, 2, 3, 4].concat([-2, -1, 1, 2].map((step) => welcome.session + step));
    for (const session of guesses) {
        stranger.say({ type: 'follow', session });
        assert.equal((await stranger.text('error')).code, 'bad_field', String(session));
    }
    assert.ok(Math.abs(engineer.welcome.session - welcome.session) > 1000 && Number.isSafeInteger(welcome.session));
    // a viewer that knows the session number, here from a link that the engineer shared, may follow that session
    stranger.say({ type: 'follow', session: engineer.welcome.session });
    const following = await stranger.text('following');
    assert.deepEqual([following.session, following.sensors, following.baselines], [engineer.welcome.session, {}, []]);
    stranger.say({ type: 'follow', session: null });
    stranger.say({ type: 'params', seq: 1, isolines: 20 });
    await stranger.frameWhere('its own picture', (f) => f.params_seq === 1);
    const picks = [];
    for (let x = 40; x < 320; x += 40) {
        stranger.say({ type: 'pick', seq: x, x, y: 90 });
        picks.push(await stranger.text('picked'));
    }
    assert.ok(picks.some((pick) => pick.asset && pick.position), 'the viewer\'s picks find assets and positions');
    assert.ok(picks.every((pick) => pick.value === null && pick.nearest.length === 0 && pick.sensor === null));
    // Two changes, because the server sends readings at most twice a second, and sends markers before pictures: once the second
    // change's picture has arrived, so have all messages caused by the first one.
    const changes = [];
    for (const value of [82.5, 61.5]) {
        await plant.tell(`set TI-1 ${value}`);
        changes.push(await engineer.until('the change', (c) =>
            c.texts.find((m) => m.type === 'tags' && m.values.some((row) => row[1] === value))));
    }
    await stranger.frameWhere('the second change', (f) => f.data_time_us > changes[0].time_us);
    stranger.say({ type: 'ping', t: 1 });
    await stranger.text('pong');
    const types = new Set(stranger.texts.map((m) => m.type));
    for (const type of ['tags', 'markers', 'alarms', 'proofs', 'alarmed'])
        assert.ok(!types.has(type), type);
    const all = JSON.stringify([welcome, following, picks, stranger.texts]);
    assert.doesNotMatch(all, /TI-\d|PI-\d|Kim|engineer-1|8[12]\.\d|20\.5|61\.5/);
    const picture = (headers = {}) => ask('/snapshot.png?width=320&height=200', { Host: 'plant.example', ...headers });
    assert.equal((await picture()).status, 200);
    // Error messages must not tell whether a tag exists: each request with an existing tag's name gets the same answer as one
    // with an unknown name.
    const hidden = (text, name) => text.replaceAll(name, 'NAME');
    for (const [i, names] of [['TI-1', 'TI-9'], ['PI-1', 'PI-9']].entries()) {
        const answers = [];
        for (const name of names) {
            const said = [];
            const distance = { show: 'distance', sensor: name };
            for (const [k, message] of [{ type: 'fit', id: name }, { type: 'params', ...distance },
                { type: 'params', sensors: { [name]: { strength: 2 } } }, { type: 'params', split: distance }].entries()) {
                stranger.say({ ...message, seq: 100 + 10 * i + k });
                const { code, text } = await stranger.text('error');
                said.push(`${code}: ${text}`);
            }
            const newcomer = await PlainClient.open(plant.port, { host: 'plant.example' });
            newcomer.say({ type: 'hello', width: 320, height: 180, codecs: ['jpeg'], params: { seq: 1, show: 'distance', sensor: name } });
            said.push((await newcomer.text('error')).code);
            newcomer.close();
            for (const query of [`fit=${name}`, `show=distance&sensor=${name}`]) {
                const { status, body } = await ask(`/snapshot.png?width=320&height=200&${query}`, { Host: 'plant.example' });
                said.push(`${status} ${body}`);
            }
            answers.push(hidden(JSON.stringify(said), name));
        }
        assert.equal(answers[0], answers[1]);
        assert.doesNotMatch(answers[0], /not_allowed|200 /);
    }
    const named = await as({ token: tokens.engineer, params: { seq: 1, show: 'distance', sensor: 'TI-1' } });
    named.say({ type: 'params', seq: 2, isolines: 20 });
    assert.equal((await named.text('params')).sensor, 'TI-1', 'a token in the hello permits naming tags');
    named.close();
    stranger.close();
    engineer.close();
});

test('over TLS: no CBC ciphers, HSTS is sent, and the policy limits connections and framing to named origins', { skip }, async () => {
    await serve(...tls, '--tokens', tokensFile, '--origin', 'https://portal.example');
    const { headers } = await ask('/', {}, true), policy = headers['content-security-policy'];
    assert.match(headers['strict-transport-security'], /^max-age=31536000/);
    assert.match(policy, /connect-src 'self';/);
    assert.match(policy, /frame-ancestors 'self' https:\/\/portal\.example$/);
    const handshake = (ciphers) => new Promise((done) => {
        const how = { port: plant.port, host: '127.0.0.1', rejectUnauthorized: false, maxVersion: 'TLSv1.2', ciphers };
        const socket = connectTls(how, () => {
            done(socket.getCipher().name);
            socket.destroy();
        });
        socket.on('error', () => done(null));
    });
    assert.equal(await handshake('ECDHE-ECDSA-AES128-GCM-SHA256'), 'ECDHE-ECDSA-AES128-GCM-SHA256');
    assert.equal(await handshake('ECDHE-ECDSA-CHACHA20-POLY1305'), 'ECDHE-ECDSA-CHACHA20-POLY1305');
    for (const cipher of ['ECDHE-ECDSA-AES128-SHA', 'ECDHE-ECDSA-AES256-SHA384', 'ECDHE-ECDSA-AES128-SHA256'])
        assert.equal(await handshake(cipher), null, cipher);
});

test('text that is not UTF-8 is closed with 1007, and user texts cannot become formulas in CSV files', { skip }, async () => {
    await serve();
    assert.equal((await ask('/')).headers['strict-transport-security'], undefined);
    for (const bytes of [[0x7b, 0xff, 0x7d], [0xc0, 0xaf], [0xed, 0xa0, 0x80], [0x7b, 0xe2, 0x82]]) {
        const client = await PlainClient.open(plant.port);
        client.write(encodeFrame(1, Buffer.from(bytes)));
        assert.equal((await client.until('a close', (c) => c.closed)).code, 1007, String(bytes));
    }
    const client = await PlainClient.open(plant.port);
    await client.hello();
    // a pong with bytes that are no valid UTF-8 is allowed, because a pong is not text
    client.write(encodeFrame(10, Buffer.from([0x80, 0xff, 0xc0, 1])));
    // splits the message into two frames within the bytes of one character, which is allowed
    const two = Buffer.from('{"type":"ping","t":7,"x":"\u20ac"}'), half = two.indexOf(0x82);
    client.write(Buffer.concat([encodeFrame(1, two.subarray(0, half), { fin: false }), encodeFrame(0, two.subarray(half))]));
    assert.equal((await client.text('pong')).t, 7);
    client.say({ type: 'prove', seq: 1, tag: 'TI-1', expected: 1, tolerance: 1, fail: true, remark: '=HYPERLINK("http://x")' });
    await client.text('proved');
    client.close();
    const answer = await fetch(`http://127.0.0.1:${plant.port}/api/v1/proofs`);
    assert.match(await answer.text(), /,"'=HYPERLINK\(""http/);
});

test('every accepted or refused token is logged; ten wrong tokens slow an address', { skip }, async () => {
    await serve('--tokens', tokensFile);
    const before = await metric('plantcast_sessions_refused_total');
    const wrong = 'pc_0123456789', lines = (pattern) => plant.daemon.said.match(pattern) ?? [];
    for (let i = 0; i < 6; i++)
        assert.equal((await ask('/api/v1/tags', bearer(wrong))).status, 401);
    assert.equal((await ask('/api/v1/tags', bearer(tokens.operator))).status, 401);
    const guess = await PlainClient.open(plant.port);
    guess.say({ type: 'hello', width: 320, height: 180, codecs: ['jpeg'], token: wrong });
    assert.equal((await guess.until('a close', (c) => c.closed)).code, 1008);
    const engineer = await PlainClient.open(plant.port);
    assert.equal((await engineer.hello({ token: tokens.engineer })).role, 'engineer');
    engineer.close();
    await plant.daemon.line(/token engineer-1/); // waits for the newest of these log lines; the earlier ones then exist, too
    assert.equal(lines(/login from 127\.0\.0\.1 by HTTP: token \(unknown\), role none: refused, the token is unknown \(\d/g).length, 6);
    assert.equal(lines(/by HTTP: token operator-1, role operator: refused, the token has expired/g).length, 1);
    assert.equal(lines(/by stream: token \(unknown\), role none: refused/g).length, 1);
    assert.equal(lines(/by stream: token engineer-1, role engineer: accepted/g).length, 1);
    assert.equal(lines(/by HTTP: token viewer-1, role viewer: accepted/g).length, 1);
    assert.equal(await metric('plantcast_sessions_refused_total') - before, 8);
    assert.equal(await metric('plantcast_logins_wrong_total'), 8);
    assert.equal(await metric('plantcast_logins_slowed_addresses'), 0);

    for (let i = 0; i < 2; i++)
        await ask('/stream', { ...UPGRADE, ...bearer(wrong) });
    const held = await ask('/api/v1/tags', bearer(wrong));
    assert.deepEqual([held.status, held.headers['retry-after']], [429, '5']);
    const late = await PlainClient.open(plant.port);
    late.say({ type: 'hello', width: 320, height: 180, codecs: ['jpeg'], token: wrong });
    assert.equal((await late.text('error')).retry_after_s, 5);
    assert.equal((await late.until('a close', (c) => c.closed)).code, 1013);
    assert.equal((await ask('/api/v1/tags', bearer(tokens.viewer))).status, 200, 'a token accepted before is not slowed');
    await until('the gauge', async () => await metric('plantcast_logins_slowed_addresses') === 1);
    assert.equal(await metric('plantcast_logins_held_total'), 2);
    await plant.daemon.line(/too many wrong tokens; only one attempt/);
    assert.equal(lines(/warn +login from 127\.0\.0\.1: too many wrong tokens/g).length, 1);
    for (const token of [wrong, ...Object.values(tokens)])
        assert.ok(!plant.daemon.said.includes(token.slice(3)), 'no token is in the log');
});

// All header names that libwebsockets recognises. If a request has a header whose name is only the beginning of one of these,
// the parser waits for the rest of the name and never ends the request.
const KNOWN = `accept accept-charset accept-encoding accept-language accept-ranges access-control-allow-origin
access-control-request-headers age allow authorization cache-control connection content-disposition content-encoding content-language
content-length content-location content-range content-type cookie date dnt etag expect expires forwarded from host http2-settings
if-match if-modified-since if-none-match if-range if-unmodified-since keep-alive last-event-id last-modified link location max-forwards
origin pragma proxy-authenticate proxy-authorization range referer replay-nonce retry-after sec-websocket-accept sec-websocket-draft
sec-websocket-extensions sec-websocket-key sec-websocket-protocol sec-websocket-version server set-cookie strict-transport-security te
transfer-encoding upgrade upgrade-insecure-requests user-agent vary via www-authenticate x-auth-token x-forwarded-for x-frame-options
x-real-ip`.split(/\s+/);

// Sends `text` after idleMs. Resolves with the first line of the server's answer, or "" if the server closes the connection
// without an answer.
function speak(text, secure = false, idleMs = 0) {
    return new Promise((done, fail) => {
        const where = { port: plant.port, host: '127.0.0.1', rejectUnauthorized: false };
        const socket = (secure ? connectTls : connect)(where, () => setTimeout(() => socket.write(text), idleMs));
        let said = '';
        socket.on('data', (bytes) => {
            said += bytes;
            if (said.includes('\r\n'))
                socket.destroy();
        });
        socket.on('close', () => done(said));
        socket.on('error', fail);
    });
}

const ENDING = 'a header whose name is the beginning of a known one ends its request within seconds, with 408';
test(ENDING, { skip, timeout: 200000 }, async () => {
    // patience: 60 s of allowed silence, so that this limit does not close the connections before the limit under test
    await serve('--limit', 'address-connections=2000', '--limit', 'patience=60');
    const names = [...new Set(KNOWN.flatMap((name) => [...name].map((_, i) => name.slice(0, i + 1))))], heads = {};
    const said = await Promise.all(names.map((name) => speak(`GET /healthz HTTP/1.1\r\nHost: localhost\r\n${name}: 1\r\n\r\n`)));
    said.forEach((text) => { heads[text.slice(9, 12)] = 1 + (heads[text.slice(9, 12)] ?? 0); });
    console.log(`# ${names.length} names:`, JSON.stringify(heads));
    assert.ok(said.every((text) => /^HTTP\/1\.[01] (200|400|403|408) /.test(text)), JSON.stringify(heads));
    assert.ok(heads[408] > 100);
    assert.match(plant.daemon.said, /http: a request from 127\.0\.0\.1 was closed with status 408: its headers were incomplete after 2 s/);
    assert.match(await speak('GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Plant: 1\r\n\r\n'), /^HTTP\/1\.1 200/,
        'an unknown header name is accepted');
});

test('over TLS, slow requests are ended, too; a connection without a request yet stays open', { skip, timeout: 200000 }, async () => {
    await serve(...tls, '--limit', 'patience=60');
    // idleMs: how long a connection waits before it sends its request; twice the 2 s after which an incomplete request is
    // ended, to show that the limit counts from the first byte
    const head = 'GET /healthz HTTP/1.1\r\nHost: localhost\r\n', idleMs = 4000;
    const [stuck, idle] = await Promise.all([speak(`${head}Acc: 1\r\n\r\n`, true), speak(`${head}\r\n`, true, idleMs)]);
    assert.match(stuck, /^HTTP\/1\.[01] 408 /);
    assert.match(idle, /^HTTP\/1\.1 200/);
});
