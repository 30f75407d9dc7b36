// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the sentences about the standby that the page shows to engineers.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { standbyText } from '../../clients/web/core/standby.js';
import { learnWords } from '../../clients/web/core/words.js';

test('the page is silent while the standby is up to date, and otherwise names files and reason', async () => {
    await learnWords();
    for (const standby of [null, undefined, { connected: true, node: 'c2', files: [] }])
        assert.equal(standbyText(standby), '');
    assert.match(standbyText({ connected: false, files: [] }), /^No standby/);
    const denied = { connected: false, files: [], node: '10.0.0.20', why: 'token' };
    assert.match(standbyText(denied), /^No standby .* refuses .* 10\.0\.0\.20: token$/);
    assert.match(standbyText({ connected: true, node: 'c2', files: ['tags'] }), /c2 .*tag list/);
    const behind = standbyText({ connected: true, node: 'c2', files: ['plant', 'models'], why: 'disk full' });
    assert.match(behind, /c2 .*plant file, models.*: disk full$/);
    assert.match(standbyText({ connected: true, node: 'c2', files: [], why: 'version' }), /c2 cannot take over: version$/);
    const other = { connected: true, node: 'c2', files: [], why: 'version', takes_over: true };
    assert.match(standbyText(other), /c2 can take over, .*: version$/);
});
