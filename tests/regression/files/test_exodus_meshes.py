# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of Exodus, read by harmos-mesh and solved.

What it guards against: nodes or sides in another order than the manual's, blocks, sets and fields that get lost, sides
of the wrong element where there are several blocks, refusals that do not name what is wrong.
"""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np

    import exodus_files
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

# Corners, edges in the order of their middle nodes, sides by their corners: figures of the manual, nodes from 1.
TRIANGLE = (
    [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(1, 2), (2, 3), (3, 1)], [(1, 2), (2, 3), (3, 1)],
)
QUADRILATERAL = (
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(1, 2), (2, 3), (3, 4), (4, 1)], [(1, 2), (2, 3), (3, 4), (4, 1)],
)
TETRAHEDRON = (
    [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    [(1, 2), (2, 3), (3, 1), (1, 4), (2, 4), (3, 4)],
    [(1, 2, 4), (2, 3, 4), (1, 4, 3), (1, 3, 2)],
)
WEDGE = (
    [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
    [(1, 2), (2, 3), (3, 1), (1, 4), (2, 5), (3, 6), (4, 5), (5, 6), (6, 4)],
    [(1, 2, 5, 4), (2, 3, 6, 5), (1, 4, 6, 3), (1, 3, 2), (4, 5, 6)],
)
HEXAHEDRON = (
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    [(1, 2), (2, 3), (3, 4), (4, 1), (1, 5), (2, 6), (3, 7), (4, 8), (5, 6), (6, 7), (7, 8), (8, 5)],
    [(1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (1, 5, 8, 4), (1, 4, 3, 2), (5, 6, 7, 8)],
)
MIDDLE = tuple(range(1, 9))
TYPES = {
    "TRI3": (TRIANGLE, 3, ()), "TRI6": (TRIANGLE, 6, ()), "QUAD4": (QUADRILATERAL, 4, ()),
    "QUAD8": (QUADRILATERAL, 8, ()), "QUAD9": (QUADRILATERAL, 8, ((1, 2, 3, 4),)),
    "TETRA": (TETRAHEDRON, 4, ()), "TETRA10": (TETRAHEDRON, 10, ()), "WEDGE": (WEDGE, 6, ()),
    "WEDGE15": (WEDGE, 15, ()), "HEX": (HEXAHEDRON, 8, ()), "HEX8": (HEXAHEDRON, 8, ()), "HEX20": (HEXAHEDRON, 20, ()),
    "HEX27": (HEXAHEDRON, 20, (MIDDLE, (1, 2, 3, 4), (5, 6, 7, 8), (1, 4, 8, 5), (2, 3, 7, 6), (1, 2, 6, 5),
                               (4, 3, 7, 8))),
}


def places_of(type_):
    (corners, edges, _), count, more = TYPES[type_]
    corners = np.array(corners, float)
    middles = [corners[[a - 1, b - 1]].mean(axis=0) for a, b in edges]
    rest = [corners[[k - 1 for k in nodes]].mean(axis=0) for nodes in more]
    return np.array([*[*corners, *middles][:count], *rest]) * (2.0, 3.0, 5.0)


def mesh(path, *words):
    return runs.start([path.name, *words], 0, program="harmos-mesh", cwd=path.parent)


class Read(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = runs.scratch("exodus")
        cls.directory.mkdir(parents=True, exist_ok=True)

    def file(self, name, *data, **more):
        exodus_files.write(self.directory / name, *data, **more)
        return self.directory / name

    def read(self, path):
        done = mesh(path, "--output", "out.h5")
        self.assertEqual(done.returncode, 0, done)
        return done.stdout

    def test_every_type_has_its_nodes_and_sides(self):
        """A file for each dimension, with a block of one element of each type."""
        for width in (2, 3):
            points, blocks, sets = [], [], []
            types = [type_ for type_ in TYPES if (type_[:3] in ("TRI", "QUA")) == (width == 2)]
            for type_ in types:
                places = places_of(type_)
                blocks.append((type_.lower(), type_, [list(range(len(points) + 1, len(points) + len(places) + 1))]))
                points += list(places)
                sides = range(1, len(TYPES[type_][0][2]) + 1)
                sets += [(f"{type_.lower()}_{k}", [len(blocks)], [k]) for k in sides]
            self.read(self.file("all.exo", points, blocks, sets, dimension=width))
            with h5py.File(self.directory / "out.h5", "r") as file:
                order = bytes(file["bodies"][()]).decode().split()
                self.assertEqual(sorted(order), sorted(type_.lower() for type_ in types))
                for type_ in types:
                    with self.subTest(type=type_):
                        self.check(file[f"body_{order.index(type_.lower())}"], type_, width)

    def check(self, body, type_, width):
        places, sides = places_of(type_)[:, :width], TYPES[type_][0][2]
        read = body["coordinates"][()].reshape(-1, width) + body["anchor"][()][0, :width]
        np.testing.assert_allclose(read[body["cells"][()].ravel()], places, atol=1e-14)
        names = bytes(body["parts"][()]).decode().split()
        self.assertEqual(sorted(names), sorted(f"{type_.lower()}_{k}" for k in range(1, len(sides) + 1)))
        for p, name in enumerate(names):
            nodes = read[body[f"part_{p}/nodes"][()].ravel()]
            corners = places[[k - 1 for k in sides[int(name.rsplit("_", 1)[1]) - 1]]]
            for corner in corners:  # and the middles of what is between them
                self.assertTrue((np.abs(nodes - corner).max(axis=1) < 1e-14).any(), f"{name} of {type_}")
            self.assertTrue(((nodes <= corners.max(axis=0)) & (nodes >= corners.min(axis=0))).all())

    def two_blocks(self, name="two.exo", **more):
        """A wedge of 6 and a hexahedron, whose numbers go on; a field that is z."""
        wedge, box = places_of("WEDGE"), places_of("HEX") + (0.0, 0.0, 5.0)
        blocks = [("roof", "WEDGE", [list(range(1, 7))]), ("box", "HEX8", [list(range(7, 15))])]
        sets = [("floor", [1], [4]), ("lid", [2], [6]), ("left", [2, 1], [4, 3])]
        points = [*wedge, *box]
        return self.file(name, points, blocks, sets, [("corner", [1, 7])],
                         {"temperature": np.transpose(points)[2]}, **more)

    def test_blocks_are_bodies_and_sets_are_parts(self):
        printed = self.read(self.two_blocks())
        for text in (
            'Body "roof": 6 nodes, 1 cells (wedge of 6 nodes), quality ', 'Body "box": 8 nodes, 1 cells (hexahedron of 8',
            'part "floor": 1 sides, area 3, flat with normal (0, 0, -1), from (0, 0, 0) to (2, 3, 0)',
            'part "lid": 1 sides, area 6, flat with normal (0, 0, 1), from (0, 0, 10) to (2, 3, 10)',
            'part "left": 1 sides, area 15, flat with normal (-1, 0, 0), from (0, 0, 0) to (0, 3, 5)',
            'part "left": 1 sides, area 15, flat with normal (-1, 0, 0), from (0, 0, 5) to (0, 3, 10)',
            'nodes "corner": 1',
        ):
            self.assertIn(text, printed)

    def test_fields_become_those_of_the_bodies(self):
        self.read(self.two_blocks())
        with h5py.File(self.directory / "out.h5", "r") as file:
            self.assertEqual(bytes(file["bodies"][()]).decode().split(), ["box", "roof"])
            for body, lift in ((file["body_0"], 5.0), (file["body_1"], 0.0)):
                self.assertEqual(bytes(body["fields"][()]).decode().split(), ["temperature"])
                heights = body["coordinates"][()].reshape(-1, 3)[:, 2] + body["anchor"][()][0, 2]
                np.testing.assert_allclose(np.ravel(body["field_0"][()]), heights, atol=1e-14)
                self.assertEqual(heights.min(), lift)

    def test_what_is_wrong_is_told(self):
        places, cell = places_of("HEX"), [list(range(1, 9))]
        cases = {
            "beam": ([("frame", "BEAM", [[1, 2]])], (), 'block "frame" has elements of the type "BEAM" with 2 nodes'),
            "node": ([("b", "HEX", [[1, 2, 3, 4, 5, 6, 7, 9]])], (), 'block "b" has elements with node 9, which does not'),
            "side": ([("b", "HEX", cell)], [("s", [1], [7])], 'side set "s" has the side 7 of element 1, a hexahedron'),
            "element": ([("b", "HEX", cell)], [("s", [2], [1])], 'side set "s" has the element 2, which does not exist'),
        }
        for name, (blocks, sets, text) in cases.items():
            with self.subTest(case=name):
                done = mesh(self.file(f"{name}.exo", places, blocks, sets))
                self.assertEqual(done.returncode, 2, done)
                self.assertIn(text, done.stderr)
        path = self.directory / "text.exo"
        path.write_text("no netCDF", encoding="utf-8")
        done = mesh(path)
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done)
        self.assertIn("it is no file of Exodus II, or is damaged", done.stderr)


if __name__ == "__main__":
    runs.main()
