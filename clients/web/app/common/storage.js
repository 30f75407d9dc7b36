// SPDX-License-Identifier: GPL-3.0-or-later
// Values stored in this browser. If the browser refuses storage, they are lost on a reload of the page.

const KEYS = { theme: 'localStorage', token: 'sessionStorage', renewed: 'sessionStorage', accepted: 'sessionStorage',
    // values in localStorage are permanent, those in sessionStorage last until the tab closes
    renewedWall: 'sessionStorage', desk: 'localStorage', alarmsWidth: 'localStorage', wall: 'localStorage' };

export function stored(name) {
    try {
        return globalThis[KEYS[name]].getItem(`plantcast.${name}`);
    } catch {
        return null;
    }
}

// Stores a text. Returns true if the browser stored it.
export function store(name, text) {
    try {
        globalThis[KEYS[name]].setItem(`plantcast.${name}`, text);
        return true;
    } catch {
        return false;
    }
}
