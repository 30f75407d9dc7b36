// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the view to the fragment of the page's URL (after #) and reads it, so that a reload or a shared link shows the same view.
import { valid } from './camera.js';
import { clipText, instantText, listText, numbersText, readInstant, readNumbers, readSensors, sensorsText } from './query.js';
import { withoutEngineers } from './session.js';

const CHOICES = {
    // parameter of the view -> its valid names; null: any name, which the server checks
    group : null,
    interpolation : null,
    distance : null,
    colormap : null,
    look : [ 'default', 'glossy', 'flat', 'materials' ],
    fill : [ 'none', 'neighbours' ],
    scale : [ 'linear', 'log' ],
    // 'difference' needs a baseline: see writeAddress() and readAddress()
    show : [ 'value', 'operator', 'distance', 'uncertainty', 'blind' ],
    arrows : [ 'strokes', 'none' ], // 'arrows' is the default and is not written
    sensor : null,
    environment : null,
};
const SETS = { hide: 'hidden', only: 'isolate', ghost: 'ghost' }; // lists of assets
// parameter with a list of numbers -> how many numbers it must have; null: any number
const LISTS = { range: 2, light: 3, breaks: null, isolines: null };
// numeric parameter -> default value, which the address leaves out; null: the default of the shown sensor group
const FACTORS = { strength: 1, decay: 1, power: null, radius: 0, reach: null };
const PARAMS = { radius: 'radius_m', reach: 'reach_m' };
const HALF = ['group', 'show', 'distance', 'interpolation', 'colormap', 'look'];

// Returns the fragment for a view. own: default values of parameters, such as those of the sensor group; parameters with these
// values are left out. named: id of the saved view that supplies the engineer-only parameters.
export function writeAddress({ camera, params: all = {}, tag = null, time = null, own = {}, named = null }) {
    const params = named ? withoutEngineers(all) : all;
    const parts = [], differs = (name) => JSON.stringify(params[name]) !== JSON.stringify(own[name]);
    const put = (name, value) => parts.push(`${name}=${encodeURIComponent(value).replace(/%2C|%3A|%3B/g, decodeURIComponent)}`);
    for (const name of Object.keys(CHOICES)) {
        if (params[name] && (!CHOICES[name] || CHOICES[name].includes(params[name])))
            put(name, params[name]);
    }
    if (params.show === 'difference' && params.baseline?.name) {
        put('show', params.show);
        put('baseline', params.baseline.name);
    }
    if (params.ramp_interval > 0)
        put('ramp', params.ramp_interval);
    for (const name of Object.keys(LISTS)) {
        if (params[name]?.length > 0 && differs(name))
            put(name, listText(name, params[name]));
        else if (name === 'isolines' && own[name]?.length > 0 && (params[name] === null || params[name]?.length === 0))
            put(name, 'none');
    }
    for (const [name, usual] of Object.entries(FACTORS)) {
        const value = params[PARAMS[name] ?? name];
        if (Number.isFinite(value) && value !== usual && differs(PARAMS[name] ?? name))
            put(name, value);
        else if (name === 'reach' && value === null && Number.isFinite(own.reach_m))
            put(name, 'none');
    }
    if (Object.keys(params.sensors ?? {}).length > 0)
        put('sensors', sensorsText(params.sensors));
    if (params.split)
        put('split', HALF.filter((name) => params.split[name] && params.split[name] !== params[name])
            .map((name) => `${name}:${params.split[name]}`).join(';') || 'same');
    if (params.selected)
        put('asset', params.selected);
    for (const [name, param] of Object.entries(SETS)) {
        if (params[param] && differs(param)) // an empty list of assets is written, too, if the plant file's default list is not empty
            put(name, params[param].join(','));
    }
    if (params.clip)
        put('clip', clipText(params.clip));
    if (tag)
        put('tag', tag);
    if (time?.atUs)
        put('at', instantText(time.atUs));
    if (named)
        put('named', named);
    if (camera)
        put('camera', numbersText([...camera.eye, ...camera.target, ...camera.up, camera.fov, camera.height_m ?? []].flat()));
    return parts.length > 0 ? `#${parts.join('&')}` : '';
}

export const addressOf = ({ camera, params, time, ownParams: own, named }, tag) => writeAddress({ camera, params, tag, time, own, named });

// Parses the text of a split view's right half, such as group:pressure;look:flat
function readSplit(text) {
    const pairs = text.split(';').map((part) => [part.slice(0, part.indexOf(':')), part.slice(part.indexOf(':') + 1)]);
    return Object.fromEntries(pairs.filter(([name, value]) => HALF.includes(name) && value));
}

function readClip(text) {
    const lists = text.split(';').map((part) => part.split(',').map(Number));
    if (!lists.flat().every(Number.isFinite))
        return null;
    if (lists.length === 1 && lists[0].length === 6)
        return { box: { min: lists[0].slice(0, 3), max: lists[0].slice(3) } };
    return lists.length <= 6 && lists.every((plane) => plane.length === 4) ? { planes: lists } : null;
}

function readCamera(text) {
    const n = (text ?? '').split(',').map(Number);
    const camera = { eye: n.slice(0, 3), target: n.slice(3, 6), up: n.slice(6, 9), fov: n[9] };
    if (n.length === 11)
        camera.height_m = n[10];
    return (n.length === 10 || n.length === 11) && valid(camera) ? camera : null;
}

// Parses a fragment, skipping invalid parts. Returns { camera or null, params (only those in the fragment), tag or null, time: { atUs } if
// the fragment has an instant }.
export function readAddress(hash) {
    const fields = new URLSearchParams(hash.replace(/^#/, ''));
    const params = {};
    for (const [name, allowed] of Object.entries(CHOICES)) {
        const value = fields.get(name);
        if (value && (!allowed || allowed.includes(value)))
            params[name] = value;
    }
    const ramp = Number(fields.get('ramp'));
    if (fields.has('ramp') && Number.isFinite(ramp) && ramp >= 0)
        params.ramp_interval = ramp;
    for (const [name, count] of Object.entries(LISTS)) {
        const list = readNumbers(fields.get(name), count);
        if (list && (name !== 'light' || list.some((n) => n !== 0)) && (name !== 'range' || list[0] < list[1]))
            params[name] = list;
    }
    if (fields.get('isolines') === 'none')
        params.isolines = [];
    for (const name of Object.keys(FACTORS)) {
        const [value] = readNumbers(fields.get(name), 1) ?? [-1];
        if (value >= 0)
            params[PARAMS[name] ?? name] = value;
    }
    if (fields.get('reach') === 'none')
        params.reach_m = null;
    const sensors = readSensors(fields.get('sensors'));
    if (sensors)
        params.sensors = sensors;
    if (fields.get('split'))
        params.split = readSplit(fields.get('split'));
    if (fields.get('show') === 'difference' && fields.get('baseline'))
        Object.assign(params, { show: 'difference', baseline: { name: fields.get('baseline') } });
    for (const [name, param] of Object.entries(SETS)) {
        if (fields.has(name))
            params[param] = fields.get(name).split(',').filter(Boolean);
    }
    const clip = readClip(fields.get('clip') ?? '');
    if (clip)
        params.clip = clip;
    if (fields.get('asset'))
        params.selected = fields.get('asset');
    const atUs = readInstant(fields.get('at') ?? ''), time = atUs > 0 ? { atUs } : {};
    return { camera: readCamera(fields.get('camera')), params, tag: fields.get('tag') || null, time };
}
