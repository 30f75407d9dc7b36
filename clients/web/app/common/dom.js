// SPDX-License-Identifier: GPL-3.0-or-later
// DOM helpers. They never write inline scripts or styles, because the page has a strict content security policy.

import { isGone } from '../../core/alarms.js';
import { say } from '../../core/words.js';

const SVG = 'http://www.w3.org/2000/svg';

export const byId = (id) => document.getElementById(id);

// Makes an element. Example: make('button', { class: 'x', onclick: f, 'aria-label': 'y' }, 'text', node, ...)
export function make(name, attributes = {}, ...children) {
    return furnish(document.createElement(name), attributes, children);
}

export function makeSvg(name, attributes = {}, ...children) {
    return furnish(document.createElementNS(SVG, name), attributes, children);
}

function furnish(element, attributes, children) {
    for (const [name, value] of Object.entries(attributes)) {
        if (typeof value === 'function')
            element.addEventListener(name.slice(2), value);
        else if (value !== null && value !== undefined && value !== false)
            element.setAttribute(name, value === true ? '' : value);
    }
    element.append(...children.filter((child) => child !== null && child !== undefined));
    return element;
}

// Inserts words into the elements below `root`. Attributes of the elements hold the keys of the words: data-say gives the text, data-label
// the aria-label, data-title the title, data-hint placeholder and aria-label, data-name title and aria-label. data-key is the keyboard
// shortcut, which the title shows. data-icon is drawn before the text. In the collapsed toolbar each icon shows its name.
export function sayAll(root) {
    for (const element of root.querySelectorAll('[data-say], [data-label], [data-title], [data-hint], [data-name], [data-icon]')) {
        const { say: text, label, title, hint, name, key, icon: drawn } = element.dataset;
        if (text)
            element.textContent = say(text);
        if (drawn)
            element.prepend(icon(`i-${drawn}`));
        if (element.parentNode.id === 'more')
            element.append(make('span', { class: 'words' }, say(name)));
        if (hint)
            element.placeholder = say(hint);
        if (label ?? hint ?? name)
            element.setAttribute('aria-label', say(label ?? hint ?? name));
        if (title ?? name)
            element.title = say(title ?? name) + (key ? ` (${key})` : '');
    }
}

// Sets a text only if it has changed, so that screen readers do not repeat it and the layout is not recomputed.
export function setText(element, text) {
    if (element.textContent !== text)
        element.textContent = text;
}

// Loads a style sheet of app/ by name. Returns a promise, which rejects if the sheet cannot be fetched.
const sheets = new Map();
export function styled(name) {
    if (!sheets.has(name))
        sheets.set(name, new Promise((done, fail) => {
            const link = make('link', { rel: 'stylesheet', href: new URL(`app/${name}.css`, document.baseURI).href, onload: done });
            link.addEventListener('error', () => {
                sheets.delete(name);
                link.remove();
                fail(new Error(`${name}.css cannot be fetched`));
            });
            document.head.append(link);
        }));
    return sheets.get(name);
}

export const setVariable = (element, name, value) => element.style.setProperty(name, value);

// The symbol of each quality, the same in lists and cards as over the picture (overlay.js).
const GLYPHS = {
    good: ['circle', { r: 4.5 }],
    uncertain: ['path', { d: 'M0-6 6 0 0 6-6 0z' }],
    bad: ['path', { d: 'M-5-5h10v10h-10zM-2.5-2.5l5 5M2.5-2.5l-5 5' }],
    none: ['circle', { r: 2.5 }],
};
export function glyph(quality) {
    const [name, shape] = GLYPHS[quality] ?? GLYPHS.none;
    return makeSvg('svg', { viewBox: '-8 -8 16 16', class: `glyph ${GLYPHS[quality] ? quality : 'none'}`, 'aria-hidden': 'true' },
        makeSvg(name, { class: 'mark', ...shape }));
}

// Returns an element with an alarm's kind in its priority's colour; hollow if the value has returned to normal.
export const limitFlag = ({ kind, priority, state }) =>
    make('span', { class: `limit-flag p${priority}${isGone(state) ? ' hollow' : ''}` }, kind);

// Matches small screens, on which the legend is a strip along the edge and panels are sheets.
export const phone = globalThis.matchMedia?.('(max-width: 719px), (max-width: 1023px) and (max-height: 480px)');

export function icon(id) {
    return makeSvg('svg', { 'aria-hidden': 'true' }, makeSvg('use', { href: `#${id}` }));
}
