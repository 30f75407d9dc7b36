// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the page that are loaded when they are first used: a module, the styles that it needs, and its markup.
import { say } from '../core/words.js';
import { sayAll, styled } from './dom.js';
import { renewIfOld } from './install.js';

// Of each module: its class, its style sheets, and the element that its markup fills.
const PARTS = {
    alarms: { type: 'AlarmList', styles: ['alarms', 'help'], fills: 'alarms' },
    arrival: { type: 'Arrival' },
    card: { type: 'Card', styles: ['card'] },
    engineer: { type: 'Engineer', styles: ['panel', 'help', 'engineer'] },
    grips: { type: 'Grips', styles: ['measure', 'grips'] },
    help: { type: 'Help', styles: ['help'] },
    measure: { type: 'Measure', styles: ['measure'] },
    picture: { type: 'Picture', styles: ['panel'], fills: 'picture-panel' },
    place: { type: 'Place', styles: ['card', 'panel'] },
    share: { type: 'Share', styles: ['panel', 'help', 'share'] },
    snapshot: { type: 'Snapshot' },
    timeline: { type: 'Timeline', styles: ['timeline'], fills: 'timeline' },
    timings: { type: 'TimingsPanel', styles: ['timings'] },
    token: { type: 'TokenDialog', styles: ['help'], fills: 'token' },
    trends: { type: 'Trends', styles: ['trends'], fills: 'trends' },
    views: { type: 'Views', styles: ['panel'], fills: 'views' },
};

async function markupOf(name) {
    const answer = await fetch(new URL(`${name}.html`, import.meta.url));
    if (!answer.ok)
        throw new Error(`${name}.html: ${answer.status}`);
    return answer.text();
}

export class Parts {
    // page: what the parts are given. tell(text): to the person.
    constructor(page, tell) {
        Object.assign(this, { page, tell, tries: 0 });
        this.made = new Map();    // by name
        this.awaited = new Map(); // likewise: promises of those that are on their way
    }

    // A part that is there already, or undefined.
    there(name) {
        return this.made.get(name);
    }

    // A part, loaded if need be; null: that failed, and was said. It is tried again when it is asked for again.
    async get(name) {
        if (!this.awaited.has(name))
            this.awaited.set(name, this.load(name).catch((error) => this.fail(name, error)));
        return this.awaited.get(name);
    }

    // A browser may remember for good that it could not fetch a module by its address, so that another one is asked for again.
    async load(name) {
        const { type, styles = [], fills } = PARTS[name], again = this.tries > 0 ? `?again=${this.tries}` : '';
        const [module, markup] = await Promise.all([import(`./${name}.js${again}`), fills && markupOf(name), ...styles.map(styled)]);
        if (await renewIfOld())
            return null; // what came may be of another version than what is here
        if (fills) {
            const element = document.getElementById(fills);
            element.innerHTML = markup;
            sayAll(element);
        }
        const part = new module[type](this.page);
        this.made.set(name, part);
        return part;
    }

    async fail(name, error) {
        this.awaited.delete(name);
        this.tries++;
        console.warn(`${name}: ${error.message}`);
        if (!await renewIfOld())
            this.tell(say('part.failed'));
        return null;
    }
}
