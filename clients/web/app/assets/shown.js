// SPDX-License-Identifier: GPL-3.0-or-later
// A notice over the picture that part of the plant is hidden, with a button that shows everything. Loaded when equipment is hidden,
// isolated or transparent.
import { showAll } from '../../core/section.js';
import { say } from '../../core/words.js';
import { byId, make, setText, setVariable } from '../common/dom.js';
import { isHidden } from '../viewport/overlay.js';

const AWAY_PX = 8;

export class Shown {
    constructor({ session, refresh }) {
        Object.assign(this, { session, refresh });
        this.words = make('span');
        this.element = make('div', { class: 'chip', id: 'shown', role: 'status', hidden: true }, this.words,
            make('button', { type: 'button', onclick: () => session.setParams(showAll(session.params)) }, say('views.all')));
        byId('viewport').append(this.element);
        const observer = new ResizeObserver(() => this.stand());
        for (const element of [byId('viewport'), byId('legend')])
            observer.observe(element);
        session.on('params', () => this.show());
        session.on('welcome', () => this.show());
        this.show();
    }

    show() {
        const { model, params } = this.session, { hidden = [], ghost = [] } = params;
        const all = model?.assets ?? [], gone = all.filter(({ id }) => isHidden(params, id)).length;
        const ghosts = all.filter(({ id }) => ghost.includes(id) && !hidden.includes(id)).length;
        this.element.hidden = gone + ghosts === 0;
        setText(this.words, [gone > 0 && say('shown.hidden', { hidden: gone, all: all.length }),
            ghosts > 0 && say('shown.ghosts', { count: ghosts })].filter(Boolean).join(', '));
        this.stand();
        this.refresh(); // redraws the sensor labels over the picture, so that those under the notice move aside
    }

    // Moves the notice below the legend if the legend lies across the top of the picture.
    stand() {
        const legend = byId('legend'), lies = legend.offsetWidth > byId('viewport').clientWidth / 2;
        setVariable(this.element, '--under', `${lies ? legend.offsetTop + legend.offsetHeight + AWAY_PX : 0}px`);
    }
}
