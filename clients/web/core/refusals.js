// SPDX-License-Identifier: GPL-3.0-or-later
// Texts for refusals of the server in the user's language, by code and arguments. Errors that only a program can cause stay in English.
import { phrase, readWords } from './phrases.js';
import { language } from './words.js';

const words = readWords((await import(`../words/refused.${language}.js`)).default);
export const put = (key, values) => phrase(words, null, key, values);

// Returns the text to show for a refusal. text: the server's English text; refusal: { code, args } or undefined; kind: member `code` of the
// server's message `error`.
export function refusalText(text, refusal, kind) {
    if (words[refusal?.code])
        return put(refusal.code, refusal.args);
    return words[`class.${kind}`] ? put(`class.${kind}`) : put('page.other', { text });
}

// Returns why the server did not apply a tag list. The argument is its message `tags_saved`.
export const whyNotSaved = ({ errors, refusal }) =>
    (refusal ? refusalText('', refusal) : errors.map((text) => refusalText(text)).join('; '));

// Returns a promise of the text to show for an HTTP response that refuses a request.
export async function answerText(answer) {
    const refusal = JSON.parse(answer.headers.get('plantcast-refusal') ?? 'null');
    return refusalText((await answer.text()).trim() || `HTTP ${answer.status}`, refusal);
}
