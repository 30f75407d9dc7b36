// SPDX-License-Identifier: GPL-3.0-or-later
// Scroll position of a virtual list (list_window.js).

// Returns a scroll position at which a row is completely visible; the present one if it is.
export function scrollTo(tops, row, scrollTop, height) {
    if (tops[row] < scrollTop)
        return tops[row];
    return tops[row + 1] > scrollTop + height ? tops[row + 1] - height : scrollTop;
}
