// SPDX-License-Identifier: GPL-3.0-or-later
// Tells screen readers about each new alarm once: tag, kind, state and value. Loaded with the first alarm that is raised while the page is
// open.
import { say } from '../../core/words.js';
import { byId } from '../common/dom.js';
import { limitText } from './alarm_bar.js';

const MOST = 3; // maximum number of alarms whose text is read out in one announcement; of the others, only the number is read out
const READ_MS = 3000; // shortest time between two announcements: a screen reader drops a text that is replaced too soon

export class Announcer {
    constructor({ session }) {
        Object.assign(this, { session, waiting: [], timer: null });
    }

    // Queues newly raised alarms. All alarms that are queued when the next announcement is due are announced together.
    take(raised) {
        this.waiting.push(...raised.map((alarm) => ({ priority: alarm.priority, text: this.textOf(alarm) })));
        if (this.timer === null)
            this.announce();
    }

    textOf(alarm) {
        return [`${alarm.tag.name} ${say(`kind.${alarm.kind}`)}`, say(`state.${alarm.state}`), limitText(this.session, alarm, true)]
            .filter(Boolean).join(', ');
    }

    announce() {
        this.timer = null;
        if (this.waiting.length === 0)
            return;
        const all = this.waiting.splice(0).sort((a, b) => a.priority - b.priority);
        const more = all.length > MOST ? [say('alarms.more', { count: all.length - MOST })] : [];
        byId('alarm-said').textContent = [...all.slice(0, MOST).map(({ text }) => text), ...more].join('; ');
        this.timer = setTimeout(() => this.announce(), READ_MS);
    }
}
