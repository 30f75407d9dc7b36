// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of charts for each theme, and patterns for missing values.

// must equal the line colours in trends.css
export const LOOKS = {
    light: { ground: '#ffffff', ink: '#4d5964', rule: '#d8dce0', gap: '#8b949c', grave: '#a31515', limit: '#8a5a00', then: '#5b2d8e',
        lines: ['#0b5c93', '#b34a00', '#00734f', '#8a3a73', '#5b5b00', '#4b4f56'] },
    dark: { ground: '#363d44', ink: '#c3cad0', rule: '#515a63', gap: '#8b949c', grave: '#ff9d94', limit: '#f0c265', then: '#cdb4f0',
        lines: ['#84c1f2', '#ffb27a', '#66d6a6', '#e8a5d6', '#d9d977', '#d5dbe0'] },
};

// Draws a hatched rectangle, clipped to the canvas: a gap of days in a chart of seconds would be millions of pixels wide.
export function hatch(ctx, left, top, width, height, colour) {
    const step = 7 * devicePixelRatio, from = Math.max(left, 0) - height, to = Math.min(left + width, ctx.canvas.width);
    if (!(height <= ctx.canvas.height))
        return;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.globalAlpha = 0.45;
    ctx.strokeStyle = colour;
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.beginPath();
    for (let x = from - from % step; x < to; x += step) {
        ctx.moveTo(x, top + height);
        ctx.lineTo(x + height, top);
    }
    ctx.stroke();
    ctx.restore();
}

export function dots(ctx, left, right, y, colour) {
    ctx.fillStyle = colour;
    for (let x = Math.max(left, 0); x < Math.min(right, ctx.canvas.width); x += 6 * devicePixelRatio)
        ctx.fillRect(x, y, 3 * devicePixelRatio, 3 * devicePixelRatio);
}
