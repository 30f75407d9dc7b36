// SPDX-License-Identifier: GPL-3.0-or-later
// A chart of a trend, with a recorder in place of the chart library.
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

// Returns a plot, and show(tags, answered), which shows these tags, of which `answered` have a series.
function plotOf(unit) {
    const colours = ['red', 'green', 'blue'];
    const view = { tags: [], look: {}, zone: 'UTC', unitOf: () => unit, colourOf: (tag) => colours[view.tags.indexOf(tag)] };
    const plot = new Plot({ view, units: [unit], isWide: false, isLast: true, element: null, width: 100, height: 100 });
    const show = (tags, answered) => {
        view.tags = tags;
        plot.show(Chart, answered.map((tag) => ({ tag, series: series(tag.name), alarms: [] })), SPAN, SPAN);
        return plot.chart;
    };
    return { show };
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
