// SPDX-License-Identifier: GPL-3.0-or-later
// A distance between two places that were picked on the plant.
import { numberText } from './format.js';
import { length, subtract } from './vector.js';

// Measures from one point to another: { metres, level (horizontal distance), rise (vertical) }. up: unit vector of the plant's vertical.
export function measure(from, to, up) {
    const way = subtract(to, from), rise = way.reduce((sum, m, i) => sum + m * up[i], 0);
    const metres = length(way);
    return { metres, level: Math.sqrt(Math.max(0, metres ** 2 - rise ** 2)), rise };
}

// Formats metres; short distances with millimetres.
export const metresText = (metres) => numberText(metres, Math.abs(metres) < 10 ? 3 : Math.abs(metres) < 100 ? 2 : 1);

// Formats a long distance with its unit, in kilometres from 10 km.
export const farText = (metres) => (metres < 1e4 ? `${numberText(metres, metres < 10 ? 2 : 0)} m` : `${numberText(metres / 1e3, 0)} km`);
