// SPDX-License-Identifier: GPL-3.0-or-later
// What of the toolbar is folded away where there is no room for it: the settings of the display, and tools behind a button.
import { byId } from './dom.js';
import { foldPanel } from './fold.js';

export class Folded {
    constructor() {
        const fold = (name) => foldPanel(byId(name), byId(`${name}-toggle`), () => {});
        Object.assign(this, { display: fold('display'), more: fold('more') });
        byId('more').addEventListener('click', () => this.more.set(false));
    }
}
