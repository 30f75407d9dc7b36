// SPDX-License-Identifier: GPL-3.0-or-later
// HAProxy in front of two cores and a renderer: requests that only a core answers go to the leader, even after kill -9, and the
// renderer's sessions survive.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Haproxy, missingHaproxy } from './support/haproxy.mjs';
import { get, PlainClient } from './support/plain_client.mjs';
import { freePort } from './support/ports.mjs';
import { PostgresServer } from './support/postgres_server.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { kill, missingTwoCores, TAKE_OVER_MS, TwoCores, until } from './support/two_cores.mjs';

const skip = missingTwoCores() || (missingHaproxy() ?? false), options = { skip, timeout: 240000 };
const CHECKS_MS = 1500; // the proxy checks its servers once a second
const HOST = ['--behind-proxy', '--host', 'plant.example', '--host', '127.0.0.1'];
let server, two, renderer, proxy, plain; // plain: a second HAProxy, which balances the two cores only and has no renderers

setUp(skip, async (own) => {
    server = own(await PostgresServer.start());
    server.makeDatabase('plants');
    two = own(await TwoCores.create(server, '', HOST));
    await two.plant.set({ 'TI-1': 50, 'TI-2': 20, 'PI-1': 5 });
    await Promise.all([two.start('one'), two.start('two')]);
    await two.followed(await two.leader());
    const agentPort = await freePort();
    renderer = await two.renderer('r1', '--agent-port', String(agentPort), ...HOST);
    proxy = own(await Haproxy.start([Object.assign(renderer, { agentPort })], two.cores.one, two.cores.two));
    plain = own(await Haproxy.startCores([two.cores.one, two.cores.two]));
    await until('the proxy and the renderer', async () => /^UP/.test((await proxy.servers().catch(() => null))?.r1.status));
});

const ask = (path, token = two.nodes.tokens.viewer) => get(proxy.port, path, 'GET', `Authorization: Bearer ${token}\r\n`);
// Returns the names of the cores that HAProxy considers usable (`UP`) and sends requests to, joined by commas.
const chosen = async () => {
    const { core, standby } = await proxy.servers('core');
    return [[core, 'one'], [standby, 'two']].filter(([{ status }]) => /^UP/.test(status)).map(([, name]) => name).join();
};
// Returns the status of the answer to a request through the proxy that has no renderers.
const plainStatus = async () =>
    (await get(plain.port, '/api/v1/history?tags=TI-1', 'GET', `Authorization: Bearer ${two.nodes.tokens.viewer}\r\n`)).status;
const journal = async () => JSON.parse((await ask('/api/v1/alarms/journal?tag=TI-1')).body).rows;

async function operator() {
    const client = await PlainClient.open(proxy.port);
    client.say({ type: 'hello', tokens: true, token: two.nodes.tokens.operator, width: 160, height: 90, codecs: ['jpeg'] });
    await client.text('welcome');
    return client;
}

test('HAProxy sends requests for a core to the leading one of two', options, async () => {
    const core = await two.leader();
    await until('the proxy\'s choice', async () => await chosen() === core.name);
    assert.equal((await ask('/api/v1/history?tags=TI-1')).status, 200);
    assert.equal((await ask('/api/v1/history?tags=TI-1', 'wrong')).status, 401);
    await until('the proxy without renderers', async () => await plainStatus() === 200);
    await until('the other core not to be in use', async () =>
        /^DOWN/.test((await plain.servers('cores'))[core.name === 'one' ? 'c2' : 'c1'].status));
});

for (const [signal, how] of [['SIGKILL', 'kill -9'], ['SIGTERM', 'an end in good order']])
    test(`${how} of the leading core: the other core answers in its place, and the renderer's sessions stay`, options, async (t) => {
        const core = await two.leader(), other = two.other(core), anna = await operator();
        await two.followed(core);
        await two.plant.tell('set TI-1 95');
        await until('the alarm', async () => (await journal()).some(({ state }) => state === 'unacknowledged'));
        const rows = (await journal()).length, began = performance.now();
        await two.takeOver(t, core, kill(core, signal));
        await until('an answer', async () => (await ask('/api/v1/alarms/journal?tag=TI-1')).status === 200);
        const took_ms = performance.now() - began;
        t.diagnostic(`answers again after ${(took_ms / 1000).toFixed(1)} s`);
        promise(t, 'until an answer', took_ms, TAKE_OVER_MS + CHECKS_MS);
        await until('the proxy\'s choice of the new leader', async () => await chosen() === other.name);
        await until('an answer through the proxy without renderers', async () => await plainStatus() === 200);
        await until('readings at the renderer', async () =>
            (await renderer.tags(two.nodes.tokens.viewer))['TI-1'].quality_name === 'Good');
        anna.say({ type: 'alarm', seq: 1, action: 'acknowledge', alarms: [['TI-1', 'H']] });
        assert.equal((await anna.text('alarmed')).done, 1);
        const acknowledged = async () => (await journal()).filter(({ event, who }) => event === 'acknowledge' && who === 'anna').length;
        await until('the acknowledgement in the journal', async () => await acknowledged() === (signal === 'SIGKILL' ? 1 : 2));
        assert.ok((await journal()).length > rows, 'the old journal rows are still there');
        assert.equal(anna.closed, null);
        anna.close();
        await two.plant.tell('set TI-1 50');
        await two.restart(core);
        await two.followed(other);
        assert.equal(await chosen(), other.name, 'HAProxy stays with the core that took over');
    });
