// SPDX-License-Identifier: GPL-3.0-or-later
// Converts responses of /api/v1/history and of the alarm journal to what charts and the time bar draw. These functions have no side
// effects.
import { calls } from './alarms.js';

export const BAD = 2, UNCERTAIN = 1; // severity of a quality: the top two bits of an OPC UA status code
export const severityOf = (quality) => Math.min(BAD, quality >>> 30);

// Converts a tag's series to seconds and values for a chart; null breaks the line. A series of intervals is drawn as a line through their
// means (trend_values.js has the band between lowest and highest value).
export function line(series, fromUs, toUs) {
    const xs = [], ys = [], { points, bucket_us: length } = series;
    const put = (us, value) => {
        const x = us / 1e6, last = xs.length - 1;
        if (last >= 0 && x <= xs[last])
            return void (ys[last] = value === null || ys[last] === null ? null : value);
        xs.push(x);
        ys.push(value);
    };
    points.forEach((point, i) => {
        if (length > 0)
            putInterval(put, point, length, points[i - 1], points[i + 1]);
        else
            putPoint(put, point, points[i - 1], series.step);
    });
    const last = ys.findLast((value) => value !== undefined);
    if (points.length > 0 && last !== null && xs.at(-1) < toUs / 1e6)
        put(toUs, last);
    return [xs, ys];
}

// Adds a recorded point to a chart's line. Where no straight line leads to the point (HISTORY.md), the previous value holds
// until just before the point.
function putPoint(put, [us, value, quality], before, step) {
    const shown = severityOf(quality) === BAD ? null : value, isJoined = !step && shown !== null && before?.[2] === quality;
    if (!isJoined && before && before[1] !== null && severityOf(before[2]) !== BAD)
        put(us - 1, before[1]);
    put(us, shown);
}

// Adds an interval of a series to a chart's line: its mean, and its first and last value where no other interval adjoins. An interval that
// ends without a value (`last` null) breaks the line, even at the end of the series.
function putInterval(put, [us, low, , mean, first, last], length, before, after) {
    const adjoins = (other) => other && other[1] !== null && Math.abs(other[0] - us) <= length * 1.001;
    // The interval has no values of its own; `first` is the value that held until it began: draws that value until just before
    // the interval.
    if (low === null && first !== null)
        put(us - 1, first);
    if (low === null)
        return put(us, null);
    if (!adjoins(before) || before[5] === null)
        put(us, first ?? mean);
    put(us + length / 2, mean);
    if (!adjoins(after) || last === null)
        put(us + length - 2, last);
    return undefined;
}

// Returns the periods of a series without a value, or with an uncertain one: [{ from, to (seconds), severity }].
export function gaps(series, fromUs, toUs) {
    const out = [];
    const add = (from, to, grade) => {
        const begin = Math.max(from, fromUs) / 1e6, end = Math.min(to, toUs) / 1e6, last = out.at(-1);
        if (grade === 0 || !(end > begin) || end - begin === Infinity)
            return;
        if (last && last.severity === grade && begin - last.to < 1e-3)
            last.to = end;
        else
            out.push({ from: begin, to: end, severity: grade });
    };
    const { points, bucket_us: length } = series;
    if (points.length === 0)
        return [{ from: fromUs / 1e6, to: toUs / 1e6, severity: BAD }];
    if (points[0][0] > fromUs)
        add(fromUs, points[0][0], BAD);
    points.forEach((point, i) => {
        const next = points[i + 1]?.[0] ?? toUs, quality = length > 0 ? point[7] : point[2];
        if (length > 0 && point[6] > 0 && severityOf(quality) !== BAD)
            add(point[0], point[0] + point[6], BAD); // marks the whole interval, because the gap is at an unknown instant within it
        add(length > 0 && severityOf(quality) === BAD ? Math.max(point[0], point[0] + length - point[6]) : point[0], next,
            length > 0 || point[1] !== null ? severityOf(quality) : BAD);
    });
    return out;
}

// Returns for each data source its first and last tag: [{ source, tags: [name] }], for at most `most` sources. If both tags
// have no values, the page treats the source as lost.
export function witnesses(tags, most = 16) {
    const ends = new Map();
    for (const { source, name } of tags.filter((tag) => tag.source))
        ends.set(source, [ends.get(source)?.[0] ?? name, name]);
    return [...ends].slice(0, most).map(([source, pair]) => ({ source, tags: [...new Set(pair)] }));
}

// Returns the periods in which none of the given series has a value: [[from, to]], microseconds.
export function lost(all, fromUs, toUs) {
    let common = [[fromUs, toUs]];
    for (const series of all) {
        const bad = gaps(series, fromUs, toUs).filter(({ severity: grade }) => grade === BAD);
        common = common.flatMap(([begin, end]) => bad.map(({ from, to }) => [Math.max(begin, from * 1e6), Math.min(end, to * 1e6)]))
            .filter(([begin, end]) => begin < end);
    }
    return all.length > 0 ? common : [];
}

// Returns the distinct alarm limits of tags, to be drawn as lines: [{ scale, name, value, tags }]. scaleOf(tag) returns the
// tag's axis. tags: those that have the limit; empty if all tags on that axis have it.
export function limitLines(tags, scaleOf) {
    const lines = new Map();
    for (const tag of tags) {
        for (const [name, value] of Object.entries(tag.limits ?? {}).filter(([, limit]) => Number.isFinite(limit))) {
            const scale = scaleOf(tag), key = JSON.stringify([scale, name, value]);
            const line = lines.get(key) ?? { scale, name, value, tags: [] };
            line.tags.push(tag);
            lines.set(key, line);
        }
    }
    return [...lines.values()].map((line) => (line.tags.length === tags.length ? { ...line, tags: [] } : line));
}

// Returns the rows of the alarm journal that raise an annunciated alarm (not shelved, suppressed or out of service): [{ us, tag, kind,
// priority }], oldest first.
export function raised(rows) {
    return rows.filter(({ event, state }) => event === 'raise' && calls(state))
        .map(({ time_us: us, tag, kind, priority }) => ({ us, tag, kind, priority }))
        .sort((a, b) => a.us - b.us);
}

// Returns the first alarm raised after a time, or with `backwards` the last one before it; of several at one instant the most urgent.
// marks: alarms as raised() returns them. null: there is none.
export function nextTo(marks, us, backwards) {
    const found = backwards ? marks.findLast((mark) => mark.us < us) : marks.find((mark) => mark.us > us);
    return marks.filter((mark) => mark.us === found?.us).sort((a, b) => a.priority - b.priority)[0] ?? null;
}

// Groups alarms (`marks`, as raised() returns them) that were raised within nearUs of each other: { us, priority (time and
// priority of the most urgent one), of: all alarms of the group }.
export function clustered(marks, nearUs) {
    const out = [];
    for (const mark of marks) {
        const last = out.at(-1);
        if (last && mark.us - last.of[0].us < nearUs)
            last.of.push(mark);
        else
            out.push({ of: [mark] });
    }
    return out.map(({ of }) => ({ ...of.reduce((gravest, mark) => (mark.priority < gravest.priority ? mark : gravest)), of }));
}

const MOST_BINS = 5000;

// Counts the alarms raised (`marks`, as raised() returns them) in `count` equal parts of a time span: { bins: [{ count, priority (of the
// most urgent) }], most (largest count of a part) }.
export function density(marks, fromUs, toUs, count) {
    const bins = Array.from({ length: Math.max(1, Math.min(MOST_BINS, Math.floor(count) || 1)) }, () => ({ count: 0, priority: Infinity }));
    for (const { us, priority } of marks) {
        const bin = bins[Math.floor(((us - fromUs) / (toUs - fromUs)) * bins.length)];
        if (bin)
            Object.assign(bin, { count: bin.count + 1, priority: Math.min(bin.priority, priority) });
    }
    return { bins, most: bins.reduce((most, bin) => Math.max(most, bin.count), 0) };
}

// Returns how many seconds one press of an arrow key moves a time slider that covers spanS seconds; at most a minute.
export const arrowS = (spanS) => Math.max(1, Math.min(60, Math.round(spanS / 900)));
