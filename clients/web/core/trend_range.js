// SPDX-License-Identifier: GPL-3.0-or-later
// Time ranges of trends: reads what a user types ("last 8 h", "yesterday 22:00 to 06:00"), and zooms and pans. A range is { spanS }, which
// ends at the present, or { fromUs, toUs } (microseconds UTC).
import { fieldInstant, fieldText } from './instant.js';

const DAY_MS = 86400e3;
// spans of a new trend in seconds. The longest is a shift, because operators ask what has changed in their shift.
const NEW_SPANS_S = [900, 3600, 8 * 3600];
export const LEAST_US = 10e6, LONGEST_US = 400 * 86400e6; // shortest and longest range of a chart, in microseconds

// Words for time units in all languages of the page, because users may type in a language other than the page's.
const UNITS = [[1, /^(?:s|sec|seconds?|sek|sekunden?|초)$/], [60, /^(?:m|min|minutes?|minuten?|분)$/],
    [3600, /^(?:h|hours?|hrs?|std|stunden?|시간)$/], [86400, /^(?:d|days?|t|tage?n?|일)$/], [604800, /^(?:w|weeks?|wochen?|주)$/]];
const LAST = /^(?:(?:the )?(?:last|past)|(?:die )?letzten?r?s?|최근|지난)?\s*(\d+(?:[.,]\d+)?)\s*([a-z]+|초|분|시간|일|주)$/;
const TO = /\s*(?:\s(?:to|until|till|bis)\s|\s[-–—]\s|~|부터|–|—)\s*/;
const DAYS = [[0, /^(?:today|heute|오늘)/], [1, /^(?:yesterday|gestern|어제)/], [2, /^(?:vorgestern|그저께|그제)/]];
const NOW = /^(?:now|jetzt|지금)$/;

const tidy = (text) => text.trim().toLowerCase().replace(/\s+/g, ' ').replace(/^(?:from|von) |까지$/g, '');

// Reads one end of a typed range, "[day] [time]": { day (YYYY-MM-DD or null), time (HH:MM:SS or null) }; null: not understood.
function readSide(text, dayAgo) {
    let rest = text, day = null;
    const [ago, word] = DAYS.find(([, pattern]) => pattern.test(rest)) ?? [];
    if (word) {
        day = dayAgo(ago);
        rest = rest.replace(word, '');
    } else if (/^\d{4}-\d\d-\d\d/.test(rest)) {
        day = rest.slice(0, 10);
        rest = rest.slice(10).replace(/^t/, '');
    }
    rest = rest.trim();
    if (!rest)
        return day && { day, time: null };
    const [, hour, minute, second = '00'] = rest.match(/^(\d{1,2}):(\d\d)(?::(\d\d))?(?: uhr)?$/) ?? [];
    return hour && hour < 24 && minute < 60 && second < 60 ? { day, time: `${hour.padStart(2, '0')}:${minute}:${second}` } : null;
}

const dayAfter = (day) => new Date(Date.parse(`${day}T00:00:00Z`) + DAY_MS).toISOString().slice(0, 10);

// Returns the range described by a text, at the time nowUs and in the plant's time zone, or null if the text is not understood.
// A range without a day that would begin in the future is moved a day back.
export function readRange(text, nowUs, timeZone) {
    const typed = tidy(text), [, count, unit] = typed.match(LAST) ?? [];
    if (count) {
        const [seconds] = UNITS.find(([, pattern]) => pattern.test(unit)) ?? [];
        const spanS = Number(count.replace(',', '.')) * seconds;
        return spanS * 1e6 >= LEAST_US && spanS * 1e6 <= LONGEST_US ? { spanS } : null;
    }
    const today = fieldText(nowUs, timeZone).slice(0, 10);
    const dayAgo = (days) => new Date(Date.parse(`${today}T00:00:00Z`) - days * DAY_MS).toISOString().slice(0, 10);
    const instant = (day, time) => fieldInstant(`${day}T${time}`, timeZone);
    const [first, second, ...more] = typed.split(TO).map((side) => side.trim());
    const from = readSide(first, dayAgo);
    if (!from || more.length > 0 || (second === undefined && from.time !== null))
        return null;
    const begin = (day) => instant(day, from.time ?? '00:00:00');
    const end = (day) => {
        if (second === undefined)
            return instant(dayAfter(day), '00:00:00');
        if (NOW.test(second))
            return nowUs;
        const to = readSide(second, dayAgo);
        if (!to)
            return null;
        if (!to.time)
            return instant(dayAfter(to.day), '00:00:00');
        const same = instant(to.day ?? day, to.time);
        return to.day || same > begin(day) ? same : instant(dayAfter(day), to.time);
    };
    let day = from.day ?? today;
    if (!from.day && begin(day) >= nowUs)
        day = dayAgo(1);
    const [fromUs, toUs] = [begin(day), end(day)];
    if (fromUs === null || toUs === null || fromUs >= nowUs)
        return null;
    const until = Math.min(toUs, nowUs);
    return until - fromUs >= LEAST_US && until - fromUs <= LONGEST_US ? { fromUs, toUs: until } : null;
}

// Returns the span in seconds of a new trend: the shortest that shows the whole record, at most a shift. recordedS: seconds
// since the first record; null: unknown.
export const newSpanS = (recordedS) => NEW_SPANS_S.find((spanS) => recordedS !== null && recordedS <= spanS) ?? NEW_SPANS_S.at(-1);

// Returns [from, to] with its length limited and no time after nowUs. If the length changes, the instant `at` keeps its relative position.
function limited(from, to, at, nowUs) {
    const length = Math.max(LEAST_US, Math.min(LONGEST_US, to - from)), part = to > from ? (at - from) / (to - from) : 0.5;
    const ends = Math.min(nowUs, at + (1 - part) * length);
    return [ends - length, ends];
}

// Returns the range with its length multiplied by `factor`. The instant `at` keeps its relative position.
export const zoomed = ([from, to], factor, at, nowUs) => limited(at - (at - from) * factor, at + (to - at) * factor, at, nowUs);

// Returns the range moved by a fraction of its length; positive: later.
export const panned = ([from, to], part, nowUs) =>
    limited(from + (to - from) * part, to + (to - from) * part, (from + to) / 2 + (to - from) * part, nowUs);
