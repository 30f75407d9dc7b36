// SPDX-License-Identifier: GPL-3.0-or-later
// What the server refuses is said in the words of the page; each of them as the server's own source has it.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { refusalText } from '../../clients/web/core/refusals.js';
import { LANGUAGES, readWords } from '../../clients/web/core/words.js';

const WEB = new URL('../../clients/web/', import.meta.url), SERVER = new URL('../../server/', import.meta.url);
const tables = Object.fromEntries(await Promise.all(LANGUAGES.map(async (language) =>
    [language, readWords((await import(`../../clients/web/words/refused.${language}.js`)).default)])));
const source = readdirSync(SERVER, { recursive: true }).filter((name) => name.endsWith('.c'))
    .map((name) => readFileSync(new URL(name, SERVER), 'utf8')).join('\n').replace(/"\s*\n\s*"/g, '');

// What the server says, as its source has it, with things put in; and what a person reads.
const SAID = [
    ['%s takes the role %s, not %s', ['acknowledge', 'operator', 'viewer'], 'that takes the role operator'],
    ['to place or prove sensors takes the role engineer, not %s', ['viewer'], 'that takes the role engineer'],
    ["group: '%s' is no group of this plant", ['heat'], 'this plant has no quantity “heat”'],
    ["selected: '%s' is no asset of this plant", ['E-9'], 'this plant has no equipment “E-9”'],
    ["%s: '%s' is no tag of this plant", ['sensor', 'TT-9'], 'this plant has no tag “TT-9”'],
    ["group: there is no group '%s'", ['heat'], 'this plant has no quantity “heat”'],
    ["tag: there is no tag '%s'", ['TT-9'], 'this plant has no tag “TT-9”'],
    ["moves: there is no asset '%s'", ['E-9'], 'this plant has no equipment “E-9”'],
    ["colormap: '%s' is unknown", ['rainbow'], '“rainbow” is not known here'],
    ["baseline: '%s' is unknown", ['monday'], '“monday” is not known here'],
    ["environment: '%s' is neither 'sky' nor one of this plant's", ['moon'], '“moon” is not known here'],
    ["alarms are another system's here", [], 'alarms are another system’s here'],
    ["alarms are another system's here: nothing can be acknowledged or shelved", [], 'alarms are another system’s here'],
    ['the plant is being loaded anew; try again', [], 'the plant is being loaded anew; try again'],
    ['there is nothing to acknowledge', [], 'there is nothing to acknowledge'],
    ['it is not latched, or still there, or not acknowledged', [], 'it is not latched, or still there, or not acknowledged'],
    ['it is not in a state for that', [], 'its state is another one by now'],
    ['it is so already', [], 'its state is another one by now'],
    ['there is no such alarm', [], 'its state is another one by now'],
    ['a shelf has an end, within a week', [], 'an alarm can be shelved for a week at most'],
    ['the value is beyond the tolerance', [], 'the value is beyond the tolerance'],
    ['the reading is not good', [], 'the reading is not good'],
    ['said to have failed', [], 'said to have failed'],
    ['it could not be kept on disk; the log says why', [], 'not saved: the server cannot write to its disk'],
    ['it could not be kept on disk: the disk is full', [], 'not saved: the server’s disk is full'],
    ['it could not be kept on disk: the disk is read-only', [], 'not saved: the server’s disk is read-only'],
    ['this view is in the plant file, and is changed there', [], 'this view is in the plant file, and is changed there'],
    ['there is no such view', [], 'somebody has removed this view'],
    ['there are as many views as there may be; remove one', [], 'there are as many views as there may be: remove one first'],
    ['tag: %s is computed from others; prove those', ['X-1'], 'X-1 is computed from other tags: prove those'],
    ['%s: that place is farther from %s than it is large', ['TI-9', 'E-101'], 'TI-9: that place is too far from E-101'],
    ['%s belongs to no group', ['TI-9'], 'TI-9 belongs to no group: the tag list has to name one'],
    ['another list is being put in force; look again in a moment', [], 'another list is being put in force'],
    ['save_tags: no sensor has been moved', [], 'no sensor has been moved'],
    ['the tag list could not be read when the plant was loaded', [], 'the tag list could not be read when the plant was loaded'],
    ['cannot be kept as %s.%d: %s', ['tags.csv', 2, 'Permission denied'],
        'the daemon may not write into the folder of the tag list (tags.csv.2)'],
    ['%s cannot be written: %s', ['tags.csv', 'Read-only file system'],
        'the daemon may not write into the folder of the tag list (tags.csv)'],
    ['%s was changed by somebody else meanwhile', ['tags.csv'], 'tags.csv was changed by somebody else meanwhile'],
    ['baseline: %d are kept already; remove one', [16], '16 comparisons are kept already: remove one first'],
    ['isolines: a step of %g makes more than %d lines', [0.1, 64], 'a step of 0.1 makes more than 64 lines'],
    ['%s: at most %d numbers, ascending', ['isolines', 64], 'at most 64 numbers, each larger than the one before'],
    ["scale: 'log' needs a range above 0", [], 'a logarithmic scale needs a range above 0'],
    ['range: [min, max] with min < max', [], 'the range has to begin below its end'],
    ['range: a number from %g to %g expected', ['-1e+12', '1e+12'], 'a number of -1e+12–1e+12 is expected'],
    ['power: expected 0.5..16', [], 'a number of 0.5–16 is expected'],
    ['reach_m: expected more than 0', [], 'a number of > 0 is expected'],
    ['%s: a number from %g to %g expected', ['strength', 0, 100], 'a number of 0–100 is expected'],
    ['sensor: it has no place in the shown group', [], 'that sensor has no place in this quantity'],
    ["interpolation: 'paper' is not prepared where '%s' has one sensor (%zu of %zu assets, first '%s'); ", ['t', 1, 12, 'V-1'],
        'Paper cannot be drawn truly where t has one sensor (1 of 12 assets, the first V-1). ' +
        'The plant file may say “singles: cut” at that group.'],
    ["sensor: distances are not prepared where '%s' has one sensor, as on '%s'; ", ['t', 'V-1'],
        'distances cannot be drawn truly where t has one sensor, as on V-1. The plant file may say “singles: cut” at that group.'],
    ['sensors: one has no place in the shown group', [], 'that sensor has no place in this quantity'],
    ['split: %d pixels are too narrow for two pictures', [30], 'the picture is too narrow for two halves'],
    ['%dx%d cannot be drawn: the server is out of memory; the last picture stays', [4, 2],
        'the server is short of memory; the last picture stays'],
    ['session: %llu is not connected, or is this one', [7], 'session 7 is not connected any more'],
    ['session: %llu does not follow this one', [7], 'session 7 is not connected any more'],
    ["history is the core's, and it does not give it now; try again", [],
        'history is kept by the core, which cannot be reached; try again'],
    ["history cannot be read; the server's log says why", [], 'nothing is recorded here, or it cannot be read'],
    ['this daemon records nothing (history: record: no)', [], 'nothing is recorded here, or it cannot be read'],
];

test('what the server says, in our words', () => {
    for (const [format, values, want] of SAID) {
        assert.ok(source.includes(format), `the server does not say: ${format}`);
        const rest = [...values], text = format.replace(/%(?:llu|zu|[sdg])/g, () => rest.shift());
        assert.equal(refusalText(text), want, text);
        assert.equal(refusalText(`moves: ${text}`), want, text);
    }
});

test('by its code, where there are no words for the text; else the server\'s own', () => {
    assert.equal(refusalText('12 messages of this address within a second: the next are read after it', 'too_fast'), tables.en.too_fast);
    assert.equal(refusalText('seq: frame 7 was never sent', 'bad_field'), 'seq: frame 7 was never sent');
    assert.equal(refusalText('TT-1: it is a bat'), 'TT-1: it is a bat');
});

test('every language has words for all of it, with the same things to put in, and none for nothing', () => {
    const blanks = (text) => (text.match(/\{\w+\}/g) ?? []).sort();
    const used = ['core/refusals.js', 'core/blocked.js', 'app/sharing/arrival.js', 'app/main.js']
        .map((name) => readFileSync(new URL(name, WEB), 'utf8')).join('\n');
    for (const table of Object.values(tables)) {
        assert.deepEqual(Object.keys(table), Object.keys(tables.en));
        for (const [key, text] of Object.entries(table))
            assert.deepEqual(blanks(text), blanks(tables.en[key]), `${key}: ${text}`);
    }
    assert.deepEqual(Object.keys(tables.en).filter((key) => !/^(?:kind|role)\./.test(key) && !used.includes(`'${key}'`)), []);
});
