// SPDX-License-Identifier: GPL-3.0-or-later
// Runs all tests of the page's modules in one process, because starting node takes longer than most of the tests.
import { readdirSync } from 'node:fs';

for (const name of readdirSync(new URL('.', import.meta.url)).filter((file) => file.endsWith('.test.mjs')).sort())
    await import(`./${name}`);
