// SPDX-License-Identifier: GPL-3.0-or-later
// Reloads a page that was cached from another version of the server; registers the service worker if https allows installing.
import { store, stored } from './common/storage.js';

const versionIn = (text) => text.match(/version = '(\w+)'/)?.[1];
const fetched = (options) => fetch('made/version.js', options).then((answer) => (answer.ok ? answer.text() : ''), () => '');
const ours = fetched({}).then(versionIn); // undefined: built without a version

// Compares the version of the page with that of the server, which may have been replaced. Called at each greeting and when a part is loaded
// late. Returns true if the page reloads, which it does once per version. key: name under which the version is stored; pages that contain
// other pages use another one.
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
