# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of a run: solution.png and convergence.png; while it goes on, contact.png.

convergence.png draws the norms of the projected gradient and of the equality residual against
the number of Hessian applications, the cost that is independent of the machine; solution.png is
described in plot_solution.py for membranes, in plot_deformed.py for elastic bodies in the plane and in plot_solid.py for
those in space, pictures of a run that goes on in follow_run.py, of one of several steps in plot_frames.py.
"""

import sys
from pathlib import Path

import numpy as np
from follow_run import follow
from plot_damage import may_break, plot_damage
from plot_frames import draw_frames, frames_of, painter_of
from plot_friction import bears_friction, plot_friction
from plot_style import FAINT, INK, STYLE, caption_of, finish, output_of, save
from command_line import PlotError
from run_results import read_iterations, read_result, read_summary

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

# Colour, marker and size of each kind of step.
STEPS = {
    "start": ("#000000", "*", 9.0),
    "cg": ("#0072B2", "o", 3.2),
    "expansion": ("#D55E00", "^", 5.5),
    "proportioning": ("#009E73", "s", 4.6),
    "pcpg": ("#56B4E9", "o", 3.2),
    "active set": ("#E69F00", "D", 4.6),
}


def positive(values):
    """Values a logarithmic axis can show; anything else becomes a gap in the line."""
    return np.where(values > 0, values, np.nan)


def tolerance(summary, name):
    value = summary.get(name)
    if isinstance(value, (int, float)) and not isinstance(value, bool) and value > 0:
        return float(value)
    return None


# Of outer iterations; more would cover what is drawn.
MOST_MARKED = 60

# What is that far below the least tolerance is not drawn: rounding errors, others on each machine.
SHOWN_BELOW_TOLERANCE = 0.1


def plot_convergence(table, summary, title, caption):
    figure = plt.figure(figsize=(9.0, 6.4))
    upper = figure.add_axes([0.1, 0.37, 0.87, 0.47 if title else 0.51])
    lower = figure.add_axes([0.1, 0.15, 0.87, 0.18], sharex=upper)

    x = table["hessian_applications"]
    gradient = positive(table["projected_gradient"])
    equality = positive(table["equality_residual"])
    few = len(x) <= 400
    handles = []

    if np.isfinite(gradient).any():
        upper.plot(x, gradient, color="#0072B2", linewidth=1.2, alpha=0.7, zorder=2)
        handles.append(Line2D([], [], color="#0072B2", linewidth=1.2, label="projected gradient"))
        for kind, (colour, marker, size) in STEPS.items():
            chosen = (table["step"] == kind) & np.isfinite(gradient)
            if not chosen.any():
                continue
            upper.plot(
                x[chosen], gradient[chosen], linestyle="none", marker=marker, color=colour,
                markersize=size if few else 0.7 * size, markeredgecolor="white",
                markeredgewidth=0.3, zorder=4 if kind != "cg" else 3,
            )
            handles.append(
                Line2D([], [], linestyle="none", marker=marker, color=colour, markersize=size,
                       label=f"step: {kind}")
            )
    tolerances = [tolerance(summary, f"tolerance_{name}")
                  for name in ("projected_gradient", "equality_residual")]
    floor = SHOWN_BELOW_TOLERANCE * min(filter(None, tolerances), default=0.0)
    if np.isfinite(equality).any():
        label = "equality residual"
        if np.nanmax(equality) < floor:
            label += f", below {floor:.0e}"
        upper.plot(
            x, equality, color="#CC79A7", linewidth=1.6, zorder=2,
            marker="." if len(x) <= 3 else None,
        )
        handles.append(Line2D([], [], color="#CC79A7", linewidth=1.6, label=label))

    for name, colour, text in (
        ("tolerance_projected_gradient", "#0072B2", "tolerance, gradient"),
        ("tolerance_equality_residual", "#CC79A7", "tolerance, equality"),
    ):
        value = tolerance(summary, name)
        if value is not None:
            upper.axhline(value, color=colour, linewidth=1.0, linestyle=(0, (6, 3)), zorder=1)
            handles.append(
                Line2D([], [], color=colour, linewidth=1.0, linestyle=(0, (6, 3)), label=text)
            )

    outer = table["outer"]
    begins = np.flatnonzero(np.diff(outer) != 0) + 1
    if len(begins) > MOST_MARKED:
        handles.append(Line2D([], [], linestyle="none", label=f"{len(begins) + 1} outer iterations, not marked"))
    elif len(begins):
        for axes in (upper, lower):
            for k in begins:
                axes.axvline(x[k], color=FAINT, linewidth=0.7, alpha=0.7, zorder=0)
        handles.append(
            Line2D([], [], color=FAINT, linewidth=0.7, label="new outer iteration")
        )

    if np.isfinite(gradient).any() or np.isfinite(equality).any():
        upper.set_yscale("log")
        if upper.get_ylim()[0] < floor:
            highest = max(np.nanmax(v) for v in (gradient, equality) if np.isfinite(v).any())
            upper.set_ylim(floor, max(highest, 10 * floor) * 2)
        upper.grid(axis="y", color="#E4E4E4", linewidth=0.6)
    else:
        upper.set_yticks([])
        upper.text(0.5, 0.5, "all residuals are zero", ha="center", transform=upper.transAxes)
    upper.set_ylabel("norm")
    upper.tick_params(axis="x", labelbottom=False)

    lower.step(x, table["active"], where="post", color=INK, linewidth=1.2)
    lower.plot(x, table["active"], linestyle="none", marker=".", markersize=3, color=INK)
    lower.set_ylabel("active\nconstraints")
    lower.set_xlabel("Hessian applications")
    lower.grid(axis="y", color="#E4E4E4", linewidth=0.6)
    bottom, top = lower.get_ylim()
    lower.set_ylim(min(bottom, top - 2), max(top, bottom + 2))  # room for whole numbers
    lower.yaxis.set_major_locator(MaxNLocator(4, integer=True))
    lower.xaxis.set_major_locator(MaxNLocator(integer=True))
    low, high = float(np.nanmin(x)), float(np.nanmax(x))
    margin = 0.02 * (high - low) or 1.0
    lower.set_xlim(low - margin, high + margin)
    for axes in (upper, lower):
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    upper.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncol=4, fontsize=8.5,
        borderaxespad=0.2, columnspacing=1.6,
    )
    finish(figure, title, caption)
    return figure


def run(options):
    directory = Path(options.directory)
    if not directory.is_dir() and not options.follow:
        raise PlotError(f"{directory}: no such directory; name the directory of a finished run")
    output = output_of(options)
    if options.follow:
        follow(directory, output, options.dpi, options.interval, plot_convergence)
    if (directory / "history.csv").exists() and not (directory / "iterations.csv").exists():
        raise PlotError(f"{directory}: output of the program shape; plot it with harmos-plot {directory} --shape")
    summary = read_summary(directory / "summary.json")
    table = read_iterations(directory / "iterations.csv")
    frames = frames_of(directory)
    if options.frames and (not frames or frames[0].time is None):
        raise PlotError(
            f"{directory}/result.vtkhdf.series: not there; frames are those of a run of several steps "
            "that writes its fields (\"Output/Fields\")"
        )

    with plt.rc_context(STYLE):
        if frames:
            field = read_result(frames[-1].path)
            text = "" if frames[-1].time is None else frames[-1].text
            figure = painter_of(field)[1](field, options.title, caption_of(summary), None, text=text)
            save(figure, output / "solution.png", options.dpi)
            if bears_friction(field):
                figure = plot_friction(field, options.title, caption_of(summary), text=text)
                save(figure, output / "friction.png", options.dpi)
            if may_break(field):
                figure = plot_damage(field, options.title, caption_of(summary), text=text)
                save(figure, output / "damage.png", options.dpi)
        else:
            print(
                f"{directory / 'result.vtkhdf'}: not found (\"Output/Fields\" was off); "
                "only convergence.png is drawn",
                file=sys.stderr,
            )
        figure = plot_convergence(table, summary, options.title, caption_of(summary))
        save(figure, output / "convergence.png", options.dpi)
    if options.frames:
        draw_frames(frames, output, options.title, summary, options.dpi)
