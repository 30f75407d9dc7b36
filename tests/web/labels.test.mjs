// SPDX-License-Identifier: GPL-3.0-or-later
// Labels by the rule of protocol/LABELS.md: with the server's test vectors, and properties that hold for every picture.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { INK, Overlay } from '../../clients/web/app/viewport/overlay.js';
import { projector } from '../../clients/web/core/camera.js';
import { placeRings } from '../../clients/web/core/callouts.js';
import { FIRST_FAR, leaderLine, placeLabels } from '../../clients/web/core/labels.js';
import { randomNumbers } from './random.mjs';

const random = randomNumbers();

const folder = new URL('../../protocol/vectors/labels/', import.meta.url);
const box = ([left, top, right, bottom]) => ({ left, top, right, bottom });

for (const name of readdirSync(folder)) {
    const vector = JSON.parse(readFileSync(new URL(name, folder), 'utf8'));
    test(`labels ${name}: ${vector.what}`, () => {
        const names = ['x', 'y', 'width', 'height', 'rank', 'depth', 'held', 'ring', 'callout'];
        const items = vector.items.map((row, id) => ({ id, ...Object.fromEntries(names.map((n, i) => [n, row[i]])) }));
        for (const [i, item] of items.entries()) {
            item.callout = item.callout >= 0 ? item.callout : undefined;
            item.tag = { asset: vector.items[i][9] === undefined ? null : `asset ${vector.items[i][9]}` };
        }
        const measure = () => ({ width: vector.callout[0], height: vector.callout[1] });
        const placed = placeLabels(items, { area: box(vector.area), unit: vector.unit, blocked: vector.blocked.map(box), rings: placeRings,
            measure });
        assert.deepEqual(items.map(({ id }) => placed.get(id)?.slot ?? -1), vector.slots);
        assert.deepEqual(items.map(({ id }) => placed.get(id)?.callout ?? -1), vector.callouts ?? items.map(() => -1));
        assert.deepEqual(items.map(({ id }) => Number(placed.get(id)?.leads ?? 0)), vector.leads ?? items.map(() => 0));
    });
}

const area = { left: 0, top: 0, right: 1280, bottom: 720 };

test('labels cover no other label and no mark, lie inside, and important ones are placed more often', () => {
    for (let round = 0; round < 30; round++) {
        const items = Array.from({ length: 300 }, (_, id) => ({
            id, x: random(0, 1280), y: random(0, 720), width: random(50, 130), height: 20,
            rank: Math.floor(random(0, 4)), depth: random(1, 90),
        }));
        const placed = placeLabels(items, { area });
        const boxes = [...placed].map(([id, { left, top }]) => ({ id, left, top, right: left + items[id].width, bottom: top + 20 }));
        assert.ok(boxes.length > 30);
        for (const a of boxes) {
            assert.ok(a.left >= 0 && a.top >= 0 && a.right <= 1280 && a.bottom <= 720);
            for (const b of boxes)
                assert.ok(a === b || a.left >= b.right || b.left >= a.right || a.top >= b.bottom || b.top >= a.bottom);
            for (const { id, x, y } of items)
                assert.ok(id === a.id || x + 5 <= a.left || x - 5 >= a.right || y + 5 <= a.top || y - 5 >= a.bottom);
        }
        const share = (rank) => {
            const mine = items.filter((item) => item.rank === rank);
            return mine.filter(({ id }) => placed.has(id)).length / mine.length;
        };
        assert.ok(share(3) > share(0));
    }
});

// Checks the leader lines of a call-out. If one to four of its rings are within 60 units, each of these has a line; otherwise
// only the nearest ring has. Rings that the call-out covers have none.
function checkLeaders(members, placed) {
    const far = ({ id, x, y }) => {
        const [x1, y1, x2, y2] = leaderLine({ x, y, ...placed.get(id) }, placed.get(id), 0);
        return Math.hypot(x2 - x1, y2 - y1);
    };
    const open = members.filter((item) => far(item) >= 13), nearest = Math.min(...open.map(far));
    const most = open.filter((item) => far(item) <= 60).length > 4 ? nearest : Math.max(60, nearest);
    for (const item of members)
        assert.equal(placed.get(item.id).leads, far(item) >= 13 && far(item) <= most,
            `a leader line is drawn only from 13 up to ${most}, the label is at ${far(item)}`);
}

const distance = ({ x, y }, { left, top, right, bottom }) => Math.hypot(Math.max(left - x, x - right, 0), Math.max(top - y, y - bottom, 0));

// Checks that labels keep 10 units from the outer edge of the widest ring (15.5 units from its centre) of another label, and that labels
// of rings are at most 60 units from one of them. Exempt is a call-out for all rings, the only label of rings.
function checkRoom(items, placed, boxes) {
    for (const { id, ring } of items) {
        const place = placed.get(id), box = place && { left: place.left, top: place.top, right: place.left + (place.width ?? 110),
            bottom: place.top + (place.height ?? 20) };
        const mine = items.filter((one) => one.ring && (one.id === id || (place?.callout ?? -1) === placed.get(one.id)?.callout));
        assert.ok(!ring || boxes.size === 1 || mine.some((one) => distance(one, box) <= 60), `${id}: a leader line is too long`);
        for (const other of place && !(ring && boxes.size === 1) ? items.filter((one) => one.ring && one.id !== id) : []) {
            const isShared = place.callout !== undefined && placed.get(other.id)?.callout === place.callout;
            assert.ok(distance(other, box) >= (isShared ? 13 : 25.5) - 1e-9, `${id}: ${distance(other, box)} from ring ${other.id}`);
        }
    }
}

// Random pictures from the size of a phone to that of a wall, with few or many rings, and with a legend in the way.
test('every alarm ring has a label or a call-out, within the picture, over no legend, and with room around', () => {
    for (let round = 0; round < 300; round++) {
        const [right, bottom] = [random(170, 1300), random(110, 700)], legend = { left: right - 90, right, top: 0, bottom: bottom * 0.8 };
        const near = random(0, 1) < 0.5 ? 40 : 2000, centre = [random(0, right), random(0, bottom)];
        const clamp = (x, most) => Math.max(0, Math.min(most, x));
        const items = Array.from({ length: 1 + Math.floor(random(0, 60)) }, (_, id) => {
            const ring = id % 4 > 0;
            return { id, x: clamp(centre[0] + random(-near, near), right), y: clamp(centre[1] + random(-near, near), bottom), width: 110,
                height: 20, rank: ring ? 3 : 0, ring, depth: random(1, 90) };
        });
        const placed = placeLabels(items, { area: { left: 0, top: 0, right, bottom }, blocked: [legend], rings: placeRings,
            measure: () => ({ width: 130, height: 36 }) });
        const rings = items.filter(({ ring }) => ring), boxes = new Map();
        for (const { id } of rings) {
            const place = placed.get(id);
            assert.ok(place, `ring ${id} of ${rings.length} has no label in a picture of ${right} x ${bottom}`);
            if (place.callout !== undefined)
                checkLeaders(items.filter((item) => placed.get(item.id)?.callout === place.callout), placed);
            boxes.set(place.callout ?? id, { ...place, right: place.left + place.width, bottom: place.top + place.height });
        }
        const list = [...boxes.values()];
        assert.ok(list.every((a) => a.left >= 0 && a.top >= 0 && a.right <= right && a.bottom <= bottom));
        if (bottom * 0.2 < 60 && right - 90 < 165)
            continue; // in such small pictures there is hardly any room for a label beside the legend, so covering it is not checked
        for (const [i, a] of list.entries())
            assert.ok([[legend, 0], ...list.slice(0, i).map((b) => [b, 8 - 1e-9])].every(([b, apart]) => a.left - b.right >= apart ||
                b.left - a.right >= apart || a.top - b.bottom >= apart || b.top - a.bottom >= apart));
        checkRoom(items, placed, boxes);
    }
});

// Returns the number of rings that a label covers: those whose square of 32 units the label overlaps.
const coveredBy = (rings, { left, top, right, bottom }) =>
    rings.filter(({ x, y }) => left < x + 16 && x - 16 < right && top < y + 16 && y - 16 < bottom).length;

// Tries all positions one after the other, unlike the page.
function fewestCovered(rings, { right, bottom }, legend, { width, height }) {
    let least = Infinity;
    const step = Math.max(4, Math.max(right, bottom) / 512);
    for (let top = 0; top <= bottom - height; top += step) {
        for (let left = 0; left <= right - width; left += step) {
            const box = { left, top, right: left + width, bottom: top + height };
            if (box.right <= legend.left || box.top >= legend.bottom)
                least = Math.min(least, coveredBy(rings, box));
        }
    }
    return least;
}

test('a call-out for all rings covers none if any place allows that, otherwise as few as possible, and has a leader line', () => {
    const size = { width: 130, height: 36 }, found = { none: 0, some: 0 };
    for (let round = 0; round < 300; round++) {
        const [right, bottom] = [random(170, 560), random(110, 320)], legend = { left: right - 60, right, top: 0, bottom: bottom * 0.6 };
        const items = Array.from({ length: 5 + Math.floor(random(0, round % 3 ? 40 : 200)) }, (_, id) => ({
            id, x: random(0, right), y: random(0, bottom), width: 110, height: 20, rank: 3, ring: true, depth: random(1, 90),
        }));
        const placed = placeLabels(items, { area: { left: 0, top: 0, right, bottom }, blocked: [legend], rings: placeRings,
            measure: () => size });
        const [{ left, top, slot, callout }] = placed.values();
        if (callout === undefined || [...placed.values()].some((place) => place.callout !== callout))
            continue;
        const box = { left, top, right: left + size.width, bottom: top + size.height };
        const open = items.filter((item) => distance(item, box) >= 13), leads = items.filter(({ id }) => placed.get(id).leads);
        assert.ok(leads.every((item) => open.includes(item)) && (leads.length > 0 || open.length === 0));
        const covered = slot < 1000000 ? items.length - open.length : coveredBy(items, box);
        const least = covered > 0 ? fewestCovered(items, { right, bottom }, legend, size) : 0;
        assert.equal(slot === 1000000 ? Infinity : covered, least, `${covered} of ${items.length} rings in ${right} x ${bottom}`);
        assert.ok(slot === 1000000 || box.right <= legend.left || box.top >= legend.bottom, 'the call-out covers no legend');
        found[covered > 0 ? 'some' : 'none']++;
    }
    assert.ok(found.none > 10 && found.some > 10, JSON.stringify(found));
});

// Two cameras look at a plant of 60 sensors: one turns around it by a quarter of a degree per picture; one trembles by a
// fraction of a pixel.
const sensors = Array.from({ length: 60 }, (_, i) => {
    const away = 12 * Math.sqrt(i / 60);
    return [away * Math.cos(i * 2.4), away * Math.sin(i * 2.4), (i % 7) * 1.5];
});
function labelsFrom(angle, places) {
    const camera = { eye: [40 * Math.cos(angle), 40 * Math.sin(angle), 20], target: [0, 0, 4], up: [0, 0, 1], fov: 45 };
    const project = projector(camera, 1280, 720);
    const items = sensors.map((sensor, id) => {
        const [x, y, depth] = project(sensor);
        return { id, x, y, width: 64, height: 20, rank: id % 9 === 0 ? 3 : 0, ring: id % 9 === 0, depth, held: places.get(id)?.slot,
            callout: places.get(id)?.callout };
    });
    return placeLabels(items, { area, rings: placeRings, measure: () => ({ width: 130, height: 36 }) });
}

test('labels stay while the camera turns, and do not flicker', () => {
    let places = labelsFrom(0, new Map()), changes = 0, flickers = 0, shown = 0;
    const since = new Map();
    for (let n = 1; n <= 720; n++) {
        const next = labelsFrom((n * Math.PI) / 720, places);
        shown += next.size;
        for (let id = 0; id < sensors.length; id++) {
            if (places.has(id) === next.has(id) && places.get(id)?.slot === next.get(id)?.slot)
                continue;
            changes++;
            flickers += n - (since.get(id) ?? -100) < 4 ? 1 : 0; // changed again within four pictures
            since.set(id, n);
        }
        places = next;
    }
    const perLabelAndPicture = changes / shown;
    console.log(`# ${changes} changes in 720 pictures, ${(100 * perLabelAndPicture).toFixed(2)} % a picture, ${flickers} flickers`);
    assert.ok(perLabelAndPicture < 0.02 && flickers < changes / 10);
});

test('while the camera trembles, no label changes', () => {
    const steady = labelsFrom(1, labelsFrom(1, new Map()));
    let places = steady;
    for (let n = 0; n < 200; n++)
        places = labelsFrom(1 + random(-2e-5, 2e-5), places);
    const slots = (map) => [...map].map(([id, { slot }]) => [id, slot]).sort();
    assert.deepEqual(slots(places), slots(steady));
});

test('a leader line runs from the rim of its marker to the nearest point of its label', () => {
    const item = { x: 100, y: 100, width: 60, height: 20 };
    assert.deepEqual(leaderLine(item, { left: 122, top: 90 }, 5), [105, 100, 122, 100]);
    const [x1, y1, x2, y2] = leaderLine(item, { left: 122, top: 130 }, 5);
    assert.deepEqual([x2, y2], [122, 130]);
    assert.ok(Math.abs(Math.hypot(x1 - 100, y1 - 100) - 5) < 1e-9);
    assert.equal(FIRST_FAR, 12);
});

test('a leader line is dark with a light outline, so that it is visible on every colour', () => {
    const lines = [], context = { beginPath() {}, moveTo() {}, lineTo() {}, stroke() {
        lines.push([this.strokeStyle.startsWith('rgb(255 255 255') ? 'light' : this.strokeStyle, this.lineWidth]);
    } };
    Overlay.prototype.drawLeader.call({ context, radius: 4 }, { x: 100, y: 100, ring: true }, box([150, 90, 210, 110]));
    const [[light, wide], [dark, narrow]] = lines;
    assert.deepEqual([light, dark, lines.length], ['light', INK, 2], 'the dark line is drawn over the light one');
    assert.ok(wide >= narrow + 1.5, `widths: ${wide}, ${narrow}`);
});
