// SPDX-License-Identifier: GPL-3.0-or-later
// The files that the page fetches first: everything that the first picture needs must be requested at once, and must be small.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { filesIn, graph } from './modules.mjs';

const WEB = new URL('../../clients/web/', import.meta.url);
const read = (path) => readFileSync(new URL(path, WEB), 'utf8');
const page = read('index.html');
const all = (pattern) => [...page.matchAll(pattern)].map(([, path]) => path);
const sheets = all(/<link rel="stylesheet" href="([^"]+)"/g);
const MOST_BYTES = 100000;

// Returns a file about as the daemon serves it: scripts lose their comment lines and indentation (server/net/http/site.c).
const served = (path) => (path.endsWith('.js') ? read(path).replace(/(?<=\n) *(\/\/.*)?/g, '') : read(path));
const weigh = (files) => files.reduce((sum, path) => sum + Buffer.byteLength(served(path)), 0);
const ours = (language) => ['index.html', `words/${language}.js`, `words/lazy.${language}.js`, ...['app', 'core'].flatMap((folder) =>
    filesIn(folder))];

test('the page itself preloads every module that the first picture needs, and main.js', () => {
    const needed = [...graph('app/startup.js'), 'app/main.js'];
    assert.deepEqual(all(/<link rel="modulepreload" href="([^"]+)"/g).sort(), needed.sort());
});

test('each worker is in a file that the build bundles completely (deploy/join)', () => {
    const workers = ['app', 'core', 'wall'].flatMap(filesIn).filter((path) => path.endsWith('.js'))
        .flatMap((path) => [...read(path).matchAll(/new (?:Shared)?Worker\(([^)]*)\)/g)].map(([, file]) => file));
    assert.ok(workers.length >= 2);
    assert.deepEqual(workers.filter((file) => !/_worker\.js'/.test(file)), []);
});

test('the page\'s first files are at most 100 kB in each language', (t) => {
    for (const language of ['en', 'de', 'ko']) {
        const files = ['index.html', 'app/open.js', ...sheets, ...graph('app/startup.js'), `words/${language}.js`];
        const bytes = weigh(files);
        t.diagnostic(`${language}: ${bytes} bytes in ${files.length} files, of ${weigh(ours(language))} that there are in this language`);
        assert.ok(bytes <= MOST_BYTES, `the first files have ${bytes} bytes`);
    }
});
