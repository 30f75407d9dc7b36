// SPDX-License-Identifier: GPL-3.0-or-later
// Reports losses of an IFC file: elements that have a shape but no triangles, and errors that web-ifc prints.
const LINES = /Curve|Polyline|IfcLine|Circle|Ellipse|Point|Text|Annotation|GeometricSet|BoundingBox|Vertex|Edge|Alignment/;
const REFERENCE = 5; // web-ifc's type code for a value that refers to a statement
// Formats values as a line of the reader's output: a record of fields separated by tabs, as preprocess/import/findings.h
// describes.
export const fields = (...values) => values.map((value) => String(value).replace(/\s+/g, ' ').trim()).join('\t');
const GRID = 'IfcGridPlacement';
const MAX_LISTED = 20;

// Joins texts to a list, which is cut after MAX_LISTED texts.
export const listed = (texts, separator = ', ') =>
    [...texts.slice(0, MAX_LISTED), ...texts.length > MAX_LISTED ? ['...'] : []].join(separator);

const elementText = (model, id) =>
    `#${id} ${model.nameOf(id)} (${model.classOf(id)}, ${model.line(id)?.GlobalId?.value ?? 'no GUID'})`;

// Returns the ids of the given IFC statements and of all statements that they refer to, directly or indirectly.
function reached(model, ids) {
    const found = new Set(), open = ids.map((value) => ({ type: REFERENCE, value }));
    while (open.length > 0) {
        const value = open.pop();
        if (Array.isArray(value)) {
            open.push(...value);
        } else if (value?.type === REFERENCE && !found.has(value.value)) {
            found.add(value.value);
            open.push(...Object.values(model.line(value.value) ?? {}));
        }
    }
    return found;
}

// Captures web-ifc's console output, the only place where web-ifc reports omissions. Returns { stop, at, lines }: stop() ends
// the capture; at() returns the ids of statements with errors; lines() returns the lines to print, without errors in items that
// Open CASCADE built instead.
export function collectErrors() {
    const { log, error } = console, found = new Map();
    console.log = console.error = (...words) => {
        for (const line of words.join(' ').split('\n')) {
            const [, text, id] = /\[error\]\s*(.*?)\s*(\d*)\s*(?:\(type \d+\))?\s*$/.exec(line) ?? [];
            if (text)
                found.set(text, (found.get(text) ?? []).concat(id ? [Number(id)] : []));
        }
    };
    // returns the lines that the reader prints about the captured errors: records in the format that
    // preprocess/import/findings.h describes
    const lines = (model, solids) => {
        const built = found.size > 0 ? builtItems(solids) : [];
        const instead = reached(model, built), left = [...found].map(([text, ids]) =>
            [text, ids.filter((id) => !instead.has(id)), ids.length > 0]);
        return left.filter(([, ids, numbered]) => ids.length > 0 || !numbered).map(([text, ids]) =>
            fields('error', Math.max(ids.length, 1), `web-ifc: ${text} ${listed(ids.map((id) => `#${id}`), ' ')}`));
    };
    return { stop: () => Object.assign(console, { log, error }), at: () => new Set([...found.values()].flat()), lines };
}

// Returns the geometry items of an IFC shape, including those of mapped representations. Visits each representation only once,
// because in a damaged file one may map itself.
function itemsOf(model, shape) {
    const items = new Set(), seen = new Set(), open = [model.line(shape)?.Representations ?? []].flat().map((one) => one?.value);
    while (open.length > 0) {
        const representation = open.pop();
        if (!representation || seen.has(representation))
            continue;
        seen.add(representation);
        for (const { value } of [model.line(representation)?.Items ?? []].flat().filter(Boolean)) {
            const source = model.line(value)?.MappingSource?.value;
            if (source)
                open.push(model.line(source)?.MappedRepresentation?.value);
            else
                items.add(value);
        }
    }
    return [...items];
}

// Returns the ids of the face sets of this type that have an index outside their list of points. web-ifc does not check
// indices, and reads whatever lies next to the points.
export function wrongIndices(model, type) {
    const numbers = (value) => [value ?? []].flat(Infinity).map((one) => Number(one?.value ?? one));
    return [...model.ofType(type)].filter((id) => {
        const set = model.lineOnce(id), points = model.lineOnce(set?.Coordinates?.value)?.CoordList?.length ?? 0;
        const table = numbers(set?.PnIndex), isWrong = (index, most) => !(index >= 1 && index <= most);
        const isLost = (index) => table.length > 0 ? isWrong(index, table.length) || isWrong(table[index - 1], points)
            : isWrong(index, points);
        const faces = [set, ...[set?.Faces ?? []].flat().filter(Boolean).map(({ value }) => model.lineOnce(value))];
        return faces.some((face) => [...numbers(face?.CoordIndex), ...numbers(face?.InnerCoordIndices)].some(isLost));
    });
}

// Returns the items of the elements that Open CASCADE built.
const builtItems = (solids) => [...solids.elements.values()].flatMap(({ parts }) => parts.map(({ item }) => item));

// Returns lines of the reader's output that name the face sets with wrong indices that web-ifc draws. Leaves out those that Open
// CASCADE built, and those in an item that it refused, because another line states the reason. Format: error records of findings.h.
export function wrongIndexLines(model, product, sets, solids) {
    if (sets.length === 0)
        return [];
    const shapes = [...model.ofType(product)].map((id) => model.line(id)?.Representation?.value).filter(Boolean);
    const drawn = reached(model, shapes.flatMap((shape) => itemsOf(model, shape)));
    const refused = [...solids.failed.keys()].filter((id) => !model.line(id)?.GlobalId);
    const others = reached(model, [...builtItems(solids), ...refused]), ids = sets.filter((id) => drawn.has(id) && !others.has(id));
    return ids.length === 0 ? [] : [fields('error', ids.length, `a face has an index outside the list of points: ${
        listed(ids.map((id) => `#${id} ${model.classOf(id)}`))}`)];
}

// Returns the elements whose shapes contain statements with web-ifc errors.
export function findDamaged(model, product, errors) {
    const known = new Map(), isDamaged = (item) => {
        if (!known.has(item))
            known.set(item, [...reached(model, [item])].some((id) => errors.has(id)));
        return known.get(item);
    };
    return errors.size === 0 ? [] : [...model.ofType(product)].filter((id) => {
        const shape = model.line(id)?.Representation?.value;
        return shape && itemsOf(model, shape).some(isDamaged);
    });
}

// Returns { lost, lines, ids, drawn }; `lost` and `drawn` are report lines (format: findings.h). lost: elements that have a
// shape but no triangles. lines: names of elements that consist only of lines and points. ids: statement ids of the lost
// elements. drawn: items that Open CASCADE cannot build and web-ifc draws instead.
export function findLosses(model, product, isShown, failed) {
    const lost = [], lines = [], ids = [], named = new Set();
    for (const id of model.ofType(product)) {
        const line = model.line(id), shape = line?.Representation?.value;
        if (!shape || isShown(id))
            continue;
        const items = itemsOf(model, shape), kinds = [...new Set(items.map((item) => model.classOf(item) || 'a missing statement'))];
        if (items.length > 0 && kinds.every((kind) => LINES.test(kind))) {
            lines.push(model.nameOf(id) || `#${id}`);
            continue;
        }
        const reason = [id, ...items].map((item) => failed.get(item)).find(Boolean);
        const why = items.length === 0 ? 'its representation is empty'
            : kinds.join(', ') + (reason ? `: ${reason}; the element is left out` : '');
        ids.push(id);
        items.forEach((item) => named.add(item));
        lost.push(fields('lost', `#${id}`, model.nameOf(id) ?? '', model.classOf(id), line.GlobalId?.value ?? 'no GUID', why));
    }
    const isItem = (id) => !named.has(id) && !model.line(id)?.GlobalId && model.classOf(id) !== GRID;
    const drawn = [...failed].filter(([id]) => isItem(id)).map(([id, reason]) =>
        fields('error', 1, `#${id} ${model.classOf(id)} is built by web-ifc, with coarse circles, instead of by Open CASCADE: ${
            reason}`));
    return { lost, lines, ids, drawn };
}

// Returns lines of the reader's output (format: error records of findings.h) that name elements shown without some of their
// parts or triangles. unplaced: by element id, its parts that have no place. incomplete: by element id, the number of triangles that
// are left out.
export function partlyLostLines(model, unplaced, incomplete) {
    return [...[...unplaced].map(([id, parts]) => fields('error', parts.length,
        `parts of ${elementText(model, id)} are not shown, because their placement is invalid: export the model again`)),
    ...[...incomplete].map(([id, count]) => fields('error', count,
        `triangles of ${elementText(model, id)} are not shown, because their coordinates are missing, infinite or not numbers`))];
}

// Returns lines of the reader's output that name the misplaced elements, whose grid placement could not be computed. Format:
// error records of preprocess/import/findings.h.
export function misplacedLines(model, { product, grid }, isShown, failed) {
    const found = new Map(); // names of the misplaced elements, by reason
    for (const id of model.ofType(grid).next().done ? [] : model.ofType(product)) {
        const line = model.line(id), seen = new Set();
        let place = line?.ObjectPlacement?.value;
        while (place && !seen.has(place) && model.classOf(place) !== GRID) {
            seen.add(place);
            place = model.line(place)?.PlacementRelTo?.value;
        }
        if (!place || seen.has(place) || !line.Representation || !isShown(id))
            continue;
        const why = failed.get(place) ?? 'built without Open CASCADE';
        found.set(why, [...found.get(why) ?? [], elementText(model, id)]);
    }
    return [...found].map(([why, names]) => fields('error', names.length,
        `elements shown at a wrong place, because a grid placement is not computed (${why}): ${
            listed(names)}`));
}
