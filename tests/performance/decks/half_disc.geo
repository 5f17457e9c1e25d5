// SPDX-License-Identifier: BSD-3-Clause
// The lower half of a disc of radius one about the origin, finest at its lowest point.
If (!Exists(scale))
  scale = 1; // of all elements
EndIf
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {0, -1, 0};
Point(4) = {-1, 0, 0};
Circle(1) = {4, 1, 3};
Circle(2) = {3, 1, 2};
Line(3) = {2, 1};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Curve("skin") = {1, 2};
Physical Curve("top") = {3, 4};
Physical Surface("ball") = {1};
Field[1] = MathEval;
Field[1].F = Sprintf("%g * (0.001 + 0.01 * sqrt(x * x + (y + 1) * (y + 1)))", scale);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
