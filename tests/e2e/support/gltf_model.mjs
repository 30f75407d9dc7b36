// SPDX-License-Identifier: GPL-3.0-or-later
// Makes glTF models with one mesh, whose vertex data is contained in the model as a data URI.

// Returns a glTF model as an object. corners: coordinates x, y, z of all vertices; nodes: the model's nodes; indices: three
// vertices per triangle, or null if each three consecutive vertices are a triangle; normals: x, y, z per vertex, or null;
// scene: indices of the root nodes.
export function gltfModel(corners, nodes, { indices = null, normals = null, scene = [0] } = {}) {
    const floats = [corners, normals].filter(Boolean).map((list) => new Float32Array(list));
    const parts = [...floats, ...(indices ? [new Uint16Array(indices)] : [])];
    const bytes = Buffer.concat(parts.map((part) => Buffer.from(part.buffer)));
    const extreme = (of) => [0, 1, 2].map((axis) => floats[0].reduce((far, v, i) => (i % 3 === axis ? of(far, v) : far), of()));
    let end = 0;
    return {
        asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: scene }], nodes,
        meshes: [{ primitives: [{ attributes: { POSITION: 0, ...(normals && { NORMAL: 1 }) },
            ...(indices && { indices: floats.length }) }] }],
        accessors: [
            { bufferView: 0, componentType: 5126, count: corners.length / 3, type: 'VEC3', min: extreme(Math.min), max: extreme(Math.max) },
            ...(normals ? [{ bufferView: 1, componentType: 5126, count: corners.length / 3, type: 'VEC3' }] : []),
            ...(indices ? [{ bufferView: floats.length, componentType: 5123, count: indices.length, type: 'SCALAR' }] : []),
        ],
        bufferViews: parts.map(({ byteLength }) => ({ buffer: 0, byteOffset: (end += byteLength) - byteLength, byteLength })),
        buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }],
    };
}

// Returns a model whose mesh is a box, `size` wide, deep and high, with its lowest corner at the origin.
export function boxModel(nodes, { size = 1, scene } = {}) {
    const corners = [...Array(8).keys()].flatMap((i) => [i & 1, i >> 1 & 1, i >> 2].map((bit) => bit * size));
    const indices = [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5];
    return gltfModel(corners, nodes, { indices, scene });
}

// Returns the file of a model of boxes with these names in rows, below a node `plant`.
export const boxesFile = (names, size = 1, columns = 8) => JSON.stringify(boxModel([{ name: 'plant', children: names.map((_, i) => i + 1) },
    ...names.map((name, i) => ({ name, mesh: 0, translation: [2 * size * (i % columns), 0, 2 * size * Math.floor(i / columns)] }))],
{ size }));
