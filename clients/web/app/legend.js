// SPDX-License-Identifier: GPL-3.0-or-later
// The legend: the colours as the server uses them, with units, limits, and the patterns for what is not known.
import { decimalsFor, numberText, unitText } from '../core/format.js';
import { colourOf, ticks } from '../core/legend.js';
import { drawHatch, drawStipple } from './patterns.js';
import { byId, make } from './dom.js';

const css = ([r, g, b]) => `rgb(${r} ${g} ${b})`;

function swatch(width, height, draw) {
    const canvas = make('canvas', {});
    const ratio = window.devicePixelRatio;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    draw(canvas.getContext('2d'), canvas.width, canvas.height, ratio);
    return canvas;
}

const solid = (colour) => (c, width, height) => {
    c.fillStyle = css(colour);
    c.fillRect(0, 0, width, height);
};

export class Legend {
    constructor({ session }) {
        this.session = session;
        this.element = byId('legend');
        this.shown = '';
        session.on('params', () => this.show());
        window.matchMedia(`(resolution: ${window.devicePixelRatio}dppx)`).addEventListener('change', () => this.show(true));
    }

    show(again = false) {
        const { model, params, range, group } = this.session;
        if (!model || !group)
            return;
        const wanted = JSON.stringify([params.group, params.colormap, params.ramp_interval, range, params.look]);
        if (wanted === this.shown && !again)
            return;
        this.shown = wanted;
        this.element.hidden = false;
        const map = model.colormap(params.colormap);
        this.element.replaceChildren(this.heading(group), this.scale(map, range, group), this.keys(map));
        if (params.look === 'glossy')
            this.element.append(make('p', { class: 'note' }, 'Glossy look: light changes the colours. Do not read values.'));
    }

    heading(group) {
        const name = group.quantity || group.id;
        return make('h2', {}, name.charAt(0).toUpperCase() + name.slice(1), ' ', make('span', {}, unitText(group.unit)));
    }

    scale(map, [min, max], group) {
        const decimals = decimalsFor(max - min);
        const text = (value) => numberText(value, decimals).replace(/\.0+$/, '');
        const end = (colour, words) => [
            make('div', { class: 'end' }, swatch(18, 14, solid(colour))), make('div', { class: 'end-text' }, words),
        ];
        const gap = () => make('div', { class: 'gap' });
        return make('div', { class: 'scale' },
            ...end(map.above, `> ${text(max)}`), gap(),
            make('div', { class: 'bar-box' }, this.bar(map, min, max)), this.ticks(min, max, group, text), gap(),
            ...end(map.below, `< ${text(min)}`));
    }

    // One row of canvas per device pixel would blur; 1024 rows are finer than any screen shows here.
    bar(map, min, max) {
        const canvas = make('canvas', { role: 'img', 'aria-label': `Colours from ${min} to ${max}` });
        canvas.width = 1;
        canvas.height = 1024;
        const c = canvas.getContext('2d');
        for (let y = 0; y < 1024; y++) {
            c.fillStyle = css(colourOf(map, max - ((y + 0.5) / 1024) * (max - min), min, max, this.session.params.ramp_interval));
            c.fillRect(0, y, 1, 1);
        }
        return canvas;
    }

    ticks(min, max, group, text) {
        const box = make('div', { class: 'ticks' });
        const place = (element, value) => {
            element.style.top = `${(100 * (max - value)) / (max - min)}%`;
            box.append(element);
        };
        for (const value of ticks(min, max))
            place(make('span', {}, text(value)), value);
        for (const [name, value] of Object.entries(group.limits ?? {})) {
            if (value !== null && value >= min && value <= max)
                place(make('span', { class: 'limit', title: `${name} ${text(value)}` }, `◂${name}`), value);
        }
        return box;
    }

    keys(map) {
        const colour = css(colourOf(map, 0.5, 0, 1));
        return make('div', { class: 'keys' },
            swatch(18, 14, drawHatch), make('span', {}, 'No data'),
            swatch(18, 14, (c, width, height, ratio) => drawStipple(c, width, height, ratio, colour)), make('span', {}, 'Uncertain'));
    }
}
