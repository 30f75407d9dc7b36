// SPDX-License-Identifier: GPL-3.0-or-later
// Links all modules of the page without running them. Fails if a module imports a name that the other module does not export.
// usage: node --experimental-vm-modules link_modules.mjs
import { readFileSync } from 'node:fs';
import { SourceTextModule } from 'node:vm';
import { filesIn } from './modules.mjs';

const WEB = new URL('../../clients/web/', import.meta.url), modules = new Map();

function moduleAt(url) {
    if (!modules.has(url.href))
        modules.set(url.href, new SourceTextModule(readFileSync(url, 'utf8'), { identifier: url.href }));
    return modules.get(url.href);
}

const files = ['app', 'core', 'handover', 'keeper', 'wall', 'words'].flatMap(filesIn).filter((name) => name.endsWith('.js'));
const lazy = readFileSync(new URL('app/lazy_modules.js', WEB), 'utf8').matchAll(/\{ file: '([^']+)', type: '([^']+)'/g);
const lines = [...files.map((name) => `import './${name}';`),
    ...[...lazy].map(([, file, type], i) => `import { ${type} as lazy${i} } from './app/${file}.js';`)];
const all = new SourceTextModule(lines.join('\n'), { identifier: new URL('all.js', WEB).href });
await all.link((path, { identifier }) => moduleAt(new URL(path, identifier)));
console.log(lines.length);
