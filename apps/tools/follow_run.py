# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a run that is not finished, drawn anew as it goes on.

The run writes iterations.csv while it goes on and contact.csv every few seconds ("Output/Live
seconds" of the deck); convergence.png and contact.png follow them. Each picture replaces the one
before it, so that a viewer which looks at the file again shows the present one.
"""

import csv
import json
import math
import sys
import time

import numpy as np
from plot_style import CLOSED, FAINT, OPEN, PRESSURE, STYLE, finish, save
from command_line import PlotError
from run_results import read_iterations

import matplotlib.pyplot as plt

QUIET = 60  # seconds
CONTACT = ("x", "y", "z", "pressure", "closed")


def read_contact(path):
    """The columns of contact.csv as an array, a row a point; None if it is not there."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except FileNotFoundError:
        return None
    if not rows or tuple(rows[0]) != CONTACT:
        raise PlotError(f"{path}:1: the header must be {','.join(CONTACT)}")
    try:
        return np.array([[float(cell) for cell in row] for row in rows[1:]]).reshape(-1, 5)
    except ValueError as error:
        raise PlotError(f"{path}: {error}; check that this program wrote it") from error


def principal(points):
    """Coordinates along the principal axes of the points, the longest first, and the extents."""
    centred = points - points.mean(axis=0)
    _, _, axes = np.linalg.svd(centred, full_matrices=False)
    # Each axis points the way of its largest component, so that pictures do not flip.
    for axis in axes:
        axis *= math.copysign(1.0, axis[np.abs(axis).argmax()])
    coordinates = points @ axes.T
    return coordinates, np.ptp(coordinates, axis=0)


def plot_contact(contact, caption):
    """Pressure along a line of contact, or by colour on a surface seen along its normal."""
    coordinates, extents = principal(contact[:, :3])
    pressure, closed = contact[:, 3], contact[:, 4] > 0
    figure = plt.figure(figsize=(9.0, 5.6))
    axes = figure.add_axes([0.1, 0.15, 0.85, 0.72])
    # A surface rather than a line: wider than a hundredth of its length.
    if len(contact) > 2 and extents[1] > 0.01 * extents[0]:
        axes.scatter(
            *coordinates[~closed, :2].T, s=9, facecolor="none", edgecolor=OPEN, label="open"
        )
        shown = axes.scatter(*coordinates[closed, :2].T, s=16, c=pressure[closed], label="closed")
        figure.colorbar(shown, ax=axes, label="contact pressure")
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_ylabel("second principal axis")
    else:
        order = coordinates[:, 0].argsort()
        x = coordinates[order, 0]
        axes.fill_between(x, pressure[order], color=PRESSURE, alpha=0.2, linewidth=0)
        axes.plot(x, pressure[order], color=PRESSURE, linewidth=1.2)
        axes.plot(x, np.where(closed[order], pressure[order], np.nan), ".", color=CLOSED,
                  label="closed")
        axes.plot(x, np.where(closed[order], np.nan, 0.0), ".", color=OPEN, label="open")
        axes.set_ylabel("contact pressure")
    axes.set_xlabel("along the contact")
    axes.grid(color="#E4E4E4", linewidth=0.6)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("bottom", "left"):
        axes.spines[side].set_color(FAINT)
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncol=2)
    finish(figure, "", caption)
    return figure


def stamp(path):
    try:
        return path.stat().st_mtime_ns
    except FileNotFoundError:
        return None


def has_ended(summary):
    """Whether a summary is there that another session does not continue: see --restart."""
    try:
        reason = json.loads(summary.read_text(encoding="utf-8")).get("reason", "")
    except (OSError, ValueError):
        return False
    return not reason.startswith("interrupted")


def follow(directory, output, dpi, interval, plot_convergence):
    """Draw until the run has come to its end, by whatever number of sessions.

    plot_convergence    (table, summary, title, caption) -> figure
    """
    iterations, contact, end = (
        directory / name for name in ("iterations.csv", "contact.csv", "summary.json")
    )
    drawn = {iterations: None, contact: None}
    print(f"following {directory}; stop with Ctrl-C", flush=True)
    quiet = time.monotonic()
    while not has_ended(end):
        if time.monotonic() - quiet > QUIET:
            quiet = time.monotonic()
            print(f"nothing new in {directory} for {QUIET} s; waiting", file=sys.stderr, flush=True)
        for path in drawn:
            now = stamp(path)
            if now is None or now == drawn[path]:
                continue
            with plt.rc_context(STYLE):
                if path == iterations:
                    table = read_iterations(path, growing=True)
                    if table is None:
                        continue
                    last = int(table["hessian_applications"][-1])
                    caption = [f"running: {last} Hessian applications so far"]
                    figure = plot_convergence(table, {}, "", caption)
                    save(figure, output / "convergence.png", dpi)
                else:
                    points = read_contact(path)
                    if points is None or not len(points):
                        continue
                    closed = int((points[:, 4] > 0).sum())
                    caption = [f"running: {closed} of {len(points)} contact points are closed"]
                    save(plot_contact(points, caption), output / "contact.png", dpi)
            drawn[path] = now
            quiet = time.monotonic()
        time.sleep(interval)
