// SPDX-License-Identifier: GPL-3.0-or-later
// Which decoder is used, how it is tried before use, and which results are remembered.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Decoding, PLAIN } from '../../clients/web/core/decoding.js';
import { codecName, findSps, H264Decoder, whatIsWrong } from '../../clients/web/core/h264.js';

const keyFrame = (level) => ({
    codec: 'h264', key: true,
    payload: Uint8Array.of(0, 0, 0, 1, 0x67, 0x42, 0xc0, level, 9, 0, 0, 0, 1, 0x68, 1, 0, 0, 1, 0x65, 2, 2),
});
const KEY = keyFrame(0x1f), LARGER = keyFrame(0x28);
const DELTA = { codec: 'h264', key: false, payload: Uint8Array.of(0, 0, 0, 1, 0x41, 7, 7) };
const JPEG = { codec: 'jpeg', key: true, payload: Uint8Array.of(0xff, 0xd8) };

// A fake VideoDecoder that answers at once, unless told otherwise.
function fakeApi({ breaks = () => false, keepsBack = () => false, formats = ['RGBA'] } = {}) {
    const made = [];
    class VideoDecoder {
        constructor({ output, error }) {
            Object.assign(this, { output, error, state: 'unconfigured', chunks: [] });
            made.push(this);
        }

        configure(config) {
            this.config = config;
            this.state = 'configured';
        }

        decode(chunk) {
            this.chunks.push(chunk.type);
            queueMicrotask(() => {
                if (breaks(this, chunk)) {
                    this.state = 'closed';
                    this.error(new Error('broken'));
                } else if (!keepsBack(this, chunk)) {
                    this.output({
                        of: chunk, closed: 0, visibleRect: { width: 3, height: 2 },
                        allocationSize: ({ format }) => (formats.includes(format) ? 24 : 9),
                        copyTo: async (pixels) => pixels.fill(chunk.timestamp),
                        close() { this.closed++; },
                    });
                }
            });
        }

        close() {
            this.state = 'closed';
        }
    }
    class EncodedVideoChunk {
        constructor(init) {
            Object.assign(this, init);
        }
    }
    return { VideoDecoder, EncodedVideoChunk, made };
}

function fakeStore() {
    const kept = new Map();
    return { kept, getItem: (name) => kept.get(name) ?? null, setItem: (name, value) => kept.set(name, value) };
}

// Makes a Decoding with fakes. wrong: for each way of decoding (`acceleration`), the fault that the fake trial of the decoder
// reports; none: it works.
function bench({ api = fakeApi(), store = fakeStore(), agent = 'browser 1', wrong = {} } = {}) {
    const told = [], tried = [];
    let now = 0;
    const decoding = new Decoding({
        api, store, agent, now: () => now, makeBitmap: async (blob) => ({ type: blob.type, close() {} }),
        tryOut: async (decoder) => {
            tried.push(decoder.acceleration);
            return wrong[decoder.acceleration] ?? null;
        },
    });
    decoding.onCodecs = (codecs) => told.push(codecs);
    decoding.onLost = () => told.push('lost');
    return { decoding, api, store, told, tried, wait: (ms) => { now += ms; } };
}

test('the codec string is built from the stream\'s parameter set', () => {
    assert.equal(codecName(findSps(KEY.payload)), 'avc1.42c01f');
    assert.deepEqual([...findSps(KEY.payload)], [0x67, 0x42, 0xc0, 0x1f, 9]);
    assert.equal(findSps(DELTA.payload), null);
    assert.equal(findSps(new Uint8Array(3)), null);
});

test('a page without WebCodecs requests JPEG, and tries no decoder', async () => {
    const { decoding, tried, store } = bench({ api: {} });
    await decoding.probe();
    assert.deepEqual([decoding.codecs, tried, store.kept.size], [PLAIN, [], 0]);
    assert.equal((await decoding.decode(JPEG)).type, 'image/jpeg');
    await assert.rejects(decoding.decode(KEY), /not asked for/);
});

test('a working decoder is remembered for this browser, and a failing one is not tried in this browser again', async () => {
    const store = fakeStore(), wrong = { 'no-preference': 'green', 'prefer-software': 'late' };
    const first = bench({ store, wrong: { 'no-preference': 'green' } });
    await first.decoding.probe();
    assert.deepEqual(first.tried, ['no-preference', 'prefer-software']);
    assert.deepEqual(first.decoding.codecs, ['auto', 'h264', 'jpeg', 'png']);
    const again = bench({ store });
    await again.decoding.probe();
    assert.deepEqual(again.tried, ['prefer-software'], 'hardware that failed is not tried again');
    const other = bench({ store, agent: 'browser 2', wrong });
    await other.decoding.probe();
    assert.deepEqual([other.tried.length, other.decoding.codecs], [2, PLAIN]);
    const never = bench({ store, agent: 'browser 2' });
    await never.decoding.probe();
    assert.deepEqual([never.tried, never.decoding.codecs], [[], PLAIN]);
});

test('blocked browser storage does no harm', async () => {
    const refuse = () => { throw new Error('denied'); };
    const { decoding } = bench({ store: { getItem: refuse, setItem: refuse } });
    await decoding.probe();
    assert.ok(decoding.codecs.includes('h264'));
});

test('each chunk gives one picture; a new parameter set makes a new decoder', async () => {
    const api = fakeApi(), decoder = new H264Decoder({ api });
    assert.equal((await decoder.decode(KEY)).of.type, 'key');
    assert.equal((await decoder.decode(DELTA)).of.type, 'delta');
    await decoder.decode(KEY);
    assert.equal(api.made.length, 1);
    assert.equal(api.made[0].config.optimizeForLatency, true);
    await decoder.decode(LARGER);
    assert.equal(api.made.length, 2);
    assert.deepEqual([api.made[0].state, api.made[1].config.codec], ['closed', 'avc1.42c028']);
});

test('without a GPU, the pixels of a video frame are copied, unless the browser cannot copy them', async () => {
    const apiOf = (renderer, formats) => ({
        ...fakeApi({ formats }),
        OffscreenCanvas: class {
            getContext = () => renderer && { getParameter: () => renderer, getExtension: () => null };
        },
        ImageData: class {
            constructor(pixels, width, height) {
                assert.equal(pixels.length, 4 * width * height);
                Object.assign(this, { pixels: [...pixels], width, height });
            }
        },
        createImageBitmap: async (image) => ({ image }),
    });
    const decodedBy = async (api) => {
        const { decoding } = bench({ api });
        await decoding.probe();
        return [await decoding.decode(KEY), await decoding.decode(DELTA)];
    };
    for (const renderer of [null, 'ANGLE (Google, Vulkan (SwiftShader Device), SwiftShader driver)']) {
        const copies = (await decodedBy(apiOf(renderer))).map(({ image }) => ({ ...image }));
        assert.deepEqual(copies, [0, 1].map((n) => ({ pixels: Array(24).fill(n), width: 3, height: 2 })));
    }
    for (const api of [apiOf('NVIDIA GeForce'), apiOf(null, []), fakeApi()]) {
        const frames = await decodedBy(api);
        assert.deepEqual(frames.map(({ of, closed }) => [of.type, closed]), [['key', 0], ['delta', 0]]);
    }
});

test('a decoder that keeps pictures back is rejected', async () => {
    const timers = [];
    const clock = { setTimeout: (f) => timers.push(f), clearTimeout: (id) => { timers[id - 1] = () => {}; } };
    const decoder = new H264Decoder({ api: fakeApi({ keepsBack: (_, chunk) => chunk.type === 'delta' }), clock });
    await decoder.decode(KEY);
    const late = assert.rejects(decoder.decode(DELTA), /returned no picture within/);
    timers.at(-1)();
    await late;
    await assert.rejects(decoder.decode(DELTA), /without a key frame/);
});

test('the decoder\'s trial detects wrong colours', async () => {
    const canvas = (colours) => () => ({
        getContext: () => ({
            drawImage() {},
            getImageData: () => ({
                data: Uint8ClampedArray.from({ length: 64 * 64 * 4 }, (_, i) => {
                    const x = (i >> 2) & 63, y = i >> 8;
                    return [...colours[(y >> 5) * 2 + (x >> 5)], 255][i & 3];
                }),
            }),
        }),
    });
    const right = [[200, 40, 40], [40, 160, 60], [240, 200, 40], [220, 220, 220]];
    assert.equal(await whatIsWrong(new H264Decoder({ api: fakeApi() }), canvas(right)), null);
    const unchanged = [...right.slice(0, 2), [50, 70, 200], right[3]];
    assert.match(await whatIsWrong(new H264Decoder({ api: fakeApi() }), canvas(unchanged)), /colours are off by 190/);
    const broken = fakeApi({ breaks: () => true });
    assert.equal(await whatIsWrong(new H264Decoder({ api: broken }), canvas(right)), 'broken');
});

test('after a lost chunk a key frame is requested once, and nothing is shown before it', async () => {
    let breaks = false;
    const { decoding, told } = bench({ api: fakeApi({ breaks: () => breaks }) });
    await decoding.probe();
    await decoding.decode(KEY);
    breaks = true;
    await assert.rejects(decoding.decode(DELTA), /broken/);
    await assert.rejects(decoding.decode(DELTA), /missing/);
    assert.deepEqual(told, ['lost']);
    breaks = false;
    await decoding.decode(KEY);
    await decoding.decode(DELTA);
});

test('a decoder that keeps failing is replaced: hardware by software, then by JPEG, for good', async () => {
    const { decoding, told, store } = bench({ api: fakeApi({ breaks: () => true }) });
    await decoding.probe();
    await assert.rejects(decoding.decode(KEY));
    assert.deepEqual([decoding.acceleration, told], ['prefer-software', ['lost']]);
    await assert.rejects(decoding.decode(KEY));
    assert.deepEqual(told, ['lost', PLAIN]);
    assert.equal((await decoding.decode(JPEG)).type, 'image/jpeg');
    const later = bench({ store });
    await later.decoding.probe();
    assert.deepEqual([later.tried, later.decoding.codecs], [[], PLAIN]);
});
