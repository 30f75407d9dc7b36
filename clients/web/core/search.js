// SPDX-License-Identifier: GPL-3.0-or-later
// Search in the equipment list.

const known = new WeakMap(); // asset or tag -> its texts in lower case, in which the search looks for words
function textOf(item, ...texts) {
    if (!known.has(item))
        known.set(item, texts.filter(Boolean).join(' ').toLowerCase());
    return known.get(item);
}

// Returns a function that tests whether an asset matches the words in `wanted`, or null if `wanted` has no words. The function
// returns { asset, tags (to list), byTag (true: found by its tags) }, or null. All words must occur in the asset's own texts
// (then all its tags are listed), or in these and the texts of one tag.
export function search(wanted) {
    const words = wanted.toLowerCase().split(/\s+/).filter(Boolean);
    return words.length === 0 ? null : (asset) => {
        const text = textOf(asset, asset.id, asset.tag, asset.description, asset.area);
        if (words.every((word) => text.includes(word)))
            return { asset, tags: asset.tags, byTag: false };
        const has = (tag, word) => textOf(tag, tag.name, tag.description).includes(word) || text.includes(word);
        const tags = asset.tags.filter((tag) => words.every((word) => has(tag, word)));
        return tags.length > 0 ? { asset, tags, byTag: true } : null;
    };
}
