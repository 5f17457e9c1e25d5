# SPDX-License-Identifier: BSD-3-Clause
"""curve.png: columns of steps.csv against each other, as forces against time or displacement, of one run or several.

steps.csv has a row for each step of the load that was accepted, or part of one. Curves that turn back, as stress over
strain does where the load is taken off, have arrows along their way; steps in which interfaces snap are marked.
"""

import csv
import difflib
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from command_line import PlotError
from plot_style import BODY_COLOURS, FAINT, STYLE, caption_of, finish, output_of, save
from run_results import read_summary

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

COLOURS = (*BODY_COLOURS[:3], "#E69F00", "#56B4E9", "#D55E00", BODY_COLOURS[3])
MOST_MARKS = 120  # rows; marks would hide the line beyond this
FEW_MARKS = 30  # large ones
LISTED = 30  # columns
# Before the first step, which has no row.
BEGIN_AT_ZERO = {"time", "strain", "stress", "stress_y", "dissipated", "released", "broken"}
ARROWS = (0.65, 0.6, 0.75)  # shares of the first branch, the second and those after it
# Released in a step, of what is released and dissipated in all: what is less may be the trapezoidal rule's error.
SNAP = 1e-3


@dataclass
class Run:
    label: str
    table: dict  # arrays by the name of the column
    path: Path


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
        raise PlotError(f"{path}: no step in the file; wait for the first step or repeat the run")
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


def begun(x, y, names):
    """With the state before the first step, where it is known."""
    if not BEGIN_AT_ZERO.issuperset(names):
        return x, y
    return np.concatenate([[0.0], x]), np.concatenate([[0.0], y])


def branches(x):
    """(first, last) of the ways between which x turns back."""
    moves = np.flatnonzero(np.diff(x) != 0)
    turns = moves[1:][np.diff(np.sign(np.diff(x)[moves])) != 0]
    ends = [0, *turns.tolist(), len(x) - 1]
    return list(zip(ends[:-1], ends[1:]))


def draw_arrows(axes, x, y, colour):
    """One a branch, where some of its way is done: ways back and forth on one line have theirs apart."""
    ways, before = branches(x), np.inf
    for number, (first, last) in enumerate(ways if len(ways) > 1 else []):
        way = x[last] - x[first]
        goal = x[first] + np.sign(way) * ARROWS[min(number, 2)] * min(abs(way), before)
        before = abs(way)
        k = first + int(np.abs(0.5 * (x[first:last] + x[first + 1 : last + 1]) - goal).argmin())
        axes.annotate(
            "", xy=(0.5 * (x[k] + x[k + 1]), 0.5 * (y[k] + y[k + 1])), xytext=(x[k], y[k]),
            arrowprops={"arrowstyle": "-|>", "color": colour, "mutation_scale": 20, "shrinkA": 0, "shrinkB": 0},
        )


def snaps(table):
    """Of each row whether interfaces snapped on the way there."""
    if "released" not in table:
        return np.zeros(len(next(iter(table.values()))), dtype=bool)
    return np.diff(table["released"], prepend=0.0) > SNAP * (table["released"][-1] + table["dissipated"][-1])


def draw_run(axes, run, names, against, colours, label_of):
    """The columns of one run; whether steps did not converge, and whether some snapped."""
    x = column(run.table, against, run.path)
    failed = run.table.get("converged", np.ones(len(x))) == 0
    snapped = snaps(run.table)
    for name, colour in zip(names, colours):
        y = column(run.table, name, run.path)
        along = begun(x, y, {against, name})
        marker = "o" if len(x) <= MOST_MARKS else None
        size = 4 if len(x) <= FEW_MARKS else 2.5
        axes.plot(*along, color=colour, linewidth=1.6, marker=marker, markersize=size, label=label_of(run, name))
        axes.plot(
            x[failed], y[failed], "o", markersize=6, markerfacecolor="white", markeredgecolor=colour,
            zorder=3,
        )
        if snapped.any():
            axes.plot(x[snapped], y[snapped], "v", markersize=9, color=colour, zorder=3)
        draw_arrows(axes, *along, colour)
    return failed.any(), snapped.any()


def plot_curve(runs, names, against, title, caption):
    """Columns of each run over another one."""

    def label_of(run, name):
        words = [*([name] if len(names) > 1 else []), *([run.label] if len(runs) > 1 else [])]
        return ", ".join(words or [name]).replace("$", r"\$")  # no formula

    figure = plt.figure(figsize=(8.0, 5.4))
    axes = figure.add_axes([0.13, 0.15, 0.83, 0.75 if title else 0.81])
    failed, snapped = False, False
    for k, run in enumerate(runs):
        colours = [COLOURS[(k * len(names) + j) % len(COLOURS)] for j in range(len(names))]
        told = draw_run(axes, run, names, against, colours, label_of)
        failed, snapped = failed or told[0], snapped or told[1]
    handles = axes.get_legend_handles_labels()[0] if len(names) * len(runs) > 1 else []
    if failed:
        handles.append(
            Line2D([], [], linestyle="none", marker="o", markersize=6, markerfacecolor="white",
                   markeredgecolor=FAINT, label="not converged")
        )
    if snapped:
        handles.append(
            Line2D([], [], linestyle="none", marker="v", markersize=9, color=FAINT, label="interfaces snapped")
        )
    if handles:
        axes.legend(handles=handles, fontsize=9, loc="best", frameon=True, framealpha=0.8, edgecolor="none")
    axes.set_xlabel(against.replace("$", r"\$"))
    axes.set_ylabel(names[0].replace("$", r"\$") if len(names) == 1 else "")
    axes.grid(color="#E4E4E4", linewidth=0.6)
    axes.margins(0.03, 0.06)
    if against == "time":
        axes.set_xlim(left=0.0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    finish(figure, title, caption)
    return figure


def read_run(directory, label):
    directory = Path(directory)
    if not directory.is_dir():
        raise PlotError(f"{directory}: no such directory; name the directory of a run")
    path = directory / "steps.csv"
    return Run(label or directory.resolve().name, read_steps(path), path)


def run(options):
    directories = [options.directory, *options.beside]
    labels = [*options.label, *[None] * len(directories)]
    runs = [read_run(directory, label) for directory, label in zip(directories, labels)]
    # A run that goes on has none.
    summary = Path(options.directory) / "summary.json"
    caption = caption_of(read_summary(summary)) if summary.exists() and len(runs) == 1 else []
    with plt.rc_context({**STYLE, "text.usetex": False}):
        figure = plot_curve(runs, options.curve, options.against, options.title, caption)
        save(figure, output_of(options) / "curve.png", options.dpi)
