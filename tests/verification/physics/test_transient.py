# SPDX-License-Identifier: BSD-3-Clause
"""Bodies in motion against closed forms: a bar that strikes a wall, two bars, Hertz' impact of a ball, vibrations by their
modes, a block that bounces.

What it guards against: masses that are lost or counted twice; another rule of time integration; loads or forces of inertia
that are not the step's own; contact forces that ring; energy that comes from nowhere; runs that go on otherwise after a
restart, or on other numbers of ranks.
"""

import math
import os
import signal
import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TESTS / "support"), str(TESTS / "verification/finite")]

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from finite_scenes import block, deck, field, geometry, steps_of
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

# Of bars of unit length, modulus and density, whose waves have unit speed.
SPEED, HEIGHT = 0.01, 0.1
MASS = HEIGHT
STEEL = {"Young's modulus": 1.0, "Poisson's ratio": 0.0, "Density": 1.0}


def fitted(sizes, errors):
    return np.polyfit(np.log(sizes), np.log(errors), 1)[0]


def steps(end, number, radius, **more):
    return {"Number": number, "End time": end, "Time integration": "Newmark", "Spectral radius": radius} | more


def scene(bodies, effects, times, tolerance=1e-8):
    return {
        "Model": {"Physics": "plane stress"}, "Materials": {"m": STEEL}, "Bodies": bodies, "Steps": times,
        "Solver": {"Tolerance": tolerance}, "Output": {"Every": 1000000}, "Effects": effects,
    }


PARTS = 4


def bar(cells, left=0.0, parts=PARTS):
    return block([left, 0.0], [1.0, HEIGHT], [parts, 1], [cells // parts, 1], "Q1", "m")


WALL = {"wall": {"Part": "bar/left", "Direction": [1.0, 0.0, 0.0]}}


def moving(body, speed):
    return {"v": {"Body": body, "Velocity": [speed, 0.0, 0.0]}}


def columns(run):
    rows = steps_of(run.directory)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


class Bar(unittest.TestCase):
    """With velocity −v against a wall: contact until 2L/c with the force ρcvA, then v. Waves of steps are wider on coarse
    meshes: what is lost and the velocity of the rebound are compared on four."""

    def go(self, cells, ranks=2, radius=0.8, steps_a_cell=1.0, end=3.0):
        tree = scene({"bar": bar(cells)}, {"Obstacle": WALL, "Initial velocity": moving("bar", -SPEED)},
                     steps(end, round(end * cells * steps_a_cell), radius))
        return runs.solved(self, deck(tree), np=ranks, program="harmos")

    def test_rebound(self):
        energy, rebound, meshes = [], [], (32, 64, 128, 256)
        for cells in meshes:
            table = columns(self.go(cells))
            time, force = table["time"], table["Obstacle/wall/fx"] / (SPEED * HEIGHT)
            cell = 1.0 / cells
            self.assertLess(abs(time[force > 0.01].max() - 2.0), 2.01 * cell)
            # From seven cells' time on, and before the wave that ends it comes.
            steady = (time > 7.0 * cell) & (time < 2.0 - 12.0 * cell ** (2.0 / 3.0) / 2.0)
            self.assertTrue(steady.sum() > cells / 2)
            self.assertLess(np.abs(force[steady] - 1.0).max(), 0.05)
            all_of = table["kinetic"] + table["energy"]
            energy.append(1.0 - all_of[-1] / (0.5 * MASS * SPEED**2))
            rebound.append(1.0 - table["momentum/x"][-1] / (MASS * SPEED))
            # What the wall gave is what the bar has more.
            gained = table["momentum/x"] + MASS * SPEED
            self.assertLess(np.abs(table["impulse/Obstacle/wall/x"] - gained).max(), 0.005 * MASS * SPEED)
        runs.table("Bar against a wall", ("cells", "energy lost", "velocity lost"),
                   [(n, f"{e:.2e}", f"{r:.2e}") for n, e, r in zip(meshes, energy, rebound)])
        self.assertTrue(0.0 < energy[-1] < 0.01, energy)
        self.assertTrue(0.0 < rebound[-1] < 0.01, rebound)
        self.assertTrue(0.4 < -fitted(meshes, rebound) < 1.0, rebound)  # widths of fronts: as the power 2/3

    def test_energy_is_kept(self):
        """By the trapezoidal rule, while contact lasts: to the solver's tolerance. Impulses are exact, too."""
        table = columns(self.go(32, radius=1.0, end=1.5))
        all_of = (table["kinetic"] + table["energy"]) / (0.5 * MASS * SPEED**2)
        self.assertLess(np.abs(all_of - 1.0).max(), 1e-6)
        gained = table["momentum/x"] + MASS * SPEED
        self.assertLess(np.abs(table["impulse/Obstacle/wall/x"] - gained).max(), 1e-6 * MASS * SPEED)

    def test_ranks(self):
        tables = [columns(self.go(32, ranks)) for ranks in (1, 2, 4)]
        for table in tables[1:]:
            for name, scale in (("kinetic", MASS * SPEED**2), ("momentum/x", MASS * SPEED), ("Obstacle/wall/fx", MASS * SPEED)):
                self.assertLess(np.abs(table[name] - tables[0][name]).max(), 1e-6 * scale, name)

    def test_moved_end(self):
        """An end that moves with v from the beginning: the force on it is ρcvA, without ringing, until the wave is back."""
        for radius in (1.0, 0.8):
            held = {"end": {"Part": "bar/left", "Displacement": [SPEED, 0.0, 0.0], "History": "moved"}}
            times = steps(1.5, 48, radius, Histories={"moved": {"Times": [0.0, 1.5], "Values": [0.0, 1.5]}})
            tree = scene({"bar": bar(32)}, {"Prescribed displacement": held}, times)
            table = columns(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
            force = table["Prescribed displacement/end/fx"] / (SPEED * HEIGHT)
            self.assertLess(np.abs(force[8:] - 1.0).max(), 0.05, radius)
            # What the end gets at once, half a cell's mass, is work by the mean of no force and all.
            energy = (table["kinetic"] + table["energy"] - table["external_work"]) / (MASS * SPEED**2)
            self.assertLess(np.abs(energy).max(), 0.3 / 32.0)

    def test_two_bars(self):
        """Of equal bars one strikes, and the other leaves with its velocity."""
        cells = 128
        bodies = {"struck": bar(cells, -1.0), "bar": bar(cells)}
        contact = {"joint": {"First": "struck/right", "Second": "bar/left"}}
        tree = scene(bodies, {"Contact": contact, "Initial velocity": moving("bar", -SPEED)}, steps(3.0, 3 * cells, 0.8))
        run = runs.solved(self, deck(tree), np=runs.RANKS, program="harmos")
        table = columns(run)
        force = np.abs(table["Contact/joint/fx"]) / (0.5 * SPEED * HEIGHT)
        self.assertLess(abs(table["time"][force > 0.01].max() - 2.0), 1.5 / cells)
        self.assertLess(np.abs(table["momentum/x"] / (-MASS * SPEED) - 1.0).max(), 1e-6)
        x, velocity, _ = field(run.directory, "velocity")
        left = velocity[x[:, 0] < -0.5 - 1e-9, 0].mean(), velocity[x[:, 0] > 0.5 + 1e-9, 0].mean()
        _, moved, _ = field(run.directory, "displacement")
        apart = moved[x[:, 0] > 1.0 - 1e-9, 0].mean() - moved[x[:, 0] < -1.0 + 1e-9, 0].mean()
        # Each bar's end: the struck one leaves with v for t − 1 of its own time; the other one stays.
        self.assertLess(abs(apart / (SPEED * 1.0) - 1.0), 0.05, left)


class Rates(unittest.TestCase):
    """Of a bar, against the same mesh in exact time."""

    FEW, CELLS = 4, 16 # few: steps resolve all modes

    def chain(self, n, massless):
        """Stiffness and masses of the bar, per unit of height."""
        stiffness = n * (2.0 * np.eye(n + 1) - np.eye(n + 1, k=1) - np.eye(n + 1, k=-1))
        stiffness[0, 0] = stiffness[-1, -1] = n
        masses = np.full(n + 1, 1.0 / n)
        masses[-1] = 0.5 / n
        masses[0] = 0.0 if massless else 0.5 / n
        masses[1] *= 1.5 if massless else 1.0
        if massless: # the centre of the part stays, by a factor that is linear along it
            part = n // PARTS
            x = np.linspace(-1.0, 1.0, part + 1)
            lumped = np.concatenate([[0.5], np.ones(part - 1), [0.5]]) / n
            moved = lumped.copy()
            moved[:2] = 0.0, 1.5 / n
            basis = np.vstack([np.ones(part + 1), x])
            factor = np.linalg.solve((basis * moved) @ basis.T, basis @ (lumped - moved))
            masses[:part + 1] += moved * (factor @ basis)
        return stiffness, masses

    END = 3.0
    PULL = {
        "Prescribed displacement": {"clamp": {"Part": "bar/left", "Displacement": [0.0, 0.0, 0.0]}},
        "Traction": {"pull": {"Part": "bar/right", "Density": [1.0, 0.0, 0.0], "History": "rise"}},
    }

    def pulled(self, number, radius, **more):
        """Clamped, under a traction that rises with time: u = Σ φ_k f_k (t − sin ω_k t/ω_k)/ω_k². @return the run and the
        largest error of displacements, relative."""
        stiffness, masses = self.chain(self.FEW, False)
        stiffness, masses = stiffness[1:, 1:], masses[1:]
        root = 1.0 / np.sqrt(masses)
        squares, modes = np.linalg.eigh(root[:, None] * stiffness * root[None, :])
        shapes, load = root[:, None] * modes, np.zeros(self.FEW)
        load[-1] = 1.0
        pulse = self.END - np.sin(np.sqrt(squares) * self.END) / np.sqrt(squares)
        exact = np.append(0.0, shapes @ (shapes.T @ load * pulse / squares))
        histories = {"rise": {"Times": [0.0, self.END], "Values": [0.0, self.END]}}
        times = steps(self.END, number, radius, Histories=histories, **more)
        run = runs.solved(self, deck(scene({"bar": bar(self.FEW)}, self.PULL, times, 1e-11)), np=runs.RANKS, program="harmos")
        x, moved, _ = field(run.directory, "displacement")
        along = np.interp(x[:, 0], np.linspace(0.0, 1.0, self.FEW + 1), exact)
        return run, np.abs(moved[:, 0] - along).max() / along.max()

    def test_vibration(self):
        """Second order."""
        for radius in (1.0, 0.5, 0.0):
            numbers = (48, 96, 192, 384)
            errors = [self.pulled(number, radius)[1] for number in numbers]
            rate = -fitted(numbers, errors)
            self.assertTrue(1.8 < rate < 2.2, (radius, rate, errors))

    def test_steps_by_error(self):
        """The error of periods that is asked for is that of what comes out, in proportion; steps go as its root."""
        asked, found = (1e-2, 1e-3, 1e-4), []
        for error in asked:
            run, reached = self.pulled(3, 1.0, **{"Time error": error, "Smallest step": 1e-4})
            time = np.append(0.0, columns(run)["time"])
            lengths = np.diff(time)
            self.assertEqual(time[-1], self.END)
            found.append((error, reached, len(lengths), lengths.max() / lengths.min()))
        runs.table("Steps by the error of periods", ("asked", "of displacements", "steps", "longest over shortest"),
                   [(f"{a:g}", f"{e:.1e}", n, f"{r:g}") for a, e, n, r in found])
        for error, reached, _, _ in found:
            self.assertTrue(error / 50.0 < reached < 2.0 * error, (error, reached))
        rate = fitted(asked, [row[2] for row in found])
        self.assertTrue(-0.65 < rate < -0.35, found)

    def test_contact(self):
        """Against a wall: momentum while contact lasts and the time at which it ends. First order or better."""
        stiffness, masses = self.chain(self.CELLS, True)
        tiny, end = 1.0 / 16384.0, 3.0
        # Central differences; the massless node is in equilibrium: at the wall, or without force.
        place, velocity = np.zeros(self.CELLS + 1), np.full(self.CELLS + 1, -SPEED)
        ends = 0.0
        for step in range(round(end / tiny)):
            place[0] = max(0.0, place[1])
            force = -stiffness @ place
            velocity[1:] += tiny * force[1:] / masses[1:]
            place[1:] += tiny * velocity[1:]
            if place[0] == 0.0 and place[1] < 0.0:
                ends = (step + 1) * tiny
        momentum = masses[1:] @ velocity[1:]
        errors, numbers = [], (48, 96, 192, 384)
        for number in numbers:
            tree = scene({"bar": bar(self.CELLS)}, {"Obstacle": WALL, "Initial velocity": moving("bar", -SPEED)},
                         steps(end, number, 1.0))
            table = columns(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
            errors.append(abs(table["momentum/x"][-1] / (momentum * HEIGHT) - 1.0))
            last = table["time"][table["Obstacle/wall/fx"] > 0.0].max()
            self.assertLess(abs(last - ends), 1.01 * end / number)
        rate = -fitted(numbers, errors)
        self.assertTrue(1.0 < rate < 2.6, (rate, errors))


class Impact(unittest.TestCase):
    def test_hertz(self):
        """A ball against a rigid floor (Johnson: Contact Mechanics, 1985, 11.1): contact lasts 2.87 (m²/RE*²v)^⅕, and the
        largest force is 4/3 E* R^½ δ^{3/2}, δ = (15mv²/16E*R^½)^⅖. Waves, which that leaves out, take as good as nothing
        of a slow ball's energy. Radii of contact are a hundredth of the ball's: circles differ from parabolas by less."""
        speed, poisson, ball = 1e-5, 0.3, 4.0 / 3.0 * math.pi
        modulus = 1.0 / (1.0 - poisson**2)
        depth = (15.0 * ball * speed**2 / (16.0 * modulus)) ** 0.4
        lasts = 2.87 * (ball**2 / (modulus**2 * speed)) ** 0.2
        largest = 4.0 / 3.0 * modulus * depth**1.5
        skin = 0.08
        mesh = geometry(f"""
            Point(1) = {{0, 0, 0, 0.002}}; Point(2) = {{0, 1, 0, 0.15}}; Point(3) = {{1, 1, 0, 0.15}};
            Point(4) = {{0, 2, 0, 0.15}}; Point(5) = {{{math.sin(skin)}, {1.0 - math.cos(skin)}, 0, 0.002}};
            Circle(1) = {{1, 2, 5}}; Circle(2) = {{5, 2, 3}}; Circle(3) = {{3, 2, 4}}; Line(4) = {{4, 2}}; Line(5) = {{2, 1}};
            Curve Loop(1) = {{1, 2, 3, 4, 5}}; Plane Surface(1) = {{1}}; Mesh.ElementOrder = 2;
            Physical Curve("skin") = {{1}}; Physical Surface("ball") = {{1}};
        """)
        tree = {
            "Model": {"Physics": "axisymmetric", "Mesh file": mesh},
            "Materials": {"m": {"Young's modulus": 1.0, "Poisson's ratio": poisson, "Density": 1.0}},
            "Bodies": {"ball": {"Materials": ["m"], "Subdomains": 4}},
            "Steps": steps(1.1 * lasts, 400, 0.8), "Solver": {"Tolerance": 1e-7}, "Output": {"Every": 1000000},
            "Effects": {
                "Obstacle": {"floor": {"Part": "ball/skin", "Direction": [0.0, 1.0, 0.0]}},
                "Initial velocity": {"fall": {"Body": "ball", "Velocity": [0.0, -speed, 0.0]}},
            },
        }
        table = columns(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
        force = table["Obstacle/floor/fy"]
        ended, peak = table["time"][force > 1e-6 * largest].max() / lasts, force.max() / largest
        rebound = table["momentum/y"][-1] / (ball * speed)
        runs.table("Ball against a floor, by Hertz", ("duration", "largest force", "rebound"),
                   [(f"{ended:.4f}", f"{peak:.4f}", f"{rebound:.6f}")])
        self.assertLess(abs(ended - 1.0), 0.01)
        self.assertLess(abs(peak - 1.0), 0.01)
        self.assertLess(abs(rebound - 1.0), 1e-3)


class Bouncing(unittest.TestCase):
    def test_twenty(self):
        """Under gravity, on a floor: what all impacts up to the twentieth leave is not more than what there was. Within
        one impact the trapezoidal rule may give a little, of second order in the length of steps."""
        fall, gravity, end = 0.02, 0.01, 50.0
        tree = {
            "Model": {"Physics": "plane stress"},
            "Materials": {"m": {"Young's modulus": 1.0, "Poisson's ratio": 0.3, "Density": 1.0}},
            "Bodies": {"block": block([0.0, fall], [0.2, 0.2], [2, 1], [2, 4], "Q1", "m")},
            "Steps": steps(end, 5000, 0.9), "Solver": {"Tolerance": 1e-8}, "Output": {"Every": 1000000},
            "Effects": {
                "Obstacle": {"floor": {"Part": "block/bottom", "Direction": [0.0, 1.0, 0.0]}},
                "Body force": {"gravity": {"Body": "block", "Density": [0.0, -gravity, 0.0]}},
            },
        }
        table = columns(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
        closed = table["closed"] > 0
        hits = np.flatnonzero(closed[1:] & ~closed[:-1]) + 1
        self.assertGreaterEqual(len(hits), 20)
        first = math.sqrt(2.0 * fall / gravity)
        self.assertLess(abs(table["time"][hits[0]] / first - 1.0), 0.011)
        # Relative to the fall's energy; the work of gravity is counted from the beginning.
        whole = (table["kinetic"] + table["energy"] - table["external_work"]) / (0.04 * gravity * fall)
        between = [whole[hit - 1] for hit in hits]
        runs.table("Block that bounces", ("impacts", "largest gain", "lost", "largest gain of an impact"),
                   [(len(hits), f"{whole.max():.1e}", f"{-whole[-1]:.1e}", f"{np.diff(between).max():.1e}")])
        self.assertLess(whole.max(), 5e-3)
        self.assertLess(np.diff(between).max(), 5e-3)
        self.assertTrue(0.0 < -whole[-1] < 0.03)


class Laws(unittest.TestCase):
    """Friction and adhesion of bodies in motion."""

    def test_friction(self):
        """A block that slides on a floor: while all of it slips the impulse of friction is that of pressure times the
        coefficient, whatever the pressure does; the work is the energy that goes."""
        friction, gravity, speed, mass = 0.3, 0.01, 0.02, 0.08
        tree = scene({"block": block([0.0, 0.0], [0.4, 0.2], [2, 1], [4, 4], "Q1", "m")}, {
            "Obstacle": {"floor": {"Part": "block/bottom", "Direction": [0.0, 1.0, 0.0]}},
            "Friction": {"dry": {"Contact": "floor", "Coefficient": friction}},
            "Body force": {"gravity": {"Body": "block", "Density": [0.0, -gravity, 0.0]}},
            "Initial velocity": moving("block", speed),
        }, steps(10.0, 1000, 0.8))
        table = columns(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
        along, down = table["impulse/Obstacle/floor/x"], table["impulse/Obstacle/floor/y"]
        slips = table["time"] < 5.0
        self.assertLess(np.abs(along + friction * down)[slips].max(), 1e-6 * mass * speed)
        self.assertLess(np.abs(table["momentum/x"] - mass * speed - along).max(), 1e-4 * mass * speed)
        energy = (table["kinetic"] + table["energy"] + table["dissipated"] - table["external_work"]) / (0.5 * mass * speed**2)
        self.assertLess(np.abs(energy - 1.0).max(), 3e-3)
        self.assertGreater(table["dissipated"][-1], 0.95 * 0.5 * mass * speed**2)
        # It stops at v/μg, but for how it rocks.
        self.assertLess(np.abs(table["momentum/x"][table["time"] > 1.2 * speed / (friction * gravity)]).max(), 0.05 * mass * speed)

    def test_adhesion(self):
        """Two glued bars, of which one is on its way: the bond breaks, takes its fracture energy, and all else stays."""
        speed, tough = 0.02, 5e-6
        half = {name: block([left, 0.0], [1.0, HEIGHT], [2, 1], [16, 2], "Q1", "m") for name, left in (("still", -1.0), ("bar", 0.0))}
        glue = {
            "Contact": "joint", "Normal stiffness": 100.0, "Tangential stiffness": 100.0, "Normal strength": 0.005,
            "Tangential strength": 0.005, "Fracture energy": tough, "Fracture energy II": tough,
        }
        errors, numbers = [], (192, 384, 768)
        for number in numbers:
            tree = scene(half, {
                "Contact": {"joint": {"First": "still/right", "Second": "bar/left"}}, "Adhesion": {"glue": glue},
                "Initial velocity": moving("bar", speed),
            }, steps(3.0, number, 0.8))
            table = columns(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
            self.assertEqual(table["broken"][-1], 3)
            self.assertLess(abs(table["dissipated"][-1] / (tough * HEIGHT) - 1.0), 1e-6)
            self.assertLess(np.abs(table["momentum/x"] / (MASS * speed) - 1.0).max(), 1e-6)
            energy = table["kinetic"] + table["energy"] + table["dissipated"]
            errors.append(np.abs(energy / (0.5 * MASS * speed**2) - 1.0).max())
        self.assertLess(errors[-1], 1e-4)
        self.assertGreater(-fitted(numbers, errors), 1.0)


class CoarseVectors(unittest.TestCase):
    def test_steps_of_any_length(self):
        """Vectors made of K + κM hold the rigid motions of parts at long steps, and none at short ones: applications stay
        what they are from 1e-4 to 100 first periods (about 4, of a block of unit length, modulus and density), on 16 and 64
        parts, clamped and floating; at 1e4 periods rounding errors of K + κM are those of solutions."""
        found = []
        for parts, clamped, length in [(8, c, d) for c in (True, False) for d in (1e-4, 1e-2, 1.0, 100.0)] + [
            (4, True, 1.0), (4, False, 100.0), (8, False, 1e4),
        ]:
            tree = {
                "Model": {"Physics": "plane strain"},
                "Materials": {"m": {"Young's modulus": 1.0, "Poisson's ratio": 0.3, "Density": 1.0}},
                "Bodies": {"block": block([0.0, 0.0], [1.0, 1.0], [parts, parts], [8, 8], "Q1", "m")},
                "Steps": steps(8.0 * length, 2, 0.8), "Solver": {"Tolerance": 1e-6}, "Output": {"Every": 1000000},
                "Dual operator": {"Expert": {"Adaptive coarse vectors": "all"}},
                "Effects": {
                    "Obstacle": {"floor": {"Part": "block/bottom", "Direction": [0.0, 1.0, 0.0]}},
                    "Body force": {"gravity": {"Body": "block", "Density": [0.05, -1.0, 0.0]}},
                    "Initial velocity": {"fall": {"Body": "block", "Velocity": [0.0, -0.1, 0.0]}},
                },
            }
            if clamped:
                tree["Effects"]["Prescribed displacement"] = {"side": {"Part": "block/left", "Displacement": [0.0, 0.0, 0.0]}}
            table = columns(runs.solved(self, deck(tree), np=runs.RANKS, program="harmos"))
            found.append((parts**2, "clamped" if clamped else "floats", f"{length:g}", int(table["products"].max())))
        runs.table("Applications of F by the length of steps", ("parts", "block", "periods", "most of a step"), found)
        self.assertLessEqual(max(row[3] for row in found), 32)


class Restart(unittest.TestCase):
    def test_bits(self):
        """Stopped between two steps and gone on with, results are those of one run, bit for bit."""
        tree = scene({"bar": bar(128)}, {"Obstacle": WALL, "Initial velocity": moving("bar", -SPEED)}, steps(1.5, 1200, 0.8))
        path = deck(tree)
        whole = runs.solved(self, path, np=2, program="harmos")
        run = runs.Background(path, {}, program="harmos")
        self.assertTrue(run.wait_until(lambda: "Step 300 of" in run.text()))
        os.kill(run.ranks()[0], signal.SIGTERM)
        run.end()
        self.assertIn("--restart", run.text())
        again = runs.start(["--restart", run.directory], 2, program="harmos")
        self.assertEqual(again.returncode, 0, again)
        for name in ("displacement", "velocity"):
            self.assertTrue((field(run.directory, name)[1] == field(whole.directory, name)[1]).all(), name)
        one, other = steps_of(whole.directory), steps_of(run.directory)
        self.assertEqual(len(one), 1200)
        for name in ("kinetic", "energy", "momentum/x", "impulse/Obstacle/wall/x"):
            self.assertEqual([row[name] for row in one], [row[name] for row in other], name)


class Refusals(unittest.TestCase):
    """By name, with what to change."""

    def test_what_lacks_or_does_not_go_with_it(self):
        def refused(change, *words):
            tree = scene({"bar": bar(8)}, {"Initial velocity": moving("bar", 1.0)}, steps(1.0, 2, 1.0))
            tree["Materials"] = {"m": dict(STEEL)}
            change(tree)
            run = runs.start([deck(tree)], 2, program="harmos")
            self.assertNotEqual(run.returncode, 0)
            for word in words:
                self.assertIn(word, str(run.errors))

        refused(lambda tree: tree["Materials"]["m"].pop("Density"), "Density", "bar")
        refused(lambda tree: tree["Steps"].pop("Time integration"), "initial velocity", "Newmark")
        refused(lambda tree: tree["Steps"].update({"Time error": -1.0}), "Time error")
        refused(lambda tree: tree["Effects"].update({"Initial velocity": {"v": {
            "Body": "bar", "Angular velocity": [1.0, 0.0, 0.0]}}}), "plane")


if __name__ == "__main__":
    runs.main()
