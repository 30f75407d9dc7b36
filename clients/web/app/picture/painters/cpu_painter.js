// SPDX-License-Identifier: GPL-3.0-or-later
// Draws warped pictures by the processor, for warp.js in browsers that have no GPU.
import { make } from '../../common/dom.js';
import { Layers, Raster } from '../../../core/warp_raster.js';

export class CpuPainter {
    constructor(canvas) {
        this.canvas = canvas;
        // opaque, because browsers without a GPU then need not draw what the canvas covers
        this.context = canvas.getContext('2d', { alpha: false });
        this.scratch = make('canvas');
        this.copy = this.scratch.getContext('2d', { willReadFrequently: true });
    }

    // Sets the size of the drawing.
    resize(width, height) {
        Object.assign(this.canvas, { width, height });
        this.raster = new Raster(width, height);
        this.image = new ImageData(new Uint8ClampedArray(this.raster.pixels.buffer), width, height);
    }

    // Returns the context of the scratch canvas, which gets this size.
    copyOf(width, height) {
        if (this.scratch.width !== width || this.scratch.height !== height)
            Object.assign(this.scratch, { width, height });
        return this.copy;
    }

    // Reads the pixels of a picture.
    load(picture, parts) {
        const width = picture.displayWidth ?? picture.width, height = picture.displayHeight ?? picture.height;
        const copy = this.copyOf(width, height);
        copy.drawImage(picture, 0, 0);
        this.layers = new Layers(new Int32Array(copy.getImageData(0, 0, width, height).data.buffer), width, parts.map(({ grid }) => grid));
        this.parts = parts;
    }

    // Draws the loaded picture, as GlPainter does. below: canvas that shows where pixels are left out.
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
        context.imageSmoothingEnabled = false; // a mixture of two colours would be read as the value between them
        context.drawImage(below, 0, 0, width, height);
        context.drawImage(this.scratch, 0, 0);
    }
}
