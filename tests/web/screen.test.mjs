// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that the page shows: numbers, ages, clock, legend, labels, meters, and the page's address.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { limitText } from '../../clients/web/app/alarms/alarm_bar.js';
import { gapText } from '../../clients/web/app/engineer/placing.js';
import { TrendTable } from '../../clients/web/app/trends/trend_table.js';
import { readAddress, writeAddress } from '../../clients/web/core/address.js';
import {
    ageText, changeText, decimalsFor, decimalsOf, numberText, shortNumberText, timeOrDay, unitText, zoneClock,
} from '../../clients/web/core/format.js';
import { Compare } from '../../clients/web/app/views/compare.js';
import { Legend } from '../../clients/web/app/viewport/legend.js';
import { behindText } from '../../clients/web/core/health.js';
import { halfAt, nearestMarker } from '../../clients/web/core/nearest.js';
import { halves } from '../../clients/web/core/split_view.js';
import {
    colourOf, edges, niceStep, placeOf, rampChoices, scaleTicks, spread, ticks, valueAt,
} from '../../clients/web/core/legend.js';
import { worst } from '../../clients/web/core/model.js';
import { statusText } from '../../clients/web/core/quality.js';
import { snapshotQuery } from '../../clients/web/core/query.js';
import { hatchAt, patternPeriodPx, stippleAt } from '../../clients/web/core/patterns.js';
import { LatencyMeter, RateMeter } from '../../clients/web/core/meters.js';
import { learnWords } from '../../clients/web/core/words.js';
import { vector } from './fixtures.mjs';

test('decimals follow the range, zero has no minus sign, and a missing value is a dash', () => {
    assert.deepEqual([1000, 160, 16, 5, 0.02, 0, NaN].map(decimalsFor), [0, 1, 2, 2, 5, 2, 2]);
    assert.equal(numberText(-0.04, 1), '0.0');
    assert.equal(numberText(-12.34, 1), '−12.3');
    assert.equal(numberText(0, 1), '0.0');
    assert.equal(numberText(null, 1), '–');
    assert.deepEqual([4.21, -4.21, 0.01, null].map((change) => changeText(change, 1)), ['Δ +4.2', 'Δ −4.2', 'Δ 0.0', 'Δ –']);
    assert.equal(numberText(NaN, 1), '–');
    const short = [[20, 1], [0.05, 2], [-1.5, 3], [0, 2], [null, 1], [100, 0]].map((of) => shortNumberText(...of));
    assert.deepEqual(short, ['20', '0.05', '−1.5', '0', '–', '100']);
});

test('on a logarithmic scale the decimals follow the value, so that no value or limit is rounded to 0', async () => {
    await learnWords();
    const group = { min: 0.1, max: 1000, scale: 'log', unit: 'ppm' }, textOf = (value) => numberText(value, decimalsOf(group, value));
    assert.deepEqual([0.45, -0.45, 5, 45, 450, 0].map(textOf), ['0.450', '−0.450', '5.00', '45.0', '450', '0.0000']);
    assert.equal(decimalsOf({ ...group, scale: 'linear' }, 0.45), decimalsFor(999.9));
    assert.equal(decimalsOf(null, 0.45), 2);
    const model = { readings: [{ value: 0.46, quality: 'good' }], group: () => group };
    const alarm = { tag: { index: 0 }, kind: 'H', value: 0.45, limit: 0.4 };
    const session = { model, time: { atUs: null }, clockUs: () => null, now: () => 0 };
    assert.equal(limitText(session, alarm, true), 'raised at 0.450 ppm, now 0.460 ppm (limit 0.400 ppm)');
});

test('a time of another day is shown with its day', () => {
    const clock = zoneClock('Europe/Oslo'), now = Date.UTC(2026, 5, 7, 6), at = (day, hour) => Date.UTC(2026, 5, day, hour, 15);
    assert.equal(timeOrDay(clock, at(7, 5), now), '07:15:00');
    assert.equal(timeOrDay(clock, at(7, 5), now, 5), '07:15');
    assert.equal(timeOrDay(clock, at(6, 21), now), 'Jun 6 23:15');
    assert.equal(timeOrDay(clock, at(6, 22), now), '00:15:00', 'the plant\'s day, not the day in UTC');
    assert.equal(timeOrDay(clock, at(8, 5), now, 5), 'Jun 8 07:15');
});

test('units are written as engineers write them', () => {
    assert.deepEqual(['degC', '°C', 'bar', 'mm/s', 'm3/h', 'kg/cm2', 'um'].map(unitText),
        ['°C', '°C', 'bar', 'mm/s', 'm³/h', 'kg/cm²', 'µm']);
});

test('ages are written with fitting units', () => {
    assert.deepEqual([0, 940, 9940, 9960, 119000, 121000, 7.3e6, 1.8e8, null].map(ageText),
        ['0.0 s', '0.9 s', '9.9 s', '10 s', '119 s', '2 min', '2 h', '2 d', '–']);
});

test('after a reload of the plant, the legend has the new limits and colours', () => {
    Object.assign(globalThis, { ResizeObserver: class { observe() {} }, window: { matchMedia: () => ({ addEventListener() {} }) } });
    try {
        const listeners = new Map(), on = (name, f) => listeners.set(name, [...listeners.get(name) ?? [], f]), drawn = [];
        const emit = (name) => (listeners.get(name) ?? []).forEach((f) => f());
        const modelOf = (H, colour) => ({ tags: [], group: () => ({ id: 'T', min: 0, max: 10, limits: { H } }),
            colormap: () => ({ rgb: [colour, 0, 0], safe: true }) });
        const session = { on, model: modelOf(8, 1), shown: { group: 'T', show: 'value' }, rangeOf: () => [0, 10],
            drawnErrors: [0, 0] };
        const legend = new Legend({ session, element: { replaceChildren: (_, scale) => drawn.push(scale), append() {} },
            paramsOf: (params) => params, lying: { matches: false, addEventListener() {} } });
        Object.assign(legend, { heading: () => null, keys: () => null, scale: ({ map }, _, { H }) => [H, map.rgb[0]] });
        emit('params');
        emit('params');
        session.model = modelOf(9, 2);
        emit('welcome');
        emit('params');
        assert.deepEqual(drawn, [[8, 1], [9, 2]]);
    } finally {
        delete globalThis.ResizeObserver;
        delete globalThis.window;
    }
});

test('a comparison no longer says "1 day earlier" after its left half has moved', () => {
    globalThis.document = {};
    try {
        const dayUs = 86400e6, nowUs = Date.UTC(2026, 5, 7) * 1000, ago = { value: '86400' };
        const session = { time: { atUs: null }, clockUs: () => nowUs };
        const show = () => Compare.prototype.show.call({ session, ago, atUs: nowUs - dayUs, date: {}, said: {}, zone: 'UTC' });
        show();
        assert.equal(ago.value, '86400');
        session.time.atUs = nowUs - 10e6;
        show();
        assert.equal(ago.value, '86400');
        session.time.atUs = nowUs - 3600e6;
        show();
        assert.equal(ago.value, '');
    } finally {
        delete globalThis.document;
    }
});

test('a trend\'s table shows no present value while no messages arrive from the server', () => {
    const cells = Object.fromEntries(['at', 'now', 'min', 'mean', 'max', 'known'].map((name) => [name, {}])), tag = { index: 0 };
    const node = { querySelector: () => ({}), classList: { toggle() {} } }, overlay = { fresh: true };
    const session = { time: { atUs: null }, model: { readings: [{ value: 9, quality: 'good' }] } };
    const view = { session, isLive: true, page: { overlay }, numberText: (_, value) => String(value ?? '–') };
    globalThis.document = { getElementById: () => node };
    try {
        const table = new TrendTable(view), stats = { min: 1, mean: 2, max: 3, known: 1 };
        table.heads = Object.fromEntries(Object.keys(cells).map((name) => [name, {}]));
        table.rows.set(tag, cells);
        table.stats.set(tag, stats);
        table.fill();
        assert.deepEqual([cells.now.textContent, cells.max.textContent], ['9', '9']);
        overlay.fresh = false;
        table.stats.set(tag, stats);
        table.fill();
        assert.deepEqual([cells.now.textContent, cells.max.textContent], ['–', '3']);
        session.time.atUs = 1e15;
        table.fill();
        assert.equal(cells.now.textContent, '9', 'the value of a past instant stays valid');
    } finally {
        delete globalThis.document;
    }
});

test('the plant clock is in the plant\'s zone and states the offset, in winter and summer', () => {
    const oslo = zoneClock('Europe/Oslo');
    assert.deepEqual(oslo(Date.UTC(2026, 0, 1, 0, 0, 7)), { date: 'Jan 1, 2026', day: 'Jan 1', time: '01:00:07', offset: 'UTC+01:00' });
    assert.deepEqual(oslo(Date.UTC(2026, 6, 1, 22, 30)), { date: 'Jul 2, 2026', day: 'Jul 2', time: '00:30:00', offset: 'UTC+02:00' });
    assert.equal(zoneClock('America/St_Johns')(Date.UTC(2026, 0, 1)).offset, 'UTC−03:30');
    const nowhere = zoneClock('Nowhere/At_All')(Date.UTC(2026, 0, 1));
    assert.deepEqual(nowhere, { date: 'Jan 1, 2026', day: 'Jan 1', time: '00:00:00', offset: 'UTC' });
});

test('qualities are written in words', async () => {
    await learnWords();
    assert.equal(statusText('good', 'Good'), 'Good');
    assert.equal(statusText('bad', 'Bad_WaitingForInitialData'), 'Bad: waiting for initial data');
    assert.equal(statusText('uncertain', 'Uncertain_NoCommunicationLastUsableValue'), 'Uncertain: no communication last usable value');
    assert.equal(worst(['good', 'uncertain', 'good']), 'uncertain');
    assert.equal(worst([]), null);
});

test('ticks are round, include both ends, and none crowds an end', () => {
    assert.deepEqual(ticks(0, 100), [0, 20, 40, 60, 80, 100]);
    assert.deepEqual(ticks(20, 180), [20, 50, 100, 150, 180]);
    assert.deepEqual(ticks(0, 16), [0, 5, 10, 16]);
    assert.deepEqual(ticks(-1, 1, 4), [-1, -0.5, 0, 0.5, 1]);
    assert.deepEqual(ticks(5, 5), []);
    for (const [min, max] of [[0, 7.1], [-273, 12], [0.001, 0.0093], [1e6, 3e6]]) {
        const list = ticks(min, max);
        assert.ok(list.length >= 3 && list.length <= 8, `ticks ${list}`);
        assert.ok(list.every((v, i) => i === 0 || v > list[i - 1]));
    }
});

test('marks that are close are moved apart, and stay on the bar', () => {
    const near = (a, b) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < 1e-9, `${a} is not ${b}`));
    near(spread([0.1, 0.5], 0.1), [0.1, 0.5]);
    near(spread([0.95, 0.98], 0.1), [0.9, 1]);
    near(spread([0.5, 0.52, 0.54], 0.1), [0.5, 0.6, 0.7]);
    near(spread([0.94, 0.96, 0.98], 0.1), [0.8, 0.9, 1]);
    assert.deepEqual(spread([], 0.1), []);
});

test('step sizes are round, and the ramp offers fitting choices', () => {
    assert.equal(niceStep(100, 6), 20);
    assert.equal(niceStep(0.3, 6), 0.05);
    assert.deepEqual(rampChoices(20, 180), [10, 20, 50]);
    assert.deepEqual(rampChoices(0, 12), [0.5, 1, 2, 5]);
});

const grey = { rgb: Uint8Array.from({ length: 768 }, (_, i) => Math.floor(i / 3)), below: [0, 0, 255], above: [255, 0, 255] };

const scale = (more = {}) => ({ map: grey, min: 0, max: 100, ...more });

test('colours: values in range take the map\'s colours, others the two end colours, and each ramp step has one colour', () => {
    assert.deepEqual(colourOf(scale(), 0), [0, 0, 0]);
    assert.deepEqual(colourOf(scale(), 100), [255, 255, 255]);
    assert.deepEqual(colourOf(scale(), -0.1), [0, 0, 255]);
    assert.deepEqual(colourOf(scale(), 100.1), [255, 0, 255]);
    const steps = scale({ interval: 25 });
    assert.deepEqual(colourOf(steps, 51), colourOf(steps, 74));
    assert.notDeepEqual(colourOf(steps, 49), colourOf(steps, 51));
    assert.deepEqual(colourOf(steps, 62), [160, 160, 160], 'a step has the colour of its middle');
    const other = scale({ min: 15, max: 50, interval: 10 });
    assert.deepEqual(colourOf(other, 26), colourOf(other, 34), 'steps are counted from MIN');
    assert.deepEqual(colourOf(steps, 100), colourOf(steps, 76), 'MAX is in the last step');
    assert.deepEqual(colourOf(scale({ interval: 30 }), 95), [243, 243, 243], 'the last step is cut short');
});

test('colours: bands between breaks are spread evenly over the map', () => {
    const bands = scale({ breaks: [-5, 60, 80, 95, 100], interval: 10 });
    assert.deepEqual([0, 59.9, 60, 80, 100].map((value) => colourOf(bands, value)[0]), [32, 32, 96, 160, 224]);
    assert.deepEqual(edges(bands), [60, 80, 95]);
    assert.deepEqual(edges(scale({ interval: 40 })), [40, 80]);
    assert.deepEqual(edges(scale({ interval: 1e-6 })), [], 'more edges than a person can see are left out');
});

test('logarithmic scales have logarithmic ticks and colours', () => {
    const log = scale({ min: 0.1, max: 1000, log: true });
    assert.equal(placeOf(log, 10), 0.5);
    assert.ok(Math.abs(valueAt(log, placeOf(log, 42)) - 42) < 1e-9);
    assert.deepEqual([0.1001, 1.0001, 10.001, 1000].map((value) => colourOf(log, value)[0]), [0, 64, 128, 255]);
    assert.deepEqual(colourOf(log, -3), [0, 0, 255]);
    assert.deepEqual(scaleTicks(log, []), [0.1, 1, 10, 100, 1000]);
    assert.deepEqual(scaleTicks(scale({ min: 20, max: 180, log: true }), []), [20, 50, 100, 180]);
});

test('ticks include breaks and isolines, unless these are too many to read', () => {
    assert.deepEqual(scaleTicks(scale({ breaks: [30, 70] }), [50]), [0, 30, 50, 70, 100]);
    assert.deepEqual(scaleTicks(scale(), Array.from({ length: 30 }, (_, i) => 3 * i + 1)), ticks(0, 100));
});

test('a split view has a left and a right half, each with its parameters and its width', () => {
    assert.deepEqual(halves({ group: 'a', split: null }, 641), [{ params: { group: 'a', split: null }, left: 0, width: 641 }]);
    const [left, right] = halves({ group: 'a', look: 'flat', split: { group: 'b' } }, 641);
    assert.deepEqual([left.left, left.width, right.left, right.width], [0, 320, 320, 321]);
    assert.deepEqual([left.params.group, right.params.group, right.params.look], ['a', 'b', 'flat']);
    assert.deepEqual([0, 319, 320, 640, 900].map((x) => halfAt({ split: {} }, 641, x).left), [0, 0, 320, 320, 320]);
});

test('patterns: half of the hatching is dark, a fifth of the stipple is dots, and both scale with the picture', () => {
    const darkness = (colourAt, light, dark) => {
        let sum = 0;
        for (let y = 0; y < 300; y++) {
            for (let x = 0; x < 300; x++)
                sum += (light - colourAt(x, y)[0]) / (light - dark);
        }
        return sum / 90000;
    };
    const period = patternPeriodPx(1080);
    assert.equal(period, 12);
    assert.equal(patternPeriodPx(360), 6);
    assert.ok(Math.abs(darkness((x, y) => hatchAt(x, y, 300, period), 240, 150) - 0.5) < 0.02);
    assert.ok(Math.abs(darkness((x, y) => stippleAt(x, y, 300, period, [200, 200, 200]), 200, 64) - Math.PI * 0.26 ** 2) < 0.02);
    assert.deepEqual(hatchAt(3, 50, 300, 10 / 1.4142), hatchAt(13, 50, 300, 10 / 1.4142), 'stripes repeat after the diagonal of a period');
    assert.deepEqual(hatchAt(40, 50, 300, 12), hatchAt(41, 51, 300, 12), 'stripes fall from left to right');
});

test('the nearest marker within reach is chosen, visible ones before hidden ones', () => {
    const markers = [{ x: 10, y: 10, occluded: true }, { x: 16, y: 10, occluded: false }, { x: 90, y: 90 }];
    assert.equal(nearestMarker(markers, 10, 10, 14), markers[1]);
    assert.equal(nearestMarker(markers, 50, 50, 14), null);
});

test('the frame rate counts the last second', () => {
    const rate = new RateMeter();
    for (let t = 0; t < 2000; t += 40)
        rate.count(t);
    assert.equal(rate.perSecond(1999), 25);
    assert.equal(rate.perSecond(4000), 0);
});

test('latency is measured from an input to the first picture that shows it, as the median of recent inputs', () => {
    const latency = new LatencyMeter();
    assert.equal(latency.median(0), null);
    latency.sent(1, 100);
    latency.sent(2, 116);
    latency.sent(3, 132);
    assert.equal(latency.behindMs(150), 50);
    latency.drawn(2, 160);
    assert.equal(latency.behindMs(160), 28);
    latency.drawn(2, 500);
    assert.equal(latency.median(500), 44);
    latency.drawn(3, 150);
    assert.equal(latency.inputs.size, 0);
    assert.equal(latency.behindMs(9000), 0);
});

test('the page states the delay of a picture that is more than 0.5 s older than the camera', () => {
    const latency = new LatencyMeter();
    latency.sent(1, 100);
    assert.deepEqual([600, 601, 1400].map((now) => behindText(latency, now)), ['', '0.5 s behind', '1.3 s behind']);
    latency.drawn(1, 1500);
    assert.equal(behindText(latency, 9000), '');
});

test('a view written to the address is read back unchanged', () => {
    const view = {
        camera: { eye: [35, -42.1234, 24], target: [1, 0.5, 6], up: [0, 0, 1], fov: 45 },
        params: {
            group: 'temperature', interpolation: 'paper', distance: 'euclidean', colormap: 'cividis', ramp_interval: 2.5, look: 'flat',
            selected: 'E-101 A&B',
        },
        tag: 'TT-101',
    };
    assert.deepEqual(readAddress(writeAddress(view)), { ...view, time: {} });
});

test('a view with every parameter is read back from the address unchanged', () => {
    const params = {
        group: 'temperature', show: 'difference', baseline: { name: 'before, 10:00' }, scale: 'linear', fill: 'neighbours', range: [-5, 5],
        breaks: [-2, 0, 2.5], isolines: [1, 2], strength: 2, decay: 0.5, power: 3, radius_m: 4, reach_m: 2.5, light: [0, 0.6, 0.8],
        sensors: { 'TT=1': { strength: 2 }, 'TT-2': { strength: 1, decay: 0 }, 'TT-3': { decay: 4 } },
        split: { group: 'pressure', look: 'flat' }, hidden: ['A', 'B'], clip: { box: { min: [0, 0, 0], max: [1, 2, 3] } },
    };
    const at = Date.UTC(2026, 4, 1, 12) * 1000, text = writeAddress({ params, time: { atUs: at } });
    assert.deepEqual(readAddress(text), { camera: null, params, tag: null, time: { atUs: at } });
    assert.ok(!writeAddress({ params, own: { power: 3, range: [-5, 5] } }).match(/power|range/),
        'the usual parameters are not in the address');
    assert.equal(writeAddress({ params: { strength: 1, decay: 1, radius_m: 0, reach_m: null, sensors: {} } }), '');
    const own = { hidden: ['ROOF'], isolate: [], ghost: ['HALL'] };
    assert.equal(writeAddress({ params: own, own }), '', 'the plant\'s own start is not in the address');
    assert.equal(writeAddress({ params: { ...own, hidden: [] }, own }), '#hide=');
    for (const none of [[], null]) // the toolbar sets null
        assert.equal(writeAddress({ params: { isolines: none }, own: { isolines: [50] } }), '#isolines=none');
    assert.deepEqual(readAddress('#isolines=none').params, { isolines: [] });
    assert.equal(writeAddress({ params: { reach_m: null }, own: { reach_m: 5 } }), '#reach=none');
    assert.equal(writeAddress({ params: { reach_m: null }, own: { reach_m: null } }), '');
    assert.deepEqual(readAddress('#reach=none').params, { reach_m: null });
    assert.deepEqual(readAddress('#hide=&ghost=A,B').params, { hidden: [], ghost: ['A', 'B'] });
    assert.deepEqual(readAddress(writeAddress({ params: { look: 'flat', split: { look: 'flat' } } })).params, { look: 'flat', split: {} });
});

test('each quantity and each look of the directions is read back from the address', () => {
    for (const show of ['value', 'operator', 'distance', 'uncertainty', 'blind'])
        assert.deepEqual(readAddress(writeAddress({ params: { show } })).params, { show });
    for (const arrows of ['strokes', 'none'])
        assert.deepEqual(readAddress(writeAddress({ params: { arrows } })).params, { arrows });
    assert.equal(writeAddress({ params: { arrows: 'arrows' } }), '', 'the default is left out');
});

test('a snapshot request has the parameters of the view', () => {
    const view = {
        carried: {
            group: 'g', range: [0, 50], isolines: [], hidden: [], ghost: ['A', 'B'], selected: null, split: { group: 'h', range: [1, 2] },
            sensors: { 'T-1': { strength: 2, decay: 3 } }, clip: { planes: [[1, 0, 0, -2]] }, light: [0, 0, 1],
        },
        camera: { eye: [1, 2, 3], target: [0, 0, 0], up: [0, 1, 0], fov: 45 }, size: { width: 800, height: 600 }, time: { atUs: null },
    };
    assert.deepEqual(snapshotQuery(view), {
        width: 800, height: 600, group: 'g', range: '0,50', ghost: 'A,B', split: 'group=h;range=1,2', sensors: 'T-1=2:3',
        clip: '1,0,0,-2', light: '0,0,1', hidden: '', isolines: 'none', camera: '1,2,3,0,0,0,45', up: '0,1,0',
    });
    const removed = { isolines: null, reach_m: null }, split = { ...removed, breaks: null };
    const { isolines, reach_m, breaks, split: right } = snapshotQuery({ ...view, carried: { ...removed, breaks: [], split } });
    assert.deepEqual([isolines, reach_m, breaks, right], ['none', 'none', undefined, 'isolines=none;reach_m=none'],
        'the sensor group\'s own isolines and reach stay removed');
    const { camera, projection, height_m, at } = snapshotQuery({ ...view, camera: { ...view.camera, height_m: 7 }, time: { atUs: 1e15 } });
    assert.deepEqual([camera, projection, height_m, at], ['1,2,3,0,0,0', 'orthographic', 7, '2001-09-09T01:46:40.000Z']);
});

test('addresses and snapshot requests keep small values and the microseconds of an instant', () => {
    const params = { range: [0.00001, 0.00004], breaks: [0.00002], isolines: [0.000035], light: [0, 0.6, 0.8] };
    const camera = { eye: [1, 2, 3], target: [0, 0, 0], up: [0, 0, 1], fov: 45 }, size = { width: 800, height: 600 };
    for (const atUs of [1793491200123987, 1793491200123000, 1793491200000007]) {
        const read = readAddress(writeAddress({ params, time: { atUs } }));
        assert.deepEqual([read.params, read.time], [params, { atUs }]);
        const { at, range, light } = snapshotQuery({ carried: { ...params, light: [0, 1 / 3, 2 / 3] }, camera, size, time: { atUs } });
        assert.deepEqual([range, light], ['0.00001,0.00004', '0,0.3333,0.6667']);
        assert.equal(readAddress(`#at=${at}`).time.atUs, atUs);
    }
    assert.equal(readAddress('#at=2026-11-01T01:00:00.123987654%2B01:00').time.atUs, Date.UTC(2026, 10, 1) * 1000 + 123987);
});

test('an invalid address counts as none', () => {
    const senseless = [
        '', '#', '#camera=1,2,3', '#camera=NaN,0,0,0,0,0,0,0,1,45', '#ramp=-3', '#ramp=x', '#look=psychedelic', '#%%%',
        '#camera=1,1,1,1,1,1,0,0,1,45', '#range=5,1', '#light=0,0,0', '#sensors=A', '#sensors=A=x',
        '#power=-1', '#show=difference', '#breaks=1,,2',
    ];
    for (const hash of senseless)
        assert.deepEqual(readAddress(hash), { camera: null, params: {}, tag: null, time: {} }, hash);
    assert.deepEqual(readAddress('#asset=E-101'), { camera: null, params: { selected: 'E-101' }, tag: null, time: {} });
});

test('sensor coverage of an asset: distances, or that the locations of its sensors are assumed', async () => {
    await learnWords();
    const { assets: [known, assumed] } = vector('server/gaps.json');
    assert.equal(gapText(known), 'Largest distance to the nearest sensor: 4.50 m. 61 % of the surface is more than 1.25 m away; '
        + '0 % has no data now.');
    assert.match(gapText({ ...known, next: ['TI-1', 'TI-2'], next_m: 2 }), /now\. Most isolated sensor: TI-1, 2\.00 m from TI-2\.$/);
    assert.equal(gapText(assumed), 'The locations of its sensors are assumed, so their distances are unknown.');
});
