// SPDX-License-Identifier: GPL-3.0-or-later
// The panel of measurements, on a key: which session this is, and where the time of its pictures goes.
import { STAGES } from '../core/timings.js';
import { byId, make } from './dom.js';

const WORDS = {
    sensor: 'Reading to picture', wait: 'waiting', field: 'field', render: 'drawing', encode: 'encoding', network: 'network',
    decode: 'decoding',
};
const ms = (value) => (value === null || value === undefined ? '–' : value < 10 ? value.toFixed(1) : String(Math.round(value)));

export class TimingsPanel {
    constructor({ session }) {
        this.session = session;
        this.element = byId('timings');
        setInterval(() => !this.element.hidden && this.show(), 500);
    }

    toggle() {
        this.element.hidden = !this.element.hidden;
        if (!this.element.hidden)
            this.show();
    }

    row(words, range) {
        return make('tr', {}, make('th', {}, words), make('td', {}, ms(range?.p50)), make('td', {}, ms(range?.p95)));
    }

    show() {
        const { session } = this, now = performance.now();
        const head = make('tr', {}, make('th', {}, 'Milliseconds'), make('th', {}, 'half'), make('th', {}, '95 %'));
        const rows = ['sensor', ...STAGES].map((name) => this.row(WORDS[name], session.timings.of(name)));
        const took = make('td', {}, ms(session.latency.median(now)));
        const input = make('tr', {}, make('th', {}, 'Input to picture'), took, make('td', {}, ''));
        const rate = `${Math.round(session.rate.perSecond(now))} pictures/s, ${Math.round(session.timings.kbitPerS(now))} kbit/s`;
        const link = make('a', { href: `#follow=${session.id}`, target: '_blank', rel: 'noopener' }, `#follow=${session.id}`);
        this.element.replaceChildren(make('table', {}, head, input, ...rows), make('p', {}, rate),
            make('p', {}, `Session ${session.id}. Who opens `, link, ' sees this view.'));
    }
}
