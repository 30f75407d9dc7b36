// SPDX-License-Identifier: GPL-3.0-or-later
// Places sensors: the user chooses a sensor from a list, clicks on the surface or drags the marker, and then saves the tag list.
import { numberText } from '../../core/format.js';
import { whyNotSaved } from '../../core/refusals.js';
import { askPick, tellAsEngineer } from '../../core/requests.js';
import { standbyText } from '../../core/standby.js';
import { say } from '../../core/words.js';
import { make, setText } from '../common/dom.js';
import { fill } from '../common/widgets.js';
import { Accepting } from './accepting.js';

const SHOWN_TAGS = 60, GRAB_PX = { mouse: 14, pen: 18, touch: 26 };
const SAVING = ['save_tags', 'accept_places', 'restore_tags']; // message types that save
const metres = (m) => numberText(m, m < 1 ? 3 : 2);
const along = ({ along: state = 'waiting' } = {}) => say(`eng.${state}`);
const percent = (share) => numberText(100 * share, share > 0 && share < 0.1 ? 1 : 0);

// Returns the sentences about the sensor coverage of one asset, an element of `assets` in the message `gaps`.
export function gapText(of) {
    if (of.assumed)
        return say('eng.gap.assumed');
    const text = say('eng.gap', { metres: metres(of.farthest_m), far: percent(of.far_share), limit: metres(of.far_m),
        lost: percent(of.lost_share) });
    return of.next ? `${text} ${say('eng.gap.next', { a: of.next[0], b: of.next[1], metres: metres(of.next_m) })}` : text;
}

export class Placing {
    constructor({ session, viewport, overlay, selection, selectTag, showTag, refresh }) {
        Object.assign(this, { session, viewport, overlay, selection, selectTag, showTag, refresh });
        this.moves = [];   // draft positions that are not saved: { tag, asset, position }
        this.undone = [];  // undo stack of `moves`
        this.tag = null;   // name of the tag whose sensor the user is placing
        this.dragging = null;
        this.accepting = new Accepting({ session, refresh });
        this.build();
        this.listen();
    }

    build() {
        const button = (key, onclick) => make('button', { type: 'button', onclick }, say(key));
        this.hint = make('p', { class: 'hint', role: 'status' });
        this.find = make('input', { type: 'search', placeholder: say('eng.find'), 'aria-label': say('eng.find'),
            oninput: () => this.showTags() });
        this.list = make('ul', { class: 'tags' });
        this.tried = make('ul', { class: 'moves' });
        this.none = make('p', { class: 'quiet' }, say('eng.nomoves'));
        this.undo = button('eng.undo', () => this.step());
        this.back = button('eng.back', () => this.move([]));
        this.save = button('eng.save', () => {
            this.accepting.restores = false;
            tellAsEngineer(this.session, 'save_tags');
        });
        this.gaps = make('div', { class: 'gaps' });
        this.note = make('p', { class: 'note', role: 'status' });
        this.standby = make('p', { class: 'note', role: 'status' });
        this.dialog = make('dialog', { class: 'help diff', 'aria-label': say('eng.save') });
        this.element = make('div', { class: 'part' }, this.hint, this.find, this.list, this.accepting.element,
            make('h3', {}, say('eng.moves')), this.none, this.tried,
            make('div', { class: 'line' }, this.undo, this.back, button('eng.gaps', () => tellAsEngineer(this.session, 'gaps')), this.save),
            this.note, this.standby, this.gaps, this.dialog);
    }

    listen() {
        const { session } = this;
        session.on('picked', ({ purpose, asset, position }) => { if (purpose === 'placing') this.put(asset, position); });
        session.on('placed', () => this.show());
        session.on('gaps', (message) => this.showGaps(message));
        session.on('tags_diff', (message) => this.showDiff(message));
        session.on('tags_saved', (message) => this.onSaved(message));
        session.on('status', () => this.showStandby());
        this.showStandby();
        // the server refused a position: undoes it, so that the sensor is at its previous position again
        session.on('error', ({ about }) => { if (about === 'place') this.step(); });
        session.on('error', ({ about }) => { if (SAVING.includes(about)) this.stopSaving(); });
        // after a reconnect, stops waiting for the answer to a save, which cannot arrive any more
        session.on('hello', () => this.stopSaving());
        session.on('welcome', () => this.onWelcome());
        session.on('params', () => this.show());
        const on = (name, f) => this.viewport.element.addEventListener(name, f, { capture: true });
        on('pointerdown', (event) => this.grab(event));
        on('pointermove', (event) => this.drag(event));
        on('pointerup', (event) => this.drop(event));
        on('pointercancel', (event) => this.drop(event));
    }

    showStandby() {
        setText(this.standby, standbyText(this.session.model?.standby));
    }

    // Sends the unsaved draft positions again after a reload of the plant.
    onWelcome() {
        if (this.saving)
            // a save is running: the server will send its result, so the draft positions need not be sent again
            return;
        const known = ({ tag, asset }) => this.session.model.tag(tag) && this.session.model.asset(asset);
        this.moves = this.moves.filter(known);
        this.undone = [];
        if (this.moves.length > 0)
            tellAsEngineer(this.session, 'place', { moves: this.moves });
        this.show();
    }

    // --- moving

    move(moves, keep = true) {
        if (keep)
            this.undone.push(this.moves);
        this.moves = moves;
        tellAsEngineer(this.session, 'place', { moves });
        this.show();
    }

    step() {
        if (this.undone.length > 0)
            this.move(this.undone.pop(), false);
    }

    takesClick(x, y) {
        if (!this.tag)
            return false;
        this.begin = this.moves;
        askPick(this.session, this.viewport.pixelOf(x, y), 'placing');
        return true;
    }

    // Sets the position of the tag being placed. A click or a whole drag is one undo step, however many positions the drag
    // passes.
    put(asset, position) {
        if (!this.tag)
            return;
        setText(this.note, asset ? '' : say('eng.missed'));
        if (!asset)
            return;
        const first = this.begin !== null;
        if (first)
            this.undone.push(this.begin);
        this.begin = null;
        this.move([...this.moves.filter(({ tag }) => tag !== this.tag), { tag: this.tag, asset, position }], false);
    }

    grab(event) {
        const box = this.viewport.element.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
        const tag = this.session.model?.tag(this.tag), marker = tag && this.overlay.marker(tag);
        const at = marker && this.overlay.placeOf(marker);
        if (this.element.offsetParent === null || !at || event.target.closest('button, .card')
            || Math.hypot(at.x - x, at.y - y) > (GRAB_PX[event.pointerType] ?? GRAB_PX.mouse))
            return;
        this.dragging = event.pointerId;
        this.begin = this.moves;
        this.viewport.element.setPointerCapture(event.pointerId);
        event.stopPropagation();
        event.preventDefault();
    }

    drag(event) {
        if (event.pointerId !== this.dragging)
            return;
        event.stopPropagation();
        const box = this.viewport.element.getBoundingClientRect();
        this.at = [event.clientX - box.left, event.clientY - box.top];
        this.frame ??= requestAnimationFrame(() => {
            this.frame = null;
            askPick(this.session, this.viewport.pixelOf(...this.at), 'placing');
        });
    }

    drop(event) {
        if (event.pointerId !== this.dragging)
            return;
        event.stopPropagation();
        this.dragging = null;
    }

    // --- display

    show() {
        const { model } = this.session;
        if (!model || this.element.offsetParent === null)
            return;
        setText(this.hint, this.tag ? say('eng.click', { tag: this.tag }) : say('eng.choose'));
        this.undo.disabled = this.undone.length === 0;
        this.back.disabled = this.save.disabled = this.moves.length === 0;
        this.none.hidden = this.moves.length > 0;
        fill(this.tried, ...this.moves.map((move) => this.row(move, model.placed.get(move.tag))));
        this.showTags();
        this.accepting.show();
        this.refresh();
    }

    // Returns the equipment of the tag's saved position if its draft position is on other equipment; else null.
    left({ tag, asset }) {
        const known = this.session.model.tag(tag), own = (known?.saved ?? known)?.asset;
        return own && own !== asset ? own : null;
    }

    row(move, placed) {
        const { tag, asset, position } = move, off = placed && placed.distance_m > placed.limit_m, left = this.left(move);
        return make('li', {}, make('b', {}, tag), ` ${say('eng.on', { asset })} `,
            left ? make('span', { class: 'off' }, say('eng.left', { asset: left })) : null,
            make('span', { class: 'place' }, position.map((v) => numberText(v, 3)).join(' · ')),
            make('span', { class: off ? 'along off' : 'along' },
                off ? say('eng.off', { metres: metres(placed.distance_m) }) : along(placed)));
    }

    // Lists the tags, those without a position first.
    showTags() {
        const { model, params } = this.session, wanted = this.find.value.trim().toLowerCase();
        const fits = ({ name, description, group }) =>
            group && (wanted ? `${name} ${description}`.toLowerCase().includes(wanted) : true);
        const tags = model.tags.filter((tag) => fits(tag) && (wanted || !tag.position || tag.group === params.group));
        tags.sort((a, b) => Boolean(a.position) - Boolean(b.position));
        fill(this.list, ...tags.slice(0, SHOWN_TAGS).map((tag) => make('li', {}, make('button', {
            type: 'button', 'aria-pressed': String(tag.name === this.tag), onclick: () => this.choose(tag),
        }, make('b', {}, tag.name), ' ', tag.description ?? '', make('i', {},
            tag.asset ? say('eng.on', { asset: tag.asset }) : say('eng.nowhere'))))));
    }

    choose(tag) {
        this.tag = this.tag === tag.name ? null : tag.name;
        if (this.tag)
            this.showTag(tag);
        this.selectTag(null); // deselects the tag, because its card would cover the surface on which the user must click
        this.show();
    }

    showGaps({ group, far, assets }) {
        const { model } = this.session, { quantity } = model.group(group);
        fill(this.gaps, make('h3', {}, say('eng.gaps.of', { quantity })),
            ...(far.length > 0 ? far.map(([tag, asset, m, limit]) =>
                make('p', { class: 'off' }, say('eng.gap.off', { tag, asset, metres: metres(m), limit: metres(limit) })))
                : [make('p', {}, say('eng.gap.none'))]),
            ...assets.map((of) => make('p', {}, make('b', {}, of.asset), ' ', gapText(of))));
    }

    // --- saving

    showDiff({ file, conflict, hash, lines, more }) {
        if (hash !== null && hash === this.confirmed)
            return; // the user has already confirmed these changes to the tag list, and the list is being saved: does not ask again
        this.stopSaving();
        const close = () => this.dialog.close();
        const change = ([number, before, after]) => make('div', { class: 'change' }, make('span', {}, say('eng.diff.line', { n: number })),
            before === null ? null : make('pre', { class: 'before', 'aria-label': say('eng.diff.before') }, before),
            after === null ? null : make('pre', { class: 'after', 'aria-label': say('eng.diff.after') }, after));
        const confirm = make('button', { type: 'button', class: 'go', onclick: () => this.confirm(hash) }, say('eng.confirm'));
        fill(this.dialog, make('h2', {}, say('eng.diff', { file })),
            make('p', {}, conflict ? say('eng.diff.conflict', { file }) : say('eng.diff.note')),
            ...this.moves.filter((move) => this.left(move)).map((move) =>
                make('p', { class: 'off' }, say('eng.diff.left', { ...move, left: this.left(move) }))),
            make('div', { class: 'lines', tabindex: '0' }, ...lines.map(change)),
            more > 0 ? make('p', {}, say('eng.diff.more', { count: more })) : null,
            make('div', { class: 'line' }, make('button', { type: 'button', onclick: close }, say('cancel')),
                conflict ? null : confirm));
        if (!this.dialog.open)
            this.dialog.showModal();
    }

    // Ends a save that has not changed the tag list, and allows the next save.
    stopSaving() {
        if (this.saving)
            setText(this.note, '');
        this.saving = false;
        this.confirmed = null;
        this.accepting.end('');
    }

    confirm(hash) {
        this.dialog.close();
        this.confirmed = hash;
        if (this.accepting.restores)
            return this.accepting.confirmRestore(hash);
        this.saving = true;
        setText(this.note, say('eng.saving'));
        return tellAsEngineer(this.session, 'save_tags', { confirm: hash });
    }

    onSaved(message) {
        const { saved, kept } = message;
        this.confirmed = null;
        if (this.accepting.onSaved(message))
            return this.show();
        this.saving = false;
        setText(this.note, saved ? say('eng.saved', { kept }) : say('eng.unsaved', { text: whyNotSaved(message) }));
        if (saved) {
            this.moves = this.undone = [];
            this.tag = null;
        }
        return this.onWelcome();
    }
}
