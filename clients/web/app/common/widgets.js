// SPDX-License-Identifier: GPL-3.0-or-later
// Helpers for panels, cards and dialogs, for example to replace an element's children and to make a close button.
import { say } from '../../core/words.js';
import { icon, make } from './dom.js';

// Replaces the children of an element; null children are skipped.
export const fill = (element, ...children) => element.replaceChildren(...children.filter((child) => child !== null));

// Splits a text at its placeholder and inserts a node there. Returns the parts.
export function around(text, node) {
    const [before, after] = text.split('\u0000');
    return [before, node, after];
}

export const closeButton = (key, onclick) =>
    make('button', { type: 'button', class: 'icon small', 'aria-label': say(key), onclick }, icon('i-close'));
