// SPDX-License-Identifier: GPL-3.0-or-later
// Debian's PostgreSQL on a free port with its own database, and a relay in front of it that can cut connections.
import { spawn, spawnSync } from 'node:child_process';
import { chownSync, existsSync, mkdirSync, mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { connect, createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { freePort } from './ports.mjs';

const VERSIONS = '/usr/lib/postgresql';
const FOLDER = existsSync(VERSIONS) && readdirSync(VERSIONS).map((version) => join(VERSIONS, version, 'bin'))
    .findLast((folder) => existsSync(join(folder, 'initdb')));
const LONG_ANSWER_BYTES = 1000000;
const NOBODY = 65534, sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const as = process.getuid() === 0 ? { uid: NOBODY, gid: NOBODY } : {}; // PostgreSQL refuses to run as root
const PASSWORD = 'not secret';

// Returns why there is no server on this machine, or null.
export const missingPostgres = () => (FOLDER ? null : 'no PostgreSQL');

export class PostgresServer {
    static async start() {
        const server = new PostgresServer();
        server.folder = mkdtempSync(join(tmpdir(), 'plantcast-postgres-'));
        server.own(server.folder);
        server.data = join(server.folder, 'data');
        server.port = await freePort();
        const made = spawnSync(join(FOLDER, 'initdb'), ['-D', server.data, '-U', 'owner', '-A', 'trust', '--no-sync', '-E', 'UTF8'],
            { encoding: 'utf8', cwd: server.folder, ...as });
        try {
            if (made.status !== 0)
                throw new Error(made.stderr);
            await server.restart();
        } catch (error) {
            await server.destroy();
            throw error;
        }
        return server;
    }

    own(path) {
        if (as.uid)
            chownSync(path, as.uid, as.gid);
    }

    // Ends the server as a power failure would, if it runs, and starts it again.
    async restart() {
        await this.kill();
        rmSync(join(this.data, 'postmaster.pid'), { force: true });
        this.child = spawn(join(FOLDER, 'postgres'), ['-D', this.data, '-p', String(this.port), '-h', '127.0.0.1', '-k', this.folder,
            '-c', 'shared_buffers=16MB', '-c', 'max_connections=20',
            // does not wait for the disk: a slow disk would delay renewing the lease until the leader has to give up its role
            '-c', 'fsync=off',
        ], { stdio: ['ignore', 'pipe', 'pipe'], cwd: this.folder, ...as });
        this.said = '';
        for (const pipe of [this.child.stdout, this.child.stderr])
            pipe.on('data', (chunk) => { this.said = (this.said + chunk).slice(-20000); });
        this.ended = new Promise((done) => this.child.once('exit', done));
        for (const end = performance.now() + 60000; this.psql('SELECT 1', 'postgres').status !== 0; await sleep(100))
            if (performance.now() > end || this.child.exitCode !== null)
                throw new Error(`PostgreSQL does not start:\n${this.said}`);
    }

    // SIGQUIT ends all of the server's processes at once, and the next start recovers from its log.
    async kill() {
        if (this.child && this.child.exitCode === null && this.child.signalCode === null) {
            this.child.kill('SIGQUIT');
            this.child.kill('SIGCONT'); // continue processes that freeze() has stopped
            await this.ended;
        }
    }

    // Makes the server's processes stop answering without closing connections. The first process is stopped first, so that it
    // neither starts new processes nor reaps ended ones.
    freeze() {
        this.child.kill('SIGSTOP');
        this.signalOthers('SIGSTOP');
    }
    thaw() {
        this.signalOthers('SIGCONT');
        this.child.kill('SIGCONT');
    }
    signalOthers(signal) {
        const { stdout } = spawnSync('ps', ['-o', 'pid=', '--ppid', String(this.child.pid)], { encoding: 'utf8' });
        for (const pid of stdout.trim().split(/\s+/).map(Number))
            process.kill(pid, signal);
    }

    psql(sql, database = this.database, user = 'owner') {
        return spawnSync(join(FOLDER, 'psql'), ['-XAtq', '-F', '\t', '-v', 'ON_ERROR_STOP=1', '-h', this.folder, '-p', String(this.port),
            '-U', user, '-d', database, '-c', sql], { encoding: 'utf8', env: { ...process.env, TZ: 'UTC', PGTZ: 'UTC' } });
    }

    // Locks the rows that the query returns. Resolves with a function that releases them.
    async lock(query) {
        const held = `/* held */ BEGIN; ${query} FOR UPDATE; SELECT pg_sleep(600)`;
        const child = spawn(join(FOLDER, 'psql'), ['-XAtq', '-h', this.folder, '-p', String(this.port), '-U', 'owner', '-d', this.database,
            '-c', held], { stdio: 'ignore' });
        const ended = new Promise((done) => child.once('exit', done));
        const holders = "FROM pg_stat_activity WHERE query LIKE '/* held */%' AND wait_event = 'PgSleep'";
        for (const end = performance.now() + 20000; this.ask(`SELECT pid ${holders}`).length === 0; await sleep(50))
            if (performance.now() > end || child.exitCode !== null)
                throw new Error('nothing is locked');
        return async () => {
            this.ask(`SELECT pg_terminate_backend(pid) ${holders}`);
            await ended;
        };
    }

    // Returns the rows of a query as lists of columns.
    ask(sql) {
        const { status, stdout, stderr } = this.psql(sql);
        if (status !== 0)
            throw new Error(stderr);
        return stdout.split('\n').filter(Boolean).map((line) => line.split('\t'));
    }

    // Makes an empty database owned by its own user; more: appended to the statement.
    makeDatabase(name, more = '') {
        this.database = name;
        const made = this.psql(`CREATE DATABASE ${name} ${more}`, 'postgres');
        if (made.status !== 0)
            throw new Error(made.stderr);
        this.psql(`CREATE ROLE plantcast LOGIN PASSWORD '${PASSWORD}'`, 'postgres');
        this.ask(`ALTER DATABASE ${name} OWNER TO plantcast`);
    }

    url(port = this.port) {
        return `postgresql://127.0.0.1:${port}/${this.database}`;
    }
    get login() { return `plantcast\n${PASSWORD}\n`; }

    // Makes a tablespace on a new file system of `megabytes` MB. Returns null if this user may not mount one.
    smallDisk(megabytes) {
        const path = join(this.folder, 'disk');
        mkdirSync(path);
        if (spawnSync('mount', ['-t', 'tmpfs', '-o', `size=${megabytes}m`, 'tmpfs', path]).status !== 0)
            return null;
        this.disk = path;
        mkdirSync(join(path, 'space'), { mode: 0o700 });
        this.own(join(path, 'space'));
        const made = this.psql(`CREATE TABLESPACE small LOCATION '${path}/space'`, 'postgres');
        if (made.status !== 0)
            throw new Error(made.stderr);
        return path;
    }

    async destroy() {
        await this.kill();
        if (this.disk)
            spawnSync('umount', [this.disk]);
        rmSync(this.folder, { recursive: true, force: true });
    }
}

// Relays bytes to a port of this machine until it is cut: then all connections end, and new ones are refused until it is
// mended.
export class CuttableLink {
    // at: { host, port: where the link listens; from: local address of its connections to the target }. freeze() stops passing
    // bytes on but closes no connection, as if a cable were unplugged.
    static async open(port, at = {}) {
        const link = new CuttableLink();
        link.sockets = new Set();
        link.server = createServer((near) => {
            const far = connect({ port, host: '127.0.0.1', localAddress: at.from });
            let count = 0, back = 0;
            if (link.isFrozen)
                for (const socket of [near, far])
                    socket.pause();
            for (const socket of [near, far]) {
                link.sockets.add(socket);
                socket.on('error', () => {});
                socket.on('close', () => { link.sockets.delete(socket); near.destroy(); far.destroy(); });
            }
            if (link.isCut)
                near.destroy();
            far.on('data', (bytes) => {
                back += bytes.length;
                if (link.cutsAnswers && back > LONG_ANSWER_BYTES)
                    near.destroy();
                else
                    near.write(bytes);
            });
            near.on('data', (bytes) => {
                count += bytes.length;
                // forwards half of these bytes and then cuts the link, so that the server gets only part of the message
                if (link.cutAfter && count >= link.cutAfter) {
                    far.write(bytes.subarray(0, bytes.length / 2), () => link.cut());
                    link.cutAfter = 0;
                } else {
                    far.write(bytes);
                }
            });
        });
        await new Promise((done) => link.server.listen(at.port ?? 0, at.host ?? '127.0.0.1', done));
        link.port = link.server.address().port;
        return link;
    }

    cut() {
        this.isCut = true;
        this.cuts = (this.cuts ?? 0) + 1;
        for (const socket of this.sockets)
            socket.destroy();
    }
    // From now on, closes each connection over which the target has sent a long answer, in the middle of the answer.
    cutAnswers() {
        this.cutsAnswers = true;
    }
    passAnswers() {
        this.cutsAnswers = false;
    }
    freeze() {
        this.isFrozen = true;
        for (const socket of this.sockets)
            socket.pause();
    }
    mend() {
        this.isCut = this.isFrozen = false;
        for (const socket of this.sockets)
            socket.resume();
    }

    close() {
        this.cut();
        this.server.close();
    }
}
