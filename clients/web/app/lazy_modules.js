// SPDX-License-Identifier: GPL-3.0-or-later
// Loads modules that the first picture does not need, on their first use: script, style sheets, markup. The first module also
// loads the words that all these modules share.
import { learnWords, say } from '../core/words.js';
import { sayAll, styled } from './common/dom.js';
import { renewIfOld } from './install.js';

const FIRST_WAIT_MS = 1000, LONGEST_WAIT_MS = 8000; // retry interval, first and longest

// For each module: file below app/ without extension, class, style sheets, and id of the element that its markup fills.
// wordless: needs no words loaded later; words: has its own file of words.
const MODULES = {
    about: { file: 'assets/about', type: 'About', styles: ['assets/about'] },
    account: { file: 'sharing/account', type: 'Account', styles: ['help/help', 'sharing/account'] },
    alarms: { file: 'alarms/alarms', type: 'AlarmList', styles: ['alarms/alarms', 'help/help'], fills: 'alarms', words: 'alarms' },
    announcer: { file: 'alarms/announcer', type: 'Announcer' },
    arrival: { file: 'sharing/arrival', type: 'Arrival' },
    assets: { file: 'assets/assets', type: 'Assets', wordless: true },
    callouts: { file: 'alarms/callouts', type: 'Callouts' },
    card: { file: 'cards/card', type: 'Card', styles: ['cards/card', 'assets/about'] },
    compare: { file: 'views/compare', type: 'Compare', styles: ['views/compare'] },
    coverage: { file: 'picture/coverage', type: 'Coverage' },
    commands: { file: 'input/commands', type: 'Commands', wordless: true },
    engineer: { file: 'engineer/engineer', type: 'Engineer', styles: ['common/panel', 'help/help', 'engineer/engineer'] },
    toolbarOverflow: { file: 'toolbar/toolbar_overflow', type: 'ToolbarOverflow', styles: ['toolbar/toolbar_overflow'], wordless: true },
    following: { file: 'sharing/following', type: 'Following', styles: ['sharing/following'] },
    clipGizmo: { file: 'views/clip_gizmo', type: 'ClipGizmo', styles: ['measure/measure', 'views/clip_gizmo'] },
    enterVr: { file: 'xr/enter_vr', type: 'EnterVr', words: 'xr' },
    help: { file: 'help/help', type: 'Help', styles: ['help/help'] },
    import: { file: 'import/import', type: 'Import', styles: ['common/panel', 'import/import'], words: 'import' },
    isolines: { file: 'viewport/isolines', type: 'Isolines' },
    journal: { file: 'alarms/journal', type: 'Journal', words: 'alarms' },
    measure: { file: 'measure/measure', type: 'Measure', styles: ['measure/measure', 'sharing/following'] },
    moment: { file: 'alarms/moment', type: 'Moment', styles: ['alarms/moment'], words: 'alarms' },
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
    split: { file: 'views/split', type: 'Split', styles: ['views/split'] },
    timeline: { file: 'timeline/timeline', type: 'Timeline', styles: ['timeline/timeline'], fills: 'timeline' },
    timings: { file: 'help/timings', type: 'TimingsPanel', styles: ['help/timings'] },
    token: { file: 'sharing/token', type: 'TokenDialog', styles: ['help/help', 'sharing/account'], fills: 'token' },
    trends: { file: 'trends/trends', type: 'Trends', styles: ['trends/trends'], fills: 'trends' },
    unrecorded: { file: 'toolbar/unrecorded', type: 'Unrecorded', styles: ['toolbar/unrecorded'] },
    warp: { file: 'picture/warp', type: 'Warp', wordless: true },
    views: { file: 'views/views', type: 'Views', styles: ['common/panel'], fills: 'views' },
};

async function markupOf(file) {
    const answer = await fetch(new URL(`${file}.html`, import.meta.url));
    if (!answer.ok)
        throw new Error(`${file}.html: ${answer.status}`);
    return answer.text();
}

export class LazyModules {
    // page: object with the page's parts, passed to each module. tell(text) shows a message to the user.
    constructor(page, tell) {
        Object.assign(this, { page, tell });
        this.made = new Map();     // created parts by name
        this.awaited = new Map();  // name -> promise of a module that is being loaded
        this.uses = new Map(); // name -> Map of callbacks by kind, called once the module is loaded
        this.missed = new Set();   // names of modules that the user waits for and that failed to load, without a message to the user so far
        this.pauses = new Set();   // functions that end a retry's wait at once
    }

    // Returns a module by its name if it is loaded, else undefined.
    there(name) {
        return this.made.get(name);
    }

    // Calls f with a module, loading it first if necessary. Of several waiting callbacks of one kind, only the last is called:
    // pressing a button again while its panel loads must not close the panel.
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

    // Drops the callbacks that wait for modules whose loading failed.
    giveUp() {
        this.uses.clear();
        this.missed.clear();
    }

    // Returns a promise of a module, loading it if necessary. Shows a failure to the user, and retries until the module is
    // loaded.
    get(name) {
        if (!this.made.has(name)) {
            this.missed.add(name);
            this.retryNow();
        }
        return this.prepare(name);
    }

    // Loads a module in advance. Failures are not shown, because the user has not asked for it yet.
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

    // Retries loading modules without waiting, because the server is reachable again or the user asks again.
    retryNow() {
        for (const go of this.pauses)
            go();
        this.pauses.clear();
    }

    // Loads a module. Browsers may remember a failed fetch of a URL forever, so retries add another query to it.
    async load(name, tries) {
        const { file, type, styles = [], fills, wordless, words } = MODULES[name], again = tries > 0 ? `?again=${tries}` : '';
        const [module, markup] = await Promise.all([import(`./${file}.js${again}`), fills && markupOf(file), wordless || learnWords(),
            words && learnWords(words), ...styles.map(styled)]);
        if (await renewIfOld())
            // never resolves: the page is about to reload, because script and page may be of different versions
            return new Promise(() => {});
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
