// SPDX-License-Identifier: GPL-3.0-or-later
// The shift handover page: notes, alarms, acknowledgements and shelved alarms for the next shift, to be printed or saved as PDF by the
// browser. ?from and ?to as in /api/v1/history.
import { asideOf } from '../core/alarm_actions.js';
import { areaOf } from '../core/alarm_table.js';
import { dateTime, dayTime, unitText, valueText, zoneClock } from '../core/format.js';
import { hearAlarms, readJournal, sortJournal } from '../core/handover.js';
import { askInTime } from '../core/http.js';
import { Model } from '../core/model.js';
import { whereText } from '../core/notes.js';
import { language, learnWords, say } from '../core/words.js';
import { byId, make } from '../app/common/dom.js';
import { store, stored } from '../app/common/storage.js';

const HOURS = [8, 12, 24], MOST = 200; // MOST: maximum number of rows in a table
const query = new URLSearchParams(location.search), token = stored('token');
document.documentElement.lang = language;
await learnWords();
new BroadcastChannel('plantcast').onmessage = ({ data }) => { // clears this page when the page that opened it was locked for inactivity
    if (data === 'locked') {
        store('token', '');
        location.reload();
    }
};

const get = (path, args = {}) => askInTime(`api/v1/${path}`, args, token);
let clock = zoneClock('UTC');
const dateTimeOf = (us) => dateTime(clock, us / 1000);
const dayTimeOf = (us) => dayTime(clock, us / 1000, 5); // without the year, which is in the page's heading
const alarmOf = (tag, kinds) => `${tag} · ${kinds.map((kind) => say(`kind.${kind}`)).join(', ')}`;
const kindsOf = ({ kind, others = [] }) => [kind, ...others.map((other) => other.kind)];

// Returns the equipment of a tag and the tag's description as text.
function aboutOf(model, tag) {
    const area = tag ? areaOf(model, tag) : '', about = tag?.description ?? '';
    return about.startsWith(area) ? about : [area, about].filter(Boolean).join(', ');
}

// Returns a value and the limit that it exceeded as text, in the unit of the journal's row (null: not known), else in the tag's unit.
function valueOf(model, tag, { value, limit, unit: was }) {
    const group = tag && model.group(tag.group), number = (x) => valueText(group, x);
    const unit = unitText(was === undefined ? tag?.unit || group?.unit : was ?? ''), texts = [number(value),
        limit === null ? '' : `(${number(limit)})`, unit];
    return value === null ? '' : texts.filter(Boolean).join(' ');
}

// rows: null if they could not be read, for the reason `why`.
function tableOf(titles, rows, why) {
    if (rows === null)
        return make('p', { class: 'wrong' }, say('handover.unread', { why }));
    if (rows.length === 0)
        return make('p', { class: 'none' }, say('none'));
    const names = titles.map((name) => say(`handover.${name}`));
    const rowOf = (cells) => make('tr', {}, ...cells.map((text, i) => make('td', { 'data-title': names[i] }, text)));
    const body = rows.slice(0, MOST).map(rowOf);
    const table = make('table', {}, make('thead', {}, make('tr', {}, ...names.map((name) => make('th', {}, name)))),
        make('tbody', {}, ...body));
    return rows.length > MOST ? make('div', {}, table, make('p', { class: 'none' }, say('walls.more',
        { count: rows.length - MOST }))) : table;
}

const part = (name, titles, rows, why) => make('section', { 'data-part': name }, make('h2', {}, say(`handover.${name}`)),
    tableOf(titles, rows, why));

function formOf(hours) {
    const select = make('select', { onchange: () => location.assign(`?from=-${select.value}h`) }, ...HOURS.map((n) =>
        make('option', { value: n, selected: n === hours }, say('handover.hours', { n }))));
    return make('form', { onsubmit: (event) => event.preventDefault() }, make('label', {}, say('handover.last'), select),
        make('button', { type: 'button', onclick: () => window.print() }, say('handover.print')));
}

function standingPart(model, alarms, why) {
    return part('standing', ['priority', 'alarm', 'about', 'state', 'time', 'value', 'who'], alarms && alarms.list().map((alarm) =>
        [String(alarm.priority), alarmOf(alarm.tag.name, kindsOf(alarm)), aboutOf(model, alarm.tag), say(`state.${alarm.state}`),
            dayTimeOf(alarm.raisedUs), valueOf(model, alarm.tag, alarm), [alarm.who, alarm.reason].filter(Boolean).join(': ')]), why);
}

function asidePart(model, alarms, why) {
    return part('asides', ['alarm', 'about', 'state', 'until', 'who', 'reason'], alarms && asideOf(alarms).map((alarm) =>
        [alarmOf(alarm.tag.name, [alarm.kind]), aboutOf(model, alarm.tag), say(`state.${alarm.state}`),
            alarm.untilUs ? dayTimeOf(alarm.untilUs) : '', alarm.who, alarm.reason]), why);
}

// alarms, journal: null if they could not be read; failures: { alarms, journal } has the reasons. cut: true if one of the two is shortened.
function pageOf(model, notes, alarms, journal, cut, [fromUs, toUs], failures) {
    const { raised, acknowledged, shelved, aside } = journal ? sortJournal(journal.rows) : {}, { active, waiting } = alarms?.counts() ?? {};
    const doneBy = ({ time_us: us, who, reason, tag, kinds }) =>
        [dayTimeOf(us), alarmOf(tag, kinds), aboutOf(model, model.tag(tag)), who, reason ?? ''];
    const raisedOf = ({ first, last, count, priority, tag, kinds, ...row }) => [dayTimeOf(first), alarmOf(tag, kinds),
        aboutOf(model, model.tag(tag)), String(priority), String(count), dayTimeOf(last), valueOf(model, model.tag(tag), row)];
    const endOf = ({ ended_us: us, ended_by: who, until_us: until }) =>
        (us ? say('handover.ended', { who, time: dayTimeOf(us) }) : until ? dayTimeOf(until) : '');
    const noteOf = (note) => [dayTimeOf(note.time_us), whereText(model, note), note.text, note.by, endOf(note)];
    const counts = [['active', active], ['waiting', waiting], ['raised', raised?.reduce((sum, { count }) => sum + count, 0)],
        ['acknowledged', acknowledged?.length]];
    const title = say('handover.title', { plant: model.plant.name });
    document.title = `${title} ${dateTimeOf(toUs)}`;
    return [
        make('h1', {}, title), make('p', { class: 'span' }, `${dateTimeOf(fromUs)} – ${dateTimeOf(toUs)} ${clock(toUs / 1000).offset}`),
        formOf(Math.round((toUs - fromUs) / 3600e6)),
        make('p', { class: 'counts' }, ...counts.map(([name, n]) =>
            make('span', {}, `${say(`handover.${name}`)}: `, make('b', {}, String(n ?? '–'))))),
        ...[journal?.failed, cut && say('handover.cut')].filter(Boolean)
            .map((text) => make('p', { class: 'wrong' }, text)),
        part('notes', ['time', 'where', 'what', 'who', 'until'], notes.map(noteOf)),
        standingPart(model, alarms, failures.alarms), asidePart(model, alarms, failures.alarms),
        part('raised', ['time', 'alarm', 'about', 'priority', 'count', 'newest', 'value'], journal && raised.map(raisedOf),
            failures.journal),
        part('acknowledged', ['time', 'alarm', 'about', 'who', 'reason'], journal && acknowledged.map(doneBy), failures.journal),
        part('shelved', ['time', 'alarm', 'about', 'who', 'reason'], journal && [...shelved, ...aside].map(doneBy), failures.journal),
        make('div', { class: 'sign' }, make('p', {}, say('handover.gives')), make('p', {}, say('handover.takes'))),
    ];
}

// Shows the handover page, but only to operators and engineers, because it contains users' names.
async function show() {
    const { role } = await get('me');
    if (!['operator', 'engineer'].includes(role))
        throw new Error(say('handover.denied'));
    const span = { from: query.get('from') ?? '-8h', to: query.get('to') ?? 'now' };
    const failures = {}; // why the alarms or the journal could not be read
    const failed = (name) => (error) => {
        failures[name] = error.message;
        return null;
    };
    const [plant, { list }, alarms, gaps] = await Promise.all([get('plant'), get('notes', span),
        get('alarms', { limit: 10000 }).catch(failed('alarms')), get('history/gaps', span)]);
    const journal = await readJournal((args) => get('alarms/journal', args), span.from, span.to).catch(failed('journal'));
    clock = zoneClock(plant.plant.time_zone);
    const model = new Model(plant);
    if (alarms)
        hearAlarms(model, alarms);
    const cut = Boolean(journal?.cut || alarms?.next_offset);
    byId('handover').replaceChildren(...pageOf(model, list, alarms && model.alarms, journal, cut, [gaps.from_us, gaps.to_us], failures));
}

show().catch((error) => byId('handover').replaceChildren(make('p', { class: 'wrong' }, error.message)));
