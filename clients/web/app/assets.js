// SPDX-License-Identifier: GPL-3.0-or-later
// The list of equipment: areas, assets and their sensors with what they say, search, and the way there. On narrow screens it is loaded
// when it is first opened.
import { decimalsFor, numberText, qualityText, unitText } from '../core/format.js';
import { Tree } from '../core/tree.js';
import { say } from '../core/words.js';
import { byId, glyph, make, setText } from './dom.js';
import { narrow } from './first.js';
import { LongList } from './list.js';

const SEARCH_MS = 80, ASSET_PX = 53;
const keyOf = ({ kind, id }) => `${kind}/${id}`;

export class Assets {
    constructor({ session, selection, parts, selectAsset, showTag }) {
        Object.assign(this, { session, selection, parts, onAsset: selectAsset, onTag: showTag });
        this.search = byId('assets-search');
        this.setOpen(!narrow.matches);
        this.list = new LongList({
            root: byId('assets-list'), make: (row) => this.make(row), fill: (row, element) => this.fill(row, element), keyOf,
            height: ({ kind }) => (kind === 'asset' ? ASSET_PX : this.touchPx), onKey: (key, row, i) => this.press(key, row, i),
        });
        this.search.addEventListener('input', () => {
            clearTimeout(this.waiting);
            this.waiting = setTimeout(() => this.filter(), SEARCH_MS);
        });
        this.search.addEventListener('keydown', ({ key }) => key === 'Escape' && !this.search.value && byId('viewport').focus());
        byId('assets-close').addEventListener('click', () => this.setOpen(false));
        session.greeted(() => this.build());
        session.on('params', () => this.mark());
        session.on('tags', () => this.soon());
        session.on('alarms', () => this.soon());
        narrow.addEventListener('change', () => this.setOpen(!narrow.matches));
        window.matchMedia('(pointer: coarse)').addEventListener('change', () => this.filter());
    }

    get touchPx() {
        return window.matchMedia('(pointer: coarse)').matches ? 44 : 36;
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
        const { model } = this.session, before = this.tree;
        this.tree = new Tree(model, say('assets.loose'));
        if (before)
            Object.assign(this.tree, { open: before.open, folded: before.folded }); // a new connection finds it as it was
        setText(byId('assets-count'), String(model.assets.length));
        this.selected = undefined;
        this.mark();
    }

    filter() {
        if (!this.tree)
            return;
        const rows = this.tree.rows(this.search.value);
        byId('assets-nothing').hidden = rows.length > 0;
        this.list.set(rows);
    }

    // --- what is selected

    mark() {
        const { selected = null } = this.session.params, tag = this.selection.tag;
        if (!this.tree || (selected === this.selected && tag === this.marked))
            return;
        const { model } = this.session, asset = model.asset(selected), chosen = model.tag(tag);
        const isNew = chosen !== null && tag !== this.marked, owner = isNew ? model.asset(chosen.asset) : asset;
        if (owner)
            this.tree.unfold(owner);
        if (asset || this.parts.there('about'))
            this.parts.use('about', (about) => about.show(), 'show');
        const reveal = isNew ? `tag/${chosen.index}` : asset && selected !== this.selected && `asset/${selected}`;
        Object.assign(this, { selected, marked: tag });
        this.filter();
        if (reveal)
            this.list.reveal(reveal);
    }

    // --- rows

    toggle(row) {
        this.tree.toggle(row);
        this.filter();
    }

    act(row) {
        const { kind, item } = row;
        if (kind === 'area')
            return this.toggle(row);
        if (kind === 'tag')
            return this.onTag(item);
        if (item.id === null)
            return this.toggle(row);
        this.onAsset(item);
        if (narrow.matches)
            this.setOpen(false);
        return undefined;
    }

    // Right opens or goes in, left closes or goes out. True: that was for us.
    press(key, row, i) {
        const { rows } = this.list, hasRows = row.kind !== 'tag';
        if (key === 'Enter' || key === ' ')
            this.act(row);
        else if (key === 'ArrowRight' && hasRows && !row.open)
            this.toggle(row);
        else if (key === 'ArrowRight')
            this.list.at(rows[i + 1]?.level > row.level ? i + 1 : i);
        else if (key === 'ArrowLeft' && hasRows && row.open)
            this.toggle(row);
        else if (key === 'ArrowLeft')
            this.list.at(rows.findLastIndex((one, n) => n < i && one.level < row.level));
        else
            return false;
        return true;
    }

    make(row) {
        const { kind, item } = row, press = { onclick: () => this.act(this.rowOf(row)) };
        const twist = make('span', { class: 'twist', 'aria-hidden': 'true', onclick: (event) => {
            event.stopPropagation();
            this.toggle(this.rowOf(row));
        } });
        const common = { role: 'treeitem', 'aria-level': row.level, ...press };
        if (kind === 'area')
            return make('div', { ...common, class: 'area' }, twist, make('b', {}, row.text), make('span', { class: 'flag' }),
                make('span', { class: 'count' }, String(row.count)));
        if (kind === 'tag')
            return make('div', { ...common, class: 'reading', title: item.description }, glyph('none'),
                make('span', {}, item.name, make('span', { class: 'flag' })), make('span', { class: 'value' }));
        const count = item.tags.length;
        return make('div', { ...common, class: 'asset' }, count > 0 ? twist : make('span'), glyph('none'),
            make('span', { class: 'text' }, make('b', {}, item.tag || item.id), make('span', {}, item.description ?? '')),
            make('span', { class: 'count' }, make('span', { class: 'flag' }), count > 0 ? say('assets.sensors', { count }) : ''));
    }

    // As the row is now.
    rowOf(row) {
        return this.list.rows[this.list.places.get(keyOf(row))];
    }

    fill(row, element) {
        const { model, params } = this.session, { kind, item } = row;
        put(element, 'aria-setsize', row.setSize);
        put(element, 'aria-posinset', row.place);
        if (kind === 'area')
            return void put(element, 'aria-expanded', row.open);
        if (kind === 'asset') {
            put(element, 'aria-expanded', item.tags.length > 0 ? row.open : null);
            put(element, 'aria-selected', item.id !== null && item.id === params.selected);
            setQuality(element, model.worstQuality(item) ?? 'none');
            setAlarm(element, model.worstAlarm(item));
            return undefined;
        }
        put(element, 'aria-selected', this.selection.tag === item.name);
        this.fillReading(item, element);
        return undefined;
    }

    fillReading(tag, element) {
        const { model, params } = this.session, value = element.lastChild;
        const { value: number, quality } = model.readings[tag.index], group = model.group(tag.group);
        const known = number !== null && quality !== 'bad';
        const text = known ? numberText(number, group ? decimalsFor(group.max - group.min) : 2) : say('novalue');
        const unit = known ? ` ${unitText(tag.unit || group?.unit)}` : '';
        if (value.textContent !== text + unit)
            value.replaceChildren(text, make('i', {}, unit));
        value.classList.toggle('other', tag.group !== params.group);
        setQuality(element, quality);
        setAlarm(element, model.alarms.gravest(tag.index));
    }

    // Once per picture of the page, however much comes in.
    soon() {
        this.mark();
        this.asked ??= requestAnimationFrame(() => {
            this.asked = null;
            if (this.open && this.tree)
                this.list.show();
        });
    }
}

function put(element, name, value) {
    if (value === null || value === undefined)
        element.removeAttribute(name);
    else if (element.getAttribute(name) !== String(value))
        element.setAttribute(name, value);
}

function setAlarm(element, alarm) {
    const text = alarm ? `${alarm.kind} p${alarm.priority}` : '';
    if ((element.dataset.alarm ?? '') === text)
        return;
    element.dataset.alarm = text;
    const flag = alarm ? [make('span', { class: `limit-flag p${alarm.priority}` }, alarm.kind)] : [];
    element.querySelector('.flag').replaceChildren(...flag);
}

function setQuality(element, quality) {
    if (element.dataset.quality === quality)
        return;
    element.dataset.quality = quality;
    element.querySelector('.glyph').replaceWith(glyph(quality));
    put(element, 'aria-description', ['good', 'none'].includes(quality) ? null : say('assets.worst', { quality: qualityText(quality) }));
}
