// SPDX-License-Identifier: GPL-3.0-or-later
// Settings for engineers of how values are interpolated between sensors: kind of distance, kind of interpolation, how areas
// without data are shown, and weighting factors for all sensors or for one.
import { say } from '../../core/words.js';
import { make, setText } from '../common/dom.js';
import { distances, fills, interpolations, numberField, writeNumber } from '../common/number_fields.js';
import { fillSegments, markSegment } from '../common/choices.js';

const FACTORS = {
    strength: [0, 100], decay: [0, 100], power: [0.5, 16], radius_m: [0, 1e6], reach_m: [1e-6, 1e6], // ranges that the server accepts
};
const OWN = ['strength', 'decay'];
const pairs = (all) => make('div', { class: 'pairs' }, ...all.map(([, { label }]) => label));

export class Method {
    constructor({ session, selection }) {
        Object.assign(this, { session, selection });
        this.choices = [this.choice('distance', say('bar.distance'), distances()),
            this.choice('interpolation', say('bar.interpolation'), interpolations()), this.choice('fill', say('picture.fill'), fills())];
        this.factors = Object.entries(FACTORS).map(([name, [min, max]]) => [name,
            numberField(`factor-${name}`, say(`factor.${name}`), { min, max }, (value) => this.setFactor(name, value))]);
        this.own = OWN.map((name) => [name, numberField(`own-${name}`, say(`factor.${name}`), { min: 0, max: 100 },
            (value) => this.setOwn({ [name]: value ?? undefined }))]);
        this.title = make('legend');
        this.reset = make('button', { type: 'button', id: 'own-reset', onclick: () => session.setParams({ sensors: null }) });
        this.element = make('div', { class: 'part method' }, ...this.choices.flatMap(({ fieldset, why }) => [fieldset, why]),
            make('fieldset', {}, make('legend', {}, say('factor.title')), pairs(this.factors)),
            make('fieldset', { id: 'own-factors' }, this.title, pairs(this.own), make('div', { class: 'line' }, this.reset)));
        session.on('params', () => this.show());
        session.on('welcome', () => this.show());
    }

    // Makes a choice field with an explanation of the chosen value below it.
    choice(name, words, all) {
        const fieldset = make('fieldset', { class: 'segments', id: name }, make('legend', {}, words));
        fillSegments(fieldset, name, all, (value) => this.session.setParams({ [name]: value }));
        return { name, fieldset, all, why: make('p', { class: 'quiet' }) };
    }

    // Offers the kinds of distance and interpolation that plantcast-prep has computed for the sensor group.
    offer(group) {
        this.offerOf('distance', distances(group));
        this.offerOf('interpolation', interpolations(group));
    }

    offerOf(name, all) {
        const choice = this.choices.find((one) => one.name === name);
        if (all.length === choice.all.length && all.every(([value], i) => value === choice.all[i][0]))
            return;
        choice.all = all;
        fillSegments(choice.fieldset, name, all, (value) => this.session.setParams({ [name]: value }));
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

    show() {
        const { session, tag } = this, { params } = session;
        if (!session.model || this.element.offsetParent === null)
            return;
        this.offer(session.model.group(params.group));
        for (const { name, fieldset, all, why } of this.choices) {
            markSegment(fieldset, params[name]);
            setText(why, all.find(([value]) => value === params[name])?.[2] ?? '');
        }
        for (const [name, f] of this.factors)
            writeNumber(f, params[name]);
        setText(this.title, tag ? say('factor.of', { tag: tag.name }) : say('factor.choose'));
        for (const [name, f] of this.own) {
            f.input.disabled = !tag;
            writeNumber(f, tag && params.sensors?.[tag.name]?.[name]);
        }
        this.reset.disabled = Object.keys(params.sensors ?? {}).length === 0;
        setText(this.reset, say('factor.reset', { count: Object.keys(params.sensors ?? {}).length }));
    }
}
