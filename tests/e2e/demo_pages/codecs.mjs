// SPDX-License-Identifier: GPL-3.0-or-later
// For each codec, a real browser shows the same picture as `plantcast snapshot` draws; a codec that the browser cannot decode
// is not used.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { folderOfTests } from '../support/folders.mjs';
import { demo } from './demo.mjs';
import { grab, readPng, settle, shoot, view, waitForPicture, withPage } from '../support/browser.mjs';
import { contrast, deltaE } from '../support/pixels.mjs';
import { BIN, BUILD, missing } from '../support/plant.mjs';
import { family, sharedMb } from '../support/processes.mjs';
import { setUp } from '../support/set_up.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
const SCREEN = { viewport: { width: 960, height: 540 } };
const QUIET_MS = 1500, MANY = 40;
const folder = folderOfTests();
let plant;
const drawn = new Map(); // pictures that `plantcast snapshot` has drawn already, by its arguments and readings

setUp(why, async () => {
    plant = await demo();
});

const withCodec = (codec, init, f) => withPage(`${plant.url}?codec=${codec}`, SCREEN, f, init);

// Draws the page's current view and readings with `plantcast snapshot`, as the reference. Returns the picture.
async function snapshot(page) {
    const { camera } = await view(page), { width, height } = await grab(page);
    const values = join(folder, 'values.csv'), out = join(folder, 'snapshot.png');
    const { tags } = await (await fetch(`${plant.url}api/v1/tags`)).json();
    const rows = tags.filter((tag) => tag.value !== null).map(({ name, value }) => `${name},${value}`);
    const size = ['--size', `${width}x${height}`, '--camera', [...camera.eye, ...camera.target, camera.fov].join(',')];
    const key = [...size, ...rows].join('\n');
    if (!drawn.has(key)) {
        writeFileSync(values, ['tag,value', ...rows, ''].join('\n'));
        const plain = ['snapshot', join(BUILD, 'demo', 'plant.yaml'), '-o', out, '--values', values, '--no-overlay'];
        const { status, stderr } = spawnSync(join(BIN, 'plantcast'), [...plain, ...size], { encoding: 'utf8' });
        assert.equal(status, 0, stderr);
        drawn.set(key, readFileSync(out));
    }
    return readPng(page, drawn.get(key));
}

async function compare(t, page, codec) {
    await waitForPicture(page);
    await settle(page, QUIET_MS);
    assert.equal(await page.evaluate(() => globalThis.plantcast.session.picture.codec), codec);
    const shown = await grab(page), { mean, p99 } = deltaE(shown, await snapshot(page));
    t.diagnostic(`${codec}: mean dE ${mean.toFixed(2)}, 99 % below ${p99.toFixed(1)}`);
    assert.ok(contrast(shown) > 10);
    await shoot(page, `codec-${codec}`);
    assert.ok(mean <= 2, `mean colour difference (dE) ${mean}`);
}

// Draws pictures while the camera moves. Returns the growth of the browser's shared memory and the size of all pictures, in MB.
async function growth(page, count) {
    const before = sharedMb(family(process.pid)), { width, height } = await grab(page);
    await page.evaluate(async (most) => {
        const { session } = globalThis.plantcast;
        for (let n = 0, { picture } = session; n < most; n++, { picture } = session) {
            session.setCamera({ ...session.camera, eye: session.camera.eye.map((m) => m + 0.01) });
            while (session.picture === picture)
                await new Promise((done) => requestAnimationFrame(done));
        }
    }, count);
    return [sharedMb(family(process.pid)) - before, (count * 4 * width * height) / 2 ** 20];
}

test('H.264 decoded by WebCodecs shows the same picture as the snapshot', options, (t) => withCodec('h264', null, async (page) => {
    await compare(t, page, 'h264');
    assert.deepEqual(await page.evaluate(() => globalThis.plantcast.decoding.codecs), ['auto', 'h264', 'jpeg', 'png']);
    // The page must not keep decoded pictures: in Chromium without a GPU, each open VideoFrame occupies shared memory.
    const [grownMb, picturesMb] = await growth(page, MANY);
    t.diagnostic(`${grownMb.toFixed()} MB more shared memory after pictures of ${picturesMb.toFixed()} MB`);
    assert.ok(grownMb < picturesMb / 2);
}));

test('without WebCodecs the page uses JPEG, and shows the same picture', options, (t) => withCodec('auto', () => {
    delete globalThis.VideoDecoder;
}, (page) => compare(t, page, 'jpeg')));

test('a decoder that passes the trial and fails later is replaced by JPEG for good', options, () => withCodec('h264', () => {
    const { decode } = VideoDecoder.prototype;
    let count = 0;
    VideoDecoder.prototype.decode = function decodeSome(chunk) {
        if (++count > 3) // lets three chunks pass (the first two are the page's trial of the decoder) and fails at every later one
            throw new DOMException('it broke', 'EncodingError');
        return decode.call(this, chunk);
    };
}, async (page) => {
    await page.waitForFunction(() => globalThis.plantcast?.session.picture?.codec === 'jpeg');
    await settle(page, QUIET_MS);
    assert.match(await page.evaluate(() => localStorage.getItem('plantcast.h264')), /"none"/);
    await page.reload();
    await waitForPicture(page);
    assert.equal(await page.evaluate(() => globalThis.plantcast.session.codec), 'jpeg');
}));
