// SPDX-License-Identifier: GPL-3.0-or-later
// Debian's mosquitto on a free port, and clients that publish to it.
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { connect as connectTcp } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';
import mqtt from 'mqtt';
import { freePort } from './ports.mjs';

const PROGRAM = ['/usr/sbin/mosquitto', '/usr/local/sbin/mosquitto'].find(existsSync);

// Returns why there is no broker on this machine, or null.
export const missingBroker = () => (PROGRAM ? null : 'no mosquitto');

const answers = (port) => new Promise((done) => {
    const socket = connectTcp(port, '127.0.0.1', () => { socket.destroy(); done(true); });
    socket.once('error', () => done(false));
});

export class Broker {
    // Starts a broker; more: lines to append to its configuration file.
    static async start(more = []) {
        const broker = new Broker();
        broker.folder = mkdtempSync(join(tmpdir(), 'plantcast-broker-'));
        broker.port = await freePort();
        broker.more = more;
        await broker.restart();
        return broker;
    }

    // Ends the broker if it runs, and starts it with the same configuration.
    async restart() {
        await this.kill();
        const file = join(this.folder, 'mosquitto.conf'), user = process.getuid() === 0 ? ['user root'] : [];
        const access = this.more.some((line) => line.startsWith('password_file')) ? [] : ['allow_anonymous true'];
        writeFileSync(file, [...user, `listener ${this.port} 127.0.0.1`, ...access, 'max_queued_messages 0', ...this.more, ''].join('\n'));
        this.child = spawn(PROGRAM, ['-c', file], { stdio: ['ignore', 'pipe', 'pipe'] });
        this.said = '';
        for (const pipe of [this.child.stdout, this.child.stderr])
            pipe.on('data', (chunk) => { this.said = (this.said + chunk).slice(-20000); });
        this.ended = new Promise((done) => this.child.once('exit', done));
        for (const end = performance.now() + 20000; !(await answers(this.port)); await sleep(20))
            if (performance.now() > end || this.child.exitCode !== null)
                throw new Error(`mosquitto does not start:\n${this.said}`);
    }

    async kill(signal = 'SIGKILL') {
        if (this.child && this.child.exitCode === null && this.child.signalCode === null) {
            this.child.kill(signal);
            await this.ended;
        }
    }

    // Returns the source's line for the plant file; keys: further keys.
    source(keys) { return `{ id: broker, type: mqtt, host: 127.0.0.1, port: ${this.port}, ${keys} }`; }

    // Stops the broker's process: it answers nothing, but its connections stay open. thaw() lets it run on.
    freeze() { this.child.kill('SIGSTOP'); }
    thaw() { this.child.kill('SIGCONT'); }

    // Returns a publishing client; options: those of npm's mqtt.
    async client(options = {}) {
        const client = mqtt.connect(`${options.ca ? 'mqtts' : 'mqtt'}://127.0.0.1:${this.port}`, { protocolVersion: 4, ...options });
        await new Promise((done, fail) => { client.once('connect', done); client.on('error', fail); });
        client.tell = (topic, payload, more = {}) => new Promise((done, fail) => {
            const text = typeof payload === 'object' && !Buffer.isBuffer(payload) ? JSON.stringify(payload) : payload;
            const bytes = Buffer.isBuffer(text) ? text : String(text);
            client.publish(topic, bytes, { qos: 1, ...more }, (error) => (error ? fail(error) : done()));
        });
        client.leave = () => new Promise((done) => client.end(false, {}, done));
        return client;
    }

    async destroy() {
        await this.kill();
        rmSync(this.folder, { recursive: true, force: true });
    }
}

// Makes a certificate authority and the certificates of a server (127.0.0.1, localhost) and a client, as PEM files in a folder.
export function makeCertificates(folder, name = 'ca') {
    const run = (...args) => {
        const { status, stderr } = spawnSync('openssl', args, { cwd: folder, encoding: 'utf8' });
        if (status !== 0)
            throw new Error(stderr);
    };
    run('req', '-x509', '-newkey', 'rsa:2048', '-nodes', '-days', '2', '-subj', `/CN=${name}`, '-keyout', `${name}.key`,
        '-out', `${name}.crt`);
    for (const who of ['server', 'client']) {
        const file = `${name}-${who}`;
        writeFileSync(join(folder, 'names'), 'subjectAltName=IP:127.0.0.1,DNS:localhost\n');
        run('req', '-newkey', 'rsa:2048', '-nodes', '-subj', `/CN=${who}`, '-keyout', `${file}.key`, '-out', `${file}.csr`);
        run('x509', '-req', '-days', '2', '-in', `${file}.csr`, '-CA', `${name}.crt`, '-CAkey', `${name}.key`, '-CAcreateserial',
            '-extfile', 'names', '-out', `${file}.crt`);
    }
}
