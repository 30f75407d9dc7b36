// SPDX-License-Identifier: GPL-3.0-or-later
// The account dialog: the user's role on the server, signing in through an identity provider, and signing out.
import { askInTime } from '../../core/http.js';
import { say } from '../../core/words.js';
import { make } from '../common/dom.js';
import { store } from '../common/storage.js';
import { closeButton } from '../common/widgets.js';

// Asks the server who the user is. Returns a promise of { name, role, signed_in, until, sign_in (label of the button to sign
// in) }.
export const whoAmI = (session) => askInTime('api/v1/me', {}, session.token);

// Makes a button that signs in at the identity provider and returns to the current view. It also discards any access token.
export function signInButton(label) {
    const go = () => {
        store('token', '');
        location.assign(`login?to=${encodeURIComponent(location.pathname + location.search + location.hash)}`);
    };
    return make('button', { type: 'button', class: 'sign-in', onclick: go }, say('account.in', { provider: label }));
}

export class Account {
    constructor({ session }) {
        this.session = session;
        this.said = make('div', { class: 'said' });
        this.dialog = make('dialog', { class: 'help ask', id: 'account', 'aria-labelledby': 'account-title' },
            make('h2', { id: 'account-title' }, say('account.title')), closeButton('close', () => this.dialog.close()), this.said);
        this.dialog.addEventListener('click', (event) => event.target === this.dialog && this.dialog.close());
        document.body.append(this.dialog);
    }

    async open() {
        this.dialog.showModal();
        this.said.replaceChildren();
        try {
            this.show(await whoAmI(this.session));
        } catch (error) {
            this.said.replaceChildren(make('p', {}, error.message));
        }
    }

    show({ name, role, signed_in: signedIn, sign_in: signIn }) {
        const unnamed = role === 'engineer' ? 'here' : 'nobody', named = signedIn ? 'person' : 'token';
        const how = `account.${name === null ? unnamed : named}`;
        const parts = [make('p', { class: 'who' }, make('strong', {}, name ?? '–'), ` ${say(`account.${role}`)}`),
            make('p', { class: 'note' }, say(how))];
        if (signedIn)
            parts.push(make('button', { type: 'button', id: 'account-out', onclick: () => this.signOut() }, say('account.out')));
        else if (signIn !== null)
            parts.push(signInButton(signIn));
        this.said.replaceChildren(...parts);
    }

    async signOut() {
        const answer = await fetch('logout', { method: 'POST' }).catch(() => null);
        const { provider = null } = answer?.ok ? await answer.json() : {};
        if (answer?.ok)
            location.assign(provider ?? location.href.split('#')[0]);
        else
            this.said.append(make('p', { role: 'alert' }, say('reason.unreachable')));
    }
}
