// SPDX-License-Identifier: GPL-3.0-or-later
// How the page shows recorded history: lines with gaps and spikes in charts, alarms and time marks on the slider, times that
// users type; and a session that shows the past.
import assert from 'node:assert/strict';
import { mock, test } from 'node:test';
import { residuals, stretches } from '../../clients/web/app/cards/drift.js';
import { Timeline } from '../../clients/web/app/timeline/timeline.js';
import { Compare } from '../../clients/web/app/views/compare.js';
import { Devices } from '../../clients/web/app/views/devices.js';
import { Remote } from '../../clients/web/app/views/remote.js';
import { readAddress, writeAddress } from '../../clients/web/core/address.js';
import {
    arrowS, BAD, clustered, density, gaps, limitLines, line, lost, nextTo, raised, UNCERTAIN, witnesses,
} from '../../clients/web/core/history.js';
import { ask, loaderOf } from '../../clients/web/core/http.js';
import { fieldInstant, fieldText, ticks } from '../../clients/web/core/instant.js';
import { LEAST_US, newSpanS, panned, readRange, zoomed } from '../../clients/web/core/trend_range.js';
import { alarmSpans, bands, statistics, valueAt, withNewest } from '../../clients/web/core/trend_values.js';
import { learnWords } from '../../clients/web/core/words.js';
import { withServer } from './fixtures.mjs';

const GOOD_CODE = 0, UNCERTAIN_CODE = 0x408f0000, BAD_CODE = 0x80050000;
const points = (...list) => ({ step: false, bucket_us: 0, points: list });

test('a line holds its last value until now, and breaks at gaps', () => {
    const series = points([1e6, 5, GOOD_CODE], [2e6, null, BAD_CODE], [4e6, 7, GOOD_CODE]);
    assert.deepEqual(line(series, 0, 6e6), [[1, 1.999999, 2, 4, 6], [5, 5, null, 7, 7]]);
    assert.deepEqual(line(points([1e6, 5, GOOD_CODE], [2e6, null, BAD_CODE]), 0, 6e6), [[1, 1.999999, 2], [5, 5, null]]);
    assert.deepEqual(line(points(), 0, 6e6), [[], []]);
    assert.deepEqual(line(points([1e6, 5, BAD_CODE]), 0, 6e6), [[1], [null]], 'a bad value counts as none');
});

test('a value holds until the quality changes, in the line, its values and its statistics', () => {
    const series = points([0, 20, GOOD_CODE], [8e6, 50, UNCERTAIN_CODE], [12e6, 70, UNCERTAIN_CODE], [20e6, null, BAD_CODE]);
    assert.deepEqual(line(series, 0, 24e6), [[0, 7.999999, 8, 12, 19.999999, 20], [20, 20, 50, 70, 70, null]]);
    assert.deepEqual([4e6, 8e6, 10e6, 16e6, 22e6].map((us) => valueAt(series, us)), [20, 50, 60, 70, null]);
    const { mean, known } = statistics(series, 0, 20e6);
    assert.deepEqual([mean, known], [(20 * 8 + 60 * 4 + 70 * 8) / 20, 1]);
});

test('a step value is drawn with steps', () => {
    const [xs, ys] = line({ ...points([1e6, 0, GOOD_CODE], [3e6, 1, GOOD_CODE]), step: true }, 0, 4e6);
    assert.deepEqual(ys, [0, 0, 1, 1]);
    assert.ok(xs[1] < 3 && xs[1] > 2.99);
});

test('the line of intervals shows their means, the band keeps spikes, and a gap breaks both', () => {
    const none = [20e6, null, null, null, null, null, 10e6, BAD_CODE];
    const series = { step: false, bucket_us: 10e6, points: [[0, 1, 99, 5, 2, 3, 0, GOOD_CODE], [10e6, 2, 4, 3, 3, 4, 0, GOOD_CODE], none] };
    assert.deepEqual(line(series, 0, 40e6), [[0, 5, 15, 19.999998, 20], [2, 5, 3, 4, null]]);
    assert.deepEqual(bands(series), [[[0, 10, 1, 99], [10, 20, 2, 4]]]);
    const lost = { step: false, bucket_us: 10e6, points: [[0, 1, 2, 1, 2, null, 4e6, BAD_CODE]] };
    assert.equal(line(lost, 0, 10e6)[1].at(-1), null);
    const ended = { ...lost, points: [[0, 1, 2, 1, 2, null, 0, BAD_CODE]] };
    assert.equal(line(ended, 0, 40e6)[1].at(-1), null, 'the series ends with the interval, and nothing is known afterwards');
    assert.deepEqual(gaps(lost, 0, 20e6), [{ from: 6, to: 20, severity: BAD }]);
    const held = { ...ended, points: [[0, 5, 5, 5, 5, 5, 0, GOOD_CODE], [30e6, null, null, null, 5, null, 10e6, BAD_CODE]] };
    assert.deepEqual(line(held, 0, 40e6), [[0, 5, 9.999998, 29.999999, 30], [5, 5, 5, 5, null]], 'the value is held until it was lost');
    assert.deepEqual(bands(points([0, 5, GOOD_CODE])), [], 'single points have no band');
    const apart = { step: false, bucket_us: 10e6, points: [[0, 1, 3, 2, 1, 3, 0, GOOD_CODE], [30e6, 5, 5, 5, 5, 5, 0, GOOD_CODE]] };
    assert.equal(bands(apart).length, 2, 'intervals with a gap have two bands');
    assert.deepEqual(line(apart, 0, 40e6)[1], [1, 2, 3, 5, 5, 5, 5],
        'the line is straight from the last value of an interval to the first of the next');
});

test('statistics are means over time, and state the share of the time that they cover', () => {
    const of = (...given) => statistics(...given);
    assert.deepEqual(of(points([0, 0, GOOD_CODE], [10e6, 10, GOOD_CODE]), 0, 20e6), { min: 0, max: 10, mean: 7.5, known: 1 });
    const holed = points([0, 4, GOOD_CODE], [5e6, null, BAD_CODE], [15e6, 8, UNCERTAIN_CODE]);
    assert.deepEqual(of(holed, 0, 20e6), { min: 4, max: 8, mean: 6, known: 0.5 });
    assert.equal(of({ ...points([0, 0, GOOD_CODE], [10e6, 10, GOOD_CODE]), step: true }, 0, 20e6).mean, 5, 'a step value is held');
    assert.deepEqual(of(points([-10e6, 0, GOOD_CODE], [10e6, 20, GOOD_CODE]), 0, 10e6), { min: 10, max: 20, mean: 15, known: 1 },
        'a range that cuts the line interpolates at its ends');
    assert.equal(of(points(), 0, 1e6), null);
    const intervals = { step: false, bucket_us: 10e6, points: [[0, 1, 99, 5, 2, 4, 0, GOOD_CODE], [30e6, 6, 10, 8, 6, 10, 5e6, BAD_CODE]] };
    const { min, max, mean, known } = of(intervals, 0, 40e6);
    assert.deepEqual([min, max, known], [1, 99, 35 / 40]);
    assert.ok(Math.abs(mean - (5 * 10 + 5 * 20 + 8 * 5) / 35) < 1e-9, 'the line between intervals counts in the mean');
    const bit = { step: true, bucket_us: 10e6, points: [[0, 0, 0, 0, 0, 0, 0, GOOD_CODE], [30e6, 0, 1, 1, 1, 1, 0, GOOD_CODE]] };
    assert.equal(of(bit, 0, 40e6).mean, 1 / 4, 'a switch holds between intervals');
});

test('minimum and maximum include a value that is newer than the series', () => {
    const stats = { min: 2, max: 8, mean: 5, known: 0.5 };
    assert.deepEqual([9, 1, 5].map((value) => withNewest(stats, value)),
        [{ ...stats, max: 9 }, { ...stats, min: 1 }, stats]);
    assert.deepEqual(withNewest(null, 4), { min: 4, max: 4 }, 'without recorded points, minimum and maximum are the new value');
});

test('the value at an instant equals the drawn line', () => {
    const series = points([0, 0, GOOD_CODE], [10e6, 10, GOOD_CODE], [20e6, null, BAD_CODE], [30e6, 7, GOOD_CODE]);
    assert.deepEqual([-1, 5e6, 15e6, 25e6, 35e6].map((us) => valueAt(series, us)), [null, 5, 10, null, 7]);
    assert.equal(valueAt({ ...series, step: true }, 9e6), 0);
    const intervals = { step: false, bucket_us: 10e6, points: [[0, 1, 99, 5, 2, 4, 0, GOOD_CODE], [30e6, 6, 10, 8, 6, 10, 0, GOOD_CODE]] };
    assert.deepEqual([3e6, 20e6, 31e6].map((us) => valueAt(intervals, us)), [5, 5, 8]);
});

test('alarms last from being raised until they return or are shelved, or until now', () => {
    const row = (us, event, before, state, tag = 'A') => ({ time_us: us, event, before, state, tag, kind: 'H', priority: 2, value: 9,
        limit: 8, unit: tag === 'A' ? 'bar' : null });
    const rows = [row(9, 'raise', 'normal', 'unacknowledged'), row(7, 'clear', 'acknowledged', 'normal'),
        row(5, 'ack', 'unacknowledged', 'acknowledged'), row(4, 'raise', 'normal', 'unacknowledged'),
        row(3, 'raise', 'normal', 'suppressed', 'B'), row(2, 'clear', 'unacknowledged', 'returned', 'B')];
    assert.deepEqual(alarmSpans(rows, 'bar').map(({ us, endUs, tag, value }) => [us, endUs, tag, value]),
        [[4, 7, 'A', 9], [9, null, 'A', 9]]);
    assert.deepEqual(alarmSpans(rows, '°C').map(({ value, limit }) => [value, limit]), [[null, null], [null, null]],
        'values in another unit are left out');
});

test('time ranges are read as people write them, in three languages', () => {
    const now = Date.parse('2026-11-26T03:00:00Z') * 1000, iso = (us) => new Date(us / 1000).toISOString().slice(0, 16);
    const read = (text, zone = 'UTC', at = now) => {
        const range = readRange(text, at, zone);
        return range && (range.spanS ?? `${iso(range.fromUs)} ${iso(range.toUs)}`);
    };
    for (const text of ['last 8 h', '8h', 'Past 8 hours', 'letzte 8 h', 'die letzten 8 Stunden', '최근 8시간', '지난 8 시간',
        '480 min'])
        assert.equal(read(text), 28800, text);
    assert.deepEqual(['last 30 d', 'letzte 2 Wochen', '최근 15분', '1,5 h'].map((text) => read(text)), [2592000, 1209600, 900, 5400]);
    const night = '2026-11-25T22:00 2026-11-26T03:00'; // 06:00 today lies in the future, so these ranges end at the present time, 03:00
    for (const text of ['yesterday 22:00 to 06:00', 'gestern 22:00 bis 06:00', 'von gestern 22:00 bis 06:00 Uhr', '어제 22:00 ~ 06:00',
        '어제 22:00부터 06:00까지', '22:00 to 06:00', 'yesterday 22:00 to now', '2026-11-25 22:00 - today 06:00'])
        assert.equal(read(text), night, text);
    assert.equal(read('yesterday 22:00 to 06:00', 'UTC', now + 9 * 3600e6), '2026-11-25T22:00 2026-11-26T06:00');
    assert.equal(read('yesterday'), '2026-11-25T00:00 2026-11-26T00:00');
    assert.equal(read('yesterday', 'Asia/Seoul'), '2026-11-24T15:00 2026-11-25T15:00', 'yesterday follows the plant\'s clock');
    assert.equal(read('2026-11-20 to 2026-11-21'), '2026-11-20T00:00 2026-11-22T00:00', 'dates cover whole days');
    assert.equal(read('2026-11-20T06:30 to 07:15'), '2026-11-20T06:30 2026-11-20T07:15');
    for (const text of ['', 'noon', 'last h', 'last 9999 d', '22:00', 'tomorrow', '2027-01-01 to 2027-01-02', '25:00 to 26:00', 'to',
        '1 x'])
        assert.equal(read(text), null, text);
});

test('a new trend shows the recorded time, at most the last eight hours', () => {
    assert.deepEqual([0, 600, 901, 3600, 3601, 28800, 1e7, null].map(newSpanS), [900, 900, 3600, 3600, 28800, 28800, 28800, 28800]);
});

test('zoom keeps the instant under the pointer, pan keeps the length, and neither goes beyond the present', () => {
    assert.deepEqual(zoomed([0, 100e6], 0.5, 25e6, 1e12), [12.5e6, 62.5e6]);
    assert.deepEqual(zoomed([900e6, 1000e6], 2, 950e6, 1000e6), [800e6, 1000e6]);
    assert.equal(zoomed([0, 100e6], 1e-9, 50e6, 1e12)[1] - zoomed([0, 100e6], 1e-9, 50e6, 1e12)[0], LEAST_US);
    assert.deepEqual(panned([100e6, 200e6], -0.5, 1e12), [50e6, 150e6]);
    assert.deepEqual(panned([100e6, 200e6], 5, 250e6), [150e6, 250e6]);
});

test('gaps are times without a value; uncertain values are told apart', () => {
    const series = points([1e6, 5, GOOD_CODE], [2e6, null, BAD_CODE], [3e6, null, BAD_CODE], [4e6, 7, UNCERTAIN_CODE], [5e6, 7, GOOD_CODE]);
    const found = gaps(series, 0, 6e6).map(({ from, to, severity }) => [from, to, severity]);
    assert.deepEqual(found, [[0, 1, BAD], [2, 4, BAD], [4, 5, UNCERTAIN]]);
    assert.deepEqual(gaps(points(), 0, 6e6), [{ from: 0, to: 6, severity: BAD }]);
});

test('a source counts as lost while none of its watched tags has a value', () => {
    const tags = ['A', 'B', 'C'].map((name) => ({ name, source: 'plc1' }));
    assert.deepEqual(witnesses([...tags, { name: 'X', source: null }, { name: 'D', source: 'plc2' }]),
        [{ source: 'plc1', tags: ['A', 'C'] }, { source: 'plc2', tags: ['D'] }]);
    const a = points([0, 5, GOOD_CODE], [2e6, null, BAD_CODE], [4e6, 7, UNCERTAIN_CODE], [5e6, null, BAD_CODE], [8e6, 7, GOOD_CODE]);
    const c = points([0, 5, GOOD_CODE], [3e6, null, BAD_CODE], [7e6, 7, GOOD_CODE]);
    assert.deepEqual(lost([a, c], 0, 9e6), [[3e6, 4e6], [5e6, 7e6]]);
    assert.deepEqual(lost([a], 0, 9e6), [[2e6, 4e6], [5e6, 8e6]]);
    assert.deepEqual(lost([a, points([0, 1, GOOD_CODE])], 0, 9e6), [], 'the fault of a single sensor is no loss of the source');
    assert.deepEqual(lost([], 0, 9e6), []);
});

test('alarms are marked when they were raised', () => {
    const row = (event, us, state) => ({ event, time_us: us, tag: 'A', kind: 'HH', priority: 1, state });
    const rows = [row('raise', 9, 'active'), row('clear', 8, 'normal'), row('raise', 5, 'suppressed'), row('raise', 3, 'unacknowledged')];
    assert.deepEqual(raised(rows).map(({ us }) => us), [3, 9]);
});

test('time ticks are round in the plant’s time zone', () => {
    assert.deepEqual(ticks(1e6, 3599e6, 6, 'UTC'), [600e6, 1200e6, 1800e6, 2400e6, 3000e6]);
    assert.ok(ticks(0, 30 * 86400e6, 6, 'UTC').length <= 6);
    const texts = (from, to, most, zone, ...least) => ticks(Date.parse(from) * 1000, Date.parse(to) * 1000, most, zone, ...least)
        .map((us) => fieldText(us, zone).slice(5, 16));
    assert.deepEqual(texts('2026-11-21T03:00Z', '2026-11-22T03:00Z', 4, 'Asia/Kolkata'),
        ['11-21T16:00', '11-22T00:00', '11-22T08:00']);
    const midnights = (zone, ...days) => assert.deepEqual(texts('2026-10-23T12:00Z', '2026-10-26T12:00Z', 9, zone, 86400),
        days.map((day) => `10-${day}T00:00`), zone);
    midnights('Asia/Seoul', 24, 25, 26);
    midnights('America/Chicago', 24, 25, 26);
    midnights('Europe/Berlin', 24, 25, 26); // the clocks are set back on 25 October
    assert.deepEqual(texts('2026-10-01T00:00Z', '2026-10-31T00:00Z', 5, 'Europe/Berlin', 86400).map((text) => text.slice(5)),
        Array(4).fill('T00:00'));
    assert.deepEqual(texts('2026-03-28T23:00Z', '2026-03-29T03:00Z', 9, 'Europe/Berlin').map((text) => text.slice(6)),
        ['00:00', '00:30', '01:00', '01:30', '03:00', '03:30', '04:00', '04:30', '05:00'], 'the clocks skip 02:00');
    const back = ['00:00', '00:30', '01:00', '01:30', '02:00', '02:30', '02:00', '02:30', '03:00', '03:30'];
    assert.deepEqual(texts('2026-10-24T22:00Z', '2026-10-25T02:30Z', 9, 'Europe/Berlin').map((text) => text.slice(6)), back,
        'the hour from 02:00 occurs twice');
    assert.deepEqual(texts('2026-10-25T00:40Z', '2026-10-25T01:20Z', 2, 'Europe/Berlin', 1800).map((text) => text.slice(6)), ['02:00']);
    assert.deepEqual(texts('2026-10-24T10:00Z', '2026-10-25T14:00Z', 14, 'Europe/Berlin').map((text) => text.slice(6)),
        ['12:00', '14:00', '16:00', '18:00', '20:00', '22:00', '00:00', '02:00', '04:00', '06:00', '08:00', '10:00', '12:00', '14:00']);
});

test('history requests carry the token, and errors show the server’s words', async () => {
    let seen;
    const fetcher = async (url, options) => { seen = [url, options.headers.Authorization]; return { ok: true }; };
    await ask('api/x', { tags: 'A,B' }, 'secret', fetcher);
    assert.deepEqual(seen, ['api/x?tags=A%2CB', 'Bearer secret']);
    const refusal = async () => new Response('nothing here\n', { status: 404 });
    await assert.rejects(ask('api/x', {}, null, refusal), /^Error: nothing here$/);
    const gone = () => Promise.reject(new TypeError('Failed to fetch'));
    await assert.rejects(ask('api/x', {}, null, gone), /^Error: The server cannot be reached$/);
});

test('the address contains the shown instant', () => {
    const hash = writeAddress({ time: { atUs: 1793491200250000 } });
    assert.equal(readAddress(hash).time.atUs, 1793491200250000);
    assert.deepEqual(readAddress('#at=never').time, {});
    assert.doesNotMatch(writeAddress({ time: { atUs: null } }), /at=/);
});

test('limits of several tags: each appears once per axis, with its tags\' names unless all share it', () => {
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

test('the user jumps from alarm to alarm, and marks in one place are merged', () => {
    const marks = [[10, 3], [20, 1], [21, 2], [50, 4]].map(([us, priority]) => ({ us, priority }));
    assert.deepEqual([nextTo(marks, 20, true).us, nextTo(marks, 20, false).us], [10, 21], 'the jump leaves the present mark');
    assert.deepEqual([nextTo(marks, 10, true), nextTo(marks, 50, false)], [null, null]);
    assert.deepEqual(clustered(marks, 5).map(({ us, priority, of }) => [us, priority, of.length]), [[10, 3, 1], [20, 1, 2], [50, 4, 1]]);
    assert.deepEqual(clustered([], 5), []);
    assert.deepEqual([900, 3600, 86400, 2592000].map(arrowS), [1, 4, 60, 60], 'an arrow step is at most a minute, even for 30 days');
});

test('the density counts alarms in equal parts of a time span, by the most urgent', () => {
    const marks = [[-5, 1], [0, 3], [1, 2], [99, 4], [100, 1]].map(([us, priority]) => ({ us, priority }));
    const { bins, most } = density(marks, 0, 100, 10);
    assert.deepEqual([bins.length, most, bins[0], bins[9]], [10, 2, { count: 2, priority: 2 }, { count: 1, priority: 4 }]);
});

test('a date field follows the plant\'s clock', () => {
    const at = (text, zone) => { const us = fieldInstant(text, zone); return us && new Date(us / 1000).toISOString(); };
    assert.equal(at('2026-11-22T07:27:02', 'Asia/Seoul'), '2026-11-21T22:27:02.000Z');
    assert.equal(at('2026-11-22 07:27', 'America/New_York'), '2026-11-22T12:27:00.000Z');
    assert.equal(at('2026-07-01', 'Europe/Berlin'), '2026-06-30T22:00:00.000Z');
    assert.equal(at('2026-10-25T02:30:00', 'Europe/Berlin'), '2026-10-25T00:30:00.000Z',
        'an hour that occurs twice means its first occurrence');
    assert.equal(at('2026-03-29T02:30:00', 'Europe/Berlin'), '2026-03-29T01:30:00.000Z', 'a skipped hour means the hour after it');
    for (const bad of ['', 'noon', '2026-13-01T00:00', '2026-02-30', '26-1-1'])
        assert.equal(fieldInstant(bad, 'UTC'), null, bad);
    assert.equal(fieldText(Date.parse('2026-11-21T22:27:02.9Z') * 1000, 'Asia/Seoul'), '2026-11-22T07:27:02');
    assert.equal(fieldInstant('2026-11-22T07:27:02', 'UTC'), Date.parse('2026-11-22T07:27:02Z') * 1000);
});

test('a failed request for a list is repeated, and the answer to an earlier request never replaces a later one', async () => {
    mock.timers.enable({ apis: ['setTimeout'] });
    try {
        const asked = [], taken = [], session = { welcomed: true };
        const load = loaderOf(session, () => new Promise((done, fail) => asked.push({ done, fail })),
            (answer, error) => taken.push(answer ?? error.message));
        const [first, second] = [load(), load()];
        asked[1].done('new');
        await second;
        asked[0].done('old');
        await first;
        assert.deepEqual(taken, ['new']);
        const third = load();
        asked[2].fail(new Error('cut'));
        await third;
        assert.deepEqual([taken.at(-1), asked.length], ['cut', 3]);
        mock.timers.tick(5000);
        assert.equal(asked.length, 4, 'asks again');
        asked[3].fail(new Error('cut'));
        await new Promise(setImmediate);
        session.welcomed = false;
        mock.timers.tick(5000);
        assert.equal(asked.length, 4, 'without a connection, the next welcome asks again');
    } finally {
        mock.timers.reset();
    }
});

test('the lists of walls and displays stay, with the reason, if they cannot be read', async () => {
    await learnWords();
    const { document } = globalThis, button = {}, node = () => ({ textContent: '', replaceChildren(...rows) { this.rows = rows; } });
    globalThis.document = { getElementById: () => button };
    try {
        const session = { role: 'operator', model: {}, walls: { list: [], displays: [] } }, pane = { dataset: {}, replaceChildren() {} };
        const remote = Object.assign(Object.create(Remote.prototype), { session, pane, panes: [{ wall: 'room', display: 1, area: 'main' }],
            said: node(), element: {} });
        pane.value = 'room/1/main';
        pane.dataset.choices = JSON.stringify([['room/1/main', 'room 1: main']]);
        remote.take(null, new Error('no server'));
        assert.deepEqual([remote.element.hidden, remote.chosen.wall], [false, 'room'], 'the pointer can be switched off');
        assert.match(remote.said.textContent, /^Walls could not be read: no server · /);
        remote.take({ walls: [] }, null);
        assert.deepEqual([remote.element.hidden, remote.panes], [true, []]);
        const devices = Object.assign(Object.create(Devices.prototype), { note: node(), element: { hidden: false }, list: node(),
            rowOf: ({ id }) => id });
        devices.take({ list: [{ id: 'a' }] }, null);
        devices.take(null, new Error('no server'));
        assert.deepEqual([devices.list.rows, devices.element.hidden, devices.note.textContent],
            [['a'], false, 'Displays could not be read: no server']);
        devices.take({ list: null }, null);
        assert.deepEqual([devices.element.hidden, devices.note.textContent], [true, '']);
    } finally {
        globalThis.document = document;
    }
});

test('a week of residuals is drawn as a line for each stretch, scaled by sigma', () => {
    assert.deepEqual(residuals([[0, 5, 3], [1, null, 3], [2, 5, null], [3, 4, 4]]), [2, null, null, 0]);
    assert.deepEqual(stretches([0, 1, null, 1, 1, null, 5], 0.5), ['0.5,26.0 1.5,21.2', '3.5,21.2 4.5,21.2']);
    assert.deepEqual(stretches([2, 2], 1), ['0.5,14.0 1.5,14.0']);
    assert.deepEqual(stretches([null, null], 1), []);
});

test('the time bar keeps its marks if the server does not answer, and does not take that for a time without alarms', async () => {
    await learnWords();
    const told = [], session = { token: null, clockUs: () => 9e6, time: { atUs: null }, model: { tags: [] } };
    const bar = Object.assign(Object.create(Timeline.prototype), { session, tell: (text) => told.push(text), marksAt: 0, toUs: 9e6,
        marks: [], gaps: [], lost: [], draw() {} });
    Object.defineProperty(bar, 'spanUs', { value: 3e6 });
    const raise = { time_us: 8e6, tag: 'TI-1', kind: 'H', event: 'raise', state: 'unacknowledged', before: 'normal', priority: 2 };
    const answers = (gaps, rows) => (query, options, path) => (path.includes('gaps') ? { gaps } : { rows, next_before: null });
    const state = () => [bar.marks.map(({ us }) => us), bar.gaps, bar.failed !== ''];
    await withServer(answers([[7e6, 7.5e6]], [raise]), () => bar.askMarks());
    assert.deepEqual(state(), [[8e6], [[7e6, 7.5e6]], false]);
    await withServer(() => { throw new Error(); }, async () => {
        await bar.askMarks();
        assert.deepEqual(state(), [[8e6], [[7e6, 7.5e6]], true]);
        await bar.goToAlarm(true);
        assert.match(told.at(-1), /^Alarms could not be read: ./);
    });
    await withServer(answers([], []), async () => {
        await bar.askMarks();
        assert.deepEqual(state(), [[], [], false]);
        await bar.goToAlarm(true);
        assert.match(told.at(-1), /^No earlier alarm/);
    });
});

test('the right half of two times gets the sensor, the factors and the baseline of the left half, if it can have them', () => {
    const first = { group: 'temperature', show: 'value', sensor: null, sensors: {}, baseline: null, range: [0, 100], breaks: [50],
        split: null, strength: 1 };
    const sent = [], other = { welcomed: true, picture: {}, params: first, setParams: (change) => sent.push(change) };
    const compare = Object.assign(Object.create(Compare.prototype), { session: { params: first, role: 'engineer' }, connected: {},
        sentParams: null, frame: { contentWindow: { plantcast: { session: other } } } });
    const tells = (change) => {
        compare.session.params = { ...compare.session.params, ...change };
        sent.length = 0;
        compare.tellParams();
        return sent[0] ?? null;
    };
    assert.equal(tells({}), null);
    assert.deepEqual(tells({ show: 'distance', sensor: 'TI-1' }), { show: 'distance', sensor: 'TI-1' });
    assert.deepEqual(tells({ sensors: { 'TI-1': { strength: 2 }, 'TI-2': { decay: 3 } } }),
        { sensors: { 'TI-1': { strength: 2 }, 'TI-2': { decay: 3 } } });
    assert.deepEqual(tells({ sensors: { 'TI-2': { decay: 3 } } }), { sensors: { 'TI-1': null } });
    const unconfirmed = { show: 'difference', baseline: 'noon', range: [-25, 25] };
    assert.equal(tells(unconfirmed), null, 'waits until the server has confirmed the baseline');
    assert.deepEqual(tells({ baseline: { name: 'noon', time_us: 1 } }), { range: [-25, 25], show: 'difference', baseline: 'noon' });
    assert.deepEqual(tells({ baseline: { name: null, time_us: 2 } }), { show: 'value', baseline: null }, 'readings without a name');
    assert.deepEqual(tells({ show: 'value', baseline: null, range: [0, 100], breaks: null }), { range: [0, 100], breaks: null },
        'removes the bands that the right half has kept');
    compare.session.role = 'operator';
    assert.equal(tells({ strength: 3, sensors: {} }), null, 'an operator may not send what only engineers may');
});
