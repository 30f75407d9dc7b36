// SPDX-License-Identifier: GPL-3.0-or-later
// Says which actions on an alarm (acknowledge, shelve, ...) a user may do, by role and the alarm's state, and lists the alarms that are
// shelved, suppressed or out of service.
import { calls, isGone } from './alarms.js';

const ACTIONS = { // actions by alarm state, for alarms that Plantcast manages itself
    unacknowledged: ['acknowledge', 'shelve'], returned: ['acknowledge', 'shelve'], acknowledged: ['shelve'],
    latched: ['acknowledge', 'reset'],
    shelved: ['unshelve'], out_of_service: ['in_service'],
};
const ROLES = { in_service: ['engineer'] };

// Returns the actions that a role may take on an alarm in this state. mode: the plant's alarm mode; only in mode `local`, in
// which Plantcast manages the alarms itself, are there any actions.
export function actionsFor({ state }, mode, role) {
    const may = (action) => (ROLES[action] ?? ['operator', 'engineer']).includes(role);
    return mode === 'local' ? (ACTIONS[state] ?? []).filter(may) : [];
}

// Returns the alarms that are shelved, suppressed or out of service, in the order of the tag list.
export const asideOf = ({ rows }) =>
    [...rows.values()].filter(({ state }) => !calls(state)).sort((a, b) => (a.tag.index ?? -1) - (b.tag.index ?? -1));

// Returns all alarms of a row in the alarm list: the alarm shown in the row, and the other alarms of its tag.
export const allOf = (row) => [row, ...(row.others ?? [])];

// Returns the alarms of a row to which an action applies.
export const targetsOf = (row, action, mode, role) => allOf(row).filter((alarm) => actionsFor(alarm, mode, role).includes(action));

// Returns the actions that apply to any alarm of a row, each once.
export const rowActions = (row, mode, role) => [...new Set(allOf(row).flatMap((alarm) => actionsFor(alarm, mode, role)))];

const IS = { // predicates by filter choice
    all: () => true, waiting: ({ waiting }) => waiting, active: ({ state }) => !isGone(state), gone: ({ state }) => isGone(state),
};

// Returns true if a row of the alarm list passes the filter. which: `all`, `waiting` (unacknowledged), `active`, `gone`
// (returned to normal), or a priority; words: each must occur in the row's text.
export function passes(row, text, { which, words }) {
    const is = IS[which] ?? (({ priority }) => priority === Number(which)), lower = text.toLowerCase();
    return is(row) && words.toLowerCase().split(/\s+/).every((word) => lower.includes(word));
}

// Splits a list of alarms into lists of at most MOST_AT_ONCE, each small enough for one message to the server.
const MOST_AT_ONCE = 256;
export function inMessages(alarms) {
    const out = [];
    for (let i = 0; i < alarms.length; i += MOST_AT_ONCE)
        out.push(alarms.slice(i, i + MOST_AT_ONCE));
    return out;
}
