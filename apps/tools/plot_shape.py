# SPDX-License-Identifier: BSD-3-Clause
"""shape.png: how a run of the program shape went on, and the contact before and after it.

Of history.csv, a row an accepted design, and of shape.csv, a row a contact point; while the run goes on history.csv is
there alone, and alone is drawn. Of cuts through the plane pressures and profiles are curves along the coordinate over which
the contact extends most, or along the contact where it turns back; of surfaces in space they are colours, seen along
the direction in which the surfaces extend least.

Where the design is a gap its profile is drawn, where it moves nodes the moved edge, its motion enlarged as the title says.
"""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from command_line import PlotError
from plot_friction import between_neighbours
from plot_style import BODY_COLOURS, CLOSED, DISPLACEMENT_MAP, FAINT, INK, STYLE, caption_of, finish, output_of, save
from run_results import read_summary

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from matplotlib.transforms import offset_copy

HISTORY = ("iteration", "evaluations", "cost", "gradient_norm", "constraint", "refused")
POINTS = ("surface", "node", *(f"{k}_{when}" for when in ("before", "after") for k in "xyz"), "gap_before",
          "gap_after", "pressure_before", "pressure_after", "area")
COST, GRADIENT, VIOLATION = BODY_COLOURS[0], CLOSED, FAINT
COLOURS = (BODY_COLOURS[0], BODY_COLOURS[1], BODY_COLOURS[2], "#E69F00")  # of surfaces, in turn
BEFORE = {"linestyle": (0, (4, 2)), "linewidth": 1.3, "alpha": 0.75}
AFTER = {"linestyle": "-", "linewidth": 1.8}
FEW_MARKS = 60  # points or iterations; marks would hide the line beyond this
FLAT = 1e-6  # of the extent: a line rather than a surface, a motion that is none
SEEN = 0.08  # of the extent: how far a motion that is enlarged seems to go
PRESSURE_MAP = plt.get_cmap("magma_r")


@dataclass
class Surface:
    name: str
    before: np.ndarray  # (points, 3)
    after: np.ndarray
    gaps: tuple  # (points,) before, after
    pressures: tuple  # likewise
    areas: np.ndarray

    @property
    def moved(self):
        return bool(np.abs(self.after - self.before).max() > FLAT * extent_of([self]))


def extent_of(surfaces):
    return float(np.ptp(np.concatenate([each.before for each in surfaces]), axis=0).max()) or 1.0


def number_of(text):
    return float(text) if text else math.nan


def read_rows(path, columns, remedy):
    """Lists of cells by name of these columns; half a row at the end of a file that grows is left out."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PlotError(f"{path}: {getattr(error, 'strerror', 'no text')}; {remedy}") from error
    rows = [row for row in csv.reader(text[: text.rfind("\n") + 1].splitlines()) if row]
    header = rows[0] if rows else []
    lacking = [name for name in columns if name not in header]
    if rows and lacking:
        raise PlotError(f"{path}: no column {', '.join(lacking)}; check that the program shape wrote it")
    for number, row in enumerate(rows[1:], start=2):
        if len(row) != len(header):
            raise PlotError(f"{path}: row {number} has {len(row)} cells for {len(header)} columns; repeat the run")
    return {name: [row[header.index(name)] for row in rows[1:]] for name in columns}


def numbers_of(table, path, texts=()):
    result = {}
    for name, cells in table.items():
        try:
            result[name] = cells if name in texts else np.array([number_of(cell) for cell in cells])
        except ValueError as error:
            raise PlotError(f"{path}: column {name}: {error}; repeat the run") from error
    return result


def read_history(path):
    """Columns of history.csv as arrays by name; an empty cell is not a number."""
    history = numbers_of(read_rows(path, HISTORY, "only the program shape writes it, once it has a first design"), path)
    if not len(history["cost"]):
        raise PlotError(f"{path}: no design in the file; wait for the first design or repeat the run")
    return history


def read_shape(path):
    """The surfaces of shape.csv in the order of the file."""
    table = numbers_of(read_rows(path, POINTS, "repeat the run"), path, ("surface",))
    names = np.array(table["surface"])
    if not len(names):
        raise PlotError(f"{path}: no contact point in the file; repeat the run")
    for name, values in table.items():
        if name != "surface" and not np.isfinite(values).all():
            raise PlotError(f"{path}: column {name} has values that are not finite; check the run, which has failed")
    pairs = {key: np.stack([table[f"{key}_before"], table[f"{key}_after"]]) for key in ("gap", "pressure")}
    before, after = (np.stack([table[f"{k}_{when}"] for k in "xyz"], axis=1) for when in ("before", "after"))
    surfaces = []
    for name in dict.fromkeys(table["surface"]):
        at = names == name
        surfaces.append(Surface(
            name, before[at], after[at], tuple(pairs["gap"][:, at]), tuple(pairs["pressure"][:, at]), table["area"][at]
        ))
    return surfaces


def path_of(points):
    """The order of points that lie one after the other on a curve; None if they spread over a surface.

    The tree of least length (Prim) that joins the points of a curve has no branches.
    """
    count = len(points)
    distance, parent = np.full(count, np.inf), np.full(count, -1)
    outside, links, last = np.ones(count, dtype=bool), [[] for _ in range(count)], 0
    for _ in range(count):
        outside[last] = False
        if parent[last] >= 0:
            links[last].append(parent[last])
            links[parent[last]].append(last)
            if len(links[parent[last]]) > 2:
                return None
        new = np.linalg.norm(points - points[last], axis=1)
        nearer = outside & (new < distance)
        distance[nearer], parent[nearer] = new[nearer], last
        last = int(np.where(outside, distance, np.inf).argmin())
    end = next((k for k in range(count) if len(links[k]) < 2), 0)
    order, before = [end], -1
    while len(order) < count:
        following = [k for k in links[order[-1]] if k != before]
        before = order[-1]
        order.append(following[0])
    return np.array(order)


def line_of(surface):
    """The order of its points along a curve, or None for a surface in space."""
    points = surface.before
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if len(points) < 3 or sizes[1] <= FLAT * sizes[0]:
        return np.argsort(points[:, int(np.ptp(points, axis=0).argmax())])
    # Scenes of the plane have no third coordinate.
    return path_of(points) if not points[:, 2].any() else None


def along(surfaces, orders):
    """What to draw over: numbers of each surface in its order, ascending, the name, and the coordinate if it is one."""
    k = int(np.ptp(np.concatenate([each.before for each in surfaces]), axis=0).argmax())
    lines = [each.before[order] for each, order in zip(surfaces, orders)]
    # A point back by rounding errors is none that turns back.
    slack = FLAT * extent_of(surfaces)
    if all((np.diff(line[:, k]) >= -slack).all() or (np.diff(line[:, k]) <= slack).all() for line in lines):
        return [line[:, k] for line in lines], f"${'xyz'[k]}$", k
    steps = [np.linalg.norm(np.diff(line, axis=0), axis=1) for line in lines]
    return [np.concatenate([[0.0], np.cumsum(step)]) for step in steps], "length along the contact", None


def mean_pressure(surfaces, when):
    areas = np.concatenate([each.areas for each in surfaces])
    pressures = np.concatenate([each.pressures[when] for each in surfaces])
    return float(pressures @ areas / areas.sum()) if areas.sum() > 0 else math.nan


def exaggeration(surfaces):
    """A round factor, not below one, with which the largest motion is seen."""
    largest = max(np.linalg.norm(each.after - each.before, axis=1).max() for each in surfaces)
    wanted = SEEN * extent_of(surfaces) / largest
    if wanted <= 1.5:
        return 1
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(step for step in (1, 2, 5) if step * power <= wanted) * power


def bare(axes, sides=("top", "right")):
    for side in sides:
        axes.spines[side].set_visible(False)


def formatted(axis):
    formatter = ScalarFormatter(useMathText=True)
    formatter.set_powerlimits((-3, 4))
    axis.set_major_formatter(formatter)


def positive(values):
    return np.where(values > 0, values, np.nan)


def draw_history(axes, history, columns=2):
    """Cost on the left, on the right and with logarithms the gradient's norm and how far a constraint is violated.

    columns  of the legend
    """
    k, cost = history["iteration"], history["cost"]
    second = axes.twinx()
    marker = "o" if len(k) <= FEW_MARKS else None
    handles = [axes.plot(k, cost, color=COST, linewidth=1.6, marker=marker, markersize=3.5, label="cost", zorder=3)[0]]
    refused = history["refused"] > 0
    if refused.any():
        handles += axes.plot(
            k[refused], cost[refused], "o", markersize=7, markerfacecolor="none", markeredgecolor=INK,
            label="after refused designs", zorder=4,
        )
    gradient, violation = positive(history["gradient_norm"]), positive(history["constraint"])
    for values, colour, style, text in (
        (gradient, GRADIENT, "-", "norm of the gradient"), (violation, VIOLATION, ":", "violated constraint")
    ):
        if np.isfinite(values).any():
            handles += second.plot(
                k, values, color=colour, linewidth=1.3, linestyle=style, marker=marker and "s", markersize=2.5, label=text
            )
    if len(handles) > 1 and second.lines:
        second.set_yscale("log")
        if np.isfinite(gradient).any():
            # How little a constraint is violated beyond that is of no interest.
            second.set_ylim(bottom=max(second.get_ylim()[0], 0.1 * float(np.nanmin(gradient))))
        second.set_ylabel("norm of the gradient", color=GRADIENT)
        second.tick_params(axis="y", colors=GRADIENT, which="both")
    else:
        second.set_yticks([])
    if np.nanmin(cost) > 0 and np.nanmax(cost) > 10 * np.nanmin(cost):
        axes.set_yscale("log")
    else:
        formatted(axes.yaxis)
    axes.set_xlabel("iteration")
    axes.set_ylabel("cost", color=COST)
    axes.tick_params(axis="y", colors=COST)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    room = 0.03 * float(k[-1] - k[0]) or 0.5
    axes.set_xlim(k[0] - room, k[-1] + room)
    axes.set_zorder(second.get_zorder() + 1)
    axes.patch.set_visible(False)
    bare(axes, ("top",))
    bare(second, ("top",))
    # Above the power of ten that the numbers of the axis may have.
    axes.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncol=columns, fontsize=8.5, borderaxespad=0.2,
        columnspacing=1.2, bbox_transform=offset_copy(axes.transAxes, axes.figure, y=11, units="points"),
    )


def legend_of(axes, surfaces, more=(), columns=8):
    """Colours tell surfaces apart, where there are several, and lines what was before and after."""
    handles = []
    if len(surfaces) > 1:
        for each, colour in zip(surfaces, colours_of(surfaces)):
            handles.append(Line2D([], [], color=colour, linewidth=1.8, label=each.name.replace("$", r"\$")))
    colour = COLOURS[0] if len(surfaces) == 1 else INK
    handles += [
        Line2D([], [], color=colour, label="before", **BEFORE), Line2D([], [], color=colour, label="after", **AFTER), *more
    ]
    axes.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(-0.02, 1.03), ncol=min(len(handles), columns), fontsize=8.5,
        borderaxespad=0.2, columnspacing=1.2,
    )


def colours_of(surfaces):
    return [COLOURS[k % len(COLOURS)] for k in range(len(surfaces))]


def draw_pressures(axes, surfaces, orders, places, name):
    for each, order, s, colour in zip(surfaces, orders, places, colours_of(surfaces)):
        marker = "." if len(s) <= FEW_MARKS else None
        for when, style in enumerate((BEFORE, AFTER)):
            axes.plot(s, each.pressures[when][order], color=colour, marker=marker, markersize=4, **style)
    mean = mean_pressure(surfaces, 1)
    line = axes.axhline(mean, color=FAINT, linewidth=1.1, linestyle="--", zorder=1)
    line.set_label(f"mean {mean:.4g}")
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.set_xlabel(name)
    axes.set_ylabel("contact pressure")
    formatted(axes.yaxis)
    axes.grid(color="#E4E4E4", linewidth=0.6)
    axes.margins(x=0.02)
    bare(axes)
    legend_of(axes, surfaces, [line], 3)


def draw_gaps(axes, surfaces, orders, places, name):
    for each, order, s, colour in zip(surfaces, orders, places, colours_of(surfaces)):
        marker = "." if len(s) <= FEW_MARKS else None
        for when, style in enumerate((BEFORE, AFTER)):
            axes.plot(s, each.gaps[when][order], color=colour, marker=marker, markersize=4, **style)
    axes.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1)
    axes.set_xlabel(name)
    axes.set_ylabel("gap at rest")
    formatted(axes.yaxis)
    legend_of(axes, surfaces)


def draw_edges(axes, surfaces, orders, coordinate):
    """Moved edges in their plane, the coordinate along which they extend most from left to right."""
    factor = exaggeration(surfaces)
    first = coordinate if coordinate is not None else 0
    second = 1 if first == 0 else 0
    for each, order, colour in zip(surfaces, orders, colours_of(surfaces)):
        marker = "." if len(order) <= FEW_MARKS else None
        for share, style in ((0.0, BEFORE), (factor, AFTER)):
            points = (each.before + share * (each.after - each.before))[order]
            axes.plot(points[:, first], points[:, second], color=colour, marker=marker, markersize=4, **style)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"${'xyz'[first]}$")
    axes.set_ylabel(f"${'xyz'[second]}$")
    more = [Line2D([], [], linestyle="none", label=f"motion drawn {factor:g} times as large")] if factor > 1 else []
    legend_of(axes, surfaces, more)


def plot_plane(history, surfaces, orders, title, caption):
    places, name, coordinate = along(surfaces, orders)
    figure = plt.figure(figsize=(11.0, 7.8))
    lift = -0.03 if title else 0.0
    draw_history(figure.add_axes([0.085, 0.575 + lift, 0.34, 0.325]), history)
    draw_pressures(figure.add_axes([0.585, 0.575 + lift, 0.395, 0.325]), surfaces, orders, places, name)
    below = figure.add_axes([0.085, 0.135, 0.895, 0.32 + lift])
    if any(each.moved for each in surfaces):
        draw_edges(below, surfaces, orders, coordinate)
    else:
        draw_gaps(below, surfaces, orders, places, name)
        below.margins(x=0.01)
    below.grid(color="#E4E4E4", linewidth=0.6)
    bare(below)
    finish(figure, title, caption)
    return figure


def draw_map(figure, axes, flat, values, limits, colours, title):
    """Discs as wide as the points are apart, with a scale below. @param limits of the colours"""
    low, high = flat.min(axis=0), flat.max(axis=0)
    margin = 0.06 * float((high - low).max())
    axes.set_aspect("equal", adjustable="box", anchor="S")
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    apart = between_neighbours(flat)
    inches = figure.get_size_inches() * axes.get_position().size
    width = 72.0 * (inches / (high - low + 2 * margin)).min() * apart if apart else 8.0
    drawn = axes.scatter(
        *flat.T, s=float(np.clip(1.25 * width, 1.7, 24.0)) ** 2, c=values, cmap=colours, vmin=limits[0], vmax=limits[1],
        linewidths=0,
    )
    axes.set_title(title, fontsize=10)
    for side in axes.spines.values():
        side.set_color(FAINT)
    return drawn


def draw_scale(figure, drawn, box, text):
    bar = figure.colorbar(drawn, cax=figure.add_axes(box), orientation="horizontal")
    bar.outline.set_visible(False)
    bar.formatter.set_powerlimits((-3, 4))
    bar.locator = MaxNLocator(5)
    bar.update_ticks()
    bar.set_label(text, fontsize=9)


def plot_space(history, surfaces, title, caption):
    before, after = (np.concatenate([getattr(each, when) for each in surfaces]) for when in ("before", "after"))
    _, _, axes_of = np.linalg.svd(before - before.mean(axis=0), full_matrices=False)
    across = int(np.abs(axes_of[-1]).argmax())
    first, second = (k for k in range(3) if k != across)
    pressures = [np.concatenate([each.pressures[when] for each in surfaces]) for when in (0, 1)]
    figure = plt.figure(figsize=(12.0, 8.4))
    draw_history(figure.add_axes([0.07, 0.665 if title else 0.69, 0.855, 0.21]), history, 4)
    largest = max(values.max() for values in pressures)
    limits = (min(0.0, *(values.min() for values in pressures)), largest if largest > 0 else 1.0)
    if any(each.moved for each in surfaces):
        profile, words = (after - before)[:, across], f"motion along ${'xyz'[across]}$"
    else:
        profile, words = np.concatenate([each.gaps[1] for each in surfaces]), "gap at rest, after"
    panels = [
        (pressures[0], limits, PRESSURE_MAP, "pressure before"), (pressures[1], limits, PRESSURE_MAP, "pressure after"),
        (profile, (profile.min(), profile.max()), DISPLACEMENT_MAP, words),
    ]
    flat = before[:, [first, second]]
    for k, (values, between, colours, text) in enumerate(panels):
        axes = figure.add_axes([0.07 + 0.325 * k, 0.215, 0.255, 0.36])
        shown = text
        if k < 2:
            mean = mean_pressure(surfaces, k)
            shown += f", {values.max():.4g} at most, mean {mean:.4g}"
        drawn = draw_map(figure, axes, flat, values, between, colours, shown)
        axes.set_xlabel(f"${'xyz'[first]}$")
        axes.set_ylabel(f"${'xyz'[second]}$")
        if k > 0:
            box = [0.07, 0.115, 0.58, 0.015] if k == 1 else [0.72, 0.115, 0.255, 0.015]
            draw_scale(figure, drawn, box, "contact pressure" if k == 1 else words)
    finish(figure, title, caption)
    return figure


def plot_shape(history, surfaces, title, caption):
    """A figure of the history, and of the surfaces where there are some."""
    if not surfaces:
        figure = plt.figure(figsize=(8.0, 4.8))
        draw_history(figure.add_axes([0.12, 0.16, 0.75, 0.64 if title else 0.7]), history, 4)
        finish(figure, title, caption)
        return figure
    orders = [line_of(each) for each in surfaces]
    if any(order is None for order in orders):
        return plot_space(history, surfaces, title, caption)
    return plot_plane(history, surfaces, orders, title, caption)


def words_of(history, summary):
    """The caption: peaks and work of the run, then what all runs tell."""
    words, results = [], summary.get("results", {})
    peaks = [results.get(key) for key in ("peak_pressure_before", "peak_pressure", "mean_pressure")]
    if all(isinstance(value, (int, float)) for value in peaks) and peaks[2]:
        words.append("peak pressure {:.4g}, after {:.4g}, {:.4g} times the mean".format(*peaks[:2], peaks[1] / peaks[2]))
    evaluations = results.get("evaluations", history["evaluations"][-1])
    words.append(f"{evaluations:g} evaluations")
    return words + (caption_of(summary) if summary else [f"running: {history['iteration'][-1]:g} iterations so far"])


def run(options):
    directory = Path(options.directory)
    if not directory.is_dir():
        raise PlotError(f"{directory}: no such directory; name the directory of a run of the program shape")
    history = read_history(directory / "history.csv")
    # A run that goes on has neither.
    shape, summary = directory / "shape.csv", directory / "summary.json"
    surfaces = read_shape(shape) if shape.exists() else []
    caption = words_of(history, read_summary(summary) if summary.exists() else {})
    with plt.rc_context({**STYLE, "text.usetex": False}):
        figure = plot_shape(history, surfaces, options.title, caption)
        save(figure, output_of(options) / "shape.png", options.dpi)
