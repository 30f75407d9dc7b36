// SPDX-License-Identifier: GPL-3.0-or-later
// Converts times to and from the text of a date field, and chooses the ticks of a time axis, in the plant's time zone.
import { zoneClock } from './format.js';

function offsetMs(clock, utcMs) {
    const [, sign, hours, minutes, seconds] = clock(utcMs).offset.match(/([+−])(\d\d):(\d\d)(?::(\d\d))?/) ?? [];
    return sign ? (sign === '+' ? 1 : -1) * ((Number(hours) * 60 + Number(minutes)) * 60 + Number(seconds ?? 0)) * 1000 : 0;
}

// Returns an instant as the text of a date field, such as 2026-11-22T07:27:02.
export function fieldText(us, timeZone) {
    const utcMs = Math.floor(us / 1e6) * 1000;
    return new Date(utcMs + offsetMs(zoneClock(timeZone), utcMs)).toISOString().slice(0, 19);
}

// Returns the instant of a date field's text in microseconds UTC, or null if the text is no date. When the clocks change, a time that
// occurs twice means the first one, and a skipped time means the hour after it.
export function fieldInstant(text, timeZone) {
    const [, date, time = '00:00', seconds = ''] = text.trim().match(/^(\d{4}-\d\d-\d\d)(?:[T ](\d\d:\d\d)(:\d\d)?(?:\.\d+)?)?$/) ?? [];
    const asUtc = date ? Date.parse(`${date}T${time}${seconds || ':00'}Z`) : NaN, clock = zoneClock(timeZone);
    if (!Number.isFinite(asUtc) || !new Date(`${date}T00:00Z`).toISOString().startsWith(date)) // 30 February
        return null;
    // UTC offsets a day before and a day after the instant, because the clocks may change in between
    const offsets = [-86400e3, 86400e3].map((off) => offsetMs(clock, asUtc + off));
    const wanted = new Date(asUtc).toISOString().slice(0, 19);
    const fits = offsets.map((offset) => asUtc - offset).filter((utcMs) => fieldText(utcMs * 1000, timeZone) === wanted);
    return (fits.length > 0 ? Math.min(...fits) : asUtc - offsets[0]) * 1000;
}

const MOST_TICKS = 1000;
const STEPS_S = [1, 5, 10, 30, 60, 300, 600, 1800, 3600, 7200, 14400, 28800, 43200, 86400, 172800, 604800];

// Returns at most about `most` times between two instants, in microseconds, for the ticks of a time axis. They are round in the time zone,
// and at least leastS apart: with a day, they are midnights. Returns none if an instant is not finite or the instants are centuries apart.
export function ticks(fromUs, toUs, most, timeZone, leastS = 1) {
    const out = [], step = (STEPS_S.find((s) => s >= leastS && (toUs - fromUs) / (s * 1e6) <= most) ?? STEPS_S.at(-1)) * 1000;
    if (!((toUs - fromUs) / (step * 1000) <= MOST_TICKS && Math.abs(fromUs) < Number.MAX_SAFE_INTEGER))
        return out;
    // steps in local time, because days with a change of the clocks are longer or shorter
    const beginMs = Date.parse(`${fieldText(fromUs, timeZone)}Z`);
    let offset = beginMs - Math.floor(fromUs / 1e6) * 1000, lastUs = null;
    const isRound = (us) => Date.parse(`${fieldText(us, timeZone)}Z`) % step === 0;
    for (let localMs = Math.floor(beginMs / step) * step; ; localMs += step) {
        const text = new Date(localMs).toISOString().slice(0, 19), likelyUs = (localMs - offset) * 1000;
        const us = fieldText(likelyUs, timeZone) === text ? likelyUs : fieldInstant(text, timeZone);
        // a gap of more than a step, because the clocks are set back: adds the ticks of the repeated hour
        for (let againUs = (lastUs ?? us) + step * 1000; againUs < us && againUs <= toUs; againUs += step * 1000) {
            if (againUs >= fromUs && isRound(againUs))
                out.push(againUs);
        }
        if (us > toUs)
            return out;
        offset = localMs - us / 1000;
        const isLater = lastUs === null || us > lastUs; // times that the clocks skip lead to later times of the same hour
        if (isLater && us >= fromUs)
            out.push(us);
        lastUs = isLater ? us : lastUs;
    }
}
