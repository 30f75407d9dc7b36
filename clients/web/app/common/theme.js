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

// Sets the theme: with forced colours that of the operating system, because pictures and charts are drawn in the theme's colours, over the
// system's background; otherwise from ?theme=dark or ?theme=light in the URL, else the stored theme. Returns the theme.
export function chooseTheme(query) {
    const has = (feature) => Boolean(globalThis.matchMedia?.(feature).matches);
    if (has('(forced-colors: active)'))
        return wear(has('(prefers-color-scheme: dark)') ? 'dark' : 'light');
    return wear((query.get('theme') ?? stored('theme')) === 'dark' ? 'dark' : 'light');
}
