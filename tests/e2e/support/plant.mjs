// SPDX-License-Identifier: GPL-3.0-or-later
// The demo plant on free ports: its simulated PLC with a control port, and the daemon.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { faultOf } from './fault.mjs';
import './fetch.mjs';
import { freePort } from './ports.mjs';
import { until } from './until.mjs';

export const BIN = resolve(process.env.PLANTCAST_BIN ?? 'build');
export const BUILD = resolve('build');
const DEMO = join(BUILD, 'demo');
const START_MS = 120000;

// Returns why this test cannot run on this machine, or null.
export function missing() {
    const needed = [join(BIN, 'plantcastd'), join(BIN, 'plantcast-sim'), join(DEMO, 'plant.yaml'), join(DEMO, 'plant.prepared')];
    const absent = needed.filter((path) => !existsSync(path));
    return absent.length > 0 ? `not built: ${absent.join(', ')}` : null;
}

// Starts a program and waits for a line of output that begins with `ready`; later output is kept for the report.
function start(program, args, ready) {
    const child = spawn(join(BIN, program), args, { stdio: ['ignore', 'pipe', 'pipe'] });
    let said = '';
    const exit = new Promise((done) => child.once('exit', done));
    const up = new Promise((done, fail) => {
        const timer = setTimeout(() => fail(new Error(`${program}: not ready after ${START_MS} ms\n${said}`)), START_MS);
        const hear = (chunk) => {
            said = (said + chunk).slice(-20000);
            if (said.split('\n').some((line) => line.startsWith(ready))) {
                clearTimeout(timer);
                done();
            }
        };
        child.stdout.on('data', hear);
        child.stderr.on('data', hear);
        exit.then((code) => {
            clearTimeout(timer);
            fail(new Error(`${program} ended with ${code}\n${said}`));
        });
    });
    let ending = false;
    const running = () => child.exitCode === null && child.signalCode === null;
    const end = async (signal) => {
        ending = true;
        child.kill(signal);
        await exit;
    };
    const fault = () => faultOf(program, child, said, ending);
    return up.then(() => ({ pid: child.pid, end, said: () => said, running, fault }));
}

// Sends one command line to the simulator's control port. Resolves with its answer, one line.
function ask(port, line) {
    return new Promise((done, fail) => {
        const socket = connect(port, '127.0.0.1', () => socket.write(`${line}\n`));
        let answer = '';
        socket.setEncoding('utf8');
        socket.on('data', (text) => {
            answer += text;
            if (!answer.endsWith('\n'))
                return;
            socket.destroy();
            if (answer.startsWith('ok'))
                done(answer.slice(2).trim());
            else
                fail(new Error(`${line}: ${answer.trim()}`));
        });
        socket.on('error', fail);
    });
}

// Makes a copy of the demo plant in which the source has this port; `more` is appended to the plant file. Returns the plant
// file's path.
function copyPlant(folder, modbusPort, more) {
    for (const name of readdirSync(DEMO)) {
        if (name !== 'plant.yaml' && !name.endsWith('.history')) // recorded history is not copied
            symlinkSync(join(DEMO, name), join(folder, name));
    }
    const text = readFileSync(join(DEMO, 'plant.yaml'), 'utf8');
    // Removes `simulated`, so that values count as measured; other tests cover simulated values. `more` may contain views and
    // walls that replace the demo's
    const bare = /^(views|walls):/m.test(more) ? text.replace(/\nviews:\n[^]*$/, '\n') : text;
    const moved = bare.replace(/^(\s+port:\s*)\d+/m, `$1${modbusPort}`).replace(/^\s+simulated: yes\n/m, '');
    if (moved === bare)
        throw new Error('the demo plant has no source with a port');
    writeFileSync(join(folder, 'plant.yaml'), moved + more);
    return join(folder, 'plant.yaml');
}

// Starts the demo plant. more: lines to append to the plant file. arrange(plant): called after the simulator has started and
// before the daemon does. flags: further arguments of the daemon.
export async function startPlant(more = '', arrange = () => {}, flags = []) {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-e2e-'));
    const [modbusPort, controlPort, httpPort] = [await freePort(), await freePort(), await freePort()];
    const file = copyPlant(folder, modbusPort, more);
    const startDaemon = () => start('plantcastd', [file, '--port', String(httpPort), ...flags], 'plantcastd: ready');
    let sim, daemon;
    const plant = {
        file,
        url: `http://127.0.0.1:${httpPort}/`,
        get pid() { return daemon.pid; },
        ask: (line) => ask(controlPort, line),
        stopDaemon: (signal) => daemon.end(signal),
        async startDaemon() {
            daemon = await startDaemon();
        },
        // Freezes each tag at its present value and waits until the daemon has read it twice: the first of these readings may
        // have been requested before the freeze. From then on no value changes by itself.
        async freeze(tags) {
            for (const tag of tags)
                await plant.ask(`set ${tag} ${await plant.ask(`get ${tag}`)}`);
            for (let reading = 0; reading < 2; reading++) {
                const since = Date.now();
                await until('a reading of each tag', async () => {
                    const asked = Date.now(), { tags: read } = await (await fetch(`${plant.url}api/v1/tags`)).json();
                    return read.every(({ value, age_ms: age }) => value === null || age <= asked - since);
                });
            }
        },
        async stop() {
            const fault = daemon?.fault() ?? sim?.fault();
            for (const process of [daemon, sim]) {
                if (process?.running())
                    await process.end('SIGTERM');
            }
            rmSync(folder, { recursive: true, force: true });
            if (fault)
                throw new Error(fault);
        },
    };
    try {
        sim = await start('plantcast-sim', [file, '--port', String(modbusPort), '--control', String(controlPort)], 'plantcast-sim:');
        await arrange(plant);
        await plant.startDaemon();
    } catch (error) {
        await plant.stop();
        throw error;
    }
    return plant;
}
