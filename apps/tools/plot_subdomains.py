# SPDX-License-Identifier: BSD-3-Clause
"""subdomains.png: how the bodies are cut, undeformed, each subdomain in another colour than those beside it.

In the plane their boundaries are drawn dark; in space they are moved away from each other, so that one sees
their shapes, and light lines are the sides of cells. Which subdomains lie beside each other is known from
the nodes of which they have copies.
"""

import dataclasses
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from command_line import PlotError
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize, to_rgb
from matplotlib.tri import Triangulation
from plot_frames import frames_of
from plot_solution import boundary_edges, thin_cells
from plot_style import INK, STYLE, caption_of, finish, output_of, save
from run_results import Field, drawn_pieces, numbered, places, read_result, read_summary
from solid_parts import edges

# Okabe's and Ito's, lighter, so that lines and shades can be told from them, and three more.
COLOURS = (
    "#F2B84B", "#7CC4EE", "#3DB891", "#F4EA72", "#4C8FC4", "#E5824A", "#DDA0C2", "#B4B4B4", "#A5D46A", "#9A86C8",
)
APART = 0.3  # subdomains in space are moved outwards by that share of their distance from the middle
MAX_PIECES = 250_000  # drawn in the plane; more take long and show no more at this size
MAX_MESH = 8_000  # pieces of faces; their edges would cover the colours beyond this
PANEL = 6.2  # inches


def neighbours_of(place, part, parts):
    """Pairs of parts with nodes in common, both ways round, and how many those are."""
    order = np.lexsort((part, place))
    place, part = place[order], part[order]
    # Copies of a node stand beside each other: each with those after it.
    pairs = []
    for shift in range(1, int(np.bincount(place).max())):
        same = (place[shift:] == place[:-shift]) & (part[shift:] != part[:-shift])
        pairs.append(np.column_stack([part[:-shift][same], part[shift:][same]]))
    pairs = np.concatenate([*pairs, np.empty((0, 2), dtype=np.int64)]).astype(np.int64)
    keys, counts = np.unique(
        np.concatenate([pairs @ [parts, 1], pairs @ [1, parts]]), return_counts=True
    )
    return keys // parts, keys % parts, counts


def colour_numbers(place, part, parts):
    """A number of a colour for each part: of those that least nodes in common with, the least used."""
    first, second, counts = neighbours_of(place, part, parts)
    begin = np.searchsorted(first, np.arange(parts + 1))
    colour = np.full(parts, -1)
    used = np.zeros(len(COLOURS), dtype=np.int64)
    for p in range(parts):
        beside, common = second[begin[p] : begin[p + 1]], counts[begin[p] : begin[p + 1]]
        done = colour[beside] >= 0
        shared = np.bincount(colour[beside[done]], common[done], len(COLOURS)).astype(np.int64)
        colour[p] = np.lexsort((used, shared))[0]
        used[colour[p]] += 1
    return colour


def coloured(xyz, part_of_point, parts):
    # Bodies that touch each other are neighbours too, where they have nodes in the same places.
    place = places(xyz, np.zeros(len(xyz), dtype=np.int64))
    return colour_numbers(place, part_of_point, parts)


def draw_plane(axes, result, colour):
    cells, _ = thin_cells(result, MAX_PIECES)
    edges = boundary_edges(result.cells)
    part = result.part_of_point[cells[:, 0]]
    both = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    proper = (np.diff(np.sort(both, axis=1), axis=1) > 0).all(axis=1)
    axes.tripcolor(
        Triangulation(*result.xy.T, both[proper]), facecolors=colour[np.tile(part, 2)[proper]],
        cmap=ListedColormap(COLOURS), norm=Normalize(-0.5, len(COLOURS) - 0.5), rasterized=True, zorder=1,
    )
    axes.add_collection(LineCollection(result.xy[edges], colors=INK, linewidths=0.7, zorder=2))
    axes.set_aspect("equal")
    axes.set_xlabel("$x$")
    axes.set_ylabel("$y$")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def moved_apart(solid, apart=APART):
    """The points of a solid with its subdomains moved away from each other."""
    part = solid.part_of_point
    count = np.maximum(np.bincount(part, minlength=solid.parts), 1)
    middles = np.column_stack([np.bincount(part, x, solid.parts) / count for x in solid.xyz.T])
    return solid.xyz + apart * (middles - middles.mean(axis=0))[part]


def surfaces(solid):
    """The solid with the outer faces of each subdomain, those between subdomains too."""
    # Subdomains share no points, so that each closes its surface by itself.
    own = np.arange(len(solid.xyz))
    cells, faces, parts = drawn_pieces(solid.volumes, solid.part_of_point, solid.xyz, own)
    return dataclasses.replace(solid, cells=cells, face_of_cell=faces, part_of_cell=parts)


def on_the_outside(solid, torn):
    """Bool for each piece of the subdomains' faces whether it is one of the body's."""
    both = np.sort(np.concatenate([torn.cells, solid.cells]), axis=1)
    number = numbered(*both.T)
    return np.isin(number[: len(torn.cells)], number[len(torn.cells) :])


def lines_of(solid, torn, points, back):
    """What is drawn dark, edges of the body and where it is cut; and light, the sides of cells."""
    outside = on_the_outside(solid, torn)
    body = dataclasses.replace(torn, cells=torn.cells[outside], face_of_cell=torn.face_of_cell[outside])
    inner, outer = edges(torn, points, back), edges(body, points, back)
    return outer.sharp, np.concatenate([inner.mesh, inner.sharp])


def draw_space(axes, solid, colour):
    import vtk_scene
    from plot_solid import corners_of, limits, show, viewer, window_about

    torn = surfaces(solid)
    points = moved_apart(torn)
    right, up = viewer()
    back = np.cross(right, up)
    norm = Normalize(-0.5, len(COLOURS) - 0.5)
    actors = [
        vtk_scene.surface(points, torn.cells, colour[torn.part_of_point], ListedColormap(COLOURS), norm)
    ]
    dot = axes.figure.dpi / 72
    dark, light = lines_of(solid, torn, points, back)
    if len(torn.cells) <= MAX_MESH:
        actors.append(vtk_scene.lines(points, light, to_rgb("#777777"), 0.2 * dot))
    actors.append(vtk_scene.lines(points, dark, to_rgb(INK), 0.9 * dot))
    box = limits(points[np.unique(torn.cells)])
    flat = points[np.unique(torn.cells)] @ np.column_stack([right, up])
    size = axes.get_window_extent().size
    axes.set_axis_off()
    show(axes, actors, right, up, window_about(None, limits(flat), size), box)


def plot_subdomains(result, title, caption):
    colour = coloured(
        np.pad(result.xy, ((0, 0), (0, 1))) if isinstance(result, Field) else result.xyz,
        result.part_of_point, result.parts,
    )
    space = not isinstance(result, Field) and result.dimension == 3
    extent = np.ptp(result.xy, axis=0)
    tall = PANEL * (0.75 if space else float(np.clip(extent[1] / extent[0], 0.2, 1.3)))
    above = 0.85 if title else 0.5
    left, below = (0.2, 0.5) if space else (0.7, 0.95)
    sizes = left + PANEL + 0.2, below + tall + above
    figure = plt.figure(figsize=sizes)
    axes = figure.add_axes([left / sizes[0], below / sizes[1], PANEL / sizes[0], tall / sizes[1]])
    (draw_space if space else draw_plane)(axes, result, colour)
    words = f"{result.parts} subdomain{'s' if result.parts > 1 else ''}"
    if space and result.parts > 1:
        words += ", moved apart"
    figure.text(0.5, 1 - (above - 0.15) / sizes[1], words, ha="center", va="bottom", fontsize=11)
    finish(figure, title, caption)
    return figure


def run(options):
    directory = Path(options.directory)
    if not directory.is_dir():
        raise PlotError(f"{directory}: no such directory; name the directory of a finished run")
    frames = frames_of(directory)
    if not frames:
        raise PlotError(
            f"{directory / 'result.vtkhdf'}: not there; let the run write its fields (\"Output/Fields\")"
        )
    caption = caption_of(read_summary(directory / "summary.json"))
    with plt.rc_context(STYLE):
        figure = plot_subdomains(read_result(frames[-1].path), options.title, caption)
        save(figure, output_of(options) / "subdomains.png", options.dpi)
