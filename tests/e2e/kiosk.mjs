// SPDX-License-Identifier: GPL-3.0-or-later
// The kiosk's supervisor (deploy/systemd/kiosk), which starts Chromium and reports to the service manager. Expected: it feeds
// the watchdog only while the page responds, the page's storage survives a restart, and systemd accepts the kiosk's units.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { chownSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createServer as createSecureServer } from 'node:https';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, test } from 'node:test';
import { SCREENSHOTS } from './support/browser.mjs';
import { freePort } from './support/ports.mjs';
import { family } from './support/processes.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, sleep, startTiny } from './support/tiny_plant.mjs';
import { missingDisplay, savePng, startDisplay } from './support/x_display.mjs';

const CHROMIUM = '/usr/bin/chromium';
const FLAGS = ['--kiosk', '--no-sandbox', '--no-first-run', '--noerrdialogs', '--disable-gpu', '--ozone-platform=x11'];
const why = missingDisplay() ?? (existsSync(CHROMIUM) ? false : 'no chromium');
const options = { skip: why, timeout: 240000 }, WATCHDOG_S = 8, PATIENCE_MS = 120000, [WIDTH, HEIGHT] = [960, 540];
const PAGE = `<!DOCTYPE html><title>display</title><script>
localStorage.secret ??= Math.random();
setInterval(async () => {
    if (await (await fetch('/beat?' + localStorage.secret)).text() === 'hang')
        for (;;);
}, 200);
</script>`;
let display, server, port, state, kiosk, beats, answer;

function serve() {
    server = createServer((request, response) => {
        const [path, secret] = request.url.split('?');
        if (path === '/beat')
            beats.push(secret);
        response.writeHead(200, { 'Content-Type': 'text/html' }).end(path === '/beat' ? answer : PAGE);
    });
    return new Promise((done) => server.listen(port, '127.0.0.1', done));
}

async function until(what, is) {
    for (const end = performance.now() + PATIENCE_MS; !await is(); await sleep(50)) {
        if (performance.now() > end) {
            savePng(display.grab(), join(SCREENSHOTS, 'kiosk-failed.png'));
            assert.fail(`${what}:\n${kiosk?.said}`);
        }
    }
}

// Starts the supervisor under a fake service manager. before: command prefix that runs the whole; around: command prefix that
// runs the browser.
function startKiosk(url, { before: starter = [], around = [], env = display.env } = {}) {
    const [program, ...args] = [...starter, 'tests/support/service_manager.py',
        '--watchdog', String(WATCHDOG_S), 'deploy/systemd/kiosk', url, ...around, CHROMIUM,
        ...FLAGS, `--window-size=${WIDTH},${HEIGHT}`, '--window-position=0,0'];
    const child = spawn(program, args, { stdio: 'pipe', env: { ...env, STATE_DIRECTORY: state, HOME: state } });
    // the supervisor may still print while the next test runs, when `kiosk` is already another one or null
    const own = { child, said: '', code: null, pid: () => Number([...own.said.matchAll(/^started: (\d+)$/mg)].at(-1)?.[1]),
        fed: () => own.said.split('notify: WATCHDOG=1').length - 1 };
    for (const pipe of [child.stdout, child.stderr])
        pipe.on('data', (text) => { own.said += text; });
    own.ended = new Promise((done) => child.once('exit', (code) => { own.code = code; done(code); }));
    kiosk = own;
}

setUp(why, async () => {
    display = await startDisplay(WIDTH, HEIGHT);
    state = mkdtempSync(join(tmpdir(), 'plantcast-kiosk-'));
    port = await freePort();
    [beats, answer] = [[], ''];
    await serve();
});
// Kills all processes, as systemd does when a service ends.
function endAll(pids) {
    for (const pid of pids) {
        try {
            process.kill(pid, 'SIGKILL');
        } catch {
            // the process has ended already
        }
    }
}
afterEach(async () => {
    if (!kiosk)
        return;
    const pids = kiosk.pids ?? (kiosk.pid() ? family(kiosk.pid()) : []);
    kiosk.child.kill('SIGTERM');
    await Promise.race([kiosk.ended, sleep(20000)]);
    endAll(pids);
    kiosk = null;
});
after(async () => {
    server?.closeAllConnections();
    server?.close();
    await display?.stop();
    rmSync(state ?? '', { recursive: true, force: true });
});

test('the kiosk feeds the watchdog while the page responds; the page\'s storage survives a restart', options, async () => {
    startKiosk(`http://127.0.0.1:${port}/`);
    await until('it is ready, and is fed', () => /notify: READY=1/.test(kiosk.said) && kiosk.fed() > 2 && beats.length > 0);
    const [secret] = beats;
    assert.ok(Number(secret) > 0, secret);
    kiosk.child.stdin.write('again\n');
    await until('it has started again', () => kiosk.said.split('notify: READY=1').length === 3);
    beats.length = 0;
    await until('its page', () => beats.length > 0);
    assert.equal(beats[0], secret);
    kiosk.child.kill('SIGTERM');
    assert.equal(await kiosk.ended, 0);
});

test('a page whose main thread hangs does not feed the watchdog, and the service manager restarts the kiosk', options, async () => {
    startKiosk(`http://127.0.0.1:${port}/`);
    beats.length = 0;
    await until('it is fed', () => kiosk.fed() > 1 && beats.length > 0);
    kiosk.pids = family(kiosk.pid());
    answer = 'hang';
    assert.equal(await kiosk.ended, 99, kiosk.said); // ended by the manager's watchdog
    answer = '';
});

test('a frozen browser does not feed the watchdog', options, async () => {
    startKiosk(`http://127.0.0.1:${port}/`);
    await until('it is fed', () => kiosk.fed() > 1);
    kiosk.pids = family(kiosk.pid());
    for (const pid of kiosk.pids.filter((one) => one !== kiosk.pid()))
        process.kill(pid, 'SIGSTOP');
    assert.equal(await kiosk.ended, 99, kiosk.said);
});

test('while the server is down the kiosk is not restarted, and it shows the page once the server is up', options, async () => {
    server.closeAllConnections();
    await new Promise((done) => server.close(done));
    startKiosk(`http://127.0.0.1:${port}/`);
    await until('it is fed', () => kiosk.fed() > 4);
    beats.length = 0;
    await serve();
    await until('its page', () => beats.length > 0);
    assert.equal(kiosk.code, null);
});

test('the kiosk service ends when its browser ends', options, async () => {
    startKiosk(`http://127.0.0.1:${port}/`);
    await until('it is fed', () => kiosk.fed() > 1);
    kiosk.pids = family(kiosk.pid());
    endAll(kiosk.pids.filter((pid) => pid !== kiosk.pid()));
    assert.equal(await kiosk.ended, 1, kiosk.said);
});

const NOBODY = 65534, lacks = ['/usr/bin/cage', '/usr/bin/Xwayland'].filter((path) => !existsSync(path));
const noCage = why || (lacks.length > 0 && `not here: ${lacks.join(', ')}`) || (process.getuid() !== 0 && 'needs root, to become nobody');
// Makes a certificate authority, and a certificate for 127.0.0.1 that it has signed: { ca, cert, key } as PEM.
function authority(name) {
    const script = `new='-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes'
        openssl req -x509 $new -keyout ca.key -out ca.pem -days 9 -subj "/CN=${name}"
        openssl req $new -keyout key.pem -out new.csr -subj "/CN=127.0.0.1" -addext "subjectAltName=IP:127.0.0.1"
        openssl x509 -req -in new.csr -CA ca.pem -CAkey ca.key -CAcreateserial -copy_extensions copy -days 9 -out cert.pem`;
    const { status, stderr } = spawnSync('sh', ['-euc', script], { cwd: state, encoding: 'utf8' });
    assert.equal(status, 0, stderr);
    const [ca, cert, key] = ['ca', 'cert', 'key'].map((file) => readFileSync(join(state, `${file}.pem`), 'utf8'));
    return { ca, cert, key };
}

const noCertutil = why || (spawnSync('certutil', ['-H']).error ? 'certutil is not installed (libnss3-tools)' : false);
test('the kiosk still shows a server whose certificate authority has changed', { ...options, skip: noCertutil }, async () => {
    const file = join(state, 'kiosk.pem'), [former, present] = ['Former works', 'Present works'].map(authority);
    const secure = createSecureServer({ cert: present.cert, key: present.key },
        (request, response) => server.emit('request', request, response));
    await new Promise((done) => secure.listen(0, '127.0.0.1', done));
    try {
        // runs `kiosk --trust` with the old certificate authority, then with the new one, then with a file that contains both
        for (const pem of [former.ca, present.ca, former.ca + present.ca]) {
            writeFileSync(file, pem);
            const env = { ...display.env, HOME: state };
            const { status, stderr } = spawnSync('deploy/systemd/kiosk', ['--trust', file], { env, encoding: 'utf8' });
            assert.equal(status, 0, stderr);
        }
        beats.length = 0;
        startKiosk(`https://127.0.0.1:${secure.address().port}/`);
        await until('its page', () => beats.length > 0);
        kiosk.child.kill('SIGTERM');
        assert.equal(await kiosk.ended, 0);
    } finally {
        secure.closeAllConnections();
        secure.close();
    }
});

test('in cage, which draws into memory here, the kiosk shows the page as on a monitor', { ...options, skip: noCage }, async () => {
    const own = state;
    state = mkdtempSync(join(tmpdir(), 'plantcast-cage-'));
    chownSync(state, NOBODY, NOBODY); // runs as the user `nobody`, because the compositor cage refuses to run as root
    beats.length = 0;
    try {
        const { DISPLAY: _, ...env } = display.env;
        startKiosk(`http://127.0.0.1:${port}/`, { before: ['setpriv', `--reuid=${NOBODY}`, `--regid=${NOBODY}`, '--clear-groups'],
            around: ['cage', '--'], env: { ...env, XDG_RUNTIME_DIR: state, WLR_BACKENDS: 'headless', WLR_RENDERER: 'pixman',
                WLR_LIBINPUT_NO_DEVICES: '1' } });
        await until('its page, and that it is fed', () => beats.length > 10 && kiosk.fed() > 4);
        kiosk.child.kill('SIGTERM');
        assert.equal(await kiosk.ended, 0, kiosk.said);
    } finally {
        rmSync(state, { recursive: true, force: true });
        state = own;
    }
});

const noPlant = notBuilt();
test('the kiosk shows a wall of a plant', { ...options, skip: why || noPlant }, async () => {
    const plant = await startTiny(`
views: [{ id: whole, title: Whole unit, view: "group=temperature" }]
walls: [{ id: room, displays: [{ grid: [main main time], panes: [{ area: main, views: [whole] }, { area: time, clock: yes }] }] }]
`);
    try {
        startKiosk(`${plant.url}?wall=room&display=1`);
        const metrics = async () => (await fetch(`${plant.url}metrics`)).text();
        await until('a picture', async () => /^plantcast_wall_frame_age_seconds\{wall="room",display="1"\}/m.test(await metrics()));
        await until('it is fed', () => kiosk.fed() > 2);
        const coloured = () => {
            const { at } = display.grab();
            let count = 0;
            for (let x = 0; x < WIDTH; x += 8)
                for (let y = 0; y < HEIGHT; y += 8)
                    count += Math.max(...at(x, y)) - Math.min(...at(x, y)) > 60;
            return count;
        };
        await until('the field', () => coloured() > 50);
        savePng(display.grab(), join(SCREENSHOTS, 'kiosk.png'));
    } finally {
        await plant.stop();
    }
});

const noAnalyze = spawnSync('systemd-analyze', ['--version']).error ? 'no systemd-analyze' : false;
test('systemd-analyze finds no fault in the kiosk\'s units', { skip: noAnalyze }, () => {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-units-')), names = ['.service', '-restart.service', '-restart.timer'];
    try {
        // replaces the kiosk's programs, which are not installed here, by /bin/true, because systemd-analyze checks that
        // programs exist
        for (const name of names)
            writeFileSync(join(folder, `plantcast-kiosk${name}`), readFileSync(`deploy/systemd/plantcast-kiosk${name}`, 'utf8')
                .replaceAll('/usr/lib/plantcast/kiosk', '/bin/true'));
        writeFileSync(join(folder, 'seatd.service'), '[Service]\nExecStart=/bin/true\n');
        const { status, stderr } = spawnSync('systemd-analyze', ['verify', '--man=no', ...names.map((name) =>
            join(folder, `plantcast-kiosk${name}`))], { encoding: 'utf8' });
        assert.deepEqual(stderr.split('\n').filter((line) => /plantcast-kiosk/.test(line)), []);
        assert.equal(status, 0, stderr);
    } finally {
        rmSync(folder, { recursive: true });
    }
});
