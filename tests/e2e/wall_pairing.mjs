// SPDX-License-Identifier: GPL-3.0-or-later
// A display that nobody types a token into: its six digits, an engineer who lets it in, the display that it is from then on, and the end.
import assert from 'node:assert/strict';
import { chmodSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, shoot, waitForPicture } from './support/browser.mjs';
import { missing, startPlant } from './support/plant.mjs';
import { runProgram } from './support/tiny_plant.mjs';

const why = missing();
const options = { skip: why ?? false, timeout: 300000 };
const WALLS = `
views:
- { id: whole, title: Whole unit, view: "group=temperature" }
walls:
- id: room
  displays:
  - grid: [main alarms]
    panes: [{ area: main, views: [whole] }, { area: alarms, alarms: yes }]
  - grid: [clock]
    panes: [{ area: clock, clock: yes }]
`;
const tokens = {};
let folder, plant, wall, desk, id;

const digitsOf = async (page) => {
    await page.locator('#denied .digits', { hasText: /^\d{3}.\d{3}$/ }).waitFor({ timeout: 60000 });
    return (await page.locator('#denied .digits').textContent()).replace(/\D/g, '');
};
const letIn = async (page, token) => {
    await page.locator('#token[open]').waitFor({ timeout: 60000 });
    await page.locator('#token-text').fill(token);
    await page.locator('#token-form button').click();
    await waitForPicture(page);
};
const get = (path, token) => fetch(plant.url + path, { headers: token ? { Authorization: token } : {} });
const audit = () => readFileSync(join(folder, 'audit'), 'utf8');

before(async () => {
    if (why)
        return;
    folder = mkdtempSync(join(tmpdir(), 'plantcast-pairing-'));
    const file = join(folder, 'tokens');
    for (const role of ['operator', 'engineer'])
        tokens[role] = runProgram('plantcast', ['token', 'add', file, '--role', role, '--name', `${role}-1`]).out.trim();
    chmodSync(file, 0o600);
    plant = await startPlant(`alarms: local\n${WALLS}`, () => {}, ['--tokens', file, '--audit', join(folder, 'audit')]);
    wall = await openPage(`${plant.url}?wall=room`, { viewport: { width: 1920, height: 1080 } });
    desk = await openPage(plant.url, { viewport: { width: 1400, height: 900 } });
    await letIn(desk.page, tokens.engineer);
    await desk.page.click('#views-toggle');
    await desk.page.locator('#devices').waitFor({ timeout: 60000 });
});
after(async () => {
    await wall?.close();
    await desk?.close();
    await plant?.stop();
    if (folder)
        rmSync(folder, { recursive: true, force: true });
});

test('it shows six digits, and nothing of the plant', options, async () => {
    const digits = await digitsOf(wall.page);
    assert.equal(await wall.page.locator('.pane').count(), 0);
    await shoot(wall.page, 'wall-pairing');
    await wall.page.reload();
    assert.equal(await digitsOf(wall.page), digits); // they are its own until they expire
});

test('digits that no display shows, other secrets and other people change nothing', options, async () => {
    await desk.page.fill('#devices-digits', '000 000');
    await desk.page.click('#devices button[type=submit]');
    await desk.page.locator('#toast, [role=status], [role=alert]').filter({ hasText: 'no display shows these digits' }).first()
        .waitFor({ timeout: 20000 });
    assert.equal((await get('api/v1/pair?wall=room&display=1', 'Pairing pc_1')).status, 400);
    assert.equal((await get('api/v1/pair?wall=nowhere&display=1', `Pairing pc_${'0'.repeat(64)}`)).status, 400);
    assert.equal((await get('api/v1/devices', `Bearer ${tokens.operator}`)).status, 403);
    assert.equal((await get('api/v1/devices')).status, 401);
    for (let i = 0; i < 7; i++)
        assert.equal((await get('api/v1/pair?wall=room&display=2', `Pairing pc_${String(i).repeat(64)}`)).status, 200);
    assert.equal((await get('api/v1/pair?wall=room&display=2', `Pairing pc_${'a'.repeat(64)}`)).status, 503); // the wall is the eighth
});

test('an engineer lets it in, and who did it is in the audit trail', options, async () => {
    await desk.page.fill('#devices-digits', await digitsOf(wall.page));
    await desk.page.click('#devices button[type=submit]');
    const row = desk.page.locator('#devices-list li');
    await row.waitFor({ timeout: 30000 });
    assert.match(await row.textContent(), /Display 1 of room, from 127\.0\.0\.1, let in by engineer-1/);
    id = await row.getAttribute('data-id');
    await wall.page.locator('.pane.alarms').waitFor({ timeout: 60000 });
    await wall.page.waitForFunction(() => document.querySelector('.pane.views iframe').contentWindow.plantcast?.session.picture, null,
        { timeout: 90000 });
    await shoot(desk.page, 'devices');
    assert.match(audit(), /engineer-1.*pair room\.1\.1/);
});

test('it is that display only, as a viewer, also after a restart of the daemon', options, async () => {
    await plant.stopDaemon('SIGKILL');
    await plant.startDaemon();
    await wall.page.reload();
    await wall.page.locator('.pane.alarms').waitFor({ timeout: 60000 });
    const secret = await wall.page.evaluate(() => localStorage.getItem('plantcast.wall.room.1'));
    assert.equal((await get('api/v1/tags', `Bearer ${secret}`)).status, 200);
    assert.equal((await get('api/v1/devices', `Bearer ${secret}`)).status, 403);
    assert.deepEqual(await (await get('api/v1/pair?wall=room&display=1', `Pairing ${secret}`)).json(), { paired: true });
    assert.equal((await get('api/v1/pair?wall=room&display=2', `Pairing ${secret}`)).status, 409);
    await wall.page.evaluate(() => globalThis.wall.session.post({ type: 'display', wall: 'room', display: 2 }));
    const end = Date.now() + 20000;
    while (!/was paired as display 1/.test(audit()) && Date.now() < end)
        await new Promise((done) => setTimeout(done, 200));
    assert.match(audit(), /refused.*was paired as display 1 of wall room/);
    await wall.page.reload();
    await wall.page.locator('.pane.alarms').waitFor({ timeout: 60000 });
});

test('a viewer notes, sends and points at nothing; who may stands in the audit trail', options, async () => {
    const pane = { wall: 'room', display: 1, area: 'main' };
    const asked = [{ type: 'note', seq: 1, text: 'Manhole open', asset: 'TK-101' }, { type: 'send_to_wall', seq: 2, ...pane, held: true },
        { type: 'point', ...pane, position: [1, 2, 3] }];
    const post = (page, globals) => page.evaluate(([messages, name]) => new Promise((done) => {
        const session = name === 'wall' ? globalThis.wall.session : globalThis.plantcast.session, heard = [];
        for (const type of ['refused', 'noted', 'sent_to_wall'])
            session.on(type, (message) => heard.push(message) >= messages.length && done(heard));
        messages.forEach((message) => session.post(message));
        setTimeout(done, 4000, heard);
    }), [asked, globals]);
    await post(wall.page, 'wall');
    for (const what of ['to note something', 'to send something to a wall'])
        assert.match(audit(), new RegExp(`refused.*room\\.1\\.1.*${what} takes the role operator`));
    assert.equal(audit().split('to send something to a wall takes').length - 1, 2); // sending, and pointing
    await desk.page.waitForFunction(() => globalThis.plantcast.session.connection.state === 'open', null, { timeout: 60000 });
    await post(desk.page, 'page');
    assert.match(audit(), /engineer-1.*at TK-101: Manhole open/);
    assert.match(audit(), /engineer-1.*hold room, display 1, main/);
});

test('it is dark within 3 s of being revoked', options, async () => {
    await desk.page.waitForFunction(() => {
        const { welcomed, connection } = globalThis.plantcast.session;
        return welcomed && connection.state === 'open';
    }, null, { timeout: 60000 });
    await desk.page.locator(`#devices-list li[data-id="${id}"] button`).click({ timeout: 60000 });
    const clicked = Date.now();
    await wall.page.locator('#denied').waitFor({ timeout: 20000 });
    const ms = Date.now() - clicked;
    assert.ok(ms < 3000, `${ms} ms`);
    assert.equal(await wall.page.locator('.pane').count(), 0);
    assert.match(audit(), /engineer-1.*unpair room\.1\.1/);
    await digitsOf(wall.page);
    assert.deepEqual(wall.errors, []);
});
