// SPDX-License-Identifier: GPL-3.0-or-later
// Camera moves: orbit, pan, zoom, look around, fit. Each move returns a new camera, or the unchanged camera if the server would reject the
// new one. Positions in the picture are pixels from the top left.
import { basis, heightAt, isParallel, LEAST_M, MAX_COORDINATE_M, metresPerPixel, RADIANS, USUAL_FOV, validOr } from './camera.js';
import { add, along, cross, dot, length, middle, scale, subtract, unit } from './vector.js';

export const USUAL_LIMITS = { near_m: 0.05, far_m: 1e5 }; // limits of zooming
// largest elevation of the eye above or below the target: at 90 degrees the direction of the horizon is undefined, and the picture would
// spin
export const MAX_ELEVATION_DEG = 89;

// Returns v turned by `angle` radians about a unit axis, right-handed (Rodrigues' formula).
function turn(v, axis, angle) {
    const c = Math.cos(angle), s = Math.sin(angle);
    return add(add(scale(v, c), scale(cross(axis, v), s)), scale(axis, dot(axis, v) * (1 - c)));
}

export const corners = (box) => [0, 1, 2, 3, 4, 5, 6, 7].map((n) => [0, 1, 2].map((i) => (n & (1 << i) ? box.max[i] : box.min[i])));

// Returns the bounds of all assets of a plant, including those outside the plant's own bounds.
export const wholeOf = ({ assets, plant }) => ({
    min: plant.bounds.min.map((m, i) => Math.min(m, ...assets.map(({ bounds }) => bounds.min[i]))),
    max: plant.bounds.max.map((m, i) => Math.max(m, ...assets.map(({ bounds }) => bounds.max[i]))),
});

// Returns { near_m, far_m }, the limits of zooming: minimum and maximum distance in metres from the eye to the point zoomed at,
// or, in an orthographic view, of the picture's height. They are wider than usual for very small or very large plants.
export function zoomLimits(model) {
    const size = ({ min, max }) => length(subtract(max, min));
    return { near_m: Math.max(LEAST_M, Math.min(USUAL_LIMITS.near_m, size(model.plant.bounds) / 100)),
        far_m: Math.max(USUAL_LIMITS.far_m, Math.min(MAX_COORDINATE_M, 4 * size(wholeOf(model)))) };
}

function fitParallel(camera, box, aspect, margin) {
    const { forward, right, up } = basis(camera);
    const half = scale(subtract(box.max, box.min), 0.5), centre = middle(box.min, box.max);
    const reach = (axis) => half.reduce((sum, m, i) => sum + Math.abs(m * axis[i]), 0);
    const height_m = Math.max(LEAST_M, 2 * margin * Math.max(reach(up), reach(right) / aspect));
    return validOr({ ...camera, height_m, eye: along(centre, forward, -(2 * reach(forward) + height_m)), target: centre }, camera);
}

// Returns the camera moved so that a box fits into the picture with a margin, with the same viewing direction.
export function fit(camera, box, aspect, margin = 1.08) {
    const { forward, right, up } = basis(camera);
    const centre = middle(box.min, box.max);
    if (isParallel(camera))
        return fitParallel(camera, box, aspect, margin);
    const tall = Math.tan((camera.fov * RADIANS) / 2) / margin, wide = tall * aspect;
    let far = LEAST_M;
    for (const corner of corners(box)) {
        const c = subtract(corner, centre);
        far = Math.max(far, Math.abs(dot(c, right)) / wide - dot(c, forward), Math.abs(dot(c, up)) / tall - dot(c, forward));
    }
    const most = Math.min(...forward.map((x, i) => (MAX_COORDINATE_M + centre[i] * Math.sign(x)) / Math.max(1e-9, Math.abs(x))));
    return validOr({ ...camera, eye: along(centre, forward, -Math.min(far, most)), target: centre }, camera);
}

// Returns the distance in metres from the camera's eye to its target.
export const distance = (camera) => length(subtract(camera.target, camera.eye));

// Returns how many degrees the eye is above the target. vertical: the plant's upward direction.
export function elevation(camera, vertical = camera.up) {
    return Math.asin(Math.max(-1, Math.min(1, -dot(basis(camera).forward, unit(vertical))))) / RADIANS;
}

// Orbits about the vertical through `pivot`, then about the picture's horizontal axis. The horizon stays level. While a camera looks
// straight down or up, as in a plan with north at the top, its `up` turns with the picture.
export function orbit(camera, azimuthDeg, elevationDeg, pivot = camera.target, vertical = camera.up) {
    const plumb = unit(vertical), before = elevation(camera, plumb), isSteep = (degrees) => Math.abs(degrees) > MAX_ELEVATION_DEG;
    const limit = Math.max(MAX_ELEVATION_DEG, Math.abs(before));
    const after = Math.max(-limit, Math.min(limit, before + elevationDeg));
    const { right } = basis(isSteep(before) ? camera : { ...camera, up: plumb });
    const swing = (v) => turn(turn(v, right, -(after - before) * RADIANS), plumb, azimuthDeg * RADIANS);
    const move = (point) => add(pivot, swing(subtract(point, pivot)));
    const up = isSteep(after) ? swing(unit(camera.up)) : vertical;
    return validOr({ ...camera, eye: move(camera.eye), target: move(camera.target), up }, camera);
}

// Turns the view about the eye by the pointer's movement. An orthographic camera, whose eye has no meaning, orbits instead.
export function lookAround(camera, dxPx, dyPx, heightPx, vertical = camera.up) {
    const degrees = (isParallel(camera) ? -USUAL_FOV : camera.fov) / heightPx;
    return orbit(camera, dxPx * degrees, -dyPx * degrees, isParallel(camera) ? camera.target : camera.eye, vertical);
}

// Returns the depth of a point: its distance along the viewing direction.
export const depthOf = (camera, point) => dot(subtract(point, camera.eye), basis(camera).forward);

// toParallel() returns an orthographic camera, its inverse a perspective one; both pictures are equal at the depth of the
// target.
export function toParallel(camera) {
    return validOr({ ...camera, height_m: heightAt(camera, distance(camera)) }, camera);
}

export function toPerspective(camera) {
    const { height_m, ...rest } = camera;
    const fov = rest.fov >= 1 ? rest.fov : USUAL_FOV;
    const back = Math.max(LEAST_M, height_m / (2 * Math.tan((fov * RADIANS) / 2)));
    return validOr({ ...rest, fov, eye: along(rest.target, basis(camera).forward, -back) }, camera);
}

// Moves the camera sideways so that a point at `depth` follows the pointer exactly.
export function pan(camera, dxPx, dyPx, heightPx, depth = distance(camera)) {
    const { right, up } = basis(camera);
    const step = metresPerPixel(camera, heightPx, depth);
    const move = along(scale(right, -dxPx * step), up, dyPx * step);
    return validOr({ ...camera, eye: add(camera.eye, move), target: add(camera.target, move) }, camera);
}

// Returns the viewing ray through a pixel: { origin, direction }. `direction` is scaled to a depth of one metre.
export function sight(camera, xPx, yPx, widthPx, heightPx) {
    const { forward, right, up } = basis(camera);
    const step = metresPerPixel(camera, heightPx, 1);
    const aside = along(scale(right, (xPx - widthPx / 2) * step), up, (heightPx / 2 - yPx) * step);
    if (isParallel(camera))
        return { origin: add(camera.eye, aside), direction: forward };
    return { origin: camera.eye, direction: add(forward, aside) };
}

function zoomParallel(camera, factor, xPx, yPx, widthPx, heightPx, { near_m, far_m }) {
    const height_m = Math.max(near_m, Math.min(far_m, camera.height_m * factor));
    const zoomed = { ...camera, height_m };
    const move = subtract(sight(camera, xPx, yPx, widthPx, heightPx).origin, sight(zoomed, xPx, yPx, widthPx, heightPx).origin);
    return validOr({ ...zoomed, eye: add(camera.eye, move), target: add(camera.target, move) }, camera);
}

// Zooms; a factor below 1 moves nearer. The point under (xPx, yPx), at `depth`, stays under the pointer. The target moves to that depth, so
// that the next orbit turns about that point.
export function zoom(camera, factor, xPx, yPx, widthPx, heightPx, depth = distance(camera), limits = USUAL_LIMITS) {
    if (isParallel(camera))
        return zoomParallel(camera, factor, xPx, yPx, widthPx, heightPx, limits);
    const wanted = Math.max(limits.near_m, Math.min(limits.far_m, depth * factor));
    const eye = along(camera.eye, sight(camera, xPx, yPx, widthPx, heightPx).direction, depth - wanted);
    return validOr({ ...camera, eye, target: along(eye, basis(camera).forward, wanted) }, camera);
}

// Returns where a ray enters a box, as a factor of `direction`; null if it misses the box or starts inside.
export function enterBox(origin, direction, box) {
    let near = -Infinity, far = Infinity;
    for (let i = 0; i < 3; i++) {
        const a = (box.min[i] - origin[i]) / direction[i], b = (box.max[i] - origin[i]) / direction[i];
        // NaN is the result of 0/0: the ray lies in the plane of one of the box's two faces across this axis, so these faces do
        // not limit the ray
        if (Number.isNaN(a) || Number.isNaN(b))
            continue;
        near = Math.max(near, Math.min(a, b));
        far = Math.min(far, Math.max(a, b));
    }
    return near <= far && near > 0 && near < Infinity ? near : null;
}

// Returns the depth of the nearest bounding box under a pixel; null if there is none.
export function depthAt(camera, xPx, yPx, widthPx, heightPx, boxes) {
    const { origin, direction } = sight(camera, xPx, yPx, widthPx, heightPx);
    let depth = Infinity;
    for (const box of boxes)
        depth = Math.min(depth, enterBox(origin, direction, box) ?? Infinity);
    return Number.isFinite(depth) && depth > LEAST_M ? depth : null;
}

// Returns a camera that looks at a point of equipment from outside, slightly from above. The direction is the normal at that point of the
// ellipsoid in the bounding box. vertical: the plant's upward direction.
export function face(camera, point, box, distanceM, elevationDeg = 20, vertical = camera.up) {
    const plumb = unit(vertical), centre = middle(box.min, box.max), level = (v) => subtract(v, scale(plumb, dot(v, plumb)));
    const outwards = point.map((x, i) => (x - centre[i]) / Math.max(1e-6, (box.max[i] - box.min[i]) ** 2));
    // fallbacks at the middle of the box: the direction to the eye, and if the camera looks straight down, the lower edge of the picture
    const sides = [outwards, subtract(camera.eye, camera.target), scale(basis(camera).up, -1)].map(level);
    const direction = unit(sides.find((side) => length(side) > 1e-4) ?? sides[1]);
    const tilt = elevationDeg * RADIANS;
    const towards = add(scale(direction, Math.cos(tilt)), scale(plumb, Math.sin(tilt)));
    const lens = isParallel(camera) ? { height_m: 0.8 * distanceM } : {};
    return validOr({ ...camera, ...lens, target: point, eye: along(point, towards, distanceM), up: vertical }, camera);
}
