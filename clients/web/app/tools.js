// SPDX-License-Identifier: GPL-3.0-or-later
// What the tools of the toolbar say: whether values stand still, and how many look along.
import { say } from '../core/words.js';
import { byId } from './dom.js';

export class Tools {
    constructor({ session }) {
        this.session = session;
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
}
