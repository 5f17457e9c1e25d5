# SPDX-License-Identifier: BSD-3-Clause
"""The application study, on a deck of a few seconds.

What each class guards against:

    Content   errors that are not those of the solutions: energy norm, displacement, contact pressure
              and zone of a run are recomputed here from two result files by formulas of their own;
              a front, sentences or ratios that do not follow from the rows
    Resume    runs that are repeated, lost or spoiled when a study is ended and started again
    Refused   bad decks that are accepted, or refused without saying where
    Decks     decks of the page that are not valid, pictures that are not shown or too large
    Charts    charts that are not drawn
    Ranks     errors that depend on the number of ranks
    Friction  slips and zones that stick which are not those of the solutions, recomputed as in Content; columns
              of friction in studies of scenes that have none, or none where one has it
"""

import csv
import json
import math
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_decks  # noqa: E402
import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

DECK = runs.SOURCE / "apps" / "study" / "decks" / "tiny.xml"
MEASURES = ("energy", "displacement", "pressure", "contact_zone")
SMALL = {"Axes/mesh/Values": "{2, 4}", "Axes/mesh/Labels": "{h = 1/4, h = 1/8}"}
REFERENCE = 256  # elements along the side of a body, as the deck says


def study(output=None, np_=2, sets=None, deck=DECK, extra=()):
    sets = {"Study/Charts": "false", "Study/Repetitions": 1, **(sets or {})}
    return runs.run(deck, sets, np=np_, output=output, extra=extra, program="study")


def rows_of(directory):
    with open(directory / "study.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(text):
    return float(text) if text else math.nan


_done = {}


def finished(case):
    """The whole study, once; (run, rows, study.json)."""
    if not _done:
        run = study(sets={"Study/Repetitions": 2})
        case.assertEqual(run.returncode, 0, run)
        text = (run.directory / "study.json").read_text(encoding="utf-8")
        _done["it"] = run, rows_of(run.directory), json.loads(text)
    return _done["it"]


CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


class Grid:
    """A solution of the model problem, cell by cell: u[body, i, j, corner].

    Cells of different subdomains have copies of their common nodes, which a loose tolerance leaves apart.
    """

    def __init__(self, elements, tolerance):
        sets = {
            "Model/Subdomains per side": 2,
            "Model/Elements per subdomain side": elements // 2,
            "Dual operator/Form": "condensed",
            "Solver/Tolerance": tolerance,
        }
        run = runs.run(runs.MODEL, sets)
        assert run.returncode == 0, run
        result = runs.Result(run.directory / "result.vtkhdf", elements)
        self.n = elements
        points = np.repeat(
            np.concatenate([[0], np.cumsum(result.arrays["NumberOfPoints"])[:-1]]),
            result.arrays["NumberOfConnectivityIds"],
        )
        cells = (result.arrays["Connectivity"] + points).reshape(-1, 4)
        i, j = result.i[cells].min(axis=1), result.j[cells].min(axis=1)
        self.u = np.full((2, elements, elements, 4), np.nan)
        for k, (dx, dy) in enumerate(CORNERS):
            at = (result.i[cells] == i[:, None] + dx) & (result.j[cells] == j[:, None] + dy)
            self.u[result.body[cells[:, 0]], i, j, k] = result.u[cells[at]]
        edge = (result.body == 0) & (result.i == elements)
        self.pressure, self.closed = np.zeros(elements + 1), np.zeros(elements + 1, dtype=bool)
        self.pressure[result.j[edge]] = result.arrays["PointData/contact_pressure"][edge]
        self.closed[result.j[edge]] = result.arrays["PointData/active_set"][edge] == 2

    def on(self, n):
        """On a finer grid whose cells lie within those of this one: (u, pressure)."""
        ratio = n // self.n
        fine = np.empty((2, n, n, 4))
        for p in range(ratio):
            for q in range(ratio):
                for k, (dx, dy) in enumerate(CORNERS):
                    x, y = (p + dx) / ratio, (q + dy) / ratio
                    weights = [(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y]
                    fine[:, p::ratio, q::ratio, k] = self.u @ weights
        x = np.arange(n + 1) / ratio
        return fine, np.interp(x, np.arange(self.n + 1), self.pressure)


def norms(u, n):
    """Energy and L2 norm of a bilinear field on squares of side 1/n, by the element matrices."""
    corners = u.reshape(-1, 4)
    stiffness = np.array([[4, -1, -2, -1], [-1, 4, -1, -2], [-2, -1, 4, -1], [-1, -2, -1, 4]]) / 6
    mass = np.array([[4, 2, 1, 2], [2, 4, 2, 1], [1, 2, 4, 2], [2, 1, 2, 4]]) / 36 / n**2
    return tuple(math.sqrt(np.sum((corners @ m) * corners)) for m in (stiffness, mass))


def areas(n):
    area = np.full(n + 1, 1.0 / n)
    area[[0, -1]] /= 2
    return area


class Content(unittest.TestCase):
    def test_rows_and_json_are_the_same_runs(self):
        _, rows, data = finished(self)
        self.assertEqual(len(rows), 12)
        self.assertEqual(len(data["runs"]), 12)
        # Without friction there is nothing of it.
        self.assertEqual(tuple(data["measures"]), MEASURES)
        self.assertFalse([name for name in rows[0] if name.startswith(("slip", "stick"))])
        for run in data["runs"]:
            row = next(r for r in rows if all(r[a] == v for a, v in run["settings"].items()))
            self.assertEqual(row["ranks"], "2")
            self.assertEqual(row["converged"], "yes")
            self.assertAlmostEqual(run["seconds"]["total"], number(row["seconds"]), places=6)
            stages = sum(number(v) for k, v in row.items() if k.startswith("seconds_"))
            # Medians of each by itself: their sum is near the total, not below it by definition.
            self.assertGreater(stages, 0)
            self.assertGreater(number(row["memory_mib"]), 0)
            for measure in MEASURES:
                errors = run["errors"][measure]
                self.assertAlmostEqual(errors["total"], number(row[f"{measure}_error"]), places=6)
                judged = errors["total"] >= 10 * errors["reference"]
                self.assertEqual(errors["judged"], judged)
                # Triangle inequality, both ways.
                parts = sum(number(row[f"{measure}_{p}"]) for p in ("discretisation", "solver", "local"))
                self.assertLessEqual(errors["total"], parts * (1 + 1e-4) + 1e-9)
        # Some are not judged, or the mark would not be tested.
        self.assertEqual({r["energy_judged"] for r in rows}, {"yes", "no"})

    def test_errors_are_those_of_the_solutions(self):
        _, rows, _ = finished(self)
        reference = Grid(REFERENCE, 1e-10)
        for elements, mesh in ((4, "2"), (8, "4")):
            for tolerance in ("1e-1", "1e-4"):
                row = next(
                    r
                    for r in rows
                    if (r["mesh"], r["tolerance"], r["local solver"])
                    == (mesh, tolerance, "condensed;double")
                )
                run = Grid(elements, tolerance)
                u, pressure = run.on(REFERENCE)
                found = norms(u - reference.u, REFERENCE)
                whole = norms(reference.u, REFERENCE)
                area = areas(REFERENCE)
                expected = {
                    "energy": found[0] / whole[0],
                    "displacement": found[1] / whole[1],
                    "pressure": math.sqrt(area @ (pressure - reference.pressure) ** 2)
                    / math.sqrt(area @ reference.pressure**2),
                    "contact_zone": abs(areas(elements) @ run.closed - area @ reference.closed)
                    / (area @ reference.closed),
                }
                for measure, value in expected.items():
                    with self.subTest(mesh=mesh, tolerance=tolerance, measure=measure):
                        # Six digits in the table; the same runs but for rounding.
                        self.assertAlmostEqual(number(row[f"{measure}_error"]) / value, 1, delta=1e-4)

    def test_the_errors_of_the_parts(self):
        _, rows, _ = finished(self)
        tight = {m: Grid(n, 1e-10) for m, n in (("2", 4), ("4", 8))}
        scale = norms(Grid(REFERENCE, 1e-10).u, REFERENCE)[0]
        for mesh, grid in tight.items():
            row = next(
                r
                for r in rows
                if (r["mesh"], r["tolerance"], r["local solver"]) == (mesh, "1e-1", "condensed;double")
            )
            run = Grid(grid.n, 1e-1)
            solver = norms(run.u - grid.u, grid.n)[0] / scale
            self.assertAlmostEqual(number(row["energy_solver"]) / solver, 1, delta=1e-4)
            self.assertEqual(number(row["energy_local"]), 0.0)
        for row in rows:
            if row["local solver"] == "condensed;single":
                # Rounding of 32 bits, times the condition of the subdomains.
                self.assertGreater(number(row["energy_local"]), 1e-10)
                self.assertLess(number(row["energy_local"]), 1e-4)

    def test_front_ratios_and_sentences(self):
        run, _, data = finished(self)
        for measure in MEASURES:
            judged = [r for r in data["runs"] if r["errors"][measure]["judged"]]
            for point in data["runs"]:
                errors = point["errors"][measure]
                if point not in judged:
                    self.assertFalse(errors["on_front"])
                    self.assertIsNone(errors["ratio_to_front"])
                    continue
                as_good = [
                    r["seconds"]["total"]
                    for r in judged
                    if r["errors"][measure]["total"] <= errors["total"]
                ]
                ratio = point["seconds"]["total"] / min(as_good)
                self.assertAlmostEqual(errors["ratio_to_front"], ratio, places=9)
                self.assertEqual(errors["on_front"], ratio == 1.0)
        self.assertEqual(len(data["sentences"]), 8)  # four measures, two targets
        for sentence in data["sentences"]:
            self.assertIn(sentence, run.stdout)
        judged = [r for r in data["runs"] if r["errors"]["energy"]["judged"]]
        best = min(
            (r for r in judged if r["errors"]["energy"]["total"] <= 0.1),
            key=lambda r: r["seconds"]["total"],
        )
        self.assertRegex(
            data["sentences"][0],
            rf"^energy norm to 1e-1: {best['label']}: \S+ s \(error \S+\)$",
        )
        self.assertRegex(data["sentences"][1], "^energy norm to 1e-6: no run that can be judged")


class Resume(unittest.TestCase):
    def test_runs_that_are_there_are_not_repeated(self):
        first = study(sets=SMALL)
        self.assertEqual(first.returncode, 0, first)
        table = (first.directory / "study.csv").read_text(encoding="utf-8")
        again = study(first.directory, sets=SMALL)
        self.assertEqual(again.returncode, 0, again)
        self.assertIn("8 settings, 1 or more repetitions each; 8 already in the table", again.stdout)
        self.assertNotRegex(again.stdout, r"(?m)^1/")
        self.assertNotIn("Reference", again.stdout)  # nothing is computed
        self.assertEqual((first.directory / "study.csv").read_text(encoding="utf-8"), table)
        lines = table.splitlines(keepends=True)
        (first.directory / "study.csv").write_text("".join(lines[:3] + lines[4:]), encoding="utf-8")
        third = study(first.directory, sets=SMALL)
        self.assertEqual(third.returncode, 0, third)
        self.assertRegex(third.stdout, r"(?m)^1/1 h = 1/4, tolerance 1e-4, double: ")
        key = lines[3].split(",")[:4]
        self.assertIn(key, [line.split(",")[:4] for line in
                            (first.directory / "study.csv").read_text(encoding="utf-8").splitlines()])
        # Runs on another number of ranks are others.
        other = study(first.directory, np_=1, sets=SMALL)
        self.assertIn("; 0 already in the table", other.stdout)
        self.assertEqual(len(rows_of(first.directory)), 16)

    def test_another_study_in_the_directory_is_refused(self):
        first = study(sets=SMALL)
        other = study(first.directory, sets={**SMALL, "Study/Tight tolerance": 1e-9})
        self.assertEqual(other.returncode, 2, other)
        self.assertRegex(other.errors[0], "is a table of another study: .*--output")

    def test_killed_and_started_again(self):
        # Without a launcher, whose ranks would live on for a while.
        directory = runs.scratch()
        words = [str(DECK), "--output", str(directory), "--set", "Study/Charts=false"]
        process = subprocess.Popen(
            [runs.application("study"), *words],
            env=runs.environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        end = time.monotonic() + runs.TIMEOUT
        while time.monotonic() < end and process.poll() is None:
            if (directory / "study.csv").exists() and len(rows_of(directory)) >= 2:
                break
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
        process.wait()
        before = rows_of(directory)
        self.assertGreaterEqual(len(before), 2)
        self.assertLess(len(before), 12)
        again = study(directory, np_=0, sets={"Study/Repetitions": 3})
        self.assertEqual(again.returncode, 0, again)
        self.assertIn(f"; {len(before)} already in the table", again.stdout)
        rows = rows_of(directory)
        self.assertEqual(rows[: len(before)], before)
        self.assertEqual(len(rows), 12)
        self.assertEqual(len({(r["mesh"], r["tolerance"], r["local solver"]) for r in rows}), 12)


class Refused(unittest.TestCase):
    def test_bad_decks(self):
        for sets, message in (
            ({"Study/Deck": "nowhere.xml"}, "nowhere.xml.* cannot be read"),
            ({"Study/Aplication": "x"}, 'did you mean "Application"'),
            ({"Study/Application": "harmos"}, "Subdomains per side"),
            ({"Study/Targets": "{1e-1, small}"}, '"small", which is not a positive number'),
            ({"Study/Set": "{Model}"}, 'Study/Set.* "Model", which is not of the form'),
            ({"Axes/mesh/Parameters": "{Model/Elements}"}, '"Axes/mesh".*Elements'),
            ({"Axes/mesh/Values": "{4, many, 32}"}, '"Axes/mesh".*"many" is not a valid value'),
            ({"Axes/mesh/Values": "{4, 4, 32}"}, 'has the value "4" twice'),
            ({"Axes/mesh/Values": "{4, 32}"}, "has 2 values, but 3 labels"),
            ({"Axes/local solver/Values": "{condensed, implicit}"}, "has 1 parts; separate them"),
            ({"Axes/extra/Values": "{1}"}, '"Axes/extra" needs "Parameters" and "Values"'),
            ({"Reference/Coarser": "{}"}, 'needs "Set", "Coarser" and "Coarsest"'),
            ({"Reference/Set": "{Model/Elements per subdomain side=0}"}, '"Reference/Set".*out of range'),
        ):
            for extra in ((), ("--check",)):
                with self.subTest(sets=sets, extra=extra):
                    run = study(sets=sets, np_=1 if extra else 2, extra=extra)
                    self.assertEqual(run.returncode, 2, run)
                    self.assertEqual(len(run.errors), 1, run)
                    self.assertRegex(run.errors[0], message)
                    self.assertFalse((run.directory / "study.csv").exists())

    def test_check_runs_nothing(self):
        run = study(np_=1, extra=["--check"])
        self.assertEqual(run.returncode, 0, run)
        self.assertIn("is valid: 12 settings", run.stdout)
        self.assertFalse(run.directory.exists())

    def test_runs_that_fail_are_rows(self):
        """Single precision refuses tolerances below 1e-6; the other runs go on."""
        sets = {**SMALL, "Axes/tolerance/Values": "{1e-2, 1e-8}"}
        run = study(sets=sets)
        self.assertEqual(run.returncode, 0, run)
        rows = rows_of(run.directory)
        self.assertEqual(len(rows), 8)
        failed = [r for r in rows if r["converged"] == "no"]
        self.assertEqual(
            {(r["tolerance"], r["local solver"]) for r in failed}, {("1e-8", "condensed;single")}
        )
        for row in failed:
            self.assertIn("below the accuracy of dense blocks in single precision", row["reason"])
            self.assertEqual((row["seconds"], row["energy_error"]), ("", ""))
        data = json.loads((run.directory / "study.json").read_text(encoding="utf-8"))
        self.assertFalse(any("1e-8, single" in s for s in data["sentences"]))
        # Their reasons, with commas and quotes, are read again.
        again = study(run.directory, sets=sets)
        self.assertIn("; 8 already in the table", again.stdout)


class Decks(unittest.TestCase):
    """The decks of the three scenes are valid, and on the page with figures and pictures."""

    def test_decks_and_page(self):
        page = (runs.SOURCE / "docs" / "accuracy.md").read_text(encoding="utf-8")
        decks = [deck for deck in DECK.parent.glob("*.xml") if deck != DECK]
        self.assertEqual(len(decks), 4)
        for deck in decks:
            with self.subTest(deck=deck.name):
                run = study(deck=deck, np_=1, extra=["--check"])
                self.assertEqual(run.returncode, 0, run)
                block = page.split(f"<!-- begin {deck.stem}: ")[1].split(f"<!-- end {deck.stem} -->")[0]
                self.assertIn("energy norm to ", block)
                pictures = list((runs.SOURCE / "docs" / "images").glob(f"accuracy_{deck.stem}_*.png"))
                self.assertGreaterEqual(len(pictures), 3)
                for picture in pictures:
                    self.assertLess(picture.stat().st_size, 150_000, picture)
                    self.assertIn(f"](images/{picture.name})", page)


class Charts(unittest.TestCase):
    NAMES = ("error_against_seconds", "stages", "iterations", "error_parts")

    def test_charts(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("the Python module matplotlib is missing")
        directory = finished(self)[0].directory
        run = study(directory, sets={"Study/Charts": "true"})
        self.assertEqual(run.returncode, 0, run)
        self.assertIn("charts as PNG and SVG", run.stdout)
        for name in self.NAMES:
            png = (directory / f"{name}.png").read_bytes()
            self.assertTrue(png.startswith(b"\x89PNG\r\n\x1a\n"), name)
            self.assertGreater(len(png), 15_000, name)  # an empty pair of axes has less
            svg = (directory / f"{name}.svg").read_text(encoding="utf-8")
            self.assertIn("</svg>", svg)

    def test_without_a_study_a_sentence_says_so(self):
        result = subprocess.run(
            [sys.executable, runs.application("harmos-study-plot"), runs.scratch()],
            capture_output=True, text=True, timeout=120,
        )
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertRegex(result.stderr, "study.json: cannot be read .*run study first")


class Ranks(unittest.TestCase):
    def test_errors_are_the_same(self):
        _, rows, _ = finished(self)
        for ranks in (1, 4):
            run = study(np_=ranks, sets=SMALL)
            self.assertEqual(run.returncode, 0, run)
            others = rows_of(run.directory)
            self.assertEqual(len(others), 8)
            for other in others:
                row = next(
                    r
                    for r in rows
                    if all(r[k] == other[k] for k in ("mesh", "tolerance", "local solver"))
                )
                for measure in MEASURES:
                    for part in ("error", "discretisation"):
                        key = f"{measure}_{part}"
                        first, second = number(row[key]), number(other[key])
                        # Sums in another order, and blocks of single precision, which round by 6e-8. With a
                        # loose tolerance rounding may turn the path; both ends are as far from the tight run
                        # as their solver errors say.
                        allowed = 1e-4 * first
                        if part == "error":
                            allowed += number(row[f"{measure}_solver"]) + number(other[f"{measure}_solver"])
                        self.assertAlmostEqual(first, second, delta=allowed)


class Strip:
    """The floor of the block of class Friction, from a run of its own: the fields at its nodes, in their order."""

    def __init__(self, deck, elements, tolerance):
        sets = {"Bodies/block/Elements a side": elements_of(elements), "Solver/Tolerance": tolerance}
        run = runs.run(deck, sets, program="harmos")
        assert run.returncode == 0, run
        with h5py.File(run.directory / "result.vtkhdf", "r") as file:
            points, data = file["VTKHDF/Points"][()], file["VTKHDF/PointData"]
            floor = np.flatnonzero(points[:, 1] == 0.0)
            # Copies of a node have the same values.
            self.x, first = np.unique(points[floor, 0], return_index=True)
            self.slip = data["slip"][()][floor[first], 0]
            self.state = data["friction_state"][()][floor[first]]
        self.area = np.full(len(self.x), self.x[1] - self.x[0])
        self.area[[0, -1]] /= 2
        self.rough = np.where(self.state > 0, self.area, 0.0)  # where it bears friction
        self.sticking = self.area @ (self.state == STICKS)


STICKS = 1


def elements_of(n):
    return f"{{{n}, {n}, 1}}"


class Friction(unittest.TestCase):
    """A block pressed onto a rough floor and pushed until half of it slips."""

    MESHES = (2, 4)
    TOLERANCES = ("1e-2", "1e-4")
    REFERENCE = 64
    TIGHT = 1e-9

    def decks(self, directory):
        scene = {
            "Model": {"Physics": "plane strain"},
            "Materials": {"soft": {"Young's modulus": 1.0, "Poisson's ratio": 0.3}},
            "Bodies": {
                "block": {
                    "Source": "block",
                    "Size": [2.0, 1.0, 1.0],
                    "Subdomains a side": [2, 1, 1],
                    "Elements a side": [4, 4, 1],
                    "Element": "Q1",
                    "Materials": ["soft"],
                }
            },
            "Effects": {
                "Obstacle": {"floor": {"Part": "block/bottom"}},
                "Friction": {"rough": {"Contact": "floor", "Coefficient": 0.5}},
                "Traction": {
                    "press": {"Part": "block/top", "Density": [0.0, -0.05, 0.0]},
                    "push": {"Part": "block/left", "Density": [0.042, 0.0, 0.0]},
                },
            },
        }
        elements = "Bodies/block/Elements a side"
        parts = (("Set", self.REFERENCE), ("Coarser", self.REFERENCE // 2), ("Coarsest", self.REFERENCE // 4))
        study = {
            "Study": {
                "Application": "harmos",
                "Deck": "scene.xml",
                "Targets": ["1e-1"],
                "Least seconds": 0.0,
                "Tight tolerance": self.TIGHT,
            },
            "Reference": {name: [f"{elements}=[{n} {n} 1]"] for name, n in parts},
            "Axes": {
                "mesh": {"Parameters": [elements], "Values": [f"[{n} {n} 1]" for n in self.MESHES]},
                "tolerance": {"Parameters": ["Solver/Tolerance"], "Values": list(self.TOLERANCES)},
            },
        }
        directory.mkdir()
        (directory / "scene.xml").write_text(harmos_decks.xml("harmos", scene), encoding="utf-8")
        (directory / "study.xml").write_text(harmos_decks.xml("study", study), encoding="utf-8")
        return directory / "scene.xml", directory / "study.xml"

    def test_slips_and_zones_are_those_of_the_solutions(self):
        scene, deck = self.decks(runs.scratch("friction"))
        done = study(deck=deck)
        self.assertEqual(done.returncode, 0, done)
        rows = rows_of(done.directory)
        self.assertEqual(len(rows), 4)
        fine = Strip(scene, self.REFERENCE, self.TIGHT)
        # Some sticks, some slips, and some is open, or not all would be seen.
        self.assertTrue(0.2 < fine.sticking / fine.rough.sum() < 0.8, fine.sticking)
        self.assertLess(fine.rough.sum(), fine.area.sum())
        scale = math.sqrt(fine.rough @ fine.slip**2)
        for row in rows:
            elements = int(row["mesh"].strip("{}").split(",")[0])
            run, tight = Strip(scene, elements, row["tolerance"]), Strip(scene, elements, self.TIGHT)
            slip = np.interp(fine.x, run.x, run.slip)
            expected = {
                "slip_error": math.sqrt(fine.rough @ (slip - fine.slip) ** 2) / scale,
                "slip_solver": math.sqrt(tight.rough @ (run.slip - tight.slip) ** 2) / scale,
                "stick_zone_error": abs(run.sticking - fine.sticking) / fine.sticking,
                "stick_zone_solver": abs(run.sticking - tight.sticking) / fine.sticking,
            }
            for name, value in expected.items():
                with self.subTest(mesh=elements, tolerance=row["tolerance"], quantity=name):
                    # Six digits in the table; what the tight runs leave.
                    self.assertAlmostEqual(number(row[name]), value, delta=1e-4 * value + 10 * self.TIGHT)
            # Half of the largest point that sticks, which is of the inside.
            self.assertGreaterEqual(
                number(row["stick_zone_reference"]), 0.5 * fine.area[1] / fine.sticking * (1 - 1e-5)
            )
        data = json.loads((done.directory / "study.json").read_text(encoding="utf-8"))
        self.assertEqual(tuple(data["measures"])[:4], MEASURES)
        self.assertEqual(list(data["measures"])[4:], ["slip", "stick_zone"])
        self.assertTrue(any(s.startswith("slip to 1e-1: ") and "(error " in s for s in data["sentences"]))
        self.assertTrue(any(s.startswith("size of the zone that sticks to 1e-1: ") for s in data["sentences"]))

    def test_friction_of_another_application(self):
        """The composite has it by a parameter of its model, and says so before a run is made."""
        mesh = "Model/Elements per side={0}, Model/Expert/Fibre layers={1}, Model/Expert/Matrix layers={1}"
        for coefficient, columns in ((0.3, 2), (0.0, 0)):
            sets = {
                "Study/Set": f"{{Model/Columns=1, Model/Rows=1, Model/Coefficient of friction={coefficient}}}",
                **{
                    f"Reference/{name}": "{" + mesh.format(n, n // 4) + "}"
                    for name, n in (("Set", 16), ("Coarser", 8), ("Coarsest", 4))
                },
                "Axes/mesh/Values": "{1;4;1;1}",
                "Axes/mesh/Labels": "{coarse}",
                "Axes/dual operator/Values": "{condensed;double;Dirichlet}",
                "Axes/dual operator/Labels": "{double}",
                "Axes/decomposition/Values": "{1;1}",
                "Axes/decomposition/Labels": "{few}",
                "Axes/tolerance/Values": "{1e-4;fixed}",
                "Axes/tolerance/Labels": "{tight}",
            }
            done = study(deck=DECK.parent / "composite.xml", sets=sets)
            self.assertEqual(done.returncode, 0, done)
            (row,) = rows_of(done.directory)
            self.assertEqual(sum(name in row for name in ("slip_error", "stick_zone_error")), columns)
            if columns:
                self.assertGreater(number(row["slip_error"]), 0.0)


if __name__ == "__main__":
    runs.main()
