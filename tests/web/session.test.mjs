// SPDX-License-Identifier: GPL-3.0-or-later
// The page's side of a session with the server: which messages it sends first, repeats or leaves out, and which ones it
// ignores.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { actionsFor, asideOf, inMessages, passes, rowActions, targetsOf } from '../../clients/web/core/alarm_actions.js';
import { health } from '../../clients/web/core/health.js';
import { orbit } from '../../clients/web/core/camera_moves.js';
import { actOnAlarm, giveLead, travel } from '../../clients/web/core/requests.js';
import { showAll } from '../../clients/web/core/section.js';
import { kbitPerS, timingOf } from '../../clients/web/core/timings.js';
import { makeSession, vector, vectorBytes } from './fixtures.mjs';

const welcome = vector('server/welcome.json');
const WANTED = { camera: { eye: [1, 2, 3], target: [4, 5, 6], up: [0, 0, 1], fov: 30 }, params: { group: 'pressure' } };

function greeted(wanted) {
    const bench = makeSession(wanted);
    bench.connection.start();
    bench.socket = bench.sockets[0];
    bench.socket.accept();
    bench.socket.say(welcome);
    bench.events.length = 0;
    return bench;
}
const last = (list) => list[list.length - 1];

test('hello states size, codecs and the address\'s view', () => {
    const { connection, session, sockets } = makeSession(WANTED);
    session.resize({ width: 800, height: 600 });
    connection.start();
    sockets[0].accept();
    assert.deepEqual(sockets[0].sent, [
        {
            type: 'hello', width: 800, height: 600, codecs: ['jpeg', 'png'], camera: { seq: 1, ...WANTED.camera },
            params: { seq: 1, ...WANTED.params },
        },
    ]);
});

test('the session\'s messages have the form of the server\'s test vectors', () => {
    const shape = (message) => Object.keys(message).sort();
    const { session, socket } = greeted(WANTED);
    const full = vector('client/accepted--hello-full.json');
    delete full.future; // the server ignores unknown fields
    assert.deepEqual(shape(socket.sent[0]), shape(full));
    assert.deepEqual(shape(socket.sent[0].camera), shape(full.camera));
    session.setCamera(orbit(session.camera, 3, 0));
    session.flush();
    assert.deepEqual(shape(last(socket.sent)), shape(vector('client/accepted--camera.json')));
    session.resize({ width: 100, height: 100 });
    assert.deepEqual(shape(last(socket.sent)), shape(vector('client/accepted--resize.json')));
    session.setVisible(false);
    assert.deepEqual(shape(last(socket.sent)), shape(vector('client/accepted--visible.json')));
    session.drawn({ seq: 1, cameraSeq: 0 }, 1);
    assert.deepEqual(shape(last(socket.sent)), shape(vector('client/accepted--ack.json')));
});

test('without a view of its own, the session takes the plant\'s view', () => {
    const { session, socket } = greeted();
    assert.deepEqual(socket.sent[0], { type: 'hello', width: 640, height: 360, codecs: ['jpeg', 'png'] });
    assert.deepEqual(session.camera, welcome.plant.home);
    session.flush();
    assert.equal(socket.sent.length, 1, 'the home camera is not sent, because the server knows it');
    assert.equal(session.params.group, welcome.view.group);
    assert.equal(session.connection.tries, 0);
});

test('a refused view is dropped step by step', () => {
    const { connection, sockets } = makeSession(WANTED);
    connection.start();
    const refuse = () => sockets[0].say({ type: 'error', code: 'bad_field', text: 'params.group: unknown', about: 'hello' });
    sockets[0].accept();
    refuse();
    refuse();
    refuse();
    assert.deepEqual(sockets[0].sent.map((m) => [!!m.camera, !!m.params]), [[true, true], [true, false], [false, false]]);
});

test('only the comparison is dropped if its baseline no longer exists', () => {
    const params = { colormap: 'cividis', show: 'difference', baseline: { name: 'before' } };
    const { connection, sockets } = makeSession({ ...WANTED, params });
    connection.start();
    sockets[0].accept();
    sockets[0].say({ type: 'error', code: 'bad_field', text: 'baseline: there is none of that name', about: 'hello' });
    assert.deepEqual(sockets[0].sent.map(({ params: { seq, ...asked } }) => asked),
        [{ colormap: 'cividis', show: 'difference', baseline: 'before' }, { colormap: 'cividis' }]);
});

test('a user who may not set field parameters does not request them again', () => {
    for (const role of ['viewer', 'engineer']) {
        const { session, socket, sockets, clock } = greeted();
        socket.say({ ...welcome, role });
        session.setParams({ look: 'flat', fill: 'neighbours', strength: 2, sensors: { [welcome.tags[0].name]: { strength: 3 } } });
        socket.fail();
        clock.advance(500);
        sockets[1].accept();
        const { params } = sockets[1].sent[0];
        assert.equal(params.look, 'flat');
        assert.deepEqual([params.fill, params.strength, params.decay, Boolean(params.sensors)],
            role === 'viewer' ? [undefined, undefined, undefined, false] : ['neighbours', 2, undefined, true]);
    }
});

test('a leader knows the followers, and hands the lead to one of them', () => {
    const { session, socket } = greeted();
    const heard = [];
    session.on('followers', () => heard.push(session.followers));
    socket.say({ type: 'followers', count: 2, sessions: [7, 9], names: ['kim', null] });
    socket.say({ type: 'followers', count: 1, sessions: [7] }); // clients without a token get the message without names
    assert.deepEqual(heard, [{ count: 2, sessions: [7, 9], names: ['kim', null] }, { count: 1, sessions: [7], names: [] }]);
    giveLead(session, 9);
    assert.deepEqual(last(socket.sent), { type: 'lead', session: 9 });
});

test('strength and decay of single sensors are changed one by one, and undone', () => {
    const { session, socket } = greeted();
    session.setParams({ sensors: { A: { strength: 2 } } });
    session.setParams({ sensors: { B: { decay: 3 } } });
    assert.deepEqual(session.params.sensors, { A: { strength: 2 }, B: { decay: 3 } });
    assert.deepEqual(last(socket.sent).sensors, { B: { decay: 3 } }, 'only the changed parameters are sent');
    session.setParams({ sensors: { A: null } });
    assert.deepEqual(session.params.sensors, { B: { decay: 3 } });
    session.setParams({ sensors: null });
    assert.deepEqual(session.params.sensors, {});
});

test('at most one camera is sent per animation frame, the newest', () => {
    const { session, socket, clock } = greeted(WANTED);
    const before = socket.sent.length;
    for (let n = 0; n < 5; n++)
        session.setCamera(orbit(session.camera, 3, 0), clock.now());
    session.flush();
    session.flush();
    assert.equal(socket.sent.length, before + 1);
    assert.deepEqual(last(socket.sent), { type: 'camera', seq: 2, ...session.camera });
    session.setCamera(session.camera);
    session.flush();
    assert.equal(socket.sent.length, before + 1, 'an unchanged camera is not sent');
});

test('over a congested connection no camera is sent; the newest is sent once it clears', () => {
    const { session, socket } = greeted(WANTED);
    socket.bufferedAmount = 1e6;
    session.setCamera(orbit(session.camera, 3, 0));
    session.flush();
    session.setCamera(orbit(session.camera, 3, 0));
    socket.bufferedAmount = 0;
    session.flush();
    assert.deepEqual(last(socket.sent).eye, session.camera.eye);
    assert.equal(last(socket.sent).seq, 2);
});

test('after a reconnect the same camera and parameters are requested', () => {
    const { session, socket, sockets, clock } = greeted();
    session.setCamera(orbit(session.camera, 33, 5));
    session.flush();
    session.setParams({ distance: 'euclidean', ramp_interval: 10 });
    socket.say({ ...vector('server/params.json'), seq: 1, distance: 'euclidean', ramp_interval: 10 });
    const { camera, params } = session;
    socket.fail();
    clock.advance(500);
    sockets[1].accept();
    assert.deepEqual(sockets[1].sent[0].camera, { seq: 1, ...camera });
    assert.equal(sockets[1].sent[0].params.distance, 'euclidean');
    assert.equal(sockets[1].sent[0].params.ramp_interval, 10);
    assert.equal(sockets[1].sent[0].params.seq, 1);
    assert.equal(sockets[1].sent[0].params.range, undefined, 'the group\'s own range is not sent, because it may have changed');
    sockets[1].say({ ...welcome, view: { ...welcome.view, ...params } });
    assert.deepEqual(session.camera, camera);
    assert.equal(session.params.ramp_interval, 10);
});

test('the plant\'s start sets are not sent; other sets are sent, even empty, and all after a reconnect', () => {
    const { connection, session, sockets } = makeSession();
    const [first, ...rest] = welcome.assets, assets = [{ ...first, start: 'hidden' }, ...rest];
    connection.start();
    sockets[0].accept();
    assert.equal(sockets[0].sent[0].params, undefined);
    sockets[0].say({ ...welcome, assets, view: { ...welcome.view, hidden: [first.id], isolate: [], ghost: [] } });
    assert.deepEqual(session.ownParams.hidden, [first.id]);
    assert.deepEqual(['hidden', 'isolate', 'ghost'].filter((name) => session.carried()[name]), []);
    session.setParams(showAll(session.params));
    assert.deepEqual(session.carried().hidden, []);
    session.setParams({ hidden: [first.id] });
    sockets[0].fail();
    connection.retryNow();
    sockets[1].accept();
    assert.deepEqual(sockets[1].sent[0].params.hidden, [first.id], 'a user\'s own set stays, whatever the plant\'s start is by then');
    const named = makeSession({ camera: null, params: { hidden: [] } });
    named.connection.start();
    named.sockets[0].accept();
    assert.deepEqual(named.sockets[0].sent[0].params.hidden, []);
});

test('parts of the view that this plant lacks are dropped and reported; the rest is requested again', () => {
    const params = { group: 'pressure', selected: 'E-9', ghost: ['P-9'] };
    const { connection, sockets, events } = makeSession({ camera: WANTED.camera, params });
    connection.start();
    sockets[0].accept();
    const errors = [['selected', 'E-9'], ['ghost', 'P-9']].map(([field, name]) => ({ type: 'error', code: 'bad_field',
        text: `${field}: this plant has no equipment “${name}”`, refusal: { code: 'no_asset', args: { name } }, about: 'hello' }));
    for (const error of errors)
        sockets[0].say(error);
    const again = sockets[0].sent.at(-1);
    assert.deepEqual([again.camera.eye, again.params], [WANTED.camera.eye, { seq: 1, group: 'pressure' }]);
    assert.deepEqual(events, errors.map((error) => ['astray', error]));
    sockets[0].say({ type: 'error', code: 'bad_field', text: 'group: \'pressure\' is no group of this plant', about: 'hello' });
    assert.deepEqual(sockets[0].sent.at(-1).params, undefined);
});

test('a token is asked for once and sent in hello, and the view is requested again', () => {
    const { session, sockets, events, connection } = makeSession();
    connection.start();
    sockets[0].accept();
    assert.equal(sockets[0].sent[0].token, undefined);
    sockets[0].say({ type: 'error', code: 'token_needed', text: 'a token is needed', about: 'hello' });
    assert.deepEqual([last(events)[0], connection.state], ['denied', 'barred']);
    session.token = 'pc_1';
    connection.retryNow();
    sockets[1].accept();
    assert.equal(sockets[1].sent[0].token, 'pc_1');
    sockets[1].say(welcome);
    assert.deepEqual([session.role, session.welcomed], [welcome.role, true]);
    sockets[1].fail();
    connection.retryNow();
    sockets[2].accept();
    assert.deepEqual([sockets[2].sent[0].token, sockets[2].sent[0].resume], ['pc_1', welcome.resume]);
});

test('a full server is asked again after the time that it named, not at once with less', () => {
    const { sockets, clock, connection } = makeSession();
    connection.start();
    sockets[0].accept();
    sockets[0].say(vector('server/error-full.json'));
    sockets[0].fail(1013, 'full');
    assert.equal(sockets[0].sent.length, 1);
    clock.advance(9999);
    assert.equal(sockets.length, 1);
    clock.advance(1);
    assert.equal(sockets.length, 2);
});

test('after a reconnect to another plant the session starts at that plant\'s home view', () => {
    const { session, socket, sockets, clock } = greeted(WANTED);
    socket.fail();
    clock.advance(500);
    sockets[1].accept();
    sockets[1].say({ ...welcome, plant: { ...welcome.plant, name: 'Unit 200' } });
    assert.deepEqual(session.camera, welcome.plant.home);
});

test('parameters are shown at once, corrected by the answer, and restored when refused', () => {
    const { session, socket } = greeted();
    session.setParams({ group: 'pressure' });
    assert.equal(session.params.interpolation, 'paper', 'a new group brings its own settings');
    assert.deepEqual(last(socket.sent), { type: 'params', seq: 1, group: 'pressure' });
    session.setParams({ colormap: 'viridis' });
    socket.say({ ...vector('server/params.json'), seq: 1, group: 'pressure', colormap: 'relief' });
    assert.equal(session.params.colormap, 'viridis', 'the answer to an older request changes nothing');
    socket.say({ ...vector('server/params.json'), seq: 2, group: 'pressure', colormap: 'viridis' });
    session.setParams({ colormap: 'plaid' });
    socket.say({ type: 'error', code: 'bad_field', text: 'colormap: plaid', about: 'params' });
    assert.equal(session.params.colormap, 'viridis');
});

test('items drawn over the picture follow the parameters of the shown picture', () => {
    const { session, socket, sockets, clock, events } = greeted();
    const frame = { seq: 1, cameraSeq: 0, paramsSeq: 0, waitUs: 0, fieldUs: 0, renderUs: 0, encodeUs: 0, sentTimeUs: 0 };
    const draw = (paramsSeq) => session.drawn({ ...frame, paramsSeq }, 1);
    const news = () => events.splice(0).filter(([name]) => name === 'shown').length;
    draw(0);
    session.setParams({ group: 'pressure' });
    session.setParams({ split: {} });
    session.setParams({ colormap: 'viridis' });
    assert.deepEqual([session.shown.group, session.shown.split, news()], ['temperature', null, 0]);
    draw(1);
    assert.deepEqual([session.shown.group, session.shown.split, news()], ['pressure', null, 1]);
    draw(3); // the server drew the third change of parameters and skipped the second one
    assert.deepEqual([session.shown, news()], [session.params, 1]);
    draw(3);
    assert.equal(news(), 0);
    socket.fail(); // parameters may also be set while there is no connection
    session.setParams({ group: 'temperature' });
    clock.advance(500);
    sockets[1].accept();
    session.setParams({ colormap: 'cividis' });
    sockets[1].say({ ...welcome, view: { ...welcome.view, group: 'temperature' } });
    assert.deepEqual([session.params.group, session.shown.group, session.shown.colormap], ['temperature', 'pressure', 'viridis']);
    draw(2);
    assert.deepEqual([session.shown, session.shown.colormap, news()], [session.params, 'cividis', 1]);
    session.setParams({ colormap: 'plaid' });
    sockets[1].say({ type: 'error', code: 'bad_field', text: 'colormap: plaid', about: 'params' });
    assert.equal(session.shown, session.params, 'no picture is awaited for refused parameters');
});

test('a choice or a resize between hello and welcome is not lost', () => {
    const { connection, sockets, session } = makeSession();
    connection.start();
    sockets[0].accept();
    session.setParams({ look: 'flat' });
    session.setParams({ ramp_interval: 5 });
    session.resize({ width: 900, height: 700 });
    sockets[0].say(welcome);
    assert.deepEqual(sockets[0].sent.slice(1), [
        { type: 'resize', width: 900, height: 700 }, { type: 'params', seq: 1, look: 'flat', ramp_interval: 5 },
    ]);
    assert.equal(session.params.look, 'flat');
});

test('a drawn frame is acknowledged and measured', () => {
    const { session, socket, clock, events } = greeted(WANTED);
    session.setCamera(orbit(session.camera, 3, 0), clock.now());
    session.flush();
    clock.advance(40);
    socket.sayBytes(vectorBytes('frame/jpeg-key.bin').buffer);
    const [name, frame] = last(events);
    assert.equal(name, 'frame');
    session.drawn({ ...frame, cameraSeq: 2 }, 2.345);
    assert.deepEqual(last(socket.sent), { type: 'ack', seq: 1, decode_ms: 2.35 });
    assert.equal(session.latency.median(clock.now()), 40);
    assert.equal(session.picture.payload, null);
});

test('a hidden page tells the server so, also over a new connection', () => {
    const { session, socket, sockets, clock } = greeted();
    session.setVisible(false);
    assert.deepEqual(last(socket.sent), { type: 'visible', visible: false });
    socket.fail();
    clock.advance(500);
    sockets[1].accept();
    sockets[1].say(welcome);
    assert.deepEqual(sockets[1].sent[1], { type: 'visible', visible: false });
});

test('tags have values, qualities, and ages that advance by the local clock', () => {
    const { session, socket, clock } = greeted();
    const values = [[0, 87.25, 'good', 'Good', 140], [1, null, 'bad', 'Bad_SensorFailure', null], [999, 1, 'good', 'Good', 0]];
    socket.say({ type: 'tags', time_us: 1, values });
    clock.advance(1000);
    assert.equal(session.model.readings[0].value, 87.25);
    assert.equal(session.model.ageMs(0, clock.now()), 1140);
    assert.equal(session.model.ageMs(1, clock.now()), null);
    assert.equal(session.model.oldestAgeMs(session.model.tags[0].group, clock.now()), 1140);
    assert.equal(session.model.worstQuality({ tags: [session.model.tags[0], session.model.tags[1]] }), 'bad');
    assert.equal(session.model.worstQuality({ tags: [] }), null);
    socket.say({ type: 'tags', time_us: 2, age_ms: 60, values: [[0, 88]] });
    assert.deepEqual(session.model.readings[0], { value: 88, quality: 'good', qualityName: 'Good', ageMs: 60, alarm: null,
        at: clock.now() });
    clock.advance(5000);
    assert.equal(session.model.ageMs(0, clock.now()), 5060);
    socket.say({ type: 'pong', t: 1, time_us: 3, oldest_age_ms: 300 });
    assert.equal(session.model.ageMs(0, clock.now()), 300, 'an unchanged reading that was read again is fresh');
    clock.advance(100);
    assert.equal(session.model.ageMs(0, clock.now()), 400);
});

test('markers belong to their frame, not to the next', () => {
    const { session, socket } = greeted();
    socket.say({ type: 'markers', seq: 4, markers: [[0, 1, 2, 1, 0], [0, 5, 2, 0, 1]], isolines: [[20, 3, 4, 0]] });
    socket.say({ type: 'markers', seq: 5, markers: [[0, 1, 2, 0, 0, 87.5, 1]] });
    assert.equal(session.markersOf(4).get('0/0').occluded, true);
    assert.deepEqual(session.markersOf(4).get('0/1'), { occluded: false, value: null, quality: null });
    assert.deepEqual(session.markersOf(4).isolines, [[20, 3, 4, 0]]);
    assert.deepEqual(session.markersOf(6).get('0/0'), { occluded: false, value: 87.5, quality: 'uncertain' });
    assert.equal(session.markersOf(6).get('7/0'), undefined);
    assert.deepEqual(session.markersOf(6).isolines, [[20, 3, 4, 0]]);
    assert.equal(session.markers.has(4), false);
    socket.say({ type: 'markers', seq: 8, values: [[0, 0, 88.5], [7, 0, null, 2]], isolines: [] });
    assert.deepEqual(session.markersOf(8).get('0/0'), { occluded: false, value: 88.5, quality: 'good' });
    assert.deepEqual([session.markersOf(8).get('7/0').quality, session.markersOf(8).isolines], ['bad', []]);
});

test('unknown and invalid messages are ignored, and the session continues', () => {
    const { session, socket, events } = greeted();
    socket.say(vector('server/unknown-type.json'));
    socket.say('{');
    socket.say('[1]');
    socket.sayBytes(new ArrayBuffer(10));
    assert.deepEqual(events.map(([name]) => name), ['ignored', 'ignored', 'ignored', 'ignored']);
    socket.say(vector('server/unknown-field.json'));
    socket.say(vector('server/status.json'));
    assert.equal(session.model.live, true);
});

test('messages before the welcome do no harm', () => {
    const { connection, sockets, session } = makeSession();
    connection.start();
    sockets[0].accept();
    for (const name of ['tags', 'markers', 'status', 'params'])
        sockets[0].say(vector(`server/${name}.json`));
    assert.equal(session.model, null);
});

test('the session understands every test vector of a server message', () => {
    for (const name of ['welcome', 'params', 'tags', 'tags-changed', 'markers', 'markers-none', 'markers-values', 'status', 'pong', 'error',
        'error-no-about']) {
        const { socket, events } = greeted();
        socket.say(vector(`server/${name}.json`));
        assert.ok(!events.some(([event]) => event === 'ignored'), name);
    }
});

test('the server\'s clock advances by the local clock', () => {
    const { session, clock } = greeted();
    clock.advance(2500);
    assert.equal(session.clockUs(), welcome.time_us + 2500000);
});

test('health: each state has its own kind and text', () => {
    const bench = makeSession();
    const { connection, session, clock, sockets } = bench;
    const now = () => health(session, clock.now());
    connection.start();
    assert.equal(now().kind, 'connecting');
    sockets[0].accept();
    sockets[0].say(welcome);
    const link = (source, up) => ({ source, up });
    sockets[0].say({ type: 'status', time_us: 1, live: true, links: [link('plc1', true), link('plc2', true)] });
    assert.equal(now().words, 'Live');
    sockets[0].say({ type: 'status', time_us: 1, live: true, links: [link('plc1', true), link('plc2', false)] });
    assert.deepEqual([now().kind, now().words, now().detail], ['partial', 'Live, 1 of 2 sources down', 'Source plc2 does not answer.']);
    const said = (links) => sockets[0].say({ type: 'status', time_us: 1, live: true, clock_set: false, links });
    said([{ ...link('plc1', true), simulated: true }, link('plc2', true)]);
    assert.deepEqual([now().kind, now().words, now().detail], ['simulated', 'Live, partly simulated', 'Simulated values from: plc1.']);
    assert.deepEqual([session.model.clockSet, session.model.clockErrorMs, session.model.leapS], [false, null, 0]);
    sockets[0].say({ type: 'status', time_us: 1, live: true, clock_set: true, clock_error_ms: 10, leap_s: 1, links: [] });
    assert.deepEqual([session.model.clockSet, session.model.clockErrorMs, session.model.leapS], [true, 10, 1]);
    let unrecorded;
    session.on('status', (message) => { ({ unrecorded } = message); });
    sockets[0].say({ type: 'status', time_us: 1, live: true, clock_set: true, unrecorded: ['alarms'], links: [] });
    assert.deepEqual(unrecorded, ['alarms']);
    said([{ ...link('plc1', true), simulated: true }]);
    assert.equal(now().words, 'Simulated');
    said([{ ...link('plc1', true), simulated: true }, link('plc2', false)]);
    assert.equal(now().words, 'Live, partly simulated, 1 of 2 sources down');
    sockets[0].say({ type: 'status', time_us: 1, live: false, links: [link('plc1', false), link('plc2', false)] });
    assert.equal(session.model.clockSet, true);
    assert.deepEqual([now().kind, now().banner], ['nodata', true]);
    session.drawn({ seq: 1, cameraSeq: 0 }, 1);
    clock.advance(6000);
    assert.equal(now().kind, 'silent');
    sockets[0].fail(1001);
    clock.advance(250);
    assert.equal(now().kind, 'lost');
    assert.equal(now().detail, 'The server shut down. This picture is 6.3 s old. Trying again in 1 s.');
});

test('health: after a reconnect the page is live only with a picture of the new connection', () => {
    const { connection, session, clock, sockets } = makeSession(), kinds = [];
    const now = () => health(session, clock.now());
    const status = { type: 'status', time_us: 1, live: true, links: [] };
    const greet = (socket) => [welcome, status].forEach((message) => socket.say(message));
    connection.start();
    sockets[0].accept();
    greet(sockets[0]);
    assert.equal(now().kind, 'live', 'without a picture, no old picture is reported');
    session.drawn({ seq: 1, cameraSeq: 0 }, 1);
    sockets[0].fail(1001);
    connection.onState = () => kinds.push(now().kind);
    clock.advance(4000);
    sockets[1].accept();
    greet(sockets[1]);
    clock.advance(400);
    assert.equal(now().kind, 'lost');
    assert.match(now().detail, /^This picture is 4\.4 s old\./);
    session.drawn({ seq: 1, cameraSeq: 0 }, 1);
    assert.equal(now().kind, 'live');
    assert.deepEqual([...new Set(kinds)], ['lost'], 'the page is never live in between');
});

test('a frame that the server gave up is skipped silently', () => {
    const { socket, events } = greeted();
    socket.sayBytes(vectorBytes('frame/bad-payload-missing.bin'));
    assert.deepEqual(events, []);
    socket.sayBytes(vectorBytes('frame/bad-payload-extra.bin'));
    assert.deepEqual(events.map(([name]) => name), ['ignored']);
    socket.sayBytes(vectorBytes('frame/jpeg-key.bin'));
    assert.equal(events.at(-1)[0], 'frame');
});

test('a frame has the depth grids that it refers to, of both halves or of none', () => {
    const { session, socket, events } = greeted(), frame = vectorBytes('frame/jpeg-key.bin'), withDepth = frame.slice();
    withDepth[2] |= 128;
    const grid = (flags) => Uint8Array.from([2, 1, flags, 0, 9]).buffer, newest = () => events.at(-1)[1].depth;
    socket.sayBytes(frame);
    assert.equal(newest(), null);
    socket.sayBytes(grid(2));
    socket.sayBytes(withDepth);
    assert.equal(newest(), null, 'the depth of the other half is missing');
    socket.sayBytes(grid(0));
    socket.sayBytes(withDepth);
    assert.equal(newest().messages.length, 2);
    socket.sayBytes(grid(0));
    socket.sayBytes(withDepth);
    const kept = newest();
    assert.equal(kept.messages.length, 1);
    socket.sayBytes(withDepth);
    assert.equal(newest(), kept, 'the depth grid of the earlier picture is used');
    socket.sayBytes(frame);
    assert.equal(newest(), null);
    socket.sayBytes(new ArrayBuffer(0));
    assert.equal(events.at(-1)[0], 'ignored');
    session.hello([]);
    assert.equal(session.depth, null, 'depth grids of the old connection are dropped');
});

test('the depth grid of a left half is dropped if its right half does not come', () => {
    const { session, socket } = greeted(), frame = vectorBytes('frame/jpeg-key.bin'), seen = [];
    frame[2] |= 128; // a depth grid belongs to the frame
    session.on('frame', ({ depth }) => seen.push(depth?.messages ?? null));
    const send = (seq, more) => {
        const bytes = Uint8Array.from([2, 2, more ? 2 : 0, 0, 0, 0, 0, 0, seq, 0, 0, 0]);
        socket.sayBytes(bytes);
        return bytes;
    };
    send(1, true);
    socket.sayBytes(frame);
    const whole = send(2, false);
    socket.sayBytes(frame);
    send(3, true);
    const halves = [send(4, true), send(4, false)];
    socket.sayBytes(frame);
    assert.deepEqual(seen, [null, [whole], halves]);
});

test('a follower shows the leader\'s parameters and camera until the follower moves', () => {
    const { session, socket, clock } = greeted();
    session.follow(12);
    assert.deepEqual(last(socket.sent), vector('client/accepted--follow.json'));
    socket.say(vector('server/following.json'));
    assert.deepEqual([session.following, session.params.group], [{ session: 12, who: 'kim', width: 1280, height: 720 }, 'temperature']);
    const camera = { eye: [9, 8, 7], target: [1, 1, 1], up: [0, 0, 1], fov: 40 };
    session.drawn({ seq: 1, cameraSeq: 0, camera, waitUs: 0, fieldUs: 0, renderUs: 0, encodeUs: 0, sentTimeUs: 0 }, 1);
    const sent = socket.sent.length;
    session.flush();
    assert.equal(socket.sent.length, sent, 'the leader\'s view is not sent back to the server');
    clock.advance(10);
    session.setCamera(orbit(session.camera, 3, 0));
    session.flush();
    assert.deepEqual(socket.sent.slice(sent).map((m) => [m.type, m.session]), [['follow', null], ['camera', undefined]]);
    assert.ok(Math.hypot(...last(socket.sent).eye.map((v, i) => v - camera.eye[i])) < 1,
        'the user\'s move starts from the last shown camera');
    socket.say(vector('server/following-nobody.json'));
    assert.deepEqual([session.following, session.params.group], [null, 'pressure']);
});

test('a leader who has left is still named', () => {
    const { session, socket } = greeted();
    session.follow(12);
    socket.say(vector('server/following.json'));
    socket.say(vector('server/following-gone.json'));
    assert.deepEqual([session.following.who, session.following.gone], ['kim', true]);
});

test('the halves of a split view have errors of their own, which a reload of the plant forgets', () => {
    const { session, socket } = greeted(WANTED), heard = [];
    session.on('shown', () => heard.push(session.drawnErrors.join()));
    for (const fields of [{ drawn_error: 2, drawn_error_right: 0.05 }, { drawn_error_right: 0.1 }, {}, { drawn_error: 0 }])
        socket.say({ type: 'markers', seq: 1, ...fields });
    assert.deepEqual(heard, ['2,0.05', '2,0.1', '0,0.1']);
    socket.say({ type: 'markers', seq: 2, drawn_error: 2 });
    socket.say(welcome);
    assert.deepEqual(session.drawnErrors, [0, 0]);
});

test('a follower\'s picture keeps its parameters until a picture with the leader\'s new ones arrives', () => {
    const { session, socket } = greeted(WANTED), following = vector('server/following.json');
    const say = (seq, group) => socket.say({ ...following, params_seq: seq, group });
    const draw = (paramsSeq) => session.drawn({ seq: 1, cameraSeq: 0, paramsSeq, camera: session.camera }, 1);
    const shown = () => session.shown.group;
    session.setParams({ group: 'pressure' });
    draw(2);
    session.follow(12);
    say(2, 'temperature'); // the leader's number equals this session's own one
    assert.deepEqual([session.params.group, shown()], ['temperature', 'pressure'], 'the own picture is still on the screen');
    draw(2);
    assert.equal(shown(), 'temperature');
    say(8, 'pressure');
    say(9, 'humidity');
    assert.equal(shown(), 'temperature');
    draw(8);
    assert.equal(shown(), 'pressure');
    draw(9);
    assert.equal(shown(), 'humidity');
    session.follow(null);
    socket.say({ ...vector('server/following-nobody.json'), params_seq: 2, group: 'pressure' });
    assert.equal(shown(), 'humidity', 'the leader\'s picture is still on the screen');
    for (let seq = 2; seq < 9; seq++)
        session.setParams({ group: 'temperature' });
    draw(9);
    assert.equal(shown(), 'temperature', 'the leader\'s numbers are forgotten');
});

test('a user who stops following sees the parameters of the own pictures, whatever numbers the leader has used', () => {
    const own = (session, group) => assert.equal(session.shown.group, group);
    const started = () => {
        const { session, socket } = greeted(WANTED);
        const draw = (paramsSeq) => session.drawn({ seq: 1, cameraSeq: 0, paramsSeq, camera: session.camera }, 1);
        draw(1);
        session.follow(12);
        socket.say({ ...vector('server/following.json'), params_seq: 2, group: 'humidity' });
        draw(2);
        own(session, 'humidity');
        return { session, socket, draw, nobody: { ...vector('server/following-nobody.json'), params_seq: 1, group: 'pressure' } };
    };
    const asks = started(); // "own view", and then a change
    asks.session.follow(null);
    asks.socket.say(asks.nobody);
    asks.session.setParams({ group: 'temperature' });
    own(asks.session, 'humidity');
    asks.draw(2);
    own(asks.session, 'temperature');
    const changes = started(); // a change, which ends the following
    changes.session.setParams({ group: 'temperature' });
    own(changes.session, 'humidity');
    changes.draw(2); // still the leader's
    changes.socket.say(changes.nobody);
    changes.socket.say({ ...vector('server/params.json'), seq: 2, group: 'temperature', colormap: 'relief' });
    changes.draw(2);
    assert.equal(changes.session.shown, changes.session.params);
});

test('a leader\'s picture whose number no message has stated keeps the parameters shown so far', () => {
    const { session, socket } = greeted(WANTED), following = vector('server/following.json');
    const draw = (paramsSeq) => session.drawn({ seq: 1, cameraSeq: 0, paramsSeq, camera: session.camera }, 1);
    session.follow(12);
    socket.say({ ...following, params_seq: 8, group: 'temperature' });
    draw(8);
    socket.say({ ...following, params_seq: 10, group: 'humidity' }); // the server has skipped 9
    draw(9);
    assert.equal(session.shown.group, 'temperature');
    socket.say({ ...following, params_seq: 11, group: 'pressure' });
    draw(10);
    assert.equal(session.shown.group, 'humidity');
});

test('a follower on a server that states no numbers shows the leader\'s parameters', () => {
    const { session, socket } = greeted(WANTED), { params_seq: _, ...following } = vector('server/following.json');
    const draw = (paramsSeq) => session.drawn({ seq: 1, cameraSeq: 0, paramsSeq, camera: session.camera }, 1);
    session.setParams({ group: 'pressure' });
    draw(2);
    session.follow(12);
    for (const group of ['temperature', 'humidity']) {
        socket.say({ ...following, group });
        assert.equal(session.shown.group, group);
        draw(2);
        assert.equal(session.shown.group, group);
    }
});

test('a user who begins to lead no longer follows; the shown camera stays until another is sent', () => {
    const eyes = (x) => ({ camera: { eye: [x, 8, 7], target: [1, 1, 1], up: [0, 0, 1], fov: 40 }, waitUs: 0, fieldUs: 0, renderUs: 0,
        encodeUs: 0, sentTimeUs: 0 });
    // By case: messages in the order in which the server sends them; a number stands for a picture with that camera, null for
    // the user's request to stop following. The last picture always shows the session's own view.
    const ways = {
        'given the lead before any picture of the leader': [vector('server/following.json'), vector('server/following-nobody.json'), 5],
        'given the lead while the leader moves': [vector('server/following.json'), 3, vector('server/following-nobody.json'), 4, 5],
        'given the lead at once': [vector('server/following-nobody.json'), 5],
        'on our own again': [vector('server/following.json'), 3, null, 3, vector('server/following-nobody.json'), 5],
    };
    for (const [how, way] of Object.entries(ways)) {
        const { session, socket, events } = greeted();
        session.follow(12);
        way.forEach((step, i) => {
            if (step === null)
                session.follow(null);
            else if (typeof step === 'number')
                session.drawn({ seq: i, cameraSeq: 0, ...eyes(step) }, 1);
            else
                socket.say(step);
        });
        assert.deepEqual(session.camera.eye, [5, 8, 7], how);
        // the session emits `camera`, so that the page writes the new camera into its address
        assert.equal(events.at(-1)[0], 'camera', how);
        const said = events.length, sent = socket.sent.length;
        session.flush();
        assert.equal(socket.sent.length, sent, 'the server knows the camera, so it is not sent');
        const own = orbit(session.camera, 3, 0);
        session.setCamera(own);
        session.drawn({ seq: 20, cameraSeq: 0, ...eyes(5) }, 1);
        assert.deepEqual(session.camera, own, 'messages under way change nothing');
        assert.equal(events.length, said + 1);
    }
});

test('a user who moves while following continues from there, whatever messages are under way', () => {
    const { session, socket } = greeted();
    session.follow(12);
    socket.say(vector('server/following.json'));
    const own = orbit(session.camera, 3, 0);
    session.setCamera(own);
    socket.say(vector('server/following-nobody.json'));
    session.drawn({ seq: 1, cameraSeq: 0, camera: { eye: [9, 8, 7], target: [1, 1, 1], up: [0, 0, 1], fov: 40 } }, 1);
    assert.deepEqual(session.camera, own);
});

test('timings list the stages of the last seconds\' pictures', () => {
    const picture = (ms, at, hereUs = 1e6 + 9000, more = {}) => ({
        picture: { waitUs: ms * 1000, fieldUs: 0, renderUs: 2000, encodeUs: 1000, sentTimeUs: 1e6, bytes: 1000, at, ...more },
        decodeMs: 4, hereUs,
    });
    assert.equal(timingOf([], 'wait'), null);
    const recent = Array.from({ length: 20 }, (_, i) => picture(i + 1, (i + 1) * 100));
    assert.deepEqual(['wait', 'network'].map((name) => timingOf(recent, name)), [{ p50: 10, p95: 19 }, { p50: 5, p95: 5 }]);
    assert.equal(timingOf(recent, 'decode').p50, 4);
    assert.equal(timingOf(recent, 'sensor'), null);
    const sensor = [...recent, picture(30, 2100, 1e6 + 9000, { data: true }), picture(1, 2200, null)];
    assert.deepEqual(timingOf(sensor, 'sensor'), { p50: 42, p95: 42 });
    assert.equal(timingOf(sensor, 'network').p50, 5, 'without a known server clock there is no network time');
    assert.deepEqual([kbitPerS(recent, 2000), kbitPerS(recent, 6050)], [32, 16]);
});

test('only the pictures of the last seconds are kept', () => {
    const { session, socket, clock } = greeted();
    for (let n = 0; n < 8; n++, clock.advance(1000)) {
        session.drawn({ seq: n + 1, cameraSeq: 0, payload: new Uint8Array(100 + n) }, 2);
        socket.say({ type: 'pong', t: 0, time_us: 1 });
    }
    assert.deepEqual(session.recent.map(({ picture }) => picture.bytes), [102, 103, 104, 105, 106, 107]);
    assert.equal(socket.sent.filter(({ type }) => type === 'ack').length, 8);
});

test('alarms: each tag shows its most urgent alarm, and the list is in order of urgency', () => {
    const { session, socket } = greeted();
    const { model } = session, { alarms } = model;
    assert.equal(alarms.known, false);
    assert.equal(model.worstAlarm(model.assets[0]), null);
    socket.say(vector('server/alarms.json'));
    assert.deepEqual([alarms.mode, alarms.known], ['local', true]);
    assert.deepEqual(alarms.list().map(({ tag, kind, state }) => [tag.index, kind, state]),
        [[0, 'HH', 'unacknowledged'], [1, 'BAD', 'returned']]);
    assert.deepEqual(asideOf(alarms).map(({ kind, who, reason }) => [kind, who, reason]),
        [['H', 'Kim (local)', 'transmitter is being changed']]);
    assert.equal(alarms.gravest(0).kind, 'HH');
    assert.deepEqual(alarms.counts(), { active: 1, waiting: 2, latched: 0, of: [0, 1, 0, 0], gone: [0, 0, 0, 1] });
    assert.deepEqual(actionsFor(alarms.list()[0], alarms.mode, 'operator'), ['acknowledge', 'shelve']);
    assert.deepEqual(actionsFor(alarms.list()[0], alarms.mode, 'viewer'), [], 'a viewer has no actions');
    socket.say(vector('server/alarms-changed.json'));
    assert.deepEqual(alarms.list().map(({ tag, kind }) => [tag.index, kind]), [[1, 'L']], 'an active alarm comes before a returned one');
    const [{ waiting, others }] = alarms.list();
    assert.deepEqual([waiting, others.map(({ kind }) => kind)], [true, ['BAD']], 'the unacknowledged alarm of the tag is waiting');
    assert.equal(alarms.gravest(0), null, 'a normal or shelved alarm does not count');
    assert.equal(model.worstAlarm({ tags: [model.tags[0], model.tags[1]] }).kind, 'L');
    socket.say({ ...vector('server/alarms.json'), mode: 'display' });
    assert.deepEqual(actionsFor(alarms.list()[0], alarms.mode, 'engineer'), [], 'alarms of the control system offer no actions');
    actOnAlarm(session, 'acknowledge', [['TT-101', 'HH']]);
    assert.deepEqual(socket.sent.at(-1), { type: 'alarm', seq: 1, action: 'acknowledge', alarms: [['TT-101', 'HH']] });
});

// [tag, kind, state, priority, raised_us]
const alarmRow = ([tag, kind, state, priority, us]) =>
    [tag, kind, state, priority, us, 1, 1, !['returned', 'latched'].includes(state), false];
const alarmRows = (...rows) => ({ type: 'alarms', mode: 'local', all: true, time_us: 1, alarms: rows.map(alarmRow) });

test('alarms: a tag counts once, by its most urgent alarm', () => {
    const { session, socket } = greeted();
    const { alarms } = session.model;
    socket.say(alarmRows([0, 'L', 'unacknowledged', 2, 1], [0, 'LL', 'unacknowledged', 1, 2],
        [1, 'H', 'acknowledged', 4, 1], [1, 'HH', 'acknowledged', 4, 1]));
    assert.deepEqual(alarms.list().map(({ tag, kind, others }) => [tag.index, kind, others.map((other) => other.kind)]),
        [[0, 'LL', ['L']], [1, 'HH', ['H']]], 'the outer limit comes first, also with equal priorities');
    assert.deepEqual(alarms.counts(), { active: 2, waiting: 1, latched: 0, of: [1, 0, 0, 1], gone: [0, 0, 0, 0] });
    socket.say(alarmRows([0, 'L', 'acknowledged', 2, 1], [0, 'LL', 'returned', 1, 2]));
    assert.deepEqual([alarms.gravest(0).kind, alarms.gravest(0).state, alarms.gravest(0).waiting], ['L', 'acknowledged', true]);
    socket.say(alarmRows([0, 'H', 'returned', 1, 2], [1, 'H', 'acknowledged', 4, 1]));
    assert.deepEqual(alarms.list().map(({ tag }) => tag.index), [1, 0], 'a returned alarm comes after an acknowledged active one');
    socket.say(alarmRows([0, 'L', 'returned', 2, 1], [0, 'LL', 'returned', 1, 2], [1, 'H', 'latched', 3, 2]));
    assert.deepEqual(alarms.counts(), { active: 0, waiting: 1, latched: 1, of: [0, 0, 0, 0], gone: [1, 0, 1, 0] });
});

test('alarms: each alarm is announced once, when it is raised', () => {
    const { session, socket } = greeted(), { alarms } = session.model;
    const raised = (all, ...rows) => {
        socket.say({ ...alarmRows(...rows), all });
        return alarms.raised.map(({ tag, kind }) => `${tag.index ?? tag.name} ${kind}`);
    };
    assert.deepEqual(raised(true, [0, 'H', 'unacknowledged', 3, 10]), [], 'alarms from before the connection are not announced');
    assert.deepEqual(raised(false, [0, 'H', 'acknowledged', 3, 10]), []);
    assert.deepEqual(raised(false, [0, 'HH', 'unacknowledged', 2, 20], [1, 'L', 'unacknowledged', 3, 20]), ['0 HH', '1 L']);
    assert.deepEqual(raised(false, [0, 'HH', 'returned', 2, 20], [1, 'L', 'returned', 3, 20]), []);
    assert.deepEqual(raised(false, [0, 'HH', 'normal'], [1, 'L', 'unacknowledged', 3, 30]), ['1 L'],
        'an alarm that is raised again is announced again');
    assert.deepEqual(raised(false, [1, 'L', 'normal'], [1, 'L', 'normal']), []);
    assert.deepEqual(raised(true, [0, 'H', 'acknowledged', 3, 10], [1, 'L', 'unacknowledged', 3, 40]), ['1 L'],
        'a complete list announces only new alarms');
});

test('alarms raised while the connection was lost are announced once, in the same plant', () => {
    const { clock, session, sockets } = greeted();
    const of = { kept: [0, 'H', 'unacknowledged', 3, 10], late: [1, 'L', 'unacknowledged', 3, 20] };
    const raised = (...rows) => {
        sockets.at(-1).say(alarmRows(...rows));
        return session.model.alarms.raised.map(({ tag, kind }) => `${tag.index} ${kind}`);
    };
    const reconnect = (greeting) => {
        sockets.at(-1).fail();
        clock.advance(60000);
        sockets.at(-1).accept();
        sockets.at(-1).say(greeting);
    };
    assert.deepEqual(raised(of.kept), []);
    reconnect(welcome);
    reconnect(welcome); // connects again before the alarms of the last connection arrived: these count as not seen yet
    assert.deepEqual(raised(of.kept, of.late), ['1 L']);
    assert.deepEqual(raised(of.kept, of.late), []);
    reconnect({ ...welcome, plant: { ...welcome.plant, name: 'Another' } });
    assert.deepEqual(raised(of.kept, of.late, [1, 'HH', 'unacknowledged', 1, 30]), []);
});

test('alarms: an action on a row applies to all its tag\'s alarms that allow the action; a filter narrows the rows', () => {
    const { session, socket } = greeted();
    const { alarms } = session.model;
    socket.say(alarmRows([0, 'L', 'returned', 2, 1], [0, 'LL', 'unacknowledged', 1, 2], [1, 'H', 'latched', 3, 2]));
    const [low, high] = alarms.list();
    const kinds = (row, action, role) => targetsOf(row, action, 'local', role).map(({ kind }) => kind);
    assert.deepEqual(kinds(low, 'acknowledge', 'operator'), ['LL', 'L']);
    assert.deepEqual(kinds(low, 'acknowledge', 'viewer'), []);
    assert.deepEqual([kinds(low, 'reset', 'operator'), kinds(high, 'reset', 'operator')], [[], ['H']]);
    assert.deepEqual(rowActions(low, 'local', 'operator'), ['acknowledge', 'shelve']);
    const which = (name, words = '') => [low, high].map((row) => passes(row, `${row.tag.name} pump`, { which: name, words }));
    assert.deepEqual(['all', 'waiting', 'active', 'gone', '1', '3'].map((name) => which(name)),
        [[true, true], [true, false], [true, false], [false, true], [true, false], [false, true]]);
    assert.deepEqual(which('all', ` PUMP  ${low.tag.name.toLowerCase()}`), [true, false]);
    assert.deepEqual(inMessages(Array(600).fill(0)).map(({ length }) => length), [256, 256, 88]);
});

test('alarms: a lost device is one alarm, without a tag', () => {
    const { session, socket } = greeted();
    const { alarms } = session.model;
    socket.say(vector('server/alarms-device.json'));
    assert.deepEqual(alarms.list().map(({ tag, kind }) => [tag.name, tag.index, kind]), [['plc1', null, 'LINK']]);
    assert.deepEqual(alarms.counts(), { active: 1, waiting: 1, latched: 0, of: [0, 0, 1, 0], gone: [0, 0, 0, 0] });
    assert.deepEqual(asideOf(alarms).map(({ tag, kind, state, reason }) => [tag.index, kind, state, reason]),
        [[0, 'BAD', 'suppressed', ''], [1, 'BAD', 'suppressed', '']]);
    assert.equal(alarms.gravest(0), null);
    socket.say({ type: 'alarms', mode: 'local', all: false, time_us: 2, alarms: [['plc1', 'LINK', 'normal']] });
    assert.deepEqual(alarms.list(), []);
});

test('in the past the session\'s clock is separate, ages stand still, and a new connection returns there', () => {
    const { session, socket, sockets, clock } = greeted();
    const time = vector('server/time.json');
    travel(session, time.at_us + 0.25, 60);
    assert.deepEqual(last(socket.sent), { type: 'time', at_us: time.at_us, speed: 60 });
    travel(session, undefined, 0);
    assert.deepEqual(last(socket.sent), { type: 'time', speed: 0 });
    socket.say({ type: 'status', links: [], time_us: 1793500000000000, live: true });
    socket.say(time);
    assert.deepEqual(session.time, { atUs: time.at_us, speed: 60, fromUs: time.from_us });
    socket.say({ type: 'tags', time_us: time.at_us, age_ms: 0, values: [[0, 5]] });
    assert.ok(Math.abs(session.clockUs() - 1793500000000000) < 1e6, 'the plant’s clock is at the present');
    const age = session.model.ageMs(0, clock.now());
    assert.equal(session.model.ageMs(0, clock.now() + 60000), age);
    assert.equal(session.model.alarms.gravest(0), null);
    socket.say({ type: 'tags', time_us: time.at_us, age_ms: 0, values: [[0, 99, 'good', 'Good', 0, 'HH', 1, 'unacknowledged']] });
    assert.deepEqual([session.model.alarms.gravest(0).kind, session.model.alarms.gravest(0).priority], ['HH', 1]);
    const { kind, words, detail, banner } = health(session, clock.now());
    assert.deepEqual([kind, words, banner], ['past', 'History', true]);
    assert.match(detail, /^\w{3} \d+, 2026 .*, playing 60×$/);
    session.hello([]);
    assert.deepEqual([last(socket.sent).at_us, last(socket.sent).speed], [time.at_us, 60]);
    assert.equal(sockets.length, 1);
});

test('a server that records no history shows the present, whatever instant the address has', () => {
    const { session, socket, clock, events } = greeted({ camera: null, params: {}, time: { atUs: 1793491200250000 } });
    let heard = 0;
    session.on('time', () => { heard++; });
    socket.say({ type: 'status', links: [], time_us: 1793500000000000, live: true });
    assert.equal(socket.sent[0].at_us, 1793491200250000);
    assert.equal(health(session, clock.now()).kind, 'past');
    const error = { type: 'error', about: 'time', code: 'no_history', text: 'no history', refusal: { code: 'unrecorded', args: {} } };
    socket.say(error);
    assert.deepEqual([session.time.atUs, Boolean(session.recorded), session.model.stopped, heard], [null, false, false, 1]);
    assert.equal(health(session, clock.now()).kind, 'live');
    assert.deepEqual(events.at(-1), ['error', error], 'the user gets the reason');
});

test('back in the present, the picture is marked as past until its first present picture', () => {
    const { session, socket, clock } = greeted();
    socket.say({ type: 'status', links: [], time_us: 1793500000000000, live: true });
    session.picture = { past: true, dataTimeUs: 1793491200250000, at: 0 };
    socket.say(vector('server/time-now.json'));
    assert.deepEqual([health(session, clock.now()).kind, health(session, clock.now()).words], ['past', 'Returning to live']);
    session.picture = { past: false, dataTimeUs: 1793500000000000, at: 0 };
    assert.equal(health(session, clock.now()).kind, 'live');
});
