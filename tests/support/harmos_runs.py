# SPDX-License-Identifier: BSD-3-Clause
"""Runs of whole programs for the Python tests, and what these tests share.

run() starts an application and returns what it printed, its exit status and what it left behind;
Result reads its fields; table() prints measured figures; main() runs the unittest cases of a
script under CTest's rules.

The environment, as harmos_add_script_test() of cmake/HarmosTest.cmake sets it (in brackets what
is taken without it, for runs by hand):

    HARMOS_SOURCE_DIR   the top of the source tree [two levels above this file]
    HARMOS_BINARY_DIR   the build tree [build in the source tree]
    HARMOS_MPIEXEC      the MPI launcher [mpirun]
    HARMOS_TABLES       a file to which table() appends a JSON object a line [none]
"""

import atexit
import csv
import functools
import itertools
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from dataclasses import dataclass
from pathlib import Path

SOURCE = Path(os.environ.get("HARMOS_SOURCE_DIR", Path(__file__).resolve().parents[2]))
BINARY = Path(os.environ.get("HARMOS_BINARY_DIR", SOURCE / "build"))
MPIEXEC = os.environ.get("HARMOS_MPIEXEC", "mpirun")
DECKS = SOURCE / "apps" / "signorini" / "decks"
MODEL = DECKS / "model.xml"
PAPER = DECKS / "paper.xml"
COMPOSITE = SOURCE / "apps" / "fiber_composite" / "decks" / "composite.xml"

# Of runs that name no number. CTest sets the default of a script: two, or one where the subject is physics; the answer
# is the same (decks_ranks, and a case of each kind of scene), and a run of one takes half the time of the processor.
# HARMOS_RANKS changes all, as in HARMOS_RANKS=4 ctest -R verification.
RANKS = int(os.environ.get("HARMOS_RANKS", os.environ.get("HARMOS_DEFAULT_RANKS", "2")))

SKIPPED = 77

# Programs that a build without ROL lacks.
OPTIONAL = {"shape"}
# What a run that has come to its end says, where that is not "converged".
REASONS = {"shape": "the gradient is below its tolerance"}

# Seconds. A run that hangs fails its test with the output so far, before CTest ends it without.
# A script of long runs sets another value.
TIMEOUT = 240

# The files that a finished run leaves behind.
RESULTS = ("iterations.csv", "result.vtkhdf", "summary.json")

_scratch = tempfile.TemporaryDirectory(prefix="harmos_test_")
atexit.register(_scratch.cleanup)
_numbers = itertools.count(1)


@dataclass
class Run:
    """A finished run."""

    command: list
    returncode: int
    stdout: str
    stderr: str
    summary: dict  # None if there is no summary.json
    directory: Path  # what --output was given; None if it was not

    @property
    def errors(self):
        """The lines that announce an error."""
        return [line for line in self.stderr.splitlines() if line.startswith("error: ")]

    def __str__(self):
        command = " ".join(map(str, self.command))
        return (
            f"\n$ {command}\nexit status {self.returncode}\n--- stdout\n{self.stdout}"
            f"--- stderr\n{self.stderr}---"
        )

    def iterations(self):
        """iterations.csv as a list of dicts by column."""
        with open(self.directory / "iterations.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))


def scratch(name="run"):
    """A path that does not exist yet, in a directory that vanishes with the test."""
    return Path(_scratch.name) / f"{name}{next(_numbers)}"


def application(name="signorini"):
    path = BINARY / "bin" / name
    if not path.exists():
        sys.exit(f"{path}: no such program; build it, or set HARMOS_BINARY_DIR")
    return str(path)


def is_built(name):
    return name not in OPTIONAL or (BINARY / "bin" / name).exists()


@functools.cache
def _shell_environment():
    command = ["env", "-i", f"PATH={os.environ['PATH']}", "sh", "-c", ". ./environment.sh && env"]
    printed = subprocess.check_output(command, cwd=SOURCE / "cmake", text=True)
    pairs = (line.split("=", 1) for line in printed.splitlines())
    return {name: value for name, value in pairs if re.match("(OMP|OPENBLAS|OMPI|PRTE)_", name)}


def environment():
    # Set by CTest; repeated here for runs by hand. The last two save time in hundreds of short runs: a second of
    # waiting for the other ranks after an exit status other than zero, and files of shared memory for the launcher.
    defaults = {
        **_shell_environment(),
        "OMPI_MCA_odls_base_sigkill_timeout": "0",
        "PMIX_MCA_gds": "hash",
    }
    return {**defaults, **os.environ}


def execute(command, cwd=None):
    """Run a command to its end; (exit status, standard output, standard error)."""
    process = subprocess.Popen(
        [str(word) for word in command],
        cwd=cwd,
        env=environment(),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        errors="replace",
    )
    try:
        out, err = process.communicate(timeout=TIMEOUT)
    except subprocess.TimeoutExpired:
        # mpirun ends its ranks when it is asked to; killed at once it would leave them behind.
        process.send_signal(signal.SIGTERM)
        try:
            out, err = process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
        words = " ".join(map(str, command))
        raise AssertionError(
            f"no end after {TIMEOUT} s: {words}\n--- stdout\n{out}--- stderr\n{err}---"
        ) from None
    return process.returncode, out, err


def launcher(np):
    """The words before the program; one rank runs without a launcher, in less than half the time."""
    return [MPIEXEC, "-n", str(np)] if np > 1 else []


def start(words, np=RANKS, cwd=None, program="signorini"):
    """Run an application with these words on its command line and nothing added to them."""
    command = [*launcher(np), application(program), *words]
    done = execute(command, cwd=cwd)
    # Open MPI 4 may miss the end of a rank that has ended well, once in some thousand starts, and says then that
    # process 0 exited improperly (its issues 7833 and 9389).
    if done[0] != 0 and re.search(r"due to process rank \d+ with PID 0 on", done[2]):
        print(f"note: the launcher lost a rank (PID 0); again: {' '.join(map(str, command))}", file=sys.stderr)
        done = execute(command, cwd=cwd)
    return Run(command, *done, summary=None, directory=None)


def run(deck, sets=None, np=RANKS, output=None, extra=(), program="signorini"):
    """Run an application on a deck.

    sets    parameters to override, a value by path
    np      ranks; 0 runs the program without a launcher
    output  directory of the results; a new one below a temporary directory if not given
    extra   more words for the command line
    """
    directory = Path(output) if output else scratch()
    words = [deck, "--output", directory]
    for path, value in (sets or {}).items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        words += ["--set", f"{path}={text}"]
    result = start([*words, *extra], np=np, program=program)
    result.directory = directory
    summary = directory / "summary.json"
    if summary.is_file():
        result.summary = json.loads(summary.read_text(encoding="utf-8"))
    return result


def solved(case, deck, sets=None, np=RANKS, **more):
    """run(), with the assertion that it converged, without an error or a warning."""
    result = run(deck, sets, np, **more)
    case.assertEqual(result.returncode, 0, result)
    case.assertTrue(result.summary["converged"], result)
    expected = REASONS.get(more.get("program"), "converged")
    case.assertEqual(result.summary["reason"], expected, result)
    # Not the whole stream: a launcher may have remarks of its own.
    case.assertNotRegex(result.stderr, "(?m)^(error|warning): ", result)
    return result


class Background:
    """A run that goes on while the test looks at it.

    program  an application, or the path of another program; deck None if it takes none
    """

    def __init__(self, deck, sets, np=2, words=(), program="signorini"):
        self.program = program
        self.directory = scratch("background")
        self.out = scratch("out")
        path = program if "/" in program else application(program)
        command = [*launcher(np), path, *([deck] if deck else []), "--output", self.directory]
        for path, value in sets.items():
            command += ["--set", f"{path}={str(value).lower() if value is False else value}"]
        with open(self.out, "wb") as out:
            self.process = subprocess.Popen(
                [str(word) for word in [*command, *words]],
                env=environment(),
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
            )

    def wait_for(self, name, seconds=120):
        """Until the file is there. False if the run came to its end without it."""
        return self.wait_until((self.directory / name).is_file, seconds)

    def wait_until(self, condition, seconds=120):
        """False if the run came to its end without it."""
        end = time.monotonic() + seconds
        while not condition():
            if self.process.poll() is not None:
                return False
            if time.monotonic() > end:
                self.process.kill()
                raise AssertionError(f"nothing after {seconds} s\n{self.text()}")
            time.sleep(0.01)
        return True

    def ranks(self):
        """The process numbers of the ranks."""
        found = []
        for entry in Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if words[0].endswith(b"/" + Path(self.program).name.encode()) and str(self.directory).encode() in words:
                found.append(int(entry.name))
        return found

    def end(self, seconds=120):
        try:
            self.process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise AssertionError(f"no end after {seconds} s\n{self.text()}") from None
        return self.process.returncode

    def text(self):
        return self.out.read_text(encoding="utf-8", errors="replace")


class Result:
    """The fields of a result file of the model problem, and the grid points of their nodes.

    arrays and attributes hold all that is below /VTKHDF, by name. Node k belongs to body[k] and
    has the place (i[k], j[k]) in the body's grid of n x n elements.

    Needs numpy and h5py; not every test that uses this module does.
    """

    def __init__(self, path, n):
        import h5py
        import numpy as np

        self.arrays = {}
        with h5py.File(path, "r") as file:
            self.attributes = dict(file["VTKHDF"].attrs)
            file["VTKHDF"].visititems(self._take)
        cells = self.arrays["NumberOfCells"]
        first = np.concatenate([[0], np.cumsum(cells)[:-1]])
        self.body = np.repeat(self.arrays["CellData/body"][first], self.arrays["NumberOfPoints"])
        self.x = self.arrays["Points"]
        self.i = np.rint((self.x[:, 0] - self.body) * n).astype(int)
        self.j = np.rint(self.x[:, 1] * n).astype(int)
        self.u = self.arrays["PointData/displacement"]

    def _take(self, name, item):
        if hasattr(item, "shape"):  # a dataset, not a group
            self.arrays[name] = item[()]

    def displacement_error(self, solution):
        """The largest difference from a solution of the oracle."""
        bodies = [abs(self.u - u[self.i, self.j])[self.body == b] for b, u in enumerate(solution.u)]
        return max(error.max() for error in bodies)


def table(title, header, rows, note=""):
    """Print figures in columns; append them to the file HARMOS_TABLES, a JSON object a line."""
    cells = [[str(cell) for cell in row] for row in (header, *rows)]
    widths = [max(map(len, column)) for column in zip(*cells)]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths)) for row in cells]
    sys.stderr.flush()
    print("\n".join(["", title, *lines, *([note] if note else [])]), flush=True)
    path = os.environ.get("HARMOS_TABLES")
    if path:
        record = {"title": title, "header": list(header), "rows": [list(r) for r in rows]}
        record |= {"note": note, "version": start(["--version"], np=0).stdout.strip()}
        with open(path, "a", encoding="utf-8") as file:
            file.write(json.dumps(record) + "\n")


def skip(reason):
    """End the script so that CTest shows it as skipped, with the reason in its log."""
    sys.stderr.flush()
    print(f"SKIPPED: {reason}", flush=True)
    sys.exit(SKIPPED)


class TimedResult(unittest.TextTestResult):
    """Prints what each case took as cmake/test_seconds.py reads it."""

    def startTest(self, test):
        self.started = time.monotonic()
        super().startTest(test)

    def stopTest(self, test):
        super().stopTest(test)
        name = ".".join(test.id().split(".")[-2:])
        self.stream.writeln(f"seconds: {time.monotonic() - self.started:.2f} {name}")


def main():
    """Run the cases of the calling script; words on its command line choose classes.

    Exit status 1 after a failure and when no case ran at all; 77 when what could run has passed
    and something was skipped.
    """
    runner = unittest.TextTestRunner(verbosity=2, resultclass=TimedResult)
    result = unittest.main(module="__main__", testRunner=runner, exit=False).result
    bad = len(result.failures) + len(result.errors) + len(result.unexpectedSuccesses)
    print(
        f"{result.testsRun} tests: {bad} failures, {len(result.skipped)} skipped", flush=True
    )
    if bad:
        sys.exit(1)
    if result.skipped:
        skip("; ".join(sorted({reason for _, reason in result.skipped})))
    sys.exit(0 if result.testsRun else 1)
