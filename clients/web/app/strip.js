// SPDX-License-Identifier: GPL-3.0-or-later
// The strip that counts alarms in every view; its list is loaded when it is opened.
import { decimalsFor, numberText, unitText } from '../core/format.js';
import { say } from '../core/words.js';
import { byId, make, setText } from './dom.js';

export const badge = (priority) =>
    make('span', { class: `priority p${priority}`, title: say('alarms.priority', { priority }) }, String(priority));

// Its value and its limit, in words; empty where it has none.
export function limitText(model, { tag, value, limit }) {
    if (value === null || limit === null)
        return '';
    const group = model.group(tag.group), decimals = group ? decimalsFor(group.max - group.min) : 2;
    const text = `${numberText(value, decimals)} ${unitText(tag.unit || group?.unit)}`;
    return say('alarms.value', { value: text, limit: numberText(limit, decimals) });
}

export class AlarmStrip {
    constructor({ session, refresh }) {
        Object.assign(this, { session, refresh });
        for (const name of ['welcome', 'alarms', 'time'])
            session.on(name, () => this.show());
        setInterval(() => this.tick(), 500);
    }

    get alarms() {
        return this.session.model?.alarms ?? null;
    }

    // What nobody has acknowledged blinks, slowly.
    tick() {
        const waiting = Boolean(this.alarms?.counts().waiting) && !window.matchMedia('(prefers-reduced-motion: reduce)').matches;
        document.body.classList.toggle('alarm-blink', waiting && !document.body.classList.contains('alarm-blink'));
        if (waiting)
            this.refresh();
    }

    show() {
        if (!this.alarms?.known)
            return;
        const { all, waiting, of } = this.alarms.counts(), [newest] = this.alarms.list();
        byId('alarm-strip').dataset.kind = waiting > 0 ? 'waiting' : all > 0 ? 'some' : 'none';
        const counts = of.flatMap((count, i) => (count > 0 ? [badge(i + 1), make('b', {}, `×\u2009${count}`)] : []));
        byId('alarm-counts').replaceChildren(...counts);
        const some = all === 0 ? say('alarms.none') : say('alarms.some', { count: all });
        const alarms = waiting > 0 ? say('alarms.waiting', { alarms: some, waiting }) : some;
        setText(byId('alarm-words'), this.session.time.atUs === null ? alarms : say('alarms.now', { alarms }));
        setText(byId('alarm-newest'), newest ? this.newestText(newest) : '');
        setText(byId('alarm-mode'), say(`mode.${this.alarms.mode}`));
    }

    newestText(newest) {
        const alarm = `${newest.tag.name} ${say(`kind.${newest.kind}`)}`, value = limitText(this.session.model, newest);
        return value ? say('alarms.at', { alarm, value }) : alarm;
    }
}
