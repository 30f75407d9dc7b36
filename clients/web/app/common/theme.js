// SPDX-License-Identifier: GPL-3.0-or-later
// Dark and light theme.
import { styled } from './dom.js';
import { stored } from './storage.js';

export function wear(theme) {
    document.documentElement.dataset.theme = theme;
    if (theme === 'dark')
        // ignored: a style sheet that failed to load is requested again the next time that the theme changes
        styled('common/dark').catch(() => {});
    return theme;
}

// Chooses ?theme=dark or light, else the stored theme. Returns the theme.
export function chooseTheme(query) {
    return wear((query.get('theme') ?? stored('theme')) === 'dark' ? 'dark' : 'light');
}
