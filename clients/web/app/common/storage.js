// SPDX-License-Identifier: GPL-3.0-or-later
// Values stored in this browser. The browser may refuse storage; they are then lost on reload.

const KEYS = { theme: 'localStorage', token: 'sessionStorage', renewed: 'sessionStorage', accepted: 'sessionStorage',
    // values in localStorage are permanent, those in sessionStorage last until the tab closes
    renewedWall: 'sessionStorage', desk: 'localStorage', wall: 'localStorage' };

export function stored(name) {
    try {
        return globalThis[KEYS[name]].getItem(`plantcast.${name}`);
    } catch {
        return null;
    }
}

// Returns whether the text was stored.
export function store(name, text) {
    try {
        globalThis[KEYS[name]].setItem(`plantcast.${name}`, text);
        return true;
    } catch {
        return false;
    }
}
