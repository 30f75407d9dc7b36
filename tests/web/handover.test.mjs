// SPDX-License-Identifier: GPL-3.0-or-later
// The shift handover from the alarm journal: counted, sorted, and read completely.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readJournal, sortJournal } from '../../clients/web/core/handover.js';

const row = (id, event, more = {}) => ({ id, event, tag: 'TI-1', kind: 'H', priority: 2, time_us: id * 10, ...more });

test('alarms are counted by tag and kind, what people did is in its order', () => {
    const { raised, acknowledged, shelved, aside } = sortJournal([row(5, 'raise'), row(4, 'clear'), row(3, 'acknowledge'), row(1, 'raise'),
        row(6, 'raise', { tag: 'TI-2', priority: 1 }), row(8, 'shelve'), row(7, 'unshelve'), row(9, 'out_of_service')]);
    assert.deepEqual(raised.map(({ tag, count, first, last }) => [tag, count, first, last]), [['TI-1', 2, 10, 50], ['TI-2', 1, 60, 60]]);
    assert.deepEqual([acknowledged, shelved, aside].map((rows) => rows.map(({ id }) => id)), [[3], [7, 8], [9]]);
});

test('the journal is read page by page, and no further than there is room', async () => {
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
