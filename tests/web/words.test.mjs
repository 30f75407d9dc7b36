// SPDX-License-Identifier: GPL-3.0-or-later
// The words of the page: the same keys in every language, none missing, none for nothing, and how one language is chosen.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { chooseLanguage, LANGUAGES, phrase, readWords, say, sayIfKnown } from '../../clients/web/core/words.js';

const WEB = new URL('../../clients/web/', import.meta.url);
const tables = Object.fromEntries(await Promise.all(LANGUAGES.map(async (language) =>
    [language, readWords((await import(`../../clients/web/words/${language}.js`)).default)])));
const source = ['core', 'app'].flatMap((folder) => readdirSync(new URL(folder, WEB)).filter((name) => name.endsWith('.js'))
    .map((name) => readFileSync(new URL(`${folder}/${name}`, WEB), 'utf8'))).join('\n');
const html = readdirSync(new URL('app', WEB)).filter((name) => name.endsWith('.html')).map((name) => `app/${name}`);
const page = ['index.html', ...html].map((name) => readFileSync(new URL(name, WEB), 'utf8')).join('\n');

const blanks = (entry) => [...new Set((typeof entry === 'string' ? entry : entry.other).match(/\{\w+\}|\[[^\]]+\]/g) ?? [])].sort();

test('every language has every key, with the same things to put in', () => {
    for (const language of LANGUAGES) {
        assert.deepEqual(Object.keys(tables[language]), Object.keys(tables.en), language);
        for (const [key, entry] of Object.entries(tables[language])) {
            assert.deepEqual(blanks(entry), blanks(tables.en[key]), `${language}: ${key}`);
            assert.ok(typeof entry === 'string' ? entry.trim() : entry.other.trim(), `${language}: ${key} says nothing`);
        }
    }
});

test('a file of words: sections, plurals, and lines that say nothing', () => {
    assert.deepEqual(readWords('a: x:\n    y\n\n[b]\nc d.e: {n}\nf(one): 1 f\nf(other): {count} f\n'),
        { a: 'x: y', 'b.c d.e': '{n}', 'b.f': { one: '1 f', other: '{count} f' } });
    for (const bad of ['a', 'a:', '[b', 'f(): x', 'a: '])
        assert.throws(() => readWords(bad), /no words: /, bad);
});

test('no key is said twice in a language', () => {
    for (const language of LANGUAGES) {
        const lines = readFileSync(new URL(`words/${language}.js`, WEB), 'utf8').match(/^[\w. ]+(\(\w+\))?: /gm);
        const said = Object.values(tables[language]).flatMap((entry) => (typeof entry === 'string' ? [entry] : Object.values(entry)));
        assert.equal(lines.length, said.length, language);
    }
});

test('plurals: each form that a language has, and no other', () => {
    for (const language of LANGUAGES) {
        const { pluralCategories } = new Intl.PluralRules(language).resolvedOptions();
        for (const [key, entry] of Object.entries(tables[language]).filter(([, one]) => typeof one !== 'string'))
            assert.deepEqual(Object.keys(entry).sort(), [...pluralCategories].sort(), `${language}: ${key}`);
    }
});

// Named whole, or by its beginning where the rest is a value: `kind.${kind}`, choices('side', 'top', ...).
test('no key is unused', () => {
    const starts = [...source.matchAll(/`([a-z]+\.)\$\{/g)].map(([, start]) => start);
    const families = [...source.matchAll(/(?:choices|explained)\('(\w+)', ([^)]*)\)/g)].flatMap(([, kind, values]) =>
        [...values.matchAll(/'(\w+)'/g)].flatMap(([, value]) => [`${kind}.${value}`, `${kind}.${value}.why`]));
    const unused = Object.keys(tables.en).filter((key) => !source.includes(`'${key}'`) && !page.includes(`"${key}"`) &&
        !families.includes(key) && !starts.some((start) => key.startsWith(start)));
    assert.deepEqual(unused, []);
});

test('no key that is asked for is missing', () => {
    const asked = [...source.matchAll(/\bsay\((?:[^'()]*\? )?'([^']+)'(?: : '([^']+)')?/g)].flatMap(([, ...keys]) => keys);
    asked.push(...[...page.matchAll(/data-(?:say|label|title|hint|name)="([^"]+)"/g)].map(([, key]) => key));
    const missing = asked.filter((key) => key && tables.en[key] === undefined);
    assert.deepEqual(missing, []);
    assert.ok(asked.length > 150, `${asked.length} were found`);
});

test('the page itself says nothing in any language', () => {
    const body = page.slice(page.indexOf('<body>')).replace(/<!--.*?-->/gs, '');
    const text = [...body.matchAll(/>([^<>]*\p{L}{2,}[^<>]*)</gu)].map(([, said]) => said.trim());
    assert.deepEqual(text, ['Plantcast']);
    assert.deepEqual([...body.matchAll(/ (?:title|placeholder|aria-label)="[^"]+"/g)].map(([all]) => all), []);
});

test('the language: asked for in the address, else preferred, else English', () => {
    const choose = (...from) => Object.values(chooseLanguage(...from));
    assert.deepEqual(choose('?lang=ko', ['de-AT']), ['ko', 'ko']);
    assert.deepEqual(choose('', ['fr', 'de-AT', 'en']), ['de', 'de-AT']);
    assert.deepEqual(choose('?lang=xx', ['fr-CH']), ['en', 'en']);
    assert.deepEqual(choose('?lang=%00', ['en-GB']), ['en', 'en-GB']);
    assert.deepEqual(choose('?lang=de-%7B'), ['de', 'de'], 'a region that is none');
    assert.deepEqual(choose(), ['en', 'en']);
});

test('plural, things put in, unknown keys', () => {
    const rules = new Intl.PluralRules('en');
    const table = { a: { one: '{count} pump', other: '{count} pumps' }, b: '{x} and {y}' };
    assert.deepEqual([1, 2, 0].map((count) => phrase(table, rules, 'a', { count })), ['1 pump', '2 pumps', '0 pumps']);
    assert.equal(phrase(table, rules, 'b', { x: '{y}', y: '$&' }), '{y} and $&', 'what is put in is not read again');
    assert.throws(() => phrase(table, rules, 'c'), /no words for c/);
    assert.equal(say('alarms.some', { count: 1 }), '1 active alarm');
    assert.equal(sayIfKnown('quantity.taste', 'Taste'), 'Taste');
});
