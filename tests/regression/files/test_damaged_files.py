# SPDX-License-Identifier: BSD-3-Clause
"""Mesh files that are damaged or cut short: a thousand of them end with a sentence and exit status 2, or are read.

    test_damaged_files.py [NUMBER]      so many in the place of 1000

What it guards against: crashes, exceptions of libraries, hangs, memory that is asked for by a damaged number, errors that do not name the
file, and files of harmos-mesh that are read as if nothing had happened. Files of other programs may be damaged in ways that leave a mesh.
"""

import collections
import random
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import exodus_files  # noqa: E402
import harmos_runs as runs  # noqa: E402
import test_foreign_meshes as foreign  # noqa: E402
import test_mesh_program as meshes  # noqa: E402

NUMBER = int(sys.argv.pop()) if sys.argv[-1].isdigit() else 1000
SEED = 24
SQUARE_GEO = """
Point(1) = {0, 0, 0, 0.5}; Point(2) = {1, 0, 0, 0.5}; Point(3) = {1, 1, 0, 0.5}; Point(4) = {0, 1, 0, 0.5};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Physical Curve("left") = {4}; Physical Surface("plate") = {1};
"""
# A quadrilateral and a triangle.
MIXED = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
5
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 2 0.5 0
$EndNodes
$Elements
3
1 3 2 1 1 1 2 3 4
2 2 2 1 1 2 5 3
3 1 2 2 2 4 1
$EndElements
"""
DECK = runs.SOURCE / "apps/harmos/decks/tied_inclusion.xml"


def cut_short(random_, data):
    return data[: random_.randrange(len(data))]


def bytes_changed(random_, data):
    data = bytearray(data)
    for _ in range(random_.choice((1, 1, 2, 8, 64))):
        data[random_.randrange(len(data))] = random_.randrange(256)
    return bytes(data)


def piece_lost(random_, data):
    begin = random_.randrange(len(data))
    return data[:begin] + data[begin + random_.randrange(1, 64) :]


def piece_repeated(random_, data):
    begin = random_.randrange(len(data))
    end = min(len(data), begin + random_.randrange(1, 64))
    return data[:end] + data[begin:]


def zeros(random_, data):
    begin = random_.randrange(len(data))
    size = min(len(data) - begin, random_.randrange(1, 512))
    return data[:begin] + bytes(size) + data[begin + size :]


def number_changed(random_, data):
    """Of a text: one of its numbers becomes huge, negative, no number."""
    words = data.split(b" ")
    places = [k for k, word in enumerate(words) if word.strip(b"-.\n").isdigit()]
    if not places:
        return bytes_changed(random_, data)
    words[random_.choice(places)] = random_.choice((b"-1", b"0", b"99999999", b"4000000000", b"1e308", b"nan", b"x", b""))
    return b" ".join(words)


DAMAGES = (cut_short, bytes_changed, piece_lost, piece_repeated, zeros, number_changed)


class Damaged(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = runs.scratch("damaged")
        cls.directory.mkdir()
        step = cls.directory / "boxes.step"
        (cls.directory / "boxes.geo").write_text(meshes.BOXES + f'Save "{step}";\n', encoding="utf-8")
        done = meshes.mesh(cls.directory / "boxes.geo")
        assert done.returncode == 0, done
        cut = cls.directory / "cut.h5"
        done = meshes.mesh(DECK.with_suffix(".geo"), "--output", cut, "--dimension", 2, "--subdomains", 4)
        assert done.returncode == 0, done
        exodus = cls.directory / "brick.exo"
        corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        exodus_files.write(exodus, corners, [("brick", "HEX8", [list(range(1, 9))])], [("floor", [1], [5])],
                           [("corner", [1])], {"temperature": range(8)})
        universal = cls.directory / "cubes.unv"
        foreign.universal(universal, [("lower", 8, range(1, 49)), ("upper", 8, range(49, 97)), ("corner", 7, [1, 2])])
        cls.files = {
            "cubes.unv": (universal.read_bytes(), 3), "mixed.msh": (MIXED.encode(), 2),
            "two.msh": (meshes.MSH_2.encode(), 2), "four.msh": (meshes.MSH_4.encode(), 2),
            "square.vtk": (meshes.VTK.encode(), 2), "square.geo": (SQUARE_GEO.encode(), 2),
            "brick.exo": (exodus.read_bytes(), 3), "boxes.step": (step.read_bytes(), 3), "cut.h5": (cut.read_bytes(), 2),
        }
        sets = {"Model/Mesh file": cut, "Bodies/plate/Subdomains": 1, "Bodies/inclusion/Subdomains": 1}
        cls.energy = runs.solved(cls("test_all"), DECK, sets, np=0, program="harmos").summary["energy"]

    def read(self, path, dimension):
        """The program that reads such a file."""
        if path.suffix != ".h5":
            return meshes.mesh(path, "--dimension", dimension, "--output", self.directory / "out.h5")
        sets = {"Model/Mesh file": path, "Bodies/plate/Subdomains": 1, "Bodies/inclusion/Subdomains": 1}
        return runs.run(DECK, sets, np=0, output=self.directory / "run", program="harmos")

    def test_all(self):
        chance = random.Random(SEED)
        ends = collections.Counter()
        runs.TIMEOUT = 60
        for number in range(NUMBER):
            name = list(self.files)[number % len(self.files)]
            data, dimension = self.files[name]
            damage = chance.choice(DAMAGES)
            path = self.directory / name
            path.write_bytes(damage(chance, data))
            with self.subTest(number=number, file=name, damage=damage.__name__):
                done = self.read(path, dimension)
                ends[name, done.returncode] += 1
                self.assertIn(done.returncode, (0, 2), done)
                if done.returncode == 2:
                    self.assertEqual(len(done.errors), 1, done)
                    self.assertIn(name, done.errors[0])
                    self.assertGreater(len(done.errors[0].split()), 5, done)
                elif name == "cut.h5":  # a byte that nothing depends on
                    self.assertEqual(done.summary["energy"], self.energy)
        rows = [(name, ends[name, 2], ends[name, 0]) for name in self.files]
        runs.table(f"{NUMBER} damaged files", ("file", "refused", "read"), rows)
        for name, refused, _ in rows:
            self.assertGreater(refused, 0, name)


if __name__ == "__main__":
    runs.main()
