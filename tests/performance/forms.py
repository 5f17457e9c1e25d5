# SPDX-License-Identifier: BSD-3-Clause
"""What `Form = auto` chooses, beside all that it could have chosen: seconds of every form, preconditioner and precision.

    forms.py [--only NAME...] [--repetitions 1] [--np 2] [--scale 1] [--output JSON]

Scenes are those of real_bodies_table.py and of unstructured.py in contact, and the twelve cells of the model problem.
Seconds are those of a run but for its stage of meshes. A line a scene: what was chosen, how many times as long as the
fastest it took, and what that was. Exit status 1 where it took more than 1.15 times and 0.1 s longer.
"""

import argparse
import itertools
import json
import statistics
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "support")]

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402
import real_bodies  # noqa: E402

FORMS = ("condensed", "implicit")
PRECONDITIONERS = ("Dirichlet", "lumped")
PRECISIONS = ("double", "single")

# Name: scene of real_bodies.py, scale of its elements, parts.
BODIES = {
    "half-ball": ("half-ball", 1.0, 96),
    "half-ball-quadratic": ("half-ball-quadratic", 1.0, 96),
    "half-disc": ("half-disc", 1.0, 96),
    "ball-on-block": ("ball-on-block", 1.0, 96),
    "half-ball-165": ("half-ball", 0.882, 96),
    "half-ball-530": ("half-ball", 0.588, 192),
    "ball-on-block-165": ("ball-on-block", 0.87, 96),
    "half-ball-quadratic-300": ("half-ball-quadratic", 0.84, 96),
}
CELLS = {f"model-{s}x{n}": (s, n) for s, n in itertools.product((1, 2, 4, 8), (8, 32, 128))}


def scene(name, directory, scale):
    """Program, deck and settings."""
    if name in CELLS:
        sides, elements = CELLS[name]
        return (
            "signorini",
            runs.MODEL,
            {"Model/Subdomains per side": sides, "Model/Elements per subdomain side": elements},
        )
    key, size, parts = BODIES[name]
    place = Path(directory) / name
    place.mkdir()
    deck = real_bodies.write_deck(place, key, True, scale=size * scale)
    return "harmos", deck, {**real_bodies.cut(key, parts), "Solver/Tolerance": 1e-4}


def combinations():
    """What there is, beside auto."""
    for form, preconditioner, precision in itertools.product(FORMS, PRECONDITIONERS, PRECISIONS):
        yield (
            f"{form}, {precision}, {preconditioner} preconditioner",
            {
                "Dual operator/Form": form,
                "Dual operator/Preconditioner": preconditioner,
                "Dual operator/Precision": precision,
            },
        )


def measured(program, deck, settings, given):
    summaries = harmos_measure.repeated(given.repetitions, deck, settings, given.np, program)
    spent = [s["seconds"]["total"] - s["seconds"]["mesh"] for s in summaries]
    last = summaries[-1]
    return {
        "seconds": statistics.median(spent),
        "products": last["hessian_applications"],
        "peak_memory_mib": last["peak_memory_mib"],
        "dual_operator": sorted({s["dual_operator"] for s in summaries}),
    }


def entry(name, directory, given):
    program, deck, settings = scene(name, directory, given.scale)
    item = {"name": name, "auto": measured(program, deck, settings, given), "combinations": {}}
    for title, sets in combinations():
        try:
            item["combinations"][title] = measured(program, deck, {**settings, **sets}, given)
        except harmos_measure.RunFailed as error:
            print(f"{name}, {title}: {error}", file=sys.stderr)
    best = min(item["combinations"], key=lambda title: item["combinations"][title]["seconds"])
    fastest, chosen = item["combinations"][best]["seconds"], item["auto"]["seconds"]
    # The same choice has the same speed: of both measurements the shorter one.
    (choice,) = item["auto"]["dual_operator"]
    if choice in item["combinations"]:
        chosen = min(chosen, item["combinations"][choice]["seconds"])
    item |= {"best": best, "quotient": chosen / fastest, "good": chosen <= max(1.15 * fastest, fastest + 0.1)}
    print(
        f"{name}: {choice} {chosen:.3g} s, {item['quotient']:.2f} times {best} {fastest:.3g} s"
        + ("" if item["good"] else "  <-- not good"),
        flush=True,
    )
    return item


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", default=[*BODIES, *CELLS])
    parser.add_argument("--repetitions", type=int, default=1)
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--scale", type=float, default=1.0, help="of the elements of bodies")
    parser.add_argument("--output")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        items = [entry(name, directory, given) for name in given.only]
    if given.output:
        document = {"benchmark": "forms", "harmos": harmos_measure.version(), "ranks": given.np, "runs": items}
        Path(given.output).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0 if all(item["good"] for item in items) else 1


if __name__ == "__main__":
    sys.exit(main())
