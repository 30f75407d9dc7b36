// SPDX-License-Identifier: GPL-3.0-or-later
// The journal, second tab of the alarm list: every alarm change in a time span, with the list's columns and filters.
import { isIn, journalRow, tableCsv } from '../../core/alarm_table.js';
import { journalSpan, readJournal } from '../../core/handover.js';
import { fieldInstant, fieldText } from '../../core/instant.js';
import { askInTime } from '../../core/http.js';
import { dayTime, zoneClock } from '../../core/format.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';
import { fillSelect } from '../common/choices.js';
import { saveFile } from '../common/save_file.js';
import { todayOf } from './alarm_bar.js';
import { AlarmTable, momentButton, refreshCells, rowOf } from './alarm_table.js';

const SPANS = ['shift', 'day', 'today', 'yesterday', 'week', 'chosen'];
const STEP = 5000, SHOWN = 200; // STEP: number of journal rows per request; SHOWN: maximum number of rows in the document
const READ_AGAIN_MS = 3000;     // shortest time in milliseconds between two requests for a time span that ends now
const EVENTS = { raised: ['raise', 'call'], cleared: ['clear'], acknowledged: ['acknowledge', 'reset'],
    shelved: ['shelve', 'unshelve', 'suppress', 'unsuppress', 'out_of_service', 'in_service', 'carry'] };

export class Journal {
    constructor({ session, modules, overlay }) {
        Object.assign(this, { session, modules, overlay, rows: [], drawn: [], most: STEP, shown: SHOWN, readAt: -Infinity, dirty: false });
        this.build();
        fillSelect(byId('journal-which'), [['', say('journal.all')],
            ...Object.keys(EVENTS).map((name) => [name, say(`journal.${name}`)])], '');
        byId('journal-which').addEventListener('input', () => this.show());
        this.table = new AlarmTable(this.element, byId('journal-order'), null, () => this.show());
        session.on('alarms', () => { this.dirty = true; });
        session.on('welcome', () => this.isShown && this.read());
        setInterval(() => this.tick(), 500);
    }

    build() {
        this.span = make('select', { id: 'journal-span', 'aria-label': say('journal.span'), oninput: () => this.choose() });
        fillSelect(this.span, SPANS.map((name) => [name, say(`journal.${name}`)]), 'day');
        const field = (id) => make('input', { type: 'datetime-local', id, 'aria-label': say(`journal.${id.slice(8)}`), step: 1,
            onchange: () => this.read() });
        [this.from, this.to] = [field('journal-from'), field('journal-to')];
        this.between = make('span', { class: 'between', hidden: true }, this.from, '–', this.to);
        this.note = make('span', { class: 'note', role: 'status' });
        this.older = make('button', { type: 'button', id: 'journal-older', hidden: true, onclick: () => this.readOlder() },
            say('journal.older'));
        this.element = make('table', { id: 'journal-table' }, make('tbody', { id: 'journal-list' }));
        this.more = make('button', { type: 'button', id: 'journal-more', hidden: true, onclick: () => {
            this.shown += SHOWN;
            this.show();
        } });
        byId('alarms-journal').append(make('div', { class: 'filter' }, this.span, this.between, this.note, this.older),
            make('div', { class: 'scroll' }, this.element, this.more));
    }

    // list: the alarm list, whose filters also apply to the journal.
    open(list) {
        this.list = list;
        return this.read();
    }

    // Removes all rows when the journal goes out of sight; otherwise the document would grow with every alarm change.
    rest() {
        Object.assign(this, { rows: [], drawn: [], cut: false, failed: null, number: (this.number ?? 0) + 1 });
        byId('journal-list').replaceChildren();
    }

    get isShown() {
        return Boolean(this.list?.open && this.list.journalOpen);
    }

    get zone() {
        return this.session.model.plant.time_zone;
    }

    // Returns the chosen span as [from, to] in microseconds; `to` null: the span ends now.
    get limits() {
        const nowUs = this.session.clockUs() ?? Date.now() * 1000;
        return this.span.value === 'chosen' ? [this.from, this.to].map(({ value }) => fieldInstant(value, this.zone))
            : journalSpan(this.span.value, nowUs, this.zone);
    }

    get rangeText() {
        return this.span.value === 'chosen' ? [this.from, this.to].map(({ value }) => value.replace('T', ' ')).join(' – ')
            : this.span.selectedOptions[0].text;
    }

    // Clears the filter for the kinds of changes.
    unfilter() {
        byId('journal-which').value = '';
    }

    choose() {
        const isChosen = this.span.value === 'chosen';
        if (isChosen && !this.from.value) {
            const nowUs = this.session.clockUs() ?? Date.now() * 1000;
            [this.from.value, this.to.value] = [nowUs - 3600e6, nowUs].map((us) => fieldText(us, this.zone));
        }
        this.between.hidden = !isChosen;
        Object.assign(this, { most: STEP, shown: SHOWN });
        return this.read();
    }

    readOlder() {
        this.most += STEP;
        return this.read();
    }

    // Requests the chosen time span's journal rows and shows them, unless a newer request has started meanwhile.
    async read() {
        const [fromUs, toUs] = this.limits, number = this.number = (this.number ?? 0) + 1;
        Object.assign(this, { dirty: false, readAt: performance.now() });
        if (fromUs === null)
            return;
        const get = (query) => askInTime('api/v1/alarms/journal', query, this.session.token);
        try {
            const { rows, cut, failed } = await readJournal(get, fromUs / 1e6, toUs === null ? 'now' : toUs / 1e6, this.most);
            if (number === this.number)
                Object.assign(this, { rows: rows.map((row) => journalRow(this.session.model, row)), cut, failed });
        } catch (error) {
            if (number === this.number)
                Object.assign(this, { rows: [], cut: false, failed: error.message });
        }
        this.show();
    }

    tick() {
        if (!this.isShown || !this.session.model)
            return;
        if (this.dirty && this.limits[1] === null && performance.now() - this.readAt > READ_AGAIN_MS)
            this.read();
        for (const [element, row] of this.drawn)
            refreshCells(this.session, element, row, this.overlay.fresh);
    }

    get passing() {
        const { filter } = this.list, events = EVENTS[byId('journal-which').value], words = filter.words.toLowerCase().split(/\s+/);
        return this.rows.filter((row) => isIn(row, filter) && (!events || events.includes(row.event)) && (filter.words === '' ||
            words.every((word) => `${this.list.textOf(row)} ${row.who} ${row.reason}`.toLowerCase().includes(word))));
    }

    show() {
        if (!this.isShown)
            return;
        const passing = this.table.sorted(this.passing), all = this.rows.length, today = todayOf(this.session);
        this.drawn = this.table.fill(byId('journal-list'), passing.slice(0, this.shown), ({ id }) => `${id} ${today}`,
            (row) => this.draw(row));
        const changes = byId('journal-which');
        this.list.showApplied(passing.length, all, [...changes.value ? [changes.selectedOptions[0].text] : [], ...this.list.applied],
            this.rangeText);
        this.more.hidden = passing.length <= this.shown;
        setText(this.more, say('alarms.more', { count: passing.length - this.shown }));
        const time = this.cut && dayTime(zoneClock(this.zone), this.rows.at(-1).us / 1000);
        const count = this.cut ? say('journal.cut', { count: passing.length, all, time })
            : say('journal.count', { count: passing.length });
        setText(this.note, [this.failed, (!this.failed || all > 0) && count].filter(Boolean).join(' · '));
        this.older.hidden = !this.cut;
    }

    draw(row) {
        const isRaise = EVENTS.raised.includes(row.event);
        return rowOf(this.session, row, this.overlay.fresh, {
            look: { class: isRaise ? 'raised' : 'changed', 'data-event': row.event }, pick: null, state: say(`change.${row.event}`),
            note: [row.who && say('alarms.by', { who: row.who }), row.reason].filter(Boolean).join(', '),
            buttons: isRaise && this.session.recorded ? [momentButton(() => this.list.showMoment(row))] : [],
            fly: (tag) => this.list.flyTo(tag),
        });
    }

    save() {
        saveFile('alarm_journal.csv', 'text/csv', tableCsv(this.table.sorted(this.passing)));
    }
}
