// SPDX-License-Identifier: GPL-3.0-or-later
// Sends GET requests to the server, and repeats requests that fail.
import { answerText } from './refusals.js';
import { say } from './words.js';

// UNANSWERED_MS: timeout of askInTime() in milliseconds; RETRY_MS: delay before loaderOf() repeats a failed request
const UNANSWERED_MS = 60000, RETRY_MS = 5000;

// Sends a GET request for a path with a query, and with the user's token if there is one. Returns a promise of the response.
export async function ask(path, query, token, fetcher = fetch) {
    const headers = token ? { Authorization: `Bearer ${token}` } : {};
    const text = new URLSearchParams(query).toString();
    const response = await fetcher(`${path}?${text}`, { headers }).catch(() => {
        throw new Error(say('reason.unreachable'));
    });
    if (!response.ok)
        throw new Error(await answerText(response));
    return response;
}

// Like ask(), but returns a promise of the response's contents, and gives up after UNANSWERED_MS: without a network, a request may stay
// unanswered for many minutes. as: type of the contents, json or blob.
export async function askInTime(path, query, token, as = 'json') {
    const abort = new AbortController(), timer = setTimeout(() => abort.abort(), UNANSWERED_MS);
    try {
        return await (await ask(path, query, token, (url, more) => fetch(url, { ...more, signal: abort.signal })))[as]();
    } catch (error) {
        throw abort.signal.aborted ? new Error(say('reason.unreachable')) : error;
    } finally {
        clearTimeout(timer);
    }
}

// Returns a function that requests something from the server: read() returns a promise of the answer. Calls take(answer, null), or
// take(null, error), and repeats a failed request while the session is connected. Drops the answer if a later call has begun.
export function loaderOf(session, read, take) {
    let latest = 0, retry;
    return async function load() {
        const number = ++latest;
        clearTimeout(retry);
        const [answer, error] = await read().then((answered) => [answered, null], (why) => [null, why]);
        if (number !== latest)
            return;
        if (error)
            retry = setTimeout(() => session.welcomed && load(), RETRY_MS);
        take(answer, error);
    };
}
