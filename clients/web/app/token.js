// SPDX-License-Identifier: GPL-3.0-or-later
// Asks for a token where the server wants one, and keeps it as long as this tab lives.
import { byId, setText } from './dom.js';

const KEY = 'plantcast.token';

// A browser may forbid storage; the token is then asked for again after a reload.
function stored() {
    try {
        return sessionStorage.getItem(KEY);
    } catch {
        return null;
    }
}

function store(token) {
    try {
        sessionStorage.setItem(KEY, token);
    } catch {
        // see above
    }
}

export class TokenDialog {
    constructor({ session }) {
        const dialog = byId('token'), field = byId('token-text');
        session.token = stored();
        session.on('denied', ({ code }) => {
            setText(byId('token-why'), code === 'bad_token' ? 'This token is not valid, or no longer.' : 'This server asks who you are.');
            field.value = '';
            if (!dialog.open)
                dialog.showModal();
            field.focus();
        });
        session.on('welcome', () => dialog.close());
        byId('token-form').addEventListener('submit', (event) => {
            event.preventDefault();
            session.token = field.value.trim();
            store(session.token);
            dialog.close();
            session.connection.retryNow();
        });
    }
}
