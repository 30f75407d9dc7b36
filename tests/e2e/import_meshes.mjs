// SPDX-License-Identifier: GPL-3.0-or-later
// OBJ, STL, PLY, FBX, COLLADA and 3DS, brought in by `plantcast import`: names, units, axes, and files that are broken.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { dae, fbx, mtl, obj, ply, stl, stlBinary, threeDs } from './support/mesh_samples.mjs';
import { BIN, missing } from './support/tiny_plant.mjs';

const absent = missing();
const notBuilt = existsSync(join(BIN, 'plantcast-import-assimp')) ? false : 'built without Assimp';
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : notBuilt;
const plantcast = (...args) => spawnSync(join(BIN, 'plantcast'), args, { encoding: 'utf8', timeout: 120000 });

async function inFolder(f) {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-meshes-'));
    try {
        writeFileSync(join(folder, 'wedge.mtl'), mtl);
        await f(folder);
    } finally {
        rmSync(folder, { recursive: true });
    }
}

async function until(f) {
    for (let i = 0; i < 2000 && !f(); i++)
        await setTimeout(20);
}

const near = (a, b) => a.every((v, k) => Math.abs(v - b[k]) < 0.002);
const boxed = (folder, name, bytes, ...args) => {
    writeFileSync(join(folder, name), bytes);
    const { status, stdout, stderr } = plantcast('nodes', join(folder, name), '--json', ...args);
    assert.equal(status, 0, stderr);
    return JSON.parse(stdout);
};

for (const { name, bytes, named } of [
    { name: 'a.obj', bytes: obj(), named: 'a/Wedge' }, { name: 'mm.OBJ', bytes: obj(1000, '펌프/P-1 A'), named: 'mm/펌프/P-1 A' },
    { name: 'mm.stl', bytes: stl(1000) }, { name: 'binary.stl', bytes: stlBinary() }, { name: 'a.ply', bytes: ply() },
    { name: 'mm.dae', bytes: dae(0.001), named: 'mm/Scene/Feed pump/쐐기' }, { name: 'feet.dae', bytes: dae(0.3048) },
    { name: 'inch.fbx', bytes: fbx(2.54), named: 'inch/Feed pump' }, { name: 'metres.fbx', bytes: fbx(100) },
    { name: 'a.3ds', bytes: threeDs(), named: 'a/#1/Wedge' },
])
    test(`${name}: its size, its height, its names`, { skip }, () => inFolder((folder) => {
        const { triangles, size, centre, list } = boxed(folder, name, bytes);
        assert.equal(triangles, 8);
        assert.ok(near(size, [2, 1, 0.5]) && near(centre, [1, 0.5, 0.25]), JSON.stringify([size, centre]));
        if (named)
            assert.equal(list.at(-1).path, named);
    }));

test('units and axis are guessed and said, or given', { skip }, () => inFolder((folder) => {
    writeFileSync(join(folder, 'a.stl'), stl(1000));
    const said = plantcast('import', join(folder, 'a.stl'), '-o', join(folder, 'plant'));
    assert.match(said.stdout, /does not say its units: mm is taken, for it is 2000 long; --units says otherwise/);
    assert.match(said.stdout, /does not say which axis is up: z is taken/);
    const given = boxed(folder, 'b.stl', stl(10), '--units', 'ft', '--up', 'y');
    assert.ok(near(given.size, [6.096, 1.524, 3.048]), JSON.stringify(given.size));
    writeFileSync(join(folder, 'a.dae'), dae());
    assert.match(plantcast('nodes', join(folder, 'a.dae'), '--units', 'mm').stderr, /COLLADA says itself what its units are/);
}));

test('a signal ends it, and nothing is left behind', { skip }, () => inFolder(async (folder) => {
    writeFileSync(join(folder, 'a.ply'), ply().slice(0, ply().length >> 1)); // on which Assimp hangs
    const program = spawn(join(BIN, 'plantcast'), ['import', join(folder, 'a.ply'), '-o', join(folder, 'plant')]);
    let said = '';
    program.stderr.on('data', (bytes) => said += bytes);
    const ended = once(program, 'close');
    await until(() => existsSync(join(folder, 'plant')) && readdirSync(join(folder, 'plant')).length > 0);
    await setTimeout(300); // for the reader to begin
    program.kill('SIGINT');
    const [code] = await ended;
    assert.equal(code, 1, said);
    assert.match(said, /a\.ply: interrupted/);
    assert.deepEqual(readdirSync(folder).sort(), ['a.ply', 'wedge.mtl']);
}));

test('a colour is kept', { skip }, () => inFolder((folder) => {
    writeFileSync(join(folder, 'a.obj'), obj());
    assert.equal(plantcast('import', join(folder, 'a.obj'), '-o', join(folder, 'plant')).status, 0);
    const bytes = readFileSync(join(folder, 'plant/a.glb')), { materials } = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
    assert.deepEqual(materials[0].pbrMetallicRoughness.baseColorFactor, [1, 0, 0, 1]);
}));

test('textures are left out, and that is said', { skip }, () => inFolder((folder) => {
    writeFileSync(join(folder, 'wedge.mtl'), `${mtl}map_Kd rust.png\nmap_Bump bump.png\n`);
    writeFileSync(join(folder, 'a.obj'), obj());
    const said = plantcast('import', join(folder, 'a.obj'), '-o', join(folder, 'plant'));
    assert.equal(said.status, 0, said.stderr);
    assert.match(said.stdout, /a\.obj: left out: 2 textures, such as bump\.png/);
}));

const countOf = (bytes, count) => {
    bytes.writeUInt32LE(count, 80);
    return bytes;
};
const noise = (bytes, every) => Buffer.from(Buffer.from(bytes).map((b, i) => i % every === every - 1 ? 255 - b : b));
const cyclic = dae().replace('<instance_geometry url="#g"/>', '<instance_geometry url="#g"/><instance_node url="#n1"/>');
const nested = dae().replace(/<node id="n2".*?<\/node>/, `${'<node>'.repeat(30000)}${'</node>'.repeat(30000)}`);
const [FBX_NESTED, DS_POINTS] = [30000, threeDs().indexOf(Buffer.from([0x10, 0x41]))];
const changed = (bytes, f) => {
    f(bytes);
    return bytes;
};
const broken = {
    'nan.ply': ply().replaceAll('\n2 ', '\nnan '), 'nan.dae': dae().replaceAll('2000', 'NaN'),
    'nan.3ds': changed(threeDs(), (bytes) => bytes.writeFloatLE(NaN, DS_POINTS + 8)),
    'nan.b.stl': changed(stlBinary(), (bytes) => bytes.writeFloatLE(Infinity, 96)),
    'huge.dae': dae().replace('<triangles count="8"', '<triangles count="4000000000"'),
    'array.dae': dae().replace('count="18"', 'count="4000000000"'), 'huge.fbx': fbx().replace('*18', '*4000000000'),
    'huge.3ds': changed(threeDs(), (bytes) => bytes.writeUInt16LE(65535, DS_POINTS + 6)),
    'chunk.3ds': changed(threeDs(), (bytes) => bytes.writeUInt32LE(0xfffffff0, DS_POINTS + 2)),
    'far.obj': obj().replaceAll('v 2 ', 'v 1e300 '), 'line.obj': `o ${'x'.repeat(3e6)}\n${obj()}`,
    'index.fbx': fbx().replace(/a: (\d+),(\d+),-\d+/, 'a: $1,$2,-2000000000'),
    'nested.fbx': fbx().replace('Shading: T', `${'A: {\n'.repeat(FBX_NESTED)}${'}\n'.repeat(FBX_NESTED)}`),
    'huge.stl': countOf(stlBinary(), 0xfffffff0), 'count.stl': countOf(stlBinary(), 9),
    'huge.ply': ply().replace('vertex 6', 'vertex 4000000000'),
    'index.ply': ply().replace('3 0 2 1', '3 0 2 1000000'), 'index.obj': obj().replace('f 1 3 2', 'f 1 3 -900000000'),
    'nan.obj': obj().replaceAll('v 2 0', 'v nan inf'), 'nan.stl': stl().replaceAll('vertex 2', 'vertex nan'),
    'nan.fbx': fbx().replace('a: 0,', 'a: nan,'),
    'cyclic.dae': cyclic, 'nested.dae': nested, 'only.dae': '<?xml version="1.0"?><COLLADA/>',
    'ring.fbx': fbx().replace('"OO",200,0', '"OO",200,200'),
};
for (const [ending, bytes] of [['obj', obj()], ['stl', stl()], ['b.stl', stlBinary()], ['ply', ply()], ['dae', dae()], ['fbx', fbx()],
    ['3ds', threeDs()]])
    Object.assign(broken, { [`empty.${ending}`]: '', [`half.${ending}`]: bytes.slice(0, bytes.length >> 1),
        [`noise.${ending}`]: noise(bytes, 29), [`zeros.${ending}`]: Buffer.alloc(5000) });

test('broken files are read or refused in one line, and leave nothing behind', { skip }, () => inFolder((folder) => {
    let refused = 0;
    for (const [name, bytes] of Object.entries(broken)) {
        writeFileSync(join(folder, name), bytes);
        const before = readdirSync(folder).sort();
        const { status, stderr, stdout } = plantcast('import', join(folder, name), '-o', join(folder, 'plant'), '--timeout', '3',
            '--memory', '2000');
        const told = status === 0 ? stdout.split('\n')[0].replace(/.*: /, 'read: ') : stderr.trim().replace(/.*?: .*?: /, '');
        console.log(`# ${name}: ${told}`);
        assert.ok(status !== 0 || !name.startsWith('half'), 'half a plant');
        assert.doesNotMatch(stderr, /bad_alloc/);
        if (status === 0) {
            if (/^nan|^far/.test(name))
                assert.match(stdout, /left out: \d+ triangles whose corners are not finite/, name);
            rmSync(join(folder, 'plant'), { recursive: true });
        } else {
            refused++;
            assert.equal(status, 1, name);
            assert.equal(stderr.trimEnd().split('\n').length, 1, stderr);
            assert.ok(stderr.includes(name), stderr);
        }
        assert.deepEqual(readdirSync(folder).sort(), before);
        rmSync(join(folder, name));
    }
    assert.ok(refused > 20, `${refused} refused`);
}));
