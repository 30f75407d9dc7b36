// SPDX-License-Identifier: GPL-3.0-or-later
// The soak test of a whole host (make soak-host) must leave no process, mount or file behind: when it is ended by Ctrl-C, when
// it is killed, and when its start fails.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { chmodSync, mkdtempSync, readdirSync, readFileSync, readlinkSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { test } from 'node:test';
import { missingClocks } from './support/clocks.mjs';
import { missingHaproxy } from './support/haproxy.mjs';
import { BIN, PROGRAMS } from './support/tiny_plant.mjs';
import { missingTwoCores, until } from './support/two_cores.mjs';

const options = { skip: missingTwoCores() || (missingHaproxy() ?? missingClocks() ?? false), timeout: 240000 };

// Returns the command lines of all processes that were started with this temporary folder or run in it (PostgreSQL overwrites
// its environment).
function programsOf(folder) {
    return readdirSync('/proc').filter((name) => /^\d+$/.test(name)).flatMap((pid) => {
        try {
            return readFileSync(`/proc/${pid}/environ`, 'utf8').split('\0').includes(`TMPDIR=${folder}`) ||
                readlinkSync(`/proc/${pid}/cwd`).startsWith(folder)
                ? [readFileSync(`/proc/${pid}/cmdline`, 'utf8').replaceAll('\0', ' ')] : [];
        } catch { // the process has ended
            return [];
        }
    });
}
const mountsOf = (folder) => readFileSync('/proc/mounts', 'utf8').split('\n').filter((line) => line.includes(folder));

// Starts the soak test as the Makefile does. It runs in its own process group, so that a signal to the group acts like Ctrl-C
// in a shell.
function soak(t, bin = BIN) {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-soak-')), { NODE_TEST_CONTEXT, ...env } = process.env;
    chmodSync(folder, 0o711); // lets PostgreSQL, which runs as another user, enter the folder
    const child = spawn('tests/long/contained', ['node', 'tests/long/host.mjs'], { detached: true, stdio: ['ignore', 'pipe', 'pipe'],
        env: { ...env, TMPDIR: folder, PLANTCAST_BIN: bin, MINUTES: '1' } });
    const run = { folder, child, said: '', ended: new Promise((done) => child.once('close', (code, signal) => done({ code, signal }))) };
    for (const pipe of [child.stdout, child.stderr])
        pipe.on('data', (chunk) => { run.said += chunk; });
    t.after(() => {
        try {
            process.kill(-child.pid, 'SIGKILL');
        } catch { /* the process has ended already */ }
        rmSync(folder, { recursive: true, force: true });
    });
    return run;
}
const runs = ({ folder }, pattern) => until(`${pattern}`, () => programsOf(folder).some((line) => pattern.test(line)));
async function leavesNothing({ folder, said }) {
    await until('the end of all programs', () => programsOf(folder).length === 0, 30, () => `${programsOf(folder).join('\n')}\n${said}`);
    assert.deepEqual(mountsOf(folder), []);
}

const CORES = /plantcastd .*--node two/;
for (const [signal, what, pattern] of [['SIGTERM', 'the database starts', /postgres -D/], ['SIGINT', 'both cores run', CORES],
    ['SIGKILL', 'both cores run', CORES]])
    test(`${signal} while ${what} leaves no program, mount or file of the soak test behind`, options, async (t) => {
        const run = soak(t);
        await runs(run, pattern);
        process.kill(-run.child.pid, signal);
        assert.notEqual((await run.ended).code, 0);
        await leavesNothing(run);
        if (signal !== 'SIGKILL')
            assert.deepEqual(readdirSync(run.folder), [], run.said);
    });

test('a soak test whose daemon fails at the start leaves nothing behind', options, async (t) => {
    const bin = mkdtempSync(join(tmpdir(), 'plantcast-bin-'));
    t.after(() => rmSync(bin, { recursive: true, force: true }));
    for (const name of PROGRAMS.filter((one) => one !== 'plantcastd'))
        symlinkSync(resolve(BIN, name), join(bin, name));
    writeFileSync(join(bin, 'plantcastd'), '#!/bin/sh\nexit 3\n');
    chmodSync(join(bin, 'plantcastd'), 0o755);
    const run = soak(t, bin);
    assert.notEqual((await run.ended).code, 0);
    await leavesNothing(run);
    assert.deepEqual(readdirSync(run.folder), [], run.said);
});
