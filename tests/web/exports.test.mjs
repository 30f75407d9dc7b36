// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that every name that a module of the page imports is exported. Otherwise lazily loaded modules would fail only when a
// user opens them.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

test('every imported name is exported', () => {
    const args = ['--experimental-vm-modules', '--no-warnings', fileURLToPath(new URL('link_modules.mjs', import.meta.url))];
    const { status, stdout, stderr } = spawnSync(process.execPath, args, { encoding: 'utf8' });
    assert.equal(status, 0, stderr);
    assert.ok(Number(stdout) > 200, `only ${stdout} modules were checked`);
});
