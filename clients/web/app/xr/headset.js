// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the plant on a headset: asks the server for a wide picture with depth from the head's position, and draws both eyes' views from it
// at the headset's own frame rate and pose.
import { isParallel } from '../../core/camera.js';
import { toPerspective } from '../../core/camera_moves.js';
import { eyeOf, headCamera, isApart, poseOf, rigFor, STAND_M, wideView } from '../../core/headset_views.js';
import { health } from '../../core/health.js';
import { along, cross, length, subtract, unit } from '../../core/vector.js';
import { learnWords, say } from '../../core/words.js';
import { clock } from '../common/clock.js';
import { make } from '../common/dom.js';
import { Board, showBanner, showColour, showLegend, showMarker } from './boards.js';
import { Hands } from './hands.js';
import { Painter } from './painter.js';

const FARTHEST_M = 2.5; // distance in metres of the head from the picture's camera beyond which the picture is not shown
const TEXT_MS = 250; // interval in milliseconds of the checks for changed texts in the headset's view
const LATE_MS = 1000; // time in milliseconds after which a missing picture is reported
const LEGEND = { metres: 1.3, pitchDeg: 28 }, BANNER_M = 1.3, MARKER_PX = 32, MOST_MARKERS = 150;
const STALE = ['lost', 'silent'], GRAVE = [...STALE, 'nodata'];

// current: the Headset in use; isListening: the events of the page's session are handled. Handlers are added only once, because a session
// cannot remove them.
let current = null, isListening = false;
function listenTo(session) {
    if (isListening)
        return;
    isListening = true;
    session.on('picked', (picked) => current?.hands.hear(picked));
    session.on('tags', () => current?.hands.ask());
    session.on('welcome', () => current?.onWelcome());
    session.on('denied', () => current?.xr.end().catch(() => {})); // ends the session: without access, the headset must show nothing
}

export class Headset {
    constructor({ xr, session, viewport, modules }) {
        Object.assign(this, { xr, session, viewport, modules, ended: false, rig: null, wide: null, sent: null, isNear: false, frames: 0 });
        this.shown = null; // picture that the eyes show
        this.shownAt = this.nearAt = this.builtAt = clock.now();
        this.markers = [];
        xr.addEventListener('end', () => this.leave());
    }

    async begin() {
        const { xr } = this, canvas = make('canvas', {});
        const gl = canvas.getContext('webgl2', { xrCompatible: true, antialias: true });
        if (!gl)
            throw new Error('WebGL 2');
        canvas.addEventListener('webglcontextlost', () => xr.end().catch(() => {}));
        await Promise.all([gl.makeXRCompatible?.(), learnWords()]);
        this.painter = new Painter(gl, this.session.shown.backdrop);
        xr.updateRenderState({ baseLayer: new XRWebGLLayer(xr, gl) });
        [this.space, this.floorM] = await xr.requestReferenceSpace('local-floor').then((space) => [space, 0],
            async () => [await xr.requestReferenceSpace('local'), STAND_M]);
        this.legend = new Board(this.painter, 1250, 300);
        this.banner = new Board(this.painter, 1150, 440);
        this.veil = new Board(this.painter, 4, 4);
        showColour(this.veil, 'rgb(110 110 110 / 94%)');
        this.marks = new Map(); // canvases with a sensor marker, by the reading's quality and the alarm
        this.hands = new Hands(this);
        xr.addEventListener('select', ({ inputSource }) => this.hands.pull(inputSource));
        xr.addEventListener('squeezestart', ({ inputSource }) => this.hands.grab(inputSource));
        xr.addEventListener('squeezeend', () => this.hands.grab(null));
        xr.addEventListener('visibilitychange', () => this.session.setVisible(xr.visibilityState !== 'hidden'));
        if (this.ended)
            throw new Error(say('xr.gone'));
        this.borrow();
        this.next = (_, frame) => this.draw(frame);
        xr.requestAnimationFrame(this.next);
    }

    // Takes over the page's session with the server. The page draws nothing until leave().
    borrow() {
        const { session, viewport } = this, { camera, model, params } = session;
        const seen = isParallel(camera) ? toPerspective(camera) : camera;
        if (!viewport.warp)
            throw new Error(say('xr.flat.why'));
        this.identity = model.identity;
        this.rig = rigFor(seen, model.plant.bounds, model.plant.up);
        this.rig.at = along(this.rig.at, this.rig.axes[1], this.floorM);
        this.before = { camera, size: session.size, split: params.split ?? null, onDrawn: viewport.onDrawn, warp: viewport.warp,
            picture: session.picture };
        viewport.warp?.hide();
        this.modules.there('place')?.close(); // closes the card of a point, because its pick requests would replace those of the hands
        const warp = { hold: () => false, holdsCamera: () => false, draw: () => false, waits: () => !this.isDecoded(clock.now()) };
        Object.assign(viewport, { warp, onDrawn: () => {}, invalidate: () => {} });
        session.resize = (size) => { this.before.size = size; };
        if (params.split)
            session.setParams({ split: null });
        listenTo(session);
        current = this;
    }

    // Gives the session back: the page shows what it showed before the headset.
    leave() {
        if (this.ended)
            return;
        this.ended = true;
        if (!this.before)
            return;
        current = null;
        const { session, viewport, before } = this;
        delete viewport.invalidate;
        delete session.resize;
        Object.assign(viewport, { onDrawn: before.onDrawn, warp: viewport.warp && before.warp });
        session.setVisible(!document.hidden);
        // gives up the WebGL context, which frees its GPU memory at once
        this.painter.gl.getExtension('WEBGL_lose_context')?.loseContext();
        session.resize(before.size);
        if (before.split)
            session.setParams({ split: before.split });
        if (session.model?.identity === this.identity)
            session.setCamera(before.camera);
        viewport.invalidate();
    }

    // Ends the headset's session if the server now shows another plant, where the user's position would have no meaning.
    onWelcome() {
        this.hands.forget();
        if (this.session.model.identity !== this.identity || !this.session.reprojects)
            this.xr.end().catch(() => {});
    }

    // Draws one frame for the headset.
    draw(frame) {
        const { xr, session, viewport, painter } = this;
        if (this.ended)
            return;
        xr.requestAnimationFrame(this.next);
        const pose = frame.getViewerPose(this.space);
        if (!pose)
            return; // draws nothing while the headset does not know its pose: the headset then shows a warning of its own
        this.head = pose.transform.matrix;
        this.hands.move(frame);
        this.aim(pose);
        session.flush();
        viewport.draw();
        const now = clock.now();
        this.take(now);
        this.isNear = this.shown !== null && length(subtract(this.shown.camera.eye, poseOf(this.rig, this.head).at)) < FARTHEST_M;
        this.nearAt = this.isNear ? now : this.nearAt;
        const boards = this.boards(now), layer = xr.renderState.baseLayer;
        painter.clear(layer.framebuffer);
        for (const view of pose.views) {
            const { x, y, width, height } = layer.getViewport(view), eye = eyeOf(this.rig, view);
            painter.gl.viewport(x, y, width, height);
            painter.drawUndrawn(eye);
            if (this.isNear)
                painter.drawPicture(eye);
            painter.drawBoards(eye, boards);
        }
        this.frames++;
    }

    // Requests a picture for the head's pose, unless the picture requested last is good enough.
    aim({ transform: { matrix }, views }) {
        const { session } = this, { height } = this.xr.renderState.baseLayer.getViewport(views[0]);
        const shape = views.map(({ projectionMatrix }) => [...projectionMatrix]).join() + height;
        if (this.shape !== shape) {
            this.shape = shape;
            this.wide = wideView(matrix, views, height);
            Object.getPrototypeOf(session).resize.call(session, { width: this.wide.width, height: this.wide.height, pixel_ratio: 1 });
        }
        const camera = headCamera(this.rig, matrix, this.wide.fov);
        if (!this.sent || session.camera !== this.sent || isApart(this.sent, camera)) {
            session.setCamera(camera);
            this.sent = session.camera;
            // counts as user activity, so that the server does not sign out a user who only moves the head
            session.connection.activeAt = Date.now();
        }
    }

    // Returns a picture's decoded depth grids in the form that ../picture/warp.js stores; undefined: unknown.
    gridsOf({ depth }) {
        return depth ? this.before.warp?.grids.find((one) => one.depth === depth) : undefined;
    }

    // Returns true if the new pictures may be drawn: their meshes are built, or LATE_MS has passed without them. Until then the
    // pictures are neither drawn nor acknowledged, so the server waits.
    isDecoded(now) {
        const isBuilt = this.viewport.decoded.every(({ frame }) => {
            const grids = this.gridsOf(frame);
            return !grids || grids.parts || grids.fails;
        });
        if (isBuilt)
            this.builtAt = now;
        return isBuilt || now - this.builtAt > LATE_MS;
    }

    // Returns true if the headset still shows an older picture LATE_MS after the last change, because the newest picture has no usable
    // depth grid.
    isFlat(now) {
        const { session: { picture }, shown, before } = this;
        return picture && picture !== shown && picture !== before.picture && now - this.shownAt > LATE_MS;
    }

    // Gives a new picture and its depth grid to the painter, which draws the eyes' views from it (painter.js).
    take(now) {
        const { session: { picture }, painter, viewport } = this, [part, other] = (picture && this.gridsOf(picture)?.parts) || [];
        if (!part || other || picture.camera.fov === 0 || picture === this.shown)
            return;
        painter.take(viewport.canvas, part, picture.camera);
        Object.assign(this, { shown: picture, shownAt: now });
        this.find();
    }

    // Finds the sensor markers of the picture, the nearest first.
    find() {
        const { session, shown } = this, { model } = session, marks = session.markersOf(shown.seq);
        this.markers = model.tags.filter(({ position, index }) => position && marks?.has(`${index}/0`) && !marks.get(`${index}/0`).occluded)
            .map((tag) => ({ tag, away: length(subtract(tag.position, shown.camera.eye)) }))
            .filter(({ tag }) => tag.group === session.params.group || model.alarms.gravest(tag.index))
            .sort((a, b) => a.away - b.away).slice(0, MOST_MARKERS);
    }

    mark(tag) {
        const { model } = this.session, alarm = model.alarms.gravest(tag.index), { quality } = model.readings[tag.index];
        const key = `${quality} ${alarm?.priority} ${alarm?.state}`;
        if (!this.marks.has(key))
            this.marks.set(key, showMarker(new Board(this.painter, 2 * MARKER_PX, 2 * MARKER_PX), quality, alarm));
        return this.marks.get(key);
    }

    // Returns the axes of a rectangle (a text or marker in the headset's view) at a position, so that it faces the head.
    facing(at) {
        const { at: eye, axes: [, up] } = poseOf(this.rig, this.head), z = unit(subtract(eye, at));
        const x = unit(cross(up, z));
        return [x, cross(z, x), z];
    }

    // Returns a position that moves with the head, `pitchDeg` below the middle of the view.
    beforeHead(metres, pitchDeg) {
        const { at, axes: [, up, back] } = poseOf(this.rig, this.head), angle = pitchDeg * Math.PI / 180;
        return along(along(at, back, -metres * Math.cos(angle)), up, -metres * Math.sin(angle));
    }

    // Returns all rectangles with texts, markers and rays to draw in the headset's view, the nearest last.
    boards(now) {
        const { session, rig, head } = this, eye = poseOf(rig, head).at, list = [];
        if (this.checkedAt === undefined || now - this.checkedAt >= TEXT_MS) {
            this.checkedAt = now;
            this.state = health(session, now);
            this.warning = this.warningOf(now);
            showLegend(this.legend, session, this.state, this.warning, now);
            if (this.warning)
                showBanner(this.banner, ...this.warning);
        }
        const isStale = STALE.includes(this.state.kind) || this.isFlat(now);
        if (this.isNear && !isStale)
            for (const { tag } of this.markers)
                list.push({ ...this.mark(tag).seenFrom(length(subtract(tag.position, eye))), at: tag.position,
                    axes: this.facing(tag.position) });
        if (isStale)
            list.push({ texture: this.veil.texture });
        const low = this.beforeHead(LEGEND.metres, LEGEND.pitchDeg), { wrist, others } = this.hands.boards(now, isStale);
        list.push(...others, { ...this.legend.seenFrom(LEGEND.metres), at: low, axes: this.facing(low) }, ...wrist);
        if (this.warning) {
            const at = this.beforeHead(BANNER_M, 0);
            list.push({ ...this.banner.seenFrom(BANNER_M), at, axes: this.facing(at) });
        }
        return list;
    }

    // Returns [words, detail, grave] of a warning across the view; null: none.
    warningOf(now) {
        const { kind, words, detail } = this.state;
        if (GRAVE.includes(kind))
            return [words, detail, true];
        if (this.isFlat(now))
            return [say('xr.flat'), say('xr.flat.why'), true];
        return now - this.nearAt > LATE_MS ? [say('xr.waiting'), '', false] : null;
    }
}
