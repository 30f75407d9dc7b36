// SPDX-License-Identifier: GPL-3.0-or-later
// Draws sensor markers and labels sharply over the picture, with the camera of that picture.
import { ALARM_COLOURS, isGone } from '../../core/alarms.js';
import { projector } from '../../core/camera.js';
import { thinOut } from '../../core/declutter.js';
import { changeText, decimalsOf, numberText, unitText, valueText } from '../../core/format.js';
import { halves } from '../../core/split_view.js';
import { FIRST_FAR, leaderLine, MOST_BAD, placeLabels, RANK_RING } from '../../core/labels.js';
import { say } from '../../core/words.js';
import { phone } from '../common/dom.js';

export const INK = '#1d252d';
export const INK_2 = '#4d5964', ACCENT = '#2a5f8f';
export const LABEL_HEIGHT = 20;
const PADDING = 6, NAMES_UP_TO = 24, RING_RADIUS = 10;
// in a picture lower than this (in CSS pixels, not on walls), alarm labels are few, so that the plant stays visible
const LOW_PICTURE = 340;
const LONG_UP_TO = 3; // maximum number of alarm labels with a value in a low picture on a phone or tablet
const touchScreen = globalThis.matchMedia?.('(pointer: coarse)');

const SHAPES = {
    good: (c, r) => c.arc(0, 0, r, 0, 2 * Math.PI),
    uncertain: (c, r) => polygon(c, [[0, -r - 1.5], [r + 1.5, 0], [0, r + 1.5], [-r - 1.5, 0]]),
    bad: (c, r) => polygon(c, [[-r, -r], [r, -r], [r, r], [-r, r]]),
};

function polygon(c, points) {
    points.forEach(([x, y], i) => (i === 0 ? c.moveTo(x, y) : c.lineTo(x, y)));
    c.closePath();
}

// Returns the radius of markers. It is smaller where markers are dense, so that the plant stays visible.
function markerRadius(markers) {
    const xs = markers.map((marker) => marker.x), ys = markers.map((marker) => marker.y);
    const area = (Math.max(...xs) - Math.min(...xs)) * (Math.max(...ys) - Math.min(...ys));
    return markers.length < 2 ? 4.5 : Math.max(2.75, Math.min(4.5, 0.12 * Math.sqrt(area / markers.length)));
}

// Returns whether the user has hidden the asset or isolated others.
export const isHidden = ({ hidden = [], isolate = [], ghost = [] }, id) =>
    hidden.includes(id) || (isolate.length > 0 && !isolate.includes(id) && !ghost.includes(id));

export class Overlay {
    constructor({ canvas, viewport, session, selection }) {
        Object.assign(this, { canvas, viewport, session, selection });
        this.context = canvas.getContext('2d');
        this.font = getComputedStyle(document.body).fontFamily;
        // size in CSS pixels of the unit for markers and labels: 1 on an ordinary page, more on a wall display
        this.unit = 1;
        this.calm = document.body.classList.contains('pane'); // true in a pane of a wall, where only abnormal readings have labels
        // markers { tag, x, y, depth, occluded, reading } of the tags of the shown group and of tags with alarms; x and y in units (see
        // `unit`)
        this.all = [];
        this.markers = []; // the drawn subset of `all`
        this.places = new Map();
        this.widths = new Map();
        // called to load the module for call-outs (labels shared by several alarm rings): there are several rings, or no room
        // for a ring's label
        this.onRings = () => {};
        this.dirty = true;
        this.fresh = true; // true: values are current; false: values are from before the connection was lost
    }

    get wide() {
        return this.viewport.width / this.unit;
    }

    get high() {
        return this.viewport.height / this.unit;
    }

    get isLow() {
        return this.unit === 1 && this.high < LOW_PICTURE;
    }

    // Returns whether alarm labels are short: in a low picture on a phone or tablet. A low window on a desk has room for whole labels,
    // because such a window is wide.
    get isShort() {
        return this.isLow && Boolean(phone?.matches || touchScreen?.matches);
    }

    // Computes the positions of the shown group's sensors in the picture on the screen.
    project() {
        const { model, picture, shown } = this.session;
        if (!model || !picture)
            return [];
        const known = this.session.markersOf(picture.seq);
        return halves(shown, picture.shownWidth).flatMap((half, number) => this.projectHalf(half, number, known));
    }

    projectHalf({ params, left, width }, number, known) {
        const { model, picture } = this.session;
        const scale = [this.wide / picture.shownWidth, this.high / picture.fullHeight];
        // margin in pixels around the picture in which markers are still drawn; 0 in a split view, where they would appear in
        // the other half
        const rim = params.split ? 0 : 20;
        const project = projector(picture.camera, width, picture.fullHeight);
        const markers = [];
        for (const tag of model.tags) {
            const shown = tag.group === params.group;
            const alarm = tag.asset && isHidden(params, tag.asset) ? null : model.alarms.gravest(tag.index);
            const unsaid = known && shown ? undefined : { occluded: false, quality: null };
            const said = (shown && known?.get(`${tag.index}/${number}`)) || (alarm ? { occluded: true, quality: null } : unsaid);
            const place = said && (shown || alarm) && tag.position ? project(tag.position) : null;
            if (!place || place[0] < -rim || place[1] < -rim || place[0] > width + rim || place[1] > picture.fullHeight + rim)
                continue;
            const newest = model.readings[tag.index];
            // prefers the value and quality used for the picture, if the server sent them, to a newer reading
            const pictured = said.quality ? { ...newest, value: said.value, quality: said.quality } : newest;
            const difference = params.show === 'difference' && shown, away = params.show === 'distance' && shown;
            markers.push({
                tag, x: (left + place[0]) * scale[0], y: place[1] * scale[1], depth: place[2], half: number,
                occluded: said.occluded, reading: difference || away ? newest : pictured, alarm,
                // change from the saved baseline; null: unknown; false: the view does not show changes
                change: difference && (said.quality === 'bad' ? null : said.value ?? null),
                // distance from the chosen sensor; null: there is none, for example on other equipment; false: the view does not show
                // distances
                distance_m: away && (said.value ?? null),
                origin: away && tag.name === params.sensor,
            });
        }
        return markers;
    }

    marker(tag) {
        return this.all.find((marker) => marker.tag === tag) ?? null;
    }

    // Thins out the markers of each half of the view where they are dense. Returns those to draw, farthest first.
    thinned() {
        const id = ({ tag, half }) => tag.index * 2 + half, { selected } = this.session.params;
        // tags whose markers the previous picture drew, without those that it drew only because they are always drawn (`kept`)
        const before = new Set(this.markers.filter(({ kept, held }) => held || !kept).map(id));
        for (const marker of this.all) {
            const { tag, alarm, origin, reading } = marker;
            marker.kept = alarm || origin || reading.quality !== 'good' || tag.asset === selected || this.isChosen(tag) ||
                this.isMarked?.(tag);
            marker.held = before.has(id(marker));
        }
        const drawn = [0, 1].flatMap((number) => thinOut(this.all.filter(({ half }) => half === number)));
        return drawn.sort((a, b) => b.depth - a.depth);
    }

    // Returns the position of a marker in CSS pixels of the viewport; markers have their positions in units (this.unit).
    placeOf({ x, y }) {
        return { x: x * this.unit, y: y * this.unit };
    }

    draw() {
        this.dirty = false;
        const { wide: width, high: height, unit } = this, ratio = window.devicePixelRatio * unit;
        const c = this.context;
        const pixels = [Math.round(width * ratio), Math.round(height * ratio)];
        if (this.canvas.width !== pixels[0] || this.canvas.height !== pixels[1])
            [this.canvas.width, this.canvas.height] = pixels;
        c.setTransform(ratio, 0, 0, ratio, 0, 0);
        c.clearRect(0, 0, width, height);
        this.all = this.project();
        this.markers = this.thinned();
        this.radius = markerRadius(this.all.filter((marker) => !marker.occluded));
        const labels = this.labels(), blocked = this.blocked();
        this.places = this.place(labels, blocked);
        this.arrows?.draw();
        for (const marker of this.markers)
            this.drawMarker(marker);
        this.drawMore?.();
        this.drawLabels(labels);
        const boxes = labels.filter(({ id }) => this.places.has(id)).map(({ id, width: w, height: h }) => {
            const { left, top, width: wide = w, height: high = h } = this.places.get(id);
            return { left, top, right: left + wide, bottom: top + high };
        });
        const marks = this.markers.map(({ x, y }) => ({ left: x - 5, right: x + 5, top: y - 5, bottom: y + 5 }));
        this.isolines?.draw([...blocked, ...boxes, ...marks]);
    }

    // Returns the boxes of HTML elements over the picture that do not move with it (legend, banner, open panels, ...) and of
    // elements that match the selector `more`. The unit is this.unit CSS pixels.
    boxesOver(more) {
        const { unit, viewport: { element } } = this, origin = element.getBoundingClientRect();
        const within = element.querySelectorAll(`.legend, .banner, .simulated-note, .chip, #plant-notes, .moment, .split-bar${more}`);
        return [...within, ...document.querySelectorAll('.toolbar .open')]
            .map((e) => e.getBoundingClientRect()).filter((box) => box.width > 0).map((box) => ({
                left: (box.left - origin.left) / unit, right: (box.right - origin.left) / unit,
                top: (box.top - origin.top) / unit, bottom: (box.bottom - origin.top) / unit,
            }));
    }

    // Returns the boxes that labels must not cover.
    blocked() {
        const own = this.boxesOver(', .card, .note-pin');
        const middle = this.wide / 2; // also blocks the line between the halves of a split view, so that no label crosses it
        return this.session.shown.split ? [...own, { left: middle - 1, right: middle + 1, top: 0, bottom: this.high }] : own;
    }

    isChosen(tag) {
        return tag.name === this.selection.tag || tag === this.selection.hover;
    }

    // Places the labels of each half of a split view. Requests the module for call-outs (labels shared by several alarm rings)
    // if rings may need it.
    place(labels, blocked) {
        const { shown } = this.session, { wide: width, high: height, callouts } = this;
        const placed = halves(shown, width).map((half, number) => placeLabels(labels.filter((label) => label.half === number), {
            area: { left: half.left, top: 0, right: half.left + half.width, bottom: height }, blocked,
            rings: callouts?.place, measure: (members) => callouts.measure(members),
        }));
        const all = new Map(placed.flatMap((one) => [...one])), rings = labels.filter(({ rank }) => rank === RANK_RING);
        if (!callouts && (rings.length > 1 || rings.some(({ id, bad }) => bad || !all.has(id))))
            this.onRings();
        return all;
    }

    // Returns labels for all visible markers and all alarm rings, in the order of tags. The selected tag has a card instead, if there is
    // room for it (cards/card_position.js).
    labels() {
        const hasCard = !document.querySelector('#card.no-room');
        const marks = this.markers.filter((marker) => !marker.occluded || marker.alarm);
        const inSight = marks.filter(({ occluded }) => !occluded);
        marks.sort((a, b) => a.tag.index - b.tag.index || a.half - b.half);
        const tooMany = inSight.filter(({ reading }) => reading.quality === 'bad').length > MOST_BAD;
        const named = inSight.length <= NAMES_UP_TO;
        const short = this.isShort && marks.filter(({ alarm }) => alarm).length > LONG_UP_TO;
        return marks.map((marker) => {
            const { tag, reading } = marker, id = `${tag.index}/${marker.half}`;
            const { alarm } = marker;
            const onSelected = tag.asset === this.session.params.selected;
            const parts = short && alarm ? [[tag.name, 400, INK_2], [alarm.kind, 700, null]]
                : this.parts(marker, named || onSelected || marker.origin || alarm !== null);
            const width = this.lineWidth(parts);
            const bad = reading.quality === 'bad', unseen = (marker.occluded || marker.distance_m === null) && !alarm;
            const silent = unseen || (hasCard && this.isChosen(tag)) || (bad && tooMany && !alarm) ||
                ((this.calm || short) && !alarm && !bad);
            const rank = silent ? -1 : alarm ? RANK_RING : bad || marker.origin ? 2 : reading.quality !== 'good' || onSelected ? 1 : 0;
            const { x, y, depth, half } = marker;
            const { slot: held, callout } = this.places.get(id) ?? {}, ring = alarm !== null;
            return { id, half, x, y, width, height: LABEL_HEIGHT, rank, depth, held, callout, parts, alarm, ring, bad, tag };
        });
    }

    // Returns a label's pieces as a list of [text, font weight, colour].
    parts({ tag, reading, change, distance_m, alarm }, withName) {
        const parts = withName ? [[tag.name, 400, INK_2]] : [];
        const held = alarm && reading.quality === 'bad' && this.callouts?.held(tag, alarm);
        if (held)
            return [...parts, ...held];
        const group = this.session.model.group(tag.group);
        if (distance_m !== false) {
            if (distance_m !== null)
                parts.push([`${numberText(distance_m, 2)}\u202fm`, 650, INK]);
        } else if (change !== false && reading.quality !== 'bad') {
            parts.push([changeText(change, decimalsOf(group, change)), ...(this.fresh ? [650, INK] : [400, INK_2])]);
            parts.push([change === null ? '' : unitText(tag.unit || group.unit), 400, INK_2]);
        } else if (reading.value === null || reading.quality === 'bad') {
            parts.push([say('novalue'), 400, INK_2]);
        } else {
            parts.push([valueText(group, reading.value), ...(this.fresh ? [650, INK] : [400, INK_2])]);
            parts.push([unitText(tag.unit || group.unit), 400, INK_2]);
        }
        if (alarm)
            parts.push([alarm.kind, 700, null]);
        return parts;
    }

    width([text, weight]) {
        const key = weight + text.replace(/\d/g, '0'); // digits have equal width
        if (!this.widths.has(key)) {
            this.setFont(weight);
            this.widths.set(key, this.context.measureText(text.replace(/\d/g, '0')).width);
        }
        return this.widths.get(key);
    }

    setFont(weight) {
        this.context.font = `${weight} 12.5px ${this.font}`;
    }

    // Draws an alarm ring around a marker, with a dark and a light rim, so that it is seen on every colour. Its colour shows the priority.
    // Its form shows the state: thick and slowly blinking while unacknowledged, thin once acknowledged, hollow after the return to normal.
    drawAlarm({ priority, state, waiting }) {
        const c = this.context, blinks = waiting && document.body.classList.contains('alarm-blink'), gone = isGone(state);
        const wide = (!waiting || blinks ? 2.5 : 4.5) + (gone ? 2.5 : 0), colour = ALARM_COLOURS[priority - 1][0];
        const strokes = [['#fff', wide + 4], [INK, wide + 1.8], [colour, wide], ...gone ? [['#fff', 2.5]] : []];
        for (const [style, width] of strokes) {
            c.beginPath();
            c.arc(0, 0, RING_RADIUS, 0, 2 * Math.PI);
            c.lineWidth = width;
            c.strokeStyle = style;
            c.stroke();
        }
    }

    drawMarker({ tag, x, y, occluded, reading, alarm, origin }) {
        const c = this.context, chosen = this.isChosen(tag);
        c.save();
        c.translate(x, y);
        if (alarm)
            this.drawAlarm(alarm);
        c.beginPath();
        const unproven = this.session.model.unproven(tag), radius = occluded ? 2.5 : unproven ? Math.max(4, this.radius) : this.radius;
        (SHAPES[reading.quality] ?? SHAPES.bad)(c, radius);
        c.lineWidth = occluded ? 1.25 : 1.5;
        if (unproven)
            c.setLineDash([(2 * Math.PI * radius) / 10]);
        if (occluded && !chosen) {
            c.globalAlpha = 0.5;
        } else {
            c.fillStyle = '#fff';
            c.fill();
        }
        c.strokeStyle = INK;
        c.stroke();
        c.setLineDash([]);
        if (tag.place === 'equipment') { // draws a second ring to show that the position is assumed
            c.beginPath();
            c.arc(0, 0, radius + 3, 0, 2 * Math.PI);
            c.lineWidth = 1;
            c.stroke();
        }
        this.drawTried?.(tag);
        if (reading.quality === 'bad' && !occluded) {
            c.beginPath();
            const arm = this.radius - 2;
            for (const side of [-arm, arm]) {
                c.moveTo(-arm, -side);
                c.lineTo(arm, side);
            }
            c.stroke();
        }
        if (chosen || origin) {
            c.beginPath();
            c.arc(0, 0, alarm ? 14.5 : 9.5, 0, 2 * Math.PI);
            c.lineWidth = 2.5;
            c.strokeStyle = chosen ? ACCENT : INK;
            c.stroke();
        }
        c.restore();
    }

    drawLabels(labels) {
        const places = labels.map((label) => [label, this.places.get(label.id)]).filter(([, place]) => place);
        for (const [label, place] of places) {
            if (place.leads ?? place.slot >= FIRST_FAR)
                this.drawLeader(label, place);
        }
        for (const [label, place] of places) {
            if (place.callout === undefined) {
                this.drawPlate(place, label);
                this.drawParts(label.parts, place, label.alarm);
            } else if (place.callout === label.id) {
                this.callouts.draw(places.filter((one) => one[1].callout === label.id).map(([member]) => member), place);
            }
        }
    }

    drawLeader(label, place) {
        const c = this.context, [x1, y1, x2, y2] = leaderLine({ ...label, ...place }, place, label.ring ? 12 : this.radius);
        c.beginPath();
        c.moveTo(x1, y1);
        c.lineTo(x2, y2);
        for (const [style, width] of [['rgb(255 255 255 / 0.85)', 3], [INK, 1.25]]) { // draws a dark line with a light outline
            c.lineWidth = width;
            c.strokeStyle = style;
            c.stroke();
        }
    }

    drawPlate({ left, top }, { width, height }) {
        const c = this.context;
        c.beginPath();
        c.roundRect(Math.round(left) + 0.5, Math.round(top) + 0.5, width - 1, height - 1, 4);
        c.fillStyle = 'rgb(255 255 255 / 0.9)';
        c.fill();
        c.lineWidth = 1;
        c.strokeStyle = 'rgb(29 37 45 / 0.3)';
        c.stroke();
    }

    // Draws one line of text.
    drawParts(parts, { left, top }, alarm) {
        const c = this.context, y = Math.round(top);
        c.textBaseline = 'middle';
        let at = Math.round(left) + PADDING;
        for (const part of parts) {
            const wide = this.width(part);
            const flag = part[2] === null, hollow = flag && isGone(alarm.state);
            const [ground, ink] = flag ? ALARM_COLOURS[alarm.priority - 1] : [];
            if (hollow) {
                for (const [style, width] of [[INK, 3.5], [ground, 1.75]]) {
                    c.strokeStyle = style;
                    c.lineWidth = width;
                    c.strokeRect(at - 2, y + 3.5, wide + 4, LABEL_HEIGHT - 7);
                }
            } else if (flag) {
                c.fillStyle = INK;
                c.fillRect(at - 3, y + 2.5, wide + 6, LABEL_HEIGHT - 5);
                c.fillStyle = ground;
                c.fillRect(at - 2, y + 3.5, wide + 4, LABEL_HEIGHT - 7);
            }
            this.setFont(part[1]);
            c.fillStyle = hollow ? INK : part[2] ?? ink;
            c.fillText(part[0], at, y + LABEL_HEIGHT / 2 + 0.5);
            at += wide + 5;
        }
    }

    // Returns the width of a label made of these pieces of text, in units of this.unit CSS pixels.
    lineWidth(parts) {
        return Math.ceil(parts.reduce((sum, part) => sum + this.width(part), 0) + 2 * PADDING + (parts.length - 1) * 5);
    }
}
