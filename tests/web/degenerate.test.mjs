// SPDX-License-Identifier: GPL-3.0-or-later
// Calls the pure functions of core/ and app/ with non-finite numbers, sizes of 0x0 and empty lists. Each must return, and
// functions that compute geometry must not return non-finite numbers. A wall display once hung because of a marker at NaN.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readdirSync } from 'node:fs';
import { test } from 'node:test';
import { CASES, forgotten, modules } from './degenerate_cases.mjs';
import { seed } from './random.mjs';

// time limit for all cases together, which normally take seconds: if it is exceeded, a function loops for ever
const PATIENCE_MS = 120000;
const MB = 512;
// Modules that are left out: those without a function that takes numbers, and those whose bad input warp.test.mjs and
// headset.test.mjs cover.
const TEXTS = ['depth_grid', 'headset_views', 'warp_mesh', 'warp_raster', 'alarm_actions', 'alarm_call', 'alarm_table', 'alarms',
    'asset_tree', 'blocked', 'connection', 'decode_queue', 'decoder_fallback', 'decoding', 'gpu', 'h264', 'handover', 'health', 'http',
    'keys', 'links', 'loop_check', 'matches', 'model', 'named_views', 'notes', 'people', 'quality', 'phrases', 'references', 'refusals',
    'requests', 'search', 'session', 'standby', 'wake', 'words'];

// Runs the cases from number `first` on in another process, until one loops or fails to return. Adds the faults to `wrong`.
// Returns the number of the case to go on with.
function runFrom(first, seed, wrong) {
    const args = [`--max-old-space-size=${MB}`, new URL('degenerate.mjs', import.meta.url).pathname, String(first), String(seed)];
    const options = { timeout: PATIENCE_MS, killSignal: 'SIGKILL', encoding: 'utf8' };
    const { status, stdout, stderr } = spawnSync(process.execPath, args, options);
    const lines = stdout.trim().split('\n'), at = Number(lines.findLast((line) => line.startsWith('case ')).slice(5));
    wrong.push(...lines.filter((line) => !line.startsWith('case ')));
    if (status !== 0)
        wrong.push(`${CASES[at].name} does not return: ${/heap/.test(stderr) ? 'the memory is full' : stderr || 'time is up'}`);
    return at + 1;
}

test('with degenerate input every pure function returns, and geometry is finite', () => {
    const wrong = [];
    for (let next = 0; next < CASES.length;)
        next = runFrom(next, seed, wrong);
    assert.equal(wrong.length, 0, wrong.join('\n'));
});

test('every module and function is covered by this test', () => {
    const all = readdirSync(new URL('../../clients/web/core/', import.meta.url)).filter((file) => file.endsWith('.js'))
        .map((file) => file.slice(0, -3));
    assert.deepEqual(all.filter((name) => !modules.includes(name) && !TEXTS.includes(name)), []);
    assert.deepEqual(forgotten, []);
});
