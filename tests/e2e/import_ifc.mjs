// SPDX-License-Identifier: GPL-3.0-or-later
// IFC, brought in by `plantcast import`: the spatial tree, names, properties, openings, and files that are broken.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { ifc } from './support/ifc_sample.mjs';
import { BIN, missing } from './support/tiny_plant.mjs';

const absent = missing();
const notBuilt = existsSync(join(BIN, 'plantcast-import-ifc/ifc.mjs')) ? false : 'built without web-ifc';
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : notBuilt;
const plantcast = (args, env = {}) =>
    spawnSync(join(BIN, 'plantcast'), args, { encoding: 'utf8', timeout: 120000, env: { ...process.env, ...env } });

async function inFolder(f) {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-ifc-'));
    try {
        await f(folder);
    } finally {
        rmSync(folder, { recursive: true });
    }
}

const near = (a, b) => a.every((v, k) => Math.abs(v - b[k]) < 0.002);

for (const schema of ['IFC2X3', 'IFC4', 'IFC4X3_ADD2'])
    test(`${schema}: tree, sizes, properties, a shared shape, an opening`, { skip }, () => inFolder((folder) => {
        writeFileSync(join(folder, 'house.ifc'), ifc(schema));
        const said = plantcast(['import', join(folder, 'house.ifc'), '-o', join(folder, 'plant')]);
        assert.equal(said.status, 0, said.stderr);
        assert.match(said.stdout, new RegExp(`${schema}: 3 elements with a shape, 1 storeys, 1 openings cut`));
        const glb = join(folder, 'plant/house.glb'), { list } = JSON.parse(plantcast(['nodes', glb, '--json']).stdout);
        assert.equal(list[6].path, 'house/Sample/Site/Pump house/Ground floor/P-101A');
        assert.equal(list[7].name, '펌프/P-101 B');
        const { properties } = list[7];
        assert.deepEqual([properties.GlobalId, properties.Storey, properties.Tag, properties.Description],
            ['0$PlantcastSample000031', 'Ground floor', '101', 'Feed pump']);
        assert.equal(properties.IfcClass, schema === 'IFC2X3' ? 'IfcFlowMovingDevice' : 'IfcPump');
        assert.deepEqual(properties.Pset_PumpCommon, { FlowRate: '12.5', Reference: 'NK 50' });
        assert.ok(near(list[7].size, [0.6, 0.4, 0.5]) && near(list[7].centre, [3, 2, 0.25]), JSON.stringify(list[7]));
        assert.ok(near(list[5].size, [4, 0.2, 3]) && list[5].triangles > 12, 'the wall has a hole');
        const bytes = readFileSync(glb), { nodes } = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
        assert.equal(nodes[6].mesh, nodes[7].mesh, 'pumps share a mesh');
        const plant = readFileSync(join(folder, 'plant/plant.yaml'), 'utf8');
        assert.match(plant, /id: "P-101A", description: "Feed pump", area: "Ground floor", model: "house\.glb", nodes: "P-101A"/);
        const check = spawnSync(join(BIN, 'plantcastd'), ['--check', join(folder, 'plant/plant.yaml')], { encoding: 'utf8' });
        assert.equal(check.status, 0, check.stderr);
    }));

test('broken files are read or refused in one line, and leave nothing behind', { skip }, () => inFolder((folder) => {
    const good = ifc(), wall = /#(\d+)=IFCWALL/.exec(good)[1], building = /#(\d+)=IFCBUILDING\(/.exec(good)[1];
    const storey = /#(\d+)=IFCBUILDINGSTOREY/.exec(good)[1], depth = 50000;
    const broken = {
        'empty.ifc': '', 'text.ifc': 'hello', 'head.ifc': good.slice(0, 120), 'half.ifc': good.slice(0, good.length >> 1),
        'tail.ifc': good.slice(good.length >> 1), 'schema.ifc': good.replace("'IFC4'", "'IFC9'"), 'zeros.ifc': Buffer.alloc(5000),
        'nan.ifc': good.replaceAll('2000.0', 'NAN'), 'huge.ifc': good.replaceAll('2000.0', '1.E300'),
        'lost.ifc': good.replace(`,(${wall},`, ',(#99999,').replace(`(${wall},`, '(#99999,'),
        'cyclic.ifc': good.replace(`,#${building},(#${storey}))`, `,#${building},(#${building}))`),
        'ring.ifc': good.replace(/#(\d+)=IFCLOCALPLACEMENT\(\$/, '#$1=IFCLOCALPLACEMENT(#$1'),
        'nested.ifc': good.replace("'Sample'", `${'('.repeat(depth)}'Sample'${')'.repeat(depth)}`),
        'noise.ifc': Buffer.from(Buffer.from(good).map((b, i) => i % 53 === 17 ? 255 - b : b)),
    };
    for (const [name, bytes] of Object.entries(broken)) {
        writeFileSync(join(folder, name), bytes);
        const before = readdirSync(folder).sort();
        const { status, stderr, stdout } = plantcast(['import', join(folder, name), '-o', join(folder, 'plant'), '--timeout', '30']);
        const told = status === 0 ? stdout.split('\n')[0].replace(/.*: /, 'read: ') : stderr.trim().replace(/.*?: .*?: /, '');
        console.log(`# ${name}: ${told}`);
        assert.ok(status !== 0 || !name.startsWith('half'), 'half a plant');
        if (status === 0) {
            rmSync(join(folder, 'plant'), { recursive: true });
        } else {
            assert.equal(status, 1, name);
            assert.equal(stderr.trimEnd().split('\n').length, 1, stderr);
            assert.ok(stderr.includes(name), stderr);
        }
        assert.deepEqual(readdirSync(folder).sort(), before);
    }
}));

test('without Node.js it is refused by name', { skip }, () => inFolder((folder) => {
    writeFileSync(join(folder, 'a.ifc'), ifc());
    const { status, stderr } = plantcast(['import', join(folder, 'a.ifc'), '-o', join(folder, 'plant')], { PATH: folder });
    assert.equal(status, 1);
    assert.match(stderr, /a\.ifc: IFC is not read: it is read by Node\.js with web-ifc: install nodejs/);
    assert.deepEqual(readdirSync(folder), ['a.ifc']);
    assert.match(plantcast(['import', '--formats'], { PATH: folder }).stdout, /^IFC +\.ifc +no: /m);
}));
