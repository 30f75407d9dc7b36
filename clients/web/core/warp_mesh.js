// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes for drawing a picture from another camera than its own. Cells of a depth grid become quads, cut where the depth has a step. A
// sheet is one surface within a cell: a divided cell has two.
import { basis, heightAt, isParallel, RADIANS } from './camera.js';
import { distance } from './camera_moves.js';
import { add, dot, length, scale, subtract } from './vector.js';

// steepest slope of a surface along the view, as a tangent: neighbouring cells with a larger difference in depth show two
// surfaces
const STEEPEST = 6;
// cells are merged into one quad if their depth codes deviate from a plane by at most FLAT_CODES, or FLAT_SHARE of the depth
const FLAT_SHARE = 0.002, FLAT_CODES = 0.8;
const BLOCK = 16; // maximum side of a block of merged cells, in cells
const LAP_PX = 0.5; // overlap of merged blocks in pixels of the picture, which hides cracks between blocks of different sizes
export const WHOLE = 0, NEAR = 1, FAR = 2; // which pixels of its cells a quad shows: all, those before the depth step, those behind it
const ORDER = [0, 2, 1, 1, 2, 3]; // corners of a quad's two triangles, by index of the vertex
// number of floats per vertex: x and y in pixels of the picture (in a split view: of one half of the picture), depth, and which
// pixels of its cells the quad shows (WHOLE, NEAR or FAR)
export const FLOATS = 4;

class Sheets {
    constructor(grid, camera) {
        Object.assign(this, grid);
        const step = STEEPEST * heightAt(camera, 1) / grid.height * grid.cellPx / Math.abs(grid.unit);
        // Maximum difference between the depth codes of one surface in neighbouring cells, as a function of the code.
        const mostAt = (code) => Math.max(2, grid.parallel ? step : step * this.depthOf(code));
        this.most = Float32Array.from({ length: grid.levels + 1 }, (_, code) => mostAt(code));
    }

    depthOf(code) {
        return code === 0 && !this.parallel ? 0 : this.base + (code - 1) * this.unit;
    }

    isNext(a, b) {
        return a === 0 || b === 0 ? a === b : Math.abs(a - b) <= this.most[Math.max(a, b)];
    }

    // Returns the depth code of the sheet (surface within a cell) of cell (x, y) that continues a neighbouring sheet with the given code;
    // -1: none.
    continuing(code, x, y) {
        if (x < 0 || y < 0 || x >= this.columns || y >= this.rows)
            return -1;
        const i = y * this.columns + x, near = this.near[i], far = this.far[i], isNear = this.isNext(code, near);
        if (far >= 0 && this.isNext(code, far) && (!isNear || Math.abs(code - far) < Math.abs(code - near)))
            return far;
        return isNear ? near : -1;
    }

    // Returns the change of the depth code from the centre of a cell to its edge in the direction (dx, dy): half the change
    // from the opposite neighbour to the cell. 0: that neighbour does not continue the surface.
    half(code, x, y, dx, dy) {
        const before = this.continuing(code, x - dx, y - dy);
        return before < 0 ? 0 : (code - before) / 2;
    }

    // Returns the depth code at the corner of a cell in the direction (dx, dy). All cells that share a corner and a surface get the same
    // code.
    corner(code, x, y, dx, dy) {
        const across = this.continuing(code, x + dx, y), down = this.continuing(code, x, y + dy);
        if (across >= 0 && down >= 0) {
            const diagonal = this.continuing(across, x + dx, y + dy);
            return diagonal < 0 ? (across + down) / 2 : (code + across + down + diagonal) / 4;
        }
        const slopes = (c, cx, cy) => c + (across < 0 ? this.half(c, cx, cy, dx, 0) : 0) + (down < 0 ? this.half(c, cx, cy, 0, dy) : 0);
        const next = across >= 0 ? [across, x + dx, y] : down >= 0 ? [down, x, y + dy] : null;
        if (!next)
            return slopes(code, x, y);
        const diagonal = this.continuing(next[0], x + dx, y + dy);
        return diagonal < 0 ? (slopes(code, x, y) + slopes(...next)) / 2 : (code + diagonal) / 2;
    }
}

// Returns the depth code at each corner of the grid around which the farthest sheets (surfaces within a cell) of the four cells
// form one surface; NaN at other corners.
function sharedCorners({ columns, rows }, back, sheets) {
    const wide = columns + 1, corners = new Float32Array(wide * (rows + 1)).fill(NaN);
    for (let y = 0; y <= rows; y++)
        for (let x = 0; x <= columns; x++) {
            // At the grid's edge, only two cells meet at a corner (x0 equals x1, or y0 equals y1). Such a corner gets NaN even
            // if its two cells show one surface.
            const x0 = Math.max(0, x - 1), x1 = Math.min(columns - 1, x);
            const y0 = Math.max(0, y - 1) * columns, y1 = Math.min(rows - 1, y) * columns;
            const a = back[y0 + x0], b = back[y0 + x1], c = back[y1 + x0], d = back[y1 + x1];
            if (sheets.isNext(a, b) && sheets.isNext(c, d) && sheets.isNext(a, c) && sheets.isNext(b, d))
                corners[y * wide + x] = x0 === x1 || y0 === y1 ? NaN : (a + b + c + d) / 4;
        }
    return corners;
}

// Collects quads as vertices and indices. `most`: maximum number of quads that a grid can need.
class Quads {
    constructor(most) {
        this.vertices = new Float32Array(most * 4 * FLOATS);
        this.indices = new Uint32Array(most * 6);
        this.count = 0;
    }

    // depths: at the top left, top right, bottom left and bottom right corner of the quad.
    add(left, top, right, bottom, depths, kind) {
        const { vertices, indices } = this, first = this.count * 4;
        for (let i = 0, at = first * FLOATS; i < 4; i++) {
            vertices[at++] = i & 1 ? right : left;
            vertices[at++] = i & 2 ? bottom : top;
            vertices[at++] = depths[i];
            vertices[at++] = kind;
        }
        for (let i = 0, at = this.count++ * 6; i < 6; i++)
            indices[at + i] = first + ORDER[i];
    }
}

const isFlat = (from, to, at, share, tolerance) => Math.abs(from + (to - from) * share - at) <= tolerance;

class Mesher {
    constructor(grid, camera) {
        this.grid = grid;
        this.sheets = new Sheets(grid, camera);
        this.back = grid.near.map((near, i) => (grid.far[i] >= 0 ? grid.far[i] : near));
        this.corners = sharedCorners(grid, this.back, this.sheets);
        let divided = 0;
        for (const far of grid.far)
            divided += far >= 0 ? 1 : 0;
        this.quads = new Quads(grid.near.length + divided);
    }

    // Returns true if a block of cells is a plane, within the tolerance.
    isPlane(x, y, side) {
        const { corners, grid: { columns, unit } } = this, wide = columns + 1, at = y * wide + x, end = at + side * wide;
        const a = corners[at], b = corners[at + side], c = corners[end], d = corners[end + side];
        if (!(a >= 0 && b >= 0 && c >= 0 && d >= 0))
            return false;
        const tolerance = a === 0 ? 0 : Math.max(FLAT_CODES, FLAT_SHARE * Math.abs(this.sheets.depthOf(a) / unit));
        for (let j = 0; j <= side; j++) {
            const share = j / side, left = a + (c - a) * share, right = b + (d - b) * share;
            for (let i = 0; i <= side; i++)
                if (!isFlat(left, right, corners[at + j * wide + i], i / side, tolerance)) // also false for NaN
                    return false;
        }
        return true;
    }

    block(x, y, side) {
        const { columns, rows, cellPx, width, height } = this.grid;
        if (x >= columns || y >= rows)
            return;
        if (side === 1) {
            this.cell(x, y);
        } else if (x + side <= columns && y + side <= rows && this.isPlane(x, y, side)) {
            const { corners, sheets } = this, wide = columns + 1, at = y * wide + x, end = at + side * wide;
            const codes = [corners[at], corners[at + side], corners[end], corners[end + side]];
            const lap = LAP_PX / (side * cellPx), [a, b, c, d] = codes;
            const grow = (own, h, v) => (own === 0 ? 0 : own + lap * (2 * own - h - v));
            const lapped = [grow(a, b, c), grow(b, a, d), grow(c, a, d), grow(d, b, c)].map((code) => sheets.depthOf(code));
            this.quads.add(x * cellPx - LAP_PX, y * cellPx - LAP_PX, Math.min(width, (x + side) * cellPx + LAP_PX),
                Math.min(height, (y + side) * cellPx + LAP_PX), lapped, this.isDivided(x, y, side) ? FAR : WHOLE);
        } else {
            for (const [i, j] of [[0, 0], [1, 0], [0, 1], [1, 1]])
                this.block(x + i * side / 2, y + j * side / 2, side / 2);
        }
    }

    isDivided(x, y, side) {
        const { far, columns } = this.grid;
        for (let j = y; j < y + side; j++)
            for (let i = x; i < x + side; i++)
                if (far[j * columns + i] >= 0)
                    return true;
        return false;
    }

    // Adds a cell's farthest sheet.
    cell(x, y) {
        const i = y * this.grid.columns + x;
        this.sheet(x, y, this.back[i], this.grid.far[i] < 0 ? WHOLE : FAR);
    }

    // Adds quads for the near sheet (surface before the step in depth) of each divided cell.
    addNear() {
        const { near, far, columns } = this.grid;
        for (let i = 0; i < far.length; i++)
            if (far[i] >= 0)
                this.sheet(i % columns, Math.floor(i / columns), near[i], NEAR);
    }

    sheet(x, y, code, kind) {
        const { sheets, corners, grid: { columns, cellPx, width, height, parallel } } = this, wide = columns + 1;
        const depth = (dx, dy) => {
            const shared = kind !== NEAR ? corners[(y + (dy > 0)) * wide + x + (dx > 0)] : NaN;
            const found = shared >= 0 ? shared : sheets.corner(code, x, y, dx, dy);
            return sheets.depthOf(parallel ? found : Math.max(0.5, found));
        };
        const depths = code === 0 ? Array(4).fill(sheets.depthOf(0)) : [depth(-1, -1), depth(1, -1), depth(-1, 1), depth(1, 1)];
        this.quads.add(x * cellPx, y * cellPx, Math.min(width, (x + 1) * cellPx), Math.min(height, (y + 1) * cellPx), depths, kind);
    }
}

// Returns { vertices, indices, count } of quads over a depth grid: merged where the surface is plane, separate where the depth
// has a step. camera: camera of the grid's picture.
export function meshOf(grid, camera) {
    const mesher = new Mesher(grid, camera);
    for (let y = 0; y < grid.rows; y += BLOCK)
        for (let x = 0; x < grid.columns; x += BLOCK)
            mesher.block(x, y, BLOCK);
    mesher.addNear();
    const { vertices, indices, count } = mesher.quads;
    return { vertices: vertices.subarray(0, count * 4 * FLOATS), indices: indices.subarray(0, count * 6), count };
}

// Returns the depth at a pixel of the picture to which the grid belongs (in a split view: of one half of the picture); null outside.
export function depthAt(grid, px, py) {
    const { columns, rows, cellPx, maskSide, masks, near, far, base, unit, parallel } = grid;
    const x = Math.floor(px / cellPx), y = Math.floor(py / cellPx), i = y * columns + x, bit = cellPx / maskSide;
    if (x < 0 || y < 0 || x >= columns || y >= rows)
        return null;
    const isFar = far[i] >= 0 && masks[Math.floor(py / bit) * columns * maskSide + Math.floor(px / bit)] === 0;
    const code = isFar ? far[i] : near[i];
    return code === 0 && !parallel ? 0 : base + (code - 1) * unit;
}

const halfHeight = (camera) => (isParallel(camera) ? camera.height_m / 2 : Math.tan(camera.fov * RADIANS / 2));

// Returns the columns of the matrix that maps [x, y, depth, 1] of a depth grid to homogeneous plant positions relative to
// `origin`. Each column is [vector, homogeneous coordinate]. camera: camera of the grid's picture.
export function gridColumns({ width, height }, camera, origin) {
    const old = basis(camera), tall = halfHeight(camera), wide = tall * width / height;
    const eye = subtract(camera.eye, origin), corner = add(scale(old.right, -wide), scale(old.up, tall));
    const [depth, rest] = isParallel(camera) ? [[old.forward, 0], [add(eye, corner), 1]] : [[eye, 1], [add(old.forward, corner), 0]];
    return [[scale(old.right, 2 * wide / width), 0], [scale(old.up, -2 * tall / height), 0], depth, rest];
}

// Returns the 4x4 matrix, column by column as WebGL takes it, from [x, y, depth, 1] of a depth grid to clip coordinates of
// another camera, for a picture of the same shape. nearest: surfaces closer to the new eye than this are not drawn (metres).
export function warpMatrix({ width, height }, from, to, nearest) {
    const now = basis(to), up = halfHeight(to), across = up * width / height, reach = 2 * distance(to) + 1e4 * up;
    return gridColumns({ width, height }, from, to.eye).flatMap(([v, h]) => {
        const x = dot(v, now.right) / across, y = dot(v, now.up) / up, z = dot(v, now.forward);
        return isParallel(to) ? [x, y, z / reach, h] : [x, y, z * (1 - 1e-6) - 2 * nearest * h, z];
    });
}

// Returns where a point [x, y, depth] of the grid appears in pixels of the new picture; null: behind the eye.
export function moveBy(matrix, { width, height }, point) {
    const [x, y, , w] = [0, 1, 2, 3].map((row) => [...point, 1].reduce((sum, value, i) => sum + matrix[4 * i + row] * value, 0));
    return w > 0 ? [(x / w + 1) * width / 2, (1 - y / w) * height / 2] : null;
}

const FADE_MS = 80; // time in which a warped picture fades to the server's picture of the same camera

// Returns the fraction of the warped picture's pixels that are left out, `ms` milliseconds after the fade began; 1: the fade is over.
export const goneAfter = (ms) => Math.min(1, ms / FADE_MS);

const MOST_TURN = Math.cos(50 * RADIANS), MOST_STEP = 0.8, MOST_ZOOM = 2.5;

// Returns true if a picture from one camera may be shown from another. It may not after a large jump of the camera, nor if one
// camera is perspective and the other orthographic.
export function isNear(from, to) {
    if (isParallel(from) !== isParallel(to) || dot(basis(from).forward, basis(to).forward) < MOST_TURN)
        return false;
    if (isParallel(to))
        return Math.abs(Math.log(from.height_m / to.height_m)) < Math.log(MOST_ZOOM) &&
            length(subtract(from.target, to.target)) < to.height_m;
    return length(subtract(from.eye, to.eye)) < MOST_STEP * Math.max(distance(from), distance(to));
}
