// SPDX-License-Identifier: GPL-3.0-or-later
// Notes of a shift, and a wall controlled from a desk: a view is sent to a pane, held, pointed at and released, with the user's
// name; also after reloads.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { openPage, settle, shoot, waitForPicture } from './support/browser.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, startTiny } from './support/tiny_plant.mjs';
import { becomes, until } from './support/until.mjs';

const why = notBuilt();
const options = { skip: why, timeout: 300000 };
const ABOVE = 'group=temperature&camera=0,-0.5,30,0,0,0,0,0,1,3';
const WALLS = `
views:
- { id: whole, title: Whole unit, view: "group=temperature" }
- { id: above, title: From above, view: "${ABOVE}" }
walls:
- id: room
  displays:
  - grid: [main alarms]
    panes:
    - { area: main, views: [whole], on_alarm: yes }
    - { area: alarms, alarms: yes }
`;
let plant, wall, desk;

setUp(why, async (own) => {
    plant = own(await startTiny(WALLS));
    wall = own(await openPage(`${plant.url}?wall=room`, { viewport: { width: 960, height: 540 } }));
    desk = own(await openPage(plant.url, { viewport: { width: 1280, height: 720 } }));
    await waitForPicture(desk.page);
    await desk.page.click('#views-toggle');
    await desk.page.locator('#remote-pane option').first().waitFor({ state: 'attached' });
});

const title = () => wall.page.locator('.pane.views h2');
const eyeOfPane = (z) => wall.page.waitForFunction((wanted) => {
    const { picture } = document.querySelector('.pane.views iframe').contentWindow.plantcast?.session ?? {};
    return picture && Math.abs(picture.camera.eye[2] - wanted) < 0.01;
}, z, { polling: 100 });
const inPane = () => wall.page.frameLocator('.pane.views iframe');

test('a note is seen by all users, and on the wall, until it is removed', options, async () => {
    await desk.page.evaluate(() => globalThis.plantcast.session.setParams({ selected: 'E-101' }));
    await desk.page.fill('#note-text', 'Manhole open, permit 4711');
    await desk.page.locator('#note-at option', { hasText: 'E-101' }).waitFor({ state: 'attached' });
    await desk.page.selectOption('#note-at', { label: 'E-101' });
    await desk.page.keyboard.press('Tab');
    await desk.page.locator('#note-form button[type=submit]').click();
    await desk.page.locator('#notes-list li', { hasText: 'Manhole open' }).waitFor();
    assert.match(await desk.page.locator('#notes-list small').textContent(), /E-101 · local, .*until/);
    await desk.page.locator('.note-pin', { hasText: 'Manhole' }).waitFor();
    await inPane().locator('.note-pin', { hasText: 'Manhole' }).waitFor();
    await settle(desk.page);
    await shoot(desk.page, 'notes');
    const { list } = await (await fetch(`${plant.url}api/v1/notes`)).json();
    assert.equal(list.length, 1);
    assert.ok(list[0].until_us > list[0].time_us);
});

// Waits until all sessions of a page are connected: the desk's one, or the wall's and its pane's. A restarted daemon gives each
// session a new model. isOld true: marks the present models; false: waits until all models are unmarked, i.e. new.
const opened = (page, isOld) => page.waitForFunction((marks) => {
    const all = globalThis.wall ? [globalThis.wall, document.querySelector('.pane.views iframe')?.contentWindow.plantcast]
        : [globalThis.plantcast];
    const models = all.map((one) => (one?.session.welcomed ? one.session.model : null));
    if (marks)
        models.forEach((model) => model && Object.assign(model, { isOld: true }));
    return models.every((model) => model && Boolean(model.isOld) === marks);
}, isOld);

test('notes survive a restart of the daemon', options, async () => {
    const pages = [desk.page, wall.page];
    await Promise.all(pages.map((page) => opened(page, true)));
    await plant.stopDaemon('SIGKILL');
    await plant.startDaemon();
    await Promise.all(pages.map((page) => opened(page, false)));
    await wall.page.locator('#lost').waitFor({ state: 'hidden' });
    await desk.page.waitForFunction(() => globalThis.plantcast.session.notes.length === 1);
    await inPane().locator('.note-pin', { hasText: 'Manhole' }).waitFor();
});

test('a view sent to a pane appears there with the sender\'s name', options, async () => {
    await desk.page.fill('#remote-desk', 'Desk 2');
    await desk.page.locator('#remote-said', { hasText: 'connected' }).waitFor();
    await desk.page.locator('.named-open', { hasText: 'From above' }).click();
    await desk.page.waitForFunction(() => Math.abs(globalThis.plantcast.session.picture.camera.eye[2] - 30) < 0.01);
    await desk.page.click('#remote-send');
    await title().filter({ hasText: 'sent by Desk 2, local' }).filter({ hasText: 'From above' }).waitFor();
    await title().locator('.about', { hasText: /Temperature · data .* old/ }).waitFor();
    await eyeOfPane(30);
});

test('a place pointed at from the desk is marked in the pane', options, async () => {
    await desk.page.check('#remote-points');
    const at = await desk.page.evaluate(() => {
        const { viewport } = globalThis.plantcast, { left, top } = viewport.element.getBoundingClientRect();
        return { x: left + viewport.width * 0.45, y: top + viewport.height * 0.55 };
    });
    let moves = 0;
    await until('a pointer in the pane', async () => {
        await desk.page.mouse.move(at.x + (moves % 5) * 12, at.y - (moves % 7) * 10);
        moves++;
        const found = inPane().locator('.note-pin.pointer', { hasText: 'Desk 2, local' });
        return found.waitFor({ timeout: 400 }).then(() => true, () => false);
    });
    await shoot(wall.page, 'wall-remote');
    await desk.page.uncheck('#remote-points');
    await inPane().locator('.note-pin.pointer').waitFor({ state: 'detached' });
});

test('a click while pointing is answered by the server', options, async () => {
    await desk.page.check('#remote-points');
    await desk.page.mouse.move(500, 500);
    await desk.page.mouse.move(520, 480);
    const isPointed = await desk.page.evaluate(async () => {
        const { session, modules, viewport } = globalThis.plantcast, remote = await modules.get('remote');
        globalThis.picked = [];
        session.on('picked', ({ purpose }) => globalThis.picked.push(purpose));
        const { askPick } = await import('./core/requests.js');
        askPick(session, viewport.pixelOf(viewport.width * 0.45, viewport.height * 0.55), 'place');
        remote.askedAt = -1e6;
        remote.ask(); // sends the pointer at once
        return Boolean(remote.page.pointed);
    });
    assert.ok(isPointed);
    await desk.page.waitForFunction(() => globalThis.picked.includes('place'));
    await desk.page.uncheck('#remote-points');
});

test('desk and wall reconnect to each other after reloads', options, async () => {
    await wall.page.reload();
    await desk.page.reload();
    await title().filter({ hasText: 'sent by Desk 2' }).waitFor();
    await eyeOfPane(30);
    await waitForPicture(desk.page);
    await desk.page.click('#views-toggle');
    await desk.page.locator('#remote-said', { hasText: 'sent by Desk 2, local' }).waitFor();
    assert.equal(await desk.page.inputValue('#remote-desk'), 'Desk 2');
});

test('an alarm replaces a sent view, and the sent view returns afterwards', options, async () => {
    const usual = await plant.ask('get TI-1');
    await plant.ask('set TI-1 95');
    await wall.page.locator('.pane.views.called h2', { hasText: 'TI-1' }).waitFor();
    await plant.ask(`set TI-1 ${usual}`);
    // the alarm's value is back within its limits, but nobody has acknowledged it, which the hollow symbol shows
    await wall.page.locator('.pane.views.called h2 .priority.hollow').waitFor();
    await wall.page.evaluate(() => {
        const { session } = globalThis.wall, alarms = [...session.model.alarms.rows.values()].filter(({ state }) => ['unacknowledged',
            'returned'].includes(state))
            .map(({ tag, kind }) => [tag.name, kind]);
        session.post({ type: 'alarm', seq: 1, action: 'acknowledge', alarms, name: 'kim' });
    });
    await title().filter({ hasText: 'sent by Desk 2' }).waitFor();
    await eyeOfPane(30);
});

test('a desk holds a pane, and gives it back', options, async () => {
    await desk.page.click('#remote-hold');
    await title().filter({ hasText: 'held by Desk 2' }).waitFor();
    await desk.page.click('#remote-back');
    await title().filter({ hasText: 'Whole unit' }).waitFor();
    await becomes(async () => /Desk 2/.test(await title().textContent()), false, 'the title names no desk');
    await desk.page.locator('#notes-list li .end').click();
    await desk.page.locator('.note-pin').waitFor({ state: 'detached' });
    await inPane().locator('.note-pin').waitFor({ state: 'detached' });
});

test('the metrics state the age of a wall\'s picture, and the age grows once the wall is closed', options, async () => {
    const age = async () => {
        const text = await (await fetch(`${plant.url}metrics`)).text();
        return Number(/plantcast_wall_frame_age_seconds\{wall="room",display="1"\} (\S+)/.exec(text)?.[1]);
    };
    await until('a young picture', async () => await age() < 10, 60);
    await wall.page.goto('about:blank');
    await until('an old picture', async () => await age() > 20, 60);
    await desk.page.locator('#remote-said', { hasText: 'not connected' }).waitFor();
});
