// SPDX-License-Identifier: GPL-3.0-or-later
// The clip gizmo: handles with arrows on the clip plane, or on the sides and at the centre of the clip box, for mouse, touch,
// pen and keys. The handles move with the picture in each half of a split view. Loaded on the first use of clipping.
import { projector } from '../../core/camera.js';
import { numberText } from '../../core/format.js';
import { alongSight, beforeEye, facing, gripsOf, moveBox, moveGrip, spotsOf, wholeOf } from '../../core/clip_gizmo.js';
import { halves } from '../../core/split_view.js';
import { sight } from '../../core/camera_moves.js';
import { along, subtract } from '../../core/vector.js';
import { say } from '../../core/words.js';
import { byId, make, makeSvg, setText } from '../common/dom.js';

const RIM_PX = 34; // minimum distance in pixels of a handle from the picture's edge
const APART_PX = 46; // minimum distance between handles
const STEPS = { ArrowRight: 0.01, ArrowUp: 0.01, ArrowLeft: -0.01, ArrowDown: -0.01, PageUp: 0.1, PageDown: -0.1, Home: -2, End: 2 };
// For each key: the axis of the plant along which it moves a clip box (0: x, 1: y, 2: z), and the direction.
const WAYS = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, 1], ArrowDown: [1, -1], PageUp: [2, 1], PageDown: [2, -1] };
const STEP = 0.01; // distance that a key press moves a clip box, as a fraction of the plant's length along that axis
const ARROW = 'M-13 0h26M-13 0l6-5.5M-13 0l6 5.5M13 0l-6-5.5M13 0l-6 5.5';
const CROSS = `${ARROW}M0-13v26M0-13l-5.5 6M0-13l5.5 6M0 13l-5.5-6M0 13l5.5-6`;

export class ClipGizmo {
    constructor({ session, viewport }) {
        Object.assign(this, { session, viewport, dragging: null });
        this.lines = makeSvg('svg', { class: 'cut-lines', 'aria-hidden': 'true' });
        this.label = make('output', { class: 'measured cut-label', 'aria-hidden': 'true', hidden: true });
        this.buttons = new Map(); // handle id -> button
        byId('overlay').after(this.lines);
        viewport.element.append(this.label);
    }

    // Handles within the plant's bounds; an empty list while this page follows another session. A box's centre handle comes
    // first, so that no other handle takes its position.
    get grips() {
        const { model, params, following } = this.session;
        return model && !following ? [wholeOf(params.clip), ...gripsOf(params.clip, model.plant.bounds)].filter(Boolean) : [];
    }

    // The views of the picture: one, or the two halves of a split view, which share a camera.
    get views() {
        const { picture, shown } = this.session, { width, height } = this.viewport, scale = width / picture.shownWidth;
        return halves(shown, picture.shownWidth).map((half) => {
            const left = half.left * scale, wide = half.width * scale, flat = projector(picture.camera, wide, height);
            const project = (point) => {
                const at = flat(point);
                return at && [left + at[0], at[1]];
            };
            return { camera: picture.camera, left, width: wide, height, project };
        });
    }

    show() {
        const grips = this.session.picture ? this.grips : [], views = grips.length > 0 ? this.views : [];
        for (const [key, button] of this.buttons)
            if (button.half >= views.length || !grips.some(({ id }) => id === button.dataset.id)) {
                // deletes the handle from the map before its button leaves the document: removing a focused button calls show()
                // again
                this.buttons.delete(key);
                button.remove();
            }
        this.lines.replaceChildren();
        views.forEach((view, half) => this.place(grips, view, half));
        this.tell(grips);
    }

    place(grips, view, half) {
        const taken = [], covers = this.covers(), path = outline(grips, view);
        // x, width: bounds of the handle's half of a split view, which the handle must not leave
        const { left: x, width } = view, { height } = this.viewport;
        this.lines.append(makeSvg('svg', { x, width, height, viewBox: `${x} 0 ${width} ${height}` },
            makeSvg('path', { class: 'under', d: path }), makeSvg('path', { d: path })));
        for (const grip of grips) {
            const button = this.buttons.get(`${grip.id}/${half}`) ?? this.make(grip.id, half);
            const held = this.dragging?.button === button ? this.dragging.spot : null;
            const stays = button.matches(':focus') ? { number: 0 } : null;
            // the focused handle stays visible even if there is no position where it is neither covered nor too near other
            // handles
            const spot = held ?? this.spotOf(grip, view, taken, covers) ?? stays;
            button.hidden = spot === null;
            if (!spot)
                continue;
            const at = spotsOf(grip)[spot.number] ?? spotsOf(grip)[0], [x, y] = view.project(at) ?? [-99, -99];
            taken.push([x, y]);
            button.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
            Object.assign(button, { grip, spot, place: [x, y] });
            if (grip.id === 'whole')
                button.setAttribute('aria-label', say('cut.whole'));
            else
                this.aim(button, view, at);
        }
    }

    // Points a handle's arrow along its direction, and gives screen readers the handle's value.
    aim(button, view, at) {
        const { grip, place: [x, y] } = button;
        const end = view.project(along(at, grip.direction, 1e-3 * Math.max(1, grip.high - grip.low))) ?? [x, y];
        const turn = Math.hypot(end[0] - x, end[1] - y) < 1e-3 ? 90 : (Math.atan2(end[1] - y, end[0] - x) * 180) / Math.PI;
        button.firstChild.firstChild.setAttribute('transform', `rotate(${turn.toFixed(1)})`);
        const said = { label: say('cut.move', { axis: nameOf(grip) }), valuemin: round(grip.low), valuemax: round(grip.high),
            valuenow: round(grip.at), valuetext: textOf(grip) };
        for (const [name, value] of Object.entries(said))
            if (button.getAttribute(`aria-${name}`) !== String(value))
                button.setAttribute(`aria-${name}`, value);
    }

    // Returns the boxes of the HTML elements that cover parts of the picture.
    covers() {
        const { left, top } = this.viewport.element.getBoundingClientRect();
        return [...document.querySelectorAll('.panel.open, .legend, .card, .assets, .engineer, .alarms')]
            .map((e) => e.getBoundingClientRect()).map((box) => [box.left - left, box.top - top, box.right - left, box.bottom - top]);
    }

    // Returns the first position for a handle that is well inside the picture, not covered, and apart from other handles; null if there is
    // none.
    spotOf(grip, { project, left, width, height }, taken, covers) {
        const inside = ([x, y]) => x > left + RIM_PX && y > RIM_PX && x < left + width - RIM_PX && y < height - RIM_PX;
        const free = ([x, y]) => taken.every((other) => Math.hypot(x - other[0], y - other[1]) >= APART_PX)
            && covers.every(([west, top, east, bottom]) => x < west || x > east || y < top || y > bottom);
        const number = spotsOf(grip).map(project).findIndex((at) => at && inside(at) && free(at));
        return number < 0 ? null : { number };
    }

    // Makes a handle. Handles in the right half of a split view are for pointers only, because keys and screen readers use those of the
    // left half.
    make(id, half) {
        const drop = (event) => this.drop(event), show = () => this.show(), icon = id === 'whole' ? CROSS : ARROW;
        const button = make('button', { type: 'button', class: 'grip', ...(id === 'whole' ? {} : { role: 'slider' }), 'data-id': id,
            ...(half > 0 ? { tabindex: -1, 'aria-hidden': 'true' } : {}),
            onpointerdown: (event) => this.grab(event, button), onpointermove: (event) => this.drag(event), onpointerup: drop,
            onpointercancel: drop, onkeydown: (event) => this.key(event, button), onfocus: show, onblur: show, onpointerenter: show,
            onpointerleave: show },
        makeSvg('svg', { viewBox: '-20 -20 40 40', 'aria-hidden': 'true' }, makeSvg('g', {},
            makeSvg('path', { class: 'rim', d: icon }), makeSvg('path', { d: icon }))));
        button.half = half;
        this.buttons.set(`${id}/${half}`, button);
        this.viewport.element.append(button);
        return button;
    }

    // Writes its position next to the handle that is dragged, hovered or focused.
    tell(grips) {
        const one = [...this.buttons.values()].find((button) => !button.hidden && grips.includes(button.grip)
            && (this.dragging ? button === this.dragging.button : button.matches(':hover, :focus-visible')));
        this.label.hidden = !one;
        if (!one)
            return;
        setText(this.label, textOf(one.grip));
        const { width, height } = this.viewport, wide = this.label.offsetWidth, [x, y] = one.place;
        const left = x + 28 + wide > width ? x - 28 - wide : x + 28;
        this.label.style.transform = `translate(${Math.round(left)}px, ${Math.round(Math.max(4, Math.min(height - 40, y - 16)))}px)`;
    }

    // --- dragging

    placeOf(event) {
        const box = this.viewport.element.getBoundingClientRect();
        return [event.clientX - box.left, event.clientY - box.top];
    }

    grab(event, button) {
        if (this.dragging || event.button !== 0)
            return;
        const { grip, spot } = button, at = this.placeOf(event), point = spotsOf(grip)[spot.number];
        this.dragging = { pointer: event.pointerId, button, grip, spot, point, before: this.session.params.clip, y: at[1] };
        this.dragging.from = this.under(this.dragging, at);
        button.setPointerCapture(event.pointerId);
        button.focus({ preventScroll: true });
        event.preventDefault();
        this.show();
    }

    // Moves the dragged handle at most once per animation frame.
    drag(event) {
        const { dragging } = this;
        if (event.pointerId !== dragging?.pointer)
            return;
        dragging.at = this.placeOf(event);
        dragging.frame ??= requestAnimationFrame(() => {
            dragging.frame = null;
            const to = this.taken(dragging);
            if (this.dragging !== dragging || to === null)
                return;
            if (dragging.grip.id === 'whole')
                this.putBox(dragging.before, to);
            else
                this.put(dragging.grip, dragging.grip.at + to);
        });
    }

    // Returns the point of the handle's line under the pointer, in metres along the line; for a whole box a position; null if
    // undefined.
    under({ grip, point, button }, [x, y]) {
        const { camera, left, width, height } = this.views[button.half] ?? this.views[0], line = sight(camera, x - left, y, width, height);
        return grip.id === 'whole' ? facing(camera, point, line) : alongSight(point, grip.direction, line);
    }

    // Returns how many metres the user has dragged the handle along its line. If the line points at the camera, the pointer's
    // vertical movement counts instead.
    taken(dragging) {
        const { at, from, grip, y: began } = dragging;
        if (from === null)
            return ((began - at[1]) / this.viewport.height) * (grip.high - grip.low);
        const to = this.under(dragging, at);
        return to === null ? null : grip.id === 'whole' ? subtract(to, from) : to - from;
    }

    drop(event) {
        if (event.pointerId !== this.dragging?.pointer)
            return;
        this.dragging = null;
        this.show();
    }

    key(event, button) {
        const step = STEPS[event.key], whole = button.grip.id === 'whole', way = WAYS[event.key];
        if (event.key === 'Escape' && this.dragging) {
            this.session.setParams({ clip: this.dragging.before });
            this.dragging = null;
        } else if (whole && way) {
            const { min, max } = this.session.model.plant.bounds, by = [0, 0, 0], [axis, sign] = way;
            by[axis] = sign * STEP * (event.shiftKey ? 10 : 1) * (max[axis] - min[axis]);
            this.putBox(this.session.params.clip, by);
        } else if (!whole && step) {
            this.put(button.grip, button.grip.at + step * (event.shiftKey ? 10 : 1) * (button.grip.high - button.grip.low));
        } else {
            return;
        }
        event.preventDefault();
        event.stopPropagation();
    }

    putBox(clip, by) {
        if (this.session.params.clip)
            this.session.setParams({ clip: moveBox(clip, by, this.session.model.plant.bounds) });
        this.show();
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
const middleText = ([middle]) => `${middle.map((m) => numberText(m, 2)).join(' · ')} m`;
const textOf = ({ id, corners, axis, turned, at }) => (id === 'whole' ? middleText(corners) : say('views.stays', {
    axis: axis ? axis.toUpperCase() : say('cut.oblique'), sign: turned ? '≤' : '≥', at: numberText(at, 2) }));

// Returns the outline of the section, or the edges of the clip box, as an SVG path that contains each edge once.
function outline(grips, { camera, project }) {
    const faces = grips.map(({ corners }) => corners).filter((corners) => corners.length > 1);
    const edges = faces.flatMap((corners) => corners.map((p, i) => [p, corners[(i + 1) % corners.length]]));
    const once = new Map(edges.map(([p, q]) => [[String(p), String(q)].sort().join(), [p, q]])).values();
    return [...once].map(([p, q]) => beforeEye(camera, p, q)?.map(project)).filter((ends) => ends?.every(Boolean))
        .map(([[x1, y1], [x2, y2]]) => `M${x1.toFixed(1)} ${y1.toFixed(1)}L${x2.toFixed(1)} ${y2.toFixed(1)}`).join('');
}
