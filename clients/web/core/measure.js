// SPDX-License-Identifier: GPL-3.0-or-later
// A distance between two places that were picked on the plant.
import { numberText } from './format.js';
import { length, subtract } from './vector.js';

// { metres, level (along the ground), rise } from one place to the other; up: the plant's vertical, a unit vector.
export function measure(from, to, up) {
    const way = subtract(to, from), rise = way.reduce((sum, m, i) => sum + m * up[i], 0);
    const metres = length(way);
    return { metres, level: Math.sqrt(Math.max(0, metres ** 2 - rise ** 2)), rise };
}

// Millimetres for what is near: a tape shows no more of what is far.
export const metresText = (metres) => numberText(metres, Math.abs(metres) < 10 ? 3 : Math.abs(metres) < 100 ? 2 : 1);
