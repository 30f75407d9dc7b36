// SPDX-License-Identifier: GPL-3.0-or-later
// The list of alarms, and what can be done about one.
import { actionsFor, asideOf } from '../core/acting.js';
import { isWaiting } from '../core/alarms.js';
import { ageText, zoneClock } from '../core/format.js';
import { refusalText } from '../core/refusals.js';
import { actOnAlarm } from '../core/requests.js';
import { say } from '../core/words.js';
import { byId, make, setText } from './dom.js';
import { badge, limitText } from './strip.js';

const SHOWN = 200; // rows at once

export class AlarmList {
    // showTag(tag), flyToTag(tag): as the page has them.
    constructor({ session, parts, showTag, flyToTag }) {
        Object.assign(this, { session, parts, showTag, flyToTag });
        this.small = window.matchMedia('(max-width: 719px), (max-height: 480px)');
        byId('alarms-close').addEventListener('click', () => this.setOpen(false));
        byId('shelve-form').addEventListener('submit', (event) => this.shelve(event));
        byId('shelve-cancel').addEventListener('click', () => byId('shelve').close());
        session.on('welcome', () => {
            ['alarms-list', 'alarms-aside'].forEach((id) => byId(id).replaceChildren()); // they were of another plant
            this.show();
        });
        session.on('alarms', () => this.show());
        session.on('time', () => this.show());
        session.on('alarmed', (answer) => this.answered(answer));
        setInterval(() => this.tick(), 500);
    }

    get alarms() {
        return this.session.model?.alarms ?? null;
    }

    get open() {
        return !byId('alarms').hidden;
    }

    toggle() {
        this.setOpen(!this.open);
    }

    setOpen(open) {
        if (open)
            this.parts.there('engineer')?.close(); // it stands in the same place
        byId('alarms').hidden = !open;
        byId('alarm-strip').setAttribute('aria-expanded', open);
        this.show();
        if (open)
            byId('alarms-close').focus();
        else
            byId('alarm-strip').focus();
    }

    // Ages go on.
    tick() {
        if (this.open)
            for (const [element, alarm] of this.ages ?? [])
                setText(element, this.since(alarm));
    }

    show() {
        if (!this.alarms?.known || !this.open)
            return;
        byId('alarms-then').hidden = this.session.time.atUs === null;
        this.keepFocus(() => this.showList());
    }

    showList() {
        const list = this.alarms.list(), aside = asideOf(this.alarms);
        this.ages = [];
        this.fill('alarms-list', list);
        byId('alarms-none').hidden = list.length > 0;
        byId('alarms-aside-head').hidden = aside.length === 0;
        setText(byId('alarms-aside-head'), say('alarms.aside', { count: aside.length }));
        this.fill('alarms-aside', aside);
        const more = Math.max(0, list.length - SHOWN) + Math.max(0, aside.length - SHOWN);
        setText(byId('alarms-more'), more > 0 ? say('alarms.more', { count: more }) : '');
    }

    // Rows that say what they said stay where they are, under the hand that presses in them.
    fill(id, alarms) {
        const list = byId(id), before = new Map([...list.children].map((row) => [row.said, row]));
        const rows = alarms.slice(0, SHOWN).map((alarm) => {
            const { tag, ...said } = alarm, is = JSON.stringify([said, actionsFor(alarm, this.alarms.mode, this.session.role)]);
            const row = before.get(is) ?? Object.assign(this.row(alarm), { said: is });
            before.delete(is);
            this.ages.push([row.querySelector('.since'), alarm]);
            return row;
        });
        for (const row of before.values())
            row.remove();
        rows.forEach((row, i) => list.children[i] !== row && list.insertBefore(row, list.children[i] ?? null));
    }

    // Where what had the focus has gone, its alarm has it, else the next one.
    keepFocus(f) {
        const held = document.activeElement, row = held.closest('#alarms li'), place = row && [...row.parentElement.children].indexOf(row);
        f();
        if (!row || document.activeElement === held)
            return;
        const next = document.querySelector(`#alarms li[data-alarm="${CSS.escape(row.dataset.alarm)}"]`) ??
            [...document.querySelectorAll('#alarms li')][place];
        (held.isConnected ? held : next?.querySelector('.do button, button') ?? byId('alarms-close')).focus();
    }

    since({ raisedUs }) {
        const now = this.session.clockUs();
        if (raisedUs === null || now === null)
            return '';
        const { time } = zoneClock(this.session.model.plant.time_zone)(raisedUs / 1000);
        return say('alarms.since', { time, age: ageText((now - raisedUs) / 1000) });
    }

    // Who did what about it last, until when, and why.
    note({ state, who, reason, untilUs, held }) {
        const clock = zoneClock(this.session.model.plant.time_zone);
        const until = untilUs === null ? '' : say('alarms.until', { time: clock(untilUs / 1000).time.slice(0, 5) });
        const by = who && state !== 'unacknowledged' ? say('alarms.by', { who }) : '';
        return [until, by, reason, held ? say('alarms.held') : ''].filter(Boolean).join(', ');
    }

    row(alarm) {
        const { tag, kind, state, priority } = alarm;
        const value = limitText(this.session.model, alarm), what = ` ${say(`kind.${kind}`)}${value ? `, ${value}` : ''}`;
        const asset = this.session.model.asset(tag.asset), age = make('span', { class: 'since' }, this.since(alarm));
        const title = say('alarms.fly', { tag: tag.name }), nowhere = tag.index === null; // a device is at no place of the model
        const how = nowhere ? { class: 'alarm-go' } : { type: 'button', class: 'alarm-go', title, onclick: () => this.flyTo(tag) };
        const fly = make(nowhere ? 'div' : 'button', how, badge(priority), make('span', { class: 'what' }, make('b', {}, tag.name), what),
            make('span', { class: 'where' }, [asset?.tag ?? asset?.id, tag.description].filter(Boolean).join(', ')),
            make('span', { class: 'state' }, say(`state.${state}`)), age, make('span', { class: 'note' }, this.note(alarm)));
        const buttons = actionsFor(alarm, this.alarms.mode, this.session.role).map((action) =>
            make('button', { type: 'button', 'data-action': action, onclick: () => this.act(action, alarm) }, say(`action.${action}`)));
        const look = { class: isWaiting(state) ? 'calls' : state, 'data-alarm': alarm.id };
        return make('li', look, fly, make('div', { class: 'do' }, ...buttons));
    }

    flyTo(tag) {
        if (this.small.matches)
            this.setOpen(false); // there is room for the place or for the list
        this.showTag(tag);
        this.flyToTag(tag);
    }

    act(action, alarm) {
        if (action !== 'shelve') {
            actOnAlarm(this.session, action, [[alarm.tag.name, alarm.kind]]);
            return;
        }
        this.shelving = alarm;
        setText(byId('shelve-title'), say('shelve.title', { what: `${alarm.tag.name} ${say(`kind.${alarm.kind}`)}` }));
        byId('shelve-reason').value = '';
        byId('shelve').showModal();
    }

    shelve(event) {
        event.preventDefault();
        const { tag, kind } = this.shelving;
        const reason = byId('shelve-reason').value.trim();
        if (!reason)
            return;
        actOnAlarm(this.session, 'shelve', [[tag.name, kind]], { reason, for_s: Number(byId('shelve-for').value) });
        byId('shelve').close();
    }

    answered({ refused }) {
        setText(byId('alarms-refused'), refused.map(([tag, kind, why]) => `${tag} ${kind}: ${refusalText(why)}`).join('; '));
    }
}

