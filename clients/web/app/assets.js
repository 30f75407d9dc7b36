// SPDX-License-Identifier: GPL-3.0-or-later
// The equipment list: search, quality at a glance, the selected one's sensors with their values, and the way there.
import { decimalsFor, numberText, qualityText, unitText } from '../core/format.js';
import { say } from '../core/words.js';
import { byId, glyph, make, setText } from './dom.js';

const NARROW = '(max-width: 1023px)';

export class Assets {
    // Handlers: onAsset(asset), onTag(tag).
    constructor({ session, selection }) {
        Object.assign(this, { session, selection });
        this.list = byId('assets-list');
        this.search = byId('assets-search');
        this.rows = new Map(); // asset id -> { item, quality, readings: Map index -> elements }
        this.onAsset = this.onTag = () => {};
        this.search.addEventListener('input', () => this.filter());
        byId('assets-toggle').addEventListener('click', () => this.setOpen(!this.open));
        byId('assets-close').addEventListener('click', () => this.setOpen(false));
        session.on('welcome', () => this.build());
        session.on('params', () => this.mark());
        session.on('tags', () => this.update());
        session.on('alarms', () => this.update());
        this.setOpen(!this.narrow);
        window.matchMedia(NARROW).addEventListener('change', () => this.setOpen(!this.narrow));
    }

    get narrow() {
        return window.matchMedia(NARROW).matches;
    }

    setOpen(open) {
        this.open = open;
        document.querySelector('.stage').classList.toggle('without-assets', !open);
        byId('assets-toggle').setAttribute('aria-expanded', open);
    }

    openSearch() {
        this.setOpen(true);
        this.search.focus();
        this.search.select();
    }

    build() {
        const { model } = this.session;
        this.rows.clear();
        this.list.replaceChildren(...model.assets.map((asset) => this.row(asset)));
        this.empty = make('li', { class: 'nothing', hidden: true }, say('assets.nothing'));
        this.list.append(this.empty);
        setText(byId('assets-count'), String(model.assets.length));
        this.filter();
        this.mark();
    }

    row(asset) {
        const count = asset.tags.length;
        const sensors = count === 0 ? '' : say('assets.sensors', { count });
        const button = make('button', { type: 'button', class: 'asset', 'aria-pressed': 'false', onclick: () => this.choose(asset) },
            glyph('none'),
            make('span', { class: 'text' }, make('b', {}, asset.tag || asset.id), make('span', {}, asset.description ?? '')),
            make('span', { class: 'count' }, make('span', { class: 'flag' }), sensors));
        const item = make('li', {}, button);
        this.rows.set(asset.id, { asset, item, button, quality: null, readings: new Map() });
        return item;
    }

    choose(asset) {
        this.onAsset(asset);
        if (this.narrow)
            this.setOpen(false);
    }

    filter() {
        const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
        let shown = 0;
        for (const { asset, item } of this.rows.values()) {
            const tags = asset.tags.map((tag) => `${tag.name} ${tag.description}`);
            const text = [asset.id, asset.tag, asset.description, ...tags].join(' ').toLowerCase();
            item.hidden = !words.every((word) => text.includes(word));
            shown += item.hidden ? 0 : 1;
        }
        if (this.empty)
            this.empty.hidden = shown > 0;
    }

    // Shows which one is selected, and its sensors beneath it.
    mark() {
        const { selected } = this.session.params;
        for (const row of this.rows.values()) {
            const on = row.asset.id === selected;
            row.button.setAttribute('aria-pressed', on);
            if (on && !row.sensors)
                this.unfold(row);
            else if (!on && row.sensors)
                this.fold(row);
        }
        this.update();
    }

    unfold(row) {
        row.sensors = make('div', { class: 'readings' });
        for (const tag of row.asset.tags) {
            const value = make('span', { class: 'value' });
            const button = make('button', { type: 'button', class: 'reading', title: tag.description, onclick: () => this.onTag(tag) },
                glyph('none'), make('span', {}, tag.name, make('span', { class: 'flag' })), value);
            row.readings.set(tag.index, { tag, button, value, quality: null });
            row.sensors.append(button);
        }
        row.item.append(row.sensors);
        row.item.scrollIntoView({ block: 'nearest' });
    }

    fold(row) {
        row.sensors.remove();
        row.sensors = null;
        row.readings.clear();
    }

    update() {
        const { model } = this.session;
        if (!model)
            return;
        for (const row of this.rows.values()) {
            this.setQuality(row, row.button, model.worstQuality(row.asset) ?? 'none');
            this.setAlarm(row, row.button, model.worstAlarm(row.asset));
            for (const reading of row.readings.values())
                this.updateReading(reading);
        }
    }

    updateReading(reading) {
        const { tag, value, button } = reading;
        const { model, params } = this.session;
        const { value: number, quality } = model.readings[tag.index];
        const group = model.group(tag.group);
        const known = number !== null && quality !== 'bad';
        const text = known ? numberText(number, group ? decimalsFor(group.max - group.min) : 2) : say('novalue');
        const unit = known ? ` ${unitText(tag.unit || group?.unit)}` : '';
        if (value.textContent !== text + unit)
            value.replaceChildren(text, make('i', {}, unit));
        value.classList.toggle('other', tag.group !== params.group);
        button.setAttribute('aria-pressed', this.selection.tag === tag.name);
        this.setQuality(reading, button, quality);
        this.setAlarm(reading, button, model.alarms.gravest(tag.index));
    }

    setAlarm(row, parent, alarm) {
        const text = alarm ? `${alarm.kind} p${alarm.priority}` : '';
        if (row.alarm === text)
            return;
        row.alarm = text;
        const flag = alarm ? [make('span', { class: `limit-flag p${alarm.priority}` }, alarm.kind)] : [];
        parent.querySelector('.flag').replaceChildren(...flag);
    }

    setQuality(row, parent, quality) {
        if (row.quality === quality)
            return;
        row.quality = quality;
        parent.querySelector('.glyph').replaceWith(glyph(quality));
        if (quality === 'good' || quality === 'none')
            parent.removeAttribute('aria-description');
        else
            parent.setAttribute('aria-description', say('assets.worst', { quality: qualityText(quality) }));
    }
}
