# SPDX-License-Identifier: BSD-3-Clause
"""Meshes as other programs write them: read as they are, or refused with place and remedy.

Two cubes, one on the other, of tetrahedra half of which are mirrored, in two regions, with the upper face of each.
What it guards against: cells or regions that get lost, "folded" for what is only numbered the other way round, files of
ParaView and meshio (VTK 5.1) that Gmsh does not read, advice that does not help.
"""

import importlib.util
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402

N = 2  # cells along an edge of a cube, each cut into six
SIX = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
CUBE = "27 nodes, 48 cells (tetrahedron of 4 nodes)"


def cube(height):
    """Points, tetrahedra, triangles of the upper face."""
    number = lambda i, j, k: i + (N + 1) * (j + (N + 1) * k)  # noqa: E731
    points = [(i / N, j / N, height + k / N) for k in range(N + 1) for j in range(N + 1) for i in range(N + 1)]
    tetrahedra, triangles = [], []
    for k in range(N):
        for j in range(N):
            for i in range(N):
                ring = ((0, 0), (1, 0), (1, 1), (0, 1))
                corners = [number(i + a, j + b, k + c) for c in (0, 1) for a, b in ring]
                tetrahedra += [[corners[c] for c in six] for six in SIX]
                if k == N - 1:
                    a, b, c, d = corners[4:]
                    triangles += [[a, b, c], [a, c, d]]
    for cell in tetrahedra[::2]:
        cell[0], cell[1] = cell[1], cell[0]
    return points, tetrahedra, triangles


def two_cubes():
    """Points, cells and triangles of both, and the region of each."""
    lower, upper = cube(0.0), cube(1.0)
    shifted = [[[node + len(lower[0]) for node in cell] for cell in cells] for cells in upper[1:]]
    points = lower[0] + upper[0]
    regions = [1] * len(lower[1]) + [2] * len(shifted[0]), [11] * len(lower[2]) + [12] * len(shifted[1])
    return points, lower[1] + shifted[0], lower[2] + shifted[1], regions


def report(path, status=0, *words):
    done = runs.start([path.name, *words], 0, program="harmos-mesh", cwd=path.parent)
    if done.returncode != status:
        raise AssertionError(f"{path.name}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def universal(path, groups=()):
    """An I-DEAS universal file: 2411 nodes, 2412 elements with their property's number, 2467 groups.

    @param groups (name, type of its entities, their numbers)
    """
    points, cells, triangles, (ofCells, ofTriangles) = two_cubes()
    kinds = [(111, cell, region) for cell, region in zip(cells, ofCells)]
    kinds += [(91, cell, region) for cell, region in zip(triangles, ofTriangles)]
    lines = ["    -1", "  2411"]
    for number, point in enumerate(points, 1):
        lines.append(f"{number:10d}{1:10d}{1:10d}{11:10d}")
        lines.append("".join(f"{x:25.16E}".replace("E", "D") for x in point))
    lines += ["    -1", "    -1", "  2412"]
    for number, (kind, cell, region) in enumerate(kinds, 1):
        lines.append(f"{number:10d}{kind:10d}{region:10d}{region:10d}{7:10d}{len(cell):10d}")
        lines.append("".join(f"{node + 1:10d}" for node in cell))
    if groups:
        lines += ["    -1", "    -1", "  2467"]
    for number, (name, kind, members) in enumerate(groups, 1):
        lines += ["".join(f"{n:10d}" for n in (number, 0, 0, 0, 0, 0, 0, len(members))), name]
        for k in range(0, len(members), 2):
            lines.append("".join(f"{kind:10d}{member:10d}{0:10d}{0:10d}" for member in members[k : k + 2]))
    path.write_text("\n".join([*lines, "    -1", ""]), encoding="utf-8")


class Case(unittest.TestCase):
    def setUp(self):
        self.directory = runs.scratch("foreign")
        self.directory.mkdir()

    def path(self, name):
        return self.directory / name

    def need(self, module, package):
        if importlib.util.find_spec(module) is None:
            self.skipTest(f"the Python module {module} is missing; install {package}")


class Meshio(Case):
    """What meshio writes."""

    def setUp(self):
        super().setUp()
        self.need("meshio", "python3-meshio")

    def write(self, name, key, **options):
        import meshio
        import numpy as np

        points, cells, triangles, regions = two_cubes()
        data = {key: [np.array(of, np.int32) for of in regions]} if key else None
        mesh = meshio.Mesh(points, [("tetra", cells), ("triangle", triangles)], cell_data=data)
        meshio.write(self.path(name), mesh, **options)
        return self.path(name)

    def test_vtk(self):
        for name, options in {
            "five.vtk": {"file_format": "vtk51"},
            "five_text.vtk": {"file_format": "vtk51", "binary": False},
            "four.vtk": {"file_format": "vtk42"},
            "four_text.vtk": {"file_format": "vtk42", "binary": False},
            "zlib.vtu": {},
            "plain.vtu": {"compression": None},
            "text.vtu": {"binary": False},
        }.items():
            with self.subTest(name):
                text = report(self.write(name, "region", **options))
                for region in (1, 2):
                    self.assertIn(f'Body "{region}": {CUBE}', text)
                    self.assertIn(f'part "{region + 10}": 8 sides, area 1, flat with normal (0, 0, 1)', text)

    def test_medit_and_nastran(self):
        for name, key in (("cubes.mesh", "medit:ref"), ("cubes.bdf", "nastran:ref")):
            with self.subTest(name):
                text = report(self.write(name, key))
                for region in (1, 2):
                    self.assertIn(f'Body "volume {region}": {CUBE}', text)
                    self.assertIn(f'part "surface {region + 10}": 8 sides, area 1', text)

    def test_region_zero_and_a_body_in_pieces(self):
        import meshio
        import numpy as np

        points, cells, _, _ = two_cubes()
        mesh = meshio.Mesh(points, [("tetra", cells)], cell_data={"medit:ref": [np.zeros(len(cells), int)]})
        meshio.write(self.path("zero.mesh"), mesh)
        text = report(self.path("zero.mesh"))
        self.assertIn('Body "volume 0": 54 nodes, 96 cells', text)
        self.assertIn("in 2 pieces without common nodes", text)

    def test_what_is_refused(self):
        text = report(self.write("lzma.vtu", "region", compression="lzma"), 2)
        self.assertIn("unsupported compressor vtkLZMADataCompressor; save it with zlib", text)
        whole = self.write("whole.vtu", "region", compression=None).read_bytes()
        cut = self.path("cut.vtu")
        cut.write_bytes(whole[: len(whole) // 3])
        self.assertRegex(report(cut, 2), "cannot be read: (it ends early|it is truncated|the array|it holds)")


class Vtk(Case):
    """What VTK itself writes, as ParaView does: appended data, a plane grid of squares in pixel order."""

    def test_appended(self):
        self.need("vtkmodules", "python3-vtk9")
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
        from vtkmodules.vtkIOLegacy import vtkUnstructuredGridWriter
        from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter
        import numpy as np

        points = vtkPoints()
        for y in range(3):
            for x in range(3):
                points.InsertNextPoint(x, y, 0.0)
        grid = vtkUnstructuredGrid()
        grid.SetPoints(points)
        pixel = 8
        for first in (0, 1, 3, 4):
            grid.InsertNextCell(pixel, 4, [first, first + 1, first + 3, first + 4])
        for name, values in (("MaterialIds", np.array([7, 7, 7, 9], np.int32)), ("share", np.ones(4))):
            array = numpy_to_vtk(values, deep=True)
            array.SetName(name)
            grid.GetCellData().AddArray(array)
        for base64 in (0, 1):
            for compressed in (0, 1):
                writer = vtkXMLUnstructuredGridWriter()
                writer.SetInputData(grid)
                writer.SetDataModeToAppended()
                writer.SetEncodeAppendedData(base64)
                if not compressed:
                    writer.SetCompressorTypeToNone()
                writer.SetFileName(str(self.path("squares.vtu")))
                writer.Write()
                self.check(report(self.path("squares.vtu")))
        for binary in (False, True):
            writer = vtkUnstructuredGridWriter()
            writer.SetInputData(grid)
            writer.SetFileName(str(self.path("squares.vtk")))
            writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
            writer.Write()
            self.check(report(self.path("squares.vtk")))

    def test_cells_of_second_order(self):
        """By the places that VTK itself gives their nodes: a body's weight is its volume, whatever the order."""
        self.need("vtkmodules", "python3-vtk9")
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import (
            vtkBiQuadraticQuad,
            vtkQuadraticTetra,
            vtkQuadraticTriangle,
            vtkTriQuadraticHexahedron,
            vtkUnstructuredGrid,
        )
        from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

        for kind, dimension, size in (
            (vtkQuadraticTriangle, 2, 0.5),
            (vtkBiQuadraticQuad, 2, 1.0),
            (vtkQuadraticTetra, 3, 1.0 / 6.0),
            (vtkTriQuadraticHexahedron, 3, 1.0),
        ):
            with self.subTest(kind.__name__):
                cell = kind()
                number = cell.GetNumberOfPoints()
                places = cell.GetParametricCoords()
                points = vtkPoints()
                points.SetDataTypeToDouble()
                for k in range(number):
                    points.InsertNextPoint(places[3 * k : 3 * k + 3])
                grid = vtkUnstructuredGrid()
                grid.SetPoints(points)
                grid.InsertNextCell(cell.GetCellType(), number, list(range(number)))
                writer = vtkXMLUnstructuredGridWriter()
                writer.SetInputData(grid)
                writer.SetFileName(str(self.path("cell.vtu")))
                writer.Write()
                physics, body = ("plane strain", "surface 1") if dimension == 2 else ("solid", "volume 1")
                deck = self.path("cell.xml")
                deck.write_text(WEIGHT.format(physics=physics, body=body, down="{0, -1, 0}"), encoding="utf-8")
                words = ["cell.xml", "--output", "run"]
                done = runs.start(words, 1, program="harmos", cwd=self.directory)
                self.assertEqual(done.returncode, 0, done)
                summary = json.loads(self.path("run/summary.json").read_text(encoding="utf-8"))
                holds = summary["forces"]["Prescribed displacement/held"]["force"][1]
                self.assertAlmostEqual(holds, size, delta=1e-12)

    def check(self, text):
        """Plane, though nobody has said so."""
        self.assertIn('Body "7": 8 nodes, 3 cells (quadrilateral of 4 nodes), quality 1 mean', text)
        self.assertIn('Body "9": 4 nodes, 1 cells (quadrilateral of 4 nodes)', text)


class Others(Case):
    def test_universal_file(self):
        path = self.path("cubes.unv")
        universal(path)
        text = report(path)
        for region in (1, 2):
            self.assertIn(f'Body "{region}": {CUBE}', text)
            self.assertIn(f'part "{region + 10}": 8 sides, area 1', text)

    def test_groups_of_a_universal_file(self):
        node, element = 7, 8
        path = self.path("groups.unv")
        cells = len(cube(0.0)[1])
        groups = [("lower half", element, range(1, cells + 1)), ("upper half", element, range(cells + 1, 2 * cells + 1)),
                  ("both", element, range(1, 2 * cells + 1)), ("lid", element, range(2 * cells + 9, 2 * cells + 17)),
                  ("corner", node, [1])]
        universal(path, groups)
        text = report(path, 0, "--body", "lower=lower half", "--body", "upper=upper half")
        for name in ("lower", "upper"):
            self.assertIn(f'Body "{name}": {CUBE}', text)
        self.assertEqual(text.count('part "lid": 8 sides, area 1, flat with normal (0, 0, 1), from (0, 0, 2)'), 1)
        self.assertEqual(text.count('nodes "corner": 1'), 1)
        self.assertIn('Body "all": 54 nodes, 96 cells', report(path, 0, "--body", "all=both"))
        for groups, said in (
            ([("lid", element, [999])], 'the group "lid" names the element 999'),
            ([("corner", node, [0])], 'the group "corner" names the node 0'),
        ):
            universal(path, groups)
            self.assertIn(said, report(path, 2))
        universal(path, [("corner", node, [1, 2, 3])])
        lines = path.read_text(encoding="utf-8").splitlines()
        path.write_text("\n".join(lines[:-2]) + "\n", encoding="utf-8")
        self.assertIn('ends within the group "corner"', report(path, 2))

    def test_models_are_told_apart_from_meshes(self):
        path = self.path("model.inp")
        path.write_text("*NODE\n1, 0, 0, 0\n", encoding="utf-8")
        self.assertIn("convert it to a deck and a mesh: harmos-inp", report(path, 2))

    def test_other_kinds_of_vtk_files(self):
        path = self.path("points.vtk")
        path.write_text("# vtk DataFile Version 3.0\npoints\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n")
        self.assertIn("a data set of the kind polydata, but bodies are made of an unstructured grid", report(path, 2))
        path.write_text(
            "# vtk DataFile Version 3.0\nno such node\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n"
            "0 0 0 1 0 0 0 1 0\nCELLS 1 4\n3 0 1 3\nCELL_TYPES 1\n5\n"
        )
        self.assertIn("a cell has the node 3, but nodes are numbered from 0 to 2", report(path, 2))

    def test_run_reads_vtu_and_warns_of_pieces(self):
        """A deck names such a file as any other: two unit squares in one region, in one of two pieces."""
        path = self.path("squares.vtk")
        squares = ((0, 0), (1, 0), (1, 1), (0, 1), (3, 0), (4, 0), (4, 1), (3, 1))
        path.write_text(
            "# vtk DataFile Version 3.0\nsquares\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n"
            + "\n".join(f"{x} {y} 0" for x, y in squares)
            + "\nCELLS 2 10\n4 0 1 2 3\n4 7 6 5 4\nCELL_TYPES 2\n9 9\n"
        )
        deck = self.path("squares.xml")
        deck.write_text(DECK)
        done = runs.start(["squares.xml", "--output", "run"], 1, program="harmos", cwd=deck.parent)
        text = done.stdout + done.stderr
        self.assertIn('Body "surface 1" is in 2 pieces without common nodes', text)
        self.assertEqual(done.returncode, 0, text)


WEIGHT = """<ParameterList name="harmos">
  <ParameterList name="Model">
    <Parameter name="Physics" type="string" value="{physics}"/>
    <Parameter name="Mesh file" type="string" value="cell.vtu"/>
  </ParameterList>
  <ParameterList name="Materials">
    <ParameterList name="m"/>
  </ParameterList>
  <ParameterList name="Bodies">
    <ParameterList name="{body}">
      <Parameter name="Materials" type="Array(string)" value="{{m}}"/>
    </ParameterList>
  </ParameterList>
  <ParameterList name="Boundary parts">
    <ParameterList name="low">
      <Parameter name="Normal" type="Array(double)" value="{down}"/>
    </ParameterList>
  </ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Prescribed displacement">
      <ParameterList name="held">
        <Parameter name="Part" type="string" value="{body}/low"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Body force">
      <ParameterList name="weight">
        <Parameter name="Body" type="string" value="{body}"/>
        <Parameter name="Density" type="Array(double)" value="{down}"/>
      </ParameterList>
    </ParameterList>
  </ParameterList>
</ParameterList>
"""

DECK = """<ParameterList name="harmos">
  <ParameterList name="Model">
    <Parameter name="Physics" type="string" value="plane strain"/>
    <Parameter name="Mesh file" type="string" value="squares.vtk"/>
  </ParameterList>
  <ParameterList name="Materials">
    <ParameterList name="m"/>
  </ParameterList>
  <ParameterList name="Bodies">
    <ParameterList name="surface 1">
      <Parameter name="Materials" type="Array(string)" value="{m}"/>
    </ParameterList>
  </ParameterList>
  <ParameterList name="Boundary parts">
    <ParameterList name="low">
      <Parameter name="Normal" type="Array(double)" value="{0, -1, 0}"/>
    </ParameterList>
    <ParameterList name="high">
      <Parameter name="Normal" type="Array(double)" value="{0, 1, 0}"/>
    </ParameterList>
  </ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Prescribed displacement">
      <ParameterList name="held">
        <Parameter name="Part" type="string" value="surface 1/low"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Traction">
      <ParameterList name="pull">
        <Parameter name="Part" type="string" value="surface 1/high"/>
        <Parameter name="Density" type="Array(double)" value="{0, 0.001, 0}"/>
      </ParameterList>
    </ParameterList>
  </ParameterList>
</ParameterList>
"""

if __name__ == "__main__":
    runs.main()
