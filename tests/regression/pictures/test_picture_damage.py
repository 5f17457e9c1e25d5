# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of interfaces that break, from files and points written here; no program is run.

What each class guards against:

    Sides   sides in the colour of another node, or of a copy in another subdomain; what is broken like what is not
    Points  points that two bodies share counted twice, a surface in space seen from its side
    Steps   steps with colours or scales of their own, pictures that an earlier run left
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

    import plot_damage
    import plot_frames
    import run_results
    import synthetic_composite
    from matplotlib import colors
    import matplotlib.pyplot as plt
    from matplotlib.image import imread
    from PIL import Image
    from plot_style import STYLE
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

RADIUS = 0.3


def damage_at(angle, share=1.0):
    """Intact on the left of a fibre, within 8 degrees, broken on its right within 65 degrees for all of the load.

    Nodes lie at multiples of 15 degrees: whether one is intact or broken is no matter of a cosine's rounding.
    """
    return np.clip(share * (0.99 + np.cos(angle)) / 1.41, 0.0, 1.0)


def composite(share=1.0, hidden=False, **more):
    """Parts and data of two fibres side by side. hidden: all copies of nodes but the last are silent."""
    parts, centres = synthetic_composite.composite(2, 1, radius=RADIUS, side=6)
    xy = np.concatenate([points for _, points, _ in parts])
    body = np.repeat([b for b, _, _ in parts], [len(points) for _, points, _ in parts])
    relative = xy - centres[np.floor(xy[:, 0] - 1e-9).clip(0, 1).astype(int)]
    on = np.abs(np.hypot(*relative.T) - RADIUS) < 1e-9
    damage = np.where(on, damage_at(np.arctan2(*relative.T[::-1]), share), 0.0)
    if hidden:
        # A node on the line between two blocks of a body is told by the last of its copies alone.
        _, last = np.unique(np.column_stack([body, np.round(xy, 9)])[::-1], axis=0, return_index=True)
        damage[~np.isin(np.arange(len(xy)), len(xy) - 1 - last)] = 0.0
    data = {
        "displacement": np.where(body[:, None] > 0, [0.02 * share, 0.0, 0.0], 0.0),
        "active_set": on.astype(np.uint8), "damage": damage, **more,
    }
    return parts, data, centres


def solid_of(*arguments, **named):
    parts, data, centres = composite(*arguments, **named)
    directory = runs.scratch("glued")
    synthetic_composite.write_run(directory, parts, data)
    return run_results.read_result(directory / "result.vtkhdf"), centres


class Sides(unittest.TestCase):
    def angles(self, solid, nodes, centres):
        relative = solid.xy[nodes] - centres[(solid.xy[nodes, 0] > 1).astype(int)]
        np.testing.assert_allclose(np.hypot(*relative.T), RADIUS, rtol=1e-12)
        return np.arctan2(*relative.T[::-1])

    def test_each_node_has_its_halves(self):
        for hidden in (False, True):
            solid, centres = solid_of(hidden=hidden)
            halves, damage = plot_damage.halves_of(solid)
            # Two sides of two circles of 24 edges, each in two halves.
            self.assertEqual(len(halves), 2 * 2 * 24 * 2)
            np.testing.assert_allclose(damage, damage_at(self.angles(solid, halves[:, 0], centres)), atol=1e-12)

    def test_what_is_drawn(self):
        solid, centres = solid_of()
        figure = plot_damage.plot_damage(solid, "", [])
        sides = next(drawn for drawn in figure.axes[0].collections if drawn.get_array() is not None)
        figure.canvas.draw()
        segments, shown = np.array(sides.get_segments()), sides.get_colors()
        halves, damage = plot_damage.halves_of(solid)
        # From its node, where that has moved to, half way.
        scale = plot_damage.look_of([solid]).scale
        moved = solid.xy + scale * solid.displacement[:, :2]
        np.testing.assert_allclose(segments[:, 0], moved[halves[:, 0]], atol=1e-12)
        np.testing.assert_allclose(segments[:, 1], moved[halves].mean(axis=1), atol=1e-12)
        broken = colors.to_rgba(plot_damage.BROKEN)
        self.assertEqual((np.abs(shown - broken).max(axis=1) < 1e-9).tolist(), (damage == 1).tolist())
        self.assertIn(True, (damage == 1).tolist())
        order = np.argsort(damage[damage < 1], kind="stable")
        # The map goes from light to dark.
        light = shown[damage < 1][order, :3].sum(axis=1)
        self.assertGreater(light[0], light[-1] + 1)
        # 24 points a fibre: of the angles k/24 of a turn all but that on the left are damaged, 9 within 65 degrees.
        words = [text.get_text() for text in figure.legends[0].get_texts()]
        self.assertIn("of 48 points 46 are damaged, 18 broken", words)
        plt.close(figure)

    def test_nearly_broken(self):
        """As near to 1 as a number can be, and still held."""
        solid, _ = solid_of()
        solid.damage = np.where(solid.damage == 1.0, np.nextafter(1.0, 0.0), solid.damage)
        figure = plot_damage.plot_damage(solid, "", [])
        sides = next(drawn for drawn in figure.axes[0].collections if drawn.get_array() is not None)
        figure.canvas.draw()
        apart = np.abs(sides.get_colors() - colors.to_rgba(plot_damage.BROKEN)).max(axis=1)
        self.assertGreater(apart.min(), 1e-3)
        words = [text.get_text() for text in figure.legends[0].get_texts()]
        self.assertIn("of 48 points 46 are damaged, 0 broken", words)
        plt.close(figure)

    def test_contact_that_is_not_glued(self):
        """The second fibre lies in the matrix with friction alone: its points are not bonded ones."""
        parts, data, centres = composite()
        xy = np.concatenate([points for _, points, _ in parts])
        data["bound"] = np.where(xy[:, 0] < 1.0, data["active_set"], 0).astype(np.uint8)
        data["damage"] = np.where(data["bound"] > 0, data["damage"], 0.0)
        directory = runs.scratch("half")
        synthetic_composite.write_run(directory, parts, data)
        solid = run_results.read_result(directory / "result.vtkhdf")
        figure = plot_damage.plot_damage(solid, "", [])
        words = [text.get_text() for text in figure.legends[0].get_texts()]
        self.assertIn("of 24 points 23 are damaged, 9 broken", words)
        halves, _ = plot_damage.halves_of(solid)
        self.assertEqual(len(halves), 2 * 24 * 2)
        self.assertLess(solid.xy[halves[:, 0], 0].max(), 1.0)
        plt.close(figure)

    def test_no_adhesion(self):
        parts, data, _ = composite()
        directory = runs.scratch("plain")
        synthetic_composite.write_run(directory, parts, {k: v for k, v in data.items() if k != "damage"})
        solid = run_results.read_result(directory / "result.vtkhdf")
        self.assertFalse(plot_damage.may_break(solid))
        self.assertIsNone(plot_damage.look_of([solid]))


class Points(unittest.TestCase):
    def test_a_surface_in_space(self):
        for axis, order in ((0, [1, 2]), (1, [0, 2]), (2, [0, 1])):
            with self.subTest(axis=axis):
                xyz = np.zeros((8, 6, 3))
                xyz[..., order[0]], xyz[..., order[1]] = np.meshgrid(np.arange(8), np.arange(6), indexing="ij")
                xyz = np.concatenate([xyz.reshape(-1, 3)] * 2)  # of two bodies, and the second does not tell
                damage = np.concatenate([np.linspace(0, 1, 48), np.zeros(48)])
                solid = SimpleNamespace(
                    dimension=3, xyz=xyz, extent=7.0, damage=damage, bound=np.ones(96, dtype=bool)
                )
                figure = plot_damage.plot_damage(solid, "", [])
                drawn = figure.axes[0].collections[0]
                expected = xyz[:48][:, order]
                got = np.asarray(drawn.get_offsets())
                rows = np.lexsort(got.T[::-1])
                np.testing.assert_array_equal(got[rows], expected)
                np.testing.assert_array_equal(np.asarray(drawn.get_array())[rows], damage[:48])
                words = [text.get_text() for text in figure.legends[0].get_texts()]
                self.assertIn("of 48 points 47 are damaged, 1 broken", words)
                plt.close(figure)


class Steps(unittest.TestCase):
    def run_of(self, shares, bonded=True):
        directory = runs.scratch("breaking")
        parts, data, _ = composite()
        synthetic_composite.write_run(directory, parts, data, energy=-1.0)
        (directory / "result.vtkhdf").unlink()
        files = []
        for k, share in enumerate(shares, start=1):
            _, data, _ = composite(share)
            files.append({"name": f"result_{k:04d}.vtkhdf", "time": float(k)})
            if not bonded:
                del data["damage"]
            synthetic_composite.write_vtkhdf(directory / files[-1]["name"], parts, data)
        series = {"file-series-version": "1.0", "files": files}
        (directory / "result.vtkhdf.series").write_text(json.dumps(series), encoding="utf-8")
        return directory

    def drawn(self, directory):
        words = [sys.executable, runs.application("harmos-plot"), directory, "--frames", "--dpi", "40"]
        status, _, errors = runs.execute(words)
        self.assertEqual((status, errors), (0, ""))
        return sorted(path.name for path in directory.glob("damage*"))

    def test_of_every_step(self):
        directory = self.run_of([0.0, 0.5, 1.0])
        (directory / "damage_0007.png").write_bytes(b"of an earlier run")
        frames = [f"damage_000{k}.png" for k in (1, 2, 3)]
        self.assertEqual(self.drawn(directory), ["damage.gif", "damage.png", *frames])
        with Image.open(directory / "damage.gif") as animation:
            self.assertEqual(animation.n_frames, 3)
        # On the scale of the last one, which moves most.
        shown = plot_frames.frames_of(directory)
        results = [run_results.read_result(frame.path) for frame in shown]
        summary = run_results.read_summary(directory / "summary.json")
        look = plot_damage.look_of(results)
        self.assertEqual(look.scale, plot_damage.look_of(results[2:]).scale)
        for frame, result, name in zip(shown, results, frames):
            with plt.rc_context(STYLE):
                caption = plot_frames.caption_at(summary, frame)
                figure = plot_damage.plot_damage(result, "", caption, look, text=frame.text)
                figure.savefig(directory / "alone.png", dpi=40)
                plt.close(figure)
            np.testing.assert_array_equal(imread(directory / "alone.png"), imread(directory / name))

    def test_a_run_without_adhesion(self):
        directory = self.run_of([0.5, 1.0], bonded=False)
        for name in ("damage.gif", "damage_0001.png"):
            (directory / name).write_bytes(b"of an earlier run")
        self.assertEqual(self.drawn(directory), [])


if __name__ == "__main__":
    runs.main()
