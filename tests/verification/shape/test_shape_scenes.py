# SPDX-License-Identifier: BSD-3-Clause
"""The scenes of which the oracle of best shapes speaks, solved by harmos from the decks that it writes.

What it guards against: an oracle of another scene than that of its deck, in loads, in how bodies are held, in the area of a
contact point or the sign of a gap; then nothing that is compared with its optima would say anything.
"""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "oracles"))

import harmos_decks  # noqa: E402
import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np
    from shape_optimum import pressures
    from shape_optimum_checks import on_plane, punch, stacked
    from shape_scene import condense, deck
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

TOLERANCE = 1e-9
# The energy is of second order in the tolerance: rounding alone, over some thousand operations a number.
ENERGY = 1e-11
# Forces are of first order; single points by the root of how many share an error, ten at most, and the condition of F.
POINTS = 100.0 * TOLERANCE


class Scenes(unittest.TestCase):
    def compared(self, scene, subdomains, np_):
        path = runs.scratch("deck").with_suffix(".xml")
        path.write_text(harmos_decks.xml("harmos", deck(scene, subdomains)), encoding="utf-8")
        run = runs.solved(self, path, {"Solver/Tolerance": TOLERANCE}, np=np_, program="harmos")
        contact = condense(scene)
        found = pressures(contact)
        self.assertAlmostEqual(run.summary["energy"] / found.energy, 1.0, delta=ENERGY)
        with h5py.File(run.directory / "result.vtkhdf", "r") as file:
            x = file["VTKHDF/Points"][()][:, :2]
            pressure = file["VTKHDF/PointData/contact_pressure"][()].ravel()
        at = np.linalg.norm(x - contact.x[:, None], axis=2) < 1e-9
        self.assertTrue(at.any(axis=1).all(), "the deck has no node at some contact point")
        shown = np.where(at, pressure, 0.0).max(axis=1)
        np.testing.assert_allclose(shown, found.pressures, rtol=0.0, atol=POINTS * found.peak)

    def test_a_block_on_another(self):
        scene = stacked(stiffer=4.0, down=0.01)
        # They meet after a third of the way.
        scene.gap = 0.003
        self.compared(scene, {"upper": (2, 1), "lower": (1, 2)}, 1)

    def test_a_punch_that_contact_alone_carries(self):
        self.compared(punch(2), {"upper": (2, 2), "lower": (4, 1)}, 2)

    def test_a_block_on_a_plane(self):
        self.compared(on_plane(), {"block": (2, 2)}, 2)


if __name__ == "__main__":
    runs.main()
