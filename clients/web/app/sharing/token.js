// SPDX-License-Identifier: GPL-3.0-or-later
// Asks the user for an access token if the server requires one, and stores it until the tab closes.
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
        // reopens the dialog when Escape closes it, because nothing can be shown without a token
        dialog.addEventListener('close', () => {
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

    // code: the server's refusal code.
    async ask(code) {
        const dialog = byId('token'), field = byId('token-text');
        if (code === 'locked') {
            this.session.token = null;
            store('token', '');
            new BroadcastChannel('plantcast').postMessage('locked'); // locks the handover page too
        }
        setText(byId('token-why'), say({ bad_token: 'token.bad', locked: 'token.locked' }[code] ?? 'token.needed'));
        field.value = '';
        const nothing = { sign_in: null, notice: null }, late = new Promise((done) => setTimeout(done, 3000, nothing));
        // asks the server how users can sign in; without the stored token, because the server would reject a wrong one
        const me = await Promise.race([whoAmI({ token: null }).catch(() => nothing), late]);
        if (!document.body.classList.contains('denied')) // does not ask for a token if another tab has obtained access in the meantime
            return;
        this.showNotice(me.notice);
        if (!dialog.open)
            dialog.showModal();
        field.focus();
        this.offerSignIn(me.sign_in);
    }

    // Shows the site's notice (a legal text, for example), which all users see before they sign in.
    showNotice(text) {
        byId('token').querySelector('.notice')?.remove();
        if (text)
            byId('token-title').after(make('p', { class: 'notice' }, text));
    }

    // If the server has an identity provider, offers to sign in there first; entering a token is then the exception.
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
