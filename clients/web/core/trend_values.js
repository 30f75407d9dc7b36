// SPDX-License-Identifier: GPL-3.0-or-later
// For trends of /api/v1/history: computes the band between lowest and highest value, the value at an instant, statistics, and the spans of
// alarms. No function has side effects.
import { BAD, severityOf } from './history.js';
import { calls, isGone } from './alarms.js';

// Returns the stretches of the band between lowest and highest value: [[[fromS, toS, low, high], ...], ...]. Neighbouring intervals form
// one stretch. Empty if the series has single points instead of intervals.
export function bands({ points, bucket_us: length }) {
    const out = [];
    let lastUs = null;
    for (const [us, low, high] of length > 0 ? points : []) {
        if (low === null)
            continue;
        if (lastUs === null || us - lastUs > length * 1.001)
            out.push([]);
        out.at(-1).push([us / 1e6, (us + length) / 1e6, low, high]);
        lastUs = us;
    }
    return out;
}

// Returns the pieces of a series between two instants that have a value: [{ from, to (us), first, last, mean, low, high }].
function pieces({ points, bucket_us: length, step }, fromUs, toUs) {
    const out = [];
    const add = (from, to, first, last) => {
        const [begin, end] = [Math.max(from, fromUs), Math.min(to, toUs)];
        if (!(end > begin))
            return;
        const at = (us) => (to > from ? first + ((last - first) * (us - from)) / (to - from) : first), [a, b] = [at(begin), at(end)];
        out.push({ from: begin, to: end, first: a, last: b, mean: (a + b) / 2, low: Math.min(a, b), high: Math.max(a, b) });
    };
    points.forEach((point, i) => {
        const next = points[i + 1];
        if (length > 0) {
            const [us, low, high, mean, , last, badUs] = point, from = Math.max(us, fromUs), to = Math.min(us + length, toUs);
            const known = low === null ? 0 : 1 - badUs / length;
            if (known > 0 && to > from)
                out.push({ from, to: from + (to - from) * known, first: mean, last: mean, mean, low, high });
            const until = next?.[0] ?? toUs;
            if (last !== null && until > us + length)
                add(us + length, until, last, step ? last : next?.[4] ?? last);
        } else if (point[1] !== null && severityOf(point[2]) < BAD) {
            const until = next?.[0] ?? toUs, flat = step || !next || next[1] === null || next[2] !== point[2];
            add(point[0], until, point[1], flat ? point[1] : next[1]);
        }
    });
    return out;
}

// Returns { min, max, mean (over the time with a value), known (fraction of the time with a value) } of a series; null without any value.
export function statistics(series, fromUs, toUs) {
    const all = pieces(series, fromUs, toUs);
    if (all.length === 0)
        return null;
    const time = all.reduce((sum, { from, to }) => sum + to - from, 0);
    return {
        min: all.reduce((least, { low }) => Math.min(least, low), Infinity),
        max: all.reduce((most, { high }) => Math.max(most, high), -Infinity),
        mean: all.reduce((sum, { from, to, mean }) => sum + mean * (to - from), 0) / time,
        known: Math.min(1, time / (toUs - fromUs)),
    };
}

// Returns statistics whose minimum and maximum include a value that is newer than the series. `stats` null: the series has no values.
export function withNewest(stats, value) {
    const { min, max } = stats ?? { min: value, max: value };
    return { ...stats, min: Math.min(min, value), max: Math.max(max, value) };
}

// Returns the value of a series at an instant; of an interval its mean. null: no value.
export function valueAt({ points, bucket_us: length, step }, us) {
    let low = 0, high = points.length;
    while (low < high) {
        const middle = (low + high) >> 1;
        [low, high] = points[middle][0] <= us ? [middle + 1, high] : [low, middle];
    }
    const point = points[low - 1], next = points[low];
    if (!point)
        return null;
    const [begin, first, last] = length > 0 ? [point[0] + length, point[5], next?.[4]] : [point[0], point[1], next?.[1]];
    if (length > 0 && us < begin)
        return point[3];
    if (first === null || (length === 0 && severityOf(point[2]) >= BAD))
        return null;
    if (!next || step || last === null || last === undefined || (length === 0 && next[2] !== point[2]))
        return first;
    return first + ((last - first) * (us - begin)) / (next[0] - begin);
}

// Returns the alarms of journal rows (newest first): [{ us, endUs (null: still active), tag, kind, priority, value, limit }],
// oldest first. value and limit are null if the row's unit is not `unit`.
export function alarmSpans(rows, unit) {
    const open = new Map(), out = [];
    for (const { time_us: us, tag, kind, event, state, before, priority, unit: was, ...row } of [...rows].reverse()) {
        const key = `${tag} ${kind}`, alarm = open.get(key);
        if (event === 'raise' && calls(state)) {
            const [value, limit] = was === unit ? [row.value, row.limit] : [null, null];
            const made = { us, endUs: null, tag, kind, priority, value, limit };
            open.set(key, made);
            out.push(made);
        } else if (alarm && !isActive(state) && isActive(before)) {
            alarm.endUs = us;
            open.delete(key);
        }
    }
    return out;
}

const isActive = (state) => calls(state) && !isGone(state);
