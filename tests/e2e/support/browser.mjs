// SPDX-License-Identifier: GPL-3.0-or-later
// Debian's chromium, driven by playwright-core, and functions that read the page's state.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, mkdtempSync, readdirSync, rmSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after } from 'node:test';
import { BUILD } from './plant.mjs';
import { sweep } from './sweep.mjs';
import { BIN } from './tiny_plant.mjs';

// Loaded with require(), and only when a page is opened: for an import, node would scan the whole module for names, which takes
// 0.2 s of processor time.
const playwright = () => createRequire(import.meta.url)('playwright-core');
const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
// Chromium without windows and menus, whose processes take four times as long to start as an empty page. `make test-long` uses
// the full browser.
const SHELL = '/usr/bin/chromium-headless-shell';
const HEADLESS = sweep(CHROMIUM, existsSync(SHELL) && !process.env.CHROMIUM ? SHELL : CHROMIUM);
const QUIET = [
    '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update',
    '--disable-sync', '--host-resolver-rules=MAP plant.example 127.0.0.1', // maps the host name plant.example to the loopback address
];
const PATIENCE_MS = 120000; // maximum time that a test waits for anything on a page, long enough for a very busy machine
export const SCREENSHOTS = join(BUILD, 'screenshots');
// Screens of tests have one device pixel per CSS pixel: layout depends on CSS pixels alone, and fewer device pixels make
// pictures cheaper. With `make test-long`, and in tests that pass `...SHARP`, screens have two.
export const SHARP = { deviceScaleFactor: 2 };
const DENSITY = sweep(SHARP, { deviceScaleFactor: 1 });
export const DESKTOP = { viewport: sweep({ width: 1920, height: 1080 }, { width: 1280, height: 800 }) };
export const TABLET = { viewport: { width: 1024, height: 768 }, ...DENSITY, hasTouch: true };
export const PHONE = { viewport: { width: 390, height: 844 }, ...DENSITY, hasTouch: true, isMobile: true };

// The camera jumps instead of flying, as for users who prefer reduced motion, because each frame of a flight costs the browser
// 15 ms of processor time. `make test-long` flies everywhere; tests of flights use `...FLYING`.
export const FLYING = { reducedMotion: 'no-preference' };
const MOTION = sweep(FLYING, { reducedMotion: 'reduce' });

// Browsers by their command-line arguments. All pages of a test program with the same arguments share one browser.
const browsers = new Map();

export async function browserWith(args) {
    const key = args.join(' ');
    if (!browsers.has(key))
        browsers.set(key, playwright().chromium.launch({ executablePath: HEADLESS, args: [...QUIET, ...args] }));
    return browsers.get(key);
}
after(async () => {
    await Promise.all([...open].map(report));
    await Promise.all([...browsers.values()].map(async (browser) => (await browser).close()));
});

// Pages that are open, each with its newest console lines and failed requests. A page that is still open at the end belongs to
// a failed test and is reported.
const open = new Map(), MAX_LINES = 30;

function record(page) {
    const lines = [], add = (line) => lines.push(line.slice(0, 300)) > MAX_LINES && lines.shift();
    open.set(page, lines);
    page.on('console', (message) => add(`console: ${message.text()}`));
    page.on('pageerror', (error) => add(`error: ${error}`));
    page.on('requestfailed', (request) => add(`request failed: ${request.url()}: ${request.failure()?.errorText}`));
    page.on('response', (response) => response.status() >= 400 && add(`${response.status()}: ${response.url()}`));
}

// Prints the state of a page that was left open, for the log of the failed test.
async function report([page, lines]) {
    const late = new Promise((go) => setTimeout(go, 2000, '(no answer)').unref());
    const text = await Promise.race([page.evaluate(() => document.body.innerText).catch(String), late]);
    console.log([`# left open: ${page.url()}`, ...lines, `text: ${text.replace(/\s+/g, ' ').slice(0, 1500)}`].join('\n#   '));
}

// A browser with a profile on disk: only with one can a page be installed or go full screen.
async function profileWith(args, shape) {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-chromium-'));
    const whole = { executablePath: CHROMIUM, ...shape, args: [...QUIET, ...args] };
    const context = await playwright().chromium.launchPersistentContext(folder, whole);
    // removes the profile only when this process exits, because a closed browser still writes to its profile for a while
    process.once('exit', () => {
        try {
            rmSync(folder, { recursive: true, force: true });
        } catch {
            console.log(`# ${folder} is left`);
        }
    });
    return context;
}

// Starts a browser that fills an X display of that size. clockMs: how far the browser's clock is set ahead.
export async function browserOn(display, url, width, height, clockMs = 0) {
    const args = ['--kiosk', '--window-position=0,0', `--window-size=${width},${height}`];
    const context = await profileWith(args, { headless: false, viewport: null, env: { ...process.env, DISPLAY: display } });
    context.setDefaultTimeout(PATIENCE_MS);
    const [page] = context.pages();
    await page.addInitScript((ms) => {
        const { now } = Date, { timeOrigin } = performance;
        Date.now = () => now.call(Date) + ms;
        Object.defineProperty(performance, 'timeOrigin', { value: timeOrigin + ms });
    }, clockMs);
    await page.goto(url);
    return { page, close: () => context.close() };
}

// Makes waitForFunction poll every 50 ms: playwright's default, every animation frame, makes the browser draw 60 times a
// second. For conditions that hold for less time, use { polling: 'raf' }.
function waitingSeldom(page) {
    const wait = page.waitForFunction.bind(page);
    page.waitForFunction = (f, arg, options) => wait(f, arg, { polling: 50, ...options });
    return page;
}

// Closed pages for reuse, by their options except the size. Reusing a page saves 0.2 s of processor time for a new process.
const closed = new Map();
const kindOf = ({ viewport, ...shape }) => JSON.stringify(shape);
const HEARD = ['pageerror', 'console', 'request', 'requestfailed', 'response', 'domcontentloaded', 'load', 'download', 'dialog'];

// Removes all state of a page before it is reused.
async function leave(page, kind) {
    const { origin } = new URL(page.url());
    HEARD.forEach((name) => page.removeAllListeners(name));
    await page.unrouteAll({ behavior: 'ignoreErrors' });
    await page.evaluate(() => sessionStorage.clear());
    await page.goto('about:blank');
    await page.mouse.move(-1, -1); // moves the pointer away, so that it is over nothing in the next page
    const client = await page.context().newCDPSession(page);
    await client.send('Storage.clearDataForOrigin', { origin, storageTypes: 'all' });
    await client.detach();
    closed.set(kind, [...closed.get(kind) ?? [], page]);
}

// Fails if a file of the page changed after the page was joined (deploy/join): the daemon would serve the older page.
function checkJoined() {
    const joined = join(BIN, 'web/app/first.js'), sources = resolve('clients/web');
    const changedIn = (folder) => readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
        const path = join(folder, entry.name);
        return entry.isDirectory() ? changedIn(path) : statSync(path).mtimeMs > statSync(joined).mtimeMs ? path : [];
    });
    const changed = existsSync(joined) && existsSync(sources) ? changedIn(sources) : [];
    if (changed.length > 0)
        throw new Error(`changed since the page was built, run \`make web\`: ${changed.join(', ')}`);
}
let isChecked = false;

// Opens a page without stored state. Returns { page, errors: script errors and requests to other origins, close }. before: a
// function that runs in the page before the page's scripts, or [function, argument]; arrange(page): sets up request routes and
// event handlers; screen.args: command-line arguments of the browser; screen.profile: use a separate browser with a profile on
// disk.
export async function openPage(url, screen = DESKTOP, before = null, arrange = null) {
    isChecked ||= checkJoined() ?? true;
    const { args = [], profile = false, ...own } = screen, shape = { ...MOTION, ...own }, kind = kindOf(shape);
    const isPlain = !before && !profile && args.length === 0, left = isPlain ? closed.get(kind)?.pop() : null;
    const context = left?.context() ?? await (profile ? profileWith(args, shape) : (await browserWith(args)).newContext(shape));
    context.setDefaultTimeout(PATIENCE_MS);
    const page = left ?? waitingSeldom(context.pages()[0] ?? await context.newPage());
    await left?.setViewportSize(shape.viewport);
    const errors = [];
    page.on('pageerror', (error) => errors.push(String(error)));
    page.on('console', (message) => {
        if (/Content Security Policy|Uncaught/.test(message.text()))
            errors.push(message.text());
    });
    page.on('request', (request) => {
        if (new URL(request.url()).host !== new URL(url).host && !request.url().startsWith('blob:'))
            errors.push(`asked ${request.url()}`);
    });
    record(page);
    if (before)
        await page.addInitScript(...[before].flat());
    await arrange?.(page);
    await page.goto(url);
    const close = () => open.delete(page) && (isPlain ? leave(page, kind).catch(() => context.close()) : context.close());
    return { page, errors, close };
}

// Opens a page as openPage() does, calls use(page, what openPage() returns), and closes the page. Fails if the page had an error.
export async function withPage(url, screen, use, ...more) {
    const opened = await openPage(url, screen, ...more);
    try {
        await use(opened.page, opened);
        assert.deepEqual(opened.errors, []);
    } finally {
        await opened.close();
    }
}

// Resizes the window, and waits for the style sheets of narrow screens and phones, which the page loads when it first needs
// them.
export async function resize(page, viewport) {
    await page.setViewportSize(viewport);
    await page.waitForFunction(async ({ width, height }) => {
        const { phone } = await import('/app/common/dom.js'), narrow = matchMedia('(max-width: 1023px)');
        const has = (name) => [...document.styleSheets].some(({ href }) => href?.endsWith(`/${name}.css`));
        return matchMedia(`(width: ${width}px) and (height: ${height}px)`).matches && (!narrow.matches || has('narrow')) &&
            (!phone.matches || has('sheet'));
    }, viewport);
}

// Run in a page before its scripts: keeps the page's media queries with their last results, for pixelRatioOf().
export function keepMediaQueries() {
    const { matchMedia } = window;
    globalThis.mediaQueries = new Map();
    window.matchMedia = (text) => {
        const query = matchMedia.call(window, text);
        globalThis.mediaQueries.set(query, query.matches);
        return query;
    };
}

// Returns a function that changes the pixel ratio, but not the window's size in CSS pixels, as when the window moves to another display.
// Chromium changes the results of media queries, but sends no event if the ratio is emulated, so the function sends the events.
export async function pixelRatioOf(page) {
    const client = await page.context().newCDPSession(page);
    return async (deviceScaleFactor) => {
        await client.send('Emulation.setDeviceMetricsOverride', { ...page.viewportSize(), deviceScaleFactor, mobile: false });
        await page.evaluate(() => {
            for (const [query, was] of [...globalThis.mediaQueries]) {
                globalThis.mediaQueries.set(query, query.matches);
                if (query.matches !== was)
                    query.dispatchEvent(new MediaQueryListEvent('change', { matches: query.matches, media: query.media }));
            }
        });
    };
}

// true: take screenshots. Only `make test-long` and PLANTCAST_SHOTS=1 set it, because they take longer than the tests
// themselves.
export const SHOOTS = sweep(true, process.env.PLANTCAST_SHOTS === '1');

export async function shoot(page, name) {
    if (!SHOOTS)
        return;
    mkdirSync(SCREENSHOTS, { recursive: true });
    await page.screenshot({ path: join(SCREENSHOTS, `${name}.png`) });
}

export const waitForHealth = (page, kind, timeout = PATIENCE_MS) =>
    page.waitForFunction((k) => document.getElementById('health').dataset.kind === k, kind, { timeout });
export const waitForPicture = (page) => page.waitForFunction(() => globalThis.plantcast?.session.picture);

// Waits until the refined picture for the page's newest camera and parameters is on the screen. quietMs: also waits until that
// picture has not been replaced for this time, which requires frozen readings.
export async function settle(page, quietMs = 0) {
    try {
        await page.waitForFunction((quiet) => {
            const { session } = globalThis.plantcast;
            const { picture } = session;
            return picture && picture.still && picture.cameraSeq === session.cameraSeq && picture.paramsSeq === session.paramsSeq &&
                !session.cameraNews && performance.now() - picture.at >= quiet;
        }, quietMs, { polling: 100 });
    } catch (error) {
        const { session } = await page.evaluate(() => {
            const { picture, cameraSeq, paramsSeq, cameraNews } = globalThis.plantcast.session;
            return { session: { picture: { ...picture, age: performance.now() - picture.at }, cameraSeq, paramsSeq, cameraNews } };
        });
        throw new Error(`no refined picture: ${JSON.stringify(session)}`, { cause: error });
    }
}

// Waits until the picture on the screen has the page's camera and size and no flight is under way, so that objects are where
// they are drawn.
export const land = (page) => page.waitForFunction(() => {
    const { cameraController, session, viewport } = globalThis.plantcast, { picture, size } = session, ratio = devicePixelRatio;
    return !cameraController?.fly && !session.cameraNews && picture.cameraSeq === session.cameraSeq &&
        Math.abs(size.width - viewport.width * ratio) <= 2 &&
        Math.abs(size.height - viewport.height * ratio) <= 2 &&
        picture.fullWidth === size.width && picture.fullHeight === size.height;
});

// Waits like land() and then like settle().
export async function arrive(page) {
    await land(page);
    await settle(page);
}

// Waits until a colour channel at a position of the picture differs by more than `least` from the earlier pixels `rgba`, as
// returned by grab().
export const waitForChange = (page, { x, y }, { width, rgba }, least) => page.waitForFunction(([px, py, was, step]) => {
    const now = document.getElementById('picture').getContext('2d').getImageData(px, py, 1, 1).data;
    return was.some((value, i) => Math.abs(value - now[i]) > step);
}, [x, y, [...rgba.subarray(4 * (y * width + x), 4 * (y * width + x) + 3)], least], { polling: 100 });

// Returns the camera and the parameters that the page requests from the server.
export const view = (page) => page.evaluate(() => {
    const { camera, params } = globalThis.plantcast.session;
    return { camera, params };
});

// Moves the page to an instant; null: back to the present.
export const travel = (page, us) => page.evaluate(async (to) => {
    const requests = await import('/core/requests.js');
    requests.travel(globalThis.plantcast.session, to);
}, us);

// Returns where a point of the plant appears on the page with the camera that the page requested: [x, y].
export const pageOf = (page, point) => page.evaluate(async (at) => {
    const { projector } = await import('/core/camera.js');
    const box = document.getElementById('viewport').getBoundingClientRect();
    const [x, y] = projector(globalThis.plantcast.session.camera, box.width, box.height)(at);
    return [box.left + x, box.top + y];
}, point);

// Returns where a point of the plant appears on the page in the picture on the screen: { x, y }.
export const drawnAt = (page, point) => page.evaluate(async (place) => {
    const [{ projector }, { halves }] = await Promise.all([import('/core/camera.js'), import('/core/split_view.js')]);
    const { session: { picture, params }, viewport } = globalThis.plantcast, box = viewport.element.getBoundingClientRect();
    const [x, y] = projector(picture.camera, halves(params, picture.shownWidth)[0].width, picture.fullHeight)(place);
    return { x: box.left + (x * box.width) / picture.shownWidth, y: box.top + (y * box.height) / picture.fullHeight };
}, point);

// Returns the point that a drag has grabbed, once the server has located it; null: none.
export async function held(page) {
    await page.waitForFunction(() => globalThis.plantcast.cameraController?.anchor?.sure);
    return page.evaluate(() => globalThis.plantcast.cameraController.anchor.point);
}

// Returns the shown group's markers: name, asset, position in pixels of the picture, visible or hidden.
export const markers = (page) => page.evaluate(() => {
    const { overlay, session } = globalThis.plantcast;
    const box = document.getElementById('viewport').getBoundingClientRect();
    const scale = session.picture.fullWidth / box.width;
    return overlay.markers.map(({ tag, x, y, occluded, reading }) => ({
        name: tag.name, asset: tag.asset, x: Math.round(x * scale), y: Math.round(y * scale), pageX: box.left + x, pageY: box.top + y,
        occluded, value: reading.value, quality: reading.quality,
    }));
});

// Returns the received picture, { width, height, rgba }, without markers, labels or panels.
export async function grab(page) {
    const { width, height, text } = await page.evaluate(() => {
        const canvas = document.getElementById('picture');
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        let binary = '';
        for (let i = 0; i < data.length; i += 32768)
            binary += String.fromCharCode(...data.subarray(i, i + 32768));
        return { width: canvas.width, height: canvas.height, text: btoa(binary) };
    });
    return { width, height, rgba: Buffer.from(text, 'base64') };
}

// Returns the pixels of a PNG file in the form that grab() returns: { width, height, rgba }.
export async function readPng(page, bytes) {
    const { width, height, text } = await page.evaluate(async (base64) => {
        const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], { type: 'image/png' }));
        const context = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
        context.drawImage(picture, 0, 0);
        const { data, width: w, height: h } = context.getImageData(0, 0, picture.width, picture.height);
        let binary = '';
        for (let i = 0; i < data.length; i += 32768)
            binary += String.fromCharCode(...data.subarray(i, i + 32768));
        return { width: w, height: h, text: btoa(binary) };
    }, bytes.toString('base64'));
    return { width, height, rgba: Buffer.from(text, 'base64') };
}
