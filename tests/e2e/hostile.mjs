// SPDX-License-Identifier: GPL-3.0-or-later
// Malicious and careless clients: each gets its answer, all of them together do not slow another session's frames, and after
// they leave the daemon uses no more resources than before.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { readdirSync, readlinkSync } from 'node:fs';
import { connect } from 'node:net';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { encodeFrame, get, PlainClient } from './support/plain_client.mjs';
import { missing as missingDemo, startPlant } from './support/plant.mjs';
import { cpuMs } from './support/processes.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { BIN, notBuilt, runProgram, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
const noDemo = missingDemo();
const SILENT = 1000, PATIENCE_S = 3, FLOOD_PER_S = 10000, PATIENCE_MS = 60000;
const PINGS = 4000, MESSAGES_PER_S = 1000;
const HELLO = { type: 'hello', width: 320, height: 180, codecs: ['jpeg'] };
const LEAST_CPU_S = 0.4; // processor time of a viewer that gets all its frames, in seconds, is taken as at least this
const MOST_TIMES = 5; // the bad clients together may make the daemon use this many times the processor time that one viewer costs
let plant, quiet;

setUp(skip, async () => {
    plant = await TinyPlant.create();
    assert.equal(plant.prepare().code, 0);
    const tokens = join(plant.folder, 'tokens');
    assert.equal(runProgram('plantcast', ['token', 'add', tokens, '--role', 'viewer', '--name', 'somebody']).code, 0);
    await plant.startDaemon('--tokens', tokens, '--trust-local', '--limit', `patience=${PATIENCE_S}`,
        '--limit', `connections=${SILENT + 200}`);
    quiet = await TinyPlant.create();
    assert.equal(quiet.prepare().code, 0);
    await quiet.startDaemon();
});
after(() => Promise.all([plant?.destroy(), quiet?.destroy()]));

const closed = (client) => client.until('a close', (c) => c.closed, PATIENCE_MS);
const metric = async (name) => Number((await get(plant.port, '/metrics')).body.toString().match(new RegExp(`^${name} (\\d+)`, 'm'))[1]);
const cpuSeconds = ({ daemon }) => cpuMs(daemon.child.pid) / 1000;
// Counts the daemon's descriptors, except for plant files: journal and history are opened only when needed.
const descriptors = () => {
    const folder = `/proc/${plant.daemon.child.pid}/fd`;
    const path = (fd) => {
        try {
            return readlinkSync(join(folder, fd));
        } catch { // the descriptor was closed meanwhile
            return plant.folder;
        }
    };
    return readdirSync(folder).filter((fd) => !path(fd).startsWith(plant.folder)).length;
};

// Opens a raw socket, and records what the server sends and when it closes.
function raw(port) {
    const socket = connect(port, '127.0.0.1');
    socket.on('error', () => {});
    socket.ended = new Promise((done) => socket.once('close', () => done(performance.now())));
    socket.resume();
    return socket;
}

// Returns the frame rate of another client, a separate program whose camera moves 60 times a second.
function othersRate(port, seconds) {
    return new Promise((done, fail) => {
        const url = `http://127.0.0.1:${port}/`;
        const child = spawn(join(BIN, 'plantcast'), ['probe', url, '--seconds', String(seconds), '--size', '320x180', '--json']);
        let said = '', errors = '';
        child.stdout.on('data', (chunk) => { said += chunk; });
        child.stderr.on('data', (chunk) => { errors += chunk; });
        child.once('exit', (code) => (code === 0 ? done(JSON.parse(said).fps) : fail(new Error(errors))));
    });
}

test('absurd numbers in messages are refused by field, and the next valid message is accepted', { skip }, async () => {
    const client = await PlainClient.open(plant.port);
    for (const [width, height] of [[0, 0], [1e9, 1e9], [-5, 100], [16.5, 100], [8193, 16]]) {
        client.say({ ...HELLO, width, height });
        assert.deepEqual(Object.values(await client.text('error')).slice(1, 2), ['bad_field'], `a size of ${width}x${height} is refused`);
    }
    await client.hello();
    const bad = ['{"type":"camera","seq":1,"eye":[1e300,0,0],"target":[0,0,0]}',
        '{"type":"camera","seq":1,"eye":[NaN,0,0],"target":[0,0,0]}',
        '{"type":"camera","seq":1,"eye":[1,2,3],"target":[1,2,3]}', '{"type":"resize","width":0,"height":0}',
        '{"type":"resize","width":1000000000,"height":1000000000}', '{"type":"ack","seq":4000000000}', '{"type":"ack","seq":-1}'];
    for (const text of bad) {
        client.say(text);
        assert.match((await client.text('error')).code, /^(bad_field|not_json)$/, text);
    }
    client.say({ type: 'camera', seq: 7, eye: [5, -6, 4], target: [1, 0, 0] });
    const frame = await client.frameWhere('camera 7', (f) => f.camera_seq === 7);
    assert.deepEqual([frame.full_width, frame.full_height], [320, 180]);
    client.close();
});

test('ten thousand messages a second are read at the permitted rate, and all of them in the end', { skip }, async (t) => {
    const client = await PlainClient.open(plant.port);
    t.after(() => client.close());
    const pings = Buffer.concat(Array.from({ length: PINGS }, (_, t) => encodeFrame(1, `{"type":"ping","t":${t}}`)));
    const before = [await metric('plantcast_messages_total'), await metric('plantcast_message_errors_total')];
    const began = performance.now(); // the daemon begins to count messages per second when hello arrives
    await client.hello();
    client.write(pings);
    await client.until('the last answer', (c) => c.texts.some((m) => m.type === 'pong' && m.t === PINGS - 1), PATIENCE_MS);
    // full: seconds for which reading is limited. One second less, because the messages for one more second may be in the
    // socket's buffer.
    const took = performance.now() - began, full = Math.floor(PINGS / MESSAGES_PER_S) - 1;
    assert.ok(took >= 1000 * full, `${PINGS} messages in ${took.toFixed(0)} ms, at ${MESSAGES_PER_S} a second`);
    // waits for the metric, which the daemon updates at least once a second
    await until('all messages', async () => await metric('plantcast_messages_total') > before[0] + PINGS);
    const told = await metric('plantcast_message_errors_total') - before[1];
    // The daemon reports "too fast" once for each second in which it has read its maximum. A daemon too slow to read that many
    // messages in a second cannot notice the excess. If it reads all messages in time, it has read the maximum in every second
    // but the last.
    const reads = took < 1000 * (PINGS / MESSAGES_PER_S), said = `too fast: said ${told} times in ${took.toFixed(0)} ms`;
    assert.ok(told >= full || !reads, said);
    assert.equal(client.texts.some((m) => m.code === 'too_fast'), told > 0, said);
});

test('all kinds of bad clients at once: each gets its answer, and no other client is slowed', { skip }, async (t) => {
    const { port } = plant;
    await until('earlier clients to be gone', async () => await metric('plantcast_connections') <= 1);
    const filesBefore = descriptors();
    const began = performance.now();

    const silent = Array.from({ length: SILENT }, () => raw(port));
    const drips = Array.from({ length: 50 }, () => raw(port));
    for (const socket of drips)
        socket.write('GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ');
    const half = await PlainClient.open(port, { acknowledge: false });
    await half.hello();
    half.write(encodeFrame(1, '{"type":"pi', { fin: false }));
    const mute = await PlainClient.open(port);
    const flood = await PlainClient.open(port, { acknowledge: false });
    await flood.hello();
    flood.socket.pause(); // stops reading: the server's answers to this client pile up
    const camera = encodeFrame(1, '{"type":"camera","seq":1,"eye":[5,-6,4],"target":[1e300,0,0]}');
    const cameras = Buffer.concat(Array(FLOOD_PER_S / 10).fill(camera));
    const guesses = [];
    let turn = 0;
    const timer = setInterval(async () => {
        if (flood.socket.writableLength < 1e6)
            flood.write(cameras);
        for (const socket of drips)
            socket.write('y');
        if (++turn % 2 === 0) {
            const guess = await PlainClient.open(port).catch(() => null);
            guess?.say({ ...HELLO, token: `pc_${turn}` });
            if (guess)
                guesses.push(guess);
        }
    }, 100);
    // Measures both daemons at the same time, because other load slows both.
    const before = [plant, quiet].map(cpuSeconds);
    const [beside, alone] = await Promise.all([plant, quiet].map((one) => othersRate(one.port, 4)));
    const [took, tookAlone] = [plant, quiet].map((one, i) => cpuSeconds(one) - before[i]);

    const ended = await Promise.all([...silent, ...drips].map((socket) => socket.ended));
    await until('some guesses', () => guesses.length >= 5);
    clearInterval(timer);
    const last = (Math.max(...ended) - began) / 1000;
    promise(t, 'until the last of those who say nothing is let go', last * 1000, PATIENCE_S * 10000);
    assert.equal((await closed(half)).code, 1008);
    assert.match((await closed(mute)).text, /no hello/);
    for (const guess of guesses)
        // close code 1008 (wrong token) for the first ten guesses; 1013 (try again later) for later ones, which the lock-out
        // refuses
        assert.ok([1008, 1013].includes((await closed(guess)).code));
    assert.equal(guesses[0].texts[0].code, 'bad_token');
    flood.close();
    const rates = `${alone.toFixed(1)} frames/s of a daemon without them, ${beside.toFixed(1)} beside all of them; processor ` +
        `${tookAlone.toFixed(2)} and ${took.toFixed(2)} s of 4`;
    assert.ok(took < MOST_TIMES * Math.max(tookAlone, LEAST_CPU_S), rates);
    console.log(`# ${rates}`);
    promise(t, 'a frame beside all of them', 1000 / beside, 1000 / (0.7 * alone));

    await until('no more descriptors than before', () => descriptors() <= filesBefore, 90, () => `${descriptors()} of ${filesBefore}`);
    await until('no sessions', async () => await metric('plantcast_sessions') === 0);
    await until('no connections but the one that asks', async () => await metric('plantcast_connections') <= 1);
});

test('connections beyond the limit are closed, and a closed connection makes room for another', { skip }, async () => {
    const all = Array.from({ length: SILENT + 300 }, () => raw(plant.port));
    const first = await Promise.race(all.map((socket) => socket.ended.then(() => performance.now())));
    assert.ok(first > 0);
    await until('those beyond the limit to be cut off', () => all.filter((socket) => socket.destroyed).length >= 50);
    for (const socket of all)
        socket.destroy();
    await until('room', () => get(plant.port, '/healthz').then(({ status }) => status === 200, () => false));
});

// Uses many views that are slow to draw. With few views, or a plant that is quick to draw, all clients sometimes wait for their
// encoders while the render thread idles.
test('while drawing is overloaded, a new session is refused with the reason and a time to retry',
    { skip: skip || noDemo || false }, async () => {
    const busy = await startPlant('', () => {}, ['--limit', 'least-fps=1000']);
    try {
        const load = ['--seconds', '600', '--sessions', '12', '--size', '960x540', '--blind', '--json'];
        const mover = spawn(join(BIN, 'plantcast'), ['probe', busy.url, ...load], { stdio: 'ignore' });
        const ended = new Promise((done) => mover.once('exit', done)), port = Number(new URL(busy.url).port);
        const refused = await until('a refusal', async () => {
            const client = await PlainClient.open(port);
            client.say(HELLO);
            await client.until('welcome or a close', (c) => c.closed || c.texts.some((m) => m.type === 'welcome'));
            if (client.closed)
                return client;
            client.close();
            return sleep(500);
        }).finally(() => mover.kill());
        await ended;
        assert.equal(refused.closed.code, 1013);
        const error = refused.texts.find((m) => m.type === 'error');
        assert.equal(refused.closed.text, error.text);
        assert.ok(['pixels', 'pixels_address', 'movers', 'late'].includes(error.refusal.code), error.refusal.code);
        assert.deepEqual([error.code, error.retry_after_s], ['full', 10]);
    } finally {
        await busy.stop();
    }
});

test('after all attacks the daemon still runs, and exits cleanly', { skip }, async () => {
    assert.deepEqual(await plant.daemon.stop('SIGTERM'), { code: 0, signal: null }, plant.daemon.said);
    assert.ok(!/ERROR: |WARNING: ThreadSanitizer|runtime error/.test(plant.daemon.said), plant.daemon.said);
});
