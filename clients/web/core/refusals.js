// SPDX-License-Identifier: GPL-3.0-or-later
// What the server refuses, in the reader's language: its own words are English, and stay where they are about what no person does here.
import { say } from './words.js';

// Its words, the key of ours, and what to put in.
const KNOWN = [
    [/takes the role (\w+), not \w+$/, 'role', (role) => ({ role: say(`role.${role}`) })],
    [/^alarms are another system's here/, 'elsewhere'],
    [/^the plant is being loaded anew; try again$/, 'anew'],
    [/^there is nothing to acknowledge$/, 'quiet'],
    [/^the value is beyond the tolerance$/, 'tolerance'],
    [/^the reading is not good$/, 'reading'],
    [/^said to have failed$/, 'failed'],
    [/^(?:moves: )?(.+): that place is farther from (.+) than it is large$/, 'far', (tag, asset) => ({ tag, asset })],
    [/^(?:moves: )?(.+) belongs to no group/, 'groupless', (tag) => ({ tag })],
    [/^another list is being put in force; look again in a moment$/, 'busy'],
    [/(\S+)(?: cannot be written)?: (?:Permission denied|Read-only file system)$/, 'locked', (file) => ({ file })],
    [/^(.+) was changed by somebody else meanwhile$/, 'changed', (file) => ({ file })],
];

export function refusalText(text) {
    for (const [pattern, key, put = () => ({})] of KNOWN) {
        const found = text.match(pattern);
        if (found)
            return say(`said.${key}`, put(...found.slice(1)));
    }
    return text;
}
