// SPDX-License-Identifier: GPL-3.0-or-later
// The toolbar: what is shown and how. It shows the parameters in force and asks for others.
import { numberText, unitText } from '../core/format.js';
import { rampChoices } from '../core/legend.js';
import { byId, make, setText } from './dom.js';

const DISTANCES = [
    ['geodesic', 'Geodesic', 'Distance along the surface: heat does not jump across a gap'],
    ['euclidean', 'Euclidean', 'Straight distance through space'],
];
const INTERPOLATIONS = [
    ['shepard', 'Shepard', 'Inverse distance: exactly the reading at each sensor'],
    ['paper', 'Paper', 'Algorithm 1 of Kim & Suh 2025: smoother, does not reach the readings'],
];
const LOOKS = [['default', 'Measured'], ['glossy', 'Glossy'], ['flat', 'Flat']];

// A row of buttons of which one is pressed; radio buttons underneath, so the keyboard works as everywhere.
function fillSegments(fieldset, name, choices, onChoose) {
    const row = make('div', { class: 'row' });
    for (const [value, text, title] of choices) {
        const input = make('input', { type: 'radio', name, value, onchange: () => onChoose(value) });
        row.append(make('label', { title }, input, make('span', {}, text)));
    }
    fieldset.replaceChildren(fieldset.querySelector('legend'), row);
}

function mark(fieldset, value) {
    for (const input of fieldset.querySelectorAll('input'))
        input.checked = input.value === value;
}

function fillSelect(select, choices, value) {
    const wanted = JSON.stringify(choices);
    if (select.dataset.choices !== wanted) {
        select.dataset.choices = wanted;
        select.replaceChildren(...choices.map(([v, text]) => make('option', { value: v }, text)));
    }
    select.value = String(value);
}

const title = (text) => text.charAt(0).toUpperCase() + text.slice(1);

export class Toolbar {
    constructor({ session }) {
        this.session = session;
        fillSegments(byId('distance'), 'distance', DISTANCES, (distance) => session.setParams({ distance }));
        fillSegments(byId('interpolation'), 'interpolation', INTERPOLATIONS, (interpolation) => session.setParams({ interpolation }));
        byId('colormap').addEventListener('change', (event) => session.setParams({ colormap: event.target.value }));
        byId('look').addEventListener('change', (event) => session.setParams({ look: event.target.value }));
        byId('ramp').addEventListener('change', (event) => session.setParams({ ramp_interval: Number(event.target.value) }));
        session.on('welcome', () => this.welcome());
        session.on('params', () => this.show());
        this.foldDisplay();
    }

    foldDisplay() {
        const button = byId('display-toggle'), panel = byId('display');
        const set = (open) => {
            panel.classList.toggle('open', open);
            button.setAttribute('aria-expanded', open);
        };
        this.closeDisplay = () => set(false);
        button.addEventListener('click', () => set(!panel.classList.contains('open')));
        document.addEventListener('pointerdown', (event) => {
            if (!event.target.closest('#display, #display-toggle'))
                set(false);
        });
    }

    welcome() {
        const { model } = this.session;
        setText(byId('plant-name'), model.plant.name);
        document.title = `${model.plant.name} – Plantcast`;
        const choices = model.groups.map((group, i) => {
            const name = title(group.quantity || group.id);
            return [group.id, name, `${name} (${i + 1})`];
        });
        fillSegments(byId('groups'), 'group', choices, (group) => this.session.setParams({ group }));
    }

    chooseGroup(index) {
        const group = this.session.model?.groups[index];
        if (group && group.id !== this.session.params.group)
            this.session.setParams({ group: group.id });
    }

    show() {
        const { model, params } = this.session;
        if (!model)
            return;
        mark(byId('groups'), params.group);
        mark(byId('distance'), params.distance);
        mark(byId('interpolation'), params.interpolation);
        fillSelect(byId('colormap'), model.colormaps.map((map) => [map.name, title(map.name)]), params.colormap);
        fillSelect(byId('look'), LOOKS, params.look);
        fillSelect(byId('ramp'), this.ramps(), params.ramp_interval ?? 0);
    }

    ramps() {
        const { group, range, params } = this.session;
        const steps = new Set(rampChoices(...range));
        if (params.ramp_interval > 0)
            steps.add(params.ramp_interval);
        const text = (step) => `${numberText(step, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)))} ${unitText(group?.unit)}`;
        return [[0, 'Smooth'], ...[...steps].sort((a, b) => a - b).map((step) => [step, text(step)])];
    }
}
