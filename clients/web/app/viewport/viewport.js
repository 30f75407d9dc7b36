// SPDX-License-Identifier: GPL-3.0-or-later
// The picture on the screen: requests pictures of the right size, decodes them, draws them in step with the display, and acknowledges those
// it has drawn.
import { DecodeQueue } from '../../core/decode_queue.js';
import { isWhole, pictureSize } from '../../core/wire.js';

const RESIZE_WAIT_MS = 100;
// Converts a length in CSS pixels to device pixels. `exact`: the browser's own measurement. It is ignored if it is more than 2
// pixels off, because on emulated screens it leaves out page zoom.
function devicePixels(cssPx, exact) {
    const px = Math.round(cssPx * window.devicePixelRatio);
    return exact !== undefined && Math.abs(exact - px) <= 2 ? exact : px;
}

const sizeOf = (width, height) => ({ ...pictureSize(width, height), pixel_ratio: Math.min(8, Math.max(0.25, window.devicePixelRatio)) });

export class Viewport {
    // onTick(now) is called once per animation frame, before drawing; onDrawn(isNew, isWarped) after drawing. isNew: a new picture was
    // drawn; isWarped: the screen has changed without a new picture (../picture/warp.js).
    constructor({ element, canvas, session, decoding }) {
        Object.assign(this, { element, canvas, session });
        this.context = canvas.getContext('2d', { alpha: false });
        this.decoded = []; // decoded frames not drawn yet: whole pictures, and rectangles of an incomplete picture
        this.scheduled = false;
        this.warp = null; // draws the newest picture from the present camera (a Warp, ../picture/warp.js); null: not loaded yet
        this.onTick = this.onDrawn = () => {};
        this.slot = new DecodeQueue({
            decode: (frame) => decoding.decode(frame),
            ready: (frame, picture, decodeMs) => this.ready(frame, picture, decodeMs),
            failed: (frame, error) => {
                console.warn(`frame ${frame.seq}: ${error.message}`);
                session.passedOver(frame);
            },
            now: () => performance.now(),
        });
        decoding.onLost = () => session.askKeyFrame();
        decoding.onCodecs = (codecs) => session.setCodecs(codecs);
        session.on('frame', (frame) => this.slot.push(frame));
        this.watchSize();
    }

    // Size in CSS pixels.
    get width() {
        return this.element.clientWidth;
    }

    get height() {
        return this.element.clientHeight;
    }

    // Converts CSS pixels of the viewport to pixels of the requested picture.
    pixelOf(x, y) {
        const size = this.session.following ?? this.session.size;
        return [(x * size.width) / this.width, (y * size.height) / this.height];
    }

    watchSize() {
        const box = this.element.getBoundingClientRect();
        this.session.resize(sizeOf(devicePixels(box.width), devicePixels(box.height)));
        let timer;
        this.observer = new ResizeObserver(([entry]) => {
            const exact = entry.devicePixelContentBoxSize?.[0];
            const width = devicePixels(entry.contentRect.width, exact?.inlineSize);
            const height = devicePixels(entry.contentRect.height, exact?.blockSize);
            clearTimeout(timer);
            timer = setTimeout(() => this.session.resize(sizeOf(width, height)), RESIZE_WAIT_MS);
            this.invalidate();
        });
        this.measure();
    }

    // Measures the viewport, and requests pictures of its size. Called at the start and after changes of the pixel ratio; changes of the
    // size in CSS pixels are noticed without a call.
    measure() {
        const { element, observer } = this;
        observer.disconnect(); // an observer reports an element that it observes already only if the element's size changes
        try {
            observer.observe(element, { box: 'device-pixel-content-box' });
        } catch {
            observer.observe(element); // Safari does not support device-pixel-content-box
        }
    }

    ready(frame, picture, decodeMs) {
        if (isWhole(frame)) {
            for (const older of this.decoded)
                older.picture.close();
            this.decoded = [];
        }
        this.decoded.push({ frame, picture, decodeMs });
        if (!frame.more)
            this.invalidate();
    }

    // Drops queued frames when the connection is lost, because a new connection restarts the frame numbers.
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
            if (!this.warp?.holdsCamera(now))
                this.session.flush();
            this.draw();
        });
    }

    // Draws one frame on the canvas.
    put({ frame, picture }) {
        if (this.canvas.width !== frame.fullWidth || this.canvas.height !== frame.fullHeight) {
            this.canvas.width = frame.fullWidth;
            this.canvas.height = frame.fullHeight;
        }
        // crops the decoded picture, which may exceed the frame by one pixel on the right and below
        const { x, y, width, height } = frame;
        this.context.drawImage(picture, 0, 0, width, height, x, y, width, height);
        picture.close();
    }

    // Draws the pictures that are complete; rectangles wait for the rest of their picture. A picture whose aspect ratio differs
    // from the viewport's is scaled to its height without distortion. picture.shownWidth: the viewport's width in pixels of the
    // picture.
    draw() {
        const complete = this.decoded.findLastIndex(({ frame }) => !frame.more) + 1;
        const drawn = this.warp?.waits(this.decoded) ? [] : this.decoded.splice(0, complete);
        for (const decoded of drawn)
            if (!this.warp?.hold(decoded))
                this.put(decoded);
        let decodeMs = 0;
        for (const { frame, decodeMs: ms } of drawn) {
            decodeMs += ms;
            if (frame.more)
                continue;
            this.session.drawn(frame, decodeMs);
            decodeMs = 0;
        }
        const { picture, shown } = this.session;
        if (picture)
            picture.shownWidth = shown.split ? picture.fullWidth : (picture.fullHeight * this.width) / this.height;
        this.onDrawn(drawn.length > 0, this.warp?.draw() ?? false);
    }
}
