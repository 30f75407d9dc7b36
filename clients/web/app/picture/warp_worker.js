// SPDX-License-Identifier: GPL-3.0-or-later
// Worker of warp.js: decodes depth grids and builds their meshes.
import { decodeGrid, fitPicture } from '../../core/depth_grid.js';
import { meshOf } from '../../core/warp_mesh.js';

// Messages from warp.js: { id, messages (binary messages with depth grids), frame: { camera, fullWidth, fullHeight } of their picture }.
// Answers: { id, parts: [{ grid, mesh }] } or { id, why (it failed) }.
onmessage = async ({ data: { id, messages, frame } }) => {
    try {
        const grids = await Promise.all(messages.map((bytes) => decodeGrid(new Uint8Array(bytes))));
        if (!fitPicture(grids, frame))
            throw new Error('depth grid: it belongs to another picture');
        const parts = grids.map((grid) => ({ grid, mesh: meshOf(grid, frame.camera) }));
        postMessage({ id, parts }, parts.flatMap(({ mesh }) => [mesh.vertices.buffer, mesh.indices.buffer]));
    } catch (error) {
        postMessage({ id, why: error.message });
    }
};
