// SPDX-License-Identifier: GPL-3.0-or-later
// Reloading the plant file and tag list while clients are connected: a reload takes effect completely or, if anything is wrong,
// not at all, and no client is disconnected.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { closeSync, constants, openSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { PlainClient } from './support/plain_client.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
const options = { skip, timeout: 300000 };
const patienceMs = 100000; // timeout of a reload in ms: it takes a second, but longer on a busy machine
let plant, tagsFile, firstTags;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    tagsFile = join(plant.folder, 'tags.csv');
    // A late reading or poll on a busy machine must not look like a gap caused by the reload.
    firstTags = readFileSync(tagsFile, 'utf8').replace('Stale s', 'Stale s,H').replace(/,1$/gm, ',60,');
    // TI-1 gets the high limit -1, so that its alarm is always active
    writeFileSync(tagsFile, firstTags.replace('E-101,0.5,0,0,60,', 'E-101,0.5,0,0,60,-1'));
    writeFileSync(plant.file, `${readFileSync(plant.file, 'utf8').replace('timeout_ms: 300', 'timeout_ms: 10000')}alarms: local\n`);
    await plant.start();
});

const url = (path) => `http://127.0.0.1:${plant.port}${path}`;
const reload = async () => {
    const answer = await fetch(url('/api/v1/reload'), { method: 'POST' });
    return { status: answer.status, ...await answer.json() };
};
const metric = async (name) => (await (await fetch(url('/metrics'))).text()).split('\n').find((line) => line.startsWith(name));
const active = async () => {
    const { alarms } = await (await fetch(url('/api/v1/alarms'))).json();
    return alarms.map(({ tag, kind, state }) => `${tag}/${kind} ${state}`);
};

test('after a failed reload the old plant stays active, and each error is named with its position', options, async () => {
    const before = await (await fetch(url('/api/v1/plant'))).json();
    const good = readFileSync(tagsFile, 'utf8');
    writeFileSync(tagsFile, good.replace('TI-2,400003,Float', 'TI-2,400003,Flaot'));
    const answer = await reload();
    writeFileSync(tagsFile, good);
    assert.equal(answer.status, 422);
    assert.equal(answer.reloaded, false);
    assert.match(answer.errors.join('\n'), /tags\.csv:3:\d+: Data Type: unknown type 'Flaot'/);
    assert.deepEqual((await (await fetch(url('/api/v1/plant'))).json()).plant.configuration, before.plant.configuration);
});

test('a reload reports the changes; sessions, alarms and readings continue', options, async () => {
    const client = await PlainClient.open(plant.port);
    const welcome = await client.hello({});
    client.say({ type: 'params', seq: 1, group: 'temperature', ramp_interval: 10 });
    client.say({ type: 'camera', seq: 1, eye: [5, -6, 4], target: [1, 0, 0] });
    await client.text('alarms');
    for (let i = 0; i < 50 && !(await active()).includes('TI-1/H unacknowledged'); i++)
        await sleep(100);
    client.say({ type: 'alarm', seq: 1, action: 'acknowledge', alarms: [['TI-1', 'H']], name: 'Kim' });
    await client.text('alarmed');
    assert.ok((await active()).includes('TI-1/H acknowledged'));
    const first = welcome.plant.configuration;
    assert.match(first, /^[0-9a-f]{16}$/);
    assert.match(await metric(`plantcast_configuration_info{hash="${first}"}`), / 1$/);

    const limited = readFileSync(tagsFile, 'utf8').replace('P-101A,3,0,0.5,60,', 'P-101A,3,0,0.5,60,9');
    writeFileSync(tagsFile, `${limited}XX-9,400007,Float,bar,spare,,,,,,1,\n`);
    const shown = client.frames.length, answer = await reload();
    assert.equal(answer.status, 200, JSON.stringify(answer));
    assert.deepEqual(answer.changes.sort(), ['tag PI-1: H none > 9', 'tag XX-9 added']);
    assert.equal(answer.before, first);
    const again = await client.text('welcome');
    assert.equal(again.plant.configuration, answer.configuration);
    assert.equal(again.session, welcome.session, 'the session continues after the reload');
    assert.equal(again.view.ramp_interval, 10, 'the view continues after the reload');
    assert.deepEqual(again.tags.map(({ name }) => name), ['TI-1', 'TI-2', 'PI-1', 'XX-9']);
    await client.until('a picture of the new plant', () => client.frames.length > shown);
    assert.ok((await active()).includes('TI-1/H acknowledged'), 'the acknowledgement survives the reload');
    assert.match(await metric(`plantcast_configuration_info{hash="${first}"}`), / 0$/);
    const tags = (await (await fetch(url('/api/v1/tags'))).json()).tags;
    assert.equal(tags.find(({ name }) => name === 'TI-1').quality, 'good');
    client.close();
});

test('a tag that stays has no gap in its history', options, async () => {
    const { series } = await until('a value', async () => {
        const answer = await (await fetch(url('/api/v1/history?tags=TI-1&from=-10m'))).json();
        return answer.series[0].points.some(([, value]) => value !== null) && answer;
    });
    const begins = series[0].points.findIndex(([, value]) => value !== null);
    assert.ok(series[0].points.slice(begins).every(([, value]) => value !== null), JSON.stringify(series[0].points));
});

test('points in a unit that cannot be converted are left out, and return with their unit', options, async () => {
    const files = [[plant.file, readFileSync(plant.file, 'utf8')], [tagsFile, readFileSync(tagsFile, 'utf8')]];
    const series = async () => (await (await fetch(url('/api/v1/history?tags=PI-1&from=-10m'))).json()).series[0];
    const begins = async () => until('a value', async () => (await series()).points.find(([, value]) => value !== null)?.[0]);
    const first = await begins();
    writeFileSync(plant.file, files[0][1].replace('unit: bar', 'unit: psig'));
    writeFileSync(tagsFile, files[1][1].replaceAll(',bar,', ',psig,'));
    const changedUs = Date.now() * 1000;
    assert.equal((await reload()).status, 200);
    const since = await begins();
    assert.equal((await series()).unit, 'psig');
    assert.ok(since >= changedUs, `a point from ${(changedUs - since) / 1e6} s before the change`);
    await plant.daemon.line(/PI-1: \d+ points in 'bar' are left out.* because 'bar' cannot be converted to 'psig'/);
    for (const [path, text] of files)
        writeFileSync(path, text);
    assert.equal((await reload()).status, 200);
    await until('the first points', async () => (await series()).points.some(([t]) => t === first));
    assert.equal((await series()).unit, 'bar');
});

test('a reload is refused by GET and from foreign origins', options, async () => {
    assert.equal((await fetch(url('/api/v1/reload'))).status, 404, 'GET reloads nothing');
    const foreign = await fetch(url('/api/v1/reload'), { method: 'POST', headers: { Origin: 'http://elsewhere.example' } });
    assert.equal(foreign.status, 403);
    assert.equal((await fetch(url('/api/v1/tags'), { method: 'POST' })).status, 405);
});

test('the old picture continues until the new plant has one', options, async (t) => {
    const client = await PlainClient.open(plant.port);
    await client.hello({ width: 1280, height: 720 });
    let seq = 0, welcome = null;
    const turn = setInterval(() => client.say(
        { type: 'camera', seq: ++seq, eye: [5, -6, 4 + 0.5 * Math.sin(seq / 10)], target: [1, 0, 0] }), 16);
    await client.until('pictures', () => client.frames.length >= 10);
    const asked = performance.now();
    plant.daemon.child.kill('SIGHUP');
    await client.until('a welcome', () => (welcome = client.texts.some((m) => m.type === 'welcome') ? performance.now() : null),
        patienceMs);
    const shown = client.frames.length;
    await client.until('pictures of the new plant', () => client.frames.length >= shown + 5);
    clearInterval(turn);
    const times = client.frames.map(({ at }) => at).filter((at) => at > asked);
    const gaps = times.map((at, i) => at - (times[i - 1] ?? asked));
    const longest = Math.max(...gaps), whole = welcome - asked;
    client.close();
    promise(t, `without a picture, in a reload of ${whole.toFixed(0)} ms`, longest, 0.6 * whole);
});

test('repeated reloads by signal, under clients that move, disconnect nobody', options, async () => {
    const clients = await Promise.all([1, 2, 3].map(() => PlainClient.open(plant.port)));
    for (const client of clients)
        await client.hello({});
    const base = readFileSync(tagsFile, 'utf8');
    for (let i = 0; i < 5; i++) {
        writeFileSync(tagsFile, base.replace('XX-9', `XX-${i}`));
        plant.daemon.child.kill('SIGHUP');
        for (let k = 1; k <= 20; k++) {
            for (const client of clients)
                client.say({ type: 'camera', seq: 100 * i + k, eye: [5, -6, 4 + 0.05 * k], target: [1, 0, 0] });
            await sleep(25);
        }
        for (const client of clients)
            await client.until('a welcome', () => client.texts.some((m) => m.type === 'welcome'), patienceMs);
        for (const client of clients)
            client.texts = client.texts.filter((m) => m.type !== 'welcome');
    }
    for (const client of clients) {
        const shown = client.frames.length;
        client.say({ type: 'camera', seq: 9999, eye: [6, -6, 4], target: [1, 0, 0] });
        await client.until('a picture in the end', () => client.frames.length > shown);
        client.close();
    }
});

// The tag list is replaced by a named pipe: reading it blocks until a writer opens the pipe, so the test decides when the
// reload ends.
test('a client whose answer takes too long gets an error, and can ask again', options, async (t) => {
    const other = await TinyPlant.create(), tags = join(other.folder, 'tags.csv'), aside = join(other.folder, 'aside.csv');
    t.after(() => other.destroy());
    const ask = () => fetch(`http://127.0.0.1:${other.port}/api/v1/reload`, { method: 'POST' });
    assert.equal(other.prepare().code, 0);
    await other.startDaemon('--limit', 'answer-wait=1');
    renameSync(tags, aside);
    assert.equal(spawnSync('mkfifo', [tags]).status, 0);
    const late = await ask();
    assert.equal(late.status, 503);
    assert.equal(late.headers.get('retry-after'), '2');
    assert.match(await late.text(), /^no answer within 1 s \(.*\); try again$/m);
    assert.equal((await fetch(`http://127.0.0.1:${other.port}/api/v1/plant`)).status, 200);
    const pipe = join(other.folder, 'pipe');
    renameSync(tags, pipe);
    renameSync(aside, tags);
    // the blocked reload, and requests that joined it, fail because the pipe is empty; the loop repeats the request until
    // one reads the restored list
    let again;
    for (let i = 0; i < 100 && again?.status !== 200; i++) {
        try {
            // opens the pipe for writing, which lets a reload that waits for it go on
            closeSync(openSync(pipe, constants.O_WRONLY | constants.O_NONBLOCK));
        } catch (error) {
            assert.equal(error.code, 'ENXIO'); // ENXIO: no reload has the pipe open for reading, so none is blocked
        }
        again = await ask();
    }
    assert.equal(again.status, 200, await again.text());
});
