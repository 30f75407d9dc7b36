// SPDX-License-Identifier: GPL-3.0-or-later
// Broken CAD files for `plantcast import`.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { takes } from './sweep.mjs';
import { BIN } from './tiny_plant.mjs';

// Imports each of the broken files { name: bytes }, by default every third one. Asserts that an import either succeeds, or refuses
// the file with one line that names it and leaves no files behind. options(name): further arguments for this file; check({ name,
// status, stdout, stderr }): further assertions by the caller.
export function importBroken(folder, files, options, check) {
    for (const [name, bytes] of Object.entries(files).filter((_, i) => takes(0, i, 3))) {
        const path = join(folder, name), plant = join(folder, 'plant');
        writeFileSync(path, bytes);
        const before = readdirSync(folder).sort();
        const { status, stdout, stderr } = spawnSync(join(BIN, 'plantcast'), ['import', path, '-o', plant, ...options(name)],
            { encoding: 'utf8', timeout: 120000 });
        const told = status === 0 ? stdout.split('\n')[0].replace(/.*: /, 'read: ') : stderr.trim().replace(/.*?: .*?: /, '');
        console.log(`# ${name}: ${told}`);
        check({ name, status, stdout, stderr });
        if (status === 0) {
            rmSync(plant, { recursive: true });
        } else {
            assert.equal(status, 1, name);
            assert.equal(stderr.trimEnd().split('\n').length, 1, stderr);
            assert.ok(stderr.includes(name), stderr);
        }
        assert.deepEqual(readdirSync(folder).sort(), before);
        rmSync(path);
    }
}
