// A wedge between two blocks that lean on each other along x = 0; the wedge's tip is cut off.
// Bodies: left_block, right_block, wedge. Surfaces: bottom, outside (of each block), middle (of each block),
// slope (of each block), slope_left, slope_right, top (of the wedge).
DefineConstant[
  tip = {0.1, Name "Parameters/tip"}   // half the width of the tip's cut
  size = {0.2, Name "Parameters/size"} // of the left block; the others differ, so that nothing matches
];

Point(1) = {-2, 0, 0, size};
Point(2) = {0, 0, 0, size};
Point(3) = {0, 1, 0, size};
Point(4) = {-1, 2, 0, size};
Point(5) = {-2, 2, 0, size};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 1};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};

Point(11) = {2, 0, 0, 0.7 * size};
Point(12) = {0, 0, 0, 0.7 * size};
Point(13) = {0, 1, 0, 0.7 * size};
Point(14) = {1, 2, 0, 0.7 * size};
Point(15) = {2, 2, 0, 0.7 * size};
Line(11) = {11, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Line(14) = {14, 15};
Line(15) = {15, 11};
Curve Loop(2) = {11, 12, 13, 14, 15};
Plane Surface(2) = {2};

Point(21) = {-1, 2, 0, 0.6 * size};
Point(22) = {-tip, 1 + tip, 0, 0.6 * size};
Point(23) = {tip, 1 + tip, 0, 0.6 * size};
Point(24) = {1, 2, 0, 0.6 * size};
Point(25) = {1, 2.5, 0, 0.6 * size};
Point(26) = {-1, 2.5, 0, 0.6 * size};
Line(21) = {21, 22};
Line(22) = {22, 23};
Line(23) = {23, 24};
Line(24) = {24, 25};
Line(25) = {25, 26};
Line(26) = {26, 21};
Curve Loop(3) = {21, 22, 23, 24, 25, 26};
Plane Surface(3) = {3};

Physical Surface("left_block") = {1};
Physical Surface("right_block") = {2};
Physical Surface("wedge") = {3};
Physical Curve("bottom") = {1, 11};
Physical Curve("middle") = {2, 12};
Physical Curve("slope") = {3, 13};
Physical Curve("outside") = {5, 15};
Physical Curve("slope_left") = {21};
Physical Curve("slope_right") = {23};
Physical Curve("top") = {25};
