// SPDX-License-Identifier: GPL-3.0-or-later
// An action that was answered as done survives any fate of the leader, even if the connection to the standby is slow
// (tests/faults/late_peer.c) and the leader is killed the moment the answer arrives.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { kill, missingTwoCores, STANDBY_HOST, TwoCores, until } from './support/two_cores.mjs';

const LIBRARY = resolve(process.env.PLANTCAST_OUT ?? 'build/release', 'tests/faults/late_peer.so'), LATE_MS = 100, ROUNDS = 3;
const skip = missingTwoCores() || (existsSync(LIBRARY) ? false : 'not built: late_peer.so');
let two;

before(async () => {
    two = skip ? null : await TwoCores.running(async (cores) => {
        for (const core of Object.values(cores.cores))
            core.before = ['env', `LD_PRELOAD=${LIBRARY}`, `LATE_PEER=${STANDBY_HOST}`, `LATE_MS=${LATE_MS}`,
                'ASAN_OPTIONS=verify_asan_link_order=0'];
        await cores.plant.tell('set TI-1 50');
    });
});
after(() => two?.destroy());

test('an action is answered once the standby has it', { skip, timeout: 240000 }, async (t) => {
    const renderer = await two.renderer('r');
    for (let round = 0; round < ROUNDS; round++) {
        const core = await two.leader();
        await two.followed(core);
        await until('the renderer is there', async () => (await renderer.tags())['TI-1'].quality_name === 'Good');
        const anna = await renderer.client({}, { token: two.nodes.tokens.operator }), began = performance.now();
        anna.say({ type: 'note', seq: 1 + round, text: `round ${round}`, asset: 'E-101' });
        await anna.text('noted');
        const answered_ms = performance.now() - began;
        const { leads } = await two.takeOver(t, core, kill(core, 'SIGKILL'));
        const notes = await (await leads.node.fetch('/api/v1/notes')).text();
        for (let i = 0; i <= round; i++)
            assert.match(notes, new RegExp(`round ${i}`), `the note that was answered after ${answered_ms.toFixed(0)} ms is kept`);
        t.diagnostic(`answered after ${answered_ms.toFixed(0)} ms`);
        anna.close();
        await two.restart(core);
    }
});

const acknowledge = (client) => client.say({ type: 'alarm', seq: 1, action: 'acknowledge', alarms: [['TI-1', 'H']] });

// Raises the alarm of TI-1 after its previous alarm has ended.
async function raise(...nodes) {
    await two.plant.tell('set TI-1 50');
    await until('the end of the alarm', async () => (await Promise.all(nodes.map((node) => node.alarm()))).every((one) => !one));
    await two.plant.tell('set TI-1 95');
    await until('the alarm at all nodes', async () =>
        (await Promise.all(nodes.map((node) => node.alarm()))).every((one) => one?.state === 'unacknowledged'));
}

for (const reloads of [false, true])
    test(`a leader cut off from standby and database ${reloads ? 'and reloaded ' : ''}confirms nothing that the next leader lacks`,
        { skip, timeout: 240000 }, async (t) => {
            const core = await two.leader(), other = two.other(core), renderer = await two.renderer(`cut-${reloads}`);
            await two.followed(core);
            await until('the renderer is there', async () => (await renderer.tags())['TI-1'].quality_name === 'Good');
            const anna = await renderer.client({}, { token: two.nodes.tokens.operator });
            const confirms = () => anna.texts.filter(({ type, done }) => type === 'alarmed' && done === 1).length;
            await raise(renderer, other.node);
            acknowledge(anna);
            await until('the confirmation without a cut', () => confirms() === 1);
            await until('acknowledged at the standby', async () => (await other.node.alarm()).state === 'acknowledged');
            await raise(renderer, other.node);
            await two.takeOver(t, core, async () => {
                await Promise.all([core.toDatabase.cut(), other.toOther.cut()]);
                acknowledge(anna);
                if (!reloads)
                    return;
                await until('acknowledged at the leader', async () => (await core.node.alarm()).state === 'acknowledged');
                core.program.child.kill('SIGHUP');
                // Waits until the reload ends, or until the leader does: without the database it gives up its role if the
                // reload takes longer than the lease.
                await Promise.race([core.program.line(/reload: configuration/), core.program.ended]).catch(() => core.program.ended);
            });
            const isConfirmed = confirms() > 1, { state } = await other.node.alarm();
            t.diagnostic(`${isConfirmed ? 'confirmed' : 'not confirmed'}, and ${state} at the next leader`);
            assert.ok(!isConfirmed || state === 'acknowledged', `a confirmed acknowledgement is ${state} at the next leader`);
            anna.close();
            // The new leader never got the acknowledgement, and the client knew: another operator acknowledges the alarm, so
            // that it can end before the next case.
            if (state !== 'acknowledged') {
                const ben = await other.node.client({}, { token: two.nodes.tokens.operator });
                acknowledge(ben);
                await ben.text('alarmed');
                ben.close();
            }
            await core.program.ended;
            await Promise.all([core.toDatabase.mend(), other.toOther.mend()]);
            await two.restart(core);
        });
