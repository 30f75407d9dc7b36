// SPDX-License-Identifier: GPL-3.0-or-later
// Dark or light.
import { styled } from './dom.js';
import { store, stored } from './stored.js';

function wear(theme) {
    document.documentElement.dataset.theme = theme;
    if (theme === 'dark')
        styled('dark').catch(() => {}); // its sheet is asked for again with the next change
}

// ?theme=dark or light, else as it was left.
export function chooseTheme(query) {
    wear((query.get('theme') ?? stored('theme')) === 'dark' ? 'dark' : 'light');
}

export function changeTheme() {
    const theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    wear(theme);
    store('theme', theme);
}
