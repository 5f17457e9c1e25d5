# SPDX-License-Identifier: BSD-3-Clause
"""The page docs/indentation.md, of what indentation.py measured."""

import textwrap

HEAD = """# A ball pressed into metal, beside deal.II

This page compares Harmos with [step-42](https://github.com/dealii/dealii/blob/master/examples/step-42/doc/intro.dox),
the tutorial of deal.II for contact of an elastoplastic body (Frohne, Heister, Bangerth, Int. J. Numer. Meth. Engng.
105, 2016). A rigid ball is pressed 0.01 deep into a cube of side 1, whose sides a mould keeps from moving outwards. E
= 200 000, ν = 0.3; linear isotropic hardening.

**The same problem.** Both solve it in one step from rest, with trilinear hexahedra and without B-bar. The tutorial's
law of total strains is the return of plastic flow then. On 8³ cells, where one node is in contact, the tutorial's
documentation gives the force 37.3058: Harmos' is 37.305781. On 16³ cells, with the nine nodes in contact put where
the tutorial puts them, both have 62.3128 (`tests/verification/physics/test_plasticity.py`).

**What differs.** The tutorial's ball keeps nodes out along z, Harmos' along the normal of the ball, without friction:
it presses material outwards. The difference grows with the slope of the ball where it touches, and decreases with the
radius. The tutorial solves until residuals are below 1e-10, by multigrid and BiCGStab on one matrix; Harmos to a
change of 1e-6 in the energy norm, with an audit. The tutorial starts with two elastic iterations on each mesh. It can
refine meshes where the error is: Harmos cannot yet.
"""


def wrapped(text):
    return textwrap.fill(text, 120) + "\n"


def page(document):
    lines = [HEAD]
    lines.append("## Forces and seconds\n")
    lines.append(wrapped(
        f"`tests/performance/plastic/indentation.py`, `{document['harmos']}`, Debian's deal.II 9.4.1; {document['ranks']} ranks "
        f"each, whole runs in turns, medians of {document['repetitions']}. Seconds of the tutorial include its output, as "
        "those of Harmos do."
    ))
    lines.append("In each cell step-42 first, then Harmos; Newton: its iterations; F: applications of F by Harmos.\n")
    lines.append("| Radius | Cells | Unknowns | Forces | Newton | F | Seconds |")
    lines.append("|---|---|---|---|---|---|---|")
    for entry in document["runs"]:
        theirs, ours = entry["tutorial"], entry["harmos"]
        lines.append(
            f"| {entry['radius']:g} | {entry['cells']}³ | {theirs['unknowns']} | {theirs['force']:g}, {ours['force']:.6g} | "
            f"{theirs['newton']}, {ours['newton']:g} | {ours['products']} | {theirs['seconds']:.3g}, {ours['seconds']:.3g} |"
        )
    lines.append("\n" + wrapped(
        "The tutorial's documentation has, of 16 cores of another machine and years ago: 1.13 s for 8³ cells, and 38.4 s for "
        "52497 unknowns of a mesh that was refined three times where the error is, with a force of 56.794."
    ))
    lines.append("## Force over depth\n")
    lines.append(f"{document['curve_cells']}³ cells, radius {document['curve_radius']:g}.\n")
    lines.append("| Depth | Force, step-42 | Force, Harmos | Difference |")
    lines.append("|---|---|---|---|")
    for point in document["curve"]:
        apart = point["harmos"] / point["tutorial"] - 1.0
        lines.append(f"| {point['depth']:g} | {point['tutorial']:g} | {point['harmos']:g} | {100.0 * apart:+.2f} % |")
    return "\n".join(lines) + "\n"
