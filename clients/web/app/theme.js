// SPDX-License-Identifier: GPL-3.0-or-later
// Dark or light.
import { styled } from './dom.js';
import { store, stored } from './stored.js';

function wear(theme) {
    document.documentElement.dataset.theme = theme;
    if (theme === 'dark')
        styled('dark').catch(() => {}); // its sheet is asked for again with the next change
    return theme;
}

// ?theme=dark or light, else as it was left; returns which.
export function chooseTheme(query) {
    return wear((query.get('theme') ?? stored('theme')) === 'dark' ? 'dark' : 'light');
}

// Returns which it is now.
export function changeTheme() {
    const theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    store('theme', theme);
    return wear(theme);
}
