// SPDX-License-Identifier: GPL-3.0-or-later
// Tests how users choose what the picture shows: standard views and parallel projection, sections, ghosted and hidden
// equipment, flights to a tag, and the card of a clicked point.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { demo } from './demo.mjs';
import { drawnAt, openPage, settle, shoot, view, waitForHealth, waitForPicture } from '../support/browser.mjs';
import { missing } from '../support/plant.mjs';
import { setUp } from '../support/set_up.mjs';
import { TinyPlant } from '../support/tiny_plant.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
let plant, browser, page;

setUp(why, async (own) => {
    plant = await demo();
    browser = own(await openPage(plant.url, { viewport: { width: 1200, height: 720 } }));
    page = browser.page;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    await settle(page);
});

// Waits until the camera satisfies `is` and no camera flight is under way.
const arrive = async (is, what) => {
    await page.waitForFunction(is, what);
    await page.waitForFunction(() => !globalThis.plantcast.cameraController.fly);
    await settle(page);
};
const waitFor = (f, what) => page.waitForFunction(f, what);

// Returns the position on the page of the middle of an asset's bounding box; a click there hits the asset's field and no
// marker.
const middleOf = async (id) => drawnAt(page, await page.evaluate((asset) => {
    const { min, max } = globalThis.plantcast.session.model.asset(asset).bounds;
    return min.map((m, i) => (m + max[i]) / 2);
}, id));

// Changes a value and waits until the page has drawn the result.
async function comeIn(change) {
    const { name, index, value } = await page.evaluate(() => {
        const { model } = globalThis.plantcast.session, { name: of, index: i } = model.tags.find(({ asset }) => asset === 'TK-101');
        return { name: of, index: i, value: model.readings[i].value };
    });
    await plant.ask(`set ${name} ${value + change}`);
    await waitFor(([i, was]) => Math.abs(globalThis.plantcast.session.model.readings[i].value - was) > 0.5, [index, value]);
    await settle(page);
}

test('a click opens a card of the place clicked, and the card stays open while values come in', options, async () => {
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: 'TK-101' }));
    await page.evaluate(() => globalThis.plantcast.modules.get('cameraController'));
    const before = (await view(page)).camera.eye;
    await page.keyboard.press('f');
    await arrive((eye) => globalThis.plantcast.session.camera.eye.some((m, i) => m !== eye[i]), before);
    const at = await middleOf('TK-101');
    await page.mouse.click(at.x + 7, at.y + 7);
    await page.locator('#place').waitFor();
    await shoot(page, 'place');
    assert.match(await page.locator('#place h3').textContent(), /TK-101/);
    assert.match(await page.locator('#place .value').textContent(), /^[\d.,]+ °C$/);
    assert.match(await page.locator('#place .state').textContent(), /Between sensors|Measured here/);
    assert.ok(await page.locator('#place .nearest li').count() >= 2);
    await comeIn(1);
    assert.equal(await page.locator('#place').isVisible(), true, 'the card stays while values come in');
    await page.keyboard.press('Escape');
    await comeIn(2);
    assert.equal(await page.locator('#place').isVisible(), false, 'the closed card does not come back');
});

test('each value on a sensor\'s card is beside its title, though the card hides some rows', options, async () => {
    const name = await page.evaluate(() => globalThis.plantcast.session.model.tags.find(({ group, asset }) => group && asset).name);
    await page.evaluate((tag) => globalThis.plantcast.selectTag(globalThis.plantcast.session.model.tag(tag)), name);
    await page.locator('#card h3', { hasText: name }).waitFor();
    const rows = await page.evaluate(() => [...document.querySelectorAll('#card dt')].map((title) => {
        const [a, b] = [title, title.nextElementSibling].map((e) => e.getBoundingClientRect());
        return { hidden: title.hidden, shown: [a, b].map(({ width }) => width > 0).join(), off: Math.abs(a.top - b.top),
            beside: b.left >= a.right };
    }));
    assert.ok(rows.some(({ hidden }) => hidden), 'the card hides a row, for example of a drift that is not known yet');
    for (const { hidden, shown, off, beside } of rows)
        assert.ok(hidden ? shown === 'false,false' : shown.startsWith('true') && off < 3 && beside, JSON.stringify(rows));
    await page.evaluate(() => globalThis.plantcast.selectTag(null));
});

test('for users who prefer reduced motion a flight is a single cut, for others it has cameras on the way', options, async () => {
    const isReduced = () => page.evaluate(() => matchMedia('(prefers-reduced-motion: reduce)').matches), was = await isReduced();
    const cameras = async (reducedMotion) => {
        await page.emulateMedia({ reducedMotion });
        await page.evaluate(() => globalThis.plantcast.modules.get('cameraController'));
        await page.evaluate(() => {
            const { session, cameraController } = globalThis.plantcast, { setCamera } = session;
            globalThis.cameras = 0;
            session.setCamera = (...given) => { globalThis.cameras++; setCamera.apply(session, given); };
            cameraController.flyTo({ ...session.camera, eye: session.camera.eye.map((m) => 1.2 * m) });
        });
        await page.waitForFunction(() => !globalThis.plantcast.cameraController.fly);
        return page.evaluate(() => { delete globalThis.plantcast.session.setCamera; return globalThis.cameras; });
    };
    assert.equal(await cameras('reduce'), 1);
    const count = await cameras('no-preference');
    assert.ok(count > 1, `${count} cameras`);
    await page.emulateMedia({ reducedMotion: was ? 'reduce' : 'no-preference' });
    await settle(page);
});

test('keys set the standard views and the parallel projection', options, async () => {
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: null }));
    await page.keyboard.press('o');
    await page.keyboard.press('t');
    await arrive(() => {
        const { eye, target, height_m: high } = globalThis.plantcast.session.camera;
        return high && Math.abs(eye[0] - target[0]) < 1 && eye[2] > target[2] + 20;
    });
    const { camera } = await view(page);
    assert.ok(camera.height_m > 20 && camera.height_m < 200, `the camera's height is ${camera.height_m} m`);
    assert.ok(camera.eye[2] > camera.target[2] + 20 && Math.abs(camera.eye[0] - camera.target[0]) < 1);
    assert.equal(await page.evaluate(() => globalThis.plantcast.session.picture.camera.height_m > 20), true,
        'the frame has the same projection');
    await shoot(page, 'plan');
    await page.keyboard.press('o');
    await page.keyboard.press('h');
    await arrive(() => globalThis.plantcast.session.camera.height_m === undefined);
    assert.equal((await view(page)).camera.height_m, undefined);
});

test('sections, ghosts and hidden equipment are drawn', options, async () => {
    await page.keyboard.press('v');
    await page.locator('#cut label', { hasText: 'Y' }).click();
    await waitFor(() => globalThis.plantcast.session.confirmed.clip?.planes?.length === 1);
    const { clip } = (await view(page)).params;
    assert.equal(clip.planes[0][1], 1);
    await page.locator('#cut-at').fill('190');
    await waitFor((before) => globalThis.plantcast.session.confirmed.clip.planes[0][3] !== before, clip.planes[0][3]);
    await settle(page);
    const [legend, panel] = await Promise.all(['#legend', '#views'].map((id) => page.locator(id).boundingBox()));
    assert.ok(legend.x + legend.width <= panel.x, 'the legend is beside the panel');
    await shoot(page, 'cut');
    await page.locator('#cut label', { hasText: 'Off' }).click();
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: 'T-101' }));
    const waitForShown = (ghost, hidden) => waitFor((lists) => {
        const { confirmed } = globalThis.plantcast.session;
        return JSON.stringify([confirmed.ghost, confirmed.hidden]) === JSON.stringify(lists);
    }, [ghost, hidden]);
    await page.locator('#shows button', { hasText: 'Transparent' }).click();
    await waitForShown(['T-101'], []);
    await settle(page);
    await page.locator('#shown span', { hasText: /^1 transparent$/ }).waitFor();
    await shoot(page, 'ghost');
    await page.locator('#shows button', { hasText: 'Hide' }).click();
    await waitForShown([], ['T-101']);
    await page.locator('#shown span', { hasText: /^1 of \d+ hidden$/ }).waitFor();
    // T-101 is hidden: its tags lose their markers, except those with an alarm
    await waitFor(() => !globalThis.plantcast.overlay.markers.some(({ tag, alarm }) => tag.asset === 'T-101' && !alarm));
    await page.locator('#show-all').click();
    await waitForShown([], []);
    await page.locator('#shown').waitFor({ state: 'hidden' });
    await page.locator('#shows button', { hasText: 'Only this' }).click();
    await waitFor(() => globalThis.plantcast.session.confirmed.isolate.length === 1);
    const count = await page.evaluate(() => globalThis.plantcast.session.model.assets.length);
    await page.locator('#shown span', { hasText: new RegExp(`^${count - 1} of ${count} hidden`) }).waitFor();
    await page.keyboard.press('Escape');
    await settle(page);
    await shoot(page, 'only');
    await page.locator('#shown button').click();
    await waitFor(() => globalThis.plantcast.session.confirmed.isolate.length === 0);
    await page.locator('#shown').waitFor({ state: 'hidden' });
    assert.deepEqual(browser.errors, []);
});

// For every sixth tag, records whether its point is visible from 5 m in front of its side and from where the flight ends, and
// which share of the picture its equipment fills there.
test('a flight to a tag ends where the tag is visible and its equipment fills 35 % of the picture', options, async (t) => {
    const arrived = await page.evaluate(async () => {
        const { session, cameraController: { approach }, viewport } = globalThis.plantcast, from = session.camera, found = [];
        const { face } = await import('/core/camera_moves.js'), { fillOf } = await import('/core/approach.js');
        for (const tag of session.model.tags.filter(({ position, asset }, i) => position && asset && i % 6 === 0)) {
            if (tag.group !== session.params.group)
                session.setParams({ group: tag.group });
            session.setCamera(from);
            const asset = session.model.asset(tag.asset);
            const own = await approach.look(face(from, tag.position, asset.bounds, 5), tag);
            let to = null;
            await approach.go(tag, asset, (camera) => { to = camera; });
            found.push({ name: tag.name, own: own.seen, seen: (await approach.look(to, tag)).seen,
                fill: fillOf(to, asset.bounds, viewport.width / viewport.height) });
        }
        return found;
    });
    t.diagnostic(`of ${arrived.length} tags ${arrived.filter(({ own }) => own).length} are in sight from their own side`);
    assert.ok(arrived.length >= 20 && arrived.some(({ own }) => !own));
    assert.deepEqual(arrived.filter(({ seen, fill }) => !seen || fill < 0.35), []);
});

test('the camera enters the tag\'s room; an asset close around the tag becomes a ghost, and Backspace undoes both', options, async () => {
    const tiny = await TinyPlant.create();
    tiny.keepFresh();
    const text = readFileSync(tiny.file, 'utf8');
    writeFileSync(tiny.file, text.replace('groups:', `  - { id: HOUSE, model: box.gltf, placement: { scale: 1.15 } }
  - { id: ROOM, model: box.gltf, placement: { translate: [3, 0, 0], scale: 2 } }\ngroups:`));
    await tiny.start();
    await tiny.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
    const own = await openPage(`http://127.0.0.1:${tiny.port}/`, { viewport: { width: 1200, height: 720 } }), on = own.page;
    const ghosts = (ids) => on.waitForFunction((all) => globalThis.plantcast.session.confirmed.ghost.join() === all, ids.join());
    try {
        await waitForPicture(on);
        await on.evaluate(() => globalThis.plantcast.modules.get('cameraController'));
        const inRoom = await on.evaluate(async () => {
            const { session, cameraController: { approach } } = globalThis.plantcast, tag = session.model.tag('PI-1'), cameras = [];
            await approach.go(tag, session.model.asset(tag.asset), (camera) => cameras.push(camera));
            const last = cameras.at(-1), { min, max } = session.model.asset('ROOM').bounds;
            const { seen } = await approach.look(last, tag);
            return { seen, inside: last.eye.every((m, i) => m > min[i] && m < max[i]), ghosts: session.params.ghost ?? [] };
        });
        assert.deepEqual(inRoom, { seen: true, inside: true, ghosts: [] });
        const { camera: before } = await view(on);
        await on.locator('#assets-list .asset', { hasText: 'E-101' }).locator('.twist').click();
        await on.locator('.reading', { hasText: 'TI-1' }).click();
        await ghosts(['HOUSE']);
        await on.waitForFunction(() => !globalThis.plantcast.cameraController.fly);
        await settle(on);
        await on.waitForFunction(() => globalThis.plantcast.overlay.markers.find(({ tag }) => tag.name === 'TI-1')?.occluded === false);
        await on.locator('#shown span', { hasText: /^1 transparent$/ }).waitFor();
        await shoot(on, 'seen-through');
        await on.locator('#viewport').focus();
        await on.keyboard.press('Backspace');
        await ghosts([]);
        await on.waitForFunction((eye) =>
            Math.hypot(...globalThis.plantcast.session.camera.eye.map((m, i) => m - eye[i])) < 1e-6, before.eye);
        await on.locator('#shown').waitFor({ state: 'hidden' });
        assert.deepEqual(own.errors, []);
    } finally {
        await own.close();
        await tiny.destroy();
    }
});

test('the views panel leads to the highest and to the lowest reading in two clicks', options, async () => {
    await page.evaluate(() => globalThis.plantcast.session.setParams({ clip: null, hidden: [], ghost: [], isolate: [] }));
    for (const [name, sign] of [['highest', 1], ['lowest', -1]]) {
        await page.evaluate(() => globalThis.plantcast.selectTag(null));
        await page.locator('#views-toggle').click();
        await page.locator(`[data-extreme=${name}]`).click();
        await page.locator('#views').waitFor({ state: 'hidden' });
        await arrive(() => globalThis.plantcast.selection.tag &&
            document.querySelector('#card h3')?.textContent === globalThis.plantcast.selection.tag);
        const [value, others, isThere, title] = await page.evaluate(() => {
            const { overlay, selection, session: { model: { tag: find, readings, tags }, model, params } } = globalThis.plantcast;
            const tag = find.call(model, selection.tag), all = tags.filter(({ group, asset, position }) =>
                group === params.group && asset && position).map(({ index }) => readings[index]);
            return [readings[tag.index].value, all.filter(({ quality }) => quality !== 'bad').map((one) => one.value),
                Boolean(overlay.marker(tag)), document.querySelector('#card h3').textContent === tag.name];
        });
        assert.ok(others.length > 20 && others.every((other) => sign * (value - other) >= 0), `${name}: ${value} of ${others}`);
        assert.ok(isThere && title);
    }
});
