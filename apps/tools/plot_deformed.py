# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of elastic bodies in the plane: deformed meshes, and the contact pressure around a body.

Displacements are drawn exaggerated, so that the largest of them is a tenth to a fifth of the
whole and gaps can be seen, or less where bodies that have closed a gap would be seen far through each other; the picture
says by how much. Colour is the von Mises stress, or the
size of the displacement in results without stresses. The bodies' outlines are drawn and their contact
sides are marked as closed or open; a node stands for the halves of the edges on both its sides.
Bodies in space are drawn by plot_solid.py.
"""

import math
from dataclasses import dataclass

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.tri import Triangulation
from plot_solution import CANDIDATE_CLOSED, boundary_edges, thin_cells
from plot_style import CLOSED, DISPLACEMENT_MAP, FAINT, INK, OPEN, PRESSURE, finish
from command_line import PlotError

MAX_PIECES = 250_000  # drawn; more take long and show no more at this size
MAX_MESH = 8_000  # cells; their edges would cover the colours beyond this


def closing(solid):
    """How much nearer points in contact have come to the body that they touch; of a body nine of ten by no more.

    Of each the part of the relative displacement along the other body's normal; a gap closed by that is overshot as many
    times as displacements are enlarged. In the plane; of results in space it is 0.
    """
    touching = np.flatnonzero(solid.active == CANDIDATE_CLOSED)
    if solid.dimension == 3 or len(touching) == 0:
        return 0.0
    edges, xy = outline(solid), deformed(solid, 1.0)
    bodies, most = solid.body_of_point, 0.0
    for body in np.unique(bodies[touching]):
        own = touching[bodies[touching] == body]
        other = edges[bodies[edges[:, 0]] != body]
        if len(other) == 0:
            continue
        start, along = xy[other[:, 0]], np.diff(xy[other], axis=1)[:, 0]
        length2 = np.maximum((along**2).sum(axis=1), 1e-300)
        normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.sqrt(length2)[:, None]
        there = solid.displacement[other, :2].mean(axis=1)
        found = []
        for node in own:
            share = np.clip(((xy[node] - start) * along).sum(axis=1) / length2, 0.0, 1.0)
            distance = np.linalg.norm(start + share[:, None] * along - xy[node], axis=1)
            near = distance <= distance.min() + 1e-3 * solid.extent  # at a corner both its sides
            found.append(np.abs(((solid.displacement[node, :2] - there[near]) * normal[near]).sum(axis=1)).min())
        most = max(most, float(np.quantile(found, 0.9, method="lower")))
    return most


# Of the whole, that bodies are drawn through each other.
MOST_THROUGH = 0.004


def automatic_scale(solids):
    """1, 2 or 5 times a power of ten, at least one, the same for all; 1 of finite displacements."""
    if any(s.is_finite for s in solids):
        return 1.0
    share = max(np.linalg.norm(s.displacement, axis=1).max() / s.extent for s in solids)
    if share == 0:
        return 1.0
    target = 0.2 / share
    through = max(closing(s) / s.extent for s in solids)
    if through > 0:
        target = min(target, 1.0 + MOST_THROUGH / through)
    power = 10.0 ** math.floor(math.log10(target))
    return max(1.0, power * max(k for k in (1, 2, 5) if k * power <= target * (1 + 1e-9)))


def colour_values(solid):
    """What is drawn as colour, and its name."""
    if solid.von_mises is not None:
        return solid.von_mises, "von Mises stress"
    return np.linalg.norm(solid.displacement, axis=1), "displacement"


def all_edges(cells):
    pairs = np.concatenate([cells[:, [k, (k + 1) % 4]] for k in range(4)])
    return pairs[pairs[:, 0] != pairs[:, 1]]


def outline(solid):
    """Edges of the bodies' outlines as pairs of points; sides between subdomains are none."""
    first = np.unique(solid.place, return_index=True)[1]
    return first[boundary_edges(solid.place[solid.cells])]


def contact_halves(solid, edges):
    """Halves of the edges in contact: pairs (node, other end), and whether the node is closed."""
    state = np.zeros(int(solid.place.max()) + 1, dtype=int)
    np.maximum.at(state, solid.place, solid.active)
    state = state[solid.place]
    chosen = edges[(state[edges] > 0).all(axis=1)]
    halves = np.concatenate([chosen, chosen[:, ::-1]])
    return halves, state[halves[:, 0]] == CANDIDATE_CLOSED


def deformed(solid, scale):
    return (solid.xyz + scale * solid.displacement)[:, : solid.dimension]


def draw_plane(axes, solid, scale, norm):
    """One deformed mesh; returns which states of contact were drawn."""
    cells = thin_cells(solid, MAX_PIECES)[0]
    xy = deformed(solid, scale)
    values = colour_values(solid)[0]
    triangles = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    proper = (np.diff(np.sort(triangles, axis=1), axis=1) > 0).all(axis=1)
    axes.tripcolor(
        Triangulation(*xy.T, triangles[proper]), values, shading="gouraud", norm=norm,
        cmap=DISPLACEMENT_MAP, rasterized=True, zorder=1,
    )
    if len(solid.cells) <= MAX_MESH:
        mesh = np.unique(np.sort(all_edges(solid.cells), axis=1), axis=0)
        lines = LineCollection(xy[mesh], colors=INK, linewidths=0.25, alpha=0.4, zorder=1.5)
        axes.add_collection(lines)

    edges = outline(solid)
    axes.add_collection(LineCollection(xy[edges], colors=INK, linewidths=0.6, zorder=2))
    halves, closed = contact_halves(solid, edges)
    segments = np.stack([xy[halves[:, 0]], xy[halves].mean(axis=1)], axis=1)
    for chosen, colour in ((~closed, OPEN), (closed, CLOSED)):
        lines = LineCollection(segments[chosen], colors=colour, linewidths=1.0, zorder=3)
        lines.set_capstyle("butt")
        axes.add_collection(lines)
    axes.set_aspect("equal")
    axes.set_xlabel("$x$")
    axes.set_ylabel("$y$")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return {CLOSED if state else OPEN for state in np.unique(closed)}


@dataclass
class Look:
    """What pictures of several results have in common."""

    scale: float
    colours: matplotlib.colors.Normalize
    clipped: bool
    limits: np.ndarray  # (least, most) of x and y


def look_of(solids, scale=None):
    """Looks at all results, which are gone through several times, and may be read anew each time."""
    if len({s.dimension for s in solids}) > 1:
        raise PlotError("one run is plane and the other in space; plot them separately")
    scale = scale or automatic_scale(solids)
    lows, highs, tops, corners = [], [], [], []
    for solid in solids:
        values, xy = colour_values(solid)[0], deformed(solid, scale)
        lows.append(float(values.min()))
        highs.append(float(values.max()))
        tops.append(float(np.quantile(values, 0.999)))
        corners += [xy.min(axis=0), xy.max(axis=0)]
    low, high, top = min(lows), max(highs), max(tops)
    # Stresses at single nodes, in corners, would make everything else dark.
    clipped = top < 0.8 * high
    norm = matplotlib.colors.Normalize(low, max(top if clipped else high, low + 1e-300))
    corners = np.array([np.min(corners, axis=0), np.max(corners, axis=0)])
    margin = 0.02 * np.ptp(corners, axis=0).max()
    return Look(scale, norm, clipped, corners + [[-margin], [margin]])


def plot_deformed(solids, title, caption, look=None, names=("", ""), text=""):
    """The deformed meshes of one or two results in the plane, side by side, on one scale."""
    look = look or look_of(solids)
    if solids[0].dimension == 3:
        raise PlotError("bodies in space must be plotted separately, by harmos-plot")
    quantity = colour_values(solids[0])[1]

    # Panels of one size and with the same limits, in inches; the figure has their shape.
    count = len(solids)
    panel = 5.6
    tall = panel * float(np.clip(np.divide(*np.ptp(look.limits, axis=0)[::-1]), 0.2, 1.3))
    above = (1.2 if title else 0.8) + (0.2 if count > 1 else 0.0)
    sizes = 0.7 + count * (panel + 0.5) + 0.8, 0.9 + tall + above
    figure = plt.figure(figsize=sizes)

    def axes_at(x, y, width, height):
        return figure.add_axes([x / sizes[0], y / sizes[1], width / sizes[0], height / sizes[1]])

    states = set()
    for k, solid in enumerate(solids):
        axes = axes_at(0.7 + k * (panel + 0.5), 0.95, panel, tall)
        states |= draw_plane(axes, solid, look.scale, look.colours)
        axes.set_xlim(*look.limits[:, 0])
        axes.set_ylim(*look.limits[:, 1])
        axes.ticklabel_format(scilimits=(-2, 4))  # there is room for some digits only
        if names[k]:
            axes.set_title(names[k])

    bar_axes = axes_at(sizes[0] - 1.15, 0.95 + 0.15 * tall, 0.12, 0.7 * tall)
    mappable = plt.cm.ScalarMappable(look.colours, DISPLACEMENT_MAP)
    bar = figure.colorbar(mappable, cax=bar_axes, extend="max" if look.clipped else "neither")
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8, length=2)
    bar.set_label(quantity, fontsize=9)
    handles = [
        Line2D([], [], color=colour, linewidth=2.2, label=f"contact {word}")
        for colour, word in ((CLOSED, "closed"), (OPEN, "open"))
        if colour in states
    ]
    words = f"displacements drawn {look.scale:g} times as large" if look.scale != 1.0 else "displacements as they are"
    handles.append(Line2D([], [], linestyle="none", label=f"{text} \u00b7 {words}" if text else words))
    figure.legend(
        handles=handles, loc="upper center", ncol=3, fontsize=9,
        bbox_to_anchor=(0.5, 1 - (0.4 if title else 0.1) / sizes[1]),
    )
    finish(figure, title, caption)
    return figure


@dataclass
class Polar:
    """Contact around a body, by the angle from the x axis."""

    body: int
    centre: np.ndarray
    radius: float
    angle: np.ndarray  # ascending, in [0, 2 pi)
    pressure: np.ndarray
    gap: np.ndarray
    closed: np.ndarray

    def arcs(self):
        """(begin, end, closed) of the runs of equal state; a node owns the half ways beside it.

        The last arc may end beyond 2 pi, where it meets the first.
        """
        following = np.roll(self.angle, -1)
        following[-1] += 2 * np.pi
        middle = (self.angle + following) / 2  # after each node
        change = np.flatnonzero(self.closed != np.roll(self.closed, -1))
        if len(change) == 0:
            return [(0.0, 2 * np.pi, bool(self.closed[0]))]
        ends = np.append(middle[change[1:]], middle[change[0]] + 2 * np.pi)
        states = self.closed[(change + 1) % len(self.angle)]
        return [(float(a), float(b), bool(c)) for a, b, c in zip(middle[change], ends, states)]


def circle(points):
    """Centre and radius of the circle through points, by least squares."""
    origin = points.mean(axis=0)
    x = points - origin
    system = np.column_stack([2 * x, np.ones(len(x))])
    solution, _, rank, _ = np.linalg.lstsq(system, (x**2).sum(axis=1), rcond=None)
    if rank < 3:
        return None
    centre = solution[:2]
    return origin + centre, float(np.sqrt(solution[2] + centre @ centre))


def contact_polar(solid, body):
    """The contact pressure of a body by the angle around its contact nodes' centre."""
    if solid.dimension != 2:
        raise PlotError("contact around a body can be plotted in the plane only; use ParaView")
    chosen = np.flatnonzero((solid.body_of_point == body) & (solid.active > 0))
    known = np.unique(solid.body_of_point[solid.active > 0]).tolist()
    if len(chosen) == 0:
        raise PlotError(f"body {body} has no contact nodes; bodies in contact are {known}")
    # A node on the edge of subdomains comes once for each of them.
    _, first, copy = np.unique(solid.place[chosen], return_index=True, return_inverse=True)

    def most(values):
        result = np.full(len(first), -np.inf)
        np.maximum.at(result, copy.ravel(), values[chosen])
        return result

    points = solid.xy[chosen[first]]
    fitted = circle(points) if len(points) >= 3 else None
    if fitted is None:
        raise PlotError(f"the contact nodes of body {body} lie on a line, not around a centre")
    centre, radius = fitted
    x, y = (points - centre).T
    angle = np.mod(np.arctan2(y, x), 2 * np.pi)
    # Minus zero, rounded, would be at the far end.
    angle[angle > 2 * np.pi - 1e-9] = 0.0
    order = np.argsort(angle)
    return Polar(
        body=int(body),
        centre=centre,
        radius=radius,
        angle=angle[order],
        pressure=most(solid.pressure)[order],
        gap=most(solid.gap)[order],
        closed=most(solid.active)[order] == CANDIDATE_CLOSED,
    )


def plot_polar(polars, title, caption, names=("", "")):
    """Contact pressure against the angle, of one or two results on one scale."""
    count = len(polars)
    figure = plt.figure(figsize=(6.4 if count == 1 else 12.0, 6.6))
    top = max(float(p.pressure.max()) for p in polars) or 1.0
    for k, polar in enumerate(polars):
        width = 0.84 / count
        place = [0.08 + k * width, 0.12, 0.94 * width, 0.66]
        axes = figure.add_axes(place, projection="polar")
        angle = np.append(polar.angle, polar.angle[0] + 2 * np.pi)
        pressure = np.append(polar.pressure, polar.pressure[0])
        axes.fill(angle, pressure, color=PRESSURE, alpha=0.18, linewidth=0)
        marker = "." if len(angle) <= 200 else None
        axes.plot(angle, pressure, color=PRESSURE, linewidth=1.6, marker=marker, markersize=4)
        for begin, end, closed in polar.arcs():
            axes.bar(
                begin, 0.06 * top, width=end - begin, bottom=1.08 * top, align="edge",
                color=CLOSED if closed else OPEN, linewidth=0,
            )
        axes.set_ylim(0, 1.14 * top)
        axes.set_yticks([t for t in axes.get_yticks() if t <= 1.02 * top])
        axes.set_rlabel_position(112.5)
        axes.tick_params(labelsize=8)
        axes.grid(color="#DDDDDD", linewidth=0.6)
        axes.spines["polar"].set_color(FAINT)
        share = sum(end - begin for begin, end, closed in polar.arcs() if closed) / (2 * np.pi)
        words = f"body {polar.body}, {100 * share:.3g} % closed"
        axes.set_title(f"{names[k]}: {words}" if names[k] else words, pad=16)
    handles = [
        Line2D([], [], color=PRESSURE, linewidth=1.6, label="contact pressure"),
        Line2D([], [], color=CLOSED, linewidth=5, label="contact closed"),
        Line2D([], [], color=OPEN, linewidth=5, label="contact open"),
    ]
    figure.legend(
        handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.95), ncol=3, fontsize=9
    )
    finish(figure, title, caption)
    return figure
