// SPDX-License-Identifier: GPL-3.0-or-later
// Arithmetic of the legend: ticks, colour bands, and the colour of a value, computed as on the server (server/field/colormap.c).

// Returns a round step (1, 2 or 5 times a power of ten) that covers the range in at most `most` steps.
export function niceStep(range, most) {
    const power = 10 ** Math.floor(Math.log10(range / most));
    return power * [1, 2, 5, 10].find((m) => range / (m * power) <= most * (1 + 1e-9));
}

const MOST_MULTIPLES = 1000; // no scale has more

// Returns the multiples of a step from min to max; an empty list if there would be more than MOST_MULTIPLES, or the step is not
// positive.
export function multiples(min, max, step) {
    const slack = (max - min) * 1e-9, list = [];
    if (!(step > 0 && (max - min) / step <= MOST_MULTIPLES && Math.abs(min / step) < Number.MAX_SAFE_INTEGER))
        return list;
    for (let n = Math.ceil((min - slack) / step); n * step <= max + slack; n++)
        list.push(Number((n * step).toPrecision(12)));
    return list;
}

// Returns round values within [min, max], and min and max themselves; round values that are too close to an end are left out.
export function ticks(min, max, most = 6) {
    if (!(max > min))
        return [];
    const step = niceStep(max - min, most);
    const inner = multiples(min, max, step).filter((v) => v - min > step * 0.45 && max - v > step * 0.45);
    return [min, ...inner, max];
}


// Moves positions along the legend's bar (0..1, ascending) apart until the labels there do not overlap; all stay on the bar.
export function spread(places, gap) {
    const out = [...places];
    for (let i = 1; i < out.length; i++)
        out[i] = Math.max(out[i], out[i - 1] + gap);
    for (let i = out.length - 1, top = 1; i >= 0; i--, top = out[i + 1] - gap)
        out[i] = Math.min(out[i], top);
    return out;
}

// Returns the widths of colour bands to offer: those dividing the range into 4 to 25 bands.
export function rampChoices(min, max) {
    if (!(max > min))
        return [];
    const steps = [25, 16, 10, 8, 5, 4].map((n) => Number(niceStep(max - min, n).toPrecision(12)));
    return [...new Set(steps)].filter(Number.isFinite).sort((a, b) => a - b);
}

// --- from a value to its colour, by the same rule as on the server (server/field/scale.h). scale: { map, min, max, log, interval, breaks
// }; map: { rgb: Uint8Array(768), below, above }

export function placeOf({ min, max, log }, value) {
    return log ? Math.log(value / min) / Math.log(max / min) : (value - min) / (max - min);
}

export function valueAt({ min, max, log }, place) {
    return log ? min * (max / min) ** place : min + place * (max - min);
}

const inside = ({ min, max, breaks }) => (breaks ?? []).filter((value) => value > min && value < max);

// Returns the values at the boundaries of the colour bands.
export function edges(scale) {
    const { min, max, interval } = scale;
    if (scale.breaks?.length > 0)
        return inside(scale);
    const count = interval > 0 ? Math.max(1, Math.ceil((max - min) / interval - 0.001)) : 1;
    return count <= 64 && Number.isFinite(min) ? Array.from({ length: count - 1 }, (_, i) => min + (i + 1) * interval) : [];
}

// Returns the position on the colour map (0..1) of the colour of a value's band. The last band includes its upper end.
function bandPlace(scale, value) {
    const { min, max, interval } = scale;
    if (scale.breaks?.length > 0) {
        const all = inside(scale);
        return (all.filter((edge) => value >= edge).length + 0.5) / (all.length + 1);
    }
    const steps = Math.max(1, Math.ceil((max - min) / interval - 0.001));
    const begin = min + Math.min(steps - 1, Math.floor((value - min) / interval)) * interval;
    return (placeOf(scale, begin) + placeOf(scale, Math.min(begin + interval, max))) / 2;
}

const NOWHERE = [128, 128, 128]; // colour of values that are not numbers

// Returns the colour of a value: [r, g, b].
export function colourOf(scale, value) {
    const { map, min, max } = scale;
    if (value < min)
        return map.below;
    if (value > max)
        return map.above;
    const banded = scale.breaks?.length > 0 || scale.interval > 0;
    const place = banded ? bandPlace(scale, value) : placeOf(scale, value);
    if (Number.isNaN(place))
        return NOWHERE;
    const i = 3 * Math.max(0, Math.min(255, Math.floor(place * 256)));
    return [map.rgb[i], map.rgb[i + 1], map.rgb[i + 2]];
}

// Returns the values to label in the legend: those of isolines and both ends if there is room for them, otherwise round values.
export function scaleTicks(scale, lines, most = 9) {
    const { min, max } = scale;
    const within = [...new Set([...edges(scale), ...lines])].filter((value) => value > min && value < max).sort((a, b) => a - b);
    if (within.length > 0 && within.length + 2 <= most)
        return [min, ...within, max];
    if (!scale.log)
        return ticks(min, max, Math.max(1, Math.min(6, most - 1)));
    if (!(min > 0 && max > min && max < Infinity))
        return [];
    const decades = [];
    for (let power = 10 ** Math.floor(Math.log10(min)); power <= max; power *= 10)
        decades.push(...[1, 2, 5].map((lead) => Number((lead * power).toPrecision(3))));
    const near = (value) => decades.length <= 12 || Number.isInteger(Math.log10(value));
    return [min, ...decades.filter((v) => near(v) && placeOf(scale, v) > 0.05 && placeOf(scale, v) < 0.95), max];
}

// Colours of the operator's view, the lowest band first, as on the server (shaders/maps/operator.csv). from, to: where a value
// is relative to its alarm limits: -2, -1, 1 and 2 are the limits LL, L, H and HH.
export const LIMIT_BANDS = [
    { from: -3, to: -2, colour: [90, 141, 192] }, { from: -2, to: -1, colour: [146, 174, 203] },
    { from: -1, to: 1, colour: [201, 201, 201] },
    { from: 1, to: 2, colour: [194, 167, 135] }, { from: 2, to: 3, colour: [175, 128, 74] },
];
