// SPDX-License-Identifier: GPL-3.0-or-later
// The panel of views: direction of view, projection, section, and visible equipment.
import { isParallel } from '../../core/camera.js';
import { numberText } from '../../core/format.js';
import { toParallel, toPerspective } from '../../core/camera_moves.js';
import { askFit } from '../../core/requests.js';
import { AXES, boxAround, cut, readBox, readCut, showAll, showAsset } from '../../core/section.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';
import { fillSegments, markSegment } from '../common/choices.js';
import { collapsiblePanel } from '../common/collapsible.js';

const choices = (kind, ...values) => values.map((value) => [value, say(`${kind}.${value}`)]);
const STEPS = 500, LARGEST_BOX = 2, EXTREMES = [['highest', 1], ['lowest', -1]];

export class Views {
    constructor({ session, modules, viewport, showTag, flyToTag, tell }) {
        Object.assign(this, { session, viewport, modules, showTag, flyToTag, tell });
        this.panel = byId('views');
        this.at = byId('cut-at');
        const sides = choices('side', 'top', 'front', 'right', 'back', 'left', 'iso');
        byId('sides').append(make('div', { class: 'buttons' }, ...sides.map(([side, text]) =>
            make('button', { type: 'button', onclick: () => this.lookFrom(side) }, text))));
        byId('extremes').append(make('div', { class: 'buttons' }, ...EXTREMES.map(([name, sign]) =>
            make('button', { type: 'button', 'data-extreme': name, onclick: () => this.goToExtreme(sign) }, say(`extreme.${name}`)))));
        const projections = choices('projection', 'perspective', 'parallel');
        fillSegments(byId('projection'), 'projection', projections, (projection) => this.project(projection === 'parallel'));
        const cuts = [...choices('cut', 'off'), ...AXES.map((axis) => [axis, axis.toUpperCase()]), ...choices('cut', 'box')];
        fillSegments(byId('cut'), 'cut', cuts, (axis) => this.cutBy(axis));
        byId('cut-turn').addEventListener('click', () => this.turn());
        this.at.addEventListener('input', () => this.move());
        const shows = choices('shown', 'hide', 'ghost', 'only');
        byId('shows').append(make('div', { class: 'buttons' },
            ...shows.map(([how, text]) => make('button', { type: 'button', 'data-how': how, onclick: () => this.show(how) }, text)),
            make('button', { type: 'button', id: 'show-all', onclick: () => this.showAll() }, say('views.all'))));
        Object.assign(this, collapsiblePanel(this.panel, byId('views-toggle'), () => {
            this.update();
            modules.use('namedViews', (named) => named.draw(), 'draw');
            ['notes', 'remote'].forEach((name) => modules.get(name));
        }));
        session.on('fitted', (camera) => modules.use('cameraController', (cameraController) => cameraController.flyTo(camera)));
        session.on('params', () => this.update());
        session.on('camera', () => this.update());
        session.on('welcome', () => this.update());
    }

    // Opens a saved view.
    openNamed(id, fly) {
        this.modules.use('namedViews', (named) => named.open(id, fly), 'open');
    }

    // Requests the engineer-only parameters of a saved view: this session may not send them itself.
    regain(id) {
        this.modules.use('namedViews', (named) => named.regain(id), 'open');
    }

    // Opens the view that the text of a URL fragment describes.
    lookAt(text) {
        this.modules.use('namedViews', (named) => named.look(text, false), 'open');
    }

    close() {
        this.set(false);
    }

    lookFrom(side) {
        askFit(this.session, { id: this.session.params.selected ?? null, side, projection: this.projection });
    }

    // Flies to the sensor with the highest (sign 1) or lowest (sign -1) usable reading of the shown quantity, and opens its card.
    goToExtreme(sign) {
        const { model, params } = this.session, at = ({ index }) => model.readings[index];
        const [first, ...others] = model.tags.filter((tag) => tag.group === params.group && tag.asset && tag.position &&
            at(tag).quality !== 'bad' && at(tag).value !== null);
        if (!first) {
            this.tell(say('novalue'));
            return;
        }
        const tag = others.reduce((best, one) => (sign * (at(one).value - at(best).value) > 0 ? one : best), first);
        this.close();
        this.showTag(tag);
        this.flyToTag(tag);
    }

    get projection() {
        return this.session.camera && isParallel(this.session.camera) ? 'orthographic' : 'perspective';
    }

    project(parallel) {
        const { camera } = this.session;
        if (camera && isParallel(camera) !== parallel)
            this.session.setCamera(parallel ? toParallel(camera) : toPerspective(camera));
        this.viewport.invalidate();
    }

    toggleProjection() {
        this.project(this.projection === 'perspective');
    }

    // --- the section

    range(axis) {
        const { min, max } = this.session.model.plant.bounds;
        const index = AXES.indexOf(axis);
        return [min[index], max[index]];
    }

    // Bounds for a new clip box: those of the selected equipment, else those of the plant.
    get boxed() {
        const { model, params } = this.session;
        return (model.asset(params.selected) ?? model.plant).bounds;
    }

    cutBy(axis) {
        if (axis === 'off' || axis === 'box') {
            this.session.setParams({ clip: axis === 'box' ? boxAround(this.boxed, 1) : null });
            return;
        }
        const [min, max] = this.range(axis);
        // a horizontal section keeps the lower part, so that users look into it from above
        this.session.setParams({ clip: cut(axis, (min + max) / 2, axis === 'z') });
    }

    turn() {
        const now = readCut(this.session.params.clip);
        if (now)
            this.session.setParams({ clip: cut(now.axis, now.at, !now.turned) });
    }

    // Moves the section plane at most once per animation frame, because sliders fire more often.
    move() {
        if (this.moving)
            return;
        this.moving = true;
        requestAnimationFrame(() => {
            this.moving = false;
            const { clip } = this.session.params, now = readCut(clip);
            if (clip?.box)
                this.session.setParams({ clip: boxAround(this.boxed, Math.max(1, this.at.value) * (LARGEST_BOX / STEPS)) });
            if (!now)
                return;
            const [min, max] = this.range(now.axis);
            this.session.setParams({ clip: cut(now.axis, min + ((max - min) * this.at.value) / STEPS, now.turned) });
        });
    }

    // --- equipment

    show(how, id = this.session.params.selected) {
        if (id)
            this.session.setParams(showAsset(this.session.params, how, id));
    }

    showAll() {
        this.session.setParams(showAll(this.session.params));
    }

    update() {
        const { model, params } = this.session;
        if (!model || !this.panel.classList.contains('open'))
            return;
        markSegment(byId('projection'), this.projection === 'orthographic' ? 'parallel' : 'perspective');
        const now = readCut(params.clip);
        const part = readBox(params.clip, this.boxed);
        const box = params.clip?.box;
        markSegment(byId('cut'), now?.axis ?? (box ? 'box' : params.clip ? '' : 'off'));
        byId('cut-place').hidden = !now && !box;
        byId('cut-turn').hidden = !now;
        this.at.hidden = box && part === null;
        if (box && part === null)
            setText(byId('cut-text'), `${box.max.map((high, i) => numberText(high - box.min[i], 1)).join(' × ')} m`);
        if (part !== null) {
            const what = model.asset(params.selected)?.tag || say('views.plant');
            this.at.value = Math.round((part * STEPS) / LARGEST_BOX);
            setText(byId('cut-text'), say('views.part', { percent: Math.round(100 * part), what }));
        }
        if (now) {
            const [min, max] = this.range(now.axis);
            this.at.max = STEPS;
            if (document.activeElement !== this.at || !this.moving)
                this.at.value = Math.round(((now.at - min) / (max - min)) * STEPS);
            setText(byId('cut-text'), say('views.stays', {
                axis: now.axis.toUpperCase(), sign: now.turned ? '≤' : '≥', at: numberText(now.at, 1) }));
        }
        const asset = model.asset(params.selected);
        setText(byId('shows-what'), asset ? say('views.equipment', { what: asset.tag || asset.id }) : say('views.select'));
        for (const button of byId('shows').querySelectorAll('[data-how]'))
            button.disabled = !asset;
        byId('show-all').disabled = Object.keys(showAll(params)).length === 0;
    }
}
