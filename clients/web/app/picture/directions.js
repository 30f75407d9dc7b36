// SPDX-License-Identifier: GPL-3.0-or-later
// A control that chooses how the directions (vectors) of a sensor group are drawn, with an explanation. Loaded with the panel of picture
// settings.
import { say } from '../../core/words.js';
import { fillSegments, markSegment } from '../common/choices.js';
import { make, setText } from '../common/dom.js';

const LOOKS = ['arrows', 'strokes', 'none'];

export class Directions {
    constructor({ session }) {
        this.session = session;
        this.why = make('p', { class: 'note' });
        this.choices = make('fieldset', { class: 'segments' }, make('legend', {}, say('arrows.title')));
        this.element = make('div', { id: 'directions' }, this.choices, this.why);
        fillSegments(this.choices, 'directions', LOOKS.map((look) => [look, say(`arrows.${look}`)]),
            (arrows) => session.setParams({ arrows }));
    }

    update() {
        const { model, params } = this.session, now = params.arrows ?? 'arrows';
        this.element.hidden = ![params, params.split ?? params].some(({ group }) => model.group(group)?.directed);
        markSegment(this.choices, now);
        setText(this.why, say(`arrows.${now}.why`));
    }
}
