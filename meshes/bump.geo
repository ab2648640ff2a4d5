// A quarter of a block with a spherical bump on top: planes of symmetry x = 0 and y = 0, the bump's top at the origin.
// Body: block. Surfaces: left (x = 0), front (y = 0), bottom, bump.
SetFactory("OpenCASCADE");
DefineConstant[
  radius = {5, Name "Parameters/radius"}   // of the sphere
  rise = {0.4, Name "Parameters/rise"}     // of the bump above the block
  side = {3, Name "Parameters/side"}       // of the quarter
  height = {3, Name "Parameters/height"}   // of the block
  zone = {1, Name "Parameters/zone"}       // of fine facets around the top
  fine = {0.15, Name "Parameters/fine"}
  coarse = {0.9, Name "Parameters/coarse"}
];

Sphere(1) = {0, 0, -radius, radius, 0, Pi / 2, Pi / 2}; // an eighth
Box(2) = {0, 0, -rise - height, side, side, height};
Box(3) = {-radius, -radius, -rise, 3 * radius, 3 * radius, radius};
BooleanIntersection(4) = { Volume{1}; Delete; }{ Volume{3}; Delete; };
BooleanUnion(5) = { Volume{2}; Delete; }{ Volume{4}; Delete; };

e = 1e-4 * side;
bump[] = Surface In BoundingBox {-e, -e, -rise - e, side + e, side + e, e};
flat[] = Surface In BoundingBox {-e, -e, -rise - e, side + e, side + e, -rise + e};
bump[] -= flat[];
left[] = Surface In BoundingBox {-e, -e, -rise - height - e, e, side + e, e};
front[] = Surface In BoundingBox {-e, -e, -rise - height - e, side + e, e, e};
bottom[] = Surface In BoundingBox {-e, -e, -rise - height - e, side + e, side + e, -rise - height + e};
// The sections of the bump lie in the planes of symmetry, not on its surface.
bump[] -= left[];
bump[] -= front[];

Field[1] = Ball;
Field[1].Radius = zone;
Field[1].Thickness = side;
Field[1].VIn = fine;
Field[1].VOut = coarse;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;

Physical Volume("block") = {5};
Physical Surface("bump") = bump[];
Physical Surface("left") = left[];
Physical Surface("front") = front[];
Physical Surface("bottom") = bottom[];
