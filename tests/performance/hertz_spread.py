# SPDX-License-Identifier: BSD-3-Clause
"""Products of Hertz' ball on meshes that hardly differ: what of a count is the problem's, and what is luck.

    hertz_spread.py [--series approach elements halves] [--np 2] [--output JSON]

approach  the deck, the contact two per cent smaller to two larger beside its elements
elements  the deck with 6 to 10 elements a side of a subdomain
halves    half a ball of tetrahedra on a plane (real_bodies.py), five meshes whose elements differ by a per cent each
cuts      24 elements a side in five cuts, from 2 to 8 subdomains a side; not without being asked for

A line a run, and the ratio of the most products to the least in each series. Exit status 1 if a run failed.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "support")]

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402
import real_bodies  # noqa: E402

DECK = runs.DECKS / "hertz_ball.xml"
SCALE, PARTS, TOLERANCE = 2.0, 48, 1e-4  # of the halves

SERIES = {
    "approach": [{"Model/Approach": 0.01 * (1 + k / 50)} for k in (-2, -1, 0, 1, 2)],
    "elements": [{"Model/Elements per subdomain side": n} for n in (6, 7, 8, 9, 10)],
    "cuts": [
        {"Model/Subdomains per side": s, "Model/Elements per subdomain side": 24 // s}
        for s in (2, 3, 4, 6, 8)
    ],
    "halves": [SCALE * (1 + k / 100) for k in (-2, -1, 0, 1, 2)],
}


def cases(series, directory):
    """Program, deck, settings and the words that tell a run from the others."""
    for member in SERIES[series]:
        if series == "halves":
            deck = real_bodies.write_deck(directory, "half-ball", True, scale=member)
            cut = real_bodies.cut("half-ball", PARTS)
            yield "harmos", deck, {**cut, "Solver/Tolerance": TOLERANCE}, {"scale": member}
        else:
            yield "signorini", DECK, {**member, "Output/Fields": False}, member


def measured(series, directory, ranks):
    """Entries of the JSON."""
    for program, deck, settings, what in cases(series, directory):
        item = {"series": series, "set": what}
        try:
            summary = harmos_measure.repeated(1, deck, settings, ranks, program)[0]
        except (harmos_measure.RunFailed, AssertionError) as error:
            print(error, file=sys.stderr)
            yield {**item, "problem_of_run": "failed"}
            continue
        yield {
            **item,
            "unknowns": summary["primal_dimension"],
            "inequalities": summary["inequalities"],
            "closed": summary["steps"][-1]["closed"],
            "subdomains": summary["subdomains"],
            "tolerance": summary["tolerance"],
            "products": summary["hessian_applications"],
            "active_sets": summary["outer_iterations"],
            "solver": summary["solver"],
            "seconds_total": summary["seconds"]["total"],
        }


def spread(items):
    """The most products over the least."""
    products = [item["products"] for item in items if "products" in item]
    return max(products) / min(products) if products else None


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--series", nargs="+", default=["approach", "elements", "halves"], choices=SERIES)
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--output")
    given = parser.parse_args()
    document = {
        "benchmark": "hertz_spread",
        "harmos": harmos_measure.version(),
        "ranks": given.np,
        "runs": [],
        "spreads": {},
    }
    for series in given.series:
        items = []
        with tempfile.TemporaryDirectory() as directory:
            for item in measured(series, Path(directory), given.np):
                print(series, item["set"], item.get("products", "failed"), flush=True)
                items.append(item)
        document["runs"] += items
        document["spreads"][series] = spread(items)
        print(series, "most over least:", document["spreads"][series], flush=True)
    if given.output:
        Path(given.output).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0 if all("products" in item for item in document["runs"]) else 1


if __name__ == "__main__":
    sys.exit(main())
