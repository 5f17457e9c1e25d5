# SPDX-License-Identifier: BSD-3-Clause
"""damage.png: how far the points of interfaces that may break are damaged, 0 intact to 1 broken.

With --frames damage_0001.png and so on, too, all on one scale, and damage.gif.

In the plane bodies are drawn deformed as in plot_deformed.py, and the sides that they share in the colour of their
damage; a node stands for the halves of the edges on both its sides. Points of surfaces in space are drawn as discs in the plane
that they spread over. Points that two bodies share count once; those of contacts that are not glued do not count.
"""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from plot_deformed import MAX_PIECES, deformed, look_of as deformed_look, outline
from plot_friction import between_neighbours
from plot_solution import thin_cells
from plot_style import FAINT, INK, OPEN, finish

BROKEN = OPEN  # of plain contact
DAMAGE_MAP = plt.get_cmap("plasma_r").with_extremes(over=BROKEN)
RANGE = Normalize(0.0, np.nextafter(1.0, 0.0))  # what is broken, 1 in the law of adhesion too, is over it
PALE = "#E6E6E6"  # bodies
PANEL = 5.6  # inches


@dataclass
class Look:
    """What pictures of several steps have in common."""

    scale: float  # of displacements
    limits: np.ndarray  # (least, most) of what is seen
    order: list  # in space, its axes


def may_break(solid):
    return getattr(solid, "damage", None) is not None and bool(solid.bound.any())


def look_of(results):
    """None where nothing may break."""
    if not any(may_break(solid) for solid in results):
        return None
    if results[0].dimension == 2:
        look = deformed_look(results)
        return Look(look.scale, look.limits, [0, 1])
    solid = next(solid for solid in results if may_break(solid))
    xyz = solid.xyz[points_of(solid)]
    _, _, axes = np.linalg.svd(xyz - xyz.mean(axis=0), full_matrices=True)
    order = [k for k in range(3) if k != int(np.abs(axes[2]).argmax())]
    flat = xyz[:, order]
    margin = 0.08 * max(np.ptp(flat, axis=0).max(), 1e-300)
    return Look(1.0, np.array([flat.min(axis=0) - margin, flat.max(axis=0) + margin]), order)


def at_places(solid):
    """Damage of each point, the largest of all copies of its node."""
    damage = np.zeros(int(solid.place.max()) + 1)
    np.maximum.at(damage, solid.place, solid.damage)
    return damage[solid.place]


def points_of(solid):
    """A node of each point of the interfaces, the most damaged of those that lie there."""
    nodes = np.flatnonzero(solid.bound)
    nodes = nodes[np.argsort(-solid.damage[nodes], kind="stable")]
    _, first = np.unique(np.round(solid.xyz[nodes] / (solid.extent or 1.0), 7), axis=0, return_index=True)
    return nodes[np.sort(first)]


def halves_of(solid):
    """Halves of the edges along interfaces, (halves, 2): their node and the other end; and their damage."""
    edges = outline(solid)
    bound = np.zeros(int(solid.place.max()) + 1, dtype=bool)
    np.logical_or.at(bound, solid.place, solid.bound)
    chosen = edges[bound[solid.place[edges]].all(axis=1)]
    halves = np.concatenate([chosen, chosen[:, ::-1]])
    return halves, at_places(solid)[halves[:, 0]]


def draw_plane(axes, solid, look):
    xy = deformed(solid, look.scale)
    pieces = thin_cells(solid, MAX_PIECES)[0]
    axes.add_collection(
        PolyCollection(xy[pieces], facecolors=PALE, edgecolors=PALE, linewidths=0.2, rasterized=True, zorder=1)
    )
    axes.add_collection(LineCollection(xy[outline(solid)], colors=INK, linewidths=0.5, zorder=2))
    halves, damage = halves_of(solid)
    lines = LineCollection(
        np.stack([xy[halves[:, 0]], xy[halves].mean(axis=1)], axis=1), array=damage, cmap=DAMAGE_MAP, norm=RANGE,
        linewidths=2.2, zorder=3,
    )
    lines.set_capstyle("butt")
    axes.add_collection(lines)
    return lines


def draw_map(axes, solid, look):
    nodes = points_of(solid)
    flat = solid.xyz[nodes][:, look.order]
    apart = between_neighbours(flat)
    size = 72.0 * PANEL / np.ptp(look.limits, axis=0).max() * apart if apart else 8.0
    return axes.scatter(
        *flat.T, s=float(np.clip(size, 1.7, 16.0)) ** 2, c=solid.damage[nodes], cmap=DAMAGE_MAP, norm=RANGE,
        linewidths=0,
    )


def plot_damage(solid, title, caption, look=None, text=""):
    """A picture of one result whose interfaces may break. @param look of all results that are to be alike."""
    look = look or look_of([solid])
    tall = PANEL * float(np.clip(np.divide(*np.ptp(look.limits, axis=0)[::-1]), 0.2, 1.3))
    sizes = 0.7 + PANEL + 1.3, 0.9 + tall + (1.2 if title else 0.8)
    figure = plt.figure(figsize=sizes)

    def axes_at(x, y, width, height):
        return figure.add_axes([x / sizes[0], y / sizes[1], width / sizes[0], height / sizes[1]])

    axes = axes_at(0.7, 0.95, PANEL, tall)
    drawn = (draw_plane if solid.dimension == 2 else draw_map)(axes, solid, look)
    axes.set_aspect("equal")
    axes.set_xlim(*look.limits[:, 0])
    axes.set_ylim(*look.limits[:, 1])
    for name, k in zip(("xlabel", "ylabel"), look.order):
        axes.set(**{name: "$" + "xyz"[k] + "$"})
    axes.ticklabel_format(scilimits=(-2, 4))
    for side in axes.spines:
        axes.spines[side].set_color(FAINT)
        axes.spines[side].set_visible(side in ("left", "bottom") or solid.dimension == 3)
    bar = figure.colorbar(drawn, cax=axes_at(sizes[0] - 1.15, 0.95 + 0.15 * tall, 0.12, 0.7 * tall), extend="max")
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8, length=2)
    bar.set_label("damage; broken at the tip", fontsize=9)
    damage = solid.damage[points_of(solid)]
    words = [
        *([text] if text else []),
        f"of {len(damage)} points {int((damage > 0).sum())} are damaged, {int((damage == 1).sum())} broken",
        *([f"displacements drawn {look.scale:g} times as large"] if solid.dimension == 2 else []),
    ]
    figure.legend(
        handles=[Line2D([], [], linestyle="none", label=word) for word in words], loc="upper center", ncol=3,
        fontsize=9, handlelength=0, bbox_to_anchor=(0.5, 1 - (0.4 if title else 0.1) / sizes[1]),
    )
    finish(figure, title, caption)
    return figure
