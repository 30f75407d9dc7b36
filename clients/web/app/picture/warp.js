// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the newest picture from the present camera until the server's picture of that camera arrives. Draws it on a mesh over
// its depth grid, once per animation frame in which the camera has moved. Places that the picture does not show become grey, as
// light as their surroundings, never coloured; wide ones get a lattice. Loaded together with the camera controller.
import { same } from '../../core/camera.js';
import { hasGpu } from '../../core/gpu.js';
import { depthAt, goneAfter, isNear, moveBy, warpMatrix } from '../../core/warp_mesh.js';
import { isWhole } from '../../core/wire.js';
import { make } from '../common/dom.js';
import { CpuPainter } from './painters/cpu_painter.js';
import { GlPainter } from './painters/gl_painter.js';

const KEPT = 8; // maximum number of stored depth grids: a grid may be decoded before its picture
// distance from the eye to the near clipping plane, as a fraction of the nearest depth that the picture's depth grid can express
const NEAREST = 0.05;
// If the median interval of SLOW_COUNT drawn frames is longer than SLOW_MS, as without a GPU, the warped picture is drawn with
// half as many pixels, but at least LEAST_PX. Intervals of PAUSE_MS or more are pauses and do not count.
const SLOW_MS = 26, SLOW_COUNT = 8, PAUSE_MS = 150, LEAST_PX = 250000;
// If frames are drawn slowly, cameras are sent at this interval in milliseconds while the warped picture is shown. Fewer pictures
// of the server then leave the processor more time to warp them.
const SEND_MS = 80;

const LATE_MS = 1000; // if the worker that decodes depth grids is silent for this long, pictures are shown without waiting for it

const LATTICE_PX = 14;

// Returns true if picture and viewport have the same aspect ratio, but for the rounding of a reduced picture's sides to even
// numbers.
export const hasViewportShape = ({ shownWidth, fullWidth, fullHeight }) =>
    Math.abs(shownWidth - fullWidth) <= 2 + 2 * fullWidth / fullHeight;

const GL = { antialias: false, powerPreference: 'high-performance' };

export class Warp {
    constructor({ session, viewport, modules }) {
        Object.assign(this, { session, viewport, modules, updates: 0, mostPx: Infinity, intervals: [], last: 0, count: 0,
            sentAt: -Infinity });
        // time (performance.now(), milliseconds) since which decoded pictures have waited for the worker that decodes their
        // depth grids; null: they do not wait
        this.waitsFrom = null;
        // newest depth grids, the newest last: { id, depth, parts: [{ grid, mesh }] or null until decoded, fails (true: it
        // cannot be decoded) }
        this.grids = [];
        this.held = null;   // newest frame, decoded but not drawn on the viewport's canvas: { frame, picture }
        this.source = null; // picture that is drawn warped: { picture, camera, parts }
        // loaded: the `source` that the painter (WebGL or processor) has loaded; painted: the one that it has drawn
        this.loaded = this.painted = null;
        this.canvas = make('canvas', { id: 'warp', 'aria-hidden': 'true' });
        this.canvas.style.display = 'none';
        if (!this.open())
            return;
        this.canvas.addEventListener('webglcontextlost', (event) => this.lose(event));
        this.canvas.addEventListener('webglcontextrestored', () => this.regain());
        viewport.canvas.after(this.canvas);
        this.worker = new Worker(new URL('./warp_worker.js', import.meta.url), { type: 'module' });
        this.worker.onmessage = ({ data }) => this.take(data);
        this.worker.onerror = () => this.giveUp();
        viewport.warp = this;
        session.on('frame', (frame) => this.prepare(frame));
        session.on('hello', () => this.forget());
        if (session.picture)
            this.prepare(session.picture);
    }

    // Prepares drawing, with WebGL if there is a GPU. Returns false if WebGL fails; pictures are then shown unwarped.
    open() {
        const { canvas } = this;
        try {
            // WebGL with a GPU, else CpuPainter, which without a GPU is several times as fast as WebGL
            this.usesGl ??= hasGpu(make('canvas'));
            this.painter = this.usesGl ? new GlPainter(canvas.getContext('webgl2', GL)) : new CpuPainter(canvas);
        } catch (error) {
            console.warn(`pictures are not warped: ${error.message}`);
            return false;
        }
        canvas.width = canvas.height = 1; // gives the canvas a valid size until fit() sets the final one
        return true;
    }

    // After the loss of the WebGL context, shows pictures unwarped until the browser restores the context.
    lose(event) {
        event.preventDefault(); // tells the browser to restore WebGL later, which it does not do without this call
        this.hide();
        this.viewport.warp = null;
        this.viewport.invalidate();
    }

    // Warps again after the browser has restored WebGL. Programs, textures and buffers of the lost context do not exist any more.
    regain() {
        this.source = this.loaded = this.painted = null;
        if (!this.canvas.isConnected || !this.open())
            return;
        this.viewport.warp = this;
        this.viewport.invalidate();
    }

    // Shows pictures unwarped from now on, because WebGL or the worker that decodes depth grids fails.
    giveUp() {
        this.hide();
        this.viewport.warp = null;
        this.canvas.remove();
        this.worker.terminate();
        this.viewport.invalidate();
    }

    forget() {
        this.grids = [];
    }

    // Sends the depth grids of a frame to the worker thread that decodes them while the browser decodes the frame.
    prepare({ depth, camera, fullWidth, fullHeight }) {
        if (!depth || this.grids.some((one) => one.depth === depth))
            return;
        const id = ++this.count;
        this.grids = [...this.grids.slice(1 - KEPT), { id, depth, parts: null, fails: false }];
        this.worker.postMessage({ id, messages: depth.messages, frame: { camera, fullWidth, fullHeight } });
    }

    take({ id, parts, why }) {
        const entry = this.grids.find((one) => one.id === id);
        this.waitsFrom = null;
        clearTimeout(this.lateTimer);
        if (!entry)
            return;
        if (parts) {
            entry.parts = parts;
        } else {
            entry.fails = true;
            if (this.why !== why)
                console.warn(this.why = why);
        }
        this.viewport.invalidate();
    }

    get isAhead() {
        const { cameraNews, cameraSeq, picture } = this.session;
        return cameraNews || picture?.cameraSeq !== cameraSeq;
    }

    // Returns true if decoded pictures must wait until the depth grid of the newest picture is decoded. If grids are decoded more slowly
    // than pictures arrive, the newest picture would otherwise never have its grid, so that no camera move could be drawn from it.
    waits(decoded) {
        const newest = decoded.findLast(({ frame }) => !frame.more)?.frame;
        const known = newest?.depth && this.grids.find(({ depth }) => depth === newest.depth);
        if (!known || known.parts || known.fails)
            return false;
        if (this.waitsFrom === null)
            this.lateTimer = setTimeout(() => this.viewport.invalidate(), LATE_MS);
        this.waitsFrom ??= performance.now();
        return performance.now() - this.waitsFrom < LATE_MS;
    }

    // Returns true if the newest picture is to be drawn warped, because the present camera is not the picture's own.
    get isWanted() {
        const { session, source, modules } = this, { picture, camera } = session;
        return source !== null && this.isAhead && session.leader === null && !session.lent && !modules.there('cameraController')?.fly
            && hasViewportShape(picture) && isNear(source.camera, camera);
    }

    // Draws the newest picture from the present camera, or shows the unwarped picture. Called once per animation frame, after new pictures
    // were drawn. now: time in milliseconds. Returns true if the screen changes.
    draw(now = performance.now()) {
        const { session } = this, { picture, camera } = session;
        if (!picture)
            return false;
        picture.ownCamera ??= picture.camera;
        const known = this.grids.find(({ depth }) => depth === picture.depth);
        if (!picture.depth || known?.fails)
            this.source = null;
        else if (known?.parts && this.source?.picture !== picture)
            this.source = { picture, camera: picture.ownCamera, parts: known.parts };
        try {
            if (!this.isWanted || !this.load())
                return !this.fade(now) && this.rest();
            if (this.isShown && this.painted === this.source && same(camera, picture.camera))
                return false;
            this.paint(camera, this.source, 0);
            this.fadeStart = null;
        // WebGL failed while drawing, for example in a browser that does not accept a VideoFrame as a texture: shows pictures
        // unwarped from now on
        } catch (error) {
            console.warn(`pictures are not warped: ${error.message}`);
            this.giveUp();
            return true;
        }
        picture.camera = camera;
        picture.moved = (x, y) => this.moved(x, y);
        this.updates++;
        return true;
    }

    // Keeps a decoded frame that will be shown warped, so that it need not be drawn on the viewport's canvas. Returns false if it must be
    // drawn there.
    hold(decoded) {
        if (isWhole(decoded.frame))
            this.held?.picture.close();
        else
            this.putHeld();
        this.held = this.isShown && isWhole(decoded.frame) ? decoded : null;
        return this.held !== null;
    }

    // Fades from the warped picture to the server's picture of the same camera. Returns false if the fade is complete, or not possible.
    fade(now) {
        const { session: { picture }, painted, isShown, viewport } = this;
        if (!isShown || painted !== this.loaded || painted.picture === picture || this.isAhead)
            return false;
        this.putHeld();
        Object.assign(picture, { camera: picture.ownCamera, moved: null });
        this.fadeStart ??= now;
        const gone = goneAfter(now - this.fadeStart);
        if (gone === 1)
            return false;
        this.paint(painted.seenFrom, painted, gone);
        viewport.invalidate();
        return true;
    }

    putHeld() {
        if (this.held)
            this.viewport.put(this.held);
        this.held = null;
    }

    hide() {
        this.putHeld();
        const { picture } = this.session;
        if (picture?.ownCamera)
            Object.assign(picture, { camera: picture.ownCamera, moved: null });
        if (!this.isShown)
            return false;
        this.isShown = false;
        this.fadeStart = null;
        this.canvas.style.display = 'none';
        return true;
    }

    // Shows the unwarped picture. Loads it into the painter if the user is expected to move the camera, so that the first move is drawn
    // sooner. Returns true if the screen changes.
    rest() {
        const changes = this.hide();
        if (this.source && this.modules.there('cameraController')?.gestures.expectsMove(performance.now()))
            this.load();
        return changes;
    }

    // Loads the newest picture and its mesh into the painter that draws warped pictures (GlPainter or CpuPainter). Returns
    // false if the viewport's canvas, from which the pixels are read, no longer shows that picture.
    load() {
        const { source, session, viewport, held } = this;
        if (source === this.loaded)
            return true;
        if (source.picture !== session.picture)
            return false;
        this.painter.load(held?.frame.seq === source.picture.seq ? held.picture : viewport.canvas, source.parts);
        this.loaded = source;
        return true;
    }

    // Returns true if the session's newest camera is to be sent later; the viewport is then asked for another frame by that time.
    holdsCamera(now) {
        const { session, viewport } = this;
        clearTimeout(this.sending);
        if (!session.cameraNews)
            return false;
        const wait = this.isShown && this.mostPx < Infinity && this.isWanted ? this.sentAt + SEND_MS - now : 0;
        if (wait > 0)
            this.sending = setTimeout(() => viewport.invalidate(), wait);
        else
            this.sentAt = now;
        return wait > 0;
    }

    // Chooses the size of the warped drawing: that of the picture, or less if frames are drawn slowly.
    fit({ fullWidth, fullHeight }) {
        const now = performance.now(), interval = now - this.last, { canvas } = this;
        this.last = now;
        if (interval < PAUSE_MS)
            this.intervals.push(interval);
        if (this.intervals.length >= SLOW_COUNT) {
            const middle = this.intervals.sort((a, b) => a - b)[SLOW_COUNT >> 1];
            this.intervals = [];
            if (middle > SLOW_MS)
                this.mostPx = Math.max(LEAST_PX, canvas.width * canvas.height / 2);
        }
        // sets the exact aspect ratio, because a reduced width and height are rounded
        canvas.style.aspectRatio = `${fullWidth} / ${fullHeight}`;
        const scale = Math.min(1, Math.sqrt(this.mostPx / (fullWidth * fullHeight)));
        const [width, height] = [fullWidth, fullHeight].map((px) => Math.round(px * scale));
        if (canvas.width !== width || canvas.height !== height)
            this.painter.resize(width, height);
    }

    // Draws the picture as the present camera sees it. gone: fraction of the pixels left out, where the canvas below shows
    // through.
    paint(camera, source, gone) {
        const { canvas, painter, session } = this, { picture, parts } = source, { fullWidth, fullHeight } = picture;
        this.fit(picture);
        const across = canvas.width / fullWidth, up = canvas.height / fullHeight;
        const boxes = parts.map((part) => {
            const { x, y, width, height, base, levels, unit } = part.grid;
            const closest = Math.max(1e-6, base + levels * unit); // largest 1/depth that this depth grid can express, in 1/m
            part.matrix = warpMatrix(part.grid, source.camera, camera, NEAREST / closest);
            return { left: x * across, top: y * up, width: width * across, height: height * up };
        });
        painter.paint(parts.map(({ matrix }) => matrix), boxes,
            LATTICE_PX * window.devicePixelRatio * canvas.height / session.size.height, gone, this.viewport.canvas);
        this.isShown = true;
        this.painted = Object.assign(source, { seenFrom: camera });
        canvas.style.display = '';
    }

    // Returns where a pixel of the picture appears in the warped picture, [x, y]; null: nowhere.
    moved(x, y) {
        const part = this.source?.parts.find(({ grid }) => x >= grid.x && x < grid.x + grid.width);
        const depth = part && depthAt(part.grid, x - part.grid.x, y - part.grid.y);
        const at = part?.matrix && depth !== null ? moveBy(part.matrix, part.grid, [x - part.grid.x, y - part.grid.y, depth]) : null;
        return at && [at[0] + part.grid.x, at[1] + part.grid.y];
    }
}
