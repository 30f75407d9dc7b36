// SPDX-License-Identifier: GPL-3.0-or-later
// The shift handover page: notes, alarms, acknowledgements and shelved alarms for the next shift, to be printed or saved as PDF by the
// browser. ?from and ?to as in /api/v1/history.
import { zoneClock } from '../core/format.js';
import { readJournal, sortJournal } from '../core/handover.js';
import { ask } from '../core/history.js';
import { whereOf } from '../core/notes.js';
import { language, learnWords, say } from '../core/words.js';
import { byId, make } from '../app/common/dom.js';
import { store, stored } from '../app/common/storage.js';

const HOURS = [8, 12, 24], MOST = 200; // maximum rows of a table
const query = new URLSearchParams(location.search), token = stored('token');
document.documentElement.lang = language;
await learnWords();
new BroadcastChannel('plantcast').onmessage = ({ data }) => { // clears this page when the page that opened it was locked
    if (data === 'locked') {
        store('token', '');
        location.reload();
    }
};

const get = async (path, args = {}) => (await ask(`api/v1/${path}`, args, token)).json();
let clock = zoneClock('UTC');
const timeOf = (us) => {
    const { date, time } = clock(us / 1000);
    return `${date} ${time.slice(0, 5)}`;
};
const alarmOf = ({ tag, kind }) => `${tag} · ${say(`kind.${kind}`)}`;

function tableOf(titles, rows) {
    if (rows.length === 0)
        return make('p', { class: 'none' }, say('none'));
    const body = rows.slice(0, MOST).map((cells) => make('tr', {}, ...cells.map((text) => make('td', {}, text))));
    const table = make('table', {}, make('thead', {}, make('tr', {}, ...titles.map((name) => make('th', {}, say(`handover.${name}`))))),
        make('tbody', {}, ...body));
    return rows.length > MOST ? make('div', {}, table, make('p', { class: 'none' }, say('walls.more',
        { count: rows.length - MOST }))) : table;
}

const part = (name, titles, rows) => make('section', { 'data-part': name }, make('h2', {}, say(`handover.${name}`)), tableOf(titles, rows));

function formOf(hours) {
    const select = make('select', { onchange: () => location.assign(`?from=-${select.value}h`) }, ...HOURS.map((n) =>
        make('option', { value: n, selected: n === hours }, say('handover.hours', { n }))));
    return make('form', { onsubmit: (event) => event.preventDefault() }, make('label', {}, say('handover.last'), select),
        make('button', { type: 'button', onclick: () => window.print() }, say('handover.print')));
}

function pageOf({ plant, assets }, notes, journal, standing, [fromUs, toUs], missing) {
    const { raised, acknowledged, shelved, aside } = sortJournal(journal.rows);
    const model = { asset: (id) => assets.find((one) => one.id === id) };
    const doneBy = ({ time_us: us, who, reason, ...alarm }) => [timeOf(us), alarmOf(alarm), who, reason ?? ''];
    const endOf = ({ ended_us: us, ended_by: who, until_us: until }) =>
        (us ? say('handover.ended', { who, time: timeOf(us) }) : until ? timeOf(until) : '');
    const noteOf = (note) => [timeOf(note.time_us), whereOf(model, note) ?? say('notes.place'), note.text, note.by, endOf(note)];
    const counts = [['raised', raised.reduce((sum, { count }) => sum + count, 0)], ['acknowledged', acknowledged.length],
        ['standing', standing.length]];
    const title = say('handover.title', { plant: plant.name });
    document.title = `${title} ${timeOf(toUs)}`;
    return [
        make('h1', {}, title), make('p', { class: 'span' }, `${timeOf(fromUs)} – ${timeOf(toUs)} ${clock(toUs / 1000).offset}`),
        formOf(Math.round((toUs - fromUs) / 3600e6)),
        make('p', { class: 'counts' }, ...counts.map(([name, n]) =>
            make('span', {}, `${say(`handover.${name}`)}: `, make('b', {}, String(n))))),
        ...[...missing, ...(journal.cut ? [say('handover.cut')] : [])].map((text) => make('p', { class: 'wrong' }, text)),
        part('notes', ['time', 'where', 'what', 'who', 'until'], notes.map(noteOf)),
        part('standing', ['time', 'alarm', 'priority', 'state', 'who'], standing.map((alarm) => [timeOf(alarm.raised_us), alarmOf(alarm),
            String(alarm.priority), say(`state.${alarm.state}`), [alarm.who, alarm.reason].filter(Boolean).join(': ')])),
        part('raised', ['time', 'alarm', 'priority', 'count', 'newest'], raised.map(({ first, last, count, priority, ...alarm }) =>
            [timeOf(first), alarmOf(alarm), String(priority), String(count), timeOf(last)])),
        part('acknowledged', ['time', 'alarm', 'who', 'reason'], acknowledged.map(doneBy)),
        part('shelved', ['time', 'alarm', 'who', 'reason'], [...shelved, ...aside].map(doneBy)),
        make('div', { class: 'sign' }, make('p', {}, say('handover.gives')), make('p', {}, say('handover.takes'))),
    ];
}

// Shows the list, only to operators and engineers, because it names users.
async function show() {
    const { role } = await get('me');
    if (!['operator', 'engineer'].includes(role))
        throw new Error(say('handover.denied'));
    const span = { from: query.get('from') ?? '-8h', to: query.get('to') ?? 'now' };
    const missing = []; // names of the data that could not be loaded, which the page lists
    const orElse = (empty) => (error) => {
        missing.push(error.message);
        return empty;
    };
    const [plant, { list }, alarms, gaps] = await Promise.all([get('plant'), get('notes', span),
        get('alarms', { limit: 10000 }).catch(orElse({ alarms: [] })), get('history/gaps', span)]);
    const journal = await readJournal((args) => get('alarms/journal', args).catch(orElse({ rows: [] })), span.from, span.to);
    clock = zoneClock(plant.plant.time_zone);
    byId('handover').replaceChildren(...pageOf(plant, list, journal, alarms.alarms, [gaps.from_us, gaps.to_us], missing));
}

show().catch((error) => byId('handover').replaceChildren(make('p', { class: 'wrong' }, error.message)));
