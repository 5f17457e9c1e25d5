# SPDX-License-Identifier: BSD-3-Clause
"""Models of CalculiX and Abaqus, converted by harmos-inp and solved.

What each class guards against:

    Answers   sets, surfaces, loads, local axes, equations, steps that mean something else after the conversion
    Meanings  loads that are lost or counted twice, names and options that are mistaken
    Faults    keywords that are dropped without a word; faults that are told one by one, without their line
    Wedges    nodes and faces of wedges in another order, for the solver or for VTK; stresses of cells
    Damage    damaged input that ends in anything but a sentence and exit status 2
"""

import random
import re
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "apps" / "tools" / "inp"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np

    import inp_deck
    import inp_file
    import inp_model
    import inp_write
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

TOOL = runs.BINARY / "bin/harmos-inp"
YOUNG = 200.0

# Two bricks of one cell of 20 nodes each, one on the other: 1 × 1 × 1, from z = 0 and z = 1.
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
PLACES = [np.array(c, float) for c in CORNERS]
PLACES += [0.5 * (PLACES[a] + PLACES[b]) for a, b in EDGES]


def brick(first, lift):
    """Lines of nodes and of the element, numbered from first."""
    nodes = [f"{first + k}, {x[0]}, {x[1]}, {x[2] + lift}" for k, x in enumerate(PLACES)]
    numbers = [str(first + k) for k in range(20)]
    return nodes, [f"{first}, " + ", ".join(numbers[:12]) + ",", ", ".join(numbers[12:])]


def bricks(element="C3D20"):
    lower, upper = brick(1, 0.0), brick(101, 1.0)
    return [
        "*NODE, NSET=NALL",
        *lower[0],
        *upper[0],
        f"*ELEMENT, TYPE={element}, ELSET=LOWER",
        *lower[1],
        f"*Element, type={element}, elset=upper",
        *upper[1],
        "*MATERIAL, NAME=STEEL",
        "*ELASTIC",
        f"{YOUNG}, 0.",
        "*DENSITY",
        "3.0",
        "*ELSET, ELSET=BOTH",
        "LOWER, UPPER",
        "*SOLID SECTION, ELSET=BOTH, MATERIAL=STEEL",
        "*NSET, NSET=FLOOR",
        "1, 2, 3, 4, 9, 10, 11, 12",
        "*NSET, NSET=SIDES",
        *[f"{n}," for k, x in enumerate(PLACES) if x[0] == 0 for n in (1 + k, 101 + k)],
        "*NSET, NSET=FRONTS",
        *[f"{n}," for k, x in enumerate(PLACES) if x[1] == 0 for n in (1 + k, 101 + k)],
        "*BOUNDARY",
        "FLOOR, 3, 3",
        "SIDES, 1",
        "FRONTS, 2, 2, 0.",
    ]


CONTACT = [
    "*SURFACE, NAME=S1",
    "LOWER, S2",
    "*SURFACE, NAME=S2, TYPE=ELEMENT",
    "101, S1",
    "*SURFACE INTERACTION, NAME=I1",
    "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
    "50.",
    "*CONTACT PAIR, INTERACTION=I1, TYPE=SURFACE TO SURFACE",
    "S2, S1",
]


def step(*lines, head="*STEP"):
    return [head, "*STATIC", *lines, "*END STEP"]


def write(lines, name="model"):
    directory = runs.scratch(name)
    directory.mkdir(parents=True, exist_ok=True)
    path = directory / f"{name}.inp"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def convert(path):
    return subprocess.run([TOOL, path], capture_output=True, text=True, timeout=60, check=False)


def field(directory):
    """Points, displacements and bodies of a result."""
    with h5py.File(sorted(directory.glob("result*.vtkhdf"))[-1], "r") as file:
        root = file["VTKHDF"]
        first = np.cumsum(root["NumberOfCells"][()]) - root["NumberOfCells"][()]
        body = np.repeat(root["CellData/body"][()].ravel()[first], root["NumberOfPoints"][()])
        return root["Points"][()], root["PointData/displacement"][()], body


class Answers(unittest.TestCase):
    def solve(self, lines, name="model", np_=2):
        path = write(lines, name)
        converted = convert(path)
        self.assertEqual(converted.returncode, 0, converted.stderr)
        out = path.parent / "out"
        run = runs.run(path.with_suffix(".xml"), {"Solver/Tolerance": 1e-10}, np=np_, output=out, program="harmos")
        self.assertEqual(run.returncode, 0, f"{run}")
        return converted, run, *field(out)

    def expect(self, points, u, exact):
        size = max(abs(exact(x, b)[c]) for x, b in zip(*points) for c in range(3))
        for x, b, value in zip(*points, u):
            np.testing.assert_allclose(value, exact(x, b), atol=1e-7 * size)

    def test_pressed_bricks_in_soft_contact(self):
        lines = bricks() + CONTACT + step("*DLOAD", "UPPER, P2, 2.0")
        converted, _, points, u, body = self.solve(lines)
        self.assertIn("model.xml", converted.stdout)
        # Shortened by p/E each; the upper one sinks in by p/k.
        self.expect((points, body), u, lambda x, b: (0, 0, -2.0 * x[2] / YOUNG - (b == 1) * 2.0 / 50.0))

    def test_forces_at_nodes_are_those_of_a_pressure(self):
        # A constant pressure has −1/12 of its force at corners, 1/3 at the middles of edges.
        corners = [f"{105 + k}, 3, {2.0 / 12}" for k in range(4)]
        edges = [f"{113 + k}, 3, {-2.0 / 3}" for k in range(4)]
        lines = bricks() + CONTACT + step("*CLOAD", *corners, *edges)
        _, _, points, u, body = self.solve(lines)
        self.expect((points, body), u, lambda x, b: (0, 0, -2.0 * x[2] / YOUNG - (b == 1) * 2.0 / 50.0))

    def test_thicknesses_and_types_side_by_side(self):
        # A quadrilateral of the thickness 1/2, two triangles of 2: 4 N go through both.
        nodes = ((0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (2, 1))
        lines = ["*NODE", *[f"{k}, {x}, {y}" for k, (x, y) in enumerate(nodes, 1)], "*ELEMENT, TYPE=CPS4, ELSET=THIN",
                 "1, 1, 2, 3, 4", "*ELEMENT, TYPE=CPS3, ELSET=THICK", "2, 2, 5, 6", "3, 2, 6, 3",
                 "*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, 0.", "*SOLID SECTION, ELSET=THIN, MATERIAL=STEEL", "0.5",
                 "*SOLID SECTION, ELSET=THICK, MATERIAL=STEEL", "2.0", "*BOUNDARY", "1, 1, 2", "4, 1"]
        for load in (["*DLOAD", "2, P2, -2."], ["*CLOAD", "5, 1, 2.", "6, 1, 2."]):
            _, run, points, u, body = self.solve(lines + step(*load))
            self.expect((points, body), u, lambda x, b: ((8.0 * min(x[0], 1) + 2.0 * max(x[0] - 1, 0)) / YOUNG, 0, 0))
            held = sum(entry["force"][0] for entry in run.summary["forces"].values())
            self.assertAlmostEqual(held, -4.0, delta=1e-8)
            self.assertAlmostEqual(run.summary["energy"], -0.5 * 4.0 * 10.0 / YOUNG, delta=1e-8)

    def test_ties_weight_and_tied_contact(self):
        # ρ g over two heights: u = ρ g/E (z²/2 − 2 z), exact at corners.
        for tie in (
            ["*TIE, NAME=T", "S2, S1"],
            ["*CONTACT PAIR, INTERACTION=I2", "S2, S1", "*SURFACE INTERACTION, NAME=I2",
             "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED"],
        ):
            lines = bricks() + CONTACT[:4] + tie + step("*DLOAD", "BOTH, GRAV, 10., 0., 0., -2.")
            _, _, points, u, _ = self.solve(lines)
            for x, value in zip(points, u):
                z = x[2]
                if z == int(z):
                    np.testing.assert_allclose(value[2], 30.0 / YOUNG * (z * z / 2 - 2 * z), atol=1e-8)

    def test_local_axes_and_equations(self):
        # Tied by equations node by node; the top is pulled in an axis of its own, which is −z.
        pairs = [(5 + k, 101 + k) for k in range(4)] + [(13 + k, 109 + k) for k in range(4)]
        rows = []
        for low, high in pairs:
            for dof in (1, 2, 3):
                rows += ["2", f"{low}, {dof}, 1., {high}, {dof}, -1."]
        top = [105, 106, 107, 108, 113, 114, 115, 116]
        lines = bricks() + ["*NSET, NSET=TOP", ", ".join(map(str, top)), "*TRANSFORM, NSET=TOP, TYPE=R",
                            "0., 0., -1., 0., 1., 0.", "*EQUATION", *rows]
        # Of the axes 1 is −z; 2 is y, which the front holds.
        held = [line for line in lines if line != "SIDES, 1"]
        held = [re.sub("^FRONTS.*", "FREE, 2, 2, 0.", line) for line in held]
        where = held.index("*BOUNDARY")
        free = [str(n) for k, x in enumerate(PLACES) if x[1] == 0 for n in (1 + k, 101 + k) if n not in top]
        side = [str(n) for k, x in enumerate(PLACES) if x[0] == 0 for n in (1 + k, 101 + k) if n not in top]
        held[where:where] = ["*NSET, NSET=FREE", *[n + "," for n in free], "*NSET, NSET=SIDE", *[n + "," for n in side]]
        held += ["*BOUNDARY", "SIDE, 1, 1"]
        _, _, points, u, body = self.solve(held + step("*BOUNDARY", "TOP, 1, 1, 0.04"))
        self.expect((points, body), u, lambda x, b: (0, 0, -0.02 * x[2]))

    def test_steps_and_amplitudes(self):
        lines = bricks() + CONTACT[:4] + ["*TIE, NAME=T", "S2, S1", "*AMPLITUDE, NAME=A", "0., 0., 1., 0.5"]
        lines += step("*DLOAD", "UPPER, P2, 2.0") + step("*DLOAD, AMPLITUDE=A", "UPPER, P2, 6.0")
        _, run, points, u, body = self.solve(lines)
        self.expect((points, body), u, lambda x, b: (0, 0, -3.0 * x[2] / YOUNG))
        self.assertEqual(len((Path(run.directory) / "steps.csv").read_text().splitlines()), 3)

    def test_rotation(self):
        # ω² = 4 about z, without sideways contraction: u_x = ρω²/E (x/2 − x³/6), exact at corners.
        lines = bricks() + CONTACT[:4] + ["*TIE, NAME=T", "S2, S1"]
        lines += step("*DLOAD", "BOTH, CENTRIF, 4., 0., 0., 9., 0., 0., 2.")
        _, _, points, u, _ = self.solve(lines)
        for x, value in zip(points, u):
            for c in (0, 1):
                if x[c] == int(x[c]):
                    exact = 12.0 / YOUNG * (x[c] / 2 - x[c] ** 3 / 6)
                    np.testing.assert_allclose(value[c], exact, atol=1e-8)

    def test_temperatures_that_vary(self):
        # Linear along z: no stress in a free body, u_z = α g z²/2, the top bends by −α g (x² + y²)/2.
        warm = [f"{n}, {10.0 * (x[2] + lift)}" for lift, first in ((0, 1), (1, 101))
                for n, x in enumerate(PLACES, first)]
        lines = [*bricks(), "*EXPANSION", "1e-3", *CONTACT[:4], "*TIE, NAME=T", "S2, S1"]
        # Of the floor a node alone is held along z, the others bend.
        lines[lines.index("FLOOR, 3, 3")] = "1, 3, 3"
        lines.insert(lines.index("*BOUNDARY"), "*INITIAL CONDITIONS, TYPE=TEMPERATURE")
        lines.insert(lines.index("*BOUNDARY"), "NALL, 0.")
        _, _, points, u, body = self.solve(lines + step("*TEMPERATURE", *warm))
        scale = 1e-2
        self.expect((points, body), u, lambda x, b: (
            scale * x[2] * x[0], scale * x[2] * x[1], scale * (x[2] ** 2 - x[0] ** 2 - x[1] ** 2) / 2))

    def test_metal_that_yields(self):
        # Pressed by 1.5 it has flowed by half of what the curve's last point says, sideways by half of that.
        for hardening in ("ISOTROPIC", "KINEMATIC"):
            lines = [*bricks(), f"*PLASTIC, HARDENING={hardening}", "1.0, 0.0", "2.0, 0.01", *CONTACT[:4], "*TIE, NAME=T", "S2, S1"]
            _, _, points, u, body = self.solve(lines + step("*DLOAD", "UPPER, P2, 1.5"))
            self.expect((points, body), u, lambda x, b: (0.0025 * x[0], 0.0025 * x[1], -(1.5 / YOUNG + 0.005) * x[2]))

    def test_clearance(self):
        # The surfaces touch; a gap of 0.01 closes before anything bears.
        lines = [*bricks(), *CONTACT[:5], *CONTACT[7:], "*CLEARANCE, MASTER=S1, SLAVE=S2, VALUE=0.01"]
        lines = [re.sub("^S2, S1", "S2, S1", line) for line in lines]
        _, _, points, u, body = self.solve(lines + step("*DLOAD", "UPPER, P2, 2.0"))
        self.expect((points, body), u, lambda x, b: (0, 0, -2.0 * x[2] / YOUNG - (b == 1) * 0.01))

    def test_all_sets_on_request(self):
        path = write(bricks() + CONTACT + step("*DLOAD", "UPPER, P2, 2.0"), "sets")
        for words, extra in (((), set()), (("--sets",), {"NALL", "FLOOR", "SIDES", "FRONTS"})):
            done = subprocess.run([TOOL, path, *words], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            text = path.with_suffix(".msh").read_text(encoding="utf-8")
            names = dict(re.findall(r'^\d+ (\d+) "(.*)"$', text, re.MULTILINE))
            names = {name.removesuffix("_2"): tag for tag, name in names.items()}
            self.assertEqual(set(names) & {"NALL", "FLOOR", "SIDES", "FRONTS"}, extra)
            self.assertLessEqual({"S1", "S2"}, set(names))  # which the contact uses
            if extra:
                points = re.findall(rf"^\d+ 15 2 {names['FLOOR']} \d+ (\d+)$", text, re.MULTILINE)
                self.assertEqual(sorted(map(int, points)), [1, 2, 3, 4, 9, 10, 11, 12])

    def test_included_files_and_generated_sets(self):
        directory = write(bricks(), "part").parent
        main = directory / "whole.inp"
        lines = ["** a comment", "*INCLUDE, INPUT=part.inp", *CONTACT, "*NSET, NSET=T, GENERATE", "105, 108, 1"]
        main.write_text("\n".join(lines + step("*CLOAD", "T, 3, -0.5")) + "\n", encoding="utf-8")
        self.assertEqual(convert(main).returncode, 0)
        deck = main.with_suffix(".xml").read_text(encoding="utf-8")
        self.assertIn('value="{0.0, 0.0, -0.5}"', deck)


# A cube of two wedges: corners, and the middles of the edges of the lower triangle, the upper one, and between them.
WEDGES = {
    "C3D6": ((1, 2, 3, 5, 6, 7), (1, 3, 4, 5, 7, 8)),
    "C3D15": (
        (1, 2, 3, 5, 6, 7, 9, 10, 21, 13, 14, 22, 17, 18, 19),
        (1, 3, 4, 5, 7, 8, 21, 11, 12, 22, 15, 16, 17, 19, 20),
    ),
}


class Wedges(unittest.TestCase):
    PRESSURE = 2.0

    def solved(self, element):
        extra = ["21, 0.5, 0.5, 0.", "22, 0.5, 0.5, 1."]
        cells = [f"{k}, " + ", ".join(map(str, nodes)) for k, nodes in enumerate(WEDGES[element], 1)]
        lines = bricks()
        first = lines.index("101, 0.0, 0.0, 1.0")
        lines = lines[:first] + extra + [f"*ELEMENT, TYPE={element}, ELSET=BOTH", *cells]
        lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG}, 0.25", "*SOLID SECTION, ELSET=BOTH, MATERIAL=M"]
        lines += ["*BOUNDARY", *[f"{n}, 3" for n in (1, 2, 3, 4, 9, 10, 11, 12, 21)], "1, 1, 2", "2, 2"]
        path = write(lines + step("*DLOAD", f"BOTH, P2, {self.PRESSURE}"), element.lower())
        self.assertEqual(convert(path).returncode, 0)
        out = path.parent / "out"
        run = runs.run(path.with_suffix(".xml"), {"Solver/Tolerance": 1e-10, "Output/Expert/Cell fields": "stress"},
                       output=out, program="harmos")
        self.assertEqual(run.returncode, 0, f"{run}")
        return out / "result.vtkhdf"

    def test_a_pressed_cube_has_one_stress(self):
        strain = self.PRESSURE / YOUNG
        for element in WEDGES:
            with self.subTest(element=element), h5py.File(self.solved(element), "r") as file:
                root = file["VTKHDF"]
                exact = root["Points"][()] * strain * np.array([0.25, 0.25, -1.0])
                np.testing.assert_allclose(root["PointData/displacement"][()], exact, atol=1e-8 * strain)
                stress = root["CellData/cell_stress"][()]
                expected = np.tile([0.0, 0.0, -self.PRESSURE, 0.0, 0.0, 0.0], (2, 1))
                np.testing.assert_allclose(stress, expected, atol=1e-8 * self.PRESSURE)

    def test_nodes_are_where_vtk_expects_them(self):
        try:
            from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
            from vtkmodules.vtkIOHDF import vtkHDFReader
        except ImportError as error:
            raise unittest.SkipTest(f"the Python module {error.name} is missing") from error
        for element in WEDGES:
            reader = vtkHDFReader()
            reader.SetFileName(str(self.solved(element)))
            reader.Update()
            grid = pieces(reader.GetOutputDataObject(0))
            volume = 0.0
            for part in grid:
                sizes = vtkCellSizeFilter()
                sizes.SetInputData(part)
                sizes.Update()
                for k in range(part.GetNumberOfCells()):
                    cell = part.GetCell(k)
                    places = np.reshape(cell.GetParametricCoords(), (-1, 3))
                    points = np.array([cell.GetPoints().GetPoint(i) for i in range(cell.GetNumberOfPoints())])
                    edges = np.array([points[1] - points[0], points[2] - points[0], points[3] - points[0]])
                    np.testing.assert_allclose(points, points[0] + places @ edges, atol=1e-14)
                    volume += sizes.GetOutput().GetCellData().GetArray("Volume").GetValue(k)
            self.assertAlmostEqual(volume, 1.0, delta=1e-12)


def pieces(data):
    """The grids of a result, one a subdomain."""
    if data.IsA("vtkUnstructuredGrid"):
        return [data]
    return [data.GetPartition(k) for k in range(data.GetNumberOfPartitions())]


class Meanings(unittest.TestCase):
    """What keywords mean, as CalculiX has it; of the conversion alone."""

    def convert(self, lines):
        conversion = inp_deck.Conversion(inp_model.read_model(inp_file.read(write(lines, "meant"))), "meant")
        self.histories = {name: points for points, name in conversion.history.names.items()}
        return conversion

    def loads(self, *steps, more=()):
        """(force along z, its history) of all Force effects."""
        effects = self.convert([*bricks(), *more, *sum(steps, [])]).effects["Force"].values()
        return sorted((e["Force"][2], self.histories.get(e.get("History"), ())) for e in effects)

    def test_loads_of_a_step_add_up(self):
        once = [(3.0, ())]
        self.assertEqual(self.loads(step("*CLOAD", "105, 3, 1.", "105, 3, 2.")), once)
        self.assertEqual(self.loads(step("*CLOAD", "105, 3, 1.", "*CLOAD", "105, 3, 2.")), once)
        twice = ["*NSET, NSET=T", "105, 106, 105"]
        self.assertEqual(self.loads(step("*CLOAD", "T, 3, 1."), more=twice), [(1.0, ()), (2.0, ())])

    def test_loads_of_a_step_replace_those_before(self):
        value = self.loads(step("*CLOAD", "105, 3, 1."), step("*CLOAD", "105, 3, 4."))
        self.assertEqual(value, [(4.0, ((0.0, 0.0), (1.0, 0.25), (2.0, 1.0)))])
        value = self.loads(step("*CLOAD", "105, 3, 4."), step("*CLOAD, OP=NEW", "106, 3, 0."))
        self.assertEqual(value, [(4.0, ((0.0, 0.0), (1.0, 1.0), (2.0, 0.0)))])
        lines = [*bricks(), *step("*DLOAD", "BOTH, P2, 1."), *step("*DLOAD", "UPPER, P2, 3.")]
        pressures = self.convert(lines).effects["Traction"].values()
        self.assertEqual(sorted(e["Pressure"] for e in pressures), [1.0, 3.0])

    def test_amplitudes_in_total_time_go_on(self):
        more = ["*AMPLITUDE, NAME=A, TIME=TOTAL TIME", "0., 0., 2., 4."]
        value = self.loads(step("*CLOAD, AMPLITUDE=A", "105, 3, 0.5"), step(), more=more)
        self.assertEqual(value, [(2.0, ((0.0, 0.0), (1.0, 0.5), (2.0, 1.0)))])

    def test_numbers_come_before_names(self):
        conversion = self.convert([*bricks(), "*NSET, NSET=5", "105", *step("*CLOAD", "5, 3, 1.")])
        self.assertEqual(list(conversion.parts.mesh.points["loaded"]), [5])

    def test_names_that_look_alike_stay_apart(self):
        lines = bricks()
        where = next(k for k, line in enumerate(lines) if line.startswith("*ELSET"))
        end = next(k for k, line in enumerate(lines) if line.startswith("*NSET, NSET=FLOOR"))
        lines[where:end] = [
            "*MATERIAL, NAME=A%B", "*ELASTIC", "1., 0.", "*MATERIAL, NAME=A_B", "*ELASTIC", "2., 0.",
            "*SOLID SECTION, ELSET=LOWER, MATERIAL=A%B", "*SOLIDSECTION, ELSET=UP PER, MATERIAL=A_B",
        ]
        conversion = self.convert(lines + step("*CLOAD", "105, 3, 1."))
        self.assertEqual(sorted(m["Young's modulus"] for m in conversion.materials.lists.values()), [1.0, 2.0])

    def test_what_would_change_the_model_is_a_fault(self):
        for lines, wanted in (
            (step("*CLOAD, TIME DELAY=1.", "105, 3, 1."), "the option TIME DELAY"),
            (step("*CLOAD", "105, 3, 1.") + step("*BOUNDARY", "107, 1"), "begins in a later step"),
            (["*AMPLITUDE, NAME=A, SHIFTY=1.", "0., 0., 1., 1."] + step(), "the option SHIFTY"),
            (step("*BOUNDARY", "105, 0, 1"), "there is no dof 0"),
        ):
            with self.assertRaises(inp_file.InpError) as caught:
                self.convert(bricks() + lines)
            self.assertIn(wanted, str(caught.exception))


class Faults(unittest.TestCase):
    def faults(self, lines):
        path = write(lines)
        done = convert(path)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertFalse(path.with_suffix(".xml").exists())
        return done.stderr

    def line_of(self, lines, text):
        return f"line {lines.index(text) + 1}"

    def test_every_keyword_that_is_not_taken_is_told(self):
        lines = bricks() + ["*CREEP", "200., 0.", "*RIGID BODY, NSET=TOP, REF NODE=3"] + step("*VIEWFACTOR", "1")
        text = self.faults(lines)
        for keyword in ("CREEP", "RIGID BODY", "VIEWFACTOR"):
            line = next(line for line in lines if line.startswith("*" + keyword))
            self.assertRegex(text, rf"{self.line_of(lines, line)}: \*{keyword} is not supported")

    def test_faults_name_what_is_wrong(self):
        base, load = bricks(), step("*CLOAD", "NALL, 3, 1.")
        for lines, wanted in (
            (base + step("*CLOAD", "NOWHERE, 3, 1."), "there is no node set"),
            (base + step("*DLOAD", "UPPER, P7, 1."), "has no face P7"),
            (base + step("*DLOAD", "UPPER, P2NP, 1."), "P2NP is not supported"),
            (base + step("*CLOAD", "105, 4, 1."), "moment"),
            (base + step("*BOUNDARY, FIXED", "NALL, 1"), "FIXED is not supported"),
            (base + ["*EQUATION", "2", "1, 1, 1."] + load, "ends early"),
            (base + ["*EQUATION", "2", "1, 1, 1., 999, 1, 1."] + load, "there is no node \"999\""),
            (base + ["*TIE, NAME=T", "A, B"] + load, "there is no surface"),
            ([*base[:-3], "FLOOR, x"] + load, "is not a number"),
            (base, "no *STEP"),
            ([line.replace("C3D20", "S8R") for line in base] + load, "S8R is not supported"),
            ([line for line in base if "SOLID" not in line] + load, "has no *SOLID SECTION"),
            (base + ["*STEP", "*FREQUENCY", "1", "*END STEP"], "*FREQUENCY is not supported"),
        ):
            self.assertIn(wanted, self.faults(lines))

    def test_what_is_taken_otherwise_is_told(self):
        lines = bricks() + CONTACT[:-2] + ["*CONTACT PAIR, INTERACTION=I1, ADJUST=NEAR", "S2, S1"]
        turns = lines + step("*DLOAD", "UPPER, CENTRIF, 4., 0., 0., 9., 0., 0., 2.", head="*STEP, NLGEOM")
        done = convert(write(turns))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("ADJUST of a node set", done.stdout)
        self.assertNotIn("NLGEOM", done.stdout)

    def test_nlgeom_is_taken_where_all_effects_go_with_it(self):
        for head, kinematics in (("*STEP, NLGEOM", 1), ("*STEP, NLGEOM=NO", 0), ("*STEP", 0)):
            path = write(bricks() + step("*CLOAD", "105, 3, -1.", head=head))
            done = convert(path)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("NLGEOM", done.stdout)
            deck = next(path.parent.rglob("*.xml")).read_text(encoding="utf-8")
            self.assertEqual(deck.count('name="Kinematics" type="string" value="finite"'), kinematics, deck)

    def test_help_and_a_file_that_is_not_there(self):
        done = subprocess.run([TOOL, "--help"], capture_output=True, text=True, check=False)
        self.assertIn("MODEL.inp", done.stdout)
        done = convert(runs.scratch("nothing") / "none.inp")
        self.assertEqual(done.returncode, 2)
        self.assertIn("cannot be read", done.stderr)


class Damage(unittest.TestCase):
    COUNT = 300

    def test_damaged_models_end_in_a_sentence(self):
        source = random.Random(7)
        pairs = ["*EQUATION", "2", "5, 1, 1., 101, 1, -1.", "*TRANSFORM, NSET=FLOOR, TYPE=C", "-1,-1,0,-1,-1,5"]
        whole = bricks() + CONTACT + pairs + step("*CLOAD", "105, 3, -1.", "*DLOAD", "UPPER, P2, 2.0")
        refused = 0
        for _ in range(self.COUNT):
            lines = list(whole)
            for _ in range(source.randint(1, 3)):
                damage(lines, source)
            path = write(lines, "damaged")
            try:
                conversion = inp_deck.Conversion(inp_model.read_model(inp_file.read(path)), "damaged")
                inp_write.write_mesh(conversion, path.with_suffix(".msh"))
                inp_write.write_deck(conversion, path.with_suffix(".xml"), "damaged.msh")
            except inp_file.InpError as error:
                refused += 1
                self.assertTrue(error.faults and all(error.faults), lines)
        self.assertGreater(refused, self.COUNT // 4)


def damage(lines, source):
    k = source.randrange(len(lines))
    kind = source.randrange(6)
    if kind == 0:
        del lines[k]
    elif kind == 1:
        lines[k] = lines[k][: source.randrange(len(lines[k]) + 1)]
    elif kind == 2:
        lines.insert(k, lines[source.randrange(len(lines))])
    elif kind == 3:
        place = source.randrange(len(lines[k]) + 1)
        lines[k] = lines[k][:place] + source.choice(",*=.-7xE\0é ") + lines[k][place:]
    elif kind == 4:
        lines[k] = re.sub(r"\d+", lambda m: str(source.choice((0, -1, 10**12, m.group()))), lines[k], count=2)
    else:
        other = source.randrange(len(lines))
        lines[k], lines[other] = lines[other], lines[k]


if __name__ == "__main__":
    runs.main()
