# SPDX-License-Identifier: BSD-3-Clause
"""solution.png: the membranes in perspective and the traces along the contact interface.

The scalar displacement u is the height over the plane; along the contact interface the traces of
u are drawn together with the contact pressure. Nodes belong to the contact zone by their
active_set value; each node stands for the half cells on both its sides.

Fields with more cells than can be drawn are thinned by vertex clustering, subdomain by subdomain:
a lattice is laid over the subdomain's bounding box, every node moves to the node closest to its
lattice point, and the cells that collapse are dropped (J. Rossignac, P. Borrel, "Multi-resolution
3D approximations for rendering complex scenes", 1993). On a regular grid this leaves a coarser
grid with the same corners; on any other mesh it leaves no holes.
"""

import math
from dataclasses import dataclass

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib import patheffects
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from plot_style import BODY_COLOURS, CLOSED, DISPLACEMENT_MAP, INK, OPEN, PRESSURE, finish

MAX_CELLS = 40_000  # drawn in three dimensions; more take long and show no more at this size
MAX_SUBDOMAIN_EDGES = 2_000  # subdomains; their edges would cover the surface beyond this

CANDIDATE_CLOSED = 2  # in active_set; 1 is a candidate with an open gap, 0 no candidate


def thin_cells(field, limit):
    """About `limit` cells at most that cover the same area, see the head of this file.

    Also returns for every point the point it has moved to.
    """
    count = len(field.cells)
    if count <= limit:
        return field.cells, np.arange(len(field.xy))

    part = field.part_of_point
    used = np.unique(part)
    low = np.zeros((field.parts, 2))
    high = np.zeros((field.parts, 2))
    # Points come part by part, so each part is one run.
    starts = np.searchsorted(part, used)
    low[used] = np.minimum.reduceat(field.xy, starts, axis=0)
    high[used] = np.maximum.reduceat(field.xy, starts, axis=0)
    extent = np.maximum(high - low, 1e-300)

    share = limit * np.bincount(field.part_of_cell, minlength=field.parts) / count
    aspect = np.sqrt(extent[:, 0] / extent[:, 1])
    aspect = np.clip(aspect, 1e-3, 1e3)
    root = np.sqrt(np.maximum(share, 1.0))
    intervals = np.maximum(1, np.floor(np.stack([root * aspect, root / aspect], axis=1)))
    intervals = intervals.astype(np.int64)

    place = (field.xy - low[part]) / extent[part] * intervals[part]
    lattice = np.rint(place)
    distance = np.abs(place - lattice).max(axis=1)
    bins = (intervals + 1).prod(axis=1)
    first_bin = np.concatenate([[0], np.cumsum(bins)[:-1]])
    lattice = lattice.astype(np.int64)
    key = first_bin[part] + lattice[:, 0] * (intervals[part, 1] + 1) + lattice[:, 1]

    order = np.lexsort((distance, key))
    head = np.ones(len(order), dtype=bool)
    head[1:] = key[order[1:]] != key[order[:-1]]
    representative = np.empty(int(bins.sum()), dtype=np.int64)
    representative[key[order[head]]] = order[head]

    target = representative[key]
    moved = target[field.cells]
    in_order = np.sort(moved, axis=1)
    corners_left = 1 + (np.diff(in_order, axis=1) > 0).sum(axis=1)
    keep = corners_left >= 3
    _, once = np.unique(in_order[keep], axis=0, return_index=True)
    return moved[keep][once], target


def refine(corners, limit):
    """Cut few large cells into more small ones, (cells, 4, 3) in and out.

    Q1 functions are bilinear on a cell, so that nothing is invented: the pieces show how the
    displacement, and with it the colour, varies inside the cell.
    """
    times = min(48, int(math.sqrt(limit / len(corners))))
    if times < 2:
        return corners
    t = np.linspace(0, 1, times + 1)
    a, b, c, d = (corners[:, k, None, None, :] for k in range(4))
    r, s = t[None, :, None, None], t[None, None, :, None]
    grid = (1 - r) * (1 - s) * a + r * (1 - s) * b + r * s * c + (1 - r) * s * d
    pieces = [grid[:, :-1, :-1], grid[:, 1:, :-1], grid[:, 1:, 1:], grid[:, :-1, 1:]]
    return np.stack(pieces, axis=3).reshape(-1, 4, 3)


def boundary_edges(cells):
    """Edges that belong to one cell only; since parts share no points: all subdomain edges."""
    pairs = np.concatenate([cells[:, [k, (k + 1) % 4]] for k in range(4)])
    pairs = np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1)
    base = int(cells.max()) + 1
    keys, counts = np.unique(pairs[:, 0] * base + pairs[:, 1], return_counts=True)
    keys = keys[counts == 1]
    return np.stack([keys // base, keys % base], axis=1)


@dataclass
class Trace:
    """One body's side of the contact interface, ordered along it."""

    body: int
    s: np.ndarray
    xy: np.ndarray
    displacement: np.ndarray
    pressure: np.ndarray
    closed: np.ndarray

    def zones(self):
        """Runs of equal state as (s0, s1, closed); a node owns the half cells beside it."""
        middle = (self.s[1:] + self.s[:-1]) / 2
        limits = np.concatenate([self.s[:1], middle, self.s[-1:]])
        change = np.flatnonzero(np.diff(self.closed)) + 1
        starts = np.concatenate([[0], change]).astype(int)
        ends = np.concatenate([change, [len(self.s)]]).astype(int)
        return [(limits[a], limits[b], bool(self.closed[a])) for a, b in zip(starts, ends)]


def interface_traces(field):
    """The traces by body, and the name of the coordinate along the interface."""
    candidates = np.flatnonzero(field.active > 0)
    if len(candidates) == 0:
        return [], ""
    xy = field.xy[candidates]
    spread = xy.max(axis=0) - xy.min(axis=0)
    if spread.max() == 0:
        return [], ""
    along = int(np.argmax(spread))
    if spread.min() <= 1e-9 * spread.max():
        across = "xy"[1 - along]
        label = f"${'xy'[along]}$ along the contact interface ${across} = {xy[0, 1 - along]:g}$"
        coordinate = xy[:, along]
    else:
        # Not parallel to an axis: the distance along its longest direction.
        centre = xy.mean(axis=0)
        direction = np.linalg.svd(xy - centre, full_matrices=False)[2][0]
        direction *= np.sign(direction[along])
        coordinate = (xy - centre) @ direction
        coordinate -= coordinate.min()
        label = "distance along the contact interface"

    traces = []
    tolerance = 1e-9 * spread.max()
    for body in np.unique(field.body_of_point[candidates]):
        chosen = field.body_of_point[candidates] == body
        nodes = candidates[chosen]
        s = coordinate[chosen]
        order = np.argsort(s, kind="stable")
        nodes, s = nodes[order], s[order]
        # A node on the edge of subdomains comes once for each of them.
        fresh = np.concatenate([[True], np.diff(s) > tolerance])
        first = np.flatnonzero(fresh)
        copies = np.diff(np.concatenate([first, [len(s)]]))
        traces.append(
            Trace(
                body=int(body),
                s=s[first],
                xy=field.xy[nodes[first]],
                displacement=np.add.reduceat(field.displacement[nodes], first) / copies,
                pressure=np.maximum.reduceat(field.pressure[nodes], first),
                closed=np.maximum.reduceat(field.active[nodes], first) == CANDIDATE_CLOSED,
            )
        )
    return [trace for trace in traces if len(trace.s) > 1], label


@dataclass
class Look:
    """What pictures of several results have in common: least and greatest values."""

    heights: tuple
    sides: tuple  # of the displacement along the interface
    pressures: tuple


def look_of(fields):
    heights, sides, pressures = [], [], []
    for field in fields:
        heights += [float(field.displacement.min()), float(field.displacement.max())]
        for trace in interface_traces(field)[0]:
            sides += [float(trace.displacement.min()), float(trace.displacement.max())]
            pressures += [float(trace.pressure.min()), float(trace.pressure.max())]
    low, high = min(heights), max(heights)
    if high - low < 1e-14 * max(1.0, abs(high)):
        low, high = low - 0.5, high + 0.5
    return Look(
        (low, high),
        (min(sides, default=0.0), max(sides, default=0.0)),
        (min([0.0, *pressures]), max([0.0, *pressures])),
    )


def shaded(colours, corners):
    """Darken faces that turn away from a light, which makes the shape readable."""
    scale = np.ptp(corners.reshape(-1, 3), axis=0)
    scale[scale == 0] = 1
    scaled = corners / scale * [1, 1, 0.6]
    normal = np.cross(scaled[:, 2] - scaled[:, 0], scaled[:, 3] - scaled[:, 1])
    # A triangle repeats its last corner; its second diagonal is then an edge, which serves.
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal /= np.where(length == 0, 1, length)
    normal *= np.where(normal[:, 2:] < 0, -1, 1)
    light = np.array([-0.45, -0.35, 0.82])
    level = 0.80 + 0.26 * np.clip(normal @ light, 0, 1)
    out = colours.copy()
    out[:, :3] = np.clip(out[:, :3] * level[:, None], 0, 1)
    return out


def draw_membranes(axes, field, traces, look):
    cells, target = thin_cells(field, MAX_CELLS)
    u = field.displacement
    xyz = np.column_stack([field.xy, u])
    corners = refine(xyz[cells], MAX_CELLS)
    low, high = look.heights
    norm = matplotlib.colors.Normalize(low, high)
    colours = shaded(DISPLACEMENT_MAP(norm(corners[:, :, 2].mean(axis=1))), corners)

    # Heights are drawn in the order given here, not by matplotlib's guess of what hides what:
    # a guess for a whole surface and a whole set of lines is wrong as often as not.
    axes.computed_zorder = False
    # Smoothed edges of neighbours do not add up to full cover and would show as a web of lines.
    surface = Poly3DCollection(
        corners, facecolors=colours, edgecolors="none", linewidths=0, antialiaseds=False
    )
    surface.set_zorder(1)
    surface.set_clip_on(False)  # the axes are square, the picture is wider
    axes.add_collection3d(surface)

    if field.parts <= MAX_SUBDOMAIN_EDGES:
        width = 0.9 if field.parts <= 64 else 0.45
        # Of all cells, not of those left over: folds of these would show as stray edges.
        ends = np.unique(np.sort(target[boundary_edges(field.cells)], axis=1), axis=0)
        ends = ends[ends[:, 0] != ends[:, 1]]
        edges = Line3DCollection(xyz[ends], colors=INK, linewidths=width)
        edges.set_alpha(0.75)
        edges.set_zorder(2)
        edges.set_clip_on(False)
        axes.add_collection3d(edges)

    for trace in traces:
        for s0, s1, closed in trace.zones():
            inner = (trace.s > s0) & (trace.s < s1)
            s = np.concatenate([[s0], trace.s[inner], [s1]])
            line = [
                np.interp(s, trace.s, values)
                for values in (trace.xy[:, 0], trace.xy[:, 1], trace.displacement)
            ]
            # A pale rim keeps the line apart from the surface's colours.
            axes.plot(*line, color="white", linewidth=3.6, zorder=3, solid_capstyle="butt",
                      clip_on=False)
            axes.plot(
                *line, color=CLOSED if closed else OPEN, linewidth=2.6, zorder=4,
                solid_capstyle="butt", clip_on=False,
            )

    halo = [patheffects.withStroke(linewidth=2.5, foreground="white", alpha=0.8)]
    for number, body in enumerate(np.unique(field.body_of_point)):
        nodes = np.flatnonzero(field.body_of_point == body)
        corner = field.xy[nodes].min(axis=0)
        # Off the middle, where subdomains tend to meet.
        aim = corner + 0.28 * (field.xy[nodes].max(axis=0) - corner)
        node = nodes[np.argmin(((field.xy[nodes] - aim) ** 2).sum(axis=1))]
        axes.text(
            *xyz[node], body_name(number), fontsize=14, zorder=5, ha="center", va="center",
            path_effects=halo,
        )

    span = np.ptp(field.xy, axis=0)
    axes.set_xlim(field.xy[:, 0].min(), field.xy[:, 0].max())
    axes.set_ylim(field.xy[:, 1].min(), field.xy[:, 1].max())
    axes.set_zlim(low, high)
    axes.set_box_aspect((span[0], span[1], 0.58 * span.max()), zoom=1.08)
    axes.set_proj_type("persp", focal_length=0.6)
    axes.view_init(elev=30, azim=-66)
    intervals = [*np.maximum(2, np.rint(4 * span / span.max())), 4]
    for axis, most in zip((axes.xaxis, axes.yaxis, axes.zaxis), intervals):
        axis.pane.set_facecolor((0.97, 0.97, 0.97, 1.0))
        axis.pane.set_edgecolor("#DDDDDD")
        axis._axinfo["grid"].update(color="#E4E4E4", linewidth=0.6)
        axis.set_major_locator(MaxNLocator(int(most), steps=[1, 2, 5, 10]))
    axes.tick_params(labelsize=9, pad=1)
    axes.set_xlabel("$x$")
    axes.set_ylabel("$y$", labelpad=1)
    axes.set_zlabel("displacement $u$")

    mappable = plt.cm.ScalarMappable(norm, DISPLACEMENT_MAP)
    return mappable


def draw_trace(axes, traces, label, bodies, look):
    """Displacement of both sides and contact pressure along the interface."""
    second = axes.twinx()
    leader = max(traces, key=lambda trace: np.abs(trace.pressure).max())
    for s0, s1, closed in leader.zones():
        axes.axvspan(
            s0, s1, color=CLOSED if closed else OPEN, alpha=0.12 if closed else 0.16, linewidth=0
        )

    few = len(leader.s) <= 70
    second.fill_between(leader.s, 0, leader.pressure, color=PRESSURE, alpha=0.18, linewidth=0)
    second.plot(
        leader.s, leader.pressure, color=PRESSURE, linewidth=1.6, linestyle="--",
        marker="." if few else None, markersize=4,
    )
    if len(traces) == 2 and np.array_equal(traces[0].s, traces[1].s):
        axes.fill_between(
            traces[0].s, traces[0].displacement, traces[1].displacement, color=OPEN, alpha=0.45,
            linewidth=0,
        )
    for trace in traces:
        number = bodies.index(trace.body)
        axes.plot(
            trace.s, trace.displacement, color=BODY_COLOURS[number % len(BODY_COLOURS)],
            linewidth=2.2, linestyle=("-", (0, (5, 1.5)))[number % 2],
        )

    axes.set_xlabel(label)
    axes.set_ylabel("displacement $u$")
    second.set_ylabel("contact pressure", color=PRESSURE)
    second.tick_params(axis="y", colors=PRESSURE)
    second.spines["right"].set_color(PRESSURE)
    axes.set_xlim(leader.s[0], leader.s[-1])

    # Displacement takes the upper part of the panel and the pressure the lower, without
    # crossing.
    low, high = look.sides
    span = (high - low) or max(abs(high), 1.0)
    axes.set_ylim(low - 0.9 * span, high + 0.08 * span)
    bottom, top = look.pressures
    second.set_ylim(bottom, bottom + 2.3 * ((top - bottom) or 1.0))
    ticks = MaxNLocator(5).tick_values(low, high)
    axes.set_yticks(ticks[(ticks >= low - 0.1 * span) & (ticks <= high + 0.08 * span)])
    ticks = MaxNLocator(4).tick_values(bottom, (top if top > bottom else 1.0))
    second.set_yticks(ticks[(ticks >= bottom) & (ticks <= 1.2 * (top or 1.0))])
    # A label belongs to its curves, not to the middle of an axis used by half.
    axes.yaxis.set_label_coords(-0.2, 0.72)
    second.yaxis.set_label_coords(1.15, 0.24)
    for side in (axes, second):
        side.spines["top"].set_visible(False)
        # The axis of the pressure lies above; the curves of the displacement must stay visible.
        side.patch.set_visible(False)
    axes.set_zorder(second.get_zorder() + 1)


def body_name(number):
    return rf"$\Omega^{{{number + 1}}}$"


def plot_solution(field, title, caption, look=None, text=""):
    """A picture of one result; look is that of several, text is printed above."""
    look = look or look_of([field])
    traces, label = interface_traces(field)
    bodies = np.unique(field.body_of_point).tolist()
    figure = plt.figure(figsize=(13.0, 5.6) if traces else (8.0, 5.6))
    # The three-dimensional axes leave wide margins of their own and may reach over the rim.
    width = 0.60 if traces else 0.94
    left = figure.add_axes([-0.02, 0.03, width, 0.98], projection="3d")
    mappable = draw_membranes(left, field, traces, look)
    bar_left = 0.578 if traces else 0.91
    bar_axes = figure.add_axes([bar_left, 0.29, 0.117 / figure.get_figwidth(), 0.44])
    bar = figure.colorbar(mappable, cax=bar_axes)
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8, length=2)
    bar.ax.set_title("$u$", fontsize=10)

    handles = []
    if traces:
        right = figure.add_axes([0.705, 0.17, 0.235, 0.63])
        draw_trace(right, traces, label, bodies, look)
        states = [
            (colour, word)
            for colour, word, found in (
                (CLOSED, "closed", any(t.closed.any() for t in traces)),
                (OPEN, "open", not all(t.closed.all() for t in traces)),
            )
            if found
        ]
        handles += [
            Line2D([], [], color=colour, linewidth=2.6, label=f"contact {word}")
            for colour, word in states
        ]
        right.legend(
            handles=[
                Line2D(
                    [], [], color=BODY_COLOURS[bodies.index(t.body) % len(BODY_COLOURS)],
                    linewidth=2.2, linestyle=("-", (0, (5, 1.5)))[bodies.index(t.body) % 2],
                    label=f"$u$ of {body_name(bodies.index(t.body))}",
                )
                for t in traces
            ]
            + [
                Line2D(
                    [], [], color=PRESSURE, linewidth=1.6, linestyle="--",
                    label="contact pressure",
                ),
                Line2D([], [], linestyle="none", label=" "),
            ]
            + [
                Patch(color=colour, alpha=0.25, linewidth=0, label=word)
                for colour, word in states
            ],
            loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3, fontsize=9,
        )
    if field.parts <= MAX_SUBDOMAIN_EDGES:
        handles.append(Line2D([], [], color=INK, linewidth=0.9, label="subdomain edges"))
    if text:
        handles.append(Line2D([], [], linestyle="none", label=text))
    figure.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(0.38 if traces else 0.6, 0.93),
        fontsize=9,
    )
    finish(figure, title, caption)
    return figure
