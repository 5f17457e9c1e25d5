# SPDX-License-Identifier: BSD-3-Clause
"""Two equal elastic balls pressed onto each other, of tetrahedra that do not match, against Hertz.

Theory (Johnson: Contact Mechanics, 1985, chapter 4) with the force F that the run tells, R = 1/2,
E* = E/2(1 - nu^2): radius a = (3FR/4E*)^(1/3), pressure p0 sqrt(1 - (r/a)^2), p0 = 3F/(2 pi a^2). What it
leaves out is of the order of (a/R)^2.

What it guards against: multipliers of quadratic tetrahedra that carry no pressure at corners or too
much, curved facets and gaps between them, areas of points, planes of symmetry through a contact zone.
"""

import math
import sys
import unittest
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402
from real_bodies import displaced, entry, group  # noqa: E402

E, NU = 1.0, 0.3
APPROACH = 0.008  # of each of the two; a is about 0.09

# A quarter of the lower half of one ball on a quarter of the upper half of the other: sizes grow from h
# where they touch. Meshes of the two differ by a factor.
GEOMETRY = """
SetFactory("OpenCASCADE");
Sphere(1) = {{0, 0, 1, 1, -Pi/2, 0, Pi/2}};
Sphere(2) = {{0, 0, -1, 1, 0, Pi/2, Pi/2}};
e = 1e-3;
x1() = Surface In BoundingBox{{-e, -e, -e, e, 1+e, 1+e}}; y1() = Surface In BoundingBox{{-e, -e, -e, 1+e, e, 1+e}};
x2() = Surface In BoundingBox{{-e, -e, -1-e, e, 1+e, e}}; y2() = Surface In BoundingBox{{-e, -e, -1-e, 1+e, e, e}};
top() = Surface In BoundingBox{{-e, -e, 1-e, 1+e, 1+e, 1+e}};
bottom() = Surface In BoundingBox{{-e, -e, -1-e, 1+e, 1+e, -1+e}};
s1() = Boundary{{ Volume{{1}}; }}; s1() -= {{x1(), y1(), top()}};
s2() = Boundary{{ Volume{{2}}; }}; s2() -= {{x2(), y2(), bottom()}};
Physical Surface("skin") = {{s1(), s2()}};
Physical Surface("x") = {{x1(), x2()}};
Physical Surface("y") = {{y1(), y2()}};
Physical Surface("middle") = {{top(), bottom()}};
Physical Volume("upper") = {{1}};
Physical Volume("lower") = {{2}};
Field[1] = MathEval;
Field[1].F = "{h} * (1.085 - 0.085 * z / (Abs(z) + 1e-6)) + 0.15 * (sqrt(x*x + y*y + z*z) - {zone} + Abs(sqrt(x*x + y*y + z*z) - {zone}))";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeMax = 0.3;
Mesh.ElementOrder = {order};
"""


def deck(directory, order, h):
    directory.mkdir(parents=True, exist_ok=True)
    mesh = directory / f"balls_{order}_{h}.geo"
    mesh.write_text(GEOMETRY.format(order=order, h=h, zone=0.12), encoding="utf-8")
    bodies = ("upper", "lower")
    effects = [
        group(
            "Contact",
            group(
                "joint",
                entry("First", "string", "upper/skin"),
                entry("Second", "string", "lower/skin"),
                entry("Reach", "double", 0.05),
            ),
        )
    ]
    held = []
    for body, sign in zip(bodies, (-1, 1)):
        held.append(displaced(f"press {body}", f"{body}/middle", (0, 0, sign * APPROACH)))
        for axis, name in (("{x}", "x"), ("{y}", "y")):
            held.append(
                group(
                    f"{name} {body}",
                    entry("Part", "string", f"{body}/{name}"),
                    entry("Components", "Array(string)", axis),
                )
            )
    effects.append(group("Prescribed displacement", *held))
    material = group("elastic", entry("Young's modulus", "double", E), entry("Poisson's ratio", "double", NU))
    text = group(
        "harmos",
        group("Model", entry("Physics", "string", "solid"), entry("Mesh file", "string", mesh.name)),
        group("Materials", material),
        group(
            "Bodies",
            *(
                group(b, entry("Materials", "Array(string)", "{elastic}"), entry("Subdomains", "int", 8))
                for b in bodies
            ),
        ),
        group("Effects", *effects),
    )
    path = directory / f"balls_{order}_{h}.xml"
    path.write_text(text, encoding="utf-8")
    return path


def measured(test, order, h):
    """Unknowns, and what differs from theory: the pressure at the origin, and in the mean of squares over the zone."""
    run = runs.solved(test, deck(runs.scratch(f"balls_{order}"), order, h), {}, program="harmos")
    force = 4.0 * abs(run.summary["forces"]["Contact/joint"]["force"][2])
    modulus, radius = E / (2.0 * (1.0 - NU**2)), 0.5
    a = (3.0 * force * radius / (4.0 * modulus)) ** (1.0 / 3.0)
    p0 = 3.0 * force / (2.0 * math.pi * a * a)
    with h5py.File(run.directory / "result.vtkhdf") as file:
        points = file["VTKHDF/Points"][:]
        pressure = file["VTKHDF/PointData/contact_pressure"][:]
        active = file["VTKHDF/PointData/active_set"][:]
    on = active > 0
    distance = np.hypot(points[on, 0], points[on, 1])
    exact = p0 * np.sqrt(np.maximum(0.0, 1.0 - (distance / a) ** 2))
    # At the rim the slope has no bound.
    inside = distance < 0.9 * a
    error = np.sqrt(np.mean((pressure[on][inside] - exact[inside]) ** 2)) / p0
    peak = pressure[on][np.argmin(distance)] / p0 - 1.0
    return run.summary["primal_dimension"], a, peak, error, run.summary["hessian_applications"]


class Hertz(unittest.TestCase):
    def test_quadratic_and_linear_tetrahedra(self):
        results = {}
        for order, meshes in ((1, (0.016, 0.012, 0.009, 0.0068)), (2, (0.036, 0.027, 0.02, 0.015))):
            rows = [measured(self, order, h) for h in meshes]
            errors = [row[3] for row in rows]
            rate = np.polyfit(np.log(meshes), np.log(errors), 1)[0]
            print(f"P{order}: unknowns, peak, mean: " + ", ".join(f"{n} {p:+.4f} {e:.4f}" for n, _, p, e, _ in rows)
                  + f"; rate {rate:.2f}; products {[row[4] for row in rows]}")
            results[order] = rows
            # Pressures of linear elements are constant a cell, of first order; the solution is in H^(5/2), which
            # allows quadratic ones 3/2.
            low, high = ((0.5, 1.5), (1.0, 2.2))[order - 1]
            self.assertGreater(rate, low)
            self.assertLess(rate, high)
        finest = results[2][-1]
        self.assertLess(abs(finest[2]), 0.01)  # (a/R)^2 = 0.8 %
        self.assertLess(finest[3], 0.015)
        # About as many unknowns, half of the error or less.
        linear, quadratic = results[1][-1], results[2][-2]
        self.assertLess(quadratic[0], 1.2 * linear[0])
        self.assertLess(quadratic[3], 0.6 * linear[3])


if __name__ == "__main__":
    runs.main()
