// SPDX-License-Identifier: GPL-3.0-or-later
// The toolbar: shows the parameters of the view, and asks the server to change them.
import { numberText, unitText } from '../../core/format.js';
import { multiples, rampChoices } from '../../core/legend.js';
import { quantityText } from '../../core/model.js';
import { say, title } from '../../core/words.js';
import { byId, setText } from '../common/dom.js';
import { fillSegments, fillSelect, markSegment } from '../common/choices.js';

const choices = (kind, ...values) => values.map((value) => [value, say(`${kind}.${value}`)]);
export const SHOWS = choices('show', 'value', 'operator', 'distance', 'difference');
export const LOOKS = choices('look', 'default', 'glossy', 'flat', 'materials');

const stepDecimals = (step) => Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));

// Returns the colour band sets that the sensor group defines: boundaries of the bands by the set's name.
export function bandsOf({ group }) {
    const limits = Object.values(group?.limits ?? {}).filter((limit) => limit !== null).sort((a, b) => a - b);
    return { group: group?.breaks ?? [], limits };
}

export class Toolbar {
    // does(name): runs a command (commands.js).
    constructor({ session, does }) {
        this.session = session;
        byId('colormap').addEventListener('change', (event) => session.setParams({ colormap: event.target.value }));
        byId('look').addEventListener('change', (event) => session.setParams({ look: event.target.value }));
        byId('ramp').addEventListener('change', ({ target }) => does('ramp')(target.value));
        byId('isolines').addEventListener('change', ({ target }) => session.setParams({ isolines: JSON.parse(target.value) }));
        byId('show').addEventListener('change', ({ target }) => does('show')(target.value));
        session.on('welcome', () => this.welcome());
        session.on('params', () => this.show());
    }

    welcome() {
        const { model } = this.session;
        setText(byId('plant-name'), model.plant.name);
        document.title = `${model.plant.name} – Plantcast`;
        const choices = model.groups.map((group, i) => {
            const name = quantityText(group);
            return [group.id, name, `${name} (${i + 1})`];
        });
        fillSegments(byId('groups'), 'group', choices, (group) => this.session.setParams({ group }));
    }

    show() {
        const { model, params } = this.session;
        if (!model)
            return;
        markSegment(byId('groups'), params.group);
        fillSelect(byId('colormap'), model.colormaps.map((map) => [map.name, title(map.name)]), params.colormap);
        fillSelect(byId('look'), LOOKS, params.look);
        fillSelect(byId('ramp'), this.ramps(), params.breaks?.length > 0 ? this.breaksName() : params.ramp_interval ?? 0);
        fillSelect(byId('isolines'), this.isolines(), JSON.stringify(params.isolines ?? null));
        fillSelect(byId('show'), SHOWS, params.show ?? 'value');
    }

    // Returns the name of the colour band set in use; 'chosen' if the user has chosen other boundaries.
    breaksName() {
        const { params } = this.session;
        const same = ([, breaks]) => JSON.stringify(params.breaks) === JSON.stringify(breaks);
        return Object.entries(bandsOf(this.session)).find(same)?.[0] ?? 'chosen';
    }

    isolines() {
        const { group, range, params } = this.session;
        const every = (step) => multiples(...range, step);
        const text = (step) => say('lines.every', { step: `${numberText(step, stepDecimals(step))} ${unitText(group?.unit)}` });
        const choices = [['null', say('lines.none')], ...rampChoices(...range).map((step) => [JSON.stringify(every(step)), text(step)])];
        const now = JSON.stringify(params.isolines ?? null);
        return choices.some(([value]) => value === now) ? choices : [...choices, [now, say('lines.chosen')]];
    }

    ramps() {
        const { group, range, params } = this.session;
        const steps = new Set(rampChoices(...range));
        if (params.ramp_interval > 0)
            steps.add(params.ramp_interval);
        const text = (step) => `${numberText(step, stepDecimals(step))} ${unitText(group?.unit)}`;
        const own = bandsOf(this.session);
        const bands = choices('ramp', 'group', 'limits').filter(([name]) => own[name].length > 0);
        if (params.breaks?.length > 0 && this.breaksName() === 'chosen')
            bands.push(['chosen', say('ramp.chosen')]);
        return [[0, say('ramp.smooth')], ...bands, ...[...steps].sort((a, b) => a - b).map((step) => [step, text(step)])];
    }
}
