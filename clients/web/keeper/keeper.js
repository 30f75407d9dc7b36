// SPDX-License-Identifier: GPL-3.0-or-later
// Reloads a page whose main thread hangs. Runs as a frame of that page and waits for a message of its worker
// (app/common/watchdog_worker.js), then navigates to itself in place of the page, because a navigation to the page would go to the hanging
// process. From there it returns to the page's URL, for which Chromium starts another process.
'use strict';

const RETRY_MS = 5000; // retry while the server does not answer: the browser's error page could not return
const ENDED_MS = 2000;

// Calls f once the server answers.
function whenServed(f) {
    fetch(location.pathname, { mode: 'no-cors', cache: 'no-store' }).then(f, () => setTimeout(whenServed, RETRY_MS, f));
}

if (parent === window) {
    const page = new URL(decodeURIComponent(location.hash.slice(1)), location.href);
    const open = () => location.replace(page.href);
    if (page.origin === location.origin)
        whenServed(() => setTimeout(() => { // waits until the hanging process has ended
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
