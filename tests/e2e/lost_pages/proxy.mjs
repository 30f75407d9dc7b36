// SPDX-License-Identifier: GPL-3.0-or-later
// Proxies that pass pages but no WebSocket: the page, the log and the command line name the proxy and state what it must do.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer, request } from 'node:http';
import { createServer as createSecureServer } from 'node:https';
import { connect } from 'node:net';
import { join } from 'node:path';
import { test } from 'node:test';
import { DESKTOP, openPage, PHONE, shoot, waitForPicture, withPage } from '../support/browser.mjs';
import { makeCertificate } from '../support/certificate.mjs';
import { freePort } from '../support/ports.mjs';
import { setUp } from '../support/set_up.mjs';
import { notBuilt, Program, runProgram, TinyPlant } from '../support/tiny_plant.mjs';
import { until } from '../support/until.mjs';

const PASSES = 'proxy_http_version 1.1; proxy_set_header Upgrade $http_upgrade; proxy_set_header Connection "upgrade";';
const NGINX = '/usr/sbin/nginx', LINES = /proxy_set_header Upgrade \$http_upgrade; proxy_set_header Connection "upgrade";/;
const options = { skip: notBuilt(), timeout: 200000 };
const withNginx = { ...options, skip: options.skip || (existsSync(NGINX) ? false : 'nginx is not installed') };
let plant;

setUp(options.skip, async (own) => {
    plant = own(await TinyPlant.create());
    await plant.start();
    await plant.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
});

// Starts nginx, which serves the plant below /plantcast/. more: further configuration lines for that location; host: host name
// that nginx passes on.
async function startNginx(port, more, host = '$http_host') {
    const path = (name) => join(plant.folder, name);
    const temporary = ['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map((name) => `${name}_temp_path ${path(name)};`).join('\n');
    writeFileSync(path('nginx.conf'), `daemon off;\nmaster_process off;\npid ${path('nginx.pid')};\nerror_log stderr;\nevents {}
http {\naccess_log off;\n${temporary}\nserver { listen 127.0.0.1:${port};
location /plantcast/ { proxy_pass http://127.0.0.1:${plant.port}/; proxy_set_header Host ${host}; ${more} } } }\n`);
    const nginx = spawn(NGINX, ['-c', path('nginx.conf'), '-p', plant.folder], { stdio: ['ignore', 'ignore', 'pipe'] });
    const ended = new Promise((done) => nginx.once('exit', done));
    await until('nginx', () => fetch(`http://127.0.0.1:${port}/plantcast/healthz`).then(({ ok }) => ok, () => false));
    return async () => { nginx.kill(); await ended; };
}

const shown = (page, pattern) => page.waitForFunction(([source]) => new RegExp(source).test(document.getElementById('banner').innerText),
    [pattern.source]);

test('a page behind nginx without WebSocket lines names nginx and the lines; with the lines the page goes live', withNginx, async () => {
    const port = await freePort(), url = `http://127.0.0.1:${port}/plantcast/`;
    let stop = await startNginx(port, 'proxy_http_version 1.1;');
    const began = performance.now();
    const desk = await openPage(url, DESKTOP);
    try {
        await shown(desk.page, /The server answers over HTTP, but nginx does not pass the WebSocket on/);
        await shown(desk.page, LINES);
        await shoot(desk.page, 'proxy-desk');
        for (const [name, query, screen, words] of [['phone', '?lang=de', PHONE, /nginx leitet den WebSocket nicht weiter/],
            ['wall', '?wall', DESKTOP, /nginx does not pass/],
            ['pane', '?wall=55,3&pane=views&hangs=x', DESKTOP, /nginx does not pass/],
            ['korean', '?lang=ko', DESKTOP, /WebSocket을 전달하지 않습니다/]]) {
            await withPage(`${url}${query}`, screen, async (page) => {
                await shown(page, words);
                await shown(page, LINES);
                await shoot(page, `proxy-${name}`);
                assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth),
                    `${name}: nothing extends beyond the page`);
            });
        }
        await plant.daemon.line(/stream: a request from 127\.0\.0\.1 came without Upgrade: websocket, although it is a WebSocket/);
        const minutes = Math.floor((performance.now() - began) / 60000);
        assert.ok(plant.daemon.said.match(/came without Upgrade/g).length <= 1 + minutes, 'the daemon logs one line a minute');
        const answer = await fetch(`http://127.0.0.1:${plant.port}/stream`);
        assert.equal(answer.status, 426);
        assert.match(await answer.text(), /^426 Upgrade Required: /);
        for (const args of [['ready', url], ['probe', url, '--seconds', '1'], ['probe', url, '--seconds', '1', '--blind']]) {
            const { code, err } = runProgram('plantcast', args);
            assert.equal(code, 1, err);
            assert.match(err, /the server answers over HTTP, but does not accept a WebSocket/);
            assert.match(err, LINES);
        }
        assert.equal(runProgram('plantcast', ['ready', `http://127.0.0.1:${plant.port}/`]).code, 0);
        await stop();
        // nginx passes on the WebSocket handshake with a host name that differs from that of the page, so the server refuses
        // its origin
        stop = await startNginx(port, PASSES, `127.0.0.1:${plant.port}`);
        await shown(desk.page, /his origin is not allowed/);
        await stop();
        stop = await startNginx(port, PASSES);
        await waitForPicture(desk.page);
        assert.equal(runProgram('plantcast', ['ready', url]).code, 0);
    } finally {
        await desk.close();
        await stop();
    }
});

const PASS = { passes: true };

// Starts a proxy that answers WebSocket handshakes itself and passes on all other requests. answer: its status line and status
// code for handshakes; null: it closes the connection; PASS: it passes on handshakes too. headers: added to all answers; tls:
// key and certificate, or null for plain http.
async function startOther(answer, headers, tls = null) {
    const serve = (asked, told) => {
        const on = request({ port: plant.port, path: asked.url, headers: { ...asked.headers, host: `127.0.0.1:${plant.port}` } }, (got) => {
            told.writeHead(asked.url.startsWith('/stream') && answer?.code ? answer.code : got.statusCode, { ...got.headers, ...headers });
            got.pipe(told);
        });
        on.on('error', () => { told.writeHead(502, headers); told.end(); });
        asked.pipe(on);
    };
    const server = tls ? createSecureServer(tls, serve) : createServer(serve);
    const refusal = answer?.line ? `HTTP/1.1 ${answer.line}\r\nContent-Length: 4\r\n\r\npage` : '';
    server.on('upgrade', (asked, socket) => {
        if (answer !== PASS) {
            socket.end(refusal);
            return;
        }
        const on = connect(plant.port, '127.0.0.1'), head = asked.rawHeaders.map((text, i) => text + (i % 2 ? '\r\n' : ': ')).join('');
        on.write(`GET ${asked.url} HTTP/1.1\r\n${head}\r\n`);
        on.pipe(socket).on('error', () => on.destroy());
        socket.pipe(on).on('error', () => socket.destroy());
    });
    const port = await freePort();
    await new Promise((done) => server.listen(port, '127.0.0.1', done));
    return { url: `http${tls ? 's' : ''}://127.0.0.1:${port}/`, stop: () => { server.closeAllConnections(); server.close(); } };
}

const OTHERS = [
    ['answers 200 with a page', { line: '200 OK', code: 200 }, { via: '1.1 gate.example (squid)' },
        /gate\.example does not pass the WebSocket on/],
    ['answers 400', { line: '400 Bad Request' }, { server: 'Apache/2.4' }, /Apache does not pass the WebSocket on\. PROXY\.md/],
    ['answers 404', { line: '404 Not Found', code: 404 }, {}, /a proxy in between does not pass the WebSocket on/],
    ['hangs up', null, {}, /a proxy in between does not pass the WebSocket on/],
];
for (const [name, answer, headers, words] of OTHERS)
    test(`a proxy that ${name} instead of passing WebSockets is named`, options, async () => {
        const proxy = await startOther(answer, headers), { page, close } = await openPage(proxy.url, DESKTOP);
        try {
            await shown(page, words);
        } finally {
            await close();
            proxy.stop();
        }
    });

test('plantcast ready fails where /stream does, over http and https, and names the proxy that blocks WebSockets', options, async () => {
    makeCertificate(plant.folder, 'mail');
    const secure = { key: readFileSync(join(plant.folder, 'mail.key')), cert: readFileSync(join(plant.folder, 'mail.pem')) };
    const ready = async (proxy) => { // Runs `plantcast ready` without blocking this process, which also runs the proxy.
        const program = new Program('plantcast', ['ready', proxy.url, '--ca', join(plant.folder, 'mail.pem')]);
        const code = await new Promise((done) => program.child.once('close', done));
        return { code, err: program.said };
    };
    for (const tls of [null, secure]) {
        for (const [answer, words] of [
            [{ line: '502 Bad Gateway', code: 502 }, /not ready: the server answers \/stream with HTTP status 502/],
            [{ line: '200 OK', code: 200 }, /a proxy in front of the server answered \/stream with HTTP status 200/],
            [{ line: '400 Bad Request' }, /does not accept a WebSocket/]]) {
            const proxy = await startOther(answer, {}, tls), { code, err } = await ready(proxy);
            proxy.stop();
            assert.equal(code, 1, err);
            assert.match(err, words);
        }
        const proxy = await startOther(PASS, {}, tls), { code, err } = await ready(proxy);
        proxy.stop();
        assert.equal(code, 0, err);
    }
});

test('when the server is down, no proxy is blamed', options, async () => {
    const proxy = await startOther({ line: '502 Bad Gateway' }, { server: 'nginx' }), { page, close } = await openPage(proxy.url, DESKTOP);
    try {
        await shown(page, /nginx does not pass the WebSocket on/);
        await plant.daemon.stop();
        await page.evaluate(() => globalThis.plantcast.session.connection.retryNow());
        await shown(page, /The server cannot be reached/);
    } finally {
        await close();
        proxy.stop();
    }
});
