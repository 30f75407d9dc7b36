// SPDX-License-Identifier: GPL-3.0-or-later
// What is kept in this browser. It may forbid that: nothing is then known the next time.

const KEYS = { theme: 'localStorage', token: 'sessionStorage', renewed: 'sessionStorage', accepted: 'sessionStorage',
    renewedWall: 'sessionStorage', desk: 'localStorage', wall: 'localStorage' }; // for good, or as long as this tab lives

export function stored(name) {
    try {
        return globalThis[KEYS[name]].getItem(`plantcast.${name}`);
    } catch {
        return null;
    }
}

// Whether it is kept.
export function store(name, text) {
    try {
        globalThis[KEYS[name]].setItem(`plantcast.${name}`, text);
        return true;
    } catch {
        return false;
    }
}
