// SPDX-License-Identifier: GPL-3.0-or-later
// The player of a wall, on an X display of 1920x1080. First pictures that come 60 times a second, decoded in software on one core: how
// many are shown, and when. Then from a camera to the pixels that it changes, in the player and in chromium, in turn. Prints a JSON object
// per row. The display is looked at, not what programs say.
// SECONDS=8 by default. REALTIME=1: what is measured goes before whatever else runs (as root; with a few SECONDS only).
import { spawn, spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { connect, createServer } from 'node:net';
import { join } from 'node:path';
import { browserOn } from '../e2e/support/browser.mjs';
import { residentKb } from '../e2e/support/crowd.mjs';
import { PlainClient } from '../e2e/support/plain_client.mjs';
import { BIN, missing, startPlant } from '../e2e/support/plant.mjs';
import { cpuMs, family } from '../e2e/support/processes.mjs';
import { missingDisplay, savePng, startDisplay } from '../e2e/support/x_display.mjs';

const PLAYER = join(BIN, 'plantcast-wall'), [WIDTH, HEIGHT] = [1920, 1080], HZ = 60;
const SECONDS = Number(process.env.SECONDS) || 8, PICTURES = 60, STEP_RAD = Math.PI / 180, CAMERAS = 20;
const why = (existsSync(PLAYER) ? null : 'not built: plantcast-wall') ?? missing() ?? missingDisplay();
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const say = (what, value, unit, more = {}) => console.log(JSON.stringify({ name: `wall_${what}`, value, unit, ...more }));
const WALLS = `
views: [{ id: whole, view: "group=temperature" }]
walls:
- { id: room, displays: [{ grid: [a], panes: [{ area: a, views: [whole] }] }] }
- { id: tiled, tile: { columns: 2, rows: 1, views: whole } }
`;
const orbit = (turn) => ({ eye: [8 + 38 * Math.sin(turn), 6 - 38 * Math.cos(turn), 18], target: [8, 6, 4], up: [0, 0, 1], fov: 40 });

// Has this program, and all that it started, go before what else runs, or no more.
function goFirst(does) {
    for (const pid of process.env.REALTIME ? family(process.pid) : [])
        spawnSync('chrt', ['-a', ...(does ? ['-r', '-p', '1'] : ['-o', '-p', '0']), String(pid)]);
}

// Gives others a turn, before it goes first.
async function letOthers() {
    goFirst(false);
    await sleep(1000);
    goFirst(true);
}

function startPlayer(port, display, args, core = null) {
    const command = [PLAYER, `http://127.0.0.1:${port}/`, ...args, '--software'];
    const pinned = core === null ? command : ['taskset', '-c', String(core), ...command];
    const child = spawn(pinned[0], pinned.slice(1),
        { env: { ...process.env, DISPLAY: display.name, SDL_VIDEODRIVER: 'x11' }, stdio: ['ignore', 'pipe', 'inherit'] });
    const gone = new Promise((done) => { child.once('exit', done); });
    const how = new Promise((done) => { child.stdout.once('data', (text) => done(String(text).trim())); });
    return { pid: child.pid, how, stop: async () => { child.kill(); await gone; } };
}

const LINES = 8, STEP = 4; // of the rows that are looked at
// What is seen, as some hundred numbers: each that many pixels of some rows.
function look(display) {
    const seen = new Uint8Array(LINES * WIDTH / STEP);
    for (let line = 0, i = 0; line < LINES; line++) {
        const bytes = display.row(Math.floor(HEIGHT * (0.3 + 0.05 * line)));
        for (let x = 0; x < WIDTH; x += STEP, i++)
            seen[i] = bytes[4 * x + 1];
    }
    return seen;
}

function difference(one, other) {
    let count = 0;
    for (let i = 0; i < one.length; i++)
        count += Math.abs(one[i] - other[i]) > 6;
    return count / one.length;
}

// What is seen once it is another picture and stands still.
async function settled(display, before) {
    let now = look(display);
    for (const end = performance.now() + 10000; difference(now, before) < 0.01 && performance.now() < end; now = look(display))
        await sleep(5);
    for (let last = null; !last || difference(now, last) > 0; await sleep(60))
        [last, now] = [now, look(display)];
    return now;
}

// --- 60 pictures a second

// Between the player and its server: passes everything on, until it plays in a session what was recorded.
class PlayerProxy {
    static async open(to) {
        const between = Object.assign(new PlayerProxy(), { pane: null, hello: null, asked: {}, played: false });
        between.server = createServer((near) => {
            const far = connect(to, '127.0.0.1'), own = { near, far };
            let rest = Buffer.alloc(0);
            near.setNoDelay(true);
            const plays = () => between.played && between.pane === own;
            near.on('data', (bytes) => {
                if (!plays())
                    far.write(bytes);
                rest = hear(Buffer.concat([rest, bytes]), (message) => between.take(own, message));
            });
            far.on('data', (bytes) => plays() || near.write(bytes)).on('error', () => {}).on('close', () => plays() || near.destroy());
            near.on('error', () => {}).on('close', () => far.destroy());
        });
        await new Promise((done) => between.server.listen(0, '127.0.0.1', done));
        between.port = between.server.address().port;
        return between;
    }

    take(own, message) {
        if (message.type === 'hello' && message.width > 16)
            Object.assign(this, { pane: own, hello: message, asked: {} });
        if (this.pane === own)
            this.asked[message.type] = message;
    }

    // opcode: 1 text, 2 binary.
    send(opcode, body) {
        const head = Buffer.from([0x80 | opcode, 127, 0, 0, 0, 0, 0, 0, 0, 0]);
        head.writeBigUInt64BE(BigInt(body.length), 2);
        this.pane.near.write(Buffer.concat([head, body]));
    }

    close() {
        this.pane?.near.destroy();
        this.server.close();
    }
}

// Calls back with the JSON messages of a client; returns what is left over. The request before them ends with an empty line.
function hear(bytes, heard) {
    for (let at = bytes.subarray(0, 4).toString() === 'GET ' ? bytes.indexOf('\r\n\r\n') + 4 : 0;;) {
        let length = bytes[at + 1] & 127, body = at + 6;
        if (at === 3 || bytes.length < at + 14)
            return bytes.subarray(at === 3 ? 0 : at);
        if (length === 126)
            [length, body] = [bytes.readUInt16BE(at + 2), at + 8];
        if (bytes.length < body + length)
            return bytes.subarray(at);
        if ((bytes[at] & 15) === 1) {
            const text = Buffer.from(bytes.subarray(body, body + length).map((byte, i) => byte ^ bytes[body - 4 + (i & 3)]));
            heard(JSON.parse(text));
        }
        at = body + length;
    }
}

const isKey = ([[, message]]) => message[2] & 1;

// [[[opcode, message], ...], ...]: what a session was sent for each picture of a camera that orbits, the first a key frame.
async function record(port, hello, params) {
    const client = await PlainClient.open(port), pictures = [];
    const take = client.onMessage;
    client.onMessage = function keep(message) {
        if (this.opcode === 2)
            pictures.push([]);
        pictures.at(-1)?.push([this.opcode, Buffer.from(message)]);
        take.call(this, message);
    };
    await client.hello({ ...hello, codecs: ['h264'] });
    client.say(params);
    await client.frameWhere('its first picture', ({ params_seq: seq }) => seq >= params.seq);
    for (let i = 0; pictures.length < PICTURES; i++) { // it never rests, so none is refined
        client.say({ type: 'camera', seq: 2 + i, ...orbit(i * STEP_RAD) });
        if (i === 5) {
            pictures.length = 0;
            client.say({ type: 'key_frame' });
            await client.until('a key frame', () => pictures.some(isKey));
            pictures.splice(0, pictures.findIndex(isKey));
        }
        await sleep(40);
    }
    client.close();
    return pictures.slice(0, PICTURES);
}

// What each picture looks like, slowly.
async function learn(display, play) {
    const known = [];
    for (let i = 0; i < PICTURES; i++) {
        if (i % 15 === 0)
            await letOthers();
        const before = look(display);
        play(i);
        known.push(await settled(display, before));
    }
    goFirst(false);
    return known;
}

async function measurePlayer(plant, display) {
    const port = Number(new URL(plant.url).port), between = await PlayerProxy.open(port);
    const player = startPlayer(between.port, display, ['--wall', 'room'], 0);
    let heard;
    try {
        for (const end = performance.now() + 60000; !between.asked.camera || !between.asked.params; await sleep(50)) {
            if (performance.now() > end)
                throw new Error('the player asks for nothing');
        }
        const pictures = await record(port, between.hello, between.asked.params);
        await sleep(1000);
        between.played = true;
        heard = setInterval(() => between.send(1, Buffer.from('{"type":"pong","t":0}')), 500);
        let seq = 1e6;
        const play = (i) => {
            for (const [opcode, message] of pictures[i]) {
                if (opcode === 2) {
                    message.writeUInt32LE(++seq, 8);
                    message.writeUInt32LE(between.asked.camera.seq, 12);
                    message.writeUInt32LE(between.asked.params.seq, 16);
                }
                between.send(opcode, message);
            }
        };
        let known = await learn(display, play);
        for (let i = 0, again; i < 4 && !again?.every((one, k) => difference(one, known[k]) < 0.01); i++)
            [known, again] = [again ?? known, await learn(display, play)]; // on a busy machine one was missed
        if (process.env.PICTURE)
            savePng(display.grab(), process.env.PICTURE);
        const shown = await watch(display, known, play, player.pid);
        judge(await player.how, shown, residentKb(player.pid));
    } finally {
        clearInterval(heard);
        between.close();
        await player.stop();
    }
}

// [{ picture, sent, seen }, ...] of all that were sent; seen: undefined if it was not.
async function watch(display, known, play, pid) {
    const sent = [];
    let last = look(display);
    goFirst(true);
    const begin = performance.now(), before = cpuMs(pid), end = begin + 1000 * SECONDS;
    for (let now = begin; now < end + 300; now = performance.now()) {
        for (; now < end && now >= begin + sent.length * 1000 / HZ;) {
            sent.push({ picture: sent.length % PICTURES, sent: performance.now() });
            play(sent.at(-1).picture);
        }
        await sleep(1);
        const seen = look(display), at = performance.now();
        if (difference(seen, last) < 0.01)
            continue;
        last = seen;
        const newest = sent.slice(-12).map((one) => [one, difference(seen, known[one.picture])]).sort((a, b) => a[1] - b[1])[0];
        if (newest?.[1] < 0.02)
            newest[0].seen ??= at;
    }
    const cpu = (cpuMs(pid) - before) / sent.length;
    goFirst(false);
    // Another could not be told from the one before.
    const isNew = (i) => difference(known[i], known[(i + PICTURES - 1) % PICTURES]) > 0.02;
    return { sent: sent.filter((one) => isNew(one.picture)), cpu };
}

const parts = (list) => {
    const all = list.toSorted((a, b) => a - b);
    const at = (share) => Number(all[Math.min(all.length - 1, Math.floor(share * all.length))]?.toFixed(1));
    return { half: at(0.5), p95: at(0.95), worst: at(1) };
};

function judge(how, { sent, cpu }, kb) {
    const seen = sent.filter((one) => one.seen), late = parts(seen.map((one) => one.seen - one.sent));
    const note = how.replace(/^plantcast-wall: /, '');
    say('1080p60_shown_percent', Number((100 * seen.length / sent.length).toFixed(1)), '%', { goal: ['>=', 99], note });
    say('1080p60_cpu_ms', Number(cpu.toFixed(1)), 'ms of a processor', { goal: ['<=', 1000 / HZ] });
    say('1080p60_received_to_shown_ms', late.half, 'ms', { p95: late.p95, note: `worst ${late.worst}` });
    say('1080p60_mb', Math.round(kb / 1024), 'MB');
}

// --- from a camera to pixels

async function leader(port) {
    const client = await PlainClient.open(port);
    await client.hello({ width: WIDTH, height: HEIGHT, codecs: ['h264'], tile: { wall: 'tiled', display: 1 } });
    await client.until('the lead', () => client.texts.some(({ type, leads }) => type === 'tiles' && leads));
    client.seq = 0;
    client.look = (turn) => client.say({ type: 'camera', seq: ++client.seq, ...orbit(turn) });
    return client;
}

// Milliseconds from each camera to the first pixels that it changed.
async function delays(client, display) {
    const out = [];
    for (let i = 0; i < CAMERAS; i++) {
        if (i % 5 === 0)
            await letOthers();
        client.look(0.3 * (i % 2));
        await sleep(900 + 37 * (i % 7)); // until it is refined, and not in step with what is drawn
        const before = look(display), begin = performance.now();
        client.look(0.3 * ((i + 1) % 2));
        while (difference(look(display), before) < 0.1) {
            await sleep(1);
            if (performance.now() > begin + 5000)
                throw new Error('no pixels change');
        }
        out.push(performance.now() - begin);
    }
    goFirst(false);
    return out;
}

async function measureDelays(plant, display) {
    const port = Number(new URL(plant.url).port), all = { player: [], chromium: [] };
    const open = {
        async player() {
            return startPlayer(port, display, ['--wall', 'tiled']).stop;
        },
        async chromium() {
            return (await browserOn(display.name, `http://127.0.0.1:${port}/wall.html?wall=tiled&display=1`, WIDTH, HEIGHT)).close;
        },
    };
    for (const name of ['player', 'chromium', 'player', 'chromium']) {
        const client = await leader(port), close = await open[name]();
        try {
            const dark = look(display);
            client.look(0);
            for (const end = performance.now() + 30000; difference(look(display), dark) < 0.3 && performance.now() < end;)
                await sleep(100);
            await sleep(4000);
            if (process.env.PICTURE)
                savePng(display.grab(), `${process.env.PICTURE}-${name}.png`);
            all[name].push(...await delays(client, display));
        } finally {
            client.close();
            await close();
        }
    }
    for (const [name, list] of Object.entries(all)) {
        const { half, p95, worst } = parts(list);
        say(`input_to_photon_${name}_ms`, half, 'ms', { p95, note: `worst ${worst}` });
    }
}

if (why) {
    say('1080p60_shown_percent', null, '%', { why });
} else {
    const plant = await startPlant(WALLS), display = await startDisplay(WIDTH, HEIGHT);
    const part = async (name, unit, run) => {
        try {
            await run(plant, display);
        } catch (error) {
            say(name, null, unit, { why: String(error.message ?? error).split('\n')[0] });
        }
    };
    await part('1080p60_shown_percent', '%', measurePlayer);
    await part('input_to_photon_player_ms', 'ms', measureDelays);
    await display.stop();
    await plant.stop();
}
