// SPDX-License-Identifier: GPL-3.0-or-later
// Saves a text as a file on the user's machine.
import { make } from './dom.js';

export function saveFile(name, type, text) {
    const url = URL.createObjectURL(new Blob([text], { type: `${type};charset=utf-8` }));
    make('a', { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
}
