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
        byId('token-form').addEventListener('submit', (event) => {
            event.preventDefault();
            session.token = field.value.trim();
            store('token', session.token);
            dialog.close();
            session.connection.retryNow();
        });
    }

    // code: of what the server refused.
    ask(code) {
        const dialog = byId('token'), field = byId('token-text');
        setText(byId('token-why'), say(code === 'bad_token' ? 'token.bad' : 'token.needed'));
        field.value = '';
        if (!dialog.open)
            dialog.showModal();
        field.focus();
        this.offerSignIn();
    }

    // Where people sign in, a token is the exception. Without a token: a wrong one would not be told.
    async offerSignIn() {
        const { sign_in: label } = await whoAmI({ token: null }).catch(() => ({ sign_in: null }));
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
