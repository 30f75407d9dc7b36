// SPDX-License-Identifier: GPL-3.0-or-later
// The card of a point on the plant's surface: its equipment, the value at the point (interpolated between sensors), the sensors
// that contribute to the value, and the uncertainty.
import { numberText, unitText, valueText } from '../../core/format.js';
import { askPick, askPoint, isClickDue, Repeater } from '../../core/requests.js';
import { asAsked } from '../../core/session.js';
import { halves } from '../../core/split_view.js';
import { say } from '../../core/words.js';
import { placeInPicture, standBeside } from './card_position.js';
import { byId, glyph, make } from '../common/dom.js';
import { closeButton, fill } from '../common/widgets.js';

// largest distance in metres between two answers about the same point
const SAME_M = 0.05;
// purposes of requests that the page makes without a choice of the user, and which may replace this card's request
const INCIDENTAL = ['anchor', 'point'];

export class Place {
    // showAsset(how, asset) hides an asset, makes it transparent or isolates it (hides all others). makeRoom() closes panels that leave no
    // room for the card.
    constructor({ session, viewport, overlay, showAsset, makeRoom }) {
        Object.assign(this, { session, viewport, overlay, showAsset, makeRoom });
        this.element = byId('place');
        new ResizeObserver(() => this.show()).observe(this.element);
        this.picked = null;
        // kind of the unanswered pick request. 'new': for the clicked point; 'again': for the card's point; null: none
        this.asked = null;
        this.repeater = new Repeater();
        // true: readings or parameters have changed, but the value was not requested again, because a request of this card or a click is
        // unanswered
        this.isLate = false;
        session.on('picked', (picked) => this.hear(picked));
        session.on('tags', () => this.ask());
        session.on('params', () => this.ask());
        session.on('welcome', () => this.close());
    }

    // Opens the card for the point at (x, y) in CSS pixels of the viewport.
    open(x, y) {
        if (!this.session.picture)
            return;
        this.half = this.session.shown.split && x >= this.viewport.width / 2 ? 1 : 0;
        this.clicked = { pixel: this.viewport.pixelOf(x, y), camera: asAsked(this.session.picture.camera) };
        this.end();
        this.send('new');
    }

    // Ends the wait for an answer.
    end() {
        this.asked = null;
        this.repeater.reset();
    }

    close() {
        this.picked = null;
        this.end();
        this.element.hidden = true;
    }

    // Sends a pick request. ask() repeats the request if the server does not answer in time.
    send(asked) {
        Object.assign(this, { asked, isLate: false });
        this.repeater.sent(performance.now());
        if (asked === 'new')
            askPick(this.session, this.clicked.pixel, 'place', this.clicked.camera);
        else
            askPoint(this.session, this.picked.position, 'place', this.half);
    }

    // Requests the value again if readings or parameters have changed, even if the point is outside the picture. Repeats an unanswered
    // request. Waits for the answer to a measuring or placing click.
    ask() {
        const { asked } = this;
        this.isLate = this.repeater.waits(performance.now()) || isClickDue(this.session);
        if (this.isLate || !this.session.picture)
            return;
        if (asked !== null)
            this.send(asked);
        else if (this.picked)
            this.send('again');
    }

    hear(picked) {
        if (this.asked === null) { // the answer belongs to another module, or the card was closed meanwhile
            if (this.isLate)
                this.ask();
            return;
        }
        const { asked } = this, again = asked === 'again';
        this.end();
        // The server answers only the newest pick request of the session. Another module's answer means that this card's request was
        // replaced. The request for a clicked point is sent again, unless the user has chosen something else since the click.
        if (picked.purpose !== 'place') {
            if (!again && INCIDENTAL.includes(picked.purpose))
                this.send(asked);
            return;
        }
        if (again && !this.isSamePlace(picked)) {
            this.close(); // closes the card, because its point is now hidden behind other equipment or its equipment was hidden
            return;
        }
        this.picked = picked.asset === null ? null : picked;
        this.element.hidden = !this.picked;
        if (this.picked)
            this.build();
        if (this.picked && !again) {
            this.session.setParams({ selected: this.picked.asset });
            this.makeRoom();
        }
        this.show();
        if (this.isLate)
            this.ask();
    }

    isSamePlace({ asset, position }) {
        return asset !== null && asset === this.picked.asset && position.every((x, i) => Math.abs(x - this.picked.position[i]) < SAME_M);
    }

    project() {
        return placeInPicture(this.session, this.viewport, this.picked.position, this.half);
    }

    number(value) {
        const { session } = this, all = halves(session.shown, 2), { params } = all[this.half] ?? all[0];
        return valueText(session.scaleOf(params), value);
    }

    build() {
        const { state, value, unit, uncertain, drawn_error: error, inside, nearest, place } = this.picked;
        const asset = this.session.model.asset(this.picked.asset);
        const found = say(`place.${place ?? state}`);
        const words = inside ? say('place.inside') : uncertain ? say('place.uncertain', { state: found }) : found;
        const away = (metres) => (place ? '' : say('distance.metres', { metres: numberText(metres, metres < 10 ? 2 : 1) }));
        const rows = nearest.map(({ tag, distance_m, value: reading, quality }) => make('li', {}, glyph(quality), make('span', {}, tag),
            make('span', {}, away(distance_m)),
            make('b', {}, this.number(reading))));
        const button = (how) => make('button', { type: 'button', onclick: () => this.showOnly(how, asset) }, say(`shown.${how}`));
        fill(this.element,
            closeButton('close', () => this.close()),
            make('h3', {}, asset.tag || asset.id), make('p', { class: 'about' }, asset.description ?? ''),
            value === null ? null : make('p', { class: 'value' }, this.number(value), make('i', {}, ` ${unitText(unit)}`)),
            make('p', { class: 'state' }, words),
            error ? make('p', { class: 'state' }, say('place.drawn', { value: `${this.number(error)} ${unitText(unit)}` })) : null,
            rows.length > 0 ? make('ul', { class: 'nearest' }, ...rows) : null,
            make('div', { class: 'buttons' }, ...['hide', 'ghost', 'only'].map(button)));
    }

    showOnly(how, asset) {
        this.showAsset(how, asset);
        this.close();
    }

    // Moves the card with its point when the picture moves.
    show() {
        if (this.picked)
            standBeside(this.element, this.viewport, this.project(), this.overlay, this.picked);
    }
}
