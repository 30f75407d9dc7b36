// SPDX-License-Identifier: GPL-3.0-or-later
// Measures how much later one tile of a wall shows a picture than another tile, in two browsers on two X screens. The picture
// shows a number: each box is one binary digit, visible or hidden, and both tiles show all digits. The test grabs the pixels of
// both screens, so it does not rely on what the programs report.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, afterEach, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { browserOn, SCREENSHOTS } from '../e2e/support/browser.mjs';
import { PlainClient } from '../e2e/support/plain_client.mjs';
import { setUp } from '../e2e/support/set_up.mjs';
import { missing, TinyPlant } from '../e2e/support/tiny_plant.mjs';
import { missingDisplay, savePng, startDisplay } from '../e2e/support/x_display.mjs';

const absent = missing();
const why = (absent.length > 0 ? `not built: ${absent.join(', ')}` : null) ?? missingDisplay();
const options = { skip: why ?? false, timeout: 240000 };
const [WIDTH, HEIGHT] = [640, 360], SPAN_M = 20, BITS = 5, PLACES_M = [1.2, 2.7, 4.2, 5.7, 7.2];
const FRAME_MS = 1000 / 30, CHANGE_MS = 200, CLOCK_MS = 5000;
const boxes = [-1, 1].flatMap((side) => PLACES_M.map((x, i) => ({ id: `${side < 0 ? 'L' : 'R'}${i}`, x: side * x })));
const screens = [], ending = [];
let plant;

setUp(options.skip, async () => {
    plant = await TinyPlant.create();
    writeFileSync(plant.file, `plant:
  name: Numbers
assets:
${boxes.map(({ id, x }) => `  - { id: ${id}, model: box.gltf, placement: { translate: [${x}, 0, 0] } }`).join('\n')}
groups: [{ id: temperature, quantity: Temperature, unit: °C, min: 0, max: 100 }]
sources:
  - { id: plc1, type: modbus, host: 127.0.0.1, port: ${plant.modbusPort}, poll_ms: 1000, byte_order: ABCD, address_base: 1 }
tags: tags.csv
views: [{ id: all, view: "group=temperature" }]
walls: [{ id: wall, tile: { columns: 2, rows: 1, views: all } }]
`);
    writeFileSync(join(plant.folder, 'tags.csv'),
        'Tag Name,Address,Data Type,Group,Asset,X,Y,Z\nTI-1,400001,Float,temperature,L0,0.5,0,0\n');
    await plant.start();
    screens.push(await startDisplay(WIDTH, HEIGHT), await startDisplay(WIDTH, HEIGHT));
});
afterEach(async () => {
    for (const end of ending.splice(0))
        await end();
});
after(async () => {
    for (const screen of screens)
        await screen.stop();
    await plant?.destroy();
});

// Opens the session that leads the wall. Its camera faces the row of boxes, one box per binary digit in each tile.
// client.tell(number) shows the number in Gray code: it hides the boxes of the digits that are 1, and shows those of the digits
// that are 0.
async function driver() {
    const client = await PlainClient.open(plant.port);
    await client.hello({ width: WIDTH, height: HEIGHT, codecs: ['jpeg'], tile: { wall: 'wall', display: 1 } });
    await client.until('the lead', () => client.texts.some(({ type, leads }) => type === 'tiles' && leads));
    client.leads = () => client.texts.filter(({ type }) => type === 'tiles').at(-1).leads;
    client.say({ type: 'camera', seq: 1, eye: [0, -50, 0], target: [0, 0, 0], up: [0, 0, 1], projection: 'orthographic',
        height_m: (SPAN_M * HEIGHT) / (2 * WIDTH) });
    client.seq = 0;
    ending.push(() => client.close());
    client.tell = (number) => {
        // Gray code: consecutive numbers differ in one digit only, so a screen grabbed while it changes shows one of the two
        // numbers and no third
        const gray = number ^ (number >> 1);
        client.say({ type: 'params', seq: ++client.seq, look: 'materials',
            hidden: boxes.filter((_, i) => gray >> (i % BITS) & 1).map(({ id }) => id) });
    };
    client.tell(0);
    return client;
}

// Returns the green values of the pixels at the digits' places on one screen. side: 0 left, 1 right tile; area: the tile's
// rectangle on its screen.
function digits(screen, side, area) {
    const { at } = screen.grab();
    return PLACES_M.map((m) => {
        const part = side === 0 ? 1 - m / (SPAN_M / 2) : m / (SPAN_M / 2);
        return at(area.x + part * area.width, area.y + 0.5 * area.height)[1];
    });
}

function reader(shown, hidden) {
    const middle = shown.map((light, i) => (light + hidden[i]) / 2), darker = shown.map((light, i) => light < hidden[i]);
    return (now) => {
        let gray = 0, number = 0;
        now.forEach((light, i) => { gray |= Number(light < middle[i] !== darker[i]) << i; });
        for (; gray; gray >>= 1)
            number ^= gray;
        return number;
    };
}

// Shows a new number every CHANGE_MS. Returns for each of the two screens a list { value, at }: the numbers seen and the time
// in ms at which each was first seen.
async function watch(name, client, areas, seconds) {
    const settle = async (number) => {
        client.tell(number);
        await sleep(2000);
        return areas.map((area, side) => digits(screens[side], side, area));
    };
    const differ = (one, other) => one.every((lights, side) => lights.every((light, i) => Math.abs(light - other[side][i]) > 10));
    // 0b10101 in Gray code is 0b11111: every box is hidden, while 0 hides none
    let shown = await settle(0), hidden = await settle(0b10101);
    for (const end = performance.now() + 60000; !differ(shown, hidden); hidden = await settle(0b10101)) {
        assert.ok(client.leads(), 'it leads no more: this machine is too busy to say how far apart tiles are');
        assert.ok(performance.now() < end, `no digits to be read: ${JSON.stringify([shown, hidden])}`);
        shown = await settle(0);
        for (const side of [0, 1])
            savePng(screens[side].grab(), join(SCREENSHOTS, `wall-skew-${name}-${side + 1}.png`));
    }
    const read = shown.map((light, side) => reader(light, hidden[side])), seen = [[], []];
    const begin = performance.now();
    let number = 1, next = begin;
    while (performance.now() - begin < seconds * 1000) {
        if (performance.now() >= next) {
            client.tell(number++ % (1 << BITS));
            next += CHANGE_MS;
        }
        for (const side of [0, 1]) {
            const value = read[side](digits(screens[side], side, areas[side])), at = performance.now();
            if (seen[side].at(-1)?.value !== value)
                seen[side].push({ value, at });
        }
        await sleep(1);
    }
    return seen;
}

// Returns, in ascending order, the times in ms between the appearance of each number on one screen and on the other.
function skews([left, right]) {
    const out = [];
    for (const { value, at } of left) {
        const other = right.filter((one) => one.value === value).map((one) => Math.abs(one.at - at)).sort((a, b) => a - b)[0];
        if (other < 800)
            out.push(other);
    }
    return out.sort((a, b) => a - b);
}

function judge(name, seen, seconds) {
    const all = skews(seen), part = (share) => all[Math.min(all.length - 1, Math.floor(share * all.length))];
    console.log(`# ${name}: ${(all.length / seconds).toFixed(1)} pictures a second on both; apart by ${part(0.5).toFixed(0)} ms (half), ${
        part(0.95).toFixed(0)} ms (95 of 100), ${all.at(-1).toFixed(0)} ms (worst)`);
    assert.ok(all.length > 20, `${all.length} pictures`);
    assert.ok(all.length > 0.9 * Math.max(...seen.map((one) => one.length)), 'what one shows the other shows');
    assert.ok(part(0.95) <= FRAME_MS, `${part(0.95)} ms apart`);
}

test('two browsers, one with a clock that is 5 s off', options, async () => {
    // the browsers start before the leading session, so that the leader need not wait for tiles that are still starting
    const url = `http://127.0.0.1:${plant.port}/wall.html?wall=wall&display=`;
    const open = await Promise.all(screens.map((screen, i) => browserOn(screen.name, 'about:blank', WIDTH, HEIGHT, i ? CLOCK_MS : 0)));
    ending.push(...open.map(({ close }) => close));
    const client = await driver();
    await Promise.all(open.map(({ page }, i) => page.goto(`${url}${i + 1}`)));
    const areas = await Promise.all(open.map(({ page }) => page.evaluate(async () => {
        while (!globalThis.wall?.panes[0]?.session?.picture)
            await new Promise((done) => { setTimeout(done, 100); });
        return { x: screenX + outerWidth - innerWidth, y: screenY + outerHeight - innerHeight, width: innerWidth, height: innerHeight };
    })));
    judge('browsers', await watch('browsers', client, areas, 10), 10);
});
