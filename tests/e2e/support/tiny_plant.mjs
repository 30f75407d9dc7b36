// SPDX-License-Identifier: GPL-3.0-or-later
// A plant of two boxes and three tags in its own folder, prepared and served on free ports.
import { spawn, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { appendFileSync, chownSync, copyFileSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, renameSync, rmSync,
    writeFileSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';
import { faultOf } from './fault.mjs';
import './fetch.mjs';
import { gltfModel } from './gltf_model.mjs';
import { freePort } from './ports.mjs';
export { sleep };

export const BIN = resolve(process.env.PLANTCAST_BIN ?? 'build');
const NOBODY = 65534, DESCENDANT_MS = 2000;
export const PROGRAMS = ['plantcastd', 'plantcast-prep', 'plantcast-sim', 'plantcast'];
export const missing = () => PROGRAMS.filter((name) => !existsSync(join(BIN, name)));

// Returns why a test of the tiny plant is skipped, or false.
export const notBuilt = () => (missing().length > 0 ? `not built: ${missing().join(', ')}` : false);

// Returns a glTF of one box, one metre wide, deep and high, with separate corners for each face.
function facedBox() {
    const positions = [], normals = [], indices = [];
    for (let axis = 0; axis < 3; axis++) {
        for (const side of [-1, 1]) {
            const base = positions.length / 3, n = [0, 0, 0];
            n[axis] = side;
            for (const [u, v] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
                const p = [0, 0, 0];
                p[axis] = 0.5 * side;
                p[(axis + 1) % 3] = 0.5 * u * side;
                p[(axis + 2) % 3] = 0.5 * v;
                positions.push(...p);
                normals.push(...n);
            }
            indices.push(base, base + 1, base + 2, base, base + 2, base + 3);
        }
    }
    return JSON.stringify(gltfModel(positions, [{ name: 'box', mesh: 0 }], { indices, normals }));
}

const plantYaml = (port) => `plant:
  name: Two boxes
assets:
  - { id: E-101, model: box.gltf, description: warm }
  - { id: P-101A, model: box.gltf, placement: { translate: [3, 0, 0] } }
groups:
  - { id: temperature, quantity: Temperature, unit: °C, min: 0, max: 100 }
  - { id: pressure, quantity: Pressure, unit: bar, min: 0, max: 10, distance: euclidean }
sources:
  - { id: plc1, type: modbus, host: 127.0.0.1, port: ${port}, poll_ms: 100, timeout_ms: 300, byte_order: ABCD, address_base: 1 }
tags: tags.csv
`;
const TAGS = `Tag Name,Address,Data Type,Eng Units,Description,Group,Asset,X,Y,Z,Stale s
TI-1,400001,Float,°C,left,temperature,E-101,0.5,0,0,1
TI-2,400003,Float,°C,right,temperature,E-101,-0.5,0,0,1
PI-1,400005,Float,bar,pump,pressure,P-101A,3,0,0.5,1
`;
const BOXES = { 'E-101': 'TI-1,TI-2', 'P-101A': 'PI-1' }; // sensors on each asset of the plant, by the asset's name

// Runs a program that ends by itself: { code, out, err }.
export function runProgram(name, args, timeout = 120000) {
    const { status, stdout, stderr } = spawnSync(join(BIN, name), args, { encoding: 'utf8', timeout });
    return { code: status, out: stdout, err: stderr };
}

export class Program {
    // Both outputs go into one pipe, so that lines arrive in the order in which the program wrote them.
    constructor(name, args, as = {}, before = [], bin = BIN) {
        this.name = name;
        this.said = '';
        this.child = spawn('/bin/sh', ['-c', 'exec "$@" 2>&1', 'sh', ...before, join(bin, name), ...args],
            { stdio: ['ignore', 'pipe', 'inherit'], ...as });
        this.child.stdout.setEncoding('utf8').on('data', (text) => { this.said = (this.said + text).slice(-100000); });
        this.ended = this.end();
    }

    // Returns how the program ended, once its last output has been read; a surviving descendant would keep the pipe open.
    async end() {
        const closed = new Promise((done) => this.child.once('close', done));
        const [code, signal] = await new Promise((done) => this.child.once('exit', (...how) => done(how)));
        await Promise.race([closed, sleep(DESCENDANT_MS, null, { ref: false })]);
        this.isOver = true;
        return { code, signal };
    }

    async line(pattern, timeoutMs = 120000) {
        for (const end = performance.now() + timeoutMs; ;) {
            const found = this.said.match(pattern);
            if (found) {
                this.began = true;
                return found;
            }
            if (this.isOver || performance.now() > end)
                throw new Error(`no ${pattern} in:\n${this.said}`);
            await new Promise((done) => setTimeout(done, 20));
        }
    }

    async stop(signal = 'SIGTERM') {
        this.stopped = true;
        this.child.kill(signal);
        return this.ended;
    }

    get fault() {
        return faultOf(this.name, this.child, this.said, this.stopped || !this.began);
    }
}

// Copies a file atomically.
function copyWhole(from, to) {
    copyFileSync(from, `${to}.${process.pid}`);
    renameSync(`${to}.${process.pid}`, to);
}

export class TinyPlant {
    static async create() {
        const plant = new TinyPlant();
        plant.folder = mkdtempSync(join(tmpdir(), 'plantcast-tiny-'));
        plant.file = join(plant.folder, 'plant.yaml');
        plant.modbusPort = await freePort();
        writeFileSync(join(plant.folder, 'box.gltf'), facedBox());
        writeFileSync(plant.file, plantYaml(plant.modbusPort));
        writeFileSync(join(plant.folder, 'tags.csv'), TAGS);
        return plant;
    }

    // Returns a prepared plant whose simulator and daemon run, with one warm end and one cold end. fresh: gives readings and
    // the device more time, so that readings stay good on a busy machine.
    static async running({ fresh = false } = {}) {
        const plant = await TinyPlant.create();
        if (fresh)
            plant.keepFresh();
        await plant.start();
        await plant.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
        return plant;
    }

    // Prepares the plant, then starts its simulator, and its daemon with these arguments.
    async start(...args) {
        const { code, err } = this.prepare();
        if (code !== 0)
            throw new Error(`it cannot be prepared: ${err}`);
        await this.startSim();
        await this.startDaemon(...args);
    }

    // Sets values of tags in the simulator: { tag: value }.
    async set(values) {
        for (const [tag, value] of Object.entries(values))
            await this.tell(`set ${tag} ${value}`);
    }

    prepare() {
        this.takePrepared();
        const ended = runProgram('plantcast-prep', [this.file]), { own, shared } = this.openness();
        this.givePrepared();
        if (shared && existsSync(shared) && !existsSync(own))
            copyWhole(shared, own);
        return ended;
    }

    // Preparing the two boxes with their three sensors takes plantcast-prep a quarter of a second of processor time. All
    // programs of one run of tests/run share the first result, whose name is a hash of everything that it depends on.
    get prepared() { return join(this.folder, 'plant.prepared'); }
    takePrepared() {
        const shared = process.env.PLANTCAST_SHARED;
        if (!shared || existsSync(this.prepared))
            return;
        mkdirSync(this.prepared);
        for (const name of readdirSync(shared).filter((file) => /^box-\w+\.(asset|report\.json)$/.test(file)))
            copyFileSync(join(shared, name), join(this.prepared, name.slice('box-'.length)));
    }
    givePrepared() {
        const shared = process.env.PLANTCAST_SHARED, manifest = join(this.prepared, 'manifest.json');
        if (!shared || !existsSync(manifest))
            return;
        const { assets } = JSON.parse(readFileSync(manifest, 'utf8'));
        for (const { key } of assets.filter(({ id, tags }) => BOXES[id] === tags.join()))
            for (const name of [`${key}.report.json`, `${key}.asset`])
                if (!existsSync(join(shared, `box-${name}`)))
                    copyWhole(join(this.prepared, name), join(shared, `box-${name}`));
    }

    // Returns the folders of this plant's computed ambient openness: its own, and one that all programs of a run of tests/run
    // share. Computing it takes half of a daemon's start and always gives the same result for one prepared plant.
    openness() {
        const manifest = join(this.prepared, 'manifest.json');
        if (!process.env.PLANTCAST_SHARED || !existsSync(manifest))
            return {};
        const name = createHash('sha256').update(readFileSync(manifest)).digest('hex').slice(0, 16);
        return { own: join(this.prepared, 'openness'), shared: join(process.env.PLANTCAST_SHARED, `tiny-${name}`) };
    }

    // Adds `alarms: local` to the plant file, and a high limit of 90 to each tag.
    addAlarms() {
        const tags = join(this.folder, 'tags.csv');
        appendFileSync(this.file, 'alarms: local\n');
        writeFileSync(tags, readFileSync(tags, 'utf8').replace('Stale s', 'Stale s,H').replace(/,1$/gm, ',1,90'));
    }

    // Lets readings be 600 s old and the device answer late, so that no reading becomes stale or Bad on a busy machine.
    keepFresh() {
        const tags = join(this.folder, 'tags.csv');
        writeFileSync(tags, readFileSync(tags, 'utf8').replace(/,1$/gm, ',600'));
        this.giveDeviceTime();
    }

    giveDeviceTime() {
        writeFileSync(this.file, readFileSync(this.file, 'utf8').replace('timeout_ms: 300', 'timeout_ms: 5000'));
    }

    async startSim(...args) {
        this.controlPort = await freePort();
        this.sim = new Program('plantcast-sim', [this.file, '--control', String(this.controlPort), ...args]);
        await this.sim.line(/^plantcast-sim: (listening|publishing)/m);
    }

    // Runs the daemon as an unprivileged user from now on, like a service, because file permissions do not apply to root.
    disown() {
        if (process.getuid() !== 0)
            return;
        this.as = { uid: NOBODY, gid: NOBODY };
        for (const name of ['.', ...readdirSync(this.folder, { recursive: true })])
            chownSync(join(this.folder, name), NOBODY, NOBODY);
    }

    // From now on starts the daemon through another program, which gets the daemon's path and arguments.
    confine(...before) {
        this.before = before;
    }

    // Sends one line to the simulator; returns one line.
    tell(line) {
        return new Promise((done, fail) => {
            const socket = connect(this.controlPort, '127.0.0.1', () => socket.write(`${line}\n`));
            socket.once('data', (answer) => { socket.destroy(); done(answer.toString().trim()); });
            socket.on('error', fail);
        });
    }

    // Starts the daemon. Without --port it gets a port that stays reserved while the daemon is down, because another program
    // could take a port that the system chose.
    async startDaemon(...args) {
        const at = args.includes('--port') ? [] : ['--port', String(await freePort())];
        this.daemon = new Program('plantcastd', [this.file, ...at, ...args], this.as, this.before, this.bin);
        const [, port] = await this.daemon.line(/^plantcastd: ready https?:\/\/[\d.]+:(\d+)\/$/m);
        this.port = Number(port);
    }

    // Returns a number of /metrics; NaN: there is no such number.
    async metric(name, headers = {}) {
        const text = await (await fetch(`http://127.0.0.1:${this.port}/metrics`, { headers })).text();
        return Number(text.split('\n').find((line) => line.startsWith(`${name} `))?.split(' ').at(-1));
    }

    async destroy() {
        const programs = [this.daemon, this.sim].filter(Boolean), fault = programs.map((program) => program.fault).find(Boolean);
        for (const program of programs)
            if (program.child.exitCode === null)
                await program.stop('SIGKILL');
        const { own, shared } = this.openness();
        if (shared && existsSync(own) && !existsSync(shared))
            copyWhole(own, shared);
        rmSync(this.folder, { recursive: true, force: true });
        if (fault)
            throw new Error(fault);
    }
}

// Returns a plant with the interface of plant.mjs; the demo takes several times as much processor time to start and to draw.
// Its readings stay good on a busy machine and have a limit of 90. more: further lines of the plant file. flags: further
// arguments of the daemon. remember(plant): called before the daemon starts, to record an earlier history.
export async function startTiny(more = '', flags = [], remember = () => {}) {
    const plant = await TinyPlant.create(), tags = join(plant.folder, 'tags.csv'), port = await freePort();
    plant.addAlarms();
    writeFileSync(tags, readFileSync(tags, 'utf8').replace(/,1,90$/gm, ',60,90'));
    plant.giveDeviceTime();
    appendFileSync(plant.file, more);
    const startDaemon = () => plant.startDaemon('--port', String(port), ...flags);
    try {
        const { code, err } = plant.prepare();
        if (code !== 0)
            throw new Error(`it cannot be prepared: ${err}`);
        remember(plant);
        await plant.startSim();
        await plant.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
        await startDaemon();
    } catch (error) {
        await plant.destroy();
        throw error;
    }
    return {
        file: plant.file, url: `http://127.0.0.1:${port}/`, startDaemon,
        get pid() { return plant.daemon.child.pid; },
        async ask(line) {
            const answer = await plant.tell(line);
            if (!answer.startsWith('ok'))
                throw new Error(`${line}: ${answer}`);
            return answer.slice(2).trim();
        },
        stopDaemon: (signal) => plant.daemon.stop(signal),
        logged: (pattern) => plant.daemon.line(pattern),
        stop: () => plant.destroy(),
    };
}
