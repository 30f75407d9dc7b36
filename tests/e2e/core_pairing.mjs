// SPDX-License-Identifier: GPL-3.0-or-later
// Pairing of a display that connects to a renderer: the core shows its digits and admits the display. Afterwards, the renderer
// admits it even while the core cannot be reached.
import assert from 'node:assert/strict';
import { appendFileSync } from 'node:fs';
import { test } from 'node:test';
import { Nodes, until } from './support/nodes.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram } from './support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 240000 };
const WALLS = `
views: [{ id: whole, title: Whole unit, view: "group=temperature" }]
walls:
- id: room
  displays: [{ grid: [main], panes: [{ area: main, views: whole }] }, { grid: [tiles], panes: [{ area: tiles, tiles: [TI-1] }] }]
`;
const SECRET = `pc_${'5'.repeat(64)}`;
let nodes, core, renderer, engineer;

setUp(options.skip, async (own) => {
    nodes = own(await Nodes.create());
    appendFileSync(nodes.plant.file, WALLS);
    assert.equal(nodes.plant.prepare().code, 0);
    engineer = runProgram('plantcast', ['token', 'add', nodes.tokenFile, '--role', 'engineer', '--name', 'eve']).out.trim();
    core = await nodes.core();
    renderer = await nodes.renderer('a', core);
});

const ask = async (node, display = 1, secret = SECRET) => {
    const answer = await fetch(`http://127.0.0.1:${node.port}/api/v1/pair?wall=room&display=${display}`,
        { headers: { Authorization: `Pairing ${secret}` } });
    return answer.ok ? answer.json() : { status: answer.status };
};
const digitsOf = (node, ...more) => until('digits', async () => (await ask(node, ...more)).digits);
const asDevice = (node) => node.client({ headers: [`Authorization: Bearer ${SECRET}`], host: 'localhost' }, { token: SECRET });
const act = async (message) => {
    const client = await renderer.client({}, { token: engineer });
    client.say(message);
    const answer = await client.text('paired');
    client.close();
    return answer;
};

test('a display at a renderer shows the core\'s digits, and an engineer at a renderer approves it', options, async () => {
    const digits = await digitsOf(renderer);
    assert.match(digits, /^\d{6}$/);
    assert.equal((await ask(core)).digits, digits);
    assert.deepEqual([(await act({ type: 'pair', seq: 1, digits: digits === '000000' ? '111111' : '000000' })).kept], [false]);
    const { kept, id } = await act({ type: 'pair', seq: 2, digits });
    assert.deepEqual([kept, id], [true, 'room.1.1']);
    await until('being let in', async () => (await ask(renderer)).paired);
    assert.equal((await ask(renderer, 2)).status, 409);
    for (const node of [renderer, core]) {
        const { list } = await (await node.fetch('/api/v1/devices', engineer)).json();
        assert.deepEqual(list.map(({ id: device, by, hash }) => [device, by, hash]), [['room.1.1', 'eve', undefined]]);
    }
});

test('both core and renderer accept the approved display\'s secret for its own display only', options, async () => {
    for (const node of [renderer, core]) {
        const client = await asDevice(node);
        assert.equal(client.welcome.role, 'viewer');
        client.say({ type: 'display', wall: 'room', display: 2 });
        assert.match((await client.text('error')).text, /this token belongs to display 1 of wall room/);
        client.close();
    }
});

test('while the core is away, a paired display gets in and learns that values are missing; no new display pairs', options, async (t) => {
    const client = await asDevice(renderer), { port } = core;
    await core.stop('SIGKILL');
    const began = performance.now();
    await client.until('it being said', ({ texts }) => texts.some(({ type, links, live }) => type === 'status' && !live &&
        links.some(({ source, up }) => source === 'core' && !up)));
    promise(t, 'until it is said', performance.now() - began, 4000);
    client.close();
    const again = await asDevice(renderer);
    assert.equal(again.welcome.role, 'viewer');
    again.close();
    assert.deepEqual(await ask(renderer, 2, `pc_${'6'.repeat(64)}`), { paired: false, digits: '', left_s: 0 });
    core = await nodes.core(port);
    assert.match(await digitsOf(renderer, 2, `pc_${'6'.repeat(64)}`), /^\d{6}$/);
});

test('a display that is revoked at one renderer is disconnected within 3 s', options, async (t) => {
    const client = await until('the display', () => asDevice(renderer));
    const revoking = performance.now(), { kept } = await act({ type: 'unpair', seq: 3, id: 'room.1.1' });
    assert.equal(kept, true);
    await client.until('the end', ({ closed }) => closed);
    promise(t, 'until it is out', performance.now() - revoking, 3000);
    assert.equal((await ask(renderer)).paired, false);
});
