#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""Contact pressure of Hertz' problems beside theory.

    plot_hertz.py DIR [DIR2] [--output FILE] [--dpi 150]

reads finished runs of signorini with "Model/Problem" = "hertz cylinder" or "hertz ball" and draws a
panel a run: the pressure at each contact node, over the distance from the middle, and the half
ellipse p = p0 sqrt(1 - (r/a)^2) of the half-width a and peak pressure p0 that theory gives for the
load of the run.
Without --output the picture is DIR/pressure.png.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "apps" / "tools"))

from draw_composite import read_solid  # noqa: E402
from plot_style import CLOSED, FAINT, INK, OPEN, STYLE, finish, save  # noqa: E402
from run_results import PlotError, read_summary  # noqa: E402

import matplotlib.pyplot as plt  # noqa: E402

NEEDED = ("half_width_theory", "peak_pressure_theory", "half_width", "load")


def profile(directory):
    """Of the contact nodes: distance from the middle in half-widths, pressure in peak pressures."""
    solid, summary = read_solid(directory), read_summary(directory / "summary.json")
    results = summary.get("results", {})
    if any(name not in results for name in NEEDED):
        deck = "apps/signorini/decks/hertz_cylinder.xml"
        raise PlotError(f"{directory}: no Hertz problem; run {deck}")
    a, peak = results["half_width_theory"], results["peak_pressure_theory"]
    if not a > 0:
        raise PlotError(f"{directory}: the body does not touch the plate; raise Model/Approach")
    chosen = np.unique(solid.place[solid.active > 0], return_index=True)[1]
    chosen = np.flatnonzero(solid.active > 0)[chosen]
    axes = solid.xyz[chosen, : solid.dimension - 1]
    return np.linalg.norm(axes, axis=1) / a, solid.pressure[chosen] / peak, solid.dimension, summary


def draw(directories):
    figure, panels = plt.subplots(1, len(directories), squeeze=False, sharey=True,
                                  figsize=(0.6 + 4.6 * len(directories), 4.4))
    for panel, directory in zip(panels[0], directories):
        r, p, dimension, summary = profile(directory)
        s = np.linspace(0.0, 1.0, 400)
        panel.plot(s, np.sqrt(1.0 - s * s), color=INK, linewidth=1.2, label="Hertz")
        near = r <= 2.0
        for chosen, colour, label in (
            (near & (p > 0), CLOSED, "closed"),
            (near & ~(p > 0), OPEN, "open"),
        ):
            panel.plot(r[chosen], p[chosen], "o", markersize=4, color=colour, label=label)
        panel.set_title("cylinder" if dimension == 2 else "ball")
        panel.set_xlabel("distance from the middle / half-width")
        panel.set_xlim(0.0, 2.0)
        panel.set_ylim(-0.03, 1.12)
        panel.grid(color=FAINT, alpha=0.25, linewidth=0.6)
        panel.spines[["top", "right"]].set_visible(False)
        results = summary["results"]
        share = {name: results[name] / results[f"{name}_theory"] - 1
                 for name in ("half_width", "peak_pressure")}
        panel.text(0.97, 0.62, f"half-width {share['half_width']:+.2%}\n"
                   f"peak pressure {share['peak_pressure']:+.2%}",
                   transform=panel.transAxes, ha="right", fontsize=9, color=INK)
    panels[0][0].set_ylabel("contact pressure / peak pressure")
    panels[0][-1].legend(loc="upper right")
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    finish(figure, "", [f"primal dimension {summary['primal_dimension']:,}" for summary in
                        (read_summary(directory / "summary.json") for directory in directories)])
    return figure


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Hertz' problems beside theory.")
    parser.add_argument("directory", type=Path, nargs="+")
    parser.add_argument("--output", type=Path)
    parser.add_argument("--dpi", type=int, default=150)
    options = parser.parse_args(arguments)
    if len(options.directory) > 2:
        parser.error("one run or two")
    try:
        with plt.rc_context(STYLE):
            output = options.output or options.directory[0] / "pressure.png"
            save(draw(options.directory), output, options.dpi)
    except PlotError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
