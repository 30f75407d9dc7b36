// SPDX-License-Identifier: GPL-3.0-or-later
// A second reader of IFC that shares no code with web-ifc or Open CASCADE: ifc-lite, in WebAssembly. It tessellates circles
// coarsely.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { triangleSums } from './triangle_sums.mjs';

// Returns null if it is not installed; otherwise a function that takes a file's bytes and returns { area (m2), size (m: x, y,
// z) } of everything that the file shows, or null if it shows nothing. Openings are ignored.
export async function secondReader() {
    let lite;
    try {
        lite = await import('@ifc-lite/wasm');
    } catch {
        return null;
    }
    lite.initSync({ module: readFileSync(createRequire(import.meta.url).resolve('@ifc-lite/wasm/ifc-lite_bg.wasm')) });
    return (bytes) => {
        const api = new lite.IfcAPI(), head = api.buildPrePassOnce(bytes);
        const meshes = api.processGeometryBatch(bytes, head.jobs, head.unitScale, 0, 0, 0, false, head.voidKeys, head.voidCounts,
            head.voidValues, head.styleIds, head.styleColors, head.planeAngleToRadians);
        const sums = triangleSums();
        for (let i = 0; i < meshes.length; i++) {
            const { ifcType, positions, origin, indices } = meshes.get(i); // web-ifc's meshes have Y up
            const at = (k) => [0, 1, 2].map((axis) => positions[3 * k + axis] + origin[axis]);
            for (let k = 0; ifcType !== 'IfcOpeningElement' && k + 2 < indices.length; k += 3)
                sums.add(...[0, 1, 2].map((corner) => at(indices[k + corner])));
        }
        meshes.free();
        api.free();
        const { area, extent: [x, y, z] } = sums.result();
        return area > 0 ? { area, size: [x, z, y] } : null;
    };
}
