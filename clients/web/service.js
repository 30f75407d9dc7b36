// SPDX-License-Identifier: GPL-3.0-or-later
// Of an installed page, by https only: the page's own files from the network, and where there is none as they last were, so that it opens
// and says that it is disconnected. Files of one version are kept at a time: those of another would not fit. Nothing that the plant says is
// ever kept.
const OURS = /^(\/|\/(index|wall)\.html|\/(app|core|words|vendor|made|wall)\/.*)$/;
const PREFIX = 'plantcast-';
let kept = null; // a promise of the store of the version that is shown

self.addEventListener('install', () => self.skipWaiting());
self.addEventListener('activate', (event) => event.waitUntil(self.clients.claim()));
self.addEventListener('fetch', (event) => {
    const url = new URL(event.request.url);
    if (event.request.method === 'GET' && url.origin === location.origin && OURS.test(url.pathname))
        event.respondWith(newest(event.request));
});

// The server's version, and no other is kept; without the server the one that is there. Others of this address have stores of their own.
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
