// SPDX-License-Identifier: BSD-3-Clause
// A quarter of a shaft (triangles) and of the ring around it (quadrilaterals). Each has its own circle of
// radius a: they are two bodies whose meshes do not match.
a = 1; b = 2; h = 0.15;
Point(1) = {0, 0, 0, h};
Point(2) = {a, 0, 0, h};
Point(3) = {0, a, 0, h};
Line(1) = {1, 2};
Circle(2) = {2, 1, 3};
Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};

Point(12) = {a, 0, 0, h};
Point(13) = {0, a, 0, h};
Point(14) = {b, 0, 0, h};
Point(15) = {0, b, 0, h};
Circle(12) = {12, 1, 13};
Line(13) = {13, 15};
Circle(14) = {14, 1, 15};
Line(15) = {12, 14};
Curve Loop(2) = {15, 14, -13, -12};
Plane Surface(2) = {2};
Transfinite Curve {12, 14} = 17;
Transfinite Curve {13, 15} = 9;
Transfinite Surface {2} = {12, 14, 15, 13};
Recombine Surface {2};

Physical Curve("outer") = {2};
Physical Curve("inner") = {12};
Physical Curve("x0") = {3, 13};
Physical Curve("y0") = {1, 15};
Physical Surface("shaft") = {1};
Physical Surface("ring") = {2};
Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 0;
