# SPDX-License-Identifier: BSD-3-Clause
"""Tables of docs/dual_operator.md and docs/clusters.md by performance_model.py, whose `--tables` prints them.

tests/regression/test_documents.py compares.
"""

import sys
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from performance_model import (
    FORMS,
    SECONDS,
    Machine,
    Problem,
    distributed_from,
    growth_of_products,
    step,
    table_of,
    takeover,
)


def two_digits(value):
    return f"{float(f'{value:.2g}'):g}"


def in_words(seconds):
    return f"{two_digits(seconds)} s" if seconds >= 1 else f"{two_digits(1e3 * seconds)} ms"


def pages_table(physics):
    """Of docs/dual_operator.md: replicated; distributed."""
    machine = Machine()
    loads = {"membrane": (16, 128), "solid": (8, 8)}[physics]
    problems = [Problem(*loads, physics=physics, form=form) for form in FORMS]
    titles = ("local work", "exchange", "coarse problem")
    titles += ("messages", "kB in them", "kB by collectives", "MiB of A⁻")
    lines = ["| P | " + " | ".join(titles) + " |", "|---" * (len(titles) + 1) + "|"]
    for one, other in zip(*(table_of(machine, problem) for problem in problems)):
        if one["ranks"] < 10:
            continue
        both = (one, other)
        cells = [f"{one['ranks']}", in_words(one["products"] + one["vectors"]), in_words(one["exchange"])]
        cells.append("; ".join(in_words(row["coarse"] + row["scalars"]) for row in both))
        cells.append("; ".join(f"{row['messages']:.0f}" for row in both))
        cells.append("; ".join(f"{row['message_bytes'] / 1e3:.0f}" for row in both))
        cells.append("; ".join(f"{row['collective_bytes'] / 1e3:.0f}" for row in both))
        cells.append("; ".join(two_digits(row["coarse_mib"]) for row in both))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def takeovers():
    """The ranks from which on the coarse problem takes over, by the load of a rank: shared; not shared."""
    machine, lines = Machine(), []
    lines.append("| a rank | replicated | distributed | `auto` distributes from |\n|---|---|---|---|")
    loads = [("membrane", s, 128) for s in (4, 16, 64)] + [("solid", s, n) for n in (8, 16) for s in (1, 8, 27)]
    for physics, subdomains, elements in loads:
        size = " × ".join([str(elements)] * (3 if physics == "solid" else 2))
        cells = [f"{subdomains} {physics}{'s' if subdomains > 1 else ''} of {size}"]
        for form in FORMS:
            problems = (Problem(subdomains, elements, shared, physics, form) for shared in (True, False))
            cells.append("; ".join(two_digits(takeover(machine, problem)) for problem in problems))
        cells.append(str(distributed_from(machine, problem=Problem(subdomains, elements, physics=physics))))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


CLUSTER_LOADS = (("membrane", 16, 128), ("membrane", 64, 128), ("solid", 8, 8), ("solid", 27, 8))


def half_from(machine, problem, most=10**6):
    """The number of ranks from which on all products take half as long with a cluster a rank as without, at
    most; `auto` asks for that too."""
    joined = replace(problem, cluster=problem.subdomains_per_rank)
    growth = growth_of_products(joined.cluster, joined.dimension)
    ranks = 1
    while ranks <= most:
        alone, together = (sum(step(ranks, machine, item).values()) for item in (problem, joined))
        if growth * together < 0.5 * alone:
            return ranks
        ranks = max(ranks + 1, round(1.05 * ranks))
    return None


def cluster_takeovers():
    """Ranks from which on the coarse problem takes over: none; a cluster a rank, of subdomains that share."""
    machine, lines = Machine(), []
    lines.append("| a rank | replicated | distributed | applications | half as long from |\n|---|---|---|---|---|")
    for physics, subdomains, elements in CLUSTER_LOADS:
        size = " × ".join([str(elements)] * (3 if physics == "solid" else 2))
        cells = [f"{subdomains} {physics}s of {size}"]
        problems = [Problem(subdomains, elements, physics=physics, cluster=m) for m in (1, subdomains)]
        for form in FORMS:
            places = (takeover(machine, replace(problem, form=form)) for problem in problems)
            cells.append("; ".join(two_digits(ranks) if ranks else "none" for ranks in places))
        cells.append(f"{growth_of_products(subdomains, problems[0].dimension):.1f}")
        cells.append("; ".join(two_digits(half_from(machine, replace(problems[0], form=form))) for form in FORMS))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def guide_table():
    """Of docs/clusters.md: ranks from which on the coarse problem takes over; none, and a cluster a rank."""
    machine, lines = Machine(), []
    titles = [f"{form}{joined}" for joined in ("", ", a cluster a rank") for form in FORMS]
    lines.append("| a rank has | " + " | ".join(titles) + " |\n" + "|---" * 5 + "|")
    for name, physics, subdomains, elements in (
        ("16 membranes of 128 × 128 elements", "membrane", 16, 128),
        ("8 solids of 8 × 8 × 8 elements", "solid", 8, 8),
    ):
        for shared, alike in ((True, f"{name}, congruent"), (False, "the same, not congruent")):
            problem = Problem(subdomains, elements, shared, physics)
            problems = (replace(problem, form=form, cluster=m) for m in (1, subdomains) for form in FORMS)
            cells = (two_digits(takeover(machine, item)) for item in problems)
            lines.append(f"| {alike} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def guide_words():
    """The list in docs/clusters.md: from how many ranks on clusters halve the time of all applications."""
    loads = (("solid", 8, 8), ("solid", 27, 8), ("membrane", 16, 128))
    problems = (Problem(s, n, physics=physics, form="distributed") for physics, s, n in loads)
    eight, many, membranes = (two_digits(half_from(Machine(), problem)) for problem in problems)
    return (
        f"* 8 solids of 8 × 8 × 8 elements a rank, from {eight} ranks on;\n"
        f"* 27 of these solids a rank, from {many} ranks on;\n"
        f"* 16 membranes of 128 × 128 elements a rank, from {membranes} ranks on."
    )


def cluster_table(physics):
    """A step with a distributed coarse problem: no clusters; one a rank."""
    machine = Machine()
    loads = {"membrane": (16, 128), "solid": (8, 8)}[physics]
    problems = [Problem(*loads, physics=physics, form="distributed", cluster=m) for m in (1, loads[0])]
    growth = growth_of_products(loads[0], problems[0].dimension)
    titles = ("coarse dimension", "coarse problem", "joins", "kB by collectives", "MiB of A⁻", "time, over none")
    lines = ["| P | " + " | ".join(titles) + " |", "|---" * (len(titles) + 1) + "|"]
    for one, other in zip(*(table_of(machine, problem) for problem in problems)):
        if one["ranks"] < 100:
            continue
        both = (one, other)
        cells = [f"{one['ranks']}", "; ".join(f"{row['coarse_dimension']:.0f}" for row in both)]
        cells.append("; ".join(in_words(row["coarse"] + row["scalars"]) for row in both))
        cells.append(in_words(other["joins"]))
        cells.append("; ".join(f"{row['collective_bytes'] / 1e3:.0f}" for row in both))
        cells.append("; ".join(two_digits(row["coarse_mib"]) for row in both))
        alone, together = (sum(row[name] for name in SECONDS) for row in both)
        cells.append(two_digits(growth * together / alone))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def all_of_them():
    both = ("membrane", "solid")
    tables = [*map(pages_table, both), takeovers(), *map(cluster_table, both), cluster_takeovers()]
    return "\n\n".join([*tables, guide_table(), guide_words()])
