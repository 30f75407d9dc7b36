// SPDX-License-Identifier: GPL-3.0-or-later
// Which alarm a wall shows in large type: the one with the highest priority, and of those the oldest. Equal ones take turns,
// and during an alarm flood none is shown.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { AlarmCall, byEquipment, FLOOD, TURN_MS } from '../../clients/web/core/alarm_call.js';

const NOW_US = 1e15;
const alarm = (index, priority, agoS = 60, more = {}) => ({ tag: { index, name: `T${index}`, asset: 'E-1', position: [0, 0, 0] },
    kind: 'HH', priority, state: 'unacknowledged', waiting: true, raisedUs: NOW_US - agoS * 1e6, ...more });
const shown = (call, alarms, ms) => call.next(alarms, ms, NOW_US)?.tag.index ?? null;

test('a wall shows the most urgent alarm first, then the oldest; each has its turn', () => {
    const call = new AlarmCall(), all = [alarm(1, 2), alarm(2, 1, 10), alarm(3, 1, 90)];
    const seen = [];
    for (let turn = 0; turn < 4; turn++)
        seen.push(shown(call, all, turn * TURN_MS));
    assert.deepEqual(seen, [3, 2, 1, 3]);
});

test('the shown alarm changes only after a full turn', () => {
    const call = new AlarmCall(), first = alarm(1, 3), graver = alarm(2, 1);
    assert.equal(shown(call, [first], 0), 1);
    assert.equal(shown(call, [graver, first], TURN_MS - 1), 1);
    assert.equal(shown(call, [graver, first], TURN_MS), 2);
    let changes = 0;
    for (let ms = 2 * TURN_MS, before = 2; ms < 12 * TURN_MS; ms += 250) {
        const now = shown(call, [graver, first], ms);
        changes += now !== before;
        before = now;
    }
    assert.ok(changes >= 4 && changes <= 10, `the shown alarm changed ${changes} times`);
});

test('an acknowledged alarm or one without a place is not shown; a returned, unacknowledged one comes last', () => {
    const call = new AlarmCall();
    assert.equal(shown(call, [alarm(1, 1, 60, { waiting: false })], 0), null);
    const gone = alarm(2, 1, 60, { state: 'returned' });
    assert.equal(shown(new AlarmCall(), [gone, alarm(1, 3)], 0), 1);
    assert.equal(shown(new AlarmCall(), [gone], 0), 2, 'a returned alarm is shown until it is acknowledged');
    assert.equal(shown(call, [{ ...alarm(1, 1), tag: { index: 1, asset: null, position: null } }], 0), null);
    assert.equal(shown(call, [alarm(1, 1)], 0), 1);
    assert.equal(shown(call, [], 1), null, 'an alarm that no longer exists is not shown');
});

test('in an alarm flood no alarm\'s place is shown, and alarms are counted by equipment', () => {
    const call = new AlarmCall(), many = Array.from({ length: FLOOD + 1 }, (_, i) => alarm(i, i === 4 ? 1 : 2));
    assert.equal(shown(call, many, 0), null);
    assert.equal(shown(call, many.map((one) => ({ ...one, raisedUs: NOW_US - 700e6 })), 0), 4, 'old alarms are no flood');
    many[7].tag.asset = many[4].tag.asset = 'P-1';
    assert.deepEqual(byEquipment(many).map(({ asset, count, worst }) => [asset, count, worst.tag.index]), [['P-1', 2, 4], ['E-1', 9, 0]]);
});
