// SPDX-License-Identifier: GPL-3.0-or-later
// Two cores whose clocks differ by an hour: the standby reports that and takes over as fast as usual. No point is lost, no
// notification is sent twice, and no value is shown older than it is. If a core with a slow clock recorded points while the
// other core was away, the other does not read them when it returns, but the database has them.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { missingClocks, withClockOff } from './support/clocks.mjs';
import { PostgresServer } from './support/postgres_server.mjs';
import { kill, missingTwoCores, TwoCores, until } from './support/two_cores.mjs';

const skip = missingTwoCores() || (missingClocks() ?? false), options = { skip, timeout: 240000 };
const HOUR_S = 3600;
let server;

before(async () => {
    server = skip ? null : await PostgresServer.start();
});
after(() => server?.destroy());

const json = async (node, path) => (await node.fetch(path)).json();

// Returns the good points of TI-2 in a core's history as [[time_us, value], ...]; sent() returns those in the database.
async function recorded(node) {
    const now_s = Date.now() / 1000, span = `from=${now_s - 2 * HOUR_S}&to=${now_s + 2 * HOUR_S}`;
    const { series } = await json(node, `/api/v1/history?tags=TI-2&${span}&points=20000`);
    return series[0].points.filter(([, value, quality]) => value !== null && quality === 0).map(([us, value]) => [us, value]);
}
const sent = () => server.ask(`SELECT (extract(epoch FROM s.t) * 1000000)::bigint, s.v FROM plantcast.sample s
    JOIN plantcast.tag g ON g.id = s.tag WHERE g.name = 'TI-2' AND s.q = 0 AND s.v IS NOT NULL ORDER BY s.t`)
    .map(([us, value]) => [Number(us), Number(value)]);

// Changes TI-2 twenty times, each time after the leading core has read the previous value.
async function move(two, leader) {
    for (let i = 0; i < 20; i++) {
        const value = 20 + i % 7;
        await two.plant.tell(`set TI-2 ${value}`);
        await until(`TI-2 ${value}`, async () => (await leader.node.tags())['TI-2'].value === value);
    }
}

// Lengthens the device's timeout and the tags' `Stale s`. Otherwise the journal would contain alarms for Bad readings if the
// device answers late on a busy machine.
function allowLateAnswers({ file, plant }) {
    const tags = join(plant.folder, 'tags.csv');
    writeFileSync(file, readFileSync(file, 'utf8').replace('timeout_ms: 300', 'timeout_ms: 10000'));
    writeFileSync(tags, readFileSync(tags, 'utf8').replace(/,1,90$/gm, ',60,90'));
}

for (const off_s of [HOUR_S, -HOUR_S])
    test(`a standby whose clock is an hour ${off_s > 0 ? 'ahead' : 'behind'} takes over, and the first core takes over from it`,
        options, async (t) => {
        server.makeDatabase(off_s > 0 ? 'ahead' : 'behind');
        const two = await TwoCores.create(server), { one, two: other } = two.cores;
        allowLateAnswers(two);
        other.before = withClockOff(off_s);
        try {
            await two.plant.set({ 'TI-1': 95, 'TI-2': 20, 'PI-1': 5 });
            await two.start('one');
            await two.leader();
            await two.start('two');
            await two.followed(one);
            const side = off_s > 0 ? 'behind' : 'ahead of';
    await other.program.line(new RegExp(`the core's clock is 3[56]\\d\\d\\.\\d s ${side} this machine's`));
            await until('the alarm at the standby', async () => (await other.node.alarm())?.state === 'unacknowledged');
            const anna = await one.node.client({}, { token: two.nodes.tokens.operator });
            anna.say({ type: 'alarm', seq: 1, action: 'acknowledge', alarms: [['TI-1', 'H']] });
            await anna.text('alarmed');
            anna.close();
            await move(two, one);
            const first = await two.takeOver(t, one, kill(one, 'SIGKILL')), began_us = Date.now() * 1000;
            t.diagnostic(`${first.pause_ms.toFixed(0)} ms without a poller`);
            const kept = await other.node.alarm();
            assert.deepEqual([kept.state, kept.who], ['acknowledged', 'anna']);
            t.diagnostic(`raised ${((kept.raised_us - began_us) / 1e6).toFixed(0)} s before`);
            await until('readings that are as old as they are', async () => (await json(other.node, '/api/v1/tags?count=9')).tags
                .every(({ value, age_ms: age }) => value === null || (age >= 0 && age < 5000)));
            await move(two, other);
            const times = (points) => [0, off_s].map((from_s) => // an hour apart
                points.filter(([us]) => Math.abs(us - began_us - from_s * 1e6) < HOUR_S / 2 * 1e6).length);
            const all = async (what, ask, least) => {
                let points;
                await until(`the points of ${what}`, async () => {
                    points = await ask();
                    return times(points).every((count, i) => count >= least[i]);
                }, 90, () => `${times(points)} of ${least}`);
                const [right, wrong] = times(points);
                t.diagnostic(`${what}: ${right} by the right clock, ${wrong} by the other`);
                assert.equal(right + wrong, points.length, `${what}: every point has one of the expected times`);
            };
            await all('two, while it led', () => recorded(other.node), [10, 15]);
            await two.plant.tell('set TI-1 50');
            await until('the end of the alarm', async () => !await other.node.alarm());
            await two.restart(one);
            await two.followed(other);
            const second = await two.takeOver(t, other, kill(other, 'SIGKILL'));
            t.diagnostic(`${second.pause_ms.toFixed(0)} ms without a poller`);
            assert.equal(await one.node.alarm(), undefined, 'the ended alarm has ended here, too');
            await move(two, one);
            await two.restart(other);
            await two.followed(one);
            await all('one', () => recorded(one.node), [30, 0]);
            await all('the database', sent, [30, 15]);
            const { rows } = await json(one.node, '/api/v1/alarms/journal?tag=TI-1');
            // Only the events of the high alarm (H) are compared. On a busy machine alarms of kind BAD may be raised and
            // cleared, because readings arrive later than `Stale s`.
            const events = rows.filter(({ kind }) => kind === 'H').map(({ event }) => event);
            assert.ok(events.includes('raise') && new Set(events).size === events.length, `each event occurs once: ${events}`);
        } finally {
            await two.destroy();
        }
    });
