// SPDX-License-Identifier: GPL-3.0-or-later
// Signed pictures of the present and the past: intact ones are verified and drawn again pixel for pixel; every alteration is
// detected.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { createPrivateKey, sign } from 'node:crypto';
import { appendFileSync, chmodSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { get } from 'node:http';
import { join } from 'node:path';
import { test } from 'node:test';
import { isDeepStrictEqual } from 'node:util';
import { shoot, waitForHealth, waitForPicture, withPage } from './support/browser.mjs';
import { alteredFilms } from './support/mp4_boxes.mjs';
import { chunksOf, pngOf, textOf, withRows, withText } from './support/png_chunks.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const noFfmpeg = spawnSync('ffmpeg', ['-version']).status === 0 ? false : 'ffmpeg is not there';
const skip = notBuilt();
const STATEMENT = 'Plantcast statement', SIGNATURE = 'Plantcast signature';
let plant, picture;

const path = (name) => join(plant.folder, name);
const openssl = (...args) => assert.equal(spawnSync('openssl', args).status, 0, `openssl ${args}`);
function makeKey(name) {
    openssl('genpkey', '-algorithm', 'ed25519', '-out', path(`${name}.pem`));
    chmodSync(path(`${name}.pem`), 0o600);
    openssl('pkey', '-in', path(`${name}.pem`), '-pubout', '-out', path(`${name}.pub`));
}
// Fetches over a new connection, because the server may close an idle one while this program waits for something else.
const fetchPicture = (query, token = null) => new Promise((done, fail) => {
    get({ host: '127.0.0.1', port: plant.port, path: `/snapshot.png?${query}`, agent: false,
        headers: token ? { Authorization: `Bearer ${token}` } : {} }, (answer) => {
        const pieces = [];
        answer.on('data', (piece) => pieces.push(piece)).on('error', fail);
        answer.on('end', () => (answer.statusCode === 200 ? done(Buffer.concat(pieces))
            : fail(new Error(`${answer.statusCode}: ${query}`))));
    }).on('error', fail);
});
function verify(png, ...args) {
    writeFileSync(path('asked.png'), png);
    return runProgram('plantcast', ['verify', path('asked.png'), '--key', path('server.pub'), ...args]);
}
const redraw = (png, ...args) => verify(png, '--plant', plant.file, ...args);
function refused(png, why) {
    const { code, out, err } = verify(png);
    assert.equal(code, 1, out + err);
    assert.match(err, why);
}

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    plant.keepFresh();
    appendFileSync(plant.file, `views:
- { id: warm, title: Warm, view: "camera=2,-4,3,0,0,0,0,0,1,45" }
- { id: pump, title: Pump, view: "camera=5,-4,3,3,0,0,0,0,1,45&group=pressure" }
tours:
- { id: round, stops: [{ view: warm, dwell_s: 1, text: "Is it < 90 °C & good?" }, { view: pump, dwell_s: 1 }] }
walls: [{ id: tiled, tile: { columns: 2, rows: 1, views: warm } }]
`);
    makeKey('server');
    makeKey('other');
    await plant.start('--signing-key', path('server.pem'));
    const values = { 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 };
    await plant.set(values);
    await until('readings', async () => (await (await fetch(`${url()}api/v1/tags`)).json()).tags
        .every(({ name, value }) => value === values[name]));
    picture = await fetchPicture('width=640&height=400');
});

test('a signed picture is verified, and every pixel is drawn again', { skip }, async () => {
    const { code, out, err } = redraw(picture);
    assert.equal(code, 0, out + err);
    assert.match(out, /signature is good/);
    assert.match(out, / {2}256000 of 256000 pixels of the picture agree with the redrawn picture within 1\/255/);
    const statement = JSON.parse(textOf(picture, STATEMENT));
    assert.deepEqual(statement.readings.now.map(([tag, value]) => [tag, value]), [['TI-1', 80], ['TI-2', 20], ['PI-1', 5]]);
    assert.doesNotMatch(JSON.stringify(statement), /127\.0\.0\.1|modbus|plantcast-tiny/,
        'the statement contains no addresses and no paths');
});

test('signed pictures of all kinds of views are verified and drawn again', { skip }, async () => {
    for (const query of ['width=512&height=320&language=ko&look=glossy&isolines=every:10&split=interpolation=paper',
        'width=512&height=320&group=pressure&fit=P-101A&side=top&clip=1,0,0,-3&backdrop=dark&hidden=E-101']) {
        const { code, out, err } = redraw(await fetchPicture(query));
        assert.equal(code, 0, `${query}: ${out}${err}`);
    }
});

test('a changed pixel, reading, time or camera is detected', { skip }, () => {
    refused(withRows(picture, (rows) => { rows[2000] ^= 1; }), /the pixels of the picture differ from the signed pixels/);
    const changes = [['reading', '"TI-1",80.0', '"TI-1",79.0'],
        ['camera', '"width=640"', '"width=641"'], ['plant', 'Two boxes', 'Six boxes'],
        ['time', /"taken_ns":\d/, '"taken_ns":9'],
        ['clock', '"clock_unset":', '"clock_unset" :'], ['quality', /("TI-1",80\.0),0/, '$1,1']];
    for (const [what, from, to] of changes) {
        const changed = withText(picture, STATEMENT, (text) => text.replace(from, to));
        assert.notDeepEqual(changed, withText(picture, STATEMENT, (text) => text), what);
        refused(changed, /the signature is wrong/);
    }
});

test('another picture\'s statement, and a signature with another key, are detected', { skip }, async () => {
    const other = await fetchPicture('width=640&height=400&group=pressure');
    const moved = chunksOf(picture).map((chunk) => (chunk.type === 'IDAT' ? null : chunk)).filter(Boolean);
    moved.splice(-1, 0, ...chunksOf(other).filter(({ type }) => type === 'IDAT'));
    refused(pngOf(picture, moved), /the pixels of the picture differ from the signed pixels/);
    const { code, err } = runProgram('plantcast', ['verify', path('asked.png'), '--key', path('other.pub')]);
    assert.equal(code, 1);
    assert.match(err, /signed with another key: [0-9a-f]{16}; the given key is [0-9a-f]{16}/);
    refused(withText(picture, SIGNATURE, (text) => text.replace(/.$/, '')), /the picture's signature cannot be read/);
    refused(withText(picture, SIGNATURE, (text) => text.replace(/(\w{16} )(.)/, (_, id, first) => id + (first === 'A' ? 'B' : 'A'))),
        /the signature is wrong/);
});

// Changes the statement in a PNG file and signs the result with the server's own key, so that only the statement's content can
// be wrong. Returns the new file.
function resigned(png, change) {
    const key = createPrivateKey(readFileSync(path('server.pem'))), text = change(textOf(png, STATEMENT));
    assert.notEqual(text, textOf(png, STATEMENT));
    const by = textOf(png, SIGNATURE).split(' ')[1], signature = sign(null, Buffer.from(text), key).toString('base64');
    return withText(withText(png, STATEMENT, () => text), SIGNATURE, () => `ed25519 ${by} ${signature}`);
}

test('a statement of another version with a valid signature is reported as not understood', { skip }, () => {
    for (const version of [0, 3, 1e9])
        refused(resigned(picture, (text) => text.replace('"plantcast_statement":2', `"plantcast_statement":${version}`)),
            new RegExp(`the picture's signed statement has version ${version}; this program supports versions 1 to 2`));
    for (const [from, to] of [['"plantcast_statement":2', '"plantcast_statement":"2"'], ['"plantcast_statement":2,', '']])
        refused(resigned(picture, (text) => text.replace(from, to)), /the picture's signed statement was not written by Plantcast/);
});

// Statements of version 1 lack `overlay` and `tier`: only complete pictures of /snapshot.png were signed then, so the redrawing
// assumes a full overlay and the refined tier.
test('a statement of version 1 is verified, and its picture drawn again', { skip }, () => {
    const first = resigned(picture, (text) => text.replace('"plantcast_statement":2', '"plantcast_statement":1')
        .replace('"overlay":"full",', '').replace('"tier":"refined",', ''));
    assert.deepEqual(Object.keys(JSON.parse(textOf(first, STATEMENT))).sort(), ['assets', 'at_us', 'bare', 'clock_unset', 'configuration',
        'height', 'pixels_sha256', 'plant', 'plantcast_statement', 'query', 'readings', 'readings_sha256', 'server', 'taken_ns', 'width']);
    const { code, out, err } = redraw(first);
    assert.equal(code, 0, out + err);
    assert.match(out, /signature is good/);
    assert.doesNotMatch(out, /frame of a live session/);
    assert.match(out, / {2}256000 of 256000 pixels of the picture agree with the redrawn picture within 1\/255/);
    refused(withRows(first, (rows) => { rows[2000] ^= 1; }), /the pixels of the picture differ from the signed pixels/);
    refused(withText(first, STATEMENT, (text) => text.replace('"TI-1",80.0', '"TI-1",79.0')), /the signature is wrong/);
});

test('a PNG with extra chunks that could change its look is refused, and the chunk is named', { skip }, () => {
    const chunks = chunksOf(picture), place = (type) => chunks.findIndex((chunk) => chunk.type === type);
    const hex = (text) => Buffer.from(text, 'hex');
    const SRGB = '00007a26000080840000fa00000080e8000075300000ea6000003a9800001770';
    const SWAPPED = '00007a2600008084000075300000ea600000fa00000080e800003a9800001770';
    const spliced = (...change) => {
        const copy = [...chunks];
        copy.splice(...change);
        return pngOf(picture, copy);
    };
    const put = (type, data, before = 'IDAT') => spliced(place(before), 0, { type, data: hex(data) });
    const change = (type, data) => spliced(place(type), 1, { type, data });
    const header = (at, value) => { const data = Buffer.from(chunks[0].data); data[at] = value; return change('IHDR', data); };
    const only = (...unwanted) => chunks.filter((chunk) => !unwanted.includes(chunk));
    const more = 'unexpected PNG chunk ';
    assert.deepEqual(chunks.map(({ type }) => type).filter((type) => type !== 'IDAT'), ['IHDR', 'zTXt', 'zTXt', 'sRGB', 'IEND']);
    assert.match(verify(put('gAMA', '0000b18f')).out, /signature is good/, 'the gamma that belongs to sRGB is permitted');
    assert.match(verify(put('cHRM', SRGB)).out, /signature is good/);
    const cases = [
        ['another gamma', put('gAMA', '000186a0'), 'contents of PNG chunk gAMA differ'],
        ['gamma before sRGB', put('gAMA', '0000b18f', 'sRGB'), 'chunk sRGB is missing or in an unusual place'],
        ['primaries swapped', put('cHRM', SWAPPED), 'contents of PNG chunk cHRM differ'],
        ['no sRGB', pngOf(picture, only(chunks[place('sRGB')])), 'chunk sRGB is missing'],
        ['primaries swapped, without sRGB', spliced(place('sRGB'), 1, { type: 'cHRM', data: hex(SWAPPED) }),
            'chunk sRGB is missing'],
        ['another intent', change('sRGB', hex('01')), 'contents of PNG chunk sRGB differ'],
        ['sRGB twice', put('sRGB', '00'), 'chunk sRGB occurs twice'],
        ['sRGB behind the pixels', pngOf(picture, [...only(chunks[place('sRGB')], chunks.at(-1)), chunks[place('sRGB')], chunks.at(-1)]),
            'chunk sRGB is missing or in an unusual place'],
        ...['acTL', 'fcTL', 'fdAT', 'iCCP', 'cICP', 'mDCV', 'cLLI', 'tRNS', 'bKGD', 'sBIT', 'PLTE', 'eXIf', 'pHYs', 'oFFs', 'tEXt', 'iTXt',
            'tIME', 'abCd'].map((type) => [type, put(type, '0000000200000000'), more + type]),
        ['another text', spliced(3, 0, chunks[1]), 'chunk zTXt occurs twice'],
        ['a text behind', spliced(-1, 0, chunks[1]), 'chunk zTXt occurs twice'],
        ['texts swapped', spliced(1, 2, chunks[2], chunks[1]), 'chunk zTXt .* in an unusual place'],
        ['no texts', pngOf(picture, chunks.filter(({ type }) => type !== 'zTXt')), 'the PNG file has no text chunk Plantcast statement'],
        ['bytes behind a text', spliced(1, 1, { type: 'zTXt', data: Buffer.concat([chunks[1].data, hex('00')]) }),
            'file has no statement'],
        ['16 bits', header(8, 16), 'PNG file has another format'],
        ['a palette', header(9, 3), 'PNG file has another format'],
        ['transparency', header(9, 6), 'PNG file has another format'],
        ['interlaced', header(12, 1), 'PNG file has another format'],
        ['no header', pngOf(picture, chunks.slice(1)), 'the first chunk is not IHDR'],
        ['no pixels', pngOf(picture, chunks.filter(({ type }) => type !== 'IDAT')), 'chunk IDAT is missing'],
        ['no end', pngOf(picture, chunks.slice(0, -1)), 'the PNG file is truncated or has wrong checksums'],
        ['bytes in the end', change('IEND', hex('00')), 'contents of PNG chunk IEND differ'],
        ['bytes behind it', Buffer.concat([picture, Buffer.from('more')]), 'the PNG file has 4 bytes after'],
        ['another picture behind it', Buffer.concat([picture, picture]), 'the PNG file has'],
        ['cut', picture.subarray(0, picture.length - 20), 'PNG file is'],
        ['GIF', Buffer.from('GIF89a'), 'PNG file is'],
    ];
    for (const [what, png, why] of cases) {
        const { code, out, err } = verify(png);
        assert.equal(code, 1, `${what}: ${out}`);
        assert.match(err, new RegExp(why), what);
    }
    console.log(`# ${cases.length} altered pictures are refused, each with its reason`);
});

const url = () => `http://127.0.0.1:${plant.port}/`;
// Runs `plantcast probe` to save signed frames into `folder`; repeats it four times as long while it saves fewer than `least`,
// as on a busy machine. Returns the run and the names of the saved files.
function probe(folder, least, ...args) {
    for (let seconds = 1; ; seconds *= 4) {
        mkdirSync(folder);
        const ended = runProgram('plantcast', ['probe', url(), '--size', '320x200', '--seconds', String(seconds), ...args,
            '--save-signed', folder], 120000);
        assert.equal(ended.code, 0, ended.out + ended.err);
        const names = readdirSync(folder);
        if (names.length >= least || seconds > 60)
            return { ...ended, names };
        rmSync(folder, { recursive: true });
    }
}
const FLAG = { still: 2, signed: 64 };
let frame; // PNG file of a signed refined frame that a session got; the following tests alter it

test('a session that requests signed frames gets refined frames signed, and they can be drawn again', { skip }, () => {
    const { names } = probe(path('refined'), 1, '--motion', 'still');
    assert.ok(names.length >= 1 && names.every((name) => /^001-\d{6}\.png$/.test(name)), names.join());
    frame = readFileSync(join(path('refined'), names[0]));
    const again = redraw(frame);
    assert.equal(again.code, 0, again.out + again.err);
    assert.match(again.out, /frame of a live session, quality refined, without legend, markers and clock/);
    assert.match(again.out, / {2}64000 of 64000 pixels of the picture agree with the redrawn picture within 1\/255/);
});

test('a session that requests all frames signed gets every frame signed while it moves', { skip }, () => {
    const { out, names } = probe(path('all'), 2, '--motion', 'orbit', '--codec', 'h264', '--signed', 'all', '--json');
    const { frames, signed_frames: count } = JSON.parse(out);
    assert.ok(frames > 1 && frames === count && frames === names.length,
        `${count} of ${frames} frames are signed, ${names.length} files are stored`);
    const again = redraw(readFileSync(join(path('all'), names[names.length >> 1])));
    assert.equal(again.code, 0, again.out + again.err);
    assert.match(again.out, /frame of a live session, quality (preview|refined)/);
});

test('a changed pixel, reading, time or camera of a frame is detected', { skip }, () => {
    refused(withRows(frame, (rows) => { rows[2000] ^= 1; }), /the pixels of the picture differ from the signed pixels/);
    for (const [what, from, to] of [['reading', '"TI-1",80.0', '"TI-1",79.0'], ['time', /"taken_ns":\d/, '"taken_ns":9'],
        ['camera', /"camera=[^,]*,/, '"camera=9,'], ['tier', '"tier":"refined"', '"tier":"preview"'],
        ['overlay', '"overlay":"none"', '"overlay":"full"']]) {
        const changed = withText(frame, STATEMENT, (text) => text.replace(from, to));
        assert.notDeepEqual(changed, withText(frame, STATEMENT, (text) => text), what);
        refused(changed, /the signature is wrong/);
    }
});

test('sessions of one view get one signed frame, drawn and encoded once', { skip }, async () => {
    const hello = { type: 'hello', width: 320, height: 200, codecs: ['png'], signed: 'refined' };
    const clients = await Promise.all([1, 2].map(() => PlainClient.open(plant.port)));
    clients.forEach((client) => client.say(hello));
    // Repeats until both sessions share a frame: a signed frame is cached for half a second only, and on a busy machine the
    // second request may come later.
    for (let seq = 1, shared = 0, end = performance.now() + 90000; shared < 2; seq++) {
        for (const client of clients)
            client.say({ type: 'camera', seq, eye: [4, -3, 1 + seq % 9], target: [1, 0, 0], up: [0, 0, 1], fov: 40 });
        const frames = await Promise.all(clients.map((client) =>
            client.frameWhere('a signed frame', (one) => one.flags & FLAG.signed && one.flags & FLAG.still && one.camera_seq === seq)));
        const [first, second] = frames.map(({ data_time_us, render_us, encode_us }) => [data_time_us, render_us, encode_us]);
        if (!isDeepStrictEqual(first, second) && performance.now() < end)
            continue;
        assert.deepEqual(first, second, 'both sessions\' frames have the same timings: drawn and encoded once');
        assert.deepEqual(frames[0].payload, frames[1].payload);
        shared++;
        for (const { payload } of frames) {
            const { code, out, err } = redraw(payload);
            assert.equal(code, 0, out + err);
        }
    }
    clients.forEach((client) => client.close());
});

test('a session requests signed frames, and is told why a frame is not signed', { skip }, async () => {
    const client = await PlainClient.open(plant.port);
    const hello = { type: 'hello', width: 320, height: 200, codecs: ['jpeg', 'png'] }, still = ({ flags }) => flags & FLAG.still;
    client.say({ ...hello, codecs: ['jpeg'], signed: 'all' });
    assert.match((await client.text('error')).text, /signed: signed frames are PNG/);
    client.say(hello);
    assert.match((await client.text('welcome')).signing_key, /^[0-9a-f]{16}$/);
    assert.equal((await client.frameWhere('a refined frame', still)).flags & FLAG.signed, 0);
    client.say({ type: 'params', seq: 1, split: { group: 'pressure', isolines: 2 }, clip: { planes: [[0.3, 0.2, 1, 0.4]] } });
    client.say({ type: 'camera', seq: 2, eye: [4, -3, 2], target: [1, 0, 0], up: [0.2, 0.1, 1], fov: 40 });
    client.say({ type: 'sign', frames: 'refined' });
    const signed = await client.frameWhere('a signed frame', (one) => one.flags & FLAG.signed && one.camera_seq === 2);
    // redraws the signed frame of the view set up above, which is split, clipped and tilted
    const { code, out, err } = redraw(signed.payload);
    assert.equal(code, 0, out + err);
    client.say({ type: 'params', seq: 3, split: null, show: 'difference', baseline: 'now' });
    assert.match((await client.text('error')).text, /has no name/);
    const unsigned = await client.frameWhere('an unsigned frame', (one) => still(one) && one.params_seq === 3);
    assert.equal(unsigned.flags & FLAG.signed, 0);
    client.close();
});

test('the page saves the screen\'s picture, signed, and one with legend and markers', { skip, timeout: 120000 }, async () => {
    await withPage(url(), { viewport: { width: 1280, height: 800 } }, async (page) => {
        await waitForPicture(page);
        await waitForHealth(page, 'live');
        await page.evaluate(() => { // records the pixels on the screen when a signed frame is drawn, and the frame's statement
            const { session, viewport: { context, canvas } } = globalThis.plantcast, { drawn } = session;
            session.drawn = (of, ...more) => {
                drawn.call(session, of, ...more);
                if (!(of.flags & 64))
                    return;
                const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
                globalThis.signedPixels = crypto.subtle.digest('SHA-256', data.filter((_, i) => i % 4 !== 3))
                    .then((hash) => Array.from(new Uint8Array(hash), (byte) => byte.toString(16).padStart(2, '0')).join(''));
            };
        });
        const save = async (choice) => {
            await page.locator('#snapshot').click();
            const download = page.waitForEvent('download');
            await page.locator(`#snapshot-${choice}`).click();
            return readFileSync(await (await download).path());
        };
        const shown = await save('shown'), again = redraw(shown), statement = JSON.parse(textOf(shown, STATEMENT));
        assert.equal(again.code, 0, again.out + again.err);
        assert.match(again.out, /frame of a live session, quality refined, without legend, markers and clock/);
        assert.match(again.out, new RegExp(`  ${statement.width * statement.height} of ${statement.width * statement.height} pixels`));
        assert.equal(await page.evaluate(() => globalThis.signedPixels), statement.pixels_sha256,
            'the signed pixels are those on the screen');
        await plant.tell('set TI-1 70');
        // after one signed frame the session gets unsigned frames again
        await page.waitForFunction(() => !(globalThis.plantcast.session.picture.flags & 64));
        await plant.tell('set TI-1 80');
        const whole = await save('again'), { code, out, err } = redraw(whole);
        assert.equal(code, 0, out + err);
        assert.equal(JSON.parse(textOf(whole, STATEMENT)).overlay, 'full');
        await page.locator('#snapshot').click();
        await shoot(page, 'signed-choice');
        await page.keyboard.press('Escape');
        await page.evaluate(() => globalThis.plantcast.session.setParams({ show: 'difference', baseline: 'now' }));
        await page.locator('#snapshot').click();
        await page.locator('#snapshot-shown').click();
        await page.waitForFunction(() => /refused: .*has no name/.test(document.getElementById('toast').textContent));
    });
});

test('verification after a change of the plant says that the plant has changed', { skip }, () => {
    const tags = readFileSync(path('tags.csv'), 'utf8');
    appendFileSync(path('tags.csv'), 'TI-3,400007,Float,°C,new,temperature,E-101,0,0.5,0,1\n');
    const { code, err } = redraw(picture);
    writeFileSync(path('tags.csv'), tags);
    assert.notEqual(code, 0);
    assert.match(err, /signed statement has readings of 3 tags; the plant has 4|prepared/);
    writeFileSync(path('tags.csv'), tags.replace('left', 'LEFT'));
    const renamed = redraw(picture);
    writeFileSync(path('tags.csv'), tags);
    assert.equal(renamed.code, 1, renamed.out + renamed.err);
    assert.match(renamed.out, /DIFFERS: the configuration hash of .* was [0-9a-f]{16} when the picture was drawn, now [0-9a-f]{16}/);
});

// Repeats a comparison of a picture with the history for up to 90 s, because readings reach the history some seconds late.
const recorded = (compare) => {
    let said = null;
    return until('agreement with the history', () => {
        said = compare();
        return said.code === 0 && said;
    }, 90, () => said.out + said.err);
};

test('a signed picture of the past agrees with the recorded history', { skip }, async () => {
    const then = new Date(Date.now() - 6000); // the newest 4 s count as the present
    await plant.tell('set TI-1 30');
    await until('the later value in the history', async () => {
        const url = `http://127.0.0.1:${plant.port}/api/v1/history?tags=TI-1&from=${then / 1000}&to=${Date.now() / 1000}&points=1000`;
        return (await (await fetch(url)).json()).series[0].points.some(([, value]) => value === 30);
    });
    const past = await fetchPicture(`width=640&height=400&at=${then.toISOString()}`);
    const { out } = await recorded(() => redraw(past, '--history', path('plant.history')));
    assert.match(out, /\(history\)/);
    assert.match(out, /3 of 3 readings in the picture agree with the recorded history/);
    const now = redraw(await fetchPicture('width=640&height=400'));
    assert.equal(now.code, 0, now.out + now.err);
});

const filmed = { skip: skip || noFfmpeg, timeout: 120000 };
test('each picture of a signed film is verified; a changed, cut or re-encoded film is refused', filmed, async () => {
    const from = new Date(Date.now() - 4500).toISOString(), to = new Date(Date.now() - 3500).toISOString(), film = path('film.mp4');
    const made = runProgram('plantcast', ['clip', `http://127.0.0.1:${plant.port}/`, '-o', film, '--from', from, '--to', to, '--speed', '1',
        '--fps', '3', '--size', '321x200', '--signed'], 60000);
    assert.equal(made.code, 0, made.err);
    const check = (file, ...args) => runProgram('plantcast', ['verify', file, '--key', path('server.pub'), ...args], 90000);
    const { out } = await recorded(() => check(film, '--plant', plant.file, '--history', path('plant.history')));
    assert.match(out, /the signatures of all 4 frames are good, and no frame is missing/);
    assert.equal(out.match(/64200 of 64200 pixels of the picture agree with the redrawn picture within 1\/255/g).length, 4);
    assert.equal(out.match(/3 of 3 readings in the picture agree with the recorded history/g).length, 4);
    const bad = (file, why) => {
        const told = check(file);
        assert.equal(told.code, 1, told.out);
        assert.match(told.err, why);
    };
    const other = runProgram('plantcast', ['verify', film, '--key', path('other.pub')]);
    assert.match(other.err, /frame 1: the picture was signed with another key/);
    const reencoded = (name, ...how) => {
        const { status, stderr } = spawnSync('ffmpeg', ['-v', 'error', '-y', '-i', film, '-map_metadata', '0', '-movflags',
            'use_metadata_tags', ...how, path(name)], { encoding: 'utf8' });
        assert.equal(status, 0, stderr);
        return path(name);
    };
    const LOSSLESS = ['-c:v', 'libx264rgb', '-qp', '0'];
    assert.equal(check(reencoded('same.mp4', ...LOSSLESS)).code, 0, 'a lossless re-encoding with the same pictures is verified');
    const bits = (name, set) => reencoded(name, '-c', 'copy', '-bsf:v', `h264_metadata=${set}`);
    assert.equal(check(bits('copied.mp4', 'video_full_range_flag=1')).code, 0,
        'a copy by another program with the same colours is verified');
    bad(bits('transfer.mp4', 'transfer_characteristics=8'), /box colr has contents that|VUI.* states other colours/);
    bad(bits('primaries.mp4', 'colour_primaries=5'), /box colr has contents that|VUI.* states other colours/);
    bad(bits('range.mp4', 'video_full_range_flag=0'), /box colr has contents that|VUI.* states other colours/);
    bad(bits('shape.mp4', 'sample_aspect_ratio=2'), /pixels are not square|box (tkhd|pasp) has contents that/);
    bad(bits('sei.mp4', 'display_orientation=insert:rotate=90'),
        /an H.264 message \(SEI\) of type 47|more than one message \(SEI\)/);
    bad(bits('cropped.mp4', 'crop_right=40'), /MP4 box avc1 states \d+x\d+ pixels|box \w+ has contents that/);
    assert.equal(spawnSync('ffmpeg', ['-v', 'error', '-y', '-i', film, '-f', 'lavfi', '-i', 'anullsrc', '-shortest', '-c:v', 'copy',
        '-map_metadata', '0', '-movflags', 'use_metadata_tags', path('sound.mp4')]).status, 0);
    bad(path('sound.mp4'), /box trak occurs twice/);
    bad(reencoded('pieces.mp4', '-c', 'copy', '-movflags', 'use_metadata_tags+frag_keyframe'), /unexpected MP4 box mvex/);
    bad(reencoded('lossy.mp4', '-c:v', 'libx264rgb', '-crf', '20'), /frame 1: the pixels of the picture differ from the signed pixels/);
    bad(reencoded('yuv.mp4', '-c:v', 'libx264', '-pix_fmt', 'yuv420p', '-vf', 'crop=320:200'),
        /this frame is encoded in another way|box colr/);
    bad(reencoded('box.mp4', ...LOSSLESS, '-vf', "drawbox=10:10:1:1:red:fill:enable='eq(n,2)'"),
        /frame 3: the pixels of the picture differ/);
    const PASS = [...LOSSLESS, '-fps_mode', 'passthrough'];
    bad(reencoded('less.mp4', ...PASS, '-vf', "select='not(eq(n,1))'"),
        /frame [23]: (the pixels .*differ|the clip was changed: this frame is shown for another time)/);
    bad(reencoded('short.mp4', ...LOSSLESS, '-frames:v', '3'), /it has 3 frames, but signed statements for 4 frames/);
    bad(reencoded('slow.mp4', ...PASS, '-vf', "setpts='if(gte(N,2),PTS+3/TB,PTS)'"),
        /this frame is shown for another time than the other frames/);
    bad(reencoded('turned.mp4', '-c', 'copy', '-metadata:s:v', 'rotate=180'), /box tkhd has contents that/);
    assert.equal(spawnSync('ffmpeg', ['-v', 'error', '-y', '-i', film, '-map_metadata', '-1', '-c', 'copy', path('bare.mp4')]).status, 0);
    bad(path('bare.mp4'), /box (udta is missing|meta has contents that)/);
    const bytes = readFileSync(film);
    for (const [what, changed, why] of alteredFilms(bytes)) {
        writeFileSync(path('altered.mp4'), changed);
        const told = check(path('altered.mp4'));
        assert.equal(told.code, 1, `${what}: ${told.out}`);
        assert.match(told.err, new RegExp(why), what);
    }
    writeFileSync(path('cut.mp4'), bytes.subarray(0, bytes.length - 2000));
    bad(path('cut.mp4'), /frames|decoded|incomplete|read|damaged/);
    const plain = runProgram('plantcast', ['clip', plant.file, '-o', film, '--from', from, '--to', to, '--signed']);
    assert.equal(plain.code, 2);
    assert.match(plain.err, /needs the URL of a daemon/);
});

test('a tour is filmed signed, with its texts in a subtitle file; its views are printed', filmed, () => {
    const film = path('tour.mp4'), from = new Date(Date.now() - 6000).toISOString();
    const url = `http://127.0.0.1:${plant.port}/`, view = ['--fps', '2', '--size', '320x200'];
    const made = runProgram('plantcast', ['clip', url, '-o', film, '--from', from, '--tour', 'round', ...view, '--signed']);
    assert.equal(made.code, 0, made.err);
    assert.equal(readFileSync(path('tour.vtt'), 'utf8'), 'WEBVTT\n\n00:00:00.000 --> 00:00:01.000\nIs it &lt; 90 °C &amp; good?\n');
    const check = (...args) => runProgram('plantcast', ['verify', film, '--key', path('server.pub'), ...args], 90000);
    const { code, out, err } = check('--tour', '--plant', plant.file);
    assert.equal(code, 0, out + err);
    assert.match(out, /all 4 frames are good[^]*view from \S+: .*camera=2,-4,3,0,0,0\b.*\n {2}view from \S+: .*group=pressure/);
    assert.equal(out.match(/64000 of 64000 pixels of the picture agree with the redrawn picture within 1\/255/g).length, 4);
    const strict = check();
    assert.equal(strict.code, 1, strict.out);
    assert.match(strict.err, /frame 3: this frame shows another view/);
});

test('frames of wall tiles are never signed, whenever signing is requested', { skip }, async () => {
    const asks = async (hello, after) => {
        const client = await PlainClient.open(plant.port);
        client.say({ type: 'hello', width: 320, height: 200, codecs: ['png'], tile: { wall: 'tiled', display: 1 }, ...hello });
        if (after)
            client.say(after);
        const { code, text } = await client.text('error');
        client.close();
        return [code, text];
    };
    for (const [code, text] of [await asks({ signed: 'all' }), await asks({}, { type: 'sign', frames: 'all' })]) {
        assert.equal(code, 'not_allowed');
        assert.match(text, /are not signed/);
    }
});

test('a client that may see no readings gets no readings through signed frames', { skip }, async () => {
    await plant.daemon.stop();
    writeFileSync(path('tokens'), '');
    chmodSync(path('tokens'), 0o600);
    await plant.startDaemon('--signing-key', path('server.pem'), '--tokens', path('tokens'), '--open-viewers');
    const nobody = await PlainClient.open(plant.port);
    nobody.say({ type: 'hello', width: 320, height: 200, codecs: ['png'], signed: 'all' });
    assert.equal((await nobody.text('error')).code, 'not_allowed');
    nobody.close();
    const bare = await fetchPicture('width=640&height=400');
    const { code, out, err } = verify(bare);
    assert.equal(code, 0, out + err);
    const statement = textOf(bare, STATEMENT);
    assert.doesNotMatch(statement, /TI-1/);
    assert.match(statement, /"readings_sha256":"[0-9a-f]{64}"/);
    const again = redraw(bare);
    assert.equal(again.code, 2);
    assert.match(again.err, /a user who may not see readings/);
});

test('an invalid signing key, and one that everybody may read, are refused', { skip }, () => {
    const start = (key) => runProgram('plantcastd', [plant.file, '--port', '0', '--signing-key', key]);
    writeFileSync(path('none.pem'), 'no key\n', { mode: 0o600 });
    for (const [key, why] of [['none.pem', /none\.pem: not a private key/], ['server.pub', /all users can read this|not a private key/],
        ['away.pem', /away\.pem: No such file/]]) {
        const { code, err } = start(path(key));
        assert.notEqual(code, 0);
        assert.match(err, why);
    }
    chmodSync(path('server.pem'), 0o644);
    const { code, err } = start(path('server.pem'));
    assert.notEqual(code, 0);
    assert.match(err, /all users can read this private key/);
});

// Returns the CPU time of each thread so far in ns, by thread id.
function threadTimes(pid) {
    const folder = `/proc/${pid}/task`;
    return new Map(readdirSync(folder).map((id) => [id, Number(readFileSync(join(folder, id, 'schedstat'), 'utf8').split(' ')[0])]));
}

test('the event loop does not wait for signatures: 10,000 readings are signed in another thread', { skip, timeout: 180000 }, async () => {
    const lines = Array.from({ length: 10000 }, (_, i) => `X-${i},${400101 + i},Short,bar,spare,,,,,,3`);
    writeFileSync(path('tags.csv'), `${readFileSync(path('tags.csv'), 'utf8')}${lines.join('\n')}\n`);
    assert.equal(plant.prepare().code, 0);
    await plant.daemon.stop();
    chmodSync(path('server.pem'), 0o600);
    // without the simulator readings do not change, because handling changed readings would add work to the event loop that is
    // measured here
    await plant.sim.stop();
    await plant.startDaemon('--signing-key', path('server.pem'));
    const { pid } = plant.daemon.child, count = 10;
    const whole = await fetchPicture('width=320&height=200');
    const before_ = threadTimes(pid);
    for (let i = 0; i < count; i++)
        await fetchPicture(`width=320&height=${200 + 2 * i}`);
    const spent = [...threadTimes(pid)].map(([id, ns]) => [id, (ns - (before_.get(id) ?? 0)) / 1e6 / count]);
    const loop = spent.find(([id]) => Number(id) === pid)[1]; // the main thread runs the loop
    const report = spent.map(([id, ms]) => `${readFileSync(`/proc/${pid}/task/${id}/comm`, 'utf8').trim()} ${ms.toFixed(2)}`).join(', ');
    console.log(`# ms of CPU a signed picture, by thread: ${report}`);
    assert.match(verify(whole).out, /signature is good/);
    assert.ok(loop < 5, `a signed picture takes ${loop} ms of the event loop: ${report}`);
    // A reload while pictures are signed: each request is answered, and all pictures are valid.
    const asked = Array.from({ length: 6 }, async (_, i) => {
        const answer = await fetch(`${url()}snapshot.png?width=320&height=${240 + 2 * i}`);
        return { status: answer.status, body: Buffer.from(await answer.arrayBuffer()) };
    });
    writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace(/^name: .*$/m, 'name: Another'));
    plant.daemon.child.kill('SIGHUP');
    for (const answer of await Promise.all(asked)) {
        assert.ok([200, 503].includes(answer.status), String(answer.status));
        if (answer.status === 200)
            assert.match(verify(answer.body).out, /signature is good/);
    }
});
