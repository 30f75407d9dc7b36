// SPDX-License-Identifier: GPL-3.0-or-later
// Temporary folders of tests.
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

// folder of models and readings that are not in the repository; without it, tests that need it are skipped
export const DATA = fileURLToPath(new URL('../../../../shared/data', import.meta.url));

const make = () => mkdtempSync(join(tmpdir(), 'plantcast-test-')), remove = (folder) => rmSync(folder, { recursive: true, force: true });

// Calls f with a new folder and removes the folder afterwards. Returns the result of f.
export async function inFolder(f) {
    const folder = make();
    try {
        return await f(folder);
    } finally {
        remove(folder);
    }
}

// Returns a new folder that is removed when this program ends.
export function folderOfTests() {
    const folder = make();
    process.on('exit', () => remove(folder));
    return folder;
}
