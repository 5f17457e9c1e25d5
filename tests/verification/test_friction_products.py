# SPDX-License-Identifier: BSD-3-Clause
"""What friction costs: products with F beside those of the same scene without it.

A plate, a composite, and bodies of tetrahedra on an obstacle and on each other, dragged aside, each with slip bounds
or coefficients from slip nearly everywhere to stick nearly everywhere. It guards against curvatures that the preconditioner or the
coarse projector does not know, against active sets that turn to anywhere, and against bodies that turn as a whole, as fibres do:
products go up tenfold without any of them.
"""

import statistics
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_decks  # noqa: E402
import harmos_runs as runs  # noqa: E402
import real_bodies  # noqa: E402

# Asked for: with given bounds at most twice the products of contact alone, or 40; by Coulomb's law three times, or 60.
# Rounding errors change counts by a few.
TRESCA, COULOMB = (2.0, 40), (3.0, 60)


def given(bound):
    return {"Law": "Tresca", "Slip bound": bound}


def coulomb(coefficient):
    return {"Coefficient": coefficient}


def plate(friction):
    """Code_Aster's SSNV128, with finer elements."""
    effects = {
        "Obstacle": {"floor": {"Part": "plate/bottom", "Point": [0.0, 0.0, 0.0], "Direction": [0.0, 1.0, 0.0]}},
        "Traction": {
            "top": {"Part": "plate/top", "Density": [0.0, -5e7, 0.0]},
            "left": {"Part": "plate/left", "Density": [15e7, 0.0, 0.0]},
        },
        "Prescribed displacement": {"right": {"Part": "plate/right", "Components": ["x"]}},
    }
    if friction is not None:
        effects["Friction"] = {"rough": {"Contact": "floor"} | friction}
    return harmos_decks.xml(
        "harmos",
        {
            "Model": {"Physics": "plane strain"},
            "Materials": {"steel": {"Young's modulus": 1.3e11, "Poisson's ratio": 0.2}},
            "Bodies": {
                "plate": {
                    "Source": "block",
                    "Size": [0.04, 0.04, 1.0],
                    "Subdomains a side": [8, 8, 1],
                    "Elements a side": [16, 16, 1],
                    "Element": "Q1",
                    "Materials": ["steel"],
                }
            },
            "Effects": effects,
        },
    )


class Products(unittest.TestCase):
    def compare(self, name, frictions, limit, run):
        without = run(None).summary["hessian_applications"]
        most = max(limit[0] * without, limit[1])
        counts = []
        for friction in frictions:
            result = run(friction)
            summary = result.summary
            step = summary["steps"][-1]
            count = summary["hessian_applications"]
            counts.append(count)
            print(
                f"{name}, {friction}: {step['sticking']} stick, {step['slipping']} slip, {count} products "
                f"({without} without), slip error {summary['audit']['slip_error']:.1e}"
            )
            with self.subTest(name, friction=friction):
                self.assertEqual(summary["solver"], "PDAS")
                self.assertEqual(summary["fallbacks"], 0)
                self.assertLessEqual(count, 1.3 * most, result)
        # One of several may be a few over.
        self.assertLessEqual(statistics.median(counts), most)

    def bodies(self, key, frictions, limit):
        with tempfile.TemporaryDirectory() as place:

            def run(friction):
                deck = real_bodies.write_deck(Path(place), key, True, scale=2.0, drag=0.02, friction=friction)
                return runs.solved(self, deck, real_bodies.cut(key, 24), program="harmos")

            self.compare(key, frictions, limit, run)

    def plate(self, frictions, limit):
        with tempfile.TemporaryDirectory() as place:

            def run(friction):
                deck = Path(place) / "plate.xml"
                deck.write_text(plate(friction), encoding="utf-8")
                return runs.solved(self, deck, program="harmos")

            self.compare("plate", frictions, limit, run)

    def composite(self, frictions, limit):
        def run(friction):
            sets = {"Model/Columns": 6, "Model/Rows": 6} | (friction or {})
            return runs.solved(self, runs.COMPOSITE, sets, program="fiber_composite")

        self.compare("composite", frictions, limit, run)

    def test_plate(self):
        self.plate([given(bound) for bound in (1e6, 1e7, 3e7, 1e8)], TRESCA)
        self.plate([coulomb(mu) for mu in (0.3, 1.0, 2.0)], COULOMB)

    def test_composite(self):
        self.composite([{"Model/Slip bound": bound} for bound in (1e-3, 3e-3, 5e-3, 8e-3)], TRESCA)
        self.composite([{"Model/Coefficient of friction": mu} for mu in (0.1, 0.3, 0.6, 1.0)], COULOMB)

    def test_half_ball(self):
        self.bodies("half-ball", [given(bound) for bound in (1e-4, 3e-3, 3e-2)], TRESCA)
        self.bodies("half-ball", [coulomb(mu) for mu in (0.1, 0.6, 3.0)], COULOMB)

    def test_ball_on_block(self):
        self.bodies("ball-on-block", [given(bound) for bound in (1e-4, 3e-3, 3e-2)], TRESCA)
        self.bodies("ball-on-block", [coulomb(mu) for mu in (0.1, 0.6, 3.0)], COULOMB)


class Composite(unittest.TestCase):
    def test_friction_stiffens_fibres(self):
        """From contact alone to ties, the stiffer the more friction; fibres are held, and what slips costs work."""
        moduli, counts = [], []
        for sets in (
            {},
            {"Model/Coefficient of friction": 0.1},
            {"Model/Coefficient of friction": 0.3},
            {"Model/Coefficient of friction": 1.0},
            {"Model/Interface": "tie"},
        ):
            scattered = {"Model/Columns": 5, "Model/Rows": 5, "Model/Volume fraction": 0.3, "Model/Radius scatter": 0.1, "Model/Offset scatter": 0.05}
            result = runs.solved(self, runs.COMPOSITE, scattered | sets, program="fiber_composite")
            moduli.append(result.summary["results"]["effective_modulus"])
            counts.append(result.summary["hessian_applications"])
        print("moduli", [f"{modulus:.6f}" for modulus in moduli], "products", counts)
        for softer, stiffer in zip(moduli, moduli[1:]):
            self.assertLess(softer * (1.0 + 1e-4), stiffer)
        # As in regular composites, with the fifth more that one of several may have.
        self.assertLessEqual(max(counts[1:4]), 1.3 * max(3 * counts[0], 60))


if __name__ == "__main__":
    runs.main()
