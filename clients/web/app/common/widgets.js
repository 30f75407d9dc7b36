// SPDX-License-Identifier: GPL-3.0-or-later
// Small pieces that panels, cards and dialogs are made of.
import { say } from '../../core/words.js';
import { icon, make } from './dom.js';

// Its children from now on; null is none.
export const fill = (element, ...children) => element.replaceChildren(...children.filter((child) => child !== null));

// A text with one {name} left to be a node.
export function around(text, node) {
    const [before, after] = text.split('\u0000');
    return [before, node, after];
}

export const closeButton = (key, onclick) =>
    make('button', { type: 'button', class: 'icon small', 'aria-label': say(key), onclick }, icon('i-close'));
