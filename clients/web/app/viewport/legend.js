// SPDX-License-Identifier: GPL-3.0-or-later
// The legend of the picture: the server's colours with units, limits, and the patterns for missing data.
import { decimalsFor, shortNumberText, unitText } from '../../core/format.js';
import { colourOf, edges, LIMIT_BANDS, placeOf, scaleTicks, spread, valueAt } from '../../core/legend.js';
import { quantityText } from '../../core/model.js';
import { hatchAt, patternPeriodPx, ruleAt, stippleAt } from '../../core/patterns.js';
import { say } from '../../core/words.js';
import { make, makeSvg, phone, setVariable } from '../common/dom.js';
import { onPixelRatio } from './pixel_ratio.js';

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

// Draws the legend's sample of the marker that the overlay draws for a tag whose sensor has not passed a loop check: a circle
// with a dashed outline.
const brokenMark = (c, width, height) => {
    const radius = 0.38 * height;
    c.beginPath();
    c.arc(width / 2, height / 2, radius, 0, 2 * Math.PI);
    c.fillStyle = '#fff';
    c.fill();
    c.lineWidth = 0.11 * height;
    c.strokeStyle = '#1d252d';
    c.setLineDash([(2 * Math.PI * radius) / 12]);
    c.stroke();
};

// Draws the legend's sample of the marker that the overlay draws for a tag with an assumed position (chosen on its equipment by
// `plantcast match`): two rings.
const doubleMark = (c, width, height) => {
    for (const [radius, line] of [[0.26, 0.11], [0.45, 0.07]]) {
        c.beginPath();
        c.arc(width / 2, height / 2, radius * height, 0, 2 * Math.PI);
        c.lineWidth = line * height;
        c.strokeStyle = '#1d252d';
        c.stroke();
    }
};

const pixels = (colourAt) => (c, width, height) => {
    const image = c.createImageData(width, height);
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++)
            image.data.set([...colourAt(x, y, height), 255], 4 * (y * width + x));
    }
    c.putImageData(image, 0, 0);
};

function at(element, place) {
    setVariable(element, '--at', `${100 * place}%`);
    return element;
}

// Legend texts by the value of the parameter `show`: functions of the quantity's name and the view's parameters that return
// [title, suffix, note]. coverage.js has those for rarely used values.
export const TITLES = { distance: (name, { sensor }) => [say('legend.distance', { tag: sensor ?? '–' })] };
// Lowest value of a picture, as a fraction of the group's range, by the value of the parameter `show`. Pictures with such a value
// do not depend on readings. Places in them are uncertain only if they are interpolated from distances along surfaces. The
// smallest hot spot that a sensor would show (`blind`) is 5 % of the range directly at a sensor; a margin for rounding is added.
const LEAST = { distance: 0, uncertainty: 0, blind: 0.05005 };
// Returns true if a picture with these parameters can have uncertain places.
const uncertainIn = ({ show, distance }) => !(show in LEAST) || (show !== 'uncertainty' && distance !== 'euclidean');
const LIMIT_PLACES = { LL: -2, L: -1, H: 1, HH: 2 };

// Returns the legend's [title, suffix, note] for the shown group and the parameter `show`.
export function titleOf({ model }, params) {
    const name = quantityText(model.group(params.group));
    const sign = { difference: 'Δ ', uncertainty: '± ', blind: '? ' }[params.show] ?? ''; // used until coverage.js is loaded
    return TITLES[params.show]?.(name, params) ?? [sign + name];
}

export class Legend {
    // paramsOf: returns the picture parameters of the half of a split view (or the whole view) that this legend explains, or
    // null if the legend stays empty. half: 1 for the right half, else 0.
    constructor({ session, element, paramsOf, half = 0, lying = phone }) {
        Object.assign(this, { session, element, paramsOf, half, lying });
        this.lying.addEventListener('change', () => this.show(true));
        // key of the contents that the legend shows, and their model; a welcome replaces the model, with other limits, units or colours
        Object.assign(this, { shown: '', drawnModel: null });
        this.long = 240; // length of the legend's colour bar in CSS pixels
        new ResizeObserver(() => this.fit()).observe(element);
        for (const name of ['params', 'shown', 'proofs'])
            session.on(name, () => this.show());
        onPixelRatio(() => this.show(true));
    }

    // Redraws the legend if its bar's length has changed, because the labels keep their distance in pixels.
    fit() {
        const bar = this.element.querySelector('.bar'), long = this.lying.matches ? bar?.clientWidth : bar?.clientHeight;
        if (!long || long === this.long)
            return;
        this.long = long;
        this.show(true);
    }

    apart(places, uprightPx, lyingPx) {
        const gap = (this.lying.matches ? lyingPx : uprightPx) / this.long;
        return spread(places, Math.min(gap, 1 / Math.max(1, places.length - 1)));
    }

    // Returns a key made of everything that affects the legend's look. The legend is redrawn only if the key changes.
    contents(params, half = this.half) {
        const { group, show, colormap, ramp_interval, scale, breaks, isolines, look, unit } = params;
        return JSON.stringify([group, show, this.title(params), colormap, ramp_interval, this.session.rangeOf(params), scale,
            breaks, isolines, look, unit, uncertainIn(params), this.unproven(params), this.assumed(params),
            this.session.drawnErrors[half]]);
    }

    show(again = false) {
        const { model } = this.session, params = model && this.paramsOf(this.session.shown);
        const group = params && model.group(params.group);
        // hides the legend if the picture shows no values interpolated between sensors, or only the materials of the model
        this.element.hidden = !group || params.look === 'materials';
        if (!group)
            return;
        const range = this.session.rangeOf(params);
        const { show, colormap, ramp_interval, scale, breaks, isolines, look } = params, wanted = this.contents(params);
        if (wanted === this.shown && model === this.drawnModel && !again)
            return;
        Object.assign(this, { shown: wanted, drawnModel: model });
        const map = model.colormap(colormap);
        const rule = { map, min: range[0], max: range[1], log: scale === 'log', interval: ramp_interval ?? 0, breaks };
        const isOperator = show === 'operator';
        this.element.replaceChildren(this.heading(params),
            isOperator ? this.limitScale()
                : this.scale(rule, isolines ?? [], show === 'value' ? group.limits : {},
                    !(range[0] <= LEAST[show] * (group.max - group.min))),
            this.keys(params, isOperator ? LIMIT_BANDS[2].colour : colourOf(rule, valueAt(rule, 0.5))));
        for (const note of this.notes(params, map, isOperator))
            this.element.append(make('p', { class: 'note' }, note));
    }

    title(params) {
        return titleOf(this.session, params);
    }

    notes(params, map, isOperator) {
        const { look, scale } = params, off = this.session.drawnErrors[this.half];
        return [
            // largest possible error of the interpolated values where the picture marks them as uncertain; left out in the
            // operator's view (values relative to alarm limits), which has no unit
            off && !isOperator && say('legend.drawn', { off: `${off}\u00a0${this.unit(params)}` }),
            this.title(params)[2],
            isOperator && say('legend.operator'),
            !isOperator && scale === 'log' && say('legend.log'),
            !isOperator && map.safe === false && say('legend.unsafe'),
            look === 'glossy' && say('legend.glossy'),
        ].filter(Boolean);
    }

    unit({ group, unit }) {
        return unitText(unit ?? this.session.model.group(group).unit);
    }

    heading(params) {
        const [text, since] = this.title(params);
        return make('h2', {}, text, ' ', make('span', {}, params.show === 'operator' ? '' : this.unit(params)),
            since && make('span', { class: 'since' }, ` ${since}`));
    }

    // Makes the scale of values. below: true if values below the range are possible.
    scale(rule, lines, limits, below) {
        const { map, min, max } = rule;
        const decimals = (value) => decimalsFor(rule.log ? value : max - min);
        const text = (value) => shortNumberText(value, decimals(value));
        const end = (name, colour, words) => [
            make('div', { class: `end ${name}` }, swatch(18, 14, solid(colour))), make('div', { class: 'end-text' }, words),
        ];
        return make('div', { class: 'scale' },
            ...end('above', map.above, `> ${text(max)}`),
            this.limits(rule, limits ?? {}, text), this.bar(rule, lines, (place) => colourOf(rule, valueAt(rule, place))),
            this.ticks(rule, lines, text),
            ...(below ? end('below', map.below, `< ${text(min)}`) : []));
    }

    // Makes the scale of the operator's view, which shows where a value is relative to its alarm limits instead of the value:
    // -2, -1, 1 and 2 are the limits LL, L, H and HH; the scale ends at -3 and 3.
    limitScale() {
        const place = (value) => (value + 3) / 6, band = (p) => LIMIT_BANDS.find(({ to }) => p * 6 - 3 < to) ?? LIMIT_BANDS[4];
        const names = Object.keys(LIMIT_PLACES), places = Object.values(LIMIT_PLACES).map(place);
        return make('div', { class: 'scale' }, make('div', { class: 'limits' }),
            this.bar({ min: -3, max: 3 }, Object.values(LIMIT_PLACES), (p) => band(p).colour), this.ticksAt(places, places, names));
    }

    // Draws the legend's bar at a higher resolution than the screen's, with a line at the value of each isoline.
    bar(rule, lines, colourAt) {
        const canvas = make('canvas', { class: 'bar', role: 'img', 'aria-label': say('legend.colours', { min: rule.min, max: rule.max }) });
        const lying = this.lying.matches;
        canvas.width = lying ? BAR_TEXELS : 1;
        canvas.height = lying ? 1 : BAR_TEXELS;
        const c = canvas.getContext('2d');
        const fill = (i, texels) => c.fillRect(lying ? i : 0, lying ? 0 : BAR_TEXELS - i - texels, lying ? texels : 1, lying ? 1 : texels);
        for (let i = 0; i < BAR_TEXELS; i++) {
            c.fillStyle = css(colourAt((i + 0.5) / BAR_TEXELS));
            fill(i, 1);
        }
        c.fillStyle = '#1d252d';
        for (const value of [...edges(rule), ...lines])
            fill(Math.round(placeOf(rule, value) * BAR_TEXELS) - 2, 4);
        return canvas;
    }

    ticks(rule, lines, text) {
        const values = scaleTicks(rule, lines, Math.min(9, Math.floor(this.long / (this.lying.matches ? 32 : 16)) + 1));
        const places = values.map((value) => placeOf(rule, value));
        return this.ticksAt(places, this.apart(places, 15, 32), values.map(text));
    }

    // Writes numbers next to the bar. A line connects a number that had to move to its position on the bar.
    ticksAt(from, to, texts) {
        const lying = this.lying.matches, line = (a, b) => (lying ? { x1: 100 * a, y1: 0, x2: 100 * b, y2: 1 }
            : { x1: 0, y1: 100 - 100 * a, x2: 1, y2: 100 - 100 * b });
        const lines = from.map((place, i) => makeSvg('line', line(place, to[i])));
        const viewBox = lying ? '0 0 100 1' : '0 0 1 100';
        const svg = makeSvg('svg', { viewBox, preserveAspectRatio: 'none', 'aria-hidden': 'true' }, ...lines);
        return make('div', { class: 'ticks' }, svg, ...texts.map((text, i) => at(make('span', {}, text), to[i])));
    }

    // Draws a line at each alarm limit, with the limit's name next to it.
    limits(rule, limits, text) {
        const { min, max } = rule;
        const inside = Object.entries(limits).filter(([, value]) => value !== null && value >= min && value <= max);
        inside.sort((a, b) => a[1] - b[1]);
        // otherwise the names would overlap
        const isTight = (inside.length - 1) * (this.lying.matches ? 27 : 15) > this.long;
        const names = isTight ? [0, inside.length - 1] : [...inside.keys()];
        const places = this.apart(inside.map(([, value]) => placeOf(rule, value)), 15, 27);
        return make('div', { class: 'limits' }, ...inside.flatMap(([name, value], i) => [
            at(make('i', {}), placeOf(rule, value)),
            names.includes(i) ? at(make('span', { title: `${name} ${text(value)}` }, name), places[i]) : null,
        ]));
    }

    unproven({ group }) {
        const { model } = this.session;
        return model.tags.some((tag) => tag.group === group && tag.position && model.unproven(tag));
    }

    assumed({ group }) {
        return this.session.model.tags.some((tag) => tag.group === group && tag.position && tag.place === 'equipment');
    }

    // Draws small samples of the patterns (no data, uncertain), fine enough to be recognised.
    keys(params, colour) {
        const { show } = params;
        const period = (height) => Math.min(height / 2, patternPeriodPx(this.session.size.height));
        const noData = pixels((x, y, height) => hatchAt(x, y, height, period(height)));
        const uncertain = pixels((x, y, height) => stippleAt(x, y, height, period(height), colour));
        const noLimits = pixels((x, y, height) => ruleAt(y, height, period(height)));
        return make('div', { class: 'keys' },
            ...(show === 'operator' ? [swatch(18, 14, noLimits), make('span', {}, say('legend.nolimits'))] : []),
            swatch(18, 14, noData), make('span', {}, say('legend.nodata')),
            ...(uncertainIn(params) ? [swatch(18, 14, uncertain), make('span', {}, say('legend.uncertain'))] : []),
            ...(this.unproven(params) ? [swatch(18, 14, brokenMark), make('span', {}, say('proof.none'))] : []),
            ...(this.assumed(params) ? [swatch(18, 14, doubleMark), make('span', {}, say('proof.assumed'))] : []));
    }
}
