#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""Brings docs/accuracy.md up to date with studies that have been run.

    refresh_accuracy.py DIR...

Each DIR is the output of study on a deck apps/study/decks/NAME.xml. What stands on the page between

    <!-- begin NAME: made by docs/tools/refresh_accuracy.py -->
    <!-- end NAME -->

is written anew from DIR/study.json, and the pictures that the page shows, docs/images/accuracy_NAME_CHART.png,
are drawn from it. Everything else on the page stays as it is.
"""

import argparse
import math
import re
import statistics
import sys
import tempfile
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "apps" / "tools"))

import plot_study  # noqa: E402
from run_results import PlotError  # noqa: E402

PAGE = ROOT / "docs" / "accuracy.md"
MOST_BYTES = 150_000


def sign(value, digits=1):
    return "" if value is None or not math.isfinite(value) else f"{value:.{digits}e}"


def reference_line(study):
    run = study["runs"][0]
    words = [
        f"{title} {sign(run['errors'][name]['reference'])}"
        for name, title in study["measures"].items()
        if run["errors"][name]["reference"] is not None
    ]
    return "The reference's own errors, by estimate: " + ", ".join(words) + "."


def ratio_table(study):
    """How far from the front the runs with each value of an axis are."""
    name, title = next(iter(study["measures"].items()))
    lines = [
        f"Seconds divided by those of the Pareto front at the same error ({title}):",
        "",
        "| Setting | Runs judged | On the front | Median | Largest |",
        "|---|---|---|---|---|",
    ]
    for axis in study["axes"]:
        for value in axis["values"]:
            ratio = value["ratio_to_front"][name]
            if ratio["runs"] == 0:
                lines.append(f"| {value['label']} | 0 | | | |")
                continue
            lines.append(
                f"| {value['label']} | {ratio['runs']} | {ratio['on_front']} |"
                f" {ratio['median']:.2g} | {ratio['largest']:.2g} |"
            )
    return lines


def rule_table(study):
    """What the rule "balanced" costs beside the best of the tolerances that were given.

    Of runs with the same settings but for the tolerance: its seconds over the least of those that are at least as
    accurate. The median and the largest of these ratios, mesh by mesh.
    """
    mesh = plot_study.mesh_axis(study)
    tolerance = plot_study.axis_with(study, plot_study.TOLERANCE)
    name, title = next(iter(study["measures"].items()))
    if mesh is None or tolerance is None:
        return []
    skipped = tolerance["name"]

    def others(run):
        return {key: value for key, value in run["settings"].items() if key != skipped}

    def is_balanced(run):
        return "balanced" in run["settings"][tolerance["name"]].split(";")

    runs = plot_study.converged(study)
    lines = [
        "The rule `balanced` compared with the best of the given tolerances, other settings equal:",
        "",
        f"| Mesh | Error ({title}) | Applications of F | of the best | Seconds / seconds of the best, median | largest |",
        "|---|---|---|---|---|---|",
    ]
    for value in mesh["values"]:
        ratios, products, least = [], [], []
        mine = [r for r in runs if is_balanced(r) and r["settings"][mesh["name"]] == value["value"]]
        for run in mine:
            front = [
                r
                for r in runs
                if not is_balanced(r)
                and others(r) == others(run)
                and r["errors"][name]["total"] <= run["errors"][name]["total"]
            ]
            best = min([run, *front], key=lambda r: r["seconds"]["total"])
            ratios.append(run["seconds"]["total"] / best["seconds"]["total"])
            products.append(int(run["products"]))
            least.append(int(best["products"]))
        if not mine:
            continue
        error = max(r["errors"][name]["total"] for r in mine)
        judged = "" if all(r["errors"][name]["judged"] for r in mine) else " (not judged)"
        span = [" to ".join(str(x) for x in sorted({min(c), max(c)})) for c in (products, least)]
        lines.append(
            f"| {value['label']} | {sign(error)}{judged} | {span[0]} | {span[1]} |"
            f" {statistics.median(ratios):.2f} | {max(ratios):.2f} |"
        )
    return [*lines, ""] if len(lines) > 4 else []


def parts_table(study):
    """Of each mesh, what the mesh alone is off by, and what each tolerance adds."""
    mesh = plot_study.mesh_axis(study)
    tolerance = plot_study.axis_with(study, plot_study.TOLERANCE)
    name, title = next(iter(study["measures"].items()))
    if mesh is None or tolerance is None:
        return []
    head = [value["label"].split()[-1] for value in tolerance["values"]]
    lines = [
        f"Parts of the error ({title}): of the mesh, of the solver by `Solver/Tolerance`, of local solves (largest):",
        "",
        "| Mesh | Discretisation | " + " | ".join(f"Solver, {word}" for word in head) + " | Local solve |",
        "|" + "---|" * (3 + len(head)),
    ]
    for value in mesh["values"]:
        runs = [r for r in plot_study.converged(study) if r["settings"][mesh["name"]] == value["value"]]
        if not runs:
            continue
        cells = [value["label"], sign(runs[0]["errors"][name]["discretisation"])]
        for each in tolerance["values"]:
            solver = [
                r["errors"][name]["solver"]
                for r in runs
                if r["settings"][tolerance["name"]] == each["value"] and r["solver_judged"]
            ]
            cells.append(sign(sorted(solver)[len(solver) // 2]) if solver else "")
        cells.append(sign(max(r["errors"][name]["local"] for r in runs)))
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def block(study):
    head = (
        f"*{len(study['runs'])} settings on {plot_study.ranks_of(study)}, Harmos {study['harmos']['version']}"
        f" ({study['harmos']['git']}). {reference_line(study)}*"
    )
    lines = [
        *textwrap.wrap(head, 118, break_on_hyphens=False),
        "",
        "```",
        *study["sentences"],
        "```",
        "",
    ]
    parts = parts_table(study)
    lines += [*parts, ""] if parts else []
    lines += rule_table(study)
    return "\n".join([*lines, *ratio_table(study)]) + "\n"


def refresh(text, name, study):
    pattern = re.compile(
        rf"(<!-- begin {re.escape(name)}: [^>]*-->\n).*?(<!-- end {re.escape(name)} -->)", re.DOTALL
    )
    if not pattern.search(text):
        raise PlotError(f"{PAGE}: no block \"begin {name}\"")
    return pattern.sub(lambda found: found.group(1) + block(study) + found.group(2), text)


def draw(directory, name, text):
    """The charts that the page shows."""
    wanted = re.findall(rf"\]\(images/accuracy_{re.escape(name)}_(\w+)\.png\)", text)
    with tempfile.TemporaryDirectory() as scratch:
        pending = set(wanted)
        for dpi in (110, 95, 80, 65):  # as sharp as the size allows, each
            plot_study.run(
                argparse.Namespace(directory=directory, output=scratch, dpi=dpi, title="")
            )
            for chart in sorted(pending):
                data = (Path(scratch) / f"{chart}.png").read_bytes()
                if len(data) < MOST_BYTES:
                    target = ROOT / "docs" / "images" / f"accuracy_{name}_{chart}.png"
                    target.write_bytes(data)
                    print(target)
                    pending.discard(chart)
            if not pending:
                return
        raise PlotError(f"{directory}: {', '.join(sorted(pending))} takes {MOST_BYTES} bytes at any resolution")


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Brings docs/accuracy.md up to date.")
    parser.add_argument("directories", metavar="DIR", nargs="+", help="output of a finished study")
    options = parser.parse_args(arguments)
    text = PAGE.read_text(encoding="utf-8")
    try:
        for directory in map(Path, options.directories):
            study = plot_study.read_study(directory / "study.json")
            name = Path(study["deck"]).stem
            text = refresh(text, name, study)
            draw(directory, name, text)
    except PlotError as error:
        print(f"refresh_accuracy.py: {error}", file=sys.stderr)
        return 2
    PAGE.write_text(text, encoding="utf-8")
    print(PAGE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
