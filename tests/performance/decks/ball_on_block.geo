// SPDX-License-Identifier: BSD-3-Clause
// The lower half of a ball of radius one about the origin, and a block that it touches from above. Their meshes do
// not match; both are finest where they touch.
If (!Exists(scale))
  scale = 1; // of all elements
EndIf
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 1, -Pi/2, 0};
Box(2) = {-0.8, -0.8, -1.6, 1.6, 1.6, 0.6};
top() = Surface In BoundingBox{-1.01, -1.01, -0.01, 1.01, 1.01, 0.01};
bottom() = Surface In BoundingBox{-1.01, -1.01, -1.61, 1.01, 1.01, -1.59};
face() = Surface In BoundingBox{-0.81, -0.81, -1.01, 0.81, 0.81, -0.99};
skin() = Boundary{ Volume{1}; };
skin() -= top();
Physical Surface("skin") = {skin()};
Physical Surface("top") = {top()};
Physical Surface("face") = {face()};
Physical Surface("bottom") = {bottom()};
Physical Volume("ball") = {1};
Physical Volume("block") = {2};
Field[1] = MathEval;
Field[1].F = Sprintf("%g * (0.013 + 0.047 * sqrt(x * x + y * y + (z + 1) * (z + 1)))", scale);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
