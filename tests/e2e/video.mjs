// SPDX-License-Identifier: GPL-3.0-or-later
// A view as video, read by other programs: constant frame rate, the clock encoded in its pixels, and a card instead of an old
// picture.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { appendFileSync, existsSync, readFileSync, writeFileSync } from 'node:fs';
import { connect, createServer } from 'node:net';
import { networkInterfaces } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { SCREENSHOTS } from './support/browser.mjs';
import { folderOfTests } from './support/folders.mjs';
import { freePort } from './support/ports.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { sweep } from './support/sweep.mjs';
import { BIN, missing, Program, runProgram, TinyPlant } from './support/tiny_plant.mjs';

const lacks = [...missing(), ...(existsSync(join(BIN, 'plantcast-video')) ? [] : ['plantcast-video']),
    ...(spawnSync('ffmpeg', ['-version']).error ? ['ffmpeg'] : [])];
const options = { skip: lacks.length > 0 ? `not here: ${lacks.join(', ')}` : false, timeout: 240000 };
const WIDTH = 320, HEIGHT = 180, STRIP_PX = 26, FPS = 10, RECORDED_S = Number(process.env.VIDEO_S ?? sweep(20, 10));
const READER = 'wall:long-password';
const folder = folderOfTests();
let plant, video, ports;

async function startVideo(...args) {
    const program = new Program('plantcast-video', [`http://127.0.0.1:${plant.port}/`, '--fps', String(FPS), '--time-code',
        ...args.includes('--size') ? [] : ['--size', `${WIDTH}x${HEIGHT}`], ...args]);
    await program.line(/^plantcast-video: ready$/m);
    return program;
}

// plantcast-video encodes the time in a row of black and white blocks. BITS: number of blocks for the time. codeOf(row) returns
// { tenths: tenths of seconds since 1970; card: whether the frame shows a text card; sound: whether the parity is right }.
const BITS = 36, BLOCKS = BITS + 4;
function codeOf(row) {
    const bits = [...row].map((value) => (value > 127 ? 1 : 0));
    const sound = bits[0] === 1 && bits[1] === 0 && bits.slice(0, -1).reduce((a, b) => a ^ b) === bits.at(-1);
    return { sound, tenths: bits.slice(2, 2 + BITS).reduce((n, bit) => n * 2 + bit, 0), card: bits[2 + BITS] === 1 };
}

class Reader {
    constructor(url, ...args) {
        this.frames = [];
        this.said = '';
        let rest = Buffer.alloc(0);
        // video filter that extracts the pixel in the middle of each block
        const row = `format=gray,crop=iw:1:0:ih-3,scale=${BLOCKS}:1:flags=neighbor`;
        this.child = spawn('ffmpeg', ['-v', 'error', '-fflags', 'nobuffer', ...args, '-i', url, '-vf', row, '-fps_mode', 'passthrough',
            '-f', 'rawvideo', 'pipe:1'], { stdio: ['ignore', 'pipe', 'pipe'] });
        this.ended = new Promise((done) => this.child.once('exit', done));
        this.child.stderr.on('data', (chunk) => { this.said += chunk; });
        this.child.stdout.on('data', (chunk) => {
            for (rest = Buffer.concat([rest, chunk]); rest.length >= BLOCKS; rest = rest.subarray(BLOCKS))
                this.frames.push({ ...codeOf(rest.subarray(0, BLOCKS)), at: Date.now() });
        });
    }

    async until(what, timeoutMs = 30000) {
        for (const end = Date.now() + timeoutMs; ;) {
            const last = this.frames.at(-1);
            if (last && what(last))
                return last;
            if (Date.now() > end || this.child.exitCode !== null)
                throw new Error(`it never came, after ${this.frames.length} frames; ${this.said}`);
            await new Promise((done) => setTimeout(done, 20));
        }
    }

    async stop() {
        this.child.kill('SIGKILL');
        await this.ended;
    }
}

const SHOTS = process.env.PLANTCAST_SHOTS === '1' ? SCREENSHOTS : null;

const rtsp = (port = ports.rtsp, user = `${encodeURI(READER)}@`) => `rtsp://${user}127.0.0.1:${port}/plantcast`;
const readRtsp = () => new Reader(rtsp(), '-rtsp_transport', 'tcp');

const http = (path) => fetch(`http://127.0.0.1:${ports.http}${path}`);
async function metric(name) {
    const text = await (await http('/metrics')).text();
    return Number(text.match(new RegExp(`^${name.replace(/[{}]/g, '\\$&')} (\\S+)$`, 'm'))[1]);
}

setUp(options.skip, async () => {
    plant = await TinyPlant.running();
    writeFileSync(join(folder, 'readers'), `${READER}\n`);
    ports = { rtsp: await freePort(), srt: await freePort(), http: await freePort() };
    video = await startVideo('--readers-file', join(folder, 'readers'), '--rtsp', String(ports.rtsp), '--srt', String(ports.srt),
        '--http', String(ports.http));
});
after(async () => {
    await video?.stop();
    await plant?.destroy();
    assert.equal(video?.fault ?? null, null);
});

test('RTSP by TCP and UDP gives H.264 of the configured size and rate, to clients with the password', options, () => {
    const probe = (url, transport) => spawnSync('ffprobe', ['-v', 'error', '-rtsp_transport', transport, '-show_entries',
        'stream=codec_name,profile,width,height,r_frame_rate', '-of', 'csv=p=0', url], { encoding: 'utf8', timeout: 30000 });
    for (const transport of ['tcp', 'udp'])
        assert.equal(probe(rtsp(), transport).stdout.trim(), `h264,Constrained Baseline,${WIDTH},${HEIGHT},${FPS}/1`, transport);
    for (const user of ['', 'wall:wrong@'])
        assert.match(probe(rtsp(ports.rtsp, user), 'tcp').stderr, /401 Unauthorized/, user);
});

test('SRT carries the same pictures, encrypted with the password', options, async () => {
    const srt = (more) => `srt://127.0.0.1:${ports.srt}?mode=caller&connect_timeout=3000${more}`;
    const reader = new Reader(srt(`&passphrase=${encodeURIComponent(READER.split(':')[1])}&pbkeylen=16`));
    const { sound, tenths, at } = await reader.until(({ card }) => !card);
    assert.ok(sound && at - tenths * 100 < 20000);
    await reader.stop();
    const stranger = new Reader(srt('&passphrase=not-that-password&pbkeylen=16'));
    assert.notEqual(await stranger.ended, 0);
    assert.equal(stranger.frames.length, 0);
});

test('ten readers of a stream cost one encoder, and a reader that stalls delays no other', options, async () => {
    const readers = Array.from({ length: 10 }, readRtsp);
    for (const reader of readers)
        await reader.until(() => true, 60000);
    readers[0].child.kill('SIGSTOP');
    const before = await metric('plantcast_video_frames_total'), counts = readers.map(({ frames }) => frames.length), begun = Date.now();
    await new Promise((done) => setTimeout(done, 5000));
    const passed = (Date.now() - begun) / 1000, made = await metric('plantcast_video_frames_total') - before;
    assert.equal(await metric('plantcast_video_readers{output="rtsp"}'), 10);
    assert.ok(made > 0.7 * FPS * passed && made < 1.2 * FPS * passed, `${made} frames in ${passed} s`);
    for (const [i, { frames }] of readers.entries())
        assert.ok(i === 0 || frames.length - counts[i] > 0.6 * FPS * passed,
            `reader ${i} got ${frames.length - counts[i]} frames in ${passed} s`);
    for (const reader of readers)
        await reader.stop();
});

test('every second is in the video, on time, whatever happens', { ...options, timeout: (RECORDED_S + 60) * 1000 }, async () => {
    const reader = readRtsp();
    await reader.until(() => true);
    await new Promise((done) => setTimeout(done, RECORDED_S * 1000));
    await reader.stop();
    const { frames } = reader, seconds = new Set(frames.map(({ tenths }) => Math.floor(tenths / 10)));
    assert.ok(frames.every(({ sound }) => sound));
    const steps = frames.slice(1).map(({ tenths }, i) => tenths - frames[i].tenths);
    assert.ok(steps.every((step) => step >= 0 && step <= 10), `steps of the clock in the frames, in tenths of a second: ${steps}`);
    assert.ok(seconds.size >= RECORDED_S, `${seconds.size} of ${RECORDED_S} s are in the video`);
    assert.ok(frames.length >= RECORDED_S * FPS * 0.8, `${frames.length} frames in ${RECORDED_S} s`);
    const lag = frames.map(({ at, tenths }) => at - tenths * 100).sort((a, b) => a - b);
    assert.ok(lag[Math.floor(lag.length / 2)] < 2000, `${lag[Math.floor(lag.length / 2)]} ms from clock to reader`);
});

test('when a server dies or hangs, a card appears within 3 s, and pictures return by themselves', options, async (t) => {
    const reader = readRtsp();
    await reader.until(({ card }) => !card);
    for (const signal of ['SIGSTOP', 'SIGKILL']) {
        const port = plant.port, begun = Date.now();
        plant.daemon.child.kill(signal);
        const { at } = await reader.until(({ card }) => card);
        // limit in ms: 3 s until the card is shown, plus 0.4 s for the buffers of the program that reads the video
        promise(t, `${signal}: to the card on the reader's screen`, at - begun, 3400);
        if (signal === 'SIGSTOP') {
            plant.daemon.child.kill('SIGCONT');
        } else {
            plant.daemon.stopped = true;
            await plant.daemon.ended;
            await plant.startDaemon('--port', String(port));
        }
        await reader.until(({ card }) => !card);
    }
    plant.sim.child.kill('SIGSTOP'); // the device stops answering, so its values are stale after 1 s
    const begun = Date.now(), { at } = await reader.until(({ card }) => card);
    promise(t, 'from the last value to the card', at - begun, 5000);
    assert.match(video.said, /no sensor shown delivers a value/);
    plant.sim.child.kill('SIGCONT');
    await reader.until(({ card }) => !card);
    await reader.stop();
});

test('metrics are served on this machine only, and idle connections do not block them', options, async () => {
    const elsewhere = Object.values(networkInterfaces()).flat().find(({ family, internal }) => family === 'IPv4' && !internal);
    if (elsewhere) // --http listens on 127.0.0.1 only
        await assert.rejects(fetch(`http://${elsewhere.address}:${ports.http}/metrics`));
    const idle = Array.from({ length: 20 }, () => connect(ports.http, '127.0.0.1').on('error', () => {}).resume());
    idle[0].write('GET /metrics HT');
    // Status 0: the connection was closed without an answer, because --http serves only 8 connections and idle ones occupy
    // them.
    const answered = () => http('/metrics').then(({ status }) => status, () => 0);
    for (const end = Date.now() + 60000; await answered() !== 200; await new Promise((done) => setTimeout(done, 100)))
        assert.ok(Date.now() < end, 'idle connections are closed');
    assert.equal((await http('/')).status, 404);
    idle.forEach((socket) => socket.destroy());
});

test('the video program ends on SIGTERM', options, async () => {
    assert.deepEqual(await video.stop(), { code: 0, signal: null });
});

test('an invalid or revoked token, and an unknown view, are reported on a card', options, async (t) => {
    const tokens = join(plant.folder, 'tokens'), token = join(folder, 'token');
    const made = runProgram('plantcast', ['token', 'add', tokens, '--role', 'viewer', '--name', 'video']);
    assert.equal(made.code, 0, made.err);
    writeFileSync(token, `${made.out.trim()}\n`);
    await plant.daemon.stop();
    await plant.startDaemon('--tokens', tokens);
    const port = await freePort(), start = (...args) => startVideo('--token-file', token, '--rtsp', String(port), ...args);
    const see = () => new Reader(rtsp(port, ''), '-rtsp_transport', 'tcp');
    let program = await start(), reader = see();
    await reader.until(({ card }) => !card);
    const begun = Date.now();
    assert.equal(runProgram('plantcast', ['token', 'revoke', tokens, 'video']).code, 0);
    const { at } = await reader.until(({ card }) => card);
    // limit in ms: 3 s until the server's refusal, 1 s to the next picture, plus the buffers of the program that reads the
    // video
    promise(t, 'to the card', at - begun, 5400);
    assert.match(program.said, /rejects this token/);
    await reader.stop();
    await program.stop();
    await plant.daemon.stop();
    await plant.startDaemon();
    program = await start('--view', 'none');
    await program.line(/there is no view 'none'; the views are: none/);
    reader = see();
    assert.ok((await reader.until(() => true)).card);
    await reader.stop();
    await program.stop();
});

test('a named view is drawn with all its parameters, in perspective or orthographic', options, async () => {
    const port = await freePort(), camera = 'camera=4,-4,3,0,0,0,0,0,1,45';
    const text = `group=temperature&show=operator&look=flat&colormap=viridis&ramp=10&range=0,50&isolines=20,40&light=1,1,2&ghost=P-101A&` +
        `split=group:pressure;look:glossy&clip=1,0,0,0.2&asset=E-101&tag=TI-1&strength=2&${camera}`;
    const whole = `group=pressure&hide=&clip=-1,-1,-1,5,5,5&split=same&${camera},6`;
    const views = [['first', text], ['second', whole], ['near', `group=temperature&reach=0.1&${camera}`],
        ['half', `group=temperature&split=reach_m:0.1&${camera}`], ['plain', `look=materials&${camera}`], ['then', `at=1&${camera}`]];
    const lines = views.map(([id, view]) => `  - { id: ${id}, title: View ${id}, view: "${view}" }\n`);
    await plant.daemon.stop();
    appendFileSync(plant.file, `views:\n${lines.join('')}`);
    await plant.startDaemon();
    const pictures = {};
    // `near` and `half` limit the reach of sensors, which viewers may not do in a query; `then` shows the present in a video
    for (const id of ['first', 'second', 'near', 'half', 'then']) {
        const program = await startVideo('--view', id, '--rtsp', String(port));
        const reader = new Reader(rtsp(port, ''), '-rtsp_transport', 'tcp');
        await reader.until(({ card }) => !card);
        assert.doesNotMatch(program.said, /no view|expected|unknown/);
        if (id === 'near')
            pictures.video = grey('-rtsp_transport', 'tcp', '-i', rtsp(port, ''));
        await reader.stop();
        await program.stop();
    }
    for (const query of ['view=near', 'view=near&reach_m=none']) {
        const url = `http://127.0.0.1:${plant.port}/snapshot.png?width=${WIDTH}&height=${HEIGHT - STRIP_PX}&${query}`;
        pictures[query] = grey('-i', url);
    }
    // the middle of the picture, which shows the plant; the clock and the ages of values differ
    const apart = (a, b) => difference(pictures[a], pictures[b], WIDTH, [0.2, 0.2, 0.75, 0.8]);
    const near = apart('video', 'view=near'), far = apart('video', 'view=near&reach_m=none');
    assert.ok(far > 3 * near, `the video differs by ${near} from the view, and by ${far} from the view with unlimited reach`);
});

// Returns the upper part of a picture of WIDTH, without the video's strip, as grey pixels. args: ffmpeg's arguments for its input.
function grey(...args) {
    const tall = HEIGHT - STRIP_PX, { stdout, stderr } = spawnSync('ffmpeg', ['-v', 'error', ...args, '-frames:v', '1', '-vf',
        `crop=${WIDTH}:${tall}:0:0`, '-f', 'rawvideo', '-pix_fmt', 'gray', 'pipe:1'], { timeout: 30000 });
    assert.equal(stdout.length, WIDTH * tall, String(stderr));
    return stdout;
}

// Returns the mean difference of two grey pictures of that width within a box, whose sides are fractions of the picture's size.
function difference(a, b, wide, [left, top, right, bottom]) {
    const tall = a.length / wide;
    let sum = 0, count = 0;
    for (let y = Math.floor(top * tall); y < bottom * tall; y++)
        for (let x = Math.floor(left * wide); x < right * wide; x++, count++)
            sum += Math.abs(a[y * wide + x] - b[y * wide + x]);
    return sum / count;
}

test('cards, strip and legend are in the requested language', options, async () => {
    const port = await freePort(), HEADLINE = [0, 0.3, 1, 0.55], LEGEND = [0.9, 0.72, 0.99, 0.77], AGE = [0.65, 0.965, 0.82, 0.985];
    const see = async (language, card, wide, tall, ...args) => {
        const program = await startVideo('--size', `${wide}x${tall}`, '--rtsp', String(port), '--language', language, ...args);
        if (card) {
            await program.line(/there is no view/);
        } else {
            const reader = new Reader(rtsp(port, ''), '-rtsp_transport', 'tcp');
            await reader.until((frame) => !frame.card);
            await reader.stop();
        }
        const picture = spawnSync('ffmpeg', ['-v', 'error', '-rtsp_transport', 'tcp', '-i', rtsp(port, ''), '-frames:v', '1',
            ...SHOTS ? ['-y', join(SHOTS, `video-${language}-${card ? 'card' : 'view'}.png`)] : [],
            '-f', 'rawvideo', '-pix_fmt', 'gray', '-frames:v', '1', 'pipe:1'], { maxBuffer: 2 * wide * tall, timeout: 30000 }).stdout;
        assert.equal(picture.length, wide * tall);
        await program.stop();
        return picture;
    };
    // Compares pictures in English, Korean and German: the boxes with words must differ by language. On a card, whose words are
    // large, a smaller picture suffices.
    for (const [card, boxes, size, args] of [[true, [HEADLINE], [640, 360], ['--view', 'none']], [false, [LEGEND, AGE], [1280, 720], []]]) {
        const [english, again, korean, german] = [await see('en', card, ...size, ...args), await see('en', card, ...size, ...args),
            await see('ko', card, ...size, ...args), await see('de', card, ...size, ...args)];
        for (const box of boxes) {
            const apart = (a, b) => difference(a, b, size[0], box), same = apart(english, again);
            for (const [name, a, b] of [['ko', english, korean], ['de', english, german], ['ko and de', korean, german]])
                assert.ok(apart(a, b) > 3 * same + 0.5, `${name}: difference ${apart(a, b)}, beside ${same}, in ${box}`);
        }
    }
});

test('a token restricted to one view shows that view and no other; revoking the token ends the picture', options, async () => {
    const tokens = join(plant.folder, 'tokens'), token = join(folder, 'token'), port = await freePort();
    const made = runProgram('plantcast', ['token', 'add', tokens, '--role', 'viewer', '--name', 'lobby', '--views',
        'first,plain,then']);
    assert.equal(made.code, 0, made.err);
    writeFileSync(token, `${made.out.trim()}\n`);
    await plant.daemon.stop();
    await plant.startDaemon('--tokens', tokens, '--audit', join(folder, 'audit'));
    const start = (view) => startVideo('--view', view, '--token-file', token, '--rtsp', String(port));
    // `plain` shows materials and no readings
    for (const [view, refusal] of [['second', /rejects this token: .*“second” is not allowed: this token is for the views first/],
        ['then', /the view shows a time in the past, but the video shows only the present/], ['plain'], ['first']]) {
        const program = await start(view), reader = new Reader(rtsp(port, ''), '-rtsp_transport', 'tcp');
        if (refusal)
            await program.line(refusal);
        else
            await reader.until(({ card }) => !card);
        assert.equal(reader.frames.some(({ card }) => !card), !refusal);
        if (view === 'first') {
            const count = () => readFileSync(join(folder, 'audit'), 'utf8').split('"refused"').length - 1, refused = count();
            // waits 6 s: a client that was permitted to list views would request them every 5 s, and this one must not
            await new Promise((done) => setTimeout(done, 6000));
            assert.equal(count(), refused);
            assert.doesNotMatch(program.said, /rejects this token|not allowed/);
            assert.equal(runProgram('plantcast', ['token', 'revoke', tokens, 'lobby']).code, 0);
            await reader.until(({ card }) => card);
        }
        await reader.stop();
        await program.stop();
    }
    await plant.daemon.stop();
    await plant.startDaemon();
});

test('invalid options and configuration are reported', options, async () => {
    const url = `http://127.0.0.1:${plant.port}/`, taken = createServer();
    await new Promise((done) => taken.listen(0, '127.0.0.1', done));
    const port = taken.address().port;
    writeFileSync(join(folder, 'empty'), '');
    writeFileSync(join(folder, 'nameless'), 'password\n');
    for (const [args, code, said] of [
        [[], 2, /URL of one daemon/],
        [[url], 2, /no output/],
        [['ftp://127.0.0.1/', '--rtsp', '1'], 2, /is not a URL such as http/],
        [[url, '--rtsp', '99999'], 2, /--rtsp 99999: expected 0 to 65535/],
        [[url, '--rtsp', '8554', '--fps', '4'], 2, /--fps 4: expected 5 to 30/],
        [[url, '--rtsp', '8554', '--size', '641x360'], 2, /even numbers/],
        [[url, '--rtsp', '8554', '--listen', '0.0.0.0'], 2, /anyone who can reach this address could watch/],
        [[url, '--rtsp', '8554', '--view', 'a', '--query', 'b'], 2, /cannot be combined/],
        [[url, '--rtsp', '8554', '--language', 'fr'], 2, /--language fr: expected en, ko or de/],
        [[url, '--rtsp', '8554', '--wall', 'b'], 2, /Unknown option --wall/],
        [[url, '--rtsp', '8554', '--ca', join(folder, 'none')], 1, /No such file/],
        [[url, '--rtsp', '8554', '--token-file', join(folder, 'empty')], 2, /the first line/],
        [[url, '--rtsp', '8554', '--token-file', join(folder, 'none')], 2, /No such file/],
        [[url, '--rtsp', '8554', '--readers-file', join(folder, 'nameless')], 2, /USER:PASSWORD/],
        [[url, '--rtsp', String(port)], 1, /--rtsp \d+: .*in use/],
    ]) {
        const result = runProgram('plantcast-video', args, 10000);
        assert.equal(result.code, code, `${args}: ${result.err}`);
        assert.match(result.err, said);
    }
    taken.close();
});
