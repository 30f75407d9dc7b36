// SPDX-License-Identifier: GPL-3.0-or-later
// Names of the users of other sessions: those who follow this view, and the one whose view this page follows.
import { say } from './words.js';

// Returns a label for each follower: the user's name, or "Viewer". If several followers have the same label, each gets a number.
export function followerNames({ sessions, names }) {
    const plain = sessions.map((_, i) => names[i] ?? say('share.viewer'));
    return plain.map((label, i) => {
        const before = plain.slice(0, i).filter((other) => other === label).length;
        return before > 0 || plain.lastIndexOf(label) > i ? `${label} ${before + 1}` : label;
    });
}

// Returns the label of the user whose view this page follows.
export const leaderName = (following) => following?.who ?? say('following.someone');
