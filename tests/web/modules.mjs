// SPDX-License-Identifier: GPL-3.0-or-later
// Lists the page's files, and the modules that a module of the page imports.
import { readdirSync, readFileSync } from 'node:fs';
import { posix } from 'node:path';

const WEB = new URL('../../clients/web/', import.meta.url);

// Returns the paths of all files in a folder of the page, including subfolders.
export const filesIn = (folder) => readdirSync(new URL(folder, WEB), { withFileTypes: true })
    .flatMap((entry) => (entry.isDirectory() ? filesIn(`${folder}/${entry.name}`) : `${folder}/${entry.name}`));

// Returns the paths of a module and of all its static imports.
export function graph(path, seen = new Set()) {
    if (seen.has(path))
        return seen;
    seen.add(path);
    for (const [, , other] of readFileSync(new URL(path, WEB), 'utf8').matchAll(/^(?:import|export) ([^;]*? from )?'([^']+)';/gm))
        graph(posix.join(posix.dirname(path), other), seen);
    return seen;
}
