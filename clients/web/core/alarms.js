// SPDX-License-Identifier: GPL-3.0-or-later
// Stores the alarms that are not in the state "normal", as the server sends them, and selects for each tag the alarm to show among its
// annunciated ones (neither shelved, suppressed nor out of service).

// [background, text] by priority. No colour map of the picture has similar colours (tests/web/alarm_colours.test.mjs).
export const ALARM_COLOURS = [['#af0c4a', '#fff'], ['#ffff96', '#1b1300'], ['#b646aa', '#fff'], ['#1e00f5', '#fff']];

const CALLS = ['unacknowledged', 'active', 'returned', 'latched', 'acknowledged']; // annunciated states

export const calls = (state) => CALLS.includes(state);
export const isWaiting = (state) => state === 'unacknowledged' || state === 'returned';
export const isGone = (state) => state === 'returned' || state === 'latched'; // returned to normal: drawn hollow
// Makes an object with the members of a tag for the alarm of a device, which has no tag.
const deviceOf = (name) => ({ name, index: null, group: null, asset: null, description: '' });

const isOuter = ({ kind }) => kind === 'HH' || kind === 'LL';
// Compares two alarms for sorting: active before returned, then the more urgent one, then the outer limit (HH, LL), whose alarm implies
// that of the inner limit (H, L).
export const graver = (a, b) => isGone(a.state) - isGone(b.state) || a.priority - b.priority || isOuter(b) - isOuter(a) ||
    isWaiting(b.state) - isWaiting(a.state) || b.raisedUs - a.raisedUs;

export class Alarms {
    constructor(tags) {
        Object.assign(this, { tags, mode: 'display', known: false, raised: [] });
        // tag or device name -> raise times of its annunciated alarms (neither shelved, suppressed nor out of service), also
        // from an earlier connection (session.js); null before the first list of alarms
        this.times = null;
        this.rows = new Map(); // "tag index/kind" -> alarm
        this.then = null; // readings of the past instant shown, which then determine each tag's alarm; null: the present is shown
        // tag index or device name -> its most urgent annunciated alarm (not shelved, suppressed or out of service), with two
        // more members: `waiting` (true: any alarm of the tag is unacknowledged) and `others` (the tag's other alarms)
        this.byTag = new Map();
    }

    hear({ mode, all, alarms }) {
        const before = this.times;
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
        const list = this.list();
        this.times = new Map(list.map((one) => [one.tag.name, [one, ...one.others].map(({ raisedUs }) => raisedUs)]));
        // alarms raised since the previous `alarms` message, even one from an earlier connection: one alarm per tag, the most
        // urgent first. Alarms that only changed their state do not count.
        this.raised = list.filter(({ tag, state, raisedUs }) => before && !isGone(state) && state !== 'acknowledged' &&
            !before.get(tag.name)?.some((us) => us >= raisedUs));
    }

    // Returns one alarm per tag, sorted: active before returned, then unacknowledged first, then by priority, then newest first.
    list() {
        return [...this.byTag.values()].sort((a, b) => isGone(a.state) - isGone(b.state) || b.waiting - a.waiting ||
            a.priority - b.priority || b.raisedUs - a.raisedUs);
    }

    gravest(index) {
        if (this.then) {
            const { alarm: kind, priority, state } = this.then[index];
            return kind ? { tag: this.tags[index], kind, priority, state, waiting: isWaiting(state), others: [] } : null;
        }
        return this.byTag.get(index) ?? null;
    }

    // Returns how many tags and devices have alarms: { active, waiting (unacknowledged), latched (returned to normal and acknowledged, but
    // not reset yet), of (active ones by priority), gone (those that returned to normal, by priority) }
    counts() {
        const list = this.list(), of = [0, 0, 0, 0], gone = [0, 0, 0, 0];
        for (const { priority, state } of list)
            (isGone(state) ? gone : of)[priority - 1]++;
        const count = (test) => list.filter(test).length;
        return { active: count(({ state }) => !isGone(state)), waiting: count(({ waiting }) => waiting),
            latched: count(({ state, waiting }) => state === 'latched' && !waiting), of, gone };
    }
}
