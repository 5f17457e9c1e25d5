#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""The packages of Harmos and what they link, drawn from their CMake files.

    draw_architecture.py [--output docs/images/architecture.svg] [--dpi 110]

An arrow points from a package to one that it links; those that follow from others are left out. In
small letters: libraries outside of Harmos. As SVG (names stay text, which
tests/regression/test_documents.py reads) or as PNG, by the ending of the output.
"""

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "apps" / "tools"))

from plot_style import BODY_COLOURS, FAINT, INK, STYLE, save  # noqa: E402
from run_results import PlotError  # noqa: E402

import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch  # noqa: E402

PURPOSES = {
    "core": "errors, parameters, logs, timers",
    "io": "files that are whole or not there: HDF5, VTK",
    "qp": "quadratic programs with bounds and equalities",
    "feti": "torn problems, dual operator, recovery, audit",
    "thyra": "FETI behind Thyra and Stratimikos",
    "fem": "meshes, elements, materials, assembly",
    "contact": "surfaces, gaps, mortar, constraint rows",
    "scene": "bodies and effects; decks; discretisation",
    "effects": "contact, ties, loads, supports",
    "sensitivity": "derivatives by gaps and shapes",
    "rol": "best designs by Trilinos' ROL",
    "run": "stages, judgement, checkpoints, results",
    "plan": "ranks, memory, seconds before a run",
}
APPS = "apps"


def without_comments(text):
    return re.sub(r"#.*", "", text)


def packages(root=ROOT):
    """Of each package: the packages and the outside libraries that it links."""
    found = {}
    for file in sorted((root / "packages").glob("*/CMakeLists.txt")):
        text = without_comments(file.read_text(encoding="utf-8"))
        found[file.parent.name] = (
            set(re.findall(r"\bHarmos::(\w+)", text)),
            set(re.findall(r"\bharmos_dep::(\w+)", text)),
        )
    return found


def applications(root=ROOT):
    """Names of the applications, and the packages that they link."""
    files = sorted((root / "apps").glob("*/CMakeLists.txt"))
    text = "\n".join(without_comments(file.read_text(encoding="utf-8")) for file in files)
    return (
        [name for file in files if (name := file.parent.name) not in ("common", "tools")],
        set(re.findall(r"\bHarmos::(\w+)", text)),
    )


def links(root=ROOT):
    """All links as they stand in CMake, those of the applications too."""
    result = {name: set(seen) for name, (seen, _) in packages(root).items()}
    result[APPS] = applications(root)[1]
    return result


def reached(graph, name):
    """Everything that can be reached from a package."""
    result = set()
    for other in graph[name]:
        result |= {other} | reached(graph, other)
    return result


def arrows(graph):
    """The links that do not follow from others."""
    return {
        (name, other)
        for name, seen in graph.items()
        for other in seen
        if not any(other in reached(graph, third) for third in seen)
    }


def levels(graph):
    """Packages by the length of the longest way down."""
    def depth(name):
        return max((depth(other) + 1 for other in graph[name]), default=0)

    rows = {}
    for name in sorted(graph):
        rows.setdefault(depth(name), []).append(name)
    return [rows[level] for level in sorted(rows)]


def outlet(place, target, width, height, gap):
    """Where an arrow leaves a box: below; at its side, where it has to pass another row of boxes."""
    (x, y), (x1, y1) = place, target
    if y - y1 > 1.5 * (height + gap) and x != x1:
        return x + 0.5 * width * (1 if x1 > x else -1), y
    return x, y - 0.5 * height


def draw(root=ROOT):
    known, (programs, _), graph = packages(root), applications(root), links(root)
    missing = set(known) - set(PURPOSES)
    if missing:
        raise PlotError(f"say in PURPOSES of {Path(__file__).name} what {sorted(missing)} is for")
    width, height, gap, between = 3.5, 0.86, 0.42, 0.5
    rows = levels(graph)
    total = max(map(len, rows)) * (width + between)
    plt.rcParams.update(STYLE)
    # A fixed salt: the same tree gives the same file.
    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "harmos"})
    figure = plt.figure(figsize=(total, len(rows) * (height + gap) + 0.1))
    axes = figure.add_axes([0.01, 0.01, 0.98, 0.98])
    axes.set_axis_off()
    places = {}
    for level, row in enumerate(rows):
        for k, name in enumerate(row):
            x = total * (k + 0.5) / len(row)
            y = level * (height + gap) + 0.5 * height
            places[name] = (x, y)
            colour = FAINT if name == APPS else BODY_COLOURS[0]
            box = FancyBboxPatch((x - 0.5 * width, y - 0.5 * height), width, height,
                                 boxstyle="round,pad=0,rounding_size=0.1", facecolor="white",
                                 edgecolor=colour, linewidth=1.4, zorder=2)
            box.set_gid(f"package-{name}")
            axes.add_patch(box)
            if name == APPS:
                head, body, foot = APPS, ", ".join(programs), ""
            else:
                head, body, foot = name, PURPOSES[name], ", ".join(sorted(known[name][1]))
            axes.text(x, y + 0.25, head, ha="center", va="center", fontsize=12, color=colour,
                      fontweight="bold", zorder=3)
            middle = -0.02 if foot else -0.1
            axes.text(x, y + middle, body, ha="center", va="center", fontsize=8.5, color=INK,
                      zorder=3)
            axes.text(x, y - 0.27, foot, ha="center", va="center", fontsize=7.5, color=FAINT,
                      zorder=3)
    for name, other in sorted(arrows(graph)):
        begin, (x1, y1) = outlet(places[name], places[other], width, height, gap), places[other]
        arrow = FancyArrowPatch(begin, (x1, y1 + 0.5 * height),
                                arrowstyle="-|>", mutation_scale=11, color=INK, linewidth=1.0,
                                shrinkA=0, shrinkB=1, zorder=1)
        arrow.set_gid(f"link-{name}-{other}")
        axes.add_patch(arrow)
    axes.set_xlim(-0.05, total + 0.05)
    axes.set_ylim(-0.05, len(rows) * (height + gap) - gap + 0.05)
    return figure


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Draw the packages of Harmos.")
    parser.add_argument("--output", type=Path, default=ROOT / "docs/images/architecture.svg")
    parser.add_argument("--dpi", type=int, default=110)
    options = parser.parse_args(arguments)
    try:
        save(draw(), options.output, options.dpi)
    except PlotError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
