// SPDX-License-Identifier: GPL-3.0-or-later
// The position of a card: inside the picture, never over its point, over as few other markers as possible, at most 280 pixels
// high. Also the requests for the value on the card of a point.
import assert from 'node:assert/strict';
import { mock, test } from 'node:test';
import { cardPlace } from '../../clients/web/app/cards/card_position.js';
import { Place } from '../../clients/web/app/cards/place.js';
import { Commands } from '../../clients/web/app/input/commands.js';
import { Remote } from '../../clients/web/app/views/remote.js';
import { projector } from '../../clients/web/core/camera.js';
import { askPick, Repeater } from '../../clients/web/core/requests.js';
import { randomNumbers } from './random.mjs';

const random = randomNumbers();

test('a card opens on the side with more space', () => {
    const free = { left: 8, top: 8, right: 900, bottom: 600 };
    assert.ok(cardPlace({ wide: 280, tall: 200 }, free, [700, 300]).left + 280 < 700);
    assert.ok(cardPlace({ wide: 280, tall: 200 }, free, [200, 300]).left > 200);
});

test('a card is inside the picture, never over its point, and at most 280 pixels high', () => {
    for (let round = 0; round < 2000; round++) {
        const free = { left: 8, top: random(8, 60), right: random(320, 1500), bottom: random(180, 1000) };
        const card = { wide: 280, tall: random(60, 900) }, at = [random(0, free.right), random(free.top, free.bottom)];
        const { left, top, most } = cardPlace(card, free, at), tall = Math.min(card.tall, most), what = JSON.stringify({ free, card, at });
        assert.ok(most <= 280, what);
        assert.ok(left >= free.left - 1 && left + card.wide <= free.right + 1, what);
        assert.ok(top >= free.top - 1 && top + tall <= free.bottom + 1, what);
        const over = at[0] > left && at[0] < left + card.wide && at[1] > top && at[1] < top + tall;
        assert.ok(!over, `${what} ${JSON.stringify({ left, top, most })}`);
    }
});

test('a card covers no other marker if any position beside its point is free', () => {
    const free = { left: 8, top: 8, right: 900, bottom: 600 }, card = { wide: 280, tall: 200 };
    const covered = ({ left, top }, marks) => marks.filter(([x, y]) => x > left - 12 && x < left + 292 && y > top - 12 && y < top + 212);
    const right = [[500, 300, false], [600, 250, false]], left = [[200, 300, true]];
    for (const marks of [right, left, [...right, ...left], [[500, 220, false]], [[500, 380, true], [250, 220, false]]])
        assert.deepEqual(covered(cardPlace(card, free, [400, 300], marks), marks), [], JSON.stringify(marks));
    const all = [[500, 300, true], [200, 300, false], [400, 200, true], [400, 400, true]];
    assert.deepEqual(covered(cardPlace(card, free, [400, 300], all), all), [all[1]], 'the card covers a marker rather than an alarm ring');
});

test('a card changes its side only to cover fewer markers', () => {
    const free = { left: 8, top: 8, right: 900, bottom: 600 }, card = { wide: 280, tall: 200 };
    const first = cardPlace(card, free, [440, 300]), next = cardPlace(card, free, [470, 300], [], first);
    assert.equal(next.side, first.side);
    assert.notEqual(cardPlace(card, free, [470, 300], [[600, 300, true]], next).side, next.side);
});

// A card of the point (0, 5, 1), whose requests are collected in `sent`.
function placeAt(camera, params = {}) {
    const sent = [], session = { welcomed: true, picture: { camera }, params, shown: {}, pickSeq: 0, size: { width: 800, height: 600 },
        setParams() {}, connection: { send: (message) => sent.push(message) } };
    const picked = { asset: 'E-101', position: [0, 5, 1], value: 1 };
    const place = Object.assign(Object.create(Place.prototype), { session, picked, half: 0, asked: null, isLate: false, element: {},
        repeater: new Repeater(), viewport: { pixelOf: (x, y) => [x, y] }, build() {}, show() {}, makeRoom() {} });
    return { place, sent, answer: (value, more = {}) => place.hear({ purpose: 'place', ...picked, value, ...more }) };
}

const LENS = { up: [0, 0, 1], fov: 30 };

test('the card of a point asks for this point\'s value, wherever the point is in the picture or outside', () => {
    for (let round = 0; round < 500; round++) {
        const eye = [random(-9, 9), random(-9, 0), random(-9, 9)], target = [random(-4, 4), random(1, 9), random(-9, 9)];
        for (const camera of [{ ...LENS, eye, target }, { ...LENS, eye, target, height_m: 3 }]) {
            const { place, sent } = placeAt(camera, { split: {} });
            place.half = 1;
            place.ask();
            const { x, y, camera: { projection, ...asked } } = sent[0], at = projector(asked, 400, 600)([0, 5, 1]);
            const what = JSON.stringify({ camera, asked, at });
            assert.ok(x === 600 && y === 300 && Math.hypot(at[0] - 200, at[1] - 300) < 1e-6, what);
            assert.equal(projection, camera.height_m && 'orthographic');
            const turn = asked.target.map((one, i) => one - asked.eye[i] - (target[i] - eye[i]));
            assert.ok(camera.height_m ? Math.hypot(...turn) < 1e-9 : Math.hypot(...asked.eye.map((one, i) => one - eye[i])) === 0, what);
        }
    }
});

test('the card of a point repeats its request if there is no answer, and if readings change before the answer', () => {
    let now = 10000;
    const { mock: calls } = mock.method(performance, 'now', () => now);
    const { place, sent, answer } = placeAt({ ...LENS, eye: [0, 0, 0], target: [0, 9, 0] });
    const after = (ms) => {
        now += ms;
        place.ask();
        return sent.length;
    };
    try {
        assert.deepEqual([after(0), after(1000), after(1900), after(200)], [1, 1, 1, 2], 'an unanswered request is repeated');
        answer(2);
        assert.deepEqual([place.picked.value, sent.length], [2, 2]);
        assert.deepEqual([after(0), after(100)], [3, 3]);
        answer(3);
        assert.deepEqual([place.picked.value, sent.length], [3, 4], 'asks again, because readings have changed since the request');
        answer(4, { purpose: 'anchor' });
        assert.deepEqual([place.picked.value, after(100)], [3, 5], 'a replaced request is repeated');
        answer(5, { position: [1, 5, 1] });
        assert.equal(place.picked, null, 'the card closes when something hides its point');
    } finally {
        calls.restore();
    }
});

test('the card of a point waits for slow answers, and asks for the clicked point until the answer comes', () => {
    let now = 10000;
    const { mock: calls } = mock.method(performance, 'now', () => now);
    const camera = { ...LENS, eye: [0, 0, 0], target: [0, 9, 0] }, { place, sent, answer } = placeAt(camera);
    const after = (ms) => {
        now += ms;
        place.ask();
        return sent.length;
    };
    const repeats = () => [3001, 5990, 20, 11970, 40].map(after);
    try {
        place.open(70, 80);
        place.session.picture = { camera: { ...camera, target: [9, 9, 0] } };
        assert.deepEqual(repeats(), [2, 2, 3, 3, 4], 'waits longer after each repetition');
        const clicks = sent.map(({ x, y, camera: { target } }) => ({ x, y, target }));
        assert.deepEqual(clicks, Array(4).fill({ x: 70, y: 80, target: [0, 9, 0] }));
        answer(2, { asset: 'E-102', position: [4, 5, 1] });
        assert.deepEqual([place.picked.asset, place.picked.value], ['E-102', 2]);
        sent.length = 0;
        after(0);
        assert.deepEqual([sent.length, ...repeats()], [1, 2, 2, 3, 3, 4], 'the waiting time starts again at its first value');
        place.open(30, 40);
        answer(3, { purpose: 'anchor' });
        const lost = sent.slice(4).map(({ x, y }) => [x, y]);
        assert.deepEqual(lost, [[30, 40], [30, 40]], 'a request that the wheel has replaced is sent again at once');
        answer(4, { asset: 'E-103' });
        assert.equal(place.picked.asset, 'E-103');
        for (const purpose of ['sight', 'measure', 'placing']) {
            place.open(50, 60);
            sent.length = 0;
            answer(5, { purpose });
            answer(6, { asset: 'E-104' });
            assert.deepEqual([sent.length, place.picked.asset], [0, 'E-103'], `a later choice of the user remains: ${purpose}`);
        }
    } finally {
        calls.restore();
    }
});

test('the card of a point does not replace an unanswered measuring or placing click, and asks for its value afterwards', () => {
    for (const purpose of ['measure', 'placing']) {
        const { place, sent, answer } = placeAt({ ...LENS, eye: [0, 0, 0], target: [0, 9, 0] }), { session } = place;
        askPick(session, [5, 5], purpose);
        place.ask();
        assert.equal(sent.length, 1, purpose);
        session.pickPurpose = null; // answered
        answer(1, { purpose });
        assert.deepEqual(sent.map(({ x }) => x), [5, 400], purpose);
        answer(2);
        assert.deepEqual([place.picked.value, sent.length], [2, 2], purpose);
    }
});

test('a selection ends the wait for the answer about a clicked point', () => {
    const camera = { ...LENS, eye: [0, 0, 0], target: [0, 9, 0] }, { place, answer } = placeAt(camera), { document } = globalThis;
    globalThis.document = { getElementById: () => ({ classList: { toggle() {} } }) };
    try {
        const modules = { there: (name) => (name === 'place' ? place : null), get() {}, use() {} };
        const commands = new Commands({ session: place.session, modules, selection: {}, saveAddress() {}, refresh() {} });
        for (const choose of [() => commands.selectTag({ name: 'TI-1' }), () => commands.selectAsset({ id: 'E-105', bounds: {} })]) {
            place.open(70, 80);
            choose();
            answer(2, { asset: 'E-104' });
            assert.equal(place.picked.asset, 'E-101');
        }
    } finally {
        globalThis.document = document;
    }
});

test('a pointer on a wall is sent however slow the answers are', () => {
    let now = 10000;
    const { mock: calls } = mock.method(performance, 'now', () => now);
    const sent = [], camera = { ...LENS, eye: [0, 0, 0], target: [0, 9, 0] }, posted = [];
    const session = { welcomed: true, picture: { camera }, pickSeq: 0, connection: { send: (message) => sent.push(message) },
        post: (message) => posted.push(message) };
    const page = { pointed: { x: 1, y: 2 } }, pane = { wall: 'room', display: 1, area: 'main' };
    const remote = Object.create(Remote.prototype, { chosen: { value: pane } });
    Object.assign(remote, { session, page, pointing: true, seenSeq: 0, repeater: new Repeater(), desk: { value: '' },
        viewport: { pixelOf: (x, y) => [x, y] } });
    // Each request is answered 5 s after it was sent. Returns the number of positions sent to the wall in 60 s.
    const pointsIn60s = () => {
        const answers = [];
        for (const end = now + 60000; now < end; now += 250) {
            for (; answers[0]?.at <= now; answers.shift()) {
                if (answers[0].seq === session.pickSeq) // the session ignores answers to earlier requests
                    remote.onPicked({ seq: answers[0].seq, purpose: 'point', asset: 'E-101', position: [0, 5, 1] });
            }
            page.pointed.x += 1;
            remote.ask();
            answers.push(...sent.splice(0).map(({ seq }) => ({ seq, at: now + 5000 })));
        }
        return posted.length;
    };
    try {
        assert.ok(pointsIn60s() >= 4, `${posted.length} positions`);
        remote.onPicked({ seq: session.pickSeq, asset: null });
        session.pickSeq++; // the user clicks
        remote.ask();
        now += 1000;
        remote.ask();
        assert.equal(sent.length, 0, 'waits for the answer to the click');
    } finally {
        calls.restore();
    }
});
