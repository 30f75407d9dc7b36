// SPDX-License-Identifier: GPL-3.0-or-later
// Saved views: converts between a view's text, a session's state, and the query for a picture of the view.
import { addressOf, readAddress } from './address.js';
import { ENGINEERS, maySendAll, withoutEngineers } from './session.js';

const ID_CHARS = 48;

// Returns the session's view as text, without the instant that is shown.
export const textOf = (session, tag = null) => {
    const { camera, params, ownParams } = session;
    return addressOf({ camera, params, time: null, ownParams }, tag).slice(1);
};

// Returns the interpolation that the server selects for a group if a view names none.
function interpolationOf({ interpolation, prepared = [] }, show) {
    if (show === 'uncertainty' && prepared.includes('gp'))
        return 'gp';
    if (show === 'operator' && interpolation === 'fin')
        return prepared.includes('harmonic') ? 'harmonic' : 'shepard';
    return interpolation;
}

// Returns the group, interpolation, environment and colour map with which the server begins a new view.
function defaultsOf({ model }, group, show) {
    const { environments: [sky, panorama = sky], colormaps } = model;
    return { group: group.id, interpolation: interpolationOf(group, show), environment: panorama,
        colormap: show === 'difference' ? 'diverging' : colormaps[0].name };
}

// Returns { camera, params, tag } that turn any state of a session into the saved view. A view without a camera gets the home
// camera, which shows the whole plant. If the user is no engineer, params contain no engineer-only parameters. The server then takes them
// from the saved view `id`, or from a new view if there is no id.
export function viewOf(session, text, id) {
    const { model } = session, { camera, params, tag } = readAddress(text), group = model.group(params.group) ?? model.groups[0];
    const show = params.show ?? model.plant.show ?? 'value';
    const plain = { ...session.ownOf(group), ...(group ? defaultsOf(session, group, show) : {}), show, arrows: 'arrows', look: 'default',
        range: null, ramp_interval: 0, breaks: null, light: null, split: null, selected: null, clip: null, sensors: null };
    if (show !== 'value') // isolines and scale of the group are for values
        Object.assign(plain, { isolines: [], scale: show === 'blind' ? 'log' : 'linear' });
    const all = { ...plain, ...params };
    const sent = maySendAll(session.role) ? all : { ...withoutEngineers(all), named: id ?? null };
    const { width, height, pixel_ratio: ratio = 1 } = session.size;
    return { camera: camera ?? session.homeIn(width / ratio, height / ratio), params: sent, tag };
}

// Returns the parameters of a new view of a tag's group, in which the tag's equipment is visible. tag.group null: the group that is shown.
export function newView(session, { group, asset }) {
    const id = group ?? session.params.group, { params } = viewOf(session, id ? `group=${encodeURIComponent(id)}` : '');
    const [hidden, ghost] = [params.hidden, params.ghost].map((ids) => ids.filter((one) => one !== asset));
    return { ...params, hidden, ghost };
}

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
