// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry of the clip gizmo: handles for each clip plane, each side of a clip box and the whole box, their positions, and how dragging
// moves them.
import { basis, isParallel } from './camera.js';
import { AXES } from './section.js';
import { add, along, cross, dot, finite, length, middle, mix, scale, subtract, unit } from './vector.js';

// LEAST_BOX_M: minimum length of a box's sides; MARGIN: minimum distance of a plane from the plant's bounds, inside them, as a
// fraction of their size
const LEAST_BOX_M = 0.05, MARGIN = 1e-3;
const NEAR_M = 0.02; // the part of a handle's line that is nearer to the camera than this many metres is cut off
// minimum squared sine of the angle between viewing ray and handle direction; below this, a drag is undefined
const STEEP = 0.03;

const isSound = ({ direction, at, low, high, corners }) => [at, low, high].every(Number.isFinite) && [direction, ...corners].every(finite);
// Returns the changed clip (section planes or clip box), or `before` if a number in the changed one is not finite.
const soundOr = (moved, before) =>
    ((moved.planes ?? [moved.box.min, moved.box.max]).flat().every(Number.isFinite) ? moved : before);

const middleOf = (points) => scale(points.reduce(add), 1 / points.length);

const cornersOf = ({ min, max }) =>
    [0, 1, 2, 3, 4, 5, 6, 7].map((n) => [0, 1, 2].map((i) => (n & (1 << i) ? max[i] : min[i])));

// Returns the corners of the polygon where the plane p·direction = at cuts a box, in order around the polygon.
function crossing(direction, at, box) {
    const corners = cornersOf(box), found = [];
    for (let a = 0; a < 8; a++) {
        for (const bit of [1, 2, 4]) {
            if (a & bit)
                continue;
            const p = corners[a], q = corners[a | bit], from = dot(p, direction) - at, to = dot(q, direction) - at;
            if (from * to < 0)
                found.push(mix(p, q, from / (from - to)));
        }
    }
    if (found.length < 3)
        return [];
    const middle = middleOf(found), u = unit(subtract(found[0], middle)), v = cross(direction, u);
    const angle = (p) => Math.atan2(dot(subtract(p, middle), v), dot(subtract(p, middle), u));
    return found.sort((p, q) => angle(p) - angle(q));
}

function planeGrip([nx, ny, nz, d], index, bounds) {
    const normal = [nx, ny, nz], size = length(normal), towards = unit(normal);
    const longest = [0, 1, 2].reduce((best, i) => (Math.abs(towards[i]) > Math.abs(towards[best]) + 1e-9 ? i : best), 0);
    const turned = towards[longest] < 0, direction = towards.map((v) => (turned ? 0 - v : v));
    const reach = cornersOf(bounds).map((p) => dot(p, direction)), low = Math.min(...reach), high = Math.max(...reach);
    const at = (turned ? d : -d) / size, room = MARGIN * (high - low);
    const axis = Math.abs(direction[longest]) > 1 - 1e-9 ? AXES[longest] : null;
    return { id: `plane${index}`, index, size, turned, direction, axis, at, low: low + room, high: high - room,
        corners: crossing(direction, at, bounds) };
}

function sideGrip(box, index, high, bounds) {
    const direction = [0, 0, 0], side = high ? box.max : box.min, more = (bounds.max[index] - bounds.min[index]) / 2;
    direction[index] = 1;
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([u, v]) => {
        const p = [...side], others = [0, 1, 2].filter((i) => i !== index);
        p[others[0]] = (u ? box.max : box.min)[others[0]];
        p[others[1]] = (v ? box.max : box.min)[others[1]];
        return p;
    });
    return { id: `${AXES[index]}${high ? 'max' : 'min'}`, index, turned: high, direction, axis: AXES[index], at: side[index], corners,
        low: high ? box.min[index] + LEAST_BOX_M : Math.min(bounds.min[index] - more, box.min[index]),
        high: high ? Math.max(bounds.max[index] + more, box.max[index]) : box.max[index] - LEAST_BOX_M };
}

// Returns the finite handles of a clip: [{ id, axis (null: oblique), turned (true: keeps the side of smaller coordinates), direction (unit
// vector), at (position in metres along `direction`), low, high (limits of `at`), corners }].
export function gripsOf(clip, bounds) {
    if (clip?.planes)
        return clip.planes.map((plane, index) => planeGrip(plane, index, bounds)).filter(isSound);
    return clip?.box ? [0, 1, 2].flatMap((i) => [false, true].map((high) => sideGrip(clip.box, i, high, bounds))).filter(isSound) : [];
}

// Returns the clip (section planes or clip box) after its handle has moved to the position `to`, within the handle's limits.
export function moveGrip(clip, { index, size, turned, direction, low, high }, to) {
    const at = Math.max(low, Math.min(high, to));
    if (clip.planes) {
        const towards = turned ? -size : size;
        const plane = [...scale(direction, towards), -at * towards];
        return soundOr({ planes: clip.planes.map((other, i) => (i === index ? plane : other)) }, clip);
    }
    const box = { min: [...clip.box.min], max: [...clip.box.max] };
    (turned ? box.max : box.min)[index] = at;
    return soundOr({ box }, clip);
}

// Returns the handle that moves a whole clip box, at the box's centre; null if the clip is not a finite box.
export function wholeOf(clip) {
    const centre = clip?.box ? middle(clip.box.min, clip.box.max) : null;
    return finite(centre) ? { id: 'whole', corners: [centre], direction: [0, 0, 0], low: 0, high: 0 } : null;
}

// Returns the clip with the whole box moved by a vector in metres. The box's centre stays inside the plant's bounds.
export function moveBox(clip, by, bounds) {
    const { box } = clip, at = middle(box.min, box.max);
    const way = by.map((m, i) => Math.max(bounds.min[i] - at[i], Math.min(bounds.max[i] - at[i], m)));
    return soundOr({ box: { min: add(box.min, way), max: add(box.max, way) } }, clip);
}

// Returns where a viewing ray meets the plane through `point` that is parallel to the picture; `point` itself if the ray misses the plane.
export function facing(camera, point, { origin, direction }) {
    const { forward } = basis(camera);
    const met = along(origin, direction, dot(subtract(point, origin), forward) / dot(direction, forward));
    return finite(met) ? met : point;
}

// Returns possible positions of a handle's knob on the handle's plane, the centre first.
export function spotsOf({ corners }) {
    if (corners.length === 0)
        return [];
    const middle = middleOf(corners);
    const around = corners.flatMap((p, i) => [p, mix(p, corners[(i + 1) % corners.length], 0.5)]);
    return [middle, ...[0.3, 0.6, 0.9].flatMap((part) => around.map((p) => mix(middle, p, part)))].filter(finite);
}

// Returns the point of a line that is nearest to a viewing ray, in metres along `direction` from `point`; null if line and ray
// are almost parallel.
export function alongSight(point, direction, { origin, direction: towards }) {
    const w = subtract(point, origin), c = dot(towards, towards), b = dot(direction, towards), sine2 = 1 - (b * b) / c;
    if (sine2 < STEEP)
        return null;
    // distance along the viewing ray to its point nearest to the line, in metres; positive means in front of the camera
    const ahead = (dot(w, towards) - b * dot(w, direction)) / (c * sine2);
    const way = (b * dot(w, towards) - c * dot(w, direction)) / (c * sine2);
    return ahead > 0 && Number.isFinite(way) ? way : null;
}

// Returns the part of the line from a to b that is in front of the camera; null if the whole line is behind the camera.
export function beforeEye(camera, a, b) {
    if (isParallel(camera))
        return [a, b];
    const { forward } = basis(camera), depth = (p) => dot(subtract(p, camera.eye), forward) - NEAR_M;
    const from = depth(a), to = depth(b);
    if (from <= 0 && to <= 0)
        return null;
    const meet = () => along(a, subtract(b, a), from / (from - to));
    const line = [from > 0 ? a : meet(), to > 0 ? b : meet()];
    return line.every(finite) ? line : null;
}
