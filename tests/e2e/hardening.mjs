// SPDX-License-Identifier: GPL-3.0-or-later
// Hardening: the protections that compiler and linker add to all programs, and the systemd unit's restrictions on a daemon that
// an attacker controls.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { inFolder } from './support/folders.mjs';
import { ifc } from './support/ifc_sample.mjs';
import { get, PlainClient } from './support/plain_client.mjs';
import { BIN, notBuilt, PROGRAMS, TinyPlant } from './support/tiny_plant.mjs';

const skip = notBuilt();
const UNIT = 'deploy/systemd/plantcastd@.service', has = (program) => spawnSync('which', [program]).status === 0;
const read = (program, ...what) => spawnSync('readelf', ['-W', ...what, join(BIN, program)], { encoding: 'utf8' }).stdout;

test('programs are built with PIE, full RELRO, stack protectors and checked library calls', { skip }, () => {
    for (const program of PROGRAMS) {
        assert.match(read(program, '-h'), /Type: +DYN/, `${program}: position-independent`);
        assert.match(read(program, '-l'), /GNU_RELRO/, `${program}: RELRO`);
        assert.match(read(program, '-d'), /FLAGS_1.*NOW.*PIE/, `${program}: symbols are bound at the start`);
        const symbols = read(program, '--dyn-syms');
        assert.match(symbols, /__stack_chk_fail/, `${program}: stack protector`);
        assert.match(symbols, /__(mem|str|v?s?n?printf|fread|read)\w*_chk/, `${program}: _FORTIFY_SOURCE`);
        const stack = read(program, '-l').match(/GNU_STACK.*/)[0];
        assert.match(stack, / RW /, `${program}: the stack is not executable`);
    }
});

test('systemd-analyze rates the exposure of the systemd unit at 2 of 10 or less', {
    skip: has('systemd-analyze') ? false : 'systemd-analyze is not installed',
}, () => {
    const said = spawnSync('systemd-analyze', ['security', '--offline=true', '--threshold=20', UNIT], { encoding: 'utf8' });
    const score = Number(said.stdout.match(/Overall exposure level.*: ([\d.]+)/)[1]);
    console.log(`# exposure ${score}`);
    assert.ok(score <= 2 && said.status === 0, said.stdout);
    for (const line of [/^MemoryMax=/m, /^UMask=0027$/m, /^CapabilityBoundingSet=$/m, /^StateDirectory=plantcast\/%i$/m])
        assert.match(readFileSync(UNIT, 'utf8'), line);
    assert.deepEqual([...readFileSync(UNIT, 'utf8').matchAll(/^ReadWritePaths=(.*)$/gm)].map(([, path]) => path),
        ['-/sys/fs/cgroup/system.slice/system-plantcastd.slice/%n'], 'the unit can write only to its own state and its own cgroup');
});

test('each clause of IEC 62443-4-2 that is marked as met names tests that exist', () => {
    const rows = readFileSync('deploy/IEC62443.md', 'utf8').split('\n').filter((line) => /^\| (CR|SAR) /.test(line));
    assert.ok(rows.length >= 40, `only ${rows.length} clauses found`);
    for (const row of rows) {
        const [, clause, state] = row.split('|').map((cell) => cell.trim());
        const files = [...row.matchAll(/`((?:tests|deploy|server)\/[\w./]+)`/g)].map(([, path]) => path);
        for (const path of files)
            assert.ok(existsSync(path), `${clause} names ${path}, which does not exist`);
        if (/^met/.test(state))
            assert.ok(files.some((path) => /^(tests|deploy\/test)\//.test(path)), `${clause} is marked as met, but names no test`);
    }
});

const unfiltered = has('systemd-analyze') && spawnSync('/usr/bin/python3', ['-c', 'import seccomp']).status === 0 ? false
    : 'python3-seccomp or systemd-analyze is not installed';
const noIfc = existsSync(join(BIN, 'plantcast-import-ifc/ifc.mjs')) ? false : 'built without web-ifc';

test('under the systemd unit\'s system call filter, an import reads IFC, for which Node.js compiles code', {
    skip: skip || unfiltered || noIfc,
}, () => inFolder((folder) => {
    const file = join(folder, 'house.ifc');
    writeFileSync(file, ifc());
    const { status, stdout, stderr } = spawnSync('tests/support/confined.py',
        [UNIT, join(BIN, 'plantcast'), 'import', file, '-o', join(folder, 'plant')], { encoding: 'utf8', timeout: 120000 });
    assert.equal(status, 0, stderr);
    assert.match(stdout, /3 elements with a shape, 0 lost/);
}));

test('under the systemd unit\'s system call filter, the daemon draws with llvmpipe, streams and records', {
    skip: skip || unfiltered,
}, async (t) => {
    const plant = await TinyPlant.create();
    t.after(() => plant.destroy());
    assert.equal(plant.prepare().code, 0);
    plant.disown();
    plant.confine('tests/support/confined.py', UNIT);
    await plant.startDaemon('--gl', 'egl-surfaceless');
    assert.match(readFileSync(`/proc/${plant.daemon.child.pid}/status`, 'utf8'), /^Seccomp:\t2$/m);
    const client = await PlainClient.open(plant.port);
    await client.hello({ codecs: ['h264', 'jpeg'] });
    const frame = await client.frameWhere('a frame', (f) => f.payload.length > 0);
    assert.deepEqual([frame.full_width, frame.full_height], [320, 180]);
    client.say({ type: 'params', seq: 1, baseline: 'now' });
    await client.text('params');
    // sends the result of a loop check (comparison of a displayed value with the instrument); the daemon must write and
    // sync it to disk under the unit's restrictions
    client.say({ type: 'prove', seq: 1, tag: 'TI-1', expected: 1, tolerance: 1, fail: true });
    const proved = await client.text('proved');
    assert.equal(proved.kept, true, plant.daemon.said);
    client.close();
    assert.equal((await get(plant.port, '/snapshot.png?width=320&height=200')).status, 200);
    assert.deepEqual(await plant.daemon.stop(), { code: 0, signal: null }, plant.daemon.said);
    assert.doesNotMatch(plant.daemon.said, /not permitted|insecure memory/);
});
