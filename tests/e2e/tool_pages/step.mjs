// SPDX-License-Identifier: GPL-3.0-or-later
// Markers and labels move together with the picture while the user moves it over a slow link: each is drawn where the frame on
// the screen shows its point, not where the page's newest camera would show it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { arrive, keepMediaQueries, openPage, pixelRatioOf, settle, shoot, TABLET, waitForPicture, withPage } from '../support/browser.mjs';
import { promise } from '../support/promise.mjs';
import { Relay, relayMissing } from '../support/relay.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { projector } from '../../../clients/web/core/camera.js';
import { missing, TinyPlant } from '../support/tiny_plant.mjs';

const absent = [...missing(), relayMissing()].filter(Boolean);
const options = { skip: absent.length > 0 ? `not built: ${absent.join(', ')}` : false, timeout: 200000 };
const LEAST_VIEWS = 10, LEAST_RUN_PX = 12, FRAME_MS = 1000 / 60;
// MARK_PX: maximum distance of a marker from its point; PICTURE_PX: maximum distance (median of the frames) between the edges of the
// coloured area and those of the box, both in page pixels. Encoded edges are blurred, more so in moving pictures, which on a loaded
// machine have fewer and larger pixels: PICTURE_PX allows for two page pixels per picture pixel and is scaled for larger ones.
const MARK_PX = 1, PICTURE_PX = 5, RING_PX = 12; // RING_PX: distance of a leader line from its marker, as in app/viewport/overlay.js
// WARPED_PX: distance beyond the box, in page pixels, up to which coloured pixels are normal: JPEG codes colour in blocks of 16
// pixels, which may extend beyond the box in a few rows. A wrong warp, which stretches across a step in depth, would colour
// whole areas farther away.
const WARPED_PX = 8, WARPED_SHARE = 0.002; // WARPED_SHARE: maximum share of coloured pixels that lie farther than WARPED_PX beyond the box
// a small window, because each frame of a warped picture is drawn and read on the processor
const SCREEN = { viewport: sweep({ width: 1100, height: 700 }, { width: 1024, height: 500 }) };
let plant, relay;

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.running({ fresh: true }));
    await plant.tell('set TI-1 94');
    await plant.tell('set TI-2 94'); // both sensors have the same value, so that the whole field has one colour
    relay = own(await Relay.open(plant.port, { bytesPerS: 4e6, delayMs: 120 }));
});

// Records for every drawn frame: where markers and the box's corners should be, projected by this test's own code with that
// frame's camera and with the page's newest camera; where the page has drawn the markers; whether the pixels there are white;
// and the bounds of the picture's coloured area.
const watch = (page) => page.evaluate((LEAST_RUN_PX) => {
    const { viewport, session, overlay } = globalThis.plantcast, { onDrawn } = viewport, picture = document.getElementById('picture');
    const marks = document.getElementById('overlay'), ratio = devicePixelRatio, { min, max } = session.model.asset('E-101').bounds;
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((n) => [0, 1, 2].map((i) => (n & (1 << i) ? max[i] : min[i])));
    const minus = (a, b) => a.map((v, i) => v - b[i]), dot = (a, b) => a.reduce((sum, v, i) => sum + v * b[i], 0);
    const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d], unit = (a) => a.map((v) => v / Math.hypot(...a));
    // Returns a function that projects a point of the plant to the picture: x and y from the picture's centre, in multiples of
    // the picture's height.
    const seenFrom = ({ eye, target, up, fov }) => (point) => {
        const forward = unit(minus(target, eye)), right = unit(cross(forward, up)), d = minus(point, eye);
        const far = 2 * Math.tan((fov * Math.PI) / 360) * dot(d, forward);
        return [dot(d, right) / far, -dot(d, cross(right, forward)) / far];
    };
    const inPage = (project, point) => {
        const [x, y] = project(point), { width, height } = viewport;
        return [width / 2 + x * height, height / 2 + y * height];
    };
    const bounds = (points) => [0, 1].flatMap((i) => [Math.min(...points.map((p) => p[i])), Math.max(...points.map((p) => p[i]))]);
    // Counts only coloured runs of several pixels, because single coloured pixels are traces that the codec leaves of earlier
    // frames.
    const coloured = () => {
        const { width, height } = picture, { data } = picture.getContext('2d').getImageData(0, 0, width, height), ends = [];
        const leastRun = (LEAST_RUN_PX * width) / viewport.width;
        for (let y = 0, run = 0; y < height; y++, run = 0)
            for (let x = 0, i = 4 * y * width; x <= width; x++, i += 4) {
                const [r, g, b] = x < width ? [data[i], data[i + 1], data[i + 2]] : [0, 0, 0];
                if (Math.max(r, g, b) - Math.min(r, g, b) > 60) {
                    run++;
                    continue;
                }
                if (run >= leastRun)
                    ends.push([x - run, y], [x, y + 1]);
                run = 0;
            }
        return ends.length > 100 ? bounds(ends.map(([x, y]) => [(x * viewport.width) / width, (y * viewport.height) / height])) : null;
    };
    const whiteAt = ([x, y]) => { // returns whether the overlay shows a marker's white disc at this position
        const { data } = marks.getContext('2d').getImageData(Math.round(x * ratio), Math.round(y * ratio), 1, 1);
        return Math.min(...data) > 200;
    };
    globalThis.frames = [];
    viewport.onDrawn = (isNew, isWarped) => {
        onDrawn(isNew, isWarped);
        if (!isNew)
            return;
        const shown = seenFrom(session.picture.camera), asked = seenFrom(session.camera);
        globalThis.frames.push({
            eye: session.picture.camera.eye, coloured: coloured(), pixel: viewport.width / picture.width,
            box: bounds(corners.map((corner) => inPage(shown, corner)).map(([x, y]) => // the part of the box inside of the picture
                [Math.max(0, Math.min(viewport.width, x)), Math.max(0, Math.min(viewport.height, y))])),
            markers: overlay.markers.filter(({ occluded }) => !occluded).map((marker) => {
                const at = inPage(shown, marker.tag.position), { x, y } = overlay.placeOf(marker);
                return { name: marker.tag.name, off: Math.hypot(x - at[0], y - at[1]), white: whiteAt(at),
                    behind: Math.hypot(...minus(at, inPage(asked, marker.tag.position))) };
            }),
        });
    };
}, LEAST_RUN_PX);

async function look(page) {
    await waitForPicture(page);
    await page.waitForFunction(() => globalThis.plantcast.session.model.readings.slice(0, 2).every(({ value }) => value === 94));
    await page.evaluate(() => {
        const { session } = globalThis.plantcast;
        session.setParams({ look: 'flat', hidden: ['P-101A'] });
        session.setCamera({ eye: [2.2, -2.6, 1.6], target: [0, 0, 0], up: [0, 0, 1], fov: 45 });
        globalThis.plantcast.viewport.invalidate();
    });
    await page.evaluate(() => globalThis.plantcast.modules.get('cameraController'));
    await settle(page);
    await watch(page);
}

// Calls step(i), which moves the pointer a little further, until frames from at least LEAST_VIEWS different cameras were seen,
// or 4000 times.
async function move(page, step) {
    const enough = () => page.evaluate((least) => new Set(globalThis.frames.map(({ eye }) => eye.join())).size >= least, LEAST_VIEWS);
    for (let i = 1; i < sweep(100, 50) || (i < 4000 && !await enough()); i++) {
        await step(i);
        await page.waitForTimeout(8);
    }
}

async function judge(page, t) {
    await settle(page);
    const frames = await page.evaluate(() => globalThis.frames), seen = frames.flatMap(({ markers }) => markers);
    const views = new Set(frames.map(({ eye }) => eye.map((m) => m.toFixed(4)).join())).size;
    const [behind, worst] = ['behind', 'off'].map((name) => Math.max(...seen.map((marker) => marker[name])));
    const edges = frames.filter(({ coloured }) => coloured).map(({ box, coloured, pixel }) =>
        Math.max(...box.map((v, i) => Math.abs(v - coloured[i]))) / Math.max(1, pixel / 2)).sort((a, b) => a - b);
    const edge = edges[edges.length >> 1];
    t.diagnostic(`${frames.length} frames of ${views} cameras, up to ${behind.toFixed(0)} px behind the hand; ` +
        `markers ${worst.toFixed(2)} px, edges of the picture ${edge.toFixed(1)} px from where the frame's camera has them`);
    assert.ok(views >= LEAST_VIEWS, `only ${views} different cameras`);
    assert.ok(behind > 10, 'the pointer was ahead of the picture; otherwise the test proves nothing');
    assert.ok(worst <= MARK_PX, `a marker ${worst} px off`);
    assert.deepEqual(seen.filter(({ white }) => !white), [], 'markers are drawn at their places');
    assert.ok(edge <= PICTURE_PX, `the picture's edges are off: ${edges}`);
}

const url = (codec) => `http://127.0.0.1:${relay.port}/?codec=${codec}`;
const middle = async (page) => {
    const box = await page.locator('#viewport').boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
};

// Disables WebGL 2, so that the page shows the server's pictures unchanged instead of warping them to its newest camera.
const withoutWarp = () => { delete globalThis.WebGL2RenderingContext; };

test('markers and labels stay in step while the mouse turns, moves and zooms the picture', options, async (t) => {
    await withPage(url('h264'), SCREEN, async (page) => {
        await look(page);
        const [x, y] = await middle(page);
        await page.mouse.move(x, y);
        await page.mouse.down();
        await move(page, (i) => page.mouse.move(x + 200 * Math.sin(i / 20), y + 40 * Math.sin(i / 9)));
        await page.mouse.up();
        await page.mouse.move(x, y);
        for (const step of [-120, -120, 200, 160]) {
            await page.mouse.wheel(0, step);
            await page.waitForTimeout(60);
        }
        await judge(page, t);
        await shoot(page, 'step');
    }, withoutWarp);
});

sweep(test, () => {})('markers and labels stay in step with fingers, on a tablet in portrait', options, async (t) => {
    await withPage(url('jpeg'), { ...TABLET, viewport: { width: 768, height: 1024 } }, async (page) => {
        await look(page);
        const [x, y] = await middle(page), client = await page.context().newCDPSession(page);
        const touch = (type, ...touchPoints) => client.send('Input.dispatchTouchEvent', { type, touchPoints });
        await touch('touchStart', { x, y, id: 0 });
        await move(page, (i) => touch('touchMove', { x: x + 200 * Math.sin(i / 20), y: y + 40 * Math.sin(i / 9), id: 0 }));
        await touch('touchEnd');
        await judge(page, t);
        await shoot(page, 'step-tablet');
    }, withoutWarp);
});

// Records every picture that the page has warped to its own camera: how many animation frames after that camera was set it was
// drawn, the positions of the markers, and the runs of coloured pixels.
const watchWarped = (page) => page.evaluate((LEAST_RUN_PX) => {
    const { viewport, session, overlay } = globalThis.plantcast, { onDrawn } = viewport, cameras = [];
    let frame = 0;
    const count = () => {
        frame++;
        if (!globalThis.rests)
            requestAnimationFrame(count);
    };
    requestAnimationFrame(count);
    session.on('camera', () => cameras.push({ camera: session.camera, frame }));
    // Returns the runs of coloured pixels in a canvas as [left, right, top] in page pixels.
    const colouredIn = (canvas) => {
        const { width, height } = canvas, copy = new OffscreenCanvas(width, height).getContext('2d'), runs = [];
        copy.drawImage(canvas, 0, 0);
        const { data } = copy.getImageData(0, 0, width, height), across = viewport.width / width, down = viewport.height / height;
        for (let y = 0; y < height; y++)
            for (let x = 0, run = 0; x <= width; x++) {
                const i = 4 * (y * width + x), [r, g, b] = x < width ? [data[i], data[i + 1], data[i + 2]] : [0, 0, 0];
                if (Math.max(r, g, b) - Math.min(r, g, b) > 60) {
                    run++;
                    continue;
                }
                if (run >= LEAST_RUN_PX)
                    runs.push([(x - run) * across, x * across, y * down]);
                run = 0;
            }
        return runs;
    };
    const pixelsOf = (canvas, width, height) => {
        const copy = new OffscreenCanvas(width, height).getContext('2d');
        copy.imageSmoothingEnabled = false;
        copy.drawImage(canvas, 0, 0, width, height);
        return new Uint32Array(copy.getImageData(0, 0, width, height).data.buffer);
    };
    // While a warped picture is replaced by the server's picture, each pixel may be that of the warped picture, that of the
    // server's picture, or transparent. Returns how many pixels of the canvas are none of these, that is, mixtures.
    let warpedPixels;
    const countMixed = (canvas) => {
        const server = pixelsOf(viewport.canvas, canvas.width, canvas.height);
        return pixelsOf(canvas, canvas.width, canvas.height)
            .filter((pixel, i) => pixel !== warpedPixels[i] && pixel !== server[i] && pixel !== 0).length;
    };
    // Gives the first sensor an alarm ring, and its label a leader line. Records where the overlay draws them: the ring's centre,
    // the begin of the leader line, and the label's top left corner with its slot.
    const { drawAlarm, drawLeader, place, context } = overlay, { model } = session;
    const alarm = { priority: 1, kind: 'HH', state: 'active', waiting: false };
    let marks = { rings: [], leaders: [], labels: [] };
    model.alarms.gravest = (index) => (index === 0 ? alarm : null);
    overlay.place = (...given) => new Map([...place.apply(overlay, given)].map(([id, at]) => [id, { ...at, leads: true }]));
    overlay.drawAlarm = (ring) => {
        const { a: ratio, e: x, f: y } = context.getTransform();
        marks.rings.push([x / ratio, y / ratio]);
        drawAlarm.call(overlay, ring);
    };
    overlay.drawLeader = (label, at) => {
        context.moveTo = (...from) => marks.leaders.push(from);
        drawLeader.call(overlay, label, at);
        delete context.moveTo;
        marks.labels.push({ slot: at.slot, at: [at.left, at.top] });
    };
    globalThis.warped = [];
    globalThis.fades = [];
    viewport.onDrawn = (isNew, isWarped) => {
        marks = { rings: [], leaders: [], labels: [] };
        onDrawn(isNew, isWarped);
        if (!isWarped && viewport.warp?.isShown && session.picture.cameraSeq === session.cameraSeq)
            globalThis.fades.push(countMixed(viewport.warp.canvas));
        if (!isWarped || !viewport.warp.isShown)
            return;
        const { canvas } = viewport.warp;
        warpedPixels = pixelsOf(canvas, canvas.width, canvas.height);
        const asked = cameras.find(({ camera }) => camera === session.picture.camera);
        // only the first drawing with a camera measures the delay: later ones draw a newer picture with the same camera
        const isFirst = asked && !asked.isSeen;
        if (asked)
            asked.isSeen = true;
        globalThis.warped.push({ frames: isFirst ? frame - asked.frame : 0, isNewest: session.picture.camera === session.camera,
            isAhead: session.picture.cameraSeq !== session.cameraSeq, runs: colouredIn(viewport.warp.canvas), camera: session.camera,
            markers: overlay.markers.filter(({ occluded }) => !occluded)
                .map((marker) => ({ ...overlay.placeOf(marker), half: marker.half, at: marker.tag.position })), ...marks });
    };
}, LEAST_RUN_PX);

// Ends the counting of watchWarped(). Then counts animation frames, drawings and timers of the page until the server has
// answered two pings; the timer that checks for the server's answers is not counted. news: number of other messages that the
// server sent meanwhile.
const still = (page) => page.evaluate(() => new Promise((done) => {
    globalThis.rests = true;
    requestAnimationFrame(done);
}).then(() => new Promise((done) => {
    const { session: { connection }, viewport: { warp: { painter } } } = globalThis.plantcast;
    const seen = { frames: 0, draws: 0, timers: [], news: 0 };
    const { requestAnimationFrame: frame, setTimeout: timer } = globalThis, { heard, clock } = connection;
    let pongs = 0;
    globalThis.requestAnimationFrame = (f) => frame(f, seen.frames++);
    globalThis.setTimeout = (f, ms) => timer(f, ms, seen.timers.push(`${ms} ms: ${f}`));
    connection.clock = { ...clock, setTimeout: (f, ms) => timer(f, ms) };
    painter.paint = () => seen.draws++;
    connection.heard = (data) => {
        heard.call(connection, data);
        const isPong = typeof data === 'string' && JSON.parse(data).type === 'pong';
        pongs += isPong ? 1 : 0;
        seen.news += isPong ? 0 : 1;
        if (pongs < 2)
            return;
        Object.assign(globalThis, { requestAnimationFrame: frame, setTimeout: timer });
        delete painter.paint;
        Object.assign(connection, { heard, clock });
        done(seen);
    };
})));

// Returns the share of coloured pixels that lie more than WARPED_PX outside the bounding rectangle of the points `places`.
function partBeyond(runs, places) {
    const [[left, top], [right, bottom]] = [[Math.min, -WARPED_PX], [Math.max, WARPED_PX]]
        .map(([most, by]) => [0, 1].map((axis) => most(...places.map((place) => place[axis])) + by));
    let all = 0, within = 0;
    for (const [from, to, y] of runs) {
        all += to - from;
        within += y < top || y > bottom ? 0 : Math.max(0, Math.min(to, right) - Math.max(from, left));
    }
    return 1 - within / all;
}

// Replaces the name of the WebGL implementation, so that the page does not notice the browser's software emulation, for which
// it would not use WebGL.
const asGpu = () => {
    const { getParameter } = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.getParameter = function renamed(name) {
        return typeof getParameter.call(this, name) === 'string' ? 'GPU' : getParameter.call(this, name);
    };
};

// Returns whether the coloured pixels of a warped picture are as high as the box, whatever the picture's number of pixels: a page on
// a loaded machine draws fewer.
const isBoxSeen = ({ runs }) => runs.length > 0 && runs.at(-1)[2] - runs[0][2] > 100;

async function loseContext(page) {
    await page.evaluate(() => {
        globalThis.context = globalThis.plantcast.viewport.warp.painter.gl.getExtension('WEBGL_lose_context');
        globalThis.context.loseContext();
    });
    await page.waitForFunction(() => globalThis.plantcast.viewport.warp === null);
    await page.mouse.wheel(0, -120);
    await settle(page);
    await page.evaluate(() => globalThis.context.restoreContext());
    await page.waitForFunction(() => globalThis.plantcast.viewport.warp);
    await page.evaluate(() => { globalThis.warped = []; });
    await page.mouse.wheel(0, 120);
    await page.waitForFunction(() => globalThis.warped.length > 0);
    assert.ok((await page.evaluate(() => globalThis.warped)).every(isBoxSeen), 'the box is visible again');
    await settle(page);
}

// Returns how far markers (and the first sensor's ring, leader line and label) lie from their places in warped pictures, in page
// pixels, and the largest share of colours beyond the box. parts: 2 for a split view, whose colours are not checked.
async function faultsOf(page, seen, parts = 1) {
    const { width: wide, height } = await page.locator('#viewport').boundingBox(), width = wide / parts;
    const { min, max } = await page.evaluate(() => globalThis.plantcast.session.model.asset('E-101').bounds);
    const first = await page.evaluate(() => globalThis.plantcast.session.model.tags[0].position), slots = new Map();
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((n) => [0, 1, 2].map((i) => (n & (1 << i) ? max[i] : min[i])));
    let off = 0, beyond = 0;
    const away = ([x, y], [left, top]) => Math.hypot(x - left, y - top);
    for (const { camera, runs, markers: marks, rings, leaders, labels } of seen) {
        const project = projector(camera, width, height), places = corners.map(project), [x, y] = project(first);
        for (const { at, half, x: left, y: top } of marks)
            off = Math.max(off, away(project(at), [left - half * width, top]));
        if (parts === 1) {
            assert.deepEqual([rings.length, leaders.length, labels.length], [1, 1, 1]);
            const [{ slot, at: [left, top] }] = labels, offset = [left - x, top - y];
            if (!slots.has(slot))
                slots.set(slot, offset);
            // a leader line begins at the edge of the ring; a label lies at a fixed distance from its marker
            off = Math.max(off, away(rings[0], [x, y]), Math.abs(away(leaders[0], [x, y]) - RING_PX), away(offset, slots.get(slot)));
        }
        beyond = parts === 1 ? Math.max(beyond, partBeyond(runs, places)) : 0;
    }
    return { off, beyond };
}

// Draws pictures of four columns with the WebGL painter, moved to the right by a quarter of a pixel. Returns the red values of
// a row of pictures with two columns of one colour and two of another: colours that are alike; shades that differ much; hues
// that differ; alike, but on both sides of a step in depth; alike, but in the two halves of a split view.
const paintMoved = (page) => page.evaluate(async () => {
    const { GlPainter } = await import('/app/picture/painters/gl_painter.js');
    const gl = document.createElement('canvas').getContext('webgl2', { antialias: false }), painter = new GlPainter(gl);
    painter.resize(4, 4);
    const paint = (left, right, kinds, parts = 1) => {
        const picture = new ImageData(4, 4), width = 4 / parts, seen = new Uint8Array(16);
        picture.data.set(Array.from({ length: 4 }, () => [left, left, right, right].flat()).flat());
        const vertices = kinds.flatMap((kind) => [[0, 0], [width, 0], [0, 4], [width, 4]].flatMap(([x, y]) => [x, y, 0, kind]));
        const indices = kinds.flatMap((_, k) => [0, 2, 1, 1, 2, 3, 0, 1, 2, 1, 3, 2].map((i) => 4 * k + i)); // seen from both sides
        const masks = Uint8Array.from({ length: 16 }, (_, i) => (i % 4 < 2 ? 255 : 0)), mesh = { vertices: new Float32Array(vertices),
            indices: new Uint32Array(indices) };
        const halves = Array.from({ length: parts }, (_, k) => (
            { mesh, grid: { x: k * width, y: 0, width, height: 4, cellPx: 4, maskSide: 4, columns: 1, rows: 1, masks } }));
        painter.load(picture, halves);
        painter.paint(halves.map(() => [2 / width, 0, 0, 0, 0, -0.5, 0, 0, 0, 0, 1, 0, 0.5 / width - 1, 1, 0, 1]),
            halves.map(({ grid }) => ({ left: grid.x, top: 0, width, height: 4 })), 14, 0);
        gl.readPixels(0, 1, 4, 1, gl.RGBA, gl.UNSIGNED_BYTE, seen);
        return [0, 4, 8, 12].map((i) => seen[i]);
    };
    const dark = [100, 80, 80, 255], alike = [140, 120, 120, 255], light = [200, 180, 180, 255], green = [80, 110, 80, 255];
    return { alike: paint(dark, alike, [0]), shades: paint(dark, light, [0]), hues: paint(dark, green, [0]),
        steps: paint(dark, alike, [1, 2]), halves: paint(dark, alike, [0], 2) };
});

const followsHand = (painter, ...script) => async (t) => {
    const slow = await Relay.open(plant.port, { bytesPerS: 4e6, delayMs: 300 });
    t.after(() => slow.close()); // also if the page cannot be opened
    const { page, errors, close } = await openPage(`http://127.0.0.1:${slow.port}/?codec=jpeg`, SCREEN,
        ...script);
    try {
        await look(page);
        if (!await page.evaluate(() => globalThis.plantcast.session.reprojects)) {
            t.skip('the server sends no depth grids');
            return;
        }
        const [x, y] = await middle(page);
        await page.mouse.move(x, y);
        await page.mouse.down();
        await page.mouse.move(x + 8, y);
        await page.waitForFunction(() => globalThis.plantcast.viewport.warp);
        assert.equal(await page.evaluate(() => globalThis.plantcast.viewport.warp.painter.constructor.name), painter);
        await settle(page);
        await page.waitForFunction(() => globalThis.plantcast.viewport.warp.grids.at(-1)?.parts);
        await watchWarped(page);
        for (let i = 1; i < 40; i++) {
            await page.mouse.move(x + 8 + 2 * i, y + 12 * Math.sin(i / 9));
            await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
        }
        await shoot(page, 'warped');
        await page.mouse.up();
        const seen = await page.evaluate(() => globalThis.warped), { off, beyond } = await faultsOf(page, seen);
        t.diagnostic(`${seen.length} drawings; markers ${off.toFixed(2)} px off, ${(100 * beyond).toFixed(3)} % of the colours beyond`);
        assert.ok(seen.length >= 10, `only ${seen.length} drawings`);
        assert.ok(seen.every(({ isNewest, isAhead }) => isNewest && isAhead),
            'each drawing shows the newest camera, before the server does');
        const frames = seen.map((one) => one.frames).sort((a, b) => a - b);
        assert.ok(frames[Math.floor(frames.length / 2)] <= 1, `frames from input to picture: ${frames}`);
        promise(t, 'from hand to picture, the latest', FRAME_MS * frames.at(-1), 2 * FRAME_MS);
        assert.ok(seen.every(isBoxSeen), 'the box is visible');
        assert.ok(off <= MARK_PX, `a marker ${off} px off`);
        assert.ok(beyond <= WARPED_SHARE, `share of colours beyond the box: ${beyond}`);
        await settle(page);
        // waits until the server's own picture replaces the warped one
        await page.waitForFunction(() => !globalThis.plantcast.viewport.warp.isShown);
        const fades = await page.evaluate(() => globalThis.fades);
        assert.ok(fades.length > 0 && fades.every((mixed) => mixed === 0), `pixels that mix two pictures: ${fades}`);
        let rest;
        do
            rest = await still(page);
        while (rest.news > 0); // repeats if the server sent a message meanwhile, such as a reading that arrived late on a busy machine
        assert.deepEqual(rest, { frames: 0, draws: 0, timers: [], news: 0 }, 'a still view causes no frames, draws or timers');
        if (painter === 'GlPainter') {
            // at a step in depth, the farther pixel next to it is grey (126)
            assert.deepEqual(await paintMoved(page), { alike: [100, 100, 130, 140], shades: [100, 100, 200, 200], hues: [100, 100, 80, 80],
                steps: [100, 100, 126, 140], halves: [100, 100, 140, 140] });
            await loseContext(page);
        }
        assert.deepEqual(errors, []);
    } finally {
        await close();
    }
};

const name = 'the picture follows the pointer before the server answers, and undrawn areas stay uncoloured';
test(`${name}, by WebGL`, options, followsHand('GlPainter', asGpu));
test(`${name}, by the processor`, options, followsHand('CpuPainter'));

test('after changes of the window\'s size and pixel ratio, and in a split view, warped pictures are true again', options, async (t) => {
    const slow = await Relay.open(plant.port, { bytesPerS: 4e6, delayMs: 150 });
    t.after(() => slow.close());
    const { page, errors, close } = await openPage(`http://127.0.0.1:${slow.port}/?codec=jpeg`, { viewport: { width: 900, height: 600 } },
        keepMediaQueries);
    try {
        await look(page);
        const frame = () => page.evaluate(() => new Promise(requestAnimationFrame));
        await page.mouse.move(...await middle(page));
        await page.waitForFunction(() => globalThis.plantcast.viewport.warp);
        await watchWarped(page);
        const setRatio = await pixelRatioOf(page), split = () => globalThis.plantcast.session.setParams({ split: { colormap: 'viridis' } });
        const changes = [['980x500', () => page.setViewportSize({ width: 980, height: 500 })],
            ['900x500', () => page.setViewportSize({ width: 900, height: 500 })],
            ['pixel ratio 2', () => setRatio(2)], ['split view', () => page.evaluate(split), 2]];
        for (const [change, make, parts = 1] of changes) {
            await make();
            await page.waitForFunction((count) => {
                const { viewport: { width }, session: { picture } } = globalThis.plantcast;
                return Math.abs(picture.fullWidth - width * devicePixelRatio) <= 2 && picture.depth?.messages.length === count;
            }, parts);
            await arrive(page);
            await page.waitForFunction(() => globalThis.plantcast.viewport.warp.grids.at(-1)?.parts &&
                !globalThis.plantcast.viewport.warp.isShown);
            await page.evaluate(() => { globalThis.warped = []; });
            const [x, y] = await middle(page);
            await page.mouse.move(x, y);
            await page.mouse.down();
            for (let i = 1; i < 20; i++) {
                await page.mouse.move(x + 2 * i, y + 8 * Math.sin(i / 5));
                await frame();
            }
            await page.mouse.up();
            const seen = await page.evaluate(() => globalThis.warped), { off, beyond } = await faultsOf(page, seen, parts);
            t.diagnostic(`${change}: ${seen.length} drawings, markers ${off.toFixed(2)} px off`);
            for (let half = 0; half < parts; half++)
                assert.ok(seen.some(({ markers }) => markers.some((marker) => marker.half === half)), 'no marker was drawn');
            assert.equal(await page.evaluate(() => globalThis.plantcast.viewport.warp.source.parts.length), parts);
            assert.ok(seen.length > 0 && off <= MARK_PX && beyond <= WARPED_SHARE, JSON.stringify({ off, beyond }));
        }
        assert.deepEqual(errors, []);
    } finally {
        await close();
    }
});
