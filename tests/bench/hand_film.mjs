// SPDX-License-Identifier: GPL-3.0-or-later
// Films the page in chromium while a pointer turns the demo plant over a link with a round trip of 200 ms: on the left the page shows
// only the server's pictures, on the right it also warps them (clients/web/app/picture/warp.js). Writes an animated WebP. Needs ffmpeg.
// usage: node tests/bench/hand_film.mjs FILE.webp
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';
import { drive } from '../e2e/support/drivers.mjs';
import { startPlant } from '../e2e/support/plant.mjs';
import { Relay } from '../e2e/support/relay.mjs';

const WIDTH = 400, HEIGHT = 270, ROOM = 400, ROUND_TRIP_MS = 200, SECONDS = 3, HZ = 60, FPS = 10,
    REACH_PX = 26, TURN_S = 3; // ROOM: space of the window in CSS pixels beside and below the picture
const [file] = process.argv.slice(2);

// Gives the picture the upper left corner of the window, and hides what lies over the picture.
function showPictureAlone([width, height]) {
    Object.assign(document.getElementById('viewport').style,
        { position: 'fixed', inset: '0 auto auto 0', width: `${width}px`, height: `${height}px`, zIndex: 9 });
    document.querySelectorAll('body > :not(.stage), .assets, .legend, .banner').forEach((part) => { part.style.visibility = 'hidden'; });
}

// Draws a disc at the pointer, because the browser does not film its own pointer.
function followPointer() {
    const disc = document.createElement('div');
    Object.assign(disc.style, { position: 'fixed', zIndex: 99, width: '14px', height: '14px', margin: '-7px 0 0 -7px', borderRadius: '50%',
        background: 'rgb(255 255 255 / 0.7)', border: '2px solid #1d252d', pointerEvents: 'none' });
    document.body.append(disc);
    addEventListener('pointermove', ({ clientX, clientY }) => Object.assign(disc.style, { left: `${clientX}px`, top: `${clientY}px` }),
        { capture: true });
}

// Returns the filmed pictures of a drag as [{ at (seconds), jpeg }, ...]. warps: whether the page warps pictures.
async function film(port, warps) {
    const page = await drive('chromium', WIDTH + ROOM, HEIGHT + ROOM, 1), pictures = [];
    try {
        if (!warps) // without WebGL 2 the page does not ask for depth
            await page.page.addInitScript(() => { delete globalThis.WebGL2RenderingContext; });
        await page.goto(`http://127.0.0.1:${port}/?codec=jpeg`);
        await page.wait(() => Boolean(globalThis.plantcast?.session.picture));
        await page.evaluate(showPictureAlone, [WIDTH, HEIGHT]);
        await page.wait(([wide]) => globalThis.plantcast.session.picture.fullWidth === wide, [WIDTH]);
        await page.evaluate(async (aspect) => {
            const { fit } = await import('/core/camera_moves.js'), { session } = globalThis.plantcast;
            session.setCamera(fit(session.camera, session.model.plant.bounds, aspect, 1));
        }, WIDTH / HEIGHT);
        await page.evaluate(followPointer);
        await page.pointer('mouseMoved', WIDTH / 2, HEIGHT / 2);
        await page.pointer('mousePressed', WIDTH / 2, HEIGHT / 2);
        const circle = async (seconds) => {
            const began = performance.now();
            for (let n = 1; n <= seconds * HZ; n++) {
                const angle = 2 * Math.PI * n / (TURN_S * HZ);
                page.pointer('mouseMoved', WIDTH / 2 + REACH_PX * Math.sin(angle), HEIGHT / 2 + 8 * Math.sin(2 * angle));
                await sleep(Math.max(0, began + n * 1000 / HZ - performance.now()));
            }
        };
        await circle(TURN_S); // not filmed: the page loads what follows the hand
        page.client.on('Page.screencastFrame', ({ data, metadata: { timestamp: at }, sessionId }) => {
            pictures.push({ at, jpeg: Buffer.from(data, 'base64') });
            page.client.send('Page.screencastFrameAck', { sessionId }).catch(() => {}); // the page may have been closed meanwhile
        });
        await page.client.send('Page.startScreencast', { format: 'jpeg', quality: 90 });
        await circle(SECONDS);
        await page.client.send('Page.stopScreencast');
        const last = pictures.at(-1).at;
        return pictures.filter(({ at }) => last - at < SECONDS);
    } finally {
        await page.close();
    }
}

// Writes the pictures and a list of them with their durations for ffmpeg. Returns the list's path.
function listOf(pictures, folder, name) {
    const lines = pictures.map(({ at, jpeg }, i) => {
        const path = join(folder, `${name}-${i}.jpg`);
        writeFileSync(path, jpeg);
        return `file '${path}'\nduration ${Math.max(0.001, (pictures[i + 1]?.at ?? at + 1 / FPS) - at).toFixed(4)}`;
    });
    const list = join(folder, `${name}.txt`);
    writeFileSync(list, `ffconcat version 1.0\n${lines.join('\n')}\n`);
    return list;
}

const plant = await startPlant(), folder = mkdtempSync(join(tmpdir(), 'plantcast-hand-'));
const relay = await Relay.open(Number(new URL(plant.url).port), { bytesPerS: 0, delayMs: ROUND_TRIP_MS / 2 });
try {
    await plant.freeze((await (await fetch(`${plant.url}api/v1/tags`)).json()).tags.map(({ name }) => name));
    const lists = [];
    for (const [name, warps] of [['before', false], ['after', true]]) {
        const pictures = await film(relay.port, warps);
        console.log(`${name}: ${(pictures.length / SECONDS).toFixed(1)} pictures a second`);
        lists.push(listOf(pictures, folder, name));
    }
    const inputs = lists.flatMap((list) => ['-safe', '0', '-f', 'concat', '-i', list]);
    const fit = `fps=${FPS},crop=${WIDTH}:${HEIGHT}:0:0`;
    const { status, stderr } = spawnSync('ffmpeg', ['-y', '-v', 'error', ...inputs, '-filter_complex',
        `[0:v]${fit}[a];[1:v]${fit},pad=${WIDTH + 8}:${HEIGHT}:8:0:white[b];[a][b]hstack`, '-t', String(SECONDS), '-c:v', 'libwebp',
        '-quality', '30', '-compression_level', '6', '-loop', '0', file], { encoding: 'utf8' });
    if (status !== 0)
        throw new Error(stderr);
} finally {
    relay.close();
    await plant.stop();
    rmSync(folder, { recursive: true });
}
