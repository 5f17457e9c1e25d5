# SPDX-License-Identifier: BSD-3-Clause
"""Bodies at large displacements, as decks have them, against the elastica and an independent solver; runs of a die that
irons a slab: forces without jumps, on any number of ranks, stopped and restarted.

What it guards against: tangents, contact search and friction that are right at rest alone; factors that are made anew
where bodies but turn; states that a restart loses.
"""

import math
import os
import signal
import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "support"), str(Path(__file__).resolve().parents[1] / "oracles")]

import harmos_runs as runs  # noqa: E402

try:
    import finite_oracle
    import numpy as np
    from finite_scenes import block, deck, field, steps_of
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

# Bisshopp, Drucker 1945: PL²/EI, deflection and shortening of the tip over L.
ELASTICA = ((1.0, 0.3017, 0.0564), (2.0, 0.4935, 0.1606), (5.0, 0.7138, 0.3876), (10.0, 0.8106, 0.5550))


def beam(load, elements, height, tolerance=1e-6):
    """A cantilever of length 10, built in at the left, under a load across its right end: PL²/EI."""
    young, length = 1e6, 10.0
    force = load * young * height**3 / 12.0 / length**2
    return deck({
        "Model": {"Physics": "plane stress", "Kinematics": "finite"},
        "Materials": {"m": {"Young's modulus": young, "Poisson's ratio": 0.0}},
        "Bodies": {"beam": block([0.0, 0.0], [length, height], [4, 1], [elements // 4, 1], "Q2", "m")},
        "Solver": {"Tolerance": tolerance},
        "Effects": {
            "Traction": {"load": {"Part": "beam/right", "Density": [0.0, -force / height, 0.0]}},
            "Prescribed displacement": {"wall": {"Part": "beam/left", "Components": ["x", "y"]}},
        },
    })


def tip(directory, height):
    points, u, _ = field(directory, "displacement")
    at = np.argmin(np.hypot(points[:, 0] - 10.0, points[:, 1] - 0.5 * height))
    return -u[at, 1] / 10.0, -u[at, 0] / 10.0


class Elastica(unittest.TestCase):
    def test_all_loads(self):
        """Deflection and shortening to 0.1 % and half of the last digit printed; the whole load in one step, which is
        halved where that does not converge, on one and two ranks."""
        for np_ in (1, 2):
            for load, down, inwards in ELASTICA:
                run = runs.solved(self, beam(load, 40, 0.1), np=np_, program="harmos")
                with self.subTest(load=load, ranks=np_):
                    found = tip(run.directory, 0.1)
                    self.assertAlmostEqual(found[0], down, delta=0.001 * down + 5e-5)
                    self.assertAlmostEqual(found[1], inwards, delta=0.001 * inwards + 5e-5)

    def test_iterations(self):
        """At most 1.3 times those of a prototype whose tangent turns with its subdomains and mixes its iterates: a
        cantilever 10 : 1, whose tip goes down by 6, 22 and 45 % of its length in one step, to 1e-8: 8, 18, 24."""
        for load, most in ((0.18, 10), (0.71, 23), (1.75, 31)):
            run = runs.solved(self, beam(load, 40, 1.0, 1e-8), np=1, program="harmos")
            rows = steps_of(run.directory)
            self.assertEqual(len(rows), 1)
            self.assertLessEqual(rows[0]["newton"], most)
            self.assertGreaterEqual(rows[0]["newton"], 4)

    def test_rates(self):
        """Tip displacements of biquadratic cells converge with h⁴, as energies do, over four meshes."""
        meshes = (8, 16, 32, 64)
        run = lambda n: runs.solved(self, beam(2.0, n, 0.5, 1e-9), np=1, program="harmos")  # noqa: E731
        exact = tip(run(256).directory, 0.5)[0]
        errors = [abs(tip(run(n).directory, 0.5)[0] - exact) for n in meshes]
        rate = -np.polyfit(np.log(meshes), np.log(errors), 1)[0]
        self.assertGreater(rate, 3.6, errors)
        self.assertLess(rate, 4.4, errors)


class OnAFloor(unittest.TestCase):
    def test_against_the_oracle(self):
        """A cantilever comes down on a floor and slides on: displacements of all nodes, and the force of the floor, as
        an independent solver with the full tangent and sets of nodes has them; without a factorisation."""
        load, floor, poisson, young = 3.0, -1.0, 0.3, 1000.0
        path = deck({
            "Model": {"Physics": "plane strain", "Kinematics": "finite"},
            "Materials": {"m": {"Young's modulus": young, "Poisson's ratio": poisson}},
            "Bodies": {"beam": block([0.0, 0.0], [10.0, 1.0], [5, 1], [6, 3], "P1", "m")},
            "Steps": {"Number": 4},
            "Solver": {"Tolerance": 1e-9},
            "Effects": {
                "Traction": {"load": {"Part": "beam/top", "Density": [0.0, -load, 0.0]}},
                "Obstacle": {"floor": {"Part": "beam/bottom", "Point": [0.0, floor, 0.0]}},
                "Prescribed displacement": {"wall": {"Part": "beam/left", "Components": ["x", "y"]}},
            },
        })
        expected = None
        for np_ in (1, 2):
            run = runs.solved(self, path, np=np_, program="harmos")
            points, u, cells = field(run.directory, "displacement")
            places, first, inverse = np.unique(
                np.round(points[:, :2], 9), axis=0, return_index=True, return_inverse=True
            )
            if expected is None:
                expected = self.oracle(places, inverse.ravel()[cells.reshape(-1, 3)], load, floor, young, poisson)
            found, pressed = expected
            size = np.abs(found).max()
            self.assertGreater(size, 1.0)  # of a height of one
            self.assertGreaterEqual(len(pressed), 3)
            # Ten times the tolerance, times a condition below a hundred.
            self.assertLess(np.abs(u[first, :2] - found).max(), 1e-6 * size)
            last = steps_of(run.directory)[-1]
            self.assertAlmostEqual(last["Obstacle/floor/fy"] / sum(pressed.values()), 1.0, delta=1e-6)
            self.assertEqual(last["closed"], len(pressed))

    def oracle(self, places, cells, load, floor, young, poisson):
        body = finite_oracle.Body(places, cells, young, poisson)
        top = sorted(np.flatnonzero(np.abs(places[:, 1] - 1.0) < 1e-9), key=lambda k: places[k, 0])
        forces = np.zeros_like(places)
        for left, right in zip(top[:-1], top[1:]):
            forces[[left, right], 1] -= 0.5 * load * (places[right, 0] - places[left, 0])
        held = np.flatnonzero(places[:, 0] < 1e-9).tolist()
        bottom = np.flatnonzero(places[:, 1] < 1e-9).tolist()
        return body.solve(held, forces, floor, bottom, steps=150)


def root(function, low, high):
    """Of a function that rises."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) < 0.0 else (low, middle)
    return middle


class Warmth(unittest.TestCase):
    """Bodies that expand by as much as a fifth."""

    def run_block(self, physics, law, steps=1, held=(), np_=1):
        sides = {"left": "x", "right": "x", "bottom": "y"} if physics != "solid" else {"left": "x", "right": "x", "front": "y"}
        body = block([0.0, 0.0], [2.0, 1.0], [2, 1], [2, 2], "Q2", "m")
        body["Element"] = "Q2" if physics != "axisymmetric" else "P2"
        material = {"Young's modulus": 3.0, "Poisson's ratio": 0.3, "Thermal expansion": [0.1, 0.1, 0.1]}
        return runs.solved(self, deck({
            "Model": {"Physics": physics, "Kinematics": "finite"},
            "Materials": {"m": material | ({"Type": "neo-Hookean"} if law == "neo-Hookean" else {})},
            "Bodies": {"b": body}, "Steps": {"Number": steps}, "Solver": {"Tolerance": 1e-10},
            "Effects": {
                "Thermal strain": {"fire": {"Body": "b", "Temperature": 2.0}},
                "Prescribed displacement": {
                    side: {"Part": f"b/{side}", "Components": [sides[side]]} for side in sides if side in held
                },
            },
        }), np=np_, program="harmos")

    def test_free_expansion(self):
        """As large as it expands, without stress."""
        for physics in ("plane stress", "axisymmetric", "solid"):
            for law in ("linear", "neo-Hookean"):
                held = {"plane stress": ("left", "bottom"), "axisymmetric": ("bottom",), "solid": ("left", "front")}[physics]
                with self.subTest(physics=physics, law=law):
                    run = self.run_block(physics, law, held=held, np_=2)
                    points, u, _ = field(run.directory, "displacement")
                    _, stress, _ = field(run.directory, "stress")
                    free = 0.2 * points
                    for axis in range(2 if physics != "solid" else 3):
                        moved = u[:, axis] - free[:, axis]
                        # Nothing holds the solid along z.
                        self.assertLess(np.ptp(moved) if axis == 2 else np.abs(moved).max(), 1e-8)
                    self.assertLess(np.abs(stress).max(), 1e-8 * 3.0)

    def test_a_block_between_walls(self):
        """Neo-Hookean, plane strain, held along x: F = diag(1, c, 1), F_e = F/1.2, c of σ_yy = 0. What heating works is
        the energy that is stored, with an error of second order in the steps."""
        mu, lame, free = 3.0 / 2.6, 3.0 * 0.3 / (1.3 * 0.4), 1.2

        def kirchhoff(stretch, square):
            return mu * (square / free**2 - 1.0) + lame * math.log(stretch / free**3)

        c = root(lambda stretch: kirchhoff(stretch, stretch**2), 1.0, 2.0)
        force = kirchhoff(c, 1.0) / (c / free**3) * c  # of Cauchy's stress over the height
        errors = []
        for steps in (2, 4, 8):
            row = steps_of(self.run_block("plane strain", "neo-Hookean", steps, ("left", "right", "bottom")).directory)[-1]
            self.assertAlmostEqual(row["Prescribed displacement/right/fx"], force, delta=1e-8)
            errors.append(row["external_work"] / row["energy"] - 1.0)
        rates = [math.log2(abs(errors[k] / errors[k + 1])) for k in range(2)]
        self.assertTrue(all(1.8 < rate < 2.2 for rate in rates), (errors, rates))


class Spinning(unittest.TestCase):
    def test_a_bar(self):
        """A bar that turns about its left end and is a sixth longer for that, its sides held: (F S)' + ρω²(X + u) = 0, S of
        St. Venant and Kirchhoff's law in plane stress, by Runge and Kutta's rule from the left, shot at F S = 0."""
        young, nu, size, length = 2.0, 0.3, 0.3, 2.0
        confined = young / (1.0 - nu * nu)

        def shot(first, steps=2000):
            x, state, h = 0.0, (0.0, first), length / steps
            stretch = lambda p: root(lambda f: confined * 0.5 * f * (f * f - 1.0) - p, 0.6, 3.0)  # noqa: E731
            for _ in range(steps):
                def slope(at, y):
                    return stretch(y[1]) - 1.0, -size * (at + y[0])
                k = [slope(x, state)]
                for part in (0.5, 0.5, 1.0):
                    k.append(slope(x + part * h, tuple(a + part * h * b for a, b in zip(state, k[-1]))))
                state = tuple(a + h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]) for i, a in enumerate(state))
                x += h
            return state

        first = root(lambda p: shot(p, 200)[1], 0.0, 2.0)
        wanted = shot(first, 200)[0]
        run = runs.solved(self, deck({
            "Model": {"Physics": "plane stress", "Kinematics": "finite"},
            "Materials": {"m": {"Young's modulus": young, "Poisson's ratio": nu}},
            "Bodies": {"bar": block([0.0, 0.0], [length, 0.1], [2, 1], [10, 1], "Q2", "m")},
            "Solver": {"Tolerance": 1e-9},
            "Effects": {
                "Centrifugal force": {"spin": {"Body": "bar", "Mass density": size, "Angular velocity": 1.0}},
                "Prescribed displacement": {
                    "hub": {"Part": "bar/left", "Components": ["x"]},
                    "low": {"Part": "bar/bottom", "Components": ["y"]}, "high": {"Part": "bar/top", "Components": ["y"]},
                },
            },
        }), np=runs.RANKS, program="harmos")
        points, u, _ = field(run.directory, "displacement")
        self.assertGreater(wanted, 0.15 * length)
        # Of twenty cells of second order at ends of cells, h⁴, and of the rule.
        self.assertAlmostEqual(u[points[:, 0] == length, 0].mean(), wanted, delta=1e-5 * wanted)


def ironing(fine, friction, steps, way):
    """A die with a round bottom presses on a slab and is drawn along it."""
    effects = {
        "Contact": {"joint": {"First": "die/bottom", "Second": "slab/top"}},
        "Prescribed displacement": {
            "ground": {"Part": "slab/bottom", "Components": ["x", "y"]},
            "sink": {"Part": "die/top", "Components": ["y"], "Displacement": [0.0, -0.4, 0.0], "History": "down"},
            "push": {"Part": "die/top", "Components": ["x"], "Displacement": [way, 0.0, 0.0], "History": "right"},
        },
    }
    if friction:
        effects["Friction"] = {"rough": {"Contact": "joint", "Coefficient": friction}}
    total = float(steps + 2)
    return deck({
        "Model": {"Physics": "plane strain", "Kinematics": "finite"},
        "Materials": {
            "soft": {"Type": "neo-Hookean", "Young's modulus": 1.0, "Poisson's ratio": 0.3},
            "hard": {"Type": "neo-Hookean", "Young's modulus": 10.0, "Poisson's ratio": 0.3},
        },
        "Bodies": {
            "slab": block([0.0, 0.0], [6.0, 2.0], [6, 2], [4 * fine, 4 * fine], "Q1", "soft"),
            "die": block([1.0, 2.0], [1.5, 0.8], [2, 1], [3 * fine, 3 * fine], "Q1", "hard"),
        },
        "Steps": {
            "Number": steps + 2, "End time": total,
            "Histories": {
                "down": {"Times": [0.0, 2.0, total], "Values": [0.0, 1.0, 1.0]},
                "right": {"Times": [0.0, 2.0, total], "Values": [0.0, 0.0, 1.0]},
            },
        },
        "Solver": {"Tolerance": 1e-5},
        "Effects": effects,
    })


class Ironing(unittest.TestCase):
    def compare(self, one, other, tolerance):
        for first, second in zip(one, other):
            for key in ("energy", "Contact/joint/fx", "Contact/joint/fy"):
                size = abs(second["Contact/joint/fy"]) if key != "energy" else second["energy"]
                self.assertLess(abs(first[key] - second[key]), tolerance * size, key)

    def test_forces_on_any_number_of_ranks(self):
        """Sliding by several cells, with friction: all points slip, each with its coefficient times the pressure, and
        forces and energies are the same on 1, 2 and 4 ranks, to ten tolerances (1e-8 seen)."""
        path = ironing(1, 0.2, 6, 1.8)
        done = {np_: runs.solved(self, path, np=np_, program="harmos").directory for np_ in (1, 2, 4)}
        rows = {np_: steps_of(directory) for np_, directory in done.items()}
        for np_ in (2, 4):
            self.compare(rows[np_], rows[1], 1e-4)
        last = rows[1][-1]
        self.assertEqual(last["sticking"], 0)
        self.assertGreater(last["slipping"], 4)
        state, drag, pressure = (
            field(done[2], name)[1] for name in ("friction_state", "friction_traction", "contact_pressure")
        )
        slips = state == 2
        ratio = np.linalg.norm(drag[slips], axis=1) / pressure[slips]
        self.assertLess(np.abs(ratio - 0.2).max(), 1e-6)  # limits are kept to rounding errors of projections, 1e-9
        # It takes about its drag times the way.
        self.assertGreater(last["dissipated"], 0.5 * 0.2 * last["Contact/joint/fy"] * 1.8)

    def test_no_jumps_from_cell_to_cell(self):
        """Without friction the pressing force changes by at most 2 % from step to step, of a quarter of a cell."""
        rows = steps_of(runs.solved(self, ironing(2, 0.0, 16, 0.5), np=runs.RANKS, program="harmos").directory)[6:]
        forces = [row["Contact/joint/fy"] for row in rows]
        jumps = [abs(b - a) / a for a, b in zip(forces[:-1], forces[1:])]
        self.assertLess(max(jumps), 0.02, forces)

    def test_restart_to_the_last_bit(self):
        """Stopped in the midst of a step, and restarted on as many ranks."""
        path = ironing(2, 0.2, 3, 0.9)
        whole = runs.solved(self, path, np=2, program="harmos")
        run = runs.Background(path, {}, program="harmos")
        self.assertTrue(run.wait_until(lambda: run.text().count("Newton iteration") > 12))
        os.kill(run.ranks()[0], signal.SIGTERM)
        run.end()
        self.assertIn("--restart", run.text())
        again = runs.start(["--restart", run.directory], 2, program="harmos")
        self.assertEqual(again.returncode, 0, again)
        for name in ("displacement", "stress", "contact_pressure"):
            self.assertTrue((field(run.directory, name)[1] == field(whole.directory, name)[1]).all(), name)

    def test_restart_on_other_ranks(self):
        path = ironing(1, 0.2, 4, 1.2)
        whole = steps_of(runs.solved(self, path, np=2, program="harmos").directory)
        run = runs.Background(path, {}, program="harmos")
        self.assertTrue(run.wait_until(lambda: "Step 3 of" in run.text()))
        os.kill(run.ranks()[0], signal.SIGTERM)
        run.end()
        again = runs.start(["--restart", run.directory], 1, program="harmos")
        self.assertEqual(again.returncode, 0, again)
        self.compare(steps_of(run.directory), whole, 1e-4)


class Failure(unittest.TestCase):
    def test_a_step_that_cannot_be_made(self):
        """A block of St. Venant-Kirchhoff's material that is pressed flat buckles inwards: the run ends with the
        reason and the place, and keeps what is done."""
        path = deck({
            "Model": {"Physics": "plane strain", "Kinematics": "finite"},
            "Materials": {"m": {"Young's modulus": 1.0, "Poisson's ratio": 0.3}},
            "Bodies": {"block": block([0.0, 0.0], [1.0, 1.0], [2, 2], [3, 3], "Q1", "m")},
            "Steps": {"Number": 3, "Smallest step": 0.25},
            "Effects": {"Prescribed displacement": {
                "ground": {"Part": "block/bottom", "Components": ["x", "y"]},
                "press": {"Part": "block/top", "Components": ["x", "y"], "Displacement": [0.0, -1.2, 0.0]},
            }},
        })
        run = runs.run(path, np=runs.RANKS, program="harmos")
        self.assertNotEqual(run.returncode, 0)
        self.assertRegex(run.stderr, r"step \d of 3, from time .*(Newton's iterations do not converge|inside out|not stable)")
        rows = steps_of(run.directory)
        self.assertGreaterEqual(len(rows), 1)
        self.assertTrue(all(row["converged"] == 1 and math.isfinite(row["energy"]) for row in rows))

    def test_states_on_the_way_that_cannot_be_solved_for(self):
        """In four steps an iteration comes to bodies whose tangent is no stiffness: the step is halved, and the end is
        that of sixteen steps, for the material is elastic."""
        tree = {
            "Model": {"Physics": "plane strain", "Kinematics": "finite"},
            "Materials": {"m": {"Type": "neo-Hookean", "Young's modulus": 1.0, "Poisson's ratio": 0.3}},
            "Bodies": {"b": block([0.0, 0.0], [4.0, 0.5], [4, 1], [3, 2], "Q1", "m")},
            "Solver": {"Tolerance": 1e-7},
            "Effects": {
                "Prescribed displacement": {"g": {"Part": "b/left"}},
                "Traction": {"p": {"Part": "b/top", "Pressure": 0.004}},
                "Force": {"f": {"Part": "b/right", "Force": [-0.003, 0.001, 0.0]}},
            },
        }
        few, many = (
            steps_of(runs.solved(self, deck(tree | {"Steps": {"Number": steps}}), np=1, program="harmos").directory)
            for steps in (4, 16)
        )
        self.assertGreater(len(few), 4)
        for key in ("energy", "Prescribed displacement/g/fx", "Prescribed displacement/g/fy"):
            # Ten times the solver's tolerance.
            self.assertLess(abs(few[-1][key] / many[-1][key] - 1.0), 1e-6, key)

    def column(self, load, turn=0.0):
        """A column of length 8 and width 1/2, built in below, in plane strain, under a share of Euler's load."""
        euler = math.pi**2 / (1.0 - 0.3**2) * 0.5**3 / 12.0 / 4.0 / 8.0**2 / 0.5  # per area
        return {
            "Model": {"Physics": "plane strain", "Kinematics": "finite"},
            "Materials": {"m": {"Type": "neo-Hookean", "Young's modulus": 1.0, "Poisson's ratio": 0.3}},
            "Bodies": {"column": block([0.0, 0.0], [0.5, 8.0], [1, 4], [2, 4], "Q2", "m")},
            "Solver": {"Tolerance": 1e-8},
            "Steps": {"Number": 1, "Smallest step": 0.01},
            "Effects": {
                "Prescribed displacement": {"ground": {"Part": "column/bottom"}},
                "Traction": {"weight": {"Part": "column/top", "Density": [turn * load * euler, -load * euler, 0.0]}},
            },
        }

    def test_columns_beyond_their_critical_load(self):
        """A straight column stays straight to 0.97 of Euler's load (1744), and is not an answer
        beyond 1.03; one that is pushed aside bends and is one."""
        for np_ in (1, 2):
            runs.solved(self, deck(self.column(0.97)), np=np_, program="harmos")
            run = runs.run(deck(self.column(1.5)), np=np_, program="harmos")
            self.assertNotEqual(run.returncode, 0)
            self.assertRegex(run.stderr, r"not stable: bodies that are moved a little buckle, most of all at \(0\.[05]0*, 8\.0*, 0\.0*\)")
            reached = steps_of(run.directory)[-1]["time"] * 1.5
            self.assertTrue(0.97 < reached < 1.03, reached)
        bent = runs.solved(self, deck(self.column(1.5, 0.01)), np=runs.RANKS, program="harmos")
        _, u, _ = field(bent.directory, "displacement")
        self.assertGreater(np.abs(u[:, 0]).max(), 4.0)

    def test_ties_across_gaps(self):
        """Bodies tied across a gap would be strained where both turn: 1e-4 of the surface is allowed."""
        for gap, good in ((0.02, False), (5e-5, True)):
            run = runs.run(deck({
                "Model": {"Physics": "plane strain", "Kinematics": "finite"},
                "Materials": {"m": {"Young's modulus": 1.0, "Poisson's ratio": 0.3}},
                "Bodies": {
                    "one": block([0.0, 0.0], [1.0, 1.0], [1, 1], [3, 3], "Q1", "m"),
                    "two": block([0.0, 1.0 + gap], [1.0, 1.0], [1, 1], [2, 2], "Q1", "m"),
                },
                "Effects": {
                    "Tie": {"bond": {"First": "two/bottom", "Second": "one/top"}},
                    "Prescribed displacement": {"ground": {"Part": "one/bottom"}},
                    "Force": {"pull": {"Part": "two/top", "Force": [0.01, 0.0, 0.0]}},
                },
            }), np=runs.RANKS, program="harmos")
            self.assertEqual(run.returncode == 0, good, run.stderr)
            if not good:
                self.assertIn('tie "bond" takes distances of up to 2.00e-02 to be zero', run.stderr)

    def approach(self, stiffness, load, steps):
        """A stiff block on a weak spring, half its size above another one, far beyond the contact's reach."""
        return {
            "Model": {"Physics": "plane strain", "Kinematics": "finite"},
            "Materials": {"m": {"Type": "neo-Hookean", "Young's modulus": 1e3, "Poisson's ratio": 0.3}},
            "Bodies": {
                "upper": block([0.5, 1.5], [1.0, 1.0], [1, 1], [5, 5], "Q1", "m"),
                "lower": block([0.0, 0.0], [2.0, 1.0], [2, 1], [4, 4], "Q1", "m"),
            },
            "Steps": {"Number": steps},
            "Effects": {
                "Contact": {"joint": {"First": "upper/bottom", "Second": "lower/top", "Stiffness": stiffness}},
                "Prescribed displacement": {
                    "ground": {"Part": "lower/bottom"}, "guide": {"Part": "upper/top", "Components": ["x"]},
                },
                "Elastic foundation": {
                    "spring": {"Part": "upper/top", "Normal stiffness": 0.02, "Tangential stiffness": 0.02},
                },
                "Traction": {"push": {"Part": "upper/top", "Density": [0.0, -load, 0.0]}},
            },
        }

    def test_contacts_farther_than_their_reach(self):
        """A step that takes a block past what the search reaches is halved; the force is that of load less spring."""
        for steps in (1, 3):
            run = runs.solved(self, deck(self.approach(0.0, 0.02, steps)), np=runs.RANKS, program="harmos")
            force = steps_of(run.directory)[-1]["Contact/joint/fy"]
            # The spring is shorter by 0.5 and what the blocks give way, 0.01 / 1e3 · 2.
            self.assertAlmostEqual(force, 0.02 - 0.02 * 0.5, delta=1e-6)

    def test_contacts_that_give_way_beyond_their_reach(self):
        """A soft contact that sinks in by more is no answer: the reason names place and remedy. With a longer reach
        penetration is what load less spring presses, (P − k_s (0.5 + d)) / k = d."""
        tree = self.approach(0.02, 0.03, 4)
        run = runs.run(deck(tree), np=runs.RANKS, program="harmos")
        self.assertNotEqual(run.returncode, 0)
        self.assertRegex(run.stderr, r'contact "joint": .* overlap at \(.*\) by more than 1.00e-01.*longer "Reach"')
        tree["Effects"]["Contact"]["joint"]["Reach"] = 1.0
        run = runs.solved(self, deck(tree), np=runs.RANKS, program="harmos")
        self.assertAlmostEqual(steps_of(run.directory)[-1]["Contact/joint/fy"], 0.02 * 0.5, delta=1e-5)



if __name__ == "__main__":
    runs.main()
