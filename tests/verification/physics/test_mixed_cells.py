# SPDX-License-Identifier: BSD-3-Clause
"""Bodies with cells of several types, against fields that every one of them represents.

In the plane quadrilaterals beside triangles; in space hexahedra beside wedges, and tetrahedra on the wedges, extruded
along y. Uniaxial tension on distorted meshes has a linear field, the own weight of a body without sideways contraction a
quadratic one:

    u_y = p y/E, u_x = -ν p x/E, u_z = -ν p z/E;    u_y = f (y - y²/2)/E

What it guards against: nodes that cells of two types share but that are not coupled, sides between them that count as
boundary, loads and supports that end where the type changes, on any number of parts and ranks, read whole or cut.
"""

import itertools
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

TOLERANCE = 1e-11  # of the solver
YY, ZZ = 1, 2  # of stresses xx, yy, zz, xy, yz, xz
YOUNG, POISSON, PRESSURE = 200.0, 0.3, 1.5

# Corners' places, edges and faces as Gmsh's manual numbers them; its numbers of the types by the number of nodes.
TRIANGLE = {"edges": ((0, 1), (1, 2), (2, 0)), "faces": (), "inside": (), "types": {3: 2, 6: 9}}
QUADRILATERAL = {"edges": ((0, 1), (1, 2), (2, 3), (3, 0)), "faces": (), "inside": (range(4),),
                 "types": {4: 3, 8: 16, 9: 10}}
TETRAHEDRON = {"edges": ((0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3)), "faces": (), "inside": (),
               "sides": ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)), "types": {4: 4, 10: 11}}
WEDGE = {"edges": ((0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)),
         "faces": ((0, 1, 4, 3), (0, 2, 5, 3), (1, 2, 5, 4)), "inside": (),
         "sides": ((0, 1, 4, 3), (0, 2, 5, 3), (1, 2, 5, 4), (0, 1, 2), (3, 4, 5)), "types": {6: 6, 15: 18, 18: 13}}
HEXAHEDRON = {"edges": ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)),
              "faces": ((0, 3, 2, 1), (0, 1, 5, 4), (0, 4, 7, 3), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7)),
              "inside": (range(8),), "types": {8: 5, 20: 17, 27: 12}}
HEXAHEDRON["sides"] = HEXAHEDRON["faces"]
TRIANGLE["sides"], QUADRILATERAL["sides"] = TRIANGLE["edges"], QUADRILATERAL["edges"]
LINE = {"edges": ((0, 1),), "faces": (), "inside": (), "types": {2: 1, 3: 8}}
SHAPES = {(2, 2): LINE, (2, 3): TRIANGLE, (2, 4): QUADRILATERAL, (3, 4): TETRAHEDRON, (3, 6): WEDGE, (3, 8): HEXAHEDRON}
SIDES = {2: LINE, 3: TRIANGLE, 4: QUADRILATERAL}


class Mesh:
    """Cells by their corners, which become nodes of the order "1", "2" (all middles) or "S" (those of edges)."""

    def __init__(self, dimension, order):
        self.dimension, self.order = dimension, order
        self.numbers, self.places = {}, []
        self.cells = {}  # body -> list of (shape, corners)
        self.middles = {}

    def node(self, *x):
        if x not in self.numbers:
            self.numbers[x] = len(self.places)
            self.places.append([float(c) for c in x])
        return self.numbers[x]

    def add(self, body, *corners):
        self.cells.setdefault(body, []).append((SHAPES[self.dimension, len(corners)], list(corners)))

    def distort(self, amount, low, high):
        """Moves corners that are inside, by a pattern without symmetry."""
        for k, x in enumerate(self.places):
            inner = [low[d] < x[d] < high(x)[d] for d in range(self.dimension)]
            for d in range(self.dimension):
                if inner[d]:
                    x[d] += amount * np.sin(7.0 * k + 2.0 * d)

    def whole(self, shape, corners):
        """All nodes of a cell or side."""
        if self.order == "1":
            return corners
        groups = list(shape["edges"])
        if self.order == "2":
            groups += [*shape["faces"], *shape["inside"]]
        nodes = list(corners)
        for group in groups:
            key = tuple(sorted(corners[k] for k in group))
            if key not in self.middles:
                self.middles[key] = len(self.places)
                self.places.append(np.mean([self.places[k] for k in key], axis=0).tolist())
            nodes.append(self.middles[key])
        return nodes

    def write(self, path, parts):
        """Format 2.2. @param parts name -> whether a side with these corners' places is on it."""
        groups, lines, marks = [], [], {}

        def element(shape, corners, mark):
            nodes = self.whole(shape, corners)
            kind = shape["types"][len(nodes)]
            lines.append(f"{len(lines) + 1} {kind} 2 {mark} {mark} " + " ".join(str(n + 1) for n in nodes))

        def mark_of(dimension, name):
            if (dimension, name) not in marks:
                marks[dimension, name] = len(marks) + 1
                groups.append(f'{dimension} {len(marks)} "{name}"')
            return marks[dimension, name]

        corners_at = [list(x) for x in self.places]
        for body, cells in self.cells.items():
            mark = mark_of(self.dimension, body)
            for shape, corners in cells:
                element(shape, corners, mark)
            for name, is_on in parts.items():
                sides = {}
                for shape, corners in cells:
                    for side in shape["sides"]:
                        members = [corners[k] for k in side]
                        if all(is_on(*corners_at[n]) for n in members):
                            sides.setdefault(tuple(sorted(members)), members)
                mark = mark_of(self.dimension - 1, name) if sides else 0
                for members in sides.values():
                    element(SIDES[len(members)], members, mark)
        nodes = [f"{k + 1} " + " ".join(map(repr, [*x, 0.0][:3])) for k, x in enumerate(self.places)]
        text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups)), *groups,
                "$EndPhysicalNames", "$Nodes", str(len(nodes)), *nodes, "$EndNodes", "$Elements", str(len(lines)), *lines,
                "$EndElements", ""]
        path.write_text("\n".join(text), encoding="utf-8")


def plane(order, n=3, bottom=0.0, body="body", mesh=None, flip=False):
    """[0, 2] × [bottom, bottom + 1]: quadrilaterals on one side of x = 1, pairs of triangles on the other."""
    mesh = mesh or Mesh(2, order)
    for i, j in itertools.product(range(2 * n), range(n)):
        # A node on a line between bodies is one of each.
        a, b, c, d = (mesh.node((i + x) / n, bottom + (j + y) / n) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
        if (i < n) != flip:
            mesh.add(body, a, b, c, d)
        elif (i + j) % 2:
            mesh.add(body, a, b, c)
            mesh.add(body, a, c, d)
        else:
            mesh.add(body, a, b, d)
            mesh.add(body, b, c, d)
    return mesh


def prism(order, n=2, kinds=("hexahedra", "wedges", "tetrahedra")):
    """[0, 1]³ of hexahedra, beside it [1, 2] × [0, 1]² of wedges, and tetrahedra on these up to z = 2."""
    mesh = Mesh(3, order)
    ring = ((0, 0), (1, 0), (1, 1), (0, 1))
    for i, j, k in itertools.product(range(2 * n), range(n), range(2 * n)):
        node = lambda x, y, z: mesh.node((i + x) / n, (j + y) / n, (k + z) / n)  # noqa: E731,B023
        corners = [node(x, y, z) for z in (0, 1) for x, y in ring]
        if i < n:
            if k < n and "hexahedra" in kinds:
                mesh.add("body", *corners)
            continue
        for split in ((0, 1, 2), (0, 2, 3)):
            low, high = [corners[m] for m in split], [corners[4 + m] for m in split]
            if k < n and "wedges" in kinds:
                mesh.add("body", *low, *high)
            elif (k >= n or "wedges" not in kinds) and "tetrahedra" in kinds:
                (a, b, c), (d, e, f) = zip(*sorted(zip(low, high)))
                for tetrahedron in ((a, b, c, f), (a, b, e, f), (a, d, e, f)):
                    mesh.add("body", *tetrahedron)
    return mesh


PARTS = {
    "left": lambda x, *_: x == 0.0, "floor": lambda x, y, *_: y == 0.0, "roof": lambda x, y, *_: y == 1.0,
    "back": lambda x, y, z=1.0: z == 0.0,
}


def support(name, part, axis):
    return f"""<ParameterList name="{name}"><Parameter name="Part" type="string" value="{part}"/>
      <Parameter name="Components" type="Array(string)" value="{{{'xyz'[axis]}}}"/></ParameterList>
"""


def body(name, subdomains):
    return f"""<ParameterList name="{name}">
      <Parameter name="Materials" type="Array(string)" value="{{steel}}"/>
      <Parameter name="Subdomains" type="string" value="{subdomains}"/></ParameterList>
"""


def deck(mesh_file, physics, load, bodies, supports, more="", poisson=POISSON):
    return f"""<ParameterList>
  <ParameterList name="Model"><Parameter name="Physics" type="string" value="{physics}"/>
    <Parameter name="Mesh file" type="string" value="{mesh_file}"/></ParameterList>
  <ParameterList name="Materials"><ParameterList name="steel">
    <Parameter name="Young's modulus" type="double" value="{YOUNG}"/>
    <Parameter name="Poisson's ratio" type="double" value="{poisson}"/>
  </ParameterList></ParameterList>
  <ParameterList name="Bodies">{bodies}</ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Prescribed displacement">{supports}</ParameterList>
    {load}
    {more}
  </ParameterList>
</ParameterList>
"""


TENSION = f"""<ParameterList name="Traction"><ParameterList name="pull">
      <Parameter name="Part" type="string" value="body/roof"/>
      <Parameter name="Pressure" type="double" value="{-PRESSURE}"/></ParameterList></ParameterList>"""
WEIGHT = f"""<ParameterList name="Body force"><ParameterList name="weight">
      <Parameter name="Body" type="string" value="body"/>
      <Parameter name="Density" type="Array(double)" value="{{0, {PRESSURE}, 0}}"/></ParameterList></ParameterList>"""


class Case(unittest.TestCase):
    def solved(self, text, np_, **more):
        directory = self.directory
        (directory / "deck.xml").write_text(text, encoding="utf-8")
        sets = {"Solver/Tolerance": TOLERANCE} | more
        run = runs.run(directory / "deck.xml", sets, np=np_, output=directory / "out", program="harmos")
        self.assertEqual(run.returncode, 0, f"{run}")
        with h5py.File(directory / "out/result.vtkhdf", "r") as file:
            return run, file["VTKHDF/Points"][()], file["VTKHDF/PointData/displacement"][()]

    def setUp(self):
        self.directory = runs.scratch("mixed")
        self.directory.mkdir(parents=True, exist_ok=True)

    def expect_stress(self, component, value, contact=None):
        """One component everywhere; the pressure of contact at all nodes of the first body at a height, and nowhere else."""
        with h5py.File(self.directory / "out/result.vtkhdf", "r") as file:
            root = file["VTKHDF"]
            stress, x = root["PointData/stress"][()], root["Points"][()]
            pressure = root["PointData/contact_pressure"][()].ravel() if contact else None
            first = np.cumsum(root["NumberOfCells"][()]) - root["NumberOfCells"][()]
            body = np.repeat(root["CellData/body"][()].ravel()[first], root["NumberOfPoints"][()])
        expected = np.zeros_like(stress)
        expected[:, component] = value
        np.testing.assert_allclose(stress, expected, rtol=0.0, atol=1e-6 * PRESSURE)
        if contact:
            axis, height = contact
            on = (body == 0) & (np.abs(x[:, axis] - height) < 1e-9)
            np.testing.assert_allclose(pressure, np.where(on, PRESSURE, 0.0), rtol=0.0, atol=1e-6 * PRESSURE)

    def expect(self, x, u, exact):
        """c ε κ of these meshes is far below; the solver's tolerance is of the residual."""
        np.testing.assert_allclose(u, exact(x), rtol=0.0, atol=1e-8 * np.abs(exact(x)).max())


def tension(poisson):
    return lambda x: PRESSURE / YOUNG * x * (-poisson, 1.0, -poisson)


def weight(x):
    zero = 0.0 * x[:, 1]
    return np.column_stack([zero, PRESSURE / YOUNG * (x[:, 1] - x[:, 1] ** 2 / 2), zero])


class Plane(Case):
    supports = support("left", "body/left", 0) + support("floor", "body/floor", 1)

    def test_tension(self):
        for order, np_, subdomains in (("1", 1, 5), ("S", 2, 2), ("2", 4, 7)):
            with self.subTest(order=order):
                mesh = plane(order)
                mesh.distort(0.06, (0.0, 0.0), lambda x: (2.0, 1.0))
                mesh.write(self.directory / "mesh.msh", PARTS)
                text = deck("mesh.msh", "plane stress", TENSION, body("body", subdomains), self.supports)
                run, x, u = self.solved(text, np_)
                self.assertEqual(run.summary["subdomains"], subdomains)
                self.expect(x, u, lambda x: tension(POISSON)(x) * (1.0, 1.0, 0.0))
                self.expect_stress(YY, PRESSURE)

    def test_weight(self):
        for order in ("S", "2"):
            with self.subTest(order=order):
                plane(order).write(self.directory / "mesh.msh", PARTS)
                text = deck("mesh.msh", "plane strain", WEIGHT, body("body", 4), self.supports, poisson=0.0)
                self.expect(*self.solved(text, 2)[1:], weight)

    def test_contact(self):
        # Triangles lie on quadrilaterals, and the other way round; nodes do not match.
        for order in ("1", "S", "2"):
            with self.subTest(order=order):
                mesh = plane(order, 3, 0.0, "lower")
                mesh.numbers = {}  # no node is shared
                plane(order, 4, 1.0, "upper", mesh, flip=True)
                parts = {"left": lambda x, y: x == 0.0, "floor": lambda x, y: y == 0.0, "joint": lambda x, y: y == 1.0,
                         "roof": lambda x, y: y == 2.0}
                mesh.write(self.directory / "mesh.msh", parts)
                contact = """<ParameterList name="Contact"><ParameterList name="joint">
                    <Parameter name="First" type="string" value="lower/joint"/>
                    <Parameter name="Second" type="string" value="upper/joint"/></ParameterList></ParameterList>"""
                supports = (support("left", "lower/left", 0) + support("above", "upper/left", 0)
                            + support("floor", "lower/floor", 1))
                load = TENSION.replace("body/roof", "upper/roof").replace(str(-PRESSURE), str(PRESSURE))
                text = deck("mesh.msh", "plane stress", load, body("lower", 3) + body("upper", 4), supports, contact)
                run, x, u = self.solved(text, 2)
                self.assertAlmostEqual(abs(run.summary["forces"]["Contact/joint"]["force"][1]), 2 * PRESSURE, delta=1e-8)
                self.expect(x, u, lambda x: -tension(POISSON)(x) * (1.0, 1.0, 0.0))
                self.expect_stress(YY, -PRESSURE, (1, 1.0))


class Space(Case):
    supports = support("left", "body/left", 0) + support("floor", "body/floor", 1) + support("back", "body/back", 2)

    def mesh(self, order, amount=0.0):
        mesh = prism(order)
        mesh.distort(amount, (0.0, 0.0, 0.0), lambda x: (2.0 if x[2] < 1 else 3.0, 1.0, 2.0))
        mesh.write(self.directory / "mesh.msh", PARTS)

    def test_tension(self):
        for order, np_, subdomains in (("1", 2, 3), ("S", 4, 9), ("2", 1, 6)):
            with self.subTest(order=order):
                self.mesh(order)
                text = deck("mesh.msh", "solid", TENSION, body("body", subdomains), self.supports)
                self.expect(*self.solved(text, np_)[1:], tension(POISSON))
                self.expect_stress(YY, PRESSURE)

    def test_weight(self):
        self.mesh("2")
        text = deck("mesh.msh", "solid", WEIGHT, body("body", 5), self.supports, poisson=0.0)
        self.expect(*self.solved(text, 2)[1:], weight)

    def test_of_a_file_that_is_cut(self):
        self.mesh("S")
        done = runs.start(["mesh.msh", "--subdomains", "8", "--output", "mesh.h5"], 0, program="harmos-mesh",
                          cwd=self.directory)
        self.assertEqual(done.returncode, 0, done)
        for text in ('Body "body": 253 nodes, cells of 3 types', "  8 cells (hexahedron of 20 nodes)", "  16 cells (wedge of 15",
                     "  48 cells (tetrahedron of 10 nodes)", 'part "roof": 16 sides, area 3, flat', "cut into 8 parts"):
            self.assertIn(text, done.stdout)
        text = deck("mesh.h5", "solid", TENSION, body("body", "auto"), self.supports)
        run, x, u = self.solved(text, 2)
        self.assertEqual(run.summary["subdomains"], 8)
        self.expect(x, u, tension(POISSON))

    def test_a_part_for_each_type_at_least(self):
        self.mesh("1")
        text = deck("mesh.msh", "solid", TENSION, body("body", 1), self.supports)
        run, x, u = self.solved(text, 1)
        self.assertEqual(run.summary["subdomains"], 3)
        self.expect(x, u, tension(POISSON))


    def test_contact_of_quadrilaterals_and_triangles(self):
        # A block on hexahedra and wedges: a contact for each shape of sides.
        prism("1", kinds=("hexahedra", "wedges")).write(self.directory / "mesh.msh", PARTS)
        block = """<ParameterList name="block"><Parameter name="Source" type="string" value="block"/>
          <Parameter name="Origin" type="Array(double)" value="{0, 0, 1}"/>
          <Parameter name="Size" type="Array(double)" value="{2, 1, 1}"/>
          <Parameter name="Elements a side" type="Array(int)" value="{3, 3, 2}"/>
          <Parameter name="Materials" type="Array(string)" value="{steel}"/></ParameterList>"""
        contact = """<ParameterList name="Automatic contact"><ParameterList name="all"/></ParameterList>"""
        supports = (self.supports + support("sides", "block/left", 0) + support("fronts", "block/front", 1))
        load = TENSION.replace("body/roof", "block/top").replace(str(-PRESSURE), str(PRESSURE))
        text = deck("mesh.msh", "solid", load, body("body", 4) + block, supports, contact)
        run, x, u = self.solved(text, 2)
        forces = {path: entry["force"][2] for path, entry in run.summary["forces"].items() if path.startswith("Contact")}
        self.assertEqual(sorted(forces), ["Contact/body-block", "Contact/body-block-2"])
        for force in forces.values():
            self.assertAlmostEqual(abs(force), PRESSURE, delta=1e-7)
        self.expect(x, u, lambda x: PRESSURE / YOUNG * x * (POISSON, POISSON, -1.0))
        self.expect_stress(ZZ, -PRESSURE, (2, 1.0))


class Refused(Case):
    def refused(self, mesh, *words):
        mesh.write(self.directory / "mesh.msh", PARTS)
        done = runs.start(["mesh.msh"], 0, program="harmos-mesh", cwd=self.directory)
        self.assertEqual(done.returncode, 2, done)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_hexahedra_beside_tetrahedra(self):
        self.refused(prism("1", kinds=("hexahedra", "tetrahedra")), 'body "body", cells of different types meet at (1, 0, 0)',
                     "with a quadrilateral on one side and triangles on the other")

    def test_sides_of_different_order(self):
        mesh = plane("2", 1)
        whole = mesh.whole
        mesh.whole = lambda shape, corners: corners if shape is QUADRILATERAL else whole(shape, corners)
        self.refused(mesh, "with sides of different order")

    def test_hanging_nodes(self):
        mesh = Mesh(2, "1")
        low, high = mesh.node(1.0, 0.0), mesh.node(1.0, 1.0)
        mesh.add("body", mesh.node(0.0, 0.0), low, high, mesh.node(0.0, 1.0))
        middle, end = mesh.node(1.0, 0.5), mesh.node(2.0, 0.5)
        mesh.add("body", low, end, middle)
        mesh.add("body", middle, end, high)
        self.refused(mesh, "cells of different types meet at (1, 0, 0)", "a node of one is within a side of the other")

    def test_a_side_cut_in_four(self):
        # A hexahedron whose side is cut at its middle: no triangle has three of its corners.
        mesh = Mesh(3, "1")
        ring = ((0, 0), (1, 0), (1, 1), (0, 1))
        corners = [mesh.node(x, y, z) for z in (0, 1) for x, y in ring]
        mesh.add("body", *corners)
        middle, tip = mesh.node(0.5, 0.5, 1.0), mesh.node(0.5, 0.5, 2.0)
        for k in range(4):
            mesh.add("body", corners[4 + k], corners[4 + (k + 1) % 4], middle, tip)
        self.refused(mesh, "a node of one is within a side of the other")

    def test_more_parts_than_cells(self):
        plane("1", 1).write(self.directory / "mesh.msh", PARTS)
        text = deck("mesh.msh", "plane stress", TENSION, body("body", 9), Plane.supports)
        (self.directory / "deck.xml").write_text(text, encoding="utf-8")
        run = runs.run(self.directory / "deck.xml", np=runs.RANKS, output=self.directory / "out", program="harmos")
        self.assertEqual(run.returncode, 2, f"{run}")
        self.assertIn('body "body" cannot be partitioned into 9 parts: it has 3 cells', run.stderr)

    def test_cells_that_overlap(self):
        mesh = plane("1", 1)
        mesh.add("body", mesh.node(1.0, 0.0), mesh.node(1.0, 1.0), mesh.node(0.5, 0.5))
        self.refused(mesh, "on the same side of their common face", "Repair it")


if __name__ == "__main__":
    runs.main()
