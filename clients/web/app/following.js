// SPDX-License-Identifier: GPL-3.0-or-later
// The view of another: it keeps its shape, and says whose it is.
import { say } from '../core/words.js';
import { byId, setText } from './dom.js';

export class Following {
    constructor({ session }) {
        this.session = session;
        window.addEventListener('resize', () => this.shape());
        session.on('following', () => this.show());
        byId('following').querySelector('button').addEventListener('click', () => session.follow(null));
        this.show();
    }

    show() {
        const { following } = this.session;
        this.shape();
        byId('following').hidden = !following;
        setText(byId('following').querySelector('span'), following ? say('following.title', following) : '');
    }

    shape() {
        const { style, classList } = byId('viewport'), { following } = this.session;
        style.width = style.height = '';
        classList.toggle('following-another', Boolean(following));
        if (!following)
            return;
        const box = byId('viewport').parentElement.getBoundingClientRect(), ratio = following.width / following.height;
        const free = box.right - Math.max(box.left, byId('assets').getBoundingClientRect().right);
        const width = Math.min(free, box.height * ratio);
        style.width = `${width}px`;
        style.height = `${width / ratio}px`;
    }
}
