# SPDX-License-Identifier: BSD-3-Clause
"""The program shape as users meet it.

What each class guards against:

    Outputs      files and summary that contradict each other; answers that depend on the number of ranks; a cost whose
                 sign changes on its way to a file
    Restart      a run that is taken up again and goes another way, or solves again what was solved; a checkpoint of another
                 deck, or a damaged one, that is believed; a design that was the best and is lost
    Refused      designs that have no answer, and what is lost with them
    Names        names, lengths and options that are wrong and are met late, or not named
    Physics      costs without derivatives that are optimised all the same
    Factors      factorisations that gap designs do not need, or of bodies that do not move
"""

import csv
import math
import os
import shutil
import signal
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

PUNCH = runs.SOURCE / "apps" / "shape" / "decks" / "punch.xml"
BLOCK = runs.SOURCE / "apps" / "shape" / "decks" / "crowned_block.xml"
MEMBRANES = runs.SOURCE / "apps" / "harmos" / "decks" / "membranes.xml"
CELLS = "{4, 4, 1}"
SMALL = {
    PUNCH: {"Bodies/punch/Elements a side": CELLS, "Bodies/ground/Elements a side": CELLS},
    BLOCK: {"Bodies/block/Elements a side": CELLS, "Shape/Design/Pieces": "{3, 1}"},
    MEMBRANES: {},
}
TOLERANCE = 1e-10  # of both decks
# The punch moved down, not pressed.
HELD = {
    "Effects/Traction/force/Density": "{0, 0, 0}",
    "Effects/Prescribed displacement/push/Part": "punch/top",
    "Effects/Prescribed displacement/push/Components": "{y}",
    "Effects/Prescribed displacement/push/Displacement": "{0, -0.01, 0}",
}
TRESCA = {
    "Effects/Friction/rough/Contact": "Contact/joint", "Effects/Friction/rough/Law": "Tresca",
    "Effects/Friction/rough/Slip bound": 0.01,
}
SOFT = {"Shape/Cost/Quantity": "softest", "Shape/Constraints/Volume": "{0.02}"}
LIMIT = "Shape/Limits/Evaluations"
FILES = {"before.vtkhdf", "design.csv", "history.csv", "result.vtkhdf", "shape.csv", "summary.json"}


def run(deck, sets=None, np_=0, **more):
    return runs.run(deck, SMALL[deck] | (sets or {}), np_, program="shape", **more)


def optimised(case, deck, sets=None, np_=0, **more):
    done = run(deck, sets, np_, **more)
    case.assertEqual(done.returncode, 0, done)
    case.assertTrue(done.summary["converged"], done)
    case.assertNotRegex(done.stderr, "(?m)^(error|warning): ", done)
    return done


def rows(done, name):
    with open(done.directory / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def column(table, name):
    return np.array([float(row[name]) for row in table])


def history(done):
    """All but the seconds."""
    return [{name: value for name, value in row.items() if name != "seconds"} for row in rows(done, "history.csv")]


def restarted(directory, sets=None, np_=0):
    """Goes on in a copy."""
    copy = runs.scratch("restart")
    shutil.copytree(directory, copy)
    words = ["--restart", copy]
    for path, value in (sets or {}).items():
        words += ["--set", f"{path}={value}"]
    done = runs.start(words, np=np_, program="shape")
    done.directory = copy
    done.summary = runs.json.loads((copy / "summary.json").read_text(encoding="utf-8"))
    return done


class Case(unittest.TestCase):
    def refused(self, deck, sets, *words, status=2, extra=()):
        done = run(deck, sets, extra=extra)
        self.assertEqual(done.returncode, status, done)
        self.assertEqual(len(done.errors), 1, done)
        for word in words:
            self.assertIn(word, done.errors[0])
        return done


class Outputs(Case):
    def compare_files(self, done):
        results = done.summary["results"]
        self.assertEqual({path.name for path in done.directory.iterdir()}, FILES)
        self.assertLessEqual(
            {"cost", "cost_before", "peak_pressure", "mean_pressure", "peak_pressure_before", "mean_pressure_before",
             "evaluations", "solutions", "adjoints", "iterations", "gradient_norm", "constraint_violation", "volume",
             "refused_designs", "design_variables", "weak_contacts"},
            set(results),
        )
        steps, design, points = (rows(done, name) for name in ("history.csv", "design.csv", "shape.csv"))
        self.assertEqual(float(steps[-1]["cost"]), results["cost"])
        self.compare_first(steps, results)
        self.assertEqual(float(steps[-1]["gradient_norm"]), results["gradient_norm"])
        self.assertEqual(len(design), results["design_variables"])
        evaluations = column(steps, "evaluations")
        self.assertTrue((np.diff(evaluations) >= 0).all())
        self.assertEqual(evaluations[-1], results["evaluations"])
        self.assertEqual(column(steps, "iteration").tolist(), list(range(len(steps))))
        best, lower, upper = (column(design, name) for name in ("best", "lower", "upper"))
        self.assertTrue(((lower <= best) & (best <= upper)).all())
        area = column(points, "area")
        for suffix, when in (("_before", "before"), ("", "after")):
            pressure = column(points, f"pressure_{when}")
            self.assertEqual(pressure.max(), results["peak_pressure" + suffix])
            # The same sum in another order, over some ten points. Areas are those of the shape at the end.
            if when == "after" or results["design_variables"] == len(points):
                mean = area @ pressure / area.sum()
                self.assertAlmostEqual(mean / results["mean_pressure" + suffix], 1.0, delta=1e-13)
        self.compare_fields(done, points)
        return results, steps, design, points

    def compare_first(self, steps, results):
        """The optimiser begins at the projection of the start onto bounds and volume, which is the start but for rounding:
        the answer there is another one, to the tolerance of the solver."""
        self.assertAlmostEqual(float(steps[0]["cost"]) / results["cost_before"], 1.0, delta=TOLERANCE)

    def compare_fields(self, done, points):
        """Pressures of files and table, at nodes of the first body, whose copies subdomains may have."""
        for name, when in (("before.vtkhdf", "before"), ("result.vtkhdf", "after")):
            with h5py.File(done.directory / name, "r") as file:
                place = file["VTKHDF/Points"][()]
                pressure = file["VTKHDF/PointData/contact_pressure"][()].ravel()
            x = np.stack([column(points, f"{axis}_{when}") for axis in "xyz"], axis=1)
            at = np.linalg.norm(place - x[:, None], axis=2) < 1e-12
            self.assertTrue(at.any(axis=1).all(), name)
            shown = np.where(at, pressure, 0.0).max(axis=1)
            expected = column(points, f"pressure_{when}")
            # Files may hold single precision.
            np.testing.assert_allclose(shown, expected, rtol=1e-6, atol=1e-6 * expected.max())

    def test_gaps(self):
        done = optimised(self, PUNCH)
        results, steps, design, points = self.compare_files(done)
        change = column(points, "gap_after") - column(points, "gap_before")
        np.testing.assert_array_equal(np.sort(change), np.sort(column(design, "best")))
        self.assertAlmostEqual(column(points, "area") @ change / results["volume"], 1.0, delta=1e-13)
        # The norm with p = 8 of the table's pressures.
        area, pressure = column(points, "area"), column(points, "pressure_after")
        norm = (area @ pressure**8 / area.sum()) ** (1 / 8)
        self.assertAlmostEqual(results["cost"] / norm, 1.0, delta=1e-12)
        # The force is given: 0.05 on a length of 1; and no peak is below the mean.
        self.assertAlmostEqual(results["mean_pressure"] / 0.05, 1.0, delta=10 * TOLERANCE)
        self.assertLess(results["cost"], 1.001 * 0.05)
        self.assertGreaterEqual(results["cost"], 0.05 * (1 - 10 * TOLERANCE))
        self.assertGreater(results["peak_pressure_before"], 1.5 * 0.05)
        self.assertEqual(results["design_variables"], 9)

    def test_positions(self):
        done = optimised(self, BLOCK)
        results, steps, design, points = self.compare_files(done)
        self.assertEqual([row["y"] for row in design], ["0"] * 5)
        self.assertEqual(column(design, "x")[[0, -1]].tolist(), [0.0, 2.0])
        # At the ends of open splines the curve has their first and last factor; nodes move along -y.
        y = column(points, "y_after")
        place = column(points, "x_after")
        for end, number in ((place.argmin(), 0), (place.argmax(), -1)):
            self.assertAlmostEqual(y[end], -column(design, "best")[number], delta=1e-15)
        # The gap to the plane is what the nodes do not go down.
        np.testing.assert_allclose(column(points, "gap_after"), y, atol=1e-15)
        # Projections keep to the volume but for rounding.
        self.assertAlmostEqual(results["volume"], 0.0, delta=1e-12)
        self.assertLess(results["cost"], 0.7 * results["cost_before"])

    def test_signs(self):
        """J of a stiffer and of a softer body, and that either is what was asked for."""
        sets = {"Shape/Constraints/Volume": "{0}", "Shape/Design/Lower": "{-0.002}", "Shape/Design/Upper": "{0.002}"}
        energies = {}
        for quantity, sign in (("softest", 1), ("stiffest", -1)):
            done = optimised(self, PUNCH, sets | {"Shape/Cost/Quantity": quantity})
            results = done.summary["results"]
            self.assertAlmostEqual(results["cost"] / done.summary["energy"], sign, delta=1e-9)
            self.assertLess(results["cost"], results["cost_before"])
            self.compare_first(rows(done, "history.csv"), results)
            energies[quantity] = done.summary["energy"], sign * results["cost_before"]
        self.assertLess(energies["softest"][0], energies["stiffest"][0])
        self.assertAlmostEqual(energies["softest"][1] / energies["stiffest"][1], 1.0, delta=TOLERANCE)

    def test_ranks(self):
        for deck, counts in ((PUNCH, (2, 4)), (BLOCK, (2,))):
            first = optimised(self, deck)
            theirs, best = column(rows(first, "history.csv"), "cost"), column(rows(first, "design.csv"), "best")
            area = 1.0 / len(best)
            for np_ in counts:
                with self.subTest(deck=deck.name, ranks=np_):
                    other = optimised(self, deck, np_=np_)
                    mine = column(rows(other, "history.csv"), "cost")
                    # Solutions differ by the tolerance times the condition, some hundred; each step multiplies what was
                    # before by a few.
                    for k in range(3):
                        self.assertAlmostEqual(mine[k] / theirs[k], 1.0, delta=100 * TOLERANCE * 10**k)
                    # The norm is convex in gaps: costs differ by no more than gradient times distance, of norms weighted
                    # with areas of 2 at most.
                    distance = np.linalg.norm(column(rows(other, "design.csv"), "best") - best) * math.sqrt(2 * area)
                    slope = max(done.summary["results"]["gradient_norm"] for done in (first, other))
                    self.assertAlmostEqual(mine[-1], theirs[-1], delta=slope * distance + 100 * TOLERANCE * theirs[-1])
                    self.assertLess(distance, 0.05 * np.abs(best).max())


class Restart(Case):
    def compare(self, done, plain, deck):
        self.assertEqual(done.returncode, 0, done)
        self.assertEqual(history(done), history(plain))
        for name in ("design.csv", "shape.csv"):
            self.assertEqual((done.directory / name).read_text(), (plain.directory / name).read_text(), name)
        mine, theirs = done.summary["results"], plain.summary["results"]
        for name in ("cost", "evaluations", "peak_pressure", "refused_designs", "iterations", "cost_before"):
            self.assertEqual(mine[name], theirs[name], name)
        self.assertFalse((done.directory / "checkpoint.h5").exists())

    def test_limit_of_evaluations(self):
        for deck, sets in ((PUNCH, {}), (BLOCK, {"Shape/Design/Lower": "{-3}", "Shape/Design/Upper": "{3}"})):
            plain = optimised(self, deck, sets)
            for spent in (1, 5):
                with self.subTest(deck=deck.name, spent=spent):
                    cut = self.refused(deck, sets | {LIMIT: spent}, '"Shape/Limits/Evaluations"', "--restart", status=1)
                    self.assertEqual(cut.summary["results"]["evaluations"], spent)
                    self.assertEqual({path.name for path in cut.directory.iterdir()}, FILES | {"checkpoint.h5"})
                    done = restarted(cut.directory, {LIMIT: 0})
                    self.compare(done, plain, deck)
                    # The first one again, and those that were not there; refused ones took none.
                    again = done.summary["results"]["solutions"]
                    saved = spent - 1 - cut.summary["results"]["refused_designs"]
                    self.assertEqual(plain.summary["results"]["solutions"] - again, saved)

    def test_limit_is_of_the_whole(self):
        cut = run(PUNCH, {LIMIT: 3})
        done = restarted(cut.directory)
        self.assertEqual(done.returncode, 1, done)
        self.assertEqual(history(done), history(cut))
        done = restarted(cut.directory, {LIMIT: 6})
        self.assertEqual(done.summary["results"]["evaluations"], 6)

    def test_other_ranks(self):
        cut = run(PUNCH, {LIMIT: 6})
        done = restarted(cut.directory, {LIMIT: 0}, np_=2)
        self.assertEqual(done.returncode, 0, done)
        self.assertTrue(done.summary["converged"])
        self.assertEqual(history(done)[: len(history(cut))], history(cut))

    def test_best_design_is_kept(self):
        """Also where a method went uphill, or the optimiser has begun again."""
        uphill = {"Shape/Optimiser/Step/Type": "Spectral Gradient"}
        plain = run(PUNCH, uphill | {LIMIT: 25})
        costs = column(rows(plain, "history.csv"), "cost")
        after = [int(row["evaluations"]) for row, rise in zip(rows(plain, "history.csv")[1:], np.diff(costs)) if rise > 0]
        self.assertTrue(after, "this method no longer goes uphill here; find a case that does")
        for spent in (3, after[0]):
            cut = run(PUNCH, uphill | {LIMIT: spent})
            known = column(rows(cut, "history.csv"), "cost")
            self.assertEqual(cut.summary["results"]["cost"], known.min())
            points = rows(cut, "shape.csv")
            area, pressure = column(points, "area"), column(points, "pressure_after")
            norm = (area @ pressure**8 / area.sum()) ** (1 / 8)
            self.assertAlmostEqual(norm / known.min(), 1.0, delta=1e3 * TOLERANCE)
            self.assertEqual(known.tolist(), costs[: len(known)].tolist())

    def test_signal(self):
        # Slow enough to be met on the way.
        sets = {"Bodies/punch/Elements a side": "{16, 16, 1}", "Bodies/ground/Elements a side": "{16, 16, 1}"}
        background = runs.Background(PUNCH, sets, np=2, program="shape")
        file = background.directory / "history.csv"
        self.assertTrue(background.wait_until(lambda: file.is_file() and len(file.read_text().splitlines()) > 3),
                        background.text())
        os.kill(background.ranks()[0], signal.SIGTERM)  # the others learn of it
        self.assertEqual(background.end(), 4, background.text())
        summary = runs.json.loads((background.directory / "summary.json").read_text(encoding="utf-8"))
        self.assertFalse(summary["converged"])
        self.assertIn("stop requested", summary["reason"])
        steps = len(file.read_text().splitlines())
        self.assertTrue((background.directory / "design.csv").is_file())
        # It goes on for a few evaluations, which are those of a run that was never stopped.
        more = int(summary["results"]["evaluations"]) + 4
        done = restarted(background.directory, {LIMIT: more}, np_=2)
        plain = runs.run(PUNCH, sets | {LIMIT: more}, 2, program="shape")
        self.assertEqual(history(done), history(plain))
        self.assertGreater(len(history(done)), steps - 1)

    def test_other_deck(self):
        cut = run(PUNCH, {LIMIT: 3})
        for path, value in (("Shape/Cost/Exponent", 6), ("Shape/Design/Upper", "{0.2}"), ("Shape/Optimiser/Step/Type", "Line Search")):
            # Of lists that the first deck has not, the list.
            told = path.removesuffix("/Type")
            done = restarted(cut.directory, {path: value})
            self.assertEqual(done.returncode, 2, done)
            self.assertIn("to another deck", done.stderr)
            self.assertIn(told, done.stderr)
            self.assertTrue((done.directory / "checkpoint.h5").is_file())

    def test_damaged(self):
        cut = run(PUNCH, {LIMIT: 3})
        path = cut.directory / "checkpoint.h5"
        whole = path.read_bytes()
        for what, content in (("cut off", whole[: len(whole) // 2]), ("a bit", None)):
            if content is None:
                # A number of the record, found by its bits.
                pattern = np.float64(float(history(cut)[1]["cost"])).tobytes()
                at = whole.index(pattern)
                content = whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :]
            path.write_bytes(content)
            done = restarted(cut.directory, {LIMIT: 0})
            self.assertEqual(done.returncode, 2, (what, done))
            self.assertIn("is damaged", done.stderr)
            self.assertIn("nothing was computed", done.stderr)

    def test_seconds(self):
        cut = self.refused(PUNCH, {"Shape/Limits/Seconds": 1e-3}, '"Shape/Limits/Seconds"', status=1)
        self.assertIsNone(cut.summary["results"]["gradient_norm"])
        self.assertEqual(column(rows(cut, "design.csv"), "best").tolist(), [0.0] * 9)


class Refused(Case):
    def test_volume_that_no_design_has(self):
        for deck, volume in ((PUNCH, "{1}"), (BLOCK, "{0.5}")):
            done = self.refused(deck, {"Shape/Constraints/Volume": volume}, 'constraint "volume"', "at most", "bounds of the design")
            self.assertFalse(done.summary["converged"])
            self.assertIn("volume", done.summary["reason"])
            self.assertGreater(len(rows(done, "design.csv")), 4)

    def test_start_that_lifts_off(self):
        done = self.refused(PUNCH, HELD | {"Shape/Design/Start": "{0.05}"}, "no contact point carries a force", "Use smaller gaps")
        self.assertIn("lifted off", done.summary["reason"])

    def test_nothing_holds(self):
        done = self.refused(PUNCH, {"Effects/Traction/force/Density": "{0, 0.05, 0}"}, "unconstrained rigid-body mode")
        self.assertFalse(done.summary["converged"])

    def test_start_that_tangles(self):
        sets = {"Shape/Constraints/Volume": "{}", "Shape/Design/Lower": "{-3}", "Shape/Design/Upper": "{3}"}
        done = self.refused(BLOCK, sets | {"Shape/Design/Start": "{-0.9}"}, "tangles the mesh", 'body "block"', "quality", "bounds of the design")
        self.assertFalse((done.directory / "result.vtkhdf").exists())

    def test_steps_that_tangle(self):
        """With bounds as wide as the block is high the first step tangles it; a shorter one does not."""
        sets = {"Shape/Design/Lower": "{-3}", "Shape/Design/Upper": "{3}"}
        done = optimised(self, BLOCK, sets)
        self.assertGreater(done.summary["results"]["refused_designs"], 0)
        self.assertGreater(int(rows(done, "history.csv")[-1]["refused"]), 0)
        tight = optimised(self, BLOCK)
        self.assertEqual(tight.summary["results"]["refused_designs"], 0)
        self.assertLess(done.summary["results"]["cost"], 1.05 * tight.summary["results"]["cost"])

    def test_what_was_found_before_an_error(self):
        """A later error loses neither the record nor the best design."""
        cut = run(PUNCH, {LIMIT: 4})
        # A directory in the place of the file that is written at the end.
        copy = runs.scratch("blocked")
        shutil.copytree(cut.directory, copy)
        (copy / "shape.csv").unlink()
        (copy / "shape.csv").mkdir()
        (copy / "shape.csv" / "x").write_text("")
        done = runs.start(["--restart", copy, "--set", f"{LIMIT}=0"], np=0, program="shape")
        self.assertNotEqual(done.returncode, 0, done)
        self.assertIn("shape.csv", done.stderr)
        self.assertTrue((copy / "checkpoint.h5").is_file())
        self.assertTrue((copy / "design.csv").is_file())


class Names(Case):
    def test_unknown_names(self):
        for deck, path, value, *words in (
            (PUNCH, "Shape/Design/Contacts", "{Contact/jont}", '"Contact/joint"', "Shape/Design/Contacts"),
            (PUNCH, "Shape/Cost/Contacts", "{Contact/jont}", '"Contact/joint"', "Shape/Cost/Contacts"),
            (BLOCK, "Shape/Design/Surface", "block/botom", '"bottom"', "Shape/Design/Surface"),
            (BLOCK, "Shape/Design/Surface", "blok/bottom", '"block"'),
            (BLOCK, "Shape/Design/Surface", "bottom", "body/boundary part"),
            (BLOCK, "Shape/Design/Bodies", "{blok}", '"block"', "Shape/Design/Bodies"),
            (BLOCK, "Shape/Design/Axes", "{w}", "x, y or z"),
            (BLOCK, "Shape/Design/Axes", "{y}", "does not extend along y"),
            (BLOCK, "Shape/Design/Direction", "{0, 0, 0}", "Shape/Design/Direction", "is a zero vector"),
            (BLOCK, "Shape/Design/Pieces", "{60, 1}", "moves no node", "fewer pieces"),
            (PUNCH, "Shape/Cost/Quantity", "peak presure", '"peak pressure"'),
        ):
            with self.subTest(f"{path}={value}"):
                self.refused(deck, {path: value}, *words)
        self.refused(PUNCH, {"Shape/Cost/Quantity": "displacement", "Shape/Cost/Part": "punch/tp"}, '"top"', "Shape/Cost/Part")

    def test_parameters_of_rol(self):
        for path, value, *words in (
            ("Status Test/Gradient Tolerence", 1e-3, "ROL has no parameter", '"Gradient Tolerance"'),
            ("Step/Type", "Trust Regoin", '"Trust Region"'),
        ):
            done = self.refused(PUNCH, {"Shape/Optimiser/" + path: value}, *words)
            # Before anything is solved.
            self.assertFalse((done.directory / "before.vtkhdf").exists())
            self.refused(PUNCH, {"Shape/Optimiser/" + path: value}, *words, extra=["--check"])
        self.refused(PUNCH, {"Shape/Optimiser/Step/Type": "Interior Point"}, "non-finite", "Step/Type", "another start")
        sets = {"Shape/Optimiser/Step/Type": "Line Search", "Shape/Optimiser/Status Test/Iteration Limit": 2}
        self.refused(PUNCH, sets, "the limit of 2 iterations", status=1)

    def test_lengths(self):
        for name in ("Start", "Lower", "Upper"):
            self.refused(PUNCH, {f"Shape/Design/{name}": "{0, 0}"}, f"Shape/Design/{name}", "2 numbers", "the design 9", "one for all")
        each = "{" + ", ".join(["0.001"] * 9) + "}"
        done = run(PUNCH, {"Shape/Design/Lower": each, "Shape/Design/Start": "{0.001}", LIMIT: 2})
        self.assertEqual(column(rows(done, "design.csv"), "lower").tolist(), [0.001] * 9)
        self.refused(PUNCH, {"Shape/Design/Start": "{-1}"}, "outside its bounds")
        self.refused(PUNCH, {"Shape/Design/Lower": "{0.2}", "Shape/Design/Start": "{0.2}"}, "exceeds upper bound")
        self.refused(PUNCH, {"Shape/Constraints/Volume": "{1, 0}"}, "a minimum and a maximum")

    def test_check_and_lists(self):
        for deck in (PUNCH, BLOCK):
            done = run(deck, extra=["--check"])
            self.assertEqual(done.returncode, 0, done)
            self.assertIn("is valid", done.stdout)
            self.assertFalse(done.directory.exists())
        done = run(BLOCK, extra=["--parts"])
        self.assertIn("block/middle", done.stdout)
        printed = runs.start(["--print-parameters", "markdown"], np=0, program="shape").stdout
        for name in ("Design", "Cost", "Constraints", "Limits"):
            self.assertIn(f"## shape/Shape/{name}\n", printed)
        path = runs.scratch("deck").with_suffix(".xml")
        path.write_text(runs.start(["--print-parameters", "xml"], np=0, program="shape").stdout, encoding="utf-8")
        self.assertIn('name="Quantity"', path.read_text(encoding="utf-8"))


class Physics(Case):
    def test_friction(self):
        self.refused(PUNCH, TRESCA, "with friction", '"softest"')
        done = optimised(self, PUNCH, TRESCA | SOFT)
        self.assertLess(done.summary["results"]["cost"], done.summary["results"]["cost_before"])
        self.assertIn("Friction", done.summary["effects"])
        coulomb = {"Effects/Friction/rough/Contact": "Contact/joint", "Effects/Friction/rough/Coefficient": 0.3}
        self.refused(PUNCH, coulomb | SOFT, "Coulomb friction", "use a slip bound")

    def test_history_of_states(self):
        self.refused(PUNCH, {"Steps/Number": 3}, '"Steps"')
        glue = {
            "Contact": "Contact/joint", "Law": "brittle", "Normal stiffness": 10.0, "Tangential stiffness": 10.0,
            "Normal strength": 0.1, "Tangential strength": 0.1,
        }
        glue = {f"Effects/Adhesion/glue/{name}": value for name, value in glue.items()}
        self.refused(PUNCH, glue, "adhesion from the deck")

    def test_membranes(self):
        position = {"Shape/Design/Kind": "position", "Shape/Design/Surface": "upper/right"}
        self.refused(MEMBRANES, position, "membranes cannot be designed", "design their gaps")
        sets = {"Shape/Constraints/Volume": "{0}", "Shape/Design/Lower": "{-0.01}", "Shape/Design/Upper": "{0.01}"}
        done = optimised(self, MEMBRANES, SOFT | sets | {"Solver/Tolerance": TOLERANCE})
        self.assertLess(done.summary["results"]["cost"], done.summary["results"]["cost_before"])

    def test_mortar(self):
        mortar = {"Effects/Contact/joint/Coupling": "mortar", "Bodies/punch/Elements a side": "{3, 4, 1}"}
        position = {
            "Shape/Design/Kind": "position", "Shape/Design/Surface": "punch/bottom", "Shape/Design/Direction": "{0, -1, 0}",
            "Shape/Design/Pieces": "{3, 1}",
        }
        self.refused(PUNCH, mortar | position, "non-matching nodes", "design its gaps")
        done = optimised(self, PUNCH, mortar)
        self.assertLess(done.summary["results"]["peak_pressure"], 1.02 * 0.05)


class Factors(Case):
    def count(self, deck, sets):
        done = run(deck, sets)
        self.assertIn(done.returncode, (0, 1), done)
        return done.summary["local_factorizations"], done.summary["results"]["solutions"]

    def test_gaps_need_none(self):
        first, one = self.count(PUNCH, {LIMIT: 1})
        last, all_ = self.count(PUNCH, {})
        self.assertGreater(all_, 10 * one)
        self.assertEqual(first, last)

    def test_positions_need_those_of_what_moves(self):
        # The lower half of 4 x 2 subdomains. What is told of in the end may be solved once more.
        depth = {"Shape/Design/Depth": 0.5}
        few, some = self.count(BLOCK, depth | {LIMIT: 4})
        many, more = self.count(BLOCK, depth | {LIMIT: 12})
        self.assertEqual(more - some, 8)
        self.assertLessEqual(abs(many - few - 4 * 8), 4)


if __name__ == "__main__":
    runs.main()
