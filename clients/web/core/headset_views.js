// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry for VR headsets: places the room of a WebXR session in the plant, projects for each eye, and chooses the camera of one wide
// picture from which both eyes' pictures are made. A rig is { at, axes }: the plant position of the room's origin in metres, and the plant
// directions of the room's x (right), y (up) and z (back). An eye is { at, axes, projection }, in plant coordinates.
import { basis, heightAt, RADIANS } from './camera.js';
import { depthAt, gridColumns } from './warp_mesh.js';
import { add, along, cross, dot, length, middle, scale, subtract, unit } from './vector.js';

// MAX_TAN, LEAST_TAN: bounds for the tangent of half the field of view, because the server accepts 1 to 120 degrees
const MAX_TAN = Math.tan(60 * RADIANS), LEAST_TAN = 0.02;
// ratio of the picture's width to the field that both eyes see, so that a turned head finds most of its view drawn
const MARGIN = 1.15;
// MOST_PX: maximum number of pixels of a picture that is requested; STEP_PX: step along a ray in hitOf(), in pixels
const MOST_PX = 4e6, STEP_PX = 2;
// largest plausible resolution of an eye's picture, as the number of pixels over which the tangent of the angle to the view
// direction grows by 1; larger values from a device are replaced by this one
const MOST_DENSITY = 4096;
const NEAREST_M = 0.05, FARTHEST_M = 1000; // ends of a ray
export const STAND_M = 1.6; // height of the eyes above the floor in metres, for devices that do not report it
const ROOM_M = 2.5; // maximum distance in metres from the plant at which a user begins whose camera was outside it

const turned = (axes, [x, y, z]) => add(add(scale(axes[0], x), scale(axes[1], y)), scale(axes[2], z));
export const pointOf = (rig, point) => add(rig.at, turned(rig.axes, point));
export const directionOf = (rig, direction) => turned(rig.axes, direction);
const columnsOf = (matrix) => [0, 4, 8].map((i) => [matrix[i], matrix[i + 1], matrix[i + 2]]);
const positionOf = (matrix) => [matrix[12], matrix[13], matrix[14]];

// Returns the rig (place and axes of the room in the plant) at a position. The rig is level, and its -z points along the level part of
// `forward`.
export function rigAt(at, forward, up) {
    const right = cross(forward, up), x = unit(length(right) > 1e-6 ? right : cross([0.6, 0.8, 0.1], up));
    return { at, axes: [x, unit(up), cross(x, unit(up))] };
}

// Converts a pose in the room, given as a WebXR matrix, to the plant. Returns { at, axes }.
export const poseOf = (rig, matrix) =>
    ({ at: pointOf(rig, positionOf(matrix)), axes: columnsOf(matrix).map((column) => turned(rig.axes, column)) });

export const eyeOf = (rig, { transform, projectionMatrix }) => ({ ...poseOf(rig, transform.matrix), projection: projectionMatrix });

// Returns the level rig (place and axes of the room in the plant) for a user who looked through the page's camera: below that camera if it
// is within the plant's bounds, else on the plant's floor in front of the plant.
export function rigFor(camera, { min, max }, up) {
    const vertical = unit(up), height = (point) => dot(point, vertical), { eye } = camera;
    const floor = [min, max].flatMap((a) => [min, max].flatMap((b) => [min, max].map((c) => height([a[0], b[1], c[2]]))));
    const lowest = Math.min(...floor), level = (point, at = lowest) => along(point, vertical, at - height(point));
    const forward = subtract(level(camera.target), level(eye));
    if (eye.every((v, i) => v >= min[i] && v <= max[i]))
        return rigAt(level(eye, Math.max(lowest, height(eye) - STAND_M)), forward, vertical);
    const centre = level(middle(min, max)), wall = level(eye.map((v, i) => Math.max(min[i], Math.min(max[i], v))));
    const away = subtract(level(eye), wall), { at, axes: [, , back] } = rigAt(wall, forward, vertical);
    if (length(away) < 0.1) // above the plant
        return rigAt(along(centre, back, length(subtract(level(max), level(min))) / 2 + ROOM_M), scale(back, -1), vertical);
    const stand = along(at, away, Math.min(1, ROOM_M / length(away)));
    return rigAt(stand, subtract(centre, stand), vertical);
}

// Returns the clip coordinates of a point for an eye. v: vector from the eye to the point, in metres; h: homogeneous coordinate of that
// vector. The far plane is at infinity; nothing nearer than `nearest` metres is drawn.
export function clipOf({ axes, projection: p }, [v, h], nearest) {
    const [x, y, z] = axes.map((axis) => dot(v, axis)), across = (row) => p[row] * x + p[4 + row] * y + p[8 + row] * z + p[12 + row] * h;
    const w = across(3);
    return [across(0), across(1), w * (1 - 1e-6) - 2 * nearest * h, w];
}

// Returns the 4x4 matrix, column by column, from [x, y, depth, 1] of a depth grid to clip coordinates of an eye. camera: camera
// of the grid's picture.
export const eyeMatrix = (grid, camera, eye, nearest) =>
    gridColumns(grid, camera, eye.at).flatMap((column) => clipOf(eye, column, nearest));

// Returns the tangent of the angle between a direction and the view. aside, depth: the direction's components across and along the view.
// Returns MAX_TAN if the device's numbers make no sense.
const tanOf = (aside, depth) => (depth > 0.1 && Math.abs(aside) < Infinity ? Math.max(LEAST_TAN, Math.abs(aside) / depth) : MAX_TAN);

// Returns the shape of a picture that covers what all eyes see: { fov, width, height }. head: matrix of the viewer's pose; views: the WebXR
// views, one per eye; eyePx: height of an eye's picture in pixels.
export function wideView(head, views, eyePx) {
    const axes = columnsOf(head);
    let across = 0, up = 0, density = 0;
    for (const { transform, projectionMatrix: p } of views) {
        const own = columnsOf(transform.matrix);
        for (const [sx, sy] of [[-1, -1], [1, -1], [-1, 1], [1, 1]]) {
            const corner = turned(own, [(sx + p[8]) / p[0], (sy + p[9]) / p[5], -1]), depth = -dot(corner, axes[2]);
            across = Math.max(across, tanOf(dot(corner, axes[0]), depth));
            up = Math.max(up, tanOf(dot(corner, axes[1]), depth));
        }
        density = Math.max(density, Math.min(MOST_DENSITY, eyePx * p[5] / 2 || 0));
    }
    const tall = Math.min(MAX_TAN, up * MARGIN), wide = Math.min(1.5 * MAX_TAN, across * MARGIN);
    const shrink = Math.min(1, Math.sqrt(MOST_PX / (4 * density * density * tall * wide)));
    const [width, height] = [wide, tall].map((tan) => Math.max(16, Math.round(density * tan * shrink) * 2));
    return { fov: 2 * Math.atan(tall) / RADIANS, width, height };
}

// Returns the camera of the wide picture, at the position of the head.
export function headCamera(rig, matrix, fov) {
    const { at, axes: [, up, back] } = poseOf(rig, matrix);
    return { eye: at, target: along(at, back, -2), up, fov };
}

// Returns true if the head has moved or turned so far that the picture from an earlier camera is no longer good enough.
export function isApart(before, now, mostM = 0.02, mostDeg = 2) {
    const [a, b] = [before, now].map(({ eye, target }) => unit(subtract(target, eye)));
    return length(subtract(before.eye, now.eye)) > mostM || dot(a, b) < Math.cos(mostDeg * RADIANS) ||
        dot(unit(before.up), unit(now.up)) < Math.cos(mostDeg * RADIANS) || before.fov !== now.fov;
}

// Returns the point of the plant at a pixel [x, y] of a depth grid and a depth above 0.
export function pointAt(grid, camera, x, y, depth) {
    const place = [x, y, depth, 1], columns = gridColumns(grid, camera, [0, 0, 0]);
    const [v, h] = columns.reduce(([sum, all], [u, g], i) => [along(sum, u, place[i]), all + g * place[i]], [[0, 0, 0], 0]);
    return scale(v, 1 / h);
}

// Returns the part [from, to] (0 to 1) of the segment from a to b that is within a picture of size `size`; null: no part.
function within(a, b, size) {
    let from = 0, to = 1;
    for (const i of [0, 1]) {
        const [p, q] = [(0 - a[i]) / (b[i] - a[i]), (size[i] - a[i]) / (b[i] - a[i])];
        if (a[i] === b[i] && (a[i] < 0 || a[i] > size[i]))
            return null;
        if (a[i] !== b[i])
            [from, to] = [Math.max(from, Math.min(p, q)), Math.min(to, Math.max(p, q))];
    }
    return from < to ? [from, to] : null;
}

// Returns where a ray first meets a surface that a perspective picture shows: { point, x, y }; null if it meets none. A ray is
// also a straight line in pixels and 1/z.
export function hitOf(grid, camera, origin, direction) {
    const { forward, right, up } = basis(camera), { width, height } = grid, px = height / heightAt(camera, 1);
    const seen = (v, h) => {
        const z = dot(v, forward);
        return [width / 2 + dot(v, right) / z * px, height / 2 - dot(v, up) / z * px, h / z];
    };
    const from = subtract(origin, camera.eye), near = dot(from, forward), slope = dot(direction, forward);
    // distance along the ray, in units of `direction`, to the first point that the picture's camera can see
    const skip = near < NEAREST_M ? (NEAREST_M - near) / slope : 0;
    if (!(skip >= 0 && skip < Infinity))
        return null;
    const end = slope < -1e-3 ? (NEAREST_M / 2 - near) / slope : Infinity;
    const a = seen(along(from, direction, skip), 1), b = end < Infinity ? seen(along(from, direction, end), 1)
        : slope > 1e-3 ? seen(direction, 0) : seen(along(from, direction, FARTHEST_M), 1);
    const part = within(a, b, [width, height]);
    if (!part)
        return null;
    const [t0, t1] = part, steps = Math.ceil(Math.hypot(b[0] - a[0], b[1] - a[1]) * (t1 - t0) / STEP_PX) + 1;
    for (let i = 0; i <= steps; i++) {
        const t = t0 + (t1 - t0) * i / steps, [x, y, depth] = a.map((v, j) => v + (b[j] - v) * t), there = depthAt(grid, x, y);
        if (there > 0 && depth <= there)
            return { point: pointAt(grid, camera, x, y, there), x, y };
    }
    return null;
}

// Returns where a ray meets the level plane through a point, at most 30 m away; null: nowhere.
export function floorHit(origin, direction, level, up) {
    const down = -dot(direction, up), t = dot(subtract(origin, level), up) / down;
    return down > 0.05 && t > 0 && t * length(direction) <= 30 ? along(origin, direction, t) : null;
}

// Returns the rig (place and axes of the room in the plant), moved so that a user whose head is at `head` in the room stands at a point of
// the plant.
export function standAt(rig, head, point) {
    const feet = pointOf(rig, [head[0], 0, head[2]]);
    return { ...rig, at: add(rig.at, subtract(point, feet)) };
}

// Returns where a ray meets a rectangle { at (its middle), axes, width, height }: [u, v] from its top left corner, 0 to 1; null: nowhere.
export function panelHit({ at, axes: [x, y, z], width, height }, origin, direction) {
    const t = dot(subtract(at, origin), z) / dot(direction, z), v = subtract(along(origin, direction, t), at);
    const u = [dot(v, x) / width + 0.5, 0.5 - dot(v, y) / height];
    return t > 0 && u.every((share) => share >= 0 && share <= 1) ? u : null;
}
