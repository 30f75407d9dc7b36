// SPDX-License-Identifier: GPL-3.0-or-later
// Reloads a page that the browser has cached from another version of the server. Registers the service worker, which lets users
// install the page, if the page came over https.
import { store, stored } from './common/storage.js';

const versionIn = (text) => text.match(/version = '(\w+)'/)?.[1];
const fetched = (options) => fetch('made/version.js', options).then((answer) => (answer.ok ? answer.text() : ''), () => '');
// promise of the version of the server from which this page was loaded; its value is undefined if that server's build has no
// version
const ours = fetched({}).then(versionIn);

// Compares the version of the page with that of the server, which may have been updated. Called at each `welcome` of the server and when a
// module is loaded late. Returns true if the page reloads, which it does once per version. key: name under which the version is stored;
// pages that contain other pages use another key.
export async function renewIfOld(key = 'renewed') {
    const mine = await ours, version = versionIn(await fetched({ cache: 'no-store' }));
    if (!mine || !version || version === mine || stored(key) === version || !store(key, version))
        return false;
    location.reload();
    return true;
}

// Registers the service worker; browsers allow none over plain http.
export function serveInstalled() {
    if (location.protocol === 'https:')
        navigator.serviceWorker?.register('service.js').catch((error) => console.warn(`not installed: ${error.message}`));
}
