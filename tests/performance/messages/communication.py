# SPDX-License-Identifier: BSD-3-Clause
"""Messages, bytes and reductions of a step, counted at MPI, at a fixed load a rank.

    communication.py [--physics membrane,solid] [--ranks 1,2,4,8,16,32,64] [--side N] [--elements N]
                     [--forms replicated,distributed] [--clusters none,rank] [--output FILE] [--table FILE]

A square of membranes or a cube of solids, side x side (x side) subdomains a rank, held at two
sides under a body force, by projected conjugate gradients with the Dirichlet preconditioner; more ranks than
cores are no matter, for nothing is timed. With a cluster a rank (`--clusters rank`) what holds the block are rows
too, so that each cluster has motions. Runs that stop after 3 and after 8 steps differ by what five steps
say to other ranks; what is left of the first is set-up, and the end. `mpi_counts` counts. Beside it stands
what performance_model.py says of the same shares, row by row (shares.py). `--table` measures nothing and
prints such a file as docs/dual_operator.md has it.
"""

import argparse
import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent), str(HERE.parents[1] / "support")]

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402
import performance_model  # noqa: E402
import shares  # noqa: E402

COUNTS = runs.BINARY / "tests" / "bin" / "libharmos_mpi_counts.so"
STEPS = (3, 8)
COLLECTIVES = ("allreduce", "allgather", "alltoall", "broadcast", "barrier", "reduce", "scan")
BY_MODEL = {
    "message_calls_a_step": "model_messages",
    "message_bytes_a_step": "model_message_bytes",
    "allreduce_calls_a_step": "model_reductions",
    "allgather_calls_a_step": "model_gathers",
    "collective_bytes_a_step": "model_collective_bytes",
}
SIDES = {"membrane": (4, 8), "solid": (2, 2)}  # of a rank's share in subdomains, of a subdomain in elements
# Of solids in clusters: a face between two that has one node inside, as with two elements, is a hinge.
JOINED_ELEMENTS = {"membrane": 8, "solid": 3}

DECK = """<ParameterList name="harmos">
  <ParameterList name="Model"><Parameter name="Physics" type="string" value="{physics}"/></ParameterList>
  {materials}
  <ParameterList name="Bodies"><ParameterList name="block">
    <Parameter name="Source" type="string" value="block"/>
    <Parameter name="Size" type="Array(double)" value="{{{x}, {y}, {z}}}"/>
    <Parameter name="Subdomains a side" type="Array(int)" value="{{{x}, {y}, {z}}}"/>
    <Parameter name="Elements a side" type="Array(int)" value="{{{n}, {n}, {n}}}"/>
    {material}
  </ParameterList></ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Body force"><ParameterList name="load">
      <Parameter name="Body" type="string" value="block"/>
      <Parameter name="Density" type="Array(double)" value="{{-1, 0, 0}}"/>
    </ParameterList></ParameterList>
    <ParameterList name="Prescribed displacement">{held}</ParameterList>
  </ParameterList>
</ParameterList>
"""
HELD = """<ParameterList name="{part}">
      <Parameter name="Part" type="string" value="block/{part}"/>
      <Parameter name="Components" type="Array(string)" value="{{{components}}}"/>
    </ParameterList>"""
MATERIALS = """<ParameterList name="Materials"><ParameterList name="steel">
    <Parameter name="Young's modulus" type="double" value="1"/>
  </ParameterList></ParameterList>"""
MATERIAL = """<Parameter name="Materials" type="Array(string)" value="{steel}"/>"""


def grid(physics, ranks, side):
    """Subdomains in each direction: as near to a square or a cube as powers of two are."""
    sides = [side] * (3 if physics == "solid" else 2)
    d = 0
    while ranks > 1:
        sides[d % len(sides)] *= 2
        ranks //= 2
        d += 1
    return sides


def deck_of(physics, sides, elements):
    is_solid = physics == "solid"
    x, y, z = sides if is_solid else (*sides, 1)
    components = "x, y, z" if is_solid else "x"
    return DECK.format(
        physics=physics,
        materials=MATERIALS if is_solid else "",
        material=MATERIAL if is_solid else "",
        held="".join(HELD.format(part=part, components=components) for part in ("left", "bottom")),
        x=x,
        y=y,
        z=z,
        n=elements,
    )


def counted(deck, ranks, form, clusters, steps):
    """What the ranks counted, the largest peak memory of one, MiB, and summary.json."""
    with tempfile.TemporaryDirectory() as folder:
        results = Path(folder) / "results"
        command = [runs.MPIEXEC, "--oversubscribe", "-n", ranks, "-x", f"LD_PRELOAD={COUNTS}"]
        command += ["-x", f"HARMOS_MPI_COUNTS={folder}", runs.application("harmos"), deck]
        command += ["--output", results]
        for setting in (
            f"Decomposition/Coarse problem={form}",
            f"Decomposition/Clusters={clusters}",
            f"Decomposition/Dirichlet={'dual' if clusters == 'rank' else 'auto'}",
            f"Solver/Maximum iterations={steps}",
            "Solver/Tolerance=1e-14",
            "Solver/Expert/PCPG/Reorthogonalisation=none",  # or the last checkpoint grows with the steps
            "Dual operator/Form=condensed",
            "Dual operator/Preconditioner=Dirichlet",
            "Dual operator/Expert/Adaptive coarse vectors=none",
            "Output/Expert/Rank diagnostics=true",
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
        summary = json.loads((results / "summary.json").read_text(encoding="utf-8"))
        return [json.loads(file.read_text(encoding="utf-8")) for file in files], memory, summary


def most(tables, name, key):
    """Of the rank with the most."""
    return max(table.get(name, {}).get(key, 0) for table in tables)


def a_step(second, first, name, key):
    """Of the rank that says the most in a step."""
    pairs = zip(second, first)
    changes = [b.get(name, {}).get(key, 0) - a.get(name, {}).get(key, 0) for b, a in pairs]
    return max(changes) / (STEPS[1] - STEPS[0])


def expected(sides, elements, ranks, form, clusters):
    """What the model says of the ranks with the most, and of how many motions and rows there are."""
    shapes = shares.shapes(sides, elements, ranks, clusters)
    tables = [performance_model.counts(shape, form) for shape in shapes]
    row = {f"model_{name}": max(table[name] for table in tables) for name in tables[0]}
    largest = max(performance_model.coarse_bytes(shape, form) for shape in shapes)
    row["model_coarse_mib_of_a_rank"] = largest / 2**20
    row["neighbours"] = max(shape.neighbours for shape in shapes)
    row["coarse_dimension"] = shapes[0].coarse_dimension
    row["dual_dimension"] = sum(shape.rows for shape in shapes)
    return row


def measure(physics, ranks, form, clusters, side, elements):
    sides = grid(physics, ranks, side)
    deck = runs.scratch("deck").with_suffix(".xml")
    deck.write_text(deck_of(physics, sides, elements), encoding="utf-8")
    (first, _, _), (second, memory, summary) = (
        counted(deck, ranks, form, clusters, steps) for steps in STEPS
    )
    row = {"physics": physics, "ranks": ranks, "form": form, "subdomains": summary["subdomains"]}
    row |= {"clusters": summary["clusters"], "memory_mib_of_a_rank": memory}
    row |= expected(sides, elements, ranks, form, clusters)
    for name in ("dual_dimension", "coarse_dimension"):
        assert row[name] == summary[name], (name, row[name], summary[name])
    assert summary["coarse_problem"] == form
    assert summary["clusters"] == (ranks if clusters == "rank" else 0)
    for name in ("message", *COLLECTIVES):
        for key in ("calls", "bytes"):
            row[f"{name}_{key}_a_step"] = change = a_step(second, first, name, key)
            row[f"{name}_{key}_of_setup"] = most(first, name, key) - change * STEPS[0]
    row["collective_bytes_a_step"] = sum(row[f"{name}_bytes_a_step"] for name in COLLECTIVES)
    return row


HEAD = (
    "                                     messages      kB in them    reductions   all-gathers  kB by these    "
    "MiB of a rank\nphysics  form        clusters ranks" + 5 * "  counted model" + "   peak  coarse"
)


def line(row):
    words = [f"{row['physics']:8} {row['form']:11} {row['clusters']:8} {row['ranks']:5}"]
    for counted_name, by_model in BY_MODEL.items():
        by, digits = (1e3, 2) if "bytes" in counted_name else (1, 1)
        words.append(f"{row[counted_name] / by:8.{digits}f} {row[by_model] / by:5.{digits}f}")
    return " ".join(words) + f" {row['memory_mib_of_a_rank']:6.0f} {row['model_coarse_mib_of_a_rank']:7.2f}"


def pages_table(document):
    """As a table of docs/dual_operator.md: replicated; distributed. In brackets the model, where it differs."""
    cases = {}
    for row in document["runs"]:
        if row["ranks"] > 1:
            physics = row["physics"] + (", a cluster a rank" if row.get("clusters", 0) > 0 else "")
            cases.setdefault((physics, row["ranks"], row["coarse_dimension"]), []).append(row)
    titles = ("messages", "kB in them", "all-reduces", "all-gathers", "kB by both")
    lines = ["| | ranks, coarse dimension | " + " | ".join(titles) + " | MiB of a rank |", "|---" * 8 + "|"]
    for (physics, ranks, dimension), forms in cases.items():
        cells = [physics, f"{ranks}, {dimension}"]
        for name, by_model in BY_MODEL.items():
            by, digits = (1e3, 1) if "bytes" in name else (1, 0)
            pairs = [[f"{row[key] / by:.{digits}f}" for key in (name, by_model)] for row in forms]
            cells.append("; ".join(one if one == model else f"{one} ({model})" for one, model in pairs))
        cells.append("; ".join(f"{row['memory_mib_of_a_rank']:.0f}" for row in forms))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--physics", default="membrane,solid")
    parser.add_argument("--ranks", default="1,2,4,8,16,32,64", help="powers of two")
    parser.add_argument("--side", type=int, help="subdomains of a rank; 4 of membranes, 2 of solids")
    parser.add_argument("--elements", type=int, help="of a subdomain; 8 of membranes, 2 of solids, 3 in clusters")
    parser.add_argument("--forms", default="replicated,distributed")
    parser.add_argument("--clusters", default="none,rank")
    parser.add_argument("--output")
    parser.add_argument("--table", metavar="FILE", help="what --output wrote")
    given = parser.parse_args()
    if given.table:
        print(pages_table(json.loads(Path(given.table).read_text(encoding="utf-8"))))
        return 0
    table = []
    print(HEAD)
    for physics in given.physics.split(","):
        side = given.side or SIDES[physics][0]
        for clusters, form in itertools.product(given.clusters.split(","), given.forms.split(",")):
            usual = JOINED_ELEMENTS[physics] if clusters == "rank" else SIDES[physics][1]
            elements = given.elements or usual
            for ranks in map(int, given.ranks.split(",")):
                table.append(measure(physics, ranks, form, clusters, side, elements))
                print(line(table[-1]), flush=True)
    if given.output:
        document = {"benchmark": "communication", "harmos": harmos_measure.version(), "runs": table}
        Path(given.output).write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
