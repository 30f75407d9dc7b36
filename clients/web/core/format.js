// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers, units, times and qualities in the words that the screen shows.

const UNITS = { degC: '°C', degF: '°F', 'deg C': '°C', 'deg F': '°F', C: '°C' };

export function unitText(unit) {
    return UNITS[unit] ?? (unit ?? '').replace(/\^?2\b/, '²').replace(/\^?3\b/, '³').replace(/\bu(?=m\b)/, 'µ');
}

// As many decimals as an instrument of this range has: 0..160 one, 0..16 two.
export function decimalsFor(range) {
    return range > 0 && Number.isFinite(range) ? Math.max(0, Math.min(6, 2 - Math.floor(Math.log10(range / 4)))) : 2;
}

export function numberText(value, decimals) {
    if (value === null || value === undefined || !Number.isFinite(value))
        return '–';
    const text = value.toFixed(decimals);
    return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
}

// A difference, with its sign.
export function changeText(value, decimals) {
    const text = numberText(value, decimals);
    return text === '–' ? 'Δ –' : `Δ ${/[1-9]/.test(text) && value > 0 ? '+' : ''}${text}`;
}

export function ageText(ms) {
    if (ms === null || ms === undefined || !Number.isFinite(ms))
        return '–';
    const s = Math.max(0, ms) / 1000;
    if (s < 9.95)
        return `${s.toFixed(1)} s`;
    if (s < 120)
        return `${Math.round(s)} s`;
    if (s < 7200)
        return `${Math.floor(s / 60)} min`;
    return s < 172800 ? `${Math.floor(s / 3600)} h` : `${Math.floor(s / 86400)} d`;
}

const two = (n) => String(n).padStart(2, '0');

// { date, time, offset } of an instant in a time zone by its IANA name. A zone that the browser does not know is shown as UTC, and says so.
export function zoneClock(timeZone) {
    const options = {
        year: 'numeric', month: '2-digit', day: '2-digit', hour: '2-digit', minute: '2-digit', second: '2-digit', hourCycle: 'h23',
        timeZoneName: 'longOffset',
    };
    let format;
    try {
        format = new Intl.DateTimeFormat('en-GB', { ...options, timeZone });
    } catch {
        format = new Intl.DateTimeFormat('en-GB', { ...options, timeZone: 'UTC' });
    }
    return (utcMs) => {
        const part = Object.fromEntries(format.formatToParts(utcMs).map((p) => [p.type, p.value]));
        const offset = part.timeZoneName.replace('GMT', 'UTC').replace('-', '−');
        return {
            date: `${part.year}-${part.month}-${part.day}`,
            time: `${two(part.hour)}:${part.minute}:${part.second}`,
            offset: offset === 'UTC+00:00' ? 'UTC' : offset,
        };
    };
}

export const QUALITIES = ['good', 'uncertain', 'bad']; // from best to worst
const QUALITY_WORDS = { good: 'Good', uncertain: 'Uncertain', bad: 'Bad' };

// "bad", "Bad_SensorFailure" -> "Bad: sensor failure"
export function qualityText(quality, name = '') {
    const word = QUALITY_WORDS[quality] ?? 'Unknown';
    const detail = String(name ?? '').replace(/^(good|uncertain|bad)[_ :]*/i, '').replace(/_/g, ' ')
        .replace(/([a-z])([A-Z])/g, '$1 $2').trim().toLowerCase();
    return detail ? `${word}: ${detail}` : word;
}

export const worst = (qualities) => QUALITIES[Math.max(-1, ...qualities.map((q) => QUALITIES.indexOf(q)))] ?? null;
