// SPDX-License-Identifier: GPL-3.0-or-later
// What is cut away, by hand: arrows on the plane or on the sides of the box, for mouse, finger, pen and keys, in step with the picture.
// Loaded when something is cut for the first time.
import { projector, sight } from '../core/camera.js';
import { numberText } from '../core/format.js';
import { alongSight, beforeEye, gripsOf, moveGrip, spotsOf } from '../core/grips.js';
import { halves } from '../core/halves.js';
import { along } from '../core/vector.js';
import { say } from '../core/words.js';
import { byId, make, makeSvg, setText } from './dom.js';

const RIM_PX = 34; // no grip nearer to the edge of the picture
const APART_PX = 46; // nor nearer to another
const STEPS = { ArrowRight: 0.01, ArrowUp: 0.01, ArrowLeft: -0.01, ArrowDown: -0.01, PageUp: 0.1, PageDown: -0.1, Home: -2, End: 2 };
const ARROW = 'M-13 0h26M-13 0l6-5.5M-13 0l6 5.5M13 0l-6-5.5M13 0l-6 5.5';

export class Grips {
    constructor({ session, viewport }) {
        Object.assign(this, { session, viewport, dragging: null });
        this.lines = makeSvg('svg', { class: 'cut-lines', 'aria-hidden': 'true' });
        this.label = make('output', { class: 'measured cut-label', 'aria-hidden': 'true', hidden: true });
        this.buttons = new Map(); // id of the grip -> button
        byId('overlay').after(this.lines);
        viewport.element.append(this.label);
    }

    // Of the plant's bounds, and none while the view is another's.
    get grips() {
        const { model, params, following } = this.session;
        return model && !following ? gripsOf(params.clip, model.plant.bounds) : [];
    }

    // The left half stands for both.
    get view() {
        const { picture, params } = this.session, { width, height } = this.viewport;
        const half = halves(params, picture.fullWidth)[0], wide = (half.width * width) / picture.fullWidth;
        const project = projector(picture.camera, wide, height);
        return { camera: picture.camera, width: wide, height, project };
    }

    show() {
        const grips = this.session.picture ? this.grips : [];
        for (const [id, button] of this.buttons)
            if (!grips.some((grip) => grip.id === id)) {
                this.buttons.delete(id); // before it goes: it loses the focus, and this is called again
                button.remove();
            }
        this.lines.replaceChildren();
        if (grips.length > 0)
            this.place(grips, this.view);
        this.tell(grips);
    }

    place(grips, view) {
        const taken = [], covers = this.covers(), path = outline(grips, view);
        this.lines.append(makeSvg('path', { class: 'under', d: path }), makeSvg('path', { d: path }));
        for (const grip of grips) {
            const button = this.buttons.get(grip.id) ?? this.make(grip.id);
            const held = this.dragging?.id === grip.id ? this.dragging.spot : null, spot = held ?? this.spotOf(grip, view, taken, covers);
            button.hidden = spot === null;
            if (!spot)
                continue;
            const at = spotsOf(grip)[spot.number] ?? spotsOf(grip)[0], [x, y] = view.project(at) ?? [-99, -99];
            const end = view.project(along(at, grip.direction, 1e-3 * Math.max(1, grip.high - grip.low))) ?? [x, y];
            taken.push([x, y]);
            button.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
            const turn = Math.hypot(end[0] - x, end[1] - y) < 1e-3 ? 90 : (Math.atan2(end[1] - y, end[0] - x) * 180) / Math.PI;
            button.firstChild.firstChild.setAttribute('transform', `rotate(${turn.toFixed(1)})`);
            Object.assign(button, { grip, spot, place: [x, y] });
            const said = { label: say('cut.move', { axis: nameOf(grip) }), valuemin: round(grip.low), valuemax: round(grip.high),
                valuenow: round(grip.at), valuetext: textOf(grip) };
            for (const [name, value] of Object.entries(said))
                if (button.getAttribute(`aria-${name}`) !== String(value))
                    button.setAttribute(`aria-${name}`, value);
        }
    }

    // What lies over the picture.
    covers() {
        const { left, top } = this.viewport.element.getBoundingClientRect();
        return [...document.querySelectorAll('.panel.open, .legend, .card, .assets, .engineer, .alarms')]
            .map((e) => e.getBoundingClientRect()).map((box) => [box.left - left, box.top - top, box.right - left, box.bottom - top]);
    }

    // The first place that is well inside the picture, under nothing and not on another grip; null: there is none.
    spotOf(grip, { project, width, height }, taken, covers) {
        const inside = ([x, y]) => x > RIM_PX && y > RIM_PX && x < width - RIM_PX && y < height - RIM_PX;
        const free = ([x, y]) => taken.every((other) => Math.hypot(x - other[0], y - other[1]) >= APART_PX)
            && covers.every(([left, top, right, bottom]) => x < left || x > right || y < top || y > bottom);
        const number = spotsOf(grip).map(project).findIndex((at) => at && inside(at) && free(at));
        return number < 0 ? null : { number };
    }

    make(id) {
        const drop = (event) => this.drop(event), show = () => this.show();
        const button = make('button', { type: 'button', class: 'grip', role: 'slider', 'data-id': id,
            onpointerdown: (event) => this.grab(event, button), onpointermove: (event) => this.drag(event), onpointerup: drop,
            onpointercancel: drop, onkeydown: (event) => this.key(event, button), onfocus: show, onblur: show, onpointerenter: show,
            onpointerleave: show },
        makeSvg('svg', { viewBox: '-20 -20 40 40', 'aria-hidden': 'true' }, makeSvg('g', {},
            makeSvg('path', { class: 'rim', d: ARROW }), makeSvg('path', { d: ARROW }))));
        this.buttons.set(id, button);
        this.viewport.element.append(button);
        return button;
    }

    // Of the grip that is held, pointed at or has the focus: where it is.
    tell(grips) {
        const one = [...this.buttons.values()].find((button) => !button.hidden && grips.includes(button.grip)
            && (button.grip.id === this.dragging?.id || button.matches(':hover, :focus-visible')));
        this.label.hidden = !one;
        if (!one)
            return;
        setText(this.label, textOf(one.grip));
        const { width, height } = this.viewport, wide = this.label.offsetWidth, [x, y] = one.place;
        const left = x + 28 + wide > width ? x - 28 - wide : x + 28;
        this.label.style.transform = `translate(${Math.round(left)}px, ${Math.round(Math.max(4, Math.min(height - 40, y - 16)))}px)`;
    }

    // --- by hand

    placeOf(event) {
        const box = this.viewport.element.getBoundingClientRect();
        return [event.clientX - box.left, event.clientY - box.top];
    }

    grab(event, button) {
        if (this.dragging || event.button !== 0)
            return;
        const { grip, spot } = button, [x, y] = this.placeOf(event), { camera, width, height } = this.view;
        const point = spotsOf(grip)[spot.number];
        this.dragging = { pointer: event.pointerId, id: grip.id, grip, spot, point, before: this.session.params.clip, y,
            from: alongSight(point, grip.direction, sight(camera, x, y, width, height)) };
        button.setPointerCapture(event.pointerId);
        button.focus({ preventScroll: true });
        event.preventDefault();
        this.show();
    }

    // Once per animation frame.
    drag(event) {
        const { dragging } = this;
        if (event.pointerId !== dragging?.pointer)
            return;
        dragging.at = this.placeOf(event);
        dragging.frame ??= requestAnimationFrame(() => {
            dragging.frame = null;
            const to = this.taken(dragging);
            if (this.dragging === dragging && to !== null)
                this.put(dragging.grip, dragging.grip.at + to);
        });
    }

    // Metres; of a way that leads towards the eye the hand says as much by going up and down.
    taken({ at: [x, y], from, grip, point, y: began }) {
        const { camera, width, height } = this.view;
        if (from === null)
            return ((began - y) / height) * (grip.high - grip.low);
        const to = alongSight(point, grip.direction, sight(camera, x, y, width, height));
        return to === null ? null : to - from;
    }

    drop(event) {
        if (event.pointerId !== this.dragging?.pointer)
            return;
        this.dragging = null;
        this.show();
    }

    key(event, button) {
        const step = STEPS[event.key];
        if (event.key === 'Escape' && this.dragging) {
            this.session.setParams({ clip: this.dragging.before });
            this.dragging = null;
        } else if (step) {
            this.put(button.grip, button.grip.at + step * (event.shiftKey ? 10 : 1) * (button.grip.high - button.grip.low));
        } else {
            return;
        }
        event.preventDefault();
        event.stopPropagation();
    }

    put(grip, to) {
        const { clip } = this.session.params;
        if (clip)
            this.session.setParams({ clip: moveGrip(clip, grip, to) });
        this.show();
    }
}

const round = (m) => Math.round(m * 100) / 100;
const nameOf = ({ axis, turned, id }) => {
    const name = axis ? axis.toUpperCase() : say('cut.oblique');
    return id.startsWith('plane') ? name : `${name} ${turned ? '+' : '−'}`;
};
const textOf = ({ axis, turned, at }) => say('views.stays', {
    axis: axis ? axis.toUpperCase() : say('cut.oblique'), sign: turned ? '≤' : '≥', at: numberText(at, 2) });

// Each edge once.
function outline(grips, { camera, project }) {
    const edges = grips.flatMap(({ corners }) => corners.map((p, i) => [p, corners[(i + 1) % corners.length]]));
    const once = new Map(edges.map(([p, q]) => [[String(p), String(q)].sort().join(), [p, q]])).values();
    return [...once].map(([p, q]) => beforeEye(camera, p, q)?.map(project)).filter((ends) => ends?.every(Boolean))
        .map(([[x1, y1], [x2, y2]]) => `M${x1.toFixed(1)} ${y1.toFixed(1)}L${x2.toFixed(1)} ${y2.toFixed(1)}`).join('');
}
