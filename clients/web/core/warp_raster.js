// SPDX-License-Identifier: GPL-3.0-or-later
// Draws meshes of depth grids (warp_mesh.js) on the processor, for browsers without a GPU. Such browsers emulate WebGL, which takes several
// times as long. Pixels are 32-bit numbers as in an ImageData, with red in the lowest byte; 0: not drawn.
import { FAR, FLOATS, NEAR } from './warp_mesh.js';

// a rectangle of the source picture is drawn as a parallelogram if its projection deviates by at most SKEW_PX from one, or
// measures at most LEAST_PX
const SKEW_PX = 1, LEAST_PX = 4;
const LAP_PX = 0.1; // overlap of neighbouring parallelograms in drawn pixels, which hides cracks between them
const LEAST_AREA = 1e-3; // parallelograms with a smaller area, in drawn pixels, are not drawn
const TINY = 1e-7; // minimum change of the position in the source picture from one screen pixel to the next; avoids divisions by zero
// the greys of undrawn places are computed for blocks of REDUCED x REDUCED pixels (fillUndrawn() divides by REDUCED with a
// shift)
const REDUCED = 4;
const WIDE_LEVEL = 3; // index of the reduced picture in which fillUndrawn() looks up how wide an undrawn place is
const BITS = 16, ONE = 2 ** BITS; // fixed-point source positions
const NEAR_ONE = 2 ** 30 - 1; // factor from nearness (1 - z of a drawn surface, below 2) to a 32-bit integer
// minimum distance in pixels of a position in the source picture from the right and lower edge of its quad, so that rounding
// does not cross the edge
const INSIDE = 4e-3;
const OPAQUE = -0x1000000;
// brightness of the lattice lines over wide undrawn places, and the lines' width as a fraction of their spacing
const MARK = 0.08 * 255, MARK_SHARE = 0.1;

const lightOf = (pixel) => (77 * (pixel & 255) + 150 * (pixel >> 8 & 255) + 29 * (pixel >> 16 & 255)) >> 8;
const greyPixel = (light) => (OPAQUE | Math.floor(light) * 0x10101);

// The pixels of a picture, separated by surfaces: `all`, and for depth cells with two surfaces `near` and `far`, in which
// pixels of the other surface are 0. In `far`, pixels next to the nearer surface are grey, because they contain part of its
// colour.
export class Layers {
    // pixels: those of the whole picture, which is `width` pixels wide.
    constructor(pixels, width, grids) {
        Object.assign(this, { all: pixels, width, far: pixels.slice(), near: new Int32Array(pixels.length) });
        for (const grid of grids)
            this.separate(grid);
    }

    separate(grid) {
        const { columns, rows, maskSide, masks, far } = grid, wide = columns * maskSide, high = rows * maskSide;
        for (let cell = 0; cell < far.length; cell++) {
            if (far[cell] < 0)
                continue;
            const left = cell % columns * maskSide, top = Math.floor(cell / columns) * maskSide;
            for (let y = top; y < top + maskSide; y++)
                for (let x = left, i = y * wide + left; x < left + maskSide; x++, i++)
                    if (masks[i] > 0) {
                        this.moveToNear(grid, x, y);
                        if (x > 0 && masks[i - 1] === 0)
                            this.makeGrey(grid, x - 1, y);
                        if (x + 1 < wide && masks[i + 1] === 0)
                            this.makeGrey(grid, x + 1, y);
                        if (y > 0 && masks[i - wide] === 0)
                            this.makeGrey(grid, x, y - 1);
                        if (y + 1 < high && masks[i + wide] === 0)
                            this.makeGrey(grid, x, y + 1);
                    }
        }
    }

    // Calls f with the index of each pixel that belongs to one bit of a cell's mask.
    pixelsOf({ x, y, width, height, cellPx, maskSide }, bitX, bitY, f) {
        const bit = cellPx / maskSide, right = Math.min(width, (bitX + 1) * bit), bottom = Math.min(height, (bitY + 1) * bit);
        for (let row = bitY * bit; row < bottom; row++)
            for (let column = bitX * bit; column < right; column++)
                f((y + row) * this.width + x + column);
    }

    moveToNear(grid, bitX, bitY) {
        const { all, near, far } = this;
        this.pixelsOf(grid, bitX, bitY, (i) => {
            near[i] = all[i];
            far[i] = 0;
        });
    }

    makeGrey(grid, bitX, bitY) {
        const { all, far } = this;
        this.pixelsOf(grid, bitX, bitY, (i) => { far[i] = greyPixel(lightOf(all[i])); });
    }
}

// Returns a value of a reduced picture by bilinear interpolation; x, y: in blocks of that picture, from the centre of the first block.
function smooth(values, { width, height }, x, y) {
    const left = Math.max(0, Math.min(width - 1, Math.floor(x))), top = Math.max(0, Math.min(height - 1, Math.floor(y)));
    const i = top * width + left, right = left + 1 < width ? 1 : 0, down = top + 1 < height ? width : 0;
    const p = Math.max(0, x - left), q = Math.max(0, y - top), above = values[i] + (values[i + right] - values[i]) * p;
    const below = values[i + down] + (values[i + down + right] - values[i + down]) * p;
    return above + (below - above) * q;
}

// Computes a reduced picture from the one with twice its width and height.
function halve(level, half, from, to) {
    for (let y = 0, at = 0; y < half.height; y++)
        for (let x = 0, i = 2 * y * level.width; x < half.width; x++, at++, i += 2) {
            const right = 2 * x + 1 < level.width ? 1 : 0, down = 2 * y + 1 < level.height ? level.width : 0;
            to[at] = (from[i] + from[i + right] + from[i + down] + from[i + down + right]) / 4;
        }
}

export class Raster {
    constructor(width, height) {
        Object.assign(this, { width, height, pixels: new Int32Array(width * height) });
        // 1 - z of the drawn surfaces, in normalized device coordinates, multiplied by NEAR_ONE
        this.nearness = new Int32Array(width * height);
        // x, y on the screen of the corners of the quad being drawn, and the corners' nearness (1 - z, larger is nearer to the
        // eye)
        [this.x, this.y, this.n] = [0, 1, 2].map(() => new Float64Array(4));
        // reduced pictures, each half as wide and high as the one before: brightness multiplied by the drawn fraction, and
        // drawn fraction
        this.levels = [];
        for (let [w, h] = [width, height].map((px) => Math.ceil(px / REDUCED)); ; [w, h] = [(w + 1) >> 1, (h + 1) >> 1]) {
            this.levels.push({ width: w, height: h, light: new Float32Array(w * h), part: new Float32Array(w * h) });
            if (w * h === 1)
                break;
        }
    }

    clear() {
        this.pixels.fill(0);
        this.nearness.fill(0);
    }

    // Draws the mesh of one half of a split view, or of the whole picture. matrix: from warpMatrix(); layers: the picture's
    // Layers; box: { left, top, width, height } of that half in drawn pixels.
    draw({ grid, mesh: { vertices, count } }, matrix, layers, box) {
        Object.assign(this, { grid, matrix: Float64Array.from(matrix), box, stride: layers.width });
        const picked = [layers.all, layers.near, layers.far], most = 4 * FLOATS;
        this.clip = { left: Math.max(0, Math.round(box.left)), right: Math.min(this.width, Math.round(box.left + box.width)),
            top: Math.max(0, Math.round(box.top)), bottom: Math.min(this.height, Math.round(box.top + box.height)) };
        for (let at = 0, end = count * most; at < end; at += most) {
            this.layer = picked[vertices[at + 3]];
            this.quad(vertices[at], vertices[at + 1], vertices[at + 3 * FLOATS], vertices[at + 3 * FLOATS + 1],
                vertices[at + 2], vertices[at + FLOATS + 2], vertices[at + 2 * FLOATS + 2], vertices[at + 3 * FLOATS + 2]);
        }
    }

    // Draws a rectangle of the source picture, with these depths at its top left, top right, bottom left and bottom right
    // corner, as a parallelogram on the screen. If perspective distorts it too much for that, its quarters are drawn
    // separately.
    quad(left, top, right, bottom, d0, d1, d2, d3) {
        const { matrix: m, box, x, y, n } = this, halfWidth = box.width / 2, halfHeight = box.height / 2;
        let behind = 0;
        for (let k = 0; k < 4; k++) {
            const a = k & 1 ? right : left, b = k & 2 ? bottom : top, d = k === 0 ? d0 : k === 1 ? d1 : k === 2 ? d2 : d3;
            const share = 1 / (m[3] * a + m[7] * b + m[11] * d + m[15]);
            x[k] = box.left + halfWidth + halfWidth * (m[0] * a + m[4] * b + m[8] * d + m[12]) * share;
            y[k] = box.top + halfHeight - halfHeight * (m[1] * a + m[5] * b + m[9] * d + m[13]) * share;
            n[k] = 1 - (m[2] * a + m[6] * b + m[10] * d + m[14]) * share;
            behind += share > 0 && n[k] < 2 ? 0 : 1;
        }
        const wide = right - left, high = bottom - top, skew = Math.abs(x[0] - x[1] - x[2] + x[3]) + Math.abs(y[0] - y[1] - y[2] + y[3]);
        if (behind === 4)
            return;
        if ((behind > 0 || skew > SKEW_PX) && wide > LEAST_PX && high > LEAST_PX) {
            const u = (left + right) / 2, v = (top + bottom) / 2, up = (d0 + d1) / 2, down = (d2 + d3) / 2, middle = (up + down) / 2;
            this.quad(left, top, u, v, d0, up, (d0 + d2) / 2, middle);
            this.quad(u, top, right, v, up, d1, middle, (d1 + d3) / 2);
            this.quad(left, v, u, bottom, (d0 + d2) / 2, middle, d2, down);
            this.quad(u, v, right, bottom, middle, (d1 + d3) / 2, down, d3);
        } else if (behind === 0) {
            this.parallelogram(left, top, right, bottom);
        }
    }

    parallelogram(left, top, right, bottom) {
        const { x, y, n, layer, stride, nearness, pixels, width, grid, clip } = this, wide = right - left, high = bottom - top;
        // vectors on the screen: (ex, ey) from the left to the right edge, (fx, fy) from the upper to the lower edge
        const ex = (x[1] - x[0] + x[3] - x[2]) / 2, ey = (y[1] - y[0] + y[3] - y[2]) / 2;
        const fx = (x[2] - x[0] + x[3] - x[1]) / 2, fy = (y[2] - y[0] + y[3] - y[1]) / 2, area = ex * fy - ey * fx;
        if (!(area > LEAST_AREA)) // not drawn: the camera sees the rectangle from behind, or along its plane
            return;
        const cx = (x[0] + x[1] + x[2] + x[3]) / 4 - 0.5, cy = (y[0] + y[1] + y[2] + y[3]) / 4 - 0.5;
        const reach = (Math.abs(ey) + Math.abs(fy)) * (0.5 + LAP_PX / Math.min(wide, high));
        const last = Math.min(clip.bottom, Math.floor(cy + reach) + 1);
        let row = Math.max(clip.top, Math.ceil(cy - reach));
        if (row >= last)
            return;
        // change of the position in the source picture (u, v) and of the nearness from one screen pixel of a row to the next
        // (x), and from one row to the next (y)
        const e = (n[1] - n[0] + n[3] - n[2]) / 2, f = (n[2] - n[0] + n[3] - n[1]) / 2, slope = high * -ey / area;
        const ux = wide * fy / area || TINY, vx = Math.abs(slope) < TINY ? TINY : slope, nx = (e * fy - f * ey) / area;
        const uy = -wide * fx / area, vy = high * ex / area, ny = (f * ex - e * fx) / area;
        const uLow = Math.max(0, left - LAP_PX), uHigh = Math.min(grid.width, right + LAP_PX) - INSIDE;
        const vLow = Math.max(0, top - LAP_PX), vHigh = Math.min(grid.height, bottom + LAP_PX) - INSIDE;
        const uFirst = ux > 0 ? uLow : uHigh, uLast = ux > 0 ? uHigh : uLow, vFirst = vx > 0 ? vLow : vHigh, vLast = vx > 0 ? vHigh : vLow;
        const perU = 1 / ux, perV = 1 / vx, xStep = Math.round(ux * ONE), yStep = Math.round(vx * ONE), nStep = Math.round(nx * NEAR_ONE);
        // position in the source picture (u, v) and nearness for the first pixel of the screen row
        let u = (left + right) / 2 - cx * ux + (row - cy) * uy, v = (top + bottom) / 2 - cx * vx + (row - cy) * vy;
        let near = (n[0] + n[1] + n[2] + n[3]) / 4 - cx * nx + (row - cy) * ny;
        for (; row < last; row++) {
            const from = Math.ceil(Math.max((uFirst - u) * perU, (vFirst - v) * perV, clip.left)) | 0;
            const to = Math.floor(Math.min((uLast - u) * perU, (vLast - v) * perV, clip.right - 1)) | 0;
            let sx = (grid.x + u + from * ux) * ONE | 0, sy = (grid.y + v + from * vx) * ONE | 0, own = (near + from * nx) * NEAR_ONE | 0;
            for (let i = row * width + from | 0, end = row * width + to | 0; i <= end; i++) {
                if (own >= nearness[i]) {
                    const pixel = layer[(sy >> BITS) * stride + (sx >> BITS)];
                    if (pixel !== 0) {
                        pixels[i] = pixel;
                        nearness[i] = own;
                    }
                }
                sx = sx + xStep | 0;
                sy = sy + yStep | 0;
                own = own + nStep | 0;
            }
            u += uy;
            v += vy;
            near += ny;
        }
    }

    // Fills the pixels that no surface of the source picture covers with a grey as light as their surroundings, and draws a
    // lattice over wide areas of such pixels. period: distance between the lines of the lattice, in pixels.
    fillUndrawn(period) {
        const { pixels, width, height, levels } = this, first = this.greys(), { light } = first;
        const wideAt = levels[Math.min(WIDE_LEVEL, levels.length - 1)], share = wideAt.width / first.width / REDUCED;
        const every = Math.max(2, Math.round(period)), line = MARK_SHARE * every, offset = every * height;
        for (let y = 0, i = 0; y < height; y++)
            for (let x = 0, row = (y >> 2) * first.width, block = -1, plain = 0, mark = 0; x < width; x++, i++) {
                if (pixels[i] !== 0)
                    continue;
                if (block !== x >> 2) {
                    block = x >> 2;
                    const grey = light[row + block];
                    const wide = Math.max(0, 0.65 - smooth(wideAt.part, wideAt, (x + 0.5) * share - 0.5, (y + 0.5) * share - 0.5)) / 0.3;
                    const by = wide < 1 ? MARK * wide * wide * (3 - 2 * wide) : MARK;
                    plain = greyPixel(grey);
                    mark = greyPixel(grey > 102 ? grey - by : grey + by);
                }
                const isLine = mark !== plain && ((x + y) % every < line || (x - y + offset) % every < line);
                pixels[i] = isLine ? mark : plain;
            }
    }

    // Makes a fraction (0 to 1) of the pixels transparent, in a dither pattern, so that the canvas below shows through while
    // this picture fades out.
    leaveOut(part) {
        const { pixels, width, height } = this;
        for (let y = 0, i = 0; y < height; y++)
            for (let x = 0; x < width; x++, i++) {
                const odd = (x ^ y) & 3;
                if (4 * (2 * (odd & 1) + (y & 1)) + (odd & 2) + (y >> 1 & 1) <= part * 16 - 0.5)
                    pixels[i] = 0;
            }
    }

    // Returns the first reduced picture, completed: where it shows nothing, it gets the brightness of the nearest coarser
    // reduced picture that shows something there.
    greys() {
        const { levels } = this, top = levels.at(-1);
        this.reduce(levels[0]);
        for (let l = 1; l < levels.length; l++) {
            halve(levels[l - 1], levels[l], levels[l - 1].light, levels[l].light);
            halve(levels[l - 1], levels[l], levels[l - 1].part, levels[l].part);
        }
        top.light[0] = top.part[0] > 0 ? top.light[0] / top.part[0] : 128;
        for (let l = levels.length - 2; l >= 0; l--) {
            const level = levels[l], above = levels[l + 1], { width, height, light, part } = level;
            for (let y = 0, at = 0; y < height; y++)
                for (let x = 0; x < width; x++, at++)
                    if (part[at] < 1)
                        light[at] += (1 - part[at]) * smooth(above.light, above, x / 2 - 0.25, y / 2 - 0.25);
        }
        return levels[0];
    }

    // Computes brightness and drawn fraction of the first reduced picture; for speed, from only a quarter of the pixels.
    reduce({ width: columns, height: rows, light, part }) {
        const { pixels, width, height } = this;
        for (let y = 0, at = 0; y < rows; y++) {
            const upper = y * REDUCED * width, lower = Math.min(height - 1, y * REDUCED + 2) * width;
            for (let x = 0; x < columns; x++, at++) {
                const left = x * REDUCED, right = Math.min(width - 1, left + 2);
                const a = pixels[upper + left], b = pixels[upper + right], c = pixels[lower + left], d = pixels[lower + right];
                light[at] = (lightOf(a) + lightOf(b) + lightOf(c) + lightOf(d)) / 4;
                part[at] = ((a !== 0) + (b !== 0) + (c !== 0) + (d !== 0)) / 4;
            }
        }
    }
}
