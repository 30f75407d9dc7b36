// SPDX-License-Identifier: GPL-3.0-or-later
// Readers of strangers' files: what one that is taken over can reach, and what becomes of one that crashes, hangs or swells.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { test } from 'node:test';
import { BIN, missing, TinyPlant } from './support/tiny_plant.mjs';

const ESCAPE = resolve(process.env.PLANTCAST_OUT ?? 'build/release', 'tests/faults/escape');
const absent = [...missing(), ...['plantcast-import', 'plantcast-match'].filter((name) => !existsSync(join(BIN, name)))];
if (!existsSync(ESCAPE))
    absent.push(ESCAPE);
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : false;
const ASK = 'import ctypes; print(ctypes.CDLL(None).syscall(444, None, 0, 1))'; // landlock_create_ruleset, its version
const abi = Number(spawnSync('/usr/bin/python3', ['-c', ASK], { encoding: 'utf8' }).stdout);
const unguarded = skip || (abi >= 6 ? false : `this kernel's Landlock has version ${abi}; 6 is needed to hold all of this back`);

async function inFolder(f) {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-confinement-'));
    try {
        await f(folder);
    } finally {
        rmSync(folder, { recursive: true });
    }
}

// Programs with the reader of meshes replaced.
function programs(folder, reader) {
    const bin = join(folder, 'bin');
    mkdirSync(bin);
    for (const name of ['plantcast', 'plantcast-import'])
        copyFileSync(join(BIN, name), join(bin, name));
    copyFileSync(reader, join(bin, 'plantcast-import-assimp'));
    return bin;
}

const attempts = (said) => Object.fromEntries([...said.matchAll(/^(?:.*: )?([\w-]+) (succeeded|refused) ?(\w*)$/gm)]
    .map(([, name, how, why]) => [name, how === 'succeeded' ? how : why]));

test('a reader that is taken over reaches nothing of the daemon or the machine', { skip: unguarded }, () => inFolder(async (folder) => {
    const plant = await TinyPlant.create();
    try {
        assert.equal(plant.prepare().code, 0);
        await plant.startDaemon();
        const secret = join(plant.folder, 'signing-key.pem'), env = { ...process.env, PLANTCAST_ESCAPE: 'a secret' };
        writeFileSync(secret, 'secret', { mode: 0o600 });
        const model = join(folder, 'model.obj');
        writeFileSync(model, `${plant.daemon.child.pid} ${plant.port} ${secret} ${join(plant.folder, 'tags.csv')}\n`);
        const own = join(folder, 'own');
        mkdirSync(own);
        const free = attempts(spawnSync(ESCAPE, [model], { cwd: own, env, encoding: 'utf8' }).stdout);
        const got = Object.keys(free).filter((name) => free[name] === 'succeeded');
        console.log(`# unconfined, ${got.length} of ${Object.keys(free).length} attempts succeed; refused: ${
            Object.entries(free).filter(([, how]) => how !== 'succeeded').map((each) => each.join(' ')).join(', ')}`);
        assert.ok(got.length >= (process.getuid() === 0 ? 60 : 35), 'the attempts work where nothing holds them back');
        const { status, stdout, stderr } = spawnSync(join(programs(folder, ESCAPE), 'plantcast'),
            ['import', model, '-o', join(folder, 'plant')], { env, encoding: 'utf8' });
        assert.equal(status, 0, stderr);
        const held = attempts(stdout);
        assert.deepEqual(Object.keys(held), Object.keys(free));
        assert.deepEqual(Object.entries(held).filter(([, how]) => how === 'succeeded'), []);
        assert.equal(readFileSync(secret, 'utf8'), 'secret');
        assert.equal(plant.daemon.child.exitCode, null);
    } finally {
        await plant.destroy();
    }
}));

