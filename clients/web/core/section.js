// SPDX-License-Identifier: GPL-3.0-or-later
// Section planes and boxes along the axes, and which assets are hidden, transparent or isolated.

export const AXES = ['x', 'y', 'z'];

// Returns a clip plane across an axis at a position in metres. The plane keeps the side of larger coordinates; turned true: the other side.
export function cut(axis, at, turned) {
    const plane = [0, 0, 0, turned ? at : -at];
    plane[AXES.indexOf(axis)] = turned ? -1 : 1;
    return { planes: [plane] };
}

// Returns { axis, at, turned } of a clip that cut() made; null for other clips.
export function readCut(clip) {
    const plane = clip?.planes?.length === 1 ? clip.planes[0] : null;
    const index = plane ? plane.slice(0, 3).findIndex((n) => Math.abs(n) === 1) : -1;
    if (index < 0)
        return null;
    const turned = plane[index] < 0;
    return { axis: AXES[index], at: turned ? plane[3] : -plane[3], turned };
}

// Returns a clip box with the same centre as the bounds. part: ratio of the box's sides to those of the bounds.
export function boxAround({ min, max }, part) {
    const side = (i, turn) => (min[i] + max[i]) / 2 + (turn * part * (max[i] - min[i])) / 2;
    return { box: { min: [0, 1, 2].map((i) => side(i, -1)), max: [0, 1, 2].map((i) => side(i, 1)) } };
}

// Returns the `part` with which boxAround() made a box; null for other clips, and for boxes that the user dragged to another
// shape.
export function readBox(clip, bounds) {
    if (!clip?.box)
        return null;
    const lengths = bounds.max.map((high, i) => high - bounds.min[i]), most = Math.max(...lengths), longest = lengths.indexOf(most);
    const part = (clip.box.max[longest] - clip.box.min[longest]) / most, { box } = boxAround(bounds, part);
    const near = (name) => box[name].every((m, i) => Math.abs(m - clip.box[name][i]) < 1e-4 * most);
    return near('min') && near('max') ? part : null;
}

const without = (list, id) => (list ?? []).filter((other) => other !== id);

// Returns the parameters after the user pressed the button `how` (hide, ghost, only) of an asset. A second press undoes the first.
export function showAsset(params, how, id) {
    const name = { hide: 'hidden', ghost: 'ghost', only: 'isolate' }[how];
    const was = (params[name] ?? []).includes(id);
    const change = { hidden: without(params.hidden, id), ghost: without(params.ghost, id), isolate: without(params.isolate, id) };
    if (!was)
        change[name] = how === 'only' ? [id] : [...change[name], id];
    return Object.fromEntries(Object.entries(change).filter(([key, list]) => list.join('\n') !== (params[key] ?? []).join('\n')));
}

export function showAll(params) {
    const sets = ['hidden', 'ghost', 'isolate'].filter((name) => params[name]?.length > 0);
    return Object.fromEntries(sets.map((name) => [name, []]));
}
