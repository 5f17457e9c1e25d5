# SPDX-License-Identifier: BSD-3-Clause
"""Table and picture of a scaling run, harmos-plot --scaling: scaling.csv and scaling.png.

Of the summary.json of all directories in a directory, one for each number of ranks. Runs that have
not converged are named and left out.

Efficiency compares with the run on the fewest ranks P0: T(P0) P0 / (T(P) P) for strong scaling, the
problem staying as it is; T(P0) / T(P) for weak scaling, the problem growing with the ranks. T is
the total time without the writing of results; `solve` is that of the stage alone.
"""

import csv
import io
import os
import sys
from pathlib import Path

from plot_style import FAINT, STYLE, finish, output_of, save
from command_line import PlotError
from run_results import read_summary

import matplotlib.pyplot as plt

STAGES = {
    "mesh": "#56B4E9",
    "assembly": "#0072B2",
    "factorization": "#009E73",
    "dual_operator": "#F0E442",
    "coarse": "#E69F00",
    "solve": "#D55E00",
    "recovery": "#CC79A7",
}
COLUMNS = ("ranks", "primal_dimension", "subdomains", "products", *STAGES, "total", "efficiency",
           "solve_efficiency", "peak_memory_mib_a_rank")


def summaries(directory):
    """Of the converged runs, by rising number of ranks."""
    found = []
    for path in sorted(directory.glob("*/summary.json")):
        summary = read_summary(path)
        if summary.get("converged") is True:
            found.append(summary)
        else:
            print(f"warning: {path.parent} has not converged; it is left out", file=sys.stderr)
    if not found:
        raise PlotError(
            f"{directory}: no converged run in its directories; has the scaling run finished?"
        )
    found.sort(key=lambda summary: summary["ranks"])
    counts = [summary["ranks"] for summary in found]
    if len(set(counts)) < len(counts):
        raise PlotError(f"{directory}: two runs have the same number of ranks: {counts}")
    return found


def kind_of(found, kind):
    """As asked for, or by whether the problem grows."""
    sizes = {summary["primal_dimension"] for summary in found}
    if kind == "strong" and len(sizes) > 1:
        raise PlotError(
            f"strong scaling compares runs of one problem, but there are {len(sizes)} sizes"
        )
    if kind == "auto":
        return "weak" if len(sizes) > 1 else "strong"
    return kind


def table_of(found, kind):
    """A dict a run, with the names of COLUMNS."""

    def row(summary):
        seconds = {stage: summary["seconds"][stage] for stage in STAGES}
        return {
            "ranks": summary["ranks"],
            "primal_dimension": summary["primal_dimension"],
            "subdomains": summary["subdomains"],
            "products": summary["hessian_applications"],
            **seconds,
            "total": summary["seconds"]["total"] - summary["seconds"]["output"],
            "peak_memory_mib_a_rank": summary["peak_memory_mib"] / summary["ranks"],
        }

    rows = [row(summary) for summary in found]
    first = rows[0]
    for item in rows:
        work = item["ranks"] / first["ranks"] if kind == "strong" else 1.0
        for name, seconds in (("efficiency", "total"), ("solve_efficiency", "solve")):
            spent = work * item[seconds]
            item[name] = first[seconds] / spent if spent > 0 else float("nan")
    return rows


def text_of(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def write_table(rows, path):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([item[name] for name in COLUMNS] for item in rows)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        temporary.write_text(text.getvalue(), encoding="utf-8")
        os.replace(temporary, path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise PlotError(
            f"{path}: cannot write ({error.strerror}); name a writable --output"
        ) from error
    cells = [COLUMNS, *([text_of(item[name]) for name in COLUMNS] for item in rows)]
    widths = [max(map(len, column)) for column in zip(*cells)]
    for line in cells:
        print("  ".join(cell.rjust(width) for cell, width in zip(line, widths)))
    print(path)


def draw(rows, kind, title):
    with plt.rc_context(STYLE):
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 4.4))
        places = range(len(rows))
        names = [str(item["ranks"]) for item in rows]
        bottom = [0.0] * len(rows)
        for stage, colour in STAGES.items():
            heights = [item[stage] for item in rows]
            left.bar(
                places,
                heights,
                bottom=bottom,
                color=colour,
                width=0.7,
                label=stage.replace("_", " "),
            )
            bottom = [b + h for b, h in zip(bottom, heights)]
        left.set_ylabel("seconds")
        left.legend(fontsize=8)
        for name, colour, label in (("efficiency", "#0072B2", "all stages"),
                                    ("solve_efficiency", "#D55E00", "solve")):
            right.plot(places, [item[name] for item in rows], "o-", color=colour, label=label)
        right.axhline(1.0, color=FAINT, linewidth=0.8)
        right.set_ylim(bottom=0.0)
        right.set_ylabel(f"efficiency, {kind} scaling")
        right.legend(fontsize=8)
        for axes in (left, right):
            axes.set_xlabel("ranks")
            axes.set_xticks(list(places), names)
        figure.subplots_adjust(
            left=0.08, right=0.98, top=0.9 if title else 0.96, bottom=0.22, wspace=0.22
        )
        dimensions = sorted({item["primal_dimension"] for item in rows})
        caption = [
            " to ".join(f"{d:,}" for d in sorted({dimensions[0], dimensions[-1]})) + " unknowns"
        ]
        finish(figure, title, caption)
        return figure


def run(options):
    found = summaries(Path(options.directory))
    kind = kind_of(found, options.scaling)
    rows = table_of(found, kind)
    output = output_of(options)
    write_table(rows, output / "scaling.csv")
    save(draw(rows, kind, options.title), output / "scaling.png", options.dpi)
