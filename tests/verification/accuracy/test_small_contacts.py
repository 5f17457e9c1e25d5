# SPDX-License-Identifier: BSD-3-Clause
"""Pressures of small contacts in large bodies under load, and stiff bodies on soft springs.

What it guards against: a solver that stops where the residual of the whole load is small, and the forces
of a small contact are wrong by half of themselves; stiff bodies on soft springs that stagnate, or that
lose digits without a word.
"""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402
from harmos_decks import xml  # noqa: E402

try:
    import h5py
    import numpy as np
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

# A plate of 40 in two halves, finer at a slit of 2 in its middle.
SLIT = """
s = 0.2; c = 2;
Point(1) = {{-20, -20, 0, c}}; Point(2) = {{20, -20, 0, c}}; Point(3) = {{20, 0, 0, c}};
Point(4) = {{1, 0, 0, s}}; Point(5) = {{-1, 0, 0, s}}; Point(6) = {{-20, 0, 0, c}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 5}}; Line(5) = {{5, 6}}; Line(6) = {{6, 1}};
Curve Loop(1) = {{1, 2, 3, 4, 5, 6}}; Plane Surface(1) = {{1}};
Point(13) = {{20, 0, 0, c}}; Point(14) = {{1, 0, 0, s * {ratio}}}; Point(15) = {{-1, 0, 0, s * {ratio}}};
Point(16) = {{-20, 0, 0, c}}; Point(17) = {{20, 20, 0, c}}; Point(18) = {{-20, 20, 0, c}};
Line(11) = {{16, 15}}; Line(12) = {{15, 14}}; Line(13) = {{14, 13}}; Line(14) = {{13, 17}}; Line(15) = {{17, 18}};
Line(16) = {{18, 16}};
Curve Loop(2) = {{11, 12, 13, 14, 15, 16}}; Plane Surface(2) = {{2}};
Physical Surface("low") = {{1}}; Physical Surface("up") = {{2}};
Physical Curve("bottom") = {{1}}; Physical Curve("top") = {{15}}; Physical Curve("left") = {{6, 16}};
Physical Curve("right") = {{2, 14}}; Physical Curve("lowin") = {{4}}; Physical Curve("upin") = {{12}};
Physical Curve("lowout") = {{3, 5}}; Physical Curve("upout") = {{11, 13}};
"""


def steel(young):
    return {"m": {"Young's modulus": young, "Poisson's ratio": 0.3}}


def written(name, tree):
    directory = runs.scratch(name)
    directory.mkdir()
    deck = directory / f"{name}.xml"
    deck.write_text(xml("harmos", tree), encoding="utf-8")
    return deck


def slit(pressure, ratio=1, friction=None):
    """Pulled along by 1, pressed across by little."""
    body = {"Subdomains": 8, "Materials": ["m"]}
    effects = {
        "Contact": {"slit": {"First": "low/lowin", "Second": "up/upin"}},
        "Tie": {"rest": {"First": "low/lowout", "Second": "up/upout"}},
        "Traction": {
            "press": {"Part": "up/top", "Density": [0.0, -pressure, 0.0]},
            "low": {"Part": "low/right", "Density": [1.0, 0.0, 0.0]},
            "up": {"Part": "up/right", "Density": [1.0, 0.0, 0.0]},
        },
        "Prescribed displacement": {
            "bottom": {"Part": "low/bottom", "Components": ["y"]},
            "low": {"Part": "low/left", "Components": ["x"]},
            "up": {"Part": "up/left", "Components": ["x"]},
        },
    }
    if friction:
        effects["Friction"] = {"rough": {"Contact": "slit", "Coefficient": friction}}
    deck = written(
        "slit",
        {
            "Model": {"Physics": "plane strain", "Mesh file": "slit.geo"},
            "Materials": steel(1000.0),
            "Bodies": {"low": body, "up": body},
            "Effects": effects,
        },
    )
    (deck.parent / "slit.geo").write_text(SLIT.format(ratio=ratio), encoding="utf-8")
    return deck


def pressures(run):
    """At the nodes of the slit's first side, which beside a tie bears the multipliers, without its ends."""
    with h5py.File(run.directory / "result.vtkhdf", "r") as file:
        x = file["VTKHDF/Points"][()]
        inside = (np.abs(x[:, 1]) < 1e-9) & (np.abs(x[:, 0]) < 0.999) & (file["VTKHDF/PointData/active_set"][()] > 0)
        return file["VTKHDF/PointData/contact_pressure"][()][inside]


class SmallContacts(unittest.TestCase):
    def test_slit(self):
        """The state is homogeneous: the pressure is what presses, at each node."""
        for np_, pressure, friction in ((1, 1e-3, None), (2, 1e-3, None), (2, 1e-2, 0.3)):
            run = runs.solved(self, slit(pressure, friction=friction), np=np_, program="harmos")
            found = pressures(run)
            self.assertGreater(len(found), 7)
            # One part in a hundred is what the acceptance asks of all forces; 0.83 without it.
            np.testing.assert_allclose(found, pressure, rtol=0.04)
            summary = run.summary
            self.assertLess(summary["forces"]["Contact/slit"]["estimated_error"], 0.04)
            self.assertGreaterEqual(
                summary["estimated_errors"]["forces"], summary["forces"]["Contact/slit"]["estimated_error"]
            )
            if pressure < 2e-3:
                self.assertRegex(
                    run.stdout,
                    r'Estimated relative error of the forces of "(Contact/slit|Tie/rest)": \S+, of its largest '
                    r"traction at one node \S+ \(force \S+, all forces \S+\): continue with a smaller tolerance",
                )
                self.assertLess(summary["reached_tolerance"], 2e-5)
            self.assertRegex(run.stdout, r"(?m)^ +x +y +z +moment x +moment y +moment z +est\. error$")

    def test_meshes_that_do_not_match(self):
        """Against a solution to 1e-11."""
        deck = slit(1e-3, ratio=1.3)
        exact = pressures(runs.solved(self, deck, {"Solver/Tolerance": 1e-11}, program="harmos"))
        found = pressures(runs.solved(self, deck, program="harmos"))
        self.assertLess(np.linalg.norm(found - exact), 0.04 * np.linalg.norm(exact))

    def test_large_contacts_stay_as_they_were(self):
        """No decision of the solver depends on the estimate where it is small."""
        run = runs.solved(self, slit(1.0), program="harmos")
        self.assertNotRegex(run.stdout, "[Ee]stimated relative error")
        self.assertGreater(run.summary["reached_tolerance"], 1e-5)


def block(solid, young, effects):
    side = 2
    return written(
        "block",
        {
            "Model": {"Physics": "solid" if solid else "plane strain"},
            "Materials": steel(young),
            "Bodies": {
                "b": {
                    "Source": "block",
                    "Subdomains a side": [side, side, side if solid else 1],
                    "Elements a side": [2, 2, 2],
                    "Materials": ["m"],
                }
            },
            "Effects": effects,
        },
    )


class StiffBodies(unittest.TestCase):
    def test_adhesion(self):
        """The opening is the traction over the stiffness, whatever the body is of."""
        for solid in (False, True):
            down = [0.0, 0.0, 1.0] if solid else [0.0, 1.0, 0.0]
            for young in (1e3, 1e7, 1e9, 1e11):
                deck = block(
                    solid,
                    young,
                    {
                        "Traction": {"pull": {"Part": "b/top", "Density": down}},
                        "Obstacle": {"floor": {"Part": "b/bottom", "Direction": down}},
                        "Adhesion": {
                            "glue": {
                                "Contact": "floor",
                                "Law": "brittle",
                                "Normal stiffness": 20.0,
                                "Tangential stiffness": 40.0,
                                "Normal strength": 10.0,
                                "Tangential strength": 10.0,
                            }
                        },
                    },
                )
                for tolerance in (1e-8, 1e-10):
                    run = runs.solved(self, deck, {"Solver/Tolerance": tolerance}, program="harmos")
                    force = np.linalg.norm(run.summary["forces"]["Obstacle/floor"]["force"])
                    self.assertAlmostEqual(force, 1.0, delta=1e-7)
                    # ½·(1/20), and what the body stores, at most 1/E.
                    self.assertAlmostEqual(run.summary["energy"], -0.025, delta=1.0 / young + 1e-9)
                    if young > 1e10:
                        self.assertIn("Attainable accuracy: spring openings", run.stdout)
                        self.assertGreater(run.summary["attainable_accuracy"], tolerance)

    def test_foundation(self):
        """What rounding errors of the matrix leave is told."""
        for young, is_told in ((1e3, False), (1e11, True)):
            deck = block(
                True,
                young,
                {
                    "Traction": {"press": {"Part": "b/top", "Density": [0.0, 0.0, -1.0]}},
                    "Elastic foundation": {
                        "springs": {"Part": "b/bottom", "Normal stiffness": 10.0, "Tangential stiffness": 10.0}
                    },
                },
            )
            run = runs.solved(self, deck, {"Solver/Tolerance": 1e-8}, program="harmos")
            force = np.array(run.summary["forces"]["Elastic foundation/springs"]["force"])
            wrong = np.linalg.norm(force - [0.0, 0.0, 1.0])
            attainable = run.summary["attainable_accuracy"]
            # An estimate from below: of the condition number, and of what it does.
            self.assertLess(wrong, 100.0 * attainable + 1e-8)
            self.assertEqual("Attainable accuracy: rounding errors of a subdomain's matrix" in run.stdout, is_told)
            self.assertEqual(attainable > 1e-8, is_told)
            # The imbalance is no rounding error of reactions.
            self.assertAlmostEqual(run.summary["audit"]["balance"], 0.5 * wrong, delta=0.5 * wrong + 1e-9)
            self.assertEqual(run.summary["audit"]["balance"] > 1e-8, is_told)


if __name__ == "__main__":
    runs.main()
