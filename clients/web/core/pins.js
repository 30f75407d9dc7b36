// SPDX-License-Identifier: GPL-3.0-or-later
// Places the pins of shift notes next to their points, where they cover neither legends nor alarm rings nor other pins.
import { grow, meets } from './labels.js';

// length of a pin's stem in CSS pixels (larger on a video wall) at the pin's usual position, above and to the right of its
// point
export const STEM = 9;
const GAP = 2; // units: space between two pins
const ROWS = 40; // number of heights to try for a pin that must cover alarm rings or markers
// largest distance in CSS pixels (larger on a video wall) that a pin moves from its usual position to leave a marker without an
// alarm uncovered; rather than move farther, it covers the marker
const FAR = 150;

// Moves a box up or down (step -1 or 1) until it meets none of the other boxes. Returns null if it would leave the area.
function slide(box, boxes, step, { top, bottom }) {
    const high = box.bottom - box.top;
    let at = box;
    for (let tries = 0; tries <= boxes.length && at.top >= top && at.bottom <= bottom; tries++) {
        const other = boxes.find((one) => meets(at, one));
        if (!other)
            return at;
        const next = step < 0 ? other.top - GAP - high : other.bottom + GAP;
        at = { ...at, top: next, bottom: next + high };
    }
    return null;
}

// Returns the box of a pin in the area, as near as possible to its usual position. x, y: the note's point; wide, high: size of
// the pin. fixed: boxes of legends and of other pins, which the pin never covers. rings: boxes of alarm rings, of which the pin
// covers as few as possible. marks: boxes of other markers, which the pin covers rather than move farther than FAR.
export function placePin({ x, y, wide, high }, area, fixed, rings, marks = []) {
    const left = Math.max(area.left, Math.min(area.right - wide, x));
    const top = Math.max(area.top, Math.min(area.bottom - high, y - STEM - high));
    const boxAt = (at, down = top) => ({ left: at, right: at + wide, top: down, bottom: down + high });
    const sides = [x - wide, area.left, area.right - wide, ...fixed.flatMap((box) => [box.left - GAP - wide, box.right + GAP])]
        .filter((at) => at >= area.left && at + wide <= area.right), lefts = [left, ...sides];
    const far = (box) => Math.hypot(box.left - left, box.top - top);
    const least = (boxes, cost) => boxes.map((box) => [cost(box), box]).reduce((best, one) => (one[0] < best[0] ? one : best))[1];
    // rings that surround the pin's own point, enlarged by the stem's length: the pin avoids them, so that its stem stays
    // visible
    const room = rings.filter((ring) => meets(ring, { left: x, right: x, top: y, bottom: y })).map((ring) => grow(ring, STEM));
    const avoided = [...marks, ...room];
    const slid = (boxes) => lefts.flatMap((at) => [-1, 1].map((step) => slide(boxAt(at), boxes, step, area))).filter(Boolean);
    const free = slid([...fixed, ...rings, ...avoided]).filter((box) => far(box) <= FAR);
    if (free.length > 0)
        return least(free, far);
    const rows = Array.from({ length: ROWS }, (_, i) => area.top + (i / (ROWS - 1)) * (area.bottom - area.top - high));
    const others = [...slid([...fixed, ...rings]), ...lefts.flatMap((at) => [top, ...rows].map((row) => boxAt(at, row)))]
        .filter((box) => !fixed.some((other) => meets(box, other)));
    const covered = (box, boxes) => boxes.filter((other) => meets(box, other)).length;
    const cost = (box) => 1e6 * covered(box, rings) + FAR * covered(box, avoided) + far(box);
    return others.length > 0 ? least(others, cost) : boxAt(left);
}
