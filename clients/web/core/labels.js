// SPDX-License-Identifier: GPL-3.0-or-later
// Which labels are shown beside their markers, and on which side: the important first, none over another.

const GAP_PX = 7;

const sides = {
    right: ({ x, y, width, height }) => ({ left: x + GAP_PX, top: y - height / 2 }),
    left: ({ x, y, width, height }) => ({ left: x - GAP_PX - width, top: y - height / 2 }),
    above: ({ x, y, width, height }) => ({ left: x - width / 2, top: y - GAP_PX - height }),
    below: ({ x, y, width, height }) => ({ left: x - width / 2, top: y + GAP_PX }),
};
const order = Object.keys(sides);

const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

// A grid, so that thousands of labels do not each look at all others.
class Taken {
    constructor(cell) {
        this.cell = cell;
        this.cells = new Map();
    }

    each(box, f) {
        for (let i = Math.floor(box.left / this.cell); i <= Math.floor(box.right / this.cell); i++) {
            for (let j = Math.floor(box.top / this.cell); j <= Math.floor(box.bottom / this.cell); j++)
                f(`${i},${j}`);
        }
    }

    add(box) {
        this.each(box, (key) => this.cells.set(key, [...(this.cells.get(key) ?? []), box]));
    }

    hits(box, but) {
        let hit = false;
        this.each(box, (key) => {
            hit = hit || (this.cells.get(key) ?? []).some((other) => other.owner !== but && overlap(box, other));
        });
        return hit;
    }
}

// items: { id, x, y (the marker), width, height, priority (larger first) }. Returns Map id -> { left, top, side }. The markers
// themselves stay free too, and the boxes in `blocked`. `before`, the last answer, keeps labels from jumping from side to side,
// and from giving way to equals.
export function placeLabels(items, { width, height, markerPx = 5, before = new Map(), blocked = [] }) {
    const taken = new Taken(96);
    for (const box of blocked)
        taken.add(box);
    for (const { id, x, y } of items)
        taken.add({ left: x - markerPx, right: x + markerPx, top: y - markerPx, bottom: y + markerPx, owner: id });
    const rank = (item) => item.priority + (before.has(item.id) ? 0.5 : 0);
    const placed = new Map();
    for (const item of [...items].sort((a, b) => rank(b) - rank(a) || (a.id < b.id ? -1 : 1))) {
        const last = before.get(item.id)?.side;
        for (const side of last ? [last, ...order.filter((s) => s !== last)] : order) {
            const { left, top } = sides[side](item);
            const box = { left, top, right: left + item.width, bottom: top + item.height, owner: item.id };
            if (left < 0 || top < 0 || box.right > width || box.bottom > height || taken.hits(box, item.id))
                continue;
            taken.add(box);
            placed.set(item.id, { left, top, side });
            break;
        }
    }
    return placed;
}

// The marker nearest to a place, within reach; null: none. Those in sight come before those behind something.
export function nearestMarker(markers, x, y, reachPx) {
    let best = null, bestRank = Infinity;
    for (const marker of markers) {
        const away = Math.hypot(marker.x - x, marker.y - y);
        const rank = away + (marker.occluded ? reachPx : 0);
        if (away <= reachPx && rank < bestRank) {
            best = marker;
            bestRank = rank;
        }
    }
    return best;
}
