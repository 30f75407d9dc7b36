// SPDX-License-Identifier: GPL-3.0-or-later
// Formats numbers, units, times and qualities for the screen.

import { QUALITIES } from './model.js';
import { locale, say } from './words.js';

const UNITS = { degC: '°C', degF: '°F', 'deg C': '°C', 'deg F': '°F', C: '°C' };

// Returns a unit in the spelling of the page, such as °C for degC and m³ for m3.
export function unitText(unit) {
    return UNITS[unit] ?? (unit ?? '').replace(/\^?2\b/, '²').replace(/\^?3\b/, '³').replace(/\bu(?=m\b)/, 'µ');
}

// Returns the number of decimals for values that span `range`: one for a range of 160, two for a range of 16.
export function decimalsFor(range) {
    return range > 0 && Number.isFinite(range) ? Math.max(0, Math.min(6, 2 - Math.floor(Math.log10(range / 4)))) : 2;
}

// Returns the number of decimals for a value of a sensor group, or of any { min, max, scale }; null: unknown group. On a
// logarithmic scale, the number follows the value's size, because values near the lower end may be far smaller than the range.
export function decimalsOf(group, value) {
    if (!group)
        return 2;
    return decimalsFor(group.scale === 'log' ? Math.abs(value) || group.min : group.max - group.min);
}

const DECIMAL = new Intl.NumberFormat(locale).format(0.5).replace(/[\d٠-٩]/g, '');
const inLocale = (text) => text.replace('-', '−').replace('.', DECIMAL);

const known = (value) => value !== null && value !== undefined && Number.isFinite(value);

function plainText(value, decimals) {
    const text = value.toFixed(decimals);
    return Number(text) === 0 ? text.replace('-', '') : text;
}

// Formats a number in the reader's locale, without thousands separators, which might be read as decimal marks.
export const numberText = (value, decimals) => (known(value) ? inLocale(plainText(value, decimals)) : '–');

// Formats a value of a sensor group, with decimalsOf(group, value) decimals.
export const valueText = (group, value) => numberText(value, decimalsOf(group, value));

// Formats a number without trailing zeros.
export const shortNumberText = (value, decimals) =>
    (known(value) ? inLocale(plainText(value, decimals).replace(/(\.\d*?)0+$/, '$1').replace(/\.$/, '')) : '–');

// Formats a difference between two values, with its sign.
export function changeText(value, decimals) {
    const text = numberText(value, decimals);
    return text === '–' ? 'Δ –' : `Δ ${/[1-9]/.test(text) && value > 0 ? '+' : ''}${text}`;
}

export function ageText(ms) {
    if (ms === null || ms === undefined || !Number.isFinite(ms))
        return '–';
    const s = Math.max(0, ms) / 1000;
    if (s < 9.95)
        return say('age.s', { n: numberText(s, 1) });
    if (s < 120)
        return say('age.s', { n: Math.round(s) });
    if (s < 7200)
        return say('age.min', { n: Math.floor(s / 60) });
    return s < 172800 ? say('age.h', { n: Math.floor(s / 3600) }) : say('age.d', { n: Math.floor(s / 86400) });
}

const two = (n) => String(n).padStart(2, '0');
const clocks = new Map(); // formatters by time zone, because creating one is slow

// Returns a function from an instant to { date, day (date without the year), time, offset } in the time zone with this IANA
// name, in the reader's date format; hours are 0 to 23. If the browser does not know the zone, the times are in UTC and
// labelled as UTC.
export function zoneClock(timeZone) {
    if (!clocks.has(timeZone))
        clocks.set(timeZone, makeClock(zoneOf(timeZone)));
    return clocks.get(timeZone);
}

// Returns the time zone with this IANA name, or UTC if the browser does not know it.
export function zoneOf(name) {
    try {
        return new Intl.DateTimeFormat('en', { timeZone: name }).resolvedOptions().timeZone;
    } catch {
        return 'UTC';
    }
}

function makeClock(timeZone) {
    const options = { hour: '2-digit', minute: '2-digit', second: '2-digit', hourCycle: 'h23', timeZoneName: 'longOffset', timeZone };
    const clock = new Intl.DateTimeFormat('en-GB', options), dates = new Intl.DateTimeFormat(locale, { dateStyle: 'medium', timeZone });
    const days = new Intl.DateTimeFormat(locale, { month: 'short', day: 'numeric', timeZone });
    return (utcMs) => {
        const part = Object.fromEntries(clock.formatToParts(utcMs).map((p) => [p.type, p.value]));
        const offset = part.timeZoneName.replace('GMT', 'UTC').replace('-', '−');
        return {
            date: dates.format(utcMs), day: days.format(utcMs),
            time: `${two(part.hour)}:${part.minute}:${part.second}`,
            offset: offset === 'UTC+00:00' ? 'UTC' : offset,
        };
    };
}

// dayTime() returns an instant in milliseconds as its day and time (`digits` 5: without seconds), dateTime() as its date with the year and
// time without seconds. clock: from zoneClock().
export function dayTime(clock, ms, digits = 8) {
    const { day, time } = clock(ms);
    return `${day} ${time.slice(0, digits)}`;
}

export function dateTime(clock, ms) {
    const { date, time } = clock(ms);
    return `${date} ${time.slice(0, 5)}`;
}

// Returns an instant in milliseconds as text: its time (`digits` 5: without seconds) if it is on the same day as the instant
// nowMs, otherwise its day and time without seconds. clock: from zoneClock().
export function timeOrDay(clock, ms, nowMs, digits = 8) {
    const { date, time } = clock(ms);
    return date === clock(nowMs).date ? time.slice(0, digits) : dayTime(clock, ms, 5);
}

export const qualityText = (quality) => say(QUALITIES.includes(quality) ? `quality.${quality}` : 'quality.unknown');
