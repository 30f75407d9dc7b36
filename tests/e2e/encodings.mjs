// SPDX-License-Identifier: GPL-3.0-or-later
// Names and units in the text encodings of other systems: each file format that `plantcast import` and `plantcast match` read,
// in each encoding. Prints a table of how many names and units were decoded correctly.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { DATA, inFolder } from './support/folders.mjs';
import { ifc } from './support/ifc_sample.mjs';
import { sweep, takes } from './support/sweep.mjs';
import { BIN, notBuilt, TinyPlant } from './support/tiny_plant.mjs';

const there = (name) => existsSync(join(BIN, name));
const skip = notBuilt();
const SAMPLES = join(process.env.PLANTCAST_OUT ?? 'build/release', 'tests/cad/step_samples');
const FOUND = join(DATA, 'found');
const plantcast = (...args) => spawnSync(join(BIN, 'plantcast'), args, { encoding: 'utf8', timeout: 120000 });

// By encoding: its name for iconv, two names and a unit. iconv encodes the texts, because node can write none of these
// encodings.
const ENCODINGS = {
    'UTF-8': ['UTF-8', '离心泵', '储罐 V-201', '℃'],
    GB18030: ['GB18030', '离心泵', '储罐 V-201', '℃'],
    'Shift-JIS': ['CP932', 'ポンプソ', '表示タンク V-201', '℃'],
    'EUC-KR': ['CP949', '급수펌프', '원료 탱크 V-201', '℃'],
    'Windows-1251': ['CP1251', 'Насос', 'Ёмкость V-201', '°C'],
    'Windows-1252': ['CP1252', 'Kühlwasserpumpe', 'Behälter V-201', '°C'],
    Big5: ['BIG5', '冷卻水泵', '儲槽 V-201', '℃'],
};
const encode = (text, name) => {
    const { status, stdout, stderr } = spawnSync('iconv', ['-f', 'UTF-8', '-t', name], { input: text });
    assert.equal(status, 0, String(stderr));
    return stdout;
};

const obj = (a, b) => `mtllib m.mtl\no ${a}\nusemtl ${b}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n` +
    `o ${b}\nv 3 0 0\nv 4 0 0\nv 3 1 0\nf 4 5 6\n`;
const dae = (a, b, encoding) => `<?xml version="1.0" encoding="${encoding}"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">${[a, b].map((name, i) =>
    `<node id="n${i}" name="${name}"><instance_geometry url="#g"/></node>`).join('')}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>`;
const stl = (a, b) => [a, b].map((name) => `solid ${name}\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n` +
    `endloop\nendfacet\nendsolid ${name}\n`).join('');
const fbx = (a, b) => `; FBX 7.4.0 project file
FBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n}
Definitions:  {\n\tVersion: 100\n\tCount: 2\n}
Objects:  {\n${[a, b].map((name, i) => `\tGeometry: 100${i}, "Geometry::g", "Mesh" {
\t\tVertices: *9 {\n\t\t\ta: 0,0,0,1,0,0,0,1,0\n\t\t}\n\t\tPolygonVertexIndex: *3 {\n\t\t\ta: 0,1,-3\n\t\t}\n\t\tGeometryVersion: 124\n\t}
\tModel: 200${i}, "Model::${name}", "Mesh" {\n\t\tVersion: 232\n\t}\n`).join('')}}
Connections:  {\n${[0, 1].map((i) => `\tC: "OO",200${i},0\n\tC: "OO",100${i},200${i}\n`).join('')}}\n`;

// Returns a CAD file that Open CASCADE wrote (step_samples); the tests replace its names. In IGES, each string is preceded by
// its length, which must be replaced as well.
let samples = null;
const sample = (name) => {
    if (!samples) {
        samples = mkdtempSync(join(tmpdir(), 'plantcast-samples-'));
        assert.equal(spawnSync(SAMPLES, [samples], { timeout: 60000 }).status, 0);
    }
    return readFileSync(join(samples, name), 'latin1');
};
const step = (a, b) => sample('skid_214.stp').replace(/[\x80-\xff]/g, 'x').replaceAll("'P-101A'", `'${a}'`)
    .replaceAll("'Plate:1'", `'${b}'`);
const iges = (a, b, iconv) => {
    const text = sample('tree.igs').split('\n');
    for (const [old, name] of [['Casing:1', a], ['Plate:1', b]]) {
        const bytes = encode(name, iconv), at = text.findIndex((line) => line.includes(`${old.length}H${old};`));
        const data = `406,1,${bytes.length}H${bytes.toString('latin1')};`;
        assert.ok(at >= 0 && data.length < 64);
        text[at] = data.padEnd(64) + text[at].slice(64);
    }
    return Buffer.from(text.join('\n'), 'latin1');
};

function rvm(a, b, iconv, said) {
    const word = (n) => { const out = Buffer.alloc(4); out.writeUInt32BE(n); return out; };
    const real = (x) => { const out = Buffer.alloc(4); out.writeFloatBE(x); return out; };
    const text = (bytes) => { const count = bytes.length + 1 + 3 >> 2; return Buffer.concat([word(count), bytes], 4 + 4 * count); };
    const chunks = [];
    let at = 0;
    const chunk = (id, ...parts) => {
        const body = Buffer.concat(parts);
        at += 24 + body.length;
        chunks.push(Buffer.from([...id].flatMap((c) => [0, 0, 0, c.charCodeAt(0)])), word(at), word(1), body);
    };
    const ascii = (s) => text(Buffer.from(s));
    chunk('HEAD', word(said ? 2 : 1), ...['a', 'b', 'c', 'd'].map(ascii), ...said ? [ascii(said)] : []);
    chunk('MODL', word(1), ascii('P'), ascii('M'));
    const group = (name, inner) => {
        chunk('CNTB', word(2), text(encode(name, iconv)), real(0), real(0), real(0), word(1));
        inner();
        chunk('CNTE', word(1));
    };
    const box = (x) => chunk('PRIM', word(1), word(2), ...[0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001, x, 0, 0].map(real),
        ...[0, 0, 0, 1, 1, 1].map(real), ...[1000, 1000, 1000].map(real));
    group('SITE', () => group(a, () => {
        box(0);
        group(b, () => box(5));
    }));
    return Buffer.concat([...chunks, Buffer.from([...'END:'].flatMap((c) => [0, 0, 0, c.charCodeAt(0)])), word(at + 24), word(1)]);
}

const FORMATS = {
    rvm: { make: (a, b, iconv) => rvm(a, b, iconv) },
    'rvm whose head says so': { ending: 'rvm', make: (a, b, iconv, name) => rvm(a, b, iconv, name) },
    stp: { needs: 'plantcast-import-occt', make: (a, b, iconv) => encode(step(a, b), iconv) },
    igs: { needs: 'plantcast-import-occt', make: iges },
    ifc: { needs: 'plantcast-import-ifc/ifc.mjs', make: (a, b, iconv) =>
        encode(ifc('IFC4', ['pump 1', 'pump 2']).replace("'pump 1'", `'${a}'`).replace("'pump 2'", `'${b}'`), iconv) },
    obj: { needs: 'plantcast-import-assimp', make: (a, b, iconv) => encode(obj(a, b), iconv) },
    dae: { needs: 'plantcast-import-assimp', make: (a, b, iconv) => encode(dae(a, b, iconv), iconv) },
    // replaces blanks in the name, because a name in an STL file ends at the first blank
    stl: { needs: 'plantcast-import-assimp', make: (a, b, iconv) => encode(stl(a, b.replaceAll(' ', '-')), iconv) },
    fbx: { needs: 'plantcast-import-assimp', make: (a, b, iconv) => encode(fbx(a, b), iconv) },
};

for (const [format, { needs, ending = format, make }] of Object.entries(FORMATS))
    test(`names in ${format} files are decoded in ${format === 'ifc' ? sweep('each encoding', 'some encodings') : 'each encoding'}`,
        { skip: skip || (needs && !there(needs) ? `not built: ${needs}` : needs?.endsWith('occt') &&
        !existsSync(SAMPLES) ? 'not built: step_samples' : false) }, (t) => inFolder((folder) => {
        let right = 0;
        const wrong = [];
        // Each IFC file takes half a second of processor time. TextDecoder decodes these files, so a few encodings suffice, if it knows
        // the names of all.
        Object.keys(ENCODINGS).forEach((name) => new TextDecoder(name));
        const tried = Object.entries(ENCODINGS).filter((_, i) => format !== 'ifc' || takes(1, i, 3));
        for (const [name, [iconv, a, b]] of tried) {
            const file = join(folder, `m.${ending}`), plant = join(folder, name);
            writeFileSync(file, make(a, b, iconv, name));
            const said = plantcast('import', file, '-o', plant);
            assert.equal(said.status, 0, `${name}: ${said.stderr}`);
            const { list } = JSON.parse(plantcast('nodes', join(plant, 'm.glb'), '--json').stdout), names = list.map((node) => node.name);
            const good = names.includes(a) && (names.includes(b) || names.includes(b.replaceAll(' ', '-'))) &&
                (name === 'UTF-8' ? !said.stdout.includes('read as') : said.stdout.includes(`names: read as ${name}`));
            right += good;
            if (!good)
                wrong.push(`${name}: ${names.join(' | ')}\n${said.stdout}`);
        }
        t.diagnostic(`${right} of ${tried.length} encodings`);
        assert.deepEqual(wrong, []);
    }));

test('--encoding sets the encoding of names that do not reveal it', { skip }, () => inFolder((folder) => {
    const file = join(folder, 'm.rvm');
    writeFileSync(file, rvm('Насос', 'Ёмкость', 'KOI8-R'));
    for (const [asked, name] of [['koi8-r', 'Насос'], ['Windows-1251', 'оБУПУ']]) {
        const said = plantcast('import', file, '--encoding', asked, '-o', join(folder, asked));
        assert.equal(said.status, 0, said.stderr);
        const { list } = JSON.parse(plantcast('nodes', join(folder, asked, 'm.glb'), '--json').stdout);
        assert.ok(list.some((node) => node.name === name), list.map((node) => node.name).join(' | '));
    }
    const unknown = plantcast('import', file, '--encoding', 'klingon', '-o', join(folder, 'none'));
    assert.equal(unknown.status, 2);
    assert.match(unknown.stderr, /--encoding klingon: unknown encoding: iconv --list/);
}));

test('a tag list\'s names, units and groups are decoded in each encoding',
    { skip: skip || (there('plantcast-import-assimp') ? false : 'built without Assimp') },
    (t) => inFolder((folder) => {
        let right = 0;
        for (const [name, [iconv, a, b, unit]] of Object.entries(ENCODINGS)) {
            const plant = join(folder, name), list = join(folder, 'tags.csv');
            mkdirSync(plant);
            writeFileSync(join(folder, 'm.obj'), obj('P-101', 'V-201'));
            writeFileSync(list, encode(`Tag Name,Address,Eng Units,Description\nTI-101,400001,${unit},${a} P-101\nPI-201,400003,bar,${b}\n`,
                iconv));
            assert.equal(plantcast('import', join(folder, 'm.obj'), '-o', plant).status, 0);
            const said = plantcast('match', plant, list, '--modbus', '127.0.0.1');
            assert.equal(said.status, 0, said.stderr);
            assert.match(said.stdout, new RegExp(`a list with a header, ${name}, `));
            const tags = readFileSync(join(plant, 'tags.csv'), 'utf8');
            assert.ok(tags.includes(`${a} P-101`) && tags.includes(b), `${name}: ${tags}`);
            assert.match(readFileSync(join(plant, 'plant.yaml'), 'utf8'), /quantity: "Temperature", unit: "°C"/);
            right++;
        }
        t.diagnostic(`${right} of ${Object.keys(ENCODINGS).length} encodings`);
        const forced = plantcast('match', join(folder, 'Big5'), join(folder, 'tags.csv'), '--encoding', 'latin1', '--dry-run');
        assert.match(forced.stdout, /a list with a header, Windows-1252/);
    }));

test('history import finds the tags of column names in each encoding', { skip }, async (t) => {
    const plant = await TinyPlant.create(), list = join(plant.folder, 'tags.csv'), tags = readFileSync(list, 'utf8');
    t.after(() => plant.destroy());
    for (const [name, [iconv, a]] of Object.entries({ ...ENCODINGS, 'UTF-16LE': ['UTF-16', '급수펌프'] })) {
        const series = join(plant.folder, `${iconv}.csv`);
        writeFileSync(list, tags.replace('TI-1', a));
        writeFileSync(series, encode(`Time,${a}\n2026-11-20T10:00:00Z,21.5\n2026-11-20T10:00:10Z,22.5\n`, iconv));
        const said = plantcast('history', 'import', plant.file, series, '--folder', join(plant.folder, iconv));
        assert.equal(said.status, 0, `${name}: ${said.stderr}`);
        assert.match(said.stdout, /: 2 samples of 1 tag /);
        assert.match(said.stdout, name === 'UTF-8' ? /^(?!.*Encoding)/s : new RegExp(`^Encoding: read as ${name}`, 'm'));
    }
    const forced = plantcast('history', 'import', plant.file, join(plant.folder, 'BIG5.csv'), '--encoding', 'latin1');
    assert.match(forced.stderr, /BIG5\.csv:1:6: /);
    assert.equal(plantcast('history', 'import', plant.file, list, '--encoding', 'klingon').status, 2);
});

test('names in real GB18030, Shift JIS and Windows-1251 files are decoded',
    { skip: skip || (existsSync(FOUND) ? false : 'no ../shared/data/found') }, () => inFolder((folder) => {
    for (const [file, ...names] of [['step_names/gb18030.stp', '泵组', '泵', '电机', '储罐V-201'],
        ['step_names/coded.stp', 'Petit étui'],
        ['step_names/sjis.stp', '装置', 'ポンプP-101', '表示器', 'モータ'],
        ['models/cn_gbk.rvm', '/装置', '/一区', '/泵-101', '/储罐-201'],
        ['models/ru1251.rvm', '/Площадка', '/Зона 1', '/Насос-101', '/Ёмкость-201']]) {
        const said = plantcast('nodes', join(FOUND, file), '--json');
        assert.equal(said.status, 0, said.stderr);
        const found = JSON.parse(said.stdout).list;
        assert.deepEqual(names.filter((name) => !found.some((node) => node.name === name)), [], file);
        if (file.endsWith('ru1251.rvm'))
            assert.ok(found.some(({ properties }) => properties?.Description === 'Насос первый подъём'));
    }
    assert.ok(folder);
}));

test.after(() => samples && rmSync(samples, { recursive: true }));
