# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of how bodies are cut, from result files written here; no program is run.

What each class guards against:

    Colours   neighbours that cannot be told from each other
    Shapes    subdomains with holes, in other places, without the lines where they are cut
    Programs  no picture, no sentence where there is nothing to draw
"""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "apps" / "tools"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py  # noqa: F401
    import numpy as np
    import vtkmodules  # noqa: F401

    import plot_subdomains
    import run_results
    import synthetic_composite
    import synthetic_solids as bodies
    from matplotlib.colors import to_rgb
    from matplotlib.image import imread
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

QUAD = 9
KINDS = (bodies.TETRA, bodies.HEXAHEDRON, bodies.TETRA_10)


def squares(count):
    """A square of count x count subdomains of 4 x 4 cells."""
    lattice = np.stack(np.meshgrid(*[np.arange(5)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    first = (5 * np.arange(4)[:, None] + np.arange(4)).ravel()
    cells = first[:, None] + [0, 5, 6, 1]
    return [(0, (lattice / 4 + place) / count, cells) for place in np.ndindex(count, count)]


def result_of(parts, kind, scalar=False):
    directory = runs.scratch("cut")
    points = bodies.all_points(parts)
    u = np.zeros(len(points)) if scalar else np.zeros((len(points), 3))
    synthetic_composite.write_run(directory, parts, {"displacement": u}, kind=kind)
    return directory


def read(directory):
    return run_results.read_result(directory / "result.vtkhdf")


def colours_of(result):
    return plot_subdomains.coloured(result.xyz, result.part_of_point, result.parts)


def area(points, cells):
    first, second = (points[cells[:, k + 2]] - points[cells[:, k]] for k in (0, 1))
    return np.linalg.norm(np.cross(first, second), axis=1).sum() / 2


class Colours(unittest.TestCase):
    def test_neighbours_differ(self):
        for name, parts, kind, side in (
            ("plane", squares(9), QUAD, 9),
            ("space", bodies.block(bodies.HEXAHEDRON, 1, 4), bodies.HEXAHEDRON, 4),
            ("tetrahedra", bodies.block(bodies.TETRA, 1, 3), bodies.TETRA, 3),
        ):
            with self.subTest(name):
                result = read(result_of(parts, kind))
                colours = colours_of(result)
                places = np.array(list(np.ndindex(*[side] * result.dimension)))
                for p, place in enumerate(places):
                    # In the plane those that share a corner too; in space there are 26 of these.
                    steps = np.abs(places - place)
                    beside = steps.max(axis=1) == 1 if name == "plane" else steps.sum(axis=1) == 1
                    self.assertNotIn(colours[p], colours[beside])
                # All are of use.
                self.assertLess(np.ptp(np.bincount(colours)), 0.5 * len(places) ** 0.5 + len(places) / 4)

    def test_more_neighbours_than_colours(self):
        """All share a node; those that share more differ."""
        count = 2 * len(plot_subdomains.COLOURS)
        part = np.repeat(np.arange(count), 3)
        place = np.column_stack([np.zeros(count), np.arange(count) + 1, np.arange(count) + 2])
        colours = plot_subdomains.colour_numbers(place.astype(int).ravel(), part, count)
        self.assertTrue((np.diff(colours) != 0).all())
        np.testing.assert_array_equal(np.bincount(colours), np.full(count // 2, 2))

    def test_of_one(self):
        self.assertEqual(colours_of(read(result_of(squares(1), QUAD))).tolist(), [0])


class Shapes(unittest.TestCase):
    def test_each_is_closed_and_moved_as_a_whole(self):
        for kind in KINDS:
            with self.subTest(kind=kind):
                solid = read(result_of(bodies.block(kind, 2, 3), kind))
                torn = plot_subdomains.surfaces(solid)
                self.assertAlmostEqual(area(torn.xyz, torn.cells), 27 * 6 / 9, places=12)
                points = plot_subdomains.moved_apart(torn, 0.5)
                away = points - torn.xyz
                for part in range(solid.parts):
                    own = away[solid.part_of_point == part]
                    np.testing.assert_allclose(own, own[:1].repeat(len(own), axis=0), atol=1e-14)
                # Those in the corners by half of what their middles are from the body's.
                self.assertAlmostEqual(away.max(), 0.5 / 3, places=12)
                self.assertAlmostEqual(away.min(), -0.5 / 3, places=12)

    def test_lines(self):
        """Around the three outer sides of each cube of eight, and between them; not inside of sides."""
        for kind in KINDS:
            with self.subTest(kind=kind):
                solid = read(result_of(bodies.block(kind, 2, 2), kind))
                torn = plot_subdomains.surfaces(solid)
                middle = torn.xyz[torn.cells].mean(axis=1)
                outside = ((np.abs(middle) < 1e-9) | (np.abs(middle - 1) < 1e-9)).any(axis=1)
                found = plot_subdomains.on_the_outside(solid, torn)
                np.testing.assert_array_equal(found, outside)
                pairs, _ = plot_subdomains.lines_of(solid, torn, torn.xyz, np.full(3, 3**-0.5))
                length = np.linalg.norm(np.diff(torn.xyz[pairs], axis=1), axis=2).sum()
                self.assertAlmostEqual(length, 8 * (6 + 3) * 0.5, places=12)


class Programs(unittest.TestCase):
    def plot(self, *words):
        return subprocess.run(
            [sys.executable, runs.application("harmos-plot"), *words],
            capture_output=True, text=True, timeout=120,
        )

    def test_drawn(self):
        for name, directory, count in (
            ("plane", result_of(squares(4), QUAD), 16),
            ("membranes", result_of(squares(4), QUAD, scalar=True), 16),
            ("space", result_of(bodies.block(bodies.TETRA, 3, 2), bodies.TETRA), 8),
        ):
            with self.subTest(name):
                drawn = self.plot(directory, "--subdomains", "--dpi", "70")
                self.assertEqual((drawn.returncode, drawn.stderr), (0, ""), drawn)
                self.assertEqual(drawn.stdout, f"{directory / 'subdomains.png'}\n")
                image = imread(directory / "subdomains.png")[..., :3]
                seen = 0
                for name_of_colour in plot_subdomains.COLOURS:
                    # Shades of a colour have its proportions; what is grey may be a line.
                    colour = np.array(to_rgb(name_of_colour))
                    bright = image.max(axis=2, keepdims=True)
                    same = np.abs(image / np.where(bright > 0.3, bright, 1) - colour / colour.max()).max(axis=2)
                    seen += ((same < 0.03) & (np.ptp(image, axis=2) > 0.02)).mean() > 0.01
                # Of the cubes one is hidden, and one may be grey.
                self.assertGreaterEqual(seen, min(count, len(plot_subdomains.COLOURS)) - 2)

    def test_refused(self):
        empty = runs.scratch("empty")
        empty.mkdir()
        for words, message in (
            ((empty, "--subdomains"), r'result.vtkhdf: not there; let the run write its fields \("Output/Fields"\)'),
            ((runs.scratch("none"), "--subdomains"), "no such directory"),
            ((empty, "--subdomains", "--follow"), "--follow and --subdomains exclude each other"),
            ((empty, "--subdomains", "--frames"), "--frames and --subdomains exclude each other"),
        ):
            with self.subTest(message):
                refused = self.plot(*words)
                self.assertEqual((refused.returncode, refused.stdout), (2, ""))
                self.assertRegex(refused.stderr, message)
                self.assertNotIn("Traceback", refused.stderr)


if __name__ == "__main__":
    runs.main()
