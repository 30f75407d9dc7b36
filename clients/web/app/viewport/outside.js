// SPDX-License-Identifier: GPL-3.0-or-later
// A notice that the first view leaves out some equipment because it is far from the rest.
import { wholeOf } from '../../core/camera_moves.js';
import { farText } from '../../core/measure.js';
import { say } from '../../core/words.js';
import { byId, make } from '../common/dom.js';

const MOST_NAMES = 3;

export class Outside {
    constructor({ session, modules }) {
        Object.assign(this, { session, modules });
        this.element = make('div', { class: 'chip outside', role: 'status' });
        byId('viewport').append(this.element);
        session.on('welcome', () => this.show());
        this.show();
    }

    // Returns the names of the assets that extend beyond the plant's bounds, which determine the first view.
    names() {
        const { assets, plant: { bounds: { min, max } } } = this.session.model;
        const rim = Math.max(...max.map((m, i) => m - min[i])) / 100;
        const far = assets.filter(({ bounds }) => min.some((m, i) => bounds.min[i] < m - rim || bounds.max[i] > max[i] + rim));
        const names = far.slice(0, MOST_NAMES).map(({ id }) => id).join(', ');
        return far.length > MOST_NAMES ? say('outside.more', { names, count: far.length - MOST_NAMES }) : names;
    }

    show() {
        const { outside } = this.session.model.plant, { element } = this, close = () => { element.hidden = true; };
        element.hidden = !outside;
        if (!outside)
            return;
        const frame = () => this.modules.use('cameraController', (controller) => controller.flyToBox(wholeOf(this.session.model)));
        element.replaceChildren(make('span', {}, say('outside.title', { names: this.names(), far: farText(outside.away_m) })),
            make('button', { type: 'button', onclick: frame }, say('outside.all')),
            make('button', { type: 'button', onclick: close, title: say('outside.close'), 'aria-label': say('outside.close') }, '×'));
    }
}
