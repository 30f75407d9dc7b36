// SPDX-License-Identifier: GPL-3.0-or-later
// Colours and sizes of charts, and patterns for missing values.

export const LOOKS = {
    light: { ground: '#ffffff', ink: '#4d5964', rule: '#d8dce0', gap: '#8b949c', grave: '#a31515', limit: '#8a5a00', then: '#5b2d8e',
        edge: '#1d252d',
        lines: ['#0b5c93', '#b34a00', '#00734f', '#8a3a73', '#5b5b00', '#4b4f56', '#006a78', '#6b4226'] },
    dark: { ground: '#363d44', ink: '#c3cad0', rule: '#515a63', gap: '#8b949c', grave: '#ff9d94', limit: '#f0c265', then: '#cdb4f0',
        edge: '#1d252d',
        lines: ['#84c1f2', '#ffb27a', '#66d6a6', '#e8a5d6', '#d9d977', '#d5dbe0', '#7fd8e8', '#d9b793'] },
};

// unitPx: CSS pixels per chart unit: 1 on a desktop page, more on a wall display, which is viewed from afar; leastText: minimum
// font size in chart units
let unitPx = 1, leastText = 0;
export function setChartUnit(px, least) {
    [unitPx, leastText] = [px, least];
}
// Convert a length in chart units to CSS pixels and to device pixels.
export const toCss = (units) => units * unitPx;
export const toPixels = (units) => units * unitPx * devicePixelRatio;
// Returns the given font size, but at least the charts' minimum, in chart units.
export const textSize = (units) => Math.max(units, leastText);

// Draws a hatched rectangle for a period without values. The rectangle is clipped to the canvas, because a gap of days in a chart of
// seconds would be millions of pixels wide.
export function hatch(ctx, left, top, width, height, colour) {
    const step = toPixels(7), from = Math.max(left, 0) - height, to = Math.min(left + width, ctx.canvas.width);
    if (!(height <= ctx.canvas.height))
        return;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.globalAlpha = 0.45;
    ctx.strokeStyle = colour;
    ctx.lineWidth = toPixels(1.5);
    ctx.beginPath();
    for (let x = from - from % step; x < to; x += step) {
        ctx.moveTo(x, top + height);
        ctx.lineTo(x + height, top);
    }
    ctx.stroke();
    ctx.restore();
}

// Draws a hatched band along a line from one position [x, y] to another.
export function hatchAlong(ctx, [left, begin], [right, end], colour) {
    const half = toPixels(8), top = Math.min(begin, end) - half, height = Math.abs(end - begin) + 2 * half;
    ctx.save();
    ctx.beginPath();
    ctx.moveTo(left, begin - half);
    ctx.lineTo(right, end - half);
    ctx.lineTo(right, end + half);
    ctx.lineTo(left, begin + half);
    ctx.clip();
    hatch(ctx, left, top, right - left, height, colour);
    ctx.restore();
}

// Strokes a series' curve between two positions, leaving out stretches without values.
export function strokeAlong(chart, index, left, right, { colour, width, dash = [], alpha = 1 }) {
    const { ctx, bbox } = chart, { stroke, clip } = chart.series[index]._paths ?? {};
    if (!stroke)
        return;
    ctx.save();
    ctx.beginPath();
    ctx.rect(Math.max(left, bbox.left), bbox.top, Math.min(right, bbox.left + bbox.width) - Math.max(left, bbox.left), bbox.height);
    ctx.clip();
    if (clip)
        ctx.clip(clip);
    Object.assign(ctx, { strokeStyle: colour, lineWidth: toPixels(width), globalAlpha: alpha, lineJoin: 'round' });
    ctx.setLineDash(dash.map(toPixels));
    ctx.stroke(stroke);
    ctx.restore();
}

// Draws a triangle that points down to a position.
export function triangle(ctx, x, y, colour, edge) {
    const px = toPixels(1);
    ctx.save();
    ctx.beginPath();
    ctx.moveTo(x, y - 3 * px);
    ctx.lineTo(x - 5.5 * px, y - 13 * px);
    ctx.lineTo(x + 5.5 * px, y - 13 * px);
    ctx.closePath();
    Object.assign(ctx, { fillStyle: colour, strokeStyle: edge, lineWidth: px });
    ctx.fill();
    ctx.stroke();
    ctx.restore();
}
