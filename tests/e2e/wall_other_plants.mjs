// SPDX-License-Identifier: GPL-3.0-or-later
// A pane of a wall that shows the picture of another plant, served by a second daemon; also what the pane shows if the other
// server sends no usable picture.
import assert from 'node:assert/strict';
import { appendFileSync, chmodSync, readFileSync, writeFileSync } from 'node:fs';
import { once } from 'node:events';
import { createServer } from 'node:http';
import { request } from 'node:https';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { openPage, shoot } from './support/browser.mjs';
import { makeCertificate } from './support/certificate.mjs';
import { freePort } from './support/ports.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { missing, runProgram, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { becomes } from './support/until.mjs';

const none = missing();
const options = { skip: none.length > 0 ? `not built: ${none}` : false, timeout: 240000 };
const SIZE = [1280, 720], LARGE_BYTES = 9 << 20, NAME = 'Zwei Kästen, 탱크 2';
const tokens = {};
let plant, other, otherArgs, fake, fakePort, picture, small;

// How a fake server answers, selected by the first part of the request's path: a good picture, a slow one, an error and so on.
const FRAME = { 'plantcast-frame': 'data_time_us=1, oldest_age_ms=1500, plant=Fake%20plant', 'content-type': 'image/png' };
const MANNERS = {
    good: (response) => response.writeHead(200, FRAME).end(picture),
    slow(response) {
        response.writeHead(200, { ...FRAME, 'content-length': picture.length });
        const timer = setInterval((at) => response.write(picture.subarray(at.i, ++at.i)), 300, { i: 0 });
        response.on('close', () => clearInterval(timer));
    },
    large: (response) => response.writeHead(200, FRAME).end(Buffer.alloc(LARGE_BYTES)),
    page: (response) => response.writeHead(200, { 'content-type': 'text/html' }).end('<html>a log-in</html>'),
    past: (response) => response.writeHead(200, { ...FRAME, 'plantcast-frame': `${FRAME['plantcast-frame']}, past=yes` }).end(picture),
    unsaid: (response) => response.writeHead(200, { 'content-type': 'image/png' }).end(picture),
    cut: (response) => response.writeHead(200, FRAME).end(picture.subarray(0, picture.length - 40)),
    small: (response) => response.writeHead(200, FRAME).end(small),
    elsewhere: (response) => response.writeHead(302, { location: `http://127.0.0.1:${fakePort}/good/snapshot.png` }).end(),
    busy: (response) => response.writeHead(503, { 'retry-after': '5' }).end('too many pictures are being made\n'),
    shut: (response) => response.writeHead(401).end('a token is needed\n'),
};
const EXPECTED = { good: '', slow: 'slow', large: 'large', page: 'no_picture', past: 'no_picture', unsaid: 'no_picture', cut: 'no_picture',
    small: 'no_picture', elsewhere: 'no_picture', busy: 'busy', shut: 'refused', untrusted: 'tls', away: 'unreachable',
    tokenless: 'token', wrong: 'no_picture' };

const get = async (path, token = tokens.viewer) => {
    const response = await fetch(`http://127.0.0.1:${plant.port}/${path}`, { headers: { Authorization: `Bearer ${token}` } });
    return { status: response.status, body: Buffer.from(await response.arrayBuffer()) };
};
const stateOf = async (id) => JSON.parse((await get(`api/v1/other_plants?id=${id}`)).body).list[0];
async function until(look, what, ms = 90000) {
    for (const end = performance.now() + ms; ; await sleep(100)) {
        const found = await look();
        if (found)
            return found;
        assert.ok(performance.now() < end, `${what}\n${plant.daemon.said}`);
    }
}

const ask = (path) => new Promise((done, fail) => {
    const ca = readFileSync(join(other.folder, 'mail.pem')), headers = { Authorization: `Bearer ${tokens.other}` };
    request({ host: '127.0.0.1', port: other.port, path, ca, headers }, async (response) => {
        const parts = [];
        for await (const part of response)
            parts.push(part);
        done(Buffer.concat(parts));
    }).on('error', fail).end();
});

function addToken(file, name, ...more) {
    const { out, err } = runProgram('plantcast', ['token', 'add', file, '--role', 'viewer', '--name', name, ...more]);
    assert.ok(out, err);
    chmodSync(file, 0o600);
    return out.trim();
}

async function startOther() {
    other = await TinyPlant.create();
    other.keepFresh();
    makeCertificate(other.folder, 'mail');
    tokens.other = addToken(join(other.folder, 'tokens'), 'wall', '--unattended');
    writeFileSync(other.file, readFileSync(other.file, 'utf8').replace('Two boxes', NAME));
    appendFileSync(other.file, 'views: [{ id: warm, title: Warm, view: "group=temperature" }]\n');
    assert.equal(other.prepare().code, 0);
    await other.startSim();
    const file = (name) => join(other.folder, name);
    const tls = ['--tls-cert', file('mail.pem'), '--tls-key', file('mail.key')];
    otherArgs = [...tls, '--tokens', file('tokens'), '--port', String(await freePort())];
    await other.startDaemon(...otherArgs);
    await other.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
}

// Starts the plant that has the wall. One large pane shows the other plant, and the pane next to it shows a server that answers
// nonsense.
async function startPlant() {
    plant = await TinyPlant.create();
    const at = (id, more = '') => `- { id: ${id}, url: "http://127.0.0.1:${fakePort}/${id}", every_s: 2${more} }\n`;
    const url = `https://127.0.0.1:${other.port}`, ca = `ca_file: ${join(other.folder, 'mail.pem')}`;
    const entries = [`- { id: tanks, url: "${url}/", token_file: other.token, ${ca}, view: warm, every_s: 2 }\n`,
        `- { id: untrusted, url: "${url}", token_file: other.token, every_s: 2 }\n`,
        `- { id: tokenless, url: "${url}", token_file: none.token, ${ca}, every_s: 2 }\n`,
        `- { id: wrong, url: "${url}", token_file: other.token, ${ca}, view: nowhere, every_s: 2 }\n`,
        `- { id: away, url: "http://127.0.0.1:${await freePort()}", every_s: 2 }\n`, ...Object.keys(MANNERS).map((id) => at(id))];
    appendFileSync(plant.file, `other_plants:\n${entries.join('')}walls:
- id: room
  displays:
  - grid: [tanks tanks page, tanks tanks clock]
    panes: [{ area: tanks, title: Tank farm, snapshot: tanks }, { area: page, snapshot: page }, { area: clock, clock: yes }]
  - { grid: [a], panes: [{ area: a, clock: yes }] }
`);
    writeFileSync(join(plant.folder, 'other.token'), `${tokens.other}\n`);
    const file = join(plant.folder, 'tokens');
    tokens.viewer = addToken(file, 'wall', '--unattended');
    tokens.display = addToken(file, 'one', '--display', 'room:1');
    tokens.second = addToken(file, 'two', '--display', 'room:2');
    await plant.start('--tokens', file);
}

setUp(options.skip, async () => {
    await startOther();
    picture = await until(async () => {
        const png = await ask(`/snapshot.png?width=${SIZE[0]}&height=${SIZE[1]}`);
        return png.length > 5000 && png;
    }, 'a picture');
    small = await ask('/snapshot.png?width=640&height=360');
    fake = createServer(({ url }, response) => MANNERS[url.split('/')[1]](response));
    fake.listen(0, '127.0.0.1');
    await once(fake, 'listening');
    fakePort = fake.address().port;
    await startPlant();
});
after(async () => {
    fake?.closeAllConnections();
    fake?.close();
    await plant?.destroy();
    await other?.destroy();
});

test('each way that another plant\'s server fails to send a picture is reported', options, async () => {
    const ids = Object.keys(EXPECTED), query = ids.map((id) => `id=${id}`).join('&');
    await until(async () => {
        const { list } = JSON.parse((await get(`api/v1/other_plants?${query}`)).body);
        const settled = list.every(({ id, why, picture: number }) => why === EXPECTED[id] && (number > 0) === (EXPECTED[id] === ''));
        return settled || (options.last = JSON.stringify(list), false);
    }, 'each', 60000).catch((error) => assert.fail(`${error.message}\n${options.last}`));
    // Reads the picture's number and then requests that picture; repeats if the server has replaced the picture in between,
    // which it does every 2 s.
    const [good, shown] = await until(async () => {
        const state = await stateOf('good'), answer = await get(`api/v1/other_plants/picture?id=good&picture=${state.picture}`);
        return answer.status === 200 && [state, answer.body];
    }, 'the good picture');
    assert.equal(good.name, 'Fake plant');
    assert.ok(good.age_ms >= 1500, `the picture is ${good.age_ms} ms old`);
    assert.deepEqual(shown, picture);
    assert.equal((await get(`api/v1/other_plants/picture?id=good&picture=${good.picture + 1}`)).status, 404);
    assert.equal((await get('api/v1/other_plants/picture?id=page&picture=1')).status, 404);
    assert.equal((await get('api/v1/other_plants?id=nobody')).status, 404);
    assert.equal((await get('api/v1/other_plants')).status, 400);
    assert.ok(!plant.daemon.said.includes(tokens.other), 'no token in the log');
});

test('a paired display can request its own panes\' plants, and nothing else', options, async () => {
    assert.equal((await get('api/v1/other_plants?id=tanks', tokens.display)).status, 200);
    for (const [path, token] of [['?id=good', tokens.display], ['?id=tanks', tokens.second],
        ['/picture?id=good&picture=1', tokens.display]])
        assert.equal((await get(`api/v1/other_plants${path}`, token)).status, 404, path);
    assert.equal((await get('api/v1/other_plants?id=tanks', 'nonsense')).status, 401);
});

test('the pane shows another plant\'s picture, name and data age; also that its server is down, since when, and its return',
    options, async (t) => {
    const screen = { viewport: { width: SIZE[0], height: SIZE[1] } };
    const { page, close, errors } = await openPage(`http://127.0.0.1:${plant.port}/wall.html?wall=room`, screen,
        // stores the token only in the top window: the frames within the page are sandboxed and have no session storage
        `top === window && sessionStorage.setItem('plantcast.token', '${tokens.display}')`);
    const image = page.locator('.pane.snapshot img').first(), card = page.locator('.pane.snapshot .gone').first();
    const title = page.locator('.pane.snapshot h2').first();
    await image.waitFor();
    assert.deepEqual(await image.evaluate(({ naturalWidth, naturalHeight }) => [naturalWidth, naturalHeight]), SIZE);
    await title.filter({ hasText: new RegExp(`^Tank farm${NAME} · data \\d+(\\.\\d)? s old$`) }).waitFor();
    await page.locator('.pane.snapshot .gone', { hasText: 'Its server sends no picture' }).waitFor();
    const first = await image.getAttribute('src');
    await page.waitForFunction((src) => document.querySelector('.pane.snapshot img').getAttribute('src') !== src, first);
    await shoot(page, 'wall-other-plant');

    await other.daemon.stop('SIGKILL');
    const killed = performance.now();
    await card.filter({ hasText: /No picture from .* since \d\d:\d\d:\d\d.*Its server does not answer/ }).waitFor();
    assert.ok(await image.isHidden());
    promise(t, 'until the page says so', performance.now() - killed, 20000);
    await becomes(async () => /old/.test(await title.textContent()), false, 'no age');
    await shoot(page, 'wall-other-plant-gone');

    // the new token is used at once, because the server reads the token file before each request to the other plant
    writeFileSync(join(plant.folder, 'other.token'), 'pc_nonsense\n');
    await other.startDaemon(...otherArgs);
    await card.filter({ hasText: 'Its server rejects the token' }).waitFor();
    writeFileSync(join(plant.folder, 'other.token'), `${tokens.other}\n`);
    await image.waitFor();
    assert.deepEqual(errors, []);
    assert.ok(!(await page.content()).includes(tokens.other));
    await close();
});
