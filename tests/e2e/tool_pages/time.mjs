// SPDX-License-Identifier: GPL-3.0-or-later
// Trends and the time slider in the browser: the past is shown and labelled, compared, exported, played back, and left again.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { arrive, openPage, PHONE, settle, shoot, TABLET, travel, waitForHealth, waitForPicture } from '../support/browser.mjs';
import { contrastRatio } from '../support/pixels.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, runProgram, sleep, TinyPlant } from '../support/tiny_plant.mjs';
import { becomes, until } from '../support/until.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
const BEGIN_S = Math.floor(Date.now() / 1000) - 3000;
let plant, browser, page;

// Returns a CSV file of history: each tag follows a slow wave, and TI-1 is Bad from minute 20 to 25. The waves of TI-2 and PI-1 have
// noise, because the history leaves out points of a smooth curve.
const STEP_S = 5;
function series() {
    const lines = ['Tag,Time,Value,Quality'], noise = (n) => Math.abs(Math.sin(n * 12.9898) * 43758.5453) % 1;
    for (let s = 0; s <= 2900; s += STEP_S) {
        const bad = s >= 1200 && s < 1500;
        const wave = [50 + 30 * Math.sin(s / 300), 40 + 10 * Math.cos(s / 400) + 2 * noise(s), 5 + Math.sin(s / 200) + noise(s + 1)]
            .map((value) => value.toFixed(3));
        lines.push(bad ? `TI-1,${BEGIN_S + s},,0x80050000` : `TI-1,${BEGIN_S + s},${wave[0]},Good`);
        lines.push(`TI-2,${BEGIN_S + s},${wave[1]},Good`, `PI-1,${BEGIN_S + s},${wave[2]},Good`);
    }
    return `${lines.join('\n')}\n`;
}

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    plant.giveDeviceTime();
    const tags = join(plant.folder, 'tags.csv'), [head, ...rows] = readFileSync(tags, 'utf8').trim().split('\n');
    const limits = { 'TI-1': '90,95', 'TI-2': '85,90' };
    // stale after 5 s instead of 1 s, because a busy machine may read that late
    const limited = rows.map((row) => `${row.replace(/,1$/, ',5')},${limits[row.split(',')[0]] ?? ','}`);
    writeFileSync(tags, `${[`${head},H,HH`, ...limited].join('\n')}\n`);
    assert.equal(plant.prepare().code, 0);
    writeFileSync(join(plant.folder, 'series.csv'), series());
    const imported = runProgram('plantcast', ['history', 'import', plant.file, join(plant.folder, 'series.csv')]);
    assert.equal(imported.code, 0, imported.err);
    await plant.startSim();
    // sets values within the limits, so that only the tests raise alarms
    await plant.set({ 'TI-1': 50, 'TI-2': 40, 'PI-1': 5 });
    await plant.startDaemon();
    browser = own(await openPage(`http://127.0.0.1:${plant.port}/`, { viewport: { width: 1280, height: 720 } }));
    page = browser.page;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    await page.waitForFunction(() => globalThis.plantcast.session.time.fromUs);
});

const shown = (on = page) => on.evaluate(() => {
    const { session } = globalThis.plantcast;
    return { ...session.time, past: session.picture.past, dataTimeUs: session.picture.dataTimeUs };
});

async function clickMarker(name) {
    const at = await page.evaluate((tag) => {
        const { session, overlay } = globalThis.plantcast;
        const marker = overlay.marker(session.model.tag(tag)), box = document.getElementById('overlay').getBoundingClientRect();
        return { x: box.left + marker.x, y: box.top + marker.y };
    }, name);
    await page.mouse.click(at.x, at.y);
}

test('a click on a marker opens its trend, with unit and gap; a chart library that failed to load is loaded again', options, async () => {
    await settle(page);
    let requests = 0;
    await page.route('**/vendor/uPlot.js', (route) => (requests++ === 0 ? route.abort() : route.continue()));
    await clickMarker('TI-1');
    await page.locator('#card .trend').click();
    await page.locator('#trend-chart canvas').waitFor();
    assert.equal(requests, 2);
    assert.match(await page.locator('#trend-tags').textContent(), /TI-1.*°C/);
    await page.waitForFunction(() => document.getElementById('trend-note').textContent.includes('TI-1'));
    assert.equal(await page.locator('#trend-range').inputValue(), 'last 1 h', 'a new trend shows the recorded 50 minutes');
    const ink = await page.evaluate(() => {
        const canvas = document.querySelector('#trend-chart canvas');
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        let blue = 0;
        for (let i = 0; i < data.length; i += 4)
            blue += data[i + 3] > 128 && data[i] < 60 && data[i + 2] > 120;
        return blue;
    });
    assert.ok(ink > 300, `the line has only ${ink} pixels`);
    const names = await page.evaluate(() => { // records the texts in the chart and their positions
        const { chart } = globalThis.plantcast.trends, { prototype } = CanvasRenderingContext2D, { fillText } = prototype, found = {};
        prototype.fillText = function write(words, x, y) {
            found[words] = { y, inside: x >= chart.bbox.left && x < chart.bbox.left + chart.bbox.width };
            fillText.call(this, words, x, y);
        };
        chart.redraw(false);
        return new Promise((done) => requestAnimationFrame(() => {
            prototype.fillText = fillText;
            done(['H 90', 'HH 95'].map((words) => found[words]?.inside &&
                Math.abs(found[words].y - chart.valToPos(Number(words.split(' ')[1]), '°C', true))));
        }));
    });
    assert.ok(names.every((away) => away < 8), `distances of limit names from their lines: ${names}`);
    await settle(page);
    await shoot(page, 'trend');
});

test('several tags are compared, each with its unit, and exported', options, async () => {
    assert.ok(await page.locator('#card .add-trend').isHidden(), 'no button adds a tag that the chart already has');
    for (const name of ['TI-2', 'PI-1']) {
        await page.evaluate((tag) => globalThis.plantcast.selectTag(globalThis.plantcast.session.model.tag(tag)), name);
        assert.equal(await page.locator('#trend-tags tbody tr').count(), name === 'TI-2' ? 1 : 2,
            'selecting a tag replaces nothing in the chart');
        await page.locator('#card .add-trend').click();
    }
    await page.waitForFunction(() => globalThis.plantcast.trends.series.size === 3);
    assert.equal(await page.locator('#trend-tags tbody tr').count(), 3);
    const axes = await page.evaluate(() => globalThis.plantcast.trends.chart.axes.filter((axis) => axis.show)
        .map((axis) => axis.label ?? 'time'));
    assert.deepEqual(axes, ['time', '°C', 'bar']);
    const download = page.waitForEvent('download');
    await page.locator('#trend-csv').click();
    const file = await download, text = readFileSync(await file.path(), 'utf8');
    assert.equal(file.suggestedFilename(), 'TI-1_TI-2_PI-1.csv');
    const rows = text.trim().split('\n');
    assert.match(rows[0], /tag/i);
    for (const name of ['TI-1', 'TI-2', 'PI-1'])
        assert.ok(rows.some((row) => row.includes(name)), name);
    await page.locator('#trend-span label', { hasText: 'Shift' }).click();
    await page.waitForFunction(() => { const { span } = globalThis.plantcast.trends; return span[1] - span[0] === 28800e6; });
    await settle(page);
    await shoot(page, 'trends');
    await page.locator('#trend-span label', { hasText: '1 h' }).click();
    await page.locator('#card .trend').click();
    assert.deepEqual(await page.locator('#trend-tags tbody b').allTextContents(), ['PI-1'], 'only PI-1 is left in the chart');
    await page.evaluate(() => globalThis.plantcast.showTrend(globalThis.plantcast.session.model.tag('TI-1')));
    for (const name of ['TI-2', 'PI-1'])
        await page.evaluate((tag) => globalThis.plantcast.addTrend(globalThis.plantcast.session.model.tag(tag)), name);
});

const rangeOf = () => page.evaluate(() => globalThis.plantcast.trends.range);
const drawn = ([from, to]) => page.waitForFunction((span) => { // Waits until the chart has drawn the values of that range.
    const { trends: { span: now, isAsking } } = globalThis.plantcast;
    return !isAsking && now.every((us, i) => Math.abs(us - span[i]) < 3e6);
}, [from, to]);

// Returns the smallest number of points that the curves of TI-2 and PI-1 have in the drawn range, relative to the number of their
// recorded values or to 100, if more are recorded.
const leastDrawn = () => page.evaluate((stepS) => {
    const { series: all, span: [from, to] } = globalThis.plantcast.trends, recorded = (to - from) / 1e6 / stepS;
    return Math.min(...['TI-2', 'PI-1'].map((name) => all.get(name)?.points.filter(([us]) => us >= from && us <= to).length ?? 0)) /
        Math.min(100, recorded);
}, STEP_S);

test('a drag zooms, the wheel zooms about the pointer, dragging the axis pans, and each can be undone', options, async () => {
    await page.waitForFunction(() => globalThis.plantcast.trends.series.size === 3 && globalThis.plantcast.trends.chart);
    // zooms out to 8 hours: the server answers with a point a minute, which are too few for the range that the drag chooses
    await page.locator('#trend-span label', { hasText: 'Shift' }).click();
    await drawn(await rangeOf());
    await settle(page); // waits until the value axes of all three tags have their final widths, because they move the plot
    const box = await page.locator('#trend-chart .u-over').boundingBox(), y = box.y + box.height / 2;
    const [from, to] = await rangeOf(), at = (x) => from + ((to - from) * (x - box.x)) / box.width;
    const [a, b] = [0.92, 0.965].map((part) => Math.round(box.x + part * box.width));
    await page.mouse.move(a, y);
    await page.mouse.down();
    await page.mouse.move(b, y, { steps: 4 });
    await page.mouse.up();
    const zoomed = await rangeOf();
    assert.ok([a, b].every((x, i) => Math.abs(at(x) - zoomed[i]) < (to - from) / 300), JSON.stringify([[a, b].map(at), zoomed]));
    assert.equal((await shown()).past, false, 'a drag does not count as a click');
    await drawn(zoomed);
    assert.ok(await leastDrawn() > 0.5, 'the curves of the zoomed range lack no points');
    assert.match(await page.locator('#trend-range').inputValue(), /^\d{4}-\d\d-\d\d \d\d:\d\d.* to /);
    await settle(page); // waits again, because the labels of the new range may change the widths of the axes
    const plot = await page.locator('#trend-chart .u-over').boundingBox();
    await page.mouse.move(plot.x + plot.width / 4, y);
    await page.mouse.wheel(0, -200);
    await page.waitForFunction((long) => { const [begin, end] = globalThis.plantcast.trends.range; return end - begin < long; },
        (zoomed[1] - zoomed[0]) * 0.9);
    const closer = await rangeOf(), kept = (range) => range[0] + (range[1] - range[0]) / 4;
    assert.ok(Math.abs(kept(closer) - kept(zoomed)) < 1e6, 'zoom keeps the instant under the pointer');
    const axis = await page.locator('#trend-chart .u-axis').first().boundingBox();
    await page.mouse.move(axis.x + 300, axis.y + axis.height / 2);
    await page.mouse.down();
    await page.mouse.move(axis.x + 400, axis.y + axis.height / 2, { steps: 4 });
    await page.mouse.up();
    const moved = await rangeOf();
    assert.ok(moved[0] < closer[0] && Math.abs(moved[1] - moved[0] - closer[1] + closer[0]) < 1,
        'the range moves to earlier times and keeps its length');
    await drawn(moved);
    await shoot(page, 'trend-zoomed');
    const back = page.locator('#trend-back');
    while ((await rangeOf())[0] !== zoomed[0])
        await back.click();
    await drawn(zoomed);
    assert.ok(await leastDrawn() > 0.5, 'the curves of the range to which the page returns lack no points');
    await back.click();
    await page.waitForFunction(() => globalThis.plantcast.trends.fixed === null);
    await page.locator('#trend-span label', { hasText: '1 h' }).click();
});

test('a typed time range is shown, with its statistics, and the crosshair is shared with the time bar', options, async () => {
    const date = (s) => new Date(s * 1000).toISOString().slice(0, 19).replace('T', ' ');
    await page.locator('#trend-range').fill(`${date(BEGIN_S + 1100)} to ${date(BEGIN_S + 1600)}`);
    await page.keyboard.press('Enter');
    await drawn([(BEGIN_S + 1100) * 1e6, (BEGIN_S + 1600) * 1e6]);
    const cells = await page.locator('#trend-tags tbody tr').first().locator('td').allTextContents();
    const [, , min, mean, max, known] = cells.map((text) => Number(text.replace('−', '-').replace(' %', '')));
    const wave = Array.from({ length: 500 }, (_, i) => 1100 + i).filter((s) => s < 1200 || s >= 1500)
        .map((s) => 50 + 30 * Math.sin(s / 300));
    assert.ok(Math.abs(min - Math.min(...wave)) < 1 && Math.abs(max - Math.max(...wave)) < 1,
        `statistics of minimum and maximum: ${cells}`);
    assert.ok(Math.abs(mean - wave.reduce((sum, value) => sum + value) / wave.length) < 1 && Math.abs(known - 40) <= 2,
        `statistics of mean and known share: ${cells}`);
    await page.locator('#trend-range').fill('noon');
    await page.keyboard.press('Enter');
    const field = page.locator('#trend-range'), isRed = () => field.evaluate((e) => e.matches('[aria-invalid="true"]'));
    const unread = /“noon” is not a time range/;
    assert.match(await page.locator('#trend-note').textContent(), unread);
    assert.equal(await isRed(), true);
    await field.fill('');
    await page.keyboard.press('Enter');
    assert.equal(await isRed(), false, 'a cleared field is not marked as wrong');
    assert.doesNotMatch(await page.locator('#trend-note').textContent(), unread);
    await field.fill('noon');
    await page.keyboard.press('Enter');
    assert.equal(await isRed(), true);
    await page.locator('#trend-span label', { hasText: 'Shift' }).click();
    assert.deepEqual([await isRed(), await field.inputValue()], [false, 'last 8 h'], 'another range replaces the wrong text');
    await page.locator('#time-toggle').click();
    await page.locator('#time-track').waitFor();
    await page.locator('#trend-span label', { hasText: '1 h' }).click();
    const box = await page.locator('#trend-chart .u-over').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + 20);
    await page.locator('#time-track .cross').waitFor({ state: 'attached' });
    assert.match(await page.locator('#trend-at').textContent(), /\d\d:\d\d:\d\d/);
    const track = await page.locator('#time-slider').boundingBox();
    await page.mouse.move(track.x + track.width * 0.8, track.y + track.height / 2);
    await page.waitForFunction(() => {
        const { trends } = globalThis.plantcast, [from, to] = trends.range;
        return Math.abs((trends.crosshairUs - from) / (to - from) - 0.8) < 0.03 && trends.chart.cursor.left > 0;
    });
    await page.locator('#time-toggle').click();
});

test('keys move the crosshair, zoom and pan, and the camera stays', options, async () => {
    const eye = () => page.evaluate(() => globalThis.plantcast.session.camera.eye);
    await page.locator('#time-toggle').click();
    // the open time bar has made the picture smaller: waits until the camera has adapted, to compare its position afterwards
    await arrive(page);
    const before = await eye();
    await page.locator('#trend-chart').focus();
    const [from, to] = await rangeOf();
    await page.keyboard.press('ArrowLeft');
    await page.waitForFunction(() => globalThis.plantcast.trends.crosshairUs);
    await page.keyboard.press('+');
    const closer = await rangeOf();
    assert.ok(closer[1] - closer[0] < 0.7 * (to - from));
    await page.keyboard.press('PageUp');
    assert.ok((await rangeOf())[0] < closer[0]);
    await page.keyboard.press('Home');
    await page.waitForFunction(() => globalThis.plantcast.trends.fixed === null);
    await page.locator('#time-slider').focus();
    await page.keyboard.press('ArrowLeft');
    await waitForHealth(page, 'past');
    await page.keyboard.press('ArrowDown');
    assert.deepEqual(await eye(), before, 'arrow keys on the slider do not turn the camera');
    await page.locator('#time-live').click();
    await waitForHealth(page, 'live');
    await page.locator('#time-toggle').click();
});

test('tags are added by typing, and by dragging a marker or a row of the list', options, async () => {
    const names = () => page.locator('#trend-tags tbody b').allTextContents();
    for (const name of ['TI-2', 'PI-1'])
        await page.locator('#trend-tags tr', { hasText: name }).locator('.drop').click();
    assert.deepEqual(await names(), ['TI-1']);
    await page.locator('#trend-add').fill('pump');
    await page.keyboard.press('Enter');
    assert.deepEqual(await names(), ['TI-1', 'PI-1'], 'the tag is found by its description');
    await page.evaluate(() => {
        globalThis.plantcast.session.setParams({ group: 'temperature' });
        globalThis.plantcast.selectTag(null); // deselects the tag, because its card may cover the marker that the test drags
    });
    await arrive(page);
    const [from, to] = await page.evaluate(() => {
        const { session, overlay } = globalThis.plantcast, chart = document.getElementById('trend-chart').getBoundingClientRect();
        const marker = overlay.marker(session.model.tag('TI-2')), box = document.getElementById('overlay').getBoundingClientRect();
        return [[box.left + marker.x, box.top + marker.y], [chart.left + 200, chart.top + 40]];
    });
    const before = await page.evaluate(() => globalThis.plantcast.session.camera.eye);
    await page.mouse.move(...from);
    await page.locator('#viewport.pointing').waitFor();
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 5 });
    await page.locator('.drag-ghost', { hasText: 'TI-2' }).waitFor();
    await page.mouse.up();
    assert.deepEqual(await names(), ['TI-1', 'PI-1', 'TI-2']);
    assert.deepEqual(await page.evaluate(() => globalThis.plantcast.session.camera.eye), before, 'the camera did not turn');
    await page.locator('#trend-tags tr', { hasText: 'PI-1' }).locator('.drop').click();
    await page.evaluate(() => globalThis.plantcast.addTrend(globalThis.plantcast.session.model.tag('PI-1')));
});

test('a chart draws no series until the answer for its tags has arrived', options, async () => {
    const state = () => page.evaluate(() => {
        const { chart, crosshairUs } = globalThis.plantcast.trends;
        const cells = [...document.querySelectorAll('#trend-tags tbody .at')].map(({ textContent }) => textContent);
        return { labels: chart.series.slice(1).map(({ label }) => label), cells, isRead: crosshairUs !== null };
    });
    const path = /api\/v1\/history/, drawn = (name) => page.waitForFunction(
        (label) => globalThis.plantcast.trends.chart.series[1]?.label === label, name);
    await page.evaluate(() => { const { trends, session } = globalThis.plantcast; trends.only(session.model.tag('TI-1')); });
    await drawn('TI-1'); // waits until TI-1's answer is drawn, so that no earlier answer can contain PI-1's values
    let answer;
    const answered = new Promise((done) => { answer = done; });
    await page.route(path, async (route) => { await answered; await route.continue(); });
    await page.evaluate(() => { const { trends, session } = globalThis.plantcast; trends.only(session.model.tag('PI-1')); });
    await page.locator('#theme').click();
    await page.waitForFunction(() => globalThis.plantcast.trends.shownTheme === 'dark');
    await page.locator('#trend-chart .u-over').hover();
    await page.waitForFunction(() => globalThis.plantcast.trends.crosshairUs);
    assert.deepEqual(await state(), { labels: [], cells: ['–'], isRead: true });
    answer();
    await drawn('PI-1');
    await page.unroute(path);
    await page.locator('#theme').click();
    await page.evaluate(() => {
        const { addTrend, session: { model } } = globalThis.plantcast;
        ['TI-1', 'TI-2'].forEach((name) => addTrend(model.tag(name)));
    });
    await page.waitForFunction(() => globalThis.plantcast.trends.series.size === 3);
});

test('in the dark theme the chart is dark, and its lines and limits are legible', options, async () => {
    await page.locator('#theme').click();
    await page.waitForFunction(() => globalThis.plantcast.trends.shownTheme === 'dark');
    const rgbOf = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
    const { ground, lines, limit, grave, ink } = await page.evaluate(() => globalThis.plantcast.trends.look);
    await page.waitForFunction((is) => getComputedStyle(document.getElementById('trends')).backgroundColor === is,
        `rgb(${rgbOf(ground).join(', ')})`); // waits until the style sheet of the new theme has given the panel its background
    assert.ok(Math.max(...rgbOf(ground)) < 90, ground);
    for (const colour of [...lines, limit, grave, ink])
        assert.ok(contrastRatio(rgbOf(colour), rgbOf(ground)) >= 4.5, `contrast of ${colour} on ${ground} is too low`);
    await settle(page);
    await shoot(page, 'trends-dark');
    await page.locator('#theme').click();
    await page.waitForFunction(() => globalThis.plantcast.trends.shownTheme === 'light');
});

test('the slider goes to a past instant, which is clearly marked as the past', options, async () => {
    await page.locator('#time-toggle').click();
    assert.equal(await page.locator('#time-live').isDisabled(), true);
    const slider = page.locator('#time-slider');
    await slider.focus();
    await slider.fill('1800');
    await waitForHealth(page, 'past');
    await page.waitForFunction(() => globalThis.plantcast.session.picture.past);
    const { atUs, dataTimeUs } = await shown();
    assert.ok(Math.abs(atUs / 1e6 - (Date.now() / 1000 - 1800)) < 20 && dataTimeUs === atUs);
    assert.match(await page.locator('#banner').textContent(), /History.*\w{3} \d+, \d{4} \d\d:\d\d:\d\d/);
    assert.match(await page.locator('#clock-name').textContent(), /^Time shown/);
    assert.equal(await page.evaluate(() => getComputedStyle(document.getElementById('viewport'), '::after').borderTopWidth), '5px');
    assert.match(await slider.getAttribute('aria-valuetext'), /\d\d:\d\d:\d\d/);
    assert.match(await page.locator('#alarm-words').textContent(), /^Now: /);
    await page.locator('#alarm-strip').click();
    assert.match(await page.locator('#alarms-then').textContent(), /shows the past.*current alarms/,
        'the list says that its alarms are current');
    await shoot(page, 'past-alarms');
    await page.locator('#alarms-close').click();
    await page.waitForFunction(() => location.hash.includes('at='));
    await settle(page);
    await shoot(page, 'past');
});

test('a recorded gap is shown as a gap in the picture, too', options, async () => {
    await travel(page, (BEGIN_S + 1350) * 1e6);
    await page.waitForFunction((us) => globalThis.plantcast.session.picture.dataTimeUs === us, (BEGIN_S + 1350) * 1e6);
    await page.waitForFunction(() => globalThis.plantcast.session.model.readings[0].quality === 'bad');
    await settle(page);
    await shoot(page, 'past-gap');
});

test('playback plays, pauses, and returns to live', options, async () => {
    await travel(page, (BEGIN_S + 100) * 1e6);
    await page.waitForFunction((us) => globalThis.plantcast.session.time.atUs === us, (BEGIN_S + 100) * 1e6);
    // 60 times: playback crosses the 48 minutes of history in 48 s, so on a busy machine it may reach the present before
    // another picture arrives
    await page.locator('#time-speed').selectOption('60');
    await page.locator('#time-play').click();
    await page.waitForFunction((us) => globalThis.plantcast.session.picture.dataTimeUs > us, (BEGIN_S + 160) * 1e6);
    assert.match(await page.locator('#banner .detail').textContent(), /playing 60×/);
    assert.equal(await page.locator('#time-play').getAttribute('aria-label'), 'Pause');
    await page.locator('#time-play').click();
    // waits for the picture of the instant at which playback was paused; the picture arrives after the instant
    await page.waitForFunction(() => {
        const { time, picture } = globalThis.plantcast.session;
        return time.speed === 0 && Math.abs(picture.dataTimeUs - time.atUs) < 1e6;
    });
    // After the pause the instant must not move: waits until it has been the same for 800 ms, in which playback would have
    // moved it by 48 s.
    await page.waitForFunction(() => {
        const { atUs } = globalThis.plantcast.session.time, now = performance.now();
        if (!(Math.abs(globalThis.paused?.atUs - atUs) < 1e6))
            globalThis.paused = { atUs, now };
        return now - globalThis.paused.now > 800;
    });
    await page.locator('#time-live').click();
    await waitForHealth(page, 'live');
    assert.equal((await shown()).past, false);
    assert.equal(await page.locator('#banner').isVisible(), false);
    await page.locator('#time-toggle').click();
    assert.equal(await page.locator('#timeline').isVisible(), false);
});

test('a click in a trend goes to that instant; a link opens an instant; a reload keeps it', options, async () => {
    const box = await page.locator('#trend-chart .u-over').boundingBox();
    await page.mouse.click(box.x + box.width * 0.6, box.y + box.height / 2);
    await waitForHealth(page, 'past');
    const url = `http://127.0.0.1:${plant.port}/#at=${new Date((BEGIN_S + 600) * 1000).toISOString()}`;
    const other = await openPage(url, TABLET);
    await waitForPicture(other.page);
    const first = await shown(other.page);
    assert.deepEqual([first.past, first.dataTimeUs], [true, (BEGIN_S + 600) * 1e6]);
    await other.page.locator('#timeline').waitFor();
    await settle(other.page);
    await shoot(other.page, 'past-tablet');
    assert.deepEqual(other.errors, []);
    await other.close();
    await page.keyboard.press('Escape');
    await travel(page, null);
    await waitForHealth(page, 'live');
});

test('alarms are marked on the time bar where they were raised', options, async () => {
    await plant.tell('set TI-2 92');
    await page.waitForFunction(() => globalThis.plantcast.session.model.alarms.list().some(({ kind }) => kind === 'HH'));
    await page.waitForFunction(async () => { // the journal is written with a delay
        const { rows } = await (await fetch('/api/v1/alarms/journal')).json();
        return rows.some(({ event, tag }) => event === 'raise' && tag === 'TI-2');
    }, null, { polling: 200 });
    if (await page.locator('#timeline').isVisible())
        await page.locator('#time-toggle').click();
    await page.locator('#time-toggle').click();
    // finds a mark on the time slider that lists an alarm of TI-2; other alarms may precede it there, because marks close
    // together are merged into one
    const mark = page.locator('#time-track .alarm title', { hasText: /\bTI-2 HH?, \d\d:\d\d:\d\d/ }).first();
    await mark.waitFor({ state: 'attached' });
    assert.match(await page.locator('#time-alarms').textContent(), /^\d+ alarms? raised$/);
    await settle(page);
    await shoot(page, 'time-alarms');
});

const instantOf = (us) => page.waitForFunction((to) => globalThis.plantcast.session.time.atUs === to, us);
const timeText = (us) => new Date(us / 1000).toISOString().slice(0, 19);
// Returns the instant (BEGIN_S + s) in microseconds, or one second later if it is a full minute, because Chromium's date field
// drops seconds of :00.
const afterBegin = (s) => (BEGIN_S + s + ((BEGIN_S + s) % 60 === 0)) * 1e6;

test('marks and buttons lead to an alarm\'s instant, from alarm to alarm, and to a date', options, async () => {
    const raises = await page.evaluate(async () => {
        const { rows } = await (await fetch('/api/v1/alarms/journal')).json();
        return rows.filter(({ event }) => event === 'raise').map(({ time_us: us }) => us).reverse();
    });
    // waits until the alarm is 4 s old, because choosing a newer instant returns the page to the present
    const old = (us) => globalThis.plantcast.session.clockUs() - us > 4e6;
    await page.waitForFunction(old, raises.at(-1));
    await page.locator('#time-track .alarm').last().click();
    await page.waitForFunction((all) => all.includes(globalThis.plantcast.session.time.atUs), raises);
    await waitForHealth(page, 'past');
    assert.match(await page.locator('#time-alarms').textContent(), /^TI-2 HH?/);
    await page.locator('#time-live').click();
    await waitForHealth(page, 'live');
    await page.locator('#time-before').click();
    await instantOf(raises.at(-1));
    assert.match(await page.locator('#moment').textContent(), /TI-2 High/, 'the moment\'s title names the alarm');
    await page.waitForFunction(() => globalThis.plantcast.selection.tag === 'TI-2');
    await page.locator('#time-track .bar').first().waitFor({ state: 'attached' });
    await shoot(page, 'time-before');
    for (const us of [...new Set(raises)].slice(0, -1).reverse()) {
        await page.locator('#time-before').click();
        await instantOf(us);
    }
    await page.locator('#time-before').click();
    await page.locator('#toast', { hasText: 'No earlier alarm' }).waitFor();
    if (new Set(raises).size > 1) {
        await page.locator('#time-after').click();
        await instantOf([...new Set(raises)][1]);
    }
    const us = afterBegin(777);
    await page.locator('#time-date').fill(timeText(us));
    await instantOf(us);
    await page.locator('#time-slider').focus();
    assert.equal(await page.locator('#time-date').inputValue(), timeText(us));
    await page.locator('#time-span').selectOption('2592000');
    await page.locator('#time-slider').focus();
    await page.keyboard.press('ArrowRight');
    // one key press moves the instant by a minute, whatever the span; a step of the slider itself (1/2000 of 30 days) would be
    // 21 minutes
    await instantOf(us + 60e6);
    await page.locator('#time-span').selectOption('3600');
    await page.locator('#time-live').click();
    await waitForHealth(page, 'live');
});

test('alarms that cannot be read are reported, and not shown as absent', options, async () => {
    const path = /api\/v1\/alarms\/journal/, marks = () => page.locator('#time-track .alarm').count();
    await page.locator('#time-track .alarm').first().waitFor({ state: 'attached' });
    await page.evaluate(() => { const { session, showTrend } = globalThis.plantcast; showTrend(session.model.tag('TI-2')); });
    await page.waitForFunction(() => globalThis.plantcast.trends.alarms.get('TI-2')?.length > 0);
    await page.route(path, (route) => route.abort());
    await page.locator('#time-before').click();
    await page.locator('#toast', { hasText: /^Alarms could not be read: ./ }).waitFor();
    await page.locator('#time-span').selectOption('28800');
    await page.locator('#time-alarms', { hasText: /^Marks may be missing or old: ./ }).waitFor();
    assert.ok(await marks() > 0, 'the marks of the last answer stay');
    await page.locator('#trend-note', { hasText: /Alarms could not be read: ./ }).waitFor();
    assert.ok(await page.evaluate(() => globalThis.plantcast.trends.alarms.get('TI-2').length) > 0);
    await page.unroute(path);
    await page.locator('#time-span').selectOption('3600');
    await page.locator('#time-alarms', { hasText: /^\d+ alarms? raised$/ }).waitFor();
    await page.waitForFunction(() => !document.getElementById('trend-note').textContent.includes('could not be read'));
});

test('two times are compared side by side, with one camera', options, async () => {
    const us = afterBegin(900), inner = () => page.frames().find((frame) => frame.url().includes('pane=compare'));
    if (!await page.locator('#timeline').isVisible())
        await page.locator('#time-toggle').click();
    await page.locator('#time-compare').click();
    await page.waitForFunction(() => globalThis.plantcast.modules.there('compare')?.connected);
    await page.locator('#compare-date').fill(timeText(us));
    await inner().waitForFunction((at) => globalThis.plantcast.session.picture.dataTimeUs === at, us);
    assert.equal((await shown()).past, false, 'the left half still shows the present');
    await page.evaluate(() => globalThis.plantcast.session.setCamera({ eye: [9, -14, 6], target: [0, 0, 0], up: [0, 0, 1], fov: 30 }));
    await inner().waitForFunction(() => globalThis.plantcast.session.camera.eye[0] === 9);
    await inner().evaluate(() => globalThis.plantcast.session.setCamera({ eye: [8, -12, 5], target: [0, 0, 0], up: [0, 0, 1], fov: 30 }));
    await page.waitForFunction(() => globalThis.plantcast.session.camera.eye[0] === 8);
    await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'pressure' }));
    await inner().waitForFunction(() => globalThis.plantcast.session.shown.group === 'pressure');
    const bothHave = async (change, wanted) => {
        await page.evaluate((params) => globalThis.plantcast.session.setParams(params), change);
        await becomes(() => inner().evaluate(() => {
            const { show, sensor, sensors, baseline, range } = globalThis.plantcast.session.confirmed;
            return [show, sensor, sensors['TI-1']?.strength ?? null, baseline?.name ?? null, ...show === 'distance' ? [] : range];
        }), wanted, JSON.stringify(change));
    };
    await bothHave({ group: 'temperature', show: 'distance', sensor: 'TI-1' }, ['distance', 'TI-1', null, null]);
    await bothHave({ sensor: 'TI-2' }, ['distance', 'TI-2', null, null]);
    await bothHave({ show: 'value', sensors: { 'TI-1': { strength: 2 } } }, ['value', 'TI-2', 2, null, 0, 100]);
    await bothHave({ sensors: { 'TI-1': null } }, ['value', 'TI-2', null, null, 0, 100]);
    await bothHave({ show: 'difference', baseline: { set: 'Start-up' } }, ['difference', 'TI-2', null, 'Start-up', -25, 25]);
    await bothHave({ baseline: 'now' }, ['value', 'TI-2', null, null, 0, 100]);
    await bothHave({ show: 'value', baseline: null, group: 'pressure' }, ['value', null, null, null, 0, 10]);
    assert.equal(await inner().locator('.toolbar').isVisible(), false);
    const [left, right] = await Promise.all(['#viewport', '#compare-half'].map((id) => page.locator(id).boundingBox()));
    assert.ok(right.x >= left.x + left.width - 1 && Math.abs(right.width - left.width) < 8, JSON.stringify([left, right]));
    await shoot(page, 'compare');
    await page.locator('#picture-toggle').click();
    await page.locator('#picture-panel.open').waitFor();
    await becomes(async () => {
        const [panel, bar] = await Promise.all(['#picture-panel', '#compare-bar'].map((id) => page.locator(id).boundingBox()));
        return panel.height > 150 && (panel.y + panel.height <= bar.y || panel.x >= bar.x + bar.width);
    }, true, 'an open panel leaves the bar of the right half free');
    await page.keyboard.press('Escape');
    await page.locator('#picture-panel.open').waitFor({ state: 'detached' });
    await page.locator('#compare-bar button').click();
    await page.locator('#compare-half').waitFor({ state: 'detached' });
    await page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'temperature' }));
});

test('times without a running daemon are hatched, without data and without earlier alarm rings', options, async () => {
    assert.ok(await page.evaluate(() => globalThis.plantcast.session.model.alarms.list().length > 0), 'an alarm exists that could linger');
    const stopping = Date.now() * 1e3;
    await plant.daemon.stop();
    const stopped = Date.now() * 1e3;
    await sleep(3500);
    await plant.startDaemon();
    const url = `http://127.0.0.1:${plant.port}/`;
    const [from, to] = await until('the gap', async () => { // recorded within a second
        const { gaps } = await (await fetch(`${url}api/v1/history/gaps?from=-10m`)).json();
        return gaps.at(-1)?.[1] > stopped && gaps.at(-1);
    }, 20);
    assert.ok(from > stopping - 2e6 && from < stopped + 2e6 && to - from > 3e6, JSON.stringify([stopping, stopped, from, to]));
    const other = await openPage(`${url}#at=${new Date((from + to) / 2000).toISOString()}`, { viewport: { width: 1280, height: 720 } });
    await waitForPicture(other.page);
    await other.page.waitForFunction(() => globalThis.plantcast.session.picture.past);
    const seen = () => other.page.evaluate(() => globalThis.plantcast.session.model.tags.map(({ index }) =>
        [globalThis.plantcast.session.model.readings[index].quality, globalThis.plantcast.session.model.alarms.gravest(index)]));
    await becomes(seen, Array(3).fill(['bad', null]));
    await other.page.locator('#banner .detail', { hasText: /No data recorded at that time$/ }).waitFor();
    await other.page.locator('#time-span').selectOption('900');
    await other.page.waitForFunction(() => [...document.querySelectorAll('#time-track .unrecorded')]
        .some((rect) => Number(rect.getAttribute('width')) < 60));
    await settle(other.page);
    await shoot(other.page, 'past-outage');
    assert.deepEqual(other.errors, []);
    await other.close();
});

test('the time bar is hatched while a PLC was lost, and names the PLC; not while a single sensor failed', options, async () => {
    await plant.sim.stop();
    await until('no good reading', async () => {
        const { tags } = await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/tags`)).json();
        return tags.every(({ quality }) => quality === 'bad');
    });
    const lostUs = (Date.now() + 2000) * 1e3; // an instant while the PLC is lost
    await sleep(4000);
    await plant.startSim();
    const then = new Date(lostUs / 1e3).toISOString();
    const { page: own, errors, close } = await openPage(`http://127.0.0.1:${plant.port}/#at=${then}`);
    await waitForPicture(own);
    await own.waitForFunction(() => globalThis.plantcast.session.picture.past);
    const strips = (of) => own.evaluate((name) => [...document.querySelectorAll(`#time-track .${name}`)].map((rect) => {
        const { toUs, spanUs } = globalThis.plantcast.modules.there('timeline');
        const perPx = spanUs / (document.getElementById('time-track').clientWidth - 18);
        const [from, long] = ['x', 'width'].map((key) => Number(rect.getAttribute(key)) * perPx);
        return [toUs - spanUs + from - 9 * perPx, toUs - spanUs + from + long - 9 * perPx, rect.textContent];
    }), of);
    const holds = (at) => ([from, to]) => from <= at && at <= to;
    const askMarks = () => own.evaluate(() => globalThis.plantcast.modules.there('timeline').askMarks());
    await own.locator('#time-span').selectOption('900');
    const strip = await until('the strip', async () => {
        await askMarks(); // history is written with a delay
        return (await strips('lost')).find(holds(lostUs));
    }, 40);
    assert.equal(strip[2], 'plc1: no connection');
    await settle(own);
    await shoot(own, 'past-lost');
    await own.locator('#time-span').selectOption('28800');
    await own.waitForFunction(() => document.querySelectorAll('#time-track .lost').length > 0);
    await askMarks();
    assert.ok(!(await strips('lost')).some(holds((BEGIN_S + 1350) * 1e6)), 'only TI-1 was bad');
    assert.deepEqual(errors, []);
    await close();
});

test('the time bar fits on a phone', options, async () => {
    const phone = await openPage(`http://127.0.0.1:${plant.port}/#at=${new Date((BEGIN_S + 600) * 1000).toISOString()}`, PHONE);
    await waitForPicture(phone.page);
    await phone.page.locator('#timeline').waitFor();
    await settle(phone.page);
    await shoot(phone.page, 'past-phone');
    const wide = await phone.page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(wide <= 0, `the time bar is ${wide} px too wide`);
    const box = await phone.page.locator('#time-live').boundingBox();
    assert.ok(box.x + box.width <= 390 && box.height >= 40, JSON.stringify(box));
    await phone.close();
    assert.deepEqual(browser.errors, []);
});

test('without a recorded history, a page whose address has a past time shows the present as live', options, async (t) => {
    const other = await TinyPlant.create();
    t.after(() => other.destroy());
    writeFileSync(other.file, `${readFileSync(other.file, 'utf8')}history: { record: no }\n`);
    await other.start();
    const live = await openPage(`http://127.0.0.1:${other.port}/#at=${new Date((BEGIN_S + 600) * 1000).toISOString()}`);
    t.after(() => live.close());
    await waitForPicture(live.page);
    await waitForHealth(live.page, 'live');
    await becomes(() => live.page.locator('#time-toggle').isHidden(), true);
    await live.page.waitForFunction(() => !location.hash.includes('at='));
});
