#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""Deformed meshes of one or two runs side by side, or the contact pressure around a body.

Purpose
-------
    draw_composite.py DIR [DIR2] [--output FILE.png] [--scale S]
    draw_composite.py DIR [DIR2] --polar BODY [--output FILE.png]

draws what plot_deformed.py describes, for runs of elastic bodies; two runs, stretch and compression
for instance, share the scale of the displacements and the colours.  Without --output the picture
is DIR/deformed.png, or DIR/polar.png.
"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "apps" / "tools"))

from plot_deformed import contact_polar, look_of, plot_deformed, plot_polar  # noqa: E402
from plot_style import STYLE, caption_of, save  # noqa: E402
from run_results import PlotError, Solid, read_result, read_summary  # noqa: E402

import matplotlib.pyplot as plt  # noqa: E402


def read_solid(directory):
    if not directory.is_dir():
        raise PlotError(f"{directory}: no such directory; name the directory of a finished run")
    path = directory / "result.vtkhdf"
    if not path.exists():
        raise PlotError(f"{path}: not there (output of fields was off); repeat the run with it")
    solid = read_result(path)
    if not isinstance(solid, Solid):
        raise PlotError(f"{path}: membranes, not elastic bodies; draw it by harmos-plot")
    return solid


def run(options):
    directories = [Path(d) for d in options.directory]
    solids = [read_solid(d) for d in directories]
    summaries = [read_summary(d / "summary.json") for d in directories]
    if len(solids) == 1:
        names, caption = ("",), caption_of(summaries[0])
    else:
        names = [d.resolve().name for d in directories]
        caption = [
            f"{name}: energy {summary['energy']:.10g}"
            for name, summary in zip(names, summaries)
            if "energy" in summary
        ]
    polar = options.polar is not None
    output = directories[0] / ("polar.png" if polar else "deformed.png")
    output = Path(options.output) if options.output else output
    with plt.rc_context(STYLE):
        if polar:
            polars = [contact_polar(s, options.polar) for s in solids]
            figure = plot_polar(polars, options.title, caption, names)
        else:
            figure = plot_deformed(solids, options.title, caption, look_of(solids, options.scale), names)
        save(figure, output, options.dpi)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Deformed meshes of one or two finished runs.")
    parser.add_argument("directory", metavar="DIR", nargs="+", help="one or two finished runs")
    parser.add_argument("--output", metavar="FILE.png", help="the picture (default: in DIR)")
    parser.add_argument("--scale", type=float, help="exaggeration of the displacements")
    parser.add_argument("--polar", type=int, metavar="BODY", help="contact pressure around a body")
    parser.add_argument("--dpi", type=float, default=150, help="dots an inch (default: 150)")
    parser.add_argument("--title", default="", help="heading of the picture")
    options = parser.parse_args(arguments)
    if len(options.directory) > 2:
        parser.error("more than two directories; name one or two")
    if options.scale is not None and not options.scale > 0:
        parser.error(f"--scale {options.scale:g} is not positive; leave it out or choose another")
    if not 10 <= options.dpi <= 1200:
        parser.error(f"--dpi {options.dpi:g} is out of range; choose 10 to 1200")
    try:
        run(options)
    except PlotError as error:
        print(f"draw_composite.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
