// SPDX-License-Identifier: GPL-3.0-or-later
// The page as an installed app: its service worker caches the files of one version of the page for use without a network. A
// minimal web server of this test serves nothing but these files.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join } from 'node:path';
import { test } from 'node:test';
import { openPage, shoot } from './support/browser.mjs';
import { setUp } from './support/set_up.mjs';
import { BIN } from './support/tiny_plant.mjs';

const WEB = join(BIN, 'web'), VERSION = '/made/version.js';
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };
const options = { skip: existsSync(join(WEB, VERSION)) ? false : 'not built', timeout: 100000 };
let server, browser, page, version = 'aaaaaaaaaaaa';

function serve(request, response) {
    const path = new URL(request.url, 'http://localhost').pathname.replace(/\/$/, '/index.html'), file = join(WEB, path);
    if (!existsSync(file))
        return response.writeHead(404).end();
    response.writeHead(200, { 'content-type': TYPES[extname(file)] ?? 'application/octet-stream', 'cache-control': 'no-cache' });
    return response.end(path === VERSION ? `export const version = '${version}';\n` : readFileSync(file));
}

setUp(options.skip, async (own) => {
    server = own(createServer(serve).listen(0, '127.0.0.1'));
    await new Promise((done) => server.once('listening', done));
    browser = own(await openPage(`http://127.0.0.1:${server.address().port}/?lang=en`));
    page = browser.page;
    await page.waitForFunction(() => globalThis.plantcast);
    await page.evaluate(async () => { // registers the service worker, as a page loaded over https does
        await navigator.serviceWorker.register('service.js');
        await navigator.serviceWorker.ready;
    });
    await page.waitForFunction(() => navigator.serviceWorker.controller);
});

// Returns { version: [path, ...] }: the cached files of each version of the page. Caches that do not belong to the page appear
// under their own names.
const kept = () => page.evaluate(async () => Object.fromEntries(await Promise.all((await caches.keys()).map(async (name) =>
    [name.replace('plantcast-', ''), (await (await caches.open(name)).keys()).map(({ url }) => new URL(url).pathname)]))));
const reload = async () => {
    await page.reload();
    await page.waitForFunction(() => globalThis.plantcast);
};
const open = async (key) => {
    await page.locator('#viewport').focus();
    await page.keyboard.press(key);
};

test('the service worker caches files as the page uses them, parts loaded later too', options, async () => {
    await reload();
    await open('v');
    await page.locator('#views.open').waitFor();
    const { [version]: files, ...others } = await kept();
    assert.deepEqual(others, {});
    for (const path of ['/', '/app/startup.js', '/app/main.js', '/app/style.css', '/words/en.js', '/app/views/views.js',
        '/app/views/views.html'])
        assert.ok(files.includes(path), path);
});

test('a new version of the page replaces all cached files of the old one', options, async () => {
    // Marks the new version as already loaded. The page may still ask for the version after its last part was loaded, and would
    // then reload itself at the same time as the test reloads it.
    await page.evaluate(() => sessionStorage.setItem('plantcast.renewed', 'bbbbbbbbbbbb'));
    version = 'bbbbbbbbbbbb';
    await page.evaluate(() => caches.open('foreign'));
    await reload();
    const { [version]: files, ...others } = await kept();
    assert.deepEqual(others, { foreign: [] }, 'caches that are not the page\'s own stay');
    assert.ok(files.includes('/app/main.js') && !files.includes('/app/views/views.js'),
        'the cache contains the files that were used, and no others');
});

test('a wall display without a network shows its name and since when it is offline', options, async () => {
    const display = await page.context().newPage();
    await display.goto(new URL('wall.html?wall=room&display=2&lang=en', page.url()).href);
    await display.waitForFunction(() => globalThis.wall);
    await page.context().setOffline(true);
    await display.reload();
    await display.locator('#lost', { hasText: /^No connection to the plant.*Display 2 of room, waiting since \d\d:\d\d:\d\d$/s })
        .waitFor();
    await shoot(display, 'wall-offline');
    await page.context().setOffline(false);
    await display.close();
});

test('the installed page opens without a network, and says what is missing', options, async () => {
    await open('v');
    await page.locator('#views.open').waitFor();
    server.closeAllConnections();
    await new Promise((done) => server.close(done));
    await reload();
    await page.waitForFunction(() => document.getElementById('health').dataset.kind === 'lost');
    assert.equal(await page.locator('#picture').isVisible(), false, 'no black picture is shown before the first picture');
    await open('v');
    await page.locator('#views.open').waitFor();
    await open('p');
    await page.locator('#toast', { hasText: 'could not be loaded' }).waitFor();
    await shoot(page, 'installed-offline');
    assert.deepEqual(browser.errors, []);
});
