// SPDX-License-Identifier: GPL-3.0-or-later
// Collapses parts of the toolbar that do not fit: the display settings, and the tools behind a button.
import { byId } from '../common/dom.js';
import { collapsiblePanel } from '../common/collapsible.js';

export class ToolbarOverflow {
    constructor() {
        const fold = (name) => collapsiblePanel(byId(name), byId(`${name}-toggle`), () => {});
        Object.assign(this, { display: fold('display'), more: fold('more') });
        byId('more').addEventListener('click', () => this.more.set(false));
    }
}
