// SPDX-License-Identifier: GPL-3.0-or-later
// The fleet page: what it shows of real servers, of unresponsive ones, and of two hundred; how often it polls them, and how
// much processor time it takes.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { createServer, get } from 'node:http';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, shoot } from './support/browser.mjs';
import { folderOfTests } from './support/folders.mjs';
import { freePort } from './support/ports.mjs';
import { cpuMs } from './support/processes.mjs';
import { long } from './support/promise.mjs';
import { BIN, notBuilt, runProgram, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const options = { skip: notBuilt(), timeout: 240000 };
const folder = folderOfTests();

const write = (text) => {
    writeFileSync(join(folder, 'fleet.yaml'), text);
    return join(folder, 'fleet.yaml');
};

async function serve(file) {
    const child = spawn(join(BIN, 'plantcast'), ['fleet', file, '--serve', '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
    const url = await new Promise((done, fail) => {
        child.stdout.once('data', (text) => done(String(text).match(/http:\/\/\S+/)[0]));
        child.on('exit', (code) => fail(new Error(`it ended with ${code}`)));
    });
    return { url, pid: child.pid, state: async () => (await fetch(`${url}fleet.json`)).json(),
        stop: () => new Promise((done) => { child.removeAllListeners('exit').on('exit', done); child.kill(); }) };
}

// Starts a fake server that answers /metrics with this text and /snapshot.png with a real PNG of one pixel; `asked` records the
// times of the requests.
const PNG = Buffer.from('iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==', 'base64');
async function pretend(metrics = '', status = 200, headers = {}) {
    const asked = { metrics: [], picture: [] };
    const server = createServer((request, response) => {
        const isPicture = request.url.startsWith('/snapshot.png');
        asked[isPicture ? 'picture' : 'metrics'].push(performance.now());
        asked.token = request.headers.authorization;
        if (isPicture && asked.broken)
            response.writeHead(503).end();
        else
            response.writeHead(status, headers).end(isPicture ? PNG : asked.page ?? `plantcast_sessions 1\n${metrics}`);
    });
    await new Promise((done) => server.listen(0, '127.0.0.1', done));
    return { asked, server, url: `http://127.0.0.1:${server.address().port}/`,
        close: () => { server.closeAllConnections(); server.close(); } };
}

test('each mistake in a fleet file is reported with its line', options, () => {
    const check = (text) => runProgram('plantcast', ['fleet', write(text)]);
    const good = check('name: Works\nplants:\n- { id: a, url: "https://a.example" }\n'
        + '- { id: b, url: "https://b.example:8443/", poll_s: 60 }\n');
    assert.equal(good.code, 0, good.err);
    assert.match(good.out, /2 plants/);
    const bad = check('plants:\n- { id: a, url: "https://a.example" }\n- { id: b, url: "HTTPS://A.example:443/" }\n'
        + '- { id: a, url: "http://c.example/" }\n- { id: d/e, url: "ftp://d/" }\n- { id: f, url: "http://me:pw@f/" }\n'
        + '- { url: "http://g/", poll_s: 0 }\n- { id: h, url: "http://h.example/", token_file: t }\n'
        + '- { id: i, url: "http://127.0.0.1:8080/", token_file: t }\n');
    assert.equal(bad.code, 1);
    for (const line of [/fleet\.yaml:3:\d+: error: url: the plant at https:\/\/a\.example\/ is listed twice \(first at line 2\)/,
        /fleet\.yaml:4:\d+: error: id: plant 'a' is listed twice \(first at line 2\)/, /fleet\.yaml:5:\d+: error: id: expected/,
        /fleet\.yaml:5:\d+: error: url: the plant's address must begin with/,
        /fleet\.yaml:6:\d+: error: url: the plant's address must not contain a password/,
        /fleet\.yaml:7:\d+: error: .*needs the key 'id'/, /fleet\.yaml:7:\d+: error: poll_s: expected/,
        /fleet\.yaml:8:\d+: error: url: a plant with `token_file` needs .*https/])
        assert.match(bad.err, line);
    assert.ok(!bad.err.includes('me:pw') && !bad.err.includes('fleet.yaml:9'));
    assert.equal(runProgram('plantcast', ['fleet', join(folder, 'fleet.yaml'), '--serve', '--address', '0.0.0.0']).code, 2);
});

test('a page instead of metrics counts as no answer, an outdated picture is dropped, a foreign host name is refused', options, async () => {
    const plant = await pretend('plantcast_alarms_shown{priority="1"} 3\n');
    const fleet = await serve(write(`poll_s: 1\npicture_s: 1\nplants:\n- { id: a, url: "${plant.url}" }\n`));
    const first = async () => (await fleet.state()).plants[0];
    const status = (host) => new Promise((done, fail) => get(`${fleet.url}fleet.json`, { headers: { host } },
        (response) => done(response.resume().statusCode)).on('error', fail));
    try {
        await until('its picture', async () => (await first()).picture);
        plant.asked.broken = true;
        await until('that there is none', async () => (await first()).picture === 0);
        assert.equal((await fetch(`${fleet.url}picture/a`)).status, 404);
        plant.asked.page = '<html>We are back soon.</html>';
        const silent = await until('silence', async () => { const now = await first(); return !now.answers && now; });
        assert.match(silent.why, /not a Plantcast server/);
        assert.deepEqual(silent.alarms, [3, 0, 0, 0]);
        assert.match(await (await fetch(`${fleet.url}metrics`)).text(), /^plantcast_fleet_up\{plant="a"\} 0$/m);
        assert.equal(await status('evil.example:8090'), 403);
        assert.equal(await status('localhost'), 200);
    } finally {
        await fleet.stop();
        plant.close();
    }
});

test('page and metrics show a healthy plant, one with alarms and one that does not respond', options, async () => {
    const plant = await TinyPlant.running(), now = Math.floor(Date.now() / 1000), gone = await freePort();
    writeFileSync(join(folder, 'token'), 'tok-1\n');
    const bad = await pretend(`plantcast_alarms_shown{priority="1"} 2\nplantcast_alarms_shown{priority="3"} 14
plantcast_alarms{state="unacknowledged"} 9\nplantcast_source_up{source="a"} 0\nplantcast_source_up{source="b"} 1
plantcast_certificate_expiry_timestamp_seconds ${now + 5.5 * 86400}\nplantcast_backup_timestamp_seconds ${now - 6 * 86400}
plantcast_history_free_bytes 900000000\nplantcast_history_good 0\nplantcast_build_info{version="9.8.7",commit="x"} 1\n`);
    const fleet = await serve(write(`name: Works of the north\npoll_s: 1\npicture_s: 2\nplants:
- { id: boxes, name: Two boxes, url: "http://127.0.0.1:${plant.port}" }
- { id: trouble, name: "Cracker 2 <b>", url: "${bad.url}", token_file: token }
- { id: gone, name: Tank farm, url: "http://127.0.0.1:${gone}/" }\n`));
    let browser;
    try {
        const state = await until('all have been asked', async () => {
            const { plants } = await fleet.state();
            return plants.slice(0, 2).every(({ picture, answers }) => picture && answers) && plants[2].why && plants;
        });
        assert.deepEqual(state.map(({ answers }) => answers), [true, true, false]);
        assert.equal(state[0].links, 1);
        await until('how much of the disk is free', async () => (await fleet.state()).plants[0].free_bytes > 0);
        const backup = runProgram('plantcast', ['backup', plant.file, '-o', join(folder, 'copy')]);
        assert.equal(backup.code, 0, backup.err);
        await plant.daemon.stop();
        await plant.startDaemon('--port', String(plant.port));
        await until('when the backup was', async () => (await fleet.state()).plants[0].backup_s >= now);
        assert.match(state[0].version, /^\d/);
        assert.deepEqual(state[1].alarms, [2, 0, 14, 0]);
        assert.equal(bad.asked.token, 'Bearer tok-1');
        assert.match(state[2].why, /connect/i);
        assert.equal(state[2].answered_us, 0);
        const metrics = await (await fetch(`${fleet.url}metrics`)).text();
        assert.match(metrics, /^plantcast_fleet_up\{plant="gone"\} 0$/m);
        assert.match(metrics, /^plantcast_fleet_alarms\{plant="trouble",priority="3"\} 14$/m);
        assert.ok(!metrics.includes('plantcast_fleet_links_down{plant="gone"}'));
        assert.equal((await fetch(`${fleet.url}../../etc/passwd`)).status, 404);
        assert.equal((await fetch(fleet.url, { method: 'POST' })).status, 404);

        browser = await openPage(fleet.url, { viewport: { width: 1280, height: 800 } });
        const { page } = browser, card = (id) => page.locator(`[data-plant="${id}"]`);
        await card('trouble').locator('.count.p1').waitFor();
        assert.equal(await card('trouble').locator('h2').textContent(), 'Cracker 2 <b>');
        assert.deepEqual(await card('trouble').locator('.wrong').allTextContents(),
            ['1 of 2 down', 'not writable', '5 days', '0.9 GB', '6 days ago']);
        assert.equal(await card('boxes').locator('a').getAttribute('href'), `http://127.0.0.1:${plant.port}/`);
        assert.equal(await card('gone').locator('.away').textContent(), 'No answer yet');
        await page.waitForFunction(() => document.querySelector('[data-plant=boxes] img')?.naturalWidth === 320);
        await plant.daemon.stop();
        await until('that it is silent', async () => /No answer since \d/.test(await card('boxes').locator('.away').textContent()));
        await shoot(page, 'fleet');
        await page.locator('#only').check();
        assert.ok(await card('boxes').isVisible());
        await page.locator('#only').uncheck();
        for (const [language, words] of [['ko', '부터 응답 없음'], ['de', 'Keine Antwort seit']]) {
            await page.goto(`${fleet.url}?lang=${language}`);
            await card('trouble').locator('.count.p1').waitFor();
            assert.ok((await card('boxes').locator('.away').textContent()).includes(words));
            await shoot(page, `fleet-${language}`);
        }
        assert.deepEqual(browser.errors, []);
    } finally {
        await browser?.close();
        await fleet.stop();
        bad.close();
        await plant.destroy();
    }
});

test('no server is polled faster than configured, and Retry-After is obeyed', options, async () => {
    const [quick, slow, busy] = [await pretend(), await pretend(), await pretend('', 503, { 'Retry-After': '5' })];
    const began = performance.now();
    const fleet = await serve(write(`poll_s: 1\npicture_s: 0\nplants:\n- { id: quick, url: "${quick.url}" }
- { id: slow, url: "${slow.url}", poll_s: 4, picture_s: 6 }\n- { id: busy, url: "${busy.url}" }\n`));
    try {
        await until('enough requests', () => quick.asked.metrics.length >= 6 && slow.asked.metrics.length >= 3 &&
            slow.asked.picture.length >= 2 && busy.asked.metrics.length >= 2);
        // The fleet page pauses after each answer before it polls again, so request n (from 0) comes at least n pauses after
        // the start, however slow this machine is.
        for (const [name, times, pause_ms] of [['quick', quick.asked.metrics, 1000], ['slow', slow.asked.metrics, 4000],
            ['picture', slow.asked.picture, 6000], ['busy', busy.asked.metrics, 5000]])
            assert.ok(times.every((at, n) => at - began >= n * pause_ms), `${name}: ${times.map((at) => Math.round(at - began))} ms`);
        assert.equal(quick.asked.picture.length, 0);
        assert.match((await fleet.state()).plants[2].why, /503/);
    } finally {
        await fleet.stop();
        for (const one of [quick, slow, busy])
            one.close();
    }
});

test('two hundred plants take two hundredths of a processor core', { ...options, skip: options.skip || long }, async () => {
    const COUNT = 200, SECONDS = 30, all = [];
    const lines = Array.from({ length: 400 }, (_, i) => `plantcast_stage_seconds_bucket{le="${i}"} ${i}`);
    for (let i = 0; i < COUNT; i++)
        all.push(await pretend(`${lines.join('\n')}\nplantcast_alarms_shown{priority="2"} ${i % 3}\n`));
    const fleet = await serve(write(`plants:\n${all.map(({ url }, i) => `- { id: p${i}, url: "${url}" }`).join('\n')}\n`));
    try {
        await until('all answer', async () => (await fleet.state()).plants.every(({ answers }) => answers));
        await sleep(2000);
        const before = cpuMs(fleet.pid);
        for (let s = 0; s < SECONDS; s += 5) { // polls every 5 s, like an open fleet page
            await fleet.state();
            await sleep(5000);
        }
        const percent = (cpuMs(fleet.pid) - before) / 10 / SECONDS;
        console.log(`# fleet of ${COUNT}: ${percent.toFixed(2)} % of a core`);
        assert.ok(percent <= 2, `${percent} % of a processor core`);
    } finally {
        await fleet.stop();
        for (const one of all)
            one.close();
    }
});
