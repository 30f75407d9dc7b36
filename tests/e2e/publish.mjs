// SPDX-License-Identifier: GPL-3.0-or-later
// Readings and alarms are published to Debian's mosquitto, and from there reach another Plantcast.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { Broker, missingBroker } from './support/broker.mjs';
import { PublishedPlant } from './support/published_plant.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until as waitFor } from './support/until.mjs';

const options = { skip: notBuilt() || (missingBroker() ?? false), timeout: 240000 };
const PREFIX = 'plantcast/two boxes';
let broker, plant, other, client, heard, publications, started;

setUp(options.skip, async () => {
    broker = await Broker.start();
    plant = await TinyPlant.create();
    plant.giveDeviceTime();
    writeFileSync(join(plant.folder, 'tags.csv'), `Tag Name,Address,Data Type,Eng Units,Group,Asset,X,Y,Z,Stale s,H
TI-1,400001,Float,°C,temperature,E-101,0.5,0,0,600,90
TI/2#a,400003,Float,°C,temperature,E-101,-0.5,0,0,600,
PI-1,400005,Float,bar,pressure,P-101A,3,0,0.5,600,
`);
    writeFileSync(plant.file, `${readFileSync(plant.file, 'utf8')}publish:
  { host: 127.0.0.1, port: ${broker.port}, prefix: ${PREFIX}, every_s: 0.2, keepalive_s: 5 }
`);
    const prepared = plant.prepare();
    assert.equal(prepared.code, 0, prepared.err);
    await plant.startSim();
    await plant.tell('set TI-1 21.5');
    started = Date.now();
    await plant.startDaemon();
    await listen();
});
after(async () => {
    client?.end(true);
    await other?.destroy();
    await plant?.destroy();
    await broker?.destroy();
});

// Subscribes to all topics and records, from now on, the newest payload of each topic (heard) and the number of messages.
async function listen() {
    client?.end(true);
    heard = {};
    publications = 0;
    client = await broker.client();
    client.on('message', (topic, payload) => { heard[topic] = payload.toString(); publications++; });
    await new Promise((done, fail) => client.subscribe('#', (error) => (error ? fail(error) : done())));
}

const until = (what, ask) => waitFor(what, ask, 90, () => `heard ${JSON.stringify(heard)}`);
const tag = (name) => JSON.parse(heard[`${PREFIX}/tags/${name}`] ?? '{}');

test('values are published with time, quality and unit, each tag in a topic of one level', options, async () => {
    const topics = ['alarms', 'state', 'tags/PI-1', 'tags/TI%2F2%23a', 'tags/TI-1'];
    await until('a value, and all topics', () => tag('TI-1').value === 21.5 && Object.keys(heard).length >= topics.length);
    assert.deepEqual([tag('TI-1').quality, tag('TI-1').unit, heard[`${PREFIX}/state`]], [0, '°C', 'online']);
    const time = Date.parse(tag('TI-1').time);
    assert.ok(time > started - 1000 && time < Date.now() + 1000, tag('TI-1').time);
    assert.deepEqual(Object.keys(heard).sort(), topics.map((name) => `${PREFIX}/${name}`));
    await plant.tell('fail PI-1');
    await until('Bad', () => tag('PI-1').value === null && tag('PI-1').quality >>> 30 === 2);
    await plant.tell('release PI-1');
    await until('Good', () => tag('PI-1').quality === 0);
});

test('all active alarms are published, and none once they have ended', options, async () => {
    const alarms = () => JSON.parse(heard[`${PREFIX}/alarms`] ?? '{}').alarms;
    await until('no alarm', () => alarms()?.length === 0);
    await plant.tell('set TI-1 95.5');
    await until('an alarm', () => alarms()?.length === 1);
    const { tag: name, kind, limit, value } = alarms()[0];
    assert.deepEqual([name, kind, limit, value], ['TI-1', 'H', 90, 95.5]);
    await plant.tell('set TI-1 50');
    await until('none', () => alarms()?.length === 0);
});

test('publishing sends the newest value, and does not exceed the configured rate', options, async () => {
    publications = 0;
    const began = performance.now();
    for (let i = 0; i < 40; i++) {
        await plant.tell(`set TI-1 ${i}`);
        await sleep(50);
    }
    assert.ok(publications <= 3 * (performance.now() - began) / 200 + 6, `${publications} messages were published`);
    await until('the last', () => tag('TI-1').value === 39);
});

test('another Plantcast shows the published values with the same qualities and times', options, async () => {
    other = await PublishedPlant.create(broker);
    const rows = ['TI-1,,,°C,temperature,E-101,0.5,0,0,600,,,,,', 'PI-1,,,bar,pressure,P-101A,3,0,0.5,600,,,,,',
        `TI-2,${PREFIX}/tags/TI%2F2%23a,,°C,temperature,E-101,-0.5,0,0,600,,,,,`];
    await other.run(`payload: json, topic: "${PREFIX}/tags/{tag}", time: time, quality: quality`, rows);
    await plant.tell('set TI-1 77.25');
    await other.until('TI-1', { quality_name: 'Good', value: 77.25 });
    await other.until('TI-2', { quality_name: 'Good' });
    await plant.tell('fail TI-1');
    const url = `http://127.0.0.1:${plant.port}/api/v1/tags?count=9`;
    const here = async () => (await (await fetch(url)).json()).tags.find(({ name }) => name === 'TI-1');
    await until('Bad', async () => !(await here()).quality_name.startsWith('Good'));
    await until('the same quality', async () => (await other.tags())['TI-1'].quality_name === (await here()).quality_name);
    await plant.tell('release TI-1');
    await other.until('TI-1', { quality_name: 'Good' });
});

test('a value that replaces another of the same time is published', options, async () => {
    const late = await PublishedPlant.create(broker);
    const keys = 'payload: json, topic: "in/{tag}", time: t', rows = ['A,,,°C,temperature,E-101,0.5,0,0,60,,,,,'];
    late.write(keys, rows);
    writeFileSync(late.file, `${readFileSync(late.file, 'utf8')}publish:
  { host: 127.0.0.1, port: ${broker.port}, prefix: plantcast/late, every_s: 0.2, keepalive_s: 5 }
`);
    try {
        assert.equal(late.plant.prepare().code, 0);
        await late.plant.startDaemon();
        await late.daemon.line(/source broker: .*: reading/);
        const t = Math.floor(Date.now() / 1000);
        for (const value of [10, 11]) {
            client.publish('in/A', JSON.stringify({ value, t }));
            await until(`A ${value}`, () => JSON.parse(heard['plantcast/late/tags/A'] ?? '{}').value === value);
        }
    } finally {
        await late.destroy();
    }
});

test('a broker that restarts receives all values again; a killed daemon is shown as offline', options, async () => {
    await broker.restart();
    await plant.daemon.line(/publish: .*: not publishing: /);
    await listen();
    await until('all', () => heard[`${PREFIX}/state`] === 'online' && tag('TI-1').quality === 0 && heard[`${PREFIX}/alarms`]);
    await plant.daemon.stop('SIGKILL');
    await until('offline', () => heard[`${PREFIX}/state`] === 'offline');
    await plant.startDaemon();
    await until('online', () => heard[`${PREFIX}/state`] === 'online');
    await plant.daemon.stop();
    await until('offline at its end', () => heard[`${PREFIX}/state`] === 'offline');
});

test('a topic prefix on which devices may listen is refused', options, () => {
    const text = readFileSync(plant.file, 'utf8');
    for (const prefix of ['plc1/write', 'plantcast/#', 'plantcast/']) {
        writeFileSync(plant.file, text.replace(`prefix: ${PREFIX}`, `prefix: "${prefix}"`));
        const { err } = runProgram('plantcastd', ['--check', plant.file]);
        assert.match(err, /error: prefix: expected a topic such as plantcast\/unit100, found/);
    }
});
