// SPDX-License-Identifier: GPL-3.0-or-later
// Confirms the assumed positions of many sensors (those chosen on their equipment by `plantcast match`) in one step. A filter
// selects the sensors by equipment, name, distance from the surface and confidence of the match. First, the page counts these
// sensors and marks them on the model. Afterwards, the user can restore the previous tag list.
import { tellAsEngineer } from '../../core/requests.js';
import { whyNotSaved } from '../../core/refusals.js';
import { say } from '../../core/words.js';
import { make, setText } from '../common/dom.js';
import { store, stored } from '../common/storage.js';
import { fill } from '../common/widgets.js';

const ASK_MS = 300; // milliseconds from the last change of the filter to the request

export class Accepting {
    constructor({ session, refresh }) {
        Object.assign(this, { session, refresh });
        this.names = new Set(); // tags that would be accepted
        this.found = null;      // newest message `places_accepted` (the sensors that the filter selects); null: none yet
        this.sent = null;       // pending request that `tags_saved` answers: 'accept' or 'restore'; null: none
        // name of the tag list version from before the last acceptance, which the user can restore; stored, so that it survives
        // a page reload
        this.kept = stored('accepted') || null;
        this.restores = false; // true: the requested `tags_diff` (differences between two tag lists) compares with an earlier version
        this.build();
        session.on('places_accepted', (message) => this.onFound(message));
    }

    build() {
        const input = (key, type, more = {}) => make('input', { type, placeholder: say(key), oninput: () => this.ask(), ...more });
        const named = (key, field) => make('label', {}, say(key), field);
        this.asset = make('select', { onchange: () => this.ask() });
        this.pattern = input('accept.pattern', 'search', { maxlength: 100 });
        this.within = input('accept.within', 'number', { min: 0, step: 'any', placeholder: '–' });
        this.confidence = input('accept.confidence', 'number', { min: 0, max: 1, step: 'any', placeholder: '–' });
        this.count = make('p', { role: 'status' });
        this.refused = make('ul', { class: 'quiet' });
        this.note = make('p', { class: 'accepted', role: 'status' });
        this.go = make('button', { type: 'button', disabled: true, onclick: () => this.accept() });
        this.undo = make('button', { type: 'button', hidden: true, onclick: () => this.restore() });
        this.element = make('details', { class: 'accept', hidden: true, ontoggle: () => this.ask() },
            make('summary', {}, say('accept')), named('accept.asset', this.asset), named('accept.tags', this.pattern),
            make('div', { class: 'line' }, named('accept.within', this.within), named('accept.confidence', this.confidence)),
            this.count, this.refused, make('div', { class: 'line' }, this.go, this.undo), this.note);
    }

    // Shows the filter for the current plant, which may have fewer sensors with an assumed position than before.
    show() {
        const assumed = this.session.model.tags.filter(({ place }) => place === 'equipment'), counts = new Map();
        assumed.forEach(({ asset }) => counts.set(asset, (counts.get(asset) ?? 0) + 1));
        this.element.hidden = assumed.length === 0 && !this.kept;
        const chosen = this.asset.value, shape = JSON.stringify([...counts]);
        if (shape !== this.shape) {
            fill(this.asset, make('option', { value: '' }, say('accept.all', { count: assumed.length })),
                ...[...counts].map(([id, count]) => make('option', { value: id, selected: id === chosen }, `${id} (${count})`)));
            this.shape = shape;
            this.ask();
        }
        this.undo.hidden = !this.kept;
        setText(this.undo, this.kept ? say('accept.undo', { kept: this.kept }) : '');
    }

    get filter() {
        const number = (field) => (field.value === '' ? undefined : field.valueAsNumber);
        return { asset: this.asset.value || undefined, pattern: this.pattern.value.trim() || undefined, within_m: number(this.within),
            confidence: number(this.confidence) };
    }

    ask() {
        clearTimeout(this.timer);
        if (this.sent)
            return; // a request is still running: does nothing now, because end() or onSaved() calls ask() again when it ends
        this.onFound(null);
        if (this.element.open && [this.within, this.confidence].every((field) => field.validity.valid))
            this.timer = setTimeout(() => { this.asked = tellAsEngineer(this.session, 'accept_places', this.filter); }, ASK_MS);
    }

    // Handles `places_accepted`, the list of sensors that the filter selects. The server also sends it after the user has
    // accepted their positions: with the hash of the tag list that the user has seen, if the server is saving the list; with
    // another hash, if the tag list has changed since.
    onFound(message) {
        if (message && message.seq !== this.asked)
            return;
        if (this.sent) {
            if (message.hash !== this.confirmed)
                this.end(say('accept.changed'));
            return;
        }
        this.found = message;
        this.names = new Set(message?.tags);
        const count = message?.count ?? 0;
        setText(this.count, !message ? '' : count > 0 ? say('accept.count', { count }) : say('accept.none'));
        fill(this.refused, ...(message?.refused ?? []).map(({ cause, count: number }) =>
            make('li', {}, say(`accept.${cause}`, { count: number }))));
        setText(this.go, say('accept.go', { count }));
        this.go.disabled = count === 0;
        this.refresh();
    }

    accept() {
        this.accepted = this.found.count;
        this.send('accept', 'accept_places', { ...this.filter, confirm: this.found.hash });
    }

    // Ends a request that has not changed the tag list: shows the text and allows the next request.
    end(text) {
        if (this.sent) {
            this.sent = null;
            setText(this.note, text);
            this.ask();
        }
    }

    restore() {
        this.restores = true;
        tellAsEngineer(this.session, 'restore_tags', { kept: this.kept });
    }

    confirmRestore(hash) {
        this.send('restore', 'restore_tags', { kept: this.kept, confirm: hash });
    }

    send(what, type, fields) {
        clearTimeout(this.timer);
        this.sent = what;
        this.confirmed = fields.confirm;
        this.go.disabled = true;
        setText(this.note, say('eng.saving'));
        this.asked = tellAsEngineer(this.session, type, fields);
        if (!this.asked) // not connected
            this.end('');
    }

    // Handles `tags_saved`, the server's result of saving the tag list. Returns true if this module requested it.
    onSaved(message) {
        const { saved, kept } = message;
        const { sent } = this;
        if (!sent)
            return false;
        this.sent = null;
        this.ask();
        if (!saved)
            setText(this.note, say('eng.unsaved', { text: whyNotSaved(message) }));
        else if (sent === 'accept')
            setText(this.note, say('accept.saved', { count: this.accepted, kept }));
        else
            setText(this.note, say('accept.undone', { kept: this.kept }));
        if (saved) {
            this.kept = sent === 'accept' ? kept : null;
            store('accepted', this.kept ?? '');
        }
        return true;
    }
}
