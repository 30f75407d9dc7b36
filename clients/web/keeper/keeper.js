// SPDX-License-Identifier: GPL-3.0-or-later
// Reloads a page whose main thread hangs. As a frame of that page, it waits for a message of the page's worker
// (app/common/watchdog_worker.js) and then opens itself in place of the page: a navigation to the page itself would go to the process that
// hangs. Opened so, it goes back to the page's address, for which Chromium starts another process.
'use strict';

const RETRY_MS = 5000; // while the server does not answer: an error page of the browser would not come back
const ENDED_MS = 2000;

// Calls f once the server answers.
function whenServed(f) {
    fetch(location.pathname, { mode: 'no-cors', cache: 'no-store' }).then(f, () => setTimeout(whenServed, RETRY_MS, f));
}

if (parent === window) {
    const page = new URL(decodeURIComponent(location.hash.slice(1)), location.href);
    const open = () => location.replace(page.href);
    if (page.origin === location.origin)
        whenServed(() => setTimeout(() => { // until the process that hung has ended
            open();
            setInterval(open, RETRY_MS);
        }, ENDED_MS));
} else {
    addEventListener('message', ({ data, ports: [worker] }) => {
        worker.onmessage = () => whenServed(() => {
            top.location.replace(`${location.pathname}#${encodeURIComponent(data)}`);
        });
    });
    parent.postMessage('kept', '*');
}
