# SPDX-License-Identifier: BSD-3-Clause
"""The model problem in all cells: seconds, products, memory; contact and tied, shared or not.

    model_problem.py [--cells 8x8,8x128] [--np 2] [--repetitions 5] [--kinds shared,tied]
                     [--set PATH=VALUE]... [--output FILE]

A cell is S x N: subdomains per side, elements per subdomain side. Kinds: shared, unshared,
implicit (shared), tied (shared), unpreconditioned (shared). Medians of the repetitions.
"""

import argparse
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402

runs.TIMEOUT = 900

KINDS = {
    "shared": {},
    "unshared": {"Dual operator/Expert/Share identical subdomains": False},
    "implicit": {"Dual operator/Form": "implicit"},
    "tied": {"Model/Interface": "tie"},
    "unpreconditioned": {"Dual operator/Preconditioner": "none"},
}
CELLS = [(s, n) for n in (8, 32, 128) for s in (1, 2, 4, 8)]


def cell_sets(s, n, kind):
    """What a cell overrides in the deck."""
    return {
        "Model/Subdomains per side": s,
        "Model/Elements per subdomain side": n,
        "Output/Fields": False,
        **KINDS[kind],
    }


def measure(s, n, kind, np, repetitions, sets):
    """The median run of a cell."""
    sets = {**cell_sets(s, n, kind), **sets}
    summaries = harmos_measure.repeated(repetitions, runs.MODEL, sets, np)
    last = summaries[-1]
    return {
        "subdomains_per_side": s,
        "elements_per_subdomain_side": n,
        "kind": kind,
        "ranks": np,
        "primal_dimension": last["primal_dimension"],
        "dual_dimension": last["dual_dimension"],
        "solver": last["solver"],
        "dual_operator": last["dual_operator"],
        "factorizations": last["distinct_local_factorizations"],
        "products": last["hessian_applications"],
        "outer_iterations": last["outer_iterations"],
        "seconds": harmos_measure.median_seconds(summaries),
        "peak_memory_mib": harmos_measure.median_memory(summaries),
        "energy": last["energy"],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--cells", default=",".join(f"{s}x{n}" for s, n in CELLS))
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--kinds", default="shared")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE")
    parser.add_argument("--output")
    given = parser.parse_args()
    sets = dict(item.split("=", 1) for item in given.set)
    results = []
    for kind in given.kinds.split(","):
        for cell in given.cells.split(","):
            s, n = map(int, cell.split("x"))
            result = measure(s, n, kind, given.np, given.repetitions, sets)
            results.append(result)
            print(
                f"S = {s}, N = {n}, {kind}: {result['primal_dimension']}/{result['dual_dimension']}, "
                f"{result['products']} products, {result['seconds']['total']:.3f} s in all "
                f"({result['seconds']['solve']:.3f} s solving), "
                f"{result['peak_memory_mib']:.0f} MiB",
                flush=True,
            )
    if given.output:
        document = {
            "benchmark": "model_problem",
            "harmos": harmos_measure.version(),
            "ranks": given.np,
            "runs": results,
        }
        Path(given.output).write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
