// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses hardware or software decoding of H.264: tests the decoders once, stores the result, and falls back after failures. The page loads
// this file only after a number of JPEG pictures (app/main.js). H.264 encodes differences between pictures, so it saves data only if many
// pictures are shown.
import { hasGpu } from './gpu.js';
import { H264Decoder, whatIsWrong } from './h264.js';

const ACCELERATIONS = ['no-preference', 'prefer-software']; // hardware first
const KEPT = 'plantcast.h264';

// Returns the stored result of the decoder test for this browser version: an acceleration mode of VideoDecoder, 'none', or null.
function remembered({ store, agent }) {
    try {
        const known = JSON.parse(store?.getItem(KEPT) ?? 'null');
        return known?.agent === agent ? known.way : null;
    } catch {
        return null; // storage may be forbidden
    }
}

function remember({ store, agent }, way) {
    try {
        store?.setItem(KEPT, JSON.stringify({ agent, way }));
    } catch {
        // tested again next time
    }
}

// Returns a decoder. Without a GPU, Chromium keeps up to 512 MB of pixels of the VideoFrames drawn on a canvas, even if the
// page draws them as ImageBitmaps. It keeps none if the page copies the pixels.
function decoderOf({ api }, acceleration) {
    const copies = Boolean(api.OffscreenCanvas) && !hasGpu(new api.OffscreenCanvas(1, 1));
    return new H264Decoder({ acceleration, copies, api });
}

// Tests the H.264 decoders and sets the first one that works. decoding: a Decoding (decoding.js).
export async function probe(decoding) {
    const { env } = decoding, known = remembered(env);
    if (known === 'none')
        return;
    for (const acceleration of ACCELERATIONS.slice(Math.max(0, ACCELERATIONS.indexOf(known)))) {
        const decoder = decoderOf(env, acceleration);
        if (await (env.tryOut ?? whatIsWrong)(decoder) === null) {
            use(decoding, decoder);
            return;
        }
    }
    remember(env, 'none');
}

function use(decoding, decoder) {
    const { env } = decoding, { acceleration } = decoder;
    Object.assign(decoding, { acceleration, h264: decoder, codecs: ['auto', 'h264', ...decoding.plain] });
    remember(env, acceleration);
}

// Falls back from hardware to software decoding of H.264, and from software decoding to JPEG.
export function demote(decoding) {
    const next = ACCELERATIONS[ACCELERATIONS.indexOf(decoding.acceleration) + 1];
    decoding.h264.close();
    if (next) {
        use(decoding, decoderOf(decoding.env, next));
        decoding.onLost();
        return;
    }
    Object.assign(decoding, { h264: null, codecs: decoding.plain });
    remember(decoding.env, 'none');
    decoding.onCodecs(decoding.codecs);
}
