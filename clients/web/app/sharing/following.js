// SPDX-License-Identifier: GPL-3.0-or-later
// Follows the view of another session, the leader: shows the view in the leader's aspect ratio, and says whose view it is.
import { leaderName } from '../../core/people.js';
import { say } from '../../core/words.js';
import { byId, setText, setVariable } from '../common/dom.js';

const ASK_MS = 3000;

export class Following {
    constructor({ session }) {
        this.session = session;
        session.on('following', () => this.show());
        byId('following').querySelector('button').addEventListener('click', () => session.follow(null));
        setInterval(() => this.ask(), ASK_MS);
        this.show();
    }

    // Asks the server again to follow a session that has ended, because that session may return after a page reload or a server restart.
    ask() {
        const { leader, following } = this.session;
        if (leader !== null && !following)
            this.session.post({ type: 'follow', session: leader });
    }

    title({ following, leader }) {
        if (!following)
            return leader === null ? '' : say('following.awaited');
        return say(following.gone ? 'following.gone' : 'following.title', { who: leaderName(following) });
    }

    show() {
        const { following } = this.session, title = this.title(this.session), another = Boolean(following) && !following.gone;
        byId('viewport').classList.toggle('following-another', another);
        if (another)
            setVariable(byId('viewport'), '--ratio', following.width / following.height);
        byId('following').hidden = title === '';
        setText(byId('following').querySelector('span'), title);
    }
}
