// SPDX-License-Identifier: GPL-3.0-or-later
// The page's style sheets contain no rule for elements that the page never has.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { filesIn } from './modules.mjs';

const WEB = new URL('../../clients/web/', import.meta.url);
const read = (name) => readFileSync(new URL(name, WEB), 'utf8');
const files = ['app', 'core', 'wall', 'handover'].flatMap(filesIn);
const pages = ['index.html', 'wall.html', 'handover.html'].map(read);
const page = pages.join('\n') + files.filter((name) => /\.(js|html)$/.test(name)).map(read).join('\n');
const words = new Set(page.match(/[\w-]+/g));
// numbered class names such as p1, p2, ..., which the page makes from a letter and a number
const isNumbered = (name) => /^[a-z]\d$/.test(name) && page.includes(` ${name[0]}\${`);
const isTheChartsOwn = (name) => name.startsWith('u-');

// Returns the selectors of a style sheet without the declarations, including those of rules inside @media and the like.
const selectors = (sheet) => [...sheet.replace(/\/\*.*?\*\//gs, '').matchAll(/([^{};]+)\{/g)].map(([, text]) => text.trim())
    .filter((text) => !text.startsWith('@'));

test('every class and id in a style sheet occurs in the page', () => {
    const unknown = [], known = [];
    for (const file of files.filter((name) => name.endsWith('.css'))) {
        for (const selector of selectors(read(file))) {
            for (const [, name] of selector.replace(/"[^"]*"/g, '').matchAll(/[.#]([a-zA-Z][\w-]*)/g))
                (words.has(name) || isNumbered(name) || isTheChartsOwn(name) ? known : unknown).push(`${file}: ${name}`);
        }
    }
    assert.deepEqual(unknown, []);
    assert.ok(known.length > 500, `only ${known.length} names were found`);
});
