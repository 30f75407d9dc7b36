// SPDX-License-Identifier: GPL-3.0-or-later
// Places the labels of alarm rings (circles around markers of tags in alarm). Each ring gets its own label, or several rings that are close
// together share one, a call-out (protocol/LABELS.md).
import { awayFrom, boxAt, CLEARANCE, grow, hasArea, HELD, meets, RING, SLOTS } from './labels.js';

// Distances in CSS pixels (larger on a wall). Alarm rings closer than CLOSE get one label together. Rings that already share a label keep
// it up to the distance STILL_CLOSE, so that labels do not flicker.
const CLOSE = 26, STILL_CLOSE = 34;
// MOST_GROUPS: maximum number of labels. While there are more, CLOSE and STILL_CLOSE are multiplied by FARTHER, so that more
// alarm rings share a label.
const MOST_GROUPS = 24, FARTHER = 1.25; // more rings than MOST_GROUPS count as a flood of alarms
const APART = 8; // least distance between two labels of rings, in CSS pixels (larger on a wall)
const MOST_LEADS = 4; // maximum number of leader lines of a call-out; if more rings are within FARTHEST, only the nearest has one
// grid of candidate positions for a label around the centre of its alarm rings: steps in CSS pixels (larger on a wall); STEPS:
// number of steps to each side
const STEP_X = 24, STEP_Y = 15, STEPS = 60;
// maximum distance, in CSS pixels (larger on a wall), of a label from the centre of its nearest alarm ring, unless no other label
// remains; also the maximum length of a leader line, from a label to the centre of a ring
const FARTHEST = 60;
// maximum number of times that CLOSE is multiplied by FARTHER; the result exceeds any picture
const MOST_GROWTHS = 100;
// A second, finer grid over the whole area has the positions at which a call-out for all rings may cover some rings. FINE: step of this
// grid in CSS pixels (larger on a wall); MOST_FINE: maximum number of steps to each side, which limits the time. BLOCKED: weight of a
// position at which the label covers a blocked box; more than the number of rings.
const FINE = 4, MOST_FINE = 512, BLOCKED = 1e9;
const FORCED = 1e6; // slot of a call-out that may cover anything; the next slots are the positions of the second grid, row by row

const OFFSETS = []; // candidate positions for a label relative to the centre of its rings: [x, y, squared distance], nearest first
for (let j = -STEPS; j <= STEPS; j++) {
    for (let i = -STEPS; i <= STEPS; i++)
        OFFSETS.push([i * STEP_X, j * STEP_Y, (i * STEP_X) ** 2 + (j * STEP_Y) ** 2]);
}
OFFSETS.sort((a, b) => a[2] - b[2]); // sort() is stable, so positions at the same distance stay in the order of the grid's rows

// Returns the connected components of a graph as [[index, ...], ...], each ascending, in the order of their first index. linked(i, k), for
// k < i, returns whether nodes i and k are joined.
function components(count, linked) {
    const first = Array.from({ length: count }, (_, i) => i);
    const root = (i) => (first[i] === i ? i : (first[i] = root(first[i])));
    for (let i = 0; i < count; i++) {
        for (let k = 0; k < i; k++) {
            const [a, b] = [root(i), root(k)];
            if (a !== b && linked(i, k))
                first[Math.max(a, b)] = Math.min(a, b);
        }
    }
    const out = new Map();
    for (let i = 0; i < count; i++) {
        if (root(i) === i)
            out.set(i, []);
        out.get(root(i)).push(i);
    }
    return [...out.values()];
}

function boundsOf(members) {
    const xs = members.map(({ x }) => x), ys = members.map(({ y }) => y);
    return [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
}

// Returns the position by which each ring is grouped: its own, or in a flood of alarms the centre of its equipment's rings, so
// that these share a call-out.
function anchorsOf(items, most) {
    const all = new Map();
    for (const item of items.length > most ? items : [])
        all.set(item.tag?.asset, [...(all.get(item.tag?.asset) ?? []), item]);
    const centres = new Map([...all].filter(([asset]) => asset).map(([asset, members]) => {
        const [left, right, top, bottom] = boundsOf(members);
        return [asset, { x: (left + right) / 2, y: (top + bottom) / 2 }];
    }));
    return items.map((item) => centres.get(item.tag?.asset) ?? item);
}

function group(members, measure) {
    const [left, right, top, bottom] = boundsOf(members);
    const [one] = members, alone = members.length === 1, { width, height } = alone ? one : measure(members);
    // the ring whose previous label position is reused; that label must have been of the same kind (own label or call-out)
    const before = members.find(({ callout }) => (callout === undefined) === alone);
    return {
        members, x: (left + right) / 2, y: (top + bottom) / 2, across: (right - left) / 2, down: (bottom - top) / 2, width, height,
        ring: true, held: before?.held ?? -1, owner: alone ? one.id : null, ids: new Set(members.map(({ id }) => id)),
    };
}

function boxOf(one, slot, unit) {
    if (slot < SLOTS.length)
        return boxAt(one, slot, unit);
    const [dx, dy] = OFFSETS[slot - SLOTS.length];
    const left = one.x + dx * unit - one.width / 2, top = one.y + dy * unit - one.height / 2;
    return { left, top, right: left + one.width, bottom: top + one.height };
}

// Returns the position on the second grid at which a label covers the fewest rings: { box, slot, covered }, or null if the label would
// cover a blocked box or leave the area everywhere. The label covers no ring (covered: 0) if any position allows that. Of equal positions,
// the nearest to the centre of the label's rings is chosen; the position of the previous picture counts as nearer than it is (HELD). add()
// marks the positions at which the label overlaps a box in the four corners of their rectangle; sums over the table then give the weight
// of each position. Therefore the time does not grow with the product of positions and rings.
function leastCovering({ x, y, width, height, held }, rings, { area, unit, blocked }) {
    const long = Math.max(area.right - area.left, area.bottom - area.top), step = Math.max(Math.min(FINE * unit, long), long / MOST_FINE);
    const count = (room) => Math.min(MOST_FINE, Math.floor(room / step)) + 1; // 0 or less if the label is larger than the area
    const columns = count(area.right - area.left - width), rows = count(area.bottom - area.top - height);
    if (!(columns > 0 && rows > 0))
        return null;
    const sums = new Float64Array((columns + 1) * (rows + 1)), put = (i, j, weight) => { sums[j * (columns + 1) + i] += weight; };
    const first = (low) => Math.max(0, Math.floor(low / step) + 1), end = (high, most) => Math.min(most, Math.ceil(high / step));
    const add = ({ left, right, top, bottom }, weight) => {
        const [i, k] = [first(left - area.left - width), end(right - area.left, columns)];
        const [j, m] = [first(top - area.top - height), end(bottom - area.top, rows)];
        if (i < k && j < m)
            [[i, j, weight], [k, j, -weight], [i, m, -weight], [k, m, weight]].forEach((corner) => put(...corner));
    };
    blocked.forEach((box) => add(box, BLOCKED));
    for (const ring of rings)
        add(grow({ left: ring.x, right: ring.x, top: ring.y, bottom: ring.y }, (RING + CLEARANCE) * unit), 1);
    let best = null, least = BLOCKED, nearest = Infinity;
    for (let j = 0; j < rows; j++) {
        for (let i = 0; i < columns; i++) {
            const at = j * (columns + 1) + i, above = at - columns - 1;
            sums[at] += (i > 0 ? sums[at - 1] : 0) + (j > 0 ? sums[above] : 0) - (i > 0 && j > 0 ? sums[above - 1] : 0);
            const left = area.left + i * step, top = area.top + j * step;
            const index = j * columns + i, factor = held === FORCED + 1 + index ? HELD * HELD : 1;
            const away = factor * ((left + width / 2 - x) ** 2 + (top + height / 2 - y) ** 2);
            if (sums[at] > least || (sums[at] === least && away >= nearest) || sums[at] >= BLOCKED)
                continue;
            [least, nearest] = [sums[at], away];
            best = { box: { left, top, right: left + width, bottom: top + height }, slot: FORCED + 1 + index, covered: least };
        }
    }
    return best;
}

const hasFiniteBox = ({ x, y, across, down, width, height }) => [x, y, across, down, width, height].every(Number.isFinite);
const placeable = (items, area, unit) => (hasArea(area) && unit > 0 && unit < Infinity
    ? items.filter(({ x, y, width, height }) => [x, y, width, height].every(Number.isFinite)) : []);

// Places labels. all: items with rings that need labels, the most important first; measure(members) returns { width, height } of their
// call-out; taken: occupied space (labels.js); blocked: boxes that labels must not cover; rings: all items with rings, by default `all`;
// most: maximum number of labels. Returns [{ members, box, slot, leads }, ...]. Each item at a finite position is a member of one label.
// leads: Set of those members of a call-out that have a leader line. In an area of 0x0 there are no labels.
export function placeRings(all, { area, unit, taken, blocked = [], rings = all, measure, most = MOST_GROUPS }) {
    const order = placeable(all, area, unit);
    let lists, least = unit;
    const anchors = anchorsOf(order, most);
    const close = (i, k) => {
        const a = anchors[i], b = anchors[k], did = order[i].callout !== undefined && order[i].callout === order[k].callout;
        return (a.x - b.x) ** 2 + (a.y - b.y) ** 2 < ((did ? STILL_CLOSE : CLOSE) * least) ** 2;
    };
    for (let n = 0; (lists = components(order.length, close)).length > most && n < MOST_GROWTHS; n++)
        least *= FARTHER;
    let groups = lists.map((list) => group(list.map((i) => order[i]), measure)).filter(hasFiniteBox);
    for (;;) {
        const out = [], lost = [], alone = groups.length === 1;
        for (const one of groups) {
            const slot = find(one, out, alone), { members } = one;
            if (slot !== null)
                out.push({ members, slot, box: boxOf(one, slot, unit) });
            else if (alone)
                out.push({ members, ...(leastCovering(one, placeable(rings, area, unit), { area, unit, blocked }) ?? forced(one)) });
            else
                lost.push(groups.indexOf(one));
        }
        if (lost.length === 0)
            return out.map(withLeads);
        const mates = new Map(lost.map((i) => [i, nearest(i)]));
        const joined = components(groups.length, (i, k) => mates.get(i) === k || mates.get(k) === i)
            .map((list) => group(order.filter((item) => list.some((i) => groups[i].members.includes(item))), measure)).filter(hasFiniteBox);
        if (joined.length >= groups.length)
            return out.map(withLeads); // no groups are left to merge, so groups that find no room get no label
        groups = joined;
    }

    // Chooses which members of a call-out have a leader line: those near its box, or only the nearest if none or too many are near. More or
    // longer lines would hide the plant. A ring that the call-out covers has no line.
    function withLeads(one) {
        const { members, box } = one, far = members.map((item) => awayFrom(item, box)), open = far.filter((away) => away >= RING * unit);
        const nearest = Math.min(...open), near = open.filter((away) => away <= FARTHEST * unit).length;
        const most = near > MOST_LEADS ? nearest : Math.max(FARTHEST * unit, nearest);
        const leads = (_, i) => far[i] >= RING * unit && far[i] <= most;
        return members.length > 1 ? { ...one, leads: new Set(members.filter(leads)) } : one;
    }

    // Returns whether a label's box is near a ring of a group.
    function isNear({ x, y, across, down, members }, box) {
        const isNearRings = awayFrom({ x, y }, box, across, down) <= FARTHEST * unit; // a fast check that most boxes fail
        return isNearRings && members.some((item) => awayFrom(item, box) <= FARTHEST * unit);
    }

    // Returns the slot of a free position for a label, or null if none is free. alone: the label is the only one, so that it may be far
    // from its rings.
    function find(one, out, alone) {
        const isApart = (box) => !out.some((other) => meets(box, other.box));
        const free = (slot, more, over) => {
            const box = boxOf(one, slot, unit), owner = slot < SLOTS.length ? one.owner : null;
            const inside = box.left >= area.left && box.top >= area.top && box.right <= area.right && box.bottom <= area.bottom;
            return inside && (alone || isNear(one, box)) && !taken.meets(grow(box, more), owner, over, one.ids) &&
                isApart(grow(box, more + APART * unit));
        };
        const isKnown = one.held >= 0 && one.held < SLOTS.length + OFFSETS.length;
        if (isKnown && isNear(one, boxOf(one, one.held, unit)) && free(one.held, 0, 1))
            return one.held;
        for (const over of [0, 1]) {
            for (let slot = 0; slot < SLOTS.length; slot++) {
                if (free(slot, CLEARANCE * unit, over))
                    return slot;
            }
        }
        for (let n = 0; n < OFFSETS.length; n++) {
            if (free(SLOTS.length + n, CLEARANCE * unit, 1))
                return SLOTS.length + n;
        }
        return null;
    }

    // Returns a position over the label's rings, moved as far into the area as possible: { slot, box }. The label may cover anything there.
    function forced(one) {
        const left = Math.max(area.left, Math.min(area.right - one.width, one.x - one.width / 2));
        const top = Math.max(area.top, Math.min(area.bottom - one.height, one.y - one.height / 2));
        return { slot: FORCED, box: { left, top, right: left + one.width, bottom: top + one.height } };
    }

    function nearest(i) {
        const a = groups[i], apart = groups.map((b, k) => (k === i ? Infinity
            : Math.max(0, Math.abs(a.x - b.x) - a.across - b.across) ** 2 + Math.max(0, Math.abs(a.y - b.y) - a.down - b.down) ** 2));
        return apart.indexOf(Math.min(...apart));
    }
}
