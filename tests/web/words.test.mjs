// SPDX-License-Identifier: GPL-3.0-or-later
// The texts of the page: every language must have the same keys, none may be missing or unused, and each must be in the right
// file. Also tests how a language is chosen.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { chooseLanguage, LANGUAGES, phrase, readWords } from '../../clients/web/core/phrases.js';
import { say, sayIfKnown } from '../../clients/web/core/words.js';
import { filesIn, graph } from './modules.mjs';

const WEB = new URL('../../clients/web/', import.meta.url);
const read = (...names) => names.map((name) => readFileSync(new URL(name, WEB), 'utf8')).join('\n');
// Files with the texts of a language: those needed at the start, of lazily loaded parts, of alarms, of the import page, of the
// watchdog, and of headsets.
const filesOf = (language) => ['', 'lazy.', 'alarms.', 'import.', 'watchdog.', 'xr.'].map((part) => `words/${part}${language}.js`);
const tableOf = async (file) => readWords((await import(`../../clients/web/${file}`)).default);
const tables = Object.fromEntries(await Promise.all(LANGUAGES.map(async (language) =>
    [language, Object.assign({}, ...await Promise.all(filesOf(language).map(tableOf)))])));
const source = read(...['core', 'app', 'wall', 'handover'].flatMap(filesIn).filter((name) => name.endsWith('.js')));
const html = filesIn('app').filter((name) => name.endsWith('.html'));
const page = read('index.html', ...html);

const blanks = (entry) => [...new Set((typeof entry === 'string' ? entry : entry.other).match(/\{\w+\}|\[[^\]]+\]/g) ?? [])].sort();

test('every language has every text key, with the same placeholders', () => {
    for (const language of LANGUAGES) {
        assert.deepEqual(Object.keys(tables[language]), Object.keys(tables.en), language);
        for (const [key, entry] of Object.entries(tables[language])) {
            assert.deepEqual(blanks(entry), blanks(tables.en[key]), `${language}: placeholders of ${key}`);
            assert.ok(typeof entry === 'string' ? entry.trim() : entry.other.trim(), `${language}: the text of ${key} is empty`);
        }
    }
});

test('word files are parsed with sections and plurals, and faulty lines are refused', () => {
    assert.deepEqual(readWords('a: x:\n    y\n\n[b]\nc d.e: {n}\nf(one): 1 f\nf(other): {count} f\n'),
        { a: 'x: y', 'b.c d.e': '{n}', 'b.f': { one: '1 f', other: '{count} f' } });
    for (const bad of ['a', 'a:', '[b', 'f(): x', 'a: '])
        assert.throws(() => readWords(bad), /no words: /, bad);
});

test('texts of the server and the fleet page: every language has each key with the same placeholders, and each is used', async () => {
    const sources = (folder) => readdirSync(new URL(folder, WEB)).filter((name) => /\.(c|h|js)$/.test(name))
        .map((name) => read(`${folder}${name}`));
    const inC = (prefix) => (key) => new RegExp(`\\b${prefix}${key.toUpperCase()}\\b`);
    const subjects = [['overlay', inC('WORD_'), ['../../server/render/overlay/', '../video/']], ['video', inC('VIDEO_'), ['../video/']],
        ['fleet', (key) => new RegExp(`'${key}'`), ['../fleet/']]];
    for (const [name, use, folders] of subjects) {
        const texts = folders.flatMap(sources).join('\n'), [english, ...others] = await Promise.all(LANGUAGES.map((language) =>
            tableOf(`words/${name}.${language}.js`)));
        const values = (text) => text.match(/\{\w*\}/g)?.sort() ?? [];
        for (const table of others) {
            assert.deepEqual(Object.keys(table), Object.keys(english), name);
            for (const [key, text] of Object.entries(table))
                assert.deepEqual(values(text), values(english[key]), `${name}: ${key}: ${text}`);
        }
        assert.deepEqual(Object.keys(english).filter((key) => !/^(?:look|interpolation|distance)_/.test(key) && !use(key).test(texts)), [],
            `${name}: unused texts`);
    }
});

test('no text key occurs twice in a language', () => {
    for (const language of LANGUAGES) {
        const lines = read(...filesOf(language)).match(/^[\w. ]+(\(\w+\))?: /gm);
        const said = Object.values(tables[language]).flatMap((entry) => (typeof entry === 'string' ? [entry] : Object.values(entry)));
        assert.equal(lines.length, said.length, language);
    }
});

test('each text has the plural forms of its language, and no others', () => {
    for (const language of LANGUAGES) {
        const { pluralCategories } = new Intl.PluralRules(language).resolvedOptions();
        for (const [key, entry] of Object.entries(tables[language]).filter(([, one]) => typeof one !== 'string'))
            assert.deepEqual(Object.keys(entry).sort(), [...pluralCategories].sort(), `${language}: plural forms of ${key}`);
    }
});

// Returns the keys of `table` that the modules and the markup do not use. A key is used if its whole name occurs, or its
// beginning followed by a value: `kind.${kind}`, choices('side', 'top', ...).
function unused(table, modules, markup) {
    const starts = [...modules.matchAll(/`([a-z]+\.)\$\{/g)].map(([, start]) => start);
    const families = [...modules.matchAll(/(?:choices|explained)\('(\w+)', ([^)]*)\)/g)].flatMap(([, kind, values]) =>
        [...values.matchAll(/'(\w+)'/g)].flatMap(([, value]) => [`${kind}.${value}`, `${kind}.${value}.why`]));
    return Object.keys(table).filter((key) => !modules.includes(`'${key}'`) && !markup.includes(`="${key}"`) &&
        !families.includes(key) && !starts.some((start) => key.startsWith(start)));
}

function asked(modules, markup) {
    const said = [...modules.matchAll(/\bsay\((?:[^'()]*\? )?'([^']+)'(?: : '([^']+)')?/g)].flatMap(([, ...keys]) => keys);
    return [...said, ...[...markup.matchAll(/data-(?:say|label|title|hint|name)="([^"]+)"/g)].map(([, key]) => key)].filter(Boolean);
}

test('no text key is unused', () => assert.deepEqual(unused(tables.en, source, page), []));

test('no requested text key is missing', () => {
    const all = asked(source, page);
    assert.deepEqual(all.filter((key) => tables.en[key] === undefined), []);
    assert.ok(all.length > 150, `only ${all.length} text keys were found`);
});

test('texts shown before the first part is loaded are in the first file, and no others', async () => {
    const wordless = [...read('app/lazy_modules.js')
        .matchAll(/^    \w+: \{ file: '([^']+)'.*wordless: true/gm)].map(([, file]) => `app/${file}.js`);
    const paths = new Set(['app/main.js', ...wordless].flatMap((path) => [...graph(path)]));
    const first = await tableOf(filesOf('en')[0]), modules = read(...paths);
    const all = asked(modules, read('index.html'));
    assert.deepEqual(all.filter((key) => first[key] === undefined), []);
    assert.ok(all.length > 70, `only ${all.length} text keys were found`);
    assert.deepEqual(unused(first, modules, read('index.html')), []);
    for (const language of LANGUAGES)
        assert.deepEqual(Object.keys(await tableOf(filesOf(language)[0])), Object.keys(first), language);
});

test('the HTML page itself contains no text in any language', () => {
    const body = page.slice(page.indexOf('<body>')).replace(/<!--.*?-->/gs, '');
    const text = [...body.matchAll(/>([^<>]*\p{L}{2,}[^<>]*)</gu)].map(([, said]) => said.trim());
    assert.deepEqual(text, ['Plantcast']);
    assert.deepEqual([...body.matchAll(/ (?:title|placeholder|aria-label)="[^"]+"/g)].map(([all]) => all), []);
});

test('the language is the address\'s, or else the preferred one, or else English', () => {
    const choose = (...from) => Object.values(chooseLanguage(...from));
    assert.deepEqual(choose('?lang=ko', ['de-AT']), ['ko', 'ko']);
    assert.deepEqual(choose('', ['fr', 'de-AT', 'en']), ['de', 'de-AT']);
    assert.deepEqual(choose('?lang=xx', ['fr-CH']), ['en', 'en']);
    assert.deepEqual(choose('?lang=%00', ['en-GB']), ['en', 'en-GB']);
    assert.deepEqual(choose('?lang=de-%7B'), ['de', 'de'], 'an invalid region is ignored');
    assert.deepEqual(choose(), ['en', 'en']);
});

test('plurals and placeholders are filled in, and unknown keys are reported', () => {
    const rules = new Intl.PluralRules('en');
    const table = { a: { one: '{count} pump', other: '{count} pumps' }, b: '{x} and {y}' };
    assert.deepEqual([1, 2, 0].map((count) => phrase(table, rules, 'a', { count })), ['1 pump', '2 pumps', '0 pumps']);
    assert.equal(phrase(table, rules, 'b', { x: '{y}', y: '$&' }), '{y} and $&', 'inserted text is not parsed again');
    assert.throws(() => phrase(table, rules, 'c'), /no words for c/);
    assert.equal(say('alarms.some', { count: 1 }), '1 active alarm');
    assert.equal(sayIfKnown('quantity.taste', 'Taste'), 'Taste');
});
