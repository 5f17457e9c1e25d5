# SPDX-License-Identifier: BSD-3-Clause
"""The page of calculix_models.py."""

import re
import textwrap
from collections import Counter

HEAD = """# Models of CalculiX and Abaqus

This page shows how to run a model of CalculiX or Abaqus with Harmos, what is converted, and how the results compare.
It is for engineers who have such models.

## Convert a model

```text
harmos-inp bracket.inp --output bracket
mpirun -np 2 harmos bracket/bracket.xml --output run
harmos-plot run
```

`harmos-inp` writes a [deck](scenes.md) and a mesh. Node sets and surfaces that loads, supports and contacts use become
boundary parts, with `--sets` all of them. Elements that hang together by nodes become a body. It has the name of the
element set that it equals, else `body_1`, `body_2` and so on. The deck is the model: edit it like any other.

What cannot be converted is an error with file and line. All errors are listed at once, and nothing is written. Notes
tell where the deck says something else than the model.

## What is converted

* `*NODE`, `*ELEMENT`, `*NSET`, `*ELSET`, `*SURFACE`, `*INCLUDE`: bodies and boundary parts. Elements: C3D4, C3D6,
  C3D8, C3D10, C3D15, C3D20 and C3D20R; CPE, CPS and CAX with 3, 4, 6 and 8 nodes, CPE8R, CPS8R, CAX8R
* `*SOLID SECTION`, `*MATERIAL`, `*ELASTIC`, `*EXPANSION`, `*DENSITY`, `*ORIENTATION`: isotropic, orthotropic and
  anisotropic materials, turned in any direction; `*PLASTIC`: curves of isotropic hardening, linear kinematic hardening
* `*BOUNDARY`: `Prescribed displacement`; with `*TRANSFORM` and for `*EQUATION`: `Linear constraint`
* `*CLOAD`: `Force`; `*DLOAD` with P, GRAV and CENTRIF, `*DSLOAD`: `Traction`, `Body force`, `Centrifugal force`
* `*INITIAL CONDITIONS` of temperatures, `*TEMPERATURE`: `Thermal strain`, by a nodal field where temperatures vary
* `*TIE`, `*CONTACT PAIR`, `*SURFACE BEHAVIOR`, `*FRICTION`: `Tie`, `Contact` (hard, or soft by a linear
  pressure-overclosure; `Adjust`), `Friction`; `*CLEARANCE`: `Adjust` and `Gap`
* `*PRE-TENSION SECTION`: the bolt is cut; `Linear constraint` holds the sides together, but for the same shift
  everywhere, which a pair of forces or a value determines. A bolt's force is that of its stresses: where a force is
  prescribed, the pair at one node carries a part that the constraint does not have
* `*STEP`, `*STATIC`, `*AMPLITUDE`: steps and histories

Keywords for output are ignored: Harmos always writes displacements, stresses at nodes, contact pressures and forces.
`Output/Expert/Cell fields` = `stress` adds the mean stress of each cell.

## What differs

* **NLGEOM** of any step makes [displacements finite](scenes.md#large-displacements) in all of them, with the St.
  Venant-Kirchhoff law as in CalculiX. Bolts under pretension keep the direction that they have at rest, which a note
  says.
* **Plasticity.** At finite strains Harmos integrates logarithmic strains, exactly where a bar is but stretched; the
  yield stress is Kirchhoff's. Of the bars of the test suite the first step is the same tension by 2.8 %, with either
  hardening: Harmos' displacement is 0.23323 in both, that of the closed form. `ccx` has 0.22782 and 0.22798 in one
  increment, 0.22741 and 0.22987 in 64.
* **Plasticity with contact** agrees: a stiff stamp pressed by 0.03 into a plate of metal that is 1 thick, ten
  increments, the force in each (`tests/verification/physics/test_plastic_calculix.py`): C3D8 to 0.28 %, with NLGEOM to
  0.50 %, C3D20R to 0.10 %, with NLGEOM and friction of 0.2 to 0.77 %. The contact of `ccx` is soft there.
* **Contact and ties** are mortar couplings where meshes do not match. CalculiX ties nodes to faces one by one, which
  does not pass the patch test on meshes that do not match.
* **Integration.** Elements of full integration are integrated exactly on straight cells. CalculiX has 4 points in C3D10
  and one in CAX3, and expands plane and axisymmetric elements to solid ones: on coarse or curved meshes results differ.
* **Plane sections** have the thickness 1 in Harmos; forces are divided by the thickness of the model.
* **Reduced elements** (C3D20R and its like) keep their reduced integration, and their body is one subdomain. A body
  of one such cell has mechanisms and is rejected.

## Its own test suite

Debian's package `calculix-ccx-test` has the test suite of CalculiX. `tests/performance/calculix/calculix_models.py`
converts each model, solves it on one rank, and compares it with the results of the suite and with Debian's `ccx`, which
solves the same input with the displacements of all nodes printed. Compared are displacements at each node, and the mean
stresses of the elements whose stresses the model prints. A difference is the largest one over the largest value. Both
programs print seven digits.
"""

LARGE_INCREMENT = "plastic strains of 0.03 in one increment, see above"
REMARKS = {
    "beampd": "stresses, " + LARGE_INCREMENT,
    "beampiso": LARGE_INCREMENT,
    "beampkin": LARGE_INCREMENT,
    "beampt": "heated by 1500 degrees between walls, in one increment",
    "beampic": "the suite's result is that of an iterative solver, with three digits",
    "thread": "a tie of surfaces that look the same way; Harmos' surfaces have to face each other",
    "pret1": "a bolt of reduced elements that is one element thick: once it is cut, its ends have mechanisms",
    "cubef2f3": "ccx ties nodes one by one",
    "ax6": "a support at a single node; the stresses next to it differ, by as much without `NLGEOM`",
    "beamcontact": "by as much without `NLGEOM`, 0.28",
    "friction1": "by as much without `NLGEOM`; friction of ccx gives way before it slips",
    "punch1": "`Adjust` of distances that are not small does not go with finite displacements; without `NLGEOM` 0.07",
    "punch2": "`ADJUST` of a node set is not supported, which a note says; by as much without `NLGEOM`",
    "planestress3": "ccx expands the elements to solid ones, in which the stress across is not zero at each point",
}


def line(entry):
    """An entry for the terminal."""
    parts = [f"{entry['name']:20} {entry['status']:8}"]
    for field in ("reference", "ccx"):
        if field in entry:
            parts.append(f"{field} {entry[field]['difference']:.1e} at {entry[field]['node']}")
    if "stress" in entry:
        parts.append(f"stress {entry['stress']['difference']:.1e} in {entry['stress']['element']}")
    return "  ".join(parts + [entry.get("reason", "")])


def wrapped(text):
    return textwrap.fill(text, 120)


def page(document):
    runs = document["runs"]
    inside = [entry for entry in runs if not entry["outside"]]
    counts = Counter(entry["status"] for entry in inside)
    reasons = Counter(entry["outside"] for entry in runs if entry["outside"])
    lines = [
        HEAD,
        wrapped(
            f"Of {len(runs)} models {len(inside)} are in scope: static, of solids, elastic or with von Mises' plasticity. "
            f"{counts['agrees']} agree, {counts['differs']} differ, {counts['refused']} are not converted, "
            f"{counts['fails']} fail."
        ),
        "",
        "| Out of scope because of | Models |",
        "|---|---|",
        *[f"| {reason} | {count} |" for reason, count in reasons.most_common()],
        "",
        wrapped(
            "A model agrees if no difference from `ccx` is above 1e-4; at most 5e-4 for axisymmetric ones, which ccx "
            "expands to a wedge of two degrees with straight sides; at most 1e-2 with coupled surfaces, whose "
            "discretisation differs. Seconds are those of a whole run, output included."
        ),
        "",
        "| Model | Nodes | | from the suite | from ccx | stresses, from ccx | Harmos, s | ccx, s |",
        "|---|---|---|---|---|---|---|---|",
        *[row(entry) for entry in inside if entry["status"] in ("agrees", "differs")],
        "",
        "What does not agree, and why:",
        "",
        *[remark(entry) for entry in inside if remark(entry)],
        "",
        wrapped(f"*Measured by `tests/performance/calculix/calculix_models.py` with {document['harmos']}.*"),
        "",
    ]
    return "\n".join(lines)


def row(entry):
    cells = [entry["name"], str(entry.get("nodes", "")), entry["status"]]
    cells += [f"{entry[f]['difference']:.1e}" if f in entry else "" for f in ("reference", "ccx", "stress")]
    cells += [f"{entry[f]:.2f}" if f in entry else "" for f in ("seconds", "ccx_seconds")]
    return "| " + " | ".join(cells) + " |"


def remark(entry):
    text = REMARKS.get(entry["name"], entry.get("reason", ""))
    text = re.sub(r"^\S+\.inp, (line \d+): ", r"\1, ", text)
    return textwrap.fill(f"* `{entry['name']}`: {text}", 120, subsequent_indent="  ") if text else ""
