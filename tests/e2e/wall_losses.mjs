// SPDX-License-Identifier: GPL-3.0-or-later
// A display of a wall whose server is killed again and again: it says so, shows no old picture as new, and comes back each time.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { appendFileSync, chmodSync, existsSync, writeFileSync } from 'node:fs';
import { connect, createServer } from 'node:net';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, SCREENSHOTS, shoot } from './support/browser.mjs';
import { Pace, residentKb, sanitized } from './support/crowd.mjs';
import { sweep } from './support/sweep.mjs';
import { BIN, missing, runProgram, startTiny, TinyPlant } from './support/tiny_plant.mjs';
import { missingDisplay, savePng, startDisplay } from './support/x_display.mjs';

const lacking = missing(), why = lacking.length > 0 && `not built: ${lacking.join(', ')}`;
const LOSSES = Number(process.env.LOSSES) || sweep(3, 2);
const options = { skip: why, timeout: 240000 + LOSSES * 60000 };
const WALLS = `
views:
- { id: whole, title: Whole unit, view: "group=temperature" }
walls:
- id: room
  displays:
  - grid: [main tiles]
    panes:
    - { area: main, views: [whole] }
    - { area: tiles, tiles: [TI-1, PI-1] }
`;
let plant, wall;

before(async () => {
    if (why)
        return;
    plant = await startTiny(WALLS);
    wall = await openPage(`${plant.url}?wall=room`, { viewport: { width: 640, height: 360 } });
});
after(async () => {
    await wall?.close();
    await plant?.stop();
});

// Of when the pane's picture and the words beside it are, by this connection.
const shown = () => wall.page.evaluate(() => {
    const inner = document.querySelector('.pane.views iframe')?.contentWindow.plantcast?.session, { session } = globalThis.wall;
    return { picture: inner?.isCurrent ? inner.picture?.dataTimeUs ?? 0 : 0, words: session.isCurrent ? session.freshAt : 0 };
});
const live = (since) => wall.page.waitForFunction(([picture, words]) => {
    const inner = document.querySelector('.pane.views iframe')?.contentWindow.plantcast?.session, { session } = globalThis.wall;
    return document.getElementById('lost').hidden && inner?.isCurrent && inner.picture?.dataTimeUs > picture && session.isCurrent &&
        session.freshAt > words;
}, [since.picture, since.words], { polling: 200 });

test(`${LOSSES} losses: each is said, and ends by itself`, options, async (t) => {
    const pace = new Pace();
    t.after(() => pace.stop());
    await wall.page.waitForFunction(() => globalThis.wall?.panes.length > 0); // until then it is another page
    await live({ picture: 0, words: 0 });
    let slowest = 0;
    for (let i = 0; i < LOSSES; i++) {
        const before = await shown();
        await plant.stopDaemon('SIGKILL');
        const lost = Date.now();
        await wall.page.locator('#lost').waitFor({ state: 'visible' });
        slowest = Math.max(slowest, Date.now() - lost);
        if (i === 0)
            await shoot(wall.page, 'wall-lost');
        await plant.startDaemon();
        await live(before);
    }
    console.log(`# said after ${slowest} ms at most`);
    pace.hold(t, 'until it is said', slowest, 10000);
    assert.deepEqual(wall.errors, []);
});

// --- the player ------------------------------------------------------------------------------------------------------------

// Between the player and its server: a network that is lost and comes back.
class Network {
    static async open(to) {
        const network = Object.assign(new Network(), { pairs: new Set(), there: true, bytes: 0 });
        network.server = createServer((near) => {
            if (!network.there)
                return near.destroy();
            const far = connect(to, '127.0.0.1'), pair = [near, far];
            network.pairs.add(pair);
            near.pipe(far);
            far.pipe(near);
            far.on('data', ({ length }) => { network.bytes += length; });
            for (const one of pair)
                one.on('error', () => {}).on('close', () => { pair.forEach((other) => other.destroy()); network.pairs.delete(pair); });
            return undefined;
        });
        await new Promise((done) => network.server.listen(0, '127.0.0.1', done));
        network.port = network.server.address().port;
        return network;
    }

    lose() {
        this.there = false;
        for (const pair of this.pairs)
            pair.forEach((one) => one.destroy());
    }

    find() {
        this.there = true;
        this.bytes = 0;
    }

    close() {
        this.lose();
        this.server.close();
    }
}

const PLAYER = join(BIN, 'plantcast-wall'), CUTS = Number(process.env.LOSSES) || sweep(200, 3);
const absent = [...lacking, ...(existsSync(PLAYER) ? [] : ['plantcast-wall'])];
const none = absent.length > 0 ? `not built: ${absent.join(', ')}` : missingDisplay();
test(`the player: ${CUTS} losses; and one whose token ends meanwhile shows nothing again`,
    { skip: none ?? false, timeout: 120000 + CUTS * 30000 }, async (t) => {
        const [width, height] = [640, 360], tiny = await TinyPlant.create();
        const file = join(tiny.folder, 'tokens'), mine = join(tiny.folder, 'mine');
        appendFileSync(tiny.file, `views: [{ id: all, view: "group=temperature" }]
walls: [{ id: room, displays: [{ grid: [a], panes: [{ area: a, views: [all] }] }] }]
`);
        const { out } = runProgram('plantcast', ['token', 'add', file, '--role', 'viewer', '--name', 'one', '--display', 'room:1']);
        writeFileSync(mine, out);
        chmodSync(file, 0o600);
        assert.equal(tiny.prepare().code, 0);
        await tiny.startSim();
        await tiny.startDaemon('--tokens', file);
        const network = await Network.open(tiny.port), screen = await startDisplay(width, height);
        const player = spawn(PLAYER, [`http://127.0.0.1:${network.port}/`, '--wall', 'room', '--token-file', mine],
            { env: screen.env, stdio: 'ignore' });
        const gone = new Promise((done) => { player.once('exit', done); });
        const black = () => {
            const { at } = screen.grab();
            let count = 0, colours = 0;
            for (let x = 2; x < width; x += 5)
                for (let y = 2; y < height; y += 5) {
                    const [r, g, b] = at(x, y);
                    count += Math.max(r, g, b) < 8;
                    colours += Math.max(r, g, b) - Math.min(r, g, b) > 60;
                }
            return { dark: count > 0.5 * (width / 5) * (height / 5), colours };
        };
        const until = async (what, is, ms = 120000) => {
            for (const end = performance.now() + ms; !is(); await new Promise((done) => setTimeout(done, 20)))
                if (performance.now() > end) {
                    savePng(screen.grab(), join(SCREENSHOTS, 'wall-losses-failed.png'));
                    assert.fail(`${what}: ${JSON.stringify(black())}`);
                }
        };
        try {
            const shows = () => !black().dark && black().colours > 50;
            await until('a picture', shows);
            let had = 0;
            for (let i = 0; i < CUTS; i++) {
                network.lose();
                await until('connections end', () => network.pairs.size === 0);
                network.find();
                await until(`pictures after loss ${i + 1}`, () => network.bytes > 5000 && network.pairs.size > 1);
                if (i === Math.min(20, CUTS - 1))
                    had = residentKb(player.pid);
            }
            await until('a picture in the end', shows);
            const has = residentKb(player.pid);
            console.log(`# ${CUTS} losses: ${had} kB, then ${has} kB`);
            assert.ok(had > 0 && network.pairs.size > 0);
            assert.ok(sanitized || has < 1.1 * had + 4096, `${had} kB, then ${has} kB`);
            const pace = new Pace(), begun = performance.now();
            t.after(() => pace.stop());
            network.lose();
            await until('it says so', () => black().dark);
            const dark = performance.now() - begun; // 3 s, and how late a busy machine is with it
            console.log(`# dark ${Math.round(dark)} ms after the loss`);
            pace.hold(t, 'until it is dark', dark, 10000);
            assert.equal(runProgram('plantcast', ['token', 'revoke', file, 'one']).code, 0);
            await tiny.daemon.line(/tokens \S+: 0$/m);
            network.find();
            await until('it was refused', () => network.bytes > 100);
            for (let i = 0; i < 40; i++, await new Promise((done) => setTimeout(done, 100)))
                assert.ok(black().dark && black().colours < 50, 'nothing of the plant is shown again');
        } finally {
            player.kill();
            await gone;
            network.close();
            await screen.stop();
            await tiny.destroy();
        }
    });
