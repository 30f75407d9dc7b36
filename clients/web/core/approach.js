// SPDX-License-Identifier: GPL-3.0-or-later
// Computes cameras that look at a sensor, the best first; app/input/approach.js tries them in this order.
import { face, orbit } from './camera_moves.js';
import { subtract } from './vector.js';

const LEAST_M = 5, MOST_M = 12, PART = 1.1;
const TURNS = [ // degrees: about the vertical, up
    [0, 0], [35, 0], [-35, 0], [0, 30], [70, 0], [-70, 0], [35, 30], [-35, 30], [0, 55], [110, 0], [-110, 0], [0, -20], [145, 0], [-145, 0],
    [180, 0], [70, 30], [-70, 30], [180, 30], [50, -20], [-50, -20], [0, -45], [90, -45], [-90, -45], [180, -45],
];

// Returns a distance from which equipment with these bounds can be recognised. It depends on the second longest side, since pipes and
// columns are long.
export function approachDistance({ min, max }) {
    const [, middle] = subtract(max, min).sort((a, b) => a - b);
    return PART * middle < MOST_M ? Math.max(LEAST_M, PART * middle) : MOST_M;
}

// Returns copies of a camera, each turned about a point by another angle.
export const sidesOf = (first, point) => TURNS.map(([azimuth, rise]) => orbit(first, azimuth, rise, point));

// Returns the cameras to try, in order, for a point on equipment with these bounds.
export const approaches = (camera, point, bounds) => sidesOf(face(camera, point, bounds, approachDistance(bounds)), point);
