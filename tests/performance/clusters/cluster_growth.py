# SPDX-License-Identifier: BSD-3-Clause
"""How products with F grow with the subdomains that a cluster joins.

    cluster_growth.py [--plane 1,2,3,4,6,8] [--space 1,2,3] [--elements 8,4] [--tolerance 1e-8] [--output FILE]

Blocks of so many clusters a side (plane 4, space 3), each of m a side, with equal elements a subdomain:
without clusters, and with. Of the ratio of products a fit 1 + a log2(m), by least squares.
Then what shape does: subdomains that are bars and plates, without clusters, and clusters of that shape.
"""

import argparse
import json
import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "support"))

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402

CLUSTERS = {"membrane": 4, "plane strain": 4, "solid": 3}  # a side
DENSITIES = {"membrane": "{-1, 0, 0}", "plane strain": "{0.01, 0.02, 0}", "solid": "{0.01, 0.02, -0.03}"}
DECK = """<ParameterList name="harmos">
  <ParameterList name="Model"><Parameter name="Physics" type="string" value="%(physics)s"/></ParameterList>
%(material)s
  <ParameterList name="Bodies"><ParameterList name="block">
    <Parameter name="Source" type="string" value="block"/>
    <Parameter name="Size" type="Array(double)" value="{1, 1, 1}"/>
    <Parameter name="Subdomains a side" type="Array(int)" value="{%(subdomains)s}"/>
    <Parameter name="Elements a side" type="Array(int)" value="{%(elements)s}"/>
%(materials)s
  </ParameterList></ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Prescribed displacement"><ParameterList name="wall">
      <Parameter name="Part" type="string" value="block/left"/>
    </ParameterList>%(held)s</ParameterList>
    <ParameterList name="Body force"><ParameterList name="load">
      <Parameter name="Body" type="string" value="block"/>
      <Parameter name="Density" type="Array(double)" value="%(density)s"/>
    </ParameterList></ParameterList>
  </ParameterList>
</ParameterList>
"""
MATERIAL = """  <ParameterList name="Materials"><ParameterList name="stuff">
    <Parameter name="Young's modulus" type="double" value="1"/>
    <Parameter name="Poisson's ratio" type="double" value="0.3"/>
  </ParameterList></ParameterList>"""
# Membranes under their weight that are held at one side vary along it in no way.
HELD = """<ParameterList name="other wall">
      <Parameter name="Part" type="string" value="block/bottom"/>
    </ParameterList>"""
MATERIALS = '    <Parameter name="Materials" type="Array(string)" value="{stuff}"/>'


def block(physics, subdomains, elements):
    """A deck: a body held at its left side, membranes at two, under its weight."""
    path = runs.scratch("block").with_suffix(".xml")
    elastic = physics != "membrane"
    text = DECK % {
        "physics": physics,
        "subdomains": ", ".join(map(str, subdomains)),
        "elements": ", ".join(map(str, elements)),
        "density": DENSITIES[physics],
        "material": MATERIAL if elastic else "",
        "materials": MATERIALS if elastic else "",
        "held": "" if elastic else HELD,
    }
    path.write_text(text, encoding="utf-8")
    return path


def solved(deck, clusters, tolerance, np):
    sets = {
        "Decomposition/Clusters": clusters,
        "Decomposition/Dirichlet": "dual",
        "Dual operator/Form": "condensed",
        "Dual operator/Preconditioner": "Dirichlet",
        "Output/Fields": False,
        "Solver/Tolerance": tolerance,
    }
    summary = harmos_measure.repeated(1, deck, sets, np=np, program="harmos")[0]
    return {
        "clusters": clusters,
        "coarse_dimension": summary["coarse_dimension"],
        "products": summary["hessian_applications"],
        "energy": summary["energy"],
        "solve_seconds": summary["seconds"]["solve"],
    }


def growth(physics, sides, elements, tolerance, np):
    rows = []
    dimension = 3 if physics == "solid" else 2
    for m in sides:
        count = CLUSTERS[physics] * m
        third = count if dimension == 3 else 1
        inner = elements if dimension == 3 else 1
        deck = block(physics, (count, count, third), (elements, elements, inner))
        none = solved(deck, "none", tolerance, np)
        some = none if m == 1 else solved(deck, str(m**dimension), tolerance, np)
        difference = abs(some["energy"] / none["energy"] - 1.0)
        row = {"physics": physics, "side": m, "none": none, "clusters": some, "difference": difference}
        rows.append(row)
        print(
            f"{physics}, {m**dimension} a cluster: coarse {none['coarse_dimension']} -> "
            f"{some['coarse_dimension']}, products {none['products']} -> {some['products']}, "
            f"energies differ by {difference:.1e}",
            flush=True,
        )
    return rows


def fitted(rows):
    """a of 1 + a log2(m)."""
    pairs = [(math.log2(r["side"]), r["clusters"]["products"] / r["none"]["products"] - 1.0) for r in rows]
    return sum(x * y for x, y in pairs) / max(sum(x * x for x, _ in pairs), 1e-300)


def shapes(elements, tolerance, np):
    """Cubes, plates and bars of two cubes a side, as subdomains and as clusters."""
    rows = []
    n, e = 6, elements
    cubes = block("solid", (n, n, n), (e, e, e))
    for name, joined, subdomains, inner in (
        ("cubes", 8, (n // 2, n // 2, n // 2), (2 * e, 2 * e, 2 * e)),
        ("plates", 4, (n // 2, n // 2, n), (2 * e, 2 * e, e)),
        ("bars", 2, (n // 2, n, n), (2 * e, e, e)),
    ):
        whole = solved(block("solid", subdomains, inner), "none", tolerance, np)
        some = solved(cubes, str(joined), tolerance, np)
        rows.append({"shape": name, "subdomains": whole, "clusters": some})
        print(f"{name}: as subdomains {whole['products']} products, as clusters {some['products']}", flush=True)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--plane", default="1,2,3,4,6,8")
    parser.add_argument("--space", default="1,2,3")
    parser.add_argument("--elements", default="8,4", help="a side of a subdomain, in the plane and in space")
    parser.add_argument("--tolerance", default="1e-8")
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--output")
    given = parser.parse_args()
    plane, space = map(int, given.elements.split(","))
    document = {"benchmark": "cluster_growth", "harmos": harmos_measure.version(), "ranks": given.ranks}
    document["tolerance"] = float(given.tolerance)
    document["runs"], document["fits"] = [], {}
    for physics in ("membrane", "plane strain", "solid"):
        flat = physics != "solid"
        sides = [int(m) for m in (given.plane if flat else given.space).split(",")]
        rows = growth(physics, sides, plane if flat else space, given.tolerance, given.ranks)
        document["runs"] += rows
        document["fits"][physics] = fitted(rows)
        print(f"{physics}: products grow by 1 + {document['fits'][physics]:.2f} log2(m)", flush=True)
    document["shapes"] = shapes(space, given.tolerance, given.ranks)
    if given.output:
        Path(given.output).write_text(json.dumps(document, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
