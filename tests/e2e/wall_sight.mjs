// SPDX-License-Identifier: GPL-3.0-or-later
// The place of an alarm that something stands before, in the player of a wall's displays: it is shown from another side, or through what
// stands before it from all of them; also to a display that has a token for itself alone.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { chmodSync, existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { SCREENSHOTS } from './support/browser.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { BIN, missing, runProgram, TinyPlant } from './support/tiny_plant.mjs';
import { missingDisplay, savePng, startDisplay } from './support/x_display.mjs';

const PLAYER = join(BIN, 'plantcast-wall'), absent = [...missing(), ...(existsSync(PLAYER) ? [] : ['plantcast-wall'])];
const why = absent.length > 0 ? `not built: ${absent.join(', ')}` : missingDisplay();
const [WIDTH, HEIGHT] = [640, 360], TOP = 40;
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
let plant, operator, screen, player, gone;

before(async () => {
    if (why)
        return;
    plant = await TinyPlant.create();
    plant.addAlarms();
    const tags = join(plant.folder, 'tags.csv'), tokens = join(plant.folder, 'tokens'), token = join(plant.folder, 'token');
    writeFileSync(tags, readFileSync(tags, 'utf8').replace(/,1,90$/gm, ',600,90'));
    const yaml = readFileSync(plant.file, 'utf8').replace('timeout_ms: 300', 'timeout_ms: 10000');
    // TI-1 is on the side of E-101 that WALL hides, TI-2 on the other, within HUT.
    const box = `  - { id: WALL, model: box.gltf, placement: { translate: [1.4, 0, 0.3] } }
  - { id: HUT, model: box.gltf, placement: { translate: [-0.65, 0, 0], scale: 0.6 } }`;
    writeFileSync(plant.file, `${yaml.replace('groups:', `${box}\ngroups:`)}
views: [{ id: pump, view: "group=temperature&camera=3,-9,1,3,0,0,0,0,1,20" }]
walls: [{ id: room, displays: [{ grid: [main], panes: [{ area: main, views: pump, on_alarm: yes }] }] }]
`);
    const made = runProgram('plantcast', ['token', 'add', tokens, '--role', 'viewer', '--name', 'one', '--display', 'room:1']);
    writeFileSync(token, made.out);
    operator = runProgram('plantcast', ['token', 'add', tokens, '--role', 'operator', '--name', 'kim']).out.trim();
    chmodSync(tokens, 0o600);
    assert.equal(plant.prepare().code, 0);
    await plant.startSim();
    await plant.startDaemon('--tokens', tokens);
    for (const [tag, value] of [['TI-1', 50], ['TI-2', 50], ['PI-1', 5]])
        await plant.tell(`set ${tag} ${value}`);
    screen = await startDisplay(WIDTH, HEIGHT);
    player = spawn(PLAYER, [`http://127.0.0.1:${plant.port}/`, '--wall', 'room', '--token-file', token],
        { env: { ...process.env, DISPLAY: screen.name, SDL_VIDEODRIVER: 'x11' }, stdio: ['ignore', 'ignore', 'inherit'] });
    gone = new Promise((done) => { player.once('exit', done); });
});
after(async () => {
    player?.kill();
    await gone;
    await screen?.stop();
    await plant?.destroy();
});

// Of the middle of the room beside the legend: the share of colours of the field, and of grays that are no background.
function middle() {
    const { at } = screen.grab(), count = { coloured: 0, gray: 0, all: 0 };
    for (let y = TOP + 0.3 * (HEIGHT - TOP); y < TOP + 0.7 * (HEIGHT - TOP); y += 3) {
        for (let x = 0.25 * WIDTH; x < 0.5 * WIDTH; x += 3) {
            const [r, g, b] = at(x, y), spread = Math.max(r, g, b) - Math.min(r, g, b);
            count.coloured += spread > 50;
            count.gray += spread < 20 && g < 200;
            count.all++;
        }
    }
    return { coloured: count.coloured / count.all, gray: count.gray / count.all };
}

async function until(what, is) {
    for (const end = performance.now() + 60000; !is(middle()); await sleep(50)) {
        if (performance.now() > end) {
            savePng(screen.grab(), join(SCREENSHOTS, 'wall-sight-failed.png'));
            assert.fail(`${what}: ${JSON.stringify(middle())}`);
        }
    }
}

const options = { skip: why ?? false, timeout: 240000 };
const left = () => Array.from({ length: 10 }, (_, x) => screen.grab().at(x, HEIGHT / 2));
const isCalled = () => left().some(([r, g]) => r > 150 && g < 60); // by its frame
async function untilCalled(is = true) {
    for (const end = performance.now() + 60000; isCalled() !== is; await sleep(100))
        assert.ok(performance.now() < end, is ? 'no alarm calls' : 'an alarm calls');
}
const shot = (name) => process.env.PLANTCAST_SHOTS === '1' && savePng(screen.grab(), join(SCREENSHOTS, `${name}.png`));

test('the place of an alarm is shown from a side where nothing stands before it', options, async () => {
    await until('the view', ({ coloured }) => coloured < 0.5);
    await plant.tell('set TI-1 95');
    await untilCalled();
    await until('its place', ({ coloured, gray }) => coloured > 0.4 && gray < 0.2);
    await sleep(500);
    assert.ok(middle().coloured > 0.4);
    shot('wall-sight');
    await plant.tell('set TI-1 50');
    const crew = await PlainClient.open(plant.port, { host: 'localhost' });
    await crew.hello({ token: operator });
    for (let seq = 1; isCalled() && seq < 100; seq++, await sleep(300))
        crew.say({ type: 'alarm', seq, action: 'acknowledge', alarms: [['TI-1', 'H']] });
    crew.close();
    await untilCalled(false);
});

test('where something does from all sides, it is seen through', options, async () => {
    await plant.tell('set TI-2 95');
    await untilCalled();
    await until('its place, within the hut', ({ coloured }) => coloured > 0.4);
    await sleep(1000);
    assert.ok(middle().coloured > 0.4);
    shot('wall-sight-through');
});
