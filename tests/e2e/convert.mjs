// SPDX-License-Identifier: GPL-3.0-or-later
// The plant file's key `convert`: plantcast-prep has another program make the models.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, renameSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { gltfModel } from './support/gltf_model.mjs';
import { BIN, notBuilt } from './support/tiny_plant.mjs';

const skip = notBuilt();

// Returns a glTF file of a square with that side length.
const square = (side) =>
    JSON.stringify(gltfModel([0, 0, 0, side, 0, 0, side, side, 0, 0, 0, 0, side, side, 0, 0, side, 0], [{ mesh: 0 }]));

async function withPlant(f) {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-convert-'));
    const write = (command, more = '') => writeFileSync(join(folder, 'plant.yaml'), `plant: { name: Made }
convert:
  - { model: plate.glb, from: plate.cad, command: ${JSON.stringify(command)}${more} }
assets:
  - { id: PLATE, model: plate.glb }
groups:
  - { id: t, unit: °C, min: 0, max: 100 }
tags: tags.csv
`);
    const prep = (where = folder) =>
        spawnSync(join(BIN, 'plantcast-prep'), [join(where, 'plant.yaml')], { encoding: 'utf8', timeout: 60000 });
    try {
        writeFileSync(join(folder, 'tags.csv'), 'Tag Name,Address,Data Type,Eng Units,Description,Source,Group,Asset,Node,X,Y,Z\n');
        writeFileSync(join(folder, 'plate.cad'), square(1));
        await f({ folder, write, prep });
    } finally {
        rmSync(folder, { recursive: true });
    }
}

const COPY = 'cp "$1" "$2"';

test('plantcast-prep converts a model again only when its input, its command or the model has changed',
    { skip }, () => withPlant(({ folder, write, prep }) => {
    const makes = (why, made, row) => {
        const said = prep();
        assert.equal(said.status, 0, said.stderr);
        assert.equal(/creating .*plate\.glb from .*plate\.cad/.test(said.stderr), made, why);
        assert.match(said.stdout, row);
    };
    write(COPY);
    makes('the first time', true, /1 built/);
    assert.equal(readFileSync(join(folder, 'plate.glb'), 'utf8'), square(1));
    makes('nothing has changed', false, /1 unchanged/);
    writeFileSync(join(folder, 'plate.cad'), square(2));
    makes('the input has changed', true, /1 built/);
    write(`${COPY} `);
    makes('the command has changed', true, /1 unchanged/);
    writeFileSync(join(folder, 'plate.glb'), square(3));
    makes('the model has changed', true, /1 unchanged/);
    assert.equal(readFileSync(join(folder, 'plate.glb'), 'utf8'), square(2));
    rmSync(join(folder, 'plate.glb'));
    makes('the model is gone', true, /1 unchanged/);
}));

test('a model is converted again when a file that `also` lists is added, changed or removed',
    { skip }, () => withPlant(({ folder, write, prep }) => {
    const part = (name) => join(folder, 'parts', name);
    const runs = (made) => {
        const { status, stderr } = prep();
        assert.equal(status, 0, stderr);
        assert.equal(/creating .*plate\.glb/.test(stderr), made);
    };
    write(COPY, ', also: "parts/{*.bin,*.mtl}"');
    assert.match(prep().stderr, /plant\.yaml:3: error: convert: '.*\*\.mtl\}' cannot be read: No such file/);
    mkdirSync(join(folder, 'parts'));
    writeFileSync(part('a.bin'), 'a');
    runs(true);
    writeFileSync(part('a.txt'), 'no part');
    runs(false);
    for (const change of [() => writeFileSync(part('a.bin'), 'b'), () => writeFileSync(part('b.bin'), 'b'),
        () => rmSync(part('b.bin')), () => renameSync(part('a.bin'), part('a.mtl'))]) {
        change();
        runs(true);
        runs(false);
    }
    const refused = (pattern, why) => {
        write(COPY, `, also: ${JSON.stringify(pattern)}`);
        assert.match(prep().stderr, why);
    };
    refused('parts', /'.*parts' cannot be read: Is a directory/);
    symlinkSync('loop', join(folder, 'loop'));
    refused('{parts,loop}/*', /'.*loop\}\/\*' cannot be read: Too many levels of symbolic links/);
    write(COPY, ', also: "{parts,absent}/*"');
    runs(true);
    mkdirSync(part('deep'));
    writeFileSync(part('deep/c.bin'), 'c');
    runs(false);
    write(COPY, ', also: "parts/{*,*/*}"');
    runs(true);
    writeFileSync(part('deep/c.bin'), 'd');
    runs(true);
}));

test('a conversion does not depend on the models that `convert` lists', { skip }, () => withPlant(({ folder, write, prep }) => {
    mkdirSync(join(folder, 'models'));
    writeFileSync(join(folder, 'models/part.bin'), '');
    write('sed "s/{/{\\"extras\\":$(date +%s%N),/" "$1" >"$2"', ', also: "./models/*" }\n  - { model: models/b.glb, from: plate.cad, ' +
        `command: '${COPY}', also: "*"`);
    const yaml = join(folder, 'plant.yaml');
    writeFileSync(yaml, readFileSync(yaml, 'utf8').replaceAll(' plate.glb', ' models/plate.glb'));
    for (const count of [2, 0]) {
        const { status, stderr } = prep();
        assert.equal(status, 0, stderr);
        assert.equal(stderr.match(/creating/g)?.length ?? 0, count, stderr);
    }
}));

test('the folder of the plant may have characters that are special in patterns', { skip }, () => withPlant(({ folder, write, prep }) => {
    const inner = join(folder, '[a]{b,c}*?\\d');
    write(COPY, ', also: "parts/*.bin"');
    mkdirSync(join(inner, 'parts'), { recursive: true });
    writeFileSync(join(inner, 'parts/a.bin'), '');
    for (const name of ['plant.yaml', 'tags.csv', 'plate.cad'])
        renameSync(join(folder, name), join(inner, name));
    const { status, stderr } = prep(inner);
    assert.equal(status, 0, stderr);
}));

test('a failed conversion prints one line and leaves the old model unchanged', { skip }, () => withPlant(({ folder, write, prep }) => {
    for (const [command, why, more] of [['echo first >&2; echo no licence >&2; exit 3', /could not be created: no licence/],
        ['kill -SEGV $$', /the command crashed \(SIGSEGV\)/],
        ['sleep 1000', /the command was stopped: it ran longer than 1 s \(timeout_s\)/, ', timeout_s: 1'],
        ['true', /its output \(\$2\): No such file/], ['echo x >"$2"', /its output \(\$2\): is not a glTF/],
        ["python3 -c 'import socket; socket.socket()'", /Operation not permitted/],
        ['echo x >"${1%/*}/other"', /cannot create .*other: Permission denied/],
        ['cat /etc/plantcast/tokens', /tokens: (Permission denied|No such file)/],
        ['kill -TERM $PPID; kill $PPID', /kill: .*not permitted/]]) {
        write(command, more);
        writeFileSync(join(folder, 'plate.glb'), square(5));
        const { status, stderr } = prep();
        assert.equal(status, 1);
        assert.match(stderr, why);
        assert.match(stderr, /plant\.yaml:3: error: convert: /);
        assert.equal(readFileSync(join(folder, 'plate.glb'), 'utf8'), square(5));
        assert.deepEqual(readdirSync(folder).sort(), ['plant.yaml', 'plate.cad', 'plate.glb', 'tags.csv']);
    }
    write(COPY);
    rmSync(join(folder, 'plate.cad'));
    assert.match(prep().stderr, /plant\.yaml:3: error: convert: '.*plate\.cad' cannot be read: No such file/);
}));

test('mistakes in the plant file\'s key convert are reported', { skip }, () => withPlant(({ folder, write }) => {
    const check = () => spawnSync(join(BIN, 'plantcastd'), ['--check', join(folder, 'plant.yaml')], { encoding: 'utf8' }).stderr;
    write('true', '}\n  - { model: plate.glb, from: plate.glb, command: ""');
    const said = check();
    assert.match(said, /:4:\d+: error: .*command/);
    assert.match(said, /from: must name another file than `model`/);
    assert.match(said, /model: another conversion already creates '.*plate\.glb' \(line 3\)/);
}));
