// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the page's language, parses the files of its texts and fills values into texts. Loads no file itself, because the fleet page uses
// this module too.

export const LANGUAGES = ['en', 'ko', 'de'];

// Returns { language, locale }: from ?lang=, else from the browser's preferences, else English. The locale is the browser's own if it
// belongs to that language.
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
        return null; // not a valid language tag
    }
}

// Parses a file of texts into a table: key to text with {names}, or to { one, other, ... } by the plural form of `count`. [section] is a
// prefix of the keys that follow; an indented line continues the text before it.
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
