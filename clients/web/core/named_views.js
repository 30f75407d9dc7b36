// SPDX-License-Identifier: GPL-3.0-or-later
// Saved views: converts between a view's text, a session's state, and the query for a picture of the view.
import { addressOf, readAddress } from './address.js';
import { ENGINEERS, withoutEngineers } from './session.js';

const ID_CHARS = 48;

// Returns the session's view as text, without the instant that is shown.
export const textOf = (session, tag = null) => {
    const { camera, params, ownParams } = session;
    return addressOf({ camera, params, time: null, ownParams }, tag).slice(1);
};

// Returns { camera, params, tag } that turn any state of a session into the saved view. A view without a camera gets the home
// camera, which shows the whole plant. id: id of the saved view. If the user is no engineer, params contain this id instead of
// the engineer-only parameters, which the server then takes from the saved view.
export function viewOf(session, text, id) {
    const { camera, params, tag } = readAddress(text), group = session.model.group(params.group) ?? session.group;
    const show = params.show ?? session.model.plant.show ?? 'value';
    const plain = { ...session.ownOf(group), show, arrows: 'arrows', look: 'default', range: null, ramp_interval: 0,
        breaks: group.breaks?.length && params.ramp_interval === undefined ? group.breaks : null,
        split: null, selected: null, clip: null, sensors: null };
    if (show !== 'value') // isolines, breaks and scale of the group are for values
        Object.assign(plain, { isolines: [], breaks: null, scale: show === 'blind' ? 'log' : 'linear' });
    const all = { ...plain, ...params }, isEngineer = session.role === 'engineer';
    const sent = isEngineer ? all : { ...withoutEngineers(all), ...(id ? { named: id } : {}) };
    const { width, height, pixel_ratio: ratio = 1 } = session.size;
    return { camera: camera ?? session.homeIn(width / ratio, height / ratio), params: sent, tag };
}

// Returns the parameters of a new view of a sensor group. group null: the group that is shown.
export const newView = (session, group) => viewOf(session, group ? `group=${encodeURIComponent(group)}` : '').params;

// Returns true if a view has engineer-only parameters.
export function isEngineers(text) {
    const { params } = readAddress(text);
    return ENGINEERS.some((name) => params[name] !== undefined);
}

// Returns a session's engineer-only parameters as text; null: all have their default values.
export function engineersOf({ params, ownParams: own }) {
    const textFrom = (from) => JSON.stringify(ENGINEERS.map((name) => from[name] ?? {})), text = textFrom(params);
    return text === textFrom(own) ? null : text;
}

// Returns the session's current parameters, with the engineer-only ones taken from the saved view `id`.
export function regained(session, id) {
    return { ...withoutEngineers(viewOf(session, textOf(session)).params), named: id };
}

// Makes an id from a title. No other saved view has this id.
export function idFor(title, views) {
    const plain = title.normalize('NFKD').replace(/\p{M}/gu, '').toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-+|-+$/g, '');
    const base = (plain || 'view').slice(0, ID_CHARS - 4), taken = new Set(views.map(({ id }) => id));
    let id = base;
    for (let n = 2; taken.has(id); n++)
        id = `${base}-${n}`;
    return id;
}
