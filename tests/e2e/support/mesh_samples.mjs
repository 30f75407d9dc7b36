// SPDX-License-Identifier: GPL-3.0-or-later
// A wedge on a slab, 2 x 1 x 0.5 m with Z up, as text or bytes in each format that Assimp reads. Its vertices identify every
// axis.
const POINTS = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [0, 0, 0.5], [0, 1, 0.5]];
const FACES = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [3, 5, 2], [1, 2, 5], [1, 5, 4], [0, 4, 5], [0, 5, 3]];

const scaled = (by) => POINTS.map((p) => p.map((v) => v * by));
const yUp = (points) => points.map(([x, y, z]) => [x, z, -y]);

export const obj = (by = 1, name = 'Wedge') => `mtllib wedge.mtl\no ${name}\n` +
    `${yUp(scaled(by)).map((p) => `v ${p.join(' ')}`).join('\n')}\n` +
    `usemtl red\n${FACES.map((f) => `f ${f.map((i) => i + 1).join(' ')}`).join('\n')}\n`;
export const mtl = 'newmtl red\nKd 1 0 0\n';

const facets = (points) => FACES.map((f) => f.map((i) => points[i]));
export const stl = (by = 1) => `solid Wedge\n${facets(scaled(by)).map((corners) => 'facet normal 0 0 0\nouter loop\n' +
    `${corners.map((p) => `vertex ${p.join(' ')}`).join('\n')}\nendloop\nendfacet`).join('\n')}\nendsolid Wedge\n`;
export function stlBinary(by = 1) {
    const bytes = Buffer.alloc(84 + 50 * FACES.length);
    bytes.writeUInt32LE(FACES.length, 80);
    facets(scaled(by)).forEach((corners, f) => corners.flat().forEach((v, i) => bytes.writeFloatLE(v, 84 + 50 * f + 12 + 4 * i)));
    return bytes;
}

export const ply = (by = 1) => `ply\nformat ascii 1.0\nelement vertex ${POINTS.length}\n` +
    `property float x\nproperty float y\nproperty float z\n` +
    `element face ${FACES.length}\nproperty list uchar int vertex_indices\nend_header\n` +
    `${scaled(by).map((p) => p.join(' ')).join('\n')}\n${FACES.map((f) => `3 ${f.join(' ')}`).join('\n')}\n`;

// Returns the wedge as COLLADA with coordinates in units of `meter` metres, Z up.
export const dae = (meter = 0.001) => `<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="unit" meter="${meter}"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="Wedge"><mesh>
<source id="p"><float_array id="pa" count="${POINTS.length * 3}">${scaled(1 / meter).flat().join(' ')}</float_array>
<technique_common><accessor source="#pa" count="${POINTS.length}" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="${FACES.length}"><input semantic="VERTEX" source="#v" offset="0"/><p>${FACES.flat().join(' ')}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n1" name="Feed pump">
<node id="n2" name="쐐기"><instance_geometry url="#g"/></node></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>\n`;

// Returns the wedge as FBX with coordinates in units of `centimetres`, Z up.
export const fbx = (centimetres = 2.54) => `; FBX 7.4.0 project file
FBXHeaderExtension:  {
    FBXHeaderVersion: 1003
    FBXVersion: 7400
}
GlobalSettings:  {
    Version: 1000
    Properties70:  {
        P: "UpAxis", "int", "Integer", "",2
        P: "UpAxisSign", "int", "Integer", "",1
        P: "FrontAxis", "int", "Integer", "",1
        P: "FrontAxisSign", "int", "Integer", "",-1
        P: "CoordAxis", "int", "Integer", "",0
        P: "CoordAxisSign", "int", "Integer", "",1
        P: "UnitScaleFactor", "double", "Number", "",${centimetres}
    }
}
Objects:  {
    Geometry: 100, "Geometry::Wedge", "Mesh" {
        Vertices: *${POINTS.length * 3} {
            a: ${scaled(100 / centimetres).flat().join(',')}
        }
        PolygonVertexIndex: *${FACES.length * 3} {
            a: ${FACES.flatMap(([a, b, c]) => [a, b, -c - 1]).join(',')}
        }
        GeometryVersion: 124
    }
    Model: 200, "Model::Feed pump", "Mesh" {
        Version: 232
        Properties70:  {
            P: "Lcl Translation", "Lcl Translation", "", "A",0,0,0
        }
        Shading: T
        Culling: "CullingOff"
    }
}
Connections:  {
    C: "OO",200,0
    C: "OO",100,200
}
`;

export function threeDs(by = 1) {
    const chunk = (id, ...parts) => {
        const body = Buffer.concat(parts), head = Buffer.alloc(6);
        head.writeUInt16LE(id, 0);
        head.writeUInt32LE(6 + body.length, 2);
        return Buffer.concat([head, body]);
    };
    const shorts = (list) => Buffer.from(new Uint16Array(list).buffer), floats = (list) => Buffer.from(new Float32Array(list).buffer);
    const mesh = chunk(0x4100, chunk(0x4110, shorts([POINTS.length]), floats(scaled(by).flat())),
        chunk(0x4120, shorts([FACES.length, ...FACES.flatMap((f) => [...f, 7])])));
    const node = chunk(0xb002, chunk(0xb030, shorts([0])), chunk(0xb010, Buffer.from('Wedge\0'), shorts([0, 0, 0xffff])),
        chunk(0xb013, floats([0, 0, 0])));
    return chunk(0x4d4d, chunk(0x0002, Buffer.from([3, 0, 0, 0])), chunk(0x3d3d, chunk(0x4000, Buffer.from('Wedge\0'), mesh)),
        chunk(0xb000, node));
}
