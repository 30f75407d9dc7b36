// SPDX-License-Identifier: GPL-3.0-or-later
// The page accepts, in one step, the assumed positions of hundreds of tags, filtered by equipment, name, distance and
// confidence. Restoring the old tag list afterwards gives the same bytes as before.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { DESKTOP, openPage, settle, shoot, waitForPicture } from '../support/browser.mjs';
import { linesOf } from '../support/lines.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { BIN, missing, runProgram, TinyPlant } from '../support/tiny_plant.mjs';
import { until } from '../support/until.mjs';

const absent = missing();
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : !existsSync('/usr/bin/chromium') ? 'no chromium' : false;
const options = { skip, timeout: 200000 };
const ASSUMED = sweep(500, 250), OFF_M = 0.4;
const name = (i) => `TA-${String(i).padStart(3, '0')}`;
// Of the tags, every fifth lies 0.4 m off the surface of its equipment, every tenth belongs to P-101A, and the last twenty
// have no position.
const isOff = (i) => i % 5 === 0, isNowhere = (i) => i >= ASSUMED - 20, isSure = (i) => i < ASSUMED / 2;
const assetOf = (i) => (i % 10 === 1 ? 'P-101A' : 'E-101');
const confidence = (i) => (isSure(i) ? 0.95 : 0.6);
const count = (of) => Array.from({ length: ASSUMED }, (_, i) => i).filter(of).length;
let plant, browser, page, tagsFile, original;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    tagsFile = join(plant.folder, 'tags.csv');
    const head = readFileSync(tagsFile, 'utf8').replace('Stale s\n', 'Stale s,Place\n');
    const middle = { 'E-101': 0, 'P-101A': 3 }; // x coordinate in metres of the middle of each equipment's box; the boxes are 1 m wide
    writeFileSync(tagsFile, head + Array.from({ length: ASSUMED }, (_, i) => {
        const x = middle[assetOf(i)] - 0.45 + 0.9 * ((i * 37 % 100) / 100), z = -0.45 + 0.9 * ((i * 61 % 100) / 100);
        const place = isNowhere(i) ? ',,' : `${x.toFixed(3)},${isOff(i) ? -0.5 - OFF_M : -0.5},${z.toFixed(3)}`;
        return `${name(i)},${400201 + 2 * i},Float,°C,assumed,temperature,${assetOf(i)},${place},600,equipment\r\n`;
    }).join(''));
    writeFileSync(join(plant.folder, 'matches.csv'), `Tag,Status,Asset,Place,Confidence\n${Array.from({ length: ASSUMED }, (_, i) =>
        `${name(i)},sure,${assetOf(i)},middle,${confidence(i)}\n`).join('')}`);
    original = readFileSync(tagsFile, 'utf8');
    const prepared = plant.prepare();
    assert.equal(prepared.code, 0, prepared.err);
    await plant.startSim();
    // fixed values: each change of a value would draw a new picture
    await plant.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5, ...Object.fromEntries(Array.from({ length: ASSUMED }, (_, i) => [name(i), 50])) });
    await plant.startDaemon('--audit', join(plant.folder, 'audit.log'));
    browser = own(await openPage(`http://127.0.0.1:${plant.port}/?lang=en`, DESKTOP));
    page = browser.page;
    await waitForPicture(page);
    await page.locator('#engineer-toggle').click();
    await page.locator('#engineer .accept summary').click();
});

const says = (selector, text) => page.waitForFunction(([where, what]) =>
    document.querySelector(where)?.textContent.includes(what), [selector, text], { timeout: 120000 });
const rows = () => readFileSync(tagsFile, 'utf8').split('\n').filter((row) => row.startsWith('TA-'));
const assumed = () => rows().filter((row) => /equipment\r?$/.test(row)).length;

test('legend and card say that the location of a tag is assumed', options, async () => {
    await page.locator('.legend').getByText('Location assumed').waitFor();
    const select = (tag) => page.evaluate((one) => globalThis.plantcast.selectTag(one && globalThis.plantcast.session.model.tag(one)), tag);
    await select(name(1));
    await page.locator('#card').getByText('Location assumed').waitFor();
    await select(null);
});

test('the filter shows how many locations would be accepted and why others are not, and marks them on the model', options, async () => {
    const all = count((i) => !isNowhere(i));
    await says('#engineer .accept p', `${all} locations would be accepted`);
    await says('#engineer .accept ul', '20 left out: no node and no position');
    await page.getByLabel('Maximum distance from surface').fill('0.1');
    await says('#engineer .accept p', `${count((i) => !isNowhere(i) && !isOff(i))} locations would be accepted`);
    await says('#engineer .accept ul', `${count((i) => !isNowhere(i) && isOff(i))} left out: farther from the surface`);
    await page.getByLabel('Minimum confidence').fill('0.9');
    const sure = count((i) => isSure(i) && !isOff(i));
    await says('#engineer .accept p', `${sure} locations would be accepted`);
    await page.locator('#engineer .accept select').selectOption('E-101');
    await page.getByPlaceholder('Name or description').fill('ta-1*');
    const some = count((i) => i >= 100 && i < 200 && isSure(i) && !isOff(i) && assetOf(i) === 'E-101');
    await says('#engineer .accept p', `${some} locations would be accepted`);
    assert.equal(await page.evaluate(() => globalThis.plantcast.modules.there('engineer').parts.place.accepting.names.size), some);
    await settle(page);
    await shoot(page, 'accepting');
    await page.getByLabel('Minimum confidence').fill('7');
    await page.getByRole('button', { name: /^Accept/, disabled: true }).waitFor();
    await page.getByLabel('Minimum confidence').fill('0.9');
    assert.equal(assumed(), ASSUMED, 'nothing is written before the confirmation');
});

test('accepting many locations writes one list and one audit line, and leaves the other rows unchanged', options, async () => {
    await page.locator('#engineer .accept select').selectOption('');
    await page.getByPlaceholder('Name or description').fill('');
    const sure = count((i) => isSure(i) && !isOff(i));
    await says('#engineer .accept p', `${sure} locations would be accepted`);
    await page.getByRole('button', { name: `Accept ${sure}`, exact: true }).click();
    await says('#engineer .accept .accepted', `${sure} locations accepted. The previous list is kept as tags.csv.1.`);
    assert.equal(assumed(), ASSUMED - sure);
    const before = original.split('\n'), now = readFileSync(tagsFile, 'utf8').split('\n');
    before.forEach((row, n) => assert.equal(now[n],
        row.startsWith('TA-') && !/equipment/.test(now[n]) ? row.replace('equipment', '') : row));
    assert.ok(!existsSync(`${tagsFile}.2`), 'the list is written once');
    const trail = () => linesOf(join(plant.folder, 'audit.log')).filter((line) => /assumed sensor place/.test(line));
    await until('it in the trail', () => trail().length > 0);
    const lines = trail();
    assert.equal(lines.length, 1, lines.join('\n'));
    assert.match(lines[0], new RegExp(`${sure} assumed sensor places accepted \\(within 0.1 m of the surface, confidence at least 0.9\\)`));
    await page.waitForFunction((n) => globalThis.plantcast.session.model.tags.filter(({ place }) => place === 'equipment').length === n,
        ASSUMED - sure);
    await settle(page);
    await shoot(page, 'accepting-accepted');
});

test('undo restores the old list byte for byte, also after a reload of the page', options, async () => {
    await page.reload();
    await waitForPicture(page);
    await page.locator('#engineer-toggle').click();
    await page.locator('#engineer .accept summary').click();
    await page.getByRole('button', { name: 'Undo: back to tags.csv.1 …' }).click();
    await page.locator('dialog.diff[open]').waitFor();
    await shoot(page, 'accepting-undo');
    await page.getByRole('button', { name: 'Save and apply' }).click();
    await says('#engineer .accept .accepted', 'Undone. tags.csv.1 applies again.');
    assert.equal(await page.locator('dialog.diff[open]').count(), 0, 'the answer to the confirmation does not open the dialog again');
    assert.equal(readFileSync(tagsFile, 'utf8'), original);
    assert.notEqual(readFileSync(`${tagsFile}.2`, 'utf8'), original, 'the undone list is kept, too');
    assert.deepEqual(browser.errors, []);
});

test('on the command line, accepting gives the same locations, and offers a dry run and undo', options, () => {
    const sure = count((i) => isSure(i) && !isOff(i));
    const accept = (...args) => runProgram('plantcast', ['sensors', 'accept', plant.file, ...args]);
    const trial = accept('--within', '0.1', '--confidence', '0.9', '--dry-run');
    assert.equal(trial.code, 0, trial.err);
    assert.match(trial.out, new RegExp(`^${sure} accepted\n20 sensors without a position`, 'm'));
    assert.equal(trial.out.match(/^TA-/gm).length, sure);
    assert.equal(readFileSync(tagsFile, 'utf8'), original);
    const done = accept('--within', '0.1', '--confidence', '0.9');
    assert.match(done.out, /written; the previous tag list is kept as tags\.csv\.3/, done.err);
    assert.equal(assumed(), ASSUMED - sure);
    assert.equal(accept('--undo', 'tags.csv.3').code, 0);
    assert.equal(readFileSync(tagsFile, 'utf8'), original);
    assert.match(accept('--asset', 'E-101', '--tags', 'ta-1*', '--dry-run').out, /^\d+ accepted/m);
    for (const [wrong, why, code] of [[['--asset', 'E-9'], /no asset 'E-9'/, 2], [['--within', 'far'], /--within: expected 0 to 1e\+06/, 2],
        [['--undo', 'tags.csv.9'], /tags\.csv/, 1]]) {
        const refused = accept(...wrong);
        assert.equal(refused.code, code);
        assert.match(refused.err, why);
    }
    assert.equal(accept('--tags', 'nothing*').code, 1);
});

test('--undo takes only list versions that differ in Place alone, and does nothing while another program is at work', options, () => {
    const accept = (...args) => runProgram('plantcast', ['sensors', 'accept', plant.file, ...args]);
    assert.equal(accept('--asset', 'E-101').code, 0);
    const now = readFileSync(tagsFile, 'utf8'), last = readdirSync(plant.folder).filter((name) => /^tags\.csv\.\d+$/.test(name)).length;
    const other = mkdtempSync(join(tmpdir(), 'plantcast-undo-'));
    const write = (name, text) => writeFileSync(join(plant.folder, name), text);
    try {
        write('tags.csv.90', original.replace(/^(TA-001,.*),600,equipment/m, '$1,601,equipment'));
        write('tags.csv.91', original.split('\n').filter((line, i) => i !== 1).join('\n'));
        write('tags.csv.92', now);
        write('tags.csv.93', 'anything at all\n');
        write('other.csv.1', original);
        writeFileSync(join(other, 'tags.csv.1'), original);
        for (const [version, why] of [['tags.csv.90', /line \d+ of this earlier tag list differs in more than the column `Place`/],
            ['tags.csv.91', /has other tags than the present tag list/],
            ['tags.csv.92', /equals the present tag list/], ['tags.csv.93', /has other tags than the present tag list/],
            ['other.csv.1', /not an earlier version of/], ['tags.csv', /not an earlier version of/],
            [plant.file, /not an earlier version of/],
            [join(other, 'tags.csv.1'), /not an earlier version of/]]) {
            const refused = accept('--undo', version);
            assert.equal(refused.code, 1, version);
            assert.match(refused.err, why, version);
            assert.equal(refused.err.trim().split('\n').length, 1);
            assert.equal(readFileSync(tagsFile, 'utf8'), now);
        }
        const locked = spawnSync('flock', [plant.folder, join(BIN, 'plantcast'), 'sensors', 'accept', plant.file, '--undo',
            `tags.csv.${last}`], { encoding: 'utf8' });
        assert.equal(locked.status, 1);
        assert.match(locked.stderr, /flock \(process \d+\) is using the plant's folder: try again later/);
        assert.equal(accept('--undo', join(plant.folder, `tags.csv.${last}`)).code, 0);
        assert.equal(readFileSync(tagsFile, 'utf8'), original);
    } finally {
        rmSync(other, { recursive: true });
    }
});
