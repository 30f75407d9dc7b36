// SPDX-License-Identifier: GPL-3.0-or-later
// Trend charts of tags: recorded values of the last hour, shift, day or week, with limits, gaps and units. Several tags can be compared.
import { decimalsFor, numberText, shortNumberText, unitText, zoneClock, zoneOf } from '../../core/format.js';
import { ask, BAD, gaps, limitLines, line } from '../../core/history.js';
import { travel } from '../../core/requests.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';
import { fillSegments, markSegment } from '../common/choices.js';
import { dots, hatch, LOOKS } from './chart_style.js';

const SPANS = [['3600', 'hour'], ['28800', 'shift'], ['86400', 'day'], ['604800', 'week']];
const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3], [5, 5], [1, 4]];
const MOST = DASHES.length, FRESH_MS = 5000, AXIS_PX = 58;
const EXPAND = 2; // uPlot's mode in which gaps (nulls) extend to neighbouring instants
const LIMIT_PX = 15;
// true: this page is a trend pane of a wall, and the chart fills the pane
const isPane = () => document.body.classList.contains('pane-trend');
const highPx = () => (isPane() ? Math.max(80, byId('trend-chart').clientHeight)
    : Math.round(Math.max(120, Math.min(210, 0.2 * innerHeight)))); // must equal the height of #trend-chart in the style sheet

// Loads the chart library with the first trend. If that fails, the next refresh tries again.
let library;
function load() {
    library ??= new Promise((done, fail) => {
        const style = make('link', { rel: 'stylesheet', href: 'vendor/uPlot.css' });
        const script = make('script', { src: 'vendor/uPlot.js' });
        script.addEventListener('load', () => done(globalThis.uPlot));
        script.addEventListener('error', () => {
            library = null;
            style.remove();
            script.remove();
            fail(new Error(say('trends.uncharted')));
        });
        document.head.append(style, script);
    });
    return library;
}

export class Trends {
    constructor({ session }) {
        Object.assign(this, { session, tags: [], spanS: 3600, series: [], number: 0, pending: 0 });
        this.element = byId('trends');
        const spans = SPANS.map(([seconds, name]) => [seconds, say(`trends.${name}`), say(`trends.${name}.why`)]);
        fillSegments(byId('trend-span'), 'trend-span', spans, (span) => {
            this.spanS = Number(span);
            this.refresh();
        });
        byId('trend-close').addEventListener('click', () => this.close());
        byId('trend-csv').addEventListener('click', () => this.save());
        session.on('time', () => this.chart?.redraw(false));
        session.on('params', () => this.chart && this.theme !== this.shownTheme && this.draw(globalThis.uPlot));
        session.greeted(() => {
            this.zone = zoneOf(session.model.plant.time_zone);
            this.clock = zoneClock(this.zone);
            this.tags = this.tags.map(({ name }) => session.model.tag(name)).filter(Boolean);
        });
        setInterval(() => this.isOpen && !document.hidden && !this.pending && this.refresh(), FRESH_MS);
        new ResizeObserver(() => this.resize()).observe(byId('trend-chart'));
    }

    get theme() {
        return document.documentElement.dataset.theme;
    }

    get look() {
        return LOOKS[this.theme] ?? LOOKS.light;
    }

    get isOpen() {
        return !this.element.hidden;
    }

    // Shows this tag alone.
    only(tag) {
        this.tags = [tag];
        this.open();
    }

    // Shows these tags, over the given span.
    compare(tags, spanS) {
        Object.assign(this, { tags: tags.slice(0, MOST), spanS });
        this.open();
    }

    // Adds a tag to the chart.
    add(tag) {
        if (this.takes(tag))
            this.tags = [...this.tags, tag];
        this.open();
    }

    // Returns true if the tag can be added to the open chart.
    takes(tag) {
        return this.isOpen && this.tags.length < MOST && !this.tags.includes(tag);
    }

    open() {
        this.element.hidden = false;
        this.show();
        this.refresh();
    }

    remove(tag) {
        this.tags = this.tags.filter((one) => one !== tag);
        if (this.tags.length === 0)
            return this.close();
        this.show();
        return this.refresh();
    }

    close() {
        this.element.hidden = true;
        this.drop();
    }

    drop() {
        this.chart?.destroy();
        this.chart = null;
    }

    show() {
        markSegment(byId('trend-span'), String(this.spanS));
        byId('trend-tags').replaceChildren(...this.tags.map((tag, i) => {
            const title = say('trends.remove', { tag: tag.name }), unit = this.unitOf(tag);
            const sample = make('span', { class: `sample s${i}`, 'aria-hidden': 'true' });
            return make('li', {}, sample, make('b', {}, tag.name), ` ${tag.description ?? ''}${unit ? ` [${unit}]` : ''}`,
                make('button', { type: 'button', class: 'drop', 'aria-label': title, onclick: () => this.remove(tag) }, '×'));
        }));
    }

    unitOf(tag) {
        return unitText(tag.unit || this.session.model.group(tag.group)?.unit);
    }

    // Time range of the chart: up to now or, while the past is shown, around that instant.
    get window() {
        const now = this.session.clockUs(), { atUs } = this.session.time, span = this.spanS * 1e6;
        const to = atUs !== null && atUs < now - span ? Math.min(now, atUs + span / 2) : now;
        return [to - span, to];
    }

    query([from, to]) {
        return { tags: this.tags.map(({ name }) => name).join(','), from: (from / 1e6).toFixed(3), to: (to / 1e6).toFixed(3) };
    }

    // Requests and draws the values. `pending` counts requests without an answer; while there are any, the timer sends no further one. It
    // would discard the answer to the pending one, so that on a slow link no answer would ever be drawn.
    async refresh() {
        if (this.tags.length === 0 || !this.session.model)
            return;
        this.pending++;
        const number = ++this.number, span = this.window, points = Math.max(200, Math.round(byId('trend-chart').clientWidth / 2));
        try {
            const answer = ask('api/v1/history', { ...this.query(span), points }, this.session.token);
            const [uPlot, response] = await Promise.all([load(), answer]);
            const { series } = await response.json();
            if (number !== this.number || !this.isOpen)
                return;
            this.span = span;
            this.series = series;
            setText(byId('trend-note'), this.words());
            this.draw(uPlot);
        } catch (error) {
            if (number === this.number)
                setText(byId('trend-note'), say('trends.failed', { why: error.message }));
        } finally {
            this.pending--;
        }
    }

    words() {
        const [from, to] = this.span;
        const lacking = this.series.filter((one) => gaps(one, from, to).some(({ severity }) => severity === BAD)).map(({ tag }) => tag);
        return lacking.length > 0 ? say('trends.gaps', { tags: lacking.join(', ') }) : '';
    }

    data(uPlot) {
        const tables = this.series.map((one) => line(one, ...this.span));
        const filled = tables.map((table) => (table[0].length > 0 ? table : [[this.span[0] / 1e6], [null]]));
        return uPlot.join(filled, filled.map(() => [EXPAND, EXPAND])); // a gap in one series must extend over the instants of the others
    }

    draw(uPlot) {
        const shape = JSON.stringify([this.tags.map(({ name }) => name), this.spanS, this.theme]);
        const [min, max] = this.span.map((us) => us / 1e6);
        if (this.chart && this.shape === shape) {
            this.chart.setData(this.data(uPlot), false);
            this.chart.setScale('x', { min, max });
            return;
        }
        this.drop();
        this.shape = shape;
        this.shownTheme = this.theme;
        this.chart = new uPlot(this.options(), this.data(uPlot), byId('trend-chart'));
        this.chart.setScale('x', { min, max });
    }

    resize() {
        const width = byId('trend-chart').clientWidth;
        if (this.chart && width > 0 && (width !== this.chart.width || highPx() !== this.chart.height))
            this.chart.setSize({ width, height: highPx() });
    }

    // --- drawing

    options() {
        const units = [...new Set(this.tags.map((tag) => this.unitOf(tag) || '–'))];
        const { ink, rule: stroke } = this.look, rule = { stroke, width: 1 }, font = '12px system-ui, sans-serif';
        const axis = { stroke: ink, grid: rule, ticks: rule, font, labelFont: font };
        const scales = Object.fromEntries(units.map((unit) => [unit, { range: (_, low, high) => this.range(unit, low, high) }]));
        const dateOf = (s) => this.clock(s * 1000);
        const tickText = (s) => (this.spanS > 2 * 86400 ? dateOf(s).day : dateOf(s).time.slice(0, 5));
        return {
            width: Math.max(200, byId('trend-chart').clientWidth), height: highPx(),
            tzDate: (s) => globalThis.uPlot.tzDate(new Date(s * 1000), this.zone),
            scales: { x: { time: true }, ...scales },
            cursor: { drag: { x: false, y: false } },
            legend: { live: true },
            series: [{ label: say('trends.time'), value: (_, s) => (s === null ? '–' : `${dateOf(s).date} ${dateOf(s).time}`) },
                ...this.tags.map((tag, i) => this.lineOf(tag, i))],
            axes: [{ ...axis, values: (_, all) => all.map(tickText), space: 70, size: 28 }, ...units.map((unit, i) => ({
                ...axis, scale: unit, label: unit, labelSize: 16, size: AXIS_PX, side: i % 2 ? 1 : 3,
                show: i < 2, grid: { ...rule, show: i === 0 },
            }))],
            hooks: { drawAxes: [(u) => this.drawGaps(u), (u) => this.drawLimits(u)],
                draw: [(u) => this.nameLimits(u), (u) => this.drawInstant(u)],
                ready: [(u) => u.over.addEventListener('click', () => this.goTo(u))] },
        };
    }

    lineOf(tag, i) {
        const group = this.session.model.group(tag.group), decimals = group ? decimalsFor(group.max - group.min) : 2;
        return {
            label: tag.name, scale: this.unitOf(tag) || '–', stroke: this.look.lines[i], dash: DASHES[i], width: 1.75,
            points: { show: false },
            value: (_, value) => (value === null || value === undefined ? '–' : `${numberText(value, decimals)} ${this.unitOf(tag)}`),
        };
    }

    // Returns the range of an axis. It includes limits that are near the values; distant limits would only flatten the curve.
    range(unit, low, high) {
        if (low === null || high === null)
            return [0, 1];
        let [min, max] = [low, high];
        const reach = Math.max(high - low, Math.abs(high) * 0.02, 1e-6);
        for (const tag of this.tags.filter((one) => (this.unitOf(one) || '–') === unit))
            for (const limit of Object.values(tag.limits ?? {}).filter(Number.isFinite)) {
                if (limit > low - 2 * reach && limit < high + 2 * reach)
                    [min, max] = [Math.min(min, limit), Math.max(max, limit)];
            }
        const margin = Math.max((max - min) * 0.08, reach * 0.1);
        return [min - margin, max + margin];
    }

    // Draws periods without a value hatched, as in the plant's picture, and uncertain ones dotted along the bottom. With several tags, each
    // has a row.
    drawGaps({ ctx, bbox, valToPos }) {
        const rows = this.series.length;
        ctx.save();
        ctx.beginPath();
        ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
        ctx.clip();
        this.series.forEach((one, i) => {
            const top = bbox.top + bbox.height * i / rows, height = bbox.height / rows;
            for (const { from, to, severity } of gaps(one, ...this.span)) {
                const left = valToPos(from, 'x', true), right = Math.max(left + 2, valToPos(to, 'x', true));
                if (severity === BAD)
                    hatch(ctx, left, top, right - left, height, rows > 1 ? this.look.lines[i] : this.look.gap);
                else
                    dots(ctx, left, right, top + height - 5, this.look.lines[i]);
            }
        });
        ctx.restore();
    }

    limitsOf({ scales, valToPos }) {
        return limitLines(this.tags, (tag) => this.unitOf(tag) || '–').filter(({ scale, value }) =>
            value >= scales[scale]?.min && value <= scales[scale]?.max).map(({ scale, name, value, tags }) => ({
            y: Math.round(valToPos(value, scale, true)), words: [...tags.map((tag) => tag.name), name, shortNumberText(value, 3)].join(' '),
            colour: tags.length > 0 ? this.look.lines[this.tags.indexOf(tags[0])] : name.length > 1 ? this.look.grave : this.look.limit,
        })).sort((a, b) => a.y - b.y);
    }

    drawLimits(chart) {
        const { ctx, bbox } = chart;
        ctx.save();
        ctx.lineWidth = devicePixelRatio;
        ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
        for (const { y, colour } of this.limitsOf(chart)) {
            ctx.strokeStyle = colour;
            ctx.beginPath();
            ctx.moveTo(bbox.left, y);
            ctx.lineTo(bbox.left + bbox.width, y);
            ctx.stroke();
        }
        ctx.restore();
    }

    // Writes the name of each limit at its line, over everything else. If lines are close together, a name goes next to the previous one.
    nameLimits(chart) {
        const { ctx, bbox } = chart, px = devicePixelRatio, height = LIMIT_PX * px, placed = [];
        ctx.save();
        ctx.font = `${11 * px}px system-ui, sans-serif`;
        ctx.textAlign = 'left';
        ctx.textBaseline = 'middle';
        for (const { y, words, colour } of this.limitsOf(chart)) {
            const near = placed.filter((other) => Math.abs(other.y - y) < height);
            const left = Math.max(bbox.left, ...near.map((other) => other.right)) + 5 * px;
            const right = left + ctx.measureText(words).width + 6 * px;
            const middle = Math.max(bbox.top + height / 2, y);
            placed.push({ y, right });
            ctx.fillStyle = this.look.ground;
            ctx.fillRect(left, middle - height / 2, right - left, height);
            ctx.fillStyle = colour;
            ctx.fillText(words, left + 3 * px, middle);
        }
        ctx.restore();
    }

    drawInstant({ ctx, bbox, valToPos }) {
        const { atUs } = this.session.time;
        if (atUs === null || atUs < this.span[0] || atUs > this.span[1])
            return;
        const x = Math.round(valToPos(atUs / 1e6, 'x', true));
        ctx.save();
        ctx.strokeStyle = this.look.then;
        ctx.lineWidth = 2 * devicePixelRatio;
        ctx.beginPath();
        ctx.moveTo(x, bbox.top);
        ctx.lineTo(x, bbox.top + bbox.height);
        ctx.stroke();
        ctx.restore();
    }

    goTo(chart) {
        const seconds = chart.posToVal(chart.cursor.left, 'x');
        if (this.session.recorded && Number.isFinite(seconds))
            travel(this.session, seconds * 1e6);
    }

    async save() {
        try {
            const response = await ask('api/v1/history', { ...this.query(this.window), points: 20000, format: 'csv' }, this.session.token);
            const url = URL.createObjectURL(await response.blob());
            make('a', { href: url, download: `${this.tags.map(({ name }) => name).join('_')}.csv` }).click();
            setTimeout(() => URL.revokeObjectURL(url), 10000);
        } catch (error) {
            setText(byId('trend-note'), say('trends.unsaved', { why: error.message }));
        }
    }
}
