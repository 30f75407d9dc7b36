// SPDX-License-Identifier: GPL-3.0-or-later
// A client of plantcast.v1 that was written from PROTOCOL.md and RFC 6455 and shares no code with the project, like one of another
// developer.
import { createHash, randomBytes } from 'node:crypto';
import { connect } from 'node:net';
import { inflateSync } from 'node:zlib';

const GUID = '258EAFA5-E914-47DA-95CA-C5AB0DC85B11';
const CODECS = { 1: 'jpeg', 2: 'png', 3: 'h264' };
const PING_MS = 1000;

// --- the frame header as in the table of PROTOCOL.md: [offset, type, name]

const FIELDS = [
    [0, 'u8', 'type'], [1, 'u8', 'codec'], [2, 'u16', 'flags'], [4, 'u32', 'payload_bytes'], [8, 'u32', 'seq'], [12, 'u32', 'camera_seq'],
    [16, 'u32', 'params_seq'], [20, 'u32', 'oldest_age_ms'], [24, 'u64', 'data_time_us'], [32, 'u64', 'sent_time_us'],
    [40, 'u32', 'wait_us'], [44, 'u32', 'field_us'], [48, 'u32', 'render_us'], [52, 'u32', 'encode_us'], [56, 'u16', 'x'], [58, 'u16', 'y'],
    [60, 'u16', 'width'], [62, 'u16', 'height'], [64, 'u16', 'full_width'], [66, 'u16', 'full_height'], [68, 'f32x3', 'eye'],
    [80, 'f32x3', 'target'],
    [92, 'f32x3', 'up'], [104, 'f32', 'fov'], [108, 'f32', 'height_m'],
];
const HEADER_BYTES = 112;
const READ = {
    u8: (b, at) => b.readUInt8(at),
    u16: (b, at) => b.readUInt16LE(at),
    u32: (b, at) => b.readUInt32LE(at),
    u64: (b, at) => Number(b.readBigUInt64LE(at)),
    f32: (b, at) => b.readFloatLE(at),
    f32x3: (b, at) => [0, 4, 8].map((o) => b.readFloatLE(at + o)),
};
export const FLAG = { key: 1, still: 2, noLiveData: 4, more: 8, past: 32 };

export function readHeader(bytes) {
    return Object.fromEntries(FIELDS.map(([at, type, name]) => [name, READ[type](bytes, at)]));
}

// --- pictures: enough of each format to check that it is complete, and its size

function jpegSize(bytes) {
    if (bytes.readUInt16BE(0) !== 0xffd8 || bytes.readUInt16BE(bytes.length - 2) !== 0xffd9)
        throw new Error('no JPEG');
    for (let at = 2; ;) {
        const marker = bytes[at + 1];
        if (bytes[at] !== 0xff)
            throw new Error(`no marker at byte ${at}`);
        if (marker >= 0xc0 && marker <= 0xc2)
            return [bytes.readUInt16BE(at + 7), bytes.readUInt16BE(at + 5)];
        at += 2 + bytes.readUInt16BE(at + 2);
    }
}

function pngSize(bytes) {
    const parts = [], [width, height] = [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
    for (let at = 8; at < bytes.length;) {
        const n = bytes.readUInt32BE(at);
        if (bytes.toString('latin1', at + 4, at + 8) === 'IDAT')
            parts.push(bytes.subarray(at + 8, at + 8 + n));
        at += 12 + n;
    }
    const channels = { 0: 1, 2: 3, 6: 4 }[bytes[25]];
    if (inflateSync(Buffer.concat(parts)).length !== height * (1 + width * channels))
        throw new Error('a PNG with too few, or too many, pixels');
    return [width, height];
}

const SIZE_OF = { jpeg: jpegSize, png: pngSize };

// --- WebSocket

function frameOf(opcode, payload) {
    const body = Buffer.from(payload), mask = randomBytes(4);
    const head = body.length < 126 ? Buffer.from([0x80 | opcode, 0x80 | body.length])
        : Buffer.from([0x80 | opcode, 0x80 | 126, body.length >> 8, body.length & 255]);
    return Buffer.concat([head, mask, body.map((byte, i) => byte ^ mask[i % 4])]);
}

export class Client {
    // headers: additional headers of the handshake. Rejects with the HTTP status and text if the server refuses.
    static open(port, { protocols = 'plantcast.v1', headers = {} } = {}) {
        const client = new Client();
        const key = randomBytes(16).toString('base64');
        const sent = {
            Host: `127.0.0.1:${port}`, Connection: 'Upgrade', Upgrade: 'websocket', 'Sec-WebSocket-Version': 13, 'Sec-WebSocket-Key': key,
            'Sec-WebSocket-Protocol': protocols, ...headers,
        };
        const lines = ['GET /stream HTTP/1.1', ...Object.entries(sent).map(([name, value]) => `${name}: ${value}`)];
        return new Promise((done, fail) => {
            const socket = connect(port, '127.0.0.1', () => socket.write(`${lines.join('\r\n')}\r\n\r\n`));
            client.socket = socket.setNoDelay(true);
            client.onOpen = (head, rest) => {
                const accept = createHash('sha1').update(key + GUID).digest('base64');
                if (!head.startsWith('HTTP/1.1 101'))
                    return setTimeout(() => fail(new Error(`${head.split('\r\n')[0]}: ${client.bytes}${rest}`)), 50);
                if (!head.includes(accept) || !/sec-websocket-protocol: *plantcast\.v1\r?$/im.test(head))
                    return fail(new Error(`a wrong hand-shake: ${head}`));
                client.opened = true;
                return done(client);
            };
            socket.on('data', (chunk) => client.take(chunk));
            socket.on('error', fail);
            socket.on('close', () => client.end(1006, ''));
        });
    }

    constructor() {
        Object.assign(this, { bytes: Buffer.alloc(0), message: [], opened: false, texts: [], pictures: [], closed: null, awaited: [] });
        this.unshown = null; // parts of an incomplete picture
        this.clock = null;   // { rtt_ms, server_us, at } of the shortest round trip
        this.acknowledges = true;
    }

    take(chunk) {
        this.bytes = Buffer.concat([this.bytes, chunk]);
        if (!this.opened) {
            const end = this.bytes.indexOf('\r\n\r\n');
            if (end < 0)
                return;
            const head = this.bytes.toString('latin1', 0, end);
            this.bytes = this.bytes.subarray(end + 4);
            this.onOpen(head, '');
        }
        while (this.opened && this.takeFrame());
        this.wake();
    }

    takeFrame() {
        const b = this.bytes;
        if (b.length < 2)
            return false;
        if (b[1] & 0x80)
            throw new Error('a server must not mask');
        const short = b[1] & 127, at = short < 126 ? 2 : short === 126 ? 4 : 10;
        if (b.length < at)
            return false;
        const n = short < 126 ? short : short === 126 ? b.readUInt16BE(2) : Number(b.readBigUInt64BE(2));
        if (b.length < at + n)
            return false;
        this.bytes = b.subarray(at + n);
        this.onFrame(b[0] & 15, (b[0] & 0x80) !== 0, b.subarray(at, at + n));
        return true;
    }

    onFrame(opcode, final, payload) {
        if (opcode === 8)
            this.end(payload.length >= 2 ? payload.readUInt16BE(0) : 1005, payload.toString('utf8', 2));
        else if (opcode === 9)
            this.socket.write(frameOf(10, payload));
        if (opcode > 2)
            return;
        this.opcode = opcode || this.opcode;
        this.message.push(payload);
        if (!final)
            return;
        const whole = Buffer.concat(this.message.splice(0));
        if (this.opcode === 1)
            this.onText(JSON.parse(whole.toString('utf8')));
        else
            this.onBinary(whole);
    }

    onText(message) {
        if (message.type === 'pong') {
            const now = performance.now(), rtt = now - message.t;
            if (!this.clock || rtt < this.clock.rtt_ms)
                this.clock = { rtt_ms: rtt, server_us: message.time_us, at: now - rtt / 2 };
        }
        this.texts.push(message);
    }

    onBinary(bytes) {
        const header = readHeader(bytes), payload = bytes.subarray(HEADER_BYTES), began = performance.now();
        if (header.type !== 1 || payload.length < header.payload_bytes) // another type of message, or a picture that was given up
            return;
        const codec = CODECS[header.codec], size = SIZE_OF[codec]?.(payload);
        this.unshown = [...(this.unshown ?? []), { header, payload, codec, size }];
        if (header.flags & FLAG.more)
            return;
        this.pictures.push({ ...header, codec, size, parts: this.unshown, at: performance.now() });
        this.unshown = null;
        if (this.acknowledges)
            this.say('ack', { seq: header.seq, decode_ms: performance.now() - began });
    }

    end(code, text) {
        this.closed ??= { code, text };
        this.socket.destroy();
        this.wake();
    }

    wake() {
        for (const look of this.awaited.splice(0))
            look();
    }

    say(type, fields = {}) {
        this.socket.write(frameOf(1, JSON.stringify({ type, ...fields })));
    }

    // Waits until `question` returns something, and returns that.
    async wait(what, question, timeoutMs = 20000) {
        for (const end = performance.now() + timeoutMs; ;) {
            const found = question(this);
            if (found)
                return found;
            if (performance.now() > end || (this.closed && !what.includes('close')))
                throw new Error(`${what} never came; closed: ${JSON.stringify(this.closed)}`);
            await new Promise((look) => { this.awaited.push(look); setTimeout(look, 100); });
        }
    }

    text(type) {
        return this.wait(`a ${type}`, () => {
            const i = this.texts.findIndex((message) => message.type === type);
            return i >= 0 && this.texts.splice(i, 1)[0];
        });
    }

    picture(what, question = () => true) {
        return this.wait(`a picture: ${what}`, () => this.pictures.find(question));
    }

    async hello(fields = {}) {
        this.say('hello', { width: 320, height: 180, codecs: ['jpeg'], ...fields });
        return this.text('welcome');
    }

    // Returns the server's present time in microseconds, from the best of some pings.
    async serverTime(pings = 3) {
        for (let i = 0; i < pings; i++) {
            this.say('ping', { t: performance.now() });
            await this.wait('a pong', () => this.texts.filter((m) => m.type === 'pong').length > i, PING_MS * 10);
        }
        return this.clock.server_us + (performance.now() - this.clock.at) * 1000;
    }

    close() {
        this.socket.write(frameOf(8, Buffer.from([0x03, 0xe8])));
        this.socket.destroy();
    }
}
