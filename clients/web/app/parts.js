// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the page that are loaded when they are first used: a module, the styles that it needs, its markup, and with the first of them
// the words of all.
import { learnWords, say } from '../core/words.js';
import { sayAll, styled } from './dom.js';
import { renewIfOld } from './install.js';

const FIRST_WAIT_MS = 1000, LONGEST_WAIT_MS = 8000; // between tries

// Of each module: its class, its style sheets, the element that its markup fills, and whether it says only what the page says at once.
const PARTS = {
    about: { type: 'About', styles: ['about'] },
    alarms: { type: 'AlarmList', styles: ['alarms', 'help'], fills: 'alarms' },
    arrival: { type: 'Arrival' },
    assets: { type: 'Assets', wordless: true },
    callouts: { type: 'Callouts' },
    card: { type: 'Card', styles: ['card', 'about'] },
    commands: { type: 'Commands', wordless: true },
    engineer: { type: 'Engineer', styles: ['panel', 'help', 'engineer'] },
    folded: { type: 'Folded', styles: ['folded'], wordless: true },
    following: { type: 'Following', styles: ['following'] },
    grips: { type: 'Grips', styles: ['measure', 'grips'] },
    help: { type: 'Help', styles: ['help'] },
    isolines: { type: 'Isolines', wordless: true },
    measure: { type: 'Measure', styles: ['measure', 'following'] },
    pilot: { type: 'Pilot', wordless: true },
    picture: { type: 'Picture', styles: ['panel'], fills: 'picture-panel' },
    place: { type: 'Place', styles: ['card', 'panel'] },
    rows: { type: 'Rows', wordless: true },
    share: { type: 'Share', styles: ['panel', 'help', 'share'] },
    shown: { type: 'Shown', styles: ['shown'] },
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
        Object.assign(this, { page, tell });
        this.made = new Map();     // by name
        this.awaited = new Map();  // likewise: promises of those that are on their way
        this.uses = new Map();     // likewise: what is to be done with one once it is there, by kind
        this.missed = new Set();   // names of those that somebody waits for, and was not told that they failed
        this.pauses = new Set();   // between tries: functions that end them
    }

    // A part that is there already, or undefined.
    there(name) {
        return this.made.get(name);
    }

    // What a person wants of a part, done once it is there. Of wishes of one kind the last is done: who presses again while it is on its
    // way does not want it shut.
    async use(name, f, kind = f) {
        if (this.made.has(name)) {
            f(this.made.get(name));
            return;
        }
        this.uses.set(name, (this.uses.get(name) ?? new Map()).set(kind, f));
        const part = await this.get(name), wishes = this.uses.get(name);
        this.uses.delete(name);
        wishes?.forEach((wish) => wish(part));
    }

    // Nobody wants any more what did not come.
    giveUp() {
        this.uses.clear();
        this.missed.clear();
    }

    // A part, loaded if need be. Where that fails it is said, and tried until it comes.
    get(name) {
        if (!this.made.has(name)) {
            this.missed.add(name);
            this.retryNow();
        }
        return this.prepare(name);
    }

    // Without a word: nobody asked for it yet.
    prepare(name) {
        if (!this.awaited.has(name))
            this.awaited.set(name, this.bring(name));
        return this.awaited.get(name);
    }

    async bring(name) {
        for (let tries = 0; ; tries++) {
            try {
                return await this.load(name, tries);
            } catch (error) {
                console.warn(`${name}: ${error.message}`);
                if (!await renewIfOld() && this.missed.delete(name))
                    this.tell(say('part.failed'));
            }
            await new Promise((go) => {
                this.pauses.add(go);
                setTimeout(go, Math.min(LONGEST_WAIT_MS, FIRST_WAIT_MS * 2 ** tries));
            });
        }
    }

    // The server is there again, or somebody asks.
    retryNow() {
        for (const go of this.pauses)
            go();
        this.pauses.clear();
    }

    // A browser may remember for good that it could not fetch a module by its address, so that another one is asked for again.
    async load(name, tries) {
        const { type, styles = [], fills, wordless } = PARTS[name], again = tries > 0 ? `?again=${tries}` : '';
        const [module, markup] = await Promise.all([import(`./${name}.js${again}`), fills && markupOf(name), wordless || learnWords(),
            ...styles.map(styled)]);
        if (await renewIfOld())
            return new Promise(() => {}); // what came may be of another version than what is here, which goes
        if (fills) {
            const element = document.getElementById(fills);
            element.innerHTML = markup;
            sayAll(element);
        }
        const part = new module[type](this.page);
        this.made.set(name, part);
        this.missed.delete(name);
        return part;
    }
}
