// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon serves the page's scripts without comment lines and indentation (server/net/http/site.c). It must not change
// template literals, which it finds by their backticks. So every backtick must belong to a template literal, and no line within
// one may begin like a comment.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { filesIn } from './modules.mjs';

const WEB = new URL('../../clients/web/', import.meta.url);

test('no line of a template literal begins like a comment', () => {
    for (const folder of ['app', 'core', 'words']) {
        for (const name of filesIn(folder).filter((one) => one.endsWith('.js'))) {
            let open = false;
            readFileSync(new URL(name, WEB), 'utf8').split('\n').forEach((line, i) => {
                const comments = /^ *\/\//.test(line);
                assert.ok(!(open && comments), `${name}:${i + 1}: a line of a text begins with //`);
                if (!comments && (line.replace(/\\`/g, '').match(/`/g) ?? []).length % 2 === 1)
                    open = !open;
            });
            assert.ok(!open, `${name}: an odd number of backticks`);
        }
    }
});
