// SPDX-License-Identifier: GPL-3.0-or-later
// One picture over many displays, on the server's side: drawn once, cut without a seam, shown by all at the same instant or not
// at all.
import assert from 'node:assert/strict';
import { appendFileSync } from 'node:fs';
import { test } from 'node:test';
import { burnShift } from '../../clients/web/core/wall.js';
import { Canvas } from './support/png_pixels.mjs';
import { get, PlainClient } from './support/plain_client.mjs';
import { Relay, relayMissing } from './support/relay.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { long, promise } from './support/promise.mjs';
import { until } from './support/until.mjs';

const options = { skip: notBuilt(), timeout: 240000 };
const [WIDTH, HEIGHT] = [320, 180], KEY = 1, STILL = 2, MORE = 8;
const WALLS = `
views: [{ id: all, title: All, view: "group=temperature" }]
walls:
- { id: seamless, tile: { columns: 3, rows: 2, views: all } }
- id: framed
  inches: 10
  tile: { columns: 2, rows: 2, bezel_mm: [20, 10], views: all }
  displays: [{ grid: [a], panes: [{ area: a, clock: yes }] }]
`;
const BEZEL = [20, 10].map((mm) => Math.round((mm * Math.hypot(WIDTH, HEIGHT)) / (10 * 25.4)));
let plant;

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    appendFileSync(plant.file, WALLS);
    plant.keepFresh();
    await plant.start();
    const values = { 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 }; // sets constant values, so that no reading changes unless a test changes it
    for (const [tag, value] of Object.entries(values))
        await plant.tell(`set ${tag} ${value}`);
    for (let read = []; read.length === 0 || read.some(({ name, value }) => value !== values[name]); await sleep(20))
        ({ tags: read } = JSON.parse((await get(plant.port, '/api/v1/tags')).body));
});

async function tileOf(wall, display, { port = plant.port, codecs = ['png'], ...more } = {}) {
    const client = await PlainClient.open(port);
    await client.hello({ width: WIDTH, height: HEIGHT, codecs, tile: { wall, display }, ...more });
    client.display = display;
    return client;
}
const tilesOf = (wall, count, more) => Promise.all(Array.from({ length: count }, (_, i) => tileOf(wall, i + 1, more)));
const close = (clients) => clients.forEach((client) => client.close());
const presents = (client) => client.texts.filter(({ type }) => type === 'present');
const tilesSaid = (client) => client.texts.filter(({ type }) => type === 'tiles').at(-1);
const leaderOf = (clients) => clients[0].until('one that leads', () => clients.find((client) => tilesSaid(client)?.leads));
const camera = (seq, turn) =>
    ({ type: 'camera', seq, eye: [1.5 + 6 * Math.sin(turn), -6 * Math.cos(turn), 3], target: [1.5, 0, 0], up: [0, 0, 1], fov: 40 });

function canvasAt(client, seq) {
    const canvas = new Canvas(), frames = client.frames.filter((one) => one.seq <= seq);
    for (const frame of frames.slice(frames.findLastIndex(({ flags, x, y }) => flags & KEY && x === 0 && y === 0)))
        canvas.draw(frame);
    return canvas;
}

// Returns, for each client, the message { seq, at_us } that tells it to show a picture; the picture is the newest one that all
// clients were told to show.
const picture = (clients) => clients[0].until('a picture that all show', () => {
    const common = presents(clients[0]).reverse().find(({ picture: number }) => clients.every((client) =>
        presents(client).some((one) => one.picture === number)));
    return common && clients.map((client) => presents(client).find((one) => one.picture === common.picture));
});

// Moves the leader's camera until isEnough(), then waits until all clients were told to show the last camera's refined picture.
// Returns how long the camera moved in milliseconds.
async function moveAll(clients, leader, isEnough) {
    const began = performance.now();
    let seq = 0;
    await until('enough pictures', async () => {
        for (let i = 0; i < 10; i++) {
            leader.say(camera(++seq, seq / 50));
            await sleep(33);
        }
        return isEnough();
    }, 60);
    const took = performance.now() - began;
    const isLast = (client) => client.frames.some((frame) => frame.seq === presents(client).at(-1)?.seq && frame.flags & STILL &&
        Math.abs(frame.eye[0] - camera(0, seq / 50).eye[0]) < 1e-3);
    for (const client of clients)
        await client.until('the refined picture', isLast);
    return took;
}

// Moves a client's camera step by step until a frame arrives that satisfies wanted(); still: a refined frame, otherwise a
// preview. Returns the frame's and the camera's sequence numbers.
async function moveUntil(client, wanted, still) {
    for (let seq = 1; seq < 200; seq++) {
        client.say(camera(seq, 0.3));
        const good = (frame) => !(frame.flags & MORE) && Boolean(frame.flags & STILL) === still && wanted(frame);
        const end = performance.now() + (still ? 60000 : 500);
        while (performance.now() < end) {
            const found = client.frames.find((frame) => frame.camera_seq === seq && good(frame));
            if (found)
                return found.seq;
            await sleep(20);
        }
    }
    throw new Error('no such picture');
}

// Returns the picture of a single client that has the size of all tiles together, as the reference.
async function whole(width, height, still) {
    const client = await PlainClient.open(plant.port);
    await client.hello({ width, height, codecs: ['png'] });
    await client.frameWhere('a first picture', () => true);
    const seq = await moveUntil(client, (frame) => frame.full_width === width, still);
    const canvas = canvasAt(client, seq);
    client.close();
    return canvas;
}

// To prevent burn-in, all tiles are shifted together within a picture that is larger by MARGIN on each side. The shift depends
// only on the clock.
const MARGIN = 3, shiftNow = () => burnShift(Date.now() * 1000), margins = (size) => size + 2 * MARGIN;

// Returns the shift of newly started pictures; waits if one with the previous shift may still be under way.
async function shiftHeld() {
    const HELD_MS = 180000, SETTLED_MS = 3000, sinceMove = Date.now() % HELD_MS;
    await sleep(Math.max(0, SETTLED_MS - sinceMove));
    return shiftNow();
}

// Compares the tiles of a wall with the picture of a single client, pixel by pixel: a preview, then a refined frame. Meanwhile
// readings and burn-in shift must not change; on a loaded machine smaller previews are skipped.
async function compare(wall, columns, rows, [across, down]) {
    const width = columns * WIDTH + (columns - 1) * across, height = rows * HEIGHT + (rows - 1) * down;
    for (const still of [false, true]) {
        const shift = await shiftHeld(), clients = await tilesOf(wall, columns * rows), leader = await leaderOf(clients);
        await picture(clients);
        const told = (frame) => presents(leader).find(({ seq }) => seq === frame.seq);
        const all = (frame) => told(frame) && clients.map((client) => presents(client).find((one) => one.picture === told(frame).picture));
        const seq = await moveUntil(leader, (frame) => frame.full_width === WIDTH && all(frame)?.every(Boolean), still);
        const shown = all({ seq });
        const canvases = clients.map((client, i) => canvasAt(client, shown[i].seq));
        assert.equal(new Set(shown.map(({ at_us: us }) => us)).size, 1);
        close(clients);
        if (`${shiftNow()}` !== `${shift}`)
            return compare(wall, columns, rows, [across, down]);
        const large = await whole(margins(width), margins(height), still);
        for (const [i, tile] of canvases.entries()) {
            const x = MARGIN - shift[0] + (i % columns) * (WIDTH + across);
            const y = MARGIN - shift[1] + Math.floor(i / columns) * (HEIGHT + down);
            assert.deepEqual([tile.width, tile.height], [WIDTH, HEIGHT]);
            assert.equal(tile.differsFrom(large, x, y), 0, `display ${i + 1} of ${wall}, ${still ? 'refined' : 'preview'}`);
        }
        const colours = new Set(Array.from({ length: large.rgb.length / 3 }, (_, i) => large.rgb.readUIntBE(3 * i, 3)));
        assert.ok(colours.size > 100, `only ${colours.size} colours to compare`);
    }
    return undefined;
}

// runs only in make test-long: when other programs were running, a preview differed once, for an unknown reason
test('six tiles equal the large picture, pixel by pixel, preview and refined', { ...options, skip: options.skip || long },
    () => compare('seamless', 3, 2, [0, 0]));
test('the picture continues behind the bezels', options, async () => {
    assert.ok(BEZEL[0] > 20 && BEZEL[1] > 10);
    await compare('framed', 2, 2, BEZEL);
});

test('every 3 minutes all tiles shift at the same instant', { ...options, timeout: 400000,
    skip: options.skip || (process.env.PLANTCAST_LONG === '1' ? false : 'PLANTCAST_LONG=1') }, async () => {
    const clients = await tilesOf('seamless', 6), leader = await leaderOf(clients);
    const refined = () => presents(leader).some(({ seq }) => leader.frames.find((frame) => frame.seq === seq)?.flags & STILL);
    await leader.until('a refined picture', refined, 60000);
    await sleep(2000);
    const before = presents(leader).at(-1), shift = shiftNow(), drawn = await metric('plantcast_renders_total');
    const canvases = clients.map((client) => canvasAt(client, presents(client).at(-1).seq));
    await leader.until('the next move', () => `${shiftNow()}` !== `${shift}`, 190000);
    await leader.until('another picture, by all', () => clients.every((client) => presents(client).at(-1).picture > before.picture));
    const shown = await picture(clients), [x, y] = shiftNow();
    assert.equal(new Set(shown.map(({ at_us: us }) => us)).size, 1);
    assert.ok(shown[0].at_us % 180e6 < 5e6, `the shift is ${shown[0].at_us % 180e6 / 1e6} s after the full 3 minutes`);
    const more = await metric('plantcast_renders_total') - drawn;
    // pictures drawn for the shift of all tiles; drawing each tile in each step of the shift would take more
    assert.ok(more <= 6, `${more} pictures were drawn`);
    // Compares each tile's new picture with its old one, moved by the shift; leaves out a rim of 8 pixels, which may have been
    // outside the tile.
    for (const [i, client] of clients.entries()) {
        const now = canvasAt(client, shown[i].seq), was = canvases[i], edge = 8, bytes = (WIDTH - 2 * edge) * 3;
        for (let row = edge; row < HEIGHT - edge; row++) {
            const at = (row * WIDTH + edge) * 3, then = ((row + shift[1] - y) * WIDTH + edge + shift[0] - x) * 3;
            assert.equal(now.rgb.compare(was.rgb, then, then + bytes, at, at + bytes), 0,
                `display ${i + 1}, row ${row} differs from the old picture`);
        }
    }
    close(clients);
});

const metric = async (name) => Number((await get(plant.port, '/metrics')).body.toString().match(new RegExp(`^${name} (\\S+)`, 'm'))[1]);

test('a moving picture is drawn once for all tiles, and all tiles show it at the same instant', options, async (t) => {
    const clients = await tilesOf('seamless', 6, { codecs: ['jpeg'] }), leader = await leaderOf(clients);
    await picture(clients);
    const before = await metric('plantcast_renders_total'), first = presents(leader).at(-1).picture;
    const shown = () => presents(leader).map((one) => one.picture).filter((number) => number > first);
    promise(t, 'until 21 pictures', await moveAll(clients, leader, () => shown().length > 20), 4000);
    const drawn = await metric('plantcast_renders_total') - before, numbers = shown();
    assert.ok(drawn <= numbers.length + 8, `${drawn} pictures drawn, ${numbers.length} shown`);
    for (const number of numbers) {
        const all = clients.map((client) => presents(client).find((one) => one.picture === number));
        assert.ok(all.every(Boolean), `all tiles show picture ${number}`);
        assert.equal(new Set(all.map(({ at_us: us }) => us)).size, 1);
        for (const [i, client] of clients.entries())
            assert.ok(client.frames.some((frame) => frame.seq === all[i].seq), 'a tile is told only of frames that it has');
        const sizes = new Set(all.map(({ seq }, i) => clients[i].frames.find((frame) => frame.seq === seq).full_width));
        assert.equal(sizes.size, 1, 'all tiles show the same quality');
    }
    close(clients);
});

test('a lost tile is named, and the others continue; the lead passes on with its view', options, async () => {
    const clients = await tilesOf('seamless', 6, { codecs: ['jpeg'] }), leader = await leaderOf(clients);
    leader.say(camera(5, 2));
    await leader.until('its camera', () => presents(leader).some(({ seq }) => leader.frames.some((frame) => frame.seq === seq &&
        frame.camera_seq === 5)));
    await picture(clients);
    const rest = clients.filter((client) => client !== leader);
    leader.close();
    const next = await rest[0].until('another that leads', () => rest.find((client) => tilesSaid(client)?.leads));
    for (const client of rest)
        await client.until('the one that is missing', () => tilesSaid(client)?.missing.join() === String(leader.display));
    const before = presents(next).at(-1).picture, eye = camera(0, 2).eye;
    next.say({ type: 'params', seq: 1, look: 'flat' });
    const shown = await rest[0].until('a picture of those left', () =>
        rest.every((client) => presents(client).at(-1).picture > before) && presents(next).at(-1));
    const frame = next.frames.find(({ seq }) => seq === shown.seq);
    for (let i = 0; i < 3; i++)
        assert.ok(Math.abs(frame.eye[i] - eye[i]) < 1e-3, `the view stays at ${eye}, not ${frame.eye}`);
    const back = await tileOf('seamless', leader.display, { codecs: ['jpeg'] });
    await picture([...rest, back]);
    await next.until('nobody missing', () => tilesSaid(next).missing.length === 0);
    close([...rest, back]);
});

test('one tile\'s slow link slows all tiles equally', { ...options, skip: options.skip || (relayMissing() ?? false) }, async (t) => {
    const relay = await Relay.open(plant.port, { bytesPerS: 60000, delayMs: 20 });
    const clients = [...await tilesOf('framed', 3, { codecs: ['jpeg'] })];
    clients.push(await tileOf('framed', 4, { codecs: ['jpeg'], port: relay.port }));
    const leader = await leaderOf(clients);
    await picture(clients);
    const pictures = () => clients.map((client) => presents(client).map((one) => one.picture)), first = pictures()[3][0];
    const took = await moveAll(clients, leader, () => pictures().every((set) => set.filter((n) => n > first).length > 10));
    promise(t, 'until 11 pictures', took, 6000);
    const sets = pictures(), shared = sets[0].filter((n) => n > sets[3][0]);
    for (const set of sets)
        assert.deepEqual(set.filter((n) => n > sets[3][0]), shared, 'no tile shows a picture that another does not');
    close(clients);
    relay.close();
});

test('a tile that reads nothing is left out and notified, and can return', options, async () => {
    const clients = await tilesOf('framed', 3, { codecs: ['jpeg'] }), stuck = await tileOf('framed', 4, { codecs: ['jpeg'] });
    await picture([...clients, stuck]);
    stuck.acknowledge = false;
    const leader = await leaderOf([...clients, stuck]), number = presents(leader).at(-1).picture;
    const moving = setInterval(() => leader.say(camera(++moving.seq, moving.seq / 50)), 50);
    moving.seq = 100;
    const isLate = (text) => text.type === 'tiles' && text.late.some(({ display }) => display === 4);
    const at = await leader.until('what is late', () => leader.texts.some(isLate) && leader.texts.findIndex(isLate));
    await stuck.until('being told', () => tilesSaid(stuck).late.some(({ display, since_us: us }) => display === 4 && us > 1.6e15));
    // number of the last picture that the tiles were told to show before the stalled display was left out
    const then = leader.texts.slice(0, at).findLast(({ type }) => type === 'present').picture;
    assert.ok(then <= number + 3, 'no picture is shown without the stalled tile until that tile is left out');
    await leader.until('pictures of the others', () => presents(leader).at(-1).picture > then + 5);
    assert.ok(presents(stuck).at(-1).picture <= then);
    stuck.acknowledge = true;
    stuck.say({ type: 'ack', seq: stuck.frames.at(-1).seq });
    await stuck.until('it takes part again', () => tilesSaid(leader).late.length === 0 && presents(stuck).at(-1).picture > then + 5);
    clearInterval(moving);
    close([...clients, stuck]);
});

test('an invalid tile is refused by name', options, async () => {
    for (const [tile, text] of [[{ wall: 'nowhere', display: 1 }, /unknown wall/], [{ wall: 'seamless', display: 7 }, /no such display/],
        [{ wall: 'framed', display: 5 }, /display 5 of wall framed is not one of its tiles/]]) {
        const client = await PlainClient.open(plant.port);
        client.say({ type: 'hello', width: WIDTH, height: HEIGHT, codecs: ['png'], tile });
        assert.match((await client.text('error')).text, text);
        client.close();
    }
    const client = await PlainClient.open(plant.port);
    client.say({ type: 'hello', width: 4096, height: 2160, codecs: ['jpeg'], tile: { wall: 'seamless', display: 1 } });
    await client.frameWhere('a smaller picture', ({ full_width: width, flags }) => width > 1000 && flags & KEY);
    assert.ok(client.frames[0].flags & KEY);
    const widest = Math.max(...client.frames.map(({ full_width: width }) => width));
    assert.ok(widest <= 2730, `the tile has ${widest} pixels in width: three tiles exceed the limit`);
    // Reloads the plant three times. Returns the tile's part of the large picture before and after, as JSON text. If the
    // burn-in shift, which also moves that part, changed meanwhile, starts over.
    const reloaded = async () => {
        const part = () => JSON.stringify(tilesSaid(client).part), shift = await shiftHeld(), before = part(), said = client.texts.length;
        for (let i = 0; i < 3; i++) {
            const welcomes = client.texts.filter(({ type }) => type === 'welcome').length;
            plant.daemon.child.kill('SIGHUP');
            await client.until('another plant', () => client.texts.filter(({ type }) => type === 'welcome').length > welcomes);
        }
        await client.until('its place again', () => client.texts.slice(said).some(({ type }) => type === 'tiles'));
        return `${shiftNow()}` === `${shift}` ? [before, part()] : reloaded();
    };
    const [before, after_] = await reloaded();
    assert.equal(after_, before, 'the picture is laid out by its display, not by the last request');
    client.close();
});
