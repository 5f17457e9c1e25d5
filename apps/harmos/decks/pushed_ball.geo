// SPDX-License-Identifier: BSD-3-Clause
// The lower half of a ball of radius 1 that touches the plane z = 0 at the origin, finer about there: the part
// "cap" is what may touch.
s = 0.32; c = 1 - Sqrt(1 - s^2); fine = 0.035; coarse = 0.45;
Point(1) = {0, 0, 1, coarse};
Point(2) = {0, 0, 0, fine};
Point(3) = {s, 0, c, fine};
Point(4) = {0, s, c, fine};
Point(5) = {-s, 0, c, fine};
Point(6) = {0, -s, c, fine};
Point(7) = {0, 0, c, fine};
Point(8) = {1, 0, 1, coarse};
Point(9) = {0, 1, 1, coarse};
Point(10) = {-1, 0, 1, coarse};
Point(11) = {0, -1, 1, coarse};
For k In {0:3}
  j = (k + 1) % 4;
  Circle(1 + k) = {2, 1, 3 + k};
  Circle(11 + k) = {3 + k, 7, 3 + j};
  Circle(21 + k) = {3 + k, 1, 8 + k};
  Circle(31 + k) = {8 + k, 1, 8 + j};
EndFor
For k In {0:3}
  j = (k + 1) % 4;
  Curve Loop(1 + k) = {1 + k, 11 + k, -(1 + j)};
  Surface(1 + k) = {1 + k};
  Curve Loop(11 + k) = {21 + k, 31 + k, -(21 + j), -(11 + k)};
  Surface(11 + k) = {11 + k};
EndFor
Curve Loop(21) = {31:34};
Plane Surface(21) = {21};
Surface Loop(1) = {1:4, 11:14, 21};
Volume(1) = {1};
Physical Surface("cap") = {1:4};
Physical Surface("top") = {21};
Physical Volume("ball") = {1};
