# SPDX-License-Identifier: BSD-3-Clause
"""Bolts under pretension and cyclic sectors: inputs of CalculiX, converted by harmos-inp and solved, against theory.

    test_bolts_and_sectors.py [-v] [CLASS]...

What each class guards against:

    Bolted    a pretension of another sign, size or place than in CalculiX; a bolt that a further load relieves or
              stretches where it should not, before and after the joint opens: against springs
    Sector    equations in cylindrical axes that turn displacements the wrong way: a sector with cyclic symmetry
              against the whole ring, field by field, and both against the virial of the pressure
"""

import itertools
import math
import subprocess
import sys
import unittest
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

TOOL = runs.BINARY / "bin/harmos-inp"
TOLERANCE = 1e-10  # of the solver

# Nodes of a hexahedron as CalculiX numbers them. The first four of each are those of a quadrilateral.
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))


@dataclass
class Grid:
    """Cells between lines of coordinates, as lines of an input."""

    element: str
    lines: list  # of each coordinate
    first: int = 1  # number of the first node, and of the first cell
    keeps: object = lambda *middle: True
    period: int = 0  # cells after which the second coordinate is back where it began; 0: never
    nodes: dict = field(default_factory=dict)  # number -> coordinates
    cells: dict = field(default_factory=dict)  # number -> nodes

    def __post_init__(self):
        numbers = {}
        # Places count half cells: the middles of edges are odd.
        at = [np.interp(np.arange(2 * len(line) - 1) / 2, range(len(line)), line).tolist() for line in self.lines]
        for cell in itertools.product(*(range(len(line) - 1) for line in self.lines)):
            if not self.keeps(*(at[d][2 * c + 1] for d, c in enumerate(cell))):
                continue
            members = []
            for place in self.places(cell):
                where = tuple(at[d][k] for d, k in enumerate(place))
                if self.period:
                    place = (place[0], place[1] % (2 * self.period), *place[2:])
                members.append(numbers.setdefault(place, self.first + len(numbers)))
                self.nodes.setdefault(members[-1], where)
            self.cells[self.first + len(self.cells)] = members

    def places(self, cell):
        count = 4 * (len(cell) - 1)
        corners = [tuple(2 * (c + x) for c, x in zip(cell, corner)) for corner in CORNERS[:count]]
        if self.element in ("CPE4", "C3D8"):
            return corners
        edges = EDGES[: 8 * len(cell) - 12]
        return corners + [tuple((x + y) // 2 for x, y in zip(corners[a], corners[b])) for a, b in edges]

    def at(self, axis, value):
        """Nodes with this coordinate."""
        return [n for n, x in self.nodes.items() if x[axis] == value]

    def beside(self, axis, value, side):
        """Cells with a face at this coordinate, that lie below (-1) or above it (1)."""
        on = set(self.at(axis, value))
        found = []
        for number, members in self.cells.items():
            away = sum(self.nodes[n][axis] - value for n in members)
            if len(on & set(members)) > 2 and away * side > 0.0:
                found.append(number)
        return found

    def text(self, name, place=lambda *x: x):
        lines = ["*NODE", *[f"{n}, " + ", ".join(map(repr, place(*x))) for n, x in self.nodes.items()]]
        lines.append(f"*ELEMENT, TYPE={self.element}, ELSET={name}")
        for number, members in self.cells.items():
            words = [str(k) for k in (number, *members)]
            rows = [", ".join(words[k : k + 10]) for k in range(0, len(words), 10)]
            lines += [row + "," for row in rows[:-1]] + rows[-1:]
        return lines


def node_set(name, nodes):
    return [f"*NSET, NSET={name}", *[f"{n}," for n in nodes]]


def surface(name, cells, label):
    return [f"*SURFACE, NAME={name}", *[f"{cell}, S{label}" for cell in cells]]


class Fields:
    """Cells of a result: nodes, their displacements, mean stresses."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            root = file["VTKHDF"]
            x, u = root["Points"][()], root["PointData/displacement"][()]
            ids, offsets = root["Connectivity"][()], root["Offsets"][()]
            sizes = [root[f"NumberOf{name}"][()].tolist() for name in ("Points", "Cells", "ConnectivityIds")]
            # Of xx, yy, zz, xy, yz, xz.
            self.stress = root["CellData/cell_stress"][()][:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
        members, point, place, start = [], 0, 0, 0
        # A part for each subdomain: its numbers begin at zero, its offsets are one more than its cells.
        for points, cells, used in zip(*sizes):
            bounds = start + offsets[place : place + cells + 1]
            members += [point + ids[a:b] for a, b in zip(bounds, bounds[1:])]
            point, place, start = point + points, place + cells + 1, start + used
        self.x, self.u = x[np.array(members)], u[np.array(members)]  # (cell, node, component)
        self.middle = self.x.mean(axis=1)


class Case(unittest.TestCase):
    def converted(self, lines, name):
        path = runs.scratch(name) / f"{name}.inp"
        path.parent.mkdir(parents=True)
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        done = subprocess.run([TOOL, path], capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return path.with_suffix(".xml")

    def solved(self, deck, np_, **subdomains):
        """subdomains: of bodies, by their names."""
        sets = {"Solver/Tolerance": TOLERANCE, "Output/Expert/Cell fields": "stress"}
        sets |= {f"Bodies/{body}/Subdomains": count for body, count in subdomains.items()}
        return runs.solved(self, deck, sets, np_, program="harmos")

    def assert_near(self, values, expected, delta, what):
        error = float(np.max(np.abs(np.asarray(values) - np.asarray(expected))))
        print(f"{what}: {error:.1e}, at most {delta:.1e}")
        self.assertLessEqual(error, delta, what)


# A bolt of section 2 × 2, and two frames around it, one on the other, of section 6 × 6 but for a hole of 4 × 4. All
# along z from 0 on; the bolt is cut beside another height than that at which the frames meet.
LENGTH, MEETING, CUT = 5.0, 2.0, 3.0
SIDE = (-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0)
OTHER = (-3.0, -2.6, -2.0, -0.8, 0.0, 1.0, 2.0, 3.0)
BOLT_AREA, PLATE_AREA = 4.0, 20.0
BOLT, LOWER, UPPER = 200.0, 70.0, 100.0  # Young's moduli
TENSION = 9999  # the node of the pretension


def in_bolt(x, y, *_):
    return max(abs(x), abs(y)) < 1.0


def in_plates(x, y, *_):
    return max(abs(x), abs(y)) > 2.0


@dataclass
class Joint:
    """Springs: a bolt and, beside it, plates; the ends of both move together.

    Nothing contracts sideways (ν = 0), hence displacements are linear along z in each part, which every element has.
    With a shift δ, by which the cut shortens the bolt, and the force P that pulls the ends apart by u:

        F_b = k_b (u + δ),    F_p = −k_p u >= 0,    F_b − F_p = P.
    """

    shift: float = None  # None: the force of the bolt is prescribed instead
    bolt: float = None
    load: float = 0.0
    stiffness: float = math.inf  # of soft contact, a force per volume

    def __post_init__(self):
        self.soft = 1.0 / (self.stiffness * PLATE_AREA)
        self.lower, self.upper = MEETING / (LOWER * PLATE_AREA), (LENGTH - MEETING) / (UPPER * PLATE_AREA)
        k_b, k_p = BOLT * BOLT_AREA / LENGTH, 1.0 / (self.lower + self.soft + self.upper)
        self.gap = 0.0
        if self.shift is None:
            self.clamp = self.bolt - self.load
            self.shift = self.bolt / k_b + self.clamp / k_p
            return
        first = self.shift * k_b * k_p / (k_b + k_p)
        self.opening = first * (k_b + k_p) / k_p  # the load that opens the joint
        if self.load <= self.opening:
            self.bolt = first + self.load * k_b / (k_b + k_p)
            self.clamp = first - self.load * k_p / (k_b + k_p)
        else:
            self.bolt, self.clamp = self.load, 0.0
            self.gap = self.load / k_b - self.shift

    def displacement(self, middle, z):
        """Along z, at heights in a cell."""
        if in_bolt(*middle):
            return self.bolt / (BOLT * BOLT_AREA) * z - (self.shift if middle[2] > CUT else 0.0)
        if middle[2] < MEETING:
            return -self.clamp / (LOWER * PLATE_AREA) * z
        foot = self.gap - self.clamp * (self.lower + self.soft)
        return foot - self.clamp / (UPPER * PLATE_AREA) * (z - MEETING)

    def stress(self, middle):
        return self.bolt / BOLT_AREA if in_bolt(*middle) else -self.clamp / PLATE_AREA


def bolted_model(*steps, element="C3D8", side=SIDE, behaviour=("HARD",), below=True, direction=()):
    """steps: lines of each, with TOP for the node that moves with the upper ends.

    below: the surface of the section is that of the cells below the cut; direction: lines that give its normal.
    """
    bolt = Grid(element, [SIDE, SIDE, (0.0, 1.2, CUT, 4.0, LENGTH)], 1, in_bolt)
    lower = Grid(element, [SIDE, SIDE, (0.0, 1.0, MEETING)], 1001, in_plates)
    upper = Grid(element, [side, side, (MEETING, 3.0, LENGTH)], 3001, in_plates)
    lines = []
    for grid, name, young in ((bolt, "BOLT", BOLT), (lower, "LOWER", LOWER), (upper, "UPPER", UPPER)):
        lines += [*grid.text(name), f"*MATERIAL, NAME={name}", "*ELASTIC", f"{young}, 0."]
        lines += [f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"]
        for axis in (0, 1):
            # Nothing contracts sideways: nodes in the planes of symmetry stay there.
            lines += node_set(f"{name}_{axis}", grid.at(axis, 0.0))
            lines += ["*BOUNDARY", f"{name}_{axis}, {axis + 1}"]
    lines += node_set("FLOOR", bolt.at(2, 0.0) + lower.at(2, 0.0)) + ["*BOUNDARY", "FLOOR, 3"]
    lines += surface("CUT", bolt.beside(2, CUT, -1 if below else 1), 2 if below else 1)
    lines += ["*NODE", f"{TENSION}, 0., 0., 0."]
    lines += [f"*PRE-TENSION SECTION, SURFACE=CUT, NODE={TENSION}", *direction]
    lines += surface("FOOT", upper.beside(2, MEETING, 1), 1) + surface("SEAT", lower.beside(2, MEETING, -1), 2)
    lines += ["*SURFACE INTERACTION, NAME=I", f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={behaviour[0]}", *behaviour[1:]]
    lines += ["*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE", "FOOT, SEAT"]
    # The upper ends of bolt and plates move together.
    top, *others = upper.at(2, LENGTH) + bolt.at(2, LENGTH)
    lines.append("*EQUATION")
    for node in others:
        lines += ["2", f"{node}, 3, 1., {top}, 3, -1."]
    for step in steps:
        lines += ["*STEP", "*STATIC", *[line.replace("TOP", str(top)) for line in step], "*END STEP"]
    return lines


class Bolted(Case):
    """Tolerances.

    The error of the forces of each contact and constraint is at most a hundred tolerances (docs/scenes.md), and bars
    of one stress each have as small an error of their elongations. Errors of displacements δ at both ends of a side h
    become 2 E δ/h of stress; the shortest sides are 1 in the bolt, 0.4 in the upper plate.
    """

    FORCE, SHIFT, LOAD = 8.0, 0.05, 3.0
    ACCURACY = 100 * TOLERANCE
    STIFFEST = max(BOLT / 1.0, UPPER / 0.4)

    def check(self, joint, result, clamp):
        """clamp: the force of the lower plate on the upper one."""
        fields = Fields(result)
        z, high = fields.x[:, :, 2], fields.middle[:, 2, None]
        rod = np.array([[in_bolt(*middle)] for middle in fields.middle])
        near = self.ACCURACY * float(np.max(np.abs(fields.u)))

        def between(is_cell, height):
            """Mean displacement along z below a height less that above it, of nodes of cells at this height."""
            on = is_cell & (z == height)
            return fields.u[on & (high < height), 2].mean() - fields.u[on & (high > height), 2].mean()

        force = BOLT_AREA * fields.stress[rod[:, 0], 2, 2].mean()
        self.assert_near(force, joint.bolt, self.ACCURACY * joint.bolt, "force of the bolt")
        self.assert_near(clamp, joint.clamp, self.ACCURACY * joint.bolt, "clamp force")
        self.assert_near(between(rod, CUT), joint.shift, 2.0 * near, "shift")
        self.assert_near(-between(~rod, MEETING), joint.gap - joint.clamp * joint.soft, 2.0 * near, "gap")
        expected, stress = np.zeros_like(fields.u), np.zeros_like(fields.stress)
        for k, middle in enumerate(fields.middle):
            expected[k, :, 2] = joint.displacement(middle, z[k])
            stress[k, 2, 2] = joint.stress(middle)
        self.assert_near(fields.u, expected, near, "displacements")
        self.assert_near(fields.stress, stress, 2.0 * self.STIFFEST * near, "stresses")

    def check_one_state(self, joint, deck, ranks=(1, 2)):
        for np_ in ranks:
            with self.subTest(ranks=np_):
                run = self.tightened(deck, np_)
                clamp = run.summary["forces"]["Contact/contact"]["force"][2]
                self.check(joint, run.directory / "result.vtkhdf", clamp)

    def tightened(self, deck, np_):
        """In several subdomains, across which the bolt and the ends are held together."""
        return self.solved(deck, np_, UPPER=3, body_1=2)

    def shifted(self, shift, load, **more):
        step = ["*BOUNDARY", f"{TENSION}, 1, 1, {shift!r}", "*CLOAD", f"TOP, 3, {load!r}"]
        return self.converted(bolted_model(step, **more), "shifted")

    def test_a_force_stays_and_clamps_less_under_load(self):
        """In two steps, as bolts are tightened first. The plates alone feel the load: F_b = F_0, F_p = F_0 − P."""
        steps = ["*CLOAD", f"{TENSION}, 1, {self.FORCE}"], ["*CLOAD", f"TOP, 3, {self.LOAD}"]
        deck = self.converted(bolted_model(*steps, element="C3D20", side=OTHER), "pulled")
        for np_ in (1, 2):
            with self.subTest(ranks=np_):
                run = self.tightened(deck, np_)
                for number, load in enumerate((0.0, self.LOAD)):
                    clamp = run.summary["steps"][number]["Contact/contact/fz"]
                    joint = Joint(bolt=self.FORCE, load=load)
                    self.check(joint, run.directory / f"result_000{number + 1}.vtkhdf", clamp)

    def test_a_shift_shares_loads_by_stiffness(self):
        joint = Joint(shift=self.SHIFT, load=self.LOAD)
        self.assertGreater(joint.clamp, 0.0)
        self.check_one_state(joint, self.shifted(self.SHIFT, joint.load))

    def test_a_shift_is_made_before_the_load(self):
        steps = ["*BOUNDARY", f"{TENSION}, 1, 1, {self.SHIFT!r}"], ["*CLOAD", f"TOP, 3, {self.LOAD}"]
        deck = self.converted(bolted_model(*steps, side=OTHER), "shifted")
        for np_ in (1, 2):
            with self.subTest(ranks=np_):
                run = self.tightened(deck, np_)
                for number, load in enumerate((0.0, self.LOAD)):
                    row = run.summary["steps"][number]
                    joint = Joint(shift=self.SHIFT, load=load)
                    self.check(joint, run.directory / f"result_000{number + 1}.vtkhdf", row["Contact/contact/fz"])
                    # All is elastic: what comes from outside is stored, F_b s/2 by tightening, and P w/2.
                    self.assert_near(row["external_work"], row["energy"], self.ACCURACY * row["energy"], "energy")

    def test_a_joint_opens(self):
        opening = Joint(shift=self.SHIFT).opening
        for part, ranks in ((0.99, (2,)), (1.01, (1, 2))):
            joint = Joint(shift=self.SHIFT, load=part * opening)
            self.assertEqual(joint.gap > 0.0, part > 1.0)
            self.check_one_state(joint, self.shifted(self.SHIFT, joint.load, side=OTHER), ranks)

    def test_soft_contact_is_a_spring_in_series(self):
        joint = Joint(shift=self.SHIFT, load=-self.LOAD, stiffness=50.0)
        deck = self.shifted(self.SHIFT, joint.load, behaviour=("LINEAR", "50."), side=OTHER)
        self.check_one_state(joint, deck, (2,))

    def test_a_force_and_its_shift_are_one_state(self):
        """A bolt that is locked as its force has shifted it keeps the force.

        From either side of the cut. With a direction against the outward normal of its faces forces and shifts have
        the opposite sign, as in CalculiX.
        """
        tight = Joint(bolt=self.FORCE)
        deck = self.shifted(tight.shift, 0.0, below=False)
        self.check_one_state(tight, deck, (1,))
        deck = self.shifted(-tight.shift, 0.0, direction=("0., 0., -2.",))
        self.check_one_state(tight, deck, (2,))
        step = ["*CLOAD", f"{TENSION}, 1, {-self.FORCE}"]
        deck = self.converted(bolted_model(step, below=False, direction=("0., 0., 1.",)), "pulled")
        self.check_one_state(tight, deck, (1,))


# A ring in six equal sectors; the pressure acts on the first two of four cells of each.
SECTORS = 6
SECTOR = 2.0 * math.pi / SECTORS
BEGIN = 0.2  # of the first sector, so that no side lies on an axis
ANGLES = (0.0, 0.15, 0.4, 0.75, SECTOR)
PRESSED = 2
RADII = (1.0, 1.3, 1.7, 2.2)
HEIGHT = 0.5
SMALLEST = 0.15  # side of a cell
PRESSURE = 1.5
YOUNG, POISSON = 200.0, 0.3


@dataclass
class Ring:
    """The whole ring, or a sector of it with cyclic symmetry.

    Symmetry: in the axes r, t, a of each node the displacements of one side are those of the other one. What remains
    is a rotation about the axis; a node at the outside holds it, in the whole ring three of them at equal distances,
    which hold the two translations too. Plane rings are about z, solid ones about y and rest on y = 0.
    """

    element: str
    is_whole: bool

    def __post_init__(self):
        self.is_solid = self.element.startswith("C3D")
        self.plane = (2, 0) if self.is_solid else (0, 1)  # components in which angles count
        count = SECTORS if self.is_whole else 1
        angles = [BEGIN + SECTOR * k + a for k in range(count) for a in ANGLES[:-1]] + [BEGIN + SECTOR * count]
        lines = [RADII, angles] + ([(0.0, HEIGHT)] if self.is_solid else [])
        self.grid = Grid(self.element, lines, period=len(angles) - 1 if self.is_whole else 0)
        outer = set(self.grid.at(0, RADII[-1])) & set(self.base())
        self.held = []
        for k in range(0, count, 2):
            self.held += sorted(outer & set(self.grid.at(1, BEGIN + SECTOR * k + ANGLES[2])))

    def base(self):
        return self.grid.at(2, 0.0) if self.is_solid else list(self.grid.nodes)

    def place(self, radius, angle, *height):
        x = [0.0, 0.0, 0.0]
        x[self.plane[0]], x[self.plane[1]] = radius * math.cos(angle), radius * math.sin(angle)
        x[1 if self.is_solid else 2] += sum(height)
        return x

    def sides(self):
        """Pairs of nodes at the end and the begin of a sector."""
        nodes = self.grid.nodes
        begin, end = (
            sorted(self.grid.at(1, BEGIN + angle), key=lambda n: (nodes[n][0], nodes[n][2:])) for angle in (0.0, SECTOR)
        )
        return list(zip(end, begin))

    def lines(self):
        grid, pairs = self.grid, [] if self.is_whole else self.sides()
        turned = [n for pair in pairs for n in pair] + self.held
        lines = [*grid.text("RING", self.place), "*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG}, {POISSON}"]
        lines += ["*SOLID SECTION, ELSET=RING, MATERIAL=M", *node_set("TURNED", turned)]
        lines += ["*TRANSFORM, NSET=TURNED, TYPE=C", "0., 0., 0., " + ("0., 3., 0." if self.is_solid else "0., 0., 3.")]
        lines += ["*EQUATION"] if pairs else []
        base = set(self.base())
        for end, begin in pairs:
            # Nodes of the base have no motion along the axis to be made equal.
            for dof in (1, 2, 3) if self.is_solid and end not in base else (1, 2):
                lines += ["2", f"{end}, {dof}, 1., {begin}, {dof}, -1."]
        lines += node_set("HELD", self.held) + ["*BOUNDARY", "HELD, 2"]
        if self.is_solid:
            # The axis is the third axis of nodes that are turned, and y of the others.
            lines += node_set("RESTS", base - set(turned)) + node_set("TURNS", base & set(turned))
            lines += ["*BOUNDARY", "RESTS, 2", "TURNS, 3"]
        lines += ["*STEP", "*STATIC", "*DLOAD"]
        parts = len(ANGLES) - 1
        inner = list(grid.cells)[: parts * (SECTORS if self.is_whole else 1)]
        face = "P6" if self.is_solid else "P4"
        lines += [f"{cell}, {face}, {PRESSURE}" for k, cell in enumerate(inner) if k % parts < PRESSED]
        return [*lines, "*END STEP"]

    def turn(self, number):
        """Takes the first sector to another one."""
        a, b = self.plane
        turn, angle = np.eye(3), SECTOR * number
        turn[a, a] = turn[b, b] = math.cos(angle)
        turn[b, a], turn[a, b] = math.sin(angle), -math.sin(angle)
        return turn

    def swept(self, fields):
        """½ ∫ x × dx along each of the four sides of each cell: (cell, side); a cell's sum is its area.

        For x = m + t d + t² c, t from −1 to 1, with the middle m of the side: m × d + d × c/3.
        """
        x = fields.x[:, :, self.plane]
        begin, end = x[:, :4], np.roll(x[:, :4], -1, axis=1)
        middle = 0.5 * (begin + end)
        if self.element in ("CPE8", "C3D20"):
            middle = x[:, 8:12] if self.is_solid else x[:, 4:]
        d, c = 0.5 * (end - begin), 0.5 * (begin + end) - middle

        def cross(v, w):
            return v[..., 0] * w[..., 1] - v[..., 1] * w[..., 0]

        return cross(middle, d) + cross(d, c) / 3.0

    def virials(self, fields):
        """∫ σ over the plane of the ring, 2 × 2, and ∮ t · x of the pressure."""
        height, swept = HEIGHT if self.is_solid else 1.0, self.swept(fields)
        stress = fields.stress[:, self.plane][:, :, self.plane]
        inside = height * np.einsum("cs,cab->ab", swept, stress)
        x, y = (fields.middle[:, c] for c in self.plane)
        angle = (np.arctan2(y, x) - BEGIN) % SECTOR
        first = fields.x[:, (0, 3)][:, :, self.plane]
        is_inner = np.all(np.abs(np.linalg.norm(first, axis=2) - RADII[0]) < 1e-12, axis=1)
        pressed = is_inner & (angle < ANGLES[PRESSED])
        # t ds = −p n ds, n ds = (dy, −dx): of the last side, from the fourth corner to the first.
        return inside, -2.0 * PRESSURE * height * swept[pressed, 3].sum()


def von_mises(stress):
    deviator = stress - np.trace(stress, axis1=-2, axis2=-1)[..., None, None] / 3.0 * np.eye(3)
    return np.sqrt(1.5 * np.sum(deviator**2, axis=(-2, -1)))


class Sector(Case):
    """Tolerances.

    Both models have the same discrete solution. Each is off by the tolerance of the solver times the root of the
    condition of the preconditioned dual operator, below ten for so few cells a subdomain. Errors of displacements δ
    at both ends of the shortest side h become 2 M δ/h of stresses, with M = E (1 − ν)/((1 + ν)(1 − 2 ν)).
    """

    ACCURACY = 10 * TOLERANCE

    def solve(self, ring, deck, np_, subdomains):
        run = self.solved(deck, np_, body=subdomains)
        fields = Fields(run.directory / "result.vtkhdf")
        self.check_virial(ring, fields)
        # What holds the rotation (and the translations) has nothing to hold.
        held = run.summary["forces"]["Linear constraint/local_axes"]["force"]
        self.assert_near([held[c] for c in ring.plane], 0.0, self.ACCURACY * PRESSURE, "forces of the hold")
        if not ring.is_whole:
            self.check_balance(ring, np.array(run.summary["forces"]["Linear constraint/equations"]["force"]))
        return fields

    def check_balance(self, ring, force):
        """Of a sector: the symmetry acts on its end, and turned back and reversed on its begin."""
        begin, end = (np.array(ring.place(RADII[0], BEGIN + angle)) for angle in (0.0, ANGLES[PRESSED]))
        chord, pressure = (end - begin)[list(ring.plane)], np.zeros(3)
        # ∫ n ds of any line is that of its chord; out of the hole, on which the pressure acts.
        pressure[list(ring.plane)] = PRESSURE * (HEIGHT if ring.is_solid else 1.0) * np.array([chord[1], -chord[0]])
        rest = (pressure + force - ring.turn(1).T @ force)[list(ring.plane)]
        self.assert_near(rest, 0.0, self.ACCURACY * PRESSURE, "forces of the symmetry and of the pressure")

    def check_virial(self, ring, fields):
        """With the virtual displacement v = x in the plane, which all conditions admit: ∫ tr σ = ∮ t · x.

        The elements have it, and forces between subdomains and sides do no work on it: it holds to rounding. In the
        whole ring, whose supports take nothing, for v = A x with any matrix A; the symmetry makes the tensor a multiple
        of the unit one.
        """
        inside, outside = ring.virials(fields)
        delta = 1e-12 * outside
        self.assert_near(np.trace(inside), outside, delta, "virial")
        if ring.is_whole:
            self.assert_near(inside, 0.5 * outside * np.eye(2), delta, "virials")

    def compare(self, ring, part, whole):
        found, near = set(), self.ACCURACY * float(np.max(np.abs(whole.u)))
        modulus = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
        errors = np.zeros(4)
        for number in range(SECTORS):
            turn = ring.turn(number)
            middle = part.middle @ turn.T
            same = np.argmin(np.linalg.norm(middle[:, None] - whole.middle[None], axis=2), axis=1)
            found |= set(same.tolist())
            turned = turn @ part.stress @ turn.T
            differences = (
                whole.x[same] - part.x @ turn.T,
                whole.u[same] - part.u @ turn.T,
                whole.stress[same] - turned,
                von_mises(whole.stress[same]) - von_mises(part.stress),
            )
            errors = np.maximum(errors, [np.max(np.abs(d)) for d in differences])
        self.assertEqual(len(found), SECTORS * len(part.middle))
        self.assertEqual(len(found), len(whole.middle))
        self.assert_near(errors[0], 0.0, 1e-12, "nodes")
        self.assert_near(errors[1], 0.0, near, "displacements")
        self.assert_near(errors[2], 0.0, 2.0 * modulus * near / SMALLEST, "stresses")
        self.assert_near(errors[3], 0.0, 2.0 * modulus * near / SMALLEST, "von Mises stresses")

    def check(self, element):
        whole, part = Ring(element, True), Ring(element, False)
        reference = self.solve(whole, self.converted(whole.lines(), "ring"), 2, 5)
        deck = self.converted(part.lines(), "sector")
        for np_, subdomains in ((1, 1), (2, 3)):
            with self.subTest(element=element, ranks=np_):
                self.compare(part, self.solve(part, deck, np_, subdomains), reference)

    def test_plane(self):
        for element in ("CPE4", "CPE8"):
            self.check(element)

    def test_solid(self):
        self.check("C3D20")


if __name__ == "__main__":
    runs.main()
