// SPDX-License-Identifier: GPL-3.0-or-later
// One chart of a trend: curves of tags with at most two different units over one time axis, with min-max bands, gaps, uncertain
// periods, limits and alarms.
import { shortNumberText } from '../../core/format.js';
import { BAD, gaps, limitLines, line, UNCERTAIN } from '../../core/history.js';
import { extentOf, placeNames } from '../../core/limit_names.js';
import { bands, valueAt } from '../../core/trend_values.js';
import { pointAtInstant } from '../common/crosshair.js';
import { hatch, hatchAlong, strokeAlong, textSize, toCss, toPixels, triangle } from './chart_style.js';

const EXPAND = 2; // argument of uPlot.join(): a null in one series also breaks its line at instants that only other series have
// Sizes in chart units (chart_style.js): AXIS, UNIT: width of a value axis and of its unit; TIME: height of the time axis;
// LINE, BOLD: width of a curve, without and with focus; LABEL, BADGE: height of a limit's name and of a curve's number; TICK:
// length of a tick. DRAGGED_PX: CSS pixels; a shorter movement is no drag.
const AXIS = 58, UNIT = 16, TIME = 28, LINE = 1.75, BOLD = 3, LABEL = 15, BADGE = 13, TICK = 10, DRAGGED_PX = 4;
const PAD = 17, LOW_PAD = 8, LOW = 130; // PAD: space above the curves; LOW_PAD: the same in charts lower than LOW; all in chart units
const DAYS_S = 2 * 86400; // time ranges longer than this many seconds have day ticks on the time axis
const FONT = 'system-ui, sans-serif';

export class Plot {
    // view: the trends (trends.js), with look, clock, zone, session, spanUs, colourOf(tag), unitOf(tag), numberText(tag, value),
    // focus, travel(us), zoomTo([from, to]) and priorities (colours). units: units of this chart, at most two. isWide true:
    // some chart of the trend has two value axes, so this chart leaves room for a second one, too. isLast true: this chart is
    // the lowest and has the time axis labels.
    constructor({ view, units, isWide, isLast, element, width, height }) {
        Object.assign(this, { view, units, isWide, isLast, rows: [], marks: [] });
        this.shape = { width, height };
        this.element = element;
    }

    // Draws the curves. rows: [{ tag, series, alarms }] of the tags with this chart's units; empty until the server has answered. span:
    // first and last instant for which values were requested, in microseconds.
    show(uPlot, rows, span, window) {
        const names = JSON.stringify(rows.map(({ tag }) => [tag.name, this.view.colourOf(tag)]));
        Object.assign(this, { rows, span });
        const tables = rows.map(({ series }) => line(series, ...span))
            .map((table) => (table[0].length > 0 ? table : [[span[0] / 1e6], [null]]));
        // EXPAND: a gap (null) in one tag's series also breaks its line at instants that only other tags' series have
        const data = tables.length > 0 ? uPlot.join(tables, tables.map(() => [EXPAND, EXPAND])) : [[span[0] / 1e6]];
        this.bands = rows.map(({ series }) => bands(series));
        if (this.chart && this.names === names) {
            this.chart.setData(data, false);
        } else {
            this.drop();
            this.names = names;
            this.chart = new uPlot(this.options(), data, this.element);
        }
        this.move(window);
    }

    move([from, to]) {
        this.chart?.setScale('x', { min: from / 1e6, max: to / 1e6 });
    }

    drop() {
        this.chart?.destroy();
        this.chart = null;
    }

    // --- pointer

    // Marks the instant at the pointer of another chart or of the time slider; null: none.
    follow(us) {
        if (!this.chart)
            return;
        const left = us === null ? -10 : this.chart.valToPos(us / 1e6, 'x');
        this.chart.setCursor({ left, top: left < 0 ? -10 : 0 }, false);
    }

    instantAt(left) {
        return this.chart.posToVal(left, 'x') * 1e6;
    }

    listen({ over }) {
        let pressed = null;
        over.addEventListener('pointerdown', ({ clientX }) => { pressed = clientX; });
        over.addEventListener('click', ({ clientX, offsetX }) => {
            if (pressed !== null && Math.abs(clientX - pressed) < DRAGGED_PX)
                this.view.travel(this.instantAt(offsetX));
        });
    }

    onCursor({ cursor }) {
        const isOver = cursor.left >= 0 && cursor.left <= this.chart?.over.clientWidth;
        pointAtInstant(isOver ? this.instantAt(cursor.left) : null, this);
    }

    onSelect(chart) {
        const { left, width } = chart.select;
        if (width > DRAGGED_PX)
            this.view.zoomTo([this.instantAt(left), this.instantAt(left + width)]);
        chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    }

    // --- drawing

    options() {
        const { ink, rule: stroke } = this.view.look, rule = { stroke, width: toCss(1) };
        const font = `${Math.round(toCss(textSize(12)))}px ${FONT}`, { units } = this;
        const axis = { stroke: ink, grid: rule, ticks: { ...rule, size: toCss(TICK) }, gap: toCss(5), font, labelFont: font };
        const scales = Object.fromEntries(units.map((unit) => [unit, { range: (_, low, high) => this.range(unit, low, high) }]));
        const right = this.isWide && units.length < 2 ? toCss(AXIS + UNIT) : null;
        const onlyPlain = (chart, target, handler) => (event) => !event.shiftKey && event.button === 0 && handler(event);
        return {
            ...this.shape, padding: [({ height: high }) => toCss(high < toCss(LOW) ? LOW_PAD : PAD), right, null, null],
            tzDate: (s) => globalThis.uPlot.tzDate(new Date(s * 1000), this.view.zone),
            scales: { x: { time: true }, ...scales },
            cursor: { y: false, points: { show: false }, drag: { x: true, y: false, setScale: false }, bind: { mousedown: onlyPlain,
                dblclick: () => null } },
            legend: { show: false },
            series: [{}, ...this.rows.map(({ tag }) => ({ label: tag.name, scale: this.view.unitOf(tag) || '–', width: toCss(LINE),
                stroke: this.view.colourOf(tag), points: { show: false } }))],
            axes: [{ ...axis, values: (_, all) => all.map((s) => this.tickText(s)), space: toCss(70), size: toCss(this.isLast ? TIME : 8),
                ...(this.isLast ? {} : { values: (_, all) => all.map(() => '') }) },
            ...units.map((unit, i) => ({
                ...axis, scale: unit, label: unit, labelSize: toCss(UNIT), size: toCss(AXIS), space: toCss(30), side: i % 2 ? 1 : 3,
                grid: { ...rule, show: i === 0 },
                values: (_, all) => all.map((value) => shortNumberText(value, 6)),
            }))],
            hooks: { drawAxes: [(u) => this.drawGaps(u), (u) => this.drawLimits(u), (u) => this.drawBands(u)],
                drawSeries: [(u, i) => this.drawQuality(u, i)],
                draw: [(u) => this.nameLimits(u), (u) => this.drawAlarms(u), (u) => this.drawBadges(u), (u) => this.drawInstant(u)],
                setCursor: [(u) => this.chart === u && this.onCursor(u)], setSelect: [(u) => this.onSelect(u)],
                ready: [(u) => this.listen(u)] },
        };
    }

    tickText(s) {
        const { day, time } = this.view.clock(s * 1000), spanS = this.view.spanUs / 1e6;
        if (spanS > DAYS_S)
            return time.startsWith('00:00') || spanS > 7 * DAYS_S ? day : time.slice(0, 5);
        return spanS < 300 ? time : time.slice(0, 5);
    }

    // Returns the range of a value axis. It covers the curves' min-max bands and the alarm limits near the values; including
    // distant limits would flatten the curve.
    range(unit, low, high) {
        let [min, max] = [low ?? Infinity, high ?? -Infinity];
        this.rows.forEach(({ tag }, i) => (this.view.unitOf(tag) || '–') === unit && this.bands[i].flat().forEach(([, , least, most]) => {
            [min, max] = [Math.min(min, least), Math.max(max, most)];
        }));
        if (!(min <= max))
            return [0, 1];
        const [from, to] = [min, max], reach = Math.max(to - from, Math.abs(to) * 0.02, 1e-6);
        for (const { scale, value } of this.limits())
            if (scale === unit && value > from - 2 * reach && value < to + 2 * reach)
                [min, max] = [Math.min(min, value), Math.max(max, value)];
        const margin = Math.max((max - min) * 0.08, reach * 0.1);
        return [min - margin, max + margin];
    }

    // Hatches periods without a value as the plant's picture does: for one tag over the whole height, for several tags where
    // the curves would be.
    drawGaps({ ctx, bbox, valToPos }) {
        ctx.save();
        ctx.beginPath();
        ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
        ctx.clip();
        for (const { tag, series } of this.rows) {
            for (const { from, to } of gaps(series, ...this.span).filter(({ severity }) => severity === BAD)) {
                const left = valToPos(from, 'x', true), right = Math.max(left + 2, valToPos(to, 'x', true));
                if (this.view.tags.length === 1) {
                    hatch(ctx, left, bbox.top, right - left, bbox.height, this.view.look.gap);
                    continue;
                }
                const ends = [valueAt(series, from * 1e6 - 1), valueAt(series, to * 1e6 + 1)];
                const known = ends.filter((value) => value !== null);
                const ys = ends.map((value) => (known.length > 0 ? valToPos(value ?? known[0], this.view.unitOf(tag) || '–', true)
                    : bbox.top + bbox.height / 2));
                hatchAlong(ctx, [left, ys[0]], [right, ys[1]], this.view.colourOf(tag));
            }
        }
        ctx.restore();
    }

    drawBands({ ctx, bbox, valToPos }) {
        ctx.save();
        ctx.beginPath();
        ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
        ctx.clip();
        ctx.globalAlpha = 0.22;
        this.rows.forEach(({ tag }, i) => {
            const scale = this.view.unitOf(tag) || '–', x = (s) => valToPos(s, 'x', true), y = (value) => valToPos(value, scale, true);
            ctx.fillStyle = this.view.colourOf(tag);
            for (const stretch of this.bands[i]) {
                ctx.beginPath();
                stretch.forEach(([from, to, , high]) => { ctx.lineTo(x(from), y(high)); ctx.lineTo(x(to), y(high)); });
                [...stretch].reverse().forEach(([from, to, low]) => { ctx.lineTo(x(to), y(low)); ctx.lineTo(x(from), y(low)); });
                ctx.fill();
            }
        });
        ctx.restore();
    }

    // Draws a curve broken where its values are uncertain, and thicker if its row of the trend's table has the focus.
    drawQuality(chart, index) {
        const { tag, series } = this.rows[index - 1] ?? {};
        if (!tag)
            return;
        const { bbox, valToPos } = chart, colour = this.view.colourOf(tag), x = (s) => valToPos(s, 'x', true);
        const width = this.view.focus === tag && this.view.tags.length > 1 ? BOLD : LINE;
        if (width > LINE)
            strokeAlong(chart, index, bbox.left, bbox.left + bbox.width, { colour, width });
        for (const { from, to } of gaps(series, ...this.span).filter(({ severity }) => severity === UNCERTAIN))
            strokeAlong(chart, index, x(from), x(to), { colour: this.view.look.ground, width: width + 1, dash: [4, 5] });
    }

    // Draws the duration of each alarm as a broad line below the curve, and a triangle where the alarm was raised.
    drawAlarms(chart) {
        const { ctx, bbox, valToPos, posToVal } = chart, found = [];
        this.rows.forEach(({ tag, alarms = [] }, i) => {
            const scale = this.view.unitOf(tag) || '–', x = (us) => valToPos(us / 1e6, 'x', true);
            for (const alarm of [...alarms].sort((a, b) => b.priority - a.priority)) { // most urgent alarms on top
                const colour = this.view.priorities[alarm.priority - 1], left = x(Math.max(alarm.us, this.span[0]));
                const right = x(alarm.endUs ?? this.span[1]), edge = { colour: this.view.look.edge, width: 7.5, alpha: 0.5 };
                for (const pen of [edge, { colour, width: 6 }, { colour: this.view.colourOf(tag), width: LINE }])
                    strokeAlong(chart, i + 1, left, right, pen);
                if (left < bbox.left || left > bbox.left + bbox.width || alarm.us < this.span[0])
                    continue;
                const value = alarm.value ?? alarm.limit, y = Math.min(Math.max(valToPos(value ?? posToVal(0, scale), scale, true),
                    bbox.top + toPixels(14)), bbox.top + bbox.height);
                triangle(ctx, left, y, colour, this.view.look.edge);
                found.push({ alarm, us: alarm.us });
            }
        });
        this.marks = found;
    }

    // Returns the alarms raised within `units` chart units of an instant.
    alarmsNear(us, units = 6) {
        const near = (toCss(units) * this.view.spanUs) / Math.max(1, this.chart?.over.clientWidth ?? 1);
        return this.marks.filter((mark) => Math.abs(mark.us - us) <= near).map(({ alarm }) => alarm);
    }

    // Returns the alarm limits to draw: those of the focused tag, and those shared by all tags of an axis.
    limits() {
        const { view } = this, scaleOf = (tag) => view.unitOf(tag) || '–', tags = this.rows.map(({ tag }) => tag);
        const isShared = ({ scale, name, value }) => {
            const all = tags.filter((tag) => scaleOf(tag) === scale);
            return (all.length > 1 || view.tags.length === 1) && all.every((tag) => tag.limits?.[name] === value);
        };
        return limitLines(tags, scaleOf).map((one) => ({ ...one, tags: one.tags.length > 0 ? one.tags : tags }))
            .filter((one) => isShared(one) || one.tags.includes(view.focus))
            .map((one) => ({ ...one, tags: isShared(one) ? [] : [view.focus] }));
    }

    limitsOf({ scales, valToPos }) {
        const { look } = this.view;
        return this.limits().filter(({ scale, value }) => value >= scales[scale]?.min && value <= scales[scale]?.max)
            .map(({ scale, name, value, tags }) => ({
                y: Math.round(valToPos(value, scale, true)),
                words: [...tags.map((tag) => tag.name), name, shortNumberText(value, 3)].join(' '),
                short: tags.length > 0 ? `${name} ${shortNumberText(value, 3)}` : null,
                colour: tags.length > 0 ? this.view.colourOf(tags[0]) : name.length > 1 ? look.grave : look.limit,
            })).sort((a, b) => a.y - b.y);
    }

    drawLimits(chart) {
        const { ctx, bbox } = chart;
        ctx.save();
        ctx.lineWidth = toPixels(1);
        ctx.setLineDash([6, 4].map(toPixels));
        for (const { y, colour } of this.limitsOf(chart)) {
            ctx.strokeStyle = colour;
            ctx.beginPath();
            ctx.moveTo(bbox.left, y);
            ctx.lineTo(bbox.left + bbox.width, y);
            ctx.stroke();
        }
        ctx.restore();
    }

    // Writes the names of the alarm limits where they do not hide a curve.
    nameLimits(chart) {
        const { ctx, bbox, data, valToPos } = chart, px = toPixels(1), height = (textSize(11) + LABEL - 11) * px;
        const limits = this.limitsOf(chart);
        if (limits.length === 0)
            return;
        const x = (s) => valToPos(s, 'x', true), y = (tag) => (value) => valToPos(value, this.view.unitOf(tag) || '–', true);
        const extents = this.rows.map(({ tag }, i) => extentOf(bbox, data[0], data[i + 1] ?? [], this.bands[i] ?? [], x, y(tag)));
        ctx.save();
        Object.assign(ctx, { font: `${textSize(11) * px}px ${FONT}`, textAlign: 'left', textBaseline: 'middle' });
        const widthOf = (text) => ctx.measureText(text).width + 6 * px;
        for (const { text, left, right, top, colour } of placeNames({ limits, bbox, extents, widthOf, height, gap: 5 * px })) {
            ctx.fillStyle = this.view.look.ground;
            ctx.fillRect(left, top, right - left, height);
            ctx.fillStyle = colour;
            ctx.fillText(text, left + 3 * px, top + height / 2);
        }
        ctx.restore();
    }

    // Draws each curve's number at its end. The table shows the same numbers, so that curves can be told apart without colour.
    drawBadges(chart) {
        const { ctx, bbox, valToPos, data, scales: { x: { min, max } } } = chart, px = toPixels(1), size = (textSize(10) + BADGE - 10) * px;
        if (this.view.tags.length < 2)
            return;
        const ends = this.rows.map(({ tag }, i) => {
            // a chart that is about to be replaced may have fewer columns than tags: then the number is not drawn
            const k = data[i + 1]?.findLastIndex((value, n) => Number.isFinite(value) && data[0][n] <= max && data[0][n] >= min) ?? -1;
            return k < 0 ? null : { tag, x: Math.min(valToPos(data[0][k], 'x', true), bbox.left + bbox.width - size / 2),
                y: valToPos(data[i + 1][k], this.view.unitOf(tag) || '–', true) };
        }).filter(Boolean).sort((a, b) => a.y - b.y);
        ctx.save();
        Object.assign(ctx, { font: `600 ${textSize(10) * px}px ${FONT}`, textAlign: 'center', textBaseline: 'middle' });
        let below = -Infinity;
        ends.forEach((end, i) => {
            const room = (ends.length - 1 - i) * size, most = bbox.top + bbox.height - size / 2 - room;
            const y = Math.min(Math.max(end.y, below + size, bbox.top + size / 2), most);
            below = y;
            ctx.fillStyle = this.view.colourOf(end.tag);
            ctx.fillRect(end.x - size / 2, y - size / 2, size, size - px);
            ctx.fillStyle = this.view.look.ground;
            ctx.fillText(String(this.view.tags.indexOf(end.tag) + 1), end.x, y);
        });
        ctx.restore();
    }

    drawInstant({ ctx, bbox, valToPos }) {
        const { atUs } = this.view.session.time, x = Math.round(valToPos(atUs / 1e6, 'x', true));
        if (atUs === null || x < bbox.left || x > bbox.left + bbox.width)
            return;
        ctx.save();
        ctx.strokeStyle = this.view.look.then;
        ctx.lineWidth = toPixels(2);
        ctx.beginPath();
        ctx.moveTo(x, bbox.top);
        ctx.lineTo(x, bbox.top + bbox.height);
        ctx.stroke();
        ctx.restore();
    }
}
