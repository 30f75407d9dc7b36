// SPDX-License-Identifier: GPL-3.0-or-later
// The alarms that are not normal, as the server tells them: what is to be seen, and in what order.

const CALLS = ['unacknowledged', 'active', 'returned', 'latched', 'acknowledged']; // what is to be seen

export const calls = (state) => CALLS.includes(state);
// Where an alarm is not of a tag but of the device that many come from.
const deviceOf = (name) => ({ name, index: null, group: null, asset: null, description: '' });

export class Alarms {
    constructor(tags) {
        Object.assign(this, { tags, mode: 'display', known: false });
        this.rows = new Map(); // "tag index/kind" -> alarm
        this.then = null; // readings of an instant of the past: a tag's gravest is of then
        this.byTag = new Map(); // tag index -> its gravest that is to be seen
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
        this.byTag.clear();
        for (const alarm of this.list()) {
            const other = this.byTag.get(alarm.tag.index);
            if (alarm.tag.index === null)
                continue;
            if (!other || alarm.priority < other.priority)
                this.byTag.set(alarm.tag.index, alarm);
        }
    }

    // Those that are to be seen: not yet acknowledged first, then by priority, the newest first.
    list() {
        const place = ({ state }) => (isWaiting(state) ? 0 : 1);
        return [...this.rows.values()].filter(({ state }) => calls(state))
            .sort((a, b) => place(a) - place(b) || a.priority - b.priority || b.raisedUs - a.raisedUs);
    }

    gravest(index) {
        if (this.then) {
            const { alarm: kind, priority, state } = this.then[index];
            return kind ? { tag: this.tags[index], kind, priority, state } : null;
        }
        return this.byTag.get(index) ?? null;
    }

    // { all, waiting: for somebody, of: by priority }
    counts() {
        const list = this.list(), of = [0, 0, 0, 0];
        for (const { priority } of list)
            of[priority - 1]++;
        return { all: list.length, waiting: list.filter(({ state }) => isWaiting(state)).length, of };
    }
}

export const isWaiting = (state) => state === 'unacknowledged' || state === 'returned';
