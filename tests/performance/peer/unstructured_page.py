# SPDX-License-Identifier: BSD-3-Clause
"""docs/unstructured.md as a function of docs/unstructured.json alone."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2] / "support")]

import real_bodies  # noqa: E402
from real_bodies_page import as_json, table, wrapped  # noqa: E402, F401

INTRODUCTION = """
Contact of bodies of tetrahedra without structure, by Harmos and by a peer that decomposes nothing: conjugate gradients
with algebraic multigrid (CG and GAMG of PETSc {petsc}) for the displacements in each of the primal-dual active sets, on
the matrix of the whole bodies. Measured in one go and in turns by `tests/performance/unstructured.py`, which writes
this page from [unstructured.json](unstructured.json). {harmos}; {ranks} ranks each, {processor} with {cores} cores,
medians of {repetitions}."""

SCENES = """
Bodies are pressed by {press:g} of their radius: {titles}. E is 1, ν 0.3. Unknowns are those of the undecomposed mesh; a
decomposition has more of them."""

HARMOS = """
**Harmos** is the program `harmos` to a tolerance of {tolerance:g}, with default settings but for the number of
subdomains{settings}. Its seconds are those of all of a run but reading, meshing, cutting and decomposition: they
have assembly, the search for contact, the choice of the first active set, factorisations, the solution, the recovery
of displacements and the audit of the answer on the primal side, which can send the solver back for more."""

PEER = """
**The peer** has its seconds from the moment on at which its matrix is assembled and its candidates for contact are
known: there is no decomposition, no assembly, no search and no audit in them. Contact is eliminated row by row; at
first what a rigid body would penetrate is closed. `plain` makes a new hierarchy with GAMG's defaults in each set, and
solves it from zero to {rtol:g} of the right-hand side. `reused` keeps the interpolation of the first hierarchy, begins
each set from the last one's displacements, and solves only the last set to {rtol:g}, those before it to a tenth of
their first residual. `best` is the fastest that was found on small meshes: as `reused`, but it keeps the whole
hierarchy of the first set, whose aggregates are not smoothed, with W cycles of symmetric SOR."""

WAYS = ("plain", "reused", "best")

MORTAR = """
Between two bodies the discretisations differ: contact of Harmos is dual mortar, that of the peer node-to-facet, both
along the normals of the ball. Energies differ by that, less on finer meshes, and not by the solvers alone."""

LIMITS = """
What is not compared here: assembly, which the peer's columns leave out and Harmos' have; meshes of congruent parts,
where Harmos shares factorisations; many ranks; materials, ties, and rows that an elimination cannot take. The peer is
a program for these scenes alone, assembled in numpy, whose memory includes Python and that assembly (in brackets: its
peak after the assembly, with the matrix)."""

TIMES = """
Seconds, medians, and in brackets how many times as long as Harmos the peer takes: below 1 the peer is faster."""

COUNTS = """
What it took: products with F and active sets of Harmos, iterations of CG in all sets of the peer. Energies are relative
to those of Harmos, the largest difference of its ways."""

MEMORY = """
Peak memory of all ranks together, MiB."""

STAGES = """
Where the time goes, seconds."""


def number(value):
    """Three digits, thousands apart."""
    return f"{value:.3g}" if value < 1000 else f"{value:,.0f}".replace(",", " ")


def seconds(entry, who):
    return entry[who]["seconds"]["median"]


def times(entries):
    rows = [
        [
            f"`{entry['name']}`",
            number(entry["unknowns"]),
            str(entry["parts"]),
            entry["harmos"]["dual_operator"],
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
    header = ["Case", "Candidates of Harmos, of the peer", "Closed in the end", "Products (sets)"]
    return table([*header, *(f"{way}: iterations (sets)" for way in WAYS), "Energies"], rows)


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
    rows = []
    for entry in entries:
        for who, title in (("harmos", "Harmos"), *((way, f"peer, {way}") for way in WAYS)):
            found = entry[who]["stages"]
            kept = {stage: value for stage, value in found.items() if stage not in ("mesh", "total")}
            parts = ", ".join(f"{stage.replace('_', ' ')} {number(value)}" for stage, value in kept.items())
            outside = (
                f"mesh {number(found['mesh'])}"
                if who == "harmos"
                else f"assembly {number(entry[who]['assembly_seconds'])}, "
                f"search {number(entry[who]['search_seconds'])}"
            )
            rows.append([f"`{entry['name']}`", title, parts, outside])
    return table(["Case", "Who", "Stages", "Not counted"], rows)


def introduction(document, entries):
    """What stands before the tables."""
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
        ("Time", TIMES, times(entries)),
        ("Work", COUNTS, counts(entries)),
        ("Memory", MEMORY, memory(entries)),
        ("Stages", STAGES, stages(entries)),
    ):
        text += [f"## {title}", wrapped(words), content]
    return "\n\n".join([*text, *failed]) + "\n"
