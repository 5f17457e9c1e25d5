# SPDX-License-Identifier: BSD-3-Clause
"""rounds.png: the estimated error over the unknowns, round by round, and the meshes of some rounds.

Cells have the colour of their estimated error over the root mean square of all: where the mesh follows the error all are
near one. In the plane cells are drawn each; in space the surface, by the mean of the cells around each node.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from command_line import PlotError
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm, to_rgb
from plot_style import INK, STYLE, caption_of, finish, output_of, save
from run_results import VTK_PIECES, drawn_pieces, parse_solid, places, read_summary, read_with

CORNERS = {5: 3, 22: 3, 9: 4, 23: 4, 28: 4}  # of VTK's cells in the plane
MOST = 4  # meshes
NORM = LogNorm(0.1, 10.0)
COLOURS = plt.get_cmap("RdYlBu_r")
EDGES = 40_000  # cells of a panel whose edges are drawn; more would cover the colours


@dataclass
class Mesh:
    dimension: int
    polygons: list  # in the plane: the cells' corners
    errors: np.ndarray  # of cells over their root mean square, in the order of the polygons; in space of points
    solid: object = None  # in space


def relative(errors):
    square = np.mean(np.square(errors))
    return errors / np.sqrt(square) if square > 0 else np.ones_like(errors)


def parse_mesh(source):
    if "CellData/estimated_error" not in source:
        source.fail("the result has no estimated errors", "only runs with \"Adaptivity\" write them")
    errors = relative(source.column("CellData/estimated_error", source.n_cells).astype(float))
    xyz = source.dataset("Points", source.n_points).astype(float)
    types = source.types(VTK_PIECES, f"the types {sorted(VTK_PIECES)}")
    volumes = source.corners({kind: entry[1] for kind, entry in VTK_PIECES.items()}, types)
    if VTK_PIECES[int(types[0])][0] == 2:
        polygons, values = [], []
        for kind, (chosen, nodes) in volumes.items():
            polygons += list(xyz[nodes[:, : CORNERS[kind]], :2])
            values.append(errors[chosen])
        return Mesh(2, polygons, np.concatenate(values))
    sums, counts = np.zeros(source.n_points), np.zeros(source.n_points)
    for chosen, nodes in volumes.values():
        np.add.at(sums, nodes, errors[chosen, None])
        np.add.at(counts, nodes, 1.0)
    # Copies of a node in several subdomains have one colour.
    place = places(xyz, np.zeros(len(xyz), dtype=np.int64))
    mean = np.bincount(place, sums) / np.maximum(np.bincount(place, counts), 1.0)
    return Mesh(3, [], mean[place], parse_solid(source))


def draw_plane(axes, mesh):
    axes.add_collection(PolyCollection(
        mesh.polygons, facecolors=COLOURS(NORM(mesh.errors)), edgecolors=INK if len(mesh.polygons) < EDGES else "none",
        linewidths=0.2, rasterized=True))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_space(axes, mesh):
    import vtk_scene
    from plot_solid import limits, show, viewer, window_about
    from solid_parts import edges

    solid = mesh.solid
    right, up = viewer()
    actors = [vtk_scene.surface(solid.xyz, solid.cells, mesh.errors, COLOURS, NORM)]
    drawn = edges(solid, solid.xyz, np.cross(right, up))
    dot = axes.figure.dpi / 72
    if len(solid.cells) < EDGES:
        actors.append(vtk_scene.lines(solid.xyz, drawn.mesh, to_rgb("#555555"), 0.2 * dot))
    actors.append(vtk_scene.lines(solid.xyz, drawn.sharp, to_rgb(INK), 0.7 * dot))
    used = np.unique(solid.cells)
    flat = solid.xyz[used] @ np.column_stack([right, up])
    axes.set_axis_off()
    show(axes, actors, right, up, window_about(None, limits(flat), axes.get_window_extent().size), limits(solid.xyz[used]))


def read_rounds(path):
    try:
        with open(path, newline="", encoding="utf-8") as file:
            return [{key: float(value) for key, value in row.items() if value} for row in csv.DictReader(file)]
    except OSError as error:
        raise PlotError(f"{path}: cannot be read ({error.strerror}); only runs with \"Adaptivity\" write it") from error


def draw_errors(axes, rounds):
    dofs = [row["dofs"] for row in rounds]
    axes.loglog(dofs, [row["estimated_error"] for row in rounds], "o-", color="#0072B2", markersize=4, label="energy norm")
    if any("quantity_error" in row for row in rounds):
        axes.loglog(dofs, [row.get("quantity_error", np.nan) for row in rounds], "s-", color="#D55E00", markersize=4,
                    label="quantity")
        axes.legend(frameon=False, fontsize=8)
    axes.set_xlabel("unknowns")
    axes.set_ylabel("estimated error, relative")
    axes.grid(color="#E4E4E4", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def plot_rounds(directory, rounds, title, caption):
    count = len(rounds)
    chosen = sorted({round(k) for k in np.linspace(1, count, min(MOST, count))})
    figure = plt.figure(figsize=(3.3 * max(2, len(chosen)), 6.4))
    grid = figure.add_gridspec(2, len(chosen), height_ratios=(1.0, 1.35), left=0.09, right=0.9, bottom=0.06, top=0.9, hspace=0.4)
    draw_errors(figure.add_subplot(grid[0, :]), rounds)
    for column, k in enumerate(chosen):
        place = directory if k == count else directory / f"round_{k}"
        mesh = read_with(place / "result.vtkhdf", parse_mesh)
        axes = figure.add_subplot(grid[1, column])
        axes.set_title(f"round {k}: {rounds[k - 1]['cells']:.0f} cells", fontsize=9)
        (draw_plane if mesh.dimension == 2 else draw_space)(axes, mesh)
    bar = figure.add_axes([0.92, 0.1, 0.012, 0.3])
    figure.colorbar(ScalarMappable(NORM, COLOURS), cax=bar, label="error of a cell over the mean", extend="both")
    finish(figure, title, caption)
    return figure


def run(options):
    directory = Path(options.directory)
    rounds = read_rounds(directory / "rounds.csv")
    caption = caption_of(read_summary(directory / "summary.json"))
    with plt.rc_context(STYLE):
        save(plot_rounds(directory, rounds, options.title, caption), output_of(options) / "rounds.png", options.dpi)
