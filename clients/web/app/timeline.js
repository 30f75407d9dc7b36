// SPDX-License-Identifier: GPL-3.0-or-later
// The time bar: a slider over what was recorded, with the alarms that were raised, play, speed, and the way back to now.
import { ageText, zoneClock } from '../core/format.js';
import { ask, raised, ticks } from '../core/history.js';
import { travel } from '../core/requests.js';
import { say } from '../core/words.js';
import { byId, makeSvg, setText } from './dom.js';
import { fillSelect } from './fields.js';

const SPANS = [[900, 'min', 15], [3600, 'h', 1], [28800, 'h', 8], [86400, 'h', 24], [604800, 'd', 7], [2592000, 'd', 30]];
const SPEEDS = [1, 10, 60, 300, 600, 3600];
const STEPS = 2000, MARKS_MS = 15000, MARKS_MOST = 2000, HAND_MS = 400, NOW_US = 3.5e6; // what is newer than that counts as now

export class Timeline {
    constructor({ session }) {
        Object.assign(this, { session, open: false, toUs: null, marks: [], wanted: null, draggedAt: -Infinity });
        this.slider = byId('time-slider');
        fillSelect(byId('time-span'), SPANS.map(([seconds, unit, n]) => [seconds, say(`age.${unit}`, { n })]), 3600);
        fillSelect(byId('time-speed'), SPEEDS.map((speed) => [speed, `${speed}×`]), 60);
        byId('time-span').addEventListener('change', () => this.turnTo(this.atUs));
        byId('time-speed').addEventListener('change', () => session.time.speed && travel(session, undefined, this.speed));
        byId('time-play').addEventListener('click', () => this.play());
        byId('time-live').addEventListener('click', () => travel(session, null));
        this.slider.addEventListener('input', () => this.drag());
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
        else if (this.atUs !== null)
            travel(this.session, null);
    }

    hear() {
        if (this.atUs !== null && !this.open)
            this.setOpen(true);
        if (this.atUs !== null && this.toUs !== null && (this.atUs > this.toUs || this.atUs < this.toUs - this.spanUs))
            this.turnTo(this.atUs);
        this.show();
    }

    // The slider spans the time up to now; around an instant where that does not hold it.
    turnTo(atUs) {
        const now = this.session.clockUs() ?? Date.now() * 1000;
        const ends = atUs !== null && atUs < now - this.spanUs ? Math.min(now, atUs + this.spanUs / 2) : now;
        this.toUs = ends;
        this.askMarks();
        this.show();
    }

    tick() {
        if (!this.open || !this.session.model)
            return;
        if (this.atUs === null)
            this.toUs = this.session.clockUs() ?? this.toUs;
        if (performance.now() - (this.askedAt ?? 0) > MARKS_MS)
            this.askMarks();
        this.show();
    }

    // Once for each picture of the page, however often the hand moves.
    drag() {
        const at = this.toUs - this.spanUs * (1 - Number(this.slider.value) / STEPS);
        const now = this.session.clockUs();
        if (this.wanted === null)
            requestAnimationFrame(() => {
                travel(this.session, this.wanted > now - NOW_US ? null : this.wanted);
                this.wanted = null;
            });
        this.wanted = at;
        this.draggedAt = performance.now();
        this.say(at);
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

    async askMarks() {
        this.askedAt = performance.now();
        const query = { from: (this.toUs - this.spanUs) / 1e6, to: this.toUs / 1e6, limit: MARKS_MOST };
        try {
            const response = await ask('api/v1/alarms/journal', query, this.session.token);
            this.marks = raised((await response.json()).rows);
        } catch {
            this.marks = []; // no journal, or not for us: the slider goes without
        }
        this.draw();
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
        const place = atUs === null ? 1 : 1 - (this.toUs - atUs) / this.spanUs;
        if (performance.now() - this.draggedAt > HAND_MS)
            this.slider.value = Math.round(place * STEPS);
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

    // Marks, ticks, and where nothing was recorded, over the slider's own length.
    draw() {
        const track = byId('time-track'), width = track.clientWidth;
        if (!this.open || !this.clock || width === 0)
            return;
        const from = this.toUs - this.spanUs, x = (us) => 9 + (width - 18) * (us - from) / this.spanUs;
        const nodes = [], { fromUs } = this.session.time;
        if (fromUs !== null && fromUs > from) {
            const length = Math.max(0, Math.min(x(fromUs), width - 9) - 9);
            nodes.push(makeSvg('rect', { class: 'unrecorded', x: 9, y: 16, width: length, height: 8 }));
            if (x(fromUs) > 120)
                nodes.push(makeSvg('text', { class: 'note', x: 12, y: 12 }, say('time.unrecorded')));
        }
        for (const us of ticks(from, this.toUs, Math.max(2, width / 110))) {
            const { day, time } = this.clock(us / 1000), text = this.spanUs > 2 * 86400e6 ? day : time.slice(0, 5);
            nodes.push(makeSvg('path', { class: 'tick', d: `M${x(us)} 26v5` }));
            if (x(us) > 30 && x(us) < width - 30)
                nodes.push(makeSvg('text', { x: x(us), y: 42, 'text-anchor': 'middle' }, text));
        }
        for (const { us, tag, kind, priority } of [...this.marks].sort((a, b) => b.priority - a.priority)) // the gravest on top
            nodes.push(makeSvg('path', { class: `alarm p${priority}`, d: `M${x(us)} 15l-5.5-11h11z` },
                makeSvg('title', {}, `${tag} ${kind}, ${this.clock(us / 1000).time}`)));
        track.replaceChildren(...nodes);
        setText(byId('time-alarms'), this.marks.length > 0 ? say('time.raised', { count: this.marks.length }) : '');
    }
}

