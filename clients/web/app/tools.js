// SPDX-License-Identifier: GPL-3.0-or-later
// The tools of the toolbar: values that stand still, measuring, a picture to keep, sharing, dark or light. What takes code of its own is
// fetched when it is first asked for.
import { ask } from '../core/history.js';
import { snapshotQuery } from '../core/query.js';
import { say } from '../core/words.js';
import { byId, make } from './dom.js';
import { foldPanel } from './fields.js';

const HELD_US = 3.5e6; // what is newer than that counts as now

export class Tools {
    // tell(text): to the person.
    constructor({ session, selection, viewport, tell }) {
        Object.assign(this, { session, selection, viewport, tell, measuring: null });
        for (const name of ['hold', 'measure', 'snapshot', 'theme'])
            byId(name).addEventListener('click', () => this[name]());
        byId('share-open').addEventListener('click', () => this.share());
        this.fold = foldPanel(byId('more'), byId('more-toggle'), () => {});
        byId('more').addEventListener('click', () => this.fold(false));
        session.on('time', () => this.show());
        session.on('welcome', () => this.show());
        session.on('followers', () => this.show());
        this.show();
    }

    show() {
        const { time, recorded, followers } = this.session, button = byId('hold'), held = time.atUs !== null;
        button.disabled = !recorded;
        button.querySelector('use').setAttribute('href', held ? '#i-play' : '#i-pause');
        const words = say(held ? 'bar.go' : recorded ? 'bar.hold' : 'bar.unrecorded');
        button.title = words;
        button.setAttribute('aria-label', words);
        byId('share-open').toggleAttribute('data-count', followers.count > 0);
        if (followers.count > 0)
            byId('share-open').dataset.count = followers.count;
    }

    hold() {
        const { session } = this;
        if (session.recorded)
            session.travel(session.time.atUs === null ? session.clockUs() - HELD_US : null);
    }

    async measure() {
        const { Measure } = await import('./measure.js');
        this.measuring ??= new Measure(this);
        this.measuring.toggle();
    }

    async share() {
        const { Share } = await import('./share.js');
        this.sharing ??= new Share(this);
        this.sharing.open();
    }

    async snapshot() {
        const { session } = this, { camera, size, time, model } = session;
        try {
            if (!model)
                return;
            if (session.params.show === 'difference' && !session.params.baseline?.name)
                throw new Error(say('snapshot.unnamed'));
            const query = snapshotQuery({ carried: session.carried(), camera, size, time });
            const answer = await ask('snapshot.png', query, session.token);
            const url = URL.createObjectURL(await answer.blob()), at = new Date((time.atUs ?? session.clockUs()) / 1000).toISOString();
            make('a', { href: url, download: `${model.plant.name} ${at.slice(0, 19).replace(/:/g, '-')}Z.png` }).click();
            setTimeout(() => URL.revokeObjectURL(url), 10000);
        } catch (error) {
            this.tell(say('snapshot.failed', { why: error.message }));
        }
    }

    theme() {
        const dark = document.documentElement.dataset.theme !== 'dark';
        document.documentElement.dataset.theme = dark ? 'dark' : 'light';
        keep(dark ? 'dark' : 'light');
    }
}

const KEY = 'plantcast.theme';

// A browser may forbid storage; the theme is then the usual one after a reload.
function keep(theme) {
    try {
        localStorage.setItem(KEY, theme);
    } catch {
        // see above
    }
}

// ?theme=dark or light, else as it was left.
export function chooseTheme(search) {
    let kept = null;
    try {
        kept = localStorage.getItem(KEY);
    } catch {
        // see above
    }
    const wanted = new URLSearchParams(search).get('theme') ?? kept;
    document.documentElement.dataset.theme = wanted === 'dark' ? 'dark' : 'light';
}
