// SPDX-License-Identifier: GPL-3.0-or-later
// Finds what is under the pointer: which half of a split view, and which sensor marker.
import { halves } from './split_view.js';

// Returns the half of a split view at a position: 0 left, 1 right.
export function halfAt(params, width, x) {
    const all = halves(params, width);
    return all.find((half) => x < half.left + half.width) ?? all[all.length - 1];
}

// Returns the marker nearest to a position, at most reachPx away, or null. Visible markers take precedence over occluded ones.
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
