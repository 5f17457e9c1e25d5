# SPDX-License-Identifier: BSD-3-Clause
"""Harmos beside PETSc's CG with GAMG in active sets, on unstructured meshes in contact.

    unstructured.py [--only NAME...] [--scale 1] [--parts N] [--repetitions 3] [--np 2] [--tolerance 1e-4] [--rtol 1e-5]
                    [--set NAME=VALUE...] [--work DIR] [--output JSON] [--page MARKDOWN]
    unstructured.py --render [--output JSON] [--page MARKDOWN]

Meshes are made once; then Harmos and the ways of the peer (peer/gamg_peer.py, without decomposition) solve the same
scene in turns, on the same number of ranks. Seconds of Harmos are those of a whole run, from the file to the judged
answer. The peer's begin after its matrix is assembled; the seconds to read the same file by Gmsh's module are added,
and, as it assembles in numpy, the seconds that Harmos takes to assemble. Medians.

Without --output and --page, whole measurements go to docs/unstructured.json and docs/unstructured.md; --only or --scale
leave these alone. --render measures nothing and writes the page anew. Exit status 1 if a run failed, or if both do
not come to the same energy; 77 where Gmsh or petsc4py are missing.
"""

import argparse
import contextlib
import dataclasses
import json
import os
import platform
import statistics
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "peer"), str(HERE.parent / "support")]

import gmsh_meshes  # noqa: E402
import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402
import peer_petsc  # noqa: E402
import real_bodies  # noqa: E402
import unstructured_page  # noqa: E402
from headline import first_match, four_digits, memory_mib  # noqa: E402

DOCUMENT = runs.SOURCE / "docs/unstructured.json"
PAGE = runs.SOURCE / "docs/unstructured.md"
PRESS = 0.03
WAYS = ("plain", "reused", "best")


@dataclasses.dataclass(frozen=True)
class Case:
    """A mesh of real_bodies.py, and how far energies of both may differ."""

    scene: str
    scale: float
    energies: float = 1e-4
    same_rows: bool = True  # of contact, in both

    def tolerance(self, coarser):
        """Where rows differ, so do discretisations, the more the coarser they are."""
        return self.energies if self.same_rows else self.energies * max(1.0, coarser)


CASES = {
    "half-ball": Case("half-ball", 0.882),
    "half-ball-large": Case("half-ball", 0.588),
    "ball-on-block": Case("ball-on-block", 0.87, 1e-2, same_rows=False),
    "half-ball-quadratic": Case("half-ball-quadratic", 0.84),
}


class PeerFailed(RuntimeError):
    """A run of the peer that left no answer, with what it printed."""


def run_peer(mesh, way, given):
    """What peer/gamg_peer.py printed of one run."""
    program = [sys.executable, HERE / "peer/gamg_peer.py", mesh]
    words = ["--way", way, "--press", PRESS, "--rtol", given.rtol]
    status, out, errors = runs.execute([*runs.launcher(given.np), *program, *words])
    found = [line for line in out.splitlines() if line.startswith("{")]
    if status != 0 or not found:
        raise PeerFailed(f"gamg_peer.py, {way}: exit status {status}\n{out}{errors}")
    answer = json.loads(found[0])
    if answer["ranks"] != given.np:
        raise PeerFailed(
            f"petsc4py sees {answer['ranks']} ranks of {given.np}: it was made for another MPI than "
            f"that of {runs.MPIEXEC}"
        )
    return answer


def spread(values):
    return {
        "median": four_digits(statistics.median(values)),
        "least": four_digits(min(values)),
        "most": four_digits(max(values)),
    }


def rounded(stages):
    return {stage: four_digits(seconds) for stage, seconds in stages.items()}


def of_harmos(summaries):
    """Its part of an entry."""
    last = summaries[-1]
    return {
        "seconds": spread([s["seconds"]["total"] for s in summaries]),
        "stages": rounded(harmos_measure.median_seconds(summaries)),
        "peak_memory_mib": round(harmos_measure.median_memory(summaries)),
        "energy": last["energy"],
        "solver": last["solver"],
        "dual_operator": last["dual_operator"],
        "unknowns": last["primal_dimension"],
        "multipliers": last["dual_dimension"],
        "inequalities": last["inequalities"],
        "subdomains": last["subdomains"],
        "closed": last["steps"][-1].get("closed"),
        "sets": last["outer_iterations"],
        "products": max(s["hessian_applications"] for s in summaries),
    }


def of_peer(answers, before):
    """Its part of an entry, for one way; `before`: seconds of reading and assembly."""
    last = answers[-1]
    stages = {
        stage: statistics.median(answer["stages"][stage] for answer in answers) for stage in last["stages"]
    }
    return {
        "seconds": spread([before + answer["search_seconds"] + answer["seconds"] for answer in answers]),
        "solution_seconds": spread([answer["seconds"] for answer in answers]),
        "stages": rounded(stages),
        "assembly_seconds": four_digits(statistics.median(a["assembly_seconds"] for a in answers)),
        "search_seconds": four_digits(statistics.median(a["search_seconds"] for a in answers)),
        "peak_memory_mib": round(statistics.median(a["peak_memory_mib"] for a in answers)),
        "solution_memory_mib": round(statistics.median(a["solution_memory_mib"] for a in answers)),
        "energy": last["energy"],
        "candidates": last["candidates"],
        "closed": last["closed"],
        "sets": [{**entry, "seconds": four_digits(entry["seconds"])} for entry in last["sets"]],
        "iterations": max(answer["iterations"] for answer in answers),
        "petsc": last["petsc"],
        "options": last["options"],
    }


def measured(name, directory, given):
    """An entry of the JSON."""
    case = CASES[name]
    settings = {
        **(real_bodies.cut(case.scene, given.parts) if given.parts else {}),
        "Solver/Tolerance": given.tolerance,
        **dict(word.split("=", 1) for word in given.set),
    }
    scale = case.scale * given.scale
    entry = {"name": name, "scene": case.scene, "scale": scale, "set": settings}
    place = directory / name
    place.mkdir(parents=True, exist_ok=True)
    deck, mesh, nodes, cells = gmsh_meshes.write(place, case.scene, scale, PRESS)
    entry |= {"unknowns": 3 * nodes, "cells": cells, "problem": None}
    found = {who: [] for who in ("harmos", *WAYS)}
    reading = []
    try:
        for _ in range(given.repetitions):
            reading.append(gmsh_meshes.seconds_to_read(mesh.with_suffix(".msh")))
            found["harmos"] += harmos_measure.repeated(1, deck, settings, given.np, "harmos")
            for way in WAYS:
                found[way].append(run_peer(mesh, way, given))
    except (harmos_measure.RunFailed, PeerFailed, AssertionError) as error:
        print(error, file=sys.stderr)
        return {**entry, "problem": "failed"}
    entry["harmos"] = of_harmos(found["harmos"])
    entry["parts"] = entry["harmos"]["subdomains"]
    entry["reading_seconds"] = four_digits(statistics.median(reading))
    before = entry["reading_seconds"] + entry["harmos"]["stages"]["assembly"]
    entry |= {way: of_peer(found[way], before) for way in WAYS}
    reference = entry["harmos"]["energy"]
    apart = [abs(entry[way]["energy"] / reference - 1.0) for way in WAYS]
    return {
        **entry,
        "energy_difference": float(f"{max(apart):.3g}"),
        "energy_tolerance": case.tolerance(given.scale),
    }


def faults(document):
    """What an exit status other than 0 is for."""
    for entry in document["runs"]:
        if entry["problem"]:
            yield f"{entry['name']}: {entry['problem']}"
        elif not entry["energy_difference"] <= entry["energy_tolerance"]:
            apart, most = entry["energy_difference"], entry["energy_tolerance"]
            yield f"{entry['name']}: energies of Harmos and of the peer differ by {apart:g}, more than {most:g}"


def line(entry):
    """Of a case, for the terminal."""
    if entry["problem"]:
        return f"{entry['name']}: {entry['problem']}"
    seconds = (f"{who} {entry[who]['seconds']['median']:g} s" for who in ("harmos", *WAYS))
    apart = f"energies differ by {entry['energy_difference']:g}"
    return f"{entry['name']}, {entry['unknowns']} unknowns: {', '.join(seconds)}; {apart}"


def measurement(given):
    """The whole document."""
    document = {
        "benchmark": "unstructured",
        "harmos": harmos_measure.version(),
        "ranks": given.np,
        "repetitions": given.repetitions,
        "tolerance": given.tolerance,
        "rtol": given.rtol,
        "press": PRESS,
        "machine": {
            "processor": first_match(r"^model name\s*:\s*(.*)$", "/proc/cpuinfo", platform.machine()),
            "cores": os.cpu_count(),
            "memory_mib": memory_mib("MemTotal"),
            "load": round(os.getloadavg()[0], 2),
        },
        "runs": [],
    }
    with contextlib.ExitStack() as stack:
        directory = given.work or Path(stack.enter_context(tempfile.TemporaryDirectory()))
        for name in given.only or CASES:
            entry = measured(name, directory, given)
            document["runs"].append(entry)
            print(line(entry), flush=True)
    return document


def write(path, text):
    Path(path).write_text(text, encoding="utf-8")
    print(f"wrote {path}")


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", default=[], choices=list(CASES), metavar="NAME")
    parser.add_argument("--scale", type=float, default=1.0, help="of all elements")
    parser.add_argument("--parts", type=int, help="subdomains of Harmos, in the place of auto")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--tolerance", type=float, default=1e-4, help="of Harmos")
    parser.add_argument("--rtol", type=float, default=1e-5, help="of the peer's CG")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help="of Harmos' deck")
    parser.add_argument("--work", type=Path, help="where meshes are left")
    parser.add_argument("--output", type=Path, metavar="JSON")
    parser.add_argument("--page", type=Path, metavar="MARKDOWN")
    parser.add_argument("--render", action="store_true", help="measure nothing")
    return parser.parse_args()


def require_peer():
    """End with status 77 where the peer or the mesher is missing."""
    missing = [] if gmsh_meshes.available() else [gmsh_meshes.PACKAGE]
    missing += [peer_petsc.PACKAGE] if peer_petsc.directory() is None else []
    if missing:
        print(f"SKIP: Debian's {' and '.join(missing)} must be installed", file=sys.stderr)
        sys.exit(runs.SKIPPED)


def main():
    runs.TIMEOUT = 3600
    given = arguments()
    if given.render:
        document = json.loads((given.output or DOCUMENT).read_text(encoding="utf-8"))
        write(given.page or PAGE, unstructured_page.page(document))
        return 0
    require_peer()
    document = measurement(given)
    found = list(faults(document))
    for fault in found:
        print(f"error: {fault}", file=sys.stderr)
    # What is quoted is a whole measurement.
    whole = not given.only and given.scale == 1.0
    if whole or given.output:
        write(given.output or DOCUMENT, unstructured_page.as_json(document))
    if whole or given.page:
        write(given.page or PAGE, unstructured_page.page(document))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
