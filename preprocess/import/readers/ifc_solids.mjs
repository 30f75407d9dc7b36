// SPDX-License-Identifier: GPL-3.0-or-later
// Merges the solids that Open CASCADE built for an IFC file (ifc_shapes.hh) with the geometry that web-ifc built for all other
// items.
import { existsSync, readFileSync } from 'node:fs';
import { multiplied } from './glb_writer.mjs';
import { voidedElements } from './ifc_openings.mjs';

const HEAD = 20, CHUNK_HEAD = 8, GREY = { x: 0.6, y: 0.6, z: 0.6, w: 1 };

function parseGlb(path) {
    const file = readFileSync(path), length = file.readUInt32LE(12), json = JSON.parse(file.subarray(HEAD, HEAD + length));
    const binary = file.subarray(HEAD + length + CHUNK_HEAD);
    const read = (number, Type, width) => {
        const { bufferView, byteOffset = 0, count } = json.accessors[number];
        const from = (json.bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
        return new Type(Uint8Array.from(binary.subarray(from, from + count * width * Type.BYTES_PER_ELEMENT)).buffer);
    };
    return { json, read };
}

// Returns { elements, failed, placements }. elements: a Map from element id to { parts, whole }. parts: the element's built
// items; whole: true if these are all of its geometry. failed: a Map from the id of an item that could not be built to the
// reason. placements: a Map from the id of a grid placement to the statements of an equal local placement.
export function readSolids(path) {
    const elements = new Map(), failed = new Map(), placements = new Map();
    if (!existsSync(path))
        return { elements, failed, placements };
    const { json, read } = parseGlb(path), number = (name) => Number(name.slice(1));
    const geometries = (json.meshes ?? []).map(({ primitives: [{ attributes: { POSITION, NORMAL }, indices }] }) => {
        const points = read(POSITION, Float32Array, 3), normals = read(NORMAL, Float32Array, 3);
        const vertices = new Float32Array(2 * points.length);
        for (let i = 0; i < points.length; i += 3)
            vertices.set([...points.subarray(i, i + 3), ...normals.subarray(i, i + 3)], 2 * i);
        return { vertices, corners: read(indices, Uint32Array, 1) };
    });
    for (const root of json.scenes[0].nodes) {
        const { name, extras = {}, matrix, children = [] } = json.nodes[root];
        if (name === 'failed' || name === 'placements')
            Object.entries(extras).forEach(([id, text]) => (name === 'failed' ? failed : placements).set(number(id), text));
        else
            elements.set(number(name), { whole: extras.whole === 'yes', cut: extras.cut === 'yes', parts: children.map((child) => {
                const part = json.nodes[child];
                return { item: number(part.name), geometry: geometries[part.mesh], place: multiplied(matrix, part.matrix) };
            }) });
    }
    return { elements, failed, placements };
}

// Replaces the statements of grid placements, which web-ifc does not compute, with equal local placements. bytes: the IFC file.
export function withPlacements(bytes, placements) {
    const out = [];
    let from = 0;
    for (let at = placements.size > 0 ? bytes.indexOf('IFCGRIDPLACEMENT') : -1; at >= 0; at = bytes.indexOf('IFCGRIDPLACEMENT', at + 1)) {
        const begin = bytes.lastIndexOf('#', at), end = bytes.indexOf(';', at) + 1;
        const [, id] = /^#(\d+)\s*=\s*$/.exec(bytes.subarray(begin, at).toString('latin1')) ?? [];
        if (end > 0 && placements.has(Number(id))) {
            out.push(bytes.subarray(from, begin), Buffer.from(placements.get(Number(id))));
            from = end;
        }
    }
    return from > 0 ? Buffer.concat([...out, bytes.subarray(from)]) : bytes;
}

// Returns a function that maps a geometry item to the colour of its style, or to undefined if the item has no style.
function styles(model, type) {
    const found = new Map();
    const colorOf = (id, depth) => {
        const line = depth < 8 ? model.line(id) : null, rgb = model.line(line?.SurfaceColour?.value);
        if (rgb)
            return { x: rgb.Red.value, y: rgb.Green.value, z: rgb.Blue.value, w: 1 - (line.Transparency?.value ?? 0) };
        return [line?.Styles ?? []].flat().map((style) => colorOf(style?.value, depth + 1)).find(Boolean) ?? null;
    };
    for (const id of model.ofType(type)) {
        const item = model.line(id)?.Item?.value, color = item ? colorOf(id, 0) : null;
        if (color && Object.values(color).every(Number.isFinite))
            found.set(item, color);
    }
    return (item) => found.get(item);
}

// Replaces web-ifc's geometry of an item by the solid that Open CASCADE built. An element with openings keeps web-ifc's
// geometry, if any, unless Open CASCADE cut the openings and web-ifc did not (`wrong`: ids of such elements).
export function takeSolids(model, solids, { shown, known, unplaced }, { styledItem, voids }, wrong) {
    const colorOf = styles(model, styledItem), voided = new Set();
    model.relate(voids, 'RelatingBuildingElement', 'RelatedOpeningElement', (host) =>
        voidedElements(model, host).forEach((element) => voided.add(element)));
    for (const [element, { whole, cut, parts }] of solids.elements) {
        const drawn = shown.get(element) ?? [], built = new Set(parts.map(({ item }) => item));
        if (drawn.length > 0 && voided.has(element) && !(cut && wrong.has(element)))
            continue;
        // parts that Open CASCADE built are placed
        const left = whole ? [] : (unplaced.get(element) ?? []).filter((item) => !built.has(item));
        unplaced.delete(element);
        if (left.length > 0)
            unplaced.set(element, left);
        const others = whole ? [] : drawn.filter(({ geometryExpressID }) => !built.has(geometryExpressID));
        shown.set(element, [...others, ...parts.map(({ item, geometry, place }) => {
            const same = drawn.find(({ geometryExpressID }) => geometryExpressID === item), id = `solid ${cut ? `${element} ` : ''}${item}`;
            const color = same?.color ?? colorOf(item) ?? drawn[0]?.color ?? GREY;
            known.set(id, geometry);
            return { color, geometryExpressID: id, flatTransformation: place };
        })]);
    }
}
