# SPDX-License-Identifier: BSD-3-Clause
"""Plasticity with contact beside CalculiX, which solves the same input on the same mesh: forces of each increment.

What it guards against: another material law than that of users' models, at small and finite displacements, in full and in
reduced elements, beneath a contact.
"""

import re
import shutil
import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "support"), str(Path(__file__).resolve().parents[1] / "finite")]

import harmos_runs as runs  # noqa: E402

try:
    from finite_scenes import steps_of
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

INCREMENTS, PRESS = 10, 0.03
FACES = {"below": "S3", "above": "S5"}  # of the hexahedra of box()


def box(corner, size, cells, order, first):
    """Nodes and elements of one layer of hexahedra with 8 or 20 nodes, 0.25 thick, numbered from `first`."""
    numbers, places, elements = {}, {}, []
    for i in range(order * cells[0] + 1):
        for j in range(order * cells[1] + 1):
            for k in range(order + 1):
                if order == 2 and i % 2 + j % 2 + k % 2 > 1:
                    continue
                numbers[i, j, k] = first + len(numbers)
                places[numbers[i, j, k]] = (
                    corner[0] + size[0] * i / (order * cells[0]), corner[1] + size[1] * j / (order * cells[1]), 0.25 * k / order,
                )
    ring = ((0, 0), (2, 0), (2, 2), (0, 2))
    edges = ((1, 0), (2, 1), (1, 2), (0, 1))
    pattern = [(*p, 0) for p in ring] + [(*p, 2) for p in ring]
    if order == 2:
        pattern += [(*p, 0) for p in edges] + [(*p, 2) for p in edges] + [(*p, 1) for p in ring]
    for i in range(cells[0]):
        for j in range(cells[1]):
            nodes = [numbers[order * i + a * order // 2, order * j + b * order // 2, c * order // 2] for a, b, c in pattern]
            elements.append((first + len(elements), nodes, j))
    return places, elements


def mesh_lines(plate, stamp, element):
    """Nodes and elements of both, and what the plate stands on."""
    lines = ["*NODE, NSET=ALL"]
    for places, _ in (plate, stamp):
        lines += [f"{node}, {x:.10g}, {y:.10g}, {z:.10g}" for node, (x, y, z) in places.items()]
    for name, (_, elements) in (("PLATE", plate), ("STAMP", stamp)):
        lines.append(f"*ELEMENT, TYPE={element}, ELSET={name}")
        for number, nodes, _ in elements:
            words = [str(word) for word in (number, *nodes)]
            lines += [", ".join(words[:11]) + ("," if words[11:] else "")] + ([", ".join(words[11:])] if words[11:] else [])
    lines += ["*NSET, NSET=GROUND"] + [f"{node}," for node, place in plate[0].items() if place[1] == 0.0]
    return lines


def model(element, nlgeom, friction):
    """A stiff stamp above a plate of metal, nodes of both at the same places."""
    order = 2 if "20" in element else 1
    plate = box((0.0, 0.0), (4.0, 1.0), (16, 4), order, 1)
    stamp = box((1.5, 1.0), (1.0, 0.5), (4, 2), order, 100001)
    lines = mesh_lines(plate, stamp, element)
    lines += ["*NSET, NSET=TOP"] + [f"{node}," for node, place in stamp[0].items() if place[1] == 1.5]
    lines += ["*SURFACE, NAME=LOWER"] + [f"{e}, {FACES['above']}" for e, _, j in plate[1] if j == 3]
    lines += ["*SURFACE, NAME=UPPER"] + [f"{e}, {FACES['below']}" for e, _, j in stamp[1] if j == 0]
    lines += ["*MATERIAL, NAME=METAL", "*ELASTIC", "200., 0.3", "*PLASTIC", "0.4, 0.", "2.4, 1.", "*MATERIAL, NAME=TOOL"]
    lines += ["*ELASTIC", "1000., 0.3", "*SOLID SECTION, ELSET=PLATE, MATERIAL=METAL", "*SOLID SECTION, ELSET=STAMP, MATERIAL=TOOL"]
    lines += ["*SURFACE INTERACTION, NAME=SI", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "1e5, 1e-3"]
    if friction:
        lines += ["*FRICTION", f"{friction}, 1e4"]
    lines += ["*CONTACT PAIR, INTERACTION=SI, TYPE=SURFACE TO SURFACE", "UPPER, LOWER", "*BOUNDARY", "ALL, 3, 3"]
    lines += ["GROUND, 1, 2", "TOP, 1, 1", "*STEP, INC=100" + (", NLGEOM" if nlgeom else ""), "*STATIC, DIRECT"]
    lines += [f"{1.0 / INCREMENTS}, 1.", "*BOUNDARY", f"TOP, 2, 2, {-PRESS}"]
    return "\n".join([*lines, "*NODE PRINT, NSET=TOP, TOTALS=ONLY", "RF", "*END STEP", ""])


@unittest.skipUnless(shutil.which("ccx"), "ccx is not installed (Debian: calculix-ccx)")
class Stamp(unittest.TestCase):
    def forces(self, element, nlgeom=False, friction=0.0):
        """Of ccx, of Harmos, in each increment."""
        directory = runs.scratch("stamp")
        directory.mkdir()
        (directory / "stamp.inp").write_text(model(element, nlgeom, friction), encoding="utf-8")
        status, out, errors = runs.execute(["ccx", "-i", "stamp"], cwd=directory)
        self.assertEqual(status, 0, out + errors)
        printed = (directory / "stamp.dat").read_text(encoding="utf-8")
        theirs = [-float(line.split()[1]) for line in re.findall(r"total force.*\n\n(.*)\n", printed)]
        converter = runs.application("harmos-inp")
        status, out, errors = runs.execute([converter, directory / "stamp.inp", "--output", directory / "deck"])
        self.assertEqual(status, 0, out + errors)
        run = runs.solved(self, directory / "deck/stamp.xml", {"Steps/Number": INCREMENTS}, np=runs.RANKS, program="harmos")
        ours = [abs(row["Contact/contact/fy"]) for row in steps_of(run.directory)]
        self.assertEqual((len(ours), len(theirs)), (INCREMENTS, INCREMENTS))
        return theirs, ours

    def compare(self, *words, **more):
        theirs, ours = self.forces(*words, **more)
        apart = [b / a - 1.0 for a, b in zip(theirs, ours)]
        print(words, more, "forces", ours[0], "to", ours[-1], "differ by at most", max(map(abs, apart)), flush=True)
        self.assertLess(max(map(abs, apart)), 0.01, (theirs, ours))

    def test_small(self):
        self.compare("C3D8")

    def test_finite(self):
        self.compare("C3D8", nlgeom=True)

    def test_reduced(self):
        self.compare("C3D20R")

    def test_friction(self):
        self.compare("C3D20R", nlgeom=True, friction=0.2)


if __name__ == "__main__":
    runs.main()
