// SPDX-License-Identifier: GPL-3.0-or-later
// What can be done about alarms, and those that somebody has set aside.
import { calls } from './alarms.js';

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
