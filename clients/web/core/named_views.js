// SPDX-License-Identifier: GPL-3.0-or-later
// Views with names: from the text that one is kept as, to what a session shows and to the query of its picture; and the other way.
import { addressOf, readAddress } from './address.js';
import { snapshotQuery } from './query.js';
import { ENGINEERS } from './session.js';

const ID_CHARS = 48, NOWHERE = { eye: [], target: [], fov: 0 };

// The text that keeps what a session shows now: without the instant, which has gone by when it is looked at again.
export const textOf = (session, tag = null) => {
    const { camera, params, ownParams } = session;
    return addressOf({ camera, params, time: null, ownParams }, tag).slice(1);
};

// { camera, params, tag } that bring a session to that view, whatever it shows. One without a camera is seen from home.
export function viewOf(session, text) {
    const { camera, params, tag } = readAddress(text), group = session.model.group(params.group) ?? session.group;
    const plain = { ...session.ownOf(group), range: null, ramp_interval: 0, breaks: group.breaks?.length ? 'group' : null,
        split: null, selected: null, clip: null, sensors: null };
    const all = { ...plain, ...params };
    if (session.role !== 'engineer')
        ENGINEERS.forEach((name) => delete all[name]);
    const { width, height, pixel_ratio: ratio = 1 } = session.size;
    return { camera: camera ?? session.homeIn(width / ratio, height / ratio), params: all, tag };
}

// The query for a small picture of it: from where the server looks, if it has no camera of its own.
export function pictureQuery(text, size) {
    const { camera, params } = readAddress(text);
    ENGINEERS.forEach((name) => delete params[name]);
    const query = snapshotQuery({ carried: { ...params, selected: null }, camera: camera ?? NOWHERE, size, time: { atUs: null } });
    if (!camera)
        delete query.camera;
    return query;
}

// An id for a title, which no other view has.
export function idFor(title, views) {
    const plain = title.normalize('NFKD').replace(/\p{M}/gu, '').toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-+|-+$/g, '');
    const base = (plain || 'view').slice(0, ID_CHARS - 4), taken = new Set(views.map(({ id }) => id));
    let id = base;
    for (let n = 2; taken.has(id); n++)
        id = `${base}-${n}`;
    return id;
}
