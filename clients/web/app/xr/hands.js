// SPDX-License-Identifier: GPL-3.0-or-later
// The hand controllers of a headset. The trigger acts on the controller's target: the panel at the wrist, a sensor, equipment
// or the floor. Grabbing moves the room.
import { RADIANS } from '../../core/camera.js';
import { directionOf, floorHit, hitOf, panelHit, pointOf, poseOf, standAt } from '../../core/headset_views.js';
import { askPoint, Repeater } from '../../core/requests.js';
import { asAsked } from '../../core/session.js';
import { add, along, cross, dot, length, scale, subtract, unit } from '../../core/vector.js';
import { Board, cardLines, showCard, showColour, showRing, showWrist } from './boards.js';

const REACH = Math.cos(2 * RADIANS); // cosine of an angle: a ray whose angle to a marker's direction is smaller than that hits the marker
const LEVEL = Math.cos(35 * RADIANS); // cosine of the steepest slope of a floor on which a user can stand
const RAY_M = 4, RAY_WIDE_M = 0.004, RING_M = 0.5;
const AGAIN_MS = 1000; // milliseconds between requests for the value that a card shows
const WRIST_UP_M = 0.16; // height in metres of the panel at the wrist above the hand

export class Hands {
    constructor(headset) {
        const { painter } = headset;
        Object.assign(this, { headset, rays: new Map(), grabbed: null, asked: null, card: null, wristButton: null, askedAt: 0 });
        this.repeater = new Repeater();
        this.wrist = new Board(painter, 640, 760);
        this.paper = new Board(painter, 760, 400);
        this.line = showColour(new Board(painter, 4, 4), 'rgb(255 255 255 / 80%)');
        this.ring = showRing(new Board(painter, 128, 128));
    }

    get up() {
        return this.headset.rig.axes[1];
    }

    // Reads where the controllers are in this frame and where they point, and moves the room with a controller that has grabbed it.
    move(frame) {
        const { headset } = this, { xr, space } = headset;
        this.rays.clear();
        this.wristAt = null;
        for (const source of xr.inputSources) {
            const matrix = frame.getPose(source.targetRaySpace, space)?.transform.matrix;
            const grip = source.gripSpace && frame.getPose(source.gripSpace, space)?.transform.matrix;
            if (!matrix)
                continue;
            this.rays.set(source, { origin: [...matrix.slice(12, 15)], direction: [-matrix[8], -matrix[9], -matrix[10]] });
            if (source.handedness === 'left')
                this.wristAt = { source, at: [...(grip ?? matrix).slice(12, 15)] };
        }
        if (this.grabbed && this.rays.has(this.grabbed.source)) {
            const { rig } = headset, { origin } = this.rays.get(this.grabbed.source);
            headset.rig = { ...rig, at: add(rig.at, subtract(this.grabbed.at, pointOf(rig, origin))) };
        }
        for (const [source, ray] of this.rays) {
            ray.at = pointOf(headset.rig, ray.origin);
            ray.along = directionOf(headset.rig, ray.direction);
            ray.target = this.targetOf(source, ray);
        }
    }

    // Lets a controller (`source`, a WebXR input source) grab the plant, so that moving the controller moves the plant; null: releases the
    // plant.
    grab(source) {
        const ray = source && this.rays.get(source);
        this.grabbed = ray ? { source, at: pointOf(this.headset.rig, ray.origin) } : null;
    }

    panel() {
        const { headset, wristAt } = this;
        if (!wristAt)
            return null;
        const at = along(pointOf(headset.rig, wristAt.at), this.up, WRIST_UP_M);
        return { ...this.wrist.atWrist, at, axes: headset.facing(at) };
    }

    onPanel({ at, axes: [x, y], width, height }, [u, v]) {
        return along(along(at, x, (u - 0.5) * width), y, (0.5 - v) * height);
    }

    // Returns what a ray hits: { kind: wrist, sensor, surface or floor, point, ... }; null: nothing.
    targetOf(source, { at, along: direction }) {
        const { headset } = this, panel = this.panel();
        const place = panel && source !== this.wristAt.source ? panelHit(panel, at, direction) : null;
        if (place)
            return { kind: 'wrist', place, point: this.onPanel(panel, place) };
        if (!headset.isNear)
            return null;
        const towards = ({ tag }) => dot(unit(subtract(tag.position, at)), direction);
        const [nearest] = headset.markers.filter((marker) => towards(marker) > REACH).sort((a, b) => towards(b) - towards(a));
        const { grid } = headset.painter.source.part, { camera } = headset.shown, hit = hitOf(grid, camera, at, direction);
        if (nearest)
            return { kind: 'sensor', point: nearest.tag.position, tag: nearest.tag };
        const floor = floorHit(at, direction, along(headset.rig.at, this.up, -headset.floorM), this.up);
        if (hit && (!floor || length(subtract(hit.point, at)) <= length(subtract(floor, at)) + 0.05))
            return { kind: 'surface', ...hit };
        return floor ? { kind: 'floor', point: floor } : null;
    }

    // Acts on what a hand points at, when the user pulls the hand's trigger.
    pull(source) {
        const target = this.rays.get(source)?.target;
        this.card = null;
        this.repeater.reset();
        if (target?.kind === 'wrist')
            this.wristButton?.act();
        else if (target?.kind === 'floor')
            this.stand(target.point);
        else if (target)
            this.pick(target);
    }

    stand(point) {
        const { headset } = this;
        headset.rig = standAt(headset.rig, [...headset.head.slice(12, 15)], along(point, this.up, headset.floorM));
    }

    // Asks the server what is at a point of the plant; hear() gets the answer.
    pick({ point }, purpose = 'headset') {
        const { session, shown } = this.headset;
        Object.assign(this, { asked: purpose, askedAt: performance.now() });
        this.repeater.sent(this.askedAt);
        askPoint(session, point, purpose, 0, asAsked(shown.camera));
    }

    hear(picked) {
        const { asked } = this;
        // an answer to another module's request also ends this module's request, because the server answers only the latest
        this.asked = null;
        this.repeater.reset();
        if (picked.purpose !== asked || (asked === 'headset again' && !this.card))
            return;
        const { sensor, asset, normal, position } = picked;
        if (!sensor && !asset)
            this.card = null;
        else if (!sensor && asked === 'headset' && normal && dot(normal, this.up) > LEVEL)
            this.stand(position);
        else
            this.card = { picked, at: position };
    }

    // Requests the value at the card's point again when readings change, and repeats an unanswered request.
    ask() {
        const now = performance.now(), isEarly = this.asked ? this.repeater.waits(now) : now - this.askedAt < AGAIN_MS;
        if (this.card && !this.card.picked.sensor && !isEarly && this.headset.shown)
            this.pick({ point: this.card.at }, 'headset again');
    }

    // Closes the card about a sensor or point: after a reconnect its values are not valid any more.
    forget() {
        this.card = this.asked = null;
        this.repeater.reset();
    }

    // Returns the rectangles to draw for the controllers: { wrist (the panel at the wrist), others (rays, the card, ...) }. isStale true:
    // values are from before the connection was lost.
    boards(now, isStale) {
        const { headset } = this, { session, xr } = headset, head = poseOf(headset.rig, headset.head).at, list = [];
        for (const { at, along: direction, target } of this.rays.values()) {
            const end = target?.point ?? along(at, direction, RAY_M), middle = scale(add(at, end), 0.5), y = unit(subtract(end, at));
            const x = unit(cross(y, subtract(head, middle)));
            list.push({ texture: this.line.texture, at: middle, axes: [x, y, cross(x, y)], width: RAY_WIDE_M,
                height: length(subtract(end, at)) });
            if (target?.kind === 'floor')
                list.push({ texture: this.ring.texture, at: target.point, axes: [headset.rig.axes[0], headset.rig.axes[2], this.up],
                    width: RING_M, height: RING_M });
        }
        if (this.card && !isStale) {
            showCard(this.paper, cardLines(session, this.card.picked, now));
            const { at } = this.card, away = length(subtract(at, head)), axes = headset.facing(at), seen = this.paper.seenFrom(away);
            list.push({ ...seen, at: along(at, axes[1], seen.height * 0.62), axes });
        }
        const panel = this.panel();
        if (panel) {
            const pointed = [...this.rays.values()].find(({ target }) => target?.kind === 'wrist')?.target.place;
            this.wristButton = showWrist(this.wrist, session, pointed, () => xr.end().catch(() => {})).over;
        }
        return { others: list, wrist: panel ? [{ ...panel, texture: this.wrist.texture }] : [] };
    }
}
