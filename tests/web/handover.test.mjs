// SPDX-License-Identifier: GPL-3.0-or-later
// The shift handover report, made from the alarm journal: alarms are counted and sorted, and the journal is read to its end,
// page by page.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { hearAlarms, readJournal, sortJournal } from '../../clients/web/core/handover.js';
import { Model } from '../../clients/web/core/model.js';

const row = (id, event, more = {}) => ({ id, event, tag: 'TI-1', kind: 'H', priority: 2, time_us: id * 10, ...more });

test('alarms are counted by tag and kind, and users\' actions are in order', () => {
    const { raised, acknowledged, shelved, aside } = sortJournal([row(5, 'raise'), row(4, 'clear'), row(3, 'acknowledge'), row(1, 'raise'),
        row(6, 'raise', { tag: 'TI-2', priority: 1 }), row(8, 'shelve'), row(7, 'unshelve'), row(9, 'out_of_service')]);
    assert.deepEqual(raised.map(({ tag, count, first, last }) => [tag, count, first, last]), [['TI-1', 2, 10, 50], ['TI-2', 1, 60, 60]]);
    assert.deepEqual([acknowledged, shelved, aside].map((rows) => rows.map(({ id }) => id)), [[3], [7, 8], [9]]);
});

test('one alarm of a tag, and one action on it, count once', () => {
    const { raised, acknowledged } = sortJournal([row(1, 'raise'), row(2, 'raise', { kind: 'HH', priority: 1, value: 97, limit: 90 }),
        row(3, 'acknowledge', { who: 'kim', reason: '' }), row(4, 'acknowledge', { kind: 'HH', who: 'kim', reason: '' }),
        row(5, 'acknowledge', { tag: 'TI-2', who: 'kim', reason: '' }), row(6, 'clear', { kind: 'HH' }), row(7, 'clear'), row(8, 'raise')]);
    assert.deepEqual(raised.map(({ tag, kinds, count, priority, last }) => [tag, kinds, count, priority, last]),
        [['TI-1', ['H', 'HH'], 2, 1, 80]]);
    assert.deepEqual(acknowledged.map(({ tag, kinds }) => [tag, kinds]), [['TI-1', ['H', 'HH']], ['TI-2', ['H']]]);
});

test('active alarms equal the page\'s: one for each tag, the most urgent', () => {
    const model = new Model({ plant: {}, groups: [], colormaps: [], assets: [], tags: ['TI-1', 'TI-2'].map((name) => ({ name })) });
    const alarm = (tag, kind, state, priority) => ({ tag, kind, state, priority, raised_us: 1, value: 1, limit: 1, active: true,
        held: false, until_us: null, who: '', reason: '' });
    hearAlarms(model, { mode: 'local', alarms: [alarm('TI-1', 'H', 'unacknowledged', 3), alarm('TI-1', 'HH', 'unacknowledged', 2),
        alarm('TI-2', 'L', 'returned', 3), alarm('TI-9', 'L', 'active', 1), alarm('plc1', 'LINK', 'acknowledged', 1)] });
    assert.deepEqual(model.alarms.list().map(({ tag, kind }) => [tag.name, kind]), [['TI-1', 'HH'], ['plc1', 'LINK'], ['TI-2', 'L']]);
    const { active, waiting } = model.alarms.counts();
    assert.deepEqual([active, waiting], [2, 2]);
});

test('the journal is read page by page, up to a limit', async () => {
    const asked = [];
    const get = async (query) => {
        asked.push(query.before ?? null);
        return { rows: [row(1, 'raise')], next_before: asked.length < 5 ? 100 - asked.length : null };
    };
    const whole = await readJournal(get, '-8h', 'now');
    assert.deepEqual([whole.rows.length, whole.cut, asked], [5, false, [null, 99, 98, 97, 96]]);
    asked.length = 0;
    const part = await readJournal(get, '-8h', 'now', 2);
    assert.deepEqual([part.rows.length, part.cut], [2, true]);
});

test('a journal whose later page cannot be read is incomplete; without its first page there is none', async () => {
    const broken = async () => { throw new Error('disk full'); };
    const get = (query) => (query.before ? broken() : Promise.resolve({ rows: [row(1, 'raise')], next_before: 7 }));
    const { rows, cut, failed } = await readJournal(get, '-8h', 'now');
    assert.deepEqual([rows.length, cut, failed], [1, true, 'disk full']);
    await assert.rejects(readJournal(broken, '-8h', 'now'), /disk full/);
});
