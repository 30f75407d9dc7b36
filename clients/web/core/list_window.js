// SPDX-License-Identifier: GPL-3.0-or-later
// Computes which rows of a long list are visible and therefore must be in the document. Rows may differ in height.

// Returns the top edges of rows, computed from their heights: { tops }, a Float64Array with the total height as its last
// element.
export function stack(heights) {
    const tops = new Float64Array(heights.length + 1);
    heights.forEach((height, i) => { tops[i + 1] = tops[i] + height; });
    return tops;
}

// Returns the index of the row at a position in pixels.
export function rowAt(tops, y) {
    let low = 0, high = tops.length - 1;
    while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (tops[middle] <= y)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Returns the range [from, to) of the rows that can be seen, plus `more` rows on both sides.
export function rowsInSight(tops, scrollTop, height, more) {
    const count = tops.length - 1;
    return count === 0 ? [0, 0] : [Math.max(0, rowAt(tops, scrollTop) - more), Math.min(count, rowAt(tops, scrollTop + height) + 1 + more)];
}
