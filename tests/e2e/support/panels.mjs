// SPDX-License-Identifier: GPL-3.0-or-later
// Starts a plant with active alarms, opens every panel, card and dialog of the page in turn, and finds faults of their texts.
import { appendFileSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { drawnAt, land } from './browser.mjs';
import { TinyPlant } from './tiny_plant.mjs';

// Returns [plant, url] of a running plant with active alarms. Its values are fixed, because each change would draw a new picture
// on every open page. arrange(file): makes further changes to the plant file before the start.
export async function startAlarmed(arrange = () => {}) {
    const plant = await TinyPlant.create();
    plant.keepFresh();
    appendFileSync(plant.file, 'alarms: local\n');
    arrange(plant.file);
    const tags = join(plant.folder, 'tags.csv');
    writeFileSync(tags, readFileSync(tags, 'utf8').split('\n').map((line, i) => line && line + (i === 0 ? ',H,HH' : ',60,90')).join('\n'));
    await plant.start();
    await plant.set({ 'TI-1': 95.5, 'TI-2': 20, 'PI-1': 5 });
    return [plant, `http://127.0.0.1:${plant.port}/`];
}

const PARTS = { picture: '#picture-panel.open', views: '#views.open', split: '#split-bar', trend: '#timeline', alarms: '#alarms',
    timings: '#timings' };

// Opens every panel, card and dialog of the page, one after another, and calls f(name) while it is open.
export async function everyPanel(page, f) {
    const press = async (key, name) => {
        // Presses the key again if the part does not appear within 10 s. The page loads a part when it is first opened, and
        // drops the key if loading takes seconds.
        const isOpen = () => !PARTS[name] || page.locator(PARTS[name]).waitFor({ timeout: 10000 }).then(() => true, () => false);
        do {
            await page.locator('#viewport').focus();
            await page.keyboard.press(key);
        } while (!await isOpen());
        await f(name);
    };
    await page.waitForFunction(() => globalThis.plantcast.session.recorded && globalThis.plantcast.session.model.alarms.list().length > 0);
    await land(page); // waits until the camera stands still, so that the objects to be clicked do not move
    await f('page');
    const places = await page.evaluate(() => {
        const { model } = globalThis.plantcast.session;
        return [model.tag('TI-1').position, model.asset('P-101A').bounds.max];
    });
    await page.waitForFunction(() => globalThis.plantcast.overlay.markers.some(({ tag }) => tag.name === 'TI-1'));
    const at = await Promise.all(places.map((place) => drawnAt(page, place)));
    await page.mouse.click(at[0].x, at[0].y);
    await page.locator('#card').waitFor();
    await f('card');
    await page.mouse.click(at[1].x - 6, at[1].y + 30);
    // clicks a second time if the asset's card (#place) does not appear: a card or label may have covered the point
    await page.locator('#place').waitFor({ timeout: 10000 }).catch(async () => {
        await page.keyboard.press('Escape');
        await page.mouse.click(at[1].x - 6, at[1].y + 30);
    });
    await page.locator('#place').waitFor();
    await f('place');
    await press('Escape', 'closed');
    await press('p', 'picture');
    await press('Escape', 'closed');
    await press('j', 'split');
    await press('j', 'closed');
    await press('v', 'views');
    await press('Escape', 'closed');
    if (await page.locator('#display-toggle').isVisible()) {
        await page.locator('#display-toggle').click();
        await page.locator('#display.open').waitFor();
        await f('display');
        await press('Escape', 'closed');
    }
    await page.evaluate(() => {
        const { session, showTrend } = globalThis.plantcast;
        session.setParams({ selected: session.model.assets[0].id });
        showTrend(session.model.tag('TI-1'));
    });
    await page.locator('#trend-chart canvas').waitFor();
    await press('y', 'trend');
    await page.locator('#trend-close').click();
    await press('y', 'closed');
    await press('e', 'alarms');
    await page.locator('[data-action="shelve"]').first().click();
    await f('shelve');
    await page.locator('#shelve-cancel').click();
    await page.locator('#alarms-close').click();
    await press('m', 'timings');
    await press('m', 'closed');
    await page.locator('#viewport').focus();
    await page.keyboard.press('?');
    await page.locator('#help[open]').waitFor();
    await f('help');
    await page.keyboard.press('Escape');
}

// Returns texts that do not fit into their element, and parts of the page that extend beyond the screen.
export const cutOff = (page) => page.evaluate(() => {
    const seen = (element) => element.checkVisibility() && element.getBoundingClientRect().width > 0;
    const tight = [...document.querySelectorAll('button, label > span, legend, h2, th, td, dt, dd, .state, .choice > span, output')]
        .filter((e) => seen(e) && e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).display !== 'inline' &&
            getComputedStyle(e).textOverflow !== 'ellipsis' && !e.closest('.alarm-strip'));
    const parts = 'header, header button, .panel.open, footer, aside, .legend, .card, dialog[open], .alarms, .trends';
    const out = [...document.querySelectorAll(parts)]
        .filter((e) => seen(e) && (e.getBoundingClientRect().right > innerWidth + 0.5 || e.getBoundingClientRect().left < -0.5));
    const wide = document.documentElement.scrollWidth > innerWidth ? [document.body] : [];
    return [...tight, ...out, ...wide].map((e) => `${e.tagName}#${e.id}.${e.className} ${e.textContent.trim().slice(0, 40)} ` +
        `${e.scrollWidth}>${e.clientWidth}`);
});

// Encloses the words of the page's German word files by two marks without a glyph or a width, but neither values nor names of keys
// between words.
const [BEGIN, END] = ['\u2063', '\u2064'];
export const markWords = (page) => page.route(/\/words\/(lazy\.|alarms\.)?de\.js/, async (route) => {
    const text = await (await route.fetch()).text();
    const marked = text.replace(/^([\w. ]+(?:\(\w+\))?: )(.*(?:\n +.*)*)$/gm,
        (_, key, said) => key + said.replace(/(^|[}\]])([^{}[\]]+)/g, `$1${BEGIN}$2${END}`));
    await route.fulfill({ body: marked, contentType: 'text/javascript' });
});

// Returns the visible texts outside the marks of markWords(). They must come from the plant.
export const unsaid = (page) => page.evaluate(([begin, end]) => {
    const { session: { model } } = globalThis.plantcast;
    const own = [model.plant, ...model.groups, ...model.assets, ...model.tags, ...model.colormaps].flatMap((one) =>
        [one.name, one.id, one.tag, one.description, one.quantity, one.unit, one.source]).filter(Boolean);
    const ours = ['Plantcast', '°C', 'JPEG', 'UTC'];
    const allowed = new Set([...own, ...own.map((text) => text[0].toUpperCase() + text.slice(1)), ...ours]);
    const shown = (element) => element?.checkVisibility?.() && !element.closest('code, kbd, a, svg, .limit-flag, .limits, #config, #clock');
    const found = [], say = (text, where) => {
        const rest = [...allowed].sort((a, b) => b.length - a.length).reduce((left, word) => left.replaceAll(word, ' '), text);
        if (/\p{L}{3,}/u.test(rest.replace(new RegExp(`${begin}[^${begin}${end}]*${end}`, 'g'), ' ')))
            found.push(`${where}: ${text}`);
    };
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        if (shown(node.parentElement))
            say(node.data, node.parentElement.id || node.parentElement.className || node.parentElement.tagName);
    }
    for (const element of document.querySelectorAll('[title], [aria-label], [placeholder], [aria-description]')) {
        for (const name of ['title', 'aria-label', 'placeholder', 'aria-description'])
            say(element.getAttribute(name) ?? '', `${name} of ${element.id || element.className}`);
    }
    return found;
}, [BEGIN, END]);
