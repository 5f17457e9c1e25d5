#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Materials that jump within subdomains: with adaptive coarse vectors products are those of one material.

Channels and inclusions that cross the cuts: products, number of vectors and their seconds beside those without vectors and
those of equal moduli; energies against an undecomposed solve by another program. With HARMOS_LONG more jumps.
"""

import os
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "oracles"), str(HERE.parent / "support")]

import harmos_runs as runs  # noqa: E402
import inclusions  # noqa: E402

try:
    import numpy as np
    import scipy.sparse.linalg as spla
    from elastic_oracle import assemble, read_mesh
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

JUMPS = (1e-6, 1e3, 1e6) if "HARMOS_LONG" in os.environ else (1e-6, 1e6)
VECTORS = "Dual operator/Expert/Adaptive coarse vectors"


def energy_by_the_oracle(block, result):
    mesh = read_mesh(result)
    for group in mesh.cells:
        centres = mesh.nodes[group.nodes].mean(axis=1)
        places = np.floor(centres * block.elements).astype(int).tolist()
        group.body[:] = [block.is_stiff(tuple(place)) for place in places]
    stiffness = assemble(mesh, [(1.0, inclusions.POISSON), (block.jump, inclusions.POISSON)]).tocsr()
    up = block.dimension - 1
    u, is_held = np.zeros(mesh.size), np.zeros(mesh.size, bool)
    for component, value in enumerate(block.top_displacement):
        is_held[mesh.dof(mesh.at(up, 0.0), component)] = True
        top = mesh.dof(mesh.at(up, float(block.count)), component)
        is_held[top], u[top] = True, value
    free = np.flatnonzero(~is_held)
    factor = spla.splu(stiffness[free][:, free].tocsc())
    for _ in range(4):  # the first solves, the others refine
        u[free] -= factor.solve((stiffness @ u)[free])
    return 0.5 * u @ (stiffness @ u)


class Case(unittest.TestCase):
    def solve(self, block, vectors, tolerance=1e-4, ranks=1):
        deck = block.write(runs.scratch("inclusions"))
        sets = {"Solver/Tolerance": tolerance, "Output/Fields": tolerance < 1e-5, VECTORS: vectors}
        run = runs.solved(self, deck, sets, program="harmos", np=ranks)
        if tolerance < 1e-5:
            # Of second order in the error: what is left is rounding of K, of stiff cells that move as a whole,
            # c εJ with c the root of their number times a soft body's |u|²E over its energy.
            exact = energy_by_the_oracle(block, run.directory / "result.vtkhdf")
            rounding = 1000 * np.finfo(float).eps * max(block.jump, 1 / block.jump)
            self.assertAlmostEqual(run.summary["energy"] / exact, 1.0, delta=max(1e-10, rounding))
        return run.summary

    def check(self, dimension, count, elements):
        for pattern in inclusions.PATTERNS[dimension]:
            make = lambda jump: inclusions.Inclusions(dimension, count, elements, jump, pattern)
            worst = 0
            equal = {
                tolerance: self.solve(make(1.0), "none", tolerance)["hessian_applications"] for tolerance in (1e-4, 1e-8)
            }
            for jump, tolerance in (*((jump, 1e-4) for jump in JUMPS), (1e6, 1e-8)):
                with self.subTest(dimension=dimension, pattern=pattern, jump=jump, tolerance=tolerance):
                    found = self.solve(make(jump), "all", tolerance)
                    without = self.solve(make(jump), "none")["hessian_applications"] if tolerance == 1e-4 else 0
                    worst = max(worst, without)
                    print(
                        f"{dimension}D {pattern}, {jump:g} to {tolerance:g}: {equal[tolerance]} equal, {without} without, "
                        f"{found['hessian_applications']} with {found['adaptive_vectors']} vectors of "
                        f"{found['adaptive_seconds']:.2f} s"
                    )
                    self.assertLessEqual(found["hessian_applications"], 2 * equal[tolerance])
                    self.assertGreater(found["adaptive_vectors"], 0)
            # Inclusions that touch a cut here and there are cured by weights.
            if pattern != "inclusions":
                self.assertGreater(worst, 2 * equal[1e-4])


class Plane(Case):
    def test_plane(self):
        self.check(2, 6, 10)

    def test_ranks(self):
        block = inclusions.Inclusions(2, 4, 8, 1e6, "crossing")
        found = [self.solve(block, "all", 1e-6, ranks) for ranks in (1, 2, 4)]
        for other in found[1:]:
            # Modes near the threshold are found or not: boundaries of classes depend on the ranks.
            self.assertAlmostEqual(other["adaptive_vectors"], found[0]["adaptive_vectors"], delta=8)
            self.assertAlmostEqual(other["energy"] / found[0]["energy"], 1.0, delta=1e-10)
            self.assertAlmostEqual(other["hessian_applications"], found[0]["hessian_applications"], delta=4)

    def test_on_demand(self):
        block = inclusions.Inclusions(2, 6, 10, 1e6, "scattered")
        found = self.solve(block, "auto")
        without = self.solve(block, "none")["hessian_applications"]
        print(f"on demand {found['hessian_applications']}, without {without}")
        # 80 products, and no more than twice those of equal moduli beyond.
        self.assertGreater(found["adaptive_vectors"], 0)
        self.assertLessEqual(found["hessian_applications"], 80 + 20)
        self.assertGreater(without, 120)


class Space(Case):
    def test_space(self):
        self.check(3, 3, 6)


if __name__ == "__main__":
    runs.main()
