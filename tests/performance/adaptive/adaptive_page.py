# SPDX-License-Identifier: BSD-3-Clause
"""The part of docs/accuracy.md on adapted meshes, and its picture.

    adaptive_page.py adaptivity.json [--page docs/accuracy.md] [--picture docs/images/adaptivity.png]
"""

import argparse
import json
import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[3] / "docs"
MARKS = re.compile(r"(<!-- begin adaptivity:[^\n]*-->\n).*?(<!-- end adaptivity -->)", re.DOTALL)
TITLES = {
    "corner": "Re-entrant corner", "cylinder": "Cylinder on a plane (Hertz)", "punch": "Flat punch", "fibre": "Fibre, plane",
    "fibre in space": "Fibre, space", "ball": "Ball on a plane (Hertz)", "lug": "Lug and pin",
}


def number(value):
    return f"{value:.2g}" if value < 100 else f"{value:.0f}"


def table(results):
    lines = ["| Scene | one size, seconds at 1 % | adapted | ratio | rate, one size | adapted | optimal | estimate / error |",
             "|---|---|---|---|---|---|---|---|"]
    for result in results:
        dimension = 3 if result["scene"] in ("ball", "lug", "fibre in space") else 2
        beyond = "*" if result["uniform_is_extrapolated"] else ""
        efficiency = result["efficiency"]
        lines.append("| " + " | ".join([
            TITLES[result["scene"]], number(result["seconds_uniform"]) + beyond,
            number(result["seconds_adapted"]) + ("*" if result["adapted_is_extrapolated"] else ""), number(result["ratio"]),
            f"{result['rate_uniform']:.2f}", f"{result['rate_adapted']:.2f}", f"{result['order'] / dimension:.2f}",
            f"{min(efficiency):.2f} to {max(efficiency):.2f}"]) + " |")
    return "\n".join(lines)


def draw(results, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 4, figsize=(13, 6), layout="constrained")
    for panel, result in zip(axes.flat, results):
        for adapted, label, style in ((False, "cells of one size", "o-"), (True, "adapted, all rounds", "s-")):
            points = sorted((p["seconds"], p["error"]) for p in result["points"] if p["adapted"] == adapted)
            panel.loglog(*zip(*points), style, markersize=4, linewidth=1.2, label=label,
                         color="#D55E00" if adapted else "#0072B2")
        panel.axhline(0.01, color="#8A8A8A", linewidth=0.7, linestyle=":")
        panel.set_title(TITLES[result["scene"]], fontsize=10)
        panel.set_xlabel("seconds")
        panel.set_ylabel("error, energy norm")
        panel.grid(color="#E4E4E4", linewidth=0.6)
    for panel in list(axes.flat)[len(results):]:
        panel.set_axis_off()
    handles, labels = axes.flat[0].get_legend_handles_labels()
    list(axes.flat)[-1].legend(handles, labels, loc="center", frameon=False)
    figure.savefig(path, dpi=80)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("json")
    parser.add_argument("--page", default=DOCS / "accuracy.md")
    parser.add_argument("--picture", default=DOCS / "images/adaptivity.png")
    options = parser.parse_args()
    study = json.loads(Path(options.json).read_text(encoding="utf-8"))
    page = Path(options.page)
    text = page.read_text(encoding="utf-8")
    words = f"*Quadratic elements, 2 ranks, {study['harmos'].replace('signorini (Harmos)', 'Harmos')}.*\n\n"
    assert MARKS.search(text), f"{page} has no marks"
    page.write_text(MARKS.sub(lambda m: m[1] + words + table(study["runs"]) + "\n" + m[2], text), encoding="utf-8")
    draw(study["runs"], options.picture)


if __name__ == "__main__":
    main()
