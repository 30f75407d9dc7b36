// SPDX-License-Identifier: GPL-3.0-or-later
// What the page weighs, how soon it shows the plant, and its parts that are loaded when they are first used.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { openPage, PHONE, shoot, waitForHealth, waitForPicture } from './support/browser.mjs';
import { startAlarmed } from './support/panels.mjs';
import { missing } from './support/tiny_plant.mjs';

const absent = missing();
const options = { skip: absent.length > 0 ? `not built: ${absent.join(', ')}` : false, timeout: 200000 };
const MOST_BYTES = 265000, QUIET_MS = 1500;
const kB = (bytes) => `${(bytes / 1000).toFixed(1)} kB`;
let plant, url;

before(async () => {
    if (!options.skip)
        [plant, url] = await startAlarmed();
});
after(() => plant?.destroy());

// When a picture was first on the screen, in milliseconds since the page was asked for.
const watchFirst = () => {
    new MutationObserver((_, observer) => {
        if (!document.getElementById('waiting')?.hidden)
            return;
        globalThis.firstPictureMs = performance.now();
        observer.disconnect();
    }).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ['hidden'] });
};

// { page, errors, close, fetched(): [[path, bytes], ...] of files that are ours, each as often as it was asked for }.
async function openCounted(address, screen, before = null) {
    const answers = [];
    const browser = await openPage(address, screen, before, (page) => page.on('response', (answer) => answers.push(answer)));
    const bytes = async (answer) => [new URL(answer.url()).pathname, (await answer.body()).length];
    return { ...browser, fetched: async () => (await Promise.all(answers.map(bytes))).filter(([path]) => !path.startsWith('/vendor/')) };
}
const sum = (files) => files.reduce((all, [, bytes]) => all + bytes, 0);

// Nothing has been asked for any more for a while.
async function calm(page, browser) {
    for (let before = -1, now = 0; now !== before;) {
        before = now;
        await page.waitForTimeout(QUIET_MS);
        now = (await browser.fetched()).length;
    }
}

for (const [name, query, screen] of [['English', '?lang=en', undefined], ['German', '?lang=de', undefined], ['Korean', '?lang=ko', PHONE]])
    test(`a page in ${name} that shows the plant has loaded at most ${kB(MOST_BYTES)}`, options, async (t) => {
        const browser = await openCounted(url + query, screen, watchFirst), { page } = browser;
        try {
            await waitForPicture(page);
            await waitForHealth(page, 'live');
            await calm(page, browser);
            const files = await browser.fetched();
            t.diagnostic(`${kB(sum(files))} in ${files.length} files; first picture after ` +
                `${(await page.evaluate(() => globalThis.firstPictureMs)).toFixed(0)} ms`);
            assert.ok(sum(files) <= MOST_BYTES, files.sort((a, b) => b[1] - a[1]).map((file) => file.join(' ')).join('\n'));
            assert.deepEqual(browser.errors, []);
        } finally {
            await browser.close();
        }
    });

// A page of its own that shows the plant.
async function withPage(f, arrange) {
    const browser = await openPage(`${url}?lang=en`, undefined, null, arrange);
    try {
        await waitForPicture(browser.page);
        await waitForHealth(browser.page, 'live');
        await f(browser.page);
        assert.deepEqual(browser.errors, []);
    } finally {
        await browser.close();
    }
}
const press = async (page, key) => {
    await page.locator('#viewport').focus();
    await page.keyboard.press(key);
};
const isSaid = (page) => page.locator('#toast', { hasText: 'could not be loaded' }).waitFor();

test('a part that cannot be loaded says so, and comes when it is asked for again', options, async () => {
    for (const [key, file, opened] of [['v', 'app/views.js', '#views.open'], ['p', 'app/picture.html', '#picture-panel.open'],
        ['m', 'app/timings.css', '#timings'], ['y', 'core/history.js', '#timeline']])
        await withPage(async (page) => {
            await page.waitForFunction(() => globalThis.plantcast.session.recorded);
            await page.route(`**/${file}*`, (route) => route.abort());
            await press(page, key);
            await isSaid(page);
            assert.equal(await page.locator(opened).isVisible(), false, file);
            await page.unroute(`**/${file}*`);
            await press(page, key);
            await page.locator(opened).waitFor();
            await page.waitForFunction(() => globalThis.plantcast.session.picture); // the page goes on
        });
});

test('the server goes away, a part is asked for; it returns, and the part comes', options, () => withPage(async (page) => {
    await plant.daemon.stop('SIGKILL');
    await waitForHealth(page, 'lost');
    await press(page, 'e');
    await isSaid(page);
    await shoot(page, 'part-failed');
    await plant.startDaemon('--port', String(plant.port));
    await waitForHealth(page, 'live');
    await press(page, 'e');
    await page.locator('#alarms').waitFor();
}));

test('a page whose server was another one meanwhile loads itself anew instead of mixing both', options, () => {
    let version = 'aaaaaaaaaaaa';
    const serve = (route) => route.fulfill({ contentType: 'text/javascript', body: `export const version = '${version}';\n` });
    return withPage(async (page) => {
        await page.evaluate(() => globalThis.plantcast.session.setParams({ distance: 'euclidean' }));
        await page.waitForFunction(() => location.hash.includes('distance=euclidean'));
        await page.evaluate(() => { globalThis.isBefore = true; });
        version = 'bbbbbbbbbbbb';
        await press(page, 'v');
        await page.waitForFunction(() => !globalThis.isBefore && globalThis.plantcast?.session.picture);
        assert.equal(await page.evaluate(() => globalThis.plantcast.session.params.distance), 'euclidean', 'the same view');
        await press(page, 'v');
        await page.locator('#views.open').waitFor();
    }, (page) => page.route('**/made/version.js', serve));
});
