// SPDX-License-Identifier: GPL-3.0-or-later
// What a module of the page loads together with itself.
import { readFileSync } from 'node:fs';
import { posix } from 'node:path';

const WEB = new URL('../../clients/web/', import.meta.url);

// Paths of a module and of all that it imports at once.
export function graph(path, seen = new Set()) {
    if (seen.has(path))
        return seen;
    seen.add(path);
    for (const [, , other] of readFileSync(new URL(path, WEB), 'utf8').matchAll(/^(?:import|export) ([^;]*? from )?'([^']+)';/gm))
        graph(posix.join(posix.dirname(path), other), seen);
    return seen;
}
