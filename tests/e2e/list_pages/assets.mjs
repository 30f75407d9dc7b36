// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the list of equipment: it shows areas, assets and tags, can be searched and used by keyboard alone, and has the same
// selection as the 3D picture. With 20,000 tags it must scroll smoothly.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { drawnAt, openPage, settle, shoot, view, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { notBuilt, TinyPlant } from '../support/tiny_plant.mjs';
import { becomes } from '../support/until.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
const ASSETS = 200, TAGS_EACH = 100;
let plant, browser, page;

const LINKS = `links:
  - { name: Work orders, url: 'https://maintenance.example/equipment/{tag}?area={area}' }
  - { name: Faceplate, of: tag, url: 'https://dcs.example/faceplate?tag={name}' }
`;

// Writes a plant of ASSETS boxes in rows of twenty. Each box has several sensors, of which only the first has a position.
function makeLarge(folder) {
    const assets = [], tags = ['Tag Name,Address,Data Type,Eng Units,Description,Group,Asset,X,Y,Z,H'];
    for (let a = 0; a < ASSETS; a++) {
        const [x, y] = [(a % 20) * 3, Math.floor(a / 20) * 3];
        const properties = `{ Maker: Example Works, Built: ${1990 + a % 30} }`;
        assets.push(`  - { id: E-${a}, tag: "E ${a}", area: Unit ${a % 7}, model: box.gltf, description: box ${a}, ` +
            `properties: ${properties}, placement: ` +
            `{ translate: [${x}, ${y}, 0] } }`);
        for (let t = 0; t < TAGS_EACH; t++) {
            const n = a * TAGS_EACH + t, placed = t === 0 ? ['temperature', `E-${a}`, x + 0.5, y, 0, 90] : ['', `E-${a}`, '', '', '', ''];
            tags.push(`TI-${a}-${t},${400001 + 2 * n},Float,°C,point ${t},${placed.join(',')}`);
        }
    }
    // in long runs, the memory test needs changing values; by default, reading them would only take processor time
    const pollMs = sweep(2000, 60000);
    const file = join(folder, 'plant.yaml'), text = readFileSync(file, 'utf8').replace('poll_ms: 100', `poll_ms: ${pollMs}`);
    writeFileSync(file, text.replace(/assets:\n(?: {2}- .*\n)+/, `assets:\n${assets.join('\n')}\n`) + LINKS);
    writeFileSync(join(folder, 'tags.csv'), `${tags.join('\n')}\n`);
}

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    makeLarge(plant.folder);
    plant.giveDeviceTime();
    const { code, err, out } = plant.prepare();
    assert.equal(code, 0, err + out);
    await plant.startSim();
    await plant.startDaemon();
    browser = own(await openPage(`http://127.0.0.1:${plant.port}/`, { viewport: { width: 1280, height: 720 } }));
    page = browser.page;
    await waitForPicture(page);
});

test('the list shows areas, assets and tags, and a search finds each of 20,000', options, async () => {
    const { model } = await page.evaluate(() => ({ model: globalThis.plantcast.session.model.tags.length }));
    assert.equal(model, ASSETS * TAGS_EACH);
    const list = page.locator('#assets-list');
    assert.equal(await list.locator('.area').first().textContent(), 'Unit 029');
    assert.ok(await list.locator('[role="treeitem"]').count() < 60, 'the page contains only visible rows');
    await page.locator('#assets-search').fill('TI-137-42');
    await list.locator('.reading', { hasText: 'TI-137-42' }).waitFor();
    assert.deepEqual(await list.locator('b').allTextContents(), ['Unit 4', 'E 137']);
    await shoot(page, 'assets-search');
    await page.locator('#assets-search').fill('no such thing');
    await page.locator('#assets-nothing').waitFor();
    await page.locator('#assets-search').fill('');
});

test('a click selects an asset and flies to it; its details and links are shown', options, async () => {
    const { camera } = await view(page);
    await page.locator('#assets-search').fill('E 137');
    await page.locator('#assets-list .asset', { hasText: 'E 137' }).click();
    await page.waitForFunction((eye) => Math.hypot(...globalThis.plantcast.session.camera.eye.map((x, i) => x - eye[i])) > 1, camera.eye);
    assert.equal((await view(page)).params.selected, 'E-137');
    // the script that shows the asset's data is loaded on first use
    await page.waitForFunction(() => document.querySelector('#asset-about')?.textContent);
    assert.match(await page.locator('#asset-about').textContent(),
        /E 137.*box 137.*Unit 4.*1\.0 × 1\.0 × 1\.0 m.*100.*MakerExample WorksBuilt2007/);
    const link = page.locator('#asset-about a');
    assert.equal(await link.getAttribute('href'), 'https://maintenance.example/equipment/E%20137?area=Unit%204');
    assert.equal(await link.getAttribute('rel'), 'noopener noreferrer');
    await page.locator('#assets-search').fill('');
    await page.waitForFunction(() => /E 137/.test(document.querySelector('#assets-list [aria-selected="true"]')?.textContent));
    await settle(page);
    await shoot(page, 'assets-selected');
});

test('an asset picked in 3D is selected in the list, and so is a marker\'s tag', options, async () => {
    const places = await page.evaluate(() => {
        const { model } = globalThis.plantcast.session, { min, max } = model.asset('E-137').bounds;
        return [[(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, max[2]], model.tag('TI-137-0').position];
    });
    const [box, marker] = await Promise.all(places.map((place) => drawnAt(page, place)));
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: null }));
    await page.mouse.click(box.x, box.y);
    await page.waitForFunction(() => globalThis.plantcast.session.params.selected === 'E-137');
    await page.locator('#place').waitFor();
    await page.keyboard.press('Escape'); // closes the asset's card, which may cover the sensor's marker that is clicked next
    await page.mouse.click(marker.x, marker.y);
    await page.waitForFunction(() => /TI-137-0/.test(document.querySelector('.reading[aria-selected="true"]')?.textContent));
    await becomes(() => page.locator('#card .links a').getAttribute('href'), 'https://dcs.example/faceplate?tag=TI-137-0');
    await page.keyboard.press('Escape');
});

test('the list can be used by the keyboard alone', options, async () => {
    await page.locator('#assets-search').focus();
    await page.keyboard.press('Tab');
    await page.keyboard.press('Home');
    const focused = (pattern) => page.waitForFunction((text) => new RegExp(text).test(document.activeElement.textContent), pattern);
    await focused('^Unit 029$');
    await page.keyboard.press('ArrowLeft');
    await becomes(() => page.evaluate(() => document.activeElement.getAttribute('aria-expanded')), 'false');
    await page.keyboard.press('ArrowDown');
    await focused('^Unit 1');
    await page.keyboard.press('ArrowDown');
    await focused('^E 1box 1');
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('ArrowRight');
    await focused('^TI-1-0');
    await page.keyboard.press('ArrowLeft');
    const { camera } = await view(page);
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => globalThis.plantcast.session.params.selected === 'E-1');
    await page.locator('#assets-list [aria-selected="true"]', { hasText: /E 1/ }).first().waitFor();
    await page.waitForFunction((eye) =>
        Math.hypot(...globalThis.plantcast.session.picture.camera.eye.map((x, i) => x - eye[i])) > 10, camera.eye);
    await page.keyboard.press('End');
    assert.ok(await page.evaluate(() => document.activeElement.getBoundingClientRect().bottom <= innerHeight), 'the last row is visible');
    assert.deepEqual(browser.errors, []);
});

// Scrolls through the list with all assets unfolded, and measures the time that the page's own code takes per frame. The time
// that the browser needs for layout and painting is not limited by this test.
test('20,000 tags scroll smoothly', options, async (t) => {
    const { frames, work, rows } = await page.evaluate(async (steps) => {
        const { assets, session } = globalThis.plantcast;
        for (const asset of session.model.assets)
            assets.tree.unfold(asset);
        assets.filter();
        const list = assets.list, root = list.root, all = root.scrollHeight - root.clientHeight, took = [];
        const show = list.show.bind(list);
        list.show = () => { const began = performance.now(); show(); took.push(performance.now() - began); };
        const stamps = [];
        for (let n = 0; n < steps; n++) {
            root.scrollTop = (all * n) / steps;
            stamps.push(await new Promise((done) => requestAnimationFrame(done)));
        }
        list.show = show;
        const between = stamps.slice(1).map((at, i) => at - stamps[i]);
        const inPage = root.querySelectorAll('[role="treeitem"]').length;
        return { frames: between.sort((a, b) => a - b), work: took.sort((a, b) => a - b), rows: inPage };
    }, sweep(200, 80));
    const middle = (list, part = 0.5) => list[Math.floor(list.length * part)];
    t.diagnostic(`pictures every ${middle(frames).toFixed(1)} ms (95 %: ${middle(frames, 0.95).toFixed(1)}), of which the list takes ` +
        `${middle(work).toFixed(2)} ms (95 %: ${middle(work, 0.95).toFixed(2)}); ${rows} rows in the page`);
    // compares the 20 % quantile, because slower frames include time for which the page waited for the processor
    assert.ok(middle(work, 0.2) < 16, `scrolling takes more than one frame: ${middle(work, 0.2)} ms`);
    assert.ok(rows < 80, `the page contains ${rows} rows`);
    await shoot(page, 'assets-20000');
});

// USE_S: seconds for which the page is used between two measurements, in `make test-long` set to half an hour. Garbage is
// collected before each measurement.
const USE_S = Number(process.env.USE_S ?? 10), EACH = 4; // EACH: at every EACH-th step a panel is opened or closed
// Allowed growth of memory (share and megabytes) and of document nodes.
const MOST = { share: 0.1, megabytes: 2, nodes: 500 };
const isSteady = (before, after) => after.megabytes < before.megabytes * (1 + MOST.share) + MOST.megabytes &&
    after.nodes < before.nodes * (1 + 2 * MOST.share) + MOST.nodes;
// Only long runs do this; in each run, leaks.mjs counts the nodes and listeners that each panel leaves.
sweep(test, () => {})('memory does not grow while the list is used', { ...options, timeout: options.timeout + 2000 * USE_S }, async (t) => {
    const client = await page.context().newCDPSession(page);
    const heap = async () => {
        await client.send('HeapProfiler.collectGarbage');
        const { usedSize } = await client.send('Runtime.getHeapUsage');
        const { nodes } = await client.send('Memory.getDOMCounters');
        return { megabytes: usedSize / 1e6, nodes };
    };
    const use = (ms) => page.evaluate(async ([long, each]) => {
        const { assets, session, modules, selectTag, showTrend } = globalThis.plantcast, { root } = assets.list;
        const search = document.getElementById('assets-search');
        const press = (key) => document.getElementById('viewport').dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
        // Presses each key in turn, which opens a panel and later closes it again; also selects random tags and shows their
        // trends and cards.
        const panels = ['e', 'v', 'p', 'm', 'b', 'b', 'm', 'p', 'v', 'e'];
        for (let n = 0, end = performance.now() + long; performance.now() < end || n < each * panels.length; n++) {
            if (n % each === 0) {
                const tag = session.model.tags[100 * Math.floor(Math.random() * 200)];
                press(panels[(n / each) % panels.length]);
                selectTag(tag);
                showTrend(tag);
            }
            root.scrollTop = Math.random() * root.scrollHeight;
            search.value = `TI-${Math.floor(Math.random() * 200)}`;
            search.dispatchEvent(new Event('input'));
            session.setParams({ selected: `E-${Math.floor(Math.random() * 200)}` });
            (await modules.get('cameraController')).flyHome();
            await new Promise((done) => setTimeout(done, 50));
        }
        search.value = '';
        search.dispatchEvent(new Event('input'));
        await new Promise((done) => setTimeout(done, 500));
    }, [ms, EACH]);
    await use(3000); // The first use creates the objects that the page creates only once; they are not counted as growth.
    let before = await heap(), after;
    // Repeats the measurement up to four times until memory is steady. A busy machine may create some objects only late, but a
    // real leak grows each time.
    for (let times = 0; times < 4 && !(after && isSteady(before, after)); times++) {
        before = after ?? before;
        await use(USE_S * 1000);
        after = await heap();
    }
    t.diagnostic(`${USE_S} s: ${before.megabytes.toFixed(1)} -> ${after.megabytes.toFixed(1)} MB, ${before.nodes} -> ${after.nodes} nodes`);
    assert.ok(isSteady(before, after), `the page grew: ${JSON.stringify(before)} -> ${JSON.stringify(after)}`);
    assert.deepEqual(browser.errors, []);
});
