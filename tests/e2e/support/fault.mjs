// SPDX-License-Identifier: GPL-3.0-or-later
const REPORTED = /WARNING: ThreadSanitizer|ERROR: \w*Sanitizer|runtime error:/;

// What went wrong in a program, whatever the tests saw of that: it fell over, though it was not to end, or a sanitizer found
// something; or null.
export function faultOf(name, { exitCode, signalCode }, said, mayEnd) {
    const fell = !mayEnd && (exitCode !== null || signalCode !== null);
    if (!fell && !REPORTED.test(said))
        return null;
    const from = said.search(REPORTED), words = from < 0 ? said.slice(-1000) : said.slice(from, from + 1000);
    return `${name}${fell ? ` ended by itself: ${signalCode ?? exitCode}` : ''}: ${words}`;
}
