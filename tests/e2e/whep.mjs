// SPDX-License-Identifier: GPL-3.0-or-later
// Video by WebRTC (WHEP), watched by a real browser from a page of another server.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, shoot } from './support/browser.mjs';
import { Pace } from './support/crowd.mjs';
import { freePort } from './support/ports.mjs';
import { BIN, missing, Program, runProgram, TinyPlant } from './support/tiny_plant.mjs';

const SLOW = resolve(process.env.PLANTCAST_OUT ?? 'build/release', 'tests/faults/slow_answer.so');
const lacks = [...missing(), ...(existsSync(join(BIN, 'plantcast-video')) ? [] : ['plantcast-video']),
    ...(!existsSync(join(BIN, 'plantcast-video')) || existsSync(SLOW) ? [] : ['slow_answer.so'])];
const options = { skip: lacks.length > 0 ? `not here: ${lacks.join(', ')}` : false, timeout: 180000 };
const WIDTH = 320, HEIGHT = 180, FPS = 10, PASSWORD = 'long-password';
let plant, folder, video, port, pages, page, slow;

// In the page: watches, and reads the row of blocks at the bottom as video.mjs does.
const watcher = () => {
    const BITS = 36, BLOCKS = BITS + 4;
    globalThis.watch = async (url, token, more, tries) => {
        const peer = new RTCPeerConnection(), element = document.createElement('video');
        peer.addTransceiver('video', { direction: 'recvonly' });
        for (const kind of more)
            peer.addTransceiver(kind, { direction: 'recvonly' });
        Object.assign(element, { muted: true, width: 64, height: 36 }); // on the screen: only there all frames are drawn
        peer.ontrack = ({ track }) => { if (track.kind === 'video') element.srcObject = new MediaStream([track]); };
        document.body.append(element);
        await peer.setLocalDescription(await peer.createOffer());
        const reply = await fetch(url, { method: 'POST', body: peer.localDescription.sdp,
            headers: { 'Content-Type': 'application/sdp', Authorization: `Bearer ${token}` } });
        const answer = await reply.text(), retryS = Number(reply.headers.get('Retry-After'));
        if (reply.status !== 201) {
            peer.close();
            element.remove();
            if (reply.status !== 503 || tries <= 1)
                return { status: reply.status, answer, retryS };
            await new Promise((done) => setTimeout(done, 1000 * retryS)); // as a player does
            return globalThis.watch(url, token, more, tries - 1);
        }
        await peer.setRemoteDescription({ type: 'answer', sdp: answer });
        await element.play();
        globalThis.streams.push({ peer, element, place: new URL(reply.headers.get('Location'), url).href, token });
        return { status: 201, answer, type: reply.headers.get('Content-Type') };
    };
    globalThis.leave = async (url, token) => { // goes away before the answer
        const peer = new RTCPeerConnection(), away = new AbortController();
        peer.addTransceiver('video', { direction: 'recvonly' });
        await peer.setLocalDescription(await peer.createOffer());
        const reply = fetch(url, { method: 'POST', body: peer.localDescription.sdp, signal: away.signal,
            headers: { 'Content-Type': 'application/sdp', Authorization: `Bearer ${token}` } });
        setTimeout(() => away.abort(), 1000);
        await reply.then(() => { throw new Error('it was answered'); }, () => {});
        peer.close();
    };
    globalThis.streams = [];
    globalThis.look = (i) => {
        const { element, peer } = globalThis.streams[i], canvas = document.createElement('canvas');
        const { videoWidth: width, videoHeight: height } = element;
        if (!width)
            return { state: peer.connectionState };
        Object.assign(canvas, { width, height });
        const context = canvas.getContext('2d');
        context.drawImage(element, 0, 0);
        const row = context.getImageData(0, height - 3, width, 1).data;
        const bits = [...Array(BLOCKS).keys()].map((n) => (row[4 * Math.floor((n + 0.5) * width / BLOCKS)] > 127 ? 1 : 0));
        return { state: peer.connectionState, width, height,
            sound: bits[0] === 1 && bits[1] === 0 && bits.slice(0, -1).reduce((a, b) => a ^ b) === bits.at(-1),
            tenths: bits.slice(2, 2 + BITS).reduce((n, bit) => n * 2 + bit, 0), card: bits[2 + BITS] === 1 };
    };
    globalThis.frames = async (i) => [...(await globalThis.streams[i].peer.getStats()).values()]
        .find(({ type }) => type === 'inbound-rtp').framesDecoded;
    globalThis.end = async (i) => {
        const { peer, element, place, token } = globalThis.streams[i];
        const { status } = await fetch(place, { method: 'DELETE', headers: { Authorization: `Bearer ${token}` } });
        element.remove();
        peer.close();
        return status;
    };
};

const url = (path = '/whep') => `http://127.0.0.1:${port}${path}`;
const watch = (token = PASSWORD, more = [], from = page, tries = 5) =>
    from.evaluate((all) => globalThis.watch(...all), [url(), token, more, tries]);
const look = (i = 0) => page.evaluate((n) => globalThis.look(n), i);

async function until(i, what, timeoutMs = 30000) {
    for (const end = Date.now() + timeoutMs; ;) {
        const seen = await look(i);
        if (seen.sound && what(seen))
            return { ...seen, at: Date.now() };
        assert.ok(Date.now() < end, `${JSON.stringify(seen)}; ${video.said}`);
        await new Promise((done) => setTimeout(done, 20));
    }
}

async function metric(name) {
    // On a connection of its own: one that has long been idle may be closed just when it is used again.
    const headers = { Authorization: `Basic ${btoa(`wall:${PASSWORD}`)}`, Connection: 'close' };
    const text = await (await fetch(url('/metrics'), { headers })).text();
    return Number(text.match(new RegExp(`^${name.replace(/[{}]/g, '\\$&')} (\\S+)$`, 'm'))[1]);
}
const readers = () => metric('plantcast_video_readers{output="whep"}');

async function openWatcher() {
    const opened = await openPage(`http://127.0.0.1:${pages.address().port}/`, { viewport: { width: 480, height: 270 } });
    await opened.page.evaluate(watcher);
    return opened;
}

before(async () => {
    if (options.skip)
        return;
    plant = await TinyPlant.running();
    folder = mkdtempSync(join(tmpdir(), 'plantcast-whep-'));
    writeFileSync(join(folder, 'readers'), `wall:${PASSWORD}\n`);
    slow = join(folder, 'slow');
    port = await freePort();
    video = new Program('plantcast-video', [`http://127.0.0.1:${plant.port}/`, '--size', `${WIDTH}x${HEIGHT}`, '--fps', String(FPS),
        '--time-code', '--readers-file', join(folder, 'readers'), '--http', String(port), '--whep', '--most-readers', '12'],
    {}, ['env', `LD_PRELOAD=${SLOW}`, `SLOW_ANSWER=${slow}`, 'ASAN_OPTIONS=verify_asan_link_order=0']);
    await video.line(/^plantcast-video: ready$/m);
    pages = createServer((_, response) => response.end('<!doctype html><title>x</title>'));
    await new Promise((done) => pages.listen(0, '127.0.0.1', done));
    ({ page } = await openWatcher());
});
after(async () => {
    pages?.close();
    await video?.stop();
    await plant?.destroy();
    rmSync(folder ?? '', { recursive: true, force: true });
    assert.equal(video?.fault ?? null, null);
});

test('a browser watches: the picture of now, from a page of another server', options, async (t) => {
    const pace = new Pace();
    t.after(() => pace.stop());
    const begun = Date.now(), { status, answer, type } = await watch();
    assert.equal(status, 201, answer);
    assert.equal(type, 'application/sdp');
    assert.match(answer, /a=sendonly/);
    const { width, height } = await until(0, ({ card }) => !card);
    const first = Date.now() - begun;
    assert.deepEqual([width, height], [WIDTH, HEIGHT]);
    pace.hold(t, 'to the first picture', first, 8000);
    const lags = [];
    for (let i = 0; i < 40; i++) {
        const { tenths } = await look();
        lags.push(Date.now() - tenths * 100);
        await new Promise((done) => setTimeout(done, 50));
    }
    lags.sort((a, b) => a - b);
    pace.hold(t, 'from clock to the page', lags[20], 1000);
    console.log(`# ${first} ms to the first picture, ${lags[20]} ms from clock to page`);
    await shoot(page, 'whep');
});

test('ten more cost no further encode, and each gets all', options, async () => {
    for (let i = 1; i <= 10; i++)
        assert.equal((await watch(PASSWORD, i === 1 ? ['audio'] : [])).status, 201);
    for (let i = 1; i <= 10; i++)
        await until(i, ({ card }) => !card);
    assert.equal(await readers(), 11);
    const count = () => page.evaluate(() => Promise.all(globalThis.streams.map((_, i) => globalThis.frames(i))));
    const made = await metric('plantcast_video_frames_total'), had = await count(), begun = Date.now();
    await new Promise((done) => setTimeout(done, 5000));
    const passed = (Date.now() - begun) / 1000, got = (await count()).map((n, i) => n - had[i]);
    const encoded = await metric('plantcast_video_frames_total') - made;
    assert.ok(encoded < 1.2 * FPS * passed, `${encoded} frames encoded in ${passed} s`);
    assert.ok(got.every((n) => n > 0.6 * FPS * passed), `${got} in ${passed} s`);
    assert.equal((await watch()).status, 201); // the twelfth
    const { status, answer, retryS } = await watch(PASSWORD, [], page, 1);
    assert.deepEqual([status, answer, retryS], [503, 'too many are reading\n', 5]);
});

test('who has no token, or another one, sees nothing', options, async () => {
    const refused = await watch('wrong');
    assert.equal(refused.status, 401);
    assert.equal((await fetch(url(), { method: 'POST', body: 'v=0', headers: { 'Content-Type': 'application/sdp' } })).status, 401);
    assert.equal((await fetch(url('/whep/0123'), { method: 'DELETE' })).status, 401);
});

test('DELETE ends it, and whoever goes without a word is forgotten', options, async () => {
    const had = await readers();
    assert.equal(await page.evaluate(() => globalThis.end(0)), 200);
    assert.equal(await readers(), had - 1);
    const other = await openWatcher();
    assert.equal((await watch(PASSWORD, [], other.page)).status, 201);
    assert.equal(await readers(), had);
    await other.close();
    for (const end = Date.now() + 60000; await readers() !== had - 1;) {
        assert.ok(Date.now() < end, 'it still counts');
        await new Promise((done) => setTimeout(done, 500));
    }
    await until(1, ({ card }) => !card); // the others go on
});

// While an answer is held up: frames are encoded, and those who watch get them.
async function goOn() {
    const { tenths } = await until(1, ({ card }) => !card), encoded = await metric('plantcast_video_frames_total');
    await until(1, (seen) => seen.tenths > tenths + 10, 8000);
    assert.ok(await metric('plantcast_video_frames_total') > encoded);
}

test('a machine that is too busy to answer says so, and to come again', options, async () => {
    assert.equal(await page.evaluate(() => globalThis.end(2)), 200); // makes room for two
    const had = await readers();
    writeFileSync(slow, '');
    // Also to whoever asked, and before the answer is given up; those who watch go on meanwhile.
    await page.evaluate((all) => globalThis.leave(...all), [url(), PASSWORD]);
    await goOn();
    let waits = true;
    const refusal = watch(PASSWORD, [], page, 1).finally(() => { waits = false; });
    while (waits)
        await goOn();
    const { status, answer, retryS } = await refusal;
    assert.match(video.said, /no answer after \d+ s, this machine is busy/);
    assert.deepEqual([status, answer, retryS], [503, 'busy, offer it again\n', 5]);
    await goOn();
    rmSync(slow);
    for (const end = Date.now() + 60000; await readers() !== had;)
        assert.ok(Date.now() < end, 'it still counts');
    writeFileSync(slow, '');
    const late = watch();
    await new Promise((done) => setTimeout(done, 4000)); // longer than ways to get here are looked for
    rmSync(slow);
    assert.equal((await late).status, 201);
    const last = await page.evaluate(() => globalThis.streams.length - 1);
    await until(last, ({ card }) => !card);
    assert.equal(await page.evaluate((i) => globalThis.end(i), last), 200);
});

test('a server that is gone: the card within 3 s, and the picture comes back', options, async (t) => {
    const pace = new Pace();
    t.after(() => pace.stop());
    await until(1, ({ card }) => !card);
    const begun = Date.now();
    plant.daemon.child.kill('SIGSTOP');
    const { at } = await until(1, ({ card }) => card);
    pace.hold(t, 'to the card', at - begun, 3400);
    plant.daemon.child.kill('SIGCONT');
    await until(1, ({ card }) => !card);
});

// Sends a head and the beginning of a body, then a byte more every 50 ms if it drips. What came back until the server closed.
function say(lines, drips) {
    return new Promise((done) => {
        const socket = connect({ port, host: '127.0.0.1', allowHalfOpen: Boolean(drips) }); // who drips goes on after the server's end
        socket.write(`POST /whep HTTP/1.1\r\nHost: x\r\n${lines.join('\r\n')}\r\n\r\n`);
        const drip = drips && setInterval(() => socket.write('x'), 50);
        let text = '';
        socket.on('data', (bytes) => { text += bytes; });
        socket.on('error', () => {});
        socket.on('close', () => { clearInterval(drip); done(text); });
    });
}

test('an offer that is too large is refused before it was sent, and its connection ends', options, async () => {
    const type = 'Content-Type: application/sdp', huge = [type, 'Content-Length: 100000000000'];
    for (const [lines, drips] of [[huge], [[type, 'Transfer-Encoding: chunked']], [[...huge, 'Expect: 100-continue']], [huge, true]])
        assert.match(await say(lines, drips), /^HTTP\/1.1 413 .*at most 64 KiB, and says how many\n$/s);
    const reply = await fetch(url(), { method: 'POST', body: 'x'.repeat(8 << 20), headers: { 'Content-Type': 'application/sdp' } });
    assert.equal(reply.status, 413);
    assert.equal(reply.headers.get('Access-Control-Allow-Origin'), '*');
    await until(1, ({ card }) => !card);
});

test('bad offers are refused, each by what is wrong', options, async () => {
    const post = (body, type = 'application/sdp', path = '/whep') => fetch(url(path), { method: 'POST', body,
        headers: { 'Content-Type': type, Authorization: `Bearer ${PASSWORD}` } });
    const head = 'v=0\r\no=- 1 1 IN IP4 127.0.0.1\r\ns=-\r\nt=0 0\r\n';
    const vp8 = `${head}m=video 9 UDP/TLS/RTP/SAVPF 96\r\nc=IN IP4 0.0.0.0\r\na=rtpmap:96 VP8/90000\r\n`;
    const bare = `${head}m=video 9 UDP/TLS/RTP/SAVPF 96\r\nc=IN IP4 0.0.0.0\r\na=rtpmap:96 H264/90000\r\n` +
        'a=fmtp:96 packetization-mode=1;profile-level-id=42e01f\r\n';
    for (const [what, code] of [[['hello'], 400], [[''], 400], [[vp8], 400], [[bare], 400], [[head], 400], [['x'.repeat(70000)], 413],
        [[vp8, 'text/plain'], 415], [[vp8, 'application/sdp', '/whep/12'], 405], [['', 'application/sdp', '/whepper'], 404]]) {
        const reply = await post(...what);
        assert.equal(reply.status, code, await reply.text());
    }
    assert.equal((await fetch(url(), { headers: { Authorization: `Bearer ${PASSWORD}` } })).status, 405);
    const wrong = runProgram('plantcast-video', [`http://127.0.0.1:${plant.port}/`, '--whep'], 10000);
    assert.equal(wrong.code, 2);
    assert.match(wrong.err, /--whep is served by --http PORT/);
    await until(1, ({ card }) => !card);
});
