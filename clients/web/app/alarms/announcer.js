// SPDX-License-Identifier: GPL-3.0-or-later
// Tells screen readers about each new alarm once: tag, kind, state and value. Loaded with the first alarm that is raised while the page is
// open.
import { say } from '../../core/words.js';
import { byId } from '../common/dom.js';
import { limitText } from './alarm_bar.js';

const MOST = 3; // maximum number of alarms in one message that are announced one by one; the others are only counted

export class Announcer {
    constructor({ session }) {
        this.session = session;
        session.on('alarms', () => this.announce());
        this.announce();
    }

    announce() {
        const { raised } = this.session.model.alarms;
        if (raised.length === 0)
            return;
        const texts = raised.slice(0, MOST).map((alarm) => [`${alarm.tag.name} ${say(`kind.${alarm.kind}`)}`, say(`state.${alarm.state}`),
            limitText(this.session, alarm, true)].filter(Boolean).join(', '));
        const more = raised.length > MOST ? [say('alarms.more', { count: raised.length - MOST })] : [];
        byId('alarm-said').textContent = [...texts, ...more].join('; ');
    }
}
