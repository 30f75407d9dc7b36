// SPDX-License-Identifier: GPL-3.0-or-later
// Dark and light theme.
import { styled } from './dom.js';
import { stored } from './storage.js';

export function wear(theme) {
    document.documentElement.dataset.theme = theme;
    if (theme === 'dark')
        // ignores errors: a style sheet that failed to load is requested again at the next theme change
        styled('common/dark').catch(() => {});
    return theme;
}

// Sets the theme: from ?theme=dark or ?theme=light in the URL, else the stored theme. Returns the theme.
export function chooseTheme(query) {
    return wear((query.get('theme') ?? stored('theme')) === 'dark' ? 'dark' : 'light');
}
