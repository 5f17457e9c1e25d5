# SPDX-License-Identifier: BSD-3-Clause
"""Products with F on meshes of real bodies, over the number of subdomains: linear problems and contact.

    real_bodies_table.py [--only NAME...] [--parts 24 48 96 192 384] [--partitions compact METIS] [--seeds 1]
                         [--problems linear contact] [--tolerance 1e-4] [--scale 1] [--output JSON]
    real_bodies_table.py --merge JSON... [--output JSON] [--page MARKDOWN]
    real_bodies_table.py --render

A line a run, and a table at the end. Exit status 1 if a run failed or did not converge.

--merge measures nothing: the runs of these files, later ones in the place of earlier ones of the same case, become
docs/real_bodies.json and the page docs/real_bodies.md, or those that --output and --page name. --render writes the
page anew.
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
import real_bodies_page  # noqa: E402

DOCUMENT = runs.SOURCE / "docs/real_bodies.json"
PAGE = runs.SOURCE / "docs/real_bodies.md"


def measured(deck, key, problem, parts, partition, seed, given):
    """An entry of the JSON."""
    settings = {
        **real_bodies.cut(key, parts, partition, seed),
        "Solver/Tolerance": given.tolerance,
        # What is chosen by itself depends on the number of parts.
        "Dual operator/Preconditioner": "Dirichlet",
    }
    item = {
        "scene": key,
        "problem": problem,
        "parts": parts,
        "partition": partition,
        "seed": seed,
        "tolerance": given.tolerance,
    }
    try:
        summary = harmos_measure.repeated(1, deck, settings, given.np, "harmos")[0]
    except (harmos_measure.RunFailed, AssertionError) as error:
        print(error, file=sys.stderr)
        return {**item, "problem_of_run": "failed"}
    return {
        **item,
        "unknowns": summary["primal_dimension"],
        "inequalities": summary["inequalities"],
        "subdomains": summary["subdomains"],
        "products": summary["hessian_applications"],
        "active_sets": summary["outer_iterations"],
        "solver": summary["solver"],
        "energy": summary["energy"],
        "seconds_solve": summary["seconds"]["solve"],
        "seconds_total": summary["seconds"]["total"],
    }


def table(document):
    """Products, a row for each scene, problem, way to cut and seed."""
    rows = {}
    for item in document["runs"]:
        place = (item["scene"], item["problem"], item["partition"], item["seed"])
        rows.setdefault(place, {})[item["parts"]] = item.get("products", "failed")
    parts = document["parts"]
    lines = [
        "| Scene | Problem | Parts | Seed | " + " | ".join(str(n) for n in parts) + " |",
        "|---|---|---|---|" + "---|" * len(parts),
    ]
    for place, cells in rows.items():
        values = [str(cells.get(n, "")) for n in parts]
        lines.append("| " + " | ".join([*map(str, place), *values]) + " |")
    return "\n".join(lines) + "\n"


def render(paths, output, page):
    """Make one document and a page of what was measured."""
    documents = [json.loads(Path(path).read_text(encoding="utf-8")) for path in paths]
    document = real_bodies_page.merged(documents)
    for path, text in (
        (output, real_bodies_page.as_json(document)),
        (page, real_bodies_page.page(document)),
    ):
        Path(path).write_text(text, encoding="utf-8")
        print(f"wrote {path}")


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", default=list(real_bodies.BODIES))
    parser.add_argument("--parts", nargs="+", type=int, default=[24, 48, 96, 192, 384])
    parser.add_argument("--partitions", nargs="+", default=["compact", "METIS"])
    parser.add_argument("--seeds", nargs="+", type=int, default=[1])
    parser.add_argument("--problems", nargs="+", default=["linear", "contact"])
    parser.add_argument("--tolerance", type=float, default=1e-4)
    parser.add_argument("--scale", type=float, default=1.0, help="of all elements")
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--output")
    parser.add_argument("--merge", nargs="+", metavar="JSON")
    parser.add_argument("--render", action="store_true")
    parser.add_argument("--page")
    return parser.parse_args()


def main():
    given = arguments()
    if given.merge or given.render:
        render(given.merge or [DOCUMENT], given.output or DOCUMENT, given.page or PAGE)
        return 0
    document = {
        "benchmark": "real_bodies",
        "harmos": harmos_measure.version(),
        "ranks": given.np,
        "parts": given.parts,
        "runs": [],
    }
    with tempfile.TemporaryDirectory() as directory:
        for key in given.only:
            for problem in given.problems:
                deck = real_bodies.write_deck(
                    Path(directory), key, problem == "contact", scale=given.scale
                )
                for partition in given.partitions:
                    for seed in given.seeds:
                        for parts in given.parts:
                            item = measured(deck, key, problem, parts, partition, seed, given)
                            document["runs"].append(item)
                            products = item.get("products", "failed")
                            print(key, problem, partition, seed, parts, products, flush=True)
    print(table(document), end="")
    if given.output:
        Path(given.output).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0 if all("products" in item for item in document["runs"]) else 1


if __name__ == "__main__":
    sys.exit(main())
