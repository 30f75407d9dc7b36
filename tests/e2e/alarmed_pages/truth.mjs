// SPDX-License-Identifier: GPL-3.0-or-later
// Anything not current, not measured or not from this version is marked: simulated data, a page after sleep, a page of another
// version; also on a wall, legibly from afar.
import assert from 'node:assert/strict';
import { createHash, X509Certificate } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { alarmed } from './alarmed.mjs';
import { settle, shoot, TABLET, waitForHealth, waitForPicture, withPage } from '../support/browser.mjs';
import { makeCertificate } from '../support/certificate.mjs';
import { Relay, relayMissing } from '../support/relay.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { missing, TinyPlant } from '../support/tiny_plant.mjs';
import { becomes, until } from '../support/until.mjs';

const absent = [...missing(), relayMissing()].filter(Boolean);
const options = { skip: absent.length > 0 ? `not built: ${absent.join(', ')}` : false, timeout: 200000 };
const SIZE = sweep({ width: 3840, height: 2160 }, { width: 1920, height: 1080 }), WALL = { viewport: SIZE, screen: SIZE };
let plant, url;

setUp(options.skip, async () => {
    [plant, url] = await alarmed();
});

const withPicture = (address, screen, f, init = null) => withPage(address, screen, async (page, browser) => {
    await waitForPicture(page);
    await f(page, browser);
}, init);

// Returns the sizes of all texts, in CSS pixels.
const letters = (page) => page.evaluate(() => {
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), found = [];
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const parent = node.parentElement, text = node.textContent.trim();
        if (!text || !parent.checkVisibility() || parent.getClientRects().length === 0)
            continue;
        const range = document.createRange();
        range.selectNodeContents(node);
        const zoom = parent.currentCSSZoom ?? 1, { fontSize } = getComputedStyle(parent);
        found.push({ text, px: parseFloat(fontSize) * zoom });
    }
    return found;
});

// Returns the height of a capital letter (0.72 of the font size of `px`) in minutes of arc, for a screen of `inches` diagonal
// seen from `metres` away.
function letterMinutes(px, { inches, metres }, screen) {
    const millimetres = (0.72 * px * inches * 25.4) / Math.hypot(screen.width, screen.height);
    return (Math.atan2(millimetres, metres * 1000) * 180 * 60) / Math.PI;
}

test(`on a wall of ${SIZE.width} pixels, all text is legible from 3 m, alarms are counted, and there are no buttons`, options, () =>
    withPicture(`${url}?wall&theme=dark`, WALL, async (page) => {
        await waitForHealth(page, 'live');
        await page.locator('#alarm-strip').waitFor();
        await page.locator('#alarm-counts .priority').first().waitFor();
        await settle(page);
        const { readWall } = await import('../../../clients/web/core/wall.js');
        const seen = await letters(page);
        assert.ok(seen.length > 12, `only ${seen.length} texts found`);
        const small = seen.map(({ text, px }) => ({ text, minutes: letterMinutes(px, readWall('?wall'), WALL.screen) }))
            .filter(({ minutes }) => minutes < 14.5);
        assert.deepEqual(small, [], 'texts smaller than 14.5 minutes of arc');
        assert.ok(await page.evaluate(() => globalThis.plantcast.overlay.unit) > SIZE.width / 960);
        assert.equal(await page.evaluate(() => [...document.querySelectorAll('button, select, input')]
            .filter((e) => e.id !== 'alarm-strip' && e.checkVisibility() && e.getBoundingClientRect().width > 1 &&
                !e.closest('#groups')).length), 0);
        const out = await page.evaluate(() => [...document.querySelectorAll('.toolbar *, .alarm-strip *, .status *, .legend *')]
            .map((e) => e.getBoundingClientRect())
            .filter((b) => b.width > 0 && (b.right > innerWidth + 1 || b.bottom > innerHeight + 1)).length);
        assert.equal(out, 0, 'nothing is cut off');
        await shoot(page, 'wall');
    }));

test('simulated values are marked on the picture itself and by a frame', options, () =>
    withPicture(url, TABLET, async (page) => {
        await waitForHealth(page, 'live');
        await page.evaluate(() => {
            const { session } = globalThis.plantcast;
            session.heard({ type: 'status', links: [{ source: 'plc1', up: true, simulated: true }], live: true });
        });
        await waitForHealth(page, 'simulated');
        assert.equal(await page.locator('#simulated').textContent(), 'Simulated');
        assert.equal(await page.evaluate(() => getComputedStyle(document.getElementById('viewport'), '::after').borderTopStyle), 'dashed');
        await settle(page);
        await shoot(page, 'simulated');
    }));

test('a tablet that slept marks its picture as old until the server responds', options, () =>
    withPicture(url, TABLET, async (page) => {
        await waitForHealth(page, 'live');
        await settle(page);
        await page.evaluate(() => {
            const { session } = globalThis.plantcast, real = Date.now;
            // the page receives nothing any more, as if the network were dead; then its clock jumps 7 hours ahead, as after
            // sleep
            session.connection.socket.onmessage = null;
            Date.now = () => real() + 7 * 3600e3;
        });
        // polls each animation frame, because this notice disappears as soon as the page reaches the server again
        await page.waitForFunction(() => {
            const banner = document.getElementById('banner');
            return /This picture is 7 h old/.test(banner.textContent) && ['silent', 'lost'].includes(banner.dataset.kind) &&
                document.getElementById('viewport').classList.contains('is-old');
        }, null, { polling: 'raf' });
        await shoot(page, 'slept');
        await waitForHealth(page, 'live');
        await page.locator('#banner').waitFor({ state: 'hidden' });
    }));

test('a tablet with a wrong date still shows correct ages and the plant\'s time', options, () =>
    withPicture(url, TABLET, async (page) => {
        await waitForHealth(page, 'live');
        const far = () => page.evaluate(() => Date.now() - globalThis.plantcast.session.clockUs() / 1000);
        assert.ok(await far() < -3 * 86400e3 + 60000, 'the tablet\'s date is wrong');
        const told = () => page.evaluate(() => ({ clock: document.getElementById('clock').textContent,
            age: document.getElementById('age').textContent }));
        // Sets the page's clock back by an hour again and again: the shown age must not change. Setting it forward would count
        // as sleep of the computer.
        const ages = await page.evaluate(() => new Promise((done) => {
            const seen = [], timer = setInterval(() => {
                seen.push(document.getElementById('age').textContent);
                globalThis.wrongMs -= 3600e3;
                if (seen.length > 20) {
                    clearInterval(timer);
                    done(seen);
                }
            }, 150);
        }));
        assert.deepEqual(ages.filter((age) => !/^[\d.]+ s$/.test(age)), [], 'ages are in seconds, never in days');
        await waitForHealth(page, 'live');
        const { clock, age } = await told(), now = new Date();
        assert.match(age, /^[\d.]+ s$/);
        assert.ok(parseFloat(age) < 10, age);
        assert.ok([0, 1000, 2000, 3000, 4000, 5000, 6000, 7000, 8000].some((ms) =>
            clock.includes(new Date(now.getTime() - ms).toISOString().slice(11, 19))), `${clock} is not ${now.toISOString()}`);
        await shoot(page, 'wrong-date');
    }, () => {
        const Real = Date;
        globalThis.wrongMs = -3 * 86400e3;
        globalThis.Date = class extends Real {
            constructor(...given) {
                super(...(given.length > 0 ? given : [Real.now() + globalThis.wrongMs]));
            }

            static now() {
                return Real.now() + globalThis.wrongMs;
            }
        };
    }));

// Returns the colours of the picture on the screen at the points of a grid.
const samples = (page) => page.evaluate(() => {
    const canvas = document.getElementById('picture'), c = canvas.getContext('2d');
    return [...Array(64).keys()].map((n) => [...c.getImageData(Math.floor(((n % 8) + 0.5) * canvas.width / 8),
        Math.floor((Math.floor(n / 8) + 0.5) * canvas.height / 8), 1, 1).data]);
});

test('a slow link that stalls: the last picture stays, marked as old, and the view is unchanged', options, async (t) => {
    const relay = await Relay.open(plant.port, { bytesPerS: 250000, delayMs: 60 });
    t.after(() => relay.close());
    await withPicture(`http://127.0.0.1:${relay.port}/`, TABLET, async (page) => {
        await waitForHealth(page, 'live');
        await page.evaluate(() => {
            const { session } = globalThis.plantcast;
            session.setCamera({ eye: [2.2, -2.2, 1.6], target: [0, 0, 0], up: [0, 0, 1], fov: 45 });
            session.setParams({ selected: 'E-101' });
        });
        await settle(page);
        const view = () => page.evaluate(() => {
            const { camera, params } = globalThis.plantcast.session;
            return { camera, selected: params.selected, group: params.group };
        });
        const was = await view();
        relay.child.kill('SIGSTOP'); // stops the relay: the connection stays open, but no data arrives
        try {
            await page.waitForFunction(() => document.getElementById('viewport').classList.contains('is-old'));
            await page.locator('#banner', { hasText: /This picture is [\d.]+ s old/ }).waitFor();
            const now = await samples(page);
            assert.ok(now.every(([r, g, b]) => r + g + b > 30), 'no part of the picture is black');
            assert.ok(new Set(now.map(String)).size > 20, 'the picture is still shown');
            await shoot(page, 'halted');
        } finally {
            relay.child.kill('SIGCONT');
        }
        await waitForHealth(page, 'live');
        await settle(page);
        assert.deepEqual(await view(), was);
        await page.locator('#banner').waitFor({ state: 'hidden' });
    });
});

test('a link that stalls while the hand moves: the warped picture is marked as old, and the status bar tells how far it lags behind',
    options, async (t) => {
    const relay = await Relay.open(plant.port, { bytesPerS: 4e6, delayMs: 60 });
    t.after(() => relay.close());
    await withPicture(`http://127.0.0.1:${relay.port}/?lang=en`, { viewport: { width: 1024, height: 768 } }, async (page) => {
        await waitForHealth(page, 'live');
        await settle(page);
        const box = await page.locator('#viewport').boundingBox(), [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
        await page.mouse.move(x, y);
        await page.mouse.down();
        let moves = 0;
        const drag = async (test) => {
            await page.mouse.move(x + 60 * Math.sin(++moves / 8), y + 20 * Math.sin(moves / 5));
            return page.evaluate(test);
        };
        await until('a warped picture', () => drag(() => globalThis.plantcast.viewport.warp?.isShown));
        relay.child.kill('SIGSTOP'); // stops the relay: the connection stays open, but no data arrives
        try {
            await until('the mark of an old picture', () => drag(() => document.getElementById('viewport').classList.contains('is-old')));
            await page.locator('#banner', { hasText: /This picture is [\d.]+ s old/ }).waitFor();
            await until('the status bar', () => drag(() => /^[\d.]+ s behind$/.test(document.getElementById('latency').textContent) &&
                document.getElementById('latency').parentElement.classList.contains('late')));
            const isOver = await drag(() => {
                const { warp } = globalThis.plantcast.viewport, mark = document.querySelector('.viewport > .old');
                return Boolean(warp.isShown && mark.checkVisibility() &&
                    warp.canvas.compareDocumentPosition(mark) & Node.DOCUMENT_POSITION_FOLLOWING);
            });
            assert.equal(isOver, true, 'the mark covers the warped picture');
            await shoot(page, 'halted-drag');
        } finally {
            relay.child.kill('SIGCONT');
        }
        await page.mouse.up();
        await waitForHealth(page, 'live');
        await settle(page);
        await page.waitForFunction(() => !document.getElementById('latency').parentElement.classList.contains('late'));
    });
});

test('legend and markers belong to the shown picture, however late the requested one arrives', options, async (t) => {
    const relay = await Relay.open(plant.port, { bytesPerS: 1e8, delayMs: 0 });
    t.after(() => relay.close());
    await withPicture(`http://127.0.0.1:${relay.port}/`, TABLET, async (page) => {
        await waitForHealth(page, 'live');
        // moves the camera away from its home position: in a split picture the page would fit the home position to the shape of
        // the halves
        await page.evaluate(() => {
            const { session } = globalThis.plantcast, { camera } = session;
            session.setCamera({ ...camera, eye: camera.eye.map((m) => 1.1 * m) });
        });
        await settle(page);
        const said = () => page.evaluate(() => {
            const { overlay, session } = globalThis.plantcast;
            const legends = [...document.querySelectorAll('.legend')].filter((element) => element.checkVisibility());
            return [session.params.group, legends.map((element) => element.querySelector('h2').textContent.trim()),
                overlay.markers.map(({ tag, x, half }) => [tag.name, Math.round(x), half])];
        });
        const [group, legend, markers] = await said();
        assert.deepEqual([group, legend], ['temperature', ['Temperature °C']]);
        assert.ok(markers.length > 0);
        relay.child.kill('SIGSTOP');
        try {
            await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'pressure', split: { group: 'temperature' } }));
            await page.waitForTimeout(300); // wait for some animation frames
            assert.deepEqual(await said(), ['pressure', legend, markers]);
        } finally {
            relay.child.kill('SIGCONT');
        }
        await page.waitForFunction(() => globalThis.plantcast.overlay.markers.some(({ half }) => half === 1));
        await becomes(async () => {
            const [, both, then] = await said();
            return [both, then.filter(([name]) => name === 'PI-1').map(([, , half]) => half)];
        }, [['Pressure bar', 'Temperature °C'], [0]]);
    });
});

test('a cached page of another version reloads itself, once', options, async () => {
    const asked = [];
    await withPicture(url, TABLET, async (page, browser) => {
        await page.goto('about:blank'); // leaves the page, so that its late requests for modules do not count
        browser.page.on('domcontentloaded', () => asked.push('loaded'));
        let first = true;
        await page.route('**/made/version.js', (route) => {
            const version = first ? 'aaaaaaaaaaaa' : 'bbbbbbbbbbbb';
            first = false;
            return route.fulfill({ contentType: 'text/javascript', body: `export const version = '${version}';\n` });
        });
        await page.goto(url);
        await waitForPicture(page);
        await page.waitForFunction(() => sessionStorage.getItem('plantcast.renewed') === 'bbbbbbbbbbbb');
        await page.waitForFunction(() => globalThis.plantcast?.session.picture);
        await waitForHealth(page, 'live');
        await page.waitForTimeout(1000);
        assert.equal(asked.length, 2, 'the page was requested, and reloaded itself once');
    });
});

test('the page can be installed: a manifest with all its icons; no service worker on plain http', options, () =>
    withPicture(url, TABLET, async (page) => {
        const manifest = await (await fetch(new URL(await page.locator('link[rel=manifest]').getAttribute('href'), url))).json();
        assert.deepEqual([manifest.display, manifest.start_url], ['standalone', './']);
        for (const { src, sizes, type } of manifest.icons) {
            const answer = await fetch(new URL(src, url));
            assert.deepEqual([answer.status, answer.headers.get('content-type')], [200, type], src);
            if (type !== 'image/png')
                continue;
            const head = Buffer.from(await answer.arrayBuffer());
            assert.equal(`${head.readUInt32BE(16)}x${head.readUInt32BE(20)}`, sizes, src);
        }
        assert.equal(await page.evaluate(async () => (await navigator.serviceWorker?.getRegistrations())?.length ?? 0), 0);
    }));

// Makes a self-signed certificate, and flags that make Chromium trust it: service workers are refused on pages whose
// certificate errors are merely ignored.
function certify(folder) {
    makeCertificate(folder, 'cert', ['127.0.0.1']);
    const [key, cert] = ['cert.key', 'cert.pem'].map((name) => join(folder, name));
    const spki = new X509Certificate(readFileSync(cert)).publicKey.export({ type: 'spki', format: 'der' });
    const hash = createHash('sha256').update(spki).digest('base64');
    return { daemon: ['--tls-cert', cert, '--tls-key', key], browser: [`--ignore-certificate-errors-spki-list=${hash}`] };
}

test('installed over https, the page opens without its server, says so, and is live again when the server returns',
    options, async (context) => {
    const secure = await TinyPlant.create(), by = certify(secure.folder);
    context.after(() => secure.destroy());
    await secure.start(...by.daemon);
    const { port } = secure, address = `https://127.0.0.1:${port}/`;
    await withPicture(address, { ...TABLET, args: by.browser, profile: true }, async (page) => {
        await page.evaluate(() => navigator.serviceWorker.ready);
        const client = await page.context().newCDPSession(page);
        assert.deepEqual((await client.send('Page.getInstallabilityErrors')).installabilityErrors, []);
        await page.waitForFunction(() => navigator.serviceWorker.controller);
        await page.reload(); // reloads through the service worker, which caches the files
        await waitForPicture(page);
        await waitForHealth(page, 'live');
        const kept = await page.evaluate(async () => (await Promise.all((await caches.keys()).map(async (name) =>
            (await caches.open(name)).keys()))).flat().map(({ url: of }) => new URL(of).pathname));
        // the service worker stores a file in its cache before it answers the page, so these files must be there
        assert.deepEqual(['/', '/app/main.js', '/words/en.js'].filter((path) => !kept.includes(path)), []);
        assert.deepEqual(kept.filter((of) => /api|snapshot|stream/.test(of)), [], 'no answer with plant data is cached');
        await secure.daemon.stop('SIGKILL');
        await page.reload();
        await waitForHealth(page, 'lost');
        await page.locator('#banner').waitFor();
        await page.locator('#picture').waitFor({ state: 'hidden' }); // no black picture
        await shoot(page, 'installed-alone');
        await secure.startDaemon('--port', String(port), ...by.daemon);
        await waitForPicture(page);
        await waitForHealth(page, 'live');
    });
});
