# SPDX-License-Identifier: BSD-3-Clause
"""Boundary parts that a deck chooses by where they are, and a look at them before a run.

What each class guards against:

    Answers   parts that are not those of the mesh: other sides, other nodes, on some ranks or from some files
    Looks     a file that VTK does not take, pictures that show other parts, no sentence where there is nothing to draw
    Faults    rules that are half given or meet nothing, and end in anything but a sentence and exit status 2
"""

import subprocess
import sys
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "apps" / "tools"))

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from matplotlib.image import imread

    import plot_parts
    import plot_style  # noqa: F401
    import run_results
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

DECKS = runs.SOURCE / "apps/harmos/decks"
BLOCKS, PUNCH = DECKS / "two_blocks.xml", DECKS / "punch.xml"

# The parts that the decks' effects name, anew: name, body, conditions.
BLOCKS_RULES = (
    ("seat", "upper", {"Normal": "{0, -1, 0}"}, "upper/bottom"),
    ("bed", "lower", {"Plane point": "{7, 1, 0}", "Plane normal": "{0, -2, 0}"}, "lower/top"),
    ("cap", "upper", {"Box from": "{-1, 1.5, -1}"}, "upper/top"),
    ("ground", "lower", {"Box to": "{9, 0, 9}"}, "lower/bottom"),
    ("side", "", {"Normal": "{-1, 0.1, 0}", "Angle": "20"}, "lower/left"),
    ("side", "", {}, "upper/left"),
)
PUNCH_RULES = (
    ("under", "block", {"Of": "{bottom}"}, "block/bottom"),
    ("over", "", {"Plane point": "{0, 0, 0.8}", "Plane normal": "{0, 0, 1}"}, "block/top"),
    ("x is 0", "", {"Normal": "{-1, 0, 0}"}, "block/x0"),
    ("y is 0", "", {"Box to": "{2, 0, 2}"}, "block/y0"),
)
TYPES = {"Angle": "double", "Of": "Array(string)", "Cylinder radius": "double", "Tolerance": "double",
         "Bodies": "Array(string)"}


def rule(name, **conditions):
    element = ElementTree.Element("ParameterList", name=name)
    for key, value in conditions.items():
        kind = TYPES.get(key, "Array(double)")
        ElementTree.SubElement(element, "Parameter", name=key, type=kind, value=value)
    return element


def deck_with(source, rules, directory, rename=True):
    """The deck with its parts chosen by rules, and with its mesh file where it is."""
    tree = ElementTree.parse(source)
    parts = ElementTree.SubElement(tree.getroot(), "ParameterList", name="Boundary parts")
    for name, body, conditions, old in rules:
        if conditions:
            parts.append(rule(name, **({"Bodies": f"{{{body}}}"} if body else {}), **conditions))
        for parameter in tree.iter("Parameter") if rename else ():
            if parameter.get("value") == old:
                parameter.set("value", old.split("/")[0] + "/" + name)
    for parameter in tree.iter("Parameter"):
        if parameter.get("name") == "Mesh file":
            parameter.set("value", str(source.parent / parameter.get("value")))
    directory.mkdir(exist_ok=True)
    path = directory / source.name
    tree.write(path)
    return path


class Answers(unittest.TestCase):
    def test_same_as_the_parts_of_the_mesh(self):
        """The same sides and nodes are the same problem, to the last bit on as many ranks."""
        for source, rules in ((BLOCKS, BLOCKS_RULES), (PUNCH, PUNCH_RULES)):
            deck = deck_with(source, rules, runs.scratch("rules"))
            for ranks in (1, 2, 4):
                with self.subTest(deck=source.name, ranks=ranks):
                    named = runs.solved(self, source, np=ranks, program="harmos").summary
                    chosen = runs.solved(self, deck, np=ranks, program="harmos").summary
                    for key in ("energy", "dual_dimension", "inequalities", "forces"):
                        self.assertEqual(chosen[key], named[key], key)

    def test_from_a_mesh_that_is_cut(self):
        directory = runs.scratch("cut")
        deck = deck_with(PUNCH, PUNCH_RULES, directory)
        done = runs.start([PUNCH.with_suffix(".geo"), "--output", directory / "punch.h5", "--subdomains", "8"], 0,
                          program="harmos-mesh")
        self.assertEqual(done.returncode, 0, done)
        sets = {"Solver/Tolerance": 1e-8}
        plain = runs.solved(self, PUNCH, sets, program="harmos").summary
        cut = runs.solved(self, deck, {**sets, "Model/Mesh file": directory / "punch.h5", "Bodies/block/Subdomains": 1,
                                       "Bodies/block/Groups": "{}"}, program="harmos").summary
        self.assertLessEqual(abs(cut["energy"] / plain["energy"] - 1.0), 10 * 1e-8)


class Looks(unittest.TestCase):
    def look(self, source, rules, ranks=2):
        """parts.vtkhdf of a deck whose effects do not name the rules' parts yet."""
        directory = runs.scratch("look")
        deck = deck_with(source, rules, directory, rename=False)
        done = runs.start([deck, "--parts", "--output", directory], ranks, program="harmos")
        self.assertEqual(done.returncode, 0, done)
        return directory, done.stdout

    def plot(self, *words):
        return subprocess.run([runs.application("harmos-plot"), *map(str, words)], capture_output=True, text=True, timeout=120)

    def test_file(self):
        directory, printed = self.look(PUNCH, PUNCH_RULES)
        self.assertRegex(printed, r"block/over: \d+ sides, area 1, flat with normal \(0, 0, 1\), from \(0, 0, 0.8\) to \(1, 1, 0.8\)")
        parts = run_results.read_with(directory / "parts.vtkhdf", plot_parts.parse_parts)
        # Rules before what the mesh has.
        self.assertEqual(parts.names[:4], [f"block: {name}" for name, *_ in PUNCH_RULES])
        corners = parts.xyz[parts.pieces]
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        area += np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 0]), axis=1) / 2
        for number, expected in ((0, 1.0), (1, 1.0), (2, 0.8), (3, 0.8), (-1, 1.6)):
            self.assertAlmostEqual(area[parts.part == number].sum(), expected, places=12)
        self.assertTrue((corners[parts.part == 2, :, 0] == 0.0).all())
        # The file does not depend on the number of ranks.
        other, _ = self.look(PUNCH, PUNCH_RULES, ranks=1)
        other = run_results.read_with(other / "parts.vtkhdf", plot_parts.parse_parts)
        for name in ("xyz", "pieces", "part"):
            np.testing.assert_array_equal(getattr(other, name), getattr(parts, name))

    def test_vtk_takes_it(self):
        try:
            from vtkmodules.vtkIOHDF import vtkHDFReader
        except ImportError as error:
            raise unittest.SkipTest(f"the Python module {error.name} is missing") from error
        directory, _ = self.look(BLOCKS, BLOCKS_RULES)
        reader = vtkHDFReader()
        reader.SetFileName(str(directory / "parts.vtkhdf"))
        reader.Update()
        grid = reader.GetOutputDataObject(0)
        self.assertEqual(grid.GetNumberOfCells(), 2 * (16 + 8) + 2 * (14 + 7))
        array = grid.GetCellData().GetArray("lower: bed")
        self.assertEqual(sum(array.GetValue(k) > 0 for k in range(grid.GetNumberOfCells())), 16)

    def test_pictures(self):
        for source, rules in ((BLOCKS, BLOCKS_RULES), (PUNCH, PUNCH_RULES)):
            with self.subTest(source.name):
                directory, _ = self.look(source, rules)
                done = self.plot(directory, "--parts", "--dpi", 60)
                self.assertEqual(done.returncode, 0, done.stderr)
                picture = (255 * imread(directory / "parts.png")[..., :3]).round().astype(int)
                # The first two colours are seen: in space shaded, but of their hue.
                for colour in plot_parts.COLOURS[:2]:
                    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
                    share = picture / np.maximum(picture.max(axis=2, keepdims=True), 1)
                    wanted = np.array([red, green, blue]) / max(red, green, blue)
                    near = (np.abs(share - wanted).max(axis=2) < 0.06) & (picture.max(axis=2) > 100)
                    self.assertGreater(near.sum(), 200, colour)

    def test_nothing_to_draw(self):
        directory = runs.scratch("empty")
        directory.mkdir()
        done = self.plot(directory, "--parts")
        self.assertEqual(done.returncode, 2)
        self.assertIn("harmos DECK --parts --output DIR", done.stderr)


class Faults(unittest.TestCase):
    def test_bad_rules(self):
        cases = (
            ({"Normal": "{0, 1}"}, '"Boundary parts/it/Normal" has 2 numbers'),
            ({"Normal": "{0, 0, 0}"}, '"Boundary parts/it/Normal" is a zero vector'),
            ({"Plane point": "{0, 0, 0}"}, 'is given without "Plane normal"'),
            ({"Angle": "20"}, 'is given without "Normal"'),
            ({"Cylinder axis": "{0, 0, 1}"}, 'is given without "Cylinder point"'),
            ({"Cylinder radius": "2"}, 'is given without "Cylinder point"'),
            ({"Box from": "{1, 1, 1}", "Box to": "{0, 2, 2}"}, 'lies beyond "Box to"'),
            ({"Bodies": "{lowr}", "Normal": "{0, 1, 0}"}, 'did you mean "lower"?'),
            ({"Of": "{tpo}"}, 'did you mean "top"?'),
            ({"Box from": "{5, 5, 5}"}, 'selects no side of any body: of 90 on its boundary 0 are in the box'),
            ({"Of": "{top}", "Normal": "{1, 0, 0}"}, "of 30 of its parts 0 are of that normal"),
        )
        for conditions, said in cases:
            with self.subTest(said):
                deck = deck_with(BLOCKS, [("it", "", conditions, "")], runs.scratch("fault"))
                for words in (["--check"], ["--parts"]):
                    done = runs.start([deck, *words], 2, program="harmos")
                    self.assertEqual(done.returncode, 2, done)
                    self.assertEqual(len(done.errors), 1, done)
                    self.assertIn(said, done.stderr)

    def test_names_that_are_taken(self):
        deck = deck_with(BLOCKS, [("top", "", {"Normal": "{0, 1, 0}"}, "")], runs.scratch("fault"))
        done = runs.start([deck, "--check"], 2, program="harmos")
        self.assertEqual(done.returncode, 2, done)
        self.assertIn('body "lower" has a part of this name in its mesh', done.stderr)


if __name__ == "__main__":
    runs.main()
