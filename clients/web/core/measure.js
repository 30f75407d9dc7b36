// SPDX-License-Identifier: GPL-3.0-or-later
// Measures distances between two points that the user picked on the plant.
import { numberText } from './format.js';
import { length, subtract } from './vector.js';

// Returns { metres, level (horizontal distance), rise (vertical distance) } from one point to another. up: unit vector of the plant's
// vertical.
export function measure(from, to, up) {
    const way = subtract(to, from), rise = way.reduce((sum, m, i) => sum + m * up[i], 0);
    const metres = length(way);
    return { metres, level: Math.sqrt(Math.max(0, metres ** 2 - rise ** 2)), rise };
}

// Formats a distance in metres, to the millimetre if it is short.
export const metresText = (metres) => numberText(metres, Math.abs(metres) < 10 ? 3 : Math.abs(metres) < 100 ? 2 : 1);

// Formats a long distance with its unit: km from 10 km on, else m.
export const farText = (metres) => (metres < 1e4 ? `${numberText(metres, metres < 10 ? 2 : 0)} m` : `${numberText(metres / 1e3, 0)} km`);
