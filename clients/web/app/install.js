// SPDX-License-Identifier: GPL-3.0-or-later
// A page that was kept from another version of the server loads itself anew; where https allows, it can be installed.

const KEY = 'plantcast.renewed';

// Asked with each greeting: the server may have been another one meanwhile.
export function renewIfOld(session) {
    const ours = import('../made/version.js').then(({ version }) => version, () => null); // null: built without
    session.on('welcome', async () => {
        const mine = await ours, theirs = await fetch('made/version.js', { cache: 'no-store' })
            .then((answer) => (answer.ok ? answer.text() : ''), () => '');
        const version = theirs.match(/version = '(\w+)'/)?.[1];
        if (mine && version && version !== mine)
            renew(version);
    });
}

// Once for each version, whatever comes back.
function renew(version) {
    try {
        if (sessionStorage.getItem(KEY) === version)
            return;
        sessionStorage.setItem(KEY, version);
    } catch {
        return; // nothing can be kept: it would go on for ever
    }
    location.reload();
}

// On plain http a page has no service worker, and needs none.
export function serveInstalled() {
    if (location.protocol === 'https:')
        navigator.serviceWorker?.register('service.js').catch((error) => console.warn(`not installed: ${error.message}`));
}
