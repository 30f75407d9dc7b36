// SPDX-License-Identifier: GPL-3.0-or-later
// A whole host for hours: two cores, PostgreSQL, two renderers, HAProxy, Prometheus, operators, the load generator, and one
// fault per minute. Requires that no alarm and no acknowledgement is lost or recorded twice, that two cores never poll at once,
// that operators are blind for at most 10 s per fault, that memory and descriptors do not grow, and that alerts fire and clear.
// MINUTES: duration. SEED: order of the faults. FAULT_S: seconds from one fault to the next. ONLY: names of faults, separated
// by commas. build/soak-host.txt has the table after each fault.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { loadavg } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { missingClocks } from '../e2e/support/clocks.mjs';
import { missingHaproxy } from '../e2e/support/haproxy.mjs';
import { missingTwoCores, sleep, until } from '../e2e/support/two_cores.mjs';
import { FAULTS, supervise } from './host/faults.mjs';
import { Site } from './host/site.mjs';

const MINUTES = Number(process.env.MINUTES ?? 120), SEED = Number(process.env.SEED ?? Date.now() % 1e6);
const FAULT_MS = Number(process.env.FAULT_S ?? 60) * 1000, ONLY = process.env.ONLY?.split(',');
const BLIND_MS = 10000, CLEARED_S = 60, GROWTH = 1.15, GROWTH_MB = 8, MORE_DESCRIPTORS = 6, MORE_THREADS = 2;
const NODES = 4, NEVER = ['PlantcastTwoLeaders'];
const skip = missingTwoCores() || (missingHaproxy() ?? missingClocks()
    ?? (spawnSync('prometheus', ['--version']).status === 0 ? false : 'prometheus is not installed'));

// mulberry32
function randomOf(seed) {
    let state = seed >>> 0;
    return () => {
        state = (state + 0x6D2B79F5) >>> 0;
        let t = Math.imul(state ^ (state >>> 15), state | 1);
        t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
        return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
    };
}
function shuffled(list, random) {
    const out = [...list];
    for (let i = out.length - 1; i > 0; i--) {
        const k = Math.floor(random() * (i + 1));
        [out[i], out[k]] = [out[k], out[i]];
    }
    return out;
}

// Causes one fault and records its consequences. ends: receives the names of nodes that ended unexpectedly.
async function oneFault(site, fault, random, ends) {
    const { cycles, alerts } = site, row = { fault: fault.name, load: loadavg()[0], failures: [] };
    const firing = (names) => names.filter((name) => alerts.firing.has(name));
    await until('clear alerts', () => firing(fault.alerts).length === 0, CLEARED_S)
        .catch(() => row.failures.push(`alerts already fire: ${firing(fault.alerts)}`));
    const leader = await site.two.leader(), standby = site.two.other(leader);
    const began = performance.now(), polled = site.two.network.now() - 500, overlaps = (await site.two.network.overlaps()).length;
    const before = { total: cycles.total, failures: cycles.failures.length, notKept: cycles.notKept };
    cycles.begin();
    cycles.resume();
    await fault.act({ site, leader, standby, random }).catch(({ message }) => row.failures.push(`fault: ${message}`));
    await until('its alerts', () => fault.alerts.every((name) => alerts.since(began).has(name)), 10).catch(() => {});
    const lacking = await site.recovered();
    if (lacking)
        row.failures.push(`not recovered: ${lacking}`);
    row.recovered_s = (performance.now() - began) / 1000;
    row.fired = fault.alerts.map((name) => alerts.since(began).has(name));
    const rest = () => firing([...fault.alerts, ...NEVER]);
    await until('clear alerts', () => rest().length === 0, CLEARED_S).catch(() => row.failures.push(`alerts go on: ${rest()}`));
    await sleep(Math.max(0, FAULT_MS - (performance.now() - began)));
    await cycles.pause().catch(({ message }) => row.failures.push(message));
    row.blind_ms = Math.max(...site.operators.map((operator) => operator.longestBlind(began)));
    row.pause_ms = await site.two.network.longestPause(polled);
    row.overlaps = (await site.two.network.overlaps()).length - overlaps;
    row.cycles = cycles.total - before.total;
    row.notKept = cycles.notKept - before.notKept;
    Object.assign(row, { lost: 0, twice: 0 });
    for (const core of Object.values(site.two.cores)) {
        const { lost, twice } = await cycles.compare(core, fault.off_s).catch(({ message }) => {
            row.failures.push(`journal of ${core.name}: ${message}`);
            return { lost: 0, twice: 0 };
        });
        row.lost += lost;
        row.twice += twice;
        if (lost || (twice && !fault.isRepeated))
            row.failures.push(`journal of ${core.name}: lost ${lost}, twice ${twice}`);
    }
    for (const name of alerts.since(began))
        if (NEVER.includes(name))
            row.failures.push(`${name} fired`);
    row.failures.push(...cycles.failures.slice(before.failures), ...ends.splice(0), ...fault.alerts.filter((_, i) => !row.fired[i])
        .map((name) => `${name} did not fire`));
    if (row.blind_ms > BLIND_MS)
        row.failures.push(`operators blind for ${(row.blind_ms / 1000).toFixed(1)} s`);
    if (row.overlaps > 0)
        row.failures.push('two pollers');
    return row;
}

const seconds = (ms) => (ms / 1000).toFixed(1);
function table(rows, site) {
    const columns = ['fault', 'count', 'longest blind s', 'without poller s', 'two pollers', 'alarms', 'lost', 'twice', 'not kept',
        'alerts', 'recovered s', 'load', 'failed'];
    const sum = (list, key) => list.reduce((total, row) => total + row[key], 0);
    const most = (list, key) => Math.max(...list.map((row) => row[key]));
    const line = (name, list) => {
        const fired = list.flatMap((row) => row.fired);
        return [name, list.length, seconds(most(list, 'blind_ms')), seconds(most(list, 'pause_ms')), sum(list, 'overlaps'),
            sum(list, 'cycles'), sum(list, 'lost'), sum(list, 'twice'), sum(list, 'notKept'),
            `${fired.filter(Boolean).length} of ${fired.length}`, most(list, 'recovered_s').toFixed(0), most(list, 'load').toFixed(1),
            list.filter(({ failures }) => failures.length > 0).length];
    };
    const names = FAULTS.map(({ name }) => name).filter((name) => rows.some(({ fault }) => fault === name));
    const lines = [columns, ...names.map((name) => line(name, rows.filter(({ fault }) => fault === name))), line('all', rows)];
    const text = lines.map((cells) => `| ${cells.join(' | ')} |`);
    text.splice(1, 0, `|${'---|'.repeat(columns.length)}`);
    const kept = site.footprint.rows().map(({ name, memory_mb: mb, descriptors, threads }) =>
        `| ${name} | ${[mb.map((x) => x.toFixed(0)), descriptors, threads].map((pair) => pair.join(' to ')).join(' | ')} |`);
    const failed = rows.flatMap(({ fault, failures }, i) => failures.map((why) => `fault ${i + 1}, ${fault}: ${why}`));
    return [`seed ${SEED}, ${rows.length} faults`, '', ...text, '', 'Medians of the first and the last third of the time:', '',
        '| process | MB | descriptors | threads |', '|---|---|---|---|', ...kept, '', ...failed, ''].join('\n');
}
function grown(site) {
    return site.footprint.rows().flatMap(({ name, memory_mb: mb, descriptors, threads }) => [
        mb[1] > GROWTH * mb[0] + GROWTH_MB && `${name}: memory ${mb} MB`,
        descriptors[1] > descriptors[0] + MORE_DESCRIPTORS && `${name}: descriptors ${descriptors}`,
        threads[1] > threads[0] + MORE_THREADS && `${name}: threads ${threads}`].filter(Boolean));
}

test(`a whole host for ${MINUTES} minutes, seed ${SEED}`, { skip, timeout: (MINUTES + 20) * 60000 }, async (t) => {
    const random = randomOf(SEED), site = new Site(), rows = [], ends = [];
    const chosen = FAULTS.filter(({ name }) => !ONLY || ONLY.includes(name));
    for (const signal of ['SIGINT', 'SIGTERM', 'SIGHUP'])
        process.on(signal, () => site.destroy().finally(() => process.exit(1)));
    t.after(() => site.destroy()); // destroy the site also after a timeout
    try {
        await site.start();
        supervise(site, ends);
        assert.equal(await site.recovered(), null, 'the whole plant works at first');
        const isRead = async () => await site.alerts.read().catch(() => 0) === NODES;
        await until('Prometheus reads all nodes', isRead, 60, () => site.alerts.said);
        await site.cycles.pause();
        for (const core of Object.values(site.two.cores))
            await site.cycles.compare(core);
        for (let turn = [], end = Date.now() + MINUTES * 60000; rows.length === 0 || Date.now() < end;) {
            turn = turn.length > 0 ? turn : shuffled(chosen, random);
            rows.push(await oneFault(site, turn.pop(), random, ends));
            const { failures, ...figures } = rows.at(-1);
            console.log(`# ${rows.length}: ${JSON.stringify(figures)}${failures.map((why) => `\n#    ${why}`).join('')}`);
            mkdirSync('build', { recursive: true });
            writeFileSync(join('build', 'soak-host.txt'), table(rows, site));
        }
        console.log(table(rows, site).replaceAll(/^/gm, '# '));
        assert.deepEqual(rows.flatMap(({ fault, failures }) => failures.map((why) => `${fault}: ${why}`)), []);
        assert.deepEqual(grown(site), []);
    } finally {
        await site.destroy();
    }
});
