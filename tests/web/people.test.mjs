// SPDX-License-Identifier: GPL-3.0-or-later
// Labels on the page for the users of other sessions.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { followerNames, leaderName } from '../../clients/web/core/people.js';
import { learnWords } from '../../clients/web/core/words.js';

test('followers are labelled with their user names; equal names and viewers without a name are numbered', async () => {
    await learnWords();
    assert.deepEqual(followerNames({ sessions: [7, 8, 9, 10, 11], names: ['kim', null, 'lee', 'kim', null] }),
        ['kim 1', 'Viewer 1', 'lee', 'kim 2', 'Viewer 2']);
    assert.deepEqual(followerNames({ sessions: [7], names: [] }), ['Viewer']);
    assert.deepEqual([leaderName({ who: 'kim' }), leaderName({})], ['kim', 'another user']);
});
