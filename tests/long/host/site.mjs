// SPDX-License-Identifier: GPL-3.0-or-later
// One plant with all of its programs on this machine: two cores with PostgreSQL, two renderers with TLS, HAProxy, Prometheus,
// operators and the load generator. Each core has its own small disk and clock; each link between the programs can be cut.
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import { appendFileSync, mkdirSync, readFileSync, renameSync, statfsSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { connect } from 'node:tls';
import { SetClock } from '../../e2e/support/clocks.mjs';
import { Haproxy } from '../../e2e/support/haproxy.mjs';
import { Node } from '../../e2e/support/nodes.mjs';
import { freePort } from '../../e2e/support/ports.mjs';
import { PostgresServer } from '../../e2e/support/postgres_server.mjs';
import { BIN } from '../../e2e/support/tiny_plant.mjs';
import { sleep, TwoCores, until } from '../../e2e/support/two_cores.mjs';
import { AlarmCycles } from './alarms.mjs';
import { Operator } from './operators.mjs';
import { Alerts, Footprint } from './watch.mjs';

const NEW_KEY = '-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes';
const OPERATORS = 4, LOAD_SESSIONS = 4, LOAD_S = 20, DISK_MB = 48, RECOVERY_S = 60, PROGRAM_MS = 60000;
const ACCESS = ['--behind-proxy', '--host', 'plant.example', '--host', '127.0.0.1'];

function run(program, args, options = {}) {
    return new Promise((done) => {
        const child = spawn(program, args, { stdio: ['ignore', 'pipe', 'pipe'], ...options });
        let said = '';
        for (const pipe of [child.stdout, child.stderr])
            pipe.on('data', (chunk) => { said += chunk; });
        child.on('exit', (code) => done({ code, said }));
        child.on('error', ({ message }) => done({ code: -1, said: message }));
    });
}
function openssl(folder, command) {
    const { status, stderr } = spawnSync('openssl', command.split(' '), { cwd: folder, encoding: 'utf8' });
    if (status !== 0)
        throw new Error(`openssl ${command}: ${stderr}`);
}

export class Site {
    constructor() { Object.assign(this, { over: new AbortController(), renderers: [], operators: [] }); }

    get isOver() { return this.over.signal.aborted; }
    mustGoOn() { this.over.signal.throwIfAborted(); }

    // Starts everything, until destroy().
    start() { return this.starting = this.startAll(); }
    async startAll() {
        const end = once(this.over.signal, 'abort').then(() => this.mustGoOn());
        for (const step of [this.startServer, this.makeTwo, this.startCores, this.startRenderers, this.balance, this.watch]) {
            this.mustGoOn();
            const done = step.call(this), isMaking = !this.two;
            // if destroy() is called meanwhile, stops waiting for this step, except for the first ones, which make the cores
            await (isMaking ? done : Promise.race([done, end]));
        }
    }
    async startServer() {
        this.server = await PostgresServer.start();
        this.server.makeDatabase('plants');
    }
    async makeTwo() {
        const two = this.two = await TwoCores.create(this.server, '', ACCESS);
        this.plant = two.plant;
        this.folder = two.plant.folder;
        this.slacken();
        await this.plant.set({ 'TI-1': 50, 'PI-1': 50 });
        this.makeAuthority();
        for (const core of Object.values(two.cores))
            this.equip(core);
    }
    async startCores() {
        await Promise.all([this.two.start('one'), this.two.start('two')]);
        await this.two.followed(await this.two.leader());
    }
    async startRenderers() {
        for (const name of ['r1', 'r2'])
            this.renderers.push(await this.makeRenderer(name));
    }
    async watch() {
        const { cores, nodes } = this.two;
        this.operators = Array.from({ length: OPERATORS }, (_, i) => new Operator({ name: `operator ${i + 1}`,
            port: () => this.proxy.port, token: nodes.tokens.operator, watched: 'TI-2' }));
        this.cycles = new AlarmCycles(this.plant, this.operators, ['TI-1', 'PI-1']);
        const targets = [...Object.values(cores).map(({ port, name }) => ({ port, node: `core ${name}`, scheme: 'http' })),
            ...this.renderers.map(({ port, name }) => ({ port, node: `renderer ${name}`, scheme: 'https' }))];
        this.alerts = await Alerts.start(this.folder, targets, nodes.tokens.viewer, join(this.folder, 'ca.pem'));
        this.footprint = new Footprint(() => this.processes());
        this.load = this.generateLoad();
    }

    // Makes the plant tolerate a busy machine: readings become stale after 3 s instead of 1, the device may answer within 1 s
    // instead of 0.3, and polls are 250 ms apart instead of 100.
    slacken() {
        const tags = join(this.folder, 'tags.csv');
        writeFileSync(tags, readFileSync(tags, 'utf8').replace(/,1,90$/gm, ',3,90'));
        writeFileSync(this.two.file, readFileSync(this.two.file, 'utf8').replace('timeout_ms: 300', 'timeout_ms: 1000')
            .replace('poll_ms: 100', 'poll_ms: 250'));
    }

    equip(core) {
        core.disk = join(this.folder, core.name, 'history');
        core.runtime = join(this.folder, core.name, 'run');
        for (const path of [core.disk, core.runtime])
            mkdirSync(path);
        const { status, stderr } = spawnSync('mount', ['-t', 'tmpfs', '-o', `size=${DISK_MB}m`, 'tmpfs', core.disk], { encoding: 'utf8' });
        if (status !== 0)
            throw new Error(stderr);
        core.clock = new SetClock(join(this.folder, core.name, 'clock'));
        core.before = [...core.clock.starter(), `RUNTIME_DIRECTORY=${core.runtime}`];
    }

    makeAuthority() {
        openssl(this.folder, `req -x509 ${NEW_KEY} -keyout ca.key -out ca.pem -days 9 -subj /CN=Works`);
        for (const name of ['r1', 'r2'])
            this.certify(name);
    }
    // Replaces a renderer's certificate as an administrator does, the key first. Each file is replaced atomically.
    certify(name) {
        openssl(this.folder, `req ${NEW_KEY} -keyout new.key -out new.csr -subj /CN=plant.example ` +
            '-addext subjectAltName=DNS:plant.example,DNS:localhost,IP:127.0.0.1');
        openssl(this.folder, 'x509 -req -in new.csr -CA ca.pem -CAkey ca.key -CAcreateserial -copy_extensions copy -days 9 -out new.pem');
        renameSync(join(this.folder, 'new.key'), join(this.folder, `${name}.key`));
        renameSync(join(this.folder, 'new.pem'), join(this.folder, `${name}.pem`));
    }
    serial({ port }) {
        return new Promise((done, fail) => {
            const socket = connect({ port, host: '127.0.0.1', rejectUnauthorized: false }, () => {
                done(socket.getPeerCertificate().serialNumber);
                socket.destroy();
            });
            socket.on('error', fail);
        });
    }

    async makeRenderer(name) {
        const links = [];
        for (const { port } of Object.values(this.two.cores))
            links.push(await this.two.network.link(port));
        const renderer = { name, links, port: await freePort(), agentPort: await freePort() };
        renderer.runtime = join(this.folder, `${name}.run`);
        mkdirSync(renderer.runtime);
        return this.startRenderer(renderer);
    }
    async startRenderer(renderer) {
        const { nodes, file } = this.two, { name, links, port, agentPort, runtime } = renderer;
        const cores = links.flatMap((link) => ['--core', `ws://127.0.0.1:${link.port}`]);
        renderer.node = new Node(this.plant, ['--role', 'render', ...cores, '--core-token-file', nodes.rendererFile, '--node', name,
            '--port', String(port), '--agent-port', String(agentPort), '--tls-cert', join(this.folder, `${name}.pem`),
            '--tls-key', join(this.folder, `${name}.key`), '--tokens', nodes.tokenFile, ...ACCESS], file,
        ['env', `RUNTIME_DIRECTORY=${runtime}`]);
        renderer.program = renderer.node.program;
        nodes.all.push(renderer.node);
        await renderer.node.ready();
        return renderer;
    }

    async balance() {
        this.mustGoOn();
        this.proxy = await Haproxy.start(this.renderers, this.two.cores.one, this.two.cores.two,
            { ca: join(this.folder, 'ca.pem'), coreCa: null, port: this.proxy?.port });
    }

    processes() {
        return [...Object.values(this.two.cores).map((core) => ({ name: `core ${core.name}`, pid: core.program.child.pid })),
            ...this.renderers.map(({ name, program }) => ({ name: `renderer ${name}`, pid: program.child.pid })),
            { name: 'haproxy', pid: this.proxy.child.pid }];
    }

    async generateLoad() {
        const token = join(this.folder, 'load.token');
        writeFileSync(token, this.two.nodes.tokens.viewer);
        while (!this.isOver) {
            await this.plantcast('probe', `http://127.0.0.1:${this.proxy.port}/`, '--sessions', String(LOAD_SESSIONS), '--seconds',
                String(LOAD_S), '--motion', 'random', '--hz', '5', '--size', '160x90', '--blind', '--token-file', token, '--json');
            await sleep(1000);
        }
    }

    // Waits until all programs work and all operators see the plant. Returns why they do not, or null.
    async recovered() {
        const leader = await this.two.leader(RECOVERY_S).catch((error) => error);
        if (leader instanceof Error)
            return leader.message;
        let lacking;
        const whole = async () => {
            const up = Object.entries(await this.proxy.servers().catch(() => ({ none: {} })));
            lacking = [...up.filter(([, { status }]) => !/^UP/.test(status)).map(([name]) => `${name} is not up at the balancer`),
                ...this.operators.filter(({ sees }) => !sees).map(({ name }) => `${name} sees nothing`),
                ...await leader.node.metric('plantcast_core_standby', leader.node.token) === 1 ? [] : ['no standby follows'],
                ...await leader.node.metric('plantcast_renderers', leader.node.token) === 2 ? [] : ['not two renderers']];
            return lacking.length === 0;
        };
        try {
            await until('the whole plant', () => whole().catch((error) => { lacking = [error.message]; return false; }), RECOVERY_S);
            return null;
        } catch {
            return lacking.join(', ');
        }
    }

    // Fills a core's disk to the last block, until freeDisk().
    fillDisk(core) {
        const { bavail, bsize } = statfsSync(core.disk);
        try {
            writeFileSync(join(core.disk, 'filler'), Buffer.alloc(bavail * bsize));
            appendFileSync(join(core.disk, 'filler'), Buffer.alloc(4096));
        } catch { /* the disk is full */ }
    }
    freeDisk(core) { spawnSync('rm', [join(core.disk, 'filler')]); }

    plantcast(...args) { return run(join(BIN, 'plantcast'), args, { signal: this.over.signal, timeout: PROGRAM_MS }); }

    // Ends everything, even after a start that failed or is incomplete. Throws the first error at the end.
    destroy() { return this.ending ??= this.endAll(); }
    async endAll() {
        this.over.abort();
        await this.starting?.catch(() => {});
        const errors = [];
        for (const end of [this.endClients, () => this.load, () => this.proxy?.destroy(), () => this.alerts?.end(), this.unmount,
            () => this.two?.destroy(), () => this.server?.destroy()])
            await Promise.resolve().then(() => end.call(this)).catch((error) => errors.push(error));
        if (errors.length > 0)
            throw errors[0];
    }
    endClients() {
        this.footprint?.end();
        if (this.cycles)
            this.cycles.isOver = true;
        for (const operator of this.operators)
            operator.leave();
    }
    unmount() {
        for (const { disk } of Object.values(this.two?.cores ?? {}).filter((core) => core.disk))
            spawnSync('umount', ['-l', disk]);
    }
}

export { sleep, until };
