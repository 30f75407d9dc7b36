// SPDX-License-Identifier: GPL-3.0-or-later
// `plantcast import` of real CAD exports in RVM: names, boxes, areas and attributes are compared with the GLB files that
// another converter made from the same exports.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { DATA, inFolder } from './support/folders.mjs';
import { ifc } from './support/ifc_sample.mjs';
import { dae, stl } from './support/mesh_samples.mjs';
import { cone } from './support/step_parts.mjs';
import { BIN, missing } from './support/tiny_plant.mjs';
import { zip } from './support/zip.mjs';

const absent = missing();
const notBuilt = absent.length > 0 ? `not built: ${absent.join(', ')}` : false;
const skip = notBuilt || (existsSync(join(DATA, 'cad')) ? false : 'no ../shared/data/cad');
const run = (program, ...args) => spawnSync(join(BIN, program), args, { encoding: 'utf8', timeout: 120000 });

function readGlb(path) {
    const bytes = readFileSync(path), length = bytes.readUInt32LE(12);
    const json = JSON.parse(bytes.subarray(20, 20 + length)), buffer = bytes.subarray(28 + length);
    const numbers = (index) => {
        const { bufferView, byteOffset = 0, componentType, count, type } = json.accessors[index];
        const at = (json.bufferViews[bufferView].byteOffset ?? 0) + byteOffset, each = { SCALAR: 1, VEC3: 3 }[type];
        const read = { 5126: (i) => buffer.readFloatLE(at + 4 * i), 5125: (i) => buffer.readUInt32LE(at + 4 * i),
            5123: (i) => buffer.readUInt16LE(at + 2 * i) }[componentType];
        return Array.from({ length: count * each }, (_, i) => read(i));
    };
    return { json, numbers };
}

const rotated = ([x, y, z, w], [a, b, c]) => {
    const t = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
    return [a + w * t[0] + y * t[2] - z * t[1], b + w * t[1] + z * t[0] - x * t[2], c + w * t[2] + x * t[1] - y * t[0]];
};

// Returns the bounding box and area of each node that has triangles, by name.
function shapes(path) {
    const { json, numbers } = readGlb(path), found = new Map();
    const walk = (index, place) => {
        const { name = '', mesh, children = [], translation: [x, y, z] = [0, 0, 0], rotation, scale = [1, 1, 1],
            matrix: m } = json.nodes[index];
        const here = (p) => {
            if (m)
                return place([0, 1, 2].map((k) => m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2] + m[12 + k]));
            const scaled = p.map((v, k) => v * scale[k]), [a, b, c] = rotation ? rotated(rotation, scaled) : scaled;
            return place([a + x, b + y, c + z]);
        };
        for (const { attributes, indices, mode = 4 } of mesh === undefined ? [] : json.meshes[mesh].primitives) {
            if (mode !== 4)
                continue;
            const flat = numbers(attributes.POSITION), corners = numbers(indices), points = [];
            for (let i = 0; i < flat.length; i += 3)
                points.push(here(flat.slice(i, i + 3)));
            const shape = found.get(name) ?? { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity], area: 0 };
            for (let i = 0; i < corners.length; i += 3) {
                const [p, q, r] = corners.slice(i, i + 3).map((corner) => points[corner]);
                const u = q.map((v, k) => v - p[k]), w = r.map((v, k) => v - p[k]);
                shape.area += Math.hypot(u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]) / 2;
                for (const point of [p, q, r])
                    for (let k = 0; k < 3; k++) {
                        shape.low[k] = Math.min(shape.low[k], point[k]);
                        shape.high[k] = Math.max(shape.high[k], point[k]);
                    }
            }
            found.set(name, shape);
        }
        for (const child of children)
            walk(child, here);
    };
    for (const root of json.scenes[0].nodes)
        walk(root, (p) => p);
    return found;
}

const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];

// The reference files of the other converter: it used the chord tolerances chordMm and moved the models to the origin.
for (const { file, as, chordMm, nodes, counted, assets } of [
    { file: 'plm-sample', as: 'plm_plant_hierarchy', chordMm: 2, nodes: 315, counted: '316', assets: 19 },
    { file: 'huldra_WD1-PSUP', as: 'huldra_wd1_psup', chordMm: 5, nodes: 4084, counted: '4,085', assets: 321 },
])
    test(`${file}.rvm: names, boxes, surface areas and attributes equal the reference`, { skip }, () => inFolder((folder) => {
        const out = join(folder, 'plant'), model = join(DATA, `cad/${file}.rvm`);
        const said = run('plantcast', 'import', model, '-o', out, '--chord', String(chordMm));
        assert.equal(said.status, 0, said.stderr);
        assert.match(said.stdout, new RegExp(`: ${counted} nodes, 0 unnamed`));
        assert.match(said.stdout, new RegExp(`: ${assets} assets`));
        const ours = shapes(join(out, `${file}.glb`)), theirs = shapes(join(DATA, `models/${as}.glb`));
        const common = [...theirs.keys()].filter((name) => ours.has(name));
        assert.deepEqual([...theirs.keys()].filter((name) => name && !ours.has(name)), [], 'names that only the other program has');
        const shift = [0, 1, 2].map((k) => median(common.map((name) => theirs.get(name).low[k] - ours.get(name).low[k])));
        let areas = [0, 0], off = 0;
        for (const name of common) {
            const [a, b] = [ours.get(name), theirs.get(name)];
            areas = [areas[0] + a.area, areas[1] + b.area];
            const size = Math.max(...b.high.map((v, k) => v - b.low[k])), bound = Math.max(0.005 * size, chordMm / 1000);
            off += [0, 1, 2].some((k) => ['low', 'high'].some((end) => Math.abs(a[end][k] + shift[k] - b[end][k]) > bound));
        }
        console.log(`# ${common.length} shapes, ${off} boxes differ; area ${areas[0].toFixed(2)} m2 for ${areas[1].toFixed(2)}`);
        assert.equal(off, 0, 'number of boxes that differ');
        // Plantcast leaves out faces that another primitive covers. The other converter leaves out fewer: it keeps covered
        // faces of another size, and all faces of ducts. The import with --keep-covered finds the nodes that lost no face.
        // Only the areas of such nodes can be compared.
        const all = run('plantcast', 'import', model, '-o', join(folder, 'all'), '--chord', String(chordMm), '--keep-covered');
        assert.equal(all.status, 0, all.stderr);
        const kept = shapes(join(folder, `all/${file}.glb`));
        const total = (of, names) => names.reduce((sum, name) => sum + of.get(name).area, 0);
        const whole = common.filter((name) => Math.abs(kept.get(name).area - ours.get(name).area) < 1e-6 * ours.get(name).area);
        const ratio = total(ours, whole) / total(theirs, whole), named = [...ours.keys()];
        const covered = Number(/left out: \d+ faces, ([\d.]+) m2/.exec(said.stdout)[1]), measured = total(kept, named) - total(ours, named);
        console.log(`# ${whole.length} shapes that are whole: area ${((ratio - 1) * 100).toFixed(3)} %; ` +
            `${covered} m2 said to be covered, ${measured.toFixed(2)} measured; all faces ${total(kept, common).toFixed(2)} m2`);
        assert.ok(Math.abs(ratio - 1) < 0.005, 'ratio of the surface areas');
        assert.ok(areas[0] <= areas[1] && areas[1] <= total(kept, common), 'the other program leaves out some of the surface');
        assert.ok(Math.abs(covered - measured) < 0.05 + 0.01 * measured, 'the reported area of left-out surfaces equals the difference');
        const { json } = readGlb(join(out, `${file}.glb`));
        assert.ok(json.nodes.filter(({ extras }) => extras?.Type).length >= nodes - 1, 'nodes with attributes');
        const check = run('plantcastd', '--check', join(out, 'plant.yaml'));
        assert.equal(check.status, 0, check.stderr);
        const again = run('plantcast', 'import', model, '-o', out, '--chord', String(chordMm));
        assert.match(again.stdout, /plant\.yaml: unchanged/);
    }));

test('a real export with broken attributes or numbers gets one error line, and leaves no files', { skip }, () => inFolder((folder) => {
    const good = readFileSync(join(DATA, 'cad/plm-sample.rvm')), text = readFileSync(join(DATA, 'cad/plm-sample.att'));
    const head = text.subarray(0, text.indexOf('NEW')).toString('latin1'), id = Buffer.from('\0\0\0P\0\0\0R\0\0\0I\0\0\0M', 'latin1');
    const notFinite = Buffer.from(good), model = join(folder, 'a.rvm');
    for (let at = good.indexOf(id); at >= 0; at = good.indexOf(id, at + 4))
        notFinite.writeFloatBE(NaN, at + 32); // replaces the first number of each primitive's transformation matrix by NaN
    for (const [bytes, attributes, why] of [
        [good, text.subarray(0, text.length >> 1), /a\.att: line \d+: the attribute file ends before the END of \d+ elements/],
        [good, `${head}${'NEW A\r\n'.repeat(100000)}`, /a\.att: line \d+ of the attribute file: elements are nested more than \d+ deep/],
        [good, `${head}${'END\r\n'.repeat(1000)}`, /a\.att: line \d+ of the attribute file: END without an element \(NEW\)/],
        [good, Buffer.from(text.map((byte, i) => (i % 53 === 17 ? 255 - byte : byte))), /a\.att: line \d+( of the attribute file)?: /],
        [good, '', /a\.att: .*no elements/], [good, 'hello', /a\.att: .*no elements/], [good, Buffer.alloc(5000), /a\.att: .*no elements/],
        [good.subarray(0, good.length >> 1), text, /byte \d+: the RVM file is truncated: /],
        [notFinite, text, /none of the model's \d+ primitives can be shown: .*infinite or invalid/],
    ]) {
        writeFileSync(model, bytes);
        writeFileSync(join(folder, 'a.att'), attributes);
        const said = run('plantcast', 'import', model, '-o', join(folder, 'plant'));
        assert.equal(said.status, 1, String(why));
        assert.match(said.stderr, why);
        assert.equal(said.stderr.trim().split('\n').length, 1);
        assert.deepEqual(readdirSync(folder).sort(), ['a.att', 'a.rvm']);
    }
}));

const IFC_XML = '<?xml version="1.0"?><ifc:ifcXML xmlns:ifc="http://www.buildingsmart-tech.org/ifcXML/IFC4/final"/>';
const UNREAD = /IFC in XML \(ifcXML\) is not supported: export the model as IFC in STEP text \(\.ifc\)/;
const scenes = { 'manifest.xml': '<dae_root>models/pump.dae#s</dae_root>', 'models/base.dae': dae(1), 'models/pump.dae': dae(2) };
const stored = zip({ 'a.ifc': ifc() }, { packed: false }).toString('latin1');
const spaces = Buffer.alloc(200 << 20, ' ');
const PACKED = [ // file name, bytes, what is printed
    ['zip.ifczip', zip({ 'inner/house.ifc': ifc() }), /3 elements with a shape, 0 lost/],
    ['gzip.ifczip', gzipSync(ifc()), /3 elements with a shape, 0 lost/], ['a.ifc.gz', gzipSync(ifc()), /3 elements with a shape, 0 lost/],
    ['zip_inside.ifc', zip({ 'house.IFC': ifc() }), /3 elements with a shape, 0 lost/],
    ['xml.ifczip', zip({ 'house.ifcXML': IFC_XML }), UNREAD],
    ['a.ifcxml', IFC_XML, UNREAD], ['b.ifcXML', gzipSync(IFC_XML), UNREAD], ['xml.ifc', IFC_XML, UNREAD],
    ['text.ifczip', zip({ 'a.txt': 'hello' }), /the archive contains no model/],
    ['not.ifczip', ifc(), /the file is not a ZIP or gzip archive/],
    ['changed.ifczip', Buffer.from(stored.replace('2000.0', '3000.0'), 'latin1'),
        /a wrong checksum/],
    ['cut.ifczip', gzipSync(ifc()).subarray(0, -20), /truncated/],
    ['locked.ifczip', zip({ 'a.ifc': ifc() }, { flags: 1 }), /the archive is encrypted: create the archive again without a password/],
    ['gzip.stpz', gzipSync(cone()), /1 parts in 1 places/], ['zip.stpz', zip({ 'a/cone.step': cone() }), /1 parts in 1 places/],
    ['a.stp.gz', gzipSync(cone()), /1 parts in 1 places/], ['B.STEP.GZ', gzipSync(cone()), /1 parts in 1 places/],
    ['gzip_inside.stp', gzipSync(cone()), /1 parts in 1 places/],
    ['a.zae', zip({ 'scene.dae': dae(1) }), /2\.0 x 1\.0 x 0\.5 m/],
    ['two.zae', zip(scenes), /left out: 1 other model in the archive; only models\/pump\.dae was imported/],
    ['a.stl.gz', gzipSync(stl()), /2\.0 x 1\.0 x 0\.5 m/], ['a.gltf.gz', gzipSync('{}'), /unknown file ending/],
    ...[['ifczip', 'a.ifc'], ['stpz', 'a.stp'], ['zae', 'a.dae']].map(([ending, inner]) =>
        [`bomb.${ending}`, zip({ [inner]: spaces }), /unpacks to more than 200 times its size/]),
    ['bomb.stp.gz', gzipSync(spaces), /unpacks to more than 200 times its size/],
];
const readers = ['plantcast-import-ifc/ifc.mjs', 'plantcast-import-occt', 'plantcast-import-assimp']
    .filter((name) => !existsSync(join(BIN, name)));
const unpackable = { skip: notBuilt || readers.join(', ') || false };
test('compressed models are unpacked, or refused in one line', unpackable, () => inFolder((folder) => {
    for (const [name, bytes, wanted] of PACKED) {
        const model = join(folder, name), plant = join(folder, 'plant');
        writeFileSync(model, bytes);
        const { status, stdout, stderr } = run('plantcast', 'import', model, '-o', plant);
        assert.match(`${stdout}${stderr}`, wanted, name);
        const written = existsSync(join(plant, `${name.replace(/\..*/, '')}.glb`));
        assert.ok(status === 0 ? written : stderr.trim().split('\n').length === 1, stderr);
        rmSync(plant, { recursive: true, force: true });
        rmSync(model);
    }
    console.log(`# ${PACKED.length} kinds of compressed models`);
}));

test('an unreadable model gets one error line, and leaves no files', { skip: notBuilt }, () => inFolder((folder) => {
    const out = join(folder, 'plant');
    const cases = [['empty.rvm', '', 'byte 0: not an RVM file'], ['text.rvm', 'ISO-10303-21;', 'byte 0: not an RVM file'],
        ['short.rvm', Buffer.from('\0\0\0H\0\0\0E\0\0\0A\0\0\0D\0\0\x01\0\0\0\0\x01', 'latin1'),
            'the RVM file is truncated: chunk HEAD should extend to byte 256']];
    const gltf = (rest) => JSON.stringify({ asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], ...rest });
    const corner = (bytes, count) => gltf({ nodes: [{ mesh: 0 }], meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
        accessors: [{ componentType: 5126, count, type: 'VEC3', bufferView: 0, min: [0, 0, 0], max: [1, 1, 1] }],
        bufferViews: [{ buffer: 0, byteLength: bytes.length }],
        buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }] });
    const notFinite = Buffer.from(new Float32Array([0, 0, 0, NaN, 0, 0, 0, Infinity, 0]).buffer);
    cases.push(['empty.gltf', '', 'line 1'], ['text.glb', 'hello', 'line 1'],
        ['half.glb', Buffer.from('glTF\x02\0\0\0\0\x01\0\0', 'latin1'), 'GLB'],
        ['cycle.gltf', gltf({ nodes: [{ children: [1] }, { children: [0] }] }), 'node 0 is part of a cycle or has two parents'],
        ['deep.gltf', gltf({ nodes: Array.from({ length: 100000 }, (_, i) => (i < 99999 ? { children: [i + 1] } : {})) }), 'nested deeper'],
        ['nested.gltf', `{"asset":${'['.repeat(200000)}${']'.repeat(200000)}}`, 'nested deeper'],
        ['huge.gltf', corner(Buffer.alloc(36), 4000000000), '4000000000 elements do not fit'],
        ['nan.gltf', corner(notFinite, 3), 'element 1 is infinite or not a number'],
        ['wire.gltf', corner(Buffer.alloc(36), 3).replace('"POSITION":0}', '"POSITION":0},"mode":3'), 'has no triangles'],
        ['out.gltf', gltf({ scenes: [{ nodes: [] }], buffers: [{ byteLength: 4, uri: '../../../etc/passwd' }] }),
            "the file is outside the model's folder"]);
    for (const [name, bytes, why] of cases) {
        writeFileSync(join(folder, name), bytes);
        const said = run('plantcast', 'import', join(folder, name), '-o', out);
        assert.equal(said.status, 1);
        assert.equal(said.stderr.trim().split('\n').length, 1);
        assert.ok(said.stderr.includes(join(folder, name)) && said.stderr.includes(why), said.stderr);
    }
    const twice = run('plantcast', 'import', join(folder, 'empty.rvm'), join(folder, '../empty.rvm'), '-o', out);
    assert.match(twice.stderr, /would both be written as empty\.glb: rename one of these files/);
    assert.deepEqual(readdirSync(folder).sort(), cases.map(([name]) => name).sort());
    assert.equal(run('plantcast', 'import', '-o', out).status, 2);
}));

// The degenerate triangle LINE (three corners on a line) and the flat triangle FLAT have no area. The import must not make
// assets of them, because plantcast-prep refuses an asset without area.
test('nodes without surface area do not become assets', { skip: notBuilt }, () => inFolder((folder) => {
    const out = join(folder, 'plant'), line = [0, 0, 0, 1, 0, 0, 3, 0, 0], triangle = [0, 0, 0, 1, 0, 0, 0, 1, 0];
    const bytes = Buffer.from(new Float32Array([...line, ...triangle]).buffer);
    const mesh = (view) => ({ primitives: [{ attributes: { POSITION: view } }] });
    const model = (scale) => JSON.stringify({ asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0, 1, 2, 3] }],
        nodes: [{ name: 'LINE', mesh: 0 }, { name: 'SHEET', mesh: 1, scale }, { name: 'FLAT', mesh: 1, scale: [1, 0, 1] },
            { name: 'BOTH', mesh: 0, children: [4] }, { name: 'INNER', mesh: 1, scale }],
        meshes: [mesh(0), mesh(1)], accessors: [0, 1].map((bufferView) => ({ componentType: 5126, count: 3, type: 'VEC3', bufferView })),
        bufferViews: [0, 36].map((byteOffset) => ({ buffer: 0, byteOffset, byteLength: 36 })),
        buffers: [{ byteLength: 72, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }] });
    writeFileSync(join(folder, 'a.gltf'), model([1, 1, 1]));
    // a folder without a plant may have files of the user: the import keeps them
    mkdirSync(out);
    writeFileSync(join(out, 'a.glb'), 'mine');
    writeFileSync(join(out, 'a.glb.1'), 'older');
    const { status, stdout, stderr } = run('plantcast', 'import', join(folder, 'a.gltf'), '-o', out);
    assert.equal(status, 0, stderr);
    for (const node of ['#0 LINE', '#2 FLAT', '#3 BOTH'])
        assert.match(stdout, new RegExp(`lost: ${node} \\(node\\): none of the node's triangles has an area`));
    assert.match(stdout, /a\.glb: the previous file is kept as .*a\.glb\.2$/m);
    assert.deepEqual(['a.glb.1', 'a.glb.2'].map((name) => readFileSync(join(out, name), 'utf8')), ['older', 'mine']);
    const ids = [...readFileSync(join(out, 'plant.yaml'), 'utf8').matchAll(/\{ id: "(\w+)", model:/g)].map(([, id]) => id);
    assert.deepEqual(ids, ['SHEET', 'BOTH']);
    const prepared = run('plantcast-prep', join(out, 'plant.yaml'));
    assert.equal(prepared.status, 0, prepared.stderr);
    writeFileSync(join(folder, 'b.gltf'), model([0, 1, 1]));
    assert.match(run('plantcast', 'import', join(folder, 'b.gltf'), '-o', out).stderr, /the model has no triangles with an area/);
}));
