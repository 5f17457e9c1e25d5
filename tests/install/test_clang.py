# SPDX-License-Identifier: BSD-3-Clause
"""Libraries and applications compile with clang, without a warning, and solve the model problem as GCC's do.

Guards against conversions that GCC does not see, extensions of GCC, and kernels of the QP layer that clang does not turn
into vector instructions (a warning of its own for loops that ask for them). Takes a build of the libraries.
"""

import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

SETS = {"Model/Subdomains per side": 4, "Model/Elements per subdomain side": 8, "Solver/Tolerance": 1e-10}


@unittest.skipUnless(shutil.which("clang++"), "clang++ is missing")
class Clang(unittest.TestCase):
    def test_builds_and_agrees(self):
        runs.TIMEOUT = 3000
        build = runs.scratch("clang")
        configure = [
            "cmake", "-S", runs.SOURCE, "-B", build, "-DCMAKE_C_COMPILER=clang", "-DCMAKE_CXX_COMPILER=clang++",
            "-DCMAKE_BUILD_TYPE=Release", "-DHARMOS_ENABLE_TESTS=OFF", "-DHARMOS_WARNINGS_AS_ERRORS=ON",
        ]
        for command in (configure, ["cmake", "--build", build, "--parallel", "2"]):
            status, out, err = runs.execute(command)
            self.assertEqual(status, 0, out[-4000:] + err[-8000:])
        energies = [runs.solved(self, runs.MODEL, SETS).summary["energy"]]
        runs.BINARY = build
        energies.append(runs.solved(self, runs.MODEL, SETS).summary["energy"])
        # Of first order in what violates the constraints, 1e-10 of the multipliers; ten for their norm.
        self.assertLess(abs(energies[1] - energies[0]), 1e-9 * abs(energies[0]))


if __name__ == "__main__":
    runs.main()
