// SPDX-License-Identifier: GPL-3.0-or-later
// Decides which sensor labels are shown next to their markers, and where (protocol/LABELS.md).

// SPACINGS: minimum distances between labels, as fractions of the area's width, tried in this order; HELD: factor on spacing
// and depth for labels of the previous picture, which makes them tend to stay
const SPACINGS = [0.16, 0.08, 0];
export const HELD = 0.8;
const MARK = 5, NEAR_GAP = 8, DIAGONAL_GAP = 6, FAR_GAP = 22; // units
export const RING = 13;                       // distance in units of a label from the centre of its own alarm ring
// distance in units of labels from the centres of alarm rings that are not their own: 10 from the outer edge of the widest ring
const OTHER_RING = 25.5;
export const CLEARANCE = 3;
const ROOM = 0.06;                            // fraction of the picture's area that labels may fill
const MOST_CELLS = 1000;                      // maximum number of cells per side of the grid that finds occupied boxes
// slots (positions next to the marker) from FIRST_DIAGONAL on are diagonal, those from FIRST_FAR on are far and need a leader line
const FIRST_DIAGONAL = 8;
export const FIRST_FAR = 12;
export const RANK_RING = 3;
export const MOST_BAD = 12;

export const SLOTS = [ // side, upper edge in heights
    [1, -0.5], [-1, -0.5], [1, -1.3], [1, 0.3], [-1, -1.3], [-1, 0.3], [0, -1.9], [0, 0.9],
    [1, -1], [-1, -1], [1, 0], [-1, 0],
    [1, -2], [-1, -2], [1, 1], [-1, 1], [1, -3.2], [-1, -3.2], [1, 2.2], [-1, 2.2],
];

// Returns true if an area is finite and larger than 0x0; otherwise no labels are placed.
export const hasArea = ({ left, top, right, bottom }) => right > left && bottom > top && right - left < Infinity && bottom - top < Infinity;

// Returns the distance of a label's box from a point, or from a box around the point. across, down: half that box's width and height.
export const awayFrom = ({ x, y }, { left, top, right, bottom }, across = 0, down = 0) =>
    Math.hypot(Math.max(0, Math.max(left - x, x - right) - across), Math.max(0, Math.max(top - y, y - bottom) - down));

export const grow = ({ left, right, top, bottom }, by) => ({ left: left - by, right: right + by, top: top - by, bottom: bottom + by });

export const meets = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

// A grid of the occupied boxes, so that a new label is compared only with boxes near it, not with thousands.
class Taken {
    constructor(unit, area) {
        const size = Math.max(area.right - area.left, area.bottom - area.top);
        Object.assign(this, { area, unit, cell: Math.max(96 * unit, size / MOST_CELLS) });
        this.cells = new Map();
    }

    // Returns the keys of the grid cells that a box covers. Cells more than one beyond the area are left out, since labels are inside the
    // area.
    keys(box) {
        const keys = [], { cell, area } = this, from = (m, least) => Math.floor(Math.max(m - least, -cell) / cell);
        const to = (m, least, most) => Math.floor(Math.min(m - least, most - least + cell) / cell);
        for (let i = from(box.left, area.left), right = to(box.right, area.left, area.right); i <= right; i++) {
            for (let j = from(box.top, area.top), bottom = to(box.bottom, area.top, area.bottom); j <= bottom; j++)
                keys.push(i * 65536 + j);
        }
        return keys;
    }

    add(box) {
        for (const key of this.keys(box))
            this.cells.set(key, [...(this.cells.get(key) ?? []), box]);
    }

    // Returns true if the box meets an occupied one, or comes too close to an alarm ring. over: 1: markers without an alarm ring are
    // ignored; 0: no marker is. owner: item whose own marker is ignored. own: ids of the items whose rings the box may approach.
    meets(box, owner, over = 0, own = null) {
        return this.keys(box).some((key) => (this.cells.get(key) ?? []).some((other) =>
            other.owner !== owner && !(other.mark <= over) && meets(box, other) && (other.mark !== 2 || this.meetsRing(box, other, own))));
    }

    // Returns true if the box comes closer to an alarm ring than a label may.
    meetsRing(box, { x, y, owner }, own) {
        return awayFrom({ x, y }, box) < (own?.has(owner) ? RING : OTHER_RING) * this.unit;
    }
}

// Returns the box of a label in a slot (index in SLOTS: a candidate position around the marker). across, down: half the width and height of
// a group of markers around its centre; 0 for a single marker.
export function boxAt({ x, y, width, height, ring, across = 0, down = 0 }, slot, unit) {
    const [side, edge] = SLOTS[slot];
    const isDiagonal = slot >= FIRST_DIAGONAL && slot < FIRST_FAR;
    const gap = (isDiagonal ? DIAGONAL_GAP : slot < FIRST_FAR ? NEAR_GAP : FAR_GAP) * unit;
    const more = ring ? (RING - MARK) * unit : 0;
    const left = side > 0 ? x + across + gap + more : side < 0 ? x - across - gap - more - width : x - width / 2;
    const rise = Math.sign(edge + 0.5) * (more + down + (isDiagonal ? gap : 0));
    const top = y + edge * height + (side === 0 || isDiagonal ? rise : 0);
    return { left, top, right: left + width, bottom: top + height };
}

// Chooses labels and positions. all: items, one per marker, with these members. x, y: centre of the marker; width, height: size
// of its label. rank: importance, 0 to RANK_RING, higher ranks are placed first; below 0: no label. depth: distance from the
// eye; within a rank, the nearest is placed first. ring: the marker has an alarm ring. held: slot (candidate position around
// the marker) of the previous picture, or undefined. callout: id of the call-out (one label for several rings) in the previous
// picture. area: { left, top, right, bottom } that must contain the labels. rings: placeRings() of callouts.js, which places
// the labels of all rings. measure(items): returns the size of a call-out for these items. Returns a Map id -> { left, top,
// slot }; items with a ring also have width, height and callout (undefined: a label of its own), and in a call-out `leads`
// (true: a leader line connects label and ring).
export function placeLabels(all, { area, unit = 1, blocked = [], rings = null, measure = null }) {
    if (!hasArea(area) || !(unit > 0 && unit < Infinity))
        return new Map();
    const items = all.filter(({ x, y, width, height, depth }) => [x, y, width, height, depth].every(Number.isFinite));
    const wide = area.right - area.left, room = ROOM * wide * (area.bottom - area.top);
    const taken = new Taken(unit, area), placed = new Map(), centres = [];
    const clearance = CLEARANCE * unit;
    let used = 0;
    for (const box of blocked)
        taken.add(box);
    for (const { id, x, y, ring } of items) {
        const radius = (ring ? OTHER_RING : MARK) * unit;
        taken.add({ left: x - radius, right: x + radius, top: y - radius, bottom: y + radius, x, y, owner: id, mark: ring ? 2 : 1 });
    }
    const isHeld = (item) => item.held !== undefined && item.held !== null && item.held >= 0;
    const far = (item) => item.depth * (isHeld(item) ? HELD : 1);
    const order = items.map((item, index) => ({ item, index })).filter(({ item }) => item.rank >= 0)
        .sort((a, b) => b.item.rank - a.item.rank || far(a.item) - far(b.item) || a.index - b.index).map(({ item }) => item);

    const fits = (item, slot) => {
        const box = boxAt(item, slot, unit), more = isHeld(item) && slot === item.held ? 0 : clearance;
        const inside = box.left >= area.left && box.top >= area.top && box.right <= area.right && box.bottom <= area.bottom;
        return inside && !taken.meets(grow(box, more), item.id) ? box : null;
    };
    const place = (item) => {
        // tries the slot of the previous picture first, unless that was the slot of a call-out
        for (let n = isHeld(item) && item.held < SLOTS.length ? -1 : 0; n < SLOTS.length; n++) {
            const slot = n < 0 ? item.held : n, box = fits(item, slot);
            if (!box)
                continue;
            taken.add({ ...box, owner: item.id });
            placed.set(item.id, { left: box.left, top: box.top, slot });
            centres.push(item);
            used += item.width * item.height;
            return;
        }
    };
    const ringed = { area, unit, taken, blocked, rings: items.filter(({ ring }) => ring), measure };
    for (const { members, box, slot, leads } of rings?.(order.filter((item) => item.rank === RANK_RING), ringed) ?? []) {
        const callout = members.length > 1 ? members[0].id : undefined;
        taken.add({ ...box, owner: members[0].id });
        for (const item of members) {
            placed.set(item.id, { left: box.left, top: box.top, width: box.right - box.left, height: box.bottom - box.top, slot, callout,
                leads: leads?.has(item) });
            centres.push(item);
        }
        used += (box.right - box.left) * (box.bottom - box.top);
    }
    for (let rank = RANK_RING; rank >= 0; rank--) {
        const mine = order.filter((item) => item.rank === rank);
        for (const spacing of SPACINGS) {
            for (const item of mine) {
                const apart = spacing * wide * (isHeld(item) ? HELD : 1);
                if (placed.has(item.id) || (rank < 2 && used >= room) ||
                    centres.some((other) => Math.hypot(other.x - item.x, other.y - item.y) < apart))
                    continue;
                place(item);
            }
        }
    }
    return placed;
}

// Returns the leader line from the edge of a marker to the nearest point of its label: [x1, y1, x2, y2].
export function leaderLine({ x, y, width, height }, { left, top }, radius) {
    const to = [Math.max(left, Math.min(left + width, x)), Math.max(top, Math.min(top + height, y))];
    const away = Math.hypot(to[0] - x, to[1] - y) || 1;
    return [x + ((to[0] - x) * radius) / away, y + ((to[1] - y) * radius) / away, ...to];
}
