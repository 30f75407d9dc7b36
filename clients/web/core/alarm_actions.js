// SPDX-License-Identifier: GPL-3.0-or-later
// What can be done about alarms, and those that somebody has set aside.
import { calls, isGone } from './alarms.js';

const ACTIONS = { // by state; what can be done where the site keeps its own alarms
    unacknowledged: ['acknowledge', 'shelve'], returned: ['acknowledge', 'shelve'], acknowledged: ['shelve'],
    latched: ['acknowledge', 'reset'],
    shelved: ['unshelve'], out_of_service: ['in_service'],
};
const ROLES = { in_service: ['engineer'] };

// mode: of the site; role: of who asks.
export function actionsFor({ state }, mode, role) {
    const may = (action) => (ROLES[action] ?? ['operator', 'engineer']).includes(role);
    return mode === 'local' ? (ACTIONS[state] ?? []).filter(may) : [];
}

export const asideOf = ({ rows }) =>
    [...rows.values()].filter(({ state }) => !calls(state)).sort((a, b) => (a.tag.index ?? -1) - (b.tag.index ?? -1));

// A row of the list stands for all alarms of its tag: the gravest, and its others.
export const allOf = (row) => [row, ...(row.others ?? [])];

// Those of a row to which an action can be done.
export const targetsOf = (row, action, mode, role) => allOf(row).filter((alarm) => actionsFor(alarm, mode, role).includes(action));

// What can be done about a row, each action once.
export const rowActions = (row, mode, role) => [...new Set(allOf(row).flatMap((alarm) => actionsFor(alarm, mode, role)))];

const IS = { // by choice of the filter
    all: () => true, waiting: ({ waiting }) => waiting, active: ({ state }) => !isGone(state), gone: ({ state }) => isGone(state),
};

// Whether a filter lets a row through. which: a name of IS, or a priority; words: all of them are in the text of the row.
export function passes(row, text, { which, words }) {
    const is = IS[which] ?? (({ priority }) => priority === Number(which)), lower = text.toLowerCase();
    return is(row) && words.toLowerCase().split(/\s+/).every((word) => lower.includes(word));
}

// Of several at once, as many messages as it takes.
const MOST_AT_ONCE = 256;
export function inMessages(alarms) {
    const out = [];
    for (let i = 0; i < alarms.length; i += MOST_AT_ONCE)
        out.push(alarms.slice(i, i + MOST_AT_ONCE));
    return out;
}
