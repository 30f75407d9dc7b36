// SPDX-License-Identifier: GPL-3.0-or-later
// Of an installed page, by https only: the page's own files from the network, and where there is none as they last were, so that it opens
// and says that it is disconnected. Nothing that the plant says is ever kept.
const KEPT = 'plantcast';
const OURS = /^(\/|\/index\.html|\/(app|core|words|vendor|made)\/.*)$/;

self.addEventListener('install', () => self.skipWaiting());
self.addEventListener('activate', (event) => event.waitUntil(self.clients.claim()));
self.addEventListener('fetch', (event) => {
    const url = new URL(event.request.url);
    if (event.request.method === 'GET' && url.origin === location.origin && OURS.test(url.pathname))
        event.respondWith(newest(event.request));
});

async function newest(request) {
    const kept = await caches.open(KEPT);
    try {
        const answer = await fetch(request);
        if (answer.status === 200)
            await kept.put(request, answer.clone());
        return answer;
    } catch (error) {
        const before = await kept.match(request, { ignoreSearch: true });
        if (before)
            return before;
        throw error;
    }
}
