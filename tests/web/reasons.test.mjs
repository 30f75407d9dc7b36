// SPDX-License-Identifier: GPL-3.0-or-later
// tests/support/reasons.py, which prints the reasons for failed tests at the end of a run: it must find them in the output of
// node and of the C tests.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';

const ASK = `import json, sys; sys.path.insert(0, "tests/support"); import reasons
lines = sys.stdin.read().splitlines()
found = [reasons.of_result(lines, i) for i, line in enumerate(lines) if line.lstrip().startswith("not ok")]
print(json.dumps(found or reasons.of_end(lines)))`;

function reasonsOf(input) {
    const { stdout, stderr } = spawnSync('/usr/bin/python3', ['-c', ASK], { input, encoding: 'utf8' });
    assert.equal(stderr, '');
    return JSON.parse(stdout);
}

const FAILING = `import assert from 'node:assert/strict';
import { test } from 'node:test';
const near = (a, b) => assert.ok(Math.abs(a - b) < 1, \`\${a} is not \${b}\`);
test('two things', () => assert.deepEqual({ a: 1, b: [1, 2], c: 'x', d: 'y' }, { a: 1, b: [1, 3], c: 'x', d: 'y' }));
test('by a helper', () => near(3, 5));
test('good', () => {});
test('outer', (t) => t.test('inner', () => { throw new Error('no answer\\nwithin 3 s'); }));
test('late', { timeout: 50 }, () => new Promise((done) => setTimeout(done, 300)));
`;

test('reasons.py extracts from node\'s output the error and the positions of helper and test', () => {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-reasons-')), file = join(folder, 'failing.mjs');
    writeFileSync(file, FAILING);
    // the inner test run must not inherit NODE_TEST_CONTEXT, with which it would report to this test's runner instead of
    // printing
    const { NODE_TEST_CONTEXT: _, ...env } = process.env;
    const { stdout } = spawnSync(process.execPath, ['--test', '--test-reporter=tap', file], { encoding: 'utf8', env });
    rmSync(folder, { recursive: true });
    const texts = reasonsOf(stdout).map((lines) => lines.join('\n'));
    const [things, helper, inner, , late] = texts;
    assert.match(things, /^Expected values .*equal:\n[+-] +[23]\n[+-] +[23]\nat \S*failing\.mjs:4:\d+$/);
    assert.match(helper, /^3 is not 5\nat \S*failing\.mjs:3:\d+ < \S*failing\.mjs:5:\d+$/);
    assert.match(inner, /^no answer\nwithin 3 s\nat \S*failing\.mjs:7:\d+/);
    assert.match(late, /^test timed out after 50ms/);
});

test('reasons.py extracts from a C test the failed check, its message, seed and position, and nothing of the next test', () => {
    const texts = reasonsOf(`1..3
# seed 12
ok 1 - good
# radius 3 m
not ok 2 - numbers
# 0x1 != 0x2
# tests/unit/x_test.c:7: error: Failure!
# of the next
ERROR: 5 of 6 are late
not ok 3 - told
# tests/unit/x_test.c:9: error: Failure!
# not ok - tests
`);
    assert.deepEqual(texts, [
        ['# 0x1 != 0x2', '# radius 3 m', '# seed 12', '# tests/unit/x_test.c:7: error: Failure!'],
        ['# of the next', 'ERROR: 5 of 6 are late', '# seed 12', '# tests/unit/x_test.c:9: error: Failure!'],
    ]);
});

test('reasons.py extracts from a crashed program the sanitizer\'s report, or its last words, shortened', () => {
    const found = reasonsOf(`1..2
ok 1 - a
==7==ERROR: AddressSanitizer: heap-use-after-free
    #0 main
SUMMARY: AddressSanitizer: main
fa fa
`);
    assert.deepEqual(found, ['==7==ERROR: AddressSanitizer: heap-use-after-free', 'SUMMARY: AddressSanitizer: main']);
    const last = reasonsOf(`a\nb\nc\nd\n\ne\n${'f'.repeat(500)}\n`);
    assert.deepEqual(last.slice(0, 4), ['b', 'c', 'd', 'e']);
    assert.ok(last.length === 5 && last[4].length < 200, last[4]);
});
