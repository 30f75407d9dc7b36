// SPDX-License-Identifier: GPL-3.0-or-later
// The plant on a headset: an emulated Quest 3 (npm's iwer) in chromium.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { DESKTOP, openPage, readPng, SCREENSHOTS, SHOOTS, waitForHealth, waitForPicture, withPage } from './support/browser.mjs';
import { aimAt, enterVr, EYE, eyesPng, headsetScript, IPD_M, lookFrom, pull, SCREEN, seen, SMALL } from './support/headset.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, TinyPlant } from './support/tiny_plant.mjs';
import { becomes, until } from './support/until.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
const PX_PER_TAN = EYE.height / 2; // focal length of one eye in pixels: its field of view is 90 degrees
let plant;

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    plant.keepFresh();
    await plant.start();
    await plant.set({ 'TI-1': 94, 'TI-2': 94, 'PI-1': 5 }); // readings that give the field one colour everywhere
});

// expected: a script error that the emulator itself causes.
async function withHeadset(f, { at = plant, expected = null, screen = SMALL } = {}) {
    const { page, errors, close } = await openPage(`http://127.0.0.1:${at.port}/?lang=en`, screen, headsetScript());
    try {
        await waitForPicture(page);
        await waitForHealth(page, 'live');
        await page.waitForFunction(() => globalThis.plantcast.session.model.readings.slice(0, 2).every(({ value }) => value === 94));
        await f(page);
        assert.deepEqual(errors.filter((text) => !expected?.test(text)), []);
    } finally {
        await close();
    }
}
const state = (page, name) => page.evaluate((key) => globalThis.plantcast.modules.there('enterVr').headset?.[key] ?? null, name);
const hasEnded = (page) => page.waitForFunction(() => !globalThis.plantcast.modules.there('enterVr').headset);
const keep = async (page, name) => SHOOTS && writeFileSync(`${SCREENSHOTS}/${name}.png`, await eyesPng(page));

test('the VR button is shown only if there is a headset and the server sends depth', options, async (t) => {
    await withPage(`http://127.0.0.1:${plant.port}/`, DESKTOP, async (page) => {
        await waitForPicture(page);
        await page.waitForFunction(() => globalThis.plantcast.modules);
        assert.equal(await page.evaluate(() => document.featurePolicy.allowsFeature('xr-spatial-tracking')), true);
        assert.equal(await page.locator('#enter-vr').count(), 0);
        const files = await page.evaluate(() => performance.getEntriesByType('resource').map(({ name }) => name));
        assert.deepEqual(files.filter((name) => name.includes('/xr')), []);
    });
    const flat = await TinyPlant.create();
    t.after(() => flat.destroy());
    writeFileSync(flat.file, readFileSync(flat.file, 'utf8').replace('name: Two boxes', 'name: Two boxes\n  reprojection: off'));
    await flat.start();
    await flat.set({ 'TI-1': 94, 'TI-2': 94, 'PI-1': 5 });
    await withHeadset(async (other) => {
        await other.locator('#enter-vr').waitFor({ state: 'attached' });
        assert.equal(await other.locator('#enter-vr').isVisible(), false);
    }, { at: flat, screen: SCREEN });
});

// Returns the server's snapshot from the position of an eye, which serves as the reference.
async function truth(page, eye, side) {
    const camera = [eye[0] + side * IPD_M / 2, eye[1], eye[2], eye[0] + side * IPD_M / 2, 0, eye[2], 90].map((m) => m.toFixed(4)).join();
    const query = `width=${EYE.width}&height=${EYE.height}&look=flat&strip=none&hidden=P-101A&camera=${camera}`;
    const answer = await fetch(`http://127.0.0.1:${plant.port}/snapshot.png?${query}`);
    return readPng(page, Buffer.from(await answer.arrayBuffer()));
}
// Returns the first and last coloured pixel of a row, left of the snapshot's legend.
function runOf({ width, rgba }, row) {
    const coloured = [...Array(Math.round(0.8 * width)).keys()].filter((x) => {
        const [r, g, b] = rgba.slice(4 * (row * width + x), 4 * (row * width + x) + 3);
        return Math.max(r, g, b) - Math.min(r, g, b) > 60;
    });
    return [coloured[0], coloured.at(-1)];
}

test('each eye sees the plant from its own position; a turned head shows the change in the next frame',
    options, (t) => withHeadset(async (page) => {
    const home = await page.evaluate(() => ({ camera: globalThis.plantcast.session.camera, size: globalThis.plantcast.session.size }));
    await page.evaluate(() => globalThis.plantcast.session.setParams({ look: 'flat', hidden: ['P-101A'] }));
    await enterVr(page, (button) => button.click());
    for (const away of [2, 20]) {
        const eye = [0, -0.5 - away, 0]; // the eye is 2 or 20 m in front of the box's side, which is at y = -0.5
        await lookFrom(page, eye, [0, 1, 0]);
        // row: index of a row of pixels next to the markers, so that no marker covers the box's edges there
        const { left, right } = await seen(page), row = EYE.height / 2 + (away === 2 ? 30 : 6);
        const trueRuns = await Promise.all([-1, 1].map(async (side) => runOf(await truth(page, eye, side), row)));
        const runs = [left, right].map((picture) => runOf(picture, row));
        t.diagnostic(`${away} m: runs ${JSON.stringify(runs)}, true ${JSON.stringify(trueRuns)}`);
        for (const i of [0, 1]) { // i: 0 for the box's left edge, 1 for its right edge
            const [own, real] = [runs, trueRuns].map(([a, b]) => a[i] - b[i]);
            assert.ok(Math.abs(own - real) <= 1, `at ${away} m: a disparity of ${own} px instead of ${real}`);
            assert.ok(Math.abs(runs[0][i] - trueRuns[0][i]) <= 2, `at ${away} m: ${runs[0][i]} px instead of ${trueRuns[0][i]}`);
        }
        const undrawn = [left, right].map(({ undrawn: share }) => share);
        t.diagnostic(`${away} m: not drawn ${undrawn.map((share) => (100 * share).toFixed(2))} %`);
        assert.ok(undrawn.every((share) => share < 0.03), `shares of pixels not drawn: ${undrawn}`);
        await keep(page, `headset-${away}m`);
    }
    await lookFrom(page, [0, -2.5, 0], [0, 1, 0]);
    const yaw = 8 * Math.PI / 180, { left, seq } = await seen(page), turned = await seen(page, yaw);
    const [a, b] = [left, turned.left].map((picture) => runOf(picture, EYE.height / 2)), middleOf = ([from, to]) => (from + to) / 2;
    assert.equal(turned.seq, seq, 'no other picture of the server has arrived');
    assert.ok(Math.abs(middleOf(b) - middleOf(a) - PX_PER_TAN * Math.tan(yaw)) < 6, `the box moved from ${a} to ${b}`);
    await page.evaluate(() => globalThis.plantcast.modules.there('enterVr').headset.xr.end());
    await hasEnded(page);
    await page.waitForFunction(({ camera, size }) => {
        const { session } = globalThis.plantcast;
        return session.size.width === size.width && session.picture.fullWidth === size.width &&
            session.picture.cameraSeq === session.cameraSeq && session.camera.eye.every((m, i) => m === camera.eye[i]);
    }, home);
    assert.equal(await page.locator('#enter-vr').isEnabled(), true);
}, { screen: SCREEN }));

// Aims at a button of the panel at the wrist and pulls the trigger. from: start of the button's text.
async function pressWrist(page, from) {
    const button = await page.evaluate(async (start) => {
        const { session, modules } = globalThis.plantcast, { hands } = modules.there('enterVr').headset;
        const { showWrist } = await import('/app/xr/boards.js');
        const { buttons } = showWrist({ canvas: hands.wrist.canvas, show() {} }, session, null, () => {});
        const { x, y, width, height } = buttons.find(({ text }) => text.startsWith(start)), panel = hands.panel();
        return hands.onPanel(panel, [x + width / 2, y + height / 2]);
    }, from);
    await aimAt(page, button);
    await pull(page);
}

// Goes a minute back and to the present with the panel at the wrist. Meanwhile, the user stays where they are, and the legend with
// the age of the data is in the view.
async function backAndLive(page) {
    const look = () => page.evaluate(() => {
        const { headset } = globalThis.plantcast.modules.there('enterVr'), { rig, legend, state } = headset;
        const boards = headset.boards(performance.now());
        return { at: rig.at, axes: rig.axes, kind: state.kind, hasLegend: boards.some(({ texture }) => texture === legend.texture),
            says: legend.key };
    });
    await page.waitForFunction(() => globalThis.plantcast.session.recorded);
    const before = await look();
    assert.match(before.says, /Oldest/);
    await pressWrist(page, '−1 ');
    await page.waitForFunction(() => globalThis.plantcast.session.time.atUs !== null);
    await becomes(async () => (await look()).kind, 'past');
    const past = await look();
    assert.notEqual(past.says, before.says, 'the legend states the instant');
    await pressWrist(page, 'Now');
    await page.waitForFunction(() => globalThis.plantcast.session.time.atUs === null);
    await becomes(async () => (await look()).kind, 'live');
    for (const { at, axes, hasLegend } of [before, past, await look()])
        assert.deepEqual({ at, axes, hasLegend }, { at: before.at, axes: before.axes, hasLegend: true });
}

test('hands can teleport on the floor, select equipment, read a sensor, use the wrist panel and grip',
    options, () => withHeadset(async (page) => {
    await enterVr(page);
    await lookFrom(page, [0, -2.5, 0.8], [0, 1, 0]);
    // aims at a point on the floor, 1.6 m below the eyes, and pulls the trigger, which moves the user there
    await aimAt(page, [-0.8, -1.2, -0.8]);
    await pull(page);
    await page.waitForFunction(() => Math.abs(globalThis.plantcast.modules.there('enterVr').headset.rig.at[0] + 0.8) < 0.05);
    await lookFrom(page, [0, -2.5, 0.8], [0, 1, 0]);
    await aimAt(page, [0.1, -0.5, 0.1]);
    await pull(page);
    await page.waitForFunction(() => globalThis.plantcast.modules.there('enterVr').headset.hands.card?.picked.asset === 'E-101');
    const value = await page.evaluate(() => globalThis.plantcast.modules.there('enterVr').headset.hands.card.picked.value);
    assert.equal(value.toFixed(0), '94');
    await keep(page, 'headset-place');
    await lookFrom(page, [-1.8, -1.2, 1.3], [1, 0.6, 0]);
    await aimAt(page, [-0.5, 0, 0]);
    await pull(page);
    await page.waitForFunction(() => globalThis.plantcast.modules.there('enterVr').headset.hands.card?.picked.sensor === 'TI-2');
    await keep(page, 'headset-sensor');
    await aimAt(page, [0.1, -0.2, 0.5]); // aims the controller at the top of the box and pulls the trigger, which moves the user there
    await pull(page);
    await page.waitForFunction(() => Math.abs(globalThis.plantcast.modules.there('enterVr').headset.rig.at[2] - 0.5) < 0.02);
    await lookFrom(page, [0, -2.5, 0.8], [0, 1, 0], true);
    const button = await page.evaluate(() => {
        const { hands } = globalThis.plantcast.modules.there('enterVr').headset, { at, axes: [x, y], width, height } = hands.panel();
        // position in the room of the right-hand button in the panel's first row
        return at.map((m, i) => m + x[i] * width * 0.25 + y[i] * height * 0.38);
    });
    await aimAt(page, button);
    await keep(page, 'headset-wrist');
    await pull(page);
    await page.waitForFunction(() => globalThis.plantcast.session.params.group === 'pressure');
    await backAndLive(page);
    const before = (await state(page, 'rig')).at;
    await page.evaluate(async () => {
        const { device } = globalThis, { headset } = globalThis.plantcast.modules.there('enterVr');
        const frame = async () => {
            for (const { frames } = headset; headset.frames === frames;)
                await new Promise(requestAnimationFrame);
        };
        device.controllers.right.updateButtonValue('squeeze', 1);
        await frame();
        await frame();
        // while it squeezes the grip, the hand moves towards the body, which must pull the user forwards
        device.controllers.right.position.set(0.2, 1.3, 0.1);
        await frame();
        await frame();
        device.controllers.right.updateButtonValue('squeeze', 0);
    });
    await until('the user is pulled along', async () => (await state(page, 'rig')).at[1] - before[1] > 0.3);
}));

test('pictures without depth are not shown, and a message says so; a locked session ends the headset view',
    options, () => withHeadset(async (page) => {
    await enterVr(page);
    await lookFrom(page, [0, -2.5, 0], [0, 1, 0]);
    await page.evaluate(() => {
        const { viewport } = globalThis.plantcast; // an animation frame that was requested before the headset view
        Object.getPrototypeOf(viewport).invalidate.call(viewport);
        globalThis.plantcast.session.on('frame', (frame) => Object.assign(frame, { depth: globalThis.isMended ? frame.depth : null }));
        // turns the head by 0.2 radians, so that the page requests another picture
        globalThis.device.quaternion.set(0, Math.sin(0.1), 0, Math.cos(0.1));
    });
    await page.waitForFunction(() => globalThis.plantcast.modules.there('enterVr').headset.warning?.[1].includes('no depth'));
    const depths = await page.evaluate(() => {
        const { session, modules } = globalThis.plantcast;
        return [session.picture, modules.there('enterVr').headset.shown].map(({ depth }) => depth !== null);
    });
    assert.deepEqual(depths, [false, true], 'the newest picture has no depth, the shown one has');
    await keep(page, 'headset-flat');
    await page.evaluate(() => {
        globalThis.isMended = true;
        globalThis.device.quaternion.set(0, 0, 0, 1);
    });
    await page.waitForFunction(() => globalThis.plantcast.modules.there('enterVr').headset.warning === null);
    await page.evaluate(() => {
        const { modules, session } = globalThis.plantcast;
        modules.there('warp').giveUp();
        session.emit('denied', { code: 'locked' });
    });
    await hasEnded(page);
    assert.equal(await page.evaluate(() => globalThis.plantcast.viewport.warp), null, 'no drawing code uses the lost context');
}));

test('a lost connection covers the headset view until the server is back; a lost GL context ends it',
    options, () => withHeadset(async (page) => {
    await enterVr(page);
    await lookFrom(page, [0, -2.5, 0], [0, 1, 0]);
    await plant.daemon.stop('SIGKILL');
    await until('the loss is noticed', async () => (await state(page, 'state')).kind === 'lost');
    await page.waitForFunction(() => globalThis.plantcast.modules.there('enterVr').headset.warning?.[2]);
    const { left, right } = await seen(page);
    for (const { rgba } of [left, right]) { // the warning is dark red
        let count = 0;
        for (let i = 0; i < rgba.length; i += 4)
            count += rgba[i] > 90 && rgba[i + 1] < 60 && rgba[i + 2] < 70 ? 1 : 0;
        assert.ok(count > 0.03 * rgba.length / 4, `only ${count} pixels of the message are drawn`);
    }
    await keep(page, 'headset-lost');
    await plant.startDaemon('--port', String(plant.port));
    await until('the server is back', async () => (await state(page, 'state')).kind === 'live' && await state(page, 'isNear'));
    await page.evaluate(() => {
        const { gl } = globalThis.plantcast.modules.there('enterVr').headset.painter;
        gl.getExtension('WEBGL_lose_context').loseContext();
    });
    await hasEnded(page);
    await page.waitForFunction(() => !Object.hasOwn(globalThis.plantcast.viewport, 'invalidate'));
}, { expected: /null \(reading '0'\)/ })); // expected error: the emulator reads a state of the lost WebGL context
