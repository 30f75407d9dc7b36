// SPDX-License-Identifier: GPL-3.0-or-later
// Pairing of a display without typing a token at it: its six digits, an engineer who approves it, the display's rights from
// then on, and its removal.
import assert from 'node:assert/strict';
import { chmodSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, shoot, waitForPicture } from './support/browser.mjs';
import { folderOfTests } from './support/folders.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram, startTiny } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const why = notBuilt();
const options = { skip: why, timeout: 300000 };
const WALLS = `
views:
- { id: whole, title: Whole unit, view: "group=temperature" }
walls:
- id: room
  displays:
  - grid: [main alarms]
    panes: [{ area: main, views: [whole] }, { area: alarms, alarms: yes }]
  - grid: [tiles trend]
    panes: [{ area: tiles, tiles: [TI-1] }, { area: trend, trend: [TI-2], hours: 1 }]
- { id: tiled, tile: { columns: 2, rows: 1, views: whole } }
`;
const tokens = {};
const folder = folderOfTests();
let plant, wall, desk, id;

const digitsOf = async (page) => {
    await page.locator('#denied .digits', { hasText: /^\d{3}.\d{3}$/ }).waitFor();
    return (await page.locator('#denied .digits').textContent()).replace(/\D/g, '');
};
const letIn = async (page, token) => {
    await page.locator('#token[open]').waitFor();
    await page.locator('#token-text').fill(token);
    await page.locator('#token-form button').click();
    await waitForPicture(page);
};
const get = (path, token) => fetch(plant.url + path, { headers: token ? { Authorization: token } : {} });
const audit = () => readFileSync(join(folder, 'audit'), 'utf8');
// Waits until a line of the audit trail matches: the daemon writes the trail after it has answered.
const recorded = (pattern) => until(`${pattern} in the trail`, () => pattern.test(audit()), 90, audit);
// Waits until the session of a page is open; name: `wall` or `plantcast`.
const connected = (page, name) => page.waitForFunction((of) => {
    const { welcomed, connection } = globalThis[of].session;
    return welcomed && connection.state === 'open';
}, name);

setUp(why, async (own) => {
    const file = join(folder, 'tokens');
    for (const role of ['operator', 'engineer'])
        tokens[role] = runProgram('plantcast', ['token', 'add', file, '--role', role, '--name', `${role}-1`]).out.trim();
    tokens.viewer = runProgram('plantcast', ['token', 'add', file, '--role', 'viewer', '--name', 'viewer-1', '--unattended']).out.trim();
    tokens.tile = runProgram('plantcast',
        ['token', 'add', file, '--role', 'viewer', '--name', 'tile-2', '--display', 'tiled:2']).out.trim();
    chmodSync(file, 0o600);
    plant = own(await startTiny(WALLS, ['--tokens', file, '--audit', join(folder, 'audit')]));
    wall = own(await openPage(`${plant.url}?wall=room`, { viewport: { width: 960, height: 540 } }));
    desk = own(await openPage(plant.url, { viewport: { width: 1280, height: 720 } }));
    await letIn(desk.page, tokens.engineer);
    await desk.page.click('#views-toggle');
    await desk.page.locator('#devices').waitFor();
});

test('a wall tile takes its display\'s token: a viewer\'s token can neither lead nor delay a wall', options, async () => {
    const port = Number(new URL(plant.url).port), open = [];
    const hello = async (token, display) => {
        const client = await PlainClient.open(port);
        open.push(client);
        client.say({ type: 'hello', width: 320, height: 180, codecs: ['jpeg'], token, tile: { wall: 'tiled', display } });
        await client.until('an answer', () => client.texts.some(({ type }) => type === 'error' || type === 'welcome'));
        return client;
    };
    for (const role of ['viewer', 'operator']) {
        const [error] = (await hello(tokens[role], 1)).texts;
        assert.deepEqual([error.type, error.code], ['error', 'not_allowed'], role);
        assert.match(error.text, /tile: this needs the token of display 1 of wall tiled, or the role engineer/);
    }
    assert.match((await hello(tokens.tile, 1)).texts[0].text, /this token belongs to display 2 of wall tiled/);
    const tile = await hello(tokens.tile, 2);
    await tile.until('the lead', () => tile.texts.some(({ type, leads }) => type === 'tiles' && leads));
    // only display 1 is missing: the clients refused above do not count as displays
    assert.deepEqual((await tile.text('tiles')).missing, [1]);
    const other = await hello(tokens.engineer, 1);
    await other.until('both', () => other.texts.some(({ type, missing: gone }) => type === 'tiles' && gone.length === 0));
    open.forEach((client) => client.close());
});

test('an unpaired display shows six digits, and nothing of the plant', options, async () => {
    const digits = await digitsOf(wall.page);
    assert.equal(await wall.page.locator('.pane').count(), 0);
    await shoot(wall.page, 'wall-pairing');
    await wall.page.reload();
    assert.equal(await digitsOf(wall.page), digits); // a reload of the page keeps the digits, until they expire
});

test('digits that no display shows, other secrets and other users change nothing', options, async () => {
    await desk.page.fill('#devices-digits', '000 000');
    await desk.page.click('#devices button[type=submit]');
    await desk.page.locator('#toast, [role=status], [role=alert]').filter({ hasText: 'no display shows this code' }).first()
        .waitFor();
    assert.equal((await get('api/v1/pair?wall=room&display=1', 'Pairing pc_1')).status, 400);
    assert.equal((await get('api/v1/pair?wall=nowhere&display=1', `Pairing pc_${'0'.repeat(64)}`)).status, 400);
    assert.equal((await get('api/v1/devices', `Bearer ${tokens.operator}`)).status, 403);
    assert.equal((await get('api/v1/devices')).status, 401);
    for (let i = 0; i < 7; i++)
        assert.equal((await get('api/v1/pair?wall=room&display=2', `Pairing pc_${String(i).repeat(64)}`)).status, 200);
    // the wall and the seven devices above are eight waiting for approval, the maximum: a ninth gets 503
    assert.equal((await get('api/v1/pair?wall=room&display=2', `Pairing pc_${'a'.repeat(64)}`)).status, 503);
});

test('an engineer approves the display, and the audit trail names the engineer', options, async () => {
    await desk.page.fill('#devices-digits', await digitsOf(wall.page));
    await desk.page.click('#devices button[type=submit]');
    const row = desk.page.locator('#devices-list li');
    await row.waitFor();
    assert.match(await row.textContent(), /Display 1 of room, address 127\.0\.0\.1, paired by engineer-1/);
    id = await row.getAttribute('data-id');
    await wall.page.locator('.pane.alarms').waitFor();
    await wall.page.waitForFunction(() => document.querySelector('.pane.views iframe').contentWindow.plantcast?.session.picture);
    await shoot(desk.page, 'devices');
    await recorded(/engineer-1.*pair room\.1\.1/);
});

test('a paired display is that display only, as a viewer, also after a restart of the daemon', options, async () => {
    await plant.stopDaemon('SIGKILL');
    await plant.startDaemon();
    await wall.page.reload();
    await wall.page.locator('.pane.alarms').waitFor();
    const secret = await wall.page.evaluate(() => localStorage.getItem('plantcast.wall.room.1'));
    assert.equal((await get('api/v1/devices', `Bearer ${secret}`)).status, 403);
    assert.deepEqual(await (await get('api/v1/pair?wall=room&display=1', `Pairing ${secret}`)).json(), { paired: true });
    assert.equal((await get('api/v1/pair?wall=room&display=2', `Pairing ${secret}`)).status, 409);
    await connected(wall.page, 'wall');
    await wall.page.evaluate(() => globalThis.wall.session.post({ type: 'display', wall: 'room', display: 2 }));
    await recorded(/refused.*this token belongs to display 1 of wall room/);
    await wall.page.reload();
    await wall.page.locator('.pane.alarms').waitFor();
});

// Connects a client with the secret of a display of the wall `room`. pairs: first lets the desk approve the digits that the
// server gives for this secret.
async function displayClient(display, secret, pairs) {
    if (pairs) {
        const { digits } = await (await get(`api/v1/pair?wall=room&display=${display}`, `Pairing ${secret}`)).json();
        await connected(desk.page, 'plantcast');
        await desk.page.evaluate((six) => globalThis.plantcast.session.post({ type: 'pair', seq: 9, digits: six }), digits);
        await until('the pairing', async () =>
            (await (await get(`api/v1/pair?wall=room&display=${display}`, `Pairing ${secret}`)).json()).paired);
    }
    return PlainClient.open(Number(new URL(plant.url).port), { headers: [`Authorization: Bearer ${secret}`], host: 'localhost' });
}

const TILES = '[{ area: tiles, tiles: [TI-1] }', PICTURE = '[{ area: tiles, views: [whole] }';

async function reload(from, to) {
    writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace(from, to));
    const answer = await fetch(`${plant.url}api/v1/reload`, { method: 'POST', headers: { Authorization: `Bearer ${tokens.engineer}` } });
    assert.equal(answer.status, 200, await answer.text());
}

const PATHS = ['tags', 'plant', 'views', 'notes', 'alarms', 'alarms/journal', 'proofs', 'pick?x=1&y=1', 'history?tags=TI-1&from=-1h',
    'devices', 'import'];

test('a display\'s secret reads only that display, even before its first message', options, async () => {
    const first = await wall.page.evaluate(() => localStorage.getItem('plantcast.wall.room.1'));
    // a secret made up by this test; display 2 may connect with it once the desk has approved its digits
    const second = `pc_${'1'.repeat(64)}`;
    const tiles = await displayClient(2, second, true), pictures = await displayClient(1, first, false);
    for (const secret of [first, second])
        for (const path of [...PATHS.map((one) => `api/v1/${one}`), 'metrics', 'snapshot.png', 'snapshot.png?view=whole'])
            assert.equal((await get(path, `Bearer ${secret}`)).status, 403, path);
    const shape = async (secret) => {
        const { walls } = await (await get('api/v1/walls', `Bearer ${secret}`)).json();
        return walls[0].displays.map(({ panes }) => panes.length);
    };
    assert.deepEqual([await shape(first), await shape(second), await shape(tokens.engineer)], [[2, 0], [0, 2], [2, 2]]);
    assert.equal((await get('api/v1/history?tags=TI-2&from=-1h', `Bearer ${second}`)).status, 200);
    assert.equal((await get('api/v1/history?tags=TI-2,TI-1&from=-1h', `Bearer ${second}`)).status, 403);

    const { tags } = await tiles.hello({ width: 640, height: 480 });
    const mine = ['TI-1', 'TI-2'].map((name) => tags.findIndex((tag) => tag.name === name));
    const read = new Set();
    for (let n = 0; n < 5; n++) {
        for (const tag of ['TI-1', 'TI-2', 'PI-1'])
            await plant.ask(`set ${tag} ${30 + n}`);
        const { values } = await tiles.text('tags', 20000);
        values.forEach(([tag]) => read.add(tag));
    }
    // display 2 got the values of all tags in its tiles, and of no others
    assert.deepEqual([...read].sort((a, b) => a - b), mine.sort((a, b) => a - b));
    const frame = await tiles.frameWhere('a picture', () => true);
    assert.deepEqual([frame.width, frame.height], [16, 16]);
    assert.equal(tiles.texts.filter(({ type }) => ['markers', 'proofs'].includes(type)).length, 0);
    assert.deepEqual(tiles.texts.filter(({ type }) => type === 'views' || type === 'notes').flatMap(({ list }) => list), []);
    for (const message of [{ type: 'pick', seq: 1, x: 1, y: 1 }, { type: 'time', at_us: 1 }, { type: 'follow', session: 1 }]) {
        tiles.say(message);
        assert.match((await tiles.text('error')).text, /this token belongs to display 2 of wall room/, message.type);
    }
    await pictures.hello({ width: 640, height: 480 });
    // a display with pictures gets all tags, because an alarm may move its camera to any part of the plant
    assert.equal((await pictures.text('tags', 20000)).values.length, 3);
    // a display with pictures may send picks: the page uses them to find a side from which an alarm's position is visible
    pictures.say({ type: 'pick', seq: 1, x: 320, y: 240 });
    assert.equal((await pictures.text('picked', 20000)).seq, 1);
    assert.deepEqual((await pictures.text('views', 20000)).list.map(({ id: view }) => view), ['whole']);
    pictures.close();

    await reload(TILES, PICTURE);
    assert.deepEqual(await tiles.until('the end', ({ closed }) => closed), { code: 1012,
        text: 'the plant file has changed what this display shows: connect again' });
    const again = await displayClient(2, second, false);
    await again.hello({ width: 640, height: 480 });
    const larger = await again.frameWhere('a picture', () => true);
    assert.deepEqual([larger.width, larger.height], [640, 480]);
    again.close();
    await reload(PICTURE, TILES);
});

// Opens the page of a display that has stored a secret or token before.
async function wallPage(display, key, token) {
    const screen = await openPage(`${plant.url}healthz`, { viewport: { width: 1280, height: 720 } });
    await screen.page.evaluate(([name, text]) => localStorage.setItem(name, text), [key, token]);
    await screen.page.goto(`${plant.url}?wall=room&display=${display}`);
    return screen;
}

test('pages of a paired display, and of a token for some views, show what these may see', options, async () => {
    const tiles = await wallPage(2, 'plantcast.wall.room.2', `pc_${'1'.repeat(64)}`);
    await tiles.page.waitForFunction(() => /\d/.test(document.querySelector('.tile .value')?.textContent ?? ''));
    const trend = tiles.page.frameLocator('.pane.trend iframe');
    await trend.locator('.uplot').first().waitFor();
    await shoot(tiles.page, 'wall-device');
    assert.deepEqual(tiles.errors, []);
    await tiles.close();

    const file = join(folder, 'tokens');
    const made = runProgram('plantcast', ['token', 'add', file, '--role', 'viewer', '--name', 'lobby', '--unattended', '--views', 'whole']);
    const lobby = made.out.trim();
    await plant.logged(/tokens .*: 5 tokens read$/m);
    const seen = await wallPage(1, 'plantcast.wall', lobby);
    await seen.page.locator('.pane.views .said', { hasText: 'Whole unit' }).waitFor();
    await seen.page.waitForFunction(() => document.querySelector('.pane.views iframe').contentWindow.plantcast?.session.picture);
    await shoot(seen.page, 'wall-views-token');
    assert.equal(await seen.page.locator('.pane').count(), 1);
    assert.doesNotMatch(audit(), /refused.*lobby|lobby.*refused/);
    assert.deepEqual(seen.errors, []);
    await seen.close();
});

test('a viewer can note, send and point at nothing; the audit trail names users who can', options, async () => {
    const pane = { wall: 'room', display: 1, area: 'main' };
    const asked = [{ type: 'note', seq: 1, text: 'Manhole open', asset: 'E-101' }, { type: 'send_to_wall', seq: 2, ...pane, held: true },
        { type: 'point', ...pane, position: [1, 2, 3] }];
    const post = async (page, name) => {
        await connected(page, name);
        await page.evaluate(([messages, of]) => messages.forEach((message) => globalThis[of].session.post(message)), [asked, name]);
    };
    await post(wall.page, 'wall');
    // the server refused three of the messages posted at the wall: a note, a view sent to a pane, and a pointer
    await recorded(/refused.*room\.1\.1.*to write or remove notes: this needs the role operator/);
    await recorded(/(refused.*room\.1\.1.*to send views or a pointer to a wall: this needs the role operator[^]*){2}/);
    await post(desk.page, 'plantcast');
    await recorded(/engineer-1.*at E-101: Manhole open/);
    await recorded(/engineer-1.*hold room, display 1, main/);
});

test('a revoked display is dark within 3 s', options, async (t) => {
    await connected(desk.page, 'plantcast');
    await desk.page.locator(`#devices-list li[data-id="${id}"] button`).click();
    const clicked = Date.now();
    await wall.page.locator('#denied').waitFor();
    promise(t, 'until it is dark', Date.now() - clicked, 3000);
    assert.equal(await wall.page.locator('.pane').count(), 0);
    await recorded(/engineer-1.*unpair room\.1\.1/);
    await digitsOf(wall.page);
    assert.deepEqual(wall.errors, []);
});
