// SPDX-License-Identifier: GPL-3.0-or-later
// Dark or light.
import { styled } from './dom.js';
import { stored } from './storage.js';

export function wear(theme) {
    document.documentElement.dataset.theme = theme;
    if (theme === 'dark')
        styled('common/dark').catch(() => {}); // its sheet is asked for again with the next change
    return theme;
}

// ?theme=dark or light, else as it was left; returns which.
export function chooseTheme(query) {
    return wear((query.get('theme') ?? stored('theme')) === 'dark' ? 'dark' : 'light');
}
