// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon as a service: its messages to the service manager, restarts by the manager, its log and metrics, and how a refused
// reload stays visible.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { PlainClient, get } from './support/plain_client.mjs';
import { freePort } from './support/ports.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { BIN, notBuilt, runProgram, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
const has = (program) => spawnSync('which', [program]).status === 0;
const WATCHDOG_S = 10, WITHIN_S = 30; // as in the systemd unit
// how long to wait for the daemon's outputs to close after its exit: a child process that outlives the daemon may keep them
// open
const DESCENDANT_MS = 2000;
let plant, runtime;
const running = new Set();

// Starts plantcastd under a fake service manager. Returns { out: lines of the manager, err: stderr of the daemon, pid,
// order(line): sends the manager a command, ended: a promise of the exit code }.
function serve(args, managed = []) {
    const child = spawn('tests/support/service_manager.py', [...managed, join(BIN, 'plantcastd'), plant.file, ...args],
        { stdio: 'pipe', env: { ...process.env, RUNTIME_DIRECTORY: runtime } });
    const service = { out: '', err: '', child, order: (line) => child.stdin.write(`${line}\n`) };
    child.stdout.on('data', (chunk) => { service.out += chunk; });
    child.stderr.on('data', (chunk) => { service.err += chunk; });
    const closed = new Promise((done) => child.once('close', done));
    service.ended = new Promise((done) => child.once('exit', async (code) => {
        running.delete(child);
        // waits for the last output, which may still be in the pipe after the process has exited
        await Promise.race([closed, sleep(DESCENDANT_MS, null, { ref: false })]);
        service.isOver = true;
        done(code);
    }));
    const waiting = (stream) => async (pattern, timeoutMs = 60000) => {
        for (const end = performance.now() + timeoutMs; performance.now() < end; await new Promise((done) => setTimeout(done, 20))) {
            const found = service[stream].match(pattern);
            if (found)
                return found;
            if (service.isOver)
                break;
        }
        throw new Error(`no ${pattern} in:\n${service.out}\n${service.err}`);
    };
    service.said = waiting('out');
    service.logged = waiting('err');
    service.stop = () => { child.kill('SIGTERM'); return service.ended; };
    service.pid = async () => Number((await service.said(/^started: (\d+)$/m))[1]);
    running.add(child);
    return service;
}

setUp(skip, async () => {
    plant = await TinyPlant.create();
    runtime = mkdtempSync(join(tmpdir(), 'plantcast-runtime-'));
    assert.equal(plant.prepare().code, 0);
});
after(async () => {
    for (const child of running)
        child.kill('SIGTERM');
    await plant?.destroy();
    if (runtime)
        rmSync(runtime, { recursive: true });
});

test('the service manager is notified of the start, of readiness once /readyz is 200, and of the end', { skip }, async () => {
    const port = await freePort(), service = serve(['--port', String(port)]);
    await service.said(/^notify: EXTEND_TIMEOUT_USEC=60000000$/m);
    await service.said(/^notify: READY=1$/m);
    assert.equal((await get(port, '/readyz')).status, 200);
    assert.equal(await service.stop(), 0, service.err);
    assert.match(service.out, /notify: STATUS=drawing the first picture\n[^]*notify: READY=1\n[^]*notify: STOPPING=1\n/);
});

test('plantcast-prep asks the service manager for more time while it works', { skip }, () => {
    const { status, stdout } = spawnSync('tests/support/service_manager.py', [join(BIN, 'plantcast-prep'), plant.file],
        { encoding: 'utf8', timeout: 60000 });
    assert.equal(status, 0);
    assert.match(stdout, /^notify: EXTEND_TIMEOUT_USEC=60000000\nnotify: STATUS=preparing/m);
});

// A plant whose preparation never ends, because a program that makes one of its models never ends.
async function unprepared() {
    const tiny = await TinyPlant.create();
    assert.equal(tiny.prepare().code, 0);
    const text = readFileSync(tiny.file, 'utf8');
    writeFileSync(join(tiny.folder, 'more.cad'), '');
    writeFileSync(tiny.file, text.replace('groups:', '  - { id: MORE, model: more.glb }\nconvert:\n' +
        '  - { model: more.glb, from: more.cad, command: exec sleep 300 }\ngroups:'));
    return tiny;
}

test('a start that prepares the plant asks for more time meanwhile, and ends on SIGTERM', { skip }, async () => {
    const tiny = await unprepared(), was = plant;
    try {
        plant = tiny;
        const port = await freePort(), service = serve(['--port', String(port)]);
        // reported twice while plantcast-prep runs
        await service.said(/(notify: EXTEND_TIMEOUT_USEC=60000000\nnotify: STATUS=preparing the plant\n[^]*){2}/);
        // the log, too, says that the plant is being prepared, and for how long
        await service.logged(/^plantcastd: preparing the plant, for \d+ s so far$/m);
        await assert.rejects(get(port, '/readyz'), { code: 'ECONNREFUSED' }, 'the daemon is not ready yet');
        assert.doesNotMatch(service.out, /READY=1/);
        assert.equal(await service.stop(), 0, service.err);
        assert.match(service.err, /stopping while plantcast-prep prepares the plant; the next start continues/);
    } finally {
        plant = was;
        await tiny.destroy();
    }
});

const alone = spawnSync('unshare', ['--pid', '--fork', 'true']).status === 0 ? skip : 'there are no process namespaces';

test('as the first process of a container, the daemon ends on SIGTERM while it prepares the plant', { skip: alone }, async (t) => {
    const tiny = await unprepared();
    t.after(() => tiny.destroy());
    const child = spawn('unshare', ['--pid', '--fork', '--kill-child', join(BIN, 'plantcastd'), tiny.file, '--port', '0'],
        { stdio: 'pipe' });
    let said = '';
    child.stderr.on('data', (chunk) => { said += chunk; });
    const ended = new Promise((done) => child.once('exit', (code) => done(code)));
    await until('a model that is made', () => /creating .*more\.glb/.test(said), 30, () => said);
    const [first] = readFileSync(`/proc/${child.pid}/task/${child.pid}/children`, 'utf8').split(' ');
    process.kill(Number(first), 'SIGTERM');
    assert.equal(await ended, 0, said);
    assert.match(said, /stopping while plantcast-prep prepares the plant; the next start continues/);
});

for (const [thread, what] of [['render', 'the render thread'], ['plantcastd', 'the loop']])
    test(`if ${what} hangs, the watchdog ends the daemon within ${WITHIN_S} s, and not before`, { skip, timeout: 240000 }, async (t) => {
        const service = serve(['--port', '0'], ['--watchdog', String(WATCHDOG_S)]);
        await service.said(/^notify: READY=1$/m);
        // six watchdog messages, 2 s apart, take 12 s: longer than the watchdog's 10 s, so the daemon was alive because of them
        await service.said(/(notify: WATCHDOG=1[^]*){6}/);
        service.order(`freeze ${thread}`);
        await service.said(new RegExp(`^frozen: ${thread}$`, 'm'));
        const began = performance.now();
        assert.equal(await service.ended, 99, service.out);
        const took_ms = performance.now() - began;
        console.log(`# ${what}: ended after ${(took_ms / 1000).toFixed(1)} s`);
        promise(t, 'until it ended', took_ms, 1000 * WITHIN_S);
        if (thread === 'render')
            assert.match(service.err, /the thread that draws pictures makes no progress; the service manager will start the daemon again/);
    });

test('during a restart connections wait in the manager\'s socket; clients are told when the daemon will be back',
    { skip, timeout: 120000 }, async () => {
        // --port 1 would fail, but plantcastd ignores --port when the service manager passes it a listening socket
        const service = serve(['--port', '1'], ['--socket']);
        const port = Number((await service.said(/^port: (\d+)$/m))[1]);
        assert.equal((await get(port, '/readyz')).status, 200, 'a request sent before the daemon ran is answered');
        assert.equal(runProgram('plantcast', ['ready', `http://127.0.0.1:${port}/`]).code, 0);
        assert.equal(runProgram('plantcast', ['ready', 'http://127.0.0.1:1/']).code, 1);
        const client = await PlainClient.open(port);
        await client.hello();
        service.order('again');
        const closed = await client.until('a close', (c) => c.closed);
        assert.equal(closed.code, 1001);
        assert.match(closed.text, /^the server is stopping; retry after \d+ s$/);
        const answers = [];
        for (let i = 0; i < 20; i++) {
            answers.push(get(port, '/healthz'));
            await new Promise((done) => setTimeout(done, 50));
        }
        assert.deepEqual([...new Set((await Promise.all(answers)).map(({ status }) => status))], [200], 'no request was refused');
        await service.said(/(^started: [^]*){2}/m);
        assert.equal((await get(port, '/healthz')).status, 200, 'the second daemon answers, too');
        await service.stop();
    });

test('each request sent while the daemon restarts is answered, by the old daemon or the new one', { skip, timeout: 120000 }, async () => {
    const service = serve(['--port', '1'], ['--socket']), port = Number((await service.said(/^port: (\d+)$/m))[1]);
    for (let round = 1; round <= 4; round++) {
        await service.said(new RegExp(`(^notify: READY=1$[^]*){${round}}`, 'm'));
        const answers = [];
        service.order('again');
        for (const began = performance.now(); performance.now() - began < 300; await new Promise((done) => setTimeout(done, 1)))
            answers.push(get(port, '/healthz').then(({ status }) => status, ({ code }) => code));
        assert.deepEqual([...new Set(await Promise.all(answers))], [200],
            `restart ${round}: of ${answers.length} requests some were not answered`);
    }
    await service.stop();
});

test('a port in use ends the daemon before it reports readiness', { skip }, async () => {
    const other = createServer().listen(0, '127.0.0.1');
    await new Promise((done) => other.once('listening', done));
    const service = serve(['--port', String(other.address().port)]), code = await service.ended;
    other.close();
    assert.equal(code, 1);
    assert.doesNotMatch(service.out, /READY=1/);
    assert.match(service.err, /error cannot listen on address 127\.0\.0\.1, port \d+: Address already in use/);
});

test('log lines for the journal begin with their priority, and have no timestamp', {
    skip: skip || (existsSync('/run/systemd/journal/socket') ? 'a journal takes them on this machine' : false),
}, async () => {
    const service = serve(['--port', '0', '--log-format', 'journal']);
    await service.said(/^notify: READY=1$/m);
    await service.logged(/^<4>source plc1: .*no readings/m);
    await service.stop();
    const lines = service.err.trim().split('\n');
    for (const line of lines)
        assert.match(line, /^<[3467]>(?!\d{4}-)/);
    assert.match(service.err, /^<6>ready http:/m);
});

test('JSON log lines are objects, also those about a faulty plant file', { skip }, async () => {
    const service = serve(['--port', '0', '--log-format', 'json']);
    await service.said(/^notify: READY=1$/m);
    await service.stop();
    const lines = service.err.trim().split('\n').map((line) => JSON.parse(line));
    assert.deepEqual(lines.filter(({ event }) => event).map(({ event, level, plant: name }) => [event, level, name]),
        [['ready', 'info', 'Two boxes'], ['stopping', 'info', 'Two boxes']]);
    const faulty = join(plant.folder, 'faulty.yaml');
    writeFileSync(faulty, readFileSync(plant.file, 'utf8').replace('assets:', 'asset:'));
    const { code, err } = runProgram('plantcastd', [faulty, '--port', '0', '--log-format', 'json']);
    assert.equal(code, 1);
    const errors = err.trim().split('\n').map((line) => JSON.parse(line)).filter(({ level }) => level === 'error');
    assert.ok(errors.some(({ message }) => /faulty\.yaml:\d+.*asset/.test(message)), err);
});

test('`plantcast reload` fails after a refused reload, and says why; metrics and status line show it too', { skip }, async () => {
    const port = await freePort(), service = serve(['--port', String(port)]), pid = await service.pid();
    const reload = () => runProgram('plantcast', ['reload', String(pid), '--runtime', runtime]);
    const metric = async (name) => Number((await get(port, '/metrics')).body.toString().match(new RegExp(`^${name} (.*)$`, 'm'))[1]);
    const good = readFileSync(plant.file, 'utf8');
    await service.said(/^notify: READY=1$/m);
    assert.equal(await metric('plantcast_reload_good'), 1);
    writeFileSync(plant.file, good.replace('max: 100', 'max: warm'));
    try {
        const { code, err } = reload();
        assert.equal(code, 1);
        assert.match(err, /plant\.yaml:\d+:\d+: .*\n.*not reloaded: the daemon keeps configuration \w+/);
    } finally {
        writeFileSync(plant.file, good);
    }
    assert.equal(await metric('plantcast_reload_good'), 0);
    await service.said(/^notify: STATUS=.*the last reload was refused/m);
    const { code, out, err } = reload();
    assert.equal(code, 0, err);
    assert.match(out, /^reloaded: configuration \w+$/m);
    assert.equal(await metric('plantcast_reload_good'), 1);
    await service.stop();
    assert.equal(reload().code, 1, 'reload fails after the daemon has ended');
});

test('metrics include build, process and certificate, and no names from before a rename', { skip }, async () => {
    const [cert, key] = ['cert.pem', 'key.pem'].map((name) => join(plant.folder, name));
    const made = spawnSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes', '-days', '3',
        '-keyout', key, '-out', cert, '-subj', '/CN=localhost', '-addext', 'subjectAltName=DNS:localhost,IP:127.0.0.1']);
    assert.equal(made.status, 0, String(made.stderr));
    const port = await freePort(), began = Date.now(), service = serve(['--port', String(port), '--tls-cert', cert, '--tls-key', key]);
    await service.said(/^notify: READY=1$/m);
    const text = await until('the first look of the supervision', () => {
        const { stdout } = spawnSync('curl', ['-s', '--cacert', cert, `https://127.0.0.1:${port}/metrics`], { encoding: 'utf8' });
        return /^plantcast_certificate_expiry_timestamp_seconds [1-9]/m.test(stdout) && stdout;
    });
    const number = (name) => Number(text.match(new RegExp(`^${name} (.*)$`, 'm'))?.[1]);
    assert.match(text, /^plantcast_build_info\{version="[\d.]+",commit="\w+"\} 1$/m);
    const left = number('plantcast_certificate_expiry_timestamp_seconds') - Date.now() / 1000;
    assert.ok(left > 2.9 * 86400 && left < 3.1 * 86400, String(left));
    const after_s = number('process_start_time_seconds') - began / 1000, took_s = (Date.now() - began) / 1000;
    // the start may seem up to 2 s too early: the kernel reports it in clock ticks after the boot time, which is in whole
    // seconds
    assert.ok(after_s > -2 && after_s < took_s, `${after_s} of ${took_s} s`);
    assert.ok(number('process_cpu_seconds_total') > 0 && number('process_threads') > 3);
    assert.ok(number('process_max_fds') >= number('process_open_fds'));
    assert.ok(number('process_open_fds') > 5 && number('process_virtual_memory_bytes') > number('process_resident_memory_bytes'));
    assert.doesNotMatch(text, /_us_total|per_10_minutes/);
    writeFileSync(join(runtime, 'metrics'), text);
    await service.stop();
    assert.match(service.err, /warn .*cert\.pem: this certificate expires within 14 days, in 3\.0 days/);
});

test('promtool finds no fault in the metrics', {
    skip: skip || (has('promtool') ? false : 'promtool (of the package prometheus) is not installed'),
}, () => {
    const { status, stdout, stderr } = spawnSync('promtool', ['check', 'metrics'],
        { input: readFileSync(join(runtime, 'metrics')), encoding: 'utf8' });
    assert.equal(status, 0, stdout + stderr);
    assert.equal(stdout + stderr, '');
    assert.ok(statSync(join(runtime, 'metrics')).size > 5000);
});
