# SPDX-License-Identifier: BSD-3-Clause
"""Adhesion at finite displacements: glued blocks that turn before they are torn apart, a strip that is peeled off.

What it guards against: openings and slips that bodies which but move would have; bonds that lose what they are bound
to where surfaces part; energies of springs and damage that do not add up.
"""

import math
import os
import signal
import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "support")]

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from finite_scenes import block, carried, corner_parts, deck, field, geometry, rotation, steps_of
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

GLUE = {"Contact": "joint", "Fracture energy": 1.0, "Fracture energy II": 1.0}


STRIP = """
    Point(1) = {0, 0, 0}; Point(2) = {6, 0, 0}; Point(3) = {6, 0.1, 0}; Point(4) = {0, 0.1, 0};
    Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
    Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
    Transfinite Curve{1, 3} = 81; Transfinite Curve{2, 4} = 2; Transfinite Surface{1}; Recombine Surface{1};
    Mesh.ElementOrder = 2;
    Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Point("tip") = {1};
    Physical Surface("strip") = {1};
"""


def peeled(steps, way):
    """A strip, 6 long and 0.1 thick, glued to a stiff base but for its first sixth, whose tip is lifted."""
    return deck({
        "Model": {"Physics": "plane strain", "Kinematics": "finite", "Mesh file": geometry(STRIP)},
        "Materials": {
            "thin": {"Young's modulus": 6e3, "Poisson's ratio": 0.0},
            "stiff": {"Young's modulus": 1e6, "Poisson's ratio": 0.0},
        },
        "Bodies": {
            "strip": {"Materials": ["thin"], "Subdomains": 6},
            "base": block([1.0, -1.0], [5.0, 1.0], [2, 1], [7, 2], "Q1", "stiff"),
        },
        "Steps": {"Number": steps, "End time": float(steps)},
        "Solver": {"Tolerance": 1e-6},
        "Effects": {
            "Contact": {"joint": {"First": "strip/bottom", "Second": "base/top"}},
            "Adhesion": {"glue": GLUE | {
                "Normal stiffness": 1e3, "Tangential stiffness": 1e3,
                "Normal strength": 10.0, "Tangential strength": 10.0,
            }},
            "Prescribed displacement": {
                "ground": {"Part": "base/bottom"}, "end": {"Part": "strip/right"},
                "lift": {"Part": "strip/tip", "Components": ["y"], "Displacement": [0.0, way, 0.0]},
            },
        },
    })


class Peel(unittest.TestCase):
    def test_energy_that_flows_to_the_front(self):
        """Of a strip that is bent as an elastica EIκ²/2 and the force P across its section add up to the same along it
        (Rivlin: Paint Technol. 9, 1944, in its steady state): P sin φ + P²/2Eh = G, φ the slope of its end, wherever
        the front is, once a point has broken. 1 %: the strip bends at its front within ten thicknesses."""
        run = runs.solved(self, peeled(30, 1.5), np=runs.RANKS, program="harmos")
        rows = steps_of(run.directory)
        checked = 0
        for row in rows:
            if row["broken"] < 3:
                continue
            checked += 1
            self.assertLess(abs(row["external_work"] - row["energy"] - row["dissipated"]), 2e-3 * row["external_work"])
        self.assertGreater(checked, 3)
        points, u, _ = field(run.directory, "displacement")
        places = points + u
        low, high = (places[np.linalg.norm(points - [0.0, y, 0.0], axis=1) < 1e-9][0] for y in (0.0, 0.1))
        across = (high - low) / np.linalg.norm(high - low)
        force = rows[-1]["Prescribed displacement/lift/fy"]
        flow = force * across[0] + force**2 / (2.0 * 6e3 * 0.1)
        self.assertLess(abs(flow - 1.0), 0.01)
        self.assertGreater(across[0], 0.8)

    def test_on_any_number_of_ranks_and_after_a_restart(self):
        path = peeled(16, 0.8)
        done = {np_: runs.solved(self, path, np=np_, program="harmos").directory for np_ in (1, 2)}
        keys = ("energy", "dissipated", "Prescribed displacement/lift/fy")
        one, two = (steps_of(done[np_]) for np_ in (1, 2))
        self.assertEqual(len(one), len(two))
        for a, b in zip(one, two):
            for key in keys:
                self.assertLess(abs(a[key] - b[key]), 1e-5 * max(1.0, abs(b[key])), key)
        run = runs.Background(path, {}, program="harmos")
        self.assertTrue(run.wait_until(lambda: "Step 12 of" in run.text()))
        os.kill(run.ranks()[0], signal.SIGTERM)
        run.end()
        self.assertIn("--restart", run.text())
        again = runs.start(["--restart", run.directory], 2, program="harmos")
        self.assertEqual(again.returncode, 0, again)
        for name in ("displacement", "damage"):
            self.assertTrue((field(run.directory, name)[1] == field(done[2], name)[1]).all(), name)


CORNERS = {
    f"{body}/p{x}{y}{z}": np.array([x, y, z], float)
    for body, z in (("lower", 0), ("upper", 2)) for x in (0, 1) for y in (0, 1)
}
CUBES = """
    SetFactory("OpenCASCADE");
    Box(1) = {0, 0, 0, 1, 1, 1}; Box(2) = {0, 0, 1, 1, 1, 1};
    Transfinite Curve{1:12} = 4; Transfinite Curve{13:24} = 3;
    Transfinite Surface{:}; Recombine Surface{:}; Transfinite Volume{:};
    Physical Surface("top") = {6}; Physical Surface("bottom") = {11};
    Physical Volume("lower") = {1}; Physical Volume("upper") = {2};
""" + corner_parts(CORNERS)


class Turned(unittest.TestCase):
    """Two glued cubes whose meshes do not match, turned by their corners, then torn apart by these, askew."""

    TURNS, PULLS = 6, 6

    def tear(self, vector, law, pull):
        count = self.TURNS + self.PULLS

        def where(name, place, k):
            torn = np.array(pull) * max(0, k - self.TURNS) / self.PULLS * name.startswith("upper")
            return rotation(np.array(vector) * min(k, self.TURNS) / self.TURNS) @ (place + torn)

        histories, held = carried(CORNERS, count, where)
        energies = {} if law == "brittle" else {"Fracture energy": 4e-4, "Fracture energy II": 8e-4}
        return steps_of(runs.solved(self, deck({
            "Model": {"Physics": "solid", "Kinematics": "finite", "Mesh file": geometry(CUBES)},
            "Materials": {"m": {"Type": "neo-Hookean", "Young's modulus": 10.0, "Poisson's ratio": 0.3}},
            "Bodies": {"lower": {"Materials": ["m"], "Subdomains": 2}, "upper": {"Materials": ["m"], "Subdomains": 2}},
            "Steps": {"Number": count, "End time": float(count), "Histories": histories, "Smallest step": 0.1},
            "Solver": {"Tolerance": 1e-7},
            "Effects": {
                "Contact": {"joint": {"First": "upper/bottom", "Second": "lower/top"}},
                "Adhesion": {"glue": {
                    "Contact": "joint", "Law": law, "Normal stiffness": 30.0, "Tangential stiffness": 20.0,
                    "Normal strength": 0.02, "Tangential strength": 0.02, **energies,
                }},
                "Prescribed displacement": held,
            },
        }), np=runs.RANKS, program="harmos").directory)

    def test_torn_apart_as_if_not_turned(self):
        """By 155° about an axis askew: forces in the turned frame, energies, what is dissipated and how much breaks are the
        same, to ten tolerances; nothing of it while they turn."""
        vector = [2.0, -1.5, 1.0]
        back = rotation(vector).T
        for law, pull in (("bilinear", (0.03, 0.02, 0.03)), ("brittle", (0.04, 0.0, 0.01))):
            still, turned = self.tear([0.0] * 3, law, pull), self.tear(vector, law, pull)
            self.assertGreater(still[-1]["dissipated"], 5e-6)
            self.assertEqual(len(turned), len(still))
            self.assertLess(max(row["energy"] for row in turned[:self.TURNS]), 1e-20)
            scale = max(row["energy"] for row in still)
            force = {
                id(row): np.array([row[f"Contact/joint/f{axis}"] for axis in "xyz"]) for row in (*still, *turned)
            }
            largest = max(np.linalg.norm(value) for value in force.values())
            for a, b in zip(turned[self.TURNS:], still[self.TURNS:]):
                self.assertEqual(a["broken"], b["broken"])
                for key in ("energy", "dissipated"):
                    self.assertLess(abs(a[key] - b[key]), 1e-6 * scale, key)
                self.assertLess(np.linalg.norm(back @ force[id(a)] - force[id(b)]), 1e-6 * largest)


class Kept(unittest.TestCase):
    """What is broken stays so in results, wherever it has gone; where both sides are held glue has nothing to say."""

    def test_broken_points_stay_broken(self):
        def block_of(name, y):
            return block([0.0, y], [4.0, 1.0], [2, 1], [3 if name == "lower" else 4, 2], "Q1", "m")

        run = runs.solved(self, deck({
            "Model": {"Physics": "plane strain", "Kinematics": "finite"},
            "Materials": {"m": {"Type": "neo-Hookean", "Young's modulus": 1.0, "Poisson's ratio": 0.3}},
            "Bodies": {"lower": block_of("lower", 0.0), "upper": block_of("upper", 1.0)},
            "Steps": {"Number": 6, "Smallest step": 0.05},
            "Effects": {
                "Contact": {"joint": {"First": "upper/bottom", "Second": "lower/top", "Reach": 0.1}},
                "Adhesion": {"glue": {
                    "Contact": "joint", "Law": "brittle", "Normal stiffness": 10.0, "Tangential stiffness": 10.0,
                    "Normal strength": 0.01, "Tangential strength": 0.01,
                }},
                "Prescribed displacement": {
                    "ground": {"Part": "lower/bottom"}, "end": {"Part": "lower/right"}, "other": {"Part": "upper/right"},
                    "lift": {"Part": "upper/left", "Components": ["y"], "Displacement": [0.0, 1.2, 0.0]},
                },
            },
        }), np=runs.RANKS, program="harmos")
        broken = [row["broken"] for row in steps_of(run.directory)]
        self.assertEqual(broken, sorted(broken))
        self.assertGreater(broken[-1], 2)
        points, damage, _ = field(run.directory, "damage")
        at = (np.abs(points[:, 1] - 1.0) < 1e-9) & (points[:, 0] < 0.01)
        self.assertEqual(damage[at].max(), 1.0)


if __name__ == "__main__":
    runs.main()
