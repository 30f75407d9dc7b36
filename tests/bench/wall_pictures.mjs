// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of three walls of the demo plant, as a control room would have them: overview and alarms on one large screen, six panes, and one
// picture over six displays. `node tests/bench/wall_pictures.mjs` writes them below build/screenshots.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { openPage, SCREENSHOTS } from '../e2e/support/browser.mjs';
import { startPlant } from '../e2e/support/plant.mjs';

const WALLS = `
views:
- { id: whole, title: Whole unit, view: "group=temperature" }
- { id: pressure, title: Pressures, view: "group=pressure" }
- { id: above, title: From above, view: "group=temperature&camera=8,2,60,8,6,0,0,1,0,45" }
walls:
- id: overview
  inches: 85
  distance_m: 4
  displays:
  - grid: [main main main alarms, main main main alarms, main main main tiles, main main main clock]
    panes:
    - { area: main, views: [whole], on_alarm: yes }
    - { area: alarms, alarms: yes }
    - { area: tiles, title: Feed, tiles: [TE-171, TE-172, PT-101, PT-102] }
    - { area: clock, clock: yes }
- id: six
  inches: 55
  distance_m: 3
  displays:
  - grid: [a b c, d e f]
    panes:
    - { area: a, views: [whole] }
    - { area: b, views: [pressure] }
    - { area: c, alarms: yes }
    - { area: d, trend: [TE-171, TE-172], hours: 1 }
    - { area: e, title: Feed, tiles: [TE-171, TE-172, PT-101, PT-102] }
    - { area: f, title: To do, text: [Check P-101A, Clean F-101] }
- { id: tiled, inches: 46, tile: { columns: 3, rows: 2, bezel_mm: 12, views: whole, title: Stabiliser unit } }
`;
const SETTLED_MS = Number(process.env.SETTLED_MS) || 15000;
const plant = await startPlant(`alarms: local\n${WALLS}`);
const [only] = process.argv.slice(2), open = [];
const shown = () => {
    const pages = [...document.querySelectorAll('.pane.views iframe')].map(({ contentWindow }) => contentWindow.plantcast);
    const panes = globalThis.wall?.panes ?? [];
    return panes.length > 0 && pages.every((page) => page?.session.picture) && panes.every(({ session }) => !session || session.picture);
};

async function take(name, address, viewport) {
    const { page, errors, close } = await openPage(`${plant.url}?${address}`, { viewport });
    open.push(close);
    await page.waitForFunction(shown, null, { timeout: 180000, polling: 200 });
    return { page, errors, save: async () => {
        writeFileSync(join(SCREENSHOTS, `${name}.jpg`), await page.screenshot({ type: 'jpeg', quality: 90, timeout: 120000 }));
        console.log(`${join(SCREENSHOTS, `${name}.jpg`)} ${errors.join('; ')}`);
    } };
}

await plant.ask('set PT-101 14');
await plant.ask('set TE-171 500');
for (const [name, address, viewport] of [['wall-overview', 'wall=overview', { width: 3840, height: 2160 }],
    ['wall-six', 'wall=six', { width: 1920, height: 1080 }]]) {
    if (only && only !== name)
        continue;
    const { page, save } = await take(name, address, viewport);
    await page.waitForTimeout(SETTLED_MS);
    await save();
    await open.pop()();
}
if (!only || only === 'wall-tile') {
    const tiles = await Promise.all([1, 2, 3, 4, 5, 6].map((display) =>
        take(`wall-tile-${display}`, `wall=tiled&display=${display}`, { width: 1920, height: 1080 })));
    await tiles[0].page.waitForTimeout(SETTLED_MS);
    for (const { save } of tiles)
        await save();
    for (const close of open)
        await close();
}
await plant.stop();
process.exit(0);
