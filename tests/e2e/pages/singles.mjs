// SPDX-License-Identifier: GPL-3.0-or-later
// Single sensors: if an asset has only one sensor of a group, its triangles are not refined, and some displays would be wrong
// on them. Every client is refused these with a hint; once the plant file asks for refinement (singles: cut), they are drawn.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, waitForPicture } from '../support/browser.mjs';
import { missing, runProgram, TinyPlant } from '../support/tiny_plant.mjs';

const options = { skip: missing().length > 0 && `not built: ${missing().join(', ')}`, timeout: 240000 };
const PAPER = /“paper” \(Kim & Suh\) cannot be drawn accurately where pressure has one sensor \(1 of 2 assets, the first P-101A\)/;
const DISTANCES = /distances cannot be drawn accurately where pressure has one sensor, as on P-101A/;

test('for a single sensor, paper style and distances are refused until the plant file refines its asset', options, async () => {
    const tiny = await TinyPlant.running(), whole = readFileSync(tiny.file, 'utf8'), url = `http://127.0.0.1:${tiny.port}/`;
    const picture = async (query) => {
        const answer = await fetch(`${url}snapshot.png?width=160&height=100&group=pressure&${query}`);
        return [answer.status, answer.status === 200 ? '' : await answer.text()];
    };
    const reload = async (text) => {
        writeFileSync(tiny.file, text);
        assert.equal(tiny.prepare().code, 0);
        assert.equal((await fetch(`${url}api/v1/reload`, { method: 'POST' })).status, 200);
    };
    const own = await openPage(url, { viewport: { width: 1200, height: 720 } }), { page } = own;
    const shown = (group, interpolation) => page.waitForFunction(([g, i]) => {
        const { confirmed } = globalThis.plantcast.session;
        return confirmed?.group === g && confirmed.interpolation === i;
    }, [group, interpolation]);
    const ask = (params) => page.evaluate((change) => globalThis.plantcast.session.setParams(change), params);
    try {
        await waitForPicture(page);
        const [paper, distances] = [await picture('interpolation=paper'), await picture('show=distance&sensor=PI-1')];
        assert.deepEqual([paper[0], distances[0]], [400, 400]);
        assert.match(paper[1], PAPER);
        assert.match(distances[1], DISTANCES);
        assert.equal((await picture('interpolation=shepard'))[0], 200);
        const args = ['snapshot', tiny.file, '--size', '160x100', '--group', 'pressure', '--out', join(tiny.folder, 'paper.png')];
        const refused = runProgram('plantcast', [...args, '--interpolation', 'paper']);
        assert.deepEqual([refused.code, PAPER.test(refused.err)], [2, true], refused.err);

        // When a change is refused, the page shows why and returns to the view before it.
        await ask({ group: 'pressure' });
        await shown('pressure', 'shepard');
        await ask({ interpolation: 'paper' });
        await page.getByText('“paper” (Kim & Suh) cannot be drawn accurately where pressure has one sensor').waitFor();
        await shown('pressure', 'shepard');
        assert.equal(await page.evaluate(() => globalThis.plantcast.session.params.interpolation), 'shepard');
        await ask({ group: 'temperature', interpolation: 'paper' });
        await shown('temperature', 'paper');

        // With `singles: cut`, which refines the triangles around single sensors, the view is allowed. When this is removed
        // from the plant file again, viewers return to the view that they had before.
        await reload(whole.replace('unit: bar,', 'unit: bar, singles: cut,'));
        assert.equal((await picture('interpolation=paper'))[0], 200);
        assert.equal((await picture('show=distance&sensor=PI-1'))[0], 200);
        assert.equal(runProgram('plantcast', [...args, '--interpolation', 'paper']).code, 0);
        await page.waitForFunction(() => globalThis.plantcast.session.model.group('pressure').singles === 'cut');
        await ask({ group: 'pressure', interpolation: 'paper' });
        await shown('pressure', 'paper');
        await reload(whole);
        await page.waitForFunction(() => globalThis.plantcast.session.model.group('pressure').singles === 'whole');
        await shown('pressure', 'shepard');
        assert.deepEqual(own.errors, []);
    } finally {
        await own.close();
        await tiny.destroy();
    }
});
