// SPDX-License-Identifier: GPL-3.0-or-later
// Alarms in the picture: every alarm ring has a label or a call-out, however small the picture, and none of these covers a
// legend. No ring covers a note. In a low picture, labels are few, and on a phone small. Labels keep away from other rings and
// from each other.
import { test } from 'node:test';
import { demo } from './demo.mjs';
import { openPage, PHONE, settle, shoot, TABLET, waitForPicture, withPage } from '../support/browser.mjs';
import { missing } from '../support/plant.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { becomes } from '../support/until.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
const SCREENS = {
    phone: PHONE,
    'phone across': { ...PHONE, viewport: { width: 844, height: 390 } },
    'far wall': { viewport: { width: 1920, height: 1080 }, query: '?wall=85,8' },
    ...sweep({
        tablet: TABLET,
        'low desk': { viewport: { width: 1280, height: 420 } },
        'desk at 200 %': { viewport: { width: 640, height: 400 }, deviceScaleFactor: 2 },
        desk: { viewport: { width: 1280, height: 800 } },
        wall: { viewport: { width: 1920, height: 1080 }, query: '?wall=55,4' },
    }, {}),
};
const SHORT = ['phone across', 'desk at 200 %']; // screens whose labels are short
// Tags beyond their limits: close together on one machine, hidden behind something, and far from all others.
const ALARMS = ['TE-161', 'TE-162', 'TE-164', 'VT-161', 'VT-162', 'VT-163', 'VT-164', 'TE-151', 'TE-152',
    'TE-211', 'TE-212', 'TE-171', 'TE-101'];
let plant;

setUp(why, async () => {
    plant = await demo();
    for (const tag of ALARMS)
        await plant.ask(`set ${tag} 200`);
    const { page, close } = await openPage(plant.url);
    await waitForPicture(page);
    await page.evaluate(() => {
        const { session } = globalThis.plantcast, add = (note) => session.post({ type: 'note', seq: ++session.toldSeq, ...note });
        add({ text: 'Manhole open', tag: 'TE-162' });
        add({ text: 'Seal drips, the tray is emptied each hour', asset: 'K-101' });
    });
    await page.waitForFunction(() => globalThis.plantcast.session.notes.length === 2);
    await close();
});

const look = (page) => page.evaluate(() => {
    const { overlay } = globalThis.plantcast, rings = overlay.markers.filter(({ alarm }) => alarm);
    const placeOf = ({ tag, half }) => overlay.places.get(`${tag.index}/${half}`);
    const legends = overlay.blocked();
    const over = rings.map(placeOf).filter((place) => place && legends.some((box) => place.left < box.right &&
        box.left < place.left + place.width && place.top < box.bottom && box.top < place.top + place.height));
    const viewport = document.getElementById('viewport').getBoundingClientRect(), { unit } = overlay;
    const pins = [...document.querySelectorAll('.note-pin')].map((pin) => pin.getBoundingClientRect());
    const hides = ({ x, y }) => pins.some(({ left, right, top, bottom }) => viewport.left + (x - 12) * unit < right &&
        left < viewport.left + (x + 12) * unit && viewport.top + (y - 12) * unit < bottom && top < viewport.top + (y + 12) * unit);
    const boxes = new Map(rings.map(placeOf).filter(Boolean).map(({ left, top, width, height }) => [`${left} ${top}`, width * height]));
    const share = [...boxes.values()].reduce((sum, area) => sum + area, 0) / (overlay.wide * overlay.high);
    const stems = [...document.querySelectorAll('.note-stem')], follows = Node.DOCUMENT_POSITION_FOLLOWING;
    const isBelow = (stem) => [document.getElementById('overlay'), ...document.querySelectorAll('.note-pin')]
        .every((other) => stem.compareDocumentPosition(other) & follows) && getComputedStyle(stem).zIndex === 'auto';
    return {
        stems: stems.length, raised: stems.filter((stem) => !isBelow(stem)).length,
        pins: pins.filter(({ width }) => width > 0).length, hidden: rings.filter(hides).length,
        few: !overlay.isLow || (boxes.size <= 9 && share < 0.1), small: !overlay.isShort || (boxes.size <= 6 && share < 0.06),
        isShort: overlay.isShort, lines: overlay.callouts.lines(rings).lines.length,
        rings: rings.length, without: rings.filter((ring) => !placeOf(ring)).map(({ tag }) => tag.name), over: over.length,
        callouts: new Set(rings.map((ring) => placeOf(ring)?.callout).filter((id) => id !== undefined)).size,
    };
});

// Returns the labels that come too close to a ring or to another label of rings, and the length of the longest leader line of a call-out.
// Exempt is the last resort of the rule, a call-out for all rings (protocol/LABELS.md).
const crowded = (page) => page.evaluate(() => {
    const { overlay } = globalThis.plantcast, labels = overlay.labels(), boxes = new Map();
    const distance = ({ x, y }, box) => Math.hypot(Math.max(box.left - x, x - box.right, 0), Math.max(box.top - y, y - box.bottom, 0));
    for (const { id, width, height } of labels) {
        const place = overlay.places.get(id), { width: w = width, height: h = height } = place ?? {};
        if (place)
            boxes.set(id, { ...place, right: place.left + w, bottom: place.top + h });
    }
    const rings = labels.filter(({ ring }) => ring), nameOf = (id) => boxes.get(id)?.callout ?? id;
    const lone = new Set(rings.map(({ id }) => nameOf(id))).size === 1 && rings.length > 1;
    const close = [], together = [];
    for (const [id, box] of boxes) {
        if (lone && nameOf(id) === nameOf(rings[0].id))
            continue;
        close.push(...rings.filter((ring) => distance(ring, box) < (nameOf(ring.id) === nameOf(id) ? 13 : 25.5) - 1e-6 && ring.id !== id)
            .map((ring) => `${id} ${ring.id}`));
    }
    const apart = (a, b) => Math.max(a.left - b.right, b.left - a.right, a.top - b.bottom, b.top - a.bottom);
    for (const { id: a } of rings) {
        together.push(...rings.filter(({ id: b }) => nameOf(a) < nameOf(b) && apart(boxes.get(a), boxes.get(b)) < 8 - 1e-6)
            .map(({ id: b }) => `${a} ${b}`));
    }
    const lines = rings.filter(({ id }) => boxes.get(id).leads).map((ring) => distance(ring, boxes.get(ring.id)));
    return { close, together, lone, longest: Math.round(Math.max(0, ...lines)) };
});

for (const [name, { query = '', ...screen }] of Object.entries(SCREENS))
    test(`every alarm ring has a label or a call-out, and covers no legend or note: ${name}`, options, async (t) => {
        await withPage(`${plant.url}${query}`, screen, async (page) => {
            await waitForPicture(page);
            await page.waitForFunction((least) => globalThis.plantcast.overlay.callouts &&
                document.querySelectorAll('.note-pin').length === 2 &&
                globalThis.plantcast.overlay.markers.filter(({ alarm }) => alarm).length >= least, ALARMS.length - 2);
            await settle(page);
            for (const group of ['temperature', 'vibration']) {
                await page.evaluate((id) => globalThis.plantcast.session.setParams({ group: id }), group);
                await settle(page);
                await becomes(async () => {
                    const { rings, callouts, isShort, lines, ...seen } = await look(page);
                    const { close, together, lone, longest } = await crowded(page);
                    t.diagnostic(`${group}: ${rings} rings, ${callouts} call-outs, longest leader line ${longest}`);
                    return { ...seen, callouts: callouts > 0, close, together, tooLong: longest > 60 && !lone, isShort, lines };
                }, { pins: 2, stems: 2, hidden: 0, without: [], over: 0, raised: 0, few: true, small: true, callouts: true, close: [],
                    together: [], tooLong: false, isShort: SHORT.includes(name), lines: SHORT.includes(name) ? 1 : 2 });
            }
            await shoot(page, `rings-${name.replace(/\W+/g, '-')}`);
        });
    });
