// SPDX-License-Identifier: GPL-3.0-or-later
// Long answers about history: a client that does not read its answer costs the daemon little memory, and a client that requests
// all history repeatedly does not delay other clients.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { connect } from 'node:net';
import { join } from 'node:path';
import { test } from 'node:test';
import { get } from './support/plain_client.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram, TinyPlant } from './support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 240000 };
const TAGS = 64, POINTS = Number(process.env.PLANTCAST_POINTS ?? 4000), BEGIN_S = 1793500000, READERS = 64;
// duration of the measurement; manual runs set it longer, and set PLANTCAST_POINTS higher
const SECONDS = Number(process.env.PLANTCAST_SECONDS ?? 2);
const GREEDY = { localAddress: '127.0.0.2' }, OTHER = { localAddress: '127.0.0.3' };
const names = Array.from({ length: TAGS }, (_, i) => `T-${i + 1}`);
const query = (tags, points) => `/api/v1/history?tags=${tags}&from=${BEGIN_S}&to=${BEGIN_S + POINTS}&points=${points}`;
const all = query(names.join(','), 20000);
let plant;

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    const rows = names.map((name, i) => `${name},${400001 + 2 * i},Float,bar,,pressure,P-101A,3,0,0.5,1`);
    writeFileSync(join(plant.folder, 'tags.csv'),
        ['Tag Name,Address,Data Type,Eng Units,Description,Group,Asset,X,Y,Z,Stale s', ...rows, ''].join('\n'));
    const value = (t, i) => (((t * 7919 + i) * 104729) % 9973 / 1000).toFixed(3);
    const lines = Array.from({ length: POINTS }, (_, t) =>
        [new Date((BEGIN_S + t) * 1000).toISOString(), ...names.map((_, i) => value(t, i))].join());
    writeFileSync(join(plant.folder, 'past.csv'), [['Time', ...names].join(), ...lines, ''].join('\n'));
    assert.equal(plant.prepare().code, 0);
    const { code, err } = runProgram('plantcast', ['history', 'import', plant.file, join(plant.folder, 'past.csv')], 100000);
    assert.equal(code, 0, err);
    await plant.startDaemon('--limit', `address-questions=${READERS}`);
});

const residentMB = () => Number(readFileSync(`/proc/${plant.daemon.child.pid}/status`, 'utf8').match(/VmRSS:\s+(\d+)/)[1]) / 1024;
const head = (path) => `GET ${path} HTTP/1.1\r\nHost: 127.0.0.1:${plant.port}\r\n\r\n`;

async function othersSeconds() {
    const began = performance.now();
    const { status, body } = await get(plant.port, query('T-1', 100), 'GET', '', { ...OTHER, timeoutMs: 60000 });
    assert.equal(status, 200, body.toString());
    assert.equal(JSON.parse(body).series[0].tag, 'T-1');
    return (performance.now() - began) / 1000;
}

test('a history request that lists a tag twice is refused', options, async () => {
    const { status, body } = await get(plant.port, query(Array(64).fill('T-1').join(','), 100));
    assert.equal(status, 400);
    assert.match(body.toString(), /'T-1' is listed twice/);
});

test('a long answer arrives complete, in pieces', options, async () => {
    const url = `http://127.0.0.1:${plant.port}`, answer = await fetch(url + all);
    assert.equal(answer.headers.get('content-length'), null);
    const { series } = await answer.json();
    assert.deepEqual(series.map(({ tag }) => tag), names);
    assert.ok(series.every(({ points }) => points.length > 0.5 * POINTS), String(series.map(({ points }) => points.length)));
    const csv = await (await fetch(`${url}${all}&format=csv`)).text();
    assert.equal(csv.split('Tag,Time').length, 2, 'the CSV has one header line');
    assert.equal((await get(plant.port, all, 'HEAD')).status, 200);
    const old = await new Promise((done) => { // with HTTP/1.0, the server marks the end of the body by closing the connection
        const socket = connect(plant.port, '127.0.0.1', () => socket.write(head(all).replace('1.1', '1.0')));
        let said = '';
        socket.on('data', (bytes) => { said += bytes; });
        socket.on('close', () => done(said));
    });
    assert.equal(JSON.parse(old.slice(old.indexOf('\r\n\r\n'))).series.length, TAGS);
});

test('clients that do not read their answers cost little memory, and do not delay others', options, async (t) => {
    const alone = await othersSeconds(), before = residentMB();
    const readers = Array.from({ length: READERS }, () => {
        const socket = connect({ port: plant.port, host: '127.0.0.1', ...GREEDY }, () => socket.write(head(all)));
        socket.on('error', () => {});
        socket.pause();
        return socket;
    });
    let most = 0, slowest = 0;
    for (const end = performance.now() + SECONDS * 1000; performance.now() < end;) {
        slowest = Math.max(slowest, await othersSeconds());
        most = Math.max(most, residentMB());
    }
    for (const socket of readers)
        socket.destroy();
    console.log(`# ${(most - before).toFixed(0)} MB more for ${READERS} who do not read; ` +
        `another's answer took ${alone.toFixed(2)} s alone, ${slowest.toFixed(2)} s at most`);
    assert.ok(most - before < 256, `memory grew by ${(most - before).toFixed(0)} MB`);
    promise(t, "the slowest answer to another client", 1000 * slowest, 1000 * Math.max(1, 20 * alone));
});

test('a client that constantly requests everything does not delay others', options, async (t) => {
    const alone = await othersSeconds();
    let going = true, had = 0;
    const greedy = Array.from({ length: 8 }, () => new Promise((done) => {
        const socket = connect({ port: plant.port, host: '127.0.0.1', ...GREEDY }, () => socket.write(head(all)));
        socket.on('data', (bytes) => {
            had += bytes.length;
            if (!going)
                socket.destroy();
            // repeats a request that was refused with 503, because the server may not yet have noticed that the earlier
            // connections of this address closed
            else if (bytes.toString('latin1', 0, 12).endsWith(' 503'))
                setTimeout(() => socket.write(head(all)), 200);
            else if (bytes.subarray(-5).toString() === '0\r\n\r\n')
                socket.write(head(all));
        });
        socket.on('error', () => {});
        socket.on('close', done);
    }));
    let slowest = 0;
    for (const end = performance.now() + SECONDS * 750; performance.now() < end || (had <= 1e6 && performance.now() < end + 60000);)
        slowest = Math.max(slowest, await othersSeconds());
    going = false;
    await Promise.all(greedy);
    console.log(`# another's answer took ${alone.toFixed(2)} s alone, ${slowest.toFixed(2)} s at most beside ${(had / 1e6).toFixed(0)} MB`);
    assert.ok(had > 1e6);
    promise(t, 'another\'s answer', 1000 * slowest, 1000 * Math.max(1, 20 * alone));
});
