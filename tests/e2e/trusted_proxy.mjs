// SPDX-License-Identifier: GPL-3.0-or-later
// HAProxy and nginx with the shipped configuration, as proxies on another host (--trusted-proxy): limits, lock-out, log and
// audit trail use the client's address, and forged headers change nothing.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { request } from 'node:https';
import { networkInterfaces } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { makeCertificate } from './support/certificate.mjs';
import { Haproxy, missingHaproxy } from './support/haproxy.mjs';
import { linesOf } from './support/lines.mjs';
import { Nodes, until } from './support/nodes.mjs';
import { get, PlainClient } from './support/plain_client.mjs';
import { freePort } from './support/ports.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt } from './support/tiny_plant.mjs';

// The daemons treat connections from this address as coming from another machine, because it is not a loopback address.
const HOST = Object.values(networkInterfaces()).flat().find(({ family, internal }) => family === 'IPv4' && !internal)?.address;
const options = { timeout: 200000, skip: notBuilt() || (missingHaproxy() ?? (HOST ? false : 'no network interface but loopback')) };
const SESSIONS = 80, CLIENTS = 20, WRONG = 'x'.repeat(43);
let nodes, core, renderers, proxy, other;

const path = (name) => join(nodes.plant.folder, name);
const served = (name) => ['--listen', '0.0.0.0', '--tls-cert', path('cert.pem'), '--tls-key', path('cert.key'), '--host', 'plant.example',
    '--audit', path(`${name}.audit`)];
// Returns the complete lines of a daemon's audit trail.
const audited = (name) => linesOf(path(`${name}.audit`)).map((line) => JSON.parse(line));
// Waits for a matching line in the node's audit trail, which another thread of the daemon writes later. Returns the first such
// line.
const recorded = (name, is) => until(`a line in the trail of ${name}`, () => audited(name).find(is));
const isRefused = ({ event, result, from }) => event === 'login' && result === 'refused' && from;
const bearer = (token, more = '') => `Authorization: Bearer ${token}\r\n${more}`;
// Asks through HAProxy, as a client with that address.
const ask = async (localAddress, headers, page = '/api/v1/tags') => (await get(proxy.port, page, 'GET', headers, { localAddress })).status;

// Asks a daemon directly, without the proxy: { status, body }.
const secure = ({ port }, headers, { host = HOST, page = '/api/v1/tags', localAddress } = {}) => new Promise((done, fail) => {
    request({ host, port, path: page, rejectUnauthorized: false, localAddress,
        headers: { Host: 'plant.example', 'X-Forwarded-For': '127.0.0.44', ...headers } }, (response) => {
        let body = '';
        response.on('data', (text) => { body += text; }).on('end', () => done({ status: response.statusCode, body }));
    }).on('error', fail).end();
});

async function start(name) {
    const agentPort = await freePort();
    const node = await nodes.renderer(name, core, '--core-ca', path('cert.pem'), '--agent-port', String(agentPort),
        '--trusted-proxy', '198.51.100.0/24', '--trusted-proxy', HOST, ...served(name));
    return Object.assign(node, { agentPort });
}

setUp(options.skip, async (own) => {
    nodes = own(await Nodes.create());
    nodes.trustsLocal = false;
    makeCertificate(nodes.plant.folder, 'cert', ['plant.example', 'localhost', '127.0.0.1', HOST]);
    core = await nodes.core(0, '--trusted-proxy', HOST, ...served('core'));
    Object.defineProperty(core, 'url', { value: `wss://127.0.0.1:${core.port}` });
    renderers = [await start('r1'), await start('r2')];
    proxy = own(await Haproxy.start(renderers, core, null, { host: HOST, ca: path('cert.pem') }));
    await until('both nodes and the core up', async () => [...Object.values(await proxy.servers().catch(() => ({ none: {} }))),
        ...Object.values(await proxy.servers('core').catch(() => ({ none: {} })))].every(({ status }) => /^UP/.test(status)));
});

test('eighty sessions of twenty clients on two nodes are all admitted, with the default limits', options, async (t) => {
    const clients = [];
    t.after(() => clients.forEach((client) => client.close()));
    for (let i = 0; i < SESSIONS; i++) {
        const client = await PlainClient.open(proxy.port, { localAddress: `127.0.0.${10 + i % CLIENTS}` });
        clients.push(client);
        client.say({ type: 'hello', token: nodes.tokens.viewer, width: 64, height: 64, codecs: ['jpeg'] });
        await client.text('welcome', 20000);
    }
    assert.deepEqual(clients.map(({ closed }) => closed).filter(Boolean), []);
    const logins = () => [...audited('r1'), ...audited('r2')].filter(({ event, how }) => event === 'login' && how === 'stream');
    await until('all logins in the trail', () => logins().length === SESSIONS);
    assert.deepEqual([...new Set(logins().map(({ from }) => from))].sort(), Array.from({ length: CLIENTS }, (_, i) => `127.0.0.${10 + i}`));
});

test('only a client with wrong tokens is slowed, also when that client forges X-Forwarded-For', options, async () => {
    const [liar, user] = ['127.0.0.40', '127.0.0.41'];
    // the balancer sends the first request to the renderers and the second to the core, so both kinds of node are tested
    for (const page of ['/api/v1/tags', '/api/v1/history?tags=TI-1']) {
        const answers = [], forged = `X-Forwarded-For: ${user}\r\nForwarded: for=${user}\r\nX-Real-IP: ${user}\r\n`;
        // the client counts as slowed when its last six requests, which went to both nodes, were answered with 429 (too many
        // requests)
        const isSlowed = () => answers.length >= 6 && answers.slice(-6).every((status) => status === 429);
        while (!isSlowed() && answers.length < 200)
            answers.push(await ask(liar, bearer(WRONG, forged), page));
        assert.ok(answers.includes(401) && isSlowed(), answers.join(' '));
        assert.equal(await ask(user, bearer(nodes.tokens.viewer), page), 200);
    }
    for (const [name, node] of [['r1', renderers[0]], ['r2', renderers[1]], ['core', core]]) {
        await recorded(name, isRefused);
        assert.deepEqual([...new Set(audited(name).filter(isRefused).map(({ from }) => from))], [liar], name);
        assert.match(node.program.said, /login from 127\.0\.0\.40 by HTTP: token \(unknown\)/);
        assert.ok(!node.program.said.includes(`login from ${user} by HTTP: token (unknown)`));
    }
});

test('an action through a renderer is recorded with the client\'s address', options, async () => {
    const client = await PlainClient.open(proxy.port, { localAddress: '127.0.0.43' });
    client.say({ type: 'hello', token: nodes.tokens.operator, width: 64, height: 64, codecs: ['jpeg'] });
    await client.text('welcome');
    client.say({ type: 'note', seq: 1, tag: 'TI-1', text: 'permit 4711' });
    await client.text('notes');
    client.close();
    const note = await recorded('core', ({ event }) => event === 'note');
    assert.deepEqual([note?.who, note?.from], ['anna', '127.0.0.43']);
});

test('forwarded headers from a peer that is no trusted proxy are ignored', options, async () => {
    other = await nodes.start(['--port', String(await freePort()), '--history', path('other'), '--trusted-proxy', '198.51.100.1',
        ...served('other')]);
    const direct = (host, headers) => secure(other, headers, { host }).then(({ status }) => status);
    assert.equal(await direct(HOST, { Authorization: `Bearer ${WRONG}` }), 401);
    assert.equal((await recorded('other', isRefused)).from, HOST);
    assert.equal(await direct('127.0.0.1', { Authorization: `Bearer ${nodes.tokens.viewer}` }), 403, 'a local proxy needs --behind-proxy');
});

test('HAProxy accepts as renderer a renderer or a core that draws, and no other daemon; the answer says why', options, async () => {
    const asked = (node) => secure(node, {}, { page: '/readyz?role=render' });
    assert.equal((await asked(renderers[0])).status, 200);
    assert.equal((await asked(core)).status, 200);
    assert.equal((await secure(other, {}, { page: '/readyz' })).status, 200);
    const { status, body } = await asked(other);
    assert.deepEqual([status, /^not a renderer: this daemon was started without --role render/.test(body)], [503, true], body);
});

const NGINX = '/usr/sbin/nginx';
test('through nginx on another host, with the shipped configuration, the core sees the client\'s address, too',
    { ...options, skip: options.skip || (existsSync(NGINX) ? false : 'nginx is not installed') }, async (t) => {
        const port = await freePort(), client = '127.0.0.60';
        const shipped = readFileSync('deploy/proxy/nginx.conf', 'utf8').replace('listen 443 ssl', `listen 127.0.0.1:${port} ssl`)
            .replace('http://127.0.0.1:8080', `https://${HOST}:${core.port}`).replace('/etc/ssl/plantcast/fullchain.pem', path('cert.pem'))
            .replace('/etc/ssl/plantcast/privkey.pem', path('cert.key'));
        const temporary = ['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map((name) => `${name}_temp_path ${path(name)};`).join('\n');
        writeFileSync(path('nginx.conf'), `daemon off;\nmaster_process off;\npid ${path('nginx.pid')};\nerror_log stderr;\nevents {}\n` +
            `http {\naccess_log off;\n${temporary}\n${shipped}\n}\n`);
        const nginx = spawn(NGINX, ['-c', path('nginx.conf'), '-p', nodes.plant.folder], { stdio: 'ignore' });
        t.after(() => nginx.kill());
        const through = (token) => secure({ port }, { Authorization: `Bearer ${token}` }, { host: '127.0.0.1', localAddress: client });
        await until('nginx', async () => (await through(nodes.tokens.viewer).catch(() => ({}))).status === 200);
        assert.equal((await through(WRONG)).status, 401);
        await recorded('core', (line) => isRefused(line) === client);
    });
