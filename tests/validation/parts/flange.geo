// A welding neck flange: pipe of 114 mm, wall 7 mm, a conical neck, a disc of 230 mm and 24 mm with eight holes of 18 mm on 180 mm.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0.15, 0, 0, 0.057};
Cone(2) = {0.1, 0, 0, 0.05, 0, 0, 0.057, 0.075};
Cylinder(3) = {0.15, 0, 0, 0.024, 0, 0, 0.115};
BooleanUnion(10) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Cylinder(20) = {-0.1, 0, 0, 0.4, 0, 0, 0.05};
For i In {0:7}
  Cylinder(21 + i) = {0.1, 0.09 * Cos(Pi / 8 + i * Pi / 4), 0.09 * Sin(Pi / 8 + i * Pi / 4), 0.2, 0, 0, 0.009};
EndFor
BooleanDifference(40) = { Volume{10}; Delete; }{ Volume{20:28}; Delete; };
