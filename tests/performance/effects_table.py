# SPDX-License-Identifier: BSD-3-Clause
"""What each effect adds to a run: scenes with everything on against the same with one effect off.

What friction adds are lines of their own: the scenes with everything else on against the same where surfaces rub.

    effects_table.py [--elements 24,8] [--repetitions 5] [--np 2] [--output FILE] [--page FILE]

Writes docs/effects.md (or --page) and, with --output, JSON. Seconds and MiB are medians.
"""

import argparse
import copy
import json
import os
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402
from harmos_decks import xml  # noqa: E402

PAGE = runs.SOURCE / "docs/effects.md"
COLUMNS = (
    ("primal dimension", "primal_dimension"),
    ("dual dimension", "dual_dimension"),
    ("inequalities", "inequalities"),
    ("kernel", "kernel_dimension"),
    ("applications of F", "hessian_applications"),
    ("seconds", "seconds"),
    ("MiB", "mib"),
)
# Where everything else rubs as well: on the contact, on the obstacle that bears a body, on both. Not among the effects
# of the scenes, whose lines are about problems without friction.
RUBS = {"contact": ("Contact/joint",), "obstacle": ("Obstacle/floor",), "both": ("Contact/joint", "Obstacle/floor")}
GLUE = {
    "Law": "brittle",
    "Normal stiffness": 10.0,
    "Tangential stiffness": 10.0,
    "Normal strength": 1.0,
    "Tangential strength": 1.0,
}
COEFFICIENT = 0.3


def steps(physics, elements):
    """Three blocks: A below B, and D tied to the right side of B, above a floor of its own.

    Every effect is on; without any one of them there is a solution too.
    """
    is_space = physics == "solid"

    def vector(x, height):
        return [x, 0.0, height] if is_space else [x, height, 0.0]

    def block(x, height):
        sides = [2, 1, 2] if is_space else [4, 4, 1]
        return {
            "Source": "block",
            "Origin": vector(x, height),
            "Subdomains a side": sides,
            "Elements a side": [elements] * 3,
            "Materials": ["steel"],
        }

    walls = {
        f"left wall of {body}": {"Part": f"{body}/left", "Direction": vector(1.0, 0.0)} for body in "AB"
    }
    held = {
        "base": {"Part": "A/bottom"},
        "side": {"Part": "B/left", "Components": ["x"]},
    }
    if is_space:
        for body in "ABD":
            held[f"front of {body}"] = {"Part": f"{body}/front", "Components": ["y"]}
    return {
        "Model": {"Physics": physics, "Name": f"steps, {physics}"},
        "Materials": {
            "steel": {
                "Young's modulus": 1.0,
                "Poisson's ratio": 0.3,
                "Thermal expansion": [0.01, 0.01, 0.01],
            }
        },
        "Bodies": {"A": block(0.0, 0.0), "B": block(0.0, 1.0), "D": block(1.0, 1.0)},
        "Effects": {
            "Tie": {"seam": {"First": "D/left", "Second": "B/right"}},
            "Contact": {"joint": {"First": "B/bottom", "Second": "A/top"}},
            "Obstacle": {
                "floor": {
                    "Part": "D/bottom",
                    "Point": vector(0.0, 1.0),
                    "Direction": vector(0.0, 1.0),
                },
                "ground": {"Part": "A/bottom", "Direction": vector(0.0, 1.0)},
                "right wall": {
                    "Part": "D/right",
                    "Point": vector(2.0, 0.0),
                    "Direction": vector(-1.0, 0.0),
                },
                **walls,
            },
            "Body force": {
                f"on {body}": {"Body": body, "Density": vector(0.001 if body == "D" else -0.002, -0.01)}
                for body in "ABD"
            },
            "Traction": {
                "on B": {"Part": "B/top", "Pressure": 0.02},
                "on D": {"Part": "D/top", "Pressure": 0.01},
            },
            "Prescribed displacement": held,
            "Thermal strain": {"warm": {"Body": "D", "Temperature": 1.0}},
            "Elastic foundation": {"soil": {"Part": "A/right", "Normal stiffness": 0.5}},
        },
        "Solver": {"Tolerance": 1e-6, "Progress frequency": 0},
        "Output": {"Fields": False},
    }


def run(tree, np):
    deck = runs.scratch("deck").with_suffix(".xml")
    deck.write_text(xml("harmos", tree), encoding="utf-8")
    done = runs.run(deck, np=np, program="harmos")
    if done.returncode != 0:
        sys.exit(f"{done}")
    return done.summary


def medians(summaries):
    last = summaries[-1]
    kept = {key: last[key] for _, key in COLUMNS if key in last}
    return {
        **kept,
        "effects": last["effects"],
        "effect_costs": last["effect_costs"],
        "seconds": statistics.median(item["seconds"]["total"] for item in summaries),
        "mib": statistics.median(item["peak_memory_mib"] for item in summaries),
    }


def without(scene, effect):
    less = copy.deepcopy(scene)
    less["Effects"].pop(effect, None)
    return less


def rubbing(scene, contacts):
    """By Coulomb's law."""
    more = copy.deepcopy(scene)
    more["Effects"]["Friction"] = {
        f"on {contact.split('/')[1]}": {"Contact": contact, "Coefficient": COEFFICIENT} for contact in contacts
    }
    return more


def glued(scene, contacts):
    """By springs as stiff as elements that hold all the loads of the scene."""
    more = copy.deepcopy(scene)
    more["Effects"]["Adhesion"] = {
        f"on {contact.split('/')[1]}": {"Contact": contact, **GLUE} for contact in contacts
    }
    return more


def measure(scene, np, repetitions):
    """By effect that is off, None for none, and by what rubs or is glued.

    They take turns, so that a busy moment is nobody's alone.
    """
    results = {}
    for _ in range(repetitions):
        for effect in (None, *scene["Effects"]):
            results.setdefault(effect, []).append(run(without(scene, effect), np))
        for where, contacts in RUBS.items():
            results.setdefault(("Friction", where), []).append(run(rubbing(scene, contacts), np))
            results.setdefault(("Adhesion", where), []).append(run(glued(scene, contacts), np))
    return {name: medians(summaries) for name, summaries in results.items()}


def cell(off, on, key):
    if key == "seconds":
        return f"{off[key]:.2f} → {on[key]:.2f}"
    if key == "mib":
        return f"{off[key]:.0f} → {on[key]:.0f}"
    return f"{off[key]} → {on[key]}" if off[key] != on[key] else f"{on[key]}"


HEAD = """# What an effect adds

This page shows what each effect of a scene costs: dimensions, iterations, seconds and memory of a run with and
without it. It is for readers who choose effects for a large scene, or who [write an effect](adding_an_effect.md) and
want to compare its cost.

`tests/performance/effects_table.py` generates the page.

* Each scene has every effect of the table. A line compares the run without the effect with the run with it
  (off → on; a single number: the same in both).
* Friction and adhesion appear only in their own tables. These compare the scene with all other effects, without
  friction and adhesion, with the same scene where the contact, the obstacle that supports a body, or both have
  Coulomb friction with a coefficient of {coefficient}, or are glued by springs that hold.
* An effect that a scene does not name has no object, row, timer or memory in its run. Such a run is bit for bit that
  of a program without the class (`tests/unit/effects/test_absence.cpp`).
* What [large displacements](scenes.md#large-displacements) cost is told there: they are no effect, but the way all
  effects are solved.
* The last table of each scene has the cost of each effect alone, as in the log and in `summary.json`
  (`effect_costs`).

Seconds are those of the whole run without result files, medians of {repetitions} on {np} ranks; memory is the sum of
the peaks of the ranks. A scene with fewer effects is another problem and may need more iterations. The machine had
{cores} cores and a load of {load:.1f} when the measurement began; with a load near or above the number of cores, the
seconds are not reliable.
"""


def table(first, items):
    names = [name for name, _ in COLUMNS]
    lines = [f"| {first} | " + " | ".join(names) + " |", "|---|" + "---:|" * len(COLUMNS)]
    for label, item in items:
        cells = [cell(item["off"], item["on"], key) for _, key in COLUMNS]
        lines.append(f"| {label} | " + " | ".join(cells) + " |")
    return lines


def costs(every):
    lines = ["| effect | number | rows | seconds | KiB |\n|---|---:|---:|---:|---:|"]
    for cost in every:
        lines.append(
            f"| {cost['kind']} | {cost['effects']} | {cost['rows']} | {cost['seconds']:.4f} | "
            f"{cost['bytes'] / 1024:.1f} |"
        )
    return lines


def page(document):
    text = [HEAD.format(**document)]
    for scene in dict.fromkeys(item["scene"] for item in document["runs"]):
        items = [item for item in document["runs"] if item["scene"] == scene]
        plain = [item for item in items if "where" not in item]
        more = [item for item in items if "where" in item]
        text.append(f"## {scene[0].upper()}{scene[1:]}\n")
        text += table("effect", [(item["effect"], item) for item in plain])
        by_themselves = list(plain[0]["on"]["effect_costs"])
        for kind in ("Friction", "Adhesion"):
            of_kind = [item for item in more if item["effect"] == kind]
            text += ["", *table(f"{kind} on the", [(item["where"], item) for item in of_kind])]
            by_themselves += [cost for cost in of_kind[-1]["on"]["effect_costs"] if cost["kind"] == kind]
        text.append("\nEach effect alone, in the scene with all effects; friction and adhesion on contact and obstacle:\n")
        text += costs(by_themselves)
        text.append("")
    return "\n".join(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--elements", default="24,8", help="of a subdomain's side, in the plane and in space")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--output")
    parser.add_argument("--page", default=PAGE)
    given = parser.parse_args()
    plane, *space = map(int, given.elements.split(","))
    scenes = [steps("plane strain", plane), steps("solid", space[0] if space else plane)]
    document = {
        "benchmark": "effects",
        "ranks": given.np,
        "np": given.np,
        "repetitions": given.repetitions,
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0],
        "coefficient": COEFFICIENT,
        "runs": [],
    }
    for scene in scenes:
        measured = measure(scene, given.np, given.repetitions)
        name, on = scene["Model"]["Name"], measured.pop(None)
        for what, other in measured.items():
            if isinstance(what, tuple):
                entry = {"effect": what[0], "where": what[1], "off": on, "on": other}
            else:
                entry = {"effect": what, "off": other, "on": on}
            document["runs"].append({"scene": name, **entry})
            seconds = [entry[key]["seconds"] for key in ("off", "on")]
            print(f"{name}, {entry['effect']} {entry.get('where', '')}: {seconds[0]:.3f} s off, {seconds[1]:.3f} s on")
    Path(given.page).write_text(page(document), encoding="utf-8")
    if given.output:
        Path(given.output).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
