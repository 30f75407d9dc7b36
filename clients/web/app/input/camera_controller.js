// SPDX-License-Identifier: GPL-3.0-or-later
// Turns pointer, wheel and keyboard input over the viewport into camera moves and flights (animated moves). Loaded when a pointer or key
// first comes near (input.js).
import { LEAST_M, same } from '../../core/camera.js';
import { flight, FLIGHT_MS } from '../../core/camera_flight.js';
import { Gestures, wheelZoom } from '../../core/gestures.js';
import { HeldKeys, keyMeaning } from '../../core/keys.js';
import { depthAt, depthOf, elevation, fit, lookAround, orbit, pan, sight, zoom, zoomLimits } from '../../core/camera_moves.js';
import { halfAt } from '../../core/nearest.js';
import { askAnchor } from '../../core/requests.js';
import { along, length, subtract } from '../../core/vector.js';
import { Approach } from './approach.js';
import { clock } from '../common/clock.js';
import { phone } from '../common/dom.js';
import { probeCodecs } from '../startup.js';
import { isOnPicture } from './input.js';

const DEGREES_PER_HEIGHT = 180; // degrees by which a drag over the picture's whole height orbits the camera
const DOUBLE_CLICK_MS = 350, DOUBLE_CLICK_PX = 24;
// A wheel event within this time and distance of the previous one belongs to the same turn of the wheel, and zooms about the same point.
const ANCHOR_MS = 600, ANCHOR_PX = 10;
// smallest elevation of the camera in degrees at the end of a flight, so that the camera stays above the floor
const LEAST_ARRIVAL_DEG = 15;
const MOST_BACK = 30; // maximum number of flights that can be undone
const USUAL_MARGIN = 1.08; // factor on the distance of a fit
const STRIP_PX = 28; // height of a phone's legend, a strip across the top of the picture (common/sheet.css)
const WRITTEN = 'input:not([type="radio"], [type="checkbox"], [type="range"]), select, textarea'; // fields that take typed text

// Returns true if two cameras differ by less than 2 % of their distance to the target.
const isNear = (a, b) => ['eye', 'target'].every((name) => length(subtract(a[name], b[name])) < 0.02 * length(subtract(b.eye, b.target)));

export class CameraController {
    // handlers: functions for input other than camera moves: { click(x, y, kind), point({ x, y } or null: the pointer has
    // left), command(name), group(index) }.
    constructor({ viewport, session, handlers, modules }) {
        Object.assign(this, { viewport, session, handlers });
        this.gestures = new Gestures();
        this.keys = new HeldKeys();
        this.fly = null;
        this.before = []; // stack for the command "back": { camera, ghosts } before each flight; ghosts: ids of assets drawn transparent
        this.approach = new Approach({ session, viewport });
        this.lastTick = null;
        this.lastClick = null;
        // surface point that the pointer grabbed: { x, y, time, point }; `point` is estimated from bounding boxes until the
        // server answers
        this.anchor = null;
        session.on('picked', ({ purpose, position }) => {
            if (purpose === 'anchor' && this.anchor)
                Object.assign(this.anchor, { point: position ?? this.anchor.point, sure: true });
        });
        window.addEventListener('blur', () => this.keys.clear());
        this.fitted = null; // the last fit to a box: { from (camera before), box, margin, to (fitted camera) }
        new ResizeObserver(() => this.stayFitted()).observe(viewport.element);
        // splitting a view, or ending the split, changes the pictures' shape: refits a camera that shows the whole plant
        session.on('params', () => this.stayFitted());
        probeCodecs(); // tests now whether the browser decodes H.264, which the pictures of a moving camera will need
        session.greeted(() => session.reprojects && modules.prepare('warp'));
    }

    // Handles an event from input.js.
    handle(event) {
        this[event.type](event);
    }

    // Hover or wheel event over the picture: requests an animation frame in which warp.js uploads the picture, so that the first camera
    // move is drawn without a delay.
    expectMove() {
        if (this.gestures.hover(performance.now()))
            this.viewport.invalidate();
    }

    place(event) {
        const box = this.viewport.element.getBoundingClientRect();
        return { id: event.pointerId, x: event.clientX - box.left, y: event.clientY - box.top, time: event.timeStamp };
    }

    pointerdown(event) {
        if (!isOnPicture(event))
            return;
        this.land();
        const place = this.place(event);
        if (!this.gestures.active)
            this.takeHold(place);
        // starts an animation frame, in which warp.js loads the picture before the pointer first moves
        this.viewport.invalidate();
        this.gestures.down({ ...place, kind: event.pointerType, button: event.button, shift: event.shiftKey, ctrl: event.ctrlKey });
    }

    // Makes the surface point under the pointer the centre of orbit and zoom. Over the sky, the previous centre stays.
    takeHold({ x, y, time }) {
        const { camera } = this.session;
        if (!camera || !this.session.model)
            return;
        const { half, at, depth } = this.under(camera, x, y);
        const { origin, direction } = sight(camera, at, y, half.width, this.viewport.height);
        this.anchor = { x, y, time, point: depth === null ? null : along(origin, direction, depth) };
        askAnchor(this.session, this.viewport.pixelOf(x, y));
    }

    // Returns which half of a split view is under the pointer, the position in that half, and the depth of the nearest bounding box there
    // (null: no box).
    under(camera, x, y) {
        const half = halfAt(this.session.shown, this.viewport.width, x), at = x - half.left;
        const boxes = this.session.model?.assets.map((asset) => asset.bounds) ?? [];
        return { half, at, depth: depthAt(camera, at, y, half.width, this.viewport.height, boxes) };
    }

    pointermove(event) {
        const place = this.place(event);
        if (!this.gestures.active) {
            const isHovering = isOnPicture(event) && event.pointerType !== 'touch';
            if (isHovering)
                this.expectMove();
            this.handlers.point(isHovering ? place : null);
            return;
        }
        this.apply(this.gestures.move(place), event.timeStamp);
        this.viewport.element.classList.toggle('moving', this.gestures.moved);
        if (this.gestures.moved)
            this.handlers.point(null);
    }

    pointerup(event) {
        const moves = this.gestures.up(this.place(event));
        this.viewport.element.classList.toggle('moving', this.gestures.active && this.gestures.moved);
        for (const { click } of moves)
            this.click(click, event);
    }

    pointercancel(event) {
        this.gestures.cancel({ id: event.pointerId });
    }

    pointerleave() {
        this.handlers.point(null);
    }

    click([x, y], event) {
        const last = this.lastClick;
        this.lastClick = { x, y, time: event.timeStamp };
        if (last && event.timeStamp - last.time < DOUBLE_CLICK_MS && Math.hypot(x - last.x, y - last.y) < DOUBLE_CLICK_PX) {
            this.lastClick = null;
            this.handlers.command('fit');
            return;
        }
        this.handlers.click(x, y, event.pointerType);
    }

    wheel(event) {
        if (!isOnPicture(event))
            return;
        this.land();
        this.expectMove();
        const place = this.place(event), { x, y, time } = place, { anchor } = this;
        if (!anchor || time - anchor.time > ANCHOR_MS || Math.hypot(x - anchor.x, y - anchor.y) > ANCHOR_PX)
            this.takeHold(place);
        else
            anchor.time = time;
        this.apply([{ zoom: wheelZoom(event), at: [x, y] }], event.timeStamp);
    }

    keydown(event) {
        if (event.defaultPrevented || document.querySelector('dialog[open]') || event.target.closest(WRITTEN))
            return; // ignores the key: a control such as the time slider has handled it, a dialog is open, or the user types into a field
        const meaning = keyMeaning(event);
        if (!meaning || (meaning.motion?.startsWith('Arrow') && event.target.closest('fieldset, [type="range"]')))
            return; // leaves arrow keys to the browser within radio buttons and sliders
        if (event.key === ' ' && event.target.closest('button, input, a'))
            return; // leaves the space bar to the button or link that has the focus
        event.preventDefault();
        if (meaning.motion) {
            this.land();
            this.apply(this.keys.press(meaning.motion), event.timeStamp);
            this.viewport.invalidate();
        } else if (meaning.command) {
            this.handlers.command(meaning.command);
        } else {
            this.handlers.group(meaning.group);
        }
    }

    keyup(event) {
        this.keys.release(event);
    }

    apply(moves, time) {
        const { width, height } = this.viewport;
        let camera = this.session.camera;
        if (!camera || moves.length === 0)
            return;
        for (const move of moves) {
            if (move.orbit)
                camera = orbit(camera, (-move.orbit[0] * DEGREES_PER_HEIGHT) / height, (move.orbit[1] * DEGREES_PER_HEIGHT) / height,
                    this.anchor?.point ?? camera.target, this.vertical);
            if (move.look)
                camera = lookAround(camera, move.look[0], move.look[1], height, this.vertical);
            if (move.orbitDeg)
                camera = orbit(camera, move.orbitDeg[0], move.orbitDeg[1], camera.target, this.vertical);
            if (move.pan)
                camera = pan(camera, move.pan[0], move.pan[1], height, this.heldDepth(camera));
            if (move.panHeights)
                camera = pan(camera, -move.panHeights[0] * height, move.panHeights[1] * height, height);
            if (move.zoom)
                camera = this.zoomed(camera, move.zoom, move.at ?? [width / 2, height / 2]);
        }
        this.session.setCamera(camera, clock.of(time));
    }

    // The plant's upward direction; undefined before the first `welcome`. In a plan with north at the top, a camera's own `up` is north.
    get vertical() {
        return this.session.model?.plant.up;
    }

    zoomed(camera, factor, [x, y]) {
        const { anchor } = this, { half, at, depth } = this.under(camera, x, y);
        const known = anchor && Math.hypot(x - anchor.x, y - anchor.y) < ANCHOR_PX ? this.heldDepth(camera) : undefined;
        return zoom(camera, factor, at, y, half.width, this.viewport.height, known ?? depth ?? undefined,
            this.session.model ? zoomLimits(this.session.model) : undefined);
    }

    // Returns the depth (distance along the view direction) of the grabbed point; undefined if nothing is grabbed.
    heldDepth(camera) {
        const depth = this.anchor?.point ? depthOf(camera, this.anchor.point) : 0;
        return depth > LEAST_M ? depth : undefined;
    }

    // --- flights

    get aspect() {
        return halfAt(this.session.params, this.viewport.width, 0).width / this.viewport.height;
    }

    // Ends a flight early, because the user moves the camera.
    land() {
        this.fly = null;
        this.approach.stop();
    }

    flyTo(camera) {
        this.approach.stop();
        this.remember();
        this.approach.setGhosts([]);
        this.steer(camera);
    }

    steer(camera) {
        const still = window.matchMedia('(prefers-reduced-motion: reduce)').matches;
        this.fly = { path: flight(this.session.camera, camera, still ? 0 : FLIGHT_MS, this.vertical), start: null };
        this.viewport.invalidate();
    }

    // Stores the start of a flight for the command "back". If a second flight begins during the first, the first one's start is
    // kept.
    remember() {
        if (!this.fly)
            this.before = [...this.before.slice(1 - MOST_BACK), { camera: this.session.camera, ghosts: this.approach.ghosts }];
    }

    goBack() {
        const last = this.before.pop();
        if (!last)
            return;
        this.approach.stop();
        this.approach.setGhosts(last.ghosts);
        this.steer(last.camera);
    }

    get homeNow() {
        const { width } = halfAt(this.session.params, this.viewport.width, 0);
        return this.session.homeIn(width, this.viewport.height);
    }

    // When the picture changes shape, refits the camera if it shows the home view or a fitted box, or is on its way there.
    stayFitted() {
        const { session, fitted } = this;
        if (!session.model)
            return;
        const now = this.homeNow, was = this.lastHome ?? now, end = this.fly?.path(Infinity) ?? session.camera;
        this.lastHome = now;
        const isFitted = fitted && same(end, fitted.to), to = isFitted ? this.refit() : isNear(end, was) ? now : end;
        if (session.leader !== null || same(to, end) || (!isFitted && same(now, was)))
            return;
        if (this.fly)
            this.steer(to);
        else
            session.setCamera(to);
    }

    // Returns the camera of the last fit for the present shape of the picture. On a phone, the box is in the middle of the part below the
    // legend's strip.
    refit() {
        const { from, box, margin } = this.fitted, { height } = this.viewport;
        const strip = phone.matches && height > 2 * STRIP_PX ? STRIP_PX : 0;
        const to = fit(from, box, this.aspect, strip ? (margin * height) / (height - strip) : margin);
        this.fitted.to = strip ? pan(to, 0, strip / 2, height) : to;
        return this.fitted.to;
    }

    flyHome() {
        this.flyTo(this.homeNow);
    }

    flyToTag(tag, asset) {
        this.remember();
        this.approach.go(tag, asset, (camera) => this.steer(camera));
    }

    flyToBox(box, margin = USUAL_MARGIN) {
        const { vertical, session: { camera } } = this, rise = Math.max(0, LEAST_ARRIVAL_DEG - elevation(camera, vertical));
        this.fitted = { from: orbit(camera, 0, rise, camera.target, vertical), box, margin };
        this.flyTo(this.refit());
    }

    tick(now) {
        const seconds = this.lastTick === null ? 0 : Math.min(0.1, (now - this.lastTick) / 1000);
        if (this.fly) {
            this.fly.start = this.fly.start ?? now;
            const camera = this.fly.path(now - this.fly.start);
            if (camera === this.fly.path(Infinity))
                this.fly = null;
            this.session.setCamera(camera, clock.of(now));
        }
        if (this.keys.moving)
            this.apply(this.keys.step(seconds), now);
        this.lastTick = this.fly || this.keys.moving ? now : null;
        if (this.lastTick !== null)
            this.viewport.invalidate();
    }
}
