# SPDX-License-Identifier: BSD-3-Clause
"""solution.png of elastic bodies in space: the whole, a cut through the contact, the contact surface.

Surfaces are drawn by VTK off screen (vtk_scene.py) as images that fill axes of matplotlib, which draws what is
flat: scales, outlines of the cut, texts. All three views are parallel projections, so that axes have lengths.
Only the whole has its displacements exaggerated: in a cut, bodies that approach each other would overlap.
Colours end where 99 % of what is seen has less, if the peak is far above; colour bars tell the peak.
"""

import math
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize, to_rgb
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from plot_deformed import automatic_scale, colour_values
from plot_style import CLOSED, DISPLACEMENT_MAP, FAINT, INK, OPEN, finish
from solid_parts import (
    CUT_OFF, Plane, cutting_plane, edges, joined, node_areas, patch, peak_of, picture_axes, section, top_colour,
)

ELEVATION, AZIMUTH = 25.0, -60.0  # degrees, of the viewer
MAX_MESH = 8_000  # pieces of faces; their edges would cover the colours beyond this
PROBE = (490, 470)  # pixels of the picture that tells what is seen
CUT = "#CC79A7"
PRESSURE_MAP = plt.get_cmap("YlOrRd")
GAP_MAP = plt.get_cmap("Blues")
# Inches.
WHOLE, PANEL = (4.9, 4.7), (3.2, 1.95)


@dataclass
class Look:
    """What pictures of one run have in common, whatever step they show."""

    scale: float
    colours: Normalize
    box: np.ndarray  # (2, 3) of the deformed bodies
    plane: Plane = None  # without contact none, and no more of these
    body: int = 0  # whose contact surface is shown
    direction: np.ndarray = None  # from where
    cut_window: np.ndarray = None
    cut_colours: Normalize = None
    contact_window: np.ndarray = None
    pressures: Normalize = None
    gaps: Normalize = None


def span(low, high):
    return Normalize(low, high if high > low else low + (abs(low) or 1.0))


def limits(points):
    return np.array([points.min(axis=0), points.max(axis=0)])


def union(boxes):
    boxes = np.array([box for box in boxes if box is not None])
    return np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)]) if len(boxes) else None


def window_about(zone, whole, shape):
    """Limits ((left, right), (low, high)) about a zone, twice as large, not beyond the whole.

    zone, whole   (2, 2) least and greatest points; the zone may be None
    shape         width and height, whose ratio the window has
    """
    ratio = shape[0] / shape[1]
    size = np.maximum(np.ptp(whole, axis=0), 1e-12)
    most = 1.08 * max(size[0], size[1] * ratio) / 2
    middle, half = whole.mean(axis=0), most
    if zone is not None:
        extent = np.ptp(zone, axis=0)
        half = min(most, max(1.1 * extent[0], 1.1 * extent[1] * ratio, 0.12 * size.max()))
        reach = np.array([half, half / ratio])
        room = np.maximum(1.04 * size / 2 - reach, 0)
        middle = middle + np.clip(zone.mean(axis=0) - middle, -room, room)
    reach = np.array([half, half / ratio])
    return np.stack([middle - reach, middle + reach], axis=1)


def inside(points, window):
    return ((points >= window[:, 0]) & (points <= window[:, 1])).all(axis=1)


def shown_triangles(part, flat, window):
    return part.triangles[inside(flat[part.triangles].mean(axis=1), window)]


def corners_of(box):
    return np.array([[box[i, 0], box[j, 1], box[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def viewer():
    """Right and up of the picture of the whole; z is up."""
    e, a = np.radians([ELEVATION, AZIMUTH])
    back = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return right, np.cross(back, right)


def seen_top(solid, look):
    """top_colour() of what can be seen of the whole, by a picture of it.

    Its shades are the values' ranks, of which 256 are enough whatever the peak is.
    """
    import vtk_scene

    right, up = viewer()
    corners = corners_of(look.box)
    window = window_about(None, limits(corners @ np.column_stack([right, up])), WHOLE)
    view = vtk_scene.View(right, up, window)
    depth = corners @ view.back
    values = colour_values(solid)[0]
    known = np.unique(values[np.unique(solid.cells)])
    ranks = np.searchsorted(known, values)
    points = solid.xyz + look.scale * solid.displacement
    grey, norm = plt.get_cmap("gray"), Normalize(0, max(1, len(known) - 1))
    actor = vtk_scene.surface(points, solid.cells, ranks, grey, norm, lit=False)
    image = vtk_scene.picture([actor], view, PROBE, (depth.min(), depth.max()), (1.0, 0.0, 1.0))
    shades = image[(image == image[..., :1]).all(axis=2)][:, 0] / 255
    if not len(shades):
        return float(known[-1])
    shown = known[np.rint(shades * (len(known) - 1)).astype(int)]
    top, peak = top_colour(shown, np.ones(len(shown))), float(known[-1])
    return top if top < CUT_OFF * peak else peak


def look_of(solids, scale=None):
    """Looks at all results, which are gone through several times, and may be read anew each time."""
    scale = scale or automatic_scale(solids)
    lows, boxes, peaks = [], [], []
    for solid in map(joined, solids):
        drawn = np.unique(solid.cells)
        lows.append(colour_values(solid)[0][drawn].min())
        boxes.append(limits((solid.xyz + scale * solid.displacement)[drawn]))
        peaks.append(peak_of(solid))
    look = Look(scale, None, union(boxes))
    look.colours = span(min(lows), max(seen_top(solid, look) for solid in map(joined, solids)))
    found = [k for k, peak in enumerate(peaks) if peak]
    if not found:
        return look
    best = max(found, key=lambda k: peaks[k].pressure)
    peak = peaks[best]
    look.body, look.direction = peak.body, peak.normal
    for k, solid in enumerate(map(joined, solids)):
        if k == best:
            look.plane = cutting_plane(solid, peak)
            break

    axes = np.column_stack(picture_axes(look.plane.normal))
    across = np.column_stack(picture_axes(look.direction))
    zones, wholes, patches, closed, pressures = [], [], [], [], [0.0]
    for solid in map(joined, solids):
        part = section(solid, colour_values(solid)[0], look.plane)
        flat = part.deformed() @ axes
        zone = flat[part.outline[part.closed]].reshape(-1, 2)
        zones.append(limits(zone) if len(zone) else None)
        wholes.append(limits(flat) if len(flat) else None)
        piece = patch(solid, look.body, look.direction)
        patches.append(limits(piece.points @ across) if len(piece.points) else None)
        if len(piece.closed):
            closed.append(limits(piece.points[piece.closed].reshape(-1, 3) @ across))
            pressures.append(top_colour(piece.pressure, node_areas(piece.points, piece.closed)))
    if union(wholes) is None or union(patches) is None:
        look.plane = None
        return look
    look.cut_window = window_about(union(zones), union(wholes), PANEL)
    look.contact_window = window_about(union(closed), union(patches), PANEL)
    look.pressures = span(0.0, max(pressures))

    # Of the other quantities, the colours of what the windows show.
    tops, lows, gaps = [], [], [0.0]
    for solid in map(joined, solids):
        part = section(solid, colour_values(solid)[0], look.plane)
        cells = shown_triangles(part, part.deformed() @ axes, look.cut_window)[:, [0, 1, 2, 2]]
        if len(cells):
            tops.append(top_colour(part.values, node_areas(part.points, cells)))
            lows.append(part.values[cells].min())
        piece = patch(solid, look.body, look.direction)
        shown = inside((piece.points @ across)[piece.open].mean(axis=1), look.contact_window)
        if shown.any():
            gaps.append(top_colour(piece.gap, node_areas(piece.points, piece.open[shown])))
    look.gaps = span(0.0, max(gaps))
    look.cut_colours = span(min(lows, default=0.0), max(tops, default=1.0))
    return look


def show(axes, actors, right, up, window, box):
    """Fill the axes by an image; their coordinates are those along right and up."""
    import vtk_scene

    view = vtk_scene.View(right, up, window)
    depth = corners_of(box) @ view.back
    size = axes.get_window_extent().size
    image = vtk_scene.picture(actors, view, size, (depth.min(), depth.max()))
    axes.imshow(image, extent=window.ravel(), interpolation="antialiased", zorder=0, aspect="auto")
    axes.set_xlim(*window[0])
    axes.set_ylim(*window[1])


def draw_rulers(axes, box, flat):
    """Lengths along the three edges of the box about the bodies that lie before or beside them."""
    low, high = box
    ends = ((low, (1, 0, 0), (0, -1, 0)), ((high[0], low[1], low[2]), (0, 1, 0), (1, 0, 0)),
            (low, (0, 0, 1), (-1, 0, 0)))
    size = high - low
    for k, (corner, along, away) in enumerate(ends):
        start = np.asarray(corner, dtype=float)
        out = flat(np.array(away, dtype=float))
        out /= np.linalg.norm(out)
        line = flat(np.array([start, start + size[k] * np.array(along)]))
        axes.plot(*line.T, color=FAINT, linewidth=0.8, clip_on=False, zorder=1)
        steps = MaxNLocator(max(2, round(4 * size[k] / size.max())), steps=[1, 2, 5, 10])
        ticks = [t for t in steps.tick_values(low[k], high[k]) if low[k] <= t <= high[k]]
        # All with as many digits as the finest one wants.
        words = [f"{t:g}" for t in ticks]
        if not any("e" in word for word in words):
            digits = max((len(word.partition(".")[2]) for word in words), default=0)
            words = [f"{t:.{digits}f}" for t in ticks]
        arrow = {"arrowstyle": "-", "color": FAINT, "linewidth": 0.8, "shrinkA": 5, "shrinkB": 0}
        for tick, word in zip(ticks, words):
            axes.annotate(
                word, flat(start + (tick - low[k]) * np.array(along)), xytext=9 * out,
                textcoords="offset points", ha="right" if k == 2 else "center",
                va="center" if k == 2 else "top", fontsize=9, annotation_clip=False, arrowprops=arrow,
            )
        axes.annotate(
            f"${'xyz'[k]}$", line.mean(axis=0), xytext=(36 if k == 2 else 26) * out,
            textcoords="offset points", ha="center", va="center", fontsize=11, annotation_clip=False,
        )


def draw_whole(axes, solid, look, part):
    """The deformed bodies from outside, with their edges and the line of the cut."""
    import vtk_scene

    right, up = viewer()
    axes.set_axis_off()
    points = solid.xyz + look.scale * solid.displacement
    lines = edges(solid, points, np.cross(right, up))
    actors = [
        vtk_scene.surface(points, solid.cells, colour_values(solid)[0], DISPLACEMENT_MAP, look.colours)
    ]
    # Lines are as wide as those of matplotlib: in points.
    dot = axes.figure.dpi / 72
    if len(solid.cells) <= MAX_MESH:
        actors.append(vtk_scene.lines(points, lines.mesh, to_rgb(INK), 0.25 * dot))
    actors.append(vtk_scene.lines(points, lines.sharp, to_rgb(INK), 1.0 * dot))
    if part is not None:
        at = part.deformed(look.scale)
        actors.append(vtk_scene.lines(at, part.outline, to_rgb(CUT), 1.6 * dot, before=12.0))
    projection = np.column_stack([right, up])
    window = window_about(None, limits(corners_of(look.box) @ projection), WHOLE)
    show(axes, actors, right, up, window, look.box)
    draw_rulers(axes, look.box, lambda places: places @ projection)


def name_of(direction):
    k = int(np.abs(direction).argmax())
    if abs(abs(direction[k]) - 1) < 1e-6:
        return f"${'xyz'[k]}$"
    return "along ({:.2g}, {:.2g}, {:.2g})".format(*(direction + 0.0))


def frame_panel(axes, right, up):
    axes.set_xlabel(name_of(right), labelpad=2)
    axes.set_ylabel(name_of(up), labelpad=2)
    axes.tick_params(labelsize=9, length=2.5)
    axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    for side in axes.spines.values():
        side.set_linewidth(0.6)


def draw_cut(axes, look, part):
    """The cut face by itself, near the contact."""
    import vtk_scene

    right, up = picture_axes(look.plane.normal)
    points = part.deformed()
    flat = points @ np.column_stack([right, up])
    cells = shown_triangles(part, flat, look.cut_window)
    # Also what reaches in from outside of the window.
    actors = [
        vtk_scene.surface(
            points, part.triangles[:, [0, 1, 2, 2]], part.values, DISPLACEMENT_MAP,
            look.cut_colours, lit=False,
        )
    ]
    if len(part.points):
        show(axes, actors, right, up, look.cut_window, limits(points))
    for chosen, colour, width in (
        (~part.touching, INK, 0.9), (part.touching & ~part.closed, OPEN, 1.8), (part.closed, CLOSED, 1.8)
    ):
        segments = LineCollection(flat[part.outline[chosen]], colors=colour, linewidths=width, zorder=2)
        segments.set_capstyle("round")
        axes.add_collection(segments)
    axes.set_xlim(*look.cut_window[0])
    axes.set_ylim(*look.cut_window[1])
    frame_panel(axes, right, up)
    k = int(np.abs(look.plane.normal).argmax())
    where = ""
    if abs(look.plane.normal[k]) > 1 - 1e-6:
        # To a thousandth of the whole.
        digits = 3 - math.floor(math.log10(np.ptp(look.box, axis=0).max()))
        where = f" at ${'xyz'[k]}$ = {round(look.plane.origin[k], digits) + 0.0:g}"
    axes.set_title(f"cut{where}, true to scale", fontsize=10, pad=4)
    return float(part.values[cells].max(initial=-np.inf)) if len(cells) else None


def draw_contact(axes, solid, look):
    """Pressure where the surface is closed, the gap where it is open; the peaks of both."""
    import vtk_scene

    piece = patch(solid, look.body, look.direction)
    right, up = picture_axes(look.direction)
    flat = piece.points @ np.column_stack([right, up])
    actors = []
    for cells, values, colours, norm in (
        (piece.open, piece.gap, GAP_MAP, look.gaps),
        (piece.closed, piece.pressure, PRESSURE_MAP, look.pressures),
    ):
        if len(cells):
            actors.append(vtk_scene.surface(piece.points, cells, values, colours, norm, lit=False))
    if actors:
        show(axes, actors, right, up, look.contact_window, limits(piece.points))
    axes.add_collection(LineCollection(flat[piece.boundary], colors=INK, linewidths=1.2, zorder=2))
    axes.set_xlim(*look.contact_window[0])
    axes.set_ylim(*look.contact_window[1])
    frame_panel(axes, right, up)
    axes.set_title("contact surface", fontsize=10, pad=4)
    pressure = float(piece.pressure[piece.closed].max()) if len(piece.closed) else None
    gap = float(piece.gap[piece.open].max()) if len(piece.open) else None
    return pressure, gap


def colour_bar(figure, place, norm, colours, text, peak):
    """With the peak in its text; pointed where colours end before."""
    axes = figure.add_axes(place)
    beyond = peak is not None and peak > norm.vmax * (1 + 1e-9)
    bar = figure.colorbar(
        plt.cm.ScalarMappable(norm, colours), cax=axes, extend="max" if beyond else "neither",
        extendfrac=0.06,
    )
    bar.outline.set_visible(False)
    axes.tick_params(labelsize=9, length=2)
    bar.locator = MaxNLocator(5)
    bar.formatter.set_powerlimits((-3, 4))
    bar.update_ticks()
    axes.yaxis.get_offset_text().set(fontsize=8, ha="left")
    bar.set_label(text if peak is None else f"{text}\npeak {peak:.3g}", fontsize=9.5, labelpad=5)


def plot_solid(solid, title, caption, look=None, text=""):
    """A picture of one result; look is that of all results of a run, text is printed above."""
    look = look or look_of([solid])
    solid = joined(solid)
    values, quantity = colour_values(solid)
    contact = look.plane is not None
    wide = 0.75 + WHOLE[0] + 1.1 + (0.75 + PANEL[0] + 2.15 if contact else 0.0)
    lines = 1 + (not contact)
    tall = 0.75 + 0.14 * lines + WHOLE[1] + (1.0 if title else 0.68)
    figure = plt.figure(figsize=(wide, tall))
    below = 0.75 + 0.14 * lines

    def place(x, y, width, height):
        return [x / wide, (below + y) / tall, width / wide, height / tall]

    part = section(solid, values, look.plane) if contact else None
    draw_whole(figure.add_axes(place(0.75, 0, *WHOLE)), solid, look, part)
    peak = float(values[np.unique(solid.cells)].max())
    bar = place(0.95 + WHOLE[0], 0.7, 0.12, WHOLE[1] - 1.4)
    colour_bar(figure, bar, look.colours, DISPLACEMENT_MAP, quantity, peak)
    handles = []
    if contact:
        x, y = 0.75 + WHOLE[0] + 1.1 + 0.75, WHOLE[1] - PANEL[1] - 0.05
        peak = draw_cut(figure.add_axes(place(x, y, *PANEL)), look, part)
        bars = x + PANEL[0] + 0.12
        bar = place(bars, y, 0.12, PANEL[1])
        colour_bar(figure, bar, look.cut_colours, DISPLACEMENT_MAP, quantity, peak)
        pressure, gap = draw_contact(figure.add_axes(place(x, 0, *PANEL)), solid, look)
        if pressure is not None:
            bar = place(bars, 0, 0.12, PANEL[1])
            colour_bar(figure, bar, look.pressures, PRESSURE_MAP, "pressure", pressure)
        if gap is not None:
            bar = place(bars + 1.1, 0, 0.12, PANEL[1])
            colour_bar(figure, bar, look.gaps, GAP_MAP, "gap", gap)
        handles = [
            Line2D([], [], color=colour, linewidth=2.2, label=f"contact {word}")
            for colour, word, found in (
                (CLOSED, "closed", part.closed.any()),
                (OPEN, "open", (part.touching & ~part.closed).any()),
            )
            if found
        ]
        handles.append(Line2D([], [], color=CUT, linewidth=1.6, label="where it is cut"))
    words = f"displacements drawn {look.scale:g} times as large"
    handles.append(Line2D([], [], linestyle="none", label=f"{text} \u00b7 {words}" if text else words))
    figure.legend(
        handles=handles, loc="upper center", ncol=4, fontsize=10,
        bbox_to_anchor=(0.5, 1 - (0.4 if title else 0.08) / tall),
    )
    finish(figure, title, caption)
    return figure
