#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""Brings docs/shape.md up to date: its runs, its tables and its pictures.

    shape_study.py DIR [--build BUILD]

makes the runs of the page on one rank, each in a directory of DIR; those that are there already are left alone. What
stands on the page between

    <!-- begin NAME: made by docs/tools/shape_study.py -->
    <!-- end NAME -->

is written anew from their summary.json and shape.csv, and so are the pictures that the page shows,
docs/images/shape_*.png. Everything else on the page stays as it is. The runs take a minute.
"""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "apps" / "tools"))

import numpy as np  # noqa: E402
import plot_shape  # noqa: E402
from plot_deformed import look_of, plot_deformed  # noqa: E402
from plot_style import STYLE, save  # noqa: E402
from run_results import read_result  # noqa: E402

import matplotlib.pyplot as plt  # noqa: E402

PAGE = ROOT / "docs" / "shape.md"
IMAGES = ROOT / "docs" / "images"
DECKS = ROOT / "apps" / "shape" / "decks"
MESHES = (4, 8, 16, 32)  # elements along a side of a subdomain
EXPONENTS = (4, 8, 16, 32)
TIGHT = {"Shape/Optimiser/Status Test/Gradient Tolerance": 1e-4, "Shape/Optimiser/Status Test/Step Tolerance": 1e-8}
COST, VOLUME, FUNCTIONS = "Shape/Cost/Quantity", "Shape/Constraints/Volume", "Shape/Design/Functions"
TOP = "Effects/Prescribed displacement/top/"
GIVEN = {TOP + "Part": "punch/top", TOP + "Components": "{y}", TOP + "Displacement": "{0, -0.01, 0}"}


def mesh(n):
    return {f"Bodies/{body}/Elements a side": f"{{{n}, {n}, 1}}" for body in ("punch", "ground")}


# By group: what its column is called, and its cases as (words, name of the run, what differs from punch.xml).
DESIGN = [
    ("peak pressure, by nodes", "punch", {}),
    ("peak pressure, splines on 6 pieces", "splines", {FUNCTIONS: "splines", "Shape/Design/Pieces": "{6, 1}"}),
    ("pressure spread, by nodes", "spread", {COST: "pressure spread"}),
    ("softest, volume 0.02", "softest", {COST: "softest", VOLUME: "{0.02}"}),
    ("stiffest, volume 0.02", "stiffest", {COST: "stiffest", VOLUME: "{0.02}"}),
]
BLOCKS = [
    ("bounds ±0.1, all nodes follow", "crowned_block", {}),
    ("bounds ±0.1, nodes down to 0.15 follow", "shallow", {"Shape/Design/Depth": 0.15}),
    ("bounds ±0.2, all nodes follow", "wide", {"Shape/Design/Lower": "{-0.2}", "Shape/Design/Upper": "{0.2}"}),
]


def runs_of():
    """By name: the deck, what differs from it, and the exit status."""
    result = {name: ("punch", sets) for _, name, sets in DESIGN}
    result |= {name: ("crowned_block", sets) for _, name, sets in BLOCKS}
    for n in MESHES:
        result[f"mesh{n}"] = ("punch", mesh(n) | TIGHT)
        result[f"cold{n}"] = ("punch", mesh(n) | {"Shape/Limits/Evaluations": 1})
    for exponent in EXPONENTS:
        result[f"exponent{exponent}"] = ("punch", {"Shape/Cost/Exponent": float(exponent)})
    result["cold_block"] = ("crowned_block", {"Shape/Limits/Evaluations": 1})
    result["given"] = ("punch", GIVEN | {VOLUME: "{0.005}"})
    result["given_freely"] = ("punch", GIVEN)
    return result


def summary_of(directory):
    return json.loads((directory / "summary.json").read_text(encoding="utf-8"))


def results_of(directory):
    return summary_of(directory)["results"]


def make_runs(directory, build):
    for name, (deck, sets) in runs_of().items():
        if (directory / name / "summary.json").exists():
            continue
        words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
        done = subprocess.run([build / "bin" / "shape", DECKS / f"{deck}.xml", *words, "--quiet", "--output",
                               directory / name], capture_output=True)
        print(f"{name}: status {done.returncode}", flush=True)


def peak(results, when=""):
    return results[f"peak_pressure{when}"] / results[f"mean_pressure{when}"]


def design_table(directory):
    lines = [
        "| Design and cost | Variables | Evaluations | Peak over mean pressure, before | After | Volume |",
        "|---|---|---|---|---|---|",
    ]
    for words, name, _ in DESIGN:
        r = results_of(directory / name)
        lines.append(
            f"| {words} | {r['design_variables']:.0f} | {r['evaluations']:.0f} | {peak(r, '_before'):.3f} | "
            f"{peak(r):.4f} | {r['volume']:.5f} |"
        )
    return lines


def profile_of(directory):
    """Gaps after by abscissa, without what they have in common: under a given force that changes nothing."""
    (surface,) = plot_shape.read_shape(directory / "shape.csv")
    order = np.argsort(surface.before[:, 0])
    gaps = surface.gaps[1][order]
    return surface.before[order, 0], gaps - gaps[0]


def mesh_table(directory):
    lines = [
        "| Elements | Unknowns | Evaluations | Peak over mean pressure, before | After | Gap at the edge | Change |",
        "|---|---|---|---|---|---|---|",
    ]
    profiles = [profile_of(directory / f"mesh{n}") for n in MESHES]
    for k, n in enumerate(MESHES):
        s, r = summary_of(directory / f"mesh{n}"), results_of(directory / f"mesh{n}")
        x, gaps = profiles[k]
        change = ""
        if k + 1 < len(MESHES):
            change = f"{np.abs(gaps - np.interp(x, *profiles[k + 1])).max():.1e}"
        lines.append(
            f"| {2 * n} | {s['primal_dimension']} | {r['evaluations']:.0f} | {peak(r, '_before'):.3f} | {peak(r):.5f} | "
            f"{gaps[-1]:.5f} | {change} |"
        )
    return lines


def exponent_table(directory):
    rows = [results_of(directory / f"exponent{p}") for p in EXPONENTS]
    return [
        "| Exponent | " + " | ".join(str(p) for p in EXPONENTS) + " |",
        "|---" * (len(EXPONENTS) + 1) + "|",
        "| evaluations | " + " | ".join(f"{r['evaluations']:.0f}" for r in rows) + " |",
        "| norm over mean pressure, before | "
        + " | ".join(f"{r['cost_before'] / r['mean_pressure_before']:.3f}" for r in rows) + " |",
        "| peak over mean pressure, after | " + " | ".join(f"{peak(r):.5f}" for r in rows) + " |",
    ]


def cost_table(directory):
    lines = [
        "| Run | Evaluations | F: first solve | F: later solve | F: gradient | Factorisations: first design | All |",
        "|---|---|---|---|---|---|---|",
    ]
    cases = [(f"punch, {2 * n} elements along the contact", f"mesh{n}", f"cold{n}") for n in MESHES]
    cases += [("punch, softest, volume 0.02", "softest", "cold8")]
    cases += [(f"block, {words}", name, "cold_block") for words, name, _ in BLOCKS]
    for words, name, cold in cases:
        s, r = summary_of(directory / name), results_of(directory / name)
        first = summary_of(directory / cold)
        products = first["results"]["products_of_solutions"]
        later = (r["products_of_solutions"] - products) / (r["solutions"] - 1)
        lines.append(
            f"| {words} | {r['evaluations']:.0f} | {products:.0f} | {later:.1f} | "
            f"{r['products_of_adjoints'] / r['adjoints']:.1f} | {first['local_factorizations']} | "
            f"{s['local_factorizations']} |"
        )
    return lines


def block_table(directory):
    lines = [
        "| Design | Evaluations | Peak over mean pressure, before | After | Bearing, before | After |", "|---|---|---|---|---|---|"
    ]
    for words, name, _ in BLOCKS:
        r = results_of(directory / name)
        (surface,) = plot_shape.read_shape(directory / name / "shape.csv")
        bearing = [f"{(surface.pressures[when] > 0).sum()} of {len(surface.areas)}" for when in (0, 1)]
        lines.append(
            f"| {words} | {r['evaluations']:.0f} | {peak(r, '_before'):.3f} | {peak(r):.3f} | " + " | ".join(bearing) + " |"
        )
    return lines


def given_lines(directory):
    free, kept = results_of(directory / "given_freely"), results_of(directory / "given")
    return [
        f"Without a volume the peak falls from {free['peak_pressure_before']:.3f} to {free['peak_pressure']:.1e}, and the mean "
        f"with it, in {free['evaluations']:.0f} evaluations; the run then ends",
        f"because its steps are too short. With `Volume` = 0.005 the peak is {peak(kept):.3f} times the mean after "
        f"{kept['evaluations']:.0f} evaluations.",
    ]


def draw(directory):
    with plt.rc_context({**STYLE, "text.usetex": False}):
        for name in ("punch", "crowned_block"):
            history = plot_shape.read_history(directory / name / "history.csv")
            surfaces = plot_shape.read_shape(directory / name / "shape.csv")
            save(plot_shape.plot_shape(history, surfaces, "", []), IMAGES / f"shape_{name}.png", 75)
        solids = [read_result(directory / "crowned_block" / f"{when}.vtkhdf") for when in ("before", "result")]
        figure = plot_deformed(solids, "", [], look_of(solids, 1.0), ("before", "after"))
        save(figure, IMAGES / "shape_crowned_block_deformed.png", 75)


def write_page(directory):
    text = PAGE.read_text(encoding="utf-8")
    blocks = {
        "designs": design_table(directory), "meshes": mesh_table(directory), "exponents": exponent_table(directory),
        "costs": cost_table(directory), "given": given_lines(directory), "blocks": block_table(directory),
    }
    for name, lines in blocks.items():
        begin = f"<!-- begin {name}: made by docs/tools/shape_study.py -->\n"
        end = f"<!-- end {name} -->"
        if begin not in text or end not in text:
            raise SystemExit(f"{PAGE}: no place for {name}")
        pattern = re.escape(begin) + ".*?" + re.escape(end)
        text = re.sub(pattern, lambda _: begin + "\n" + "\n".join(lines) + "\n\n" + end, text, flags=re.S)
    PAGE.write_text(text, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description="Runs, tables and pictures of docs/shape.md.")
    parser.add_argument("directory", metavar="DIR", type=Path, help="of the runs")
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="where Harmos was built (default: build)")
    options = parser.parse_args()
    options.directory.mkdir(parents=True, exist_ok=True)
    make_runs(options.directory, options.build)
    draw(options.directory)
    write_page(options.directory)


if __name__ == "__main__":
    main()
