// SPDX-License-Identifier: GPL-3.0-or-later
// Other programs' readers, for comparison with Plantcast's import: for STEP and IGES occt-import-js (a newer Open CASCADE in
// WebAssembly with its own assembly tree), for FBX, COLLADA and OBJ the loaders of three.js.
import { createRequire } from 'node:module';
import { extname } from 'node:path';
import { triangleSums } from './triangle_sums.mjs';

const CHORD_M = 0.001;
const require = createRequire(import.meta.url);

// Returns { area, size: [x, y, z] with Z up } of triangles with the given up axis, or null if there are none.
function summed(sums, yUp) {
    const { area, extent: [x, y, z] } = sums.result();
    return area > 0 ? { area, size: yUp ? [x, z, y] : [x, y, z] } : null;
}

function sumOcct(occt, name, bytes) {
    const params = { linearUnit: 'meter', linearDeflectionType: 'absolute_value', linearDeflection: CHORD_M }, sums = triangleSums();
    const { meshes } = /^\.igs|^\.iges/i.test(extname(name)) ? occt.ReadIgesFile(bytes, params) : occt.ReadStepFile(bytes, params);
    for (const { attributes: { position: { array } }, index } of meshes ?? [])
        for (let i = 0; i + 2 < index.array.length; i += 3)
            sums.add(...[0, 1, 2].map((k) => array.slice(3 * index.array[i + k], 3 * index.array[i + k] + 3)));
    return summed(sums, false);
}

function sumScene(THREE, scene, metres) {
    const sums = triangleSums(), v = new THREE.Vector3();
    scene.updateMatrixWorld(true);
    scene.traverse(({ isMesh, geometry, matrixWorld }) => {
        const position = isMesh ? geometry.attributes.position : null, count = geometry?.index?.count ?? position?.count;
        const at = (k) => v.fromBufferAttribute(position, geometry.index ? geometry.index.getX(k) : k).applyMatrix4(matrixWorld)
            .multiplyScalar(metres).toArray();
        for (let i = 0; position && i + 2 < count; i += 3)
            sums.add(at(i), at(i + 1), at(i + 2));
    });
    return summed(sums, true);
}

// Resolves with a function that reads a STEP or IGES file, given as name and bytes, and returns its area and size; null if
// occt-import-js is not installed.
export async function secondCadReader() {
    try {
        const occt = await require('occt-import-js')({ print() {}, printErr() {} });
        return (name, bytes) => sumOcct(occt, name, new Uint8Array(bytes));
    } catch {
        return null;
    }
}

// Resolves with a function that reads an OBJ, COLLADA or FBX file, given as name and bytes, and returns its area and size; null
// if three.js is not installed. { metres }: unit of an OBJ or FBX file; COLLADA's loader applies the unit that the file states.
export async function secondMeshReader() {
    let THREE, loaders, DOMParser;
    try {
        THREE = await import('three');
        ({ DOMParser } = await import('@xmldom/xmldom'));
        loaders = [await import('three/examples/jsm/loaders/FBXLoader.js'), await import('three/examples/jsm/loaders/ColladaLoader.js'),
            await import('three/examples/jsm/loaders/OBJLoader.js')];
    } catch {
        return null;
    }
    const [{ FBXLoader }, { ColladaLoader }, { OBJLoader }] = loaders;
    globalThis.DOMParser ??= DOMParser;
    // three.js's FBX loader reads the size of `window` when it makes cameras, and node has none
    globalThis.window ??= { innerWidth: 1, innerHeight: 1 };
    return (name, bytes, { metres = 1 } = {}) => {
        const { log, warn, error } = console;
        console.log = console.warn = console.error = () => {}; // silences the loaders
        try {
            if (/\.fbx$/i.test(name))
                return sumScene(THREE, new FBXLoader().parse(Uint8Array.from(Buffer.from(bytes)).buffer, ''), metres);
            if (/\.dae$/i.test(name))
                return sumScene(THREE, new ColladaLoader().parse(bytes.toString(), '').scene, metres);
            return sumScene(THREE, new OBJLoader().parse(bytes.toString()), metres);
        } finally {
            Object.assign(console, { log, warn, error });
        }
    };
}
