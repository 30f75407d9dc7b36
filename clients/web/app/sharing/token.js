// SPDX-License-Identifier: GPL-3.0-or-later
// Asks for a token where the server wants one, and keeps it as long as this tab lives.
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';
import { around } from '../common/widgets.js';
import { store } from '../common/storage.js';
import { signInButton, whoAmI } from './account.js';

export class TokenDialog {
    constructor({ session }) {
        const dialog = byId('token'), field = byId('token-text');
        this.session = session;
        const command = make('code', {}, 'plantcast token add');
        byId('token-note').replaceChildren(...around(say('token.note', { command: '\u0000' }), command));
        session.on('welcome', () => dialog.close());
        dialog.addEventListener('close', () => { // by Escape: there is nothing to see without it
            if (session.connection.state === 'barred')
                dialog.showModal();
        });
        byId('token-form').addEventListener('submit', (event) => {
            event.preventDefault();
            session.token = field.value.trim();
            store('token', session.token);
            dialog.close();
            session.connection.retryNow();
        });
    }

    // code: of what the server refused.
    async ask(code) {
        const dialog = byId('token'), field = byId('token-text');
        if (code === 'locked') {
            this.session.token = null;
            store('token', '');
            new BroadcastChannel('plantcast').postMessage('locked'); // to the handover
        }
        setText(byId('token-why'), say({ bad_token: 'token.bad', locked: 'token.locked' }[code] ?? 'token.needed'));
        field.value = '';
        const nothing = { sign_in: null, notice: null }, late = new Promise((done) => setTimeout(done, 3000, nothing));
        const me = await Promise.race([whoAmI({ token: null }).catch(() => nothing), late]);
        if (!document.body.classList.contains('denied')) // let in meanwhile, from another tab
            return;
        this.showNotice(me.notice);
        if (!dialog.open)
            dialog.showModal();
        field.focus();
        this.offerSignIn(me.sign_in);
    }

    // What the site wants everybody to have read.
    showNotice(text) {
        byId('token').querySelector('.notice')?.remove();
        if (text)
            byId('token-title').after(make('p', { class: 'notice' }, text));
    }

    // Where people sign in, a token is the exception. Without a token: a wrong one would not be told.
    offerSignIn(label) {
        byId('token').querySelector('.sign-in')?.remove();
        if (!label)
            return;
        const button = signInButton(label);
        setText(byId('token-title'), say('account.title'));
        byId('token-text').placeholder = say('token.title');
        byId('token-why').after(button);
        button.focus();
    }
}
