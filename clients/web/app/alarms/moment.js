// SPDX-License-Identifier: GPL-3.0-or-later
// The moment before an alarm: flies to the alarm's tag, shows the plant 30 s before the raise, and names the alarm in large letters over
// the picture.
import { zoneClock } from '../../core/format.js';
import { travel } from '../../core/requests.js';
import { say } from '../../core/words.js';
import { make, setText } from '../common/dom.js';
import { badge } from './alarm_bar.js';

const BEFORE_US = 30e6, NARROW = window.matchMedia('(max-width: 899px), (max-height: 480px)');

export class Moment {
    constructor({ session, viewport, showTag, flyToTag }) {
        Object.assign(this, { session, showTag, flyToTag, alarm: null });
        const button = (name, f, words = `moment.${name}`) => make('button', { type: 'button', class: name, onclick: f }, say(words));
        this.name = make('strong');
        this.mark = make('span', { class: 'mark-of' });
        this.when = make('span', { class: 'when' });
        this.element = make('div', { class: 'moment', id: 'moment', role: 'status', hidden: true },
            make('p', {}, this.mark, this.name), this.when, make('div', { class: 'line' }, button('before', () => this.go(-BEFORE_US)),
                button('at', () => this.go(0)), button('play', () => travel(session, undefined, 1), 'time.play'),
                button('live', () => travel(session, null), 'time.live')));
        viewport.element.append(this.element);
        session.on('time', () => this.hear());
        session.on('welcome', () => this.close());
        setInterval(() => this.say(), 500);
    }

    // alarm: { tag, kind, priority, us (time of the raise, microseconds) }. afterUs: offset of the shown instant from the
    // raise; negative: before.
    show(alarm, afterUs = -BEFORE_US) {
        Object.assign(this, { alarm, arrived: false });
        this.mark.replaceChildren(badge(alarm.priority));
        setText(this.name, `${alarm.tag.name} ${say(`kind.${alarm.kind}`)}`);
        this.go(afterUs);
        this.element.hidden = false;
        this.say();
        if (alarm.tag.index !== null)
            this.flyTo(alarm.tag);
    }

    // Selects the tag, which opens its card, and flies to it. On narrow screens no card is opened, because it would cover the picture.
    flyTo(tag) {
        if (!NARROW.matches)
            this.showTag(tag);
        else if (tag.group && tag.group !== this.session.params.group)
            this.session.setParams({ group: tag.group });
        this.flyToTag(tag);
    }

    go(afterUs) {
        travel(this.session, this.alarm.us + afterUs);
    }

    // Hides the alarm's name when the page returns from the moment before the alarm to the present.
    hear() {
        const { atUs } = this.session.time;
        if (this.alarm && atUs === null && this.arrived)
            this.close();
        this.arrived ||= atUs !== null;
        this.say();
    }

    say() {
        const { atUs } = this.session.time;
        if (!this.alarm)
            return;
        const { date, time } = zoneClock(this.session.model.plant.time_zone)(this.alarm.us / 1000);
        const s = Math.round(((atUs ?? 0) - this.alarm.us) / 1e6);
        const away = atUs === null ? '' : s < 0 ? say('moment.early', { s: -s }) : s > 0 ? say('moment.late', { s }) : say('moment.now');
        setText(this.when, [say('moment.raised', { time: `${date} ${time}` }), away].filter(Boolean).join(' · '));
    }

    close() {
        this.alarm = null;
        this.element.hidden = true;
    }
}
