# SPDX-License-Identifier: BSD-3-Clause
"""Jobs on clusters: what harmos-submit hands to a scheduler, and scaling runs to their picture.

Schedulers, and where a signal is to be seen also the program, are small scripts put first on PATH;
the job scripts are run as they are.

What each class guards against:

    Scripts     templates with gaps or that the shell cannot read; limits, threads or signals that
                are not in them; requests that make no sense and are submitted all the same
    Chain       jobs that stop with a checkpoint and are not continued, continue without it,
                continue for ever, or hide how they ended; signals that do not reach the ranks
    Scaling     runs that are not those asked for; efficiencies that are not what their names say
"""

import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

SUBMIT = {"slurm": "sbatch", "pbs": "qsub"}

# A scheduler that writes down its words and then runs the script with the environment that was
# asked for. SIGNAL_AFTER: seconds after which Slurm signals the batch script, as with --signal=B:.
FAKE_SCHEDULER = r"""#!/bin/bash
if [ "$1" = --test-only ]; then
  echo "sbatch: Job 1 to start now" >&2
  exit "${NO_PLACE:-0}"
fi
printf '%s\n' "$*" >> "$RECORD/submissions"
script="${@: -1}"
for word in "$@"; do
  case "$word" in
    *HARMOS_RESUBMISSION=*) export HARMOS_RESUBMISSION="${word##*=}" ;;
  esac
done
export SLURM_JOB_ID=7 PBS_JOBID=7.server
bash "$script" > "$RECORD/log.${HARMOS_RESUBMISSION:-0}" 2>&1 &
job=$!
if [ -n "${SIGNAL_AFTER:-}" ]; then
  ( sleep "$SIGNAL_AFTER"; kill -USR1 "$job" ) 2> /dev/null &
fi
wait "$job"
echo $? >> "$RECORD/statuses"
exit 0
"""

# mpirun that writes down its words and leaves with the next of the statuses in $RECORD/plan.
FAKE_MPIRUN = r"""#!/bin/bash
printf '%s\n' "$*" >> "$RECORD/runs"
status=$(head -n 1 "$RECORD/plan")
sed -i 1d "$RECORD/plan"
exit "${status:-0}"
"""

# A program that leaves a checkpoint and status 4 when it is signalled, and 0 when it is continued.
STOPPABLE = r"""#!/bin/bash
case "$*" in *--restart*) exit 0 ;; esac
trap 'echo signalled >> "$RECORD/ranks"; exit 4' USR1
for _ in $(seq 600); do sleep 0.1; done
exit 1
"""


class Place(unittest.TestCase):
    def setUp(self):
        self.place = runs.scratch("cluster")
        (self.place / "bin").mkdir(parents=True)
        self.output = self.place / "out"
        self.environment = {
            **runs.environment(),
            "PATH": f"{self.place / 'bin'}:{os.environ['PATH']}",
            "RECORD": str(self.place),
        }

    def program(self, name, text):
        path = self.place / "bin" / name
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)
        return path

    def submit(self, *words, deck=runs.MODEL, app=None):
        command = [
            sys.executable,
            runs.application("harmos-submit"),
            deck,
            "--app",
            app or runs.application(),
            "--output",
            self.output,
        ]
        command += words
        return subprocess.run(
            [str(word) for word in command],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=runs.TIMEOUT,
        )

    def lines(self, name):
        path = self.place / name
        return path.read_text(encoding="utf-8").splitlines() if path.exists() else []


class Scripts(Place):
    WORDS = (
        "--ranks", "10", "--ranks-per-node", "4", "--time", "02:30:00", "--margin", "240",
        "--memory", "1500", "--queue", "long", "--account", "p42", "--module", "openmpi/4.1",
        "--module", "gcc", "--resubmissions", "3", "--set", "Model/Subdomains per side=8",
        "--job-name", "study",
    )  # fmt: skip

    def script(self, scheduler, *more):
        done = self.submit(*self.WORDS, "--dry-run", "--scheduler", scheduler, *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse(self.output.exists(), "a dry run left files")
        return done.stdout

    def assert_good(self, text):
        self.assertNotRegex(text, r"@\w+@")
        checked = subprocess.run(["bash", "-n"], input=text, capture_output=True, text=True)
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))
        # Lines of the scheduler count before the first command only.
        first = next(i for i, line in enumerate(text.splitlines()) if line and line[0] != "#")
        for line in text.splitlines()[first:]:
            self.assertNotRegex(line, "^#(SBATCH|PBS)")
        for line in (
            "export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1",
            "module load openmpi/4.1",
            "module load gcc",
            "most=3",
        ):
            self.assertIn(line, text.splitlines())
        program = [runs.application(), str(runs.MODEL), "--output", str(self.output)]
        program += ["--set", "Model/Subdomains per side=8"]
        self.assertIn(shlex.join(program), text)
        self.assertIn("mpirun -np 10 --map-by core --bind-to core", text)

    def test_slurm(self):
        text = self.script("slurm")
        self.assert_good(text)
        wanted = {
            "job-name=study", "ntasks=10", "ntasks-per-node=4", "cpus-per-task=1", "time=02:30:00",
            "mem-per-cpu=1500M", f"output={self.output}/job-%j.log", "signal=B:USR1@240",
            "partition=long", "account=p42",
        }  # fmt: skip
        self.assertEqual(set(re.findall("^#SBATCH --(.*)$", text, re.M)), wanted)

    def test_slurm_with_srun_has_its_steps_signalled(self):
        text = self.script("slurm", "--launcher", "srun")
        self.assertIn("#SBATCH --signal=USR1@240\n", text)
        self.assertIn("srun --mpi=pmix --cpu-bind=cores", text)
        self.assertIn("srun --mpi=pmi2 ", self.script("slurm", "--launcher", "srun", "--mpi", "pmi2"))

    def test_pbs(self):
        text = self.script("pbs")
        self.assert_good(text)
        wanted = {
            "-N study", "-l walltime=02:30:00", "-j oe", f"-o {self.output}/job.log",
            "-S /bin/bash", "-q long", "-A p42",
            # Ten ranks on nodes of four: two whole ones and half of one.
            "-l select=2:ncpus=4:mpiprocs=4:mem=6000mb+1:ncpus=2:mpiprocs=2:mem=3000mb",
        }  # fmt: skip
        self.assertEqual(set(re.findall("^#PBS (.*)$", text, re.M)), wanted)
        self.assertIn(f"timeout --foreground --preserve-status -s USR1 {9000 - 240} mpirun", text)

    def test_without_options_no_line_asks_for_them(self):
        for scheduler, marks in (("slurm", ("partition", "account")), ("pbs", ("-q", "-A"))):
            done = self.submit("--dry-run", "--scheduler", scheduler)
            self.assertEqual(done.returncode, 0, done.stderr)
            for mark in marks:
                self.assertNotRegex(done.stdout, f"(?m)^#(SBATCH --|PBS ){mark}")

    def refused(self, *words, message, **more):
        done = self.submit(*words, **more)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(message, done.stderr)
        self.assertFalse(self.output.exists())

    def test_requests_that_make_no_sense(self):
        self.refused("--ranks", "0", "--dry-run", message="not a list of positive numbers")
        self.refused("--ranks", "1,2", "--dry-run", message="need --scaling strong or --scaling weak")
        self.refused("--time", "soon", "--dry-run", message='--time "soon" is not a valid time')
        self.refused("--time", "00:05:00", "--dry-run", message="--margin 300 must lie between")
        self.refused("--job-name", "my job", "--dry-run", message="contains blanks")
        self.refused("--scaling", "weak", "--dry-run", message="needs a --set that depends on ranks")
        self.refused("--set", "A={ranks.x}", "--dry-run", message="not an expression in ranks")
        self.refused("--memory", "0", "--dry-run", message="--memory 0 is too small")
        self.refused("--dry-run", message="deck not found", deck="missing.xml")
        self.refused("--dry-run", message="program not found", app="/nowhere/harmos")
        self.refused("--launcher", "srun", "--local", message="belongs to Slurm")

    def test_no_scheduler(self):
        if shutil.which("sbatch") or shutil.which("qsub"):
            self.skipTest("there is a scheduler here")
        self.refused(message="neither sbatch nor qsub is on PATH")
        self.refused("--scheduler", "pbs", message="no qsub is on PATH")


class Chain(Place):
    def chain(self, scheduler, statuses, *words):
        self.program(SUBMIT[scheduler], FAKE_SCHEDULER)
        self.program("mpirun", FAKE_MPIRUN)
        (self.place / "plan").write_text("\n".join(map(str, statuses)) + "\n", encoding="utf-8")
        done = self.submit("--ranks", "2", "--scheduler", scheduler, *words)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_checkpoints_are_continued(self):
        for scheduler in SUBMIT:
            with self.subTest(scheduler=scheduler):
                self.setUp()
                self.chain(scheduler, [4, 4, 0])
                submissions, started = self.lines("submissions"), self.lines("runs")
                self.assertEqual((len(submissions), len(started)), (3, 3))
                script = str(self.output / f"harmos.{scheduler}")
                self.assertEqual(submissions[0], script)
                for number, line in enumerate(submissions[1:], start=1):
                    self.assertIn("afterany:7", line)
                    self.assertIn(f"HARMOS_RESUBMISSION={number}", line)
                    self.assertTrue(line.endswith(script))
                restart = f"--restart {self.output}"
                self.assertEqual([restart in line for line in started], [False, True, True])
                for line in started:
                    self.assertIn(f"{runs.application()} {runs.MODEL} --output {self.output}", line)
                # The innermost job ends first.
                self.assertEqual(self.lines("statuses"), ["0", "4", "4"])

    def test_other_ends_are_told_and_not_repeated(self):
        for status in (0, 1, 2, 3, 137):
            with self.subTest(status=status):
                self.setUp()
                self.chain("slurm", [status])
                self.assertEqual(len(self.lines("submissions")), 1)
                self.assertEqual(self.lines("statuses"), [str(status)])

    def test_number_of_resubmissions_is_limited(self):
        self.chain("pbs", [4] * 9, "--resubmissions", "2")
        self.assertEqual(len(self.lines("runs")), 3)
        self.assertIn("after 2 resubmissions", self.lines("log.2")[-1])

    def test_restart_is_continued_from_the_first_job_on(self):
        self.chain("slurm", [4, 4, 4], "--resubmissions", "1", "--restart")
        started = self.lines("runs")
        self.assertEqual(len(started), 2)
        for line in started:
            self.assertIn(f"--restart {self.output}", line)

    def signalled(self, scheduler, *words, after=""):
        self.program(SUBMIT[scheduler], FAKE_SCHEDULER)
        app = self.program("stoppable", STOPPABLE)
        self.environment["SIGNAL_AFTER"] = after
        done = self.submit("--ranks", "2", "--bind", "none", "--scheduler", scheduler, *words, app=app)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.lines("statuses"), ["0", "4"], self.lines("log.0"))
        self.assertEqual(len(self.lines("submissions")), 2)
        self.assertTrue(self.lines("ranks"))

    def test_signal_to_the_script_reaches_the_ranks(self):
        """With the real mpirun, whose status is that of the ranks."""
        self.signalled("slurm", after="2")

    def test_time_limit_of_pbs_signals_the_ranks(self):
        self.signalled("pbs", "--time", "00:01:02", "--margin", "60")


class Before(Place):
    """What is asked before anything is submitted."""

    def test_jobs_without_a_place_are_not_submitted(self):
        self.program("sbatch", FAKE_SCHEDULER)
        self.environment["NO_PLACE"] = "1"
        done = self.submit("--ranks", "2", "--scheduler", "slurm")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn("Slurm cannot start 2 ranks", done.stderr)
        self.assertFalse(self.lines("submissions"))

    def test_plan(self):
        words = ("--plan", "--ranks", "2", "--dry-run", "--scheduler", "slurm")
        done = self.submit(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        needed = int(re.search(r"Plan for 2 ranks: (\d+) MiB", done.stdout).group(1))
        self.assertIn(f"#SBATCH --mem-per-cpu={needed}M\n", done.stdout)
        self.assertTrue(30 < needed < 300, needed)
        # Each plan measures what its own process takes, which differs by some MiB from one start to the next.
        done = self.submit(*words, "--memory", str(needed // 2))
        self.assertEqual(done.returncode, 1)
        told = re.search(r"less than the (\d+) that the run needs", done.stderr)
        self.assertTrue(told, done.stderr)
        self.assertAlmostEqual(int(told.group(1)), needed, delta=0.2 * needed)
        done = self.submit(*words, "--set", "Model/Problem=nothing")
        self.assertEqual(done.returncode, 1)
        self.assertIn("the plan failed: error: ", done.stderr)


class Scaling(Place):
    TINY = ("--set", "Model/Elements per subdomain side=4", "--set", "Output/Fields=false")

    def collect(self, kind):
        drawn = subprocess.run(
            [sys.executable, runs.application("harmos-plot"), self.output, "--scaling", kind],
            capture_output=True,
            text=True,
        )
        if "cannot import" in drawn.stderr:
            self.skipTest(drawn.stderr.splitlines()[-1])
        return drawn

    def rows(self):
        with open(self.output / "scaling.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_strong_scaling_ends_in_table_and_picture(self):
        done = self.submit("--local", "--scaling", "strong", "--ranks", "1,2", *self.TINY)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        for ranks in (1, 2):
            summary = json.loads(
                (self.output / f"ranks_{ranks}" / "summary.json").read_text(encoding="utf-8")
            )
            self.assertEqual((summary["ranks"], summary["converged"]), (ranks, True))
        drawn = self.collect("strong")
        self.assertEqual(drawn.returncode, 0, drawn.stderr)
        self.assertTrue((self.output / "scaling.png").read_bytes().startswith(b"\x89PNG"))
        rows = self.rows()
        self.assertEqual([row["ranks"] for row in rows], ["1", "2"])
        self.assertEqual(rows[0]["primal_dimension"], rows[1]["primal_dimension"])
        self.assertEqual(float(rows[0]["efficiency"]), 1.0)

    def test_weak_scaling_sets_what_grows(self):
        done = self.submit(
            "--scaling", "weak", "--ranks", "1,4", "--dry-run", "--scheduler", "slurm",
            "--set", "Model/Subdomains per side={2*sqrt(ranks)}", "--set", "List/Array={1, 2}",
        )  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        sides = re.findall("Subdomains per side=([^']*)'", done.stdout)
        self.assertEqual(sides, ["2", "4"])
        self.assertIn(str(self.output / "ranks_4"), done.stdout)
        self.assertEqual(done.stdout.count("'List/Array={1, 2}'"), 2)

    def write(self, ranks, solve, mesh, dimension, converged=True):
        seconds = dict.fromkeys(
            ("assembly", "factorization", "dual_operator", "coarse", "recovery"), 0.0
        )
        seconds |= {"mesh": mesh, "solve": solve, "output": 5.0, "total": 5.0 + solve + mesh}
        directory = self.output / f"ranks_{ranks}"
        directory.mkdir(parents=True)
        summary = {
            "ranks": ranks, "converged": converged, "primal_dimension": dimension, "subdomains": 4,
            "hessian_applications": 9, "peak_memory_mib": 10.0 * ranks, "seconds": seconds,
        }  # fmt: skip
        (directory / "summary.json").write_text(json.dumps(summary), encoding="utf-8")

    def test_efficiencies_by_hand(self):
        """Two ranks against eight; writing does not count, nor does what has not converged."""
        for kind, dimension, total, solve in (
            ("strong", 100, (8 + 4) * 2 / ((4 + 2) * 8), 8 * 2 / (4 * 8)),
            ("weak", 400, (8 + 4) / (4 + 2), 8 / 4),
        ):
            with self.subTest(kind=kind):
                self.setUp()
                self.write(2, 8.0, 4.0, 100)
                self.write(8, 4.0, 2.0, dimension)
                self.write(16, 1.0, 1.0, 100, converged=False)
                drawn = self.collect("auto")
                self.assertEqual(drawn.returncode, 0, drawn.stderr)
                self.assertIn("ranks_16 has not converged", drawn.stderr)
                rows = self.rows()
                self.assertEqual([row["ranks"] for row in rows], ["2", "8"])
                self.assertAlmostEqual(float(rows[1]["efficiency"]), total, 12)
                self.assertAlmostEqual(float(rows[1]["solve_efficiency"]), solve, 12)
                self.assertEqual(float(rows[1]["peak_memory_mib_a_rank"]), 10.0)

    def test_what_cannot_be_compared(self):
        self.output.mkdir(parents=True)
        self.assertIn("no converged run", self.collect("auto").stderr)
        self.write(1, 1.0, 1.0, 100)
        self.write(2, 1.0, 1.0, 200)
        drawn = self.collect("strong")
        self.assertEqual(drawn.returncode, 2)
        self.assertIn("2 sizes", drawn.stderr)


if __name__ == "__main__":
    runs.main()
