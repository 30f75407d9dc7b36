// SPDX-License-Identifier: GPL-3.0-or-later
// The server's own patterns for "no data" and "uncertain", for the legend.

const HATCH_LIGHT = '#d6d6d6', HATCH_DARK = '#8c8c8c', STIPPLE = '#1e1e1e';

export function drawHatch(c, width, height) {
    const image = c.createImageData(width, height);
    const light = [214, 214, 214], dark = [140, 140, 140];
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++)
            image.data.set([...((x + y) % 8 < 3 ? dark : light), 255], 4 * (y * width + x));
    }
    c.putImageData(image, 0, 0);
}

export function drawStipple(c, width, height, ratio, colour) {
    c.fillStyle = colour;
    c.fillRect(0, 0, width, height);
    c.fillStyle = STIPPLE;
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) {
            if (x % 4 === 0 && y % 4 === 0)
                c.fillRect(x, y, 1, 1);
        }
    }
}
