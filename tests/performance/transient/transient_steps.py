# SPDX-License-Identifier: BSD-3-Clause
"""What a step of bodies in motion costs beside a cold static solve of the same scene.

    transient_steps.py [--scenes plane,space] [--lengths 1,10] [--steps 200] [--size 1.0] [--output JSON]

A block falls on a floor and stands on it, one side of it held: in the plane 225 792 dofs in 256 parts, in space 139 968 in
64. Lengths of steps are in times that the slowest wave of a rod takes through a cell. Seconds are those of assembly,
set-up and solves of a run, without files, of two ranks; runs are made in turns. --size is the share of cells a side.
"""

import argparse
import csv
import json
import statistics
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parents[1] / "support"), str(HERE.parents[1] / "verification/finite")]

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402
from finite_scenes import deck  # noqa: E402

# Dimension, parts and cells of a part a side.
SCENES = {"plane": (2, 16, 20), "space": (3, 4, 8)}
STAGES = ("assembly", "factorization", "dual_operator", "coarse", "solve", "recovery")


def scene(dimension, parts, cells, steps=0, length=1.0):
    """Of no steps: static."""
    sides = [parts] * dimension + [1] * (3 - dimension)
    weight = [0.05, -1.0, 0.0] if dimension == 2 else [0.05, 0.0, -1.0]
    tree = {
        "Model": {"Physics": "plane strain" if dimension == 2 else "solid"},
        "Materials": {"m": {"Young's modulus": 1.0, "Poisson's ratio": 0.3, "Density": 1.0}},
        "Bodies": {"block": {
            "Source": "block", "Size": [1.0, 1.0, 1.0], "Subdomains a side": sides,
            "Elements a side": [cells] * dimension + [1] * (3 - dimension), "Element": "Q1", "Materials": ["m"]}},
        "Solver": {"Tolerance": 1e-6}, "Output": {"Every": 1000000},
        "Effects": {
            "Obstacle": {"floor": {"Part": "block/bottom", "Direction": [0.0, float(dimension == 2), float(dimension == 3)]}},
            "Body force": {"weight": {"Body": "block", "Density": weight}},
            "Prescribed displacement": {"side": {"Part": "block/left", "Displacement": [0.0, 0.0, 0.0]}},
        },
    }
    if steps:
        tree["Steps"] = {
            "Number": steps, "End time": steps * length / (parts * cells), "Time integration": "Newmark",
            "Spectral radius": 0.8,
        }
        tree["Effects"]["Initial velocity"] = {"fall": {"Body": "block", "Velocity": [-0.1 * part for part in weight]}}
    return tree


def solved(tree):
    run = runs.run(deck(tree), np=2, program="harmos")
    if run.returncode != 0:
        raise harmos_measure.RunFailed(str(run))
    seconds = run.summary["seconds"]
    return run, sum(seconds.get(stage, 0.0) for stage in STAGES)


def measured(name, length, given):
    """An entry of the JSON."""
    dimension, parts, cells = SCENES[name]
    cells = max(2, round(given.size * cells))
    static, cold = [], []
    for _ in range(3):
        run, seconds = solved(scene(dimension, parts, cells))
        cold.append(seconds)
        static.append(run.summary["hessian_applications"])
    run, seconds = solved(scene(dimension, parts, cells, given.steps, length))
    with open(Path(run.directory) / "steps.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    products = [int(row["products"]) for row in rows]
    entry = {
        "scene": name,
        "dofs": run.summary["primal_dimension"],
        "parts": parts**dimension,
        "length": length,
        "steps": len(rows),
        "static_seconds": statistics.median(cold),
        "static_products": statistics.median(static),
        "step_seconds": seconds / len(rows),
        "products": sum(products) / len(products),
        "most_products": max(products),
        "damped": sum(float(row["damped"]) for row in rows),
    }
    entry["ratio"] = entry["step_seconds"] / entry["static_seconds"]
    return entry


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="plane,space")
    parser.add_argument("--lengths", default="1,10")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--size", type=float, default=1.0)
    parser.add_argument("--output")
    given = parser.parse_args()
    runs.TIMEOUT = 3600
    document = {"benchmark": "transient_steps", "harmos": harmos_measure.version(), "ranks": 2, "runs": []}
    for name in given.scenes.split(","):
        for length in map(float, given.lengths.split(",")):
            entry = measured(name, length, given)
            document["runs"].append(entry)
            print(json.dumps(entry), flush=True)
    if given.output:
        Path(given.output).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
