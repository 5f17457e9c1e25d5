# SPDX-License-Identifier: BSD-3-Clause
"""parts.png: the bodies' named boundary parts, of parts.vtkhdf, which --parts of an application writes.

A row a body, since bodies hide what they have at each other; in space each from two sides, so that every face shows.
"""

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import matplotlib.pyplot as plt
import numpy as np
from command_line import PlotError
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize, to_rgb
from matplotlib.patches import Patch
from plot_subdomains import COLOURS
from plot_style import INK, STYLE, finish, output_of, save
from run_results import VTK_PIECES, places, read_with

BARE = "#E8E8E8"  # what no part has
LINES = {3: ((0, 1),), 21: ((0, 2), (2, 1))}  # pieces of sides in the plane
POINT = 1
NODES = {POINT: 1, 3: 2, 21: 3, **{kind: entry[1] for kind, entry in VTK_PIECES.items() if entry[0] == 2}}
MOST_ROWS = 6  # more bodies are drawn together
MOST_NAMES = 12  # of a row
PANEL = 3.3  # inches
MAX_MESH = 20_000  # pieces; their edges would cover the colours beyond this


@dataclass
class Parts:
    """Sides of the bodies, as flat pieces."""

    xyz: np.ndarray  # (points, 3); copies of a node are one
    names: list  # of parts, "body: part"
    pieces: np.ndarray  # (pieces, 4) in space, (pieces, 2) in the plane
    part: np.ndarray  # of each piece; -1 none
    body: np.ndarray
    side: np.ndarray  # the same number for all pieces of a side
    points: np.ndarray  # of parts that have nodes alone, where no part has sides
    part_of_point: np.ndarray
    body_of_point: np.ndarray

    @property
    def dimension(self):
        return 3 if self.pieces.shape[1] == 4 else 2

    def of(self, body):
        """Where a body's pieces and points are; those of all where body is None."""
        if body is None:
            return np.full(len(self.pieces), True), np.full(len(self.points), True)
        return self.body == body, self.body_of_point == body


def numbered_names(source):
    """Names of the parts in the order of their numbers, and of each side the number of the first that it is on."""
    names = [name for name in source.root["CellData"] if name not in ("body", "part")]
    number = {name: source.column(f"CellData/{name}", source.n_cells).max() for name in names}
    return sorted(names, key=number.get), source.column("CellData/part", source.n_cells) - 1


def parse_parts(source):
    types = source.types(NODES, "sides of cells")
    body = source.column("CellData/body", source.n_cells)
    xyz = source.dataset("Points", source.n_points).astype(float)
    corners = source.corners(NODES, types)
    body_of_point = np.zeros(source.n_points, dtype=np.int64)
    for chosen, nodes in corners.values():
        body_of_point[nodes] = body[chosen, None]
    place = places(xyz, body_of_point)
    merged = np.empty((place.max() + 1, 3))
    merged[place] = xyz
    names, part = numbered_names(source)
    pieces, of_piece, points, of_point = [], [], [], []
    for kind, (chosen, nodes) in corners.items():
        nodes = place[nodes]
        if kind == POINT:
            points.append(nodes[:, 0])
            of_point.append(chosen)
            continue
        cut = np.array(LINES[kind]) if kind in LINES else np.array(VTK_PIECES[kind][2][0][1])
        pieces.append(nodes[:, cut].reshape(-1, cut.shape[1]))
        of_piece.append(np.repeat(chosen, len(cut)))
    if len({piece.shape[1] for piece in pieces}) != 1:
        source.fail("sides of the plane and of space in one file", "use ParaView for it")
    none = np.empty(0, dtype=np.int64)
    of_piece, of_point, points = (np.concatenate([none, *rows]) for rows in (of_piece, of_point, points))
    pieces = np.concatenate(pieces)
    # A geometry without groups has one for each of its curves and corners.
    kept = ~np.isin(points, pieces[part[of_piece] >= 0])
    of_point, points = of_point[kept], points[kept]
    return Parts(
        xyz=merged, names=names, pieces=pieces, part=part[of_piece], body=body[of_piece],
        side=of_piece, points=points, part_of_point=part[of_point],
        body_of_point=body[of_point],
    )


def colours_of(numbers):
    """By part: those that are drawn beside each other differ as long as there are colours."""
    return {number: COLOURS[k % len(COLOURS)] for k, number in enumerate(numbers)}


def draw_plane(axes, parts, pieces, points, colour):
    for number in (-1, *colour):
        segments = parts.xyz[parts.pieces[pieces & (parts.part == number)]][:, :, :2]
        own = colour.get(number, INK)
        axes.add_collection(LineCollection(segments, colors=own, linewidths=4.0 if number >= 0 else 0.8,
                                           capstyle="butt", zorder=1 if number >= 0 else 2))
        at = parts.xyz[parts.points[points & (parts.part_of_point == number)]]
        axes.plot(at[:, 0], at[:, 1], linestyle="none", marker="o", color=own, zorder=3)
    axes.set_aspect("equal", adjustable="datalim")
    axes.autoscale_view()
    axes.margins(0.05)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_space(axes, parts, pieces, points, colour, right, up):
    import vtk_scene
    from plot_solid import limits, show, window_about
    from solid_parts import edges

    back = np.cross(right, up)
    actors = []
    for number in (-1, *colour):
        chosen = pieces & (parts.part == number)
        if chosen.any():
            plain = ListedColormap([to_rgb(colour.get(number, BARE))])
            actors.append(vtk_scene.surface(
                parts.xyz, parts.pieces[chosen], np.zeros(len(parts.xyz)), plain, Normalize(-1, 1)))
    body = SimpleNamespace(xyz=parts.xyz, cells=parts.pieces[pieces], face_of_cell=parts.side[pieces])
    drawn = edges(body, parts.xyz, back)
    dot = axes.figure.dpi / 72
    if len(body.cells) <= MAX_MESH:
        actors.append(vtk_scene.lines(parts.xyz, drawn.mesh, to_rgb("#777777"), 0.2 * dot))
    actors.append(vtk_scene.lines(parts.xyz, drawn.sharp, to_rgb(INK), 0.9 * dot))
    used = parts.xyz[np.unique(body.cells)]
    axes.set_axis_off()
    size = axes.get_window_extent().size
    flat = np.column_stack([right, up])
    show(axes, actors, right, up, window_about(None, limits(used @ flat), size), limits(used))
    for number, own in colour.items():
        at = parts.xyz[parts.points[points & (parts.part_of_point == number)]] @ flat
        axes.plot(at[:, 0], at[:, 1], linestyle="none", marker="o", color=own, markeredgecolor=INK, zorder=3)


def views():
    """Right and up of the picture from before and above, and of the one from behind and below."""
    from plot_solid import viewer

    right, up = viewer()
    behind = np.array([-right[0], -right[1], right[2]])
    back = -np.cross(right, up)
    return (right, up), (behind, np.cross(back, behind))


def plain(name):
    """As it is: matplotlib takes dollars for formulas, and leaves out what begins with an underscore."""
    return ("\u200a" if name.startswith("_") else "") + name.replace("$", r"\$")


def name_in(parts, number):
    return plain(parts.names[number].partition(": ")[2])


def plot_parts(parts, title):
    bodies = np.unique(np.concatenate([parts.body, parts.body_of_point])).tolist()
    rows = bodies if len(bodies) <= MOST_ROWS else [None]
    columns = 2 if parts.dimension == 3 else 1
    wide, names = PANEL * 2 / columns, 2.3
    above = 0.5 if title else 0.15
    sizes = 0.6 + 2 * PANEL + names, 0.6 + PANEL * 0.8 * len(rows) + above
    figure = plt.figure(figsize=sizes)
    for k, body in enumerate(rows):
        pieces, points = parts.of(body)
        numbers = np.unique(np.concatenate([parts.part[pieces], parts.part_of_point[points]]))
        colour = colours_of(numbers[numbers >= 0].tolist())
        top = 1 - (above + PANEL * 0.8 * k) / sizes[1]
        tall = PANEL * 0.8 / sizes[1]
        for c in range(columns):
            axes = figure.add_axes([(0.5 + wide * c) / sizes[0], top - 0.92 * tall, 0.95 * wide / sizes[0], 0.88 * tall])
            if columns == 1:
                draw_plane(axes, parts, pieces, points, colour)
            else:
                draw_space(axes, parts, pieces, points, colour, *views()[c])
        handles = [Patch(facecolor=own, edgecolor=INK, linewidth=0.5, label=name_in(parts, number))
                   for number, own in list(colour.items())[:MOST_NAMES]]
        if len(colour) > MOST_NAMES:
            handles.append(Patch(facecolor="none", label=f"and {len(colour) - MOST_NAMES} others"))
        if (parts.part[pieces] < 0).any():
            handles.append(Patch(facecolor=BARE, edgecolor=INK, linewidth=0.5, label="(no part)"))
        of_body = [plain(name.partition(": ")[0]) for number, name in enumerate(parts.names) if number in colour]
        figure.legend(
            handles=handles, loc="upper left", bbox_to_anchor=((0.55 + 2 * PANEL) / sizes[0], top - 0.05 * tall),
            fontsize=9, title=of_body[0] if body is not None and of_body else None, alignment="left",
        )
    finish(figure, title, [f"{len(np.unique(parts.side)):,} sides on the boundary", f"{len(parts.names)} parts"])
    return figure


def run(options):
    path = Path(options.directory) / "parts.vtkhdf"
    if not path.is_file():
        raise PlotError(f"{path}: not found; write it with harmos DECK --parts --output DIR")
    with plt.rc_context(STYLE):
        save(plot_parts(read_with(path, parse_parts), options.title), output_of(options) / "parts.png", options.dpi)
