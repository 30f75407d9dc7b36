// SPDX-License-Identifier: GPL-3.0-or-later
// Two cores of one plant, each with its own network, whose links to the other core and to the database can be cut; and a tap
// before the device that records who polls, and when.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Network } from './network_thread.mjs';
import { Node, Nodes, sleep, until } from './nodes.mjs';
import { freePort } from './ports.mjs';
import { missingPostgres, PostgresServer } from './postgres_server.mjs';
import { promise } from './promise.mjs';
import { missing, runProgram } from './tiny_plant.mjs';

export const TAKE_OVER_MS = 5000;
// address from which each core connects to the other one, so that tests/faults/late_peer.c can delay just these connections
export const STANDBY_HOST = '127.0.0.9';

// Returns why these tests cannot run on this machine; false: they can.
export function missingTwoCores() {
    const absent = missing();
    if (absent.length > 0)
        return `not built: ${absent.join(', ')}`;
    const canMount = process.getuid() === 0 && spawnSync('unshare', ['--mount', 'true']).status === 0;
    return missingPostgres() ?? (canMount ? false : 'nothing can be mounted here');
}

// Returns how many times this core has begun to lead, i.e. to poll devices, according to its log.
export const terms = (core) => core.program.said.match(/now polls devices and evaluates alarms/g)?.length ?? 0;
export const kill = (core, signal) => () => core.program.child.kill(signal);

export class TwoCores {
    // Makes two cores. server: a PostgresServer with a database; more: lines to append to the plant file; access: options that
    // say who may access the cores.
    static async create(server, more = '', access = ['--trust-local']) {
        const two = new TwoCores();
        Object.assign(two, { server, access });
        try {
            await two.make(more);
        } catch (error) {
            await two.destroy().catch(() => {});
            throw error;
        }
        return two;
    }
    // Starts a PostgreSQL server and two cores; waits until one leads and the other follows. prepare: called before the cores
    // start. `two.destroy()` ends the server, too.
    static async running(prepare = () => {}, ...more) {
        const server = await PostgresServer.start();
        let two = server;
        try {
            server.makeDatabase('plants');
            two = await TwoCores.create(server, ...more);
            two.destroys = server;
            await prepare(two);
            await Promise.all([two.start('one'), two.start('two')]);
            await two.followed(await two.leader());
        } catch (error) {
            await two.destroy().catch(() => {});
            throw error;
        }
        return two;
    }
    async make(more) {
        const { server } = this;
        this.nodes = await Nodes.create();
        const { plant } = this.nodes, tapPort = await freePort();
        this.plant = plant;
        this.databasePort = await freePort();
        this.network = new Network();
        await this.network.tap(tapPort, plant.modbusPort);
        this.file = join(plant.folder, 'two.yaml');
        writeFileSync(join(plant.folder, 'login'), server.login, { mode: 0o600 });
        const url = server.url(this.databasePort).replace('127.0.0.1', 'db.test');
        writeFileSync(this.file, `${readFileSync(plant.file, 'utf8').replace(`port: ${plant.modbusPort}`, `port: ${tapPort}`)}history:
  deadband_percent: 0
  postgres: { url: "${url}", login: login }
${more}`);
        // the second core's plant file differs only in its port, so it gets a copy of the first one's prepared assets
        cpSync(plant.prepared, join(plant.folder, 'two.prepared'), { recursive: true });
        const prepared = runProgram('plantcast-prep', [this.file]);
        if (prepared.code !== 0)
            throw new Error(prepared.err);
        const one = await this.makeCore('one', '127.0.0.2'), other = await this.makeCore('two', '127.0.0.3');
        this.cores = { one, two: other };
        one.toOther = await this.network.link(other.port, { from: STANDBY_HOST });
        other.toOther = await this.network.link(one.port, { from: STANDBY_HOST });
    }

    // Makes a core with its own history, port and connection to the database.
    async makeCore(name, host) {
        const { plant } = this.nodes;
        mkdirSync(join(plant.folder, name));
        const hosts = join(plant.folder, name, 'hosts');
        writeFileSync(hosts, `127.0.0.1 localhost\n${host} db.test\n`);
        return { name, hosts, port: await freePort(), file: this.file,
            toDatabase: await this.network.link(this.server.port, { host, port: this.databasePort }) };
    }

    // Starts a core; it becomes leader or standby. as: its --node name. Optional members of the core: `before`: command that
    // starts the program; `args`: further options; `tokenFile`: tokens that the core accepts; `standbyFile`: token with which it
    // connects to the other core.
    start(name, as = name) { return this.startCore(this.cores[name], as); }
    async startCore(core, as = core.name) {
        const { plant, standbyFile, tokenFile } = this.nodes;
        core.node = new Node(plant, ['--role', 'core', '--port', String(core.port), '--node', as, ...this.access,
            '--tokens', core.tokenFile ?? tokenFile, '--core-token-file', core.standbyFile ?? standbyFile,
            '--core', `ws://127.0.0.1:${core.toOther.port}`,
            '--history', join(plant.folder, core.name, 'history'), ...(core.args ?? [])], core.file,
        ['unshare', '--mount', 'sh', '-c', `mount --bind ${core.hosts} /etc/hosts && exec "$@"`, 'sh',
            ...(core.before ?? [])]);
        core.program = core.node.program;
        core.node.token = this.access.includes('--trust-local') ? undefined : this.nodes.tokens.viewer;
        this.nodes.all.push(core.node);
        await core.node.ready();
        return core;
    }

    renderer(name, ...more) {
        const urls = Object.values(this.cores).flatMap(({ port }) => ['--core', `ws://127.0.0.1:${port}`]);
        return this.nodes.start(['--role', 'render', ...urls, '--core-token-file', this.nodes.rendererFile, '--node', name, '--port', '0',
            ...more], this.file);
    }

    runs(core) { return core.node && core.program.child.exitCode === null && core.program.child.signalCode === null; }

    async ready(core) {
        if (!this.runs(core))
            return false;
        try {
            return (await core.node.fetch('/readyz', core.node.token, 10)).status === 200;
        } catch {
            return false;
        }
    }
    // Waits as until() does; if that fails, adds the output and state of both cores to the error.
    async waitsFor(what, good, seconds) {
        try {
            return await until(what, good, seconds);
        } catch (error) {
            const state = async (core) => `${await this.ready(core) ? ' (ready)' : ''}${this.runs(core) ? '' : ' (ended)'}`;
            for (const core of Object.values(this.cores))
                error.message += `\n${core.name}${await state(core)}:\n${core.program?.said.slice(-1500)}`;
            throw error;
        }
    }
    // Waits for the leader; fails if there are two.
    leader(seconds) {
        return this.waitsFor('one that leads', async () => {
            const ready = [];
            for (const core of Object.values(this.cores))
                if (await this.ready(core))
                    ready.push(core);
            return ready.length === 1 && ready[0];
        }, seconds);
    }
    other(core) { return Object.values(this.cores).find((one) => one !== core); }
    // Waits until the other core follows this one, so that its promises not to take over count, and has TI-1's reading.
    followed(core) {
        return this.waitsFor('a standby that is named', async () => await core.node.metric('plantcast_core_standby') === 1 &&
            (await this.other(core).node.tags())['TI-1'].quality_name === 'Good');
    }

    // Kills or stops the leader. Returns the new leader, and for how long no core polled.
    async takeOver(t, core, how) {
        const other = this.other(core), since = this.network.now();
        core.program.stopped = true;
        await how();
        this.takeOvers = (this.takeOvers ?? 0) + 1;
        await until(`${other.name} leads`, () => this.ready(other));
        await until('readings there', async () => (await other.node.tags())['TI-1'].quality_name === 'Good');
        await this.network.onePoller();
        const pause_ms = await this.network.longestPause(since);
        assert.deepEqual(await this.network.overlaps(), []);
        assert.ok(pause_ms > 0);
        promise(t, 'without a poller', pause_ms, TAKE_OVER_MS);
        return { leads: other, pause_ms };
    }
    async restart(core) {
        await core.program.ended;
        await this.start(core.name);
    }
    // Asserts that during these seconds the leader polls and the other core does not.
    async goesOn(t, core, seconds) {
        const since = this.network.now(), other = this.other(core), before = terms(other);
        await sleep(seconds * 1000);
        assert.ok(await this.ready(core), `${core.name} leads:\n${core.program.said.slice(-2000)}`);
        assert.ok(!await this.ready(other));
        assert.equal(terms(other), before);
        assert.deepEqual(await this.network.overlaps(), []);
        promise(t, 'without a poller', await this.network.longestPause(since), 1500);
    }

    async destroy() {
        try {
            await this.nodes?.destroy();
        } finally {
            await this.network?.close();
            await this.destroys?.destroy();
        }
    }
}

export { sleep, until };
