// SPDX-License-Identifier: GPL-3.0-or-later
// The legend: the colours as the server uses them, with units, limits, and the patterns for what is not known.
import { decimalsFor, numberText, unitText } from '../core/format.js';
import { colourOf, spread, ticks } from '../core/legend.js';
import { hatchAt, patternPeriodPx, stippleAt } from '../core/patterns.js';
import { byId, make, setVariable } from './dom.js';

const BAR_TEXELS = 1024;
const css = ([r, g, b]) => `rgb(${r} ${g} ${b})`;

function swatch(width, height, draw) {
    const canvas = make('canvas', {});
    const ratio = window.devicePixelRatio;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    draw(canvas.getContext('2d'), canvas.width, canvas.height);
    return canvas;
}

const solid = (colour) => (c, width, height) => {
    c.fillStyle = css(colour);
    c.fillRect(0, 0, width, height);
};

const pixels = (colourAt) => (c, width, height) => {
    const image = c.createImageData(width, height);
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++)
            image.data.set([...colourAt(x, y, height), 255], 4 * (y * width + x));
    }
    c.putImageData(image, 0, 0);
};

function at(element, value, min, max) {
    setVariable(element, '--at', `${(100 * (value - min)) / (max - min)}%`);
    return element;
}

export class Legend {
    constructor({ session }) {
        this.session = session;
        this.lying = window.matchMedia('(max-width: 719px)');
        this.lying.addEventListener('change', () => this.show(true));
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
        const end = (name, colour, words) => [
            make('div', { class: `end ${name}` }, swatch(18, 14, solid(colour))), make('div', { class: 'end-text' }, words),
        ];
        return make('div', { class: 'scale' },
            ...end('above', map.above, `> ${text(max)}`),
            this.limits(min, max, group, text), this.bar(map, min, max), this.ticks(min, max, text),
            ...end('below', map.below, `< ${text(min)}`));
    }

    // A texture along the bar, finer than any screen shows it.
    bar(map, min, max) {
        const canvas = make('canvas', { class: 'bar', role: 'img', 'aria-label': `Colours from ${min} to ${max}` });
        const lying = this.lying.matches;
        canvas.width = lying ? BAR_TEXELS : 1;
        canvas.height = lying ? 1 : BAR_TEXELS;
        const c = canvas.getContext('2d');
        for (let i = 0; i < BAR_TEXELS; i++) {
            c.fillStyle = css(colourOf(map, min + ((i + 0.5) / BAR_TEXELS) * (max - min), min, max, this.session.params.ramp_interval));
            c.fillRect(lying ? i : 0, lying ? 0 : BAR_TEXELS - 1 - i, 1, 1);
        }
        return canvas;
    }

    ticks(min, max, text) {
        return make('div', { class: 'ticks' }, ...ticks(min, max).map((value) => at(make('span', {}, text(value)), value, min, max)));
    }

    // A line at the limit itself, its name beside it.
    limits(min, max, group, text) {
        const inside = Object.entries(group.limits ?? {}).filter(([, value]) => value !== null && value >= min && value <= max);
        inside.sort((a, b) => a[1] - b[1]);
        const places = spread(inside.map(([, value]) => (value - min) / (max - min)), this.lying.matches ? 0.085 : 0.06);
        return make('div', { class: 'limits' }, ...inside.flatMap(([name, value], i) => [
            at(make('i', {}), value, min, max), at(make('span', { title: `${name} ${text(value)}` }, name), places[i], 0, 1),
        ]));
    }

    // In small, the pattern is drawn no coarser than can be recognised.
    keys(map) {
        const colour = colourOf(map, 0.5, 0, 1);
        const period = (height) => Math.min(height / 2, patternPeriodPx(this.session.size.height));
        const noData = pixels((x, y, height) => hatchAt(x, y, height, period(height)));
        const uncertain = pixels((x, y, height) => stippleAt(x, y, height, period(height), colour));
        return make('div', { class: 'keys' },
            swatch(18, 14, noData), make('span', {}, 'No data'), swatch(18, 14, uncertain), make('span', {}, 'Uncertain'));
    }
}
