// SPDX-License-Identifier: GPL-3.0-or-later
// Split view: the same view twice, with a bar over the right half that chooses what the right half shows.
import { quantityText } from '../../core/model.js';
import { say, title } from '../../core/words.js';
import { fillSelect } from '../common/choices.js';
import { byId, icon, make } from '../common/dom.js';
import { distances, interpolations } from '../common/number_fields.js';
import { LOOKS, SHOWS } from '../toolbar/toolbar.js';
import { keepPanelsAbove } from './bar_top.js';

const CHOICES = { group: 'bar.quantity', show: 'bar.show', colormap: 'bar.colours', look: 'bar.look', distance: 'bar.distance',
    interpolation: 'bar.interpolation' };
const ENGINEERS = ['distance', 'interpolation'];

export class Split {
    constructor({ session, viewport }) {
        Object.assign(this, { session, group: null, last: null });
        const choose = (name) => ({ target }) => session.setParams({ split: { [name]: target.value } });
        this.selects = Object.fromEntries(Object.keys(CHOICES).map((name) =>
            [name, make('select', { id: `right-${name}`, onchange: choose(name) })]));
        const labels = Object.entries(CHOICES).map(([name, key]) =>
            make('label', { class: `choice ${name}` }, make('span', {}, say(key)), this.selects[name]));
        this.element = make('section', { class: 'split-bar', id: 'split-bar', hidden: true, 'aria-label': say('split.right') }, ...labels,
            make('button', { type: 'button', class: 'icon small', 'aria-label': say('split.end'), title: say('split.end'),
                onclick: () => this.toggle() }, icon('i-close')));
        viewport.element.append(this.element);
        keepPanelsAbove(this.element);
        session.on('params', () => this.update());
        session.on('welcome', () => this.update());
        this.update();
    }

    toggle() {
        const { params } = this.session;
        this.session.setParams({ split: params.split ? null : this.first() });
    }

    // Returns what the right half shows when the split begins: the sensor group shown before the present one, else the next
    // group in the list. If that is the left half's group, the right half shows that group's alarm limits, or its values if the
    // left half shows the limits.
    first() {
        const { model, params } = this.session, { groups } = model, now = groups.findIndex(({ id }) => id === params.group);
        const last = model.group(this.last)?.id ?? groups[(now + 1) % groups.length].id;
        return last === params.group ? { show: params.show === 'operator' ? 'value' : 'operator' } : { group: last };
    }

    update() {
        const { model, params, role } = this.session;
        if (!model)
            return;
        if (this.group !== params.group)
            this.last = this.group;
        this.group = params.group;
        this.element.hidden = !params.split;
        byId('split-toggle').setAttribute('aria-pressed', String(Boolean(params.split)));
        if (!params.split)
            return;
        const right = { ...params, ...params.split }, group = model.group(right.group);
        const plain = (choices) => choices.map(([value, text]) => [value, text]);
        const choices = {
            group: model.groups.map((one) => [one.id, quantityText(one)]),
            show: plain(SHOWS.filter(([value]) => ['value', 'operator', right.show].includes(value) ||
                (value === 'distance' && params.sensor) || (value === 'difference' && params.baseline))),
            colormap: model.colormaps.map(({ name }) => [name, title(name)]),
            look: plain(LOOKS),
            distance: plain(distances(group)),
            interpolation: plain(interpolations(group)),
        };
        for (const [name, select] of Object.entries(this.selects)) {
            fillSelect(select, choices[name], right[name]);
            if (!ENGINEERS.includes(name))
                continue;
            // A control that the user may not change (only engineers may) is visible only if its value differs from the left
            // half's, or, if the halves show different sensor groups, from the default of the right half's group.
            const differs = right[name] !== (right.group === params.group ? params : group)[name];
            select.disabled = role !== 'engineer';
            select.parentElement.hidden = select.disabled && !differs;
            select.parentElement.classList.toggle('differs', differs);
        }
    }
}
