// SPDX-License-Identifier: GPL-3.0-or-later
// Assets that the plant file defines as hidden or ghosted (translucent) at the start: which views start that way, how the user
// shows these assets again, and what a link and a plant reload change.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, settle, shoot, waitForPicture } from '../support/browser.mjs';
import { missing, runProgram, TinyPlant } from '../support/tiny_plant.mjs';

const options = { skip: missing().length > 0 && `not built: ${missing().join(', ')}`, timeout: 120000 };
const NONE = { hidden: [], isolate: [], ghost: [] };

test('a plant changed since its preparation is prepared when the daemon starts', options, async (t) => {
    const tiny = await TinyPlant.create();
    t.after(() => tiny.destroy());
    assert.equal(tiny.prepare().code, 0);
    const text = readFileSync(tiny.file, 'utf8');
    writeFileSync(tiny.file, text.replace('groups:', '  - { id: NEW, model: box.gltf, placement: { translate: [9, 0, 0] } }\ngroups:'));
    await tiny.startSim();
    await tiny.startDaemon();
    assert.match(tiny.daemon.said, /prepared files are missing or outdated: running plantcast-prep/);
    const { assets } = await (await fetch(`http://127.0.0.1:${tiny.port}/api/v1/plant`)).json();
    assert.ok(assets.some(({ id }) => id === 'NEW'));
    // The model is no valid glTF, so plantcast-prep could not prepare the plant: the daemon must print one line and not start.
    await tiny.daemon.stop();
    writeFileSync(join(tiny.folder, 'box.gltf'), '{');
    const { code, err } = runProgram('plantcastd', [tiny.file, '--port', '0']);
    assert.equal(code, 1);
    assert.match(err, /plantcast-prep could not prepare the plant: /);
});

test('a plant can start with hidden and ghosted assets; a user who shows all keeps them shown', options, async () => {
    const tiny = await TinyPlant.create(), text = readFileSync(tiny.file, 'utf8');
    const write = (id, how) => writeFileSync(tiny.file, text.replace('{ id: P-101A,', '{ id: P-101A, start: ghost,')
        .replace('groups:', `  - { id: ${id}, model: box.gltf, start: ${how}, placement: { scale: 9 } }\ngroups:`));
    write('HOUSE', 'hidden');
    await tiny.start();
    await tiny.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
    const url = `http://127.0.0.1:${tiny.port}/`, own = await openPage(url, { viewport: { width: 1200, height: 720 } }), { page } = own;
    const sets = async () => page.evaluate(() => {
        const { hidden, isolate, ghost } = globalThis.plantcast.session.confirmed;
        return { hidden, isolate, ghost };
    });
    const sign = () => page.waitForFunction(() => document.getElementById('shown')?.textContent);
    try {
        await waitForPicture(page);
        await sign();
        await settle(page);
        assert.deepEqual(await sets(), { hidden: ['HOUSE'], isolate: [], ghost: ['P-101A'] });
        assert.equal(await page.locator('#shown span').textContent(), '1 of 3 hidden, 1 transparent');
        const { outline } = await page.evaluate(() => globalThis.plantcast.session.model.plant);
        assert.ok(outline.every((place) => Math.abs(place[1]) < 0.6), 'assets that start hidden are not in the first view');
        await shoot(page, 'start');

        // A snapshot without parameters hides and ghosts the same assets as the page's start; its size in bytes tells.
        const picture = async (more = '') => {
            const answer = await fetch(`${url}snapshot.png?width=320&height=200&camera=6,-9,5,1.5,0,0${more}`);
            return (await answer.arrayBuffer()).byteLength;
        };
        const [begun, said, all] = [await picture(), await picture('&hidden=HOUSE&ghost=P-101A'), await picture('&hidden=&ghost=')];
        assert.ok(Math.abs(begun - said) < 0.1 * said && Math.abs(all - said) > 0.1 * said,
            `pictures of ${begun}, ${said} and ${all} bytes`);
        const files = [[], ['--hide', 'HOUSE', '--ghost', 'P-101A'], ['--hide', '', '--ghost', '']].map((more, i) => {
            const out = join(tiny.folder, `${i}.png`);
            const args = ['snapshot', tiny.file, '--size', '320x200', '--no-overlay', '--out', out, ...more];
            const { code, err } = runProgram('plantcast', args);
            assert.equal(code, 0, err);
            return readFileSync(out);
        });
        assert.ok(files[0].equals(files[1]) && !files[0].equals(files[2]));

        // The user shows all assets with one button; the page's link then contains empty lists, so that a reload shows all
        // assets again.
        await page.locator('#shown button').click();
        await page.waitForFunction(() => globalThis.plantcast.session.confirmed.hidden.length === 0);
        assert.deepEqual(await sets(), NONE);
        await page.locator('#shown').waitFor({ state: 'hidden' });
        await page.waitForFunction(() => /hide=&ghost=(&|$)/.test(location.hash));
        await page.reload();
        await waitForPicture(page);
        await page.waitForFunction(() => globalThis.plantcast.session.confirmed);
        assert.deepEqual(await sets(), NONE, 'the link shows all assets');

        // The plant file now ghosts ROOF at the start: after a plant reload, this applies to new sessions only.
        await page.evaluate(() => globalThis.plantcast.session.setParams({ hidden: ['E-101', 'HOUSE'] }));
        await page.waitForFunction(() => globalThis.plantcast.session.confirmed.hidden.length === 2);
        write('ROOF', 'ghost');
        assert.equal(tiny.prepare().code, 0);
        const before = await page.evaluate(() => globalThis.plantcast.session.model.plant.configuration);
        const { changes } = await (await fetch(`${url}api/v1/reload`, { method: 'POST' })).json();
        assert.deepEqual(changes, ['asset HOUSE removed', 'asset ROOF added']);
        await page.waitForFunction((was) => globalThis.plantcast.session.model.plant.configuration !== was, before);
        assert.deepEqual(await sets(), { ...NONE, hidden: ['E-101'], ghost: ['ROOF'] },
            'a connected user keeps the own choice, and new assets start as configured');
        const ghosts = () => page.evaluate(() => globalThis.plantcast.session.confirmed.ghost);
        write('ROOF', 'hidden');
        assert.equal(tiny.prepare().code, 0);
        assert.equal((await fetch(`${url}api/v1/reload`, { method: 'POST' })).status, 200);
        await page.waitForFunction(() => globalThis.plantcast.session.confirmed.hidden.includes('ROOF'));
        assert.deepEqual(await ghosts(), [], 'no asset is a ghost without a request');
        await page.goto(`${url}?again`);
        await waitForPicture(page);
        await sign();
        assert.deepEqual(await sets(), { hidden: ['ROOF'], isolate: [], ghost: ['P-101A'] });
        assert.equal(await page.locator('#shown span').textContent(), '1 of 3 hidden, 1 transparent');
        assert.deepEqual(own.errors, []);
    } finally {
        await own.close();
        await tiny.destroy();
    }
});
