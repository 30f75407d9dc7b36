// SPDX-License-Identifier: GPL-3.0-or-later
// The time bar: a slider over the recorded history that marks gaps, lost sources and alarms (clickable), with playback, its
// speed, a date field and a button that returns to the present.
import { ageText, timeOrDay, zoneClock } from '../../core/format.js';
import { arrowS, clustered, density, lost, nextTo, raised, witnesses } from '../../core/history.js';
import { askInTime } from '../../core/http.js';
import { fieldInstant, fieldText, ticks } from '../../core/instant.js';
import { travel } from '../../core/requests.js';
import { say } from '../../core/words.js';
import { onCrosshair, pointAtInstant } from '../common/crosshair.js';
import { byId, makeSvg, setText } from '../common/dom.js';
import { fillSelect } from '../common/choices.js';

const DAY_S = 86400;
const SPANS = [[900, 'min', 15], [3600, 'h', 1], [28800, 'h', 8], [DAY_S, 'h', 24], [604800, 'd', 7], [2592000, 'd', 30]];
const SPEEDS = [1, 10, 60, 300, 600, 3600];
// MARKS_MS: milliseconds after which the marks are requested again; MARKS_MOST: alarm journal rows per request, MARK_PAGES:
// maximum number of such requests; HAND_MS: time after a drag in which the slider is not moved by the page; NOW_US: an instant
// less than this many microseconds ago counts as now
const MARKS_MS = 15000, MARKS_MOST = 10000, MARK_PAGES = 5, HAND_MS = 400, NOW_US = 3.5e6;
// LOST_POINTS: number of history points per tag that are requested to find periods in which a source delivered nothing. BARS:
// lower edge and height of the bars that show how many alarms were raised; the highest bar has the full height only if it
// represents `full` alarms or more.
const TRACK = { top: 15, height: 10 }, BARS = { bottom: 58, height: 14, full: 10 }, BAR_PX = 5, LOST_POINTS = 300;
const THUMB_PX = 9; // half the width of the slider's thumb: the slider's values end this far inside its track
// MARK_PX: minimum distance between two alarm marks; SEARCH_MOST: journal rows per request; PAGES: maximum number of requests
// when searching for the next alarm
const MARK_PX = 9, SEARCH_MOST = 10000, PAGES = 24, NAMED = 8;

export class Timeline {
    // tell(text): shows a message to the user.
    constructor({ session, modules, tell }) {
        Object.assign(this, { session, modules, tell, open: false, toUs: null, marks: [], gaps: [], lost: [], wanted: null,
            draggedAt: -Infinity, askedAt: 0, marksAt: 0, failed: '' });
        this.slider = byId('time-slider');
        fillSelect(byId('time-span'), SPANS.map(([seconds, unit, n]) => [seconds, say(`age.${unit}`, { n })]), 3600);
        fillSelect(byId('time-speed'), SPEEDS.map((speed) => [speed, `${speed}×`]), 60);
        byId('time-span').addEventListener('change', () => this.turnTo(this.atUs));
        byId('time-speed').addEventListener('change', () => session.time.speed && travel(session, undefined, this.speed));
        byId('time-play').addEventListener('click', () => this.play());
        byId('time-live').addEventListener('click', () => travel(session, null));
        byId('time-compare').addEventListener('click', () => modules.use('compare', (compare) => compare.toggle(), 'toggle'));
        this.slider.addEventListener('input', () => this.drag());
        this.slider.addEventListener('keydown', (event) => this.press(event));
        byId('time-before').addEventListener('click', () => this.goToAlarm(true));
        byId('time-after').addEventListener('click', () => this.goToAlarm(false));
        byId('time-date').addEventListener('change', () => this.goToDate());
        this.slider.addEventListener('pointermove', ({ offsetX }) => pointAtInstant(this.instantAt(offsetX), this));
        this.slider.addEventListener('pointerleave', () => pointAtInstant(null, this));
        onCrosshair((us) => this.cross(us));
        session.greeted(() => { this.clock = zoneClock(session.model.plant.time_zone); });
        session.on('time', () => this.hear());
        this.hear();
        setInterval(() => this.tick(), 500);
        new ResizeObserver(() => this.draw()).observe(byId('time-track'));
    }

    get spanUs() {
        return Number(byId('time-span').value) * 1e6;
    }

    get speed() {
        return Number(byId('time-speed').value);
    }

    get atUs() {
        return this.session.time.atUs;
    }

    toggle() {
        this.setOpen(!this.open);
    }

    setOpen(open) {
        this.open = open;
        byId('timeline').hidden = !open;
        byId('time-toggle').setAttribute('aria-expanded', open);
        if (open)
            this.turnTo(this.atUs);
        else
            // removes the alarm marks, which would accumulate while the bar is closed; they are redrawn when it opens
            byId('time-track').replaceChildren();
        if (!open && this.atUs !== null)
            travel(this.session, null);
    }

    hear() {
        if (this.atUs !== null && !this.open)
            this.setOpen(true);
        if (this.atUs !== null && this.toUs !== null && (this.atUs > this.toUs || this.atUs < this.toUs - this.spanUs))
            this.turnTo(this.atUs);
        this.showDate();
        this.show();
    }

    // Sets the slider's time span: up to now, or around atUs if atUs is earlier than that span.
    turnTo(atUs) {
        const now = this.session.clockUs() ?? Date.now() * 1000;
        const ends = atUs !== null && atUs < now - this.spanUs ? Math.min(now, atUs + this.spanUs / 2) : now;
        this.toUs = ends;
        this.slider.max = this.spanUs / 1e6; // in seconds
        this.askMarks();
        this.show();
    }

    tick() {
        if (!this.open || !this.session.model)
            return;
        if (this.atUs === null)
            this.toUs = this.session.clockUs() ?? this.toUs;
        if (performance.now() - this.askedAt > MARKS_MS)
            this.askMarks();
        this.show();
    }

    // Shows the plant at the slider's instant, at most once per animation frame: pointer events are more frequent.
    drag() {
        const at = this.toUs - this.spanUs + Number(this.slider.value) * 1e6;
        if (this.wanted === null)
            requestAnimationFrame(() => {
                this.go(this.wanted);
                this.draw();
                this.wanted = null;
            });
        this.wanted = at;
        this.draggedAt = performance.now();
        this.say(at);
    }

    go(us) {
        travel(this.session, us > this.session.clockUs() - NOW_US ? null : us);
    }

    // Handles keys on the slider: arrows move by a small step, Page keys by a fraction of the span.
    press(event) {
        const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
        const pages = { PageDown: -1, PageUp: 1 }[event.key];
        if (!steps && !pages)
            return;
        event.preventDefault();
        const us = steps ? steps * arrowS(this.spanUs / 1e6) * 1e6 : pages * this.spanUs / PAGES;
        this.go((this.wanted ?? this.atUs ?? this.session.clockUs()) + us);
    }

    // --- moves the shown instant to a date, or to the next or previous alarm

    showDate() {
        const field = byId('time-date');
        if (document.activeElement !== field && this.clock)
            field.value = this.atUs === null ? '' : fieldText(this.atUs, this.session.model.plant.time_zone);
    }

    goToDate() {
        const us = fieldInstant(byId('time-date').value, this.session.model.plant.time_zone);
        if (us !== null)
            this.go(us);
    }

    async goToAlarm(backwards) {
        const here = this.atUs ?? this.session.clockUs();
        try {
            const found = await this.alarmFrom(here, backwards);
            if (found)
                this.showAlarm(found);
            else
                this.tell(say(backwards ? 'time.first' : 'time.last'));
        } catch (error) {
            this.tell(say('time.unread', { why: error.message }));
        }
    }

    // Shows the plant at the instant when an alarm was raised, flies to its tag, and names the alarm over the picture.
    showAlarm({ us, tag: name, kind, priority }) {
        const tag = this.session.model.tag(name) ?? { name, index: null };
        this.modules.use('moment', (moment) => moment.show({ us, tag, kind, priority }, 0), 'moment');
    }

    // Returns the next alarm raised after an instant, or with `backwards` the previous one; null: none. The alarm journal
    // returns its newest rows first.
    async alarmFrom(us, backwards) {
        let before = null;
        for (let i = 0; backwards && i < PAGES; i++) {
            const { rows, next_before: next } = await this.journal({ to: us / 1e6, limit: SEARCH_MOST, ...(before ? { before } : {}) });
            const found = nextTo(raised(rows), us, true);
            if (found || next === null)
                return found;
            before = next;
        }
        const now = this.session.clockUs();
        for (let from = us, length = this.spanUs / 8, i = 0; !backwards && from < now && i < 10 * PAGES; i++) {
            const span = { from: from / 1e6, to: (from + length) / 1e6 };
            const { rows, next_before: next } = await this.journal({ ...span, limit: SEARCH_MOST });
            const found = next === null || length < 2e6 ? nextTo(raised(rows), us, false) : null;
            if (found)
                return found;
            // If all journal rows of the span were read (next is null) without finding an alarm, searches the next, longer
            // span. If the span has too many rows for one request, searches a shorter span.
            [from, length] = next === null ? [from + length, length * 4] : [from, length / 8];
        }
        return null;
    }

    journal(query) {
        return askInTime('api/v1/alarms/journal', query, this.session.token);
    }

    play() {
        const { time } = this.session;
        if (time.speed)
            travel(this.session, undefined, 0);
        else if (time.atUs !== null)
            travel(this.session, undefined, this.speed);
        else
            travel(this.session, this.toUs - this.spanUs, this.speed);
    }

    // Requests the marks of the time span. Marks whose request fails stay unchanged, and the bar says so.
    async askMarks() {
        const at = this.askedAt = performance.now();
        const span = { from: (this.toUs - this.spanUs) / 1e6, to: this.toUs / 1e6 }, { token } = this.session;
        const gaps = askInTime('api/v1/history/gaps', span, token).then((said) => said.gaps);
        const all = await Promise.allSettled([this.askRaised(span), gaps, this.askLost(span)]);
        if (at < this.marksAt)
            return; // a newer request, perhaps for another time span, has been answered earlier
        this.marksAt = at;
        ['marks', 'gaps', 'lost'].forEach((name, i) => { this[name] = all[i].value ?? this[name]; });
        this.failed = all.find(({ reason }) => reason)?.reason.message ?? '';
        this.draw();
    }

    // Requests the alarms raised in a time span and returns a promise. If there are too many, the list is complete only from
    // the instant `marks.sinceUs` on.
    async askRaised(span) {
        const all = [];
        let before = null, page = null;
        for (let i = 0; i < MARK_PAGES && (i === 0 || before !== null); i++) {
            page = await this.journal({ ...span, limit: MARKS_MOST, ...(before === null ? {} : { before }) });
            all.push(...page.rows);
            before = page.next_before;
        }
        return Object.assign(raised(all), { sinceUs: before === null ? null : all.at(-1)?.time_us ?? null });
    }

    // Draws bars with the number of raised alarms over time. Their heights are on a logarithmic scale, so that one alarm is still visible.
    densityBars(from, width) {
        const inner = width - 2 * THUMB_PX, count = Math.max(1, Math.floor(inner / BAR_PX));
        const { bins, most } = density(this.marks, from, this.toUs, count), step = inner / count;
        return bins.flatMap(({ count: n, priority }, i) => {
            const height = n > 0 ? Math.max(2, (BARS.height * Math.log1p(n)) / Math.log1p(Math.max(most, BARS.full))) : 0;
            return n === 0 ? [] : [makeSvg('rect', { class: `bar p${priority}`, x: THUMB_PX + i * step, width: Math.max(1, step - 1),
                y: BARS.bottom - height, height }, makeSvg('title', {}, say('time.raised', { count: n })))];
        });
    }

    // Returns a promise of [{ source, spans }]: the periods in which each source delivered nothing.
    async askLost(span) {
        const sources = witnesses(this.session.model?.tags ?? []), tags = sources.flatMap((one) => one.tags);
        if (tags.length === 0)
            return [];
        const query = { ...span, tags: tags.join(','), points: LOST_POINTS };
        const { series } = await askInTime('api/v1/history', query, this.session.token);
        return sources.map((one) => ({ source: one.source, spans: lost(series.filter(({ tag }) => one.tags.includes(tag)),
            span.from * 1e6, span.to * 1e6) }));
    }

    say(us) {
        const { date, time, offset } = this.clock(us / 1000);
        const ago = ageText((this.session.clockUs() - us) / 1000);
        this.slider.setAttribute('aria-valuetext', `${date} ${time} ${offset}`);
        setText(byId('time-at'), say('time.ago', { instant: `${date} ${time} ${offset}`, age: ago }));
    }

    show() {
        if (!this.open || !this.clock)
            return;
        const { atUs, speed } = this.session.time;
        if (performance.now() - this.draggedAt > HAND_MS)
            this.slider.value = Math.round((this.spanUs - (atUs === null ? 0 : this.toUs - atUs)) / 1e6);
        if (atUs === null) {
            setText(byId('time-at'), say('time.now'));
            this.slider.setAttribute('aria-valuetext', say('time.now'));
        } else if (this.wanted === null) {
            this.say(atUs);
        }
        byId('timeline').classList.toggle('past', atUs !== null);
        byId('time-live').disabled = atUs === null;
        const verb = say(speed ? 'time.pause' : 'time.play');
        byId('time-play').setAttribute('aria-label', verb);
        byId('time-play').title = verb;
        byId('time-play').querySelector('use').setAttribute('href', speed ? '#i-pause' : '#i-play');
        this.draw();
    }

    instantAt(left) {
        const width = byId('time-track').clientWidth;
        return this.toUs - this.spanUs + ((left - THUMB_PX) * this.spanUs) / (width - 2 * THUMB_PX);
    }

    // Draws a line on the slider at the instant `us`, where the pointer is on the slider or in a trend; null: no line.
    cross(us) {
        const track = byId('time-track'), width = track.clientWidth, from = this.toUs - this.spanUs;
        track.querySelector('.cross')?.remove();
        if (!this.open || us === null || us < from || us > this.toUs)
            return;
        const x = THUMB_PX + ((width - 2 * THUMB_PX) * (us - from)) / this.spanUs, { time } = this.clock(us / 1000);
        const side = x > width / 2 ? { x: x - 4, 'text-anchor': 'end' } : { x: x + 4 };
        track.append(makeSvg('g', { class: 'cross' }, makeSvg('path', { d: `M${x} 0v34` }), makeSvg('text', { y: 10, ...side }, time)));
    }

    // Draws alarm marks, ticks, gaps and periods of lost sources (one row for each source) along the slider.
    draw() {
        const track = byId('time-track'), width = track.clientWidth;
        if (!this.open || !this.clock || width === 0)
            return;
        const from = this.toUs - this.spanUs, x = (us) => THUMB_PX + (width - 2 * THUMB_PX) * (us - from) / this.spanUs;
        const nodes = this.densityBars(from, width), { fromUs } = this.session.time, begin = Math.max(from, fromUs ?? from);
        const strip = (begins, ends, place, ...more) => {
            const left = x(Math.max(begins, from)), long = Math.max(2, Math.min(x(ends), width - THUMB_PX) - left);
            nodes.push(makeSvg('rect', { fill: 'url(#time-gap)', x: left, width: long, ...place }, ...more));
            return [left, long];
        };
        const row = TRACK.height / Math.max(1, this.lost.length);
        this.lost.forEach(({ source, spans }, i) => {
            for (const [begins, ends] of spans.filter((one) => one[1] > from))
                strip(begins, ends, { class: 'lost', y: TRACK.top + i * row, height: row },
                    makeSvg('title', {}, say('time.lost', { source })));
        });
        const hatch = (begins, ends) => {
            const [left, long] = strip(begins, ends, { class: 'unrecorded', y: TRACK.top, height: TRACK.height });
            if (long > 70)
                nodes.push(makeSvg('text', { class: 'note', x: left + 3, y: 12 }, say('time.unrecorded')));
        };
        if (begin > from)
            hatch(from, begin);
        if (this.marks.sinceUs > from)
            strip(from, this.marks.sinceUs, { class: 'uncounted', y: BARS.bottom - BARS.height, height: BARS.height },
                makeSvg('title', {}, say('time.uncounted')));
        for (const [begins, ends] of this.gaps)
            hatch(begins, ends);
        const thumb = x(from + Number(this.slider.value) * 1e6); // redraws the slider's thumb, which the hatching has covered
        if (nodes.some((node) => node.classList.contains('lost') || node.classList.contains('unrecorded')))
            nodes.push(makeSvg('circle', { class: 'thumb', cx: thumb, cy: 20, r: 8 }));
        const isOfDays = this.spanUs > 2 * DAY_S * 1e6, { time_zone: zone } = this.session.model.plant;
        for (const us of ticks(from, this.toUs, Math.max(2, width / 110), zone, isOfDays ? DAY_S : 1)) {
            const { day, time } = this.clock(us / 1000), text = isOfDays ? day : time.slice(0, 5);
            nodes.push(makeSvg('path', { class: 'tick', d: `M${x(us)} 26v5` }));
            if (x(us) > 30 && x(us) < width - 30)
                nodes.push(makeSvg('text', { x: x(us), y: 42, 'text-anchor': 'middle' }, text));
        }
        const groups = clustered(this.marks, MARK_PX * this.spanUs / (width - 2 * THUMB_PX)), words = ({ us, tag, kind }) =>
            `${tag} ${kind}, ${timeOrDay(this.clock, us / 1000, this.toUs / 1000)}`;
        for (const { us, priority, of } of groups.sort((a, b) => b.priority - a.priority)) { // most urgent alarms on top
            const all = of.slice(0, NAMED).map(words).concat(of.length > NAMED ? [say('alarms.more', { count: of.length - NAMED })] : []);
            const look = { class: `alarm p${priority}`, d: `M${x(us)} 15l-5.5-11h11z` };
            const gravest = of.find((mark) => mark.priority === priority);
            nodes.push(makeSvg('path', { ...look, onclick: () => this.showAlarm(gravest) }, makeSvg('title', {}, all.join('\n'))));
        }
        track.replaceChildren(...nodes, ...track.querySelectorAll('.cross'));
        const here = this.marks.filter(({ us }) => us === this.atUs).map(({ tag, kind }) => `${tag} ${kind}`).join(', ');
        setText(byId('time-alarms'), this.failed ? say('time.unmarked', { why: this.failed })
            : here || (this.marks.length > 0 ? say('time.raised', { count: this.marks.length }) : ''));
    }
}

