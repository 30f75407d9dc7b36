// SPDX-License-Identifier: GPL-3.0-or-later
// The first view of a plant whose file defines no views: the plant fills the picture, and the legends cover no part of the
// plant.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { arrive, PHONE, shoot, TABLET, waitForPicture, withPage } from './support/browser.mjs';
import { startAlarmed } from './support/panels.mjs';
import { sweep } from './support/sweep.mjs';
import { notBuilt, runProgram, TinyPlant } from './support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
const SCREENS = { desk: { viewport: { width: 1280, height: 800 } },
    ...sweep({ 'large desk': { viewport: { width: 1920, height: 1080 } }, tablet: TABLET }, {}),
    'tablet upright': { ...TABLET, viewport: { width: 768, height: 1024 } }, phone: PHONE,
    'phone across': { ...PHONE, viewport: { width: 844, height: 390 } } };
let plant, url;

before(async () => {
    const more = [-3, 0, 3, 6].map((x) => `  - { id: S${x}, model: box.gltf, placement: { translate: [${x}, 9, 0] } }\n`).join('');
    if (!options.skip)
        [plant, url] = await startAlarmed((file) =>
            writeFileSync(file, readFileSync(file, 'utf8').replace('groups:', `${more}groups:`)));
});
after(() => plant?.destroy());

for (const [name, screen] of Object.entries(SCREENS))
    test(`the first view fills the picture, and nothing lies under the legend: ${name}`, options, async (t) => {
        await withPage(`${url}?lang=en`, screen, async (page) => {
            await waitForPicture(page);
            await page.locator('.legend:visible').first().waitFor();
            await arrive(page);
            const seen = await page.evaluate(async () => {
                const { projector } = await import('/core/camera.js');
                const { session, viewport } = globalThis.plantcast;
                const project = projector(session.picture.camera, viewport.width, viewport.height);
                const origin = viewport.element.getBoundingClientRect();
                const corners = session.model.assets.flatMap(({ bounds: { min, max } }) => [0, 1, 2, 3, 4, 5, 6, 7].map((n) =>
                    project([0, 1, 2].map((i) => (n & (1 << i) ? max[i] : min[i])))));
                const legend = document.getElementById('legend').getBoundingClientRect(), lies = legend.width > 0.7 * origin.width;
                return { points: corners, width: viewport.width, height: viewport.height, shown: legend.width > 0,
                    right: lies ? viewport.width : legend.left - origin.left, top: lies ? legend.bottom - origin.top : 0 };
            });
            const range = (list) => [Math.min(...list), Math.max(...list)];
            const [left, right] = range(seen.points.map(([x]) => x)), [top, bottom] = range(seen.points.map(([, y]) => y));
            const freeRight = seen.shown ? seen.right : seen.width, freeTop = seen.shown ? seen.top : 0;
            const across = (right - left) / freeRight, up = (bottom - top) / (seen.height - freeTop);
            const rims = across > up ? [left / freeRight, 1 - right / freeRight]
                : [(top - freeTop) / (seen.height - freeTop), (seen.height - bottom) / (seen.height - freeTop)];
            const part = (x) => `${(100 * x).toFixed(1)} %`;
            t.diagnostic(`fills ${part(Math.max(across, up))}, rims ${rims.map(part).join(' and ')}`);
            await shoot(page, `first-${name.replace(/ /g, '-')}`);
            assert.ok(left >= 0 && top >= freeTop && right <= freeRight && bottom <= seen.height,
                'the plant lies in sight and not under the legend');
            assert.ok(Math.max(across, up) >= 0.7 && rims.every((rim) => rim <= 0.1));
        });
    });

// The plant lies at survey coordinates (far from the origin), except for one box at the origin, as some CAD models contain.
test('a notice names assets far outside the first view, and its button shows everything', options, async (t) => {
    const far = await TinyPlant.create(), at = [260978, 7007098, 12];
    t.after(() => far.destroy());
    const text = readFileSync(far.file, 'utf8').replace('model: box.gltf,', `model: box.gltf, placement: { translate: [${at}] },`)
        .replace('translate: [3, 0, 0]', `translate: [${at[0] + 3}, ${at[1]}, ${at[2]}]`);
    writeFileSync(far.file, text.replace('groups:', '  - { id: STRAY, model: box.gltf }\ngroups:'));
    const tags = join(far.folder, 'tags.csv'), moved = (line, i) => line &&
        line.split(',').map((cell, c) => (i > 0 && c >= 7 && c <= 9 ? Number(cell) + at[c - 7] : cell)).join(',');
    writeFileSync(tags, readFileSync(tags, 'utf8').split('\n').map(moved).join('\n'));
    assert.equal(far.prepare().code, 0);
    assert.match(runProgram('plantcastd', ['--check', far.file]).err, /leaves out a part of asset STRAY at /);
    await far.startSim();
    await far.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
    await far.startDaemon();
    for (const [language, screen, title, all] of [
        ['en', SCREENS.desk, 'Outside the first view, up to 7012 km away: STRAY', 'Show everything'],
        ['de', SCREENS.desk, 'Außerhalb der ersten Ansicht, bis 7012 km entfernt: STRAY', 'Alles zeigen'],
        ['ko', PHONE, '첫 화면 밖, 최대 7012 km 거리: STRAY', '전체 보기']]) {
        await withPage(`http://127.0.0.1:${far.port}/?lang=${language}`, screen, async (page) => {
            await waitForPicture(page);
            const notice = page.locator('.chip.outside');
            await notice.waitFor();
            assert.equal(await notice.locator('span').textContent(), title);
            await arrive(page);
            await shoot(page, `outside-${language}`);
            await notice.getByRole('button', { name: all }).click();
            await page.waitForFunction(() => {
                const { session: { camera }, cameraController } = globalThis.plantcast;
                return cameraController && !cameraController.fly && Math.hypot(...camera.eye.map((m, i) => m - camera.target[i])) > 1e6;
            });
            await arrive(page);
            await shoot(page, `outside-all-${language}`);
            await notice.locator('button').last().click();
            await notice.waitFor({ state: 'hidden' });
        });
    }
});
