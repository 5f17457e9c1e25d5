# SPDX-License-Identifier: BSD-3-Clause
"""Hertz contact of a cylinder and a ball with rigid plates against theory, on four meshes.

Theory holds for contacts that are small beside the body: the half-width is 3 % of the radius of
the cylinder and 10 % of that of the ball, and what theory leaves out is of second order in it.

What it guards against: gaps of obstacles, tributary areas and signs of pressure, graded and bent
meshes, and elastic constants that are wrong.
"""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

# Distance from theory on the finest mesh, relative. What is asked of the peak pressure is 2 %; the
# rest of theory's error, (a/R)^2 = 1e-3 for the cylinder and 1e-2 for the ball, is far below it.
FINEST = {"half_width": 0.01, "peak_pressure": 0.005, "approach": 0.005}


def errors(case, problem, sides, elements, approach):
    result = {name: [] for name in FINEST}
    for n in elements:
        run = runs.solved(
            case,
            runs.MODEL,
            {
                "Model/Problem": problem,
                "Model/Subdomains per side": sides,
                "Model/Elements per subdomain side": n,
                "Model/Approach": approach,
                "Solver/Tolerance": 1e-6,
                "Output/Fields": False,
            },
        )
        values = run.summary["results"]
        # The obstacle bears what the plate presses with, and that is the load: of the half or quarter.
        up = 2 if problem == "hertz ball" else 1
        forces = {name.split("/")[0]: f["force"][up] for name, f in run.summary["forces"].items()
                  if name.endswith(("/plane", "/top"))}
        load = values["load"] / (4 if problem == "hertz ball" else 2)
        for value in (forces["Obstacle"], -forces["Prescribed displacement"]):
            case.assertLessEqual(abs(value - load), 10 * 1e-6 * load, run.summary["forces"])
        for name in FINEST:
            result[name].append(abs(values[name] / values[name + "_theory"] - 1.0))
    for name, values in result.items():
        print(f"{problem}, {name}: ", " ".join(f"{value:.2e}" for value in values))
    return result


class Hertz(unittest.TestCase):
    def check(self, result):
        for name, values in result.items():
            self.assertLessEqual(values[-1], FINEST[name], name)
            # A single mesh may be lucky, and the finest ones reach the error of theory itself:
            # the two finest together halve what the two coarsest leave.
            self.assertLessEqual(max(values[2:]), 0.5 * max(values[:2]), name)

    def test_cylinder(self):
        self.check(errors(self, "hertz cylinder", 4, (2, 4, 8, 16), 0.002))

    def test_ball(self):
        self.check(errors(self, "hertz ball", 2, (3, 4, 8, 12), 0.01))


if __name__ == "__main__":
    runs.main()
