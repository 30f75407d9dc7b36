// SPDX-License-Identifier: GPL-3.0-or-later
// Service worker of an installed page (https only). It serves the page's files from the network, or else from the cache, so that the page
// opens offline and shows that it is disconnected. Only one version is cached. Plant data is never cached.
const OURS = /^(\/|\/(index|wall)\.html|\/(app|core|words|vendor|made|wall)\/.*)$/;
const PREFIX = 'plantcast-';
let kept = null; // promise of the cache of the server's version; null: not opened yet

self.addEventListener('install', () => self.skipWaiting());
self.addEventListener('activate', (event) => event.waitUntil(self.clients.claim()));
self.addEventListener('fetch', (event) => {
    const url = new URL(event.request.url);
    if (event.request.method === 'GET' && url.origin === location.origin && OURS.test(url.pathname))
        event.respondWith(newest(event.request));
});

// Opens the cache of the server's version and deletes the others; if the server does not answer, opens the one that exists. Other pages of
// this host have caches of their own.
async function choose() {
    const text = await fetch('made/version.js', { cache: 'no-store' }).then((answer) => (answer.ok ? answer.text() : ''), () => '');
    const names = (await caches.keys()).filter((name) => name.startsWith(PREFIX)), version = text.match(/version = '(\w+)'/)?.[1];
    if (!version)
        return caches.open(names.at(-1) ?? PREFIX);
    await Promise.all(names.filter((name) => name !== PREFIX + version).map((name) => caches.delete(name)));
    return caches.open(PREFIX + version);
}

async function newest(request) {
    if (request.mode === 'navigate' || !kept)
        kept = choose();
    const store = await kept;
    try {
        const answer = await fetch(request);
        if (answer.status === 200)
            await store.put(request, answer.clone());
        return answer;
    } catch (error) {
        const before = await store.match(request, { ignoreSearch: true });
        if (before)
            return before;
        throw error;
    }
}
