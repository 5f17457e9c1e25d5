// SPDX-License-Identifier: BSD-3-Clause
// A lug with a hole and a pin through it, in mm: stands for your CAD program. Its last line writes lug.step.
SetFactory("OpenCASCADE");
Box(1) = {-60, -20, -6, 60, 40, 12};
Cylinder(2) = {0, 0, -6, 0, 0, 12, 20};
BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Cylinder(4) = {0, 0, -6, 0, 0, 12, 10};
BooleanDifference(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
Cylinder(6) = {0, 0, -10, 0, 0, 20, 9.9};
Save "lug.step";
