// SPDX-License-Identifier: GPL-3.0-or-later
// The view of another: it keeps its shape, and says whose it is.
import { say } from '../core/words.js';
import { byId, setText, setVariable } from './dom.js';

export class Following {
    constructor({ session }) {
        this.session = session;
        session.on('following', () => this.show());
        byId('following').querySelector('button').addEventListener('click', () => session.follow(null));
        this.show();
    }

    show() {
        const { following } = this.session;
        byId('viewport').classList.toggle('following-another', Boolean(following));
        if (following)
            setVariable(byId('viewport'), '--ratio', following.width / following.height);
        byId('following').hidden = !following;
        setText(byId('following').querySelector('span'), following ? say('following.title', following) : '');
    }
}
