// SPDX-License-Identifier: GPL-3.0-or-later
// The view in the address of the page (what follows #), so that a reload or a shared link shows the same.
import { valid } from './camera.js';

const CHOICES = { // null: any name; the server knows which there are
    group: null, interpolation: ['shepard', 'paper'], distance: ['geodesic', 'euclidean'], colormap: null,
    look: ['default', 'glossy', 'flat'],
};
const round = (x) => Number(x.toFixed(4)) + 0;

export function writeAddress({ camera, params = {}, tag = null }) {
    const parts = [];
    const put = (name, value) => parts.push(`${name}=${encodeURIComponent(value).replace(/%2C/g, ',')}`);
    for (const name of Object.keys(CHOICES)) {
        if (params[name])
            put(name, params[name]);
    }
    if (params.ramp_interval > 0)
        put('ramp', params.ramp_interval);
    if (params.selected)
        put('asset', params.selected);
    if (tag)
        put('tag', tag);
    if (camera)
        put('camera', [...camera.eye, ...camera.target, ...camera.up, camera.fov].map(round).join(','));
    return parts.length > 0 ? `#${parts.join('&')}` : '';
}

function readCamera(text) {
    const n = (text ?? '').split(',').map(Number);
    const camera = { eye: n.slice(0, 3), target: n.slice(3, 6), up: n.slice(6, 9), fov: n[9] };
    return n.length === 10 && valid(camera) ? camera : null;
}

// { camera or null, params (only what the address names), tag or null }. What makes no sense is left out.
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
    if (fields.get('asset'))
        params.selected = fields.get('asset');
    return { camera: readCamera(fields.get('camera')), params, tag: fields.get('tag') || null };
}
