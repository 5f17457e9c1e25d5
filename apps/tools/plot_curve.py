# SPDX-License-Identifier: BSD-3-Clause
"""curve.png: columns of steps.csv against each other, as forces against time or displacement.

steps.csv has a row for each step of the load that was accepted, or part of one.
"""

import csv
import difflib
import math
from pathlib import Path

import numpy as np
from command_line import PlotError
from plot_style import BODY_COLOURS, FAINT, STYLE, caption_of, finish, output_of, save
from run_results import read_summary

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

COLOURS = (*BODY_COLOURS[:3], "#E69F00", "#56B4E9", "#D55E00", BODY_COLOURS[3])
MOST_MARKS = 120  # rows; marks would hide the line beyond this
LISTED = 30  # columns


def read_steps(path):
    """Arrays by the name of the column; what is empty is not a number. Half a row at the end is left out."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise PlotError(
            f"{path}: {error.strerror}; only a run of several steps writes it"
        ) from error
    rows = [row for row in csv.reader(text[: text.rfind("\n") + 1].splitlines()) if row]
    if len(rows) < 2:
        raise PlotError(f"{path}: no step in the file; wait for the first, or repeat the run")
    header = rows[0]
    for number, row in enumerate(rows[1:], start=2):
        if len(row) != len(header):
            raise PlotError(
                f"{path}: row {number} has {len(row)} cells for {len(header)} columns; repeat the run"
            )
    table = {}
    for name, cells in zip(header, zip(*rows[1:])):
        try:
            table[name] = np.array([float(cell) if cell else math.nan for cell in cells])
        except ValueError as error:
            raise PlotError(f"{path}: column {name}: {error}; repeat the run") from error
    return table


def column(table, name, path):
    if name in table:
        return table[name]
    lower = {known.lower(): known for known in table}
    near = difflib.get_close_matches(name.lower(), lower, 1, 0.0)[0]
    words = f'{path}: no column "{name}"; did you mean "{lower[near]}"?'
    if len(table) <= LISTED:
        raise PlotError(f"{words} The columns are {', '.join(table)}")
    raise PlotError(f"{words} The first line of the file has the {len(table)} columns")


def plot_curve(table, names, against, path, title, caption):
    """Columns of the table over another."""
    x = column(table, against, path)
    figure = plt.figure(figsize=(8.0, 5.4))
    axes = figure.add_axes([0.13, 0.15, 0.83, 0.75 if title else 0.81])
    failed = table.get("converged", np.ones(len(x))) == 0
    marker = "o" if len(x) <= MOST_MARKS else None
    plain = [name.replace("$", r"\$") for name in (against, *names)]  # no formula
    for k, name in enumerate(names):
        y = column(table, name, path)
        colour = COLOURS[k % len(COLOURS)]
        axes.plot(x, y, color=colour, linewidth=1.6, marker=marker, markersize=4, label=plain[k + 1])
        axes.plot(
            x[failed], y[failed], "o", markersize=6, markerfacecolor="white", markeredgecolor=colour,
            zorder=3,
        )
    handles = axes.get_legend_handles_labels()[0] if len(names) > 1 else []
    if failed.any():
        handles.append(
            Line2D([], [], linestyle="none", marker="o", markersize=6, markerfacecolor="white",
                   markeredgecolor=FAINT, label="not converged")
        )
    if handles:
        axes.legend(handles=handles, fontsize=9, loc="best", frameon=True, framealpha=0.8, edgecolor="none")
    axes.set_xlabel(plain[0])
    axes.set_ylabel(plain[1] if len(names) == 1 else "")
    axes.grid(color="#E4E4E4", linewidth=0.6)
    axes.margins(0.03, 0.06)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    finish(figure, title, caption)
    return figure


def run(options):
    directory = Path(options.directory)
    if not directory.is_dir():
        raise PlotError(f"{directory}: no such directory; name the directory of a run")
    path = directory / "steps.csv"
    table = read_steps(path)
    # A run that goes on has none.
    summary = directory / "summary.json"
    caption = caption_of(read_summary(summary)) if summary.exists() else []
    with plt.rc_context({**STYLE, "text.usetex": False}):
        figure = plot_curve(table, options.curve, options.against, path, options.title, caption)
        save(figure, output_of(options) / "curve.png", options.dpi)
