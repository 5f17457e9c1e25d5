# SPDX-License-Identifier: BSD-3-Clause
"""friction.png: where surfaces stick and slip, with the tractions on them, and how far they have slipped.

Points of a flat interface in the plane are drawn along it, as curves; those of others, and of surfaces in
space, in the plane that they spread over, with arrows for tractions and colours for slips. Of two surfaces that
bear the same points the one of the body that has more of them is shown, or that comes first.
"""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from plot_style import BODY_COLOURS, FAINT, INK, finish

STICKS, SLIPS = "#009E73", "#E69F00"  # as in plot_style: Okabe, Ito
SLIPPING = 2  # in friction_state; 1 sticks, 0 bears no friction
SLIP_MAP = plt.get_cmap("magma_r")
MOST_ARROWS = 900


@dataclass
class Points:
    """The points that bear friction, each once."""

    flat: np.ndarray  # (points, 2) in the plane of the picture
    names: tuple  # of its axes
    traction: np.ndarray  # (points, 2) likewise
    size: np.ndarray  # of tractions
    slip: np.ndarray  # size
    slips: np.ndarray  # whether

    @property
    def line(self):
        """Whether they lie on a line along the first axis."""
        spread = np.ptp(self.flat, axis=0)
        return len(self.flat) > 1 and spread[1] <= 1e-6 * spread[0]


def points_of(solid):
    nodes = np.flatnonzero(solid.friction > 0)
    # With mortar coupling the second surface has those points alone that nodes of both share.
    bodies = solid.body_of_point[nodes]
    nodes = nodes[np.lexsort((bodies, -np.bincount(bodies)[bodies]))]
    extent = solid.extent or 1.0
    _, first = np.unique(np.round(solid.xyz[nodes] / extent, 7), axis=0, return_index=True)
    nodes = nodes[np.sort(first)]
    xyz = solid.xyz[nodes]
    centre = xyz.mean(axis=0)
    _, _, axes = np.linalg.svd(xyz - centre, full_matrices=False)
    if len(nodes) < 3 or solid.dimension == 2:
        spread = np.ptp(xyz, axis=0)
        order = [0, 1] if spread[0] >= spread[1] or spread[0] > 1e-6 * spread[1] else [1, 0]
    else:
        order = [k for k in range(3) if k != int(np.abs(axes[2]).argmax())]
    axes = np.eye(3)[order]
    names = tuple("$" + "xyz"[k] + "$" for k in order)
    traction, slip = solid.traction[nodes], solid.slip[nodes]
    return Points(
        xyz @ axes.T, names, traction @ axes.T, np.linalg.norm(traction, axis=1), np.linalg.norm(slip, axis=1),
        solid.friction[nodes] == SLIPPING,
    )


def zones(points):
    """Runs of equal state along the first axis; a point owns the half ways beside it."""
    order = np.argsort(points.flat[:, 0])
    s, slips = points.flat[order, 0], points.slips[order]
    middle = 0.5 * (s[1:] + s[:-1])
    limits = np.concatenate([s[:1], middle, s[-1:]])
    change = np.flatnonzero(np.diff(slips)) + 1
    return order, [
        (limits[a], limits[b], bool(slips[a]))
        for a, b in zip(np.concatenate([[0], change]), np.concatenate([change, [len(s)]]))
    ]


def draw_line(figure, points):
    axes = figure.add_axes([0.1, 0.2, 0.78, 0.6])
    second = axes.twinx()
    order, runs = zones(points)
    for begin, end, slips in runs:
        axes.axvspan(begin, end, color=SLIPS if slips else STICKS, alpha=0.18, linewidth=0)
    s = points.flat[order, 0]
    marker = "." if len(s) <= 120 else None
    axes.plot(s, points.size[order], color=INK, linewidth=1.8, marker=marker, markersize=4)
    second.plot(
        s, points.slip[order], color=BODY_COLOURS[0], linewidth=1.6, linestyle="--", marker=marker, markersize=4
    )
    axes.set_xlabel(f"{points.names[0]} along the interface")
    axes.set_ylabel("traction of friction")
    second.set_ylabel("slip", color=BODY_COLOURS[0])
    second.tick_params(axis="y", colors=BODY_COLOURS[0])
    for side in (axes, second):
        side.set_ylim(bottom=0)
        side.spines["top"].set_visible(False)
    axes.set_xlim(s[0], s[-1])
    return [
        Line2D([], [], color=INK, linewidth=1.8, label="traction of friction"),
        Line2D([], [], color=BODY_COLOURS[0], linewidth=1.6, linestyle="--", label="slip"),
    ]


def draw_map(figure, points):
    spread = np.maximum(np.ptp(points.flat, axis=0), 1e-300)
    low, high = points.flat.min(axis=0) - 0.08 * spread.max(), points.flat.max(axis=0) + 0.08 * spread.max()
    size = float(np.clip(2600.0 / len(points.flat), 3.0, 60.0))
    left = figure.add_axes([0.07, 0.12, 0.4, 0.68])
    right = figure.add_axes([0.55, 0.12, 0.36, 0.68])
    left.scatter(*points.flat.T, s=size, c=np.where(points.slips, SLIPS, STICKS), linewidths=0)
    largest = points.size.max()
    if largest > 0:
        shown = np.linspace(0, len(points.flat) - 1, min(MOST_ARROWS, len(points.flat))).astype(int)
        arrows = points.traction[shown] / largest * 0.07 * spread.max()
        left.quiver(
            *points.flat[shown].T, *arrows.T, angles="xy", scale_units="xy", scale=1, color=INK, width=0.003,
        )
    left.set_title(f"traction, at most {largest:.3g}", fontsize=10)
    drawn = right.scatter(*points.flat.T, s=size, c=points.slip, cmap=SLIP_MAP, vmin=0.0, linewidths=0)
    right.set_title("slip", fontsize=10)
    bar = figure.colorbar(drawn, cax=figure.add_axes([0.925, 0.2, 0.012, 0.5]))
    bar.outline.set_visible(False)
    bar.formatter.set_powerlimits((-3, 4))
    bar.update_ticks()
    for axes in (left, right):
        axes.set_aspect("equal")
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_xlabel(points.names[0])
        axes.set_ylabel(points.names[1])
        axes.grid(color="#EEEEEE", linewidth=0.6)
        for side in axes.spines.values():
            side.set_color(FAINT)
    return []


def plot_friction(solid, title, caption, text=""):
    """A picture of one result that has friction."""
    points = points_of(solid)
    figure = plt.figure(figsize=(8.0, 4.8) if points.line else (12.0, 5.6))
    handles = (draw_line if points.line else draw_map)(figure, points)
    slipping = int(points.slips.sum())
    handles += [
        Patch(color=colour, alpha=0.5 if points.line else 1.0, linewidth=0, label=f"{count} points {word}")
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
