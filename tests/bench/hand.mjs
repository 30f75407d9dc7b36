// SPDX-License-Identifier: GPL-3.0-or-later
// Measures how soon the page reacts to the user's hand: sends real pointer events to a browser that shows the demo plant over
// a simulated slow link. Prints one JSON object per measured quantity. Arguments: WIDTHxHEIGHT, CODEC (auto), ROUND_TRIP_MS
// (0), BYTES_PER_S of the link (0: no limit). Without arguments, measures each link of LINKS in turn and prints a table that
// compares the results with their goals. --browser: chromium, firefox or webkit. --throttle: factor by which Chromium slows the
// page's main thread down, like a phone. --ratio: device pixels per CSS pixel. --motion: what the hand does: orbit, pan or zoom
// (pan and zoom only in Chromium).
import { loadavg } from 'node:os';
import { setTimeout as sleep } from 'node:timers/promises';
import { parseArgs } from 'node:util';
import { drive, missingBrowser } from '../e2e/support/drivers.mjs';
import { missing, startPlant } from '../e2e/support/plant.mjs';
import { cpuMs, family } from '../e2e/support/processes.mjs';
import { Relay, relayMissing } from '../e2e/support/relay.mjs';

const { values: OPTIONS, positionals: GIVEN } = parseArgs({ allowPositionals: true, options: {
    browser: { type: 'string', default: 'chromium' }, throttle: { type: 'string', default: '1' },
    ratio: { type: 'string', default: '1' }, motion: { type: 'string', default: 'orbit' } } });
// Links and their goals: size, codec, round trip in ms, bytes per second (0: no limit); largest time from a pointer event to
// the first changed pixel (95th percentile, ms), and smallest number of picture updates per second while dragging.
const LINKS = [['1280x720', 'jpeg', 0, 0, 34, 55], ['1280x720', 'jpeg', 50, 0, 34, 55], ['1280x720', 'jpeg', 200, 0, 34, 55],
    ['1280x720', 'jpeg', 300, 0, 34, 55], ['1280x720', 'jpeg', 0, 125000, 34, 55], ['1920x1080', 'jpeg', 0, 0, 34, 30],
    ['1920x1080', 'jpeg', 200, 0, 34, 30]];
const BROWSER_MS = 25; // goal: largest processor time (ms) that the browser may use per picture update
let width, height, name, results; // data of the link being measured: size of the picture in pixels, name in the printed rows, results
if (!['orbit', 'pan', 'zoom'].includes(OPTIONS.motion) || (OPTIONS.motion !== 'orbit' && OPTIONS.browser !== 'chromium'))
    throw new Error(`--motion ${OPTIONS.motion}: write orbit, or in Chromium pan or zoom`);
const isZoom = OPTIONS.motion === 'zoom', BUTTON = OPTIONS.motion === 'pan' ? 'right' : 'left'; // the right button pans
const SECONDS = Number(process.env.SECONDS) || 5, TRIES = Number(process.env.TRIES) || 20, HZ = 60, CALM_MS = 400;
function say(what, value, unit, more = {}) {
    console.log(JSON.stringify({ name: `${name}_${what}`, value, unit, ...more }));
    results[what] = more.p95 ?? value;
}
const round = (x) => Math.round(10 * x) / 10;
const rank = (values, share) => round([...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(share * values.length))]);

// Runs in the page: records when pointer events happened, when the picture on the screen changed, and which frames of the
// server were drawn. While hand.reads, counts animation frames.
function record() {
    const hand = globalThis.hand = { events: [], changes: [], frames: [], reads: false, count: 0 };
    const { session, viewport } = globalThis.plantcast, { drawn } = session, { onDrawn } = viewport, small = new OffscreenCanvas(160, 90);
    const context = small.getContext('2d', { willReadFrequently: true });
    const count = () => {
        hand.count++;
        if (hand.reads)
            requestAnimationFrame(count);
    };
    hand.start = () => requestAnimationFrame(count);
    for (const type of ['pointermove', 'wheel'])
        addEventListener(type, ({ timeStamp: at }) => hand.events.push({ at, count: hand.count }), { capture: true, passive: true });
    session.drawn = (frame, ...rest) => {
        drawn.call(session, frame, ...rest);
        hand.frames.push({ at: performance.now(), last: frame.cameraSeq === session.cameraSeq && !session.cameraNews });
    };
    context.imageSmoothingEnabled = false;
    let before = 0;
    viewport.onDrawn = (...news) => {
        onDrawn(...news);
        if (!hand.reads || (viewport.warp?.isShown && !news[1]))
            return; // nothing was drawn
        context.drawImage(viewport.warp?.isShown ? viewport.warp.canvas : viewport.canvas, 0, 0, small.width, small.height);
        const pixels = new Uint32Array(context.getImageData(0, 0, small.width, small.height).data.buffer);
        const hash = pixels.reduce((sum, pixel) => (Math.imul(sum, 31) + pixel) | 0, 0);
        if (hash !== before)
            hand.changes.push({ at: performance.now(), count: hand.count });
        before = hash;
    };
}

const look = (page) => page.evaluate(() => {
    const { events, changes, frames } = globalThis.hand;
    const { picture, size: { width: w }, cameraSeq } = globalThis.plantcast.session;
    return { events, changes, frames, rests: picture.still && picture.fullWidth === w && picture.cameraSeq === cameraSeq };
});
const clear = (page, reads) => page.evaluate((on) => {
    if (on && !globalThis.hand.reads)
        globalThis.hand.start();
    Object.assign(globalThis.hand, { events: [], changes: [], frames: [], reads: on });
}, reads);

async function rest(page) {
    for (let before = -1, now = 0; now !== before || now < 0;) {
        before = now;
        await sleep(CALM_MS);
        const { changes, rests } = await look(page);
        now = rests ? changes.length : -1;
    }
}

// Moves the mouse, with its button pressed, in a circle for that many seconds, without waiting for the page. To zoom, turns the
// wheel to and fro instead.
async function circle(page, seconds) {
    const began = performance.now(), count = seconds * HZ, reach = Math.min(150, width / 3);
    for (let n = 1, last; n <= count; n++) {
        const angle = 2 * Math.PI * n / (3 * HZ);
        last = isZoom ? page.wheel(width / 2, height / 2, 10 * Math.cos(angle))
            : page.pointer('mouseMoved', width / 2 + reach * Math.sin(angle), height / 2 + 100 * (1 - Math.cos(angle)) / 2, BUTTON);
        await sleep(Math.max(0, began + n * 1000 / HZ - performance.now()));
        if (n === count)
            await last;
    }
}

const cpuOf = (pids) => pids.reduce((sum, pid) => {
    try {
        return sum + cpuMs(pid);
    } catch {
        return sum; // the process has ended
    }
}, 0);

async function measure(page, daemonPid) {
    await page.evaluate(record);
    await page.pointer('mouseMoved', width / 2, height / 2);
    await clear(page, true);
    if (!isZoom)
        await page.pointer('mousePressed', width / 2, height / 2, BUTTON);
    await circle(page, 2); // unmeasured drag, so that the page has loaded everything that it loads lazily at the first drag
    const how = await page.evaluate(() => globalThis.plantcast.viewport.warp?.painter.constructor.name ?? null);
    const firsts = [], counts = [];
    for (let n = 0; n < TRIES; n++) {
        await rest(page);
        await clear(page, true);
        await (isZoom ? page.wheel(width / 2, height / 2, n % 2 ? 60 : -60)
            : page.pointer('mouseMoved', width / 2 + 20 * (1 + n % 2), height / 2 + n, BUTTON));
        await page.wait(() => globalThis.hand.changes.some(({ at }) => at > globalThis.hand.events[0].at));
        const { events: [event], changes } = await look(page), change = changes.find(({ at }) => at > event.at);
        firsts.push(change.at - event.at);
        counts.push(change.count - event.count);
    }
    say('first_pixel_ms', rank(firsts, 0.5), 'ms', { p95: rank(firsts, 0.95) });
    say('first_pixel_frames', rank(counts, 0.5), 'animation frames', { p95: rank(counts, 0.95), painter: how, load: round(loadavg()[0]) });
    await clear(page, true);
    await circle(page, SECONDS);
    const seen = await look(page);
    say('seen_per_s', round(seen.changes.length / SECONDS), '1/s');
    say('pictures_per_s_read', round(seen.frames.length / SECONDS), '1/s');
    await page.wait(() => globalThis.hand.frames.some(({ last, at }) => last && at > globalThis.hand.events.at(-1).at));
    const { frames, events } = await look(page);
    const end = events.at(-1).at;
    say('last_picture_ms', round(frames.find(({ last, at }) => last && at > end).at - end), 'ms');
    await clear(page, false);
    const pids = family(page.pid), begun = cpuOf(pids), served = cpuMs(daemonPid), from = performance.now();
    const updates = () => page.evaluate(() => globalThis.plantcast.viewport.warp?.updates ?? globalThis.hand.frames.length);
    const before = await updates();
    await circle(page, SECONDS);
    const pictures = (await look(page)).frames.length, drawn = await updates() - before, seconds = (performance.now() - from) / 1000;
    const cpu = cpuOf(pids) - begun;
    say('pictures_per_s', round(pictures / seconds), '1/s');
    say('updates_per_s', round(drawn / seconds), '1/s');
    say('cpu_per_picture_ms', round(cpu / pictures), 'ms of a processor');
    say('cpu_per_update_ms', round(cpu / drawn), 'ms of a processor');
    say('cores', round(cpu / seconds / 100) / 10, 'cores', { server: round((cpuMs(daemonPid) - served) / seconds / 100) / 10 });
    if (!isZoom)
        await page.pointer('mouseReleased', width / 2, height / 2, BUTTON);
    if (process.env.SHOT)
        await page.shoot(process.env.SHOT);
}

async function run(size, codec = 'auto', roundTripMs = 0, bytesPerS = 0) {
    const motion = OPTIONS.motion === 'orbit' ? '' : `_${OPTIONS.motion}`, limit = Number(bytesPerS) === 0 ? '' : `_${bytesPerS}Bps`;
    name = `hand_${OPTIONS.browser}${motion}_${size}_${codec}_${roundTripMs}ms${limit}`;
    results = {};
    [width, height] = size.split('x').map(Number);
    const why = missing() ?? relayMissing() ?? missingBrowser(OPTIONS.browser);
    if (why) {
        say('seen_per_s', null, '1/s', { why });
        return;
    }
    const plant = await startPlant();
    const port = Number(new URL(plant.url).port);
    const relay = await Relay.open(port, { bytesPerS: Number(bytesPerS), delayMs: Number(roundTripMs) / 2 });
    const page = await drive(OPTIONS.browser, width + 300, height + 200, Number(OPTIONS.ratio));
    try {
        await page.goto(`http://127.0.0.1:${Number(roundTripMs) + Number(bytesPerS) === 0 ? port : relay.port}/?codec=${codec}`);
        await page.wait(() => Boolean(globalThis.plantcast?.session.picture));
        // sets the picture's size in CSS pixels to the measured size; the window is larger than the picture
        await page.evaluate(([w, h]) => Object.assign(document.getElementById('viewport').style,
            { position: 'fixed', inset: '0 auto auto 0', width: `${w}px`, height: `${h}px`, zIndex: 9 }), [width, height]);
        await plant.freeze((await (await fetch(`${plant.url}api/v1/tags`)).json()).tags.map((tag) => tag.name));
        if (OPTIONS.throttle !== '1')
            await page.throttle(Number(OPTIONS.throttle));
        await measure(page, plant.pid);
    } finally {
        await page.close();
        relay.close();
        await plant.stop();
    }
}

if (GIVEN.length > 0) {
    await run(...GIVEN);
} else {
    const rows = [], met = (value, isMet) => `${value ?? '–'} ${isMet ? '(met)' : '(not met)'}`;
    for (const [size, codec, roundTripMs, bytesPerS, pixelMs, rate] of LINKS) {
        await run(size, codec, roundTripMs, bytesPerS);
        const { first_pixel_ms: first, updates_per_s: updates, cpu_per_update_ms: cpu, pictures_per_s: pictures } = results;
        rows.push([`${size}, ${roundTripMs} ms${bytesPerS ? `, ${bytesPerS * 8 / 1e6} Mbit/s` : ''}`, met(first, first <= pixelMs),
            met(updates, updates >= rate), met(cpu, cpu <= BROWSER_MS), pictures ?? '–']);
    }
    console.log(['', '| picture, round trip | pointer to first changed pixel, p95, ms (34) | updates/s (720p: 55, 1080p: 30) |' +
        ` processor time of an update, ms (${BROWSER_MS}) | server pictures/s |`, '|---|---|---|---|---|',
    ...rows.map((cells) => `| ${cells.join(' | ')} |`)].join('\n'));
}
