// SPDX-License-Identifier: GPL-3.0-or-later
// Turns pointer and wheel events into camera moves. Positions are CSS pixels of the viewport. Each call returns a list of moves: { orbit:
// [dx, dy] }, { orbitDeg: [about the vertical, up] }, { pan: [dx, dy] }, { look: [dx, dy] }, { zoom: factor, at: [x, y] }, { click: [x, y]
// }. Moves end with the gesture, without momentum.

const CLICK_MS = 500;
const SLOP_PX = { mouse: 3, pen: 5, touch: 8 };
const LINE_PX = 16, PAGE_PX = 400;
const WHEEL_PER_PX = 0.0016, PINCH_PER_PX = 0.01, MOST_PER_EVENT = 0.5;
// time in milliseconds after a hover or wheel event during which a camera move is likely
const MOVE_EXPECTED_MS = 5000;

const centre = (all) => ['x', 'y'].map((axis) => all.reduce((sum, p) => sum + p[axis], 0) / all.length);
const apart = ([a, b]) => Math.hypot(a.x - b.x, a.y - b.y);
const angle = ([a, b]) => Math.atan2(b.y - a.y, b.x - a.x) * (180 / Math.PI);
const TWIST_DEG = 8; // twists of two fingers by fewer degrees count as tremor and are ignored

export class Gestures {
    constructor() {
        this.pointers = new Map(); // pointers that are pressed: id -> { x, y, mode }
        this.moved = false;
        this.hoverAt = -Infinity; // time in milliseconds of the last hover or wheel event over the picture
    }

    get active() {
        return this.pointers.size > 0;
    }

    // Returns true if the user is expected to move the camera soon. now: milliseconds.
    expectsMove(now) {
        return this.active || now - this.hoverAt < MOVE_EXPECTED_MS;
    }

    // Records a hover or wheel event over the picture. Returns true if no camera move was likely before.
    hover(now) {
        const isNew = !this.expectsMove(now);
        this.hoverAt = now;
        return isNew;
    }

    down({ id, x, y, kind = 'mouse', button = 0, shift = false, ctrl = false, time = 0 }) {
        this.pointers.set(id, { x, y, mode: button !== 0 || shift ? 'pan' : ctrl ? 'look' : 'orbit' });
        if (this.pointers.size === 1)
            this.first = { x, y, time, slop: SLOP_PX[kind] ?? SLOP_PX.mouse, button };
        this.moved = this.pointers.size > 1;
        this.twisted = 0; // angle in degrees that the two fingers have turned so far
        return [];
    }

    move({ id, x, y }) {
        const pointer = this.pointers.get(id);
        if (!pointer)
            return [];
        if (!this.moved && Math.hypot(x - this.first.x, y - this.first.y) < this.first.slop)
            return [];
        this.moved = true;
        const before = [...this.pointers.values()].map((p) => ({ ...p }));
        const dx = x - pointer.x, dy = y - pointer.y;
        Object.assign(pointer, { x, y });
        if (this.pointers.size === 1)
            return [{ [pointer.mode]: [dx, dy] }];
        return this.pointers.size === 2 ? this.pinch(before) : this.lookAround(before);
    }

    // Three fingers turn the view about the camera's eye; further fingers are ignored.
    lookAround(before) {
        const from = centre(before.slice(0, 3)), to = centre([...this.pointers.values()].slice(0, 3));
        return [{ look: [to[0] - from[0], to[1] - from[1]] }];
    }

    // Two fingers pan and zoom so that each finger stays on its point of the plant. A twist also turns the plant about the vertical.
    pinch(before) {
        const then = before.slice(0, 2), now = [...this.pointers.values()].slice(0, 2);
        const from = centre(then), to = centre(now);
        const moves = [{ pan: [to[0] - from[0], to[1] - from[1]] }];
        if (apart(then) > 1 && apart(now) > 1) {
            moves.push({ zoom: apart(then) / apart(now), at: to });
            const turned = ((angle(now) - angle(then) + 540) % 360) - 180, twisted = this.twisted + turned;
            const beyond = (twist) => Math.sign(twist) * Math.max(0, Math.abs(twist) - TWIST_DEG);
            if (beyond(twisted) !== beyond(this.twisted))
                moves.push({ orbitDeg: [beyond(twisted) - beyond(this.twisted), 0] });
            this.twisted = twisted;
        }
        return moves;
    }

    up({ id, x, y, time = 0 }) {
        if (!this.pointers.delete(id) || this.pointers.size > 0 || this.moved)
            return [];
        return this.first.button === 0 && time - this.first.time <= CLICK_MS ? [{ click: [x, y] }] : [];
    }

    cancel({ id }) {
        this.pointers.delete(id);
        this.moved = true;
        return [];
    }
}

// Returns the zoom factor of a wheel event. A pinch on a track pad arrives as a wheel event with ctrl.
export function wheelZoom({ deltaY, deltaMode = 0, ctrlKey = false }) {
    const px = deltaY * [1, LINE_PX, PAGE_PX][deltaMode];
    const power = px * (ctrlKey ? PINCH_PER_PX : WHEEL_PER_PX);
    return Number.isNaN(power) ? 1 : Math.exp(Math.max(-MOST_PER_EVENT, Math.min(MOST_PER_EVENT, power)));
}
