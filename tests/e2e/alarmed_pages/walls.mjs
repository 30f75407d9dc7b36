// SPDX-License-Identifier: GPL-3.0-or-later
// The wall page (pictures on a control room's screens) at several screen sizes and viewing distances: legends, clock and data
// age are shown completely and do not cover the picture.
import { readFileSync, writeFileSync } from 'node:fs';
import { after, test } from 'node:test';
import { shoot, waitForPicture, withPage } from '../support/browser.mjs';
import { startAlarmed } from '../support/panels.mjs';
import { setUp } from '../support/set_up.mjs';
import { sweep } from '../support/sweep.mjs';
import { notBuilt } from '../support/tiny_plant.mjs';
import { becomes } from '../support/until.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
const HD = { width: 1920, height: 1080 }, UHD = { width: 3840, height: 2160 }, UPRIGHT = { width: 1080, height: 1920 };
const WALLS = [
    ['55,4', HD], ['85,8', HD, 'de'], ['10,50', UPRIGHT],
    ...sweep([['400,0.5', UHD], ['85,8', HD], ['10,0.5', HD], ['10,50', HD], ['400,50', HD]], []),
];
let plant, url;

setUp(options.skip, async () => {
    [plant, url] = await startAlarmed((file) => // simulated data shows an additional notice
        writeFileSync(file, readFileSync(file, 'utf8').replace('type: modbus,', 'type: modbus, simulated: yes,')));
});
after(() => plant?.destroy());

// Returns the page's elements that are cut off or that cover the picture; there should be none.
const amiss = (page) => page.evaluate(() => {
    const box = (element) => element.getBoundingClientRect(), picture = box(document.getElementById('viewport')), found = [];
    const all = (selector) => [...document.querySelectorAll(selector)].filter((e) => e.checkVisibility() && box(e).width > 0);
    const within = (a, b) => a.left >= b.left - 1 && a.right <= b.right + 1 && a.top >= b.top - 1 && a.bottom <= b.bottom + 1;
    const meet = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    const screen = { left: 0, top: 0, right: innerWidth, bottom: innerHeight };
    const legends = all('.legend'), texts = legends.map((legend) => [legend,
        [...legend.querySelectorAll('h2, .ticks span, .limits span, .keys span, .keys canvas, .bar, .end canvas, .note')]
            .filter((e) => box(e).width > 0)]);
    for (const part of [...legends, ...all('.clock, .age, .simulated-note, .health')]) {
        if (!within(box(part), screen))
            found.push(`${part.id || part.className} leaves the screen`);
        if (meet(box(part), picture))
            found.push(`${part.id || part.className} lies over the picture`);
    }
    for (const [legend, parts] of texts) {
        for (const [i, part] of parts.entries()) {
            if (!within(box(part), box(legend)))
                found.push(`${part.textContent || part.className} leaves the legend`);
            if (parts.slice(i + 1).some((other) => meet(box(part), box(other))))
                found.push(`${part.textContent || part.className} is written over another`);
        }
        if (!/No data|Keine Daten/.test(legend.querySelector('.keys').textContent))
            found.push('no key for what has no data');
    }
    const said = ['.clock', '.age', '.simulated-note'].filter((selector) => all(selector).length === 0);
    if (picture.height < 0.3 * innerHeight - 1 || picture.width < 0.5 * innerWidth)
        found.push(`a picture of ${Math.round(picture.width)}x${Math.round(picture.height)}`);
    return [...found, ...said.map((name) => `no ${name}`), ...legends.length === 0 ? ['no legend'] : []];
});

test('on walls, legends, clock, data age and the mark of simulated values are complete and beside the picture', options, async () => {
    for (const [wall, viewport, language = 'en'] of WALLS) {
        await withPage(`${url}?lang=${language}&wall=${wall}`, { viewport, screen: viewport }, async (page) => {
            await waitForPicture(page);
            await page.locator('.legend:visible').first().waitFor();
            await page.locator('#simulated').waitFor();
            for (const split of [null, { show: 'operator' }]) {
                await page.evaluate((half) => globalThis.plantcast.session.setParams({ split: half }), split);
                await page.waitForFunction((count) => document.querySelectorAll('.legend:not([hidden])').length === count &&
                    document.getElementById('viewport').classList.contains('split') === (count > 1), split ? 2 : 1);
                await becomes(() => amiss(page), [], `?wall=${wall} at ${viewport.width}x${viewport.height}${split ? ', split' : ''}`);
                await shoot(page, `wall-${wall.replace(/\W/g, '-')}-${viewport.width}-${language}${split ? '-split' : ''}`);
            }
        });
    }
});
