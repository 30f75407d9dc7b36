// SPDX-License-Identifier: GPL-3.0-or-later
// The tree of equipment as a list of rows: areas, assets, their tags, and tags without an asset. It also stores which rows are expanded.

// A row is { kind: area | asset | tag, level (depth in the tree), id, open (area or asset: it is expanded), item (the asset or tag), text
// (of an area), setSize, place (number of siblings and position among them, for screen readers) }.
export class Tree {
    // loose: heading under which the tags without equipment are listed
    constructor(model, loose) {
        this.folded = new Set(); // ids of collapsed areas
        this.open = new Set();   // ids of expanded assets
        const known = new Map();
        for (const asset of model.assets) {
            const area = asset.area ?? '';
            if (!known.has(area))
                known.set(area, []);
            known.get(area).push(asset);
        }
        this.areas = [...known].sort(([a], [b]) => Number(a === '') - Number(b === '') || a.localeCompare(b, undefined, { numeric: true }))
            .map(([name, assets]) => ({ name, assets }));
        const strays = model.tags.filter(({ asset }) => asset === null);
        if (strays.length > 0)
            this.areas.push({ name: '', assets: [{ id: null, tag: loose, description: '', tags: strays }] });
    }

    toggle({ kind, id, open }) {
        const set = kind === 'area' ? this.folded : this.open;
        if (open === (kind === 'area'))
            set.add(id);
        else
            set.delete(id);
    }

    // Expands an asset, and the area that contains it.
    unfold(asset) {
        this.open.add(asset.id);
        this.folded.delete(asset.area ?? '');
    }

    // Returns the rows of the equipment list. find(asset) is the search of search.js: it returns { asset, tags, byTag }, or
    // null for an asset to leave out. find null: no search is active.
    rows(find = null) {
        const rows = [];
        for (const { name, assets } of this.areas) {
            const found = assets.map(find ?? all).filter(Boolean);
            if (found.length === 0)
                continue;
            const level = name ? 1 : 0, open = find !== null || !this.folded.has(name);
            if (name)
                rows.push({ kind: 'area', level: 1, id: name, open, text: name, count: found.length });
            if (open)
                this.addAssets(rows, found, level + 1);
        }
        return rows;
    }

    addAssets(rows, found, level) {
        found.forEach(({ asset, tags, byTag }, i) => {
            const open = byTag || this.open.has(asset.id);
            const at = { setSize: found.length, place: i + 1 };
            rows.push({ kind: 'asset', level, id: asset.id, open: tags.length > 0 && open, item: asset, ...at });
            if (open)
                tags.forEach((tag, n) =>
                    rows.push({ kind: 'tag', level: level + 1, id: tag.index, item: tag, setSize: tags.length, place: n + 1 }));
        });
    }
}

const all = (asset) => ({ asset, tags: asset.tags, byTag: false });
