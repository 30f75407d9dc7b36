// SPDX-License-Identifier: GPL-3.0-or-later
// 20,000 tags through the whole daemon: read once a second, shown, recorded, and served in pages. A page of tags is complete
// and in order, other clients are served meanwhile, and losing the tags' device raises one alarm.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { PlainClient } from './support/plain_client.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const options = { skip: notBuilt(), timeout: 280000 };
const MANY = 20000;
const name = (i) => `X-${String(i).padStart(5, '0')}`;
let plant;

// Sets up 20,000 tags on one device, each with a high limit, in registers from 400101 on, which nearly fill the table of
// 65,536. The registers below belong to the tiny plant's own tags.
setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    const file = join(plant.folder, 'tags.csv'), tiny = readFileSync(file, 'utf8').replace('Stale s', 'Stale s,H');
    const lines = Array.from({ length: MANY }, (_, i) => `${name(i)},${400101 + i},Short,bar,spare,,,,,,3,30000`);
    writeFileSync(file, `${tiny.replace(/,1$/gm, ',3,')}${lines.join('\n')}\n`);
    writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace('poll_ms: 100', 'poll_ms: 1000'));
    const prepared = plant.prepare();
    assert.equal(prepared.code, 0, prepared.err);
    await plant.startSim();
    await plant.startDaemon();
});

const get = async (path) => {
    const response = await fetch(`http://127.0.0.1:${plant.port}${path}`);
    assert.equal(response.status, 200, path);
    return response.json();
};

async function pages(count) {
    const tags = [];
    for (let first = 0; ; first += count) {
        const page = await get(`/api/v1/tags?first=${first}&count=${count}`);
        assert.deepEqual([page.total, page.first], [MANY + 3, first]);
        tags.push(...page.tags);
        if (page.tags.length < count)
            return tags;
    }
}

test('pages of tags contain every tag once, in order, with its register\'s value', options, async () => {
    await until('all are good', async () => (await pages(5000)).every(({ quality }) => quality === 'good'));
    for (const count of [1000, 4096]) {
        const tags = await pages(count);
        assert.deepEqual(tags.slice(3).map((tag) => tag.name), Array.from({ length: MANY }, (_, i) => name(i)));
        assert.ok(tags.every(({ quality, value, age_ms: age }) => quality === 'good' && value !== null && age < 60000));
    }
    assert.equal((await get('/api/v1/tags')).tags.length, 1000, 'the default page has 1000 tags');
    assert.deepEqual((await get(`/api/v1/tags?first=${MANY + 3}`)).tags, [], 'a page beyond the last tag is empty');
    for (const query of ['count=5001', 'count=0', 'first=-1', 'first=x', 'page=2'])
        assert.equal((await fetch(`http://127.0.0.1:${plant.port}/api/v1/tags?${query}`)).status, 400, query);
});

test('while one client reads pages of tags, others get pictures and all tags', options, async () => {
    const client = await PlainClient.open(plant.port);
    const welcome = await client.hello({});
    assert.equal(welcome.tags.length, MANY + 3);
    await client.frameWhere('the first');
    let asking = true;
    const asked = (async () => {
        while (asking)
            await pages(5000);
    })();
    const shown = client.frames.length;
    for (let i = 0; i < 10; i++) {
        client.say({ type: 'camera', seq: i + 1, eye: [5, -6, 3 + 0.2 * i], target: [1, 0, 0] });
        await sleep(100);
    }
    await client.until('pictures between the pages', () => client.frames.length > shown + 2);
    asking = false;
    await asked;
    client.close();
});

test('the loss of the tags\' device raises one alarm, is in the journal of each tag, and ends when the device is back',
    options, async () => {
    const counts = async () => (await get('/api/v1/alarms?limit=1')).counts;
    await plant.sim.stop('SIGKILL');
    await until('all are carried', async () => (await counts()).states.suppressed === MANY);
    const { alarms, counts: { active } } = await get('/api/v1/alarms?limit=10000');
    const seen = alarms.filter(({ state }) => state !== 'suppressed').map(({ tag, kind }) => [tag, kind]);
    assert.equal(active, 1);
    assert.ok(seen.length === 0 || (seen.length === 1 && seen[0].join() === 'plc1,LINK'), JSON.stringify(seen));
    const isCarried = ({ kind, state, reason }) => kind === 'BAD' && state === 'suppressed' && reason === 'plc1';
    await until('all are journalled', async () => {
        const { rows } = await get('/api/v1/alarms/journal?limit=10000');
        return rows.filter(isCarried).length > 9000;
    });
    await plant.startSim();
    await until('it is over', async () => (await counts()).states.suppressed === 0 && (await counts()).active === 0);
    await until('its own changes are journalled, by its name', async () => {
        const { rows } = await get('/api/v1/alarms/journal?tag=plc1');
        return rows.length >= 2 && rows.every(({ tag, kind }) => tag === 'plc1' && kind === 'LINK');
    });
    const unknown = await fetch(`http://127.0.0.1:${plant.port}/api/v1/alarms/journal?tag=plc9`);
    assert.equal(unknown.status, 400);
    assert.match(await unknown.text(), /this plant has no tag “plc9”/);
});
