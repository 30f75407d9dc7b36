// SPDX-License-Identifier: GPL-3.0-or-later
// A sensor drifts away from the value that its neighbours suggest: the daemon and the command-line tool find the drift in
// recorded history, and the page shows it.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, settle, shoot, waitForHealth, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, runProgram, TinyPlant } from '../support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 120000 };
const HOUR = 3600, HOURS = 168, END_S = Math.floor(Date.now() / 1000 / HOUR) * HOUR, BEGIN_S = END_S - HOURS * HOUR;
const TAGS = `Tag Name,Address,Data Type,Eng Units,Description,Group,Asset,X,Y,Z,Stale s
TI-1,400001,Float,°C,left,temperature,E-101,0.5,0,0,1
TI-2,400003,Float,°C,right,temperature,E-101,-0.5,0,0,1
TI-3,400005,Float,°C,front,temperature,E-101,0,-0.5,0,1
TI-4,400007,Float,°C,top,temperature,E-101,0,0,0.5,1
PI-1,400009,Float,bar,pump,pressure,P-101A,3,0,0.5,1
`;
let plant, url;

// Returns a week of samples of four sensors. All follow the time of day; TI-3 also drifts upwards by 8 K over the week; TI-4
// delivers no values on the second day.
function series() {
    const lines = ['Tag,Time,Value,Quality'];
    for (let quarter = 0; quarter < HOURS * 4; quarter++) {
        const day = 10 * Math.sin(quarter / 96 * 2 * Math.PI) + 3 * Math.sin(quarter / 11), lost = quarter >= 96 && quarter < 192;
        const values = [60 + day, 50 + 0.8 * day, 55 + 1.1 * day + 8 * quarter / (HOURS * 4), lost ? '' : 45 + 0.9 * day];
        values.forEach((value, i) => lines.push(value === '' ? `TI-${i + 1},${BEGIN_S + quarter * 900},,0x80050000`
            : `TI-${i + 1},${BEGIN_S + quarter * 900},${value.toFixed(3)},Good`));
    }
    return `${lines.join('\n')}\n`;
}

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    writeFileSync(join(plant.folder, 'tags.csv'), TAGS);
    assert.equal(plant.prepare().code, 0);
    writeFileSync(join(plant.folder, 'series.csv'), series());
    const { code, err } = runProgram('plantcast', ['history', 'import', plant.file, join(plant.folder, 'series.csv')]);
    assert.equal(code, 0, err);
    await plant.startSim();
    await plant.startDaemon();
    url = `http://127.0.0.1:${plant.port}/`;
});

const ask = async (query) => {
    const answer = await fetch(`${url}api/v1/drift?${query}`);
    return [answer.status, answer.ok ? await answer.json() : await answer.text()];
};

test('the daemon finds the one drifting sensor, and no other', options, async () => {
    const [status, { from_us: from, to_us: to, group, unit, sensors }] = await ask('group=temperature');
    assert.equal(status, 200);
    assert.deepEqual([group, unit, to - from], ['temperature', '°C', HOURS * HOUR * 1e6]);
    assert.deepEqual(sensors.map(({ tag, verdict }) => [tag, verdict]),
        [['TI-1', 'none'], ['TI-2', 'none'], ['TI-3', 'found'], ['TI-4', 'none']]);
    assert.ok(Math.abs(sensors[2].change - 8) < 1, `the found drift is ${sensors[2].change} of 8 K`);
    assert.ok(sensors[3].hours >= HOURS - 26 && sensors[3].hours < HOURS - 20, 'the hours of the lost day are missing');
    const [, { sensors: [one] }] = await ask('tag=TI-3');
    assert.equal(one.by_hour.length, HOURS);
    assert.equal(one.by_hour[0][0], from);
    assert.ok(one.by_hour.at(-2)[1] - one.by_hour.at(-2)[2] > one.by_hour[1][1] - one.by_hour[1][2] + 5);
    assert.deepEqual(sensors.map(({ cause }) => cause), ['', '', '', '']);
    assert.deepEqual((await ask('group=pressure'))[1].sensors.map(({ verdict, cause, change }) => [verdict, cause, change]),
        [['unknown', 'fewer than 3 sensors of the group on the asset', null]]);
});

test('plantcast sensors drift gives the daemon\'s verdicts; a week earlier all are unknown', options, async () => {
    const { code, out, err } = runProgram('plantcast', ['sensors', 'drift', plant.file, '--group', 'temperature']);
    assert.equal(code, 1, err);
    const [, { sensors }] = await ask('group=temperature');
    assert.deepEqual(out.trim().split('\n').slice(1).map((line) => line.split(',').slice(0, 2)), sensors.map((s) => [s.tag, s.verdict]));
    const before = runProgram('plantcast', ['sensors', 'drift', plant.file, '--group', 'temperature', '--to', '-7d']);
    assert.equal(before.code, 0, before.err);
    const few = 'fewer than 84 hours with readings of the sensor and its neighbours';
    assert.deepEqual(before.out.trim().split('\n').slice(1), [1, 2, 3, 4].map((n) => `TI-${n},unknown,,,,°C,0,${few}`));
    const alone = runProgram('plantcast', ['sensors', 'drift', plant.file, '--group', 'pressure']);
    assert.match(alone.out, /^PI-1,unknown,,,,bar,0,fewer than 3 sensors of the group on the asset$/m);
    assert.equal(runProgram('plantcast', ['sensors', 'drift', plant.file, '--group', 'speed']).code, 2);
    for (const query of ['', 'group=speed', 'tag=TI-9', 'group=temperature&to=never'])
        assert.equal((await ask(query))[0], 400, query);
});

// Returns by how many pixels the card's contents extend beyond the right edge of its inner area; negative if everything fits.
const overhang = (page) => page.evaluate(() => {
    const card = document.querySelector('#card'), padding = parseFloat(getComputedStyle(card).paddingRight);
    const right = card.getBoundingClientRect().right - padding;
    return Math.max(...[...card.querySelectorAll('dd, .drift-curve')].map((part) => part.getBoundingClientRect().right - right));
});

test('the page lists the drifting sensor, and its card shows the week', options, async () => {
    await plant.set({ 'TI-1': 60, 'TI-2': 50, 'TI-3': 63, 'TI-4': 45 });
    const languages = [['en', /\+[78]\.\d °C.*: drifts/, /no drift detected/], ['de', /\+[78],\d °C.*: driftet/, /keine Drift/],
        ['ko', /\+[78]\.\d °C.*드리프트 있음/, /드리프트 없음/]];
    for (const [language, found, none] of languages.slice(0, process.env.PLANTCAST_SHOTS ? 3 : 1)) {
        const { page, errors, close } = await openPage(`${url}?lang=${language}`, { viewport: { width: 1280, height: 800 } });
        await waitForPicture(page);
        await waitForHealth(page, 'live');
        await page.evaluate(() => globalThis.plantcast.selectTag(globalThis.plantcast.session.model.tag('TI-3')));
        await page.locator('#card .drifts .drift-curve').waitFor();
        assert.match(await page.locator('#card .drifts').textContent(), found);
        assert.ok(await overhang(page) <= 1, `${language}: the card of a drifting sensor is ${await overhang(page)} px too wide`);
        await settle(page);
        await shoot(page, `drift-card-${language}`);
        await page.evaluate(() => globalThis.plantcast.selectTag(globalThis.plantcast.session.model.tag('TI-1')));
        await page.waitForFunction(() => document.querySelector('#card .drift-curve') && !document.querySelector('#card .drifts'));
        assert.match(await page.locator('#card').textContent(), none);
        assert.ok(await overhang(page) <= 1, `${language}: the card of another sensor is ${await overhang(page)} px too wide`);
        await page.locator('#picture-toggle').click();
        await page.locator('#drifting:not([hidden]) .line').first().waitFor();
        assert.equal(await page.locator('#drifting .line').count(), 1);
        assert.match(await page.locator('#drifting .line').textContent(), /TI-3/);
        await page.locator('#drifting').scrollIntoViewIfNeeded();
        await shoot(page, `drift-list-${language}`);
        assert.deepEqual(errors, []);
        await close();
    }
});
