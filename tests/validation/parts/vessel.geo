// A horizontal vessel with round heads: radius 0.4 m, 1.2 m between the heads, wall 16 mm.
SetFactory("OpenCASCADE");
R = 0.4; L = 1.2; t = 0.016;
Cylinder(1) = {-L/2, 0, 0, L, 0, 0, R};
Sphere(2) = {-L/2, 0, 0, R};
Sphere(3) = {L/2, 0, 0, R};
BooleanUnion(10) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Cylinder(4) = {-L/2, 0, 0, L, 0, 0, R - t};
Sphere(5) = {-L/2, 0, 0, R - t};
Sphere(6) = {L/2, 0, 0, R - t};
BooleanUnion(20) = { Volume{4}; Delete; }{ Volume{5, 6}; Delete; };
BooleanDifference(30) = { Volume{10}; Delete; }{ Volume{20}; Delete; };
