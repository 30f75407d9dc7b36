// SPDX-License-Identifier: GPL-3.0-or-later
// Labels of the toolbar's tools. They also show whether values are frozen at a past instant.
import { say } from '../../core/words.js';
import { byId } from '../common/dom.js';

export class Tools {
    constructor({ session }) {
        this.session = session;
        for (const name of ['time', 'welcome'])
            session.on(name, () => this.show());
        this.show();
    }

    show() {
        const { time, recorded } = this.session, button = byId('hold'), held = time.atUs !== null;
        button.disabled = !recorded;
        button.querySelector('use').setAttribute('href', held ? '#i-play' : '#i-pause');
        const words = say(held ? 'bar.go' : recorded ? 'bar.hold' : 'bar.unrecorded');
        button.title = words;
        button.setAttribute('aria-label', words);
    }
}
