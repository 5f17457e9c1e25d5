# SPDX-License-Identifier: BSD-3-Clause
"""docs/headline.md and the README's figures as functions of docs/headline.json alone.

tests/regression/test_documents.py makes both anew and compares.
"""

import json
import math
import shlex
import textwrap

from published_figures import (
    PAPER_CG,
    PAPER_LARGEST_SECONDS,
    PERMON,
    PERMON_LARGEST_GB,
    PERMON_LARGEST_PRODUCTS,
    PERMON_LARGEST_SECONDS,
    SIDES,
)

BEGIN = "<!-- headline: begin; written by tests/performance/headline.py --render -->"
END = "<!-- headline: end -->"
LINE = 125


class Incomplete(ValueError):
    """A figure of the README was not measured."""


def as_json(document):
    """A line a run: what a new measurement changed shows in a diff."""
    head = json.dumps({**document, "runs": []}, indent=1, ensure_ascii=False)
    lines = [json.dumps(entry, ensure_ascii=False) for entry in document["runs"]]
    return head.replace('"runs": []', '"runs": [\n  ' + ",\n  ".join(lines) + "\n ]") + "\n"


def two_digits(value):
    """Two that count; whole numbers from ten on."""
    if value <= 0.0:
        return "0"
    decimals = max(0, 1 - math.floor(math.log10(value)))
    return f"{value:.{decimals}f}"


def seconds(entry, stage="total"):
    return two_digits(entry[f"seconds_{stage}"]["median"])


def gib(entry):
    return two_digits(entry["peak_memory_mib"]["median"] / 1024.0)


def by_name(document):
    return {entry["name"]: entry for entry in document["runs"]}


def needed(entries, name):
    entry = entries.get(name)
    if entry is None:
        raise Incomplete(f"{name} was not measured")
    if entry["problem"]:
        raise Incomplete(f"{name} was {entry['problem']}")
    if not entry["converged"]:
        raise Incomplete(f"{name} did not converge")
    return entry


def wrapped(text):
    return textwrap.fill(
        " ".join(text.split()), LINE, break_long_words=False, break_on_hyphens=False
    )


def cell_products(entries, group, n):
    """Of a row of the table; a dash for what was not measured."""
    row = [entries.get(f"{group}-{s}x{n}") for s in SIDES]
    return [entry["products"] if entry and not entry["problem"] else "—" for entry in row]


def products_table(entries, permon_rule):
    """The table of products; with the row of PERMON's rule on the page only."""
    text = ["| H/h | | " + " | ".join(f"1/H = {s}" if s == 1 else str(s) for s in SIDES) + " |"]
    text.append("|---" * (2 + len(SIDES)) + "|")
    for n in PAPER_CG:
        rows = [
            ("Harmos, all products", cell_products(entries, "default", n)),
            ("Harmos, no preconditioner", cell_products(entries, "plain", n)),
        ]
        if permon_rule:
            rows.append(("the same, PERMON's rule", cell_products(entries, "permon", n)))
        rows += [("PERMON, all products", PERMON[n]), ("paper, CG iterations", PAPER_CG[n])]
        for k, (words, row) in enumerate(rows):
            cells = " | ".join(map(str, row))
            text.append(f"| {n if k == 0 else ''} | {words} | {cells} |".replace("|  |", "| |"))
    return "\n".join(text)


def joined(words):
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def permon_rule(entries):
    """Where the other stopping rule takes other numbers of products, in words."""
    parts = []
    for n in PAPER_CG:
        pairs = [
            (str(a), str(b))
            for a, b in zip(cell_products(entries, "permon", n), cell_products(entries, "plain", n))
            if a != b
        ]
        if pairs:
            theirs, ours = zip(*pairs)
            parts.append(f"{joined(theirs)} instead of {joined(ours)} for H/h = {n}")
    if not parts:
        return "ours without preconditioner are the same"
    return f"ours without preconditioner are {'; '.join(parts)}, and else the same"


def largest(entries):
    """The sentences on large problems."""
    shared, unshared, fields, large, cube, other_cube, stretch, compression, solid = (
        needed(entries, name)
        for name in (
            "paper-shared",
            "paper-unshared",
            "paper-unshared-fields",
            "large",
            "cube-512",
            "cube-216",
            "composite-stretch",
            "composite-compression",
            "half-ball",
        )
    )
    return wrapped(f"""
        The largest problem of the paper, {shared['unknowns']} unknowns and
        {shared['multipliers']} multipliers, to 1e-4 on two cores: {seconds(shared)} s and
        {gib(shared)} GiB; without sharing factorisations {seconds(unshared)} s and
        {gib(unshared)} GiB, with result files {seconds(fields)} s and {gib(fields)} GiB (PERMON
        3.18 on such a machine: {PERMON_LARGEST_SECONDS} s, {PERMON_LARGEST_GB} GB).
        {large['unknowns'] / 1e6:.0f} million unknowns: {seconds(large)} s, {gib(large)} GiB. An
        elastic cube of {cube['unknowns']} unknowns on a rigid plane (`block.xml`), to 1e-4, as
        8 × 8 × 8 subdomains of 8 × 8 × 8 elements: {cube['products']} products,
        {seconds(cube)} s, {gib(cube)} GiB; as 6 × 6 × 6 of 11 × 11 × 11:
        {other_cube['products']} products, {seconds(other_cube)} s, {gib(other_cube)} GiB. The
        fibre composite of 30 × 30 cells,
        {stretch['unknowns']} unknowns and {stretch['inequalities']} inequalities:
        {stretch['products']} products and {seconds(stretch)} s stretched,
        {compression['products']} and {seconds(compression)} s compressed. Half a ball of
        tetrahedra on a plane, {solid['unknowns']} unknowns, {solid['inequalities']} inequalities,
        {solid['subdomains']} subdomains of which no two are alike: {solid['products']} products,
        {seconds(solid)} s, {gib(solid)} GiB. Machine, commands and spread: [headline
        figures](docs/headline.md).""")


def readme_block(document):
    """What stands between the README's markers. @throws Incomplete."""
    entries = by_name(document)
    for group in ("default", "plain", "permon"):
        for n in PAPER_CG:
            for s in SIDES:
                needed(entries, f"{group}-{s}x{n}")
    table = wrapped(f"""
        Products with F to a relative tolerance of 1e-4, two ranks, with default settings
        (Dirichlet preconditioner, PDAS) and without preconditioner (SMALBE); beside them the
        conjugate gradient iterations the paper reports and all Hessian applications of PERMON 3.18
        with tuned options. The stopping rules differ (ours is `scaled`, see
        [theory](docs/theory.md)); under PERMON's rule, `Solver/Stopping rule` = `permon`,
        {permon_rule(entries)}. `tests/verification` asserts that no cell needs more than the
        paper's (0.6 of it for H/h = 128), and without preconditioner none more than PERMON's under
        its rule.""")
    return "\n\n".join([largest(entries), table, products_table(entries, permon_rule=False)])


def with_block(readme, document):
    """The README with its figures anew."""
    before, rest = readme.split(BEGIN)
    after = rest.split(END)[1]
    return f"{before}{BEGIN}\n\n{readme_block(document)}\n\n{END}{after}"


def command(entry, ranks):
    words = [f"mpirun -np {ranks} build/bin/{entry['program']} {entry['deck']}"]
    for path, value in entry["set"].items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        words.append(f"--set {shlex.quote(f'{path}={text}')}".replace("'", '"'))
    return " ".join([*words, "--output run"])


def memory(entry):
    used, limit = entry["peak_memory_mib"]["median"], entry["memory_limit_mib"]
    return f"{gib(entry)} ({used} MiB" + (f", to be below {limit})" if limit else ")")


def row(entry):
    first = f"| `{entry['name']}`: {entry['title']} "
    if entry["problem"]:
        return f"{first}| {entry['problem']} | | | | | |"
    least, most = (two_digits(entry["seconds_total"][key]) for key in ("least", "most"))
    return (
        f"{first}| {entry['unknowns']} / {entry['multipliers']} "
        f"| {entry['inequalities']} | {entry['factorizations']} of {entry['subdomains']} "
        f"| {entry['products'] if entry['converged'] else 'did not converge'} "
        f"| {seconds(entry)} ({least}, {most}); {seconds(entry, 'solve')} | {memory(entry)} |"
    )


INTRODUCTION = """
What the [README](../README.md#what-works) claims, as it was measured: written by
`tests/performance/headline.py` from [headline.json](headline.json), and so are the figures of the
README; a test compares all three."""

MEASURED = """
Measured on {date} with `{harmos}`, {compiler}, {ranks} ranks{quick}. Machine: {processor}, {cores}
cores, {gib} of memory, a load of {load} when the measurement began. Seconds and memory are
{statistic}, memory is the sum of the ranks' peaks. Tolerance 1e-4, Hertz' problems 1e-6; without
result files, but for the case that says so."""

PRODUCTS = """
PERMON's are all Hessian applications of PERMON 3.18 with tuned options on two ranks, the paper's
are conjugate gradient iterations (Dostál, Horák, Vlach). Stopping rules: ours is `scaled`; that of
PERMON is `permon` ([theory](theory.md))."""

PEERS = f"""
The largest problem of the paper takes PERMON 3.18 with CHOLMOD, on a machine of two cores,
{PERMON_LARGEST_PRODUCTS} products, {PERMON_LARGEST_SECONDS} s and {PERMON_LARGEST_GB} GB; it took
the paper {PAPER_LARGEST_SECONDS} s on 64 processors of its time."""


def head(document):
    machine = document["machine"]
    size, count = machine["memory_mib"], document["repetitions"]
    measured = MEASURED.format(**{
        **document,
        **machine,
        "quick": ", **tiny forms of the cases**" if document["quick"] else "",
        "gib": f"{size / 1024:.0f} GiB" if size else "unknown size",
        "statistic": f"medians of {count} runs" if count > 1 else "those of one run",
    })
    return "\n\n".join(["# Headline figures", wrapped(INTRODUCTION), wrapped(measured), ""])


def theory_table(entries):
    """Hertz' quantities beside theory."""
    found = [e for e in entries.values() if not e["problem"] and e["from_theory"]]
    if not found:
        return ""
    names = list(found[0]["from_theory"])
    text = ["## Distance from Hertz' theory", ""]
    text.append("| | " + " | ".join(name.replace("_", " ") for name in names) + " |")
    text.append("|---" * (1 + len(names)) + "|")
    for entry in found:
        shares = " | ".join(f"{100.0 * entry['from_theory'][name]:.2f} %" for name in names)
        text.append(f"| `{entry['name']}` | {shares} |")
    return "\n".join([*text, ""])


def commands(document):
    """One for each case, and for the cells of the table one for each row."""
    lines, groups = [], set()
    for entry in document["runs"]:
        group = entry["group"]
        if group is None or group not in groups:
            others = "" if group is None else f", and so the other {group} ones"
            lines += [f"# {entry['name']}{others}", command(entry, document["ranks"])]
        groups.add(group)
    return "\n".join(lines)


def page(document):
    """docs/headline.md."""
    entries = by_name(document)
    cells = [entry for entry in document["runs"] if entry["group"]]
    others = [entry for entry in document["runs"] if not entry["group"]]
    text = [head(document)]
    if cells:
        text += ["## Products of the model problem", "", wrapped(PRODUCTS), ""]
        text += [products_table(entries, permon_rule=True), ""]
        text += [f"* `{e['name']}`: {e['problem']}" for e in cells if e["problem"]]
    if others:
        text.append("## Large and hard problems\n")
        text.append(
            "| | Unknowns / multipliers | Inequalities | Factorisations of subdomains | Products "
            "| Seconds in all (least, most); solving | Memory, GiB |"
        )
        text.append("|---" * 7 + "|")
        text += [*map(row, others), "", wrapped(PEERS), "", theory_table(entries)]
    text.append("## Commands\n")
    text.append("All of it: `/usr/bin/python3 tests/performance/headline.py`; case by case:\n")
    text.append(f"```sh\n{commands(document)}\n```")
    return "\n".join(text) + "\n"
