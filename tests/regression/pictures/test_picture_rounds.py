# SPDX-License-Identifier: BSD-3-Clause
"""harmos-plot --rounds: estimated errors and meshes of a run whose meshes follow the error, in the plane and in space."""

import subprocess
import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TESTS / "support"), str(TESTS / "verification/finite"), str(TESTS.parent / "apps/tools")]

import harmos_runs as runs  # noqa: E402

try:
    import matplotlib.image
    import numpy as np
    from finite_scenes import deck
except ImportError as error:
    runs.skip(f"{error.name} is not installed")


def block(dimension, adaptivity):
    """Held below, pulled at a half of its top: singular where the load ends, coarse far from it."""
    axis = "xyz"[dimension - 1]
    way = [0.0, 0.01, 0.0] if dimension == 2 else [0.0, 0.0, 0.01]
    tree = {
        "Model": {"Physics": "plane strain" if dimension == 2 else "solid"},
        "Materials": {"m": {"Young's modulus": 1.0}},
        "Bodies": {"block": {"Source": "block", "Elements a side": [3, 3, 3], "Element": "P2", "Materials": ["m"]}},
        "Effects": {"Prescribed displacement": {
            "foot": {"Part": "block/bottom"},
            "head": {"Part": "block/top", "Components": [axis], "Displacement": way}}},
    }
    if adaptivity:
        tree["Adaptivity"] = adaptivity
    return deck(tree)


def plot(directory):
    return subprocess.run(
        [sys.executable, runs.application("harmos-plot"), directory, "--rounds", "--dpi", "60"],
        capture_output=True, text=True, timeout=240)


class Rounds(unittest.TestCase):
    def drawn(self, dimension):
        run = runs.solved(self, block(dimension, {"Rounds": 2, "Target error": 1e-3}), np=2, program="harmos")
        result = plot(run.directory)
        self.assertEqual(result.returncode, 0, result.stderr)
        return Path(run.directory)

    def test_plane(self):
        directory = self.drawn(2)
        picture = matplotlib.image.imread(directory / "rounds.png")
        self.assertGreater(np.std(picture[..., :3]), 0.05)
        # Three meshes below the curve, each with cells of many colours.
        lower = picture[picture.shape[0] // 2:, : int(0.88 * picture.shape[1]), :3]
        for panel in np.array_split(lower, 3, axis=1):
            self.assertGreater(len(np.unique((panel.reshape(-1, 3) * 8).astype(int), axis=0)), 20)

    def test_errors_of_cells_are_the_estimate(self):
        import h5py

        run = runs.solved(self, block(2, {"Rounds": 1, "Target error": 1e-3}), np=2, program="harmos")
        rows = (Path(run.directory) / "rounds.csv").read_text(encoding="utf-8").splitlines()
        last = dict(zip(rows[0].split(","), map(float, rows[-1].split(","))))
        with h5py.File(Path(run.directory) / "result.vtkhdf") as file:
            errors = file["VTKHDF/CellData/estimated_error"][()]
        self.assertEqual(len(errors), last["cells"])
        total = float(np.sqrt(np.sum(errors**2)))
        self.assertAlmostEqual(total / (last["estimated_error"] * last["energy_norm"]), 1.0, delta=1e-6)

    def test_space(self):
        try:
            import vtkmodules  # noqa: F401
        except ImportError:
            self.skipTest("VTK's Python modules are missing")
        picture = matplotlib.image.imread(self.drawn(3) / "rounds.png")
        self.assertGreater(np.std(picture[..., :3]), 0.05)

    def test_other_runs_are_refused(self):
        run = runs.solved(self, block(2, None), np=1, program="harmos")
        result = plot(run.directory)
        self.assertEqual(result.returncode, 2)
        self.assertIn("Adaptivity", result.stderr)


if __name__ == "__main__":
    runs.main()
