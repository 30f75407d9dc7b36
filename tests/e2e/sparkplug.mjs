// SPDX-License-Identifier: GPL-3.0-or-later
// Sparkplug B with Debian's mosquitto and the Eclipse project's client: births, deaths, aliases, types, gaps and rebirths; and
// a node and a broker that are killed.
import assert from 'node:assert/strict';
import { afterEach, test } from 'node:test';
import sparkplug from 'sparkplug-client';
import payloads from 'sparkplug-payload';
import { Broker, missingBroker } from './support/broker.mjs';
import { promise } from './support/promise.mjs';
import { PublishedPlant } from './support/published_plant.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, sleep } from './support/tiny_plant.mjs';
import { until as waitFor } from './support/until.mjs';

const options = { skip: notBuilt() || (missingBroker() ?? false), timeout: 240000 };
const encode = (payload) => Buffer.from(payloads.get('spBv1.0').encodePayload(payload));
const ROWS = ['TI-1,U100/edge#Inlet/Temperature,,°C,temperature,E-101,0.5,0,0,,,,,,',
    'TI-2,U100/edge/skid#TI-2,,°C,temperature,E-101,-0.5,0,0,,,,,,',
    'PI-1,U100/edge/skid#Raw,,bar,pressure,P-101A,3,0,0.5,,Linear,0,27648,0,10', 'XS-1,U100/edge/skid#Running,bool,,,,,,,,,,,,'];
const good = { quality_name: 'Good' }, dead = { quality_name: 'Bad_CommunicationError', value: null };
let broker, plant, nodes = [];
const until = (...args) => plant.until(...args), metric = (name) => plant.metric(`${name}{source="broker"}`);

// Starts a Sparkplug edge node with one device. node.births counts the birth certificates that it has published.
async function startNode(more = {}) {
    const node = sparkplug.newClient({ serverUrl: `mqtt://127.0.0.1:${broker.port}`, username: '', password: '', groupId: 'U100',
        edgeNode: 'edge', clientId: `edge${Math.random()}`, ...more });
    nodes.push(node);
    node.births = 0;
    node.bear = () => {
        node.births++;
        node.publishNodeBirth({ timestamp: Date.now(), metrics: [
            { name: 'Node Control/Rebirth', type: 'Boolean', value: false },
            { name: 'Inlet/Temperature', alias: 1, type: 'Double', value: 20.5 }] });
        node.publishDeviceBirth('skid', { timestamp: Date.now(), metrics: [
            { name: 'TI-2', alias: 2, type: 'Float', value: -7.5, timestamp: Date.now() - 2000 },
            { name: 'Raw', alias: 3, type: 'UInt16', value: 13824 },
            { name: 'Running', alias: 4, type: 'Boolean', value: true },
            { name: 'Other', alias: 5, type: 'String', value: 'text' }] });
    };
    node.on('ncmd', ({ metrics }) => {
        if (metrics.some(({ name, value }) => name === 'Node Control/Rebirth' && value === true))
            node.bear();
    });
    await new Promise((done) => node.once('birth', done));
    node.bear();
    node.on('birth', node.bear);
    return node;
}

async function allDead(...names) {
    for (const name of names)
        await until(name, dead);
}

// Closes the node's connection without a DISCONNECT message, so that the broker publishes the node's death certificate.
const kill = (node) => node.client.stream.destroy();

setUp(options.skip, async (own) => {
    broker = own(await Broker.start());
    plant = own(await PublishedPlant.create(broker));
});
afterEach(async () => {
    await plant?.daemon?.stop();
    nodes.forEach((node) => node.client.end(true));
    nodes = [];
    await broker?.restart();
});

test('births and data of every number type are read, by name and by alias', options, async () => {
    await plant.run('payload: sparkplug', ROWS);
    const began = Date.now(), node = await startNode();
    await until('TI-1', { ...good, value: 20.5 });
    const older = await until('TI-2', { ...good, value: -7.5 });
    assert.ok(older.age_ms >= 2000 && older.age_ms <= 2000 + Date.now() - began + 1, `the reading is ${older.age_ms} ms old`);
    await until('PI-1', { ...good, value: 5 });
    await until('XS-1', { ...good, value: 1 });
    node.publishNodeData({ timestamp: Date.now(), metrics: [{ alias: 1, type: 'Double', value: 21.25 }] });
    node.publishDeviceData('skid', { timestamp: Date.now(), metrics: [{ alias: 4, type: 'Boolean', value: false },
        { name: 'TI-2', type: 'Float', value: 3.5, properties: { Quality: { type: 'Int32', value: 500 } } },
        { alias: 3, type: 'UInt16', value: 0, isHistorical: true }, { alias: 5, type: 'String', value: 'more' }] });
    await until('TI-1', { ...good, value: 21.25 });
    await until('XS-1', { ...good, value: 0 });
    await until('TI-2', { quality_name: 'Uncertain_NoCommunicationLastUsableValue', value: 3.5 });
    await until('PI-1', { ...good, value: 5 }); // PI-1 keeps its value: the metric marked as historical must not change it
    assert.equal(await metric('historical_total'), 1);
    node.publishDeviceData('skid', { timestamp: Date.now(), metrics: [{ alias: 3, type: 'UInt16', value: null, isNull: true },
        { alias: 4, type: 'Boolean', value: true, properties: { Quality: { type: 'Int32', value: 0 } } }] });
    await until('PI-1', { quality_name: 'Bad_SensorFailure' });
    await until('XS-1', { quality: 'bad' });
    // The device's aliases begin at 1 and so repeat those of its node, although Sparkplug demands unique aliases within a node:
    // both must still be read correctly.
    node.publishDeviceBirth('skid', { timestamp: Date.now(), metrics: [{ name: 'TI-2', alias: 1, type: 'Float', value: 4 },
        { name: 'Raw', alias: 2, type: 'UInt16', value: 13824 }, { name: 'Running', alias: 3, type: 'Boolean', value: true }] });
    node.publishNodeData({ timestamp: Date.now(), metrics: [{ alias: 1, type: 'Double', value: 22.5 }] });
    node.publishDeviceData('skid', { timestamp: Date.now(), metrics: [{ alias: 1, type: 'Float', value: 5.5 }] });
    await until('TI-1', { ...good, value: 22.5 });
    await until('TI-2', { ...good, value: 5.5 });
    assert.equal(await metric('gaps_total'), 0);
    assert.equal(await metric('rebirths_total'), 0);
});

test('the death of a device or a node makes all its tags Bad at once', options, async (t) => {
    await plant.run('payload: sparkplug', ROWS);
    // reconnectPeriod 0: the node does not reconnect by itself after it has been killed
    const node = await startNode({ mqttOptions: { reconnectPeriod: 0 } });
    await until('XS-1', { ...good, value: 1 });
    let died = performance.now();
    node.publishDeviceDeath('skid', { timestamp: Date.now() });
    await allDead('TI-2', 'PI-1', 'XS-1');
    promise(t, 'until the tags of the device are Bad', performance.now() - died, 1000);
    await until('TI-1', good);
    node.bear();
    await until('XS-1', { ...good, value: 1 });
    died = performance.now();
    kill(node);
    await allDead('TI-1', 'TI-2', 'PI-1', 'XS-1');
    promise(t, 'until the tags of the node are Bad', performance.now() - died, 1000);
    node.client.reconnect();
    await until('TI-1', { ...good, value: 20.5 });
});

// The connection of a reloaded daemon is a new one, which may have missed messages.
test('after a reload, tags are Bad until the next birth certificate', options, async () => {
    await plant.run('payload: sparkplug', ROWS);
    const node = await startNode();
    await until('XS-1', { ...good, value: 1 });
    await plant.reload();
    node.publishDeviceData('skid', { timestamp: Date.now(), metrics: [{ alias: 4, type: 'Boolean', value: false }] });
    await plant.daemon.line(/node U100\/edge: values ignored, because the node has not sent a Sparkplug birth certificate yet/);
    await allDead('TI-1', 'TI-2', 'PI-1', 'XS-1');
    node.bear();
    await until('TI-1', { ...good, value: 20.5 });
    await until('XS-1', { ...good, value: 1 });
    await plant.reload();
    kill(node);
    await allDead('TI-1', 'TI-2', 'PI-1', 'XS-1');
});

test('an old death certificate is ignored', options, async () => {
    await plant.run('payload: sparkplug', ROWS);
    const node = await startNode();
    await until('XS-1', { ...good, value: 1 });
    const late = await broker.client();
    const death = (bdSeq) => encode({ timestamp: Date.now(), metrics: [{ name: 'bdSeq', type: 'UInt64', value: bdSeq }] });
    await late.tell('spBv1.0/U100/NDEATH/edge', death(node.bdSeq + 1));
    await plant.daemon.line(/U100\/edge: an old Sparkplug death certificate \(bdSeq 1; the birth certificate has 0\) is ignored/);
    await until('TI-1', good);
    await late.tell('spBv1.0/U100/NDEATH/edge', death(node.bdSeq));
    await until('TI-1', dead);
    await late.leave();
});

test('a lost message leaves no value Good; the node is asked for a rebirth only where that is permitted', options, async () => {
    for (const rebirth of ['no', 'yes']) {
        await plant.run(`payload: sparkplug, rebirth: ${rebirth}`, ROWS);
        const node = await startNode();
        await until('XS-1', { ...good, value: 1 });
        const births = node.births;
        node.seq += 3;
        node.publishNodeData({ timestamp: Date.now(), metrics: [{ alias: 1, type: 'Double', value: 30 }] });
        if (rebirth === 'no')
            for (const [name, value] of [['TI-2', -7.5], ['PI-1', 5], ['XS-1', 1]])
                await until(name, { quality_name: 'Uncertain_LastUsableValue', value });
        await plant.daemon.line(/node U100\/edge: Sparkplug messages were lost: received sequence number 5, expected 2/);
        if (rebirth === 'yes')
            await waitFor('a request for its birth', () => node.births > births);
        await until('TI-1', { ...good, value: rebirth === 'no' ? 30 : 20.5 });
        await until('XS-1', { quality_name: rebirth === 'no' ? 'Uncertain_LastUsableValue' : 'Good', value: 1 });
        assert.equal(await metric('gaps_total'), 1);
        await plant.daemon.stop();
        // the broker sends this command to the node after those of the daemon, which has disconnected
        const later = await broker.client(), isThere = new Promise((done) => node.once('ncmd', done));
        await later.tell('spBv1.0/U100/NCMD/edge', encode({ timestamp: Date.now(), metrics: [] }));
        await isThere;
        await later.leave();
        assert.equal(node.births > births, rebirth === 'yes');
        const closed = new Promise((done) => node.client.once('close', done));
        node.stop();
        // waits until the node is disconnected, so that its death certificate does not arrive after the next node's birth
        // certificate
        await closed;
    }
});

test('a node born before the daemon connected is read once its birth certificate is known', options, async () => {
    const node = await startNode(), stranger = await broker.client();
    await stranger.tell('spBv1.0/U100/NBIRTH/edge', encode({ seq: 0, metrics: [{ name: 'Inlet/Temperature', type: 'Double', value: 9 }] }),
        { retain: true });
    await plant.run('payload: sparkplug', ROWS);
    await plant.daemon.line(/NBIRTH\/edge: a message of \d+ bytes was refused: retained messages are ignored, because they may be old/);
    await stranger.tell('spBv1.0/U100/NBIRTH/edge', '', { retain: true });
    await stranger.leave();
    node.publishNodeData({ timestamp: Date.now(), metrics: [{ name: 'Inlet/Temperature', type: 'Double', value: 30 }] });
    await plant.daemon.line(new RegExp('node U100/edge: values ignored, because the node has not sent a Sparkplug birth certificate ' +
        'yet; `rebirth: yes` requests it'));
    await until('TI-1', { quality_name: 'Bad_WaitingForInitialData' });
    await plant.daemon.stop();
    await plant.run('payload: sparkplug, rebirth: yes', ROWS);
    await until('XS-1', { ...good, value: 1 });
    assert.equal(node.births, 2);
});

test('the broker is killed and restarts; node and tags recover', options, async () => {
    await plant.run('payload: sparkplug, rebirth: yes', ROWS);
    await startNode({ mqttOptions: { reconnectPeriod: 200 } });
    await until('XS-1', { ...good, value: 1 });
    await broker.kill();
    await allDead('TI-1', 'TI-2', 'PI-1', 'XS-1');
    await broker.restart();
    await until('XS-1', { ...good, value: 1 });
    await until('TI-1', good);
});

test('invalid Sparkplug payloads, and metrics that change their type, are refused by name', options, async () => {
    await plant.run('payload: sparkplug', ROWS);
    const node = await startNode();
    await until('XS-1', { ...good, value: 1 });
    const stranger = await broker.client();
    const refused = async (count) => {
        const name = 'messages_total{source="broker",result="refused"}';
        for (const end = performance.now() + 60000; await plant.metric(name) < count; await sleep(20))
            assert.ok(performance.now() < end, `not all ${count} messages were refused`);
    };
    await stranger.tell('spBv1.0/U100/NDATA/edge', Buffer.from([0xff, 0xff, 0xff, 0xff, 0x0f, 1, 2, 3]));
    await plant.daemon.line(/NDATA\/edge: a message of 8 bytes was refused: not a Sparkplug B payload/);
    await stranger.tell(`spBv1.0/U100/DDATA/edge/${'x'.repeat(65000)}`, encode({ metrics: [] }));
    // checks the counter of refused messages: the log would not do, because it has at most one line per minute about them
    await refused(2);
    await stranger.tell('spBv1.0/U100/NDATA/edge', Buffer.alloc(5 << 20)).catch(() => {});
    await stranger.leave();
    node.bear();
    await until('TI-1', { ...good, value: 20.5 });
    node.publishDeviceData('skid', { timestamp: Date.now(), metrics: [{ alias: 2, type: 'Int32', value: 5 },
        { alias: 4, type: 'Boolean', value: false }] });
    await until('TI-2', { quality_name: 'Bad_ConfigurationError' });
    await until('XS-1', { ...good, value: 0 });
    await refused(3);
    node.publishDeviceBirth('skid', { timestamp: Date.now(), metrics: [{ name: 'TI-2', type: 'Int32', value: -5 }] });
    // although PI-1's metric is missing in it, this new birth certificate of the device is accepted for TI-2
    await until('TI-2', { ...good, value: -5 });
    await until('PI-1', { quality_name: 'Bad_ConfigurationError' });
    await plant.daemon.line(/U100\/edge\/skid: the Sparkplug birth certificate has no metric 'Raw', nor metrics of other tags/);
    // after a gap, the tags without a metric do not get the values of the earlier birth certificate back
    node.seq += 3;
    node.publishNodeData({ timestamp: Date.now(), metrics: [{ alias: 1, type: 'Double', value: 30 }] });
    await until('TI-1', { ...good, value: 30 });
    await until('TI-2', { quality_name: 'Uncertain_LastUsableValue', value: -5 });
    for (const name of ['PI-1', 'XS-1'])
        assert.equal((await plant.tags())[name].quality_name, 'Bad_ConfigurationError', name);
});

// A node sends 4,000 metrics five times a second, split into messages of `each` metrics.
for (const each of [4000, 40])
    test(`20,000 metrics a second, ${each} in a message, all arrive`, options, async () => {
        const MANY = 4000, SECONDS = 4, name = (i) => `N-${i}`;
        const numbers = Array.from({ length: MANY }, (_, i) => i);
        await plant.run('payload: sparkplug', [ROWS[0], ...numbers.map((i) => `${name(i)},U100/edge#${name(i)},,,,,,,,,,,,,`)]);
        const node = await startNode();
        const born = numbers.map((i) => ({ name: name(i), alias: i, type: 'Float', value: -1 }));
        node.publishNodeBirth({ timestamp: Date.now(), metrics: born });
        await until(name(MANY - 1), { ...good, value: -1 });
        const own = 1; // number of metrics in the birth certificate of startNode() that belong to a tag of this plant
        await waitFor('all births being counted', async () => await metric('samples_total') >= MANY + own);
        const before = await metric('samples_total'), begun = performance.now();
        let sent = 0, round = 0;
        for (; round < 5 * SECONDS; round++) {
            for (let first = 0; first < MANY; first += each) {
                const metrics = numbers.slice(first, first + each).map((i) => ({ alias: i, type: 'Float', value: (i + round) % 1000 }));
                node.publishNodeData({ timestamp: Date.now(), metrics });
                sent += each;
            }
            await sleep(Math.max(0, begun + (round + 1) * 200 - performance.now()));
        }
        const seconds = (performance.now() - begun) / 1000;
        await until(name(MANY - 1), { ...good, value: (MANY + round - 2) % 1000 });
        const caught = (performance.now() - begun) / 1000;
        await waitFor('all being counted', async () => await metric('samples_total') - before >= sent);
        assert.equal(await metric('samples_total') - before, sent);
        assert.equal(await metric('gaps_total'), 0);
        const rate = Math.round(sent / seconds);
        console.log(`${sent} metrics sent in ${seconds.toFixed(2)} s (${rate} a second), read after ${caught.toFixed(2)} s`);
    });
