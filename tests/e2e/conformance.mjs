// SPDX-License-Identifier: GPL-3.0-or-later
// PROTOCOL.md against a real daemon, sentence by sentence, with a client that was written from that page alone (conformance/client.mjs).
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { Client, FLAG, readHeader } from './conformance/client.mjs';
import { notBuilt, TinyPlant } from './support/tiny_plant.mjs';

const skip = notBuilt();
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const CAMERA = { eye: [5, -6, 4], target: [1, 0, 0] };
let plant;

before(async () => {
    if (skip)
        return;
    plant = await TinyPlant.create();
    await plant.start();
});
after(() => plant?.destroy());

test('the header is where the page says, for every vector', () => {
    const folder = 'protocol/vectors/frame';
    let good = 0;
    for (const name of readdirSync(folder).filter((file) => file.endsWith('.json'))) {
        const { valid, ...expected } = JSON.parse(readFileSync(`${folder}/${name}`, 'utf8'));
        if (!valid)
            continue;
        const got = readHeader(readFileSync(`${folder}/${name.replace('.json', '.bin')}`));
        for (const [field, value] of Object.entries(expected))
            if (field in got && typeof value === 'number' && Math.abs(value - got[field]) > 1e-5 * Math.abs(value))
                assert.fail(`${name}: ${field} is ${got[field]}, not ${value}`);
        good++;
    }
    assert.ok(good >= 8, `${good} vectors`);
});

test('versions: ours among others is spoken, another is refused by name', { skip }, async () => {
    (await Client.open(plant.port, { protocols: 'plantcast.v2, plantcast.v1' })).close();
    await assert.rejects(Client.open(plant.port, { protocols: 'plantcast.v2' }), /400.*plantcast\.v2.*plantcast\.v1/s);
});

test('welcome has what the page says', { skip }, async () => {
    const client = await Client.open(plant.port);
    const welcome = await client.hello({ pixel_ratio: 1.5, a_field_of_tomorrow: { x: 1 } });
    assert.equal(welcome.protocol, 'plantcast.v1');
    assert.equal(welcome.role, 'engineer');
    assert.match(welcome.resume, /^\S+$/);
    assert.ok(welcome.resume_s > 0 && welcome.resumed === false && welcome.limits.message_bytes >= 1024);
    assert.ok(welcome.limits.messages_per_s > 0 && welcome.limits.pixels >= 320 * 180);
    assert.deepEqual([welcome.codec, typeof welcome.session, typeof welcome.server], ['jpeg', 'number', 'string']);
    assert.deepEqual(Object.keys(welcome.plant).sort(), ['bounds', 'configuration', 'home', 'name', 'outline', 'time_zone']);
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

test('pictures are whole, in order, of the size asked for, and say when and whence they were seen', { skip }, async () => {
    const client = await Client.open(plant.port);
    const welcome = await client.hello();
    const now = await client.serverTime();
    const first = await client.picture('the first');
    assert.deepEqual([first.seq > 0, first.flags & FLAG.key, first.camera_seq, first.params_seq], [true, FLAG.key, 0, 0]);
    for (const [i, value] of welcome.plant.home.eye.entries())
        assert.ok(Math.abs(first.eye[i] - value) < 1e-3);
    assert.ok(Math.abs(first.sent_time_us - now) < 10e6 && first.data_time_us <= first.sent_time_us && first.data_time_us > now - 20e6);
    assert.ok(first.render_us > 0 && first.encode_us > 0);
    client.say('camera', { seq: 1, ...CAMERA, fov: 40 });
    const moved = await client.picture('camera 1', (p) => p.camera_seq === 1);
    assert.deepEqual([moved.eye, moved.target, moved.up, moved.fov], [CAMERA.eye, CAMERA.target, [0, 0, 1], 40]);
    const still = await client.picture('refined', (p) => p.camera_seq === 1 && p.flags & FLAG.still);
    assert.deepEqual([still.full_width, still.full_height], [320, 180]);
    let last = 0;
    for (const { seq, parts } of client.pictures) {
        assert.ok(seq > last, 'seq counts up');
        last = seq;
        for (const { header, size } of parts) {
            assert.deepEqual(size, [header.width, header.height]);
            assert.ok(header.x + header.width <= header.full_width && header.y + header.height <= header.full_height);
        }
    }
    client.close();
});

test('parameters, sizes and projections are echoed by the pictures that show them', { skip }, async () => {
    const client = await Client.open(plant.port);
    await client.hello({ codecs: ['av2', 'png'], camera: { seq: 3, ...CAMERA }, params: { seq: 4, group: 'pressure' } });
    const first = await client.picture('the first');
    assert.deepEqual([first.codec, first.camera_seq, first.params_seq], ['png', 3, 4]);
    client.say('params', { seq: 5, ramp_interval: 2, range: [0, 8] });
    const { seq, group, ramp_interval: ramp, range, distance, unit } = await client.text('params');
    assert.deepEqual([seq, group, ramp, range, distance, unit], [5, 'pressure', 2, [0, 8], 'euclidean', 'bar']);
    const shown = await client.picture('parameters 5', (p) => p.params_seq === 5);
    // markers are sent only when they change
    const markers = client.texts.findLast((m) => m.type === 'markers' && m.markers && m.seq <= shown.seq);
    assert.deepEqual(markers?.markers.map(([tag]) => tag), [2], 'markers go before their frame');
    client.say('resize', { width: 200, height: 120, pixel_ratio: 2 });
    await client.picture('200x120', (p) => p.full_width === 200 && p.full_height === 120 && p.flags & FLAG.still);
    client.say('camera', { seq: 6, ...CAMERA, projection: 'orthographic', height_m: 5 });
    const flat = await client.picture('orthographic', (p) => p.camera_seq === 6);
    assert.deepEqual([flat.fov, flat.height_m], [0, 5]);
    client.say('codecs', { codecs: ['jpeg'] });
    const other = await client.picture('JPEG', (p) => p.codec === 'jpeg');
    assert.ok(other.flags & FLAG.key);
    client.close();
});

test('fit, pick and key frames are answered', { skip }, async () => {
    const client = await Client.open(plant.port);
    await client.hello();
    client.say('fit', { seq: 1, id: 'E-101', side: 'right' });
    const { seq, eye, target, up, fov } = await client.text('camera');
    assert.ok(seq === 1 && eye[0] > target[0]);
    client.say('pick', { seq: 2, x: 160.5, y: 90.5, camera: { eye, target, up, fov } });
    const picked = await client.text('picked');
    assert.deepEqual([picked.seq, picked.asset, picked.unit, picked.inside], [2, 'E-101', '°C', false]);
    assert.ok(['measured', 'between', 'no data'].includes(picked.state) && picked.position.length === 3);
    await client.picture('refined', (p) => p.flags & FLAG.still);
    const before = client.pictures.at(-1).seq;
    client.say('key_frame');
    const again = await client.picture('another', (p) => p.seq > before);
    assert.ok(again.parts[0].header.flags & FLAG.key);
    client.close();
});

test('a page that is not seen gets nothing, and one picture when it is', { skip }, async () => {
    const client = await Client.open(plant.port);
    await client.hello();
    await client.picture('refined', (p) => p.flags & FLAG.still);
    client.say('visible', { visible: false });
    await client.serverTime(1);
    const count = client.pictures.length;
    client.say('camera', { seq: 1, ...CAMERA });
    await sleep(500);
    assert.equal(client.pictures.length, count);
    client.say('visible', { visible: true });
    await client.picture('camera 1', (p) => p.camera_seq === 1);
    client.close();
});

test('who does not acknowledge gets what may be under way, and the newest once it does', { skip }, async () => {
    const client = await Client.open(plant.port);
    client.acknowledges = false;
    await client.hello();
    for (let seq = 1; seq <= 20; seq++) {
        client.say('camera', { seq, ...CAMERA, eye: [5, -6 - seq / 20, 4] });
        await sleep(25);
    }
    assert.ok(client.pictures.length <= 8, `${client.pictures.length} pictures under way`);
    client.acknowledges = true;
    client.say('ack', { seq: client.pictures.at(-1).seq });
    await client.picture('the last camera', (p) => p.camera_seq === 20);
    client.close();
});

test('who comes back has the view that it left', { skip }, async () => {
    const client = await Client.open(plant.port);
    const { resume } = await client.hello({ width: 256, height: 144, camera: { seq: 9, ...CAMERA } });
    client.say('params', { seq: 1, group: 'pressure', sensors: { 'PI-1': { strength: 2 } } });
    await client.text('params');
    client.socket.destroy(); // no closing handshake
    const again = await Client.open(plant.port);
    again.say('hello', { resume });
    const welcome = await again.text('welcome');
    assert.deepEqual([welcome.resumed, welcome.view.group, welcome.view.sensors], [true, 'pressure', { 'PI-1': { strength: 2 } }]);
    assert.notEqual(welcome.resume, resume);
    const picture = await again.picture('the first');
    assert.deepEqual([picture.full_width, picture.full_height, picture.eye, picture.camera_seq], [256, 144, CAMERA.eye, 0]);
    const third = await Client.open(plant.port);
    third.say('hello', { resume: welcome.resume }); // resumes while the second connection is still open
    assert.equal((await third.text('welcome')).resumed, true);
    assert.equal((await again.wait('a close', (c) => c.closed)).code, 1000);
    const late = await Client.open(plant.port);
    late.say('hello', { resume });
    assert.equal((await late.text('error')).code, 'bad_field');
    assert.equal((await late.hello({ resume })).resumed, false);
    third.close();
    late.close();
});

test('any number follow one; who leads gives the lead away, and what is shown stays', { skip }, async () => {
    const [presenter, heir, viewer] = await Promise.all([0, 1, 2].map(() => Client.open(plant.port)));
    const camera = { seq: 1, ...CAMERA };
    const { session } = await presenter.hello({ width: 400, height: 240, camera, params: { seq: 1, group: 'pressure' } });
    const heirs = (await heir.hello({ width: 320, height: 200 })).session, viewers = (await viewer.hello()).session;
    const told = (client, what, match) => client.wait(what, (c) => c.texts.some((m) => m.type === 'following' && match(m)));
    presenter.say('lead', { session: heirs });
    assert.equal((await presenter.text('error')).code, 'bad_field', 'it does not follow');
    for (const client of [heir, viewer]) {
        client.say('follow', { session });
        await told(client, 'whom', (m) => m.session === session && m.width === 400 && m.group === 'pressure');
        await client.picture('the presenter\'s view', (p) => p.full_width === 400 && p.eye[1] === CAMERA.eye[1] && p.flags & FLAG.still);
    }
    const sorted = (list) => [...list].sort((a, b) => a - b);
    await presenter.wait('two followers', (c) => c.texts.some((m) => m.type === 'followers' && m.count === 2
        && `${sorted(m.sessions)}` === `${sorted([heirs, viewers])}`));
    presenter.say('lead', { session: heirs });
    await told(heir, 'that it leads', (m) => m.session === null && m.group === 'pressure' && m.width === 320);
    await heir.wait('two followers', (c) => c.texts.some((m) => m.type === 'followers' && m.count === 2
        && `${sorted(m.sessions)}` === `${sorted([session, viewers])}`));
    for (const client of [presenter, viewer]) {
        await told(client, 'the new one', (m) => m.session === heirs && m.width === 320 && m.group === 'pressure');
        const same = await client.picture('the same from there', (p) => p.full_width === 320 && p.full_height === 200);
        assert.equal(same.eye[1], CAMERA.eye[1]);
    }
    await presenter.wait('nobody follows it', (c) => c.texts.some((m) => m.type === 'followers' && m.count === 0));
    heir.say('camera', { seq: 5, ...CAMERA, eye: [6, -5, 3] });
    for (const client of [presenter, viewer])
        await client.picture('where the new one looks', (p) => p.eye[0] === 6);
    presenter.say('lead', { session: viewers });
    assert.equal((await presenter.text('error')).code, 'bad_field', 'who follows has no lead to give');
    heir.close();
    await told(viewer, 'that the leader has gone, and what is shown stays', (m) => m.session === heirs && m.gone && m.group === 'pressure');
    presenter.close();
    viewer.close();
});

test('mistakes are answered by their names, what is unknown is passed over', { skip }, async () => {
    const client = await Client.open(plant.port);
    const expect = async (code, about, type, fields) => {
        client.say(type, fields);
        const error = await client.text('error');
        assert.deepEqual([error.code, error.about, typeof error.text], [code, about, 'string'], type);
    };
    await expect('hello_first', 'camera', 'camera', { seq: 1, ...CAMERA });
    await client.hello();
    await expect('hello_again', 'hello', 'hello', { width: 320, height: 180, codecs: ['jpeg'] });
    await expect('unknown_type', null, 'teleport', {});
    await expect('bad_field', 'camera', 'camera', { seq: 1, eye: [1, 2, 3], target: [1, 2, 3] });
    await expect('bad_field', 'params', 'params', { seq: 1, group: 'nothing' });
    await expect('bad_field', 'ack', 'ack', { seq: 123456789 });
    await expect('bad_field', 'resize', 'resize', { width: 0, height: 0 });
    client.say('ping', { t: 0.1 + 0.2, field: 'of tomorrow' });
    assert.equal((await client.text('pong')).t, 0.1 + 0.2);
    client.close();
});

test('a server that goes down says so', { skip }, async () => {
    const client = await Client.open(plant.port);
    await client.hello();
    await plant.daemon.stop();
    assert.equal((await client.wait('a close', (c) => c.closed)).code, 1001);
});
