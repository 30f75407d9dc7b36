// SPDX-License-Identifier: GPL-3.0-or-later
// HAProxy in front of two renderers: a node is killed, drained, stopped or cut off from the core, and no viewer loses its view
// and no acknowledgement is lost.
import assert from 'node:assert/strict';
import { connect } from 'node:net';
import { after, test } from 'node:test';
import { Operator } from '../long/host/operators.mjs';
import { Haproxy, missingHaproxy } from './support/haproxy.mjs';
import { Nodes, sleep, until } from './support/nodes.mjs';
import { get, PlainClient } from './support/plain_client.mjs';
import { freePort } from './support/ports.mjs';
import { CuttableLink } from './support/postgres_server.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt } from './support/tiny_plant.mjs';

const options = { skip: notBuilt() || (missingHaproxy() ?? false), timeout: 200000 };
const VIEWERS = 40, MOST = 80, LEAST = 10, BACK_MS = 10000, BLIND_MS = 10000;
let nodes, core, renderers, proxy, viewers, links;

setUp(options.skip, async () => {
    nodes = await Nodes.create({ slowDevice: true });
    core = await nodes.core(0, '--behind-proxy', '--host', 'plant.example');
    links = [await CuttableLink.open(core.port), await CuttableLink.open(core.port)];
    renderers = await Promise.all(['r1', 'r2'].map(start));
    proxy = await Haproxy.start(renderers, core);
    await nodes.plant.tell('set TI-1 20');
    await until('both nodes up', async () => Object.values(await proxy.servers().catch(() => ({ none: {} })))
        .every(({ status }) => /^UP/.test(status)));
});
after(async () => {
    for (const viewer of viewers ?? [])
        viewer.leave();
    await proxy?.destroy();
    await nodes?.destroy();
    for (const link of links ?? [])
        link.close();
});

async function start(name, i) {
    const agentPort = renderers?.[i].agentPort ?? await freePort();
    const through = { url: `ws://127.0.0.1:${links[i].port}` };
    const node = await nodes.renderer(name, through, '--agent-port', String(agentPort), '--behind-proxy', '--host', 'plant.example',
        '--limit', 'address-sessions=100', '--limit', 'address-connections=200',
        ...(renderers ? ['--port', String(renderers[i].port)] : []));
    return Object.assign(node, { agentPort, name });
}

// Returns the camera's eye position from a view token: MAC.PAYLOAD, where the payload is JSON in base64url.
const eyeOf = (token) => JSON.parse(Buffer.from(token.split('.')[1], 'base64url')).c.eye;

// A client that behaves like a page without drawing pictures: it reconnects as pages do, and restores its view with nothing but
// the view token.
class Viewer {
    constructor(number) {
        Object.assign(this, { number, eye: [3 + number / 10, -5, 2], returns: 0, moved: null, resume: null, lostAt: null });
    }

    async come() {
        const { headers } = await get(proxy.port, '/healthz', 'GET', this.cookie ? `Cookie: ${this.cookie}\r\n` : '');
        this.cookie = headers['set-cookie']?.split(';')[0] ?? this.cookie;
        this.node = this.cookie.split('=')[1];
        this.client = await PlainClient.open(proxy.port, { headers: [`Cookie: ${this.cookie}`] });
        const token = nodes.tokens.operator;
        this.client.say(this.resume ? { type: 'hello', tokens: true, token, resume: this.resume }
            : { type: 'hello', tokens: true, token, width: 160, height: 90, codecs: ['jpeg'] });
        this.welcome = await this.client.until('a welcome', ({ texts, closed }) => texts.find(({ type }) => type === 'welcome') ?? closed);
        if (this.welcome.type !== 'welcome')
            throw new Error(`closed: ${JSON.stringify(this.welcome)}`);
        this.watch(this.client);
    }

    async watch(client) {
        await client.until('the end', ({ closed }) => closed, 1e9).catch(() => {});
        if (this.left)
            return;
        this.lostAt = performance.now();
        this.reason = client.closed.text;
        for (let wait = 500; !this.left; wait = Math.min(8000, wait * 2)) {
            await sleep(wait * (0.75 + Math.random() / 2));
            try {
                await this.come();
                this.returns++;
                return;
            } catch { /* try again */ }
        }
    }

    async look() {
        this.client.say({ type: 'camera', seq: 1, eye: this.eye, target: [0, 0, 0] });
        await this.shows();
        const isOfView = ({ type, resume }) => type === 'resume' && Math.abs(eyeOf(resume)[0] - this.eye[0]) < 1e-5;
        this.resume = (await this.client.until('a token of the view', ({ texts }) => texts.find(isOfView))).resume;
    }

    shows() {
        const same = ({ eye }) => this.eye.every((v, i) => Math.abs(v - eye[i]) < 1e-5);
        return this.client.until('the view', ({ frames }) => frames.some(same));
    }

    leave() {
        this.left = true;
        this.client?.close();
    }
}

const line = (port) => new Promise((done, fail) => {
    let text = '';
    const socket = connect(port, '127.0.0.1').on('data', (chunk) => { text += chunk; }).on('end', () => done(text)).on('error', fail);
});
const standing = async (node) => (await (await node.fetch('/api/v1/alarms', nodes.tokens.viewer)).json()).alarms;

test('each node reports its spare drawing capacity; a cookie keeps a client at one node', options, async () => {
    assert.match(await line(renderers[0].agentPort), /^up \d{1,3}%\n$/);
    viewers = [];
    // On a busy machine one node may for a while report less spare capacity than the other, so it gets fewer viewers. Adds
    // viewers until each node has at least LEAST.
    const counts = () => ['r1', 'r2'].map((name) => viewers.filter(({ node }) => node === name).length);
    while (viewers.length < VIEWERS || Math.min(...counts()) < LEAST) {
        assert.ok(viewers.length < MOST, `viewers per node ${counts()} after ${MOST} viewers`);
        viewers.push(new Viewer(viewers.length));
        await viewers.at(-1).come();
    }
    await Promise.all(viewers.map((viewer) => viewer.look()));
    await nodes.onePoller();
    const { status } = await get(proxy.port, '/api/v1/history?tags=TI-1', 'GET', `Authorization: Bearer ${nodes.tokens.viewer}\r\n`);
    assert.equal(status, 200, 'a renderer passes history requests to the core');
});

test('a follower is routed to its leader\'s node, wherever the follower was', options, async () => {
    const leader = viewers.find(({ node }) => node === 'r1');
    assert.equal(leader.welcome.plant.node, 'r1');
    const { headers } = await get(proxy.port, `/healthz?node=${leader.welcome.plant.node}`, 'GET', 'Cookie: PLANTCAST=r2\r\n');
    const cookie = headers['set-cookie'].split(';')[0];
    assert.equal(cookie, 'PLANTCAST=r1');
    const follower = await PlainClient.open(proxy.port, { headers: [`Cookie: ${cookie}`] });
    follower.say({ type: 'hello', token: nodes.tokens.viewer, width: 160, height: 90, codecs: ['jpeg'] });
    await follower.text('welcome');
    follower.say({ type: 'follow', session: leader.welcome.session });
    assert.equal((await follower.text('following')).session, leader.welcome.session);
    await follower.frameWhere('the leader\'s view', ({ eye }) => Math.abs(eye[0] - leader.eye[0]) < 1e-5);
    follower.close();
});

test('kill -9 of one of two nodes: all sessions are back within 10 s with their views; no acknowledgement is lost', options, async (t) => {
    for (const tag of ['TI-1', 'TI-2', 'PI-1'])
        await nodes.plant.tell(`set ${tag} 95`);
    await until('three alarms', async () => (await standing(core)).filter(({ state }) => state === 'unacknowledged').length === 3);
    const hit = viewers.filter(({ node }) => node === 'r1'), done = [];
    const acknowledge = async (viewer, tag, seq) => {
        for (;;) { // repeats the acknowledgement until it is confirmed, as a user would after the connection was lost
            const { client } = viewer, from = client.texts.length;
            client.say({ type: 'alarm', seq, action: 'acknowledge', alarms: [[tag, 'H']] });
            const answer = await client.until('an answer', ({ texts, closed }) => closed ?? texts.slice(from)
                .find((text) => text.type === 'alarmed' && text.seq === seq));
            if (answer.type === 'alarmed')
                return done.push([tag, answer.done]);
            await until('its return', () => viewer.client !== client);
        }
    };
    const acks = [acknowledge(hit[0], 'TI-1', 1)];
    await until('the first', () => done.length > 0);
    const killed = performance.now();
    acks.push(acknowledge(hit[1], 'TI-2', 2));
    await renderers[0].stop('SIGKILL');
    acks.push(acknowledge(hit[2], 'PI-1', 3));
    await until('all back', () => hit.every(({ returns }) => returns > 0));
    await Promise.all(hit.map((viewer) => viewer.shows()));
    const took_ms = performance.now() - killed;
    t.diagnostic(`${hit.length} of ${viewers.length} sessions back on the other node, each with its view, ` +
        `after ${(took_ms / 1000).toFixed(1)} s`);
    promise(t, 'until all are back', took_ms, BACK_MS);
    assert.ok(hit.every(({ welcome, node }) => welcome.resumed && node === 'r2'));
    assert.equal(new Set(viewers.map(({ welcome }) => welcome.session)).size, viewers.length, 'each session has its own number');
    await Promise.all(acks);
    const anna = ({ state, who }) => state === 'acknowledged' && who === 'anna';
    await until('all acknowledged', async () => (await standing(core)).filter(anna).length === 3);
    const kept = async () => (await (await core.fetch('/api/v1/alarms/journal', nodes.tokens.viewer)).json()).rows
        .filter(({ event }) => event === 'acknowledge').map(({ tag }) => tag).sort().join();
    await until('each in the journal, once', async () => await kept() === 'PI-1,TI-1,TI-2');
    await nodes.onePoller();
});

test('a drained node sends its sessions to the other node one by one, and gets no new ones', options, async (t) => {
    renderers[0] = await start('r1', 0);
    await until('the node being back', async () => /^UP/.test((await proxy.servers()).r1.status));
    const before_ = viewers.map(({ returns }) => returns), began = performance.now();
    renderers[1].program.child.kill('SIGUSR1');
    await until('its word', async () => /^down/.test(await line(renderers[1].agentPort)));
    await until('all elsewhere', () => viewers.every(({ returns, node }, i) => returns > before_[i] && node === 'r1'));
    await Promise.all(viewers.map((viewer) => viewer.shows()));
    const lost = viewers.map(({ lostAt }) => (lostAt - began) / 1000);
    t.diagnostic(`${viewers.length} sessions left from ${Math.min(...lost).toFixed(1)} to ${Math.max(...lost).toFixed(1)} s ` +
        'after it was said');
    assert.ok(Math.max(...lost) - Math.min(...lost) > 4, `the sessions were moved one after the other: ${lost}`);
    assert.ok(viewers.every(({ reason }) => reason === 'this daemon moves its sessions to other daemons; retry after 0 s'));
    await until('the drained node not to be in use', async () => /^DOWN/.test((await proxy.servers()).r2.status));
});

test('a forged resume token or another user\'s restores no view; the user\'s own, unchanged, does', options, async () => {
    // restarts the second renderer, so that it has no views of earlier sessions in memory and must restore them from the token
    await renderers[1].stop();
    renderers[1] = await start('r2', 1);
    const { resume } = viewers[0], [secret, body, mac] = resume.split('.');
    const cases = [[`${secret}.${body}.${mac.replace(/.$/, (c) => (c === '0' ? '1' : '0'))}`, 'operator', false],
        [`${secret}.${body.replace(/^..../, 'eyJ9')}.${mac}`, 'operator', false], [resume, 'viewer', false],
        [`${'0'.repeat(32)}..`, 'operator', false], [resume, 'operator', true]];
    for (const [i, [token, person, restores]] of cases.entries()) {
        const client = await PlainClient.open(renderers[1].port);
        client.say({ type: 'hello', token: nodes.tokens[person], resume: token, width: 160, height: 90, codecs: ['jpeg'] });
        assert.equal((await client.text('welcome')).resumed, restores, `case ${i}`);
        client.close();
    }
});

const isUp = async (name) => /^UP/.test((await proxy.servers())[name].status);
const operatorNamed = (name) => new Operator({ name, port: () => proxy.port, token: nodes.tokens.operator, watched: 'TI-2' });
const nodeOf = ({ jar }) => jar.cookie?.split('=')[1];

// Connects operators with the page's own connection code until each node has two, and changes a reading five times a second.
async function watching(t) {
    for (const viewer of viewers ?? [])
        viewer.leave();
    await until('both nodes up', async () => await isUp('r1') && await isUp('r2'));
    let turn = 0;
    const timer = setInterval(() => nodes.plant.tell(`set TI-2 ${20 + ++turn % 9}`).catch(() => {}), 200), operators = [];
    t.after(() => {
        clearInterval(timer);
        for (const operator of operators)
            operator.leave();
    });
    const count = (name) => operators.filter((one) => nodeOf(one) === name).length;
    while (count('r1') < 2 || count('r2') < 2) {
        const operator = operatorNamed(`operator ${operators.length}`);
        operators.push(operator);
        await until('a live picture', () => operator.frameAt > 0 && operator.sees);
    }
    return operators;
}
const blindMs = (operators, since) => Math.max(...operators.map((operator) => operator.longestBlind(since)));

for (const [what, act, undo] of [
    ['stopped', (i) => renderers[i].program.child.kill('SIGSTOP'), (i) => renderers[i].program.child.kill('SIGCONT')],
    ['cut off the core', (i) => links[i].cut(), (i) => links[i].mend()],
    ['cut off the core without a word', (i) => links[i].freeze(), (i) => links[i].mend()],
])
    test(`a node is ${what}: its operators see the plant again at the other node, and nobody else notices`, options, async (t) => {
        const operators = await watching(t), hit = operators.filter((one) => nodeOf(one) === 'r1'), began = performance.now();
        act(0);
        try {
            await until('all at the other node', () => operators.every((one) => nodeOf(one) === 'r2' && one.sees));
            promise(t, 'operators blind', blindMs(hit, began), BLIND_MS);
            assert.ok(operators.filter((one) => !hit.includes(one)).every(({ visits }) => visits === 1));
        } finally {
            undo(0);
        }
        await until('the node in use', () => isUp('r1'));
    });

test('without a core at any node all sessions stay, and new users get a page; sessions go on when the core is back', options, async (t) => {
    const operators = await watching(t);
    const areDown = async (seconds) => Object.values(await proxy.servers())
        .every(({ status, since_s: since }) => /^DOWN/.test(status) && since >= seconds);
    for (const link of links)
        link.cut();
    await until('six checks without a node in use', () => areDown(6));
    assert.equal((await get(proxy.port, '/readyz?role=render')).status, 200);
    assert.ok(operators.every(({ visits }) => visits === 1));
    const late = operatorNamed('late');
    t.after(() => late.leave());
    await until('a new user', () => late.connection.state === 'open' && late.tags.length > 0);
    for (const link of links)
        link.mend();
    await until('live pictures', () => [...operators, late].every(({ sees }) => sees));
    assert.ok([...operators, late].every(({ visits }) => visits === 1));
});
