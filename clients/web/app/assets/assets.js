// SPDX-License-Identifier: GPL-3.0-or-later
// The equipment list: areas, assets and their sensors with values. On narrow screens it is loaded when first opened. Pointer,
// keyboard and search handling (rows.js) is loaded on first use.
import { qualityText, unitText, valueText } from '../../core/format.js';
import { Tree } from '../../core/asset_tree.js';
import { say } from '../../core/words.js';
import { byId, glyph, limitFlag, make, setText } from '../common/dom.js';
import { narrow } from '../startup.js';
import { LongList } from './list.js';

const SEARCH_MS = 80, ASSET_PX = 53;
// keys handled by the list's rows; other handlers get the rest
const KEYS = /^(Arrow(Up|Down|Left|Right)|Home|End|Page(Up|Down)|Enter| )$/;
const keyOf = ({ kind, id }) => `${kind}/${id}`;

export class Assets {
    constructor({ session, selection, modules }) {
        Object.assign(this, { session, selection, modules, found: null });
        this.search = byId('assets-search');
        this.setOpen(!narrow.matches);
        this.list = new LongList({
            root: byId('assets-list'), make: (row) => this.make(row), fill: (row, element) => this.fill(row, element), keyOf,
            height: ({ kind }) => (kind === 'asset' ? ASSET_PX : this.touchPx),
        });
        this.listen(this.list.root);
        this.search.addEventListener('input', () => {
            clearTimeout(this.waiting);
            this.waiting = setTimeout(() => this.modules.use('rows', (rows) => rows.search(), 'search'), SEARCH_MS);
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

    // Calls f with the module that handles input to the rows (rows.js), loading it first if necessary.
    does(f) {
        this.modules.use('rows', f);
    }

    listen(root) {
        root.addEventListener('pointerover', () => this.modules.prepare('rows'), { once: true });
        root.addEventListener('focusin', ({ target }) => {
            const key = target.closest('[data-row]')?.dataset.row;
            this.does((rows) => rows.isAt(key));
        });
        root.addEventListener('keydown', (event) => {
            if (event.ctrlKey || event.altKey || event.metaKey || !KEYS.test(event.key))
                return;
            this.does((rows) => rows.press(event.key));
            event.preventDefault();
            event.stopPropagation(); // stops the event here, because the key would also move the camera
        });
    }

    get touchPx() {
        return window.matchMedia('(pointer: coarse)').matches ? 44 : 36;
    }

    setOpen(open) {
        this.open = open;
        document.querySelector('.stage').classList.toggle('without-assets', !open);
        byId('assets-toggle').setAttribute('aria-expanded', open);
    }

    build() {
        const { model } = this.session, before = this.tree;
        this.tree = new Tree(model, say('assets.loose'));
        if (before)
            // after a reconnect, keeps the same areas and assets expanded
            Object.assign(this.tree, { open: before.open, folded: before.folded });
        setText(byId('assets-count'), String(model.assets.length));
        this.selected = undefined;
        // rebuilds all rows, because after a plant reload the same name may belong to another item
        this.list.renew(() => this.mark());
    }

    filter() {
        if (!this.tree)
            return;
        const rows = this.tree.rows(this.found);
        byId('assets-nothing').hidden = rows.length > 0;
        this.list.set(rows);
    }

    // --- selection

    mark() {
        const { selected = null } = this.session.params, tag = this.selection.tag;
        if (!this.tree || (selected === this.selected && tag === this.marked))
            return;
        const { model } = this.session, asset = model.asset(selected), chosen = model.tag(tag);
        const isNew = chosen !== null && tag !== this.marked, owner = isNew ? model.asset(chosen.asset) : asset;
        if (owner)
            this.tree.unfold(owner);
        if (asset || this.modules.there('about'))
            this.modules.use('about', (about) => about.show(), 'show');
        const reveal = isNew ? `tag/${chosen.index}` : asset && selected !== this.selected && `asset/${selected}`;
        Object.assign(this, { selected, marked: tag });
        this.filter();
        if (reveal)
            this.modules.use('rows', (rows) => rows.reveal(reveal), 'reveal');
    }

    // --- rows

    make(row) {
        const { kind, item } = row, key = keyOf(row);
        const twist = make('span', { class: 'twist', 'aria-hidden': 'true', onclick: (event) => {
            event.stopPropagation();
            this.does((rows) => rows.toggle(key));
        } });
        const common = { role: 'treeitem', 'aria-level': row.level, onclick: () => this.does((rows) => rows.act(key)) };
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
        const text = known ? valueText(group, number) : say('novalue');
        const unit = known ? ` ${unitText(tag.unit || group?.unit)}` : '';
        if (value.textContent !== text + unit)
            value.replaceChildren(text, make('i', {}, unit));
        value.classList.toggle('other', tag.group !== params.group);
        setQuality(element, quality);
        setAlarm(element, model.alarms.gravest(tag.index));
    }

    // Schedules one update of the rows in the next animation frame, however many messages arrive before it.
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
    const text = alarm ? `${alarm.kind} p${alarm.priority} ${alarm.state}` : '';
    if ((element.dataset.alarm ?? '') === text)
        return;
    element.dataset.alarm = text;
    const flag = alarm ? [limitFlag(alarm)] : [];
    element.querySelector('.flag').replaceChildren(...flag);
}

function setQuality(element, quality) {
    if (element.dataset.quality === quality)
        return;
    element.dataset.quality = quality;
    element.querySelector('.glyph').replaceWith(glyph(quality));
    put(element, 'aria-description', ['good', 'none'].includes(quality) ? null : say('assets.worst', { quality: qualityText(quality) }));
}
