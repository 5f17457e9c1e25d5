#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""Brings docs/debonding.md up to date: its runs, its tables and its pictures.

    debonding_study.py DIR [--build BUILD]

makes the runs of the page on one rank, each in a directory of DIR; those that are there already are left alone. What
stands on the page between

    <!-- begin NAME: made by docs/tools/debonding_study.py -->
    <!-- end NAME -->

is written anew from their summary.json, and the pictures that the page shows, docs/images/debonding_*.png, from their
steps.csv and result files. Everything else on the page stays as it is. The runs take five minutes.
"""

import argparse
import json
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "apps" / "tools"))

import plot_curve  # noqa: E402
import plot_damage  # noqa: E402
import plot_frames  # noqa: E402
from plot_style import STYLE, save  # noqa: E402

import matplotlib.pyplot as plt  # noqa: E402

PAGE = ROOT / "docs" / "debonding.md"
IMAGES = ROOT / "docs" / "images"
DECK = ROOT / "apps" / "fiber_composite" / "decks" / "debonding.xml"
LOADS = ("stretch", "compression")
SAMPLE = {"Model/Columns": 4, "Model/Rows": 4, "Model/Strain": 0.06, "Steps/Number": 60}
RAMP = {"Model/History": "ramp"}
ONE = {"Model/History": "ramp", "Model/Strain": 1e-4, "Steps/Number": 1, "Solver/Tolerance": 1e-8}
ADHESION = "Model/Adhesion/"


def both(name, value):
    return {f"{ADHESION}{way} {name}": value for way in ("Normal", "Tangential")}


BASE = ("base", {})
# By group: what its column is called, and its cases as (words, name of the run, what differs from the sample).
GROUPS = {
    "strength": ("Interface", [
        ("strength 0.005", "strength0.005", both("strength", 0.005)),
        ("strength 0.01", *BASE),
        ("strength 0.02", "strength0.02", both("strength", 0.02)),
        ("strength 0.02, energy 4e-4", "tough", {
            **both("strength", 0.02), ADHESION + "Fracture energy": 4e-4, ADHESION + "Fracture energy II": 4e-4,
        }),
        ("brittle, strength 0.01", "brittle", {
            ADHESION + "Law": "brittle", ADHESION + "Fracture energy": -1, ADHESION + "Fracture energy II": -1,
        }),
    ]),
    "share": ("Share of fibres", [
        ("0.2", "share0.2", {"Model/Volume fraction": 0.2}),
        ("0.3", "share0.3", {"Model/Volume fraction": 0.3}),
        ("0.4", *BASE),
        ("0.5", "share0.5", {"Model/Volume fraction": 0.5}),
    ]),
    "arrangement": ("Arrangement", [
        ("regular", "regular", {"Model/Offset scatter": 0.0}),
        ("offset 0.05, seed 1", *BASE),
        ("offset 0.05, seed 2", "seed2", {"Model/Seed": 2}),
        ("offset 0.05, seed 3", "seed3", {"Model/Seed": 3}),
        ("offset 0.03, radius 0.2", "radius", {"Model/Radius scatter": 0.2, "Model/Offset scatter": 0.03}),
    ]),
}
LARGE = {"Model/Columns": 10, "Model/Rows": 10, "Output/Fields": "false"}
STEPS = (15, 30, 120)  # besides those of the sample
STIFFNESSES = (10, 100, 1000, 10000)
SHOWN = (0.02, 0.04, 0.06)  # strains of the tables
DAMAGE_AT = (4, 15, 45, 60)  # steps of the cycle


def runs_of():
    """(name, sets) of all runs, each once."""
    result = {"hundred": {**LARGE, "Steps/Number": 100}}
    result["hundred_contact"] = {**LARGE, **RAMP, "Model/Interface": "contact", "Steps/Number": 1}
    for load in LOADS:
        here = {**SAMPLE, "Model/Load": load}
        cycle = {"Steps/Histories/cycle/Values": "{0,0.3,0,1}"}
        result[f"cycle_{load}"] = {**here, **cycle}
        result[f"tie_{load}"] = {**here, **RAMP, "Model/Interface": "tie", "Model/Strain": 0.015, "Steps/Number": 2}
        result[f"contact_{load}"] = {**here, **RAMP, "Model/Interface": "contact", "Steps/Number": 2}
        for _, cases in GROUPS.values():
            for _, name, sets in cases:
                result[f"{name}_{load}"] = {**here, **RAMP, **sets}
        for steps in STEPS:
            result[f"steps{steps}_{load}"] = {**here, **RAMP, "Steps/Number": steps}
        for stiffness in STIFFNESSES:
            result[f"stiffness{stiffness}_{load}"] = {**here, **ONE, **both("stiffness", stiffness)}
        result[f"stiffness_tie_{load}"] = {**here, **ONE, "Model/Interface": "tie"}
    return result


def summary_of(directory):
    path = directory / "summary.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def make_runs(directory, build):
    for name, sets in runs_of().items():
        if (directory / name / "steps.csv").exists() or "steps" in summary_of(directory / name):
            continue
        words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
        began = time.monotonic()
        done = subprocess.run([build / "bin" / "fiber_composite", DECK, *words, "--quiet", "--output", directory / name])
        print(f"{name}: status {done.returncode}, {time.monotonic() - began:.1f} s", flush=True)


def stress_at(steps, strain):
    """Between two steps on a straight line; of a run that ended before, None."""
    before = {"strain": 0.0, "stress": 0.0}
    for step in steps:
        if abs(step["strain"]) >= strain * (1 - 1e-9):
            way = (strain - abs(before["strain"])) / (abs(step["strain"]) - abs(before["strain"]))
            return abs(before["stress"] + way * (step["stress"] - before["stress"]))
        before = step
    return None


def group_table(directory, group):
    title, cases = GROUPS[group]
    lines = [
        f"| {title} | Load | Initial modulus | Stress at " + " | ".join(f"{100 * s:g} %" for s in SHOWN)
        + f" | Secant, {100 * SHOWN[-1]:g} % | Dissipated | Released | Broken |",
        "|---" * (len(SHOWN) + 7) + "|",
    ]
    for load in LOADS:
        for words, name, _ in cases:
            steps = summary_of(directory / f"{name}_{load}")["steps"]
            last = steps[-1]
            stresses = [stress_at(steps, strain) for strain in SHOWN]
            cells = [
                words, load, f"{steps[0]['stress'] / steps[0]['strain']:.3f}",
                *["" if s is None else f"{s:.4f}" for s in stresses],
                "" if stresses[-1] is None else f"{stresses[-1] / SHOWN[-1]:.3f}",
                f"{last['dissipated']:.2e}", f"{last['released']:.1e}",
                f"{last['broken']} of {last['closed'] + last['open']}",
            ]
            lines.append("| " + " | ".join(cells) + " |")
    return lines


def stiffness_table(directory):
    def modulus(name):
        return summary_of(directory / name)["results"]["effective_modulus"]

    heads = [f"k = {stiffness}" for stiffness in STIFFNESSES]
    lines = ["| | " + " | ".join(heads) + " | bonded |", "|---" * (len(heads) + 2) + "|"]
    for load in LOADS:
        tied = modulus(f"stiffness_tie_{load}")
        moduli = [modulus(f"stiffness{stiffness}_{load}") for stiffness in STIFFNESSES]
        cells = [f"{m:.4f} (−{tied - m:.1e})" for m in moduli]
        lines.append(f"| modulus, {load} | " + " | ".join(cells) + f" | {tied:.4f} |")
    return lines


def energy_table(directory):
    lines = [
        "| Run | Work | Stored | Dissipated | Released | Work less their sum, over all work |", "|---|---|---|---|---|---|"
    ]
    names = {"cycle": "the cycle", "steps15": "on a ramp, 15 steps", "steps30": "30 steps", "base": "60 steps"}
    names |= {"steps120": "120 steps", "strength0.02": "strength 0.02, 60 steps", "brittle": "brittle, 60 steps"}
    for load in LOADS:
        for name, words in names.items():
            last = summary_of(directory / f"{name}_{load}")["steps"][-1]
            work = last["external_work"]
            left = work - last["energy"] - last["dissipated"] - last["released"]
            lines.append(
                f"| {load}, {words} | {work:.5f} | {last['energy']:.5f} | {last['dissipated']:.5f} | "
                f"{last['released']:.1e} | {left / work:.1e} |"
            )
    return lines


def cost_lines(directory):
    summary, contact = summary_of(directory / "hundred"), summary_of(directory / "hundred_contact")
    products = {}
    for step in summary["steps"]:
        products[step["step"]] = products.get(step["step"], 0) + step["products"]
    products = sorted(products.values())
    return [
        f"10 × 10 cells, {summary['primal_dimension']} unknowns and {summary['dual_dimension']} multipliers, with the "
        f"history of the deck in {len(products)} steps, on one rank",
        f"and without result files: {summary['seconds']['total']:.0f} s, {summary['peak_memory_mib']:.0f} MiB. A step "
        f"needs {products[len(products) // 2]} applications of F in the median, because most steps",
        f"unload and reload, and at most {products[-1]}. One solve of the sample without adhesion needs "
        f"{contact['hessian_applications']}.",
    ]


def draw_curves(directory, picture, cases):
    """cases    (label, name of the run)"""
    runs = [plot_curve.read_run(directory / name, label) for label, name in cases]
    figure = plot_curve.plot_curve(runs, ["stress"], "strain", "", [])
    save(figure, IMAGES / f"debonding_{picture}.png", 60)


def draw_damage(directory):
    frames = plot_frames.frames_of(directory / "cycle_stretch")
    results = plot_frames.Results(frames)
    look = plot_damage.look_of(results)
    table = plot_curve.read_steps(directory / "cycle_stretch" / "steps.csv")
    for number, step in enumerate(DAMAGE_AT, start=1):
        k = next(k for k, frame in enumerate(frames) if frame.number == step)
        strain = table["strain"][table["step"] == step][-1]
        figure = plot_damage.plot_damage(results[k], "", [], look, text=f"strain {100 * strain:.2g} %")
        save(figure, IMAGES / f"debonding_damage_{number}.png", 50)


def draw(directory):
    with plt.rc_context({**STYLE, "text.usetex": False}):
        for load in LOADS:
            cases = [("adhesive", f"cycle_{load}"), ("bonded", f"tie_{load}"), ("no adhesion", f"contact_{load}")]
            draw_curves(directory, load, cases)
            for group, (_, variants) in GROUPS.items():
                cases = [(words, f"{name}_{load}") for words, name, _ in variants]
                draw_curves(directory, f"{group}_{load}", cases)
        draw_damage(directory)


def write_page(directory):
    text = PAGE.read_text(encoding="utf-8")
    blocks = {group: group_table(directory, group) for group in GROUPS}
    blocks |= {"stiffness": stiffness_table(directory), "energy": energy_table(directory)}
    blocks["cost"] = cost_lines(directory)
    for name, lines in blocks.items():
        begin = f"<!-- begin {name}: made by docs/tools/debonding_study.py -->\n"
        end = f"<!-- end {name} -->"
        if begin not in text or end not in text:
            raise SystemExit(f"{PAGE}: no place for {name}")
        pattern = re.escape(begin) + ".*?" + re.escape(end)
        text = re.sub(pattern, lambda _: begin + "\n" + "\n".join(lines) + "\n\n" + end, text, flags=re.S)
    PAGE.write_text(text, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description="Runs, tables and pictures of docs/debonding.md.")
    parser.add_argument("directory", metavar="DIR", type=Path, help="of the runs")
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="where Harmos was built (default: build)")
    options = parser.parse_args()
    options.directory.mkdir(parents=True, exist_ok=True)
    make_runs(options.directory, options.build)
    draw(options.directory)
    write_page(options.directory)


if __name__ == "__main__":
    main()
