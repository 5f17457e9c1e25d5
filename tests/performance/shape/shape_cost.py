# SPDX-License-Identifier: BSD-3-Clause
"""What the best shape of a contact surface costs, in solutions of the same scene from nothing.

    shape_cost.py [--only NAME...] [--scale 1] [--np 1] [--repetitions 3] [--tolerance 1e-7] [--output JSON]

The punch of apps/shape/decks/punch.xml with 60 design variables and some 10⁵ unknowns: `shared`, whose subdomains are
congruent and share their factors; `unshared`, where each has its own; `meshed`, triangles that Gmsh makes and METIS cuts.
`nodes` has a number for each contact node in the place of splines. `moved` shapes the lower edge of crowned_block.xml.

A cold solution is what the run does until it has its first value: decks, meshes, assembly, contact, factors, solver. An
evaluation is a value and a gradient after the first, means over the run.
"""

import argparse
import json
import statistics
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "support"))

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402

DECKS = runs.SOURCE / "apps/shape/decks"

GEO = """
h = {h}; n = {n};
Point(1) = {{0, 0, 0, h}}; Point(2) = {{2, 0, 0, h}}; Point(3) = {{2, 1, 0, h}}; Point(4) = {{1, 1, 0, h}}; Point(5) = {{0, 1, 0, h}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 5}}; Line(5) = {{5, 1}};
Curve Loop(1) = {{1, 2, 3, 4, 5}}; Plane Surface(1) = {{1}};
Point(6) = {{0, 1, 0, h}}; Point(7) = {{1, 1, 0, h}}; Point(8) = {{1, 1.5, 0, h}}; Point(9) = {{0, 1.5, 0, h}};
Line(6) = {{6, 7}}; Line(7) = {{7, 8}}; Line(8) = {{8, 9}}; Line(9) = {{9, 6}};
Curve Loop(2) = {{6, 7, 8, 9}}; Plane Surface(2) = {{2}};
Transfinite Curve {{4, 6}} = n;
Physical Curve("bottom") = {{1, 6}}; Physical Curve("below") = {{4}}; Physical Curve("left") = {{5, 9}};
Physical Curve("top") = {{8}};
Physical Surface("ground") = {{1}}; Physical Surface("punch") = {{2}};
"""


def elements(scale, full):
    return max(2, round(full / scale))


def blocks(scale):
    """The punch of the deck on a finer grid, in 40 subdomains."""
    n = elements(scale, 36)
    return {
        "Bodies/punch/Subdomains a side": "{4, 2, 1}",
        "Bodies/ground/Subdomains a side": "{8, 4, 1}",
        "Bodies/punch/Elements a side": f"{{{n}, {n}, 1}}",
        "Bodies/ground/Elements a side": f"{{{n}, {n}, 1}}",
    }


def splines(scale):
    return {"Shape/Design/Functions": "splines", "Shape/Design/Pieces": f"{{{elements(scale, 58)}, 1}}"}


def meshed(directory, scale):
    """A deck and a mesh as large as blocks()."""
    h = 0.0072 * scale
    (directory / "punch.geo").write_text(GEO.format(h=h, n=round(1 / h) + 1), encoding="utf-8")
    text = (DECKS / "punch.xml").read_text(encoding="utf-8")
    begin, end = text.index('  <ParameterList name="Bodies">'), text.index('  <ParameterList name="Effects">')
    bodies = "".join(
        f"""    <ParameterList name="{name}">
      <Parameter name="Subdomains" type="int" value="{parts}"/>
      <Parameter name="Materials" type="Array(string)" value="{{{material}}}"/>
    </ParameterList>
"""
        for name, parts, material in (("punch", 8, "hard"), ("ground", 32, "soft"))
    )
    text = text[:begin] + f'  <ParameterList name="Bodies">\n{bodies}  </ParameterList>\n' + text[end:]
    physics = '    <Parameter name="Physics" type="string" value="plane strain"/>\n'
    mesh = '    <Parameter name="Mesh file" type="string" value="punch.geo"/>\n'
    assert physics in text
    deck = directory / "punch.xml"
    deck.write_text(text.replace(physics, physics + mesh), encoding="utf-8")
    return deck


def moved(scale):
    n = elements(scale, 56)
    return {
        "Bodies/block/Subdomains a side": "{4, 4, 1}",
        "Bodies/block/Elements a side": f"{{{n}, {n}, 1}}",
        "Shape/Design/Depth": 0.5,
    }


def case(name, directory, scale):
    """Deck and settings."""
    punch = DECKS / "punch.xml"
    if name == "shared":
        return punch, {**blocks(scale), **splines(scale)}
    if name == "unshared":
        return punch, {**blocks(scale), **splines(scale), "Dual operator/Expert/Share identical subdomains": "false"}
    if name == "nodes":
        return punch, blocks(scale)
    if name == "moved":
        return DECKS / "crowned_block.xml", moved(scale)
    return meshed(directory, scale), splines(scale)


NAMES = ("shared", "unshared", "meshed", "nodes", "moved")


def entry(name, given):
    with tempfile.TemporaryDirectory() as directory:
        deck, settings = case(name, Path(directory), given.scale)
        settings |= {"Solver/Tolerance": given.tolerance, "Output/Fields": "false"}
        once = harmos_measure.repeated(1, deck, {**settings, "Shape/Optimiser/Status Test/Gradient Tolerance": 10.0}, given.np, "shape")
        summaries = harmos_measure.repeated(given.repetitions, deck, settings, given.np, "shape")
    median = lambda get: statistics.median(get(s) for s in summaries)  # noqa: E731
    last, results = summaries[-1], summaries[-1]["results"]
    cold = median(lambda s: s["seconds"]["set_up"] + s["seconds"]["first_value"])
    value = median(lambda s: (s["seconds"]["values"] - s["seconds"]["first_value"]) / max(1, s["results"]["solutions"] - 1))
    gradient = median(lambda s: s["seconds"]["gradients"] / max(1, s["results"]["adjoints"]))
    item = {
        "name": name,
        "unknowns": last["primal_dimension"],
        "subdomains": last["subdomains"],
        "design_variables": int(results["design_variables"]),
        "evaluations": int(results["evaluations"]),
        "peak_over_mean": results["peak_pressure"] / results["mean_pressure"],
        "peak_over_mean_before": results["peak_pressure_before"] / results["mean_pressure_before"],
        "products_of_a_solution": results["products_of_solutions"] / results["solutions"],
        "products_of_an_adjoint": results["products_of_adjoints"] / results["adjoints"],
        "factorisations": last["local_factorizations"],
        "factorisations_of_first": once[0]["local_factorizations"],
        "cold_seconds": cold,
        "value_seconds": value,
        "gradient_seconds": gradient,
        "evaluation_over_cold": (value + gradient) / cold,
        "whole_over_cold": median(lambda s: s["seconds"]["total"]) / cold,
    }
    print(
        f"{name}: {item['unknowns']} unknowns, {item['design_variables']} numbers, {item['evaluations']} evaluations; cold "
        f"{cold:.3g} s, an evaluation {item['evaluation_over_cold']:.2f} of it, the whole {item['whole_over_cold']:.1f} of it; "
        f"peak over mean {item['peak_over_mean_before']:.3f} -> {item['peak_over_mean']:.4f}",
        flush=True,
    )
    return item


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", default=NAMES, choices=NAMES)
    parser.add_argument("--scale", type=float, default=1.0, help="of the elements")
    parser.add_argument("--np", type=int, default=1)
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--tolerance", type=float, default=1e-7)
    parser.add_argument("--output")
    given = parser.parse_args()
    items = [entry(name, given) for name in given.only]
    if given.output:
        document = {
            "benchmark": "shape_cost", "harmos": harmos_measure.version(), "ranks": given.np, "tolerance": given.tolerance,
            "runs": items,
        }
        Path(given.output).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
