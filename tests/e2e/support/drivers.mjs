// SPDX-License-Identifier: GPL-3.0-or-later
// Drives Chromium (playwright-core), Debian's Firefox (WebDriver BiDi) or WebKitGTK (WebDriver) with the same few functions.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';
import { freePort } from './ports.mjs';
import { until } from './until.mjs';
import { missingDisplay, startDisplay } from './x_display.mjs';

const require = createRequire(import.meta.url);
const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium', FIREFOX = '/usr/bin/firefox-esr', DRIVER = '/usr/bin/WebKitWebDriver';
const MINI_BROWSER = '/usr/lib/x86_64-linux-gnu/webkit2gtk-4.1/MiniBrowser';
const ARGS = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking'];
const SCRIPT_MS = 600000; // longest time in milliseconds that a function may run in the page
const POLL_MS = 20, WAIT_MS = 120000;
const PROGRAMS = { chromium: [CHROMIUM], firefox: [FIREFOX], webkit: [DRIVER, MINI_BROWSER] };

// Returns why this machine cannot run the browser, or null.
export function missingBrowser(name) {
    const absent = PROGRAMS[name].filter((path) => !existsSync(path));
    return absent.length > 0 ? `no ${absent.join(', ')}` : name === 'webkit' ? missingDisplay() : null;
}

// The text of a function that calls f with an argument in JSON and resolves with its result in JSON.
const called = (f, arg) => `async () => JSON.stringify(await (${f})(${JSON.stringify(arg) ?? ''})) ?? 'null'`;
// Actions of WebDriver for a mouse.
const KINDS = { mouseMoved: 'pointerMove', mousePressed: 'pointerDown', mouseReleased: 'pointerUp' };
const mouse = (type, x, y) => [{ type: 'pointer', id: 'mouse', parameters: { pointerType: 'mouse' }, actions: [
    { type: 'pointerMove', x: Math.round(x), y: Math.round(y), duration: 0 },
    ...type === 'mouseMoved' ? [] : [{ type: KINDS[type], button: 0 }]] }];
const typed = (keys) => [{ type: 'key', id: 'keyboard', actions: keys.flatMap((value) =>
    [{ type: 'keyDown', value }, { type: 'keyUp', value }]) }];

// A page in a browser. Each browser defines goto(url), evaluate(f, arg), pointer(type, x, y) with a type of the Chrome DevTools
// Protocol, press(keys), screenshot() (PNG) and close(), and sets `pid`, the process whose descendants are the browser.
class Page {
    // Polls f in the page until its result is truthy, and returns the result.
    async wait(f, arg) {
        for (const end = performance.now() + WAIT_MS; performance.now() < end; await sleep(POLL_MS)) {
            const found = await this.evaluate(f, arg);
            if (found)
                return found;
        }
        throw new Error(`not within ${WAIT_MS} ms: ${f}`);
    }

    async shoot(path) {
        writeFileSync(path, await this.screenshot());
    }
}

class ChromiumPage extends Page {
    async open(width, height, ratio) {
        const { chromium } = require('playwright-core');
        this.server = await chromium.launchServer({ executablePath: CHROMIUM, args: ARGS });
        this.pid = this.server.process().pid;
        const browser = await chromium.connect(this.server.wsEndpoint());
        this.page = await browser.newPage({ viewport: { width, height }, deviceScaleFactor: ratio });
        this.client = await this.page.context().newCDPSession(this.page);
    }

    goto(url) {
        return this.page.goto(url);
    }

    async evaluate(f, arg) {
        return JSON.parse(await this.page.evaluate(`(${called(f, arg)})()`));
    }

    pointer(type, x, y, button = 'left') {
        this.buttons = { mousePressed: button === 'left' ? 1 : 2, mouseReleased: 0 }[type] ?? this.buttons ?? 0;
        return this.client.send('Input.dispatchMouseEvent',
            { type, x: Math.round(x), y: Math.round(y), button, buttons: this.buttons, clickCount: 1 });
    }

    // Turns the mouse wheel. by: distance in pixels; above 0: towards the user.
    wheel(x, y, by) {
        return this.client.send('Input.dispatchMouseEvent',
            { type: 'mouseWheel', x: Math.round(x), y: Math.round(y), deltaX: 0, deltaY: by });
    }

    async press(keys) {
        for (const key of keys)
            await this.page.keyboard.press(key);
    }

    // Slows the page's main thread down by that factor.
    throttle(rate) {
        return this.client.send('Emulation.setCPUThrottlingRate', { rate });
    }

    screenshot() {
        return this.page.screenshot();
    }

    close() {
        return this.server.close();
    }
}

// Starts a program and resolves when its output matches `ready`: { child, found (the match) }.
function started(program, args, ready, env = process.env) {
    const child = spawn(program, args, { stdio: ['ignore', 'pipe', 'pipe'], env });
    let text = '';
    const up = new Promise((done, fail) => {
        const read = (chunk) => {
            text += chunk;
            const found = text.match(ready);
            if (found)
                done({ child, found });
        };
        child.stdout.on('data', read);
        child.stderr.on('data', read);
        child.once('exit', (code) => fail(new Error(`${program} ended with ${code}\n${text}`)));
    });
    return up;
}

async function end(child) {
    if (!child || child.exitCode !== null || child.signalCode !== null)
        return;
    const gone = new Promise((done) => child.once('exit', done));
    child.kill();
    await gone;
}

class FirefoxPage extends Page {
    async open(width, height, ratio) {
        this.folder = mkdtempSync(join(tmpdir(), 'plantcast-firefox-'));
        writeFileSync(join(this.folder, 'user.js'), 'user_pref("browser.shell.checkDefaultBrowser", false);\n');
        const { child, found } = await started(FIREFOX, ['--headless', '--no-remote', '--profile', this.folder,
            '--remote-debugging-port', '0', 'about:blank'], /WebDriver BiDi listening on (ws:\S+)/);
        Object.assign(this, { child, pid: child.pid, waiting: new Map(), count: 0 });
        const WebSocket = require('ws');
        this.socket = new WebSocket(`${found[1]}/session`);
        await new Promise((done, fail) => this.socket.once('open', done).once('error', fail));
        this.socket.on('message', (data) => this.take(JSON.parse(data)));
        await this.send('session.new', { capabilities: {} });
        await this.send('session.subscribe', { events: ['log.entryAdded'] });
        this.context = (await this.send('browsingContext.getTree', {})).contexts[0].context;
        await this.send('browsingContext.setViewport', { context: this.context, viewport: { width, height }, devicePixelRatio: ratio });
    }

    take({ id, result, error, message, method, params }) {
        if (method === 'log.entryAdded')
            console.error(`${params.level}: ${params.text}`);
        const { done, fail } = this.waiting.get(id) ?? {};
        this.waiting.delete(id);
        if (error)
            fail?.(new Error(`${error}: ${message}`));
        else
            done?.(result);
    }

    send(method, params) {
        const id = ++this.count;
        this.socket.send(JSON.stringify({ id, method, params }));
        return new Promise((done, fail) => this.waiting.set(id, { done, fail }));
    }

    goto(url) {
        return this.send('browsingContext.navigate', { context: this.context, url, wait: 'complete' });
    }

    async evaluate(f, arg) {
        const { result, exceptionDetails } = await this.send('script.callFunction', { functionDeclaration: called(f, arg),
            awaitPromise: true, target: { context: this.context } });
        if (exceptionDetails)
            throw new Error(exceptionDetails.text);
        return JSON.parse(result.value);
    }

    perform(actions) {
        return this.send('input.performActions', { context: this.context, actions });
    }

    pointer(type, x, y) {
        return this.perform(mouse(type, x, y));
    }

    press(keys) {
        return this.perform(typed(keys));
    }

    async screenshot() {
        const { data } = await this.send('browsingContext.captureScreenshot', { context: this.context });
        return Buffer.from(data, 'base64');
    }

    async close() {
        this.socket?.terminate();
        await end(this.child);
        rmSync(this.folder, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 });
    }
}

class WebKitPage extends Page {
    async open(width, height) {
        this.display = await startDisplay(width + 200, height + 300);
        this.port = await freePort();
        this.child = spawn(DRIVER, [`--port=${this.port}`], { stdio: ['ignore', process.stderr, process.stderr], env: this.display.env });
        this.pid = this.child.pid;
        await until('WebKitWebDriver', () => fetch(`http://127.0.0.1:${this.port}/status`).then(({ ok }) => ok, () => false));
        const options = { binary: MINI_BROWSER, args: ['--automation', '--enable-write-console-messages-to-stdout=true'] };
        const { sessionId } = await this.send('POST', '/session', { capabilities: { alwaysMatch: {
            'webkitgtk:browserOptions': options, timeouts: { script: SCRIPT_MS } } } });
        this.session = `/session/${sessionId}`;
        const inner = () => this.evaluate(() => [innerWidth, innerHeight]);
        // makes the window larger than the page by the size of the window's frame and bars
        const rect = await this.command('/window/rect', { x: 0, y: 0, width, height }), [shown, high] = await inner();
        await this.command('/window/rect', { x: 0, y: 0, width: rect.width + width - shown, height: rect.height + height - high });
    }

    async send(method, path, body) {
        const answer = await fetch(`http://127.0.0.1:${this.port}${path}`, { method, body: body && JSON.stringify(body) });
        const { value } = await answer.json();
        if (!answer.ok)
            throw new Error(`${path}: ${value.error}: ${value.message}`);
        return value;
    }

    command(path, body) {
        return this.send('POST', this.session + path, body);
    }

    goto(url) {
        return this.command('/url', { url });
    }

    async evaluate(f, arg) {
        return JSON.parse(await this.command('/execute/sync', { script: `return (${called(f, arg)})()`, args: [] }));
    }

    // WebKitWebDriver refuses an action while another one runs. Of the moves that wait, performs only the newest.
    pointer(type, x, y) {
        const number = this.actions = (this.actions ?? 0) + 1;
        this.last = Promise.resolve(this.last).then(() => (type === 'mouseMoved' && number < this.actions ? null
            : this.command('/actions', { actions: mouse(type, x, y) })));
        return this.last;
    }

    async press(keys) {
        await this.last;
        return this.command('/actions', { actions: typed(keys) });
    }

    async screenshot() {
        return Buffer.from(await this.send('GET', `${this.session}/screenshot`), 'base64');
    }

    async close() {
        await this.send('DELETE', this.session).catch(() => {});
        await end(this.child);
        await this.display?.stop();
    }
}

// Opens an empty page with a viewport of width x height CSS pixels in a browser of its own. name: chromium, firefox or webkit.
// ratio: device pixels per CSS pixel; WebKitGTK always has 1.
export async function drive(name, width, height, ratio = 1) {
    const page = new { chromium: ChromiumPage, firefox: FirefoxPage, webkit: WebKitPage }[name]();
    try {
        await page.open(width, height, ratio);
    } catch (error) {
        await page.close().catch(() => {}); // ends the browser, however far it has been started
        throw error;
    }
    return page;
}
