// SPDX-License-Identifier: GPL-3.0-or-later
// Elements with openings, as statements of ifc_kinds.mjs, and the volume that remains. The element is a box of 200 x 100 x 50
// mm unless its name says otherwise.
import { point } from './ifc_kinds.mjs';

const BOX = 200 * 100 * 50, DISC = Math.PI * 20 ** 2;
const rectangle = ['profile', 'IFCRECTANGLEPROFILEDEF(.AREA.,$,$,200.,100.)'];
const box = [rectangle, ['item', 'IFCEXTRUDEDAREASOLID(#{profile},#{frame},#{z},50.)']];
const voids = (shape, place = 'place', number = 6) => [
    [`opening${number}`, `IFCOPENINGELEMENT('0$PlantcastKinds000000${number}',$,'O-${number}',$,$,#{${place}},#{${shape}},$)`],
    [`voids${number}`, `IFCRELVOIDSELEMENT('0$PlantcastKinds000001${number}',$,$,$,#{element},#{opening${number}})`]];
const opening = (item, lines, { type = 'SweptSolid', place, number = 6 } = {}) => [...lines,
    [`body${number}`, `IFCSHAPEREPRESENTATION(#{context},'Body','${type}',(#{${item}}))`],
    [`shape${number}`, `IFCPRODUCTDEFINITIONSHAPE($,$,(#{body${number}}))`], ...voids(`shape${number}`, place, number)];
const extruded = (profile, low, height, name = 'hole') => [[`${name}p`, profile], point(`${name}u`, 0, 0, low),
    [`${name}f`, `IFCAXIS2PLACEMENT3D(#{${name}u},$,$)`], [name, `IFCEXTRUDEDAREASOLID(#{${name}p},#{${name}f},#{z},${height}.)`]];
const square = (low, height, x = 50, y = 50, name) => extruded(`IFCRECTANGLEPROFILEDEF(.AREA.,$,$,${x}.,${y}.)`, low, height, name);
const hole = opening('hole', square(-10, 70));

const SIDES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
const corners = (x, y, low, high) => [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? high : low]);
const faceted = (name, ...size) => [...corners(...size).map((at, i) => point(`${name}${i}`, ...at)),
    ...SIDES.flatMap((side, i) => [[`${name}l${i}`, `IFCPOLYLOOP((${side.map((k) => `#{${name}${k}}`)}))`],
        [`${name}b${i}`, `IFCFACEOUTERBOUND(#{${name}l${i}},.T.)`], [`${name}f${i}`, `IFCFACE((#{${name}b${i}}))`]]),
    [`${name}s`, `IFCCLOSEDSHELL((${SIDES.map((_, i) => `#{${name}f${i}}`)}))`], [name, `IFCFACETEDBREP(#{${name}s})`]];
const tessellated = (name, ...size) => [
    [`${name}p`, `IFCCARTESIANPOINTLIST3D((${corners(...size).map((at) => `(${at.map((v) => `${v}.`)})`)}))`],
    [name, `IFCTRIANGULATEDFACESET(#{${name}p},$,.T.,(${SIDES.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]])
        .map((three) => `(${three.map((k) => k + 1)})`)}),$)`]];
const mapped = (item, name) => [[`${name}s`, `IFCSHAPEREPRESENTATION(#{context},'Body','SweptSolid',(#{${item}}))`],
    [`${name}m`, `IFCREPRESENTATIONMAP(#{frame},#{${name}s})`],
    [`${name}o`, 'IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,#{o},1.,$)'], [name, `IFCMAPPEDITEM(#{${name}m},#{${name}o})`]];
const line = (low, high) => [point('low', 0, 0, low), point('high', 0, 0, high), ['line', 'IFCPOLYLINE((#{low},#{high}))']];
const composite = (low, high) => [...line(low, high), ['segment', 'IFCCOMPOSITECURVESEGMENT(.CONTINUOUS.,.T.,#{line})'],
    ['curve', 'IFCCOMPOSITECURVE((#{segment}),.F.)']];

// [name, IFC statements, volume in mm3 that remains after cutting, type of the shape representation]
export const OPENINGS = [
    ['through', [...box, ...hole], BOX - 2500 * 50],
    ['as deep as the element', [...box, ...opening('hole', square(0, 50))], BOX - 2500 * 50],
    ['recess', [...box, ...opening('hole', square(25, 50))], BOX - 2500 * 25],
    ['cavity', [...box, ...opening('hole', square(10, 20))], BOX - 2500 * 20],
    ['longer than the element', [...box, ...opening('hole', square(-10, 70, 400, 20))], BOX - 200 * 20 * 50],
    ['round', [...box, ...opening('hole', extruded('IFCCIRCLEPROFILEDEF(.AREA.,$,$,20.)', -10, 70))], BOX - DISC * 50],
    ['a faceted B-rep', [...box, ...opening('cut', faceted('cut', 20, 20, -10, 60), { type: 'Brep' })], BOX - 1600 * 50],
    ['tessellated', [...box, ...opening('cut', tessellated('cut', 20, 20, -10, 60), { type: 'Tessellation' })], BOX - 1600 * 50],
    ['in a faceted B-rep', [...faceted('item', 100, 50, 0, 50), ...hole], BOX - 2500 * 50, 'Brep'],
    ['in a tessellated element', [...tessellated('item', 100, 50, 0, 50), ...hole], BOX - 2500 * 50, 'Tessellation'],
    ['in a mapped element', [rectangle, ['solid', box[1][1]], ...mapped('solid', 'item'), ...hole], BOX - 2500 * 50,
        'MappedRepresentation'],
    ['mapped', [...box, ...square(-10, 70), ...opening('again', mapped('hole', 'again'), { type: 'MappedRepresentation' })],
        BOX - 2500 * 50],
    ['a pipe', [...box, ...opening('disk', [...line(-10, 60), ['disk', 'IFCSWEPTDISKSOLID(#{line},20.,$,$,$)']])], BOX - DISC * 50],
    ['a pipe along a composite curve with parameters', [...box, ...opening('disk', [...composite(-10, 60),
        ['disk', 'IFCSWEPTDISKSOLID(#{curve},20.,$,0.,1.)']])], BOX - DISC * 50],
    ['a cylinder of CSG', [...box, ...opening('csg', [point('low', 0, 0, -10), ['at', 'IFCAXIS2PLACEMENT3D(#{low},$,$)'],
        ['round', 'IFCRIGHTCIRCULARCYLINDER(#{at},70.,20.)'], ['csg', 'IFCCSGSOLID(#{round})']], { type: 'CSG' })], BOX - DISC * 50],
    ['clipped by a half space', [...box, ...opening('clipped', [...square(-10, 70), point('half', 0, 0, 25),
        ['halfAt', 'IFCAXIS2PLACEMENT3D(#{half},#{z},#{x})'], ['plane', 'IFCPLANE(#{halfAt})'],
        ['space', 'IFCHALFSPACESOLID(#{plane},.F.)'], ['clipped', 'IFCBOOLEANCLIPPINGRESULT(.DIFFERENCE.,#{hole},#{space})']],
    { type: 'Clipping' })], BOX - 2500 * 25],
    ['a sectioned spine', [...box, ...opening('spine', [['section', 'IFCRECTANGLEPROFILEDEF(.AREA.,$,$,50.,50.)'], ...line(-10, 60),
        ['lowAt', 'IFCAXIS2PLACEMENT3D(#{low},$,$)'], ['highAt', 'IFCAXIS2PLACEMENT3D(#{high},$,$)'],
        ['spine', 'IFCSECTIONEDSPINE(#{line},(#{section},#{section}),(#{lowAt},#{highAt}))']])], BOX - 2500 * 50],
    ['in a pipe', [...line(0, 500), ['item', 'IFCSWEPTDISKSOLID(#{line},100.,$,$,$)'], ...hole], Math.PI * 1e4 * 500 - 2500 * 60],
    ['in a pipe along a composite curve with parameters', [...composite(0, 500), ['item', 'IFCSWEPTDISKSOLID(#{curve},100.,$,0.,1.)'],
        ...opening('hole', square(-10, 270))], Math.PI * 1e4 * 500 - 2500 * 260],
    ['in a block of CSG', [['block', 'IFCBLOCK(#{frame},200.,100.,50.)'], ['item', 'IFCCSGSOLID(#{block})'], ...hole],
        BOX - 625 * 50, 'CSG'],
    ['in a tapered element', [rectangle, ['item', 'IFCEXTRUDEDAREASOLIDTAPERED(#{profile},#{frame},#{z},50.,#{profile})'], ...hole],
        BOX - 2500 * 50],
    ['two that overlap', [...box, ...hole, ...opening('second', square(-10, 70, 80, 20, 'second'), { number: 7 })],
        BOX - 2500 * 50 - 30 * 20 * 50],
    ['placed relative to the element', [...box, point('off', 40, 0, 0), ['offAt', 'IFCAXIS2PLACEMENT3D(#{off},$,$)'],
        ['moved', 'IFCLOCALPLACEMENT(#{place},#{offAt})'], ...opening('hole', square(-10, 70), { place: 'moved' })], BOX - 2500 * 50],
];

// [name, IFC statements, part of the reason reported]: elements with an opening that the importer cannot cut
export const UNCUT = [
    ['a surface', [...box, ...opening('sheet', [point('a', -300, 0, 0), point('b', 300, 0, 0), ['edge', 'IFCPOLYLINE((#{a},#{b}))'],
        ['open', 'IFCARBITRARYOPENPROFILEDEF(.CURVE.,$,#{edge})'], ['sheet', 'IFCEXTRUDEDAREASOLID(#{open},#{frame},#{z},50.)']])],
    'the opening encloses no space'],
    ['without a shape', [...box, ['none', 'IFCPRODUCTDEFINITIONSHAPE($,$,())'], ...voids('none')],
        'the shape of the opening cannot be built'],
];
