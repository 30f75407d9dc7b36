// SPDX-License-Identifier: GPL-3.0-or-later
// An emulated headset (npm's iwer, a Quest 3) in the browser's pages: moves it, and reads what its eyes see.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { sweep } from './sweep.mjs';

// size of one eye's picture in pixels; the emulator draws both eyes into the window, side by side
export const EYE = { width: 700, height: 700 };
const screenOf = ({ width, height }) => ({ viewport: { width: 2 * width, height } });
// SMALL: for tests that do not judge where the eyes see something, because each frame of SCREEN takes 90 ms of processor time
export const SCREEN = screenOf(EYE), SMALL = sweep(SCREEN, screenOf({ width: 320, height: 320 }));
export const IPD_M = 0.063;
// pause in milliseconds between two frames of the headset, which each take up to 90 ms of processor time
const FRAME_MS = sweep(0, 60);
const HEAD_M = 1.6; // height in metres of the emulated head above the floor of the user's room

// Returns an init script that installs the headset, with a field of view of 90 degrees per eye.
export function headsetScript() {
    const runtime = readFileSync(createRequire(import.meta.url).resolve('iwer/build/iwer.min.js'), 'utf8');
    return { content: `${runtime};(() => {
        globalThis.device = new IWER.XRDevice(IWER.metaQuest3, { stereoEnabled: true, fovy: Math.PI / 2, ipd: ${IPD_M} });
        device.installRuntime({ forceInstall: true });
        const { requestAnimationFrame: ask } = XRSession.prototype;
        XRSession.prototype.requestAnimationFrame = function later(draw) { setTimeout(() => ask.call(this, draw), ${FRAME_MS}); };
    })();` };
}

const isNear = () => globalThis.plantcast.modules.there('enterVr')?.headset?.isNear;

// Presses the page's button and waits until the eyes show a picture. press: how it presses the button; the default also works in a
// small window, where the button is hidden.
export async function enterVr(page, press = (button) => button.dispatchEvent('click')) {
    await press(page.locator('#enter-vr'));
    await page.waitForFunction(isNear, null, { polling: 50 });
}

// Moves the headset so that its eyes are at a point of the plant and look horizontally along `forward`, and waits for the
// picture drawn for that place. hasLeft: the user holds a left controller, too.
export async function lookFrom(page, eye, forward, hasLeft = false) {
    await page.evaluate(async ([at, towards, head, both]) => {
        const { headset } = globalThis.plantcast.modules.there('enterVr'), { device } = globalThis;
        const { rigAt } = await import('/core/headset_views.js');
        headset.rig = rigAt([at[0], at[1], at[2] - head], towards, [0, 0, 1]);
        device.quaternion.set(0, 0, 0, 1);
        device.controllers.left.connected = both;
        device.controllers.left.position.set(-0.15, 1.3, -0.4);
        device.controllers.right.position.set(0.2, 1.3, -0.3);
        device.controllers.right.quaternion.set(0, 0, 0, 1);
        headset.hands.card = null;
    }, [eye, forward, HEAD_M, hasLeft]);
    await page.waitForFunction((at) => {
        const { shown, sent } = globalThis.plantcast.modules.there('enterVr').headset, { session } = globalThis.plantcast;
        return shown?.still && sent.eye.every((m, i) => Math.abs(m - at[i]) < 0.02) && shown.cameraSeq === session.cameraSeq;
    }, eye, { polling: 50 });
}

// Turns the right controller so that its ray points at a point of the plant, and waits for the next frame.
export const aimAt = (page, point) => page.evaluate(async (place) => {
    const { headset } = globalThis.plantcast.modules.there('enterVr'), { position, quaternion } = globalThis.device.controllers.right;
    const { axes, at } = headset.rig, from = place.map((m, i) => m - at[i]), hand = [position.x, position.y, position.z];
    const [x, y, z] = axes.map((axis, j) => axis.reduce((sum, v, i) => sum + v * from[i], -hand[j]));
    const yaw = Math.atan2(-x, -z) / 2, pitch = Math.atan2(y, Math.hypot(x, z)) / 2;
    const [c, s, p, q] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    quaternion.set(c * q, s * p, -s * q, c * p);
    const { frames } = headset;
    while (headset.frames < frames + 2)
        await new Promise(requestAnimationFrame);
}, point);

// Pulls and releases the trigger of the right controller, and waits for two frames after each.
export const pull = (page) => page.evaluate(async () => {
    const { headset } = globalThis.plantcast.modules.there('enterVr'), { right } = globalThis.device.controllers;
    for (const value of [1, 0]) {
        right.updateButtonValue('trigger', value);
        const { frames } = headset;
        while (headset.frames < frames + 2 && !headset.ended)
            await new Promise(requestAnimationFrame);
    }
});

// Runs f(headset) in the page right after the next frame is drawn. yaw: angle in radians by which the head has turned since the
// frame before; null: the head does not turn.
const inFrame = (page, f, yaw = null) => page.evaluate(`new Promise((done) => {
    const { headset } = globalThis.plantcast.modules.there('enterVr'), { next } = headset, yaw = ${yaw};
    const last = (now, frame) => {
        headset.next = next;
        next(now, frame);
        done((${f})(headset));
    };
    headset.next = yaw === null ? last : (now, frame) => {
        headset.next = last;
        next(now, frame);
        device.quaternion.set(0, Math.sin(yaw / 2), 0, Math.cos(yaw / 2));
    };
})`);

// Returns the pictures of both eyes and what they consist of: { left, right: { width, rgba, undrawn: share of pixels where the
// page has no picture to show }, seq: number of the server's picture }.
export async function seen(page, yaw = null) {
    const { pixels, seq, width, height } = await inFrame(page, ((headset) => {
        const { gl } = headset.painter, { drawingBufferWidth: both, drawingBufferHeight: height } = gl;
        const all = new Uint8Array(4 * both * height);
        gl.readPixels(0, 0, both, height, gl.RGBA, gl.UNSIGNED_BYTE, all);
        let text = '';
        for (let i = 0; i < all.length; i += 32768)
            text += String.fromCharCode(...all.subarray(i, i + 32768));
        return { pixels: btoa(text), seq: headset.shown.seq, width: both / 2, height };
    }).toString(), yaw);
    const all = Buffer.from(pixels, 'base64');
    const eye = (left) => {
        const rgba = Buffer.alloc(4 * width * height);
        for (let y = 0; y < height; y++)
            all.copy(rgba, 4 * y * width, 4 * ((height - 1 - y) * 2 * width + left), 4 * ((height - 1 - y) * 2 * width + left + width));
        let undrawn = 0;
        for (let i = 0; i < rgba.length; i += 4)
            // one of the two greys that the page draws where there is no picture
            undrawn += [140, 120].includes(rgba[i]) && rgba[i + 1] === rgba[i] && rgba[i + 2] === rgba[i] ? 1 : 0;
        return { width, rgba, undrawn: undrawn / (width * height) };
    };
    return { left: eye(0), right: eye(width), seq };
}

// Returns what the eyes see in the next frame, as a PNG file with the left eye's picture beside the right eye's.
export const eyesPng = async (page) =>
    Buffer.from(await inFrame(page, ((headset) => headset.painter.gl.canvas.toDataURL('image/png').split(',')[1]).toString()), 'base64');
