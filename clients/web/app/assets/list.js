// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual list: only the rows in sight are in the document. One row is active: keys act on it (rows.js).
import { rowsInSight, stack } from '../../core/list_window.js';
import { make } from '../common/dom.js';

const MORE = 8; // number of extra rows in the document above and below the visible ones, so that scrolling shows them at once

export class LongList {
    // make(row) creates the element of a row, fill(row, element) updates its content, height(row) returns CSS pixels, keyOf(row) returns a
    // key that identifies the row. The element `root` scrolls.
    constructor({ root, make: build, fill, height, keyOf }) {
        Object.assign(this, { root, build, fill, height, keyOf, rows: [], tops: stack([]), shown: new Map(), active: null });
        this.space = make('div', { role: 'none', class: 'space' });
        root.append(this.space);
        root.addEventListener('scroll', () => this.show(), { passive: true });
        new ResizeObserver(() => this.show()).observe(root);
    }

    // Builds the elements of all rows again, not only of changed rows; keeps scroll position and focus. change(): a function of
    // the caller that sets the rows with set().
    renew(change) {
        const { root } = this, hasFocus = root.contains(document.activeElement);
        this.space.replaceChildren();
        this.shown.clear();
        change();
        if (hasFocus)
            this.shown.get(this.active)?.focus({ preventScroll: true });
    }

    // Sets the rows. A row with the key of an earlier row reuses that row's element.
    set(rows) {
        this.rows = rows;
        this.tops = stack(rows.map(this.height));
        this.space.style.height = `${this.tops.at(-1)}px`;
        this.places = new Map(rows.map((row, i) => [this.keyOf(row), i]));
        if (!this.places.has(this.active))
            this.active = rows.length > 0 ? this.keyOf(rows[0]) : null;
        this.show();
    }

    show() {
        const { root, tops } = this;
        const [from, to] = rowsInSight(tops, root.scrollTop, root.clientHeight, MORE), wanted = new Set();
        for (let i = from; i < to; i++)
            wanted.add(i);
        if (this.active !== null)
            // the active row keeps its element even out of sight, because keyboard users would otherwise lose their position
            wanted.add(this.places.get(this.active));
        const before = this.shown;
        this.shown = new Map();
        for (const i of [...wanted].sort((a, b) => a - b))
            this.place(i, before);
        for (const element of before.values())
            element.remove();
    }

    place(i, before) {
        const row = this.rows[i], key = this.keyOf(row);
        let element = before.get(key);
        before.delete(key);
        if (!element) {
            element = this.build(row);
            element.dataset.row = key;
            this.space.append(element);
        }
        this.shown.set(key, element);
        element.tabIndex = key === this.active ? 0 : -1;
        element.style.transform = `translateY(${this.tops[i]}px)`;
        this.fill(row, element);
    }
}
