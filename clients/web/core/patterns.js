// SPDX-License-Identifier: GPL-3.0-or-later
// The patterns for "no data" and "uncertain", as the server draws them (shaders/field.glsl).
import { PATTERNS } from '../made/constants.js';

const grey = (level) => [level, level, level];
const HATCH = [grey(PATTERNS.HATCH_LIGHT_GREY), grey(PATTERNS.HATCH_DARK_GREY)], STIPPLE = grey(PATTERNS.STIPPLE_GREY);
const RULE = [grey(PATTERNS.RULE_LIGHT_GREY), grey(PATTERNS.RULE_DARK_GREY)];
const fract = (x) => x - Math.floor(x);
const clamp = (x) => Math.max(0, Math.min(1, x));
const mix = (a, b, t) => a.map((x, i) => Math.round(x + (b[i] - x) * t));

// Returns the period of the patterns in pixels, for a picture that is heightPx high.
export const patternPeriodPx = (heightPx) => Math.max(PATTERNS.PATTERN_LEAST_PX, heightPx / PATTERNS.PATTERN_PERIODS);

// Returns how much of a pixel (0 to 1) the stripes cover. In this and the functions below, y points up, as in OpenGL.
const stripes = (place, edge, period) => clamp((Math.abs(fract(place) - 0.5) - edge) * period + 0.5);
const hatch = (x, y, period) => stripes((x + y) / (period * PATTERNS.HATCH_SLANT), PATTERNS.HATCH_EDGE, period);

function stipple(x, y, period) {
    const row = y / period, column = x / period + 0.5 * Math.floor(row % 2);
    return clamp((PATTERNS.STIPPLE_RADIUS - Math.hypot(fract(column) - 0.5, fract(row) - 0.5)) * period + 0.5);
}

// Returns the colour of a pixel of the pattern for "no data", [r, g, b]; row 0 is at the top.
export function hatchAt(x, row, heightPx, period) {
    return mix(HATCH[0], HATCH[1], hatch(x + 0.5, heightPx - row - 0.5, period));
}

// Returns the colour of the pattern for tags without alarm limits in the operator's view, which shows values relative to their
// alarm limits.
export function ruleAt(row, heightPx, period) {
    return mix(RULE[0], RULE[1], stripes((heightPx - row - 0.5) / period, PATTERNS.RULE_EDGE, period));
}

export function stippleAt(x, row, heightPx, period, colour) {
    return mix(colour, STIPPLE, stipple(x + 0.5, heightPx - row - 0.5, period));
}
