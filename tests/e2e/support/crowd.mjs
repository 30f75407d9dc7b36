// SPDX-License-Identifier: GPL-3.0-or-later
// Opens many clients at once, and measures the daemon's open files, memory and metrics, and the frames that a client gets.
import { readdirSync, readFileSync, readlinkSync } from 'node:fs';
import { setTimeout as sleep } from 'node:timers/promises';
import { get, PlainClient } from './plain_client.mjs';

export { sleep };
export const sanitized = /asan|tsan/.test(process.env.PLANTCAST_OUT ?? '');

export const residentKb = (pid) => Number(readFileSync(`/proc/${pid}/status`, 'utf8').match(/^VmRSS:\s+(\d+)/m)[1]);

// Returns the files that a process has open, from /proc.
export function openFiles(pid) {
    const folder = `/proc/${pid}/fd`, list = [];
    for (const fd of readdirSync(folder)) {
        try {
            list.push(readlinkSync(`${folder}/${fd}`));
        } catch { /* the file was closed meanwhile */ }
    }
    return list.sort();
}

export const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

// Returns the named counters and gauges from /metrics, summed over their labels.
export async function metrics(port, ...names) {
    const text = (await get(port, '/metrics')).body.toString();
    const values = (name) => [...text.matchAll(new RegExp(`^${name}(?:\\{[^}]*\\})? (\\d+)`, 'gm'))].map((m) => Number(m[1]));
    return names.map((name) => values(name).reduce((sum, value) => sum + value, 0));
}

export const camera = (seq, angle) => ({
    type: 'camera', seq, eye: [1.5 + 7 * Math.cos(angle), 7 * Math.sin(angle), 4], target: [1.5, 0, 0],
});

// Moves the client's camera `hz` times a second, from sequence number seq on, until stop(). `waits`: for each camera, the time
// and the delay until a frame of that camera arrived.
export class Mover {
    constructor(client, hz = 60, seq = 0) {
        Object.assign(this, { client, seq, shown: seq, frames: 0, sent: new Map(), waits: [] });
        this.timer = setInterval(() => this.tick(), 1000 / hz);
    }

    tick() {
        this.sent.set(++this.seq, performance.now());
        this.client.say(camera(this.seq, this.seq / 60));
        for (const frame of this.client.frames.splice(0))
            this.show(frame);
    }

    show(frame) {
        this.frames++;
        for (; this.shown < frame.camera_seq; this.shown++) {
            this.waits.push({ at: frame.at, ms: frame.at - this.sent.get(this.shown + 1) });
            this.sent.delete(this.shown + 1);
        }
    }

    // Returns how many pictures arrive per second, measured for `ms` milliseconds.
    async rate(ms) {
        const before = this.frames, start = performance.now();
        await sleep(ms);
        return ((this.frames - before) * 1000) / (performance.now() - start);
    }

    stop() {
        clearInterval(this.timer);
    }
}

export async function openMany(port, count, options, hello) {
    const clients = await Promise.all(Array.from({ length: count }, () => PlainClient.open(port, options)));
    await Promise.all(clients.map((client, i) => client.hello(typeof hello === 'function' ? hello(i) : hello)));
    return clients;
}
