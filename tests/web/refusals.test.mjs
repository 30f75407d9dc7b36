// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of refusals: each refusal code has a text in every language with the same arguments, the server sends these arguments
// with the code, and no language uses the English text.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { answerText, refusalText, whyNotSaved } from '../../clients/web/core/refusals.js';
import { LANGUAGES, phrase, readWords } from '../../clients/web/core/phrases.js';

const ROOT = new URL('../../', import.meta.url);
const read = (name) => readFileSync(new URL(name, ROOT), 'utf8');
const tables = Object.fromEntries(await Promise.all(LANGUAGES.map(async (language) =>
    [language, readWords((await import(`../../clients/web/words/refused.${language}.js`)).default)])));
const codes = Object.keys(tables.en).filter((key) => !key.includes('.'));
const blanks = (text) => (text.match(/\{\w+\}/g) ?? []).map((blank) => blank.slice(1, -1)).sort();

// The server's source text, and `refused`: [code, names of the arguments, or null if unknown] for each place where it refuses
// something.
const source = ['server', 'preprocess'].flatMap((folder) => readdirSync(new URL(folder, ROOT), { recursive: true })
    .filter((name) => name.endsWith('.c') && !name.endsWith('base/refusal.c')).map((name) => read(`${folder}/${name}`))).join('\n');
const refused = [...source.matchAll(/\bREFUSAL_([A-Z]\w*)\b(?:,\s*"([^"]*)")?/g)].filter(([, code]) => !/^(?:NONE|TEXT_BYTES)$/.test(code))
    .map(([, code, args]) => [code.toLowerCase(), args?.includes('=') ? args.split('\\n').map((arg) => arg.split('=')[0]).sort() : null]);

test('every language has a text for each refusal code, with the same arguments', () => {
    for (const [language, table] of Object.entries(tables)) {
        assert.deepEqual(Object.keys(table), Object.keys(tables.en));
        for (const [key, text] of Object.entries(table))
            assert.deepEqual(blanks(text), blanks(tables.en[key]), `${language}: ${key}: ${text}`);
    }
});

test('the server uses every refusal code, and provides the arguments of its text', () => {
    assert.deepEqual(codes.filter((code) => !refused.some(([one]) => one === code)), []);
    for (const [code, args] of refused) {
        const wanted = blanks(tables.en[code] ?? assert.fail(`no text for the code ${code}`));
        assert.ok(wanted.length === 0 || args === null || wanted.every((name) => args.includes(name)),
            `${code}: arguments ${args}, the text needs ${wanted}`);
    }
    for (const code of codes.filter((one) => blanks(tables.en[one]).length > 0))
        assert.ok(refused.some(([one, args]) => one === code && args), `the server never gives ${code} its arguments`);
});

test('PROTOCOL.md names every code with its arguments', () => {
    const rows = [...read('protocol/PROTOCOL.md').split('## Refusals')[1].matchAll(/^\| `(\w+)` \| ([^|]*)\| [^|]+ \| [^|]+ \|$/gm)];
    for (const [, code, args] of rows)
        assert.deepEqual((args.match(/\w+/g) ?? []).sort(), blanks(tables.en[code] ?? assert.fail(
            `PROTOCOL.md does not list ${code}`)), code);
    assert.deepEqual(rows.map(([, code]) => code).sort(), [...codes].sort());
});

test('a refusal\'s sentence is formed from code and arguments, whatever the English text says', () => {
    for (const code of codes) {
        const args = Object.fromEntries(blanks(tables.en[code]).map((name) => [name, `<${name}>`]));
        assert.equal(refusalText('reworded', { code, args }, 'bad_field'), phrase(tables.en, null, code, args));
    }
    assert.equal(refusalText('reworded', undefined, 'too_fast'), tables.en['class.too_fast']);
    assert.equal(refusalText('seq: frame 7 was never sent', undefined, 'bad_field'), 'seq: frame 7 was never sent');
    assert.equal(refusalText('of tomorrow', { code: 'tomorrow', args: {} }), 'of tomorrow');
});

test('refusals over HTTP, and of a tag list, are worded in the page\'s language', async () => {
    const refusal = { code: 'no_tag', args: { name: 'Ü-1' } };
    const ascii = JSON.stringify(refusal).replace('Ü', '\\u00dc');
    assert.equal(await answerText(new Response('reworded', { status: 400, headers: { 'plantcast-refusal': ascii } })),
        'this plant has no tag “Ü-1”');
    assert.equal(await answerText(new Response('', { status: 502 })), 'HTTP 502');
    assert.equal(whyNotSaved({ errors: ['reworded'], refusal: { code: 'busy', args: {} } }), tables.en.busy);
    assert.equal(whyNotSaved({ errors: ['tags.csv:2:1: a', 'b'] }), 'tags.csv:2:1: a; b');
});

test('no text for refusals on the page is unused', () => {
    const page = ['core/refusals.js', 'core/blocked.js', 'app/sharing/arrival.js', 'app/alarms/alarms.js', 'app/main.js']
        .map((name) => read(`clients/web/${name}`)).join('\n');
    assert.deepEqual(Object.keys(tables.en).filter((key) => key.startsWith('page.') && !page.includes(`'${key}'`)), []);
    const errors = read('protocol/PROTOCOL.md');
    assert.deepEqual(Object.keys(tables.en).filter((key) => key.startsWith('class.') && !errors.includes(`| \`${key.slice(6)}\` |`)), []);
});
