// SPDX-License-Identifier: GPL-3.0-or-later
// The table of tags with their matches (tag to asset): the user filters it, makes decisions by pointer or keyboard, and saves
// them.
import { FILTERS, Matches, patternOf, readMatches } from '../../core/matches.js';
import { rowAt } from '../../core/list_window.js';
import { scrollTo } from '../../core/scroll.js';
import { say } from '../../core/words.js';
import { LongList } from '../assets/list.js';
import { make, setText } from '../common/dom.js';
import { fill } from '../common/widgets.js';

const ROW_PX = 44, ROOM = 1.9, AROUND_M = 1, MOST_AROUND = 20;
const union = (boxes) => ({
    min: [0, 1, 2].map((i) => Math.min(...boxes.map(({ min }) => min[i]))),
    max: [0, 1, 2].map((i) => Math.max(...boxes.map(({ max }) => max[i]))),
});

const meet = (a, b, m) => [0, 1, 2].every((i) => a.min[i] < b.max[i] + m && b.min[i] < a.max[i] + m);

export class TagTable {
    // save(): sends the decisions.
    constructor({ page, highlights, save }) {
        Object.assign(this, { page, highlights, save, filter: 'all', chosen: null, shown: null });
        this.matches = new Matches((name) => this.isPlaced(name));
        this.build();
    }

    build() {
        const button = (key, onclick) => make('button', { type: 'button', onclick }, say(key));
        this.counts = Object.fromEntries(FILTERS.map((filter) => [filter, make('b', {})]));
        const choice = (filter) => make('label', {}, make('input', { type: 'radio', name: 'import-filter', value: filter,
            checked: filter === 'all', onchange: () => this.setFilter(filter) }),
        make('span', {}, this.counts[filter], say(`import.filter.${filter}`)));
        this.find = make('input', { type: 'search', placeholder: say('import.find'), 'aria-label': say('import.find'),
            oninput: () => this.refresh() });
        this.root = make('div', { class: 'table', role: 'listbox', 'aria-label': say('import.tags'),
            onkeydown: (event) => this.press(event) });
        this.list = new LongList({ root: this.root, make: (row) => this.makeRow(row), fill: (row, element) => this.fillRow(row, element),
            height: () => ROW_PX, keyOf: ({ tag }) => tag });
        this.detail = make('div', { class: 'detail' });
        this.count = make('span', { role: 'status' });
        this.keep = button('named.save', () => this.save());
        this.back = button('import.undo', () => this.forget());
        this.element = make('section', { class: 'matching', hidden: true }, make('h3', {}, say('import.tags')),
            make('fieldset', { class: 'segments' }, make('legend', {}, say('import.filter')), ...FILTERS.map(choice)), this.find, this.root,
            make('p', { class: 'quiet' }, say('import.keys')), this.detail,
            make('div', { class: 'line' }, this.count, this.back, this.keep));
    }

    // Returns true if the sensor of this name has a position of its own, false if only its equipment is known, so that its
    // position is assumed; null if the tag is not a sensor on equipment.
    isPlaced(name) {
        const tag = this.page.session.model?.tag(name);
        return tag?.asset && tag.group ? Boolean(tag.position) && tag.place !== 'equipment' : null;
    }

    set(text) {
        this.matches.set(readMatches(text));
        this.element.hidden = this.matches.all.length === 0;
        this.chosen = this.matches.all.find(({ tag }) => tag === this.chosen?.tag) ?? null;
        this.light(); // redraws the boxes of the assets that the tag may belong to, because a plant reload may have changed them
        this.list.renew(() => this.refresh());
    }

    setBusy(busy) {
        this.busy = busy;
        this.showDecisions();
    }

    forget() {
        this.matches.decisions.clear();
        this.refresh();
    }

    // Marks decisions about tags' assets as saved. decided: the decisions that the server has saved.
    settle(decided) {
        this.matches.settle(decided);
        this.refresh();
    }

    setFilter(filter) {
        this.filter = filter;
        this.refresh();
    }

    refresh() {
        const counts = this.matches.counts();
        for (const filter of FILTERS)
            setText(this.counts[filter], String(counts[filter]));
        this.list.set(this.matches.rows(this.filter, this.find.value));
        this.showDetail();
        this.showDecisions();
    }

    showDecisions() {
        const count = this.matches.decisions.size;
        setText(this.count, count > 0 ? say('import.decided', { count }) : '');
        this.keep.disabled = this.back.disabled = count === 0 || this.busy;
    }

    // --- rows

    makeRow(row) {
        return make('div', { role: 'option', class: 'row', onclick: () => this.choose(row),
            onfocus: () => { this.list.active = row.tag; } },
            make('i', {}), make('b', {}, row.tag), make('span', { class: 'on' }), make('span', { class: 'why' }));
    }

    fillRow(row, element) {
        const now = this.matches.of(row), [sign, , asset, why] = element.children;
        const kind = this.matches.fits(row, 'unplaced') ? 'unplaced' : this.matches.kindOf(row);
        element.dataset.kind = kind;
        element.classList.toggle('decided', this.matches.decisions.has(row.tag));
        element.setAttribute('aria-selected', row === this.chosen);
        setText(sign, say(`import.sign.${kind}`));
        sign.title = say(`import.filter.${kind}`);
        setText(asset, now.asset || (kind === 'likely' ? row.candidates.join(', ') : '–'));
        setText(why, this.reasonOf(row));
    }

    reasonOf(row) {
        return this.matches.decisions.has(row.tag) || row.reason === 'by hand' ? say('import.byhand') : row.reason;
    }

    // Selects a row and highlights the assets that its tag may belong to, the matched or most likely one first.
    choose(row) {
        this.chosen = row;
        this.goTo(this.list.places.get(row.tag));
        this.light(true);
        this.refresh();
        this.detail.scrollIntoView({ block: 'nearest' });
    }

    candidatesOf(row) {
        const { model } = this.page.session, now = this.matches.of(row);
        return [...new Set([now.asset, ...row.candidates])].map((id) => model.asset(id)).filter(Boolean);
    }

    light(flies = false) {
        const assets = this.chosen && this.element.offsetParent !== null ? this.candidatesOf(this.chosen) : [];
        this.highlights.show({ assets });
        if (assets.length > 0 && flies)
            this.page.modules.use('cameraController', (controller) =>
                controller.flyToBox(union(assets.map(({ bounds }) => bounds)), ROOM), 'lit');
    }

    goTo(i) {
        const { list } = this, row = list.rows[i];
        if (!row)
            return;
        list.active = row.tag;
        list.root.scrollTop = scrollTo(list.tops, i, list.root.scrollTop, list.root.clientHeight);
        list.show();
        list.shown.get(row.tag)?.focus({ preventScroll: true });
    }

    // Handles the keys of the table: letters for decisions, digits to choose an asset.
    press(event) {
        if (event.ctrlKey || event.altKey || event.metaKey)
            return;
        const { list, chosen } = this, i = list.places?.get(list.active) ?? 0, page = rowAt(list.tops, list.root.clientHeight);
        const steps = { ArrowDown: i + 1, ArrowUp: i - 1, Home: 0, End: list.rows.length - 1, PageDown: i + page, PageUp: i - page };
        const number = /^[1-8]$/.test(event.key) ? Number(event.key) : 0;
        if (event.key in steps)
            this.chooseAt(steps[event.key]);
        else if (event.key === ' ')
            this.chooseAt(i);
        else if (chosen && event.key === 'Enter')
            this.accept(this.matches.of(chosen).asset || chosen.candidates[0]);
        else if (chosen && number > 0 && this.candidatesOf(chosen)[number - 1])
            this.accept(this.candidatesOf(chosen)[number - 1].id);
        else if (chosen && event.key.toLowerCase() === 'a')
            this.acceptAlike();
        else if (chosen && event.key.toLowerCase() === 'n')
            this.accept('');
        else if (chosen && event.key.toLowerCase() === 'p')
            this.place();
        else
            return;
        event.preventDefault();
        event.stopPropagation(); // stops the event here, because the key would also move the camera
    }

    chooseAt(i) {
        const row = this.list.rows[Math.max(0, Math.min(this.list.rows.length - 1, i))];
        if (row)
            this.choose(row);
    }

    // --- deciding

    // Accepts the asset for the selected row, and selects the next row, because the filter may hide this one.
    accept(asset) {
        if (asset === undefined)
            return;
        const i = this.list.places.get(this.chosen.tag), { rows } = this.list, next = rows[i + 1] ?? rows[i - 1] ?? null;
        this.matches.decide(this.chosen, asset);
        if (this.matches.fits(this.chosen, this.filter) || !next) {
            this.light();
            this.refresh();
        } else {
            this.refresh();
            this.choose(next);
        }
    }

    acceptAlike() {
        for (const [match, asset] of this.matches.alike(this.chosen))
            this.matches.decide(match, asset);
        this.light();
        this.refresh();
    }

    // Isolates one asset so that clicks hit only this asset: its neighbours become transparent, and all else is hidden.
    showAlone(id) {
        const { session } = this.page, { model, params } = session, asset = model.asset(id);
        if (!asset)
            return;
        const around = model.assets.filter((other) => other !== asset && meet(other.bounds, asset.bounds, AROUND_M));
        this.showAgain();
        this.shown = { isolate: params.isolate ?? [], ghost: params.ghost ?? [], alone: id };
        session.setParams({ isolate: [id], ghost: around.slice(0, MOST_AROUND).map((other) => other.id) });
    }

    // Restores what was shown before showAlone(), unless the user has changed it since.
    showAgain() {
        const { session } = this.page, { isolate = [], ghost, alone } = this.shown ?? {};
        this.shown = null;
        if (alone && session.params.isolate?.length === 1 && session.params.isolate[0] === alone)
            session.setParams({ isolate, ghost });
    }

    // Opens the engineering panel, in which the user places the tag on its equipment.
    place() {
        const tag = this.page.session.model.tag(this.chosen.tag);
        if (!tag?.group)
            return;
        this.highlights.show({ assets: [] });
        this.showAlone(tag.asset);
        this.page.modules.use('engineer', (engineer) => {
            if (!engineer.open)
                engineer.toggle();
            engineer.take('place');
            if (engineer.parts.place.tag !== tag.name)
                engineer.parts.place.choose(tag);
        });
    }

    showDetail() {
        const { chosen, page } = this, { session } = page;
        this.detail.hidden = !chosen;
        if (!chosen)
            return;
        const now = this.matches.of(chosen), alike = this.matches.alike(chosen), selected = session.params.selected;
        const button = (text, onclick, more = {}) => make('button', { type: 'button', onclick, ...more }, text);
        const assets = this.candidatesOf(chosen), tag = session.model.tag(chosen.tag);
        const other = selected && !assets.some(({ id }) => id === selected) ? selected : null;
        fill(this.detail, make('h4', {}, chosen.tag), tag?.description ? make('p', {}, tag.description) : null,
            make('p', { class: 'quiet' }, this.reasonOf(chosen)),
            make('div', { class: 'candidates' }, ...assets.map(({ id, description }, i) => button([`${i + 1}  ${id}`, description]
                .filter(Boolean).join(' · '), () => this.accept(id), {
                'aria-pressed': String(now.status === 'sure' && now.asset === id) })),
            other ? button(say('import.selected', { asset: other }), () => this.accept(other)) : null),
            make('div', { class: 'line' },
                alike.length > 1 ? button(say('import.alike', { pattern: patternOf(chosen.tag), count: alike.length }),
                    () => this.acceptAlike()) : null,
                now.status === 'none' ? null : button(say('import.off'), () => this.accept('')),
                tag?.group ? button(say('import.place'), () => this.place()) : null),
            other || assets.length > 0 ? null : make('p', { class: 'quiet' }, say('import.choose')));
    }
}
