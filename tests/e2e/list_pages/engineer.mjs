// SPDX-License-Identifier: GPL-3.0-or-later
// The engineer's panel in the browser: a sensor is placed on the surface, dragged and saved, and its loop is checked with a
// forced transmitter.
import assert from 'node:assert/strict';
import { chmodSync, existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { DESKTOP, drawnAt, land, openPage, settle, shoot, TABLET, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { missing, TinyPlant } from '../support/tiny_plant.mjs';
import { until } from '../support/until.mjs';

const absent = missing();
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : !existsSync('/usr/bin/chromium') ? 'no chromium' : false;
const options = { skip, timeout: 200000 };
let plant, browser, page, tagsFile;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    tagsFile = join(plant.folder, 'tags.csv');
    plant.keepFresh();
    writeFileSync(tagsFile, `${readFileSync(tagsFile, 'utf8')}TI-9,400007,Float,°C,spare,temperature,,,,,600\n`);
    assert.equal(plant.prepare().code, 0);
    await plant.startSim();
    await plant.set({ 'TI-1': 80, 'TI-2': 20, 'TI-9': 50, 'PI-1': 5 });
    plant.disown();
    await plant.startDaemon();
    browser = own(await openPage(`http://127.0.0.1:${plant.port}/`, DESKTOP));
    page = browser.page;
    await ready(page);
});

async function ready(on) {
    await waitForPicture(on);
    await look(on, [2.2, -2.2, 1.6]);
}

async function look(on, eye) {
    await on.evaluate((from) => globalThis.plantcast.session.setCamera({ eye: from, target: [0, 0, 0], up: [0, 0, 1], fov: 45 }), eye);
    await on.waitForFunction((from) => {
        const at = globalThis.plantcast.session.picture?.camera.eye;
        return at && Math.hypot(...at.map((v, i) => v - from[i])) < 1e-3;
    }, eye);
}

const text = (selector, on = page) => on.locator(selector).textContent();
const says = (selector, pattern, on = page) => on.waitForFunction(
    ([where, what]) => new RegExp(what).test(document.querySelector(where)?.textContent ?? ''), [selector, pattern]);
// Returns the position on the page of a point of the plant.
const at = (place, on = page) => drawnAt(on, place);
const moved = (on = page) => on.evaluate(() => [...globalThis.plantcast.session.model.placed.values()][0]?.position ?? null);
const button = (name, on = page) => on.locator('#engineer').getByRole('button', { name, exact: true });

test('a click puts an unplaced tag onto the surface, and its field appears', options, async () => {
    await page.locator('#engineer-toggle').click();
    await says('#engineer .tags li', 'TI-9 spare.*not placed');
    await page.locator('#engineer .tags button').first().click();
    await says('#engineer .hint', '^TI-9: click on the surface');
    await land(page); // opening the panel has moved the picture: waits until the camera stands still
    const { x, y } = await at([0.2, -0.5, 0.2]);
    await page.mouse.click(x, y);
    await says('#engineer .moves', 'TI-9 on E-101 .*\\d{3}distances along the surface');
    const place = await moved();
    assert.ok(Math.hypot(place[0] - 0.2, place[1] + 0.5, place[2] - 0.2) < 0.02, `the tag was placed at ${place}`);
    await page.waitForFunction(() => globalThis.plantcast.overlay.markers.some(({ tag }) => tag.name === 'TI-9'));
    await settle(page);
    await shoot(page, 'engineer-placed');
});

test('a marker is dragged over the surface, and one undo step reverts the whole drag', options, async () => {
    const before = await moved(), from = await at(before), to = await at([-0.2, -0.5, -0.1]);
    const eye = await page.evaluate(() => globalThis.plantcast.session.camera.eye);
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    for (let i = 1; i <= 8; i++) {
        await page.mouse.move(from.x + ((to.x - from.x) * i) / 8, from.y + ((to.y - from.y) * i) / 8);
        await page.waitForTimeout(30);
    }
    await page.mouse.up();
    await page.waitForFunction(() => {
        const position = [...globalThis.plantcast.session.model.placed.values()][0]?.position;
        return position && Math.hypot(position[0] + 0.2, position[1] + 0.5, position[2] + 0.1) < 0.02;
    });
    assert.deepEqual(await page.evaluate(() => globalThis.plantcast.session.camera.eye), eye, 'the camera stays');
    await button('Undo').click();
    await page.waitForFunction((x) => Math.abs([...globalThis.plantcast.session.model.placed.values()][0].position[0] - x) < 1e-9,
        before[0]);
    await page.mouse.click(5 + (await page.locator('#viewport').boundingBox()).x, 5 + (await page.locator('#viewport').boundingBox()).y);
    await says('#engineer .note', 'There is no surface');
});

test('a new value for the card of a point does not move the tag that is being placed', options, async () => {
    const before = await moved(), hint = await text('#engineer .hint');
    assert.match(hint, /^TI-9: click on the surface/);
    await page.evaluate(() => {
        const { modules, viewport: { width, height } } = globalThis.plantcast;
        modules.use('place', (card) => card.open(width / 2, height / 2));
    });
    await page.waitForFunction(() => globalThis.plantcast.modules.there('place')?.picked);
    await page.evaluate(() => {
        const card = globalThis.plantcast.modules.there('place');
        globalThis.answered = new Promise((done) => { globalThis.plantcast.session.on('picked', done); });
        card.ask();
        return globalThis.answered;
    });
    assert.deepEqual(await moved(), before);
    await page.evaluate(() => globalThis.plantcast.modules.there('place').close());
});

test('the panel reports coverage gaps', options, async () => {
    await button('Coverage gaps').click();
    await says('#engineer .gaps', 'Coverage gaps: Temperature.*No sensor is off its surface.*' +
        'E-101 Largest distance to the nearest sensor: \\d.*Most isolated sensor');
    await settle(page);
    await shoot(page, 'engineer-gaps');
});

// snapshot() fetches the picture of one past instant, so that two of them can differ only by the marks of loop checks. plain:
// the one without such marks.
let instant, plain;
const snapshot = async () => {
    const answer = await fetch(`http://127.0.0.1:${plant.port}/snapshot.png?width=640&height=400&look=flat&at=${instant}`);
    assert.equal(answer.status, 200);
    return Buffer.from(await answer.arrayBuffer());
};

test('saving the list first shows the changes, then makes the list active', options, async () => {
    const old = readFileSync(tagsFile, 'utf8');
    await says('#assets-list', 'E-101.*2 sensors.*Unassigned tags.*1 sensor');
    await button('Save …').click();
    await says('dialog.diff[open]', 'line 5');
    await shoot(page, 'engineer-diff');
    await page.getByRole('button', { name: 'Cancel', exact: true }).click();
    assert.equal(readFileSync(tagsFile, 'utf8'), old);
    await button('Save …').click();
    await page.getByRole('button', { name: 'Save and apply' }).click();
    await says('#engineer .part .note', 'Applied. The previous list is kept as tags\\.csv\\.1');
    assert.equal(readFileSync(`${tagsFile}.1`, 'utf8'), old);
    assert.match(readFileSync(tagsFile, 'utf8'), /TI-9,400007,Float,°C,spare,temperature,E-101,0\.\d+,-0\.5,0\.\d+,600/);
    await page.waitForFunction(() => globalThis.plantcast.session.model.tag('TI-9').position !== null);
    assert.equal(await moved(), null);
    await says('#assets-list', 'E-101.*3 sensors');
    assert.doesNotMatch(await text('#assets-list'), /Unassigned/);
    await ready(page);
    instant = new Date().toISOString();
    await page.waitForFunction((us) => globalThis.plantcast.session.clockUs() > us + 3e6, Date.now() * 1000);
    // requests the picture until two in a row are equal: on a busy machine the history of an instant may be completed late
    plain = await until('equal pictures', async () => {
        const one = await snapshot();
        return one.equals(await snapshot()) && one;
    });
});

test('loop check: the panel names the tag that changed, even if two are swapped; a matching value passes the tag', options, async () => {
    await page.locator('#engineer label', { hasText: 'Loop check' }).click();
    await says('#engineer .count', '^0 of 4 passed');
    await page.locator('#engineer .part:not([hidden]) .tags button', { hasText: 'TI-1' }).click();
    await says('#engineer .judge output', '^now 80');
    await page.waitForFunction(() => globalThis.plantcast.modules.there('engineer').parts.prove.loopCheck.last.size === 4);
    await button('Watch for changes').click();
    await plant.tell('set TI-2 60');
    await says('#engineer .judge .note', 'TI-2 changed, not TI-1: are they swapped');
    await settle(page);
    await shoot(page, 'engineer-swapped');
    await button('Watch for changes').click();
    await plant.tell('set TI-1 90');
    await says('#engineer .judge .note', '^TI-1 changed most: by 10');
    await page.getByLabel('Expected').fill('90,2');
    await page.getByLabel('Tolerance').fill('0.5');
    await button('Compare').click();
    await says('#engineer .count', '^1 of 4 passed');
    await says('#engineer .judge h3', '^TI-2$');
    await page.getByLabel('Expected').fill('10');
    await button('Compare').click();
    await says('#engineer', 'TI-2 failed: the value is beyond the tolerance \\(60');
    await settle(page);
    await shoot(page, 'engineer-proving');
});

test('expected values are read from a CSV file; results are exported with name, time and value', options, async () => {
    const choose = (name, body) =>
        page.locator('#engineer input[type="file"]').setInputFiles({ name, mimeType: 'text/csv', buffer: Buffer.from(body) });
    await choose('wrong.csv', 'Tag,Value\nTI-9,50\n');
    await says('#engineer .part:not([hidden])', 'Columns Tag Name, Expected, Tolerance are required');
    await choose('loop.csv', 'Tag Name;Expected;Tolerance\r\nTI-9;50,3;0,5\r\nPI-1;5;0,1\r\n');
    await says('#engineer .part:not([hidden])', '2 expected values were read');
    await page.locator('#engineer .part:not([hidden]) .tags button', { hasText: 'TI-9' }).click();
    assert.deepEqual([await page.getByLabel('Expected').inputValue(), await page.getByLabel('Tolerance').inputValue()], ['50.3', '0.5']);
    await says('#engineer .judge output', '^now 50');
    await button('Compare').click();
    await says('#engineer .count', '^2 of 4 passed');
    const download = page.waitForEvent('download');
    await button('Export results').click();
    const file = await download, rows = readFileSync(await file.path(), 'utf8').trim().split('\n');
    assert.equal(file.suggestedFilename(), 'proofs.csv');
    assert.match(rows[0], /^Time,Tag Name,Result,Value,Unit,Expected,Tolerance,By/);
    assert.match(rows.find((row) => row.includes('"TI-9"')), /^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ,"TI-9",pass,50,"°C",50\.3,0\.5,"local"/);
});

test('a failed or missing loop check is shown to everybody, also after a reload of the page', options, async () => {
    await page.reload();
    await ready(page);
    await page.waitForFunction(() => globalThis.plantcast.session.model.provingBegun);
    await page.evaluate(() => {
        const { selection, session } = globalThis.plantcast;
        selection.tag = session.model.tag('TI-2').name;
    });
    await says('#card .proof', '^Loop check failed$');
    assert.deepEqual(await page.evaluate(() => globalThis.plantcast.session.model.tags.map((tag) =>
        globalThis.plantcast.session.model.unproven(tag))), [null, 'fail', 'none', null]);
    await says('#legend .keys', 'Not loop-checked');
    assert.notDeepEqual(await snapshot(), plain, 'the server\'s pictures show the loop check, too');
    await settle(page);
    await shoot(page, 'engineer-unproven');
    assert.deepEqual(browser.errors, []);
});

test('on a tablet a tap places a tag, and a finger drags it', options, async () => {
    const tablet = await openPage(`http://127.0.0.1:${plant.port}/`, TABLET), on = tablet.page;
    await ready(on);
    await on.locator('#engineer-toggle').tap();
    // waits until TI-1's marker is visible: if it were hidden, choosing the tag would start a camera flight, which the test
    // does not expect
    await on.waitForFunction(() => globalThis.plantcast.overlay.markers.some(({ tag, occluded }) => tag.name === 'TI-1' && !occluded));
    await on.locator('#engineer .tags button', { hasText: 'TI-1' }).tap();
    await look(on, [2.6, -2.2, 1.6]);
    const { x, y } = await at([0.1, -0.5, 0.1], on);
    await on.touchscreen.tap(x, y);
    await says('#engineer .moves', 'TI-1 on E-101 .*\\d{3}distances along the surface', on); // the server has answered
    assert.ok(Math.hypot(...(await moved(on)).map((v, i) => v - [0.1, -0.5, 0.1][i])) < 0.03);
    await settle(on);
    await shoot(on, 'engineer-tablet');
    const from = await at(await moved(on), on), to = await at([0.3, -0.5, -0.2], on), client = await on.context().newCDPSession(on);
    const eye = await on.evaluate(() => globalThis.plantcast.session.camera.eye);
    const touch = (type, ...touchPoints) => client.send('Input.dispatchTouchEvent', { type, touchPoints });
    await touch('touchStart', from);
    for (let i = 1; i <= 5; i++)
        await touch('touchMove', { x: from.x + ((to.x - from.x) * i) / 5, y: from.y + ((to.y - from.y) * i) / 5 });
    await on.waitForFunction(() => {
        const [x, y, z] = [...globalThis.plantcast.session.model.placed.values()][0].position;
        return Math.hypot(x - 0.3, y + 0.5, z + 0.2) < 0.03;
    });
    await touch('touchEnd');
    assert.deepEqual(await on.evaluate(() => globalThis.plantcast.session.camera.eye), eye, 'the camera stays');
    await says('#engineer .moves', '\\d{3}distances along the surface', on);
    await settle(on);
    await shoot(on, 'engineer-tablet-dragged');
    assert.equal(await text('#engineer .hint', on), 'TI-1: click on the surface, or drag its marker.');
    assert.deepEqual(tablet.errors, []);
    await tablet.close();
});

test('a read-only folder of the tag list is reported, and nothing changes', options, async () => {
    const before = readFileSync(tagsFile, 'utf8');
    await page.locator('#engineer-toggle').click();
    await page.locator('#engineer .tags button', { hasText: 'TI-9' }).click();
    await look(page, [2.2, -2.2, 1.6]);
    const { x, y } = await at([0.1, -0.5, 0.3]);
    await page.mouse.click(x, y);
    await says('#engineer .moves', 'TI-9 on E-101 .*\\d{3}distances along the surface');
    chmodSync(plant.folder, 0o555);
    try {
        await button('Save …').click();
        await page.getByRole('button', { name: 'Save and apply' }).click();
        await says('#engineer .part .note', 'Not saved: the daemon may not write into the folder of the tag list \\(tags\\.csv\\.2\\)');
    } finally {
        chmodSync(plant.folder, 0o755);
    }
    assert.equal(readFileSync(tagsFile, 'utf8'), before);
    assert.ok(await moved(), 'the trial positions are still there');
    await settle(page);
    await shoot(page, 'engineer-refused');
    await button('Save …').click();
    await page.getByRole('button', { name: 'Save and apply' }).click();
    await says('#engineer .part .note', 'Applied. The previous list is kept as tags\\.csv\\.2');
});
