// SPDX-License-Identifier: GPL-3.0-or-later
// Builds a GLB file. Matrices are arrays of 16 numbers, column-major.
const FLOAT = 5126, UINT = 5125, VERTICES = 34962, INDICES = 34963, TRIANGLES = 4; // constants of glTF
const GLB_HEAD = 12, CHUNK_HEAD = 8, MAX_BYTES = 0xffffffff;

export function multiplied(a, b) {
    const out = new Array(16).fill(0);
    for (let column = 0; column < 4; column++)
        for (let row = 0; row < 4; row++)
            for (let k = 0; k < 4; k++)
                out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    return out;
}

function inverted(m) { // Returns the inverse of an affine matrix, or null if it is not invertible.
    const [a, b, c, , d, e, f, , g, h, i] = m;
    const determinant = a * (e * i - f * h) - d * (b * i - c * h) + g * (b * f - c * e);
    if (!(Math.abs(determinant) > 1e-300))
        return null;
    const r = [[e * i - f * h, c * h - b * i, b * f - c * e], [f * g - d * i, a * i - c * g, c * d - a * f],
        [d * h - e * g, b * g - a * h, a * e - b * d]].map((column) => column.map((v) => v / determinant));
    const out = [...r[0], 0, ...r[1], 0, ...r[2], 0, 0, 0, 0, 1];
    for (let row = 0; row < 3; row++)
        out[12 + row] = -(out[row] * m[12] + out[4 + row] * m[13] + out[8 + row] * m[14]);
    return out;
}

// Returns inverse(frame) * place: the placement `place` relative to `frame`. If `frame` is not invertible, returns `place`.
export function relativeTo(frame, place) {
    const inverse = inverted(frame);
    return inverse ? multiplied(inverse, place) : place;
}

const linear = (c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;

export class GlbWriter {
    constructor(generator) {
        this.json = { asset: { version: '2.0', generator }, scene: 0, scenes: [{ nodes: [] }], nodes: [], meshes: [], materials: [],
            accessors: [], bufferViews: [] };
        this.chunks = [];
        this.length = 0;
        this.materials = new Map();
    }

    #add(array, componentType, type, target, range) {
        const width = type === 'VEC3' ? 3 : 1;
        this.json.bufferViews.push({ buffer: 0, byteOffset: this.length, byteLength: array.byteLength, target });
        this.chunks.push(Buffer.from(array.buffer, array.byteOffset, array.byteLength));
        this.length += array.byteLength;
        const bufferView = this.json.bufferViews.length - 1, count = array.length / width;
        this.json.accessors.push({ bufferView, componentType, type, count, ...range });
        return this.json.accessors.length - 1;
    }

    #material([r, g, b, a]) {
        const key = [r, g, b, a].map((v) => v.toFixed(3)).join(' ');
        if (!this.materials.has(key)) {
            this.materials.set(key, this.json.materials.length);
            this.json.materials.push({ doubleSided: true, ...a < 1 ? { alphaMode: 'BLEND' } : {}, pbrMetallicRoughness: {
                baseColorFactor: [linear(r), linear(g), linear(b), a], metallicFactor: 0.1, roughnessFactor: 0.6 } });
        }
        return this.materials.get(key);
    }

    // Transforms triangles by the matrix `place` and adds them to the file as a glTF primitive. vertices: six numbers per
    // vertex, position and normal. corners: vertex indices. Returns { primitive, dropped }: primitive is null if no triangle
    // remains; dropped: number of triangles left out because a corner is not finite, or has no vertex.
    addPrimitive({ vertices, corners }, place, color) {
        const count = Math.floor(vertices.length / 6), positions = new Float32Array(count * 3), normals = new Float32Array(count * 3);
        const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], good = new Uint8Array(count);
        for (let i = 0; i < count; i++) {
            const [x, y, z, nx, ny, nz] = vertices.subarray(6 * i, 6 * i + 6), n = [0, 0, 0];
            for (let row = 0; row < 3; row++) {
                positions[3 * i + row] = place[row] * x + place[4 + row] * y + place[8 + row] * z + place[12 + row];
                n[row] = place[row] * nx + place[4 + row] * ny + place[8 + row] * nz;
            }
            const length = Math.hypot(...n), p = positions.subarray(3 * i, 3 * i + 3);
            good[i] = p.every(Number.isFinite);
            if (!good[i])
                p.fill(0);
            normals.set(length > 1e-12 ? n.map((v) => v / length) : [0, 1, 0], 3 * i);
            for (let axis = 0; axis < 3; axis++) {
                low[axis] = Math.min(low[axis], p[axis]);
                high[axis] = Math.max(high[axis], p[axis]);
            }
        }
        const kept = [];
        for (let i = 0; i + 2 < corners.length; i += 3) {
            const three = corners.subarray(i, i + 3);
            if (three.every((corner) => corner < count && good[corner]))
                kept.push(...three);
        }
        const dropped = Math.floor(corners.length / 3) - kept.length / 3;
        if (kept.length === 0)
            return { primitive: null, dropped };
        return { dropped, primitive: { attributes: { POSITION: this.#add(positions, FLOAT, 'VEC3', VERTICES, { min: low, max: high }),
            NORMAL: this.#add(normals, FLOAT, 'VEC3', VERTICES) }, indices: this.#add(new Uint32Array(kept), UINT, 'SCALAR', INDICES),
        mode: TRIANGLES, material: this.#material(color) } };
    }

    addMesh(name, primitives) {
        this.json.meshes.push({ ...name ? { name } : {}, primitives });
        return this.json.meshes.length - 1;
    }

    addNode(parent, name, extras) {
        const number = this.json.nodes.length;
        this.json.nodes.push({ ...name ? { name } : {}, ...extras ? { extras } : {} });
        (parent < 0 ? this.json.scenes[0].nodes : this.json.nodes[parent].children ??= []).push(number);
        return number;
    }

    place(node, mesh, matrix) {
        Object.assign(this.json.nodes[node], { mesh, matrix });
    }

    // Returns the whole GLB file as a buffer.
    finished() {
        this.json.buffers = [{ byteLength: this.length }];
        let text = Buffer.from(JSON.stringify(this.json));
        text = Buffer.concat([text, Buffer.alloc((4 - text.length % 4) % 4, ' ')]);
        const total = GLB_HEAD + CHUNK_HEAD + text.length + CHUNK_HEAD + this.length;
        if (total > MAX_BYTES)
            throw new Error('a GLB file holds at most 4 GiB');
        const head = Buffer.alloc(GLB_HEAD + CHUNK_HEAD), binary = Buffer.alloc(CHUNK_HEAD);
        head.write('glTF', 0, 'latin1');
        head.writeUInt32LE(2, 4);
        head.writeUInt32LE(total, 8);
        head.writeUInt32LE(text.length, 12);
        head.write('JSON', 16, 'latin1');
        binary.writeUInt32LE(this.length, 0);
        binary.write('BIN\0', 4, 'latin1');
        return Buffer.concat([head, text, binary, ...this.chunks]);
    }
}
