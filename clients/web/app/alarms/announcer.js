// SPDX-License-Identifier: GPL-3.0-or-later
// Tells screen readers about each new alarm once: tag, kind, state and value. Loaded with the first alarm that is raised while the page is
// open.
import { calls } from '../../core/alarms.js';
import { say } from '../../core/words.js';
import { byId } from '../common/dom.js';
import { limitText } from './alarm_bar.js';

const MOST = 3; // maximum number of alarms that one announcement reads out; the others are only counted
const READ_MS = 3000; // shortest time between two announcements in milliseconds: a screen reader skips a text that is replaced too soon

const isOpen = ({ state }) => calls(state) && state !== 'acknowledged';

export class Announcer {
    constructor({ session }) {
        Object.assign(this, { session, waiting: new Set(), timer: null }); // waiting: ids of queued alarms
    }

    // Queues newly raised alarms. All queued alarms are announced together, at the next announcement.
    take(raised) {
        raised.forEach(({ id }) => this.waiting.add(id));
        if (this.timer === null)
            this.announce();
    }

    textOf(alarm) {
        return [`${alarm.tag.name} ${say(`kind.${alarm.kind}`)}`, say(`state.${alarm.state}`), limitText(this.session, alarm, true)]
            .filter(Boolean).join(', ');
    }

    // Reads out the queued alarms with their present states, except those acknowledged or ended while queued.
    announce() {
        this.timer = null;
        const { rows } = this.session.model.alarms;
        const all = [...this.waiting].map((id) => rows.get(id)).filter((alarm) => alarm && isOpen(alarm))
            .sort((a, b) => a.priority - b.priority);
        this.waiting.clear();
        if (all.length === 0)
            return;
        const more = all.length > MOST ? [say('alarms.more', { count: all.length - MOST })] : [];
        byId('alarm-said').textContent = [...all.slice(0, MOST).map((alarm) => this.textOf(alarm)), ...more].join('; ');
        this.timer = setTimeout(() => this.announce(), READ_MS);
    }
}
