# SPDX-License-Identifier: BSD-3-Clause
"""Results converted by harmos-exodus, read back by other means than its own.

What each class guards against:

    Bodies     copies of nodes that stay apart, nodes of pieces or of bodies that are joined, values at other nodes or
               cells, blocks without their body's name
    Elements   nodes of a cell in another order than that of Exodus
    Steps      results that are lost, or have the time of another step
    Readers    a file that scipy reads, and meshio or VTK do not, or without vectors and tensors
    Faults     anything but a sentence and exit status 2 where there is nothing to convert
"""

import csv
import functools
import importlib.util
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np
    from scipy.io import netcdf_file
    from scipy.spatial import cKDTree
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

TOOL = runs.BINARY / "bin/harmos-exodus"
BLOCKS = runs.SOURCE / "apps/harmos/decks/two_blocks.xml"
BLOCK = runs.SOURCE / "apps/signorini/decks/block.xml"

# Exodus II manual, by the head of the element's name: share that a cell has of the box that its edges span at a corner;
# corners, each with its neighbours so that these are a right-handed system; faces, of which in the plane edges.
SHARE = {"TRI": 1 / 2, "QUAD": 1.0, "TETRA": 1 / 6, "WEDGE": 1 / 2, "HEX": 1.0}
CORNERS = {
    "TRI": ((0, 1, 2), (1, 2, 0), (2, 0, 1)),
    "QUAD": ((0, 1, 3), (1, 2, 0), (2, 3, 1), (3, 0, 2)),
    "TETRA": ((0, 1, 2, 3),),
    "WEDGE": ((0, 1, 2, 3), (1, 2, 0, 4), (2, 0, 1, 5), (3, 5, 4, 0), (4, 3, 5, 1), (5, 4, 3, 2)),
    "HEX": ((0, 1, 3, 4), (1, 2, 0, 5), (2, 3, 1, 6), (3, 0, 2, 7), (4, 7, 5, 0), (5, 4, 6, 1), (6, 5, 7, 2),
            (7, 6, 4, 3)),
}
FACES = {
    "TRI": ((0, 1), (1, 2), (2, 0)),
    "QUAD": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "TETRA": ((0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 2, 1)),
    "WEDGE": ((0, 1, 4, 3), (1, 2, 5, 4), (0, 3, 5, 2), (0, 2, 1), (3, 4, 5)),
    "HEX": ((0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 4, 7, 3), (0, 3, 2, 1), (4, 5, 6, 7)),
}
# Corners between which the nodes lie that are none.
BETWEEN = {
    "TRI": ((0, 1), (1, 2), (2, 0)),
    "QUAD": ((0, 1), (1, 2), (2, 3), (3, 0), (0, 1, 2, 3)),
    "TETRA": ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)),
    "WEDGE": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 4), (2, 5), (3, 4), (4, 5), (5, 3), (0, 1, 4, 3), (1, 2, 5, 4),
              (0, 2, 5, 3)),
    "HEX": ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4),
            tuple(range(8)), (0, 1, 2, 3), (4, 5, 6, 7), (0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (2, 3, 7, 6)),
}


class Exodus:
    """The arrays of a file, by scipy."""

    def __init__(self, path):
        with netcdf_file(path, "r", mmap=False) as file:
            self.dimensions = dict(file.dimensions)
            self.values = {name: variable[:].copy() for name, variable in file.variables.items()}
            self.attributes = dict(file._attributes)
            kinds = [variable.elem_type.decode() for name, variable in self.named(file.variables, "connect")]
        self.path, self.begin = path, Path(path).read_bytes()[:4]
        self.times = self.values["time_whole"]
        self.xyz = np.zeros((self.dimensions["num_nodes"], 3))
        for axis, letter in enumerate("xyz"[: self.dimensions["num_dim"]]):
            self.xyz[:, axis] = self.values[f"coord{letter}"]
        cells = [values - 1 for _, values in self.named(self.values, "connect")]
        self.blocks = dict(zip(self.texts("eb_names"), zip(kinds, cells)))

    @staticmethod
    def named(items, head):
        return [(f"{head}{k}", items[f"{head}{k}"]) for k in range(1, len(items)) if f"{head}{k}" in items]

    def texts(self, name):
        return [row.tobytes().rstrip(b"\0").decode() for row in self.values[name]]

    def nodal(self, name, step=0):
        return self.values[f"vals_nod_var{self.texts('name_nod_var').index(name) + 1}"][step]

    def vectors(self, name, step=0):
        return np.column_stack([self.nodal(f"{name}_{axis}", step) for axis in "xyz"[: self.dimensions["num_dim"]]])

    def elemental(self, name, block, step=0):
        variable, number = self.texts("name_elem_var").index(name) + 1, list(self.blocks).index(block) + 1
        return self.values[f"vals_elem_var{variable}eb{number}"][step]


class Result:
    """The arrays of a result, by h5py, with the body of each point and the middle of each cell."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            root = file["VTKHDF"]
            self.point_data = {name: item[()] for name, item in root["PointData"].items()}
            self.cell_data = {name: item[()] for name, item in root["CellData"].items()}
            self.xyz, points, cells = root["Points"][()], root["NumberOfPoints"][()], root["NumberOfCells"][()]
            offsets, links = root["Offsets"][()], root["Connectivity"][()]
            lengths = root["NumberOfConnectivityIds"][()]
        first = np.concatenate([[0], np.cumsum(cells)[:-1]])
        self.body = np.repeat(self.cell_data["body"][first], points)
        self.middles = []
        for part in range(len(points)):
            own = links[lengths[:part].sum() :] + points[:part].sum()
            ends = offsets[first[part] + part :][: cells[part] + 1]
            self.middles += [self.xyz[own[a:b]].mean(axis=0) for a, b in zip(ends[:-1], ends[1:])]
        self.middles = np.array(self.middles)


def convert(directory, *words, **environment):
    return subprocess.run([TOOL, directory, *words], capture_output=True, text=True, env={**os.environ, **environment})


def head(kind):
    return kind.rstrip("0123456789")


def spans(exodus, kind, cells):
    """Of each cell at each corner the product of the edges: its area or volume if it is a box."""
    xyz = exodus.xyz[cells]
    result = []
    for corner, *others in CORNERS[head(kind)]:
        edges = np.stack([xyz[:, other] - xyz[:, corner] for other in others], axis=1)
        result.append(np.linalg.det(edges[:, :, : edges.shape[1]]))
    return np.array(result)


def outer_faces(cells, faces):
    """How many faces only one cell has."""
    count = 0
    for length in {len(face) for face in faces}:
        corners = np.concatenate([np.sort(cells[:, face], axis=1) for face in faces if len(face) == length])
        count += int((np.unique(corners, axis=0, return_counts=True)[1] == 1).sum())
    return count


def entry(name, value):
    """A parameter, of the type that its value has."""
    items = value if isinstance(value, (list, tuple)) else [value]
    kind = {str: "string", int: "int", float: "double"}[type(items[0])]
    if items is value:
        kind, value = f"Array({kind})", "{" + ", ".join(map(str, items)) + "}"
    return f'<Parameter name="{name}" type="{kind}" value="{value}"/>'


def list_of(name, items):
    text = "".join(list_of(key, item) if isinstance(item, dict) else entry(key, item) for key, item in items.items())
    return f'<ParameterList name="{name}">{text}</ParameterList>'


def solved(case, physics, bodies, low, down, model=None, **effects):
    """Bodies that are held at their part of the name `low` and pulled by their weight; the run."""
    directory = runs.scratch("exodus")
    directory.mkdir()
    for name, text in (model or {}).items():
        (directory / name).write_text(text, encoding="utf-8")
    items = {
        "Model": {"Physics": physics, **{"Mesh file": name for name in model or {}}},
        "Materials": {"m": {}},
        "Bodies": {name: {"Materials": ["m"], **body} for name, body in bodies.items()},
        **({"Boundary parts": {low: {"Normal": down}}} if model else {}),
        "Effects": {
            "Prescribed displacement": {f"held {name}": {"Part": f"{name}/{low}"} for name in bodies},
            "Body force": {f"weight {name}": {"Body": name, "Density": down} for name in bodies},
        },
    }
    deck = directory / "deck.xml"
    deck.write_text(list_of("harmos", items), encoding="utf-8")
    return runs.solved(case, deck, program="harmos").directory


def gmsh(names, points, cells):
    """A mesh file; cells are (type, group, nodes), groups and nodes counted from one."""
    dimension = 2 if all(point[2] == 0 for point in points) else 3
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'{dimension} {k} "{name}"' for k, name in enumerate(names, 1)]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(points))]
    lines += [f"{k} {x:.17g} {y:.17g} {z:.17g}" for k, (x, y, z) in enumerate(points, 1)]
    lines += ["$EndNodes", "$Elements", str(len(cells))]
    lines += [f"{k} {kind} 2 {group} {group} {' '.join(map(str, nodes))}" for k, (kind, group, nodes) in
              enumerate(cells, 1)]
    return "\n".join([*lines, "$EndElements", ""])


@functools.cache
def block_run():
    """A cube of 6 x 6 x 6 hexahedra in eight subdomains, solved as loosely as the deck says."""
    sets = {"Model/Subdomains per side": 2, "Model/Elements per subdomain side": 3,
            "Output/Expert/Cell fields": "stress"}
    return runs.solved(unittest.TestCase(), BLOCK, sets).directory


@functools.cache
def steps_run():
    """Two blocks, of which the results of steps 3 and 4 are kept."""
    return runs.solved(unittest.TestCase(), BLOCKS, {"Steps/Number": 4, "Output/Every": 3}, program="harmos").directory


SIZE = (1.0, 0.7, 1.3)
GRID = (4, 2, 2)  # hexahedra, each of which is cut into six tetrahedra


@functools.cache
def elements_run():
    """A box of each kind of element, in four subdomains."""
    bodies = {
        element: {"Source": "block", "Element": element, "Origin": [2.0 * k, 0.0, 0.0], "Size": list(SIZE),
                  "Subdomains a side": [2, 1, 2], "Elements a side": [2, 2, 1]}
        for k, element in enumerate(("Q1", "Q2", "S2", "P1", "P2"))
    }
    return solved(unittest.TestCase(), "solid", bodies, "bottom", [0.3, 0.1, -1.0])


class Case(unittest.TestCase):
    def converted(self, directory):
        """The file, and what the tool has printed."""
        path = runs.scratch("result").with_suffix(".exo")
        done = convert(directory, "--output", path)
        self.assertEqual(done.returncode, 0, done)
        return Exodus(path), done.stdout

    def assert_values(self, exodus, result, step=0):
        """Displacements and cell data are those of the result at the same place of the same body."""
        for body, (name, (_, cells)) in enumerate(exodus.blocks.items()):
            own = np.flatnonzero(result.body == body)
            nodes = np.unique(cells)
            near = cKDTree(result.xyz[own]).query_ball_point(exodus.xyz[nodes], 1e-9)
            u = result.point_data["displacement"].reshape(len(result.xyz), -1)
            written = exodus.vectors("displacement", step) if u.shape[1] > 1 else exodus.nodal("displacement", step)
            written = written.reshape(len(exodus.xyz), -1)
            for node, copies in zip(nodes, near):
                apart = np.abs(u[own[copies], : written.shape[1]] - written[node]).max(axis=1)
                self.assertEqual(apart.min(), 0.0)
            middles = exodus.xyz[cells].mean(axis=1)
            own = np.flatnonzero(result.cell_data["body"] == body)
            distance, place = cKDTree(result.middles[own]).query(middles)
            self.assertLess(distance.max(), 1e-9)
            self.assertEqual(len(np.unique(place)), len(own))
            for data, values in result.cell_data.items():
                if values.ndim == 1:
                    np.testing.assert_array_equal(exodus.elemental(data, name, step), values[own[place]])

    def assert_box(self, exodus, name, nodes, volume, faces):
        """The block has so many nodes and the volume of a box, no cell that is inside out, no gap between cells."""
        kind, cells = exodus.blocks[name]
        self.assertEqual(len(np.unique(cells)), nodes)
        size = SHARE[head(kind)] * spans(exodus, kind, cells)
        self.assertGreater(size.min(), 0.0)
        self.assertAlmostEqual(size[0].sum(), volume, delta=1e-12)
        self.assertEqual(outer_faces(cells, FACES[head(kind)]), faces)


class Bodies(Case):
    def test_block_in_space(self):
        exodus, text = self.converted(block_run())
        self.assertIn("343 nodes, 216 elements, 1 block(s), 1 time step(s)", text)
        self.assertEqual(exodus.dimensions["num_nodes"], 343)
        self.assertEqual(exodus.begin, b"CDF\x02")  # offsets of 64 bits
        self.assertEqual(exodus.texts("coor_names"), ["x", "y", "z"])
        self.assertEqual([(name, kind) for name, (kind, _) in exodus.blocks.items()], [("block", "HEX8")])
        self.assert_box(exodus, "block", 343, 1.0, 6 * 36)
        result = Result(block_run() / "result.vtkhdf")
        self.assertEqual(len(result.xyz), 8 * 64)
        self.assert_values(exodus, result)
        # The stresses of cells, whose order is kept within a body.
        for k, name in enumerate(("xx", "yy", "zz", "xy", "yz", "zx")):
            written = exodus.elemental(f"cell_stress_{name}", "block")
            np.testing.assert_array_equal(written, result.cell_data["cell_stress"][:, k])

    def test_plane_blocks_have_their_names(self):
        exodus, _ = self.converted(steps_run())
        self.assertEqual(exodus.dimensions["num_dim"], 2)
        self.assertNotIn("coordz", exodus.values)
        self.assertNotIn("displacement_z", exodus.texts("name_nod_var"))
        self.assertEqual([(name, kind) for name, (kind, _) in exodus.blocks.items()],
                         [("lower", "QUAD9"), ("upper", "QUAD4")])
        self.assert_box(exodus, "lower", 33 * 17, 2.0, 2 * (16 + 8))
        self.assert_box(exodus, "upper", 15 * 8, 0.5, 2 * (14 + 7))
        self.assertEqual(exodus.dimensions["num_nodes"], 33 * 17 + 15 * 8)
        self.assertEqual(exodus.xyz[exodus.blocks["lower"][1], 1].max(), 1.0)
        self.assertEqual(exodus.attributes["title"], b"two blocks")

    def test_membranes(self):
        sets = {"Model/Subdomains per side": 2, "Model/Elements per subdomain side": 4}
        directory = runs.solved(self, runs.MODEL, sets).directory
        exodus, _ = self.converted(directory)
        self.assertEqual(exodus.dimensions["num_nodes"], 2 * 81)
        self.assert_values(exodus, Result(directory / "result.vtkhdf"))

    def test_places_that_differ_by_rounding(self):
        directory = runs.scratch("rounded")
        shutil.copytree(block_run(), directory)
        with h5py.File(directory / "result.vtkhdf", "r+") as file:
            points = file["VTKHDF/Points"]
            points[:64] = points[:64] * (1 + 3e-13) - 2e-13
        self.assertEqual(self.converted(directory)[0].dimensions["num_nodes"], 343)

    def test_pieces_that_nothing_couples_stay_apart(self):
        """Of one body in two regions: a square, and beside it a column of two squares.

        What touches at the ground moves as one, but has another stress. Without stresses nothing tells it apart.
        """
        points = [(x, y, 0.0) for y in (0, 1) for x in (0, 1)] + [(x, y, 0.0) for y in (0, 1, 2) for x in (1, 2)]
        cells = [(3, 1, (1, 2, 4, 3)), (3, 2, (5, 6, 8, 7)), (3, 2, (7, 8, 10, 9))]
        directory = solved(self, "plane strain", {"both": {"Groups": ["left", "right"]}}, "low", [0.0, -1.0, 0.0],
                           {"squares.msh": gmsh(("left", "right"), points, cells)})
        exodus, _ = self.converted(directory)
        self.assertEqual(list(exodus.blocks), ["both", "both_2"])
        self.assertEqual(exodus.elemental("region", "both_2").tolist(), [1.0, 1.0])
        self.assertEqual(exodus.dimensions["num_nodes"], 4 + 6)
        self.assertEqual([len(np.unique(cells)) for _, cells in exodus.blocks.values()], [4, 6])
        with h5py.File(directory / "result.vtkhdf", "r+") as file:
            del file["VTKHDF/PointData/stress"]
        exodus, _ = self.converted(directory)
        self.assertEqual(exodus.dimensions["num_nodes"], 4 + 6 - 1)
        both = set.intersection(*(set(cells.ravel()) for _, cells in exodus.blocks.values()))
        np.testing.assert_allclose(exodus.xyz[list(both)], [[1, 0, 0]])


class Elements(Case):
    def assert_between(self, exodus, name):
        kind, cells = exodus.blocks[name]
        first = len({corner for corners in CORNERS[head(kind)] for corner in corners})
        for node, ends in zip(range(first, cells.shape[1]), BETWEEN[head(kind)]):
            ends = list(ends) if kind != "HEX20" else list(BETWEEN["HEX"][node - 8])
            middle = exodus.xyz[cells[:, ends]].mean(axis=1)
            np.testing.assert_allclose(exodus.xyz[cells[:, node]], middle, atol=1e-12, err_msg=f"{kind}, node {node}")

    def test_boxes(self):
        exodus, _ = self.converted(elements_run())
        self.assertEqual({name: kind for name, (kind, _) in exodus.blocks.items()},
                         {"Q1": "HEX8", "Q2": "HEX27", "S2": "HEX20", "P1": "TETRA4", "P2": "TETRA10"})
        x, y, z = GRID
        corners, all_nodes = (x + 1) * (y + 1) * (z + 1), (2 * x + 1) * (2 * y + 1) * (2 * z + 1)
        edges = x * (y + 1) * (z + 1) + y * (x + 1) * (z + 1) + z * (x + 1) * (y + 1)
        faces = 2 * (x * y + y * z + z * x)
        for name, nodes, parts in (("Q1", corners, 1), ("Q2", all_nodes, 1), ("S2", corners + edges, 1),
                                   ("P1", corners, 2), ("P2", all_nodes, 2)):
            with self.subTest(name):
                self.assert_box(exodus, name, nodes, SIZE[0] * SIZE[1] * SIZE[2], parts * faces)
                self.assert_between(exodus, name)
        self.assert_values(exodus, Result(elements_run() / "result.vtkhdf"))

    def test_wedges(self):
        """A box of two for each number of nodes; Gmsh has the edges in another order again."""
        square = np.array([(0, 0), (1, 0), (1, 0.8), (0, 0.8)], float)
        between = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5), (0, 1, 4, 3), (0, 2, 5, 3),
                   (1, 2, 5, 4))
        numbers, cells, kinds = {}, [], {"WEDGE6": 6, "WEDGE15": 18, "WEDGE18": 13}
        for group, (name, kind) in enumerate(kinds.items(), 1):
            for triangle in ((0, 1, 2), (0, 2, 3)):
                corners = np.array([(*(square[k] + [2 * group, 0]), z) for z in (0, 1.2) for k in triangle])
                places = [*corners, *(corners[list(ends)].mean(axis=0) for ends in between)][: int(name[5:])]
                keys = [tuple(np.round(place, 9)) for place in places]
                cells.append((kind, group, [numbers.setdefault(key, len(numbers) + 1) for key in keys]))
        directory = solved(self, "solid", {name: {} for name in kinds}, "low", [0.0, 0.0, -1.0],
                           {"wedges.msh": gmsh(kinds, numbers, cells)})
        exodus, _ = self.converted(directory)
        self.assertEqual({name: kind for name, (kind, _) in exodus.blocks.items()}, {name: name for name in kinds})
        for name, nodes in (("WEDGE6", 8), ("WEDGE15", 8 + 14), ("WEDGE18", 8 + 14 + 5)):
            with self.subTest(name):
                self.assert_box(exodus, name, nodes, 0.8 * 1.2, 4 + 4)
                self.assert_between(exodus, name)
        self.assert_values(exodus, Result(directory / "result.vtkhdf"))


class Steps(Case):
    def test_times_and_values(self):
        directory = steps_run()
        with open(directory / "steps.csv", newline="", encoding="utf-8") as file:
            times = {int(row["step"]): float(row["time"]) for row in csv.DictReader(file)}
        exodus, text = self.converted(directory)
        self.assertIn("2 time step(s)", text)
        self.assertEqual(exodus.times.tolist(), [times[3], times[4]])
        self.assertEqual(exodus.values["vals_nod_var1"].shape, (2, 33 * 17 + 15 * 8))
        for k, step in enumerate((3, 4)):
            self.assert_values(exodus, Result(directory / f"result_{step:04d}.vtkhdf"), k)
        self.assertGreater(np.abs(exodus.nodal("displacement_y", 1) - exodus.nodal("displacement_y", 0)).max(), 1e-3)


class Readers(Case):
    def written(self, directory):
        path = runs.scratch("result").with_suffix(".exo")
        self.assertEqual(convert(directory, "--output", path).returncode, 0)
        return str(path)

    def test_meshio(self):
        for module, package in (("meshio", "python3-meshio"), ("netCDF4", "python3-netcdf4")):
            if importlib.util.find_spec(module) is None:
                self.skipTest(f"the Python module {module} is missing; install {package}")
        import contextlib
        import io

        import meshio

        with contextlib.redirect_stdout(io.StringIO()):  # it remarks that it reads one step alone
            mesh = meshio.read(self.written(block_run()))
        self.assertEqual([(cells.type, cells.data.shape) for cells in mesh.cells], [("hexahedron", (216, 8))])
        self.assertEqual(mesh.points.shape, (343, 3))
        self.assertIn("von_mises", mesh.point_data)

    def test_vtk(self):
        """Vectors; nodes where its own cells have them."""
        try:
            from vtkmodules.vtkIOExodus import vtkExodusIIReader
        except ImportError as error:
            self.skipTest(f"the Python module {error.name} is missing; install python3-vtk9")
        reader = vtkExodusIIReader()
        reader.SetFileName(self.written(elements_run()))
        reader.UpdateInformation()
        reader.SetAllArrayStatus(reader.NODAL, 1)
        reader.SetApplyDisplacements(0)
        reader.Update()
        blocks = reader.GetOutput().GetBlock(0)
        names = [blocks.GetMetaData(k).Get(blocks.NAME()) for k in range(blocks.GetNumberOfBlocks())]
        self.assertEqual(names, ["Q1", "Q2", "S2", "P1", "P2"])
        for k in range(len(names)):
            grid = blocks.GetBlock(k)
            arrays = grid.GetPointData()
            width = {arrays.GetArrayName(a).rstrip("_"): arrays.GetArray(a).GetNumberOfComponents()
                     for a in range(arrays.GetNumberOfArrays())}
            self.assertEqual(width["displacement"], 3)
            cell = grid.GetCell(0)
            places = np.reshape(cell.GetParametricCoords(), (-1, 3))
            points = np.array([cell.GetPoints().GetPoint(i) for i in range(cell.GetNumberOfPoints())])
            edges = [next(points[i] - points[0] for i in range(len(points)) if (places[i] == unit).all())
                     for unit in np.eye(3)]
            np.testing.assert_allclose(points, points[0] + places @ np.array(edges), atol=1e-6)  # floats

    def test_vectors_and_tensors_of_seacas(self):
        """By its library Ioss, which newer ParaView uses."""
        try:
            from vtkmodules.vtkIOIOSS import vtkIOSSReader
        except ImportError as error:
            self.skipTest(f"the Python module {error.name} is missing; install python3-vtk9")
        for directory, dimension in ((block_run(), 3), (steps_run(), 2)):
            reader = vtkIOSSReader()
            reader.AddFileName(self.written(directory))
            reader.Update()
            arrays = reader.GetOutputDataObject(0).GetPartitionedDataSet(0).GetPartition(0).GetPointData()
            width = {arrays.GetArrayName(a).rstrip("_"): arrays.GetArray(a).GetNumberOfComponents()
                     for a in range(arrays.GetNumberOfArrays())}
            self.assertEqual((width["displacement"], width["stress"]), (dimension, 6))

    def test_library_of_exodus(self):
        exodus, _ = self.converted(steps_run())
        done = runs.start([exodus.path, "--dimension", 2], 0, program="harmos-mesh")
        self.assertEqual(done.returncode, 0, done)
        self.assertIn(f'Body "lower": {33 * 17} nodes, 128 cells (quadrilateral of 9 nodes), quality 1 mean', done.stdout)
        self.assertIn(f'Body "upper": {15 * 8} nodes, 98 cells (quadrilateral of 4 nodes), quality 1 mean', done.stdout)


class Faults(Case):
    def assert_fault(self, words, directory, *more, **environment):
        done = convert(directory, *more, **environment)
        self.assertEqual(done.returncode, 2, done)
        self.assertEqual(done.stdout, "")
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(words, done.stderr)

    def test_no_run(self):
        directory = runs.scratch("nothing")
        self.assert_fault(f"{directory}: no such directory; name the output directory of a run", directory)
        directory.mkdir()
        self.assert_fault(f"{directory}: no result of a run (result.vtkhdf); name the output", directory)

    def test_run_without_fields(self):
        sets = {"Model/Subdomains per side": 2, "Model/Elements per subdomain side": 4, "Output/Fields": False}
        directory = runs.solved(self, runs.MODEL, sets).directory
        self.assert_fault('no fields (result.vtkhdf); repeat it with "Output/Fields" = true', directory)

    def test_damaged_results(self):
        directory = runs.scratch("damaged")
        shutil.copytree(steps_run(), directory)
        last = directory / "result_0004.vtkhdf"
        with h5py.File(last, "r+") as file:
            del file["VTKHDF/PointData/gap"]
        self.assert_fault(f"{last}: the fields are not those of the first step; repeat the run", directory)
        last.write_bytes(last.read_bytes()[:5000])
        self.assert_fault(f"{last}: not a readable HDF5 file", directory)
        last.unlink()
        self.assert_fault(f"{last}: ", directory)
        (directory / "result.vtkhdf.series").write_text("{", encoding="utf-8")
        self.assert_fault("result.vtkhdf.series: no series of results", directory)
        self.assertFalse(list(directory.glob(".*.part")))

    def test_place_that_cannot_be_written(self):
        place = runs.scratch("nowhere") / "result.exo"
        self.assert_fault(f"{place}: cannot write (No such file or directory); give a writable", block_run(),
                          "--output", place)

    def test_missing_modules(self):
        for module in ("numpy", "h5py", "scipy"):
            with self.subTest(module):
                place = runs.scratch("modules")
                place.mkdir()
                (place / f"{module}.py").write_text("raise ImportError('hidden by a test')\n", encoding="utf-8")
                words = f"cannot import {module} (hidden by a test): install Debian's package python3-{module}"
                self.assert_fault(words, block_run(), PYTHONPATH=str(place))
                self.assertEqual(convert("--help", PYTHONPATH=str(place)).returncode, 0)


if __name__ == "__main__":
    runs.main()
