// SPDX-License-Identifier: GPL-3.0-or-later
// Recorded history in charts and the time slider: lines with gaps and spikes, alarms and ticks; and a session that shows the past.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { residuals, stretches } from '../../clients/web/app/cards/drift.js';
import { readAddress, writeAddress } from '../../clients/web/core/address.js';
import {
    arrowS, ask, BAD, clustered, gaps, limitLines, line, lost, nextTo, raised, ticks, UNCERTAIN, witnesses,
} from '../../clients/web/core/history.js';
import { fieldInstant, fieldText } from '../../clients/web/core/instant.js';

const GOOD_CODE = 0, UNCERTAIN_CODE = 0x408f0000, BAD_CODE = 0x80050000;
const points = (...list) => ({ step: false, bucket_us: 0, points: list });

test('a line holds its last value until now, and breaks where there is none', () => {
    const series = points([1e6, 5, GOOD_CODE], [2e6, null, BAD_CODE], [4e6, 7, GOOD_CODE]);
    assert.deepEqual(line(series, 0, 6e6), [[1, 2, 4, 6], [5, null, 7, 7]]);
    assert.deepEqual(line(points([1e6, 5, GOOD_CODE], [2e6, null, BAD_CODE]), 0, 6e6), [[1, 2], [5, null]]);
    assert.deepEqual(line(points(), 0, 6e6), [[], []]);
    assert.deepEqual(line(points([1e6, 5, BAD_CODE]), 0, 6e6), [[1], [null]], 'a value that is bad is none');
});

test('steps are steps', () => {
    const [xs, ys] = line({ ...points([1e6, 0, GOOD_CODE], [3e6, 1, GOOD_CODE]), step: true }, 0, 4e6);
    assert.deepEqual(ys, [0, 0, 1, 1]);
    assert.ok(xs[1] < 3 && xs[1] > 2.99);
});

test('a stretch keeps its spike, and its gap', () => {
    const stretch = (us, ...rest) => [us, ...rest];
    const none = stretch(20e6, null, null, null, null, null, 10e6, BAD_CODE);
    const series = { step: false, bucket_us: 10e6, points: [stretch(0, 1, 99, 5, 2, 3, 0, GOOD_CODE), none] };
    const [, ys] = line(series, 0, 40e6);
    assert.deepEqual([Math.max(...ys), Math.min(...ys.filter((y) => y !== null)), ys.at(-1)], [99, 1, null]);
    const lost = { step: false, bucket_us: 10e6, points: [stretch(0, 1, 2, 1, 2, null, 4e6, BAD_CODE)] };
    assert.equal(line(lost, 0, 10e6)[1].at(-1), null);
    const ended = { ...lost, points: [stretch(0, 1, 2, 1, 2, null, 0, BAD_CODE)] };
    assert.equal(line(ended, 0, 40e6)[1].at(-1), null, 'the series ends with the bucket: nothing is known afterwards');
    assert.deepEqual(gaps(lost, 0, 20e6), [{ from: 6, to: 20, severity: BAD }]);
});

test('gaps are when there was no value; uncertain ones are told apart', () => {
    const series = points([1e6, 5, GOOD_CODE], [2e6, null, BAD_CODE], [3e6, null, BAD_CODE], [4e6, 7, UNCERTAIN_CODE], [5e6, 7, GOOD_CODE]);
    const found = gaps(series, 0, 6e6).map(({ from, to, severity }) => [from, to, severity]);
    assert.deepEqual(found, [[0, 1, BAD], [2, 4, BAD], [4, 5, UNCERTAIN]]);
    assert.deepEqual(gaps(points(), 0, 6e6), [{ from: 0, to: 6, severity: BAD }]);
});

test('a source is lost while none of those that speak for it has a value', () => {
    const tags = ['A', 'B', 'C'].map((name) => ({ name, source: 'plc1' }));
    assert.deepEqual(witnesses([...tags, { name: 'X', source: null }, { name: 'D', source: 'plc2' }]),
        [{ source: 'plc1', tags: ['A', 'C'] }, { source: 'plc2', tags: ['D'] }]);
    const a = points([0, 5, GOOD_CODE], [2e6, null, BAD_CODE], [4e6, 7, UNCERTAIN_CODE], [5e6, null, BAD_CODE], [8e6, 7, GOOD_CODE]);
    const c = points([0, 5, GOOD_CODE], [3e6, null, BAD_CODE], [7e6, 7, GOOD_CODE]);
    assert.deepEqual(lost([a, c], 0, 9e6), [[3e6, 4e6], [5e6, 7e6]]);
    assert.deepEqual(lost([a], 0, 9e6), [[2e6, 4e6], [5e6, 8e6]]);
    assert.deepEqual(lost([a, points([0, 1, GOOD_CODE])], 0, 9e6), [], 'one fault is none of the source');
    assert.deepEqual(lost([], 0, 9e6), []);
});

test('alarms are marked when they were raised', () => {
    const row = (event, us, state) => ({ event, time_us: us, tag: 'A', kind: 'HH', priority: 1, state });
    const rows = [row('raise', 9, 'active'), row('clear', 8, 'normal'), row('raise', 5, 'suppressed'), row('raise', 3, 'unacknowledged')];
    assert.deepEqual(raised(rows).map(({ us }) => us), [3, 9]);
});

test('ticks are round, in the plant’s own zone', () => {
    assert.deepEqual(ticks(1e6, 3599e6, 6), [600e6, 1200e6, 1800e6, 2400e6, 3000e6]);
    assert.ok(ticks(0, 30 * 86400e6, 6).length <= 6);
    assert.equal(ticks(0, 86400e6, 2, 3600e6)[0] % 3600e6, 0);
});

test('requests carry the token, and failures are said in the server’s words', async () => {
    let seen;
    const fetcher = async (url, options) => { seen = [url, options.headers.Authorization]; return { ok: true }; };
    await ask('api/x', { tags: 'A,B' }, 'secret', fetcher);
    assert.deepEqual(seen, ['api/x?tags=A%2CB', 'Bearer secret']);
    const refusal = async () => new Response('nothing here\n', { status: 404 });
    await assert.rejects(ask('api/x', {}, null, refusal), /^Error: nothing here$/);
    const gone = () => Promise.reject(new TypeError('Failed to fetch'));
    await assert.rejects(ask('api/x', {}, null, gone), /^Error: The server cannot be reached$/);
});

test('the address names the instant', () => {
    const hash = writeAddress({ time: { atUs: 1793491200250000 } });
    assert.equal(readAddress(hash).time.atUs, 1793491200250000);
    assert.deepEqual(readAddress('#at=never').time, {});
    assert.doesNotMatch(writeAddress({ time: { atUs: null } }), /at=/);
});

test('limits of several tags: each once, by its axis, with whose it is unless it is everybody\'s', () => {
    const tag = (name, unit, limits) => ({ name, unit, limits });
    const tags = [
        tag('a', 'degC', { L: null, H: 60, HH: 90 }), tag('b', 'degC', { L: 5, H: 60, HH: 80 }), tag('c', 'bar', { H: 60 }),
        tag('d', 'bar'),
    ];
    const lines = limitLines(tags, ({ unit }) => unit)
        .map(({ scale, name, value, tags: of }) => [scale, name, value, ...of.map((one) => one.name)]);
    assert.deepEqual(lines, [
        ['degC', 'H', 60, 'a', 'b'], ['degC', 'HH', 90, 'a'], ['degC', 'L', 5, 'b'], ['degC', 'HH', 80, 'b'], ['bar', 'H', 60, 'c'],
    ]);
    assert.deepEqual(limitLines(tags.slice(0, 2), ({ unit }) => unit)[0], { scale: 'degC', name: 'H', value: 60, tags: [] });
    assert.deepEqual(limitLines([], () => ''), []);
});

test('from alarm to alarm, and marks that stand in one place as one', () => {
    const marks = [[10, 3], [20, 1], [21, 2], [50, 4]].map(([us, priority]) => ({ us, priority }));
    assert.deepEqual([nextTo(marks, 20, true).us, nextTo(marks, 20, false).us], [10, 21], 'never the one where it stands');
    assert.deepEqual([nextTo(marks, 10, true), nextTo(marks, 50, false)], [null, null]);
    assert.deepEqual(clustered(marks, 5).map(({ us, priority, of }) => [us, priority, of.length]), [[10, 3, 1], [20, 1, 2], [50, 4, 1]]);
    assert.deepEqual(clustered([], 5), []);
    assert.deepEqual([900, 3600, 86400, 2592000].map(arrowS), [1, 4, 60, 60], 'a minute at most, also of 30 days');
});

test('a date field is by the clock of the plant', () => {
    const at = (text, zone) => { const us = fieldInstant(text, zone); return us && new Date(us / 1000).toISOString(); };
    assert.equal(at('2026-11-22T07:27:02', 'Asia/Seoul'), '2026-11-21T22:27:02.000Z');
    assert.equal(at('2026-11-22 07:27', 'America/New_York'), '2026-11-22T12:27:00.000Z');
    assert.equal(at('2026-07-01', 'Europe/Berlin'), '2026-06-30T22:00:00.000Z');
    assert.equal(at('2026-10-25T02:30:00', 'Europe/Berlin'), '2026-10-25T00:30:00.000Z', 'the first of the hour that comes twice');
    assert.equal(at('2026-03-29T02:30:00', 'Europe/Berlin'), '2026-03-29T01:30:00.000Z', 'an hour that is left out: the one after it');
    for (const bad of ['', 'noon', '2026-13-01T00:00', '26-1-1'])
        assert.equal(fieldInstant(bad, 'UTC'), null, bad);
    assert.equal(fieldText(Date.parse('2026-11-21T22:27:02.9Z') * 1000, 'Asia/Seoul'), '2026-11-22T07:27:02');
    assert.equal(fieldInstant('2026-11-22T07:27:02', 'UTC'), Date.parse('2026-11-22T07:27:02Z') * 1000);
});

test('a week of residuals: a line for each stretch, as high as it is against sigma', () => {
    assert.deepEqual(residuals([[0, 5, 3], [1, null, 3], [2, 5, null], [3, 4, 4]]), [2, null, null, 0]);
    assert.deepEqual(stretches([0, 1, null, 1, 1, null, 5], 0.5), ['0.5,26.0 1.5,21.2', '3.5,21.2 4.5,21.2']);
    assert.deepEqual(stretches([2, 2], 1), ['0.5,14.0 1.5,14.0']);
    assert.deepEqual(stretches([null, null], 1), []);
});
