// SPDX-License-Identifier: GPL-3.0-or-later
// A new user's way with three real plants: from exports of two control systems to a picture with live values. Counts the
// commands that the user types and the lines edited.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { DATA } from './support/folders.mjs';
import { freePort } from './support/ports.mjs';
import { sweep } from './support/sweep.mjs';
import { formats, makeTagList } from './support/tag_lists.mjs';
import { missing, Program, runProgram } from './support/tiny_plant.mjs';

const absent = missing(), MOST_STEPS = 10;
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : !existsSync(join(DATA, 'cad')) ? 'no ../shared/data/cad' : false;
const PLANTS = [
    { plant: 'plm-sample', model: 'cad/plm-sample.rvm', format: 'kepware', equipment: [] },
    { plant: 'huldra_WD1-PSUP', model: 'cad/huldra_WD1-PSUP.rvm', format: 'intouch', equipment: [] },
    { plant: 'duplex_mep', model: 'models/duplex_mep.glb', format: 'honeywell',
        equipment: ['M_*Boiler*', 'M_*Pump*', 'M_*Fan*', 'M_*Valve*'] },
];

// Records a user's steps: typed commands, and lines changed in files.
class Walk {
    steps = [];

    type(name, ...args) {
        this.steps.push([name, ...args].join(' '));
        const { code, out, err } = runProgram(name, args, 280000);
        assert.equal(code, 0, `${name}: ${err}`);
        return out;
    }

    async start(name, args, ready) {
        this.steps.push([name, ...args].join(' '));
        const program = new Program(name, args);
        return [program, await program.line(ready, 200000)];
    }
}

for (const { plant, model, format, equipment } of sweep(PLANTS, PLANTS.slice(0, 1)))
    test(`${plant}: at most ${MOST_STEPS} steps from exports to live values`, { skip, timeout: 600000 }, async () => {
        const folder = mkdtempSync(join(tmpdir(), 'plantcast-own-')), out = join(folder, 'plant'), list = join(folder, 'export');
        const walk = new Walk(), programs = [];
        try {
            // Makes the tag list that a control system would export: names of equipment in the model in various spellings, and
            // some names that the model lacks.
            const names = runProgram('plantcast', ['nodes', join(DATA, model), '--json'], 100000).out;
            const named = [...new Set([...names.matchAll(/"name":\s*"([^"\\]{4,60})"/g)].map(([, name]) => name))];
            const wanted = named.filter((name) => (equipment.length > 0 ? /Boiler|Pump|Fan|Valve/.test(name) : /\d{3}/.test(name)));
            const { rows } = makeTagList(wanted.slice(0, 400), { seed: 7, count: 300 });
            writeFileSync(list, formats[format](rows));
            const port = await freePort();

            walk.type('plantcast', 'import', join(DATA, model), '-o', out);
            const said = walk.type('plantcast', 'match', out, list, ...equipment.flatMap((one) => ['--equipment', one]),
                '--modbus', `127.0.0.1:${port}`, '--byte-order', 'CDAB');
            walk.type('plantcast-prep', join(out, 'plant.yaml'));
            const device = new Program('plantcast-sim', [join(out, 'plant.yaml')]);
            programs.push(device);
            await device.line(/^plantcast-sim: listening/m);
            const [daemon, [, url]] = await walk.start('plantcastd', ['--port', '0', join(out, 'plant.yaml')], /ready (http:\S+)/);
            programs.push(daemon);

            for (let good = 0, tries = 0; good === 0; tries++) {
                assert.ok(tries < 300, 'no value arrived');
                await new Promise((done) => setTimeout(done, 200));
                const { tags } = await (await fetch(`${url}api/v1/tags`)).json();
                good = tags.filter(({ quality }) => quality === 'good').length;
            }
            const picture = await fetch(`${url}snapshot.png?width=320&height=200`);
            assert.equal(picture.status, 200);
            console.log(`# ${plant}: ${walk.steps.length} steps, all of them commands; ${said.match(/^\d+ tags: .*$/m)}`);
            assert.ok(walk.steps.length <= MOST_STEPS);
            assert.ok(readdirSync(out).every((name) => !/\.\d+$|\.undone$/.test(name)));
            assert.match(readFileSync(join(out, 'plant.yaml'), 'utf8'), /type: modbus/);
        } finally {
            for (const program of programs)
                await program.stop();
            rmSync(folder, { recursive: true });
        }
    });
