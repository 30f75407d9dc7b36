// A pipe bent back on itself: 100 mm outside, 84 mm inside, legs of 0.8 m whose walls are 100 mm apart.
SetFactory("OpenCASCADE");
Cylinder(1) = {0.1, 0, 0, 0, -0.8, 0, 0.05};
Cylinder(2) = {-0.1, 0, 0, 0, -0.8, 0, 0.05};
Torus(3) = {0, 0, 0, 0.1, 0.05, Pi};
BooleanUnion(10) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Cylinder(4) = {0.1, 0, 0, 0, -0.9, 0, 0.042};
Cylinder(5) = {-0.1, 0, 0, 0, -0.9, 0, 0.042};
Torus(6) = {0, 0, 0, 0.1, 0.042, Pi};
BooleanUnion(20) = { Volume{4}; Delete; }{ Volume{5, 6}; Delete; };
BooleanDifference(30) = { Volume{10}; Delete; }{ Volume{20}; Delete; };
