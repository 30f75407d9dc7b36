// SPDX-License-Identifier: GPL-3.0-or-later
// A page that was kept from another version of the server loads itself anew; where https allows, it can be installed.
import { store, stored } from './common/storage.js';

const versionIn = (text) => text.match(/version = '(\w+)'/)?.[1];
const fetched = (options) => fetch('made/version.js', options).then((answer) => (answer.ok ? answer.text() : ''), () => '');
const ours = fetched({}).then(versionIn); // undefined: built without

// Asked with each greeting, and with each part that is loaded later: the server may be another one meanwhile. True: the page goes, once
// for each version, whatever comes back. key: under which that is kept, of a page that holds others.
export async function renewIfOld(key = 'renewed') {
    const mine = await ours, version = versionIn(await fetched({ cache: 'no-store' }));
    if (!mine || !version || version === mine || stored(key) === version || !store(key, version))
        return false;
    location.reload();
    return true;
}

// On plain http a page has no service worker, and needs none.
export function serveInstalled() {
    if (location.protocol === 'https:')
        navigator.serviceWorker?.register('service.js').catch((error) => console.warn(`not installed: ${error.message}`));
}
