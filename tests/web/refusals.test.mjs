// SPDX-License-Identifier: GPL-3.0-or-later
// What the server refuses is said in the words of the page; each of them as the server's own source has it.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { refusalText } from '../../clients/web/core/refusals.js';

test('refusals in our words', () => {
    const said = {
        'to place or prove sensors takes the role engineer, not viewer': 'that takes the role engineer',
        'TI-9: that place is farther from E-101 than it is large': 'TI-9: that place is too far from E-101',
        'moves: TI-9: that place is farther from E-101 than it is large': 'TI-9: that place is too far from E-101',
        'the list as it is cannot be kept as tags.csv.2: Permission denied':
            'the daemon may not write into the folder of the tag list (tags.csv.2)',
        'tags.csv cannot be written: Read-only file system':
            'the daemon may not write into the folder of the tag list (tags.csv)',
        'tags.csv was changed by somebody else meanwhile': 'tags.csv was changed by somebody else meanwhile',
        'seq: frame 7 was never sent': 'seq: frame 7 was never sent',
    };
    for (const [text, want] of Object.entries(said))
        assert.equal(refusalText(text), want);
});

test('the server still says what is known here', () => {
    const folder = new URL('../../server/', import.meta.url);
    const source = readdirSync(folder, { recursive: true }).filter((name) => name.endsWith('.c'))
        .map((name) => readFileSync(new URL(name, folder), 'utf8')).join('\n');
    for (const text of [
        'takes the role', 'alarms are another system\'s here', 'the plant is being loaded anew; try again',
        'there is nothing to acknowledge',
        'the value is beyond the tolerance',
        'the reading is not good', 'said to have failed',
        '%s: that place is farther from %s than it is large', '%s belongs to no group',
        'another list is being put in force; look again in a moment', 'cannot be kept as %s.%d: %s', '%s cannot be written: %s',
        '%s was changed by somebody else meanwhile'
    ])
        assert.ok(source.includes(text), text);
});
