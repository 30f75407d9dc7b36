// SPDX-License-Identifier: GPL-3.0-or-later
// Small IFC files, one for each kind of shape that the importer supports, with the volume (m3) and size (m) that follow from
// the shape's geometry.
const R = 25, PIPE = Math.PI * R * R * 1e-9, HALF_TURN = Math.PI * 500;

// Numbers the statements of a list, given as [name, text], from `first` on. In a text, #{name} is replaced by the number of the
// statement with that name, in this list or in `before`. Returns { numbers, text }.
function statements(lines, first, before = new Map()) {
    const numbers = new Map([...before, ...lines.map(([name], i) => [name, first + i])]);
    const numbered = (text) => text.replace(/#\{(\w+)\}/g, (_, to) => `#${numbers.get(to)}`);
    return { numbers, text: lines.map(([, text], i) => `#${first + i}=${numbered(text)};`) };
}

const HEAD = [['o', 'IFCCARTESIANPOINT((0.,0.,0.))'], ['frame', 'IFCAXIS2PLACEMENT3D(#{o},$,$)'],
    ['z', 'IFCDIRECTION((0.,0.,1.))'], ['y', 'IFCDIRECTION((0.,1.,0.))'], ['x', 'IFCDIRECTION((1.,0.,0.))'],
    ['mm', 'IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.)'], ['rad', 'IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.)'],
    ['units', 'IFCUNITASSIGNMENT((#{mm},#{rad}))'],
    ['context', "IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#{frame},$)"],
    ['project', "IFCPROJECT('0$PlantcastKinds0000001',$,'P',$,$,$,$,(#{context}),#{units})"],
    ['place', 'IFCLOCALPLACEMENT($,#{frame})'],
    ['site', "IFCSITE('0$PlantcastKinds0000002',$,'S',$,$,#{place},$,$,.ELEMENT.,$,$,$,$,$)"],
    ['in', "IFCRELAGGREGATES('0$PlantcastKinds0000003',$,$,$,#{project},(#{site}))"]];

// Returns the statements of the building element "K-<i + 1>" with its shape and its place in the building; its identifiers and
// name contain `i`, so that no two elements share them.
const element = (lines, type, i) => [...lines,
    ['body', `IFCSHAPEREPRESENTATION(#{context},'Body','${type}',(#{item}))`],
    ['shape', 'IFCPRODUCTDEFINITIONSHAPE($,$,(#{body}))'],
    ['element', "IFCBUILDINGELEMENTPROXY('0$PlantcastKinds0000004',$,'K-1',$,$,#{place},#{shape},$,$)"],
    ['on', "IFCRELCONTAINEDINSPATIALSTRUCTURE('0$PlantcastKinds0000005',$,$,$,(#{element}),#{site})"]].map(([name, text]) =>
    [name, text.replace("'K-1'", `'K-${i + 1}'`).replace(/Kinds00(?=\d{5}')/, `Kinds${String(i).padStart(2, '0')}`)]);

// Returns an IFC file in millimetres with the elements "K-1", "K-2" and so on. Each element is given as { lines, type }: the
// statements of its shape, of which the one named "item" is the shape itself, and the representation type.
export function ifcOfAll(schema, elements) {
    const head = statements(HEAD, 1), body = [...head.text];
    elements.forEach(({ lines, type = 'SweptSolid' }, i) =>
        body.push(...statements(element(lines, type, i), body.length + 1, head.numbers).text));
    return ['ISO-10303-21;', 'HEADER;', "FILE_DESCRIPTION((''),'2;1');", "FILE_NAME('','',(''),(''),'','','');",
        `FILE_SCHEMA(('${schema}'));`, 'ENDSEC;', 'DATA;', ...body, 'ENDSEC;', 'END-ISO-10303-21;', ''].join('\n');
}

export const ifcOf = (schema, lines, type) => ifcOfAll(schema, [{ lines, type }]);

export const point = (name, ...at) => [name, `IFCCARTESIANPOINT((${at.map((v) => v.toFixed(6)).join(',')}))`];
const rectangle = ['profile', 'IFCRECTANGLEPROFILEDEF(.AREA.,$,$,200.,100.)'];
const corner = [point('a', 0, 0, 0), point('b', 1750, 0, 0), point('c', 1750, 1500, 0)];
const twoLines = [...corner, ['first', 'IFCPOLYLINE((#{a},#{b}))'], ['second', 'IFCPOLYLINE((#{b},#{c}))'],
    ['s1', 'IFCCOMPOSITECURVESEGMENT(.CONTINUOUS.,.T.,#{first})'], ['s2', 'IFCCOMPOSITECURVESEGMENT(.CONTINUOUS.,.T.,#{second})'],
    ['curve', 'IFCCOMPOSITECURVE((#{s1},#{s2}),.F.)']];
const mitred = { volume: PIPE * 3250, size: [1.775, 1.525, 0.05] };
const bend = [point('m', 0, 500, 0), ['v', 'IFCDIRECTION((0.,-1.,0.))'], ['at', 'IFCAXIS2PLACEMENT3D(#{m},#{z},#{v})'],
    ['circle', 'IFCCIRCLE(#{at},500.)'],
    ['arc', 'IFCTRIMMEDCURVE(#{circle},(IFCPARAMETERVALUE(0.)),(IFCPARAMETERVALUE(3.14159265358979)),.T.,.PARAMETER.)']];
const disk = (curve, rest = '$,$,$') => ['item', `IFCSWEPTDISKSOLID(#{${curve}},${R}.,${rest})`];

// A cylinder of 100 mm radius and 300 mm height as an advanced B-rep; its edges are circles, or exactly equal B-splines.
function cylinder(splines) {
    const ring = (name, z) => splines
        ? [...Array.from({ length: 9 }, (_, i) => {
            const angle = i * Math.PI / 4, radius = i % 2 ? 100 * Math.SQRT2 : 100;
            return point(`${name}${i}`, radius * Math.cos(angle), radius * Math.sin(angle), z);
        }), [name, `IFCRATIONALBSPLINECURVEWITHKNOTS(2,(${Array.from({ length: 9 }, (_, i) => `#{${name}${i}}`)}),.CIRCULAR_ARC.,.T.,.F.,` +
            `(3,2,2,2,3),(0.,1.,2.,3.,4.),.UNSPECIFIED.,(${Array.from({ length: 9 }, (_, i) => i % 2 ? Math.SQRT1_2 : '1.')}))`]]
        : [point(`${name}o`, 0, 0, z), [`${name}at`, `IFCAXIS2PLACEMENT3D(#{${name}o},#{z},#{x})`], [name, `IFCCIRCLE(#{${name}at},100.)`]];
    const oriented = (name, edge, same) => [name, `IFCORIENTEDEDGE(*,*,#{${edge}},.${same}.)`];
    return [point('p0', 100, 0, 0), point('p1', 100, 0, 300), ['v0', 'IFCVERTEXPOINT(#{p0})'], ['v1', 'IFCVERTEXPOINT(#{p1})'],
        ...ring('low', 0), ...ring('high', 300), ['up', 'IFCVECTOR(#{z},300.)'], ['seam', 'IFCLINE(#{p0},#{up})'],
        ['e0', 'IFCEDGECURVE(#{v0},#{v0},#{low},.T.)'], ['e1', 'IFCEDGECURVE(#{v1},#{v1},#{high},.T.)'],
        ['e2', 'IFCEDGECURVE(#{v0},#{v1},#{seam},.T.)'],
        oriented('l0', 'e0', 'T'), oriented('l1', 'e2', 'T'), oriented('l2', 'e1', 'F'), oriented('l3', 'e2', 'F'),
        ['loop', 'IFCEDGELOOP((#{l0},#{l1},#{l2},#{l3}))'], ['bound', 'IFCFACEOUTERBOUND(#{loop},.T.)'],
        ['round', 'IFCCYLINDRICALSURFACE(#{frame},100.)'], ['f0', 'IFCADVANCEDFACE((#{bound}),#{round},.T.)'],
        oriented('d0', 'e0', 'F'), ['dl', 'IFCEDGELOOP((#{d0}))'], ['db', 'IFCFACEOUTERBOUND(#{dl},.T.)'], ['dp', 'IFCPLANE(#{frame})'],
        ['f1', 'IFCADVANCEDFACE((#{db}),#{dp},.F.)'],
        oriented('u0', 'e1', 'T'), ['ul', 'IFCEDGELOOP((#{u0}))'], ['ub', 'IFCFACEOUTERBOUND(#{ul},.T.)'], point('top', 0, 0, 300),
        ['uat', 'IFCAXIS2PLACEMENT3D(#{top},$,$)'], ['upl', 'IFCPLANE(#{uat})'], ['f2', 'IFCADVANCEDFACE((#{ub}),#{upl},.T.)'],
        ['shell', 'IFCCLOSEDSHELL((#{f0},#{f1},#{f2}))'], ['item', 'IFCADVANCEDBREP(#{shell})']];
}

const box = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => point(`b${i}`, i & 1 ? 200 : 0, i & 2 ? 100 : 0, i & 4 ? 50 : 0));
const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
const facets = sides.flatMap((side, i) => [[`l${i}`, `IFCPOLYLOOP((${side.map((k) => `#{b${k}}`)}))`],
    [`fb${i}`, `IFCFACEOUTERBOUND(#{l${i}},.T.)`], [`f${i}`, `IFCFACE((#{fb${i}}))`]]);
const extruded = [rectangle, ['solid', 'IFCEXTRUDEDAREASOLID(#{profile},#{frame},#{z},50.)']];
const ofBox = { volume: 200 * 100 * 50 * 1e-9, size: [0.2, 0.1, 0.05] };
const turned = [point('far', 0, 500, 0), ['axis', 'IFCAXIS1PLACEMENT(#{far},#{x})']];

const upright = (name, along) => [[`${name}at`, `IFCPOINTBYDISTANCEEXPRESSION(IFCLENGTHMEASURE(${along.toFixed(6)}),$,$,$,$)`],
    [name, `IFCAXIS2PLACEMENTLINEAR(#{${name}at},$,$)`]];

// The centre line of a road (alignment). Seen from above: a line of 1 m, a clothoid of 0.4 m, and an arc of 0.5 m with a radius
// of 1 m. Its height along the way: a slope, a parabola from 0.5 m to 1.3 m, a circular crest to 1.7 m, and a slope.
const curveSegment = (name, parent, at, slope, length) => [point(`${name}p`, ...at),
    [`${name}d`, `IFCDIRECTION((${Math.cos(slope).toFixed(12)},${Math.sin(slope).toFixed(12)}))`],
    [`${name}f`, `IFCAXIS2PLACEMENT2D(#{${name}p},#{${name}d})`],
    [name, `IFCCURVESEGMENT(.CONTINUOUS.,#{${name}f},IFCLENGTHMEASURE(0.),IFCLENGTHMEASURE(${length.toFixed(9)}),#{${parent}})`]];
const PLAN_MM = 1900, spiral = [1000 + 400 * (1 - 0.004 + 0.2 ** 4 / 216), 400 * (0.2 / 3 - 0.2 ** 3 / 42)];
const planEnd = [spiral[0] + 1000 * (Math.sin(0.7) - Math.sin(0.2)), spiral[1] + 1000 * (Math.cos(0.2) - Math.cos(0.7))];
const [steep, gentle] = [0.2, 0.1].map(Math.atan), crest = 400 / (Math.sin(steep) - Math.sin(gentle));
const crestEnd = 80 + crest * (Math.cos(gentle) - Math.cos(steep)), PARABOLA_MM = 2000 * (0.2 * Math.hypot(1, 0.2) + Math.asinh(0.2));
const SLOPING_MM = 500 + PARABOLA_MM + crest * (steep - gentle) + 200 * Math.hypot(1, 0.1);
const plan = [point('zero', 0, 0), ['right', 'IFCDIRECTION((1.,0.))'], ['flat', 'IFCAXIS2PLACEMENT2D(#{zero},$)'],
    ['one', 'IFCVECTOR(#{right},1.)'], ['level', 'IFCLINE(#{zero},#{one})'], ['ring', 'IFCCIRCLE(#{flat},1000.)'],
    ['spiral', `IFCCLOTHOID(#{flat},${Math.sqrt(400000)})`], ...curveSegment('p1', 'level', [0, 0], 0, 1000),
    ...curveSegment('p2', 'spiral', [1000, 0], 0, 400), ...curveSegment('p3', 'ring', spiral, 0.2, 500),
    ...curveSegment('p4', 'level', planEnd, 0.7, 0),
    ['plan', 'IFCCOMPOSITECURVE((#{p1},#{p2},#{p3},#{p4}),.F.)']];
const gradient = [...plan, ['bowl', 'IFCPOLYNOMIALCURVE(#{flat},(0.,1.),(0.,0.,0.000125),$)'],
    ['hill', `IFCCIRCLE(#{flat},${crest})`], ...curveSegment('h1', 'level', [0, 0], 0, 500),
    ...curveSegment('h2', 'bowl', [500, 0], 0, PARABOLA_MM), ...curveSegment('h3', 'hill', [1300, 80], steep, -crest * (steep - gentle)),
    ...curveSegment('h4', 'level', [1700, crestEnd], gentle, 200 * Math.hypot(1, 0.1)),
    ...curveSegment('h5', 'level', [1900, crestEnd + 20], gentle, 0),
    ['curve', 'IFCGRADIENTCURVE((#{h1},#{h2},#{h3},#{h4},#{h5}),.F.,#{plan},$)']];

// [name of the kind, IFC schemas, statements, expected { volume, size }, representation type (default: SweptSolid)]
export const KINDS = [
    ['extrusion', ['IFC2X3', 'IFC4'], [rectangle, ['item', 'IFCEXTRUDEDAREASOLID(#{profile},#{frame},#{z},50.)']], ofBox],
    ['hollow circle extruded', ['IFC4'], [['profile', 'IFCCIRCLEHOLLOWPROFILEDEF(.AREA.,$,$,100.,20.)'],
        ['item', 'IFCEXTRUDEDAREASOLID(#{profile},#{frame},#{z},500.)']], { volume: Math.PI * 3600 * 500e-9, size: [0.2, 0.2, 0.5] }],
    ['tapered extrusion', ['IFC4'], [rectangle, ['end', 'IFCRECTANGLEPROFILEDEF(.AREA.,$,$,100.,50.)'],
        ['item', 'IFCEXTRUDEDAREASOLIDTAPERED(#{profile},#{frame},#{z},60.,#{end})']],
    { volume: 20 * (20000 + 5000 + 10000) * 1e-9, size: [0.2, 0.1, 0.06] }],
    ['revolved rectangle', ['IFC2X3', 'IFC4'], [rectangle, ...turned,
        ['item', 'IFCREVOLVEDAREASOLID(#{profile},#{frame},#{axis},3.14159265358979)']],
    { volume: 20000 * HALF_TURN * 1e-9, size: [0.2, 1.1, 0.55] }],
    ['revolved hollow circle (elbow)', ['IFC2X3', 'IFC4'], [['profile', 'IFCCIRCLEHOLLOWPROFILEDEF(.AREA.,$,$,100.,10.)'], ...turned,
        ['item', 'IFCREVOLVEDAREASOLID(#{profile},#{frame},#{axis},1.5707963267949)']],
    { volume: Math.PI * 1900 * HALF_TURN / 2 * 1e-9, size: [0.2, 0.6, 0.6] }],
    ['pipe on a polyline', ['IFC2X3', 'IFC4'], [...corner, ['curve', 'IFCPOLYLINE((#{a},#{b},#{c}))'], disk('curve')], mitred],
    ['pipe on a polyline with parameters', ['IFC2X3', 'IFC4'], [...corner, ['curve', 'IFCPOLYLINE((#{a},#{b},#{c}))'],
        disk('curve', '$,0.,2.')], mitred],
    ['pipe on half of a polyline', ['IFC2X3', 'IFC4'], [...corner, ['curve', 'IFCPOLYLINE((#{a},#{b},#{c}))'], disk('curve', '$,0.5,1.')],
        { volume: PIPE * 875, size: [0.875, 0.05, 0.05] }],
    ['pipe on a composite curve', ['IFC2X3', 'IFC4'], [...twoLines, disk('curve')], mitred],
    ['pipe on a composite curve with parameters', ['IFC2X3', 'IFC4'], [...twoLines, disk('curve', '$,0.,2.')], mitred],
    ['hollow pipe on a composite curve with parameters', ['IFC2X3', 'IFC4'], [...twoLines, disk('curve', '20.,0.,2.')],
        { volume: PIPE * (1 - 400 / 625) * 3250, size: [1.775, 1.525, 0.05] }],
    ['pipe on an arc', ['IFC2X3', 'IFC4'], [...bend, disk('arc')], { volume: PIPE * HALF_TURN, size: [0.525, 1.05, 0.05] }],
    ['pipe on half of an arc', ['IFC2X3', 'IFC4'], [...bend, disk('arc', '$,0.,1.5707963267949')],
        { volume: PIPE * HALF_TURN / 2, size: [0.525, 0.525, 0.05] }],
    ['pipe on a line and an arc', ['IFC2X3', 'IFC4'], [...bend, point('start', -1000, 0, 0), ['line', 'IFCPOLYLINE((#{start},#{o}))'],
        ['s1', 'IFCCOMPOSITECURVESEGMENT(.CONTINUOUS.,.T.,#{line})'], ['s2', 'IFCCOMPOSITECURVESEGMENT(.CONTINUOUS.,.T.,#{arc})'],
        ['curve', 'IFCCOMPOSITECURVE((#{s1},#{s2}),.F.)'], disk('curve', '$,0.,4.14159265358979')],
    { volume: PIPE * (1000 + HALF_TURN), size: [1.525, 1.05, 0.05] }],
    ['pipe on an indexed curve', ['IFC4'], [
        ['points', 'IFCCARTESIANPOINTLIST3D(((0.,0.,0.),(1000.,0.,0.),(1500.,500.,0.),(1000.,1000.,0.)))'],
        ['curve', 'IFCINDEXEDPOLYCURVE(#{points},(IFCLINEINDEX((1,2)),IFCARCINDEX((2,3,4))),.F.)'], disk('curve')],
    { volume: PIPE * (1000 + HALF_TURN), size: [1.525, 1.05, 0.05] }],
    ['pipe with rounded corners', ['IFC4'], [...corner, ['curve', 'IFCPOLYLINE((#{a},#{b},#{c}))'],
        ['item', 'IFCSWEPTDISKSOLIDPOLYGONAL(#{curve},25.,$,$,$,200.)']],
    { volume: PIPE * (1550 + 1300 + Math.PI * 100), size: [1.775, 1.525, 0.05] }],
    ['profile along a curve', ['IFC4'], [...bend, rectangle,
        ['item', 'IFCFIXEDREFERENCESWEPTAREASOLID(#{profile},#{frame},#{arc},$,$,#{z})']],
        { volume: 20000 * HALF_TURN * 1e-9, size: [0.55, 1.1, 0.2] }],
    ['sectioned spine', ['IFC2X3', 'IFC4'], [rectangle, point('end', 0, 0, 400), ['spine', 'IFCPOLYLINE((#{o},#{end}))'],
        ['there', 'IFCAXIS2PLACEMENT3D(#{end},$,$)'], ['item', 'IFCSECTIONEDSPINE(#{spine},(#{profile},#{profile}),(#{frame},#{there}))']],
    { volume: 20000 * 400e-9, size: [0.2, 0.1, 0.4] }],
    ['profile along a curve on a plane', ['IFC2X3', 'IFC4'], [...bend, rectangle, ['plane', 'IFCPLANE(#{frame})'],
        ['item', 'IFCSURFACECURVESWEPTAREASOLID(#{profile},#{frame},#{arc},0.,3.14159265358979,#{plane})']],
    { volume: 20000 * HALF_TURN * 1e-9, size: [0.55, 1.1, 0.2] }],
    ['profile along a curve on a wall', ['IFC4'], [...bend, rectangle, ['edge', 'IFCARBITRARYOPENPROFILEDEF(.CURVE.,$,#{arc})'],
        ['wall', 'IFCSURFACEOFLINEAREXTRUSION(#{edge},#{frame},#{z},100.)'],
        ['item', 'IFCSURFACECURVESWEPTAREASOLID(#{profile},#{frame},#{arc},0.,3.14159265358979,#{wall})']],
    { volume: 20000 * HALF_TURN * 1e-9, size: [0.6, 1.2, 0.1] }],
    ['profile along a curve on a cylinder', ['IFC4'], [...bend, rectangle, ['round', 'IFCCYLINDRICALSURFACE(#{at},500.)'],
        ['item', 'IFCSURFACECURVESWEPTAREASOLID(#{profile},#{frame},#{arc},0.,3.14159265358979,#{round})']],
    { volume: 20000 * HALF_TURN * 1e-9, size: [0.6, 1.2, 0.1] }],
    ['sections upright on two lines', ['IFC4X3_ADD2'], [...corner, rectangle, ['curve', 'IFCPOLYLINE((#{a},#{b},#{c}))'],
        ...upright('first', 0), ...upright('last', 1750),
        ['item', 'IFCSECTIONEDSOLIDHORIZONTAL(#{curve},(#{profile},#{profile}),(#{first},#{last}))']],
    { volume: 20000 * 1750e-9, size: [1.75, 0.2, 0.1] }],
    ['sections upright on an arc', ['IFC4X3_ADD2'], [...bend, rectangle, ...upright('first', 0), ...upright('last', HALF_TURN),
        ['item', 'IFCSECTIONEDSOLIDHORIZONTAL(#{arc},(#{profile},#{profile}),(#{first},#{last}))']],
    { volume: 20000 * HALF_TURN * 1e-9, size: [0.6, 1.2, 0.1] }],
    ['pipe on a plan of curve segments', ['IFC4X3_ADD2'], [...plan, disk('plan')],
        { volume: PIPE * PLAN_MM, size: [(planEnd[0] + R * Math.sin(0.7)) / 1e3, (planEnd[1] + R * (1 + Math.cos(0.7))) / 1e3, 0.05] }],
    ['profile along a gradient curve', ['IFC4X3_ADD2'], [...gradient, rectangle,
        ['item', 'IFCFIXEDREFERENCESWEPTAREASOLID(#{profile},#{frame},#{curve},$,$,#{z})']],
    { volume: 20000 * SLOPING_MM * 1e-9, size: [(planEnd[0] + 50 * Math.sin(0.7) + 7.6) / 1e3,
        (planEnd[1] + 50 * (1 + Math.cos(0.7)) + 6.4) / 1e3, (crestEnd + 20 + 199.5) / 1e3] }],
    ['profile along the first line of a gradient curve', ['IFC4X3_ADD2'], [...gradient, rectangle,
        ['item', 'IFCFIXEDREFERENCESWEPTAREASOLID(#{profile},#{frame},#{curve},IFCLENGTHMEASURE(100.),IFCLENGTHMEASURE(400.),#{z})']],
    { volume: 20000 * 300e-9, size: [0.3, 0.1, 0.2] }],
    ['profile along a sloping line and a level one', ['IFC4'], [point('low', 0, 0, 0), point('high', 800, 0, 600),
        point('end', 1800, 0, 600), ['curve', 'IFCPOLYLINE((#{low},#{high},#{end}))'], rectangle,
        ['item', 'IFCFIXEDREFERENCESWEPTAREASOLID(#{profile},#{frame},#{curve},$,$,#{z})']],
    { volume: 20000 * 2000e-9, size: [1.86, 0.1, 0.78] }],
    ['sections upright on a gradient curve', ['IFC4X3_ADD2'], [...gradient, rectangle, ...upright('first', 0), ...upright('last', PLAN_MM),
        ['item', 'IFCSECTIONEDSOLIDHORIZONTAL(#{curve},(#{profile},#{profile}),(#{first},#{last}))']],
    { volume: 20000 * PLAN_MM * 1e-9,
        size: [(planEnd[0] + 100 * Math.sin(0.7)) / 1e3, (planEnd[1] + 100 * (1 + Math.cos(0.7))) / 1e3, (crestEnd + 20 + 100) / 1e3] }],
    ['centre-line profile extruded', ['IFC2X3', 'IFC4'], [...corner, ['line', 'IFCPOLYLINE((#{a},#{b},#{c}))'],
        ['profile', 'IFCCENTERLINEPROFILEDEF(.AREA.,$,#{line},20.)'],
        ['item', 'IFCEXTRUDEDAREASOLID(#{profile},#{frame},#{z},500.)']], { volume: 20 * 3250 * 500e-9, size: [1.76, 1.51, 0.5] }],
    ['asymmetric I-shape extruded', ['IFC2X3'], [point('zero', 0, 0), ['flat', 'IFCAXIS2PLACEMENT2D(#{zero},$)'],
        ['profile', 'IFCASYMMETRICISHAPEPROFILEDEF(.AREA.,$,#{flat},100.,200.,10.,20.,$,60.,15.,$,$)'],
        ['item', 'IFCEXTRUDEDAREASOLID(#{profile},#{frame},#{z},500.)']],
    { volume: (100 * 20 + 60 * 15 + 165 * 10) * 500e-9, size: [0.1, 0.2, 0.5] }],
    ['face with two outer bounds', ['IFC2X3'], [...box, ...facets.filter(([name]) => !/^f[45]$/.test(name)),
        ['f4', 'IFCFACE((#{fb4},#{fb5}))'],
        ['shell', 'IFCCLOSEDSHELL((#{f0},#{f1},#{f2},#{f3},#{f4}))'], ['item', 'IFCFACETEDBREP(#{shell})']], ofBox, 'Brep'],
    ['mapped item', ['IFC2X3', 'IFC4'], [...extruded, ['source', "IFCSHAPEREPRESENTATION(#{context},'Body','SweptSolid',(#{solid}))"],
        ['map', 'IFCREPRESENTATIONMAP(#{frame},#{source})'], ['onto', 'IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,#{o},2.,$)'],
        ['item', 'IFCMAPPEDITEM(#{map},#{onto})']], { volume: 8e-3, size: [0.4, 0.2, 0.1] }, 'MappedRepresentation'],
    ['mapped pipe', ['IFC2X3', 'IFC4'], [...twoLines, ['pipe', 'IFCSWEPTDISKSOLID(#{curve},25.,$,0.,2.)'],
        ['source', "IFCSHAPEREPRESENTATION(#{context},'Body','AdvancedSweptSolid',(#{pipe}))"],
        ['map', 'IFCREPRESENTATIONMAP(#{frame},#{source})'], ['onto', 'IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,#{b},2.,$)'],
        ['item', 'IFCMAPPEDITEM(#{map},#{onto})']],
    { volume: 8 * mitred.volume, size: mitred.size.map((v) => 2 * v) }, 'MappedRepresentation'],
    ['clipped extrusion', ['IFC2X3', 'IFC4'], [...extruded, point('half', 0, 0, 25), ['cut', 'IFCAXIS2PLACEMENT3D(#{half},#{z},#{x})'],
        ['plane', 'IFCPLANE(#{cut})'], ['space', 'IFCHALFSPACESOLID(#{plane},.F.)'],
        ['item', 'IFCBOOLEANCLIPPINGRESULT(.DIFFERENCE.,#{solid},#{space})']], { volume: 0.5e-3, size: [0.2, 0.1, 0.025] }, 'Clipping'],
    ['clipped pipe', ['IFC4'], [...twoLines, ['pipe', 'IFCSWEPTDISKSOLID(#{curve},25.,$,0.,2.)'], point('half', 1000, 0, 0),
        ['cut', 'IFCAXIS2PLACEMENT3D(#{half},#{x},#{y})'], ['plane', 'IFCPLANE(#{cut})'], ['space', 'IFCHALFSPACESOLID(#{plane},.F.)'],
        ['item', 'IFCBOOLEANRESULT(.DIFFERENCE.,#{pipe},#{space})']], { volume: PIPE * 1000, size: [1, 0.05, 0.05] }, 'CSG'],
    ['sphere, as CSG', ['IFC2X3', 'IFC4'], [['ball', 'IFCSPHERE(#{frame},100.)'], ['item', 'IFCCSGSOLID(#{ball})']],
        { volume: 4 / 3 * Math.PI * 1e-3, size: [0.2, 0.2, 0.2] }, 'CSG'],
    ['advanced B-rep with circles', ['IFC4'], cylinder(false), { volume: Math.PI * 3e-3, size: [0.2, 0.2, 0.3] }, 'AdvancedBrep'],
    ['advanced B-rep with B-splines', ['IFC4'], cylinder(true), { volume: Math.PI * 3e-3, size: [0.2, 0.2, 0.3] }, 'AdvancedBrep'],
    ['faceted B-rep', ['IFC2X3', 'IFC4'], [...box, ...facets, ['shell', `IFCCLOSEDSHELL((${sides.map((_, i) => `#{f${i}}`)}))`],
        ['item', 'IFCFACETEDBREP(#{shell})']], ofBox, 'Brep'],
    ['tessellated face set', ['IFC4'], [['points', `IFCCARTESIANPOINTLIST3D((${[0, 1, 2, 3, 4, 5, 6, 7].map((i) =>
        `(${i & 1 ? 200 : 0}.,${i & 2 ? 100 : 0}.,${i & 4 ? 50 : 0}.)`)}))`], ['item', `IFCTRIANGULATEDFACESET(#{points},$,.T.,(${
        sides.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]).map((t) => `(${t.map((k) => k + 1)})`)}),$)`]], ofBox, 'Tessellation'],
    ['extrusion with an opening', ['IFC2X3', 'IFC4'], [rectangle, ['item', 'IFCEXTRUDEDAREASOLID(#{profile},#{frame},#{z},50.)'],
        ['hole', 'IFCRECTANGLEPROFILEDEF(.AREA.,$,$,50.,50.)'], point('under', 0, 0, -10), ['from', 'IFCAXIS2PLACEMENT3D(#{under},$,$)'],
        ['cutter', 'IFCEXTRUDEDAREASOLID(#{hole},#{from},#{z},70.)'],
        ['ob', "IFCSHAPEREPRESENTATION(#{context},'Body','SweptSolid',(#{cutter}))"], ['os', 'IFCPRODUCTDEFINITIONSHAPE($,$,(#{ob}))'],
        ['opening', "IFCOPENINGELEMENT('0$PlantcastKinds0000006',$,'O',$,$,#{place},#{os},$)"],
        ['voids', "IFCRELVOIDSELEMENT('0$PlantcastKinds0000007',$,$,$,#{element},#{opening})"]],
    { volume: (20000 - 2500) * 50e-9, size: [0.2, 0.1, 0.05] }],
];
