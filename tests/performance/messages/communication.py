# SPDX-License-Identifier: BSD-3-Clause
"""Messages, bytes and reductions of a step, counted at MPI, at a fixed load a rank.

    communication.py [--ranks 1,2,4,8,16,32,64] [--side 4] [--elements 8] [--forms replicated,distributed]
                     [--output FILE]

A membrane of side x side subdomains a rank, held at one end, by projected conjugate gradients with
the Dirichlet preconditioner; more ranks than cores are no matter, for nothing is timed. Runs that
stop after 3 and after 8 steps differ by what five steps say to other ranks; what is left of the
first is set-up, and the end. `mpi_counts` counts. Beside it stand the terms of the model
(performance_model.py): all-reduces or all-gathers of a number for each subdomain, four a step, and
the bytes that come to a rank by them.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
import harmos_runs as runs

COUNTS = runs.BINARY / "tests" / "bin" / "libharmos_mpi_counts.so"
STEPS = (3, 8)
COLLECTIVES = ("allreduce", "allgather", "alltoall", "broadcast", "barrier", "reduce", "scan")

DECK = """<ParameterList name="harmos">
  <ParameterList name="Model"><Parameter name="Physics" type="string" value="membrane"/></ParameterList>
  <ParameterList name="Bodies"><ParameterList name="sheet">
    <Parameter name="Source" type="string" value="block"/>
    <Parameter name="Size" type="Array(double)" value="{{{x}, {y}, 1}}"/>
    <Parameter name="Subdomains a side" type="Array(int)" value="{{{x}, {y}, 1}}"/>
    <Parameter name="Elements a side" type="Array(int)" value="{{{n}, {n}, 1}}"/>
  </ParameterList></ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Body force"><ParameterList name="load">
      <Parameter name="Body" type="string" value="sheet"/>
      <Parameter name="Density" type="Array(double)" value="{{-1, 0, 0}}"/>
    </ParameterList></ParameterList>
    <ParameterList name="Prescribed displacement"><ParameterList name="frame">
      <Parameter name="Part" type="string" value="sheet/left"/>
      <Parameter name="Components" type="Array(string)" value="{{x}}"/>
    </ParameterList></ParameterList>
  </ParameterList>
</ParameterList>
"""


def grid(ranks):
    """Ranks side by side, as square as powers of two are."""
    columns = 1
    while columns * columns < ranks:
        columns *= 2
    return columns, ranks // columns


def counted(deck, ranks, form, steps):
    """What the ranks counted, and the largest peak memory of one, MiB."""
    with tempfile.TemporaryDirectory() as folder:
        results = Path(folder) / "results"
        command = [runs.MPIEXEC, "--oversubscribe", "-n", ranks, "-x", f"LD_PRELOAD={COUNTS}"]
        command += ["-x", f"HARMOS_MPI_COUNTS={folder}", runs.application("harmos"), deck]
        command += ["--output", results]
        for setting in (
            f"Decomposition/Coarse problem={form}",
            f"Solver/Maximum iterations={steps}",
            "Solver/Tolerance=1e-14",
            "Dual operator/Preconditioner=Dirichlet",
            "Dual operator/Adaptive coarse vectors=none",
            "Output/Rank diagnostics=true",
            "Output/Fields=false",
        ):
            command += ["--set", setting]
        done = subprocess.run(
            [str(word) for word in command],
            env=runs.environment(),
            capture_output=True,
            text=True,
            check=False,
        )
        files = [Path(folder) / f"{rank}.json" for rank in range(ranks)]
        if not all(file.exists() for file in (*files, results / "ranks.csv")):
            sys.exit(done.stdout + done.stderr)
        lines = (results / "ranks.csv").read_text(encoding="utf-8").splitlines()
        column = lines[0].split(",").index("peak_memory_mib")
        memory = max(float(line.split(",")[column]) for line in lines[1:])
        return [json.loads(file.read_text(encoding="utf-8")) for file in files], memory


def most(tables, name, key):
    """Of the rank with the most."""
    return max(table.get(name, {}).get(key, 0) for table in tables)


def measure(ranks, form, side, elements):
    columns, rows = grid(ranks)
    deck = runs.scratch("deck").with_suffix(".xml")
    deck.write_text(DECK.format(x=side * columns, y=side * rows, n=elements), encoding="utf-8")
    (first, _), (second, memory) = (counted(deck, ranks, form, steps) for steps in STEPS)
    steps = STEPS[1] - STEPS[0]
    row = {"ranks": ranks, "form": form, "subdomains": side * side * ranks, "memory_mib_of_a_rank": memory}
    for name in ("message", *COLLECTIVES):
        for key in ("calls", "bytes"):
            change = most(second, name, key) - most(first, name, key)
            setup = most(first, name, key) - change / steps * STEPS[0]
            row[f"{name}_{key}_a_step"] = change / steps
            row[f"{name}_{key}_of_setup"] = setup
    size = side * side * ranks - side * rows  # those at the frame do not float
    row["coarse_dimension"] = size
    row["model_bytes_a_step"] = 4 * 8 * size if ranks > 1 else 0
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--ranks", default="1,2,4,8,16,32,64")
    parser.add_argument("--side", type=int, default=4)
    parser.add_argument("--elements", type=int, default=8)
    parser.add_argument("--forms", default="replicated,distributed")
    parser.add_argument("--output")
    given = parser.parse_args()
    table = []
    print("form           ranks  messages   reductions  all-gathers  bytes: messages  collectives   model   MiB")
    for form in given.forms.split(","):
        for ranks in map(int, given.ranks.split(",")):
            row = measure(ranks, form, given.side, given.elements)
            table.append(row)
            collectives = sum(row[f"{name}_bytes_a_step"] for name in COLLECTIVES)
            print(
                f"{form:13} {ranks:6} {row['message_calls_a_step']:9.1f} {row['allreduce_calls_a_step']:12.1f}"
                f" {row['allgather_calls_a_step']:12.1f} {row['message_bytes_a_step']:16.0f}"
                f" {collectives:12.0f} {row['model_bytes_a_step']:7} {row['memory_mib_of_a_rank']:5.0f}",
                flush=True,
            )
    if given.output:
        document = {"benchmark": "communication", "elements": given.elements, "runs": table}
        Path(given.output).write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
