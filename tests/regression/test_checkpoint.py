# SPDX-License-Identifier: BSD-3-Clause
"""Runs that are stopped, by themselves, by a signal or by force, and taken up again.

What each class guards against:

    SameHistory  a run that is taken up again on the same or another number of ranks and takes
                 other steps, or comes to another answer; counts and histories that begin anew
    Stopped      signals that go unheard, or end a run without a checkpoint; another exit status
    Killed       a rank that dies and leaves the others waiting, or half a checkpoint
    Faults       a checkpoint that cannot be written ending the run, or taking the last one with
                 it; a damaged or foreign one that is believed
    WhileItRuns  nothing to look at before the end: iterations.csv, contact.csv, the status line
    Ranks        ranks.csv
"""

import csv
import os
import pty
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402
import inclusions  # noqa: E402

BLOCKS = runs.SOURCE / "apps" / "harmos" / "decks" / "two_blocks.xml"

# Some two hundred steps of some ten milliseconds and more, by a solver that is slow in this: long enough to be met on
# the way.
LONG = {
    "Model/Subdomains per side": 4,
    "Model/Elements per subdomain side": 24,
    "Solver/Method": "SMALBE",
    "Solver/Tolerance": 1e-8,
    "Dual operator/Preconditioner": "none",
    "Dual operator/Form": "implicit",
    "Dual operator/Local solver": "MUMPS",
    "Dual operator/Expert/Share identical subdomains": False,
}
# Some seconds, so that matplotlib is there before the end.
WATCHED = LONG | {"Model/Elements per subdomain side": 48, "Output/Expert/Live seconds": 0.1}
# The same steps in an instant.
SHORT = LONG | {"Model/Elements per subdomain side": 8, "Dual operator/Form": "condensed"}

METHODS = {
    "PDAS": {"Solver/Method": "PDAS"},
    "SMALBE": {"Solver/Method": "SMALBE"},
    "SMALBE, no preconditioner": {
        "Solver/Method": "SMALBE",
        "Dual operator/Preconditioner": "none",
    },
    "Dual Penalty": {"Solver/Method": "Dual Penalty"},
    "PDAS, then SMALBE": {"Solver/Expert/PDAS/Maximum active sets": 2},
    "PDAS, then SMALBE, kept often": {
        "Solver/Expert/PDAS/Maximum active sets": 2,
        "Output/Checkpoint/Outer iterations": 1,
    },
    "balanced": {"Solver/Tolerance rule": "balanced"},
}
# Without "seconds": everything else is to be the same.
COLUMNS = (
    "outer inner step projected_gradient equality_residual penalty M active hessian_applications"
).split()
COUNTERS = (
    "outer_iterations hessian_applications setup_applications cg_steps expansion_steps "
    "proportioning_steps faces fallbacks step_cuts confirmations"
).split()


def history(run):
    return [[row[name] for name in COLUMNS] for row in run.iterations()]


def restarted(case, directory, np=2, status=0, sets=None, words=(), program="signorini"):
    """A run that goes on from a directory, in a copy of it, with the deck that it knows."""
    copy = runs.scratch("restart")
    shutil.copytree(directory, copy)
    words = ["--restart", copy, *words]
    for path, value in (sets or {}).items():
        words += ["--set", f"{path}={value}"]
    run = runs.start(words, np=np, program=program)
    run.directory = copy
    case.assertEqual(run.returncode, status, run)
    if (copy / "summary.json").is_file():
        run.summary = runs.json.loads((copy / "summary.json").read_text())
    return run


def background(sets, np=2, words=()):
    return runs.Background(runs.MODEL, sets, np, words)


class SameHistory(unittest.TestCase):
    def compare(self, run, plain, first, exact, alike=3, delta=1e-8, rounding=0.0):
        mine, theirs = history(run), history(plain)
        if exact:
            self.assertEqual(mine, theirs, run)
            for name in COUNTERS + ["energy", "tolerance", "converged", "penalty"]:
                self.assertEqual(run.summary[name], plain.summary[name], name)
            return
        # Other ranks round differently. What was kept is kept to the last digit; the next steps
        # differ by rounding errors, which a step of conjugate gradients multiplies by no more
        # than the condition of the preconditioned operator, some hundred.
        self.assertEqual(mine[: first + 1], theirs[: first + 1])
        last = first + 1 + alike
        for row, other in zip(mine[first + 1 : last], theirs[first + 1 : last]):
            self.assertEqual(row[:3], other[:3])
            self.assertAlmostEqual(float(row[3]) / float(other[3]), 1.0, delta=delta)
        self.assertLessEqual(abs(len(mine) - len(theirs)), 0.1 * len(theirs) + 2)
        # Ten times the tolerance of both; the energy is quadratic in the error, so there is room.
        tolerance = 10.0 * plain.summary["tolerance"] + rounding
        self.assertAlmostEqual(
            run.summary["energy"] / plain.summary["energy"], 1.0, delta=tolerance
        )

    def test_history_goes_on(self):
        for name, sets in METHODS.items():
            with self.subTest(name):
                sets = {
                    "Model/Subdomains per side": 4,
                    "Model/Elements per subdomain side": 8,
                    "Solver/Tolerance": 1e-7,
                } | sets
                plain = runs.solved(self, runs.MODEL, sets)
                steps = int(plain.iterations()[-1]["inner"])
                self.assertGreater(steps, 3, plain)
                half = steps // 2
                cut = runs.run(runs.MODEL, sets | {"Solver/Maximum iterations": half})
                self.assertEqual(cut.returncode, 1, cut)
                self.assertTrue((cut.directory / "checkpoint.h5").is_file(), cut)
                for np in (2, 1, 4):
                    run = restarted(
                        self, cut.directory, np, sets={"Solver/Maximum iterations": 10000}
                    )
                    # Penalties make the condition some ten thousand times as large.
                    delta = 1e-4 if name == "Dual Penalty" else 1e-8
                    self.compare(run, plain, half, exact=np == 2, delta=delta)
                    self.assertTrue(run.summary["restarted_from"], run)
                    # It has served.
                    self.assertFalse((run.directory / "checkpoint.h5").exists(), run)

    def test_every_outer_iteration(self):
        """Checkpoints change nothing; a chain of runs comes to the same end."""
        plain = runs.solved(self, runs.MODEL, SHORT)
        every = {"Output/Checkpoint/Outer iterations": 1}
        kept = runs.solved(self, runs.MODEL, SHORT | every)
        self.compare(kept, plain, 0, exact=True)
        self.assertGreaterEqual(kept.summary["checkpoints"], 3, kept)
        directory, most, links = None, 0, 0
        while True:
            most += 15
            links += 1
            limit = {"Solver/Maximum iterations": most}
            if directory is None:
                run = runs.run(runs.MODEL, SHORT | limit)
            else:
                status = 0 if most >= len(history(plain)) else 1
                run = restarted(self, directory, status=status, sets=limit)
            directory = run.directory
            if run.returncode == 0:
                break
        self.assertGreater(links, 2)
        self.compare(run, plain, 0, exact=True)

    def test_other_tolerance(self):
        """A run that asks for more goes on to it, and ends where that tolerance alone leads."""
        plain = runs.solved(self, runs.MODEL, SHORT | {"Solver/Tolerance": 1e-10})
        cut = runs.run(runs.MODEL, SHORT | {"Solver/Maximum iterations": 20})
        run = restarted(
            self,
            cut.directory,
            sets={"Solver/Maximum iterations": 10000, "Solver/Tolerance": 1e-10},
        )
        self.assertEqual(history(run)[:20], history(plain)[:20])
        self.assertAlmostEqual(
            run.summary["energy"] / plain.summary["energy"], 1.0, delta=10.0 * 1e-10
        )

    def test_choice_is_kept(self):
        """Another machine, or another tolerance, would choose the other form; a restart keeps the first."""
        rates = runs.scratch("rates").with_suffix(".json")
        rates.write_text(runs.json.dumps({"dense_flops": 1e3, "stream_bytes": 1e3}))
        sets = SHORT | {"Dual operator/Form": "auto"}
        other = runs.solved(self, runs.MODEL, sets)
        self.assertIn("condensed", other.summary["dual_operator"])
        sets = sets | {"Dual operator/Expert/Rates": rates}
        plain = runs.solved(self, runs.MODEL, sets)
        self.assertIn("implicit", plain.summary["dual_operator"])
        cut = runs.run(runs.MODEL, sets | {"Solver/Maximum iterations": 20})
        for np in (2, 1):
            run = restarted(
                self,
                cut.directory,
                np,
                sets={"Solver/Maximum iterations": 10000, "Dual operator/Expert/Rates": ""},
            )
            self.assertIn(" as before; cost model", run.stdout)
            self.assertEqual(run.summary["dual_operator"], plain.summary["dual_operator"])
            self.compare(run, plain, 20, exact=np == 2)

    def test_inverses_of_their_own(self):
        """Where congruent subdomains share a pseudoinverse, it depends on which of them a rank has."""
        block = runs.DECKS / "block.xml"
        plain = runs.solved(self, block)
        cut = runs.run(block, {"Solver/Maximum iterations": 5})
        self.assertEqual(cut.returncode, 1, cut)
        for np in (2, 1, 3):
            run = restarted(self, cut.directory, np, sets={"Solver/Maximum iterations": 10000})
            # The direction that was kept is stepped along; the next one is another, for the Schur complements
            # of the preconditioner are those on the common boundary of what a rank has of a class.
            self.compare(run, plain, 5, exact=np == 2, alike=1)

    def test_scene(self):
        """Of the harmos app, three-dimensional bodies in contact."""
        plain = runs.solved(self, BLOCKS, program="harmos")
        steps = int(plain.iterations()[-1]["inner"])
        cut = runs.run(BLOCKS, {"Solver/Maximum iterations": steps // 2}, program="harmos")
        run = restarted(self, cut.directory, sets={"Solver/Maximum iterations": 10000}, program="harmos")
        self.compare(run, plain, steps // 2, exact=True)

    def test_chosen_subdomains_are_kept(self):
        """`auto` chooses by the number of ranks: a restart on others goes on with what the run before chose."""
        sets = {"Bodies/block/Subdomains": "auto", "Output/Fields": False}
        deck = runs.SOURCE / "apps/harmos/decks/punch.xml"
        number = {np: runs.solved(self, deck, sets, np=np, program="harmos").summary["subdomains"] for np in (1, 4)}
        self.assertNotEqual(number[1], number[4])
        cut = runs.run(deck, {**sets, "Solver/Maximum iterations": 2}, np=4, program="harmos")
        self.assertTrue((cut.directory / "checkpoint.h5").is_file(), cut)
        run = restarted(self, cut.directory, 1, sets={"Solver/Maximum iterations": 10000}, program="harmos")
        self.assertEqual(run.summary["subdomains"], number[4])
        self.assertTrue(run.summary["restarted_from"], run)

    def test_adaptive_vectors(self):
        """Vectors are made anew, before the first step of the run that goes on: with those that it had, it takes the same steps."""
        deck = inclusions.Inclusions(2, 6, 10, 1e6, "scattered").write(runs.scratch("inclusions"))
        sets = {"Dual operator/Expert/Adaptive coarse vectors": "auto", "Output/Fields": False}
        plain = runs.solved(self, deck, sets, program="harmos")
        made = 80  # products for four digits, at 20 each
        steps = int(plain.iterations()[-1]["inner"])
        self.assertGreater(plain.summary["adaptive_vectors"], 0)
        self.assertGreater(steps, made + 4)
        for first in (made - 20, made + 3):
            with self.subTest(first=first):
                cut = runs.run(deck, sets | {"Solver/Maximum iterations": first}, program="harmos")
                self.assertEqual(cut.returncode, 1, cut)
                self.assertEqual(cut.summary["adaptive_vectors"] > 0, first > made)
                sets_on = {"Solver/Maximum iterations": 10000}
                run = restarted(self, cut.directory, sets=sets_on, program="harmos")
                self.compare(run, plain, first, exact=True)
                # On other ranks there are other vectors: with these the solver begins anew.
                other = restarted(self, cut.directory, 1, sets=sets_on, program="harmos")
                self.assertAlmostEqual(other.summary["energy"] / plain.summary["energy"], 1.0, delta=1e-3)
                self.assertEqual("starts again" in other.stdout, first > made)

    def test_vectors_that_were_left(self):
        """A run that is asked for more than its vectors let it have has left them: it goes on without, on any ranks."""
        sets = {"Dual operator/Expert/Adaptive coarse vectors": "all", "Solver/Tolerance": 1e-14, "Output/Fields": False}
        # When they are left hangs on rounding errors, with some kernels of BLAS but a step before the end.
        for jump in (1e6, 3e6, 3e5, 1e7):
            deck = inclusions.Inclusions(2, 6, 10, jump, "scattered").write(runs.scratch("inclusions"))
            plain = runs.run(deck, sets, program="harmos")
            self.assertIn("continue without them", plain.stdout)
            self.assertIn("stagnation", plain.summary["reason"])
            self.assertLess(plain.summary["audit"]["gluing_jump"], 1e-12)
            left = max(int(row["inner"]) for row in plain.iterations() if row["step"] == "start")
            first = (left + int(plain.iterations()[-1]["inner"])) // 2
            if first >= left + 10:
                break
        self.assertGreaterEqual(first, left + 10)
        cut = runs.run(deck, sets | {"Solver/Maximum iterations": first}, program="harmos")
        self.assertIn("continue without them", cut.stdout)
        for np in (2, 1):
            run = restarted(self, cut.directory, np, 1, {"Solver/Maximum iterations": 10000}, program="harmos")
            self.assertNotIn("daptive", run.stdout)
            # Rounding of K: ε times the jump of moduli, ten for sums.
            self.compare(run, plain, first, exact=np == 2, rounding=2.2e-15 * jump)


class Stopped(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plain = runs.run(runs.MODEL, LONG)

    def stop(self, send):
        run = background(LONG | {"Output/Checkpoint/Outer iterations": 1})
        self.assertTrue(run.wait_for("checkpoint.h5"), run.text())
        send(run)
        self.assertEqual(run.end(), 4, run.text())
        text = run.text()
        self.assertIn("continue with --restart", text)
        summary = runs.json.loads((run.directory / "summary.json").read_text())
        self.assertFalse(summary["converged"])
        self.assertTrue(summary["reason"].startswith("interrupted"), summary["reason"])
        self.assertIsNone(summary["audit"])
        self.assertEqual(summary["results"], {})
        again = restarted(self, run.directory)
        self.assertEqual(history(again), history(self.plain), text)
        self.assertEqual(again.summary["energy"], self.plain.summary["energy"])

    def test_signal_to_the_launcher(self):
        self.stop(lambda run: run.process.send_signal(signal.SIGUSR1))

    def test_signal_to_one_rank(self):
        """The others learn of it."""
        self.stop(lambda run: os.kill(run.ranks()[0], signal.SIGTERM))

    def test_signal_before_the_solver(self):
        """Heard as soon as there is a line of output, obeyed when there is something to keep."""
        run = background(LONG)
        end = time.monotonic() + 60
        while "Harmos" not in run.text():
            self.assertLess(time.monotonic(), end, run.text())
            time.sleep(0.002)
        # The rank that printed: another one may not be as far.
        first = [
            rank
            for rank in run.ranks()
            if b"OMPI_COMM_WORLD_RANK=0\0" in Path(f"/proc/{rank}/environ").read_bytes()
        ]
        os.kill(first[0], signal.SIGUSR1)
        self.assertEqual(run.end(), 4, run.text())
        again = restarted(self, run.directory)
        self.assertEqual(history(again), history(self.plain), run.text())

    def test_checkpoint_on_request(self):
        run = background(LONG)
        self.assertTrue(run.wait_for("iterations.csv"), run.text())
        for rank in run.ranks():
            os.kill(rank, signal.SIGUSR2)
        self.assertEqual(run.end(), 0, run.text())
        self.assertIn("Checkpoint at iteration", run.text())

    def test_minutes(self):
        run = runs.solved(self, runs.MODEL, LONG | {"Output/Checkpoint/Minutes": 1e-3})
        self.assertGreater(run.summary["checkpoints"], 0, run)
        self.assertEqual(history(run), history(self.plain))

    def test_time_limit(self):
        """What a limit of time ends is kept too, and the limit is of each run alone."""
        limit = {"Solver/Maximum seconds": 0.1}
        run = runs.run(runs.MODEL, LONG | limit)
        self.assertEqual(run.returncode, 1, run)
        self.assertTrue((run.directory / "checkpoint.h5").is_file(), run)
        again = restarted(self, run.directory, sets={"Solver/Maximum seconds": 0})
        self.assertEqual(history(again), history(self.plain))


class Killed(unittest.TestCase):
    def test_rank_dies(self):
        plain = runs.run(runs.MODEL, LONG)
        run = background(LONG | {"Output/Checkpoint/Outer iterations": 1})
        self.assertTrue(run.wait_for("checkpoint.h5"), run.text())
        time.sleep(0.05)
        os.kill(run.ranks()[-1], signal.SIGKILL)
        # No rank is left waiting: the launcher ends them all.
        self.assertNotEqual(run.end(60), 0, run.text())
        self.assertEqual(run.ranks(), [])
        # A file that was being written is no checkpoint; the last whole one is there.
        for np in (2, 1):
            again = restarted(self, run.directory, np)
            self.assertAlmostEqual(
                again.summary["energy"] / plain.summary["energy"], 1.0, delta=10.0 * 1e-8
            )
            if np == 2:
                self.assertEqual(history(again), history(plain))


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cut = runs.run(runs.MODEL, SHORT | {"Solver/Maximum iterations": 20})
        cls.on = {"Solver/Maximum iterations": 10000}

    def damaged(self, damage):
        """A restart from a checkpoint to which something was done; its error."""
        copy = runs.scratch("damaged")
        shutil.copytree(self.cut.directory, copy)
        path = copy / "checkpoint.h5"
        damage(path)
        before = path.read_bytes()
        run = restarted(self, copy, status=2, sets=self.on)
        self.assertEqual(len(run.errors), 1, run)
        # Nothing was computed, and nothing lost.
        self.assertNotIn("local factorisations", run.stdout)
        self.assertEqual((run.directory / "checkpoint.h5").read_bytes(), before)
        return run.errors[0]

    def test_every_kind_of_damage(self):
        whole = (self.cut.directory / "checkpoint.h5").read_bytes()

        def cut_short(path):
            path.write_bytes(whole[: len(whole) // 2])

        def emptied(path):
            path.write_bytes(b"")

        def text(path):
            path.write_text("not an HDF5 file\n")

        for damage in (cut_short, emptied, text):
            with self.subTest(damage.__name__):
                error = self.damaged(damage)
                self.assertIn("is damaged", error)
                self.assertIn("without --restart", error)

    def test_a_bit_of_any_data(self):
        try:
            import h5py
        except ImportError:
            self.skipTest("the Python module h5py is missing")
        names = []
        with h5py.File(self.cut.directory / "checkpoint.h5", "r") as file:
            file.visititems(lambda name, item: names.append(name) if hasattr(item, "shape") else None)
        self.assertIn("vectors/x", names)
        for name in ("vectors/x", "vectors/gradient", "numbers", "texts/deck", "checksums", "lengths"):
            with self.subTest(name):

                def flip(path, name=name):
                    with h5py.File(path, "r+") as file:
                        data = file[name][...]
                        bits = data.view("uint8").reshape(-1)
                        bits[len(bits) // 2] ^= 1
                        file[name][...] = data

                error = self.damaged(flip)
                self.assertIn("is damaged", error)
                if name not in ("checksums", "lengths"):
                    self.assertIn("checksum", error)

    def test_no_checkpoint(self):
        run = restarted(self, Path(runs.solved(self, runs.MODEL, SHORT).directory), status=2,
                        words=[runs.MODEL])
        self.assertIn("checkpoint not found", run.errors[0])

    def test_earlier_run(self):
        """Its checkpoint is put aside, not lost, and not taken for one of the new run."""
        copy = runs.scratch("earlier")
        shutil.copytree(self.cut.directory, copy)
        before = (copy / "checkpoint.h5").read_bytes()
        runs.solved(self, runs.MODEL, SHORT | {"Model/Interface": "tie", "Solver/Method": "Auto"},
                    output=copy)
        self.assertFalse((copy / "checkpoint.h5").exists())
        self.assertEqual((copy / "checkpoint.previous.h5").read_bytes(), before)

    def test_directory_of_one_rank(self):
        """One that the other rank does not see: an error on both, and no rank waits."""
        places = [runs.scratch("place") for _ in range(2)]
        command = [runs.MPIEXEC]
        for rank, place in enumerate(places):
            place.mkdir()
            command += [":"] * rank + ["-n", "1", "-wdir", place, runs.application(), runs.MODEL]
            command += ["--output", "run"]
        status, out, err = runs.execute(command)
        self.assertEqual(status, 2, out + err)
        self.assertIn("cannot be written by all ranks", err)
        self.assertIn("that all nodes share", err)

    def test_other_mesh(self):
        """A mesh file that was changed by a ten-thousandth between the two runs."""
        place = runs.scratch("mesh")
        shutil.copytree(BLOCKS.parent, place)
        deck = place / "punch.xml"
        cut = runs.run(deck, {"Solver/Maximum iterations": 3}, program="harmos")
        self.assertTrue((cut.directory / "checkpoint.h5").is_file(), cut)
        mesh = place / "punch.geo"
        text = mesh.read_text()
        self.assertIn("0.8", text)
        mesh.write_text(text.replace("0.8", "0.80008"))
        run = restarted(self, cut.directory, status=2, program="harmos")
        self.assertIn("belongs to another problem", run.errors[0])

    def test_other_deck(self):
        run = restarted(
            self,
            self.cut.directory,
            status=2,
            sets=self.on | {"Model/Elements per subdomain side": 4},
        )
        self.assertIn("belongs to another deck", run.errors[0])
        self.assertIn('"Model/Elements per subdomain side" was 8, is 4', run.errors[0])
        self.assertTrue((run.directory / "checkpoint.h5").is_file())

    def test_disk_is_full(self):
        """Files of at most 30 kB, which no checkpoint of this run is: it goes on without."""
        sets = LONG | {"Output/Checkpoint/Outer iterations": 1, "Output/Fields": False}
        run = background(sets)
        self.assertTrue(run.wait_for("iterations.csv"), run.text())
        for rank in run.ranks():
            resource.prlimit(rank, resource.RLIMIT_FSIZE, (30000, 30000))
        self.assertEqual(run.end(), 0, run.text())
        self.assertIn("warning: no checkpoint: ", run.text())
        self.assertIn("the disk is not full", run.text())
        left = sorted(path.name for path in run.directory.iterdir())
        self.assertEqual(left, ["iterations.csv", "summary.json"], run.text())

    def test_place_is_taken(self):
        """The last checkpoint stays where the next one cannot be written."""
        copy = runs.scratch("taken")
        shutil.copytree(self.cut.directory, copy)
        (copy / "checkpoint.h5.part").mkdir()
        before = (copy / "checkpoint.h5").read_bytes()
        run = restarted(self, copy, status=1, sets={"Solver/Maximum iterations": 30})
        self.assertIn("warning: no checkpoint: ", run.stderr)
        self.assertEqual((run.directory / "checkpoint.h5").read_bytes(), before)


class WhileItRuns(unittest.TestCase):
    def test_files_grow(self):
        run = background(WATCHED)
        self.assertTrue(run.wait_for("contact.csv"), run.text())
        seen = []
        while run.process.poll() is None:
            try:
                with open(run.directory / "iterations.csv", newline="", encoding="utf-8") as file:
                    seen.append(len(list(csv.DictReader(file))))
                contact = (run.directory / "contact.csv").read_text().splitlines()
            except FileNotFoundError:
                break  # the end
            self.assertEqual(contact[0], "x,y,z,pressure,closed")
            self.assertEqual(len(contact), 1 + 4 * WATCHED["Model/Elements per subdomain side"] + 1)
            time.sleep(0.05)
        self.assertEqual(run.end(), 0, run.text())
        self.assertEqual(seen, sorted(seen))
        self.assertGreater(len(set(seen)), 2, seen)
        left = sorted(path.name for path in run.directory.iterdir())
        self.assertEqual(left, sorted(runs.RESULTS))

    def test_pictures_follow(self):
        """harmos-plot --follow, begun before there is anything to see."""
        try:
            import matplotlib  # noqa: F401
            import numpy  # noqa: F401
        except ImportError as missing:
            self.skipTest(f"the Python module {missing.name} is missing")
        run = background(WATCHED)
        pictures = runs.scratch("pictures")
        tool = runs.application("harmos-plot")
        words = [sys.executable, tool, run.directory, "--follow", "--interval", 0.1]
        status, out, err = runs.execute([*words, "--output", pictures, "--dpi", 50])
        self.assertEqual(run.end(), 0, run.text())
        self.assertEqual(status, 0, err)
        for name in ("convergence.png", "contact.png", "solution.png"):
            self.assertTrue((pictures / name).is_file(), out)
        # Drawn while it ran, and once more at its end.
        self.assertGreaterEqual(out.count("contact.png"), 1, out)
        self.assertGreaterEqual(out.count("convergence.png"), 2, out)

    def test_status_line(self):
        """On a terminal, and only there; the launcher's terminal is what counts."""
        master, slave = pty.openpty()
        directory = runs.scratch("terminal")
        command = [*runs.launcher(2), runs.application(), runs.MODEL, "--output", directory]
        for path, value in (WATCHED | {"Steps/Number": 2}).items():
            command += ["--set", f"{path}={str(value).lower() if value is False else value}"]
        process = subprocess.Popen(
            [str(word) for word in command],
            env=runs.environment(),
            stdin=subprocess.DEVNULL,
            stdout=slave,
            stderr=subprocess.STDOUT,
        )
        os.close(slave)
        shown = b""
        while True:
            try:
                part = os.read(master, 65536)
            except OSError:
                break
            if not part:
                break
            shown += part
        self.assertEqual(process.wait(), 0)
        text = shown.decode(errors="replace")
        lines = re.findall(r"step 1/2 t 0.5  SMALBE \d+/\d+  [^|]* s[^|]*  \|g\^P\| \S+/\S+  \|G l\| ", text)
        self.assertGreater(len(lines), 2, text)
        self.assertIn("\r\x1b[K", text)
        self.assertEqual(len(re.findall("Step [12] of 2, time", text)), 2, text)
        # The table gives way to it.
        self.assertNotIn("outer  inner  step", text)
        piped = runs.solved(self, runs.MODEL, SHORT)
        self.assertNotIn("\r\x1b[K", piped.stdout)
        self.assertIn("outer  inner  step", piped.stdout)


class Ranks(unittest.TestCase):
    def test_table(self):
        run = runs.solved(self, runs.MODEL, SHORT | {"Output/Expert/Rank diagnostics": True}, np=3)
        with open(run.directory / "ranks.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["rank"] for row in rows], ["0", "1", "2"])
        total = {name: sum(float(row[name]) for row in rows) for name in rows[0] if name != "host"}
        self.assertEqual(total["subdomains"], run.summary["subdomains"])
        self.assertEqual(total["primal_dimension"], run.summary["primal_dimension"])
        # Of nine digits each.
        self.assertAlmostEqual(
            total["peak_memory_mib"] / run.summary["peak_memory_mib"], 1.0, delta=1e-6
        )
        self.assertTrue(all(float(row["solve"]) > 0.0 for row in rows))
        plain = runs.solved(self, runs.MODEL, SHORT)
        self.assertFalse((plain.directory / "ranks.csv").exists())


if __name__ == "__main__":
    runs.main()
