// SPDX-License-Identifier: GPL-3.0-or-later
// The alarm list: one row per tag, with actions on one or several alarms.
import { asideOf, inMessages, passes, rowActions, targetsOf } from '../../core/alarm_actions.js';
import { isGone } from '../../core/alarms.js';
import { ageText, zoneClock } from '../../core/format.js';
import { put, refusalText } from '../../core/refusals.js';
import { actOnAlarm } from '../../core/requests.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';
import { fillSelect } from '../common/choices.js';
import { asOf, badge, limitText } from './alarm_bar.js';

const SHOWN = 200; // maximum number of rows in the document
const WHICH = ['all', 'waiting', 'active', 'gone'];

export class AlarmList {
    // showTag(tag) and flyToTag(tag) are functions of the page; of `overlay` only `fresh` is used.
    constructor({ session, modules, overlay, showTag, flyToTag }) {
        Object.assign(this, { session, modules, overlay, showTag, flyToTag });
        // rows selected for acknowledgement: tag -> ids of the tag's unacknowledged alarms at the time of selection
        this.chosen = new Map();
        this.filter = { which: 'all', words: '' };
        const priorities = [1, 2, 3, 4].map((priority) => [priority, say('alarms.priority', { priority })]);
        fillSelect(byId('alarms-which'), [...WHICH.map((name) => [name, say(`which.${name}`)]), ...priorities], 'all');
        for (const [id, name] of [['alarms-which', 'which'], ['alarms-words', 'words']])
            byId(id).addEventListener('input', () => {
                this.filter[name] = byId(id).value;
                this.show();
            });
        byId('alarms-all').addEventListener('change', () => this.chooseAll(byId('alarms-all').checked));
        byId('alarms-acknowledge').addEventListener('click', () => this.acknowledgeChosen());
        this.small = window.matchMedia('(max-width: 719px), (max-height: 480px)');
        byId('alarms-close').addEventListener('click', () => this.setOpen(false));
        byId('shelve-form').addEventListener('submit', (event) => this.shelve(event));
        byId('shelve-cancel').addEventListener('click', () => byId('shelve').close());
        session.on('welcome', () => {
            ['alarms-list', 'alarms-aside'].forEach((id) => byId(id).replaceChildren()); // removes the rows of the previous plant
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
        for (const name of open ? ['engineer', 'import'] : [])
            this.modules.there(name)?.close(); // closes other panels that use the same space
        byId('alarms').hidden = !open;
        byId('alarm-strip').setAttribute('aria-expanded', open);
        this.show();
        if (open)
            byId('alarms-close').focus();
        else
            byId('alarm-strip').focus();
    }

    // Role of the user, which decides about the actions offered; null while no messages arrive from the server.
    get role() {
        return this.overlay.fresh ? this.session.role : null;
    }

    // Updates the ages shown.
    tick() {
        if (!this.open)
            return;
        if (this.shownFresh !== this.overlay.fresh)
            this.show();
        for (const [row, alarm] of this.ages ?? []) {
            setText(row.querySelector('.since'), this.since(alarm));
            setText(row.querySelector('.raised'), this.readingText(alarm));
        }
    }

    show() {
        if (!this.alarms?.known || !this.open)
            return;
        const { fresh } = this.overlay;
        this.shownFresh = fresh;
        byId('alarms-then').hidden = this.session.time.atUs === null;
        setText(byId('alarms-stale'), fresh ? '' : say('alarms.stale', { time: asOf(this.session) }));
        this.keepFocus(() => this.showList());
    }

    showList() {
        const all = this.alarms.list(), aside = asideOf(this.alarms);
        const list = all.filter((row) => passes(row, this.textOf(row), this.filter));
        this.rows = list.slice(0, SHOWN);
        this.ages = [];
        this.forgetChanged(all);
        this.fill('alarms-list', this.rows);
        const none = all.length > 0 ? say('alarms.filtered', { count: all.length }) : say('alarms.quiet');
        setText(byId('alarms-none'), list.length > 0 ? '' : none);
        byId('alarms-aside-head').hidden = aside.length === 0;
        setText(byId('alarms-aside-head'), say('alarms.aside', { count: aside.length }));
        this.fill('alarms-aside', aside.slice(0, SHOWN));
        const more = Math.max(0, list.length - SHOWN) + Math.max(0, aside.length - SHOWN);
        setText(byId('alarms-more'), more > 0 ? say('alarms.more', { count: more }) : '');
        this.showChosen();
    }

    // Returns the text of an alarm in which the filter searches.
    textOf({ tag, kind }) {
        const asset = this.session.model.asset(tag.asset);
        return [tag.name, tag.description, kind, say(`kind.${kind}`), tag.asset, asset?.tag, asset?.description].filter(Boolean).join(' ');
    }

    // Fills the table. Keeps the elements of rows that did not change, so that a button does not move while it is being pressed.
    fill(id, alarms) {
        const list = byId(id), before = new Map([...list.children].map((row) => [row.said, row]));
        const rows = alarms.map((alarm) => {
            const said = [alarm, rowActions(alarm, this.alarms.mode, this.role)];
            const is = JSON.stringify(said, (key, value) => (key === 'tag' ? undefined : value));
            const row = before.get(is) ?? Object.assign(this.row(alarm), { said: is });
            before.delete(is);
            this.ages.push([row, alarm]);
            return row;
        });
        for (const row of before.values())
            row.remove();
        rows.forEach((row, i) => list.children[i] !== row && list.insertBefore(row, list.children[i] ?? null));
    }

    // --- actions on several alarms

    // Returns the ids and times of a row's alarms that this user can acknowledge, as a text; '' if there are none.
    waitsFor(row) {
        return targetsOf(row, 'acknowledge', this.alarms.mode, this.role).map(({ id, raisedUs }) => `${id}@${raisedUs}`).join();
    }

    // Deselects rows that have another alarm than when they were selected, because the user has not seen it.
    forgetChanged(all) {
        const now = new Map(all.map((row) => [row.tag.name, this.waitsFor(row)]));
        for (const [name, was] of this.chosen)
            if (now.get(name) !== was)
                this.chosen.delete(name);
    }

    choose(row, on) {
        if (on)
            this.chosen.set(row.tag.name, this.waitsFor(row));
        else
            this.chosen.delete(row.tag.name);
        this.showChosen();
    }

    chooseAll(on) {
        for (const row of this.rows.filter((one) => this.waitsFor(one)))
            this.choose(row, on);
        this.showChosen();
    }

    showChosen() {
        const can = this.rows.filter((row) => this.waitsFor(row)), on = can.filter(({ tag }) => this.chosen.has(tag.name));
        byId('alarms-many').hidden = can.length < 2;
        byId('alarms-all').checked = on.length === can.length;
        byId('alarms-all').indeterminate = on.length > 0 && on.length < can.length;
        setText(byId('alarms-acknowledge'), say('alarms.acknowledge', { count: on.length }));
        byId('alarms-acknowledge').disabled = on.length === 0;
        for (const box of byId('alarms-list').querySelectorAll('.choose'))
            box.checked = this.chosen.has(box.value);
    }

    // Acknowledges the selected rows that are visible; rows hidden by the filter are not acknowledged.
    acknowledgeChosen() {
        const rows = this.rows.filter(({ tag }) => this.chosen.has(tag.name));
        const alarms = rows.flatMap((row) => targetsOf(row, 'acknowledge', this.alarms.mode, this.role));
        for (const some of inMessages(alarms.map(({ tag, kind }) => [tag.name, kind])))
            actOnAlarm(this.session, 'acknowledge', some);
        this.chosen.clear();
        this.showChosen();
    }

    // Calls f, which rebuilds rows, and then gives the keyboard focus back to the same alarm, or to the next row if that alarm is gone.
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

    // Returns a text with the user who last acted on the alarm, when the effect of the action ends (such as shelving), and the reason.
    note({ state, who, reason, untilUs, held }) {
        const clock = zoneClock(this.session.model.plant.time_zone);
        const until = untilUs === null ? '' : say('alarms.until', { time: clock(untilUs / 1000).time.slice(0, 5) });
        const by = who && state !== 'unacknowledged' ? say('alarms.by', { who }) : '';
        return [until, by, reason, held ? say('alarms.held') : ''].filter(Boolean).join(', ');
    }

    // Returns the other alarms of the row's tag as text.
    also({ others = [] }) {
        return others.length === 0 ? '' : say('alarms.also', { what: others.map(({ kind, state }) =>
            `${say(`kind.${kind}`)} (${say(`state.${state}`)})`).join(', ') });
    }

    readingText(alarm) {
        const value = limitText(this.session, alarm, this.overlay.fresh);
        return value ? `, ${value}` : '';
    }

    row(alarm) {
        const { tag, kind, state, priority } = alarm, { mode } = this.alarms, actions = rowActions(alarm, mode, this.role);
        const reading = make('span', { class: 'raised' }, this.readingText(alarm));
        const asset = this.session.model.asset(tag.asset), age = make('span', { class: 'since' }, this.since(alarm));
        // `nowhere`: true for a device, which has no position in the model
        const title = say('alarms.fly', { tag: tag.name }), nowhere = tag.index === null;
        const how = nowhere ? { class: 'alarm-go' } : { type: 'button', class: 'alarm-go', title, onclick: () => this.flyTo(tag) };
        const note = [this.note(alarm), this.also(alarm)].filter(Boolean).join('; ');
        const fly = make(nowhere ? 'div' : 'button', how, badge(priority, isGone(state)),
            make('span', { class: 'what' }, make('b', {}, tag.name), ` ${say(`kind.${kind}`)}`, reading),
            make('span', { class: 'where' }, [asset?.tag ?? asset?.id, tag.description].filter(Boolean).join(', ')),
            make('span', { class: 'state' }, say(`state.${state}`)), age, make('span', { class: 'note' }, note));
        const buttons = actions.map((action) =>
            make('button', { type: 'button', 'data-action': action, onclick: () => this.act(action, alarm) }, say(`action.${action}`)));
        const choose = make('input', {
            type: 'checkbox', class: 'choose', value: tag.name, 'aria-label': say('alarms.choose', { tag: tag.name }),
            onchange: ({ target }) => this.choose(alarm, target.checked),
        });
        const look = { class: alarm.waiting ? 'calls' : state, 'data-alarm': alarm.id };
        return make('li', look, actions.includes('acknowledge') ? choose : null, fly, make('div', { class: 'do' }, ...buttons));
    }

    flyTo(tag) {
        if (this.small.matches)
            this.setOpen(false); // closes the list on narrow screens, which show either the plant or the list
        this.showTag(tag);
        this.flyToTag(tag);
    }

    // Applies an action to all alarms of the row.
    act(action, row) {
        const alarms = targetsOf(row, action, this.alarms.mode, this.role);
        if (action !== 'shelve') {
            actOnAlarm(this.session, action, alarms.map(({ tag, kind }) => [tag.name, kind]));
            return;
        }
        this.shelving = alarms;
        const kinds = alarms.map(({ kind }) => say(`kind.${kind}`)).join(', ');
        setText(byId('shelve-title'), say('shelve.title', { what: `${row.tag.name} ${kinds}` }));
        byId('shelve-reason').value = '';
        byId('shelve').showModal();
    }

    shelve(event) {
        event.preventDefault();
        const reason = byId('shelve-reason').value.trim();
        if (!reason)
            return;
        const alarms = this.shelving.map(({ tag, kind }) => [tag.name, kind]);
        actOnAlarm(this.session, 'shelve', alarms, { reason, for_s: Number(byId('shelve-for').value) });
        byId('shelve').close();
    }

    answered({ refused, not_kept: count, why, refusal }) {
        const texts = refused.map(([tag, kind, ...cause]) => `${tag} ${kind}: ${refusalText(...cause)}`);
        setText(byId('alarms-refused'), [...texts, ...(count ? [put('page.unkept', { text: refusalText(why, refusal) })] : [])].join('; '));
    }
}

