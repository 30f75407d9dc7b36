// SPDX-License-Identifier: GPL-3.0-or-later
// Where a long list (list_window.js) is scrolled to.

// Where to scroll so that a row is wholly seen; unchanged where it is.
export function scrollTo(tops, row, scrollTop, height) {
    if (tops[row] < scrollTop)
        return tops[row];
    return tops[row + 1] > scrollTop + height ? tops[row + 1] - height : scrollTop;
}
