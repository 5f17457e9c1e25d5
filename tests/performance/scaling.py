# SPDX-License-Identifier: BSD-3-Clause
"""One rank against two, and both against the performance model.

    scaling.py [--cells 8x128] [--repetitions 5] [--output FILE]

Strong scaling of the model problem, without and with sharing: total times of one and two ranks.
Then the seconds of a step of PCPG (the tied problem, solve / products), against those that
performance_model.py computes from the rates of this machine.
"""

import argparse
import json
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "support")]

import harmos_measure  # noqa: E402
import model_problem  # noqa: E402
import performance_model  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--cells", default="8x128")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--output")
    given = parser.parse_args()
    speedups, steps = [], []
    for cell in given.cells.split(","):
        s, n = map(int, cell.split("x"))
        for kind in ("unshared", "shared"):
            one, two = (
                model_problem.measure(s, n, kind, np, given.repetitions, {})["seconds"]["total"]
                for np in (1, 2)
            )
            speedups.append(
                {
                    "subdomains_per_side": s,
                    "elements_per_subdomain_side": n,
                    "kind": kind,
                    "seconds_np1": one,
                    "seconds_np2": two,
                    "speedup": one / two,
                }
            )
            print(f"S = {s}, N = {n}, {kind}: {one:.3f} s, {two:.3f} s, speedup {one / two:.2f}", flush=True)
        for kind in ("tied", "tied unshared"):
            for np in (1, 2):
                sets = model_problem.KINDS["unshared"] if kind != "tied" else {}
                run = model_problem.measure(s, n, "tied", np, given.repetitions, sets)
                measured = run["seconds"]["solve"] / run["products"]
                # Between ranks of one machine memory is the network; both numbers are assumptions.
                machine = performance_model.Machine(latency=1e-6, bandwidth=5e9)
                problem = performance_model.Problem(2 * s * s // np, n, kind == "tied")
                expected = sum(performance_model.step(np, machine, problem).values())
                steps.append(
                    {
                        "subdomains_per_side": s,
                        "elements_per_subdomain_side": n,
                        "kind": kind,
                        "ranks": np,
                        "seconds_a_step": measured,
                        "expected_seconds_a_step": expected,
                        "expected_over_measured": expected / measured,
                    }
                )
                print(
                    f"S = {s}, N = {n}, {kind}, np = {np}: {measured:.2e} s a step, "
                    f"expected {expected:.2e}",
                    flush=True,
                )
    if given.output:
        document = {
            "benchmark": "scaling",
            "harmos": harmos_measure.version(),
            "speedups": speedups,
            "steps": steps,
        }
        Path(given.output).write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
