// SPDX-License-Identifier: GPL-3.0-or-later
// Tools of the page: detection that the computer slept, sizes of letters to be read from afar, measuring distances, and links
// to share.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Measure } from '../../clients/web/app/measure/measure.js';
import { Picture } from '../../clients/web/app/picture/picture.js';
import { Headset } from '../../clients/web/app/xr/headset.js';
import { health, simulatedText } from '../../clients/web/core/health.js';
import { shareLinks } from '../../clients/web/core/links.js';
import { farText, measure, metresText } from '../../clients/web/core/measure.js';
import { Wake } from '../../clients/web/core/wake.js';
import { LEAST, MINUTES, readWall, wallFit, wallScale } from '../../clients/web/core/wall.js';
import { learnWords } from '../../clients/web/core/words.js';
import { makeSession, vector } from './fixtures.mjs';

test('sleep is detected when the calendar advances without the monotonic clock', () => {
    const time = { now: 0, date: 1e12 }, slept = [];
    const wake = new Wake({ now: () => time.now, date: () => time.date, onWake: (ms) => slept.push(ms) });
    const pass = (now, date) => {
        time.now += now;
        time.date += date;
        wake.check();
    };
    pass(500, 500);
    pass(500, 2500);
    assert.deepEqual(slept, [], 'a late timer or a small clock correction is no sleep');
    pass(500, 3600500);
    assert.deepEqual(slept, [3600000]);
    pass(500, 500);
    pass(500, -7200000);
    pass(500, 500);
    assert.deepEqual(slept, [3600000], 'a clock that was set back is no sleep');
});

test('after a sleep the picture counts as old until the server sends again', () => {
    const { session, connection, sockets, clock } = makeSession();
    connection.start();
    sockets[0].accept();
    sockets[0].say(vector('server/welcome.json'));
    session.picture = {};
    clock.time += 3600000;
    connection.doubt();
    assert.equal(sockets[0].sent.at(-1).type, 'ping', 'the server is asked at once');
    const { kind, banner, detail } = health(session, clock.now());
    assert.deepEqual([kind, banner], ['silent', true]);
    assert.match(detail, /This picture is 60 min old/);
    sockets[0].say({ type: 'pong', t: clock.now(), time_us: 1 });
    assert.equal(connection.quiet, false);
    connection.doubt();
    clock.advance(1500);
    assert.equal(connection.quiet, true);
    clock.time += 12000;
    clock.advance(600);
    assert.notEqual(connection.state, 'open', 'without an answer the connection counts as lost');
});

test('simulated values are marked on the live picture, but not on the past', () => {
    const model = { links: [{ source: 'a', up: true, simulated: true }, { source: 'b', up: true }] }, time = { atUs: null };
    assert.equal(simulatedText({ model, time, picture: {} }), 'Partly simulated');
    assert.equal(simulatedText({ model: { links: [model.links[0]] }, time, picture: {} }), 'Simulated');
    assert.equal(simulatedText({ model: { links: [model.links[1]] }, time, picture: {} }), '');
    assert.equal(simulatedText({ model, time: { atUs: 5 }, picture: {} }), '');
    assert.equal(simulatedText({ model: null, time, picture: null }), '');
});

// Returns the height of a capital letter (0.72 of the font size) in minutes of arc.
function letterMinutes(fontPx, { inches, metres }, screen) {
    const millimetres = (0.72 * fontPx * inches * 25.4) / Math.hypot(screen.width, screen.height);
    return (Math.atan(millimetres / (metres * 1000)) * 60 * 180) / Math.PI;
}

test('a wall\'s capitals are at least 16 minutes of arc high, wherever the screen hangs', () => {
    assert.equal(readWall('?lang=ko'), null);
    assert.deepEqual(readWall('?wall'), { inches: 55, metres: 3 });
    assert.deepEqual(readWall('?wall=85,5'), { inches: 85, metres: 5 });
    assert.deepEqual(readWall('?wall=-3,x'), { inches: 55, metres: 3 });
    for (const [wall, screen] of [['?wall', [3840, 2160]], ['?wall=85,5', [1920, 1080]], ['?wall=110,8', [7680, 4320]]]) {
        const at = readWall(wall), [width, height] = screen, scale = wallScale(at, { width, height });
        assert.ok(letterMinutes(12.5 * scale, at, { width, height }) >= MINUTES - 1e-6, wall);
    }
    assert.equal(wallScale({ inches: 55, metres: 0.5 }, { width: 800, height: 600 }), 1, 'letters are never smaller than on a desk');
    const screen = { width: 1920, height: 1080 }, far = { inches: 10, metres: 50 }, { scale, metres } = wallFit(far, screen, screen);
    assert.ok(1920 / scale > LEAST.width - 1e-6 && 1080 / scale > LEAST.height - 1e-6, 'the whole wall page fits');
    assert.ok(Math.abs(letterMinutes(12.5 * scale, { ...far, metres }, screen) - MINUTES) < 1e-2,
        'letters are legible from the stated distance');
    const near = { inches: 85, metres: 8 };
    assert.deepEqual(wallFit(near, screen, screen), { scale: wallScale(near, screen), metres: 8 });
});

test('the vertical is the plant\'s, also if its home view looks straight down with north as `up`', async () => {
    await learnWords();
    const { connection, session, sockets } = makeSession(), welcome = vector('server/welcome.json');
    connection.start();
    sockets[0].accept();
    sockets[0].say({ ...welcome, plant: { ...welcome.plant, home: { eye: [1, 2, 90], target: [1, 2, 0], up: [0, 1, 0], fov: 45 } } });
    session.camera = session.model.plant.home;
    const written = [], label = { style: {}, replaceChildren: (...parts) => written.push(...parts) };
    globalThis.document = { createElement: () => ({ append() {} }) };
    try {
        Measure.prototype.write.call({ session, places: [[0, 0, 0], [3, 4, 0]], label, viewport: { width: 640, height: 360 } }, 9, 9);
    } finally {
        delete globalThis.document;
    }
    assert.equal(written[1], ' horizontal 5.000 m, vertical 0.000 m');
    assert.equal(Object.getOwnPropertyDescriptor(Picture.prototype, 'isYUp').get.call({ session }), false);
    const headset = { session, viewport: { warp: { hide() {} } }, modules: { there: () => null }, floorM: 0 };
    Headset.prototype.borrow.call(headset);
    assert.deepEqual(headset.rig.axes[1], [0, 0, 1]);
});

test('distances: straight, level and rise are measured, with as many figures as a tape has', () => {
    assert.deepEqual(measure([0, 0, 0], [3, 4, 12], [0, 0, 1]), { metres: 13, level: 5, rise: 12 });
    assert.deepEqual(measure([1, 1, 1], [1, 0, 1], [0, 1, 0]), { metres: 1, level: 0, rise: -1 });
    assert.deepEqual([1.234, 123.4, 9999, 5300123].map(farText), ['1.23 m', '123 m', '9999 m', '5300 km']);
    assert.deepEqual([0.1234, 12.345, 123.45, -3.2].map(metresText), ['0.123', '12.35', '123.5', '−3.200']);
});

test('share links contain the chosen parts, and no more', () => {
    const session = { id: 7, camera: null, params: { group: 'g' }, time: { atUs: null }, ownParams: {}, following: null };
    const location = { origin: 'https://plant.example', pathname: '/' };
    assert.deepEqual(shareLinks({ location, session, tag: null }),
        { view: 'https://plant.example/#group=g', follow: 'https://plant.example/#follow=7' });
    assert.equal(shareLinks({ location, session: { ...session, model: { plant: { node: 'r1' } } }, tag: null }).follow,
        'https://plant.example/?node=r1#follow=7');
    const links = shareLinks({ location, session: { ...session, params: { selected: 'E 1' }, following: { session: 3 } }, tag: 'T&1' });
    assert.deepEqual([links.tag, links.asset, links.follow].map((link) => link.slice(link.indexOf('#'))),
        ['#tag=T%261', '#asset=E%201', '#follow=3']);
});
