# SPDX-License-Identifier: BSD-3-Clause
"""Quantities that meshes are adapted for: a displacement, a force, a peak pressure, each against an answer from elsewhere.

What it guards against: an adjoint of another problem than the one that was solved (its value may be right all the same, the
bound is not); bounds that are not kept; a solver that stops before the bound; limits that are passed over; a round that
fails and takes the one before with it.
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
    from finite_scenes import deck, geometry
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

from adaptive_scenes import corner, cylinder  # noqa: E402

RING = """
SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, 2}; Disk(2) = {0, 0, 0, 1}; Rectangle(3) = {0, 0, 0, 2, 2};
BooleanDifference(4) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
BooleanIntersection(5) = { Surface{4}; Delete; }{ Surface{3}; Delete; };
e = 0.001;
x() = Curve In BoundingBox{-e, -e, -e, e, 2 + e, e}; Physical Curve("x") = {x()};
y() = Curve In BoundingBox{-e, -e, -e, 2 + e, e, e}; Physical Curve("y") = {y()};
inner() = Curve In BoundingBox{-e, -e, -e, 1 + e, 1 + e, e}; inner() -= {x()}; inner() -= {y()};
Physical Curve("inner") = {inner()};
outer() = Curve In BoundingBox{-e, -e, -e, 2 + e, 2 + e, e}; outer() -= {x()}; outer() -= {y()}; outer() -= {inner()};
Physical Curve("outer") = {outer()}; Physical Surface("body") = {5};
Mesh.MeshSizeMax = 0.7; Mesh.ElementOrder = 2;
"""


def scene(made, adaptivity):
    mesh, tree = made
    tree["Model"]["Mesh file"] = geometry(mesh)
    tree["Adaptivity"] = {"Rounds": 12, **adaptivity}
    return deck(tree)


def ring():
    """A quarter of a ring under pressure from inside (Lamé)."""
    return RING, {
        "Model": {"Physics": "plane strain"}, "Materials": {"m": {"Young's modulus": 1.0, "Poisson's ratio": 0.3}},
        "Bodies": {"body": {"Materials": ["m"], "Subdomains": 4}},
        "Effects": {
            "Traction": {"p": {"Part": "body/inner", "Pressure": 1e-3}},
            "Prescribed displacement": {
                "x": {"Part": "body/x", "Components": ["x"]}, "y": {"Part": "body/y", "Components": ["y"]}}},
    }


def rounds_of(run):
    with open(Path(run.directory) / "rounds.csv", newline="", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items() if value} for row in csv.DictReader(file)]


class Quantities(unittest.TestCase):
    def rounds(self, made, adaptivity, np=runs.RANKS):
        run = runs.solved(self, scene(made, adaptivity), np=np, program="harmos")
        return run, rounds_of(run)

    def check(self, title, rows, exact, first=0, floor=0.0):
        """Errors within twice their bound, and no bound far too large; from a round on where the mesh resolves the scene."""
        found = []
        for row in rows:
            error = abs(row["quantity"] / exact - 1.0)
            found.append((int(row["cells"]), f"{row['quantity']:.7g}", f"{row['quantity_error']:.2e}", f"{error:.2e}"))
        runs.table(title, ("cells", "value", "bound", "error"), found)
        for row in rows[first:]:
            self.assertLess(abs(row["quantity"] / exact - 1.0), 2.0 * row["quantity_error"] + floor, found)
        self.assertGreater(len(rows), first + 2)

    def test_displacement(self):
        """Of the outer arc along x: the radial displacement, whose mean cosine is 2/π (Lamé, plane strain, b = 2a)."""
        run, rows = self.rounds(ring(), {"Quantity": "displacement", "Of": "body/outer", "Direction": [1.0, 0.0, 0.0],
                                         "Target error": 1e-6})
        a, b, nu, p = 1.0, 2.0, 0.3, 1e-3
        radial = p * a**2 / (b**2 - a**2) * ((1.0 - 2.0 * nu) * b + b**2 / b) * (1.0 + nu)
        self.check("Ring", rows, radial * 2.0 / math.pi)
        self.assertLess(rows[-1]["quantity_error"], 1e-6)
        # The bound is no excuse: ten times the error it is at most, in the mean of all rounds.
        exact = radial * 2.0 / math.pi
        ratios = [math.log(row["quantity_error"] / abs(row["quantity"] / exact - 1.0)) for row in rows]
        self.assertLess(math.exp(sum(ratios) / len(ratios)), 10.0)
        self.assertAlmostEqual(run.summary["results"]["quantity"], rows[-1]["quantity"], delta=1e-8 * exact)

    def test_force(self):
        """Of what holds the corner's foot when its head is moved: the energy is half of force by way, and stationary."""
        mesh, tree = corner(0.5, 2)
        tree["Effects"] = {"Prescribed displacement": {
            "foot": {"Part": "body/held", "Displacement": [0.0, 0.0, 0.0]},
            "head": {"Part": "body/pulled", "Displacement": [0.0, 1e-3, 0.0]}}}
        tight = {"Rounds": 25, "Target error": 2e-3}
        _, fine = self.rounds((mesh, tree), tight)
        # J of the continuous problem: that of the finest mesh, less half the square of its error.
        last = fine[-1]
        energy = last["energy"] - 0.5 * (last["estimated_error"] * last["energy_norm"])**2
        for effect, sign in (("head", 1.0), ("foot", -1.0)):
            _, rows = self.rounds((mesh, tree), {
                "Quantity": "force", "Of": f"Prescribed displacement/{effect}", "Direction": [0.0, 1.0, 0.0],
                "Target error": 1e-4, "Rounds": 20})
            self.check(f"Corner, {effect}", rows, sign * 2.0 * energy / 1e-3, floor=1e-6)
            self.assertLess(rows[-1]["quantity_error"], 1e-4)

    def test_peak_pressure(self):
        """Of a cylinder on a plane: with Hertz' pressures ∫p⁹/∫p⁸ is p₀ B(1/2, 11/2) / B(1/2, 5), p₀ by the force."""
        run, rows = self.rounds(cylinder(0.3, 2), {"Quantity": "peak pressure", "Of": "Obstacle/floor", "Target error": 1e-3,
                                                "Rounds": 20})
        force = abs(run.summary["forces"]["Obstacle/floor"]["force"][1])
        peak = math.sqrt(force / (1.0 - 0.3**2) / math.pi)
        share = math.gamma(5.5) / math.gamma(6.0) * math.gamma(5.5) / math.gamma(5.0)
        # Hertz' half-plane is within (a/R)² = 1e-4 of the cylinder.
        self.check("Peak pressure", rows, peak * share, first=9, floor=1e-3)
        self.assertLess(rows[-1]["quantity_error"], 1e-3)

    def test_contact_force(self):
        """Of the floor, by gaps, and of what presses, by displacements: the same force, and the same bound."""
        bounds = []
        for effect, sign in (("Obstacle/floor", 1.0), ("Prescribed displacement/press", -1.0)):
            _, rows = self.rounds(cylinder(0.3, 2), {"Quantity": "force", "Of": effect, "Direction": [0.0, sign, 0.0],
                                                  "Target error": 1e-3, "Rounds": 20})
            bounds.append([(row["quantity"], row["quantity_error"]) for row in rows[:4]])
        for one, other in zip(*bounds):
            self.assertAlmostEqual(one[0] / other[0], 1.0, delta=2e-3)
            self.assertAlmostEqual(one[1] / other[1], 1.0, delta=2e-2)

    def test_ranks(self):
        """Meshes are the same on any number of ranks, for solutions are to 1e-9, and sizes are rounded to a ninth."""
        mesh, tree = ring()
        tree["Solver"] = {"Tolerance": 1e-9}
        found = [self.rounds((mesh, tree), {"Quantity": "displacement", "Of": "body/outer", "Direction": [1.0, 0.0, 0.0],
                                            "Target error": 1e-5}, np=np)[1] for np in (1, 2, 4)]
        for rows in found[1:]:
            self.assertEqual([row["cells"] for row in rows], [row["cells"] for row in found[0]])
            for row, one in zip(rows, found[0]):
                for key in ("quantity", "quantity_error", "estimated_error", "energy"):
                    self.assertAlmostEqual(row[key] / one[key], 1.0, delta=1e-7)


class Limits(unittest.TestCase):
    def limited(self, mesh, adaptivity, *words):
        run = runs.run(scene((mesh, ring()[1]), {"Target error": 1e-4, **adaptivity}), np=runs.RANKS, program="harmos")
        self.assertEqual(run.returncode, 0, run)
        for word in words:
            self.assertIn(word, run.stderr)
        self.assertEqual(len(rounds_of(run)), 1)
        self.assertTrue((Path(run.directory) / "result.vtkhdf").is_file())
        self.assertFalse((Path(run.directory) / "round_1").exists())
        self.assertEqual(run.summary["converged"], True)

    def test_seconds_and_memory(self):
        """A round that is expected to be too large is not begun; results are those of the one before."""
        self.limited(RING, {"Maximum seconds": 1e-3}, "warning: Round 2 is expected to end after", "answer is that of round 1")
        self.limited(RING, {"Maximum memory": 1.0}, "MiB a rank", "answer is that of round 1")

    def test_mesher_fails(self):
        """A geometry that is there but once: the answer is that of the first round."""
        other = Path(geometry(RING))
        self.limited(f'Merge "{other}";\nSystemCall "mv {other} {other}.gone";\n', {}, "warning: no mesh for another round",
                     "the answer is that of the round before")


class Refusals(unittest.TestCase):
    def refused(self, made, adaptivity, *words):
        run = runs.start([scene(made, adaptivity)], 2, program="harmos")
        self.assertNotEqual(run.returncode, 0)
        for word in words:
            self.assertIn(word, str(run.errors))

    def test_what_is_not_there(self):
        self.refused(ring(), {"Quantity": "force", "Direction": [1.0, 0.0, 0.0]}, "Adaptivity/Of")
        self.refused(ring(), {"Quantity": "force", "Of": "Prescribed displacement/x"}, "Adaptivity/Direction")
        self.refused(ring(), {"Quantity": "force", "Of": "Contact/x", "Direction": [1.0, 0.0, 0.0]}, "Contact/x", "Traction/p")
        self.refused(ring(), {"Quantity": "displacement", "Of": "body/other", "Direction": [1.0, 0.0, 0.0]}, "other")
        self.refused(ring(), {"Quantity": "peak pressure", "Of": "Prescribed displacement/x"}, "no contact pressure")

    def test_friction(self):
        mesh, tree = cylinder(0.3, 2)
        tree["Effects"]["Obstacle"]["floor"]["Coefficient"] = 0.3
        tree["Effects"]["Friction"] = {"rough": {"Contact": "Obstacle/floor", "Coefficient": 0.3}}
        del tree["Effects"]["Obstacle"]["floor"]["Coefficient"]
        self.refused((mesh, tree), {"Quantity": "peak pressure", "Of": "Obstacle/floor"}, "friction")


if __name__ == "__main__":
    runs.main()
