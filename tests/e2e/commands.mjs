// SPDX-License-Identifier: GPL-3.0-or-later
// The command line as a client of the daemon: many commands at once over https, and through a proxy that serves the daemon
// below a path.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import { appendFileSync, copyFileSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer as createHttpServer } from 'node:http';
import { connect, createServer } from 'node:net';
import { join } from 'node:path';
import { after, afterEach, test } from 'node:test';
import { createServer as createTlsServer } from 'node:tls';
import { makeCertificate } from './support/certificate.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { long } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { BIN, notBuilt, TinyPlant } from './support/tiny_plant.mjs';

const skip = notBuilt();
const H264 = 'plantcast-h264.so', noFilms = skip || (existsSync(join(BIN, H264)) ? false : 'built without H.264');
const SESSIONS = 10, PROBES = 10, TOGETHER = 2;
let plant, proxy, cert;

// A minimal proxy: passes requests for /b/... on without that prefix, and answers 404 to all others.
function serveBelow(base, port) {
    return createServer((client) => {
        client.once('data', (head) => {
            const text = head.toString('latin1');
            if (!text.startsWith(`GET ${base}/`))
                return client.end('HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n');
            const server = connect(port, '127.0.0.1', () => server.write(Buffer.from(text.replace(`GET ${base}/`, 'GET /'), 'latin1')));
            server.on('error', () => client.destroy());
            client.pipe(server).pipe(client);
            return undefined;
        });
        client.on('error', () => {});
    });
}

const runIn = (folder, ...args) => new Promise((done) => {
    const child = spawn(join(folder, 'plantcast'), args, { stdio: ['ignore', 'pipe', 'pipe'] });
    let out = '', err = '';
    child.stdout.on('data', (chunk) => { out += chunk; });
    child.stderr.on('data', (chunk) => { err += chunk; });
    child.once('exit', (code) => done({ code, out, err }));
});

const run = (...args) => runIn(BIN, ...args);

setUp(skip, async () => {
    plant = await TinyPlant.create();
    assert.equal(plant.prepare().code, 0);
    cert = join(plant.folder, 'cert.pem');
    makeCertificate(plant.folder, 'cert');
});
afterEach(() => plant?.daemon?.stop());
after(async () => {
    proxy?.close();
    await plant?.destroy();
});

test(`${SESSIONS * PROBES} connections over https, ${SESSIONS * TOGETHER} at once, all succeed`, { skip, timeout: 300000 }, async () => {
    await plant.startDaemon('--tls-cert', cert, '--tls-key', join(plant.folder, 'cert.key'));
    const probe = () => run('probe', `https://localhost:${plant.port}/`, '--ca', cert, '--sessions', String(SESSIONS), '--seconds', '0.2',
        '--motion', 'still', '--size', '64x36');
    for (let i = 0; i < PROBES; i += TOGETHER)
        for (const { code, err } of await Promise.all(Array.from({ length: TOGETHER }, probe)))
            assert.deepEqual([code, err], [0, '']);
});

test('under a proxy\'s path prefix, tags, snapshot and stream work', { skip, timeout: 100000 }, async () => {
    await plant.startDaemon();
    proxy = serveBelow('/b', plant.port).listen(0, '127.0.0.1');
    await new Promise((done) => proxy.once('listening', done));
    const at = `http://127.0.0.1:${proxy.address().port}`;
    for (const url of [`${at}/b`, `${at}/b/`]) {
        const tags = await run('tags', url);
        assert.equal(tags.code, 0, tags.err);
        assert.match(tags.out, /TI-1/);
    }
    for (const more of [[], ['--blind']]) {
        const probe = await run('probe', `${at}/b/`, '--sessions', '1', '--seconds', '0.5', '--motion', 'still', ...more);
        assert.equal(probe.code, 0, probe.err);
    }
    const wrong = await run('tags', at);
    assert.equal(wrong.code, 1);
    assert.match(wrong.err, /404/);
    assert.equal((await run('tags', `${at}/b?x=1`)).code, 2, 'a query in the URL\'s path is refused');
});

test('snapshot --view accepts views of the plant file and of the page, by id or title, with or without a daemon', { skip, timeout: 100000 },
    async () => {
        const tokens = join(plant.folder, 'view_tokens'), token = (name) => join(plant.folder, `${name}.token`);
        for (const [name, ...more] of [['all', '--role', 'operator'], ['some', '--role', 'viewer', '--views', 'boxes']])
            writeFileSync(token(name), (await run('token', 'add', tokens, '--name', name, ...more)).out);
        appendFileSync(plant.file, // The view sets `power`, which only engineers may set themselves.
            'views: [{ id: boxes, title: Both boxes, view: "group=temperature&power=3&camera=0,-8,0,0,0,0,0,0,1,30" }]\n');
        await plant.startDaemon('--tokens', tokens);
        const bearer = `Authorization: Bearer ${readFileSync(token('all'), 'utf8').trim()}`;
        const client = await PlainClient.open(plant.port, { headers: [bearer] });
        await client.hello();
        const save = async (id, title, view) => {
            client.say({ type: 'save_view', seq: 1, id, title, view });
            assert.equal((await client.text('view_saved')).kept, true);
        };
        await save('pump', 'Pump, close', 'group=pressure&camera=9,0,0,3,0,0,0,0,1,30,2&at=5&hide=E-101&tag=PI-1');
        await save('pump-2', 'Twice', 'group=pressure');
        await save('pump-3', 'Twice', 'group=pressure');
        client.close();
        const url = `http://127.0.0.1:${plant.port}/`, png = join(plant.folder, 'view.png');
        const there = async (from, view, ...more) => {
            const { code, out, err } = await run('snapshot', from, '--view', view, '--size', '320x180', '--pick', '160,90', ...more);
            assert.equal(code, 0, err);
            const { asset, unit, position } = JSON.parse(out);
            return [asset, unit, ...position.map((x) => Math.round(x * 100) / 100)];
        };
        const refused = async (from, why, ...more) => {
            const { code, err } = await run('snapshot', from, '-o', png, ...more);
            assert.equal(code, 1);
            assert.match(err, why);
        };
        const front = ['E-101', '°C', 0, -0.5, 0], pump = ['P-101A', 'bar', 3.5, 0, 0], mine = ['--token-file', token('all')];
        for (const [from, ...more] of [[url, ...mine], [plant.file]]) {
            assert.deepEqual(await there(from, 'boxes', ...more), front);
            assert.deepEqual(await there(from, 'Both boxes', ...more), front);
            assert.deepEqual(await there(from, 'pump', ...more), pump);
            assert.deepEqual(await there(from, 'Pump, close', ...more), pump);
            assert.deepEqual(await there(from, 'pump', ...more, '--camera', '3,-8,0,3,0,0'), ['P-101A', 'bar', 3, -0.5, 0]);
            assert.deepEqual(await there(from, 'pump', ...more, '--hide', '', '--camera', '0,-8,0,0,0,0', '--group', 'temperature'), front);
            for (const name of ['pimp', 'Twice'])
                await refused(from, new RegExp(`'${name}' is neither the id of a view nor the title of exactly one view; ` +
                    'ids and titles of the views:\n  boxes +Both boxes\n  pump +Pump, close\n  pump-2 +Twice\n  pump-3 +Twice\n$'),
                '--view', name, ...more);
        }
        assert.equal((await run('snapshot', url, '--view', 'boxes', '-o', png, '--token-file', token('some'))).code, 0);
        await refused(url, /HTTP status 403: .*boxes/, '--view', 'pump', '--token-file', token('some'));
        await refused(url, /HTTP status 401/, '--view', 'pump');
    });

// Serves one answer: `head`, `first`, then 2000 bytes of a picture. Then closes the connection, unless `stalls`. tls: serves over TLS, and
// closes the connection without a TLS message.
async function serveCutOff(head, first, stalls, tls) {
    const serve = (client) => {
        client.on('error', () => {});
        client.once('data', () => {
            client.write(`HTTP/1.1 200 OK\r\nContent-Type: image/png\r\n${head}\r\n${first}`);
            client.write(Buffer.alloc(2000, 7), () => stalls || (tls ? client.destroy() : client.end()));
        });
    };
    const key = () => readFileSync(join(plant.folder, 'cert.key'));
    const server = (tls ? createTlsServer({ cert: readFileSync(cert), key: key() }, serve) : createServer(serve)).listen(0, '127.0.0.1');
    await once(server, 'listening');
    return server;
}

async function saveCutOff(t, head, first = '', { stalls = false, tls = false } = {}) {
    const server = await serveCutOff(head, first, stalls, tls), png = join(plant.folder, 'cut.png');
    t.after(() => server.close());
    writeFileSync(png, 'the old picture');
    const { code, err } = await run('snapshot', `http${tls ? 's' : ''}://127.0.0.1:${server.address().port}/`, '--ca', cert, '-o', png);
    return { code, err, saved: readFileSync(png) };
}

test('snapshot leaves the old file if the answer is cut off; it accepts one that ends with the connection', { skip, timeout: 100000 },
    async (t) => {
        const cut = await saveCutOff(t, 'Content-Length: 5000\r\n');
        assert.equal(cut.code, 1);
        assert.match(cut.err, /the answer is incomplete/);
        assert.equal(String(cut.saved), 'the old picture');
        const chunked = await saveCutOff(t, 'Transfer-Encoding: chunked\r\n', '7d0\r\n'); // the last chunk is missing
        assert.deepEqual([chunked.code, String(chunked.saved)], [1, 'the old picture']);
        assert.match(chunked.err, /the answer is incomplete/);
        const overTls = await saveCutOff(t, 'Content-Length: 5000\r\n', '', { tls: true });
        assert.deepEqual([overTls.code, String(overTls.saved)], [1, 'the old picture']);
        assert.match(overTls.err, /the answer is incomplete: the connection ended too early\n$/);
        const whole = await saveCutOff(t, 'Connection: close\r\n');
        assert.deepEqual([whole.code, whole.err, whole.saved.length], [0, '', 2000]);
    });

test('an error names --ca only if the certificate is not trusted', { skip, timeout: 100000 }, async (t) => {
    const untrusted = await serveCutOff('Content-Length: 5000\r\n', '', false, true);
    const closing = createServer((client) => client.once('data', () => client.end())); // ends the connection before a certificate is sent
    await once(closing.listen(0, '127.0.0.1'), 'listening');
    for (const server of [untrusted, closing]) {
        t.after(() => server.close());
        const { code, err } = await run('tags', `https://127.0.0.1:${server.address().port}/`);
        assert.deepEqual([code, /pass the certificate of the daemon or of its authority with --ca FILE\n$/.test(err)],
            [1, server === untrusted], err);
    }
});

test('an error names the server to which another one redirects, if it does not get the token', { skip, timeout: 100000 }, async (t) => {
    const token = join(plant.folder, 'token'), urlOf = (server) => `http://127.0.0.1:${server.address().port}/`;
    writeFileSync(token, 'a'.repeat(32));
    const target = createHttpServer((request, answer) => answer.writeHead(request.headers.authorization ? 200 : 401).end('[]'));
    const first = createHttpServer((request, answer) => answer.writeHead(302, { location: urlOf(target) }).end());
    for (const server of [target, first]) {
        await once(server.listen(0, '127.0.0.1'), 'listening');
        t.after(() => server.close());
    }
    const { code, err } = await run('tags', urlOf(first), '--token-file', token);
    assert.equal(code, 1);
    assert.ok(err.includes(`the server redirects to ${urlOf(target)}, and the token is not sent to another server`), err);
});

test('snapshot ends if the server stops sending for a minute', { skip: skip || long, timeout: 150000 }, async (t) => {
    const { code, err, saved } = await saveCutOff(t, 'Content-Length: 5000\r\n', '', { stalls: true });
    assert.deepEqual([code, String(saved)], [1, 'the old picture']);
    assert.match(err, /the server has stopped sending/);
});

// Imports two readings of each tag, which are one minute old.
async function record(...tags) {
    const file = join(plant.folder, 'points.csv'), from = Math.floor(Date.now() / 1000) - 60;
    writeFileSync(file, `Tag,Time,Value\n${tags.map((tag) => `${tag},${from},20\n${tag},${from + 1},21\n`).join('')}`);
    const { code, err } = await run('history', 'import', plant.file, file);
    assert.equal(code, 0, err);
}

test('history export continues after a tag that the plant lacks, and reads tag names from a file', { skip }, async () => {
    await record('TI-1', 'TI-2');
    const names = join(plant.folder, 'names'), lists = (list) => run('history', 'export', plant.file, '--tags', list);
    const tags = (out) => [...new Set(out.match(/^TI-\d(?=,)/gm))];
    writeFileSync(names, '\uFEFFTI-1\r\n\nGONE\nTI-2\n');
    for (const list of ['TI-1,GONE,TI-2', `@${names}`]) {
        const { code, out, err } = await lists(list);
        assert.deepEqual([code, tags(out), err], [1, ['TI-1', 'TI-2'], `plantcast: ${plant.file}: the plant has no tag 'GONE'\n`]);
    }
    writeFileSync(names, 'TI-2');
    const { code, out, err } = await lists(`@${names}`);
    assert.deepEqual([code, tags(out), err], [0, ['TI-2'], '']);
    writeFileSync(names, '\n');
    for (const [list, why] of [[`@${names}`, /no tag names/], ['', /no tag names/], [`@${names}.csv`, /No such file/]]) {
        const wrong = await lists(list);
        assert.deepEqual([wrong.code, why.test(wrong.err)], [1, true], wrong.err);
    }
});

test('a command fails if its output cannot be written', { skip, timeout: 100000 }, async () => {
    await plant.startDaemon();
    await record('TI-1');
    const url = `http://127.0.0.1:${plant.port}/`, model = join(plant.folder, 'box.gltf'), tokens = join(plant.folder, 'unprinted');
    const toFull = (program, ...args) => spawnSync('sh', ['-c', 'exec "$@" >/dev/full', 'sh', join(BIN, program), ...args],
        { encoding: 'utf8' });
    for (const [program, ...args] of [['plantcast', '--help'], ['plantcast', 'history', 'export', plant.file, '--tags', 'TI-1'],
        ['plantcast', 'tags', url], ['plantcast', 'snapshot', url, '--size', '64x64', '--pick', '32,32'], ['plantcast', 'nodes', model],
        ['plantcast', 'match', '--help'], ...(noFilms ? [] : [['plantcast', 'clip', '--help']]), ['plantcastd', '--check', plant.file],
        ['plantcastd', '--version'], ['plantcast-prep', '--help'],
        ['plantcast', 'token', 'add', tokens, '--role', 'viewer', '--name', 'x']]) {
        const { status, stderr } = toFull(program, ...args), what = `${program} ${args.join(' ')}: ${stderr}`;
        assert.equal(status, 1, what);
        assert.match(stderr, /: standard output could not be written(: No space left on device)?\n$/, what);
    }
    assert.equal(readFileSync(tokens, 'utf8'), '', 'no token stays that nobody has seen');
    const toClosedPipe = 'mkfifo "$1.pipe" && exec 3<>"$1.pipe" 4>"$1.pipe" 3<&- && exec "$0" token add "$1" --role viewer --name x >&4';
    const { status, stderr } = spawnSync('sh', ['-c', toClosedPipe, join(BIN, 'plantcast'), tokens], { encoding: 'utf8' });
    assert.equal(status, 1, stderr);
    assert.match(stderr, /the new token could not be printed and was removed again/);
    assert.equal(readFileSync(tokens, 'utf8'), '', 'no token stays whose reader has gone');
});

test('a snapshot without a daemon marks tags that have not passed their loop check', { skip }, async () => {
    const values = join(plant.folder, 'values.csv'), history = join(plant.folder, 'checks');
    mkdirSync(history);
    writeFileSync(values, 'TI-1,80\nTI-2,20\n');
    const draw = async () => {
        const png = join(plant.folder, 'checks.png'), { code, err } = await run('snapshot', plant.file, '-o', png, '--values', values,
            '--at', '2026-01-01T00:00:00Z', '--history', history, '--fit', 'E-101', '--side', 'iso');
        assert.equal(code, 0, err);
        return readFileSync(png);
    };
    const before = await draw();
    assert.deepEqual(await draw(), before);
    writeFileSync(join(history, 'proofs.csv'), 'Time,Tag Name,Result,Value,Unit,Expected,Tolerance,By,Remark,Fingerprint\n' +
        '2026-01-01T00:00:00Z,"TI-1",fail,1,"°C",2,0.5,"kim","",0123456789abcdef\n');
    assert.notDeepEqual(await draw(), before);
    const recording = readFileSync(plant.file, 'utf8');
    writeFileSync(plant.file, `${recording.trimEnd()}\nhistory: { record: no }\n`);
    const unrecorded = await draw();
    rmSync(join(history, 'proofs.csv'));
    assert.deepEqual(await draw(), unrecorded, 'a plant without history has no loop checks');
    writeFileSync(plant.file, recording);
});

const film = (url, ...more) => ['clip', url, '-o', join(plant.folder, 'film.mp4'), '--from', '-20s', '--to', '-10s', '--speed', '10',
    '--fps', '1', '--size', '64x64', ...more];

test('a subcommand that is its own program also gets the certificates and the token', { skip: noFilms, timeout: 100000 }, async () => {
    const tokens = join(plant.folder, 'tokens'), mine = join(plant.folder, 'mine');
    writeFileSync(mine, (await run('token', 'add', tokens, '--role', 'viewer', '--name', 'films')).out);
    await plant.startDaemon('--tls-cert', cert, '--tls-key', join(plant.folder, 'cert.key'), '--tokens', tokens);
    const url = `https://localhost:${plant.port}/`;
    for (const [more, why] of [[[], /pass the certificate of the daemon/], [['--ca', cert], /HTTP status 401/]]) {
        const { code, err } = await run(...film(url, ...more));
        assert.equal(code, 1, err);
        assert.match(err, why);
    }
    const { code, out, err } = await run('--token-file', mine, ...film(url, '--ca', cert));
    assert.equal(code, 0, err);
    assert.match(out, /film\.mp4: \d+ frames/);
});

test('an error names a missing or damaged library or program that a command needs', { skip: noFilms, timeout: 100000 }, async () => {
    const bin = join(plant.folder, 'bin'), modules = join(plant.folder, 'lib/plantcast');
    mkdirSync(bin);
    mkdirSync(modules, { recursive: true });
    copyFileSync(join(BIN, 'plantcast'), join(bin, 'plantcast'));
    await plant.startDaemon();
    const url = `http://127.0.0.1:${plant.port}/`;
    const probe = () => runIn(bin, 'probe', url, '--codec', 'h264', '--sessions', '1', '--seconds', '0.5', '--size', '64x36');
    const refused = ({ code, err }, why) => {
        assert.equal(code, 1, err);
        assert.match(err, why);
    };
    refused(await runIn(bin, ...film(url)), /bin\/plantcast-film: No such file or directory: install the package plantcast-h264$/m);
    const where = /h264: plantcast-h264\.so is missing: install the package plantcast-h264 \(searched next to \S+\/bin\/plantcast and in/;
    refused(await probe(), where);
    writeFileSync(join(modules, H264), 'no program');
    refused(await probe(), /lib\/plantcast\/plantcast-h264\.so cannot be loaded: .*(too short|invalid ELF)/);
    copyFileSync(join(BIN, H264), join(modules, H264));
    const { code, out, err } = await probe();
    assert.equal(code, 0, err);
    assert.match(out, /decode/);
});
