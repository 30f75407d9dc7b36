// SPDX-License-Identifier: GPL-3.0-or-later
// Accessibility: axe-core finds nothing on any panel, and the keyboard reaches every control with a visible focus. All texts come from
// the word files.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { test } from 'node:test';
import { alarmed } from './alarmed.mjs';
import { drawnAt, openPage, PHONE, shoot, TABLET, travel, waitForPicture, withPage } from '../support/browser.mjs';
import { cutOff, everyPanel, markWords, unsaid } from '../support/panels.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep, takes } from '../support/sweep.mjs';
import { notBuilt } from '../support/tiny_plant.mjs';
import { becomes } from '../support/until.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
const SCREEN = { viewport: sweep({ width: 1680, height: 1000 }, { width: 1280, height: 800 }) };
const UPRIGHT = { ...TABLET, viewport: { width: 768, height: 1024 } };
const RULES = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];
// By default all rules run in one theme, and only the colour rules run in the other, because the themes differ only in colours.
const COLOURS = { type: 'rule', values: ['color-contrast', 'link-in-text-block'] };
const WALKS = sweep([['dark', RULES], ['light', RULES]], [['dark', RULES, 'light']]);
const THEMES = { dark: RULES, light: sweep(RULES, COLOURS) };
// A step of the walk through the page, and the part of the page that it opens. After the step, axe-core checks only this part,
// unless a call says otherwise.
const PARTS = {
    card: '#card', place: '#place', picture: '#picture-panel', split: '#split-bar', views: '#views', display: '#display',
    trend: '.lower', alarms: '#alarms', shelve: '#shelve',
    timings: '#timings', help: '#help', cut: '#viewport', measure: '#viewport', share: '#share',
    'engineer-place': '#engineer', 'engineer-gaps': '#engineer', 'engineer-prove': '#engineer', token: '#token',
};
let url, browser, page;

setUp(options.skip, async (own) => {
    [, url] = await alarmed();
    browser = own(await openPage(url, SCREEN, null, markWords));
    page = browser.page;
    await waitForPicture(page);
});

// Returns axe-core's findings. within: checks only matching elements; null: the whole page.
async function findings(on, rules = RULES, within = null) {
    if (!await on.evaluate(() => globalThis.axe !== undefined))
        await on.evaluate(readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8'));
    const { violations } = await on.evaluate(([runOnly, part]) =>
        globalThis.axe.run(part ? { include: [[part]] } : document, { runOnly, resultTypes: ['violations'], preload: !part }),
    // preload: axe-core needs to preload style sheets only for rules about the whole page, so checks of a part skip this
    [rules, within]);
    return violations.flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(' ')} ${node.any[0]?.message ?? ''}`));
}

for (const [theme, rules, other] of WALKS) {
    const themes = `${theme}${other ? `, nor in colours, ${other}` : ''}`;
    test(`axe-core finds no fault, and all texts are complete and from the word files, on any panel or dialog, ${themes}`, options,
        async () => {
            await page.goto(`${url}?theme=${theme}&lang=de`); // German has the longest words
            await waitForPicture(page);
            await lookAtEverything(theme, rules, other);
        });
}

// Roles that a screen reader announces with a name.
const NAMED = new Set(['button', 'link', 'checkbox', 'radio', 'switch', 'slider', 'spinbutton', 'textbox', 'searchbox', 'combobox',
    'listbox', 'option', 'tab', 'tablist', 'tabpanel', 'tree', 'treeitem', 'menuitem', 'dialog', 'alertdialog', 'region', 'navigation',
    'complementary', 'main', 'image', 'columnheader', 'Date', 'DateTime', 'InputTime', 'progressbar', 'meter']);

// Returns what a screen reader could not announce, according to the browser's accessibility tree: controls, dialogs and regions
// without a name, tables without column or row titles, and open dialogs without the focus.
async function unspoken(on) {
    const client = await on.context().newCDPSession(on);
    const { nodes } = await client.send('Accessibility.getFullAXTree');
    const byId = new Map(nodes.map((node) => [node.nodeId, node])), role = (node) => node?.role?.value;
    const below = (node) => (node.childIds ?? []).map((id) => byId.get(id)).filter(Boolean).flatMap((child) => [child, ...below(child)]);
    const said = nodes.filter(({ ignored }) => !ignored);
    const nameless = said.filter((node) => NAMED.has(role(node)) && !node.name?.value?.trim());
    const untitled = said.filter((node) => ['table', 'grid'].includes(role(node)) &&
        !below(node).some((one) => ['columnheader', 'rowheader'].includes(role(one))));
    const where = async ({ backendDOMNodeId: backendNodeId, ...node }) => {
        const { node: { nodeName, attributes = [] } } = await client.send('DOM.describeNode', { backendNodeId });
        return `${role(node)}: ${nodeName} ${attributes.join(' ')}`;
    };
    const found = await Promise.all([...nameless, ...untitled].map(where));
    await client.detach();
    const unfocused = await on.evaluate(() => [...document.querySelectorAll('dialog[open]')]
        .filter((dialog) => !dialog.contains(document.activeElement)).map(({ id }) => `dialog ${id} has not the focus`));
    return [...found, ...unfocused];
}

const wear = (theme) => page.evaluate((name) => { document.documentElement.dataset.theme = name; }, theme);

async function lookAtEverything(theme, rules, other) {
    const seen = [];
    const look = async (name) => {
        await becomes(() => unsaid(page), [], name);
        if (name === 'closed')
            return;
        seen.push(name);
        await shoot(page, `axe-${theme}-${name}`);
        await becomes(() => cutOff(page), [], name);
        await becomes(() => unspoken(page), [], name);
        const part = sweep(null, PARTS[name] ?? null);
        assert.deepEqual(await findings(page, rules, part), [], name);
        if (!other)
            return;
        await wear(other);
        assert.deepEqual(await findings(page, COLOURS, part), [], `${name}, ${other}`);
        await wear(theme);
    };
    await everyPanel(page, look);
    await travel(page, await page.evaluate(() => globalThis.plantcast.session.clockUs() - 5e6));
    await page.waitForFunction(() => globalThis.plantcast.session.picture.past && document.body.classList.contains('shows-past'));
    await look('past');
    await travel(page, null);
    await page.waitForFunction(() => !globalThis.plantcast.session.picture.past);
    await lookAtTools(look);
    for (const name of ['page', 'card', 'place', 'picture', 'split', 'views', 'trend', 'alarms', 'shelve', 'timings', 'help'])
        assert.ok(seen.includes(name), name);
}

async function lookAtTools(look) {
    const setClip = (clip) => page.evaluate((value) => globalThis.plantcast.session.setParams({ clip: value }), clip);
    await setClip({ box: { min: [-1, -1, -1], max: [1, 1, 1] } });
    await page.locator('.grip:visible').first().waitFor();
    await look('cut');
    await setClip(null);
    await page.waitForFunction(() => document.querySelectorAll('.grip').length === 0);
    await page.locator('#viewport').focus();
    await page.keyboard.press('r');
    await page.locator('.measuring').waitFor();
    for (const place of [[0, -0.5, 0.2], [0, -0.5, -0.2]]) {
        const count = await page.evaluate(() => document.querySelectorAll('.measure .end').length);
        const { x, y } = await drawnAt(page, place);
        await page.mouse.click(x, y);
        await page.waitForFunction((n) => document.querySelectorAll('.measure .end').length > n, count);
    }
    await look('measure');
    await page.keyboard.press('Escape');
    await page.keyboard.press('k');
    await page.locator('#share-code svg').waitFor();
    await look('share');
    await page.keyboard.press('Escape');
    await page.locator('#engineer-toggle').click();
    await page.locator('#engineer .tags button').first().click();
    await look('engineer-place');
    await page.getByRole('button', { name: /Messlücken/ }).click();
    await page.locator('#engineer .gaps h3').waitFor();
    await look('engineer-gaps');
    await page.locator('#engineer label', { hasText: 'Loop-Check' }).click();
    await page.locator('#engineer .part:not([hidden]) .tags button').first().click();
    await page.locator('#engineer .judge').waitFor();
    await look('engineer-prove');
    await page.locator('#engineer-toggle').click();
    await page.evaluate(() => globalThis.plantcast.session.emit('denied', { code: 'token_needed' }));
    await page.locator('#token[open]').waitFor();
    await look('token');
    await page.keyboard.press('Escape');
    // shows the page again by removing the class `denied`, as the page does when the server's message `welcome` arrives
    await page.evaluate(() => document.body.classList.remove('denied'));
}

const WALL = { viewport: sweep({ width: 3840, height: 2160 }, { width: 1920, height: 1080 }) };
const OTHERS = [['wall', '&wall', WALL], ['tablet', '', UPRIGHT], ['phone', '', PHONE]];
for (const [row, theme] of Object.keys(THEMES).entries()) {
    const tried = OTHERS.filter((_, i) => takes(row, i, 2));
    test(`axe-core finds no fault on other screens, ${theme}: ${tried.map(([name]) => name).join(', ')}`, options, async () => {
        for (const [name, query, screen] of tried) {
            const other = await openPage(`${url}?theme=${theme}${query}`, screen);
            await waitForPicture(other.page);
            await other.page.waitForFunction(() => document.querySelector('#alarm-counts .priority'));
            await shoot(other.page, `axe-${theme}-${name}`);
            assert.deepEqual(await findings(other.page), [], name);
            assert.deepEqual(other.errors, []);
            await other.close();
        }
    });
}

// [key to press, selector of the part of the page that it opens, selector of a button to press within that part]
const OPENED = [['e', '#alarms'], ['e', '#alarms', '#journal-tab'], ['v', '#views'], ['p', '#picture-panel'], ['y', '#timeline'],
    ['b', '#assets'], ['k', '#share'], ['?', '#help']];
test('on a phone a screen reader announces every control, table and dialog by name; alarms are in a live region', options, async () => {
    await withPage(`${url}?lang=ko`, PHONE, async (on) => {
        await waitForPicture(on);
        await on.waitForFunction(() => globalThis.plantcast.session.recorded && document.querySelector('#alarm-counts .priority'));
        await becomes(() => unspoken(on), [], 'as it opens');
        for (const [key, part, button] of OPENED) {
            await on.locator('#viewport').focus();
            await on.keyboard.press(key);
            await on.locator(part).waitFor();
            if (button)
                await on.locator(button).click();
            await becomes(() => unspoken(on), [], `${part} ${button ?? ''}`);
            await on.keyboard.press('Escape');
            if (await on.locator(part).isVisible())
                await on.keyboard.press(key);
            await on.locator(part).waitFor({ state: 'hidden' });
        }
        const client = await on.context().newCDPSession(on), { root } = await client.send('DOM.getDocument');
        const { nodeId } = await client.send('DOM.querySelector', { nodeId: root.nodeId, selector: '#alarm-said' });
        const { nodes: [region] } = await client.send('Accessibility.getPartialAXTree', { nodeId, fetchRelatives: false });
        assert.deepEqual([region.ignored, region.role.value, region.properties.find(({ name }) => name === 'live').value.value],
            [false, 'status', 'polite']);
    });
});

// Returns the focused element: its name, whether the focus is visible, and its position.
const focused = () => page.evaluate(() => {
    const element = document.activeElement;
    (globalThis.reached ??= new Set()).add(element);
    const shown = element.matches('.segments input') ? element.nextElementSibling : element;
    const { outlineStyle, outlineWidth } = getComputedStyle(shown), box = shown.getBoundingClientRect();
    const inside = box.right <= innerWidth + 1 && box.bottom <= innerHeight + 1 && box.width > 0;
    const seen = outlineStyle !== 'none' && parseFloat(outlineWidth) >= 2, inToolbar = Boolean(element.closest('.toolbar'));
    return { name: element.id, seen, inToolbar, left: box.left, inside, body: element === document.body };
});

test('Tab reaches every control in visual order, and the focus is visible', options, async () => {
    await page.evaluate(() => document.getElementById('assets-toggle').focus());
    const first = await focused(), reached = [];
    for (let n = 0; n < 80; n++) {
        await page.keyboard.press('Tab');
        const now = await focused();
        if (now.body || now.name === first.name)
            break;
        reached.push(now);
    }
    assert.deepEqual(reached.filter(({ seen, inside }) => !seen || !inside), []);
    const bar = reached.filter(({ inToolbar }) => inToolbar);
    assert.deepEqual(bar.map(({ left }) => left), bar.map(({ left }) => left).sort((a, b) => a - b),
        'Tab goes from left to right in the bar');
    const missed = await page.evaluate(() => [...document.querySelectorAll('button, select, input:not([type="radio"]), [tabindex="0"]')]
        .filter((e) => e.checkVisibility({ visibilityProperty: true }) && !e.disabled)
        .filter((e) => !globalThis.reached.has(e)).map((e) => e.id || e.textContent));
    assert.deepEqual(missed, []);
    assert.ok(reached.length > 15, `Tab reached only ${reached.length} controls`);
});

test('a dialog keeps the focus inside, closes on Escape, and returns the focus', options, async () => {
    await page.locator('#help-open').focus();
    await page.keyboard.press('Enter');
    await page.locator('#help[open]').waitFor();
    await shoot(page, 'focus-help');
    for (let n = 0; n < 4; n++) {
        const where = await page.evaluate(() => document.activeElement.closest('dialog, body').id || document.activeElement.tagName);
        // After the dialog's last element, Tab moves the focus to the browser's own interface (activeElement is then BODY), and
        // then back to the dialog's first element; it never reaches the page behind.
        assert.ok(['help', 'BODY'].includes(where), where);
        await page.keyboard.press('Tab');
    }
    await page.keyboard.press('Escape');
    await becomes(async () => (await focused()).name, 'help-open');
});

test('panels open and close by keys, and the focus follows', options, async () => {
    await page.locator('#viewport').focus();
    await page.keyboard.press('/');
    await page.keyboard.type('TI');
    await page.keyboard.press('Escape'); // the first Escape clears the search field and leaves the focus there
    await becomes(() => page.evaluate(() => [document.activeElement.id, document.activeElement.value]), ['assets-search', '']);
    await page.keyboard.press('Escape'); // the second Escape moves the focus to the picture
    await becomes(() => page.evaluate(() => document.activeElement.id), 'viewport');
    await page.locator('#alarm-strip').focus();
    await page.keyboard.press('Enter');
    await becomes(async () => (await focused()).name, 'alarms-close');
    await page.keyboard.press('Escape');
    await page.locator('#alarms').waitFor({ state: 'hidden' });
    await becomes(async () => (await focused()).name, 'alarm-strip');
    for (const name of ['picture', 'views']) {
        await page.locator(`#${name}-toggle`).focus();
        await page.keyboard.press('Enter');
        await page.keyboard.press('Tab');
        const within = await page.evaluate(() => document.activeElement.closest('.panel, .toolbar')?.id ?? document.activeElement.id);
        assert.ok(within !== 'viewport', `the focus is in ${within} after opening ${name}`);
        await page.keyboard.press('Escape');
        await page.locator(name === 'views' ? '#views' : '#picture-panel').waitFor({ state: 'hidden' });
        await becomes(async () => (await focused()).name, `${name}-toggle`, 'back where it came from');
    }
    assert.deepEqual(browser.errors, []);
});
