// SPDX-License-Identifier: GPL-3.0-or-later
// The page on a tablet and on a phone, used by touch.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { demo } from './demo.mjs';
import { arrive, markers, openPage, PHONE, resize, settle, SHARP, shoot, TABLET, view, waitForHealth,
    waitForPicture } from '../support/browser.mjs';
import { contrastRatio } from '../support/pixels.mjs';
import { missing } from '../support/plant.mjs';
import { sweep, takes } from '../support/sweep.mjs';
import { becomes, until } from '../support/until.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 200000 };
const LARGE = { viewport: { width: 1920, height: sweep(1080, 800) } }; // a desktop screen large enough to show all controls
let plant;

before(async () => {
    if (!why)
        plant = await demo();
});

// Opens a page, and returns what openPage() returns, with the page's first camera and view parameters.
async function openOn(screen) {
    const opened = await openPage(plant.url, screen), { page } = opened;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    // loads the camera controller now; by itself, the page loads it at the first input
    await page.evaluate(() => globalThis.plantcast.modules.get('cameraController'));
    await arrive(page);
    return { ...opened, ...await view(page) };
}

// Returns a page to its first view, closes its lists, trends and time bar, and returns sheets and legends to their usual height. Does not
// close the panels of the toolbar, and does not undo the theme, the span of trends, measuring or notes.
const reset = ({ page, camera, params }) => page.evaluate(([first, all]) => {
    const { selectTag, session } = globalThis.plantcast, isOpen = (id) => document.getElementById(id)?.checkVisibility();
    for (const [part, button] of [['trends', 'trend-close'], ['timeline', 'time-toggle'], ['alarms', 'alarm-strip'],
        ['engineer', 'engineer-toggle']])
        if (isOpen(part))
            document.getElementById(button).click();
    for (const name of ['other-sheet', 'whole'])
        [...document.getElementsByClassName(name)].forEach((element) => element.classList.remove(name));
    selectTag(null);
    session.setParams(all);
    session.setCamera(first);
}, [camera, params]);

// Open pages by the kind of their screen. Tests on screens of one kind share a page, because opening a page takes a second of
// processor time.
const shared = new Map();
after(() => Promise.all([...shared.values()].map(({ close }) => close())));

// Calls f(page) with a shared page of that size. A page on which a test failed is not used again.
async function onScreen({ viewport, ...kind }, f) {
    const key = JSON.stringify(kind), opened = shared.get(key) ?? await openOn({ viewport, ...kind });
    shared.delete(key);
    await resize(opened.page, viewport);
    await f(opened.page);
    assert.deepEqual(opened.errors, []);
    await reset(opened);
    shared.set(key, opened);
}

// Calls f(page) with a new page that no other test uses.
async function onOwnPage(screen, f) {
    const { page, errors, close } = await openOn(screen);
    await f(page);
    assert.deepEqual(errors, []);
    await close();
}

// Sends touch events as the hardware does; playwright itself can only tap.
async function touches(page) {
    const client = await page.context().newCDPSession(page);
    const send = (type, points) => client.send('Input.dispatchTouchEvent', {
        type, touchPoints: points.map(([x, y], id) => ({ x, y, id })),
    });
    return {
        async drag(from, to, steps = 10) {
            await send('touchStart', from);
            for (let n = 1; n <= steps; n++)
                await send('touchMove', from.map(([x, y], i) => [x + ((to[i][0] - x) * n) / steps, y + ((to[i][1] - y) * n) / steps]));
            await send('touchEnd', []);
        },
    };
}

const distance = ({ camera }) => Math.hypot(...camera.eye.map((x, i) => x - camera.target[i]));

// Returns controls that are smaller than a finger.
const tooSmall = (page) => page.evaluate(() => [...document.querySelectorAll(
    'button, select, .segments label, input:not([type="radio"], [type="checkbox"])')].filter((e) => e.checkVisibility())
    .map((e) => ({ what: e.id || e.className || e.textContent, box: e.getBoundingClientRect() }))
    .filter(({ box }) => box.height < 43.5 || box.width < 43.5)
    .map(({ what, box }) => `${what}: ${box.width}x${box.height}`));

// Returns the controls of the toolbar that a thumb does not reach on a phone held upright in one hand: those in the upper half.
const beyondThumb = (page) => page.evaluate(() => [...document.querySelectorAll(
    '.actions button, #groups label, #assets-toggle, #alarms-toggle')]
    .map((e) => ({ name: e.id || e.textContent, box: e.getBoundingClientRect() }))
    .filter(({ box }) => box.width > 0 && box.top < innerHeight / 2).map(({ name }) => name));

// Returns parts of the page that extend beyond the screen, and texts that extend beyond their button.
const sticksOut = (page) => page.evaluate(() => [
    // The row of quantities may extend beyond the screen, because it can be dragged.
    ...[...document.querySelectorAll('header, header *:not(#groups .row *), main, footer, .legend, .card, .assets')].filter((e) => {
        const box = e.getBoundingClientRect();
        return box.width > 0 && (box.right > window.innerWidth + 0.5 || box.left < -0.5 || box.bottom > window.innerHeight + 0.5);
    }),
    ...[...document.querySelectorAll('.segments span')].filter((e) => e.scrollWidth > e.clientWidth + 1),
].map((e) => e.id || e.className || e.textContent));

test('tablet: one finger orbits, two fingers pan and zoom', options, () => onOwnPage(TABLET, async (page) => {
    const box = await page.locator('#viewport').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const hand = await touches(page);
    const start = await view(page);
    await hand.drag([[x, y]], [[x + 120, y]]);
    const turned = await view(page);
    assert.notDeepEqual(turned.camera.eye, start.camera.eye);
    assert.ok(Math.abs(distance(turned) - distance(start)) < 1e-6, 'one finger turns the camera without zooming');
    await hand.drag([[x - 40, y], [x + 40, y]], [[x - 120, y], [x + 120, y]]);
    const pinched = await view(page);
    assert.ok(distance(pinched) < distance(turned) * 0.6, `pinching zooms in: distance ${distance(turned)} -> ${distance(pinched)}`);
    await hand.drag([[x - 90, y], [x, y], [x + 90, y]], [[x - 30, y + 20], [x + 60, y + 20], [x + 150, y + 20]]);
    const looked = await view(page);
    looked.camera.eye.forEach((m, i) => assert.ok(Math.abs(m - pinched.camera.eye[i]) < 1e-6, 'three fingers look around: the eye stays'));
    assert.notDeepEqual(looked.camera.target, pinched.camera.target);
    const isHome = ({ camera }) => camera.eye.every((m, i) => Math.abs(m - start.camera.eye[i]) < 1e-6);
    await settle(page);
    let tries = 0;
    await until('home again', async () => {
        // Chromium may treat a tap right after a three-finger gesture as the end of that gesture, so the tap on `home` is
        // repeated every 60 checks
        if (tries++ % 60 === 0)
            await page.locator('#home').tap();
        return isHome(await view(page));
    });
    await settle(page);
    await becomes(() => tooSmall(page), []);
    await becomes(() => sticksOut(page), []);
    await shoot(page, 'tablet');
    await page.locator('#display-toggle').tap();
    await becomes(() => tooSmall(page), []);
    await shoot(page, 'tablet-display');
    await page.locator('#display-toggle').tap();
    for (const [button, panel] of Object.entries({ display: '#display', more: '#more', views: '#views', picture: '#picture-panel' })) {
        await page.locator(`#${button}-toggle`).tap();
        await becomes(async () => {
            const [strip, box] = await Promise.all(['#alarm-strip', `${panel}.open`].map((one) => page.locator(one).boundingBox()));
            return box?.y >= strip.y + strip.height;
        }, true, `${panel} leaves the alarms free`);
        await page.locator(`#${button}-toggle`).tap();
    }
}));

// Runs in the page: gives the picture a bound on its errors, and returns the legend's text.
function legendWithError() {
    const { legend, session } = globalThis.plantcast;
    session.drawnErrors = [2, 2];
    legend.show(true);
    return legend.element.textContent;
}

test('desktop: two parameter sets side by side, each with legend and markers', options, () => onOwnPage(LARGE, async (page) => {
    const choose = (id, value) => page.locator(`#${id}`).selectOption(value);
    const whole = await page.evaluate(() => ['plant-name', 'health'].filter((id) => {
        const { scrollWidth, clientWidth } = document.getElementById(id);
        return clientWidth < 150 || (id === 'health' && scrollWidth > clientWidth);
    }));
    assert.deepEqual(whole, [], 'the plant\'s name and state fit');
    await page.locator('#viewport').focus();
    await page.keyboard.press('j');
    await page.locator('#split-bar').waitFor();
    assert.equal(await page.locator('#right-group').inputValue(), 'pressure', 'the halves differ from the start');
    await choose('right-group', 'temperature');
    await page.locator('#legend').waitFor({ state: 'hidden' });
    await page.locator('#legend-right').waitFor();
    assert.deepEqual(await page.locator('.legend:visible').evaluateAll((all) => all.map(({ id }) => id)), ['legend-right'],
        'halves with equal parameters share one legend');
    // hot spots that no sensor would show are uncertain only with distances along surfaces: only that half's legend has the key
    const set = (params) => page.evaluate((all) => globalThis.plantcast.session.setParams(all), params);
    const uncertain = () => page.locator('.legend:visible').evaluateAll((all) => all.map((one) => /Uncertain/.test(one.textContent)));
    for (const [distance, other, keys] of [['geodesic', 'euclidean', [true, false]], ['euclidean', 'geodesic', [false, true]]]) {
        await set({ show: 'blind', distance, split: { show: 'blind', distance: other } });
        await becomes(uncertain, keys, `${distance} beside ${other}`);
    }
    await set({ show: 'value', distance: 'geodesic', split: { show: 'value', distance: 'geodesic' } });
    await choose('right-group', 'pressure');
    await choose('isolines', { index: 2 });
    await settle(page);
    const legends = await page.locator('.legend:visible h2').allTextContents();
    assert.deepEqual(legends.map((text) => text.trim()), ['Temperature °C', 'Pressure bar']);
    const [left, right] = await Promise.all(['#legend', '#legend-right'].map((id) => page.locator(id).boundingBox()));
    const box = await page.locator('#viewport').boundingBox(), middle = box.x + box.width / 2;
    assert.ok(left.x + left.width <= middle && right.x > middle, 'each legend is in its half');
    const bar = await page.locator('#split-bar').boundingBox();
    assert.ok(bar.x > middle && bar.x + bar.width <= box.x + box.width && bar.y + bar.height <= box.y + box.height,
        'the bar is in the right half');
    const places = await page.evaluate(() =>
        globalThis.plantcast.overlay.markers.map(({ tag, x, half, alarm }) => ({ group: tag.group, x, half, alarm: Boolean(alarm) })));
    for (const { group, x, half, alarm } of places) {
        // each half of the split picture has markers for the sensors of its own group, and for tags of any group that are in
        // alarm
        assert.ok(alarm || group === (half ? 'pressure' : 'temperature'), `a marker of group ${group} is in half ${half}`);
        assert.equal(half, box.x + x >= middle - 1 ? 1 : 0);
    }
    assert.ok(places.some(({ half }) => half === 0) && places.some(({ half }) => half === 1));
    await shoot(page, 'split');
    await page.locator('#split-bar button').click();
    await page.locator('#groups label', { hasText: 'Vibration' }).click();
    await page.locator('#groups label', { hasText: 'Temperature' }).click();
    await page.locator('#viewport').focus();
    await page.keyboard.press('j');
    // key j splits the picture: the right half shows the quantity that was shown before the present one (vibration)
    await page.waitForFunction(() => document.getElementById('right-group').value === 'vibration');
    await page.keyboard.press('j');
    await page.locator('#split-bar').waitFor({ state: 'hidden' });
    await page.locator('#picture-toggle').click();
    await choose('environment', 'sky');
    await page.locator('#sun-turn').fill('90');
    await choose('show', 'distance');
    await settle(page);
    const { light, sensor } = (await view(page)).params;
    assert.match(await page.locator('#legend h2').textContent(), new RegExp(`Distance from ${sensor} m`));
    const labels = await page.evaluate(() => {
        const { overlay } = globalThis.plantcast;
        return overlay.labels().filter(({ id }) => overlay.places.has(id))
            .map(({ parts, alarm }) => ({ text: parts.map(([part]) => part).join(' '), alarm: Boolean(alarm) }));
    });
    assert.ok(labels.every(({ text, alarm }) => alarm || / m$|\u202fm/.test(text)), JSON.stringify(labels)); // no label is empty
    assert.ok(labels.some(({ text }) => text.startsWith(`${sensor} 0.00`)),
        `a label names the reference sensor: ${JSON.stringify(labels)}`);
    assert.ok(light[0] > 0.3 && Math.abs(light[1]) < 0.02, `the light comes from the east: ${light}`);
    assert.equal(await page.locator('#sensor').inputValue(), sensor);
    await shoot(page, 'distance');
    await choose('show', 'difference');
    await page.locator('#baseline-name').fill('before');
    await page.locator('#baseline-keep').click();
    await settle(page);
    assert.equal(await page.locator('#baseline').inputValue(), 'before');
    assert.match(await page.locator('#legend h2').textContent(), /Δ Temperature °C since before, \w{3} \d+ \d\d:\d\d:\d\d$/);
    assert.match(await page.evaluate(legendWithError), /error up to 2\u00a0°C\./);
    await page.keyboard.press('Escape');
    await choose('show', 'operator');
    await settle(page);
    assert.deepEqual(await page.locator('#legend .ticks span').allTextContents(), ['LL', 'L', 'H', 'HH']);
    assert.equal(await page.locator('#legend-right').isVisible(), false);
    await shoot(page, 'operator');
    const notes = await page.evaluate(legendWithError);
    assert.doesNotMatch(notes, /error up to/, 'a view without a unit says nothing about errors');
}));

test('the right half\'s interpolation method is shown on every screen if it differs from the left half\'s',
    options, () => onScreen(LARGE, async (page) => {
    const method = page.locator('#right-interpolation'), paper = { group: 'temperature', interpolation: 'paper' };
    for (const [width, height] of [[1280, 800], [1024, 768], [844, 390], [390, 844]]) {
        const name = `${width}x${height}`;
        await resize(page, { width, height });
        for (const split of [{ group: 'pressure' }, paper]) {
            await page.evaluate((half) => globalThis.plantcast.session.setParams({ split: half }), split);
            await method.waitFor({ state: split === paper ? 'visible' : 'hidden' });
            const boxes = () => Promise.all(['#split-bar', '#viewport'].map((one) => boxOf(page, one)));
            await until(`the bar in the right half: ${name}`, async () => {
                const [bar, box] = await boxes();
                return bar.x >= box.x + box.width / 2 && bar.y >= box.y && bar.x + bar.width <= box.x + box.width &&
                    bar.y + bar.height <= box.y + box.height;
            }, 30);
            await page.evaluate(() => globalThis.plantcast.session.setParams({ split: null }));
            await page.locator('#split-bar').waitFor({ state: 'hidden' });
        }
    }
}));

test('an open panel covers neither legends nor the bar of a split view, and ends above the status bar', options, () => onOwnPage(
    { viewport: { width: 1280, height: 800 } }, async (page) => {
        const parts = ['#legend', '#legend-right', '.panel.open, .display.open', '#status', '#split-bar'];
        const visibleBoxes = () => page.evaluate((all) => all.map((selector) => {
            const { left, top, right, bottom, width } = document.querySelector(selector)?.getBoundingClientRect() ?? { width: 0 };
            return width > 0 && { selector, left, top, right, bottom };
        }).filter(Boolean), parts);
        const covered = async () => (await visibleBoxes()).flatMap((a, i, all) => all.slice(i + 1)
            .filter((b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom)
            .map((b) => `${a.selector} and ${b.selector}`));
        const panels = { display: '#display', picture: '#picture-panel', views: '#views' };
        const set = (params) => page.evaluate((all) => globalThis.plantcast.session.setParams(all), params);
        const right = { group: 'vibration' };
        for (const [row, [width, height, split]] of [[1280, 800, null], [1280, 640, null], [1024, 600, null], [1280, 800, right],
            [1600, 900, right]].entries()) {
            await resize(page, { width, height });
            await set({ group: 'temperature', split });
            await page.locator('#legend-right').waitFor({ state: split ? 'visible' : 'hidden' });
            const isTight = width === 1024 || (width === 1280 && split);
            for (const [button, panel] of Object.entries(panels).filter((_, i) => isTight || takes(row, i, 2))) {
                await page.locator(`#${button}-toggle`).click();
                await page.locator(`${panel}.open`).waitFor();
                await becomes(covered, [], `${panel} at ${width}x${height}`);
                const [left, legend] = await Promise.all(['#viewport', '#legend'].map(async (one) => (await boxOf(page, one)).x));
                assert.ok(split || legend - left < 20, `the legend leaves the middle of the picture free: ${legend} ${left}`);
                assert.equal((await visibleBoxes()).length, split ? 5 : 3, panel);
                assert.ok((await boxOf(page, `${panel}.open`)).height > 250, `${panel} has room at ${width}x${height}`);
                await shoot(page, `legend-${button}${split ? `-split-${width}` : ''}`);
                await page.locator(`#${button}-toggle`).click();
                await page.locator(`${panel}.open`).waitFor({ state: 'detached' });
            }
        }
        await resize(page, { width: 1280, height: 800 });
        await set({ split: null });
        // opens the alarm list, which takes the place that the picture panel would otherwise cover
        await page.locator('#alarm-strip').click();
        await page.locator('#alarms').waitFor();
        await page.locator('#picture-toggle').click();
        await page.locator('#picture-panel.open').waitFor();
        const [legend, picture] = await Promise.all(['#legend', '#viewport'].map((one) => boxOf(page, one)));
        assert.ok(picture.x + picture.width - legend.x - legend.width <= 12, JSON.stringify([legend, picture]));

        const temperatures = page.locator('#disagreeing .line', { hasText: '°C' });
        await temperatures.first().waitFor();
        await page.locator('#picture-toggle').click();
        await set({ group: 'pressure' });
        await becomes(() => temperatures.count(), 0, 'the closed panel keeps no rows of another quantity');
        await page.locator('#theme').click();
        await page.waitForFunction(() => document.documentElement.dataset.theme === 'dark');
        const ground = () => page.locator('#viewport').evaluate((e) => getComputedStyle(e).backgroundColor.match(/\d+/g).map(Number));
        await becomes(async () => Math.max(...await ground()) < 90, true, 'no bright strips at the sides of a picture');
    }));

test('beside an open panel, the notice of hidden equipment and a card cover neither the legend nor each other', options, () => onScreen(
    { viewport: { width: 1280, height: 640 } }, async (page) => {
        const parts = ['#legend', '.chip:not(.outside)', ':is(.panel, .display).open', '.viewport > #card'];
        const boxes = () => page.evaluate((all) => all.map((selector) => {
            const { left, top, right, bottom, width } = document.querySelector(selector)?.getBoundingClientRect() ?? { width: 0 };
            return { selector, left, top, right, bottom, width };
        }), parts);
        await page.evaluate(() => {
            const { session } = globalThis.plantcast;
            session.setParams({ hidden: [session.model.assets.at(-1).id] });
        });
        await visible(page, '.chip:not(.outside)');
        await ask(page, 'selectTag');
        await visible(page, '.viewport > #card');
        for (const [width, height] of [[1280, 640], [1024, 600]]) {
            await resize(page, { width, height });
            if (width < 1280) { // no room for a card between legend and panel
                await page.evaluate(() => globalThis.plantcast.selectTag(null));
                await hidden(page, parts.pop());
            }
            for (const [button, panel] of [['picture', '#picture-panel'], ['display', '#display']]) {
                await page.locator(`#${button}-toggle`).click();
                await visible(page, `${panel}.open`);
                await becomes(async () => {
                    const all = await boxes();
                    return all.flatMap((a, i) => (a.width > 0 ? all.slice(i + 1) : [{ selector: 'nothing' }])
                        .filter((b) => !b.width || (a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom))
                        .map((b) => `${a.selector} and ${b.selector}`));
                }, [], `${panel} at ${width}x${height}`);
                await shoot(page, `legend-chip-${button}-${width}`);
                await page.locator(`#${button}-toggle`).click();
            }
        }
    }));

const SHARP_PHONE = { ...PHONE, ...SHARP };
test('phone: sharp pixels, and a user chooses equipment from the list, flies there and taps a sensor',
    options, () => onOwnPage(SHARP_PHONE, async (page) => {
    const box = await page.locator('#viewport').boundingBox();
    await page.waitForFunction(([width, height]) => { // a preview has fewer pixels
        const canvas = document.getElementById('picture');
        return canvas.width === width && canvas.height === height;
    }, [box.width * 2, box.height * 2]);
    const { camera: home } = await view(page);
    await becomes(() => sticksOut(page), []);
    await becomes(() => tooSmall(page), []);
    await shoot(page, 'phone');
    await page.locator('#assets-toggle').tap();
    const row = page.locator('.asset', { hasText: 'sensors' }).first();
    await shoot(page, 'phone-list');
    await row.tap();
    await page.locator('#assets').waitFor({ state: 'hidden' }); // a tap on a row closes the list
    await page.waitForFunction((eye) => globalThis.plantcast.session.camera.eye.some((m, i) => m !== eye[i]), home.eye);
    await arrive(page);
    const selected = (await view(page)).params.selected;
    const sensor = await until(`a sensor of ${selected} in sight`, async () =>
        (await markers(page)).find((m) => m.asset === selected && !m.occluded));
    await page.touchscreen.tap(sensor.pageX, sensor.pageY);
    await page.locator('#card h3', { hasText: sensor.name }).waitFor();
    await becomes(() => sticksOut(page), []);
    await shoot(page, 'phone-card');
}));

const PHONES = [[390, 844], [844, 390], [360, 640]];
const SHEETS = { 'alarm-strip': '#alarms', 'views-toggle': '#views', 'picture-toggle': '#picture-panel', 'display-toggle': '#display',
    'assets-toggle': '#assets' };
const boxOf = (page, selector) => page.locator(selector).boundingBox();

test('phones: panels are sheets of at most 40 % beside the picture, the legend is a strip', options, () => onScreen(PHONE, async (page) => {
    for (const [row, [width, height]] of PHONES.entries()) {
        const upright = height > width, name = `${width}x${height}`;
        await resize(page, { width, height });
        // waits for the legend's height, because the browser sends the click that opens or closes it some time after the tap
        const isOpen = (is) => page.waitForFunction((open) => {
            const { height: high } = document.getElementById('legend').getBoundingClientRect();
            return open ? high > 60 : high === 28;
        }, is);
        await isOpen(false);
        await page.locator('#legend').tap();
        await isOpen(true);
        await page.locator('#legend').tap();
        await isOpen(false);
        const { height: tall } = await boxOf(page, '#viewport');
        assert.ok(tall >= (upright ? 0.6 : 0.8) * height, `${name}: the bars leave a picture of ${tall} px`);
        for (const [button, sheet] of Object.entries(SHEETS).filter((_, i) => !upright || takes(row / 2, i, 2))) {
            await page.locator(`#${button}`).tap();
            await page.waitForFunction(([one, side, whole]) => {
                const box = document.querySelector(one).getBoundingClientRect();
                return box[side] > 0 && box[side] <= 0.4 * whole + 1;
            }, [sheet, upright ? 'height' : 'width', upright ? height : width]);
            const [picture, box] = await Promise.all(['#viewport', sheet].map((one) => boxOf(page, one)));
            const apart = upright ? box.y >= picture.y + picture.height - 1 : box.x >= picture.x + picture.width - 1;
            assert.ok(apart, `${name} ${sheet}: ${JSON.stringify([picture, box])}`);
            assert.ok(upright ? picture.height > 0.15 * height : picture.width > 0.55 * width, `${name} ${sheet}`);
            if (upright && sheet === '#alarms') {
                await page.touchscreen.tap(box.x + box.width / 2, box.y + 8); // taps the grip, which folds the sheet
                await page.waitForFunction((most) => document.querySelector('#alarms').offsetHeight <= most, 0.2 * height + 1);
                await page.touchscreen.tap(box.x + box.width / 2, (await boxOf(page, sheet)).y + 8);
                await page.waitForFunction((least) => document.querySelector('#alarms').offsetHeight > least, 0.3 * height);
            }
            await page.locator(`#${button}`).tap();
            await page.locator(sheet).waitFor({ state: 'hidden' });
        }
        const tag = await page.evaluate(() => {
            const { session, showTag } = globalThis.plantcast, one = session.model.tags.find(({ group, position }) => group && position);
            showTag(one);
            return one.name;
        });
        await page.locator('#card').getByText(tag).first().waitFor();
        const [picture, card] = await Promise.all(['#viewport', '#card'].map((one) => boxOf(page, one)));
        assert.ok(upright ? card.y >= picture.y + picture.height - 1 && card.height <= 0.4 * height + 1
            : card.x >= picture.x + picture.width - 1 && card.width <= 0.4 * width + 1, `${name} card`);
        await page.evaluate(() => globalThis.plantcast.selectTag(null));
        await page.locator('#card').waitFor({ state: 'hidden' });
    }
}));

const heightOf = (page, selector) => page.evaluate((one) => document.querySelector(one).getBoundingClientRect().height, selector);
const visible = (page, selector) => page.locator(selector).waitFor();
const hidden = (page, selector) => page.locator(selector).waitFor({ state: 'hidden' });
const ask = (page, name) => page.evaluate((f) => {
    const { plantcast } = globalThis, { model } = plantcast.session;
    plantcast[f](model.tags.find(({ group, position }) => group && position));
}, name);

test('phones: the button of a list that a card or a trend covers shows the list again', options, () => onScreen(PHONE, async (page) => {
    for (const [row, [width, height]] of PHONES.entries()) {
        await page.setViewportSize({ width, height });
        for (const [i, [button, list]] of [['#alarm-strip', '#alarms'], ['#assets-toggle', '#assets']].entries())
            for (const [call, cover] of [['selectTag', '#card'], ['showTrend', '#trends']].filter((_, j) => takes(row, i + j, 2))) {
                await page.locator(button).tap();
                await visible(page, list);
                await ask(page, call);
                await visible(page, cover);
                await hidden(page, list);
                await page.locator(button).tap();
                await visible(page, list);
                await hidden(page, cover);
                await page.locator(button).tap();
                await hidden(page, list);
            }
    }
}));

// The alarm strip stays at the top of a phone's screen, where no sheet and no hand covers it. What users press often is in the lower half:
// Google Maps places its bar and its sheets there, too.
test('phones: one thumb opens and closes the alarm list, and reaches the controls that users press often', options, () => onScreen(PHONE,
    async (page) => {
        for (const [width, height] of PHONES) {
            const upright = height > width, name = `${width}x${height}`;
            await resize(page, { width, height });
            const often = ['#alarms-toggle', '#home', '#more-toggle',
                ...upright ? ['#assets-toggle', '#groups', '#views-toggle', '#time-toggle'] : []];
            await becomes(() => page.evaluate((all) => all.filter((selector) => {
                const { left, right, top, bottom } = document.querySelector(selector).getBoundingClientRect();
                const isIn = left >= 0 && right <= innerWidth && bottom <= innerHeight && (top + bottom) / 2 > innerHeight / 2;
                return !isIn || !document.elementFromPoint((left + right) / 2, (top + bottom) / 2)?.closest(selector);
            }), often), [], name);
            const tools = await boxOf(page, '.actions');
            assert.ok(upright || tools.x + tools.width >= width - 1, `${name}: the column of tools is where the right thumb is`);
            await becomes(() => page.evaluate(() => document.getElementById('alarms-toggle').dataset.count ===
                String(globalThis.plantcast.session.model.alarms.counts().active || '')), true, name, 20);
            await page.locator('#alarms-toggle').tap();
            await visible(page, '#alarms');
            assert.equal(await page.locator('#alarms-toggle').getAttribute('aria-expanded'), 'true');
            await shoot(page, `phone-thumb-${name}`);
            await page.locator('#alarms-toggle').tap();
            await hidden(page, '#alarms');
            assert.equal(await page.evaluate(() => document.activeElement.id), 'alarms-toggle');
        }
        await resize(page, { width: 1280, height: 800 });
        await page.locator('#alarms-toggle').waitFor({ state: 'detached' });
    }));

test('phones: sheets, time bar and trends leave room for the picture; the sheet\'s grip has two heights',
    options, () => onScreen(PHONE, async (page) => {
    await page.waitForFunction(() => globalThis.plantcast.session.recorded);
    for (const [width, height] of PHONES.filter(([w, h]) => h > w)) {
        const name = `${width}x${height}`, low = height < 700;
        const leaves = async (what, part) => {
            const tall = await heightOf(page, '#viewport');
            await shoot(page, `phone-${name}-${what}`);
            assert.ok(tall >= part * height, `${name} ${what}: a picture of ${tall.toFixed(0)} px`);
        };
        await page.setViewportSize({ width, height });
        await ask(page, 'selectTag');
        await visible(page, '#card');
        await leaves('card', 0.3);
        await page.locator('#time-toggle').tap();
        await visible(page, '#time-slider');
        await leaves('card-time', 0.2);
        await page.locator('#alarm-strip').tap();
        await visible(page, '#alarms');
        await leaves('alarms-time', 0.2);
        const [stage, list] = await Promise.all(['.stage', '#alarms'].map((one) => boxOf(page, one)));
        assert.ok(Math.abs(stage.y + stage.height - list.y - list.height) < 1, `${name}: there is no gap below the list`);

        const isAt = (part) => page.waitForFunction((px) => Math.abs(document.getElementById('alarms').offsetHeight - px) < 2,
            part * height);
        const usual = low ? 0.22 : 0.4, other = low ? 0.4 : 0.2, hand = await touches(page);
        const drag = async (px) => {
            const { x, y } = await boxOf(page, '#alarms'), at = [[x + width / 2, y + 8]];
            await hand.drag(at, [[at[0][0], at[0][1] + px]]);
        };
        await isAt(usual);
        const least = Math.min(usual, other);
        for (const [px, part] of [[0, other], [0, usual], [-40, 0.4], [-40, 0.4], [40, least], [40, least]]) {
            await drag(px);
            await isAt(part);
        }
        await page.locator('#time-toggle').tap();
        await isAt(0.4);
        await ask(page, 'showTrend');
        await visible(page, '#trends');
        await leaves('trend', 0.2);
        await ask(page, 'selectTag');
        await visible(page, '#card');
        await leaves('trend-card', 0.2);
        await becomes(() => page.evaluate(() => {
            const [value, button] = ['.value', '.trends-of'].map((part) => document.querySelector(`#card ${part}`).getBoundingClientRect());
            const card = document.getElementById('card').getBoundingClientRect();
            return [value.top >= card.top && value.bottom <= card.bottom, button.left >= value.left + 90 || button.top >= value.bottom];
        }), [true, true], `${name}: the card's value is complete, and no button covers it`, 20);
        await page.locator('#trend-close').tap();
        await page.evaluate(() => globalThis.plantcast.selectTag(null));
        await page.locator('#alarm-strip').tap();
        await hidden(page, '#alarms');
    }
}));

test('phones: a trend\'s chart is readable, its table fits, and the picture stays visible', options, () => onScreen(PHONE, async (page) => {
    await page.waitForFunction(() => globalThis.plantcast.session.recorded);
    await page.evaluate(() => {
        const { addTrend, session: { model }, showTrend } = globalThis.plantcast;
        const temperatures = model.tags.filter(({ group }) => group === 'temperature').slice(0, 3);
        temperatures.forEach((tag, i) => (i === 0 ? showTrend : addTrend)(tag));
    });
    await page.waitForFunction(() => globalThis.plantcast.trends?.series.size === 3);
    // chooses the span of 30 days, of which only minutes are recorded, so that the table shows its column for incomplete
    // periods
    await page.locator('#trend-span label').nth(4).tap();
    await page.locator('#trend-tags.lacks .known').first().waitFor();
    for (const [width, height] of PHONES) {
        const name = `${width}x${height}`, isLying = width > height;
        await resize(page, { width, height });
        await until(`${name}: a chart and a picture`, async () => {
            const [chart, picture] = await Promise.all(['#trend-chart', '#viewport'].map((one) => heightOf(page, one)));
            return chart >= (isLying ? 130 : 110) && picture >= 0.25 * height;
        }, 30);
        await shoot(page, `phone-trend-${name}`);
        const hidden = await page.locator('.trends .scroll').evaluate((e) => e.scrollWidth - e.clientWidth);
        assert.ok(hidden <= 0, `${name}: ${hidden} px of the table are hidden`);
        const cut = () => page.evaluate(() => {
            const [table, note] = ['.trends .scroll', '#trend-note'].map((one) => document.querySelector(one).getBoundingClientRect());
            const rows = [...document.querySelectorAll('#trend-tags tr')].map((row) => row.getBoundingClientRect());
            return { rows: rows.filter(({ top, bottom }) => top < table.bottom - 1 && bottom > table.bottom + 1).length,
                seen: rows.filter(({ bottom }) => bottom <= table.bottom + 1).length, isNear: note.top < table.bottom + 3 };
        });
        await becomes(cut, { rows: 0, seen: 3, isNear: false }, `${name}: the table ends with a row, above the note`);
    }
}));

test('phones: charts that would be too low are shown one at a time, with a switch', options, () => onScreen(PHONE, async (page) => {
    await page.waitForFunction(() => globalThis.plantcast.session.recorded);
    await page.evaluate(() => {
        const { addTrend, session: { model }, showTrend } = globalThis.plantcast;
        ['temperature', 'pressure', 'vibration'].map((name) => model.tags.find(({ group }) => group === name))
            .forEach((tag, i) => (i === 0 ? showTrend : addTrend)(tag));
    });
    await page.waitForFunction(() => globalThis.plantcast.trends?.series.size === 3);
    // Returns the number of charts, their least height, whether each has its whole height on the screen, and their units.
    const charts = () => page.evaluate(() => {
        const outer = document.getElementById('trend-chart').getBoundingClientRect();
        const all = [...document.querySelectorAll('#trend-chart .uplot')].map((e) => e.getBoundingClientRect());
        return { count: all.length, least: Math.min(...all.map(({ height }) => height)),
            whole: all.every(({ top, bottom }) => top >= outer.top - 1 && bottom <= outer.bottom + 1),
            units: globalThis.plantcast.trends.plots.flatMap(({ units }) => units) };
    });
    const choices = page.locator('#trend-charts label:visible');
    for (const [width, height] of PHONES) {
        const name = `${width}x${height}`, isLying = width > height;
        await resize(page, { width, height });
        await until(`${name}: charts that can be read`, async () => {
            const { count, least, whole } = await charts();
            return whole && least >= (isLying ? 130 : 100) && await choices.count() === (count === 1 ? 2 : 0);
        }, 30);
        await shoot(page, `phone-charts-${name}`);
        if (!isLying)
            continue;
        for (const [i, units] of [['mm/s'], ['°C', 'bar']].entries()) {
            await choices.nth(1 - i).tap();
            await becomes(async () => (await charts()).units, units, name);
        }
        await page.locator('#trend-tags .name').last().tap(); // the chart of this tag
        await becomes(async () => (await charts()).units, ['mm/s'], name);
        await becomes(() => tooSmall(page), [], name);
        await page.locator('#time-toggle').tap();
        await page.locator('#time-slider').waitFor();
        await becomes(async () => {
            const { count, least, whole } = await charts(), picture = await heightOf(page, '#viewport');
            return count === 1 && whole && least >= 120 && picture >= 0.25 * height && await choices.count() === 2;
        }, true, `${name} with the time bar`);
        await shoot(page, `phone-charts-${name}-time`);
        await page.locator('#time-toggle').tap();
    }
}));

test('desktop: a trend takes eight tags and refuses a ninth, and all its charts share the crosshair', options, () => onScreen(LARGE,
    async (page) => {
        await page.waitForFunction(() => globalThis.plantcast.session.recorded);
        const ninth = await page.evaluate(() => {
            const { addTrend, session: { model }, showTrend } = globalThis.plantcast;
            const nine = ['temperature', 'pressure', 'vibration']
                .flatMap((id) => model.tags.filter(({ group }) => group === id).slice(0, 3));
            nine.slice(0, 8).forEach((tag, i) => (i === 0 ? showTrend : addTrend)(tag));
            return nine[8].name;
        });
        const isDrawn = () => page.waitForFunction(() => {
            const { trends } = globalThis.plantcast;
            return trends?.series.size === 8 && !trends.isAsking && trends.plots.length === 2 && trends.plots.every(({ chart }) => chart);
        });
        await isDrawn();
        const note = await page.evaluate((name) => {
            const { session, trends } = globalThis.plantcast;
            trends.add(session.model.tag(name));
            return document.getElementById('trend-note').textContent;
        }, ninth);
        assert.match(note, /\b8\b/);
        assert.equal(await page.locator('#trend-tags tbody tr').count(), 8);
        await isDrawn();
        await shoot(page, 'trend-eight');
        for (const from of [0, 1]) {
            const box = await page.locator('#trend-chart .u-over').nth(from).boundingBox(), part = [0.25, 0.75][from];
            await page.mouse.move(box.x + part * box.width, box.y + box.height / 2);
            await page.waitForFunction((at) => {
                const { trends: { plots, crosshairUs, range: [begin, end] } } = globalThis.plantcast;
                const parts = plots.map(({ chart }) => chart.cursor.left / chart.over.clientWidth);
                return [...parts, (crosshairUs - begin) / (end - begin)].every((is) => Math.abs(is - at) < 0.02);
            }, part);
        }
        await page.locator('#trend-close').click();
    }));

// has its own page, because Chromium may ignore taps after a gesture of two fingers
test('phone: two fingers pinch, twist and pan', options, () => onOwnPage(PHONE, async (page) => {
    const box = await boxOf(page, '#viewport'), [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const hand = await touches(page), azimuth = ({ camera: { eye, target } }) => Math.atan2(eye[1] - target[1], eye[0] - target[0]);
    const start = await view(page);
    await hand.drag([[x - 40, y], [x + 40, y]], [[x - 110, y], [x + 110, y]]);
    const pinched = await view(page);
    assert.ok(distance(pinched) < distance(start) * 0.6, 'pinching zooms in');
    assert.ok(Math.abs(azimuth(pinched) - azimuth(start)) < 1e-6, 'a pinch does not turn');
    await hand.drag([[x - 80, y], [x + 80, y]], [[x, y - 80], [x, y + 80]], 20);
    const twisted = await view(page), turned = ((azimuth(twisted) - azimuth(pinched)) * 180) / Math.PI;
    assert.ok(Math.abs(turned) > 45 && Math.abs(turned) < 100, `a quarter turn of the fingers: ${turned} degrees`);
    await hand.drag([[x - 40, y], [x + 40, y]], [[x - 40, y + 90], [x + 40, y + 90]]);
    const panned = await view(page);
    assert.ok(Math.abs(azimuth(panned) - azimuth(twisted)) < 1e-6 && Math.abs(distance(panned) / distance(twisted) - 1) < 0.1);
    assert.notDeepEqual(panned.camera.target, twisted.camera.target);
}));

// screen sizes [width, height] in CSS pixels: a phone held upright, the same phone held sideways, a small phone, and a folded
// one
const HELD = [[390, 844], [844, 390], [360, 740], [280, 653]];

test('phones: names and states are readable and complete, and controls are finger-sized', options, () => onScreen(PHONE, async (page) => {
    const rgb = (text) => text.match(/[\d.]+/g).slice(0, 3).map(Number);
    for (const [width, height] of HELD) {
        const name = `${width}x${height}`;
        await resize(page, { width, height });
        const words = await page.evaluate(() => ['plant-name', 'health'].map((id) => document.getElementById(id))
            .filter((e) => e.clientWidth < 30 || e.scrollWidth > e.clientWidth + 1).map((e) => e.id));
        assert.deepEqual(words, [], name);
        // with the longest text of the connection state, the state must not cover the words of the alarm strip
        const isOver = await page.evaluate(() => {
            const state = document.querySelector('#health .words'), { textContent } = state;
            state.textContent = 'Keine Verbindung zum Server';
            const strip = document.getElementById('alarm-strip'), [a, b, title] = [strip, document.querySelector('.identity'),
                document.getElementById('plant-name')].map((e) => e.getBoundingClientRect());
            state.textContent = textContent;
            if (title.top < 0 || title.bottom > b.bottom + 1)
                return `the name is cut: from ${title.top} to ${title.bottom}`;
            return b.top < a.bottom && a.top < b.bottom && b.left < a.right - parseFloat(getComputedStyle(strip).paddingRight);
        });
        assert.equal(isOver, false, name);
        await becomes(() => tooSmall(page), [], name);
        await becomes(() => sticksOut(page), [], name);
        if (height > width)
            await becomes(() => beyondThumb(page), [], name);
        await shoot(page, `phone-${name}`);

        await page.locator('#more-toggle').tap();
        await page.locator('#more.open').waitFor();
        const [more, ...others] = await Promise.all(['#more', '#legend', '#alarm-strip'].map((id) => page.locator(id).boundingBox()));
        for (const other of others)
            assert.ok(more.x >= other.x + other.width || more.y >= other.y + other.height,
                `${name}: legend and alarms are beside the sheet: ${JSON.stringify([more, other])}`);
        assert.ok(more.y >= 0 && more.x >= 0 && more.y + more.height <= height && more.x + more.width <= width, name);
        await becomes(() => tooSmall(page), [], name);
        await page.keyboard.press('Escape');
        await page.locator('#more.open').waitFor({ state: 'hidden' });
    }
    await page.locator('#more-toggle').tap();
    await page.locator('#measure').tap();
    await page.locator('#measure[aria-pressed="true"]').waitFor({ state: 'attached' });
    await page.locator('#more-toggle').tap();
    const [ink, ground] = await page.locator('#measure').evaluate((e) =>
        [getComputedStyle(e.querySelector('.words')).color, getComputedStyle(e).backgroundColor]);
    assert.ok(contrastRatio(rgb(ink), rgb(ground)) >= 4.5, `contrast of ${ink} on ${ground} is too low`);
    await page.locator('#measure').tap();

    await page.setViewportSize({ width: 390, height: 844 });
    await page.locator('#views-toggle').tap();
    await page.locator('#cut').waitFor();
    await becomes(() => tooSmall(page), [], 'views');
    await page.keyboard.press('Escape');
    await page.waitForFunction(() => globalThis.plantcast.session.recorded);
    await page.locator('#time-toggle').tap();
    await page.locator('#time-slider').waitFor();
    await becomes(() => tooSmall(page), [], 'history');
    await page.evaluate(() => globalThis.plantcast.showTrend(globalThis.plantcast.session.model.tags.find(({ group }) => group)));
    await page.locator('#trends .drop').first().waitFor();
    await becomes(() => tooSmall(page), [], 'trend');
}));

test('in a low window of a desk, no part of the page lies over another', options, () => onScreen(
    { viewport: { width: 1280, height: 420 } }, async (page) => {
        const meet = (one, other) => page.evaluate((both) => {
            const [a, b] = both.map((name) => document.querySelector(name).getBoundingClientRect());
            return a.width > 0 && b.width > 0 && a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
        }, [one, other]);
        await page.evaluate(() => globalThis.plantcast.session.setParams({ split: { group: 'pressure' } }));
        await page.locator('#split-bar').waitFor();
        await visible(page, '#legend-right');
        await becomes(() => meet('#legend-right', '#split-bar'), false, 'the right half\'s legend ends above the bar');
        await page.evaluate(() => globalThis.plantcast.session.setParams({ split: null }));
        await ask(page, 'showTrend');
        await page.locator('#trends .drop').first().waitFor();
        await page.evaluate(() => document.getElementById('time-toggle').click());
        await visible(page, '#time-slider');
        const [box, trends] = await Promise.all(['#assets', '#trends'].map((one) => boxOf(page, one)));
        assert.ok(box.y + box.height <= trends.y + 1 && await page.locator('#assets').evaluate((e) => getComputedStyle(e).overflow) ===
            'hidden', 'the list of equipment does not stick out over the trend');
        await hidden(page, '.timeline .line');
    }));

test('tablet in portrait: the equipment list is folded, nothing sticks out, and the buttons of a sensor\'s card are complete', options,
    () => onOwnPage({ ...TABLET, viewport: { width: 768, height: 1024 } }, async (page) => {
        assert.equal(await page.locator('#assets').isVisible(), false, 'the list is folded');
        await becomes(() => sticksOut(page), []);
        await shoot(page, 'tablet-upright');
        await ask(page, 'selectTag');
        await page.locator('#card .trends-of button').first().waitFor();
        await becomes(async () => {
            const [card, button] = await Promise.all(['#card', '#card .trends-of button >> nth=0'].map((one) => boxOf(page, one)));
            return button.y + button.height <= card.y + card.height && button.height >= 43.5;
        }, true);
    }));

test('at 200 % zoom the engineering panel is as high as the picture, and both fill the stage', options, () => onScreen(
    { viewport: { width: 640, height: 400 } }, async (page) => {
        await page.locator('#engineer-toggle').click();
        await page.locator('#engineer').waitFor();
        const heights = await Promise.all(['.stage', '#viewport', '#engineer'].map(async (one) =>
            Math.round((await boxOf(page, one)).height)));
        assert.deepEqual(heights, Array(3).fill(heights[0]));
    }));

test('on half-width legends of a phone, limit names do not overlap, and colour bar and numbers are complete', options, () => onScreen(
    { ...PHONE, viewport: { width: 360, height: 640 } }, async (page) => {
        await page.locator('#viewport').focus();
        await page.keyboard.press('j');
        await page.locator('#viewport.split #legend-right .ticks').waitFor();
        const limits = await page.evaluate(() => {
            const { legend, session } = globalThis.plantcast, group = session.model.group('temperature'), { limits: own } = group;
            group.limits = { LL: 60, L: 62, H: 64, HH: 66 };
            legend.show(true);
            return own;
        });
        for (const id of ['legend', 'legend-right']) {
            const [title, bar, first, last, right] = await page.locator(`#${id}`).evaluate((e) => [
                ...['h2', '.bar', '.ticks span:nth-of-type(1)', '.ticks span:last-child'].map((part) =>
                    e.querySelector(part).getBoundingClientRect()).map(({ left, right: end, width }) => ({ left, end, width })),
                e.getBoundingClientRect().right]);
            assert.ok(bar.width >= 30 && first.left >= title.end && last.left > first.end && last.end <= right,
                `${id}: ${JSON.stringify([title, bar, first, last, right])}`);
        }
        const { height: low } = await boxOf(page, '#legend');
        await page.locator('#legend').tap();
        await page.waitForFunction((was) => document.getElementById('legend').getBoundingClientRect().height > was, low);
        for (const width of ['', '60px']) {
            await page.locator('#legend .scale').evaluate((e, wide) => { e.style.width = wide; }, width);
            const names = await page.evaluate(() => {
                const { legend } = globalThis.plantcast, was = legend.element.querySelector('.scale').style.width;
                legend.fit();
                legend.element.querySelector('.scale').style.width = was;
                return [...legend.element.querySelectorAll('.limits span')].map((e) => [e.textContent, e.getBoundingClientRect()])
                    .map(([text, { left, right }]) => ({ text, left, right }));
            });
            assert.deepEqual(names.map(({ text }) => text), width ? ['LL', 'HH'] : ['LL', 'L', 'H', 'HH']);
            assert.ok(names.every(({ left }, i) => i === 0 || left >= names[i - 1].right), JSON.stringify(names));
        }
        await page.evaluate((own) => {
            const { legend, session } = globalThis.plantcast;
            session.model.group('temperature').limits = own;
            legend.element.querySelector('.scale').style.width = '';
            legend.show(true);
        }, limits);
    }));
