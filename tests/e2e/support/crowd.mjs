// SPDX-License-Identifier: GPL-3.0-or-later
// Clients by the dozen, and what they cost the daemon.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync, readlinkSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { get, PlainClient } from './plain_client.mjs';

export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
export const sanitized = /asan|tsan/.test(process.env.PLANTCAST_OUT ?? '');

export const residentKb = (pid) => Number(readFileSync(`/proc/${pid}/status`, 'utf8').match(/^VmRSS:\s+(\d+)/m)[1]);

// What a process has open, as /proc says it.
export function openFiles(pid) {
    const folder = `/proc/${pid}/fd`, list = [];
    for (const fd of readdirSync(folder)) {
        try {
            list.push(readlinkSync(`${folder}/${fd}`));
        } catch { /* closed meanwhile */ }
    }
    return list.sort();
}

export const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

// The counters and gauges of /metrics whose names are asked for; labels are added up.
export async function metrics(port, ...names) {
    const text = (await get(port, '/metrics')).body.toString();
    const values = (name) => [...text.matchAll(new RegExp(`^${name}(?:\\{[^}]*\\})? (\\d+)`, 'gm'))].map((m) => Number(m[1]));
    return names.map((name) => values(name).reduce((sum, value) => sum + value, 0));
}

export const camera = (seq, angle) => ({
    type: 'camera', seq, eye: [1.5 + 7 * Math.cos(angle), 7 * Math.sin(angle), 4], target: [1.5, 0, 0],
});

// Moves its camera at that rate until stop(), from a number of the client's on; how long each was waited for is in `waits`, by the time of
// its showing.
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

    // Pictures in a second, over that time.
    async rate(ms) {
        const before = this.frames, start = performance.now();
        await sleep(ms);
        return ((this.frames - before) * 1000) / (performance.now() - start);
    }

    stop() {
        clearInterval(this.timer);
    }
}

// What a processor is to be had for, time and again: how long the same piece of work takes, by the time of its end, and how many threads
// want one just then. To judge times of the daemon by, which other programs delay as much.
export class Pace {
    constructor() {
        this.times = [];
        this.timer = setInterval(() => this.work(), 100);
    }

    work() {
        const begin = performance.now();
        for (let i = 0, x = 1; i < 1e6; i++)
            x = Math.imul(x, 1664525) + 1013904223;
        const wanting = Number(readFileSync('/proc/loadavg', 'utf8').match(/ (\d+)\//)[1]);
        this.times.push({ at: performance.now(), ms: performance.now() - begin, wanting });
    }

    stop() {
        clearInterval(this.timer);
    }

    // Why times of the daemon mean nothing, or null: others take too much of the machine. Where they do so all the time, no piece of work
    // is done sooner than another.
    get busy() {
        const times = this.times.map(({ ms }) => ms), typical = median(times), least = Math.min(...times);
        const wanting = median(this.times.map((one) => one.wanting)), processors = availableParallelism();
        if (wanting > 2 * processors)
            return `the machine is busy: ${wanting} threads want its ${processors} processors`;
        return typical < 1.5 * least ? null : `the machine is busy: ${least.toFixed(1)} ms of work took ${typical.toFixed(1)} ms`;
    }

    // That it took less than mostMs; where others take so much of the machine that this means nothing, t is a skip instead.
    hold(t, what, ms, mostMs) {
        if (ms >= mostMs && this.busy)
            t.skip(`${what}: ${ms} ms; ${this.busy}`);
        else
            assert.ok(ms < mostMs, `${what}: ${ms} ms`);
    }
}

export async function openMany(port, count, options, hello) {
    const clients = await Promise.all(Array.from({ length: count }, () => PlainClient.open(port, options)));
    await Promise.all(clients.map((client, i) => client.hello(typeof hello === 'function' ? hello(i) : hello)));
    return clients;
}
