// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the tests of all modules in one program, because starting node costs more than most of the tests.
import { readdirSync } from 'node:fs';

for (const name of readdirSync(new URL('.', import.meta.url)).filter((file) => file.endsWith('.test.mjs')).sort())
    await import(`./${name}`);
