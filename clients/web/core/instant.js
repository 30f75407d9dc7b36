// SPDX-License-Identifier: GPL-3.0-or-later
// Converts times to and from the text of a date field, in the plant's time zone.
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
