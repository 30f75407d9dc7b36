// SPDX-License-Identifier: GPL-3.0-or-later
// Loads the modules of the page that are not needed for the first picture when they are first used: the script, its style sheets, its
// markup, and with the first of them the words of all.
import { learnWords, say } from '../core/words.js';
import { sayAll, styled } from './common/dom.js';
import { renewIfOld } from './install.js';

const FIRST_WAIT_MS = 1000, LONGEST_WAIT_MS = 8000; // between tries

// Of each module: its file in this folder without the ending, its class, its style sheets, the element that its markup fills, and whether
// it says only what the page says at once, or has a file of words of its own.
const MODULES = {
    about: { file: 'assets/about', type: 'About', styles: ['assets/about'] },
    account: { file: 'sharing/account', type: 'Account', styles: ['help/help', 'sharing/account'] },
    alarms: { file: 'alarms/alarms', type: 'AlarmList', styles: ['alarms/alarms', 'help/help'], fills: 'alarms' },
    arrival: { file: 'sharing/arrival', type: 'Arrival' },
    assets: { file: 'assets/assets', type: 'Assets', wordless: true },
    callouts: { file: 'alarms/callouts', type: 'Callouts' },
    card: { file: 'cards/card', type: 'Card', styles: ['cards/card', 'assets/about'] },
    coverage: { file: 'picture/coverage', type: 'Coverage' },
    commands: { file: 'input/commands', type: 'Commands', wordless: true },
    engineer: { file: 'engineer/engineer', type: 'Engineer', styles: ['common/panel', 'help/help', 'engineer/engineer'] },
    toolbarOverflow: { file: 'toolbar/toolbar_overflow', type: 'ToolbarOverflow', styles: ['toolbar/toolbar_overflow'], wordless: true },
    following: { file: 'sharing/following', type: 'Following', styles: ['sharing/following'] },
    clipGizmo: { file: 'views/clip_gizmo', type: 'ClipGizmo', styles: ['measure/measure', 'views/clip_gizmo'] },
    help: { file: 'help/help', type: 'Help', styles: ['help/help'] },
    import: { file: 'import/import', type: 'Import', styles: ['common/panel', 'import/import'], words: 'import' },
    isolines: { file: 'viewport/isolines', type: 'Isolines' },
    measure: { file: 'measure/measure', type: 'Measure', styles: ['measure/measure', 'sharing/following'] },
    cameraController: { file: 'input/camera_controller', type: 'CameraController', wordless: true },
    outside: { file: 'viewport/outside', type: 'Outside', styles: ['assets/shown', 'viewport/outside'] },
    picture: { file: 'picture/picture', type: 'Picture', styles: ['common/panel'], fills: 'picture-panel' },
    namedViews: { file: 'views/named_views', type: 'NamedViews', styles: ['common/panel', 'views/named_views'] },
    notes: { file: 'notes/notes', type: 'Notes', styles: ['common/panel', 'notes/notes'] },
    remote: { file: 'views/remote', type: 'Remote', styles: ['common/panel', 'notes/notes'] },
    place: { file: 'cards/place', type: 'Place', styles: ['cards/card', 'common/panel'] },
    rows: { file: 'assets/rows', type: 'Rows', wordless: true },
    share: { file: 'sharing/share', type: 'Share', styles: ['common/panel', 'help/help', 'sharing/share'] },
    shown: { file: 'assets/shown', type: 'Shown', styles: ['assets/shown'] },
    snapshot: { file: 'picture/snapshot', type: 'Snapshot' },
    timeline: { file: 'timeline/timeline', type: 'Timeline', styles: ['timeline/timeline'], fills: 'timeline' },
    timings: { file: 'help/timings', type: 'TimingsPanel', styles: ['help/timings'] },
    token: { file: 'sharing/token', type: 'TokenDialog', styles: ['help/help', 'sharing/account'], fills: 'token' },
    trends: { file: 'trends/trends', type: 'Trends', styles: ['trends/trends'], fills: 'trends' },
    views: { file: 'views/views', type: 'Views', styles: ['common/panel'], fills: 'views' },
};

async function markupOf(file) {
    const answer = await fetch(new URL(`${file}.html`, import.meta.url));
    if (!answer.ok)
        throw new Error(`${file}.html: ${answer.status}`);
    return answer.text();
}

export class LazyModules {
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
        const { file, type, styles = [], fills, wordless, words } = MODULES[name], again = tries > 0 ? `?again=${tries}` : '';
        const [module, markup] = await Promise.all([import(`./${file}.js${again}`), fills && markupOf(file), wordless || learnWords(),
            words && learnWords(words), ...styles.map(styled)]);
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
