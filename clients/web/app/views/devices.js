// SPDX-License-Identifier: GPL-3.0-or-later
// Lists paired wall displays, for engineers: pairing a display by the code that it shows, and revoking a pairing.
import { dateTime, zoneClock } from '../../core/format.js';
import { askInTime, loaderOf } from '../../core/http.js';
import { refusalText } from '../../core/refusals.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';

export class Devices {
    constructor({ session, tell }) {
        Object.assign(this, { session, tell });
        this.list = make('ul', { id: 'devices-list' });
        this.digits = make('input', { id: 'devices-digits', inputmode: 'numeric', maxlength: 7, autocomplete: 'off',
            placeholder: '123 456', 'aria-label': say('devices.digits') });
        this.note = make('p', { class: 'note', id: 'devices-note' });
        const form = make('form', { class: 'line', onsubmit: (event) => this.pair(event) },
            make('span', {}, say('devices.digits')), this.digits, make('button', { type: 'submit' }, say('devices.pair')));
        this.element = make('fieldset', { id: 'devices', hidden: true }, make('legend', {}, say('devices.legend')), this.list,
            this.note, form);
        byId('views').append(this.element);
        // Loads the list of displays.
        this.learn = loaderOf(session, async () => (session.role === 'engineer' ? askInTime('api/v1/devices', {}, session.token) : {}),
            (answer, error) => this.take(answer, error));
        session.on('welcome', () => this.learn());
        session.on('paired', ({ kept, why, refusal }) => (kept ? this.learn() : tell(refusalText(why, refusal))));
        this.learn();
    }

    // Shows the list of displays. There is none if displays need no token, or if the user is not an engineer. If the request failed, keeps
    // the previous list and shows the error.
    take(answer, error) {
        setText(this.note, error ? say('devices.unread', { why: error.message }) : '');
        const list = answer?.list;
        this.element.hidden = !list && !error;
        if (error)
            return;
        this.list.replaceChildren(...(list ?? []).map((device) => this.rowOf(device)));
    }

    rowOf({ id, by: who, time_us: us, ...place }) {
        const time = dateTime(zoneClock(this.session.model.plant.time_zone), us / 1000);
        return make('li', { 'data-id': id }, make('span', {}, say('devices.is', { ...place, who, time })),
            make('button', { type: 'button', onclick: () => this.post({ type: 'unpair', id }) }, say('devices.revoke')));
    }

    pair(event) {
        event.preventDefault();
        const digits = this.digits.value.replace(/\s/g, '');
        if (/^\d{6}$/.test(digits)) {
            this.post({ type: 'pair', digits });
            this.digits.value = '';
        }
    }

    post(message) {
        const { session } = this;
        if (!session.welcomed || !session.connection.send({ seq: ++session.toldSeq, ...message }))
            this.tell(say('reason.unreachable')); // tells the user that the pairing was not revoked
    }
}
