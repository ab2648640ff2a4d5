// The block of groove.geo in space: z is up, the groove runs along y from 0 to width; x ≥ 0.
// Body: block. Surfaces: left, right (x), front, back (y), bottom, top (with the groove).
DefineConstant[
  length = {4, Name "Parameters/length"}
  width = {1, Name "Parameters/width"}
  height = {1, Name "Parameters/height"}
  half_width = {1, Name "Parameters/half_width"}
  depth = {5e-4, Name "Parameters/depth"}
  size = {0.25, Name "Parameters/size"}
];

n = 20;
profile[] = {};
For i In {0 : n}
  x = half_width * i / n;
  Point(10 + i) = {x, 0, height - depth * (1 - (i / n)^2)^1.5, size};
  profile[] += 10 + i;
EndFor
Point(1) = {length, 0, height, size};
Point(2) = {length, 0, 0, 1.5 * size};
Point(3) = {0, 0, 0, 1.5 * size};
Spline(1) = profile[];
Line(2) = {10 + n, 1};
Line(3) = {1, 2};
Line(4) = {2, 3};
Line(5) = {3, 10};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};
extruded[] = Extrude {0, width, 0} { Surface{1}; }; // the far surface, the volume, then the sides in the loop's order

Physical Volume("block") = {extruded[1]};
Physical Surface("front") = {1};
Physical Surface("back") = {extruded[0]};
Physical Surface("top") = {extruded[2], extruded[3]};
Physical Surface("right") = {extruded[4]};
Physical Surface("bottom") = {extruded[5]};
Physical Surface("left") = {extruded[6]};
