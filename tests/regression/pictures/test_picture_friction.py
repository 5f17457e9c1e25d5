# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of friction, from files and points written here; no program is run.

What each class guards against:

    Points  a point that two bodies share drawn twice, axes that look at a surface from its side
    Maps    points too small or too large for the zones that they stand for
    Steps   steps with scales of their own, a step in which nothing rubs that ends all
"""

import json
import sys
import unittest
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "apps" / "tools"))

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np

    import plot_friction
    import synthetic_composite
    from matplotlib import colors
    import matplotlib.pyplot as plt
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")


def rubbing(xyz, state=None, body=None, traction=0.0, slip=0.0, dimension=3):
    """What a result tells of points that rub: force and slip along x."""
    along = np.eye(3)[[0] * len(xyz)]
    return SimpleNamespace(
        xyz=xyz, extent=float(np.ptp(xyz, axis=0).max()), dimension=dimension,
        friction=np.ones(len(xyz), dtype=int) if state is None else state, active=np.ones(len(xyz), dtype=int),
        body_of_point=np.zeros(len(xyz), dtype=int) if body is None else body,
        traction=along * np.reshape(traction, (-1, 1)), slip=along * np.reshape(slip, (-1, 1)),
    )


def raster(n, axis, size=1.0):
    """n × n points of a square across an axis."""
    xyz = np.zeros((n, n, 3))
    first, second = (k for k in range(3) if k != axis)
    xyz[..., first], xyz[..., second] = np.meshgrid(*[np.linspace(0, size, n)] * 2)
    return xyz.reshape(-1, 3)


class Points(unittest.TestCase):
    def test_surfaces_are_seen_from_their_front(self):
        for axis, order in ((0, [1, 2]), (1, [0, 2]), (2, [0, 1])):
            xyz = raster(4, axis)
            xyz[:, axis] += 0.01 * xyz[:, order[0]] ** 2
            look = plot_friction.look_of([rubbing(xyz)])
            self.assertEqual((look.order, look.line), (order, False))

    def test_a_line_in_the_plane(self):
        xyz = np.zeros((5, 3))
        xyz[:, 1] = np.arange(5)
        look = plot_friction.look_of([rubbing(xyz, dimension=2)])
        self.assertEqual((look.order, look.line), ([1, 0], True))

    def test_points_of_two_bodies_count_once(self):
        xyz = raster(3, 2)
        both = np.concatenate([xyz, xyz[:4]])
        body = np.repeat([0, 1], [9, 4])
        # Of points that both have the body with more of them is shown.
        points = plot_friction.points_of(rubbing(both, body=body, traction=np.where(body == 0, 1.0, -1.0)))
        self.assertEqual(len(points.flat), 9)
        self.assertEqual(points.traction[:, 0].tolist(), [1.0] * 9)
        # Nor do those count that bear nothing.
        state = np.where(np.arange(9) < 2, 0, 2)
        self.assertEqual(len(plot_friction.points_of(rubbing(xyz, state)).flat), 7)


class Lines(unittest.TestCase):
    """Curves along an interface that is open in its middle."""

    def test_open_points_part_the_curves(self):
        xyz = np.zeros((9, 3))
        xyz[:, 0] = np.arange(9)
        state = np.array([1, 1, 2, 0, 0, 2, 1, 1, 0])
        solid = rubbing(xyz, state, traction=1.0 + xyz[:, 0], slip=xyz[:, 0], dimension=2)
        points = plot_friction.points_of(solid)
        self.assertEqual([points.flat[run, 0].tolist() for run in plot_friction.runs_of(points)], [[0, 1, 2], [5, 6, 7]])
        self.assertEqual(
            plot_friction.zones(points), [(0, 1.5, False), (1.5, 2.5, True), (4.5, 5.5, True), (5.5, 7.5, False)]
        )
        figure = plot_friction.plot_friction(solid, "", [])
        drawn = [line.get_xdata().tolist() for line in figure.axes[0].lines]
        self.assertEqual(drawn, [[0, 1, 2], [5, 6, 7]])
        plt.close(figure)
        # Points of the other body that lie at the same places are not open ones.
        solid.active = np.where(state == 0, 0, 1)
        self.assertEqual(len(plot_friction.runs_of(plot_friction.points_of(solid))), 1)


class Maps(unittest.TestCase):
    def test_points_are_as_wide_as_they_are_apart(self):
        for n, size in ((12, 1.0), (12, 1e-3), (40, 1.0)):
            with self.subTest(n=n, size=size):
                xyz = raster(n, 2, size)
                state = np.where(xyz[:, 0] > 0.5 * size, plot_friction.SLIPPING, 1)
                figure = plot_friction.plot_friction(rubbing(xyz, state, slip=xyz[:, 0]), "", [])
                axes = figure.axes[0]
                figure.canvas.draw()
                across = axes.transData.transform([[0.0, 0.0], [size / (n - 1), 0.0]])
                apart = (across[1, 0] - across[0, 0]) / figure.dpi * 72
                drawn = axes.collections[0]
                wide = float(np.sqrt(drawn.get_sizes()[0]))
                # The picture has some room for labels, no more: a tenth.
                self.assertAlmostEqual(wide / min(16.0, apart), 1.0, delta=0.1)
                sticking = np.array(colors.to_rgb(plot_friction.STICKS))
                shown = np.abs(drawn.get_facecolors()[:, :3] - sticking).max(axis=1) < 1e-9
                self.assertEqual(shown.tolist(), (state == 1).tolist())
                plt.close(figure)

    def test_a_point_alone(self):
        for dimension in (2, 3):
            plt.close(plot_friction.plot_friction(rubbing(np.zeros((1, 3)), dimension=dimension), "", []))


class Steps(unittest.TestCase):
    def test_one_look(self):
        xyz = raster(6, 2)
        few = np.where(np.hypot(*(xyz[:, :2] - 0.5).T) < 0.3, 1, 0)
        look = plot_friction.look_of([
            rubbing(xyz, few, traction=1.0, slip=3.0),
            rubbing(xyz, np.zeros(36, dtype=int)),
            SimpleNamespace(friction=None),
            rubbing(xyz, traction=2.0, slip=0.5),
        ])
        self.assertEqual((look.traction, look.slip), (2.0, 3.0))
        self.assertEqual((look.low.tolist(), look.high.tolist()), ([0.0, 0.0], [1.0, 1.0]))
        self.assertIsNone(plot_friction.look_of([rubbing(xyz, np.zeros(36, dtype=int))]))

    def test_frames_of_the_steps_that_rub(self):
        """Results of steps in which all is open have no friction; the last one here."""
        directory = runs.scratch("friction")
        square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        parts = [(0, square, np.arange(4)[None])]
        bottom = np.array([1, 1, 0, 0], dtype=np.uint8)
        data = {
            "displacement": np.zeros((4, 3)), "contact_pressure": 1.0 * bottom, "gap": np.zeros(4),
            "active_set": 2 * bottom, "von_mises": np.ones(4),
        }
        synthetic_composite.write_run(directory, parts, data, energy=-1.0)
        (directory / "result.vtkhdf").unlink()
        files = []
        for k, share in enumerate((1.0, 2.0, 0.0), start=1):
            rubs = {
                "friction_traction": np.outer(share * bottom, [1.0, 0.0, 0.0]),
                "slip": np.outer(share * bottom, [-1.0, 0.0, 0.0]), "friction_state": 2 * bottom,
            }
            files.append({"name": f"result_{k:04d}.vtkhdf", "time": float(k)})
            synthetic_composite.write_vtkhdf(directory / files[-1]["name"], parts, {**data, **(rubs if share else {})})
        series = {"file-series-version": "1.0", "files": files}
        (directory / "result.vtkhdf.series").write_text(json.dumps(series), encoding="utf-8")
        (directory / "friction_0007.png").write_bytes(b"of an earlier run")
        drawn = runs.execute([sys.executable, runs.application("harmos-plot"), directory, "--frames", "--dpi", "50"])
        self.assertEqual((drawn[0], drawn[2]), (0, ""))
        pictures = sorted(path.name for path in directory.glob("friction*.png"))
        self.assertEqual(pictures, ["friction_0001.png", "friction_0002.png"])
        # The second has twice the slip on the same scale: they differ.
        first, second = ((directory / name).read_bytes() for name in pictures)
        self.assertNotEqual(first, second)


if __name__ == "__main__":
    runs.main()
