// SPDX-License-Identifier: GPL-3.0-or-later
// Looks up the page's texts in the user's language. Each language has a file of texts that are needed immediately, and one for parts that
// are loaded later.
import { chooseLanguage, phrase, readWords } from './phrases.js';

const reader = globalThis.document ? chooseLanguage(location.search, navigator.languages) : chooseLanguage();
const tableOf = async (name, tries = 0) => readWords((await import(`../words/${name}.js${tries > 0 ? `?again=${tries}` : ''}`)).default);
const words = await tableOf(reader.language);
const rules = new Intl.PluralRules(reader.language);

export const { language, locale } = reader;
export const say = (key, values) => phrase(words, rules, key, values);

// Loads a further file of texts, by its name. Returns a promise, which rejects if the file cannot be fetched.
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

// Returns a text with its first letter in upper case.
export const title = (text) => text.charAt(0).toUpperCase() + text.slice(1);

// Returns the text for a key if there is one, else `otherwise`.
export const sayIfKnown = (key, otherwise) => (words[key] === undefined ? otherwise : say(key));
