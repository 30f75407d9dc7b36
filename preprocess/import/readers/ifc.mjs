// SPDX-License-Identifier: GPL-3.0-or-later
// `node ifc.mjs INPUT OUTPUT.glb CHORD_MM UNITS UP ENCODING`: reads IFC with web-ifc, in its own process; web-ifc is installed
// in the same folder. The spatial tree becomes nodes with GUID, class, storey and property sets; geometry that several elements
// share is stored once. On failure the last line on stderr is the reason.
import { createRequire } from 'node:module';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { basename, dirname, extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { GlbWriter, relativeTo } from './glb_writer.mjs';
import { collectErrors, findDamaged, findLosses, listed, misplacedLines, partlyLostLines, wrongIndexLines, wrongIndices }
    from './ifc_losses.mjs';
import { openingLines, uncutOpenings } from './ifc_openings.mjs';
import { readSolids, takeSolids, withPlacements } from './ifc_solids.mjs';

const CORNERS = 24; // number of segments that approximate a full circle
const MAX_DEPTH = 400; // maximum depth of the tree of nodes; plantcast-prep reads at most 512 levels
const NOT_SHOWN = new Set(['IfcOpeningElement', 'IfcOpeningStandardCase', 'IfcSpace', 'IfcDistributionPort', 'IfcVirtualElement']);

const webIfc = createRequire(import.meta.url)('./web-ifc-api-node.js');

const textOf = (value) => {
    const plain = value?.value ?? value;
    return plain === null || plain === undefined || typeof plain === 'object' ? '' : String(plain);
};

class Model {
    constructor(api, id) {
        Object.assign(this, { api, id });
        this.children = new Map();
        this.sets = new Map(); // property sets by element id
        this.types = new Map();
        this.lines = new Map();
    }

    // Returns a statement, or null if the file refers to this id but has no statement with it.
    lineOnce(id) {
        try {
            return this.api.GetLine(this.id, id);
        } catch {
            return null;
        }
    }

    // Like lineOnce(), but keeps the statement for the next call.
    line(id) {
        if (!this.lines.has(id))
            this.lines.set(id, this.lineOnce(id));
        return this.lines.get(id);
    }

    *ofType(type) {
        const ids = this.api.GetLineIDsWithType(this.id, type, true);
        for (let i = 0; i < ids.size(); i++)
            yield ids.get(i);
    }

    // Calls f(relating, related) with the ids of both objects, for each pair of objects related by an IFC relationship of this
    // type.
    relate(type, one, many, f) {
        for (const id of this.ofType(type)) {
            const line = this.line(id), relating = line?.[one]?.value, related = [line?.[many] ?? []].flat();
            for (const { value } of related.filter(Boolean))
                if (Number.isInteger(relating) && Number.isInteger(value))
                    f(relating, value);
        }
    }

    readRelations() {
        const append = (map) => (key, value) => map.set(key, [...map.get(key) ?? [], value]);
        const below = append(this.children), define = append(this.sets);
        this.relate(webIfc.IFCRELAGGREGATES, 'RelatingObject', 'RelatedObjects', below);
        this.relate(webIfc.IFCRELNESTS, 'RelatingObject', 'RelatedObjects', below);
        this.relate(webIfc.IFCRELCONTAINEDINSPATIALSTRUCTURE, 'RelatingStructure', 'RelatedElements', below);
        this.relate(webIfc.IFCRELDEFINESBYPROPERTIES, 'RelatingPropertyDefinition', 'RelatedObjects',
            (set, element) => define(element, set));
        this.relate(webIfc.IFCRELDEFINESBYTYPE, 'RelatingType', 'RelatedObjects', (type, element) => this.types.set(element, type));
    }

    classOf(id) {
        const name = this.api.GetNameFromTypeCode(this.api.GetLineType(this.id, id));
        return typeof name === 'string' ? name : '';
    }

    nameOf(id) {
        const line = this.line(id);
        return textOf(line?.Name) || textOf(line?.LongName) || textOf(line?.ObjectType) || '';
    }

    valuesOf(set) {
        const values = {}, line = this.line(set);
        for (const reference of [...line?.HasProperties ?? [], ...line?.Quantities ?? []]) {
            const property = this.line(reference?.value);
            const name = textOf(property?.Name);
            const value = ['NominalValue', 'LengthValue', 'AreaValue', 'VolumeValue', 'CountValue', 'WeightValue', 'TimeValue']
                .map((key) => textOf(property?.[key])).find(Boolean) ?? [property?.EnumerationValues ?? property?.ListValues ?? []].flat()
                .map(textOf).filter(Boolean).join(', ');
            if (name && value)
                values[name] = value;
        }
        return values;
    }

    propertiesOf(id, storey) {
        const line = this.line(id), type = this.line(this.types.get(id));
        const out = { GlobalId: textOf(line?.GlobalId), IfcClass: this.classOf(id), Storey: storey, Type: textOf(type?.Name),
            Tag: textOf(line?.Tag), Description: textOf(line?.Description), ObjectType: textOf(line?.ObjectType) };
        for (const key of Object.keys(out))
            if (!out[key])
                delete out[key];
        for (const set of [...[type?.HasPropertySets ?? []].flat().map((reference) => reference?.value), ...this.sets.get(id) ?? []]) {
            const name = textOf(this.line(set)?.Name) || 'Properties', values = this.valuesOf(set);
            if (Object.keys(values).length > 0)
                out[name] = { ...typeof out[name] === 'object' ? out[name] : {}, ...values };
        }
        return out;
    }
}

// Returns one mesh for an IFC element, in the frame of the first of its geometries (parts). Elements with equal parts at equal relative
// positions share a mesh. dropped: number of the parts' triangles that are left out.
function meshOf(glb, geometries, parts, name) {
    const frame = parts[0].flatTransformation;
    const placed = parts.map((part) => ({ ...part, place: relativeTo(frame, part.flatTransformation) }));
    const key = JSON.stringify(placed.map(({ geometryExpressID, color: { x, y, z, w }, place }) =>
        [geometryExpressID, x, y, z, w, place.map((v) => Math.round(v * 1e6) / 1e6)]));
    if (!geometries.made.has(key)) {
        const added = placed.map(({ geometryExpressID, color: { x, y, z, w }, place }) =>
            glb.addPrimitive(geometries.of(geometryExpressID), place, [x, y, z, w]));
        const primitives = added.map(({ primitive }) => primitive).filter(Boolean);
        geometries.made.set(key, { mesh: primitives.length > 0 ? glb.addMesh(name, primitives) : -1,
            dropped: added.reduce((sum, { dropped }) => sum + dropped, 0) });
    }
    return { ...geometries.made.get(key), matrix: frame };
}

// Reads the triangles of all IFC elements from web-ifc. Copies each mesh while web-ifc streams it, because web-ifc frees it
// afterwards. unplaced: by element id, the ids of its parts whose placement web-ifc could not compute.
function readGeometry(api, id, model) {
    const shown = new Map(), known = new Map(), cutters = new Map(), unplaced = new Map();
    const copy = (geometryId) => {
        const geometry = api.GetGeometry(id, geometryId);
        const vertices = api.GetVertexArray(geometry.GetVertexData(), geometry.GetVertexDataSize()).slice();
        const corners = api.GetIndexArray(geometry.GetIndexData(), geometry.GetIndexDataSize()).slice();
        geometry.delete?.();
        return { vertices, corners };
    };
    const take = (to) => (mesh) => {
        const parts = [];
        for (let i = 0; i < mesh.geometries.size(); i++) {
            const { color, geometryExpressID, flatTransformation } = mesh.geometries.get(i), place = Array.from(flatTransformation);
            if (!place.every(Number.isFinite)) {
                unplaced.set(mesh.expressID, [...unplaced.get(mesh.expressID) ?? [], geometryExpressID]);
                continue;
            }
            if (!known.has(geometryExpressID))
                known.set(geometryExpressID, copy(geometryExpressID));
            parts.push({ color: { ...color }, geometryExpressID, flatTransformation: place });
        }
        if (parts.length > 0)
            to.set(mesh.expressID, parts);
    };
    const takeShown = take(shown);
    api.StreamAllMeshes(id, (mesh) => NOT_SHOWN.has(model.classOf(mesh.expressID)) || takeShown(mesh));
    const openings = [];
    model.relate(webIfc.IFCRELVOIDSELEMENT, 'RelatingBuildingElement', 'RelatedOpeningElement', (_, opening) => openings.push(opening));
    if (openings.length > 0)
        // stream the openings separately, because StreamAllMeshes() leaves them out
        api.StreamMeshes(id, [...new Set(openings)], take(cutters));
    return { shown, known, cutters, unplaced, geometries: { of: (geometryId) => known.get(geometryId), made: new Map() } };
}

function addTree(glb, model, { shown, geometries }, root) {
    const seen = new Set();
    const drawn = new Set(), incomplete = new Map(); // incomplete: by element id, the number of its triangles that are left out
    let storeys = 0;
    const add = (id, parent, storey, depth) => {
        if (depth > MAX_DEPTH)
            throw new Error(`its elements are nested deeper than ${MAX_DEPTH} levels`);
        const kind = model.classOf(id);
        if (seen.has(id) || NOT_SHOWN.has(kind) && !model.children.has(id))
            return;
        seen.add(id);
        const name = model.nameOf(id), below = model.children.get(id) ?? [], parts = shown.get(id);
        storeys += kind === 'IfcBuildingStorey';
        const within = kind === 'IfcBuildingStorey' ? name : storey;
        const node = glb.addNode(parent, name, model.propertiesOf(id, within));
        if (parts) {
            const { mesh, matrix, dropped } = meshOf(glb, geometries, parts, name);
            if (mesh >= 0) {
                glb.place(below.length > 0 ? glb.addNode(node, '', null) : node, mesh, matrix);
                drawn.add(id);
                if (dropped > 0)
                    incomplete.set(id, dropped);
            }
        }
        for (const child of below)
            add(child, node, within, depth + 1);
    };
    for (const id of model.ofType(webIfc.IFCPROJECT))
        add(id, root, '', 0);
    for (const id of shown.keys())
        add(id, root, '', 0); // add the elements that are outside the spatial tree as children of the root node
    return { drawn, incomplete, storeys };
}

// Converts the file's text to UTF-8. Standard IFC is ASCII with escapes, but many programs write names in their system's encoding.
function inUtf8(bytes, encoding) {
    if (['-', 'UTF-8'].includes(encoding))
        return bytes;
    let decoder;
    try {
        decoder = new TextDecoder(encoding);
    } catch {
        throw new Error(`Node.js does not know the encoding ${encoding}: save the file as UTF-8`);
    }
    return Buffer.from(decoder.decode(bytes));
}

// Writes the list of elements that Open CASCADE should build instead of web-ifc; plantcast-import then runs this program again.
// If the list already exists, this is the second run.
function askForSolids(list, elements) {
    if (elements.length > 0 && !existsSync(list))
        writeFileSync(list, `${[...new Set(elements)].join('\n')}\n`);
}

async function main([input, output, , , , encoding]) {
    const bytes = inUtf8(readFileSync(input), encoding), folder = dirname(fileURLToPath(import.meta.url));
    const head = bytes.subarray(0, 4096).toString('latin1');
    if (/^\W*</.test(head) && /ifcxml/i.test(head))
        throw new Error('IFC in XML (ifcXML) is not supported: export the model as IFC in STEP text (.ifc)');
    if (!head.includes('ISO-10303-21'))
        throw new Error('this is not an IFC file: it does not begin with ISO-10303-21');
    if (!bytes.subarray(-4096).toString('latin1').includes('END-ISO-10303-21'))
        throw new Error('the IFC file is truncated: it does not end with END-ISO-10303-21');
    // must precede the initialisation of web-ifc, which keeps references to the console functions it finds at that time
    const errors = collectErrors();
    const api = new webIfc.IfcAPI();
    api.SetWasmPath(`${folder}/`, true);
    await api.Init();
    api.SetLogLevel(webIfc.LogLevel.LOG_LEVEL_ERROR);
    const solids = readSolids(join(dirname(output), 'solids.glb'));
    const id = api.OpenModel(withPlacements(bytes, solids.placements), { COORDINATE_TO_ORIGIN: false, CIRCLE_SEGMENTS: CORNERS });
    if (id < 0 || !api.IsModelOpen(id))
        throw new Error('this is not an IFC file of a known schema, or the file is truncated');
    const schema = api.GetModelSchema(id);
    const model = new Model(api, id);
    model.readRelations();
    const glb = new GlbWriter('plantcast-import, web-ifc');
    const root = glb.addNode(-1, basename(input, extname(input)), null);
    const geometry = readGeometry(api, id, model);
    const findUncut = () => uncutOpenings(model, webIfc.IFCRELVOIDSELEMENT, geometry, solids);
    const wrong = new Set(solids.elements.size > 0 ? findUncut().flatMap(({ elements }) => elements) : []);
    takeSolids(model, solids, geometry, { styledItem: webIfc.IFCSTYLEDITEM, voids: webIfc.IFCRELVOIDSELEMENT }, wrong);
    const uncut = findUncut();
    const { drawn, incomplete, storeys } = addTree(glb, model, geometry, root);
    errors.stop();
    const types = { product: webIfc.IFCPRODUCT, grid: webIfc.IFCGRIDPLACEMENT };
    const isShown = (element) => drawn.has(element) || NOT_SHOWN.has(model.classOf(element));
    const { lost, lines, ids, drawn: drawnInstead } = findLosses(model, webIfc.IFCPRODUCT, isShown, solids.failed);
    const unplaced = new Map([...geometry.unplaced].filter(([element]) => drawn.has(element)));
    const wrongFaces = [webIfc.IFCPOLYGONALFACESET, webIfc.IFCTRIANGULATEDFACESET].flatMap((type) => wrongIndices(model, type));
    askForSolids(join(dirname(output), 'asked.txt'), [...ids, ...unplaced.keys(), ...incomplete.keys(),
        ...findDamaged(model, webIfc.IFCPRODUCT, new Set([...errors.at(), ...wrongFaces])),
        ...uncut.flatMap(({ opening, elements }) => [opening, ...elements])]);
    if (drawn.size > 0)
        writeFileSync(output, glb.finished());
    const openings = [...model.ofType(webIfc.IFCRELVOIDSELEMENT)].length - uncut.length;
    process.stdout.write([`${schema}: ${drawn.size} elements with a shape, ${lost.length} lost, ${storeys} storeys, ${openings} openings ` +
        `cut; ${solids.elements.size} elements by Open CASCADE; of the others circles have ${CORNERS} corners (--chord does not apply)`,
    ...lines.length > 0 ? [`not shown: ${lines.length} elements that consist only of lines or points: ${
        listed(lines)}`.replace(/[\t\n]/g, ' ')] : [],
    ...lost, ...partlyLostLines(model, unplaced, incomplete), ...wrongIndexLines(model, webIfc.IFCPRODUCT, wrongFaces, solids),
    ...openingLines(model, uncut), ...drawnInstead, ...misplacedLines(model, types, isShown, solids.failed),
    ...errors.lines(model, solids), ''].join('\n'));
    if (drawn.size === 0)
        throw new Error(`the IFC file contains no surface${lost.length > 0 ? `: ${lost.length} elements have no triangles, such as ` +
            lost[0].split('\t').slice(1).join(', ') : ''}`);
}

main(process.argv.slice(2)).catch((error) => {
    // exceptions of this program are Error objects with a message for users; others come from web-ifc, so their text is only
    // quoted
    const reason = String(error?.message ?? error).split('\n')[0], ours = error?.constructor === Error;
    process.stderr.write(`${ours && reason ? reason : `the IFC file could not be read (${reason || 'no reason is known'})`}\n`);
    process.exit(1);
});
