# SPDX-License-Identifier: BSD-3-Clause
"""The sparse direct solvers of the subdomains beside each other: seconds and memory of whole runs.

    local_solvers.py [--repetitions 3] [--np 2] [--scale 1] [--only NAME...] [--output JSON]

Scenes: half a ball of linear tetrahedra on a plane (no two subdomains alike) and the cube of block.xml without sharing.
Each solver runs with the form and the preconditioner that "auto" chooses for it, and with the implicit form and the
Dirichlet preconditioner, which all of them have. Medians; solvers take turns, so that a busy machine is busy for all.
Prints the table of docs/dual_operator.md. Exit status 1 if energies differ by more than ten tolerances.
"""

import argparse
import json
import statistics
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parents[1] / "support")]

import harmos_measure  # noqa: E402
import headline  # noqa: E402
import harmos_runs as runs  # noqa: E402
import real_bodies  # noqa: E402

TOLERANCE = 1e-4
SOLVERS = ("multifrontal", "MUMPS", "KLU2")
IMPLICIT = {"Dual operator/Form": "implicit", "Dual operator/Preconditioner": "Dirichlet"}
WAYS = {"auto": {}, "implicit, Dirichlet": IMPLICIT}


def half_ball(directory, scale):
    deck = real_bodies.write_deck(Path(directory), "half-ball", True, scale=scale)
    return "harmos", deck, real_bodies.cut("half-ball", max(8, round(96 / scale**3)))


def cube(_, scale):
    sides = max(2, round(6 / scale))
    sets = {
        "Model/Subdomains per side": sides,
        "Model/Elements per subdomain side": 8,
        "Dual operator/Expert/Share identical subdomains": False,
    }
    return "signorini", runs.DECKS / "block.xml", sets


SCENES = {"half-ball": half_ball, "cube": cube}


def measured(scene, repetitions, np):
    """A row for each solver and way."""
    program, deck, sets = scene
    common = {**sets, "Solver/Tolerance": TOLERANCE, "Output/Fields": False}
    ways = [(solver, way) for way in WAYS for solver in SOLVERS]
    summaries = {way: [] for way in ways}
    for _ in range(repetitions):
        for solver, way in ways:
            more = {**common, **WAYS[way], "Dual operator/Local solver": solver}
            summaries[solver, way] += harmos_measure.repeated(1, deck, more, np=np, program=program)
    return [row(solver, way, summaries[solver, way]) for solver, way in ways]


def row(solver, way, summaries):
    last = summaries[-1]
    mesh = [s["seconds"]["total"] - s["seconds"].get("mesh", 0.0) for s in summaries]
    return {
        "solver": solver,
        "way": way,
        "dual_operator": last["dual_operator"],
        "local_solver": last["local_solver"],
        "hessian_applications": last["hessian_applications"],
        "energy": last["energy"],
        "seconds_without_mesh": statistics.median(mesh),
        "seconds": harmos_measure.median_seconds(summaries),
        "peak_memory_mib": harmos_measure.median_memory(summaries),
    }


def table(scenes):
    lines = ["| Scene | Operator | Solver | Seconds | Applications | MiB |", "|---|---|---|---|---|---|"]
    for name, rows in scenes.items():
        for item in rows:
            lines.append(
                f"| {name} | {item['dual_operator'].removesuffix(' preconditioner')} | {item['solver']} | "
                f"{item['seconds_without_mesh']:.2f} | {item['hessian_applications']} | {item['peak_memory_mib']:.0f} |"
            )
    return "\n".join(lines)


def energies_agree(rows):
    energies = [item["energy"] for item in rows]
    return max(energies) - min(energies) <= 10 * TOLERANCE * abs(energies[0])


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--scale", type=float, default=1.0, help="of the elements of the meshes")
    parser.add_argument("--only", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--output", type=Path)
    options = parser.parse_args(arguments)
    scenes = {}
    with tempfile.TemporaryDirectory() as directory:
        for name in options.only:
            scenes[name] = measured(SCENES[name](directory, options.scale), options.repetitions, options.np)
    print(table(scenes))
    if options.output:
        document = {
            "version": harmos_measure.version(),
            "machine": headline.machine(),
            "ranks": options.np,
            "repetitions": options.repetitions,
            "scenes": scenes,
        }
        options.output.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0 if all(energies_agree(rows) for rows in scenes.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
