// SPDX-License-Identifier: GPL-3.0-or-later
// The button that shows the plant on a headset. Loaded if the browser has an immersive headset; the headset's own modules are loaded when
// the button is pressed.
import { say } from '../../core/words.js';
import { byId, make, makeSvg } from '../common/dom.js';

const GOGGLES = 'M2.5 6.5h15v7h-5l-1.5-2h-2l-1.5 2h-5zM6.5 9.5h.01M13.5 9.5h.01';

export class EnterVr {
    constructor(page) {
        this.page = page;
        const name = say('xr.enter');
        this.button = make('button', { class: 'icon', id: 'enter-vr', title: name, 'aria-label': name, onclick: () => this.enter() },
            makeSvg('svg', { 'aria-hidden': 'true' }, makeSvg('path', { d: GOGGLES })), make('span', { class: 'words' }, name));
        byId('help-open').before(this.button);
        this.headset = null; // controls the headset while it shows the plant; null: no headset shows it
        // hides the button if the server sends no depth grids, without which the eyes' views cannot be drawn
        page.session.greeted(() => { this.button.hidden = !page.session.reprojects; });
    }

    // Requests the WebXR session before anything else, because browsers grant it only right after the user's click.
    async enter() {
        const { page } = this;
        this.button.disabled = true;
        let xr = null;
        try {
            const [session, { Headset }] = await Promise.all([
                navigator.xr.requestSession('immersive-vr', { optionalFeatures: ['local-floor'] }).then((granted) => (xr = granted)),
                import('./headset.js'), page.modules.get('warp')]);
            this.headset = new Headset({ ...page, xr: session });
            await this.headset.begin();
            await new Promise((done) => this.headset.ended ? done() : session.addEventListener('end', done));
        } catch (error) {
            console.warn(`headset: ${error.message}`);
            xr?.end().catch(() => {});
            page.tell(say('xr.failed', { why: error.message }));
        }
        this.headset = null;
        this.button.disabled = false;
    }
}
