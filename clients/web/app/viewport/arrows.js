// SPDX-License-Identifier: GPL-3.0-or-later
// Arrows of a group whose sensors have directions: as long as the field's value, and a cross where it is not known where to.
import { decimalsFor, shortNumberText, unitText } from '../../core/format.js';
import { halves } from '../../core/split_view.js';
import { say } from '../../core/words.js';
import { make } from '../common/dom.js';
import { INK } from './overlay.js';

const LONGEST_PX = (width) => 0.95 * Math.max(48, width / 24); // of the picture; the server leaves a little more between them
const HEAD = 7, CROSS = 'M-3 -3L3 3M-3 3L3 -3', DOT = 'M-.6 0A.6 .6 0 1 0 .6 0A.6 .6 0 1 0 -.6 0';
const isUnknown = (dx, dy) => dx === 0 && dy === 0;

// Along x, its middle at 0.
function shape(length) {
    const head = Math.min(HEAD, length / 2), tip = length / 2;
    return new Path2D(`M${-tip} 0H${tip}M${tip - 0.85 * head} ${-head / 2}L${tip} 0L${tip - 0.85 * head} ${head / 2}`);
}

export class Arrows {
    constructor({ session, overlay }) {
        Object.assign(this, { session, overlay });
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
        if (!picture)
            return;
        const parts = halves(shown, picture.shownWidth), [across, down] = this.scale, c = this.overlay.context;
        for (const [px, py, dx, dy, value, uncertain, half] of this.session.markersOf(picture.seq)?.arrows ?? []) {
            const { params, width } = parts[half] ?? parts[0];
            const length = LONGEST_PX(width) * Math.min(1, Math.abs(value) / this.longestIn(params)) * Math.hypot(dx, dy) * across;
            c.save();
            c.translate((px + (picture.shownWidth - picture.fullWidth) / 2) * across, py * down);
            c.rotate(Math.atan2(dy, dx));
            this.stroke(isUnknown(dx, dy) ? new Path2D(CROSS) : length < 2 ? new Path2D(DOT) : shape(length), uncertain);
            c.restore();
        }
        this.explain();
    }

    stroke(path, uncertain) {
        const c = this.overlay.context;
        c.lineCap = c.lineJoin = 'round';
        c.lineWidth = 3.6;
        c.strokeStyle = 'rgb(255 255 255 / 0.85)';
        c.stroke(path);
        c.setLineDash(uncertain ? [3, 2.5] : []);
        c.lineWidth = 1.6;
        c.strokeStyle = INK;
        c.stroke(path);
        c.lineCap = c.lineJoin = 'butt';
        c.setLineDash([]);
    }

    // In each legend, the longest arrow in its true length, and what a cross is where there is one.
    explain() {
        const { shown, picture } = this.session;
        const rows = this.session.markersOf(picture.seq)?.arrows ?? [];
        const legends = [...this.overlay.viewport.element.querySelectorAll('.legend')];
        halves(shown, picture.shownWidth).forEach(({ params, width }, half) => {
            const legend = legends[half], group = this.session.model.group(params.group);
            const key = legend?.querySelector('.arrow-key'), wanted = group?.directed && params.show === 'value';
            if (!legend || legend.hidden || !wanted)
                return key?.remove();
            const value = this.longestIn(params), length = LONGEST_PX(width) * this.scale[0];
            const text = `${shortNumberText(value, decimalsFor(value))}\u202f${unitText(params.unit ?? group.unit)}`;
            const unknown = rows.some(([, , dx, dy, , , of]) => of === half && isUnknown(dx, dy)), says = `${text}/${length}/${unknown}`;
            if (key?.dataset.says === says)
                return null;
            key?.remove();
            const canvas = make('canvas', { 'aria-hidden': 'true' }), ratio = window.devicePixelRatio;
            Object.assign(canvas, { width: (length + 4) * ratio, height: 12 * ratio });
            canvas.style.cssText = `width:${length + 4}px;height:12px;vertical-align:middle`;
            const c = canvas.getContext('2d');
            c.setTransform(ratio, 0, 0, ratio, (length / 2 + 2) * ratio, 6 * ratio);
            c.lineWidth = 1.6;
            c.lineCap = c.lineJoin = 'round';
            c.strokeStyle = INK;
            c.stroke(shape(length));
            const keys = unknown ? [make('br'), `× ${say('arrows.unknown')}`] : [];
            return legend.append(make('p', { class: 'note arrow-key', 'data-says': says }, canvas, ` ${text}`, ...keys));
        });
    }
}
