// SPDX-License-Identifier: GPL-3.0-or-later
// Boards: canvases that the headset shows in the room, with the legend and the age of the data, warnings, the panel at the wrist, cards and
// markers.
import { ALARM_COLOURS, isGone } from '../../core/alarms.js';
import { RADIANS } from '../../core/camera.js';
import { ageText, decimalsFor, shortNumberText, unitText, valueText, zoneClock } from '../../core/format.js';
import { behindText, simulatedText } from '../../core/health.js';
import { colourOf, edges, LIMIT_BANDS, placeOf, scaleTicks, valueAt } from '../../core/legend.js';
import { quantityText } from '../../core/model.js';
import { hatchAt, stippleAt } from '../../core/patterns.js';
import { statusText } from '../../core/quality.js';
import { travel } from '../../core/requests.js';
import { say } from '../../core/words.js';
import { make } from '../common/dom.js';
import { titleOf } from '../viewport/legend.js';

const PX_PER_DEGREE = 24; // resolution, in pixels per degree of view, of canvases whose apparent size in the headset is fixed
const LETTER_PX = 52; // font size; a capital letter is 0.72 of this high, which is 1.56 degrees at PX_PER_DEGREE
const PATTERN_PX = 18, LINE = 1.24, FAMILY = 'system-ui, sans-serif', INK = '#1d252d', PAPER = 'rgb(250 250 250 / 94%)', ALERT = '#7a0019';
const WRIST_PX = 4600; // pixels per metre of the panel at the wrist
const css = ([r, g, b]) => `rgb(${r} ${g} ${b})`;

// A rectangle with text or symbols that the headset shows in the room: a canvas and its WebGL texture. The canvas is drawn again only if
// `key` changes.
export class Board {
    constructor(painter, width, height) {
        this.painter = painter;
        this.canvas = make('canvas', { width, height });
        this.texture = null;
        this.key = null;
    }

    show(key, draw) {
        const { canvas, painter } = this;
        if (key === this.key)
            return this;
        this.key = key;
        const c = canvas.getContext('2d');
        c.reset();
        draw(c, canvas.width, canvas.height);
        this.texture = painter.upload(this.texture, canvas);
        return this;
    }

    // Returns the canvas as a texture, with the width and height in metres that its rectangle needs at this distance from the
    // eye to have its fixed apparent size (PX_PER_DEGREE).
    seenFrom(metres) {
        const perPx = 2 * metres * Math.tan(0.5 * RADIANS) / PX_PER_DEGREE;
        return { texture: this.texture, width: this.canvas.width * perPx, height: this.canvas.height * perPx };
    }

    get atWrist() {
        return { texture: this.texture, width: this.canvas.width / WRIST_PX, height: this.canvas.height / WRIST_PX };
    }
}

function paper(c, width, height, fill = PAPER) {
    c.fillStyle = fill;
    c.beginPath();
    c.roundRect(0, 0, width, height, 20);
    c.fill();
    c.fillStyle = fill === PAPER ? INK : '#fff';
}

function write(c, text, x, y, most, { size = LETTER_PX, weight = 400, align = 'left' } = {}) {
    c.font = `${weight} ${size}px ${FAMILY}`;
    c.textAlign = align;
    c.textBaseline = 'middle';
    c.fillText(text, x, y, most);
}

// Breaks a text into lines at most `most` pixels wide in the context's font.
function linesOf(c, text, most) {
    const lines = [''];
    for (const word of text.split(' ')) {
        const longer = `${lines.at(-1)} ${word}`.trim();
        if (c.measureText(longer).width <= most || lines.at(-1) === '')
            lines[lines.length - 1] = longer;
        else
            lines.push(word);
    }
    return lines;
}

// Returns the legend's scale: colourAt(place) (colour of the bar), `ends` (colours below and above the range), `labels` [[place, text],
// ...] and `lines` (places of band edges and isolines). A place is a fraction, 0 to 1, of the bar's length.
function scaleOf(session, params) {
    const { model } = session, group = model.group(params.group), [min, max] = session.rangeOf(params);
    if (params.show === 'operator')
        return { colourAt: (p) => LIMIT_BANDS.find(({ to }) => p * 6 - 3 < to)?.colour ?? LIMIT_BANDS.at(-1).colour,
            labels: ['LL', 'L', 'H', 'HH'].map((name, i) => [[1, 2, 4, 5][i] / 6, name]), lines: [], group };
    const { colormap, ramp_interval: interval, scale, breaks, isolines } = params, map = model.colormap(colormap);
    const rule = { map, min, max, log: scale === 'log', interval: interval ?? 0, breaks };
    const text = (value) => shortNumberText(value, decimalsFor(rule.log ? value : max - min));
    return { colourAt: (p) => colourOf(rule, valueAt(rule, p)), ends: [map.below, map.above], group,
        labels: scaleTicks(rule, isolines ?? [], 5).map((value) => [placeOf(rule, value), text(value)]),
        lines: [...edges(rule), ...isolines ?? []].map((value) => placeOf(rule, value)) };
}

function swatch(c, x, y, width, height, colourAt) {
    const image = c.createImageData(width, height);
    for (let row = 0; row < height; row++)
        for (let column = 0; column < width; column++)
            image.data.set([...colourAt(column, row), 255], 4 * (row * width + column));
    c.putImageData(image, x, y);
}

function bar(c, x, y, width, height, { colourAt, ends, labels, lines }) {
    for (let i = 0; i < width; i++) {
        c.fillStyle = css(colourAt((i + 0.5) / width));
        c.fillRect(x + i, y, 1, height);
    }
    ends?.forEach((colour, i) => {
        c.fillStyle = css(colour);
        c.fillRect(i ? x + width + 6 : x - 36, y, 30, height);
    });
    c.fillStyle = INK;
    for (const place of lines)
        c.fillRect(x + place * width - 1, y, 2, height);
    labels.forEach(([place, text], i) => write(c, text, x + place * width, y + height + 34, 200,
        { align: i === 0 && place === 0 ? 'left' : place === 1 ? 'right' : 'center' }));
}

// Draws the legend, the age of the data and the state of the connection on a canvas in the headset's view. state: health() of the session;
// warning: [words, detail, isGrave] of a warning across the view, or null.
export function showLegend(board, session, state, warning, now) {
    const params = session.shown, { model, picture } = session, group = model.group(params.group);
    const hasField = group && params.look !== 'materials', past = state.kind === 'past';
    const title = hasField ? `${titleOf(session, params)[0]} ${params.show === 'operator' ? '' : unitText(params.unit ?? group.unit)}` : '';
    const age = model.oldestAgeMs(params.group, now), clock = zoneClock(model.plant.time_zone);
    const at = past ? clock((picture?.past ? picture.dataTimeUs : session.time.atUs) / 1000) : null;
    const data = at ? `${at.date} ${at.time}` : `${say('status.oldest')}: ${age === null ? say('none') : ageText(age)}`;
    const late = warning?.[2] === true ? warning[0] : behindText(session.latency, now);
    const note = late || simulatedText(session) || state.words, isGood = !late && ['live', 'simulated'].includes(state.kind);
    const key = JSON.stringify([title, data, note, params.colormap, params.ramp_interval, params.breaks, params.isolines, params.scale,
        session.rangeOf(params), params.show, hasField]);
    if (board.model !== model) // a welcome has replaced the model: colours and units may differ
        Object.assign(board, { model, key: null });
    return board.show(key, (c, width, height) => {
        paper(c, width, height);
        write(c, title, 24, 46, 560, { weight: 600 });
        c.fillStyle = isGood ? INK : ALERT;
        write(c, note, width - 24, 46, width - 640, { align: 'right', weight: isGood ? 400 : 700 });
        c.fillStyle = INK;
        if (hasField) {
            const scale = scaleOf(session, params), middle = scale.colourAt(0.5), y = height - 74;
            bar(c, 60, 86, width - 120, 44, scale);
            swatch(c, 24, y, 60, 48, (px, row) => hatchAt(px, row, 48, PATTERN_PX));
            write(c, say('legend.nodata'), 98, y + 24, 240);
            swatch(c, 360, y, 60, 48, (px, row) => stippleAt(px, row, 48, PATTERN_PX, middle));
            write(c, say('legend.uncertain'), 434, y + 24, 220);
        }
        c.fillStyle = isGood || past ? INK : ALERT;
        write(c, data, width - 24, height - 50, hasField ? width - 700 : width - 48, { align: 'right', weight: 600 });
    });
}

// Draws a warning on the canvas in the middle of the headset's view. grave true: white on dark red.
export function showBanner(board, words, detail, grave) {
    return board.show(`${grave} ${words} ${detail}`, (c, width) => {
        c.font = `400 ${LETTER_PX}px ${FAMILY}`;
        const lines = detail ? linesOf(c, detail, width - 80).slice(0, 4) : [], tall = 170 + 64 * lines.length;
        c.canvas.height = tall;
        paper(c, width, tall, grave ? ALERT : PAPER);
        write(c, words, width / 2, 80, width - 60, { size: 92, weight: 700, align: 'center' });
        lines.forEach((line, i) => write(c, line, width / 2, 180 + 64 * i, width - 60, { align: 'center' }));
    });
}

// Returns the wrist panel's buttons in rows: [[{ text, isOn, act }, ...], ...].
function wristRows(session, leave) {
    const { model, params, time, recorded } = session, groups = model.groups.slice(0, 8);
    const now = time.atUs ?? session.clockUs(), live = time.atUs === null;
    const to = (minutes) => ({ text: say('xr.back', { n: minutes }), act: () => travel(session, now - minutes * 60e6) });
    const rows = groups.map((group) => ({ text: quantityText(group), isOn: group.id === params.group,
        act: () => session.setParams({ group: group.id }) })).reduce((all, one, i) => (i % 2 ? [...all.slice(0, -1), [all.at(-1)[0], one]]
        : [...all, [one]]), []);
    return [...rows, ...recorded ? [[to(1), to(10), to(60)], [{ text: say('xr.live'), isOn: live, act: () => travel(session, null) }]] : [],
        [{ text: say('xr.leave'), act: leave }]];
}

// Draws the panel at the wrist with the user's controls. Returns { buttons (with their rectangles as fractions of the panel's size), over
// (the button that the user points at, or null) }.
export function showWrist(board, session, pointed, leave) {
    const rows = wristRows(session, leave), { width, height } = board.canvas, tall = height / rows.length;
    const buttons = rows.flatMap((row, j) => row.map((button, i) => ({ ...button, x: i / row.length, y: j / rows.length,
        width: 1 / row.length, height: 1 / rows.length })));
    const [u, v] = pointed ?? [-1, -1];
    const over = buttons.findIndex(({ x, y, width: w, height: h }) => u >= x && u < x + w && v >= y && v < y + h);
    board.show(JSON.stringify([buttons, over]), (c) => {
        paper(c, width, height);
        buttons.forEach(({ text, isOn, x, y, width: w }, i) => {
            c.fillStyle = isOn ? '#2a5f8f' : i === over ? '#c9d6e2' : '#e4e8eb';
            c.beginPath();
            c.roundRect(x * width + 8, y * height + 8, w * width - 16, tall - 16, 14);
            c.fill();
            c.fillStyle = isOn ? '#fff' : INK;
            write(c, text, (x + w / 2) * width, y * height + tall / 2, w * width - 32, { size: Math.min(44, tall / 2), align: 'center' });
        });
    });
    return { buttons, over: buttons[over] ?? null };
}

// Returns the lines [[text, size, weight], ...] of a card about the sensor or point that the user picked.
export function cardLines(session, picked, now) {
    const { model } = session, tag = picked.sensor ? model.tag(picked.sensor) : null, asset = model.asset(tag?.asset ?? picked.asset);
    const named = asset ? [asset.tag || asset.id, asset.description].filter(Boolean).join(', ') : '';
    if (!tag) {
        const scale = session.scaleOf(session.params), number = (x) => valueText(scale, x);
        const { value, unit, state, place, uncertain, nearest } = picked, found = say(`place.${place ?? state}`);
        const text = value === null ? null : `${number(value)} ${unitText(unit)}`;
        return [[named, 52, 600], text && [text, 84, 700], [uncertain ? say('place.uncertain', { state: found }) : found, 52, 400],
            ...nearest.slice(0, 2).map((one) => [`${one.tag}  ${number(one.value)}`, 52, 400])].filter(Boolean);
    }
    const reading = model.readings[tag.index], group = model.group(tag.group), alarm = model.alarms.gravest(tag.index);
    const value = reading.value === null ? say('card.novalue')
        : `${valueText(group, reading.value)} ${unitText(tag.unit || group?.unit)}`;
    return [[tag.name, 60, 700], tag.description && [tag.description, 52, 400], [value, 84, 700],
        [`${statusText(reading.quality, reading.qualityName)}, ${ageText(model.ageMs(tag.index, now))}`, 52, 400],
        alarm && [`${say(`card.${alarm.kind}`)}, ${say(`state.${alarm.state}`)}`, 52, 700, ALERT],
        named && [named, 52, 400]].filter(Boolean);
}

export function showCard(board, lines) {
    const tall = 40 + lines.reduce((sum, [, size]) => sum + LINE * size, 0);
    return board.show(JSON.stringify(lines), (c, width) => {
        c.canvas.height = tall;
        paper(c, width, tall);
        let y = 20;
        for (const [text, size, weight, colour = INK] of lines) {
            c.fillStyle = colour;
            write(c, text, 28, y + size * LINE / 2, width - 56, { size, weight });
            y += size * LINE;
        }
    });
}

// Draws a sensor's marker on a canvas in the headset's view: its shape is the quality of the reading, its ring the priority of an alarm.
export function showMarker(board, quality, alarm) {
    return board.show('once', (c, width) => {
        const r = width * 0.2;
        c.translate(width / 2, width / 2);
        if (alarm) {
            for (const [line, colour] of [[0.16, '#fff'], [0.11, INK], [0.07, ALARM_COLOURS[alarm.priority - 1][0]],
                ...isGone(alarm.state) ? [[0.025, '#fff']] : []]) {
                c.beginPath();
                c.arc(0, 0, width * 0.4, 0, 2 * Math.PI);
                c.lineWidth = line * width;
                c.strokeStyle = colour;
                c.stroke();
            }
        }
        c.beginPath();
        if (quality === 'uncertain')
            c.rotate(Math.PI / 4);
        if (quality === 'good')
            c.arc(0, 0, r, 0, 2 * Math.PI);
        else
            c.rect(-r, -r, 2 * r, 2 * r);
        c.fillStyle = '#fff';
        c.fill();
        c.lineWidth = 0.06 * width;
        c.strokeStyle = INK;
        c.stroke();
        if (quality === 'bad') {
            c.moveTo(-r / 2, -r / 2);
            c.lineTo(r / 2, r / 2);
            c.moveTo(r / 2, -r / 2);
            c.lineTo(-r / 2, r / 2);
            c.stroke();
        }
    });
}

// Fills a canvas with one colour, for a pointing ray or for a veil over the whole view.
export const showColour = (board, colour) => board.show(colour, (c, width, height) => {
    c.fillStyle = colour;
    c.fillRect(0, 0, width, height);
});

// Shows the ring on the floor where the user will stand.
export const showRing = (board) => board.show('once', (c, width) => {
    for (const [line, colour] of [[0.12, '#fff'], [0.06, INK]]) {
        c.beginPath();
        c.arc(width / 2, width / 2, width * 0.4, 0, 2 * Math.PI);
        c.lineWidth = line * width;
        c.strokeStyle = colour;
        c.stroke();
    }
});
