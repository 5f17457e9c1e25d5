# SPDX-License-Identifier: BSD-3-Clause
"""The charts of harmos-study-plot, whose --help says what each shows."""

import json
import math
from pathlib import Path

import numpy as np
from plot_style import FAINT, INK, STYLE, output_of, save
from command_line import PlotError

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

# Okabe-Ito, see plot_style.py, in the order of use.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000", "#8A8A8A")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
STAGES = {
    "mesh": "#8A8A8A",
    "assembly": "#56B4E9",
    "factorization": "#0072B2",
    "dual_operator": "#009E73",
    "coarse": "#E69F00",
    "solve": "#D55E00",
    "recovery": "#CC79A7",
}
PARTS = {
    "total": ("#000000", "o", "total"),
    "discretisation": ("#0072B2", "", "discretisation"),
    "solver": ("#D55E00", "s", "solver"),
    "local": ("#009E73", "^", "local solve"),
}
TOLERANCE = "Solver/Tolerance"
ROUNDS = "Adaptivity/Rounds"
WAYS = {False: ("cells of one size", "#0072B2", "o"), True: ("adapted", "#D55E00", "s")}


def read_study(path):
    try:
        study = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise PlotError(f"{path}: cannot be read ({error}); run study first") from error
    if not study.get("runs"):
        raise PlotError(f"{path}: no runs")
    return study


def axis_with(study, parameter):
    """The axis that sets a parameter, alone or among others, or None."""
    for axis in study["axes"]:
        if parameter in axis["parameters"]:
            return axis
    return None


def mesh_axis(study):
    """The first axis that does not belong to the solver: what a mesh is."""
    solver = ("Solver/", "Dual operator/", "Decomposition/", "Output/")
    for axis in study["axes"]:
        if not axis["parameters"][0].startswith(solver):
            return axis
    return None


def values_of(axis):
    return [value["value"] for value in axis["values"]] if axis else [None]


def label_of(axis, value):
    return next(v["label"] for v in axis["values"] if v["value"] == value)


def setting(run, axis):
    return run["settings"][axis["name"]] if axis else None


def converged(study):
    return [run for run in study["runs"] if run["converged"] and run["seconds"]["total"]]


def error(run, measure, part="total"):
    value = run["errors"][measure][part]
    return math.nan if value is None else value


def measures_of(study):
    """Those that the scene has."""
    return [
        name
        for name in study["measures"]
        if any(np.isfinite(error(run, name)) for run in study["runs"])
    ]


def tidy(axes):
    axes.grid(color="#E4E4E4", linewidth=0.6, which="major")
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def ranks_of(study):
    return "1 rank" if study["ranks"] == 1 else f"{study['ranks']} ranks"


def caption(figure, study):
    git = study["harmos"]["git"]
    words = f"{study['application']}, {ranks_of(study)}, Harmos {study['harmos']['version']} ({git})"
    figure.text(0.995, 0.005, words, ha="right", va="bottom", fontsize=7, color=FAINT)


def legend_below(figure, handles, columns):
    """In a strip of its own under the axes."""
    longest = max(len(handle.get_label()) for handle in handles)
    # Inches: a line of a sample, then letters of this size.
    fitting = int(figure.get_figwidth() / (0.55 + 0.062 * longest))
    columns = max(1, min(columns, len(handles), fitting))
    rows = -(-len(handles) // columns)
    strip = (0.17 * rows + 0.22) / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, strip, 1, 1 - strip))
    figure.legend(
        handles=handles, loc="lower center", bbox_to_anchor=(0.5, 0.12 / figure.get_figheight()),
        ncol=columns, fontsize=8, borderaxespad=0.0,
    )


def panels(count, width=4.6, height=3.9):
    columns = min(count, 2)
    rows = -(-count // columns)
    figure, axes = plt.subplots(
        rows, columns, figsize=(width * columns, height * rows), squeeze=False, layout="constrained"
    )
    flat = list(axes.flat)
    for extra in flat[count:]:
        extra.set_visible(False)
    return figure, flat[:count]


def spread(axes, values):
    """Room on a logarithmic axis, at least a decade, so that it has labels."""
    values = [v for v in values if np.isfinite(v) and v > 0]
    if not values:
        return None
    low, high = min(values), max(values)
    extra = max(0.0, math.log10(10.0) - math.log10(high / low)) / 2 + 0.06 * max(
        1.0, math.log10(high / low)
    )
    return low * 10**-extra, high * 10**extra


def label_decades(axis, low, high):
    """Where a logarithmic axis spans less than two decades, 2 and 5 have labels too."""
    if high / low < 100:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def error_against_seconds(study):
    runs, names, mesh = converged(study), measures_of(study), mesh_axis(study)
    tolerance = axis_with(study, TOLERANCE)
    if not runs or not names:
        return None
    figure, flat = panels(len(names))
    meshes, tolerances = values_of(mesh), values_of(tolerance)
    for axes, name in zip(flat, names):
        front = sorted(
            (run["seconds"]["total"], error(run, name))
            for run in runs
            if run["errors"][name]["on_front"]
        )
        if front:
            axes.step(*zip(*front), where="post", color=INK, linewidth=1.3, zorder=2)
        for run in runs:
            y = error(run, name)
            if not y > 0:
                continue
            colour = COLOURS[meshes.index(setting(run, mesh)) % len(COLOURS)]
            marker = MARKERS[tolerances.index(setting(run, tolerance)) % len(MARKERS)]
            judged = run["errors"][name]["judged"]
            on_front = run["errors"][name]["on_front"]
            axes.plot(
                run["seconds"]["total"], y, marker, color=colour,
                markerfacecolor=colour if judged else "none",
                markersize=7 if on_front else 4.5, markeredgewidth=0.9,
                markeredgecolor=INK if on_front else colour, alpha=1.0 if on_front else 0.75,
                zorder=4 if on_front else 3,
            )
        for target in study["targets"]:
            axes.axhline(target, color=FAINT, linewidth=0.7, linestyle=(0, (2, 3)), zorder=1)
        axes.set_xscale("log")
        axes.set_yscale("log")
        limits = spread(axes, [error(run, name) for run in runs])
        if limits:
            axes.set_ylim(*limits)
        label_decades(axes.xaxis, *axes.get_xlim())
        label_decades(axes.yaxis, *axes.get_ylim())
        axes.set_title(study["measures"][name])
        axes.set_xlabel("seconds")
        axes.set_ylabel("relative error")
        tidy(axes)
    handles = [Line2D([], [], color=INK, linewidth=1.3, label="Pareto front")]
    if mesh:
        handles += [
            Line2D([], [], linestyle="none", marker="o", color=COLOURS[k % len(COLOURS)],
                   markersize=5, label=label_of(mesh, value))
            for k, value in enumerate(meshes)
        ]
    if tolerance:
        handles += [
            Line2D([], [], linestyle="none", marker=MARKERS[k % len(MARKERS)], color=FAINT,
                   markersize=5, label=label_of(tolerance, value))
            for k, value in enumerate(tolerances)
        ]
    handles.append(
        Line2D([], [], linestyle="none", marker="o", color=FAINT, markerfacecolor="none",
               markersize=5, label="hollow: not judged")
    )
    legend_below(figure, handles, 5)
    return figure


def adaptivity(study):
    """Of an axis that adapts meshes: its two kinds of meshes, medians over the other settings."""
    axis, names = axis_with(study, ROUNDS), measures_of(study)
    if axis is None or not names:
        return None
    place = axis["parameters"].index(ROUNDS)
    figure, flat = panels(len(names))
    for axes, name in zip(flat, names):
        for adapted, (label, colour, marker) in WAYS.items():
            points = []
            for value in values_of(axis):
                if (int(value.split(";")[place]) > 0) != adapted:
                    continue
                runs = [r for r in converged(study) if setting(r, axis) == value and error(r, name) > 0]
                if runs:
                    points.append([np.median([r["seconds"]["total"] for r in runs]), np.median([error(r, name) for r in runs])])
            if points:
                axes.loglog(*zip(*points), marker=marker, color=colour, linewidth=1.3, markersize=5, label=label)
        for target in study["targets"]:
            axes.axhline(target, color=FAINT, linewidth=0.7, linestyle=(0, (2, 3)), zorder=1)
        label_decades(axes.xaxis, *axes.get_xlim())
        label_decades(axes.yaxis, *axes.get_ylim())
        axes.set_title(study["measures"][name])
        axes.set_xlabel("seconds, of all rounds")
        axes.set_ylabel("relative error")
        tidy(axes)
    legend_below(figure, flat[0].get_legend_handles_labels()[0], 2)
    return figure


def stages(study):
    names, runs = measures_of(study), converged(study)
    if not names or not runs:
        return None
    chosen = [run for run in runs if run["errors"][names[0]]["on_front"]]
    what = f"runs on the front ({study['measures'][names[0]]})"
    if not chosen:
        chosen, what = sorted(runs, key=lambda run: run["seconds"]["total"])[:12], "fastest runs"
    chosen = sorted(chosen, key=lambda run: run["seconds"]["total"])[:14]
    figure = plt.figure(figsize=(8.6, 1.5 + 0.34 * len(chosen)), layout="constrained")
    axes = figure.add_subplot()
    places = np.arange(len(chosen))
    left = np.zeros(len(chosen))
    totals = np.array([run["seconds"]["total"] for run in chosen])
    for stage, colour in STAGES.items():
        share = 100 * np.array([run["seconds"].get(stage) or 0.0 for run in chosen]) / totals
        axes.barh(places, share, left=left, color=colour, label=stage.replace("_", " "), height=0.72)
        left += share
    rest = np.maximum(0.0, 100 - left)
    axes.barh(places, rest, left=left, color="#E4E4E4", label="other", height=0.72)
    labels = [
        f"{run['label']}\n{run['seconds']['total']:.2g} s, error {error(run, names[0]):.1e}"
        for run in chosen
    ]
    axes.set_yticks(places, labels, fontsize=7.5)
    axes.set_xlim(0, 100)
    axes.set_xlabel("per cent of the seconds")
    axes.set_title(f"Where the time goes: {what}")
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    legend_below(figure, axes.get_legend_handles_labels()[0], 8)
    return figure


def with_tolerance(study, axis):
    """Converged runs whose tolerance was given: not chosen by the rule "balanced"."""
    runs = converged(study)
    return [r for r in runs if "balanced" not in setting(r, axis).split(";")] if axis else runs


def iterations(study):
    axis, mesh = axis_with(study, TOLERANCE), mesh_axis(study)
    runs = with_tolerance(study, axis)
    if axis is None or len(axis["values"]) < 2 or not runs:
        return None
    place = axis["parameters"].index(TOLERANCE)
    others = [a for a in study["axes"] if a is not axis and a is not mesh]
    groups = {}
    for run in runs:
        key = tuple(setting(run, a) for a in others)
        groups.setdefault(key, []).append(run)
    figure = plt.figure(figsize=(9.4, 5.6), layout="constrained")
    axes = figure.add_subplot()
    styles = ("-", "--", ":", "-.")
    meshes = values_of(mesh)
    drawn = {}
    for group in groups.values():
        for value in meshes:
            points = sorted(
                (float(setting(run, axis).split(";")[place]), run["products"])
                for run in group
                if setting(run, mesh) == value
            )
            if len(points) < 2 or (value, tuple(points)) in drawn:
                continue
            k = list(groups.values()).index(group)
            drawn[value, tuple(points)] = k
            axes.plot(
                *zip(*points), color=COLOURS[meshes.index(value) % len(COLOURS)],
                linestyle=styles[k % len(styles)], marker=MARKERS[k % len(MARKERS)], markersize=4,
                linewidth=1.2, alpha=0.85,
            )
    axes.set_xscale("log")
    axes.invert_xaxis()
    counts = [run["products"] for run in runs if run["products"] > 0]
    if counts and max(counts) > 20 * min(counts):
        axes.set_yscale("log")
    else:
        axes.set_ylim(bottom=0)
    axes.set_xlabel("relative tolerance of the solver")
    axes.set_ylabel("applications of F")
    axes.set_title("Iterations against tolerance")
    tidy(axes)
    handles = []
    if mesh:
        handles += [
            Line2D([], [], color=COLOURS[k % len(COLOURS)], label=label_of(mesh, value))
            for k, value in enumerate(meshes)
        ]
    shown = sorted(set(drawn.values()))
    if len(groups) > 1:
        keys = list(groups)
        handles += [
            Line2D([], [], color=FAINT, linestyle=styles[k % len(styles)],
                   marker=MARKERS[k % len(MARKERS)], markersize=4,
                   label=", ".join(label_of(a, v) for a, v in zip(others, keys[k])))
            for k in shown
        ]
    legend_below(figure, handles, 3)
    return figure


def error_parts(study):
    """In the energy norm: medians over the other settings, of local solves the worst."""
    axis, mesh = axis_with(study, TOLERANCE), mesh_axis(study)
    runs = with_tolerance(study, axis)
    if axis is None or not runs:
        return None
    measure = measures_of(study)[0]
    place = axis["parameters"].index(TOLERANCE)
    meshes = [v for v in values_of(mesh) if any(setting(r, mesh) == v for r in runs)][:6]
    figure, flat = panels(len(meshes), width=4.2, height=3.2)
    values = []
    for axes, value in zip(flat, meshes):
        here = [run for run in runs if setting(run, mesh) == value]
        for part, (colour, marker, _) in PARTS.items():
            best = {}
            for run in here:
                x = float(setting(run, axis).split(";")[place])
                known = part != "solver" or run["solver_judged"]
                best.setdefault(x, []).append(error(run, measure, part) if known else math.nan)
            xs = sorted(best)
            chosen = np.max if part == "local" else np.median
            here_and_known = [[y for y in best[x] if y >= 0] for x in xs]  # nan is not
            ys = [chosen(some) if some else math.nan for some in here_and_known]
            ys = [y if y > 0 else math.nan for y in ys]
            values += ys
            axes.plot(xs, ys, color=colour, marker=marker or None, markersize=4, linewidth=1.3,
                      linestyle="--" if part == "discretisation" else "-")
        axes.axhline(here[0]["errors"][measure]["reference"], color=FAINT, linewidth=0.8,
                     linestyle=(0, (2, 3)))
        values.append(here[0]["errors"][measure]["reference"])
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.invert_xaxis()
        axes.set_title(label_of(mesh, value) if mesh else "")
        axes.set_xlabel("tolerance of the solver")
        axes.set_ylabel(f"relative error, {study['measures'][measure]}")
        axes.yaxis.label.set_fontsize(8)
        tidy(axes)
    limits = spread(None, values)
    for axes in flat:
        axes.set_ylim(*limits)
    handles = [
        Line2D([], [], color=colour, marker=marker or None, markersize=4, label=label,
               linestyle="--" if part == "discretisation" else "-")
        for part, (colour, marker, label) in PARTS.items()
    ]
    handles.append(Line2D([], [], color=FAINT, linestyle=(0, (2, 3)), label="the reference's own"))
    legend_below(figure, handles, 5)
    return figure


CHARTS = {
    "error_against_seconds": error_against_seconds,
    "adaptivity": adaptivity,
    "stages": stages,
    "iterations": iterations,
    "error_parts": error_parts,
}


def run(options):
    study = read_study(Path(options.directory) / "study.json")
    output = output_of(options)
    style = {**STYLE, "svg.hashsalt": "harmos", "svg.fonttype": "path"}
    with plt.rc_context(style):
        for name, draw in CHARTS.items():
            figure = draw(study)
            if figure is None:
                continue
            if options.title:
                figure.suptitle(options.title, fontsize=12)
            caption(figure, study)
            save(figure, output / f"{name}.svg", options.dpi, close=False)
            save(figure, output / f"{name}.png", options.dpi)
