// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the cameras of a flight from one view to another. The horizon stays level, and the camera turns the shorter way.
import { basis, isParallel, RADIANS, valid } from './camera.js';
import { distance, elevation, MAX_ELEVATION_DEG, toParallel, toPerspective } from './camera_moves.js';
import { add, cross, dot, mix, scale, subtract, unit } from './vector.js';

export const FLIGHT_MS = 700;
const ease = (t) => (t < 0.5 ? 4 * t * t * t : 1 - (2 - 2 * t) ** 3 / 2);

function frame(up) {
    const z = unit(up);
    const x = unit(cross(Math.abs(z[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], z));
    return { x, y: cross(z, x), z };
}

// Returns true if a camera looks straight down or up along `vertical`, as in a plan with north at the top.
const isSteep = (camera, vertical) => Math.abs(elevation(camera, vertical)) > MAX_ELEVATION_DEG;

// Returns the direction from the target to the eye as angles about axes.z. The azimuth of a camera that looks straight down is that of the
// picture's lower edge; of one that looks straight up, that of the upper edge.
function angles(camera, axes) {
    const degrees = elevation(camera, axes.z), most = MAX_ELEVATION_DEG;
    const v = isSteep(camera, axes.z) ? scale(basis(camera).up, -Math.sign(degrees)) : subtract(camera.eye, camera.target);
    return { azimuth: Math.atan2(dot(v, axes.y), dot(v, axes.x)), elevation: Math.max(-most, Math.min(most, degrees)) * RADIANS };
}

// Returns a function from milliseconds since the start to the camera; from durationMs on it returns exactly `to`. vertical: the plant's
// upward direction.
export function flight(start, to, durationMs = FLIGHT_MS, vertical = to.up) {
    const from = isParallel(start) === isParallel(to) ? start : isParallel(to) ? toParallel(start) : toPerspective(start);
    const up = isSteep(to, vertical) && !isSteep(from, vertical) ? vertical : to.up, axes = frame(up);
    const a = angles(from, axes), b = angles(to, axes);
    const turn = Math.atan2(Math.sin(b.azimuth - a.azimuth), Math.cos(b.azimuth - a.azimuth));
    const near = distance(from), far = distance(to);
    return (ms) => {
        if (ms >= durationMs)
            return to;
        const t = ease(Math.max(0, ms) / durationMs);
        const azimuth = a.azimuth + turn * t, tilt = a.elevation + (b.elevation - a.elevation) * t;
        const flat = add(scale(axes.x, Math.cos(azimuth)), scale(axes.y, Math.sin(azimuth)));
        const towards = add(scale(flat, Math.cos(tilt)), scale(axes.z, Math.sin(tilt)));
        const target = mix(from.target, to.target, t);
        const eye = add(target, scale(towards, near * (far / near) ** t));
        const lens = isParallel(to) ? { height_m: from.height_m * (to.height_m / from.height_m) ** t } : {};
        const camera = { eye, target, up, fov: from.fov + (to.fov - from.fov) * t, ...lens };
        return valid(camera) ? camera : to;
    };
}
