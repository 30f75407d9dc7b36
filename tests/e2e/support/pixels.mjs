// SPDX-License-Identifier: GPL-3.0-or-later
// Compares pictures.

// Compares two pictures of equal size. Returns, for each pixel, the largest difference of any of the three colour channels: 0
// to 255.
export function difference(a, b) {
    if (a.width !== b.width || a.height !== b.height)
        throw new Error(`${a.width}x${a.height} is not ${b.width}x${b.height}`);
    const out = new Uint8Array(a.width * a.height);
    for (let i = 0; i < out.length; i++) {
        for (let c = 0; c < 3; c++)
            out[i] = Math.max(out[i], Math.abs(a.rgba[4 * i + c] - b.rgba[4 * i + c]));
    }
    return { width: a.width, height: a.height, at: out };
}

// Takes the result of difference(). Returns its mean over a square around (x, y), leaving out what lies outside the picture.
export function meanAround({ width, height, at }, x, y, radius) {
    let sum = 0, count = 0;
    for (let j = Math.max(0, y - radius); j <= Math.min(height - 1, y + radius); j++) {
        for (let i = Math.max(0, x - radius); i <= Math.min(width - 1, x + radius); i++) {
            sum += at[j * width + i];
            count++;
        }
    }
    return count > 0 ? sum / count : 0;
}

// Takes the result of difference(). Counts the pixels outside the box whose difference exceeds `least`.
export function countOutside({ width, height, at }, least, box) {
    let count = 0;
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) {
            const inside = x >= box.left && x <= box.right && y >= box.top && y <= box.bottom;
            if (!inside && at[y * width + x] > least)
                count++;
        }
    }
    return count;
}

// Returns the spread of the brightness: 0 for a black or empty picture.
export function contrast({ rgba }) {
    let sum = 0, squares = 0;
    const count = rgba.length / 4;
    for (let i = 0; i < rgba.length; i += 4) {
        const grey = (rgba[i] + rgba[i + 1] + rgba[i + 2]) / 3;
        sum += grey;
        squares += grey * grey;
    }
    return Math.sqrt(squares / count - (sum / count) ** 2);
}

const toLinear = (v) => (v <= 10.31475 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
const LINEAR = Float64Array.from({ length: 256 }, (_, v) => toLinear(v));

// Returns the WCAG contrast ratio of two colours: 1 (none) to 21.
export function contrastRatio(a, b) {
    const lights = [a, b].map((rgb) => [0.2126, 0.7152, 0.0722].reduce((sum, k, i) => sum + k * toLinear(rgb[i]), 0.05));
    return Math.max(...lights) / Math.min(...lights);
}

function lab(r, g, b) {
    const linear = [LINEAR[r], LINEAR[g], LINEAR[b]];
    const xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]].map((row, i) =>
        row.reduce((sum, k, c) => sum + k * linear[c], 0) / [0.9505, 1, 1.089][i]);
    const [x, y, z] = xyz.map((t) => (t > 216 / 24389 ? Math.cbrt(t) : (24389 / 27 * t + 16) / 116));
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

// Returns the CIELAB distances (1976) between two pictures: { mean, p99 }.
export function deltaE(a, b) {
    if (a.width !== b.width || a.height !== b.height)
        throw new Error(`${a.width}x${a.height} is not ${b.width}x${b.height}`);
    const all = new Float64Array(a.width * a.height), known = new Map(); // cache: pictures have far fewer colours than pixels
    const at = ({ rgba }, i) => {
        const [r, g, b] = [rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]], key = r << 16 | g << 8 | b;
        if (!known.has(key))
            known.set(key, lab(r, g, b));
        return known.get(key);
    };
    for (let i = 0; i < all.length; i++) {
        const p = at(a, i), q = at(b, i);
        all[i] = Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
    }
    const mean = all.reduce((sum, value) => sum + value, 0) / all.length;
    return { mean, p99: all.sort()[Math.floor(all.length * 0.99)] };
}

// Structural similarity of two pictures of equal size (Wang, Bovik, Sheikh and Simoncelli, 2004), by luma, in windows of 8 x 8
// pixels at every fourth pixel.
export function similarity(a, b) {
    const { width, height } = a, SIDE = 8, STEP = 4, C1 = (0.01 * 255) ** 2, C2 = (0.03 * 255) ** 2;
    const luma = ({ rgba }) => Float64Array.from({ length: width * height }, (_, i) =>
        0.299 * rgba[4 * i] + 0.587 * rgba[4 * i + 1] + 0.114 * rgba[4 * i + 2]);
    const [p, q] = [luma(a), luma(b)], n = SIDE * SIDE;
    let sum = 0, windows = 0;
    for (let top = 0; top + SIDE <= height; top += STEP)
        for (let left = 0; left + SIDE <= width; left += STEP, windows++) {
            let sp = 0, sq = 0, spp = 0, sqq = 0, spq = 0;
            for (let y = top; y < top + SIDE; y++)
                for (let x = left, i = y * width + left; x < left + SIDE; x++, i++) {
                    sp += p[i];
                    sq += q[i];
                    spp += p[i] * p[i];
                    sqq += q[i] * q[i];
                    spq += p[i] * q[i];
                }
            const mp = sp / n, mq = sq / n;
            sum += ((2 * mp * mq + C1) * (2 * (spq / n - mp * mq) + C2)) /
                ((mp * mp + mq * mq + C1) * (spp / n - mp * mp + sqq / n - mq * mq + C2));
        }
    return sum / windows;
}
