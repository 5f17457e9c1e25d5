# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of the program shape, from files written here; no program is run.

What each class guards against:

    Reading  files that another program wrote, or half of one taken for a whole
    Curves   columns drawn for others, points out of order, a mean without its areas
    Maps     surfaces in space drawn as curves, or seen from their side, with a scale each
    Edges    motions drawn larger than told, a gap drawn where nodes have moved
    Tool     a run that goes on, options that exclude each other, sentences for what is not there
"""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "apps" / "tools"))

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np

    import plot_shape
    from command_line import PlotError
    import matplotlib.pyplot as plt
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

HISTORY = (
    "iteration,evaluations,cost,gradient_norm,constraint,step,refused,seconds\n"
    "0,1,4,0.5,,0,0,0.1\n"
    "1,2,3,0.25,,0.1,0,0.2\n"
    "2,5,2.5,0,,0.1,2,0.3\n"
)
SHAPE = (
    "surface,node,x_before,y_before,z_before,x_after,y_after,z_after,gap_before,gap_after,pressure_before,pressure_after,"
    "area\n"
)
SUMMARY = {
    "converged": True, "reason": "converged", "primal_dimension": 42,
    "results": {
        "peak_pressure_before": 4.0, "peak_pressure": 3.0, "mean_pressure": 2.5, "evaluations": 5, "gradient_norm": 0.0,
        "cost": 2.5, "cost_before": 4.0,
    },
}


def rows(name, before, after=None, gap=(0.0, 0.1), pressure=(4.0, 3.0), area=1.0):
    """Lines of shape.csv. gap, pressure: before and after, a number or one a point."""
    after = before if after is None else after
    count = len(before)
    values = [np.broadcast_to(value, count) for value in (*gap, *pressure, area)]
    lines = []
    for k in range(count):
        cells = [*before[k], *after[k], *(value[k] for value in values)]
        lines.append(",".join([name, str(7 * k), *(repr(float(cell)) for cell in cells)]))
    return "\n".join(lines) + "\n"


def straight(n, axis=0, at=0.0):
    points = np.zeros((n, 3))
    points[:, axis] = at + np.linspace(0, 2, n)
    return points


def written(shape=None, history=HISTORY, summary=SUMMARY):
    """The directory of a run; without a shape one that goes on."""
    directory = runs.scratch("shape")
    directory.mkdir()
    (directory / "history.csv").write_text(history, encoding="utf-8")
    if shape is not None:
        (directory / "shape.csv").write_text(SHAPE + shape, encoding="utf-8")
        (directory / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    return directory


def figure_of(directory):
    history = plot_shape.read_history(directory / "history.csv")
    path = directory / "shape.csv"
    return plot_shape.plot_shape(history, plot_shape.read_shape(path) if path.exists() else [], "", [])


def axes_of(figure, label):
    """Those whose ordinate has this label."""
    return next(axes for axes in figure.axes if axes.get_ylabel() == label)


def curves_of(axes):
    """Abscissas and ordinates of the lines with more than the two points of a level, in the order drawn."""
    return [np.array(line.get_data()) for line in axes.lines if len(line.get_xdata()) > 2]


def words_of(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


class Drawn(unittest.TestCase):
    def tearDown(self):
        plt.close("all")


class Reading(Drawn):
    def refused(self, words, shape=None, history=HISTORY):
        directory = written(shape, history)
        with self.assertRaises(PlotError) as caught:
            figure_of(directory)
        self.assertRegex(str(caught.exception), words)

    def test_history(self):
        # A row that is being written does not count.
        history = plot_shape.read_history(written(history=HISTORY + "3,6,2.25") / "history.csv")
        self.assertEqual(history["cost"].tolist(), [4.0, 3.0, 2.5])
        self.assertEqual(history["refused"].tolist(), [0, 0, 2])
        self.assertTrue(np.isnan(history["constraint"]).all())
        self.refused(r"history\.csv: no design in the file; wait for the first", history=HISTORY.splitlines()[0] + "\n")
        self.refused(r"history\.csv: no column cost, gradient_norm", history="iteration,evaluations,constraint,refused\n0,1,,0\n")
        self.refused(r"row 3 has 2 cells for 8 columns", history=HISTORY.replace("1,2,3,0.25,,0.1,0,0.2", "1,2"))
        self.refused(r"column cost: .*'high'", history=HISTORY.replace("2,5,2.5", "2,5,high"))

    def test_shape(self):
        points = straight(3)
        surfaces = plot_shape.read_shape(written(rows("a", points) + rows("b", points + 3, area=[1, 2, 3])) / "shape.csv")
        self.assertEqual([each.name for each in surfaces], ["a", "b"])
        np.testing.assert_array_equal(surfaces[1].before, points + 3)
        self.assertEqual(surfaces[1].areas.tolist(), [1, 2, 3])
        self.refused("no contact point in the file", "")
        self.refused("column gap_after has values that are not finite", rows("a", points, gap=(0.0, np.nan)))


class Curves(Drawn):
    def test_history(self):
        figure = figure_of(written())
        cost, gradient = axes_of(figure, "cost"), axes_of(figure, "norm of the gradient")
        self.assertEqual(curves_of(cost)[0].tolist(), [[0, 1, 2], [4, 3, 2.5]])
        # A norm of zero has no logarithm.
        np.testing.assert_array_equal(curves_of(gradient)[0], [[0, 1, 2], [0.5, 0.25, np.nan]])
        self.assertEqual((cost.get_yscale(), gradient.get_yscale()), ("linear", "log"))
        self.assertEqual(words_of(cost), ["cost", "after refused designs", "norm of the gradient"])
        marks = next(line for line in cost.lines if line.get_label() == "after refused designs")
        self.assertEqual(np.array(marks.get_data()).tolist(), [[2], [2.5]])
        self.assertEqual(len(figure.axes), 2)
        # A cost that falls by more than ten times, without its gradient; and a constraint.
        other = HISTORY.replace("2,5,2.5,0,,", "2,5,0.25,0,0.125,").replace("0.5,", "0,").replace("0.25,,", "0,0.5,")
        figure = figure_of(written(history=other))
        self.assertEqual(axes_of(figure, "cost").get_yscale(), "log")
        self.assertIn("violated constraint", words_of(axes_of(figure, "cost")))

    def test_pressures_and_gaps(self):
        # In the order of the abscissa, whatever that of the file is.
        for axis, name in ((0, "$x$"), (1, "$y$")):
            points, shuffled = straight(5, axis), [3, 0, 4, 1, 2]
            s = points[:, axis]
            gaps, pressures = (0 * s, s**2), (4 - s, 3 + 0 * s)
            chosen = [tuple(value[shuffled] for value in pair) for pair in (gaps, pressures)]
            area = np.array([1.0, 2, 2, 2, 1])
            figure = figure_of(written(rows("joint", points[shuffled], None, *chosen, area[shuffled])))
            axes = axes_of(figure, "contact pressure")
            self.assertEqual(axes.get_xlabel(), name)
            for drawn, values in zip(curves_of(axes), pressures):
                np.testing.assert_array_equal(drawn, [s, values])
            self.assertEqual(words_of(axes), ["before", "after", "mean 3"])
            below = axes_of(figure, "gap at rest")
            for drawn, values in zip(curves_of(below), gaps):
                np.testing.assert_array_equal(drawn, [s, values])
            self.assertEqual(len(curves_of(below)), 2)

    def test_the_mean_is_that_of_the_areas(self):
        points = straight(3)
        first = rows("a", points, pressure=(1.0, [8.0, 2.0, 2.0]), area=[1, 2, 1])
        second = rows("b", points + [3, 0, 0], pressure=(1.0, 0.0), area=2)
        figure = figure_of(written(first + second))
        axes = axes_of(figure, "contact pressure")
        # (8 + 4 + 2) / (4 + 6)
        level = next(line for line in axes.lines if len(line.get_xdata()) == 2)
        self.assertEqual((level.get_ydata()[0], level.get_linestyle()), (1.4, "--"))
        # Surfaces have a colour each.
        self.assertEqual(words_of(axes), ["a", "b", "before", "after", "mean 1.4"])
        lines = [line for line in axes.lines if len(line.get_xdata()) > 2]
        colours = [line.get_color() for line in lines]
        self.assertEqual((colours[0], colours[2]), (colours[1], colours[3]))
        self.assertNotEqual(colours[0], colours[2])

    def test_around_a_fibre(self):
        """A curve that turns back is drawn over its length, its points in their turn."""
        count = 40
        angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
        points = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        order = np.random.default_rng(1).permutation(count)
        pressure = 1 + np.cos(angle)
        figure = figure_of(written(rows("fibre", points[order], pressure=(pressure[order], 1.0))))
        axes = axes_of(figure, "contact pressure")
        self.assertEqual(axes.get_xlabel(), "length along the contact")
        s, drawn = curves_of(axes)[0]
        chord = 2 * np.sin(np.pi / count)
        np.testing.assert_allclose(s, chord * np.arange(count), rtol=1e-12)
        # From some point on, either way: neighbours stay neighbours.
        turned = min(
            np.abs(np.roll(way, shift) - drawn).max() for way in (pressure, pressure[::-1]) for shift in range(count)
        )
        self.assertLess(turned, 1e-12)


class Maps(Drawn):
    def surface(self, axis, n=6):
        points = np.zeros((n, n + 1, 3))
        first, second = (k for k in range(3) if k != axis)
        points[..., first], points[..., second] = np.meshgrid(np.arange(n), np.arange(n + 1), indexing="ij")
        return points.reshape(-1, 3)

    def test_of_surfaces(self):
        for axis, names in ((0, "yz"), (1, "xz"), (2, "xy")):
            for bend in (0.0, 0.02):
                with self.subTest(axis=axis, bend=bend):
                    points = self.surface(axis)
                    first, second = ("xyz".index(name) for name in names)
                    points[:, axis] += bend * points[:, first] ** 2
                    pressures = points[:, first], 2 + 0 * points[:, 0]
                    gaps = 0 * points[:, 0], points[:, second]
                    figure = figure_of(written(rows("pad", points, gap=gaps, pressure=pressures)))
                    maps = [axes for axes in figure.axes if axes.get_ylabel() == f"${names[1]}$"]
                    self.assertEqual([axes.get_xlabel() for axes in maps], 3 * [f"${names[0]}$"])
                    drawn = [axes.collections[0] for axes in maps]
                    for one, values in zip(drawn, (*pressures, gaps[1])):
                        np.testing.assert_array_equal(one.get_offsets(), points[:, [first, second]])
                        np.testing.assert_array_equal(one.get_array(), values)
                    # One scale for both pressures.
                    self.assertEqual(drawn[0].get_clim(), (0.0, 5.0))
                    self.assertEqual(drawn[1].get_clim(), (0.0, 5.0))
                    plt.close(figure)

    def test_a_curve_is_no_surface(self):
        x = np.linspace(0, 1, 9)
        curve = np.stack([x, x**2, 0 * x], axis=1)
        self.assertEqual(plot_shape.path_of(curve[::-1]).tolist(), list(range(9)))
        self.assertIsNone(plot_shape.path_of(self.surface(2)))
        # A line in space is one, wherever it is.
        surface = plot_shape.read_shape(written(rows("a", straight(4, 2))) / "shape.csv")[0]
        self.assertEqual(plot_shape.line_of(surface).tolist(), [0, 1, 2, 3])


class Edges(Drawn):
    def test_motion_is_enlarged_as_told(self):
        points = straight(5)
        points[:, 1] = 0.1 * points[:, 0] ** 2
        # Of an extent of 2 eight hundredths are 0.16: 200 times 0.0007, 50 times 0.003, 20 times 0.007; of 0.7 once.
        for largest, factor in ((0.0007, 200), (0.003, 50), (0.007, 20), (0.7, 1)):
            motion = largest * np.array([0, 1, 0]) * (points[:, :1] / 2) ** 2
            figure = figure_of(written(rows("edge", points, points + motion)))
            axes = axes_of(figure, "$y$")
            before, after = curves_of(axes)
            np.testing.assert_allclose(before, points[:, :2].T, atol=1e-15)
            np.testing.assert_allclose(after, (points + factor * motion)[:, :2].T, atol=1e-12)
            told = [text for text in words_of(axes) if "times" in text]
            self.assertEqual(told, [f"motion drawn {factor} times as large"] if factor > 1 else [])
            self.assertFalse([axes for axes in figure.axes if axes.get_ylabel() == "gap at rest"])

    def test_in_space_along_the_normal(self):
        points = Maps().surface(1)
        motion = np.zeros_like(points)
        motion[:, 1] = 0.01 * points[:, 0]
        figure = figure_of(written(rows("pad", points, points + motion)))
        titles = [axes.get_title() for axes in figure.axes]
        axes = figure.axes[titles.index("motion along $y$")]
        np.testing.assert_allclose(axes.collections[0].get_array(), motion[:, 1], atol=1e-14)


class Tool(Drawn):
    def plot(self, *words):
        return runs.execute([sys.executable, runs.application("harmos-plot"), *words, "--dpi", "50"])

    def test_a_run_that_has_ended_and_one_that_goes_on(self):
        ended, going = written(rows("joint", straight(5))), written()
        for directory in (ended, going):
            self.assertEqual(self.plot(directory, "--shape"), (0, f"{directory / 'shape.png'}\n", ""))
            self.assertTrue((directory / "shape.png").read_bytes().startswith(b"\x89PNG"))
        history = plot_shape.read_history(ended / "history.csv")
        words = plot_shape.words_of(history, SUMMARY)
        self.assertEqual(words[:2], ["peak pressure 4, after 3, 1.2 times the mean", "5 evaluations"])
        self.assertIn("converged", words)
        self.assertEqual(plot_shape.words_of(history, {}), ["5 evaluations", "running: 2 iterations so far"])

    def test_refused(self):
        empty = runs.scratch("empty")
        empty.mkdir()
        for directory, words in (
            (empty, r"history\.csv: No such file or directory; only the program shape writes it"),
            (empty / "nowhere", "no such directory; name the directory of a run of the program shape"),
        ):
            status, out, errors = self.plot(directory, "--shape")
            self.assertEqual((status, out), (2, ""))
            self.assertRegex(errors, f"^harmos-plot: .*{words}.*\n$")
        status, _, errors = self.plot(written(), "--shape", "--parts")
        self.assertEqual(status, 2)
        self.assertIn("--shape and --parts exclude each other", errors)


if __name__ == "__main__":
    runs.main()
