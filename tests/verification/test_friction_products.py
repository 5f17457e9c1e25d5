# SPDX-License-Identifier: BSD-3-Clause
"""What friction costs: products with F beside those of the same scene without it.

A plate, a composite, and bodies of tetrahedra on an obstacle and on each other, dragged aside, each with slip bounds
from slip nearly everywhere to stick nearly everywhere. It guards against curvatures that the preconditioner or the
coarse projector does not know, and against active sets that turn to anywhere: products go up tenfold without either.
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

# Asked for: at most twice the products of contact alone, or 40. Rounding errors change counts by a few.
TWICE, FEW = 2.0, 40


def plate(slip_bound):
    """Code_Aster's SSNV128, with finer elements."""
    effects = {
        "Obstacle": {"floor": {"Part": "plate/bottom", "Point": [0.0, 0.0, 0.0], "Direction": [0.0, 1.0, 0.0]}},
        "Traction": {
            "top": {"Part": "plate/top", "Density": [0.0, -5e7, 0.0]},
            "left": {"Part": "plate/left", "Density": [15e7, 0.0, 0.0]},
        },
        "Prescribed displacement": {"right": {"Part": "plate/right", "Components": ["x"]}},
    }
    if slip_bound is not None:
        effects["Friction"] = {"rough": {"Contact": "floor", "Law": "Tresca", "Slip bound": slip_bound}}
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
    def compare(self, name, bounds, run):
        without = run(None).summary["hessian_applications"]
        most = max(TWICE * without, FEW)
        counts = []
        for bound in bounds:
            result = run(bound)
            summary = result.summary
            step = summary["steps"][-1]
            count = summary["hessian_applications"]
            counts.append(count)
            print(
                f"{name}, bound {bound:g}: {step['sticking']} stick, {step['slipping']} slip, {count} products "
                f"({without} without), slip error {summary['audit']['slip_error']:.1e}"
            )
            with self.subTest(name, bound=bound):
                self.assertEqual(summary["solver"], "PDAS")
                self.assertEqual(summary["fallbacks"], 0)
                self.assertLessEqual(count, 1.3 * most, result)
        # One of several may be a few over.
        self.assertLessEqual(statistics.median(counts), most)

    def bodies(self, key):
        with tempfile.TemporaryDirectory() as place:

            def run(bound):
                deck = real_bodies.write_deck(
                    Path(place), key, True, scale=2.0, drag=0.02, friction=None if bound is None else {"Law": "Tresca", "Slip bound": bound}
                )
                return runs.solved(self, deck, real_bodies.cut(key, 24), program="harmos")

            self.compare(key, (1e-4, 3e-3, 3e-2), run)

    def test_plate(self):
        with tempfile.TemporaryDirectory() as place:

            def run(bound):
                deck = Path(place) / "plate.xml"
                deck.write_text(plate(bound), encoding="utf-8")
                return runs.solved(self, deck, program="harmos")

            self.compare("plate", (1e6, 1e7, 3e7, 1e8), run)

    def test_composite(self):
        def run(bound):
            sets = {"Model/Columns": 6, "Model/Rows": 6, "Model/Slip bound": bound or 0.0}
            return runs.solved(self, runs.COMPOSITE, sets, program="fiber_composite")

        self.compare("composite", (1e-3, 3e-3, 5e-3, 8e-3), run)

    def test_half_ball(self):
        self.bodies("half-ball")

    def test_ball_on_block(self):
        self.bodies("ball-on-block")


if __name__ == "__main__":
    runs.main()
