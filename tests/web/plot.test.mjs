// SPDX-License-Identifier: GPL-3.0-or-later
// The chart of trends, with an object that records calls instead of the chart library.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Plot } from '../../clients/web/app/trends/plot.js';

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
