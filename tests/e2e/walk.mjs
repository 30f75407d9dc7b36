// SPDX-License-Identifier: GPL-3.0-or-later
// preprocess/YOUR_PLANT.md, walked: each command is typed as it stands there, and each line that stands below it has to be among what it
// says. Only ports are others, and times are not compared.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { arrive, openPage, settle, shoot, waitForPicture } from './support/browser.mjs';
import { freePort } from './support/ports.mjs';
import { BIN, missing } from './support/tiny_plant.mjs';

const absent = missing(), CAD = join(import.meta.dirname, '../../../shared/data/cad');
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : !existsSync(CAD) ? 'no ../shared/data/cad'
    : !existsSync('/usr/bin/chromium') ? 'no chromium' : false;
const page = readFileSync(join(import.meta.dirname, '../../preprocess/YOUR_PLANT.md'), 'utf8');
const blocks = (text, kind) => [...text.matchAll(/^```(\w*)\n([^]*?)^```$/gm)].filter(([, of]) => of === kind).map(([, , code]) => code);

// [{ command, said: [line, ...] }], from the section of this number on.
function stepsOf(text) {
    const steps = [];
    for (const line of blocks(text, '').filter((code) => code.startsWith('$ ')).join('').split('\n').filter(Boolean))
        if (line.startsWith('$ '))
            steps.push({ command: line.slice(2).replace(/ +#.*$/, ''), said: [] });
        else
            steps.at(-1)?.said.push(line);
    return steps.filter(({ command }) => !command.includes('--serve'));
}

test('what the page says is typed, and what it shows comes', { skip, timeout: 400000 }, async () => {
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
                assert.ok(out.includes(line), `${command}: on the page:\n${line}\nit said:\n${out}`);
            console.log(`# ${command}: as on the page, ${said.length} lines`);
            if (/^plantcast match/.test(command) && said.length > 0) // shown below it
                for (const line of blocks(page, '').find((code) => code.startsWith('Tag,Status')).trim().split('\n'))
                    assert.ok(readFileSync(join(folder, 'plant/matches.csv'), 'utf8').includes(`${line}\n`), line);
            if (/^plantcastd --port/.test(command)) {
                const seen = await openPage(`http://127.0.0.1:${port}/?lang=en`, { viewport: { width: 1280, height: 800 } });
                await waitForPicture(seen.page);
                for (let good = 0; good < 9;) {
                    const { tags } = await (await fetch(`http://127.0.0.1:${port}/api/v1/tags`)).json();
                    good = tags.filter(({ quality }) => quality === 'good').length;
                    await new Promise((done) => setTimeout(done, 200));
                }
                await settle(seen.page);
                await arrive(seen.page);
                await shoot(seen.page, 'walk-4-live');
                assert.deepEqual(seen.errors, []);
                await seen.close();
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
