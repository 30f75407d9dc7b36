// SPDX-License-Identifier: GPL-3.0-or-later
// The alarms that are not normal, as the server sends them; which of them are annunciated, one for each tag, and in what order.

const CALLS = ['unacknowledged', 'active', 'returned', 'latched', 'acknowledged']; // what is to be seen

export const calls = (state) => CALLS.includes(state);
const isWaiting = (state) => state === 'unacknowledged' || state === 'returned';
export const isGone = (state) => state === 'returned' || state === 'latched'; // its cause: drawn hollow
// Where an alarm is not of a tag but of the device that many come from.
const deviceOf = (name) => ({ name, index: null, group: null, asset: null, description: '' });

const isOuter = ({ kind }) => kind === 'HH' || kind === 'LL';
// Compares two alarms for sorting: active before cleared, then the more urgent, then the outer limit, which implies the inner one.
export const graver = (a, b) => isGone(a.state) - isGone(b.state) || a.priority - b.priority || isOuter(b) - isOuter(a) ||
    isWaiting(b.state) - isWaiting(a.state) || b.raisedUs - a.raisedUs;

export class Alarms {
    constructor(tags) {
        Object.assign(this, { tags, mode: 'display', known: false });
        this.rows = new Map(); // "tag index/kind" -> alarm
        this.then = null; // readings of an instant of the past: a tag's gravest is of then
        this.byTag = new Map(); // tag index or name of a device -> its gravest that is to be seen, with `waiting` (any of its alarms)
        // and `others` (the rest of them)
    }

    hear({ mode, all, alarms }) {
        Object.assign(this, { mode, known: true });
        if (all)
            this.rows.clear();
        for (const [index, kind, state, priority, raisedUs, value, limit, active, held, untilUs = null, who = '', reason = ''] of alarms) {
            const tag = kind === 'LINK' ? deviceOf(index) : this.tags[index], id = `${index}/${kind}`;
            if (state === 'normal' || !tag)
                this.rows.delete(id);
            else
                this.rows.set(id, { id, tag, kind, state, priority, raisedUs, value, limit, active, held, untilUs, who, reason });
        }
        const ofTags = new Map();
        for (const alarm of [...this.rows.values()].filter(({ state }) => calls(state)).sort(graver)) {
            const key = alarm.tag.index ?? alarm.tag.name;
            ofTags.set(key, [...(ofTags.get(key) ?? []), alarm]);
        }
        this.byTag = new Map([...ofTags].map(([key, [gravest, ...others]]) =>
            [key, { ...gravest, others, waiting: [gravest, ...others].some(({ state }) => isWaiting(state)) }]));
    }

    // One for each tag. Those with something not yet acknowledged first, then what is there, then by priority, the newest first.
    list() {
        return [...this.byTag.values()].sort((a, b) => b.waiting - a.waiting || isGone(a.state) - isGone(b.state) ||
            a.priority - b.priority || b.raisedUs - a.raisedUs);
    }

    gravest(index) {
        if (this.then) {
            const { alarm: kind, priority, state } = this.then[index];
            return kind ? { tag: this.tags[index], kind, priority, state, waiting: isWaiting(state), others: [] } : null;
        }
        return this.byTag.get(index) ?? null;
    }

    // Of tags and devices: { active (the cause is there), waiting (for somebody to acknowledge), latched, of, gone: by priority, those
    // whose cause is there and those whose cause has gone }
    counts() {
        const list = this.list(), of = [0, 0, 0, 0], gone = [0, 0, 0, 0];
        for (const { priority, state } of list)
            (isGone(state) ? gone : of)[priority - 1]++;
        const count = (test) => list.filter(test).length;
        return { active: count(({ state }) => !isGone(state)), waiting: count(({ waiting }) => waiting),
            latched: count(({ state, waiting }) => state === 'latched' && !waiting), of, gone };
    }
}
