// SPDX-License-Identifier: GPL-3.0-or-later
// Scroll position of a virtual list (list_window.js).

// Returns the scroll position nearest to the present one that shows the whole row.
export function scrollTo(tops, row, scrollTop, height) {
    if (tops[row] < scrollTop)
        return tops[row];
    return tops[row + 1] > scrollTop + height ? tops[row + 1] - height : scrollTop;
}
