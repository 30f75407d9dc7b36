// SPDX-License-Identifier: GPL-3.0-or-later
const REPORTED = /WARNING: ThreadSanitizer|ERROR: \w*Sanitizer|runtime error:/;

// Returns a description of a failure of the program that tests may have missed: it ended although mayEnd is false, or a
// sanitizer reported an error. Returns null if there is none.
export function faultOf(name, { exitCode, signalCode }, said, mayEnd) {
    const fell = !mayEnd && (exitCode !== null || signalCode !== null);
    if (!fell && !REPORTED.test(said))
        return null;
    const from = said.search(REPORTED), words = from < 0 ? said.slice(-1000) : said.slice(from, from + 1000);
    return `${name}${fell ? ` ended by itself: ${signalCode ?? exitCode}` : ''}: ${words}`;
}
