// SPDX-License-Identifier: GPL-3.0-or-later
// A building of one storey in IFC, in millimetres: a wall of 4 x 3 x 0.2 m with an opening, and two pumps that share one shape.
const escaped = (text) => text.replace(/'/g, "''")
    .replace(/[^\x20-\x7e]/g, (c) => `\\X2\\${c.charCodeAt(0).toString(16).toUpperCase().padStart(4, '0')}\\X0\\`);

export function ifc(schema = 'IFC4', pumpNames = ['P-101A', '펌프/P-101 B']) {
    const old = schema === 'IFC2X3', lines = [];
    const add = (text) => `#${lines.push(text)}`;
    const guid = (n) => `'0$PlantcastSample00${String(n).padStart(4, '0')}'`;
    const point = (...at) => add(`IFCCARTESIANPOINT((${at.map((v) => v.toFixed(1)).join(',')}))`);
    const axes = (...at) => add(`IFCAXIS2PLACEMENT3D(${point(...at)},$,$)`);
    const person = add("IFCPERSON($,'A',$,$,$,$,$,$)"), firm = add("IFCORGANIZATION($,'A',$,$,$)");
    const both = add(`IFCPERSONANDORGANIZATION(${person},${firm},$)`), program = add(`IFCAPPLICATION(${firm},'1','A','A')`);
    const owner = add(`IFCOWNERHISTORY(${both},${program},$,.ADDED.,$,$,$,0)`);
    const units = ['.LENGTHUNIT.,.MILLI.,.METRE.', '.AREAUNIT.,$,.SQUARE_METRE.', '.VOLUMEUNIT.,$,.CUBIC_METRE.',
        '.PLANEANGLEUNIT.,$,.RADIAN.'].map((unit) => add(`IFCSIUNIT(*,${unit})`));
    const context = add(`IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,${axes(0, 0, 0)},$)`);
    const project = add(`IFCPROJECT(${guid(1)},${owner},'Sample',$,$,$,$,(${context}),${add(`IFCUNITASSIGNMENT((${units.join(',')}))`)})`);
    const place = (above, ...at) => add(`IFCLOCALPLACEMENT(${above},${axes(...at)})`);
    const ground = place('$', 0, 0, 0);
    const site = add(`IFCSITE(${guid(2)},${owner},'Site',$,$,${ground},$,$,.ELEMENT.,$,$,$,$,$)`);
    const building = add(`IFCBUILDING(${guid(3)},${owner},'Pump house',$,$,${ground},$,$,.ELEMENT.,$,$,$)`);
    const storey = add(`IFCBUILDINGSTOREY(${guid(4)},${owner},'Ground floor',$,$,${ground},$,$,.ELEMENT.,0.)`);
    [[project, site], [site, building], [building, storey]].forEach(([a, b], i) =>
        add(`IFCRELAGGREGATES(${guid(10 + i)},${owner},$,$,${a},(${b}))`));
    const box = (x, y, z) => {
        const axis = add(`IFCAXIS2PLACEMENT2D(${point(0, 0)},$)`), up = add('IFCDIRECTION((0.,0.,1.))');
        const profile = add(`IFCRECTANGLEPROFILEDEF(.AREA.,$,${axis},${x.toFixed(1)},${y.toFixed(1)})`);
        return add(`IFCEXTRUDEDAREASOLID(${profile},${axes(0, 0, 0)},${up},${z.toFixed(1)})`);
    };
    const bodyOf = (solid, kind = 'SweptSolid') => add(`IFCSHAPEREPRESENTATION(${context},'Body','${kind}',(${solid}))`);
    const shape = (body) => add(`IFCPRODUCTDEFINITIONSHAPE($,$,(${body}))`);
    const end = old ? '' : ',.STANDARD.', endOpening = old ? '' : ',.OPENING.';
    const wallShape = shape(bodyOf(box(4000, 200, 3000)));
    const wall = add(`IFCWALL(${guid(20)},${owner},'Wall 1',$,$,${place(ground, 2000, 100, 0)},${wallShape},'W1'${end})`);
    const opening = add(`IFCOPENINGELEMENT(${guid(21)},${owner},'Door',$,$,${place(ground, 2000, 100, 0)},${shape(
        bodyOf(box(1000, 400, 2000)))},$${endOpening})`);
    add(`IFCRELVOIDSELEMENT(${guid(22)},${owner},$,$,${wall},${opening})`);
    const map = add(`IFCREPRESENTATIONMAP(${axes(0, 0, 0)},${bodyOf(box(600, 400, 500))})`);
    const operator = add(`IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,${point(0, 0, 0)},1.,$)`);
    const pumps = pumpNames.map((name, i) => {
        const body = shape(bodyOf(add(`IFCMAPPEDITEM(${map},${operator})`), 'MappedRepresentation'));
        return add(`${old ? 'IFCFLOWMOVINGDEVICE' : 'IFCPUMP'}(${guid(30 + i)},${owner},'${escaped(name)}','Feed pump',$,` +
            `${place(ground, 1000 + 2000 * i, 2000, 0)},${body},'${100 + i}'${old ? '' : ',.CIRCULATOR.'})`);
    });
    add(`IFCRELCONTAINEDINSPATIALSTRUCTURE(${guid(40)},${owner},$,$,(${[wall, ...pumps].join(',')}),${storey})`);
    const single = (name, value) => add(`IFCPROPERTYSINGLEVALUE('${name}',$,${value},$)`);
    const set = add(`IFCPROPERTYSET(${guid(41)},${owner},'Pset_PumpCommon',$,(${single('FlowRate', 'IFCREAL(12.5)')},${
        single('Reference', "IFCLABEL('NK 50')")}))`);
    add(`IFCRELDEFINESBYPROPERTIES(${guid(42)},${owner},$,$,(${pumps.join(',')}),${set})`);
    return `ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n` +
        `FILE_NAME('a.ifc','2025-01-01T00:00:00',(''),(''),'','','');\n` +
        `FILE_SCHEMA(('${schema}'));\nENDSEC;\nDATA;\n` +
        `${lines.map((line, i) => `#${i + 1}=${line};`).join('\n')}\nENDSEC;\nEND-ISO-10303-21;\n`;
}
