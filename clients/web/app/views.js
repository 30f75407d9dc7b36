// SPDX-License-Identifier: GPL-3.0-or-later
// The panel of views: from where to look, in which projection, what is cut away and which equipment is shown.
import { isParallel, toParallel, toPerspective } from '../core/camera.js';
import { AXES, cut, readCut, showAll, showAsset } from '../core/section.js';
import { byId, make, setText } from './dom.js';

const SIDES = [['top', 'Top'], ['front', 'Front'], ['right', 'Right'], ['back', 'Back'], ['left', 'Left'], ['iso', 'Corner']];
const PROJECTIONS = [['perspective', 'Perspective'], ['parallel', 'Parallel']];
const CUTS = [['off', 'Off'], ...AXES.map((axis) => [axis, axis.toUpperCase()])];
const SHOWS = [['hide', 'Hide'], ['ghost', 'Ghost'], ['only', 'Only this']];
const STEPS = 500;

function segments(fieldset, name, choices, onChoose) {
    const row = make('div', { class: 'row' });
    for (const [value, text] of choices) {
        const input = make('input', { type: 'radio', name, value, onchange: () => onChoose(value) });
        row.append(make('label', {}, input, make('span', {}, text)));
    }
    fieldset.append(row);
}

function mark(fieldset, value) {
    for (const input of fieldset.querySelectorAll('input[type="radio"]'))
        input.checked = input.value === value;
}

export class Views {
    constructor({ session, pilot }) {
        Object.assign(this, { session, pilot });
        this.panel = byId('views');
        this.at = byId('cut-at');
        byId('sides').append(make('div', { class: 'buttons' }, ...SIDES.map(([side, text]) =>
            make('button', { type: 'button', onclick: () => this.lookFrom(side) }, text))));
        segments(byId('projection'), 'projection', PROJECTIONS, (projection) => this.project(projection === 'parallel'));
        segments(byId('cut'), 'cut', CUTS, (axis) => this.cutBy(axis));
        byId('cut-turn').addEventListener('click', () => this.turn());
        this.at.addEventListener('input', () => this.move());
        byId('shows').append(make('div', { class: 'buttons' },
            ...SHOWS.map(([how, text]) => make('button', { type: 'button', 'data-how': how, onclick: () => this.show(how) }, text)),
            make('button', { type: 'button', id: 'show-all', onclick: () => this.showAll() }, 'Show all')));
        this.foldPanel();
        session.on('fitted', (camera) => this.pilot.flyTo(camera));
        session.on('params', () => this.update());
        session.on('camera', () => this.update());
        session.on('welcome', () => this.update());
    }

    foldPanel() {
        const button = byId('views-toggle');
        this.set = (open) => {
            this.panel.classList.toggle('open', open);
            button.setAttribute('aria-expanded', open);
            this.update();
        };
        button.addEventListener('click', () => this.toggle());
        document.addEventListener('pointerdown', (event) => {
            if (!event.target.closest('#views, #views-toggle, #viewport'))
                this.set(false);
        });
    }

    toggle() {
        this.set(!this.panel.classList.contains('open'));
    }

    close() {
        this.set(false);
    }

    lookFrom(side) {
        this.session.fit({ id: this.session.params.selected ?? null, side, projection: this.projection });
    }

    get projection() {
        return this.session.camera && isParallel(this.session.camera) ? 'orthographic' : 'perspective';
    }

    project(parallel) {
        const { camera } = this.session;
        if (camera && isParallel(camera) !== parallel)
            this.session.setCamera(parallel ? toParallel(camera) : toPerspective(camera));
        this.pilot.viewport.invalidate();
    }

    toggleProjection() {
        this.project(this.projection === 'perspective');
    }

    // --- the cut

    range(axis) {
        const { min, max } = this.session.model.plant.bounds;
        const index = AXES.indexOf(axis);
        return [min[index], max[index]];
    }

    cutBy(axis) {
        if (axis === 'off') {
            this.session.setParams({ clip: null });
            return;
        }
        const [min, max] = this.range(axis);
        this.session.setParams({ clip: cut(axis, (min + max) / 2, axis === 'z') }); // from above one looks into it
    }

    turn() {
        const now = readCut(this.session.params.clip);
        if (now)
            this.session.setParams({ clip: cut(now.axis, now.at, !now.turned) });
    }

    // Once per animation frame: a slider speaks oftener.
    move() {
        if (this.moving)
            return;
        this.moving = true;
        requestAnimationFrame(() => {
            this.moving = false;
            const now = readCut(this.session.params.clip);
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
        mark(byId('projection'), this.projection === 'orthographic' ? 'parallel' : 'perspective');
        const now = readCut(params.clip);
        mark(byId('cut'), now?.axis ?? (params.clip ? '' : 'off'));
        byId('cut-place').hidden = !now;
        if (now) {
            const [min, max] = this.range(now.axis);
            this.at.max = STEPS;
            if (document.activeElement !== this.at || !this.moving)
                this.at.value = Math.round(((now.at - min) / (max - min)) * STEPS);
            setText(byId('cut-text'), `${now.axis} ${now.turned ? '≤' : '≥'} ${now.at.toFixed(1)} m stays`);
        }
        const asset = model.asset(params.selected);
        setText(byId('shows-what'), asset ? asset.tag || asset.id : 'Select equipment first');
        for (const button of byId('shows').querySelectorAll('[data-how]'))
            button.disabled = !asset;
        byId('show-all').disabled = Object.keys(showAll(params)).length === 0;
    }
}
