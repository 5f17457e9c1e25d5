# SPDX-License-Identifier: BSD-3-Clause
"""docs/real_bodies.md as a function of docs/real_bodies.json alone.

tests/regression/test_documents.py makes it anew and compares. Tables have what was measured: without runs in
contact there is none of contact.
"""

import json
import textwrap

import real_bodies

LINE = 125
PROBLEMS = ("linear", "contact")
PARTITIONS = ("compact", "METIS")
# What tells a run from the others.
KEY = ("scene", "problem", "partition", "seed", "parts")

INTRODUCTION = """
Products with F, the unit of cost, on meshes without structure, over the number of subdomains. A method that scales takes
no more of them where there are more subdomains, and in contact little more than in the linear problem. Measured by
`tests/performance/real_bodies_table.py`, which writes this page from [real_bodies.json](real_bodies.json); a test
compares. {versions}, {ranks} ranks, tolerance {tolerance:g}, the Dirichlet preconditioner, and default settings but for
the cut: `compact` is the default,
`METIS` what METIS alone makes (`Bodies/<body>/Expert/Partition`, [parameters](parameters/harmos.md))."""

SCENES = """
In the linear problem bodies hang by their weight, without contact; in contact the upper one is pressed down by 3 per cent
of its radius. The more parts, the more unknowns: those between subdomains count in each."""

CONTACT = """
Products of all active sets together. In the last column, how many sets it took at most."""

RATIO = """
Products in contact over those of the linear problem, with the same cut."""

SEEDS = """
Least and most products of cuts by several seeds of METIS (`Partition seed`), and their ratio."""


def wrapped(text):
    return textwrap.fill(
        " ".join(text.split()), LINE, break_long_words=False, break_on_hyphens=False
    )


def key_of(item):
    return tuple(item[name] for name in KEY)


def order_of(item):
    """Scenes, problems and ways to cut in the order of this page, not of the measurement."""
    return (
        list(real_bodies.BODIES).index(item["scene"]),
        PROBLEMS.index(item["problem"]),
        PARTITIONS.index(item["partition"]),
        item["seed"],
        item["parts"],
    )


def merged(documents):
    """One document of the runs of all; later ones stand in the place of the same runs of earlier ones.

    @throws ValueError for runs on other numbers of ranks or to another tolerance.
    """
    found = {}
    for document in documents:
        for item in document["runs"]:
            version = item.get("harmos", document.get("harmos"))
            found[key_of(item)] = {**item, "harmos": version}
    items = sorted(found.values(), key=order_of)
    for what, values in (
        ("numbers of ranks", {document["ranks"] for document in documents}),
        ("tolerances", {item["tolerance"] for item in items}),
    ):
        if len(values) != 1:
            raise ValueError(f"runs of several {what} make no table: {sorted(values)}")
    return {
        "benchmark": "real_bodies",
        "ranks": documents[0]["ranks"],
        "parts": sorted({item["parts"] for item in items}),
        "runs": items,
    }


def as_json(document):
    """A line a run: what a new measurement changed shows in a diff."""
    head = {name: value for name, value in document.items() if name != "runs"}
    fields = [f" {json.dumps(name)}: {json.dumps(value)}" for name, value in head.items()]
    lines = ",\n".join(f"  {json.dumps(item)}" for item in document["runs"])
    return "{\n" + ",\n".join([*fields, f' "runs": [\n{lines}\n ]']) + "\n}\n"


class Figures:
    """What was measured, by what tells runs from each other."""

    def __init__(self, document):
        self.document = document
        self.items = {key_of(item): item for item in document["runs"]}
        self.parts = document["parts"]
        self.scenes = [key for key in real_bodies.BODIES if any(k[0] == key for k in self.items)]
        self.first_seed = min(k[3] for k in self.items)

    def item(self, scene, problem, partition, parts):
        return self.items.get((scene, problem, partition, self.first_seed, parts), {})

    def products(self, *place):
        """None where there was no such run; "failed"."""
        item = self.item(*place)
        return item.get("products", "failed") if item else None

    def row(self, scene, problem, partition):
        return [self.products(scene, problem, partition, n) for n in self.parts]

    def of_seeds(self, scene, problem, partition, parts):
        """Of all seeds of a cut."""
        return [
            item.get("products", "failed")
            for k, item in self.items.items()
            if k[:3] == (scene, problem, partition) and k[4] == parts
        ]


def table(header, rows):
    lines = [f"| {' | '.join(header)} |", "|---" * len(header) + "|"]
    return "\n".join(lines + [f"| {' | '.join(row)} |".replace("|  |", "| |") for row in rows])


def shown(value):
    return "—" if value is None else str(value)


def numbers(values):
    return [value for value in values if isinstance(value, int)]


def span(values):
    """As "18 to 22", or one number."""
    least, most = min(values), max(values)
    return str(least) if least == most else f"{least} to {most}"


def scenes_table(figures):
    rows = []
    for scene in figures.scenes:
        items = [item for key, item in figures.items.items() if key[0] == scene and "unknowns" in item]
        unknowns = [item["unknowns"] for item in items]
        candidates = [item["inequalities"] for item in items if item["problem"] == "contact"]
        rows.append([
            f"`{scene}`",
            real_bodies.BODIES[scene].title,
            span(unknowns) if unknowns else "—",
            span(candidates) if candidates else "—",
        ])
    return table(["Scene", "What", "Unknowns", "Inequalities in contact"], rows)


def products_table(figures, problem):
    """Rows of the two cuts below each other; nothing where nothing was measured."""
    rows = []
    for scene in figures.scenes:
        for partition in PARTITIONS:
            row = figures.row(scene, problem, partition)
            if not any(row):
                continue
            ratio = "—"
            if numbers(row) and isinstance(row[0], int):
                ratio = f"{max(numbers(row)) / row[0]:.2f}"
            cells = [f"`{scene}`", partition, *map(shown, row), ratio]
            if problem == "contact":
                sets = [figures.item(scene, problem, partition, n).get("active_sets", 0) for n in figures.parts]
                cells.append(str(max(sets)))
            rows.append(cells)
    header = ["Scene", "Cut", *(f"{n} parts" if n == figures.parts[0] else str(n) for n in figures.parts)]
    header.append(f"most / at {figures.parts[0]}")
    if problem == "contact":
        header.append("active sets")
    return table(header, rows) if rows else ""


def ratio_table(figures):
    rows = []
    for scene in figures.scenes:
        for partition in PARTITIONS:
            pairs = list(zip(figures.row(scene, "contact", partition), figures.row(scene, "linear", partition)))
            cells = [
                f"{a / b:.2f}" if isinstance(a, int) and isinstance(b, int) else "—" for a, b in pairs
            ]
            if any(cell != "—" for cell in cells):
                rows.append([f"`{scene}`", partition, *cells])
    header = ["Scene", "Cut", *(f"{n} parts" if n == figures.parts[0] else str(n) for n in figures.parts)]
    return table(header, rows) if rows else ""


def seeds_table(figures):
    rows, columns = [], set()
    for scene in figures.scenes:
        for problem in PROBLEMS:
            for partition in PARTITIONS:
                cells = {}
                for n in figures.parts:
                    products = figures.of_seeds(scene, problem, partition, n)
                    if len(products) > 1 and numbers(products) == products:
                        ratio = max(products) / min(products)
                        cells[n] = f"{span(products)} ({len(products)} seeds, {ratio:.2f})"
                    elif len(products) > 1:
                        cells[n] = "failed"
                if cells:
                    rows.append((f"`{scene}`", problem, partition, cells))
                    columns |= set(cells)
    columns = sorted(columns)
    header = ["Scene", "Problem", "Cut", *(f"{n} parts" if n == columns[0] else str(n) for n in columns)]
    return (
        table(header, [[*row, *(cells.get(n, "—") for n in columns)] for *row, cells in rows])
        if rows
        else ""
    )


def page(document):
    """docs/real_bodies.md."""
    figures = Figures(document)
    versions = sorted({item["harmos"] for item in document["runs"]})
    introduction = INTRODUCTION.format(
        versions=" and ".join(f"`{version}`" for version in versions),
        ranks=document["ranks"],
        tolerance=document["runs"][0]["tolerance"],
    )
    text = ["# Products on real bodies", wrapped(introduction), "## Scenes", wrapped(SCENES), scenes_table(figures)]
    for title, words, content in (
        ("Linear problems", "", products_table(figures, "linear")),
        ("Contact", CONTACT, products_table(figures, "contact")),
        ("Contact beside the linear problem", RATIO, ratio_table(figures)),
        ("Seeds", SEEDS, seeds_table(figures)),
    ):
        if content:
            text += [f"## {title}", *([wrapped(words)] if words else []), content]
    return "\n\n".join(text) + "\n"
