// SPDX-License-Identifier: GPL-3.0-or-later
// Time travel (showing recorded instants) with a real daemon and a client written from PROTOCOL.md alone: frames and messages
// contain the values of the chosen instant, and sessions that show the present are unaffected.
import assert from 'node:assert/strict';
import { appendFileSync, existsSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { FLAG, PlainClient } from './support/plain_client.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram, TinyPlant } from './support/tiny_plant.mjs';

const skip = notBuilt();
const BEGIN_S = Math.floor(Date.now() / 1000) - 3600;
const at = (s) => (BEGIN_S + s) * 1e6;
let plant;

// Returns half an hour of samples: TI-1 rises from 10 by 1 per minute; TI-2 is 40, but Bad from minute 10 to 20. Then both get
// the quality "no data".
function series() {
    const lines = ['Tag,Time,Value,Quality'];
    for (let s = 0; s <= 1800; s += 10)
        lines.push(`TI-1,${BEGIN_S + s},${10 + s / 60},Good`);
    for (let s = 0; s <= 1800; s += 10)
        lines.push(s >= 600 && s < 1200 ? `TI-2,${BEGIN_S + s},,0x80050000` : `TI-2,${BEGIN_S + s},40,Good`);
    lines.push(`TI-1,${BEGIN_S + 1801},,0x80310000`, `TI-2,${BEGIN_S + 1801},,0x80310000`);
    return `${lines.join('\n')}\n`;
}

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    appendFileSync(plant.file, 'views:\n- { id: near, view: "camera=3,-2,3,0,0,0,0,0,1,45&at=1" }\n- { id: all, view: "look=default" }\n'
        + 'tours:\n- id: round\n  stops: [{ view: near, dwell_s: 2, text: The first of two \uccab \ubc88\uc9f8 }, '
        + '{ view: all, dwell_s: 3 }]\n');
    assert.equal(plant.prepare().code, 0);
    writeFileSync(join(plant.folder, 'series.csv'), series());
    const imported = runProgram('plantcast', ['history', 'import', plant.file, join(plant.folder, 'series.csv')]);
    assert.equal(imported.code, 0, imported.err);
    await plant.startSim();
    await plant.startDaemon();
});

async function open(fields) {
    const client = await PlainClient.open(plant.port);
    client.welcome = await client.hello(fields);
    return client;
}

async function travel(client, us, speed = 0) {
    client.say({ type: 'time', at_us: us, speed });
    const seen = await client.until('the instant', () => client.texts.find((m) => m.type === 'time' && m.at_us === us));
    await client.frameWhere('of it', (p) => p.flags & FLAG.past && (speed ? p.data_time_us >= us : p.data_time_us === us));
    return seen;
}

const reading = (client, index) => client.texts.filter((m) => m.type === 'tags').flatMap((m) => m.values)
    .findLast((row) => row[0] === index);

test('a new session starts in the present, and is told where history begins', { skip }, async () => {
    const client = await open();
    const time = await client.until('a time with a beginning', () => client.texts.find((m) => m.type === 'time'));
    assert.deepEqual([time.at_us, time.speed], [null, 0]);
    const first = await client.frameWhere('the first');
    assert.equal(first.flags & FLAG.past, 0);
    client.close();
});

test('pictures, tags, markers and picks show the chosen instant, with the qualities of then', { skip }, async () => {
    const client = await open();
    const seen = await travel(client, at(300.5));
    assert.equal(seen.from_us, at(0));
    const tags = await client.until('tags of then', () => client.texts.find((m) => m.type === 'tags' && m.time_us === at(300.5)));
    assert.equal(tags.values.length, 3, 'the tags message has all tags');
    assert.ok(Math.abs(reading(client, 0)[1] - (10 + 300.5 / 60)) < 0.2 && reading(client, 1)[1] === 40);
    assert.deepEqual(reading(client, 2).slice(1, 3), [null, 'bad'], 'a tag that was never recorded has no value');
    client.say({ type: 'fit', seq: 1, id: 'TI-1' });
    const camera = await client.text('camera');
    client.say({ type: 'pick', seq: 2, x: 160.5, y: 90.5, camera });
    const picked = await client.text('picked');
    assert.equal(picked.time_us, at(300.5));
    assert.ok(Math.abs(picked.value - 15) < 0.5, `the picked value is ${picked.value}`);
    await travel(client, at(900));
    await client.until('TI-2 lost', () => reading(client, 1)[2] === 'bad');
    assert.equal(reading(client, 1)[3], 'Bad_CommunicationError');
    assert.equal(reading(client, 1)[4], 300e3, 'the age of a reading lost at minute 10, at minute 15');
    await travel(client, at(1140));
    await client.until('the age at minute 19', () => reading(client, 1)[4] === 540e3);
    await travel(client, at(2400));
    const empty = await client.frameWhere('of the time when nothing ran', (p) => p.data_time_us === at(2400));
    assert.ok(empty.flags & FLAG.noLiveData && empty.oldest_age_ms === 0xffffffff);
    client.close();
});

test('playback runs at its speed, pauses, and returns to the present', { skip }, async () => {
    const client = await open();
    const began = performance.now();
    await travel(client, at(60), 120);
    await client.frameWhere('ten seconds of the past later', (p) => p.flags & FLAG.past && p.data_time_us > at(180));
    const took_s = (performance.now() - began) / 1000, gone_s = client.frames.at(-1).data_time_us / 1e6 - BEGIN_S - 60;
    assert.ok(gone_s <= 120 * took_s + 1, `${gone_s} s of the past played in ${took_s} s`);
    const times = client.frames.filter((p) => p.flags & FLAG.past).map((p) => p.data_time_us);
    assert.deepEqual(times, [...times].sort((a, b) => a - b));
    client.say({ type: 'time', speed: 0 });
    const stood = await client.until('a stand', () => client.texts.findLast((m) => m.type === 'time' && m.at_us && m.speed === 0));
    client.say({ type: 'camera', seq: 9, eye: [5, -6, 4], target: [1, 0, 0] });
    const still = await client.frameWhere('after the pause', (p) => p.camera_seq === 9);
    assert.equal(still.data_time_us, stood.at_us, 'a picture drawn after the pause shows the instant of the pause');
    const before = client.frames.at(-1).seq;
    client.say({ type: 'time', at_us: null });
    const now = await client.frameWhere('of now', (p) => p.seq > before && !(p.flags & FLAG.past));
    assert.ok(now.data_time_us > at(3500));
    client.say({ type: 'time', at_us: at(3500), speed: 3600 });
    await client.until('the instant', () => client.texts.some((m) => m.type === 'time' && m.at_us === at(3500)));
    await client.until('the present', () => client.texts.findLast((m) => m.type === 'time')?.at_us === null &&
        client.frames.at(-1).data_time_us > at(3550) && !(client.frames.at(-1).flags & FLAG.past));
    client.close();
});

test('one session\'s time travel does not affect others, and followers come along', { skip }, async () => {
    const live = await open(), client = await open(), follower = await open();
    follower.say({ type: 'follow', session: client.welcome.session });
    await follower.text('following');
    await live.frameWhere('refined', (p) => p.flags & FLAG.still);
    await travel(client, at(300), 60); // plays back at 60 times the normal speed, which reaches the end of the records after 25 s
    await follower.frameWhere('of then too', (p) => p.flags & FLAG.past && p.data_time_us >= at(300));
    await follower.until('the time', () => follower.texts.find((m) => m.type === 'time' && m.at_us >= at(300) && m.speed === 60));
    const ofThen = (m) => m.type === 'tags' && m.time_us >= at(300) && m.time_us < at(3000);
    await follower.until('tags of then', () => follower.texts.find(ofThen));
    live.say({ type: 'ping', t: 1 });
    await live.until('an answer after them', () => live.texts.some((m) => m.type === 'pong' && m.t === 1));
    assert.ok(live.frames.every((p) => !(p.flags & FLAG.past) && p.data_time_us > at(3000)));
    assert.ok(live.texts.filter((m) => m.type === 'tags').every((m) => m.time_us > at(3000)));
    for (const one of [live, client, follower])
        one.close();
});

test('the same instant is drawn once for all sessions that show it', { skip }, async () => {
    const first = await open(), second = await open();
    // Repeats with other instants until a frame was shared. The server caches a frame for half a second, and on a busy machine
    // the two requests may be farther apart.
    let isShared = false;
    for (let s = 440, end = performance.now() + 90000; s < 1800 && performance.now() < end && !isShared; s++) {
        const before = await plant.metric('plantcast_renders_shared_total');
        await Promise.all([first, second].map((client) => travel(client, at(s))));
        const isThere = (p) => p.flags & FLAG.still && p.data_time_us === at(s);
        await Promise.all([first, second].map((client) => client.frameWhere('refined', isThere)));
        isShared = await plant.metric('plantcast_renders_shared_total') > before;
    }
    assert.ok(isShared);
    first.close();
    second.close();
});

test('a session that starts or reconnects in the past never shows the present', { skip }, async () => {
    const client = await PlainClient.open(plant.port);
    const { resume } = await client.hello({ at_us: at(600) });
    assert.equal((await client.frameWhere('the first')).data_time_us, at(600));
    client.socket.destroy();
    const again = await PlainClient.open(plant.port);
    again.say({ type: 'hello', resume });
    assert.equal((await again.text('welcome')).resumed, true);
    const first = await again.frameWhere('the first again');
    assert.deepEqual([first.data_time_us, first.flags & FLAG.past], [at(600), FLAG.past]);
    again.close();
});

test('invalid time requests are answered with their error codes', { skip }, async () => {
    const client = await open();
    for (const fields of [{}, { at_us: 'noon' }, { at_us: -5 }, { speed: 2 }, { at_us: at(0), speed: 1e9 }]) {
        client.say({ type: 'time', ...fields });
        const error = await client.text('error');
        assert.deepEqual([error.code, error.about], ['bad_field', 'time'], JSON.stringify(fields));
    }
    client.close();
});

test('snapshots, picks and films of the past are correct, and impossible times are refused', { skip, timeout: 280000 }, async () => {
    const url = `http://127.0.0.1:${plant.port}/`, png = join(plant.folder, 'then.png'), film = join(plant.folder, 'then.mp4');
    for (const [query, status] of [[`at=${BEGIN_S + 300}`, 200], ['at=yesterday', 400], ['at=-1s', 400], [`at=${BEGIN_S + 9000}`, 400]])
        assert.equal((await fetch(`${url}snapshot.png?width=64&height=36&${query}`)).status, status, query);
    const options = ['--at', String(BEGIN_S + 300), '-o', png, '--size', '160x90', '--pick', '80,45'];
    const taken = runProgram('plantcast', ['snapshot', url, ...options]);
    assert.equal(taken.code, 0, taken.err);
    assert.equal(JSON.parse(taken.out).time_us, at(300));
    assert.ok(existsSync(png));
    const args = ['--from', String(BEGIN_S), '--to', String(BEGIN_S + 600), '--speed', '300', '--fps', '5', '--size', '160x90'];
    for (const from of [url, plant.file]) {
        const made = runProgram('plantcast', ['clip', from, '-o', film, ...args], 120000);
        if (/without H\.264/.test(made.err))
            return;
        assert.equal(made.code, 0, made.err);
        assert.match(made.out, /11 frames, 2\.2 s/);
        assert.ok(statSync(film).size > 2000);
    }
    const tour = ['--from', String(BEGIN_S), '--fps', '4', '--size', '320x180', '--tour'];
    for (const from of [url, plant.file]) {
        const made = runProgram('plantcast', ['clip', from, '-o', film, ...tour, 'round'], 120000);
        assert.equal(made.code, 0, made.err);
        assert.match(made.out, /20 frames, 5\.0 s/);
        const none = runProgram('plantcast', ['clip', from, '-o', join(plant.folder, 'none.mp4'), ...tour, 'rund']);
        assert.deepEqual([none.code, /no tour 'rund' \(tours: round\)/.test(none.err)], [1, true], none.err);
    }
    const wrong = [
        [...tour, 'round', '--to', '-1h'], [...tour, 'round', '--group', 'x'],
        ['--from', '-1h'], ['--from', '-1h', '--to', '-2h'], ['--from', '-1h', '--to', 'x'],
        [...args, '--fps', '0'], [...args, '--pick', '1,1'],
    ];
    for (const list of wrong)
        assert.equal(runProgram('plantcast', ['clip', url, '-o', film, ...list]).code, 2, list.join(' '));
    const odd = runProgram('plantcast', ['clip', plant.file, '-o', join(plant.folder, 'then.xyz'), ...args]);
    assert.deepEqual([odd.code, /unknown file format/.test(odd.err)], [1, true]);
    const early = runProgram('plantcast', ['clip', plant.file, '-o', film, '--from', String(BEGIN_S - 60), ...args.slice(2)]);
    assert.deepEqual([early.code, /no readings recorded/.test(early.err), existsSync(film)], [1, true, true]);
});

// This test runs last, because it imports a week of older history, which changes the beginning of the recorded time.
test('an imported gap, blanks and state words count as no data in pictures, readings, trends, exports and tables', { skip }, async () => {
    const file = join(plant.folder, 'gap.csv'), from = BEGIN_S - 7 * 86400, day = 86400;
    const rows = [[0, 10], [10, 10], [10, 11], [20, 'I/O Timeout'], [30, 'No Data'], [40, 12], [50, ''], [60, 12], [70, 12], [2 * day, 80],
        [2 * day + 10, 80]];
    writeFileSync(file, `Time,TI-1\n${rows.map(([s, value]) => `${from + s},${value}`).join('\n')}\n`);
    const imported = runProgram('plantcast', ['history', 'import', plant.file, file]);
    assert.equal(imported.code, 0, imported.err);
    assert.match(imported.out, /11 samples of 1 tag .*\nBad samples: 3\nDuplicate times: 1 .*\nGaps without data: 1 \(longer than 100 s\)/);
    const url = `http://127.0.0.1:${plant.port}`, client = await open();
    client.say({ type: 'fit', seq: 1, id: 'TI-1' });
    const camera = await client.text('camera');
    const expected = [[5, 10.5], [25, null], [45, 12], [55, null], [65, 12], [75, null], [day, null], [2 * day - 1, null],
        [2 * day + 5, 80]];
    for (const [i, [s, value]] of expected.entries()) {
        await travel(client, (from + s) * 1e6);
        const severity = value ? undefined : 'bad';
        await client.until(`the reading at ${s} s`, () => reading(client, 0)[1] === value && reading(client, 0)[2] === severity);
        client.say({ type: 'pick', seq: i + 2, x: 160.5, y: 90.5, camera });
        const picked = await client.until('a pick', () => client.texts.find((m) => m.type === 'picked' && m.seq === i + 2));
        assert.ok(value ? Math.abs(picked.value - value) < 0.1 : picked.value === null, `at ${s} s the picked value is ${picked.value}`);
    }
    client.close();
    const answer = await fetch(`${url}/api/v1/history?tags=TI-1&from=${from}&to=${from + 3 * day}&points=50`);
    const { series: [{ points }] } = await answer.json();
    assert.ok(points.every(([, low, high]) => low === null || (high < 13 || low > 79)), JSON.stringify(points));
    const exported = runProgram('plantcast', ['history', 'export', plant.file, '--tags', 'TI-1', '--from', String(from + 65), '--to',
        String(from + 2 * day + 5), '--points', '1000000']);
    assert.match(exported.out, /TI-1,[^,]*,12,0x00000000,°C\r\nTI-1,[^,]*,,0x80310000,°C\r\nTI-1,[^,]*,80,0x00000000/);
    const pick = (source, s) => JSON.parse(runProgram('plantcast', ['snapshot', source, '--at', String(from + s), '-o',
        join(plant.folder, 'gap.png'), '--size', '320x180', '--fit', 'TI-1', '--pick', '160,90']).out).value;
    for (const source of [`${url}/`, plant.file])
        assert.deepEqual([pick(source, 65), pick(source, day)], [12, null], source);

    // A gap that is shorter than --longest-gap counts as recorded: pictures, readings and exports interpolate linearly across
    // it.
    const bring = (name, list, ...more) => {
        writeFileSync(file, `Time,${name}\n${list.map(([s, value]) => `${from + s},${value}`).join('\n')}\n`);
        const brought = runProgram('plantcast', ['history', 'import', plant.file, file, ...more]);
        assert.equal(brought.code, 0, brought.err);
        return brought.out;
    };
    const told = async (tag, first, last) => (await (await fetch(
        `${url}/api/v1/history?tags=${tag}&from=${from + first}&to=${from + last}&points=1000`)).json()).series[0].points;
    assert.match(bring('TI-1', rows, '--longest-gap', '3d'), /samples of 1 tag/);
    const late = day + 3600, middle = 12 + 68 * (late - 70) / (2 * day - 70);
    for (const source of [`${url}/`, plant.file])
        assert.ok(Math.abs(pick(source, late) - middle) < 0.5, `${source}: the value is ${pick(source, late)}, not ${middle}`);
    // within this minute nothing was recorded, so the API returns only the last point before and the first point after it
    const joined = await told('TI-1', day, day + 60);
    assert.deepEqual(joined.map(([, value, quality]) => [value, quality]), [[12, 0], [80, 0]]);

    const without = runProgram('plantcast', ['history', 'export', plant.file, '--tags', 'TI-1', '--from', String(from + 65), '--to',
        String(from + 2 * day + 5), '--points', '1000000']);
    assert.match(without.out, /TI-1,[^,]*,12,0x00000000,°C\r\nTI-1,[^,]*,80,0x00000000/);
    assert.doesNotMatch(without.out, /TI-1,[^,]*,,0x80310000/);

    // The default for the longest gap is ten times the spacing of the samples, but not more than the tag's `Stale s`, which is
    // 1 s for TI-2. So 3.5 s without a sample count as no data.
    const steps = Array.from({ length: 20 }, (_, i) => [i / 2 + (i > 9 ? 3 : 0), 50]);
    assert.match(bring('TI-2', steps), /Gaps without data: 1 \(longer than 1 s\)/);
    assert.ok((await told('TI-2', 0, 12)).some(([us, , quality]) => us === (from + 4.5) * 1e6 + 1 && quality === 0x80310000),
        'the history API has the gap');
    const stale = runProgram('plantcast', ['history', 'export', plant.file, '--tags', 'TI-2', '--from', String(from), '--to',
        String(from + 12), '--points', '1000000']);
    assert.equal(stale.out.match(/TI-2,[^,]*,,0x80310000/g).length, 1, stale.out);
    const at = (s) => JSON.parse(runProgram('plantcast', ['snapshot', plant.file, '--at', String(from + s), '-o',
        join(plant.folder, 'gap.png'), '--size', '320x180', '--fit', 'TI-2', '--pick', '160,90']).out);
    assert.deepEqual([Math.round(at(4).value), at(6).value], [50, null]);
});
