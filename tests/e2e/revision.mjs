// SPDX-License-Identifier: GPL-3.0-or-later
// `plantcast import` of a new CAD export into an existing plant: matches stay, sensors move with their equipment, and a review
// lists what needs a decision. Tested with a running daemon, undone again, killed midway, and on a full disk.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import {
    copyFileSync, cpSync, existsSync, lstatSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, symlinkSync, utimesSync,
    writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { DATA, inFolder } from './support/folders.mjs';
import { boxModel } from './support/gltf_model.mjs';
import { copyGroup, findGroup, readRvm, writeRvm } from './support/rvm_file.mjs';
import { sweep } from './support/sweep.mjs';
import { BIN, missing, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const absent = missing();
const SAMPLE = join(DATA, 'cad/plm-sample');
const notBuilt = absent.length > 0 ? `not built: ${absent.join(', ')}` : false;
const noData = notBuilt || (existsSync(`${SAMPLE}.rvm`) ? false : 'no ../shared/data/cad');
const run = (program, ...args) => spawnSync(join(BIN, program), args, { encoding: 'utf8', timeout: 120000 });
const good = (said) => (assert.equal(said.status, 0, said.stderr), said);
const KILLS = sweep(24, 6);

const rowsOf = (path) => readFileSync(path, 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
const review = (folder) => rowsOf(join(folder, 'review.csv'))
    .map(([what, change, name]) => `${what} ${change} ${name.replace(/^'/, '')}`).sort();
// Returns all user-visible files of a folder, by name.
const filesOf = (folder) => Object.fromEntries(readdirSync(folder, { withFileTypes: true })
    .filter((entry) => entry.isFile()).map(({ name }) => [name, readFileSync(join(folder, name)).toString('base64')]));

// Writes a plant file with a group of temperatures. assets: the text of each asset's entry, without braces.
const writePlant = (plant, ...assets) => writeFileSync(join(plant, 'plant.yaml'), `plant: { name: revised }
assets:
${assets.map((asset) => `  - { ${asset} }\n`).join('')}groups:
  - { id: temperature, unit: °C, min: 0, max: 100 }
tags: tags.csv
`);

// Writes a changed CAD export: the pump 1101 is moved, a copy of it is added as 1102, another pump is renamed, and a pipe and a
// part of a tank are removed.
function revise(folder) {
    const rvm = readRvm(readFileSync(`${SAMPLE}.rvm`)), path = join(folder, 'plm-sample.rvm');
    const replace = (name, by) => {
        const { group, above } = findGroup(rvm, name);
        above.items.splice(above.items.indexOf(group), 1, ...by(group));
    };
    replace('/-ART1101PO-', (pump) =>
        [copyGroup(pump, [1.5, 0.25, 0]), copyGroup(pump, [4, 0, 0], (name) => name.replace('1101', '1102'))]);
    replace('/-ART1111PO-', (pump) => [copyGroup(pump, [0, 0, 0], (name) => name.replace('1111', '1113'))]);
    replace('/-ART1010TY-', () => []);
    writeFileSync(path, writeRvm(rvm));
    copyFileSync(`${SAMPLE}.att`, join(folder, 'plm-sample.att'));
    return path;
}

const LIST = `Tag Name,Address,Data Type,Scaled Low,Scaled High,Eng Units,Description
ART1105BA_TT01,400001,Float,0,150,degC,top
TT-1101,400003,Float,0,120,degC,Pump ART1101PO bearing DE temperature
art1111po.TE-03,400005,Float,0,120,degC,Bearing temperature
ART1010TY_TI_01,400007,Float,0,200,degC,Feed line
`;

function bring(folder, ...more) {
    good(run('plantcast', 'import', `${SAMPLE}.rvm`, '-o', folder));
    writeFileSync(join(folder, 'export.csv'), LIST);
    good(run('plantcast', 'match', folder, join(folder, 'export.csv'), ...more));
    // edits the tag list as a user would who confirms the position of the sensor on the pump that the revision moves
    const list = join(folder, 'tags.csv'), text = readFileSync(list, 'utf8');
    writeFileSync(list, text.replace(/(TT-1101,.*-ART1101PO-,)equipment(,,).*/, '$1$2-4.700,-4.150,3.3'));
    assert.notEqual(readFileSync(list, 'utf8'), text);
}

test('a real plant\'s import applies renamed, moved, deleted and added equipment, and undo reverts it',
    { skip: noData }, () => inFolder((folder) => {
    const plant = join(folder, 'plant'), revised = revise(folder);
    bring(plant, '--modbus', '127.0.0.1:502', '--byte-order', 'CDAB');
    const before = filesOf(plant);
    const dry = good(run('plantcast', 'import', revised, '-o', plant, '--dry-run'));
    assert.match(dry.stdout, /assets: 1 added, 1 removed, 1 renamed, 1 moved/);
    assert.deepEqual(filesOf(plant), before);
    const said = good(run('plantcast', 'import', revised, '-o', plant));
    assert.match(said.stdout, /tags: 1 moved, 1 equipment lost/);
    assert.deepEqual(review(plant).filter((row) => !row.includes(' changed ')), ['asset added -ART1102PO-', 'asset moved -ART1101PO-',
        'asset removed -ART1010TY-', 'asset renamed -ART1111PO-', 'node added plm-sample//-ART//-ART10//-ART1102PO-',
        'tag equipment lost ART1010TY_TI_01', 'tag moved TT-1101']);
    const list = readFileSync(join(plant, 'tags.csv'), 'utf8'), file = readFileSync(join(plant, 'plant.yaml'), 'utf8');
    assert.match(list, /TT-1101,.*,-ART1101PO-,,,-3\.2,-3\.9,3\.3$/m);
    assert.match(list, /art1111po\.TE-03,.*,temperature,-ART1111PO-,equipment,/);
    assert.match(list, /ART1010TY_TI_01,.*,plc,temperature,,,,,,$/m);
    assert.match(file, /- \{ id: "-ART1111PO-", tag: "-ART1113PO-", area: "-ART10", model: "plm-sample.glb", nodes: "\/-ART1113PO-" \}/);
    assert.match(file, /- \{ id: "-ART1102PO-", /);
    assert.doesNotMatch(file, /ART1010TY/);
    good(run('plantcastd', '--check', join(plant, 'plant.yaml')));
    // Running `plantcast match` again must not undo the revision, and must name the tag that is missing from the new tag list.
    writeFileSync(join(plant, 'export.csv'), LIST.replace(/^art1111po.*\n/m, ''));
    const again = good(run('plantcast', 'match', plant, join(plant, 'export.csv')));
    assert.match(again.stdout, /1 tags are no longer in the exported list; decisions about these tags are kept: art1111po\.TE-03/);
    assert.equal(readFileSync(join(plant, 'tags.csv'), 'utf8'), list);
    assert.match(readFileSync(join(plant, 'matches.csv'), 'utf8'), /^art1111po\.TE-03,sure,-ART1111PO-,/m);
    // The second match changed matches.csv after the import, so undoing the import requires --force.
    const refused = run('plantcast', 'import', '--undo', '-o', plant);
    assert.equal(refused.status, 1);
    assert.match(refused.stderr, /changed since the import: matches\.csv; --force undoes/);
    good(run('plantcast', 'import', '--undo', '--force', '-o', plant));
    const after = filesOf(plant);
    assert.match(Buffer.from(after['matches.csv.undone'], 'base64').toString(), /^ART1010TY_TI_01,none,/m);
    delete after['matches.csv.undone'];
    assert.deepEqual({ ...after, 'export.csv': before['export.csv'] }, before);
    const twice = run('plantcast', 'import', '--undo', '-o', plant);
    assert.equal(twice.status, 1);
    assert.match(twice.stderr, /this folder has no import to undo/);
    assert.ok(readdirSync(plant).every((name) => !name.startsWith('.')), readdirSync(plant).join(' '));
}));

// Writes a glTF model of boxes of one metre at given positions.
function boxes(path, nodes) {
    writeFileSync(path, JSON.stringify(boxModel(nodes.map(({ name, at, guid, turned }) => ({ name, mesh: 0, translation: at,
        ...guid && { extras: { GlobalId: guid } }, ...turned && { rotation: [0, Math.SQRT1_2, 0, Math.SQRT1_2] } })),
    { scene: nodes.map((_, i) => i) })));
}

test('assets are recognised by GUID, node number and reused names', { skip: notBuilt }, () => inFolder((folder) => {
    const model = join(folder, 'm.gltf'), plant = join(folder, 'plant'), list = join(plant, 'tags.csv');
    const A = { name: 'A', at: [0, 0, 0], guid: 'gA' }, B = { name: 'B', at: [5, 0, 0], guid: 'gB' }, C = { name: '', at: [9, 0, 0] },
        D = { name: 'D', at: [20, 0, 0] }, E = { name: 'E', at: [30, 0, 0] }, T = { name: 'TT-9', at: [5, 2, 0], guid: 'gT' };
    boxes(model, [A, B, C, D, E, T]);
    good(run('plantcast', 'import', model, '-o', plant));
    writeFileSync(join(plant, 'plant.yaml'), `plant: { name: identities }
assets:
  - { id: first, model: m.glb, nodes: A } # a comment
  - { id: second, model: m.glb, nodes: [B, TT-9] }
  - id: third
    model: m.glb
    nodes: "#2"
  - { id: fourth, model: m.glb, nodes: D }
groups:
  - { id: temperature, unit: °C, min: 0, max: 100 }
tags: tags.csv
`);
    writeFileSync(list, `Tag Name;Group;Asset;Node;Place;X;Y;Z;Mine
T1;temperature;first;;;0.5;0;1;a
T2;temperature;second;TT-9;;;;;b
T3;temperature;third;"#2";;;;;c
T4;temperature;fourth;;;20.5;0;1;d
T5;temperature;second;;equipment;;;;e
T6;temperature;second;TT-9;;;;;f
`);
    const first = filesOf(plant);
    // The new model: A and B exchange their names; A is also rotated about the vertical and moved; C has another number; TT-9,
    // the node of T2, is missing; D is moved; F is new; E, which no asset uses, is missing.
    boxes(model, [{ ...D, at: [20, 0, -3] }, { name: 'F', at: [40, 0, 0] }, C, { ...B, name: 'A' },
        { ...A, name: 'B', at: [0, 1, 0], turned: true }]);
    const said = good(run('plantcast', 'import', model, '-o', plant));
    const file = readFileSync(join(plant, 'plant.yaml'), 'utf8'), tags = readFileSync(list, 'utf8');
    assert.match(file, /id: first, model: m\.glb, nodes: "B" \} # a comment/);
    assert.match(file, /id: second, model: m\.glb, nodes: \["A"\] \}/);
    assert.match(file, /nodes: "#2"\n/);
    assert.match(file, /- \{ id: "F", model: "m\.glb", nodes: "F" \}/);
    assert.doesNotMatch(file, /id: "E"/);
    // Expected position of T1, which was at (0.5, 1, 0) on A: A's quarter turn about Y, then A's movement by 1 m upwards give
    // (0, 2, -0.5) in glTF's axes with Y up.
    assert.match(tags, /^T1;temperature;first;;;0;0\.5;2;a$/m);
    assert.match(tags, /^T2;temperature;second;;equipment;;;;b$/m);
    assert.match(tags, /^T3;temperature;third;"?#2"?;;;;;c$/m);
    assert.match(tags, /^T4;temperature;fourth;;;20\.5;3;1;d$/m);
    assert.match(tags, /^T5;temperature;second;;equipment;;;;e$/m);
    assert.match(said.stdout, /tag +place lost +T2 +on second: the tag's node TT-9 is no longer in the model/);
    assert.match(said.stdout, /tags: 2 moved, 2 place lost/);
    assert.ok(review(plant).includes('node removed E'));
    // A second import of the same model changes nothing, and undo still restores the files as they were before the first
    // import.
    assert.match(good(run('plantcast', 'import', model, '-o', plant)).stdout, /plant\.yaml: unchanged/);
    good(run('plantcast', 'import', '--undo', '-o', plant));
    assert.deepEqual(filesOf(plant), first);
    boxes(model, [{ ...A, name: '' }, { ...B, name: 'B\x01' }, C, D, E, T]);
    const unnamed = good(run('plantcast', 'import', model, '-o', plant, '--dry-run')).stdout;
    assert.match(unnamed, /asset +renamed +first +now #0; the asset keeps its id/);
    assert.match(unnamed, /asset +renamed +second +now B\ufffd; the asset keeps its id/);
    // A model without any node name of the plant belongs to another plant: the import must refuse it.
    boxes(model, [{ name: 'X', at: [100, 0, 0] }]);
    const other = run('plantcast', 'import', model, '-o', plant);
    assert.equal(other.status, 1);
    assert.match(other.stderr, /the imported models contain none of the plant's assets/);
    // Importing a model file with a new name adds its assets to the plant and leaves the others.
    boxes(join(folder, 'n.gltf'), [{ name: 'G', at: [50, 0, 0] }, { name: 'A', at: [60, 0, 0] }]);
    good(run('plantcast', 'import', join(folder, 'n.gltf'), '-o', plant));
    assert.match(readFileSync(join(plant, 'plant.yaml'), 'utf8'), /- \{ id: "G", model: "n\.glb", nodes: "G" \}\n/);
    good(run('plantcast', 'import', '--undo', '-o', plant));
    assert.deepEqual(filesOf(plant), first);
}));

test('a name that occurs several times in a model moves no tag to other equipment', { skip: notBuilt }, () => inFolder((folder) => {
    const model = join(folder, 'm.gltf'), plant = join(folder, 'plant'), list = join(plant, 'tags.csv');
    const skids = (places) => writeFileSync(model, JSON.stringify(boxModel(Object.entries(places).flatMap(([name, x], i) =>
        [{ name: `Skid ${name}`, children: [2 * i + 1] }, { name: 'Pump', mesh: 0, translation: [x, 0, 0] }]),
    { scene: Object.keys(places).map((_, i) => 2 * i) })));
    skids({ A: 0, B: 5, D: 10 });
    good(run('plantcast', 'import', model, '-o', plant));
    writePlant(plant, 'id: PUMP-A, model: m.glb, nodes: "Skid A/Pump"', 'id: PUMP-B, model: m.glb, nodes: "Skid B/Pump"');
    writeFileSync(list, 'Tag Name;Group;Asset;Node;Place;X;Y;Z\nTE-A;temperature;PUMP-A;;;0.5;0;1\nTE-B;temperature;PUMP-B;;;5.5;0;1\n');
    // Skid A is removed, and a new Skid C stands elsewhere: its pump is not the pump of Skid A.
    skids({ B: 5, C: 55, D: 10 });
    good(run('plantcast', 'import', model, '-o', plant));
    assert.deepEqual(review(plant).filter((row) => !row.startsWith('node ')), ['asset added Skid C', 'asset removed PUMP-A',
        'tag equipment lost TE-A']);
    assert.match(readFileSync(list, 'utf8'), /^TE-A;temperature;;;;;;$/m);
    assert.match(readFileSync(list, 'utf8'), /^TE-B;temperature;PUMP-B;;;5\.5;0;1$/m);
}));

test('an asset whose pattern selects several nodes keeps them all when they are renamed', { skip: notBuilt }, () => inFolder((folder) => {
    const pipes = (names) => names.map((name, i) => ({ name, at: [5 * i, 0, 0] })), four = ['Pipe-1', 'Pipe-2', 'Pipe-3', 'Pipe-4'];
    const lines = four.map((name) => name.replace('Pipe', 'Line')), tags = 'Tag Name;Group;Asset;Node;Place;X;Y;Z\n' +
        'T3;temperature;PIPES;;;10.5;0;1\n';
    for (const [names, nodes, expected] of [
        [lines, 'nodes: "Pipe-*"', /nodes: \["Line-1", "Line-2", "Line-3", "Line-4"\] \}/],
        [four.with(1, 'Line-2'), 'nodes: "Pipe-*"', /nodes: \["Pipe-\*", "Line-2"\] \}/],
        [lines, 'nodes: ["!Pipe-[34]", "Pipe-*"]', /nodes: \["!Line-3", "!Line-4", "Line-1", "Line-2", "Line-3", "Line-4"\] \}/],
    ]) {
        const model = join(folder, 'm.gltf'), plant = mkdtempSync(join(folder, 'plant-')), list = join(plant, 'tags.csv');
        boxes(model, pipes(four));
        good(run('plantcast', 'import', model, '-o', plant));
        writePlant(plant, `id: PIPES, model: m.glb, ${nodes}`);
        writeFileSync(list, tags);
        boxes(model, pipes(names));
        good(run('plantcast', 'import', model, '-o', plant));
        assert.match(readFileSync(join(plant, 'plant.yaml'), 'utf8'), expected);
        assert.equal(readFileSync(list, 'utf8'), tags);
        assert.ok(!review(plant).some((row) => /^(tag|asset (added|removed|node lost))/.test(row)), review(plant).join('\n'));
    }
}));

test('the review names equipment that an asset loses, and its sensors lose their places', { skip: notBuilt }, () => inFolder((folder) => {
    const model = join(folder, 'm.gltf'), plant = join(folder, 'plant'), list = join(plant, 'tags.csv');
    const nodes = [{ name: 'Skid', mesh: 0, children: [2] }, { name: 'Tank', mesh: 0, translation: [9, 0, 0] },
        { name: 'Motor', mesh: 0, translation: [3, 0, 0] }];
    writeFileSync(model, JSON.stringify(boxModel(nodes, { scene: [0, 1] })));
    good(run('plantcast', 'import', model, '-o', plant));
    writeFileSync(list, 'Tag Name;Group;Asset;Node;Place;X;Y;Z\nT-M;temperature;Skid;;;3.5;0;1\n' +
        'T-N;temperature;Skid;Motor;;;;\nT-S;temperature;Skid;;;0.5;0;1\n');
    // In the new export, the motor stands in the same place, but is no longer part of the skid.
    nodes[0] = { name: 'Skid', mesh: 0 };
    writeFileSync(model, JSON.stringify(boxModel(nodes, { scene: [0, 1, 2] })));
    const said = good(run('plantcast', 'import', model, '-o', plant));
    assert.match(said.stdout, /asset +node lost +Skid +.*Motor no longer belongs to the asset/);
    assert.match(said.stdout, /tag +place lost +T-M +on Skid: its node Skid\/Motor no longer belongs to the asset/);
    assert.match(said.stdout, /tag +place lost +T-N +on Skid: its node Skid\/Motor no longer belongs to the asset/);
    assert.ok(review(plant).includes('asset added Motor'));
    assert.match(readFileSync(list, 'utf8'), /^T-M;temperature;Skid;;equipment;;;$/m);
    assert.match(readFileSync(list, 'utf8'), /^T-N;temperature;Skid;;equipment;;;$/m);
    assert.match(readFileSync(list, 'utf8'), /^T-S;temperature;Skid;;;0\.5;0;1$/m);
}));

test('a path pattern decides which asset a node belongs to that moves to another parent', { skip: notBuilt }, () => inFolder((folder) => {
    const model = join(folder, 'm.gltf');
    const units = (tree) => {
        const nodes = [];
        const add = ([name, below, guid]) => {
            const index = nodes.push({ name, ...guid && { extras: { GlobalId: guid } } }) - 1;
            Object.assign(nodes[index], Array.isArray(below) ? { children: below.map(add) } : { mesh: 0, translation: [below, 0, 0] });
            return index;
        };
        const scene = tree.map(add);
        writeFileSync(model, JSON.stringify(boxModel(nodes, { scene })));
    };
    const P1 = ['P-1', 0], P2 = ['P-2', 4], Q1 = ['Q-1', 20], R1 = ['R-1', 40];
    const GUIDS = [['Unit 1', [P1, [...P2, 'guid']]], ['Unit 2', [Q1]]];
    const old = [['Unit 1', [P1, P2]], ['Unit 2', [Q1]]];
    for (const [was, is, first, second, lost] of [
        [old, [['Unit 1', [P1]], ['Unit 2', [Q1, P2]]], 'Unit 1/*', 'Unit 1/*', true],
        [old, [['Unit 1', [P1]], ['Unit 2', [Q1, P2]]], 'Unit 1/**', 'Unit 1/**', true],
        [old, [['Unit 1', [P1]], ['Unit 2', [Q1, P2]]], 'Unit 1/P-2', null, true],
        [old, [['Unit 2', [Q1, P1, P2]]], 'Unit 1/*', null, true],
        [[['Unit 1', [P1, ['Rack', [P2]]]], ['Unit 2', [Q1]]], [['Unit 1', [P1]], ['Unit 2', [Q1, ['Rack', [P2]]]]], 'Unit 1/Rack/*', null,
            true],
        [old, [['Unit 1', [P1, ['Rack', [P2]]]], ['Unit 2', [Q1]]], 'Unit 1/P-*', ['Unit 1/P-*', 'P-2'], false],
        [old, [['Unit 1A', [P1, P2]], ['Unit 2', [Q1]]], 'Unit 1/*', ['P-1', 'P-2'], false],
        [GUIDS, [['Unit 1', [P1]], ['Unit 2', [Q1, ['P-2A', 4, 'guid']]]], 'Unit */P-2', 'P-2A', false], // its name has changed
        // no other asset selects the node below Unit 3
        [[...old, ['Unit 3', [R1]]], [['Unit 1', [P1]], ['Unit 2', [Q1]], ['Unit 3', [R1, P2]]], 'Unit 1/P-2', 'P-2', false],
        [[...old, ['Unit 3', [R1]]], [['Unit 1', [P1]], ['Unit 2', [Q1]], ['Unit 3', [R1, P2]]], 'Unit 1/*', ['Unit 1/*', 'P-2'], false],
        [old, [['Site', [['Unit 1', [P1, P2]], ['Unit 2', [Q1]]]]], '/Unit 1/*', ['P-1', 'P-2'], false],
    ]) {
        const plant = mkdtempSync(join(folder, 'plant-'));
        units(was);
        good(run('plantcast', 'import', model, '-o', plant));
        writePlant(plant, `id: U1, model: m.glb, nodes: ${JSON.stringify(first)}`, 'id: U2, model: m.glb, nodes: "Unit 2/*"');
        units(is);
        good(run('plantcast', 'import', model, '-o', plant));
        const text = readFileSync(join(plant, 'plant.yaml'), 'utf8'), now = /id: U1, model: m.glb, nodes: (.*) \}/.exec(text);
        assert.deepEqual(now && JSON.parse(now[1]), second, `${first}: ${text}`);
        assert.match(text, /id: U2, model: m.glb, nodes: "Unit 2\/\*" \}/);
        assert.equal(review(plant).includes('asset node lost U1'), lost, `${first}: ${review(plant).join('\n')}`);
        assert.ok(!review(plant).some((row) => row.startsWith('asset added')), review(plant).join('\n'));
    }
}));

test('an import revises a tag list in another folder, or behind a symlink', { skip: notBuilt }, () => inFolder((folder) => {
    const model = join(folder, 'm.gltf'), lists = join(folder, 'lists'), list = join(lists, 'tags.csv');
    const A = { name: 'A', at: [0, 0, 0] }, B = { name: 'B', at: [5, 0, 0] };
    for (const linked of [false, true]) {
        const plant = join(folder, linked ? 'linked' : 'elsewhere');
        boxes(model, [A, B]);
        good(run('plantcast', 'import', model, '-o', plant));
        mkdirSync(lists, { recursive: true });
        writeFileSync(list, 'Tag Name,Address,Data Type,Eng Units,Description,Source,Group,Asset,Node,X,Y,Z\n' +
            'TT-1,,,,,,temperature,A,,0.5,1,0.5\nTT-2,,,,,,temperature,B,,5.5,1,0.5\n');
        rmSync(join(plant, 'tags.csv'));
        if (linked)
            symlinkSync(list, join(plant, 'tags.csv'));
        else
            writeFileSync(join(plant, 'plant.yaml'), readFileSync(join(plant, 'plant.yaml'), 'utf8')
                .replace('tags: tags.csv', 'tags: ../lists/tags.csv'));
        const before = readFileSync(list, 'utf8');
        boxes(model, [{ ...A, at: [0, 0, 3] }, { name: 'C', at: [40, 0, 0] }]);
        assert.match(good(run('plantcast', 'import', model, '-o', plant, '--dry-run')).stdout, /tags: 1 moved, 1 equipment lost/);
        assert.equal(readFileSync(list, 'utf8'), before);
        good(run('plantcast', 'import', model, '-o', plant));
        const after = readFileSync(list, 'utf8');
        assert.match(after, /^TT-1,.*,A,,0\.5,-2,0\.5$/m);
        assert.match(after, /^TT-2,.*,,,,,$/m);
        assert.equal(lstatSync(join(plant, 'tags.csv'), { throwIfNoEntry: false })?.isSymbolicLink() ?? false, linked);
        good(run('plantcastd', '--check', join(plant, 'plant.yaml')));
        good(run('plantcast', 'import', '--undo', '-o', plant));
        assert.equal(readFileSync(list, 'utf8'), before);
        assert.deepEqual(readdirSync(lists), ['tags.csv']);
    }
}));

test('under a running daemon, readings, history and alarms keep their tags', { skip: noData, timeout: 300000 }, async () => {
    const tiny = await TinyPlant.create(), plant = tiny.folder;
    for (const name of readdirSync(plant))
        rmSync(join(plant, name), { recursive: true });
    const api = async (path) => (await fetch(`http://127.0.0.1:${tiny.port}${path}`)).json();
    const value = async (name) => (await api('/api/v1/tags')).tags.find((tag) => tag.name === name);
    const points = async (name) => JSON.stringify(await api(`/api/v1/history?tags=${name}&from=-10m`));
    const outside = mkdtempSync(join(tmpdir(), 'plantcast-revised-'));
    try {
        bring(plant, '--modbus', `127.0.0.1:${tiny.modbusPort}`, '--byte-order', 'CDAB');
        await tiny.start();
        await tiny.tell('set TT-1101 77');
        await tiny.tell('set art1111po.TE-03 44');
        await until('a reading', async () => (await value('TT-1101')).value === 77);
        const before = await api('/api/v1/plant');
        good(run('plantcast', 'import', revise(outside), '-o', plant));
        // the daemon still serves the old files, so the connected users' values are unaffected until the reload
        assert.equal((await value('TT-1101')).value, 77);
        assert.equal(tiny.prepare().code, 0);
        const reload = async () => {
            const answer = await fetch(`http://127.0.0.1:${tiny.port}/api/v1/reload`, { method: 'POST' }), said = await answer.json();
            assert.equal(answer.status, 200, JSON.stringify(said));
            return said;
        };
        await reload();
        const after = await api('/api/v1/plant');
        assert.notEqual(after.plant.configuration, before.plant.configuration);
        for (const [name, want, asset] of [['TT-1101', 77, '-ART1101PO-'], ['art1111po.TE-03', 44, '-ART1111PO-']]) {
            await until(name, async () => (await value(name)).value === want);
            assert.equal((await value(name)).asset, asset);
        }
        assert.ok(await value('ART1010TY_TI_01'), 'a tag without equipment is still read');
        await until('history', async () => (await points('TT-1101')).includes('77'));
        good(run('plantcast', 'import', '--undo', '-o', plant));
        assert.equal(tiny.prepare().code, 0);
        await reload();
        assert.equal((await api('/api/v1/plant')).plant.configuration, before.plant.configuration);
        assert.equal((await value('ART1010TY_TI_01')).asset, '-ART1010TY-');
    } finally {
        rmSync(outside, { recursive: true });
        await tiny.destroy();
    }
});

const patient = { skip: noData, timeout: 300000 };
test('after a kill midway or a full disk, the plant is the old or the new one', patient, () => inFolder(async (folder) => {
    const first = join(folder, 'first'), revised = revise(folder), plant = join(folder, 'plant');
    bring(first);
    const old = filesOf(first);
    cpSync(first, join(folder, 'whole'), { recursive: true });
    const began = Date.now();
    good(run('plantcast', 'import', revised, '-o', join(folder, 'whole')));
    const ms = Date.now() - began, whole = filesOf(join(folder, 'whole'));
    let kept = 0;
    for (let i = 1; i <= KILLS; i++) {
        cpSync(first, plant, { recursive: true });
        const child = spawn(join(BIN, 'plantcast-import'), [revised, '-o', plant], { stdio: 'ignore' });
        const ended = new Promise((done) => child.once('exit', done));
        await sleep(ms * i / (KILLS - 1));
        child.kill('SIGKILL');
        await ended;
        const now = filesOf(plant), hourAgo = new Date(Date.now() - 3600000);
        // leaves the trial plant file of a program that was killed while it checked the new plant file
        writeFileSync(join(plant, `.trial.${child.pid}.yaml`), '');
        // makes the left files an hour old, because the next import does not delete files of the last minute, which another
        // program may be using
        for (const name of readdirSync(plant).filter((left) => left.includes(`.${child.pid}.`)))
            utimesSync(join(plant, name), hourAgo, hourAgo);
        // true: the killed import had not yet changed any of the plant's files. Otherwise the next import first completes its
        // changes. Both must end with the same files (`whole`).
        const untouched = Object.keys(old).every((name) => now[name] === old[name]);
        kept += untouched;
        if (untouched)
            good(run('plantcastd', '--check', join(plant, 'plant.yaml')));
        good(run('plantcast', 'import', revised, '-o', plant));
        assert.deepEqual(filesOf(plant), whole);
        assert.deepEqual(readdirSync(plant).filter((name) => name.startsWith('.')), ['.revision']);
        rmSync(plant, { recursive: true });
    }
    console.log(`# killed ${KILLS} times within ${ms} ms: ${kept} times before anything was replaced`);
    cpSync(first, plant, { recursive: true });
    const script = `trap '' XFSZ; ulimit -f 300; exec "$0" "$1" -o "$2"`;
    const full = spawnSync('bash', ['-c', script, join(BIN, 'plantcast-import'), revised, plant],
        { encoding: 'utf8', timeout: 60000 });
    assert.equal(full.status, 1);
    assert.equal(full.stderr.trim().split('\n').length, 1, full.stderr);
    assert.deepEqual(filesOf(plant), old);
    assert.deepEqual(readdirSync(plant).filter((name) => name.startsWith('.')), []);
}));
