# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of bodies in space, from result files written here; no program is run.

What each class guards against:

    Surfaces  holes, sides between subdomains, what is hidden in front of what hides it
    Colours   a peak stress that takes the whole scale
    Cuts      planes that miss the contact or show one body; values of one body in the other
    Contact   a contact surface with the pressure, the gap or the zone of another one
    Programs  no picture, no sentence where VTK is missing, VTK asked for where it is not needed
"""

import json
import os
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "apps" / "tools"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py  # noqa: F401
    import numpy as np
    import vtkmodules  # noqa: F401

    import plot_solid
    import run_results
    import solid_parts
    import synthetic_composite
    import synthetic_solids as bodies
    import vtk_scene
    from matplotlib.image import imread
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

KINDS = (
    bodies.TETRA, bodies.HEXAHEDRON, bodies.WEDGE, bodies.TETRA_10, bodies.HEXAHEDRON_20, bodies.WEDGE_15,
)
MAGENTA = (1.0, 0.0, 1.0)
RIGHT, UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])  # seen from the front, -y


def result_of(parts, data, kind):
    directory = runs.scratch("solid")
    synthetic_composite.write_run(directory, parts, data, kind=kind)
    return directory


def read(directory):
    return run_results.read_result(directory / "result.vtkhdf")


def still(parts):
    return {"displacement": np.zeros_like(bodies.all_points(parts))}


def solid_of(parts, kind, **data):
    return solid_parts.joined(read(result_of(parts, {**still(parts), **data}, kind)))


def stack_of(kind, **more):
    parts, data = bodies.stack(kind, **more)
    return solid_parts.joined(read(result_of(parts, data, kind)))


def length(points, pairs):
    return np.linalg.norm(points[pairs[:, 1]] - points[pairs[:, 0]], axis=1).sum()


def area(points, triangles):
    first, second = (points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))
    return np.linalg.norm(np.cross(first, second), axis=1).sum() / 2


def image_of(actors, window, depth, size=(200, 200)):
    view = vtk_scene.View(RIGHT, UP, np.array(window, dtype=float))
    return vtk_scene.picture(actors, view, size, depth, MAGENTA).astype(int)


class Surfaces(unittest.TestCase):
    def surface(self, solid, values=None):
        values = np.ones(len(solid.xyz)) if values is None else values
        norm = plot_solid.Normalize(0.0, 1.0)
        return vtk_scene.surface(solid.xyz, solid.cells, values, plot_solid.GAP_MAP, norm)

    def test_a_ball_has_no_hole(self):
        for kind in KINDS:
            with self.subTest(kind=kind):
                solid = solid_of(bodies.ball(kind, 3, 2), kind)
                # White in front and dark blue behind.
                image = image_of(
                    [self.surface(solid, (solid.xyz[:, 1] > 0.1).astype(float))],
                    [[-1.2, 1.2]] * 2, (-1, 1), (240, 240),
                )
                y, x = np.mgrid[0:240, 0:240]
                away = np.hypot(x - 119.5, y - 119.5) / 100
                drawn = (image != [255, 0, 255]).any(axis=2)
                # Twelve edges or more around: their middles are 4 % nearer.
                self.assertTrue(drawn[away < 0.95].all())
                self.assertFalse(drawn[away > 1.02].any())
                self.assertGreater(image[away < 0.9, 0].min(), 110)

    def test_outer_faces_close_the_body_once(self):
        for kind in KINDS:
            with self.subTest(kind=kind):
                solid = solid_of(bodies.block(kind, 2, 3), kind)
                triangles = vtk_scene.triangles_of(solid.cells)
                self.assertAlmostEqual(area(solid.xyz, triangles), 6.0, places=12)
                # Outward: the flux of x through the surface is three times the volume.
                a, b, c = (solid.xyz[triangles[:, k]] for k in range(3))
                self.assertAlmostEqual(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6, 1.0, places=12)

    def test_edges(self):
        """Those of the cube are drawn, those of its subdomains and inside of its faces are not."""
        for kind, mesh in ((bodies.HEXAHEDRON, 6 * (2 * 5)), (bodies.TETRA_10, 6 * (2 * 5 + 6 * 2**0.5))):
            with self.subTest(kind=kind):
                solid = solid_of(bodies.block(kind, 2, 3), kind)
                edges = solid_parts.edges(solid, solid.xyz, np.array([0.3, -0.5, 0.8]))
                self.assertAlmostEqual(length(solid.xyz, edges.sharp), 12.0, places=12)
                self.assertAlmostEqual(length(solid.xyz, edges.mesh), mesh, places=12)

    def test_silhouette_of_a_ball(self):
        solid = solid_of(bodies.ball(bodies.HEXAHEDRON, 6, 2), bodies.HEXAHEDRON)
        edges = solid_parts.edges(solid, solid.xyz, np.array([0.0, 0.0, 1.0]))
        # The equator, without corners on the way: edges zigzag between two rows of faces at most.
        self.assertTrue(2 * np.pi * 0.95 < length(solid.xyz, edges.sharp) < 2 * np.pi * 1.5)
        self.assertLess(np.abs(solid.xyz[edges.sharp][..., 2]).max(), 0.3)

    def test_what_is_hidden_is_hidden(self):
        parts = bodies.block(bodies.HEXAHEDRON, 1, 1, 0) + bodies.block(
            bodies.HEXAHEDRON, 1, 1, 1, origin=(0.25, 2.0, 0.25), size=0.5
        )
        solid = solid_of(parts, bodies.HEXAHEDRON)
        values = (solid.body_of_point == 1).astype(float)
        marks = np.array([[0.1, 1.5, 0.5], [0.9, 1.5, 0.5], [0.1, -0.5, 0.3], [0.9, -0.5, 0.3]])
        lines = [vtk_scene.lines(marks, np.array([pair]), (1, 0, 0), 4) for pair in ((0, 1), (2, 3))]
        image = image_of([self.surface(solid, values), *lines], [[-0.5, 1.5]] * 2, (-2.5, 0.5))
        # The far body is dark, the near one white, the line behind it does not show, the one before it does.
        self.assertGreater(image[100, 100].min(), 200)
        self.assertTrue((image[60:105, 60:140].min(axis=2) > 200).all())
        self.assertTrue((image[119:122, 100] == [255, 0, 0]).all(axis=1).any())

    def test_colours_are_the_same_every_time(self):
        solid = solid_of(bodies.ball(bodies.TETRA, 2, 2), bodies.TETRA)
        first, second = (
            image_of([self.surface(solid, solid.xyz[:, 0])], [[-1.2, 1.2]] * 2, (-1, 1)) for _ in range(2)
        )
        np.testing.assert_array_equal(first, second)


class Colours(unittest.TestCase):
    def test_top(self):
        values = np.arange(100.0)
        even = np.ones(100)
        # 0.8 of the peak or more: nothing is cut off.
        self.assertEqual(solid_parts.top_colour(values, even, 0.95), 99.0)
        self.assertEqual(solid_parts.top_colour(values, even, 0.5), 49.0)
        # By weight, not by number; what has none is not drawn.
        self.assertEqual(solid_parts.top_colour(values, np.where(values < 10, 100.0, 1.0), 0.9), 9.0)
        self.assertEqual(solid_parts.top_colour(values, np.where(values < 50, 1.0, 0.0), 1.0), 49.0)
        self.assertEqual(solid_parts.top_colour(values, np.zeros(100)), 99.0)

    def test_areas_of_nodes(self):
        solid = solid_of(bodies.block(bodies.HEXAHEDRON, 1, 2), bodies.HEXAHEDRON)
        shares = solid_parts.node_areas(solid.xyz, solid.cells)
        self.assertAlmostEqual(shares.sum(), 6.0, places=12)
        corner = np.unique(solid.cells[np.isin(solid.cells, np.flatnonzero((solid.xyz == 0).all(axis=1)))])
        self.assertAlmostEqual(shares[corner[0]], 3 / 16, places=12)

    def test_what_is_not_seen_takes_no_colours(self):
        """A cube of high stresses inside of another one."""
        inner = bodies.block(bodies.TETRA, 2, 1, body=1, origin=(0.25, 0.25, 0.25), size=0.5)
        parts = bodies.block(bodies.TETRA, 2, 2) + inner
        body = np.concatenate([np.full(len(points), b) for b, points, _ in parts])
        solid = solid_of(parts, bodies.TETRA, von_mises=np.where(body == 1, 50.0, bodies.all_points(parts)[:, 0]))
        look = plot_solid.look_of([solid])
        self.assertTrue(0.95 <= look.colours.vmax <= 1.0, look.colours.vmax)

    def test_a_peak_does_not_take_the_scale(self):
        parts = bodies.block(bodies.HEXAHEDRON, 4, 2)
        x = bodies.all_points(parts)
        stress = np.where((x == 1.0).all(axis=1), 100.0, x[:, 0])
        look = plot_solid.look_of([solid_of(parts, bodies.HEXAHEDRON, von_mises=stress)])
        self.assertEqual(look.colours.vmin, 0.0)
        # The stress is 1 on the right side, beside the corner; between nodes more than that is drawn.
        self.assertTrue(0.99 <= look.colours.vmax <= 1.0, look.colours.vmax)
        self.assertIsNone(look.plane)


class Cuts(unittest.TestCase):
    def plane(self, **more):
        solid = stack_of(bodies.HEXAHEDRON, **more)
        peak = solid_parts.peak_of(solid)
        return solid, peak, solid_parts.cutting_plane(solid, peak)

    def test_the_plane_goes_through_the_peak(self):
        solid, peak, plane = self.plane(peak=(1 / 3, 0.5))
        np.testing.assert_allclose(peak.place, [1 / 3, 0.5, 1.0], atol=1e-12)
        self.assertEqual((peak.body, *peak.normal), (1, 0.0, 0.0, -1.0))
        np.testing.assert_allclose(plane.normal, [0, 1, 0], atol=1e-12)
        # Aside by less than can be seen, so as to hit no nodes.
        self.assertTrue(0 < plane.origin[1] - 0.5 < 1e-6)

    def test_a_plane_of_symmetry_is_left(self):
        for place in (0.0, 1.0):
            _, _, plane = self.plane(peak=(place, place))
            self.assertTrue(abs(abs(plane.origin[1] - place) - 0.01) < 1e-6)

    def test_a_strip_is_cut_across(self):
        solid, peak, _ = self.plane()
        peak.extent[:] = [0.9, 0.1, 0.0]
        np.testing.assert_allclose(solid_parts.cutting_plane(solid, peak).normal, [1, 0, 0], atol=1e-12)
        peak.extent[:] = [0.1, 0.9, 0.0]
        np.testing.assert_allclose(solid_parts.cutting_plane(solid, peak).normal, [0, 1, 0], atol=1e-12)
        # Contact on a slanted side: the plane contains the normal.
        peak.normal = np.array([0.6, 0.0, 0.8])
        plane = solid_parts.cutting_plane(solid, peak)
        self.assertAlmostEqual(plane.normal @ peak.normal, 0.0, places=12)

    def test_no_contact_no_plane(self):
        self.assertIsNone(solid_parts.peak_of(solid_of(bodies.block(bodies.TETRA, 1, 1), bodies.TETRA)))

    def test_both_bodies_are_cut_and_keep_their_values(self):
        for kind in KINDS:
            for place in (0.4217, 0.5 + 1e-7):  # within cells, and along sides of subdomains
                with self.subTest(kind=kind, place=place):
                    solid = stack_of(kind)
                    values = 10.0 * solid.body_of_point + solid.xyz[:, 0]
                    plane = solid_parts.Plane(np.array([0.0, place, 0.0]), np.array([0.0, 1.0, 0.0]))
                    part = solid_parts.section(solid, values, plane)
                    self.assertAlmostEqual(area(part.points, part.triangles), 2.0, places=9)
                    upper = part.values >= 5
                    np.testing.assert_allclose(part.values - 10 * upper, part.points[:, 0], atol=1e-9)
                    self.assertTrue((part.points[upper, 2] > 1 - 1e-9).all())
                    self.assertTrue((part.points[~upper, 2] < 1 + 1e-9).all())
                    # Two squares; no sides between cells or subdomains.
                    self.assertAlmostEqual(length(part.points, part.outline), 8.0, places=6)
                    touching = part.outline[part.touching]
                    self.assertAlmostEqual(length(part.points, touching), 1.0, places=6)
                    self.assertTrue((np.abs(part.points[touching][..., 2] - 1) < 1e-9).all())
                    self.assertTrue(upper[touching].all())
                    closed = length(part.points, part.outline[part.closed])
                    self.assertTrue(0.4 < closed < 0.8, closed)

    def test_a_cut_beside_the_bodies_is_empty(self):
        plane = solid_parts.Plane(np.array([0.0, 7.0, 0.0]), np.array([0.0, 1.0, 0.0]))
        solid = stack_of(bodies.TETRA)
        part = solid_parts.section(solid, solid.pressure, plane)
        self.assertEqual((len(part.points), len(part.triangles), len(part.closed)), (0, 0, 0))

    def test_axes_of_pictures(self):
        for normal, right, up in (((0, 1, 0), (1, 0, 0), (0, 0, 1)), ((0, 0, -1), (1, 0, 0), (0, 1, 0)),
                                  ((1, 0, 0), (0, 1, 0), (0, 0, 1))):
            found = solid_parts.picture_axes(np.array(normal, dtype=float))
            np.testing.assert_allclose(found, (right, up), atol=1e-12)

    def test_windows(self):
        whole = np.array([[0.0, 0.0], [10.0, 4.0]])
        for zone in ([[4.0, 2.0], [5.0, 2.0]], [[0.0, 0.0], [0.2, 0.1]], [[9.0, 1.0], [10.0, 4.0]], None):
            zone = None if zone is None else np.array(zone)
            window = plot_solid.window_about(zone, whole, (3.0, 2.0))
            self.assertAlmostEqual(np.ptp(window[0]) / np.ptp(window[1]), 1.5)
            shown = whole if zone is None else zone
            self.assertTrue((window[:, 0] <= shown[0]).all() and (window[:, 1] >= shown[1]).all())
            if zone is not None:
                self.assertLess(np.ptp(window[0]), 11)


class Contact(unittest.TestCase):
    def test_patch(self):
        for kind in KINDS:
            with self.subTest(kind=kind):
                solid = stack_of(kind, peak=(0.5, 0.5), radius=0.4)
                piece = solid_parts.patch(solid, 1, np.array([0.0, 0.0, -1.0]))
                both = [vtk_scene.triangles_of(cells) for cells in (piece.closed, piece.open)]
                self.assertAlmostEqual(area(piece.points, np.concatenate(both)), 1.0, places=12)
                self.assertTrue((np.abs(piece.points[:, 2] - 1) < 1e-12).all())
                closed = area(piece.points, both[0])
                self.assertTrue(0.3 < closed < 0.7, closed)
                # Around the zone, along straight pieces of a grid: the circle's length and somewhat more.
                around = length(piece.points, piece.boundary)
                self.assertTrue(0.8 * np.pi < around < 0.8 * np.pi * 1.6, around)
                self.assertAlmostEqual(piece.pressure.max(), 0.4, places=12)
                self.assertEqual(piece.gap[piece.closed[:, 0]].max(), 0.0)

    def test_what_does_not_face_the_viewer_is_left_out(self):
        solid = stack_of(bodies.TETRA)
        self.assertEqual(len(solid_parts.patch(solid, 1, np.array([0.0, 0.0, 1.0])).points), 0)
        self.assertEqual(len(solid_parts.patch(solid, 0, np.array([0.0, 0.0, 1.0])).points), 0)

    def test_looks_of_several_steps(self):
        """The scale, the colours and the places are those of the greatest load."""
        steps = [stack_of(bodies.HEXAHEDRON, load=load) for load in (0.5, 2.0, 1.0)]
        together, alone = plot_solid.look_of(steps), plot_solid.look_of(steps[1:2])
        self.assertEqual(together.scale, alone.scale)
        for name in ("colours", "cut_colours", "pressures"):
            self.assertEqual(getattr(together, name).vmax, getattr(alone, name).vmax)
        np.testing.assert_allclose(together.plane.origin, alone.plane.origin)
        np.testing.assert_allclose(together.contact_window, alone.contact_window)


class Programs(unittest.TestCase):
    def plot(self, *words, hidden=None):
        place = runs.scratch("hidden")
        place.mkdir()
        if hidden:
            (place / f"{hidden}.py").write_text("raise ImportError('hidden by a test')\n")
        return subprocess.run(
            [sys.executable, runs.application("harmos-plot"), *words],
            capture_output=True, text=True, timeout=120,
            env={**os.environ, "PYTHONPATH": str(place), "DISPLAY": ""},
        )

    def test_drawn(self):
        for kind in KINDS:
            parts, data = bodies.stack(kind)
            for fields in (data, {"displacement": data["displacement"]}):
                with self.subTest(kind=kind, fields=len(fields)):
                    directory = result_of(parts, fields, kind)
                    drawn = self.plot(directory, "--dpi", "60")
                    self.assertEqual((drawn.returncode, drawn.stderr), (0, ""), drawn)
                    image = imread(directory / "solution.png")
                    # Three panels where there is contact.
                    wide = image.shape[1] / image.shape[0]
                    self.assertTrue(wide > 1.8 if "gap" in fields else wide < 1.5, wide)
                    # Neither white nor black, as what VTK could not draw.
                    panel = image[image.shape[0] // 5 : -image.shape[0] // 5, image.shape[1] // 8 : image.shape[1] // 3]
                    self.assertGreater(np.std(panel[..., :3]), 0.05)
                    self.assertGreater((np.ptp(panel[..., :3], axis=2) > 0.1).mean(), 0.2)

    def test_frames(self):
        directory = result_of(*bodies.stack(bodies.TETRA), bodies.TETRA)
        (directory / "result.vtkhdf").unlink()
        files = []
        for k, load in enumerate((0.5, 1.0), start=1):
            files.append({"name": f"result_{k:04d}.vtkhdf", "time": load})
            parts, data = bodies.stack(bodies.TETRA, load=load)
            synthetic_composite.write_vtkhdf(directory / files[-1]["name"], parts, data, bodies.TETRA)
        (directory / "result.vtkhdf.series").write_text(json.dumps({"files": files}), encoding="utf-8")
        drawn = self.plot(directory, "--frames", "--dpi", "50")
        self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
        first, second = (imread(directory / f"frame_{k:04d}.png") for k in (1, 2))
        self.assertEqual(first.shape, second.shape)
        # Half the load, half the colours: darker.
        left = slice(0, first.shape[1] // 3)
        self.assertLess(first[:, left, :3].sum(), second[:, left, :3].sum())
        self.assertTrue((directory / "steps.gif").is_file())

    def test_without_vtk(self):
        space = result_of(*bodies.stack(bodies.TETRA), bodies.TETRA)
        refused = self.plot(space, hidden="vtkmodules")
        self.assertEqual((refused.returncode, refused.stdout), (2, ""))
        self.assertRegex(
            refused.stderr,
            r"^harmos-plot: bodies in space are drawn by VTK, but \S+ cannot import vtkmodules \(hidden by a test\): "
            r"install Debian's package python3-vtk9 for /usr/bin/python3, or use an interpreter .*\n$",
        )
        square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        parts = [(0, square, np.arange(4)[None])]
        for shape in ((4, 3), 4):
            directory = result_of(parts, {"displacement": np.full(shape, 0.1)}, 9)
            drawn = self.plot(directory, hidden="vtkmodules")
            self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))

    def test_without_a_renderer(self):
        with mock.patch("ctypes.CDLL", side_effect=OSError("libEGL.so.1: no such file")):
            self.assertIn("no such file", vtk_scene.make_context())
        if vtk_scene.knows_x_alone():
            with mock.patch.object(vtk_scene, "make_context", return_value="no EGL"):
                with self.assertRaisesRegex(run_results.PlotError, r"off screen \(no EGL\): .*libegl1"):
                    vtk_scene.render_window.__wrapped__()


if __name__ == "__main__":
    runs.main()
