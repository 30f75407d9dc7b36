// SPDX-License-Identifier: GPL-3.0-or-later
// Layout on every screen: lists and panels lie next to the picture, and the controls needed to read it stay complete and
// visible.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { before, test } from 'node:test';
import { alarmed } from './alarmed.mjs';
import {
    arrive, keepMediaQueries, land, openPage, PHONE, pixelRatioOf, resize, settle, shoot, TABLET, waitForPicture, withPage,
} from '../support/browser.mjs';
import { startAlarmed } from '../support/panels.mjs';
import { sweep, takes } from '../support/sweep.mjs';
import { notBuilt } from '../support/tiny_plant.mjs';
import { becomes } from '../support/until.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
const SCREENS = {
    desk: { viewport: { width: 1280, height: 800 } },
    'low window': { viewport: { width: 1280, height: 520 } },
    tablet: TABLET,
    'tablet upright': { ...TABLET, viewport: { width: 768, height: 1024 } },
    phone: PHONE,
    'phone across': { ...PHONE, viewport: { width: 844, height: 390 } },
};
// Screens on which all panels are opened; by default only those with little room.
const WALKED = sweep(Object.keys(SCREENS), ['tablet upright', 'phone across']);
let url;

before(async () => {
    if (!options.skip)
        [, url] = await alarmed();
});

// Returns the layout faults: elements that cover the picture, or leave it, although they should not, and missing parts of the
// legend.
const amiss = (page) => page.evaluate(() => {
    const box = (element) => element.getBoundingClientRect(), picture = box(document.getElementById('viewport'));
    const shown = (selector) => [...document.querySelectorAll(selector)].filter((e) => e.checkVisibility() && box(e).width > 0);
    const within = (a, b) => a.left >= b.left - 1 && a.right <= b.right + 1 && a.top >= b.top - 1 && a.bottom <= b.bottom + 1;
    const meet = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    const found = [];
    for (const panel of shown('.alarms, .engineer, .lower, .alarm-strip, .toolbar'))
        if (meet(box(panel), picture) || !within(box(panel), { left: 0, top: 0, right: innerWidth, bottom: innerHeight }))
            found.push(`${panel.className} lies over the picture or leaves the screen`);
    for (const cell of shown('.status .cell'))
        if (!within(box(cell), { left: 0, top: 0, right: innerWidth, bottom: innerHeight }))
            found.push(`${cell.textContent} is cut off`);
    for (const part of shown('.viewport > .card, .viewport > .legend'))
        if (!within(box(part), picture))
            found.push(`${part.id} leaves the picture`);
    const legend = document.getElementById('legend'), strip = box(legend).height <= 28;
    const texts = [...legend.querySelectorAll('.ticks span, .limits span, .keys span')]
        // on a phone, the legend is a low strip that hides some of its texts until it is tapped; hidden texts are not checked
        .filter((text) => !strip || text.checkVisibility());
    const isSaid = shown('#legend').length > 0 && /No data|Keine Daten/.test(legend.querySelector('.keys').textContent);
    if (picture.height > (innerWidth < 720 ? 125 : 200) && !isSaid)
        found.push('no legend, or no key for what has no data');
    for (const [i, text] of texts.entries()) {
        if (shown('#legend').length > 0 && (!text.checkVisibility() || !within(box(text), box(legend))))
            found.push(`${text.textContent} is not within the legend`);
        if (texts.slice(i + 1).some((other) => meet(box(text), box(other))))
            found.push(`${text.textContent} is written over another`);
    }
    return found;
});

// Returns the faults of a tag's marker, which must lie in the picture with nothing in front of it.
const inSight = (page, name) => page.evaluate((tag) => {
    const { overlay, session } = globalThis.plantcast, marker = overlay.marker(session.model.tag(tag));
    if (!marker)
        return 'no marker';
    const { x, y } = overlay.placeOf(marker), origin = document.getElementById('viewport').getBoundingClientRect();
    const before = document.elementFromPoint(origin.left + x, origin.top + y);
    return before?.closest('.viewport > canvas, .viewport') && !before.closest('.card') ? 'in sight' : before?.id || before?.className;
}, name);

for (const name of WALKED) {
    const screen = SCREENS[name];
    test(`${name}: an alarm, its place, its trend, the past and the engineer's panel are all complete and usable`, options, async (t) => {
        const browser = await openPage(url, screen), { page } = browser, file = name.replace(' ', '-');
        t.after(() => browser.close());
        const press = (selector) => (screen.hasTouch ? page.locator(selector).first().tap() : page.locator(selector).first().click());
        await waitForPicture(page);
        await page.waitForFunction(() => globalThis.plantcast.session.model.alarms.list().length > 0 &&
            globalThis.plantcast.session.recorded && !document.getElementById('legend').hidden);
        await land(page);
        await becomes(() => amiss(page), [], 'as it opens');
        await press('#alarm-strip');
        await page.locator('#alarms-list tr').first().waitFor();
        await land(page);
        await becomes(() => amiss(page), [], 'alarms');
        await page.locator('#alarms-list tr', { hasText: 'TI-1' }).locator('.alarm-go').first().click();
        await page.locator('#card').waitFor();
        await arrive(page);
        await becomes(() => amiss(page), [], 'flown to');
        await becomes(() => inSight(page, 'TI-1'), 'in sight');
        await shoot(page, `room-${file}-alarm`);
        await press('#card .trend'); // opens the trend from the card: press() fails if anything covers the button
        await page.locator('#trend-chart canvas').waitFor();
        await press('#time-toggle');
        await page.locator('#time-slider').waitFor();
        await arrive(page);
        await becomes(() => amiss(page), [], 'trend and past');
        await shoot(page, `room-${file}-trend`);
        await press('#trend-close');
        await press('#time-toggle');
        const listed = await page.locator('#alarms').isVisible();
        await press('#engineer-toggle');
        await page.locator('#engineer').waitFor();
        await page.locator('#alarms').waitFor({ state: 'hidden' }); // one of both is open
        if (listed) { // if the alarm list was open: opens it again, which closes the engineer's panel, and then the other way round
            await press('#alarm-strip');
            await page.locator('#engineer').waitFor({ state: 'hidden' });
            await press('#engineer-toggle');
            await page.locator('#alarms').waitFor({ state: 'hidden' });
        }
        await page.locator('#engineer .tags button', { hasText: 'TI-2' }).click();
        await arrive(page);
        await becomes(() => amiss(page), [], 'engineer');
        await becomes(() => inSight(page, 'TI-2'), 'in sight');
        await shoot(page, `room-${file}-engineer`);
        assert.deepEqual(browser.errors, []);
    });
}

// Returns panels and dialogs that extend beyond the screen or cover the buttons that opened them, and texts that extend beyond
// their panel.
const panelsAmiss = (page) => page.evaluate(() => {
    const box = (element) => element.getBoundingClientRect(), found = [];
    const buttons = box(document.querySelector('.actions'));
    const open = [...document.querySelectorAll('.panel.open, .display.open, .more.open, dialog[open]')];
    for (const panel of open) {
        const { left, top, right, bottom } = box(panel), legend = document.getElementById('legend');
        if (left < 0 || top < 0 || right > innerWidth || bottom > innerHeight)
            found.push(`${panel.id} leaves the screen: ${[left, top, right, bottom].map(Math.round)}`);
        const meets = top < buttons.bottom && bottom > buttons.top && left < buttons.right && right > buttons.left;
        if (panel.localName !== 'dialog' && meets)
            found.push(`${panel.id} lies over the buttons`);
        const isCut = panel.scrollHeight > panel.clientHeight + 1 && getComputedStyle(panel).overflowY !== 'auto';
        if (panel.scrollTop > 0)
            found.push(`${panel.id} does not begin with its first line`);
        if (panel.scrollWidth > panel.clientWidth + 1 || isCut)
            found.push(`${panel.id} is cut off`);
        if (panel.matches('.panel, .display') && innerWidth >= 720 && legend.checkVisibility() && box(legend).right > left)
            found.push(`${panel.id} lies over the legend`);
        if (legend.scrollWidth > legend.clientWidth + 1)
            found.push(`beside ${panel.id} the legend is too narrow`);
    }
    return open.length === 1 ? found : [...found, `${open.length} are open`];
});

test('panels and the help page are complete on every screen', options, async (t) => {
    const narrow = ['tablet upright', 'phone'];
    const ways = Object.entries(SCREENS).filter(([name]) => sweep(true, narrow.includes(name))).flatMap((one, row) =>
        ['en', 'de', 'ko'].filter((_, i) => takes(row, i, 3)).map((language) => [...one, language]));
    for (const [name, screen, language] of ways)
        await t.test(`panels and help on ${name}, ${language}`, async () => {
            await withPage(`${url}?lang=${language}`, screen, async (page) => {
                await waitForPicture(page);
                for (const [key, opened] of [['v', '#views.open'], ['p', '#picture-panel.open'], ['?', '#help[open]']]) {
                    await page.locator('#viewport').focus();
                    await page.keyboard.press(key);
                    await page.locator(opened).waitFor();
                    await becomes(() => panelsAmiss(page), [], opened);
                    await page.keyboard.press('Escape');
                    await page.locator(opened).waitFor({ state: 'hidden' });
                }
                for (const id of ['display', 'more']) {
                    if (!await page.locator(`#${id}-toggle`).isVisible())
                        continue;
                    await page.locator(`#${id}-toggle`).click();
                    await page.locator(`#${id}.open`).waitFor();
                    await becomes(() => panelsAmiss(page), [], id);
                    await page.locator(`#${id}-toggle`).click();
                }
            });
        });
});

test('the banner about an old picture covers no legend', options, async () => {
    const most = sweep(SCREENS, { phone: PHONE });
    const wall = { viewport: sweep({ width: 3840, height: 2160 }, { width: 1920, height: 1080 }) };
    const more = { ...sweep({ 'large desk': { viewport: { width: 1440, height: 900 } } }, {}), wall };
    for (const [name, screen] of Object.entries({ ...more, ...most })) {
        await withPage(`${url}?lang=de${name === 'wall' ? '&wall' : ''}`, screen, async (page) => {
            await waitForPicture(page);
            await page.locator('.legend:visible').first().waitFor();
            await page.evaluate(() => {
                const { connection } = globalThis.plantcast.session;
                connection.connect = () => {};
                connection.lose('Der Server ist nicht erreichbar');
            });
            await page.locator('#banner').waitFor();
            await page.waitForFunction(() => {
                const [a, b] = ['banner', 'legend'].map((id) => document.getElementById(id).getBoundingClientRect());
                return b.width === 0 || a.bottom <= b.top || a.right <= b.left;
            }).catch(() => assert.fail(name));
            // on a phone held sideways there is no room for both texts, so one is cut off and the layout is not checked
            if (name !== 'phone across')
                await becomes(() => amiss(page), [], name);
            await shoot(page, `old-${name.replace(' ', '-')}`);
        });
    }
});

test('after a resize, the old picture stays undistorted and its marks stay in place until the new picture arrives', options, async () => {
    await withPage(`${url}?lang=en`, SCREENS.desk, async (page) => {
        await waitForPicture(page);
        await arrive(page);
        await page.waitForFunction(() => globalThis.plantcast.overlay.markers.length > 0);
        // the page no longer tells the server its size, so no picture of the new size arrives
        await page.evaluate(() => { globalThis.plantcast.session.resize = () => {}; });
        const seen = () => page.evaluate(async () => {
            const { projector } = await import('/core/camera.js');
            const { overlay, session: { picture }, viewport } = globalThis.plantcast, canvas = document.getElementById('picture');
            const box = canvas.getBoundingClientRect(), place = viewport.element.getBoundingClientRect();
            const project = projector(picture.camera, canvas.width, canvas.height);
            const across = box.width / canvas.width, up = box.height / canvas.height;
            const off = overlay.markers.map(({ tag, x, y }) => {
                const [px, py] = project(tag.position);
                return Math.hypot(box.left + px * across - place.left - x, box.top + py * up - place.top - y);
            });
            return { across, up, off: Math.max(...off), width: place.width, count: off.length };
        });
        const first = await seen();
        for (const id of ['assets-close', 'alarm-strip']) {
            const before = await seen();
            await page.locator(`#${id}`).click();
            await page.waitForFunction((width) => document.getElementById('viewport').clientWidth !== width, before.width);
            await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
            const { across, up, off, count } = await seen();
            await shoot(page, `shape-${id}`);
            assert.ok(Math.abs(across - up) < 0.005 * up, `${id}: ${across.toFixed(3)} across, ${up.toFixed(3)} up`);
            assert.ok(count > 0 && off < 1.5, `${id}: marks up to ${off.toFixed(1)} px off`);
        }
        assert.ok(Math.abs(first.across - first.up) < 1e-3 && first.off < 1.5, JSON.stringify(first));
    });
});

test('in the low picture above a trend and the time bar, legend and banner are complete, and do not overlap', options, async () => {
    for (const [width, height] of sweep([[1024, 768], [1280, 800], [1280, 640]], [[1024, 768]]))
        await withPage(`${url}?lang=en`, { viewport: { width, height }, hasTouch: true }, async (page) => {
            await waitForPicture(page);
            await page.waitForFunction(() => globalThis.plantcast.session.recorded);
            await page.evaluate(() => {
                const { session, showTrend } = globalThis.plantcast;
                showTrend(session.model.tag('TI-1'));
            });
            await page.locator('#trend-chart canvas').waitFor();
            await page.locator('#time-toggle').click();
            await page.locator('#time-slider').waitFor();
            await page.locator('#hold').click();
            await page.locator('#banner[data-kind="past"]').waitFor();
            await becomes(() => page.evaluate(() => {
                const [picture, legend, banner, end] = ['#viewport', '#legend', '#banner', '#legend .end.below']
                    .map((part) => document.querySelector(part).getBoundingClientRect());
                return { below: legend.bottom <= picture.bottom && end.height > 0 && end.bottom <= legend.bottom,
                    apart: banner.right <= legend.left || banner.bottom <= legend.top, inside: banner.left >= picture.left };
            }), { below: true, apart: true, inside: true }, `${width}x${height}`, 20);
            await shoot(page, `low-past-${width}`);
        });
});

// Sizes of windows with little room next to a panel, and of tablets, from narrow to wide: a window that becomes wide opens the list of
// equipment, as a new page does.
const LITTLE = sweep([[740, 560], [768, 1024], [820, 1180], [1024, 600], [1024, 768], [1100, 700], [1199, 640], [1280, 640]],
    [[768, 1024], [1024, 600], [1280, 640]]);
// Returns whether the card is visible, and the faults of its position: what it overlaps, and whether it leaves the picture.
const cardOf = (page, id = 'card') => page.evaluate((name) => {
    const card = document.getElementById(name), box = (element) => element.getBoundingClientRect(), a = box(card);
    const isSeen = card.checkVisibility({ visibilityProperty: true }), picture = box(document.getElementById('viewport'));
    const others = '.panel.open, .display.open, .more.open, .legend, .alarms, .engineer, .assets, .toolbar, .lower, #split-bar';
    const over = [...document.querySelectorAll(others)].filter((other) => other.checkVisibility()).filter((other) => {
        const b = box(other);
        return isSeen && a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    }).map((other) => other.id || other.className);
    const leaves = a.left < picture.left - 1 || a.top < picture.top - 1 || a.right > picture.right + 1 || a.bottom > picture.bottom + 1;
    return { isSeen, over: isSeen && leaves ? [...over, 'the edge of the picture'] : over };
}, id);

// Opens a page in the first of these sizes, and presses sensors and opens panels in each of them.
async function checkCards(sizes) {
    const panels = { picture: '#picture-panel.open', views: '#views.open', display: '#display.open', more: '#more.open' };
    const lists = { none: null, alarms: '#alarm-strip', engineer: '#engineer-toggle' };
    const seen = { isSeen: true, over: [] };
    const [[width, height]] = sizes;
    await withPage(`${url}?lang=de`, { viewport: { width, height } }, async (page) => {
        await waitForPicture(page);
        const select = (tag) => page.evaluate((name) => {
            const { selectTag, session } = globalThis.plantcast;
            selectTag(name && session.model.tag(name));
        }, tag);
        for (const [wide, high] of sizes) {
            await resize(page, { width: wide, height: high });
            await arrive(page);
            for (const [list, opener] of Object.entries(lists)) {
                if (opener)
                    await page.locator(opener).click();
                await select('TI-1');
                await page.locator('#card').waitFor();
                for (const [panel, element] of Object.entries(panels)) {
                    const name = `${wide}x${high}, ${list}, ${panel}`, button = page.locator(`#${panel}-toggle`);
                    if (!await button.isVisible())
                        continue;
                    await becomes(() => cardOf(page), seen, `before ${name}`, 20);
                    await button.click();
                    await page.locator(element).waitFor();
                    await becomes(async () => (await cardOf(page)).over, [], name, 20);
                    await shoot(page, `card-${name.replaceAll(', ', '-')}`);
                    if (list !== 'engineer') { // the engineering panel itself takes presses on sensors
                        await select(null);
                        await page.evaluate(() => {
                            const { handlers, overlay, session } = globalThis.plantcast, marker = overlay.marker(session.model.tag('TI-1'));
                            handlers.click(marker.x, marker.y, 'mouse');
                        });
                        await becomes(() => cardOf(page), seen, `${name}, after a press on the sensor`, 20);
                    }
                    if (await page.locator(element).isVisible())
                        await button.click();
                }
                await select(null);
            }
            await page.locator(lists.engineer).click();
            await page.locator('#engineer').waitFor({ state: 'hidden' });
        }
    });
}

test('a card is never under a panel; a pressed sensor\'s card replaces a panel that leaves it no room', options, async () => {
    for (const sizes of sweep(LITTLE.map((size) => [size]), [LITTLE])) // only long runs open a new page in each size
        await checkCards(sizes);
});

// In a split view, the left half's legend lies near the middle of the picture, so that there may be little room on either side of it.
test('no legend hides the card of a sensor in a split view without open panels', options, async () => {
    for (const [width, height] of sweep([[1024, 768], [740, 560]], [[740, 560]]))
        await withPage(`${url}?lang=de`, { viewport: { width, height } }, async (page) => {
            await waitForPicture(page);
            await arrive(page);
            for (const split of [null, { show: 'operator' }]) {
                await page.evaluate((to) => {
                    const { selectTag, session } = globalThis.plantcast;
                    session.setParams({ split: to });
                    selectTag(session.model.tag('TI-1'));
                }, split);
                await page.locator('#legend-right').waitFor({ state: split ? 'visible' : 'hidden' });
                for (const lists of ['no list', 'the alarm list']) {
                    await page.locator('#alarms').waitFor({ state: lists === 'no list' ? 'hidden' : 'visible' });
                    await settle(page);
                    // waits for a picture of the new size, and until the card is moved for it
                    await page.waitForFunction(() => {
                        const { session: { picture }, viewport } = globalThis.plantcast;
                        return Math.abs(picture.fullWidth - viewport.width * devicePixelRatio) <= 2;
                    });
                    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
                    const name = `${width}x${height}, ${split ? 'split' : 'whole'}, ${lists}`;
                    await becomes(async () => (await cardOf(page)).isSeen, true, name, 20);
                    await shoot(page, `card-legend-${name.replaceAll(/\W+/g, '-')}`);
                    await page.locator('#alarm-strip').click();
                }
            }
        });
});

// Makes the browser observe sizes in CSS pixels only, as Safari does.
function observeAsSafari() {
    const { observe } = ResizeObserver.prototype;
    ResizeObserver.prototype.observe = function observeCssPixels(element, options) {
        if (options?.box === 'device-pixel-content-box')
            throw new TypeError('unsupported box');
        observe.call(this, element, options);
    };
}

test('each change of the pixel ratio brings pictures and a legend with as many pixels as the screen has', options, async () => {
    for (const [name, isSafari] of [['Chromium', false], ['Safari', true]])
        await withPage(`${url}?lang=en`, SCREENS.desk, async (page) => {
            await waitForPicture(page);
            await page.locator('#legend .keys canvas').first().waitFor();
            const setRatio = await pixelRatioOf(page);
            for (const ratio of [2, 1.5, 1]) {
                await setRatio(ratio);
                await becomes(() => page.evaluate(() => {
                    const { session: { picture, size }, viewport } = globalThis.plantcast;
                    return { ratio: size.pixel_ratio, sample: document.querySelector('#legend .keys canvas').width / 18,
                        off: Math.max(Math.abs(picture.fullWidth - viewport.width * devicePixelRatio),
                            Math.abs(picture.fullHeight - viewport.height * devicePixelRatio)) > 2 };
                }), { ratio, sample: ratio, off: false }, `${name}, ${ratio}`, 30);
            }
        }, keepMediaQueries, (page) => isSafari && page.addInitScript(observeAsSafari));
});

// With more quantities than fit, the row of their names can be dragged sideways; if a key or a server message selects one that
// is out of view, the row moves to show it.
test('with seven quantities, the name of each is complete', options, async () => {
    const names = ['Differential pressure', 'Volume flow', 'Level', 'Vibration velocity', 'Electrical power'];
    const [many, address] = await startAlarmed((file) => writeFileSync(file, readFileSync(file, 'utf8').replace(/^sources:/m,
        `${names.map((name, i) => `  - { id: more${i}, quantity: ${name}, unit: bar, min: 0, max: 1 }\n`).join('')}sources:`)));
    try {
        for (const [name, screen] of [['phone', PHONE], ...sweep([['desk', SCREENS.desk], ['tablet', TABLET]], [])]) {
            await withPage(`${address}?lang=en`, screen, async (page) => {
                await waitForPicture(page);
                await becomes(() => page.evaluate(() => [...document.querySelectorAll('#groups span')]
                    .filter((e) => e.scrollWidth > e.clientWidth + 1).map((e) => e.textContent)), [], name);
                await shoot(page, `seven-${name}`);
                await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'more4' }));
                await page.waitForFunction(() => {
                    const row = document.querySelector('#groups .row').getBoundingClientRect();
                    const { left, right } = document.querySelector('#groups :checked + span').getBoundingClientRect();
                    return left >= row.left - 1 && right <= row.right + 1 && row.right <= innerWidth;
                });
                assert.ok(await page.evaluate(() => document.getElementById('plant-name').clientWidth > 60 &&
                    document.querySelector('.actions').getBoundingClientRect().right <= innerWidth), name);
            });
        }
    } finally {
        await many.destroy();
    }
});

const PARTS = '.identity, .alarm-strip, .viewport, .alarms, .stage > .card, .panel.open, .lower, #groups, .actions';
// Returns parts that overlap or extend beyond a side of the window, and the page itself if it scrolls sideways.
const collisions = (page) => page.evaluate((selector) => {
    const wide = () => [...document.body.querySelectorAll('*')].filter((e) => e.getBoundingClientRect().right > innerWidth)
        .map((e) => `${e.tagName} ${e.id || e.className} in ${e.parentNode.id || e.parentNode.className}`);
    const found = [document.scrollingElement, document.body].filter((e) => e.scrollWidth > innerWidth)
        .map((e) => `${e.tagName} scrolls sideways: ${wide()}`);
    const parts = [...document.querySelectorAll(selector)].filter((e) => e.checkVisibility() && e.getBoundingClientRect().width > 0)
        .map((e) => [e.id || e.className, e.getBoundingClientRect()]);
    for (const [i, [name, a]] of parts.entries()) {
        if (a.left < -1 || a.right > innerWidth + 1)
            found.push(`${name} leaves the window`);
        for (const [other, b] of parts.slice(i + 1))
            if (a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1)
                found.push(`${name} overlaps ${other}`);
    }
    return found;
}, PARTS);
const inkOf = (page, name = '--ink') => page.evaluate((of) => getComputedStyle(document.documentElement).getPropertyValue(of), name);
// Window sizes of a desk of 1280 x 1024 or 1280 x 800 pixels at a browser zoom of 400 % or 200 %, in CSS pixels.
const ZOOMED = { '400 %': { width: 320, height: 256 }, '200 %': { width: 640, height: 400 } };
test('at 200 % and 400 % zoom no part of the page covers another, and the page scrolls in one direction', options, async () => {
    await withPage(`${url}?lang=de`, { viewport: ZOOMED['400 %'] }, async (page) => { // opens the page with the least room
        const press = async (key) => {
            await page.locator('#viewport').focus();
            await page.keyboard.press(key);
        };
        const call = (name) => page.evaluate((does) => {
            const { plantcast } = globalThis;
            return plantcast[does](plantcast.session.model.tag('TI-1'));
        }, name);
        // [what opens a part, the part, what closes it]
        const steps = [
            [() => press('p'), '#picture-panel.open', () => press('Escape')], [() => press('v'), '#views.open', () => press('Escape')],
            [() => press('e'), '#alarms', () => press('e')], [() => press('y'), '#timeline', () => press('y')],
            [() => call('showTrend'), '#trend-chart canvas', () => page.locator('#trend-close').click()],
            [() => call('selectTag'), '.stage > #card', () => press('Escape')],
        ];
        await waitForPicture(page);
        await page.waitForFunction(() => globalThis.plantcast.session.recorded);
        for (const [zoom, viewport] of Object.entries(ZOOMED)) {
            await resize(page, viewport);
            await becomes(() => collisions(page), [], zoom);
            assert.notEqual(await inkOf(page), await inkOf(page, '--ink-2'));
            // with the browser's preference for more contrast, all texts and lines get the colour of the main text
            await page.emulateMedia({ contrast: 'more' });
            await page.waitForFunction(() => getComputedStyle(document.documentElement).getPropertyValue('--line') ===
                getComputedStyle(document.documentElement).getPropertyValue('--ink'));
            assert.equal(await inkOf(page), await inkOf(page, '--ink-2'));
            await page.emulateMedia({ contrast: 'no-preference' });
            for (const [show, part, hide] of steps) {
                await show();
                await page.locator(part).waitFor();
                await becomes(() => collisions(page), [], `${zoom}, ${part}`);
                await shoot(page, `zoom-${viewport.width}-${part.replace(/\W/g, '')}`);
                await hide();
                await page.locator(part).waitFor({ state: 'hidden' });
            }
            await press('y');
            await call('showTrend');
            await page.locator('#trend-chart canvas').waitFor();
            // waits until the trend chart lies completely above the time bar, with at least 40 pixels for its curve
            await page.waitForFunction(() => {
                const box = (of) => document.querySelector(of).getBoundingClientRect(), chart = box('#trend-chart canvas');
                return box('#trend-chart .u-over').height >= 40 && box('#timeline').height > 0 && chart.bottom <= box('#timeline').top + 1;
            });
            await shoot(page, `zoom-${viewport.width}-trend-and-time`);
            await page.locator('#trend-close').click();
            await press('y');
            await page.locator('#timeline').waitFor({ state: 'hidden' });
        }
    });
});

// Sizes of phones, tablets, desks and zoomed desks in CSS pixels.
const SIZES = sweep([[1280, 800], [1024, 768], [768, 1024], [640, 400], [390, 844], [844, 390], [667, 375], [360, 640], [320, 256]],
    [[1280, 800], [768, 1024], [667, 375], [360, 640], [320, 256]]);
const setField = (page, fields) => page.evaluate((all) => {
    for (const [id, value] of Object.entries(all)) {
        document.getElementById(id).value = value;
        document.getElementById(id).dispatchEvent(new Event('input', { bubbles: true }));
    }
}, fields);
// Returns the text of a part that is entirely on the screen and not covered; otherwise ''.
const readable = (page, selector) => page.evaluate((one) => {
    const element = document.querySelector(one), { left, top, right, bottom, width } = element.getBoundingClientRect();
    const inside = width > 0 && left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight;
    const isTop = (x) => element.contains(document.elementFromPoint(x, (top + bottom) / 2));
    return inside && isTop(left + 3) && isTop(right - 3) ? element.value || element.textContent : '';
}, selector);

test('on every screen a button tells what the alarm filter hides, and clears the filter', options, async () => {
    for (const kind of [{ viewport: SCREENS.desk.viewport }, sweep(PHONE, null)].filter(Boolean)) {
        const { page, errors, close } = await openPage(`${url}?lang=de`, kind), button = page.locator('#alarms-applied');
        const press = async (key) => {
            await page.locator('#viewport').focus();
            await page.keyboard.press(key);
        };
        try {
            await waitForPicture(page);
            await page.waitForFunction(() => globalThis.plantcast.session.recorded);
            for (const [i, [width, height]] of SIZES.entries()) {
                await resize(page, { width, height });
                await press('e');
                await page.locator('#alarms').waitFor();
                const withTime = [false, true].filter((time, n) => takes(i, n, 2) || (time && height === 375));
                for (const time of withTime) {
                    const name = `${width}x${height}${time ? ' with the time bar' : ''}`;
                    if (time) {
                        await press('y');
                        await page.locator('#time-slider').waitFor();
                    }
                    await page.locator('#alarms-tab').click();
                    await button.waitFor({ state: 'hidden' });
                    await setField(page, { 'alarms-words': 'TI', 'alarms-which': 'gone', 'alarms-priority': '1' });
                    await button.getByText('0/1 · “TI” · Gegangen · Priorität 1').waitFor();
                    // at 400 % zoom (256 pixels high) the button may be out of view, because the page scrolls, so its text is
                    // checked only elsewhere
                    if (height > 300)
                        await becomes(async () => await readable(page, '#alarms-applied') !== '', true, name);
                    await shoot(page, `filtered-${width}${time ? '-time' : ''}`);
                    await button.click();
                    await page.locator('#alarms-list tr').waitFor();
                    await page.locator('#journal-tab').click();
                    await page.locator('#journal-list tr').first().waitFor();
                    await setField(page, { 'journal-which': 'shelved' });
                    await button.getByText(/^0\/\d+ · .* · Zurückgestellt/).waitFor();
                    if (height > 300)
                        await becomes(async () => await readable(page, '#alarms-applied') !== '', true, `${name}, journal`);
                    await button.click();
                    await page.locator('#journal-list tr').first().waitFor();
                    if (height > 300)
                        await becomes(async () => /^(day|Letzte 24 Stunden)$/.test(
                            await readable(page, '#journal-span') + await readable(page, '#alarms-applied')), true,
                        `${name}: the time range`);
                }
                if (withTime.at(-1))
                    await press('y');
                await press('e');
                await page.locator('#alarms').waitFor({ state: 'hidden' });
                assert.deepEqual(errors, [], i);
            }
        } finally {
            await close();
        }
    }
});
