// SPDX-License-Identifier: GPL-3.0-or-later
// The source checks (tests/style, tests/layers, tests/maps) must also read files that git does not track yet, but not files
// that git ignores.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';

test('tests/style, tests/layers and tests/maps also check files that git does not track yet', () => {
    const tree = mkdtempSync(join(tmpdir(), 'plantcast-checks-'));
    const write = (path, text) => {
        mkdirSync(join(tree, path, '..'), { recursive: true });
        writeFileSync(join(tree, path), text);
    };
    const said = (check) => spawnSync(join(tree, check), { encoding: 'utf8' }).stdout;
    try {
        for (const check of ['tests/style', 'tests/layers', 'tests/maps'])
            cpSync(check, join(tree, check), { recursive: true });
        assert.equal(spawnSync('git', ['init', '-q', tree]).status, 0);
        write('.gitignore', '/build/\n');
        write('build/made.c', '');
        write('server/value/new.c', '#include <GL/gl.h>\nstruct search {\n};\n');
        write('tests/unit/new_test.c', 'struct search {\n};\n');
        write('server/value/README.md', 'Begin with `no_such_name`, [a file](gone.md), [no](#gone), [a](#a).\n\n## A\n');
        assert.match(said('tests/style'), /^server\/value\/new\.c:1: no licence line$/m);
        assert.match(said('tests/layers'), /^server\/value\/new\.c: only gpu\/ and render\/ include GL$/m);
        assert.match(said('tests/layers'), /^search is defined in 2 files: server\/value\/new\.c, tests\/unit\/new_test\.c$/m);
        assert.match(said('tests/maps'), /^server\/value\/README\.md: nothing is called `no_such_name`$/m);
        assert.match(said('tests/maps'), /the link gone\.md leads to no file\n.*the link #gone leads to no heading\n(?!.*#a leads)/);
        assert.doesNotMatch(said('tests/style'), /made\.c/);
    } finally {
        rmSync(tree, { recursive: true });
    }
});
