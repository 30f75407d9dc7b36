// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels of 8-bit PNG files, and of pictures sent in parts.
import { inflateSync } from 'node:zlib';
import { chunksOf } from './png_chunks.mjs';

const CHANNELS = { 0: 1, 2: 3, 4: 2, 6: 4 };

function paeth(a, b, c) {
    const p = a + b - c, [pa, pb, pc] = [Math.abs(p - a), Math.abs(p - b), Math.abs(p - c)];
    return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

// Returns { width, height, rgb }: three bytes per pixel, rows from the top.
export function pixelsOf(png) {
    const chunks = chunksOf(Buffer.from(png)), header = chunks.find(({ type }) => type === 'IHDR').data;
    const [width, height, depth, kind] = [header.readUInt32BE(0), header.readUInt32BE(4), header[8], header[9]], n = CHANNELS[kind];
    if (depth !== 8 || !(n >= 3) || header[12] !== 0)
        throw new Error(`PNG of ${depth} bits and kind ${kind}`);
    const raw = inflateSync(Buffer.concat(chunks.filter(({ type }) => type === 'IDAT').map(({ data }) => data)));
    const row = width * n, rgb = Buffer.alloc(width * height * 3);
    let before = Buffer.alloc(row);
    for (let y = 0; y < height; y++) {
        const filter = raw[y * (row + 1)], now = Buffer.from(raw.subarray(y * (row + 1) + 1, (y + 1) * (row + 1)));
        for (let i = 0; i < row && filter > 0; i++) {
            const a = i >= n ? now[i - n] : 0, b = before[i], c = i >= n ? before[i - n] : 0;
            now[i] += [0, a, b, (a + b) >> 1, paeth(a, b, c)][filter];
        }
        for (let x = 0; x < width; x++)
            now.copy(rgb, (y * width + x) * 3, x * n, x * n + 3);
        before = now;
    }
    return { width, height, rgb };
}

// The picture that a client with the codec "png" shows: draw() adds each received frame, a whole picture or a part of it.
export class Canvas {
    constructor() {
        Object.assign(this, { width: 0, height: 0, rgb: Buffer.alloc(0) });
    }

    draw(frame) {
        const { width, height, rgb } = pixelsOf(frame.payload);
        const { full_width: fullWidth, full_height: fullHeight } = frame;
        if (this.width !== fullWidth || this.height !== fullHeight)
            Object.assign(this, { width: fullWidth, height: fullHeight, rgb: Buffer.alloc(fullWidth * fullHeight * 3) });
        for (let y = 0; y < height; y++)
            rgb.copy(this.rgb, ((frame.y + y) * this.width + frame.x) * 3, y * width * 3, (y + 1) * width * 3);
    }

    // Returns how many of this picture's pixels differ from the picture `whole`; this picture's top left corner lies at (x, y)
    // in it.
    differsFrom(whole, x, y) {
        let count = 0;
        for (let row = 0; row < this.height; row++) {
            const here = row * this.width * 3, there = ((y + row) * whole.width + x) * 3, bytes = this.width * 3;
            if (this.rgb.compare(whole.rgb, there, there + bytes, here, here + bytes) === 0)
                continue;
            for (let i = 0; i < bytes; i += 3)
                count += this.rgb.compare(whole.rgb, there + i, there + i + 3, here + i, here + i + 3) !== 0;
        }
        return count;
    }
}
