// SPDX-License-Identifier: GPL-3.0-or-later
// The halves of a split view (protocol/PROTOCOL.md): the left half is floor(width / 2) pixels wide, the right half has the rest.

// Returns the halves as [{ params, left, width }], in whole pixels of the picture. A view that is not split has a single entry.
export function halves(params, width) {
    if (!params.split)
        return [{ params, left: 0, width }];
    const left = Math.floor(width / 2);
    return [{ params, left: 0, width: left }, { params: { ...params, ...params.split }, left, width: width - left }];
}
