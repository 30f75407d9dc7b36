// SPDX-License-Identifier: GPL-3.0-or-later
// Measures how many bytes the page transfers and how soon it shows the plant. Also tests the parts of the page that are loaded
// on first use.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { land, openPage, PHONE, shoot, waitForHealth, waitForPicture, withPage } from '../support/browser.mjs';
import { startAlarmed } from '../support/panels.mjs';
import { promise } from '../support/promise.mjs';
import { sweep } from '../support/sweep.mjs';
import { notBuilt } from '../support/tiny_plant.mjs';
import { becomes } from '../support/until.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
// limits of the first load in compressed bytes: desk: with a mouse; touch: the same plus the code for touch; warp: the code
// that redraws a picture for another camera. QUIET_MS: time without requests after which the load counts as finished
const MOST_BYTES = { desk: 70000, touch: 95000, warp: 15000 }, MOST_REQUESTS = 30, QUIET_MS = 1500;
const source = readFileSync(new URL('../../../clients/web/app/lazy_modules.js', import.meta.url), 'utf8');
const PARTS = [...source.matchAll(/^    (\w+): \{ file:/gm)].map(([, name]) => name);
const kB = (bytes) => `${(bytes / 1000).toFixed(1)} kB`;
let plant, url;

before(async () => {
    if (!options.skip)
        [plant, url] = await startAlarmed();
});
after(() => plant?.destroy());

// Records when a picture was first on the screen, in milliseconds after the page was requested.
const watchFirst = () => {
    new MutationObserver((_, observer) => {
        if (!document.getElementById('waiting')?.hidden)
            return;
        globalThis.firstPictureMs = performance.now();
        observer.disconnect();
    }).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ['hidden'] });
};

// Opens the page. Returns what openPage() returns, the list of all answers, and fetched(), which returns [[path, bytes on the
// wire], ...] with one entry per file; files below /vendor/ are not counted.
async function openCounted(address, screen, before = null) {
    const answers = [];
    const browser = await openPage(address, screen, before, (page) => page.on('response', (answer) => answers.push(answer)));
    const bytes = async (answer) => [new URL(answer.url()).pathname, Number(await answer.headerValue('content-length'))];
    const counts = ([path]) => !path.startsWith('/vendor/');
    const fetched = async () => [...new Map((await Promise.all(answers.map(bytes))).filter(counts))]; // each file once
    return { ...browser, answers, fetched };
}
const sum = (files) => files.reduce((all, [, bytes]) => all + bytes, 0);

// Waits until the page has made no request for QUIET_MS.
async function calm(page, browser) {
    for (let before = -1, now = 0; now !== before;) {
        before = now;
        await page.waitForTimeout(QUIET_MS);
        now = (await browser.fetched()).length;
    }
}

const HAND = /\/(camera_controller|warp|warp_worker)\.js$/; // files that follow a hand
const PAGES = [['English', 'en'], ['Korean on a phone', 'ko', PHONE], ...sweep([['German', 'de'], ['Korean', 'ko']], [])];
for (const [name, language, screen] of PAGES) {
    const most = screen === PHONE ? MOST_BYTES.touch : MOST_BYTES.desk;
    test(`a page in ${name} loads at most ${kB(most)} in ${MOST_REQUESTS} requests to show the plant`, options, async (t) => {
        const browser = await openCounted(`${url}?lang=${language}`, screen, watchFirst), { page } = browser;
        t.after(() => browser.close());
        await waitForPicture(page);
        await waitForHealth(page, 'live');
        // waits for the watchdog's canvas, which appears 5 s after the start
        await page.locator('canvas.watchdog.watches').waitFor({ state: 'attached' });
        if (screen === PHONE)
            await page.waitForFunction(() => globalThis.plantcast.modules.there('warp'));
        await calm(page, browser);
        const files = await browser.fetched(), requests = browser.answers.map((answer) => `${answer.status()} ${answer.url()}`);
        assert.deepEqual(requests.filter((text) => !text.startsWith('200')), []);
        assert.ok(requests.length <= MOST_REQUESTS, requests.join('\n'));
        assert.equal(files.filter(([path]) => path.includes('watchdog')).length, 3, 'module, words and worker are loaded');
        t.diagnostic(`${kB(sum(files))} in ${files.length} files; first picture after ` +
            `${(await page.evaluate(() => globalThis.firstPictureMs)).toFixed(0)} ms`);
        assert.ok(sum(files) <= most, files.sort((a, b) => b[1] - a[1]).map((file) => file.join(' ')).join('\n'));
        const hand = files.filter(([path]) => HAND.test(path));
        assert.equal(hand.length, screen === PHONE ? 3 : 0);
        if (screen !== PHONE) {
            await page.mouse.move(400, 300);
            await becomes(async () => {
                hand.splice(0, hand.length, ...(await browser.fetched()).filter(([path]) => HAND.test(path)));
                return hand.length;
            }, 3, 'a movement of the mouse loads the code that moves the picture', 30);
        }
        const warp = hand.filter(([path]) => path.includes('warp'));
        t.diagnostic(`${kB(sum(hand))} follow a hand, ${kB(sum(warp))} of them move the picture`);
        assert.ok(sum(warp) <= MOST_BYTES.warp, warp.join('\n'));
        assert.deepEqual(browser.errors, []);
    });
}

const DESK = { viewport: { width: 1024, height: 640 } };
const onDesk = (f, arrange) => withPage(`${url}?lang=en`, DESK, async (page) => {
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    await f(page);
}, null, arrange);
const press = async (page, key) => {
    await page.locator('#viewport').focus();
    await page.keyboard.press(key);
};
const isSaid = (page) => page.locator('#toast', { hasText: 'could not be loaded' }).waitFor();

test('a part of the page that cannot be loaded says so, and opens by itself once it can be loaded', options, async () => {
    // [key that opens a part, a file that the part loads, selector of the opened part]. A file must not be loaded by an earlier
    // part of this list, since each file is blocked only while its own part is tested.
    const parts = [['m', 'app/help/timings.css', '#timings'], ['y', 'core/history.js', '#timeline'],
        ['p', 'app/picture/picture.html', '#picture-panel.open'], ['v', 'app/views/views.js', '#views.open']];
    const words = [['v', 'words/lazy.en.js', '#views.open']]; // the file that contains the texts of all lazily loaded parts
    const away = (page, file) => page.route(`**/${file}*`, (route) => route.abort());
    for (const all of [parts, words])
        await onDesk(async (page) => {
            await page.waitForFunction(() => globalThis.plantcast.session.recorded);
            for (const [key, file, opened] of all) {
                await page.evaluate(() => { document.getElementById('toast').hidden = true; }); // hides the previous part's message
                await away(page, file);
                await press(page, key);
                await isSaid(page);
                assert.equal(await page.locator(opened).isVisible(), false, file);
                await press(page, key); // while the file is missing, a second press of the key must try again instead of closing the part
                await page.unroute(`**/${file}*`);
                await page.locator(opened).waitFor();
                await page.waitForFunction(() => globalThis.plantcast.session.picture); // the page still works
            }
        // blocks the file with the texts before the page opens, because the page loads it early if an alarm ring appears
        }, (page) => all === words && away(page, all[0][1]));
});

test('no part of the page shows text before its texts are loaded', options, () => {
    const warnings = [];
    return onDesk(async (page) => {
        page.on('console', (message) => warnings.push(message.text()));
        await page.evaluate((names) => Promise.all(names.map((name) => globalThis.plantcast.modules.prepare(name))), PARTS);
        assert.deepEqual(warnings.filter((text) => text.includes('no words')), []);
    }, (page) => page.route('**/words/lazy.en.js', async (route) => {
        await new Promise((done) => setTimeout(done, 500));
        await route.continue();
    }));
});

test('a panel that the user gave up waiting for does not open when it arrives late', options, () => onDesk(async (page) => {
    await page.route('**/app/views/views.js*', (route) => route.abort());
    await press(page, 'v');
    await isSaid(page);
    await press(page, 'Escape');
    await page.unroute('**/app/views/views.js*');
    await page.waitForFunction(() => globalThis.plantcast.modules.there('views'));
    assert.equal(await page.locator('#views.open').isVisible(), false);
    await press(page, 'v');
    await page.locator('#views.open').waitFor();
}));

test('a part requested while the server is away loads by itself when the server returns', options, () => onDesk(async (page) => {
    await plant.daemon.stop('SIGKILL');
    await waitForHealth(page, 'lost');
    await page.locator('#alarm-strip').click();
    await isSaid(page);
    await shoot(page, 'part-failed');
    await plant.startDaemon('--port', String(plant.port));
    await waitForHealth(page, 'live');
    await page.locator('#alarms').waitFor();
}));

const eye = (page) => page.evaluate(() => globalThis.plantcast.session.camera.eye);
const waitForMove = (page, before, limit) => page.waitForFunction((was) =>
    globalThis.plantcast.session.camera.eye.some((m, i) => Math.abs(m - was[i]) > 0.01), before, limit);
const ELSEWHERE = { eye: [9, -14, 6], target: [0, 0, 0], up: [0, 0, 1], fov: 30 };
const isCameraControllerThere = (page) => page.evaluate(() => Boolean(globalThis.plantcast.cameraController));
const drag = async (page) => {
    const { x, y, width, height } = await page.locator('#viewport').boundingBox();
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + width / 2 + 90, y + height / 2, { steps: 3 });
    await page.mouse.up();
};

test('the first input by mouse, keys or buttons moves the camera, though the camera controller is still loading', options, async (t) => {
    const firsts = [
        async (page) => drag(page),
        async (page) => press(page, 'ArrowLeft'),
        // clicks `home`; the test has moved the camera elsewhere before, so that the click moves it
        async (page) => page.locator('#home').click(),
        async (page) => page.locator('#assets-list .asset').first().click(),
    ];
    for (const act of firsts)
        await onDesk(async (page) => {
            assert.equal(await isCameraControllerThere(page), false, 'the camera controller is not loaded before it is needed');
            await page.evaluate((camera) => globalThis.plantcast.session.setCamera(camera), ELSEWHERE);
            const began = performance.now();
            await act(page);
            // Repeats the action as a user would. The page drops input that has waited more than 2 s for code to load, which
            // can happen on a busy machine.
            while (!await waitForMove(page, ELSEWHERE.eye, { timeout: 10000 }).catch(() => null))
                await act(page);
            promise(t, 'until the camera moves', performance.now() - began, 5000);
        }, (page) => page.route(/core\/flight\.js|app\/rows\.js/, async (route) => {
            await new Promise((done) => setTimeout(done, 300));
            await route.continue();
        }));
});

test('a drag that began before the camera controller was loaded is followed, however long loading takes',
    options, () => onDesk(async (page) => {
    await page.evaluate((camera) => globalThis.plantcast.session.setCamera(camera), ELSEWHERE);
    const { x, y, width, height } = await page.locator('#viewport').boundingBox(), [left, top] = [x + width / 2, y + height / 2];
    await page.mouse.move(left, top);
    await page.mouse.down();
    await page.waitForTimeout(2500); // waits longer than the 2 s after which the page drops a click that waits for code
    await page.mouse.move(left + 90, top, { steps: 3 });
    assert.equal(await isCameraControllerThere(page), false);
    assert.deepEqual(await eye(page), ELSEWHERE.eye);
    await page.unroute('**/app/input/camera_controller.js*');
    await waitForMove(page, ELSEWHERE.eye);
    await page.mouse.up();
}, (page) => page.route('**/app/input/camera_controller.js*', (route) => route.abort())));

test('the page names the marker under the pointer, even if the pointer has not moved since', options, () => onDesk(async (page) => {
    await page.waitForFunction(() => globalThis.plantcast.overlay.markers.some(({ occluded }) => !occluded));
    await land(page); // waits until the camera stands still, and with it the marker over which the pointer is placed
    const marker = await page.evaluate(() => {
        const { x, y } = globalThis.plantcast.overlay.markers.find(({ occluded }) => !occluded);
        return [x, y];
    });
    const { x, y } = await page.locator('#viewport').boundingBox();
    await page.mouse.move(x + marker[0], y + marker[1]);
    await page.locator('#card').waitFor();
}, (page) => page.route('**/app/input/commands.js', async (route) => {
    await new Promise((done) => setTimeout(done, 500));
    await route.continue();
})));

test('input that the page cannot follow yet gets a message, and is followed once the controller is loaded',
    options, () => onDesk(async (page) => {
    const before = await eye(page);
    await drag(page);
    await isSaid(page);
    assert.deepEqual(await eye(page), before);
    await page.unroute('**/app/input/camera_controller.js*');
    await page.waitForFunction(() => globalThis.plantcast.cameraController);
    await drag(page);
    await waitForMove(page, before);
}, (page) => page.route('**/app/input/camera_controller.js*', (route) => route.abort())));

test('a page whose server changed version meanwhile reloads itself instead of mixing both versions', options, () => {
    let version = 'aaaaaaaaaaaa';
    const serve = (route) => route.fulfill({ contentType: 'text/javascript', body: `export const version = '${version}';\n` });
    return onDesk(async (page) => {
        await page.evaluate(() => globalThis.plantcast.session.setParams({ distance: 'euclidean' }));
        await page.waitForFunction(() => location.hash.includes('distance=euclidean'));
        await page.evaluate(() => { globalThis.isBefore = true; });
        version = 'bbbbbbbbbbbb';
        await press(page, 'v');
        await page.waitForFunction(() => !globalThis.isBefore && globalThis.plantcast?.session.picture);
        assert.equal(await page.evaluate(() => globalThis.plantcast.session.params.distance), 'euclidean',
            'the view is the same after the reload');
        await press(page, 'v');
        await page.locator('#views.open').waitFor();
    }, (page) => page.route('**/made/version.js', serve));
});
