// SPDX-License-Identifier: GPL-3.0-or-later
// The bar that counts alarms in every view; its list is loaded when it is opened.
import { decimalsFor, numberText, unitText, zoneClock } from '../../core/format.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';

export const badge = (priority, hollow = false) => make('span', {
    class: `priority p${priority}${hollow ? ' hollow' : ''}`, title: say(hollow ? 'alarms.gone' : 'alarms.priority', { priority }),
}, String(priority));

// Its value and its limit, in words; empty where it has none.
export function limitText(model, { tag, value, limit }) {
    if (value === null || limit === null)
        return '';
    const group = model.group(tag.group), decimals = group ? decimalsFor(group.max - group.min) : 2;
    const text = `${numberText(value, decimals)} ${unitText(tag.unit || group?.unit)}`;
    return say('alarms.value', { value: text, limit: numberText(limit, decimals) });
}

export class AlarmBar {
    constructor({ session, refresh }) {
        Object.assign(this, { session, refresh, fresh: true });
        for (const name of ['welcome', 'alarms', 'time'])
            session.on(name, () => this.show());
        setInterval(() => this.tick(), 500);
    }

    get alarms() {
        return this.session.model?.alarms ?? null;
    }

    // false: the server does not speak to us; what is said is as of when it last did.
    setFresh(fresh) {
        this.fresh = fresh;
        byId('alarm-strip').classList.toggle('stale', !fresh);
        document.body.classList.remove('alarm-blink');
        this.show();
    }

    // What nobody has acknowledged blinks, slowly.
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
        const counts = this.alarms.counts(), { active, waiting, of, gone } = counts, [newest] = this.alarms.list();
        byId('alarm-strip').dataset.kind = active === 0 ? (waiting > 0 ? 'gone' : 'none') : waiting > 0 ? 'waiting' : 'some';
        const badges = (list, hollow) =>
            list.flatMap((count, i) => (count > 0 ? [badge(i + 1, hollow), make('b', {}, `×\u2009${count}`)] : []));
        byId('alarm-counts').replaceChildren(...badges(of, false), ...badges(gone, true));
        setText(byId('alarm-words'), this.words(counts, Boolean(newest)));
        setText(byId('alarm-newest'), newest ? this.newestText(newest) : '');
        setText(byId('alarm-mode'), say(`mode.${this.alarms.mode}`));
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

    newestText(newest) {
        const alarm = `${newest.tag.name} ${say(`kind.${newest.kind}`)}`, value = limitText(this.session.model, newest);
        return value ? say('alarms.at', { alarm, value }) : alarm;
    }
}

// When the server last spoke, by the plant's clock.
export const asOf = (session) => zoneClock(session.model.plant.time_zone)(session.clockUs(session.freshAt) / 1000).time;
