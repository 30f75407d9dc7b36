// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that each opening is cut out of its element: no point inside the opening may lie inside the element.
import { fields } from './ifc_losses.mjs';

const SAMPLES = 24; // number of points tested within each opening
// directions of the rays that test whether a point is inside an element; chosen so that faces are rarely parallel to them
const RAYS = [[0.2672612, 0.5345225, 0.8017837], [-0.6337502, 0.4436252, -0.6337502]];
const SHARE = 0.1; // an opening counts as not cut if more than this share of its points is inside the element

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// Returns the triangles of an element's geometries (parts), in metres.
function trianglesOf(parts, geometryOf) {
    const out = [];
    for (const { geometryExpressID, flatTransformation: m } of parts) {
        const { vertices, corners } = geometryOf(geometryExpressID);
        const at = (corner) => {
            const [x, y, z] = vertices.subarray(6 * corner, 6 * corner + 3);
            return [0, 1, 2].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]);
        };
        for (let i = 0; i + 2 < corners.length; i += 3)
            out.push([at(corners[i]), at(corners[i + 1]), at(corners[i + 2])]);
    }
    return out;
}

// Returns whether a point is inside closed triangles: each ray from the point crosses an odd number of triangles.
const isInside = (point, triangles) => RAYS.every((ray) => {
    let crossings = 0;
    for (const [a, b, c] of triangles) {
        const ab = minus(b, a), ac = minus(c, a), normal = cross(ray, ac), det = dot(ab, normal);
        if (Math.abs(det) < 1e-18)
            continue;
        const from = minus(point, a), u = dot(from, normal) / det, q = cross(from, ab), v = dot(ray, q) / det;
        crossings += u >= 0 && v >= 0 && u + v <= 1 && dot(ac, q) / det > 0;
    }
    return crossings % 2 === 1;
});

// Returns points well inside closed triangles: midpoints between the centres of two triangles.
function innerPoints(triangles) {
    const points = [], count = triangles.length;
    const centre = (i) => [0, 1, 2].map((axis) => (triangles[i][0][axis] + triangles[i][1][axis] + triangles[i][2][axis]) / 3);
    for (let k = 0; k < 4 * SAMPLES && points.length < SAMPLES && count > 3; k++) {
        const i = k * 7 % count, a = centre(i), b = centre((i + 1 + k * 5 % (count - 1)) % count);
        const middle = a.map((v, axis) => (v + b[axis]) / 2);
        if (isInside(middle, triangles))
            points.push(middle);
    }
    return points;
}

// Returns the elements that an opening of `host` is cut out of: the host, or, if it has no shape, the elements it consists of.
export const voidedElements = (model, host) => (model.line(host)?.Representation?.value ? [host] : model.children.get(host) ?? []);

// Returns the openings of an IFC file that are not cut out of their element: [{ opening, host, elements, why }]. elements: see
// voidedElements(). why: the reason, or ''. geometry: the result of ifc.mjs's readGeometry(); its `cutters` are the openings
// that web-ifc built, by id.
export function uncutOpenings(model, voids, geometry, solids) {
    const { shown, known, cutters } = geometry;
    const out = [], triangles = new Map(), geometryOf = (id) => known.get(id);
    const of = (id, parts) => triangles.get(id) ?? triangles.set(id, trianglesOf(parts, geometryOf)).get(id);
    model.relate(voids, 'RelatingBuildingElement', 'RelatedOpeningElement', (host, opening) => {
        const elements = voidedElements(model, host), solid = solids.elements.get(opening);
        const cutter = cutters.get(opening) ?? solid?.parts.map(({ geometry, place, item }) => {
            known.set(`solid ${item}`, geometry);
            return { geometryExpressID: `solid ${item}`, flatTransformation: place };
        });
        if (!model.line(opening)?.Representation?.value || elements.every((element) => !shown.has(element)))
            return; // nothing to check: the opening has no shape, or none of the elements it is cut out of has one
        const points = cutter ? innerPoints(of(opening, cutter)) : [];
        const hosts = elements.filter((element) => shown.has(element)).map((element) => of(element, shown.get(element)));
        const filled = points.filter((point) => hosts.some((host) => isInside(point, host))).length;
        if (points.length === 0 || filled > SHARE * points.length)
            out.push({ opening, host, elements, why: !cutter ? 'the shape of the opening cannot be built'
                : points.length === 0 ? 'the opening encloses no space'
                : elements.map((element) => solids.failed.get(element)).find(Boolean) ?? '' });
    });
    return out;
}

// Returns one line of the reader's output for each opening that web-ifc did not cut out of its element. Format: error record of
// preprocess/import/findings.h.
export const openingLines = (model, uncut) => uncut.map(({ opening, host, why }) => fields('error', 1, `#${host} ${
    model.nameOf(host)} is shown without its opening #${opening} ${model.nameOf(opening)}${why ? `: ${why}` : ''}`));
