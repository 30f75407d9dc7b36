// SPDX-License-Identifier: GPL-3.0-or-later
// What a pointer is at: a half of the picture, a marker.
import { halves } from './split_view.js';

// The half in which a place of the picture lies.
export function halfAt(params, width, x) {
    const all = halves(params, width);
    return all.find((half) => x < half.left + half.width) ?? all[all.length - 1];
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
