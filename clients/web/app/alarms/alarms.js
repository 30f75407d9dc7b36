// SPDX-License-Identifier: GPL-3.0-or-later
// The alarm list: one row per tag, with actions on one or several alarms. Its second tab is the alarm journal.
import { allOf, asideOf, inMessages, passes, rowActions, targetsOf } from '../../core/alarm_actions.js';
import { areaOf, areasOf, isIn, tableCsv } from '../../core/alarm_table.js';
import { timeOrDay, zoneClock } from '../../core/format.js';
import { put, refusalText } from '../../core/refusals.js';
import { actOnAlarm } from '../../core/requests.js';
import { say, sayIfKnown } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';
import { fillSelect } from '../common/choices.js';
import { saveFile } from '../common/save_file.js';
import { asOf, heldSince, todayOf } from './alarm_bar.js';
import { addEdge } from './panel_edge.js';
import { actionButton, AlarmTable, momentButton, refreshCells, rowOf } from './alarm_table.js';

const SHOWN = 200; // maximum number of the alarm list's rows in the document
// true on wide screens; on narrower ones the list covers the equipment list (alarms.css)
const WIDE = window.matchMedia('(min-width: 1200px)');
const WHICH = ['all', 'waiting', 'active', 'gone'];
const FILTERS = { words: 'alarms-words', which: 'alarms-which', priority: 'alarms-priority', area: 'alarms-area' };
const NO_FILTER = { words: '', which: 'all', priority: '', area: '' };

export class AlarmList {
    // showTag(tag) selects a tag, flyToTag(tag) moves the camera to it. overlay: the markers over the picture; the list reads only
    // overlay.fresh (true: messages arrive from the server).
    constructor({ session, modules, overlay, showTag, flyToTag }) {
        Object.assign(this, { session, modules, overlay, showTag, flyToTag });
        // selected rows: tag -> signature of the tag's alarms at the time of selection (see signatureOf)
        this.chosen = new Map();
        this.filter = { ...NO_FILTER };
        this.pickAll = make('input', { type: 'checkbox', id: 'alarms-all', 'aria-label': say('alarms.chooseall'),
            title: say('alarms.chooseall'), onchange: () => this.chooseAll(this.pickAll.checked) });
        this.table = new AlarmTable(byId('alarms-table'), byId('alarms-order'), this.pickAll, () => this.show(), 'raised');
        fillSelect(byId('alarms-priority'), [['', say('alarms.priorities')],
            ...[1, 2, 3, 4].map((priority) => [priority, say('alarms.priority', { priority })])], '');
        for (const [name, id] of Object.entries(FILTERS))
            byId(id).addEventListener('input', () => {
                this.filter[name] = byId(id).value;
                this.show();
            });
        this.small = window.matchMedia('(max-width: 719px), (max-height: 480px)');
        const press = { 'alarms-acknowledge': () => this.actOnChosen('acknowledge'), 'alarms-shelve': () => this.actOnChosen('shelve'),
            'alarms-unchoose': () => this.chooseAll(false), 'alarms-applied': () => this.unfilter(),
            'alarms-close': () => this.setOpen(false), 'alarms-csv': () => this.save(),
            'shelve-cancel': () => byId('shelve').close(), 'alarms-tab': () => this.turnTo(false), 'journal-tab': () => this.turnTo(true) };
        for (const [id, f] of Object.entries(press))
            byId(id).addEventListener('click', f);
        byId('shelve-form').addEventListener('submit', (event) => this.shelve(event));
        byId('shelve').addEventListener('close', () => this.focusRow(this.shelving[0]?.id));
        for (const tab of ['alarms-tab', 'journal-tab'])
            byId(tab).addEventListener('keydown', ({ key }) =>
                ['ArrowLeft', 'ArrowRight'].includes(key) && this.turnTo(!this.journalOpen, true));
        session.on('welcome', () => {
            ['alarms-list', 'alarms-aside'].forEach((id) => byId(id).replaceChildren()); // removes the rows of the previous plant
            this.show();
        });
        for (const name of ['alarms', 'time'])
            session.on(name, () => this.show());
        session.on('alarmed', (answer) => this.answered(answer));
        setInterval(() => this.tick(), 500);
        addEdge(byId('alarms'));
    }

    get alarms() {
        return this.session.model?.alarms ?? null;
    }

    get open() {
        return !byId('alarms').hidden;
    }

    get journalOpen() {
        return !byId('alarms-journal').hidden;
    }

    toggle() {
        this.setOpen(!this.open);
    }

    setOpen(open) {
        const opener = document.activeElement?.closest('[aria-controls="alarms"]'); // before other panels close and take the focus away
        for (const name of open ? ['engineer', 'import'] : [])
            this.modules.there(name)?.close(); // closes the engineering and import panels, which are shown in the same place
        this.shareRoom(open);
        byId('alarms').hidden = !open;
        byId('alarm-strip').setAttribute('aria-expanded', open);
        this.readJournal();
        this.show();
        if (open) {
            this.opener = opener;
            byId('alarms-close').focus();
        } else
            (this.opener?.isConnected ? this.opener : byId('alarm-strip')).focus();
    }

    // Closes the equipment list while the alarm list is open, to leave room for the picture, and reopens it afterwards.
    shareRoom(open) {
        const assets = this.modules.there('assets');
        if (open && assets?.open && WIDE.matches) {
            assets.setOpen(false);
            this.borrowed = true;
        } else if (!open && this.borrowed) {
            assets.setOpen(true);
            this.borrowed = false;
        }
    }

    // Switches the panel to the tab with the journal (journal true) or the present alarms.
    turnTo(journal, focus = false) {
        for (const [id, on] of [['alarms-tab', !journal], ['journal-tab', journal]]) {
            byId(id).setAttribute('aria-selected', on);
            byId(id).tabIndex = on ? 0 : -1;
            if (on && focus)
                byId(id).focus();
        }
        for (const id of ['alarms-now', 'alarms-which', 'alarms-order'])
            byId(id).hidden = journal;
        for (const id of ['alarms-journal', 'journal-which', 'journal-order'])
            byId(id).hidden = !journal;
        this.readJournal();
        this.show();
    }

    // Reads the journal if it is visible now, else empties it.
    readJournal() {
        if (this.open && this.journalOpen)
            this.modules.use('journal', (part) => part.open(this), 'open');
        else
            this.modules.there('journal')?.rest();
    }

    // The user's role, which decides which actions are offered; null while no messages arrive from the server.
    get role() {
        return this.overlay.fresh ? this.session.role : null;
    }

    // Updates ages and present values.
    tick() {
        if (!this.open)
            return;
        if (this.shownFresh !== this.overlay.fresh || this.shownDay !== todayOf(this.session))
            this.show();
        for (const [element, row] of this.journalOpen ? [] : this.drawn ?? [])
            refreshCells(this.session, element, row, this.overlay.fresh);
    }

    show() {
        if (!this.alarms?.known || !this.open)
            return;
        const { fresh } = this.overlay;
        this.shownFresh = fresh;
        this.shownDay = todayOf(this.session); // texts of times in all rows depend on today's date
        byId('alarms-then').hidden = this.journalOpen || this.session.time.atUs === null;
        setText(byId('alarms-stale'), fresh ? '' : say('alarms.stale', { time: asOf(this.session) }));
        this.keepFocus(() => this.showList());
        if (this.journalOpen)
            this.modules.there('journal')?.show();
    }

    // Returns an alarm plus the members that the table shows and sorts by.
    rowOf = (alarm) => ({ ...alarm, us: alarm.raisedUs, area: areaOf(this.session.model, alarm.tag), about: alarm.tag.description ?? '' });

    showList() {
        const all = this.alarms.list().map(this.rowOf), aside = asideOf(this.alarms).map(this.rowOf);
        this.showChoices(all);
        const passing = (row) => isIn(row, this.filter) && passes(row, this.textOf(row), { ...this.filter, which: 'all' });
        const list = this.table.sorted(all.filter((row) => passing(row) && passes(row, '', { which: this.filter.which, words: '' })));
        const asides = this.table.sorted(aside.filter(passing));
        this.listed = [...list, ...asides];
        this.rows = list.slice(0, SHOWN);
        this.forgetChanged(all);
        this.drawn = [...this.fill('alarms-list', this.rows), ...this.fill('alarms-aside', asides.slice(0, SHOWN))];
        const none = all.length > 0 ? say('alarms.filtered', { count: all.length }) : say('alarms.quiet');
        setText(byId('alarms-none'), list.length > 0 ? '' : none);
        if (!this.journalOpen)
            this.showApplied(list.length + asides.length, all.length + aside.length, this.applied);
        this.showAsideHead(asides.length);
        const more = Math.max(0, list.length - SHOWN) + Math.max(0, asides.length - SHOWN);
        setText(byId('alarms-more'), more > 0 ? say('alarms.more', { count: more }) : '');
        this.showChosen();
    }

    // Returns the alarm list's filter settings (search words, state, priority, area) as texts for a button. The journal is not
    // filtered by state.
    get applied() {
        const { words, which, priority, area } = this.filter;
        return [words.trim() && `“${words.trim()}”`, !this.journalOpen && which !== 'all' && say(`which.${which}`),
            priority && say('alarms.priority', { priority }), area].filter(Boolean);
    }

    // Shows the filter settings on a button that clears them: on small screens the filter's fields may be out of sight. range:
    // the journal's time range, shown where its field is hidden (common/sheet.css); the button does not clear it.
    showApplied(count, all, applied, range = '') {
        const button = byId('alarms-applied'), some = applied.length > 0;
        button.hidden = !some && !range;
        button.disabled = !some;
        const what = [...(range ? [range] : []), ...applied].join(' · ');
        setText(button.firstChild, some ? `${count}/${all} · ${what}` : what);
        button.title = some ? say('alarms.unfilter', { count, all, what }) : what;
        button.setAttribute('aria-label', button.title);
    }

    // Clears the filter settings that the button `alarms-applied` shows.
    unfilter() {
        for (const [name, id] of Object.entries(FILTERS))
            if (name !== 'which' || !this.journalOpen)
                byId(id).value = this.filter[name] = NO_FILTER[name];
        if (this.journalOpen)
            this.modules.there('journal')?.unfilter();
        // moves the keyboard focus away from the button `alarms-applied`, which is about to be hidden
        byId(this.journalOpen ? 'journal-tab' : 'alarms-tab').focus();
        this.show();
    }

    // Fills the filter's selection lists: areas, and states with the number of alarms in each state.
    showChoices(all) {
        const choices = WHICH.map((name) => [name, `${say(`which.${name}`)} (${all.filter((row) => passes(row, '',
            { which: name, words: '' })).length})`]);
        fillSelect(byId('alarms-which'), choices, this.filter.which);
        setText(byId('alarms-count'), String(all.length));
        if (this.offeredOf !== this.session.model) {
            this.offeredOf = this.session.model;
            this.offered = areasOf(this.session.model.assets.map(({ id }) => ({ area: areaOf(this.session.model, { asset: id }) })));
        }
        fillSelect(byId('alarms-area'), [['', say('alarms.areas')], ...this.offered.map((area) => [area, area])], this.filter.area);
    }

    showAsideHead(count) {
        const head = byId('alarms-aside-head');
        head.hidden = count === 0;
        if (!head.firstChild)
            head.append(make('tr', {}, make('th', { scope: 'rowgroup' })));
        setText(head.querySelector('th'), say('alarms.aside', { count }));
    }

    // Returns the searchable text of an alarm, for the text filter.
    textOf({ tag, kind }) {
        const asset = this.session.model.asset(tag.asset);
        return [tag.name, tag.description, kind, say(`kind.${kind}`), tag.asset, asset?.tag, asset?.description].filter(Boolean).join(' ');
    }

    fill(id, rows) {
        const today = todayOf(this.session);
        return this.table.fill(byId(id), rows, (row) => JSON.stringify([today, row, rowActions(row, this.alarms.mode, this.role)],
            (key, value) => (key === 'tag' ? undefined : value)), (row) => this.draw(row));
    }

    // --- selecting rows of the alarm list, and actions on all selected alarms

    // Returns the ids and raise times of a row's alarms as text. While it stays the same, the row has the alarms that the user
    // selected.
    signatureOf = (row) => allOf(row).map(({ id, raisedUs }) => `${id}@${raisedUs}`).join();

    can = (row) => rowActions(row, this.alarms.mode, this.role).some((action) => ['acknowledge', 'shelve'].includes(action));

    // Deselects rows whose alarms have changed since the user selected the rows, because the user has not seen the new alarms.
    forgetChanged(all) {
        const now = new Map(all.map((row) => [row.tag.name, this.can(row) ? this.signatureOf(row) : null]));
        for (const [name, was] of this.chosen)
            if (now.get(name) !== was)
                this.chosen.delete(name);
    }

    choose(row, on) {
        if (on)
            this.chosen.set(row.tag.name, this.signatureOf(row));
        else
            this.chosen.delete(row.tag.name);
        this.showChosen();
    }

    // Selects a row; with the Shift key also the rows between it and the last pressed row.
    chooseUpTo(row, on, isRange) {
        const at = (name) => this.rows.findIndex(({ tag }) => tag.name === name), here = at(row.tag.name);
        const from = isRange && at(this.pressed) >= 0 ? at(this.pressed) : here;
        this.pressed = row.tag.name;
        for (const one of this.rows.slice(Math.min(from, here), Math.max(from, here) + 1).filter(this.can))
            this.choose(one, on);
    }

    chooseAll(on) {
        for (const row of this.rows.filter(this.can))
            this.choose(row, on);
        this.showChosen();
    }

    // Returns the selected rows that are visible. Actions do not apply to rows that the filter hides.
    get chosenRows() {
        return this.rows.filter(({ tag }) => this.chosen.has(tag.name));
    }

    showChosen() {
        const can = this.rows.filter(this.can), on = this.chosenRows;
        this.pickAll.disabled = can.length === 0;
        this.pickAll.checked = on.length > 0 && on.length === can.length;
        this.pickAll.indeterminate = on.length > 0 && on.length < can.length;
        this.showMany(on.length > 0 && !this.journalOpen);
        setText(byId('alarms-chosen'), say('alarms.chosen', { count: on.length }));
        for (const action of ['acknowledge', 'shelve']) {
            const count = on.filter((row) => rowActions(row, this.alarms.mode, this.role).includes(action)).length;
            setText(byId(`alarms-${action}`), say(`alarms.${action}`, { count }));
            byId(`alarms-${action}`).disabled = count === 0;
        }
        for (const box of byId('alarms-list').querySelectorAll('.choose'))
            box.checked = this.chosen.has(box.value);
    }

    // Shows or hides the buttons for actions on several alarms. If they had the keyboard focus, the first row gets it.
    showMany(shown) {
        const many = byId('alarms-many'), hadFocus = many.contains(document.activeElement);
        many.hidden = !shown;
        if (!shown && hadFocus)
            this.focusRow(null);
    }

    actOnChosen(action) {
        const rows = this.chosenRows, alarms = rows.flatMap((row) => targetsOf(row, action, this.alarms.mode, this.role));
        if (action === 'shelve') {
            this.askShelve(alarms, say('alarms.count', { count: rows.length }));
            return;
        }
        this.send(action, alarms);
        this.chooseAll(false);
    }

    send(action, alarms, more) {
        for (const some of inMessages(alarms.map(({ tag, kind }) => [tag.name, kind])))
            actOnAlarm(this.session, action, some, more);
    }

    // Calls f, which rebuilds rows, then returns the keyboard focus to the same alarm, or to the next row if that alarm is
    // gone.
    keepFocus(f) {
        const held = document.activeElement, row = held.closest('#alarms-now tbody tr');
        const place = row && [...row.parentElement.children].indexOf(row);
        f();
        if (!row || document.activeElement === held)
            return;
        const next = document.querySelector(`#alarms-now tr[data-alarm="${CSS.escape(row.dataset.alarm)}"]`) ??
            [...document.querySelectorAll('#alarms-list tr, #alarms-aside tr')][place];
        (held.isConnected ? held : next?.querySelector('[data-col=do] button, button') ?? byId('alarms-close')).focus();
    }

    // Gives the keyboard focus to the row of an alarm, or to the first row, unless another element has the focus.
    focusRow(id) {
        const { activeElement: held } = document;
        if (held !== document.body && held.checkVisibility())
            return;
        const row = document.querySelector(`#alarms-now tr[data-alarm="${CSS.escape(id ?? '')}"]`) ?? byId('alarms-list').firstChild;
        (row?.querySelector('button') ?? byId('alarms-close')).focus();
    }

    // --- rows

    // Returns the parts of a row's text that its columns do not show: the end of shelving, the user who last acted on the
    // alarm, the reason, and whether the measurement is bad.
    noteOf(row) {
        const { state, who, reason, untilUs, held } = row;
        const clock = zoneClock(this.session.model.plant.time_zone), nowMs = this.session.clockUs() / 1000;
        const until = untilUs === null ? '' : say('alarms.until', { time: timeOrDay(clock, untilUs / 1000, nowMs, 5) });
        const by = who && state !== 'unacknowledged' ? say('alarms.by', { who }) : '';
        const since = held && this.session.time.atUs === null ? heldSince(this.session, row) : null;
        const bad = since ? say('alarms.heldfrom', { time: since }) : held ? say('alarms.held') : '';
        return [until, by, reason, bad].filter(Boolean).join(', ');
    }

    // Returns the other alarms of the row's tag as text.
    alsoOf = ({ others = [] }) => (others.length === 0 ? '' : say('alarms.also', { what: others.map(({ kind, state }) =>
        `${say(`kind.${kind}`)} (${say(`state.${state}`)})`).join(', ') }));

    draw(row) {
        const { tag, kind, state } = row, actions = rowActions(row, this.alarms.mode, this.role);
        const choose = make('input', { type: 'checkbox', class: 'choose', value: tag.name,
            'aria-label': say('alarms.choose', { tag: tag.name }),
            onclick: ({ target, shiftKey }) => this.chooseUpTo(row, target.checked, shiftKey) });
        const buttons = actions.map((action) => actionButton(action, () => this.act(action, row)));
        const back = this.session.recorded && row.us !== null ? [momentButton(() => this.showMoment(row))] : [];
        return rowOf(this.session, row, this.overlay.fresh, {
            look: { class: row.waiting ? 'calls' : state, 'data-alarm': row.id, 'data-kind': kind },
            pick: this.can(row) && row.others ? choose : null,
            state: sayIfKnown(`short.${state}`, say(`state.${state}`)), note: this.noteOf(row),
            also: this.alsoOf(row), buttons: [...back, ...buttons], fly: (one) => this.flyTo(one),
        });
    }

    flyTo(tag) {
        this.giveRoom();
        this.showTag(tag);
        this.flyToTag(tag);
    }

    // Closes the list on narrow screens, which have room for either the plant or the list.
    giveRoom() {
        if (this.small.matches)
            this.setOpen(false);
    }

    showMoment(row) {
        this.giveRoom();
        this.modules.use('moment', (moment) => moment.show(row), 'moment');
    }

    // Applies an action to all alarms of the row.
    act(action, row) {
        const alarms = targetsOf(row, action, this.alarms.mode, this.role);
        if (action === 'shelve')
            this.askShelve(alarms, `${row.tag.name} ${alarms.map(({ kind }) => say(`kind.${kind}`)).join(', ')}`);
        else
            this.send(action, alarms);
    }

    askShelve(alarms, what) {
        this.shelving = alarms;
        setText(byId('shelve-title'), say('shelve.title', { what }));
        byId('shelve-reason').value = '';
        byId('shelve').showModal();
    }

    shelve(event) {
        event.preventDefault();
        const reason = byId('shelve-reason').value.trim();
        if (!reason)
            return;
        this.send('shelve', this.shelving, { reason, for_s: Number(byId('shelve-for').value) });
        this.chosen.clear();
        byId('shelve').close();
    }

    answered({ refused, not_kept: count, why, refusal }) {
        const texts = refused.map(([tag, kind, ...cause]) => `${tag} ${kind}: ${refusalText(...cause)}`);
        setText(byId('alarms-refused'), [...texts, ...(count ? [put('page.unkept', { text: refusalText(why, refusal) })] : [])].join('; '));
    }

    save() {
        if (this.journalOpen)
            this.modules.there('journal')?.save();
        else
            saveFile('alarms.csv', 'text/csv', tableCsv(this.listed));
    }
}
