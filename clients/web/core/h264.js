// SPDX-License-Identifier: GPL-3.0-or-later
// H.264 by the browser's VideoDecoder: each frame gives one picture. Has a self-test with known frames.
import { decodeBase64 } from './wire.js';

const ANSWER_MS = 2000;
const SPS = 7;

// Test frames (base64) from the server's own encoder. The picture has four squares of one colour each; the second frame changes the third
// square.
const PROOF_SIDE = 64, PROOF_TOLERANCE = 16;
const PROOF_KEY = 'AAAAAWdCwAraEJpuAhoMgAAAAwCAAAA8R4kTUAAAAAFozg/IAAAAAWWIhBaEYoAAhvxwABA1jgACG1JxGKAAIP0cY4AAjAydddPXNigACAzHAAEQ6OAA' +
    'IjdrFEigACUVEAAEAYAAQC0GAAIBIADgACAlEATIgCZEATJwEyC4Ai1guAi1guAItYvAEWsOtq65n/mJmTA=';
const PROOF_CHANGE = 'AAAAAUGaIFoSLxQABKEjgACE3HAAEHXELZ/P3A==';
const PROOF_COLOURS = [[200, 40, 40], [40, 160, 60], [240, 200, 40], [220, 220, 220]];

// Returns the sequence parameter set of an H.264 stream in Annex B bytes; null: none found.
export function findSps(bytes) {
    for (let i = 0; i + 6 < bytes.length && i < 4096; i++) {
        if (bytes[i] === 0 && bytes[i + 1] === 0 && bytes[i + 2] === 1 && (bytes[i + 3] & 31) === SPS) {
            let end = i + 4;
            while (end + 2 < bytes.length && !(bytes[end] === 0 && bytes[end + 1] === 0 && bytes[end + 2] <= 1))
                end++;
            return bytes.subarray(i + 3, end);
        }
    }
    return null;
}

const hex = (bytes) => [...bytes].map((byte) => byte.toString(16).padStart(2, '0')).join('');
export const codecName = (sps) => `avc1.${hex(sps.subarray(1, 4))}`;

export class H264Decoder {
    // acceleration: hardwareAcceleration of the VideoDecoder. copies: decode() returns ImageBitmaps instead of VideoFrames. api: {
    // VideoDecoder, EncodedVideoChunk, ImageData, createImageBitmap }.
    constructor({ acceleration = 'no-preference', copies = false, api = globalThis, clock = globalThis }) {
        Object.assign(this, { acceleration, copies, api, clock });
        this.pixels = new Uint8ClampedArray(0); // pixels of the last copied picture
        this.waiting = null; // { resolve, reject } of the promise for the picture being decoded
        this.sps = '';
        this.count = 0;
    }

    // Decodes frame { key, payload }. Returns a promise of a VideoFrame or ImageBitmap. After a failure only a key frame can be decoded.
    async decode({ key, payload }) {
        if (key)
            this.open(payload);
        else if (!this.decoder)
            throw new Error('H.264: cannot start without a key frame');
        try {
            const picture = await this.next(key, payload);
            return this.copies ? await this.copyOf(picture) : picture;
        } catch (error) {
            this.close();
            throw error;
        }
    }

    open(payload) {
        const sps = findSps(payload);
        if (!sps)
            throw new Error('H.264: the key frame has no sequence parameters (SPS)');
        if (this.decoder && hex(sps) === this.sps)
            return;
        this.close();
        this.sps = hex(sps);
        this.decoder = new this.api.VideoDecoder({
            output: (picture) => this.take(picture),
            error: (error) => this.fail(error),
        });
        this.decoder.configure({ codec: codecName(sps), optimizeForLatency: true, hardwareAcceleration: this.acceleration });
    }

    next(key, data) {
        return new Promise((resolve, reject) => {
            const late = () => this.fail(new Error(`H.264: the decoder returned no picture within ${ANSWER_MS} ms`));
            const timer = this.clock.setTimeout(late, ANSWER_MS);
            this.waiting = { resolve, reject, timer };
            const { EncodedVideoChunk } = this.api;
            this.decoder.decode(new EncodedVideoChunk({ type: key ? 'key' : 'delta', timestamp: this.count++, data }));
        });
    }

    // Returns a promise of an ImageBitmap with the pixels of a VideoFrame, or of the VideoFrame itself if the browser cannot copy it as
    // RGBA.
    async copyOf(picture) {
        const { width, height } = picture.visibleRect, options = { format: 'RGBA' };
        try {
            const bytes = picture.allocationSize(options);
            if (this.pixels.length !== bytes)
                this.pixels = new Uint8ClampedArray(bytes);
            await picture.copyTo(this.pixels, options);
            const copy = await this.api.createImageBitmap(new this.api.ImageData(this.pixels, width, height));
            picture.close();
            return copy;
        } catch {
            this.copies = false;
            return picture;
        }
    }

    settle() {
        const { waiting } = this;
        this.waiting = null;
        if (waiting)
            this.clock.clearTimeout(waiting.timer);
        return waiting;
    }

    take(picture) {
        const waiting = this.settle();
        if (waiting)
            waiting.resolve(picture);
        else
            picture.close();
    }

    fail(error) {
        this.settle()?.reject(error);
        this.close();
    }

    close() {
        const { decoder } = this;
        this.decoder = null;
        this.sps = '';
        this.settle()?.reject(new Error('H.264: the decoder was closed'));
        if (decoder && decoder.state !== 'closed')
            decoder.close();
    }
}

// Returns the colours at the centres of the four squares of a test frame: [[r, g, b], ...].
function squares(picture, makeCanvas) {
    const context = makeCanvas(PROOF_SIDE, PROOF_SIDE).getContext('2d', { willReadFrequently: true });
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, PROOF_SIDE, PROOF_SIDE);
    return [0, 1, 2, 3].map((n) => {
        const x = PROOF_SIDE / 4 + (n & 1) * PROOF_SIDE / 2, y = PROOF_SIDE / 4 + (n >> 1) * PROOF_SIDE / 2;
        return [...data.subarray(4 * (y * PROOF_SIDE + x), 4 * (y * PROOF_SIDE + x) + 3)];
    });
}

// Decodes both test frames and compares the colours of their squares. Returns null, or a text that describes the fault.
export async function whatIsWrong(decoder, makeCanvas = (w, h) => new OffscreenCanvas(w, h)) {
    try {
        (await decoder.decode({ key: true, payload: decodeBase64(PROOF_KEY) })).close();
        const picture = await decoder.decode({ key: false, payload: decodeBase64(PROOF_CHANGE) });
        const seen = squares(picture, makeCanvas);
        picture.close();
        const off = Math.max(...seen.flatMap((rgb, n) => rgb.map((value, i) => Math.abs(value - PROOF_COLOURS[n][i]))));
        return off <= PROOF_TOLERANCE ? null : `colours are off by ${off}`;
    } catch (error) {
        return error.message;
    } finally {
        decoder.close();
    }
}
