// SPDX-License-Identifier: GPL-3.0-or-later
// Replays an hour of temperatures recorded on a rig through Modbus at 60 times the speed. The history must return each tag
// within its deviation; a spike, a gap and changes of quality exactly.
import assert from 'node:assert/strict';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { setUp } from '../e2e/support/set_up.mjs';
import { missing, TinyPlant } from '../e2e/support/tiny_plant.mjs';

const SERIES = resolve('../shared/data/sensors/hydraulic/hydraulic_ts_1hz.csv');
const absent = missing();
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : existsSync(SERIES) ? false : `${SERIES} is not there`;
// SPEED: recorded seconds per second; WALL_S: duration in s; WITHIN: deviation allowed for the history, in degrees; FAR_S:
// largest difference, in seconds of wall clock, between the time at which a register was read and its nominal time.
const SPEED = 60, WALL_S = 60, WITHIN = 0.2, FAR_S = 0.35;
const BACK_S = 4; // seconds until a device that answers again is polled again
const CODES = { Bad_CommunicationError: 0x80050000, Uncertain_NoCommunicationLastUsableValue: 0x408f0000, Bad_NoCommunication: 0x80310000 };
const TAGS = `Tag Name,Address,Data Type,Eng Units,Description,Group,Asset,X,Y,Z,Stale s,Deadband
TI-1,400001,Float,°C,left,temperature,E-101,0.5,0,0,1,${WITHIN}
TI-2,400003,Float,°C,right,temperature,E-101,-0.5,0,0,1,${WITHIN}
PI-1,400005,Float,bar,pump,pressure,P-101A,3,0,0.5,1,0.01
`;
const now = () => Date.now() / 1000;
let plant, started, spike, gap;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    writeFileSync(join(plant.folder, 'tags.csv'), TAGS);
    assert.equal(plant.prepare().code, 0);
    await plant.startSim('--values', SERIES, '--map', 'TI-1=TS1', '--map', 'TI-2=TS4', '--speed', String(SPEED));
    started = now();
    await plant.startDaemon();
    await plant.tell('set PI-1 3');
    await sleep(20000);
    spike = { from: now() };
    await plant.tell('set PI-1 9');
    await sleep(350);
    await plant.tell('set PI-1 3');
    spike.to = now();
    await sleep(5000);
    gap = { from: now() };
    await plant.tell('pause');
    await sleep(4000);
    gap.seen = now();
    const tags = (await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/tags`)).json()).tags;
    gap.quality = tags.find(({ name }) => name === 'TI-2').quality_name;
    await plant.tell('resume');
    gap.to = now();
    await sleep(Math.max(0, (started + WALL_S + 2 - now()) * 1000));
});

const history = async (tag, from, to) => {
    const query = new URLSearchParams({ tags: tag, from: from.toFixed(3), to: to.toFixed(3), points: 20000 });
    const [series] = (await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/history?${query}`)).json()).series;
    assert.equal(series.bucket_us, 0, 'points');
    return series.points.map(([us, value, quality]) => ({ t: us / 1e6, value, quality }));
};

// Returns the value at time t: interpolated between the points around t if they have the same quality, otherwise that of the
// point before; null if that has no good value.
function at(points, t) {
    const i = points.findLastIndex((point) => point.t <= t), a = points[i], b = points[i + 1];
    if (!a || a.value === null || a.quality !== 0)
        return null;
    return !b || b.value === null || b.quality !== a.quality ? a.value : a.value + (b.value - a.value) * (t - a.t) / (b.t - a.t);
}

function column(name) {
    const [head, ...rows] = readFileSync(SERIES, 'utf8').trim().split('\n').slice(0, WALL_S * SPEED + 600);
    const index = head.split(',').indexOf(name);
    return rows.map((row) => Number(row.split(',')[index]));
}

test('every tag is within its deviation of what was measured, for the whole hour', { skip }, async () => {
    for (const [tag, name] of [['TI-1', 'TS1'], ['TI-2', 'TS4']]) {
        const points = await history(tag, started, started + WALL_S), series = column(name);
        let compared = 0, worst = 0;
        for (let t = started + 3; t < started + WALL_S - 1; t += 1 / SPEED) {
            if (t > gap.from - FAR_S && t < gap.to + BACK_S)
                continue;
            const value = at(points, t), k = (t - started) * SPEED, reach = FAR_S * SPEED;
            const near = series.slice(Math.max(0, Math.floor(k - reach)), Math.ceil(k + reach));
            assert.notEqual(value, null, `${tag} has no value ${t - started} s after the start`);
            const off = Math.max(Math.min(...near) - value, value - Math.max(...near));
            worst = Math.max(worst, off);
            compared++;
        }
        assert.ok(compared > 2500, `${compared} of 3600 compared`);
        assert.ok(worst <= WITHIN, `${tag}: ${worst.toFixed(3)} off, ${WITHIN} at most`);
        assert.ok(points.length < compared / 2, `${points.length} points kept of ${compared} samples`);
    }
});

test('a spike of a third of a second is there, exactly', { skip }, async () => {
    const points = await history('PI-1', spike.from - 2, spike.to + 2);
    const top = points.filter(({ value }) => value > 5);
    assert.ok(top.length >= 1 && top.every(({ value }) => value === 9), JSON.stringify(points));
    assert.ok(top.every(({ t }) => t >= spike.from - 0.01 && t <= spike.to + FAR_S));
    assert.ok(points.some(({ t, value }) => t < top[0].t && value === 3) && points.some(({ t, value }) => t > top.at(-1).t && value === 3));
});

test('a gap is a gap, with the quality that it had', { skip }, async () => {
    for (const tag of ['TI-1', 'TI-2', 'PI-1']) {
        const points = await history(tag, gap.from - 2, gap.to + BACK_S + 1);
        const first = points.findIndex(({ t, quality }) => t >= gap.from && quality !== 0);
        const back = points.findIndex(({ t, quality }, i) => i > first && quality === 0);
        assert.ok(first >= 0 && points[first].t - gap.from < 2, JSON.stringify(points));
        assert.ok(points[back]?.t >= gap.to && points[back].t - gap.to < BACK_S, JSON.stringify(points.slice(first)));
        const seen = points.findLast(({ t }) => t <= gap.seen);
        assert.equal(seen.quality, CODES[gap.quality], `${gap.quality} then, 0x${seen.quality.toString(16)} in history`);
        assert.equal(at(points, gap.seen), null, 'no value is made up');
    }
});
