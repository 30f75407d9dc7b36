// SPDX-License-Identifier: GPL-3.0-or-later
// Many clients at once, well-behaved and misbehaving: measures what each costs the server and the other clients. SOAK_S sets
// the duration in seconds, such as 1800 for a long run.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { camera, median, metrics, Mover, openFiles, openMany, residentKb, sanitized, sleep } from './support/crowd.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { Relay, relayMissing } from './support/relay.mjs';
import { setUp } from './support/set_up.mjs';
import { seed, sweep } from './support/sweep.mjs';
import { missing, TinyPlant } from './support/tiny_plant.mjs';

const STALLED = 50, VIEWERS = 100, SOAK_S = Number(process.env.SOAK_S ?? sweep(20, 10));
const LIMITS = ['address-sessions=300', 'address-connections=400', 'address-messages=100000', 'least-fps=1'];
const absent = [...missing(), relayMissing()].filter(Boolean);
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : false;
let plant, pid, stalled, stalledAt;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    await plant.start(...LIMITS.flatMap((limit) => ['--limit', limit]));
    pid = plant.daemon.child.pid;
});

test('a hundred viewers of one view cost one render, one encode and a hundred sends', { skip }, async (t) => {
    const names = ['plantcast_renders_total', 'plantcast_encodes_total', 'plantcast_frames_sent_total'];
    const leader = await PlainClient.open(plant.port), { session } = await leader.hello({ width: 640, height: 360 });
    const viewers = await openMany(plant.port, VIEWERS - 1, {}, { width: 640, height: 360 });
    const all = [leader, ...viewers], steps = 6;
    t.after(() => all.forEach((client) => client.close()));
    for (const client of viewers)
        client.say({ type: 'follow', session });
    await Promise.all(all.map((c) => c.frameWhere('a refined frame', (f) => (f.flags & 2) !== 0)));
    const mover = new Mover(leader, 20);
    await sleep(4000); // the camera moves until the server sends the best quality to all clients, so that they can share pictures
    mover.stop();
    await sleep(500);
    const start = await metrics(plant.port, ...names);
    for (let seq = 1; seq <= steps; seq++) {
        leader.say(camera(seq, seq));
        await Promise.all(all.map((c) => c.frameWhere(`view ${seq}`, (f) => Math.abs(f.eye[1] - camera(seq, seq).eye[1]) < 1e-3)));
    }
    const end = await metrics(plant.port, ...names);
    const [renders, encodes, frames] = end.map((value, i) => value - start[i]);
    assert.ok(frames >= steps * VIEWERS, `only ${frames} frames arrived`);
    assert.ok(renders <= 2 * steps && encodes <= 2 * steps,
        `${renders} renders and ${encodes} encodes for ${frames} frames of ${steps} views`);
});

// Waits until the daemon's memory stops growing and returns it in kB. By then, caches that depend on the picture size are
// filled, so they are not counted as memory of a client.
async function standsStillKb() {
    let kb = residentKb(pid), same = 0;
    for (let i = 0; i < 40 && same < 4; i++) {
        await sleep(250);
        const now = residentKb(pid);
        same = Math.abs(now - kb) < 256 ? same + 1 : 0;
        kb = now;
    }
    return kb;
}

test('fifty clients that read nothing cost next to nothing', { skip }, async () => {
    const first = await PlainClient.open(plant.port);
    await first.hello({ width: 1280, height: 720 });
    await first.frameWhere('a refined frame', (f) => (f.flags & 2) !== 0);
    first.close();
    stalled = await openMany(plant.port, STALLED, { acknowledge: false }, (i) => ({
        width: 1280, height: 720, camera: camera(1, i),
    }));
    await Promise.all(stalled.map((c) => c.frameWhere('a frame', () => true)));
    const beforeKb = await standsStillKb();
    for (const client of stalled)
        client.socket.pause();
    stalledAt = performance.now();
    for (let seq = 2; seq < 40; seq++) {
        stalled.forEach((client, i) => client.say(camera(seq, i + seq / 10)));
        await sleep(50);
    }
    const moreKb = residentKb(pid) - beforeKb;
    console.log(`# ${STALLED} stalled clients: ${moreKb} kB more`);
    // kB of uncompressed pictures that the daemon may hold at the time of the measurement: two being drawn and one being
    // encoded
    const picturesKb = 3 * 1280 * 720 * 4 / 1024;
    assert.ok(sanitized || moreKb <= 5 * 1024 + picturesKb, `the daemon grew by ${moreKb} kB`);
});

test('over 1 Mbit/s and 200 ms, a picture is never more than a second old, and another client is not slowed', { skip }, async (t) => {
    const relay = await Relay.open(plant.port, { bytesPerS: 125000, delayMs: 100 });
    const fast = await PlainClient.open(plant.port);
    await fast.hello({ width: 1280, height: 720 });
    const mover = new Mover(fast), slow = await PlainClient.open(relay.port), late = [], rounds = [];
    await slow.hello({ width: 1280, height: 720, camera: camera(1, 0) });
    await slow.frameWhere('a frame', () => true);
    t.after(() => {
        mover.stop();
        for (const one of [fast, slow, relay])
            one.close();
    });
    // Measures the fast client's frame rate alone and next to the slow client, three times in turn. Subtracts the fast client's
    // largest delay from the slow one's, because delays that both have come from the busy machine and not from the slow link.
    for (let round = 0, frames = 0; round < 3; round++) {
        await sleep(500);
        const alone = await mover.rate(1000), slowMover = new Mover(slow, 30, frames), begin = performance.now();
        await sleep(1000);
        const beside = await mover.rate(1700), since = ({ at }) => at > begin + 1000, delay = mover.waits.filter(since);
        late.push(Math.max(...slowMover.waits.filter(since).map(({ ms }) => ms)) - Math.max(...delay.map(({ ms }) => ms)));
        slowMover.stop();
        frames = slowMover.seq;
        rounds.push({ alone, beside, frames: slowMover.frames });
    }
    const best = Math.max(...rounds.map(({ alone, beside }) => beside / alone)), said = JSON.stringify(rounds);
    console.log(`# fast and slow: ${said}; slow later by at most ${late.map(Math.round)} ms`);
    assert.ok(rounds.every(({ frames }) => frames > 3), said);
    assert.ok(sanitized || Math.min(...late) < 900, `pictures ${late.map(Math.round)} ms old`);
    assert.ok(best > 0.7, `frame rate beside a slow client: ${said}`);
});

test('a client that reads nothing for 15 s is disconnected, and its connection closed', { skip }, async () => {
    await sleep(Math.max(0, 19000 - (performance.now() - stalledAt)));
    const [open] = await metrics(plant.port, 'plantcast_sessions');
    assert.equal(open, 0);
    const [counted] = await metrics(plant.port, 'plantcast_sessions_stalled_total');
    assert.equal(counted, STALLED);
    for (const client of stalled)
        client.close();
});

// Until the time `end`, opens one client after another that acts at random: it drags the camera, hides its page, stops reading,
// or is cut off.
async function wander(port, random, end) {
    while (performance.now() < end) {
        const client = await PlainClient.open(port).catch(() => null);
        if (!client) {
            await sleep(100);
            continue;
        }
        client.hello({ width: 160 + 16 * Math.floor(random() * 40), height: 90 + 16 * Math.floor(random() * 20) }).catch(() => {});
        const begin = random() * 6;
        for (let seq = 1, left = 20 + random() * 60; left > 0 && !client.closed && performance.now() < end; left--) {
            if (random() < 0.7)
                client.say(camera(seq++, begin + seq / 40));
            if (random() < 0.02)
                client.say({ type: 'visible', visible: random() < 0.7 });
            if (random() < 0.02)
                client.socket.isPaused() ? client.socket.resume() : client.socket.pause();
            client.frames.length = client.texts.length = 0;
            await sleep(30);
        }
        client.close(); // the client is cut off at a random moment
    }
}

// Returns the files that the daemon has open, without those of the history, which may be at most MOST_OF_HISTORY. SQLite does not
// close the descriptor of a month file while another handle of the file is open, but reuses it later. So the number of these
// descriptors depends on how many handles were ever open at once, and it may still grow.
const MOST_OF_HISTORY = 10;
function openForClients() {
    const all = openFiles(pid), others = all.filter((name) => !name.includes('.history/'));
    assert.ok(all.length - others.length <= MOST_OF_HISTORY, all.join('\n'));
    return others;
}

test(`after ${SOAK_S} s of random connects, drags, stalls and cuts, no resource has grown`,
    { skip, timeout: (SOAK_S + 240) * 1000 }, async () => {
    console.log(`# PLANTCAST_SEED=${seed}`);
    let state = seed;
    const random = () => ((state = (state * 1103515245 + 12345) % 2147483648) / 2147483648);
    const filesBefore = openForClients(), begin = performance.now(), end = begin + SOAK_S * 1000;
    const steady = await PlainClient.open(plant.port);
    await steady.hello();
    const mover = new Mover(steady, 30);
    const wanderers = Array.from({ length: 6 }, () => wander(plant.port, random, end));
    const memory = [];
    for (let next = begin; next < end; next = performance.now()) {
        await sleep(Math.max(250, SOAK_S * 10));
        memory.push(residentKb(pid));
        steady.texts.length = 0;
    }
    await Promise.all(wanderers);
    mover.stop();
    steady.close();
    await sleep(1000);
    const third = SOAK_S * 1000 / 3, within = (list, from, to) => median(list
        .filter(({ at }) => at >= begin + from * third && at < begin + to * third).map(({ ms }) => ms));
    const [early, late] = [within(mover.waits, 1, 2), within(mover.waits, 2, 3)];
    const half = memory.length >> 1, grownKb = median(memory.slice(-4)) - median(memory.slice(half, half + 4));
    console.log(`# latency ${early.toFixed(1)}, then ${late.toFixed(1)} ms; memory ${grownKb} kB more in the second half`);
    console.log(`# MB: ${memory.map((kb) => (kb / 1024).toFixed(1)).join(' ')}`);
    assert.ok(late < 1.5 * early + 20, `latency grew from ${early.toFixed(1)} to ${late.toFixed(1)} ms`);
    assert.ok(sanitized || grownKb < 8 * 1024, `memory grew by ${grownKb} kB`);
    const patience = performance.now() + 180000;
    // the daemon may close files of the last clients some time after the clients have left
    for (; openForClients().length > filesBefore.length; await sleep(250))
        assert.ok(performance.now() < patience,
            `files are still open:\n${openForClients().join('\n')}\nbefore:\n${filesBefore.join('\n')}`);
    assert.equal(steady.closed.code, 1000);
});
