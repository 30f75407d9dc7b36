// SPDX-License-Identifier: GPL-3.0-or-later
// Checks each statement of PROTOCOL.md against a real daemon, with a client written from that page alone
// (support/plain_client.mjs). The answers to fits, picks and errors are tested in daemon.mjs.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FLAG, get, http, PlainClient } from './support/plain_client.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
const JPEG = 1, PNG = 2; // numbers of codecs in PROTOCOL.md
const CAMERA = { eye: [5, -6, 4], target: [1, 0, 0] };
const BEGAN_US = Date.now() * 1000;
let plant;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    plant.keepFresh();
    await plant.start();
    await plant.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
    await until('good readings', async () => JSON.parse((await get(plant.port, '/api/v1/tags')).body).tags
        .every(({ quality_name: quality }) => quality === 'Good'));
});

test('the server picks its protocol version from several, and refuses unknown versions by name', { skip }, async () => {
    (await PlainClient.open(plant.port, { protocol: 'plantcast.v2, plantcast.v1' })).close();
    const lines = ['GET /stream HTTP/1.1', `Host: 127.0.0.1:${plant.port}`, 'Upgrade: websocket', 'Connection: Upgrade',
        'Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==', 'Sec-WebSocket-Version: 13', 'Sec-WebSocket-Protocol: plantcast.v2', '', ''];
    const refused = await http(plant.port, lines.join('\r\n'));
    assert.equal(refused.status, 400);
    assert.match(refused.body.toString(), /plantcast\.v2.*plantcast\.v1/s);
});

test('the welcome message has all fields that PROTOCOL.md lists', { skip }, async () => {
    const client = await PlainClient.open(plant.port);
    const welcome = await client.hello({ pixel_ratio: 1.5, a_field_of_tomorrow: { x: 1 } });
    assert.equal(welcome.protocol, 'plantcast.v1');
    assert.equal(welcome.role, 'engineer');
    assert.match(welcome.resume, /^\S+$/);
    assert.ok(welcome.resume_s > 0 && welcome.resumed === false && welcome.limits.message_bytes >= 1024);
    assert.ok(welcome.limits.messages_per_s > 0 && welcome.limits.pixels >= 320 * 180);
    assert.deepEqual([welcome.codec, typeof welcome.session, typeof welcome.server], ['jpeg', 'number', 'string']);
    assert.deepEqual(Object.keys(welcome.plant).sort(), ['bounds', 'configuration', 'home', 'name', 'outline', 'time_zone', 'up']);
    const lists = {
        groups: ['id', 'quantity', 'unit', 'min', 'max', 'limits', 'interpolation', 'distance', 'fill', 'power', 'radius_m', 'reach_m',
            'singles', 'scale', 'breaks', 'isolines'],
        assets: ['id', 'tag', 'description', 'bounds'],
        tags: ['name', 'description', 'unit', 'group', 'asset', 'position', 'limits'],
        colormaps: ['name', 'rgb', 'below', 'above', 'safe'],
    };
    for (const [list, names] of Object.entries(lists))
        for (const name of names)
            assert.ok(name in welcome[list][0], `${list}: ${name}`);
    assert.equal(Buffer.from(welcome.colormaps[0].rgb, 'base64').length, 768);
    assert.equal(welcome.environments[0], 'sky');
    assert.deepEqual(welcome.groups.map((group) => group.id), ['temperature', 'pressure']);
    const tags = await client.text('tags');
    assert.deepEqual(tags.values.map(([index]) => index), [0, 1, 2]);
    for (const [, value, quality] of tags.values) /* a missing quality means good */
        assert.ok(quality === undefined ? typeof value === 'number' && tags.age_ms >= 0 : ['good', 'uncertain', 'bad'].includes(quality));
    const status = await client.text('status');
    assert.deepEqual([status.links.length, typeof status.live], [1, 'boolean']);
    client.close();
});

test('pictures are complete, in order and of the requested size, and state their time and camera', { skip }, async () => {
    const client = await PlainClient.open(plant.port), asked_us = Date.now() * 1000;
    const welcome = await client.hello();
    client.say({ type: 'ping', t: 1, field: 'of tomorrow' });
    const { t, time_us: now } = await client.text('pong');
    assert.equal(t, 1);
    const first = await client.frameWhere('the first');
    assert.deepEqual([first.seq > 0, first.flags & FLAG.key, first.camera_seq, first.params_seq], [true, FLAG.key, 0, 0]);
    for (const [i, value] of welcome.plant.home.eye.entries())
        assert.ok(Math.abs(first.eye[i] - value) < 1e-3);
    const came_us = Date.now() * 1000 + 1000, times = JSON.stringify([asked_us, now, came_us, first.sent_time_us, first.data_time_us]);
    assert.ok([now, first.sent_time_us].every((us) => us >= asked_us && us <= came_us), times);
    assert.ok(first.data_time_us <= first.sent_time_us && first.data_time_us > BEGAN_US, times);
    assert.ok(first.render_us > 0 && first.encode_us > 0);
    client.say({ type: 'camera', seq: 1, ...CAMERA, fov: 40 });
    const moved = await client.frameWhere('camera 1', (p) => p.camera_seq === 1);
    assert.deepEqual([moved.eye, moved.target, moved.up, moved.fov], [CAMERA.eye, CAMERA.target, [0, 0, 1], 40]);
    const still = await client.frameWhere('refined', (p) => p.camera_seq === 1 && p.flags & FLAG.still);
    assert.deepEqual([still.full_width, still.full_height], [320, 180]);
    let last = 0, isPart = false;
    // frames with equal seq are parts of one picture; otherwise seq must increase
    for (const { seq, flags, x, y, width, height, full_width, full_height, payload } of client.frames) {
        assert.ok(seq > last || (isPart && seq === last), 'seq increases');
        [last, isPart] = [seq, Boolean(flags & FLAG.more)];
        assert.deepEqual([payload.readUInt16BE(0), payload.readUInt16BE(payload.length - 2)], [0xffd8, 0xffd9],
            'the payload begins and ends as a JPEG does');
        assert.ok(x + width <= full_width && y + height <= full_height);
    }
    client.close();
});

test('pictures echo the parameters, sizes and projections that they show', { skip }, async () => {
    const client = await PlainClient.open(plant.port);
    await client.hello({ codecs: ['av2', 'png'], camera: { seq: 3, ...CAMERA }, params: { seq: 4, group: 'pressure' } });
    const first = await client.frameWhere('the first');
    assert.deepEqual([first.codec, first.camera_seq, first.params_seq], [PNG, 3, 4]);
    assert.deepEqual([first.payload.readUInt32BE(16), first.payload.readUInt32BE(20)], [first.width, first.height]);
    client.say({ type: 'params', seq: 5, ramp_interval: 2, range: [0, 8] });
    const { seq, group, ramp_interval: ramp, range, distance, unit } = await client.text('params');
    assert.deepEqual([seq, group, ramp, range, distance, unit], [5, 'pressure', 2, [0, 8], 'euclidean', 'bar']);
    const shown = await client.frameWhere('parameters 5', (p) => p.params_seq === 5);
    // takes the last `markers` message before the frame, because the server sends markers only when they change
    const markers = client.texts.findLast((m) => m.type === 'markers' && m.markers && m.seq <= shown.seq);
    assert.deepEqual(markers?.markers.map(([tag]) => tag), [2], 'markers are sent before their frame');
    client.say({ type: 'resize', width: 200, height: 120, pixel_ratio: 2 });
    await client.frameWhere('200x120', (p) => p.full_width === 200 && p.full_height === 120 && p.flags & FLAG.still);
    client.say({ type: 'camera', seq: 6, ...CAMERA, projection: 'orthographic', height_m: 5 });
    const flat = await client.frameWhere('orthographic', (p) => p.camera_seq === 6);
    assert.deepEqual([flat.fov, flat.height_m], [0, 5]);
    client.say({ type: 'codecs', codecs: ['jpeg'] });
    const other = await client.frameWhere('JPEG', (p) => p.codec === JPEG);
    assert.ok(other.flags & FLAG.key);
    client.close();
});

test('a key frame is sent on request', { skip }, async () => {
    const client = await PlainClient.open(plant.port);
    await client.hello();
    await client.frameWhere('refined', (p) => p.flags & FLAG.still);
    const before = client.frames.at(-1).seq;
    client.say({ type: 'key_frame' });
    const again = await client.frameWhere('another', (p) => p.seq > before);
    assert.ok(again.flags & FLAG.key);
    client.close();
});

test('a client that reconnects gets the view that it left', { skip }, async () => {
    const client = await PlainClient.open(plant.port);
    const { resume } = await client.hello({ width: 256, height: 144, camera: { seq: 9, ...CAMERA } });
    client.say({ type: 'params', seq: 1, group: 'pressure', sensors: { 'PI-1': { strength: 2 } } });
    await client.text('params');
    client.socket.destroy(); // break the connection without a closing handshake
    const again = await PlainClient.open(plant.port);
    again.say({ type: 'hello', resume });
    const welcome = await again.text('welcome');
    assert.deepEqual([welcome.resumed, welcome.view.group, welcome.view.sensors], [true, 'pressure', { 'PI-1': { strength: 2 } }]);
    assert.notEqual(welcome.resume, resume);
    const picture = await again.frameWhere('the first');
    assert.deepEqual([picture.full_width, picture.full_height, picture.eye, picture.camera_seq], [256, 144, CAMERA.eye, 0]);
    again.close();
});

test('several clients follow one leader; the leader hands over the lead, and the shown view stays', { skip }, async () => {
    const [presenter, heir, viewer] = await Promise.all([0, 1, 2].map(() => PlainClient.open(plant.port)));
    const camera = { seq: 1, ...CAMERA };
    const { session } = await presenter.hello({ width: 400, height: 240, camera, params: { seq: 1, group: 'pressure' } });
    const heirs = (await heir.hello({ width: 320, height: 200 })).session, viewers = (await viewer.hello()).session;
    const told = (client, what, match) => client.until(what, (c) => c.texts.some((m) => m.type === 'following' && match(m)));
    presenter.say({ type: 'lead', session: heirs });
    assert.equal((await presenter.text('error')).code, 'bad_field', 'a session that does not follow cannot be given the lead');
    for (const client of [heir, viewer]) {
        client.say({ type: 'follow', session });
        await told(client, 'whom', (m) => m.session === session && m.width === 400 && m.group === 'pressure');
        await client.frameWhere('the presenter\'s view', (p) => p.full_width === 400 && p.eye[1] === CAMERA.eye[1] && p.flags & FLAG.still);
    }
    const sorted = (list) => [...list].sort((a, b) => a - b);
    await presenter.until('two followers', (c) => c.texts.some((m) => m.type === 'followers' && m.count === 2
        && `${sorted(m.sessions)}` === `${sorted([heirs, viewers])}`));
    presenter.say({ type: 'lead', session: heirs });
    await told(heir, 'that it leads', (m) => m.session === null && m.group === 'pressure' && m.width === 320);
    await heir.until('two followers', (c) => c.texts.some((m) => m.type === 'followers' && m.count === 2
        && `${sorted(m.sessions)}` === `${sorted([session, viewers])}`));
    for (const client of [presenter, viewer]) {
        await told(client, 'the new one', (m) => m.session === heirs && m.width === 320 && m.group === 'pressure');
        const same = await client.frameWhere('the same from there', (p) => p.full_width === 320 && p.full_height === 200);
        assert.equal(same.eye[1], CAMERA.eye[1]);
    }
    await presenter.until('nobody follows it', (c) => c.texts.some((m) => m.type === 'followers' && m.count === 0));
    heir.say({ type: 'camera', seq: 5, ...CAMERA, eye: [6, -5, 3] });
    for (const client of [presenter, viewer])
        await client.frameWhere('where the new one looks', (p) => p.eye[0] === 6);
    presenter.say({ type: 'lead', session: viewers });
    assert.equal((await presenter.text('error')).code, 'bad_field', 'a follower has no lead to hand over');
    heir.close();
    await told(viewer, 'that the leader has gone, and what is shown stays', (m) => m.session === heirs && m.gone && m.group === 'pressure');
    presenter.close();
    viewer.close();
});
