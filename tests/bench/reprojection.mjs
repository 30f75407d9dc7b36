// SPDX-License-Identifier: GPL-3.0-or-later
// Compares pictures that the page draws from another camera with true pictures of that camera: similarity, pixels that differ,
// pixels not yet drawn, and values read back from the colours. Uses the page's own modules; only the rasterizer is written
// here, in place of WebGL. usage: build/release/tests/bench/reprojection_bench FOLDER; node tests/bench/reprojection.mjs FOLDER
// [processor]. processor: draws with the page's own rasterizer, as browsers without a GPU do.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { deflateSync, inflateRawSync } from 'node:zlib';

const WEB = process.env.PLANTCAST_WEB ?? fileURLToPath(new URL('../../clients/web', import.meta.url));
const { readGrid, readHeader } = await import(join(WEB, 'core/depth_grid.js'));
const { Layers, Raster } = await import(join(WEB, 'core/warp_raster.js'));
const { FLOATS, meshOf, warpMatrix } = await import(join(WEB, 'core/warp_mesh.js'));

const folder = process.argv[2], isByProcessor = process.argv[3] === 'processor';
const CASES = ['orbit_1', 'orbit_3', 'orbit_6', 'nearer_5', 'nearer_10', 'nearer_20'];
const OFF = 16;          // a pixel counts as different if a channel differs by at least this much, of 255
const NEAREST = 0.05;    // same value as in app/picture/warp.js
const MOST_ERROR = 0.03; // a value read from a colour counts as correct up to this error, as a fraction of the range
// a pixel shows a colour of the map if its distance from it, in red, green and blue of 0..255, is below MOST_UNLIKE
const MOST_UNLIKE = 32;
const LIKE_HUE = 8, LIKE = 48; // as in app/picture/painters/gl_painter.js
const REDUCED = 4, LATTICE_PX = 14, MARK = 0.08 * 255; // as in app/picture/warp.js

const load = (name) => ({
    ...JSON.parse(readFileSync(join(folder, `${name}.json`), 'utf8')),
    pixels: readFileSync(join(folder, `${name}.bgrx`)), depth: readFileSync(join(folder, `${name}.depth`)),
});

// Draws the first picture's mesh as seen by another camera. Returns, for each pixel drawn, `shown`, the index of the pixel of
// the first picture that it shows (-1: nothing is drawn there); `places`, the position there (u, v); `isMasked`, whether the
// picture's depth has a step there.
function rasterize({ vertices, indices }, matrix, grid, width, height) {
    const shown = new Int32Array(width * height).fill(-1), depths = new Float64Array(width * height).fill(Infinity);
    const places = new Float64Array(2 * width * height), isMasked = new Uint8Array(width * height);
    const count = vertices.length / FLOATS, clip = new Float64Array(count * 4);
    for (let i = 0; i < count; i++)
        for (let row = 0; row < 4; row++)
            clip[4 * i + row] = matrix[row] * vertices[FLOATS * i] + matrix[4 + row] * vertices[FLOATS * i + 1]
                + matrix[8 + row] * vertices[FLOATS * i + 2] + matrix[12 + row];
    const bit = grid.cellPx / grid.maskSide, wide = grid.columns * grid.maskSide;
    for (let t = 0; t < indices.length; t += 3) {
        const corners = [0, 1, 2].map((k) => {
            const i = indices[t + k], w = clip[4 * i + 3];
            return { x: (clip[4 * i] / w + 1) * width / 2, y: (1 - clip[4 * i + 1] / w) * height / 2, z: clip[4 * i + 2] / w, w,
                behind: !(w > 0) || clip[4 * i + 2] < -w, u: vertices[FLOATS * i], v: vertices[FLOATS * i + 1] };
        });
        const [a, b, c] = corners, area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x), kind = vertices[FLOATS * indices[t] + 3];
        if (!(area < 0) || corners.some(({ behind }) => behind)) // the page culls back faces
            continue;
        const from = (...at) => Math.max(0, Math.ceil(Math.min(...at) - 0.5));
        const to = (most, ...at) => Math.min(most - 1, Math.floor(Math.max(...at) - 0.5));
        const left = from(a.x, b.x, c.x), right = to(width, a.x, b.x, c.x), top = from(a.y, b.y, c.y), bottom = to(height, a.y, b.y, c.y);
        for (let y = top; y <= bottom; y++)
            for (let x = left; x <= right; x++) {
                const px = x + 0.5, py = y + 0.5;
                const p = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) / area;
                const q = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) / area;
                const r = 1 - p - q, z = p * a.z + q * b.z + r * c.z, at = y * width + x;
                if (p < 0 || q < 0 || r < 0 || z > depths[at] || z > 1)
                    continue;
                const over = p / a.w + q / b.w + r / c.w;
                const u = (p * a.u / a.w + q * b.u / b.w + r * c.u / c.w) / over;
                const v = (p * a.v / a.w + q * b.v / b.w + r * c.v / c.w) / over;
                const near = grid.masks[Math.floor(v / bit) * wide + Math.floor(u / bit)] > 127;
                if (kind > 0.5 && near !== kind < 1.5)
                    continue;
                depths[at] = z;
                isMasked[at] = kind > 0.5 ? 1 : 0;
                places.set([u, v], 2 * at);
                shown[at] = Math.min(height - 1, Math.max(0, Math.floor(v))) * width + Math.min(width - 1, Math.max(0, Math.floor(u)));
            }
    }
    return { shown, places, isMasked };
}

const luma = (pixels, i) => 0.114 * pixels[4 * i] + 0.587 * pixels[4 * i + 1] + 0.299 * pixels[4 * i + 2];

// Mean structural similarity (Wang et al., 2004) in windows of 8 x 8 pixels, 4 pixels apart.
function similarity(a, b, width, height) {
    const C1 = (0.01 * 255) ** 2, C2 = (0.03 * 255) ** 2, x = new Float64Array(width * height).map((_, i) => luma(a, i));
    const y = new Float64Array(width * height).map((_, i) => luma(b, i));
    let sum = 0, count = 0;
    for (let top = 0; top + 8 <= height; top += 4)
        for (let left = 0; left + 8 <= width; left += 4) {
            let sx = 0, sy = 0, xx = 0, yy = 0, xy = 0;
            for (let i = 0; i < 64; i++) {
                const at = (top + (i >> 3)) * width + left + (i & 7), p = x[at], q = y[at];
                sx += p; sy += q; xx += p * p; yy += q * q; xy += p * q;
            }
            const mx = sx / 64, my = sy / 64, vx = xx / 64 - mx * mx, vy = yy / 64 - my * my, both = xy / 64 - mx * my;
            sum += (2 * mx * my + C1) * (2 * both + C2) / ((mx * mx + my * my + C1) * (vx + vy + C2));
            count++;
        }
    return sum / count;
}

const differs = (a, b, i) => [0, 1, 2].some((c) => Math.abs(a[4 * i + c] - b[4 * i + c]) > OFF);

function partOff(a, b, count) {
    let off = 0;
    for (let i = 0; i < count; i++)
        off += differs(a, b, i) ? 1 : 0;
    return off / count;
}

// Returns a mip level with half the width and height, averaged as WebGL does. A level has two values per pixel: brightness and
// the drawn fraction.
function half({ width, height, values }) {
    const out = { width: Math.max(1, width >> 1), height: Math.max(1, height >> 1) };
    const at = (x, y, c) => values[2 * (Math.min(height - 1, y) * width + Math.min(width - 1, x)) + c];
    out.values = new Float64Array(2 * out.width * out.height).map((_, i) => {
        const x = 2 * ((i >> 1) % out.width), y = 2 * Math.floor((i >> 1) / out.width), c = i & 1;
        return (at(x, y, c) + at(x + 1, y, c) + at(x, y + 1, c) + at(x + 1, y + 1, c)) / 4;
    });
    return out;
}

// Returns the mip levels of a reprojected picture; the greys of undrawn areas are computed from them. The first level is a
// linear blit: each of its pixels is the mean of the four in the middle of a square.
function levelsOf(pixels, shown, width, height) {
    const wide = Math.ceil(width / REDUCED), middle = REDUCED / 2, values = new Float64Array(2 * wide * Math.ceil(height / REDUCED));
    for (let i = 0; i < values.length / 2; i++)
        for (const [dx, dy] of [[-1, -1], [0, -1], [-1, 0], [0, 0]]) {
            const x = Math.min(width - 1, (i % wide) * REDUCED + middle + dx);
            const at = Math.min(height - 1, Math.floor(i / wide) * REDUCED + middle + dy) * width + x;
            values[2 * i] += shown[at] < 0 ? 0 : luma(pixels, at) / 4;
            values[2 * i + 1] += shown[at] < 0 ? 0 : 1 / 4;
        }
    const levels = [{ width: wide, height: Math.ceil(height / REDUCED), values }];
    while (levels.at(-1).width > 1 || levels.at(-1).height > 1)
        levels.push(half(levels.at(-1)));
    return levels;
}

// Samples a level at (u, v), 0..1, with linear filtering. Returns [brightness, drawn fraction].
function sample({ width, height, values }, u, v) {
    const x = u * width - 0.5, y = v * height - 0.5, left = Math.floor(x), top = Math.floor(y), p = x - left, q = y - top;
    const most = (value, size) => Math.max(0, Math.min(size - 1, value));
    const at = (i, j, c) => values[2 * (most(j, height) * width + most(i, width)) + c];
    return [0, 1].map((c) => (at(left, top, c) * (1 - p) + at(left + 1, top, c) * p) * (1 - q) +
        (at(left, top + 1, c) * (1 - p) + at(left + 1, top + 1, c) * p) * q);
}

// Returns, for each pixel of the finest level, the grey with which an undrawn area is filled there, and the width of that area,
// computed like the page's shaders.
function greysOf(levels) {
    const { width, height } = levels[0], values = new Float64Array(2 * width * height);
    for (let i = 0; i < width * height; i++) {
        const u = (i % width + 0.5) / width, v = (Math.floor(i / width) + 0.5) / height;
        let sum = 0, part = 0;
        for (let level = 0; level < levels.length && part < 0.98; level++) {
            const [brightness, drawn] = sample(levels[level], u, v);
            sum += (1 - part) * brightness;
            part += (1 - part) * drawn;
        }
        const wide = Math.max(0, Math.min(1, (0.65 - sample(levels[3], u, v)[1]) / 0.3));
        values.set([part > 0 ? sum / part : 128, wide * wide * (3 - 2 * wide)], 2 * i);
    }
    return { width, height, values };
}

function greyAt(greys, x, y, width, height) {
    const [grey, wide] = sample(greys, (x + 0.5) / width, (y + 0.5) / height);
    const line = Math.min((x + y) % LATTICE_PX, (x - y + height * LATTICE_PX) % LATTICE_PX) < 0.1 * LATTICE_PX;
    return grey + (line ? MARK * wide : 0) * (grey > 0.4 * 255 ? -1 : 1);
}

// Returns whether the page's shader mixes two pixels. a, b: their places in `pixels`.
function areAlike(pixels, a, b) {
    const [blue, green, red] = [0, 1, 2].map((c) => pixels[a + c] - pixels[b + c]);
    return Math.abs(red - green) <= LIKE_HUE && Math.abs(green - blue) <= LIKE_HUE
        && Math.max(Math.abs(red), Math.abs(green), Math.abs(blue)) <= LIKE;
}

// Writes the colour of pixel `i` of the warped picture to `out`: a mixture of up to four neighbouring pixels of the first
// picture, as in the page's shader.
function mix({ pixels, width, height }, { grid, shown, places, isMasked }, i, out) {
    const bit = grid.cellPx / grid.maskSide, wide = grid.columns * grid.maskSide, x = places[2 * i] - 0.5, y = places[2 * i + 1] - 0.5;
    const isNear = (column, row) => grid.masks[Math.floor(row / bit) * wide + Math.floor(column / bit)] > 127;
    const own = shown[i], left = Math.floor(x), top = Math.floor(y), ownSide = isNear(own % width, Math.floor(own / width));
    const sum = [0, 0, 0];
    let shares = 0;
    for (let k = 0; k < 4; k++) {
        const column = Math.max(0, Math.min(width - 1, left + (k & 1))), row = Math.max(0, Math.min(height - 1, top + (k >> 1)));
        const share = Math.abs(1 - (k & 1) - x + left) * Math.abs(1 - (k >> 1) - y + top), at = 4 * (row * width + column);
        if (isMasked[i] && isNear(column, row) !== ownSide || !areAlike(pixels, at, 4 * own))
            continue;
        sum.forEach((_, c) => { sum[c] += share * pixels[at + c]; });
        shares += share;
    }
    sum.forEach((value, c) => { out[4 * i + c] = Math.round(value / shares); });
}

function warped(first, drawn) {
    const { pixels, width, height } = first, { shown } = drawn, out = Buffer.alloc(pixels.length);
    for (let i = 0; i < shown.length; i++)
        if (shown[i] >= 0)
            mix(first, drawn, i, out);
    const greys = greysOf(levelsOf(out, shown, width, height));
    for (let i = 0; i < shown.length; i++)
        if (shown[i] < 0)
            out.fill(greyAt(greys, i % width, Math.floor(i / width), width, height), 4 * i, 4 * i + 4);
    return out;
}

const swapped = (pixel) => -0x1000000 | (pixel & 255) << 16 | pixel & 0xff00 | pixel >> 16 & 255; // converts a pixel between BGRX and RGBA

// Draws the first picture from another camera with the page's own rasterizer, as browsers without a GPU do. shown: -1 at pixels
// where the first picture has nothing to show, otherwise 0.
function movedByProcessor({ pixels, width, height }, part, matrix) {
    const source = Int32Array.from(new Int32Array(pixels.buffer, pixels.byteOffset, width * height), swapped);
    const raster = new Raster(width, height);
    raster.clear();
    raster.draw(part, matrix, new Layers(source, width, [part.grid]), { left: 0, top: 0, width, height });
    const shown = raster.pixels.map((pixel) => (pixel === 0 ? -1 : 0));
    raster.fillUndrawn(LATTICE_PX);
    return { shown, pixels: Buffer.from(raster.pixels.map(swapped).buffer) };
}

function movedPicture(first, second) {
    const header = readHeader(first.depth), grid = readGrid(header, inflateRawSync(header.payload)), mesh = meshOf(grid, first);
    const matrix = warpMatrix(grid, first, second, NEAREST / Math.abs(grid.base + grid.levels * grid.unit));
    if (isByProcessor)
        return movedByProcessor(first, { grid, mesh }, matrix);
    const drawn = { grid, ...rasterize(mesh, matrix, grid, first.width, first.height) };
    return { shown: drawn.shown, pixels: warped(first, drawn) };
}

// Returns a function that returns the index of the colour of the map that is most like a pixel, in pictures of the flat look (no
// shading); -1 if no colour of the map is like it.
function reader(map) {
    const known = new Map();
    const find = (red, green, blue) => {
        let best = -1, least = MOST_UNLIKE ** 2;
        for (let i = 0; i < 256; i++) {
            const by = (map[3 * i] - red) ** 2 + (map[3 * i + 1] - green) ** 2 + (map[3 * i + 2] - blue) ** 2;
            [best, least] = by < least ? [i, by] : [best, least];
        }
        return best;
    };
    return (pixels, i) => {
        const [blue, green, red] = pixels.subarray(4 * i, 4 * i + 3), key = red | green << 8 | blue << 16;
        if (!known.has(key))
            known.set(key, find(red, green, blue));
        return known.get(key);
    };
}

// Returns the share of the warped pixels with a colour of the map whose value equals that of the true picture.
function partTrue(moved, second, read) {
    let right = 0, all = 0;
    for (let i = 0; i < moved.shown.length; i++) {
        const seen = moved.shown[i] < 0 ? -1 : read(moved.pixels, i);
        if (seen < 0)
            continue;
        const is = read(second.pixels, i);
        right += is >= 0 && Math.abs(seen - is) <= MOST_ERROR * 255 ? 1 : 0;
        all++;
    }
    return right / all;
}

function crc(bytes) {
    let value = ~0;
    for (const byte of bytes) {
        value ^= byte;
        for (let k = 0; k < 8; k++)
            value = value & 1 ? value >>> 1 ^ 0xedb88320 : value >>> 1;
    }
    return ~value >>> 0;
}

function png(pixels, width, height) {
    const rows = Buffer.alloc(height * (3 * width + 1));
    for (let y = 0; y < height; y++)
        for (let x = 0; x < width; x++)
            for (let c = 0; c < 3; c++)
                rows[y * (3 * width + 1) + 1 + 3 * x + c] = pixels[4 * (y * width + x) + 2 - c];
    const chunk = (type, data) => {
        const body = Buffer.concat([Buffer.from(type), data]), out = Buffer.alloc(body.length + 8);
        out.writeUInt32BE(data.length);
        body.copy(out, 4);
        out.writeUInt32BE(crc(body), body.length + 4);
        return out;
    };
    const head = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0]);
    head.writeUInt32BE(width);
    head.writeUInt32BE(height, 4);
    return Buffer.concat([Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'), chunk('IHDR', head), chunk('IDAT', deflateSync(rows)),
        chunk('IEND', Buffer.alloc(0))]);
}

const read = reader(readFileSync(join(folder, 'colours.rgb')));
const first = load('plain_first'), flat = load('flat_first'), { width, height } = first;
console.log('case       | old picture: SSIM, off | warped: SSIM, off, off where drawn, not yet drawn | values right');
for (const name of CASES) {
    const second = load(`plain_${name}`), moved = movedPicture(first, second), values = load(`flat_${name}`);
    const undrawn = moved.shown.filter((at) => at < 0).length / moved.shown.length;
    let off = 0;
    for (let i = 0; i < moved.shown.length; i++)
        off += moved.shown[i] >= 0 && differs(moved.pixels, second.pixels, i) ? 1 : 0;
    const percent = (part) => `${(100 * part).toFixed(1)} %`.padStart(7);
    const like = (pixels) => similarity(pixels, second.pixels, width, height).toFixed(3);
    const all = (pixels) => percent(partOff(pixels, second.pixels, width * height));
    console.log(`${name.padEnd(10)} | ${like(first.pixels)} ${all(first.pixels)} | ${like(moved.pixels)} ${all(moved.pixels)} ` +
        `${percent(off / moved.shown.length)} ${percent(undrawn)} | ${percent(partTrue(movedPicture(flat, values), values, read))}`);
    writeFileSync(join(folder, `${name}_warped.png`), png(moved.pixels, width, height));
    writeFileSync(join(folder, `${name}_true.png`), png(second.pixels, width, height));
}
writeFileSync(join(folder, 'first.png'), png(first.pixels, width, height));
