// SPDX-License-Identifier: GPL-3.0-or-later
// The legend's arithmetic: ticks, ramps, and the colour of a value by the server's own rule (server/field/colormap.c).

// Steps of 1, 2 or 5 times a power of ten, at most `most` of them over the range.
export function niceStep(range, most) {
    const power = 10 ** Math.floor(Math.log10(range / most));
    return power * [1, 2, 5, 10].find((m) => range / (m * power) <= most * (1 + 1e-9));
}

function multiples(min, max, step) {
    const slack = (max - min) * 1e-9, list = [];
    for (let n = Math.ceil((min - slack) / step); n * step <= max + slack; n++)
        list.push(Number((n * step).toPrecision(12)));
    return list;
}

// Round values within [min, max], with both ends, which push away what would touch them.
export function ticks(min, max, most = 6) {
    if (!(max > min))
        return [];
    const step = niceStep(max - min, most);
    const inner = multiples(min, max, step).filter((v) => v - min > step * 0.45 && max - v > step * 0.45);
    return [min, ...inner, max];
}


// Moves places along a bar (0..1, ascending) apart, so that what is written there can be read; none leaves the bar.
export function spread(places, gap) {
    const out = [...places];
    for (let i = 1; i < out.length; i++)
        out[i] = Math.max(out[i], out[i - 1] + gap);
    for (let i = out.length - 1, top = 1; i >= 0; i--, top = out[i + 1] - gap)
        out[i] = Math.min(out[i], top);
    return out;
}

// What to offer as ramp intervals: between 4 and 25 steps over the range.
export function rampChoices(min, max) {
    if (!(max > min))
        return [];
    return [...new Set([25, 16, 10, 8, 5, 4].map((n) => Number(niceStep(max - min, n).toPrecision(12))))].sort((a, b) => a - b);
}

// The last step ends at MAX, and MAX belongs to it.
function stepMiddle(value, min, max, interval) {
    const steps = Math.max(1, Math.ceil((max - min) / interval - 0.001));
    const begin = min + Math.min(steps - 1, Math.floor((value - min) / interval)) * interval;
    return (begin + Math.min(begin + interval, max)) / 2;
}

// map: { rgb: Uint8Array(768), below, above }. Returns [r, g, b]. Ramp steps count from `min` and have the colour of their middle.
export function colourOf(map, value, min, max, interval = 0) {
    if (value < min)
        return map.below;
    if (value > max)
        return map.above;
    const stepped = interval > 0 ? stepMiddle(value, min, max, interval) : value;
    const i = 3 * Math.min(255, Math.floor(((stepped - min) / (max - min)) * 256));
    return [map.rgb[i], map.rgb[i + 1], map.rgb[i + 2]];
}
