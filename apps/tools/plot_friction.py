# SPDX-License-Identifier: BSD-3-Clause
"""friction.png: where surfaces stick and slip, with the tractions on them, and how far they have slipped.

With --frames friction_0001.png and so on, too, all with one scale.

Points of a flat interface in the plane are drawn along it, as curves, which open points between them part; those of others, and of surfaces in
space, in the plane that they spread over, as discs, with arrows for tractions and colours for slips. Of two
surfaces that bear the same points the one of the body that has more of them is shown, or that comes first.
"""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from plot_style import BODY_COLOURS, FAINT, INK, finish

STICKS, SLIPS = "#009E73", "#E69F00"  # as in plot_style: Okabe, Ito
SLIPPING = 2  # in friction_state; 1 sticks, 0 bears no friction
PALE = 0.55  # opacity of the zones in space, on which arrows are drawn
SLIP_MAP = plt.get_cmap("magma_r")
MOST_ARROWS = 900
MOST_LOOKED_AT = 500  # points, for how far they are from their neighbours


@dataclass
class Points:
    """The points that bear friction, each once."""

    flat: np.ndarray  # (points, 2) in the plane of the picture
    order: list  # its axes
    traction: np.ndarray  # (points, 2) likewise
    size: np.ndarray  # of tractions
    slip: np.ndarray  # size
    slips: np.ndarray  # whether
    open: np.ndarray  # (points,) first coordinates of those that bear none

    @property
    def names(self):
        return tuple("$" + "xyz"[k] + "$" for k in self.order)


@dataclass
class Look:
    """What pictures of several steps have in common."""

    order: list  # axes
    line: bool  # whether the points lie on a line along the first axis
    low: np.ndarray  # corners of what is seen
    high: np.ndarray
    traction: float  # largest
    slip: float


def bears_friction(solid):
    return getattr(solid, "friction", None) is not None and bool((solid.friction > 0).any())


def look_of(results):
    """None where nothing bears friction."""
    every = [points_of(solid) for solid in results if bears_friction(solid)]
    if not every:
        return None
    order = max(every, key=lambda points: len(points.flat)).order
    seen = [points_of(solid, order) for solid in results if bears_friction(solid)]
    flat = np.concatenate([points.flat for points in seen])
    spread = np.ptp(flat, axis=0)
    return Look(
        order, bool(spread[0] > 0 and spread[1] <= 1e-6 * spread[0]), flat.min(axis=0), flat.max(axis=0),
        max(points.size.max() for points in seen), max(points.slip.max() for points in seen),
    )


def points_of(solid, order=None):
    nodes = np.flatnonzero(solid.friction > 0)
    # With mortar coupling the second surface has those points alone that nodes of both share.
    bodies = solid.body_of_point[nodes]
    nodes = nodes[np.lexsort((bodies, -np.bincount(bodies)[bodies]))]
    extent = solid.extent or 1.0
    _, first = np.unique(np.round(solid.xyz[nodes] / extent, 7), axis=0, return_index=True)
    nodes = nodes[np.sort(first)]
    xyz = solid.xyz[nodes]
    if order is None and (len(nodes) < 3 or solid.dimension == 2):
        spread = np.ptp(xyz, axis=0)
        order = [0, 1] if spread[0] >= spread[1] or spread[0] > 1e-6 * spread[1] else [1, 0]
    elif order is None:
        _, _, axes = np.linalg.svd(xyz - xyz.mean(axis=0), full_matrices=False)
        order = [k for k in range(3) if k != int(np.abs(axes[2]).argmax())]
    axes = np.eye(3)[order]
    traction, slip = solid.traction[nodes], solid.slip[nodes]
    return Points(
        xyz @ axes.T, order, traction @ axes.T, np.linalg.norm(traction, axis=1), np.linalg.norm(slip, axis=1),
        solid.friction[nodes] == SLIPPING,
        solid.xyz[(solid.active > 0) & (solid.friction == 0)] @ axes[0],
    )


def runs_of(points):
    """Points along the first axis, in runs that no open point parts: arrays of their numbers."""
    order = np.argsort(points.flat[:, 0])
    s, between = points.flat[order, 0], np.sort(points.open)
    tolerance = 1e-9 * max(np.ptp(s), 1e-300)
    parted = np.searchsorted(between, s[1:] - tolerance) > np.searchsorted(between, s[:-1] + tolerance)
    return np.split(order, np.flatnonzero(parted) + 1)


def zones(points):
    """(begin, end, slips) of runs of equal state along the first axis; a point owns the half ways beside it, up to the next
    point, an open one too."""
    every = np.unique(np.concatenate([points.flat[:, 0], points.open]))
    found = []
    for run in runs_of(points):
        s, slips = points.flat[run, 0], points.slips[run]
        before, after = every[every < s[0]], every[every > s[-1]]
        ends = [0.5 * (s[0] + before[-1]) if len(before) else s[0], 0.5 * (s[-1] + after[0]) if len(after) else s[-1]]
        limits = np.concatenate([ends[:1], 0.5 * (s[1:] + s[:-1]), ends[1:]])
        change = np.flatnonzero(np.diff(slips)) + 1
        found += [
            (limits[a], limits[b], bool(slips[a]))
            for a, b in zip(np.concatenate([[0], change]), np.concatenate([change, [len(s)]]))
        ]
    return found


def draw_line(figure, points, look):
    axes = figure.add_axes([0.1, 0.2, 0.78, 0.6])
    second = axes.twinx()
    for begin, end, slips in zones(points):
        axes.axvspan(begin, end, color=SLIPS if slips else STICKS, alpha=0.18, linewidth=0)
    for run in runs_of(points):
        s = points.flat[run, 0]
        marker = "." if len(points.flat) <= 120 or len(run) == 1 else None
        axes.plot(s, points.size[run], color=INK, linewidth=1.8, marker=marker, markersize=4)
        second.plot(
            s, points.slip[run], color=BODY_COLOURS[0], linewidth=1.6, linestyle="--", marker=marker, markersize=4
        )
    axes.set_xlabel(f"{points.names[0]} along the interface")
    axes.set_ylabel("traction of friction")
    second.set_ylabel("slip", color=BODY_COLOURS[0])
    second.tick_params(axis="y", colors=BODY_COLOURS[0])
    for side, largest in ((axes, look.traction), (second, look.slip)):
        side.set_ylim(0, 1.05 * largest if largest > 0 else 1.0)
        side.spines["top"].set_visible(False)
    axes.set_xlim(look.low[0], look.high[0])
    return [
        Line2D([], [], color=INK, linewidth=1.8, label="traction of friction"),
        Line2D([], [], color=BODY_COLOURS[0], linewidth=1.6, linestyle="--", label="slip"),
    ]


def between_neighbours(flat):
    """The median distance of points from the nearest other one; None of a single point."""
    some = flat[np.linspace(0, len(flat) - 1, min(MOST_LOOKED_AT, len(flat))).astype(int)]
    distance = np.hypot(*(some[:, None] - flat[None]).transpose(2, 0, 1))
    nearest = np.where(distance > 0, distance, np.inf).min(axis=1)
    return float(np.median(nearest)) if np.isfinite(nearest).all() else None


def draw_map(figure, points, look):
    spread = max((look.high - look.low).max(), 1e-300)
    low, high = look.low - 0.08 * spread, look.high + 0.08 * spread
    left = figure.add_axes([0.07, 0.12, 0.4, 0.68])
    right = figure.add_axes([0.55, 0.12, 0.36, 0.68])
    apart = between_neighbours(points.flat)
    for axes in (left, right):
        axes.set_aspect("equal")
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
    # As wide as there is room for, so that zones are seen as such.
    inches = figure.get_size_inches() * right.get_position().size
    width = 72.0 * (inches / (high - low)).min() * apart if apart else 8.0
    area = float(np.clip(width, 1.7, 16.0)) ** 2
    left.scatter(*points.flat.T, s=area, c=np.where(points.slips, SLIPS, STICKS), alpha=PALE, linewidths=0)
    if look.traction > 0:
        shown = np.linspace(0, len(points.flat) - 1, min(MOST_ARROWS, len(points.flat))).astype(int)
        arrows = points.traction[shown] / look.traction * 0.09 * spread
        left.quiver(
            *points.flat[shown].T, *arrows.T, angles="xy", scale_units="xy", scale=1, color=INK, width=0.0035,
        )
    left.set_title(f"traction, at most {points.size.max():.3g}", fontsize=10)
    drawn = right.scatter(
        *points.flat.T, s=area, c=points.slip, cmap=SLIP_MAP, vmin=0.0, vmax=look.slip or None, linewidths=0
    )
    right.set_title("slip", fontsize=10)
    bar = figure.colorbar(drawn, cax=figure.add_axes([0.925, 0.2, 0.012, 0.5]))
    bar.outline.set_visible(False)
    bar.formatter.set_powerlimits((-3, 4))
    bar.update_ticks()
    for axes in (left, right):
        axes.set_xlabel(points.names[0])
        axes.set_ylabel(points.names[1])
        axes.grid(color="#EEEEEE", linewidth=0.6)
        for side in axes.spines.values():
            side.set_color(FAINT)
    return []


def plot_friction(solid, title, caption, look=None, text=""):
    """A picture of one result that bears friction. @param look of all results that are to be alike."""
    look = look or look_of([solid])
    points = points_of(solid, look.order)
    figure = plt.figure(figsize=(8.0, 4.8) if look.line else (12.0, 5.6))
    handles = (draw_line if look.line else draw_map)(figure, points, look)
    slipping = int(points.slips.sum())
    handles += [
        Patch(color=colour, alpha=0.5 if look.line else PALE, linewidth=0, label=f"{count} points {word}")
        for colour, word, count in (
            (STICKS, "stick", len(points.slips) - slipping), (SLIPS, "slip", slipping)
        )
        if count
    ]
    if text:
        handles.append(Line2D([], [], linestyle="none", label=text))
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.93), ncol=5, fontsize=9)
    finish(figure, title, caption)
    return figure
