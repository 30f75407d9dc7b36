// SPDX-License-Identifier: GPL-3.0-or-later
// The panel of picture settings: baseline (saved readings with which the present ones are compared), colour scale and range,
// and light.
import { dayTime, zoneClock } from '../../core/format.js';
import { sunOf, sunText, towardsSun } from '../../core/sun.js';
import { say, sayIfKnown, title } from '../../core/words.js';
import { sensorsOf } from '../input/commands.js';
import { byId, setText } from '../common/dom.js';
import { Range } from '../common/number_fields.js';
import { fillSegments, fillSelect, markSegment } from '../common/choices.js';
import { collapsiblePanel } from '../common/collapsible.js';
import { Directions } from './directions.js';
import { Disagreeing } from '../cards/neighbours.js';

export class Picture {
    constructor({ session, selection, modules, selectTag }) {
        Object.assign(this, { session, selection });
        this.panel = byId('picture-panel');
        Object.assign(this, collapsiblePanel(this.panel, byId('picture-toggle'), () => this.update()));
        const scales = ['linear', 'log'].map((scale) => [scale, say(`scale.${scale}`)]);
        fillSegments(byId('scale'), 'scale', scales, (scale) => session.setParams({ scale }));
        byId('environment').addEventListener('change', ({ target }) => session.setParams({ environment: target.value }));
        byId('sensor').addEventListener('change', ({ target }) => session.setParams({ show: 'distance', sensor: target.value }));
        byId('baseline').addEventListener('change', ({ target }) => session.setParams({ show: 'difference', baseline: target.value }));
        byId('baseline-now').addEventListener('click', () => session.setParams({ show: 'difference', baseline: 'now' }));
        byId('baseline-keep').addEventListener('click', () => this.keep());
        byId('baseline-name').addEventListener('keydown', (event) => event.key === 'Enter' && this.keep());
        for (const id of ['sun-turn', 'sun-height'])
            byId(id).addEventListener('input', () => this.moveSun());
        this.range = new Range(this);
        modules.use('coverage', (coverage) => coverage.fill());
        this.disagreeing = new Disagreeing({ session, selectTag });
        this.directions = new Directions({ session });
        byId('light').before(this.directions.element, this.disagreeing.element);
        session.on('params', () => this.update());
        session.on('welcome', () => this.update());
    }

    close() {
        this.set(false);
    }

    keep() {
        const name = byId('baseline-name').value.trim();
        if (name)
            this.session.setParams({ show: 'difference', baseline: { set: name } });
        byId('baseline-name').value = '';
    }

    // --- light

    get isYUp() {
        const { up } = this.session.model.plant;
        return up[1] > up[2];
    }

    // Moves the light at most once per animation frame, because sliders fire more often.
    moveSun() {
        const sun = { turn: Number(byId('sun-turn').value), height: Number(byId('sun-height').value) };
        setText(byId('sun-text'), say('picture.light', { where: sunText(sun) }));
        if (!this.sun)
            requestAnimationFrame(() => {
                this.session.setParams({ light: towardsSun(this.sun, this.isYUp) });
                this.sun = null;
            });
        this.sun = sun;
    }

    updateLight({ model, params }) {
        const places = model.environments.map((name) => [name, sayIfKnown(`environment.${name}`, title(name))]);
        fillSelect(byId('environment'), places, params.environment);
        if (this.sun || !params.light)
            return;
        const sun = sunOf(params.light, this.isYUp);
        byId('sun-turn').value = sun.turn;
        byId('sun-height').value = sun.height;
        setText(byId('sun-text'), say('picture.light', { where: sunText(sun) }));
    }

    update() {
        const { model, params } = this.session;
        if (!model || !this.panel.classList.contains('open'))
            return;
        this.disagreeing.update();
        this.directions.update();
        byId('from-sensor').hidden = params.show !== 'distance';
        fillSelect(byId('sensor'), sensorsOf(this.session).map(({ name, asset }) => [name, `${name}, ${asset}`]), params.sensor ?? '');
        byId('from-baseline').hidden = params.show !== 'difference';
        const kept = (params.baselines ?? []).map(({ name }) => [name, name]), now = params.baseline?.name ?? '';
        fillSelect(byId('baseline'), now ? kept : [['', this.instantText(params.baseline)], ...kept], now);
        byId('scale').disabled = !(this.session.range[0] > 0) || params.show === 'operator';
        markSegment(byId('scale'), params.scale ?? 'linear');
        this.updateLight(this.session);
        this.range.update();
    }

    instantText(baseline) {
        if (!baseline?.time_us)
            return '–';
        return dayTime(zoneClock(this.session.model.plant.time_zone), baseline.time_us / 1000);
    }
}
