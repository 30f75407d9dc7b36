// SPDX-License-Identifier: GPL-3.0-or-later
// The card of one sensor: its description, value, quality, loop check and age.
import { ageText, unitText, valueText } from '../../core/format.js';
import { statusText } from '../../core/quality.js';
import { say } from '../../core/words.js';
import { linksOf } from '../assets/about.js';
import { placeInPicture, standBeside } from './card_position.js';
import { clock } from '../common/clock.js';
import { byId, glyph, limitFlag, make, setText } from '../common/dom.js';
import { closeButton, fill } from '../common/widgets.js';
import { driftCurve, driftOf, driftText } from './drift.js';
import { Neighbours, neighbourText } from './neighbours.js';

export class Card {
    constructor({ session, selection, overlay, viewport, modules, selectTag, showTrend, addTrend }) {
        Object.assign(this, { session, selection, overlay, viewport, modules, selectTag, showTrend, addTrend });
        this.element = byId('card');
        // Repositions the card when its size changes: the lines with the sensor's drift and its neighbours' prediction are
        // added after the card has opened.
        new ResizeObserver(() => this.show()).observe(this.element);
        this.show();
    }

    get tag() {
        return this.selection.hover ?? this.session.model?.tag(this.selection.tag) ?? null;
    }

    show() {
        const { tag } = this;
        const marker = tag && this.overlay.marker(tag);
        this.element.hidden = !tag || (!marker && tag === this.selection.hover);
        if (this.element.hidden) {
            this.neighbours?.show(null);
            return;
        }
        this.element.classList.toggle('hover', tag === this.selection.hover && tag.name !== this.selection.tag);
        this.fill(tag);
        this.place(marker);
    }

    fill(tag) {
        const { model } = this.session;
        if (this.filled !== tag) {
            this.filled = tag;
            this.build(tag, model.asset(tag.asset));
        }
        const reading = model.readings[tag.index], group = model.group(tag.group);
        const known = reading.value !== null;
        const number = known ? valueText(group, reading.value) : say('card.novalue');
        const unit = known ? ` ${unitText(tag.unit || group?.unit)}` : '';
        if (this.value.textContent !== number + unit)
            this.value.replaceChildren(number, make('i', {}, unit));
        const quality = statusText(reading.quality, reading.qualityName);
        if (this.quality.textContent !== quality)
            this.quality.replaceChildren(glyph(reading.quality), quality);
        setText(this.age, ageText(model.ageMs(tag.index, clock.now())));
        const unproven = model.unproven(tag);
        setText(this.proof, unproven ? say(`proof.${unproven}`) : '');
        setText(this.assumed, tag.place === 'equipment' ? say('proof.assumed') : '');
        if (group && tag.asset)
            this.neighbours.show(`tag=${encodeURIComponent(tag.name)}`);
        this.adds.hidden = !this.modules.there('trends')?.takes(tag);
        const alarm = model.alarms.gravest(tag.index);
        this.limit.hidden = !alarm;
        if (alarm) {
            this.limit.replaceChildren(limitFlag(alarm), ` ${say(`card.${alarm.kind}`)}, ${say(`state.${alarm.state}`)}`);
        }
    }

    build(tag, asset) {
        const links = linksOf(this.session.model, 'tag', tag);
        const on = asset ? [asset.tag || asset.id, asset.description].filter(Boolean).join(', ') : '–';
        this.value = make('p', { class: 'value' });
        this.limit = make('p', { class: 'limit', hidden: true });
        this.proof = make('p', { class: 'proof' });
        this.assumed = make('p', { class: 'proof assumed' });
        this.quality = make('dd');
        this.age = make('dd');
        this.others = make('dd');
        this.othersTerm = make('dt', { hidden: true }, say('neighbours.say'));
        this.neighbours?.show(null);
        this.neighbours = new Neighbours(this.session, () => this.element.offsetParent !== null, ([row]) => {
            const text = neighbourText(row, this.session.model.group(tag.group));
            this.othersTerm.hidden = !text;
            setText(this.others, text ?? '');
        });
        this.week = make('dd', {});
        this.weekTerm = make('dt', { hidden: true }, say('drift.week'));
        this.showDrift(tag);
        const trend = (name, f, key) => make('button', { type: 'button', class: name, onclick: () => f(tag) }, say(key));
        this.adds = trend('add-trend', this.addTrend, 'card.add');
        fill(this.element,
            closeButton('close', () => this.selectTag(null)),
            make('h3', {}, tag.name), make('p', { class: 'about' }, tag.description ?? ''), this.value, this.limit,
            this.proof, this.assumed,
            make('dl', {}, make('dt', {}, say('card.quality')), this.quality, make('dt', {}, say('card.age')), this.age,
                this.othersTerm, this.others, this.weekTerm, this.week,
                make('dt', {}, say('card.on')), make('dd', {}, on)),
            this.session.recorded ? make('div', { class: 'trends-of' }, trend('trend', this.showTrend, 'card.trend'), this.adds) : null,
            links.length > 0 ? make('p', { class: 'links' }, ...links) : null);
    }

    async showDrift(tag) {
        const { week, weekTerm } = this, group = this.session.model.group(tag.group);
        const [row] = group && tag.asset ? await driftOf(this.session, { tag: tag.name }) : [];
        const text = driftText(row, group);
        weekTerm.hidden = !text;
        week.replaceChildren(...text ? [text, driftCurve(row)].filter(Boolean) : []);
        week.classList.toggle('drifts', row?.verdict === 'found');
    }

    place(marker) {
        const { tag, session, viewport, overlay } = this, { x, y } = marker ? overlay.placeOf(marker) : {};
        const at = marker ? [x, y] : tag.position && placeInPicture(session, viewport, tag.position);
        const isInside = at && at[0] >= 0 && at[0] <= viewport.width && at[1] >= 0 && at[1] <= viewport.height;
        standBeside(this.element, viewport, marker || isInside ? at : null, overlay, tag);
    }
}
