# SPDX-License-Identifier: BSD-3-Clause
"""Scenes whose meshes follow the error, in both ways: of cells of one size, and adapted.

Each is a function of the size of the cells, relative to that of the first mesh, that gives the text of Gmsh's geometry and
the lists of the deck besides.
"""


def materials(**ratios):
    return {name: {"Young's modulus": value, "Poisson's ratio": 0.3} for name, value in (ratios or {"m": 1.0}).items()}


def cells(size, order):
    """Of the first mesh."""
    return f"Mesh.MeshSizeMax = {size!r}; Mesh.MeshSizeFromPoints = 0; Mesh.MeshSizeFromCurvature = 0; Mesh.ElementOrder = {order};\n"


def corner(size, order):
    """A square without a quarter, held at one end of the L and pulled at the other."""
    mesh = """
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {-1, 1, 0}; Point(5) = {-1, -1, 0};
Point(6) = {0, -1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6}; Plane Surface(1) = {1};
Physical Surface("body") = {1}; Physical Curve("held") = {5}; Physical Curve("pulled") = {2};
""" + cells(size, order)
    return mesh, {
        "Model": {"Physics": "plane strain"}, "Materials": materials(), "Bodies": {"body": {"Materials": ["m"]}},
        "Effects": {
            "Prescribed displacement": {"end": {"Part": "body/held", "Displacement": [0.0, 0.0, 0.0]}},
            "Traction": {"pull": {"Part": "body/pulled", "Density": [0.0, 1.0, 0.0]}}},
    }


def cylinder(size, order):
    """Half a cylinder pressed onto a rigid plane (Hertz): the contact is a hundredth of it."""
    mesh = """
SetFactory("OpenCASCADE");
Disk(1) = {0, 1, 0, 1}; Rectangle(2) = {-2, 1, 0, 4, 2};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
sole() = Curve In BoundingBox{-1.01, -0.01, -0.01, 1.01, 1.01, 0.01};
top() = Curve In BoundingBox{-1.01, 0.99, -0.01, 1.01, 1.01, 0.01};
Physical Surface("body") = {3}; Physical Curve("top") = {top()}; sole() -= {top()}; Physical Curve("sole") = {sole()};
""" + cells(size, order)
    return mesh, {
        "Model": {"Physics": "plane strain"}, "Materials": materials(), "Bodies": {"body": {"Materials": ["m"]}},
        "Effects": {
            "Obstacle": {"floor": {"Part": "body/sole"}},
            "Prescribed displacement": {"press": {"Part": "body/top", "Displacement": [0.0, -2e-4, 0.0]}}},
    }


def ball(size, order):
    """A quarter of half a ball pressed onto a rigid plane (Hertz): the contact is a tenth of it."""
    mesh = """
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 1, 1}; Box(2) = {0, 0, 0, 1, 1, 1};
BooleanIntersection(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
e = 0.01;
all() = Surface In BoundingBox{-e, -e, -e, 1 + e, 1 + e, 1 + e};
top() = Surface In BoundingBox{-e, -e, 1 - e, 1 + e, 1 + e, 1 + e};
x() = Surface In BoundingBox{-e, -e, -e, e, 1 + e, 1 + e};
y() = Surface In BoundingBox{-e, -e, -e, 1 + e, e, 1 + e};
all() -= {top()}; all() -= {x()}; all() -= {y()};
Physical Volume("body") = {3}; Physical Surface("top") = {top()}; Physical Surface("x") = {x()};
Physical Surface("y") = {y()}; Physical Surface("sole") = {all()};
""" + cells(size, order)
    return mesh, {
        "Model": {"Physics": "solid"}, "Materials": materials(), "Bodies": {"body": {"Materials": ["m"]}},
        "Effects": {
            "Obstacle": {"floor": {"Part": "body/sole", "Direction": [0.0, 0.0, 1.0]}},
            "Prescribed displacement": {
                "press": {"Part": "body/top", "Displacement": [0.0, 0.0, -1e-2]},
                "x": {"Part": "body/x", "Components": ["x"]}, "y": {"Part": "body/y", "Components": ["y"]}}},
    }


def punch(size, order):
    """Half a stiff block with sharp corners on a soft, wider one."""
    mesh = """
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 0.25, 0.25}; Rectangle(2) = {0, -1, 0, 1, 1};
e = 0.001;
Physical Surface("punch") = {1}; Physical Surface("base") = {2};
press() = Curve In BoundingBox{-e, 0.25 - e, -e, 0.25 + e, 0.25 + e, e}; Physical Curve("press") = {press()};
sole() = Curve In BoundingBox{-e, -e, -e, 0.25 + e, e, e}; Physical Curve("sole") = {sole()};
seat() = Curve In BoundingBox{-e, -e, -e, 1 + e, e, e}; seat() -= {sole()}; Physical Curve("seat") = {seat()};
bed() = Curve In BoundingBox{-e, -1 - e, -e, 1 + e, -1 + e, e}; Physical Curve("bed") = {bed()};
above() = Curve In BoundingBox{-e, -e, -e, e, 1, e}; Physical Curve("above") = {above()};
below() = Curve In BoundingBox{-e, -1 - e, -e, e, e, e}; Physical Curve("below") = {below()};
""" + cells(size, order)
    return mesh, {
        "Model": {"Physics": "plane strain"}, "Materials": materials(soft=1.0, hard=10.0),
        "Bodies": {"punch": {"Materials": ["hard"]}, "base": {"Materials": ["soft"]}},
        "Effects": {
            "Contact": {"joint": {"First": "punch/sole", "Second": "base/seat"}},
            "Prescribed displacement": {
                "press": {"Part": "punch/press", "Displacement": [0.0, -1e-2, 0.0]},
                "bed": {"Part": "base/bed", "Displacement": [0.0, 0.0, 0.0]},
                "above": {"Part": "punch/above", "Components": ["x"]},
                "below": {"Part": "base/below", "Components": ["x"]}}},
    }


def fibre(size, order):
    """A quarter of a square of matrix with a stiffer fibre in its hole, pulled at one side: they part there."""
    mesh = """
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 1, 1}; Disk(2) = {0, 0, 0, 0.5};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
e = 0.001;
hole() = Curve In BoundingBox{-e, -e, -e, 0.5 + e, 0.5 + e, e}; Physical Curve("hole") = {hole()};
left() = Curve In BoundingBox{-e, -e, -e, e, 1 + e, e}; Physical Curve("left") = {left()};
below() = Curve In BoundingBox{-e, -e, -e, 1 + e, e, e}; Physical Curve("below") = {below()};
right() = Curve In BoundingBox{1 - e, -e, -e, 1 + e, 1 + e, e}; Physical Curve("right") = {right()};
Disk(4) = {0, 0, 0, 0.5}; Rectangle(5) = {0, 0, 0, 1, 1};
BooleanIntersection(6) = { Surface{4}; Delete; }{ Surface{5}; Delete; };
all() = Curve In BoundingBox{-e, -e, -e, 0.5 + e, 0.5 + e, e}; all() -= {hole()};
inner() = Curve In BoundingBox{-e, -e, -e, e, 0.5 + e, e}; inner() -= {left()}; Physical Curve("inner") = {inner()};
lower() = Curve In BoundingBox{-e, -e, -e, 0.5 + e, e, e}; lower() -= {below()}; Physical Curve("lower") = {lower()};
all() -= {inner()}; all() -= {lower()}; all() -= {left()}; all() -= {below()}; Physical Curve("skin") = {all()};
Physical Surface("fibre") = {6}; Physical Surface("matrix") = {3};
""" + cells(size, order)
    return mesh, {
        "Model": {"Physics": "plane strain"}, "Materials": materials(soft=1.0, hard=10.0),
        "Bodies": {"fibre": {"Materials": ["hard"]}, "matrix": {"Materials": ["soft"]}},
        "Effects": {
            "Contact": {"joint": {"First": "fibre/skin", "Second": "matrix/hole"}},
            "Prescribed displacement": {
                "left": {"Part": "matrix/left", "Components": ["x"]},
                "below": {"Part": "matrix/below", "Components": ["y"]},
                "inner": {"Part": "fibre/inner", "Components": ["x"]},
                "lower": {"Part": "fibre/lower", "Components": ["y"]},
                "right": {"Part": "matrix/right", "Components": ["x"], "Displacement": [1e-2, 0.0, 0.0]}}},
    }


def lug(size, order):
    """Half of the lug of docs/examples/lug and its pin, which is 0.2 mm thinner than the hole and pulls with 20 kN."""
    mesh = """
SetFactory("OpenCASCADE");
Box(1) = {-60, 0, 0, 60, 20, 6}; Cylinder(2) = {0, 0, 0, 0, 0, 6, 20, Pi};
BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Cylinder(4) = {0, 0, -1, 0, 0, 20, 10};
BooleanDifference(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
Cylinder(6) = {0, 0, 0, 0, 0, 10, 9.9, Pi};
e = 0.01;
Physical Volume("lug") = {5}; Physical Volume("pin") = {6};
root() = Surface In BoundingBox{-60 - e, -e, -e, -60 + e, 20 + e, 6 + e}; Physical Surface("root") = {root()};
pins() = Surface In BoundingBox{-9.9 - e, -e, -e, 9.9 + e, 9.9 + e, 10 + e};
end() = Surface In BoundingBox{-9.9 - e, -e, 10 - e, 9.9 + e, 9.9 + e, 10 + e}; Physical Surface("end") = {end()};
foot() = Surface In BoundingBox{-9.9 - e, -e, -e, 9.9 + e, 9.9 + e, e}; Physical Surface("foot") = {foot()};
axis() = Surface In BoundingBox{-9.9 - e, -e, -e, 9.9 + e, e, 10 + e}; Physical Surface("axis") = {axis()};
pins() -= {end()}; pins() -= {foot()}; pins() -= {axis()}; Physical Surface("shank") = {pins()};
hole() = Surface In BoundingBox{-10 - e, -e, -e, 10 + e, 10 + e, 6 + e};
base() = Surface In BoundingBox{-60 - e, -e, -e, 20 + e, 20 + e, e}; base() -= {foot()};
Physical Surface("base") = {base()};
middle() = Surface In BoundingBox{-60 - e, -e, -e, 20 + e, e, 6 + e}; middle() -= {axis()};
Physical Surface("middle") = {middle()};
hole() -= {base()}; hole() -= {middle()}; hole() -= {pins()}; hole() -= {foot()}; hole() -= {axis()};
Physical Surface("hole") = {hole()};
""" + cells(size, order)
    return mesh, {
        "Model": {"Physics": "solid"}, "Materials": {"steel": {"Young's modulus": 210000.0, "Poisson's ratio": 0.3}},
        "Bodies": {"lug": {"Materials": ["steel"]}, "pin": {"Materials": ["steel"]}},
        "Effects": {
            "Contact": {"bearing": {"First": "lug/hole", "Second": "pin/shank"}},
            "Prescribed displacement": {
                "wall": {"Part": "lug/root", "Displacement": [0.0, 0.0, 0.0]},
                "middle": {"Part": "lug/middle", "Components": ["y"]}, "base": {"Part": "lug/base", "Components": ["z"]},
                "axis": {"Part": "pin/axis", "Components": ["y"]}, "foot": {"Part": "pin/foot", "Components": ["z"]},
                "guide": {"Part": "pin/end", "Components": ["y", "z"]}},
            "Traction": {"pull": {"Part": "pin/end", "Density": [32.6, 0.0, 0.0]}}},
    }


def fibre_in_space(size, order):
    """A quarter of a brick of matrix with a stiffer fibre through it, pulled at one side: they part there."""
    mesh = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 0.5}; Cylinder(2) = {0, 0, 0, 0, 0, 0.5, 0.5, Pi / 2};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
e = 0.001;
left() = Surface In BoundingBox{-e, -e, -e, e, 1 + e, 0.5 + e}; Physical Surface("left") = {left()};
below() = Surface In BoundingBox{-e, -e, -e, 1 + e, e, 0.5 + e}; Physical Surface("below") = {below()};
right() = Surface In BoundingBox{1 - e, -e, -e, 1 + e, 1 + e, 0.5 + e}; Physical Surface("right") = {right()};
base() = Surface In BoundingBox{-e, -e, -e, 1 + e, 1 + e, e}; Physical Surface("base") = {base()};
hole() = Surface In BoundingBox{-e, -e, -e, 0.5 + e, 0.5 + e, 0.5 + e}; Physical Surface("hole") = {hole()};
Cylinder(4) = {0, 0, 0, 0, 0, 0.5, 0.5, Pi / 2};
inner() = Surface In BoundingBox{-e, -e, -e, e, 0.5 + e, 0.5 + e}; inner() -= {left()}; Physical Surface("inner") = {inner()};
lower() = Surface In BoundingBox{-e, -e, -e, 0.5 + e, e, 0.5 + e}; lower() -= {below()}; Physical Surface("lower") = {lower()};
foot() = Surface In BoundingBox{-e, -e, -e, 0.5 + e, 0.5 + e, e}; foot() -= {base()}; Physical Surface("foot") = {foot()};
end() = Surface In BoundingBox{-e, -e, 0.5 - e, 0.5 + e, 0.5 + e, 0.5 + e};
skin() = Surface In BoundingBox{-e, -e, -e, 0.5 + e, 0.5 + e, 0.5 + e};
skin() -= {hole()}; skin() -= {inner()}; skin() -= {lower()}; skin() -= {foot()}; skin() -= {end()};
Physical Surface("skin") = {skin()}; Physical Volume("fibre") = {4}; Physical Volume("matrix") = {3};
""" + cells(size, order)
    _, tree = fibre(size, order)
    tree["Model"]["Physics"] = "solid"
    tree["Effects"]["Prescribed displacement"].update({
        "base": {"Part": "matrix/base", "Components": ["z"]}, "foot": {"Part": "fibre/foot", "Components": ["z"]}})
    return mesh, tree


class Scene:
    """A scene, with the size of its first mesh; by order of the elements five sizes, five targets, and the reference's."""

    def __init__(self, describe, size, sizes, targets, finest):
        self.describe, self.size, self.sizes, self.targets, self.finest = describe, size, sizes, targets, finest

    def make(self, order=2):
        return self.describe(self.size, order)


SCENES = {
    "corner": Scene(corner, 0.5, {2: (0.1, 0.05, 0.025, 0.0125, 0.00625)}, {2: (0.08, 0.04, 0.02, 0.01, 0.005)}, {2: 5e-4}),
    "cylinder": Scene(cylinder, 0.3, {2: (0.02, 0.01, 0.0075, 0.005, 0.0035)}, {2: (0.08, 0.04, 0.02, 0.01, 0.005)},
                      {2: 5e-4}),
    "punch": Scene(punch, 0.25, {2: (0.05, 0.025, 0.0125, 0.00625, 0.004)}, {2: (0.08, 0.04, 0.02, 0.01, 0.005)}, {2: 5e-4}),
    "fibre": Scene(fibre, 0.4, {1: (0.05, 0.025, 0.0125, 0.00625, 0.004), 2: (0.2, 0.1, 0.05, 0.025, 0.0125)},
                   {1: (0.04, 0.02, 0.014, 0.01, 0.007), 2: (0.04, 0.02, 0.01, 0.005, 0.0025)}, {1: 2e-3, 2: 2e-4}),
    "fibre in space": Scene(fibre_in_space, 0.4, {2: (0.2, 0.15, 0.1, 0.075, 0.05)}, {2: (0.04, 0.02, 0.014, 0.01, 0.007)},
                            {2: 3e-3}),
    "ball": Scene(ball, 0.4, {2: (0.15, 0.1, 0.07, 0.05, 0.04)}, {2: (0.1, 0.05, 0.03, 0.02, 0.01)}, {2: 5e-3}),
    "lug": Scene(lug, 8.0, {2: (6.0, 4.0, 3.0, 2.0, 1.5)}, {2: (0.1, 0.05, 0.03, 0.02, 0.01)}, {2: 5e-3}),
}
