// SPDX-License-Identifier: GPL-3.0-or-later
// Thins out sensor markers where they are dense (protocol/LABELS.md).

// At most MOST markers are drawn within NEAR CSS pixels (more on a video wall) of each other. For a marker that was drawn in
// the previous picture, NEAR is multiplied by HELD, so that such a marker tends to stay.
const MOST = 6, NEAR = 30, HELD = 0.8;

// items: { x, y, depth, occluded, kept (always drawn), held (drawn in the previous picture) }. Returns the items to draw, in the same
// order.
export function thinOut(items, unit = 1) {
    const cell = NEAR * unit, cells = new Map(), drawn = new Set(items.filter(({ kept }) => kept));
    const key = ({ x, y }) => Math.floor(x / cell) * 65536 + Math.floor(y / cell);
    const put = (item) => {
        const at = key(item), there = cells.get(at);
        if (there)
            there.push(item);
        else
            cells.set(at, [item]);
    };
    const isCrowded = (item) => {
        const { x, y, held } = item, middle = key(item), least = (cell * (held ? HELD : 1)) ** 2;
        let count = 0;
        for (let i = -65536; i <= 65536; i += 65536) {
            for (let k = -1; k <= 1; k++) {
                for (const other of cells.get(middle + i + k) ?? []) {
                    if ((other.x - x) ** 2 + (other.y - y) ** 2 < least && ++count === MOST)
                        return true;
                }
            }
        }
        return false;
    };
    drawn.forEach(put);
    const others = items.filter(({ kept }) => !kept); // sort() is stable, so that equal markers stay in the order of `items`
    others.sort((a, b) => a.occluded - b.occluded || b.held - a.held || a.depth - b.depth);
    for (const item of others) {
        if (!isCrowded(item)) {
            put(item);
            drawn.add(item);
        }
    }
    return items.filter((item) => drawn.has(item));
}
