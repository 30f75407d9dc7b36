// SPDX-License-Identifier: GPL-3.0-or-later
// A display that is not let in: it shows six digits, which an engineer approves, or takes a token. Its secret is made here, and kept for
// this wall and display.
import { make, setText } from '../app/common/dom.js';
import { say } from '../core/words.js';

const ASK_MS = 2000, SECRET_BYTES = 32;

export class Pairing {
    // place: { wall, display }. enter(secret): tries to be let in with it, or with a token that somebody typed.
    constructor({ element, place, enter }) {
        Object.assign(this, { element, place, enter, key: `plantcast.wall.${place.wall}.${place.display}`, asking: 0 });
        this.digits = make('p', { class: 'digits' });
        this.field = make('input', { type: 'password', autocomplete: 'off', 'aria-label': say('walls.token') });
        this.said = make('p', {}, say('walls.denied'));
        element.replaceChildren(this.said, this.digits, make('details', {}, make('summary', {}, say('walls.token')), this.field,
            make('button', { type: 'submit' }, say('walls.enter'))));
        element.addEventListener('submit', (event) => {
            event.preventDefault();
            this.typed(this.field.value.trim());
        });
    }

    // What was kept for this display, or for all of this machine: NULL if there is nothing.
    get kept() {
        return localStorage.getItem('plantcast.wall') ?? localStorage.getItem(this.key);
    }

    typed(token) {
        localStorage.setItem('plantcast.wall', token);
        this.field.value = '';
        this.enter(token);
    }

    // Asks until it is let in. A token that was turned away is forgotten; its own secret is not, which may be let in again.
    show() {
        if (!this.element.hidden)
            return;
        const bytes = crypto.getRandomValues(new Uint8Array(SECRET_BYTES));
        this.secret = localStorage.getItem(this.key) ?? `pc_${[...bytes].map((byte) => byte.toString(16).padStart(2, '0')).join('')}`;
        localStorage.removeItem('plantcast.wall');
        localStorage.setItem(this.key, this.secret);
        this.element.hidden = false;
        this.ask(++this.asking);
    }

    hide() {
        this.element.hidden = true;
        this.asking++;
        setText(this.digits, '');
    }

    async ask(turn) {
        let answer = {};
        try {
            const reply = await fetch(`api/v1/pair?${new URLSearchParams(this.place)}`,
                { headers: { Authorization: `Pairing ${this.secret}` }, signal: AbortSignal.timeout(5 * ASK_MS) });
            answer = reply.ok ? await reply.json() : {};
        } catch {
            // it is asked again
        }
        if (turn !== this.asking)
            return;
        const { paired, digits = '' } = answer;
        setText(this.digits, digits.replace(/^.../, '$& '));
        setText(this.said, say(digits ? 'walls.digits' : 'walls.denied', this.place));
        if (paired)
            this.enter(this.secret);
        setTimeout(() => turn === this.asking && this.ask(turn), ASK_MS);
    }
}
