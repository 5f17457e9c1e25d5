# SPDX-License-Identifier: BSD-3-Clause
"""Runs of several steps, by decks: what they cost, what they leave behind, what stops them.

What each class guards against:

    Files     columns, keys and numbers of steps.csv, summary.json and the series of results
    Costs     factorisations after the first step, solutions that start anew; --plan without steps
    Failures  a step that fails for good where half of it does not; a run that fails and takes its
              results with it
    Restarts  a run that is taken up again between two steps or within one and comes to other
              results than one that was not
    Live      a look at a run that hides what it has
"""

import csv
import json
import os
import shutil
import signal
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

APPS = runs.SOURCE / "apps"
BLOCKS = APPS / "harmos" / "decks" / "two_blocks.xml"
DRAGGED = APPS / "harmos" / "decks" / "dragged_block.xml"
COMPOSITE = APPS / "fiber_composite" / "decks" / "composite.xml"
DEBONDING = APPS / "fiber_composite" / "decks" / "debonding.xml"
LIFTED = APPS / "harmos" / "decks" / "lifted_beam.xml"
CYLINDER = APPS / "signorini" / "decks" / "hertz_cylinder.xml"
COLUMNS = (
    "step time converged products active_sets energy external_work dissipated released "
    "closed open sticking slipping broken"
).split()


def steps_of(directory):
    with open(directory / "steps.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def summary_of(directory):
    return json.loads((directory / "summary.json").read_text(encoding="utf-8"))


def read(directory, name):
    return (directory / name).read_bytes()


def datasets(path):
    import h5py

    found = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return found


class Files(unittest.TestCase):
    def test_four_steps(self):
        tolerance = 1e-8
        one = runs.solved(self, BLOCKS, {"Solver/Tolerance": tolerance}, program="harmos")
        four = runs.solved(
            self, BLOCKS, {"Solver/Tolerance": tolerance, "Steps/Number": 4}, program="harmos"
        )
        rows = steps_of(four.directory)
        self.assertEqual([row["step"] for row in rows], ["1", "2", "3", "4"])
        self.assertEqual([float(row["time"]) for row in rows], [0.25, 0.5, 0.75, 1.0])
        names = list(rows[0])
        self.assertEqual(names[: len(COLUMNS)], COLUMNS)
        effects = list(four.summary["forces"])
        self.assertEqual(names[len(COLUMNS):], [f"{e}/f{d}" for e in effects for d in "xyz"])
        self.assertFalse((one.directory / "steps.csv").exists())
        # The same numbers in the summary, for one step too.
        self.assertEqual(len(one.summary["steps"]), 1)
        for row, told in zip(rows, four.summary["steps"], strict=True):
            self.assertEqual({k: float(v) for k, v in row.items()}, {k: float(v) for k, v in told.items()})
        last, only = four.summary["steps"][-1], one.summary["steps"][0]
        for summary in (one.summary, four.summary):
            self.assertLessEqual(summary["audit"]["balance"], 1e-8)
        self.assertAlmostEqual(four.summary["energy"] / one.summary["energy"], 1.0, delta=1e-6)
        for key in ("energy", "external_work", "Contact/joint/fy"):
            self.assertAlmostEqual(last[key] / only[key], 1.0, delta=1e-6, msg=key)
        self.assertEqual(
            four.summary["local_factorizations"], one.summary["local_factorizations"]
        )
        # Linear in the load here, so that work is energy at every step.
        for row in four.summary["steps"]:
            self.assertAlmostEqual(row["external_work"] / row["energy"], 1.0, delta=1e-6)

        series = json.loads((four.directory / "result.vtkhdf.series").read_text(encoding="utf-8"))
        self.assertEqual(series["file-series-version"], "1.0")
        self.assertEqual(
            series["files"],
            [{"name": f"result_000{k}.vtkhdf", "time": k / 4} for k in (1, 2, 3, 4)],
        )
        self.assertFalse((four.directory / "result.vtkhdf").exists())
        whole = datasets(one.directory / "result.vtkhdf")["VTKHDF/PointData/displacement"]
        for k in (1, 2, 3, 4):
            part = datasets(four.directory / f"result_000{k}.vtkhdf")["VTKHDF/PointData/displacement"]
            # A hundred for the condition of these blocks.
            self.assertLessEqual(abs(part - k / 4 * whole).max(), 1e2 * tolerance * abs(whole).max())

    def test_factors_of_histories_and_what_the_application_tells(self):
        sets = {
            "Steps/Times": "{1,2,3}",
            "Steps/Histories/press/Times": "{0,2,3}",
            "Steps/Histories/press/Values": "{0,1,-0.5}",
            "Steps/Histories/idle/Times": "{1,3}",
            "Steps/Histories/idle/Values": "{7,9}",
            "Model/History": "press",
            "Model/Interface": "tie",
            "Model/Columns": 3,
            "Model/Rows": 2,
            "Model/Cell size": 0.5,
            "Solver/Tolerance": 1e-8,
            "Output/Fields": False,
        }
        for load, sign in (("compression", -1), ("biaxial", 1)):
            with self.subTest(load=load):
                run = runs.solved(self, COMPOSITE, sets | {"Model/Load": load}, program="fiber_composite")
                rows = steps_of(run.directory)
                more = ["history/idle", "history/press", "strain", "stress"]
                more += ["stress_y"] if load == "biaxial" else []
                self.assertEqual(list(rows[0])[-len(more):], more)
                self.assertEqual([float(row["history/idle"]) for row in rows], [7, 8, 9])
                self.assertEqual([float(row["history/press"]) for row in rows], [0.5, 1, -0.5])
                for row, told in zip(rows, run.summary["steps"], strict=True):
                    # All of them are products of two numbers.
                    factor = float(row["history/press"])
                    self.assertAlmostEqual(float(row["strain"]) / (sign * 0.01 * factor), 1.0, delta=1e-15)
                    self.assertEqual({k: float(row[k]) for k in more}, {k: told[k] for k in more})
                    # Linear: twice the energy is stress times strain times area, of each direction; the error
                    # of forces is that of displacements.
                    stress = sum(float(row[k]) for k in more[3:])
                    work = stress * float(row["strain"]) * 3 * 2 * 0.5**2
                    self.assertAlmostEqual(work / (2 * float(row["energy"])), 1.0, delta=1e-6)

    def test_every_third_and_the_last(self):
        run = runs.solved(
            self, BLOCKS, {"Steps/Number": 7, "Output/Every": 3}, np=1, program="harmos"
        )
        found = sorted(path.name for path in run.directory.glob("result*"))
        self.assertEqual(
            found,
            ["result.vtkhdf.series"] + [f"result_000{k}.vtkhdf" for k in (3, 6, 7)],
        )
        # Those of an earlier run do not stay.
        again = runs.run(
            BLOCKS, {"Steps/Number": 2}, np=1, output=run.directory, program="harmos"
        )
        self.assertEqual(again.returncode, 0, again)
        found = sorted(path.name for path in run.directory.glob("result*"))
        self.assertEqual(
            found, ["result.vtkhdf.series"] + [f"result_000{k}.vtkhdf" for k in (1, 2)]
        )
        self.assertFalse((run.directory / "checkpoint.h5").exists())


class Costs(unittest.TestCase):
    def test_solutions_before_are_where_a_step_starts(self):
        for program, deck in (
            ("signorini", "model"), ("fiber_composite", "composite"), ("signorini", "hertz_ball"),
        ):
            with self.subTest(deck=deck):
                path = APPS / program / "decks" / f"{deck}.xml"
                cold = runs.solved(self, path, {"Output/Fields": False}, program=program)
                sets = {"Steps/Number": 20, "Output/Fields": False}
                run = runs.solved(self, path, sets, program=program)
                products = [row["products"] for row in run.summary["steps"]]
                mean = sum(products[1:]) / 19
                print(f"{deck}: cold {cold.summary['hessian_applications']}, steps {products}")
                self.assertLessEqual(mean, 0.6 * cold.summary["hessian_applications"])
                self.assertEqual(
                    run.summary["local_factorizations"], cold.summary["local_factorizations"]
                )

    def test_plan_counts_steps(self):
        seconds = {}
        for steps in (1, 10):
            run = runs.run(
                BLOCKS, {"Steps/Number": steps}, np=1, extra=("--plan",), program="harmos"
            )
            self.assertEqual(run.returncode, 0, run)
            plan = json.loads((run.directory / "plan.json").read_text(encoding="utf-8"))
            self.assertEqual(plan["steps"], steps)
            seconds[steps] = plan["rows"][0]["seconds"]
        # What is done once is timed anew by each plan, and as long as many steps; these come after it.
        solving = {steps: [value - told["setup"] for value in told["run"]] for steps, told in seconds.items()}
        for first, all_of_them in zip(solving[1], solving[10]):
            self.assertGreater(all_of_them, 1.5 * first)
        self.assertGreaterEqual(solving[10][0], (10 + 9 * 4) * seconds[10]["product"])


class Failures(unittest.TestCase):
    def test_a_step_that_fails_is_halved(self):
        # The second step lifts one end off. Without a limit it takes some 87 iterations, its halves 60
        # and 69, the first step 60.
        sets = {
            "Steps/Times": "{1,2}",
            "Steps/Histories/tilt/Times": "{1,2}",
            "Steps/Histories/tilt/Values": "{0,1}",
            "Effects/Traction/load/History": "constant",
            "Effects/Traction/tilt/Part": "upper/right",
            "Effects/Traction/tilt/Density": "{0,0.04,0}",
            "Effects/Traction/tilt/History": "tilt",
            "Dual operator/Preconditioner": "none",
            "Solver/Tolerance": 1e-6,
        }
        whole = runs.solved(self, BLOCKS, sets, program="harmos")
        limited = sets | {"Solver/Maximum iterations": 78}
        run = runs.solved(self, BLOCKS, limited, program="harmos")
        self.assertIn("Step 2 of 2: halved, new end time 1.5: iteration limit", run.stdout)
        rows, plain = run.summary["steps"], whole.summary["steps"]
        self.assertEqual([(row["step"], row["time"]) for row in plain], [(1, 1.0), (2, 2.0)])
        self.assertEqual(
            [(row["step"], row["time"]) for row in rows], [(1, 1.0), (2, 1.5), (2, 2.0)]
        )
        # A hundred for the condition of these blocks.
        self.assertAlmostEqual(rows[-1]["energy"] / plain[-1]["energy"], 1.0, delta=1e-4)
        self.assertEqual(rows[-1]["closed"], plain[-1]["closed"])
        # Fields of the deck's steps alone.
        self.assertEqual(
            sorted(path.name for path in run.directory.glob("result_*")),
            ["result_0001.vtkhdf", "result_0002.vtkhdf"],
        )

    def test_unloaded_steps(self):
        # Nothing but rounding errors, also of gaps, by each way to measure residuals.
        sets = {
            "Steps/Times": "{1,2,3,4}",
            "Steps/Histories/c/Times": "{0,1,2,3,4}",
            "Steps/Histories/c/Values": "{0,1,0,0,1}",
            "Effects/Traction/load/History": "c",
        }
        for rule in ("scaled", "paper", "permon"):
            run = runs.solved(
                self, BLOCKS, sets | {"Solver/Stopping rule": rule}, np=1, program="harmos"
            )
            rows = run.summary["steps"]
            self.assertEqual(len(rows), 4)
            for k in (1, 2):
                # Squares of rounding errors, with room for millions of them.
                self.assertLessEqual(abs(rows[k]["energy"]), 1e-15 * rows[0]["energy"])
            # Ten times the tolerance of decks.
            self.assertAlmostEqual(rows[3]["energy"] / rows[0]["energy"], 1.0, delta=1e-3)

    def test_a_run_that_cannot_go_on_keeps_what_it_has(self):
        # Once the load has turned nothing holds the upper block.
        run = runs.run(
            BLOCKS,
            {
                "Steps/Times": "{1.0,2.0,3.0}",
                "Steps/Smallest step": 0.25,
                "Steps/Histories/turns/Times": "{0.0,1.0,2.0,3.0}",
                "Steps/Histories/turns/Values": "{0.0,1.0,0.5,-1.0}",
                "Effects/Traction/load/History": "turns",
            },
            program="harmos",
        )
        self.assertEqual(run.returncode, 1, run)
        reason = run.summary["reason"]
        self.assertIn("step 3 of 3, from time 2.25 to 2.5 (the smallest part allowed)", reason)
        self.assertIn("unconstrained rigid-body mode under load", reason)
        self.assertIn("results up to time 2.25 are complete", reason)
        self.assertFalse(run.summary["converged"])
        rows = steps_of(run.directory)
        self.assertEqual([float(row["time"]) for row in rows], [1.0, 2.0, 2.25])
        for k in (1, 2):
            self.assertIn(
                "VTKHDF/PointData/displacement", datasets(run.directory / f"result_000{k}.vtkhdf")
            )
        self.assertFalse((run.directory / "result_0003.vtkhdf").exists())


class Continued:
    """What tests of restarts share."""

    # Contact closes bit by bit, and every step takes about a second.
    SETS = {
        "Steps/Number": 5,
        "Model/Elements per subdomain side": 18,
        "Solver/Method": "SMALBE",
        "Solver/Tolerance": 1e-8,
        "Dual operator/Preconditioner": "none",
        "Dual operator/Form": "implicit",
        "Dual operator/Local solver": "MUMPS",
        "Dual operator/Expert/Share identical subdomains": False,
    }
    # A block that is tilted: forces and displacements are known to less than the tolerance here.
    TILTED = {
        "Steps/Number": 5,
        "Steps/Histories/tilt/Times": "{0.2,1}",
        "Steps/Histories/tilt/Values": "{0,1}",
        "Effects/Traction/load/History": "constant",
        "Effects/Traction/tilt/Part": "upper/right",
        "Effects/Traction/tilt/Density": "{0,0.06,0}",
        "Effects/Traction/tilt/History": "tilt",
        "Bodies/lower/Elements a side": "{24,24,1}",
        "Bodies/upper/Elements a side": "{42,42,1}",
        "Solver/Tolerance": 1e-8,
        "Dual operator/Form": "implicit",
        "Dual operator/Local solver": "MUMPS",
        "Dual operator/Expert/Share identical subdomains": False,
    }

    def plain(self, deck, sets, program="signorini"):
        """The directory of the run that was not disturbed."""
        if deck not in self._plain:
            self._plain[deck] = runs.solved(self, deck, sets, program=program).directory
        return self._plain[deck]

    _plain = {}

    def killed(self, deck, sets, rows, program="signorini"):
        """The directory of a run that is killed when so many steps are done, in the next one."""
        run = runs.Background(deck, sets, program=program)
        path = run.directory / "steps.csv"
        run.wait_until(lambda: path.is_file() and len(path.read_bytes().splitlines()) > rows)
        time.sleep(0.05)
        for rank in run.ranks():
            os.kill(rank, signal.SIGKILL)
        self.assertNotEqual(run.end(), 0)
        self.assertEqual(len(steps_of(run.directory)), rows, "killed too late")
        return run.directory

    def restarted(self, directory, target=None, np=2, program="signorini"):
        words = ["--restart", directory, "--output", target or directory, "--quiet"]
        run = runs.start(words, np, program=program)
        self.assertEqual(run.returncode, 0, run)
        directory = Path(target or directory)
        self.assertTrue(summary_of(directory)["converged"])
        self.assertFalse((directory / "checkpoint.h5").exists())

    def same_files(self, plain, directory):
        names = [f"result_000{k}.vtkhdf" for k in range(1, 6)]
        self.assertEqual(sorted(path.name for path in directory.glob("result_*")), names)
        for one, other in zip(*(read(d, "result.vtkhdf.series") for d in (plain, directory))):
            self.assertEqual(one, other)
        return [(name, datasets(plain / name), datasets(directory / name)) for name in names]

    def same_bits(self, plain, directory):
        self.assertEqual(*(read(d, "steps.csv") for d in (plain, directory)))
        for name, one, other in self.same_files(plain, directory):
            self.assertEqual(list(one), list(other))
            for key, values in one.items():
                self.assertEqual(values.tobytes(), other[key].tobytes(), f"{name}, {key}")

    def same_within(self, plain, directory, tolerance):
        ours, others = steps_of(plain), steps_of(directory)
        self.assertEqual(len(ours), len(others))
        forces = [key for key in ours[0] if "/f" in key]
        scale = dict.fromkeys(["energy", "external_work"], float(ours[-1]["energy"]))
        scale |= dict.fromkeys(forces, max(abs(float(ours[-1][key])) for key in forces))
        for one, other in zip(ours, others):
            self.assertEqual(one["closed"], other["closed"])
            for key, size in scale.items():
                difference = abs(float(one[key]) - float(other[key]))
                self.assertLessEqual(difference, tolerance * size, f"{key}, step {one['step']}")
        for name, one, other in self.same_files(plain, directory):
            self.assertEqual(list(one), list(other))
            for key in ("displacement", "stress", "contact_pressure"):
                a, b = (d[f"VTKHDF/PointData/{key}"] for d in (one, other))
                self.assertLessEqual(abs(a - b).max(), tolerance * abs(a).max(), f"{name}, {key}")

    GLUE = "Effects/Adhesion/glue/"
    GLUED = {
        "Output/Fields": False,
        GLUE + "Contact": "joint",
        GLUE + "Normal stiffness": 10.0,
        GLUE + "Tangential stiffness": 10.0,
        GLUE + "Normal strength": 0.03,
        GLUE + "Tangential strength": 0.03,
        GLUE + "Fracture energy": 0.002,
        GLUE + "Fracture energy II": 0.002,
    }

    def stopped(self, deck, sets, rows, np=2, program="harmos"):
        """The directory of a run that is told to stop when so many steps are done, wherever it is by then."""
        run = runs.Background(deck, sets, np=np, program=program)
        path = run.directory / "steps.csv"
        run.wait_until(lambda: path.is_file() and len(path.read_bytes().splitlines()) > rows)
        os.kill(run.ranks()[0], signal.SIGTERM)
        self.assertEqual(run.end(), 4, run.text())
        return run.directory


class Restarts(Continued, unittest.TestCase):
    def test_killed_in_the_third_of_five(self):
        directory = self.killed(CYLINDER, self.SETS, 2)
        self.restarted(directory)
        self.same_bits(self.plain(CYLINDER, self.SETS), directory)

    def test_stopped_by_a_signal(self):
        run = runs.Background(CYLINDER, self.SETS)
        run.wait_until(lambda: (run.directory / "result_0001.vtkhdf").is_file())
        time.sleep(0.3)
        os.kill(run.ranks()[0], signal.SIGTERM)
        self.assertEqual(run.end(), 4, run.text())
        self.assertTrue((run.directory / "checkpoint.h5").is_file())
        self.restarted(run.directory)
        self.same_bits(self.plain(CYLINDER, self.SETS), run.directory)

    def test_a_signal_is_heard_where_steps_are_nothing(self):
        # One product a step: solvers have no time to look.
        deck = APPS / "harmos" / "decks" / "tied_inclusion.xml"
        sets = {"Steps/Number": 4000, "Output/Fields": False, "Output/Checkpoint/Steps": 0}
        run = runs.Background(deck, sets, np=1, program="harmos")
        run.wait_for("steps.csv")
        time.sleep(0.5)
        os.kill(run.ranks()[0], signal.SIGUSR1)
        self.assertEqual(run.end(seconds=20), 4, run.text())
        done = steps_of(run.directory)
        self.assertLess(len(done), 4000)
        self.assertTrue((run.directory / "checkpoint.h5").is_file())
        # A checkpoint of another problem is refused, and all stays as it was.
        words = ["--restart", run.directory, "--set", "Effects/Traction/more/Part=plate/right"]
        other = runs.start(words, 1, program="harmos")
        self.assertEqual(other.returncode, 2, other)
        self.assertEqual(steps_of(run.directory), done)
        self.assertTrue((run.directory / "checkpoint.h5").is_file())

    def test_a_limit_of_time_is_one_of_each_run(self):
        sets = {"Solver/Maximum seconds": 0.1, "Output/Fields": False, "Steps/Number": 2000}
        directory = runs.scratch("limited")
        run = runs.run(LIFTED, sets, np=1, output=directory, program="harmos")
        self.assertEqual(run.returncode, 1, run)
        self.assertIn('"Solver/Maximum seconds", 0.1, are over', run.summary["reason"])
        rows = len(steps_of(directory))
        for _ in range(3):
            runs.start(["--restart", directory, "--quiet"], 1, program="harmos")
            more = len(steps_of(directory))
            self.assertGreater(more, rows)
            rows = more

    def test_slips_go_on(self):
        """Friction: where surfaces have slipped to, and what was dissipated, bit for bit."""
        steps = 320
        sets = {"Output/Fields": False, "Steps/Number": steps}
        plain = runs.solved(self, DRAGGED, sets, np=1, program="harmos").directory
        for rows in (steps // 4, steps // 2):
            directory = self.stopped(DRAGGED, sets, rows, np=1)
            done = steps_of(directory)
            self.assertGreaterEqual(len(done), rows)
            self.assertGreater(int(done[-1]["slipping"]) + int(done[-1]["sticking"]), 0)
            self.restarted(directory, np=1, program="harmos")
            self.assertEqual(*(read(d, "steps.csv") for d in (plain, directory)))
        last = steps_of(plain)[-1]
        self.assertGreater(float(last["dissipated"]), 0.0)

    def test_damage_goes_on(self):
        """Adhesion: damage, what was dissipated and released, and the steps towards it, bit for bit."""
        steps = 160
        sets = self.GLUED | {"Steps/Number": steps}
        plain = runs.solved(self, DRAGGED, sets, np=1, program="harmos").directory
        damaged = [float(row["dissipated"]) for row in steps_of(plain)]
        # It breaks until half of the steps are done, and is let go again.
        for rows in (steps * 3 // 8, steps * 5 // 8):
            directory = self.stopped(DRAGGED, sets, rows, np=1)
            self.assertLess(len(steps_of(directory)), steps, "stopped too late")
            self.restarted(directory, np=1, program="harmos")
            self.assertEqual(*(read(d, "steps.csv") for d in (plain, directory)))
        self.assertGreater(damaged[steps // 2], damaged[steps // 4])
        self.assertEqual(damaged[-1], damaged[steps // 2])



class LongRestarts(Continued, unittest.TestCase):
    def test_killed_after_a_checkpoint_within_a_step(self):
        directory = self.killed(CYLINDER, self.SETS | {"Output/Checkpoint/Outer iterations": 1}, 2)
        # Into a directory of its own, where what was done before is brought to.
        target = runs.scratch("target")
        self.restarted(directory, target)
        self.same_bits(self.plain(CYLINDER, self.SETS), target)

    def test_taken_up_by_other_ranks(self):
        cut = self.killed(BLOCKS, self.TILTED, 2, program="harmos")
        plain = self.plain(BLOCKS, self.TILTED, program="harmos")
        for np in (1, 3):
            directory = runs.scratch("other")
            shutil.copytree(cut, directory)
            self.restarted(directory, np=np, program="harmos")
            self.same_within(plain, directory, 10 * self.TILTED["Solver/Tolerance"])

    def test_stopped_on_the_way_to_damage(self):
        """In steps of some twenty solutions: what all of them told of the bodies, bit for bit."""
        size = {"Model/Columns": 6, "Model/Rows": 6, "Output/Fields": False}
        sets = size | {"Steps/Number": 10, "Steps/End time": 1}
        plain = runs.solved(self, DEBONDING, sets, program="fiber_composite").directory
        for rows in (3, 4):
            directory = self.stopped(DEBONDING, sets, rows, program="fiber_composite")
            self.restarted(directory, program="fiber_composite")
            self.assertEqual(*(read(d, "steps.csv") for d in (plain, directory)))
            self.assertGreater(int(steps_of(plain)[rows]["active_sets"]), 5)

    def test_damage_goes_on_with_other_ranks(self):
        """Damage that grows and damage that stays, taken up by two ranks and by one: the same answers, to ten tolerances."""
        tolerance, steps = 1e-8, 160
        sets = self.GLUED | {"Solver/Tolerance": tolerance, "Steps/Number": steps}
        plain = steps_of(runs.solved(self, DRAGGED, sets, np=1, program="harmos").directory)
        numbers = [{key: float(value) for key, value in row.items()} for row in plain]
        forces = [key for key in numbers[0] if "/f" in key]
        energies = ["energy", "external_work", "dissipated", "released"]
        force = max(abs(row[key]) for row in numbers for key in forces)
        work = max(row["external_work"] for row in numbers)
        size = dict.fromkeys(forces, force) | dict.fromkeys(energies, work)
        # It is pushed until half of the steps are done, and let go again.
        for np, wanted in ((1, steps // 6), (2, steps * 5 // 8)):
            directory = self.stopped(DRAGGED, sets, wanted, np=np)
            self.assertLess(len(steps_of(directory)), steps // 2 if np == 1 else steps, "stopped too late")
            self.restarted(directory, np=3 - np, program="harmos")
            for row, other in zip(numbers, steps_of(directory), strict=True):
                for key in ("time", "closed", "open", "sticking", "slipping", "broken"):
                    self.assertEqual(row[key], float(other[key]), key)
                for key in energies + forces:
                    difference = abs(row[key] - float(other[key]))
                    self.assertLessEqual(difference, 10 * tolerance * size[key], f"{key}, step {other['step']}")
        self.assertGreater(numbers[-1]["dissipated"], numbers[steps // 6]["dissipated"])


class Live(unittest.TestCase):
    def test_springs_pull(self):
        """contact.csv while the solver works: a block that is pulled, glued to another."""
        glue = "Effects/Adhesion/glue/"
        sets = {
            "Effects/Traction/load/Density": "{0,0.001,0}",  # away, by less than the glue bears
            "Bodies/lower/Elements a side": "{24,24,1}",
            "Bodies/upper/Elements a side": "{42,42,1}",
            "Steps/Number": 200,
            "Solver/Tolerance": 1e-8,
            "Dual operator/Preconditioner": "none",
            "Output/Fields": False,
            "Output/Expert/Live seconds": 1e-3,
            "Output/Checkpoint/Steps": 0,
            glue + "Contact": "joint",
            glue + "Law": "brittle",
            **{glue + f"{way} stiffness": 10.0 for way in ("Normal", "Tangential")},
            **{glue + f"{way} strength": 1.0 for way in ("Normal", "Tangential")},
        }
        run = runs.Background(BLOCKS, sets, program="harmos")
        seen = []

        def pulls():
            try:
                text = (run.directory / "contact.csv").read_text(encoding="utf-8")
            except FileNotFoundError:
                return False
            seen[:] = [(float(row["pressure"]), row["closed"]) for row in csv.DictReader(text.splitlines())]
            return any(pressure < 0 for pressure, _ in seen)

        self.assertTrue(run.wait_until(pulls), f"{seen}\n{run.text()}")
        for rank in run.ranks():
            os.kill(rank, signal.SIGKILL)
        run.end()
        for pressure, closed in seen:
            self.assertEqual(closed, "1" if pressure > 0 else "0")


if __name__ == "__main__":
    runs.main()
