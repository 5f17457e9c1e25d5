# SPDX-License-Identifier: BSD-3-Clause
"""Bodies in motion at finite displacements, or of materials that yield, against rigid bodies and waves: a body that
tumbles, a block that tips and falls with friction, blocks that collide in space, a bar that yields where it strikes.

What it guards against: inertia that does not turn with bodies; masses whose centre or moments are others; contacts that
give energy where steps are too long for an impact; forces of materials or of contacts that inertia is not in balance
with; runs that go on otherwise after a restart, or on other numbers of ranks.
"""

import math
import os
import signal
import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TESTS / "support"), str(TESTS / "verification/finite"), str(TESTS / "verification/physics")]

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from finite_scenes import block, deck, field, rotation, steps_of
    from test_transient import columns, fitted, steps
except ImportError as error:
    runs.skip(f"{error.name} is not installed")


def solid(origin, size, parts, cells):
    """Of cubes."""
    return {
        "Source": "block", "Origin": origin, "Size": size, "Subdomains a side": parts, "Elements a side": cells,
        "Element": "Q1", "Materials": ["m"],
    }


def material(young, **more):
    return {"m": {"Young's modulus": young, "Poisson's ratio": 0.3, "Density": 1.0} | more}


def lumped(sizes, cells):
    """∫x² of each axis about the centre, over the mass, of masses at nodes."""
    return np.array([size**2 / 12.0 * (1.0 + 2.0 / n**2) for size, n in zip(sizes, cells)])


def followed(slope, state, time, number=4000):
    """By Runge and Kutta."""
    step = time / number
    for _ in range(number):
        k1 = slope(state)
        k2 = slope(state + 0.5 * step * k1)
        k3 = slope(state + 0.5 * step * k2)
        k4 = slope(state + step * k3)
        state = state + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return state


class Tumbling(unittest.TestCase):
    def test_euler(self):
        """Free in space, about its middle axis, which is not stable: by Euler's equations of the rigid body, second order."""
        size, spin, speed, end = np.array([1.0, 0.6, 0.3]), np.array([0.1, 1.0, 0.1]), np.array([0.3, 0.0, 0.1]), 10.0
        squares = lumped(size, [4, 4, 4])
        inertia = squares.sum() - squares

        def slope(state):
            turned, rate = state[:9].reshape(3, 3), state[9:]
            x, y, z = rate
            return np.concatenate([
                (turned @ np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])).ravel(),
                -np.cross(rate, inertia * rate) / inertia,
            ])

        turned = followed(slope, np.concatenate([np.eye(3).ravel(), spin]), end)[:9].reshape(3, 3)
        whole = 0.5 * size.prod() * (inertia @ spin**2 + speed @ speed)
        errors, numbers = [], (50, 100, 200, 400)
        for number in numbers:
            tree = {
                "Model": {"Physics": "solid", "Kinematics": "finite"}, "Materials": material(1e5),
                "Bodies": {"block": solid([0.0, 0.0, 0.0], list(size), [2, 1, 1], [2, 4, 4])},
                "Steps": steps(end, number, 0.8), "Solver": {"Tolerance": 1e-8}, "Output": {"Every": number},
                "Effects": {"Initial velocity": {"v": {
                    "Body": "block", "Velocity": list(speed), "Angular velocity": list(spin), "Centre": list(0.5 * size)}}},
            }
            run = runs.solved(self, deck(tree), np=runs.RANKS, program="harmos")
            table = columns(run)
            x, u, _ = field(run.directory, "displacement")
            errors.append(np.abs(x + u - 0.5 * size - speed * end - (x - 0.5 * size) @ turned.T).max())
            for axis, part in zip("xyz", speed):
                self.assertLess(np.abs(table[f"momentum/{axis}"] - size.prod() * part).max(), 1e-10)
            # What is lost is of second order, too.
            self.assertLess(abs((table["kinetic"][-1] + table["energy"][-1]) / whole - 1.0), 40.0 / number**2)
            self.assertLess(table["newton"].mean(), 6.5 if number > 50 else 13.0)
        rate = -fitted(numbers[1:], errors[1:])
        runs.table("Body that tumbles", ("steps", "error of places"), [(n, f"{e:.1e}") for n, e in zip(numbers, errors)])
        self.assertTrue(1.8 < rate < 2.2, errors)


class Tipping(unittest.TestCase):
    """A block that is pushed over its edge: it turns about it, slides when friction no longer holds, and comes to rest
    on its side."""

    WIDTH, HEIGHT, CELLS, YOUNG, FRICTION = 1.0, 2.0, 4, 1e5, 0.8

    def rate(self):
        """Of the push: with it there is three times the energy that tipping takes."""
        return math.sqrt(6.0 * (math.hypot(self.WIDTH, self.HEIGHT) / 2.0 - self.HEIGHT / 2.0) / self.inertia(1.0))

    def inertia(self, less=0.0):
        """About the edge, over the mass; of the body itself (1), or of masses at nodes."""
        squares = np.array([self.WIDTH, self.HEIGHT])**2
        more = 1.0 + (1.0 - less) * 2.0 / np.array([self.CELLS, 2 * self.CELLS])**2
        return (squares * more).sum() / 12.0 + squares.sum() / 4.0

    def scene(self, end, number, every):
        edge = [self.WIDTH, 0.0, 0.0]
        return {
            "Model": {"Physics": "plane strain", "Kinematics": "finite"}, "Materials": material(self.YOUNG),
            "Bodies": {"block": block([0.0, 0.0], [self.WIDTH, self.HEIGHT], [1, 2], [self.CELLS, self.CELLS], "Q1", "m")},
            "Steps": steps(end, number, 0.8), "Solver": {"Tolerance": 1e-8}, "Output": {"Every": every},
            "Effects": {
                "Initial velocity": {"push": {"Body": "block", "Angular velocity": [0.0, 0.0, -self.rate()], "Centre": edge}},
                "Obstacle": {"floor": {"Part": "block/bottom"}, "side": {"Part": "block/right"}},
                "Friction": {name: {"Contact": name, "Coefficient": self.FRICTION} for name in ("floor", "side")},
                "Body force": {"weight": {"Body": "block", "Density": [0.0, -1.0, 0.0]}},
            },
        }

    def test_fall(self):
        step, end = 0.01, 7.0
        run = runs.solved(self, deck(self.scene(end, round(end / step), 25)), np=runs.RANKS, program="harmos")
        table = columns(run)
        radius, start = 0.5 * math.hypot(self.WIDTH, self.HEIGHT), math.atan2(self.WIDTH, self.HEIGHT)
        edge = np.array([self.WIDTH, 0.0])
        found = []
        for time in np.arange(0.25, 2.01, 0.25):
            angle = followed(
                lambda state: np.array([state[1], radius / self.inertia() * math.sin(state[0] - start)]),
                np.array([0.0, self.rate()]), time)[0]
            x, u, _ = field(run.directory, "displacement", round(time / step))
            turned = (x[:, :2] - edge) @ rotation(np.array([0.0, 0.0, -angle]))[:2, :2].T
            error = np.abs((x + u)[:, :2] - edge - turned).max()
            found.append((f"{time:.2f}", f"{angle:.4f}", f"{error:.1e}"))
            # Deflections under the weight, E/ρgh = 5e4, and what they become on the way, times e^{0.8 t}.
            self.assertLess(error, 0.01 * self.HEIGHT)
        runs.table("Block that tips", ("time", "angle", "error of places"), found)
        # No contact gives energy: friction, waves and impacts take it.
        whole = table["kinetic"] + table["energy"] + table["dissipated"] - table["external_work"]
        self.assertLess(whole.max() / whole[0], 1.002)
        self.assertGreater(table["dissipated"][-1], 0.01 * whole[0])
        # Friction is at its limit where all slips, and never above it.
        floor = [np.abs(table[f"Obstacle/floor/f{axis}"]) for axis in "xy"]
        self.assertLess((floor[0] - self.FRICTION * floor[1]).max(), 1e-6 * 2.0)
        # At rest on its side: all points of it closed, the weight on them.
        x, u, _ = field(run.directory, "displacement")
        lies = x[:, 0] > self.WIDTH - 1e-9
        self.assertLess(np.abs((x + u)[lies, 1]).max(), 1e-3)
        self.assertLess(np.abs((x + u)[~lies, 1].max() - self.WIDTH), 1e-3)
        self.assertLess(table["kinetic"][-1], 1e-3 * whole[0])
        # What contacts gave is what momentum and weight are, but for a step's force.
        for axis, weight in (("x", 0.0), ("y", 2.0)):
            given = sum(table[f"impulse/Obstacle/{name}/{axis}"] for name in ("floor", "side"))
            forces = sum(np.abs(table[f"Obstacle/{name}/f{axis}"]) for name in ("floor", "side"))
            error = np.abs(given - weight * table["time"] - table[f"momentum/{axis}"] + table[f"momentum/{axis}"][0])
            self.assertLess(error.max(), step * forces.max())

    def test_restart(self):
        """Gone on with in the middle of the fall: bit for bit."""
        path = deck(self.scene(2.6, 260, 1000))
        whole = runs.solved(self, path, np=2, program="harmos")
        run = runs.Background(path, {}, program="harmos")
        self.assertTrue(run.wait_until(lambda: "Step 230 of" in run.text()))
        os.kill(run.ranks()[0], signal.SIGTERM)
        run.end()
        self.assertIn("--restart", run.text())
        again = runs.start(["--restart", run.directory], 2, program="harmos")
        self.assertEqual(again.returncode, 0, again)
        one, other = steps_of(whole.directory), steps_of(run.directory)
        self.assertEqual(len(one), 260)
        for name in ("kinetic", "energy", "dissipated", "momentum/x", "impulse/Obstacle/floor/x", "newton"):
            self.assertEqual([row[name] for row in one], [row[name] for row in other], name)

    def test_ranks(self):
        tables = [columns(runs.solved(self, deck(self.scene(1.0, 50, 1000)), np=ranks, program="harmos")) for ranks in (1, 2, 4)]
        for table in tables[1:]:
            self.assertLess(np.abs(table["kinetic"] / tables[0]["kinetic"] - 1.0).max(), 1e-6)


class Collision(unittest.TestCase):
    def test_blocks_in_space(self):
        """One block strikes another off its centre, with friction: momentum stays, energy does not grow."""
        speed = 0.05
        bodies = {
            "struck": solid([0.0, 0.0, 0.0], [0.4, 0.4, 0.4], [1, 1, 1], [4, 4, 4]),
            "block": solid([0.42, 0.13, 0.07], [0.3, 0.3, 0.3], [1, 1, 1], [4, 4, 4]),
        }
        tree = {
            "Model": {"Physics": "solid", "Kinematics": "finite"}, "Materials": material(1.0), "Bodies": bodies,
            "Steps": steps(3.0, 150, 0.9), "Solver": {"Tolerance": 1e-8}, "Output": {"Every": 1000},
            "Effects": {
                "Contact": {"joint": {"First": "block/left", "Second": "struck/right"}},
                "Friction": {"f": {"Contact": "joint", "Coefficient": 0.3}},
                "Initial velocity": {"v": {"Body": "block", "Velocity": [-speed, 0.2 * speed, 0.0]}},
            },
        }
        table = columns(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
        mass = 0.3**3
        for axis, before in (("x", -mass * speed), ("y", 0.2 * mass * speed), ("z", 0.0)):
            self.assertLess(np.abs(table[f"momentum/{axis}"] - before).max(), 1e-7 * mass * speed)
        self.assertGreater(np.abs(table["impulse/Contact/joint/x"][-1]), 0.5 * mass * speed)
        whole = (table["kinetic"] + table["energy"] + table["dissipated"]) / (0.5 * mass * 1.04 * speed**2)
        self.assertLess(whole.max(), 1.002)
        self.assertGreater(whole[-1], 0.9)


class LongSteps(unittest.TestCase):
    """Longer than an impact: an average of contact forces would let a body part at up to three times its velocity."""

    def test_no_gain(self):
        for kinematics in ("small", "finite"):
            for young, step in ((1e4, 0.01), (1e4, 0.1), (1e6, 0.03)):
                tree = {
                    "Model": {"Physics": "plane stress" if kinematics == "small" else "plane strain", "Kinematics": kinematics},
                    "Materials": material(young),
                    "Bodies": {"block": block([0.0, 0.02], [0.2, 0.2], [1, 1], [4, 4], "Q1", "m")},
                    "Steps": steps(6.0, round(6.0 / step), 1.0 if kinematics == "small" else 0.8),
                    "Solver": {"Tolerance": 1e-8}, "Output": {"Every": 1000000},
                    "Effects": {
                        "Obstacle": {"floor": {"Part": "block/bottom"}},
                        "Body force": {"gravity": {"Body": "block", "Density": [0.0, -0.01, 0.0]}},
                    },
                }
                table = columns(runs.solved(self, deck(tree), np=1, program="harmos"))
                self.assertTrue((table["closed"] > 0).any())
                whole = (table["kinetic"] + table["energy"] - table["external_work"]) / (0.04 * 0.01 * 0.02)
                self.assertLess(whole.max(), 2e-3, (kinematics, young, step))


class Yielding(unittest.TestCase):
    def test_bar(self):
        """Linear hardening, rate independent (Donnell 1930; von Kármán, Duwez 1950): behind the plastic wave, which goes
        with √(E_t/ρ), the stress is σ_Y + ρc_p(v − σ_Y/ρc)."""
        speed, limit, tangent, width = 0.01, 0.005, 0.25, 0.02
        hardening = tangent / (1.0 - tangent)
        area, stress = width**2, limit + math.sqrt(tangent) * (speed - limit)
        # Of all that the plastic wave has passed; isotropic hardening stores nothing.
        work = 0.5 * (limit + stress) * (stress - limit) / hardening * math.sqrt(tangent) * area
        found, meshes = [], (32, 64, 128)
        for cells in meshes:
            tree = {
                "Model": {"Physics": "solid"},
                "Materials": {"m": {
                    "Young's modulus": 1.0, "Poisson's ratio": 0.0, "Density": 1.0,
                    "Plasticity": {"Yield stress": limit, "Isotropic hardening": hardening}}},
                "Bodies": {"bar": solid([0.0, 0.0, 0.0], [1.0, width, width], [2, 1, 1], [cells // 2, 1, 1])},
                "Steps": steps(1.0, 2 * cells, 0.8), "Solver": {"Tolerance": 1e-8}, "Output": {"Every": 1000000},
                "Effects": {"Obstacle": WALL, "Initial velocity": {"v": {"Body": "bar", "Velocity": [-speed, 0.0, 0.0]}}},
            }
            table = columns(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
            force = table["Obstacle/wall/fx"][table["time"] > 0.3] / (area * stress)
            whole = (table["kinetic"] + table["energy"] + table["dissipated"]) / (0.5 * area * speed**2)
            found.append((cells, abs(force.mean() - 1.0), np.abs(force - 1.0).max(), np.abs(whole - 1.0).max(),
                          abs(table["dissipated"][-1] / work - 1.0)))
        runs.table("Bar that yields", ("cells", "mean force", "largest", "energy", "dissipated"),
                   [(row[0], *(f"{value:.1e}" for value in row[1:])) for row in found])
        errors = [row[1] for row in found]
        self.assertGreater(-fitted(meshes, errors), 0.5)
        for value, most in zip(found[-1][1:], (0.01, 0.05, 0.01, 0.03)):
            self.assertLess(value, most)


WALL = {"wall": {"Part": "bar/left", "Direction": [1.0, 0.0, 0.0]}}

if __name__ == "__main__":
    runs.main()
