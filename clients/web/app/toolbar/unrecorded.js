// SPDX-License-Identifier: GPL-3.0-or-later
// A warning in the status bar, for operators and engineers, of what the server does not record because it cannot use a file.
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';

export class Unrecorded {
    constructor() {
        this.names = make('output', {});
        this.element = make('div', { class: 'cell late unrecorded', role: 'status' }, this.names);
        byId('status').querySelector('.clock').after(this.element);
    }

    // unrecorded: names of what is not recorded, as in the server's message `status`; []: all is recorded.
    show(unrecorded) {
        this.element.hidden = unrecorded.length === 0;
        const text = say('unrecorded.title', { what: unrecorded.map((name) => say(`unrecorded.${name}`)).join(', ') });
        setText(this.names, text);
        this.element.title = `${text}. ${say('unrecorded.why')}`; // a narrow status bar truncates the names
    }
}
