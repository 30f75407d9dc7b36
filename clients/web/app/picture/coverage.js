// SPDX-License-Identifier: GPL-3.0-or-later
// Shows sensor coverage, which does not depend on readings: how large the field's error may be (uncertainty), and which hot spots no sensor
// would show (blind spots). Also has rarely needed titles of the legend. Loaded when one of these is shown, and with the panel of picture
// settings.
import { dayTime, shortNumberText, zoneClock } from '../../core/format.js';
import { say } from '../../core/words.js';
import { fillSegments, markSegment } from '../common/choices.js';
import { byId, make, setText } from '../common/dom.js';
import { SHOWS } from '../toolbar/toolbar.js';
import { TITLES } from '../viewport/legend.js';

const COVERS = ['uncertainty', 'blind'], OWN = SHOWS.length;

export class Coverage {
    constructor({ session }) {
        this.session = session;
        this.why = make('p', { class: 'note' });
        this.choices = make('fieldset', { class: 'segments' }, make('legend', {}, say('coverage.title')));
        this.element = make('div', { id: 'coverage' }, this.choices, this.why);
        TITLES.difference = (name, params) => [`Δ ${name}`, this.since(params)];
        TITLES.uncertainty = (name) => [`± ${name}`, null, say('coverage.uncertainty.note')];
        TITLES.blind = (name, { group }) =>
            [say('coverage.blind.of', { name }), null,
                say('coverage.blind.note', { size: shortNumberText(session.model.group(group).hot_spot_m, 3) })];
        session.on('params', () => this.update());
        this.update();
        session.emit('shown'); // makes the legends redraw
    }

    // Returns the name of the saved baseline (readings with which the present ones are compared) and the time it was saved, in
    // the plant's time zone; null if unknown.
    since({ baseline }) {
        if (!baseline?.time_us)
            return null;
        const when = dayTime(zoneClock(this.session.model.plant.time_zone), baseline.time_us / 1000);
        return say('coverage.since', { when: baseline.name ? `${baseline.name}, ${when}` : when });
    }

    // Adds the controls to the panel of picture settings when a user first opens the panel.
    fill() {
        this.shown = [];
        byId('scale').before(this.element);
        this.update();
    }

    update() {
        const { model, params } = this.session;
        if (!model)
            return;
        const now = COVERS.find((show) => show === params.show);
        SHOWS.splice(OWN, 1, ...(now ? [[now, say(`coverage.${now}`)]] : []));
        const may = COVERS.filter((show) => show === 'blind' || model.group(params.group)?.prepared?.includes('gp'));
        if (this.shown && JSON.stringify(may) !== JSON.stringify(this.shown)) {
            this.shown = may;
            fillSegments(this.choices, 'coverage', [['', say('coverage.none')], ...may.map((show) => [show, say(`coverage.${show}`)])],
                (show) => this.session.setParams({ show: show || 'value' }));
        }
        markSegment(this.choices, now ?? '');
        setText(this.why, now ? say(`coverage.${now}.why`) : '');
        this.why.hidden = !now;
    }
}
