// SPDX-License-Identifier: GPL-3.0-or-later
// Translates the server's refusals to the reader's language; those that no action of a person causes stay in English.
import { language, phrase, readWords } from './words.js';

const words = readWords((await import(`../words/refused.${language}.js`)).default);
export const put = (key, values) => phrase(words, null, key, values);

// Its words (behind the name of a field), the key of ours, and what to put in.
const KNOWN = [
    [/takes the role (\w+), not \w+$/, 'role', (role) => ({ role: put(`role.${role}`) })],
    [/^'(.*)' is no (group|asset|tag) of this plant/, 'no', (name, kind) => ({ name, kind: put(`kind.${kind}`) })],
    [/^there is no (group|asset|tag) '(.*)'$/, 'no', (kind, name) => ({ name, kind: put(`kind.${kind}`) })],
    [/^'(.*)' is (?:unknown|neither .*)$/, 'unknown', (name) => ({ name })],
    [/^'paper' is not prepared where '(.*)' has one sensor \((\d+) of (\d+) assets, first '(.*)'\)/, 'uncut',
        (group, count, all, asset) => ({ group, count, all, asset })],
    [/^distances are not prepared where '(.*)' has one sensor, as on '(.*)';/, 'far_uncut', (group, asset) => ({ group, asset })],
    [/^alarms are another system's here/, 'elsewhere'],
    [/^the plant is being loaded anew; try again$/, 'anew'],
    [/^there is nothing to acknowledge$/, 'quiet'],
    [/^it is not latched, or still there, or not acknowledged$/, 'latched'],
    [/^(?:it is not in a state for that|it is so already|there is no such alarm)$/, 'otherwise'],
    [/^a shelf has an end, within a week$/, 'shelf'],
    [/^the value is beyond the tolerance$/, 'tolerance'],
    [/^the reading is not good$/, 'reading'],
    [/^said to have failed$/, 'failed'],
    [/^it could not be kept on disk: the disk is full$|: No space left on device$/, 'disk_full'],
    [/^it could not be kept on disk: the disk is read-only$/, 'disk_locked'],
    [/^it could not be kept on disk/, 'disk'],
    [/^this view is in the plant file/, 'fixed'],
    [/^there is no such view$/, 'viewless'],
    [/^no display shows these digits$/, 'digits'],
    [/^too many wrong digits/, 'guesses'],
    [/^there is no such device$/, 'deviceless'],
    [/^there are as many devices/, 'devices'],
    [/^there are as many views as there may be/, 'views'],
    [/^(.+) is computed from others; prove those$/, 'computed', (tag) => ({ tag })],
    [/^(.+): that place is farther from (.+) than it is large$/, 'far', (tag, asset) => ({ tag, asset })],
    [/^(.+) belongs to no group/, 'groupless', (tag) => ({ tag })],
    [/^another list is being put in force; look again in a moment$/, 'busy'],
    [/^no sensor has been moved$/, 'unmoved'],
    [/^the tag list could not be read/, 'unread'],
    [/(\S+)(?: cannot be written)?: (?:Permission denied|Read-only file system)$/, 'locked', (file) => ({ file })],
    [/^(.+) was changed by somebody else meanwhile$/, 'changed', (file) => ({ file })],
    [/^(\d+) are kept already; remove one$/, 'kept', (count) => ({ count })],
    [/^a step of (\S+) makes more than (\d+) lines/, 'lines', (step, count) => ({ step, count })],
    [/^at most (\d+) numbers, ascending/, 'numbers', (count) => ({ count })],
    [/^'log' needs a range above 0/, 'log'],
    [/^\[min, max\] with min < max/, 'range'],
    [/^expected (more than \d+|[\d.]+\.\.[\d.]+)$/, 'between', (span) => ({ span: span.replace('more than', '>').replace('..', '–') })],
    [/a number from (\S+) to (\S+) expected$/, 'between', (low, high) => ({ span: `${low}–${high}` })],
    [/no place in the shown group$/, 'placeless'],
    [/too narrow for two pictures$/, 'narrow'],
    [/out of memory; the last picture stays$/, 'memory'],
    [/^(\d+) (?:is not connected|does not follow this one)/, 'gone', (session) => ({ session })],
    [/^history is the core's/, 'coreless'],
    [/^history cannot be read|^this daemon records nothing/, 'history'],
];
// What has no words of ours, by its code.
const CODES = ['too_fast', 'limit', 'not_allowed', 'core_lost'];
const FIELDS = ['baseline', 'breaks', 'colormap', 'decay', 'environment', 'ghost', 'group', 'hidden', 'interpolation', 'isolate',
    'isolines', 'moves', 'power', 'radius_m', 'range', 'reach_m', 'save_tags', 'scale', 'selected', 'sensor', 'sensors', 'session', 'split',
    'strength', 'tag'];
const FIELD = new RegExp(`^((?:${FIELDS.join('|')}): )+`);

// Returns the text to show for a refusal. code: that of the server, if there is one.
export function refusalText(text, code) {
    const bare = text.replace(FIELD, '');
    for (const [pattern, key, values = () => ({})] of KNOWN) {
        const found = bare.match(pattern);
        if (found)
            return put(key, values(...found.slice(1)));
    }
    return CODES.includes(code) ? put(code) : put('other', { text });
}
