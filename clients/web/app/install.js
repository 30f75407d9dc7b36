// SPDX-License-Identifier: GPL-3.0-or-later
// Reloads a page that was cached from another version of the server; registers the service worker where https allows installing.
import { store, stored } from './common/storage.js';

const versionIn = (text) => text.match(/version = '(\w+)'/)?.[1];
const fetched = (options) => fetch('made/version.js', options).then((answer) => (answer.ok ? answer.text() : ''), () => '');
const ours = fetched({}).then(versionIn); // undefined: built without a version

// Compares versions at each greeting and each late-loaded part, because the server may have been replaced. Returns true if the page
// reloads; it does so once per version. key: storage name, another one for pages that contain others.
export async function renewIfOld(key = 'renewed') {
    const mine = await ours, version = versionIn(await fetched({ cache: 'no-store' }));
    if (!mine || !version || version === mine || stored(key) === version || !store(key, version))
        return false;
    location.reload();
    return true;
}

// Registers the service worker; plain http does not allow one.
export function serveInstalled() {
    if (location.protocol === 'https:')
        navigator.serviceWorker?.register('service.js').catch((error) => console.warn(`not installed: ${error.message}`));
}
