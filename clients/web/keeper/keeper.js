// SPDX-License-Identifier: GPL-3.0-or-later
// Reloads the page on a video wall when its main thread hangs. This code runs in a frame of that page and waits for a message
// from the page's worker (app/common/watchdog_worker.js). It then makes the top window load keeper.html in place of the page:
// Chromium loads keeper.html in another process, which then loads the page. If the top window loaded the page's own URL at
// once, that would happen in the hanging process.
'use strict';

// milliseconds between attempts while the server does not answer. Loading the page without an answer would end on the browser's
// error page, where this code does not run any more.
const RETRY_MS = 5000;
const ENDED_MS = 2000;

// Calls f once the server answers.
function whenServed(f) {
    fetch(location.pathname, { mode: 'no-cors', cache: 'no-store' }).then(f, () => setTimeout(whenServed, RETRY_MS, f));
}

if (parent === window) {
    const page = new URL(decodeURIComponent(location.hash.slice(1)), location.href);
    const open = () => location.replace(page.href);
    if (page.origin === location.origin)
        whenServed(() => setTimeout(() => { // waits ENDED_MS, until the hanging process has ended
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
