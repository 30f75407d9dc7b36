// SPDX-License-Identifier: GPL-3.0-or-later
// Opens short links.
import { ask } from '../../core/http.js';
import { stored } from '../common/storage.js';

const ANSWER_MS = 3000; // milliseconds to wait for the server; without an answer, the page starts without the linked view

// Asks the server for a short link's view, replaces the link in the page's URL with the view, and returns a promise of the view.
export async function expand(id, token, fetcher) {
    const { view } = await (await ask('api/v1/link', { id }, token, fetcher)).json();
    history.replaceState(null, '', `${location.pathname}${location.search}#${view}`);
    return view;
}

// Opens the short link in the page's address. Returns a promise of { short (the link's id), expanded (its view; null: it could not be
// opened) }. arrival.js tries again when the user has signed in, and says why it fails.
export async function openShort() {
    const short = location.hash.slice('#v='.length), signal = AbortSignal.timeout(ANSWER_MS);
    const fetcher = (path, init) => fetch(path, { ...init, signal });
    return { short, expanded: await expand(short, stored('token'), fetcher).catch(() => null) };
}
