// SPDX-License-Identifier: GPL-3.0-or-later
// Describes to engineers whether the standby, which takes over if this core fails, has the plant that this core shows.
import { say } from './words.js';

// standby: `standby` of the server's message `status`. Returns a sentence; '' if there is no pair of cores, or the standby is
// up to date.
export function standbyText(standby) {
    if (!standby)
        return '';
    const { connected, node, why, takes_over : takesOver } = standby,
                                                         files = (standby.files ?? []).map((name) => say(`standby.${name}`)).join(', ');
    if (!connected)
        return why ? say('standby.denied', { node, why }) : say('standby.none');
    if (why)
        return files ? say('standby.behind', { node, files, why })
            : takesOver ? say('standby.warned', { node, why }) : say('standby.refused', { node, why });
    return files ? say('standby.getting', { node, files }) : '';
}
