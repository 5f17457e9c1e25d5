#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""Submits a run of Harmos to Slurm or PBS, or a scaling run of several.

    submit.py DECK --ranks 64 --ranks-per-node 32 --time 04:00:00 --memory 2000 --output run
    submit.py DECK --scaling strong --ranks 1,2,4,8 --output scaling ...
    submit.py DECK --scaling weak --ranks 1,2,4 --set "Model/Columns={16*ranks}" --output scaling

Some minutes before the time limit (--margin) the ranks are asked to write a checkpoint and stop;
the job then submits itself again, at most --resubmissions times, and goes on from there.
--dry-run prints the scripts and submits nothing; --local runs at once, here, without a scheduler.
Needs nothing but Python's standard library.
"""

import argparse
import ast
import math
import operator
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
SUBMIT = {"slurm": "sbatch", "pbs": "qsub"}
CHECKPOINT_LEFT = 4  # exit status of a run that a signal stopped


class Refused(Exception):
    """What is wrong with the request: a sentence."""


OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Pow: operator.pow,
}
FUNCTIONS = {"sqrt": math.sqrt, "round": round, "int": int}


def value_of(node, ranks):
    """A number from a parsed expression in ranks; nothing else is evaluated."""
    if isinstance(node, ast.Expression):
        return value_of(node.body, ranks)
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return node.value
    if isinstance(node, ast.Name) and node.id == "ranks":
        return ranks
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        return OPERATORS[type(node.op)](value_of(node.left, ranks), value_of(node.right, ranks))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return -value_of(node.operand, ranks)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS:
        return FUNCTIONS[node.func.id](*(value_of(item, ranks) for item in node.args))
    raise ValueError


def expand(setting, ranks):
    """A setting for so many ranks: {16*ranks} becomes a number, other braces are arrays."""

    def replace(match):
        text = match.group(1)
        if not re.search(r"\branks\b", text):
            return match.group(0)
        try:
            value = value_of(ast.parse(text.strip(), mode="eval"), ranks)
        except (ValueError, SyntaxError, ZeroDivisionError, TypeError):
            raise Refused(
                f'--set "{setting}": {{{text}}} is no expression in ranks; '
                "+ - * / // ** sqrt() round() int() are known"
            ) from None
        return str(int(value)) if float(value).is_integer() else repr(value)

    return re.sub(r"\{([^{}]*)\}", replace, setting)


def seconds_of(time):
    """Of HH:MM:SS, MM:SS or D-HH:MM:SS."""
    match = re.fullmatch(r"(?:(\d+)-)?(?:(\d+):)?(\d+):(\d\d)", time)
    if not match:
        raise Refused(f'--time "{time}" is no time; write hours:minutes:seconds, as in 04:00:00')
    days, hours, minutes, seconds = (int(group or 0) for group in match.groups())
    return ((24 * days + hours) * 60 + minutes) * 60 + seconds


def clock(seconds):
    return f"{seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}"


def program_of(given):
    """The application: a path, or a name beside the installed or built tree, or on PATH."""
    if "/" in given.app:
        places = [Path(given.app)]
    else:
        places = [
            HERE.parents[2] / "bin" / given.app, HERE.parents[1] / "build" / "bin" / given.app
        ]
        on_path = shutil.which(given.app)
        places += [Path(on_path)] if on_path else []
    for place in places:
        if place.is_file() and os.access(place, os.X_OK):
            return place.resolve()
    raise Refused(
        f'there is no program "{given.app}" ({", ".join(map(str, places))}); give its path by --app'
    )


class Job:
    """One run: so many ranks, one output directory."""

    def __init__(self, given, ranks, output):
        self.given = given
        self.ranks = ranks
        self.output = output
        self.per_node = min(given.ranks_per_node or ranks, ranks)
        self.name = f"{given.job_name}-{ranks}" if given.scaling else given.job_name

    def program(self, restart=False):
        words = [str(program_of(self.given)), str(Path(self.given.deck).resolve())]
        words += ["--output", str(self.output)]
        for setting in self.given.set:
            words += ["--set", expand(setting, self.ranks)]
        return words + (["--restart", str(self.output)] if restart else [])

    def launch(self, scheduler):
        if self.given.launcher == "srun":
            return ["srun", "--cpu-bind=cores"]
        words = ["mpirun", "-np", str(self.ranks)]
        if self.given.bind == "core":
            words += ["--map-by", "core", "--bind-to", "core"]
        if scheduler == "pbs":
            # PBS sends no signal before the limit.
            limit = seconds_of(self.given.time) - self.given.margin
            words = [
                "timeout", "--foreground", "--preserve-status", "-s", "USR1", str(limit), *words
            ]
        return words

    def select(self):
        """Whole nodes, and one with the rest."""
        nodes, rest = divmod(self.ranks, self.per_node)
        chunks = [(nodes, self.per_node)] + ([(1, rest)] if rest else [])
        return "+".join(
            f"{count}:ncpus={cores}:mpiprocs={cores}:mem={cores * self.given.memory}mb"
            for count, cores in chunks
        )

    def options(self, scheduler):
        queue, account = ("--partition=", "--account=") if scheduler == "slurm" else ("-q ", "-A ")
        mark = "#SBATCH" if scheduler == "slurm" else "#PBS"
        lines = []
        if self.given.queue:
            lines.append(f"{mark} {queue}{self.given.queue}")
        if self.given.account:
            lines.append(f"{mark} {account}{self.given.account}")
        return "\n".join(lines)

    def script_path(self, scheduler):
        return self.output / f"harmos.{scheduler}"

    def script(self, scheduler):
        """The template with all that it names filled in."""
        given = self.given
        values = {
            "name": self.name,
            "ranks": self.ranks,
            "ranks_per_node": self.per_node,
            "time": clock(seconds_of(given.time)),
            "memory": given.memory,
            "output": self.output,
            "select": self.select(),
            # To the steps, which srun starts; mpirun is none on the first node, so the script
            # passes it on.
            "signal": ("" if given.launcher == "srun" else "B:") + f"USR1@{given.margin}",
            "options": self.options(scheduler),
            "script": shlex.quote(str(self.script_path(scheduler))),
            "resubmissions": given.resubmissions,
            "first": int(given.restart),
            "modules": "\n".join(f"module load {shlex.quote(module)}" for module in given.module),
            "launch": shlex.join(self.launch(scheduler)),
            "program": shlex.join(self.program()),
        }

        def fill(text):
            return re.sub(r"@(\w+)@", lambda match: str(values[match.group(1)]), text)

        values["body"] = fill((HERE / "job.sh").read_text(encoding="utf-8"))
        text = fill((HERE / f"harmos.{scheduler}").read_text(encoding="utf-8"))
        return re.sub(r"\n{3,}", "\n\n", text)


def check(given, jobs):
    if not Path(given.deck).is_file():
        raise Refused(f'there is no deck "{given.deck}"')
    # Schedulers read their lines without a shell.
    for option, text in (
        ("--output", str(Path(given.output).resolve())),
        ("--job-name", given.job_name),
        ("--queue", given.queue or ""),
        ("--account", given.account or ""),
    ):
        if not re.fullmatch(r"[\w./+:=-]*", text):
            raise Refused(f'{option} "{text}" holds blanks or signs that schedulers do not take')
    limit = seconds_of(given.time)
    if not 0 < given.margin < limit:
        raise Refused(
            f"--margin {given.margin} must lie between 0 and the time limit, {limit} seconds"
        )
    if given.launcher == "srun" and (given.scheduler == "pbs" or given.local):
        raise Refused("--launcher srun belongs to Slurm; use mpirun")
    if given.scaling == "weak" and not any(
        expand(setting, 1) != expand(setting, 2) for setting in given.set
    ):
        raise Refused('--scaling weak needs a --set that grows, as in "Model/Columns={16*ranks}"')
    if not given.scaling and len(jobs) > 1:
        raise Refused("several numbers of ranks are a scaling run: say --scaling strong or weak")
    for job in jobs:
        job.program()


def scheduler_of(given):
    """The one that was named, or that is there."""
    if given.scheduler:
        wanted = [given.scheduler]
    else:
        wanted = [name for name, command in SUBMIT.items() if shutil.which(command)]
    if not given.dry_run and (not wanted or not shutil.which(SUBMIT[wanted[0]])):
        names = SUBMIT[wanted[0]] if wanted else "sbatch nor qsub"
        raise Refused(
            f"no scheduler here: {'no' if wanted else 'neither'} {names} is on PATH; "
            "submit from a login node, or use --local or --dry-run"
        )
    return wanted[0] if wanted else "slurm"


def run_here(job):
    """Runs to the end, going on from checkpoints as a job would."""
    job.output.mkdir(parents=True, exist_ok=True)
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    status = 0
    for attempt in range(job.given.resubmissions + 1):
        words = job.launch("none") + job.program(restart=attempt > 0 or job.given.restart)
        print("$ " + shlex.join(words), flush=True)
        process = subprocess.Popen(words, env=environment, stdin=subprocess.DEVNULL)
        previous = signal.signal(signal.SIGUSR1, lambda *_: process.send_signal(signal.SIGUSR1))
        status = process.wait()
        signal.signal(signal.SIGUSR1, previous)
        if status != CHECKPOINT_LEFT:
            break
    return status


def submit(job, scheduler):
    job.output.mkdir(parents=True, exist_ok=True)
    path = job.script_path(scheduler)
    path.write_text(job.script(scheduler), encoding="utf-8")
    words = [SUBMIT[scheduler], str(path)]
    print("$ " + shlex.join(words), flush=True)
    return subprocess.run(words, check=False).returncode


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n\n", 1)[0],
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    add = parser.add_argument
    add("deck", help="deck of the application")
    add("--app", default="harmos", help="harmos, signorini, fiber_composite, or a path")
    add("--ranks", default="1", help="number of ranks; for a scaling run several, as in 1,2,4")
    add(
        "--ranks-per-node",
        type=int,
        help="cores of a node that ranks take; all on one node if not given",
    )
    add("--time", default="01:00:00", help="time limit, hours:minutes:seconds")
    add(
        "--margin",
        type=int,
        default=300,
        help="seconds before it at which a checkpoint is asked for",
    )
    add(
        "--memory",
        type=int,
        default=2000,
        help="MiB a rank; --plan of the application tells how much",
    )
    add("--queue", "--partition", help="queue of PBS, partition of Slurm")
    add("--account", help="account that pays")
    add("--module", action="append", default=[], help="environment module to load; repeat for more")
    add("--output", default="run", help="directory of the results, of a scaling run's directories")
    add(
        "--set",
        action="append",
        default=[],
        metavar="PATH=VALUE",
        help="as of the application; {ranks} is known",
    )
    add("--resubmissions", type=int, default=10, help="most times that a job submits itself again")
    add("--restart", action="store_true", help="go on from the checkpoint in the output directory")
    add("--job-name", default="harmos", help="what the queue shows")
    add("--scheduler", choices=sorted(SUBMIT), help="default: the one whose command is on PATH")
    add("--launcher", choices=("mpirun", "srun"), default="mpirun", help="what starts the ranks")
    add("--bind", choices=("core", "none"), help="ranks to cores; default: core, with --local none")
    add(
        "--scaling",
        choices=("strong", "weak"),
        help="one run for each number of ranks, in DIR/ranks_N",
    )
    add("--local", action="store_true", help="run here, without a scheduler, one after the other")
    add("--dry-run", action="store_true", help="print what would be submitted, and stop")
    given = parser.parse_args()
    given.bind = given.bind or ("none" if given.local else "core")
    return given


def main():
    given = arguments()
    if not re.fullmatch(r"[1-9]\d*(,[1-9]\d*)*", given.ranks):
        raise Refused(f'--ranks "{given.ranks}" is no list of positive numbers, as in 1,2,4')
    for option in ("memory", "resubmissions", "ranks_per_node"):
        value = getattr(given, option)
        if value is not None and value < (0 if option == "resubmissions" else 1):
            raise Refused(f"--{option.replace('_', '-')} {value} is too small")
    top = Path(given.output).resolve()
    counts = [int(word) for word in given.ranks.split(",")]
    jobs = [Job(given, ranks, top / f"ranks_{ranks}" if given.scaling else top) for ranks in counts]
    check(given, jobs)
    if given.dry_run:
        scheduler = scheduler_of(given)
        for job in jobs:
            print(job.script(scheduler), end="")
        return 0
    if given.local:
        statuses = [run_here(job) for job in jobs]
    else:
        scheduler = scheduler_of(given)
        statuses = [submit(job, scheduler) for job in jobs]
    if given.scaling:
        words = ["plot_scaling.py", str(top), "--kind", given.scaling]
        print("When they have finished: " + shlex.join(words))
    return next((status for status in statuses if status), 0)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Refused as error:
        sys.exit(f"error: {error}")
