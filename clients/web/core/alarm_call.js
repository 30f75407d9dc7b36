// SPDX-License-Identifier: GPL-3.0-or-later
// Selects the alarm that a pane of a video wall shows: during alarms, the pane shows the position of an alarm instead of its
// own view. The unacknowledged alarms take turns: active before returned, then by urgency and age. During a flood of alarms
// none is selected, because a constantly changing picture would help nobody.
import { isGone } from './alarms.js';

export const TURN_MS = 10000;  // minimum time in milliseconds between two changes of the picture
export const FLOOD = 10; // more alarms than this within FLOOD_US are a flood, during which the pane shows its own view
const FLOOD_US = 600e6;

const byGravity = (a, b) => a.priority - b.priority || a.raisedUs - b.raisedUs;
const keyOf = ({ tag, kind }) => `${tag.index}/${kind}`;

export class AlarmCall {
    constructor() {
        this.shown = null; // key of the alarm that the pane shows; null: the pane shows its view
        this.changedAt = -Infinity;
    }

    isFlood(alarms, nowUs) {
        return alarms.filter((alarm) => !isGone(alarm.state) && nowUs - alarm.raisedUs <= FLOOD_US).length > FLOOD;
    }

    // Returns the alarm to show, or null. alarms: the annunciated alarms (neither shelved, suppressed nor out of service), one
    // per tag; nowMs: monotonic time; nowUs: the server's time.
    next(alarms, nowMs, nowUs) {
        const waiting = this.isFlood(alarms, nowUs) ? [] : alarms.filter(({ tag, waiting: calls }) =>
            calls && tag.asset && tag.position).sort((a, b) => isGone(a.state) - isGone(b.state) || byGravity(a, b));
        const at = waiting.findIndex((alarm) => keyOf(alarm) === this.shown);
        if (nowMs - this.changedAt >= TURN_MS) {
            const key = waiting.length > 0 ? keyOf(waiting[(at + 1) % waiting.length]) : null;
            if (key !== null || this.shown !== null)
                this.changedAt = nowMs;
            this.shown = key;
        }
        return waiting.find((alarm) => keyOf(alarm) === this.shown) ?? null;
    }
}

// Returns the equipment with alarms, the most urgent first: [{ asset, count (of alarms), worst (most urgent alarm) }].
export function byEquipment(alarms) {
    const all = new Map();
    for (const alarm of alarms) {
        const key = alarm.tag.asset ?? alarm.tag.name; // alarms of a device, or of a tag without equipment, get an entry of their own
        const known = all.get(key) ?? { asset: alarm.tag.asset, count: 0, worst: alarm };
        all.set(key, { ...known, count: known.count + 1, worst: byGravity(alarm, known.worst) < 0 ? alarm : known.worst });
    }
    return [...all.values()].sort((a, b) => byGravity(a.worst, b.worst) || b.count - a.count);
}
