// SPDX-License-Identifier: GPL-3.0-or-later
// The patterns that say "no data" and "uncertain", as the server draws them (shaders/field.glsl, server/render/shaded_colormap.c).

const HATCH = [[240, 240, 240], [150, 150, 150]], STIPPLE = [64, 64, 64], RULE = [[226, 226, 226], [196, 196, 196]];
const fract = (x) => x - Math.floor(x);
const clamp = (x) => Math.max(0, Math.min(1, x));
const mix = (a, b, t) => a.map((x, i) => Math.round(x + (b[i] - x) * t));

// Returns the period of the pattern in a picture of that height.
export const patternPeriodPx = (heightPx) => Math.max(6, heightPx / 90);

// Coverage of the pattern at the middle of a pixel; y upwards, as GL has it.
const hatch = (x, y, period) => clamp((Math.abs(fract((x + y) / (period * 1.4142)) - 0.5) - 0.25) * period + 0.5);

function stipple(x, y, period) {
    const row = y / period, column = x / period + 0.5 * Math.floor(row % 2);
    return clamp((0.26 - Math.hypot(fract(column) - 0.5, fract(row) - 0.5)) * period + 0.5);
}

// Returns the colour of a pixel, [r, g, b]; row 0 is at the top.
export function hatchAt(x, row, heightPx, period) {
    return mix(HATCH[0], HATCH[1], hatch(x + 0.5, heightPx - row - 0.5, period));
}

// The same for the pattern of tags without limits in the operator's view.
export function ruleAt(row, heightPx, period) {
    return mix(RULE[0], RULE[1], clamp((Math.abs(fract((heightPx - row - 0.5) / period) - 0.5) - 0.36) * period + 0.5));
}

export function stippleAt(x, row, heightPx, period, colour) {
    return mix(colour, STIPPLE, stipple(x + 0.5, heightPx - row - 0.5, period));
}
