// SPDX-License-Identifier: GPL-3.0-or-later
// Shift notes: their position in the plant, and until when they are valid.

// Returns [x, y, z], or null if the note's tag or equipment is no longer in this plant.
export function placeOf(model, { position, tag, asset }) {
    if (position || tag)
        return position ?? model.tag(tag)?.position ?? null;
    const { min, max } = model.asset(asset)?.bounds ?? {};
    return min ? [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, max[2]] : null;
}

// Returns the name of the note's tag or equipment; null: it is at a point.
export const whereOf = (model, { tag, asset }) => tag ?? (asset ? model.asset(asset)?.tag || asset : null);

// Returns the notes that are in force now; with atUs (an instant of the past that is shown), the notes that were in force then.
export const inForce = (notes, nowUs, atUs = null) => notes.filter(({ time_us: from, until_us: until, ended_us: ended }) => (atUs === null
    ? until === 0 || nowUs === null || until > nowUs
    : from <= atUs && (!until || until > atUs) && (!ended || ended > atUs)));
