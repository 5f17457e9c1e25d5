# SPDX-License-Identifier: BSD-3-Clause
"""deal.II's tutorial step-42 and Harmos, pressed by the same ball on the same cells: forces, and seconds of whole runs.

    indentation.py [--cells 8,16,32] [--depths 0.0025,0.005,0.0075,0.01] [--repetitions 3] [--np 2] [--work DIR]
                   [--output JSON] [--page MARKDOWN]
    indentation.py --render [--output JSON] [--page MARKDOWN]

The tutorial's program is that of Debian's package libdeal.ii-doc, built with its own CMake file as a release against
libdeal.ii-dev; radius and depth of the ball are made variables of the environment. Both programs run in turns. Seconds of
the tutorial are those that it prints of a mesh; it starts anew on each. Exit status 1 if a run failed; 77 where the
packages are missing.
"""

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
TESTS = HERE.parents[1]
sys.path[:0] = [str(HERE), str(HERE.parent), str(TESTS / "support"), str(TESTS / "verification/physics")]
sys.path.append(str(TESTS / "verification/finite"))

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402
import indentation_page  # noqa: E402
import step42  # noqa: E402
from headline import four_digits  # noqa: E402

DOCUMENT = runs.SOURCE / "docs/indentation.json"
PAGE = runs.SOURCE / "docs/indentation.md"
TUTORIAL = Path("/usr/share/doc/libdeal.ii-doc/examples/step-42")
RADII = (step42.RADIUS, 6.0)
SUBDOMAINS = {8: 2, 16: 4, 32: 4}  # a side, the fastest of those tried; else one for each eight cells
VARIABLES = """#include <cstdlib>
static double of_environment(const char *name) { return std::atof(std::getenv(name)); }
"""


def built(work):
    """The tutorial's program."""
    directory = work / "step-42"
    program = directory / "step-42"
    if program.exists():
        return program
    directory.mkdir(parents=True, exist_ok=True)
    source = (TUTORIAL / "step-42.cc").read_text(encoding="utf-8")
    for words, variable in (("z_surface + 0.59", 'z_surface + of_environment("RADIUS") - of_environment("DEPTH")'),
                            ("0.36", '(of_environment("RADIUS") * of_environment("RADIUS"))')):
        if words not in source:
            sys.exit(f"{TUTORIAL}/step-42.cc: no {words!r}: another version of the tutorial than that of deal.II 9.4.1")
        source = source.replace(words, variable)
    (directory / "step-42.cc").write_text(VARIABLES + source, encoding="utf-8")
    (directory / "CMakeLists.txt").write_text((TUTORIAL / "CMakeLists.txt").read_text(encoding="utf-8"), encoding="utf-8")
    for command in (["cmake", "-DCMAKE_BUILD_TYPE=Release", "."], ["make"]):
        subprocess.run(command, cwd=directory, check=True, stdout=subprocess.DEVNULL)
    return program


def of_tutorial(program, cells, radius, depth, given):
    """Of each of its meshes, up to so many cells: force, seconds, Newton's iterations."""
    cycles = cells.bit_length() - 3
    settings = {
        "polynomial degree": 1, "number of initial refinements": 3, "number of cycles": cycles,
        "refinement strategy": "global", "obstacle": "sphere", "output directory": "out",
    }
    deck = program.parent / "case.prm"
    deck.write_text("".join(f"set {name} = {value}\n" for name, value in settings.items()), encoding="utf-8")
    environment = {**os.environ, "RADIUS": str(radius), "DEPTH": str(depth)}
    done = subprocess.run(
        [*map(str, runs.launcher(given.np)), str(program), deck.name], cwd=program.parent, env=environment, text=True, capture_output=True, check=False,
    )
    found = {}
    for cycle in done.stdout.split("Cycle ")[1:]:
        count = int(re.search(r"active cells: (\d+)", cycle).group(1))
        found[round(count ** (1 / 3))] = {
            "force": float(re.search(r"Contact force = (\S+)", cycle).group(1)),
            "seconds": float(re.search(r"elapsed since start\s*\|\s*([0-9.]+)s", cycle).group(1)),
            "newton": len(re.findall(r"Newton iteration", cycle)),
            "unknowns": int(re.search(r"degrees of freedom: (\d+)", cycle).group(1)),
        }
    if done.returncode != 0 or cells not in found:
        sys.exit(f"step-42: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return found


def of_harmos(cells, radius, depth, given):
    parts = SUBDOMAINS.get(cells, cells // 8)
    summary = harmos_measure.repeated(1, deck(step42.scene(cells, parts, radius=radius, depth=depth)), {}, given.np, "harmos")[0]
    step = summary["steps"][-1]
    return {
        "force": -step["Obstacle/ball/fz"], "seconds": summary["seconds"]["total"], "newton": step["newton"],
        "products": summary["hessian_applications"], "subdomains": summary["subdomains"], "closed": step["closed"],
    }


def deck(tree):
    from finite_scenes import deck as written

    return written(tree)


def medians(answers):
    return {**answers[-1], "seconds": four_digits(statistics.median(answer["seconds"] for answer in answers))}


def measured(program, given):
    """The document."""
    entries, curve = [], []
    largest = max(given.cells)
    for radius in RADII:
        found = {who: {cells: [] for cells in given.cells} for who in ("harmos", "tutorial")}
        for _ in range(given.repetitions):
            theirs = of_tutorial(program, largest, radius, step42.DEPTH, given)
            for cells in given.cells:
                found["tutorial"][cells].append(theirs[cells])
                found["harmos"][cells].append(of_harmos(cells, radius, step42.DEPTH, given))
        for cells in given.cells:
            entry = {"radius": radius, "cells": cells, **{who: medians(found[who][cells]) for who in found}}
            entries.append(entry)
            print(f"radius {radius:g}, {cells}^3 cells: {entry['harmos']} {entry['tutorial']}", flush=True)
    middle = sorted(given.cells)[len(given.cells) // 2]
    for depth in given.depths:
        forces = {
            "tutorial": of_tutorial(program, middle, RADII[-1], depth, given)[middle]["force"],
            "harmos": four_digits(of_harmos(middle, RADII[-1], depth, given)["force"]),
        }
        curve.append({"depth": depth, **forces})
    return {
        "benchmark": "indentation", "harmos": harmos_measure.version(), "ranks": given.np,
        "repetitions": given.repetitions, "runs": entries, "curve": curve, "curve_cells": middle,
        "curve_radius": RADII[-1],
    }


def numbers(kind):
    return lambda text: [kind(word) for word in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=numbers(int), default=[8, 16, 32])
    parser.add_argument("--depths", type=numbers(float), default=[0.0025, 0.005, 0.0075, 0.01])
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--work", type=Path)
    parser.add_argument("--render", action="store_true")
    parser.add_argument("--output", type=Path, default=DOCUMENT)
    parser.add_argument("--page", type=Path, default=PAGE)
    given = parser.parse_args()
    if not given.render:
        if not TUTORIAL.exists():
            runs.skip(f"{TUTORIAL} is not there (Debian: libdeal.ii-doc, libdeal.ii-dev)")
        with tempfile.TemporaryDirectory() as scratch:
            document = measured(built(given.work or Path(scratch)), given)
        given.output.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    given.page.write_text(indentation_page.page(json.loads(given.output.read_text(encoding="utf-8"))), encoding="utf-8")


if __name__ == "__main__":
    main()
