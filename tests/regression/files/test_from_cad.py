# SPDX-License-Identifier: BSD-3-Clause
"""docs/from_cad.md does what it says: its commands, as they stand there, lead from a CAD file to pressures.

What it guards against: commands that no longer run, more of them than a new user will type, forces that do not reach the other body, pressures where there is no contact.
"""

import json
import math
import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "apps" / "tools"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np
    import vtkmodules  # noqa: F401

    import run_results
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

PAGE = runs.SOURCE / "docs/from_cad.md"
EXAMPLE = runs.SOURCE / "docs/examples/lug"
MOST_COMMANDS = 10
TRACTION, RADIUS = 32.6, 9.9  # on the pin's two ends


class FromCad(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        text = PAGE.read_text(encoding="utf-8")
        cls.blocks = re.findall(r"```sh\n(.*?)```", text, re.S)
        cls.directory = runs.scratch("cad")
        shutil.copytree(EXAMPLE, cls.directory / "docs/examples/lug")
        (cls.directory / "build").mkdir()
        (cls.directory / "build/bin").symlink_to(runs.BINARY / "bin")
        cls.done = subprocess.run(
            ["bash", "-e", "-c", "".join(cls.blocks)], cwd=cls.directory, env={**os.environ, **runs.environment()},
            capture_output=True, text=True, timeout=240,
        )
        cls.place = cls.directory / "docs/examples/lug"

    def test_commands(self):
        lines = "".join(self.blocks).replace("\\\n", " ").strip().splitlines()
        self.assertLessEqual(len(lines), MOST_COMMANDS)
        self.assertEqual(self.done.returncode, 0, self.done.stdout + self.done.stderr)
        for name in ("lug.step", "lug.h5", "look/parts.vtkhdf", "look/parts.png", "run/solution.png"):
            self.assertTrue((self.place / name).is_file(), name)

    def test_forces(self):
        """What pulls at the pin arrives at the wall: the ends' area by the circle, of which curved sides lack 2e-5."""
        summary = json.loads((self.place / "run/summary.json").read_text(encoding="utf-8"))
        self.assertTrue(summary["converged"])
        pull = TRACTION * 2 * math.pi * RADIUS**2
        forces = summary["forces"]
        for effect, sign in (("Contact/bearing", 1.0), ("Prescribed displacement/wall", -1.0)):
            force = np.array(forces[effect]["force"])
            self.assertAlmostEqual(sign * force[0] / pull, 1.0, delta=1e-3, msg=effect)
            self.assertLess(np.abs(force[1:]).max(), 1e-3 * pull, effect)

    def test_pressures(self):
        """On an arc about the pull, and nowhere else."""
        with h5py.File(self.place / "run/result.vtkhdf") as file:
            points = file["VTKHDF/Points"][()]
            active = file["VTKHDF/PointData/active_set"][()].ravel()
            pressure = file["VTKHDF/PointData/contact_pressure"][()].ravel()
        radius = np.hypot(points[:, 0], points[:, 1])
        hole = (active > 0) & (radius > 0.5 * (RADIUS + 10.0))
        angle = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
        closed = hole & (active == 2)
        self.assertTrue((pressure[hole & ~closed] == 0.0).all())
        self.assertTrue((pressure[closed] > 0.0).all())
        # Hertz' half angle for two cylinders that are not close, (4 Q/(pi E* dR))^(1/2), is 24.6 degrees; a lug that
        # gives way around the pin is touched on a wider arc, but of no more than the half that the pin is pulled to.
        self.assertGreater(np.abs(angle[closed]).max(), 24.6)
        self.assertLess(np.abs(angle[closed]).max(), 90.0)

    def test_pressures_make_up_the_pull(self):
        """Their integral over the hole, by flat pieces of its facets with the mean of their corners."""
        solid = run_results.read_result(self.place / "run/result.vtkhdf")
        corners = solid.xyz[solid.cells]
        hole = (np.abs(np.hypot(corners[..., 0], corners[..., 1]) - 10.0) < 1e-6).all(axis=1)
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
        # A triangle repeats its last corner.
        mean = solid.pressure[solid.cells[:, :3]].mean(axis=1)
        force = -(normal * mean[:, None])[hole].sum(axis=0)
        pull = TRACTION * 2 * math.pi * RADIUS**2
        # Pressures that double towards the rims over the last of some ten facets: the trapezoidal rule is off by a tenth
        # of the rise there, on two of ten rows.
        self.assertAlmostEqual(force[0] / pull, 1.0, delta=0.02)


if __name__ == "__main__":
    runs.main()
