// SPDX-License-Identifier: GPL-3.0-or-later
// What the page says, in the language of who reads it: of each language two files beside this folder, of what the page says at once and of
// what its parts say that are loaded later.

export const LANGUAGES = ['en', 'ko', 'de'];

// { language, locale } by ?lang=, else by what the browser prefers, else English. The locale is the reader's own where it is of that
// language.
export function chooseLanguage(search = '', preferred = []) {
    const tags = [new URLSearchParams(search).get('lang'), ...preferred].filter(Boolean);
    const languageOf = (tag) => tag.toLowerCase().split('-')[0];
    const language = tags.map(languageOf).find((name) => LANGUAGES.includes(name)) ?? LANGUAGES[0];
    return { language, locale: known(tags.find((tag) => languageOf(tag) === language)) ?? language };
}

function known(tag) {
    try {
        return Intl.getCanonicalLocales(tag ?? [])[0] ?? null;
    } catch {
        return null; // no tag of a language
    }
}

// Lines of a file of words to a table: key to text with {names} in it, or to { one, other, ... } by the plural of `count`. [section] is
// how the keys of the lines after it begin; a line that is indented goes on with the text before it.
export function readWords(text) {
    const table = {};
    let begin = '';
    for (const line of text.replace(/\n +/g, ' ').split('\n').filter(Boolean)) {
        const [, section] = line.match(/^\[(\w+)\]$/) ?? [], [, key, form, said] = line.match(/^([\w. ]+)(?:\((\w+)\))?: (.+)$/) ?? [];
        if (section)
            begin = `${section}.`;
        else if (!key)
            throw new Error(`no words: ${line}`);
        else
            table[begin + key] = form ? { ...table[begin + key], [form]: said } : said;
    }
    return table;
}

export function phrase(table, plural, key, values = {}) {
    const entry = table[key];
    if (entry === undefined)
        throw new Error(`no words for ${key}`);
    const text = typeof entry === 'string' ? entry : entry[plural.select(values.count)] ?? entry.other;
    return text.replace(/\{(\w+)\}/g, (_, name) => values[name]);
}

const reader = globalThis.document ? chooseLanguage(location.search, navigator.languages) : chooseLanguage();
const tableOf = async (name, tries = 0) => readWords((await import(`../words/${name}.js${tries > 0 ? `?again=${tries}` : ''}`)).default);
const words = await tableOf(reader.language);
const rules = new Intl.PluralRules(reader.language);

export const { language, locale } = reader;
export const say = (key, values) => phrase(words, rules, key, values);

// The words of parts that are loaded later, there from now on; a promise, which fails where they cannot be fetched. name: of their file.
const learnt = new Map();
let failures = 0;
export function learnWords(name = 'lazy') {
    if (!learnt.has(name))
        learnt.set(name, tableOf(`${name}.${language}`, failures).then((more) => Object.assign(words, more), (error) => {
            learnt.delete(name);
            failures++;
            throw error;
        }));
    return learnt.get(name);
}

// Of what has a name of its own that may be known to us: that, else what it is called.
export const sayIfKnown = (key, otherwise) => (words[key] === undefined ? otherwise : say(key));
