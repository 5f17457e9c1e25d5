# SPDX-License-Identifier: BSD-3-Clause
"""Error over seconds of meshes of one size and of meshes that follow the error.

    adaptive_curves.py [--scenes corner,cylinder,...] [--repetitions 3] [--order 2] [--coarser 1] [--output JSON]
        [--keep DIR]

For each scene the program study runs five meshes of one size and five targets of the adapted ones on two ranks; errors are
those in the energy norm against a far finer adapted mesh, seconds those of whole runs: of the adapted ones all rounds.
"""

import argparse
import json
import math
import shutil
import statistics
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / "support"), str(HERE.parents[1] / "verification/finite")]

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402
from adaptive_scenes import SCENES  # noqa: E402
from finite_scenes import deck, geometry  # noqa: E402
from harmos_decks import xml  # noqa: E402

ROUNDS = 40


def study_deck(application_deck, sizes, targets, finest, repetitions):
    values = [f"{size};0;0.05" for size in sizes] + [f"0;{ROUNDS};{target}" for target in targets]
    labels = [f"size {size:g}" for size in sizes] + [f"adapted to {target:g}" for target in targets]
    reference = {
        name: [f"Adaptivity/Rounds={ROUNDS}", f"Adaptivity/Target error={factor * finest!r}"]
        for name, factor in (("Set", 1.0), ("Coarser", 2.0), ("Coarsest", 4.0))
    }
    tree = {
        "Study": {"Application": "harmos", "Deck": str(application_deck), "Repetitions": repetitions, "Targets": ["1e-2"],
                  "Charts": False},
        "Reference": reference,
        "Axes": {"mesh": {"Parameters": ["Model/Mesh size", "Adaptivity/Rounds", "Adaptivity/Target error"],
                          "Values": values, "Labels": labels}},
    }
    path = runs.scratch("study").with_suffix(".xml")
    path.write_text(xml("study", tree), encoding="utf-8")
    return path


def studied(name, options):
    order, coarser = options.order, options.coarser
    scene = SCENES[name]
    mesh, tree = scene.make(order)
    tree["Model"]["Mesh file"] = geometry(mesh)
    tree["Adaptivity"] = {"Rounds": 0}
    tree["Solver"] = {"Tolerance": 1e-5}
    sizes, targets = ([coarser * value for value in values[order]] for values in (scene.sizes, scene.targets))
    path = study_deck(deck(tree), sizes, targets, coarser * scene.finest[order], options.repetitions)
    output = runs.scratch("study")
    run = runs.start([path, "--output", output], 2, program="study")
    if run.returncode != 0:
        raise harmos_measure.RunFailed(str(run))
    study = json.loads((output / "study.json").read_text(encoding="utf-8"))
    if options.keep:
        shutil.copytree(output, Path(options.keep) / f"{name}_{order}", dirs_exist_ok=True)
    found = []
    for item in study["runs"]:
        adapted = item["label"].startswith("adapted")
        found.append({
            "adapted": adapted, "label": item["label"], "dofs": item["primal_dimension"],
            "seconds": item["seconds"]["total"], "error": item["errors"]["energy"]["total"],
            "estimate": item["estimated_error"] if adapted else None, "reference": item["errors"]["energy"]["reference"],
            "converged": item["converged"],
        })
    return found


def line(points, error, count):
    """log seconds over log error, by least squares through the points with the least errors."""
    last = sorted(points)[:count]
    mx, my = statistics.mean(x for x, _ in last), statistics.mean(y for _, y in last)
    slope = sum((x - mx) * (y - my) for x, y in last) / sum((x - mx)**2 for x, _ in last)
    return math.exp(my + slope * (math.log(error) - mx))


def seconds_at(points, error):
    """By lines between the points in logarithmic axes; beyond the last one by those with the least errors, and so said."""
    points = [(math.log(p["error"]), math.log(p["seconds"])) for p in points if p["error"] and p["converged"]]
    x = math.log(error)
    below, above = [p for p in points if p[0] <= x], [p for p in points if p[0] > x]
    if not below:
        return line(points, error, 3), True
    if not above:
        return min(math.exp(p[1]) for p in points), False
    return line([max(below), min(above)], error, 2), False


def rate(points):
    """−d log error / d log dofs, of the last four."""
    last = sorted(points, key=lambda p: p["dofs"])[-4:]
    x, y = [math.log(p["dofs"]) for p in last], [math.log(p["error"]) for p in last]
    mx, my = statistics.mean(x), statistics.mean(y)
    return -sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx)**2 for a in x)


def judged(name, order, found):
    uniform, adapted = [p for p in found if not p["adapted"]], [p for p in found if p["adapted"]]
    one, one_beyond = seconds_at(uniform, 0.01)
    other, other_beyond = seconds_at(adapted, 0.01)
    return {
        "scene": name, "order": order, "points": found, "seconds_uniform": one, "uniform_is_extrapolated": one_beyond,
        "seconds_adapted": other, "adapted_is_extrapolated": other_beyond, "ratio": other / one,
        "rate_uniform": rate(uniform), "rate_adapted": rate(adapted),
        "efficiency": [p["estimate"] / p["error"] for p in adapted],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--order", type=int, default=2)
    parser.add_argument("--coarser", type=float, default=1.0, help="sizes and targets times this")
    parser.add_argument("--output")
    parser.add_argument("--keep", help="directory for the studies")
    options = parser.parse_args()
    runs.TIMEOUT = 3600
    document = {"benchmark": "adaptive_curves", "harmos": harmos_measure.version(), "ranks": 2, "runs": []}
    for name in options.scenes.split(","):
        result = judged(name, options.order, studied(name, options))
        document["runs"].append(result)
        rows = [(p["label"], p["dofs"], f"{p['seconds']:.3g}", f"{p['error']:.3g}",
                 f"{p['estimate'] / p['error']:.2f}" if p["adapted"] else "") for p in result["points"]]
        runs.table(name, ("mesh", "dofs", "seconds", "error", "estimate over error"), rows)
        beyond = " (beyond the last one)" if result["uniform_is_extrapolated"] else ""
        print(f"at 1 %: one size {result['seconds_uniform']:.3g} s{beyond}, adapted {result['seconds_adapted']:.3g} s, "
              f"ratio {result['ratio']:.3g}; rates {result['rate_uniform']:.2f}, {result['rate_adapted']:.2f}; "
              f"the reference's own error {result['points'][0]['reference']:.1e}", flush=True)
        if options.output:
            Path(options.output).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
