# SPDX-License-Identifier: BSD-3-Clause
"""Jobs under a real Slurm, which the test starts on this machine alone and stops again: see support/private_slurm.py.

What it guards against: what the stand-ins of test_cluster.py hide. Signals that Slurm sends elsewhere or at other times, jobs that wait for ever,
ranks that srun starts without MPI, jobs that continue each other and do not come to the answer of a run that was never stopped.

A limit of Slurm's is a minute at the least, and its signals come up to a minute early: some three minutes in all.
"""

import csv
import json
import re
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402
import private_slurm  # noqa: E402

if private_slurm.missing():
    runs.skip(private_slurm.missing())

DECK = runs.SOURCE / "apps/fiber_composite/decks/debonding.xml"
# More than a minute on two cores: longer than two jobs of a minute, whose signals come after some 30 s.
LONG = {"Model/Columns": 14, "Model/Rows": 14, "Steps/Number": 260, "Output/Fields": False}
SECONDS = 600  # that no chain takes
ENDED = ("COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL", "OUT_OF_MEMORY")


class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = runs.scratch("slurm")
        cls.slurm = cls.enterClassContext(private_slurm.PrivateSlurm(cls.place / "slurm"))
        cls.environment = {**runs.environment(), **cls.slurm.environment}

    def submit(self, *words, deck=runs.MODEL, app="signorini", sets=None):
        command = [sys.executable, runs.application("harmos-submit"), deck, "--app", runs.application(app), "--memory", "500"]
        for path, value in (sets or {}).items():
            command += ["--set", f"{path}={str(value).lower() if isinstance(value, bool) else value}"]
        return subprocess.run([*map(str, command), *map(str, words)], env=self.environment, capture_output=True, text=True,
                              timeout=runs.TIMEOUT)

    def submitted(self, *words, **more):
        done = self.submit(*words, **more)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return int(re.search(r"Submitted batch job (\d+)", done.stdout).group(1))

    def states(self, first):
        """Of this job and those after it, by their numbers."""
        return {int(number): state for number, state, *_ in self.slurm.jobs() if int(number) >= first}

    def wait_for_end(self, first, seconds=SECONDS):
        def has_ended():
            states = self.states(first)
            return states and all(state in ENDED for state in states.values())

        self.slurm.wait(has_ended, f"job {first} or one after it is not at its end", seconds)
        return self.states(first)

    def log(self, output, job):
        path = output / f"job-{job}.log"
        return path.read_text(encoding="utf-8", errors="replace") if path.exists() else "no log"

    def summary(self, output):
        return json.loads((output / "summary.json").read_text(encoding="utf-8"))

    def steps(self, output):
        """steps.csv without what time it took."""
        with open(output / "steps.csv", newline="", encoding="utf-8") as file:
            return [{key: value for key, value in row.items() if "seconds" not in key} for row in csv.DictReader(file)]

    def test_chain_of_jobs_comes_to_the_answer_of_one_run(self):
        output = self.place / "chain"
        first = self.submitted("--ranks", "2", "--time", "00:01:00", "--margin", "10", "--output", output,
                               deck=DECK, app="fiber_composite", sets=LONG)
        states = self.wait_for_end(first)
        logs = "\n".join(f"--- {job}\n{self.log(output, job)[-1500:]}" for job in states)
        summary = self.summary(output)
        self.assertTrue(summary["converged"], logs)
        *stopped, last = sorted(states)
        self.assertGreaterEqual(len(stopped), 2, logs)
        self.assertEqual(states[last], "COMPLETED", logs)
        for job in stopped:
            self.assertIn("Stopped with a checkpoint; submitted again", self.log(output, job))
        whole = runs.solved(self, DECK, LONG, program="fiber_composite")
        self.assertEqual(summary["energy"], whole.summary["energy"])
        self.assertEqual(self.steps(output), self.steps(whole.directory))
        runs.table("A run of several jobs", ("jobs", "steps", "seconds of one run"),
                   [(len(states), len(self.steps(output)), f"{whole.summary['seconds']['total']:.0f}")])

    def running(self, output):
        """A job whose run has begun to solve."""
        job = self.submitted("--ranks", "2", "--time", "00:10:00", "--margin", "60", "--resubmissions", "0", "--output", output,
                             deck=DECK, app="fiber_composite", sets=LONG)
        self.slurm.wait(lambda: (output / "steps.csv").exists() and len(self.steps(output)) > 2, "no step is done", 120)
        return job

    def test_signals_by_scancel_leave_a_checkpoint(self):
        output = self.place / "signalled"
        job = self.running(output)
        self.slurm.command("scancel", "--batch", "--signal=USR1", job)
        states = self.wait_for_end(job, 90)
        self.assertEqual(states, {job: "FAILED"}, self.log(output, job)[-2000:])  # status 4
        self.assertTrue((output / "checkpoint.h5").is_file())
        self.assertIn("go on by harmos-submit --restart", self.log(output, job))
        done = len(self.steps(output))
        # On from there, for a while.
        again = self.submitted("--ranks", "2", "--time", "00:10:00", "--resubmissions", "0", "--restart", "--output", output,
                               deck=DECK, app="fiber_composite", sets=LONG)
        self.slurm.wait(lambda: len(self.steps(output)) > done, "it does not go on", 120)
        # SIGTERM, as of a plain scancel, leaves no more than the last step's checkpoint.
        self.slurm.command("scancel", again)
        self.assertEqual(self.wait_for_end(again, 90), {again: "CANCELLED"})
        self.assertTrue((output / "checkpoint.h5").is_file())
        self.assertFalse([path for path in output.iterdir() if path.name.startswith(".")])

    def test_what_cannot_fit_is_refused(self):
        for words, said in (
            (("--memory", "5000"), "Requested node configuration is not available"),
            (("--ranks", "3"), "Requested node configuration is not available"),
            (("--time", "48:00:00"), "partition all has a time limit of 1:00:00"),
            (("--queue", "nowhere"), "nvalid partition"),
        ):
            with self.subTest(words):
                before = len(self.slurm.jobs())
                done = self.submit("--ranks", "2", "--output", self.place / "unfit", *words)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertRegex(done.stderr, "error: Slurm cannot start .*" + said)
                self.assertEqual(len(self.slurm.jobs()), before)

    def test_ranks_that_srun_starts(self):
        output = self.place / "srun"
        job = self.submitted("--ranks", "2", "--launcher", "srun", "--output", output)
        self.assertEqual(self.wait_for_end(job, 90), {job: "COMPLETED"}, self.log(output, job)[-2000:])
        self.assertEqual(self.summary(output)["ranks"], 2)
        output = self.place / "steps"
        job = self.submitted("--ranks", "2", "--launcher", "srun", "--time", "00:10:00", "--resubmissions", "0", "--output", output,
                             deck=DECK, app="fiber_composite", sets=LONG)
        self.slurm.wait(lambda: (output / "steps.csv").exists() and len(self.steps(output)) > 2, "no step is done", 120)
        self.slurm.command("scancel", "--signal=USR1", job)  # to the step, as Slurm's own signal before the limit
        self.wait_for_end(job, 90)
        self.assertTrue((output / "checkpoint.h5").is_file(), self.log(output, job)[-2000:])
        self.assertIn("go on by harmos-submit --restart", self.log(output, job))

    def test_scaling_run(self):
        output = self.place / "scaling"
        done = self.submit("--plan", "--scaling", "strong", "--ranks", "1,2", "--output", output,
                           sets={"Output/Fields": False})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"Plan for 1 ranks: \d+ MiB")
        first = int(re.search(r"Submitted batch job (\d+)", done.stdout).group(1))
        self.assertEqual(set(self.wait_for_end(first, 90).values()), {"COMPLETED"})
        for ranks in (1, 2):
            self.assertEqual(self.summary(output / f"ranks_{ranks}")["ranks"], ranks)
        drawn = subprocess.run([sys.executable, runs.application("harmos-plot"), output, "--scaling", "strong"],
                               capture_output=True, text=True)
        self.assertEqual(drawn.returncode, 0, drawn.stderr)


if __name__ == "__main__":
    runs.TIMEOUT = SECONDS
    runs.main()
