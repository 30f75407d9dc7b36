// SPDX-License-Identifier: GPL-3.0-or-later
// Which rows of a long list are to be there for what is seen of it. Rows may differ in height.

// heights: of each row. Returns { tops: Float64Array with one more, the total at its end }.
export function stack(heights) {
    const tops = new Float64Array(heights.length + 1);
    heights.forEach((height, i) => { tops[i + 1] = tops[i] + height; });
    return tops;
}

// The row that a place lies in.
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

// [from, to): the rows in sight, and some more on both sides.
export function rowsInSight(tops, scrollTop, height, more) {
    const count = tops.length - 1;
    return count === 0 ? [0, 0] : [Math.max(0, rowAt(tops, scrollTop) - more), Math.min(count, rowAt(tops, scrollTop + height) + 1 + more)];
}
