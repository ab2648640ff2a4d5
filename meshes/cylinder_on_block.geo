// NAFEMS: a cylinder (its lower half) on a block; the right half of both, x = 0 is the plane of symmetry.
// Bodies: cylinder, block. Surfaces: contact (cylinder), top (of each), axis (of each), bottom (block).
DefineConstant[
  radius = {50, Name "Parameters/radius"}
  width = {100, Name "Parameters/width"}   // of half the block
  height = {200, Name "Parameters/height"} // of the block
  zone = {12, Name "Parameters/zone"}      // of fine facets and of possible contact
  fine = {0.5, Name "Parameters/fine"}     // size of the facets there
  coarse = {15, Name "Parameters/coarse"}
];

Point(1) = {0, radius, 0, coarse};
Point(2) = {0, 0, 0, fine};
Point(3) = {zone, radius - Sqrt(radius^2 - zone^2), 0, fine};
Point(4) = {radius, radius, 0, coarse};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 1};
Line(4) = {1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

// The block's facets are a little shorter, so that nothing matches.
Point(11) = {0, 0, 0, 0.9 * fine};
Point(12) = {1.2 * zone, 0, 0, 0.9 * fine};
Point(13) = {width, 0, 0, coarse};
Point(14) = {width, -height, 0, coarse};
Point(15) = {0, -height, 0, coarse};
Line(11) = {11, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Line(14) = {14, 15};
Line(15) = {15, 11};
Curve Loop(2) = {11, 12, 13, 14, 15};
Plane Surface(2) = {2};

Physical Surface("cylinder") = {1};
Physical Surface("block") = {2};
Physical Curve("contact") = {1, 2};
Physical Curve("cylinder_top") = {3};
Physical Curve("top") = {11};
Physical Curve("bottom") = {14};
Physical Curve("axis") = {4, 15};
