// SPDX-License-Identifier: GPL-3.0-or-later
// A long list of which only what is in sight is in the page, with one row that the keyboard is at.
import { rowsInSight, scrollTo, stack } from '../core/window.js';
import { make } from './dom.js';

const MORE = 8; // rows beyond both edges

export class LongList {
    // make(row): its element; fill(row, element): what changes in it; height(row) in CSS pixels; keyOf(row): what it is; onKey(key,
    // row, i): whether that was for it. The element `root` scrolls.
    constructor({ root, make: build, fill, height, keyOf, onKey }) {
        Object.assign(this, { root, build, fill, height, keyOf, onKey, rows: [], tops: stack([]), shown: new Map(), active: null });
        this.space = make('div', { role: 'none', class: 'space' });
        root.append(this.space);
        root.addEventListener('scroll', () => this.show(), { passive: true });
        root.addEventListener('keydown', (event) => this.keyDown(event));
        root.addEventListener('focusin', ({ target }) => {
            const key = target.closest('[data-row]')?.dataset.row;
            if (key && key !== this.active)
                this.at(this.rows.findIndex((row) => keyOf(row) === key), false);
        });
        new ResizeObserver(() => this.show()).observe(root);
    }

    // Elements stay those of their rows.
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
            wanted.add(this.places.get(this.active)); // or the keyboard would lose its place
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

    // The row that is at a place from now on; null: none is there.
    at(i, focus = true) {
        if (!this.rows[i])
            return;
        this.active = this.keyOf(this.rows[i]);
        this.root.scrollTop = scrollTo(this.tops, i, this.root.scrollTop, this.root.clientHeight);
        this.show();
        if (focus)
            this.shown.get(this.active).focus({ preventScroll: true });
    }

    reveal(key) {
        const i = this.places?.get(key);
        if (i !== undefined)
            this.at(i, this.root.contains(document.activeElement));
    }

    keyDown(event) {
        const i = this.places?.get(this.active), last = this.rows.length - 1;
        const page = Math.max(1, Math.floor(this.root.clientHeight / this.height(this.rows[i] ?? {})) - 1);
        const steps = {
            ArrowDown: i + 1, ArrowUp: i - 1, Home: 0, End: last, PageDown: Math.min(last, i + page), PageUp: Math.max(0, i - page),
        };
        if (event.ctrlKey || event.altKey || event.metaKey || i === undefined)
            return;
        if (steps[event.key] !== undefined)
            this.at(steps[event.key]);
        else if (!this.onKey(event.key, this.rows[i], i))
            return;
        event.preventDefault();
        event.stopPropagation(); // the plant stands still meanwhile
    }
}
