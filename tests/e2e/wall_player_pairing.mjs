// SPDX-License-Identifier: GPL-3.0-or-later
// plantcast-wall without a token: the digits that it shows, an engineer who lets it in, where its secret is kept, digits again once that is
// revoked, and what it says where there are none; at a daemon, and at a renderer of a core.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { appendFileSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { SCREENSHOTS } from './support/browser.mjs';
import { Pace } from './support/crowd.mjs';
import { Nodes, sleep, until } from './support/nodes.mjs';
import { BIN } from './support/plant.mjs';
import { missing, runProgram } from './support/tiny_plant.mjs';
import { missingDisplay, savePng, startDisplay } from './support/x_display.mjs';

const PROGRAM = join(BIN, 'plantcast-wall'), absent = missing();
const unbuilt = existsSync(PROGRAM) ? absent : [...absent, 'plantcast-wall'];
const why = unbuilt.length > 0 ? `not built: ${unbuilt.join(', ')}` : missingDisplay();
const options = { skip: why ?? false, timeout: 240000 };
const WALLS = `
views: [{ id: whole, title: Whole unit, view: "group=temperature" }]
walls:
- id: room
  displays: [{ grid: [main], panes: [{ area: main, views: [whole] }] }, { grid: [time], panes: [{ area: time, clock: yes }] }]
`;
const WIDTH = 1280, HEIGHT = 720;
const folder = mkdtempSync(join(tmpdir(), 'plantcast-pairing-'));
let nodes, core, display, engineer, players = [];

function startPlayer(url, args, { on = display, env = {} } = {}) {
    const bare = { ...on.env, HOME: folder, XDG_STATE_HOME: '', STATE_DIRECTORY: '' };
    const child = spawn(PROGRAM, [url, '--wall', 'room', ...args], { env: { ...bare, ...env } });
    const player = { child, said: '' };
    const exit = new Promise((done) => child.once('exit', (code, signal) => done(code ?? signal)));
    for (const pipe of [child.stdout, child.stderr])
        pipe.on('data', (text) => { player.said += text; });
    player.stop = async (signal) => { child.kill(signal); return exit; };
    player.saying = (pattern, from = 0) => until(`${pattern}: ${player.said}`, () => pattern.exec(player.said.slice(from)));
    player.digits = async (from = 0) => (await player.saying(/shows the digits (\d{6}), good for (\d+) s/, from))[1];
    players.push(player);
    return player;
}

// The shares of black and of white, and in how many pieces the highest line of letters is: digits stand apart.
function look(on = display) {
    const { at, width, height } = on.grab(), isInk = (x, y) => at(x, y)[0] > 128;
    let black = 0, white = 0, all = 0, top = 0, bottom = 0;
    for (let y = 0, begin = 0; y < height; y++) {
        let ink = false;
        for (let x = 0; x < width; x += 2, all++) {
            const [r, g, b] = at(x, y);
            black += Math.max(r, g, b) < 8;
            white += Math.min(r, g, b) > 247;
            ink ||= r > 128;
        }
        if (!ink)
            begin = y + 1;
        else if (y - begin > bottom - top)
            [top, bottom] = [begin, y];
    }
    let pieces = 0, was = false;
    for (let x = 0; x < width; x++) {
        let now = false;
        for (let y = top; y <= bottom && !now; y++)
            now = isInk(x, y);
        pieces += now && !was;
        was = now;
    }
    return { black: black / all, white: white / all, pieces };
}

const showsDigits = ({ black, white, pieces }) => black > 0.8 && white > 0.008 && pieces === 6;
const showsPlant = ({ black }) => black < 0.3;
async function seen(what, good, on) {
    let last;
    await until(what, () => good(last = look(on)), 60).catch((error) => assert.fail(`${error.message}: ${JSON.stringify(last)}`));
}
const shoot = (name, on = display) => process.env.PLANTCAST_SHOTS === '1' && savePng(on.grab(), join(SCREENSHOTS, `${name}.png`));
const urlOf = ({ port }) => `http://127.0.0.1:${port}/`;

async function act(node, message, answered) {
    const client = await node.client({}, { token: engineer });
    client.say({ seq: 1, ...message });
    const answer = await client.text(answered);
    client.close();
    return answer;
}
const letIn = async (node, digits) => {
    const answer = await act(node, { type: 'pair', digits }, 'paired');
    assert.equal(answer.kept, true, JSON.stringify(answer));
    return answer.id;
};
async function restartCore() {
    const { port } = core;
    await core.stop('SIGKILL');
    core = await nodes.core(port);
}
const revoke = (node, id) => act(node, { type: 'unpair', id }, 'paired');

before(async () => {
    if (why)
        return;
    nodes = await Nodes.create();
    nodes.trustsLocal = false;
    appendFileSync(nodes.plant.file, WALLS);
    assert.equal(nodes.plant.prepare().code, 0);
    engineer = runProgram('plantcast', ['token', 'add', nodes.tokenFile, '--role', 'engineer', '--name', 'eve']).out.trim();
    [core, display] = await Promise.all([nodes.core(0), startDisplay(WIDTH, HEIGHT)]);
});
after(async () => {
    await Promise.all(players.map((player) => player.stop()));
    await display?.stop();
    await nodes?.destroy();
    rmSync(folder, { recursive: true, force: true });
});

const file = join(folder, 'display.token');
let player, id;

test('without a token it shows six digits; an engineer lets it in, and its secret is in the file, for it alone', options, async () => {
    player = startPlayer(urlOf(core), ['--token-file', file]);
    const digits = await player.digits();
    await seen('six digits', showsDigits);
    shoot('wall-player-digits');
    assert.equal(existsSync(file), false);
    id = await letIn(core, digits);
    await seen('the plant', showsPlant);
    assert.equal(id, 'room.1.1');
    assert.match(readFileSync(file, 'utf8'), /^pc_[0-9a-f]{64}\n$/);
    assert.equal(statSync(file).mode & 0o777, 0o600);
});

test('started again, it is let in without a word', options, async () => {
    await player.stop('SIGKILL');
    player = startPlayer(urlOf(core), ['--token-file', file]);
    await seen('nothing of it', ({ black }) => black > 0.99);
    await seen('the plant', showsPlant);
    assert.doesNotMatch(player.said, /digits/);
});

test('revoked, it is dark within 3 s and shows other digits, with another secret; they let it in again', options, async (t) => {
    const pace = new Pace(), secret = readFileSync(file, 'utf8'), from = player.said.length;
    t.after(() => pace.stop());
    await revoke(core, id);
    const begin = performance.now();
    await seen('dark', ({ black }) => black > 0.8);
    const ms = performance.now() - begin, { busy } = pace;
    assert.ok(ms < 3000 || busy, `${ms} ms`);
    const digits = await player.digits(from);
    await seen('six digits', showsDigits);
    assert.equal(readFileSync(file, 'utf8'), secret); // until there is another one
    id = await letIn(core, digits);
    await seen('the plant', showsPlant);
    assert.notEqual(readFileSync(file, 'utf8'), secret);
});

test('a token that somebody puts in the file ends the digits', options, async () => {
    const from = player.said.length;
    await revoke(core, id);
    await player.digits(from);
    const made = runProgram('plantcast', ['token', 'add', nodes.tokenFile, '--role', 'viewer', '--name', 'd1', '--display', 'room:1']);
    writeFileSync(file, made.out);
    await seen('the plant', showsPlant);
    assert.equal(readFileSync(file, 'utf8'), made.out);
});

test('while its server is away it says so and since when, in place of digits, and shows them again', options, async () => {
    await player.stop();
    const { port } = core, other = startPlayer(urlOf(core), ['--display', '2', '--language', 'ko']);
    await other.digits();
    await seen('six digits', showsDigits);
    await core.stop('SIGKILL');
    await seen('a card', ({ black, white, pieces }) => black > 0.7 && white > 0.03 && pieces !== 6);
    shoot('wall-player-digits-away');
    const from = other.said.length;
    core = await nodes.core(port);
    await seen('six digits', showsDigits);
    await letIn(core, await other.digits(from));
    await seen('the clock', showsPlant);
    const state = join(folder, '.local/state/plantcast');
    assert.deepEqual(readdirSync(state), [`127.0.0.1_${port}_room_2.token`]);
    assert.equal(statSync(join(state, readdirSync(state)[0])).mode & 0o777, 0o600);
    assert.equal(statSync(state).mode & 0o777, 0o700);
    assert.equal(await other.stop(), 0);
});

test('a file that is not its own to write keeps nothing: its secret is in the state folder, and stands before a revoked token', options,
    async () => {
        const made = runProgram('plantcast', ['token', 'add', nodes.tokenFile, '--role', 'viewer', '--name', 'd2', '--display', 'room:1']);
        const locked = '/proc/self/nothing/token', state = join(folder, 'service'); // where nobody may write, not root either
        mkdirSync(state);
        const env = { STATE_DIRECTORY: state }, first = startPlayer(urlOf(core), ['--token-file', locked], { env });
        await letIn(core, await first.digits());
        await seen('the plant', showsPlant);
        assert.deepEqual(readdirSync(state), [`127.0.0.1_${core.port}_room_1.token`]);
        await first.stop();
        const granted = join(folder, 'granted');
        writeFileSync(granted, made.out);
        runProgram('plantcast', ['token', 'revoke', nodes.tokenFile, 'd2']);
        await sleep(4000); // the daemon looks every 3 s
        const second = startPlayer(urlOf(core), ['--token-file', granted], { env });
        await seen('the plant', showsPlant);
        assert.equal(readFileSync(granted, 'utf8'), made.out);
        await second.stop();
    });

test('what cannot be let in says why: no such display, no plant, nobody, too many that wait', options, async () => {
    const refused = async (url, more, pattern, name) => {
        const it = startPlayer(url, more);
        await seen(name, ({ black, white, pieces }) => black > 0.7 && white > 0.0005 && pieces !== 6 && pieces > 0);
        if (pattern)
            await it.saying(pattern);
        shoot(name);
        await it.stop();
        await seen('nothing', ({ white }) => white === 0);
        assert.doesNotMatch(it.said, /shows the digits/);
    };
    await refused(urlOf(core), ['--display', '9'], null, 'wall-player-nowhere');
    const stranger = createServer((request, answer) => answer.writeHead(404).end('no'));
    await new Promise((done) => stranger.listen(0, '127.0.0.1', done));
    await refused(`http://127.0.0.1:${stranger.address().port}/`, ['--language', 'de'], /127\.0\.0\.1:\d+\/: /, 'wall-player-stranger');
    stranger.close();
    await refused('http://127.0.0.1:9/', [], /127\.0\.0\.1:9\/: /, 'wall-player-nobody');
    for (let i = 0; i < 8; i++) // as many as may wait from one address
        await fetch(`${urlOf(core)}api/v1/pair?wall=room`, { headers: { Authorization: `Pairing pc_${String(i).repeat(64)}` } });
    await refused(urlOf(core), [], null, 'wall-player-crowded');
    await restartCore();
});

test('a renderer shows the digits of its core, and lets it in', options, async () => {
    const renderer = await nodes.renderer('a', core), it = startPlayer(urlOf(renderer), []);
    const device = await letIn(renderer, await it.digits());
    await seen('the plant', showsPlant);
    const from = it.said.length;
    await revoke(core, device);
    await it.digits(from);
    await seen('six digits', showsDigits);
    await it.stop();
});

for (const language of ['en', 'ko', 'de'])
    test(`digits in ${language} fit a display of 1920x1080 and of 3840x2160, and one that stands upright`, options, async () => {
        await restartCore(); // so that nobody waits
        for (const [width, height] of [[1920, 1080], [3840, 2160], [1080, 1920]]) {
            const on = await startDisplay(width, height);
            const it = startPlayer(urlOf(core), ['--language', language], { on, env: { HOME: join(folder, `${language}${width}`) } });
            await it.digits();
            await seen('six digits', showsDigits, on);
            shoot(`wall-player-digits-${language}-${width}`, on);
            await it.stop();
            await on.stop();
        }
    });
