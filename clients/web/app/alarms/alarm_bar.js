// SPDX-License-Identifier: GPL-3.0-or-later
// The alarm bar at the top of the page, always visible, with the numbers of alarms. The alarm list is loaded when the user
// first opens it.
import { timeOrDay, unitText, valueText, zoneClock } from '../../core/format.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';

export const badge = (priority, hollow = false) => make('span', {
    class: `priority p${priority}${hollow ? ' hollow' : ''}`, title: say(hollow ? 'alarms.gone' : 'alarms.priority', { priority }),
}, String(priority));

// Returns the time since which an alarm's tag has had no usable reading, so that the alarm keeps its state; null if the tag has
// a usable reading or never had one.
export function heldSince(session, { tag, kind }) {
    const { model, time } = session, bad = model.readings[tag.index]?.quality === 'bad';
    const ageMs = bad && kind !== 'BAD' ? model.ageMs(tag.index, session.now()) : null, nowUs = time.atUs ?? session.clockUs();
    if (ageMs === null || nowUs === null)
        return null;
    return timeOrDay(zoneClock(model.plant.time_zone), nowUs / 1000 - ageMs, nowUs / 1000, 5);
}

// Returns a text about an alarm: the value that raised it, its limit, and the present value, or since when there is no usable
// value. For an alarm without a value or a limit, the text has only that time, or is empty. fresh false (no messages arrive
// from the server): a dash replaces the present value. While the past is shown, the present value is left out.
export function limitText(session, alarm, fresh) {
    const { model, time } = session, { tag, value, limit } = alarm, isPast = time.atUs !== null;
    const since = fresh && !isPast ? heldSince(session, alarm) : null, held = since && say('alarms.since', { time: since });
    if (value === null || limit === null)
        return held ?? '';
    const group = model.group(tag.group);
    const textOf = (number) => `${valueText(group, number)} ${unitText(tag.unit || group?.unit)}`;
    const reading = model.readings[tag.index], known = reading.quality === 'bad' ? say('novalue') : textOf(reading.value);
    const now = isPast ? '' : `, ${held ?? say('alarms.present', { now: fresh ? known : '–' })}`;
    return say('alarms.value', { value: textOf(value), now, limit: textOf(limit) });
}

export class AlarmBar {
    constructor({ session, refresh }) {
        Object.assign(this, { session, refresh, fresh: true });
        for (const name of ['welcome', 'alarms', 'time'])
            session.on(name, () => this.show());
        session.on('tags', () => this.showNewest());
        setInterval(() => this.tick(), 500);
    }

    get alarms() {
        return this.session.model?.alarms ?? null;
    }

    // Sets whether messages arrive from the server. fresh false: none arrive, so the bar shows the alarms as of the last
    // message.
    setFresh(fresh) {
        this.fresh = fresh;
        document.body.classList.toggle('stale', !fresh);
        document.body.classList.remove('alarm-blink');
        this.show();
    }

    // Makes the alarm bar blink slowly while any alarm is unacknowledged.
    tick() {
        const waiting = this.fresh && Boolean(this.alarms?.counts().waiting) &&
            !window.matchMedia('(prefers-reduced-motion: reduce)').matches;
        document.body.classList.toggle('alarm-blink', waiting && !document.body.classList.contains('alarm-blink'));
        if (waiting)
            this.refresh();
    }

    show() {
        if (!this.alarms?.known)
            return;
        const counts = this.alarms.counts(), { active, waiting, of, gone } = counts;
        const kind = active === 0 ? (waiting > 0 ? 'gone' : 'none') : waiting > 0 ? 'waiting' : 'some';
        Object.assign(byId('alarm-strip').dataset, { kind, active });
        const badges = (list, hollow) =>
            list.flatMap((count, i) => (count > 0 ? [badge(i + 1, hollow), make('b', {}, `×\u2009${count}`)] : []));
        byId('alarm-counts').replaceChildren(...badges(of, false), ...badges(gone, true));
        setText(byId('alarm-words'), this.words(counts, this.alarms.byTag.size > 0));
        this.showNewest();
        setText(byId('alarm-mode'), say(`mode.${this.alarms.mode}`));
        document.title = `${active > 0 ? `(${active}) ` : ''}${this.session.model.plant.name} – Plantcast`;
    }

    words({ active, waiting, latched }, any) {
        const { session } = this;
        const some = !any ? say('alarms.none') : active === 0 ? say('alarms.zero') : say('alarms.some', { count: active });
        const alarms = [some, waiting > 0 ? say('alarms.waiting', { waiting }) : '', latched > 0 ? say('alarms.latched', { latched }) : '']
            .filter(Boolean).join(', ');
        if (!this.fresh)
            return say('alarms.asof', { time: asOf(session), alarms });
        return session.time.atUs === null ? alarms : say('alarms.now', { alarms });
    }

    showNewest() {
        const [newest] = this.alarms?.known ? this.alarms.list() : [];
        setText(byId('alarm-newest'), newest ? this.newestText(newest) : '');
    }

    newestText(newest) {
        return [`${newest.tag.name} ${say(`kind.${newest.kind}`)}`, limitText(this.session, newest, this.fresh)].filter(Boolean).join(', ');
    }
}

// Returns an instant as text in the plant's time zone, with its day if that is not today.
export const timeOf = (session, us) => timeOrDay(zoneClock(session.model.plant.time_zone), us / 1000, session.clockUs() / 1000);

// Returns today's date in the plant's time zone.
export const todayOf = (session) => zoneClock(session.model.plant.time_zone)(session.clockUs() / 1000).date;

// Returns the time of the server's last message.
export const asOf = (session) => timeOf(session, session.clockUs(session.freshAt));
