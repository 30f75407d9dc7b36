// SPDX-License-Identifier: GPL-3.0-or-later
// A leading core is shut down properly: it evaluates its last samples, sends them to its standby and hands over the lease.
// Expected: the journal has each alarm change once, the standby leads at once, and the two never poll at the same time. The
// readings of the new leader become stale if the device stops.
import assert from 'node:assert/strict';
import { copyFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { promise } from './support/promise.mjs';
import { runProgram } from './support/tiny_plant.mjs';
import { kill, missingTwoCores, sleep, TwoCores, until } from './support/two_cores.mjs';

const skip = missingTwoCores(), options = { skip, timeout: 240000 }, STOPS = 2, ROWS = 20, POLL_MS = 100;
// GIVEN_MS: maximum time in which no core polls; BLIND_MS: maximum time in which a renderer has no usable readings
const GIVEN_MS = 1500, BLIND_MS = 2500;
let two, stopFeeding;

before(async () => { two = skip ? null : await TwoCores.running((cores) => cores.plant.set({ 'TI-1': 50, 'TI-2': 20, 'PI-1': 5 })); });
after(async () => {
    await stopFeeding?.();
    await two?.destroy();
});

// Sets TI-1 alternately above and below its limit, once per poll interval, until stopFeeding().
function feed() {
    let going = true;
    const done = (async () => {
        for (let i = 0; going; i++) {
            await two.plant.tell(`set TI-1 ${i % 2 ? 50 : 95}`);
            await sleep(POLL_MS);
        }
        await two.plant.tell('set TI-1 50');
    })();
    stopFeeding = async () => { going = false; stopFeeding = null; await done; };
}

async function journal(core, tag) {
    return (await (await core.node.fetch(`/api/v1/alarms/journal?tag=${tag}&limit=1000`)).json()).rows;
}

// Returns the journal rows of TI-1's high alarm at a core, the oldest first.
async function changes(core) {
    const rows = await journal(core, 'TI-1');
    return rows.filter(({ kind }) => kind === 'H').map(({ time_us, event, state }) => `${time_us} ${event} ${state}`).sort();
}

// Watches a renderer every 20 ms. end() returns the longest time in milliseconds in which TI-1 was not Good there.
function watch(renderer) {
    let going = true, longest = 0, seen = performance.now();
    const done = (async () => {
        for (; going; await sleep(20)) {
            const good = (await renderer.tags().catch(() => ({})))['TI-1']?.quality_name === 'Good', now = performance.now();
            longest = Math.max(longest, now - seen);
            seen = good ? now : seen;
        }
    })();
    return { end: async () => { going = false; await done; return longest; } };
}

test('with changing leaders each change of an alarm is written once, and the standby leads at once', options, async (t) => {
    const renderer = await two.renderer('r');
    feed();
    for (let stop = 0; stop < STOPS; stop++) {
        const core = await two.leader();
        await two.followed(core);
        await until('the renderer is there', async () => (await renderer.tags())['TI-1'].quality_name === 'Good');
        const had = (await changes(core)).length;
        await until('changes of the alarm', async () => (await changes(core)).length > had + ROWS);
        const watching = watch(renderer), { pause_ms } = await two.takeOver(t, core, kill(core, 'SIGTERM'));
        assert.equal((await core.program.ended).code, 0);
        assert.match(core.program.said, new RegExp(`lease: this core handed the lead over to ${two.other(core).name}\n`));
        await until('the renderer is there', async () => (await renderer.tags())['TI-1'].quality_name === 'Good');
        promise(t, 'without a poller', pause_ms, GIVEN_MS);
        promise(t, 'without readings at a renderer', await watching.end(), BLIND_MS);
        await two.restart(core);
    }
    const core = await two.leader();
    await two.followed(core);
    await stopFeeding();
    await two.plant.tell('set TI-1 51'); // a value that feed() never sets: once the core has read it, it has read all earlier changes
    await until('the last value', async () => (await core.node.tags())['TI-1'].value === 51);
    // Raises an alarm of another tag. The journal is written in order, so when it contains this alarm, it contains all earlier
    // changes of TI-1's alarm.
    await two.plant.tell('set TI-2 95');
    await until('a later alarm', async () => (await journal(core, 'TI-2')).some(({ event, kind }) => event === 'raise' && kind === 'H'));
    assert.match((await changes(core)).at(-1), / clear /);
    const rows = await changes(core), events = rows.map((row) => row.split(' ')[1]);
    assert.ok(events.length > STOPS * ROWS);
    assert.deepEqual(events.filter((event, i) => event === events[i - 1]), [], rows.join('\n'));
    await until('the same changes at the standby', async () => (await changes(two.other(core))).length >= rows.length);
    assert.deepEqual(await changes(two.other(core)), rows);
    assert.deepEqual(await two.network.overlaps(), []);
    // This leader was a standby, whose readings do not become stale by themselves. Now they must, as on any leader.
    await two.plant.tell('pause');
    await until('a stale reading', async () => (await core.node.tags())['TI-1'].quality_name === 'Bad_CommunicationError');
    await two.plant.tell('resume');
});

// Restarts both cores so that each has a token file of its own and a token of its own for the role standby.
async function separateTokens() {
    for (const core of Object.values(two.cores)) {
        const own = (name) => join(two.plant.folder, core.name, name);
        Object.assign(core, { tokenFile: own('tokens'), standbyFile: own('token') });
        copyFileSync(two.nodes.tokenFile, core.tokenFile);
        copyFileSync(two.nodes.standbyFile, core.standbyFile);
        await core.program.stop();
    }
    await Promise.all([two.start('one'), two.start('two')]);
}

// Copies a core's new token to the other core. Returns a function that revokes the old one there.
async function handNewToken(core) {
    const other = two.other(core), change = async (...args) => {
        const had = other.program.said.length, { code, out, err } = runProgram('plantcast', ['token', ...args]);
        assert.equal(code, 0, err);
        await until('the file is read', () => other.program.said.indexOf(`tokens ${other.tokenFile}: `, had) >= 0);
        return out;
    };
    writeFileSync(core.standbyFile, await change('add', other.tokenFile, '--role', 'standby', '--name', `${core.name}-new`));
    return () => change('revoke', other.tokenFile, 's');
}

test('the cores get new tokens as KEYS.md describes, without a refused connection', options, async (t) => {
    await separateTokens();
    const leader = await two.leader(), standby = two.other(leader);
    await two.followed(leader);
    const revokeStandbys = await handNewToken(standby);
    await standby.program.stop();
    await two.restart(standby);
    await two.followed(leader);
    await revokeStandbys();
    const revokeLeaders = await handNewToken(leader);
    await two.takeOver(t, leader, kill(leader, 'SIGTERM'));
    await two.restart(leader);
    await two.followed(standby);
    await revokeLeaders();
    // waits longer than the 3 s within which a daemon ends connections whose token was revoked; the standby must still follow
    // the leader
    await two.goesOn(t, standby, 4);
    await two.followed(standby);
    for (const { node, program } of [leader, standby]) {
        assert.equal(await node.metric('plantcast_core_refused_total'), 0);
        assert.doesNotMatch(program.said, /refuse|no longer has the role/);
    }
});
