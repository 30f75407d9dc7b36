// SPDX-License-Identifier: GPL-3.0-or-later
// How pointer, wheel and key events become camera moves.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { listenToInput } from '../../clients/web/app/input/input.js';
import { Measure } from '../../clients/web/app/measure/measure.js';
import { Gestures, wheelZoom } from '../../clients/web/core/gestures.js';
import { HeldKeys, HOLD_S, keyMeaning, TAP_S } from '../../clients/web/core/keys.js';
import { askAnchor, askPick } from '../../clients/web/core/requests.js';
import { makeSession, vector } from './fixtures.mjs';

const touch = (id, x, y, time = 0) => ({ id, x, y, time, kind: 'touch' });

test('left drag orbits; right, middle and shift drags pan', () => {
    const pens = [[{ kind: 'pen' }, 'orbit'], [{ kind: 'pen', button: 2 }, 'pan']];
    const moves = [[{ button: 2 }, 'pan'], [{ button: 1 }, 'pan'], [{ shift: true }, 'pan']];
    for (const [options, name] of [[{}, 'orbit'], [{ ctrl: true }, 'look'], ...moves, ...pens]) {
        const g = new Gestures();
        g.down({ id: 1, x: 10, y: 10, ...options });
        assert.deepEqual(g.move({ id: 1, x: 20, y: 15 }), [{ [name]: [10, 5] }]);
        assert.deepEqual(g.move({ id: 1, x: 21, y: 15 }), [{ [name]: [1, 0] }]);
        assert.deepEqual(g.up({ id: 1, x: 21, y: 15 }), []);
        assert.equal(g.active, false);
    }
});

test('a short press without motion is a click; a long press, a drag or a right press is not', () => {
    const press = (options, x, time) => {
        const g = new Gestures();
        g.down({ id: 1, x: 5, y: 5, time: 0, ...options });
        g.move({ id: 1, x, y: 5 });
        return g.up({ id: 1, x, y: 5, time });
    };
    assert.deepEqual(press({}, 6, 100), [{ click: [6, 5] }]);
    assert.deepEqual(press({ kind: 'touch' }, 11, 100), [{ click: [11, 5] }]);
    assert.deepEqual(press({}, 6, 900), []);
    assert.deepEqual(press({}, 15, 100), []);
    assert.deepEqual(press({ button: 2 }, 5, 100), []);
});

test('a trembling finger does not move the picture', () => {
    const g = new Gestures();
    g.down(touch(1, 100, 100));
    assert.deepEqual(g.move(touch(1, 104, 103)), []);
    assert.deepEqual(g.move(touch(1, 120, 100)), [{ orbit: [20, 0] }]);
});

test('two fingers pan by their average, and zoom about the middle between them', () => {
    const g = new Gestures();
    g.down(touch(1, 100, 100));
    g.down(touch(2, 200, 100));
    const [pan, zoom] = g.move(touch(2, 300, 100));
    assert.deepEqual(pan, { pan: [50, 0] });
    assert.deepEqual(zoom, { zoom: 0.5, at: [200, 100] });
    assert.deepEqual(g.up(touch(2, 300, 100)), []);
    assert.deepEqual(g.move(touch(1, 110, 100)), [{ orbit: [10, 0] }], 'the remaining finger orbits without a jump');
    assert.deepEqual(g.up(touch(1, 110, 100)), [], 'lifting the remaining finger is no click');
});

test('three fingers look around; a fourth finger is ignored', () => {
    const g = new Gestures();
    for (let id = 1; id <= 4; id++)
        g.down(touch(id, 100 * id, 50));
    assert.deepEqual(g.move(touch(2, 230, 80)), [{ look: [10, 10] }]);
    assert.deepEqual(g.move(touch(4, 900, 900)), [{ look: [0, 0] }]);
    g.up(touch(1, 100, 50));
    g.up(touch(4, 900, 900));
    assert.deepEqual(Object.keys(g.move(touch(3, 310, 50))[0]), ['pan'], 'the two remaining fingers pan');
    assert.deepEqual(g.up(touch(2, 230, 80)), [], 'lifting them is no click');
});

test('a lost pointer ends its gesture, an unknown pointer is ignored', () => {
    const g = new Gestures();
    g.down(touch(1, 0, 0));
    g.down(touch(2, 100, 0));
    g.cancel(touch(1));
    g.cancel(touch(2));
    assert.equal(g.active, false);
    assert.deepEqual(g.move(touch(1, 50, 50)), []);
});

test('wheel: forth and back cancel out, lines count as pixels, and one turn is limited', () => {
    assert.ok(Math.abs(wheelZoom({ deltaY: 100 }) * wheelZoom({ deltaY: -100 }) - 1) < 1e-12);
    assert.ok(wheelZoom({ deltaY: -100 }) < 1);
    assert.equal(wheelZoom({ deltaY: 3, deltaMode: 1 }), wheelZoom({ deltaY: 48 }));
    assert.equal(wheelZoom({ deltaY: 1e9 }), Math.exp(0.5));
    assert.ok(wheelZoom({ deltaY: 10, ctrlKey: true }) > wheelZoom({ deltaY: 10 }));
});

test('each key maps to its motion or command', () => {
    const plain = { ctrlKey: false, altKey: false, metaKey: false, shiftKey: false };
    const key = (k, code = '', more = {}) => keyMeaning({ key: k, code, ...plain, ...more });
    assert.deepEqual(key('ArrowLeft', 'ArrowLeft'), { motion: 'ArrowLeft' });
    assert.deepEqual(key('ArrowLeft', 'ArrowLeft', { shiftKey: true }), { motion: 'KeyA' });
    assert.deepEqual(key('w', 'KeyW'), { motion: 'KeyW' });
    assert.deepEqual(key('=', 'Equal'), { motion: '+' });
    assert.deepEqual(key('-', 'NumpadSubtract'), { motion: '-' });
    assert.deepEqual(key('F', 'KeyF', { shiftKey: true }), { command: 'fit' });
    assert.deepEqual(key('?', 'Slash', { shiftKey: true }), { command: 'help' });
    assert.deepEqual(key('2', 'Digit2'), { group: 1 });
    assert.equal(key('f', 'KeyF', { ctrlKey: true }), null, 'Ctrl+F is left to the browser');
    assert.equal(key('q', 'KeyQ'), null);
});

test('a tap moves by one step, holding moves steadily, and keyboard repeat is ignored', () => {
    const keys = new HeldKeys();
    assert.deepEqual(keys.press('ArrowRight'), [{ orbitDeg: [45 * TAP_S, 0] }]);
    assert.deepEqual(keys.press('ArrowRight'), []);
    assert.deepEqual(keys.step(HOLD_S), []);
    let turned = 0;
    for (let n = 0; n < 100; n++)
        turned += keys.step(0.01)[0].orbitDeg[0];
    assert.ok(Math.abs(turned - 45) < 1e-9);
    keys.release({ key: 'ArrowRight', code: 'ArrowRight' });
    assert.equal(keys.moving, false);
    assert.deepEqual(keys.step(1), []);
});

test('a key whose shift was released first does not stay down', () => {
    const keys = new HeldKeys();
    keys.press('KeyA');
    keys.release({ key: 'ArrowLeft', code: 'ArrowLeft', shiftKey: false });
    assert.equal(keys.moving, false);
});

test('input from before the camera controller loaded: only a drag that lasts or has just ended is replayed', async () => {
    const on = new Map(), now = performance.now();
    globalThis.document = { addEventListener: () => {} };
    const element = { addEventListener: (name, f) => on.set(name, f), setPointerCapture: () => {}, focus: () => {} };
    const target = { closest: () => null };
    const toldOf = async (...events) => {
        const told = [];
        let come;
        const cameraController = { handle: ({ type }) => told.push(type) }, coming = new Promise((done) => { come = done; });
        listenToInput(element, { there: () => null, get: () => coming, prepare: () => coming });
        for (const [type, ago] of events)
            on.get(type)({ type, target, timeStamp: now - ago, preventDefault: () => {} });
        come(cameraController);
        await coming;
        return told;
    };
    assert.deepEqual(await toldOf(['pointerdown', 5000], ['pointermove', 4000]), ['pointerdown', 'pointermove']);
    assert.deepEqual(await toldOf(['pointerdown', 5000], ['pointermove', 4000], ['pointerup', 100]),
        ['pointerdown', 'pointermove', 'pointerup']);
    assert.deepEqual(await toldOf(['pointerdown', 5000], ['pointerup', 4000], ['pointermove', 100]), ['pointermove']);
    assert.deepEqual(await toldOf(['wheel', 4000]), []);
    delete globalThis.document;
});

test('a wheel turn does not replace the unanswered request of a measuring click', () => {
    const { connection, session, sockets } = makeSession();
    connection.start();
    sockets[0].accept();
    sockets[0].say(vector('server/welcome.json'));
    session.picture = { camera: session.camera };
    const heard = [];
    session.on('picked', ({ purpose }) => heard.push(purpose));
    const answer = () => sockets[0].say({ type: 'picked', seq: session.pickSeq, asset: null, position: null });
    askPick(session, [5, 5], 'measure');
    askAnchor(session, [1, 2]);
    answer();
    askAnchor(session, [1, 2]);
    answer();
    assert.deepEqual(heard, ['measure', 'anchor']);
    askPick(session, [5, 5], 'measure');
    askAnchor(session, [1, 2], session.pickedAt + 4000);
    answer();
    assert.equal(heard[2], 'anchor', 'a lost answer delays the anchor for 3 s only');
});

test('a second measuring click waits for the answer to the first, and keeps its pixel and camera', () => {
    const { connection, session, sockets } = makeSession();
    connection.start();
    sockets[0].accept();
    sockets[0].say(vector('server/welcome.json'));
    session.picture = { camera: session.camera };
    const tool = Object.assign(Object.create(Measure.prototype), { session, on: true, places: [], next: null, show() {},
        viewport: { width: 640, pixelOf: (x, y) => [x, y] } });
    session.on('picked', (picked) => tool.hear(picked));
    const asked = () => sockets[0].sent.filter(({ type }) => type === 'pick').map(({ x, camera }) => [x, camera.eye]);
    const answer = (x) => sockets[0].say({ type: 'picked', seq: session.pickSeq, asset: 'E-101', position: [x, 0, 0] });
    const { eye } = session.camera, moved = [1, 2, 3];
    tool.click(1, 1);
    tool.click(2, 1);
    session.picture = { camera: { ...session.camera, eye: moved } };
    assert.deepEqual(asked(), [[1, eye]]);
    answer(10);
    assert.deepEqual(asked(), [[1, eye], [2, eye]]);
    answer(20);
    assert.deepEqual(tool.places, [[10, 0, 0], [20, 0, 0]]);
    for (const x of [3, 4])
        tool.click(x, 1);
    answer(30);
    answer(40);
    assert.deepEqual([tool.places, tool.next], [[[30, 0, 0], [40, 0, 0]], null]);
    assert.deepEqual(asked().slice(2), [[3, moved], [4, moved]]);
});
