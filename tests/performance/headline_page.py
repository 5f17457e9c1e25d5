# SPDX-License-Identifier: BSD-3-Clause
"""docs/headline.md and the README's sentence as functions of docs/headline.json.

The page also reads the logs beside the decks: a deck that takes another number of applications since the
measurement is named. tests/regression/test_documents.py renders both anew and compares.
"""

import json
import math
import re
import shlex
import textwrap

import harmos_runs as runs
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
LINE = 118


class Incomplete(ValueError):
    """A headline figure was not measured."""


def as_json(document):
    """One run per line, so that a diff shows which runs a new measurement changed."""
    head = json.dumps({**document, "runs": []}, indent=1, ensure_ascii=False)
    lines = [json.dumps(entry, ensure_ascii=False) for entry in document["runs"]]
    return head.replace('"runs": []', '"runs": [\n  ' + ",\n  ".join(lines) + "\n ]") + "\n"


def two_digits(value):
    """Two significant digits; whole numbers from ten on."""
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
    """Paragraphs, filled."""
    return "\n\n".join(
        textwrap.fill(" ".join(paragraph.split()), LINE, break_long_words=False, break_on_hyphens=False)
        for paragraph in text.strip().split("\n\n")
    )


def cell_products(entries, group, n):
    """One row of the table; a dash where nothing was measured."""
    row = [entries.get(f"{group}-{s}x{n}") for s in SIDES]
    return [entry["products"] if entry and not entry["problem"] else "—" for entry in row]


def products_table(entries):
    """Applications of F for the model problem, beside PERMON and the paper."""
    text = ["| H/h | | " + " | ".join(f"1/H = {s}" if s == 1 else str(s) for s in SIDES) + " |"]
    text.append("|---" * (2 + len(SIDES)) + "|")
    for n in PAPER_CG:
        rows = [
            ("Harmos, default settings", cell_products(entries, "default", n)),
            ("Harmos, no preconditioner", cell_products(entries, "plain", n)),
            ("the same, PERMON's stopping rule", cell_products(entries, "permon", n)),
            ("PERMON 3.18", PERMON[n]),
            ("paper, CG iterations", PAPER_CG[n]),
        ]
        for k, (words, row) in enumerate(rows):
            cells = " | ".join(map(str, row))
            text.append(f"| {n if k == 0 else ''} | {words} | {cells} |".replace("|  |", "| |"))
    return "\n".join(text)


LARGEST = (
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


def cost(entry):
    return f"{seconds(entry)} s and {gib(entry)} GiB"


def work(entry):
    return f"{entry['products']} applications of F, {seconds(entry)} s"


def bullet(text):
    return textwrap.fill(
        " ".join(text.split()), LINE, break_long_words=False, break_on_hyphens=False, initial_indent="* ",
        subsequent_indent="  ",
    )


def in_short(entries):
    """The chief figures in sentences. @throws Incomplete."""
    found = {name: needed(entries, name) for name in LARGEST}
    largest, cube, solid = found["paper-shared"], found["cube-512"], found["half-ball"]
    stretch, compression = found["composite-stretch"], found["composite-compression"]
    return "\n".join(
        bullet(text)
        for text in (
            f"""The largest model problem of the paper has {largest['unknowns']} unknowns and
            {largest['multipliers']} multipliers. Harmos solves it in {cost(largest)}. If each subdomain has a
            factorisation of its own, the run takes {cost(found['paper-unshared'])}; with result files
            {cost(found['paper-unshared-fields'])}. PERMON 3.18 on such a machine takes
            {PERMON_LARGEST_SECONDS} s and {PERMON_LARGEST_GB} GB.""",
            f"""The model problem with {found['large']['unknowns'] / 1e6:.0f} million unknowns takes
            {cost(found['large'])}.""",
            f"""An elastic cube of {cube['unknowns']} unknowns on a rigid plane (`block.xml`), cut into
            8 × 8 × 8 subdomains of 8 × 8 × 8 elements, takes {work(cube)} and {gib(cube)} GiB. Cut into
            6 × 6 × 6 subdomains of 11 × 11 × 11 elements, it takes {work(found['cube-216'])} and
            {gib(found['cube-216'])} GiB.""",
            f"""The fibre composite of 30 × 30 cells has {stretch['unknowns']} unknowns and
            {stretch['inequalities']} inequalities. Stretched, it takes {work(stretch)}; compressed,
            {work(compression)}.""",
            f"""Half a ball of tetrahedra on a rigid plane has {solid['unknowns']} unknowns,
            {solid['inequalities']} inequalities and {solid['subdomains']} subdomains, no two of them alike. It
            takes {work(solid)} and {gib(solid)} GiB.""",
        )
    )


def readme_block(document):
    """The text between the README's markers. @throws Incomplete."""
    entries = by_name(document)
    for group in ("default", "plain", "permon"):
        for n in PAPER_CG:
            for s in SIDES:
                needed(entries, f"{group}-{s}x{n}")
    in_short(entries)
    largest, unshared, large, solid = (
        needed(entries, name) for name in ("paper-shared", "paper-unshared", "large", "half-ball")
    )
    return "\n".join([
        f"**Cost** on {document['machine']['cores']} cores, to a relative tolerance of 1e-4"
        " ([all figures](docs/headline.md), with machine and commands):",
        "",
        bullet(f"""two membranes with {largest['unknowns'] / 1e6:.1f} million unknowns: {cost(largest)}. Equal
            subdomains share a factorisation; without sharing, {cost(unshared)}. PERMON 3.18 on such a machine:
            {PERMON_LARGEST_SECONDS} s and {PERMON_LARGEST_GB} GB."""),
        bullet(f"the same with {large['unknowns'] / 1e6:.0f} million unknowns, shared: {cost(large)}."),
        bullet(f"""half a ball of tetrahedra on a plane, {solid['unknowns']} unknowns, all
            {solid['subdomains']} subdomains different: {cost(solid)}."""),
    ])


def with_block(readme, document):
    """The README with the figures of a document."""
    before, rest = readme.split(BEGIN)
    after = rest.split(END)[1]
    return f"{before}{BEGIN}\n\n{readme_block(document)}\n\n{END}{after}"


def continued(words):
    """A command of the shell in lines that end in a backslash."""
    lines = [words[0]]
    for word in words[1:]:
        if len(lines[-1]) + len(word) + 1 > LINE - len(" \\"):
            lines.append("   ")
        lines[-1] += f" {word}"
    return " \\\n".join(lines)


def command(entry, ranks):
    words = [f"mpirun -np {ranks} build/bin/{entry['program']} {entry['deck']}"]
    for path, value in entry["set"].items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        words.append(f"--set {shlex.quote(f'{path}={text}')}".replace("'", '"'))
    return continued([*words, "--output run"])


def memory(entry):
    used, limit = entry["peak_memory_mib"]["median"], entry["memory_limit_mib"]
    return f"{gib(entry)} ({used} MiB" + (f", limit {limit})" if limit else ")")


def row(entry):
    first = f"| `{entry['name']}` "
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
The chief figures of Harmos: seconds, memory, and applications of the dual operator F, which are the unit of cost of
a FETI method. `tests/performance/headline.py` measures them, writes [headline.json](headline.json), and renders this
page and the sentence in the [README](../README.md#what-works) from it. A test compares the three. "The paper" is
Dostál, Horák, Vlach: *Toward scalable FETI algorithm for variational inequalities with applications to composites*."""

MEASURED = """
Measured on {date} with `{harmos}`, {compiler}, {ranks} ranks{quick}. Machine: {processor}, {cores}
cores, {gib} of memory, a load of {load} at the beginning. Seconds and memory are
{statistic}; memory is the sum of the ranks' peaks. The tolerance is 1e-4, for Hertz' problems 1e-6. Result files are
not written, except where a case says so."""

CHANGED = """
The measurement is older than this version. By the logs beside the decks, these cases now take another number of
applications of F: {changes}."""

PRODUCTS = """
Each membrane has S × S subdomains (S = 1/H) of N × N elements (N = H/h). The table counts all applications of F from
the first iterate to the stop, to a relative tolerance of 1e-4. The default settings are the Dirichlet preconditioner
and the solver PDAS; without preconditioner the solver is SMALBE. The rows of PERMON 3.18 count all its Hessian
applications, with tuned options on two ranks; those of the paper count its conjugate gradient iterations. The
stopping rules differ: Harmos uses the rule `scaled`, PERMON the rule `permon` ([theory](theory.md)).

`tests/verification` asserts two bounds. Default settings need at most as many applications as the paper needs
iterations, and at most 0.6 times as many for H/h = 128. Without preconditioner and with PERMON's rule, Harmos needs at
most as many applications as PERMON."""

COLUMNS = """
Factorisations are those that were made, of the number of subdomains; F stands for applications of F. Seconds are
those of the whole run, with least and most in brackets, then those of the solver alone."""

PEERS = f"""
PERMON 3.18 with CHOLMOD takes {PERMON_LARGEST_PRODUCTS} applications, {PERMON_LARGEST_SECONDS} s and
{PERMON_LARGEST_GB} GB for the largest problem of the paper, on a machine of two cores. The paper took
{PAPER_LARGEST_SECONDS} s on 64 processors of its time."""

COUNTED = re.compile(r"(?m)^Converged: .*?(\d+) (?:products with|applications of) F\b")


def changed_counts(document):
    """Cases that run a deck as it is, but whose log has another number of applications; in words."""
    parts = []
    for entry in document["runs"]:
        log = (runs.SOURCE / entry["deck"]).with_suffix(".log")
        if entry["problem"] or set(entry["set"]) - {"Output/Fields"} or not log.exists():
            continue
        found = COUNTED.search(log.read_text(encoding="utf-8"))
        if found and int(found.group(1)) != entry["products"]:
            parts.append(f"`{entry['name']}` {found.group(1)} (measured: {entry['products']})")
    return "; ".join(parts)


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
    changes = changed_counts(document)
    later = [wrapped(CHANGED.format(changes=changes))] if changes else []
    return "\n\n".join(["# Headline figures", wrapped(INTRODUCTION), wrapped(measured), *later])


def theory_table(entries):
    """Relative differences from Hertz' theory."""
    found = [e for e in entries.values() if not e["problem"] and e["from_theory"]]
    if not found:
        return ""
    names = list(found[0]["from_theory"])
    text = ["## Difference from Hertz' theory", ""]
    text.append("| | " + " | ".join(name.replace("_", " ") for name in names) + " |")
    text.append("|---" * (1 + len(names)) + "|")
    for entry in found:
        shares = " | ".join(f"{100.0 * entry['from_theory'][name]:.2f} %" for name in names)
        text.append(f"| `{entry['name']}` | {shares} |")
    return "\n".join([*text, ""])


def commands(document):
    """One for each case; for the cells of the table, one for each row."""
    lines, groups = [], set()
    for entry in document["runs"]:
        group = entry["group"]
        if group is None or group not in groups:
            others = "" if group is None else f"; the other {group} cells likewise"
            lines += [f"# {entry['name']}{others}", command(entry, document["ranks"])]
        groups.add(group)
    return "\n".join(lines)


def page(document):
    """docs/headline.md."""
    entries = by_name(document)
    cells = [entry for entry in document["runs"] if entry["group"]]
    others = [entry for entry in document["runs"] if not entry["group"]]
    text = [head(document), ""]
    try:
        text += ["## In short", "", in_short(entries), ""]
    except Incomplete:
        pass  # some cases alone, or skipped ones
    if cells:
        text += ["## The model problem", "", wrapped(PRODUCTS), "", products_table(entries), ""]
        text += [f"* `{e['name']}`: {e['problem']}" for e in cells if e["problem"]]
    if others:
        text.append("## Large and hard problems\n")
        text += [f"* `{entry['name']}`: {entry['title']}" for entry in others]
        text += ["", wrapped(COLUMNS), ""]
        text.append(
            "| | Unknowns / multipliers | Inequalities | Factorisations | F | Seconds; solver | Memory, GiB |"
        )
        text.append("|---" * 7 + "|")
        text += [*map(row, others), "", wrapped(PEERS), "", theory_table(entries)]
    text.append("## Commands\n")
    text.append("`/usr/bin/python3 tests/performance/headline.py` measures all cases. One case at a time:\n")
    text.append(f"```sh\n{commands(document)}\n```")
    return "\n".join(text) + "\n"
