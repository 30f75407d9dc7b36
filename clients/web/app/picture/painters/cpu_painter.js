// SPDX-License-Identifier: GPL-3.0-or-later
// Draws warped pictures on the processor, for warp.js in browsers without a GPU.
import { make } from '../../common/dom.js';
import { Layers, Raster } from '../../../core/warp_raster.js';

export class CpuPainter {
    constructor(canvas) {
        this.canvas = canvas;
        // an opaque canvas: a browser without a GPU, which draws slowly, then need not draw what lies below it
        this.context = canvas.getContext('2d', { alpha: false });
        this.scratch = make('canvas');
        this.copy = this.scratch.getContext('2d', { willReadFrequently: true });
    }

    // Sets the size of the canvas in pixels.
    resize(width, height) {
        Object.assign(this.canvas, { width, height });
        this.raster = new Raster(width, height);
        this.image = new ImageData(new Uint8ClampedArray(this.raster.pixels.buffer), width, height);
    }

    // Sets the size of the hidden canvas and returns its 2D context. load() reads a picture's pixels through that canvas;
    // paint() draws the warped pixels on it before it combines them with the picture below.
    copyOf(width, height) {
        if (this.scratch.width !== width || this.scratch.height !== height)
            Object.assign(this.scratch, { width, height });
        return this.copy;
    }

    // Reads the pixels of a picture. parts: depth grid and mesh of each half of a split view, or of the whole picture.
    load(picture, parts) {
        const width = picture.displayWidth ?? picture.width, height = picture.displayHeight ?? picture.height;
        const copy = this.copyOf(width, height);
        copy.drawImage(picture, 0, 0);
        this.layers = new Layers(new Int32Array(copy.getImageData(0, 0, width, height).data.buffer), width, parts.map(({ grid }) => grid));
        this.parts = parts;
    }

    // Draws the loaded picture from another camera. gone: fraction of the pixels left out, in a dither pattern, while the
    // picture fades out; there the canvas `below` shows through.
    paint(matrices, boxes, period, gone, below) {
        const { raster, layers, context, image, canvas: { width, height } } = this;
        raster.clear();
        this.parts.forEach((part, i) => raster.draw(part, matrices[i], layers, boxes[i]));
        raster.fillUndrawn(period);
        if (gone === 0) {
            context.putImageData(image, 0, 0);
            return;
        }
        raster.leaveOut(gone);
        this.copyOf(width, height).putImageData(image, 0, 0);
        // draws pixels unmixed when it scales the picture, because users would read a mixture of two colours as the value
        // between them
        context.imageSmoothingEnabled = false;
        context.drawImage(below, 0, 0, width, height);
        context.drawImage(this.scratch, 0, 0);
    }
}
