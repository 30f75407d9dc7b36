// SPDX-License-Identifier: GPL-3.0-or-later
// Writes values along isolines where no other label is, and draws arrows. Loaded when there are isolines or arrows.
import { decimalsOf, shortNumberText } from '../../core/format.js';
import { halfAt } from '../../core/nearest.js';
import { Arrows } from './arrows.js';
import { INK } from './overlay.js';

const SPACING_PX = 160; // minimum distance in pixels between two labels of the same isoline value

export class Isolines {
    constructor({ session, overlay, refresh }) {
        Object.assign(this, { session, overlay });
        overlay.isolines = this;
        overlay.arrows = new Arrows({ session, overlay });
        refresh();
    }

    draw(blocked) {
        const { overlay } = this, { picture, shown } = this.session, c = overlay.context;
        if (!picture || shown.show === 'operator')
            return;
        const { fullWidth, shownWidth, fullHeight } = picture, scale = [overlay.wide / shownWidth, overlay.high / fullHeight];
        const taken = [...blocked];
        overlay.setFont(600);
        c.textBaseline = 'middle';
        c.textAlign = 'center';
        const moved = picture.moved ?? ((...at) => at);
        const labels = (this.session.markersOf(picture.seq)?.isolines ?? []).map(([value, ...at]) => ({ value, at: moved(...at) }))
            .filter(({ at }) => at).map(({ value, at: [px, py] }) => {
                const x = px + (shownWidth - fullWidth) / 2, of = this.session.scaleOf(halfAt(shown, shownWidth, x).params);
                return { text: shortNumberText(value, decimalsOf(of, value)), x: x * scale[0], y: py * scale[1] };
            });
        for (const { text, x, y } of labels) {
            const wide = c.measureText(text).width + 6, box = { left: x - wide / 2, right: x + wide / 2, top: y - 8, bottom: y + 8, text };
            const meets = (o) => box.left < o.right && o.left < box.right && box.top < o.bottom && o.top < box.bottom;
            const near = (o) => o.text === text && Math.hypot(o.left - box.left, o.top - box.top) < SPACING_PX;
            if (taken.some((other) => meets(other) || near(other)))
                continue;
            taken.push(box);
            c.fillStyle = 'rgb(255 255 255 / 0.75)';
            c.fillRect(box.left, box.top, wide, 16);
            c.fillStyle = INK;
            c.fillText(text, x, y + 0.5);
        }
        c.textAlign = 'start';
    }
}
