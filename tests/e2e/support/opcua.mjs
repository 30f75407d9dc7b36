// SPDX-License-Identifier: GPL-3.0-or-later
// An OPC UA server on a free port, and certificates for both sides.
import { spawn, spawnSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import { isDeepStrictEqual } from 'node:util';
import { missingClocks, SetClock } from './clocks.mjs';
import { freePort } from './ports.mjs';
import { missing, runProgram } from './tiny_plant.mjs';

const HERE = dirname(fileURLToPath(import.meta.url));

// Returns why OPC UA cannot be tested on this machine, or null.
function missingOpcua() {
    if (/without OPC UA/.test(runProgram('plantcastd', ['--version']).out))
        return 'built without OPC UA';
    return existsSync(join(HERE, '../node_modules/node-opcua-server')) ? null : 'no node-opcua-server';
}

// Returns a test's options, including a reason to skip it if it cannot run.
export function opcuaOptions(timeout) {
    const absent = missing();
    return { skip: absent.length > 0 ? `not built: ${absent.join(', ')}` : missingOpcua() ?? false, timeout };
}

// Makes NAME.crt and NAME.key in a folder, with their own authority. uri, hosts: subject alternative names; dates: [from, to],
// in openssl's format. All share one key, because making keys is slow; ownKey: makes a new one.
export function makeCertificate(folder, name, { uri = `urn:test:${name}`, hosts = 'IP:127.0.0.1,DNS:localhost', dates, ownKey } = {}) {
    const run = (...args) => {
        const { status, stderr } = spawnSync('openssl', args, { cwd: folder, encoding: 'utf8' });
        if (status !== 0)
            throw new Error(stderr);
    };
    writeFileSync(join(folder, `${name}.cnf`), `[req]\ndistinguished_name = dn\nx509_extensions = v3\nprompt = no\n[dn]\nCN = ${name}
[v3]\nbasicConstraints = CA:FALSE\nsubjectAltName = URI:${uri},${hosts}
keyUsage = digitalSignature, nonRepudiation, keyEncipherment, dataEncipherment, keyCertSign\nextendedKeyUsage = serverAuth, clientAuth
[ca]\ndefault_ca = own\n[own]\ndatabase = ${name}.index\nserial = ${name}.serial\nnew_certs_dir = .\ndefault_md = sha256\npolicy = any
x509_extensions = v3\n[any]\ncommonName = supplied\n`);
    const shared = join(folder, 'shared.key');
    if (ownKey || !existsSync(shared))
        run('genrsa', '-out', ownKey ? `${name}.key` : shared, '2048');
    if (!ownKey)
        copyFileSync(shared, join(folder, `${name}.key`));
    if (!dates) {
        run('req', '-x509', '-key', `${name}.key`, '-days', '2', '-config', `${name}.cnf`, '-out', `${name}.crt`);
        return;
    }
    writeFileSync(join(folder, `${name}.index`), '');
    writeFileSync(join(folder, `${name}.serial`), '01\n');
    run('req', '-new', '-key', `${name}.key`, '-config', `${name}.cnf`, '-out', `${name}.csr`);
    run('ca', '-batch', '-selfsign', '-config', `${name}.cnf`, '-keyfile', `${name}.key`, '-in', `${name}.csr`, '-out', `${name}.crt`,
        '-notext', '-startdate', dates[0], '-enddate', dates[1]);
}

export class OpcuaServer {
    // Makes the certificates `server` (trusted) and `client`; does not start the server.
    static async create() {
        const server = new OpcuaServer();
        server.folder = mkdtempSync(join(tmpdir(), 'plantcast-opcua-'));
        server.port = await freePort();
        for (const name of ['server', 'client'])
            makeCertificate(server.folder, name);
        server.trust('server');
        return server;
    }

    // Makes the folder of trusted certificates contain exactly these.
    trust(...names) {
        rmSync(join(this.folder, 'trusted'), { recursive: true, force: true });
        mkdirSync(join(this.folder, 'trusted'));
        for (const name of names)
            spawnSync('openssl', ['x509', '-in', `${name}.crt`, '-out', `trusted/${name}.pem`], { cwd: this.folder });
    }

    // Brings the server back to the state after a start with these settings; restarts it only if the settings differ from the
    // present ones.
    async reset(settings = this.settings ?? {}) {
        if (this.runs && isDeepStrictEqual(settings, this.settings))
            await this.tell({ reset: true });
        else
            await this.restart(settings);
    }

    get runs() { return this.child?.exitCode === null && this.child.signalCode === null; }

    // Stops serving, and serves again with these settings (opcua_server.mjs). ahead_s: how far its wall clock is ahead. The
    // process keeps running, because loading node-opcua takes three seconds of processor time.
    async restart(settings = this.settings ?? {}) {
        if (!this.runs)
            this.run();
        this.settings = settings;
        this.clock?.set(settings.ahead_s ?? 0);
        await this.tell({ serve: { folder: this.folder, port: this.port, ...settings } });
    }

    run() {
        this.clock = missingClocks() ? null : new SetClock(join(this.folder, 'clock'));
        this.child = spawn(process.execPath, [join(HERE, 'opcua_server.mjs')],
            { stdio: ['pipe', 'pipe', 'pipe'], env: { ...process.env, ...this.clock?.variables() } });
        this.said = '';
        this.answers = [];
        const child = this.child;
        child.stderr.on('data', (chunk) => { this.said = (this.said + chunk).slice(-5000); });
        this.ended = new Promise((done) => child.once('exit', done));
        createInterface({ input: child.stdout }).on('line', (line) => {
            if (line.startsWith('{"done"'))
                this.answers.shift()?.(JSON.parse(line));
        });
    }

    tell(order) {
        const answer = new Promise((done) => { this.answers.push(done); this.child.stdin.write(`${JSON.stringify(order)}\n`); });
        return Promise.race([answer, this.ended.then(() => { throw new Error(`the OPC UA server ends:\n${this.said}`); })]);
    }

    set(name, value, more = {}) { return this.tell({ set: { name, value, ...more } }); }

    async kill(signal = 'SIGKILL') {
        if (this.runs) {
            this.child.kill(signal);
            await this.ended;
        }
    }

    freeze() { this.child.kill('SIGSTOP'); }
    thaw() { this.child.kill('SIGCONT'); }

    // Returns the source's line for the plant file; keys: further keys.
    source(keys) { return `{ id: plc, type: opcua, host: ${this.host ?? '127.0.0.1'}, port: ${this.port}, poll_ms: 100, ${keys} }`; }

    // Returns the key `security` with the client's certificate.
    security(more = '', name = 'client') {
        const at = (file) => join(this.folder, file);
        return `security: { certificate: ${at(name)}.crt, key: ${at(name)}.key, trusted: ${at('trusted')}${more} }`;
    }

    async destroy() {
        await this.kill();
        rmSync(this.folder, { recursive: true, force: true });
    }
}
