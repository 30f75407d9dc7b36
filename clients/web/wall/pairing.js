// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs a display with the server: shows a code, which an engineer enters on another machine, or takes a token that a user types here. The
// display's secret is generated here and stored for this wall and display.
import { make, setText } from '../app/common/dom.js';
import { say } from '../core/words.js';

const ASK_MS = 2000, SECRET_BYTES = 32;
// HTTP status of the pairing request -> text shown instead of the code
const WHY = { 200: 'walls.asks', 400: 'walls.nowhere', 503: 'walls.crowded' };

export class Pairing {
    // place: { wall, display }. enter(secret) tries to connect with the display's secret, or with a token that a user typed.
    constructor({ element, place, enter }) {
        Object.assign(this, { element, place, enter, key: `plantcast.wall.${place.wall}.${place.display}`, asking: 0 });
        this.digits = make('p', { class: 'digits' });
        this.field = make('input', { type: 'password', autocomplete: 'off', 'aria-label': say('walls.token') });
        this.said = make('p', {}, say('walls.denied'));
        this.left = make('p', {});
        const name = make('p', {}, say('walls.place', place));
        const typing = make('details', {}, make('summary', {}, say('walls.token')), this.field,
            make('button', { type: 'submit' }, say('walls.enter')));
        element.replaceChildren(this.said, this.digits, this.left, name, typing);
        element.addEventListener('submit', (event) => {
            event.preventDefault();
            this.typed(this.field.value.trim());
        });
    }

    // The stored secret to connect with: the token that a user typed for the whole machine, else this display's own secret; null: neither.
    get kept() {
        return localStorage.getItem('plantcast.wall') ?? localStorage.getItem(this.key);
    }

    typed(token) {
        localStorage.setItem('plantcast.wall', token);
        this.field.value = '';
        this.enter(token);
    }

    // Shows the code and asks the server until an engineer has paired the display. A typed token is deleted, because the server
    // has refused it. The display's own secret stays, because the display may be paired again.
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
        setText(this.left, '');
    }

    async ask(turn) {
        let answer = {}, status = 0;
        try {
            const reply = await fetch(`api/v1/pair?${new URLSearchParams(this.place)}`,
                { headers: { Authorization: `Pairing ${this.secret}` }, signal: AbortSignal.timeout(5 * ASK_MS) });
            ({ status } = reply);
            answer = reply.ok ? await reply.json() : {};
        } catch {
            // retried at the next poll
        }
        if (turn !== this.asking)
            return;
        const { paired, digits = '', left_s: left = 0 } = answer;
        setText(this.digits, digits.replace(/^.../, '$& '));
        setText(this.left, digits && say('walls.left', { time: `${Math.floor(left / 60)}:${String(left % 60).padStart(2, '0')}` }));
        setText(this.said, say(digits ? 'walls.digits' : WHY[status] ?? 'walls.denied', this.place));
        if (paired)
            this.enter(this.secret);
        setTimeout(() => turn === this.asking && this.ask(turn), ASK_MS);
    }
}
