// SPDX-License-Identifier: GPL-3.0-or-later
// Reload of two cores. A standby loads changed files when the leader does. A core that has taken over and is reloaded at once
// still reads from the database the points that the other core recorded while the link between the cores was cut. If the
// standby keeps reconnecting, the leader reads these points at most twice more.
import assert from 'node:assert/strict';
import { copyFileSync, cpSync, readFileSync, writeFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { long } from './support/promise.mjs';
import { kill, missingTwoCores, sleep, TwoCores, until } from './support/two_cores.mjs';

const skip = missingTwoCores(), options = { skip, timeout: 240000 }, PEAKS = 4, RETURNS = 5;
const READ = /history: read \d+ points from PostgreSQL, covering the \d+ s in which another core led/g;
let two;

before(async () => { two = skip ? null : await TwoCores.running(); });
after(() => two?.destroy());

const valuesOf = async (core, from_us, to_us) => {
    const path = `/api/v1/history?tags=TI-1&points=20000&from=${from_us / 1e6}&to=${to_us / 1e6}`;
    return (await (await core.node.fetch(path)).json()).series[0].points.map(([, value]) => value);
};

test('points recorded during a cut are read although the plant is reloaded meanwhile', options, async (t) => {
    const core = await two.leader(), other = two.other(core), from_us = Date.now() * 1000;
    await other.toOther.cut();
    for (let i = 0; i < 2 * PEAKS; i++) { // readings that the other core misses
        const value = i % 2 ? 31 : 71;
        await two.plant.tell(`set TI-1 ${value}`);
        await until(`TI-1 ${value}`, async () => (await core.node.tags())['TI-1'].value === value);
    }
    const sent = `SELECT count(*) FROM plantcast.history WHERE tag = 'TI-1' AND value = 71 AND time > to_timestamp(${from_us / 1e6})`;
    await until('all being sent', () => Number(two.server.ask(sent)[0][0]) >= PEAKS);
    const to_us = Date.now() * 1000;
    await two.takeOver(t, core, kill(core, 'SIGKILL'));
    change(two.file, 100, 101);
    other.program.child.kill('SIGHUP');
    await other.program.line(/reload: configuration/);
    assert.equal(other.program.said.match(READ), null, 'the reload came before the points were read');
    await until('the points of then', async () => (await valuesOf(other, from_us, to_us))
        .filter((value) => value === 71).length >= PEAKS, 60);
    await other.toOther.mend();
    await two.restart(core);
    await two.followed(other);
});

test('a standby that keeps reconnecting does not make the leader read the points as often',
    { ...options, skip: skip || long }, async () => {
    const core = await two.leader(), other = two.other(core);
    // waits until the core has read all points that the previous test left in the database: for 13 s it logs no more reads
    await until('nothing left', async () => {
        const { length } = core.program.said.match(READ) ?? [];
        await sleep(13000);
        return length === core.program.said.match(READ)?.length;
    }, 100);
    const { length } = core.program.said.match(READ);
    for (let i = 0; i < RETURNS; i++) {
        await other.toOther.cut();
        await sleep(500);
        await other.toOther.mend();
        await two.followed(core);
    }
    await sleep(30000);
    const more = core.program.said.match(READ).length - length;
    assert.ok(more >= 1 && more <= 2, `read ${more} times after ${RETURNS} returns`);
});

// Gives a core its own plant file and prepared models, as on its own machine, and restarts it.
async function separate(core) {
    const own = two.file.replace('two.yaml', 'own.yaml');
    copyFileSync(two.file, own);
    cpSync(two.file.replace('.yaml', '.prepared'), own.replace('.yaml', '.prepared'), { recursive: true });
    await core.node.stop();
    core.file = own;
    await two.restart(core);
}
const change = (file, from, to) => writeFileSync(file, readFileSync(file, 'utf8').replace(`max: ${from} }`, `max: ${to} }`));

test('a standby with the same changed files loads them when the leader does', options, async () => {
    const core = await two.leader(), other = two.other(core);
    await two.followed(core);
    await separate(other);
    await two.followed(core);
    for (const file of [core.file, other.file])
        change(file, 101, 102);
    core.program.child.kill('SIGHUP');
    await other.program.line(/reload: configuration \w+ replaced \w+ after [\d.]+ s, requested by the core/);
    await two.followed(core);
    // a reload without changes in the plant file (as after changed models): the standby must reload, too
    other.program.said = '';
    core.program.child.kill('SIGHUP');
    await other.program.line(/reload: configuration (\w+) replaced \1 after [\d.]+ s, requested by the core/);
    await two.followed(core);
});

test('a standby with different files keeps its own, takes over only after a reload, and says so', options, async () => {
    const core = await two.leader(), other = two.other(core);
    change(core.file, 102, 103);
    other.program.said = '';
    core.program.child.kill('SIGHUP');
    await other.program.line(/configuration: the renderer has .*only confirms the leader's lease/);
    await other.program.line(/not got its core's files: the core has another plant file than \S+own\.yaml on node \w+: copy/);
    core.program.stopped = true;
    core.program.child.kill('SIGKILL');
    await other.program.line(/lease: no core leads, .*because the last leader refused this core \(configuration: /);
    assert.ok(!await two.ready(other));
    change(other.file, 102, 103);
    other.program.said = '';
    other.program.child.kill('SIGHUP');
    await two.waitsFor('the other core leads', () => two.ready(other));
    await two.restart(core);
    await two.followed(other);
});
