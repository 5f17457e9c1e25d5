# SPDX-License-Identifier: BSD-3-Clause
"""harmos-mesh: meshes that are cut once, and read by all ranks.

What it guards against: parts, numbers of nodes or boundary parts that get lost on their way through the file; ranks that
read what is not theirs; files that are damaged, or no meshes, and end in anything but a sentence and exit status 2.
"""

import os
import json
import sys
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402

DECKS = runs.SOURCE / "apps/harmos/decks"

# Two boxes of OpenCASCADE that do not touch, saved as a CAD file without any names.
BOXES = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Box(2) = {0, 0, 1, 1, 1, 0.5};
Mesh.MeshSizeMax = 0.6;
"""

# A cube, and in the same volume a second shell that goes through its faces.
CROSSED = """
Point(1) = {0, 0, 0, 0.5}; Point(2) = {1, 0, 0, 0.5}; Point(3) = {1, 1, 0, 0.5}; Point(4) = {0, 1, 0, 0.5};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
e[] = Extrude {0, 0, 1} { Surface{1}; };
Point(101) = {0.5, 0.5, 0.5, 0.5}; Point(102) = {1.5, 0.5, 0.5, 0.5}; Point(103) = {0.5, 1.5, 0.5, 0.5};
Point(104) = {0.5, 0.5, 1.5, 0.5};
Line(101) = {101, 102}; Line(102) = {102, 103}; Line(103) = {103, 101};
Line(104) = {101, 104}; Line(105) = {102, 104}; Line(106) = {103, 104};
Curve Loop(101) = {101, 102, 103}; Plane Surface(101) = {101};
Curve Loop(102) = {101, 105, -104}; Plane Surface(102) = {102};
Curve Loop(103) = {102, 106, -105}; Plane Surface(103) = {103};
Curve Loop(104) = {103, 104, -106}; Plane Surface(104) = {104};
Delete { Volume{1}; }
Surface Loop(1) = {1, e[0], e[2], e[3], e[4], e[5]}; Surface Loop(2) = {101, 102, 103, 104};
Volume(7) = {1, 2};
"""

# A square of four triangles, by hand.
NODES = ((0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5))
TRIANGLES = ((1, 2, 5), (2, 3, 5), (3, 4, 5), (4, 1, 5))
LEFT = (4, 1)

MSH_2 = "\n".join(
    ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '1 2 "left"', '2 1 "plate"', "$EndPhysicalNames"]
    + ["$Nodes", "5", *(f"{k + 1} {x} {y} 0" for k, (x, y) in enumerate(NODES)), "$EndNodes", "$Elements", "5"]
    + ["1 1 2 2 2 {} {}".format(*LEFT), *("{} 2 2 1 1 {} {} {}".format(k + 2, *t) for k, t in enumerate(TRIANGLES))]
    + ["$EndElements", ""]
)
MSH_4 = "\n".join(
    ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '1 2 "left"', '2 1 "plate"', "$EndPhysicalNames"]
    + ["$Entities", "0 1 1 0", "2 0 0 0 0 1 0 1 2 0", "1 0 0 0 1 1 0 1 1 0", "$EndEntities"]
    + ["$Nodes", "1 5 1 5", "2 1 0 5", *(str(k + 1) for k in range(5)), *(f"{x} {y} 0" for x, y in NODES), "$EndNodes"]
    + ["$Elements", "2 5 1 5", "1 2 1 1", "1 {} {}".format(*LEFT), "2 1 2 4"]
    + ["{} {} {} {}".format(k + 2, *t) for k, t in enumerate(TRIANGLES)]
    + ["$EndElements", ""]
)
VTK = "\n".join(
    ["# vtk DataFile Version 2.0", "a square", "ASCII", "DATASET UNSTRUCTURED_GRID", "POINTS 5 double"]
    + [f"{x} {y} 0" for x, y in NODES]
    + ["CELLS 4 16", *("3 {} {} {}".format(*(node - 1 for node in t)) for t in TRIANGLES), "CELL_TYPES 4"]
    + ["5"] * 4
    + [""]
)


def mesh(*words, cwd=None):
    return runs.start([str(word) for word in words], 0, program="harmos-mesh", cwd=cwd)


def bodies_of(deck):
    """Of each body from a file: its groups and subdomains."""
    found = {}
    for bodies in ElementTree.parse(deck).getroot().findall("ParameterList[@name='Bodies']"):
        for body in bodies.findall("ParameterList"):
            values = {p.get("name"): p.get("value") for p in body.findall("Parameter")}
            groups = values.get("Groups", "{}").strip("{}").replace(" ", "")
            found[body.get("name")] = (groups, int(values.get("Subdomains", 1)))
    return found


class Cut(unittest.TestCase):
    """The same scene from its geometry and from the file of harmos-mesh."""

    def check(self, deck, dimension):
        directory = runs.scratch("cut")
        directory.mkdir()
        tree = ElementTree.parse(deck)
        words = [deck.with_suffix(".geo"), "--output", directory / "mesh.h5", "--dimension", dimension]
        for name, (groups, number) in bodies_of(deck).items():
            words += ["--body", f"{name}={groups}" if groups else name, "--cut", f"{name}={number}"]
        done = mesh(*words)
        self.assertEqual(done.returncode, 0, done)
        for parameter in tree.iter("Parameter"):
            if parameter.get("name") == "Mesh file":
                parameter.set("value", "mesh.h5")
        for body in tree.getroot().find("ParameterList[@name='Bodies']"):
            for parameter in list(body.findall("Parameter")):
                if parameter.get("name") in ("Groups", "Subdomains"):
                    body.remove(parameter)
        tree.write(directory / "deck.xml")
        sets = {"Solver/Tolerance": 1e-8}
        plain = runs.solved(self, deck, sets, program="harmos").summary
        for ranks in (1, 2, 4):
            other = runs.solved(self, directory / "deck.xml", sets, np=ranks, program="harmos").summary
            for key in ("primal_dimension", "dual_dimension", "kernel_dimension", "inequalities", "subdomains"):
                self.assertEqual(other[key], plain[key], key)
            # The same parts and the same defaults, but for rounding.
            self.assertLessEqual(abs(other["hessian_applications"] - plain["hessian_applications"]), 2)
            self.assertLessEqual(abs(other["energy"] / plain["energy"] - 1.0), 10 * 1e-8)
        return directory, plain

    def test_plane_bodies_with_regions_and_ties(self):
        self.check(DECKS / "tied_inclusion.xml", 2)

    def test_quadratic_tetrahedra_on_an_obstacle_and_a_restart(self):
        directory, plain = self.check(DECKS / "punch.xml", 3)
        limit = {"Solver/Tolerance": 1e-8, "Solver/Maximum iterations": 3, "Output/Checkpoint/Outer iterations": 1}
        run = runs.run(directory / "deck.xml", limit, program="harmos")
        self.assertEqual(run.returncode, 1, run)
        words = ["--restart", run.directory, "--quiet", "--set", "Solver/Maximum iterations=100000"]
        again = runs.start(words, 2, program="harmos")
        self.assertEqual(again.returncode, 0, again)
        summary = json.loads((run.directory / "summary.json").read_text(encoding="utf-8"))
        self.assertLessEqual(abs(summary["energy"] / plain["energy"] - 1.0), 10 * 1e-8)

    def test_decks_that_do_not_fit(self):
        directory = runs.scratch("unfit")
        directory.mkdir()
        done = mesh(DECKS / "tied_inclusion.geo", "--output", directory / "mesh.h5", "--dimension", 2)
        self.assertEqual(done.returncode, 0, done)
        run = runs.run(DECKS / "tied_inclusion.xml", {"Model/Mesh file": directory / "nowhere.h5"}, program="harmos")
        self.assertEqual(run.returncode, 2, run)
        self.assertIn("mesh file not found", run.stderr)
        run = runs.run(DECKS / "tied_inclusion.xml", {"Model/Mesh file": directory / "mesh.h5"}, program="harmos")
        self.assertEqual(run.returncode, 2, run)
        self.assertIn("but the mesh file is already partitioned into 1 subdomains", run.stderr)
        for name, value in (("Mesh size", 0.1), ("Mesh order", 2)):
            run = runs.run(DECKS / "tied_inclusion.xml",
                           {"Model/Mesh file": directory / "mesh.h5", f"Model/{name}": value}, program="harmos")
            self.assertEqual(run.returncode, 2, run)
            self.assertIn("have no effect; give them to harmos-mesh (--size, --order)", run.stderr)
        done = mesh(DECKS / "tied_inclusion.geo", "--body", "plate", "--output", directory / "half.h5", "--dimension", 2)
        self.assertEqual(done.returncode, 0, done)
        run = runs.run(DECKS / "tied_inclusion.xml",
                       {"Model/Mesh file": directory / "half.h5", "Bodies/plate/Subdomains": 1}, program="harmos")
        self.assertEqual(run.returncode, 2, run)
        self.assertIn('"Bodies/inclusion": the mesh file has no body of this name', run.stderr)


class Formats(unittest.TestCase):
    def report(self, name, text, *words):
        directory = runs.scratch("format")
        directory.mkdir()
        (directory / name).write_text(text, encoding="utf-8")
        done = mesh(directory / name, "--output", directory / "cut.h5", *words)
        self.assertEqual(done.returncode, 0, done)
        self.assertTrue((directory / "cut.h5").is_file())
        return done.stdout

    def test_meshes(self):
        for name, text in (("two.msh", MSH_2), ("four.msh", MSH_4)):
            printed = self.report(name, text, "--dimension", 2)
            self.assertIn('Body "plate": 5 nodes, 4 cells (triangle of 3 nodes), quality 0.866', printed)
            self.assertIn('part "left": 1 sides', printed)
        self.assertIn("5 nodes, 4 cells (triangle of 3 nodes)", self.report("square.vtk", VTK, "--dimension", 2))

    def test_cad_files(self):
        directory = runs.scratch("cad")
        directory.mkdir()
        (directory / "boxes.geo").write_text(BOXES + f'Save "{directory / "boxes.step"}";\n', encoding="utf-8")
        done = mesh(directory / "boxes.geo")
        self.assertEqual(done.returncode, 0, done)
        done = mesh(directory / "boxes.step", "--output", directory / "boxes.h5", "--subdomains", 6)
        self.assertEqual(done.returncode, 0, done)
        self.assertIn('Body "volume 1"', done.stdout)
        self.assertIn('part "surface 12"', done.stdout)
        # Of twelve faces two look into each other; their neighbours touch along edges.
        self.assertRegex(done.stdout, r"Facing surfaces: volume 1/surface \d+ and volume 2/surface \d+ ")
        self.assertEqual(done.stdout.count("Facing surfaces"), 1, done)

    def test_what_cannot_be_read(self):
        directory = runs.scratch("refused")
        directory.mkdir()
        cases = {
            "ten.msh": (MSH_2.replace("2 2 2 1 1 1 2 5", "2 21 2 1 1 1 2 3 4 5 1 2 3 4 5"), "cells of unsupported type"),
            "mixed.msh": (MSH_2.replace("2 2 2 1 1 1 2 5", "2 3 2 1 1 1 2 3 5"), "cells of different types meet at .* on the same side"),
            "nan.msh": (MSH_2.replace("5 0.5 0.5 0", "5 nan 0.5 0"), "not a finite number"),
            "crossed.geo": (CROSSED, r"cut each other.*use smaller cells \(--size\)"),
            "exit.geo": (BOXES + "Exit;\n", "contains Exit"),
            "empty.msh": ("", "holds no cells"),
            "text.msh": ("no mesh at all\n", "holds no cells|cannot read"),
            # Gmsh does not survive a field with an expression it cannot read.
            "crash.geo": (BOXES + 'Field[1] = MathEval;\nField[1].F = "x > 0 ? 1 : 2";\nBackground Field = 1;\n',
                          "cannot read or mesh|ended the program"),
        }
        for name, (text, said) in cases.items():
            with self.subTest(name):
                (directory / name).write_text(text, encoding="utf-8")
                done = mesh(directory / name, "--dimension", 3 if name.endswith(".geo") else 2)
                self.assertEqual(done.returncode, 2, done)
                self.assertRegex(done.stderr, "(?m)^error: .*(" + said + ")")
        for words, said in (
            ((directory / "nowhere.msh",), "mesh file not found"),
            ((DECKS / "punch.geo", "--output", "mesh.msh"), "does not end with"),
            ((DECKS / "punch.geo", "--cut", "nobody=3", "--output", directory / "m.h5"), "unknown body"),
            ((DECKS / "punch.geo", "--body", "a=block", "--body", "a=block"), "twice"),
            ((DECKS / "punch.geo", "--body", "=block"), "has no body name"),
            (("mesh.h5",), "is already partitioned"),
            ((), "no file given"),
        ):
            done = mesh(*words)
            self.assertEqual(done.returncode, 2, done)
            self.assertIn(said, done.stderr)


if __name__ == "__main__":
    runs.main()
