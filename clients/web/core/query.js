// SPDX-License-Identifier: GPL-3.0-or-later
// Writes and reads parameters as text for the page's URL and for snapshot queries, in the grammar of /snapshot.png (protocol/HTTP.md).

const round = (x) => Number(x.toFixed(4)) + 0;
// Writes coordinates in metres, or components of directions, with at most 4 decimals.
export const numbersText = (list) => list.map(round).join(',');
// Writes a parameter with a list of numbers. Values of a sensor group may be small, so they are not rounded.
export const listText = (name, list) => (name === 'light' ? numbersText(list) : list.join(','));

// Parses a comma-separated list of numbers; null if it is invalid or does not have `count` numbers. count null: any number.
export function readNumbers(text, count = null) {
    const list = (text ?? '').split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
    return list.every(Number.isFinite) && (count === null || list.length === count) ? list : null;
}

// Writes an instant with microseconds. With milliseconds only, an address of an alarm's instant would show the plant just before the alarm.
export function instantText(us) {
    const whole = Math.round(us), text = new Date(Math.floor(whole / 1000)).toISOString();
    return whole % 1000 ? `${text.slice(0, -1)}${String(whole % 1000).padStart(3, '0')}Z` : text;
}

// Parses a date and time with up to 6 decimals of the second; NaN if it is invalid.
export function readInstant(text) {
    const [, begin = text, micros = '', zone = ''] = text.match(/^(.*\.\d{3})(\d{1,3})\d*(.*)$/) ?? [];
    return Date.parse(begin + zone) * 1000 + Number(micros.padEnd(3, '0'));
}

// Writes the factors of single sensors, { tag: { strength, decay } }, as TAG=STRENGTH[:DECAY],...
export function sensorsText(sensors) {
    const factors = ({ strength = null, decay = null }) => `${strength ?? ''}${decay === null ? '' : `:${decay}`}`;
    return Object.entries(sensors).filter(([, own]) => own).map(([tag, own]) => `${tag}=${factors(own)}`).join(',');
}

export function readSensors(text) {
    const all = {};
    for (const part of (text ?? '').split(',').filter(Boolean)) {
        const equals = part.lastIndexOf('='), [strength, decay = ''] = part.slice(equals + 1).split(':');
        const given = [['strength', strength], ['decay', decay]].filter(([, n]) => n !== '');
        const own = Object.fromEntries(given.map(([name, n]) => [name, Number(n)]));
        if (equals < 1 || Object.keys(own).length === 0 || !Object.values(own).every((n) => n >= 0 && n <= 100))
            return null;
        all[part.slice(0, equals)] = own;
    }
    return Object.keys(all).length > 0 ? all : null;
}

export function clipText({ planes, box }) {
    return planes ? planes.map(numbersText).join(';') : numbersText([...box.min, ...box.max]);
}

const LISTS = ['range', 'light', 'breaks', 'isolines'], NAMES = ['hidden', 'isolate', 'ghost'];
const APART = ['split', 'clip', 'baseline']; // see snapshotQuery
// Parameters whose default from the sensor group a user can remove. The query then says `none`.
const REMOVABLE = ['isolines', 'reach_m'];
const isNone = (value) => value === null || (Array.isArray(value) && value.length === 0);

function text(name, value) {
    if (REMOVABLE.includes(name) && isNone(value))
        return 'none';
    if (LISTS.includes(name))
        return listText(name, value);
    if (NAMES.includes(name))
        return value.join(',');
    return name === 'sensors' ? sensorsText(value) : String(value);
}

const isWritten = ([name, value]) => !APART.includes(name) && value !== undefined &&
    (!isNone(value) || REMOVABLE.includes(name) || (value !== null && NAMES.includes(name)));

// Returns the query of /snapshot.png for a picture of a session's view. carried: the view's parameters, as Session.carried() returns them.
export function snapshotQuery({ carried, camera, size, time }) {
    const query = { width: size.width, height: size.height };
    for (const [name, value] of Object.entries(carried).filter(isWritten))
        query[name] = text(name, value);
    if (carried.baseline)
        query.baseline = carried.baseline;
    if (carried.clip)
        query[carried.clip.planes ? 'clip' : 'clip_box'] = clipText(carried.clip);
    if (carried.split)
        query.split = Object.entries(carried.split).filter(isWritten).map(([name, value]) => `${name}=${text(name, value)}`).join(';');
    const parallel = camera.height_m !== undefined;
    query.camera = numbersText([...camera.eye, ...camera.target, ...(parallel ? [] : [camera.fov])]);
    query.up = numbersText(camera.up);
    if (parallel)
        Object.assign(query, { projection: 'orthographic', height_m: camera.height_m });
    if (time.atUs !== null)
        query.at = instantText(time.atUs);
    return query;
}
