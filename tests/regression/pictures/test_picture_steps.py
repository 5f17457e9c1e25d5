# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of runs of several steps, from files written here; no program is run.

What each class guards against:

    Curves  a column taken for another one, a name that is not there without a hint, half a row; runs taken for
            each other, ways back drawn as ways forth, snaps that nobody sees
    Frames  frames of steps that are not there, each with a scale and colours of its own, an
            animation that lacks some; the figures of another step in the caption
    Counts  iterations of several steps drawn on top of each other
"""

import csv
import json
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

    import plot_curve
    import plot_deformed
    import plot_frames
    import plot_solution
    import run_results
    import synthetic_composite
    from matplotlib.image import imread
    from PIL import Image
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

TIMES = (0.25, 0.5, 1.0)
FIXED = ("step", "time", "converged", "products", "active_sets", "energy", "external_work", "dissipated",
         "released", "closed", "open", "sticking", "slipping", "broken")
FORCES = [f"Contact/joint, left/f{x}" for x in "xyz"] + [f"Prescribed displacement/top/f{x}" for x in "xyz"]


def rows_of(times=TIMES):
    rows = []
    for k, time in enumerate(times, start=1):
        row = dict.fromkeys((*FIXED, *FORCES), 0)
        row.update(step=k, time=time, converged=1, energy=-(time**2))
        row["Contact/joint, left/fy"] = -2 * time
        row["Prescribed displacement/top/fy"] = 2 * time
        rows.append(row)
    return rows


def squares(vector, load):
    """Two squares side by side, which touch; a membrane or plane bodies."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    parts = [(body, square + [body, 0.0], np.arange(4)[None]) for body in (0, 1)]
    x = np.concatenate([points for _, points, _ in parts])
    touching = x[:, 0] == 1
    u = 0.1 * load * (1 + x[:, 1])
    data = {
        "displacement": np.stack([u, 0 * u, 0 * u], axis=1) if vector else -u,
        "contact_pressure": np.where(touching, load * x[:, 1], 0.0),
        "gap": np.zeros(len(x)),
        "active_set": np.where(touching, 1 + (x[:, 1] > 0), 0).astype(np.uint8),
    }
    if vector:
        data["von_mises"] = load * (1 + x[:, 0])
    return parts, data


def stepped(vector=True, times=TIMES, files=None):
    """The directory of a run of several steps."""
    directory = runs.scratch("steps")
    synthetic_composite.write_run(
        directory, *squares(vector, 1.0), energy=-1.0, steps=rows_of(times)
    )
    (directory / "result.vtkhdf").unlink()
    names = []
    for k, time in enumerate(times, start=1):
        names.append({"name": f"result_{k:04d}.vtkhdf", "time": time})
        synthetic_composite.write_vtkhdf(directory / names[-1]["name"], *squares(vector, time))
    series = {"file-series-version": "1.0", "files": files or names}
    (directory / "result.vtkhdf.series").write_text(json.dumps(series), encoding="utf-8")
    with open(directory / "steps.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, (*FIXED, *FORCES))
        writer.writeheader()
        writer.writerows(rows_of(times))
    return directory


def plot(*words):
    return subprocess.run(
        [sys.executable, runs.application("harmos-plot"), *words], capture_output=True, text=True, timeout=120
    )


class Curves(unittest.TestCase):
    def refused(self, *words):
        result = plot(*words)
        self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
        self.assertNotIn("Traceback", result.stderr)
        return result.stderr

    def test_columns(self):
        table = plot_curve.read_steps(stepped() / "steps.csv")
        self.assertEqual(list(table), [*FIXED, *FORCES])
        self.assertEqual(table["Contact/joint, left/fy"].tolist(), [-0.5, -1.0, -2.0])
        self.assertEqual(table["time"].tolist(), list(TIMES))

    def test_what_is_drawn(self):
        path = stepped() / "steps.csv"
        table = plot_curve.read_steps(path)
        table["converged"][1] = 0
        names = ["Contact/joint, left/fy", "energy"]
        figure = plot_curve.plot_curve([plot_curve.Run("", table, path)], names, "time", "", [])
        lines = figure.axes[0].lines
        for k, name in enumerate(names):
            np.testing.assert_array_equal(lines[2 * k].get_xdata(), TIMES)
            np.testing.assert_array_equal(lines[2 * k].get_ydata(), table[name])
            # What did not converge is marked.
            np.testing.assert_array_equal(lines[2 * k + 1].get_xdata(), TIMES[1:2])
        words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
        self.assertEqual(words, [*names, "not converged"])

    @staticmethod
    def stretched(label, strain, stiffness, released=None):
        strain = np.array(strain)
        none = np.zeros(len(strain))
        table = {
            "step": np.arange(1, len(strain) + 1), "strain": strain, "stress": stiffness * strain,
            "dissipated": 1.0 + none, "released": none if released is None else np.array(released),
        }
        return plot_curve.Run(label, table, Path("steps.csv"))

    def test_runs_beside_each_other(self):
        runs_of = [self.stretched("soft", [1, 2, 3], 1.0), self.stretched("stiff", [2, 4], 5.0)]
        figure = plot_curve.plot_curve(runs_of, ["stress"], "strain", "", [])
        axes = figure.axes[0]
        for line, drawn in zip(axes.lines[::2], runs_of, strict=True):
            # From where it began, which has no row.
            self.assertEqual(line.get_xdata().tolist(), [0, *drawn.table["strain"]])
            self.assertEqual(line.get_ydata().tolist(), [0, *drawn.table["stress"]])
        self.assertEqual([text.get_text() for text in axes.get_legend().get_texts()], ["soft", "stiff"])
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("strain", "stress"))
        self.assertEqual(len(axes.texts), 0)
        # Over time as well; the axis begins there for all columns, but no row of steps tells what others began with.
        runs_of[0].table["time"] = np.array([1.0, 2.0, 3.0])
        figure = plot_curve.plot_curve(runs_of[:1], ["stress"], "time", "", [])
        self.assertEqual(figure.axes[0].lines[0].get_xdata().tolist(), [0, 1, 2, 3])
        self.assertEqual(figure.axes[0].get_xlim()[0], 0.0)

    def test_ways_back_and_forth(self):
        self.assertEqual(plot_curve.branches(np.array([0, 1, 2, 1, 1, 0, 3])), [(0, 2), (2, 5), (5, 6)])
        self.assertEqual(plot_curve.branches(np.array([0.0, 1.0])), [(0, 1)])
        self.assertEqual(plot_curve.branches(np.array([2.0])), [(0, 0)])
        run = self.stretched("", [1, 2, 3, 2, 1, 0, 1, 2, 3, 4, 5], 1.0)
        figure = plot_curve.plot_curve([run], ["stress"], "strain", "", [])
        arrows = figure.axes[0].texts
        ways = [np.sign(arrow.xy[0] - arrow.xyann[0]) for arrow in arrows]
        self.assertEqual(ways, [1, -1, 1])
        # On one line; a segment is one long.
        self.assertGreaterEqual(abs(arrows[1].xy[0] - arrows[2].xy[0]), 1)

    def test_snaps(self):
        # Of all 1.02 half a thousandth in the second row, and two hundredths in the last.
        run = self.stretched("", [1, 2, 3], 1.0, [0.0, 5e-4, 0.0205])
        figure = plot_curve.plot_curve([run], ["stress"], "strain", "", [])
        marks = [line for line in figure.axes[0].lines if line.get_marker() == "v"]
        self.assertEqual([line.get_xdata().tolist() for line in marks], [[3]])
        words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
        self.assertEqual(words, ["interfaces snapped"])

    def test_runs_by_the_program(self):
        directory, other = stepped(), stepped()
        words = ["--curve", "energy", "--output", directory / "beside"]
        alone = plot(directory, *words)
        self.assertEqual((alone.returncode, alone.stderr), (0, ""))
        before = (directory / "beside" / "curve.png").read_bytes()
        (other / "summary.json").unlink()
        drawn = plot(directory, *words, "--beside", other, "--label", "first")
        self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
        self.assertNotEqual((directory / "beside" / "curve.png").read_bytes(), before)
        self.assertIn("no such directory", self.refused(directory, *words, "--beside", directory / "none"))

    def test_program(self):
        directory = stepped()
        drawn = plot(
            directory, "--curve", "Contact/joint, left/fy", "--curve", "energy",
            "--against", "Prescribed displacement/top/fy",
        )
        self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
        self.assertEqual(drawn.stdout.split(), [str(directory / "curve.png")])
        self.assertGreater((directory / "curve.png").stat().st_size, 10_000)
        # Of a run that goes on: no summary yet, and half a row.
        (directory / "summary.json").unlink()
        with open(directory / "steps.csv", "a", encoding="utf-8") as file:
            file.write("4,1.2")
        self.assertEqual(plot(directory, "--curve", "energy", "--output", directory / "other").returncode, 0)
        self.assertEqual(len(plot_curve.read_steps(directory / "steps.csv")["time"]), 3)

    def test_unknown_names(self):
        directory = stepped()
        for words, nearest in (
            (("--curve", "Contact/joint,left/fy"), "Contact/joint, left/fy"),
            (("--curve", "contact/joint, left/FY"), "Contact/joint, left/fy"),
            (("--curve", "energy", "--against", "tim"), "time"),
            (("--curve", "prescribed displacement/top/f"), "Prescribed displacement/top/f"),
        ):
            with self.subTest(words):
                told = self.refused(directory, *words)
                self.assertIn(f'steps.csv: no column "{words[-1]}"; did you mean "{nearest}', told)
                self.assertIn("The columns are step, time, ", told)

    def test_files_that_cannot_be_drawn(self):
        for text, message in (
            (None, r"steps.csv: No such file.*only a run of several steps"),
            ("", "no step in the file"),
            (",".join(FIXED) + "\n", "no step in the file"),
            ("step,time\n1,0.5\n2\n", "row 3 has 1 cells for 2 columns"),
            ("step,time\n1,half\n", "column time: could not convert"),
        ):
            with self.subTest(message):
                directory = stepped()
                (directory / "steps.csv").unlink()
                if text is not None:
                    (directory / "steps.csv").write_text(text, encoding="utf-8")
                self.assertRegex(self.refused(directory, "--curve", "time"), message)

    def test_options_that_exclude_each_other(self):
        directory = stepped()
        for words, message in (
            (("--curve", "time", "--follow"), "--follow and --curve exclude each other"),
            (("--curve", "time", "--frames"), "--frames and --curve exclude each other"),
            (("--scaling", "auto", "--frames"), "--frames and --scaling exclude each other"),
            (("--against", "time"), "--against needs --curve"),
            (("--beside", directory), "--beside needs --curve"),
            (("--curve", "time", "--label", "one"), "more --label options than runs"),
        ):
            self.assertIn(message, self.refused(directory, *words))


class Frames(unittest.TestCase):
    def test_all_are_drawn_and_animated(self):
        for vector in (True, False):
            with self.subTest(vector=vector):
                directory = stepped(vector)
                drawn = plot(directory, "--frames", "--dpi", "50")
                self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
                frames = [f"frame_{k:04d}.png" for k in (1, 2, 3)]
                names = ["solution.png", "convergence.png", *frames, "steps.gif"]
                self.assertEqual(drawn.stdout.split(), [str(directory / name) for name in names])
                images = [imread(directory / name) for name in frames]
                self.assertEqual(len({image.shape for image in images}), 1)
                self.assertGreater(np.abs(images[0] - images[-1]).max(), 0.5)
                with Image.open(directory / "steps.gif") as animation:
                    self.assertEqual((animation.n_frames, animation.info["loop"]), (3, 0))
                    self.assertEqual(animation.size, images[0].shape[1::-1])
                    for k, image in enumerate(images):
                        animation.seek(k)
                        shown = np.asarray(animation.convert("RGB")) / 255
                        # Dithered: means of squares agree.
                        rows, columns = (size // 16 * 16 for size in shown.shape[:2])
                        off = (shown - image[..., :3])[:rows, :columns]
                        off = off.reshape(rows // 16, 16, columns // 16, 16, 3).mean(axis=(1, 3))
                        self.assertLess(np.abs(off).max(), 0.04)

    def test_one_look_for_all(self):
        for vector, module in ((True, plot_deformed), (False, plot_solution)):
            frames = plot_frames.frames_of(stepped(vector))
            results = plot_frames.Results(frames)
            self.assertIs(plot_frames.painter_of(results[0])[0], module)
            together, last = module.look_of(results), module.look_of([results[2]])
            if vector:
                self.assertEqual(together.scale, last.scale)
                # From the least stress of the first step to the greatest of the last.
                self.assertEqual((together.colours.vmin, together.colours.vmax), (0.25, 3.0))
            else:
                np.testing.assert_allclose(together.heights, (-0.2, -0.025))
                self.assertEqual(together.pressures, (0.0, 1.0))

    def test_results_are_read_again_where_they_are_many(self):
        results = plot_frames.Results(plot_frames.frames_of(stepped()))
        again = [r.von_mises.max() for r in results]
        self.assertEqual(len(results.kept), 3)
        results.kept = None
        self.assertEqual([r.von_mises.max() for r in results], again)

    def test_captions(self):
        directory = stepped()
        summary = run_results.read_summary(directory / "summary.json")
        frames = plot_frames.frames_of(directory)
        self.assertEqual(frames[1].text, "step 2 \u00b7 time 0.5")
        self.assertIn("energy -0.25", plot_frames.caption_at(summary, frames[1]))
        self.assertIn("energy -1", plot_frames.caption_at(summary, frames[2]))
        summary["steps"] = []
        self.assertFalse([w for w in plot_frames.caption_at(summary, frames[1]) if "energy" in w])

    def test_the_last_step_is_the_solution(self):
        directory = stepped()
        drawn = plot(directory, "--dpi", "50")
        self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
        first = (directory / "solution.png").read_bytes()
        series = directory / "result.vtkhdf.series"
        files = json.loads(series.read_text(encoding="utf-8"))
        files["files"].pop()
        series.write_text(json.dumps(files), encoding="utf-8")
        plot(directory, "--dpi", "50")
        self.assertNotEqual(first, (directory / "solution.png").read_bytes())

    def test_every_second_step(self):
        """Frames are called as the steps, which need not all have a result."""
        files = [{"name": "result_0001.vtkhdf", "time": 0.25}, {"name": "result_0003.vtkhdf", "time": 1.0}]
        frames = plot_frames.frames_of(stepped(files=files))
        self.assertEqual([frame.number for frame in frames], [1, 3])

    def test_what_is_no_series(self):
        single = runs.scratch("single")
        synthetic_composite.write_run(single, *squares(True, 1.0))
        broken, empty, gone = stepped(), stepped(), stepped()
        (broken / "result.vtkhdf.series").write_text('{"files": [{"time": 1}]}', encoding="utf-8")
        (empty / "result.vtkhdf.series").write_text('{"files": []}', encoding="utf-8")
        (gone / "result_0002.vtkhdf").unlink()
        for directory, message in (
            (single, r"result.vtkhdf.series: not there; frames are those of a run of several steps"),
            (broken, r"no series of results \(KeyError: 'name'\)"),
            (empty, "no result in the series"),
            (gone, "names result_0002.vtkhdf, which does not exist"),
        ):
            refused = plot(directory, "--frames")
            self.assertEqual(refused.returncode, 2)
            self.assertRegex(refused.stderr, message)


class Counts(unittest.TestCase):
    def test_a_run_that_has_ended_is_followed_to_its_frames(self):
        directory = stepped()
        path = directory / "iterations.csv"
        rows = path.read_text(encoding="utf-8").splitlines()
        path.write_text("\n".join([*rows, *rows[1:], ""]), encoding="utf-8")
        self.assertEqual(run_results.read_iterations(path)["hessian_applications"][-1], 14)
        drawn = plot(directory, "--follow", "--frames", "--dpi", "50")
        self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
        self.assertIn("steps.gif", drawn.stdout)

    def test_counts_that_begin_anew(self):
        self.assertEqual(run_results.running(np.array([0, 3, 5, 0, 2, 1, 4])).tolist(), [0, 3, 5, 5, 7, 8, 11])
        self.assertEqual(run_results.running(np.array([0, 3, 3, 5])).tolist(), [0, 3, 3, 5])
        self.assertEqual(run_results.running(np.array([4])).tolist(), [4])


if __name__ == "__main__":
    runs.main()
