// SPDX-License-Identifier: GPL-3.0-or-later
// Number and choice fields of the panels for the colour range (picture.js) and for field settings (field_settings.js).
import { unitText } from '../../core/format.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from './dom.js';

const explained = (kind, ...values) => values.map((value) => [value, say(`${kind}.${value}`), say(`${kind}.${value}.why`)]);
export const distances = (group) => explained('distance', 'geodesic', 'euclidean', 'heat')
    .filter(([value], i) => i < 2 || group?.prepared?.includes(value));
// Returns the interpolations between sensors that a sensor group offers. The first two are always available, the others only if
// plantcast-prep has computed them for the group.
export const interpolations = (group) => explained('interpolation', 'shepard', 'paper', 'harmonic', 'fin', 'gp')
    .filter(([value], i) => i < 2 || group?.prepared?.includes(value));
export const fills = () => explained('fill', 'none', 'neighbours');

// Makes a number field. onNumber is called with the number, or with null if the field is empty.
export function numberField(id, words, attributes, onNumber) {
    const input = make('input', { type: 'number', id, step: 'any', inputmode: 'decimal', ...attributes,
        onchange: () => input.checkValidity() && onNumber(input.value === '' ? null : input.valueAsNumber) });
    return { input, label: make('label', { class: 'choice' }, make('span', {}, words), input) };
}

// Writes a number into a field, unless the user is typing in it.
export function writeNumber({ input }, value) {
    if (document.activeElement !== input)
        input.value = value ?? '';
}

export class Range {
    constructor({ session }) {
        this.session = session;
        this.ends = ['min', 'max'].map((end) => numberField(`range-${end}`, say(`factor.${end}`), {}, () => this.set()));
        const own = make('button', { type: 'button', id: 'range-own', onclick: () => session.setParams({ range: null }) });
        byId('light').before(make('fieldset', {}, make('legend', {}, say('factor.range')),
            make('div', { class: 'pairs' }, ...this.ends.map((f) => f.label)), make('div', { class: 'line' }, own)));
    }

    set() {
        const [min, max] = this.ends.map(({ input }) => input.valueAsNumber);
        if (min < max)
            this.session.setParams({ range: [min, max] });
    }

    update() {
        const { session } = this, { min, max, unit } = session.group;
        this.ends.forEach((f, i) => writeNumber(f, session.range[i]));
        setText(byId('range-own'), `${say('factor.own')} (${min}–${max} ${unitText(unit)})`);
    }
}
