// SPDX-License-Identifier: GPL-3.0-or-later
// Debian's HAProxy with the configuration shipped with Plantcast, except for addresses, TLS and paths.
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { connect } from 'node:net';
import { freePort } from './ports.mjs';
import { until } from './until.mjs';

const PROGRAM = '/usr/sbin/haproxy';
const shipped = (name) => readFileSync(new URL(`../../../deploy/proxy/${name}`, import.meta.url), 'utf8');
export const missingHaproxy = () => (existsSync(PROGRAM) ? null : 'haproxy is not installed');

export class Haproxy {
    // Starts HAProxy. renderers: [{ port, agentPort }]; core and standby: { port }. host: address of all daemons. ca, coreCa:
    // certificate authorities' files that verify renderers and cores; null: connections to them without TLS. port: port of
    // HAProxy itself; null: a free one.
    static async start(renderers, core, standby = null, { host = '127.0.0.1', ca = null, coreCa = ca, port: own = null } = {}) {
        // the shipped configuration has three `ca-file` entries, in this order: two for renderers, one for cores
        const authorities = [ca, ca, coreCa];
        const tls = (authority) => (authority ? ` ssl verify required ca-file ${authority}` : '');
        let text = shipped('haproxy.cfg').replaceAll(/ ssl verify required ca-file \S+/g, () => tls(authorities.shift()))
            .replace('server core 10.0.0.10:8443', `server core ${host}:${core.port}`);
        if (standby)
            text = text.replace('# server standby 10.0.0.20:8443', `server standby ${host}:${standby.port}`);
        renderers.forEach(({ port, agentPort }, i) => {
            text = text.replaceAll(`10.0.0.1${i + 1}:8443`, `${host}:${port}`)
                .replace(`cookie r${i + 1} agent-port 8404`, `cookie r${i + 1} agent-port ${agentPort}`);
        });
        return Haproxy.run(text, own ?? await freePort());
    }

    // Starts HAProxy in front of two cores, without renderers or TLS. cores: [{ port }, { port }]
    static async startCores(cores) {
        let text = shipped('haproxy-cores.cfg').replace(/ ssl verify required ca-file \S+/, '').replaceAll(/ verifyhost \S+/g, '');
        cores.forEach(({ port }, i) => {
            text = text.replace(`10.0.0.${i + 1}0:8443`, `127.0.0.1:${port}`);
        });
        return Haproxy.run(text, await freePort());
    }

    static async run(text, port) {
        const proxy = new Haproxy();
        proxy.folder = mkdtempSync(join(tmpdir(), 'plantcast-haproxy-'));
        proxy.port = port;
        const file = join(proxy.folder, 'haproxy.cfg');
        writeFileSync(file, text.replace(/bind :443 .*/, `bind 127.0.0.1:${port}`).replace('/run/haproxy', proxy.folder));
        const checked = spawnSync(PROGRAM, ['-c', '-f', file], { encoding: 'utf8' });
        if (checked.status !== 0) {
            await proxy.destroy();
            throw new Error(checked.stderr);
        }
        proxy.child = spawn(PROGRAM, ['-db', '-f', file], { stdio: ['ignore', 'ignore', 'pipe'] });
        proxy.said = checked.stderr;
        proxy.child.stderr.on('data', (chunk) => { proxy.said += chunk; });
        await until('HAProxy', () => proxy.child.exitCode !== null || proxy.servers().catch(() => null), 90, () => proxy.said);
        return proxy;
    }

    // Returns the state of each server in a backend from `show stat`: { r1: { status, weight, sessions, since_s } }; since_s:
    // seconds since the status changed.
    async servers(backend = 'renderers') {
        const text = await new Promise((done, fail) => {
            const socket = connect(join(this.folder, 'admin.sock'), () => socket.end('show stat\n'));
            let said = '';
            socket.on('data', (chunk) => { said += chunk; });
            socket.on('end', () => done(said));
            socket.on('error', fail);
        });
        const [head, ...lines] = text.trim().split('\n').map((line) => line.replace(/^# /, '').split(','));
        const column = (line, name) => line[head.indexOf(name)];
        return Object.fromEntries(lines.filter((line) => column(line, 'pxname') === backend && column(line, 'svname') !== 'BACKEND')
            .map((line) => [column(line, 'svname'), { status: column(line, 'status'), weight: Number(column(line, 'weight')),
                sessions: Number(column(line, 'scur')), since_s: Number(column(line, 'lastchg')) }]));
    }

    async destroy() {
        if (this.child?.exitCode === null && this.child.signalCode === null) {
            const ended = new Promise((done) => this.child.once('exit', done));
            this.child.kill('SIGKILL');
            await ended;
        }
        rmSync(this.folder, { recursive: true, force: true });
    }
}
