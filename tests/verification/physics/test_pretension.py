# SPDX-License-Identifier: BSD-3-Clause
"""Bolts under pretension: by force, then locked; by a shift; against bars and against equilibrium.

A bar of length L and stiffness EA, held at both ends, is cut in the middle and pulled together, without sideways
contraction. One end moves by d once the bolt is locked:

    s = F L/EA,   u linear in each half,   F(d) = F + EA d/L while the bolt keeps its length

What it guards against: forces of another sign, size or direction, on axes that are not those of the coordinates; a bolt
that gives way when it is locked, or keeps its length before; work and moments that are lost; other answers on other ranks
and after a restart.
"""

import csv
import os
import signal
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

YOUNG, LENGTH, FORCE, MOVE = 200.0, 4.0, 3.0, 0.02
AREA = 0.5 * 0.75
ANGLE = 0.5  # of the bar about z, then about x
STIFFNESS = YOUNG * AREA / LENGTH
TOLERANCE = 1e-10  # of the solver



def turned(x):
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    x = np.array([c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]])
    return np.array([x[0], c * x[1] - s * x[2], s * x[1] + c * x[2]])


# A bar along x in two volumes with a common face, turned.
AXIS = turned([1.0, 0.0, 0.0])
POINTS = "".join(f"Point({k}) = {{{', '.join(map(repr, turned([0.0, y, z]).tolist()))}, 0.5}};\n"
                 for k, (y, z) in enumerate(((0, 0), (0.5, 0), (0.5, 0.75), (0, 0.75)), 1))
HALF = ", ".join(map(repr, (LENGTH / 2 * AXIS).tolist()))
GEO = f"""{POINTS}
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 1}};
Curve Loop(1) = {{1, 2, 3, 4}}; Plane Surface(1) = {{1}};
a[] = Extrude {{{HALF}}} {{ Surface{{1}}; }};
b[] = Extrude {{{HALF}}} {{ Surface{{a[0]}}; }};
Physical Volume("lower") = {{a[1]}}; Physical Volume("upper") = {{b[1]}};
Physical Surface("bottom") = {{1}}; Physical Surface("cut") = {{a[0]}}; Physical Surface("top") = {{b[0]}};
"""
CENTRE = turned([LENGTH / 2, 0.25, 0.375])  # of the cut


def parameters(**values):
    kinds = {bool: "bool", int: "int", float: "double"}
    return "".join(f'<Parameter name="{name.replace("_", " ")}" type="{kinds.get(type(value), "string")}" value="{value}"/>'
                   for name, value in values.items())


def arrays(**values):
    return "".join(f'<Parameter name="{name}" type="Array({"string" if isinstance(value[0], str) else "double"})" '
                   f'value="{{{", ".join(map(str, value))}}}"/>' for name, value in values.items())


def named(name, text):
    return f'<ParameterList name="{name}">{text}</ParameterList>\n'


def deck(bolt, top, steps="", order=1, parts=3):
    """top: what acts on the upper end."""
    bodies = "".join(named(body, arrays(Materials=["steel"]) + parameters(Subdomains=parts)) for body in ("lower", "upper"))
    effects = (named("Pretension", named("bolt", parameters(First="lower/cut", Second="upper/cut", **bolt)))
               + named("Prescribed displacement", named("bottom", parameters(Part="lower/bottom")) + top[0]) + top[1])
    return named("", named("Model", parameters(Physics="solid", Mesh_file=f"bar{order}.geo"))
                 + named("Materials", named("steel", '<Parameter name="Young\'s modulus" type="double" value="200"/>'
                                            '<Parameter name="Poisson\'s ratio" type="double" value="0"/>'))
                 + named("Bodies", bodies) + steps + named("Effects", effects))


def held(move=0.0, history=""):
    values = arrays(Displacement=(move * AXIS).tolist())
    return named("top", parameters(Part="upper/top") + values + (parameters(History=history) if history else "")), ""


def histories(times, **values):
    lists = "".join(named(name, arrays(Times=[0.0, *times], Values=[0.0, *of])) for name, of in values.items())
    return named("Steps", arrays(Times=list(times)) + named("Histories", lists))


class Case(unittest.TestCase):
    def setUp(self):
        self.directory = runs.scratch("bolt")
        self.directory.mkdir(parents=True, exist_ok=True)
        for order in (1, 2):
            (self.directory / f"bar{order}.geo").write_text(GEO + f"Mesh.ElementOrder = {order};\n", encoding="utf-8")

    def solved(self, text, np_=2, status=0, extra=(), **sets):
        (self.directory / "deck.xml").write_text(text, encoding="utf-8")
        run = runs.run(self.directory / "deck.xml", {"Solver/Tolerance": TOLERANCE} | sets, np=np_,
                       output=self.directory / "out", program="harmos", extra=extra)
        self.assertEqual(run.returncode, status, f"{run}")
        return run

    def expect_bar(self, run, force, move, name="result.vtkhdf"):
        """Fields: strain F/EA in both halves, fixed at the ends."""
        with h5py.File(Path(run.directory) / name, "r") as file:
            root = file["VTKHDF"]
            x, u = root["Points"][()], root["PointData/displacement"][()]
            first = np.cumsum(root["NumberOfCells"][()]) - root["NumberOfCells"][()]
            body = np.repeat(root["CellData/body"][()].ravel()[first], root["NumberOfPoints"][()])
        along = x @ AXIS
        strain = force / (YOUNG * AREA)
        exact = np.where(body == 0, strain * along, move + strain * (along - LENGTH))[:, None] * AXIS
        np.testing.assert_allclose(u, exact, rtol=0.0, atol=1e-7 * np.abs(exact).max())

    def expect_force(self, entry, force):
        np.testing.assert_allclose(entry["force"], force * AXIS, atol=1e-7 * FORCE)
        np.testing.assert_allclose(entry["moment"], np.cross(CENTRE, force * AXIS), atol=1e-6 * FORCE)


class OneState(Case):
    def test_force(self):
        for order, np_ in ((1, 1), (2, 2), (1, 4)):
            with self.subTest(order=order, ranks=np_):
                run = self.solved(deck({"Force": FORCE}, held(), order=order), np_)
                self.expect_bar(run, FORCE, 0.0)
                self.expect_force(run.summary["forces"]["Pretension/bolt"], FORCE)
                work = 0.5 * FORCE**2 / STIFFNESS
                for column in ("energy", "external_work"):
                    self.assertAlmostEqual(run.summary["steps"][0][column], work, delta=1e-7 * work)

    def test_shift(self):
        run = self.solved(deck({"Shift": FORCE / STIFFNESS}, held()))
        self.expect_bar(run, FORCE, 0.0)
        self.expect_force(run.summary["forces"]["Pretension/bolt"], FORCE)
        work = 0.5 * FORCE**2 / STIFFNESS
        self.assertAlmostEqual(run.summary["steps"][0]["external_work"], work, delta=1e-7 * work)

    def test_half_of_a_bolt(self):
        # Along x, with a plane of symmetry through the cut: what is held on both sides is no row.
        straight = GEO
        for k, (y, z) in enumerate(((0, 0), (0.5, 0), (0.5, 0.75), (0, 0.75)), 1):
            head = straight.index(f"Point({k}) = ")
            end = straight.index(";", head)
            straight = straight[:head] + f"Point({k}) = {{0, {y}, {z}, 0.5}}" + straight[end:]
        straight = straight.replace(HALF, f"{LENGTH / 2}, 0, 0")
        straight += 'Physical Surface("plane") = {a[2], b[2]};\nMesh.ElementOrder = 2;\n'
        (self.directory / "bar1.geo").write_text(straight, encoding="utf-8")
        planes = "".join(named(f"plane of {body}", parameters(Part=f"{body}/plane") + arrays(Components=["z"]))
                         for body in ("lower", "upper"))
        run = self.solved(deck({"Force": FORCE}, (held()[0] + planes, "")))
        entry = run.summary["forces"]["Pretension/bolt"]
        np.testing.assert_allclose(entry["force"], [FORCE, 0, 0], atol=1e-8)
        np.testing.assert_allclose(entry["moment"], np.cross([2, 0.25, 0.375], [FORCE, 0, 0]), atol=1e-7)
        with h5py.File(Path(run.directory) / "result.vtkhdf", "r") as file:
            x, u = file["VTKHDF/Points"][()], file["VTKHDF/PointData/displacement"][()]
        np.testing.assert_allclose(u[:, 1:], 0.0, atol=1e-8)
        inner = np.abs(x[:, 0] - LENGTH / 2) > 1e-6
        exact = FORCE / (YOUNG * AREA) * np.where(x[:, 0] < LENGTH / 2, x[:, 0], x[:, 0] - LENGTH)
        np.testing.assert_allclose(u[inner, 0], exact[inner], atol=1e-7 * np.abs(exact).max())

    def test_a_free_bolt_keeps_its_force(self):
        run = self.solved(deck({"Force": FORCE}, held(MOVE)))
        self.expect_bar(run, FORCE, MOVE)

    def test_a_cut_bears_shear_and_bending(self):
        # The upper half is free, under a force across: the cut passes it on, with its moment.
        load = np.array([0.3e-3, -0.2e-3, 0.9e-3])
        load -= load.dot(AXIS) * AXIS
        traction = named("Traction", named("push", parameters(Part="upper/top") + arrays(Density=(load / AREA).tolist())))
        for order in (1, 2):
            run = self.solved(deck({"Shift": 1e-3}, ("", traction), order=order))
            entry = run.summary["forces"]["Pretension/bolt"]
            np.testing.assert_allclose(entry["force"], load, atol=1e-10)
            end = turned([LENGTH, 0.25, 0.375])
            np.testing.assert_allclose(entry["moment"], np.cross(end, load), atol=1e-9)


class Steps(Case):
    times = (1.0, 2.0, 3.0, 4.0)
    moves = (0.0, 1.0, -4.0, 0.0)  # so that the bolt pushes for a while

    def text(self, parts=3):
        steps = histories(self.times, tighten=(1.0, 1.0, 0.5, 0.5), move=self.moves)
        return deck({"Force": FORCE, "Locked from": 1.0, "History": "tighten"}, held(MOVE, "move"), steps, parts=parts)

    def check(self, run):
        with open(Path(run.directory) / "steps.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(self.times))
        for k, (row, move) in enumerate(zip(rows, self.moves), 1):
            with self.subTest(step=k):
                force = FORCE + STIFFNESS * MOVE * move
                along = np.array([float(row[f"Pretension/bolt/f{c}"]) for c in "xyz"])
                np.testing.assert_allclose(along, force * AXIS, atol=1e-7 * FORCE)
                energy = 0.5 * force**2 / STIFFNESS
                for column in ("energy", "external_work"):
                    self.assertAlmostEqual(float(row[column]), energy, delta=1e-7 * FORCE**2 / STIFFNESS, msg=column)
                self.expect_bar(run, force, MOVE * move, f"result_000{k}.vtkhdf")

    def test_locked_after_tightening(self):
        for np_ in (1, 2, 4):
            with self.subTest(ranks=np_):
                run = self.solved(self.text(), np_)
                self.check(run)
                self.assertIn(f'pretension "bolt" is locked at a shift of {FORCE / STIFFNESS:.6e}', run.stdout)

    def test_restart_keeps_the_length(self):
        # Many steps, to be stopped in the middle of.
        times = [float(k) for k in range(1, 121)]
        steps = histories(times, tighten=[1.0] * 120, move=[(k - 1) / 119 for k in range(1, 121)])
        text = deck({"Force": FORCE, "Locked from": 2.0, "History": "tighten"}, held(MOVE, "move"), steps)
        (self.directory / "deck.xml").write_text(text, encoding="utf-8")
        sets = {"Solver/Tolerance": TOLERANCE, "Output/Fields": False}
        run = runs.Background(self.directory / "deck.xml", sets, program="harmos")
        path = run.directory / "steps.csv"
        run.wait_until(lambda: path.is_file() and len(path.read_bytes().splitlines()) > 10)
        os.kill(run.ranks()[0], signal.SIGTERM)
        self.assertEqual(run.end(), 4, run.text())
        with open(path, newline="", encoding="utf-8") as file:
            self.assertLess(len(list(csv.DictReader(file))), 120)
        again = runs.start(["--restart", run.directory, "--output", run.directory], 1, program="harmos")
        self.assertEqual(again.returncode, 0, again)
        self.assertIn("Restart after", again.stdout)
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 120)
        for k, row in enumerate(rows):
            along = np.array([float(row[f"Pretension/bolt/f{c}"]) for c in "xyz"])
            force = FORCE + STIFFNESS * MOVE * max(0, k - 1) / 119
            np.testing.assert_allclose(along, force * AXIS, atol=1e-7 * FORCE, err_msg=f"step {k + 1}")

    def test_two_times_the_bolts_force_without_a_lock(self):
        text = self.text().replace('<Parameter name="Locked from" type="double" value="1.0"/>', "")
        run = self.solved(text)
        with open(Path(run.directory) / "steps.csv", newline="", encoding="utf-8") as file:
            forces = [np.linalg.norm([float(row[f"Pretension/bolt/f{c}"]) for c in "xyz"]) for row in csv.DictReader(file)]
        np.testing.assert_allclose(forces, [FORCE, FORCE, FORCE / 2, FORCE / 2], atol=1e-7)


class Refused(Case):
    def refused(self, said, bolt, **more):
        run = self.solved(deck(bolt, held(), **more), 2, status=2)
        self.assertIn(said, run.stderr)

    def test_settings(self):
        self.refused('neither "Force" nor "Shift"', {})
        self.refused('both "Force" and "Shift"', {"Force": 1.0, "Shift": 1.0})
        self.refused("is not the end of a step", {"Force": 1.0, "Locked from": 1.0})

    def test_sides_that_do_not_match(self):
        text = deck({"Force": 1.0}, held()).replace("lower/cut", "lower/bottom").replace("upper/cut", "upper/top")
        run = self.solved(text, 2, status=2)
        self.assertIn("has no counterpart on the second one", run.stderr)
        text = deck({"Force": 1.0}, held()).replace("upper/cut", "upper/top")
        run = self.solved(text, 2, status=2)
        self.assertIn("do not face each other", run.stderr)


if __name__ == "__main__":
    runs.main()
