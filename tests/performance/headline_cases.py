# SPDX-License-Identifier: BSD-3-Clause
"""The cases of headline.py, each also in a tiny form."""

from dataclasses import dataclass

import harmos_runs as runs
import model_problem

HERE = "tests/performance"


@dataclass(frozen=True)
class Case:
    """A run to measure; names and paths are those of JSON and page."""

    name: str
    title: str
    deck: str  # from the top of the source tree
    sets: dict
    tiny: dict  # further overrides with --quick
    program: str = "signorini"
    needs_mib: int = 1024  # skipped if less memory is free
    limit_mib: int = None  # upper limit of the peak memory
    group: str = None  # row in the table of the model problem; None for other cases


MODEL = str(runs.MODEL.relative_to(runs.SOURCE))
BLOCK = str((runs.DECKS / "block.xml").relative_to(runs.SOURCE))
COMPOSITE = str(runs.COMPOSITE.relative_to(runs.SOURCE))

# Rows of the table of the model problem, in the words of --list.
GROUPS = {
    "default": ("shared", {}, "default settings"),
    "plain": ("unpreconditioned", {}, "without preconditioner"),
    "permon": (
        "unpreconditioned",
        {"Solver/Stopping rule": "permon"},
        "without preconditioner, PERMON's stopping rule",
    ),
}


def cells():
    for group, (kind, more, words) in GROUPS.items():
        for s, n in model_problem.CELLS:
            yield Case(
                name=f"{group}-{s}x{n}",
                title=f"1/H = {s}, H/h = {n}, {words}",
                deck=MODEL,
                sets={**model_problem.cell_sets(s, n, kind), **more},
                tiny={"Model/Elements per subdomain side": {8: 2, 32: 3, 128: 4}[n]},
                group=group,
            )


def membranes(name, title, s, n, kind="shared", fields=False, **more):
    sets = {**model_problem.cell_sets(s, n, kind), "Output/Fields": fields}
    tiny = {"Model/Subdomains per side": 2, "Model/Elements per subdomain side": 8}
    return Case(name, title, MODEL, sets, tiny, **more)


def cube(s, n):
    return Case(
        f"cube-{s**3}",
        "an elastic cube on a rigid plane, "
        f"{s} × {s} × {s} subdomains of {n} × {n} × {n} elements",
        BLOCK,
        {
            "Model/Subdomains per side": s,
            "Model/Elements per subdomain side": n,
            "Output/Fields": False,
        },
        {"Model/Subdomains per side": 2, "Model/Elements per subdomain side": 2},
        needs_mib=4096,
    )


def composite(load, words):
    return Case(
        f"composite-{load}",
        f"the fibre composite of 30 × 30 cells, {words}",
        COMPOSITE,
        {"Model/Columns": 30, "Model/Rows": 30, "Model/Load": load, "Output/Fields": False},
        {"Model/Columns": 2, "Model/Rows": 2},
        program="fiber_composite",
    )


def hertz(body):
    deck = runs.DECKS / f"hertz_{body}.xml"
    return Case(
        f"hertz-{body}",
        f"Hertz' {body}, as the deck says",
        str(deck.relative_to(runs.SOURCE)),
        {"Output/Fields": False},
        {"Model/Subdomains per side": 2, "Model/Elements per subdomain side": 2},
    )


def others():
    largest = "the largest problem of the paper"
    yield membranes("paper-shared", f"{largest}, default settings", 8, 256)
    yield membranes(
        "paper-unshared",
        f"{largest}, a factorisation for each subdomain",
        8,
        256,
        "unshared",
        needs_mib=9216,
    )
    # Its peak was once 8238 MiB, while fields were written.
    yield membranes(
        "paper-unshared-fields",
        f"{largest}, a factorisation for each subdomain, with result files",
        8,
        256,
        "unshared",
        fields=True,
        needs_mib=10240,
        limit_mib=8192,
    )
    many = "the model problem with 32 × 32 subdomains a membrane, default settings"
    yield membranes("large", many, 32, 256, needs_mib=4096)
    yield cube(8, 8)
    yield cube(6, 11)
    yield composite("stretch", "stretched")
    yield composite("compression", "compressed")
    yield hertz("cylinder")
    yield hertz("ball")
    yield Case(
        "half-ball",
        "half a ball of linear tetrahedra on a rigid plane, no two subdomains alike",
        f"{HERE}/decks/half_ball.xml",
        {"Output/Fields": False},
        {"Model/Mesh file": "half_ball_coarse.geo", "Bodies/ball/Subdomains": 4},
        program="harmos",
        needs_mib=4096,
    )


CASES = {case.name: case for case in (*cells(), *others())}
