// SPDX-License-Identifier: GPL-3.0-or-later
// The page's list of matches (which equipment each tag belongs to): reading it, filtering it, and recording the user's
// decisions.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Matches, patternOf, readCsv, readMatches, sizeOf, timesOf } from '../../clients/web/core/matches.js';

const FILE = `Tag,Status,Asset,Place,Confidence,Reason,Candidates,Check
TT-1011,sure,E-101,spread,0.97,its name has 'E-101' in it,,s1
TT-2011,likely,P-201,,0.70,"its area, but words",P-201|V-201,l1
TT-2012,likely,P-201,,0.70,its area,P-201,l2
FT-3011,none,,,,loop 301: E-301 or P-301,E-301|P-301,n1
"열교환기/TT ""1""",none,,,,"nothing
in the model",,n2
`;
const read = (placed) => {
    const matches = new Matches(placed);
    matches.set(readMatches(FILE));
    return matches;
};
const tags = (rows) => rows.map(({ tag }) => tag);

test('CSV cells: quotes, commas and line feeds in them, and carriage returns at line ends, are read', () => {
    assert.deepEqual(readCsv('a,"b, ""c""\n"\r\n,\nlast'), [['a', 'b, "c"\n'], ['', ''], ['last']]);
    assert.deepEqual(readCsv(''), []);
    assert.deepEqual(readMatches(''), []);
});

test('candidates: the proposed one is first, and each appears once', () => {
    const { all } = read();
    assert.deepEqual(all.map(({ candidates }) => candidates), [['E-101'], ['P-201', 'V-201'], ['P-201'], ['E-301', 'P-301'], []]);
    assert.equal(all[4].tag, '열교환기/TT "1"');
});

test('filters: a match with several candidates is doubtful until decided; unplaced means equipment without position', () => {
    const matches = read((tag) => tag !== 'TT-1011');
    assert.deepEqual(matches.counts(), { all: 5, sure: 1, likely: 3, none: 1, unplaced: 1 });
    assert.deepEqual(tags(matches.rows('likely', '301 e-')), ['FT-3011']);
    assert.deepEqual(tags(matches.rows('all', 'MODEL')), ['열교환기/TT "1"']);
    matches.decide(matches.all[3], '');
    assert.deepEqual([matches.counts().none, matches.counts().likely], [2, 2], 'a decision for no equipment counts as none');
    matches.decide(matches.all[3], 'P-301');
    assert.deepEqual([matches.counts().sure, matches.counts().likely], [2, 2]);
});

test('accepting a pattern decides its doubtful tags that have a proposal', () => {
    const matches = read(), [sure, first] = matches.all;
    assert.equal(patternOf('10-TT-1012.PV'), '##-TT-####.PV');
    assert.deepEqual(matches.alike(first).map(([{ tag }, asset]) => [tag, asset]), [['TT-2011', 'P-201'], ['TT-2012', 'P-201']]);
    for (const [match, asset] of matches.alike(first))
        matches.decide(match, asset);
    assert.deepEqual(matches.alike(first), []);
    matches.decide(sure, '');
    matches.decide(matches.all[4], 'V-1, "a"');
    assert.equal(matches.text(), 'Tag,Status,Asset\nTT-2011,sure,P-201\nTT-2012,sure,P-201\nTT-1011,none,\n' +
        '"열교환기/TT ""1""",sure,"V-1, ""a"""\n');
    assert.deepEqual(readCsv(matches.text())[4], ['열교환기/TT "1"', 'sure', 'V-1, "a"'], 'a written list is read back unchanged');
    matches.decide(sure, 'E-101');
    assert.equal(matches.decisions.has('TT-1011'), false, 'deciding as the list proposes removes the decision');
    matches.set(matches.all.slice(0, 2));
    assert.deepEqual([...matches.decisions.keys()], ['TT-2011'], 'decisions for removed tags are dropped');
});

test('a decision for one tag extends to tags of its pattern with the same candidate', () => {
    const matches = new Matches();
    matches.set(readMatches('Tag,Status,Asset,Reason,Candidates\nT-1,none,,x,A|B\nT-2,none,,x,A|B\nT-3,none,,x,B|C\nT-44,none,,x,A|B\n'));
    const [first, second] = matches.all;
    assert.deepEqual(matches.alike(second), []);
    matches.decide(first, 'A');
    assert.deepEqual(matches.alike(second).map(([{ tag }, asset]) => [tag, asset]), [['T-2', 'A']]);
});

test('saved decisions are removed, but not those made since', () => {
    const matches = read(), [, first, second, third] = matches.all;
    matches.decide(first, 'P-201');
    matches.decide(second, 'P-201');
    const sent = new Map(matches.decisions);
    matches.decide(second, '');
    matches.decide(third, 'E-301');
    matches.settle(sent);
    assert.deepEqual([...matches.decisions], [['TT-2012', { status: 'none', asset: '' }], ['FT-3011', { status: 'sure', asset: 'E-301' }]]);
});

test('sizes are converted to other units', () => {
    const box = { min: [1, 2, 3], max: [2001, 4002, 6003] };
    assert.deepEqual(sizeOf(box), [2000, 4000, 6000]);
    assert.deepEqual(sizeOf(box, timesOf('m', 'mm')), [2, 4, 6]);
    assert.equal(timesOf('mm', 'm'), 1000);
    assert.equal(timesOf('m', ''), 1);
});
