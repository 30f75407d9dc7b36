// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the distance between two clicked points of the plant; the line between them moves with the picture.
import { projector } from '../../core/camera.js';
import { halves } from '../../core/split_view.js';
import { measure, metresText } from '../../core/measure.js';
import { askPick, isClickDue } from '../../core/requests.js';
import { asAsked } from '../../core/session.js';
import { say } from '../../core/words.js';
import { byId, make, makeSvg, setText } from '../common/dom.js';

export class Measure {
    constructor({ session, viewport }) {
        Object.assign(this, { session, viewport, places: [], on: false });
        this.line = makeSvg('svg', { class: 'measure', 'aria-hidden': 'true' });
        this.label = make('output', { class: 'measured', id: 'measured' });
        this.note = make('div', { class: 'following measuring', role: 'status' }, make('span', {}),
            make('button', { type: 'button', onclick: () => this.setOn(false) }, say('measure.end')));
        viewport.element.append(this.line, this.label, this.note);
        session.on('picked', (picked) => picked.purpose === 'measure' && this.hear(picked));
        session.on('welcome', () => this.setOn(false));
        this.setOn(false);
    }

    toggle() {
        this.setOn(!this.on);
    }

    setOn(on) {
        this.on = on;
        this.places = [];
        this.next = null; // click that waits for the answer to the previous click
        this.note.hidden = !on;
        byId('measure').setAttribute('aria-pressed', on);
        this.viewport.element.classList.toggle('pointing-out', on);
        this.show();
    }

    // Takes a clicked point at x, y in CSS pixels of the viewport. A third click starts another measurement.
    click(x, y) {
        const { session, viewport } = this;
        if (!session.picture)
            return;
        const half = session.shown.split && x >= viewport.width / 2 ? 1 : 0;
        const click = { half, pixel: viewport.pixelOf(x, y), camera: asAsked(session.picture.camera) };
        if (isClickDue(session))
            this.next = click;
        else
            this.send(click);
    }

    send({ half, pixel, camera }) {
        if (this.places.length === 2)
            this.places = [];
        Object.assign(this, { half, next: null });
        askPick(this.session, pixel, 'measure', camera);
    }

    hear({ position }) {
        if (this.on && position && this.places.length < 2)
            this.places.push(position);
        this.missed = !position;
        this.show();
        if (this.next)
            this.send(this.next);
    }

    get words() {
        if (this.missed && this.places.length < 2)
            return say('measure.missed');
        return say(['measure.first', 'measure.second', 'measure.done'][this.places.length]);
    }

    // Moves the line between the two points with the picture.
    show() {
        setText(this.note.querySelector('span'), this.words);
        const { picture, shown } = this.session;
        const half = picture && (halves(shown, picture.shownWidth)[this.half] ?? null);
        this.label.hidden = true;
        if (!half || this.places.length === 0) {
            this.line.replaceChildren();
            return;
        }
        const project = projector(picture.camera, half.width, picture.fullHeight);
        const scale = [this.viewport.width / picture.shownWidth, this.viewport.height / picture.fullHeight];
        const ends = this.places.map(project).map((at) => at && [(half.left + at[0]) * scale[0], at[1] * scale[1]]);
        this.draw(ends);
    }

    draw(ends) {
        const nodes = ends.filter(Boolean).map(([x, y]) => makeSvg('path', { class: 'end', d: `M${x - 7} ${y}h14M${x} ${y - 7}v14` }));
        if (ends.length === 2 && ends[0] && ends[1]) {
            const [[x1, y1], [x2, y2]] = ends, d = `M${x1} ${y1}L${x2} ${y2}`;
            nodes.unshift(makeSvg('path', { class: 'under', d }), makeSvg('path', { d }));
            this.write((x1 + x2) / 2, (y1 + y2) / 2);
        }
        this.line.replaceChildren(...nodes);
    }

    write(x, y) {
        const { metres, level, rise } = measure(...this.places, this.session.model.plant.up);
        this.label.hidden = false;
        this.label.replaceChildren(make('b', {}, `${metresText(metres)} m`), ` ${say('measure.parts', {
            level: metresText(level), rise: metresText(rise) })}`);
        const [width, height] = [this.label.offsetWidth, this.label.offsetHeight];
        const within = (n, size, most) => Math.round(Math.max(8, Math.min(most - size - 8, n - size / 2)));
        this.label.style.transform =
            `translate(${within(x, width, this.viewport.width)}px, ${within(y - height, height, this.viewport.height)}px)`;
    }
}
