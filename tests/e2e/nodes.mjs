// SPDX-License-Identifier: GPL-3.0-or-later
// `plantcast nodes`: lists the nodes of a model.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { DATA } from './support/folders.mjs';
import { gltfModel } from './support/gltf_model.mjs';
import { promise } from './support/promise.mjs';
import { BIN, notBuilt } from './support/tiny_plant.mjs';

const skip = notBuilt();

// Returns a glTF model with one triangle of the given size, used by each of the given nodes.
function model(nodes, size = 1, meshName = 'plate') {
    const made = gltfModel([0, 0, 0, size, 0, 0, 0, 2 * size, 0], nodes);
    made.meshes[0].name = meshName;
    return made;
}

function nodes(content, ...args) {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-nodes-'));
    try {
        writeFileSync(join(folder, 'a.gltf'), typeof content === 'string' ? content : JSON.stringify(content));
        return spawnSync(join(BIN, 'plantcast'), ['nodes', join(folder, 'a.gltf'), ...args],
            { encoding: 'utf8', timeout: 60000, maxBuffer: 1 << 28, env: { ...process.env, TMPDIR: folder } });
    } finally {
        assert.deepEqual(readdirSync(folder), ['a.gltf'], 'the command leaves no file behind');
        rmSync(folder, { recursive: true });
    }
}

const three = () => model([{ name: 'Unit', children: [1, 2, 3] },
    { name: '펌프/P-101', mesh: 0, translation: [100, 0, -240], extras: { Type: 'PUMP', Rating: { power_kW: 7.5 } } },
    { mesh: 0, scale: [2, 2, 2] }, { name: 'a\nb\u0007', translation: [1, 2, 3] }]);

test('plantcast nodes prints a summary line, then one line for each node', { skip }, () => {
    const { status, stdout } = nodes(three());
    assert.equal(status, 0);
    const lines = stdout.trimEnd().split('\n');
    assert.equal(lines[0],
        '4 nodes, 1 unnamed; 2 triangles; 101.0 x 240.0 x 4.0 m if the unit is metres and Y is up; 130 m from the origin');
    assert.equal(lines.length, 6);
    assert.match(lines[3], /^#1 +1 +1 x 0 x 2 +100\.50, 240\.00, 1\.00 +Unit\/펌프\/P-101 {2}\| Type=PUMP; power_kW=7\.5$/);
    assert.match(lines[4], /^#2 +1 +2 x 0 x 4 .* Unit\/plate$/, 'a node without a name has its mesh\'s name');
    assert.match(lines[5], /Unit\/a\ufffdb\ufffd$/);
    assert.match(nodes(model([{ mesh: 0 }], 1, '')).stdout, / #0\n$/);
});

test('plantcast nodes filters with --grep, and prints a tree or JSON', { skip }, () => {
    const found = nodes(three(), '--grep', 'type=pump|nothing');
    assert.equal(found.stdout.trimEnd().split('\n').length, 3);
    assert.equal(nodes(three(), '--grep', 'xyz').status, 3);
    assert.equal(nodes(three(), '--grep', '(').status, 2);
    assert.equal(nodes(three(), '--tree', '1').stdout.trimEnd().split('\n').length, 3);
    assert.match(nodes(three(), '--tree', '2').stdout, / {4}펌프\/P-101 /);
    const { list, ...head } = JSON.parse(nodes(three(), '--json').stdout);
    assert.equal(head.nodes, 4);
    assert.equal(head.triangles, 2);
    const { number, name, parent, triangles, centre } = list[1];
    assert.deepEqual([number, name, parent, triangles, centre], [1, '펌프/P-101', 0, 1, [100.5, 240, 1]]);
    assert.equal(list[1].properties.Type, 'PUMP');
    assert.equal(list[3].name, 'a\nb\u0007');
});

test('a size that suggests millimetres read as metres gets a warning', { skip }, () => {
    assert.match(nodes(model([{ mesh: 0 }], 2500)).stdout, /check its units\. If the numbers of the model are in mm/);
    assert.doesNotMatch(nodes(model([{ mesh: 0 }], 25)).stdout, /check its units/);
    const ours = model([{ mesh: 0 }], 2500);
    ours.asset.generator = 'plantcast-import';
    assert.doesNotMatch(nodes(ours).stdout, /check its units/, 'models that import made get no warning');
});

test('listing 100,000 nodes takes seconds', { skip }, (t) => {
    const list = [{ name: 'top', children: Array.from({ length: 300 }, (_, i) => i + 1) }];
    for (let i = 0; i < 300; i++)
        list.push({ name: `area ${i}`, children: Array.from({ length: 333 }, (_, k) => 301 + i * 333 + k) });
    for (let i = 0; i < 99900; i++)
        list.push({ name: `P-${i}`, mesh: 0, translation: [i % 200, 0, i / 500], extras: { Type: 'PUMP', Number: `${i}` } });
    const from = process.hrtime.bigint(), { status, stdout } = nodes(model(list));
    const seconds = Number(process.hrtime.bigint() - from) / 1e9;
    assert.equal(status, 0);
    assert.equal(stdout.trimEnd().split('\n').length, 100203, stdout.slice(0, 400));
    promise(t, 'listing the nodes', 1000 * seconds, 20000);
});

test('a file that is no model gets one error line', { skip }, () => {
    const cyclic = model([{ children: [1] }, { children: [0] }]);
    const deep = model(Array.from({ length: 600 }, (_, i) => ({ children: [i + 1] })));
    deep.nodes.push({});
    for (const [content, why] of [['', 'not a glTF'], ['{', 'not a glTF'], [cyclic, 'not a tree'], [deep, 'not a tree'],
        ['[' .repeat(100000), 'not a glTF'], [JSON.stringify({ asset: { version: '1.0' } }), 'not glTF 2.0']]) {
        const { status, stderr, stdout } = nodes(content);
        assert.equal(status, 1);
        assert.equal(stdout, '');
        assert.equal(stderr.trimEnd().split('\n').length, 1, stderr);
        assert.ok(stderr.includes(why), stderr);
    }
});

const noData = existsSync(join(DATA, 'cad')) ? false : 'no ../shared/data/cad';
test('an RVM file is read as import reads it', { skip: skip || noData }, () => {
    const args = ['nodes', join(DATA, 'cad/plm-sample.rvm'), '--tree', '3', '--grep', 'ZONE'];
    const { status, stdout } = spawnSync(join(BIN, 'plantcast'), args,
        { encoding: 'utf8', timeout: 60000 });
    assert.equal(status, 0);
    assert.match(stdout,
        /^316 nodes, 0 unnamed; [\d,]+ triangles; 12\.5 x 6\.5 x 8\.0 m if the unit is metres and Y is up; 5 m from the origin\n/);
    assert.match(stdout, /\/-ART10 {2}\| Name=/);
});
