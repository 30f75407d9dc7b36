// SPDX-License-Identifier: GPL-3.0-or-later
// Computes cameras that look at a sensor, the best first; app/input/approach.js tries them in this order.
import { isParallel, projector, validOr } from './camera.js';
import { corners, distance, face, orbit } from './camera_moves.js';
import { along, dot, length, subtract, unit } from './vector.js';

// The camera's distance from a sensor is the larger of PART times the middle side and LONG_PART times the longest side of the bounding box
// of the sensor's equipment.
const PART = 1.1, LONG_PART = 0.7;
const LEAST_M = 0.2, MOST_M = 16; // minimum and maximum distance of the camera in plants of usual size, in metres
// minimum and maximum distance of the camera in very small and very large plants, as fractions of the plant's diagonal
const LEAST_PART = 1 / 200, MOST_PART = 1 / 20;
const FILL = 0.42; // fraction of the picture that the equipment's box fills, unless the bounds of the distance prevent it
// A side of the equipment is narrow if the camera would have to come very near for that side to fill the fraction FILL of the
// picture: nearer than NARROW times the largest distance of the first FRONT cameras. Narrow sides are tried last because they
// show little: of a pump, only the motor's fan cover.
const NARROW = 0.75, FRONT = 9;
// A plate seen edge-on is a line, although its bounding rectangle may be large. Sides from which the equipment's box covers
// less than EDGE times its largest silhouette are therefore also tried last.
const EDGE = 0.4;
const STEPS = 16;  // bisections of the distance
const TURNS = [ // degrees: about the vertical, up
    [0, 0], [35, 0], [-35, 0], [0, 30], [70, 0], [-70, 0], [35, 30], [-35, 30], [0, 55], [110, 0], [-110, 0], [0, -20], [145, 0], [-145, 0],
    [180, 0], [70, 30], [-70, 30], [180, 30], [50, -20], [-50, -20], [0, -45], [90, -45], [-90, -45], [180, -45],
];

// Returns the bounds { least, most } of a camera's distance from a sensor, in metres. The argument is the plant's bounds.
export function distanceBounds({ min, max }) {
    const size = length(subtract(max, min));
    return { least: Math.min(LEAST_M, size * LEAST_PART), most: Math.max(MOST_M, size * MOST_PART) };
}

// Returns the largest distance from which equipment with these bounds can be recognised. It depends on the box's middle side,
// because pipes and columns are long.
export function approachDistance({ min, max }, { least, most }) {
    const [, medium, longest] = subtract(max, min).sort((a, b) => a - b);
    const wanted = Math.max(PART * medium, LONG_PART * longest);
    return wanted < most ? Math.max(least, wanted) : most;
}

// Returns the fraction of the picture (0 to 1) filled by the bounding rectangle of a projected box. A box that reaches behind
// the camera counts as 1.
export function fillOf(camera, box, aspect) {
    const places = corners(box).map(projector(camera, aspect, 1));
    if (places.includes(null))
        return 1;
    const span = (axis, whole) => {
        const all = places.map((place) => Math.max(0, Math.min(whole, place[axis])));
        return (Math.max(...all) - Math.min(...all)) / whole;
    };
    return span(0, aspect) * span(1, 1) || 0; // in a picture of 0x0 pixels, the fraction is NaN: returns 0
}

// Returns the silhouette of a box in the camera's direction, as a fraction (0 to 1) of its largest silhouette in any direction. Source: the
// projected area of a box is the sum of its faces' areas, each times the cosine of the angle between its normal and the direction.
export function silhouetteOf({ eye, target }, { min, max }) {
    const [x, y, z] = subtract(max, min), faces = [y * z, z * x, x * y], largest = length(faces);
    return dot(unit(subtract(eye, target)).map(Math.abs), faces) / largest || 0; // a box of size 0 gives NaN: returns 0
}

// Returns the camera moved along its viewing direction to another distance from its target.
export function atDistance(camera, metres) {
    const back = unit(subtract(camera.eye, camera.target));
    const lens = isParallel(camera) ? { height_m: camera.height_m * (metres / distance(camera)) } : {};
    return validOr({ ...camera, ...lens, eye: along(camera.target, back, metres) }, camera);
}

// Returns the camera, moved nearer until the box fills the fraction FILL of the picture, but no nearer than `least` metres.
function nearer(camera, box, aspect, least) {
    let near = least, far = distance(camera);
    if (fillOf(camera, box, aspect) >= FILL)
        return camera;
    for (let step = 0; step < STEPS; step++) {
        const mean = Math.sqrt(near * far);
        if (fillOf(atDistance(camera, mean), box, aspect) >= FILL)
            near = mean;
        else
            far = mean;
    }
    return atDistance(camera, near);
}

const isIn = (point, { min, max }) => point.every((m, i) => m > min[i] && m < max[i]);

// Returns true if the bounds of an asset contain other assets, as those of a building do.
export const isRoom = ({ id, bounds }, assets) =>
    assets.some((other) => other.id !== id && isIn(other.bounds.min, bounds) && isIn(other.bounds.max, bounds));

// Returns the cameras to try, in order, for a point on equipment with the bounds `box`. aspect: width of the picture divided by its height;
// whole: bounds of the plant; solid true: leaves out cameras whose eye is within `box`, except the first camera; vertical: the plant's
// upward direction.
export function approaches({ camera, point, box, aspect, whole, solid, vertical = camera.up }) {
    const bounds = distanceBounds(whole), first = face(camera, point, box, approachDistance(box, bounds), undefined, vertical);
    const all = TURNS.map(([azimuth, rise]) => nearer(orbit(first, azimuth, rise, point), box, aspect, bounds.least));
    const widest = Math.max(...all.slice(0, FRONT).map(distance));
    const shows = (side) => distance(side) >= NARROW * widest && silhouetteOf(side, box) >= EDGE;
    const sides = all.filter(({ eye }, i) => i === 0 || !solid || !isIn(eye, box));
    return [...sides.filter(shows), ...sides.filter((side) => !shows(side))];
}
