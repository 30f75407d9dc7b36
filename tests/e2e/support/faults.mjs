// SPDX-License-Identifier: GPL-3.0-or-later
// A GPU that fails on demand: a library that replaces the daemon's libEGL (tests/faults/gl_faults.c).
import { spawnSync } from 'node:child_process';
import { closeSync, existsSync, ftruncateSync, mkdtempSync, openSync, readSync, rmSync, writeSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';

const FOLDER = join(resolve(process.env.PLANTCAST_OUT ?? 'build/release'), 'tests/faults');
const LIBRARY = 'libEGL.so.1', BYTES = 64;
// Members of struct faults in tests/faults/gl_faults.c: [offset, size] in bytes in the shared file.
const FIELDS = {
    losses: [0, 4], loss_calls: [4, 4], refusals: [8, 4], hardware: [12, 4], room_bytes: [16, 8], lost: [24, 4], contexts: [28, 4],
    used_bytes: [32, 8], most_bytes: [40, 8], objects: [48, 4], refused: [52, 4], made: [56, 4],
};

function realLibrary() {
    const said = spawnSync('/sbin/ldconfig', ['-p'], { encoding: 'utf8' }).stdout ?? '';
    return said.match(new RegExp(`^\\s*${LIBRARY.replaceAll('.', '\\.')} .*=> (.*)$`, 'm'))?.[1];
}

// Returns why GPU faults cannot be simulated on this machine, or null if they can.
export function faultsMissing() {
    const ours = join(FOLDER, LIBRARY);
    return !existsSync(ours) ? `not built: ${ours}` : realLibrary() ? null : `no ${LIBRARY}`;
}

export class Faults {
    constructor() {
        this.folder = mkdtempSync(join(tmpdir(), 'plantcast-faults-'));
        const path = join(this.folder, 'faults');
        this.file = openSync(path, 'w+');
        ftruncateSync(this.file, BYTES);
        this.spawn = { env: { ...process.env, LD_LIBRARY_PATH: FOLDER, FAULTY_EGL: realLibrary(), FAULTS: path } };
    }

    get(name) {
        const [at, bytes] = FIELDS[name], buffer = Buffer.alloc(8);
        readSync(this.file, buffer, 0, bytes, at);
        return Number(buffer.readBigUInt64LE());
    }

    set(name, value) {
        const [at, bytes] = FIELDS[name], buffer = Buffer.alloc(8);
        buffer.writeBigUInt64LE(BigInt(value));
        writeSync(this.file, buffer, 0, bytes, at);
    }

    end() {
        closeSync(this.file);
        rmSync(this.folder, { recursive: true, force: true });
    }
}
