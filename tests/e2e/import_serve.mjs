// SPDX-License-Identifier: GPL-3.0-or-later
// `plantcast import --serve`: a plant is imported on the page. Files are dropped, tags reviewed and decided on, units
// corrected.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { once } from 'node:events';
import { copyFileSync, existsSync, mkdtempSync, readdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { arrive, drawnAt, land, openPage, settle, shoot, TABLET, waitForPicture, withPage } from './support/browser.mjs';
import { DATA } from './support/folders.mjs';
import { ifcOf, KINDS } from './support/ifc_kinds.mjs';
import { stl } from './support/mesh_samples.mjs';
import { setUp } from './support/set_up.mjs';
import { sweep } from './support/sweep.mjs';
import { formats, makeTagList } from './support/tag_lists.mjs';
import { freePort } from './support/ports.mjs';
import { BIN, missing, Program } from './support/tiny_plant.mjs';
import { becomes } from './support/until.mjs';

const absent = missing();
const notBuilt = absent.length > 0 ? `not built: ${absent.join(', ')}` : !existsSync('/usr/bin/chromium') ? 'no chromium' : false;
const options = { skip: notBuilt, timeout: 240000 };
const noData = notBuilt || (existsSync(join(DATA, 'cad')) ? false : 'no ../shared/data/cad');
const DESK = { viewport: { width: 1280, height: 800 } };

// `plantcast import --serve` in a folder that does not exist yet.
class Served {
    static async start(...args) {
        const served = new Served();
        served.root = mkdtempSync(join(tmpdir(), 'plantcast-serve-'));
        served.folder = join(served.root, 'plant');
        served.began = performance.now();
        served.child = spawn(join(BIN, 'plantcast'), ['import', '--serve', '--port', '0', ...args, '-o', served.folder]);
        served.ended = new Promise((done) => served.child.once('exit', done));
        served.said = '';
        for (const pipe of [served.child.stdout, served.child.stderr])
            pipe.on('data', (chunk) => { served.said += chunk; });
        while (!served.port) {
            await new Promise((done) => setTimeout(done, 50));
            served.port = Number(served.said.match(/ready http:\/\/127\.0\.0\.1:(\d+)\//)?.[1]);
            if (served.child.exitCode !== null)
                throw new Error(served.said);
        }
        served.url = `http://127.0.0.1:${served.port}/`;
        return served;
    }

    read(name) {
        return readFileSync(join(this.folder, name), 'utf8');
    }

    api(path, more = {}) {
        return fetch(`${this.url}api/v1/import${path}`, more);
    }

    post(path, body = undefined, headers = {}) {
        return this.api(path, { method: 'POST', body, headers });
    }

    async idle() {
        for (;;) {
            const state = await (await this.api('')).json();
            if (state.phase === 'idle')
                return state;
            await new Promise((done) => setTimeout(done, 100));
        }
    }

    async destroy() {
        this.child.kill();
        await this.ended;
        rmSync(this.root, { recursive: true, force: true });
    }
}

// Returns a model with a row of boxes of these names, each `size` wide.
function boxes(names, size = 1) {
    const corners = [...Array(8).keys()].flatMap((i) => [i & 1, i >> 1 & 1, i >> 2 & 1].map((bit) => bit * size));
    const faces = [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5];
    const bytes = Buffer.concat([Buffer.from(new Float32Array(corners).buffer), Buffer.from(new Uint16Array(faces).buffer)]);
    return JSON.stringify({ asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }],
        nodes: [{ name: 'plant', children: names.map((_, i) => i + 1) },
            ...names.map((name, i) => ({ name, mesh: 0, translation: [2 * size * (i % 8), 0, 2 * size * Math.floor(i / 8)] }))],
        meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
        accessors: [{ bufferView: 0, componentType: 5126, count: 8, type: 'VEC3', min: [0, 0, 0], max: [size, size, size] },
            { bufferView: 1, componentType: 5123, count: 36, type: 'SCALAR' }],
        bufferViews: [{ buffer: 0, byteLength: 96 }, { buffer: 0, byteOffset: 96, byteLength: 72 }],
        buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }] });
}
const NAMES = ['E-101', 'P-201A', 'P-201B', '열교환기-301', 'V 401/A'];
const TAGS = `Tag Name,Scaled Low,Scaled High,Eng Units,Description
E-101.TT-01,0,150,degC,Shell
TT-2011,0,120,degC,
TT-2012,0,120,degC,
TT-201,0,120,degC,Bearing
FT-201,0,10,m3/h,Flow
TT-1013,0,90,degC,Before P-201A
TT-1014,0,90,degC,Before P-201A
열교환기-301/TT,0,90,degC,입구 온도
V 401/A.LT,0,100,%,Level
TT-9999,0,90,degC,Another unit
`;

// Selects files in the page's file input; files: [{ name, text }] or paths.
const choose = (page, files) => page.locator('#import input[type=file]').setInputFiles(files.map((file) => (typeof file === 'string' ? file
    : { name: file.name, mimeType: 'application/octet-stream', buffer: Buffer.from(file.text) })));
const row = (page, tag) => page.locator('#import .row').filter({ has: page.locator('b', { hasText: new RegExp(`^${tag}$`) }) });
const inForce = (page) => page.waitForFunction(() => {
    const panel = document.getElementById('import');
    return !panel.classList.contains('new') && !panel.classList.contains('busy') && panel.querySelectorAll('.row').length > 0;
}, null, { timeout: 200000 });
const saved = (page) => page.waitForFunction(() => !document.querySelector('#import .row.decided') &&
    !document.querySelector('#import.busy'));
const assetsOf = (page) => page.evaluate(() => globalThis.plantcast.session.model.assets.map(({ id }) => id));
const wrong = (page, pattern) => page.waitForFunction((what) => new RegExp(what).test(document.querySelector('#import .wrong').textContent),
    pattern);

// --- requests over HTTP

test('uploads with a bad name, a bad size or from another site are refused, and only one import runs at a time', options, async (t) => {
    const served = await Served.start();
    t.after(() => served.destroy());
    const put = (name, body = 'x', headers = {}) => served.post(`/upload?name=${encodeURIComponent(name)}`, body, headers);
    for (const name of ['../x.glb', 'a/b.glb', '.x.glb', '', 'a\\b.glb', `${'a'.repeat(201)}`])
        assert.equal((await put(name)).status, 400, JSON.stringify(name));
    assert.equal((await served.post('/upload?name=x.glb')).status, 413, 'an empty upload is refused');
    assert.equal((await put('x.glb', 'x', { Origin: 'http://elsewhere.example' })).status, 403);
    assert.equal((await put('x.glb', 'x', { 'Sec-Fetch-Site': 'cross-site' })).status, 403);
    assert.equal((await served.post('/run', undefined, { Origin: 'http://elsewhere.example' })).status, 403);
    assert.equal((await served.post('/run?units=km')).status, 400);
    const nothing = await served.post('/nothing', 'x');
    assert.equal(nothing.status, 405);
    assert.deepEqual((await nothing.text()).match(/\/[\w/]+/g).filter((path) => /import/.test(path)).map((path) => path.slice(15)),
        ['upload', 'remove', 'run', 'decide', 'source', 'cancel']);
    assert.equal((await served.api('/matches')).status, 404, 'there are no matches before the first import');
    assert.deepEqual(readdirSync(join(served.folder, 'exports')), [], 'no upload with a bad name is stored');
    assert.deepEqual(readdirSync(served.root), ['plant']);

    assert.equal((await put('열교환기 -1.gltf', boxes(['E-1']))).status, 200);
    assert.equal((await put('tags.csv', TAGS)).status, 200);
    assert.equal((await put('other.csv', TAGS)).status, 200);
    assert.deepEqual((await served.idle()).files.map(({ name, kind }) => [name, kind]), [['other.csv', 'tags'],
        ['열교환기 -1.gltf', 'model']], 'a new tag list replaces the old one');
    const both = await Promise.all([served.post('/run'), served.post('/run')]);
    assert.deepEqual(both.map(({ status }) => status).sort(), [200, 409]);
    const state = await served.idle();
    assert.equal(state.failed, null, state.failed);
    assert.match(served.read('plant.yaml'), /model: "열교환기 -1\.glb"/);
    assert.equal((await served.post('/remove?name=..%2Fplant.yaml')).status, 400);
    assert.equal((await served.post('/remove?name=other.csv')).status, 200);
    assert.equal((await served.idle()).files.length, 1);
});

// Sends a request that announces a body of `length` bytes and sends 16 MB of it before it reads anything. Returns the answer, and
// why the connection ended.
async function pushes(port, request, length, header = `Host: 127.0.0.1:${port}`) {
    const socket = connect(port, '127.0.0.1'), sent = 16 << 20;
    let said = '', why = 'end';
    const ended = new Promise((done) => socket.on('close', done));
    socket.on('data', (bytes) => { said += bytes; }).on('error', ({ code }) => { why = code; }).pause();
    socket.write(`POST ${request} HTTP/1.1\r\nContent-Length: ${length}\r\n${header}\r\n\r\n`);
    await new Promise((done) => socket.write(Buffer.alloc(sent), done));
    socket.resume();
    for (const end = performance.now() + 60000; !/\r\n\r\n[^]*\n$/.test(said) && why === 'end' && performance.now() < end;)
        await new Promise((done) => setTimeout(done, 20));
    if (length > sent)
        socket.destroy();
    await ended;
    return { said, why };
}

test('a client that is still sending its body when it is refused gets the answer', options, async (t) => {
    const served = await Served.start(), large = 3e9, whole = 16 << 20;
    t.after(() => served.destroy());
    for (const [request, length, status, says, header] of [
        ['/api/v1/import/upload?name=x.glb', large, 413, /file/], ['/api/v1/import/upload?name=..%2Fx.glb', large, 400, /name/],
        ['/api/v1/import/upload?name=..%2Fx.glb', whole, 400, /name/], ['/api/v1/import/decide', large, 413, /file/],
        ['/api/v1/import/run?units=km', large, 400, /./], ['/api/v1/import/nothing', large, 405, /POST/], ['/x', whole, 405, /GET/],
        ['/api/v1/import/upload?name=x.glb', large, 403, /./, 'Host: localhost\r\nOrigin: http://elsewhere.example'],
        ['/api/v1/import/upload?name=x.glb', large, 400, /Host/, 'Origin: http://elsewhere.example'],
    ]) {
        const { said, why } = await pushes(served.port, request, length, header), what = `${request} ${header}: ${said}`;
        assert.equal(why, 'end', what);
        assert.match(said, new RegExp(`^HTTP/1\\.1 ${status} [^]*connection: close`, 'i'), what);
        assert.match(said.replace(/^[^]*?\r\n\r\n/, ''), says, what);
    }
});

test('at most four uploads run at a time, and one that trickles is ended', options, async () => {
    const served = await Served.start(), drips = [];
    const put = (name) => served.post(`/upload?name=${name}`, 'x');
    try {
        for (let i = 0; i < 4; i++) {
            const socket = connect(served.port, '127.0.0.1'), drip = { socket, said: '' };
            socket.on('data', (bytes) => { drip.said += bytes; }).on('error', () => {});
            socket.write(`POST /api/v1/import/upload?name=drip${i}.glb HTTP/1.1\r\nHost: 127.0.0.1:${served.port}\r\n` +
                'Content-Length: 1000000000\r\n\r\nx');
            drip.timer = setInterval(() => socket.write('x'), 500);
            drips.push(drip);
        }
        // waits until all four uploads have begun
        for (let status = 200; status !== 503; await new Promise((done) => setTimeout(done, 100))) {
            ({ status } = await put('fifth.glb'));
            assert.ok([200, 503].includes(status), `upload answered with ${status}`);
        }
        for (const end = performance.now() + 120000; !drips.every(({ said }) => /^HTTP\/1\.1 408 /.test(said));) {
            assert.ok(performance.now() < end, drips.map(({ said }) => said.slice(0, 60)).join());
            await new Promise((done) => setTimeout(done, 200));
        }
        assert.equal((await put('fifth.glb')).status, 200);
        assert.deepEqual(readdirSync(join(served.folder, 'exports')).filter((file) => file.includes('drip')), []);
    } finally {
        drips.forEach(({ socket, timer }) => { clearInterval(timer); socket.destroy(); });
        await served.destroy();
    }
});

test('a daemon that does not serve imports has none of the import URLs', options, async (t) => {
    const { TinyPlant } = await import('./support/tiny_plant.mjs'), plant = await TinyPlant.running();
    t.after(() => plant.destroy());
    const url = `http://127.0.0.1:${plant.port}/api/v1/import`;
    assert.equal((await fetch(url)).status, 404);
    const upload = await fetch(`${url}/upload?name=x.glb`, { method: 'POST', body: 'x' });
    assert.deepEqual([upload.status, await upload.text()], [405, 'only GET and HEAD are allowed (POST: /api/v1/reload, /logout)\n']);
    assert.equal(existsSync(join(plant.folder, 'exports')), false);
});

test('a failed import gives one error line, and the previous plant stays', options, async (t) => {
    const served = await Served.start();
    t.after(() => served.destroy());
    const put = (name, body) => served.post(`/upload?name=${encodeURIComponent(name)}`, body);
    const fails = async (pattern) => {
        await served.post('/run');
        const { failed } = await served.idle();
        assert.match(failed, pattern);
        assert.doesNotMatch(failed, /\n/);
    };
    const before = served.read('plant.yaml');
    await put('plant.gltf', boxes(['E-1']));
    await put('plant.glb', 'glTF cut off');
    await fails(/plant\.glb and .*plant\.gltf would both be written as plant\.glb: rename one of these files/);
    await served.post('/remove?name=plant.gltf');
    await fails(/plant\.glb: /);
    await served.post('/remove?name=plant.glb');
    await put('plant.dwg', 'x');
    await fails(/plant\.dwg: /);
    assert.equal(served.read('plant.yaml'), before);
    await served.post('/remove?name=plant.dwg');
    await fails(/no model has been uploaded yet/);
    await put('plant.gltf', boxes(['E-1', 'P-2']));
    await put('tags.csv', '\u0000\u0001');
    await fails(/tags\.csv/);
    assert.match(served.read('plant.yaml'), /id: "P-2"/, 'the new models stay');
    await put('tags.csv', TAGS);
    await served.post('/run?what=tags');
    assert.equal((await served.idle()).failed, null);
    const kept = ['plant.yaml', 'tags.csv', 'matches.csv'].map((name) => served.read(name));
    await served.post('/decide', 'Tag,Status,Asset\nTT-9999,sure,nowhere\n');
    assert.match((await served.idle()).failed, /TT-9999: no asset of the plant is called 'nowhere'/);
    assert.deepEqual(['plant.yaml', 'tags.csv', 'matches.csv'].map((name) => served.read(name)), kept);
});

test('an import that fails or is cancelled after placing its models restores the previous models, too', options, async (t) => {
    const served = await Served.start();
    t.after(() => served.destroy());
    // hashes of the folder's files by name, without earlier versions of replaced files (NAME.1, NAME.2, ...)
    const files = () => Object.fromEntries(readdirSync(served.folder, { withFileTypes: true })
        .filter((entry) => entry.isFile() && !/\.\d+$/.test(entry.name))
        .map(({ name }) => [name, createHash('md5').update(readFileSync(join(served.folder, name))).digest('hex')]));
    const bring = async (names, how = '') => {
        await served.post('/upload?name=plant.gltf', boxes(names));
        await served.post(`/run${how}`);
    };
    await served.post('/upload?name=tags.csv', TAGS);
    const prepared = join(served.folder, readdirSync(served.folder).find((name) => /prepared/.test(name)));
    const breaks = async (how) => { // makes preparing fail
        renameSync(prepared, `${prepared}.away`);
        writeFileSync(prepared, '');
        const before = files();
        await bring([...NAMES, 'K-501'], how);
        const { failed } = await served.idle();
        assert.match(failed, /prepared/);
        assert.doesNotMatch(failed, /undone/);
        assert.deepEqual(files(), before, `the files are as before: ${how}`);
        rmSync(prepared);
        renameSync(`${prepared}.away`, prepared);
    };
    await breaks('');
    assert.match(served.read('plant.yaml'), /person\.glb/);
    await bring(NAMES);
    assert.equal((await served.idle()).failed, null);
    await breaks('');
    await breaks('?what=anew&units=ft');
    // A model converted by a program that waits as long as the file `wait` exists, so that an import cannot end before it
    // is cancelled.
    const [wait, drawing] = ['wait', 'box.cad'].map((name) => join(served.folder, name));
    const command = 'test -e "${1%/*}/wait" && touch waits && sleep 100; cp "$1" "$2"';
    writeFileSync(drawing, boxes(['Box']));
    writeFileSync(join(served.folder, 'plant.yaml'), served.read('plant.yaml').replace(/^assets:\n/m,
        `convert:\n  - { model: box.glb, from: box.cad, command: ${JSON.stringify(command)} }\n\n$&` +
        '  - { id: BOX, model: box.glb }\n'));
    copyFileSync(drawing, join(served.folder, 'box.glb'));
    await bring(NAMES);
    assert.equal((await served.idle()).failed, null);
    const isWaiting = () => readdirSync(served.folder).some((name) => existsSync(join(served.folder, name, 'waits')));
    const before = files(), mine = createHash('md5').update('mine\n').digest('hex');
    for (const saves of [false, true]) {
        writeFileSync(wait, '');
        writeFileSync(drawing, boxes(['Box'], saves ? 2 : 3));
        await bring([...NAMES, saves ? 'X-1' : 'X-2']);
        while (!isWaiting())
            await new Promise((done) => setTimeout(done, 10));
        assert.equal((await (await served.api('')).json()).phase, 'preparing');
        assert.notEqual(files()['plant.glb'], before['plant.glb'], 'the new model is in place');
        // While the import holds the folder's lock, other Plantcast programs refuse to change the folder. A program that
        // ignores the lock and writes a file (matches.csv) does not lose it when the import is cancelled.
        const other = spawnSync(join(BIN, 'plantcast'), ['match', served.folder, join(served.folder, 'exports/tags.csv')]);
        assert.match(String(other.stderr), /^plantcast match: .*: plantcastd \(process \d+\) is using the plant's folder\n$/);
        if (saves)
            writeFileSync(join(served.folder, 'matches.csv'), 'mine\n');
        rmSync(wait);
        await served.post('/cancel');
        const { failed } = await served.idle(), after = files();
        assert.match(failed, /^plantcast-prep was stopped before it finished: the import was cancelled, or the daemon is stopping$/);
        for (const name of ['plant.yaml', 'plant.glb', 'tags.csv'])
            assert.equal(after[name], before[name], name);
        if (saves)
            assert.ok([after['matches.csv'], after['matches.csv.undone']].includes(mine));
        else
            assert.equal(after['matches.csv'], before['matches.csv']);
    }
    // While another process holds the folder's lock, an import does not start.
    const held = spawn('flock', [served.folder, 'sh', '-c', 'echo held; read line'], { stdio: ['pipe', 'pipe', 'ignore'] });
    await once(held.stdout, 'data');
    const now = files();
    await bring([...NAMES, 'X-3']);
    const { failed } = await served.idle();
    held.stdin.end();
    assert.match(failed, new RegExp('^the plant\'s folder .* cannot be locked: (flock|sh) \\(process \\d+\\) is using the plant\'s ' +
        'folder; try again later$'));
    assert.deepEqual(files(), now);
    assert.equal(readdirSync(served.folder).filter((name) => /^\.(import|revision\.)/.test(name)).length, 0);
});

test('the import reports duplicate rows and a tag name with control characters', options, async () => {
    const given = mkdtempSync(join(tmpdir(), 'plantcast-given-')), lines = TAGS.trim().split('\n').slice(1);
    const [model, list] = ['plant.gltf', 't.csv'].map((name) => join(given, name));
    writeFileSync(model, boxes(NAMES));
    writeFileSync(list, [...TAGS.trim().split('\n'), ...lines.slice(0, 5), '"P-201B\u0007_TT",0,1,degC,x'].join('\n'));
    const served = await Served.start(model, list); // files given on the command line must be imported like files dropped on the page
    try {
        const state = await served.idle();
        assert.equal(state.failed, null, state.failed);
        assert.match(state.said, /ignored 5 duplicate rows/);
        assert.match(state.said, /replaced 1 control characters by blanks/);
    } finally {
        await served.destroy();
        rmSync(given, { recursive: true });
    }
});

// --- on the page

let served, browser, page;
setUp(notBuilt, async () => {
    served = await Served.start();
    browser = await openPage(`${served.url}?lang=en`, DESK);
    ({ page } = browser);
});
after(async () => {
    await browser?.close();
    await served?.destroy();
});

test('an empty plant opens the import panel; a model and a tag list make a plant', options, async () => {
    await waitForPicture(page);
    await page.locator('#import.new .drop').waitFor();
    // for an empty plant the page shows a drop zone instead of the picture, which would contain only the human figure
    await page.locator('.drop-zone').waitFor();
    assert.equal(await page.locator('#import .measures').isVisible(), false, 'an empty plant shows no measurements');
    assert.deepEqual(await assetsOf(page), ['person']);
    await settle(page);
    await shoot(page, 'import-1-empty');
    await choose(page, [{ name: 'plant.gltf', text: boxes(NAMES) }, { name: 'tags.csv', text: TAGS }]);
    await inForce(page);
    await becomes(() => assetsOf(page), NAMES);
    await page.locator('.drop-zone').waitFor({ state: 'hidden' });
    assert.equal(existsSync(join(served.folder, 'plant.yaml.1')), false, 'no version is kept of a generated plant file');
    await becomes(async () => (await page.locator('#import .segments b').allTextContents()).map(Number), [10, 3, 6, 1, 3],
        'all, matched, doubtful, unmatched, unplaced');
    await settle(page);
    await shoot(page, 'import-2-plant');
});

test('by keyboard a user browses doubtful tags and their candidates, accepts one, a whole pattern or none, and saves',
    options, async () => {
    await page.locator('#import .segments label', { hasText: 'Doubtful' }).click();
    await row(page, 'TT-201').click();
    const lit = () => page.evaluate(() => globalThis.plantcast.modules.there('import').highlights.assets.map(({ id }) => id));
    await becomes(lit, ['P-201A', 'P-201B']);
    await arrive(page);
    await shoot(page, 'import-3-candidates');
    await page.keyboard.press('2');
    assert.match(await page.locator('#import [role=status]').last().textContent(), /^1 decision$/);
    assert.match(await page.locator('#import .row[aria-selected=true] b').textContent(), /^FT-201$/, 'the selection moves to the next row');
    await page.keyboard.press('n');
    await page.keyboard.press('Home');
    await page.keyboard.press('ArrowDown');
    assert.match(await page.locator('#import .row[aria-selected=true] b').textContent(), /^TT-2012$/);
    await page.keyboard.press('End');
    assert.match(await page.locator('#import .row[aria-selected=true] b').textContent(), /^TT-1014$/);
    assert.equal(await page.getByRole('button', { name: 'Accept all 2 matching TT-####' }).count(), 1,
        'a button accepts the tags of this pattern with a proposal');
    await page.keyboard.press('a');
    await page.locator('#import .segments label', { hasText: 'All' }).click();
    await shoot(page, 'import-4-decided');
    await page.getByRole('button', { name: 'Save', exact: true }).click();
    await saved(page);
    const matches = served.read('matches.csv');
    assert.match(matches, /^TT-201,sure,P-201B,,,by hand/m);
    assert.match(matches, /^FT-201,none,,,,by hand/m);
    assert.match(matches, /^TT-1013,sure,E-101,,,by hand/m);
    assert.match(matches, /^TT-1014,sure,E-101,,,by hand/m);
    assert.match(served.read('tags.csv'), /^TT-201,.*,P-201B,/m);
    await page.waitForFunction(() => globalThis.plantcast.session.model.tag('TT-201')?.asset === 'P-201B');
});

test('a tag without a candidate can be put on the equipment selected in the picture', options, async () => {
    await row(page, 'TT-9999').click();
    await page.evaluate(() => globalThis.plantcast.session.setParams({ selected: 'E-101' }));
    await row(page, 'TT-9999').click();
    await page.getByRole('button', { name: 'On the selected equipment: E-101' }).click();
    await page.getByRole('button', { name: 'Save', exact: true }).click();
    await saved(page);
    assert.match(served.read('matches.csv'), /^TT-9999,sure,E-101,,,by hand/m);
});

test('decisions stay when the models are read again in other units', options, async () => {
    const size = () => page.locator('#import .measures .size').textContent();
    await page.locator('#import .measures summary').click();
    assert.match(await size(), /^9\.00 × 1\.00 × 1\.00 m$/);
    await page.locator('#import .measures select').first().selectOption('ft');
    assert.match(await size(), /^2\.74 × 0\.30 × 0\.30 m$/, 'the panel shows the size after correction');
    await page.locator('#import .measures select').last().selectOption('z');
    await page.getByRole('button', { name: 'Apply' }).click();
    await page.waitForFunction(() => Math.abs(globalThis.plantcast.session.model.plant.bounds.max[0] - 9 * 0.3048) < 0.01);
    await page.waitForFunction(() => !document.querySelector('#import.busy'));
    assert.match(await size(), /^2\.74 × 0\.30 × 0\.30 m$/);
    assert.match(served.read('plant.yaml'), /units: ft, up: z/);
    assert.match(served.read('plant.yaml.1'), /id: "E-101"/, 'the previous plant file is kept');
    assert.match(served.read('matches.csv'), /^TT-9999,sure,E-101,,,by hand/m);
    assert.match(served.read('tags.csv'), /^TT-9999,.*,E-101,/m);
    await settle(page);
    await shoot(page, 'import-5-units');
});

test('a tag can be placed by hand in the engineer\'s panel, and then counts as placed', options, async () => {
    await row(page, 'TT-9999').click();
    await page.getByRole('button', { name: 'Place by hand' }).click();
    await page.waitForFunction(() => /TT-9999/.test(document.querySelector('#engineer .hint')?.textContent ?? ''));
    await page.locator('#import').waitFor({ state: 'hidden' });
    await shoot(page, 'import-6-place');
    const shown = () => page.evaluate(() => {
        const { isolate, ghost } = globalThis.plantcast.session.params;
        return { isolate, ghost };
    });
    await becomes(async () => (await shown()).isolate, ['E-101']);
    await page.getByRole('button', { name: 'Show all' }).click();
    // Places the tag's sensor on P-201A, not on the equipment that the tag was matched with: the page must report this during
    // the trial and again before saving.
    const { min, max } = await page.evaluate(() => {
        const { session: { model }, cameraController } = globalThis.plantcast, { bounds } = model.asset('P-201A');
        cameraController.flyToBox(bounds, 4);
        return bounds;
    });
    await land(page);
    const engineer = page.locator('#engineer'), dialog = page.locator('dialog.diff[open]');
    const { x, y } = await drawnAt(page, [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, max[2]]);
    await page.mouse.click(x, y);
    await engineer.locator('.moves .off', { hasText: /^not on E-101, where it is listed$/ }).waitFor();
    await engineer.getByRole('button', { name: 'Save …' }).click();
    await dialog.locator('.off', { hasText: 'TT-9999 was on E-101 and is now on P-201A: is that intended?' }).waitFor();
    await settle(page);
    await shoot(page, 'import-6-elsewhere');
    await dialog.getByRole('button', { name: 'Cancel' }).click();
    await engineer.getByRole('button', { name: 'Discard all' }).click();
    await page.waitForFunction(() => globalThis.plantcast.session.model.placed.size === 0);
    await page.locator('#import-toggle').click();
    // `Place by hand` isolates the tag's equipment in the picture; closing the panel shows again what was shown before.
    await page.getByRole('button', { name: 'Place by hand' }).click();
    await page.waitForFunction(() => globalThis.plantcast.session.params.isolate?.[0] === 'E-101');
    await page.locator('#import-toggle').click();
    await becomes(shown, { isolate: [], ghost: [] });
    await page.locator('#engineer').waitFor({ state: 'hidden' });
});

test('a failed import gives its reason in one line', options, async () => {
    await choose(page, [{ name: 'plant.stl', text: 'no model at all' }]);
    await wrong(page, 'plant\\.stl');
    assert.deepEqual(await assetsOf(page), NAMES);
    await shoot(page, 'import-7-wrong');
    assert.deepEqual(browser.errors, []);
});

const READERS = sweep([['dark, German', 'de', DESK, true], ['Korean on a tablet', 'ko', TABLET, false]],
    [['dark, German, on a tablet', 'de', TABLET, true]]);
for (const [name, language, screen, dark] of READERS)
    test(`the import panel fits and works: ${name}`, options, async () => {
        await withPage(`${served.url}?lang=${language}${dark ? '&theme=dark' : ''}`, screen, async (page) => {
            await waitForPicture(page);
            await page.locator('#import-toggle').click();
            await page.locator('#import .row').nth(3).click();
            await arrive(page);
            await shoot(page, `import-${language}`);
            const wide = await page.locator('#import').evaluate((panel) => panel.scrollWidth - panel.clientWidth);
            assert.ok(wide <= 0, `the panel is ${wide} pixels too wide`);
        });
    });

// --- a real plant

// Returns the unique names of a GLB file's nodes.
function namesIn(path) {
    const bytes = readFileSync(path), json = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
    const names = json.nodes.map(({ name }) => name).filter(Boolean);
    return names.filter((name) => names.indexOf(name) === names.lastIndexOf(name));
}
const seenRows = (text, status) => text.split('\n').filter((line) => line.includes(`,${status},`));

const large = sweep(test, () => {}); // runs only in long runs, because walk.mjs covers the same steps with a plant room
large('400,000 triangles and 300 tags: a first picture within 5 minutes of the first command', { skip: noData, timeout: 4e5 }, async () => {
    const models = ['models/duplex_mep.glb', 'models/plm_plant_5parts.glb'].map((name) => join(DATA, name));
    const list = join(mkdtempSync(join(tmpdir(), 'plantcast-list-')), 'tags.csv');
    const equipment = namesIn(models[0]).filter((name) => /Boiler|Pump|Radiator|Fan|Valve/.test(name));
    const { rows } = makeTagList(equipment, { seed: 7, count: 300 });
    writeFileSync(list, formats.kepware(rows));
    const real = await Served.start(), seen = await openPage(`${real.url}?lang=en`, DESK);
    try {
        await waitForPicture(seen.page);
        await choose(seen.page, [...models, list]);
        await inForce(seen.page);
        await seen.page.waitForFunction(() => globalThis.plantcast.session.model.assets.length > 100, null, { timeout: 300000 });
        await settle(seen.page);
        const seconds = (performance.now() - real.began) / 1000, { length } = seenRows(real.read('matches.csv'), 'sure');
        const triangles = Number((await (await real.api('')).json()).said
            .match(/[\d,]+(?= triangles)/g).map((text) => Number(text.replaceAll(',', ''))).reduce((a, b) => a + b));
        console.log(`# ${triangles} triangles, ${rows.length} rows, ${length} tags matched: ${seconds.toFixed(1)} s`);
        assert.ok(length > 100, `only ${length} tags matched`);
        assert.ok(triangles > 399000, `only ${triangles} triangles imported`);
        assert.ok(seconds < 300, `the import took ${seconds} s`);
        await shoot(seen.page, 'import-8-large');
        assert.deepEqual(seen.errors, []);
    } finally {
        await seen.close();
        await real.destroy();
        rmSync(join(list, '..'), { recursive: true });
    }
});

test('a data source is entered, its values are seen, it is corrected, and it survives an import from scratch', options, async () => {
    const own = await Served.start(), seen = await openPage(`${own.url}?lang=en`, DESK), { page: desk } = seen;
    const list = ['Tag Name,Address,Data Type,Scaled Low,Scaled High,Eng Units,Description', 'E-101.TT-01,400001,Float,0,150,degC,Shell',
        'P-201A.TT-01,400003,Float,0,120,degC,Bearing', 'P-201B.PT-01,400005,Float,0,16,bar,Outlet', ''].join('\n');
    const live = (text) => desk.waitForFunction((what) => document.querySelector('#import .live').textContent === what, text);
    const source = async () => (await (await own.api('')).json()).source, fold = desk.locator('#import .source');
    const connect = async (port) => {
        await fold.getByLabel('Modbus TCP device').fill('127.0.0.1');
        await fold.getByLabel('Port').fill(String(port));
        await fold.getByLabel('Byte order').selectOption('CDAB');
        await fold.getByRole('button', { name: 'Connect' }).click();
        await desk.waitForFunction((text) => document.querySelector('#import .source summary b').textContent === text &&
            !document.querySelector('#import.busy'), `127.0.0.1:${port}`);
    };
    let sim;
    try {
        await waitForPicture(desk);
        await choose(desk, [{ name: 'plant.gltf', text: boxes(NAMES) }, { name: 'tags.csv', text: list }]);
        await inForce(desk);
        assert.equal(await source(), null);
        await becomes(() => desk.evaluate(() => globalThis.plantcast.session.range), [0, 150], 'of the tags, not of the plant before');
        await fold.locator('summary').click();
        await settle(desk);
        await shoot(desk, 'import-11-source');
        const [wrongPort, port] = [await freePort(), await freePort()];
        await connect(wrongPort);
        await live('0 of 3 tags have values');
        await shoot(desk, 'import-12-no-values');
        await connect(port);
        assert.deepEqual(await source(), { host: '127.0.0.1', port: String(port), unit: '1', order: 'CDAB', base: '1' });
        assert.match(own.read('plant.yaml'), new RegExp(`^# Where values come from\\.\\nsources:\\n  - \\{ id: plc, type: modbus, ` +
            `host: 127\\.0\\.0\\.1, port: ${port}, unit: 1, address_base: 1, byte_order: CDAB \\}$`, 'm'));
        assert.equal(own.read('plant.yaml').match(/type: modbus/g).length, 1, 'the first source was changed, not added again');
        assert.match(own.read('tags.csv'), /^E-101\.TT-01,400001,Float,.*,plc,temperature,E-101,/m);
        const still = join(own.root, 'still.csv'), tags = ['E-101.TT-01', 'P-201A.TT-01', 'P-201B.PT-01'];
        writeFileSync(still, `Time_s,${tags}\n0,60,50,8\n`); // all values are constant, because each change would cost a rendered picture
        sim = new Program('plantcast-sim', [join(own.folder, 'plant.yaml'), '--values', still,
            ...tags.flatMap((tag) => ['--map', `${tag}=${tag}`])]);
        await sim.line(/^plantcast-sim: listening/m);
        await live('3 of 3 tags have values');
        await arrive(desk);
        await shoot(desk, 'import-13-values');
        // The user changes the model's unit and imports again: values continue, and a page that connects later gets sizes in
        // the new unit, too.
        await desk.locator('#import .measures summary').click();
        await desk.locator('#import .measures select').first().selectOption('ft');
        await desk.getByRole('button', { name: 'Apply' }).click();
        await desk.waitForFunction(() => Math.abs(globalThis.plantcast.session.model.plant.bounds.max[0] - 9 * 0.3048) < 0.01);
        await desk.waitForFunction(() => !document.querySelector('#import.busy'));
        assert.equal((await source()).port, String(port));
        await live('3 of 3 tags have values');
        await desk.reload();
        await waitForPicture(desk);
        await desk.locator('#import-toggle').click();
        await desk.waitForFunction(() => document.querySelector('#import .measures select')?.value === 'ft');
        for (const query of ['host=a%20b', 'host=--x', 'port=1', 'host=a&port=70000', 'host=a&order=XYZ', 'host=a&unit=256'])
            assert.equal((await own.post(`/source?${query}`)).status, 400, query);
        // An import after the tag list was removed is refused, because the new plant file would lack the data source that the
        // list brought.
        assert.equal((await own.post('/remove?name=tags.csv')).status, 200);
        const sources = /^sources:\n(  .*\n)+/m.exec(own.read('plant.yaml'))[0];
        await own.post('/run?what=anew');
        assert.match((await own.idle()).failed, /upload a tag list first: without one, the plant would lose its data source 127\.0\.0\.1/);
        assert.ok(own.read('plant.yaml').includes(sources));
        assert.equal((await own.post('/upload?name=tags.csv', list)).status, 200);
        // After a user has edited the source's line (here: poll_ms), an import refuses to change it, and the line stays.
        writeFileSync(join(own.folder, 'plant.yaml'), own.read('plant.yaml').replace('CDAB }', 'CDAB, poll_ms: 2000 }'));
        await own.post(`/source?host=127.0.0.1&port=${wrongPort}&order=CDAB`);
        assert.match((await own.idle()).failed,
            /--modbus cannot change a source that was edited by hand: edit the source in the plant file/);
        assert.match(own.read('plant.yaml'), /poll_ms: 2000/);
        assert.deepEqual(seen.errors, []);
    } finally {
        await sim?.stop();
        await seen.close();
        await own.destroy();
    }
});

test('decisions stay when the matches cannot be fetched', options, async () => {
    await page.unrouteAll();
    const inPanel = (f) => page.evaluate(f), decided = () => inPanel(() =>
        globalThis.plantcast.modules.there('import').table.matches.decisions.size);
    const bring = () => inPanel(() => globalThis.plantcast.modules.there('import').bringMatches());
    await inPanel(() => {
        const { table } = globalThis.plantcast.modules.there('import');
        table.matches.decide(table.matches.all.find(({ tag }) => tag === 'TT-2011'), 'P-201A');
    });
    const before = await decided();
    assert.ok(before > 0);
    await page.route('**/api/v1/import/matches', (route) => route.abort());
    await bring();
    assert.equal(await decided(), before);
    await page.unrouteAll();
    await bring();
    assert.equal(await decided(), before);
    await inPanel(() => globalThis.plantcast.modules.there('import').table.forget());
});

test('millimetres read as metres are noticed beside a person\'s figure, and corrected', options, async () => {
    const huge = await Served.start(), seen = await openPage(`${huge.url}?lang=en`, DESK);
    const size = () => seen.page.locator('#import .measures .size').textContent();
    try {
        await waitForPicture(seen.page);
        await choose(seen.page, [{ name: 'plant.gltf', text: boxes(NAMES, 1000) }, { name: 'tags.csv', text: TAGS }]);
        await inForce(seen.page);
        await seen.page.locator('#import .measures summary').click();
        assert.match(await size(), /^9000 × 1000 × 1000 m$/);
        await arrive(seen.page);
        await shoot(seen.page, 'import-9-huge');
        await seen.page.locator('#import .measures select').first().selectOption('mm');
        assert.match(await size(), /^9\.00 × 1\.00 × 1\.00 m$/);
        await seen.page.getByRole('button', { name: 'Apply' }).click();
        await seen.page.waitForFunction(() => globalThis.plantcast.session.model.plant.bounds.max[0] < 10);
        await seen.page.waitForFunction(() => !document.querySelector('#import.busy'));
        await arrive(seen.page);
        await shoot(seen.page, 'import-10-corrected');
        assert.deepEqual(seen.errors, []);
    } finally {
        await seen.close();
        await huge.destroy();
    }
});

test('the panel shows the text encoding of a list, and the user chooses another', options, async () => {
    const own = await Served.start(), view = await openPage(`${own.url}?lang=en`, DESK), { page: sheet } = view;
    const text = 'Tag Name,Eng Units,Description\nTI-101,℃,泵轴承温度\n';
    const { stdout: list } = spawnSync('iconv', ['-f', 'UTF-8', '-t', 'GB18030'], { input: text });
    const readAs = (pattern) => sheet.waitForFunction((what) => !document.querySelector('#import.busy') &&
        new RegExp(what).test(document.querySelector('#import .quiet').textContent), pattern, { timeout: 120000 });
    const unfold = () => sheet.locator('#import .files').first().evaluate((files) => { files.closest('details').open = true; });
    try {
        await choose(sheet, [{ name: 'm.gltf', text: boxes(['P-101', 'V-201']) }, { name: 'tags.csv', text: list }]);
        await readAs('^tags.csv: read as GB18030$');
        assert.match(own.read('tags.csv'), /TI-101,.*℃,泵轴承温度/);
        await unfold();
        await settle(sheet);
        await shoot(sheet, 'import-9-letters');
        await sheet.getByLabel('Character encoding of names and units').selectOption('Windows-1251');
        await readAs('^tags.csv: read as Windows-1251$');
        assert.doesNotMatch(own.read('tags.csv'), /泵/);
        await sheet.reload();
        await sheet.waitForFunction(() => document.querySelector('#import select')?.value === 'Windows-1251');
    } finally {
        await view.close();
        await own.destroy();
    }
});

const noReader = notBuilt || (['plantcast-import-assimp', 'plantcast-import-ifc/ifc.mjs'].every((name) => existsSync(join(BIN, name)))
    ? false : 'built without Assimp or web-ifc');
test('the panel asks about a guessed unit and reads the model again; lost elements are counted and named',
    { ...options, skip: noReader }, async () => {
    const own = await Served.start(), view = await openPage(`${own.url}?lang=en`, DESK), { page: sheet } = view;
    const [, , lines, , type] = KINDS.find(([name]) => name === 'extrusion');
    const lost = ['$', '#999'].map((shape, i) => `#90${3 + i}=IFCPIPESEGMENT('0$PlantcastKinds000000${i}',$,'LINE-100${i}',$,$,$,` +
        `${i === 0 ? '#902' : shape},$,$);`).join('\n');
    const ifc = ifcOf('IFC4', lines, type).replace('ENDSEC;\nEND-ISO', () => '#900=IFCSECTIONEDSOLIDHORIZONTAL($,$,$);\n' +
        "#901=IFCSHAPEREPRESENTATION($,'Body','AdvancedSweptSolid',(#900));\n#902=IFCPRODUCTDEFINITIONSHAPE($,$,(#901));\n" +
        `${lost}\nENDSEC;\nEND-ISO`);
    const shown = (pattern) => sheet.waitForFunction((what) => !document.querySelector('#import.busy') &&
        new RegExp(what).test(document.querySelector('#import .report').textContent), pattern, { timeout: 120000 });
    try {
        await choose(sheet, [{ name: 'skid.stl', text: stl() }, { name: 'lines.ifc', text: ifc }]);
        await shown('skid.stl does not state its unit. If the unit is metres, the model is 2 m long');
        await shown('2 elements have missing triangles');
        await sheet.locator('#import [data-kind=lost] summary').click();
        await sheet.locator('#import [data-kind=lost] li').nth(1).waitFor();
        const items = await sheet.locator('#import [data-kind=lost] li').allTextContents();
        assert.match(items[0], /^LINE-1000 #903 · IfcPipeSegment · 0\$PlantcastKinds0000000 · lines\.ifc.*IfcSectionedSolidHorizontal/);
        assert.match(items[1], /^LINE-1001 #904 .*its representation is empty/);
        await settle(sheet);
        await shoot(sheet, 'import-11-report');
        for (const [language, words] of [['ko', '삼각형이 빠진 요소 2개'], ['de', '2 Elemente sind unvollständig']]) {
            await sheet.goto(`${own.url}?lang=${language}`);
            await sheet.getByText(words).waitFor({ state: 'attached' });
        }
        await sheet.goto(`${own.url}?lang=en`);
        await waitForPicture(sheet);
        await sheet.evaluate(() => globalThis.plantcast.modules.there('import')?.open || document.getElementById('import-toggle').click());
        await sheet.locator('#import .unit [data-unit=mm]').click();
        await sheet.waitForFunction(() => document.querySelector('#import .report') && !document.querySelector('#import .unit'), null,
            { timeout: 120000 });
        await shown('^2 elements have missing triangles');
        const { models } = await (await own.api('/report')).json(), state = await own.idle();
        assert.deepEqual([state.units, state.mesh_units, state.failed], ['', 'mm', null]);
        assert.deepEqual(models.map(({ file, unit, lost_count: count }) => [file, unit, count]),
            [['lines.ifc', null, 2], ['skid.stl', null, 0]]);
        const { list } = JSON.parse(spawnSync(join(BIN, 'plantcast'), ['nodes', join(own.folder, 'skid.glb'), '--json']).stdout);
        assert.ok(Math.abs(Math.max(...list[0].size) - 0.002) < 1e-6, 'the STL is in millimetres');
    } finally {
        await view.close();
        await own.destroy();
    }
});
