# SPDX-License-Identifier: BSD-3-Clause
"""docs/unstructured.md as a function of docs/unstructured.json alone."""

import sys
import textwrap
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2] / "support")]

import real_bodies  # noqa: E402
from real_bodies_page import LINE, as_json, table, wrapped  # noqa: E402, F401

INTRODUCTION = """
This page compares Harmos with a peer without domain decomposition, for contact of bodies with unstructured meshes of
tetrahedra. The peer is a primal-dual active set method for the displacements. It solves each active set by conjugate
gradients with algebraic multigrid (CG and GAMG of PETSc {petsc}) on the matrix of the whole bodies.

`tests/performance/unstructured.py` measures both in turns and renders this page from
[unstructured.json](unstructured.json). Version {harmos}; {ranks} ranks each, {processor} with {cores} cores, medians
of {repetitions} runs."""

SCENES = """
The bodies are pressed by {press:g} of their radius: {titles}. E is 1 and ν is 0.3. Unknowns are those of the whole
mesh; a decomposition has more."""

HARMOS = """
**Harmos** is the program `harmos` with a tolerance of {tolerance:g} and default settings{settings}; it chooses the
number of subdomains. Its time is that of a whole run: reading the mesh file, cutting, assembly, the search for contact,
the choice of the first active set, factorisations, the solver, the recovery of displacements, and the audit of the
result on the primal side, which can make the solver continue."""

PEER = """
**The peer** assembles in numpy. Its time is made of three parts: reading the same file by Gmsh's module, the assembly
of Harmos (its stage *assembly*) in the place of its own, and its search and solution. Distribution of the matrix and
an audit of the result are not in it. Contact constraints are eliminated row by row. The first active set consists of
the points where rigid bodies would penetrate. Three variants were measured.

`plain` makes a new hierarchy with GAMG's defaults for each active set, and solves from zero to {rtol:g} of the
right-hand side.

`reused` keeps the interpolation of the first hierarchy and starts each set from the displacements of the previous
one. It solves the last set to {rtol:g}, and each earlier set to a tenth of its initial residual.

`best` is the fastest variant that was found on small meshes: like `reused`, but it keeps the whole hierarchy of the
first set, with unsmoothed aggregation and W cycles of symmetric SOR."""

WAYS = ("plain", "reused", "best")

MORTAR = """
Between two bodies the discretisations differ: Harmos uses dual mortar contact, the peer node-to-facet contact, both
along the normals of the ball. The energies differ for this reason too; the difference decreases on finer meshes."""

LIMITS = """
**Not compared**: meshes with congruent parts, for which Harmos
shares factorisations; many ranks; several materials, ties, and constraints that an elimination cannot take. The peer
is a program for these scenes only. It assembles in numpy, and its memory includes Python and the assembly; the number
in brackets is its peak after assembly, with the matrix."""

TIMES = """
Seconds of whole runs (medians). In brackets: the time of the peer over that of Harmos. Below 1, the peer is
faster.{ranges}"""

COUNTS = """
Candidates and closed contacts: of Harmos, of the peer. F: applications of F by Harmos. The next three columns are CG
iterations of the peer over all its active sets. In brackets: numbers of active sets. The last column is the largest
difference of an energy of the peer, relative to that of Harmos."""

MEMORY = """
Peak memory of all ranks together, in MiB."""

STAGES = """
Seconds of each stage; of the peer those of its solution, and what is before it."""


def number(value):
    """Three significant digits; a space between thousands."""
    return f"{value:.3g}" if value < 1000 else f"{value:,.0f}".replace(",", " ")


def seconds(entry, who):
    return entry[who]["seconds"]["median"]


def ranges(entries):
    """The least and largest quotients of each way, in a sentence."""
    if not entries:
        return ""
    parts = []
    for way in WAYS:
        found = [seconds(entry, way) / seconds(entry, "harmos") for entry in entries]
        parts.append(f"`{way}` {min(found):.2f} to {max(found):.2f}")
    return f" The quotients are: {', '.join(parts)}."


def times(entries):
    rows = [
        [
            f"`{entry['name']}`",
            number(entry["unknowns"]),
            str(entry["parts"]),
            entry["harmos"]["dual_operator"].removesuffix(" preconditioner"),
            number(seconds(entry, "harmos")),
            *(
                f"{number(seconds(entry, way))} ({seconds(entry, way) / seconds(entry, 'harmos'):.2f})"
                for way in WAYS
            ),
        ]
        for entry in entries
    ]
    header = ["Case", "Unknowns", "Parts", "Dual operator", "Harmos", *(f"Peer, {way}" for way in WAYS)]
    return table(header, rows)


def counts(entries):
    rows = [
        [
            f"`{entry['name']}`",
            f"{entry['harmos']['inequalities']}, {entry['best']['candidates']}",
            f"{entry['harmos']['closed']}, {entry['best']['closed']}",
            f"{entry['harmos']['products']} ({entry['harmos']['sets']})",
            *(f"{entry[way]['iterations']} ({len(entry[way]['sets'])})" for way in WAYS),
            f"{entry['energy_difference']:.1e}",
        ]
        for entry in entries
    ]
    header = ["Case", "Candidates", "Closed", "F (sets)"]
    return table([*header, *(f"Peer, {way}" for way in WAYS), "Energy"], rows)


def memory(entries):
    rows = [
        [
            f"`{entry['name']}`",
            number(entry["harmos"]["peak_memory_mib"]),
            *(
                f"{number(entry[way]['peak_memory_mib'])} ({number(entry[way]['solution_memory_mib'])})"
                for way in WAYS
            ),
        ]
        for entry in entries
    ]
    return table(["Case", "Harmos", *(f"Peer, {way}" for way in WAYS)], rows)


def stages(entries):
    lines = []
    for entry in entries:
        lines.append(f"* `{entry['name']}`")
        for who, title in (("harmos", "Harmos"), *((way, f"peer, {way}") for way in WAYS)):
            found = entry[who]["stages"]
            kept = {stage: value for stage, value in found.items() if stage != "total"}
            parts = ", ".join(f"{stage.replace('_', ' ')} {number(value)}" for stage, value in kept.items())
            before = (
                ""
                if who == "harmos"
                else f"; before it reading {number(entry['reading_seconds'])}, "
                f"search {number(entry[who]['search_seconds'])}, its own assembly "
                f"{number(entry[who]['assembly_seconds'])}"
            )
            lines += textwrap.wrap(f"* {title}: {parts}{before}", LINE, break_on_hyphens=False,
                                   initial_indent="  ", subsequent_indent="    ")
    return "\n".join(lines)


def introduction(document, entries):
    """The text before the tables."""
    machine = document["machine"]
    head = {
        "petsc": entries[0]["best"]["petsc"] if entries else "",
        "harmos": f"`{document['harmos']}`",
        "processor": machine["processor"],
        "cores": machine["cores"],
    }
    names = {name: [] for name in dict.fromkeys(entry["scene"] for entry in entries)}
    for entry in entries:
        names[entry["scene"]].append(f"`{entry['name']}`")
    titles = [f"{' and '.join(found)}, {real_bodies.BODIES[scene].title}" for scene, found in names.items()]
    extra = {
        f"`{name}` = {value}"
        for entry in entries
        for name, value in entry["set"].items()
        if not name.startswith("Bodies/") and name != "Solver/Tolerance"
    }
    settings = f" and {', '.join(sorted(extra))}" if extra else ""
    given = {**document, **head, "titles": "; ".join(titles), "settings": settings}
    text = [INTRODUCTION, SCENES, HARMOS, PEER]
    text += [MORTAR] if "ball-on-block" in names else []
    return [wrapped(words.format(**given)) for words in (*text, LIMITS)]


def page(document):
    """docs/unstructured.md."""
    entries = [entry for entry in document["runs"] if not entry["problem"]]
    text = ["# Unstructured meshes beside algebraic multigrid", *introduction(document, entries)]
    failed = [f"`{entry['name']}`: {entry['problem']}." for entry in document["runs"] if entry["problem"]]
    for title, words, content in (
        ("Time", TIMES.format(ranges=ranges(entries)), times(entries)),
        ("Work", COUNTS, counts(entries)),
        ("Memory", MEMORY, memory(entries)),
        ("Stages", STAGES, stages(entries)),
    ):
        text += [f"## {title}", wrapped(words), content]
    return "\n\n".join([*text, *failed]) + "\n"
