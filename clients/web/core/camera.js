// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras (camera_moves.js moves them). A camera is { eye, target, up, fov }: positions in metres in plant coordinates, fov is the vertical
// field of view in degrees, target is the centre of orbits. A camera with height_m (height of the picture in metres) is orthographic and
// does not use its fov. Every function returns a new camera. Positions in the picture are pixels from the top left.
import { along, cross, dot, finite, length, middle, subtract, unit } from './vector.js';

export const RADIANS = Math.PI / 180;
// minimum distance from eye to target, and minimum height_m, that the server accepts, in metres
export const LEAST_M = 1e-5;
export const MAX_COORDINATE_M = 1e7;
export const USUAL_FOV = 45;

// Returns true if the server accepts the camera.
export function valid(camera) {
    if (!camera || !finite(camera.eye) || !finite(camera.target) || !finite(camera.up) || !Number.isFinite(camera.fov))
        return false;
    const lens = camera.height_m === undefined ? camera.fov >= 1 && camera.fov <= 120
        : camera.height_m >= LEAST_M && camera.height_m <= MAX_COORDINATE_M;
    if (!lens || [...camera.eye, ...camera.target].some((m) => Math.abs(m) > MAX_COORDINATE_M))
        return false;
    const view = subtract(camera.target, camera.eye);
    return length(view) > 1e-9 && length(camera.up) > 1e-9 && length(cross(unit(view), unit(camera.up))) > 1e-6;
}

// Returns the moved camera, or `before` if the server would reject the moved one, as in a picture of 0x0.
export const validOr = (moved, before) => (valid(moved) ? moved : before);

// Returns true if two cameras are equal.
export function same(a, b) {
    const sameLens = !!a && !!b && a.fov === b.fov && a.height_m === b.height_m;
    return a === b || (sameLens && ['eye', 'target', 'up'].every((k) => a[k].every((x, i) => x === b[k][i])));
}

// Returns the unit vectors of the picture: `forward` into the picture, `right`, and `up` in the picture's plane. camera.up need not be
// perpendicular to `forward`: it is the plant's vertical, except in views that look straight down or up.
export function basis(camera) {
    const forward = unit(subtract(camera.target, camera.eye));
    const right = unit(cross(forward, camera.up));
    return { forward, right, up: cross(right, forward) };
}

// Returns true if the camera is orthographic.
export const isParallel = (camera) => camera.height_m !== undefined;

// heightAt() returns the picture's height in metres at a depth; metresPerPixel() returns the metres per pixel at that depth.
export const heightAt = (camera, depth) => camera.height_m ?? 2 * depth * Math.tan((camera.fov * RADIANS) / 2);
export const metresPerPixel = (camera, heightPx, depth) => heightAt(camera, depth) / heightPx;

// Converts a camera to the form that messages of plantcast.v1 have.
export function cameraMessage({ eye, target, up, fov, height_m }) {
    return { eye, target, up, ...(height_m === undefined ? { fov } : { projection: 'orthographic', height_m }) };
}

// Converts a camera in a message of plantcast.v1 to a camera.
export function cameraOfMessage({ eye, target, up, fov, height_m }) {
    return { eye, target, up, fov: fov ?? USUAL_FOV, ...(height_m === undefined ? {} : { height_m }) };
}

// Returns a function from a point of the plant to [x, y, depth in metres] in the picture; it returns null for points behind the camera, or
// if the picture is 0x0.
export function projector(camera, widthPx, heightPx) {
    const { forward, right, up } = basis(camera);
    const perMetre = 1 / metresPerPixel(camera, heightPx, 1), parallel = isParallel(camera);
    return (point) => {
        const v = subtract(point, camera.eye);
        const depth = dot(v, forward);
        const step = parallel ? perMetre : perMetre / depth;
        const place = [widthPx / 2 + dot(v, right) * step, heightPx / 2 - dot(v, up) * step, depth];
        return (parallel || depth > 1e-6) && finite(place) ? place : null;
    };
}

// Returns the part of the picture that the legend leaves free, in coordinates from -1 to 1. lies true: the legend is a strip of 28 px
// across the top. title: number of letters of the legend's title.
export const besideLegend = (width, height, lies, title = 14) => (lies ? { top: 1 - 2 * share(32, height) }
    : { right: 1 - 2 * share(Math.max(128, 7.6 * title + 24) + (height <= 320 ? 110 : 28), width) });
const share = (part, whole) => (whole > 0 && part / whole <= 0.4 ? part / whole : 0.4);

const FIT = 1.08; // margin, as a factor

// Returns a perspective camera with the same direction, just far enough away that all points are in the free part of the picture.
function fitPoints(camera, points, aspect, { left = -1, right = 1, bottom = -1, top = 1 }) {
    const axes = basis(camera), tall = Math.tan((camera.fov * RADIANS) / 2);
    const centre = middle(...[Math.min, Math.max].map((f) => [0, 1, 2].map((i) => f(...points.map((p) => p[i])))));
    const all = points.map((p) => subtract(p, centre)).map((p) => [dot(p, axes.right), dot(p, axes.up), dot(p, axes.forward)]);
    const side = (axis, low, high, slope) => {
        const half = (high - low) / 2 / FIT, from = ((low + high) / 2 - half) * slope, to = ((low + high) / 2 + half) * slope;
        const least = Math.max(...all.map((p) => p[2] * from - p[axis])), most = Math.max(...all.map((p) => p[axis] - p[2] * to));
        return { back: (least + most) / (to - from), shift: (back) => (most - least - back * (to + from)) / 2 };
    };
    const across = side(0, left, right, tall * aspect), up = side(1, bottom, top, tall);
    const back = Math.max(across.back, up.back, -1.001 * Math.min(...all.map((p) => p[2])));
    const target = along(along(centre, axes.right, across.shift(back)), axes.up, up.shift(back));
    return { ...camera, eye: along(target, axes.forward, -back), target };
}

// Returns the camera of the home view, which shows the whole plant. The plant file's home camera is used unchanged if
// everything that it shows at 16:9 fits into this window; otherwise it is moved back.
export function home({ home: { given, ...view }, outline }, width, height, window = {}) {
    const aspect = width / height, sees = (shape, { right = 1, top = 1 }) => {
        const project = projector(view, 2 * shape, 2);
        return (point) => {
            const [x, y] = project(point) ?? [-1];
            return x >= 0 && x / shape - 1 <= right && 1 - y <= top && y <= 2;
        };
    };
    const held = given ? outline?.filter(sees(16 / 9, {})) : outline;
    return !outline?.length || (given && held.every(sees(aspect, window))) ? view : validOr(fitPoints(view, held, aspect, window), view);
}
