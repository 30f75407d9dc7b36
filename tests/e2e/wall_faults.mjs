// SPDX-License-Identifier: GPL-3.0-or-later
// Displays under what goes wrong around them: clocks of tiles that are 5 s apart; a player without EGL, without sound, with little memory.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { appendFileSync, existsSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, SCREENSHOTS } from './support/browser.mjs';
import { missingClocks, withClockOff } from './support/clocks.mjs';
import { residentKb, sanitized } from './support/crowd.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { BIN, missing, TinyPlant } from './support/tiny_plant.mjs';
import { missingDisplay, savePng, startDisplay } from './support/x_display.mjs';

const absent = missing(), PLAYER = join(BIN, 'plantcast-wall');
const options = { skip: absent.length > 0 ? `not built: ${absent.join(', ')}` : false, timeout: 240000 };
const noPlayer = options.skip || ((existsSync(PLAYER) ? null : 'not built: plantcast-wall') ?? missingDisplay() ?? false);
const [WIDTH, HEIGHT] = [640, 360], APART_S = 5, NEAR_MS = 2500, BLACK = 8;
const WALLS = `
views: [{ id: all, title: All, view: "group=temperature&camera=3.5,-7,1,1.5,0,0,0,0,1,30" }]
walls:
- { id: wide, tile: { columns: 2, rows: 1, views: all } }
- { id: room, displays: [{ grid: [main clock], panes: [{ area: main, views: all }, { area: clock, clock: yes }] }] }
`;
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
let plant;

before(async () => {
    if (options.skip)
        return;
    plant = await TinyPlant.create();
    plant.keepFresh();
    appendFileSync(plant.file, WALLS);
    assert.equal(plant.prepare().code, 0);
    await plant.startSim();
    await plant.startDaemon();
});
after(() => plant?.destroy());

const url = () => `http://127.0.0.1:${plant.port}/`;

// A player on a screen of its own: { screen, said(), stop }.
async function startPlayer(args, env = {}, starter = []) {
    const screen = await startDisplay(WIDTH, HEIGHT), [program, ...more] = [...starter, PLAYER, url(), ...args];
    const child = spawn(program, more, { env: { ...screen.env, ...env } });
    const gone = new Promise((done) => { child.once('exit', done); });
    let said = '';
    for (const pipe of [child.stdout, child.stderr])
        pipe.on('data', (text) => { said = (said + text).slice(-4000); });
    return { screen, pid: child.pid, said: () => said, async stop() {
        child.kill();
        const code = await gone;
        await screen.stop();
        return code;
    } };
}

// The share of a screen's pixels that are in colours, as the field is.
function coloured({ screen }) {
    const { at } = screen.grab();
    let count = 0, all = 0;
    for (let y = 2; y < HEIGHT; y += 4) {
        for (let x = 2; x < WIDTH - 180; x += 4, all++) { // without the legend
            const rgb = at(x, y);
            count += Math.max(...rgb) - Math.min(...rgb) > 60;
        }
    }
    return count / all;
}

async function until(player, what, is, ms = 60000) {
    for (const end = performance.now() + ms; !is(); await sleep(20)) {
        if (performance.now() > end) {
            savePng(player.screen.grab(), join(SCREENSHOTS, 'wall-faults-failed.png'));
            assert.fail(`${what}: ${coloured(player)}\n${player.said()}`);
        }
    }
}

const presents = (client) => client.texts.filter(({ type }) => type === 'present');
const camera = (seq, x) => ({ type: 'camera', seq, eye: [x, -7, 1], target: [x, 0, 0], up: [0, 0, 1], fov: 30 });

// The first tile, which leads and acknowledges at once.
async function leading() {
    const leader = await PlainClient.open(plant.port);
    await leader.hello({ width: WIDTH, height: HEIGHT, codecs: ['jpeg'], tile: { wall: 'wide', display: 1 } });
    await leader.until('the lead', () => leader.texts.some(({ type, leads }) => type === 'tiles' && leads));
    leader.say({ type: 'params', seq: 1, group: 'temperature' });
    return leader;
}

test('the page of a tile whose clock is 5 s ahead shows each picture at the server\'s time', options, async () => {
    const leader = await leading();
    const { page, close } = await openPage(`${url()}wall.html?wall=wide&display=2`, { viewport: { width: WIDTH, height: HEIGHT } }, () => {
        const { now } = Date, { timeOrigin } = performance;
        Date.now = () => now.call(Date) + 5000;
        Object.defineProperty(performance, 'timeOrigin', { value: timeOrigin + 5000 });
    });
    await page.waitForFunction(() => globalThis.wall?.panes[0]?.session?.picture, null, { timeout: 60000 });
    await page.evaluate(() => {
        globalThis.shown = [];
        globalThis.wall.panes[0].session.on('presented', ({ number }) => globalThis.shown.push({ number, at: Date.now() - 5000 }));
    });
    let late = [];
    for (let seq = 1; late.length < 3 && seq < 150; seq++, await sleep(400)) {
        leader.say(camera(seq, 1 + 0.02 * (seq % 50)));
        const shown = await page.evaluate(() => globalThis.shown);
        late = shown.flatMap(({ number, at }) => presents(leader).filter(({ picture }) => picture === number)
            .map(({ at_us: us }) => at - us / 1000));
    }
    assert.ok(late.length >= 3 && late.every((ms) => ms > -200), `${late}: none is shown before its time`);
    assert.ok(Math.min(...late) < NEAR_MS, `${late}`);
    await close();
    leader.close();
});

test('likewise the player, whose clock is 5 s behind', { ...options, skip: noPlayer || (missingClocks() ?? false) }, async () => {
    const leader = await leading(), player = await startPlayer(['--wall', 'wide', '--display', '2'], {}, withClockOff(-APART_S));
    leader.say(camera(1, 60)); // nothing is there
    await until(player, 'an empty picture', () => presents(leader).length > 0 && coloured(player) < 0.001);
    await sleep(3000);
    const late = [];
    for (let seq = 2; seq < 6; seq++) {
        const before = presents(leader).at(-1).picture, there = seq % 2 === 0;
        leader.say(camera(seq, there ? -0.8 : 60)); // the box stands on the second tile, or nowhere
        await leader.until('a picture', () => presents(leader).at(-1).picture > before);
        const told = presents(leader).find(({ picture }) => picture > before);
        await until(player, `picture ${seq}`, () => (coloured(player) > 0.01) === there);
        late.push(Date.now() - told.at_us / 1000);
    }
    assert.ok(Math.min(...late) < NEAR_MS, `${late} ms after it was to be shown`);
    assert.equal(await player.stop(), 0);
    leader.close();
});

test('without EGL, without sound and with little memory the player shows its wall', { ...options, skip: noPlayer }, async () => {
    const limit = sanitized ? [] : ['prlimit', `--as=${900 << 20}`]; // of addresses, most of them code and stacks of threads
    for (const name of ['libEGL.so.1', 'libEGL.so'])
        writeFileSync(join(plant.folder, name), 'no library');
    const player = await startPlayer(['--wall', 'room'], { SDL_VIDEO_X11_FORCE_EGL: '1', LD_LIBRARY_PATH: plant.folder,
        SDL_AUDIODRIVER: 'there-is-none' }, limit);
    await until(player, 'the plant', () => coloured(player) > 0.01);
    assert.match(player.said(), /x11, software, 640x360/);
    const kb = residentKb(player.pid);
    console.log(`# ${kb} kB`);
    assert.ok(sanitized || kb < 200 << 10, `${kb} kB`);
    const { at } = player.screen.grab();
    assert.ok(Math.max(...at(WIDTH - 20, HEIGHT / 2)) > BLACK, 'the clock beside it');
    assert.equal(await player.stop(), 0);
});
