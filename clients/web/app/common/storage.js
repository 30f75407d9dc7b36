// SPDX-License-Identifier: GPL-3.0-or-later
// Values stored in this browser. If the browser refuses to store them, a reload of the page loses them.

const KEYS = { theme: 'localStorage', token: 'sessionStorage', renewed: 'sessionStorage', accepted: 'sessionStorage',
    // where each value is stored: localStorage is permanent, sessionStorage lasts until the tab closes
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
