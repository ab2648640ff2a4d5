// The paper's lower body with its groove cut into the top: depth · (1 − (x/half_width)²)^(3/2) for |x| ≤ half_width; x ≥ 0.
// Body: block. Surfaces: left, right, bottom, top (with the groove).
DefineConstant[
  length = {4, Name "Parameters/length"}
  height = {1, Name "Parameters/height"}
  half_width = {1, Name "Parameters/half_width"}
  depth = {5e-4, Name "Parameters/depth"}
  size = {0.125, Name "Parameters/size"}
];

n = 20;
profile[] = {};
For i In {0 : n}
  x = half_width * i / n;
  Point(10 + i) = {x, height - depth * (1 - (i / n)^2)^1.5, 0, size};
  profile[] += 10 + i;
EndFor
Point(1) = {length, height, 0, size};
Point(2) = {length, 0, 0, size};
Point(3) = {0, 0, 0, size};
Spline(1) = profile[];
Line(2) = {10 + n, 1};
Line(3) = {1, 2};
Line(4) = {2, 3};
Line(5) = {3, 10};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};

Physical Surface("block") = {1};
Physical Curve("top") = {1, 2};
Physical Curve("right") = {3};
Physical Curve("bottom") = {4};
Physical Curve("left") = {5};
