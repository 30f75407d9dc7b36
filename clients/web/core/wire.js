// SPDX-License-Identifier: GPL-3.0-or-later
// Parses binary messages of the protocol plantcast.v1 (protocol/PROTOCOL.md) into objects with checked values. No other code parses their
// headers.

export const SUBPROTOCOL = 'plantcast.v1';
const FRAME_HEADER_BYTES = 112, MAX_PAYLOAD_BYTES = 64 * 1024 * 1024, NO_AGE = 0xffffffff;
const MIN_SIDE_PX = 16, MAX_SIDE_PX = 8192, MAX_PIXELS = 16 * 1024 * 1024;
export const CODECS = { 1: 'jpeg', 2: 'png', 3: 'h264' };
const FLAG_KEY = 1, FLAG_STILL = 2, FLAG_NO_LIVE_DATA = 4, FLAG_MORE = 8, FLAG_DATA = 16, FLAG_PAST = 32, FLAG_DEPTH = 128;
// message type of a depth grid; flag in its header: the grid of the split view's other half follows
const DEPTH_GRID = 2, FLAG_OTHER_HALF = 2;

export class WireError extends Error {}

function need(condition, what) {
    if (!condition)
        throw new WireError(what);
}

// Reads a time as a u64 of microseconds since 1970, which a double represents exactly until the year 2255.
function time(view, offset) {
    const us = Number(view.getBigUint64(offset, true));
    need(Number.isSafeInteger(us), `time at byte ${offset} is after the year 2255`);
    return us;
}

const triple = (view, offset) => [0, 4, 8].map((o) => view.getFloat32(offset + o, true));

// Reads a camera's field of view and height; a camera with a field of view of 0 is orthographic.
function lens(view) {
    const fov = view.getFloat32(104, true), height_m = view.getFloat32(108, true);
    if (fov === 0) {
        need(Number.isFinite(height_m) && height_m > 0, `orthographic height of ${height_m} m`);
        return { fov: 0, height_m };
    }
    need(fov >= 1 && fov <= 120, `field of view of ${fov} degrees, expected 1 to 120`);
    return { fov };
}

// Parses a frame. Throws WireError. The payload is a view into the given bytes.
export function decodeFrame(bytes) {
    const data = bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes);
    need(data.length >= FRAME_HEADER_BYTES, `${data.length} bytes, too few for a frame header`);
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    const u16 = (o) => view.getUint16(o, true), u32 = (o) => view.getUint32(o, true);
    need(view.getUint8(0) === 1, `message type ${view.getUint8(0)} is unknown`);
    const flags = u16(2);
    const frame = {
        flags, codec: CODECS[view.getUint8(1)],
        key: (flags & FLAG_KEY) !== 0, still: (flags & FLAG_STILL) !== 0, noLiveData: (flags & FLAG_NO_LIVE_DATA) !== 0,
        data: (flags & FLAG_DATA) !== 0,
        // flag: the frame shows the past instant dataTimeUs
        past: (flags & FLAG_PAST) !== 0,
        // flag: another frame with a further rectangle of the same picture follows
        more: (flags & FLAG_MORE) !== 0,
        // flag: the newest depth grids belong to this picture
        hasDepth: (flags & FLAG_DEPTH) !== 0,
        seq: u32(8), cameraSeq: u32(12), paramsSeq: u32(16),
        oldestAgeMs: u32(20) === NO_AGE ? null : u32(20),
        dataTimeUs: time(view, 24), sentTimeUs: time(view, 32),
        waitUs: u32(40), fieldUs: u32(44), renderUs: u32(48), encodeUs: u32(52),
        x: u16(56), y: u16(58), width: u16(60), height: u16(62), fullWidth: u16(64), fullHeight: u16(66),
        camera: { eye: triple(view, 68), target: triple(view, 80), up: triple(view, 92), ...lens(view) },
        payload: data.subarray(FRAME_HEADER_BYTES),
    };
    need(frame.codec, `codec ${view.getUint8(1)} is unknown`);
    need(frame.seq > 0, 'the frame has number 0');
    need(u32(4) >= 1 && u32(4) <= MAX_PAYLOAD_BYTES, `payload of ${u32(4)} bytes, expected 1 to ${MAX_PAYLOAD_BYTES}`);
    need(u32(4) === frame.payload.length, `${frame.payload.length} bytes of payload, the header says ${u32(4)}`);
    need(frame.fullWidth >= 1 && frame.fullWidth <= MAX_SIDE_PX && frame.fullHeight >= 1 && frame.fullHeight <= MAX_SIDE_PX,
        `picture of ${frame.fullWidth}x${frame.fullHeight}`);
    need(frame.width >= 1 && frame.height >= 1 && frame.x + frame.width <= frame.fullWidth && frame.y + frame.height <= frame.fullHeight,
        `part ${frame.width}x${frame.height}+${frame.x}+${frame.y} of ${frame.fullWidth}x${frame.fullHeight}`);
    const { eye, target, up } = frame.camera;
    need([...eye, ...target, ...up].every(Number.isFinite), 'the camera has infinite coordinates, or not numbers');
    return frame;
}

// Returns true if the server aborted the frame: the message is shorter than its header says.
export function isGivenUp(bytes) {
    const data = bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes);
    const there = data.length - FRAME_HEADER_BYTES;
    return there >= 0 && new DataView(data.buffer, data.byteOffset, data.length).getUint32(4, true) > there;
}

// Returns null if the message is not a depth grid, else { more (true: the grid of the split view's other half follows), seq (number of the
// picture that the grid belongs to; null: the message is too short) }. core/depth_grid.js parses the rest.
export function depthGridOf(bytes) {
    const data = new Uint8Array(bytes), [type, , flags] = data;
    const seq = data.length < 12 ? null : new DataView(data.buffer).getUint32(8, true);
    return type === DEPTH_GRID ? { more: (flags & FLAG_OTHER_HALF) !== 0, seq } : null;
}

// Returns true if the frame covers the whole picture, so that nothing of the previous one remains.
export const isWhole = (frame) => frame.width === frame.fullWidth && frame.height === frame.fullHeight;

// Parses a text message into an object that has a `type`.
export function decodeMessage(text) {
    let message;
    try {
        message = JSON.parse(text);
    } catch (error) {
        throw new WireError(`not JSON: ${error.message}`);
    }
    need(message && typeof message === 'object' && !Array.isArray(message), 'not an object');
    need(typeof message.type === 'string', 'no type');
    return message;
}

export function decodeBase64(text) {
    return Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
}

// Returns the size of the picture to request: the window's size in device pixels, reduced in proportion to the largest size that the server
// draws.
export function pictureSize(widthPx, heightPx) {
    const shrink = Math.min(1, MAX_SIDE_PX / widthPx, MAX_SIDE_PX / heightPx, Math.sqrt(MAX_PIXELS / (widthPx * heightPx)));
    const side = (px) => (px > 0 && px * shrink > MIN_SIDE_PX ? Math.floor(px * shrink) : MIN_SIDE_PX);
    return { width: side(widthPx), height: side(heightPx) };
}
