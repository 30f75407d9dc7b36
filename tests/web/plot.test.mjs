// SPDX-License-Identifier: GPL-3.0-or-later
// The chart of trends, with an object that records calls instead of the chart library, and the requests of trends to the server.
import assert from 'node:assert/strict';
import { mock, test } from 'node:test';
import { LOOKS } from '../../clients/web/app/trends/chart_style.js';
import { Plot } from '../../clients/web/app/trends/plot.js';
import { Trends } from '../../clients/web/app/trends/trends.js';
import { bands } from '../../clients/web/core/trend_values.js';
import { learnWords } from '../../clients/web/core/words.js';
import { silent, withServer } from './fixtures.mjs';

const SPAN = [0, 100e6];
const series = (tag) => ({ tag, bucket_us: 0, points: [[0, 1, 0], [50e6, 2, 0]] });

class Chart {
    static join = (tables) => [tables[0][0], ...tables.map(([, values]) => values)];

    constructor(options, data) {
        Object.assign(this, { options, data });
    }

    setData(data) {
        this.data = data;
    }

    setScale() {}

    destroy() {}
}

// Returns a plot and a function show(tags, answered), which shows these tags; `answered`: the tags whose series have arrived.
function plotOf(unit) {
    const colours = ['red', 'green', 'blue'];
    const view = { tags: [], look: {}, zone: 'UTC', unitOf: () => unit, colourOf: (tag) => colours[view.tags.indexOf(tag)] };
    const plot = new Plot({ view, units: [unit], isWide: false, isLast: true, element: null, width: 100, height: 100 });
    const show = (tags, answered) => {
        view.tags = tags;
        plot.show(Chart, answered.map((tag) => ({ tag, series: series(tag.name), alarms: [] })), SPAN, SPAN);
        return plot.chart;
    };
    return { show, plot };
}

test('a chart without an answer has axes, and no curve', () => {
    const { options, data } = plotOf('bar').show([{ name: 'A' }], []);
    assert.deepEqual([options.series, data.length, options.axes.length], [[{}], 1, 2]);
});

test('a curve gets the colour of its row again when a row above it is removed', () => {
    const { show } = plotOf('bar'), [a, b] = [{ name: 'A' }, { name: 'B' }];
    assert.equal(show([a, b], [b]).options.series[1].stroke, 'green');
    assert.equal(show([b], [b]).options.series[1].stroke, 'red');
});

test('names of limits that are close together are placed side by side within the chart, or left out', () => {
    const { plot } = plotOf('bar'), written = [];
    const ctx = { save() {}, restore() {}, fillRect() {}, measureText: ({ length }) => ({ width: 10 * length }),
        fillText: (text, x) => written.push([text, x]) };
    globalThis.devicePixelRatio = 1;
    plot.limitsOf = () => ['HH 99', 'H 98', 'L 97', 'LL 20'].map((words, i) => ({ words, colour: 'red', y: i === 3 ? 90 : 10 + i }));
    plot.nameLimits({ ctx, bbox: { left: 40, top: 0, width: 150, height: 100 } });
    assert.deepEqual(written.map(([text]) => text), ['HH 99', 'H 98', 'LL 20']);
    assert.ok(written.every(([text, x]) => x >= 40 && x + 10 * text.length <= 190) && written[1][1] > written[0][1] + 50);
});

// Returns the limits' names that nameLimits() draws in a chart next to a curve through the points [x, y]: [{ text, left, right,
// top, bottom }].
function namesBeside(points, limits) {
    const { plot, show } = plotOf('bar'), drawn = [];
    show([{ name: 'A' }], [{ name: 'A' }]);
    let box;
    const ctx = { save() {}, restore() {}, measureText: ({ length }) => ({ width: 6 * length }),
        fillRect: (left, top, width, height) => { box = { left, top, right: left + width, bottom: top + height }; },
        fillText: (text) => drawn.push({ text, ...box }) };
    plot.limitsOf = () => limits;
    const data = [points.map(([x]) => x), points.map(([, y]) => y)];
    plot.bands = [[]];
    plot.nameLimits({ ctx, bbox: { left: 0, top: 0, width: 300, height: 60 }, data, valToPos: (value) => value });
    return drawn;
}

test('a limit\'s name is on its line beside the curve, shortened or above the line if necessary, or left out', () => {
    const limit = { words: 'TE-101 H 170', short: 'H 170', colour: 'red', y: 20 };
    const [first] = namesBeside([[0, 20], [100, 20], [130, 50], [300, 50]], [limit]);
    assert.equal(first.text, 'TE-101 H 170');
    assert.ok(first.left >= 100 && first.left < 120 && (first.top + first.bottom) / 2 === 20, JSON.stringify(first));
    const [short] = namesBeside([[0, 20], [200, 20], [205, 60], [260, 60], [265, 0], [300, 0]], [limit]);
    assert.equal(short.text, 'H 170', 'a long name is shortened');
    const [above] = namesBeside([[0, 20], [300, 20]], [{ ...limit, y: 40 }, { ...limit, y: 20 }]);
    assert.ok(above.top > 20, 'the name does not cover the curve');
    const zigzag = Array.from({ length: 31 }, (_, i) => [10 * i, i % 2 ? 60 : 0]);
    assert.deepEqual(namesBeside(zigzag, [limit]), [], 'no name is placed beside a curve that is everywhere');
});

const GOOD = 0, UNSURE = 0x40000000, LOST = 0x80000000; // OPC UA status codes

// Calls a method of the chart that draws. A chart of 100 x 100 pixels shows one tag from 0 to 100 s, one pixel per second and per
// unit. Returns the calls of the drawing context: [{ name, args, fillStyle, strokeStyle, globalAlpha, lineWidth }, ...].
function callsOf(method, series, { alarms = [], args = [] } = {}) {
    const { show, plot } = plotOf('bar'), tag = { name: 'A' }, calls = [], state = { canvas: { width: 100, height: 100 } };
    globalThis.devicePixelRatio = 1;
    show([tag], [tag]);
    Object.assign(plot, { rows: [{ tag, series, alarms }], bands: [bands(series)] });
    Object.assign(plot.view, { look: LOOKS.light, priorities: ['#111111', '#222222'], focus: null });
    const ctx = new Proxy(state, { get: (of, name) => of[name] ?? ((...given) => calls.push({ name, args: given, ...of })) });
    const bbox = { left: 0, top: 0, width: 100, height: 100 }, valToPos = (value, scale) => (scale === 'x' ? value : 100 - value);
    plot[method]({ ctx, bbox, valToPos, posToVal: () => 0, series: [{}, { _paths: { stroke: 'curve' } }] }, ...args);
    return { plot, calls, named: (name) => calls.filter((call) => call.name === name) };
}

test('a coarse chart has a translucent band from the lowest to the highest value of each interval', () => {
    const points = [[0, 1, 90, 5, 2, 3, 0, GOOD], [10e6, 20, 40, 30, 30, 40, 0, GOOD]];
    const { named } = callsOf('drawBands', { tag: 'A', bucket_us: 10e6, points });
    assert.deepEqual(named('lineTo').map(({ args }) => args),
        [[0, 10], [10, 10], [10, 60], [20, 60], [20, 80], [10, 80], [10, 99], [0, 99]]);
    const [{ globalAlpha, fillStyle }] = named('fill');
    assert.ok(fillStyle === 'red' && globalAlpha > 0.1 && globalAlpha < 0.5);
});

test('a curve is dashed where its values are uncertain, and only there', () => {
    const points = [[0, 50, GOOD], [20e6, 50, UNSURE], [40e6, 50, GOOD]];
    const { calls, named } = callsOf('drawQuality', { tag: 'A', bucket_us: 0, points }, { args: [1] });
    assert.deepEqual(named('rect').map(({ args }) => args), [[20, 0, 20, 100]], 'the dashes are clipped to the uncertain time');
    const [stroke] = named('stroke'), dash = calls.findLast(({ name }) => name === 'setLineDash').args[0];
    assert.equal(stroke.args[0], 'curve');
    assert.ok(dash.length === 2 && dash.every((px) => px > 2) && stroke.strokeStyle === LOOKS.light.ground,
        'the curve is interrupted with the colour of the ground');
});

test('a time without values is hatched over the whole height of a chart with one tag', () => {
    const points = [[0, 50, GOOD], [30e6, null, LOST], [60e6, 50, GOOD]];
    const { named } = callsOf('drawGaps', { tag: 'A', bucket_us: 0, points });
    assert.deepEqual(named('rect').map(({ args }) => args), [[0, 0, 100, 100], [30, 0, 30, 100]]);
    assert.equal(named('stroke').length, 1);
    assert.ok(named('moveTo').length > 5, 'the hatching has several lines');
});

test('an alarm is a broad line along the curve while it lasts, and a triangle where it was raised', () => {
    const alarm = { us: 10e6, endUs: 30e6, priority: 2, value: 60, limit: 50, tag: 'A', kind: 'H' };
    const { plot, named } = callsOf('drawAlarms', { tag: 'A', bucket_us: 0, points: [[0, 50, GOOD]] }, { alarms: [alarm] });
    const pens = named('stroke').filter(({ args }) => args[0] === 'curve');
    assert.ok(named('rect').length > 0);
    assert.ok(named('rect').every(({ args }) => args.join() === '10,0,20,100'));
    const colours = pens.map(({ strokeStyle }) => strokeStyle), widths = pens.map(({ lineWidth }) => lineWidth);
    assert.deepEqual(colours, [LOOKS.light.edge, '#222222', 'red'], 'edge, priority and curve, one over the other');
    assert.ok(widths[0] > widths[1] && widths[1] > 2 * widths[2]);
    assert.deepEqual([named('moveTo')[0].args[0], named('fill')[0].fillStyle], [10, '#222222']);
    plot.chart.over = { clientWidth: 100 };
    plot.view.spanUs = 100e6;
    assert.deepEqual([plot.alarmsNear(12e6), plot.alarmsNear(60e6)], [[alarm], []]);
});

// Returns trends of the tag TI-1 over the instants 500 to 1000, and the list of notes that the trends show.
function trendsOf() {
    const notes = [], trends = Object.assign(Object.create(Trends.prototype), { tags: [{ name: 'TI-1', unit: '°C' }], span: [500, 1000],
        fixed: [500, 1000], session: { model: {}, token: null }, element: { hidden: true }, plots: [], series: new Map(), alarms: new Map(),
        unknown: [], undrawn: [], unmarked: [], unread: null, note: (text) => notes.push(text) });
    return { notes, trends };
}

// A journal with `count` changes at the instants 1, 2, ..., in which an alarm is raised and clears in turn.
const journal = (count) => (query) => {
    const before = Number(query.get('before') ?? count + 1), limit = Number(query.get('limit'));
    const rows = Array.from({ length: Math.min(limit, before - 1) }, (_, i) => before - 1 - i).map((id) => ({ id, time_us: id, tag: 'TI-1',
        kind: 'H', priority: 2, unit: '°C', ...id % 2 ? { event: 'raise', state: 'active', before: 'normal' }
            : { event: 'clear', state: 'normal', before: 'active' } }));
    return { rows, next_before: before > limit + 1 ? before - limit : null };
};

test('a trend reads the alarms of its whole time range, however many there are, or says that some are missing', async () => {
    const { trends } = trendsOf(), [tag] = trends.tags;
    await withServer(journal(7000), async () => {
        const { alarms, isCut } = await trends.alarmsOf(tag, [2001, 7001]);
        assert.deepEqual([alarms.length, alarms[0].us, alarms.at(-1).us, isCut], [2500, 2001, 6999, false]);
    });
    await withServer(journal(20000), async () => {
        const { alarms, isCut } = await trends.alarmsOf(tag, [2001, 20001]);
        assert.deepEqual([alarms.length, isCut], [5000, true]);
    });
    const old = { tag, kind: 'HH', state: 'acknowledged', active: true, raisedUs: 1, priority: 1, value: 80, limit: 70 };
    trends.session.model.alarms = { rows: new Map([[1, old], [2, { ...old, kind: 'LL', state: 'shelved' }]]) };
    let pages = 0;
    await withServer((query) => { pages++; return journal(20000)(query); }, async () => {
        const { alarms: [first, ...others], isCut } = await trends.alarmsOf(tag, [19001, 20001]);
        assert.deepEqual([first, others.length, isCut, pages],
            [{ us: 1, endUs: null, tag: 'TI-1', kind: 'HH', priority: 1, value: 80, limit: 70 }, 500, false, 1], 'an old active alarm');
    });
    trends.session.model.alarms.rows.clear();
    await withServer(() => ({ rows: [], next_before: null }), async () => {
        assert.deepEqual(await trends.alarmsOf(tag, [0, 1]), { alarms: [], isCut: false });
    });
});

test('a trend keeps its alarms if the journal cannot be read, and says so', async () => {
    await learnWords();
    const { trends, notes } = trendsOf();
    trends.element.hidden = false;
    await withServer(journal(1000), () => trends.askAlarms());
    assert.deepEqual([trends.alarms.get('TI-1').length, notes], [250, []]);
    await withServer(() => { throw new Error(); }, () => trends.askAlarms());
    assert.equal(trends.alarms.get('TI-1').length, 250);
    assert.match(notes.at(-1), /^Alarms could not be read: ./);
    await withServer(journal(1000), () => trends.askAlarms());
    assert.equal(notes.at(-1), '');
});

test('a live trend marks alarms even if their requests take longer than the time until its next values', async () => {
    const { trends } = trendsOf(), { tags } = trends, waiting = [];
    let answer = journal(1000);
    const slow = (query) => new Promise((done) => { waiting.push(() => done(answer(query))); });
    const settle = () => new Promise((done) => { setImmediate(done); });
    trends.element.hidden = false;
    const asks = async (change) => {
        Object.assign(trends, change);
        trends.askAlarms();
        await settle();
        return waiting.length;
    };
    await withServer(slow, async () => {
        assert.deepEqual([await asks({}), await asks({ span: [600, 1100] }), await asks({ span: [700, 1200] })], [1, 1, 1]);
        waiting.pop()();
        await settle();
        assert.deepEqual([trends.alarms.get('TI-1').length, waiting.length], [250, 1], 'then asks once for the newest span');
        waiting.pop()();
        await settle();
        assert.deepEqual([trends.alarms.get('TI-1').length, waiting.length], [150, 0]);
        answer = journal(7000);
        assert.deepEqual([await asks({}), await asks({ tags: [] })], [1, 1]);
        waiting.pop()();
        await settle();
        assert.deepEqual([trends.alarms.size, waiting.length], [0, 0], 'no marks of a removed tag, and no request for its earlier alarms');
        answer = journal(1000);
        assert.deepEqual([await asks({ tags }), await asks({})], [1, 1]);
        trends.element.hidden = true;
        waiting.pop()();
        await settle();
        assert.equal(waiting.length, 0, 'no further requests after the trend was closed');
    });
});

test('a trend abandons a request that the server never answers, and can then ask again', async () => {
    await learnWords();
    const { trends, notes } = trendsOf();
    const node = { append() {}, setAttribute() {}, addEventListener() {}, clientWidth: 800 };
    globalThis.document = { getElementById: () => node, createElement: () => node, head: node };
    mock.timers.enable({ apis: ['setTimeout'] });
    try {
        await withServer(silent, async () => {
            const asked = trends.refresh();
            mock.timers.tick(59000);
            await Promise.resolve();
            assert.deepEqual([trends.isAsking, notes], [true, []]);
            mock.timers.tick(2000);
            await asked;
            assert.equal(trends.isAsking, false);
            assert.match(notes.at(-1), /^No trend: ./);
        });
    } finally {
        mock.timers.reset();
        delete globalThis.document;
    }
});
