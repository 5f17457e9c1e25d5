// SPDX-License-Identifier: BSD-3-Clause
// The lower half of a ball of radius one about the origin, finest at its lowest point. Surfaces
// are four spherical triangles that meet there and the disc on top.
If (!Exists(scale))
  scale = 1; // of all elements
EndIf
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {0, 1, 0};
Point(4) = {-1, 0, 0};
Point(5) = {0, -1, 0};
Point(6) = {0, 0, -1};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 2};
Circle(5) = {2, 1, 6};
Circle(6) = {3, 1, 6};
Circle(7) = {4, 1, 6};
Circle(8) = {5, 1, 6};
Curve Loop(1) = {-1, 5, -6};
Curve Loop(2) = {-2, 6, -7};
Curve Loop(3) = {-3, 7, -8};
Curve Loop(4) = {-4, 8, -5};
Surface(1) = {1} In Sphere {1};
Surface(2) = {2} In Sphere {1};
Surface(3) = {3} In Sphere {1};
Surface(4) = {4} In Sphere {1};
Curve Loop(5) = {1, 2, 3, 4};
Plane Surface(5) = {5};
Surface Loop(1) = {1, 2, 3, 4, 5};
Volume(1) = {1};
Physical Surface("skin") = {1, 2, 3, 4};
Physical Surface("top") = {5};
Physical Volume("ball") = {1};
// Coarser with the depth below the skin and with the distance from the axis.
Field[1] = MathEval;
Field[1].F = Sprintf("%g * (0.015 + 0.05 * (1 - sqrt(x * x + y * y + z * z)) + 0.031 * (x * x + y * y))", scale);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
