// SPDX-License-Identifier: GPL-3.0-or-later
// Which codecs this browser decodes, tried once and remembered, and the decoder of each.

export const PLAIN = ['jpeg', 'png'];
const MIME = { jpeg: 'image/jpeg', png: 'image/png' };
const WAYS = ['no-preference', 'prefer-software']; // hardware first, if there is any
const KEPT = 'plantcast.h264';
const AGAIN_MS = 10000; // two failures within so long: it does not work

// What was learnt of this very browser: a way to decode H.264, 'none', or null.
function remembered(store, agent) {
    try {
        const known = JSON.parse(store?.getItem(KEPT) ?? 'null');
        return known?.agent === agent ? known.way : null;
    } catch {
        return null; // a store that may not be read
    }
}

function remember(store, agent, way) {
    try {
        store?.setItem(KEPT, JSON.stringify({ agent, way }));
    } catch {
        // it is tried again next time
    }
}

// Frames to pictures that can be drawn. onCodecs(list): what to ask the server for from now on. onLost(): a key frame is needed.
export class Decoding {
    // env: { api (with VideoDecoder, or without), store, agent, now, makeBitmap(blob), tryOut(decoder) where not the usual one }.
    constructor(env) {
        Object.assign(this, { env, h264: null, lost: false, failedAt: -Infinity });
        this.codecs = PLAIN;
        this.onCodecs = this.onLost = () => {};
    }

    // Finds out whether H.264 works here.
    async prove() {
        const { api, store, agent } = this.env;
        const known = remembered(store, agent);
        if (!api.VideoDecoder || known === 'none')
            return;
        const { H264Decoder, whatIsWrong } = await import('./h264.js').catch(() => ({}));
        if (!H264Decoder)
            return; // the server is away: JPEG it stays
        Object.assign(this, { H264Decoder });
        for (const acceleration of WAYS.slice(Math.max(0, WAYS.indexOf(known)))) {
            const decoder = new H264Decoder({ acceleration, api });
            const wrong = await (this.env.tryOut ?? whatIsWrong)(decoder);
            if (wrong === null) {
                this.use(acceleration);
                return;
            }
            this.why = wrong;
        }
        remember(store, agent, 'none');
    }

    use(acceleration) {
        const { api, store, agent } = this.env;
        this.acceleration = acceleration;
        this.h264 = new this.H264Decoder({ acceleration, api });
        this.codecs = ['auto', 'h264', ...PLAIN];
        remember(store, agent, acceleration);
    }

    // A promise of something with close() that a canvas draws.
    async decode(frame) {
        if (this.lost && !frame.key)
            throw new Error('the picture that it changes is missing');
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
            this.demote();
            return;
        }
        this.failedAt = now;
        if (first)
            this.onLost();
    }

    // Hardware gives way to software, that to JPEG.
    demote() {
        const next = WAYS[WAYS.indexOf(this.acceleration) + 1];
        this.h264.close();
        if (next) {
            this.use(next);
            this.onLost();
            return;
        }
        this.h264 = null;
        this.codecs = PLAIN;
        remember(this.env.store, this.env.agent, 'none');
        this.onCodecs(this.codecs);
    }
}

export const browserDecoding = () => {
    let store = null;
    try {
        store = globalThis.localStorage;
    } catch {
        // not allowed to this page
    }
    return new Decoding({
        api: globalThis, store, agent: navigator.userAgent, now: () => performance.now(),
        makeBitmap: (blob) => createImageBitmap(blob),
    });
};
