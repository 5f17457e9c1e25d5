# SPDX-License-Identifier: BSD-3-Clause
"""Bolts under pretension that turn by more than a right angle: by force, locked, by a shift.

A bar of length L and section A is cut in the middle and held at both ends, which turn with it and move apart by d,
without sideways contraction: with the stretch λ of both halves,

    λ = 1 + (s + d)/L,   N = EAλ(λ² − 1)/2,   W = LEA(λ² − 1)²/8

What it guards against: a bolt whose direction stays behind, in forces, moments or where it is locked; work that is lost.
"""

import math
import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "support")]

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from finite_scenes import block, carried, corner_parts, deck, geometry, rotation, steps_of
    from scipy.optimize import brentq
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

YOUNG, LENGTH, AREA, FORCE, SHIFT, MOVE = 200.0, 4.0, 0.5 * 0.75, 6.0, 0.3, 0.2
TURN = np.array([1.4, -1.2, 1.0])
ENDS = {
    f"{body}/p{x}{y}{z}": np.array([4.0 * x, 0.5 * y, 0.75 * z])
    for body, x in (("lower", 0), ("upper", 1)) for y in (0, 1) for z in (0, 1)
}
BAR = """
    SetFactory("OpenCASCADE");
    Box(1) = {0, 0, 0, 2, 0.5, 0.75}; Box(2) = {2, 0, 0, 2, 0.5, 0.75};
    Transfinite Curve{:} = 2; Transfinite Curve{9:12, 21:24} = 5;
    Transfinite Surface{:}; Recombine Surface{:}; Transfinite Volume{:};
    Physical Surface("cut") = {2}; Physical Surface("face") = {7};
    Physical Volume("lower") = {1}; Physical Volume("upper") = {2};
""" + corner_parts(ENDS)


def force_at(stretch):
    return YOUNG * AREA * stretch * (stretch**2 - 1.0) / 2.0


def energy_at(stretch):
    return LENGTH * YOUNG * AREA * (stretch**2 - 1.0) ** 2 / 8.0


class Turned(unittest.TestCase):
    TIGHTEN, TURNS, PULLS = 2, 6, 2

    def rows(self, bolt, np_=2):
        """Tightened, turned, pulled apart."""
        count = self.TIGHTEN + self.TURNS + self.PULLS
        def where(name, place, k):
            turn = rotation(TURN * min(1.0, max(0, k - self.TIGHTEN) / self.TURNS))
            apart = MOVE * max(0, k - self.TIGHTEN - self.TURNS) / self.PULLS * name.startswith("upper")
            return turn @ (place + [apart, 0.0, 0.0])

        histories, held = carried(ENDS, count, where)
        histories["tight"] = {"Times": [0.0, float(self.TIGHTEN), float(count)], "Values": [0.0, 1.0, 1.0]}
        return steps_of(runs.solved(self, deck({
            "Model": {"Physics": "solid", "Kinematics": "finite", "Mesh file": geometry(BAR)},
            "Materials": {"m": {"Young's modulus": YOUNG, "Poisson's ratio": 0.0}},
            "Bodies": {"lower": {"Materials": ["m"], "Subdomains": 2}, "upper": {"Materials": ["m"], "Subdomains": 2}},
            "Steps": {"Number": count, "End time": float(count), "Histories": histories},
            "Solver": {"Tolerance": 1e-9},
            "Effects": {
                "Pretension": {"bolt": bolt | {"First": "lower/cut", "Second": "upper/face", "History": "tight"}},
                "Prescribed displacement": held,
            },
        }), np=np_, program="harmos").directory)

    def expect(self, rows, stretches):
        turned = rotation(TURN) @ [1.0, 0.0, 0.0]
        for k, row in enumerate(rows):
            stretch = stretches[min(k, len(stretches) - 1)] if k < self.TIGHTEN else stretches[
                self.TIGHTEN - 1 + max(0, k + 1 - self.TIGHTEN - self.TURNS)
            ]
            force = np.array([row[f"Pretension/bolt/f{axis}"] for axis in "xyz"])
            energy = energy_at(stretches[-1])
            self.assertAlmostEqual(np.linalg.norm(force), force_at(stretch), delta=1e-6 * FORCE, msg=f"step {k + 1}")
            self.assertAlmostEqual(row["energy"], energy_at(stretch), delta=1e-6 * energy, msg=f"step {k + 1}")
            if k + 1 >= self.TIGHTEN + self.TURNS:
                self.assertLess(np.linalg.norm(force - force_at(stretch) * turned), 1e-6 * FORCE)

    def test_by_force(self):
        """Which stays as it is, also where the ends part: the bolt gives way."""
        at = [brentq(lambda stretch: force_at(stretch) - share * FORCE, 1.0, 2.0) for share in (0.5, 1.0)]
        self.expect(self.rows({"Force": FORCE}), at + [at[-1]] * self.PULLS)

    def test_locked(self):
        """When it is tight: it keeps its shift while it turns, and the ends pull."""
        at = [brentq(lambda stretch: force_at(stretch) - share * FORCE, 1.0, 2.0) for share in (0.5, 1.0)]
        rows = {np_: self.rows({"Force": FORCE, "Locked from": float(self.TIGHTEN)}, np_) for np_ in (1, 4)}
        for of in rows.values():
            self.expect(of, at + [at[-1] + share * MOVE / LENGTH for share in (0.5, 1.0)])

    def test_by_shift(self):
        rows = self.rows({"Shift": SHIFT})
        self.expect(rows, [
            1.0 + (share * SHIFT + move * MOVE) / LENGTH for share, move in ((0.5, 0.0), (1.0, 0.0), (1.0, 0.5), (1.0, 1.0))
        ])
        # Work of the shift and of the ends, by the trapezoidal rule.
        self.assertAlmostEqual(rows[-1]["external_work"], rows[-1]["energy"], delta=0.01 * rows[-1]["energy"])


class Half(unittest.TestCase):
    """Of a bolt whose cut dishes, beside a plane of symmetry and around an axis: what it is cut from is held there."""

    def rows(self, physics, left, width):
        lower = block([left, 0.0], [width, 1.0], [1, 1], [4 if width == 1.0 else 8, 4], "Q1", "m")
        upper = block([left, 1.0], [width, 0.25], [1, 1], [4 if width == 1.0 else 8, 1], "Q1", "m")
        held = {"ground": {"Part": "lower/bottom"}, "hold": {"Part": "upper/right", "Components": ["y"]}}
        if physics == "plane strain" and width == 1.0:
            held |= {f"{body}": {"Part": f"{body}/left", "Components": ["x"]} for body in ("lower", "upper")}
        if width == 2.0:
            held["other"] = {"Part": "upper/left", "Components": ["y"]}
        return steps_of(runs.solved(self, deck({
            "Model": {"Physics": physics, "Kinematics": "finite"},
            "Materials": {"m": {"Young's modulus": 100.0, "Poisson's ratio": 0.3}},
            "Bodies": {"lower": lower, "upper": upper},
            "Steps": {"Number": 3},
            "Solver": {"Tolerance": 1e-8},
            "Effects": {
                "Pretension": {"bolt": {"First": "lower/top", "Second": "upper/bottom", "Shift": 0.05}},
                "Prescribed displacement": held,
            },
        }), np=runs.RANKS, program="harmos").directory)[-1]

    def test_half_is_half(self):
        half, whole = self.rows("plane strain", 0.0, 1.0), self.rows("plane strain", -1.0, 2.0)
        self.assertAlmostEqual(2.0 * half["energy"], whole["energy"], delta=1e-6 * whole["energy"])
        self.assertAlmostEqual(2.0 * half["Pretension/bolt/fy"], whole["Pretension/bolt/fy"], delta=1e-5)

    def test_around_an_axis(self):
        row = self.rows("axisymmetric", 0.0, 1.0)
        self.assertAlmostEqual(row["external_work"], row["energy"], delta=0.02 * row["energy"])


if __name__ == "__main__":
    runs.main()
