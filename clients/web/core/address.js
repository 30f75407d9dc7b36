// SPDX-License-Identifier: GPL-3.0-or-later
// The view in the address of the page (what follows #), so that a reload or a shared link shows the same.
import { valid } from './camera.js';

const CHOICES = { // null: any name; the server knows which there are
    group: null, interpolation: ['shepard', 'paper'], distance: ['geodesic', 'euclidean'], colormap: null,
    look: ['default', 'glossy', 'flat', 'materials'], fill: ['none', 'neighbours'], scale: ['linear', 'log'],
    show: ['value', 'operator', 'distance'], sensor: null, environment: null,
};
const SETS = { hide: 'hidden', only: 'isolate', ghost: 'ghost' }; // lists of assets
const round = (x) => Number(x.toFixed(4)) + 0;

export function writeAddress({ camera, params = {}, tag = null, time = null }) {
    const parts = [];
    const put = (name, value) => parts.push(`${name}=${encodeURIComponent(value).replace(/%2C/g, ',')}`);
    for (const name of Object.keys(CHOICES)) {
        if (params[name] && (!CHOICES[name] || CHOICES[name].includes(params[name])))
            put(name, params[name]);
    }
    if (params.ramp_interval > 0)
        put('ramp', params.ramp_interval);
    if (params.light)
        put('light', params.light.map(round).join(','));
    if (params.selected)
        put('asset', params.selected);
    for (const [name, param] of Object.entries(SETS)) {
        if (params[param]?.length > 0)
            put(name, params[param].join(','));
    }
    if (params.clip)
        put('clip', writeClip(params.clip));
    if (tag)
        put('tag', tag);
    if (time?.atUs)
        put('at', new Date(time.atUs / 1000).toISOString());
    if (camera)
        put('camera', [...camera.eye, ...camera.target, ...camera.up, camera.fov, camera.height_m ?? []].flat().map(round).join(','));
    return parts.length > 0 ? `#${parts.join('&')}` : '';
}

// Planes as nx,ny,nz,d with semicolons; a box as its six numbers.
function writeClip({ planes, box }) {
    return planes ? planes.map((plane) => plane.map(round).join(',')).join(';') : [...box.min, ...box.max].map(round).join(',');
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

// { camera or null, params (only what the address names), tag or null, time: { atUs } where it names an instant }. What makes no sense is
// left out.
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
    const light = (fields.get('light') ?? '').split(',').map(Number);
    if (light.length === 3 && light.every(Number.isFinite) && light.some((n) => n !== 0))
        params.light = light;
    for (const [name, param] of Object.entries(SETS)) {
        if (fields.get(name))
            params[param] = fields.get(name).split(',');
    }
    const clip = readClip(fields.get('clip') ?? '');
    if (clip)
        params.clip = clip;
    if (fields.get('asset'))
        params.selected = fields.get('asset');
    const at = Date.parse(fields.get('at') ?? '');
    const time = at > 0 ? { atUs: at * 1000 } : {};
    return { camera: readCamera(fields.get('camera')), params, tag: fields.get('tag') || null, time };
}
