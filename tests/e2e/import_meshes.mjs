// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `plantcast import` of OBJ, STL, PLY, FBX, COLLADA, 3DS and glTF files. Names, sizes, units and up axis must be right,
// shapes that are not read must be reported, and broken files must be read or refused in one line.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { importBroken } from './support/broken_files.mjs';
import { inFolder } from './support/folders.mjs';
import { volumeOf } from './support/glb_volume.mjs';
import { dae, fbx, mtl, obj, ply, stl, stlBinary, threeDs } from './support/mesh_samples.mjs';
import { family } from './support/processes.mjs';
import { secondMeshReader } from './support/second_cad_reader.mjs';
import { sweep } from './support/sweep.mjs';
import { BIN, missing } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const absent = missing();
const notBuilt = existsSync(join(BIN, 'plantcast-import-assimp')) ? false : 'built without Assimp';
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : notBuilt;
const plantcast = (...args) => spawnSync(join(BIN, 'plantcast'), args, { encoding: 'utf8', timeout: 120000 });

const withMaterials = (f) => inFolder((folder) => {
    writeFileSync(join(folder, 'wedge.mtl'), mtl);
    return f(folder);
});

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
    test(`${name}: size, height and names are imported`, { skip }, () => withMaterials((folder) => {
        const { triangles, size, centre, list } = boxed(folder, name, bytes);
        assert.equal(triangles, 8);
        assert.ok(near(size, [2, 1, 0.5]) && near(centre, [1, 0.5, 0.25]), JSON.stringify([size, centre]));
        if (named)
            assert.equal(list.at(-1).path, named);
    }));

test('units and up axis are guessed and reported, or taken from the options', { skip }, () => withMaterials((folder) => {
    writeFileSync(join(folder, 'a.stl'), stl(1000));
    const said = plantcast('import', join(folder, 'a.stl'), '-o', join(folder, 'plant'));
    assert.match(said.stdout,
        /states no unit: assuming mm, which makes the model's length of 2000 equal to 2 m;.*set --units/);
    assert.match(said.stdout, /states no up axis: assuming z/);
    assert.doesNotMatch(said.stdout, /check its units/);
    const nodes = plantcast('nodes', join(folder, 'a.stl'), '--json');
    assert.match(nodes.stderr, /a\.stl: the file states no unit: assuming mm, which makes /);
    assert.match(nodes.stderr, /a\.stl: the file states no up axis: assuming z/);
    assert.equal(JSON.parse(nodes.stdout).triangles, 8);
    for (const [scale, size] of [[0.01, '0.02 x 0.01 x 0.005 m'], [2e5, '400 x 200 x 100 m']]) {
        writeFileSync(join(folder, 'c.stl'), stl(scale));
        for (const args of [['import', '-o', join(folder, `${scale}`)], ['nodes']])
            assert.match(plantcast(...args, join(folder, 'c.stl')).stdout, new RegExp(`its size is ${size}: check its units$`, 'm'));
    }
    const given = boxed(folder, 'b.stl', stl(10), '--units', 'ft', '--up', 'y');
    assert.ok(near(given.size, [6.096, 1.524, 3.048]), JSON.stringify(given.size));
    writeFileSync(join(folder, 'a.dae'), dae());
    assert.match(plantcast('nodes', join(folder, 'a.dae'), '--units', 'mm').stderr, /COLLADA files state their own units/);
}));

// The wedge in surveyed metres, 5,800 km from the origin, where positions stored as float have steps of 0.5 m.
const PLACE = [431250.137, 5812345.678, 12.5];
const surveyed = (text, word) => text.replace(new RegExp(`^${word} (\\S+) (\\S+) (\\S+)`, 'gm'), (_, ...p) =>
    `${word} ${PLACE.map((v, axis) => (v + Number(p[axis])).toFixed(3)).join(' ')}`);

test('a model far from the origin keeps its size in OBJ, and is reported in other formats', { skip }, () => withMaterials((folder) => {
    const box = boxed(folder, 'far.obj', surveyed(obj(), 'v'), '--units', 'm', '--up', 'y');
    assert.ok(near(box.size, [2, 1, 0.5]), JSON.stringify(box.size));
    assert.ok([431251.137, -12, 5812345.928].every((v, k) => Math.abs(box.centre[k] - v) < 0.1), JSON.stringify(box.centre));
    const lines = (name, bytes) => {
        writeFileSync(join(folder, name), bytes);
        const { status, stdout, stderr } = plantcast('import', join(folder, name), '-o', join(folder, `plant of ${name}`),
            '--mesh-units', 'm');
        assert.equal(status, 0, stderr);
        return stdout;
    };
    const error = /error: the model has coordinates up to \d{7} m from its origin: positions are rounded to steps of (\S+) mm/;
    assert.doesNotMatch(lines('far.obj', surveyed(obj(), 'v')), /rounded/);
    assert.doesNotMatch(lines('near.stl', stl()), /rounded/);
    assert.equal(error.exec(lines('far.stl', surveyed(stl(), 'vertex')))?.[1], '500');
    const moved = dae(1).replace('<node id="n2" name="쐐기">', '$&<translate>0 0 5812345.678</translate>');
    assert.equal(error.exec(lines('far.dae', moved))?.[1], '500');
    // a second vertex at the origin prevents the move
    assert.equal(error.exec(lines('wide.obj', surveyed(obj(), 'v').replace('usemtl', 'v 0 0 0\nf 1 2 7\nusemtl')))?.[1], '500');
}));

test('an STL file in capitals is read', { skip }, () => withMaterials((folder) => {
    const { size, list } = boxed(folder, 'a.stl', stl().replace(/.*/g, (line) => line.toUpperCase()));
    assert.ok(near(size, [2, 1, 0.5]) && list.length > 0, JSON.stringify(size));
}));

test('STL: a solid\'s name is its whole line; the report says which unit was guessed', { skip }, () => withMaterials((folder) => {
    const bytes = stl().replaceAll('Wedge', 'P-101 A  (spare)'), report = join(folder, 'report.json');
    assert.equal(boxed(folder, 'a.stl', bytes).list.at(-1).name, 'P-101 A  (spare)');
    const models = (...args) => {
        const { status, stderr } = plantcast('import', join(folder, 'a.stl'), '-o', join(folder, 'plant'), '--report', report, ...args);
        assert.equal(status, 0, stderr);
        return JSON.parse(readFileSync(report)).models;
    };
    assert.deepEqual(models(), [{ file: 'a.stl', lost_count: 0, lost: [], errors: [], left_out: [], unit: { taken: 'm', length: 2 },
        failed: null }]);
    assert.equal(models('--mesh-units', 'mm')[0].unit, null);
}));

test('OBJ: a material file in a folder written with backslashes is found', { skip }, () => withMaterials((folder) => {
    mkdirSync(join(folder, 'looks'));
    writeFileSync(join(folder, 'looks/wedge.mtl'), mtl);
    const { triangles } = boxed(folder, 'a.obj', obj().replace(/mtllib .*/, 'mtllib .\\looks\\wedge.mtl'));
    assert.equal(triangles, 8);
}));

// In FBX, a geometric transform of a node moves the node's own mesh but not its children. Here it moves the pump's mesh by 100
// in = 2.54 m along x; the child lies 200 in = 5.08 m from the pump along x, and its own transform moves its mesh by 2.54 m
// along y.
test('FBX: a geometric transform moves its own mesh and no child', { skip }, () => withMaterials((folder) => {
    const whole = fbx(2.54), moved = (x, y) => `"A",${x},0,0\n            P: "GeometricTranslation", "Vector3D", "Vector", "",${y}\n`;
    const mesh = /Geometry: 100[\s\S]*?\n {4}\}\n/.exec(whole)[0], model = /Model: 200[\s\S]*?\n {4}\}\n/.exec(whole)[0];
    const child = `    ${mesh.replace('100', '101')}    ${model.replace('200', '201').replace('Feed pump', 'Child')
        .replace('"A",0,0,0\n', moved(200, '0,100,0'))}`;
    const bytes = whole.replace('"A",0,0,0\n', moved(0, '100,0,0')).replace('}\nConnections:', `${child}}\nConnections:`)
        .replace('C: "OO",100,200', 'C: "OO",100,200\n    C: "OO",201,200\n    C: "OO",101,201');
    const { list } = boxed(folder, 'a.fbx', bytes);
    assert.deepEqual(list.map(({ path }) => path), ['a', 'a/Feed pump', 'a/Feed pump/Child']);
    assert.ok(near(list[2].centre, [1 + 5.08, 0.5 + 2.54, 0.25]), JSON.stringify(list[2]));
    /* the node and its child extend from x = 2.54 m to 7.08 m */
    assert.ok(near(list[1].size, [4.54, 3.54, 0.5]), JSON.stringify(list[1]));
}));

// One triangle as a glTF file whose buffer is `uri`, or as a GLB file with the given chunks.
const triangle = Buffer.alloc(44);
[0, 0, 0, 1, 0, 0, 1, 1, 0].forEach((v, i) => triangle.writeFloatLE(v, 4 * i));
[0, 1, 2].forEach((v, i) => triangle.writeUInt16LE(v, 36 + 2 * i));
const gltf = (uri, more = {}) => JSON.stringify({ asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: 'T-1' }], meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    buffers: [{ byteLength: 42, uri }], bufferViews: [{ buffer: 0, byteLength: 36 }, { buffer: 0, byteOffset: 36, byteLength: 6 }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] },
        { bufferView: 1, componentType: 5123, count: 3, type: 'SCALAR' }], ...more });
function glbOf(...chunks) {
    const head = Buffer.from('glTF\x02\0\0\0\0\0\0\0'), parts = chunks.flatMap(([kind, bytes]) => {
        const size = Buffer.alloc(8, kind.padEnd(8, '\0'));
        size.copyWithin(4, 0, 4);
        size.writeUInt32LE(bytes.length);
        return [size, bytes];
    });
    head.writeUInt32LE(12 + parts.reduce((sum, { length }) => sum + length, 0), 8);
    return Buffer.concat([head, ...parts]);
}

test('glTF: percent signs and accents in file names are decoded; unknown required extensions and missing images are handled',
    { skip }, () => withMaterials((folder) => {
    const file = (name) => writeFileSync(join(folder, name), triangle);
    for (const [name, uri] of [['tank 10%.bin', 'tank 10%.bin'], ['a+b#1.bin', 'a+b%231.bin'], ['50%25.bin', '50%25.bin'],
        ['Behälter.bin'.normalize('NFD'), 'Behälter.bin'.normalize('NFC')],
        ['Öl.bin'.normalize('NFC'), encodeURIComponent('Öl.bin'.normalize('NFD'))],
        ['back.bin', '.\\back.bin']]) {
        file(name);
        assert.equal(boxed(folder, 'a.gltf', gltf(uri)).triangles, 1, uri);
        rmSync(join(folder, name));
    }
    file('a.bin');
    writeFileSync(join(folder, 'look.gltf'), gltf('a.bin', { extensionsRequired: ['KHR_texture_basisu'],
        images: [{ uri: 'none.png' }], textures: [{ source: 0 }],
        materials: [{ name: 'paint', pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }] }));
    const { status, stdout, stderr } = plantcast('import', join(folder, 'look.gltf'), '-o', join(folder, 'plant'));
    assert.equal(status, 0, stderr);
    assert.match(stdout, new RegExp('left out: Plantcast does not support the glTF extension KHR_texture_basisu, which the file ' +
        'requires: the model is shown without it, because it affects only the look'));
    assert.match(stdout, new RegExp('left out: material 0 \'paint\': the base colour texture: the texture\'s image is missing, so the ' +
        'texture is not shown: \'none\\.png\''));
    const ran = (program, ...args) => spawnSync(join(BIN, program), [...args, join(folder, 'plant/plant.yaml')], { encoding: 'utf8' });
    assert.match(ran('plantcastd', '--check').stdout,
        /not prepared yet \(no prepared files in .*\), so some things were not checked: glTF textures and extensions that /);
    // `plantcastd --check` names what the import left out, even after a second run of plantcast-prep, which finds the model
    // prepared and does not read it again.
    for (let run = 0; run < 2; run++) {
        assert.equal(ran('plantcast-prep').status, 0);
        const checked = ran('plantcastd', '--check').stdout;
        assert.match(checked, /plant\.yaml:\d+: warning: model .*look\.glb: left out: .* the glTF extension KHR_texture_basisu, which/);
        assert.match(checked, /warning: model .*look\.glb: left out: material 0 'paint': the base colour texture/);
    }
    writeFileSync(join(folder, 'r.gltf'), gltf('a.bin', { extensionsRequired: ['CESIUM_RTC'] }));
    assert.match(plantcast('import', join(folder, 'r.gltf'), '-o', join(folder, 'other')).stderr,
        /requires the glTF extension CESIUM_RTC, which Plantcast does not support/);
}));

const read = (folder, name, bytes) => {
    writeFileSync(join(folder, name), bytes);
    const said = plantcast('import', join(folder, name), '-o', join(folder, `${name}.plant`), '--report', join(folder, 'report.json'));
    assert.equal(said.status, 0, said.stderr);
    const bytesOfGlb = readFileSync(join(folder, `${name}.plant/${name.replace(/\.\w+$/, '')}.glb`));
    return { ...JSON.parse(readFileSync(join(folder, 'report.json'))).models[0], out: said.stdout,
        json: JSON.parse(bytesOfGlb.subarray(20, 20 + bytesOfGlb.readUInt32LE(12))) };
};

test('FBX: surfaces without placement, with two placements or without finite corners are reported',
    { skip }, () => withMaterials((folder) => {
    const model = (id, name, x = 0) => `    Model: ${id}, "Model::${name}", "Mesh" {\n        Version: 232\n        Properties70:  {\n` +
        `            P: "Lcl Translation", "Lcl Translation", "", "A",${x},0,0\n        }\n    }\n`;
    const withModels = (models, links) => fbx().replace('    Model: 200', `${models}    Model: 200`)
        .replace('    C: "OO",200,0', ['C: "OO",200,0', ...links].map((link) => `    ${link}`).join('\n'));
    const ring = read(folder, 'ring.fbx', withModels(model(201, 'Drum\t1\tA') + model(202, 'Tank'),
        ['C: "OO",201,202', 'C: "OO",202,201', 'C: "OO",100,201']));
    assert.deepEqual(ring.lost, [{ id: '201', name: 'Drum 1 A', class: 'model', guid: '',
        why: 'this part is not shown, because the FBX file does not connect it with the scene' }]);
    const shared = read(folder, 'shared.fbx', withModels(model(201, 'Drum'), ['C: "OO",201,200', 'C: "OO",201,0', 'C: "OO",100,201']));
    assert.deepEqual(shared.errors[0], { count: 1, text: 'FBX part Drum has 2 parents: the part is shown below each parent' });
    const twice = read(folder, 'twice.fbx', fbx().replace(/P: "Lcl Translation".*0,0,0/, (line) =>
        [5, 7].map((x) => line.replace('0,0,0', `${x},0,0`)).join('\n')));
    assert.deepEqual(twice.errors[0], { count: 1,
        text: 'in the FBX file, model Feed pump states property Lcl Translation more than once: the last value is used' });
    assert.ok(twice.json.nodes.some(({ matrix }) => matrix?.[12] === 7), JSON.stringify(twice.json.nodes));
    for (const number of ['-1.#IND', '1.#INF', '1.#QNAN0', 'nan'])
        assert.match(read(folder, 'nan.fbx', fbx().replace('a: 0,', `a: ${number},`)).out,
            /left out: \d+ triangles whose coordinates are infinite or not numbers, in Feed pump\n/);
}));

test('FBX, COLLADA and OBJ: shapes that are not read are reported', { skip }, () => withMaterials((folder) => {
    const nurbs = fbx().replace('    Model: 200', '    Geometry: 101, "Geometry::Shell", "NurbsSurface" {\n        Form: "Open"\n    }\n' +
        '    Model: 201, "Model::Tank shell", "NurbsSurface" {\n        Version: 232\n    }\n    Model: 200')
        .replace('    C: "OO",200,0', '    C: "OO",200,0\n    C: "OO",201,0\n    C: "OO",101,201');
    const { errors: fbxErrors, lost: fbxLost } = read(folder, 'a.fbx', nurbs), fbxTexts = fbxErrors.map(({ text }) => text);
    assert.deepEqual(fbxLost, [{ id: '', name: 'Tank shell', class: 'model', guid: '',
        why: 'Plantcast does not read NURBS and patches, so this part is not shown: export the model as polygons' }]);
    assert.ok(fbxTexts.includes('Assimp: FBX-DOM failed to read source object for incoming Model link, ignoring'), fbxTexts.join('; '));
    const hull = '<geometry id="h" name="Hull"><convex_mesh convex_hull_of="#g"/></geometry></library_geometries>';
    const { lost, errors } = read(folder, 'b.dae', dae().replace('</library_geometries>', hull).replace('</visual_scene>',
        '<node id="n8" name="Gone"><instance_geometry url="#zz"/></node></visual_scene>'));
    assert.deepEqual(lost, [{ id: 'h', name: 'Hull', class: 'geometry', guid: '',
        why: 'Plantcast does not read convex hulls, so this geometry is not shown: export the geometry as polygons' }]);
    assert.deepEqual(errors, [{ count: 1, text: 'Assimp: Collada: Unable to find geometry for ID "zz". Skipping.' }]);
    const free = read(folder, 'c.obj', `${obj()}cstype bezier\ndeg 3 3\nsurf 0 1 0 1 1 2 3 4\nparm u 0 1\nend\no Pipe axis\nl 1 2\n`);
    assert.deepEqual(free.errors[0], { count: 1,
        text: 'Plantcast does not read free-form surfaces (surf), so they are not shown: export the surfaces as polygons' });
    assert.match(free.out, /not shown: 1 nodes that consist only of lines or points: Pipe axis\n/);
}));

// Files that use features which exporters write differently. The area and size that Plantcast imports are compared with those
// of three.js, the second reader, which ignores the unit of FBX and OBJ (`metres`).
const polygons = obj().replace(/f .*\n/g, '').concat('g slab\nf -6 -5 \\\n-4 -3\ng wedge\nf 1 5 2\nf 4 3 6\nf 2 5 6 3\nf 1 4 6 5\n');
const SECOND = [['a.obj', obj()], ['polygons.obj', polygons], ['mm.dae', dae(0.001)], ['feet.dae', dae(0.3048)],
    ['mirrored.dae', dae().replace('<node id="n2"', '<node id="n2x"><matrix>-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>' +
        '<instance_geometry url="#g"/></node><node id="n2"')],
    ['twice.dae', dae().replace('<node id="n2"', '<node id="n2x"><translate>0 5000 0</translate><rotate>0 0 1 90</rotate>' +
        '<instance_geometry url="#g"/></node><node id="n2"')],
    ['inch.fbx', fbx(2.54), { metres: 0.0254 }], ['metres.fbx', fbx(100)],
    ['geometric.fbx', fbx(2.54).replace('P: "Lcl Translation", "Lcl Translation", "", "A",0,0,0', (line) => `${line}\n            P: ` +
        '"GeometricTranslation", "Vector3D", "Vector", "",10,20,30\n            P: "Lcl Rotation", "Lcl Rotation", "", "A",0,0,90\n' +
        '            P: "Lcl Scaling", "Lcl Scaling", "", "A",-1,2,1'), { metres: 0.0254 }]];
// Returns the FBX text with tabs instead of blanks, because three.js cannot read FBX that is indented with blanks.
const indented = (text) => Buffer.from(text.replace(/^( {4})+/gm, (blanks) => '\t'.repeat(blanks.length / 4)));
test('FBX, COLLADA and OBJ: area and size equal those of a second reader', { skip }, (t) => withMaterials(async (folder) => {
    const second = await secondMeshReader();
    if (!second)
        return t.skip('no second reader: npm ci in tests/e2e brings three and @xmldom/xmldom');
    for (const [name, bytes, how] of SECOND) {
        const { lost } = read(folder, name, bytes);
        assert.deepEqual(lost, []);
        const ours = volumeOf(join(folder, `${name}.plant/${name.replace(/\.\w+$/, '')}.glb`));
        const theirs = second(name, indented(bytes), how);
        const areas = `${ours.area.toFixed(4)} m2 of ${theirs.area.toFixed(4)}`;
        const text = `${name}: ${areas}, ${ours.size.map((v) => v.toFixed(3)).join(' x ')} m`;
        console.log(`# ${text}`);
        assert.ok(Math.abs(ours.area / theirs.area - 1) < 1e-3 && near(ours.size, theirs.size),
            `${text}: area or size differ from ${theirs.size}`);
    }
}));

test('glTF: nodes without triangles, and nodes in no scene, are reported', { skip }, () => withMaterials((folder) => {
    writeFileSync(join(folder, 'a.bin'), triangle);
    const mesh = (mode, indices = 1) => ({ primitives: [{ attributes: { POSITION: 0 }, indices, mode }] });
    const { lost, left_out, out } = read(folder, 'a.gltf', gltf('a.bin', { scenes: [{ nodes: [0, 1, 2, 3] }, { nodes: [4] }],
        meshes: [mesh(4), mesh(1), mesh(0), mesh(4, 2)], accessors: [...JSON.parse(gltf('')).accessors,
            { bufferView: 1, componentType: 5123, count: 0, type: 'SCALAR' }], extensionsUsed: ['ACME_bent', 'KHR_materials_unlit'],
        nodes: [...['T-1', 'L-2', 'P-3', 'E-4'].map((name, i) => ({ name, mesh: i })), { name: 'S-5', mesh: 0 }] }));
    assert.deepEqual(lost, [{ id: '#3', name: 'E-4', class: 'node', guid: '', why: 'the node\'s mesh has no triangles' }]);
    assert.match(out, /not shown: 2 nodes that consist only of lines or points: L-2, P-3\n/);
    assert.deepEqual(left_out, ['the file uses the glTF extension ACME_bent, which Plantcast does not support and ignores',
        "not shown, because not in the glTF file's default scene: 1 node with a mesh, node 4 'S-5'"]);
}));

test('glTF: the diffuse colour of old materials, unusual image types and unknown chunks are read',
    { skip }, () => withMaterials((folder) => {
    const png = 'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR4nGP4z8DwHwAFAAH/iZk9HQAAAABJRU5ErkJggg==';
    writeFileSync(join(folder, 'a.bin'), triangle);
    const old = (more) => ({ name: 'paint', extensions: { KHR_materials_pbrSpecularGlossiness: more } });
    const { left_out } = read(folder, 'a.gltf', gltf('a.bin', { extensionsRequired: ['KHR_materials_pbrSpecularGlossiness'],
        images: ['image/jpg', 'application/octet-stream', ''].map((type) => ({ uri: `data:${type};base64,${png}` })),
        textures: [{ source: 0 }, { source: 1 }, { source: 2 }], materials: [0, 1, 2].map((index) =>
            old({ diffuseFactor: [1, 0, 0, 1], diffuseTexture: { index } })) }));
    assert.deepEqual(left_out, ['Plantcast does not support the glTF extension KHR_materials_pbrSpecularGlossiness, which the file ' +
        'requires: diffuse colours are kept, specular colours are ignored']);
    const json = Buffer.from(JSON.stringify({ ...JSON.parse(gltf()), buffers: [{ byteLength: 42 }] }).padEnd(2000));
    const [first, bin, other] = [['JSON', json], ['BIN', triangle], ['ACME', Buffer.alloc(8)]];
    for (const [name, ...chunks] of [['after.glb', first, bin, other], ['between.glb', first, other, bin]])
        assert.equal(boxed(folder, name, glbOf(...chunks)).triangles, 1, name);
    assert.equal(boxed(folder, 'tail.glb', Buffer.concat([glbOf(first, bin), Buffer.alloc(12, 7)])).triangles, 1);
}));

// gltfpack writes two buffers: the compressed one, and an empty one for programs that cannot decompress.
const noPacker = spawnSync('gltfpack', ['-v']).error ? 'no gltfpack' : false;
test('glTF: meshopt data with a fallback buffer without a uri is read', { skip: skip || noPacker }, () => withMaterials((folder) => {
    writeFileSync(join(folder, 'a.bin'), triangle);
    writeFileSync(join(folder, 'a.gltf'), gltf('a.bin'));
    assert.equal(spawnSync('gltfpack', ['-i', join(folder, 'a.gltf'), '-o', join(folder, 'b.gltf'), '-cc', '-kn', '-noq'],
        { timeout: 60000 }).status, 0);
    const packed = JSON.parse(readFileSync(join(folder, 'b.gltf')));
    const standIn = packed.buffers.findIndex(({ extensions }) => extensions?.EXT_meshopt_compression?.fallback);
    assert.ok(standIn >= 0 && packed.bufferViews.some(({ extensions }) => extensions?.EXT_meshopt_compression), JSON.stringify(packed));
    delete packed.buffers[standIn].uri;
    const cases = { said: packed.buffers[standIn].extensions, unsaid: undefined };
    for (const [name, extensions] of Object.entries(cases)) {
        packed.buffers[standIn].extensions = extensions;
        const { triangles, size } = boxed(folder, `${name}.gltf`, JSON.stringify(packed));
        // Plantcast's Z axis points up, so the y axis of the glTF file becomes z
        assert.ok(triangles === 1 && near(size, [1, 0, 1]), JSON.stringify(size));
    }
}));

test('a signal ends the import, and no file is left behind', { skip }, () => withMaterials(async (folder) => {
    // Assimp never ends on this truncated file, so the import is still running when the signal arrives
    writeFileSync(join(folder, 'a.ply'), ply().slice(0, ply().length >> 1));
    const program = spawn(join(BIN, 'plantcast'), ['import', join(folder, 'a.ply'), '-o', join(folder, 'plant')]);
    let said = '';
    program.stderr.on('data', (bytes) => said += bytes);
    const ended = once(program, 'close');
    const isReader = (pid) => spawnSync('readlink', [`/proc/${pid}/exe`], { encoding: 'utf8' }).stdout.includes('plantcast-import-assimp');
    await until('the reader', () => family(program.pid).some(isReader));
    program.kill('SIGINT');
    const [code] = await ended;
    assert.equal(code, 1, said);
    assert.match(said, /a\.ply: interrupted/);
    assert.deepEqual(readdirSync(folder).sort(), ['a.ply', 'wedge.mtl']);
}));

test('OBJ: a material\'s colour is imported, also if the model is compressed', { skip }, () => withMaterials((folder) => {
    for (const [name, text] of [['a.obj', obj()], ['packed.obj.gz', gzipSync(obj())]]) {
        writeFileSync(join(folder, name), text);
        assert.equal(plantcast('import', join(folder, name), '-o', join(folder, `plant of ${name}`)).status, 0);
        const bytes = readFileSync(join(folder, `plant of ${name}`, name.replace(/\.obj.*/, '.glb')));
        const { materials } = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
        assert.deepEqual(materials[0].pbrMetallicRoughness.baseColorFactor, [1, 0, 0, 1], name);
    }
}));

test('textures are left out, and the report says so', { skip }, () => withMaterials((folder) => {
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

test('broken mesh files are read or refused in one line, and leave no files', { skip }, () => withMaterials((folder) => {
    let refused = 0;
    importBroken(folder, broken, () => ['--timeout', '3', '--memory', '2000'], ({ name, status, stdout, stderr }) => {
        assert.ok(status !== 0 || !name.startsWith('half'), 'a truncated file is refused');
        assert.doesNotMatch(stderr, /bad_alloc/);
        refused += status !== 0;
        if (status === 0 && /^nan|^far/.test(name))
            assert.match(stdout, /left out: \d+ triangles whose coordinates are infinite or not numbers/, name);
    });
    assert.ok(refused > sweep(20, 8), `only ${refused} files were refused`);
}));
