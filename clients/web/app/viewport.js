// SPDX-License-Identifier: GPL-3.0-or-later
// The picture on the screen: asks for the right size, decodes, draws in step with the display, acknowledges what was drawn.
import { DecodeSlot } from '../core/slot.js';
import { isWhole, pictureSize } from '../core/wire.js';

const RESIZE_WAIT_MS = 100;
const MIME = { jpeg: 'image/jpeg', png: 'image/png' };

function decode(frame) {
    const type = MIME[frame.codec];
    if (!type)
        return Promise.reject(new Error(`codec ${frame.codec} was not asked for`));
    return createImageBitmap(new Blob([frame.payload], { type }));
}

// What the browser states exactly, unless it leaves out the page's zoom, as emulated screens do.
function devicePixels(cssPx, exact) {
    const px = Math.round(cssPx * window.devicePixelRatio);
    return exact !== undefined && Math.abs(exact - px) <= 2 ? exact : px;
}

export class Viewport {
    // onTick(now): once per animation frame, before drawing. onDrawn(frame): after.
    constructor({ element, canvas, session }) {
        Object.assign(this, { element, canvas, session });
        this.context = canvas.getContext('2d', { alpha: false });
        this.decoded = [];
        this.scheduled = false;
        this.onTick = this.onDrawn = () => {};
        this.slot = new DecodeSlot({
            decode,
            ready: (frame, picture, decodeMs) => this.ready(frame, picture, decodeMs),
            failed: (frame, error) => console.warn(`frame ${frame.seq}: ${error.message}`),
            now: () => performance.now(),
        });
        session.on('frame', (frame) => this.slot.push(frame));
        this.watchSize();
    }

    // CSS pixels.
    get width() {
        return this.element.clientWidth;
    }

    get height() {
        return this.element.clientHeight;
    }

    watchSize() {
        const box = this.element.getBoundingClientRect();
        this.session.resize(pictureSize(devicePixels(box.width), devicePixels(box.height)));
        let timer;
        const observer = new ResizeObserver(([entry]) => {
            const exact = entry.devicePixelContentBoxSize?.[0];
            const width = devicePixels(entry.contentRect.width, exact?.inlineSize);
            const height = devicePixels(entry.contentRect.height, exact?.blockSize);
            clearTimeout(timer);
            timer = setTimeout(() => this.session.resize(pictureSize(width, height)), RESIZE_WAIT_MS);
            this.invalidate();
        });
        try {
            observer.observe(this.element, { box: 'device-pixel-content-box' });
        } catch {
            observer.observe(this.element); // Safari
        }
    }

    ready(frame, picture, decodeMs) {
        if (isWhole(frame)) {
            for (const older of this.decoded)
                older.picture.close();
            this.decoded = [];
        }
        this.decoded.push({ frame, picture, decodeMs });
        this.invalidate();
    }

    // The connection is gone: what still waits belongs to its numbering.
    forget() {
        this.slot.clear();
        for (const { picture } of this.decoded)
            picture.close();
        this.decoded = [];
    }

    invalidate() {
        if (this.scheduled)
            return;
        this.scheduled = true;
        requestAnimationFrame((now) => {
            this.scheduled = false;
            this.onTick(now);
            this.session.flush();
            this.draw();
        });
    }

    draw() {
        const drawn = this.decoded;
        this.decoded = [];
        for (const { frame, picture } of drawn) {
            if (this.canvas.width !== frame.fullWidth || this.canvas.height !== frame.fullHeight) {
                this.canvas.width = frame.fullWidth;
                this.canvas.height = frame.fullHeight;
            }
            this.context.drawImage(picture, frame.x, frame.y, frame.width, frame.height);
            picture.close();
        }
        for (const { frame, decodeMs } of drawn)
            this.session.drawn(frame, decodeMs);
        this.onDrawn(drawn.length > 0);
    }
}
