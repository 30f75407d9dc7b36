// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers in the panel of the picture: the range of the colours, and for engineers how the field is computed, of all sensors and of one.
import { unitText } from '../core/format.js';
import { say } from '../core/words.js';
import { byId, make, setText } from './dom.js';

const FACTORS = {
    strength: [0, 100], decay: [0, 100], power: [0.5, 16], radius_m: [0, 1e6], reach_m: [1e-6, 1e6], // as the server takes them
};
const pairs = (all) => make('div', { class: 'pairs' }, ...all.map(([, { label }]) => label));
const OWN = ['strength', 'decay'];

export class Factors {
    constructor({ session, selection }) {
        Object.assign(this, { session, selection });
        this.range = ['min', 'max'].map((end) => this.field(`range-${end}`, say(`factor.${end}`), {}, () => this.setRange()));
        this.factors = Object.entries(FACTORS).map(([name, [min, max]]) => [name,
            this.field(`factor-${name}`, say(`factor.${name}`), { min, max }, (value) => this.setFactor(name, value))]);
        this.own = OWN.map((name) => [name, this.field(`own-${name}`, say(`factor.${name}`), { min: 0, max: 100 },
            (value) => this.setOwn({ [name]: value ?? undefined }))]);
        this.title = make('legend');
        this.reset = make('button', { type: 'button', id: 'own-reset', onclick: () => session.setParams({ sensors: null }) });
        const own = make('button', { type: 'button', id: 'range-own', onclick: () => session.setParams({ range: null }) });
        this.engineers = make('div', { id: 'factors' },
            make('fieldset', {}, make('legend', {}, say('factor.title')), pairs(this.factors)),
            make('fieldset', { id: 'own-factors' }, this.title, pairs(this.own),
                make('div', { class: 'line' }, this.reset)));
        byId('light').before(make('fieldset', {}, make('legend', {}, say('factor.range')),
            make('div', { class: 'pairs' }, ...this.range.map((f) => f.label)),
            make('div', { class: 'line' }, own)), this.engineers);
    }

    // onNumber(number, or null where nothing is written).
    field(id, words, attributes, onNumber) {
        const input = make('input', { type: 'number', id, step: 'any', inputmode: 'decimal', ...attributes,
            onchange: () => input.checkValidity() && onNumber(input.value === '' ? null : input.valueAsNumber) });
        return { input, label: make('label', { class: 'choice' }, make('span', {}, words), input) };
    }

    setRange() {
        const [min, max] = this.range.map(({ input }) => input.valueAsNumber);
        if (min < max)
            this.session.setParams({ range: [min, max] });
    }

    setFactor(name, value) {
        if (value !== null || name === 'reach_m')
            this.session.setParams({ [name]: value });
    }

    setOwn(change) {
        const { tag } = this;
        if (tag)
            this.session.setParams({ sensors: { [tag.name]: { ...this.session.params.sensors?.[tag.name], ...change } } });
    }

    get tag() {
        const { model, params } = this.session, tag = model?.tag(this.selection.tag);
        return tag?.group === params.group ? tag : null;
    }

    update() {
        const { session, tag } = this, { params } = session, write = ({ input }, value) => {
            if (document.activeElement !== input)
                input.value = value ?? '';
        };
        this.range.forEach((f, i) => write(f, session.range[i]));
        const { min, max, unit } = session.group;
        setText(byId('range-own'), `${say('factor.own')} (${min}–${max} ${unitText(unit)})`);
        this.engineers.hidden = session.role !== 'engineer';
        for (const [name, f] of this.factors)
            write(f, params[name]);
        const all = Object.keys(params.sensors ?? {});
        setText(this.title, tag ? say('factor.of', { tag: tag.name }) : say('factor.choose'));
        for (const [name, f] of this.own) {
            f.input.disabled = !tag;
            write(f, tag && params.sensors?.[tag.name]?.[name]);
        }
        this.reset.disabled = all.length === 0;
        setText(this.reset, say('factor.reset', { count: all.length }));
    }
}
