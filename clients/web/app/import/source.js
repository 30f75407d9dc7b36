// SPDX-License-Identifier: GPL-3.0-or-later
// The data source of an imported plant: the user enters a device's address, and the panel shows which values arrive.
import { statusText } from '../../core/quality.js';
import { say } from '../../core/words.js';
import { make, setText } from '../common/dom.js';
import { fill } from '../common/widgets.js';

const ORDERS = ['', 'ABCD', 'CDAB', 'BADC', 'DCBA'], BASES = [['1', '1 (400001)'], ['0', '0 (400000)']];
const REASONS = 4, LOOK_MS = 500;

const labelled = (key, element) => make('label', { class: 'choice' }, make('span', {}, say(`import.source.${key}`)), element);

export class Source {
    // connect(source) sends the Modbus data source { host, port, unit (unit identifier), order (byte order), base (number of
    // the first register: 0 or 1) }, all texts, to the server.
    constructor({ session, connect }) {
        Object.assign(this, { session, known: '' });
        this.host = make('input', { type: 'text', required: true, maxLength: 253, pattern: '[A-Za-z0-9._][A-Za-z0-9._\\-]*',
            spellcheck: false });
        this.port = make('input', { type: 'number', required: true, min: 1, max: 65535, value: '502' });
        this.unit = make('input', { type: 'number', required: true, min: 0, max: 255, value: '1' });
        this.order = make('select', {}, ...ORDERS.map((value) => make('option', { value }, value || say('import.source.unstated'))));
        this.base = make('select', {}, ...BASES.map(([value, text]) => make('option', { value }, text)));
        this.button = make('button', { type: 'submit' }, say('import.source.connect'));
        this.summary = make('b', { class: 'size' });
        this.live = make('p', { class: 'live', role: 'status' });
        this.reasons = make('ul', { class: 'quiet' });
        const form = make('form', { onsubmit: (event) => {
            event.preventDefault();
            connect(this.stated());
        } }, make('div', { class: 'line' }, labelled('host', this.host), labelled('port', this.port), labelled('unit', this.unit)),
        make('div', { class: 'line' }, labelled('order', this.order), labelled('base', this.base), this.button));
        this.element = make('details', { class: 'source' }, make('summary', {}, say('import.source'), ' ', this.summary), form, this.live,
            this.reasons, make('p', { class: 'quiet' }, say('import.source.note')));
        session.on('tags', () => this.soon());
        this.element.addEventListener('toggle', () => this.soon());
    }

    stated() {
        const { host, port, unit, order, base } = this;
        return { host: host.value.trim(), port: port.value, unit: unit.value, order: order.value, base: base.value };
    }

    // source: data source of the shown plant; null: none, or one that this panel cannot show. Text that the user has typed
    // stays until the source changes.
    set(source, busy) {
        const known = JSON.stringify(source);
        this.button.disabled = busy;
        if (known === this.known)
            return;
        this.known = known;
        setText(this.summary, source ? `${source.host}:${source.port}` : say('import.source.none'));
        for (const name of ['host', 'port', 'unit', 'order', 'base'])
            if (source)
                this[name].value = source[name];
        this.soon();
    }

    soon() {
        this.timer ??= setTimeout(() => {
            this.timer = null;
            this.show();
        }, LOOK_MS);
    }

    // Shows how many tags have values from the source, and why the others have none.
    show() {
        const { model } = this.session;
        if (!this.element.open || this.element.offsetParent === null || !model)
            return;
        const bad = model.readings.filter(({ quality }) => quality === 'bad'), all = model.readings.length, reasons = new Map();
        for (const { quality, qualityName } of bad)
            reasons.set(statusText(quality, qualityName), (reasons.get(statusText(quality, qualityName)) ?? 0) + 1);
        setText(this.live, this.known === 'null' ? '' : say('import.source.live', { good: all - bad.length, count: all }));
        this.live.classList.toggle('all', bad.length === 0);
        fill(this.reasons, ...(this.known === 'null' ? [] : [...reasons].sort(([, a], [, b]) => b - a).slice(0, REASONS)
            .map(([why, count]) => make('li', {}, say('import.source.bad', { count, why })))));
    }
}
