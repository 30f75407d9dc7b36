// SPDX-License-Identifier: GPL-3.0-or-later
// Sums up the triangles of a GLB file, or of its nodes with a given name. Returns { volume (m3), area (m2), size (m: x, y, z
// with Z up) }.
import { readFileSync } from 'node:fs';
import { triangleSums } from './triangle_sums.mjs';

const HEAD = 20, CHUNK_HEAD = 8, TYPES = { 5126: Float32Array, 5125: Uint32Array, 5123: Uint16Array };
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const product = (a, b) => Array.from({ length: 16 }, (_, i) =>
    [0, 1, 2, 3].reduce((sum, k) => sum + a[4 * k + i % 4] * b[i - i % 4 + k], 0));

export function volumeOf(path, wanted = null) {
    const file = readFileSync(path), length = file.readUInt32LE(12), json = JSON.parse(file.subarray(HEAD, HEAD + length));
    const binary = file.subarray(HEAD + length + CHUNK_HEAD);
    const read = (number) => {
        const { bufferView, byteOffset = 0, count, componentType, type } = json.accessors[number], Type = TYPES[componentType];
        const from = (json.bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
        const bytes = count * (type === 'VEC3' ? 3 : 1) * Type.BYTES_PER_ELEMENT;
        return new Type(Uint8Array.from(binary.subarray(from, from + bytes)).buffer);
    };
    const sums = triangleSums();
    const walk = (number, above, isWithin) => {
        const { matrix = IDENTITY, mesh, name, children = [] } = json.nodes[number], place = product(above, matrix);
        const isWanted = isWithin || name === wanted;
        for (const { attributes, indices } of isWanted && json.meshes[mesh]?.primitives || []) {
            const points = read(attributes.POSITION), corners = read(indices);
            const at = (k) => [0, 1, 2].map((row) => place[row] * points[3 * k] + place[4 + row] * points[3 * k + 1] +
                place[8 + row] * points[3 * k + 2] + place[12 + row]);
            for (let i = 0; i + 2 < corners.length; i += 3)
                sums.add(...[0, 1, 2].map((k) => at(corners[i + k])));
        }
        children.forEach((child) => walk(child, place, isWanted));
    };
    json.scenes[json.scene ?? 0].nodes.forEach((root) => walk(root, IDENTITY, wanted === null));
    const { volume, area, extent: [x, y, z] } = sums.result();
    return { volume, area, size: [x, z, y] };
}
