// SPDX-License-Identifier: GPL-3.0-or-later
const REPORTED = /WARNING: ThreadSanitizer|ERROR: \w*Sanitizer|runtime error:/;

// Returns a fault of the program that the tests may not have noticed: it ended although it should not have, or a sanitizer
// reported an error. Otherwise returns null.
export function faultOf(name, { exitCode, signalCode }, said, mayEnd) {
    const fell = !mayEnd && (exitCode !== null || signalCode !== null);
    if (!fell && !REPORTED.test(said))
        return null;
    const from = said.search(REPORTED), words = from < 0 ? said.slice(-1000) : said.slice(from, from + 1000);
    return `${name}${fell ? ` ended by itself: ${signalCode ?? exitCode}` : ''}: ${words}`;
}
