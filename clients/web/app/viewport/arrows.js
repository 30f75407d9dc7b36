// SPDX-License-Identifier: GPL-3.0-or-later
// Arrows for a sensor group with directions: an arrow's length is the field's value, a cross marks an unknown direction.
// Alternatively streaks with moving dashes, on a separate canvas.
import { decimalsFor, shortNumberText, unitText } from '../../core/format.js';
import { halves } from '../../core/split_view.js';
import { say } from '../../core/words.js';
import { make } from '../common/dom.js';
import { INK } from './overlay.js';

// length in pixels of the longest arrow in a picture `width` pixels wide: slightly less than the server's minimum distance
// between arrows
const LONGEST_PX = (width) => 0.95 * Math.max(48, width / 24);
const HEAD = 7, CROSS = 'M-3 -3L3 3M-3 3L3 -3', DOT = 'M-.6 0A.6 .6 0 1 0 .6 0A.6 .6 0 1 0 -.6 0';
// dash pattern of the arrow of an uncertain value, and length in pixels of such an arrow in a legend
const UNCERTAIN = [3, 2.5], UNCERTAIN_PX = 24;
// DASH: dash pattern of streaks; FASTEST_PX: speed of the dashes in pixels per second at the largest value of the colour scale
const DASH = [5, 11], FASTEST_PX = 60;
const isUnknown = (dx, dy) => dx === 0 && dy === 0;

// Returns an arrow's path along x, centred at 0.
function shape(length) {
    const head = Math.min(HEAD, length / 2), tip = length / 2;
    return new Path2D(`M${-tip} 0H${tip}M${tip - 0.85 * head} ${-head / 2}L${tip} 0L${tip - 0.85 * head} ${head / 2}`);
}

// Path of an arrow head along x, with its tip at 0.
const head = () => new Path2D(`M${-0.85 * HEAD} ${-HEAD / 2}L0 0L${-0.85 * HEAD} ${HEAD / 2}`);

// Returns a canvas with an arrow for a legend.
function sample(length, dashes = []) {
    const canvas = make('canvas', { 'aria-hidden': 'true' }), ratio = window.devicePixelRatio, c = canvas.getContext('2d');
    Object.assign(canvas, { width: (length + 4) * ratio, height: 12 * ratio });
    canvas.style.cssText = `width:${length + 4}px;height:12px;vertical-align:middle`;
    c.setTransform(ratio, 0, 0, ratio, (length / 2 + 2) * ratio, 6 * ratio);
    c.lineWidth = 1.6;
    c.lineCap = c.lineJoin = 'round';
    c.setLineDash(dashes);
    c.strokeStyle = INK;
    c.stroke(shape(length));
    return canvas;
}

export class Arrows {
    constructor({ session, overlay }) {
        Object.assign(this, { session, overlay, strokes: [] });
        this.running = make('canvas', { id: 'strokes', 'aria-hidden': 'true' });
        overlay.canvas.before(this.running);
        this.still = window.matchMedia('(prefers-reduced-motion: reduce)');
        this.still.addEventListener('change', () => this.run());
    }

    get scale() {
        const { shownWidth, fullHeight } = this.session.picture;
        return [this.overlay.wide / shownWidth, this.overlay.high / fullHeight];
    }

    longestIn(params) {
        return Math.max(...this.session.rangeOf(params).map(Math.abs));
    }

    draw() {
        const { picture, shown } = this.session;
        this.strokes = [];
        if (!picture)
            return;
        const parts = halves(shown, picture.shownWidth), [across, down] = this.scale, c = this.overlay.context;
        for (const [x, y, dx, dy, value, uncertain, half, number] of this.session.markersOf(picture.seq)?.arrows ?? []) {
            const { params, width } = parts[half] ?? parts[0], moved = picture.moved ? picture.moved(x, y) : [x, y];
            if (!moved)
                continue;
            const [px, py] = moved;
            if (number) {
                const at = [(px + (picture.shownWidth - picture.fullWidth) / 2) * across, py * down];
                const speed = Math.min(1, Math.abs(value) / this.longestIn(params));
                this.addToStroke({ at, to: [dx, dy], half, number, uncertain, speed });
                continue;
            }
            const length = LONGEST_PX(width) * Math.min(1, Math.abs(value) / this.longestIn(params)) * Math.hypot(dx, dy) * across;
            c.save();
            c.translate((px + (picture.shownWidth - picture.fullWidth) / 2) * across, py * down);
            c.rotate(Math.atan2(dy, dx));
            this.stroke(isUnknown(dx, dy) ? new Path2D(CROSS) : length < 2 ? new Path2D(DOT) : shape(length), uncertain);
            c.restore();
        }
        for (const { path, end, to } of this.strokes)
            path.addPath(head(), new DOMMatrix().translate(...end).rotate(Math.atan2(to[1], to[0]) * 180 / Math.PI));
        if (this.still.matches)
            this.strokes.forEach(({ path, uncertain }) => this.stroke(path, uncertain));
        this.run();
        this.explain();
    }

    addToStroke({ at, half, number, uncertain, speed, to }) {
        const last = this.strokes.at(-1), goesOn = last?.number === number && last.half === half;
        if (!goesOn)
            this.strokes.push({ half, number, speed, uncertain: 0, path: new Path2D(), line: new Path2D() });
        const stroke = this.strokes.at(-1);
        for (const path of [stroke.path, stroke.line])
            path[goesOn ? 'lineTo' : 'moveTo'](...at);
        Object.assign(stroke, { end: at, to, uncertain: stroke.uncertain || uncertain });
    }

    // Animates white dashes along dark streaks, below all labels, while streaks are shown, unless the user has asked for reduced motion.
    run() {
        const { canvas } = this.overlay, moves = this.strokes.length > 0 && !this.still.matches;
        this.running.hidden = !moves;
        if (this.frame || !moves)
            return;
        const next = (ms) => {
            const c = this.running.getContext('2d');
            this.frame = null;
            if (this.strokes.length === 0 || this.still.matches)
                return this.run();
            for (const side of ['width', 'height'])
                if (this.running[side] !== canvas[side])
                    this.running[side] = canvas[side];
            c.setTransform(this.overlay.context.getTransform());
            c.clearRect(0, 0, this.overlay.wide, this.overlay.high);
            this.strokes.forEach(({ path, uncertain }) => this.stroke(path, uncertain, c));
            c.lineCap = 'round';
            c.lineWidth = 1.6;
            c.strokeStyle = 'white';
            c.setLineDash(DASH);
            for (const { line, speed } of this.strokes) {
                c.lineDashOffset = -(ms / 1000 * speed * FASTEST_PX) % (DASH[0] + DASH[1]);
                c.stroke(line);
            }
            c.setLineDash([]);
            this.frame = requestAnimationFrame(next);
            return null;
        };
        this.frame = requestAnimationFrame(next);
    }

    stroke(path, uncertain, c = this.overlay.context) {
        c.lineCap = c.lineJoin = 'round';
        c.lineWidth = 3.6;
        c.strokeStyle = 'rgb(255 255 255 / 0.85)';
        c.stroke(path);
        c.setLineDash(uncertain ? UNCERTAIN : []);
        c.lineWidth = 1.6;
        c.strokeStyle = INK;
        c.stroke(path);
        c.lineCap = c.lineJoin = 'butt';
        c.setLineDash([]);
    }

    // Adds to each legend the longest arrow at its true length, and the meaning of dashes and crosses if the picture has any.
    explain() {
        const { shown, picture } = this.session;
        const rows = this.session.markersOf(picture.seq)?.arrows ?? [];
        const legends = [...this.overlay.viewport.element.querySelectorAll('.legend')];
        halves(shown, picture.shownWidth).forEach(({ params, width }, half) => {
            const legend = legends[half], group = this.session.model.group(params.group);
            const key = legend?.querySelector('.arrow-key'), wanted = group?.directed && params.show === 'value' && shown.arrows !== 'none';
            if (!legend || legend.hidden || !wanted)
                return key?.remove();
            const value = this.longestIn(params), length = LONGEST_PX(width) * this.scale[0];
            const strokes = shown.arrows === 'strokes'; // streaks all have the same length, so only arrows need their length in the legend
            const text = strokes ? '' : `${shortNumberText(value, decimalsFor(value))}\u202f${unitText(params.unit ?? group.unit)}`;
            const own = rows.filter(([, , , , , , of]) => of === half), unknown = own.some(([, , dx, dy]) => isUnknown(dx, dy));
            const dashed = own.some(([, , , , , uncertain]) => uncertain), says = `${text}/${length}/${unknown}/${dashed}`;
            if (key?.dataset.says === says)
                return null;
            key?.remove();
            const lines = [...(strokes ? [] : [[sample(length), ` ${text}`]]),
                ...(dashed ? [[sample(UNCERTAIN_PX, UNCERTAIN), ` ${say('legend.uncertain')}`]] : []),
                ...(unknown ? [[`× ${say('arrows.unknown')}`]] : [])];
            const keys = lines.flatMap((line, i) => (i ? [make('br'), ...line] : line));
            return keys.length > 0 && legend.append(make('p', { class: 'note arrow-key', 'data-says': says }, ...keys));
        });
    }
}
