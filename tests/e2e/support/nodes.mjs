// SPDX-License-Identifier: GPL-3.0-or-later
// Starts several daemons for one plant on this machine: a core, which polls the device, and renderers, which get their readings
// from the core.
import { chmodSync, existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { openFiles } from './crowd.mjs';
import { PlainClient } from './plain_client.mjs';
import { freePort } from './ports.mjs';
import { Program, runProgram, TinyPlant } from './tiny_plant.mjs';
import { until } from './until.mjs';
export { setTimeout as sleep } from 'node:timers/promises';


export { until };

// Returns the names (socket:[INODE]) of the sockets that a process has open; an empty list if the process has ended.
function sockets(pid) {
    try {
        return openFiles(pid).filter((name) => name.startsWith('socket:'));
    } catch {
        return [];
    }
}

export class Node {
    // before: command prefix that starts the daemon; the daemon's path and arguments are appended.
    constructor(plant, args, file = plant.file, before = []) {
        this.program = new Program('plantcastd', [file, ...args], {}, before);
    }

    async ready() {
        const [, port] = await this.program.line(/ready https?:\/\/[\d.]+:(\d+)\/$/m);
        this.port = Number(port);
        return this;
    }

    get url() { return `ws://127.0.0.1:${this.port}`; }

    // seconds: limit for the answer
    async fetch(path, token = this.token, seconds = 60) {
        const headers = token ? { authorization: `Bearer ${token}` } : {};
        return fetch(`http://127.0.0.1:${this.port}${path}`, { headers, signal: AbortSignal.timeout(seconds * 1000) });
    }

    async tags(token) {
        const answer = await this.fetch('/api/v1/tags?count=9', token);
        return Object.fromEntries((await answer.json()).tags.map((tag) => [tag.name, tag]));
    }

    async metric(name, token) {
        const text = await (await this.fetch('/metrics', token)).text();
        return Number(text.split('\n').find((line) => line.startsWith(`${name} `))?.split(' ')[1]);
    }

    // Returns the active high alarm (kind H) of a tag, or undefined if there is none.
    async alarm(name = 'TI-1', token = this.token) {
        const { alarms } = await (await this.fetch('/api/v1/alarms', token)).json();
        return alarms?.find(({ tag, kind }) => tag === name && kind === 'H');
    }

    async client(options = {}, hello = {}) {
        const client = await PlainClient.open(this.port, options);
        client.welcome = await client.hello(hello);
        return client;
    }

    stop(signal) { return this.program.stop(signal); }
}

export class Nodes {
    // Makes a plant whose tags have high alarms at 90, and one token for each of the roles viewer, operator, renderer and
    // standby. slowDevice: the daemons tolerate slow answers of the device, for a busy machine.
    static async create({ slowDevice = false } = {}) {
        const nodes = new Nodes();
        nodes.plant = await TinyPlant.create();
        nodes.plant.addAlarms();
        if (slowDevice)
            nodes.plant.giveDeviceTime();
        const prepared = nodes.plant.prepare();
        if (prepared.code !== 0)
            throw new Error(prepared.err);
        nodes.tokenFile = join(nodes.plant.folder, 'tokens');
        nodes.tokens = {};
        for (const [role, name] of [['viewer', 'wall'], ['operator', 'anna'], ['renderer', 'r'], ['standby', 's']]) {
            const made = runProgram('plantcast', ['token', 'add', nodes.tokenFile, '--role', role, '--name', name]);
            nodes.tokens[role] = made.out.trim();
            nodes[`${role}File`] = join(nodes.plant.folder, `${role}.token`);
            writeFileSync(nodes[`${role}File`], nodes.tokens[role]);
        }
        chmodSync(nodes.tokenFile, 0o600);
        await nodes.plant.startSim();
        nodes.all = [];
        // true: daemons are started with --trust-local, so local connections have the role engineer; tests may change this
        nodes.trustsLocal = true;
        return nodes;
    }

    async start(args, file) {
        const local = this.trustsLocal && !args.includes('--behind-proxy') ? ['--trust-local'] : [];
        const node = new Node(this.plant, [...local, '--tokens', this.tokenFile, ...args], file);
        this.all.push(node);
        return node.ready();
    }

    // Starts the core on a port that no other program gets while the core is down.
    async core(port = 0, ...more) {
        return this.start(['--role', 'core', '--port', String(port || await freePort()), ...more]);
    }

    async renderer(name, cores, ...more) {
        const urls = [cores].flat().flatMap((core) => ['--core', core.url]);
        const at = more.includes('--port') ? [] : ['--port', String(await freePort())];
        return this.start(['--role', 'render', ...urls, '--core-token-file', this.rendererFile, '--node', name, ...at, ...more]);
    }

    // Returns the connections from these daemons to the device, as local addresses. Connections of other daemons are left out:
    // a daemon of another test may run on for a moment and poll a port that this test uses now.
    pollers() {
        const port = this.plant.modbusPort.toString(16).toUpperCase().padStart(4, '0'), established = '01';
        const ours = new Set(this.all.flatMap(({ program }) => sockets(program.child.pid)));
        const lines = ['/proc/net/tcp', '/proc/net/tcp6'].filter(existsSync).flatMap((path) => readFileSync(path, 'utf8').split('\n'));
        return lines.map((line) => line.trim().split(/\s+/)).filter(([, , remote, state, , , , , , inode]) =>
            remote?.endsWith(`:${port}`) && state === established && ours.has(`socket:[${inode}]`)).map(([, local]) => local);
    }

    // Waits until exactly one daemon is connected to the device. Fails if the same two connections are listed twice in a row. A
    // single list with two is no proof, because the system lists connections one by one and may include an ended connection
    // together with its successor.
    onePoller() {
        let before = [];
        return until('one poller', () => {
            const now = this.pollers(), both = now.filter((local) => before.includes(local));
            if (both.length > 1)
                throw new Error(`${both.length} pollers: ${both}`);
            before = now;
            return now.length === 1;
        });
    }

    async destroy() {
        const fault = this.all.map(({ program }) => program.fault).find(Boolean);
        for (const { program } of this.all)
            if (program.child.exitCode === null) {
                program.child.kill('SIGCONT');
                await program.stop('SIGKILL');
            }
        await this.plant.destroy();
        if (fault)
            throw new Error(fault);
    }
}
