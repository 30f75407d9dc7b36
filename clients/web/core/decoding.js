// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes frames: JPEG and PNG by the browser; H.264 after decoder_fallback.js has found a decoder that works.

export const PLAIN = ['jpeg', 'png'];
const MIME = { jpeg: 'image/jpeg', png: 'image/png' };
// a second failure within this many milliseconds means that the H.264 decoder is broken; a single one may be a damaged frame
const AGAIN_MS = 10000;

// Decodes frames to pictures that a canvas can draw. onCodecs(list) is called with the codecs to request from now on, onLost() when a key
// frame is needed.
export class Decoding {
    // env: { api (the browser's objects, perhaps with VideoDecoder), store (localStorage), agent (browser version), now,
    // makeBitmap(blob), tryOut(decoder) (optional: replaces the test of H.264 decoders; resolves to null if the decoder works)
    // }.
    constructor(env) {
        Object.assign(this, { env, h264: null, lost: false, failedAt: -Infinity });
        // plain: the codecs that need no VideoDecoder (JPEG, PNG)
        this.codecs = this.plain = PLAIN;
        this.onCodecs = this.onLost = () => {};
    }

    // Tests whether H.264 works here.
    async probe() {
        if (this.env.api.VideoDecoder)
            // while the server is unreachable, decoder_fallback.js cannot be loaded, and the page continues with JPEG
            this.fallback = await import('./decoder_fallback.js').catch(() => null);
        await this.fallback?.probe(this);
    }

    // Returns a promise of a picture that a canvas can draw and that has a method close().
    async decode(frame) {
        if (this.lost && !frame.key)
            throw new Error('the picture before this frame is missing');
        try {
            const picture = await this.pictureOf(frame);
            this.lost = false;
            return picture;
        } catch (error) {
            this.fail(frame);
            throw error;
        }
    }

    pictureOf(frame) {
        if (frame.codec === 'h264' && this.h264)
            return this.h264.decode(frame);
        if (!MIME[frame.codec])
            return Promise.reject(new Error(`codec ${frame.codec} was not asked for`));
        return this.env.makeBitmap(new Blob([frame.payload], { type: MIME[frame.codec] }));
    }

    fail(frame) {
        const first = !this.lost, now = this.env.now(), again = now - this.failedAt < AGAIN_MS;
        this.lost = true;
        if (frame.codec === 'h264' && this.h264 && (again || frame.key)) {
            this.fallback.demote(this);
            return;
        }
        this.failedAt = now;
        if (first)
            this.onLost();
    }
}

export const browserDecoding = () => {
    let store = null;
    try {
        store = globalThis.localStorage;
    } catch {
        // storage is forbidden
    }
    return new Decoding({
        api: globalThis, store, agent: navigator.userAgent, now: () => performance.now(),
        makeBitmap: (blob) => createImageBitmap(blob),
    });
};
