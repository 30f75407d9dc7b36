// SPDX-License-Identifier: GPL-3.0-or-later
// The tools of the toolbar: values that stand still, how many look along, and what is folded away on narrow screens.
import { say } from '../core/words.js';
import { byId } from './dom.js';
import { foldPanel } from './fields.js';

const HELD_US = 3.5e6; // what is newer than that counts as now

export class Tools {
    constructor({ session }) {
        this.session = session;
        const { set, toggle } = foldPanel(byId('more'), byId('more-toggle'), () => {});
        byId('more-toggle').addEventListener('click', toggle);
        byId('more').addEventListener('click', () => set(false));
        session.on('time', () => this.show());
        session.on('welcome', () => this.show());
        session.on('followers', () => this.show());
        this.show();
    }

    show() {
        const { time, recorded, followers } = this.session, button = byId('hold'), held = time.atUs !== null;
        button.disabled = !recorded;
        button.querySelector('use').setAttribute('href', held ? '#i-play' : '#i-pause');
        const words = say(held ? 'bar.go' : recorded ? 'bar.hold' : 'bar.unrecorded');
        button.title = words;
        button.setAttribute('aria-label', words);
        byId('share-open').toggleAttribute('data-count', followers.count > 0);
        if (followers.count > 0)
            byId('share-open').dataset.count = followers.count;
    }

    hold() {
        const { session } = this;
        if (session.recorded)
            session.travel(session.time.atUs === null ? session.clockUs() - HELD_US : null);
    }
}
