# SPDX-License-Identifier: BSD-3-Clause
"""docs/real_bodies.md as a function of docs/real_bodies.json alone.

tests/regression/test_documents.py renders it anew and compares. A table without measured runs is left out.
"""

import json
import textwrap

import real_bodies

LINE = 118
PROBLEMS = ("linear", "contact")
PARTITIONS = ("compact", "METIS")
# These fields identify a run.
KEY = ("scene", "problem", "partition", "seed", "parts")

INTRODUCTION = """
How many applications of the dual operator F a solution takes on unstructured meshes, over the number of subdomains.
An application is one solve in every subdomain, the unit of cost. For a scalable method the count stays bounded as the
number of subdomains grows, and contact takes only a few more applications than the linear problem.

`tests/performance/real_bodies_table.py` measures the counts and renders this page from
[real_bodies.json](real_bodies.json); a test compares. Versions: {versions}, {ranks} ranks. The tolerance is
{tolerance:g}, the preconditioner Dirichlet; other settings are the default except the partition of the mesh
(`Bodies/<body>/Expert/Partition`, [parameters](parameters/harmos.md)). `compact` is the default; `METIS` is the
partition by METIS alone."""

SCENES = """
In the linear problem, the bodies hang from their supports under their weight, without contact. In the contact problem, the upper body
is pressed down by 3 % of its radius. The number of unknowns grows with the number of parts, because each subdomain
has its own copy of the unknowns on its boundary."""

LINEAR = """
Applications of F. The last column is the largest count over the count for the fewest parts."""

CONTACT = """
Applications of F for all active sets together. The last column is the largest number of active sets."""

RATIO = """
Applications in contact over those of the linear problem, with the same partition."""

SEEDS = """
Least and most applications over partitions with several seeds of METIS (`Partition seed`), and their ratio."""


def wrapped(text):
    """Paragraphs, filled."""
    return "\n\n".join(
        textwrap.fill(" ".join(paragraph.split()), LINE, break_long_words=False, break_on_hyphens=False)
        for paragraph in text.strip().split("\n\n")
    )


def key_of(item):
    return tuple(item[name] for name in KEY)


def order_of(item):
    """Scenes, problems and partitions in the order of this page, not of the measurement."""
    return (
        list(real_bodies.BODIES).index(item["scene"]),
        PROBLEMS.index(item["problem"]),
        PARTITIONS.index(item["partition"]),
        item["seed"],
        item["parts"],
    )


def merged(documents):
    """One document with the runs of all; a later run replaces an earlier one of the same case.

    @throws ValueError for runs on different numbers of ranks or with different tolerances.
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
    """One run per line, so that a diff shows which runs a new measurement changed."""
    head = {name: value for name, value in document.items() if name != "runs"}
    fields = [f" {json.dumps(name)}: {json.dumps(value)}" for name, value in head.items()]
    lines = ",\n".join(f"  {json.dumps(item)}" for item in document["runs"])
    return "{\n" + ",\n".join([*fields, f' "runs": [\n{lines}\n ]']) + "\n}\n"


class Figures:
    """The measured runs, by the fields that identify them."""

    def __init__(self, document):
        self.document = document
        self.items = {key_of(item): item for item in document["runs"]}
        self.parts = document["parts"]
        self.scenes = [key for key in real_bodies.BODIES if any(k[0] == key for k in self.items)]
        self.first_seed = min(k[3] for k in self.items)

    def item(self, scene, problem, partition, parts):
        return self.items.get((scene, problem, partition, self.first_seed, parts), {})

    def products(self, *place):
        """None if there is no such run, "failed" if it failed."""
        item = self.item(*place)
        return item.get("products", "failed") if item else None

    def row(self, scene, problem, partition):
        return [self.products(scene, problem, partition, n) for n in self.parts]

    def of_seeds(self, scene, problem, partition, parts):
        """The counts of all seeds of a partition."""
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
    return table(["Scene", "Bodies", "Unknowns", "Inequalities in contact"], rows)


def products_table(figures, problem):
    """The rows of both partitions of a scene; "" if nothing was measured."""
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
    header = ["Scene", "Partition", *(f"{n} parts" if n == figures.parts[0] else str(n) for n in figures.parts)]
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
    header = ["Scene", "Partition", *(f"{n} parts" if n == figures.parts[0] else str(n) for n in figures.parts)]
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
    header = ["Scene", "Problem", "Partition", *(f"{n} parts" if n == columns[0] else str(n) for n in columns)]
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
    text = ["# Applications of F on real bodies", wrapped(introduction), "## Scenes", wrapped(SCENES), scenes_table(figures)]
    for title, words, content in (
        ("Linear problems", LINEAR, products_table(figures, "linear")),
        ("Contact", CONTACT, products_table(figures, "contact")),
        ("Contact over the linear problem", RATIO, ratio_table(figures)),
        ("Seeds", SEEDS, seeds_table(figures)),
    ):
        if content:
            text += [f"## {title}", wrapped(words), content]
    return "\n\n".join(text) + "\n"
