// SPDX-License-Identifier: GPL-3.0-or-later
// A display that was paired at the leading core is still paired at the core that takes over. A display whose pairing is revoked
// there stays revoked when the first core leads again.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { setUp } from './support/set_up.mjs';
import { runProgram } from './support/tiny_plant.mjs';
import { kill, missingTwoCores, TwoCores, until } from './support/two_cores.mjs';

const skip = missingTwoCores(), options = { skip, timeout: 240000 };
const WALLS = `
views: [{ id: whole, title: Whole unit, view: "group=temperature" }]
walls: [{ id: room, displays: [{ grid: [main], panes: [{ area: main, views: [whole] }] }] }]
`;
const SECRET = `pc_${'7'.repeat(64)}`;
let two, renderer, engineer;

setUp(skip, async (own) => {
    two = own(await TwoCores.running(async (cores) => {
        cores.nodes.trustsLocal = false;
        engineer = runProgram('plantcast', ['token', 'add', cores.nodes.tokenFile, '--role', 'engineer', '--name', 'eve']).out.trim();
        await cores.plant.tell('set TI-1 50');
    }, WALLS, []));
    renderer = await two.renderer('r');
});

const ask = async ({ port }) => {
    const headers = { Authorization: `Pairing ${SECRET}` };
    return (await fetch(`http://127.0.0.1:${port}/api/v1/pair?wall=room&display=1`, { headers })).json();
};
// Sends a pairing action through the renderer until it succeeds. The renderer answers after the standby has stored the action
// too, and refuses it while it has no core.
const act = (message) => until('the answer of the core', async () => {
    const client = await renderer.client({}, { token: engineer });
    client.say({ seq: 1, ...message });
    const answer = await client.until('an answer', ({ texts }) => texts.find(({ type }) => type === 'paired' || type === 'error'));
    client.close();
    return answer.type === 'paired' && answer;
}, 60);
// Asserts that the node admits the display and sends it a picture of its wall.
async function shows(node) {
    const client = await until('being let in',
        () => node.client({ headers: [`Authorization: Bearer ${SECRET}`] }, { token: SECRET }).catch(() => null));
    assert.equal(client.welcome.role, 'viewer');
    client.say({ type: 'display', wall: 'room', display: 1 });
    await client.frameWhere('a picture', () => true);
    client.close();
}

test('a display paired at the leader shows its wall after a take-over, at the new leader and at a renderer', options, async (t) => {
    const core = await two.leader(), digits = await until('digits', async () => (await ask(core)).digits);
    assert.equal((await act({ type: 'pair', digits })).kept, true);
    await shows(core.node);
    await shows(renderer);
    const { leads } = await two.takeOver(t, core, kill(core, 'SIGKILL'));
    assert.notEqual(leads, core);
    assert.equal((await ask(leads)).paired, true);
    await shows(leads.node);
    await shows(renderer);
    const { list } = await (await leads.node.fetch('/api/v1/devices', engineer)).json();
    assert.deepEqual(list.map(({ id, by }) => [id, by]), [['room.1.1', 'eve']]);
    await two.restart(core);
});

test('a display revoked at the second leader stays revoked at the first core', options, async (t) => {
    const core = await two.leader();
    await two.followed(core);
    assert.equal((await act({ type: 'unpair', id: 'room.1.1' })).kept, true);
    const { leads } = await two.takeOver(t, core, kill(core, 'SIGKILL'));
    assert.notEqual(leads, core);
    assert.equal((await ask(leads)).paired, false);
    assert.equal((await leads.node.fetch('/api/v1/walls', SECRET)).status, 401);
});
