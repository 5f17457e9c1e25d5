# SPDX-License-Identifier: BSD-3-Clause
"""Meshes that follow the estimated error: a re-entrant corner, and a cylinder on an obstacle.

What it guards against: an estimate that is not the error; sizes that do not follow from it; rounds that end too early or
never; results that are not those of the last mesh; what does not go with it and is taken.
"""

import csv
import math
import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TESTS / "support"), str(TESTS / "verification/finite"), str(TESTS / "performance/adaptive")]

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from finite_scenes import deck, field, geometry
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

from adaptive_scenes import ball, cylinder  # noqa: E402


def fitted(sizes, errors):
    return np.polyfit(np.log(sizes), np.log(errors), 1)[0]


def corner(size, order=1):
    """A square without a quarter, held at one end of the L and pulled at the other."""
    return geometry(f"""
lc = {size!r};
Point(1) = {{0, 0, 0, lc}}; Point(2) = {{1, 0, 0, lc}}; Point(3) = {{1, 1, 0, lc}};
Point(4) = {{-1, 1, 0, lc}}; Point(5) = {{-1, -1, 0, lc}}; Point(6) = {{0, -1, 0, lc}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 5}}; Line(5) = {{5, 6}}; Line(6) = {{6, 1}};
Curve Loop(1) = {{1, 2, 3, 4, 5, 6}}; Plane Surface(1) = {{1}};
Physical Surface("body") = {{1}}; Physical Curve("held") = {{5}}; Physical Curve("pulled") = {{2}};
Mesh.ElementOrder = {order};
""")


def scene(mesh, physics, effects, adaptivity):
    return {
        "Model": {"Physics": physics, "Mesh file": mesh},
        "Materials": {"m": {"Young's modulus": 1.0, "Poisson's ratio": 0.3}},
        "Bodies": {"body": {"Materials": ["m"], "Subdomains": 8}},
        "Solver": {"Tolerance": 1e-9}, "Effects": effects, "Adaptivity": adaptivity,
    }


PULL = {
    "Prescribed displacement": {"end": {"Part": "body/held", "Displacement": [0.0, 0.0, 0.0]}},
    "Traction": {"pull": {"Part": "body/pulled", "Density": [0.0, 1.0, 0.0]}},
}


def rounds_of(run):
    with open(Path(run.directory) / "rounds.csv", newline="", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


class Corner(unittest.TestCase):
    def rounds(self, mesh, adaptivity):
        run = runs.solved(self, deck(scene(mesh, "plane strain", PULL, adaptivity)), np=runs.RANKS, program="harmos")
        return run, rounds_of(run)

    def exact(self):
        """Energy of the body: of a fine mesh, less half the square of its error."""
        _, rows = self.rounds(corner(0.2, 2), {"Rounds": 20, "Target error": 1.5e-3})
        return rows[-1]["energy"] - 0.5 * (rows[-1]["estimated_error"] * rows[-1]["energy_norm"])**2

    def test_rates(self):
        """Error over dofs: as the power −1/2 with linear triangles and −1 with quadratic ones on adapted meshes; on uniform
        ones as λ/2 = 0.27, λ = 0.5445 of the corner of 270° (Williams 1952)."""
        exact = self.exact()
        found = []
        for order, target in ((1, 0.02), (2, 0.004)):
            run, rows = self.rounds(corner(0.4, order), {"Rounds": 20, "Target error": target})
            errors = [math.sqrt(max(0.0, 1.0 - row["energy"] / exact)) for row in rows]
            found += [(order, int(row["cells"]), int(row["dofs"]), f"{row['estimated_error']:.4f}", f"{error:.4f}",
                       f"{row['seconds']:.2f}") for row, error in zip(rows, errors)]
            self.assertLess(rows[-1]["estimated_error"], target)
            late = [k for k in range(len(rows)) if rows[k]["estimated_error"] < 8.0 * target]
            rate = -fitted([rows[k]["dofs"] for k in late], [errors[k] for k in late])
            self.assertTrue(0.8 * order / 2.0 < rate < 1.5 * order / 2.0, (order, rate, found))
            for k in late:
                self.assertTrue((0.7, 0.78)[order - 1] < rows[k]["estimated_error"] / errors[k] < 1.1, (order, rows[k], errors[k]))
            self.assertGreater(len(late), 3)
            # The last round's results are in the directory, those before beside.
            self.assertEqual(run.summary["primal_dimension"], rows[-1]["dofs"])
            self.assertAlmostEqual(run.summary["results"]["estimated_error"], rows[-1]["estimated_error"], delta=1e-9)
            self.assertTrue((Path(run.directory) / "round_1/summary.json").is_file())
            self.assertTrue((Path(run.directory) / "result.vtkhdf").is_file())

        runs.table("Re-entrant corner", ("order", "cells", "dofs", "estimated", "true", "seconds"), found)

    def test_order_that_the_deck_asks_for(self):
        """The meshes of a geometry that asks for that order itself, also once cells are adapted."""
        tree = scene(corner(0.3, 1), "plane strain", PULL, {"Rounds": 2, "Target error": 1e-3})
        tree["Model"]["Mesh order"] = 2
        asked = rounds_of(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
        _, own = self.rounds(corner(0.3, 2), {"Rounds": 2, "Target error": 1e-3})
        for a, b in zip(asked, own):
            self.assertEqual(a["dofs"], b["dofs"])
            self.assertLess(abs(a["energy"] / b["energy"] - 1.0), 1e-8)  # ten times the tolerance

    def test_limit_of_cells(self):
        _, rows = self.rounds(corner(0.3), {"Rounds": 8, "Target error": 0.001, "Maximum cells": 2000})
        self.assertLess(rows[-1]["cells"], 2600)
        self.assertLess(len(rows), 9)


class Contact(unittest.TestCase):
    def test_cylinder(self):
        """Half a cylinder pressed onto a rigid plane: cells become small where it touches, and the force over the width of
        the contact comes to Hertz'."""
        made, tree = cylinder(0.3, 1)
        tree["Model"]["Mesh file"] = geometry(made)
        tree["Adaptivity"] = {"Rounds": 12, "Target error": 0.06}
        run = runs.solved(self, deck(tree), np=runs.RANKS, program="harmos")
        rows = rounds_of(run)
        found = [(int(row["cells"]), int(row["dofs"]), f"{row['estimated_error']:.3f}", f"{row['seconds']:.2f}") for row in rows]
        runs.table("Cylinder on a plane", ("cells", "dofs", "estimated", "seconds"), found)
        self.assertLess(rows[-1]["estimated_error"], 0.06)
        force = abs(run.summary["forces"]["Obstacle/floor"]["force"][1])
        # Johnson: Contact Mechanics, 1985, 4.2: the peak pressure √(FE*/πR), of radius one.
        peak = math.sqrt(force / (1.0 - 0.3**2) / math.pi)
        pressure = field(run.directory, "contact_pressure")[1].max()
        print("force", force, "peak", pressure / peak)
        self.assertLess(abs(pressure / peak - 1.0), 0.05)


class Space(unittest.TestCase):
    def test_rate(self):
        """A ball on a plane, quadratic tetrahedra: as the power −2/3 of the dofs, by the estimate."""
        made, tree = ball(0.4, 2)
        tree["Model"]["Mesh file"] = geometry(made)
        tree["Adaptivity"] = {"Rounds": 12, "Target error": 0.025}
        rows = rounds_of(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
        runs.table("Ball on a plane", ("cells", "dofs", "estimated", "seconds"),
                   [(int(row["cells"]), int(row["dofs"]), f"{row['estimated_error']:.4f}", f"{row['seconds']:.2f}")
                    for row in rows])
        late = [row for row in rows if row["estimated_error"] < 0.2]
        self.assertGreater(len(late), 3)
        rate = -fitted([row["dofs"] for row in late], [row["estimated_error"] for row in late])
        self.assertTrue(0.8 * 2.0 / 3.0 < rate < 1.5 * 2.0 / 3.0, rate)
        # A mesh never has far more cells than were foretold: at most three times those before.
        for one, next_one in zip(rows, rows[1:]):
            self.assertLess(next_one["cells"], 3.6 * one["cells"])


class Steps(unittest.TestCase):
    def test_friction_in_steps(self):
        """Blocks of a deck, the upper one pressed and then pushed: all steps in each round, the mesh by the last one."""
        block = {"Source": "block", "Element": "P2", "Materials": ["m"]}
        tree = {
            "Model": {"Physics": "plane strain"}, "Materials": {"m": {"Young's modulus": 1.0, "Poisson's ratio": 0.3}},
            "Bodies": {"lower": {**block, "Size": [2.0, 1.0, 1.0], "Elements a side": [4, 2, 1]},
                       "upper": {**block, "Origin": [0.5, 1.0, 0.0], "Size": [1.0, 0.5, 1.0], "Elements a side": [2, 1, 1]}},
            "Solver": {"Tolerance": 1e-7},
            "Steps": {"Number": 3, "Histories": {"push": {"Times": [0.0, 0.34, 1.0], "Values": [0.0, 0.0, 1.0]}}},
            "Effects": {
                "Contact": {"joint": {"First": "upper/bottom", "Second": "lower/top"}},
                "Friction": {"rough": {"Contact": "joint", "Law": "Coulomb", "Coefficient": 0.3}},
                "Prescribed displacement": {
                    "ground": {"Part": "lower/bottom", "Displacement": [0.0, 0.0, 0.0]},
                    "press": {"Part": "upper/top", "Components": ["y"], "Displacement": [0.0, -0.01, 0.0],
                              "History": "constant"},
                    "push": {"Part": "upper/top", "Components": ["x"], "Displacement": [0.002, 0.0, 0.0],
                             "History": "push"}}},
            "Adaptivity": {"Rounds": 6, "Target error": 0.03},
        }
        run = runs.solved(self, deck(tree), np=runs.RANKS, program="harmos")
        rows = rounds_of(run)
        runs.table("Friction in steps", ("cells", "estimated", "energy"),
                   [(int(row["cells"]), f"{row['estimated_error']:.4f}", f"{row['energy']:.7g}") for row in rows])
        self.assertLess(rows[-1]["estimated_error"], 0.03)
        self.assertLess(rows[-1]["estimated_error"], 0.5 * rows[0]["estimated_error"])
        with open(Path(run.directory) / "steps.csv", newline="", encoding="utf-8") as file:
            steps = list(csv.DictReader(file))
        self.assertEqual(len(steps), 3)
        # Sliding begins at an edge: friction stays below 0.3 of the pressure in all.
        force = run.summary["forces"]["Contact/joint"]
        self.assertLess(abs(force["tangential"][0]), 0.3 * abs(force["normal"][1]) * (1.0 + 1e-5))
        self.assertGreater(abs(force["tangential"][0]), 0.0)

    def test_blocks_in_space(self):
        block = {"Source": "block", "Element": "P2", "Size": [1.0, 1.0, 1.0], "Elements a side": [2, 2, 2], "Materials": ["m"]}
        tree = scene("", "solid", {
            "Prescribed displacement": {"foot": {"Part": "body/bottom"}},
            "Traction": {"shear": {"Part": "body/top", "Density": [1e-3, 0.0, 0.0]}}}, {"Rounds": 6, "Target error": 0.06})
        tree["Bodies"] = {"body": block}
        run = runs.solved(self, deck(tree), np=runs.RANKS, program="harmos")
        rows = rounds_of(run)
        self.assertLess(rows[-1]["estimated_error"], 0.06)
        force = run.summary["forces"]["Prescribed displacement/foot"]["force"]
        self.assertAlmostEqual(force[0], -1e-3, delta=1e-9)


class Refusals(unittest.TestCase):
    def refused(self, tree, *words):
        run = runs.start([deck(tree)], 2, program="harmos")
        self.assertNotEqual(run.returncode, 0)
        for word in words:
            self.assertIn(word, str(run.errors))

    def test_what_does_not_go_with_it(self):
        tree = scene(corner(0.5), "plane strain", PULL, {"Rounds": 2})
        tree["Model"]["Kinematics"] = "finite"
        self.refused(tree, "Adaptivity", "finite")
        tree = scene(corner(0.5), "plane strain", PULL, {"Rounds": 2})
        tree["Model"]["Mesh file"] = str(runs.SOURCE / "tests/verification/accuracy/none.msh")
        self.refused(tree, "none.msh")
        block = {"Source": "block", "Materials": ["m"]}
        tree = scene("", "plane strain", {"Prescribed displacement": {"end": {"Part": "a/left"}}}, {"Rounds": 2})
        tree["Bodies"] = {"a": {**block, "Element": "P1"}, "b": {**block, "Element": "Q2"}}
        self.refused(tree, "Bodies/b/Element", "order")


if __name__ == "__main__":
    runs.main()
