// A pipe, 100 mm outside and 84 mm inside, 0.6 m long, with eight round fins of 200 mm, 6 mm thick, 60 mm apart.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0.6, 0, 0, 0.05};
For i In {0:7}
  Cylinder(10 + i) = {0.09 + 0.06 * i - 0.003, 0, 0, 0.006, 0, 0, 0.1};
EndFor
BooleanUnion(30) = { Volume{1}; Delete; }{ Volume{10:17}; Delete; };
Cylinder(40) = {-0.1, 0, 0, 0.8, 0, 0, 0.042};
BooleanDifference(50) = { Volume{30}; Delete; }{ Volume{40}; Delete; };
