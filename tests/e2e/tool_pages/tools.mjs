// SPDX-License-Identifier: GPL-3.0-or-later
// The tools of the page's toolbar: holding the present values, measuring a distance, saving a picture, links with a QR code,
// following and leading other sessions, and the dark and light themes.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { afterEach, test } from 'node:test';
import jsqr from 'jsqr';
import { boxes } from './boxes.mjs';
import {
    drawnAt, grab, openPage, PHONE, readPng, SCREENSHOTS, settle, shoot, SHOOTS, TABLET, view, waitForHealth, waitForPicture,
} from '../support/browser.mjs';
import { contrast, deltaE } from '../support/pixels.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt } from '../support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 200000 };
const SCREEN = { viewport: { width: 1280, height: 800 } };
let plant, url, browser, page;

setUp(options.skip, async (own) => {
    plant = await boxes();
    url = `http://127.0.0.1:${plant.port}/`;
    browser = own(await openPage(url, SCREEN));
    page = browser.page;
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    await page.waitForFunction(() => globalThis.plantcast.session.time.fromUs !== undefined && globalThis.plantcast.session.recorded);
    await settle(page);
});

// Closes dialogs that a failed test left open.
afterEach(() => page?.evaluate(() => document.querySelectorAll('dialog[open]').forEach((dialog) => dialog.close())));

// Returns the position on the page, in CSS pixels, of a point of the plant.
const placeOf = (point) => drawnAt(page, point);

test('a button freezes the values, and lets them go on', options, async () => {
    await page.waitForFunction(() => globalThis.plantcast.session.model.readings[0].value === 80);
    const since = await page.evaluate(() => globalThis.plantcast.session.clockUs());
    // waits until TI-1 has been 80 for 5 s, so that the last seconds, one of which the held picture shows, have this value
    await page.waitForFunction((us) => globalThis.plantcast.session.clockUs() > us + 5e6, since);
    await page.locator('#hold').click();
    await waitForHealth(page, 'past');
    await page.waitForFunction(() => globalThis.plantcast.session.picture.past);
    const then = await page.evaluate(() => globalThis.plantcast.session.picture.dataTimeUs);
    assert.match(await page.locator('#banner').textContent(), /History.*\d\d:\d\d:\d\d/);
    assert.equal(await page.locator('#hold').getAttribute('aria-label'), 'Resume live values');
    await plant.tell('set TI-1 30');
    await page.waitForFunction((us) => globalThis.plantcast.session.clockUs() > us + 6e6, then);
    assert.equal(await page.evaluate(() => globalThis.plantcast.session.picture.dataTimeUs), then, 'the picture is frozen');
    assert.equal(await page.evaluate(() => globalThis.plantcast.session.model.readings[0].value), 80);
    await page.locator('#viewport').focus();
    await page.keyboard.press(' ');
    await waitForHealth(page, 'live');
    await page.waitForFunction(() => globalThis.plantcast.session.model.readings[0].value === 30);
    await plant.tell('set TI-1 80');
});

test('the distance between two points is measured', options, async () => {
    await page.keyboard.press('r');
    const ends = [[0, -0.5, 0.2], [0, -0.5, -0.2]];
    await page.evaluate(() => globalThis.plantcast.session.setCamera({ eye: [0.8, -4, 1], target: [0, 0, 0], up: [0, 0, 1], fov: 30 }));
    await page.evaluate(() => globalThis.plantcast.viewport.invalidate());
    await settle(page);
    assert.match(await page.locator('.measuring').textContent(), /first point/);
    for (const [i, end] of ends.entries()) {
        const { x, y } = await placeOf(end);
        await page.mouse.click(x, y);
        await page.waitForFunction((words) => document.querySelector('.measuring').textContent.includes(words),
            ['second point', 'measure again'][i]);
    }
    await page.locator('#measured').waitFor();
    const said = await page.locator('#measured').textContent();
    const [, metres] = said.match(/^(0\.\d{3}) m horizontal 0\.0\d\d m, vertical −0\.\d{3} m$/);
    assert.ok(Math.abs(metres - 0.4) < 0.012, `the distance is ${metres} m`);
    await shoot(page, 'measure');
    const before = await page.locator('#measured').boundingBox();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('-');
    await settle(page);
    assert.notDeepEqual(await page.locator('#measured').boundingBox(), before, 'the measurement moves with the picture');
    await page.keyboard.press('Escape');
    assert.equal(await page.locator('#measured').isVisible(), false);
    assert.equal(await page.locator('#card').isVisible(), false, 'a measuring click selects nothing');
});

test('an arrow key turns a plan with north at the top about the plant\'s vertical', options, async () => {
    const plan = { eye: [0.3, 0, 9], target: [0.3, 0, 0], up: [0, 1, 0], fov: 30 }, { camera: before } = await view(page);
    const show = (one) => page.evaluate((camera) => globalThis.plantcast.session.setCamera(camera), one);
    await show(plan);
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction(() => globalThis.plantcast.session.camera.up[1] < 1);
    const { eye, target, up } = await page.evaluate(() => globalThis.plantcast.session.camera);
    assert.ok([...eye, ...target].every((m, i) => Math.abs(m - [...plan.eye, ...plan.target][i]) < 1e-6), `the eye moved to ${eye}`);
    assert.ok(Math.abs(up[2]) < 1e-6 && up[1] > 0, `${up} is horizontal`);
    await show(before);
    await settle(page);
});

test('on a tablet in portrait, the tools behind More work by taps', options, async (t) => {
    const tablet = await openPage(url, { ...TABLET, viewport: { width: 768, height: 1024 } }), on = tablet.page;
    t.after(() => tablet.close());
    const tool = async (id) => {
        await on.locator('#more-toggle').tap();
        await on.locator(`#more #${id}`).tap();
    };
    await waitForPicture(on);
    await on.evaluate(() => {
        globalThis.plantcast.session.setCamera({ eye: [0.8, -4, 1], target: [0, 0, 0], up: [0, 0, 1], fov: 30 });
        globalThis.plantcast.viewport.invalidate();
    });
    await settle(on);
    await tool('measure');
    await on.locator('.measuring').waitFor();
    for (const [i, end] of [[0, -0.5, 0.2], [0, -0.5, -0.2]].entries()) {
        const { x, y } = await drawnAt(on, end);
        await on.touchscreen.tap(x, y);
        await on.waitForFunction((words) => document.querySelector('.measuring').textContent.includes(words),
            ['second point', 'measure again'][i]);
    }
    assert.ok(Math.abs(parseFloat(await on.locator('#measured').textContent()) - 0.4) < 0.02);
    await shoot(on, 'tablet-measure');
    await on.locator('.measuring button').tap();
    await on.locator('.measuring').waitFor({ state: 'hidden' });
    await tool('share-open');
    await on.locator('#share-code svg').waitFor();
    assert.ok((await scan(on)).startsWith(url));
    await shoot(on, 'tablet-share');
    await on.locator('#share .icon').tap();
    const download = on.waitForEvent('download');
    await tool('snapshot');
    assert.match((await download).suggestedFilename(), /\.png$/);
    await tool('theme');
    await on.waitForFunction(() => document.documentElement.dataset.theme === 'dark');
    await tool('help-open');
    await on.locator('#help[open]').waitFor();
    await shoot(on, 'tablet-help');
    assert.deepEqual(tablet.errors, []);
});

test('a pen turns the picture, and the timings panel shows how soon', options, async () => {
    await page.keyboard.press('m');
    await page.locator('#timings').waitFor();
    const kinds = page.evaluate(() => new Promise((done) => {
        document.getElementById('viewport').addEventListener('pointerdown', ({ pointerType }) => done(pointerType), { once: true });
    }));
    const { eye } = (await view(page)).camera, { x, y } = await placeOf([0, 0, 0.5]);
    const client = await page.context().newCDPSession(page);
    const pen = (type, dx) => client.send('Input.dispatchMouseEvent', { type, x: x + dx, y, button: 'left', buttons: 1, clickCount: 1,
        pointerType: 'pen' });
    await pen('mousePressed', 0);
    for (const dx of [20, 50, 90])
        await pen('mouseMoved', dx);
    await pen('mouseReleased', 90);
    assert.equal(await kinds, 'pen');
    await page.waitForFunction((from) => Math.hypot(...globalThis.plantcast.session.camera.eye.map((m, i) => m - from[i])) > 0.3, eye);
    await page.waitForFunction(() => /Input to picture\D*\d/.test(document.getElementById('timings').textContent));
    await settle(page);
    await shoot(page, 'timings');
    await page.keyboard.press('m');
    assert.equal(await page.locator('#timings').isVisible(), false);
});

test('the saved picture equals the picture on the screen', options, async () => {
    await page.evaluate(() => globalThis.plantcast.session.setParams({ colormap: 'cividis', range: [0, 120], ghost: ['P-101A'] }));
    await settle(page, 1000);
    const shown = await grab(page), download = page.waitForEvent('download');
    await page.locator('#snapshot').click();
    const file = await download;
    assert.match(file.suggestedFilename(), /^Two boxes \d{4}-\d\d-\d\dT\d\d-\d\d-\d\dZ\.png$/);
    const kept = await readPng(page, readFileSync(await file.path()));
    assert.ok(contrast(kept) > 5);
    // mean colour difference (CIELAB); it is not 0, because only the saved picture contains markers, legend and clock
    const { mean } = deltaE(shown, kept);
    assert.ok(mean < 4, `mean difference between the saved and the shown picture: ${mean}`);
    await page.evaluate(() => globalThis.plantcast.session.setParams({ show: 'difference', baseline: 'now' }));
    await page.locator('#snapshot').click();
    await page.waitForFunction(() => /under a name/.test(document.getElementById('toast').textContent));
    await page.evaluate(() => globalThis.plantcast.session.setParams({ show: 'value', ghost: [] }));
});

test('a saved picture has the page\'s theme, and the active notes below', options, async (t) => {
    const noteIds = () => page.evaluate(() => globalThis.plantcast.session.notes.map(({ id }) => id));
    const post = (message) => page.evaluate((one) => {
        const { session } = globalThis.plantcast;
        session.post({ seq: ++session.toldSeq, ...one });
    }, message);
    t.after(async () => {
        for (const id of await noteIds())
            await post({ type: 'remove_note', id });
        await page.waitForFunction(() => globalThis.plantcast.session.notes.length === 0);
    });
    const save = async (name) => {
        const download = page.waitForEvent('download');
        await page.locator('#snapshot').click();
        const bytes = readFileSync(await (await download).path());
        if (SHOOTS) {
            mkdirSync(SCREENSHOTS, { recursive: true });
            writeFileSync(join(SCREENSHOTS, `${name}.png`), bytes);
        }
        return readPng(page, bytes);
    };
    const at = ({ width, rgba }, x, y) => [...rgba.slice(4 * (y * width + x), 4 * (y * width + x) + 3)];
    const plain = await save('saved-plain');
    await post({ type: 'note', text: 'Flange weeps, permit 4711 is open', tag: 'TI-1' });
    await post({ type: 'note', text: `Night shift: ${'watch the cooling water and call the engineer. '.repeat(2)}` });
    await page.waitForFunction(() => globalThis.plantcast.session.notes.length === 2);
    const light = await save('saved-notes');
    assert.equal(light.width, plain.width);
    assert.ok(light.height > plain.height + 60, `with notes the picture is ${light.height} px high, without ${plain.height}`);
    assert.ok(Math.min(...at(light, light.width - 3, light.height - 3)) > 230, 'the list of notes is light');
    const turn = async (surface) => {
        await page.keyboard.press('z');
        await page.waitForFunction((is) => getComputedStyle(document.documentElement).getPropertyValue('--surface').trim() === is, surface);
    };
    await turn('#2b3137');
    const dark = await save('saved-notes-dark');
    assert.equal(dark.height, light.height);
    assert.ok(Math.max(...at(dark, dark.width - 3, dark.height - 3)) < 80, 'the list of notes is dark');
    // pixel (12, 12) of the saved picture belongs to the card with the header
    assert.ok(Math.max(...at(dark, 12, 12)) < 110, 'the card is dark');
    await turn('#f4f5f6');
    await post({ type: 'note', text: `https://permits.example/${'valve-4711-'.repeat(30)}end` });
    await page.waitForFunction(() => globalThis.plantcast.session.notes.length === 3);
    const long = await save('saved-notes-long');
    assert.ok(long.height > light.height + 48,
        `a word longer than a line makes the picture ${long.height} px high instead of ${light.height}`);
});

test('the legend warns that values cannot be read from a glossy look', options, async () => {
    const notes = () => page.locator('#legend .note').allTextContents();
    assert.deepEqual(await notes(), []);
    await page.evaluate(() => globalThis.plantcast.session.setParams({ look: 'glossy' }));
    await page.locator('#legend .note').waitFor();
    assert.deepEqual(await notes(), ['Glossy: light alters the colours. Do not read values.']);
    await page.evaluate(() => globalThis.plantcast.session.setParams({ look: 'default' }));
    await page.locator('#legend .note').waitFor({ state: 'detached' });
});

// Takes a screenshot of the QR code and returns the text that it encodes.
async function scan(where) {
    // Photographs #share-code, the element around the code, because the page may replace the code itself with that of a shorter
    // link at any time.
    const { width, height, rgba } = await readPng(where, await where.locator('#share-code').screenshot());
    return jsqr.default ? jsqr.default(rgba, width, height)?.data : jsqr(rgba, width, height)?.data;
}

test('an engineer sets range, factors and one sensor\'s own values, and resets them to the configured ones', options, async () => {
    const params = () => page.evaluate(() => globalThis.plantcast.session.confirmed);
    const waitForParam = (name, value) => page.waitForFunction(([n, v]) =>
        JSON.stringify(globalThis.plantcast.session.confirmed[n]) === v, [name, JSON.stringify(value)]);
    const write = async (id, text) => {
        await page.locator(id).fill(text);
        await page.locator(id).blur();
    };
    await page.evaluate(() => globalThis.plantcast.showTag(globalThis.plantcast.session.model.tag('TI-1')));
    await page.locator('#picture-toggle').click();
    await page.locator('#range-max').press('Control+a');
    await page.keyboard.type('62'); // the digit keys select a quantity, but not while they are typed into a field
    await page.keyboard.press('Tab');
    await waitForParam('range', [0, 62]);
    assert.equal((await params()).group, 'temperature');
    await page.keyboard.press('Escape');
    await page.locator('#engineer-toggle').click();
    await page.locator('#engineer label', { hasText: 'Field settings' }).click();
    await page.locator('#own-factors').waitFor();
    for (const [id, choice] of [['distance', 'Euclidean'], ['interpolation', 'Kim & Suh'], ['fill', 'From neighbours'],
        ['distance', 'Geodesic'], ['interpolation', 'Shepard'], ['fill', 'Hatched']]) {
        await page.locator(`#${id} label`, { hasText: choice }).click();
        await waitForParam(id, await page.locator(`#${id} input:checked`).inputValue());
    }
    await write('#factor-power', '4');
    await waitForParam('power', 4);
    await write('#factor-reach_m', '0.4');
    await page.waitForFunction(() => Math.abs(globalThis.plantcast.session.confirmed.reach_m - 0.4) < 1e-6);
    await write('#own-strength', '5');
    await page.waitForFunction(() => globalThis.plantcast.session.confirmed.sensors['TI-1']?.strength === 5);
    assert.match(await page.locator('#own-reset').textContent(), /1 sensor\b/);
    await settle(page);
    await shoot(page, 'factors');
    await page.locator('#own-reset').click();
    await waitForParam('sensors', {});
    await write('#factor-reach_m', '');
    await waitForParam('reach_m', null);
    await page.locator('#engineer-toggle').click();
    await page.locator('#picture-toggle').click();
    await page.locator('#range-own').click();
    await waitForParam('range', [0, 100]);
    assert.equal((await params()).power, 4);
    await page.keyboard.press('Escape');
});

test('links to the view, the tag and the equipment, each with a QR code that a camera reads', options, async () => {
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: 'E-101', colormap: 'cividis', range: [0, 120] }));
    await page.evaluate(() => globalThis.plantcast.showTag(globalThis.plantcast.session.model.tag('TI-1')));
    await page.locator('#share-open').click();
    await page.locator('#share-code svg').waitFor();
    const links = {}, sent = () => page.evaluate(() => globalThis.plantcast.session.toldSeq), sentBefore = await sent();
    for (const kind of ['This tag', 'This view', 'This equipment']) {
        if (kind === 'This view')
            assert.equal(await sent(), sentBefore, 'a link that the user does not see is not stored');
        await page.locator('#share-kind label', { hasText: kind }).click();
        if (kind === 'This view') // waits until the page shows the short link from the server instead of the long link
            await page.waitForFunction(() => /\/v\/\w{8}$/.test(document.getElementById('share-link').value));
        const link = await page.locator('#share-link').inputValue();
        await page.waitForFunction(() => document.querySelector('#share-code svg path'));
        assert.equal(await scan(page), link, kind);
        const width = Number((await page.locator('#share-code svg').getAttribute('viewBox')).split(' ')[2]);
        assert.ok(width - 2 * 4 <= 33, `the QR code has ${width} modules with margins`);
        links[kind] = link;
    }
    assert.equal(links['This tag'], `${url}#tag=TI-1`);
    assert.equal(links['This equipment'], `${url}#asset=E-101`);
    assert.match(await page.locator('#share-note').textContent(), /this machine only/);
    await shoot(page, 'share');
    assert.match(await page.locator('#share-people').textContent(), /Nobody is following you\./);
    await page.locator('#share .icon').click();
    const asked = await view(page);
    const other = await openPage(links['This view'], SCREEN);
    await waitForPicture(other.page);
    assert.match(other.page.url(), /#group=.*colormap=cividis.*range=0,120.*camera=/);
    const there = await view(other.page);
    there.camera.eye.forEach((m, i) => assert.ok(Math.abs(m - asked.camera.eye[i]) < 1e-3, 'the link has the same camera'));
    for (const name of ['group', 'colormap', 'range', 'selected', 'show'])
        assert.deepEqual(there.params[name], asked.params[name], name);
    await other.page.goto(`${url}v/nosuch`);
    await waitForPicture(other.page);
    await other.page.locator('#toast', { hasText: 'this short link is unknown or no longer stored' }).waitFor();
    await shoot(other.page, 'short-link-unknown');
    await other.close();
    // The test never answers the page's first request for the short link's content. The page must start without it, request it
    // again and then show the linked view.
    let requests = 0;
    const late = await openPage(links['This view'], SCREEN, null, (on) => on.route('**/api/v1/link?*', (route) =>
        requests++ > 0 && route.continue()));
    await late.page.waitForURL(/#group=.*colormap=cividis/);
    await waitForPicture(late.page);
    assert.deepEqual([requests, late.errors], [2, []]);
    await late.close();
});

test('a QR code at the equipment opens that equipment, on a phone', options, async () => {
    const phone = await openPage(`${url}#tag=PI-1`, PHONE);
    await waitForPicture(phone.page);
    await phone.page.waitForFunction(() => globalThis.plantcast.session.params.group === 'pressure');
    await phone.page.locator('#card').waitFor();
    assert.match(await phone.page.locator('#card h3').textContent(), /PI-1/);
    await phone.page.waitForFunction(() => globalThis.plantcast.overlay.markers.some(({ tag, x, occluded }) =>
        tag.name === 'PI-1' && x > 0 && !occluded));
    await settle(phone.page);
    await shoot(phone.page, 'phone-tag');
    assert.deepEqual(phone.errors, []);
    await phone.close();
});

test('parts of a link that this plant lacks are reported in the reader\'s language; the rest applies', options, async () => {
    const opened = async (address, screen, said, f) => {
        const other = await openPage(address, screen), note = other.page.locator('#toast');
        await waitForPicture(other.page);
        await note.waitFor();
        assert.match(await note.textContent(), said);
        await settle(other.page);
        await f(other.page);
        assert.deepEqual(other.errors, []);
        await other.close();
    };
    await opened(`${url}?lang=en#tag=TT-9`, PHONE, /^This link does not fit: this plant has no tag “TT-9”\./, async (phone) => {
        assert.equal(await phone.locator('#card').isVisible(), false);
        await shoot(phone, 'link-astray');
    });
    await opened(`${url}?lang=de#asset=E-9&group=pressure&distance=geodesic`, SCREEN,
        /^Dieser Link passt nicht: diese Anlage hat kein Anlagenteil „E-9“\./, async (other) => {
            const { params } = await view(other);
            assert.deepEqual([params.group, params.distance, params.selected ?? null], ['pressure', 'geodesic', null]);
        });
});

test('a leader may reload the page: the followers stay, and continue', options, async (t) => {
    const leader = await openPage(url, { viewport: { width: 900, height: 600 } });
    t.after(() => leader.close());
    await waitForPicture(leader.page);
    const id = await leader.page.evaluate(() => globalThis.plantcast.session.id), link = `${url}#follow=${id}`;
    const second = await openPage(link, { viewport: { width: 1000, height: 700 } });
    t.after(() => second.close());
    const follows = (gone) => second.page.waitForFunction(([of, is]) => {
        const following = globalThis.plantcast?.session.following;
        return following?.session === of && Boolean(following.gone) === is;
    }, [id, gone]);
    await follows(false);
    await leader.page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'pressure' }));
    await second.page.waitForFunction(() => globalThis.plantcast.session.params.group === 'pressure');
    await leader.page.goto('about:blank');
    await follows(true);
    assert.equal(await second.page.evaluate(() => globalThis.plantcast.session.params.group), 'pressure', 'the shown group stays');
    assert.match(await second.page.locator('#following').textContent(), /has ended: this is its last view/);
    assert.equal(second.page.url(), link);
    await settle(second.page);
    await shoot(second.page, 'following-gone');
    await leader.page.goto(url);
    await waitForPicture(leader.page);
    assert.equal(await leader.page.evaluate(() => globalThis.plantcast.session.id), id, 'the leader has the same session number');
    assert.notEqual(await leader.page.evaluate(() => globalThis.plantcast.session.params.group), 'pressure',
        'the view is that of the opened address');
    await follows(false);
    await second.page.reload();
    await follows(false);
    assert.equal(second.page.url(), link);
    assert.deepEqual([...leader.errors, ...second.errors], []);
});

test('others follow; handing over the lead keeps the shown view', options, async (t) => {
    const id = await page.evaluate(() => globalThis.plantcast.session.id);
    const second = await openPage(`${url}#follow=${id}`, { viewport: { width: 1000, height: 700 } });
    t.after(() => second.close());
    await second.page.waitForFunction((leader) => globalThis.plantcast?.session.following?.session === leader, id);
    await page.waitForFunction(() => document.getElementById('share-open').dataset.count === '1');
    const before = await view(page);
    await page.keyboard.press('k');
    await page.waitForFunction((words) => document.querySelector('#share[open] #share-people')?.textContent.includes(words),
        '1 person is following you');
    await shoot(page, 'share-lead');
    assert.equal(await page.locator('#share-people button').textContent(), 'Hand over to Viewer');
    await page.locator('#share-people button').click();
    const heir = await second.page.evaluate(() => globalThis.plantcast.session.id);
    await page.waitForFunction((leader) => globalThis.plantcast.session.following?.session === leader, heir);
    await second.page.waitForFunction(() => globalThis.plantcast.session.following === null);
    await page.locator('#following', { hasText: 'Following the view of another user' }).waitFor();
    await second.page.evaluate(() => globalThis.plantcast.session.setParams({ group: 'pressure' }));
    await page.waitForFunction(() => globalThis.plantcast.session.params.group === 'pressure');
    // The second session may become the leader before it has received its first picture, so the test waits for that.
    await second.page.waitForFunction(() => {
        const { picture, paramsSeq } = globalThis.plantcast.session;
        return picture?.paramsSeq === paramsSeq;
    });
    const after = await view(second.page), seen = await second.page.evaluate(() => globalThis.plantcast.session.picture.camera.eye);
    for (const eye of [after.camera.eye, seen])
        eye.forEach((m, i) => assert.ok(Math.abs(m - before.camera.eye[i]) < 1e-3, `the shown camera stays: ${eye}`));
    await page.keyboard.press('Escape');
    await shoot(page, 'following');
    await page.locator('#following button').click();
    await page.waitForFunction(() => globalThis.plantcast.session.following === null);
    assert.deepEqual(second.errors, []);
});

test('the theme switches to dark and back to light, and survives a reload', options, async () => {
    await page.evaluate(() => {
        const { session } = globalThis.plantcast, { width, height } = session.size;
        session.setParams({ group: 'temperature' });
        // chooses a camera that shows the whole plant, so that the left edge of the picture, which is tested below, shows
        // background
        session.setCamera(session.homeIn(width, height));
    });
    // Waits for the theme, because the page loads the code for keys and buttons only when it is first needed.
    const waitForTheme = (name) => page.waitForFunction((is) => document.documentElement.dataset.theme === is, name);
    await page.keyboard.press('z');
    await waitForTheme('dark');
    await settle(page);
    await page.waitForFunction(() => { // waits until the picture's left edge, which shows background, is dark as well
        const canvas = document.getElementById('picture');
        return Math.max(...canvas.getContext('2d').getImageData(4, Math.floor(canvas.height / 2), 1, 1).data.slice(0, 3)) < 110;
    });
    const rim = await page.locator('#legend .end.below canvas').evaluate((e) => getComputedStyle(e).outline);
    assert.match(rim, /rgba\(255, 255, 255.*solid/, 'the rim of the colour below the range is visible in the legend');
    await shoot(page, 'dark');
    await page.reload();
    await waitForPicture(page);
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
    await page.locator('#theme').click();
    await waitForTheme('light');
    assert.deepEqual(browser.errors, []);
});
