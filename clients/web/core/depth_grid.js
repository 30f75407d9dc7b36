// SPDX-License-Identifier: GPL-3.0-or-later
// Parses depth grids (protocol/PROTOCOL.md). A depth grid holds the depth of each small square cell of a picture as an integer
// code. warp_mesh.js builds a mesh from the grid.

const HEADER_BYTES = 44, ENCODING = 2, FLAG_PARALLEL = 1, FLAG_MORE = 2, MAX_LEVELS = 4095, LONG = 255;
const MAX_CELLS = 1 << 20, MAX_MASK_PX = 1 << 24;

function need(condition, what) {
    if (!condition)
        throw new Error(`depth grid: ${what}`);
}

// Returns the header of a depth grid and its compressed payload. Throws if a field has an impossible value.
export function readHeader(data) {
    need(data.length > HEADER_BYTES, `${data.length} bytes`);
    const view = new DataView(data.buffer, data.byteOffset, data.length);
    const u16 = (o) => view.getUint16(o, true), u32 = (o) => view.getUint32(o, true);
    const grid = {
        parallel: (u16(2) & FLAG_PARALLEL) !== 0, more: (u16(2) & FLAG_MORE) !== 0, seq: u32(8),
        x: u16(12), y: u16(14), width: u16(16), height: u16(18), fullWidth: u16(20), fullHeight: u16(22), columns: u16(24), rows: u16(26),
        cellPx: data[28], maskSide: data[29], levels: u16(30), base: view.getFloat32(32, true), unit: view.getFloat32(36, true),
        dataBytes: u32(40), payload: data.subarray(HEADER_BYTES),
    };
    const { width, height, columns, rows, cellPx, maskSide, base, unit } = grid;
    need(data[0] === 2 && data[1] === ENCODING, `encoding ${data[1]} is unknown`);
    need(u32(4) === grid.payload.length, `${grid.payload.length} bytes of payload, the header says ${u32(4)}`);
    need(cellPx > 0 && maskSide > 0 && cellPx % maskSide === 0, `masks of side ${maskSide} do not divide cells of ${cellPx} px`);
    need(width > 0 && height > 0 && grid.x + width <= grid.fullWidth && grid.y + height <= grid.fullHeight,
        `part of ${width}x${height} is outside the picture`);
    need(columns === Math.ceil(width / cellPx) && rows === Math.ceil(height / cellPx), `${columns}x${rows} cells`);
    need(columns * rows <= MAX_CELLS && columns * rows * maskSide * maskSide <= MAX_MASK_PX, `too many cells or masks: ${columns}x${rows}`);
    need(grid.levels >= 1 && grid.levels <= MAX_LEVELS, `${grid.levels} levels`);
    // Depth codes grow towards the eye: 1/z grows in a perspective picture, z shrinks in an orthographic one.
    need(Number.isFinite(base) && Number.isFinite(unit) && (grid.parallel ? unit < 0 : unit > 0),
        `depths from ${base} in steps of ${unit}`);
    need(Number.isFinite(base + grid.levels * unit), 'the depths are too large');
    return grid;
}

// Reads the cells' depth codes from bytes. A symbol is the difference from a predicted code, or announces an explicit code in
// the next two bytes.
class Symbols {
    constructor(bytes, at, levels) {
        Object.assign(this, { bytes, at, levels });
    }

    next(prediction) {
        const symbol = this.bytes[this.at++];
        let code = prediction + (symbol & 1 ? -(symbol + 1) / 2 : symbol / 2);
        if (symbol === LONG) {
            code = this.bytes[this.at] | (this.bytes[this.at + 1] << 8);
            this.at += 2;
        }
        // the check also rejects NaN, which is the code that results from reading beyond the end of the bytes
        need(code >= 0 && code <= this.levels, `code ${code}`);
        return code;
    }
}

// Predicts a cell's depth code from the codes of its left, upper and upper left neighbours (0 for a missing one): the median of left, up
// and left + up - corner (the plane through all three), as in JPEG-LS.
function predicted(left, up, corner) {
    if (!left || !up || !corner)
        return left || up;
    return Math.max(Math.min(left, up), Math.min(Math.max(left, up), left + up - corner));
}

// Returns arrays with an entry for each cell: `near` (depth code of the nearest surface), `far` (code of the surface behind a step in
// depth; -1: the cell has no step) and `back` (code of the farthest surface). Also returns `at`, the byte position after the codes.
function readCodes({ columns, rows, levels }, bytes) {
    const count = columns * rows, back = new Int16Array(count), far = new Int16Array(count).fill(-1), bits = Math.ceil(count / 8);
    const symbols = new Symbols(bytes, bits, levels);
    for (let y = 0, i = 0; y < rows; y++)
        for (let x = 0; x < columns; x++, i++) {
            const left = x > 0 ? back[i - 1] : 0, up = y > 0 ? back[i - columns] : 0, corner = x > 0 && y > 0 ? back[i - columns - 1] : 0;
            back[i] = symbols.next(predicted(left, up, corner));
        }
    const near = back.slice();
    for (let i = 0; i < count; i++)
        if (bytes[i >> 3] & (1 << (i & 7))) {
            const x = i % columns, beside = [x > 0 ? near[i - 1] : 0, near[i - columns] ?? 0, x > 0 ? near[i - columns - 1] ?? 0 : 0];
            far[i] = back[i];
            near[i] = symbols.next(beside.find((code) => code > back[i]) ?? back[i]);
            need(far[i] < near[i], `near surface (${near[i]}) not before far one (${far[i]})`);
        }
    return { near, far, back, at: symbols.at };
}

// Reads the masks of divided cells (cells with a near and a far surface). A mask says which of the cell's pixels show the near surface.
class Masks {
    constructor({ columns, rows, maskSide }, { near, far, back }) {
        Object.assign(this, { columns, maskSide, near, far, back, wide: columns * maskSide });
        // one byte for each mask bit of the whole grid: 255 where the picture shows the nearer surface of its cell
        this.bits = new Uint8Array(this.wide * rows * maskSide);
        this.row = new Uint8Array(maskSide); // mask bits of the row of pixels above, from which the bits of the present row are predicted
    }

    // Compares cell `i`, which shows two surfaces, with a neighbour. Returns 1 if the neighbour's surface continues the near
    // surface of cell `i`, 0 if it continues the far one: the one with the nearer depth code. Returns null if the neighbour
    // also shows two surfaces and so has a mask of its own.
    sideOf(neighbour, i) {
        const { near, far, back } = this;
        if (far[neighbour] >= 0)
            return null;
        return Math.abs(back[neighbour] - near[i]) < Math.abs(back[neighbour] - far[i]) ? 1 : 0;
    }

    read(i, bytes, at) {
        const { columns, maskSide, wide, bits, row } = this, x = i % columns, first = (i - x) * maskSide * maskSide + x * maskSide;
        const west = x > 0 ? this.sideOf(i - 1, i) : 0, north = i >= columns ? this.sideOf(i - columns, i) : 0;
        for (let bx = 0; bx < maskSide; bx++)
            row[bx] = north ?? bits[first - wide + bx] & 1;
        for (let by = 0, bit = 0, corner; by < maskSide; by++) {
            const start = first + by * wide, beside = west ?? bits[start - 1] & 1;
            let left = beside, between = by === 0 ? beside : corner;
            for (let bx = 0; bx < maskSide; bx++, bit++) {
                const up = row[bx], expected = left === up ? left : 1 - between;
                between = up;
                left = row[bx] = expected ^ (bytes[at + (bit >> 3)] >> (bit & 7) & 1);
                bits[start + bx] = -left;
            }
            corner = beside;
        }
    }
}

// Returns one byte for each mask bit of the whole grid: 255 where the picture shows the nearer one of its cell's two surfaces.
function readMasks(grid, bytes, codes) {
    const masks = new Masks(grid, codes), each = Math.ceil(grid.maskSide ** 2 / 8);
    let { at } = codes;
    codes.far.forEach((far, i) => {
        if (far < 0)
            return;
        masks.read(i, bytes, at);
        at += each;
    });
    need(at === bytes.length, `${bytes.length} bytes, expected ${at}`);
    return masks.bits;
}

// Parses the inflated payload of a grid. Returns the grid with `near` and `far` (depth codes by cell; far -1: the cell shows one surface)
// and `masks`.
export function readGrid(header, bytes) {
    need(bytes.length === header.dataBytes, `${bytes.length} bytes inflated, the header says ${header.dataBytes}`);
    const codes = readCodes(header, bytes), { near, far } = codes;
    // true: the grid shows no surface, so `base`, the depth of the lowest code, may have any value
    const isEmpty = near.every((code) => code === 0);
    need(header.parallel || header.base > 0 || isEmpty, `depth ${header.base} is not above 0`);
    return { ...header, payload: null, near, far, masks: readMasks(header, bytes, codes) };
}

// Returns true if depth grids (of a whole picture, or of the left and then the right half of a split view) belong to a picture: they have
// the picture's size and projection, and cover it.
export function fitPicture(grids, { camera, fullWidth, fullHeight }) {
    let right = 0;
    for (const grid of grids) {
        if (grid.fullWidth !== fullWidth || grid.fullHeight !== fullHeight || grid.parallel !== (camera.fov === 0)
            || grid.x !== right || grid.y !== 0 || grid.height !== fullHeight)
            return false;
        right += grid.width;
    }
    return right === fullWidth;
}

async function inflate(payload, most) {
    const reader = new Blob([payload]).stream().pipeThrough(new DecompressionStream('deflate-raw')).getReader();
    const bytes = new Uint8Array(most);
    for (let at = 0; ;) {
        const { done, value } = await reader.read();
        if (done)
            return bytes.subarray(0, at);
        need(at + value.length <= most, `more bytes inflated than the header says, ${most}`);
        bytes.set(value, at);
        at += value.length;
    }
}

// Decodes a binary message with a depth grid. Returns a promise, which rejects if the bytes are not a valid grid.
export async function decodeGrid(bytes) {
    const header = readHeader(bytes), most = 3 * MAX_CELLS + MAX_MASK_PX;
    need(header.dataBytes <= most, `${header.dataBytes} bytes`);
    return readGrid(header, await inflate(header.payload, header.dataBytes));
}
