// SPDX-License-Identifier: GPL-3.0-or-later
// The performance panel, opened by a key: this session's id and the latency of its pictures by stage.
import { numberText } from '../../core/format.js';
import { kbitPerS, STAGES, timingOf } from '../../core/timings.js';
import { say } from '../../core/words.js';
import { clock } from '../common/clock.js';
import { byId, make } from '../common/dom.js';
import { around } from '../common/widgets.js';

const ms = (value) => (value === null || value === undefined ? '–' : value < 10 ? numberText(value, 1) : String(Math.round(value)));

export class TimingsPanel {
    constructor({ session }) {
        this.session = session;
        this.element = byId('timings');
        setInterval(() => !this.element.hidden && this.show(), 500);
    }

    // Opens or closes the panel.
    toggle() {
        this.element.hidden = !this.element.hidden;
        if (!this.element.hidden)
            this.show();
    }

    row(words, range) {
        return make('tr', {}, make('th', {}, words), make('td', {}, ms(range?.p50)), make('td', {}, ms(range?.p95)));
    }

    show() {
        const { session } = this, now = clock.now();
        const head = make('tr', {}, ...['ms', 'half', 'most'].map((name) => make('th', {}, say(`timings.${name}`))));
        const rows = ['sensor', ...STAGES].map((name) => this.row(say(`timings.${name}`), timingOf(session.recent, name)));
        const took = make('td', {}, ms(session.latency.median(now)));
        const input = make('tr', {}, make('th', {}, say('timings.input')), took, make('td', {}, ''));
        const [pictures, kbit] = [session.rate.perSecond(now), kbitPerS(session.recent, now)].map(Math.round);
        const link = make('a', { href: `#follow=${session.id}`, target: '_blank', rel: 'noopener' }, `#follow=${session.id}`);
        this.element.replaceChildren(make('table', {}, head, input, ...rows), make('p', {}, say('timings.rate', { pictures, kbit })),
            make('p', {}, ...around(say('timings.follow', { link: '\u0000' }), link)));
    }
}
