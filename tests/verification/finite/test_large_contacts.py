# SPDX-License-Identifier: BSD-3-Clause
"""Contacts that move far: a ball pressed flat, a ring pushed through a gate, a die that irons a slab in space.

What it guards against: normals, mortar integrals and rows that are right on flat or resting surfaces alone; forces that
depend on the way that led to a state; sets of contact that depend on the mesh.
"""

import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "support")]

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from finite_scenes import block, deck, field, geometry, steps_of
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

SOFT = {"Type": "neo-Hookean", "Young's modulus": 1.0, "Poisson's ratio": 0.3}


class Hertz(unittest.TestCase):
    """The lower half of a ball of radius 1, pressed on a plane by 0.3: in space a quarter of it."""

    SPACE = """
        size = 0.16; fine = 0.07;
        Point(1) = {0, 0, 1, size}; Point(2) = {0, 0, 0, fine}; Point(3) = {1, 0, 1, size}; Point(4) = {0, 1, 1, size};
        Line(1) = {1, 3}; Line(2) = {1, 4}; Line(3) = {1, 2};
        Circle(4) = {3, 1, 4}; Circle(5) = {2, 1, 3}; Circle(6) = {2, 1, 4};
        Curve Loop(1) = {1, 4, -2}; Plane Surface(1) = {1};
        Curve Loop(2) = {3, 5, -1}; Plane Surface(2) = {2};
        Curve Loop(3) = {3, 6, -2}; Plane Surface(3) = {3};
        Curve Loop(4) = {5, 4, -6}; Surface(4) = {4};
        Surface Loop(1) = {1, 2, 3, 4}; Volume(1) = {1};
        Mesh.ElementOrder = 2;
        Physical Surface("top") = {1}; Physical Surface("y0") = {2}; Physical Surface("x0") = {3};
        Physical Surface("cap") = {4}; Physical Volume("ball") = {1};
    """
    MERIDIAN = """
        size = 0.06; fine = 0.024;
        Point(1) = {0, 1, 0, size}; Point(2) = {0, 0, 0, fine}; Point(3) = {1, 1, 0, size};
        Line(1) = {3, 1}; Line(2) = {1, 2}; Circle(3) = {2, 1, 3};
        Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};
        Mesh.ElementOrder = 2;
        Physical Curve("top") = {1}; Physical Curve("cap") = {3}; Physical Surface("ball") = {1};
    """

    def run_ball(self, mesh, axis, physics, planes):
        sink, up = [0.0] * 3, [0.0] * 3
        sink["xyz".index(axis)], up["xyz".index(axis)] = -0.3, 1.0
        return runs.solved(self, deck({
            "Model": {"Physics": physics, "Kinematics": "finite", "Mesh file": geometry(mesh)},
            "Materials": {"m": SOFT}, "Bodies": {"ball": {"Materials": ["m"], "Subdomains": 8}},
            "Steps": {"Number": 3}, "Solver": {"Tolerance": 1e-5},
            "Effects": {
                "Obstacle": {"plane": {"Part": "ball/cap", "Direction": up}},
                "Prescribed displacement": {
                    "sink": {"Part": "ball/top", "Components": [axis], "Displacement": sink},
                    **{f"{name}0": {"Part": f"ball/{name}0", "Components": [name]} for name in planes},
                },
            },
        }), np=runs.RANKS, program="harmos").directory

    def test_a_ball_pressed_by_a_third_of_its_radius(self):
        """In space and around its axis: forces and the greatest pressure agree as their meshes do. Hertz' formula is a
        third off here."""
        space = self.run_ball(self.SPACE, "z", "solid", "xy")
        around = self.run_ball(self.MERIDIAN, "y", "axisymmetric", "")
        hertz = [4.0 / 3.0 / (1.0 - 0.3**2) * d**1.5 for d in (0.1, 0.2, 0.3)]
        forces = [
            (4.0 * one["Obstacle/plane/fz"], other["Obstacle/plane/fy"])
            for one, other in zip(steps_of(space), steps_of(around))
        ]
        for one, other in forces:
            self.assertLess(abs(one / other - 1.0), 0.005)  # 0.0014 at the first step, whose contact is five cells wide
        self.assertGreater(forces[-1][1] / hertz[-1], 1.3)
        pressures = [field(path, "contact_pressure")[1].max() for path in (space, around)]
        self.assertLess(abs(pressures[0] / pressures[1] - 1.0), 0.03)


class Rings(unittest.TestCase):
    """A ring, its right half, is pushed up past half a ring that stands in its way by a fifth of its radius."""

    def mesh(self, down):
        return geometry(f"""
            Point(1) = {{0, 0, 0}};
            Point(2) = {{0, -1, 0}}; Point(3) = {{1, 0, 0}}; Point(4) = {{0, 1, 0}};
            Point(5) = {{0, -0.8, 0}}; Point(6) = {{0.8, 0, 0}}; Point(7) = {{0, 0.8, 0}};
            Circle(1) = {{2, 1, 3}}; Circle(2) = {{3, 1, 4}}; Circle(3) = {{5, 1, 6}}; Circle(4) = {{6, 1, 7}};
            Line(5) = {{2, 5}}; Line(6) = {{4, 7}}; Line(7) = {{3, 6}};
            Curve Loop(1) = {{1, 7, -3, -5}}; Plane Surface(1) = {{1}};
            Curve Loop(2) = {{2, 6, -4, -7}}; Plane Surface(2) = {{2}};
            Transfinite Curve{{1, 2, 3, 4}} = 25; Transfinite Curve{{5, 6, 7}} = 4;
            Point(11) = {{1.8, 0, 0}}; Point(12) = {{1.8, -1, 0}}; Point(13) = {{0.8, 0, 0}}; Point(14) = {{1.8, 1, 0}};
            Point(15) = {{1.8, -0.7, 0}}; Point(16) = {{1.1, 0, 0}}; Point(17) = {{1.8, 0.7, 0}};
            Circle(11) = {{12, 11, 13}}; Circle(12) = {{13, 11, 14}}; Circle(13) = {{15, 11, 16}}; Circle(14) = {{16, 11, 17}};
            Line(15) = {{12, 15}}; Line(16) = {{14, 17}}; Line(17) = {{13, 16}};
            Curve Loop(11) = {{11, 17, -13, -15}}; Plane Surface(11) = {{11}};
            Curve Loop(12) = {{12, 16, -14, -17}}; Plane Surface(12) = {{12}};
            Transfinite Curve{{11, 12, 13, 14}} = 19; Transfinite Curve{{15, 16, 17}} = 4;
            Transfinite Surface{{1, 2, 11, 12}}; Recombine Surface{{1, 2, 11, 12}};
            Translate {{0, -{down}, 0}} {{ Surface{{1, 2}}; }}
            Mesh.ElementOrder = 2;
            Physical Curve("outer") = {{1, 2}}; Physical Curve("cut") = {{5, 6}}; Physical Surface("ring") = {{1, 2}};
            Physical Curve("face") = {{11, 12}}; Physical Curve("foot") = {{15, 16}}; Physical Surface("gate") = {{11, 12}};
        """)

    def test_a_ring_through_a_gate(self):
        """Mesh and way are symmetric, bodies elastic, and nothing rubs: the force along the way is odd, that across and
        the energy are even, and behind the gate nothing is left. All of it to ten tolerances."""
        tolerance = 1e-6
        rows = steps_of(runs.solved(self, deck({
            "Model": {"Physics": "plane strain", "Kinematics": "finite", "Mesh file": self.mesh(1.3)},
            "Materials": {"m": SOFT},
            "Bodies": {"ring": {"Materials": ["m"], "Subdomains": 4}, "gate": {"Materials": ["m"], "Subdomains": 3}},
            "Steps": {"Number": 26}, "Solver": {"Tolerance": tolerance},
            "Effects": {
                "Contact": {"joint": {"First": "ring/outer", "Second": "gate/face"}},
                "Prescribed displacement": {
                    "feet": {"Part": "gate/foot"}, "middle": {"Part": "ring/cut", "Components": ["x"]},
                    "push": {"Part": "ring/cut", "Components": ["y"], "Displacement": [0.0, 2.6, 0.0]},
                },
            },
        }), np=runs.RANKS, program="harmos").directory)
        along, across, energy = (
            np.array([0.0] + [row[key] for row in rows]) for key in ("Contact/joint/fy", "Contact/joint/fx", "energy")
        )
        self.assertLess(along[:13].min(), -1e-3)
        self.assertLess(across[13], -5e-3)
        for values, mirrored in ((along, -along[::-1]), (across, across[::-1])):
            self.assertLess(np.abs(values - mirrored).max(), 10.0 * tolerance * np.abs(across).max())
        self.assertLess(np.abs(energy - energy[::-1]).max(), 10.0 * tolerance * energy.max())
        self.assertEqual(rows[-1]["closed"], 0)
        # What pushing works is stored: by the trapezoidal rule, whose steps see five points of contact.
        self.assertLess(np.abs(np.array([0.0] + [row["external_work"] for row in rows]) - energy).max(), 0.02 * energy.max())


class IroningInSpace(unittest.TestCase):
    """A half cylinder of tetrahedra is pressed on a slab of hexahedra of second order and drawn across its grid."""

    DIE = """
        size = 0.3; fine = 0.18;
        Point(1) = {-1, -0.6, 1, size}; Point(2) = {0, -0.6, 1, size}; Point(3) = {1, -0.6, 1, size};
        Point(4) = {0, -0.6, 0, fine};
        Line(1) = {1, 3}; Circle(2) = {3, 2, 4}; Circle(3) = {4, 2, 1};
        Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};
        out() = Extrude {0, 1.2, 0} { Surface{1}; };
        Mesh.ElementOrder = 2;
        Physical Surface("top") = {out(2)}; Physical Surface("round") = {out(3), out(4)};
        Physical Volume("die") = {out(1)};
    """

    def drawn(self, steps, np_=2):
        total = float(steps + 1)
        slab = block([-1.2, -1.0], [4.0, 2.2], [4, 2], [2, 2], "Q2", "soft")
        slab |= {"Origin": [-1.2, -1.0, -1.0], "Elements a side": [2, 2, 2]}
        return steps_of(runs.solved(self, deck({
            "Model": {"Physics": "solid", "Kinematics": "finite", "Mesh file": geometry(self.DIE)},
            "Materials": {"soft": SOFT, "hard": SOFT | {"Young's modulus": 10.0}},
            "Bodies": {"die": {"Materials": ["hard"], "Subdomains": 2}, "slab": slab},
            "Steps": {
                "Number": steps + 1, "End time": total,
                "Histories": {
                    "down": {"Times": [0.0, 1.0, total], "Values": [0.0, 1.0, 1.0]},
                    "on": {"Times": [0.0, 1.0, total], "Values": [0.0, 0.0, 1.0]},
                },
            },
            "Solver": {"Tolerance": 1e-4},
            "Effects": {
                "Contact": {"joint": {"First": "die/round", "Second": "slab/top"}},
                "Prescribed displacement": {
                    "ground": {"Part": "slab/bottom"},
                    "sink": {"Part": "die/top", "Components": ["z"], "Displacement": [0.0, 0.0, -0.3], "History": "down"},
                    "push": {
                        "Part": "die/top", "Components": ["x", "y"], "Displacement": [0.5, 0.15, 0.0], "History": "on",
                    },
                },
            },
        }), np=np_, program="harmos").directory)

    def test_no_jumps_from_cell_to_cell(self):
        """Drawn by a whole cell and its quarter across: the pressing force changes by at most 2 % a step."""
        forces = [row["Contact/joint/fz"] for row in self.drawn(4)[1:]]
        self.assertLess(max(abs(b / a - 1.0) for a, b in zip(forces[:-1], forces[1:])), 0.02, forces)


if __name__ == "__main__":
    runs.main()
