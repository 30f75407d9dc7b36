// SPDX-License-Identifier: GPL-3.0-or-later
// Comparing pictures.

// Largest difference of a channel at each pixel, as one byte per pixel.
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

// Mean over a square around a place, of what lies in the picture.
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

// How many pixels differ by more than `least`, outside of a box.
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

// Spread of the brightness: a black or an empty picture has none.
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
