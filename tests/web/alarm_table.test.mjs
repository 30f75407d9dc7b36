// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of alarms and of the alarm journal: order of the rows, filter, area, export as CSV, and named time spans.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Journal } from '../../clients/web/app/alarms/journal.js';
import { areaOf, areasOf, isIn, journalRow, nextSort, sortRows, tableCsv } from '../../clients/web/core/alarm_table.js';
import { journalSpan } from '../../clients/web/core/handover.js';
import { learnWords } from '../../clients/web/core/words.js';

const row = (name, more = {}) => ({ tag: { name, unit: '°C' }, kind: 'H', state: 'active', priority: 2, us: 10, area: '', about: '',
    value: 1, limit: 2, who: '', reason: '', ...more });
const names = (rows) => rows.map(({ tag }) => tag.name).join(' ');

test('alarm rows sort by any column, and equal rows keep their order', () => {
    const rows = [row('TE-10', { priority: 3, us: 5, area: 'B' }), row('TE-9', { priority: 1, us: 7, area: 'A', state: 'returned' }),
        row('TE-2', { priority: 3, us: 6, area: 'B', state: 'unacknowledged' })];
    const by = (name, down = false) => names(sortRows(rows, { by: name, down }));
    assert.equal(by('tag'), 'TE-2 TE-9 TE-10', 'numbers in names are compared as numbers');
    assert.equal(by('tag', true), 'TE-10 TE-9 TE-2');
    assert.equal(by('priority'), 'TE-9 TE-10 TE-2');
    assert.equal(by('us'), 'TE-9 TE-2 TE-10', 'the newest alarm is first');
    assert.equal(by('area'), 'TE-9 TE-10 TE-2');
    assert.equal(by('state'), 'TE-2 TE-10 TE-9');
    assert.equal(by(null), names(rows));
});

test('one click on a title sorts, a second reverses, a third restores the first order', () => {
    const order = [{ by: null, down: false }];
    for (let i = 0; i < 3; i++)
        order.push(nextSort(order.at(-1), 'tag'));
    assert.deepEqual(order.slice(1), [{ by: 'tag', down: false }, { by: 'tag', down: true }, { by: null, down: false }]);
    assert.deepEqual(nextSort(order[2], 'area'), { by: 'area', down: false });
});

const model = { asset: (id) => ({ P: { id: 'P', tag: 'P-101', area: 'North' }, Q: { id: 'Q', tag: '', area: '' } })[id],
    tag: (name) => (name === 'TI-1' ? { name, index: 0, asset: 'P', description: 'Pump', unit: '°C' } : null) };

test('an alarm\'s area is its equipment\'s area, or the equipment if that has none', () => {
    assert.deepEqual(['P', 'Q', null].map((asset) => areaOf(model, { asset })), ['North', 'Q', '']);
    assert.deepEqual(areasOf([{ area: 'U10' }, { area: 'U9' }, { area: '' }, { area: 'U10' }]), ['U9', 'U10']);
    const north = row('TI-1', { area: 'North', priority: 1 });
    assert.deepEqual([{}, { area: 'North' }, { area: 'South' }, { priority: '1' }, { priority: '2' }].map((filter) => isIn(north, filter)),
        [true, true, false, true, false]);
});

test('the journal has rows also for tags that the plant no longer has, and exports them as CSV', () => {
    const from = { id: 7, time_us: 1e15, tag: 'TI-1', kind: 'HH', event: 'raise', state: 'unacknowledged', priority: 1, value: 95.5,
        limit: 90, unit: '°C', who: '', reason: '' };
    const other = { ...from, tag: 'TI-9', unit: null, event: 'shelve', who: '=kim', reason: 'a, "b"' };
    const known = journalRow(model, from), gone = journalRow(model, other), changed = journalRow(model, { ...from, unit: 'bar' });
    assert.deepEqual([known.area, known.about, known.us, known.tag.index], ['North', 'Pump', 1e15, 0]);
    assert.deepEqual([gone.area, gone.tag.index], ['', null]);
    assert.deepEqual(tableCsv([known, gone, changed]).split('\r\n'), [
        'time,state,event,priority,tag,kind,area,description,value,limit,unit,who,reason',
        '2001-09-09T01:46:40.000Z,unacknowledged,raise,1,TI-1,HH,North,Pump,95.5,90,°C,,',
        '2001-09-09T01:46:40.000Z,unacknowledged,shelve,1,TI-9,HH,,,95.5,90,,\'=kim,"a, ""b"""',
        '2001-09-09T01:46:40.000Z,unacknowledged,raise,1,TI-1,HH,North,Pump,95.5,90,bar,,', '']);
});

test('yesterday is from midnight to midnight in the plant\'s zone, also on a day of 23 hours', () => {
    const us = (text) => Date.parse(text) * 1000;
    const yesterday = (now, zone) => journalSpan('yesterday', us(now), zone);
    assert.deepEqual(yesterday('2026-11-26T10:00Z', 'Asia/Seoul'), [us('2026-11-24T15:00Z'), us('2026-11-25T15:00Z')]);
    assert.deepEqual(yesterday('2026-03-30T10:00Z', 'Europe/Berlin'), [us('2026-03-28T23:00Z'), us('2026-03-29T22:00Z')]);
    assert.deepEqual(journalSpan('today', us('2026-11-26T10:00Z'), 'UTC'), [us('2026-11-26T00:00Z'), null]);
    assert.deepEqual(journalSpan('shift', 9 * 3600e6, 'UTC'), [3600e6, null]);
});

test('a journal that had too many rows opens again without rows', async () => {
    await Promise.all([learnWords(), learnWords('alarms')]);
    const { document } = globalThis, node = () => ({ selectedOptions: [{ text: '' }], value: '', replaceChildren() {} });
    globalThis.document = { getElementById: node };
    try {
        const shown = [], list = { open: true, journalOpen: true, applied: [], filter: { words: '' },
            showApplied: (...counts) => shown.push(counts) };
        const journal = Object.assign(Object.create(Journal.prototype), { list, span: node(), more: node(), note: node(), older: node(),
            table: { sorted: (rows) => rows, fill: () => [] }, shown: 200, rows: [{}], cut: true, failed: 'no answer',
            session: { model: { plant: { time_zone: 'UTC' } }, clockUs: () => 0 } });
        journal.rest();
        journal.show();
        assert.deepEqual([shown[0][1], journal.older.hidden], [0, true]);
        assert.doesNotMatch(journal.note.textContent, /no answer/);
    } finally {
        globalThis.document = document;
    }
});
