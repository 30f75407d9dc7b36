// SPDX-License-Identifier: GPL-3.0-or-later
// A day of a plant in one hour: temperatures recorded on a test rig are played 24 times as fast, and twenty users move their
// cameras. Meanwhile the plant file is changed and reloaded, devices stop answering, a tag is refused, a disk fills up, the
// clock is set forward and back by an hour, and a month ends. MINUTES sets the duration. Prints memory, descriptors, threads
// and latency, and their growth. Requires that the field equals a fresh computation to the last bit, that history has no gaps,
// and that descriptors and threads do not grow.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { appendFileSync, existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { isDeepStrictEqual } from 'node:util';
import { missingClocks, SetClock } from '../e2e/support/clocks.mjs';
import { get } from '../e2e/support/plain_client.mjs';
import { setUp } from '../e2e/support/set_up.mjs';
import { BIN, missing, runProgram, TinyPlant } from '../e2e/support/tiny_plant.mjs';

const SERIES = resolve('../shared/data/sensors/hydraulic/hydraulic_ts_1hz.csv'), MINUTES = Number(process.env.MINUTES ?? 60);
const absent = missing();
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}`
    : missingClocks() ?? (existsSync(SERIES) ? false : `${SERIES} is not there`);
const SESSIONS = 20, PROBE_S = 15, GROWTH = 1.1, WAIT_MS = 120000, BEFORE_END_S = 30, MONTH_DESCRIPTORS = 4;
const pid = () => plant.daemon.child.pid;
let plant, clock, marked = 0;
const marks = [];

async function until(what, ask) {
    for (const end = Date.now() + WAIT_MS; ; await sleep(200)) {
        const found = await ask();
        if (found)
            return found;
        assert.ok(Date.now() < end, `not within ${WAIT_MS / 1000} s: ${what}`);
    }
}
const tags = async () => new Map(JSON.parse((await get(plant.port, '/api/v1/tags')).body).tags.map((tag) => [tag.name, tag]));
const hold = async (tag, value) => {
    await plant.tell(`set ${tag} ${value}`);
    await until(`${tag} is ${value}`, async () => {
        const now = (await tags()).get(tag);
        return Math.fround(now.value) === Math.fround(value) && now.quality_name.startsWith('Good');
    });
};

// Gives PI-1 a unique value that history must contain exactly. The value lies above or below all other readings of PI-1,
// because history stores no points that lie on the line between two others.
const mark = async () => {
    const n = marked++, value = (n % 2 ? -2.375 : 12.375) + n / 1024;
    const from_s = Math.floor(clock.now() / 1000) - 1;
    await hold('PI-1', value);
    marks.push({ value, from_s, to_s: Math.ceil(clock.now() / 1000) + 1 });
};

function measure() {
    const status = readFileSync(`/proc/${pid()}/status`, 'utf8');
    const of = (key) => Number(status.match(new RegExp(`^${key}:\\s+(\\d+)`, 'm'))[1]);
    return { memory_mb: of('VmRSS') / 1024, threads: of('Threads'), descriptors: readdirSync(`/proc/${pid()}/fd`).length };
}

// Runs `plantcast probe` with twenty clients that move their cameras. Resolves with its report when it ends.
const crowd = () => new Promise((done, fail) => {
    const child = spawn(join(BIN, 'plantcast'), ['probe', `http://127.0.0.1:${plant.port}/`, '--sessions', String(SESSIONS), '--seconds',
        String(PROBE_S), '--motion', 'random', '--size', '320x180', '--blind', '--json'], { stdio: ['ignore', 'pipe', 'inherit'] });
    let out = '';
    child.stdout.on('data', (chunk) => { out += chunk; });
    child.on('error', fail);
    child.on('exit', () => done(JSON.parse(out)));
});

// Events at the plant while clients watch: each round calls one of these functions.
const events = [
    async function reload() {
        const text = readFileSync(plant.file, 'utf8'), turn = /description: warm/.test(text);
        const [was, is] = turn ? ['warm', 'cold'] : ['cold', 'warm'];
        writeFileSync(plant.file, text.replace(`description: ${was}`, `description: ${is}`));
        const answer = await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/reload`, { method: 'POST' })).json();
        assert.ok(answer.reloaded, JSON.stringify(answer));
    },
    async function lost() {
        await plant.tell('pause');
        await until('readings are Bad', async () => (await tags()).get('TI-2').quality_name.startsWith('Bad'));
        await plant.tell('resume');
        await until('readings are Good', async () => (await tags()).get('TI-2').quality_name.startsWith('Good'));
    },
    async function refused() {
        await plant.tell('fail TI-2');
        await until('TI-2 is not Good', async () => !(await tags()).get('TI-2').quality_name.startsWith('Good'));
        await plant.tell('release TI-2');
    },
    async function full() {
        const limit = (bytes) => spawnSync('prlimit', ['--pid', String(pid()), `--fsize=${bytes}`]).status;
        assert.equal(limit('1:unlimited'), 0);
        await sleep(5000);
        assert.equal(limit('unlimited:unlimited'), 0);
    },
    async function clockSet() {
        for (const by_s of [3600, -3600]) {
            clock.set(clock.ahead_s + by_s);
            await mark();
        }
    },
    async function monthEnd() {
        const now = new Date(clock.now()), end = Date.UTC(now.getUTCFullYear(), now.getUTCMonth() + 1);
        clock.set(clock.ahead_s + Math.floor((end - now) / 1000) - BEFORE_END_S);
        await mark();
        assert.ok(clock.now() < end, 'the month has not ended yet');
        await sleep(end - clock.now() + 500);
        await mark();
        const file = `history-${new Date(clock.now()).toISOString().slice(0, 7)}.sqlite`;
        await until(file, () => existsSync(join(plant.folder, 'plant.history', file)));
    },
];

// Compares the daemon's field after all these events, at points on both boxes, with the field that a newly started program
// computes from the current readings. Repeats if the two used different readings or qualities, as when the device answers late
// on a busy machine.
async function drift(round) {
    for (const [i, tag] of ['TI-1', 'TI-2', 'PI-1'].entries())
        await hold(tag, [20 + round % 50, 70 - round % 50, round % 10][i]);
    const now = await tags(), values = join(plant.folder, 'values.csv'), view = ['--size', '320x180', '--fit', 'E-101', '--side', 'iso'];
    writeFileSync(values, ['TI-1', 'TI-2', 'PI-1'].map((name) => `${name},${now.get(name).value}`).join('\n'));
    let worst = 0, compared = 0;
    for (const at of ['150,80', '160,90', '170,100', '140,100']) {
        const [live, fresh] = await until(`the readings at ${at} are those that were set`, () => {
            const picks = [[`http://127.0.0.1:${plant.port}/`], [plant.file, '--values', values]].map((from) =>
                JSON.parse(runProgram('plantcast', ['snapshot', ...from, ...view, '--pick', at], WAIT_MS).out));
            const same = isDeepStrictEqual(picks[0].nearest, picks[1].nearest);
            return same && picks.map(({ value }) => value);
        });
        if (typeof live !== 'number' && typeof fresh !== 'number')
            continue;
        worst = Math.max(worst, Math.abs(live - fresh));
        compared++;
    }
    assert.ok(compared > 0, 'something is compared');
    for (const tag of ['TI-1', 'TI-2'])
        await plant.tell(`release ${tag}`);
    return worst;
}

// Returns by how much row[key] grows per hour: the slope of a least-squares line.
function slope(rows, key) {
    const n = rows.length, mean = (of) => rows.reduce((sum, row) => sum + of(row), 0) / n;
    const t = mean((row) => row.hours), y = mean((row) => row[key]);
    return mean((row) => (row.hours - t) * (row[key] - y)) / mean((row) => (row.hours - t) ** 2);
}

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    appendFileSync(plant.file, 'history: { keep_days: 36500 }\n');
    clock = new SetClock(join(plant.folder, 'clock'));
    plant.confine(...clock.starter());
    assert.equal(plant.prepare().code, 0);
    await plant.startSim('--values', SERIES, '--map', 'TI-1=TS1', '--map', 'TI-2=TS4', '--speed', '24', '--loop');
    await plant.startDaemon();
});

test(`a day's life in ${MINUTES} minutes`, { skip, timeout: (MINUTES + 20) * 60000 }, async () => {
    const began = Date.now(), rows = [];
    for (let round = 0; round === 0 || Date.now() - began < MINUTES * 60000; round++) {
        const event = events[round % events.length], looking = crowd();
        await event();
        const { input_to_frame_ms: waited } = await looking;
        assert.ok(waited, `${event.name}: no frame showed a camera that was sent, for ${PROBE_S} s`);
        const off = await drift(round);
        await mark();
        rows.push({ hours: (Date.now() - began) / 3.6e6, ...measure(), p95_ms: waited.p95, off });
        console.log(`# ${event.name}: ${JSON.stringify(rows.at(-1))}`);
        assert.equal(off, 0, 'the field is that of a fresh computation');
    }
    for (const key of ['memory_mb', 'descriptors', 'threads', 'p95_ms'])
        console.log(`# ${key}: ${rows[0][key].toFixed(1)} at first, ${rows.at(-1)[key].toFixed(1)} at last, ` +
            `${slope(rows, key).toFixed(2)} an hour`);
    // Compares the median of the first third of the samples with that of the last third, because single samples vary:
    // descriptors of closing connections exist for a moment, and the end of a month releases memory. Each month that begins may
    // add MONTH_DESCRIPTORS for its file.
    const third = Math.ceil(rows.length / 3), median = (part, key) => part.map((row) => row[key]).sort((a, b) => a - b)[third >> 1];
    for (const [key, growth, more] of [['descriptors', 1, MONTH_DESCRIPTORS], ['threads', 1, 0], ['memory_mb', GROWTH, 0]]) {
        const early = median(rows.slice(0, third), key), late = median(rows.slice(-third), key);
        console.log(`# ${key}: median ${early.toFixed(1)} in the first third, ${late.toFixed(1)} in the last`);
        assert.ok(late <= growth * early + more, `${key}: ${early} in the first third, ${late} in the last`);
    }
    for (const { value, from_s, to_s } of marks)
        await until(`history has ${value} between ${from_s} and ${to_s}`, () => runProgram('plantcast', ['history', 'export', plant.file,
            '--tags', 'PI-1', '--from', String(from_s), '--to', String(to_s)], WAIT_MS).out.split('\n')
            .some((line) => Math.fround(line.split(',')[2]) === Math.fround(value)));
    console.log(`# history: ${marks.length} of ${marks.length} marks`);
});
