# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of elastic bodies in the plane and of membranes, from result files written here; no program is run.

What each class guards against:

    Reading   cells or copies of nodes taken for others than they are
    Numbers   pictures of something else than the contact pressure, the gaps and the outlines
    Pictures  scripts that fail, or that draw nothing
    Following an end that is none, half a row, a contact zone seen from its edge
"""

import json
import math
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "verification" / "oracles"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "docs" / "tools"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "apps" / "tools"))

import harmos_runs as runs  # noqa: E402

try:
    import elastic_oracle
    import follow_run
    import h5py  # noqa: F401
    import numpy as np
    import plot_deformed
    import matplotlib.pyplot as plt
    import plot_hertz
    import plot_run
    import run_results
    import synthetic_composite
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

TOOLS = runs.SOURCE / "docs" / "tools"
RADIUS, SIDE = 0.3, 6
AROUND = 4 * SIDE  # contact nodes of a fibre
OPEN, CLOSED = 1, 2


def pressure_of(angle):
    """Closed where the matrix is pressed along x."""
    return np.maximum(0.0, np.cos(2 * angle))


_runs = {}


def composite(sign=1):
    """The directory of a composite of 2 x 1 cells with a contact pressure that is known."""
    if sign not in _runs:
        parts, centres = synthetic_composite.composite(2, 1, RADIUS, SIDE, 3, 4)
        points = np.concatenate([p for _, p, _ in parts])
        body = np.concatenate([np.full(len(p), b) for b, p, _ in parts])
        away = points[:, None, :] - centres
        nearest = np.linalg.norm(away, axis=2).argmin(axis=1)
        away = away[np.arange(len(points)), nearest]
        touching = np.abs(np.linalg.norm(away, axis=1) - RADIUS) < 1e-12
        angle = np.arctan2(away[:, 1], away[:, 0]) + (0 if sign > 0 else np.pi / 2)
        # The second fibre bears twice as much.
        pressure = np.where(touching, (1 + nearest) * pressure_of(angle), 0.0)
        pressure[pressure < 1e-12] = 0.0
        active = np.where(touching, np.where(pressure > 0, CLOSED, OPEN), 0)
        gap = np.where(active == OPEN, 0.01 * -np.cos(2 * angle), 0.0)
        displacement = np.zeros((len(points), 3))
        displacement[:, 0] = 0.01 * sign * points[:, 0]
        matrix = body == 0
        displacement[matrix, :2] += (gap[:, None] * away / RADIUS)[matrix]
        data = {
            "displacement": displacement,
            "von_mises": 1.0 + points[:, 0],
            "stress": np.zeros((len(points), 6)),
            "contact_pressure": pressure,
            "gap": gap,
            "active_set": active.astype(np.uint8),
        }
        directory = runs.scratch("composite")
        synthetic_composite.write_run(directory, parts, data, energy=1.5)
        _runs[sign] = directory, parts, centres
    return _runs[sign]


def write_cells(kind, shifts, scalar=False):
    """A run of reference cells beside each other, each a subdomain of one body."""
    nodes = np.array(elastic_oracle.NODES[kind], dtype=float)
    shifts = [np.eye(nodes.shape[1])[0] * s for s in shifts]
    parts = [(0, nodes + s, np.arange(len(nodes))[None]) for s in shifts]
    points = np.concatenate([p for _, p, _ in parts])
    u = np.zeros(len(points)) if scalar else np.zeros((len(points), 3))
    u[...] = 0.1 * points[:, 0].reshape(-1, *[1] * (u.ndim - 1))
    directory = runs.scratch("cells")
    synthetic_composite.write_run(directory, parts, {"displacement": u}, kind=kind)
    return directory


def hertz_run(results):
    """Three squares in a row, each a subdomain; pressure 2 - x on their lower sides."""
    square = np.array(elastic_oracle.NODES[9], dtype=float)
    square = (square - square.min(axis=0)) / np.ptp(square, axis=0)
    parts = [(0, square + [s, 0.0], np.arange(4)[None]) for s in range(3)]
    points = np.concatenate([p for _, p, _ in parts])
    touching = points[:, 1] == 0.0
    pressure = np.where(touching, np.maximum(0.0, 2.0 - points[:, 0]), 0.0)
    data = {
        "displacement": np.zeros((len(points), 3)),
        "contact_pressure": pressure,
        "active_set": np.where(touching, np.where(pressure > 0, CLOSED, OPEN), 0).astype(np.uint8),
        "gap": np.zeros(len(points)),
    }
    directory = runs.scratch("hertz")
    synthetic_composite.write_run(directory, parts, data)
    path = directory / "summary.json"
    summary = json.loads(path.read_text(encoding="utf-8"))
    summary.update(results=results, primal_dimension=24)
    path.write_text(json.dumps(summary), encoding="utf-8")
    return directory


HERTZ = {
    "half_width": 1.96,
    "half_width_theory": 2.0,
    "peak_pressure": 4.0,
    "peak_pressure_theory": 4.0,
    "load": 1.0,
}


def read(directory):
    return run_results.read_result(directory / "result.vtkhdf")


def areas(points, cells):
    """Of flat triangles and quadrilaterals; a triangle repeats its last corner."""
    first, second = (points[cells[:, k + 2]] - points[cells[:, k]] for k in (0, 1))
    return np.linalg.norm(np.cross(first, second), axis=1) / 2


class Reading(unittest.TestCase):
    def test_pieces_cover_each_type_of_cell(self):
        # Area of a cell in the plane, of its faces in space.
        slanted = 1.5 + math.sqrt(3) / 2
        plane = {5: 0.5, 9: 1.0, 22: 0.5, 28: 1.0}
        space = {10: slanted, 12: 6.0, 24: slanted, 29: 6.0}
        for kind, size in {**plane, **space}.items():
            with self.subTest(kind=kind):
                solid = read(write_cells(kind, [0.0]))
                self.assertIsInstance(solid, run_results.Solid)
                found = areas(solid.xyz, solid.cells)
                self.assertAlmostEqual(found.sum(), size, places=12)
                self.assertGreater(found.min(), 0.0)

    def test_faces_between_subdomains_are_not_outer(self):
        for kind in (12, 29):
            solid = read(write_cells(kind, [0.0, 1.0]))
            self.assertAlmostEqual(areas(solid.xyz, solid.cells).sum(), 10, places=12)

    def test_faces_between_tetrahedra_are_not_outer(self):
        """Both cells list the corners of their common face from another one on."""
        for kind in (10, 24):
            nodes = np.array(elastic_oracle.NODES[kind], dtype=float)
            mirrored = nodes * [1, 1, -1]
            for turned in (nodes, nodes[:, [1, 2, 0]], nodes[:, [2, 0, 1]], nodes[:, [1, 0, 2]]):
                with self.subTest(kind=kind):
                    parts = [(0, x, np.arange(len(x))[None]) for x in (turned, mirrored)]
                    directory = runs.scratch("cells")
                    u = np.zeros((2 * len(nodes), 3))
                    synthetic_composite.write_run(directory, parts, {"displacement": u}, kind=kind)
                    solid = read(directory)
                    # Two slanted faces, four sides of the two; their common face is none.
                    common = (turned[:, 2] == 0).sum() == (nodes[:, 2] == 0).sum()
                    self.assertTrue(common)
                    self.assertAlmostEqual(
                        areas(solid.xyz, solid.cells).sum(), 2 * (1.0 + math.sqrt(3) / 2), places=12
                    )

    def test_copies_of_a_node_have_one_place(self):
        directory, _, _ = composite()
        solid = read(directory)
        mesh = elastic_oracle.read_mesh(directory / "result.vtkhdf")
        self.assertEqual(len(np.unique(solid.place)), len(mesh.nodes))
        # One number for one number, both ways.
        pairs = np.unique(np.column_stack([solid.place, mesh.node_of_point]), axis=0)
        self.assertEqual(len(pairs), len(mesh.nodes))

    def test_scalar_displacement_is_a_membrane(self):
        field = read(write_cells(9, [0.0, 1.0], scalar=True))
        self.assertIsInstance(field, run_results.Field)
        self.assertEqual(field.displacement.tolist(), (0.1 * field.xy[:, 0]).tolist())
        self.assertEqual(field.cells.tolist(), [[0, 1, 2, 3], [4, 5, 6, 7]])

    def test_membranes_alone_are_refused_for_vectors(self):
        with self.assertRaisesRegex(run_results.PlotError, "3 components"):
            run_results.read_field(composite()[0] / "result.vtkhdf")


class Numbers(unittest.TestCase):
    def test_polar(self):
        directory, _, centres = composite()
        solid = read(directory)
        for body in (1, 2):
            polar = plot_deformed.contact_polar(solid, body)
            np.testing.assert_allclose(polar.centre, centres[body - 1], rtol=0, atol=1e-12)
            self.assertAlmostEqual(polar.radius, RADIUS, places=12)
            # Each node once, though subdomains meet at some of them.
            expected = 2 * np.pi * np.arange(AROUND) / AROUND
            np.testing.assert_allclose(polar.angle, expected, rtol=0, atol=1e-12)
            np.testing.assert_allclose(
                polar.pressure, body * pressure_of(expected), rtol=0, atol=1e-11
            )
            gap = 0.01 * np.maximum(0.0, -np.cos(2 * expected))
            np.testing.assert_allclose(polar.gap, gap, rtol=0, atol=1e-12)
            np.testing.assert_array_equal(polar.closed, polar.pressure > 0)

    def test_arcs(self):
        polar = plot_deformed.contact_polar(read(composite()[0]), 1)
        arcs = polar.arcs()
        self.assertEqual([closed for _, _, closed in arcs], [False, True, False, True])
        # Nodes every 15 degrees: those at 45 degrees have no pressure and are open.
        degrees = [(math.degrees(a), math.degrees(b)) for a, b, _ in arcs]
        expected = [(37.5, 142.5), (142.5, 217.5), (217.5, 322.5), (322.5, 397.5)]
        np.testing.assert_allclose(degrees, expected, rtol=0, atol=1e-9)
        polar.closed[:] = True
        self.assertEqual(polar.arcs(), [(0.0, 2 * math.pi, True)])

    def test_outline(self):
        solid = read(composite()[0])
        edges = plot_deformed.outline(solid)
        length = np.linalg.norm(np.diff(solid.xy[edges], axis=1)[:, 0], axis=1).sum()
        # Two squares side by side, and each circle twice: fibre and matrix.
        polygon = AROUND * 2 * RADIUS * math.sin(math.pi / AROUND)
        self.assertAlmostEqual(length, 6 + 4 * polygon, places=12)

    def test_contact_halves(self):
        solid = read(composite()[0])
        halves, closed = plot_deformed.contact_halves(solid, plot_deformed.outline(solid))
        self.assertEqual(len(halves), 2 * 4 * AROUND)
        self.assertEqual(closed.sum(), 2 * 4 * 10)  # of 24 nodes 10 are closed
        np.testing.assert_array_equal(closed, solid.active[halves[:, 0]] == CLOSED)

    def test_scale(self):
        # The largest displacement is 0.01 times the width.
        self.assertEqual(plot_deformed.automatic_scale([read(composite()[0])]), 20)
        # 0.1 times as long as the cell: twice as large makes a fifth.
        far = read(write_cells(12, [0.0]))
        far.displacement[:] = [0.1, 0, 0]
        self.assertEqual(plot_deformed.automatic_scale([far]), 2)
        far.displacement[:] = [10, 0, 0]
        self.assertEqual(plot_deformed.automatic_scale([far]), 1)
        far.displacement[:] = 0
        self.assertEqual(plot_deformed.automatic_scale([far]), 1)

    def test_bodies_are_not_drawn_through_each_other(self):
        """A square comes down on another one, over a gap of a hundredth: enlarged, it would be seen in the other."""
        square = np.array(elastic_oracle.NODES[9], dtype=float)
        square = (square - square.min(axis=0)) / np.ptp(square, axis=0)
        for gap, scale in ((0.0, 20), (0.01, 1), (0.001, 5)):
            with self.subTest(gap=gap):
                parts = [(0, square, np.arange(4)[None]), (1, square + [0.0, 1.0 + gap], np.arange(4)[None])]
                points = np.concatenate([p for _, p, _ in parts])
                upper = np.repeat([False, True], 4)
                touching = np.abs(points[:, 1] - 1.0) < 0.1
                displacement = np.zeros((8, 3))
                displacement[:, 0] = 0.019 * upper  # along each other it may be as large as it likes
                displacement[:, 1] = -gap * upper
                data = {
                    "displacement": displacement, "active_set": np.where(touching, CLOSED, 0).astype(np.uint8),
                    "contact_pressure": 1.0 * touching, "gap": np.zeros(8),
                }
                directory = runs.scratch("stack")
                synthetic_composite.write_run(directory, parts, data)
                solid = read(directory)
                self.assertAlmostEqual(plot_deformed.closing(solid), gap, delta=1e-12)
                self.assertEqual(plot_deformed.automatic_scale([solid]), scale)

    def test_many_outer_iterations_are_no_wall(self):
        for outer, marked in ((20, True), (500, False)):
            count = 2 * outer
            table = {
                "hessian_applications": np.arange(count), "projected_gradient": np.geomspace(1.0, 1e-6, count),
                "equality_residual": np.zeros(count), "outer": np.repeat(np.arange(outer), 2),
                "active": np.zeros(count), "step": np.array(["cg"] * count),
            }
            figure = plot_run.plot_convergence(table, {}, "", [])
            words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
            self.assertEqual("new outer iteration" in words, marked)
            self.assertEqual("500 outer iterations, not marked" in words, not marked)
            upright = [line for line in figure.axes[0].lines if len(set(line.get_xdata())) == 1]
            self.assertEqual(len(upright), outer - 1 if marked else 0)
            plt.close(figure)

    def test_hertz_profile(self):
        """A node once, whatever its copies; lengths and pressures in those of theory."""
        r, p, dimension, _ = plot_hertz.profile(hertz_run(HERTZ))
        order = np.argsort(r)
        np.testing.assert_allclose(r[order], np.arange(4) / 2.0, atol=1e-14)
        np.testing.assert_allclose(p[order], np.array([2.0, 1.0, 0.0, 0.0]) / 4.0, atol=1e-14)
        self.assertEqual(dimension, 2)


class Pictures(unittest.TestCase):
    def script(self, name, *words):
        path = TOOLS / name if name.endswith(".py") else runs.application(name)
        return subprocess.run(
            [sys.executable, path, *words], capture_output=True, text=True, timeout=120
        )

    def assert_drawn(self, result, *paths):
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        for path in paths:
            data = path.read_bytes()
            self.assertTrue(data.startswith(b"\x89PNG\r\n\x1a\n"), path)
            # An empty pair of axes has less.
            self.assertGreater(len(data), 20_000, path)

    def test_harmos_plot_of_bodies_and_of_membranes(self):
        for name, directory in (
            ("plane", composite()[0]),
            ("without stresses", write_cells(28, np.arange(3.0))),
            ("membranes", write_cells(9, np.arange(3.0), scalar=True)),
        ):
            with self.subTest(name):
                target = runs.scratch("pictures")
                result = self.script("harmos-plot", directory, "--output", target)
                self.assert_drawn(result, target / "solution.png", target / "convergence.png")

    def test_deformed(self):
        first, second = composite()[0], composite(-1)[0]
        for words in ([first], [first, second], [first, "--scale", "3", "--title", "Fibres"]):
            target = runs.scratch("picture").with_suffix(".png")
            result = self.script("draw_composite.py", *words, "--output", target)
            self.assert_drawn(result, target)
        result = self.script("draw_composite.py", second)
        self.assert_drawn(result, second / "deformed.png")

    def test_polar(self):
        first, second = composite()[0], composite(-1)[0]
        result = self.script("draw_composite.py", first, second, "--polar", "2")
        self.assert_drawn(result, first / "polar.png")

    def test_pictures_are_the_same_every_time(self):
        made = []
        for _ in range(2):
            target = runs.scratch("picture").with_suffix(".png")
            self.assert_drawn(
                self.script("draw_composite.py", composite()[0], "--output", target), target
            )
            made.append(target.read_bytes())
        self.assertEqual(*made)

    def test_hertz(self):
        one, other = hertz_run(HERTZ), hertz_run(HERTZ)
        self.assert_drawn(self.script("plot_hertz.py", one), one / "pressure.png")
        target = runs.scratch("picture").with_suffix(".png")
        self.assert_drawn(self.script("plot_hertz.py", one, other, "--output", target), target)
        for directory, message in (
            (runs.scratch("nowhere"), "no such directory"),
            (hertz_run({}), "no Hertz problem"),
            (hertz_run({**HERTZ, "half_width_theory": 0.0}), "does not touch"),
        ):
            with self.subTest(message):
                result = self.script("plot_hertz.py", directory)
                self.assertEqual(result.returncode, 2)
                self.assertRegex(result.stderr, message)
                self.assertNotIn("Traceback", result.stderr)

    def test_what_cannot_be_drawn_is_said(self):
        first = composite()[0]
        membranes = write_cells(9, [0.0], scalar=True)
        space = write_cells(12, [0.0])
        for words, message in (
            ([runs.scratch("nowhere")], "no such directory"),
            ([membranes], "harmos-plot"),
            ([first, space], "separately"),
            ([first, "--polar", "7"], r"bodies in contact are \[0, 1, 2\]"),
            ([space, "--polar", "0"], "in the plane only"),
            ([first, first, first], "one or two"),
            ([first, "--scale", "0"], "not positive"),
        ):
            with self.subTest(message):
                result = self.script("draw_composite.py", *words)
                self.assertEqual(result.returncode, 2)
                self.assertRegex(result.stderr, message)
                self.assertNotIn("Traceback", result.stderr)



class Following(unittest.TestCase):
    """Runs that go on: what counts as their end, and contact zones from contact.csv."""

    def test_end(self):
        place = runs.scratch("follow")
        place.mkdir()
        summary = place / "summary.json"
        self.assertFalse(follow_run.has_ended(summary))
        for text, ended in (
            ("", False),
            ('{"reason": "interrupted: stop requested"}', False),
            ('{"reason": "converged"}', True),
            ('{"reason": "iteration limit: ..."}', True),
        ):
            summary.write_text(text, encoding="utf-8")
            self.assertEqual(follow_run.has_ended(summary), ended, text)

    def test_growing_file(self):
        place = runs.scratch("follow")
        place.mkdir()
        path = place / "iterations.csv"
        self.assertIsNone(run_results.read_iterations(path, growing=True))
        header = (
            "outer,inner,step,projected_gradient,equality_residual,penalty,M,active,"
            "hessian_applications,seconds\n"
        )
        row = "1,0,start,0.5,0.1,0,0,3,1,0.2\n"
        for text, rows in ((header, None), (header + row[:9], None), (header + row + row[:9], 1)):
            path.write_text(text, encoding="utf-8")
            table = run_results.read_iterations(path, growing=True)
            self.assertEqual(None if table is None else len(table["step"]), rows, text)

    def test_principal_axes(self):
        """A line is a line however it lies, and so is a surface."""
        along = np.array([1.0, 2.0, -2.0]) / 3.0
        across = np.array([2.0, 1.0, 2.0]) / 3.0
        s, t = np.meshgrid(np.linspace(0, 5, 11), np.linspace(0, 2, 5))
        line = np.outer(s[0], along)
        _, extents = follow_run.principal(line)
        # Rounding errors of a singular value decomposition of numbers below 5.
        np.testing.assert_allclose(extents, [5, 0, 0], atol=1e-14)
        surface = np.outer(s.ravel(), along) + np.outer(t.ravel(), across)
        _, extents = follow_run.principal(surface)
        np.testing.assert_allclose(extents, [5, 2, 0], atol=1e-14)


if __name__ == "__main__":
    runs.main()
