// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual X display (Xvfb), and its pixels.
import { spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { deflateSync } from 'node:zlib';
import { crc } from './png_chunks.mjs';

const PROGRAM = '/usr/bin/Xvfb';
export const missingDisplay = () => (existsSync(PROGRAM) ? null : 'no Xvfb');

// Returns { name, pid, env: environment for programs that use it, grab(): { width, height, at(x, y): [r, g, b] }, stop }.
export async function startDisplay(width, height, more = []) {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-display-'));
    const args = ['-displayfd', '3', '-screen', '0', `${width}x${height}x24`, '-fbdir', folder, '-nolisten', 'tcp', ...more];
    const child = spawn(PROGRAM, args, { stdio: ['ignore', 'ignore', 'ignore', 'pipe'] });
    const number = await new Promise((done, fail) => {
        child.stdio[3].once('data', (text) => done(Number(text)));
        child.once('exit', (code) => fail(new Error(`Xvfb ended with ${code}`)));
    });
    const path = join(folder, 'Xvfb_screen0');
    return {
        name: `:${number}`,
        pid: child.pid,
        env: { ...process.env, DISPLAY: `:${number}`, LIBGL_ALWAYS_SOFTWARE: '1' },
        grab: () => readXwd(readFileSync(path)),
        async stop() {
            const gone = new Promise((done) => child.once('exit', done));
            child.kill();
            await gone;
            rmSync(folder, { recursive: true, force: true });
        },
    };
}

// Layout of an X window dump as written by Xvfb: a header of big-endian numbers, the colour map, then rows of B, G, R and a pad
// byte.
function layoutOf(bytes) {
    const number = (i) => bytes.readUInt32BE(4 * i);
    return { width: number(4), height: number(5), stride: number(12), from: number(0) + 12 * number(19) };
}

function readXwd(bytes) {
    const { width, height, stride, from } = layoutOf(bytes);
    const at = (x, y) => {
        const i = from + Math.floor(y) * stride + 4 * Math.floor(x);
        return [bytes[i + 2], bytes[i + 1], bytes[i]];
    };
    return { width, height, at };
}

// Saves a grabbed picture as PNG.
export function savePng({ width, height, at }, path) {
    const rows = Buffer.alloc(height * (1 + 3 * width));
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++)
            rows.set(at(x, y), y * (1 + 3 * width) + 1 + 3 * x);
    }
    const chunk = (type, data) => {
        const out = Buffer.alloc(12 + data.length);
        out.writeUInt32BE(data.length, 0);
        out.write(type, 4, 'latin1');
        data.copy(out, 8);
        out.writeUInt32BE(crc(out.subarray(4, 8 + data.length)), 8 + data.length);
        return out;
    };
    const head = Buffer.alloc(13);
    head.writeUInt32BE(width, 0);
    head.writeUInt32BE(height, 4);
    head.set([8, 2, 0, 0, 0], 8);
    mkdirSync(dirname(path), { recursive: true });
    writeFileSync(path, Buffer.concat([Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'), chunk('IHDR', head),
        chunk('IDAT', deflateSync(rows, { level: 3 })), chunk('IEND', Buffer.alloc(0))]));
}
