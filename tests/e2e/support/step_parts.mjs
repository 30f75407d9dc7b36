// SPDX-License-Identifier: GPL-3.0-or-later
// Small STEP files as text: a cone that Open CASCADE tessellates only as a B-spline surface, an assembly with its parts in
// other files, and files that lack a statement.

const file = (lines) => `ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n` +
    `FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n${lines.join('\n')}\nENDSEC;\nEND-ISO-10303-21;\n`;

// The STEP file states lengths in millimetres.
const HEAD = ["#1=APPLICATION_CONTEXT('automotive design');", "#2=PRODUCT_CONTEXT('',#1,'mechanical');",
    "#5=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');",
    '#10=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#11))GLOBAL_UNIT_ASSIGNED_CONTEXT((#12,#13,#14))' +
    "REPRESENTATION_CONTEXT('',''));", "#11=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-3),#12,'','');",
    '#12=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));', '#13=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));',
    '#14=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());', "#15=AXIS2_PLACEMENT_3D('',#16,#17,#18);",
    "#16=CARTESIAN_POINT('',(0.,0.,0.));", "#17=DIRECTION('',(0.,0.,1.));", "#18=DIRECTION('',(1.,0.,0.));"];
const product = (at, name) => [`#${at}=PRODUCT('${name}','${name}','',(#2));`, `#${at + 1}=PRODUCT_DEFINITION_FORMATION('','',#${at});`,
    `#${at + 2}=PRODUCT_DEFINITION('','',#${at + 1},#5);`, `#${at + 3}=PRODUCT_DEFINITION_SHAPE('','',#${at + 2});`,
    `#${at + 4}=SHAPE_DEFINITION_REPRESENTATION(#${at + 3},#${at + 5});`];

// A cone (funnel) of 45 degrees between two circles with these radii in millimetres. Its seam lies opposite its reference
// direction, which Open CASCADE tessellates only as a B-spline surface.
export const CONE = { small: 21.6535433070866, large: 45.0944881889764 };
export const cone = (name = 'Funnel') => file([...HEAD, ...product(200, name),
    "#205=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#26,#15),#10);", "#26=SHELL_BASED_SURFACE_MODEL('',(#27));",
    "#27=OPEN_SHELL('',(#78));",
    "#78=ADVANCED_FACE('',(#24),#15000,.F.);", "#24=FACE_OUTER_BOUND('',#31,.T.);", "#31=EDGE_LOOP('',(#68,#69,#70,#71));",
    "#68=ORIENTED_EDGE('',*,*,#54,.F.);", "#69=ORIENTED_EDGE('',*,*,#55,.T.);", "#70=ORIENTED_EDGE('',*,*,#51,.T.);",
    "#71=ORIENTED_EDGE('',*,*,#55,.F.);", "#54=EDGE_CURVE('',#47,#47,#42,.T.);", "#55=EDGE_CURVE('',#47,#45,#34,.T.);",
    "#51=EDGE_CURVE('',#45,#45,#40,.T.);", "#47=VERTEX_POINT('',#142);", "#45=VERTEX_POINT('',#136);",
    `#142=CARTESIAN_POINT('',(-51.3622047244094,${CONE.small},0.));`, `#136=CARTESIAN_POINT('',(-74.8031496062992,${CONE.large},0.));`,
    `#42=CIRCLE('',#101,${CONE.small});`, `#40=CIRCLE('',#97,${CONE.large});`, "#34=LINE('',#136,#37);", "#37=VECTOR('',#127,45.);",
    "#127=DIRECTION('',(-0.707106781186547,0.707106781186548,-7.49314599887035E-15));",
    "#101=AXIS2_PLACEMENT_3D('',#144,#123,#124);", "#97=AXIS2_PLACEMENT_3D('',#137,#123,#124);",
    "#144=CARTESIAN_POINT('',(-51.3622047244094,1.13404413564787E-14,0.));",
    "#137=CARTESIAN_POINT('',(-74.8031496062992,1.13404413564787E-14,0.));", "#123=DIRECTION('',(-1.,0.,0.));",
    "#124=DIRECTION('',(0.,-1.,1.04744440165294E-14));", `#15000=CONICAL_SURFACE('',#97,${CONE.large},0.785398163397449);`]);

// Returns an assembly of parts placed 100 mm apart, whose shapes are in other files. files: names of these files as the
// assembly states them; format: the file format that the assembly states for them.
export const assembly = (files, format = 'STEP AP242') => file([...HEAD, ...product(20, 'Line'),
    "#25=SHAPE_REPRESENTATION('',(#15),#10);", "#30=OBJECT_ROLE('mandatory',$);", "#31=DOCUMENT_TYPE('geometry');",
    ...files.flatMap((name, i) => {
        const at = 100 * (i + 1), ref = (k) => `#${at + k}`;
        return [...product(at, `Part ${i + 1}`), `${ref(5)}=SHAPE_REPRESENTATION('',(#15),#10);`,
            `${ref(10)}=DOCUMENT_FILE('${name}','','',#31,'',$);`, `${ref(11)}=APPLIED_DOCUMENT_REFERENCE(${ref(10)},'',(${ref(2)}));`,
            `${ref(12)}=ROLE_ASSOCIATION(#30,${ref(11)});`, `${ref(13)}=DOCUMENT_REPRESENTATION_TYPE('digital',${ref(10)});`,
            `${ref(14)}=PROPERTY_DEFINITION('external definition','',${ref(10)});`,
            `${ref(15)}=REPRESENTATION('document format',(${ref(16)}),#10);`,
            `${ref(16)}=DESCRIPTIVE_REPRESENTATION_ITEM('data format','${format}');`,
            `${ref(17)}=PROPERTY_DEFINITION_REPRESENTATION(${ref(14)},${ref(15)});`,
            `${ref(20)}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('${i}','Place ${i + 1}','',#22,${ref(2)},$);`,
            `${ref(21)}=PRODUCT_DEFINITION_SHAPE('','',${ref(20)});`,
            `${ref(22)}=(REPRESENTATION_RELATIONSHIP('','',${ref(5)},#25)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(${ref(23)})` +
            'SHAPE_REPRESENTATION_RELATIONSHIP());', `${ref(23)}=ITEM_DEFINED_TRANSFORMATION('','',#15,${ref(24)});`,
            `${ref(24)}=AXIS2_PLACEMENT_3D('',${ref(25)},#17,#18);`, `${ref(25)}=CARTESIAN_POINT('',(0.,${100 * i}.,0.));`,
            `${ref(26)}=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(${ref(22)},${ref(21)});`];
    })]);

// Returns the text without the statement that has this number.
export const without = (text, number) => text.replace(new RegExp(`#${number}\\s*=[^;]*;`), '');
