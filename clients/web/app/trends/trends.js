// SPDX-License-Identifier: GPL-3.0-or-later
// Trends of up to eight tags: recorded values over a relative or absolute time range, with zoom and pan. Plot draws the curves,
// two units to a chart; TrendTable shows numbers.
import { calls, isGone } from '../../core/alarms.js';
import { timeOrDay, unitText, valueText, zoneClock, zoneOf } from '../../core/format.js';
import { BAD, gaps } from '../../core/history.js';
import { ask, askInTime } from '../../core/http.js';
import { fieldText } from '../../core/instant.js';
import { travel } from '../../core/requests.js';
import { newSpanS, panned, readRange, zoomed } from '../../core/trend_range.js';
import { alarmSpans } from '../../core/trend_values.js';
import { say } from '../../core/words.js';
import { onCrosshair } from '../common/crosshair.js';
import { byId, make, phone, setText } from '../common/dom.js';
import { fillSegments, markSegment } from '../common/choices.js';
import { LOOKS, setChartUnit } from './chart_style.js';
import { listenToDrags } from './drag_in.js';
import { Plot } from './plot.js';
import { listenToGestures } from './trend_gestures.js';
import { TrendTable } from './trend_table.js';

const SPANS = [['3600', 'hour'], ['28800', 'shift'], ['86400', 'day'], ['604800', 'week'], ['2592000', 'month']];
const EXAMPLES = ['minutes', 'hours', 'today', 'yesterday', 'night'];
const MOVES = ['earlier', 'later', 'in', 'out', 'back'];
const MOST = LOOKS.light.lines.length, UNITS_PER_PLOT = 2, FRESH_MS = 5000, NOW_MS = 1000, SETTLED_MS = 250, PAN = 0.5, ZOOM = 2;
// ALARM_PAGES: maximum number of requests, of ALARM_ROWS rows of the alarm journal each, for the alarms of a tag
const ALARM_ROWS = 2000, ALARM_PAGES = 5, MATCHES = 30, MOST_BACK = 50, ALMOST_US = 2e6;
const WALL_TEXT = 13; // minimum font size of charts on a video wall, in units of the page: 16 minutes of arc (wall.js)
const HEAD_PX = 24, ROW_PX = 22; // heights in the table
// minimum height of a phone's charts in CSS pixels; if all charts together have less room, the trend shows one at a time, with a switch
const LEAST_CHART_PX = 100;
// true: charts fill the space that the table leaves, in a video wall's trend pane or in a phone's sheet
const fills = () => document.body.classList.contains('pane-trend') || phone.matches;

// Returns the height in pixels of each of `count` charts next to a table of `rows` rows.
function heightOf(count, rows) {
    if (fills())
        return Math.max(80, byId('trend-chart').clientHeight / count);
    const least = Math.max(120, Math.min(210, 0.2 * innerHeight)); // the same value as the height of #trend-chart in trends.css
    // height of a single chart: that of the table, but at least `least` and at most 0.26 of the window's height
    const one = Math.max(least, Math.min(0.26 * innerHeight, HEAD_PX + ROW_PX * rows));
    return Math.round(count === 1 ? one : Math.max(96, one * 0.7));
}

// Loads the chart library when the first trend opens. If loading fails, the next refresh retries.
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
    // page: the page's parts (main.js)
    constructor(page) {
        const { session, overlay, handlers } = page;
        Object.assign(this, { page, session, tags: [], plots: [], focus: null, isAsking: false, isAskingAlarms: false });
        Object.assign(this, { turn: 0, isSwitched: false }); // turn: index of the chart shown while isSwitched (one chart at a time)
        Object.assign(this, { spanS: newSpanS(null), fixed: null, before: [] });
        this.unread = null; // the text in the range field, if it was not understood
        this.isChosen = false; // true: a user or a video wall's trend pane has set the time range; false: it is the default
        this.unknown = []; // names in the trend's list that are not tags of this plant
        this.undrawn = []; // names of tags that are not drawn, because the trend already has its maximum number of tags
        this.series = new Map(); // tag name -> its recorded series; empty until the server has answered
        this.alarms = new Map(); // tag name -> its alarms in the time range
        this.unmarked = []; // texts that say which alarms of the time range the charts do not mark
        this.element = byId('trends');
        this.addControls();
        this.table = new TrendTable(this);
        session.on('time', () => this.onTime());
        session.on('params', () => this.plots.length > 0 && this.theme !== this.shownTheme && this.rebuild());
        session.greeted(() => {
            this.zone = zoneOf(session.model.plant.time_zone);
            this.clock = zoneClock(this.zone);
            this.setNames([...this.tags.map(({ name }) => name), ...this.undrawn, ...this.unknown]);
            if (this.isOpen)
                this.showTags();
        });
        onCrosshair((us, from) => this.onCrosshair(us, from));
        setInterval(() => this.isOpen && !document.hidden && this.isLive && !this.isAsking && this.refresh(), FRESH_MS);
        setInterval(() => this.isOpen && !document.hidden && session.model && this.table.fill(), NOW_MS);
        new ResizeObserver(() => this.resize()).observe(byId('trend-chart'));
        listenToGestures(this, byId('trend-chart'));
        listenToDrags({ trends: this, session, overlay, handlers });
    }

    addControls() {
        const spans = SPANS.map(([seconds, name]) => [seconds, say(`trends.${name}`), say(`trends.${name}.why`)]);
        fillSegments(byId('trend-span'), 'trend-span', spans, (span) => this.goTo({ spanS: Number(span) }));
        for (const name of MOVES)
            byId(`trend-${name}`).addEventListener('click', () => this.step(name));
        byId('trend-close').addEventListener('click', () => this.close());
        byId('trend-csv').addEventListener('click', () => this.save());
        byId('trend-ranges').append(...EXAMPLES.map((name) => make('option', { value: say(`trends.example.${name}`) })));
        const range = byId('trend-range'), add = byId('trend-add');
        // the browser filters the list of example ranges by the field's text, so the text becomes the placeholder while the field has the
        // focus; a text that was not understood stays, so that users can correct it
        range.addEventListener('focus', () => this.unread === null && Object.assign(range, { placeholder: range.value, value: '' }));
        range.addEventListener('blur', () => { range.value ||= range.placeholder; });
        range.addEventListener('input', () => this.markRange(null));
        add.addEventListener('input', () => this.offer(add.value));
        for (const [field, f] of [[range, () => this.typeRange()], [add, () => this.typeTag()]]) {
            field.addEventListener('change', f);
            field.form.addEventListener('submit', (event) => { event.preventDefault(); f(); });
        }
    }

    // --- for Plot and TrendTable

    get theme() {
        return document.documentElement.dataset.theme;
    }

    get look() {
        return LOOKS[this.theme] ?? LOOKS.light;
    }

    // Size of a chart unit in CSS pixels. On a wall, the style sheet magnifies only the table; charts use larger units instead,
    // which keeps them sharp.
    get unit() {
        return document.body.classList.contains('pane-trend') ? this.page.unit : 1;
    }

    get priorities() {
        const style = getComputedStyle(document.documentElement);
        return [1, 2, 3, 4].map((priority) => style.getPropertyValue(`--p${priority}`).trim());
    }

    colourOf(tag) {
        return this.look.lines[this.tags.indexOf(tag)] ?? this.look.ink;
    }

    unitOf(tag) {
        return unitText(tag.unit || this.session.model.group(tag.group)?.unit);
    }

    numberText(tag, value) {
        return valueText(this.session.model.group(tag.group), value);
    }

    setFocus(tag) {
        this.focus = tag;
        this.table.build();
        this.turnTo(tag);
        this.redraw();
    }

    travel(us) {
        if (this.session.recorded && Number.isFinite(us))
            travel(this.session, us);
    }

    // --- tags

    get isOpen() {
        return !this.element.hidden;
    }

    setTags(tags) {
        this.tags = tags;
        if (!tags.includes(this.focus))
            this.focus = tags[0] ?? null;
        const names = new Set(tags.map(({ name }) => name));
        this.series = new Map([...this.series].filter(([name]) => names.has(name)));
        if (this.plots.length === 0)
            return;
        this.note(this.words());
        this.draw(globalThis.uPlot);
    }

    // Sets the tags by name. Names without a tag in the plant, and names beyond the maximum number of tags, are listed below
    // the charts.
    setNames(names) {
        const { model } = this.session, tags = names.map((name) => model.tag(name)).filter(Boolean);
        this.unknown = names.filter((name) => !model.tag(name));
        this.undrawn = tags.slice(MOST).map(({ name }) => name);
        this.setTags(tags.slice(0, MOST));
    }

    // Builds the table's rows for the tags and requests their values; closes the trend if there are neither tags nor unknown
    // names.
    showTags() {
        if (this.tags.length === 0 && this.unknown.length === 0)
            return this.close();
        this.table.build();
        if (this.tags.length === 0)
            this.note(this.words());
        return this.refresh();
    }

    // Shows this tag alone.
    only(tag) {
        this.setNames([tag.name]);
        this.open();
    }

    // Opens the trend with the tags of these names, over the last spanS seconds.
    compare(names, spanS) {
        Object.assign(this, { spanS, fixed: null, isChosen: true });
        this.setNames(names);
        this.open();
    }

    // Adds a tag to the chart.
    add(tag) {
        if (this.takes(tag)) {
            this.setTags([...this.tags, tag]);
            this.turnTo(tag);
        } else if (this.isOpen && this.tags.length >= MOST)
            this.note(say('trends.full', { count: MOST }));
        this.open();
    }

    // Returns true if the tag can be added to the open chart: the chart has fewer tags than the maximum and does not show this
    // tag yet.
    takes(tag) {
        return this.isOpen && this.tags.length < MOST && !this.tags.includes(tag);
    }

    remove(tag) {
        this.setTags(this.tags.filter((one) => one !== tag));
        return this.showTags();
    }

    // Fills the list of tags with those matching a typed text.
    offer(text) {
        const wanted = text.trim().toLowerCase(), { tags } = this.session.model;
        this.matches = wanted ? tags.filter((tag) => !this.tags.includes(tag) &&
            `${tag.name} ${tag.description ?? ''}`.toLowerCase().includes(wanted)).slice(0, MATCHES) : [];
        byId('trend-names').replaceChildren(...this.matches.map((tag) => make('option', { value: tag.name }, tag.description ?? '')));
    }

    typeTag() {
        const field = byId('trend-add'), text = field.value.trim();
        this.offer(text);
        const tag = this.session.model.tag(text) ?? this.matches[0];
        if (!text)
            return;
        if (tag)
            this.add(tag);
        else
            this.note(say('trends.none', { text }));
        field.value = '';
    }

    // --- range

    get nowUs() {
        return this.session.clockUs() ?? Date.now() * 1000;
    }

    // Time range of the charts: the fixed one if set; otherwise a span up to now, or around the past instant shown.
    get range() {
        if (this.fixed)
            return this.fixed;
        const now = this.nowUs, { atUs } = this.session.time, span = this.spanS * 1e6;
        const to = atUs !== null && atUs < now - span ? Math.min(now, atUs + span / 2) : now;
        return [to - span, to];
    }

    get spanUs() {
        const [from, to] = this.range;
        return to - from;
    }

    get isLive() {
        return !this.fixed || this.fixed[1] > this.nowUs - FRESH_MS * 1000;
    }

    // Sets the time span of a trend that is being opened, unless a user or a video wall's trend pane has set one.
    chooseSpan() {
        const { fromUs } = this.session.time;
        if (!this.isChosen && !this.isOpen)
            this.spanS = newSpanS(fromUs === null ? null : (this.nowUs - fromUs) / 1e6);
    }

    // Shows a time range in the form of readRange()'s result.
    goTo({ spanS, fromUs, toUs }, isUndone = false) {
        if (!isUndone)
            this.before = [...this.before.slice(1 - MOST_BACK), { spanS: this.spanS, fixed: this.fixed }];
        Object.assign(this, spanS ? { spanS, fixed: null } : { fixed: [fromUs, toUs] }, { isChosen: true });
        this.showRange();
        this.plots.forEach((plot) => plot.move(this.range));
        this.refresh();
    }

    zoomTo([fromUs, toUs]) {
        const [from, to] = zoomed([fromUs, toUs], 1, (fromUs + toUs) / 2, this.nowUs);
        this.goTo({ fromUs: from, toUs: to });
    }

    zoomBy(factor, at) {
        this.adjust(zoomed(this.range, factor, at, this.nowUs));
    }

    // Moves the charts by a fraction of their time range; positive: later.
    pan(part) {
        this.adjust(panned(this.range, part, this.nowUs));
    }

    // Shows a time range set by a gesture (wheel, pinch, drag, key), which takes many small steps. Steps in quick succession
    // become a single undo step.
    adjust([fromUs, toUs]) {
        if (!Number.isFinite(fromUs + toUs))
            return;
        const isNext = performance.now() - (this.adjustedAt ?? -Infinity) < NOW_MS;
        this.adjustedAt = performance.now();
        const isSpan = toUs > this.nowUs - ALMOST_US && Math.abs(toUs - fromUs - this.spanS * 1e6) < ALMOST_US;
        this.goTo(isSpan ? { spanS: this.spanS } : { fromUs, toUs }, isNext);
    }

    back() {
        const last = this.before.pop();
        if (last)
            this.goTo(last.fixed ? { fromUs: last.fixed[0], toUs: last.fixed[1] } : last, true);
    }

    step(name) {
        const [from, to] = this.range;
        ({ earlier: () => this.pan(-PAN), later: () => this.pan(PAN), back: () => this.back(),
            in: () => this.zoomBy(1 / ZOOM, (from + to) / 2), out: () => this.zoomBy(ZOOM, (from + to) / 2) })[name]();
    }

    typeRange() {
        const field = byId('trend-range'), text = field.value.trim();
        if (!text)
            return;
        const range = readRange(text, this.nowUs, this.zone);
        this.markRange(range ? null : text);
        if (!range)
            return;
        this.goTo(range);
        field.blur();
    }

    // Marks the text in the range field as not understood, with a message below the charts; null: removes both.
    markRange(unread) {
        byId('trend-range').setAttribute('aria-invalid', String(unread !== null));
        if (unread === this.unread)
            return;
        this.unread = unread;
        this.note(this.words());
    }

    // Returns the time range as a text that readRange() understands.
    rangeText() {
        if (!this.fixed) {
            const [unit, n] = this.spanS % 86400 === 0 ? ['d', this.spanS / 86400] : this.spanS % 3600 === 0 ? ['h', this.spanS / 3600]
                : this.spanS % 60 === 0 ? ['min', this.spanS / 60] : ['s', this.spanS];
            return say('trends.last', { span: say(`age.${unit}`, { n }) });
        }
        const isLong = this.spanUs > 3600e6;
        const [from, to] = this.fixed.map((us) => fieldText(us, this.zone).replace('T', ' ').replace(isLong ? /:\d\d$/ : /:00$/, ''));
        return say('trends.between', { from, to });
    }

    showRange() {
        const field = byId('trend-range'), text = this.zone ? this.rangeText() : '';
        if (document.activeElement !== field) {
            field.value = text;
            this.markRange(null);
        }
        field.placeholder = text;
        markSegment(byId('trend-span'), this.fixed ? '' : String(this.spanS));
        byId('trend-back').disabled = this.before.length === 0;
        byId('trend-later').disabled = this.isLive && this.session.time.atUs === null;
    }

    // --- values

    open() {
        this.chooseSpan();
        this.element.hidden = false;
        this.showRange();
        this.showTags();
    }

    close() {
        this.element.hidden = true;
        Object.assign(this, { unknown: [], undrawn: [], unmarked: [] });
        this.drop();
    }

    drop() {
        this.plots.forEach((plot) => plot.drop());
        this.plots = [];
        this.shape = null;
    }

    onTime() {
        const { atUs } = this.session.time, [from, to] = this.span ?? [0, 0];
        this.redraw();
        if (this.isOpen && !this.fixed && atUs !== null && (atUs < from || atUs > to))
            this.refresh();
    }

    query([from, to]) {
        return { tags: this.tags.map(({ name }) => name).join(','), from: (from / 1e6).toFixed(3), to: (to / 1e6).toFixed(3) };
    }

    // Requests and draws the values of the present range. Only one request runs at a time, because on a slow link an answer would otherwise
    // always be outdated. If the range changes meanwhile, one more request follows, for the newest range.
    async refresh() {
        if (this.isAsking)
            this.isLate = true;
        if (this.tags.length === 0 || !this.session.model || this.isAsking)
            return;
        this.isAsking = true;
        this.isLate = false;
        const span = this.range, { tags } = this, points = Math.max(200, Math.round(byId('trend-chart').clientWidth / 2));
        try {
            const answer = askInTime('api/v1/history', { ...this.query(span), points }, this.session.token);
            const [uPlot, { series }] = await Promise.all([load(), answer]);
            if (this.isOpen && tags === this.tags)
                this.take(uPlot, span, series);
        } catch (error) {
            this.note(say('trends.failed', { why: error.message }));
        } finally {
            this.isAsking = false;
        }
        if (this.isLate && this.isOpen)
            this.refresh();
    }

    take(uPlot, span, series) {
        Object.assign(this, { span, series: new Map(series.map((one) => [one.tag, one])) });
        this.note(this.words());
        this.draw(uPlot);
        this.table.count(this.series, span);
        clearTimeout(this.alarmTimer);
        this.alarmTimer = setTimeout(() => this.askAlarms(), SETTLED_MS);
    }

    note(text) {
        setText(byId('trend-note'), text);
    }

    // Returns why a typed range was not understood, and what the charts do not show: periods without values, unknown names, and tags beyond
    // the largest number.
    words() {
        const [from, to] = this.span ?? this.range;
        const lacks = (one) => gaps(one, from, to).some(({ severity }) => severity === BAD);
        const lacking = [...this.series.values()].filter(lacks).map(({ tag }) => tag);
        const unread = this.unread === null ? [] : [say('trends.unread', { text: this.unread, example: say('trends.example.night') })];
        const unshown = [['gaps', lacking], ['unknown', this.unknown], ['undrawn', this.undrawn]].filter(([, names]) => names.length > 0)
            .map(([key, names]) => say(`trends.${key}`, { tags: names.join(', '), count: MOST }));
        return [...unread, ...unshown, ...this.unmarked].join(' · ');
    }

    // Requests the tags' alarms in the time range, and earlier alarms that are still active. Only one round of requests runs at a time: a
    // call during a round starts another round at its end. The answers are shown even if the range has changed meanwhile.
    async askAlarms() {
        this.isAlarmsLate = this.isAskingAlarms;
        if (this.isAskingAlarms)
            return;
        this.isAskingAlarms = true;
        const { tags, span } = this, all = await Promise.allSettled(tags.map((tag) => this.alarmsOf(tag, span)));
        this.isAskingAlarms = false;
        if (this.isOpen && tags === this.tags)
            this.takeAlarms(all);
        if (this.isOpen && this.isAlarmsLate)
            this.askAlarms();
    }

    // Marks the alarms in the charts. all: for each tag, the settled promise of alarmsOf(). The marks of a tag whose request failed stay
    // unchanged, and the note says so.
    takeAlarms(all) {
        const { tags } = this;
        this.alarms = new Map(tags.map(({ name }, i) => [name, all[i].value?.alarms ?? this.alarms.get(name)]));
        const failed = all.find(({ reason }) => reason), cut = tags.filter((_, i) => all[i].value?.isCut).map(({ name }) => name);
        const unmarked = [...failed ? [say('time.unread', { why: failed.reason.message })] : [],
            ...cut.length > 0 ? [say('trends.cut', { tags: cut.join(', ') })] : []];
        this.plots.forEach((plot) => plot.rows.forEach((row) => { row.alarms = this.alarms.get(row.tag.name); }));
        if (unmarked.join() !== this.unmarked.join()) { // other notes stay if nothing has changed
            this.unmarked = unmarked;
            this.note(this.words());
        }
        this.redraw();
    }

    // Returns a tag's annunciated alarms that are active now and were raised before an instant, in the form of alarmSpans().
    activeAlarms(name, us) {
        return [...this.session.model?.alarms?.rows.values() ?? []]
            .filter(({ tag, state, raisedUs }) => tag.name === name && calls(state) && !isGone(state) && raisedUs < us)
            .map(({ raisedUs, kind, priority, value, limit }) => ({ us: raisedUs, endUs: null, tag: name, kind, priority, value, limit }));
    }

    // Returns a promise of a tag's alarms in a time range: { alarms, isCut (true: the earliest ones are missing) }. Reads the journal back
    // to the start of the range. Earlier alarms are included if they are still active, or if a page that was read has their raise. Stops
    // reading pages if the tag is removed from the charts.
    async alarmsOf(tag, [from, to]) {
        const { name, unit } = tag, rows = [], query = { tag: name, to: (to / 1e6).toFixed(3), limit: ALARM_ROWS };
        const isCut = () => query.before !== null && !(rows.at(-1)?.time_us <= from);
        for (let i = 0; i < ALARM_PAGES && isCut() && this.tags.includes(tag); i++) {
            const page = await askInTime('api/v1/alarms/journal', query, this.session.token);
            rows.push(...page.rows);
            query.before = page.next_before;
        }
        const spans = alarmSpans(rows, unit).filter(({ endUs }) => endUs === null || endUs > from);
        const isNew = ({ kind }) => !spans.some((span) => span.kind === kind && span.endUs === null);
        const alarms = [...this.activeAlarms(name, to).filter(isNew), ...spans].sort((a, b) => a.us - b.us);
        return { alarms, isCut: isCut() };
    }

    // --- charts

    // The first chart, for tests.
    get chart() {
        return this.plots[0]?.chart ?? null;
    }

    // Units of each chart: [[unit, ...], ...].
    get units() {
        const all = [...new Set(this.tags.map((tag) => this.unitOf(tag) || '–'))];
        return Array.from({ length: Math.ceil(all.length / UNITS_PER_PLOT) }, (_, i) =>
            all.slice(i * UNITS_PER_PLOT, (i + 1) * UNITS_PER_PLOT));
    }

    // Returns true if the charts would be too low on this phone, so that the trend shows one at a time.
    isTight(count) {
        const { clientHeight: height } = byId('trend-chart');
        return phone.matches && !document.body.classList.contains('wall') && height > 0 && height < LEAST_CHART_PX * count && count > 1;
    }

    draw(uPlot) {
        const all = this.units, isSwitched = this.isTight(all.length), turn = Math.max(0, Math.min(this.turn, all.length - 1));
        const units = isSwitched ? [all[turn]] : all, shape = JSON.stringify([all, isSwitched && turn, this.theme, this.unit]);
        const element = byId('trend-chart'), width = Math.max(200, element.clientWidth);
        if (shape !== this.shape) {
            this.drop();
            setChartUnit(this.unit, document.body.classList.contains('pane-trend') ? WALL_TEXT : 0);
            const height = heightOf(units.length, this.tags.length), isWide = units[0]?.length > 1;
            this.plots = units.map((mine, i) => new Plot({ view: this, element, width, height, isWide, isLast: i === units.length - 1,
                units: mine }));
            Object.assign(this, { shape, turn, isSwitched, shownTheme: this.theme, shownUnit: this.unit });
            this.showSwitch(isSwitched ? all : []);
        }
        const answered = this.tags.filter(({ name }) => this.series.has(name));
        const rows = answered.map((tag) => ({ tag, series: this.series.get(tag.name), alarms: this.alarms.get(tag.name) }));
        this.resize();
        for (const plot of this.plots)
            plot.show(uPlot, rows.filter(({ tag }) => plot.units.includes(this.unitOf(tag) || '–')), this.span, this.range);
    }

    // Shows the chart with this tag if the trend shows one chart at a time.
    turnTo(tag) {
        const turn = this.units.findIndex((units) => units.includes(this.unitOf(tag) || '–'));
        if (turn < 0 || turn === this.turn)
            return;
        this.turn = turn;
        if (this.isSwitched)
            this.draw(globalThis.uPlot);
    }

    // Shows a switch with these charts, named by their units; hides it if there are none.
    showSwitch(charts) {
        const fieldset = byId('trend-charts'), names = charts.map((units, i) => [String(i), units.join(' · ')]);
        if (JSON.stringify(names) !== fieldset.dataset.choices) {
            fieldset.dataset.choices = JSON.stringify(names);
            fillSegments(fieldset, 'trend-charts', names, (turn) => {
                this.turn = Number(turn);
                this.draw(globalThis.uPlot);
            });
        }
        fieldset.hidden = charts.length === 0;
        markSegment(fieldset, String(this.turn));
    }

    redraw() {
        this.plots.forEach(({ chart }) => chart?.redraw(false));
    }

    rebuild() {
        this.draw(globalThis.uPlot);
        this.table.build();
    }

    resize() {
        if (this.plots.length > 0 && (this.unit !== this.shownUnit || this.isTight(this.units.length) !== this.isSwitched))
            return this.draw(globalThis.uPlot);
        const width = byId('trend-chart').clientWidth, height = heightOf(this.plots.length, this.tags.length);
        for (const { chart } of this.plots)
            if (chart && width > 0 && (width !== chart.width || height !== chart.height))
                chart.setSize({ width, height });
        return undefined;
    }

    onCrosshair(us, from) {
        this.crosshairUs = us;
        if (!this.isOpen)
            return;
        this.plots.forEach((plot) => plot !== from && plot.follow(us));
        this.table.point(us, this.series);
        const { date, time } = us === null ? {} : this.clock(us / 1000), near = (raised) => timeOrDay(this.clock, raised / 1000, us / 1000);
        const alarms = us === null ? [] : this.plots.flatMap((plot) => plot.alarmsNear(us));
        setText(byId('trend-at'), us === null ? '' : [`${date} ${time}`, ...alarms.map(({ us: raised, tag, kind }) =>
            say('trends.raised', { alarm: `${tag} ${say(`kind.${kind}`)}`, time: near(raised) }))].join(' · '));
    }

    async save() {
        const file = `${this.tags.map(({ name }) => name).join('_')}.csv`;
        try {
            const response = await ask('api/v1/history', { ...this.query(this.range), points: 20000, format: 'csv' }, this.session.token);
            const url = URL.createObjectURL(await response.blob());
            make('a', { href: url, download: file }).click();
            setTimeout(() => URL.revokeObjectURL(url), 10000);
        } catch (error) {
            this.note(say('trends.unsaved', { why: error.message }));
        }
    }
}
