// SPDX-License-Identifier: GPL-3.0-or-later
// What the compiler and the linker put between a fault of ours and whoever finds it: in every program, as it is installed.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import { test } from 'node:test';
import { BIN, missing, PROGRAMS } from './support/tiny_plant.mjs';

const absent = missing();
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : false;
const read = (program, ...what) => spawnSync('readelf', ['-W', ...what, join(BIN, program)], { encoding: 'utf8' }).stdout;

test('programs have PIE, full RELRO, stack protectors and checked library calls', { skip }, () => {
    for (const program of PROGRAMS) {
        assert.match(read(program, '-h'), /Type: +DYN/, `${program}: position-independent`);
        assert.match(read(program, '-l'), /GNU_RELRO/, `${program}: RELRO`);
        assert.match(read(program, '-d'), /FLAGS_1.*NOW.*PIE/, `${program}: bound at the start`);
        const symbols = read(program, '--dyn-syms');
        assert.match(symbols, /__stack_chk_fail/, `${program}: stack protector`);
        assert.match(symbols, /__(mem|str|v?s?n?printf|fread|read)\w*_chk/, `${program}: _FORTIFY_SOURCE`);
        const stack = read(program, '-l').match(/GNU_STACK.*/)[0];
        assert.match(stack, / RW /, `${program}: no program in its stack`);
    }
});
