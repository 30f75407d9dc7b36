// SPDX-License-Identifier: GPL-3.0-or-later
// The table element shared by the alarm list and the alarm journal: sortable columns and common cells.
import { nextSort, sortable, sortRows } from '../../core/alarm_table.js';
import { isGone } from '../../core/alarms.js';
import { ageText, unitText, valueText, zoneClock } from '../../core/format.js';
import { say } from '../../core/words.js';
import { icon, make, makeSvg, setText } from '../common/dom.js';
import { fillSelect } from '../common/choices.js';
import { badge } from './alarm_bar.js';

const COLUMNS = ['pick', 'state', 'priority', 'tag', 'kind', 'area', 'about', 'us', 'then', 'now', 'limit', 'since', 'do'];
const ICONS = {
    acknowledge: 'M4 10.5 8.5 15 16.5 5.5', shelve: 'M3.5 4h13v4h-13zM4.5 8v8.5h11V8M8 11h4', reset: 'M5 4.5v4h4M5.3 8.5a6 6 0 1 1-.6 4',
    unshelve: 'M3.5 12.5v4h13v-4M10 13V4M6.5 7 10 3.5 13.5 7', in_service: 'M3.5 12.5v4h13v-4M10 13V4M6.5 7 10 3.5 13.5 7',
};

export class AlarmTable {
    // table: an empty <table>; select: a selection list of the sort orders, for screens without column titles; pick: node in
    // the first column's title that selects rows, or null. changed(): called after the user changes the sort order. time: key of
    // the words for the title of the column with times.
    constructor(table, select, pick, changed, time = 'us') {
        Object.assign(this, { select, changed, sort: { by: null, down: false } });
        const titleOf = (name) => say(`column.${name === 'us' ? time : name}`);
        this.heads = COLUMNS.filter(sortable).map((name) => [name, make('th', { scope: 'col', 'data-col': name, 'aria-sort': 'none' },
            make('button', { type: 'button', title: say('column.sort', { what: titleOf(name) }),
                onclick: () => this.order(nextSort(this.sort, name)) }, titleOf(name)))]);
        const heads = new Map(this.heads), other = (name) => (name === 'pick'
            // a first column without the title node `pick` gets role none, so that screen readers read no title for it
            ? make('th', { 'data-col': name, ...pick ? {} : { role: 'none' } }, pick)
            : make('th', { scope: 'col', 'data-col': name }, titleOf(name)));
        table.prepend(make('thead', {}, make('tr', {}, ...COLUMNS.map((name) => heads.get(name) ?? other(name)))));
        fillSelect(select, [['', say('column.order')], ...this.heads.map(([name]) => [name, titleOf(name)])], '');
        select.addEventListener('change', () => this.order({ by: select.value || null, down: false }));
    }

    order(sort) {
        this.sort = sort;
        this.select.value = sort.by ?? '';
        for (const [name, head] of this.heads)
            head.setAttribute('aria-sort', sort.by !== name ? 'none' : sort.down ? 'descending' : 'ascending');
        this.changed();
    }

    sorted(rows) {
        return sortRows(rows, this.sort);
    }

    // Fills a <tbody> with rows. said(row) returns a text that changes whenever the row's display must change; draw(row) makes
    // the row's element. A row whose text did not change keeps its element, so that a button does not move while the user
    // presses it. Returns [[element, row]].
    fill(body, rows, said, draw) {
        const before = new Map([...body.children].map((element) => [element.said, element]));
        const drawn = rows.map((row) => {
            const is = said(row), element = before.get(is) ?? Object.assign(draw(row), { said: is });
            before.delete(is);
            return [element, row];
        });
        for (const element of before.values())
            element.remove();
        drawn.forEach(([element], i) => body.children[i] !== element && body.insertBefore(element, body.children[i] ?? null));
        return drawn;
    }
}

// Returns a function that formats a number in the unit and with the decimals of a tag.
function textsOf(model, tag) {
    const group = model.group(tag.group);
    const text = (value) => (value === null ? '' : valueText(group, value));
    return { unit: unitText(tag.unit || group?.unit), text };
}

// Returns text and title of a cell with a value from the journal. The journal row's unit may differ from the tag's current one,
// or be unknown (null).
function thenTexts(model, { tag, unit: was }, value) {
    const { text, unit } = textsOf(model, tag), then = text(value);
    if (then === '' || was === undefined || (was !== null && unitText(was) === unit))
        return [then, null];
    return was === null ? [`${then} ?`, say('journal.nounit')] : [`${then} ${unitText(was)}`, null];
}

// Returns the present value and its unit as texts. A dash replaces the value while the past is shown, or, with fresh false,
// while no messages arrive from the server.
function nowTexts({ model, time }, tag, fresh) {
    const { text, unit } = textsOf(model, tag), reading = tag.index === null ? null : model.readings[tag.index];
    if (!reading)
        return [''];
    return !fresh || time.atUs !== null ? ['–'] : reading.quality === 'bad' ? [say('novalue')] : [text(reading.value), unit];
}

// Updates the cells that change although the alarm does not: the present value and the age.
export function refreshCells(session, element, row, fresh) {
    const now = session.clockUs(), cell = element.querySelector('[data-col=now]');
    const [value, unit = ''] = nowTexts(session, row.tag, fresh), text = unit ? `${value} ${unit}` : value;
    if (cell.title !== text) {
        cell.title = text;
        cell.replaceChildren(value, ...unit ? [' ', make('small', {}, unit)] : []);
    }
    setText(element.querySelector('[data-col=since]'), row.us === null || now === null ? '' : ageText((now - row.us) / 1000));
}

// Returns title and content of the cell with the time of a raise or change: the time if it was today, otherwise day and time, which are
// two lines in a narrow list.
function timeCell(session, us) {
    if (us === null)
        return [null];
    const clock = zoneClock(session.model.plant.time_zone), at = clock(us / 1000), title = `${at.date} ${at.time}`;
    return at.date === clock(session.clockUs() / 1000).date ? [title, at.time]
        : [title, make('span', {}, at.day), ' ', make('span', {}, at.time.slice(0, 5))];
}

const flyButton = (tag, name, fly) => make('button', { type: 'button', class: 'alarm-go', title: say('alarms.fly', { tag: tag.name }),
    onclick: () => fly(tag) }, name);

// Returns the <tr> for a row of the alarm list or of the journal. The caller supplies the parts in which the two tables differ:
// look (attributes of the <tr>), pick (checkbox), state (text), note and also (texts in the description), buttons. fly(tag) is
// called when the user presses the tag's button.
export function rowOf(session, row, fresh, { look, pick, state, note, also = '', buttons, fly }) {
    const { tag, kind, priority } = row, name = make('b', {}, tag.name);
    const cell = (col, title, ...content) => make('td', { 'data-col': col, title }, ...content);
    // cells with numbers, which show their column's name where there is no room for column titles (alarms.css)
    const named = (col, title, ...content) => make('td', { 'data-col': col, title, 'data-name': say(`column.${col}`) }, ...content);
    const about = [note, row.about, also].filter(Boolean);
    const [value, limit] = [row.value, row.limit].map((number) => thenTexts(session.model, row, number));
    const element = make('tr', look, cell('pick', null, pick), cell('state', state, state),
        cell('priority', null, badge(priority, isGone(row.state))),
        // the alarm of a field device has no tag index and no position in the model to fly to, so its name is not a button
        cell('tag', null, tag.index === null ? name : flyButton(tag, name, fly)),
        cell('kind', null, say(`kind.${kind}`)), cell('area', row.area, row.area),
        cell('about', about.join(' · '), ...about.flatMap((part, i) =>
            [i > 0 ? ' · ' : null, part === note ? make('em', {}, part) : part])),
        cell('us', ...timeCell(session, row.us)), named('then', value[1], value[0]), named('now'),
        named('limit', limit[1], limit[0]), cell('since'), cell('do', null, ...buttons));
    refreshCells(session, element, row, fresh);
    return element;
}

// Returns the button of an action, such as acknowledge, for a row of the alarm list.
export const actionButton = (action, onclick) => make('button', { type: 'button', 'data-action': action, title: say(`action.${action}`),
    'aria-label': say(`action.${action}`), onclick }, makeSvg('svg', { viewBox: '0 0 20 20', 'aria-hidden': 'true' },
    makeSvg('path', { d: ICONS[action] })));

// Returns the button that shows the plant 30 s before an alarm.
export const momentButton = (onclick) => make('button', { type: 'button', class: 'moment-go', title: say('moment.show'),
    'aria-label': say('moment.show'), onclick }, icon('i-clock'));
