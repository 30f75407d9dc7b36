// SPDX-License-Identifier: GPL-3.0-or-later
// A client of the protocol plantcast.v1, written from PROTOCOL.md and RFC 6455 alone. It uses a plain socket, so that tests can
// also violate the protocol.
import { createHash, randomBytes } from 'node:crypto';
import { connect } from 'node:net';

// bits of a frame's `flags`; more: another part of the same picture follows
export const FLAG = { key: 1, still: 2, noLiveData: 4, more: 8, past: 32 };
const OPCODE = { continuation: 0, text: 1, binary: 2, close: 8, ping: 9, pong: 10 };

// Sends one HTTP request, whose request line and headers are `head`, unchanged. Resolves with { status, headers (lower case),
// body }. localAddress: source address of the connection, 127.0.0.1 or another address of this machine.
export function http(port, head, { timeoutMs = 60000, localAddress } = {}) {
    return new Promise((done, fail) => {
        const socket = connect({ port, host: '127.0.0.1', localAddress }, () => socket.write(head));
        let bytes = Buffer.alloc(0);
        const timer = setTimeout(() => socket.destroy(new Error(`no answer to ${JSON.stringify(head.slice(0, 80))}`)), timeoutMs);
        const finish = (ended) => {
            const end = bytes.indexOf('\r\n\r\n');
            if (end < 0)
                return ended ? (clearTimeout(timer), done({ status: 0, headers: {}, body: Buffer.alloc(0) })) : undefined;
            const [first, ...lines] = bytes.subarray(0, end).toString().split('\r\n');
            const headers = Object.fromEntries(lines.map((line) => {
                const colon = line.indexOf(':');
                return [line.slice(0, colon).toLowerCase(), line.slice(colon + 1).trim()];
            }));
            const body = bytes.subarray(end + 4), length = /^HEAD /.test(head) ? 0 : Number(headers['content-length'] ?? 0);
            if (!ended && body.length < length)
                return undefined;
            clearTimeout(timer);
            socket.destroy();
            return done({ status: Number(first.split(' ')[1]), headers, body });
        };
        socket.on('data', (chunk) => { bytes = Buffer.concat([bytes, chunk]); finish(false); });
        socket.on('end', () => finish(true));
        socket.on('error', (error) => { clearTimeout(timer); fail(error); });
    });
}
export const get = (port, path, method = 'GET', more = '', options = {}) =>
    http(port, `${method} ${path} HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n${more}\r\n`, options);

export function encodeFrame(opcode, payload, { fin = true } = {}) {
    const body = Buffer.from(payload), n = body.length, key = randomBytes(4);
    const size = n < 126 ? Buffer.from([n]) : n < 65536 ? Buffer.from([126, n >> 8, n & 255]) : Buffer.concat([Buffer.from([127]), big(n)]);
    const masked = Buffer.from(body.map((byte, i) => byte ^ key[i & 3]));
    size[0] |= 0x80;
    return Buffer.concat([Buffer.from([opcode | (fin ? 0x80 : 0)]), size, key, masked]);
}

function big(n) {
    const out = Buffer.alloc(8);
    out.writeBigUInt64BE(BigInt(n));
    return out;
}

// Parses the header of a frame, with the names of PROTOCOL.md.
function readFrame(bytes) {
    const f32 = (at, count) => Array.from({ length: count }, (_, i) => bytes.readFloatLE(at + 4 * i));
    const u32 = (at) => bytes.readUInt32LE(at), u16 = (at) => bytes.readUInt16LE(at);
    return {
        type: bytes[0], codec: bytes[1], flags: u16(2), payload_bytes: u32(4), seq: u32(8), camera_seq: u32(12), params_seq: u32(16),
        oldest_age_ms: u32(20), data_time_us: Number(bytes.readBigUInt64LE(24)), sent_time_us: Number(bytes.readBigUInt64LE(32)),
        wait_us: u32(40), field_us: u32(44), render_us: u32(48), encode_us: u32(52), x: u16(56), y: u16(58), width: u16(60),
        height: u16(62), full_width: u16(64), full_height: u16(66), eye: f32(68, 3), target: f32(80, 3), up: f32(92, 3),
        fov: f32(104, 1)[0], height_m: f32(108, 1)[0],
        payload: bytes.subarray(112),
    };
}

// Parses the header of a depth grid, using the names of PROTOCOL.md.
function readDepth(bytes) {
    const u32 = (at) => bytes.readUInt32LE(at), u16 = (at) => bytes.readUInt16LE(at);
    return {
        encoding: bytes[1], flags: u16(2), payload_bytes: u32(4), seq: u32(8), x: u16(12), y: u16(14), width: u16(16), height: u16(18),
        full_width: u16(20), full_height: u16(22), columns: u16(24), rows: u16(26), cell_px: bytes[28], mask_side: bytes[29],
        levels: u16(30),
        base: bytes.readFloatLE(32), unit: bytes.readFloatLE(36), data_bytes: u32(40), payload: bytes.subarray(44), message: bytes,
    };
}

export class PlainClient {
    // Opens a WebSocket and resolves with the client when the server accepts the handshake. options: protocol (null: none),
    // origin, host, path, headers; acknowledge: false: do not acknowledge frames; localAddress: source address.
    static open(port, options = {}) {
        const { protocol = 'plantcast.v1', origin = null, host = `127.0.0.1:${port}`, path = '/stream', headers = [] } = options;
        const { acknowledge = true, localAddress } = options;
        const key = randomBytes(16).toString('base64');
        const client = new PlainClient();
        client.acknowledge = acknowledge;
        return new Promise((done, fail) => {
            const socket = connect({ port, host: '127.0.0.1', localAddress }, () => socket.write([
                `GET ${path} HTTP/1.1`, `Host: ${host}`, 'Upgrade: websocket', 'Connection: Upgrade',
                `Sec-WebSocket-Key: ${key}`, 'Sec-WebSocket-Version: 13', ...(protocol ? [`Sec-WebSocket-Protocol: ${protocol}`] : []),
                ...(origin ? [`Origin: ${origin}`] : []), ...headers, '', '',
            ].join('\r\n')));
            const accept = createHash('sha1').update(`${key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest('base64');
            client.socket = socket;
            const greet = (chunk) => {
                client.bytes = Buffer.concat([client.bytes, chunk]);
                const end = client.bytes.indexOf('\r\n\r\n');
                if (end < 0)
                    return;
                const head = client.bytes.subarray(0, end).toString();
                client.bytes = client.bytes.subarray(end + 4);
                socket.off('data', greet);
                if (!head.startsWith('HTTP/1.1 101') || !head.includes(accept))
                    return fail(new Error(head.split('\r\n')[0]));
                if (protocol && !/^sec-websocket-protocol: *plantcast(\.core)?\.v1\r?$/im.test(head))
                    return fail(new Error(`another subprotocol: ${head}`));
                socket.on('data', (more) => client.take(more));
                client.take(Buffer.alloc(0));
                done(client);
            };
            socket.setNoDelay(true);
            socket.on('data', greet);
            socket.on('error', (error) => { client.finish(null); fail(error); });
            socket.on('close', () => { client.finish(null); fail(new Error('closed before it was open')); });
        });
    }

    constructor() {
        Object.assign(this, { bytes: Buffer.alloc(0), parts: [], opcode: 0, texts: [], frames: [], depths: [] });
        Object.assign(this, { closed: null, waiting: [], held: null });
    }

    take(chunk) {
        this.bytes = this.bytes.length ? Buffer.concat([this.bytes, chunk]) : chunk;
        while (this.bytes.length >= 2) {
            let n = this.bytes[1] & 127, at = 2;
            if (n === 126)
                [n, at] = this.bytes.length < 4 ? [Infinity, 4] : [this.bytes.readUInt16BE(2), 4];
            else if (n === 127)
                [n, at] = this.bytes.length < 10 ? [Infinity, 10] : [Number(this.bytes.readBigUInt64BE(2)), 10];
            if (this.bytes.length < at + n)
                return;
            const first = this.bytes[0];
            this.onFrame(first & 15, (first & 0x80) !== 0, this.bytes.subarray(at, at + n));
            this.bytes = this.bytes.subarray(at + n);
        }
    }

    onFrame(opcode, fin, payload) {
        if (opcode === OPCODE.close) {
            this.finish({ code: payload.length >= 2 ? payload.readUInt16BE(0) : 1005, text: payload.subarray(2).toString() });
        } else if (opcode === OPCODE.ping) {
            this.write(encodeFrame(OPCODE.pong, payload));
        } else if (opcode <= OPCODE.binary) {
            this.opcode = opcode || this.opcode;
            this.parts.push(payload);
            if (fin)
                this.onMessage(Buffer.concat(this.parts.splice(0)));
        }
    }

    onMessage(message) {
        if (this.opcode === OPCODE.text) {
            this.texts.push(JSON.parse(message.toString()));
        } else if (message[0] === 2) {
            this.depths.push({ ...readDepth(message), before: this.frames.length });
        } else {
            const frame = readFrame(message);
            if (frame.payload.length < frame.payload_bytes)
                return; // the server has cancelled this frame while sending it, so its payload is incomplete
            this.frames.push({ ...frame, at: performance.now() });
            // acknowledges a picture only with its last part, because the server may cancel the remaining parts
            if (this.acknowledge && !(frame.flags & FLAG.more))
                this.say({ type: 'ack', seq: frame.seq });
        }
        this.wake();
    }

    finish(how) {
        this.closed ??= how ?? { code: 1006, text: '' };
        this.socket.destroy();
        this.wake();
    }

    wake() {
        for (const look of this.waiting.splice(0))
            look();
    }

    write(bytes) {
        if (this.held)
            this.held.push(bytes);
        else if (!this.socket.destroyed)
            this.socket.write(bytes);
    }

    // Sends the bytes of a WebSocket frame one at a time. Frames that the client wants to send meanwhile, such as pongs, wait,
    // because no frame may begin inside another.
    async trickle(bytes, pauseMs) {
        this.held = [];
        for (const byte of bytes) {
            if (!this.socket.destroyed)
                this.socket.write(Buffer.from([byte]));
            await new Promise((done) => setTimeout(done, pauseMs));
        }
        const waiting = this.held;
        this.held = null;
        for (const one of waiting)
            this.write(one);
    }

    say(message) {
        this.write(encodeFrame(OPCODE.text, typeof message === 'string' ? message : JSON.stringify(message)));
    }

    // Waits until question(this) is neither null, false nor undefined, and returns that.
    async until(what, question, timeoutMs = 60000) {
        const end = performance.now() + timeoutMs;
        for (;;) {
            const answer = question(this);
            if (answer !== null && answer !== undefined && answer !== false)
                return answer;
            if (performance.now() > end) {
                const { payload, ...frame } = this.frames.at(-1) ?? {}, came = this.texts.slice(-3).map((text) => JSON.stringify(text));
                throw new Error(`waited ${timeoutMs} ms for ${what}; closed: ${JSON.stringify(this.closed)}; came: ` +
                    `${this.frames.length} frames, the last ${JSON.stringify(frame)}; the last messages ${came.join(' ').slice(0, 600)}`);
            }
            await new Promise((done) => { this.waiting.push(done); setTimeout(done, 50); });
        }
    }

    // Waits for the first message of that type that has not been taken yet, and takes it.
    text(type, timeoutMs) {
        return this.until(`a message of type ${type}`, () => {
            const i = this.texts.findIndex((message) => message.type === type);
            return i < 0 ? null : this.texts.splice(i, 1)[0];
        }, timeoutMs);
    }

    async hello(more = {}) {
        this.say({ type: 'hello', width: 320, height: 180, codecs: ['jpeg'], ...more });
        return this.text('welcome');
    }

    frameWhere(what, question = () => true, timeoutMs = undefined) {
        return this.until(what, () => this.frames.find(question), timeoutMs);
    }

    close() {
        this.closed ??= { code: 1000, text: 'by us' };
        this.socket.destroy();
    }
}
