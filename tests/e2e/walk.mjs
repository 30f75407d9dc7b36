// SPDX-License-Identifier: GPL-3.0-or-later
// Follows the instructions of preprocess/YOUR_PLANT.md: types each printed command and compares the output with the printed
// lines; clicks the named controls of the web page and expects the described results. Ports may differ from the printed ones,
// and times are not compared.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { arrive, drawnAt, land, openPage, settle, shoot, waitForPicture } from './support/browser.mjs';
import { DATA } from './support/folders.mjs';
import { freePort } from './support/ports.mjs';
import { long } from './support/promise.mjs';
import { BIN, missing } from './support/tiny_plant.mjs';

const absent = missing(), CAD = join(DATA, 'cad');
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : !existsSync(CAD) ? 'no ../shared/data/cad'
    : !existsSync('/usr/bin/chromium') ? 'no chromium' : false;
const page = readFileSync(new URL('../../preprocess/YOUR_PLANT.md', import.meta.url), 'utf8');
const blocks = (text, kind) => [...text.matchAll(/^```(\w*)\n([^]*?)^```$/gm)].filter(([, of]) => of === kind).map(([, , code]) => code);

// Returns the printed commands of a text with the output lines printed below each: [{ command, said: [line, ...] }].
function stepsOf(text) {
    const steps = [];
    for (const line of blocks(text, '').filter((code) => code.startsWith('$ ')).join('').split('\n').filter(Boolean))
        if (line.startsWith('$ '))
            steps.push({ command: line.slice(2).replace(/ +#.*$/, ''), said: [] });
        else
            steps.at(-1)?.said.push(line);
    return steps.filter(({ command }) => !command.includes('--serve'));
}

test('each command of YOUR_PLANT.md prints the output that the page shows', { skip, timeout: 400000 }, async () => {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-walk-')), device = await freePort(), port = await freePort(), running = [];
    const ours = (text) => text.replaceAll(':5020', `:${device}`).replaceAll(':8080', `:${port}`)
        .replace(/^plantcastd plant/, `plantcastd --port ${port} plant`);
    const env = { ...process.env, PATH: `${BIN}:${process.env.PATH}` };
    const here = { cwd: folder, env, encoding: 'utf8', timeout: 200000 };
    try {
        for (const name of ['plm-sample.rvm', 'plm-sample.att'])
            copyFileSync(join(CAD, name), join(folder, name));
        writeFileSync(join(folder, 'kepware.csv'), blocks(page, 'csv')[0]);
        for (const { command, said } of stepsOf(page).map(({ command, said }) => ({ command: ours(command), said: said.map(ours) }))) {
            const stays = / &$/.test(command) || /^plantcastd --port/.test(command);
            let out = '';
            if (stays) {
                const child = spawn('sh', ['-c', `exec ${command.replace(/ &$/, '')}`], here);
                running.push(child);
                for (const pipe of [child.stdout, child.stderr])
                    pipe.on('data', (bytes) => { out += bytes; });
                const ready = /ready http:|listening/;
                for (let i = 0; i < 600 && !ready.test(out) && child.exitCode === null; i++)
                    await new Promise((done) => setTimeout(done, 100));
                assert.match(out, ready, command);
            } else {
                const { status, stdout, stderr } = spawnSync('sh', ['-c', command], here);
                assert.equal(status, 0, `${command}: ${stderr}`);
                out = stdout + stderr;
            }
            for (const line of said)
                assert.ok(out.includes(line), `${command}: the page shows:\n${line}\nthe program printed:\n${out}`);
            console.log(`# ${command}: as on the page, ${said.length} lines`);
            // YOUR_PLANT.md also prints lines of matches.csv; the real file must contain each of them
            if (/^plantcast match/.test(command) && said.length > 0)
                for (const line of blocks(page, '').find((code) => code.startsWith('Tag,Status')).trim().split('\n'))
                    assert.ok(readFileSync(join(folder, 'plant/matches.csv'), 'utf8').includes(`${line}\n`), line);
            if (/^plantcastd --port/.test(command)) {
                for (let good = 0; good < 10;) {
                    const { tags } = await (await fetch(`http://127.0.0.1:${port}/api/v1/tags`)).json();
                    good = tags.filter(({ quality }) => quality === 'good').length;
                    await new Promise((done) => setTimeout(done, 200));
                }
                const picture = await fetch(`http://127.0.0.1:${port}/snapshot.png?width=640&height=400`);
                assert.equal(picture.status, 200);
            }
        }
        const { plant } = await (await fetch(`http://127.0.0.1:${port}/api/v1/plant`)).json();
        assert.equal(plant.name, 'plm-sample');
    } finally {
        for (const child of running) {
            const ended = new Promise((done) => child.once('exit', done));
            child.kill();
            await ended;
        }
        rmSync(folder, { recursive: true });
    }
});

// The steps of the section `On a page`, in their printed order. In one of many complete runs the click on *Place by hand* did
// nothing; the cause is not known yet.
test('each click described in YOUR_PLANT.md has the described result', { skip: skip || long, timeout: 400000 }, async () => {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-walk-')), device = await freePort(), running = [];
    const section = page.slice(page.indexOf('## On a page'), page.indexOf('## 1. The model'));
    const written = section.slice(section.indexOf('1. ')).replace(/\s+/g, ' ');
    let at = 0; // position in the section behind the last text that read() has found; texts must occur in this order
    const read = (text) => {
        const found = written.indexOf(text, at);
        assert.ok(found >= 0, `the page does not contain, or not in this order: ${text}`);
        at = found + text.length;
        return text;
    };
    const named = (text) => read(`*${text}*`).slice(1, -1);
    const here = { cwd: folder, env: { ...process.env, PATH: `${BIN}:${process.env.PATH}` } };
    const run = async (command, ready) => {
        const child = spawn('sh', ['-c', `exec ${command}`], here);
        let out = '';
        running.push(child);
        for (const pipe of [child.stdout, child.stderr])
            pipe.on('data', (bytes) => { out += bytes; });
        for (let i = 0; i < 600 && !ready.test(out) && child.exitCode === null; i++)
            await new Promise((done) => setTimeout(done, 100));
        assert.match(out, ready, command);
        return ready.exec(out);
    };
    let seen;
    try {
        for (const name of ['plm-sample.rvm', 'plm-sample.att'])
            copyFileSync(join(CAD, name), join(folder, name));
        writeFileSync(join(folder, 'kepware.csv'), blocks(page, 'csv')[0]);
        const serve = blocks(section, '')[0].split('\n').find((line) => line.startsWith('$ ')).slice(2).replace(/ +#.*$/, '');
        const [, address] = await run(serve.replace('--serve', '--serve --port 0'), /ready (http:\S+)/);
        seen = await openPage(`${address}?lang=en`, { viewport: { width: 1280, height: 800 } });
        const room = seen.page, panel = room.locator('#import'), button = (name) => room.getByRole('button', { name, exact: true });
        const row = (tag) => panel.locator('.row').filter({ has: room.locator('b', { hasText: new RegExp(`^${tag}$`) }) });
        const said = (text) => room.waitForFunction((what) =>
            document.getElementById('import').innerText.replace(/\s+/g, ' ').includes(what), text, { timeout: 100000 })
            .catch(async () => assert.fail(`the panel does not show: ${text}; but: ${await panel.innerText()}`));
        const filter = (name) => panel.locator('.segments label', { hasText: new RegExp(`^\\d+${name}$`) });
        const idle = () => room.waitForFunction(() => !document.querySelector('#import.busy') &&
            !document.querySelector('#import .row.decided'));
        await waitForPicture(room);
        await settle(room);
        await shoot(room, 'page-1-empty');

        // Step 1 of the section `On a page`: the user chooses the files.
        await said(named('Drop a model and a tag list here, or choose files'));
        const files = ['plm-sample.rvm', 'plm-sample.att', 'kepware.csv'].map((name) => join(folder, read(`\`${name}\``).slice(1, -1)));
        await panel.locator('input[type=file]').setInputFiles(files);
        await room.waitForFunction(() => globalThis.plantcast.session.model.assets.length === 19, null, { timeout: 200000 });
        await said(named('The plant is live'));

        // Step 2 of the section: the page shows the size of the model.
        await said(read('12.5 × 6.45 × 8.00 m'));
        await panel.locator('summary', { hasText: named('Size') }).click();
        assert.ok(await panel.getByLabel(named('Show a person of 1.8 m next to it')).isChecked());
        await arrive(room);
        await shoot(room, 'page-2-plant');
        await panel.locator('summary', { hasText: 'Size' }).click();

        // Step 3 of the section: the user reviews the matches of the tags.
        for (const name of ['Matched', 'Doubtful', 'Unmatched', 'Unplaced'])
            read(`${await filter(name).locator('b').textContent()} ${name}`);
        await filter(named('Doubtful')).click();
        await row(read('TT-1111')).click();
        await arrive(room);
        await shoot(room, 'page-3-candidates');
        await panel.getByRole('button', { name: /-ART1111PO-/ }).click();
        read('-ART1111PO-');
        await button(named('Save')).click();
        await idle();
        await room.waitForFunction(() => globalThis.plantcast.session.model.tag('TT-1111')?.asset === '-ART1111PO-');

        // Step 4 of the section: the user places a sensor by hand.
        await filter(named('Unplaced')).click();
        await row(read('ART1105BA_TT01')).click();
        await arrive(room);
        await panel.getByRole('button', { name: named('Place by hand') }).click();
        await room.waitForFunction(() => /ART1105BA_TT01/.test(document.querySelector('#engineer .hint')?.textContent ?? ''));
        await land(room);
        const place = await room.evaluate(() => globalThis.plantcast.session.model.tag('ART1105BA_TT01').position);
        const { x, y } = await drawnAt(room, place);
        await room.mouse.move(x, y);
        await room.mouse.down();
        for (let i = 1; i <= 6; i++) {
            await room.mouse.move(x, y - i);
            await room.waitForTimeout(50);
        }
        await room.mouse.up();
        await room.waitForFunction(() => globalThis.plantcast.session.model.placed.size === 1);
        assert.equal(await room.locator('#engineer .off').count(), 0, 'the tag is on its equipment');
        await room.mouse.move(640, 5); // moves the pointer away, so that no card covers the picture
        await arrive(room);
        await shoot(room, 'page-4-placed');
        await room.locator('#engineer').getByRole('button', { name: named('Save …') }).click();
        await settle(room);
        await shoot(room, 'page-4b-save');
        await button(named('Save and apply')).click();
        await room.waitForFunction(() => globalThis.plantcast.session.model.tag('ART1105BA_TT01').place === undefined);
        await arrive(room);
        await shoot(room, 'page-4c-saved');

        // Step 5 of the section: the user names the source of the values.
        await room.locator('#import-toggle').click();
        await panel.locator('summary', { hasText: named('Values') }).click();
        for (const [label, value] of [['Modbus TCP device', '127.0.0.1'], ['Port', '5020']])
            await panel.getByLabel(named(label)).fill(read(`\`${value}\``).slice(1, -1).replace('5020', device));
        await panel.getByLabel(named('Byte order')).selectOption(read('`CDAB`').slice(1, -1));
        await button(named('Connect')).click();
        await said(`127.0.0.1:${device}`);
        await idle();
        const [, sim] = /`(plantcast-sim [^`]*)`/.exec(written.slice(at));
        await run(read(sim), /listening/);
        await said(read('10 of 10 tags have values'));
        await arrive(room);
        await shoot(room, 'page-5-values');
        await room.locator('#import').getByRole('button', { name: 'Close' }).click();
        await room.locator('#home').click();
        await arrive(room);
        await shoot(room, 'page-6-live');
        assert.deepEqual(seen.errors, []);
    } finally {
        await seen?.close();
        for (const child of running) {
            const ended = new Promise((done) => child.once('exit', done));
            child.kill();
            await ended;
        }
        rmSync(folder, { recursive: true });
    }
});
