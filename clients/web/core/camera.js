// SPDX-License-Identifier: GPL-3.0-or-later
// The camera of one viewer (moves.js moves it). A camera is { eye, target, up, fov }: metres in the plant frame, fov vertical in
// degrees; target is what it turns about. One that has height_m, what its picture is high, is orthographic; fov is then kept for
// later. Every function returns a new camera. Picture places are pixels from the top left.
import { along, cross, dot, finite, length, middle, scale, subtract, unit } from './vector.js';

export const RADIANS = Math.PI / 180;
export const MIN_DISTANCE_M = 0.05;
export const MAX_DISTANCE_M = 1e5;
const MAX_COORDINATE_M = 1e7; // what the server accepts
const MIN_HEIGHT_M = 1e-3;
export const USUAL_FOV = 45;

export function valid(camera) {
    if (!camera || !finite(camera.eye) || !finite(camera.target) || !finite(camera.up) || !Number.isFinite(camera.fov))
        return false;
    const lens = camera.height_m === undefined ? camera.fov >= 1 && camera.fov <= 120
        : camera.height_m >= MIN_HEIGHT_M && camera.height_m <= MAX_COORDINATE_M;
    if (!lens || [...camera.eye, ...camera.target].some((m) => Math.abs(m) > MAX_COORDINATE_M))
        return false;
    const view = subtract(camera.target, camera.eye);
    return length(view) > 1e-9 && length(camera.up) > 1e-9 && length(cross(unit(view), unit(camera.up))) > 1e-6;
}

export function same(a, b) {
    const sameLens = !!a && !!b && a.fov === b.fov && a.height_m === b.height_m;
    return a === b || (sameLens && ['eye', 'target', 'up'].every((k) => a[k].every((x, i) => x === b[k][i])));
}

// Unit vectors of the picture: forward into it, right, and up within it (camera.up is the vertical of the plant).
export function basis(camera) {
    const forward = unit(subtract(camera.target, camera.eye));
    const right = unit(cross(forward, camera.up));
    return { forward, right, up: cross(right, forward) };
}

export const isParallel = (camera) => camera.height_m !== undefined;

export const heightAt = (camera, depth) => camera.height_m ?? 2 * depth * Math.tan((camera.fov * RADIANS) / 2);
export const metresPerPixel = (camera, heightPx, depth) => heightAt(camera, depth) / heightPx;

const corners = (box) => [0, 1, 2, 3, 4, 5, 6, 7].map((n) => [0, 1, 2].map((i) => (n & (1 << i) ? box.max[i] : box.min[i])));

function fitParallel(camera, box, aspect, margin) {
    const { forward, right, up } = basis(camera);
    const half = scale(subtract(box.max, box.min), 0.5), centre = middle(box.min, box.max);
    const reach = (axis) => half.reduce((sum, m, i) => sum + Math.abs(m * axis[i]), 0);
    const height_m = Math.max(MIN_DISTANCE_M, 2 * margin * Math.max(reach(up), reach(right) / aspect));
    return { ...camera, height_m, eye: along(centre, forward, -(2 * reach(forward) + height_m)), target: centre };
}

// Looks the same way at the middle of a box, from just so far that all of it is inside the picture with a margin around.
export function fit(camera, box, aspect, margin = 1.08) {
    const { forward, right, up } = basis(camera);
    const centre = middle(box.min, box.max);
    if (isParallel(camera))
        return fitParallel(camera, box, aspect, margin);
    const tall = Math.tan((camera.fov * RADIANS) / 2) / margin, wide = tall * aspect;
    let far = MIN_DISTANCE_M;
    for (const corner of corners(box)) {
        const c = subtract(corner, centre);
        far = Math.max(far, Math.abs(dot(c, right)) / wide - dot(c, forward), Math.abs(dot(c, up)) / tall - dot(c, forward));
    }
    return { ...camera, eye: along(centre, forward, -Math.min(far, MAX_DISTANCE_M)), target: centre };
}

// As plantcast.v1 says it.
export function cameraMessage({ eye, target, up, fov, height_m }) {
    return { eye, target, up, ...(height_m === undefined ? { fov } : { projection: 'orthographic', height_m }) };
}

// The other way round.
export function cameraOfMessage({ eye, target, up, fov, height_m }) {
    return { eye, target, up, fov: fov ?? USUAL_FOV, ...(height_m === undefined ? {} : { height_m }) };
}

// Function from a point in the plant to [x, y, depth in metres] in the picture; null: behind the eye.
export function projector(camera, widthPx, heightPx) {
    const { forward, right, up } = basis(camera);
    const perMetre = 1 / metresPerPixel(camera, heightPx, 1), parallel = isParallel(camera);
    return (point) => {
        const v = subtract(point, camera.eye);
        const depth = dot(v, forward);
        const step = parallel ? perMetre : perMetre / depth;
        return parallel || depth > 1e-6 ? [widthPx / 2 + dot(v, right) * step, heightPx / 2 - dot(v, up) * step, depth] : null;
    };
}

// The plant's own first view; where the picture is too narrow to hold what it was made for, the whole plant from there.
export function home(plant, aspect) {
    const view = { ...plant.home };
    return aspect >= 1.3 ? view : fit(view, plant.bounds, aspect);
}
