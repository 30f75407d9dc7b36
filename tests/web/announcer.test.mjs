// SPDX-License-Identifier: GPL-3.0-or-later
// The announcer: a live region of the page through which screen readers read out new alarms.
import assert from 'node:assert/strict';
import { mock, test } from 'node:test';
import { Announcer } from '../../clients/web/app/alarms/announcer.js';
import { learnWords, say } from '../../clients/web/core/words.js';
import { mockTimeouts } from './older_node.mjs';

test('in an alarm flood each alarm is announced once, and no text is replaced before it can be read', async () => {
    await learnWords();
    const said = [], region = { set textContent(text) { said.push(text); } };
    const rows = new Map(), session = { model: { readings: [], alarms: { rows } }, time: { atUs: 1 }, now: () => 0, clockUs: () => null };
    const alarm = (n, priority = 3, state = 'unacknowledged') => {
        const row = { id: `${n}/H`, tag: { name: `T-${n}`, index: n }, kind: 'H', state, priority, value: null, limit: null };
        rows.set(row.id, row);
        return row;
    };
    mockTimeouts();
    globalThis.document = { getElementById: () => region };
    try {
        const announcer = new Announcer({ session });
        announcer.take([alarm(0)]);
        for (let n = 1; n < 20; n++)
            announcer.take([alarm(n, n === 7 ? 1 : 3)]);
        assert.equal(said.length, 1, 'only one text while the first is read');
        for (let n = 0; n < 5; n++)
            mock.timers.tick(3000);
        assert.equal(said.length, 2, said.join('\n'));
        assert.match(said[0], /^T-0 /);
        assert.match(said[1], /^T-7 .*; T-1 .*; T-2 .*; .*\b16\b/);
        announcer.take([alarm(20)]);
        assert.match(said[2], /^T-20 /, 'a new alarm is announced at once if no text is being read');
        announcer.take([21, 22, 23, 24, 25].map((n) => alarm(n)));
        alarm(21, 3, 'acknowledged');
        rows.delete('22/H');
        alarm(23, 3, 'returned');
        mock.timers.tick(3000);
        assert.match(said[3], /^T-23 [^;]*; T-24 [^;]*; T-25 [^;]*$/, 'alarms acknowledged or ended meanwhile are left out');
        assert.ok(said[3].includes(say('state.returned')), said[3]);
        announcer.take([alarm(26)]);
        alarm(26, 3, 'acknowledged');
        mock.timers.tick(3000);
        assert.equal(said.length, 4, 'no alarm is left to announce');
    } finally {
        delete globalThis.document;
        mock.timers.reset();
    }
});
