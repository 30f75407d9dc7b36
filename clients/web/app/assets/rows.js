// SPDX-License-Identifier: GPL-3.0-or-later
// Pointer, keyboard and search in the equipment list: moving between rows, expanding, selecting, and flying to an item.
import { scrollTo } from '../../core/scroll.js';
import { search } from '../../core/search.js';
import { narrow } from '../startup.js';

export class Rows {
    constructor({ modules, selectAsset, showTag }) {
        Object.assign(this, { assets: modules.there('assets'), selectAsset, showTag });
        this.list = this.assets.list;
    }

    // Returns the index of the row with this key; undefined if there is none.
    placeOf(key) {
        return this.list.places?.get(key);
    }

    rowOf(key) {
        return this.list.rows[this.placeOf(key)];
    }

    search() {
        this.assets.found = search(this.assets.search.value);
        this.assets.filter();
    }

    toggle(key) {
        const row = this.rowOf(key);
        if (row)
            this.assets.tree.toggle(row);
        this.assets.filter();
    }

    act(key) {
        const { kind, item } = this.rowOf(key) ?? {};
        if (kind === 'tag') {
            this.showTag(item);
        } else if (!item?.id) {
            this.toggle(key);
        } else {
            this.selectAsset(item);
            if (narrow.matches)
                this.assets.setOpen(false);
        }
    }

    // Makes row i the active row and scrolls to it; no-op if there is no such row.
    goTo(i, focus = true) {
        const { list } = this, row = list.rows[i];
        if (!row)
            return;
        list.active = list.keyOf(row);
        list.root.scrollTop = scrollTo(list.tops, i, list.root.scrollTop, list.root.clientHeight);
        list.show();
        if (focus)
            list.shown.get(list.active).focus({ preventScroll: true });
    }

    // Makes the row with this key the active row, because it has received the keyboard focus.
    isAt(key) {
        if (key !== this.list.active)
            this.goTo(this.placeOf(key), false);
    }

    reveal(key) {
        this.goTo(this.placeOf(key), this.list.root.contains(document.activeElement));
    }

    // Handles arrow keys: right expands a row or moves into it, left collapses a row or moves to its parent.
    press(key) {
        const { rows, root, active, height } = this.list, i = this.placeOf(active), last = rows.length - 1;
        if (i === undefined)
            return;
        const row = rows[i], hasRows = row.kind !== 'tag', page = Math.max(1, Math.floor(root.clientHeight / height(row)) - 1);
        const steps = {
            ArrowDown: i + 1, ArrowUp: i - 1, Home: 0, End: last, PageDown: Math.min(last, i + page), PageUp: Math.max(0, i - page),
            ArrowRight: rows[i + 1]?.level > row.level ? i + 1 : i,
            ArrowLeft: rows.findLastIndex((one, n) => n < i && one.level < row.level),
        };
        const turns = (key === 'ArrowRight' && !row.open) || (key === 'ArrowLeft' && row.open);
        if (key === 'Enter' || key === ' ')
            this.act(active);
        else if (hasRows && turns)
            this.toggle(active);
        else
            this.goTo(steps[key]);
    }
}
