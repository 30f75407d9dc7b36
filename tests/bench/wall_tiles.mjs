// SPDX-License-Identifier: GPL-3.0-or-later
// The demo plant as one picture on 3 x 2 displays of 1920x1080 with a moving camera. Prints one JSON object per row: the number of pictures
// that all six tiles showed, processor time per picture, regularity, and quality.
// SECONDS: duration, 10 by default. REALTIME=1: daemon and clients get real-time priority (needs root; use a few SECONDS only).
import { spawnSync } from 'node:child_process';
import { setTimeout as sleep } from 'node:timers/promises';
import { PlainClient } from '../e2e/support/plain_client.mjs';
import { missing, startPlant } from '../e2e/support/plant.mjs';
import { cpuMs } from '../e2e/support/processes.mjs';

const [COLUMNS, ROWS, WIDTH, HEIGHT] = [3, 2, 1920, 1080], HZ = 30;
const SECONDS = Number(process.env.SECONDS) || 10, SETTLE_S = process.env.REALTIME ? 4 : 8;
const codec = process.argv[2] ?? 'h264', name = `wall_3x2_1080p_${codec}`;
const say = (what, value, unit, more = {}) => console.log(JSON.stringify({ name: `${name}_${what}`, value, unit, ...more }));
const why = missing();

async function measure(plant) {
    const port = Number(new URL(plant.url).port);
    const clients = await Promise.all(Array.from({ length: COLUMNS * ROWS }, async (_, i) => {
        const client = await PlainClient.open(port);
        await client.hello({ width: WIDTH, height: HEIGHT, codecs: [codec], tile: { wall: 'wall', display: i + 1 } });
        return client;
    }));
    const shown = (client) => client.texts.filter(({ type }) => type === 'present');
    const [leader] = clients;
    await leader.until('the first leads', () => leader.texts.some(({ type, leads }) => type === 'tiles' && leads));
    await leader.until('pictures', () => clients.every((client) => shown(client).length > 0));
    const runAs = (...policy) => process.env.REALTIME &&
        [plant.pid, process.pid].forEach((pid) => spawnSync('chrt', ['-a', ...policy, pid]));
    let seq = 0;
    runAs('-r', '-p', '1');
    const move = setInterval(() => {
        const turn = ++seq / HZ / 4; // angle of the camera around the plant in radians; it moves by one radian in 4 s
        const eye = [8 + 38 * Math.sin(turn), 6 - 38 * Math.cos(turn), 18];
        leader.say({ type: 'camera', seq, eye, target: [8, 6, 4], up: [0, 0, 1], fov: 40 });
    }, 1000 / HZ);
    await sleep(SETTLE_S * 1000); // until the quality has settled
    const last = shown(leader).at(-1).picture, begun = cpuMs(plant.pid);
    await sleep(SECONDS * 1000);
    const cpu = cpuMs(plant.pid) - begun;
    const pictures = shown(leader).filter(({ picture }) => picture > last);
    clearInterval(move);
    runAs('-o', '-p', '0');
    await sleep(1500);
    const apart = pictures.slice(1).map(({ at_us: us }, i) => (us - pictures[i].at_us) / 1000).sort((a, b) => a - b);
    const sizes = new Map();
    let uneven = 0, bytes = 0;
    for (const { picture, at_us: us } of pictures) {
        const all = clients.map((client) => shown(client).find((one) => one.picture === picture));
        const frames = all.map((one, i) => one && clients[i].frames.findLast((frame) => frame.seq === one.seq));
        const widths = new Set(frames.map((frame) => frame?.full_width));
        uneven += all.some((one) => one?.at_us !== us) || widths.size !== 1 || widths.has(undefined);
        bytes += frames.reduce((sum, frame) => sum + (frame?.payload_bytes ?? 0), 0);
        const width = frames[0]?.full_width;
        sizes.set(width, (sizes.get(width) ?? 0) + 1);
    }
    clients.forEach((client) => client.close());
    const count = pictures.length, at = (share) => Number(apart[Math.min(apart.length - 1, Math.floor(share * apart.length))]?.toFixed(0));
    const width = [...sizes].sort((a, b) => b[1] - a[1])[0]?.[0];
    say('pictures_per_s', Number((count / SECONDS).toFixed(1)), '1/s');
    say('cpu_ms', Number((cpu / count).toFixed(1)), 'ms of a processor');
    say('apart_ms', at(0.5), 'ms', { p95: at(0.95) });
    say('width_px', width, 'px');
    say('uneven', uneven, 'pictures', { goal: ['<=', 0] });
    say('mbit_per_s', Number((8e-6 * bytes / SECONDS).toFixed(1)), 'Mbit/s');
}

if (why) {
    say('pictures_per_s', null, '1/s', { why });
} else {
    const walls = `views: [{ id: whole, view: "group=temperature" }]
walls: [{ id: wall, tile: { columns: ${COLUMNS}, rows: ${ROWS}, bezel_mm: 8, views: whole } }]
`;
    const plant = await startPlant(walls);
    try {
        await measure(plant);
    } catch (error) {
        say('pictures_per_s', null, '1/s', { why: String(error.message ?? error).split('\n')[0] });
    } finally {
        await plant.stop();
    }
}
