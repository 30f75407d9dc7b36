// SPDX-License-Identifier: GPL-3.0-or-later
// Decoding of depth grids, and drawing a picture as seen by another camera with the mesh that a grid gives. The test scene is a
// floor and a box in front of a background.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { mock, test } from 'node:test';
import { deflateRawSync } from 'node:zlib';
import { PICTURE } from '../../clients/web/app/picture/painters/gl_painter.js';
import { hasViewportShape, Warp } from '../../clients/web/app/picture/warp.js';
import { ClipGizmo } from '../../clients/web/app/views/clip_gizmo.js';
import { Arrows } from '../../clients/web/app/viewport/arrows.js';
import { Isolines } from '../../clients/web/app/viewport/isolines.js';
import { projector } from '../../clients/web/core/camera.js';
import { sight } from '../../clients/web/core/camera_moves.js';
import { decodeGrid, fitPicture, readHeader } from '../../clients/web/core/depth_grid.js';
import { Gestures } from '../../clients/web/core/gestures.js';
import { along } from '../../clients/web/core/vector.js';
import { depthAt, FAR, FLOATS, goneAfter, isNear, meshOf, moveBy, NEAR, warpMatrix } from '../../clients/web/core/warp_mesh.js';
import { Layers, Raster } from '../../clients/web/core/warp_raster.js';
import { mockTimeouts } from './older_node.mjs';

const WIDTH = 400, HEIGHT = 240, CELL = 8, SIDE = 4, LEVELS = 4095;
const PERSPECTIVE = { eye: [6, -9, 5], target: [0, 0, 0.5], up: [0, 0, 1], fov: 45 };
const PARALLEL = { ...PERSPECTIVE, fov: 0, height_m: 8 };
const BOX = { min: [-1, -1, 0], max: [1, 1, 2] }, FLOOR = 4; // FLOOR: half the side of the floor, metres

// Returns what the camera sees at a pixel: { z: distance along the view direction, name: surface (floor or side of the box),
// point }, or null for the background.
function hit(camera, x, y) {
    const { origin, direction } = sight(camera, x, y, WIDTH, HEIGHT);
    let best = null;
    const offer = (t, name, point) => {
        if (t > 1e-6 && (best === null || t < best.z))
            best = { z: t, name, point };
    };
    const floor = -origin[2] / direction[2], at = along(origin, direction, floor);
    if (Math.abs(at[0]) <= FLOOR && Math.abs(at[1]) <= FLOOR)
        offer(floor, 'floor', at);
    for (const i of [0, 1, 2])
        for (const side of ['min', 'max']) {
            const t = (BOX[side][i] - origin[i]) / direction[i], p = along(origin, direction, t);
            if ([0, 1, 2].every((j) => j === i || (p[j] >= BOX.min[j] && p[j] <= BOX.max[j])))
                offer(t, `box ${i} ${side}`, p);
        }
    return best;
}

// A mask's bits are stored as differences from a prediction made from neighbouring bits. Returns these differences for one
// cell, bit by bit from the definition in PROTOCOL.md.
function unexpected(cell, { columns, near, far, masks }) {
    const at = (x, y) => { // x, y: position of the bit, counted from the cell's top left corner
        const [dx, dy] = [x, y].map((v) => Math.floor(v / SIDE)), other = cell + dx + dy * columns;
        if (other < 0 || cell % columns + dx < 0)
            return false;
        const distance = (code) => Math.abs(near[other] - code);
        return far[other] >= 0 ? masks[other][(y - dy * SIDE) * SIDE + x - dx * SIDE] : distance(near[cell]) < distance(far[cell]);
    };
    return masks[cell].map((bit, i) => {
        const x = i % SIDE, y = Math.floor(i / SIDE), left = at(x - 1, y), up = at(x, y - 1);
        return bit !== (left === up ? left : !(i === 0 ? left : at(x - 1, y - 1)));
    });
}

// Encodes the depths that the camera sees as PROTOCOL.md describes. A cell of pixels is divided into near and far where it
// shows the box and also something else.
function encode(camera) {
    const parallel = camera.height_m !== undefined, columns = Math.ceil(WIDTH / CELL), rows = Math.ceil(HEIGHT / CELL);
    const depth = (at) => (parallel ? at.z : 1 / at.z), all = [];
    for (let y = 0; y < HEIGHT; y++)
        for (let x = 0; x < WIDTH; x++)
            all.push(hit(camera, x + 0.5, y + 0.5));
    const depths = all.filter(Boolean).map(depth), low = Math.min(...depths), high = Math.max(...depths);
    const [base, last] = parallel ? [high, low] : [low, high], unit = (last - base) / (LEVELS - 1);
    const code = (at) => (at === null ? 0 : Math.round((depth(at) - base) / unit) + 1);
    const near = [], far = [], masks = [];
    for (let row = 0; row < rows; row++)
        for (let column = 0; column < columns; column++) {
            const pixels = [];
            for (let y = 0; y < CELL; y++)
                for (let x = 0; x < CELL; x++)
                    pixels.push({ x, y, at: all[(row * CELL + y) * WIDTH + column * CELL + x] });
            const kind = ({ at }) => (at === null ? 0 : at.name === 'floor' ? 1 : 2), most = Math.max(...pixels.map(kind));
            const front = pixels.filter((p) => kind(p) === most), back = pixels.filter((p) => kind(p) < most);
            const mean = (some) => Math.round(some.reduce((sum, { at }) => sum + code(at), 0) / some.length);
            const [n, f] = [mean(front), back.length > 0 ? mean(back.filter((p) => kind(p) === Math.max(...back.map(kind)))) : -1];
            near.push(n);
            far.push(f < n ? f : -1);
            const bit = CELL / SIDE, mask = Array(SIDE * SIDE).fill(0);
            front.forEach(({ x, y }) => { mask[Math.floor(y / bit) * SIDE + Math.floor(x / bit)]++; });
            masks.push(mask.map((count) => count > bit * bit / 2));
        }
    const bits = (flags) => flags.reduce((bytes, flag, i) => {
        bytes[i >> 3] |= flag << (i & 7);
        return bytes;
    }, new Uint8Array(Math.ceil(flags.length / 8)));
    const out = [...bits(far.map((f) => f >= 0))];
    const symbol = (value, prediction) => {
        const d = value - prediction, s = d >= 0 ? 2 * d : -2 * d - 1;
        out.push(...(s < 255 ? [s] : [255, value & 255, value >> 8]));
    };
    const back = near.map((value, i) => (far[i] >= 0 ? far[i] : value)), middle = (...codes) => codes.sort((a, b) => a - b)[1];
    const beside = (codes, i) => [i % columns ? codes[i - 1] : 0, codes[i - columns] ?? 0, i % columns ? codes[i - columns - 1] ?? 0 : 0];
    back.forEach((value, i) => {
        const [left, up, corner] = beside(back, i);
        symbol(value, left && up && corner ? middle(left, up, left + up - corner) : left || up);
    });
    far.forEach((value, i) => value >= 0 && symbol(near[i], beside(near, i).find((code) => code > value) ?? value));
    far.forEach((value, i) => value >= 0 && out.push(...bits(unexpected(i, { columns, near, far, masks }))));
    return { bytes: packed(Uint8Array.from(out), { parallel, columns, rows, base, unit }), near, far, all };
}

function packed(data, { parallel, columns, rows, base, unit, width = WIDTH }) {
    const payload = deflateRawSync(data), bytes = new Uint8Array(44 + payload.length), view = new DataView(bytes.buffer);
    bytes.set([2, 2, parallel ? 1 : 0, 0]);
    view.setUint32(4, payload.length, true);
    view.setUint32(8, 7, true);
    [0, 0, width, HEIGHT, width, HEIGHT, columns, rows].forEach((value, i) => view.setUint16(12 + 2 * i, value, true));
    bytes.set([CELL, SIDE], 28);
    view.setUint16(30, LEVELS, true);
    view.setFloat32(32, base, true);
    view.setFloat32(36, unit, true);
    view.setUint32(40, data.length, true);
    bytes.set(payload, 44);
    return bytes;
}

for (const [name, camera] of [['perspective', PERSPECTIVE], ['orthographic', PARALLEL]]) {
    test(`a depth grid is decoded as it was encoded: ${name}`, async () => {
        const { bytes, near, far, all } = encode(camera), grid = await decodeGrid(bytes);
        assert.deepEqual([...grid.near], near);
        assert.deepEqual([...grid.far], far);
        assert.ok(far.some((code) => code >= 0), 'some cells of the grid are divided');
        let off = 0;
        for (let i = 0; i < all.length; i++) {
            const depth = depthAt(grid, i % WIDTH + 0.5, Math.floor(i / WIDTH) + 0.5);
            off += all[i] !== null && Math.abs((grid.parallel ? depth : 1 / depth) - all[i].z) > 0.3 ? 1 : 0;
        }
        assert.ok(off < 0.03 * all.length, `${off} pixels differ from the encoded depth`);
        assert.equal(depthAt(grid, WIDTH + 9, 5), null);
    });

    test(`a point of the picture moves to its position in the new camera: ${name}`, async () => {
        const grid = await decodeGrid(encode(camera).bytes), to = { ...camera, eye: [6.5, -8.6, 5.2], target: [0.2, 0, 0.4] };
        const matrix = warpMatrix(grid, camera, to, 0.1), project = projector(to, WIDTH, HEIGHT);
        for (const [x, y] of [[150.5, 150.5], [200.5, 120.5], [210.5, 180.5]]) {
            const { z, point } = hit(camera, x, y), [px, py] = moveBy(matrix, grid, [x, y, grid.parallel ? z : 1 / z]);
            const [wantX, wantY] = project(point);
            assert.ok(Math.hypot(px - wantX, py - wantY) < 1e-3, `${px}, ${py} instead of ${wantX}, ${wantY}`);
        }
        const same = warpMatrix(grid, camera, camera, 0.1);
        assert.ok(Math.hypot(...moveBy(same, grid, [30, 40, depthAt(grid, 30, 40)]).map((v, i) => v - [30, 40][i])) < 1e-3);
    });

    test(`the mesh lies on the surfaces, and is cut between them: ${name}`, async () => {
        const grid = await decodeGrid(encode(camera).bytes), { vertices, indices, count } = meshOf(grid, camera);
        assert.ok(count < grid.near.length, `${count} quads for ${grid.near.length} cells: planes are merged`);
        assert.equal(indices.length, 6 * count);
        assert.ok(vertices.every(Number.isFinite));
        const covered = new Float32Array(WIDTH * HEIGHT), kinds = new Set();
        let off = 0, checked = 0;
        for (let q = 0; q < count; q++) {
            const corner = (n) => [...vertices.subarray((4 * q + n) * FLOATS, (4 * q + n + 1) * FLOATS)];
            const [a, b, c, d] = [0, 1, 2, 3].map(corner), kind = a[3];
            kinds.add(kind);
            for (let y = Math.ceil(a[1]); y + 0.5 < d[1]; y++)
                for (let x = Math.ceil(a[0]); x + 0.5 < d[0]; x++) {
                    const u = (x + 0.5 - a[0]) / (d[0] - a[0]), v = (y + 0.5 - a[1]) / (d[1] - a[1]);
                    const depth = (1 - v) * ((1 - u) * a[2] + u * b[2]) + v * ((1 - u) * c[2] + u * d[2]);
                    const isNearPixel = grid.masks[Math.floor(y / 2) * grid.columns * SIDE + Math.floor(x / 2)] > 0;
                    if ((kind === NEAR && !isNearPixel) || (kind === FAR && isNearPixel))
                        continue;
                    covered[y * WIDTH + x]++;
                    const truth = hit(camera, x + 0.5, y + 0.5);
                    if (!truth)
                        continue;
                    checked++;
                    off += Math.abs((grid.parallel ? depth : 1 / depth) - truth.z) > 0.02 * truth.z ? 1 : 0;
                }
        }
        assert.ok(covered.every((times) => times >= 1), 'every pixel is on the mesh');
        assert.deepEqual([...kinds].sort(), [0, NEAR, FAR]);
        assert.ok(off < 0.05 * checked, `${off} of ${checked} pixels lie off their surface`);
    });
}

// colourOf(): colour of the picture's pixel by what it shows (background, floor, a side of the box), a 32-bit number with red
// in the lowest byte. isGrey(): whether a pixel is grey.
const sumOf = (name) => [...name].reduce((sum, letter) => sum + letter.charCodeAt(), 0);
const colourOf = (at) => (at === null ? 0xfff0f0f0 : 0xff000000 + 40 * sumOf(at.name)) | 0;
const isGrey = (pixel) => (pixel & 255) === (pixel >> 8 & 255) && (pixel & 255) === (pixel >> 16 & 255);

// Draws the scene as seen by the camera, warps the picture to the camera `to` by the page's own rasterizer, and leaves areas
// that the picture does not show empty.
async function rasterized(camera, to, size = [WIDTH, HEIGHT], box = { left: 0, top: 0, width: size[0], height: size[1] }) {
    const { bytes, all } = encode(camera), grid = await decodeGrid(bytes), picture = Int32Array.from(all, colourOf);
    const raster = new Raster(...size), layers = new Layers(picture, WIDTH, [grid]);
    raster.draw({ grid, mesh: meshOf(grid, camera) }, warpMatrix(grid, camera, to, 0.1), layers, box);
    return { raster, picture };
}

for (const [name, camera] of [['perspective', PERSPECTIVE], ['orthographic', PARALLEL]]) {
    test(`the processor draws the picture from another camera, true to its surfaces: ${name}`, async () => {
        const same = await rasterized(camera, camera);
        const changed = same.raster.pixels.filter((pixel, i) => pixel !== same.picture[i] && !isGrey(pixel)).length;
        assert.equal(changed, 0, 'from its own camera, the picture is unchanged');
        const to = { ...camera, eye: [6.5, -8.6, 5.2], target: [0.2, 0, 0.4] }, { raster } = await rasterized(camera, to);
        const drawn = raster.pixels.slice();
        let shown = 0, wrong = 0;
        for (let i = 0; i < drawn.length; i++)
            if (!isGrey(drawn[i])) {
                shown++;
                wrong += drawn[i] === colourOf(hit(to, i % WIDTH + 0.5, Math.floor(i / WIDTH) + 0.5)) ? 0 : 1;
            }
        assert.ok(shown > 0.2 * drawn.length && wrong < 0.03 * shown, `${wrong} of ${shown} coloured pixels show another surface`);
        const bare = drawn.filter((pixel) => pixel === 0).length;
        assert.ok(bare > 0 && bare < 0.2 * drawn.length, `${bare} pixels are not drawn`);
        raster.fillUndrawn(14);
        assert.ok(drawn.every((pixel, i) => (pixel === 0 ? isGrey(raster.pixels[i]) && raster.pixels[i] < 0 : pixel === raster.pixels[i])),
            'what is not drawn becomes grey and opaque, and nothing else changes');
        raster.leaveOut(0.5);
        assert.equal(raster.pixels.filter((pixel) => pixel === 0).length, drawn.length / 2);
        raster.clear();
        assert.ok(raster.pixels.every((pixel) => pixel === 0));
    });
}

test('the processor draws reduced pictures, and halves of split views only in their half', async () => {
    const half = { left: 100, top: 0, width: 100, height: 120 };
    const { raster } = await rasterized(PERSPECTIVE, { ...PERSPECTIVE, eye: [6.5, -8.6, 5.2] }, [200, 120], half);
    const drawn = (from, to) => raster.pixels.filter((pixel, i) => i % 200 >= from && i % 200 < to && pixel !== 0).length;
    assert.equal(drawn(0, 100), 0);
    assert.ok(drawn(100, 200) > 0.8 * 100 * 120);
    // the camera is so close that the box reaches behind the eye
    const near = await rasterized(PERSPECTIVE, { ...PERSPECTIVE, eye: [1.05, -1.6, 1] });
    assert.ok(near.raster.pixels.some((pixel) => pixel !== 0));
    const lost = await rasterized(PERSPECTIVE, { ...PERSPECTIVE, eye: [NaN, 0, 0] });
    assert.ok(lost.raster.pixels.every((pixel) => pixel === 0), 'an invalid camera sees nothing');
    lost.raster.fillUndrawn(NaN);
    assert.ok(lost.raster.pixels.every((pixel) => pixel === lost.raster.pixels[0] && isGrey(pixel)));
});

test('an invalid depth grid is refused, whatever its content', async () => {
    const { bytes } = encode(PERSPECTIVE), changed = (f) => {
        const copy = bytes.slice();
        f(copy, new DataView(copy.buffer));
        return copy;
    };
    const wrong = {
        short: bytes.slice(0, 40), 'cut off': bytes.slice(0, -5), encoding: changed((b) => { b[1] = 9; }),
        'no cells': changed((_, v) => v.setUint16(24, 0, true)), 'another size': changed((_, v) => v.setUint16(16, 64, true)),
        'mask of 3': changed((b) => { b[29] = 3; }), 'cell of 0': changed((b) => { b[28] = 0; }),
        'NaN base': changed((_, v) => v.setFloat32(32, NaN, true)), 'infinite unit': changed((_, v) => v.setFloat32(36, Infinity, true)),
        'unit of 0': changed((_, v) => v.setFloat32(36, 0, true)), 'negative base': changed((_, v) => v.setFloat32(32, -1, true)),
        levels: changed((_, v) => v.setUint16(30, 5000, true)), 'fewer levels than codes': changed((_, v) => v.setUint16(30, 3, true)),
        'more bytes than stated': changed((_, v) => v.setUint32(40, 9, true)),
        'fewer than stated': changed((_, v) => v.setUint32(40, 1e6, true)),
        'beyond memory': changed((_, v) => v.setUint32(40, 0xffffffff, true)), noise: changed((b) => b.fill(0x5a, 44)),
        orthographic: changed((b) => { b[2] = 1; }),
    };
    for (const [name, data] of Object.entries(wrong))
        await assert.rejects(decodeGrid(data), undefined, name);
    assert.equal(readHeader(bytes).seq, 7);
});

test('depth grids of another size, projection or half do not fit a picture', () => {
    const frame = { camera: PERSPECTIVE, fullWidth: 641, fullHeight: 360 };
    const whole = { x: 0, y: 0, width: 641, height: 360, fullWidth: 641, fullHeight: 360, parallel: false };
    const left = { ...whole, width: 320 }, right = { ...whole, x: 320, width: 321 };
    const orthographic = { ...frame, camera: { ...PERSPECTIVE, fov: 0, height_m: 8 } };
    for (const grids of [[whole], [left, right]])
        assert.equal(fitPicture(grids, frame), true);
    assert.equal(fitPicture([{ ...whole, parallel: true }], orthographic), true);
    for (const grids of [[], [left], [right], [right, left], [left, whole], [left, left, right], [whole, right],
        [{ ...whole, parallel: true }], [left, { ...right, parallel: true }], [{ ...whole, fullWidth: 640 }],
        [{ ...whole, fullHeight: 361 }], [{ ...whole, y: 1, height: 359 }]])
        assert.equal(fitPicture(grids, frame), false, JSON.stringify(grids));
    assert.equal(fitPicture([whole], orthographic), false);
});

test('after a jump or a change of projection, the camera gets no warped picture', () => {
    const turned = { ...PERSPECTIVE, eye: [-6, -9, 5] };
    assert.ok(isNear(PERSPECTIVE, { ...PERSPECTIVE, eye: [6.3, -8.7, 5] }));
    assert.ok(!isNear(PERSPECTIVE, turned));
    assert.ok(!isNear(PERSPECTIVE, PARALLEL));
    assert.ok(!isNear(PARALLEL, { ...PARALLEL, height_m: 80 }));
    assert.ok(isNear(PARALLEL, { ...PARALLEL, height_m: 7 }));
});

test('a picture drawn with fewer pixels keeps its exact shape', () => {
    const canvas = { width: 1, height: 1, style: {} }, painter = { resize: (width, height) => Object.assign(canvas, { width, height }) };
    const warp = Object.assign(Object.create(Warp.prototype), { canvas, painter, intervals: [], last: 0, mostPx: 10000 });
    warp.fit({ fullWidth: 322, fullHeight: 178 });
    assert.deepEqual([canvas.width, canvas.height, canvas.style.aspectRatio], [134, 74, '322 / 178']);
});

test('a reduced picture has the shape of the viewport despite rounding its sides', () => {
    const shape = (fullWidth, fullHeight) => hasViewportShape({ fullWidth, fullHeight, shownWidth: fullHeight * 1280 / 720 });
    assert.ok(shape(1280, 720) && shape(448, 250) && shape(448, 252) && shape(446, 252));
    assert.ok(!shape(640, 352) && !shape(512, 360));
});

test('pictures wait for their depth, but not for a worker that does not answer', () => {
    let now = 0, draws = 0;
    mockTimeouts();
    const { mock: calls } = mock.method(performance, 'now', () => now);
    const viewport = { invalidate: () => draws++ };
    const warp = Object.assign(Object.create(Warp.prototype), { isShown: true, waitsFrom: null, viewport, grids: [] });
    const waits = (ms, id) => {
        now += ms;
        mock.timers.tick(ms);
        const depth = warp.grids[id]?.depth ?? {};
        warp.grids[id] ??= { id, depth, parts: null, fails: false };
        return warp.waits([{ frame: { depth } }]);
    };
    try {
        assert.deepEqual([waits(0, 0), waits(900, 0), draws], [true, true, 0]);
        assert.deepEqual([waits(200, 0), draws], [false, 1], 'a picture whose depth is late is drawn without it');
        assert.equal(waits(0, 1), false, 'the worker still owes an answer');
        warp.take({ id: 0, parts: [] });
        assert.deepEqual([waits(0, 1), waits(0, 0), waits(900, 1), waits(200, 1)], [true, false, true, false]);
        Object.assign(warp, { isShown: false, session: { cameraNews: false, cameraSeq: 1, picture: { cameraSeq: 1 } } });
        warp.take({ id: 1, parts: [] });
        assert.ok(waits(0, 2), 'a still view waits for the depth, because the next move is drawn from it');
        warp.take({ id: 2, parts: [] });
        const before = draws;
        assert.deepEqual([waits(0, 2), waits(5000, 2), draws], [false, false, before], 'a still view leaves no timer');
    } finally {
        calls.restore();
        mock.timers.reset();
    }
});

test('a page that draws slowly sends some twelve cameras a second while the warped picture is shown, and the last one', async () => {
    const viewport = { frames: 0, invalidate() { this.frames++; } }, session = { cameraNews: true };
    const warp = Object.create(Warp.prototype, { isWanted: { value: true, writable: true } });
    Object.assign(warp, { session, viewport, isShown: true, mostPx: 250000, sentAt: -Infinity });
    const sent = [];
    for (let now = 1000; now < 2000; now += 16)
        if (!warp.holdsCamera(now))
            sent.push(now);
    assert.ok(sent.length >= 12 && sent.length <= 13, `${sent.length} cameras in a second`);
    assert.equal(sent[0], 1000, 'the first one is not delayed');
    const last = sent.at(-1) + 79;
    assert.equal(warp.holdsCamera(last), true);
    assert.equal(viewport.frames, 0);
    await new Promise((done) => { viewport.invalidate = done; }); // a frame is drawn for the last camera although nothing moves
    assert.equal(warp.holdsCamera(last + 1), false);
    for (const change of [{ mostPx: Infinity }, { isShown: false }, { isWanted: false }, { session: { cameraNews: false } }])
        assert.equal(Object.assign(Object.create(warp), change, { sentAt: last }).holdsCamera(last + 1), false, Object.keys(change)[0]);
});

// Returns an object with the members of Warp that decide whether a picture is warped: a picture of 1280x720 whose camera the user
// has moved a little. in the session, fly: the camera's flight, or null.
function ahead({ fly = null, source = { camera: PERSPECTIVE }, ...session } = {}) {
    const picture = { cameraSeq: 1, shownWidth: 1280, fullWidth: 1280, fullHeight: 720 };
    const camera = { ...PERSPECTIVE, eye: [6.3, -8.7, 5] };
    return Object.assign(Object.create(Warp.prototype), { source, modules: { there: () => ({ fly }) },
        session: { picture, camera, cameraSeq: 2, cameraNews: null, leader: null, lent: false, ...session } });
}

test('only a picture that lags behind the user\'s own camera is warped: no flight, no followed view, no jump, no other shape', () => {
    const { picture } = ahead().session, sharp = { ...picture, fullWidth: 2560, fullHeight: 1440, shownWidth: 2560 };
    for (const warped of [{}, { picture: sharp }, { picture: { ...picture, cameraSeq: 2 }, cameraNews: {} }])
        assert.equal(ahead(warped).isWanted, true, JSON.stringify(warped));
    for (const plain of [{ leader: 7 }, { lent: true }, { fly: {} }, { source: null }, { camera: { ...PERSPECTIVE, eye: [-6, -9, 5] } },
        { camera: PARALLEL }, { picture: { ...picture, cameraSeq: 2 } }, { picture: { ...picture, shownWidth: 960 } }])
        assert.equal(ahead(plain).isWanted, false, JSON.stringify(plain));
});

test('after a movement, the server\'s picture of the same camera replaces the warped one in 80 ms', () => {
    assert.deepEqual([0, 40, 79, 80, 500].map(goneAfter), [0, 0.5, 79 / 80, 1, 1]);
    const canvas = { style: { display: '' } }, painted = { picture: {}, seenFrom: PERSPECTIVE }, steps = [];
    let frames = 0;
    const picture = { ...ahead().session.picture, camera: PERSPECTIVE, cameraSeq: 2, moved: () => null };
    const warp = Object.assign(ahead({ picture }), { canvas, isShown: true, held: null, painted, loaded: painted, grids: [],
        fadeStart: null, viewport: { invalidate: () => frames++ }, paint: (camera, source, gone) => steps.push([camera, source, gone]) });
    warp.draw(1000);
    warp.draw(1040);
    assert.equal(frames, 2, 'each step asks for the next frame');
    assert.deepEqual(steps, [[PERSPECTIVE, painted, 0], [PERSPECTIVE, painted, 0.5]]);
    assert.deepEqual([picture.moved, canvas.style.display], [null, ''], 'markers are at their places in the server\'s picture');
    assert.deepEqual([warp.draw(1080), warp.isShown, canvas.style.display, steps.length, frames], [true, false, 'none', 2, 2]);
    Object.assign(warp, { isShown: true });
    warp.draw(2000);
    assert.equal(steps.at(-1)[2], 0, 'the next movement ends with a fade of its own');
    warp.session.cameraSeq = 3;
    assert.deepEqual([warp.draw(2040), warp.isShown], [true, false], 'no fade while the camera moves');
});

test('a picture is loaded before the camera moves only while a pointer is pressed or a mouse has just moved over it', () => {
    let now = 100000;
    const { mock: calls } = mock.method(performance, 'now', () => now), loaded = [], gestures = new Gestures();
    const session = { ...ahead().session, cameraSeq: 1 }, canvas = { style: {} };
    const warp = Object.assign(ahead(session), { canvas, grids: [], held: null, painted: {}, modules: { there: () => ({ gestures }) },
        load: () => loaded.push(now) });
    session.picture.depth = {};
    const draws = () => [warp.draw(), loaded.length];
    try {
        assert.deepEqual(draws(), [false, 0], 'a still view costs nothing');
        assert.deepEqual([gestures.hover(now), gestures.hover(now)], [true, false], 'only the first event starts an animation frame');
        assert.deepEqual(draws(), [false, 1]);
        now += 4999;
        assert.deepEqual(draws(), [false, 2]);
        now += 1;
        assert.deepEqual(draws(), [false, 2], 'the mouse has rested for 5 s');
        gestures.down({ id: 1, x: 0, y: 0 });
        assert.deepEqual(draws(), [false, 3]);
        warp.isShown = true;
        assert.deepEqual(draws(), [true, 4], 'also in the frame that ends a movement');
    } finally {
        calls.restore();
    }
});

test('if a picture comes without depth, or its depth cannot be decoded, the page stops warping', () => {
    for (const grid of [null, { messages: [] }]) {
        const canvas = { style: { display: '' } }, picture = { ...ahead().session.picture, camera: PERSPECTIVE, depth: grid };
        const warp = Object.assign(ahead({ picture }), { canvas, isShown: true, held: null, loaded: {}, painted: {},
            grids: grid ? [{ depth: grid, parts: null, fails: true }] : [] });
        assert.equal(warp.draw(), true, 'the screen changes');
        assert.deepEqual([warp.isShown, warp.source, canvas.style.display, picture.camera], [false, null, 'none', PERSPECTIVE]);
        assert.equal(warp.draw(), false);
    }
});

test('values on contour lines and handles of a section move with a warped picture', () => {
    const moved = (x, y) => (x < 400 ? [x + 30, y - 20] : null);
    const picture = { fullWidth: 800, fullHeight: 600, shownWidth: 800, camera: PERSPECTIVE, moved };
    const written = [], context = { measureText: () => ({ width: 20 }), fillRect() {}, fillText: (...given) => written.push(given) };
    const session = { picture, shown: {}, scaleOf: () => ({ min: 0, max: 100 }), model: {},
        markersOf: () => ({ isolines: [[50, 100, 200], [60, 500, 200]] }) };
    Isolines.prototype.draw.call({ session, overlay: { context, wide: 800, high: 600, setFont() {} } }, []);
    assert.deepEqual(written, [['50', 130, 180.5]], 'a value whose place has left the picture is not written');
    const { get } = Object.getOwnPropertyDescriptor(ClipGizmo.prototype, 'views'), viewport = { width: 800, height: 600 };
    for (const camera of [PERSPECTIVE, { ...PERSPECTIVE, eye: [6.5, -8.6, 5.2] }]) {
        const [{ project }] = get.call({ session: { ...session, picture: { ...picture, camera } }, viewport });
        assert.deepEqual(project([1, 1, 2]), projector(camera, 800, 600)([1, 1, 2]).slice(0, 2));
    }
});

test('arrows and streaks move with a warped picture', () => {
    const moved = (x, y) => (x < 400 ? [x + 30, y - 20] : null), places = [], streaks = [], done = () => {};
    const picture = { fullWidth: 800, fullHeight: 600, shownWidth: 800, moved };
    const context = { save: done, restore: done, rotate: done, translate: (...at) => places.push(at) };
    const rows = [[100, 200, 0, 0, 50, 0, 0, null], [500, 200, 0, 0, 50, 0, 0, null], [200, 300, 1, 0, 50, 0, 0, 7]];
    const session = { picture, shown: {}, rangeOf: () => [0, 100], markersOf: () => ({ arrows: rows }) };
    const arrows = Object.assign(Object.create(Arrows.prototype), { session, overlay: { context, wide: 400, high: 300 }, still: {},
        stroke: done, run: done, explain: done, addToStroke: ({ at }) => streaks.push(at) });
    globalThis.Path2D = class {};
    try {
        arrows.draw();
    } finally {
        delete globalThis.Path2D;
    }
    assert.deepEqual([places, streaks], [[[65, 90]], [[115, 140]]], 'an arrow whose place has left the picture is not drawn');
});

// Returns the colours of a map in shaders/maps as [[red, green, blue], ...].
const MAPS = new URL('../../shaders/maps/', import.meta.url);
const coloursOf = (file) => readFileSync(new URL(file, MAPS), 'utf8').split('\n').filter((line) => /^\d/.test(line))
    .map((line) => line.split(',').map(Number));

test('pixels that the shader mixes change a value by at most 4.3 % of the range, in every colour map', () => {
    const limit = (name) => Math.floor(Number(PICTURE.match(new RegExp(`\\b${name} = ([\\d.]+) / 255`))[1]));
    const LIKE_HUE = limit('LIKE_HUE'), LIKE = limit('LIKE'), worst = {};
    const areAlike = (a, b) => {
        const [red, green, blue] = [0, 1, 2].map((c) => a[c] - b[c]);
        return Math.abs(red - green) <= LIKE_HUE && Math.abs(green - blue) <= LIKE_HUE
            && Math.max(Math.abs(red), Math.abs(green), Math.abs(blue)) <= LIKE;
    };
    for (const file of readdirSync(MAPS).filter((name) => name.endsWith('.csv') && name !== 'operator.csv')) {
        const map = coloursOf(file);
        assert.equal(map.length, 256, file);
        const valueOf = (colour) => {
            let best = 0, least = Infinity;
            for (let i = 0; i < 256; i++) {
                const by = (map[i][0] - colour[0]) ** 2 + (map[i][1] - colour[1]) ** 2 + (map[i][2] - colour[2]) ** 2;
                if (by < least)
                    [best, least] = [i, by];
            }
            return best;
        };
        worst[file] = 0;
        for (let i = 0; i < 256; i++)
            for (let j = i + 1; j < 256; j++)
                for (let part = 1; part < 8 && areAlike(map[i], map[j]); part++) {
                    const at = valueOf(map[i].map((v, c) => Math.round(v + (map[j][c] - v) * part / 8)));
                    worst[file] = Math.max(worst[file], Math.min(Math.abs(at - i), Math.abs(at - j)) / 255);
                }
    }
    assert.ok(Object.values(worst).length >= 6 && Object.values(worst).every((part) => part <= 0.0435), JSON.stringify(worst));
    // grey within the limits L and H
    const isWithin = ([red, green, blue]) => red === green && green === blue, states = coloursOf('operator.csv');
    assert.ok(states.every((a) => states.every((b) => isWithin(a) && isWithin(b) || a.join() === b.join() || !areAlike(a, b))),
        'states are never mixed');
});
