// SPDX-License-Identifier: GPL-3.0-or-later
// Shift notes: pins in the picture, also on video walls, and a list and a form in the panel of views. On a video wall, also
// shows where a user at another computer (a desk) points.
import { projector } from '../../core/camera.js';
import { askInTime } from '../../core/http.js';
import { meets } from '../../core/labels.js';
import { aboutText, endText, inForce, isOfPlant, placeOf, whereOf, whereText } from '../../core/notes.js';
import { placePin } from '../../core/pins.js';
import { refusalText } from '../../core/refusals.js';
import { halves } from '../../core/split_view.js';
import { say } from '../../core/words.js';
import { fillSelect } from '../common/choices.js';
import { byId, make, setText, setVariable } from '../common/dom.js';

const UNTIL = ['shift', 'day', 'week', 'ever'], HOURS = { shift: 8, day: 24, week: 168 };
const MAY = ['operator', 'engineer'], POINTS_MS = 4000, TICK_MS = 500, LONGEST = 130;
const RING = 13, MARK = 6; // radii in CSS pixels of an alarm ring including its outlines, and of other markers; larger on a video wall

// Makes a pin's stem, the line from the pin to its point. The stem is drawn below all other markers over the picture, so labels
// and other pins cover it.
function makeStem(kind = '') {
    const stem = make('i', { class: `note-stem ${kind}`, hidden: true });
    byId('picture').after(stem);
    return stem;
}

function unpin({ element, stem }) {
    element.remove();
    stem.remove();
}

const setVariables = (element, px) => Object.entries(px).forEach(([name, value]) => setVariable(element, `--${name}`, `${value}px`));

export class Notes {
    constructor({ session, selection, viewport, overlay, modules, hangs, tell, flyToTag, selectAsset }) {
        Object.assign(this, { session, selection, viewport, overlay, modules, hangs, flyToTag, selectAsset });
        this.pins = new Map(); // pins of notes: id -> { element, stem, position }
        // on a video wall: mark where a user at another computer points: { element, stem, position, until }; null: nobody
        // points
        this.pointer = null;
        this.list = make('ul', { id: 'notes-list' });
        this.ofPlant = make('ul', { id: 'plant-notes', hidden: true }); // list over the picture with the notes about the whole plant
        viewport.element.append(this.ofPlant);
        this.edited = null; // the note being edited in the form; null: the form adds a note
        this.text = make('input', { maxlength: LONGEST, placeholder: say('notes.text'), 'aria-label': say('notes.text'), id: 'note-text' });
        this.at = make('select', { id: 'note-at', 'aria-label': say('notes.at') });
        this.until = make('select', { id: 'note-until', 'aria-label': say('notes.until') });
        this.button = make('button', { type: 'submit' }, say('notes.save'));
        this.cancel = make('button', { type: 'button', hidden: true, onclick: () => this.edit(null) }, say('cancel'));
        this.form = make('form', { id: 'note-form', onsubmit: (event) => this.onSave(event) }, this.text,
            make('div', { class: 'line' }, this.at, this.until, this.cancel, this.button));
        this.element = make('fieldset', { id: 'notes' }, make('legend', {}, say('notes.legend')), this.list, this.form,
            make('a', { id: 'notes-handover', href: 'handover.html', target: '_blank', rel: 'opener' }, say('notes.handover')));
        byId('views').append(this.element);
        session.on('notes', () => this.hear());
        for (const name of ['welcome', 'time'])
            session.on(name, () => this.hear());
        session.greeted(() => this.askName());
        session.on('pointed', () => this.point());
        session.on('params', () => this.offer());
        session.on('noted', ({ kept, why, refusal }) => (kept ? this.onKept() : tell(refusalText(why, refusal))));
        setInterval(() => this.tick(), TICK_MS);
        this.hear();
        this.offer();
        this.offerEnds();
        this.point();
    }

    // Returns true if the user may add and remove notes; nobody may while the past is shown.
    get may() {
        return MAY.includes(this.session.role) && this.session.time.atUs === null;
    }

    // Returns true while the form has text or edits a note.
    get isWriting() {
        return Boolean(this.edited || this.text.value);
    }

    // Asks for the name under which the server stores this user's notes; only the author may change a note.
    async askName() {
        if (!MAY.includes(this.session.role))
            return;
        const answer = await askInTime('api/v1/me', {}, this.session.token).catch(() => null);
        this.name = answer && (answer.name ?? 'local');
        this.hear();
    }

    // --- making a note

    // Returns what a note can be attached to now: the selected tag, equipment or point, and the whole plant.
    get places() {
        const { model, params } = this.session, picked = this.modules.there('place')?.picked, out = [];
        if (model?.tag(this.selection.tag))
            out.push(['tag', { tag: this.selection.tag }, this.selection.tag]);
        if (picked)
            out.push(['place', { position: picked.position }, say('notes.place')]);
        if (model?.asset(params.selected))
            out.push(['asset', { asset: params.selected }, whereOf(model, { asset: params.selected })]);
        return [...out, ['plant', {}, say('notes.plant')]];
    }

    offer() {
        const places = this.edited ? [['', {}, whereText(this.session.model, this.edited)]] : this.places, now = JSON.stringify(places);
        if (now === this.offered)
            return;
        this.offered = now;
        fillSelect(this.at, places.map(([name, , words]) => [name, words]), places[0][0]);
        this.at.disabled = Boolean(this.edited);
    }

    // Fills the selection list of end times for a note. While a note is edited, its present end comes first.
    offerEnds() {
        const { edited } = this, kept = edited && endText(this.session.model, edited);
        fillSelect(this.until, [...(kept ? [['kept', kept]] : []), ...UNTIL.map((name) => [name, say(`until.${name}`)])],
            kept ? 'kept' : edited ? 'ever' : 'shift');
    }

    // Returns the chosen end in microseconds; null: the note does not end by itself.
    get untilUs() {
        const hours = HOURS[this.until.value];
        if (this.until.value === 'kept')
            return this.edited.until_us;
        return hours ? Math.round(this.session.clockUs() + hours * 3600e6) : null;
    }

    // Fills the form with the note to edit; null: empties the form.
    edit(note) {
        this.edited = note;
        this.text.value = note?.text ?? '';
        this.cancel.hidden = !note;
        setText(this.button, say(note ? 'notes.change' : 'notes.save'));
        this.offer();
        this.offerEnds();
        if (note)
            this.text.focus();
    }

    onSave(event) {
        event.preventDefault();
        const { session, edited } = this, text = this.text.value.trim();
        const place = edited ? { replaces: edited.id } : this.places.find(([name]) => name === this.at.value)?.[1];
        if (!text || !place)
            return;
        const { untilUs } = this, until = untilUs === null ? {} : { until_us: untilUs };
        session.post({ type: 'note', seq: ++session.toldSeq, text, ...place, ...until });
    }

    onKept() {
        this.edit(null);
        this.text.blur();
    }

    remove(id) {
        this.session.post({ type: 'remove_note', seq: ++this.session.toldSeq, id });
    }

    // --- existing notes

    get notes() {
        return inForce(this.session.notes, this.session.clockUs(), this.session.time.atUs);
    }

    // Removes notes that have ended, and offers the current selection as the place of a new note.
    tick() {
        this.offer();
        if (this.notes.length !== this.list.children.length)
            this.hear();
        if (this.pointer && performance.now() > this.pointer.until)
            this.drop();
    }

    hear() {
        const { model } = this.session, { notes } = this;
        this.form.hidden = byId('notes-handover').hidden = !this.may;
        this.element.hidden = notes.length === 0 && !this.may;
        this.list.replaceChildren(...notes.map((note) => this.rowOf(note)));
        if (this.edited && !notes.some(({ id }) => id === this.edited.id))
            this.edit(null); // somebody ended the note meanwhile
        const ofPlant = model ? notes.filter(isOfPlant) : [];
        this.ofPlant.hidden = ofPlant.length === 0;
        this.ofPlant.replaceChildren(...ofPlant.map((note) => make('li', {}, note.text, ' ', make('small', {}, this.authorOf(note)))));
        this.pins.forEach(unpin);
        this.pins.clear();
        for (const note of model ? notes : []) {
            const position = placeOf(model, note);
            if (position)
                this.pins.set(note.id, { position, element: this.pinOf(note), stem: makeStem() });
        }
        this.show();
        // repositions the sensor labels, so that none covers a new pin
        this.overlay.dirty = true;
        this.viewport.invalidate();
    }

    pinOf(note) {
        const title = aboutText(this.session.model, note);
        const pin = make('button', { type: 'button', class: 'note-pin', title, onclick: () => this.lookAt(note) },
            make('span', {}, note.text));
        byId('overlay').before(pin); // inserted before the overlay, so that alarm rings and their labels are drawn over the pin
        return pin;
    }

    // Returns a note's author, and until when the note is shown.
    authorOf(note) {
        return [note.by, endText(this.session.model, note)].filter(Boolean).join(' · ');
    }

    rowOf(note) {
        const button = (name, f) => make('button', { type: 'button', class: name, onclick: f }, say(`notes.${name}`));
        return make('li', { 'data-id': note.id }, make('b', {}, note.text), make('small', {}, aboutText(this.session.model, note)),
            this.isOwn(note) ? button('edit', () => this.edit(note)) : null,
            this.isOwn(note) || (this.may && this.session.role === 'engineer') ? button('end', () => this.remove(note.id)) : null);
    }

    // Returns true if the note was written from the user's account and the user may still change it.
    isOwn(note) {
        return this.may && note.by === this.name;
    }

    lookAt({ tag, asset }) {
        if (tag && this.session.model.tag(tag))
            this.flyToTag(this.session.model.tag(tag));
        else if (asset && this.session.model.asset(asset))
            this.selectAsset(this.session.model.asset(asset));
    }

    // --- on a wall: position at which a user at another computer points

    point() {
        const { hangs, session } = this;
        const mine = hangs && session.pointed.filter(({ wall, display, area }) => `${wall}/${display}/${area}` === hangs).at(-1);
        if (!mine)
            return;
        if (!mine.position) {
            this.drop();
            return;
        }
        if (!this.pointer) {
            this.pointer = { element: make('p', { class: 'note-pin pointer' }, make('span', {})), stem: makeStem('pointer') };
            this.viewport.element.append(this.pointer.element);
        }
        this.pointer.position = mine.position;
        this.pointer.until = performance.now() + POINTS_MS;
        setText(this.pointer.element.firstChild, mine.by);
        this.pointer.room = null; // its width may have changed
        this.show();
    }

    drop() {
        if (this.pointer)
            unpin(this.pointer);
        this.pointer = null;
    }

    // positions that follow the picture

    // Places the pins of notes in the left half of a split view, or in the whole picture. The newest pins are placed first, so
    // that only older pins, which are drawn below the others, get longer stems. While the camera moves, a pin keeps its
    // distance from its point as long as it covers nothing, so that it does not jump.
    show() {
        const { picture, shown } = this.session, half = picture && halves(shown, picture.shownWidth)[0];
        const project = half && projector(picture.camera, half.width, picture.fullHeight), { wide, high } = this.overlay;
        const pins = [...(this.pointer ? [this.pointer] : []), ...[...this.pins.values()].reverse()];
        const area = half && { left: 0, top: 0, right: ((half.left + half.width) * wide) / picture.shownWidth, bottom: high };
        const [fixed, rings, marks] = pins.length > 0 && half ? [this.overlay.boxesOver(''), ...this.markers()] : [[], [], []];
        const marked = [...rings, ...marks];
        for (const pin of pins) {
            const { element, stem, position } = pin, at = project?.(position);
            const x = at && ((half.left + at[0]) * wide) / picture.shownWidth, y = at && (at[1] * high) / picture.fullHeight;
            element.hidden = stem.hidden = !at || x < 0 || y < 0 || x > wide || y > high || at[0] > half.width;
            if (element.hidden)
                continue;
            if (pin.room !== `${area.right}/${high}`) { // measures the pin only if the room for it has changed
                setVariable(element, '--most', `${area.right - 4}px`);
                Object.assign(pin, { room: `${area.right}/${high}`, wide: element.offsetWidth, high: element.offsetHeight });
            }
            const [left, top] = picture.still || !pin.offset ? [-1, -1] : [x + pin.offset[0], y + pin.offset[1]];
            const kept = { left, top, right: left + pin.wide, bottom: top + pin.high };
            const isFree = left >= 0 && top >= 0 && kept.right <= area.right && kept.bottom <= area.bottom &&
                !fixed.some((other) => meets(kept, other)) && !rings.some((ring) => meets(kept, ring));
            const box = isFree ? kept : placePin({ ...pin, x, y }, area, fixed, rings, marks);
            pin.offset = [box.left - x, box.top - y];
            element.classList.toggle('over', marked.some((mark) => meets(mark, box)));
            fixed.push(box);
            const fromX = Math.max(box.left, Math.min(box.right, x)), fromY = Math.max(box.top, Math.min(box.bottom, y));
            setVariables(element, { left: box.left, top: box.top });
            setVariables(stem, { left: fromX - 1, top: fromY, long: Math.hypot(x - fromX, y - fromY) });
            setVariable(stem, '--turn', `${Math.atan2(fromX - x, y - fromY)}rad`);
        }
    }

    // Returns the boxes of the alarm rings and of the other sensor markers in the left half of a split view, in CSS pixels (larger on a
    // wall), so that pins do not cover them.
    markers() {
        const boxes = (markers, radius) => markers.filter(({ half }) => half === 0)
            .map(({ x, y }) => ({ left: x - radius, right: x + radius, top: y - radius, bottom: y + radius }));
        return [boxes(this.overlay.project().filter(({ alarm }) => alarm), RING),
            boxes(this.overlay.markers.filter(({ alarm }) => !alarm), MARK)];
    }
}
